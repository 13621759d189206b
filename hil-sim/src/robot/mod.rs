//! The robot's side of the LWR FRI: an arm, its controller, and what they report.
//!
//! A [`Robot`] is driven cycle by cycle and passes byte arrays, so that a
//! datagram socket and a client in the same process see exactly the same:
//!
//! ```text
//! loop {
//!     robot.measurement(&mut msr);       // cycle n, at t_n
//!     // ... the client's answers, in the order in which they arrive:
//!     robot.command(&cmd, since_t_n);
//!     robot.advance();                   // the newest command acts from t_n to t_n+1
//! }
//! ```
//!
//! An answer to the measurement of cycle n that arrives before the next one acts
//! in cycle n: there is no dead time. Dead cycles of the plant's options delay
//! the added torque; the robot's own gravity, springs and dampers act at once.
//!
//! Scenario time 0 is `settle_s` (1 s) after the cycle whose measurement first said
//! command state. References and q_d start from the position of that measurement,
//! as the binary32 numbers that the client saw. From time 0 on contacts act and
//! figures count; losing command state does not stop that clock.

mod counters;
mod driving;
mod figures;
mod inbox;
mod krc;
mod model;
mod options;
mod order;
mod rating;
mod report;

use controller_core::Target;
use controller_core::joint::{JointMatrix, JointState, JointVector};

pub use figures::{Event, LatencyFigures, LinkFigures, QualityCycles, Rejected, StateCycles};
pub use krc::{Krc, State};
pub use model::RobotModel;
pub use options::{Krl, RatingOptions, RobotAdds, RobotOptions, Scheme};
pub use order::Order;
pub use rating::{Quality, Rating, Statistics};

use crate::arm_points::origins;
use crate::contact::{Contacts, push_torque};
use crate::metrics::{FaultCounts, Metrics};
use crate::plant::{DeadTime, Plant, PlantOptions};
use crate::sample::{LevelProbes, Stop, UnsafeMotion};
use crate::summary::{self, Summary, Verdict};
use cell::names::{Named, PlantKind};
use cell::scenario::{PointSpec, Push, Scenario};
use counters::Counters;
use inbox::Inbox;
use krc::{Added, Now};
use record::run::Sample;

/// Bytes of a measurement datagram.
pub const MEASUREMENT_BYTES: usize = 916;

/// Which arm, which experiment, and how the robot behaves.
#[derive(Clone, Debug)]
pub struct RobotSetup {
    /// What is to be done: start, contacts, what is judged.
    pub scenario: Scenario,
    /// The arm.
    pub plant: PlantKind,
    /// Whether the scripted contacts act.
    pub contacts: bool,
    /// Seed of mismatch and noise.
    pub seed: u64,
    /// What the plant does beyond the reference.
    pub plant_options: PlantOptions,
    /// The robot's behaviour.
    pub options: RobotOptions,
}

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

/// A robot with its controller.
pub struct Robot {
    setup: RobotSetup,
    cycle_s: f64,
    model: RobotModel,
    torque_limit: JointVector<f64>,
    speed_limit: JointVector<f64>,
    plant: Plant,
    krc: Krc,
    rating: Rating,
    inbox: Inbox,
    counters: Counters,
    pipe: Pipe,
    contacts: Contacts,
    /// Pushes typed while it runs, in robot time.
    typed: Vec<Push>,
    drives_off: bool,
    probes: LevelProbes,
    metrics: Metrics,
    /// Cycles since the first answer.
    cycle: u64,
    /// The cycle of scenario time 0, and where it starts from.
    start: Option<Start>,
    seen: Option<Seen>,
    /// Torque of the last cycle \[Nm\].
    applied: Option<JointVector<f64>>,
    stop: Option<Stop>,
    ended_in_monitor: bool,
}

/// Scenario time 0.
struct Start {
    cycle: u64,
    posture: JointVector<f64>,
    origins: Vec<Target<f64>>,
}

