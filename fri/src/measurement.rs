//! The measurement (MSR): what the robot reports every cycle.

use crate::blocks::{Header, UserData, check, check_finite};
use crate::bytes::{f32s_at, put, put_f32s, u16_at, u32_at};
use crate::error::Error;
use crate::frame::{DOF, Frame};

/// Bytes of a measurement.
pub const LEN: usize = 916;

/// Its id, also the version of the interface.
pub const ID: u16 = 0x2006;

/// Offsets.
mod field {
    pub const TIMESTAMP: usize = 140;
    pub const STATE: usize = 144;
    pub const QUALITY: usize = 146;
    pub const PERIODS_AND_LIMITS: usize = 148;
    pub const STATISTICS: usize = 160;
    pub const MISSED: usize = 176;
    pub const POWER: usize = 180;
    pub const CONTROL: usize = 182;
    pub const ERROR: usize = 184;
    pub const WARNING: usize = 186;
    pub const TEMPERATURE: usize = 188;
    pub const JOINT_POSITION: usize = 216;
    pub const FRAME: usize = 244;
    pub const COMMANDED_POSITION: usize = 292;
    pub const FRI_OFFSET: usize = 320;
    pub const COMMANDED_FRAME: usize = 348;
    pub const FRI_FRAME_OFFSET: usize = 396;
    pub const JOINT_TORQUE: usize = 444;
    pub const EXTERNAL_TORQUE: usize = 472;
    pub const EXTERNAL_WRENCH: usize = 500;
    pub const JACOBIAN: usize = 524;
    pub const MASS_MATRIX: usize = 692;
    pub const GRAVITY: usize = 888;
}

/// Every field with reals: name, offset, count.
const REALS: &[(&str, usize, usize)] = &[
    ("user data real", crate::blocks::field::USER_REAL, 16),
    ("timestamp", field::TIMESTAMP, 1),
    ("periods and safety limits", field::PERIODS_AND_LIMITS, 3),
    ("statistics", field::STATISTICS, 4),
    ("temperature", field::TEMPERATURE, DOF),
    ("measured joint position", field::JOINT_POSITION, DOF),
    ("measured frame", field::FRAME, 12),
    ("commanded joint position", field::COMMANDED_POSITION, DOF),
    ("joint position offset", field::FRI_OFFSET, DOF),
    ("commanded frame", field::COMMANDED_FRAME, 12),
    ("frame offset", field::FRI_FRAME_OFFSET, 12),
    ("joint torque", field::JOINT_TORQUE, DOF),
    ("external joint torque", field::EXTERNAL_TORQUE, DOF),
    ("external wrench", field::EXTERNAL_WRENCH, 6),
    ("jacobian", field::JACOBIAN, 42),
    ("mass matrix", field::MASS_MATRIX, 49),
    ("gravity", field::GRAVITY, DOF),
];

