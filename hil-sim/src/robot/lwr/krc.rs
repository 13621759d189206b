//! The robot controller's logic: which state the link is in, which answers may
//! act, and what the motors get. No clock, no datagrams, no plant.

mod orders;

use controller_core::arm::{ArmParameters, LinkParameters};
use controller_core::joint::{DOF, JointVector};
use fri::{ControlScheme, InterfaceState, Quality};

use super::options::{Krl, RobotOptions};
use super::order::Order;
use super::rating::Rating;
use crate::plant::Impedance;
use crate::robot::control_box::{Now, cycles};
use crate::robot::driving::{Driving, Passage, Pipe};
use crate::sample::UnsafeMotion;

/// Why the content of an answer is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// cmdFlags changed in command state.
    Flags,
    /// jntPos jumps.
    Jump,
    /// addJntTrq is more than any client can mean.
    Torque,
}

/// The robot controller.
#[derive(Clone, Debug)]
pub struct Krc {
    options: RobotOptions,
    cycle_s: f64,
    /// Their maker's names.
    joints: [&'static str; DOF],
    /// Largest motion of jntPos in a cycle \[rad\].
    reach: JointVector<f64>,
    /// Largest added torque that is taken for meant \[Nm\].
    torque_bound: JointVector<f64>,
    /// In command state; else in monitor state.
    commands: bool,
    scheme: ControlScheme,
    /// Position commanded before FRI \[rad\].
    hold: JointVector<f64>,
    /// Position commanded in all \[rad\].
    commanded: JointVector<f64>,
    /// The same at the start of the cycle.
    from: JointVector<f64>,
    /// What it moves per cycle \[rad\].
    rate: JointVector<f64>,
    /// Cycles since the order that acts came in.
    age: u32,
    order: Option<Order>,
    /// An order of this cycle.
    fresh: bool,
    flags: u32,
    refused: Option<Refusal>,
    /// The last answer that was checked was refused as well.
    refusing: bool,
    /// Cycles in a row that were good enough to begin.
    good: u64,
    passage: Passage,
    last: Driving,
    /// Added torque of orders that arrived in the last cycle \[Nm\], and how much it
    /// differs from the cycle before.
    arrived: JointVector<f64>,
    change: JointVector<f64>,
    left: bool,
    /// The robot ended a motion by itself.
    braked: bool,
    fallbacks: u64,
    entries: u64,
    told: String,
    messages: Vec<String>,
}

impl Krc {
    /// In monitor state, holding `q0` \[rad\]; names and limits of joints are those of `arm`.
    #[must_use]
    pub fn new(
        options: RobotOptions,
        cycle_s: f64,
        q0: &JointVector<f64>,
        arm: &ArmParameters,
    ) -> Self {
        let limit =
            |value: fn(&LinkParameters) -> f64| JointVector::from_fn(|i, _| value(&arm.links[i]));
        Self {
            options,
            cycle_s,
            joints: arm.links.map(|link| link.name),
            reach: limit(|link| link.speed_limit) * (options.speed_factor * cycle_s),
            torque_bound: limit(|link| link.torque_limit) * options.torque_factor,
            commands: false,
            scheme: options.scheme,
            hold: *q0,
            commanded: *q0,
            from: *q0,
            rate: JointVector::zeros(),
            age: 0,
            order: None,
            fresh: false,
            flags: 0,
            refused: None,
            refusing: false,
            good: 0,
            passage: Passage::none(cycles(options.fade_s, cycle_s), cycle_s),
            last: Driving::by_springs(Impedance::NONE),
            arrived: JointVector::zeros(),
            change: JointVector::zeros(),
            left: false,
            braked: false,
            fallbacks: 0,
            entries: 0,
            told: String::new(),
            messages: Vec::new(),
        }
    }

    /// State that the coming measurement reports.
    #[must_use]
    pub fn state(&self) -> InterfaceState {
        if self.commands {
            InterfaceState::Command
        } else {
            InterfaceState::Monitor
        }
    }

    /// Control scheme.
    #[must_use]
    pub fn scheme(&self) -> ControlScheme {
        self.scheme
    }

    /// Position commanded before FRI \[rad\], and what FRI adds to it.
    #[must_use]
    pub fn positions(&self) -> (JointVector<f64>, JointVector<f64>) {
        // Equal in monitor state: the difference is zero.
        (self.hold, self.commanded - self.hold)
    }