/// What the robot sees at the start of a cycle.
#[derive(Clone, Copy)]
struct Seen {
    truth: JointState<f64>,
    measured: JointState<f64>,
    mass_matrix: JointMatrix<f64>,
    gravity: JointVector<f64>,
    /// +J^T F of all contacts \[Nm\].
    contact: JointVector<f64>,
    hand_force_n: f64,
}

/// The way of added torque to the motors: so many cycles long.
struct Pipe {
    cycles: usize,
    way: DeadTime,
}

impl Pipe {
    fn new(cycles: usize) -> Self {
        Self {
            cycles,
            way: DeadTime::new(cycles, JointVector::zeros()),
        }
    }
}

impl Added for Pipe {
    fn pass(&mut self, ordered: &JointVector<f64>) -> JointVector<f64> {
        self.way.pass(ordered)
    }

    fn void(&mut self) {
        *self = Self::new(self.cycles);
    }
}

impl Robot {
    /// A robot at rest in the scenario's start posture, in monitor state.
    #[must_use]
    pub fn new(setup: RobotSetup) -> Self {
        let scenario = &setup.scenario;
        let (arm, cycle_s, q0) = (scenario.arm(), scenario.cycle_s(), scenario.start());
        let limit = |value: fn(&controller_core::arm::LinkParameters) -> f64| {
            JointVector::from_fn(|i, _| value(&arm.links[i]))
        };
        let speed_limit = limit(|link| link.speed_limit);
        let contacts = if setup.contacts {
            Contacts::of(scenario)
        } else {
            Contacts::none()
        };
        let own = PlantOptions {
            dead_cycles: 0,
            ..setup.plant_options
        };
        Self {
            cycle_s,
            model: RobotModel::new(arm),
            torque_limit: limit(|link| link.torque_limit),
            speed_limit,
            plant: Plant::with_options(setup.plant, arm, q0, cycle_s, setup.seed, own),
            krc: Krc::new(setup.options, cycle_s, &q0, &speed_limit),
            rating: Rating::new(setup.options.rating, cycle_s),
            inbox: Inbox::new(),
            counters: Counters::default(),
            pipe: Pipe::new(setup.plant_options.dead_cycles),
            metrics: Metrics::new(
                scenario.levels.len(),
                &contacts.intervals(),
                &limit(|link| link.position_limit),
            ),
            contacts,
            typed: Vec::new(),
            drives_off: false,
            probes: LevelProbes::new(scenario),
            cycle: 0,
            start: None,
            seen: None,
            applied: None,
            stop: None,
            ended_in_monitor: false,
            setup,
        }
    }

    /// The measurement of this cycle. Each call is a datagram of its own with the
    /// next counter; a cycle may send several.
    pub fn measurement(&mut self, out: &mut [u8; MEASUREMENT_BYTES]) {
        let seen = self.look();
        if self.start.is_none() && self.krc.state() == State::Command {
            self.begin(&seen);
        }
        let header = self.inbox.next_header(self.cycle);
        self.report(&seen, header).emit(out);
    }

    /// Command state is reported for the first time: scenario time gets its zero.
    fn begin(&mut self, seen: &Seen) {
        let posture = seen.measured.q.map(|angle| f64::from(angle as f32));
        let settle = options::cycles(self.setup.options.settle_s, self.cycle_s);
        self.start = Some(Start {
            cycle: self.cycle + settle,
            posture,
            origins: origins(&self.setup.scenario, &posture),
        });
    }

