//! Violent random motions: goals that the arm can reach somehow, in no time, with a posture that
//! it cannot have.

use cell::invalid::Invalid;
use controller_core::joint::{DOF, Vector3};
use controller_core::task::trajectory::quintic;
use controller_core::{LinkPoint, Target};

use super::case::{Case, point};
use super::ground::Ground;
use super::parameters::{Draw, Parameter, RANDOM_GOAL, RANDOM_POSTURE, RANDOM_START, RANDOM_TIME};
use crate::arm_points::at_rest;

/// Seed of the first motion.
const SEED: u64 = 1000;

/// Length \[s\].
const DURATION_S: f64 = 1.3;

/// Factor on K_q.
const STIFFNESS: f64 = 3.0;

/// The motion `number` (from 0): the flange, and every other time the wrist on x and y below it,
/// to where they are in one random posture and on to another.
///
/// # Errors
/// An arm without the points.
pub fn motion(ground: &Ground, number: usize) -> Result<Case, Invalid> {
    let mut draw = Draw::new(SEED, number);
    let posture = |draw: &mut Draw, parameter: &Parameter| {
        ground.of_range(&core::array::from_fn::<_, DOF, _>(|_| {
            draw.value(parameter)
        }))
    };
    let start = posture(&mut draw, &RANDOM_START);
    let goals = [
        start,
        posture(&mut draw, &RANDOM_GOAL),
        posture(&mut draw, &RANDOM_GOAL),
    ];
    let times = [draw.value(&RANDOM_TIME), draw.value(&RANDOM_TIME)];
    let wanted = posture(&mut draw, &RANDOM_POSTURE);
    let mut levels = vec![ground.flange_level()?];
    let mut points = vec![ground.flange];
    if number % 2 == 1 {
        levels.push(ground.wrist_level()?);
        points.push(point(&ground.arm, "wrist")?);
    }
    let place = |point: &LinkPoint| goals.map(|q| at_rest(&ground.model, &q, point));
    let ways: Vec<_> = points.iter().map(place).collect();
    let case = Case::at_rest(format!("random-{number:03}"), &ground.arm, start, levels);
    let case = case.following(DURATION_S, |t_s| {
        ways.iter().map(|goals| at(goals, &times, t_s)).collect()
    });
    Ok(Case {
        posture: wanted,
        stiffness_factor: STIFFNESS,
        plant_seed: number as u64,
        ..case
    })
}

/// On the way through the goals at time `t_s`, a quintic blend from each to the next.
fn at(goals: &[Vector3<f64>; 3], times: &[f64; 2], t_s: f64) -> Target<f64> {
    let leg = usize::from(t_s >= times[0]);
    let since_s = if leg == 0 { t_s } else { t_s - times[0] };
    let by = goals[leg + 1] - goals[leg];
    let rate = 1.0 / times[leg];
    let [b, db, ddb] = quintic(since_s * rate);
    Target::Position {
        x: goals[leg] + by * b,
        dx: by * (db * rate),
        ddx: by * (ddb * rate * rate),
    }
}
