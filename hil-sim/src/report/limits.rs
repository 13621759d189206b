//! Figures and tables of a run that met limits.

use controller_core::joint::DOF;

use super::figure::{Figure, chart, figure};
use super::met::OF_LEVELS;
use super::plot::{LimitLine, Panel, Scale, Strip, Stroke, Style};
use super::run::Run;
use super::tables::{Table, number};
use crate::limit_events::{JointEvents, LevelEvents, LimitEvents};

/// Below this, what the bounds of the joints take from a level is not drawn \[m/s2\].
const DISTURBANCE_FLOOR: f64 = 1e-3;

/// Shares are drawn where one is below this: above it they are one line.
const LEAST_CUT: f64 = 0.99;

/// Ends of the axis of what joints have of their limits \[%\].
const OF_LIMITS: [f64; 2] = [-112.0, 112.0];

/// What a run met, if it met a limit.
fn met<'a>(run: &Run<'a>) -> Option<&'a LimitEvents> {
    let events = run.summary.limit_events.as_ref();
    events.filter(|events| events.is_any())
}

/// Of levels and of joints; nothing of a run that met no limit.
pub(super) fn figures(run: &Run<'_>) -> Vec<Figure> {
    match met(run) {
        Some(_) => std::iter::once(levels(run)).chain(joints(run)).collect(),
        None => Vec::new(),
    }
}

/// How long levels and joints met what; none of a run that met no limit.
pub(super) fn tables(run: &Run<'_>) -> Option<String> {
    let events = met(run)?;
    let names = (1..).zip(&run.summary.levels);
    let names = names.map(|(place, level)| format!("#Level {place}, {}", level.name));
    let mut of_levels = Table::new(
        "Levels that met limits, times in s; the error is the largest meanwhile.",
        std::iter::once("Level".to_string()).chain(names),
    );
    let unit = |level: usize| run.summary.levels[level].unit().suffix();
    for (what, value) in [
        (
            "Near a singularity",
            (|level| level.degraded_s) as fn(&LevelEvents) -> f64,
        ),
        ("In a singularity", |level| level.released_s),
        ("Stuck there", |level| level.stuck_s),
        ("Command shortened", |level| level.shaped_s),
        ("Less than it asked the joints for", |level| level.scaled_s),
        ("Disturbed by the bounds of joints", |level| {
            level.disturbed_s
        }),
        ("Most that these took [m/s\u{b2}]", |level| {
            level.disturbance_max
        }),
    ] {
        let cells = events.levels.iter().map(value);
        of_levels.row(what, cells.map(|value| number(Some(value))));
    }
    let error = |(level, events): (usize, &LevelEvents)| {
        format!(
            "{}\u{a0}{}",
            number(Some(1e3 * events.error_max)),
            unit(level)
        )
    };
    let count = run.summary.levels.len();
    of_levels.row(
        "Largest error",
        events.levels.iter().take(count).enumerate().map(error),
    );
    let joints = run.recording.arm().joints();
    let mut of_joints = Table::new(
        "Joints at their bounds, times in s.",
        std::iter::once("Joint".to_string()).chain(joints.map(|name| format!("#{name}"))),
    );
    for (what, value) in [
        (
            "At the end of the range",
            (|joint| joint.at_range_s) as fn(&JointEvents) -> f64,
        ),
        ("At the speed limit", |joint| joint.at_speed_s),
        ("At the acceleration limit", |joint| joint.at_acceleration_s),
    ] {
        let cells = events.joints.iter().map(value);
        of_joints.row(what, cells.map(|value| number(Some(value))));
    }
    Some(of_levels.finish() + &of_joints.finish())
}

