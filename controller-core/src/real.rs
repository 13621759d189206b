//! The scalar: `f32` or `f64`, chosen by a type parameter, with the four
//! elementary functions the cycle needs.
//!
//! Every operation is an IEEE-754 addition, multiplication, division or square
//! root in a fixed order, without branches on data and without contraction to
//! fused multiply-add. So the instruction count is constant, and the torque is
//! the same to the last bit on every machine that rounds to nearest.

use core::fmt::{Debug, Display};

/// A floating-point scalar of the controller: `f32` or `f64`.
///
/// The arithmetic comes from [`nalgebra::Field`], the order from `PartialOrd`.
/// nalgebra's `RealField` is left out on purpose: its `sqrt`, `sin` and `exp`
/// reach libm's routines, whose instruction count depends on the argument.
pub trait Real:
    nalgebra::Field + PartialOrd + Copy + Debug + Display + Default + Send + Sync + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// Larger than any number.
    const INFINITE: Self;
    /// Share of a pivot of a 7 x 7 elimination of ordinary condition that may be rounding.
    const PIVOT_SHARE: Self;

    /// Nearest value of this precision.
    fn from_f64(value: f64) -> Self;
    /// The value widened (exact).
    fn to_f64(self) -> f64;
    /// Square root, correctly rounded; NaN for negative input.
    fn square_root(self) -> Self;
    /// `(sin x, cos x)` for an angle `self` in rad, |x| <= 2 pi: within 1.5
    /// units in the last place. Up to 100 turns within epsilon |x|, which is how far
    /// neighbours of the angle are apart. Beyond, accuracy fades; there is no other
    /// harm, and a non-finite angle gives NaN.
    fn sine_cosine(self) -> (Self, Self);
    /// `exp(-x)` for `self` >= 0: within 2 units in the last place up to where
    /// the result leaves the normal numbers; there it stays at about 1e-304
    /// (`f64`) or 1e-37 (`f32`). Negative input and NaN count as 0.
    fn exp_negative(self) -> Self;
    /// Largest integer not above `self`, for |x| < 2^31.
    fn floor_small(self) -> Self;
    /// Absolute value.
    fn magnitude(self) -> Self;
    /// Absolute value of `self` with the sign of `sign`; zeros of either sign count as positive.
    fn with_sign_of(self, sign: Self) -> Self;
    /// Neither infinite nor NaN.
    fn finite(self) -> bool;
    /// The larger of two numbers: `other`, which is never NaN, where `self` is. Of two zeros either:
    /// one instruction on every machine, for what does not depend on the sign of a zero.
    fn most(self, other: Self) -> Self;
    /// The smaller one, likewise.
    fn least(self, other: Self) -> Self;

    /// `below` where `self` is less than `other`, else `otherwise`: a choice between two numbers
    /// that are both known, by which no path of the program depends on data.
    #[inline(always)]
    fn choose_below(self, other: Self, below: Self, otherwise: Self) -> Self {
        if self < other { below } else { otherwise }
    }

    /// `self` limited to `low..=high`; NaN stays NaN.
    fn limited(self, low: Self, high: Self) -> Self {
        let above = self.choose_below(low, low, self);
        high.choose_below(above, high, above)
    }
}

/// Square root by the FPU's instruction on a Cortex-M7, where libm's is software;
/// libm's elsewhere. Both round correctly, so the bits agree.
macro_rules! square_root {
    ($name:ident, $float:ident, $instruction:literal, $register:ident, $software:expr) => {
        #[inline(always)]
        fn $name(x: $float) -> $float {
            #[cfg(fpu)]
            #[allow(unsafe_code)]
            {
                let root: $float;
                // SAFETY: one register-to-register instruction; build.rs sets
                // the flag only where the target CPU has this FPU.
                unsafe {
                    core::arch::asm!($instruction, out($register) root, in($register) x,
                        options(pure, nomem, nostack, preserves_flags));
                }
                root
            }
            #[cfg(not(fpu))]
            $software(x)
        }
    };
}
square_root!(
    square_root_f64,
    f64,
    "vsqrt.f64 {0}, {1}",
    dreg_low16,
    libm::sqrt
);
square_root!(
    square_root_f32,
    f32,
    "vsqrt.f32 {0}, {1}",
    sreg,
    libm::sqrtf
);

