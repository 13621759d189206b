//! Whether an arm can have its tables.

use core::fmt;

use crate::arm::limits::JointLimits;
use crate::arm::parameters::{ArmParameters, LinkParameters};
use crate::arm::pose::{Pose, distortion};
use crate::joint::{DOF, in_turn};
use crate::ranges::{
    ANGLE_MAX, DISTORTION_MAX, GRAVITY_MAX, JOINT_LIMIT_RANGE, MASS_MIN, POSITION_MARGIN,
};
use crate::real::Real;

/// Why parameter tables do not make a model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum ArmError {
    /// A number is infinite or NaN.
    NonFinite {
        /// Link (1..=7), 0 for the arm as a whole.
        link: usize,
        /// Name of the parameter.
        parameter: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must be above zero is not.
    NotPositive {
        /// Link (1..=7).
        link: usize,
        /// Name of the parameter.
        parameter: &'static str,
        /// The number.
        value: f64,
    },
    /// A number is outside what is allowed.
    OutOfRange {
        /// Link (1..=7), 0 for the arm as a whole.
        link: usize,
        /// Name of the parameter, with its unit.
        parameter: &'static str,
        /// The number.
        value: f64,
        /// What is allowed, from and to.
        allowed: [f64; 2],
    },
    /// The principal moments of inertia break the triangle inequality: no
    /// distribution of positive mass has this inertia. Then a mass matrix need
    /// not be positive definite.
    ImpossibleInertia {
        /// Link (1..=7), 0 for a tool.
        link: usize,
        /// Smallest leading minor of the matrix of second moments, normalised
        /// by its trace; must not be below 0.
        value: f64,
    },
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = |f: &mut fmt::Formatter<'_>, link: usize| match link {
            0 => write!(f, "arm: "),
            _ => write!(f, "link {link}: "),
        };
        match *self {
            Self::NonFinite {
                link,
                parameter,
                value,
            } => {
                place(f, link)?;
                write!(f, "{parameter} = {value}; it must be finite")
            }
            Self::NotPositive {
                link,
                parameter,
                value,
            } => {
                place(f, link)?;
                write!(f, "{parameter} = {value}; it must be above 0")
            }
            Self::OutOfRange {
                link,
                parameter,
                value,
                allowed: [min, max],
            } => {
                place(f, link)?;
                write!(f, "{parameter} = {value}; allowed {min} to {max}")
            }
            Self::ImpossibleInertia { link, value } => {
                match link {
                    0 => write!(f, "tool: ")?,
                    _ => place(f, link)?,
                }
                write!(
                    f,
                    "inertia gives a negative second moment of mass ({value:e} of its trace); it \
                     must be at least 0 (triangle inequality of the principal moments)"
                )
            }
        }
    }
}

impl core::error::Error for ArmError {}

/// Second moment of mass about the centre of mass, tr(I)/2 1 - I, of the inertia I in the order
/// of the tables.
pub(super) fn second_moment(inertia: &[f64; 6]) -> nalgebra::Matrix3<f64> {
    let [xx, xy, xz, yy, yz, zz] = *inertia;
    let half_trace = (xx + yy + zz) / 2.0;
    nalgebra::Matrix3::new(
        half_trace - xx,
        -xy,
        -xz,
        -xy,
        half_trace - yy,
        -yz,
        -xz,
        -yz,
        half_trace - zz,
    )
}

/// Checks every number of the tables.
pub(super) fn validate(arm: &ArmParameters) -> Result<(), ArmError> {
    let mut checks = Checks::NONE;
    checks.pose(&arm.base, ["base.rotation", "base.shift"]);
    checks.pose(&arm.flange, ["flange.rotation", "flange.shift"]);
    checks.finite("gravity", &arm.gravity);
    let [x, y, z] = arm.gravity;
    let gravity = (x * x + y * y + z * z).square_root();
    checks.within("gravity [m/s2]", gravity, [0.0, GRAVITY_MAX]);
    for i in in_turn::<DOF>(DOF) {
        checks.link = i + 1;
        checks.joint(&arm.links[i]);
    }
    if let Some(limits) = &arm.limits {
        checks.joint_limits(limits);
    }
    checks.result()
}

