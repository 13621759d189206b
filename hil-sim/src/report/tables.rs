//! The tables of a report.

use std::fmt::{Display, Write};

use super::svg::escape;
use super::ticks::{figure, plain};
use super::{Run, letter};
use crate::metrics::LevelFigures;
use crate::robot::{Event, FciFigures, LinkFigures, OwnLateness};
use cell::scenario::{LevelSpec, Metric, Unit};

/// A table under construction: rows of cells that are HTML already.
pub(crate) struct Table {
    html: String,
}

impl Table {
    /// `columns` are titles; those that begin with `#` hold numbers.
    pub fn new(caption: &str, columns: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        let caption = escape(caption);
        let mut html =
            format!("<div class=\"scroll\"><table>\n<caption>{caption}</caption>\n<thead><tr>");
        for column in columns {
            let (class, title) = numeric(column.as_ref());
            let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(title));
        }
        html += "</tr></thead>\n<tbody>\n";
        Self { html }
    }

    /// A row: its heading, then cells; a cell that begins with `#` is a number.
    pub fn row(&mut self, heading: &str, cells: impl IntoIterator<Item = String>) {
        let _ = write!(self.html, "<tr><th scope=\"row\">{heading}</th>");
        for cell in cells {
            let (class, text) = numeric(&cell);
            let _ = write!(self.html, "<td{class}>{text}</td>");
        }
        self.html += "</tr>\n";
    }

    pub fn finish(self) -> String {
        self.html + "</tbody></table></div>\n"
    }
}

/// The class of a cell and what is in it.
fn numeric(cell: &str) -> (&str, &str) {
    match cell.strip_prefix('#') {
        Some(number) => (" class=\"n\"", number),
        None => ("", cell),
    }
}

pub(crate) fn number(value: Option<f64>) -> String {
    format!("#{}", value.map_or("\u{2013}".to_string(), figure))
}

/// A table of single numbers.
fn numbers<'a>(caption: &str, rows: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut table = Table::new(caption, ["Quantity", "#Value"]);
    for (name, cell) in rows {
        table.row(name, [cell]);
    }
    table.finish()
}

fn count(count: impl Display) -> String {
    format!("#{count}")
}

/// The units of some levels: "mm", "mrad" or "mm, mrad".
pub(crate) fn units(levels: impl Iterator<Item = Unit>) -> String {
    let used: Vec<_> = levels.collect();
    let all = [Unit::Millimetre, Unit::Milliradian].into_iter();
    let suffixes: Vec<_> = all
        .filter(|unit| used.contains(unit))
        .map(Unit::suffix)
        .collect();
    suffixes.join(", ")
}

/// Limits, what was reached, and whether that is good enough.
pub fn acceptance(run: &Run<'_>) -> String {
    let all = &run.summary.acceptance;
    if all.is_empty() {
        return "<p>The scenario sets no limits for this plant with these contacts, measurement \
                and dead cycles: nothing was judged.</p>\n"
            .to_string();
    }
    let levels = &run.scenario.levels;
    let unit = units(levels.iter().map(|level| Unit::of(level.task)));
    let [limit, value] = ["Limit", "Value"].map(|name| format!("#{name} [{unit}]"));
    let mut table = Table::new(
        "Every metric must be below its limit.",
        ["Metric", &limit, &value, "#Used", "Result"],
    );
    for one in all {
        let used = |value| format!("#{:.0}\u{a0}%", 100.0 * value / one.limit);
        let result = match one.pass {
            Some(true) => "<span class=\"pass\">\u{2713} pass</span>",
            Some(false) => "<span class=\"fail\">\u{2717} fail</span>",
            None => "<span class=\"none\">\u{2013} not judged: no samples</span>",
        };
        let [name, metric] = [&metric_name(&one.metric, levels), &one.metric].map(|t| escape(t));
        table.row(
            &format!("{name} <code>{metric}</code>"),
            [
                format!("#&lt;\u{a0}{}", plain(one.limit)),
                number(one.value),
                one.value.map_or_else(|| number(None), used),
                result.to_string(),
            ],
        );
    }
    table.finish()
}

/// "rms error of level 1, flange xyz".
fn metric_name(name: &str, levels: &[LevelSpec]) -> String {
    let (what, level) = match Metric::parse(name, levels) {
        Ok(Metric::Rms(level)) => ("rms error", level),
        Ok(Metric::Max(level)) => ("largest error", level),
        Ok(Metric::Plateau(level)) => ("worst plateau", level),
        Err(_) => return String::new(),
    };
    format!("{what} of level {}, {}", level + 1, levels[level].label())
}

