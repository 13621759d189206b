//! The state: what the robot reports every millisecond.
//!
//! Reals are binary64 up to version 9 and binary32 in version 10; here they are `f64` in all
//! of them. Poses are matrices of 4 by 4, column by column; joints count from the base.
//! [`FIELDS`] has the reals by name, unit, frame and place; as a table, with offsets in bytes:
#![doc = include_str!("../layout.md")]

use crate::bytes::{check_bool, get, put};
use crate::error::Error;
use crate::modes::{ControllerMode, MotionGeneratorMode, RobotMode};
use crate::robot_error::{COUNT, RobotErrors};
use crate::version::Version;

/// Joints of the arm.
pub const DOF: usize = 7;

/// A pose: a homogeneous matrix of 4 by 4, column by column, \[m\].
pub type Pose = [f64; 16];

/// Position of a pose \[m\].
#[must_use]
pub fn position(pose: &Pose) -> [f64; 3] {
    let [.., x, y, z, _] = *pose;
    [x, y, z]
}

/// Bytes of the longest state.
pub const LEN_MAX: usize = 2373;

/// A field of reals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// The vendor's name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Frame; empty where there is none.
    pub frame: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Numbers.
    pub count: usize,
    double: Option<usize>,
    single: usize,
}

impl Field {
    /// Its first byte; `None` in versions that do not have it.
    #[must_use]
    pub const fn offset(&self, version: Version) -> Option<usize> {
        if version.is_single() {
            Some(self.single)
        } else {
            self.double
        }
    }
}

/// Offsets of what is no real.
mod at {
    /// Before all reals.
    pub const MESSAGE_ID: usize = 0;
    pub const REALS: usize = 8;
    /// Of the block between the reals and the success rate.
    pub const MOTION_GENERATOR_MODE: usize = 0;
    pub const CONTROLLER_MODE: usize = 1;
    pub const ERRORS: usize = 2;
    pub const REFLEX_REASON: usize = ERRORS + super::COUNT;
    pub const ROBOT_MODE: usize = REFLEX_REASON + super::COUNT;
    pub const BLOCK_LEN: usize = ROBOT_MODE + 1;
}

/// Bytes of a real.
const fn real_len(version: Version) -> usize {
    if version.is_single() { 4 } else { 8 }
}

/// First byte of the block of modes and errors.
const fn block(version: Version) -> usize {
    match field::CONTROL_COMMAND_SUCCESS_RATE.offset(version) {
        Some(rate) => rate - at::BLOCK_LEN,
        None => 0,
    }
}

impl Version {
    /// Bytes of a state.
    #[must_use]
    pub const fn state_len(self) -> usize {
        block(self) + at::BLOCK_LEN + real_len(self)
    }
}

/// Gives fields their places, one behind the other; the last one is behind the block.
const fn place<const N: usize>(mut fields: [Field; N]) -> [Field; N] {
    let (mut double, mut single) = (at::REALS, at::REALS);
    let mut i = 0;
    while i < N {
        if i == N - 1 {
            double += at::BLOCK_LEN;
            single += at::BLOCK_LEN;
        }
        fields[i].single = single;
        single += 4 * fields[i].count;
        if fields[i].double.is_some() {
            fields[i].double = Some(double);
            double += 8 * fields[i].count;
        }
        i += 1;
    }
    fields
}

/// Numbers, arrays and rows of them.
trait Reals {
    const COUNT: usize;
    const ZERO: Self;
    fn slice(&self) -> &[f64];
    fn slice_mut(&mut self) -> &mut [f64];
}

impl Reals for f64 {
    const COUNT: usize = 1;
    const ZERO: Self = 0.0;
    fn slice(&self) -> &[f64] {
        core::slice::from_ref(self)
    }
    fn slice_mut(&mut self) -> &mut [f64] {
        core::slice::from_mut(self)
    }
}

impl<const N: usize> Reals for [f64; N] {
    const COUNT: usize = N;
    const ZERO: Self = [0.0; N];
    fn slice(&self) -> &[f64] {
        self
    }
    fn slice_mut(&mut self) -> &mut [f64] {
        self
    }
}

