//! The arm that a file or an option names.

use std::fmt;
use std::path::Path;
use std::sync::Mutex;

use controller_core::arm::ArmParameters;
use serde::Deserialize;

use super::file::{self, OwnArm};
use crate::file::{is_path, text};
use crate::invalid::Invalid;

/// An arm by its name in the crate `arms`, or by the name of an arm file.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "String")]
pub struct Robot {
    named: String,
    table: Option<&'static ArmParameters>,
}

impl From<String> for Robot {
    /// As it is written; its table is found by [`Robot::find`].
    fn from(named: String) -> Self {
        Self { named, table: None }
    }
}

impl fmt::Display for Robot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.named)
    }
}

impl Robot {
    /// The names of all arms in the crate `arms`.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        arms::ALL.map(|arm| arm.name).into()
    }

    /// The arm that an option names; a file is looked for in the working directory.
    ///
    /// # Errors
    /// As of [`Robot::find`].
    pub fn found(named: &str) -> Result<Self, Invalid> {
        let mut robot = Self::from(named.to_string());
        robot.find(Path::new(""))?;
        Ok(robot)
    }

    /// Finds the table; a file is looked for in `folder`.
    ///
    /// # Errors
    /// An unknown name, a file that cannot be read, or anything in it that cannot be used.
    pub fn find(&mut self, folder: &Path) -> Result<(), Invalid> {
        let table = match is_path(&self.named) {
            true => read(&folder.join(&self.named))?,
            false => arms::by_name(&self.named)
                .ok_or_else(|| Invalid::name("robot", &self.named, &Self::names()))?,
        };
        self.table = Some(table);
        Ok(())
    }

    /// The table.
    ///
    /// # Errors
    /// Nobody has looked for it.
    pub fn table(&self) -> Result<&'static ArmParameters, Invalid> {
        let found = "an arm that was looked for";
        self.table
            .ok_or_else(|| Invalid::new("robot", &self.named, found))
    }
}

/// The table of an arm file.
fn read(path: &Path) -> Result<&'static ArmParameters, Invalid> {
    let of_file = |error: Invalid| {
        // The place in the arm file is none in the file that names it.
        Invalid::line(error.within(path.display())).in_table("robot")
    };
    let text = text(path).map_err(|error| {
        let allowed = format!("a readable arm file ({error})");
        Invalid::new("robot", path.display(), allowed)
    })?;
    file::parse(&text).map(kept).map_err(of_file)
}

/// The arm of a text, as [`Robot::find`] gives that of a file.
///
/// # Errors
/// The first line and key that cannot be used.
pub fn parse(text: &str) -> Result<&'static ArmParameters, Invalid> {
    file::parse(text).map(kept)
}

/// Tables of files live as long as the program, equal ones once.
static KEPT: Mutex<Vec<&'static ArmParameters>> = Mutex::new(Vec::new());

/// The table of an arm, kept.
pub fn kept(arm: OwnArm) -> &'static ArmParameters {
    // A panic elsewhere leaves a list that is whole.
    let mut all = KEPT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some(known) = all.iter().find(|known| arm.is(known)) {
        return known;
    }
    let arm = arm.leak();
    all.push(arm);
    arm
}
