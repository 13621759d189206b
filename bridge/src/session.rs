//! The conversation with the robot: who may move it, when, and with what.
//!
//! ```text
//!            first datagram            state 2, drives on
//!  Waiting ------------------> Ready ---------------------> Starting
//!                               ^                              | time 0
//!          state not 2          |                              v
//!  (any) -----------------------+      link bad  +--------- Moving
//!                                                v             ^
//!  end of the motion, stop(), fault           Holding ---------+ link good
//!        v
//!  Stopping: comes to rest, then the robot's own stiffness holds it
//! ```
//!
//! Which robot it is, and what it does and reports, is an affair of its
//! [`Protocol`]. In every state a fresh datagram gets one answer if
//! the robot takes any. Only in `Starting`, `Moving`, `Holding` and `Stopping` does an answer
//! carry torque; where the robot has no stiffness of its own, also behind it, until the robot
//! has taken over.

mod config;
mod report;

use controller_core::arm::ArmParameters;
use controller_core::cycle::velocity::{CORNER_HZ, VelocityEstimator};
use controller_core::fault::{IndexSet, Mode};
use controller_core::joint::{JointState, JointVector, zeros};
use controller_core::ranges::{HOLD_S, INTERVAL_FACTORS};
use controller_core::real::Real;
use controller_core::task::trajectory::quintic;
use controller_core::{ConfigError, Controller, Fault, Measurement, Reference, State, Step};

use crate::audit::Audit;
use crate::belief::Belief;
use crate::link_monitor::LinkMonitor;
use crate::protocol::{Incoming, Order, Outgoing, Protocol, Sent};
use crate::source::ReferenceSource;

pub use self::config::{RobotAdds, SessionConfig};
pub use self::report::{CycleReport, Outcome, Phase, StopReason};

/// The session: our end of the robot's protocol, configuration, controller, and everything
/// that changes.
#[derive(Clone, Debug)]
pub struct Session<P: Protocol> {
    protocol: P,
    config: SessionConfig,
    controller: Option<Controller<f64>>,
    state: State<f64>,
    velocity: VelocityEstimator<f64>,
    /// q_d of the last cycle with one \[rad\].
    posture: JointVector<f64>,
    link: LinkMonitor<P::Clock>,
    belief: Belief,
    phase: Phase,
    stop: Option<StopReason>,
    /// Whether it stops without braking first.
    halted: bool,
    audit: Audit,
    /// Cycles since the first datagram, lost ones included.
    cycle: u64,
    /// The cycle in which command state was first seen.
    first_command: Option<u64>,
    /// Cycles since command state was last entered.
    in_command: u64,
    /// Cycles since stopping began.
    stopping: u64,
    /// Those of them in which the controller still brakes an arm with a fault.
    braked: u64,
    /// Where the robot's own stiffness holds the arm, once it does \[rad\].
    hold: Option<JointVector<f64>>,
    /// What the robot added in the last cycle \[Nm\].
    robot_part: JointVector<f64>,
    cycle_s: f64,
    last: Option<CycleReport<P::Robot>>,
}

impl<P: Protocol> Session<P> {
    /// Waiting for the first datagram.
    #[must_use]
    pub fn new(protocol: P, config: SessionConfig) -> Self {
        Self {
            protocol,
            config,
            controller: None,
            state: State::new(),
            velocity: VelocityEstimator::new(CORNER_HZ),
            posture: zeros(),
            link: LinkMonitor::new(),
            belief: Belief::default(),
            phase: Phase::Waiting,
            stop: None,
            halted: false,
            audit: Audit::default(),
            cycle: 0,
            first_command: None,
            in_command: 0,
            stopping: 0,
            braked: 0,
            hold: None,
            robot_part: zeros(),
            cycle_s: 0.0,
            last: None,
        }
    }

    /// Our end of the robot's protocol.
    #[must_use]
    pub fn protocol(&self) -> &P {
        &self.protocol
    }

    /// The same, for what the protocol is to be told.
    pub fn protocol_mut(&mut self) -> &mut P {
        &mut self.protocol
    }

    /// The arm that the controller believes in.
    #[must_use]
    pub fn arm(&self) -> &ArmParameters {
        &self.config.arm
    }

    /// Where the conversation stands.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Why it stops or has stopped, if it does.
    #[must_use]
    pub fn stop_reason(&self) -> Option<StopReason> {
        self.stop
    }

