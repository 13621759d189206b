//! Plain structs of the interface, and their way into the core's configuration.
//!
//! Every field is a number and any number is allowed in it: what cannot be is
//! refused by name.

use core::fmt;
use core::mem::MaybeUninit;

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use controller_core::arm::{ArmParameters, Friction, LinkParameters, Pose};
use controller_core::gain::diagonal;
use controller_core::joint::DOF;
use controller_core::law::null_space::{NullDamping, Posture};
use controller_core::ranges::{DEAD_CYCLES_MAX, MAX_LEVELS};
use controller_core::{
    Axes, ConfigError, Controller, ControllerConfig, Link, LinkPoint, NullSpace, Task, TaskGains,
    TaskSet,
};

use crate::codes::{self, StratumResult};
use crate::constants::{
    STRATUM_AXIS_X, STRATUM_AXIS_Y, STRATUM_AXIS_Z, STRATUM_DAMPING_INERTIA, STRATUM_DAMPING_JOINT,
    STRATUM_POSTURE_CONSTANT, STRATUM_POSTURE_INTEGRAL_COUPLED, STRATUM_POSTURE_INTEGRAL_UNCOUPLED,
    STRATUM_TASK_ORIENTATION, STRATUM_TASK_POSITION, StratumAxes, StratumDampingKind,
    StratumPostureKind, StratumTaskKind,
};
use crate::scalar::Scalar;

/// The version of the interface: numbers, structs and functions of this header.
pub const STRATUM_ABI_VERSION: u32 = 4;
/// Joints of an arm.
pub const STRATUM_JOINTS: usize = 7;
/// Most levels.
pub const STRATUM_LEVELS: usize = 7;

/// Tables of one link and of the joint that moves it, by the standard
/// Denavit-Hartenberg convention.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumLink {
    /// Length along the new x axis, m.
    pub a: f64,
    /// Twist about the new x axis, rad.
    pub alpha: f64,
    /// Offset along the joint axis, m.
    pub d: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the link's frame, m.
    pub com: [f64; 3],
    /// Inertia about the centre of mass, axes of the link's frame, kg m2:
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
    /// Largest |q|, rad.
    pub position_limit: f64,
    /// Largest |dq| of the data sheet, rad/s.
    pub speed_limit: f64,
    /// Largest |torque|, Nm.
    pub torque_limit: f64,
    /// Largest change of the torque while the law runs, Nm/s.
    pub torque_rate_limit: f64,
    /// The same while the arm is braked after a fault, Nm/s.
    pub brake_rate_limit: f64,
}

/// Tables of an arm.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumArm {
    /// Height of frame 0 above the mounting plate, m.
    pub base_height: f64,
    /// Distance of the flange from the origin of frame 7 along z7, m.
    pub flange: f64,
    /// Gravitational acceleration, base-plate axes, m/s2.
    pub gravity: [f64; 3],
    /// Links, base to flange.
    pub links: [StratumLink; STRATUM_JOINTS],
}

/// One priority level.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumLevel {
    /// STRATUM_TASK_POSITION or STRATUM_TASK_ORIENTATION.
    pub task: StratumTaskKind,
    /// Link that is turned or carries the point, 1 to 7.
    pub link: u32,
    /// The point in the link's frame, m.
    pub offset: [f64; 3],
    /// Controlled axes: sum of STRATUM_AXIS_X, _Y and _Z.
    pub axes: StratumAxes,
    /// Always 0: completes the struct to whole words.
    pub reserved: u32,
    /// Stiffness of the error, 1/s2: acts on acceleration.
    pub stiffness: [[f64; 3]; 3],
    /// Damping of the error, 1/s.
    pub damping: [[f64; 3]; 3],
}

/// Everything a controller is made of.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumSettings {
    /// Set by stratum_settings_default; not to be changed.
    pub abi: u32,
    /// Levels in use, 1 to 7; together at most 7 axes.
    pub level_count: u32,
    /// The arm with its limits.
    pub arm: StratumArm,
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
pub const STRATUM_SETTINGS_SIZE: usize = 3216;
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

impl From<&LinkParameters> for StratumLink {
    fn from(link: &LinkParameters) -> Self {
        Self {
            a: link.a,
            alpha: link.alpha,
            d: link.d,
            mass: link.mass,
            com: link.com,
            inertia: link.inertia,
            position_limit: link.position_range[1],
            speed_limit: link.speed_limit,
            torque_limit: link.torque_limit,
            torque_rate_limit: link.torque_rate_limit,
            brake_rate_limit: link.brake_rate_limit,
        }
    }
}

