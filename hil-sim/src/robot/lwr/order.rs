//! Datagrams on the robot's side: what an answer orders, whether command state may begin
//! with it, and what a measurement is filled with.

use controller_core::fault::Mode;
use controller_core::joint::{DOF, JointVector};
use fri::{Command, CommandPacket, ControlScheme, Error, Flags, UserData};

use super::options::{Krl, RobotOptions, scheme_of_strategy};

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
    /// int\[2\]: by convention of this simulation the client's mode plus 1.
    pub mode: Option<Mode>,
    /// real\[0..7\]: by convention of this simulation the client's residual \[Nm\].
    pub residual: JointVector<f64>,
}

impl Order {
    /// The checks before command state, when the robot holds `hold` \[rad\]: the scheme
    /// that begins. `joints` are their names.
    ///
    /// # Errors
    /// Why it does not begin, in the client's terms.
    pub fn entry(
        &self,
        options: &RobotOptions,
        hold: &JointVector<f64>,
        joints: &[&str; DOF],
        drives_on: bool,
    ) -> Result<ControlScheme, String> {
        let scheme = match options.krl {
            Krl::Auto => options.scheme,
            Krl::Handshake => scheme_of_strategy(self.strategy)?,
        };
        if !drives_on {
            return Err("drives are off".into());
        }
        if self.position.is_none() && scheme == ControlScheme::Position {
            return Err("cmdFlags do not set jntPos (0x0001), which this scheme needs".into());
        }
        for joint in 0..DOF {
            let off = self
                .position
                .map_or(0.0, |q| (q[joint] - hold[joint]).abs());
            if off > options.entry_position_rad {
                return Err(format!(
                    "jntPos of {} is {:.1} mrad from the commanded position; allowed: {:.1}",
                    joints[joint],
                    off * 1e3,
                    options.entry_position_rad * 1e3
                ));
            }
        }
        for joint in 0..DOF {
            let torque = self.torque.map_or(0.0, |torque| torque[joint]);
            if torque.abs() > options.entry_torque_nm {
                return Err(format!(
                    "addJntTrq of {} is {torque:.2} Nm; allowed: {:.2}",
                    joints[joint], options.entry_torque_nm
                ));
            }
        }
        Ok(scheme)
    }
}

/// Reads an answer.
///
/// # Errors
/// It is no command datagram, or a real that counts is not finite.
pub fn read(datagram: &[u8]) -> Result<Order, Error> {
    let bytes = datagram.try_into().map_err(|_| Error::Length {
        found: datagram.len(),
        expected: Command::LEN,
    })?;
    // What a client leaves in fields that it does not use is its own affair.
    let flags = CommandPacket::new_checked(used(bytes, Flags::default()))?.flags();
    let packet = CommandPacket::new_checked(used(bytes, flags))?;
    Ok(order(&Command::parse(&packet), &UserData::read(bytes)))
}

/// The datagram with zeros for user reals, and for the fields that `flags` do not set.
fn used(bytes: &[u8; Command::LEN], flags: Flags) -> [u8; Command::LEN] {
    // No byte of it is zero, as those of the empty datagram are there.
    const MARK: f32 = f32::from_bits(0x3F3F_3F3F);
    let mark = |flag| if flags.contains(flag) { 0.0 } else { MARK };
    let marked = Command {
        user: UserData {
            real: [MARK; 16],
            ..UserData::default()
        },
        joint_position: [mark(Flags::JOINT_POSITION); DOF],
        frame: [mark(Flags::FRAME); 12],
        joint_torque: [mark(Flags::JOINT_TORQUE); DOF],
        wrench: [mark(Flags::WRENCH); 6],
        joint_stiffness: [mark(Flags::JOINT_STIFFNESS); DOF],
        joint_damping: [mark(Flags::JOINT_DAMPING); DOF],
        cartesian_stiffness: [mark(Flags::CARTESIAN_STIFFNESS); 6],
        cartesian_damping: [mark(Flags::CARTESIAN_DAMPING); 6],
        ..Command::default()
    };
    let (mut here, mut empty) = ([0; Command::LEN], [0; Command::LEN]);
    marked.emit(&mut here);
    Command::default().emit(&mut empty);
    std::array::from_fn(|i| if here[i] == empty[i] { bytes[i] } else { 0 })
}

fn order(command: &Command, user: &UserData) -> Order {
    let vector = |values: &[f32; DOF]| JointVector::from(values.map(f64::from));
    let given = |flag, values: &[f32; DOF]| command.flags.contains(flag).then(|| vector(values));
    let within = |values: Option<JointVector<f64>>, max: f64| {
        values.map(|values| values.map(|value| value.clamp(0.0, max)))
    };
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
        mode: user.int[2]
            .checked_sub(1)
            .and_then(|number| Mode::ALL.get(usize::try_from(number).ok()?))
            .copied(),
        // User data are free; those that are no numbers read as zero.
        residual: JointVector::from_fn(|i, _| match user.real[i] {
            real if real.is_finite() => real.into(),
            _ => 0.0,
        }),
    }
}

/// A joint vector in binary32.
#[must_use]
pub fn wire(vector: &JointVector<f64>) -> [f32; DOF] {
    std::array::from_fn(|i| vector[i] as f32)
}
