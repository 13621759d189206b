//! What differs from robot to robot: its datagrams, what it reports and what it wants back.
//! One implementation per robot; the [`Session`](crate::session::Session) asks no other
//! question about which robot it talks to.

use core::fmt::Debug;

use controller_core::Step;
use controller_core::fault::IndexSet;
use controller_core::joint::JointVector;

use crate::audit::RobotModel;

/// The real-time protocol of a robot: one measurement in, at most one answer out.
///
/// A value of it is one end of one conversation, with what it must remember: its own
/// counters, and what it sent.
pub trait Protocol {
    /// What the robot says of itself.
    type Robot: Report;
    /// Why a datagram is no measurement.
    type Error: Copy + Debug + PartialEq;
    /// A datagram that has passed its check.
    type Packet<'a>;
    /// Room for an answer.
    type Answer: AsRef<[u8]>;
    /// How measurements are counted.
    type Clock: Clock;

    /// No answer yet.
    const EMPTY: Self::Answer;

    /// Whether the robot has a stiffness of its own, which takes the arm over at the end
    /// while the torque fades. One that has none takes over at once, by a way of its own:
    /// until then the arm is held by torque.
    const OWN_STIFFNESS: bool;

    /// Lost measurements in a row with which the robot has ended the motion; none where no
    /// number does.
    const LOST_MAX: Option<u16>;

    /// Reads a measurement.
    ///
    /// # Errors
    /// It is none that can be used.
    fn read<'a>(&self, datagram: &'a [u8]) -> Result<Incoming<'a, Self>, Self::Error>;

    /// The robot's model in the posture of a measurement.
    fn model(&self, incoming: &Incoming<'_, Self>) -> RobotModel;

    /// The torque \[Nm\] that acted on the arm until this measurement besides what the robot
    /// adds, with `dead_cycles` cycles between the arrival of a command and its effect.
    /// Called once for every measurement that counts.
    fn acted(&mut self, incoming: &Incoming<'_, Self>, dead_cycles: u8) -> JointVector<f64>;

    /// Writes the answer to a measurement; none where the robot is to get none.
    fn answer(
        &mut self,
        incoming: &Incoming<'_, Self>,
        outgoing: &Outgoing,
        answer: &mut Self::Answer,
    ) -> Option<Sent>;
}

/// What an answer carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sent {
    /// Torque besides what the robot adds \[Nm\], as the robot reads it.
    pub torque: JointVector<f64>,
    /// Joints whose step from the last torque was limited to what the robot bears.
    pub limited: IndexSet,
}

/// What a robot says of itself, in its own words.
pub trait Report: Copy + Debug + PartialEq {
    /// Who moves the arm.
    fn state(&self) -> impl Debug;

    /// How good the link is.
    fn quality(&self) -> impl Debug;
}

/// A measurement as the session needs it.
#[derive(Debug)]
pub struct Incoming<'a, P: Protocol + ?Sized> {
    /// Its counter.
    pub counter: u64,
    /// Another number for every command that has reached the robot; none of a robot that
    /// has none or does not say.
    pub mirrored: Option<u64>,
    /// What the robot says of itself.
    pub robot: P::Robot,
    /// Whether an added torque reaches the joints.
    pub takes_torque: bool,
    /// Measured joint angles \[rad\].
    pub q: JointVector<f64>,
    /// Measured joint speeds \[rad/s\]; none where they have to be estimated.
    pub dq: Option<JointVector<f64>>,
    /// The robot's cycle \[s\], if it states one that can be.
    pub period_s: Option<f64>,
    /// All of it.
    pub packet: P::Packet<'a>,
}

/// What an answer is to do.
#[derive(Clone, Copy, Debug)]
pub struct Outgoing {
    /// The controller's cycle behind it, if it ran.
    pub step: Option<Step<f64>>,
    /// What it orders.
    pub order: Order,
    /// Whether the robot is to let itself be moved, as far as it can be asked.
    pub wish: bool,
}

/// What an answer orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Nothing: the robot moves or holds itself.
    Nothing,
    /// Nothing, in a session that never moves the robot. One that lets itself be moved all the
    /// same must not find a limp arm.
    LookOn,
    /// Torque.
    Torque {
        /// Besides what the robot adds \[Nm\].
        torque: JointVector<f64>,
        /// Where the robot is to hold the arm by itself \[rad\].
        hold: Option<JointVector<f64>>,
        /// Share of its own stiffness with which it is to, 0 to 1.
        share: f64,
    },
}

/// How a measurement stands to those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The first one: any counter.
    First,
    /// Newer than all before it.
    Next {
        /// How many between the newest before it and this one have not come.
        lost: u64,
    },
    /// The newest again.
    Repeated,
    /// Older than one before.
    Old,
}

/// The counters of a robot's measurements.
pub trait Clock: Copy + Debug + Default {
    /// Takes the counter of a measurement.
    fn receive(&mut self, counter: u64) -> Arrival;

    /// Takes any counter next.
    fn reset(&mut self);
}
