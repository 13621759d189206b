//! The arm: parameter tables as constants, and the validated model that the
//! algorithms read.
//!
//! Conventions. Frames follow the standard Denavit-Hartenberg table: frame i
//! moves with link i, axis z of frame i - 1 is the axis of joint i, frame 0 is
//! fixed at `base_height` above the mounting plate. Positions are expressed in
//! the base-plate frame, z up.

mod lwr_iv;

use core::fmt;

use crate::joint::{DOF, JointVector, Lanes, Vector3};
use crate::real::Real;

pub use lwr_iv::{LWR_IV, LWR_IV_POINTS};

/// A point of an arm with a name. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedPoint {
    /// Its name in scenario files.
    pub name: &'static str,
    /// Link that carries it, 1..=7.
    pub link: usize,
    /// Position \[m\] in the DH frame of that link.
    pub offset: [f64; 3],
}

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
pub enum ModelError {
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

impl fmt::Display for ModelError {
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

impl core::error::Error for ModelError {}

/// What a link does to what is carried over it: right angles of twist without a
/// length a only exchange axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twist(pub u8);

impl Twist {
    pub const NONE: u8 = 0;
    /// + 90 deg.
    pub const RIGHT: u8 = 1;
    /// - 90 deg.
    pub const LEFT: u8 = 2;
    pub const OTHER: u8 = 3;

    fn new(sine: f64, cosine: f64, a: f64) -> Self {
        let (zero, one) = (0.0, 1.0);
        Self(if a != zero {
            Self::OTHER
        } else if (sine, cosine) == (zero, one) {
            Self::NONE
        } else if (sine, cosine) == (one, zero) {
            Self::RIGHT
        } else if (sine, cosine) == (-one, zero) {
            Self::LEFT
        } else {
            Self::OTHER
        })
    }
}

/// One link as the algorithms read it.
///
/// Its moments are about the origin of the frame of its joint and in axes that
/// turn with the link, z along the joint ([`crate::spatial`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link<T: Real> {
    pub a: T,
    pub d: T,
    pub cos_alpha: T,
    pub sin_alpha: T,
    pub twist: Twist,
    /// Integral of (p, 1) (p, 1)^T dm by rows: the second moment S \[kg m2\] with the
    /// first moment h \[kg m\] behind and below it, and the mass \[kg\]. The inertia
    /// tensor is tr(S) 1 - S.
    pub moments: [Lanes<T>; 4],
}

/// A validated arm model. Immutable; shared by any number of controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel<T: Real> {
    pub(crate) links: [Link<T>; DOF],
    /// Before the first joint: no length, no twist, no mass.
    pub(crate) base: Link<T>,
    pub(crate) base_height: T,
    pub(crate) gravity: Vector3<T>,
    position_limit: JointVector<T>,
    speed_limit: JointVector<T>,
    torque_limit: JointVector<T>,
    parameters: ArmParameters,
}

impl<T: Real> ArmModel<T> {
    /// Checks the tables and prepares the model.
    ///
    /// # Errors
    /// [`ModelError`] names the first parameter that cannot be: a number that
    /// is not finite, a mass or limit that is not positive, an inertia that no
    /// body can have.
    pub fn new(parameters: &ArmParameters) -> Result<Self, ModelError> {
        match validate(parameters) {
            Ok(()) => Ok(Self::prepared(parameters)),
            Err(error) => Err(error),
        }
    }

    /// Behind a call, so that the model is built in the place of the result.
    #[inline(never)]
    fn prepared(parameters: &ArmParameters) -> Self {
        let column = |pick: fn(&LinkParameters) -> f64| {
            let mut values = parameters.links.iter().map(pick);
            JointVector::from_fn(|_, _| T::from_f64(values.next().unwrap_or(0.0)))
        };
        Self {
            links: core::array::from_fn(|i| match parameters.links.get(i) {
                Some(link) => Link::new(link),
                None => Link::fixed(),
            }),
            base: Link::fixed(),
            base_height: T::from_f64(parameters.base_height),
            gravity: vector(parameters.gravity),
            position_limit: column(|link| link.position_limit),
            speed_limit: column(|link| link.speed_limit),
            torque_limit: column(|link| link.torque_limit),
            parameters: *parameters,
        }
    }