/// Tracking figures per level.
pub fn levels(run: &Run<'_>) -> String {
    let mut table = Table::new(
        "Task error of every level. Inside: during contacts and 0.3 s after them.",
        [
            "Level",
            "#rms",
            "#Largest",
            "#rms inside",
            "#rms outside",
            "#Worst plateau",
        ],
    );
    for (place, level) in (1..).zip(&run.summary.levels) {
        let plateaus = level.plateaus().enumerate();
        let worst = plateaus.filter_map(|(k, value)| Some((k, value?)));
        let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
        let worst = worst.map(|(k, value)| format!("#{} ({})", figure(value), letter(k)));
        let (name, unit) = (escape(&level.name), level.unit().suffix());
        table.row(
            &format!("{place} {name}, {unit}"),
            [
                number(level.rms()),
                number(level.max()),
                number(level.rms_inside_mm),
                number(level.rms_outside_mm),
                worst.unwrap_or_else(|| number(None)),
            ],
        );
    }
    table.finish()
}

/// Who pushed where, when, how hard, and how far each level gave way.
pub fn contacts(run: &Run<'_>) -> String {
    let interval = |from, to| {
        let missed = if run.reached(from) {
            ""
        } else {
            ", not reached"
        };
        format!("{} to {}{missed}", plain(from), plain(to))
    };
    let pushes = run.pushes().iter().map(|push| {
        let force = push.force_n.map(plain).join(", ");
        let size = push.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        [
            escape(&push.point.label()),
            interval(push.from_s, push.to_s),
            format!("#{force}"),
            number(Some(size)),
        ]
    });
    let hands = run.hands().iter().map(|hand| {
        let largest = run.summary.hand_force_max_n;
        let largest = largest.map_or("\u{2013}".to_string(), figure);
        [
            format!("hand at {}", escape(&hand.point.label())),
            interval(hand.from_s, hand.to_s),
            "#see figure".to_string(),
            format!("#\u{2264}\u{a0}{largest}"),
        ]
    });
    let contacts: Vec<_> = pushes.chain(hands).collect();
    if contacts.is_empty() {
        return "<p>No contacts in this run.</p>\n".to_string();
    }
    let names = [
        "Contact",
        "Point",
        "Interval [s]",
        "#Force x, y, z [N]",
        "#|F| [N]",
    ];
    let levels = &run.summary.levels;
    let plateaus = (1..)
        .zip(levels)
        .map(|(place, level)| format!("#Plateau level {place} [{}]", level.unit().suffix()));
    let mut table = Table::new(
        "Contacts, lettered as in the figures. Plateau: mean error over the last 0.2 s before the \
         force ramps down.",
        names.map(String::from).into_iter().chain(plateaus),
    );
    for (index, cells) in contacts.into_iter().enumerate() {
        let plateau = |level: &LevelFigures| number(level.plateaus().nth(index).flatten());
        let badge = format!("<span class=\"badge\">{}</span>", letter(index));
        table.row(&badge, cells.into_iter().chain(levels.iter().map(plateau)));
    }
    table.finish()
}

/// Which tasks and gains changed, and what that did.
pub fn changes(run: &Run<'_>) -> String {
    let levels = &run.summary.levels;
    let errors = (1..)
        .zip(levels)
        .map(|(place, level)| format!("#Level {place} [{}]", level.unit().suffix()));
    let names = ["Change", "What", "Interval [s]", "#Torque step [Nm]"];
    let mut table = Table::new(
        "Changes of tasks and gains, numbered as in the figures: the largest change of a joint's \
         torque from one cycle to the next, and the largest error of the levels that are there all \
         the time.",
        names.map(String::from).into_iter().chain(errors),
    );
    for (number, change) in (1..).zip(&run.summary.changes) {
        let missed = if run.reached(change.from_s) {
            ""
        } else {
            ", not reached"
        };
        let cells = [
            escape(&change.what),
            format!("{} to {}{missed}", plain(change.from_s), plain(change.to_s)),
            format!("#{}", figure(change.torque_step_nm)),
        ];
        let errors = change.level_max.iter().map(|&most| self::number(most));
        let badge = format!("<span class=\"badge\">{number}</span>");
        table.row(&badge, cells.into_iter().chain(errors));
    }
    table.finish()
}

/// Torque, travel, estimate, limits and faults.
pub fn joints(run: &Run<'_>) -> String {
    let summary = run.summary;
    let joints = run.recording.arm().joints();
    let names =
        std::iter::once("Quantity".to_string()).chain(joints.map(|name| format!("#{name}")));
    let mut table = Table::new("Per joint.", names);
    let cells = |values: &[f64; 7]| values.map(|value| number(Some(value)));
    table.row("Largest |\u{3c4}| [Nm]", cells(&summary.torque.max_abs_nm));
    table.row("Travel [deg]", cells(&summary.joints.range_deg));
    let (limits, faults) = (&summary.limits, &summary.faults);
    let force = summary.hand_force_max_n;
    let force = force.map(|force| ("Largest hand force [N]", number(Some(force))));
    let rows = [
        ("rms of r [Nm]", number(summary.residual.rms_nm)),
        (
            "rms of r + \u{3c4}_ext, the error of the estimate [Nm]",
            number(summary.residual.rms_error_nm),
        ),
    ];
    let counts = [
        ("Cycles with a torque at its limit", limits.torque),
        (
            "Cycles with a task row that cannot be resolved",
            limits.rank,
        ),
        ("Cycles with a joint beyond its range", limits.position),
        ("Faults: implausible input", faults.implausible),
        ("Faults: torque not finite", faults.non_finite_torque),
    ];
    let rows = rows.into_iter().chain(force);
    let rows = rows.chain(counts.map(|(name, cycles)| (name, count(cycles))));
    table.finish() + &numbers("Observer, limits and faults.", rows)
}

