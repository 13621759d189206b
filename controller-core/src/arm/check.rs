//! Whether an arm can have its tables.

use core::fmt;

use crate::arm::limits::JointLimits;
use crate::arm::parameters::{ArmParameters, LinkParameters};
use crate::arm::pose::{Pose, distortion};
use crate::ranges::{
    ANGLE_MAX, DISTORTION_MAX, GRAVITY_MAX, JOINT_LIMIT_RANGE, MASS_MIN, POSITION_MARGIN,
};

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
    pose(&arm.base, ["base.rotation", "base.shift"])?;
    pose(&arm.flange, ["flange.rotation", "flange.shift"])?;
    finite(0, "gravity", &arm.gravity)?;
    let [x, y, z] = arm.gravity;
    let gravity = libm::sqrt(x * x + y * y + z * z);
    within(0, "gravity [m/s2]", gravity, [0.0, GRAVITY_MAX])?;
    (1..)
        .zip(&arm.links)
        .try_for_each(|(number, link)| joint(number, link))?;
    match &arm.limits {
        Some(limits) => joint_limits(limits),
        None => Ok(()),
    }
}

fn joint_limits(limits: &JointLimits) -> Result<(), ArmError> {
    for (parameter, values) in [
        ("limits.acceleration [rad/s2]", &limits.acceleration),
        ("limits.braking [rad/s2]", &limits.braking),
        ("limits.speed_gain [1/s]", &limits.speed_gain),
    ] {
        for (number, &value) in (1..).zip(values) {
            within(number, parameter, value, JOINT_LIMIT_RANGE)?;
        }
    }
    let (gain, [least, most]) = (limits.position_gain, JOINT_LIMIT_RANGE);
    within(0, "limits.position_gain [1/s]", gain, [least, most])?;
    within(
        0,
        "limits.margin [rad]",
        limits.margin,
        [0.0, POSITION_MARGIN],
    )?;
    within(0, "limits.speed_share", limits.speed_share, [0.1, 1.0])
}

/// Whether a pose of the arm has the axes of a frame.
pub(super) fn pose(pose: &Pose, [rotation, shift]: [&'static str; 2]) -> Result<(), ArmError> {
    finite(0, shift, &pose.shift)?;
    finite(0, rotation, pose.rotation.as_flattened())?;
    let allowed = [0.0, DISTORTION_MAX];
    within(
        0,
        "distortion of a rotation of base, flange or tool",
        distortion(&pose.rotation),
        allowed,
    )
}

fn joint(number: usize, link: &LinkParameters) -> Result<(), ArmError> {
    for (parameter, value) in [
        ("a", link.a),
        ("alpha", link.alpha),
        ("d", link.d),
        ("angle_offset", link.angle_offset),
    ] {
        finite(number, parameter, &[value])?;
    }
    finite(number, "com", &link.com)?;
    finite(number, "inertia", &link.inertia)?;
    for (parameter, value) in [
        ("mass", link.mass),
        ("speed_limit", link.speed_limit),
        ("torque_limit", link.torque_limit),
        ("torque_rate_limit", link.torque_rate_limit),
        ("brake_rate_limit", link.brake_rate_limit),
        ("friction.smoothing", link.friction.smoothing),
    ] {
        finite(number, parameter, &[value])?;
        if value <= 0.0 {
            return Err(ArmError::NotPositive {
                link: number,
                parameter,
                value,
            });
        }
    }
    let unbounded = f64::INFINITY;
    within(number, "mass [kg]", link.mass, [MASS_MIN, unbounded])?;
    for (parameter, value) in [
        ("rotor_inertia [kg m2]", link.rotor_inertia),
        ("friction.coulomb [Nm]", link.friction.coulomb),
        ("friction.viscous [Nms/rad]", link.friction.viscous),
    ] {
        finite(number, parameter, &[value])?;
        within(number, parameter, value, [0.0, unbounded])?;
    }
    let [min, max] = link.position_range;
    // Positions are believed up to a margin beyond the range.
    let farthest = ANGLE_MAX - POSITION_MARGIN;
    let allowed = [-farthest - link.angle_offset, farthest - link.angle_offset];
    within(number, "least position [rad]", min, allowed)?;
    within(number, "greatest position [rad]", max, [min, allowed[1]])?;
    if let Some(approach) = &link.end_approach {
        finite(number, "end_approach.ends", &approach.ends)?;
        let numbers = [approach.margin, approach.deceleration];
        for (parameter, value) in ["end_approach.margin", "end_approach.deceleration"]
            .into_iter()
            .zip(numbers)
        {
            finite(number, parameter, &[value])?;
            within(number, parameter, value, [0.0, unbounded])?;
        }
    }
    possible(number, &link.inertia)
}

/// Whether a body can have this inertia.
pub(super) fn possible(link: usize, inertia: &[f64; 6]) -> Result<(), ArmError> {
    let value = smallest_minor(&second_moment(inertia));
    // Identified bodies sit on the border of the feasible set: allow the
    // rounding of their printed numbers.
    if value < -1e-9 {
        return Err(ArmError::ImpossibleInertia { link, value });
    }
    Ok(())
}

pub(super) fn finite(link: usize, parameter: &'static str, values: &[f64]) -> Result<(), ArmError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(ArmError::NonFinite {
            link,
            parameter,
            value,
        }),
        None => Ok(()),
    }
}

pub(super) fn within(
    link: usize,
    parameter: &'static str,
    value: f64,
    allowed: [f64; 2],
) -> Result<(), ArmError> {
    // False for NaN as well.
    if value >= allowed[0] && value <= allowed[1] {
        return Ok(());
    }
    Err(ArmError::OutOfRange {
        link,
        parameter,
        value,
        allowed,
    })
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
