//! The core's law near rest: its torque, differentiated at a posture.

use controller_core::arm::ArmParameters;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{DOF, JointMatrix, JointVector};
use controller_core::task::Tracked;
use controller_core::{Controller, Measurement, Reference, Target, Task};

use super::link::Link;
use super::matrix::Matrix;
use super::sampled::{Arm, Slopes, Springs};
use crate::arm_points;
use crate::plant::PlantModel;
use crate::plant::actuators::Actuators;

/// Half a central difference \[rad\], \[rad/s\], \[Nm\]: below every threshold of the law; torques
/// of 100 Nm are exact to 1e-14 of that, slopes then to 1e-6.
const STEP: f64 = 1e-6;

/// An arm and the law, near rest in a posture.
pub struct NearRest {
    /// What moves.
    pub arm: Arm,
    /// The law.
    pub law: Slopes,
}

/// Torque, weight and mass matrix of a cycle.
struct Cycle {
    torque: JointVector<f64>,
    gravity: JointVector<f64>,
    mass_matrix: JointMatrix<f64>,
}

/// Where a task is at rest in a posture \[rad\].
fn target(task: &Task, plant: &PlantModel, q: &JointVector<f64>) -> Target<f64> {
    match &task.tracked {
        Tracked::Position(point) => Target::position(arm_points::at_rest(plant, q, point)),
        Tracked::Orientation(frame) => {
            Target::orientation(arm_points::orientation(plant, q, frame))
        }
    }
}

fn matrix(columns: &[JointVector<f64>; DOF]) -> Matrix {
    Matrix::from_fn(DOF, DOF, |row, column| columns[column][row])
}

fn of_joints(joints: &JointMatrix<f64>) -> Matrix {
    Matrix::from_fn(DOF, DOF, |row, column| joints[(row, column)])
}

impl NearRest {
    /// Of a controller with these tasks for `arm`, at `q` \[rad\], every task on its target, no
    /// external torque. None where a mass matrix is not positive definite.
    #[must_use]
    pub fn of(
        arm: &ArmParameters,
        controller: &Controller<f64>,
        tasks: &[Task],
        observer_gain: f64,
        link: &Link,
        q: &JointVector<f64>,
    ) -> Option<Self> {
        let plant = PlantModel::new(arm);
        let mut reference = Reference::hold(tasks.len(), *q);
        for (to, task) in reference.targets_mut().iter_mut().zip(tasks) {
            *to = target(task, &plant, q);
        }
        let cycle = |offset: [JointVector<f64>; 3]| {
            let [position, speed, residual] = offset;
            let measurement = Measurement {
                q: q + position,
                dq: speed,
                interval_s: link.timing.cycle_s,
            };
            let input = Input {
                measurement: &measurement,
                reference: &reference,
            };
            let mut data = Data::new();
            // An observer that has not started keeps it.
            data.observer.residual = residual;
            controller.evaluate(&input, &mut data);
            Cycle {
                torque: data.demand.0,
                gravity: data.dynamics.gravity,
                mass_matrix: data.dynamics.mass_matrix,
            }
        };
        let rest = cycle([JointVector::zeros(); 3]);
        let mut slopes = [[JointVector::zeros(); DOF]; 3];
        let mut weight = [JointVector::zeros(); DOF];
        for (what, slopes) in slopes.iter_mut().enumerate() {
            for joint in 0..DOF {
                let [above, below] = [STEP, -STEP].map(|step| {
                    let mut offset = [JointVector::zeros(); 3];
                    offset[what][joint] = step;
                    cycle(offset)
                });
                slopes[joint] = (above.torque - below.torque) / (2.0 * STEP);
                if what == 0 {
                    weight[joint] = (above.gravity - below.gravity) / (2.0 * STEP);
                }
            }
        }
        let [position, speed, residual] = slopes.each_ref().map(matrix);
        let mut moved = rest.mass_matrix;
        let mut springs = None;
        if link.elastic {
            // Rotors are on the other side of the springs.
            for (joint, of_joint) in arm.links.iter().enumerate() {
                moved[(joint, joint)] -= of_joint.rotor_inertia;
            }
            let drives = Actuators::of(arm);
            let values = |all: JointVector<f64>| all.as_slice().to_vec();
            springs = Some(Springs {
                stiffness: values(drives.stiffness),
                damping: values(drives.damping),
                inertia: values(drives.motor_inertia),
            });
        }
        let mobility = moved.cholesky()?.inverse();
        Some(Self {
            arm: Arm {
                mass_matrix: of_joints(&rest.mass_matrix),
                mobility: of_joints(&mobility),
                gravity_slope: matrix(&weight),
                friction: link.friction.to_vec(),
                elastic: springs,
            },
            law: Slopes {
                position,
                speed,
                residual,
                observer_gain,
            },
        })
    }
}