impl<const N: usize, const M: usize> Reals for [[f64; M]; N] {
    const COUNT: usize = N * M;
    const ZERO: Self = [[0.0; M]; N];
    fn slice(&self) -> &[f64] {
        self.as_flattened()
    }
    fn slice_mut(&mut self) -> &mut [f64] {
        self.as_flattened_mut()
    }
}

/// Number `index` of the field at `at`.
#[inline]
fn real_at(bytes: &[u8], version: Version, at: usize, index: usize) -> f64 {
    if version.is_single() {
        f32::from_le_bytes(get(bytes, at + 4 * index)).into()
    } else {
        f64::from_le_bytes(get(bytes, at + 8 * index))
    }
}

/// Reads a field, zeros where the version does not have it.
#[inline]
fn read<T: Reals>(bytes: &[u8], version: Version, field: &Field) -> T {
    let mut value = T::ZERO;
    if let Some(at) = field.offset(version) {
        for (index, real) in value.slice_mut().iter_mut().enumerate() {
            *real = real_at(bytes, version, at, index);
        }
    }
    value
}

/// Writes a field where the version has it, rounded to its precision.
fn write(bytes: &mut [u8], version: Version, field: &Field, values: &[f64]) {
    if let Some(at) = field.offset(version) {
        for (i, &value) in values.iter().enumerate() {
            if version.is_single() {
                put(bytes, at + 4 * i, (value as f32).to_le_bytes());
            } else {
                put(bytes, at + 8 * i, value.to_le_bytes());
            }
        }
    }
}

/// Fields of reals in the order of the wire: their places, accessors of the view, members
/// of the value.
macro_rules! reals {
    ($($name:ident, $const:ident: $type:ty = $vendor:literal, $unit:literal $(in $frame:literal)?,
        $meaning:literal $(, $single:ident)?;)+) => {
        /// The place of a field in [`FIELDS`].
        #[allow(non_camel_case_types)]
        enum Place { $($name,)+ }

        /// All fields of reals, in the order of the wire.
        pub const FIELDS: [Field; [$($vendor),+].len()] = place([
            $(Field {
                name: $vendor,
                unit: $unit,
                frame: concat!("" $(, $frame)?),
                meaning: $meaning,
                count: <$type as Reals>::COUNT,
                double: reals!(@double $($single)?),
                single: 0,
            },)+
        ]);

        /// Fields of reals by name.
        pub mod field {
            use super::{FIELDS, Field, Place};
            $(
                #[doc = concat!("`", $vendor, "` \\[", $unit, "\\]" $(, ", frame: ", $frame)?, ": ", $meaning, ".")]
                pub const $const: Field = FIELDS[Place::$name as usize];
            )+
        }

        impl<T: AsRef<[u8]>> StatePacket<T> {
            $(
                #[doc = concat!("`", $vendor, "` \\[", $unit, "\\]" $(, ", frame: ", $frame)?, ": ", $meaning, ".")]
                #[must_use]
                #[inline]
                pub fn $name(&self) -> $type {
                    const FIELD: Field = field::$const;
                    read(self.slice(), self.version, &FIELD)
                }
            )+
        }

        /// A state as a plain value.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct State {
            /// Milliseconds since the robot's start: one more in every state.
            pub message_id: u64,
            /// Motion generator that runs.
            pub motion_generator_mode: MotionGeneratorMode,
            /// Controller that runs.
            pub controller_mode: ControllerMode,
            /// State of the robot.
            pub robot_mode: RobotMode,
            /// Errors now.
            pub errors: RobotErrors,
            /// Errors that have aborted the last motion.
            pub reflex_reason: RobotErrors,
            $(
                #[doc = concat!("`", $vendor, "` \\[", $unit, "\\]" $(, ", frame: ", $frame)?, ": ", $meaning, ".")]
                pub $name: $type,
            )+
        }

        impl State {
            /// Everything in a checked datagram.
            #[must_use]
            pub fn parse<T: AsRef<[u8]>>(packet: &StatePacket<T>) -> Self {
                Self {
                    message_id: packet.message_id(),
                    motion_generator_mode: packet.motion_generator_mode(),
                    controller_mode: packet.controller_mode(),
                    robot_mode: packet.robot_mode(),
                    errors: packet.errors(),
                    reflex_reason: packet.reflex_reason(),
                    $($name: packet.$name(),)+
                }
            }

            /// The numbers of every field, in the order of [`FIELDS`].
            #[must_use]
            pub fn reals(&self) -> [&[f64]; FIELDS.len()] {
                [$(self.$name.slice(),)+]
            }

            /// The same, to be changed.
            pub fn reals_mut(&mut self) -> [&mut [f64]; FIELDS.len()] {
                [$(self.$name.slice_mut(),)+]
            }
        }
    };
    (@double) => { Some(0) };
    (@double $single:ident) => { None };
}

