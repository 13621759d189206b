//! The control box of the LWR, by KUKA's Fast Research Interface.

pub mod figures;
mod inbox;
mod krc;
mod options;
mod order;
mod rating;
mod report;

use controller_core::arm::ArmParameters;
use controller_core::joint::JointVector;
use fri::{InterfaceState, Measurement, Quality};

use super::control_box::{Answer, ControlBox, Figures, Now, Surroundings, Told, Turn};
use super::counters::Counters;
use super::driving::Pipe;
use super::figures::Counted;
use cell::names::MeasurementKind;
use inbox::Inbox;

pub use figures::{LinkFigures, QualityCycles, Rejected};
pub use krc::Krc;
pub use options::{Krl, POSITION_STIFFNESS, RatingOptions, RobotAdds, RobotOptions, scheme_named};
pub use order::Order;
pub use rating::{Rating, Statistics};

/// The robot controller, its end of the link, and how good the link is.
pub struct LwrBox {
    krc: Krc,
    rating: Rating,
    inbox: Inbox,
    /// The way of added torque to the motors.
    pipe: Pipe,
    adds: RobotAdds,
    /// What is reported as it is counted.
    link: LinkFigures,
    /// Why the last datagram that is no answer is none.
    unread: Option<fri::Error>,
}

impl LwrBox {
    /// State of the link.
    #[must_use]
    pub fn state(&self) -> InterfaceState {
        self.krc.state()
    }

    /// How good the link is.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.rating.quality()
    }
}

impl ControlBox for LwrBox {
    type Options = RobotOptions;
    type Measurement = [u8; Measurement::LEN];

    const EMPTY: [u8; Measurement::LEN] = [0; Measurement::LEN];
    const MEASUREMENT: MeasurementKind = MeasurementKind::Fri;
    const CLIENT_ENDS: bool = false;

    fn new(
        options: &RobotOptions,
        cycle_s: f64,
        q0: &JointVector<f64>,
        arm: &ArmParameters,
        dead_cycles: usize,
    ) -> Self {
        Self {
            krc: Krc::new(*options, cycle_s, q0, arm),
            rating: Rating::new(options.rating, cycle_s),
            inbox: Inbox::new(),
            pipe: Pipe::new(dead_cycles),
            adds: options.adds,
            link: LinkFigures::default(),
            unread: None,
        }
    }

    fn settle_s(options: &RobotOptions) -> f64 {
        options.settle_s
    }

    fn drives_off_s(options: &RobotOptions) -> Option<[f64; 2]> {
        options.drives_off_s
    }

    fn adds_coriolis(&self) -> bool {
        self.adds == RobotAdds::GravityCoriolis
    }

    fn as_sent(&self, q: &JointVector<f64>) -> JointVector<f64> {
        q.map(|angle| f64::from(angle as f32))
    }

    fn report(&mut self, around: &Surroundings<'_>, out: &mut [u8; Measurement::LEN]) {
        let header = self.inbox.next_header(around.cycle);
        report::measurement(&self.krc, &self.rating, around, header).emit(out);
    }

    fn departed(&mut self, cycle: u64, at_s: f64) {
        self.inbox.departed(cycle, at_s);
    }

    fn command(
        &mut self,
        datagram: &[u8],
        cycle: u64,
        cycle_s: f64,
        since_s: f64,
        q: &JointVector<f64>,
        counters: &mut Counters,
    ) -> Answer {
        let order = match order::read(datagram) {
            Ok(order) => order,
            Err(error) => {
                inbox::count_error(&mut self.link.rejected, &error);
                self.unread = Some(error);
                return Answer::Rejected;
            }
        };
        let place = match self.inbox.place(&order, &mut self.link) {
            Ok(place) => place,
            Err(answer) => {
                self.unread = None;
                return answer;
            }
        };
        if let Err(refusal) = self.krc.accept(&order, q) {
            inbox::count_refusal(&mut self.link.rejected, refusal);
            return Answer::Rejected;
        }
        let behind = cycle - place;
        let between_s = self.inbox.between(place, cycle);
        let between_s = between_s.unwrap_or(behind as f64 * cycle_s);
        // Never before its measurement, whatever two clocks say.
        let latency_s = (between_s + since_s).max(0.0);
        let in_time = behind == 0 && latency_s <= cycle_s;
        self.inbox.accepted(place, in_time.then_some(latency_s));
        counters.answer(latency_s, in_time);
        Answer::Accepted
    }

    fn has_begun(&self) -> bool {
        self.inbox.has_begun()
    }

    fn is_driven(&self) -> bool {
        self.has_begun()
    }

    fn is_answered(&self) -> bool {
        self.inbox.is_answered()
    }

    fn answers(measurement: &[u8], answer: &[u8]) -> bool {
        answer.get(2..4) == measurement.get(..2)
    }

    fn cycle(&mut self, now: &Now<'_>) -> Turn {
        let state = self.krc.state();
        self.rating.add(self.inbox.end_of_cycle());
        let bridging = self.krc.is_bridging();
        let driving = self.krc.cycle(now, &self.rating, &mut self.pipe);
        let bridging = bridging || self.krc.is_bridging() || self.krc.state() != state;
        if self.rating.broken() {
            // The client may begin anew, with any counter.
            self.inbox.forget_counter();
        }
        let levels = &mut self.link.quality_cycles;
        *match self.rating.quality() {
            Quality::Bad => &mut levels.bad,
            Quality::Ok => &mut levels.ok,
            Quality::Perfect => &mut levels.perfect,
            _ => &mut levels.unacceptable,
        } += 1;
        Turn {
            driving,
            ordered_change: *self.krc.ordered_change(),
            bridging,
            commanded: state == InterfaceState::Command,
        }
    }

    fn commands(&self) -> bool {
        self.krc.state() == InterfaceState::Command
    }

    fn has_never_commanded(&self) -> bool {
        self.krc.entries() == 0
    }

    fn leave(&mut self) {
        self.krc.leave();
    }

    fn told(&self) -> Told {
        self.krc.order().map_or_else(Told::default, |order| Told {
            residual: order.residual,
            mode: order.mode,
        })
    }

    fn take_messages(&mut self) -> Vec<String> {
        self.krc.take_messages()
    }

    fn refused(&self) -> Option<(u64, String)> {
        let count = self.link.rejected.total();
        let why = match &self.unread {
            Some(error) => error.to_string(),
            None => "reflects no measurement that was sent".to_string(),
        };
        (count > 0).then_some((count, why))
    }

    fn link(&self) -> String {
        format!("link quality {:?}", self.quality()).to_lowercase()
    }

    fn failure(&self) -> Option<String> {
        None
    }

    fn figures(&self, counted: Counted) -> Figures {
        Figures::Fri(LinkFigures {
            state_cycles: counted.state_cycles,
            command_share: counted.command_share,
            answers: counted.answers,
            missed: self.rating.missed(),
            late: counted.late,
            latency_ms: counted.latency_ms,
            jitter_ms: counted.jitter_ms,
            fallbacks: self.krc.fallbacks(),
            recoveries: self.krc.entries().saturating_sub(1),
            largest_torque_step_nm: counted.largest_torque_step_nm,
            own_lateness: counted.own_lateness,
            events: counted.events,
            ..self.link.clone()
        })
    }
}
