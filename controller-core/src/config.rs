//! Configuration of a controller, validated once.

use core::fmt;

use heapless::Vec;

use crate::damping::{self, DampingRate};
use crate::joint::{DOF, JointMatrix, JointVector, Matrix3};
use crate::law::{NullDamping, NullSpace};
use crate::linalg::Cholesky;
use crate::model::{ArmModel, ModelError};
use crate::real::Real;
use crate::task::{MAX_LEVELS, MAX_ROWS, Task};

/// Nominal cycle times that make sense \[s\].
pub const CYCLE_RANGE_S: [f64; 2] = [1e-4, 20e-3];

/// Largest |gain| accepted: beyond it single precision overflows in the law.
pub const GAIN_MAX: f64 = 1e9;

/// Most cycles of dead time.
pub const DEAD_CYCLES_MAX: u8 = 8;

/// Largest h c of an inertia-shaped damping D = c M.
pub const INERTIA_DAMPING_BOUND: f64 = 0.5;

/// What a controller is made of, besides the arm.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerConfig<T: Real> {
    /// The tasks in priority order, highest first: 1 to 7 rows in all.
    pub tasks: Vec<Task<T>, MAX_LEVELS>,
    /// Compliance of what the tasks leave.
    pub null_space: NullSpace<T>,
    /// K_I \[1/s\] per joint, diagonal: bandwidth of the external-torque estimate.
    pub observer_gain: JointVector<T>,
    /// Nominal cycle \[s\].
    pub cycle_s: T,
    /// Cycles between a measurement and the moment its torque acts, beyond the
    /// zero-order hold: 0 for a direct link. Lowers the damping that is allowed,
    /// see [`damping::bound`].
    pub dead_cycles: u8,
}

/// Which gain matrix an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum Gain {
    /// K_p of a task level.
    TaskStiffness,
    /// K_d of a task level.
    TaskDamping,
    /// K_q.
    NullStiffness,
    /// D.
    NullDamping,
}

impl Gain {
    fn name(self) -> &'static str {
        match self {
            Self::TaskStiffness => "task stiffness [1/s2]",
            Self::TaskDamping => "task damping [1/s]",
            Self::NullStiffness => "null-space stiffness [Nm/rad]",
            Self::NullDamping => "null-space damping [Nms/rad]",
        }
    }
}

