//! Limits that hold whatever the committed figures say.

use crate::figures::{Figures, Way};

/// Ends of names of [`Figures::bounded`], and the most that each of those figures may be.
pub const LIMITS: [(&str, u64); 16] = [
    ("two-level f64: cycle, instructions", 14_246),
    ("two-level f32: cycle, instructions", 12_254),
    ("case-1 f64: cycle, instructions", 17_171),
    ("case-1 f32: cycle, instructions", 15_070),
    ("two-level f64: longest cycle, instructions", 22_400),
    ("two-level f32: longest cycle, instructions", 19_750),
    ("case-1 f64: longest cycle, instructions", 26_700),
    ("case-1 f32: longest cycle, instructions", 24_050),
    ("f64: state and stack of the cycle, bytes", 23_200),
    ("f32: state and stack of the cycle, bytes", 11_900),
    ("f64: flash of the linked core, bytes", 116_000),
    ("f32: flash of the linked core, bytes", 109_000),
    (
        "f64 with the exact law: flash of the linked core, bytes",
        98_500,
    ),
    (
        "f32 with the exact law: flash of the linked core, bytes",
        89_500,
    ),
    ("stack bound of the cycle, bytes", 12_288),
    ("stack bound of the constructor, bytes", 13_400),
];

/// Most pivots of a projection: every number of them has to be measured.
const PIVOTS: u64 = 12;

/// Smallest to largest instruction count of a path: a spread below 0.5 %.
const SPREAD_PER_MILLE: u64 = 5;

/// The same where directions get lost: of which levels, and whether one is stuck, is within the path.
const SPREAD_LOST_PER_MILLE: u64 = 30;

/// One line per figure that is beyond its limit, or that is not there.
pub fn exceeded(figures: &Figures) -> Vec<String> {
    let bounded = figures.bounded();
    let mut lines = Vec::new();
    for (end, limit) in LIMITS {
        let mut measured = bounded
            .iter()
            .filter(|(name, _)| name.ends_with(end))
            .peekable();
        if measured.peek().is_none() {
            lines.push(format!("{end}: none, limit {limit}"));
        }
        lines.extend(
            measured
                .filter(|(_, value)| **value > limit)
                .map(|(name, value)| {
                    let value = if *value == u64::MAX {
                        "none".into()
                    } else {
                        value.to_string()
                    };
                    format!("{name}: {value}, limit {limit}")
                }),
        );
    }
    for controller in &figures.controllers {
        let (of, stack) = (controller.name(), &controller.stack);
        for path in &controller.paths {
            let (name, min, max) = (path.name(), path.min, path.max);
            let allowed = match path.way {
                Way::Free => SPREAD_PER_MILLE,
                _ => SPREAD_LOST_PER_MILLE,
            };
            if 1000 * (max - min) >= allowed * min {
                let percent = allowed as f64 / 10.0;
                lines.push(format!(
                    "{of}: {name} takes {min} to {max} instructions; the spread must be below {percent} %"
                ));
            }
        }
        for pivots in 0..=PIVOTS {
            if !controller.paths.iter().any(|path| path.pivots == pivots) {
                lines.push(format!("{of}: no input takes {pivots} pivots"));
            }
        }
        for (what, bound, seen) in [
            ("cycle", stack.cycle_bound, stack.cycle_seen),
            ("constructor", stack.init_bound, stack.init_seen),
        ] {
            if bound.is_some_and(|bound| bound < seen) {
                lines.push(format!(
                    "{of}: stack of the {what} seen is {seen} bytes, above its bound"
                ));
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{Controller, Cost, Path, Stack};

    const STATE: u64 = 2_000;

    /// Of everything that has a limit, the instructions those of `case-1` with nothing at a limit.
    fn figures(instructions: u64, bound: Option<u64>, flash: u64) -> Figures {
        let controller = |experiment: &str, precision: &str, instructions: u64| Controller {
            experiment: experiment.into(),
            precision: precision.into(),
            cycle: Cost {
                max: instructions,
                ..Cost::default()
            },
            paths: (0..=PIVOTS)
                .map(|pivots| Path {
                    pivots,
                    min: instructions - 10,
                    max: instructions,
                    ..Path::default()
                })
                .collect(),
            stack: Stack {
                cycle_bound: bound,
                init_bound: bound,
                ..Stack::default()
            },
            ..Controller::default()
        };
        let mut figures = Figures::default();
        for precision in ["f64", "f32"] {
            let state = [("state".to_string(), STATE)].into();
            figures.sizes.insert(precision.into(), state);
            for law in ["", " with the exact law"] {
                let name = format!("{precision}{law}");
                figures.core_flash.insert(name, flash);
            }
            let case_1 = controller("case-1", precision, instructions);
            let two_level = controller("two-level", precision, 9_000);
            figures.controllers.extend([case_1, two_level]);
        }
        figures
    }

    #[test]
    fn what_is_beyond_a_limit_is_named_with_value_and_limit() {
        let most = 11_900 - STATE;
        assert!(exceeded(&figures(15_070, Some(most), 77_000)).is_empty());
        assert_eq!(
            exceeded(&figures(15_071, Some(most), 1)),
            ["case-1 f32: cycle, instructions: 15071, limit 15070"]
        );
        assert_eq!(
            exceeded(&figures(9_000, Some(most + 1), 1)),
            ["case-1", "two-level"].map(|experiment| format!(
                "{experiment} f32: state and stack of the cycle, bytes: 11901, limit 11900"
            ))
        );
        // Working memory, cycle and constructor of all four.
        assert_eq!(exceeded(&figures(9_000, Some(23_201), 1)).len(), 12);
        let lost = exceeded(&figures(9_000, None, 1));
        assert_eq!(lost.len(), 12);
        assert!(lost[11].ends_with("bytes: none, limit 13400"), "{lost:?}");
        assert_eq!(exceeded(&figures(9_000, Some(1), 116_001)).len(), 4);
        // Ten instructions are too much of a spread here, on every path.
        let paths = 2 * (PIVOTS as usize + 1);
        assert_eq!(exceeded(&figures(1_000, Some(1), 1)).len(), paths);
        let mut unseen = figures(9_000, Some(1), 1);
        unseen.controllers[0].paths.remove(7);
        assert_eq!(exceeded(&unseen), ["case-1 f64: no input takes 7 pivots"]);
        let mut seen = figures(9_000, Some(1_000), 1);
        seen.controllers[0].stack.init_seen = 1_004;
        assert_eq!(
            exceeded(&seen),
            ["case-1 f64: stack of the constructor seen is 1004 bytes, above its bound"]
        );
        assert_eq!(exceeded(&Figures::default()).len(), LIMITS.len());
    }
}