reals! {
    o_t_ee, O_T_EE: Pose = "O_T_EE", "m" in "base",
        "measured pose of the end effector";
    o_t_ee_d, O_T_EE_D: Pose = "O_T_EE_d", "m" in "base",
        "desired pose of the end effector";
    f_t_ee, F_T_EE: Pose = "F_T_EE", "m" in "flange",
        "pose of the end effector: F_T_NE times NE_T_EE";
    ee_t_k, EE_T_K: Pose = "EE_T_K", "m" in "end effector",
        "pose of the stiffness frame, by SetEEToK";
    f_t_ne, F_T_NE: Pose = "F_T_NE", "m" in "flange",
        "pose of the nominal end effector, by the vendor's web interface";
    ne_t_ee, NE_T_EE: Pose = "NE_T_EE", "m" in "nominal end effector",
        "pose of the end effector, by SetNEToEE";
    m_ee, M_EE: f64 = "m_ee", "kg",
        "mass of the end effector";
    i_ee, I_EE: [f64; 9] = "I_ee", "kg m2",
        "inertia of the end effector about its centre of mass, column by column";
    f_x_cee, F_X_CEE: [f64; 3] = "F_x_Cee", "m" in "flange",
        "centre of mass of the end effector";
    m_load, M_LOAD: f64 = "m_load", "kg",
        "mass of the load, by SetLoad";
    i_load, I_LOAD: [f64; 9] = "I_load", "kg m2",
        "inertia of the load about its centre of mass, by SetLoad, column by column";
    f_x_cload, F_X_CLOAD: [f64; 3] = "F_x_Cload", "m" in "flange",
        "centre of mass of the load, by SetLoad";
    elbow, ELBOW: [f64; 2] = "elbow", "rad, 1",
        "angle of joint 3; sign of the elbow, that of q4 + 0.467002423653011";
    elbow_d, ELBOW_D: [f64; 2] = "elbow_d", "rad, 1",
        "desired angle of joint 3 and sign of the elbow";
    tau_j, TAU_J: [f64; DOF] = "tau_J", "Nm",
        "measured joint torque on the side of the links, gravity included";
    tau_j_d, TAU_J_D: [f64; DOF] = "tau_J_d", "Nm",
        "joint torque that acted in the last cycle, without gravity";
    dtau_j, DTAU_J: [f64; DOF] = "dtau_J", "Nm/s",
        "rate of the measured joint torque";
    q, Q: [f64; DOF] = "q", "rad",
        "measured joint angles";
    q_d, Q_D: [f64; DOF] = "q_d", "rad",
        "desired joint angles";
    dq, DQ: [f64; DOF] = "dq", "rad/s",
        "measured joint speeds";
    dq_d, DQ_D: [f64; DOF] = "dq_d", "rad/s",
        "desired joint speeds";
    ddq_d, DDQ_D: [f64; DOF] = "ddq_d", "rad/s2",
        "desired joint accelerations";
    joint_contact, JOINT_CONTACT: [f64; DOF] = "joint_contact", "1",
        "level of contact of the joints, 0 below the lower threshold";
    cartesian_contact, CARTESIAN_CONTACT: [f64; 6] = "cartesian_contact", "1",
        "level of contact along x y z and about them, 0 below the lower threshold";
    joint_collision, JOINT_COLLISION: [f64; DOF] = "joint_collision", "1",
        "level of collision of the joints, 0 below the upper threshold; stays until recovery";
    cartesian_collision, CARTESIAN_COLLISION: [f64; 6] = "cartesian_collision", "1",
        "level of collision along x y z and about them, 0 below the upper threshold; stays until recovery";
    tau_ext_hat_filtered, TAU_EXT_HAT_FILTERED: [f64; DOF] = "tau_ext_hat_filtered", "Nm",
        "external joint torque: measured without that of the robot's model, filtered";
    o_f_ext_hat_k, O_F_EXT_HAT_K: [f64; 6] = "O_F_ext_hat_K", "N, Nm" in "base",
        "force and torque at the stiffness frame, of the external joint torque; positive what the robot exerts";
    k_f_ext_hat_k, K_F_EXT_HAT_K: [f64; 6] = "K_F_ext_hat_K", "N, Nm" in "stiffness frame",
        "force and torque at the stiffness frame, of the external joint torque; positive what the robot exerts";
    o_dp_ee_d, O_DP_EE_D: [f64; 6] = "O_dP_EE_d", "m/s, rad/s" in "base",
        "desired twist of the end effector";
    o_ddp_o, O_DDP_O: [f64; 3] = "O_ddP_O", "m/s2" in "base",
        "acceleration of the base: 0 0 -9.81";
    elbow_c, ELBOW_C: [f64; 2] = "elbow_c", "rad, 1",
        "commanded angle of joint 3 and sign of the elbow";
    delbow_c, DELBOW_C: [f64; 2] = "delbow_c", "rad/s, 1",
        "commanded speed of the elbow";
    ddelbow_c, DDELBOW_C: [f64; 2] = "ddelbow_c", "rad/s2, 1",
        "commanded acceleration of the elbow";
    o_t_ee_c, O_T_EE_C: Pose = "O_T_EE_c", "m" in "base",
        "commanded pose of the end effector";
    o_dp_ee_c, O_DP_EE_C: [f64; 6] = "O_dP_EE_c", "m/s, rad/s" in "base",
        "commanded twist of the end effector";
    o_ddp_ee_c, O_DDP_EE_C: [f64; 6] = "O_ddP_EE_c", "m/s2, rad/s2" in "base",
        "commanded acceleration of the end effector";
    theta, THETA: [f64; DOF] = "theta", "rad",
        "motor angles";
    dtheta, DTHETA: [f64; DOF] = "dtheta", "rad/s",
        "motor speeds";
    accelerometer_top, ACCELEROMETER_TOP: [[f64; 3]; 6] = "accelerometer_top", "m/s2" in "sensor",
        "accelerations x y z at joints 1 to 6, upper sensors; zeros before version 10", single;
    accelerometer_bottom, ACCELEROMETER_BOTTOM: [[f64; 3]; 6] = "accelerometer_bottom", "m/s2" in "sensor",
        "accelerations x y z at joints 1 to 6, lower sensors; zeros before version 10", single;
    control_command_success_rate, CONTROL_COMMAND_SUCCESS_RATE: f64 = "control_command_success_rate", "1",
        "share of the last 100 commands that came in time, 0 to 1; 0 without a motion";
}