/// Why a configuration is refused. Levels and joints count from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigError {
    /// The tables of the arm. [`ControllerConfig::validate`] never says this: it is
    /// there so that arm and configuration fail with one type.
    Model(ModelError),
    /// The tasks have no rows, or more than there are joints.
    Rows {
        /// Rows of all levels.
        rows: usize,
    },
    /// A task has no axis.
    NoAxis {
        /// Its level.
        level: usize,
    },
    /// A task point on a link that does not exist.
    PointLink {
        /// Its level.
        level: usize,
        /// The link asked for.
        link: usize,
    },
    /// A task point whose offset is not finite or beyond 10 m.
    PointOffset {
        /// Its level.
        level: usize,
        /// The coordinate \[m\].
        value: f64,
    },
    /// An entry of a gain matrix is not finite, or beyond [`GAIN_MAX`].
    GainValue {
        /// Which matrix.
        gain: Gain,
        /// Level of a task gain, 0 for the null space.
        level: usize,
        /// The entry.
        value: f64,
    },
    /// A gain matrix is not symmetric.
    GainSymmetry {
        /// Which matrix.
        gain: Gain,
        /// Level of a task gain, 0 for the null space.
        level: usize,
        /// Row and column of the entry, counted from 1.
        entry: [usize; 2],
        /// The entry less its mirror image.
        difference: f64,
    },
    /// A gain matrix is not positive definite.
    GainDefinite {
        /// Which matrix.
        gain: Gain,
        /// Level of a task gain, 0 for the null space.
        level: usize,
        /// Joint or axis of the first pivot that is not positive.
        index: usize,
        /// That pivot.
        pivot: f64,
    },
    /// The observer gain of a joint is not above 0, or not finite.
    ObserverGain {
        /// The joint.
        joint: usize,
        /// Its gain \[1/s\].
        value: f64,
    },
    /// The nominal cycle is outside [`CYCLE_RANGE_S`].
    Cycle {
        /// The cycle \[s\].
        value: f64,
    },
    /// More dead time than [`DEAD_CYCLES_MAX`].
    DeadCycles {
        /// The cycles.
        value: u8,
    },
    /// The rate of an inertia-shaped damping is not above 0, or not finite.
    InertiaDamping {
        /// The rate \[1/s\].
        value: f64,
    },
    /// The null-space damping is too strong for the cycle.
    Damping {
        /// The joint that dissipates most.
        joint: usize,
        /// h lambda_max(L^-1 D L^-T).
        value: f64,
        /// What it must stay below.
        bound: f64,
        /// Posture \[rad\] where it occurs.
        posture: [f64; DOF],
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = |f: &mut fmt::Formatter<'_>, gain: Gain, level: usize| {
            if level > 0 {
                write!(f, "level {level}: ")?;
            }
            write!(f, "{}", gain.name())
        };
        match *self {
            Self::Model(error) => error.fmt(f),
            Self::Rows { rows } => {
                write!(
                    f,
                    "the tasks have {rows} rows together; allowed 1 to {MAX_ROWS}"
                )
            }
            Self::NoAxis { level } => {
                write!(
                    f,
                    "level {level}: the task has no axis; it needs 1 to 3 of x, y, z"
                )
            }
            Self::PointLink { level, link } => {
                write!(f, "level {level}: point on link {link}; allowed 1 to {DOF}")
            }
            Self::PointOffset { level, value } => write!(
                f,
                "level {level}: point offset {value} m; allowed -{POINT_OFFSET_MAX} to \
                 {POINT_OFFSET_MAX}"
            ),
            Self::GainValue { gain, level, value } => {
                place(f, gain, level)?;
                write!(f, ": entry {value}; allowed -{GAIN_MAX:e} to {GAIN_MAX:e}")
            }
            Self::GainSymmetry {
                gain,
                level,
                entry: [row, column],
                difference,
            } => {
                place(f, gain, level)?;
                write!(
                    f,
                    ": entry ({row}, {column}) differs from ({column}, {row}) by {difference}; \
                     the matrix must be symmetric"
                )
            }
            Self::GainDefinite {
                gain,
                level,
                index,
                pivot,
            } => {
                place(f, gain, level)?;
                write!(
                    f,
                    ": pivot {pivot} at row {index}; the matrix must be positive definite \
                     (a diagonal one: every entry above 0)"
                )
            }
            Self::ObserverGain { joint, value } => write!(
                f,
                "observer gain of joint {joint} is {value} 1/s; it must be above 0 and at most \
                 {GAIN_MAX:e}"
            ),
            Self::Cycle { value } => {
                let [min, max] = CYCLE_RANGE_S;
                write!(f, "cycle {value} s; allowed {min} to {max}")
            }
            Self::DeadCycles { value } => {
                write!(
                    f,
                    "dead time of {value} cycles; allowed 0 to {DEAD_CYCLES_MAX}"
                )
            }
            Self::InertiaDamping { value } => write!(
                f,
                "inertia-shaped null-space damping {value} 1/s; it must be above 0 and at most \
                 {GAIN_MAX:e}"
            ),
            Self::Damping {
                joint,
                value,
                bound,
                posture,
            } => {
                write!(
                    f,
                    "null-space damping of joint {joint} is too strong for the cycle: \
                     h lambda_max = {value:.3} at the posture"
                )?;
                for q in posture {
                    write!(f, " {}", (q.to_degrees() + 0.5).floor_small() as i32)?;
                }
                write!(f, " deg; it must be below {bound:.3}")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

impl From<ModelError> for ConfigError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

/// Farthest point of a task from its link's frame \[m\].
const POINT_OFFSET_MAX: f64 = 10.0;

impl<T: Real> ControllerConfig<T> {
    /// Checks everything and returns the fastest null-space mode.
    ///
    /// # Errors
    /// The first thing that cannot be, with its value and what is allowed.
    pub fn validate(&self, model: &ArmModel<T>) -> Result<DampingRate, ConfigError> {
        let rows = self.tasks.iter().map(|task| task.axes.count()).sum();
        if !(1..=MAX_ROWS).contains(&rows) {
            return Err(ConfigError::Rows { rows });
        }
        for (level, task) in (1..).zip(&self.tasks) {
            validate_task(level, task)?;
        }
        let cycle = self.cycle_s.to_f64();
        // The range is meant in decimal: allow the rounding to T at its ends.
        let [min, max] = CYCLE_RANGE_S;
        if !(cycle >= min * (1.0 - 1e-6) && cycle <= max * (1.0 + 1e-6)) {
            return Err(ConfigError::Cycle { value: cycle });
        }
        for (joint, gain) in (1..).zip(&self.observer_gain) {
            let value = gain.to_f64();
            if !(value > 0.0 && value <= GAIN_MAX) {
                return Err(ConfigError::ObserverGain { joint, value });
            }
        }
        validate_gain(Gain::NullStiffness, 0, &self.null_space.stiffness)?;
        if self.dead_cycles > DEAD_CYCLES_MAX {
            return Err(ConfigError::DeadCycles {
                value: self.dead_cycles,
            });
        }
        self.validate_damping(model)
    }

    /// What h lambda must stay below. An inertia-shaped damping is held to half
    /// a cycle's decay: it is the same everywhere and never needs more.
    #[must_use]
    pub fn damping_bound(&self) -> f64 {
        let stable = damping::bound(self.dead_cycles);
        match self.null_space.damping {
            NullDamping::Joint(_) => stable,
            NullDamping::Inertia(_) => stable.min(INERTIA_DAMPING_BOUND),
        }
    }

    fn validate_damping(&self, model: &ArmModel<T>) -> Result<DampingRate, ConfigError> {
        let fastest = match &self.null_space.damping {
            NullDamping::Joint(matrix) => {
                validate_gain(Gain::NullDamping, 0, matrix)?;
                damping::fastest_mode(model, matrix)
            }
            NullDamping::Inertia(rate) => {
                let rate = rate.to_f64();
                if !(rate > 0.0 && rate <= GAIN_MAX) {
                    return Err(ConfigError::InertiaDamping { value: rate });
                }
                DampingRate {
                    rate,
                    joint: 1,
                    posture: [0.0; DOF],
                }
            }
        };
        let value = fastest.rate * self.cycle_s.to_f64();
        let bound = self.damping_bound();
        if value < bound {
            return Ok(fastest);
        }
        let DampingRate { joint, posture, .. } = fastest;
        Err(ConfigError::Damping {
            joint,
            value,
            bound,
            posture,
        })
    }
}

/// One level. Behind a call: its matrices leave the stack before the damping is
/// looked at.
#[inline(never)]
fn validate_task<T: Real>(level: usize, task: &Task<T>) -> Result<(), ConfigError> {
    if task.axes.count() == 0 {
        return Err(ConfigError::NoAxis { level });
    }
    let link = task.point.link;
    if !(1..=DOF).contains(&link) {
        return Err(ConfigError::PointLink { level, link });
    }
    for offset in &task.point.offset {
        let value = offset.to_f64();
        if !(-POINT_OFFSET_MAX..=POINT_OFFSET_MAX).contains(&value) {
            return Err(ConfigError::PointOffset { level, value });
        }
    }
    validate_gain(Gain::TaskStiffness, level, &embedded(task, &task.stiffness))?;
    validate_gain(Gain::TaskDamping, level, &embedded(task, &task.damping))
}

/// The controlled block of a task gain, completed by the identity to 7 x 7.
fn embedded<T: Real>(task: &Task<T>, gain: &Matrix3<T>) -> JointMatrix<T> {
    let mut matrix = JointMatrix::identity();
    for i in 0..3 {
        for j in 0..3 {
            if task.axes.xyz[i] && task.axes.xyz[j] {
                matrix[(i, j)] = gain[(i, j)];
            }
        }
    }
    matrix
}

fn validate_gain<T: Real>(
    gain: Gain,
    level: usize,
    matrix: &JointMatrix<T>,
) -> Result<(), ConfigError> {
    for entry in matrix {
        let value = entry.to_f64();
        if !(-GAIN_MAX..=GAIN_MAX).contains(&value) {
            return Err(ConfigError::GainValue { gain, level, value });
        }
    }
    for i in 0..DOF {
        for j in 0..i {
            let difference = (matrix[(i, j)] - matrix[(j, i)]).to_f64();
            if difference != 0.0 {
                return Err(ConfigError::GainSymmetry {
                    gain,
                    level,
                    entry: [i + 1, j + 1],
                    difference,
                });
            }
        }
    }
    match Cholesky::checked(matrix) {
        Ok(_) => Ok(()),
        Err((index, pivot)) => Err(ConfigError::GainDefinite {
            gain,
            level,
            index: index + 1,
            pivot,
        }),
    }
}
