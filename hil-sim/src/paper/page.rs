//! The report of all experiments: one HTML file that needs nothing else.

use super::claim::{self, Claim, Verdict};
use super::results::{Outcome, Results};
use super::stability::Evidence;
use crate::metrics::LevelFigures;
use crate::report::figures::Figure;
use crate::report::html;
use crate::report::svg::escape;
use crate::report::tables::{Table, number as cell, units};
use crate::report::ticks;

const SECTIONS: [(&str, &str); 7] = [
    ("6.1", "6.1 Two levels: a circle while the body is pushed"),
    ("6.2", "6.2 Three levels"),
    ("6.3", "6.3 Discussion: residual, and a hand at the elbow"),
    (
        "attribution",
        "What the observer brings, and what the hierarchy",
    ),
    (
        "velocity",
        "The same priorities on velocity level, above the robot's position controller",
    ),
    ("stability", "Stability as the paper argues it"),
    ("errata", "Where the printed formulas fail"),
];

/// The report as text of one HTML file.
#[must_use]
pub fn report(
    results: &Results,
    claims: &[Claim],
    figures: &[Figure],
    evidence: &[Evidence],
) -> String {
    let mut body = header();
    body += &banner(claims);
    for (section, heading) in SECTIONS {
        let mut content = claims_table(claims.iter().filter(|claim| claim.section == section));
        if section == "stability" {
            content += &rises(evidence);
            content += "<p>(54) and (55) cannot hold as printed: under a constant push what \
                        converges is Z (K_q q~ \u{2212} \u{3c4}_ext), so q~ tends to the \
                        deflection that balances the push, not to zero. The plateaus of the \
                        null space in the figures below show it.</p>\n";
        }
        html::section(&mut body, heading, &content);
    }
    let numbered = (1..).zip(figures);
    let drawings = numbered.map(|(n, figure)| html::figure(n, &figure.drawing, &figure.caption));
    html::section(&mut body, "Figures", &drawings.collect::<String>());
    html::section(&mut body, "Runs", &runs(results));
    body += "<footer>\n<p>Repeat with</p>\n<pre>hil-sim paper --out DIR</pre>\n</footer>\n";
    html::page(
        "Hierarchical tracking with a compliant null space: every claim, measured",
        &body,
    )
}

fn header() -> String {
    "<header>\n<p class=\"kind\">Paper report</p>\n\
     <h1>Hierarchical tracking with a compliant null space</h1>\n\
     <p>Every claim of section 6 of Karami, Sadeghian, Keshmiri, Oriolo, Mechatronics 55 (2018) \
     171\u{2013}179, as a sentence with a measured number. On the realistic arm a number is the \
     worst over five seeds. <b>Confirmed</b>: the number says so. <b>Not confirmed</b>: the number \
     refutes a claim of the paper. <b>Out of limit</b>: a limit of this project is \
     exceeded.</p>\n</header>\n"
        .to_string()
}

fn banner(claims: &[Claim]) -> String {
    let (class, word) = match claim::count(claims, Verdict::OutOfLimit) {
        0 => ("pass", "ALL LIMITS KEPT"),
        _ => ("fail", "OUT OF LIMIT"),
    };
    html::verdict(class, word, &[&format!("{}.", claim::tally(claims))])
}

fn claims_table<'a>(claims: impl Iterator<Item = &'a Claim>) -> String {
    let columns = ["Claim", "#Measured", "#Limit", "Verdict", "Run"];
    let mut table = Table::new("Claims and what was measured.", columns);
    for claim in claims {
        let (class, mark) = match claim.verdict {
            Verdict::Confirmed => ("pass", "\u{2713}"),
            Verdict::NotConfirmed => ("stopped", "\u{2260}"),
            Verdict::OutOfLimit => ("fail", "\u{2717}"),
        };
        let verdict = claim.verdict.name();
        table.row(
            &escape(&claim.claim),
            [
                format!("#{}\u{a0}{}", ticks::figure(claim.measured), claim.unit),
                format!("#{}\u{a0}{}", claim.sense, claim::shown(claim.limit)),
                format!("<span class=\"{class}\">{mark}\u{a0}{verdict}</span>"),
                format!("<code>{}</code>", escape(&claim.run)),
            ],
        );
    }
    table.finish()
}

/// Rises of the Lyapunov functions at every cycle time.
fn rises(evidence: &[Evidence]) -> String {
    let columns = [
        "Function",
        "#Cycle [ms]",
        "#Cycles that rise",
        "#Largest rise / V(0)",
    ];
    let mut table = Table::new("Lyapunov functions along sampled runs, 2 s each.", columns);
    for one in evidence {
        let largest = match one.rises {
            0 => "#0".to_string(),
            _ => format!("#{:.1e}", one.largest_rise),
        };
        let (cycle, rises) = (ticks::plain(one.cycle_ms), one.rises);
        let cells = [format!("#{cycle}"), format!("#{rises}"), largest];
        table.row(&escape(&one.name), cells);
    }
    table.finish()
}

/// Every run with its figures, as in its summary.json.
fn runs(results: &Results) -> String {
    let columns = [
        "Run",
        "#rms",
        "#Largest",
        "#Worst plateau",
        "#r error [Nm]",
        "Verdict",
    ];
    let levels = results
        .outcomes()
        .flat_map(|outcome| &outcome.summary.levels);
    let caption = format!(
        "Per level, in {}; the first row of a run is level 1. The files are in \
         runs/NAME/summary.json.",
        units(levels.map(LevelFigures::unit))
    );
    let mut table = Table::new(&caption, columns);
    for Outcome { id, summary, .. } in results.outcomes() {
        for (number, level) in (1..).zip(&summary.levels) {
            let [name, residual, verdict] = match number {
                1 => [
                    format!("<code>{id}</code>"),
                    cell(summary.residual.rms_error_nm),
                    summary.verdict_word().to_string(),
                ],
                _ => [
                    format!("&emsp;level {number}"),
                    String::new(),
                    String::new(),
                ],
            };
            let figures = [level.rms(), level.max(), level.worst_plateau()].map(cell);
            table.row(&name, figures.into_iter().chain([residual, verdict]));
        }
    }
    table.finish()
}
