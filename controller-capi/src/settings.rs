//! Plain structs of the interface, and their way into the core's configuration.
//!
//! Every field is a number and any number is allowed in it: what cannot be is
//! refused by name.

use core::fmt;

use controller_core::config::{ConfigError, ControllerConfig};
use controller_core::controller::Controller;
use controller_core::joint::{DOF, JointMatrix, JointVector, Matrix3, Vector3};
use controller_core::kinematics::LinkPoint;
use controller_core::law::{NullDamping, NullSpace, Posture};
use controller_core::model::{ArmModel, ArmParameters, LWR_IV, LinkParameters, ModelError};
use controller_core::real::Real;
use controller_core::task::{Axes, MAX_LEVELS, Task, TaskKind, TaskReference};

use crate::{Scalar, codes};

/// The version of the interface: numbers, structs and functions of this header.
pub const STRATUM_ABI_VERSION: u32 = 1;
/// Joints of an arm.
pub const STRATUM_JOINTS: usize = 7;
/// Most levels.
pub const STRATUM_LEVELS: usize = 7;

/// StratumLevel.task: the position of the point.
pub const STRATUM_TASK_POSITION: u32 = 0;
/// StratumLevel.task: the orientation of the link.
pub const STRATUM_TASK_ORIENTATION: u32 = 1;
/// StratumLevel.axes: along x (about x for an orientation).
pub const STRATUM_AXIS_X: u32 = 1;
/// StratumLevel.axes: along y.
pub const STRATUM_AXIS_Y: u32 = 2;
/// StratumLevel.axes: along z.
pub const STRATUM_AXIS_Z: u32 = 4;
/// StratumSettings.damping: the constant matrix null_damping.
pub const STRATUM_DAMPING_JOINT: u32 = 0;
/// StratumSettings.damping: null_damping_rate times the mass matrix.
pub const STRATUM_DAMPING_INERTIA: u32 = 1;
/// StratumSettings.posture: the posture that was set.
pub const STRATUM_POSTURE_CONSTANT: u32 = 0;
/// StratumSettings.posture: the integral of the task motion, with coupling.
pub const STRATUM_POSTURE_INTEGRAL_COUPLED: u32 = 1;
/// StratumSettings.posture: the integral of the task motion, without coupling.
pub const STRATUM_POSTURE_INTEGRAL_UNCOUPLED: u32 = 2;

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
    pub task: u32,
    /// Link that carries the point, 1 to 7.
    pub link: u32,
    /// The point in the link's frame, m.
    pub offset: [f64; 3],
    /// Controlled axes: sum of STRATUM_AXIS_X, _Y and _Z.
    pub axes: u32,
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
    pub damping: u32,
    /// STRATUM_POSTURE_CONSTANT or one of the integrals.
    pub posture: u32,
    /// Bandwidth of the external-torque estimate, 1/s.
    pub observer_gain: [f64; STRATUM_JOINTS],
    /// Nominal cycle, s.
    pub cycle_s: f64,
    /// Cycles between a measurement and the moment its torque acts.
    pub dead_cycles: u32,
    /// Always 0.
    pub reserved: u32,
}

/// Desired motion of one level, base-plate axes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumReference {
    /// Position, m.
    pub x: [f64; 3],
    /// Orientation quaternion w x y z, norm 0.5 to 2; 1 0 0 0 for a position.
    pub orientation: [f64; 4],
    /// Velocity, m/s, or angular velocity, rad/s.
    pub dx: [f64; 3],
    /// Acceleration, m/s2, or angular acceleration, rad/s2.
    pub ddx: [f64; 3],
}

