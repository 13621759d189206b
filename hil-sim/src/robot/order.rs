//! Datagrams on the robot's side: what an answer orders, and what a measurement
//! is filled with.

use controller_core::joint::{DOF, JointVector};
use fri::{Command, CommandPacket, Error, Flags};

/// Largest stiffness that counts \[Nm/rad\].
pub const STIFFNESS_MAX: f64 = 2000.0;

/// Content of an answer, as far as this robot uses it. A field without its flag is
/// none: the robot's own value counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Counter of the client.
    pub counter: u16,
    /// Counter of the measurement that it answers.
    pub reflected: u16,
    /// cmdFlags.
    pub flags: u32,
    /// jntPos \[rad\].
    pub position: Option<JointVector<f64>>,
    /// addJntTrq \[Nm\].
    pub torque: Option<JointVector<f64>>,
    /// jntStiffness \[Nm/rad\], within 0 to 2000.
    pub stiffness: Option<JointVector<f64>>,
    /// jntDamping, a ratio, within 0 to 1.
    pub damping: Option<JointVector<f64>>,
    /// int\[0\]: the strategy asked for.
    pub strategy: i32,
    /// int\[1\] = 1: command state is asked for.
    pub wants_command: bool,
    /// real\[0..7\]: by convention of this simulation the client's residual \[Nm\].
    pub residual: JointVector<f64>,
}

/// Fields of a command whose flag says whether they count: flag, offset, reals.
const FLAGGED: [(u32, usize, usize); 8] = [
    (0x0001, 144, 7),
    (0x0100, 172, 12),
    (0x0004, 220, 7),
    (0x0400, 248, 6),
    (0x0010, 272, 7),
    (0x0020, 300, 7),
    (0x1000, 328, 6),
    (0x2000, 352, 6),
];

/// Reads an answer.
///
/// # Errors
/// It is no command datagram, or a real that counts is not finite.
pub fn read(datagram: &[u8]) -> Result<Order, Error> {
    // What a client leaves in fields that it does not use is its own affair.
    let mut bytes: [u8; Command::LEN] = match datagram.try_into() {
        Ok(bytes) => bytes,
        Err(_) => return CommandPacket::new_checked(datagram).map(|packet| order(&packet)),
    };
    let flags = u32::from_le_bytes([bytes[140], bytes[141], bytes[142], bytes[143]]);
    for (flag, at, reals) in FLAGGED {
        if flags & flag == 0 {
            bytes[at..at + 4 * reals].fill(0);
        }
    }
    // User data are free; those that are no numbers read as zero.
    for at in (8..72).step_by(4) {
        let real = f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        if !real.is_finite() {
            bytes[at..at + 4].fill(0);
        }
    }
    CommandPacket::new_checked(&bytes[..]).map(|packet| order(&packet))
}

fn order<T: AsRef<[u8]>>(packet: &CommandPacket<T>) -> Order {
    let command = Command::parse(packet);
    let vector = |values: &[f32; DOF]| JointVector::from(values.map(f64::from));
    let given = |flag, values: &[f32; DOF]| command.flags.contains(flag).then(|| vector(values));
    let within = |values: Option<JointVector<f64>>, max: f64| {
        values.map(|values| values.map(|value| value.clamp(0.0, max)))
    };
    let user = &command.user;
    Order {
        counter: command.header.counter,
        reflected: command.header.reflected,
        flags: command.flags.0,
        position: given(Flags::JOINT_POSITION, &command.joint_position),
        torque: given(Flags::JOINT_TORQUE, &command.joint_torque),
        stiffness: within(
            given(Flags::JOINT_STIFFNESS, &command.joint_stiffness),
            STIFFNESS_MAX,
        ),
        damping: within(given(Flags::JOINT_DAMPING, &command.joint_damping), 1.0),
        strategy: user.int[0],
        wants_command: user.int[1] == 1,
        residual: JointVector::from_fn(|i, _| f64::from(user.real[i])),
    }
}

/// A joint vector in binary32.
#[must_use]
pub fn wire(vector: &JointVector<f64>) -> [f32; DOF] {
    std::array::from_fn(|i| vector[i] as f32)
}