/// How good the link was, and what happened on it.
pub fn link(link: &LinkFigures) -> String {
    let (states, levels) = (&link.state_cycles, &link.quality_cycles);
    let share = link.command_share.map(|share| share * 100.0);
    let rows = [
        ("Cycles in monitor state", count(states.monitor)),
        ("Cycles in command state", count(states.command)),
        ("Share of command state [%]", number(share)),
        ("Cycles of quality perfect", count(levels.perfect)),
        ("Cycles of quality ok", count(levels.ok)),
        ("Cycles of quality bad", count(levels.bad)),
        ("Cycles of quality unacceptable", count(levels.unacceptable)),
        ("Answers used", count(link.answers)),
        ("Cycles without answer in time", count(link.missed)),
        ("Answers after their cycle", count(link.late)),
        ("Answers lost", count(link.lost)),
        ("Answers repeated", count(link.repeated)),
        ("Answers overtaken", count(link.old)),
        ("Datagrams rejected", count(link.rejected.total())),
        ("Mean latency [ms]", number(link.latency_ms.mean)),
        ("Largest latency [ms]", number(link.latency_ms.max)),
        ("Jitter [ms]", number(link.jitter_ms)),
        ("Falls to monitor state", count(link.fallbacks)),
        ("Recoveries", count(link.recoveries)),
        (
            "Largest torque step that the link caused [Nm]",
            number(Some(link.largest_torque_step_nm)),
        ),
    ];
    let rows = rows.into_iter().chain(lateness(link.own_lateness.as_ref()));
    numbers(
        "Datagrams between robot and client, from the first answer on.",
        rows,
    ) + &events(&link.events)
}

/// The same of a robot with the FCI.
pub fn fci(fci: &FciFigures) -> String {
    let percent = |share: Option<f64>| number(share.map(|share| share * 100.0));
    let rows = [
        ("Version of the interface", count(u64::from(fci.version))),
        ("Motions", count(fci.motions)),
        ("Aborted by a reflex", count(fci.reflexes)),
        (
            "Share under the client's torque [%]",
            percent(fci.command_share),
        ),
        ("Commands in time", count(fci.commands)),
        ("Cycles without a command", count(fci.lost)),
        ("Least success rate [%]", percent(fci.success_rate_min)),
        ("Commands to an older state", count(fci.late)),
        ("Commands to a state that had one", count(fci.repeated)),
        ("Datagrams without a motion", count(fci.idle)),
        ("Datagrams that cannot be used", count(fci.unreadable)),
        (
            "Largest step of a commanded torque [Nm]",
            number(Some(fci.largest_torque_step_nm)),
        ),
    ];
    let rows = rows.into_iter().chain(lateness(fci.own_lateness.as_ref()));
    let errors = match fci.errors.is_empty() {
        true => String::new(),
        false => format!(
            "<p>Motions were aborted by {}.</p>\n",
            fci.errors.join(", ")
        ),
    };
    numbers("Commands of the client, in all motions.", rows) + &errors + &events(&fci.events)
}

/// How the robot itself kept the wall clock, where that decided.
fn lateness(own: Option<&OwnLateness>) -> impl Iterator<Item = (&'static str, String)> {
    own.into_iter().flat_map(|own| {
        [
            ("Robot's own late measurements", count(own.cycles)),
            (
                "They left late by more than [ms]",
                number(Some(own.bound_ms)),
            ),
            (
                "Robot's own lateness, p99.9 [ms]",
                number(Some(own.p999_ms)),
            ),
            (
                "Robot's own lateness, largest [ms]",
                number(Some(own.max_ms)),
            ),
        ]
    })
}

/// What happened, if anything did.
fn events(events: &[Event]) -> String {
    if events.is_empty() {
        return String::new();
    }
    let mut table = Table::new(
        "Events, by the time of the scenario and of the robot.",
        ["Event", "#t [s]", "#Robot [s]"],
    );
    for event in events {
        let times = [event.t_s, Some(event.robot_t_s)];
        table.row(&escape(&event.text), times.map(number));
    }
    table.finish()
}
