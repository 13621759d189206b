//! The command: the client's answer to a state while a motion runs.
//!
//! Fields lie one behind the other, little endian, reals in binary64:
//!
//! | field | type | at |
//! |---|---|---|
//! | message_id | u64 | 0 |
//! | q_c | 7 f64 | 8 |
//! | dq_c | 7 f64 | 64 |
//! | O_T_EE_c | 16 f64 | 120 |
//! | O_dP_EE_c | 6 f64 | 248 |
//! | elbow_c | 2 f64 | 296 |
//! | valid_elbow | bool | 312 |
//! | motion_generation_finished | bool | 313 |
//! | tau_J_d | 7 f64 | 314 |
//! | torque_command_finished | bool | 370, from version 7 |

use crate::bytes::{Reader, Writer, check_finite};
use crate::error::Error;
use crate::state::{DOF, Pose};
use crate::version::Version;

/// Bytes of the longest command.
pub const LEN_MAX: usize = 371;

impl Version {
    /// Bytes of a command.
    #[must_use]
    pub const fn command_len(self) -> usize {
        if self.has_torque_finished() {
            LEN_MAX
        } else {
            LEN_MAX - 1
        }
    }
}

/// A command as a plain value. Fields of what does not run are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// `message_id` of the state that is answered.
    pub message_id: u64,
    /// Joint angles \[rad\].
    pub q_c: [f64; DOF],
    /// Joint speeds \[rad/s\].
    pub dq_c: [f64; DOF],
    /// Pose of the end effector in the base frame \[m\].
    pub o_t_ee_c: Pose,
    /// Twist of the end effector in the base frame \[m/s\], \[rad/s\].
    pub o_dp_ee_c: [f64; 6],
    /// Angle of joint 3 \[rad\] and sign of the elbow.
    pub elbow_c: [f64; 2],
    /// Whether `elbow_c` counts.
    pub valid_elbow: bool,
    /// The motion ends with this command.
    pub motion_generation_finished: bool,
    /// Joint torque \[Nm\] without that of gravity and friction, which the robot adds.
    pub tau_j_d: [f64; DOF],
    /// The torque ends with this command; before version 7 it is not sent.
    pub torque_command_finished: bool,
}

impl Command {
    /// A command of torque alone \[Nm\], for a motion by
    /// [`Move::torque`](crate::Move::torque); `finished` ends it.
    #[must_use]
    pub fn torque(version: Version, message_id: u64, tau_j_d: [f64; DOF], finished: bool) -> Self {
        Self {
            message_id,
            tau_j_d,
            motion_generation_finished: finished && !version.has_torque_alone(),
            torque_command_finished: finished && version.has_torque_alone(),
            ..Self::default()
        }
    }

    /// Whether it ends the motion.
    #[must_use]
    pub fn is_last(&self) -> bool {
        self.motion_generation_finished || self.torque_command_finished
    }

    /// Everything in a datagram, reals as they are.
    ///
    /// # Errors
    /// Another length, a truth value that is neither 0 nor 1.
    pub fn parse(version: Version, bytes: &[u8]) -> Result<Self, Error> {
        let (found, expected) = (bytes.len(), version.command_len());
        if found != expected {
            return Err(Error::Length {
                what: "command",
                found,
                min: expected,
                max: expected,
            });
        }
        let mut from = Reader::new(bytes);
        Ok(Self {
            message_id: from.u64(),
            q_c: from.reals(),
            dq_c: from.reals(),
            o_t_ee_c: from.reals(),
            o_dp_ee_c: from.reals(),
            elbow_c: from.reals(),
            valid_elbow: from.bool("valid_elbow")?,
            motion_generation_finished: from.bool("motion_generation_finished")?,
            tau_j_d: from.reals(),
            torque_command_finished: version.has_torque_finished()
                && from.bool("torque_command_finished")?,
        })
    }

    /// The datagram: the first bytes of `bytes`. Reals are sent as they are.
    pub fn emit<'a>(&self, version: Version, bytes: &'a mut [u8; LEN_MAX]) -> &'a [u8] {
        let mut to = Writer::new(bytes);
        to.put(self.message_id.to_le_bytes());
        to.reals(&self.q_c);
        to.reals(&self.dq_c);
        to.reals(&self.o_t_ee_c);
        to.reals(&self.o_dp_ee_c);
        to.reals(&self.elbow_c);
        to.bools(&[self.valid_elbow, self.motion_generation_finished]);
        to.reals(&self.tau_j_d);
        if version.has_torque_finished() {
            to.bools(&[self.torque_command_finished]);
        }
        to.finish().unwrap_or(&[])
    }

    /// Whether all numbers are numbers: no client may send others.
    ///
    /// # Errors
    /// The first one that is infinite or NaN.
    pub fn check(&self) -> Result<(), Error> {
        check_finite("q_c", &self.q_c)?;
        check_finite("dq_c", &self.dq_c)?;
        check_finite("O_T_EE_c", &self.o_t_ee_c)?;
        check_finite("O_dP_EE_c", &self.o_dp_ee_c)?;
        check_finite("elbow_c", &self.elbow_c)?;
        check_finite("tau_J_d", &self.tau_j_d)
    }
}