/// What levels and null space met, and what they got.
fn levels(run: &Run<'_>) -> Figure {
    let recording = run.recording;
    let mut chart = chart(
        run,
        "limits-levels",
        "Limits met by levels",
        "When levels met which limit, what the bounds of the joints took from them, the share of \
         what they asked for that they got, and the exchanges of the projection, over time.",
    );
    let mut strips = Vec::new();
    for (level, of_level) in recording.met().levels.iter().enumerate() {
        for (name, spans) in OF_LEVELS.iter().zip(of_level) {
            strips.push((format!("level {} {name}", level + 1), spans, level));
        }
    }
    let null = recording.levels();
    let others = recording.met();
    strips.push(("null space scaled".into(), &others.null_scaled, null));
    strips.push(("unresolved".into(), &others.unresolved, null));
    let strips: Vec<_> = (strips.into_iter())
        .filter(|(_, spans, _)| !spans.0.is_empty())
        .map(|(label, spans, colour)| Strip {
            label,
            spans: spans.0.clone(),
            colour,
        })
        .collect();
    if !strips.is_empty() {
        chart.panels.push(Panel::of_strips(strips));
    }
    let names = |level: usize| format!("level {}, {}", level + 1, run.summary.levels[level].name);
    let count = recording.levels().min(run.summary.levels.len());
    let scale = Scale::Log {
        floor: DISTURBANCE_FLOOR,
    };
    let disturbed = (0..count)
        .map(|level| {
            let values = recording.disturbance(level);
            recording.line(names(level), values, Style::solid(level))
        })
        .collect();
    let disturbed = Panel::new("disturbance [m/s\u{b2}]", 150.0, scale, disturbed);
    let has_disturbance = (0..count)
        .flat_map(|level| recording.disturbance(level))
        .any(|&value| value > DISTURBANCE_FLOOR);
    if has_disturbance {
        chart.panels.push(disturbed);
    }
    let of_levels = (0..count).map(|level| (names(level), recording.share(level), level));
    let of_null = ("null space".to_string(), recording.null_share(), null);
    let shares: Vec<_> = of_levels.chain(std::iter::once(of_null)).collect();
    if shares
        .iter()
        .any(|(_, share, _)| share.iter().any(|&share| share < LEAST_CUT))
    {
        let lines = shares.into_iter().map(|(name, share, colour)| {
            let percent: Vec<_> = share.iter().map(|share| 100.0 * share).collect();
            recording.line(name, &percent, Style::solid(colour))
        });
        let scale = Scale::Within([0.0, 105.0]);
        chart
            .panels
            .push(Panel::new("share [%]", 110.0, scale, lines.collect()));
    }
    let most = recording.pivots().iter().copied().fold(0.0, f64::max);
    if most > 0.0 {
        let line = recording.line("", recording.pivots(), Style::new(6, Stroke::Solid));
        // Whole numbers, two of them at least.
        let scale = Scale::Within([0.0, most.max(2.0) + 0.2]);
        chart
            .panels
            .push(Panel::new("exchanges", 80.0, scale, vec![line]));
    }
    let caption = "Limits met by levels. Bars: released, a direction is given to the levels below; \
                   degraded, it is driven less than the level asks; shaped, the command is \
                   shortened; scaled, the joints give only a share. Disturbance: task acceleration \
                   that the bounds of the joints take from a level, logarithmic, zero at the lower \
                   edge. Share: of what a level or the null space asks the joints for. Exchanges: \
                   of the projection onto the bounds, in a cycle; 12 are the most.";
    figure(run, "limits-levels.svg", caption, &chart)
}

/// Positions, speeds and torques of the joints that came to a bound, as shares of what they may
/// be.
fn joints(run: &Run<'_>) -> Option<Figure> {
    let recording = run.recording;
    let at_bound: Vec<_> = (0..DOF)
        .filter(|&joint| {
            recording.met().joints[joint]
                .iter()
                .any(|side| !side.0.is_empty())
        })
        .collect();
    let mut chart = chart(
        run,
        "limits-joints",
        "Joints at their bounds",
        "Position, speed and torque of the joints that came to a bound, as shares of their \
         limits, over time.",
    );
    let links = &recording.arm().parameters.links;
    let panel = |&joint: &usize| {
        let link = &links[joint];
        let [least, greatest] = link.position_range.map(f64::to_degrees);
        let (middle, half) = (f64::midpoint(least, greatest), 0.5 * (greatest - least));
        let share = |values: &[f64], middle: f64, whole: f64| -> Vec<f64> {
            let share = |value: &f64| 100.0 * (value - middle) / whole;
            values.iter().map(share).collect()
        };
        let position = share(recording.q_deg(joint), middle, half);
        let speed = share(recording.dq(joint), 0.0, link.speed_limit);
        let torque = share(recording.torque(joint), 0.0, link.torque_limit);
        let lines = vec![
            recording.line("torque", &torque, Style::new(6, Stroke::Thin)),
            recording.line("speed", &speed, Style::solid(1)),
            recording.line("position", &position, Style::solid(0)),
        ];
        let label = format!("{} [%]", link.name);
        let height = Panel::height_among(at_bound.len()).min(150.0);
        let mut panel = Panel::new(label, height, Scale::Within(OF_LIMITS), lines);
        panel.limits = [100.0, -100.0]
            .map(|value| LimitLine {
                value,
                label: "limit".into(),
            })
            .into();
        panel.edges = recording.met().joints[joint]
            .each_ref()
            .map(|side| side.0.clone());
        panel
    };
    chart.panels = at_bound.iter().map(panel).collect();
    let caption = "Joints at their bounds, those that came to one: true position from the middle \
                   of the range, true speed and torque, of what the arm may have. Bars along the \
                   upper edge: the joint could not be accelerated further up; along the lower \
                   edge: further down.";
    (!at_bound.is_empty()).then(|| figure(run, "limits-joints.svg", caption, &chart))
}

