//! Limits that hold whatever the committed figures say.

use crate::figures::{Controller, Figures};

/// Most stack of cycle or constructor, by the bound from the code \[bytes\].
const STACK: u64 = 12 * 1024;

/// Most flash of constructor, cycle and record in one precision \[bytes\].
const FLASH: u64 = 64 * 1024;

/// Most instructions of a cycle on the Cortex-M7, by precision.
const CYCLE: [(&str, u64); 2] = [("f64", 20_000), ("f32", 16_000)];

/// Smallest to largest instruction count of a cycle: a spread below 0.5 %.
const SPREAD_PER_MILLE: u64 = 5;

/// One line per figure that is beyond its limit: what, its value, the limit.
pub fn exceeded(figures: &Figures) -> Vec<String> {
    let mut lines: Vec<String> = figures.controllers.iter().flat_map(of_controller).collect();
    for (precision, bytes) in &figures.core_flash {
        let what = format!("{precision}: flash of the linked core, bytes");
        lines.extend(above(what, Some(*bytes), FLASH));
    }
    if figures.core_flash.len() < CYCLE.len() {
        lines.push("flash of the linked core: not measured in both precisions".into());
    }
    lines
}

fn of_controller(controller: &Controller) -> Vec<String> {
    let of = format!("{} {}", controller.job, controller.precision);
    let (cycle, stack) = (&controller.cycle, &controller.stack);
    let allowed = CYCLE.iter().find(|(name, _)| *name == controller.precision);
    let mut lines = Vec::new();
    lines.extend(above(
        format!("{of}: cycle, instructions"),
        Some(cycle.max),
        allowed.map_or(0, |(_, limit)| *limit),
    ));
    if 1000 * (cycle.max - cycle.min) >= SPREAD_PER_MILLE * cycle.min {
        lines.push(format!(
            "{of}: cycle takes {} to {} instructions; the spread must be below 0.5 %",
            cycle.min, cycle.max
        ));
    }
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
        Figures {
            controllers: vec![controller("f64"), controller("f32")],
            core_flash: [("f64".to_string(), flash), ("f32".to_string(), flash)].into(),
            ..Figures::default()
        }
    }

    #[test]
    fn what_is_beyond_a_limit_is_named_with_value_and_limit() {
        assert!(exceeded(&figures(16_000, Some(STACK), FLASH)).is_empty());
        let slow = exceeded(&figures(16_001, Some(STACK), FLASH));
        assert_eq!(
            slow,
            ["case-1 f32: cycle, instructions: 16001, limit 16000"]
        );
        assert_eq!(exceeded(&figures(9_000, Some(STACK + 1), FLASH)).len(), 4);
        let lost = exceeded(&figures(9_000, None, FLASH));
        assert!(lost[0].ends_with("bytes: none, limit 12288"), "{lost:?}");
        assert_eq!(exceeded(&figures(9_000, Some(1), FLASH + 1)).len(), 2);
        // Ten instructions are too much of a spread here.
        assert_eq!(exceeded(&figures(1_000, Some(1), 1)).len(), 2);
        let mut seen = figures(9_000, Some(1000), 1);
        seen.controllers[0].stack.init_seen = 1004;
        assert_eq!(
            exceeded(&seen),
            ["case-1 f64: stack of the constructor seen is 1004 bytes, above its bound"]
        );
    }
}
