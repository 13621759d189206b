//! Limits of the joints of an arm that brings none of its own.
//!
//! ```text
//! alpha = 0.42 kv V, at most what half of the torque accelerates
//! kv    = 1.5 F_c / (M_jj x 1 rad/s), at least 25 1/s    a joint that brakes overcomes its
//!                                                        friction, where known, else 1 % of
//!                                                        its torque
//! A     = 4.4 1/s x V, at most 0.4 alpha                 less where the speed limit depends on
//!                                                        the way to the end
//! ```
//!
//! with the largest M_jj of the ranges. At its bound the acceleration of joint j changes by up to
//! kv alpha in a second, and with it the torque of joint i by |M_ij| kv alpha, at most
//! (M_ii)^1/2 s_j, s_j = kv alpha (M_jj)^1/2. Two bounds follow:
//!
//! ```text
//! s_j  <= half of the largest s that joints have with kv = 25 1/s      of joints with a larger kv:
//!                                                                      a light joint does not
//!                                                                      shake the heavy ones
//! (sum of s_j^2)^1/2 (M_ii)^1/2 <= 0.9 of the torque rate of joint i   of all i: where joints swing
//!                                                                      independently their torques
//!                                                                      follow
//! ```
//!
//! The first one bounds kv, the second one scales all alpha by one share.

use crate::arm::limits::JointLimits;
use crate::arm::{ArmModel, ArmParameters, LinkParameters};
use crate::joint::{DOF, in_turn, zeros};
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

/// alpha as a share of what kv makes of the speed limit, and of the torque limit.
const SWING: f64 = 0.42;
const STRONG_SHARE: f64 = 0.5;

/// Share of the largest s that joints with a larger kv than the least have at most.
const LIGHT_SHARE: f64 = 0.5;

/// Share of the torque rate that bounds may use; the rest is for gravity and references.
const RATE_SHARE: f64 = 0.9;

/// k \[1/s\], margin \[rad\] and share of the speed limit.
const POSITION_GAIN: f64 = 12.0;
const MARGIN: f64 = core::f64::consts::PI / 180.0;
const SPEED_SHARE: f64 = 0.9;

/// h kv stays below this, in cycles until a torque acts.
const SPEED_GAIN_BOUND: f64 = 0.4;

/// What an arm says of itself, or else the rule, whatever the cycle.
pub fn own_joint_limits<T: Real>(parameters: &ArmParameters, model: &ArmModel<T>) -> JointLimits {
    match parameters.limits {
        Some(limits) => limits,
        None => by_rule(parameters, &largest_inertias(model)),
    }
}

/// The same, no faster than a cycle of `cycle_s` \[s\] and `dead_cycles` carry.
pub fn joint_limits<T: Real>(
    parameters: &ArmParameters,
    model: &ArmModel<T>,
    cycle_s: f64,
    dead_cycles: u8,
) -> JointLimits {
    let mut limits = own_joint_limits(parameters, model);
    let fastest = SPEED_GAIN_BOUND / (f64::from(dead_cycles + 1) * cycle_s);
    let mut slowest = fastest;
    for i in in_turn::<DOF>(DOF) {
        let share = (fastest / limits.speed_gain[i]).min(1.0);
        limits.speed_gain[i] *= share;
        limits.acceleration[i] *= share;
        slowest = slowest.min(limits.speed_gain[i]);
    }
    limits.position_gain = limits.position_gain.min(POSITION_SHARE * slowest);
    for i in in_turn::<DOF>(DOF) {
        let most = approach_braking(&parameters.links[i], &limits);
        let most = most.min(BRAKING_SHARE * limits.acceleration[i]);
        limits.braking[i] = limits.braking[i].min(most);
    }
    limits
}

/// Speeds of a joint at which its ways to the end are compared.
const SPEEDS: usize = 32;