/// An enumeration of 16 bits with 0xFFFF for "invalid".
macro_rules! code {
    ($(#[$doc:meta])* $name:ident, $field:literal, { $($(#[$variant_doc:meta])* $variant:ident = $value:literal),+ $(,)? }, $max:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
        #[repr(u16)]
        pub enum $name {
            $($(#[$variant_doc])* $variant = $value,)+
            /// The robot says that it has none.
            #[default]
            Invalid = 0xFFFF,
        }

        impl $name {
            /// From the wire.
            ///
            /// # Errors
            /// A code that means nothing.
            pub fn from_code(code: u16) -> Result<Self, Error> {
                match code {
                    $($value => Ok(Self::$variant),)+
                    0xFFFF => Ok(Self::Invalid),
                    found => Err(Error::Code { field: $field, found, max: $max }),
                }
            }

            /// To the wire.
            #[must_use]
            pub fn code(self) -> u16 {
                self as u16
            }
        }
    };
}

code!(
    /// Who commands the arm.
    InterfaceState, "interface state", {
        /// No interface: nothing is sent.
        Off = 0,
        /// Answers are rated and have no effect.
        Monitor = 1,
        /// Answers move the arm.
        Command = 2,
    }, 2
);

code!(
    /// How good the link is, by the robot's own rating of the answers.
    Quality, "quality", {
        /// No command state.
        Unacceptable = 0,
        /// Command state is possible.
        Bad = 1,
        /// Command state is possible.
        Ok = 2,
        /// Every answer in time.
        Perfect = 3,
    }, 3
);

code!(
    /// What the robot does with a command.
    ControlScheme, "control scheme", {
        /// None of the others.
        Other = 0,
        /// Joint positions replace the robot's own.
        Position = 1,
        /// Spring and damper at the tool.
        CartesianImpedance = 2,
        /// Spring, damper and added torque at every joint.
        JointImpedance = 3,
    }, 3
);

/// Bytes that have passed the check of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct MeasurementPacket<T: AsRef<[u8]>> {
    bytes: T,
}

impl<T: AsRef<[u8]>> MeasurementPacket<T> {
    /// Checks length, id, size field, codes and that every real is finite.
    ///
    /// # Errors
    /// The first thing that is wrong, in this order.
    pub fn new_checked(bytes: T) -> Result<Self, Error> {
        let slice = bytes.as_ref();
        check(slice, ID, LEN as u16)?;
        InterfaceState::from_code(u16_at(slice, field::STATE))?;
        Quality::from_code(u16_at(slice, field::QUALITY))?;
        ControlScheme::from_code(u16_at(slice, field::CONTROL))?;
        check_finite(slice, REALS)?;
        Ok(Self { bytes })
    }

    fn slice(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// Counters.
    #[must_use]
    pub fn header(&self) -> Header {
        Header::read(self.slice())
    }

    /// Data of the robot's program.
    #[must_use]
    pub fn user(&self) -> UserData {
        UserData::read(self.slice())
    }

    /// Who commands the arm.
    #[must_use]
    pub fn state(&self) -> InterfaceState {
        InterfaceState::from_code(u16_at(self.slice(), field::STATE)).unwrap_or_default()
    }

    /// How good the link is.
    #[must_use]
    pub fn quality(&self) -> Quality {
        Quality::from_code(u16_at(self.slice(), field::QUALITY)).unwrap_or_default()
    }

    /// What the robot does with a command.
    #[must_use]
    pub fn control(&self) -> ControlScheme {
        ControlScheme::from_code(u16_at(self.slice(), field::CONTROL)).unwrap_or_default()
    }

    /// Period of the measurements \[s\].
    #[must_use]
    pub fn period_s(&self) -> f32 {
        let [period, ..] = f32s_at::<3>(self.slice(), field::PERIODS_AND_LIMITS);
        period
    }

    /// Bits of the drives that are on; 0 means off.
    #[must_use]
    pub fn power(&self) -> u16 {
        u16_at(self.slice(), field::POWER)
    }

    /// Measured joint angles \[rad\].
    #[must_use]
    pub fn joint_position(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::JOINT_POSITION)
    }

    /// Joint angles commanded by the robot's program \[rad\].
    #[must_use]
    pub fn commanded_position(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::COMMANDED_POSITION)
    }

    /// What the client's commands add to them \[rad\].
    #[must_use]
    pub fn fri_offset(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::FRI_OFFSET)
    }

    /// Jacobian in the robot's row order, x y z \[m\], then rotations z y x \[1\].
    #[must_use]
    pub fn jacobian(&self) -> [[f32; DOF]; 6] {
        core::array::from_fn(|row| f32s_at(self.slice(), field::JACOBIAN + row * 4 * DOF))
    }

    /// Mass matrix \[kg m2\], row by row.
    #[must_use]
    pub fn mass_matrix(&self) -> [[f32; DOF]; DOF] {
        core::array::from_fn(|row| f32s_at(self.slice(), field::MASS_MATRIX + row * 4 * DOF))
    }

    /// Gravity torque \[Nm\], positive where it holds the arm.
    #[must_use]
    pub fn gravity(&self) -> [f32; DOF] {
        f32s_at(self.slice(), field::GRAVITY)
    }
}

