//! Passes through the wrist singularity: flange and orientation follow a joint motion on which
//! joint 6 goes through zero.

use cell::invalid::Invalid;
use cell::scenario::Stroke;
use controller_core::Target;
use controller_core::joint::JointVector;
use controller_core::task::orientation;

use super::case::{Case, CaseLevel};
use super::ground::Ground;
use super::parameters::{
    Draw, WRIST_1, WRIST_2, WRIST_3, WRIST_4, WRIST_4_MOVE, WRIST_5, WRIST_5_OFF, WRIST_6, WRIST_7,
    WRIST_TIME,
};
use crate::arm_points::{at_rest, orientation as orientation_at};

/// Seed of the first pass.
const SEED: u64 = 9000;

/// Before the pass, at its far end and behind it \[s\].
const BEFORE_S: f64 = 0.2;
const HOLD_S: f64 = 0.3;
const AFTER_S: f64 = 1.5;

/// The pass `number` (from 0). Position first and orientation first by turns.
///
/// # Errors
/// An arm with other joints than the LWR.
pub fn pass(ground: &Ground, number: usize) -> Result<Case, Invalid> {
    super::case::only_lwr(&ground.arm, "wrist")?;
    let mut draw = Draw::new(SEED, number);
    let mut start = JointVector::zeros();
    start[4] = draw.angle(&WRIST_5) + draw.angle(&WRIST_5_OFF);
    start[5] = draw.angle(&WRIST_6);
    start[1] = draw.angle(&WRIST_2);
    start[0] = draw.value(&WRIST_1);
    start[2] = draw.value(&WRIST_3);
    start[3] = draw.angle(&WRIST_4);
    start[6] = draw.value(&WRIST_7);
    let mut end = start;
    end[5] = -start[5];
    end[3] += draw.value(&WRIST_4_MOVE);
    let stroke = Stroke {
        from_s: BEFORE_S,
        duration_s: draw.value(&WRIST_TIME),
        ramp_s: None,
        hold_s: HOLD_S,
    };

    let position_first = number.is_multiple_of(2);
    let mut levels = vec![ground.flange_level()?, CaseLevel::orientation(&ground.arm)?];
    let [from, to] = [start, end].map(|q| at_rest(&ground.model, &q, &ground.flange));
    let frame = ground.arm.parameters.flange_frame();
    let [turned_from, turned_to] = [start, end].map(|q| orientation_at(&ground.model, &q, &frame));
    let by = to - from;
    let turn = orientation::rotation_vector(&orientation::chord(&turned_to, &turned_from));
    if !position_first {
        levels.reverse();
    }
    let case = Case::at_rest(format!("wrist-{number:03}"), &ground.arm, start, levels);
    let case = case.following(stroke.end_s() + AFTER_S, |t_s| {
        let [b, db, ddb] = stroke.share(t_s);
        let position = Target::Position {
            x: from + by * b,
            dx: by * db,
            ddx: by * ddb,
        };
        let orientation = Target::Orientation {
            q: orientation::turned(&turned_from, &(turn * b)),
            w: turn * db,
            dw: turn * ddb,
        };
        match position_first {
            true => vec![position, orientation],
            false => vec![orientation, position],
        }
    });
    Ok(Case {
        back_at_s: Some(stroke.end_s()),
        ..case
    })
}
