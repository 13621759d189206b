//! What differs from robot to robot on the robot's side: what its controller reports, which
//! answers it takes, and what the motors get. The mirror of the bridge's
//! [`Protocol`](bridge::protocol::Protocol).

use controller_core::arm::ArmParameters;
use controller_core::fault::Mode;
use controller_core::joint::{JointMatrix, JointState, JointVector};

use super::counters::Counters;
use super::driving::Driving;
use super::fci::figures::FciFigures;
use super::figures::Counted;
use super::lwr::figures::LinkFigures;
use super::model::RobotModel;
use crate::sample::UnsafeMotion;
use cell::names::MeasurementKind;

/// What became of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The newest: it acts.
    Accepted,
    /// Seen before, or to a cycle that has its answer: no effect.
    Repeated,
    /// Older than one already accepted: no effect.
    Old,
    /// Not usable: no effect.
    Rejected,
}

/// What the robot sees at the start of a cycle.
#[derive(Clone, Copy)]
pub struct Seen {
    /// The true arm.
    pub truth: JointState<f64>,
    /// The arm by the robot's sensors.
    pub measured: JointState<f64>,
    /// M of the robot's model \[kg m2\].
    pub mass_matrix: JointMatrix<f64>,
    /// g of the robot's model \[Nm\].
    pub gravity: JointVector<f64>,
    /// +J^T F of all contacts \[Nm\].
    pub contact: JointVector<f64>,
    /// Force of a hand \[N\].
    pub hand_force_n: f64,
}

/// What a measurement is made of besides what the control box knows itself.
pub struct Surroundings<'a> {
    /// The arm at the start of the cycle.
    pub seen: &'a Seen,
    /// The robot's own model.
    pub model: &'a RobotModel,
    /// All that the motors gave in the last cycle \[Nm\]; none before the first.
    pub applied: Option<&'a JointVector<f64>>,
    /// Cycles since the first answer.
    pub cycle: u64,
    /// Length of a cycle \[s\].
    pub cycle_s: f64,
    /// Whether the drives have power.
    pub drives_on: bool,
}

/// What a cycle brings besides the answer.
#[derive(Clone, Copy)]
pub struct Now<'a> {
    /// Whether the drives have power.
    pub drives_on: bool,
    /// A motion that the robot itself ends.
    pub unsafe_motion: Option<UnsafeMotion>,
    /// Measured position \[rad\].
    pub q: &'a JointVector<f64>,
    /// M of the robot's model \[kg m2\].
    pub mass_matrix: &'a JointMatrix<f64>,
}

/// What a cycle was.
pub struct Turn {
    /// What the motors get besides the robot's own dynamics.
    pub driving: Driving,
    /// Change of torque since the last cycle that the client ordered \[Nm\].
    pub ordered_change: JointVector<f64>,
    /// Whether one way of driving is turning into another, or the order that acts is not of
    /// this cycle.
    pub bridging: bool,
    /// Whether answers moved the arm when the cycle began.
    pub commanded: bool,
}

/// What the client says of its controller, where its answers can.
#[derive(Clone, Copy, Default)]
pub struct Told {
    /// Residual \[Nm\].
    pub residual: JointVector<f64>,
    /// Mode.
    pub mode: Option<Mode>,
}

/// What a robot's link did in a run, in its own terms.
#[derive(Clone, Debug, PartialEq)]
pub enum Figures {
    /// Of the LWR.
    Fri(LinkFigures),
    /// Of Panda and FR3.
    Fci(FciFigures),
}

/// A robot's controller as the arm and its loops need it. No clock, no plant, no sockets.
pub trait ControlBox: Sized {
    /// How it behaves.
    type Options: Clone;
    /// Room for a measurement.
    type Measurement: AsRef<[u8]>;

    /// No bytes yet.
    const EMPTY: Self::Measurement;

    /// What limits of a scenario call runs over its link.
    const MEASUREMENT: MeasurementKind;

    /// Whether the client ends by itself what it has begun, and the robot goes on until then; else
    /// the robot says that it is over.
    const CLIENT_ENDS: bool;

    /// At rest in `q0` \[rad\]; torques act `dead_cycles` cycles after they have arrived.
    fn new(
        options: &Self::Options,
        cycle_s: f64,
        q0: &JointVector<f64>,
        arm: &ArmParameters,
        dead_cycles: usize,
    ) -> Self;

    /// From the first measurement that says that answers move the arm to scenario time 0 \[s\].
    fn settle_s(options: &Self::Options) -> f64;

    /// Scenario time during which the drives are off \[s\].
    fn drives_off_s(options: &Self::Options) -> Option<[f64; 2]>;

    /// Whether the robot adds C dq to the torque of answers, besides gravity.
    fn adds_coriolis(&self) -> bool;

    /// Joint angles \[rad\] as a client reads them.
    fn as_sent(&self, q: &JointVector<f64>) -> JointVector<f64>;

    /// The measurement of a cycle; each call is a datagram of its own with the next counter.
    fn report(&mut self, around: &Surroundings<'_>, out: &mut Self::Measurement);

    /// By the wall clock: the measurement of `cycle` left at `at_s` \[s\].
    fn departed(&mut self, cycle: u64, at_s: f64);

    /// An answer has arrived in `cycle` (of `cycle_s` \[s\]), `since_s` \[s\] after its
    /// measurement, with the arm at `q` \[rad\].
    fn command(
        &mut self,
        datagram: &[u8],
        cycle: u64,
        cycle_s: f64,
        since_s: f64,
        q: &JointVector<f64>,
        counters: &mut Counters,
    ) -> Answer;

    /// Whether an answer was ever accepted.
    fn has_begun(&self) -> bool;

    /// Whether a client that is there answers every measurement.
    fn is_driven(&self) -> bool;

    /// Whether the present cycle has its answer.
    fn is_answered(&self) -> bool;

    /// Whether `answer` is one to `measurement`.
    fn answers(measurement: &[u8], answer: &[u8]) -> bool;

    /// Ends a cycle.
    fn cycle(&mut self, now: &Now<'_>) -> Turn;

    /// Whether answers move the arm.
    fn commands(&self) -> bool;

    /// Whether they never did.
    fn has_never_commanded(&self) -> bool;

    /// Lets answers move the arm no more; the last cycle's torque stays the last.
    fn leave(&mut self);

    /// What the client says of its controller.
    fn told(&self) -> Told;

    /// What there is to say since the last call.
    fn take_messages(&mut self) -> Vec<String>;

    /// How many datagrams were refused, if any were, and why the last one.
    fn refused(&self) -> Option<(u64, String)>;

    /// The link, in words.
    fn link(&self) -> String;

    /// Why a run that nothing stopped is a failure all the same, if it is.
    fn failure(&self) -> Option<String>;

    /// The figures of the link, with those that the arm's side has counted.
    fn figures(&self, counted: Counted) -> Figures;
}

/// Whole cycles in a time, at least one.
pub(crate) fn cycles(time_s: f64, cycle_s: f64) -> u64 {
    (time_s / cycle_s).round().max(1.0) as u64
}
