//! The report of a run: one HTML file that needs nothing else.

use std::fmt::Write;

use super::svg::{Svg, escape};
use super::ticks::plain;
use super::{Run, diagram, figures, limits, palette, settings, tables};
use crate::summary::{Summary, Verdict};
use cell::names::{Named, Switch};
use cell::scenario::Scenario;

const PAGE_CSS: &str = include_str!("page.css");

/// The report as text of one HTML file, with style and drawings inside.
#[must_use]
pub fn run_report(run: &Run<'_>) -> String {
    let title = format!("{} \u{2013} {}", run.label(), run.summary.verdict_word());
    let mut body = header(run);
    body += &banner(run.summary);
    section(&mut body, "Acceptance", &tables::acceptance(run));
    section(&mut body, "Task levels", &tables::levels(run));
    section(&mut body, "Contacts", &tables::contacts(run));
    if !run.scenario.events.is_empty() {
        section(&mut body, "Changes", &tables::changes(run));
    }
    section(&mut body, "Figures", &drawings(run));
    if let Some(tables) = limits::tables(run) {
        section(&mut body, "Limits met", &tables);
    }
    section(&mut body, "Joints, observer, limits", &tables::joints(run));
    if let Some(link) = &run.summary.link {
        section(&mut body, "Link", &tables::link(link));
    }
    if let Some(fci) = &run.summary.fci {
        section(&mut body, "Link", &tables::fci(fci));
    }
    section(&mut body, "Settings", &settings::settings(run));
    body += &footer(run);
    page(&title, &body)
}

/// A whole page around `body`, with the style of pages and drawings. `body` is
/// HTML already.
#[must_use]
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n\
         <style>\n{}{PAGE_CSS}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escape(title),
        palette::drawing_css(),
    )
}

/// A section with its heading. `content` is HTML already.
pub fn section(body: &mut String, heading: &str, content: &str) {
    let _ = write!(
        body,
        "<section>\n<h2>{}</h2>\n{content}</section>\n",
        escape(heading)
    );
}

/// A numbered figure; `caption` is plain text.
#[must_use]
pub fn figure(number: usize, drawing: &Svg, caption: &str) -> String {
    format!(
        "<figure id=\"fig-{number}\">\n<div class=\"scroll\">{}</div>\n\
         <figcaption><b>Fig. {number}</b> {}</figcaption>\n</figure>\n",
        drawing.inline(),
        escape(caption)
    )
}

