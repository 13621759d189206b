//! Round numbers for axes, and how they are written.

/// Positions of ticks with what is written at them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// Labelled ticks: value and text.
    pub major: Vec<(f64, String)>,
    /// Ticks without a label.
    pub minor: Vec<f64>,
}

/// Ticks at 1, 2 or 5 times a power of ten within `low..=high`, about `count`.
#[must_use]
pub fn linear(low: f64, high: f64, count: usize) -> Ticks {
    spaced(low, high, (high - low) / count.max(1) as f64)
}

/// The same, about `spacing` (above 0) apart.
#[must_use]
pub fn spaced(low: f64, high: f64, spacing: f64) -> Ticks {
    let span = high - low;
    if !(span.is_finite() && span > 0.0 && spacing.is_finite() && spacing > 0.0) {
        return Ticks::default();
    }
    let (digit, exponent) = nice_step(spacing);
    // Integer multiples, divided rather than multiplied for negative powers of
    // ten: 3 steps of 0.1 are 0.3 and not 0.30000000000000004.
    let value = |k: i64| {
        if exponent < 0 {
            (k * digit) as f64 / 10f64.powi(-exponent)
        } else {
            (k * digit) as f64 * 10f64.powi(exponent)
        }
    };
    let step = value(1);
    let (first, last) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    if !(first.abs() < 1e15 && last.abs() < 1e15) {
        return Ticks::default();
    }
    let decimals = usize::try_from(-exponent).unwrap_or(0);
    let largest = low.abs().max(high.abs());
    let text = |v: f64| {
        if !(1e-4..1e6).contains(&largest) {
            scientific(v)
        } else {
            signed(&format!("{v:.decimals$}"))
        }
    };
    let values = (first as i64..=last as i64).map(value);
    Ticks {
        major: values.map(|v| (v, text(v))).collect(),
        minor: Vec::new(),
    }
}

/// Ticks at powers of ten within `low..=high` (above 0), at most about `count`
/// of them; where there are few, also at 2 and 5 times these.
#[must_use]
pub fn logarithmic(low: f64, high: f64, count: usize) -> Ticks {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Ticks::default();
    }
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |v: &f64| *v >= low * (1.0 - 1e-9) && *v <= high * (1.0 + 1e-9);
    let decades = (last - first).unsigned_abs() as usize;
    let stride = decades.div_ceil(count.max(1)).max(1) as i32;
    let mut ticks = Ticks::default();
    for exponent in first..=last {
        let power = 10f64.powi(exponent);
        let labelled = exponent.rem_euclid(stride) == 0;
        if inside(&power) && labelled {
            ticks.major.push((power, power_of_ten(exponent)));
        }
        if stride > 1 {
            continue;
        }
        for digit in 2..10 {
            let value = f64::from(digit) * power;
            if !inside(&value) {
                continue;
            }
            if decades <= 2 && (digit == 2 || digit == 5) {
                let decimals = usize::try_from(-exponent).unwrap_or(0);
                ticks.major.push((value, format!("{value:.decimals$}")));
            } else {
                ticks.minor.push(value);
            }
        }
    }
    if decades <= 2 {
        for (value, text) in &mut ticks.major {
            let decimals = (-value.log10().floor()).max(0.0) as usize;
            *text = format!("{value:.decimals$}");
        }
    }
    ticks
}

/// The 1-2-5 step next to `raw`, as digit and power of ten.
fn nice_step(raw: f64) -> (i64, i32) {
    let exponent = raw.log10().floor();
    let fraction = raw / 10f64.powf(exponent);
    let exponent = exponent as i32;
    match fraction {
        f if f < 1.5 => (1, exponent),
        f if f < 3.5 => (2, exponent),
        f if f < 7.5 => (5, exponent),
        _ => (1, exponent + 1),
    }
}

/// The number with a true minus sign; no negative zero.
fn signed(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_string(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text.to_string(),
    }
}

/// A number for tables: about three significant digits.
#[must_use]
pub fn figure(value: f64) -> String {
    let size = value.abs();
    let text = if !value.is_finite() {
        return "\u{2013}".to_string();
    } else if size == 0.0 {
        "0".to_string()
    } else if !(1e-4..1e6).contains(&size) {
        return scientific(value);
    } else if size < 1e-2 {
        format!("{value:.5}")
    } else if size < 10.0 {
        format!("{value:.3}")
    } else if size < 1e3 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    };
    signed(&text)
}

/// The shortest decimal text of a setting, with a true minus sign.
#[must_use]
pub fn plain(value: f64) -> String {
    signed(&value.to_string())
}

/// `1.2×10⁻⁵`.
fn scientific(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let text = format!("{value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = signed(mantissa.trim_end_matches(".0"));
    format!(
        "{mantissa}\u{d7}{}",
        power_of_ten(exponent.parse().unwrap_or(0))
    )
}

/// `10⁻⁵`.
fn power_of_ten(exponent: i32) -> String {
    let raised = exponent.to_string().chars().map(raise).collect::<String>();
    format!("10{raised}")
}

fn raise(c: char) -> char {
    match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        '0' | '4'..='9' => char::from_u32(0x2070 + (c as u32 - '0' as u32)).unwrap_or(c),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_nice() {
        assert_eq!(
            labels(&linear(0.0, 1.34, 5)),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0", "1.2"]
        );
        assert_eq!(
            labels(&linear(-12.0, 9.0, 4)),
            ["\u{2212}10", "\u{2212}5", "0", "5"]
        );
        assert_eq!(labels(&linear(0.0, 20.0, 10)).len(), 11);
        for scale in [1e-9, 3.3e-3, 1.0, 47.0, 8e7] {
            for count in 2..12 {
                let ticks = linear(-0.31 * scale, scale, count);
                let n = ticks.major.len();
                assert!(n >= 2 && n <= 2 * count + 2, "{scale} {count} {n}");
                let step = ticks.major[1].0 - ticks.major[0].0;
                let digit = step / 10f64.powf(step.log10().floor() + 1e-12);
                let digit = if digit > 9.99 { digit / 10.0 } else { digit };
                assert!(
                    [1.0, 2.0, 5.0].iter().any(|d| (digit - d).abs() < 1e-6),
                    "{step}"
                );
            }
        }
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(
            labels(&logarithmic(1e-3, 2.0, 6)),
            ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]
        );
        assert!(labels(&logarithmic(1e-18, 1.0, 5)).len() <= 6);
        assert_eq!(labels(&logarithmic(0.3, 2.5, 6)), ["0.5", "1", "2"]);
        assert_eq!(logarithmic(0.0, 1.0, 5), Ticks::default());
        assert_eq!(linear(f64::NAN, 1.0, 5), Ticks::default());
    }

    #[test]
    fn numbers_for_tables() {
        assert_eq!(figure(0.4335), "0.433");
        assert_eq!(figure(-44.35), "\u{2212}44.4");
        assert_eq!(figure(1.2e-6), "1.2\u{d7}10⁻⁶");
        assert_eq!(figure(f64::NAN), "\u{2013}");
        assert_eq!(signed("-0.00"), "0.00");
    }
}
