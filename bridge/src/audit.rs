//! The robot's own model against the controller's: M, g and J arrive in every
//! measurement, and a wrong tool, a wrong sign or a wrong arm shows there before
//! it shows in the motion.

use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::arm::{ArmParameters, Pose};
use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{DOF, JointMatrix, JointVector, Vector3, zeros};
use controller_core::real::Real;
use controller_core::{Controller, Link, LinkPoint, Measurement, Reference};

/// Largest difference of gravity torques that counts as agreement \[Nm\].
pub const GRAVITY_TOLERANCE_NM: f64 = 3.0;

/// Largest difference of mass-matrix entries over the largest entry that counts
/// as agreement.
pub const MASS_TOLERANCE: f64 = 0.25;

/// Largest difference of Jacobian entries that counts as agreement, \[m\] and \[1\].
pub const JACOBIAN_TOLERANCE: f64 = 0.02;

/// Largest difference of an entry of the end effector's pose that counts as agreement, \[m\]
/// and \[1\].
pub const POSE_TOLERANCE: f64 = 0.005;

/// What the robot says about itself in a posture.
#[derive(Clone, Copy, Debug)]
pub struct RobotModel {
    /// Measured joint angles \[rad\].
    pub q: JointVector<f64>,
    /// Mass matrix \[kg m2\], of a robot that sends it.
    pub mass_matrix: Option<JointMatrix<f64>>,
    /// Gravity torque \[Nm\], of a robot that sends it.
    pub gravity: Option<JointVector<f64>>,
    /// Jacobian of the flange, rows x y z \[m\], then rotations about x y z \[1\], of a robot
    /// that sends it.
    pub jacobian: Option<[JointVector<f64>; 6]>,
    /// Where its end effector is, of a robot that says so.
    pub end_effector: Option<EndEffector>,
    /// Measured joint torque \[Nm\] at rest, of a robot that measures it behind the motors'
    /// friction: what holds arm, end effector and load. None in motion.
    pub holding: Option<JointVector<f64>>,
}

/// Where an end effector is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndEffector {
    /// In the base-plate frame \[m\].
    pub base: Pose,
    /// In the frame of the flange \[m\].
    pub flange: Pose,
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
    /// Pose of the end effector, where the robot says it.
    pub pose: Option<Agreement>,
    /// Largest difference of an entry, \[m\] or \[1\].
    pub pose_error: f64,
    /// Gravity torque against the torque measured at rest, where the robot measures it and
    /// was at rest.
    pub holding: Option<Agreement>,
    /// Largest difference \[Nm\].
    pub holding_nm: f64,
    /// The joint, 1..=7, where it occurred.
    pub holding_joint: usize,
}

impl Audit {
    /// Compares in one more posture; `flange` is the point of the robot's Jacobian, on `arm`.
    /// Behind a call, so that the controller's results are on the stack only meanwhile.
    #[inline(never)]
    pub fn compare(
        &mut self,
        controller: &Controller<f64>,
        arm: &ArmParameters,
        flange: &LinkPoint,
        robot: &RobotModel,
    ) {
        let mut data = Data::new();
        at_rest(controller, &robot.q, &mut data);
        self.samples = self.samples.saturating_add(1);
        self.compare_dynamics(&data.dynamics, robot);
        self.compare_jacobian(&data.kinematics, flange, robot.jacobian.as_ref());
        if let Some(end_effector) = &robot.end_effector {
            self.compare_pose(&data.kinematics, arm, end_effector);
        }
    }

    fn compare_dynamics(&mut self, ours: &Dynamics<f64>, robot: &RobotModel) {
        let (gravity, difference) = judge_torque(robot.gravity.as_ref(), &ours.gravity);
        self.gravity = worse(self.gravity, gravity);
        if let Some((joint, nm)) = difference.filter(|(_, nm)| *nm > self.gravity_nm) {
            (self.gravity_joint, self.gravity_nm) = (joint, nm);
        }
        if robot.holding.is_some() {
            let (holding, difference) = judge_torque(robot.holding.as_ref(), &ours.gravity);
            self.holding = Some(self.holding.map_or(holding, |known| worse(known, holding)));
            if let Some((joint, nm)) = difference.filter(|(_, nm)| *nm > self.holding_nm) {
                (self.holding_joint, self.holding_nm) = (joint, nm);
            }
        }

        let scale = ours.mass_matrix.amax();
        let Some(theirs) = &robot.mass_matrix else {
            self.mass = worse(self.mass, Agreement::NotSent);
            return;
        };
        let tolerance = MASS_TOLERANCE * scale;
        let mass = judge(theirs.as_slice(), ours.mass_matrix.as_slice(), tolerance);
        self.mass = worse(self.mass, mass);
        if mass != Agreement::NotSent {
            let share = (theirs - ours.mass_matrix).amax() / scale;
            self.mass_share = self.mass_share.most(share);
        }
    }