    /// An answer has arrived, `since_cycle_start_s` \[s\] after this cycle's
    /// measurement. Its latency is that plus the cycles since the measurement
    /// which it answers. One that is not accepted has no effect but on counters.
    pub fn command(&mut self, datagram: &[u8], since_cycle_start_s: f64) -> Answer {
        let q = self.look().measured.q;
        let order = match order::read(datagram) {
            Ok(order) => order,
            Err(error) => {
                inbox::count_error(&mut self.counters.rejected, &error);
                return Answer::Rejected;
            }
        };
        let place = match self.inbox.place(&order, &mut self.counters) {
            Ok(place) => place,
            Err(answer) => return answer,
        };
        if let Err(refusal) = self.krc.accept(&order, &q) {
            inbox::count_refusal(&mut self.counters.rejected, refusal);
            return Answer::Rejected;
        }
        let behind = self.cycle - place;
        let latency_s = behind as f64 * self.cycle_s + since_cycle_start_s;
        let in_time = behind == 0 && latency_s <= self.cycle_s;
        self.inbox.accepted(place, in_time.then_some(latency_s));
        self.counters.answer(latency_s, in_time);
        Answer::Accepted
    }

    /// Ends the cycle: rates the link, moves the arm. What the cycle was, if
    /// scenario time runs. Before the first answer nothing moves and no time passes.
    pub fn advance(&mut self) -> Option<Sample> {
        if !self.inbox.has_begun() || self.stop.is_some() {
            return None;
        }
        let seen = self.look();
        if let Some(motion) = UnsafeMotion::of(&seen.truth, &self.speed_limit) {
            self.stop = Some(Stop::Unsafe(motion));
            return None;
        }
        let state = self.krc.state();
        self.rating.add(self.inbox.end_of_cycle());
        let now = Now {
            rating: &self.rating,
            drives_on: self.drives_on(),
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
        let motors = self.plant.motors().unwrap_or(self.plant.state());
        let by_springs = driving.impedance.torque(motors);
        let mut applied = explicit + by_springs;
        let mut saturated = false;
        for joint in 0..applied.len() {
            let limit = self.torque_limit[joint];
            if applied[joint].abs() > limit {
                applied[joint] = applied[joint].clamp(-limit, limit);
                explicit[joint] = applied[joint] - by_springs[joint];
                saturated = true;
            }
        }
        if let (Some(last), true) = (self.applied, bridging) {
            let by_link = applied - last - self.krc.ordered_change();
            self.counters.step = self.counters.step.max(by_link.amax());
        }
        self.applied = Some(applied);
        let t_s = self.time_s();
        self.counters
            .cycle(state, self.rating.quality(), t_s.is_some());
        for text in self.krc.take_messages() {
            self.counters.event(t_s, self.robot_time_s(), text);
        }

        let residual = self
            .krc
            .order()
            .map_or(JointVector::zeros(), |order| order.residual);
        self.move_on(&explicit, &driving.impedance);

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
            saturated,
            rank: false,
            tau_ext: -seen.contact,
            hand_force_n: seen.hand_force_n,
            conditioning: Vec::new(),
            levels,
        };
        self.metrics.add(&sample);
        Some(sample)
    }

    /// Moves the arm to the next cycle.
    fn move_on(&mut self, torque: &JointVector<f64>, impedance: &crate::plant::Impedance) {
        let (robot_t, scenario_t) = (self.robot_time_s(), self.contact_time_s());
        let (contacts, typed) = (&self.contacts, &self.typed);
        self.plant
            .advance_with(scenario_t, torque, impedance, |t, model, state| {
                let (scripted, _) = contacts.joint_torque(t, model, state);
                let at = robot_t + (t - scenario_t);
                typed.iter().fold(scripted, |sum, push| {
                    sum + push_torque(push, at, model, state)
                })
            });
        self.typed.retain(|push| push.to_s > robot_t);
        self.cycle += 1;
        self.seen = None;
    }

