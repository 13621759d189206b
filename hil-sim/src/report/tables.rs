//! The tables of a report.

use std::fmt::Write;

use super::svg::escape;
use super::ticks::{figure, plain};
use super::{Run, letter};
use crate::metrics::LevelFigures;
use crate::robot::LinkFigures;
use cell::names::Named;
use cell::scenario::{AxisGain, LevelSpec, Metric, PostureSpec, ReferenceSpec, TaskSpec};

/// A table under construction: rows of cells that are HTML already.
pub(crate) struct Table {
    html: String,
}

impl Table {
    /// `columns` are titles; those that begin with `#` hold numbers.
    pub fn new(caption: &str, columns: &[String]) -> Self {
        let mut html = format!(
            "<div class=\"scroll\"><table>\n<caption>{}</caption>\n<thead><tr>",
            escape(caption)
        );
        for column in columns {
            let (class, title) = match column.strip_prefix('#') {
                Some(title) => (" class=\"n\"", title),
                None => ("", column.as_str()),
            };
            let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(title));
        }
        html += "</tr></thead>\n<tbody>\n";
        Self { html }
    }

    /// A row: its heading, then cells; a cell that begins with `#` is a number.
    pub fn row(&mut self, heading: &str, cells: &[String]) {
        let _ = write!(self.html, "<tr><th scope=\"row\">{heading}</th>");
        for cell in cells {
            let _ = match cell.strip_prefix('#') {
                Some(number) => write!(self.html, "<td class=\"n\">{number}</td>"),
                None => write!(self.html, "<td>{cell}</td>"),
            };
        }
        self.html += "</tr>\n";
    }

    pub fn finish(self) -> String {
        self.html + "</tbody></table></div>\n"
    }
}

pub(crate) fn columns(names: &[&str]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}

pub(crate) fn number(value: Option<f64>) -> String {
    format!("#{}", value.map_or("\u{2013}".to_string(), figure))
}

/// Limits, what was reached, and whether that is good enough.
pub fn acceptance(run: &Run<'_>) -> String {
    let all = &run.summary.acceptance;
    if all.is_empty() {
        return "<p>The scenario sets no limits for this plant with these contacts, measurement \
                and dead cycles: nothing was judged.</p>\n"
            .to_string();
    }
    let turns = |level: &LevelSpec| level.task == TaskSpec::Orientation;
    let unit = if run.scenario.levels.iter().any(turns) {
        "mm, mrad"
    } else {
        "mm"
    };
    let [limit, value] = ["Limit", "Value"].map(|name| format!("#{name} [{unit}]"));
    let mut table = Table::new(
        "Every metric must be below its limit.",
        &columns(&["Metric", &limit, &value, "#Used", "Result"]),
    );
    for one in all {
        let used = one
            .value
            .map(|value| format!("#{:.0}\u{a0}%", 100.0 * value / one.limit));
        let result = match one.pass {
            Some(true) => "<span class=\"pass\">\u{2713} pass</span>",
            Some(false) => "<span class=\"fail\">\u{2717} fail</span>",
            None => "<span class=\"none\">\u{2013} not judged: no samples</span>",
        };
        let name = format!(
            "{} <code>{}</code>",
            escape(&metric_name(&one.metric, &run.scenario.levels)),
            escape(&one.metric)
        );
        table.row(
            &name,
            &[
                format!("#&lt;\u{a0}{}", plain(one.limit)),
                number(one.value),
                used.unwrap_or_else(|| number(None)),
                result.to_string(),
            ],
        );
    }
    table.finish()
}

/// "rms error of level 1, flange xyz".
fn metric_name(name: &str, levels: &[LevelSpec]) -> String {
    let Ok(metric) = Metric::parse(name, levels) else {
        return String::new();
    };
    let (what, level) = match metric {
        Metric::Rms(level) => ("rms error", level),
        Metric::Max(level) => ("largest error", level),
        Metric::Plateau(level) => ("worst plateau", level),
    };
    format!("{what} of level {}, {}", level + 1, levels[level].label())
}

