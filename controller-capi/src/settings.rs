//! Plain structs of the interface, and their way into the core's configuration.
//!
//! Every field is a number and any number is allowed in it: what cannot be is
//! refused by name.

use core::fmt;
use core::mem::MaybeUninit;

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use controller_core::arm::{ArmParameters, Pose};
use controller_core::gain::diagonal;
use controller_core::joint::DOF;
use controller_core::law::null_space::{NullDamping, Posture};
use controller_core::ranges::{DEAD_CYCLES_MAX, MAX_LEVELS};
use controller_core::task::{AfterStale, LevelLimits, Stale};
use controller_core::{
    Axes, ConfigError, Controller, ControllerConfig, Link, LinkFrame, LinkPoint, MakeController,
    NullSpace, Task, TaskGains, TaskSet,
};

use crate::arm::{STRATUM_JOINTS, StratumArm, StratumTool};
use crate::codes::{self, StratumResult};
use crate::constants::{
    STRATUM_AXIS_X, STRATUM_AXIS_Y, STRATUM_AXIS_Z, STRATUM_DAMPING_INERTIA, STRATUM_DAMPING_JOINT,
    STRATUM_POSTURE_CONSTANT, STRATUM_POSTURE_INTEGRAL_COUPLED, STRATUM_POSTURE_INTEGRAL_UNCOUPLED,
    STRATUM_STALE_HOLD, STRATUM_STALE_RELEASE, STRATUM_TASK_ORIENTATION, STRATUM_TASK_POSITION,
    StratumAxes, StratumDampingKind, StratumPostureKind, StratumStaleKind, StratumTaskKind,
};
use crate::scalar::Scalar;

/// The version of the interface: numbers, structs and functions of this header.
pub const STRATUM_ABI_VERSION: u32 = 6;
/// Most levels.
pub const STRATUM_LEVELS: usize = 7;
/// In the place of a link: what is on the tool, or without one on the flange.
pub const STRATUM_ON_TOOL: u32 = 8;

/// What happens to a level near singularities and far from its target; orientations count at
/// 0.1 m from their origin. All zeros: what the place of the level calls for.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumLevelLimits {
    /// Below this mobility a direction is driven less, 1/kg.
    pub drive_mobility: f64,
    /// Below this mobility a direction is given to the levels below, 1/kg.
    pub release_mobility: f64,
    /// No error calls for more speed than this, m/s.
    pub error_speed: f64,
    /// No more speed is asked for along a direction that is lost, m/s.
    pub lost_speed: f64,
    /// Where joints are at their bounds, a direction with this mobility resists them as much
    /// again as the arm does, 1/kg.
    pub stiff_mobility: f64,
}

impl StratumLevelLimits {
    const BY_PLACE: Self = Self {
        drive_mobility: 0.0,
        release_mobility: 0.0,
        error_speed: 0.0,
        lost_speed: 0.0,
        stiff_mobility: 0.0,
    };

    fn limits(&self) -> Option<LevelLimits> {
        (*self != Self::BY_PLACE).then_some(LevelLimits {
            drive_mobility: self.drive_mobility,
            release_mobility: self.release_mobility,
            error_speed: self.error_speed,
            lost_speed: self.lost_speed,
            stiff_mobility: self.stiff_mobility,
        })
    }
}

/// One priority level.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumLevel {
    /// STRATUM_TASK_POSITION or STRATUM_TASK_ORIENTATION.
    pub task: StratumTaskKind,
    /// Link that is turned or carries the point, 1 to 7, or STRATUM_ON_TOOL.
    pub link: u32,
    /// The point in the frame of the link or tool, m.
    pub offset: [f64; 3],
    /// The frame of an orientation: takes its axes to those of the link or tool.
    pub rotation: [[f64; 3]; 3],
    /// Controlled axes: sum of STRATUM_AXIS_X, _Y and _Z.
    pub axes: StratumAxes,
    /// 1: the level is not there until stratum_level_add; else 0.
    pub absent: u32,
    /// Stiffness of the error, 1/s2: acts on acceleration.
    pub stiffness: [[f64; 3]; 3],
    /// Damping of the error, 1/s.
    pub damping: [[f64; 3]; 3],
    /// What happens near singularities and far from the target.
    pub limits: StratumLevelLimits,
    /// Age from which on the level's reference is too old, s: it comes to rest then. 0: never.
    pub stale_after_s: f64,
    /// STRATUM_STALE_HOLD or STRATUM_STALE_RELEASE: what follows once it rests.
    pub stale: StratumStaleKind,
    /// Always 0: completes the struct to whole words.
    pub reserved: u32,
}

