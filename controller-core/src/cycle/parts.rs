//! A cycle in parts, for tools that write it down instead of running it: what stages consist of,
//! what they remember and tell, and which numbers of a controller may differ.
//!
//! Behind every part all of its results are in [`Data`]; parts whose path depends on data are
//! small.

use super::controller::Controller;
use super::data::{Data, Input, State};
use super::measurement::believe_in_turn;
use super::stages;
use super::usable::{usable_posture, usable_target};
use crate::cells::Cells;
use crate::fault::{Fault, IndexSet, Mode};
use crate::real::Real;
use crate::task::Level;

/// A part of the stages that are longer than one. Places of levels count from 0, in order of
/// priority.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What the level at a place follows.
    Target(usize),
    /// What the null space follows.
    Posture,
    /// The force on the null space.
    NullForce,
    /// What bends a straight arm.
    WayOut,
    /// The wish before any level.
    NoWish,
    /// What the level at a place asks for.
    LevelWish(usize),
    /// What the null space asks for.
    NullWish,
    /// The wish, where it is within the bounds.
    WishKept,
    /// By what measure it is brought within them.
    Compliance,
    /// What that does, the nearest acceleration found.
    Projected,
}

/// What of an input is looked at, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputPart {
    /// The measurement.
    Measurement,
    /// The target of the level at a place.
    Target(usize),
    /// The posture.
    Posture,
}

/// A part of a cycle with a fault, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrakePart {
    /// Whether the measurement is followed.
    Look,
    /// What brakes and holds the arm.
    Demand,
    /// What of it is allowed.
    Allowed,
}

/// Something of a state that has a path of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// q and dq.
    Joints,
    /// The torque that holds the arm.
    HoldingTorque,
    /// What the observer remembers.
    Observer,
    /// What the level at a place follows.
    Target(usize),
    /// What the null space follows.
    Posture,
    /// q_d, joined.
    PostureReference,
    /// Levels on their way to what they are to follow.
    Joining,
    /// Levels whose error was shortened.
    Shortened,
    /// What is told of the directions.
    Spectrum,
    /// Rows that cannot be resolved, of the exact law.
    Deficient,
    /// What bends a straight arm.
    WayOut,
    /// What is asked for.
    Wish,
    /// What the bounds leave of it.
    Projection,
    /// The torque that is asked for.
    Demand,
    /// The torque that acts.
    Allocation,
}

impl<T: Real> Controller<T> {
    /// Number of levels.
    #[must_use]
    pub fn levels_in_force(&self) -> usize {
        self.levels.in_order().len()
    }

    /// The nominal interval \[s\].
    #[must_use]
    pub fn nominal_interval_s(&self) -> T {
        self.cycle_s
    }

    /// The slot of the level at a place.
    #[must_use]
    pub fn slot_at(&self, place: usize) -> Option<usize> {
        self.levels.in_order().get(place).map(|level| level.slot)
    }

    /// Whether the level at a place tracks an orientation.
    #[must_use]
    pub fn tracks_orientation(&self, place: usize) -> bool {
        let level = self.levels.in_order().get(place);
        level.is_some_and(|level| matches!(level.tracked, crate::task::LevelPoint::Orientation(..)))
    }

    /// Numbers that may differ from controller to controller of a kind: gains, limits, the last
    /// link with what it carries.
    pub fn visit(&mut self, cells: &mut impl Cells<T>) {
        self.arm.visit(cells);
        for (place, level) in self.levels.in_order_mut().iter_mut().enumerate() {
            cells.level(Some(place));
            level.visit(cells);
        }
        cells.level(None);
        if self.law.limits {
            self.bounds.visit(cells);
        }
        self.compliance.visit(cells);
        cells.numbers("observer_gain", self.observer_gain.as_mut_slice());
        cells.numbers("cycle_s", core::slice::from_mut(&mut self.cycle_s));
        cells.numbers("torque_step", self.torque_step.as_mut_slice());
        cells.numbers("brake_step", self.brake_step.as_mut_slice());
        cells.numbers("brake_rate", core::slice::from_mut(&mut self.brake_rate));
    }

    /// Whether a cycle may run on a part of an input, no fault latched.
    ///
    /// # Errors
    /// The first quantity that cannot be.
    pub fn admit_part(&self, part: InputPart, input: &Input<'_, T>) -> Result<(), Fault> {
        match part {
            InputPart::Measurement => believe_in_turn(&self.arm, self.cycle_s, input.measurement),
            InputPart::Target(place) => {
                let level = self.levels.in_order().get(place);
                let target = |level: &Level<T>| input.reference.targets().get(level.slot);
                match level.and_then(|level| Some((level, target(level)?))) {
                    Some((level, target)) => usable_target(level, target, self.levels.shoulder()),
                    None => Ok(()),
                }
            }
            InputPart::Posture => usable_posture(&input.reference.posture, &self.arm),
        }
    }