/// Tracking figures per level.
pub fn levels(run: &Run<'_>) -> String {
    let mut table = Table::new(
        "Task error of every level. Inside: during contacts and 0.3 s after them.",
        &columns(&[
            "Level",
            "#rms",
            "#Largest",
            "#rms inside",
            "#rms outside",
            "#Worst plateau",
        ]),
    );
    for (index, level) in run.summary.levels.iter().enumerate() {
        let plateaus = level.plateau_mm.iter().chain(&level.plateau_mrad);
        let worst = plateaus.enumerate().filter_map(|(k, v)| Some((k, (*v)?)));
        let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
        table.row(
            &format!(
                "{} {}, {}",
                index + 1,
                escape(&level.name),
                level.unit().suffix()
            ),
            &[
                number(level.rms()),
                number(level.max()),
                number(level.rms_inside_mm),
                number(level.rms_outside_mm),
                worst.map_or_else(
                    || number(None),
                    |(k, value)| format!("#{} ({})", figure(value), letter(k)),
                ),
            ],
        );
    }
    table.finish()
}

/// Who pushed where, when, how hard, and how far each level gave way.
pub fn contacts(run: &Run<'_>) -> String {
    let (scripted, hands) = (run.pushes(), run.hands());
    if scripted.is_empty() && hands.is_empty() {
        return "<p>No contacts in this run.</p>\n".to_string();
    }
    let mut names = columns(&[
        "Contact",
        "Point",
        "Interval [s]",
        "#Force x, y, z [N]",
        "#|F| [N]",
    ]);
    for level in 1..=run.summary.levels.len() {
        let unit = run.summary.levels[level - 1].unit().suffix();
        names.push(format!("#Plateau level {level} [{unit}]"));
    }
    let mut table = Table::new(
        "Contacts, lettered as in the figures. Plateau: mean error over the last 0.2 s before the \
         force ramps down.",
        &names,
    );
    for (index, contact) in scripted.iter().enumerate() {
        let force = contact.force_n.map(plain).join(", ");
        let size = contact.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        let mut cells = vec![
            escape(&contact.point.label()),
            if run.reached(contact.from_s) {
                interval(contact.from_s, contact.to_s)
            } else {
                format!("{}, not reached", interval(contact.from_s, contact.to_s))
            },
            format!("#{force}"),
            number(Some(size)),
        ];
        let levels = run.summary.levels.iter();
        cells.extend(levels.map(|level| number(plateau(level, index))));
        table.row(&badge(index), &cells);
    }
    for (index, hand) in (scripted.len()..).zip(hands) {
        let largest = run
            .summary
            .hand_force_max_n
            .map_or("\u{2013}".to_string(), figure);
        let mut cells = vec![
            format!("hand at {}", escape(&hand.point.label())),
            interval(hand.from_s, hand.to_s),
            "#see figure".to_string(),
            format!("#\u{2264}\u{a0}{largest}"),
        ];
        let levels = run.summary.levels.iter();
        cells.extend(levels.map(|level| number(plateau(level, index))));
        table.row(&badge(index), &cells);
    }
    table.finish()
}

/// Plateau of a level in a contact, in the level's unit.
fn plateau(level: &LevelFigures, contact: usize) -> Option<f64> {
    let plateaus = level.plateau_mm.iter().chain(&level.plateau_mrad);
    plateaus.copied().nth(contact).flatten()
}

fn badge(index: usize) -> String {
    format!("<span class=\"badge\">{}</span>", letter(index))
}

fn interval(from: f64, to: f64) -> String {
    format!("{} to {}", plain(from), plain(to))
}

