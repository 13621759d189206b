//! The validated arm, as the algorithms read it.

use crate::arm::exchange::AxisExchange;
use crate::arm::parameters::{ArmError, ArmParameters, LinkParameters, second_moment, validate};
use crate::joint::{DOF, JointVector, Lanes, Vector3};
use crate::real::Real;

/// One link as the algorithms read it.
///
/// Its moments are about the origin of the frame of its joint and in axes that
/// turn with the link, z along the joint ([`super::transform`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinkModel<T: Real> {
    pub a: T,
    pub d: T,
    pub cos_alpha: T,
    pub sin_alpha: T,
    pub exchange: AxisExchange,
    /// Integral of (p, 1) (p, 1)^T dm by rows: the second moment S \[kg m2\] with the
    /// first moment h \[kg m\] behind and below it, and the mass \[kg\]. The inertia
    /// tensor is tr(S) 1 - S.
    pub moments: [Lanes<T>; 4],
}

/// A validated arm model. Immutable; shared by any number of controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel<T: Real> {
    pub(crate) links: [LinkModel<T>; DOF],
    /// Before the first joint: no length, no twist, no mass.
    pub(crate) base: LinkModel<T>,
    pub(crate) base_height: T,
    pub(crate) gravity: Vector3<T>,
    position_limit: JointVector<T>,
    speed_limit: JointVector<T>,
    torque_limit: JointVector<T>,
    torque_rate_limit: JointVector<T>,
    brake_rate_limit: JointVector<T>,
    parameters: ArmParameters,
}

impl<T: Real> ArmModel<T> {
    /// Checks the tables and prepares the model.
    ///
    /// # Errors
    /// [`ArmError`] names the first parameter that cannot be: a number that
    /// is not finite, a mass or limit that is not positive, an inertia that no
    /// body can have.
    pub fn new(parameters: &ArmParameters) -> Result<Self, ArmError> {
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
                Some(link) => LinkModel::new(link),
                None => LinkModel::fixed(),
            }),
            base: LinkModel::fixed(),
            base_height: T::from_f64(parameters.base_height),
            gravity: vector(parameters.gravity),
            position_limit: column(|link| link.position_limit),
            speed_limit: column(|link| link.speed_limit),
            torque_limit: column(|link| link.torque_limit),
            torque_rate_limit: column(|link| link.torque_rate_limit),
            brake_rate_limit: column(|link| link.brake_rate_limit),
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

    /// Largest |change of torque| while the law runs \[Nm/s\] per joint.
    #[must_use]
    pub fn torque_rate_limit(&self) -> &JointVector<T> {
        &self.torque_rate_limit
    }

    /// The same while the arm is braked after a fault \[Nm/s\].
    #[must_use]
    pub fn brake_rate_limit(&self) -> &JointVector<T> {
        &self.brake_rate_limit
    }

    /// The tables this model was made from.
    #[must_use]
    pub fn parameters(&self) -> &ArmParameters {
        &self.parameters
    }
}

impl<T: Real> LinkModel<T> {
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
            exchange: AxisExchange::new(sin_alpha, cos_alpha, link.a),
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
            exchange: AxisExchange(AxisExchange::NONE),
            moments: [Lanes::from([zero; 4]); 4],
        }
    }
}

fn vector<T: Real>(values: [f64; 3]) -> Vector3<T> {
    Vector3::from(values.map(T::from_f64))
}