/// Everything a controller is made of.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumSettings {
    /// Set by stratum_settings_default; not to be changed.
    pub abi: u32,
    /// Levels in use, with those that are absent, 1 to 7; together at most 12 axes, with the exact
    /// law 7.
    pub level_count: u32,
    /// The arm with its limits, mounted as it is.
    pub arm: StratumArm,
    /// What it carries.
    pub tool: StratumTool,
    /// Levels, highest priority first.
    pub levels: [StratumLevel; STRATUM_LEVELS],
    /// Null-space stiffness, symmetric positive definite, Nm/rad.
    pub null_stiffness: [[f64; STRATUM_JOINTS]; STRATUM_JOINTS],
    /// Null-space damping, symmetric positive definite, Nms/rad.
    pub null_damping: [[f64; STRATUM_JOINTS]; STRATUM_JOINTS],
    /// Rate of STRATUM_DAMPING_INERTIA, 1/s.
    pub null_damping_rate: f64,
    /// STRATUM_DAMPING_JOINT or STRATUM_DAMPING_INERTIA.
    pub damping: StratumDampingKind,
    /// STRATUM_POSTURE_CONSTANT or one of the integrals.
    pub posture: StratumPostureKind,
    /// Bandwidth of the external-torque estimate, 1/s.
    pub observer_gain: [f64; STRATUM_JOINTS],
    /// Nominal cycle, s.
    pub cycle_s: f64,
    /// Cycles between a measurement and the moment its torque acts.
    pub dead_cycles: u32,
    /// Always 0.
    pub reserved: u32,
}

/// sizeof(StratumSettings).
pub const STRATUM_SETTINGS_SIZE: usize = 5408;
const _: () = assert!(size_of::<StratumSettings>() == STRATUM_SETTINGS_SIZE);
const _: () = assert!(STRATUM_JOINTS == DOF && STRATUM_LEVELS == MAX_LEVELS);

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Refusal {
    Abi(u32),
    Number(Number),
    Config(ConfigError),
}

/// A whole number outside its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Number {
    code: StratumResult,
    /// 0 for what belongs to no level.
    level: usize,
    thing: &'static str,
    value: u32,
    allowed: [u32; 2],
}

impl Refusal {
    pub(crate) fn code(&self) -> StratumResult {
        match self {
            Self::Abi(_) => codes::STRATUM_ERROR_ABI,
            Self::Number(number) => number.code,
            Self::Config(error) => codes::of_config(error),
        }
    }
}

impl From<ConfigError> for Refusal {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Abi(value) => write!(
                f,
                "settings.abi is {value}; this library has {STRATUM_ABI_VERSION} \
                 (start from stratum_settings_default)"
            ),
            Self::Number(Number {
                level,
                thing,
                value,
                allowed: [min, max],
                ..
            }) => {
                if *level > 0 {
                    write!(f, "level {level}: ")?;
                }
                write!(f, "{thing} is {value}; allowed {min} to {max}")
            }
            Self::Config(error) => error.fmt(f),
        }
    }
}

