//! The validated arm, as the algorithms read it.

use crate::arm::check::{ArmError, second_moment, validate};
use crate::arm::exchange::AxisExchange;
use crate::arm::link::LinkPoint;
use crate::arm::parameters::{ArmParameters, LinkParameters};
use crate::cells::Cells;
use crate::joint::{DOF, JointVector, Lanes, Padded, Vector3, in_turn, padded, zeros};
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
    /// Axes x, y, z of frame 0, base-plate axes, and its origin \[m\].
    pub(crate) base_axes: [Vector3<T>; 3],
    pub(crate) base_shift: Vector3<T>,
    /// Gravitational acceleration \[m/s2\], axes of frame 0.
    pub(crate) gravity: Vector3<T>,
    /// q at which the DH angles are 0 \[rad\].
    pub(crate) zero_angle: Padded<T>,
    /// \[kg m2\].
    pub(crate) rotor_inertia: JointVector<T>,
    position_range: [JointVector<T>; 2],
    speed_limit: JointVector<T>,
    torque_limit: JointVector<T>,
    torque_rate_limit: JointVector<T>,
    brake_rate_limit: JointVector<T>,
    pub(crate) damping_postures: &'static [[f64; DOF]],
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
        let mut columns: [JointVector<T>; 8] = [zeros(); 8];
        for i in in_turn::<DOF>(DOF) {
            let link = &parameters.links[i];
            let [least, greatest] = link.position_range;
            let numbers = [
                -link.angle_offset,
                link.rotor_inertia,
                least,
                greatest,
                link.speed_limit,
                link.torque_limit,
                link.torque_rate_limit,
                link.brake_rate_limit,
            ];
            for (column, number) in columns.iter_mut().zip(numbers) {
                column[i] = T::from_f64(number);
            }
        }
        let [zero_angle, rotor_inertia, least, greatest, columns @ ..] = columns;
        let [
            speed_limit,
            torque_limit,
            torque_rate_limit,
            brake_rate_limit,
        ] = columns;
        // nalgebra takes columns.
        let base = nalgebra::Matrix3::from(parameters.base.rotation).transpose();
        Self {
            links: core::array::from_fn(|i| match parameters.links.get(i) {
                Some(link) => LinkModel::new(link),
                None => LinkModel::fixed(),
            }),
            base: LinkModel::fixed(),
            base_axes: [
                base.column(0).map(T::from_f64),
                base.column(1).map(T::from_f64),
                base.column(2).map(T::from_f64),
            ],
            base_shift: vector(parameters.base.shift),
            gravity: base
                .tr_mul(&nalgebra::Vector3::from(parameters.gravity))
                .map(T::from_f64),
            zero_angle: padded(&zero_angle),
            rotor_inertia,
            position_range: [least, greatest],
            speed_limit,
            torque_limit,
            torque_rate_limit,
            brake_rate_limit,
            damping_postures: parameters.damping_postures,
        }
    }

    /// The shoulder \[m\], base-plate frame: the foot of link 1's frame on the axis of joint 1,
    /// which no joint moves.
    #[must_use]
    pub fn shoulder(&self) -> Vector3<T> {
        let [_, _, axis] = &self.base_axes;
        let [first, ..] = &self.links;
        self.base_shift + axis * first.d
    }

    /// Farthest that `point` can be from the shoulder \[m\]: all lengths between, in one line.
    #[must_use]
    pub fn reach(&self, point: &LinkPoint) -> T {
        let [first, links @ ..] = &self.links;
        let mut reach = first.a.magnitude();
        for link in links.iter().take(point.link.number() - 1) {
            reach += (link.a * link.a + link.d * link.d).square_root();
        }
        let offset = Vector3::from(point.offset.map(T::from_f64));
        reach + offset.dot(&offset).square_root()
    }

    /// What may differ from arm to arm of a kind: the body of the last link with what it carries,
    /// by S (xx, xy, xz, yy, yz, zz), h and the mass, and the limits.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        if let Some(last) = self.links.last_mut() {
            let [x, y, z, one] = last.moments;
            let mut body = [
                x[0], x[1], x[2], y[1], y[2], z[2], one[0], one[1], one[2], one[3],
            ];
            cells.numbers("last_link", &mut body);
            let [xx, xy, xz, yy, yz, zz, hx, hy, hz, mass] = body;
            last.moments = [
                Lanes::from([xx, xy, xz, hx]),
                Lanes::from([xy, yy, yz, hy]),
                Lanes::from([xz, yz, zz, hz]),
                Lanes::from([hx, hy, hz, mass]),
            ];
        }
        let [least, greatest] = &mut self.position_range;
        cells.numbers("least_position", least.as_mut_slice());
        cells.numbers("greatest_position", greatest.as_mut_slice());
        cells.numbers("speed_limit", self.speed_limit.as_mut_slice());
        cells.numbers("torque_limit", self.torque_limit.as_mut_slice());
    }

    /// Smallest and largest q \[rad\] per joint.
    #[must_use]
    pub fn position_range(&self) -> &[JointVector<T>; 2] {
        &self.position_range
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
        let turned = product(&turn, &second_moment(&link.inertia));
        let s = product(&turned, &turn.transpose()) + com * com.transpose() * link.mass;
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

/// a b. Behind a call: it is in the flash once.
#[inline(never)]
fn product(a: &nalgebra::Matrix3<f64>, b: &nalgebra::Matrix3<f64>) -> nalgebra::Matrix3<f64> {
    a * b
}

fn vector<T: Real>(values: [f64; 3]) -> Vector3<T> {
    Vector3::from(values.map(T::from_f64))
}