/// Numbers one after the other: of those that cannot be the first is kept.
pub(super) struct Checks {
    first: Option<ArmError>,
    /// Link (1..=7) of the numbers, 0 for the arm as a whole.
    link: usize,
}

impl Checks {
    /// Of the arm as a whole, none so far.
    pub const NONE: Self = Self {
        first: None,
        link: 0,
    };

    /// Ok where all of them can be.
    pub fn result(&self) -> Result<(), ArmError> {
        self.first.map_or(Ok(()), Err)
    }

    #[cold]
    #[inline(never)]
    fn add(&mut self, error: ArmError) {
        self.first = self.first.or(Some(error));
    }

    fn joint_limits(&mut self, limits: &JointLimits) {
        for i in in_turn::<DOF>(DOF) {
            self.link = i + 1;
            let [alpha, braking, gain] =
                [&limits.acceleration, &limits.braking, &limits.speed_gain].map(|of| of[i]);
            self.within("limits.acceleration [rad/s2]", alpha, JOINT_LIMIT_RANGE);
            self.within("limits.braking [rad/s2]", braking, JOINT_LIMIT_RANGE);
            self.within("limits.speed_gain [1/s]", gain, JOINT_LIMIT_RANGE);
        }
        self.link = 0;
        let gain = limits.position_gain;
        self.within("limits.position_gain [1/s]", gain, JOINT_LIMIT_RANGE);
        let allowed = [0.0, POSITION_MARGIN];
        self.within("limits.margin [rad]", limits.margin, allowed);
        self.within("limits.speed_share", limits.speed_share, [0.1, 1.0]);
    }

    /// Whether a pose of the arm has the axes of a frame.
    pub fn pose(&mut self, pose: &Pose, [rotation, shift]: [&'static str; 2]) {
        self.finite(shift, &pose.shift);
        self.finite(rotation, pose.rotation.as_flattened());
        let parameter = "distortion of a rotation of base, flange or tool";
        let value = distortion(&pose.rotation);
        self.within(parameter, value, [0.0, DISTORTION_MAX]);
    }

    fn joint(&mut self, link: &LinkParameters) {
        self.finite("a", &[link.a]);
        self.finite("alpha", &[link.alpha]);
        self.finite("d", &[link.d]);
        self.finite("angle_offset", &[link.angle_offset]);
        self.finite("com", &link.com);
        self.finite("inertia", &link.inertia);
        self.positive("mass", link.mass);
        self.positive("speed_limit", link.speed_limit);
        self.positive("torque_limit", link.torque_limit);
        self.positive("torque_rate_limit", link.torque_rate_limit);
        self.positive("brake_rate_limit", link.brake_rate_limit);
        self.positive("friction.smoothing", link.friction.smoothing);
        self.within("mass [kg]", link.mass, [MASS_MIN, f64::INFINITY]);
        self.not_negative("rotor_inertia [kg m2]", link.rotor_inertia);
        self.not_negative("friction.coulomb [Nm]", link.friction.coulomb);
        self.not_negative("friction.viscous [Nms/rad]", link.friction.viscous);
        let [min, max] = link.position_range;
        // Positions are believed up to a margin beyond the range.
        let farthest = ANGLE_MAX - POSITION_MARGIN;
        let [least, most] = [-farthest, farthest].map(|end| end - link.angle_offset);
        self.within("least position [rad]", min, [least, most]);
        self.within("greatest position [rad]", max, [min, most]);
        if let Some(approach) = &link.end_approach {
            self.finite("end_approach.ends", &approach.ends);
            self.not_negative("end_approach.margin", approach.margin);
            self.not_negative("end_approach.deceleration", approach.deceleration);
        }
        self.possible(&link.inertia);
    }

    /// Whether a body can have this inertia.
    pub fn possible(&mut self, inertia: &[f64; 6]) {
        let (link, value) = (self.link, smallest_minor(&second_moment(inertia)));
        // Identified bodies sit on the border of the feasible set: allow the
        // rounding of their printed numbers.
        if value < -1e-9 {
            self.add(ArmError::ImpossibleInertia { link, value });
        }
    }

    #[inline(never)]
    pub fn finite(&mut self, parameter: &'static str, values: &[f64]) {
        let link = self.link;
        if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
            self.add(ArmError::NonFinite {
                link,
                parameter,
                value,
            });
        }
    }

