//! The robot's own model against the controller's: M, g and J arrive in every
//! measurement, and a wrong tool, a wrong sign or a wrong arm shows there before
//! it shows in the motion.

use controller_core::dynamics::Dynamics;
use controller_core::joint::{DOF, JointMatrix, JointState, JointVector, zeros};
use controller_core::kinematics::{Kinematics, LinkPoint};
use controller_core::model::ArmModel;
use controller_core::real::Real;

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
    pub fn compare(&mut self, model: &ArmModel<f64>, flange: &LinkPoint<f64>, robot: &RobotModel) {
        let state = JointState {
            q: robot.q,
            dq: zeros(),
        };
        let kinematics = Kinematics::new(model, &state);
        let dynamics = Dynamics::new(model, &kinematics, &state);
        self.samples = self.samples.saturating_add(1);

        let difference = robot.gravity - dynamics.gravity;
        for (joint, value) in (1..=DOF).zip(&difference) {
            if value.magnitude() > self.gravity_nm {
                self.gravity_nm = value.magnitude();
                self.gravity_joint = joint;
            }
        }
        let gravity = judge(
            robot.gravity.as_slice(),
            dynamics.gravity.as_slice(),
            GRAVITY_TOLERANCE_NM,
        );
        self.gravity = worse(self.gravity, gravity);

        let scale = dynamics.mass_matrix.amax();
        let share = (robot.mass_matrix - dynamics.mass_matrix).amax() / scale;
        self.mass_share = self.mass_share.larger(share);
        let mass = judge(
            robot.mass_matrix.as_slice(),
            dynamics.mass_matrix.as_slice(),
            MASS_TOLERANCE * scale,
        );
        self.mass = worse(self.mass, mass);

        let motion = kinematics.point(flange);
        let linear = kinematics.point_jacobian(flange.link, &motion).jacobian;
        let angular = kinematics.angular_jacobian(flange.link).jacobian;
        let rows = linear.iter().chain(&angular);
        let mut jacobian = Agreement::NotSent;
        for (row, ours) in robot.jacobian.iter().zip(rows) {
            self.jacobian_error = self.jacobian_error.larger((row - ours).amax());
            let row = judge(row.as_slice(), ours.as_slice(), JACOBIAN_TOLERANCE);
            jacobian = match (jacobian, row) {
                // A row of zeros is a row like any other once another one is sent.
                (Agreement::NotSent, row) => row,
                (all, Agreement::NotSent) => all,
                (all, row) => worse(all, row),
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