    /// int\[1\] of the KRL program: 10 after its start, 1 in command state, 0 after it.
    #[must_use]
    pub fn answer_int(&self) -> i32 {
        match (self.commands, self.entries) {
            (true, _) => 1,
            (false, 0) => 10,
            (false, _) => 0,
        }
    }

    /// How often command state was lost against the client's will.
    #[must_use]
    pub fn fallbacks(&self) -> u64 {
        self.fallbacks
    }

    /// How often command state was entered.
    #[must_use]
    pub fn entries(&self) -> u64 {
        self.entries
    }

    /// Whether one way of driving is turning into another, or the order that acts
    /// is not of this cycle.
    #[must_use]
    pub fn is_bridging(&self) -> bool {
        self.passage.is_running() || (self.commands && self.age > 0)
    }

    /// Change of torque in the last cycle that the client ordered \[Nm\].
    #[must_use]
    pub fn ordered_change(&self) -> &JointVector<f64> {
        &self.change
    }

    /// What there is to say since the last call.
    pub fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// The order that acts.
    #[must_use]
    pub fn order(&self) -> Option<&Order> {
        self.order.as_ref()
    }

    /// Ends a cycle, which is in `rating`: what the motors get in it besides the robot's own dynamics.
    /// `added` delays the added torque of orders by the dead time; it is told
    /// when what is under way is void.
    pub fn cycle(&mut self, now: &Now<'_>, rating: &Rating, added: &mut Pipe) -> Driving {
        self.age = if self.fresh {
            0
        } else {
            self.age.saturating_add(1)
        };
        self.fresh = false;
        if self.commands {
            self.bridge();
            if let Some(motion) = now.unsafe_motion {
                self.brake(now, &motion);
                added.void();
            } else if let Some((reason, fault)) = self.must_stop(now, rating) {
                self.stop(now, &reason, fault);
                added.void();
            }
        }
        let resting = self.passage.next();
        if !self.commands {
            self.hold += resting * self.cycle_s;
            self.commanded = self.hold;
        }
        let wanted = if self.commands {
            self.ordered(now, added)
        } else {
            let [stiffness, ratio] = match self.braked {
                true => self.position_springs(),
                false => self.own_springs(),
            };
            Driving::by_springs(self.springs(now, &stiffness, &ratio))
        };
        // In monitor state nothing arrives: what fades then is the link's doing.
        self.change = if self.commands {
            wanted.torque - self.arrived
        } else {
            JointVector::zeros()
        };
        self.arrived = wanted.torque;
        self.last = self.passage.blend(&wanted);
        self.from = self.commanded;
        self.consider(now, rating);
        self.refused = None;
        self.last
    }

    /// Without an answer the position scheme goes on as before, for as long as
    /// missing answers are borne.
    fn bridge(&mut self) {
        if self.age > 0
            && self.scheme == ControlScheme::Position
            && self.age <= self.options.rating.misses_max
        {
            self.commanded += self.rate;
        }
    }

    /// Why command state must end, and whether that is a fault.
    fn must_stop(&self, now: &Now<'_>, rating: &Rating) -> Option<(String, bool)> {
        let wish = self.order.is_none_or(|order| order.wants_command);
        if self.refused == Some(Refusal::Flags) {
            let text = "cmdFlags changed in command state; they must stay constant";
            Some((text.into(), true))
        } else if !now.drives_on {
            Some(("drives off".into(), true))
        } else if rating.broken() {
            let row = rating.row();
            Some((format!("{row} answers missing in a row"), true))
        } else if rating.quality() == Quality::Unacceptable {
            let rate = rating.statistics().answer_rate;
            Some((format!("answer rate {rate:.2}: link unacceptable"), true))
        } else if self.options.krl == Krl::Handshake && !wish {
            Some(("the client gives command state back".into(), false))
        } else {
            None
        }
    }

    /// Back to monitor state: where an order moved the joint by springs, these
    /// come to rest; other joints are held where they are.
    fn stop(&mut self, now: &Now<'_>, reason: &str, fault: bool) {
        let stiffness = self.last.impedance.stiffness;
        let follows = |i: usize| stiffness[i] > 0.0 && self.scheme == ControlScheme::Position;
        let rate = JointVector::from_fn(|i, _| {
            let bound = self.reach[i];
            if follows(i) {
                self.rate[i].clamp(-bound, bound) / self.cycle_s
            } else {
                0.0
            }
        });
        self.hold = JointVector::from_fn(|i, _| if follows(i) { self.from[i] } else { now.q[i] });
        self.from = self.hold;
        self.passage.begin(self.last, rate);
        self.leave_command();
        self.fallbacks += u64::from(fault);
        self.say(format!("monitor state: {reason}"));
    }

