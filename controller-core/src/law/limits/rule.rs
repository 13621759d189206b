//! Limits of the joints of an arm that brings none of its own.
//!
//! ```text
//! kv    = 1.5 F_c / (M_jj,max x 1 rad/s), at least 25 1/s    a joint that brakes overcomes its
//!                                                            friction, where known, else 1 % of
//!                                                            its torque
//! alpha = 0.42 kv V, at most what half of the torque accelerates
//! A     = 4.4 1/s x V, at most 0.4 alpha
//! ```

use crate::arm::limits::JointLimits;
use crate::arm::{ArmModel, ArmParameters};
use crate::joint::{DOF, zeros};
use crate::law::sampling::{posture_ranges, set_mass_matrix};
use crate::real::Real;

/// Share of the torque limit that the friction of a joint is where it is not known.
const FRICTION_SHARE: f64 = 0.01;

/// Least kv \[1/s\]: the cascade of k and kv overshoots below 2 k.
const SPEED_GAIN_MIN: f64 = 25.0;

/// Largest k as a share of the least kv.
const POSITION_SHARE: f64 = 0.48;

/// Largest A as a share of alpha.
const BRAKING_SHARE: f64 = 0.4;

/// k \[1/s\], margin \[rad\] and share of the speed limit.
const POSITION_GAIN: f64 = 12.0;
const MARGIN: f64 = core::f64::consts::PI / 180.0;
const SPEED_SHARE: f64 = 0.9;

/// h kv stays below this, in cycles until a torque acts.
const SPEED_GAIN_BOUND: f64 = 0.4;

/// What an arm says of itself, or else the rule; no faster than a cycle of `cycle_s` \[s\] and
/// `dead_cycles` carry.
pub fn joint_limits<T: Real>(
    parameters: &ArmParameters,
    model: &ArmModel<T>,
    cycle_s: f64,
    dead_cycles: u8,
) -> JointLimits {
    let mut limits = match parameters.limits {
        Some(limits) => limits,
        None => by_rule(parameters, &largest_inertias(model)),
    };
    let fastest = SPEED_GAIN_BOUND / (f64::from(dead_cycles + 1) * cycle_s);
    let mut slowest = fastest;
    for (gain, alpha) in limits.speed_gain.iter_mut().zip(&mut limits.acceleration) {
        let share = (fastest / *gain).min(1.0);
        *gain *= share;
        *alpha *= share;
        slowest = slowest.min(*gain);
    }
    limits.position_gain = limits.position_gain.min(POSITION_SHARE * slowest);
    for (braking, alpha) in limits.braking.iter_mut().zip(&limits.acceleration) {
        *braking = braking.min(BRAKING_SHARE * alpha);
    }
    limits
}

fn by_rule(parameters: &ArmParameters, inertias: &[f64; DOF]) -> JointLimits {
    let mut limits = JointLimits {
        acceleration: [0.0; DOF],
        braking: [0.0; DOF],
        speed_gain: [0.0; DOF],
        position_gain: POSITION_GAIN,
        margin: MARGIN,
        speed_share: SPEED_SHARE,
    };
    for (i, (link, &inertia)) in parameters.links.iter().zip(inertias).enumerate() {
        let friction = if link.friction.coulomb > 0.0 {
            link.friction.coulomb
        } else {
            FRICTION_SHARE * link.torque_limit
        };
        let gain = (1.5 * friction / inertia).max(SPEED_GAIN_MIN);
        let strong = 0.5 * link.torque_limit / inertia;
        limits.speed_gain[i] = gain;
        limits.acceleration[i] = (0.42 * gain * link.speed_limit).min(strong);
        limits.braking[i] = 4.4 * link.speed_limit;
    }
    limits
}

/// Places of each joint that are looked at, and rounds over the joints.
const PLACES: usize = 9;
const ROUNDS: usize = 3;

/// Largest M_jj \[kg m2\] of every joint over the ranges, by a walk along one joint after the
/// other from two postures.
fn largest_inertias<T: Real>(model: &ArmModel<T>) -> [f64; DOF] {
    let ranges = posture_ranges(model);
    let mut largest = [0.0; DOF];
    for (joint, largest) in largest.iter_mut().enumerate() {
        for start in [0.5, 0.25] {
            let mut posture = ranges.map(|[min, max]| min + (max - min) * start);
            for _ in 0..ROUNDS {
                // Joints up to this one do not change its inertia.
                for moved in joint + 1..DOF {
                    walk(model, joint, moved, &ranges, &mut posture, largest);
                }
            }
            let here = inertia(model, joint, &posture);
            *largest = here.max(*largest);
        }
    }
    largest
}

/// Moves one joint to where the inertia of `joint` is largest.
fn walk<T: Real>(
    model: &ArmModel<T>,
    joint: usize,
    moved: usize,
    ranges: &[[f64; 2]; DOF],
    posture: &mut [f64; DOF],
    largest: &mut f64,
) {
    let mut best = *posture;
    let mut most = inertia(model, joint, posture);
    for place in 0..PLACES {
        let mut tried = *posture;
        if let (Some(angle), Some([min, max])) = (tried.get_mut(moved), ranges.get(moved)) {
            *angle = min + (max - min) * (place as f64 / (PLACES - 1) as f64);
        }
        let here = inertia(model, joint, &tried);
        if here > most {
            (best, most) = (tried, here);
        }
    }
    *posture = best;
    *largest = most.max(*largest);
}

fn inertia<T: Real>(model: &ArmModel<T>, joint: usize, posture: &[f64; DOF]) -> f64 {
    let mut mass_matrix = zeros();
    set_mass_matrix(model, posture, &mut mass_matrix);
    mass_matrix
        .get((joint, joint))
        .map_or(0.0, |inertia| inertia.to_f64())
}
