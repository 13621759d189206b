//! What a run tells while it goes on and in the end, and its files.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use bridge::protocol::{Protocol, Report};
use bridge::session::{CycleReport, Phase, Session};
use cell::invalid::Invalid;
use cell::terminal::tell;

use crate::recorder;
use crate::summary::{AuditSummary, Obstacle, Summary};

/// Cycles kept for the case of a fault: 2 s at 2 ms.
const FLIGHT: usize = 1000;

pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> Invalid {
    Invalid::new(
        "file",
        path.display(),
        format_args!("a file that can be written ({error})"),
    )
}

/// Makes the folder of a file that will be written at the end, and tries to
/// write to it now: an hour of motion is a bad time to find out.
pub(super) fn prepare(path: &Path) -> Result<(), Invalid> {
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        std::fs::create_dir_all(folder).map_err(|error| unwritable(path, &error))?;
    }
    let there = path.exists();
    let file = std::fs::OpenOptions::new()
        .append(true)
        .create(true)
        .open(path);
    file.map(drop).map_err(|error| unwritable(path, &error))?;
    if !there {
        // It only had to be possible.
        std::fs::remove_file(path).map_err(|error| unwritable(path, &error))?;
    }
    Ok(())
}

/// Where a file is or will be, whatever way its name goes; its folder is there.
pub(super) fn place(path: &Path) -> std::io::Result<PathBuf> {
    if path.exists() {
        return path.canonicalize();
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let folder = Path::new(".").join(folder).canonicalize()?;
    Ok(folder.join(path.file_name().unwrap_or_default()))
}

/// The last cycles, in a ring that is taken once.
pub(super) struct Flight<R> {
    cycles: VecDeque<CycleReport<R>>,
}

impl<R: Report> Flight<R> {
    pub(super) fn new() -> Self {
        Self {
            cycles: VecDeque::with_capacity(FLIGHT),
        }
    }

    pub(super) fn push(&mut self, cycle: &CycleReport<R>) {
        if self.cycles.len() == FLIGHT {
            self.cycles.pop_front();
        }
        self.cycles.push_back(*cycle);
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.cycles.len()
    }

    pub(super) fn csv(&self) -> Vec<u8> {
        let mut text = Vec::new();
        // Writing to memory does not fail.
        let _ = recorder::write_rows(&mut text, self.cycles.iter().copied());
        text
    }
}

/// Tells what happens, a line per change of phase.
pub(super) struct Teller {
    phase: Phase,
    obstacle: Option<Obstacle>,
    terminal: bool,
}

impl Teller {
    pub(super) fn new() -> Self {
        Self {
            phase: Phase::Waiting,
            obstacle: None,
            terminal: std::io::stderr().is_terminal(),
        }
    }

    /// A cycle, and what keeps the robot from taking torque in it.
    pub(super) fn tell<P: Protocol>(
        &mut self,
        session: &Session<P>,
        cycle: &CycleReport<P::Robot>,
        obstacle: Option<Obstacle>,
    ) {
        if obstacle != self.obstacle {
            self.obstacle = obstacle;
            // Nothing else says why nothing moves.
            if let Some(obstacle) = obstacle {
                tell(format_args!("{:8.3} s  {obstacle}", cycle.t_s));
            }
        }
        if cycle.phase == self.phase {
            return;
        }
        // Printing takes time and memory: rarely, and not while nobody looks.
        if self.terminal || self.phase == Phase::Waiting {
            let audit = AuditSummary::from(session.audit());
            let mut line = format!("{:8.3} s  {}", cycle.t_s, cycle.phase.name());
            if self.phase == Phase::Waiting {
                let _ = write!(line, "; robot's model: {audit}");
            }
            tell(line);
        }
        self.phase = cycle.phase;
    }
}

/// The closing lines.
pub(super) fn closing(summary: &Summary) -> String {
    let mut text = format!(
        "{}: {} answers, {}\n",
        summary.scenario, summary.answered, summary.reason
    );
    for (number, level) in (1..).zip(&summary.levels) {
        let (Some(rms), Some(max)) = (level.rms, level.max) else {
            continue;
        };
        let _ = writeln!(
            text,
            "level {number} {}: rms {rms:.3}, max {max:.3} (mm, or mrad of an orientation; from measured positions)",
            level.name
        );
    }
    let link = &summary.link;
    let rejected: u64 = link.rejected.values().sum();
    let _ = writeln!(
        text,
        "link: {} lost, {} stale, {rejected} rejected, {} from strangers, {} unproven",
        link.lost, link.stale, link.strangers, link.unproven
    );
    for (reason, count) in &link.rejected {
        let _ = writeln!(text, "rejected {count}: {reason}");
    }
    if let Some(references) = &summary.references {
        let _ = writeln!(text, "references: {references}");
    }
    let _ = writeln!(text, "robot's model: {}", summary.audit);
    if let Some(fci) = &summary.fci {
        let _ = writeln!(text, "{fci}");
    }
    let _ = writeln!(text, "compute: {}", summary.compute);
    let _ = writeln!(text, "latency: {}", summary.latency);
    text
}
