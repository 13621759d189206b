//! One control cycle, from measurement to torque.

use super::brake::{Brake, next};
use super::controller::Controller;
use super::data::{Data, Input, State};
use super::measurement::{Measurement, believe};
use super::stages::{Stage, StageName, kinematics_at, run_law};
use super::usable::admit;
use crate::fault::{Fault, Mode, Status};
use crate::joint::{DOF, JointState, JointVector, zeros};
use crate::law::allocation::TorqueLimits;
use crate::law::control::TorqueDemand;
use crate::ranges::{BLIND_FADE_S, INTERVAL_FACTORS, SPEED_FACTOR};
use crate::real::Real;
use crate::task::{Levels, Reference};

/// The result of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T: Real> {
    /// Joint torque to apply until the next cycle \[Nm\]: always finite and
    /// within the limits of the arm.
    pub torque: JointVector<T>,
    /// r \[Nm\], tends to -tau_ext; zero while a fault is latched.
    pub residual: JointVector<T>,
    /// g(q) \[Nm\], contained in the torque: what a robot that compensates
    /// gravity itself must not be sent. While nothing is seen the torque itself.
    pub gravity: JointVector<T>,
    /// C dq \[Nm\], contained in the torque; zero while a fault is latched.
    pub coriolis: JointVector<T>,
    /// What limited or degraded the cycle.
    pub status: Status,
}

impl<T: Real> Controller<T> {
    /// The reference that keeps the arm in the posture `q` \[rad\]: every level of the controller's
    /// own at rest where it is there, absent or not, q_d = q. What motions start from.
    #[must_use]
    pub fn rest_reference(&self, q: &JointVector<T>) -> Reference<T> {
        let dq = zeros();
        self.moving_reference(&JointState { q: *q, dq })
    }

    /// The same of the tasks of a state, changed or not.
    #[must_use]
    pub fn rest_reference_of(&self, state: &State<T>, q: &JointVector<T>) -> Reference<T> {
        let dq = zeros();
        reference_of(
            self,
            state.data.tasks.levels(&self.levels),
            &JointState { q: *q, dq },
        )
    }

    /// The reference that moves as the arm does at this instant: position and
    /// velocity of every level, no acceleration, q_d = q.
    #[must_use]
    pub fn moving_reference(&self, joints: &JointState<T>) -> Reference<T> {
        reference_of(self, &self.levels, joints)
    }

    /// What levels and posture followed in the last cycle of `state`: its reference, joined
    /// where it jumped. A level that followed nothing yet has
    /// [`Target::Hold`](crate::Target::Hold).
    #[must_use]
    pub fn followed_reference(&self, state: &State<T>) -> Reference<T> {
        state.data.followed.reference(self.level_count())
    }

    /// One cycle. Never fails and never panics: with a measurement or reference
    /// that cannot be true it latches a fault and brakes the arm, see
    /// [`Mode`](crate::fault::Mode).
    #[must_use]
    pub fn step(
        &self,
        state: &mut State<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
    ) -> Step<T> {
        self.step_by(state, measurement, reference, run_law)
    }

