//! Numbers as text with 17 significant digits, byte by byte as `{:.16e}` writes them, in a
//! fraction of its instructions.
//!
//! A number is m 2^e with whole m. With k such that it has 17 digits before its point, x 10^k =
//! m 5^k 2^(e + k), which is a whole number of 192 bits and a shift: exact, as 5^k has up to 128
//! bits. What does not fit, and what lies half way between two decimals, is left to `{:.16e}`.

use std::io::Write as _;

/// 5^55 is the largest power in 128 bits.
const POWERS: usize = 56;

const FIVES: [u128; POWERS] = {
    let mut powers = [1; POWERS];
    let mut k = 1;
    while k < POWERS {
        powers[k] = 5 * powers[k - 1];
        k += 1;
    }
    powers
};

/// 10^16, the least number with 17 digits.
const LEAST: u64 = 10_000_000_000_000_000;

/// Two digits each.
const DIGITS: [[u8; 2]; 100] = {
    let mut digits = [[0; 2]; 100];
    let mut n = 0;
    while n < 100 {
        digits[n] = [b'0' + (n / 10) as u8, b'0' + (n % 10) as u8];
        n += 1;
    }
    digits
};

/// Appends `value` as `{value:.16e}`.
pub fn push(text: &mut Vec<u8>, value: f64) {
    match decimal(value.abs()) {
        Some((digits, exponent)) => push_parts(text, value.is_sign_negative(), digits, exponent),
        None => {
            // Writing to memory does not fail.
            let _ = write!(text, "{value:.16e}");
        }
    }
}

/// 17 digits, and the power of ten of the first one; of a number that is not negative.
fn decimal(value: f64) -> Option<(u64, i32)> {
    let bits = value.to_bits();
    if bits == 0 {
        return Some((0, 0));
    }
    let raw = (bits >> 52) as i32;
    // Neither subnormal, infinite nor NaN.
    if raw == 0 || raw == 0x7ff {
        return None;
    }
    let whole = (bits & ((1 << 52) - 1)) | (1 << 52);
    let binary = raw - 1075;
    // log10 of the leading bit, rounded down: 78,913 / 2^18 is log10 2 to 6 digits. It may be one
    // less than that of the number.
    let exponent = ((raw - 1023) * 78_913) >> 18;
    let (digits, exponent) = match scaled(whole, binary, exponent)? {
        digits if digits < 10 * LEAST => (digits, exponent),
        _ => (scaled(whole, binary, exponent + 1)?, exponent + 1),
    };
    Some(match digits < 10 * LEAST {
        true => (digits, exponent),
        // Rounded up to the next power of ten.
        false => (LEAST, exponent + 1),
    })
}

/// `whole` 2^`binary` 10^(16 - `exponent`) to the nearest whole number; none where it is not
/// known here.
fn scaled(whole: u64, binary: i32, exponent: i32) -> Option<u64> {
    let power = 16 - exponent;
    let five = *FIVES.get(usize::try_from(power).ok()?)?;
    let shift = u32::try_from(-(binary + power)).ok()?;
    let low = u128::from(whole) * u128::from(five as u64);
    let high = u128::from(whole) * (five >> 64) + (low >> 64);
    // high 2^64 + low, shifted right; the bits that go are compared with a half of the last
    // place.
    let low = u128::from(low as u64);
    let (number, rest, half) = match shift {
        0 => return None,
        1..64 => {
            let rest = low & ((1 << shift) - 1);
            (high << (64 - shift) | low >> shift, rest, 1 << (shift - 1))
        }
        64..128 => {
            let (number, bits) = (high >> (shift - 64), shift - 64);
            let rest = (high & ((1 << bits) - 1)) << 64 | low;
            (number, rest, 1 << (shift - 1))
        }
        // Powers up to 5^55 need no more.
        _ => return None,
    };
    if rest == half {
        return None;
    }
    Some(number as u64 + u64::from(rest > half))
}

fn push_parts(text: &mut Vec<u8>, negative: bool, digits: u64, exponent: i32) {
    // Sign, 17 digits, point, e, sign and two digits of the exponent.
    let mut bytes = [b'0'; 24];
    let mut rest = digits;
    for place in (0..8).rev() {
        let pair = DIGITS[(rest % 100) as usize];
        rest /= 100;
        bytes[2 * place + 3..2 * place + 5].copy_from_slice(&pair);
    }
    (bytes[1], bytes[2]) = (b'0' + rest as u8, b'.');
    bytes[19] = b'e';
    let mut end = 20;
    if exponent < 0 {
        bytes[end] = b'-';
        end += 1;
    }
    let [tens, ones] = DIGITS[exponent.unsigned_abs() as usize];
    if tens != b'0' {
        bytes[end] = tens;
        end += 1;
    }
    bytes[end] = ones;
    let mut start = 1;
    if negative {
        (bytes[0], start) = (b'-', 0);
    }
    text.extend_from_slice(&bytes[start..=end]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(value: f64) {
        let mut text = Vec::new();
        push(&mut text, value);
        let expected = format!("{value:.16e}");
        assert_eq!(
            str::from_utf8(&text),
            Ok(expected.as_str()),
            "{:x}",
            value.to_bits()
        );
    }

    #[test]
    fn every_number_is_as_the_formatter_writes_it() {
        // A xorshift over all bits, and over what a run is full of.
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for n in 0..400_000_u32 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            holds(f64::from_bits(bits));
            let share = bits as i64 as f64 / i64::MAX as f64;
            holds(share * 10f64.powi((n % 60) as i32 - 45));
            // Short decimals, times of cycles, whole numbers.
            holds(f64::from(n) * 2e-3);
            holds(f64::from(n) / 1024.0);
            holds((bits >> (n % 64)) as f64);
        }
    }

    #[test]
    fn so_are_powers_neighbours_ties_and_what_is_no_number() {
        for n in -330..=308 {
            let power: f64 = format!("1e{n}").parse().expect("a number");
            for value in [power, power.next_up(), power.next_down(), 5.0 * power] {
                holds(value);
                holds(-value);
            }
        }
        for n in -1074..=1023 {
            holds(libm::scalbn(1.0, n));
            // Many of them end in a 5 in the 18th place.
            holds(libm::scalbn(9_007_199_254_740_991.0, n - 52));
            holds(libm::scalbn(4_503_599_627_370_497.0, n - 52));
        }
        let odd = [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        for value in odd.into_iter().chain([f64::MIN_POSITIVE, f64::MAX, 5e-324]) {
            holds(value);
        }
    }
}