/// One implementation per precision: same algorithm, constants of that precision.
///
/// Sine and cosine: x = k pi/2 + r with k = round(2 x / pi), |k| <= 4. pi/2 is
/// cut in three pieces, the first two short enough that k times them is exact;
/// the rest of the reduction is carried as a tail. Both minimax polynomials
/// are evaluated on |r| <= pi/4, then exchanged and signed by k without a branch.
///
/// Exponential: -x = k ln 2 + r, a polynomial in r, scaled by an exponent field.
macro_rules! real {
    ($float:ident, $bits:ident,
     round: $round:expr, pi_2: [$p1:expr, $p2:expr, $p3:expr],
     sin: [$($s:expr),+], cos: [$($c:expr),+],
     ln2: [$l1:expr, $l2:expr], exp: [$($e:expr),+],
     exp_range: $exp_range:expr, exponent_bias: $bias:expr, mantissa: $mantissa:expr,
     square_root: $sqrt:expr, pivot_share: $pivot_share:expr) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const INFINITE: Self = Self::INFINITY;
            const PIVOT_SHARE: Self = $pivot_share;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn square_root(self) -> Self {
                $sqrt(self)
            }

            #[inline(always)]
            fn sine_cosine(self) -> (Self, Self) {
                // Adding and taking away 1.5 * 2^mantissa rounds to an integer,
                // whose low bits are then the low bits of the sum.
                let shifted = self * core::$float::consts::FRAC_2_PI + $round;
                let quadrant = shifted.to_bits();
                let k = shifted - $round;
                let head = self - k * $p1;
                let r = head - k * $p2;
                let tail = ((head - r) - k * $p2) - k * $p3;

                let z = r * r;
                let s = horner(z, [$($s),+]);
                let c = horner(z, [$($c),+]);
                // sin(r + t) = sin r + t cos r,  cos(r + t) = cos r - t sin r
                let sine = r + (r * z * s + tail * (1.0 - 0.5 * z));
                let half = 0.5 * z;
                let one = 1.0 - half;
                let cosine = one + (((1.0 - one) - half) + (z * z * c - r * tail));

                let swap = quadrant & 1 != 0;
                let (a, b) = if swap { (cosine, sine) } else { (sine, cosine) };
                let sign_bit = <$bits>::BITS - 1;
                let sine_sign = ((quadrant >> 1) & 1) << sign_bit;
                let cosine_sign = ((quadrant.wrapping_add(1) >> 1) & 1) << sign_bit;
                (
                    $float::from_bits(a.to_bits() ^ sine_sign),
                    $float::from_bits(b.to_bits() ^ cosine_sign),
                )
            }

            #[inline(always)]
            fn exp_negative(self) -> Self {
                let x = self.most(0.0).least($exp_range);
                let shifted = x * -core::$float::consts::LOG2_E + $round;
                let k = shifted - $round;
                let r = (-x - k * $l1) - k * $l2;
                let poly = 1.0 + (r + r * r * horner(r, [$($e),+]));
                // k is between -bias and 0: its low bits are a valid exponent.
                let exponent = shifted.to_bits().wrapping_add($bias) << $mantissa;
                poly * $float::from_bits(exponent & !(1 << (<$bits>::BITS - 1)))
            }

            #[inline(always)]
            fn floor_small(self) -> Self {
                let truncated = (self as i32) as $float;
                if truncated > self { truncated - 1.0 } else { truncated }
            }

            #[inline(always)]
            fn magnitude(self) -> Self {
                self.abs()
            }

            #[inline(always)]
            fn with_sign_of(self, sign: Self) -> Self {
                self.copysign(sign + 0.0)
            }

            #[inline(always)]
            fn finite(self) -> bool {
                self.is_finite()
            }

            #[inline(always)]
            fn most(self, other: Self) -> Self {
                if cfg!(fpu) {
                    self.max(other)
                } else if self > other {
                    self
                } else {
                    other
                }
            }

            #[inline(always)]
            fn least(self, other: Self) -> Self {
                if cfg!(fpu) {
                    self.min(other)
                } else if self < other {
                    self
                } else {
                    other
                }
            }
        }
    };
}

/// Polynomial with coefficients from the lowest power up.
#[inline(always)]
fn horner<T: Real, const N: usize>(x: T, coefficients: [T; N]) -> T {
    coefficients
        .iter()
        .rev()
        .fold(T::ZERO, |sum, &coefficient| sum * x + coefficient)
}

// The trigonometric coefficients are minimax on |r| <= pi/4 + 0.001 (relative
// error 4e-18 and 6e-20 for f64, 4e-9 and 1e-10 for f32); those of the
// exponential are 1/n!, cut where the next term is below a quarter of a unit.
#[allow(clippy::excessive_precision)]
mod constants {
    use super::*;

    real!(f64, u64,
        round: 6_755_399_441_055_744.0,
        pi_2: [core::f64::consts::FRAC_PI_2, 6.123_233_995_736_757e-17, 8.478_427_660_368_9e-32],
        sin: [-0.166_666_666_666_666_301_73, 0.008_333_333_333_321_974_243_6,
              -0.000_198_412_698_294_695_753_67, 2.755_731_357_833_521_781_5e-6,
              -2.505_074_081_105_703_538e-8, 1.589_581_560_476_898_184_8e-10],
        cos: [0.041_666_666_666_666_591_768, -0.001_388_888_888_887_285_073,
              0.000_024_801_587_288_719_741_51, -2.755_731_414_020_725_777e-7,
              2.087_569_540_280_166_079_1e-9, -1.135_824_864_515_999_269_9e-11],
        ln2: [0.693_147_180_369_123_8, 1.908_214_929_270_587_8e-10],
        exp: [1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5_040.0,
              1.0 / 40_320.0, 1.0 / 362_880.0, 1.0 / 3_628_800.0, 1.0 / 39_916_800.0,
              1.0 / 479_001_600.0, 1.0 / 6_227_020_800.0],
        exp_range: 700.0, exponent_bias: 1023, mantissa: 52,
        square_root: square_root_f64, pivot_share: 1e-12);

