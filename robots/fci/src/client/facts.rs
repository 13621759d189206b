//! What goes into the machine and comes out of it.

use crate::modes::{Controller, ControllerMode, Generator, MotionGeneratorMode, RobotMode};
use crate::request::{CollisionBehavior, Load};
use crate::robot_error::RobotErrors;
use crate::state::{DOF, StatePacket};

use super::event::{Cause, Stop};

/// Where the conversation stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// No version is agreed on.
    Connecting,
    /// Connected; the robot's model and a first state are still to come.
    Reading,
    /// Everything is read, nothing is asked for.
    Ready,
    /// Thresholds, load, Move; then until the state shows the motion.
    Starting,
    /// The motion runs: states are answered.
    Running,
    /// The motion ends, or has ended: its second reply and an idle state are still to come.
    Ending,
    /// The end, and why.
    Stopped(Stop),
}

/// What to do about a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Duty {
    /// Nothing: there is no motion.
    Listen,
    /// One command.
    Answer,
    /// The last command once more, with the flag that ends the motion.
    Finish,
}

/// What the machine needs of a state that has passed its check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Milliseconds since the robot's start.
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
}

impl Facts {
    /// Those of a state.
    #[must_use]
    pub fn of<T: AsRef<[u8]>>(packet: &StatePacket<T>) -> Self {
        Self {
            message_id: packet.message_id(),
            motion_generator_mode: packet.motion_generator_mode(),
            controller_mode: packet.controller_mode(),
            robot_mode: packet.robot_mode(),
            errors: packet.errors(),
            reflex_reason: packet.reflex_reason(),
        }
    }

    /// Whether a motion of external torque with this generator runs.
    pub(super) fn runs(&self, generator: Generator) -> bool {
        self.robot_mode == RobotMode::Move
            && self.motion_generator_mode == generator.into()
            && self.controller_mode == Controller::External.into()
    }

    /// What stops a motion.
    pub(super) fn abort(&self) -> Option<Cause> {
        match self.robot_mode {
            RobotMode::UserStopped => Some(Cause::UserStop),
            RobotMode::Reflex => Some(Cause::Reflex(self.reasons())),
            _ => None,
        }
    }

    /// A mode in which no motion runs, and which is not where motions lead.
    pub(super) fn wrong(&self) -> Option<Cause> {
        let (found, needed) = (self.robot_mode, RobotMode::Move);
        let fine = matches!(found, RobotMode::Idle | RobotMode::Move);
        (!fine).then_some(Cause::WrongMode { found, needed })
    }

    /// Why there is a reflex.
    pub(super) fn reasons(&self) -> RobotErrors {
        if self.reflex_reason.is_empty() {
            self.errors
        } else {
            self.reflex_reason
        }
    }
}

/// Torque \[Nm\] and force \[N\] that count as a collision in the vendor's example of a compliant arm.
pub const COMPLIANT: f64 = 100.0;

/// What is set before the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Thresholds of contact and collision.
    pub thresholds: CollisionBehavior,
    /// Load besides the end effector that the robot knows; zeros for none, which takes back what
    /// another client has set.
    pub load: Load,
}

impl Start {
    /// The thresholds of a compliant arm, and no load.
    pub const COMPLIANT: Self = Self::uniform(COMPLIANT, COMPLIANT);

    /// Contact and collision at the same torque \[Nm\] of every joint and the same force \[N\] and
    /// moment \[Nm\] along and about every axis, in motion or not, and no load.
    #[must_use]
    pub const fn uniform(torque_nm: f64, force_n: f64) -> Self {
        let (torque, force) = ([torque_nm; DOF], [force_n; 6]);
        Self {
            thresholds: CollisionBehavior {
                lower_torque_acceleration: torque,
                upper_torque_acceleration: torque,
                lower_torque_nominal: torque,
                upper_torque_nominal: torque,
                lower_force_acceleration: force,
                upper_force_acceleration: force,
                lower_force_nominal: force,
                upper_force_nominal: force,
            },
            load: Load {
                m_load: 0.0,
                f_x_cload: [0.0; 3],
                i_load: [0.0; 9],
            },
        }
    }
}

/// Takes the URDF of the robot's model, which is too long for the machine to keep.
pub trait ModelSink {
    /// The next bytes of it, from the first one on; at most
    /// [`MODEL_LEN_MAX`](super::MODEL_LEN_MAX) in all.
    fn piece(&mut self, urdf: &[u8]);
}

/// Nobody wants it.
impl ModelSink for () {
    fn piece(&mut self, _: &[u8]) {}
}