/// Torque, travel, estimate, limits and faults.
pub fn joints(run: &Run<'_>) -> String {
    let summary = run.summary;
    let mut names = columns(&["Quantity"]);
    names.extend((1..=7).map(|joint| format!("#Joint {joint}")));
    let mut table = Table::new("Per joint.", &names);
    let cells = |values: &[f64; 7]| values.map(|value| number(Some(value)));
    table.row("Largest |\u{3c4}| [Nm]", &cells(&summary.torque.max_abs_nm));
    table.row("Travel [deg]", &cells(&summary.joints.range_deg));
    let mut html = table.finish();

    let cycles = |count: usize| format!("#{count}");
    let mut table = Table::new(
        "Observer, limits and faults.",
        &columns(&["Quantity", "#Value"]),
    );
    table.row("rms of r [Nm]", &[number(summary.residual.rms_nm)]);
    table.row(
        "rms of r + \u{3c4}_ext, the error of the estimate [Nm]",
        &[number(summary.residual.rms_error_nm)],
    );
    if let Some(force) = summary.hand_force_max_n {
        table.row("Largest hand force [N]", &[number(Some(force))]);
    }
    table.row(
        "Cycles with a torque at its limit",
        &[cycles(summary.limits.torque)],
    );
    table.row(
        "Cycles with a task row that cannot be resolved",
        &[cycles(summary.limits.rank)],
    );
    table.row(
        "Cycles with a joint beyond its range",
        &[cycles(summary.limits.position)],
    );
    table.row(
        "Faults: implausible input",
        &[cycles(summary.faults.implausible)],
    );
    table.row(
        "Faults: torque not finite",
        &[cycles(summary.faults.non_finite_torque)],
    );
    html += &table.finish();
    html
}

/// How good the link was, and what happened on it.
pub fn link(link: &LinkFigures) -> String {
    let mut table = Table::new(
        "Datagrams between robot and client, from the first answer on.",
        &columns(&["Quantity", "#Value"]),
    );
    let count = |count: u64| format!("#{count}");
    let (states, levels) = (&link.state_cycles, &link.quality_cycles);
    table.row("Cycles in monitor state", &[count(states.monitor)]);
    table.row("Cycles in command state", &[count(states.command)]);
    let share = link.command_share.map(|share| share * 100.0);
    table.row("Share of command state [%]", &[number(share)]);
    table.row("Cycles of quality perfect", &[count(levels.perfect)]);
    table.row("Cycles of quality ok", &[count(levels.ok)]);
    table.row("Cycles of quality bad", &[count(levels.bad)]);
    table.row(
        "Cycles of quality unacceptable",
        &[count(levels.unacceptable)],
    );
    table.row("Answers used", &[count(link.answers)]);
    table.row("Cycles without answer in time", &[count(link.missed)]);
    table.row("Answers after their cycle", &[count(link.late)]);
    table.row("Answers lost", &[count(link.lost)]);
    table.row("Answers repeated", &[count(link.repeated)]);
    table.row("Answers overtaken", &[count(link.old)]);
    table.row("Datagrams rejected", &[count(link.rejected.total())]);
    table.row("Mean latency [ms]", &[number(link.latency_ms.mean)]);
    table.row("Largest latency [ms]", &[number(link.latency_ms.max)]);
    table.row("Jitter [ms]", &[number(link.jitter_ms)]);
    table.row("Falls to monitor state", &[count(link.fallbacks)]);
    table.row("Recoveries", &[count(link.recoveries)]);
    table.row(
        "Largest torque step that the link caused [Nm]",
        &[number(Some(link.largest_torque_step_nm))],
    );
    let mut html = table.finish();
    if link.events.is_empty() {
        return html;
    }
    let mut table = Table::new(
        "Events, by the time of the scenario and of the robot.",
        &columns(&["Event", "#t [s]", "#Robot [s]"]),
    );
    for event in &link.events {
        table.row(
            &escape(&event.text),
            &[number(event.t_s), number(Some(event.robot_t_s))],
        );
    }
    html += &table.finish();
    html
}

