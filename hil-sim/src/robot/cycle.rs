//! A cycle of the robot: it reports, takes answers, moves on.

use controller_core::joint::JointVector;
use fri::{InterfaceState, Measurement};

use super::arm::{Robot, Seen, Start};
use super::driving::{Driving, Limited};
use super::figures::{Event, Stamp};
use super::inbox::{self, Answer};
use super::krc::Now;
use super::options::{RobotAdds, cycles};
use super::order;
use crate::after_fault::Acting;
use crate::arm_points::origins;
use crate::sample::{Stop, UnsafeMotion};
use record::run::Sample;

impl Robot {
    /// The measurement of this cycle. Each call is a datagram of its own with the
    /// next counter; a cycle may send several.
    pub fn measurement(&mut self, out: &mut [u8; Measurement::LEN]) {
        let seen = self.look();
        if self.start.is_none() && self.krc.state() == InterfaceState::Command {
            self.begin(&seen);
        }
        let header = self.inbox.next_header(self.cycle);
        self.report(&seen, header).emit(out);
    }

    /// Command state is reported for the first time: scenario time gets its zero.
    fn begin(&mut self, seen: &Seen) {
        let posture = seen.measured.q.map(|angle| f64::from(angle as f32));
        let settle = cycles(self.setup.options.settle_s, self.cycle_s);
        self.start = Some(Start {
            cycle: self.cycle + settle,
            posture,
            origins: origins(&self.setup.scenario, &posture),
        });
    }

    /// The wall clock decides from now on; `stamp` says when answers arrive.
    pub fn keep_time(&mut self, stamp: Stamp) {
        self.counters.keep_time(stamp, self.cycle_s);
    }

    /// By the wall clock: this cycle's measurement left at `at_s` \[s\], `late_s` \[s\]
    /// after its time.
    pub fn departed(&mut self, at_s: f64, late_s: f64) {
        self.inbox.departed(self.cycle, at_s);
        self.counters.departure(late_s);
    }

    /// Whether this cycle has its answer.
    #[must_use]
    pub fn is_answered(&self) -> bool {
        self.inbox.is_answered()
    }

    /// An answer has arrived, `since_measurement_s` \[s\] after this cycle's
    /// measurement; before it, below 0, can only be one to an earlier measurement. Its
    /// latency is that plus the time since the measurement which it answers: by the wall
    /// clock since it left, else whole cycles. One that is not accepted has no effect but
    /// on counters.
    pub fn command(&mut self, datagram: &[u8], since_measurement_s: f64) -> Answer {
        let q = self.look().measured.q;
        let order = match order::read(datagram) {
            Ok(order) => order,
            Err(error) => {
                inbox::count_error(&mut self.counters.link.rejected, &error);
                self.unread = Some(error);
                return Answer::Rejected;
            }
        };
        let place = match self.inbox.place(&order, &mut self.counters.link) {
            Ok(place) => place,
            Err(answer) => {
                self.unread = None;
                return answer;
            }
        };
        if let Err(refusal) = self.krc.accept(&order, &q) {
            inbox::count_refusal(&mut self.counters.link.rejected, refusal);
            return Answer::Rejected;
        }
        let behind = self.cycle - place;
        let between_s = self.inbox.between(place, self.cycle);
        let between_s = between_s.unwrap_or(behind as f64 * self.cycle_s);
        // Never before its measurement, whatever two clocks say.
        let latency_s = (between_s + since_measurement_s).max(0.0);
        let in_time = behind == 0 && latency_s <= self.cycle_s;
        self.inbox.accepted(place, in_time.then_some(latency_s));
        self.counters.answer(latency_s, in_time);
        Answer::Accepted
    }