    /// A part of a cycle with a fault.
    pub fn run_brake_part(&self, part: BrakePart, state: &mut State<T>, input: &Input<'_, T>) {
        match part {
            BrakePart::Look => self.look(state, input),
            BrakePart::Demand => self.demand_hold(state, input),
            BrakePart::Allowed => self.allow_hold(&mut state.data),
        }
    }

    /// Whether the wish of a cycle is within its bounds.
    #[must_use]
    pub fn keeps_wish(&self, data: &Data<T>) -> bool {
        data.bounds.contain(&data.wish.acceleration)
    }

    /// One part on the results of those before it.
    pub fn run_part(&self, part: Part, input: &Input<'_, T>, data: &mut Data<T>) {
        let interval_s = input.measurement.interval_s;
        let level_at = |place: usize| self.levels.in_order().get(place);
        match part {
            Part::Target(place) => {
                if let Some(level) = level_at(place) {
                    let reference = input.reference;
                    let kinematics = &data.kinematics;
                    let fresh = IndexSet::NONE;
                    data.followed
                        .follow_target(level, reference, fresh, kinematics, interval_s);
                }
            }
            Part::Posture => {
                let wanted = &input.reference.posture;
                data.followed
                    .follow_posture(wanted, &data.joints.q, interval_s);
            }
            Part::NullForce => stages::null_force(self, input, data),
            Part::WayOut => stages::way_out(self, input, data),
            Part::NoWish => stages::with_ask(self, data, |wish, ask| wish.begin(ask)),
            Part::LevelWish(place) => {
                if let Some(level) = level_at(place) {
                    stages::with_ask(self, data, |wish, ask| wish.add_level(ask, level));
                }
            }
            Part::NullWish => stages::with_ask(self, data, |wish, ask| wish.add_rest(ask)),
            Part::WishKept => stages::with_wished(self, data, |projection, wished| {
                projection.keep(wished);
            }),
            Part::Compliance => stages::with_wished(self, data, |projection, wished| {
                projection.set_compliance(wished);
            }),
            Part::Projected => stages::with_wished(self, data, |projection, wished| {
                projection.record(wished);
            }),
        }
    }

    /// What belongs to a group.
    pub fn visit_group(&self, group: Group, data: &mut Data<T>, cells: &mut impl Cells<T>) {
        match group {
            Group::Joints => {
                cells.numbers("q", data.joints.q.as_mut_slice());
                cells.numbers("dq", data.joints.dq.as_mut_slice());
            }
            Group::HoldingTorque => {
                cells.numbers("holding_torque", data.holding_torque.as_mut_slice());
            }
            Group::Observer => data.observer.visit(cells),
            Group::Target(place) => {
                if let Some(level) = self.levels.in_order().get(place) {
                    cells.level(Some(place));
                    data.followed.visit_level(level, cells);
                    cells.level(None);
                }
            }
            Group::Posture => data.followed.visit_posture(cells),
            Group::PostureReference => cells.numbers("q_d", data.posture.as_mut_slice()),
            Group::Joining => data.followed.visit_joining(cells),
            Group::Shortened => cells.set("shortened", &mut data.rows.shortened.0),
            Group::Spectrum => data.spectrum.visit(cells),
            Group::Deficient => data.hierarchy.visit(cells),
            Group::WayOut => data.way_out.visit(cells),
            Group::Wish => data.wish.visit(cells),
            Group::Projection => data.projection.visit(cells),
            Group::Demand => cells.numbers("demand", data.demand.0.as_mut_slice()),
            Group::Allocation => data.allocation.visit(cells),
        }
    }
}

impl<T: Real> Data<T> {
    /// Row `i` of the measure by which the wish is brought within the bounds, up to its diagonal.
    #[must_use]
    pub fn compliance_row(&self, i: usize) -> &[T] {
        self.projection.compliance_row(i)
    }
}

impl<T: Real> State<T> {
    /// The results of the last cycle, to change them.
    pub fn data_mut(&mut self) -> &mut Data<T> {
        &mut self.data
    }

    /// What it remembers of a fault: whether the arm was ever seen, is at rest, unseen, or left to
    /// itself, and since when it is unseen \[s\].
    pub fn visit_brake(&mut self, cells: &mut impl Cells<T>) {
        // Moving or at rest; unseen, then left to itself.
        let mut is_still = matches!(self.brake.mode, Mode::Resting | Mode::Stopped);
        let mut is_unseen = matches!(self.brake.mode, Mode::Blind | Mode::Stopped);
        cells.flag("is_still", &mut is_still);
        cells.flag("is_unseen", &mut is_unseen);
        self.brake.mode = match (is_unseen, is_still) {
            (false, false) => Mode::Braking,
            (false, true) => Mode::Resting,
            (true, false) => Mode::Blind,
            (true, true) => Mode::Stopped,
        };
        cells.numbers("blind_s", core::slice::from_mut(&mut self.brake.blind_s));
        cells.flag("sees", &mut self.brake.sees);
        cells.flag("seen", &mut self.seen);
    }
}
