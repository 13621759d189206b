//! The robot: its parts, where it is, and what may be done to it besides answers.

use controller_core::Target;
use controller_core::arm::ArmParameters;
use controller_core::fault::Status;
use controller_core::joint::JointVector;

use super::control_box::{ControlBox, Seen};
use super::counters::Counters;
use super::figures::Event;
use super::model::RobotModel;
use crate::after_fault::Ending;
use crate::contact::{Contacts, PlacedPush};
use crate::metrics::Metrics;
use crate::plant::{Plant, PlantOptions};
use crate::sample::{LevelProbes, Stop};
use cell::names::PlantKind;
use cell::scenario::{PointSpec, Push, Scenario};

/// How long a client may go on behind the end of the scenario, where it ends by itself what it has
/// begun \[cycles\]: many times what it takes to come to rest.
const OVERTIME: u64 = 10_000;

/// Which arm, which experiment, and how the robot behaves: options `O` of its control box.
#[derive(Clone, Debug)]
pub struct RobotSetup<O> {
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
    pub options: O,
}

/// A robot: an arm with its control box.
pub struct Robot<B: ControlBox> {
    pub(super) setup: RobotSetup<B::Options>,
    pub(super) cycle_s: f64,
    pub(super) model: RobotModel,
    pub(super) torque_limit: JointVector<f64>,
    pub(super) parameters: ArmParameters,
    pub(super) plant: Plant,
    pub(super) control_box: B,
    pub(super) counters: Counters,
    pub(super) contacts: Contacts,
    /// Pushes typed while it runs, in robot time.
    pub(super) typed: Vec<PlacedPush>,
    pub(super) drives_off: bool,
    pub(super) probes: LevelProbes,
    pub(super) metrics: Metrics,
    /// Cycles since the first answer.
    pub(super) cycle: u64,
    /// The cycle of scenario time 0, and where it starts from.
    pub(super) start: Option<Start>,
    pub(super) seen: Option<Seen>,
    /// Torque of the last cycle \[Nm\].
    pub(super) applied: Option<JointVector<f64>>,
    pub(super) ending: Ending,
    /// What the client's controller says of itself, where it can.
    pub(super) client: Option<Status>,
    /// Whether answers moved the arm no more at the end.
    pub(super) ended_alone: bool,
}

/// Scenario time 0.
pub(super) struct Start {
    pub(super) cycle: u64,
    pub(super) posture: JointVector<f64>,
    pub(super) origins: Vec<Target<f64>>,
}

impl<B: ControlBox> Robot<B> {
    /// A robot at rest in the scenario's start posture, which no answer moves yet.
    #[must_use]
    pub fn new(setup: RobotSetup<B::Options>) -> Self {
        let scenario = &setup.scenario;
        let (cycle_s, q0) = (scenario.cycle_s(), scenario.start());
        let equipped = scenario.arm();
        let arm = &equipped.parameters;
        let torque_limit = JointVector::from_fn(|i, _| arm.links[i].torque_limit);
        let contacts = if setup.contacts {
            Contacts::of(scenario)
        } else {
            Contacts::none()
        };
        let dead_cycles = setup.plant_options.dead_cycles;
        let own = PlantOptions {
            dead_cycles: 0,
            ..setup.plant_options
        };
        Self {
            cycle_s,
            model: RobotModel::new(arm),
            torque_limit,
            parameters: *arm,
            plant: Plant::with_options(setup.plant, arm, q0, cycle_s, setup.seed, own),
            control_box: B::new(&setup.options, cycle_s, &q0, arm, dead_cycles),
            counters: Counters::default(),
            metrics: Metrics::new(scenario, &contacts.intervals(), arm),
            contacts,
            typed: Vec::new(),
            drives_off: false,
            probes: LevelProbes::new(scenario),
            cycle: 0,
            start: None,
            seen: None,
            applied: None,
            ending: Ending::new(cycle_s),
            client: None,
            ended_alone: false,
            setup,
        }
    }

