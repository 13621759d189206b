//! Limits that hold whatever the committed figures say.

use crate::figures::{Controller, Figures};

/// Most stack of cycle or constructor, by the bound from the code \[bytes\].
pub const STACK: u64 = 12 * 1024;

/// What holds in one precision.
pub struct OfPrecision {
    /// f64 or f32.
    pub name: &'static str,
    /// Most flash of constructor, cycle and record \[bytes\].
    pub flash: u64,
    /// Most state and stack of the cycle together, the stack by its bound \[bytes\].
    pub working_memory: u64,
}

/// Both precisions.
pub const PRECISIONS: [OfPrecision; 2] = [
    OfPrecision {
        name: "f64",
        flash: 61_440,
        working_memory: 8_560,
    },
    OfPrecision {
        name: "f32",
        flash: 56_748,
        working_memory: 4_352,
    },
];

/// Most instructions of a cycle on the Cortex-M7, by experiment and precision.
pub const CYCLE: [(&str, &str, u64); 4] = [
    ("two-level", "f64", 13_446),
    ("two-level", "f32", 10_931),
    ("case-1", "f64", 15_194),
    ("case-1", "f32", 12_448),
];

/// Smallest to largest instruction count of a cycle: a spread below 0.5 %.
const SPREAD_PER_MILLE: u64 = 5;

/// One line per figure that is beyond its limit: what, its value, the limit.
pub fn exceeded(figures: &Figures) -> Vec<String> {
    let mut lines: Vec<String> = (figures.controllers.iter())
        .flat_map(|controller| of_controller(figures, controller))
        .collect();
    for OfPrecision { name, flash, .. } in PRECISIONS {
        let what = format!("{name}: flash of the linked core, bytes");
        lines.extend(above(what, figures.core_flash.get(name).copied(), flash));
    }
    lines
}

fn of_controller(figures: &Figures, controller: &Controller) -> Vec<String> {
    let Controller {
        job,
        precision,
        cycle,
        stack,
        ..
    } = controller;
    let of = format!("{job} {precision}");
    let cycles = CYCLE.iter().find(|(a, b, _)| a == job && b == precision);
    let bytes = PRECISIONS.iter().find(|limits| limits.name == precision);
    let mut lines = Vec::new();
    lines.extend(above(
        format!("{of}: cycle, instructions"),
        Some(cycle.max),
        cycles.map_or(0, |(_, _, limit)| *limit),
    ));
    if 1000 * (cycle.max - cycle.min) >= SPREAD_PER_MILLE * cycle.min {
        lines.push(format!(
            "{of}: cycle takes {} to {} instructions; the spread must be below 0.5 %",
            cycle.min, cycle.max
        ));
    }
    lines.extend(above(
        format!("{of}: state and stack of the cycle, bytes"),
        figures.working_memory(controller),
        bytes.map_or(0, |limits| limits.working_memory),
    ));
    for (what, bound, seen) in [
        ("cycle", stack.cycle_bound, stack.cycle_seen),
        ("constructor", stack.init_bound, stack.init_seen),
    ] {
        let name = format!("{of}: stack bound of the {what}, bytes");
        lines.extend(above(name, bound, STACK));
        if bound.is_some_and(|bound| bound < seen) {
            lines.push(format!(
                "{of}: stack of the {what} seen is {seen} bytes, above its bound"
            ));
        }
    }
    lines
}

fn above(what: String, value: Option<u64>, limit: u64) -> Option<String> {
    match value {
        Some(value) if value <= limit => None,
        Some(value) => Some(format!("{what}: {value}, limit {limit}")),
        None => Some(format!("{what}: none, limit {limit}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{Cost, Stack};

    const STATE: u64 = 1_000;

    fn figures(instructions: u64, bound: Option<u64>, flash: u64) -> Figures {
        let controller = |precision: &str| Controller {
            job: "case-1".into(),
            precision: precision.into(),
            cycle: Cost {
                min: instructions - 10,
                max: instructions,
                worst: String::new(),
            },
            stack: Stack {
                cycle_bound: bound,
                init_bound: bound,
                ..Stack::default()
            },
            ..Controller::default()
        };
        let by_precision = |value: u64| {
            let each = |limits: OfPrecision| (limits.name.to_string(), value);
            PRECISIONS.map(each)
        };
        let sizes = |(precision, state)| (precision, [("state".to_string(), state)].into());
        Figures {
            controllers: vec![controller("f64"), controller("f32")],
            sizes: by_precision(STATE).map(sizes).into(),
            core_flash: by_precision(flash).into(),
            ..Figures::default()
        }
    }

    #[test]
    fn what_is_beyond_a_limit_is_named_with_value_and_limit() {
        let [f64, f32] = PRECISIONS;
        let most = f32.working_memory - STATE;
        assert!(exceeded(&figures(12_448, Some(most), f32.flash)).is_empty());
        let slow = exceeded(&figures(12_449, Some(most), f32.flash));
        assert_eq!(
            slow,
            ["case-1 f32: cycle, instructions: 12449, limit 12448"]
        );
        let large = exceeded(&figures(9_000, Some(most + 1), f32.flash));
        assert_eq!(
            large,
            ["case-1 f32: state and stack of the cycle, bytes: 4353, limit 4352"]
        );
        // Working memory, cycle and constructor in both precisions.
        assert_eq!(exceeded(&figures(9_000, Some(STACK + 1), 1)).len(), 6);
        let lost = exceeded(&figures(9_000, None, 1));
        assert_eq!(lost.len(), 6);
        assert!(lost[1].ends_with("bytes: none, limit 12288"), "{lost:?}");
        assert_eq!(exceeded(&figures(9_000, Some(1), f64.flash + 1)).len(), 2);
        // Ten instructions are too much of a spread here.
        assert_eq!(exceeded(&figures(1_000, Some(1), 1)).len(), 2);
        let mut seen = figures(9_000, Some(1000), 1);
        seen.controllers[0].stack.init_seen = 1004;
        assert_eq!(
            exceeded(&seen),
            ["case-1 f64: stack of the constructor seen is 1004 bytes, above its bound"]
        );
        seen = figures(9_000, Some(1), 1);
        seen.core_flash.clear();
        seen.sizes.clear();
        assert_eq!(exceeded(&seen).len(), 4);
    }
}
