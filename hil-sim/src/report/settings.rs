//! The table of what a run was set to.

use super::Run;
use super::svg::escape;
use super::tables::Table;
use super::ticks::plain;
use crate::plant::want_of_data;
use cell::names::{Named, PlantKind};
use cell::scenario::{AxisGain, AxisOf, LevelSpec, PostureSpec, ReferenceSpec};

/// Gains as they acted, references, cycle.
pub fn settings(run: &Run<'_>) -> String {
    let (scenario, summary) = (run.scenario, run.summary);
    let caption = if run.by_client() {
        "Arm and motion that the client is held against; its gains are its own."
    } else {
        "Gains as they acted, with the chosen null-space stiffness."
    };
    let mut table = Table::new(caption, ["Setting", "Value"]);
    let mut row = |name: &str, value: &str| table.row(&escape(name), [escape(value)]);
    let arm = run.recording.arm();
    row("Arm", arm.parameters.name);
    if let Some(mount) = &scenario.mount {
        let [roll, pitch, yaw] = mount.rpy_deg.map(plain);
        row(
            "Mount [deg]",
            &format!("roll {roll}, pitch {pitch}, yaw {yaw}"),
        );
    }
    if let Some(tool) = &scenario.tool {
        row("Tool: mass [kg]", &plain(tool.mass_kg));
        row(
            "Tool: frame in the flange [m], roll, pitch, yaw [deg]",
            &format!("{}; {}", list(&tool.shift_m), list(&tool.rpy_deg)),
        );
        row(
            "Tool: centre of mass [m], inertia about it [kg m\u{b2}]",
            &format!(
                "{}; {}",
                list(&tool.center_of_mass_m),
                list(&tool.inertia_kg_m2)
            ),
        );
    }
    row(
        "Plant, seed",
        &format!("{}, {}", summary.plant, summary.seed),
    );
    row("Controller", summary.controller);
    let [duration, cycle] = [summary.duration_s, summary.cycle_ms].map(plain);
    row(
        "Duration, cycle",
        &format!("{duration} s, {cycle} ms, {} cycles run", summary.cycles),
    );
    if summary.plant == PlantKind::Realistic.name()
        && let Some(note) = want_of_data(&arm.parameters)
    {
        row("Plant", &note);
    }
    let options = &run.choices.options;
    let measurement = run.choices.measurement.name();
    row(
        "Measurement, dead cycles",
        &format!("{measurement}, {}", options.dead_cycles),
    );
    if options.stiction {
        row("Plant option", "stiction");
    }
    if options.elasticity {
        row("Plant option", "elastic joints");
    }
    let start = if run.by_client() {
        "Start posture [deg]"
    } else {
        "Start posture, also q_d [deg]"
    };
    row(start, &list(&scenario.start_deg));
    for (number, level) in (1..).zip(&scenario.levels) {
        row(
            &format!("Level {number}: task"),
            &format!("{}: {}", level.label(), reference(level)),
        );
        if !run.by_client() {
            row(
                &format!("Level {number}: K_p [1/s\u{b2}], K_d [1/s]"),
                &format!("{}; {}", gain(&level.stiffness), gain(&level.damping)),
            );
        }
    }
    if run.by_client() {
        return table.finish();
    }
    let null = &scenario.null_space;
    let factor = run.choices.null_stiffness.factor();
    let stiffness = null.stiffness.map(|k| factor * k);
    row("Null space: K_q [Nm/rad]", &list(&stiffness));
    let damping = if run.choices.has_inertia_damping() {
        format!("c M with c = {} /s", plain(null.damping_rate))
    } else {
        list(&null.damping)
    };
    row("Null space: D [Nms/rad]", &damping);
    let posture = match null.posture {
        PostureSpec::Constant => "constant",
        PostureSpec::IntegralCoupled => "integral, coupled",
        PostureSpec::IntegralUncoupled => "integral, uncoupled",
    };
    row("Null space: posture q_d", posture);
    if summary.controller.starts_with("acceleration-level") {
        row("Null space: rate gain [1/s]", &plain(null.rate_gain));
    }
    row("Observer: K_I [1/s]", &plain(scenario.observer.gain));
    table.finish()
}

fn list(values: &[f64]) -> String {
    // Products of settings and factors carry the last bits of rounding.
    let short = |v: &f64| plain((v * 1e9).round() / 1e9);
    values.iter().map(short).collect::<Vec<_>>().join(", ")
}

fn gain(gain: &AxisGain) -> String {
    match gain {
        AxisGain::Uniform(value) => plain(*value),
        AxisGain::PerAxis(values) => list(values),
    }
}

fn reference(level: &LevelSpec) -> String {
    let turn = match &level.reference {
        ReferenceSpec::Hold {} => return "held".to_string(),
        ReferenceSpec::Move(straight) => {
            return format!(
                "moved by ({}) m in {} s",
                list(&straight.by_m),
                plain(straight.duration_s)
            );
        }
        ReferenceSpec::ThereAndBack(motion) => {
            return format!(
                "by ({}) m and back from {} s on, {} s each way, {} s between",
                list(&motion.by_m),
                plain(motion.from_s),
                plain(motion.duration_s),
                plain(motion.hold_s)
            );
        }
        ReferenceSpec::Swing(swing) => {
            return format!(
                "swing about ({}){}, {} deg reached in {} s, {} s a swing",
                list(&swing.axis),
                match swing.axis_of {
                    AxisOf::BasePlate => "",
                    AxisOf::Own => " of its own frame",
                },
                plain(swing.angle_deg),
                plain(swing.growth_s),
                plain(swing.period_s)
            );
        }
        ReferenceSpec::Circle(turn) | ReferenceSpec::Spiral(turn) => turn,
    };
    format!(
        "circle in {}, radius {} m reached in {} s, {} s a turn",
        format!("{:?}", turn.plane).to_uppercase(),
        plain(turn.radius_m),
        plain(turn.growth_s),
        plain(turn.period_s)
    )
}
