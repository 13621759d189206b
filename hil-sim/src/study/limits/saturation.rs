//! Torque at its limits: a second level that jumps with what the joints may do opened wide, so
//! that the motors are what is too weak.

use std::f64::consts::TAU;

use cell::invalid::Invalid;
use cell::scenario::{PointSpec, Push};
use controller_core::joint::Vector3;
use controller_core::real::Real as _;
use controller_core::task::LevelLimits;
use controller_core::task::trajectory::{Plane, Trajectory};
use controller_core::{Target, Task};

use super::case::{Case, CaseLevel, only_lwr};
use super::ground::Ground;
use super::push::STARTS_DEG;
use super::truth;

/// Share of the torque limits that the arm has, and factor on what its joints are asked for.
const TORQUE: f64 = 0.28;
const ACCELERATION: f64 = 10.0;

/// Length \[s\]; half of a jump \[m\], time between two \[s\], time of the first \[s\].
const DURATION_S: f64 = 6.0;
const HALF_JUMP_M: f64 = 0.03;
const BETWEEN_S: f64 = 0.5;
const FROM_S: f64 = 1.0;

/// Speeds as good as none \[m/s\].
const OPEN_SPEED: f64 = 9.0;

/// The flange on a circle, the wrist below it jumps to and fro, the elbow is pushed.
///
/// # Errors
/// An arm with other joints than the LWR.
pub fn jumps(ground: &Ground) -> Result<Case, Invalid> {
    only_lwr(&ground.arm, "saturation")?;
    let start = STARTS_DEG[1].map(f64::to_radians).into();
    let levels = [ground.flange_level()?, ground.wrist_level()?];
    let [flange, wrist] =
        [&levels[0], &levels[1]].map(|level| truth::rest(&ground.model, &start, &level.task));
    let levels = levels
        .into_iter()
        .zip([LevelLimits::FIRST, LevelLimits::BELOW]);
    let levels = levels.map(|(level, limits)| open(level, limits)).collect();
    let circle = Trajectory::Turn {
        plane: Plane::Yz,
        radius_m: 0.04,
        period_s: 5.0,
        growth_s: 2.0,
    };
    let mut arm = ground.arm.clone();
    for link in &mut arm.parameters.links {
        link.torque_limit *= TORQUE;
    }
    if let Some(limits) = &mut arm.parameters.limits {
        limits.acceleration = limits.acceleration.map(|most| most * ACCELERATION);
    }
    let case = Case::at_rest("jumps-of-level-2".into(), &arm, start, levels);
    let case = case.following(DURATION_S, |t_s| {
        let first = match &flange {
            Target::Position { x, .. } => circle.sample(x, t_s),
            other => *other,
        };
        let second = match &wrist {
            Target::Position { x, .. } => Target::position(x + Vector3::y() * aside(t_s)),
            other => *other,
        };
        vec![first, second]
    });
    let push = Push {
        point: PointSpec::Name("elbow".into()),
        from_s: 3.0,
        to_s: 5.0,
        ramp_s: 0.3,
        force_n: [0.0, 35.0, 0.0],
    };
    Ok(Case {
        jumps: true,
        pushes: vec![push],
        ..case
    })
}

/// Where the wrist is wanted \[m\].
fn aside(t_s: f64) -> f64 {
    if t_s <= FROM_S {
        return 0.0;
    }
    let (sin, _) = (t_s * TAU / (2.0 * BETWEEN_S)).sine_cosine();
    HALF_JUMP_M.copysign(sin)
}

/// A level whose speeds nothing holds back.
fn open(level: CaseLevel, limits: LevelLimits) -> CaseLevel {
    let limits = LevelLimits {
        error_speed: OPEN_SPEED,
        lost_speed: OPEN_SPEED,
        ..limits
    };
    CaseLevel {
        task: Task {
            limits: Some(limits),
            ..level.task
        },
        ..level
    }
}