/// Bytes that have passed the check of a state.
#[derive(Clone, Copy, Debug)]
pub struct StatePacket<T: AsRef<[u8]>> {
    version: Version,
    bytes: T,
}

impl<T: AsRef<[u8]>> StatePacket<T> {
    /// Checks length, modes, and that truth values are 0 or 1.
    ///
    /// # Errors
    /// The first thing that is wrong, in this order.
    pub fn new_checked(version: Version, bytes: T) -> Result<Self, Error> {
        let slice = bytes.as_ref();
        let (found, expected) = (slice.len(), version.state_len());
        if found != expected {
            return Err(Error::Length {
                what: "state",
                found,
                min: expected,
                max: expected,
            });
        }
        let block = slice.get(block(version)..).unwrap_or(&[]);
        let code = |at| get::<1>(block, at)[0].into();
        MotionGeneratorMode::from_code(version, code(at::MOTION_GENERATOR_MODE))?;
        ControllerMode::from_code(version, code(at::CONTROLLER_MODE))?;
        RobotMode::from_code(version, code(at::ROBOT_MODE))?;
        for (field, at) in [("errors", at::ERRORS), ("reflex_reason", at::REFLEX_REASON)] {
            for (index, byte) in get::<COUNT>(block, at).into_iter().enumerate() {
                check_bool(field, index, byte)?;
            }
        }
        Ok(Self { version, bytes })
    }

