//! `hil-sim model`: an arm from a URDF, and what an arm is like.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use controller_core::arm::{ArmModel, ArmParameters};

use crate::model::c::c;
use crate::model::figures::Figures;
use crate::model::import::{Request, import};
use crate::model::rust::rust;
use crate::model::search::states;
use cell::arguments::values::number;
use cell::arm::robot::Robot;
use cell::arm::text;
use cell::file;
use cell::invalid::Invalid;
use cell::model::agreement::{Agreement, Apart};
use cell::model::chain::{Angles, Chain, Choice, Impossible};
use cell::model::urdf::Urdf;
use cell::ranges::Range;
use cell::terminal::{print, tell};

/// What `model` can be asked for.
pub(super) const COMMANDS: &[&str] = &["import", "check", "show"];

/// Range to either side of a continuous joint \[deg\].
const CONTINUOUS_DEG: Range<f64> = Range::above(0.0, 35_600.0);

/// Largest share of the largest entry by which a table and a URDF may differ.
const TOLERANCE: Range<f64> = Range::above(0.0, 1.0);

/// Random states of `check --against`.
const STATES: usize = 1000;

/// Options of `model`.
#[derive(Clone, Debug, Args)]
pub struct ModelOptions {
    #[command(subcommand)]
    command: Model,
}

#[derive(Clone, Debug, Subcommand)]
enum Model {
    /// Print the arm of a URDF as an arm file: seven turning joints, what is fixed to them merged
    Import(ImportOptions),
    /// Say what an arm is like; with --against, how far it is from a URDF
    Check(CheckOptions),
    /// Print an arm as an arm file, in Rust or in C
    Show(ShowOptions),
}

/// Where an arm starts and ends in a URDF.
#[derive(Clone, Debug, Args)]
struct Ends {
    /// Link that stands still [default: the root]
    #[arg(long)]
    base: Option<String>,
    /// Link at the end, whose frame is the flange [default: the only end there is]
    #[arg(long)]
    tip: Option<String>,
}

/// What is printed.
#[derive(Clone, Copy, Debug, Args)]
struct Form {
    /// A Rust constant, as those of the crate arms, instead of an arm file
    #[arg(long, conflicts_with = "c")]
    rust: bool,
    /// A C constant for stratum.h instead of an arm file
    #[arg(long)]
    c: bool,
}

#[derive(Clone, Debug, Args)]
struct ImportOptions {
    /// URDF; xacro has to be expanded first
    file: PathBuf,
    #[command(flatten)]
    ends: Ends,
    /// Name of the arm [default: that of the robot]
    #[arg(long)]
    name: Option<String>,
    #[arg(long, default_value = "360", value_parser = number(CONTINUOUS_DEG),
        help = format!("Range of continuous joints to either side in deg, {CONTINUOUS_DEG}"))]
    continuous_deg: f64,
    /// Put the nearest possible body in the place of one that cannot be
    #[arg(long)]
    nearest: bool,
    /// Search postures of the sampling bound now, for co-processors that have to start within milliseconds; else they are searched, for the very damping, whenever a controller is made
    #[arg(long)]
    postures: bool,
    #[command(flatten)]
    form: Form,
}

#[derive(Clone, Debug, Args)]
struct CheckOptions {
    /// Arm file, or an arm of the crate arms
    arm: String,
    /// URDF that M, g, C dq and the flange are held against
    #[arg(long)]
    against: Option<PathBuf>,
    #[command(flatten)]
    ends: Ends,
    #[arg(long, default_value = "1e-9", value_parser = number(TOLERANCE),
        help = format!("Largest difference to the URDF with exact right angles, as a share of \
            the largest entry, {TOLERANCE}"))]
    tolerance: f64,
}

#[derive(Clone, Debug, Args)]
struct ShowOptions {
    /// Arm file, or an arm of the crate arms
    arm: String,
    #[command(flatten)]
    form: Form,
}

impl ModelOptions {
    /// Does what was asked for, gives the exit code.
    ///
    /// # Errors
    /// Whatever was given that cannot be used.
    pub fn run(&self) -> Result<u8, Invalid> {
        match &self.command {
            Model::Import(options) => options.run(),
            Model::Check(options) => options.run(),
            Model::Show(options) => options.run(),
        }
    }
}

