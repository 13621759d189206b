//! A command as a value.

use super::command::{CommandPacket, LEN};
use super::{Cartesian, CommandFlags, Error, Frame, Header, Joints, UserData};

/// A command: what the PC answers to one measurement.
///
/// The same datagram serves all control schemes; [`flags`](Self::flags) says which
/// fields the KRC uses. In joint impedance the robot does
/// tau = diag(k) (q_cmd - q) + D(d) + tau_add + f_dyn(q, dq, ddq), with
/// k, d, q_cmd and tau_add from here. f_dyn contains gravity, so tau_add must not.
///
/// The default uses no field; its reals are zero and its frame the identity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Cmd {
    /// Counters; `reflected` is that of the measurement this command was computed
    /// from.
    pub header: Header,
    /// Numbers for the KRL program (`$FRI_FRM_REA`, `$FRI_FRM_INT`, `$FRI_FRM_BOOL`).
    pub user: UserData,
    /// Which of the fields below the KRC uses; constant throughout command state.
    pub flags: CommandFlags,
    /// q_cmd \[rad\]. In monitor state, or with the drives off, it has to be
    /// [`Arm::total_command`](super::Arm::total_command): a robot stops when it
    /// starts to command from somewhere else.
    pub joint_position: Joints,
    /// x_cmd: tool frame for Cartesian impedance \[m\].
    pub frame: Frame,
    /// tau_add \[Nm\], without gravity, positive along the joint. Zero until command
    /// state is seen.
    pub joint_torque: Joints,
    /// Additional wrench at the tool \[N, Nm\], for Cartesian impedance.
    pub wrench: Cartesian,
    /// k \[Nm/rad\], commonly 0 to 2000.
    pub joint_stiffness: Joints,
    /// d, normalised, 0 to 1; 0.7 is usual.
    pub joint_damping: Joints,
    /// k_c \[N/m, Nm/rad\], commonly 0 to 5000 and 0 to 300.
    pub cartesian_stiffness: Cartesian,
    /// d_c, normalised, 0 to 1.
    pub cartesian_damping: Cartesian,
}

impl Cmd {
    /// Length on the wire \[byte\].
    pub const BUFFER_LEN: usize = LEN;

    /// The value of a view, which is checked for it.
    ///
    /// # Errors
    ///
    /// What [`CommandPacket::check`] refuses.
    pub fn parse<T: AsRef<[u8]>>(packet: &CommandPacket<T>) -> Result<Self, Error> {
        packet.check()?;
        Ok(Self {
            header: Header {
                sequence: packet.sequence(),
                reflected: packet.reflected(),
            },
            user: UserData {
                reals: packet.reals(),
                ints: packet.ints(),
                bools: packet.bools(),
            },
            flags: packet.flags(),
            joint_position: packet.joint_position(),
            frame: packet.frame(),
            joint_torque: packet.joint_torque(),
            wrench: packet.wrench(),
            joint_stiffness: packet.joint_stiffness(),
            joint_damping: packet.joint_damping(),
            cartesian_stiffness: packet.cartesian_stiffness(),
            cartesian_damping: packet.cartesian_damping(),
        })
    }

    /// The value of a datagram.
    ///
    /// # Errors
    ///
    /// What [`CommandPacket::check`] refuses.
    pub fn from_bytes(datagram: &[u8]) -> Result<Self, Error> {
        Self::parse(&CommandPacket::new_unchecked(datagram))
    }

    /// Writes every byte of the buffer. Reals go as they are, finite or not:
    /// senders use [`to_bytes`](Self::to_bytes).
    pub fn emit(&self, buffer: &mut [u8; LEN]) {
        let mut packet = CommandPacket::new_unchecked(buffer);
        packet.set_format();
        packet.set_sequence(self.header.sequence);
        packet.set_reflected(self.header.reflected);
        packet.set_reals(&self.user.reals);
        packet.set_ints(&self.user.ints);
        packet.set_bools(self.user.bools);
        packet.set_flags(self.flags);
        packet.set_joint_position(&self.joint_position);
        packet.set_frame(&self.frame);
        packet.set_joint_torque(&self.joint_torque);
        packet.set_wrench(&self.wrench);
        packet.set_joint_stiffness(&self.joint_stiffness);
        packet.set_joint_damping(&self.joint_damping);
        packet.set_cartesian_stiffness(&self.cartesian_stiffness);
        packet.set_cartesian_damping(&self.cartesian_damping);
    }

    /// The datagram to send.
    ///
    /// # Errors
    ///
    /// [`Error::NonFinite`]: a robot must never be sent such a number, for not
    /// every peer looks.
    pub fn to_bytes(&self) -> Result<[u8; LEN], Error> {
        let mut buffer = [0; LEN];
        self.emit(&mut buffer);
        CommandPacket::new_checked(&buffer)?;
        Ok(buffer)
    }
}