    #[inline(never)]
    fn positive(&mut self, parameter: &'static str, value: f64) {
        let link = self.link;
        self.finite(parameter, &[value]);
        if value <= 0.0 {
            self.add(ArmError::NotPositive {
                link,
                parameter,
                value,
            });
        }
    }

    #[inline(never)]
    fn not_negative(&mut self, parameter: &'static str, value: f64) {
        self.finite(parameter, &[value]);
        self.within(parameter, value, [0.0, f64::INFINITY]);
    }

    #[inline(never)]
    pub fn within(&mut self, parameter: &'static str, value: f64, allowed: [f64; 2]) {
        let (link, [least, most]) = (self.link, allowed);
        // False for NaN as well.
        let can_be = value >= least && value <= most;
        if !can_be {
            self.add(ArmError::OutOfRange {
                link,
                parameter,
                value,
                allowed,
            });
        }
    }
}

/// Smallest principal minor, each order normalised by the trace: not negative
/// if and only if the symmetric matrix is positive semidefinite.
fn smallest_minor(m: &nalgebra::Matrix3<f64>) -> f64 {
    let trace = m.trace();
    if trace <= 0.0 {
        return -1.0;
    }
    let s = m / trace;
    let minor = |i: usize, j: usize| s[(i, i)] * s[(j, j)] - s[(i, j)] * s[(i, j)];
    [
        s.m11,
        s.m22,
        s.m33,
        minor(0, 1),
        minor(0, 2),
        minor(1, 2),
        s.determinant(),
    ]
    .into_iter()
    .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::ArmModel;
    use crate::arm::test_arm::RODS;

    extern crate std;
    use std::string::ToString;

    #[test]
    fn the_rods_are_a_model_in_both_precisions() {
        assert!(ArmModel::<f64>::new(&RODS).is_ok());
        assert!(ArmModel::<f32>::new(&RODS).is_ok());
    }

    #[test]
    fn each_impossible_table_is_named() {
        let error = |change: fn(&mut ArmParameters)| {
            let mut arm = RODS;
            change(&mut arm);
            ArmModel::<f64>::new(&arm).unwrap_err().to_string()
        };
        assert_eq!(
            error(|arm| arm.links[3].mass = 0.0),
            "link 4: mass = 0; it must be above 0"
        );
        assert_eq!(
            error(|arm| arm.links[6].com[1] = f64::NAN),
            "link 7: com = NaN; it must be finite"
        );
        assert_eq!(
            error(|arm| arm.links[3].mass = 1e-7),
            "link 4: mass [kg] = 0.0000001; allowed 0.000001 to inf"
        );
        assert_eq!(
            error(|arm| arm.gravity = [0.0, 0.0, -31.0]),
            "arm: gravity [m/s2] = 31; allowed 0 to 30"
        );
        assert_eq!(
            error(|arm| arm.base.shift[2] = f64::INFINITY),
            "arm: base.shift = inf; it must be finite"
        );
        assert_eq!(
            error(|arm| arm.links[1].rotor_inertia = -0.1),
            "link 2: rotor_inertia [kg m2] = -0.1; allowed 0 to inf"
        );
        assert_eq!(
            error(|arm| arm.links[4].position_range = [0.5, -0.5]),
            "link 5: greatest position [rad] = -0.5; allowed 0.5 to 627.9185307179586"
        );
        // A hundred turns and a bit.
        assert_eq!(
            error(|arm| arm.links[6].position_range = [-629.0, 629.0]),
            "link 7: least position [rad] = -629; allowed -628.3185307179587 to 627.9185307179586"
        );
        // Stretched, and a mirror image.
        assert!(error(|arm| arm.base.rotation[0][0] = 1.0001).contains("distortion"));
        assert!(error(|arm| arm.flange.rotation[0][0] = -1.0).contains("distortion"));
        // A thin rod along z cannot have its largest moment about z.
        assert!(
            error(|arm| arm.links[0].inertia = [0.1, 0.0, 0.0, 0.1, 0.0, 0.3])
                .contains("triangle inequality")
        );
    }
}