/// A measurement as a plain value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Counters.
    pub header: Header,
    /// $FRI_TO_..: data of the robot's program.
    pub user: UserData,
    /// Time of the robot's controller \[s\].
    pub timestamp_s: f32,
    /// Who commands the arm.
    pub state: InterfaceState,
    /// How good the link is.
    pub quality: Quality,
    /// Configured period of the measurements \[s\].
    pub period_s: f32,
    /// Configured period of the expected commands \[s\].
    pub command_period_s: f32,
    /// Configured safety limits, one number.
    pub safety_limits: f32,
    /// Statistics of the answers.
    pub statistics: Statistics,
    /// Drives.
    pub drives: Drives,
    /// Measured joint angles \[rad\].
    pub joint_position: [f32; DOF],
    /// Measured tool frame.
    pub frame: Frame,
    /// Joint angles commanded by the robot's program \[rad\].
    pub commanded_position: [f32; DOF],
    /// What the client's commands add to them \[rad\].
    pub fri_offset: [f32; DOF],
    /// Frame commanded by the robot's program.
    pub commanded_frame: Frame,
    /// What the client's commands add to it.
    pub fri_frame_offset: Frame,
    /// Torque sensors of the joints \[Nm\].
    pub joint_torque: [f32; DOF],
    /// The robot's estimate of the external joint torque \[Nm\].
    pub external_torque: [f32; DOF],
    /// Its estimate of force \[N\] and torque \[Nm\] at the tool: Fx Fy Fz Tz Ty Tx.
    pub external_wrench: [f32; 6],
    /// Rows x y z \[m\], then rotations z y x \[1\].
    pub jacobian: [[f32; DOF]; 6],
    /// \[kg m2\], row by row.
    pub mass_matrix: [[f32; DOF]; DOF],
    /// Gravity torque \[Nm\], positive where it holds the arm.
    pub gravity: [f32; DOF],
}

/// The robot's rating of the answers, means over the last 100 datagrams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Statistics {
    /// Share of answers in time, ideal 1.
    pub answer_rate: f32,
    /// Latency \[s\].
    pub latency_s: f32,
    /// Its variation \[s\].
    pub jitter_s: f32,
    /// Share of missed answers, ideal 0.
    pub miss_rate: f32,
    /// Missed answers in all.
    pub missed: u32,
}

/// What the drives report.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Drives {
    /// Bits of the drives that are on; 0 means off.
    pub power: u16,
    /// What the robot does with a command.
    pub control: ControlScheme,
    /// Bits of drives with an error, which cuts power.
    pub error: u16,
    /// Bits of drives with a warning.
    pub warning: u16,
    /// Temperatures.
    pub temperature: [f32; DOF],
}

impl Default for Measurement {
    /// An interface that is off; frames, matrices and positions zero.
    fn default() -> Self {
        // Every code and number 0.
        Self::parse(&MeasurementPacket { bytes: [0; LEN] })
    }
}

impl Measurement {
    /// Bytes of the datagram.
    pub const LEN: usize = LEN;

