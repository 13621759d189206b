//! A cycle of the robot: it reports, takes answers, moves on.

use super::arm::{Robot, Start};
use super::control_box::{Answer, ControlBox, Now, Seen, Surroundings, cycles};
use super::driving::{Driving, Limited};
use super::figures::{Event, Stamp};
use crate::after_fault::Acting;
use crate::arm_points::origins;
use crate::sample::{Stop, UnsafeMotion};
use record::run::Sample;

impl<B: ControlBox> Robot<B> {
    /// The measurement of this cycle. Each call is a datagram of its own with the
    /// next counter; a cycle may send several.
    pub fn measurement(&mut self, out: &mut B::Measurement) {
        let seen = self.look();
        if self.start.is_none() && self.control_box.commands() {
            self.begin(&seen);
        }
        let around = Surroundings {
            seen: &seen,
            model: &self.model,
            applied: self.applied.as_ref(),
            cycle: self.cycle,
            cycle_s: self.cycle_s,
            drives_on: self.drives_on(),
        };
        self.control_box.report(&around, out);
    }

    /// A measurement says for the first time that answers move the arm: scenario time gets
    /// its zero.
    fn begin(&mut self, seen: &Seen) {
        let posture = self.control_box.as_sent(&seen.measured.q);
        let settle = cycles(B::settle_s(&self.setup.options), self.cycle_s);
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
        self.control_box.departed(self.cycle, at_s);
        self.counters.departure(late_s);
    }

    /// Whether this cycle has its answer.
    #[must_use]
    pub fn is_answered(&self) -> bool {
        self.control_box.is_answered()
    }

    /// An answer has arrived, `since_measurement_s` \[s\] after this cycle's
    /// measurement; before it, below 0, can only be one to an earlier measurement. Its
    /// latency is that plus the time since the measurement which it answers: by the wall
    /// clock since it left, else whole cycles. One that is not accepted has no effect but
    /// on counters.
    pub fn command(&mut self, datagram: &[u8], since_measurement_s: f64) -> Answer {
        let q = self.look().measured.q;
        let (cycle, cycle_s) = (self.cycle, self.cycle_s);
        let counters = &mut self.counters;
        (self.control_box).command(datagram, cycle, cycle_s, since_measurement_s, &q, counters)
    }

    /// Ends the cycle: rates the link, moves the arm. What the cycle was, if
    /// scenario time runs. Before the first answer nothing moves and no time passes.
    pub fn advance(&mut self) -> Option<Sample> {
        if !self.control_box.has_begun() || self.ending.is_over() {
            return None;
        }
        let over = self.is_finished();
        let seen = self.look();
        let unsafe_motion = UnsafeMotion::of(&seen.truth, &self.parameters);
        if let Some(lost @ UnsafeMotion::NotFinite { .. }) = unsafe_motion {
            self.ending.at_once(Stop::Unsafe(lost));
            return None;
        }
        let now = Now {
            drives_on: self.drives_on(),
            unsafe_motion,
            q: &seen.measured.q,
            mass_matrix: &seen.mass_matrix,
        };
        let turn = self.control_box.cycle(&now);
        let driving = turn.driving;

        let mut explicit = driving.torque + seen.gravity;
        if self.control_box.adds_coriolis() {
            explicit += self.model.coriolis(&seen.measured);
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
        if let (Some(last), true) = (self.applied, turn.bridging && !by_itself) {
            let by_link = applied - last - turn.ordered_change;
            self.counters.torque_step(by_link.amax());
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
        self.counters.cycle(turn.commanded, t_s.is_some() && !over);
        for text in self.control_box.take_messages() {
            let robot_t_s = self.robot_time_s();
            self.counters.event(Event {
                t_s,
                robot_t_s,
                text,
            });
        }

        // A client may say anything; figures are made from what a torque can be.
        let told = self.control_box.told();
        let limit = &self.torque_limit;
        let residual = (told.residual).zip_map(limit, |r, limit| r.clamp(-limit, limit));
        self.move_on(&driving);
        if over {
            // A client may end its motion later: the run is judged to the end of the scenario.
            return None;
        }

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
            mode: told.mode,
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
