//! The paper in one command: every experiment, every claim, every figure.
//!
//! [`plan`] lists the runs; [`results`] holds what they reached; [`claims`] turns
//! each claim of section 6 into a sentence with a number and a verdict;
//! [`stability`] follows the Lyapunov functions; [`figures`](mod@figures) and
//! [`page`] show all of it.

pub mod claim;
pub mod claims;
pub mod figures;
pub mod page;
pub mod plan;
pub mod results;
pub mod stability;

use std::io::{self, IsTerminal};
use std::path::Path;

use crate::interrupt;
use crate::output::Folder;
use crate::spread;
use crate::summary::Verdict as RunVerdict;
use cell::invalid::Invalid;
use cell::terminal::{print, show, tell};
use claim::{Claim, Verdict};
use results::Results;

/// Does everything and writes it to `out`: report.html, verdicts.json, figures,
/// and the summary of every run. Exit code 1 if a limit is exceeded; a claim of
/// the paper that does not hold is a result, not a failure. Exit code 3 if it was
/// interrupted; then nothing is written.
///
/// # Errors
/// The output folder cannot be written.
pub fn run(out: &Path) -> Result<u8, Invalid> {
    let mut folder = Folder::claim(out)?;
    interrupt::heed();
    let terminal = io::stderr().is_terminal();
    let workers = spread::processors();
    let results = Results::of(&plan::all()?, workers, |done, all| {
        if terminal {
            show(format_args!("\r{done} of {all} runs"));
        }
    })?;
    let evidence = stability::evidence(workers)?;
    if terminal {
        show(format_args!("\r{:30}\r", ""));
    }
    // Figures of runs that were cut short are no evidence.
    let (Some(results), Some(evidence)) = (results, evidence) else {
        tell("error: interrupted: nothing was written");
        return Ok(RunVerdict::Stopped.exit_code());
    };
    let claims = claims::all(&results, &evidence);
    let drawings = figures::all(&results, &evidence);

    for outcome in results.outcomes() {
        let name = format!("runs/{}/summary.json", outcome.id);
        folder.add(name, &json(&outcome.summary)?)?;
    }
    for figure in &drawings {
        let name = format!("figures/{}", figure.file);
        folder.add(name, &figure.drawing.standalone())?;
    }
    folder.add("stability.json", &json(&evidence)?)?;
    let report = page::report(&results, &claims, &drawings, &evidence);
    folder.add("report.html", &report)?;
    folder.add("verdicts.json", &json(&claims)?)?;
    folder.publish()?;

    print(text(&claims, out))?;
    Ok(u8::from(claim::count(&claims, Verdict::OutOfLimit) > 0))
}

fn json(value: &impl serde::Serialize) -> Result<String, Invalid> {
    Ok(serde_json::to_string_pretty(value).map_err(Invalid::line)? + "\n")
}

/// One line per claim, and where the files are.
fn text(claims: &[Claim], out: &Path) -> String {
    let width = claims.iter().map(|claim| claim.id.len()).max();
    let width = width.unwrap_or(0);
    let row = |claim: &Claim| {
        let (verdict, figure) = (claim.verdict.name(), claim.figure());
        format!("{verdict:<14} {:<width$}  {figure}\n", claim.id)
    };
    let rows: String = claims.iter().map(row).collect();
    format!(
        "{rows}\n{}\nreport.html, verdicts.json, figures and runs are in {}\n",
        claim::tally(claims),
        out.display()
    )
}