    /// Whether the numbers of fields that are used are numbers. Others may be anything.
    ///
    /// # Errors
    /// The first one that is infinite or NaN.
    pub fn check_finite(&self, fields: &[Field]) -> Result<(), Error> {
        let version = self.version;
        for field in fields {
            let Some(at) = field.offset(version) else {
                continue;
            };
            for index in 0..field.count {
                if !real_at(self.slice(), version, at, index).is_finite() {
                    let field = field.name;
                    return Err(Error::NotFinite { field, index });
                }
            }
        }
        Ok(())
    }

    /// The version that it was checked for.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    fn slice(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    fn code(&self, at: usize) -> u32 {
        let [code] = get(self.slice(), block(self.version) + at);
        code.into()
    }

    /// Milliseconds since the robot's start: one more in every state.
    #[must_use]
    pub fn message_id(&self) -> u64 {
        u64::from_le_bytes(get(self.slice(), at::MESSAGE_ID))
    }

    /// Motion generator that runs.
    #[must_use]
    pub fn motion_generator_mode(&self) -> MotionGeneratorMode {
        let code = self.code(at::MOTION_GENERATOR_MODE);
        MotionGeneratorMode::from_code(self.version, code).unwrap_or_default()
    }

    /// Controller that runs.
    #[must_use]
    pub fn controller_mode(&self) -> ControllerMode {
        let code = self.code(at::CONTROLLER_MODE);
        ControllerMode::from_code(self.version, code).unwrap_or_default()
    }

    /// State of the robot.
    #[must_use]
    pub fn robot_mode(&self) -> RobotMode {
        RobotMode::from_code(self.version, self.code(at::ROBOT_MODE)).unwrap_or_default()
    }

    /// Errors now.
    #[must_use]
    pub fn errors(&self) -> RobotErrors {
        RobotErrors::read(self.slice(), block(self.version) + at::ERRORS)
    }

    /// Errors that have aborted the last motion.
    #[must_use]
    pub fn reflex_reason(&self) -> RobotErrors {
        RobotErrors::read(self.slice(), block(self.version) + at::REFLEX_REASON)
    }
}

impl State {
    /// The datagram: the first bytes of `bytes`. Reals are sent as they are, in version 10
    /// rounded to binary32.
    ///
    /// # Errors
    /// A mode that the version does not have.
    pub fn emit<'a>(
        &self,
        version: Version,
        bytes: &'a mut [u8; LEN_MAX],
    ) -> Result<&'a [u8], Error> {
        // Codes of modes are below 256.
        let modes = [
            self.motion_generator_mode.code(version)? as u8,
            self.controller_mode.code(version)? as u8,
        ];
        let robot_mode = [self.robot_mode.code(version)? as u8];
        put(bytes, at::MESSAGE_ID, self.message_id.to_le_bytes());
        for (field, values) in FIELDS.iter().zip(self.reals()) {
            write(bytes, version, field, values);
        }
        let block = block(version);
        put(bytes, block + at::MOTION_GENERATOR_MODE, modes);
        put(bytes, block + at::ERRORS, self.errors.bytes());
        put(bytes, block + at::REFLEX_REASON, self.reflex_reason.bytes());
        put(bytes, block + at::ROBOT_MODE, robot_mode);
        Ok(bytes.get(..version.state_len()).unwrap_or(&[]))
    }
}