    /// The controller's latched fault.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.state.fault()
    }

    /// The robot's model against the controller's, so far.
    #[must_use]
    pub fn audit(&self) -> &Audit {
        &self.audit
    }

    /// The last answered cycle.
    #[must_use]
    pub fn last(&self) -> Option<&CycleReport<P::Robot>> {
        self.last.as_ref()
    }

    /// The controller, once the robot's cycle is known.
    #[must_use]
    pub fn controller(&self) -> Option<&Controller<f64>> {
        self.controller.as_ref()
    }

    /// The robot's cycle \[s\]; 0 before the first datagram.
    #[must_use]
    pub fn cycle_s(&self) -> f64 {
        self.cycle_s
    }

    /// The controller's state.
    #[must_use]
    pub fn state(&self) -> &State<f64> {
        &self.state
    }

    /// Brings the arm to rest and ends the session.
    pub fn stop(&mut self) {
        self.stop_for(StopReason::Asked);
    }

    /// Ends the session without waiting for the arm to come to rest: the robot's own
    /// stiffness takes over at once. For an emergency stop.
    pub fn halt(&mut self) {
        self.stop_for(StopReason::Asked);
        self.halted = true;
    }

    /// For a robot that was silent so long that it may have been restarted: any
    /// counter is accepted next. The motion is over, if there was one.
    pub fn silent(&mut self) {
        self.link.resync();
        self.leave_command();
        if self.first_command.is_some() {
            self.phase = Phase::Finished;
        }
    }

    /// Takes a datagram, and writes the answer if it gets one.
    pub fn receive(
        &mut self,
        datagram: &[u8],
        source: &mut impl ReferenceSource,
        answer: &mut P::Answer,
    ) -> Outcome<P::Error> {
        let incoming = match self.protocol.read(datagram) {
            Ok(incoming) => incoming,
            Err(error) => return Outcome::Rejected(error),
        };
        let before = self.link.clone();
        let Some(lost) = self.link.arrival(incoming.counter, incoming.mirrored) else {
            return Outcome::Stale;
        };
        if self.doubts(&incoming, lost) {
            // As if it had not come.
            self.link = before;
            return Outcome::Doubted;
        }
        if let Err(error) = self.take_cycle(&incoming) {
            self.link = before;
            return Outcome::Unusable(error);
        }
        self.cycle += 1 + u64::from(lost);

        let interval_s = self.cycle_s * f64::from(1 + u32::from(lost));
        let joints = match incoming.dq {
            Some(dq) => JointState { q: incoming.q, dq },
            None => self.velocity.update(&incoming.q, interval_s),
        };
        let dead_cycles = self.config.controller.dead_cycles;
        let acted = self.protocol.acted(&incoming, dead_cycles);
        self.advance_phase(&incoming, lost, source);
        self.watch_model(&incoming);

        let holding = self.hold.is_some() && incoming.takes_torque;
        let (step, order) = if self.phase.is_in_command() || holding || self.config.dry {
            self.state.set_applied_torque(&(acted + self.robot_part));
            self.control(&incoming, joints, interval_s, source)
        } else {
            (None, Order::Nothing)
        };
        let wish = self.wish();
        let outgoing = Outgoing { step, order, wish };
        let sent = self.protocol.answer(&incoming, &outgoing, answer);
        let none = Sent {
            torque: zeros(),
            limited: IndexSet::NONE,
        };
        let Sent { torque, limited } = sent.unwrap_or(none);
        self.last = Some(CycleReport {
            phase: self.phase,
            t_s: self.time_s(),
            counter: incoming.counter,
            lost,
            robot: incoming.robot,
            joints,
            step,
            sent: torque,
            limited,
        });
        match sent {
            Some(_) => Outcome::Answered,
            None => Outcome::Heard,
        }
    }

    /// Whether the arm cannot be where this measurement says, or as fast, lost ones before it
    /// or not.
    fn doubts(&mut self, incoming: &Incoming<'_, P>, lost: u16) -> bool {
        let interval_s = self.cycle_s * (1.0 + f64::from(lost));
        self.last.is_some_and(|last| {
            let way = incoming.q - last.joints.q;
            let (most, arm) = (self.config.doubted_max, &self.config.arm);
            self.belief
                .doubts(most, arm, &way, incoming.dq.as_ref(), interval_s)
        })
    }

    /// Makes the controller for the robot's cycle, again if that changes before
    /// command state.
    fn take_cycle(&mut self, incoming: &Incoming<'_, P>) -> Result<(), ConfigError> {
        let period = incoming.period_s.unwrap_or(self.config.controller.cycle_s);
        let known = self.controller.is_some() && period == self.cycle_s;
        if known || self.first_command.is_some() {
            return Ok(());
        }
        let before = core::mem::replace(&mut self.config.controller.cycle_s, period);
        let controller = match (self.config.law)(&self.config.arm, &self.config.controller) {
            Ok(controller) => controller,
            Err(error) => {
                // A measurement without a cycle is not to have that one.
                self.config.controller.cycle_s = before;
                return Err(error);
            }
        };
        self.cycle_s = period;
        self.posture = incoming.q;
        self.controller = Some(controller);
        Ok(())
    }

    /// Scenario time of this cycle \[s\].
    fn time_s(&self) -> f64 {
        self.first_command
            .map_or(0.0, |first| self.cycles_since(first) as f64 * self.cycle_s)
    }

    /// Cycles since time 0, negative before.
    fn cycles_since(&self, first_command: u64) -> i64 {
        let settle = cycles(self.config.settle_s, self.cycle_s);
        (self.cycle - first_command) as i64 - settle
    }

    fn advance_phase(
        &mut self,
        incoming: &Incoming<'_, P>,
        lost: u16,
        source: &mut impl ReferenceSource,
    ) {
        let all = cycles(self.config.duration_s, self.cycle_s);
        let over = match self.first_command {
            None => self.config.dry && self.cycle as i64 > all,
            Some(first) => self.cycles_since(first) >= all,
        };
        if !incoming.takes_torque || self.config.dry {
            let carried = self.config.dry || self.phase.is_in_command();
            self.leave_command();
            if over {
                self.stop_for(self.ending(carried, lost));
            }
            self.phase = match self.phase {
                Phase::Finished | Phase::Stopping => Phase::Finished,
                _ if self.stop.is_some() => Phase::Finished,
                _ => Phase::Ready,
            };
            return;
        }
        if self.phase == Phase::Finished {
            return;
        }
        if self.stop.is_some() && !self.phase.is_in_command() {
            self.phase = Phase::Finished;
            return;
        }
        if !self.phase.is_in_command() {
            self.enter_command(incoming, source);
        }
        self.in_command += 1 + u64::from(lost);
        let Some(first) = self.first_command else {
            return;
        };
        let now = self.cycles_since(first);
        if over {
            self.stop_for(self.ending(true, lost));
        }
        if self.state.fault().is_some() {
            self.stop_for(StopReason::Fault);
        }
        if P::LOST_MAX.is_some_and(|most| lost >= most) {
            self.stop_for(StopReason::Link);
        }
        let (limit, resume) = (self.config.hold_after, self.config.resume_after);
        let bad = self.link.judge(lost, limit, resume);
        self.phase = match self.phase {
            Phase::Stopping => {
                self.stopping += 1 + u64::from(lost);
                if self.brakes() {
                    self.braked = self.stopping;
                }
                let rest_s = HOLD_S + HANDOVER_S;
                if self.stopping as i64 > cycles(rest_s, self.cycle_s) {
                    Phase::Finished
                } else {
                    Phase::Stopping
                }
            }
            _ if bad => {
                if self.link.bad_cycles as f64 * self.cycle_s > self.config.stop_after_s {
                    self.stop_for(StopReason::Link);
                    Phase::Stopping
                } else {
                    Phase::Holding
                }
            }
            _ if now < 0 => Phase::Starting,
            _ => Phase::Moving,
        };
    }

    /// What the end of the motion's time is: done only if the arm was `carried` to it on
    /// a link that was sound.
    fn ending(&self, carried: bool, lost: u16) -> StopReason {
        if carried
            && self
                .link
                .was_sound(lost, self.config.hold_after, self.cycle_s)
        {
            StopReason::Done
        } else {
            StopReason::Link
        }
    }

    /// Command state begins: rest here, torque from zero.
    fn enter_command(&mut self, incoming: &Incoming<'_, P>, source: &mut impl ReferenceSource) {
        let Some(controller) = &self.controller else {
            return;
        };
        let rest = controller.rest_reference_of(&self.state, &incoming.q);
        self.posture = incoming.q;
        self.state.reset();
        self.in_command = 0;
        self.link.clear();
        self.phase = Phase::Starting;
        if self.first_command.is_none() {
            self.first_command = Some(self.cycle);
            source.start(&rest);
        }
    }

    fn leave_command(&mut self) {
        if self.phase.is_in_command() {
            self.in_command = 0;
            self.hold = None;
        }
    }

    fn stop_for(&mut self, reason: StopReason) {
        if self.stop.is_none() {
            self.stop = Some(reason);
            self.stopping = 0;
            self.braked = 0;
            if self.phase.is_in_command() {
                self.phase = Phase::Stopping;
            }
        }
    }

    /// Compares models at first, then now and then.
    fn watch_model(&mut self, incoming: &Incoming<'_, P>) {
        if let Some(controller) = &self.controller
            && self.cycle % AUDIT_EVERY == 1
        {
            let robot = self.protocol.model(incoming);
            self.audit
                .compare(controller, &self.config.arm, &self.config.flange, &robot);
        }
    }

    /// The control cycle.
    fn control(
        &mut self,
        incoming: &Incoming<'_, P>,
        joints: JointState<f64>,
        interval_s: f64,
        source: &mut impl ReferenceSource,
    ) -> (Option<Step<f64>>, Order) {
        let Some(controller) = &self.controller else {
            return (None, Order::Nothing);
        };
        let now = self.first_command.map(|first| self.cycles_since(first));
        let t_s = now.map(|now| now as f64 * self.cycle_s);
        let wanted = match (self.phase, t_s) {
            (Phase::Moving, Some(t_s)) => {
                source.change(t_s, &mut |change| controller.begin(&mut self.state, change));
                source.sample(t_s)
            }
            _ => None,
        };
        if self.phase == Phase::Holding && self.link.is_broken() {
            // The arm is where it drifted to: hold it there.
            self.state.join_from_the_arm();
        }
        let reference =
            wanted.unwrap_or_else(|| Reference::hold(controller.level_count(), self.posture));
        self.posture = reference.posture;

        // A gap longer than the core believes in.
        let [_, longest] = INTERVAL_FACTORS;
        let gap = interval_s > longest * self.cycle_s;
        if gap {
            self.state.resume_after_gap();
        }
        let measurement = Measurement {
            q: joints.q,
            dq: joints.dq,
            interval_s: if gap { self.cycle_s } else { interval_s },
        };
        let step = controller.step(&mut self.state, &measurement, &reference);
        self.robot_part = match self.config.robot_adds {
            RobotAdds::Gravity => step.gravity,
            RobotAdds::GravityAndCoriolis => step.gravity + step.coriolis,
        };
        if self.config.dry {
            return (Some(step), Order::LookOn);
        }
        let torque = (step.torque - self.robot_part) * self.ramp();
        let share = self.stiffness_share();
        if share > 0.0 && self.hold.is_none() {
            self.hold = Some(incoming.q);
        }
        let order = Order::Torque {
            torque,
            hold: self.hold,
            share,
        };
        (Some(step), order)
    }

    /// Share of the torque that is sent, 0 to 1.
    fn ramp(&self) -> f64 {
        let since = self.in_command.saturating_sub(1) as f64 * self.cycle_s;
        let [share, ..] = quintic(since / self.config.ramp_s);
        match P::OWN_STIFFNESS {
            true => share * (1.0 - self.stiffness_share()),
            false => share,
        }
    }

    /// Whether the controller brakes an arm with a fault, and has not done so for as long
    /// as a reference takes to come to rest.
    fn brakes(&self) -> bool {
        let step = self.last.and_then(|last| last.step);
        let braking = step.is_some_and(|step| step.status.mode == Mode::Braking);
        let longest = cycles(HOLD_S, self.cycle_s);
        braking && self.stopping as i64 <= longest
    }

    /// Share of the robot's own stiffness that holds the arm, 0 to 1: after the
    /// reference has come to rest, or an arm with a fault has; at once where nothing
    /// brakes it.
    fn stiffness_share(&self) -> f64 {
        match self.phase {
            Phase::Stopping => {}
            Phase::Finished => return 1.0,
            _ => return 0.0,
        }
        let brake_s = if self.halted {
            0.0
        } else if self.state.fault().is_some() {
            self.braked as f64 * self.cycle_s
        } else {
            HOLD_S
        };
        let since = self.stopping as f64 * self.cycle_s - brake_s;
        let [share, ..] = quintic(since / HANDOVER_S);
        share
    }

    /// What the robot program is asked for.
    fn wish(&self) -> bool {
        self.stop.is_none() && !self.config.dry
    }
}

/// Between a reference at rest and the robot's own stiffness \[s\].
const HANDOVER_S: f64 = 0.3;

/// Every how many cycles the models are compared.
const AUDIT_EVERY: u64 = 50;

/// A time \[s\] as a whole number of cycles, rounded.
fn cycles(time_s: f64, cycle_s: f64) -> i64 {
    (time_s / cycle_s + 0.5).floor_small() as i64
}