fn header(run: &Run<'_>) -> String {
    let summary = run.summary;
    let facts = [
        ("Controller", summary.controller.to_string()),
        ("Plant", summary.plant.to_string()),
        ("Contacts", Switch(summary.contacts).name().to_string()),
        ("Seed", summary.seed.to_string()),
        ("Duration", format!("{} s", plain(summary.duration_s))),
        ("Cycle", format!("{} ms", plain(summary.cycle_ms))),
    ];
    let fact = |(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n");
    let facts: String = facts.into_iter().map(fact).collect();
    format!(
        "<header>\n<p class=\"kind\">Run report</p>\n<h1>{}</h1>\n\
         <dl class=\"facts\">\n{facts}</dl>\n</header>\n",
        escape(&summary.scenario)
    )
}

/// A verdict as icon and colour by its `class`, word, and paragraphs of plain text.
#[must_use]
pub fn verdict(class: &str, word: &str, reasons: &[&str]) -> String {
    let icon = match class {
        "pass" => r#"<circle cx="20" cy="20" r="17"/><path d="M12 21l6 6 11-13"/>"#,
        "fail" => r#"<circle cx="20" cy="20" r="17"/><path d="M13.500 13.500l13 13m0-13l-13 13"/>"#,
        "stopped" => {
            r#"<path d="M13 3.500h14l9.500 9.500v14l-9.500 9.500h-14l-9.500-9.500v-14z"/><path d="M20 11v11m0 6v.5"/>"#
        }
        _ => r#"<circle cx="20" cy="20" r="17"/><path d="M12 20h16"/>"#,
    };
    let paragraph = |reason: &&str| format!("<p>{}</p>\n", escape(reason));
    let reasons: String = reasons.iter().map(paragraph).collect();
    format!(
        "<section class=\"verdict {class}\" aria-label=\"Verdict\">\n\
         <svg class=\"icon\" viewBox=\"0 0 40 40\" aria-hidden=\"true\">{icon}</svg>\n\
         <div><p class=\"word\">{word}</p>\n{reasons}</div>\n</section>\n"
    )
}

/// The verdict of a run with its reason. `summary` decides.
fn banner(summary: &Summary) -> String {
    let judged: Vec<_> = summary
        .acceptance
        .iter()
        .filter_map(|one| one.pass)
        .collect();
    let all = judged.len();
    let kept = judged.iter().filter(|&&pass| pass).count();
    let good = match all {
        0 => "The scenario sets no limit for such a run.",
        1 => "The one limit is kept.",
        _ => &format!("All {all} limits are kept."),
    };
    let reason = summary.reason.as_deref().unwrap_or(good);
    let word = summary.verdict_word().to_uppercase();
    let class = match summary.verdict {
        Verdict::Pass if all == 0 => "none",
        Verdict::Pass => "pass",
        Verdict::NotJudged => "none",
        Verdict::Fail => "fail",
        Verdict::Stopped => "stopped",
    };
    let note = match summary.verdict {
        Verdict::Stopped => Some(format!("The run ended after {} cycles.", summary.cycles)),
        Verdict::Fail | Verdict::NotJudged if all > 0 => {
            Some(format!("{kept} of {all} limits kept."))
        }
        _ => None,
    };
    // The reason of a failure is a list, that of a stop one sentence.
    let reasons: Vec<_> = match summary.verdict {
        Verdict::Stopped => vec![reason],
        _ => reason.split("; ").collect(),
    };
    let remarks = summary.remarks();
    let notes = note.iter().chain(&remarks).map(String::as_str);
    let reasons: Vec<_> = reasons.into_iter().chain(notes).collect();
    verdict(class, &word, &reasons)
}

fn drawings(run: &Run<'_>) -> String {
    let mut drawings: Vec<_> = figures::figures(run)
        .into_iter()
        .map(|figure| (figure.drawing, figure.caption))
        .collect();
    if run.summary.controller == "hierarchical" {
        let caption = "The controller of this run: references by priority, compliance in what \
                       the tasks leave free, external torque estimated from momentum and \
                       compensated on the tasks.";
        drawings.push((diagram::drawing(), caption.to_string()));
    }
    let numbered = (1..).zip(&drawings);
    let html = numbered.map(|(number, (drawing, caption))| figure(number, drawing, caption));
    html.collect()
}

fn footer(run: &Run<'_>) -> String {
    let command = run.command.map_or_else(|| command(run), str::to_string);
    let same = if run.by_client() {
        "With --lockstep the same client gives the same numbers again"
    } else {
        "The same command gives the same numbers on every machine"
    };
    format!(
        "<footer>\n<p>This run again:</p>\n<pre><code>{}</code></pre>\n\
         <p>Stratum {}. {same}; all of them are \
         in <code>summary.json</code> and <code>trace.csv</code> beside this file.</p>\n</footer>\n",
        escape(&command),
        env!("CARGO_PKG_VERSION")
    )
}

/// The command line that repeats the run: every choice named, and of the
/// scenario's own numbers those that it does not have by itself.
fn command(run: &Run<'_>) -> String {
    let summary = run.summary;
    let mut line = format!(
        "hil-sim run {} --plant {} --contacts {} --controller {} --seed {}",
        summary.scenario,
        summary.plant,
        Switch(summary.contacts).name(),
        summary.controller,
        summary.seed
    );
    let stiffness = run.choices.null_stiffness.name();
    if stiffness != "normal" {
        let _ = write!(line, " --null-stiffness {stiffness}");
    }
    let own = Scenario::find(&summary.scenario).ok();
    for (option, value, own) in [
        (
            "duration",
            summary.duration_s,
            own.as_ref().map(|own| own.duration_s),
        ),
        (
            "cycle-ms",
            summary.cycle_ms,
            own.as_ref().map(|own| own.cycle_ms),
        ),
    ] {
        if own != Some(value) {
            let _ = write!(line, " --{option} {value}");
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::super::figures::Figure;
    use super::super::recording::{ArmSnapshot, Recording};
    use super::super::svg::well_formed;
    use super::*;
    use crate::controllers::TorqueLaw;
    use crate::experiment::Experiment;
    use crate::plant::PlantOptions;
    use cell::names::PlantKind;
    use cell::names::{MeasurementKind, NullStiffness};
    use controller_core::joint::{JointState, JointVector};
    use record::run::{LevelSample, Sample};

    /// A short real summary, and a recording with what `value` gives.
    fn run(value: f64) -> (Summary, Scenario, Recording) {
        let mut scenario = Scenario::find("two-level").unwrap();
        scenario.duration_s = 0.2;
        let experiment = Experiment {
            scenario: scenario.clone(),
            plant: PlantKind::Realistic,
            contacts: true,
            controller: TorqueLaw::Hierarchical.into(),
            null_stiffness: NullStiffness::Normal,
            measurement: MeasurementKind::Direct,
            seed: 1,
            options: PlantOptions::default(),
        };
        let controller = experiment.controller().unwrap();
        let summary = experiment.run(&controller, |_| Ok(()), |_| ()).unwrap();
        let mut recording = Recording::new(&scenario, true);
        let joints = JointVector::repeat(value);
        for k in 0..100 {
            let level = LevelSample {
                error: value,
                leak: value,
                desired_point: [value; 3],
                actual_point: [value; 3],
                ..LevelSample::default()
            };
            let sample = Sample {
                t_s: f64::from(k) * 2e-3,
                state: JointState {
                    q: joints,
                    dq: joints,
                },
                torque: joints,
                residual: joints,
                mode: None,
                saturated: false,
                rank: false,
                tau_ext: joints,
                hand_force_n: value,
                conditioning: vec![value; 7],
                limits: None,
                levels: vec![level],
            };
            recording.push(&sample);
        }
        recording.arms.push(ArmSnapshot {
            t_s: 0.0,
            corners: vec![[value; 3]; 5],
        });
        recording.finish();
        (summary, scenario, recording)
    }

    #[test]
    fn reports_are_well_formed_whatever_was_recorded() {
        for value in [0.0, 1.0, -1e9, f64::NAN, f64::INFINITY] {
            let (summary, scenario, recording) = run(value);
            let run = Run::new(&summary, &scenario, &recording);
            let html = run_report(&run);
            well_formed(&html).unwrap_or_else(|error| panic!("{value}: {error}"));
            assert!(!html.contains("NaN"), "{value}");
            for Figure { file, drawing, .. } in figures::figures(&run) {
                let (name, svg) = (file, drawing.standalone());
                well_formed(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert!(svg.len() < 300_000 && !svg.contains("NaN"), "{name}");
            }
        }
    }

    #[test]
    fn an_empty_recording_is_a_report() {
        let (mut summary, scenario, _) = run(1.0);
        let recording = Recording::new(&scenario, true);
        summary.verdict = Verdict::Stopped;
        summary.reason = Some("joint 1 is not finite".into());
        well_formed(&run_report(&Run::new(&summary, &scenario, &recording))).unwrap();
    }

    #[test]
    fn names_are_escaped_and_the_verdict_is_a_word() {
        let (mut summary, scenario, recording) = run(1.0);
        summary.scenario = "<b>&\"".into();
        summary.verdict = Verdict::Fail;
        summary.reason = Some("a = 3 < 4; b".into());
        let html = run_report(&Run::new(&summary, &scenario, &recording));
        well_formed(&html).unwrap();
        assert!(html.contains("&lt;b&gt;&amp;&quot;") && !html.contains("<b>&\""));
        assert!(html.contains(">FAIL<") && html.contains("a = 3 &lt; 4"));
    }

    /// The damping that acts is the one that the settings show.
    #[test]
    fn settings_show_what_acted() {
        let (summary, scenario, recording) = run(1.0);
        let mut run = Run::new(&summary, &scenario, &recording);
        let own = "<td>4, 4, 3, 3, 0.4, 0.3, 0.03</td>";
        assert!(run_report(&run).contains(own));
        run.choices.options.dead_cycles = 1;
        let html = run_report(&run);
        assert!(!html.contains(own) && html.contains("c M with c = 10 /s"));
        assert!(html.contains("<td>direct, 1</td>"));
    }

    #[test]
    fn the_command_names_what_differs() {
        let (summary, scenario, recording) = run(1.0);
        let mut run = Run::new(&summary, &scenario, &recording);
        run.choices.null_stiffness = NullStiffness::High;
        assert_eq!(
            command(&run),
            "hil-sim run two-level --plant realistic --contacts on --controller hierarchical \
             --seed 1 --null-stiffness high --duration 0.2"
        );
    }
}
