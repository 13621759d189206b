//! Byte ranges of a measurement, in wire order.

pub use crate::wire::header::field::*;

use super::LEN;
use crate::wire::codes::{ControlScheme, Quality, State};
use crate::wire::field::{Field, Kind, tile};

/// Controller time \[s\].
pub const TIMESTAMP: Field = Field::f32("timestamp", 140);
/// State of the interface: 0 off, 1 monitor, 2 command.
pub const STATE: Field = Field::new(
    "state",
    144,
    Kind::Code {
        max: State::Command.raw(),
    },
    1,
);
/// Quality of the link: 0 unacceptable, 1 bad, 2 ok, 3 perfect.
pub const QUALITY: Field = Field::new(
    "quality",
    146,
    Kind::Code {
        max: Quality::Perfect.raw(),
    },
    1,
);
/// Configured period of measurements \[s\].
pub const MSR_PERIOD: Field = Field::f32("msrPeriod", 148);
/// Configured period of expected commands \[s\].
pub const CMD_PERIOD: Field = Field::f32("cmdPeriod", 152);
/// Configured safety limits, one number; scale not documented.
pub const SAFETY_LIMITS: Field = Field::f32("safetyLimits", 156);
/// Mean rate of answers, 0 to 1, ideal 1.
pub const ANSWER_RATE: Field = Field::f32("answerRate", 160);
/// Mean latency of answers \[s\].
pub const LATENCY: Field = Field::f32("latency", 164);
/// Mean jitter of answers \[s\].
pub const JITTER: Field = Field::f32("jitter", 168);
/// Mean rate of missed answers, 0 to 1, ideal 0.
pub const MISS_RATE: Field = Field::f32("missRate", 172);
/// Answers missed in all.
pub const MISSED: Field = Field::new("missed", 176, Kind::U32, 1);
/// Drive power bits; any bit set reads as on.
pub const POWER: Field = Field::u16("power", 180);
/// Control scheme: 0 other, 1 position, 2 Cartesian impedance, 3 joint impedance.
pub const CONTROL: Field = Field::new(
    "control",
    182,
    Kind::Code {
        max: ControlScheme::JointImpedance.raw(),
    },
    1,
);
/// Drive error bits.
pub const ERROR: Field = Field::u16("error", 184);
/// Drive warning bits.
pub const WARNING: Field = Field::u16("warning", 186);
/// Drive temperatures, 7.
pub const TEMPERATURE: Field = Field::f32s("temperature", 188, 7);
/// Measured joint angles \[rad\], 7.
pub const MSR_JNT_POS: Field = Field::f32s("msrJntPos", 216, 7);
/// Measured tool frame \[m\], 3 rows of 4.
pub const MSR_CART_POS: Field = Field::f32s("msrCartPos", 244, 12);
/// Joint angles the KRC commands before FRI \[rad\], 7.
pub const CMD_JNT_POS: Field = Field::f32s("cmdJntPos", 292, 7);
/// What FRI adds to them \[rad\], 7.
pub const CMD_JNT_POS_FRI_OFFSET: Field = Field::f32s("cmdJntPosFriOffset", 320, 7);
/// Frame the KRC commands before FRI \[m\], 3 rows of 4.
pub const CMD_CART_POS: Field = Field::f32s("cmdCartPos", 348, 12);
/// Frame part due to FRI \[m\], 3 rows of 4.
pub const CMD_CART_POS_FRI_OFFSET: Field = Field::f32s("cmdCartPosFriOffset", 396, 12);
/// Torque of the joint sensors \[Nm\], 7.
pub const MSR_JNT_TRQ: Field = Field::f32s("msrJntTrq", 444, 7);
/// Estimated external joint torque \[Nm\], 7.
pub const EST_EXT_JNT_TRQ: Field = Field::f32s("estExtJntTrq", 472, 7);
/// Estimated external wrench Fx Fy Fz Tz Ty Tx \[N, Nm\].
pub const EST_EXT_TCP_FT: Field = Field::f32s("estExtTcpFT", 500, 6);
/// Jacobian, rows X Y Z RZ RY RX of 7.
pub const JACOBIAN: Field = Field::f32s("jacobian", 524, 42);
/// Mass matrix \[kg m2\], 7 rows of 7.
pub const MASS_MATRIX: Field = Field::f32s("massMatrix", 692, 49);
/// Gravity vector, 7.
pub const GRAVITY: Field = Field::f32s("gravity", 888, 7);

/// Every field, in wire order, without gap.
pub const ALL: [Field; 36] = [
    SEND_SEQ,
    REFL_SEQ,
    PACKET_SIZE,
    DATAGRAM_ID,
    REAL,
    INT,
    BOOL,
    FILL,
    TIMESTAMP,
    STATE,
    QUALITY,
    MSR_PERIOD,
    CMD_PERIOD,
    SAFETY_LIMITS,
    ANSWER_RATE,
    LATENCY,
    JITTER,
    MISS_RATE,
    MISSED,
    POWER,
    CONTROL,
    ERROR,
    WARNING,
    TEMPERATURE,
    MSR_JNT_POS,
    MSR_CART_POS,
    CMD_JNT_POS,
    CMD_JNT_POS_FRI_OFFSET,
    CMD_CART_POS,
    CMD_CART_POS_FRI_OFFSET,
    MSR_JNT_TRQ,
    EST_EXT_JNT_TRQ,
    EST_EXT_TCP_FT,
    JACOBIAN,
    MASS_MATRIX,
    GRAVITY,
];

const _: () = assert!(tile(&ALL, LEN));