    /// Ends the cycle: rates the link, moves the arm. What the cycle was, if
    /// scenario time runs. Before the first answer nothing moves and no time passes.
    pub fn advance(&mut self) -> Option<Sample> {
        if !self.inbox.has_begun() || self.ending.is_over() {
            return None;
        }
        let seen = self.look();
        let unsafe_motion = UnsafeMotion::of(&seen.truth, &self.parameters);
        if let Some(lost @ UnsafeMotion::NotFinite { .. }) = unsafe_motion {
            self.ending.at_once(Stop::Unsafe(lost));
            return None;
        }
        let state = self.krc.state();
        self.rating.add(self.inbox.end_of_cycle());
        let now = Now {
            rating: &self.rating,
            drives_on: self.drives_on(),
            unsafe_motion,
            q: &seen.measured.q,
            mass_matrix: &seen.mass_matrix,
        };
        let bridging = self.krc.is_bridging();
        let driving = self.krc.cycle(&now, &mut self.pipe);
        let bridging = bridging || self.krc.is_bridging() || self.krc.state() != state;
        if self.rating.broken() {
            // The client may begin anew, with any counter.
            self.inbox.forget_counter();
        }

        let mut explicit = driving.torque + seen.gravity;
        if self.setup.options.adds == RobotAdds::GravityCoriolis {
            explicit += self.model.coriolis(&seen.measured, &seen.mass_matrix);
        }
        let whole = Driving {
            torque: explicit,
            impedance: driving.impedance,
        };
        let motors = self.plant.motors().unwrap_or(self.plant.state());
        let Limited {
            driving,
            torque: applied,
            saturated,
        } = whole.limited(motors, &self.torque_limit);
        let by_itself = unsafe_motion.is_some() || self.ending.has_begun();
        if let (Some(last), true) = (self.applied, bridging && !by_itself) {
            let by_link = applied - last - self.krc.ordered_change();
            let largest = &mut self.counters.link.largest_torque_step_nm;
            *largest = largest.max(by_link.amax());
        }
        self.applied = Some(applied);
        let acting = Acting {
            torque: applied,
            fault: self.client.and_then(|status| status.fault),
            mode: self.client.map(|status| status.mode),
        };
        self.ending
            .cycle(self.clock_s(), &seen.truth, unsafe_motion, &acting);
        let t_s = self.time_s();
        self.counters
            .cycle(state, self.rating.quality(), t_s.is_some());
        for text in self.krc.take_messages() {
            let robot_t_s = self.robot_time_s();
            self.counters.event(Event {
                t_s,
                robot_t_s,
                text,
            });
        }

        // User data may hold anything; figures are made from what a torque can be.
        let residual = self.krc.order().map_or(JointVector::zeros(), |order| {
            let limit = &self.torque_limit;
            order
                .residual
                .zip_map(limit, |r, limit| r.clamp(-limit, limit))
        });
        self.move_on(&driving);

        let (t_s, start) = (t_s?, self.start.as_ref()?);
        let scenario = &self.setup.scenario;
        let reference = scenario.reference(&start.origins, &start.posture, t_s);
        let levels = self
            .probes
            .levels(self.plant.model(), &seen.truth, &reference);
        let sample = Sample {
            t_s,
            state: seen.truth,
            torque: applied,
            residual,
            mode: self.krc.order().and_then(|order| order.mode),
            saturated,
            rank: false,
            tau_ext: -seen.contact,
            hand_force_n: seen.hand_force_n,
            conditioning: Vec::new(),
            limits: None,
            levels,
        };
        if !self.ending.has_begun() {
            self.metrics.add(&sample);
        }
        Some(sample)
    }

    /// Moves the arm to the next cycle.
    fn move_on(&mut self, driving: &Driving) {
        let (robot_t, scenario_t) = (self.robot_time_s(), self.contact_time_s());
        let (contacts, typed) = (&self.contacts, &self.typed);
        self.plant.advance_with(
            scenario_t,
            &driving.torque,
            &driving.impedance,
            |t, model, state| {
                let (scripted, _) = contacts.joint_torque(t, model, state);
                let at = robot_t + (t - scenario_t);
                typed
                    .iter()
                    .fold(scripted, |sum, push| sum + push.torque(at, model, state))
            },
        );
        self.typed.retain(|typed| typed.push.to_s > robot_t);
        self.cycle += 1;
        self.seen = None;
    }
}
