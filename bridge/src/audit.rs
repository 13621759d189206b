//! The robot's own model against the controller's: M, g and J arrive in every
//! measurement, and a wrong tool, a wrong sign or a wrong arm shows there before
//! it shows in the motion.

use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{DOF, JointMatrix, JointVector, Vector3, zeros};
use controller_core::real::Real;
use controller_core::{Controller, LinkPoint, Measurement, Reference};

/// Largest difference of gravity torques that counts as agreement \[Nm\].
pub const GRAVITY_TOLERANCE_NM: f64 = 3.0;

/// Largest difference of mass-matrix entries over the largest entry that counts
/// as agreement.
pub const MASS_TOLERANCE: f64 = 0.25;

/// Largest difference of Jacobian entries that counts as agreement, \[m\] and \[1\].
pub const JACOBIAN_TOLERANCE: f64 = 0.02;

/// What the robot says about itself in a posture.
#[derive(Clone, Copy, Debug)]
pub struct RobotModel {
    /// Measured joint angles \[rad\].
    pub q: JointVector<f64>,
    /// Mass matrix \[kg m2\].
    pub mass_matrix: JointMatrix<f64>,
    /// Gravity torque \[Nm\].
    pub gravity: JointVector<f64>,
    /// Jacobian of the flange, rows x y z \[m\], then rotations about x y z \[1\].
    pub jacobian: [JointVector<f64>; 6],
}

/// How the two stand to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Agreement {
    /// Within the tolerance.
    #[default]
    Agrees,
    /// The robot sends zeros: nothing to compare.
    NotSent,
    /// It fits with the opposite sign.
    OppositeSign,
    /// It does not fit.
    Differs,
}

impl Agreement {
    /// One or two words for reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::NotSent => "not sent",
            Self::OppositeSign => "opposite sign",
            Self::Differs => "differs",
        }
    }
}

/// The largest differences so far, and what they mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audit {
    /// Postures compared.
    pub samples: u32,
    /// Gravity torque.
    pub gravity: Agreement,
    /// Largest difference of a gravity torque \[Nm\].
    pub gravity_nm: f64,
    /// The joint, 1..=7, where it occurred.
    pub gravity_joint: usize,
    /// Mass matrix.
    pub mass: Agreement,
    /// Largest difference of an entry over the largest entry.
    pub mass_share: f64,
    /// Jacobian.
    pub jacobian: Agreement,
    /// Largest difference of an entry, \[m\] or \[1\].
    pub jacobian_error: f64,
}

impl Audit {
    /// Compares in one more posture; `flange` is the point of the robot's Jacobian.
    /// Behind a call, so that the controller's results are on the stack only meanwhile.
    #[inline(never)]
    pub fn compare(
        &mut self,
        controller: &Controller<f64>,
        flange: &LinkPoint,
        robot: &RobotModel,
    ) {
        let mut data = Data::new();
        at_rest(controller, &robot.q, &mut data);
        let (kinematics, dynamics) = (&data.kinematics, &data.dynamics);
        self.samples = self.samples.saturating_add(1);

        let gravity = judge(
            robot.gravity.as_slice(),
            dynamics.gravity.as_slice(),
            GRAVITY_TOLERANCE_NM,
        );
        self.gravity = worse(self.gravity, gravity);
        let difference = robot.gravity - dynamics.gravity;
        for (joint, value) in (1..=DOF).zip(&difference) {
            if gravity != Agreement::NotSent && value.magnitude() > self.gravity_nm {
                self.gravity_nm = value.magnitude();
                self.gravity_joint = joint;
            }
        }

        let scale = dynamics.mass_matrix.amax();
        let mass = judge(
            robot.mass_matrix.as_slice(),
            dynamics.mass_matrix.as_slice(),
            MASS_TOLERANCE * scale,
        );
        self.mass = worse(self.mass, mass);
        if mass != Agreement::NotSent {
            let share = (robot.mass_matrix - dynamics.mass_matrix).amax() / scale;
            self.mass_share = self.mass_share.larger(share);
        }

        let motion = kinematics.point(flange.link, &Vector3::from(flange.offset));
        let linear = kinematics.point_jacobian(flange.link, &motion).jacobian;
        let angular = kinematics.angular_jacobian(flange.link).jacobian;
        let rows = linear.iter().chain(&angular);
        let sent = robot.jacobian.iter().any(|row| row.amax() > 0.0);
        let mut jacobian = if sent {
            Agreement::Agrees
        } else {
            Agreement::NotSent
        };
        for (row, ours) in robot.jacobian.iter().zip(rows).filter(|_| sent) {
            let error = (row - ours).amax();
            self.jacobian_error = self.jacobian_error.larger(error);
            // One row of zeros is a row like any other.
            jacobian = match judge(row.as_slice(), ours.as_slice(), JACOBIAN_TOLERANCE) {
                Agreement::NotSent => worse(jacobian, Agreement::Differs),
                agreement => worse(jacobian, agreement),
            };
        }
        self.jacobian = worse(self.jacobian, jacobian);
    }