    fn compare_jacobian(
        &mut self,
        ours: &Kinematics<f64>,
        flange: &LinkPoint,
        theirs: Option<&[JointVector<f64>; 6]>,
    ) {
        let sent = |theirs: &&[JointVector<f64>; 6]| theirs.iter().any(|row| row.amax() > 0.0);
        let Some(theirs) = theirs.filter(sent) else {
            self.jacobian = worse(self.jacobian, Agreement::NotSent);
            return;
        };
        let motion = ours.point(flange.link, &Vector3::from(flange.offset));
        let linear = ours.point_jacobian(flange.link, &motion).jacobian;
        let angular = ours.angular_jacobian(flange.link).jacobian;
        let mut jacobian = Agreement::Agrees;
        for (row, ours) in theirs.iter().zip(linear.iter().chain(&angular)) {
            let error = (row - ours).amax();
            self.jacobian_error = self.jacobian_error.most(error);
            // One row of zeros is a row like any other.
            jacobian = match judge(row.as_slice(), ours.as_slice(), JACOBIAN_TOLERANCE) {
                Agreement::NotSent => worse(jacobian, Agreement::Differs),
                agreement => worse(jacobian, agreement),
            };
        }
        self.jacobian = worse(self.jacobian, jacobian);
    }

    fn compare_pose(
        &mut self,
        kinematics: &Kinematics<f64>,
        arm: &ArmParameters,
        theirs: &EndEffector,
    ) {
        let said = &theirs.base;
        let on_link = arm.flange.carrying(&theirs.flange);
        let at = |offset: [f64; 3]| {
            let offset = Vector3::from(on_link.place(offset));
            kinematics.point(Link::L7, &offset).x
        };
        let origin = at([0.0; 3]);
        let mut error = (origin - Vector3::from(said.shift)).amax();
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (axis, unit) in units.into_iter().enumerate() {
            let ours = at(unit) - origin;
            for (row, ours) in said.rotation.iter().zip(&ours) {
                let said = row.get(axis).copied().unwrap_or(0.0);
                error = error.most((said - ours).magnitude());
            }
        }
        let pose = match error <= POSE_TOLERANCE {
            true => Agreement::Agrees,
            false => Agreement::Differs,
        };
        self.pose = Some(self.pose.map_or(pose, |known| worse(known, pose)));
        self.pose_error = self.pose_error.most(error);
    }

    /// Whether nothing contradicts the controller's model.
    #[must_use]
    pub fn passes(&self) -> bool {
        let fine = |agreement| matches!(agreement, Agreement::Agrees | Agreement::NotSent);
        let both = [self.pose, self.holding];
        let fine_if_known = both.into_iter().flatten().all(fine);
        fine(self.gravity) && fine(self.mass) && fine(self.jacobian) && fine_if_known
    }
}

/// A torque of the robot against that of our gravity, and where it differs most: joint, 1..=7,
/// and by how much \[Nm\].
fn judge_torque(
    theirs: Option<&JointVector<f64>>,
    ours: &JointVector<f64>,
) -> (Agreement, Option<(usize, f64)>) {
    let Some(theirs) = theirs else {
        return (Agreement::NotSent, None);
    };
    let agreement = judge(theirs.as_slice(), ours.as_slice(), GRAVITY_TOLERANCE_NM);
    let mut most = None;
    for (joint, value) in (1..=DOF).zip(&(theirs - ours)) {
        let nm = value.magnitude();
        if most.is_none_or(|(_, known)| nm > known) {
            most = Some((joint, nm));
        }
    }
    (agreement, most.filter(|_| agreement != Agreement::NotSent))
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
            worst.most((a - sign * b).magnitude())
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
            mass_matrix: Some(data.dynamics.mass_matrix),
            gravity: Some(data.dynamics.gravity),
            jacobian: Some([x, y, z, rx, ry, rz]),
            end_effector: None,
            holding: None,
        };
        change(&mut robot);
        let mut audit = Audit::default();
        audit.compare(&controller, &LWR_IV, &LWR_IV_FLANGE, &robot);
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
            robot.gravity = Some(zeros());
            robot.mass_matrix = Some(JointMatrix::zeros());
            robot.jacobian = Some([zeros(); 6]);
        });
        assert!(audit.passes());
        let all = [audit.gravity, audit.mass, audit.jacobian];
        assert_eq!(all, [Agreement::NotSent; 3]);
        assert_eq!((audit.gravity_nm, audit.mass_share), (0.0, 0.0));
    }

    #[test]
    fn a_wrong_sign_a_tool_and_a_wrong_order_are_found() {
        let sign = audit(|robot| robot.gravity = robot.gravity.map(|gravity| -gravity));
        assert_eq!(sign.gravity, Agreement::OppositeSign);
        let tool = audit(|robot| {
            robot
                .gravity
                .iter_mut()
                .for_each(|gravity| gravity[1] -= 5.0)
        });
        assert_eq!((tool.gravity, tool.gravity_joint), (Agreement::Differs, 2));
        assert!((tool.gravity_nm - 5.0).abs() < 1e-12);
        // Joints in the order of the robot's program: the third axis last.
        let order = audit(|robot| {
            for row in robot.jacobian.iter_mut().flatten() {
                let third = row[2];
                *row = row.remove_row(2).insert_row(6, third);
            }
        });
        assert_eq!(order.jacobian, Agreement::Differs);
        let heavy = audit(|robot| robot.mass_matrix.iter_mut().for_each(|mass| *mass *= 1.5));
        assert_eq!(heavy.mass, Agreement::Differs);
        assert!(![sign, tool, order, heavy].iter().any(Audit::passes));
    }
}