impl StratumLevel {
    /// The task of the level with this number; `tool` is the pose of the tool in frame 7. Link
    /// and axes that no task can have are refused here: the core has no words for them.
    fn task(&self, level: usize, tool: &Pose) -> Result<Task, Refusal> {
        let (link, parent) = match usize::try_from(self.link).ok().and_then(Link::from_number) {
            Some(link) => (link, &Pose::IDENTITY),
            None if self.link == STRATUM_ON_TOOL => (Link::L7, tool),
            None => {
                let code = codes::STRATUM_CONFIG_POINT_LINK;
                return Err(number(level, code, "link", self.link, [1, STRATUM_ON_TOOL]));
            }
        };
        let axes = Axes::from_bits(self.axes).ok_or_else(|| {
            let code = match self.axes {
                0 => codes::STRATUM_CONFIG_NO_AXIS,
                _ => codes::STRATUM_CONFIG_CHOICE,
            };
            number(level, code, "axes", self.axes, [1, 7])
        })?;
        let gains = TaskGains {
            stiffness: self.stiffness,
            damping: self.damping,
        };
        let offset = parent.place(self.offset);
        let rotation = parent.turned(&self.rotation);
        let task = match self.task {
            STRATUM_TASK_POSITION => Task::position(LinkPoint { link, offset }, axes, gains),
            STRATUM_TASK_ORIENTATION => {
                Task::orientation(LinkFrame { link, rotation }, axes, gains)
            }
            value => {
                let code = codes::STRATUM_CONFIG_CHOICE;
                return Err(number(level, code, "task", value, [0, 1]));
            }
        };
        Ok(Task {
            limits: self.limits.limits(),
            stale: self.stale(level)?,
            ..task
        })
    }

    fn stale(&self, level: usize) -> Result<Option<Stale>, Refusal> {
        let then = match self.stale {
            STRATUM_STALE_HOLD => AfterStale::Hold,
            STRATUM_STALE_RELEASE => AfterStale::Release,
            value => {
                let code = codes::STRATUM_CONFIG_CHOICE;
                return Err(number(level, code, "stale", value, [0, 1]));
            }
        };
        let age_s = self.stale_after_s;
        // What is not a number is refused further on.
        Ok((age_s != 0.0).then_some(Stale { age_s, then }))
    }
}

impl Default for StratumSettings {
    /// Of the LWR IV+.
    fn default() -> Self {
        Self::LWR_IV
    }
}

impl StratumSettings {
    /// The LWR IV+ without tool, its flange held in x, y, z above a compliant null space, 2 ms.
    pub(crate) const LWR_IV: Self = {
        let flange = StratumLevel {
            task: STRATUM_TASK_POSITION,
            link: STRATUM_ON_TOOL,
            offset: [0.0; 3],
            rotation: Pose::IDENTITY.rotation,
            axes: STRATUM_AXIS_X + STRATUM_AXIS_Y + STRATUM_AXIS_Z,
            absent: 0,
            stiffness: diagonal([400.0; 3]),
            damping: diagonal([40.0; 3]),
            limits: StratumLevelLimits::BY_PLACE,
            stale_after_s: 0.0,
            stale: STRATUM_STALE_HOLD,
            reserved: 0,
        };
        Self {
            abi: STRATUM_ABI_VERSION,
            level_count: 1,
            arm: StratumArm::new(&LWR_IV),
            tool: StratumTool::NONE,
            levels: [flange; STRATUM_LEVELS],
            null_stiffness: diagonal(LWR_IV_STIFFNESS),
            null_damping: diagonal(LWR_IV_DAMPING),
            null_damping_rate: 20.0,
            damping: STRATUM_DAMPING_JOINT,
            posture: STRATUM_POSTURE_CONSTANT,
            observer_gain: [50.0; STRATUM_JOINTS],
            cycle_s: 0.002,
            dead_cycles: 0,
            reserved: 0,
        }
    };

    /// The same with another arm. The damping matrix is for the LWR IV+; c M is for an arm of
    /// any mass.
    #[inline(never)]
    pub(crate) fn set_arm(&mut self, arm: &ArmParameters) {
        self.arm = StratumArm::new(arm);
        if arm.name != LWR_IV.name {
            self.damping = STRATUM_DAMPING_INERTIA;
        }
    }

