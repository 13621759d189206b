//! The report of all experiments: one HTML file that needs nothing else.

use super::claims::{self, Claim, Verdict};
use super::figures::Figure;
use super::results::Results;
use super::stability::Evidence;
use crate::report::html;
use crate::report::svg::escape;
use crate::report::tables::{Table, columns, number};
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
        "velocity-level",
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
    let drawings: Vec<_> = (1..)
        .zip(figures)
        .map(|(n, figure)| html::figure(n, &figure.drawing.inline(), &figure.caption))
        .collect();
    html::section(&mut body, "Figures", &drawings.concat());
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
    let count = |verdict| {
        claims
            .iter()
            .filter(|claim| claim.verdict == verdict)
            .count()
    };
    let out = count(Verdict::OutOfLimit);
    let (class, word, icon) = if out == 0 {
        (
            "pass",
            "ALL LIMITS KEPT",
            r#"<circle cx="20" cy="20" r="17"/><path d="M12 21l6 6 11-13"/>"#,
        )
    } else {
        (
            "fail",
            "OUT OF LIMIT",
            r#"<circle cx="20" cy="20" r="17"/><path d="M13.5 13.5l13 13m0-13l-13 13"/>"#,
        )
    };
    format!(
        "<section class=\"verdict {class}\" aria-label=\"Verdict\">\n<svg class=\"icon\" \
         viewBox=\"0 0 40 40\" aria-hidden=\"true\">{icon}</svg>\n<div><p class=\"word\">{word}</p>\n\
         <p>{} confirmed, {} not confirmed, {out} out of limit.</p></div>\n</section>\n",
        count(Verdict::Confirmed),
        count(Verdict::NotConfirmed)
    )
}

fn claims_table<'a>(claims: impl Iterator<Item = &'a Claim>) -> String {
    let names = columns(&["Claim", "#Measured", "#Limit", "Verdict", "Run"]);
    let mut table = Table::new("Claims and what was measured.", &names);
    for claim in claims {
        let (class, mark) = match claim.verdict {
            Verdict::Confirmed => ("pass", "\u{2713}"),
            Verdict::NotConfirmed => ("stopped", "\u{2260}"),
            Verdict::OutOfLimit => ("fail", "\u{2717}"),
        };
        let limit = claim
            .limit
            .map(|limit| format!("#{}\u{a0}{}", claim.sense, claims::shown(limit)));
        table.row(
            &escape(&claim.claim),
            &[
                format!("#{}\u{a0}{}", ticks::figure(claim.measured), claim.unit),
                limit.unwrap_or_default(),
                format!(
                    "<span class=\"{class}\">{mark}\u{a0}{}</span>",
                    claim.verdict.name()
                ),
                format!("<code>{}</code>", escape(&claim.run)),
            ],
        );
    }
    table.finish()
}

/// Rises of the Lyapunov functions at every cycle time.
fn rises(evidence: &[Evidence]) -> String {
    let names = columns(&[
        "Function",
        "#Cycle [ms]",
        "#Cycles that rise",
        "#Largest rise / V(0)",
    ]);
    let mut table = Table::new("Lyapunov functions along sampled runs, 2 s each.", &names);
    for one in evidence {
        table.row(
            &escape(&one.name),
            &[
                format!("#{}", ticks::plain(one.cycle_ms)),
                format!("#{}", one.rises),
                if one.rises == 0 {
                    "#0".to_string()
                } else {
                    format!("#{:.1e}", one.largest_rise)
                },
            ],
        );
    }
    table.finish()
}

/// Every run with its figures, as in its summary.json.
fn runs(results: &Results) -> String {
    let names = columns(&[
        "Run",
        "#rms",
        "#Largest",
        "#Worst plateau",
        "#r error [Nm]",
        "Verdict",
    ]);
    let mut table = Table::new(
        "Per level, in mm; the first row of a run is level 1. The files are in \
         runs/NAME/summary.json.",
        &names,
    );
    for outcome in results.outcomes() {
        for (level, figures) in outcome.summary.levels.iter().enumerate() {
            let first = level == 0;
            let name = if first {
                format!("<code>{}</code>", outcome.id)
            } else {
                format!("&emsp;level {}", level + 1)
            };
            let residual = outcome.summary.residual.rms_error_nm.filter(|_| first);
            table.row(
                &name,
                &[
                    number(figures.rms()),
                    number(figures.max()),
                    number(figures.worst_plateau()),
                    if first {
                        number(residual)
                    } else {
                        String::new()
                    },
                    if first {
                        outcome.summary.verdict_word().to_string()
                    } else {
                        String::new()
                    },
                ],
            );
        }
    }
    table.finish()
}
