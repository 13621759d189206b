//! The scalar that records what is done with it.

use std::cmp::Ordering;
use std::fmt;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};

use controller_core::real::Real;
use nalgebra::{Field, SimdValue};

use crate::tape::{Condition, NumberId, Operation, with};

/// A number of the tape. As [`Real`] it runs the generic cycle, which writes itself down thereby.
#[derive(Clone, Copy)]
pub struct Recorded(pub NumberId);

impl Recorded {
    fn of(operation: Operation) -> Self {
        Self(with(|tape| tape.record(operation)))
    }

    /// As a comparison decides on the present path.
    fn decided(condition: Condition) -> bool {
        with(|tape| {
            let flag = tape.compare(condition);
            tape.decide(flag)
        })
    }
}

impl fmt::Debug for Recorded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

impl fmt::Display for Recorded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

impl Default for Recorded {
    fn default() -> Self {
        Self::ZERO
    }
}

macro_rules! arithmetic {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $operation:ident;)*) => {
        $(
            impl $operator for Recorded {
                type Output = Self;
                fn $method(self, other: Self) -> Self {
                    Self::of(Operation::$operation(self.0, other.0))
                }
            }
            impl $assign for Recorded {
                fn $assign_method(&mut self, other: Self) {
                    *self = Self::of(Operation::$operation(self.0, other.0));
                }
            }
        )*
    };
}
arithmetic! {
    Add add AddAssign add_assign Add;
    Sub sub SubAssign sub_assign Subtract;
    Mul mul MulAssign mul_assign Multiply;
    Div div DivAssign div_assign Divide;
}

impl Rem for Recorded {
    type Output = Self;
    fn rem(self, _: Self) -> Self {
        unreachable!("a cycle takes no remainders")
    }
}

impl RemAssign for Recorded {
    fn rem_assign(&mut self, other: Self) {
        *self = *self % other;
    }
}

impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        Self::of(Operation::Negate(self.0))
    }
}

impl PartialEq for Recorded {
    fn eq(&self, other: &Self) -> bool {
        Self::decided(Condition::Equal(self.0, other.0))
    }
}

impl PartialOrd for Recorded {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match (self < other, self > other, self == other) {
            (true, ..) => Some(Ordering::Less),
            (_, true, _) => Some(Ordering::Greater),
            (.., true) => Some(Ordering::Equal),
            _ => None,
        }
    }
    fn lt(&self, other: &Self) -> bool {
        Self::decided(Condition::Below(self.0, other.0))
    }
    fn le(&self, other: &Self) -> bool {
        Self::decided(Condition::AtMost(self.0, other.0))
    }
    fn gt(&self, other: &Self) -> bool {
        other < self
    }
    fn ge(&self, other: &Self) -> bool {
        other <= self
    }
}

impl num_traits::Zero for Recorded {
    fn zero() -> Self {
        Self::ZERO
    }
    fn is_zero(&self) -> bool {
        *self == Self::ZERO
    }
}

impl num_traits::One for Recorded {
    fn one() -> Self {
        Self::ONE
    }
}

impl num_traits::Num for Recorded {
    type FromStrRadixErr = num_traits::ParseFloatError;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::from_f64)
    }
}

#[allow(unsafe_code)]
impl SimdValue for Recorded {
    const LANES: usize = 1;
    type Element = Self;
    type SimdBool = bool;

    fn splat(value: Self) -> Self {
        value
    }
    fn extract(&self, _: usize) -> Self {
        *self
    }
    // SAFETY: there is one lane, whatever is asked for; nothing is read beyond it.
    unsafe fn extract_unchecked(&self, _: usize) -> Self {
        *self
    }
    fn replace(&mut self, _: usize, value: Self) {
        *self = value;
    }
    // SAFETY: as above.
    unsafe fn replace_unchecked(&mut self, _: usize, value: Self) {
        *self = value;
    }
    fn select(self, condition: bool, other: Self) -> Self {
        if condition { self } else { other }
    }
}

impl Field for Recorded {}

/// Upper half of a NaN that carries a recorded number in its lower half: what a fault says of a
/// number passes through `f64`.
const CARRIER: u64 = 0x7ff8_5354_0000_0000;

/// The recorded number that a `f64` of a fault carries, or that it is.
pub fn carried(value: f64) -> Recorded {
    let bits = value.to_bits();
    if bits & 0xffff_ffff_0000_0000 == CARRIER {
        Recorded(bits as u32)
    } else {
        Recorded(with(|tape| tape.constant(value)))
    }
}

impl Real for Recorded {
    const ZERO: Self = Self(0);
    const ONE: Self = Self(1);
    const HALF: Self = Self(2);
    const INFINITE: Self = Self(3);
    const PIVOT_SHARE: Self = Self(4);

    fn from_f64(value: f64) -> Self {
        carried(value)
    }
    fn to_f64(self) -> f64 {
        with(|tape| tape.constant_of(self.0))
            .unwrap_or_else(|| f64::from_bits(CARRIER | u64::from(self.0)))
    }
    fn square_root(self) -> Self {
        Self::of(Operation::SquareRoot(self.0))
    }
    fn sine_cosine(self) -> (Self, Self) {
        (
            Self::of(Operation::Sine(self.0)),
            Self::of(Operation::Cosine(self.0)),
        )
    }
    fn exp_negative(self) -> Self {
        Self::of(Operation::ExpNegative(self.0))
    }
    fn floor_small(self) -> Self {
        match with(|tape| tape.constant_of(self.0)) {
            Some(value) => Self::from_f64(Real::floor_small(value)),
            None => unreachable!("a cycle rounds nothing but constants"),
        }
    }
    fn magnitude(self) -> Self {
        Self::of(Operation::Magnitude(self.0))
    }
    fn with_sign_of(self, sign: Self) -> Self {
        Self::of(Operation::WithSign(self.0, sign.0))
    }
    fn finite(self) -> bool {
        // x - x is 0 of every number, else NaN.
        Self::of(Operation::Subtract(self.0, self.0)) == Self::ZERO
    }
    fn most(self, other: Self) -> Self {
        Self::of(Operation::Most(self.0, other.0))
    }
    fn least(self, other: Self) -> Self {
        Self::of(Operation::Least(self.0, other.0))
    }
    fn choose_below(self, other: Self, below: Self, otherwise: Self) -> Self {
        Self::of(Operation::Choose([self.0, other.0, below.0, otherwise.0]))
    }
}
