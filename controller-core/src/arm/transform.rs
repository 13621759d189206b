//! From one joint frame to the next.
//!
//! The *joint frame* i has its origin at that of DH frame i and its z axis along
//! joint i + 1, and turns with the link behind that joint. There a joint's own
//! axis is (0, 0, 1), so that most products with it are only a choice of entries.
//! From joint frame i + 1 to joint frame i leads the angle of that joint, about z,
//! then the twist of the link between, about x, then the shift between the origins,
//! (a, 0, d).

use core::ops::{Add, Mul, Neg, Sub};

use crate::arm::exchange::AxisExchange;
use crate::arm::model::LinkModel;
use crate::real::Real;

/// What turns as a coordinate does: a number, or a column of a matrix.
pub(crate) trait Entry<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> + Mul<T, Output = Self>
{
}
impl<T, E> Entry<T> for E where
    E: Copy + Add<Output = E> + Sub<Output = E> + Neg<Output = E> + Mul<T, Output = E>
{
}

/// Rotation about z by the angle whose sine and cosine are given.
#[inline(always)]
fn rotate_about_z<T: Copy, E: Entry<T>>([x, y, z]: [E; 3], sine: T, cosine: T) -> [E; 3] {
    [x * cosine - y * sine, x * sine + y * cosine, z]
}

/// Rotation about x by the twist of `link`, whose class is `EXCHANGE`.
#[inline(always)]
fn rotate_about_x<T: Real, E: Entry<T>, const EXCHANGE: u8>(
    [x, y, z]: [E; 3],
    link: &LinkModel<T>,
) -> [E; 3] {
    match AxisExchange::turn(EXCHANGE) {
        AxisExchange::NONE => [x, y, z],
        AxisExchange::RIGHT => [x, -z, y],
        AxisExchange::LEFT => [x, z, -y],
        _ => {
            let (sine, cosine) = (link.sin_alpha, link.cos_alpha);
            [x, y * cosine - z * sine, y * sine + z * cosine]
        }
    }
}

/// The transform between one joint frame and the next one towards the base.
#[derive(Clone, Copy)]
pub(crate) struct JointTransform<'a, T: Real> {
    /// Sine and cosine of the outer joint's angle.
    pub sine: T,
    pub cosine: T,
    /// The link between the joints.
    pub link: &'a LinkModel<T>,
}

/// Calls a function with the exchange of axes of a transform's link as constant, so
/// that one branch serves all that is carried.
macro_rules! by_exchange {
    ($object:expr, $function:ident, $transform:expr) => {
        match $transform.link.exchange.0 {
            AxisExchange::NONE => $object.$function::<{ AxisExchange::NONE }>($transform),
            AxisExchange::RIGHT => $object.$function::<{ AxisExchange::RIGHT }>($transform),
            AxisExchange::LEFT => $object.$function::<{ AxisExchange::LEFT }>($transform),
            AxisExchange::RIGHT_WITH_LENGTH => {
                $object.$function::<{ AxisExchange::RIGHT_WITH_LENGTH }>($transform)
            }
            AxisExchange::LEFT_WITH_LENGTH => {
                $object.$function::<{ AxisExchange::LEFT_WITH_LENGTH }>($transform)
            }
            _ => $object.$function::<{ AxisExchange::OTHER }>($transform),
        }
    };
}
pub(crate) use by_exchange;

impl<T: Real> JointTransform<'_, T> {
    /// A vector of the outer joint frame in axes of the inner one.
    #[inline(always)]
    pub fn in_parent<E: Entry<T>, const EXCHANGE: u8>(&self, v: [E; 3]) -> [E; 3] {
        rotate_about_x::<T, E, EXCHANGE>(rotate_about_z(v, self.sine, self.cosine), self.link)
    }

    /// A vector of the inner joint frame in axes of the outer one.
    #[inline(always)]
    pub fn in_child<const EXCHANGE: u8>(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        let (sine, cosine) = (self.link.sin_alpha, self.link.cos_alpha);
        let back = match AxisExchange::turn(EXCHANGE) {
            AxisExchange::NONE => [x, y, z],
            AxisExchange::RIGHT => [x, z, -y],
            AxisExchange::LEFT => [x, -z, y],
            _ => [x, y * cosine + z * sine, z * cosine - y * sine],
        };
        rotate_about_z(back, -self.sine, self.cosine)
    }
}
