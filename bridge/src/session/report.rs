//! What a session says of itself.

use controller_core::fault::IndexSet;
use controller_core::joint::{JointState, JointVector};
use controller_core::{ConfigError, Step};

/// Where the conversation stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// No datagram yet.
    Waiting,
    /// The robot talks and is not in command state, or its drives are off.
    Ready,
    /// In command, torque grows, posture held until time 0.
    Starting,
    /// The wanted motion.
    Moving,
    /// In command, held because the link cannot carry the motion.
    Holding,
    /// Coming to rest, then held by the robot's own stiffness.
    Stopping,
    /// At rest after the end, or the robot has left command state after it.
    Finished,
}

impl Phase {
    /// One word for reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Ready => "ready",
            Self::Starting => "starting",
            Self::Moving => "moving",
            Self::Holding => "holding",
            Self::Stopping => "stopping",
            Self::Finished => "finished",
        }
    }

    /// Whether answers carry torque.
    #[must_use]
    pub fn is_in_command(self) -> bool {
        matches!(
            self,
            Self::Starting | Self::Moving | Self::Holding | Self::Stopping
        )
    }
}

/// Why a session stops early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StopReason {
    /// The motion is over.
    Done,
    /// [`super::Session::stop`] was called.
    Asked,
    /// The controller latched a fault, see [`super::Session::fault`].
    Fault,
    /// The link was bad for longer than allowed, or when the motion should have ended.
    Link,
}

/// What became of a datagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome<E> {
    /// It is answered.
    Answered,
    /// It counts, and the robot is to get no answer.
    Heard,
    /// It is not a measurement that can be used: no answer.
    Rejected(E),
    /// It was answered before, or is older than one that was: no answer.
    Stale,
    /// No arm can be where it says, so soon after the last one: no answer. Several in a
    /// row are believed.
    Doubted,
    /// The controller cannot work at the robot's cycle: no answer.
    Unusable(ConfigError),
}

/// One cycle, answered if the robot takes answers, with a robot that says `R` of itself.
#[derive(Clone, Copy, Debug)]
pub struct CycleReport<R> {
    /// Where the conversation stands.
    pub phase: Phase,
    /// Scenario time \[s\]; before 0 while the arm settles. Zero before command state.
    pub t_s: f64,
    /// Counter of the measurement.
    pub counter: u64,
    /// Measurements lost just before this one.
    pub lost: u16,
    /// What the robot says of itself.
    pub robot: R,
    /// Measured position \[rad\] and estimated speed \[rad/s\].
    pub joints: JointState<f64>,
    /// The controller's cycle; none where it did not run.
    pub step: Option<Step<f64>>,
    /// Torque sent \[Nm\], as the robot gets it.
    pub sent: JointVector<f64>,
    /// Joints whose step from the last torque was limited to what the robot bears.
    pub limited: IndexSet,
}