    /// Makes the controller in its place. Steps that need much stack are calls of their
    /// own, so that they need it one after the other.
    pub(crate) fn controller<'a>(
        &self,
        law: MakeController<Scalar>,
        place: &'a mut MaybeUninit<Controller<Scalar>>,
    ) -> Result<&'a mut Controller<Scalar>, Refusal> {
        if self.abi != STRATUM_ABI_VERSION {
            return Err(Refusal::Abi(self.abi));
        }
        // Before the levels that are on it.
        if let Err(error) = self.tool.validate() {
            return Err(Refusal::Config(error.into()));
        }
        match &self.config() {
            Ok(config) => Ok(self.arm.controller(law, &self.tool, config, place)?),
            Err(refusal) => Err(*refusal),
        }
    }

    #[inline(never)]
    fn config(&self) -> Result<ControllerConfig, Refusal> {
        Ok(ControllerConfig {
            tasks: self.tasks()?,
            null_space: self.null_space()?,
            observer_gain: self.observer_gain,
            cycle_s: self.cycle_s,
            dead_cycles: u8::try_from(self.dead_cycles).map_err(|_| {
                let allowed = [0, u32::from(DEAD_CYCLES_MAX)];
                let code = codes::STRATUM_CONFIG_DEAD_CYCLES;
                number(0, code, "dead_cycles", self.dead_cycles, allowed)
            })?,
        })
    }

    #[inline(never)]
    pub(crate) fn null_space(&self) -> Result<NullSpace, Refusal> {
        Ok(NullSpace {
            stiffness: self.null_stiffness,
            damping: match self.damping {
                STRATUM_DAMPING_JOINT => NullDamping::Joint(self.null_damping),
                STRATUM_DAMPING_INERTIA => NullDamping::Inertia(self.null_damping_rate),
                value => return Err(choice("damping", value, 1)),
            },
            posture: match self.posture {
                STRATUM_POSTURE_CONSTANT => Posture::Constant,
                STRATUM_POSTURE_INTEGRAL_COUPLED => Posture::IntegralCoupled,
                STRATUM_POSTURE_INTEGRAL_UNCOUPLED => Posture::IntegralUncoupled,
                value => return Err(choice("posture", value, 2)),
            },
        })
    }

    /// Of the tool in frame 7.
    fn tool_pose(&self) -> Pose {
        self.arm.flange.pose().carrying(&self.tool.pose.pose())
    }

    #[inline(never)]
    fn tasks(&self) -> Result<TaskSet, Refusal> {
        let unused = Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(0.0, 0.0));
        let mut tasks = [unused; STRATUM_LEVELS];
        let count = usize::try_from(self.level_count).unwrap_or(usize::MAX);
        let used = tasks.get_mut(..count).filter(|used| !used.is_empty());
        let used = used.ok_or_else(|| {
            let (code, allowed) = (codes::STRATUM_CONFIG_LEVELS, [1, STRATUM_LEVELS as u32]);
            number(0, code, "level_count", self.level_count, allowed)
        })?;
        for (number, (task, level)) in (1..).zip(used.iter_mut().zip(&self.levels)) {
            *task = level.task(number, &self.tool_pose())?;
        }
        let mut set = TaskSet::new(used)?;
        for (slot, level) in self.levels.iter().enumerate().take(count) {
            match level.absent {
                0 => {}
                1 => set = set.without(slot),
                value => {
                    let code = codes::STRATUM_CONFIG_CHOICE;
                    return Err(number(slot + 1, code, "absent", value, [0, 1]));
                }
            }
        }
        Ok(set)
    }

    /// The task of a level, counted from 0, with its tool.
    pub(crate) fn task(&self, slot: usize) -> Result<Task, Refusal> {
        match self.levels.get(slot) {
            Some(level) => level.task(slot + 1, &self.tool_pose()),
            None => Err(number(
                0,
                codes::STRATUM_ERROR_LEVEL,
                "level",
                slot as u32 + 1,
                [1, 7],
            )),
        }
    }
}

/// A whole number outside its range, of a level or of the settings as a whole.
fn number(
    level: usize,
    code: StratumResult,
    thing: &'static str,
    value: u32,
    allowed: [u32; 2],
) -> Refusal {
    Refusal::Number(Number {
        code,
        level,
        thing,
        value,
        allowed,
    })
}

/// A choice that does not exist.
fn choice(thing: &'static str, value: u32, max: u32) -> Refusal {
    number(0, codes::STRATUM_CONFIG_CHOICE, thing, value, [0, max])
}