#[cfg(test)]
mod tests {
    use super::super::recording::Recording;
    use super::super::svg::well_formed;
    use super::super::{Run, run_report};
    use super::*;
    use crate::controllers::TorqueLaw;
    use crate::experiment::Experiment;
    use crate::plant::PlantOptions;
    use crate::summary::Summary;
    use cell::names::{MeasurementKind, NullStiffness, PlantKind};
    use cell::scenario::{NEAR_LIMITS, Scenario};

    fn run_of(scenario: Scenario) -> (Summary, Scenario, Recording) {
        let experiment = Experiment {
            scenario,
            plant: PlantKind::Ideal,
            contacts: true,
            controller: TorqueLaw::Hierarchical.into(),
            null_stiffness: NullStiffness::Normal,
            measurement: MeasurementKind::Direct,
            seed: 1,
            options: PlantOptions::default(),
        };
        let mut recording = Recording::new(&experiment.scenario, true);
        let controller = experiment.controller().expect("a controller");
        let sink = |sample: &record::run::Sample| {
            recording.push(sample);
            Ok(())
        };
        let summary = experiment.run(&controller, sink, |_| ()).expect("a run");
        recording.finish();
        (summary, experiment.scenario, recording)
    }

    /// Bars last as long as the sums of the summary say, but for the gaps that they close.
    #[test]
    fn a_run_that_met_limits_shows_them() {
        let (_, text) = NEAR_LIMITS
            .iter()
            .find(|(name, _)| *name == "fast-30-beyond-wrist")
            .expect("a scenario");
        let (summary, scenario, recording) = run_of(Scenario::parse(text).expect("valid"));
        let run = Run::new(&summary, &scenario, &recording);
        let files: Vec<_> = figures(&run).iter().map(|figure| figure.file).collect();
        assert_eq!(files, ["limits-levels.svg", "limits-joints.svg"]);
        let html = run_report(&run);
        well_formed(&html).expect("a page");
        assert!(html.contains("<h2>Limits met</h2>"));

        let events = summary.limit_events.as_ref().expect("known");
        let long = |spans: &super::super::met::Spans| -> f64 {
            spans.0.iter().map(|[from, to]| to - from).sum()
        };
        let gap = scenario.duration_s / 2000.0;
        let mut compared = 0;
        for (spans, events) in recording.met().levels.iter().zip(&events.levels) {
            let times = [
                events.stuck_s,
                events.released_s,
                events.degraded_s,
                events.shaped_s,
                events.scaled_s,
            ];
            for (spans, time) in spans.iter().zip(times) {
                let closed = long(spans) - time;
                assert!(closed > -1e-9 && closed <= gap * 20.0, "{closed}");
                compared += usize::from(time > 0.0);
            }
        }
        assert!(compared > 5, "{compared}");
        for (sides, events) in recording.met().joints.iter().zip(&events.joints) {
            let time: f64 = events.times().iter().sum();
            let closed = sides.iter().map(long).sum::<f64>() - time;
            assert!(closed > -1e-9 && closed <= gap * 20.0, "{closed}");
        }
    }

    #[test]
    fn a_run_that_met_none_has_the_report_of_before() {
        let mut scenario = Scenario::find("two-level").expect("built in");
        scenario.duration_s = 0.5;
        let (summary, scenario, recording) = run_of(scenario);
        let run = Run::new(&summary, &scenario, &recording);
        assert!(summary.limit_events.is_some());
        assert!(figures(&run).is_empty() && tables(&run).is_none());
        assert!(!run_report(&run).contains("Limits met"));
    }
}