    /// Largest |q| \[rad\] per joint.
    #[must_use]
    pub fn position_limit(&self) -> &JointVector<T> {
        &self.position_limit
    }

    /// Largest |dq| of the data sheet \[rad/s\] per joint.
    #[must_use]
    pub fn speed_limit(&self) -> &JointVector<T> {
        &self.speed_limit
    }

    /// Largest |torque| \[Nm\] per joint.
    #[must_use]
    pub fn torque_limit(&self) -> &JointVector<T> {
        &self.torque_limit
    }

    /// The tables this model was made from.
    #[must_use]
    pub fn parameters(&self) -> &ArmParameters {
        &self.parameters
    }
}

impl<T: Real> Link<T> {
    fn new(link: &LinkParameters) -> Self {
        // Right angles are exact here, so that zeros of the geometry stay zeros.
        let (sin_alpha, cos_alpha) = link.alpha.sine_cosine();
        let exact = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
        let (sin_alpha, cos_alpha) = (exact(sin_alpha), exact(cos_alpha));
        let turn = nalgebra::Matrix3::new(
            1.0, 0.0, 0.0, 0.0, cos_alpha, -sin_alpha, 0.0, sin_alpha, cos_alpha,
        );
        let com =
            turn * nalgebra::Vector3::from(link.com) + nalgebra::Vector3::new(link.a, 0.0, link.d);
        let s = turn * second_moment(link) * turn.transpose() + com * com.transpose() * link.mass;
        let h = com * link.mass;
        Self {
            a: T::from_f64(link.a),
            d: T::from_f64(link.d),
            cos_alpha: T::from_f64(cos_alpha),
            sin_alpha: T::from_f64(sin_alpha),
            twist: Twist::new(sin_alpha, cos_alpha, link.a),
            moments: [
                Lanes::from([s.m11, s.m12, s.m13, h.x].map(T::from_f64)),
                Lanes::from([s.m12, s.m22, s.m23, h.y].map(T::from_f64)),
                Lanes::from([s.m13, s.m23, s.m33, h.z].map(T::from_f64)),
                Lanes::from([h.x, h.y, h.z, link.mass].map(T::from_f64)),
            ],
        }
    }

    fn fixed() -> Self {
        let zero = T::ZERO;
        Self {
            a: zero,
            d: zero,
            cos_alpha: T::ONE,
            sin_alpha: zero,
            twist: Twist(Twist::NONE),
            moments: [Lanes::from([zero; 4]); 4],
        }
    }
}

fn vector<T: Real>(values: [f64; 3]) -> Vector3<T> {
    Vector3::from(values.map(T::from_f64))
}

/// Second moment of mass about the centre of mass: tr(I)/2 1 - I.
fn second_moment(link: &LinkParameters) -> nalgebra::Matrix3<f64> {
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

fn validate(arm: &ArmParameters) -> Result<(), ModelError> {
    let finite =
        |link, parameter, values: &[f64]| match values.iter().find(|value| !value.is_finite()) {
            Some(&value) => Err(ModelError::NonFinite {
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
        ] {
            finite(number, parameter, &[value])?;
            if value <= 0.0 {
                return Err(ModelError::NotPositive {
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
            return Err(ModelError::ImpossibleInertia {
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

    extern crate std;
    use std::string::ToString;

    #[test]
    fn the_lwr_is_a_model_in_both_precisions() {
        assert!(ArmModel::<f64>::new(&LWR_IV).is_ok());
        assert!(ArmModel::<f32>::new(&LWR_IV).is_ok());
    }

    #[test]
    fn each_impossible_table_is_named() {
        let error = |change: fn(&mut ArmParameters)| {
            let mut arm = LWR_IV;
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
