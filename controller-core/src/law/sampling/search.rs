//! The worst posture of an arm that brings no checked ones: a net over its ranges, then
//! coordinate ascent from the worst places of it.

use core::f64::consts::{PI, TAU};

use super::mode::{DampingRate, NONE, mode_at};
use crate::arm::ArmModel;
use crate::joint::{DOF, JointMatrix, in_turn};
use crate::real::Real;

/// Postures of the net.
const NET: usize = 256;

/// How many of them are climbed from.
const CLIMBS: usize = 16;

/// Rounds of each climb, of one step up and one down per joint and one along the way.
const ROUNDS: usize = 16;

/// How many of the summits are climbed on from, and with how many rounds.
const LAST_CLIMBS: usize = 4;
const LAST_ROUNDS: usize = 48;

/// Shares of the ranges of neighbours in the net: powers of 1/x with x^8 = x + 1, whose
/// multiples fill seven dimensions evenly.
const SHARES: [f64; DOF] = [
    0.911592, 0.831001, 0.757534, 0.690562, 0.629511, 0.573857, 0.523124,
];

/// Where the position of each joint can change M: its range, of continuous joints one turn.
pub(crate) fn ranges<T: Real>(arm: &ArmModel<T>) -> [[f64; 2]; DOF] {
    let [least, greatest] = arm.position_range();
    let mut ranges = [[-PI, PI]; DOF];
    for ((range, min), max) in ranges.iter_mut().zip(least).zip(greatest) {
        let (min, max) = (min.to_f64(), max.to_f64());
        if max - min <= TAU {
            *range = [min, max];
        }
    }
    ranges
}

/// Posture `n` of the net \[rad\].
fn knot(ranges: &[[f64; 2]; DOF], n: usize) -> [f64; DOF] {
    let mut posture = [0.0; DOF];
    for ((angle, [min, max]), share) in posture.iter_mut().zip(ranges).zip(&SHARES) {
        let place = 0.5 + share * n as f64;
        *angle = min + (max - min) * (place - libm::floor(place));
    }
    posture
}

/// The fastest mode the search finds. Its time is bounded: at most
/// `NET` + (`CLIMBS` x `ROUNDS` + `LAST_CLIMBS` x `LAST_ROUNDS`) x 15 postures.
pub(super) fn fastest_mode<T: Real>(arm: &ArmModel<T>, damping: &JointMatrix<T>) -> DampingRate {
    let ranges = ranges(arm);
    let mut places = [NONE; CLIMBS];
    for n in in_turn::<NET>(NET) {
        keep_worst(&mut places, &mode_at(arm, damping, knot(&ranges, n)));
    }
    let mut summits = [NONE; LAST_CLIMBS];
    for i in in_turn::<CLIMBS>(CLIMBS) {
        let summit = climbed(arm, damping, &ranges, &places[i], ROUNDS);
        keep_worst(&mut summits, &summit);
    }
    let mut fastest = NONE;
    for i in in_turn::<LAST_CLIMBS>(LAST_CLIMBS) {
        let last = climbed(arm, damping, &ranges, &summits[i], LAST_ROUNDS);
        if last.rate > fastest.rate {
            fastest = last;
        }
    }
    fastest
}

/// Puts a mode in the place of the slowest one of the worst seen, if it is faster.
#[inline(never)]
fn keep_worst(worst: &mut [DampingRate], mode: &DampingRate) {
    let mut slowest = mode.rate;
    let mut place = None;
    for seen in worst {
        if seen.rate < slowest {
            slowest = seen.rate;
            place = Some(seen);
        }
    }
    if let Some(place) = place {
        *place = *mode;
    }
}

/// Coordinate ascent within the ranges; the steps halve when no joint gains.
#[inline(never)]
fn climbed<T: Real>(
    arm: &ArmModel<T>,
    damping: &JointMatrix<T>,
    ranges: &[[f64; 2]; DOF],
    start: &DampingRate,
    rounds: usize,
) -> DampingRate {
    let mut best = *start;
    let mut step = 0.125;
    for _ in 0..rounds {
        let (rate, before) = (best.rate, best.posture);
        for i in in_turn::<DOF>(DOF) {
            let [min, max] = ranges[i];
            for way in [step, -step] {
                let mut posture = best.posture;
                posture[i] = (posture[i] + way * (max - min)).min(max).max(min);
                best.raise(arm, damping, &posture);
            }
        }
        if best.rate <= rate {
            step *= 0.5;
            continue;
        }
        // Once more as far: along a ridge that no single joint follows.
        let mut further = best.posture;
        for i in in_turn::<DOF>(DOF) {
            let [min, max] = ranges[i];
            further[i] = (2.0 * further[i] - before[i]).min(max).max(min);
        }
        best.raise(arm, damping, &further);
    }
    best
}