    /// Back to monitor state for good: the springs of the position scheme take every joint
    /// where it is, without a passage, as what the client orders is what moves it.
    fn brake(&mut self, now: &Now<'_>, motion: &UnsafeMotion) {
        self.hold = *now.q;
        self.from = self.hold;
        self.passage.end();
        self.braked = true;
        self.leave();
        self.fallbacks += 1;
        self.say(format!("monitor state: {motion}"));
    }

    fn leave_command(&mut self) {
        self.commands = false;
        self.commanded = self.hold;
        self.rate = JointVector::zeros();
        self.good = 0;
        self.told.clear();
    }

    /// Leaves command state for good; the last cycle's torque stays the last.
    pub fn leave(&mut self) {
        self.left = true;
        if self.commands {
            self.leave_command();
        }
    }

    /// What the order that acts asks for; the robot's own value where it asks for none.
    fn ordered(&self, now: &Now<'_>, added: &mut Pipe) -> Driving {
        let Some(order) = &self.order else {
            return Driving::by_springs(Impedance::NONE);
        };
        let none = JointVector::zeros();
        let (torque, stiffness, ratio) = if self.scheme == ControlScheme::Position {
            let [stiffness, ratio] = self.position_springs();
            (none, stiffness, ratio)
        } else {
            let [stiffness, ratio] = self.own_springs();
            (
                order.torque.unwrap_or(none),
                order.stiffness.unwrap_or(stiffness),
                order.damping.unwrap_or(ratio),
            )
        };
        Driving {
            torque: added.pass(&torque),
            impedance: self.springs(now, &stiffness, &ratio),
        }
    }

    /// Stiffness \[Nm/rad\] and damping ratio where no order says otherwise.
    fn own_springs(&self) -> [JointVector<f64>; 2] {
        [self.options.stiffness, self.options.damping].map(JointVector::repeat)
    }

    /// The same of the position scheme.
    fn position_springs(&self) -> [JointVector<f64>; 2] {
        [self.options.position_stiffness, 1.0].map(JointVector::repeat)
    }

    /// Springs K to the commanded position, which moves evenly during the cycle.
    fn springs(
        &self,
        now: &Now<'_>,
        stiffness: &JointVector<f64>,
        ratio: &JointVector<f64>,
    ) -> Impedance {
        let way = [&self.from, &self.commanded];
        Impedance::moving(stiffness, ratio, now.mass_matrix, way, self.cycle_s)
    }

    /// In monitor state: whether command state begins with the next measurement.
    fn consider(&mut self, now: &Now<'_>, rating: &Rating) {
        if self.commands || self.left {
            return;
        }
        let Some(order) = self.order else { return };
        let wish = self.options.krl == Krl::Auto || order.wants_command;
        let link = matches!(rating.quality(), Quality::Ok | Quality::Perfect);
        if !link || self.age > 0 || !wish {
            // One missing answer does not begin the wait anew; a bad link does.
            if !link || !wish {
                self.good = 0;
            }
            return;
        }
        self.good += 1;
        if self.good <= cycles(self.options.good_for_s, self.cycle_s) {
            return;
        }
        self.good = 0;
        match order.entry(&self.options, &self.hold, &self.joints, now.drives_on) {
            Err(message) => self.tell_once(&message),
            Ok(scheme) => {
                self.scheme = scheme;
                self.commands = true;
                self.flags = order.flags;
                self.rate = JointVector::zeros();
                self.commanded = self.hold;
                self.passage.begin(self.last, JointVector::zeros());
                self.entries += 1;
                self.told.clear();
                self.say(format!("command state, cmdFlags {:#06x}", order.flags));
            }
        }
    }

    /// Why command state does not begin, once per reason in a row.
    fn tell_once(&mut self, reason: &str) {
        if reason != self.told {
            self.told = reason.to_string();
            self.say(format!("no command state: {reason}"));
        }
    }

    fn say(&mut self, text: String) {
        self.messages.push(text);
    }
}