impl StratumLink {
    fn parameters(&self) -> LinkParameters {
        LinkParameters {
            name: "joint",
            angle_offset: 0.0,
            rotor_inertia: 0.0,
            friction: Friction::NONE,
            end_approach: None,
            a: self.a,
            alpha: self.alpha,
            d: self.d,
            mass: self.mass,
            com: self.com,
            inertia: self.inertia,
            position_range: [-self.position_limit, self.position_limit],
            speed_limit: self.speed_limit,
            torque_limit: self.torque_limit,
            torque_rate_limit: self.torque_rate_limit,
            brake_rate_limit: self.brake_rate_limit,
        }
    }
}

impl StratumArm {
    pub(crate) fn lwr_iv() -> Self {
        Self {
            base_height: LWR_IV.base.shift[2],
            flange: LWR_IV.flange.shift[2],
            gravity: LWR_IV.gravity,
            links: LWR_IV.links.each_ref().map(StratumLink::from),
        }
    }

    fn parameters(&self) -> ArmParameters {
        ArmParameters {
            name: "settings",
            base: Pose::at([0.0, 0.0, self.base_height]),
            flange: Pose::at([0.0, 0.0, self.flange]),
            points: &[],
            damping_postures: &[],
            gravity: self.gravity,
            links: self.links.each_ref().map(StratumLink::parameters),
        }
    }

    #[inline(never)]
    fn controller<'a>(
        &self,
        config: &ControllerConfig,
        place: &'a mut MaybeUninit<Controller<Scalar>>,
    ) -> Result<&'a mut Controller<Scalar>, Refusal> {
        match Controller::new(&self.parameters(), config) {
            Ok(controller) => Ok(place.write(controller)),
            Err(error) => Err(Refusal::Config(error)),
        }
    }
}

impl StratumLevel {
    /// The task of the level with this number. Link and axes that no task can have are
    /// refused here: the core has no words for them.
    fn task(&self, level: usize) -> Result<Task, Refusal> {
        let link = usize::try_from(self.link).ok().and_then(Link::from_number);
        let link = link.ok_or_else(|| {
            let code = codes::STRATUM_CONFIG_POINT_LINK;
            number(level, code, "link", self.link, [1, DOF as u32])
        })?;
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
        let offset = self.offset;
        match self.task {
            STRATUM_TASK_POSITION => Ok(Task::position(LinkPoint { link, offset }, axes, gains)),
            STRATUM_TASK_ORIENTATION => Ok(Task::orientation(link.frame(), axes, gains)),
            value => Err(number(
                level,
                codes::STRATUM_CONFIG_CHOICE,
                "task",
                value,
                [0, 1],
            )),
        }
    }
}

impl Default for StratumSettings {
    /// The LWR IV+, its flange held in x, y, z above a compliant null space, 2 ms.
    fn default() -> Self {
        let flange = StratumLevel {
            task: STRATUM_TASK_POSITION,
            link: 7,
            offset: LWR_IV.flange.shift,
            axes: STRATUM_AXIS_X + STRATUM_AXIS_Y + STRATUM_AXIS_Z,
            reserved: 0,
            stiffness: diagonal([400.0; 3]),
            damping: diagonal([40.0; 3]),
        };
        Self {
            abi: STRATUM_ABI_VERSION,
            level_count: 1,
            arm: StratumArm::lwr_iv(),
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
    }
}

impl StratumSettings {
    /// Makes the controller in its place. Steps that need much stack are calls of their
    /// own, so that they need it one after the other.
    pub(crate) fn controller<'a>(
        &self,
        place: &'a mut MaybeUninit<Controller<Scalar>>,
    ) -> Result<&'a mut Controller<Scalar>, Refusal> {
        if self.abi != STRATUM_ABI_VERSION {
            return Err(Refusal::Abi(self.abi));
        }
        match &self.config() {
            Ok(config) => self.arm.controller(config, place),
            Err(refusal) => Err(*refusal),
        }
    }

    #[inline(never)]
    fn config(&self) -> Result<ControllerConfig, Refusal> {
        Ok(ControllerConfig {
            tasks: self.tasks()?,
            null_space: NullSpace {
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
            },
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
            *task = level.task(number)?;
        }
        Ok(TaskSet::new(used)?)
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