    /// Looks at the arm, once per cycle.
    pub(super) fn look(&mut self) -> Seen {
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
            sum + push.torque(robot_t, model, &truth)
        });
        let (mass_matrix, gravity) = self.model.at_rest(&measured.q);
        let seen = Seen {
            truth,
            measured,
            mass_matrix,
            gravity,
            contact,
            hand_force_n,
        };
        self.seen = Some(seen);
        seen
    }

    pub(super) fn drives_on(&self) -> bool {
        let window = B::drives_off_s(&self.setup.options);
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

    /// Scenario time \[s\], negative before it has begun; robot time while its zero is
    /// still unknown.
    pub(super) fn clock_s(&self) -> f64 {
        let zero = self.start.as_ref().map_or(0, |start| start.cycle);
        (self.cycle as f64 - zero as f64) * self.cycle_s
    }

    /// Scenario time for contacts, where it must be a number: they have not begun
    /// before it has.
    pub(super) fn contact_time_s(&self) -> f64 {
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
        self.control_box.has_begun()
    }

    /// The datagrams that were not used, as the end of a sentence.
    pub(crate) fn refused(&self) -> Option<String> {
        let (count, why) = self.control_box.refused()?;
        Some(format!(
            "; {count} datagrams from there were refused, the last: {why}"
        ))
    }

    /// The robot's controller.
    #[must_use]
    pub fn control_box(&self) -> &B {
        &self.control_box
    }

    /// What goes between it and the client beside the datagrams.
    pub fn control_box_mut(&mut self) -> &mut B {
        &mut self.control_box
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
    pub fn setup(&self) -> &RobotSetup<B::Options> {
        &self.setup
    }

    /// Whether the scenario is over, or something has ended it.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        let end = self.setup.scenario.cycles() as u64;
        match (&self.start, self.ending.has_begun()) {
            (_, true) => self.ending.is_over(),
            (None, _) => false,
            (Some(start), _) => self.cycle >= start.cycle + end,
        }
    }

    /// Whether there is nothing more to do: [`Robot::is_finished`], and a client that ends by
    /// itself what it has begun has done so, or had the time for it.
    #[must_use]
    pub fn is_over(&self) -> bool {
        let stopped = self.ending.has_begun();
        let waits = B::CLIENT_ENDS && !stopped && self.is_driven() && self.overtime() < OVERTIME;
        self.is_finished() && !waits
    }

    /// Cycles behind the end of the scenario.
    fn overtime(&self) -> u64 {
        let end = self.setup.scenario.cycles() as u64;
        let start = self.start.as_ref().map_or(0, |start| start.cycle);
        self.cycle.saturating_sub(start + end)
    }

    /// Whether a client that is there answers every measurement.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.control_box.is_driven()
    }

    /// Lets answers move the arm no more; measurements say so from now on. Where the client ends by
    /// itself what it has begun, it has done so or is late: nothing is left to say.
    pub fn leave(&mut self) {
        if !B::CLIENT_ENDS {
            self.ended_alone |= !self.control_box.commands();
            self.control_box.leave();
        }
    }

    /// Ends the run early.
    pub fn abort(&mut self, stop: Stop) {
        self.ending.at_once(stop);
    }

    /// What the client's controller says of this cycle, if it acts. No datagram carries it: only a
    /// client in this process can tell. A fault ends the run as unsafe motion does.
    pub fn hear(&mut self, status: Option<Status>) {
        self.client = status;
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
        let push = Push {
            point,
            from_s,
            to_s: from_s + seconds,
            ramp_s: RAMP_S.min(seconds / 2.0),
            force_n,
        };
        let arm = self.setup.scenario.arm();
        self.typed.push(PlacedPush::new(push, &arm));
    }

    /// Takes all typed pushes away, with their ramps.
    pub fn release(&mut self) {
        let now = self.robot_time_s();
        for PlacedPush { push, .. } in &mut self.typed {
            push.to_s = push.to_s.min(now + push.ramp_s);
        }
    }
}
