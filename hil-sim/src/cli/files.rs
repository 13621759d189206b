//! The files of a run: trace, report, figures, summary.

use std::io;
use std::path::Path;

use crate::output::{Draft, Folder};
use crate::report::{self, Choices, Recording};
use crate::summary::Summary;
use crate::trace::{self, Trace};
use cell::invalid::Invalid;
use cell::scenario::Scenario;
use cell::terminal::tell;
use record::run::Sample;

/// From here on the size of trace.csv is said before a run \[GB\].
const NOTABLE_GB: f64 = 1.0;

/// Whether this is the word for no output at all; a folder of that name is `./none`.
pub fn is_none(out: &Path) -> bool {
    out.as_os_str() == "none"
}

/// An output folder of a command whose results are its files.
///
/// # Errors
/// It is the word for none.
pub fn needed(out: &Path) -> Result<&Path, Invalid> {
    match is_none(out) {
        true => Err(Invalid::new(
            "--out",
            "none",
            "a folder here; none is for hil-sim run",
        )),
        false => Ok(out),
    }
}

/// Says how large trace.csv will be, where that matters.
///
/// # Errors
/// It would be larger than `most_gb`.
pub fn announce(scenario: &Scenario, most_gb: f64) -> Result<(), Invalid> {
    let size_gb = trace::expected_bytes(scenario) / 1e9;
    if size_gb > most_gb {
        let given = format!("about {size_gb:.1} GB of {} cycles", scenario.cycles());
        let allowed = format!("at most {most_gb} GB; see --max-trace-gb");
        return Err(Invalid::new("trace.csv", given, allowed));
    }
    if size_gb > NOTABLE_GB {
        tell(format_args!(
            "note: trace.csv will have about {size_gb:.1} GB"
        ));
    }
    Ok(())
}

/// Files on their way: nothing is seen of them before [`Files::finish`].
pub struct Files {
    folder: Folder,
    trace: Trace<Draft>,
    recording: Recording,
}

impl Files {
    /// Files in `folder`. `contacts` says whether scripted contacts act.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(folder: Folder, scenario: &Scenario, contacts: bool) -> Result<Self, Invalid> {
        let trace = Trace::new(folder.draft("trace.csv")?, scenario)
            .map_err(|error| Invalid::line(error).within(folder.path().display()))?;
        Ok(Self {
            folder,
            trace,
            recording: Recording::new(scenario, contacts),
        })
    }

    /// Adds a cycle.
    ///
    /// # Errors
    /// The disk.
    pub fn push(&mut self, instant: &Sample) -> io::Result<()> {
        self.recording.push(instant);
        self.trace.push(instant)
    }

    /// An error of the disk, in one line.
    pub fn failed(&self, error: io::Error) -> Invalid {
        Invalid::line(error).within(self.folder.path().display())
    }

    /// Writes everything. `command` is the command line that repeats the run.
    ///
    /// # Errors
    /// The disk.
    pub fn finish(
        mut self,
        scenario: &Scenario,
        summary: &Summary,
        choices: Choices,
        command: Option<&str>,
    ) -> Result<(), Invalid> {
        self.recording.finish();
        let run = report::Run {
            choices,
            command,
            ..report::Run::new(summary, scenario, &self.recording)
        };
        let folder = &mut self.folder;
        for figure in report::figures(&run) {
            let name = format!("figures/{}", figure.file);
            folder.add(name, &figure.drawing.standalone())?;
        }
        folder.add("report.html", &report::run_report(&run))?;
        folder.keep(self.trace.finish())?;
        let json = serde_json::to_string_pretty(summary).map_err(Invalid::line)?;
        folder.add("summary.json", &(json + "\n"))?;
        self.folder.publish()
    }
}
