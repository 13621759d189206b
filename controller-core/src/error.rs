//! Why an arm or a configuration is refused: one type, one text per reason.

use core::fmt;

use crate::arm::{ArmError, ArmParameters};
use crate::fault::{JointLabel, Named, NamesJoints};
use crate::joint::DOF;
use crate::ranges::{
    CYCLE_RANGE_S, DEAD_CYCLES_MAX, DISTORTION_MAX, EXACT_ROWS, GAIN_MAX, LEVEL_SPEED_RANGE,
    MAX_LEVELS, MAX_ROWS, MOBILITY_RANGE, POINT_OFFSET_MAX_M, STALE_RANGE_S,
};
use crate::real::Real;

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
    /// Name and unit.
    fn name(self) -> &'static str {
        match self {
            Self::TaskStiffness => "task stiffness [1/s2]",
            Self::TaskDamping => "task damping [1/s]",
            Self::NullStiffness => "null-space stiffness [Nm/rad]",
            Self::NullDamping => "null-space damping [Nms/rad]",
        }
    }
}

/// Which number of [`LevelLimits`](crate::task::LevelLimits) an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum LevelLimit {
    /// z0.
    DriveMobility,
    /// zr.
    ReleaseMobility,
    /// v_err.
    ErrorSpeed,
    /// vm.
    LostSpeed,
    /// zw.
    StiffMobility,
}

impl LevelLimit {
    /// Name and unit.
    fn name(self) -> &'static str {
        match self {
            Self::DriveMobility => "drive mobility z0 [1/kg]",
            Self::ReleaseMobility => "release mobility zr [1/kg]",
            Self::ErrorSpeed => "error speed v_err [m/s]",
            Self::LostSpeed => "speed along a lost direction vm [m/s]",
            Self::StiffMobility => "stiff mobility zw [1/kg]",
        }
    }

    /// Smallest and largest value.
    pub(crate) fn range(self) -> [f64; 2] {
        match self {
            Self::ErrorSpeed | Self::LostSpeed => LEVEL_SPEED_RANGE,
            _ => MOBILITY_RANGE,
        }
    }
}

