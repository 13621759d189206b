//! Why a controller cannot be frozen.

use std::fmt;

use controller_core::ConfigError;
use controller_core::ControllerConfig;
use controller_core::law::null_space::Posture;
use controller_core::task::Tracked;

/// Why a controller cannot be frozen.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FreezeError {
    /// It cannot be made.
    Config(ConfigError),
    /// Its loop has dead time, of so many cycles.
    DeadCycles(u8),
    /// A level, counted from 1, tracks an orientation.
    Orientation {
        /// The level.
        level: usize,
    },
    /// A level, counted from 1, looks at the age of its reference.
    Stale {
        /// The level.
        level: usize,
    },
    /// Its posture is integrated.
    Posture,
    /// It has room for tasks that are to come.
    Capacity,
    /// There is no posture in which none of its limits is active: so many were tried.
    NoOrdinaryPosture {
        /// How many.
        tried: usize,
    },
}

impl fmt::Display for FreezeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) => write!(f, "{error}"),
            Self::DeadCycles(cycles) => {
                write!(f, "dead time of {cycles} cycles; a frozen cycle allows 0")
            }
            Self::Orientation { level } => write!(
                f,
                "level {level} tracks an orientation; a frozen cycle allows positions"
            ),
            Self::Stale { level } => write!(
                f,
                "level {level} looks at the age of its reference; a frozen cycle allows none"
            ),
            Self::Posture => write!(
                f,
                "the posture is integrated; a frozen cycle allows a constant one"
            ),
            Self::Capacity => write!(
                f,
                "there is room for tasks to come; a frozen cycle allows those in force only"
            ),
            Self::NoOrdinaryPosture { tried } => write!(
                f,
                "in each of {tried} postures a limit is active; one without is needed"
            ),
        }
    }
}

impl std::error::Error for FreezeError {}

impl From<ConfigError> for FreezeError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

/// Whether what a configuration asks for can be frozen.
pub(crate) fn check(config: &ControllerConfig) -> Result<(), FreezeError> {
    if config.dead_cycles != 0 {
        return Err(FreezeError::DeadCycles(config.dead_cycles));
    }
    if config.null_space.posture != Posture::Constant {
        return Err(FreezeError::Posture);
    }
    let tasks = config.tasks.tasks();
    for (level, task) in (1..).zip(tasks) {
        if matches!(task.tracked, Tracked::Orientation(_)) {
            return Err(FreezeError::Orientation { level });
        }
        if task.stale.is_some() {
            return Err(FreezeError::Stale { level });
        }
    }
    let capacity = config.tasks.capacity();
    let rows: usize = tasks.iter().map(|task| task.axes.count()).sum();
    if capacity.levels != config.tasks.count_in_force() || capacity.rows != rows {
        return Err(FreezeError::Capacity);
    }
    Ok(())
}