    /// One cycle with another law in the place of [`StageName::TorqueDemand`] of the exact law,
    /// everything around it unchanged: `law` reads the results above it and writes
    /// [`Data::demand`]. For experiments that compare laws on equal terms, with controllers of
    /// [`Controller::exact`].
    #[must_use]
    pub fn step_with(
        &self,
        state: &mut State<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
        law: impl FnOnce(&Self, &Input<'_, T>, &mut Data<T>),
    ) -> Step<T> {
        self.step_by(state, measurement, reference, |controller, input, data| {
            controller.run_exact_with(input, data, law);
        })
    }

    #[inline(always)]
    fn step_by(
        &self,
        state: &mut State<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
        law: impl FnOnce(&Self, &Input<'_, T>, &mut Data<T>),
    ) -> Step<T> {
        let input = Input {
            measurement,
            reference,
        };
        let levels = state.data.tasks.levels(&self.levels);
        let admitted = admit(state.fault, &self.arm, levels, self.cycle_s, &input);
        if let Err(fault) = admitted {
            return self.brake(state, &input, fault);
        }
        self.run_by(&input, &mut state.data, law);
        state.seen = true;
        match state.data.allocation.fault(&state.data.demand) {
            None => state.answer(self.law.limits),
            Some(fault) => self.brake(state, &input, fault),
        }
    }

    /// All stages on an input that is taken as it is: no check, no fault, no joining. For
    /// inspection and tests.
    pub fn evaluate(&self, input: &Input<'_, T>, data: &mut Data<T>) {
        self.evaluate_until(StageName::ObserverInput, input, data);
    }

    /// The same up to and including the stage `last`.
    pub fn evaluate_until(&self, last: StageName, input: &Input<'_, T>, data: &mut Data<T>) {
        if last >= StageName::Followed {
            data.follow_at_once();
        }
        self.run_until(last, input, data);
    }

    fn run_until(&self, last: StageName, input: &Input<'_, T>, data: &mut Data<T>) {
        let stages: &[Stage<T>] = if last <= StageName::TaskRows {
            &Self::OBSERVED
        } else if self.law.limits {
            &Self::STAGES
        } else {
            &Self::EXACT_STAGES
        };
        self.run_listed(stages, last, input, data);
    }

    /// Those of `stages` up to and including `last`.
    #[inline(always)]
    fn run_listed(
        &self,
        stages: &[Stage<T>],
        last: StageName,
        input: &Input<'_, T>,
        data: &mut Data<T>,
    ) {
        for (name, run) in stages {
            if *name <= last {
                run(self, input, data);
            }
        }
    }

    /// The same with another law, as in [`Controller::step_with`].
    #[inline]
    pub fn evaluate_with(
        &self,
        input: &Input<'_, T>,
        data: &mut Data<T>,
        law: impl FnOnce(&Self, &Input<'_, T>, &mut Data<T>),
    ) {
        data.follow_at_once();
        self.run_by(input, data, |controller, input, data| {
            controller.run_exact_with(input, data, law);
        });
    }

    /// The exact law, with `law` in the place of its torque demand.
    #[inline(always)]
    fn run_exact_with(
        &self,
        input: &Input<'_, T>,
        data: &mut Data<T>,
        law: impl FnOnce(&Self, &Input<'_, T>, &mut Data<T>),
    ) {
        for (_, run) in Self::EXACT {
            run(self, input, data);
        }
        law(self, input, data);
    }

    /// All stages, with `law` as the law.
    #[inline(always)]
    fn run_by(
        &self,
        input: &Input<'_, T>,
        data: &mut Data<T>,
        law: impl FnOnce(&Self, &Input<'_, T>, &mut Data<T>),
    ) {
        for (_, run) in Self::OBSERVED {
            run(self, input, data);
        }
        law(self, input, data);
        for (_, run) in Self::ALLOWED {
            run(self, input, data);
        }
    }
}

/// How the points and frames of levels move, in force or not.
#[inline(never)]
fn reference_of<T: Real>(
    controller: &Controller<T>,
    levels: &Levels<T>,
    joints: &JointState<T>,
) -> Reference<T> {
    let kinematics = kinematics_at(controller, joints);
    let mut reference = Reference::hold(levels.slots(), joints.q);
    for level in levels.all().iter().filter(|level| level.size > 0) {
        if let Some(target) = reference.targets_mut().get_mut(level.slot) {
            *target = level.tracked.target(&kinematics);
        }
    }
    reference
}

impl<T: Real> Controller<T> {
    /// A cycle with a fault.
    #[inline(never)]
    pub(super) fn brake(
        &self,
        state: &mut State<T>,
        input: &Input<'_, T>,
        fault: Fault,
    ) -> Step<T> {
        if state.fault.is_none() {
            state.brake = Brake::new();
        }
        state.fault = Some(fault);
        self.look(state, input);
        self.demand_hold(state, input);
        self.allow_hold(&mut state.data);
        let (followed, mode) = (state.brake.sees, state.brake.mode);
        let allocation = &state.data.allocation;
        let torque = allocation.torque;
        Step {
            torque,
            residual: zeros(),
            // What a robot adds by itself goes on while nobody sees.
            gravity: if followed {
                state.data.dynamics.gravity
            } else {
                torque
            },
            coriolis: zeros(),
            status: Status {
                mode,
                fault: Some(fault),
                saturated: allocation.saturated,
                rate_limited: allocation.rate_limited,
                ..Status::CLEAR
            },
        }
    }

    /// Of a cycle with a fault: whether it sees.
    pub(super) fn look(&self, state: &mut State<T>, input: &Input<'_, T>) {
        let stopped = state.brake.mode == Mode::Stopped;
        state.brake.sees = !stopped && self.follows(state, input.measurement);
    }

    /// What brakes and holds the arm, by what is seen or was.
    pub(super) fn demand_hold(&self, state: &mut State<T>, input: &Input<'_, T>) {
        let demand = if state.brake.sees {
            let data = &mut state.data;
            self.run_listed(&Self::OBSERVED, StageName::HoldingTorque, input, data);
            state.seen = true;
            state.brake.blind_s = T::ZERO;
            state.brake.mode = next(state.brake.mode, &state.data.joints.dq);
            let dynamics = &state.data.dynamics;
            dynamics.gravity - dynamics.momentum * self.brake_rate
        } else {
            let brake = &mut state.brake;
            brake.blind_s += self.cycle_s;
            let left = T::ONE - brake.blind_s * T::from_f64(1.0 / BLIND_FADE_S);
            let ends = left <= T::ZERO || brake.mode == Mode::Stopped;
            brake.mode = if ends { Mode::Stopped } else { Mode::Blind };
            state.data.holding_torque * if ends { T::ZERO } else { left }
        };
        state.data.demand = TorqueDemand(demand);
    }

    /// What of it is allowed.
    pub(super) fn allow_hold(&self, data: &mut Data<T>) {
        let limits = TorqueLimits {
            limit: self.arm.torque_limit(),
            step: &self.brake_step,
        };
        data.allocation.update(&data.demand, &limits);
    }

    /// Whether the arm can be where a measurement says, seen from where it was last: finite,
    /// and no faster than four times what is believed of an arm that runs. A position or a speed
    /// may be a fault and true.
    fn follows(&self, state: &State<T>, measurement: &Measurement<T>) -> bool {
        if !state.seen {
            return believe(&self.arm, self.cycle_s, measurement).is_ok();
        }
        let fastest = T::from_f64(4.0 * SPEED_FACTOR);
        let [_, longest] = INTERVAL_FACTORS;
        // An interval may be what is wrong: then the arm may have moved for the longest one.
        let longest_s = T::from_f64(longest) * self.cycle_s;
        let interval_s = measurement.interval_s;
        let believed = interval_s >= self.cycle_s && interval_s <= longest_s;
        let since_s = state.brake.blind_s + if believed { interval_s } else { longest_s };
        let (speeds, last) = (self.arm.speed_limit(), &state.data.joints.q);
        let mut followed = true;
        for i in 0..DOF {
            let speed = fastest * speeds[i];
            // False for NaN as well.
            followed &= measurement.dq[i].magnitude() <= speed;
            followed &= (measurement.q[i] - last[i]).magnitude() <= speed * since_s;
        }
        followed
    }
}

impl<T: Real> State<T> {
    /// The results of a cycle without a fault.
    #[inline(always)]
    fn answer(&mut self, limits: bool) -> Step<T> {
        self.count_limits();
        let data = &self.data;
        let allocation = &data.allocation;
        let mut status = Status {
            saturated: allocation.saturated,
            rate_limited: allocation.rate_limited,
            joining: data.followed.joining(),
            changing: data.tasks.changing(),
            stale: data.tasks.stale(),
            ..Status::CLEAR
        };
        if limits {
            data.tell_limits(&mut status);
        } else {
            status.rank = data.hierarchy.deficient();
        }
        Step {
            torque: allocation.torque,
            residual: *data.residual(),
            gravity: data.dynamics.gravity,
            coriolis: data.dynamics.coriolis,
            status: status.without_fault(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_stand_in_the_order_of_their_names() {
        assert!(Controller::<f64>::STAGES.is_sorted_by(|(a, _), (b, _)| a < b));
        assert!(Controller::<f64>::EXACT_STAGES.is_sorted_by(|(a, _), (b, _)| a < b));
    }
}