/// Gains, references, cycle: what the run was set to.
pub fn settings(run: &Run<'_>) -> String {
    let (scenario, summary) = (run.scenario, run.summary);
    let caption = if run.by_client() {
        "Arm and motion that the client is held against; its gains are its own."
    } else {
        "Gains as they acted, with the chosen null-space stiffness."
    };
    let mut table = Table::new(caption, &columns(&["Setting", "Value"]));
    let mut row = |name: &str, value: String| table.row(&escape(name), &[escape(&value)]);
    row("Arm", scenario.robot.clone());
    row(
        "Plant, seed",
        format!("{}, {}", summary.plant, summary.seed),
    );
    row("Controller", summary.controller.to_string());
    row(
        "Duration, cycle",
        format!(
            "{} s, {} ms, {} cycles run",
            plain(summary.duration_s),
            plain(summary.cycle_ms),
            summary.cycles
        ),
    );
    let options = &run.choices.options;
    row(
        "Measurement, dead cycles",
        format!(
            "{}, {}",
            run.choices.measurement.name(),
            options.dead_cycles
        ),
    );
    let beyond = [
        (options.stiction, "stiction"),
        (options.elasticity, "elastic joints"),
    ];
    for (_, effect) in beyond.iter().filter(|(on, _)| *on) {
        row("Plant option", effect.to_string());
    }
    let start = if run.by_client() {
        "Start posture [deg]"
    } else {
        "Start posture, also q_d [deg]"
    };
    row(start, list(&scenario.start_deg));
    for (number, level) in (1..).zip(&scenario.levels) {
        row(
            &format!("Level {number}: task"),
            format!("{}: {}", level.label(), reference(level)),
        );
        if run.by_client() {
            continue;
        }
        row(
            &format!("Level {number}: K_p [1/s\u{b2}], K_d [1/s]"),
            format!("{}; {}", gain(&level.stiffness), gain(&level.damping)),
        );
    }
    if run.by_client() {
        return table.finish();
    }
    let null = &scenario.null_space;
    let factor = run.choices.null_stiffness.factor();
    row(
        "Null space: K_q [Nm/rad]",
        list(&null.stiffness.map(|k| factor * k)),
    );
    if run.choices.has_inertia_damping() {
        let rate = plain(null.damping_rate);
        row("Null space: D [Nms/rad]", format!("c M with c = {rate} /s"));
    } else {
        row("Null space: D [Nms/rad]", list(&null.damping));
    }
    let posture = match null.posture {
        PostureSpec::Constant => "constant",
        PostureSpec::IntegralCoupled => "integral, coupled",
        PostureSpec::IntegralUncoupled => "integral, uncoupled",
    };
    row("Null space: posture q_d", posture.to_string());
    if summary.controller.starts_with("acceleration-level") {
        row("Null space: rate gain [1/s]", plain(null.rate_gain));
    }
    row("Observer: K_I [1/s]", plain(scenario.observer.gain));
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
    let (kind, turn) = match &level.reference {
        ReferenceSpec::Hold {} => return "held".to_string(),
        ReferenceSpec::Move { by_m, duration_s } => {
            return format!("moved by ({}) m in {} s", list(by_m), plain(*duration_s));
        }
        ReferenceSpec::Swing(swing) => {
            return format!(
                "swing about ({}), {} deg reached in {} s, {} s a swing",
                list(&swing.axis),
                plain(swing.angle_deg),
                plain(swing.growth_s),
                plain(swing.period_s)
            );
        }
        ReferenceSpec::Circle(turn) => ("circle", turn),
        ReferenceSpec::Spiral(turn) => ("spiral", turn),
    };
    format!(
        "{kind} in {}, radius {} m reached in {} s, {} s a turn",
        format!("{:?}", turn.plane).to_uppercase(),
        plain(turn.radius_m),
        plain(turn.growth_s),
        plain(turn.period_s)
    )
}
