//! The tables of an arm as plain data, and the check that an arm can have them.

use core::fmt;

use crate::joint::DOF;

/// Tables of one link and of the joint that moves it. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkParameters {
    /// DH length a \[m\], along the new x axis.
    pub a: f64,
    /// DH twist alpha \[rad\], about the new x axis.
    pub alpha: f64,
    /// DH offset d \[m\], along the joint axis.
    pub d: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\], in the link's own DH frame.
    pub com: [f64; 3],
    /// Inertia about the centre of mass \[kg m2\], axes of the link's own DH
    /// frame, in the order Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
    /// Largest |q| \[rad\]; the range is symmetric.
    pub position_limit: f64,
    /// Largest |dq| of the data sheet \[rad/s\].
    pub speed_limit: f64,
    /// Largest |torque| \[Nm\].
    pub torque_limit: f64,
    /// Largest change of the torque while the law runs \[Nm/s\]: a net below what the drives
    /// and gears can take, above what motion and contact need.
    pub torque_rate_limit: f64,
    /// The same while the arm is braked after a fault \[Nm/s\].
    pub brake_rate_limit: f64,
}

/// Tables of a 7-joint arm. Plain `f64` data, usable as a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmParameters {
    /// Short name, as in scenario files.
    pub name: &'static str,
    /// Height of frame 0 above the mounting plate \[m\].
    pub base_height: f64,
    /// Distance of the flange from the origin of frame 7 along z7 \[m\].
    pub flange: f64,
    /// Gravitational acceleration \[m/s2\], base-plate axes.
    pub gravity: [f64; 3],
    /// The links, base to flange.
    pub links: [LinkParameters; DOF],
}

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
    /// The principal moments of inertia break the triangle inequality: no
    /// distribution of positive mass has this inertia. Then a mass matrix need
    /// not be positive definite.
    ImpossibleInertia {
        /// Link (1..=7).
        link: usize,
        /// Smallest leading minor of the matrix of second moments, normalised
        /// by its trace; must not be below 0.
        value: f64,
    },
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NonFinite {
                link,
                parameter,
                value,
            } => {
                write!(f, "link {link}: {parameter} = {value}; it must be finite")
            }
            Self::NotPositive {
                link,
                parameter,
                value,
            } => {
                write!(f, "link {link}: {parameter} = {value}; it must be above 0")
            }
            Self::ImpossibleInertia { link, value } => write!(
                f,
                "link {link}: inertia gives a negative second moment of mass ({value:e} of its \
                 trace); it must be at least 0 (triangle inequality of the principal moments)"
            ),
        }
    }
}

impl core::error::Error for ArmError {}

/// Second moment of mass about the centre of mass: tr(I)/2 1 - I.
pub(super) fn second_moment(link: &LinkParameters) -> nalgebra::Matrix3<f64> {
    let [xx, xy, xz, yy, yz, zz] = link.inertia;
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
    let finite =
        |link, parameter, values: &[f64]| match values.iter().find(|value| !value.is_finite()) {
            Some(&value) => Err(ArmError::NonFinite {
                link,
                parameter,
                value,
            }),
            None => Ok(()),
        };
    finite(0, "base_height", &[arm.base_height])?;
    finite(0, "flange", &[arm.flange])?;
    finite(0, "gravity", &arm.gravity)?;
    for (number, link) in (1..).zip(&arm.links) {
        finite(number, "a", &[link.a])?;
        finite(number, "alpha", &[link.alpha])?;
        finite(number, "d", &[link.d])?;
        finite(number, "com", &link.com)?;
        finite(number, "inertia", &link.inertia)?;
        for (parameter, value) in [
            ("mass", link.mass),
            ("position_limit", link.position_limit),
            ("speed_limit", link.speed_limit),
            ("torque_limit", link.torque_limit),
            ("torque_rate_limit", link.torque_rate_limit),
            ("brake_rate_limit", link.brake_rate_limit),
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
        let value = smallest_minor(&second_moment(link));
        // Identified bodies sit on the border of the feasible set: allow the
        // rounding of their printed numbers.
        if value < -1e-9 {
            return Err(ArmError::ImpossibleInertia {
                link: number,
                value,
            });
        }
    }
    Ok(())
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
        // A thin rod along z cannot have its largest moment about z.
        assert!(
            error(|arm| arm.links[0].inertia = [0.1, 0.0, 0.0, 0.1, 0.0, 0.3])
                .contains("triangle inequality")
        );
    }
}