/// sizeof(StratumSettings).
pub const STRATUM_SETTINGS_SIZE: usize = 3104;
/// sizeof(StratumReference).
pub const STRATUM_REFERENCE_SIZE: usize = 104;
const _: () = assert!(size_of::<StratumSettings>() == STRATUM_SETTINGS_SIZE);
const _: () = assert!(size_of::<StratumReference>() == STRATUM_REFERENCE_SIZE);
const _: () = assert!(STRATUM_JOINTS == DOF && STRATUM_LEVELS == MAX_LEVELS);

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Refusal {
    Abi { value: u32 },
    Levels { value: u32 },
    Choice(Choice),
    Model(ModelError),
    Config(ConfigError),
}

/// A choice that does not exist: thing, level (0: none), value, largest allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    thing: &'static str,
    level: usize,
    value: u32,
    max: u32,
}

impl Refusal {
    pub(crate) fn code(&self) -> codes::StratumResult {
        match self {
            Self::Abi { .. } => codes::STRATUM_ERROR_ABI,
            Self::Levels { .. } => codes::STRATUM_CONFIG_LEVELS,
            Self::Choice(_) => codes::STRATUM_CONFIG_CHOICE,
            Self::Model(error) => codes::of_model(error),
            Self::Config(error) => codes::of_config(error),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Abi { value } => write!(
                f,
                "settings.abi is {value}; this library has {STRATUM_ABI_VERSION} \
                 (start from stratum_settings_default)"
            ),
            Self::Levels { value } => {
                write!(f, "level_count is {value}; allowed 1 to {STRATUM_LEVELS}")
            }
            Self::Choice(Choice {
                thing,
                level,
                value,
                max,
            }) => {
                if *level > 0 {
                    write!(f, "level {level}: ")?;
                }
                write!(f, "{thing} is {value}; allowed 0 to {max}")
            }
            Self::Model(error) => error.fmt(f),
            Self::Config(error) => error.fmt(f),
        }
    }
}

fn choice<T: Copy>(
    thing: &'static str,
    level: usize,
    value: u32,
    allowed: &[T],
) -> Result<T, Refusal> {
    let found = usize::try_from(value).ok().and_then(|i| allowed.get(i));
    found.copied().ok_or(Refusal::Choice(Choice {
        thing,
        level,
        value,
        max: allowed.len().saturating_sub(1) as u32,
    }))
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
            position_limit: link.position_limit,
            speed_limit: link.speed_limit,
            torque_limit: link.torque_limit,
        }
    }
}

impl StratumLink {
    fn parameters(&self) -> LinkParameters {
        LinkParameters {
            a: self.a,
            alpha: self.alpha,
            d: self.d,
            mass: self.mass,
            com: self.com,
            inertia: self.inertia,
            position_limit: self.position_limit,
            speed_limit: self.speed_limit,
            torque_limit: self.torque_limit,
        }
    }
}

impl StratumArm {
    pub(crate) fn lwr_iv() -> Self {
        Self {
            base_height: LWR_IV.base_height,
            flange: LWR_IV.flange,
            gravity: LWR_IV.gravity,
            links: LWR_IV.links.each_ref().map(StratumLink::from),
        }
    }

    fn parameters(&self) -> ArmParameters {
        ArmParameters {
            name: "settings",
            base_height: self.base_height,
            flange: self.flange,
            gravity: self.gravity,
            links: self.links.each_ref().map(StratumLink::parameters),
        }
    }
}

/// All combinations of axes by their bits.
const AXES: [Axes; 8] = {
    let mut all = [Axes { xyz: [false; 3] }; 8];
    let mut bits = 0;
    while bits < 8 {
        all[bits] = Axes {
            xyz: [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0],
        };
        bits += 1;
    }
    all
};

impl StratumLevel {
    fn task(&self, level: usize) -> Result<Task<Scalar>, Refusal> {
        let kinds = [TaskKind::Position, TaskKind::Orientation];
        Ok(Task {
            kind: choice("task", level, self.task, &kinds)?,
            point: LinkPoint {
                link: usize::try_from(self.link).unwrap_or(usize::MAX),
                offset: vector(&self.offset),
            },
            axes: choice("axes", level, self.axes, &AXES)?,
            stiffness: Matrix3::from(self.stiffness.map(|row| row.map(Scalar::from_f64)))
                .transpose(),
            damping: Matrix3::from(self.damping.map(|row| row.map(Scalar::from_f64))).transpose(),
        })
    }
}

