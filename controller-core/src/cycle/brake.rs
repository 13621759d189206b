//! What acts after a fault: the arm is braked and held by g(q) - c M dq as long as the
//! measurement can be followed; blind, the last gravity torque that could be believed fades.
//!
//! The damping stays on at rest: where the believed masses are wrong, g alone lets the arm
//! sink, with it the sinking is slower by the ratio of c M to the friction of the joints.

use super::controller::Controller;
use super::data::{Input, State};
use super::measurement::{Measurement, believe};
use super::stages::StageName;
use super::step::Step;
use crate::fault::{Fault, IndexSet, Mode, Status};
use crate::joint::{DOF, JointVector, zeros};
use crate::law::allocation::TorqueLimits;
use crate::law::control::TorqueDemand;
use crate::law::sampling;
use crate::ranges::{
    BLIND_FADE_S, BRAKE_DECAY_BOUND, BRAKE_RATE, INTERVAL_FACTORS, MOVING_SPEED, RESTING_SPEED,
    SPEED_FACTOR,
};
use crate::real::Real;

/// c \[1/s\] of the torque -c M dq: [`BRAKE_RATE`], or what the cycle and the dead time carry.
pub(super) fn brake_rate(cycle_s: f64, dead_cycles: u8) -> f64 {
    let bound = BRAKE_DECAY_BOUND * sampling::bound(dead_cycles);
    BRAKE_RATE.min(bound / cycle_s)
}

/// Where an arm stands that has a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Brake<T: Real> {
    /// Braking, Resting, Blind or Stopped.
    mode: Mode,
    /// Time since a measurement could be followed \[s\].
    blind_s: T,
}

impl<T: Real> Brake<T> {
    pub const fn new() -> Self {
        Self {
            mode: Mode::Braking,
            blind_s: T::ZERO,
        }
    }
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
        let followed = state.brake.mode != Mode::Stopped && self.follows(state, input.measurement);
        let demand = if followed {
            self.evaluate_until(StageName::HoldingTorque, input, &mut state.data);
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
        let limits = TorqueLimits {
            limit: self.arm.torque_limit(),
            step: &self.brake_step,
        };
        let allocation = &mut state.data.allocation;
        allocation.update(&TorqueDemand(demand), &limits);
        let (mode, torque) = (state.brake.mode, allocation.torque);
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
                rank: IndexSet::NONE,
            },
        }
    }

    /// Whether the arm can be where a measurement says, seen from where it was last: finite,
    /// and no faster than twice what is believed of an arm that runs. A position or a speed
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

/// The mode of an arm that is seen: at rest below one speed, moving above another.
fn next<T: Real>(mode: Mode, dq: &JointVector<T>) -> Mode {
    let mut fastest = T::ZERO;
    for speed in dq {
        fastest = fastest.larger(speed.magnitude());
    }
    let limit = match mode {
        Mode::Resting => MOVING_SPEED,
        _ => RESTING_SPEED,
    };
    if fastest < T::from_f64(limit) {
        Mode::Resting
    } else {
        Mode::Braking
    }
}
