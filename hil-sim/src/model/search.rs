//! Postures of an arm that are the worst in something.

use std::f64::consts::{PI, TAU};

use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{DOF, JointMatrix, JointState};
use controller_core::law::sampling::{fastest_mode, mode_at};

use crate::plant::noise::Rng;

/// Seed and streams of what is drawn: postures, dampings.
const SEED: u64 = 1;
const POSTURES: u64 = 21;
const DAMPINGS: u64 = 22;

/// Postures that are drawn, how many of them are climbed from, and the steps of a climb.
const DRAWN: usize = 1000;
const CLIMBS: usize = 8;
const STEPS: usize = 400;

/// Dampings that are drawn in a round to see whether postures are missing, and most rounds.
const DRAWN_DAMPINGS: usize = 16;
const ROUNDS: usize = 4;

/// What the search for a damping may find above the postures of a table: as much as it
/// differs from other searches. After a round without more than this there is no other one.
const EXCESS: f64 = 3e-3;

/// Ranges in which the posture of an arm makes a difference, of continuous joints one turn.
#[must_use]
pub fn ranges(arm: &ArmParameters) -> [[f64; 2]; DOF] {
    arm.links.map(|link| match link.position_range {
        [min, max] if max - min <= TAU => [min, max],
        _ => [-PI, PI],
    })
}

/// Random postures, the same ones every time \[rad\].
#[must_use]
pub fn drawn(arm: &ArmParameters, count: usize) -> Vec<[f64; DOF]> {
    let (mut rng, ranges) = (Rng::new(SEED, POSTURES), ranges(arm));
    let mut one = || ranges.map(|[min, max]| min + (max - min) * rng.uniform());
    (0..count).map(|_| one()).collect()
}

/// Seed and stream of [`states`].
const STATES_SEED: [u64; 2] = [1, 20];

/// So many random states within the ranges and speeds of an arm.
pub fn states(arm: &ArmParameters, count: usize) -> impl Iterator<Item = JointState<f64>> {
    let [seed, stream] = STATES_SEED;
    let mut rng = Rng::new(seed, stream);
    (0..count).map(move |_| {
        let mut within = |[min, max]: [f64; 2]| min + (max - min) * rng.uniform();
        let q = arm.links.map(|link| within(link.position_range));
        let dq = arm
            .links
            .map(|link| within([-link.speed_limit, link.speed_limit]));
        JointState {
            q: q.into(),
            dq: dq.into(),
        }
    })
}

/// The largest value that is found, and where \[rad\]: random postures, then random steps uphill
/// from the highest.
#[must_use]
pub fn highest(arm: &ArmParameters, value: impl Fn(&[f64; DOF]) -> f64) -> (f64, [f64; DOF]) {
    let (mut rng, ranges) = (Rng::new(SEED, POSTURES), ranges(arm));
    let mut seen: Vec<_> = drawn(arm, DRAWN)
        .into_iter()
        .map(|posture| (value(&posture), posture))
        .collect();
    seen.sort_by(|one, other| other.0.total_cmp(&one.0));
    let mut highest = seen[0];
    for mut best in seen.into_iter().take(CLIMBS) {
        let mut size = 0.2;
        for _ in 0..STEPS {
            let share = if rng.uniform() < 0.5 { 1.0 } else { 0.3 };
            let mut tried = best.1;
            for (angle, [min, max]) in tried.iter_mut().zip(ranges) {
                let step = size * (max - min) * (2.0 * rng.uniform() - 1.0);
                if rng.uniform() < share {
                    *angle = (*angle + step).clamp(min, max);
                }
            }
            let there = value(&tried);
            if there > best.0 {
                (best, size) = ((there, tried), size * 1.3);
            } else {
                size = (size * 0.95).max(1e-5);
            }
        }
        if best.0 > highest.0 {
            highest = best;
        }
    }
    highest
}

/// Postures of the sampling bound of an arm without any: the worst one of the damping of each
/// single joint and of equal damping; then those of random dampings for which none of these is as
/// bad. With the largest excess, as a share, that the last round of random dampings found.
#[must_use]
pub fn damping_postures(model: &ArmModel<f64>) -> (Vec<[f64; DOF]>, f64) {
    let diagonal = |values: [f64; DOF]| JointMatrix::from_diagonal(&values.into());
    let mut postures: Vec<[f64; DOF]> = Vec::new();
    let add = |posture: [f64; DOF], postures: &mut Vec<[f64; DOF]>| {
        // A ten-thousandth of a degree matters to no bound.
        let rounded = posture.map(|angle| ((angle.to_degrees() * 1e4).round() / 1e4).to_radians());
        if !postures.contains(&rounded) {
            postures.push(rounded);
        }
    };
    for joint in 0..DOF {
        let mut only = [1e-9; DOF];
        only[joint] = 1.0;
        add(fastest_mode(model, &diagonal(only)).posture, &mut postures);
    }
    add(
        fastest_mode(model, &diagonal([1.0; DOF])).posture,
        &mut postures,
    );
    let mut rng = Rng::new(SEED, DAMPINGS);
    let mut worst = 0.0f64;
    for _ in 0..ROUNDS {
        worst = 0.0;
        for _ in 0..DRAWN_DAMPINGS {
            // Over three decades.
            let damping = diagonal(std::array::from_fn(|_| 10f64.powf(-3.0 * rng.uniform())));
            let found = fastest_mode(model, &damping);
            let known = postures
                .iter()
                .map(|&posture| mode_at(model, &damping, posture).rate);
            let excess = found.rate / known.fold(f64::MIN_POSITIVE, f64::max) - 1.0;
            worst = worst.max(excess);
            if excess > EXCESS {
                add(found.posture, &mut postures);
            }
        }
        if worst <= EXCESS {
            break;
        }
    }
    (postures, worst)
}