    /// Whether nothing contradicts the controller's model.
    #[must_use]
    pub fn passes(&self) -> bool {
        let fine = |agreement| matches!(agreement, Agreement::Agrees | Agreement::NotSent);
        fine(self.gravity) && fine(self.mass) && fine(self.jacobian)
    }
}

/// The controller's model at rest in a posture `q` \[rad\].
fn at_rest(controller: &Controller<f64>, q: &JointVector<f64>, data: &mut Data<f64>) {
    let input = Input {
        measurement: &Measurement {
            q: *q,
            dq: zeros(),
            interval_s: 0.0,
        },
        reference: &Reference::hold(0, *q),
    };
    controller.evaluate_until(StageName::Dynamics, &input, data);
}

fn worse(one: Agreement, other: Agreement) -> Agreement {
    let rank = |agreement| match agreement {
        Agreement::Agrees => 0,
        Agreement::NotSent => 1,
        Agreement::OppositeSign => 2,
        Agreement::Differs => 3,
    };
    if rank(other) > rank(one) { other } else { one }
}

fn judge(theirs: &[f64], ours: &[f64], tolerance: f64) -> Agreement {
    let largest = |sign: f64| {
        let pairs = theirs.iter().zip(ours);
        pairs.fold(0.0f64, |worst, (a, b)| {
            worst.larger((a - sign * b).magnitude())
        })
    };
    if largest(1.0) <= tolerance {
        Agreement::Agrees
    } else if theirs.iter().all(|value| *value == 0.0) {
        Agreement::NotSent
    } else if largest(-1.0) <= tolerance {
        Agreement::OppositeSign
    } else {
        Agreement::Differs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::{LWR_IV, LWR_IV_FLANGE};
    use controller_core::{Axes, ControllerConfig, Link, NullSpace, Task, TaskGains, TaskSet};

    /// The controller's own model as a robot would send it, and an audit of it
    /// after `change`.
    fn audit(change: impl FnOnce(&mut RobotModel)) -> Audit {
        let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
        let config = ControllerConfig {
            tasks: TaskSet::new(&[flange]).expect("a task"),
            null_space: NullSpace::diagonal([10.0; 7], [0.03; 7]),
            observer_gain: [50.0; 7],
            cycle_s: 0.002,
            dead_cycles: 0,
        };
        let controller = Controller::new(&LWR_IV, &config).expect("the built-in arm");
        let q = JointVector::from([0.1, 0.6, -0.3, -1.3, 0.4, 0.9, 0.2]);
        let mut data = Data::new();
        at_rest(&controller, &q, &mut data);
        let kinematics = &data.kinematics;
        let motion = kinematics.point(Link::L7, &Vector3::from(LWR_IV_FLANGE.offset));
        let [x, y, z] = kinematics.point_jacobian(Link::L7, &motion).jacobian;
        let [rx, ry, rz] = kinematics.angular_jacobian(Link::L7).jacobian;
        let mut robot = RobotModel {
            q,
            mass_matrix: data.dynamics.mass_matrix,
            gravity: data.dynamics.gravity,
            jacobian: [x, y, z, rx, ry, rz],
        };
        change(&mut robot);
        let mut audit = Audit::default();
        audit.compare(&controller, &LWR_IV_FLANGE, &robot);
        audit
    }

    #[test]
    fn the_same_model_agrees() {
        let audit = audit(|_| ());
        assert!(audit.passes());
        let all = [audit.gravity, audit.mass, audit.jacobian];
        assert_eq!(all, [Agreement::Agrees; 3]);
        assert_eq!((audit.gravity_nm, audit.jacobian_error), (0.0, 0.0));
    }

    #[test]
    fn what_is_not_sent_is_not_held_against_the_robot() {
        let audit = audit(|robot| {
            robot.gravity = zeros();
            robot.mass_matrix = JointMatrix::zeros();
            robot.jacobian = [zeros(); 6];
        });
        assert!(audit.passes());
        let all = [audit.gravity, audit.mass, audit.jacobian];
        assert_eq!(all, [Agreement::NotSent; 3]);
        assert_eq!((audit.gravity_nm, audit.mass_share), (0.0, 0.0));
    }

    #[test]
    fn a_wrong_sign_a_tool_and_a_wrong_order_are_found() {
        let sign = audit(|robot| robot.gravity = -robot.gravity);
        assert_eq!(sign.gravity, Agreement::OppositeSign);
        let tool = audit(|robot| robot.gravity[1] -= 5.0);
        assert_eq!((tool.gravity, tool.gravity_joint), (Agreement::Differs, 2));
        assert!((tool.gravity_nm - 5.0).abs() < 1e-12);
        // Joints in the order of the robot's program: the third axis last.
        let order = audit(|robot| {
            for row in &mut robot.jacobian {
                let third = row[2];
                *row = row.remove_row(2).insert_row(6, third);
            }
        });
        assert_eq!(order.jacobian, Agreement::Differs);
        let heavy = audit(|robot| robot.mass_matrix *= 1.5);
        assert_eq!(heavy.mass, Agreement::Differs);
        assert!(![sign, tool, order, heavy].iter().any(Audit::passes));
    }
}