    /// Looks at the arm, once per cycle.
    fn look(&mut self) -> Seen {
        if let Some(seen) = self.seen {
            return seen;
        }
        let truth = *self.plant.state();
        let measured = self.plant.measure();
        let (t_s, robot_t) = (self.contact_time_s(), self.robot_time_s());
        self.contacts.take_hold(t_s, self.plant.model(), &truth);
        let (scripted, hand_force_n) = self.contacts.joint_torque(t_s, self.plant.model(), &truth);
        let model = self.plant.model();
        let contact = self.typed.iter().fold(scripted, |sum, push| {
            sum + push_torque(push, robot_t, model, &truth)
        });
        let seen = Seen {
            truth,
            measured,
            mass_matrix: self.model.mass_matrix(&measured.q),
            gravity: self.model.gravity(&measured.q),
            contact,
            hand_force_n,
        };
        self.seen = Some(seen);
        seen
    }

    fn drives_on(&self) -> bool {
        let window = self.setup.options.drives_off_s;
        let scripted = window.zip(self.time_s());
        !self.drives_off && !scripted.is_some_and(|([from, to], t)| t >= from && t < to)
    }

    /// Scenario time of this cycle \[s\]; none before it has begun.
    #[must_use]
    pub fn time_s(&self) -> Option<f64> {
        let start = self.start.as_ref()?;
        let cycles = self.cycle.checked_sub(start.cycle)?;
        Some(cycles as f64 * self.cycle_s)
    }

    /// Scenario time for contacts, where it must be a number: they have not begun
    /// before it has.
    fn contact_time_s(&self) -> f64 {
        const LONG_BEFORE: f64 = -1e6;
        self.time_s().unwrap_or(LONG_BEFORE)
    }

    /// Time since the first answer \[s\].
    #[must_use]
    pub fn robot_time_s(&self) -> f64 {
        self.cycle as f64 * self.cycle_s
    }

    /// Cycles since the first answer.
    #[must_use]
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Whether an answer was ever accepted.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.inbox.has_begun()
    }

    /// Whether command state was never reached.
    #[must_use]
    pub fn has_never_commanded(&self) -> bool {
        self.krc.entries() == 0
    }

    /// How good the link is.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.rating.quality()
    }

    /// State of the link.
    #[must_use]
    pub fn state(&self) -> State {
        self.krc.state()
    }

    /// The true arm.
    #[must_use]
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Torque of the last cycle \[Nm\], all that the motors gave.
    #[must_use]
    pub fn applied_torque(&self) -> Option<&JointVector<f64>> {
        self.applied.as_ref()
    }

    /// What happened so far.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        self.counters.events()
    }

    /// What this robot is.
    #[must_use]
    pub fn setup(&self) -> &RobotSetup {
        &self.setup
    }

    /// Whether the scenario is over, or something stopped it.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        let end = self.setup.scenario.cycles() as u64;
        let over = self
            .start
            .as_ref()
            .is_some_and(|start| self.cycle >= start.cycle + end);
        over || self.stop.is_some()
    }

    /// Leaves command state for good; measurements say monitor from now on.
    pub fn leave(&mut self) {
        self.ended_in_monitor |= self.krc.state() == State::Monitor;
        self.krc.leave();
    }

    /// Ends the run early.
    pub fn abort(&mut self, stop: Stop) {
        self.stop.get_or_insert(stop);
    }

    /// Turns the drives off or on.
    pub fn switch_drives(&mut self, on: bool) {
        self.drives_off = !on;
    }

    /// Pushes the arm from now on for `seconds` \[s\] with `force_n` \[N\], base-plate
    /// axes, with short ramps inside.
    pub fn push(&mut self, point: PointSpec, force_n: [f64; 3], seconds: f64) {
        const RAMP_S: f64 = 0.1;
        let from_s = self.robot_time_s();
        self.typed.push(Push {
            point,
            from_s,
            to_s: from_s + seconds,
            ramp_s: RAMP_S.min(seconds / 2.0),
            force_n,
        });
    }

    /// Takes all typed pushes away, with their ramps.
    pub fn release(&mut self) {
        let now = self.robot_time_s();
        for push in &mut self.typed {
            push.to_s = push.to_s.min(now + push.ramp_s);
        }
    }
}
