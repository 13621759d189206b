//! The files of a run: trace, report, figures, summary.

use std::io;
use std::path::{Path, PathBuf};

use crate::output::{self, Draft};
use crate::report::{self, Choices, Recording};
use crate::summary::Summary;
use crate::trace::Trace;
use cell::invalid::Invalid;
use cell::scenario::Scenario;
use record::run::Sample;

/// Files on their way: nothing is seen of them before [`Files::finish`].
pub struct Files {
    out: PathBuf,
    trace: Trace<Draft>,
    recording: Recording,
}

impl Files {
    /// Makes the folder `out`. `contacts` says whether scripted contacts act.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(out: &Path, scenario: &Scenario, contacts: bool) -> Result<Self, Invalid> {
        output::prepare(out)?;
        let trace = Trace::new(Draft::create(out, "trace.csv")?, scenario)
            .map_err(|error| Invalid::line(error).within(out.display()))?;
        Ok(Self {
            out: out.to_path_buf(),
            trace,
            recording: Recording::new(scenario, contacts),
        })
    }

    /// Adds a cycle.
    ///
    /// # Errors
    /// The disk.
    pub fn push(&mut self, scenario: &Scenario, instant: &Sample) -> io::Result<()> {
        self.recording.push(scenario, instant);
        self.trace.push(instant)
    }

    /// An error of the disk, in one line.
    pub fn failed(&self, error: io::Error) -> Invalid {
        Invalid::line(error).within(self.out.display())
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
        let out = &self.out;
        let figures = out.join("figures");
        output::prepare(&figures)?;
        for figure in report::figures(&run) {
            output::write(&figures, figure.file, &figure.drawing.standalone())?;
        }
        output::write(out, "report.html", &report::run_report(&run))?;
        let trace = self.trace.finish().commit();
        trace.map_err(|error| Invalid::line(error).within(out.display()))?;
        let json = serde_json::to_string_pretty(summary).map_err(Invalid::line)?;
        output::write(out, "summary.json", &(json + "\n"))
    }
}