    real!(f32, u32,
        round: 12_582_912.0,
        pi_2: [1.570_796_012_878_418, 3.139_164_164_167_596e-7, 6.223_372_171_896_613e-14],
        sin: [-0.166_666_545_166_390_46, 0.008_332_154_764_825_566_7, -0.000_195_144_538_130_822_85],
        cos: [0.041_666_645_519_267_18, -0.001_388_730_811_900_438_2, 0.000_024_432_208_966_187_481],
        ln2: [0.693_115_234_375, 3.194_618_3e-5],
        exp: [1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5_040.0],
        exp_range: 85.0, exponent_bias: 127, mantissa: 23,
        square_root: square_root_f32, pivot_share: 3e-6);
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;

    /// Distance in units in the last place of `reference`.
    fn ulps(value: f64, reference: f64, epsilon: f64) -> f64 {
        let exponent = libm::ilogb(reference);
        libm::fabs(value - reference) / libm::scalbn(epsilon, exponent)
    }

    #[test]
    fn sine_and_cosine_are_within_one_and_a_half_ulp_of_libm() {
        let (mut worst64, mut worst32) = (0.0f64, 0.0f64);
        let mut check = |x: f64| {
            let (s, c) = x.sine_cosine();
            worst64 = worst64.max(ulps(s, libm::sin(x), f64::EPSILON)).max(ulps(
                c,
                libm::cos(x),
                f64::EPSILON,
            ));
            let x = x as f32;
            let (s, c) = x.sine_cosine();
            worst32 = worst32
                .max(ulps(s.into(), libm::sin(x.into()), f32::EPSILON.into()))
                .max(ulps(c.into(), libm::cos(x.into()), f32::EPSILON.into()));
        };
        for i in 1..400_000 {
            let x = f64::from(i) / 400_000.0 * core::f64::consts::TAU;
            check(x);
            check(-x);
        }
        // The neighbourhood of the zeros, where cancellation is worst.
        for k in -4..=4 {
            let zero = f64::from(k) * core::f64::consts::FRAC_PI_2;
            for n in 1..2_000u64 {
                let near = f64::from_bits(zero.to_bits() + n);
                check(near);
                check(zero + 1e-9 * n as f64);
            }
        }
        assert!(worst64 <= 1.5 && worst32 <= 1.5, "{worst64} {worst32}");
    }

    #[test]
    fn sine_and_cosine_of_many_turns_are_as_good_as_the_angle() {
        for i in 1..200_000 {
            let x = f64::from(i) / 200_000.0 * crate::ranges::ANGLE_MAX;
            for x in [x, -x] {
                let (s, c) = x.sine_cosine();
                let allowed = f64::EPSILON * x.abs().max(1.0);
                assert!((s - libm::sin(x)).abs() <= allowed, "{x}");
                assert!((c - libm::cos(x)).abs() <= allowed, "{x}");
                let x = x as f32;
                let (s, c) = x.sine_cosine();
                let (wide, allowed) = (f64::from(x), f32::EPSILON * x.abs().max(1.0));
                assert!((s - libm::sin(wide) as f32).abs() <= allowed, "{x}");
                assert!((c - libm::cos(wide) as f32).abs() <= allowed, "{x}");
            }
        }
    }

    #[test]
    fn exponential_is_within_two_ulp_of_libm() {
        for i in 0..200_000 {
            let x = f64::from(i) * 0.003_5;
            let (ours, theirs) = (x.exp_negative(), libm::exp(-x));
            assert!(
                ulps(ours, theirs, f64::EPSILON) <= 2.0,
                "{x} {ours:e} {theirs:e}"
            );
            let x = (f64::from(i) * 0.000_42) as f32;
            let (ours, theirs) = (x.exp_negative(), libm::exp(-f64::from(x)));
            assert!(ulps(ours.into(), theirs, f32::EPSILON.into()) <= 2.0, "{x}");
        }
        assert_eq!(0.0f64.exp_negative(), 1.0);
        assert_eq!((-3.0f32).exp_negative(), 1.0);
        assert!(f64::INFINITY.exp_negative() < 1e-300);
    }

    #[test]
    fn floor_and_limits() {
        for (x, floor) in [(2.7, 2.0), (-2.7, -3.0), (-2.0, -2.0), (0.0, 0.0)] {
            assert_eq!(Real::floor_small(x), floor);
        }
        assert_eq!(Real::limited(5.0f32, -1.0, 1.0), 1.0);
        assert!(Real::limited(f64::NAN, -1.0, 1.0).is_nan());
        assert_eq!(Real::most(f64::NAN, 2.0), 2.0);
    }
}