/// Why a configuration is refused. Levels and joints count from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigError {
    /// The tables of the arm.
    Arm(ArmError),
    /// No task, or more tasks than a set holds.
    Levels {
        /// Tasks given.
        levels: usize,
    },
    /// The tasks have more rows together than the law serves.
    Rows {
        /// Rows of all levels.
        rows: usize,
    },
    /// The tasks have, or have room for, more rows together than the exact law serves.
    ExactRows {
        /// Rows of all levels.
        rows: usize,
    },
    /// Room for less than the tasks take, or for more than there may be.
    Capacity {
        /// What was given.
        given: [usize; 2],
        /// What the tasks take.
        taken: [usize; 2],
    },
    /// The age from which on a reference is stale.
    StaleAge {
        /// Its level.
        level: usize,
        /// \[s\].
        value: f64,
    },
    /// A task point whose offset is not finite or beyond 10 m.
    PointOffset {
        /// Its level.
        level: usize,
        /// The coordinate \[m\].
        value: f64,
    },
    /// A task frame whose axes are not orthogonal and of length 1, or a mirror image.
    FrameRotation {
        /// Its level.
        level: usize,
        /// Largest entry of R^T R - 1, more than 1 for a mirror image.
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
    /// The gains of a task need a shorter cycle, see
    /// [`longest_cycle`](crate::law::gain_bound::longest_cycle).
    TaskGains {
        /// Its level.
        level: usize,
        /// K_p \[1/s2\].
        stiffness: f64,
        /// K_d \[1/s\].
        damping: f64,
        /// The cycle \[s\].
        cycle_s: f64,
        /// What it must stay below \[s\].
        bound: f64,
    },
    /// The observer gain of a joint is not above 0, not finite, or too large for the dead
    /// time of the loop.
    ObserverGain {
        /// The joint.
        joint: usize,
        /// Its gain \[1/s\].
        value: f64,
        /// Its largest value \[1/s\].
        bound: f64,
    },
    /// The gain of a resolver is not above 0, or more than the cycle carries.
    ResolverGain {
        /// The gain \[1/s\].
        value: f64,
        /// Its largest value \[1/s\].
        bound: f64,
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
    /// A number of what a task does near its limits.
    LevelLimits {
        /// Its level.
        level: usize,
        /// Which number.
        limit: LevelLimit,
        /// Its value.
        value: f64,
        /// What is allowed, from and to.
        allowed: [f64; 2],
    },
    /// An integrated posture and the law within limits: what becomes of both together is not
    /// known. [`Controller::exact`](crate::Controller::exact) takes it.
    IntegratedPosture,
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

impl ConfigError {
    /// The same as text that calls joints by the names that their maker gave them.
    #[must_use]
    pub fn named<'a>(&'a self, arm: &'a ArmParameters) -> impl fmt::Display + 'a {
        Named { of: self, arm }
    }
}

impl NamesJoints for ConfigError {
    fn write(&self, f: &mut fmt::Formatter<'_>, arm: Option<&ArmParameters>) -> fmt::Result {
        let label = |number| JointLabel { number, arm };
        let place = |f: &mut fmt::Formatter<'_>, gain: Gain, level: usize| {
            if level > 0 {
                write!(f, "level {level}: ")?;
            }
            write!(f, "{}", gain.name())
        };
        match *self {
            Self::Arm(error) => write!(f, "{error}"),
            Self::Levels { levels } => {
                write!(f, "there are {levels} tasks; allowed 1 to {MAX_LEVELS}")
            }
            Self::Rows { rows } => {
                write!(
                    f,
                    "the tasks have {rows} rows together; allowed 1 to {MAX_ROWS}"
                )
            }
            Self::ExactRows { rows } => write!(
                f,
                "the tasks have, or have room for, {rows} rows together; allowed with the exact law \
                 1 to {EXACT_ROWS}"
            ),
            Self::Capacity {
                given: [levels, rows],
                taken: [least_levels, least_rows],
            } => write!(
                f,
                "room for {levels} levels and {rows} rows; allowed {least_levels} to {MAX_LEVELS} \
                 levels and {least_rows} to {MAX_ROWS} rows"
            ),
            Self::StaleAge { level, value } => {
                let [min, max] = STALE_RANGE_S;
                write!(
                    f,
                    "level {level}: age {value} s from which on a reference is stale; allowed \
                     {min} to {max}"
                )
            }
            Self::PointOffset { level, value } => write!(
                f,
                "level {level}: point offset {value} m; allowed -{POINT_OFFSET_MAX_M} to \
                 {POINT_OFFSET_MAX_M}"
            ),
            Self::FrameRotation { level, value } => write!(
                f,
                "level {level}: rotation of the frame is distorted by {value:e}; allowed 0 to \
                 {DISTORTION_MAX:e}"
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
            Self::TaskGains {
                level,
                stiffness,
                damping,
                cycle_s,
                bound,
            } => write!(
                f,
                "level {level}: task stiffness {stiffness} 1/s2 and damping {damping} 1/s make \
                 the sampled loop unstable: the cycle is {cycle_s} s; it must be below {bound:.6} s"
            ),
            Self::ObserverGain {
                joint,
                value,
                bound,
            } => write!(
                f,
                "observer gain of {} is {value} 1/s; it must be above 0 and at most {bound:.1}",
                label(joint)
            ),
            Self::ResolverGain { value, bound } => write!(
                f,
                "resolver gain {value} 1/s; it must be above 0 and at most {bound}"
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
            Self::LevelLimits {
                level,
                limit,
                value,
                allowed: [min, max],
            } => write!(
                f,
                "level {level}: {} is {value}; allowed {min} to {max}",
                limit.name()
            ),
            Self::IntegratedPosture => write!(
                f,
                "posture is integrated; allowed constant, or the exact law without limits"
            ),
            Self::Damping {
                joint,
                value,
                bound,
                posture,
            } => {
                write!(
                    f,
                    "null-space damping of {} is too strong for the cycle: \
                     h lambda_max = {value:.3} at the posture",
                    label(joint)
                )?;
                for q in posture {
                    write!(f, " {}", (q.to_degrees() + 0.5).floor_small() as i32)?;
                }
                write!(f, " deg; it must be below {bound:.3}")
            }
        }
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, None)
    }
}

impl core::error::Error for ConfigError {}

impl From<ArmError> for ConfigError {
    fn from(error: ArmError) -> Self {
        Self::Arm(error)
    }
}
