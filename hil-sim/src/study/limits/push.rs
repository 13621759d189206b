//! The flange holds while the elbow is pushed: hard, until joints come to the ends of their
//! ranges, and softly, to feel how the null space gives way.

use cell::invalid::Invalid;
use cell::scenario::{PointSpec, Push};
use controller_core::joint::JointVector;

use super::case::{Case, only_lwr};
use super::ground::Ground;
use super::parameters::{Draw, PUSH_3, PUSH_FORCE};
use super::truth;

/// Seed of the first push.
const SEED: u64 = 300;

/// Length of the hard pushes \[s\], and factor on K_q.
const DURATION_S: f64 = 6.0;
const SOFT: f64 = 0.2;

/// Share of the upward part of the direction that is left.
const FLAT: f64 = 0.3;

/// Where pushed arms start \[deg\], by turns.
pub const STARTS_DEG: [[f64; 7]; 2] = [
    [0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0],
    [10.0, 30.0, 5.0, -85.0, 25.0, 50.0, 0.0],
];

/// The hard push `number` (from 0).
///
/// # Errors
/// An arm with other joints than the LWR.
pub fn hard(ground: &Ground, number: usize) -> Result<Case, Invalid> {
    let mut draw = Draw::new(SEED, number);
    let mut start = start(number % 2);
    start[2] += draw.value(&PUSH_3);
    let mut direction = draw.vector();
    direction.z *= FLAT;
    let force = direction.normalize() * draw.value(&PUSH_FORCE);
    let push = Push {
        point: PointSpec::Name("elbow".into()),
        from_s: 0.5,
        to_s: 4.5,
        ramp_s: 0.3,
        force_n: force.into(),
    };
    let case = holding(ground, format!("push-{number:03}"), start, DURATION_S)?;
    Ok(Case {
        stiffness_factor: SOFT,
        pushes: vec![push],
        ..case
    })
}

/// A push that comes to no limit: 30 N.
///
/// # Errors
/// An arm with other joints than the LWR.
pub fn soft(ground: &Ground) -> Result<Case, Invalid> {
    let push = Push {
        point: PointSpec::Name("elbow".into()),
        from_s: 3.0,
        to_s: 6.0,
        ramp_s: 0.3,
        force_n: [0.0, 30.0, 0.0],
    };
    let case = holding(ground, "give-30-n".into(), start(0), 8.0)?;
    Ok(Case {
        pushes: vec![push],
        ..case
    })
}

fn start(index: usize) -> JointVector<f64> {
    STARTS_DEG[index].map(f64::to_radians).into()
}

fn holding(
    ground: &Ground,
    name: String,
    start: JointVector<f64>,
    duration_s: f64,
) -> Result<Case, Invalid> {
    only_lwr(&ground.arm, "push")?;
    let flange = ground.flange_level()?;
    let rest = truth::rest(&ground.model, &start, &flange.task);
    let case = Case::at_rest(name, &ground.arm, start, vec![flange]);
    Ok(case.following(duration_s, |_| vec![rest]))
}