impl Ends {
    fn choice(&self, continuous_deg: f64, impossible: Impossible) -> Choice {
        Choice {
            base: self.base.clone(),
            tip: self.tip.clone(),
            continuous: continuous_deg.to_radians(),
            impossible,
        }
    }
}

impl Form {
    fn text(self, arm: &ArmParameters, comment: &str) -> String {
        match self {
            Self { rust: true, .. } => rust(arm, comment),
            Self { c: true, .. } => c(arm, comment),
            _ => text::text(arm, comment),
        }
    }
}

impl ImportOptions {
    fn run(&self) -> Result<u8, Invalid> {
        let text = urdf_text("URDF", &self.file)?;
        let source = self.file.file_name().unwrap_or_default().to_string_lossy();
        let impossible = match self.nearest {
            true => Impossible::Nearest,
            false => Impossible::Refused,
        };
        let request = Request {
            source: &source,
            name: self.name.as_deref(),
            choice: self.ends.choice(self.continuous_deg, impossible),
            has_postures: self.postures,
        };
        let import = import(&text, &request).map_err(|error| error.within(self.file.display()))?;
        for note in &import.notes {
            tell(format_args!("note: {}", Invalid::line(note)));
        }
        print(self.form.text(import.arm, &import.notes.join("\n")))?;
        Ok(0)
    }
}

impl CheckOptions {
    fn run(&self) -> Result<u8, Invalid> {
        let arm = Robot::found(&self.arm)?.table()?;
        let mut text = Figures::of(arm)
            .map_err(|error| error.within(arm.name))?
            .text();
        let mut agrees = true;
        if let Some(path) = &self.against {
            let urdf = urdf_text("--against", path)?;
            let lines = self
                .against(arm, &urdf)
                .map_err(|error| error.within(path.display()))?;
            writeln!(text, "\nagainst {}, {STATES} random states", path.display()).ok();
            text += &lines.0;
            agrees = lines.1;
        }
        print(text)?;
        Ok(u8::from(!agrees))
    }

    /// What is different from the URDF, and whether it agrees.
    fn against(&self, arm: &ArmParameters, urdf: &str) -> Result<(String, bool), Invalid> {
        let urdf = Urdf::parse(urdf)?;
        let choice = self.ends.choice(360.0, Impossible::Kept);
        let model = ArmModel::new(arm).map_err(Invalid::line)?;
        let agreement = |angles| {
            let chain = Chain::new(&urdf, &choice, angles)?;
            Ok(Agreement::of(arm, &model, &chain, states(arm, STATES)))
        };
        let (printed, exact) = (agreement(Angles::AsPrinted)?, agreement(Angles::Exact)?);
        let row = |label: &str, cells: [String; 5]| {
            let cells = cells.map(|cell| format!(" {cell:>10}")).concat();
            format!("{label:<20}{cells}\n")
        };
        let differences = |agreement: &Agreement| {
            let shown = |(_, apart): (&str, Apart)| format!("{:.1e}", apart.most);
            agreement.all().map(shown)
        };
        let mut lines = row("", exact.all().map(|(name, _)| name.to_string()));
        lines += &row("as printed", differences(&printed));
        lines += &row("right angles exact", differences(&exact));
        let share = exact.worst_share();
        let agrees = share <= self.tolerance;
        let word = if agrees { "agrees" } else { "differs" };
        let tolerance = self.tolerance;
        writeln!(
            lines,
            "{word}: by at most {share:.1e} of the largest entry; allowed: {tolerance:e}"
        )
        .ok();
        Ok((lines, agrees))
    }
}

impl ShowOptions {
    fn run(&self) -> Result<u8, Invalid> {
        let arm = Robot::found(&self.arm)?.table()?;
        print(self.form.text(arm, &format!("from {}", self.arm)))?;
        Ok(0)
    }
}

fn urdf_text(thing: &str, path: &Path) -> Result<String, Invalid> {
    file::text(path).map_err(|error| {
        let allowed = format!("a readable URDF ({error})");
        Invalid::new(thing, path.display(), allowed)
    })
}
