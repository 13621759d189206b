//! Passes through and beyond singularities at a speed, and back.

use cell::invalid::Invalid;
use cell::scenario::Stroke;
use controller_core::Target;
use controller_core::joint::{JointVector, Vector3};

use super::case::{Case, CaseLevel};
use super::ground::Ground;
use super::parameters::{BESIDE, BEYOND, Draw, LINE, OBLIQUE, RAMP_S, SPEED};
use super::truth;
use crate::arm_points::at_rest;

/// Seed of the first pass.
const SEED: u64 = 7000;

/// Before the pass, at its far end and behind it \[s\].
const BEFORE_S: f64 = 0.2;
const HOLD_S: f64 = 0.5;
const AFTER_S: f64 = 1.5;

/// Length of a way \[m\].
const WAY_M: [f64; 2] = [0.1, 1.2];

/// Ends inside: distance from the shoulder, from the axis of joint 1, and least height over the
/// shoulder \[m\].
const INSIDE_M: [f64; 2] = [0.35, 0.84];
const FROM_AXIS_M: f64 = 0.15;
const HEIGHT_M: f64 = -0.3;

/// Starts are so far from the axis of joint 1 \[m\].
const START_FROM_AXIS_M: f64 = 0.1;

/// Most starts that are tried.
const TRIES: usize = 500;

/// What a pass goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The straight arm, and on.
    Beyond,
    /// Close to the axis of joint 1.
    Overhead,
    /// Whatever is on a long line.
    Line,
}

/// A start, and the way from there \[m\].
struct Way {
    start: JointVector<f64>,
    by: Vector3<f64>,
}

/// The pass `number` (from 0). Half of them end beyond reach, a quarter lead over the shoulder, a
/// quarter are long lines; of each a third has no second level, one the wrist on x and y, one
/// the orientation of the flange, which are to stay.
///
/// # Errors
/// An arm without the points, or without a start for such a pass.
pub fn pass(ground: &Ground, number: usize) -> Result<Case, Invalid> {
    let kind = match number % 4 {
        0 | 1 => Kind::Beyond,
        2 => Kind::Overhead,
        _ => Kind::Line,
    };
    let mut draw = Draw::new(SEED, number);
    let name = format!("pass-{number:03}");
    let mut ways = (0..TRIES).filter_map(|_| way(ground, kind, &mut draw));
    let Some(Way { start, by }) = ways.next() else {
        let given = format!("no start for {name} in {TRIES}");
        return Err(Invalid::new("arm", given, "one that reaches farther")
            .within(ground.arm.parameters.name));
    };
    let mut levels = vec![ground.flange_level()?];
    match number / 4 % 3 {
        0 => {}
        1 => levels.push(ground.wrist_level()?),
        _ => levels.push(CaseLevel::orientation(&ground.arm)?),
    }
    let stroke = Stroke {
        from_s: BEFORE_S,
        hold_s: HOLD_S,
        ..Stroke::at_speed(by.norm(), SPEED, RAMP_S)
    };
    let rests: Vec<_> = levels
        .iter()
        .map(|level| truth::rest(&ground.model, &start, &level.task))
        .collect();
    let from = at_rest(&ground.model, &start, &ground.flange);
    let case = Case::at_rest(name, &ground.arm, start, levels);
    let case = case.following(stroke.end_s() + AFTER_S, |t_s| {
        let [b, db, ddb] = stroke.share(t_s);
        let mut targets = rests.clone();
        targets[0] = Target::Position {
            x: from + by * b,
            dx: by * db,
            ddx: by * ddb,
        };
        targets
    });
    Ok(Case {
        back_at_s: Some(stroke.end_s()),
        ..case
    })
}

/// A start that is drawn and the way from it, where it is one of that kind.
fn way(ground: &Ground, kind: Kind, draw: &mut Draw) -> Option<Way> {
    let start = ground.start(draw);
    let x = ground.from_shoulder(&start);
    let across = ground.across(&x);
    let by = match kind {
        Kind::Beyond => {
            let ray = x.normalize();
            let slant = draw.value(&OBLIQUE);
            let direction = (ray + ray.cross(&draw.vector()) * slant).normalize();
            let end = ground.reach + draw.value(&BEYOND);
            // Where the line leaves the sphere of that radius.
            let along = x.dot(&direction);
            direction * ((along * along - x.dot(&x) + end * end).sqrt() - along)
        }
        Kind::Overhead => {
            let inwards = -across.normalize();
            let aside = ground.axis.cross(&inwards);
            let slant = ground.scaled(draw.value(&BESIDE)) / across.norm();
            (inwards + aside * slant).normalize() * (2.0 * across.norm())
        }
        Kind::Line => draw.vector().normalize() * ground.scaled(draw.value(&LINE)),
    };
    let [shortest, longest] = WAY_M.map(|length| ground.scaled(length));
    let fits = across.norm() > ground.scaled(START_FROM_AXIS_M)
        && by.norm() > shortest
        && by.norm() < longest
        && (kind == Kind::Beyond || ends_inside(ground, kind, &(x + by)));
    fits.then_some(Way { start, by })
}

fn ends_inside(ground: &Ground, kind: Kind, end: &Vector3<f64>) -> bool {
    let [near, far] = INSIDE_M.map(|length| ground.scaled(length));
    let clear = || {
        ground.up.dot(end) > ground.scaled(HEIGHT_M)
            && ground.across(end).norm() > ground.scaled(FROM_AXIS_M)
    };
    end.norm() > near && end.norm() < far && (kind == Kind::Overhead || clear())
}
