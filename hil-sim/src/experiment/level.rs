//! What a level's point or frame really does, seen by the plant.

use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::kinematics::LinkPoint;
use controller_core::measurement::Reference;
use controller_core::orientation;
use controller_core::task::Axes;

use crate::plant::PlantModel;
use crate::scenario::{self, Scenario, TaskSpec};

/// One level at one instant, true values.
#[derive(Clone, Debug, Default)]
pub struct LevelInstant {
    /// Desired coordinates of its axes \[m\], or the desired quaternion.
    pub desired: Vec<f64>,
    /// True coordinates of its axes \[m\], or the true quaternion.
    pub actual: Vec<f64>,
    /// Norm of their difference \[m\], or of the orientation error \[rad\].
    pub error: f64,
    /// Norm of the task acceleration that the torques of lower levels and of the
    /// null space cause on this arm \[m/s2\], or \[rad/s2\]; NaN where it is not known.
    pub leak: f64,
    /// Desired position of the point \[m\].
    pub desired_point: [f64; 3],
    /// True position of the point \[m\].
    pub actual_point: [f64; 3],
}

/// The points and axes of a scenario's levels.
pub(crate) struct Places(pub Vec<Place>);

pub(crate) struct Place {
    task: TaskSpec,
    point: LinkPoint<f64>,
    axes: Axes,
}

impl Places {
    pub fn new(scenario: &Scenario) -> Self {
        let place = |level: &scenario::LevelSpec| Place {
            task: level.task,
            point: level.point.resolve(),
            axes: Axes::from_name(&level.axes).unwrap_or(Axes::XYZ),
        };
        Self(scenario.levels.iter().map(place).collect())
    }

    /// Every level at the plant's true state.
    pub fn levels(
        &self,
        plant: &PlantModel,
        truth: &JointState<f64>,
        reference: &Reference<f64>,
    ) -> Vec<LevelInstant> {
        let levels = self.0.iter().zip(&reference.tasks);
        levels
            .map(|(place, reference)| {
                let (x, _) = plant.point(truth, place.point.link, &place.point.offset);
                let shown = LevelInstant {
                    desired_point: reference.x.into(),
                    actual_point: x.into(),
                    leak: f64::NAN,
                    ..LevelInstant::default()
                };
                match place.task {
                    TaskSpec::Position => LevelInstant {
                        desired: place.pick(&reference.x).collect(),
                        actual: place.pick(&x).collect(),
                        error: place.norm(&(reference.x - x)),
                        ..shown
                    },
                    TaskSpec::Orientation => {
                        let desired = reference.orientation;
                        let actual = scenario::orientation(&truth.q, place.point.link);
                        LevelInstant {
                            desired: desired.as_slice().to_vec(),
                            actual: actual.as_slice().to_vec(),
                            error: place.norm(&orientation::error(&desired, &actual)),
                            ..shown
                        }
                    }
                }
            })
            .collect()
    }
}

impl Place {
    fn pick<'a>(&'a self, v: &'a Vector3<f64>) -> impl Iterator<Item = f64> + 'a {
        (0..3)
            .filter(|&axis| self.axes.xyz[axis])
            .map(|axis| v[axis])
    }

    fn norm(&self, v: &Vector3<f64>) -> f64 {
        self.pick(v).map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Norm of J M^-1 below \[m/s2\], M of the plant: what its acceleration loses
    /// when `below` is taken off its torque.
    pub fn leak(
        &self,
        plant: &PlantModel,
        truth: &JointState<f64>,
        torque: &JointVector<f64>,
        below: &JointVector<f64>,
    ) -> f64 {
        let none = JointVector::zeros();
        let ddq = |torque| plant.forward_dynamics(&truth.q, &truth.dq, &torque, &none);
        let caused = ddq(*torque) - ddq(torque - below);
        // J caused is the velocity of the point for joint speeds `caused`.
        let moving = JointState {
            q: truth.q,
            dq: caused,
        };
        match self.task {
            TaskSpec::Position => {
                let (_, acceleration) = plant.point(&moving, self.point.link, &self.point.offset);
                self.norm(&acceleration)
            }
            TaskSpec::Orientation => self.norm(&angular_velocity(plant, &moving, self.point.link)),
        }
    }
}

/// Angular velocity of a link \[rad/s\], from the velocities of its frame's origin
/// and of the ends of its unit axes: w = sum of e_i x (de_i) / 2.
pub(crate) fn angular_velocity(
    plant: &PlantModel,
    state: &JointState<f64>,
    link: usize,
) -> Vector3<f64> {
    let (origin, origin_rate) = plant.point(state, link, &Vector3::zeros());
    let mut sum = Vector3::zeros();
    for axis in 0..3 {
        let mut end = Vector3::zeros();
        end[axis] = 1.0;
        let (tip, tip_rate) = plant.point(state, link, &end);
        sum += (tip - origin).cross(&(tip_rate - origin_rate));
    }
    sum / 2.0
}