fn vector(values: &[f64; 3]) -> Vector3<Scalar> {
    Vector3::from(values.map(Scalar::from_f64))
}

pub(crate) fn joints(values: &[f64; DOF]) -> JointVector<Scalar> {
    JointVector::from(values.map(Scalar::from_f64))
}

/// From rows; a core matrix is made of columns.
fn matrix(rows: &[[f64; DOF]; DOF]) -> JointMatrix<Scalar> {
    JointMatrix::from(rows.map(|row| row.map(Scalar::from_f64))).transpose()
}

fn diagonal<const N: usize>(values: [f64; N]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for (i, (row, value)) in matrix.iter_mut().zip(values).enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            if i == j {
                *entry = value;
            }
        }
    }
    matrix
}

impl Default for StratumSettings {
    /// The LWR IV+, its flange held in x, y, z above a compliant null space, 2 ms.
    fn default() -> Self {
        let flange = StratumLevel {
            task: STRATUM_TASK_POSITION,
            link: 7,
            offset: [0.0, 0.0, LWR_IV.flange],
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
            null_stiffness: diagonal([20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]),
            null_damping: diagonal([4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03]),
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
    pub(crate) fn controller(&self) -> Result<Controller<Scalar>, Refusal> {
        if self.abi != STRATUM_ABI_VERSION {
            return Err(Refusal::Abi { value: self.abi });
        }
        let count = usize::try_from(self.level_count).unwrap_or(usize::MAX);
        let Some(levels) = self.levels.get(..count) else {
            return Err(Refusal::Levels {
                value: self.level_count,
            });
        };
        let mut tasks = heapless::Vec::new();
        for (number, level) in (1..).zip(levels) {
            // Never full: there are no more levels than places.
            let _ = tasks.push(level.task(number)?);
        }
        let inertia = choice("damping", 0, self.damping, &[false, true])?;
        let postures = [
            Posture::Constant,
            Posture::IntegralCoupled,
            Posture::IntegralUncoupled,
        ];
        let config = ControllerConfig {
            tasks,
            null_space: NullSpace {
                stiffness: matrix(&self.null_stiffness),
                damping: if inertia {
                    NullDamping::Inertia(Scalar::from_f64(self.null_damping_rate))
                } else {
                    NullDamping::Joint(matrix(&self.null_damping))
                },
                posture: choice("posture", 0, self.posture, &postures)?,
            },
            observer_gain: joints(&self.observer_gain),
            cycle_s: Scalar::from_f64(self.cycle_s),
            // What does not fit is too many.
            dead_cycles: u8::try_from(self.dead_cycles).unwrap_or(u8::MAX),
        };
        let model = ArmModel::new(&self.arm.parameters()).map_err(Refusal::Model)?;
        Controller::new(&model, &config).map_err(Refusal::Config)
    }
}

impl StratumReference {
    pub(crate) fn task_reference(&self) -> TaskReference<Scalar> {
        TaskReference {
            x: vector(&self.x),
            orientation: self.orientation.map(Scalar::from_f64).into(),
            dx: vector(&self.dx),
            ddx: vector(&self.ddx),
        }
    }
}

impl From<&TaskReference<Scalar>> for StratumReference {
    fn from(reference: &TaskReference<Scalar>) -> Self {
        Self {
            x: reference.x.map(Real::to_f64).into(),
            orientation: reference.orientation.map(Real::to_f64).into(),
            dx: reference.dx.map(Real::to_f64).into(),
            ddx: reference.ddx.map(Real::to_f64).into(),
        }
    }
}