    /// Everything in a checked datagram.
    #[must_use]
    pub fn parse<T: AsRef<[u8]>>(packet: &MeasurementPacket<T>) -> Self {
        let bytes = packet.slice();
        let [period_s, command_period_s, safety_limits] = f32s_at(bytes, field::PERIODS_AND_LIMITS);
        let [answer_rate, latency_s, jitter_s, miss_rate] = f32s_at(bytes, field::STATISTICS);
        let [timestamp_s] = f32s_at(bytes, field::TIMESTAMP);
        Self {
            header: packet.header(),
            user: packet.user(),
            timestamp_s,
            state: packet.state(),
            quality: packet.quality(),
            period_s,
            command_period_s,
            safety_limits,
            statistics: Statistics {
                answer_rate,
                latency_s,
                jitter_s,
                miss_rate,
                missed: u32_at(bytes, field::MISSED),
            },
            drives: Drives {
                power: packet.power(),
                control: packet.control(),
                error: u16_at(bytes, field::ERROR),
                warning: u16_at(bytes, field::WARNING),
                temperature: f32s_at(bytes, field::TEMPERATURE),
            },
            joint_position: packet.joint_position(),
            frame: f32s_at(bytes, field::FRAME),
            commanded_position: packet.commanded_position(),
            fri_offset: packet.fri_offset(),
            commanded_frame: f32s_at(bytes, field::COMMANDED_FRAME),
            fri_frame_offset: f32s_at(bytes, field::FRI_FRAME_OFFSET),
            joint_torque: f32s_at(bytes, field::JOINT_TORQUE),
            external_torque: f32s_at(bytes, field::EXTERNAL_TORQUE),
            external_wrench: f32s_at(bytes, field::EXTERNAL_WRENCH),
            jacobian: packet.jacobian(),
            mass_matrix: packet.mass_matrix(),
            gravity: packet.gravity(),
        }
    }

    /// The datagram. Reals are sent as they are: what is not finite will be
    /// refused at the other end.
    pub fn emit(&self, bytes: &mut [u8; LEN]) {
        self.header.write(bytes, ID, LEN as u16);
        self.user.write(bytes);
        put_f32s(bytes, field::TIMESTAMP, &[self.timestamp_s]);
        put(bytes, field::STATE, self.state.code().to_le_bytes());
        put(bytes, field::QUALITY, self.quality.code().to_le_bytes());
        let periods = [self.period_s, self.command_period_s, self.safety_limits];
        put_f32s(bytes, field::PERIODS_AND_LIMITS, &periods);
        let statistics = &self.statistics;
        let means = [
            statistics.answer_rate,
            statistics.latency_s,
            statistics.jitter_s,
            statistics.miss_rate,
        ];
        put_f32s(bytes, field::STATISTICS, &means);
        put(bytes, field::MISSED, statistics.missed.to_le_bytes());
        let drives = &self.drives;
        put(bytes, field::POWER, drives.power.to_le_bytes());
        put(bytes, field::CONTROL, drives.control.code().to_le_bytes());
        put(bytes, field::ERROR, drives.error.to_le_bytes());
        put(bytes, field::WARNING, drives.warning.to_le_bytes());
        put_f32s(bytes, field::TEMPERATURE, &drives.temperature);
        for (at, values) in [
            (field::JOINT_POSITION, &self.joint_position[..]),
            (field::FRAME, &self.frame),
            (field::COMMANDED_POSITION, &self.commanded_position),
            (field::FRI_OFFSET, &self.fri_offset),
            (field::COMMANDED_FRAME, &self.commanded_frame),
            (field::FRI_FRAME_OFFSET, &self.fri_frame_offset),
            (field::JOINT_TORQUE, &self.joint_torque),
            (field::EXTERNAL_TORQUE, &self.external_torque),
            (field::EXTERNAL_WRENCH, &self.external_wrench),
            (field::JACOBIAN, self.jacobian.as_flattened()),
            (field::MASS_MATRIX, self.mass_matrix.as_flattened()),
            (field::GRAVITY, &self.gravity),
        ] {
            put_f32s(bytes, at, values);
        }
    }

    /// Rows x y z \[m\], then rotations about x y z \[1\].
    #[must_use]
    pub fn jacobian_xyz(&self) -> [[f32; DOF]; 6] {
        let [x, y, z, rz, ry, rx] = self.jacobian;
        [x, y, z, rx, ry, rz]
    }

    /// Joint angles that the robot commands in all \[rad\]: what a client mirrors
    /// before command state.
    #[must_use]
    pub fn total_commanded_position(&self) -> [f32; DOF] {
        let mut total = self.commanded_position;
        for (total, offset) in total.iter_mut().zip(self.fri_offset) {
            *total += offset;
        }
        total
    }
}
