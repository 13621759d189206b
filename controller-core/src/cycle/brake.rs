//! What acts after a fault: the arm is braked and held by g(q) - c M dq as long as the
//! measurement can be followed; blind, the last gravity torque that could be believed fades.
//!
//! The damping stays on at rest: where the believed masses are wrong, g alone lets the arm
//! sink, with it the sinking is slower by the ratio of c M to the friction of the joints.

use crate::fault::Mode;
use crate::joint::JointVector;
use crate::law::sampling;
use crate::ranges::{BRAKE_DECAY_BOUND, BRAKE_RATE, MOVING_SPEED, RESTING_SPEED};
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
    pub mode: Mode,
    /// Time since a measurement could be followed \[s\].
    pub blind_s: T,
    /// Whether the measurement of the cycle is followed.
    pub sees: bool,
}

impl<T: Real> Brake<T> {
    pub const fn new() -> Self {
        Self {
            mode: Mode::Braking,
            blind_s: T::ZERO,
            sees: false,
        }
    }
}

/// The mode of an arm that is seen: at rest below one speed, moving above another.
pub(super) fn next<T: Real>(mode: Mode, dq: &JointVector<T>) -> Mode {
    let mut fastest = T::ZERO;
    for speed in dq {
        fastest = fastest.most(speed.magnitude());
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