/// Largest A \[rad/s2\] with which v_p keeps `speed_share` of a speed limit that depends on the
/// way to the end.
///
/// A joint that has v of it left is c = (v + m)^2 / 2D from the end of that limit, less what the
/// margin adds. It needs v_p^2/2A + A/2k^2 from 2 d0 on, v_p/k before, with v_p the share of v: not
/// more than c up to A = v_p^2 / (c + (c^2 - v_p^2/k^2)^1/2).
fn approach_braking(link: &LinkParameters, limits: &JointLimits) -> f64 {
    let Some(approach) = &link.end_approach else {
        return f64::INFINITY;
    };
    let ([start, end], [least, greatest]) = (approach.ends, link.position_range);
    let added = limits.margin + (least - start).min(end - greatest);
    let mut most = f64::INFINITY;
    for place in 1..=SPEEDS {
        let left = link.speed_limit * (place as f64 / SPEEDS as f64);
        let braked = left + approach.margin;
        let way = braked * braked / (2.0 * approach.deceleration) - added;
        let speed = limits.speed_share * left;
        let shortest = speed / limits.position_gain;
        if way > shortest {
            let root = (way * way - shortest * shortest).square_root();
            most = most.min(speed * speed / (way + root));
        }
    }
    most
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
    let links = &parameters.links;
    let mut calm = 0.0f64;
    for i in in_turn::<DOF>(DOF) {
        calm = calm.max(shaking(&links[i], inertias[i], SPEED_GAIN_MIN));
    }
    calm *= LIGHT_SHARE;
    let mut squares = 0.0;
    for i in in_turn::<DOF>(DOF) {
        let (link, inertia) = (&links[i], inertias[i]);
        // Without the bound by torque s is proportional to kv^2.
        let of_one = SWING * link.speed_limit * inertia.square_root();
        let gain = friction_gain(link, inertia)
            .min((calm / of_one).square_root())
            .max(SPEED_GAIN_MIN);
        let shaking = shaking(link, inertia, gain);
        squares += shaking * shaking;
        limits.speed_gain[i] = gain;
        limits.acceleration[i] = acceleration(link, inertia, gain);
        limits.braking[i] = 4.4 * link.speed_limit;
    }
    let mut share = 1.0f64;
    for i in in_turn::<DOF>(DOF) {
        let rate = RATE_SHARE * links[i].torque_rate_limit;
        share = share.min(rate / (inertias[i] * squares).square_root());
    }
    for alpha in &mut limits.acceleration {
        *alpha *= share;
    }
    limits
}

/// kv \[1/s\] with which a joint of M_jj = `inertia` \[kg m2\] overcomes its friction.
fn friction_gain(link: &LinkParameters, inertia: f64) -> f64 {
    let friction = if link.friction.coulomb > 0.0 {
        link.friction.coulomb
    } else {
        FRICTION_SHARE * link.torque_limit
    };
    1.5 * friction / inertia
}

/// alpha \[rad/s2\] that goes with a kv \[1/s\].
fn acceleration(link: &LinkParameters, inertia: f64, gain: f64) -> f64 {
    let strong = STRONG_SHARE * link.torque_limit / inertia;
    (SWING * gain * link.speed_limit).min(strong)
}

/// s \[kg^1/2 m/s3\] that goes with a kv \[1/s\]. Behind a call: it is in the flash once.
#[inline(never)]
fn shaking(link: &LinkParameters, inertia: f64, gain: f64) -> f64 {
    gain * acceleration(link, inertia, gain) * inertia.square_root()
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
                    walk(model, joint, moved, &ranges, &mut posture);
                }
            }
            *largest = inertia(model, joint, &posture).max(*largest);
        }
    }
    largest
}

/// Moves one joint to where the inertia of `joint` is largest. Behind a call: it is in the flash
/// once.
#[inline(never)]
fn walk<T: Real>(
    model: &ArmModel<T>,
    joint: usize,
    moved: usize,
    ranges: &[[f64; 2]; DOF],
    posture: &mut [f64; DOF],
) {
    let moved = moved.min(DOF - 1);
    let ([min, max], mut best) = (ranges[moved], posture[moved]);
    let mut most = inertia(model, joint, posture);
    for place in 0..PLACES {
        let angle = min + (max - min) * (place as f64 / (PLACES - 1) as f64);
        posture[moved] = angle;
        let here = inertia(model, joint, posture);
        if here > most {
            (best, most) = (angle, here);
        }
    }
    posture[moved] = best;
}

/// Behind a call: it is in the flash once.
#[inline(never)]
fn inertia<T: Real>(model: &ArmModel<T>, joint: usize, posture: &[f64; DOF]) -> f64 {
    let mut mass_matrix = zeros();
    set_mass_matrix(model, posture, &mut mass_matrix);
    mass_matrix
        .get((joint, joint))
        .map_or(0.0, |inertia| inertia.to_f64())
}
