//! A straight or nearly straight arm, pulled back towards its shoulder.

use cell::invalid::Invalid;
use cell::scenario::Stroke;
use controller_core::Target;
use controller_core::joint::JointVector;

use super::case::{Case, CaseLevel};
use super::ground::Ground;
use super::truth;

/// How far from straight the elbow is \[deg\]: not at all, and to either side.
pub const BENT_DEG: [f64; 9] = [0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0];

/// How far the flange is pulled back \[m\].
pub const PULLED_M: [f64; 2] = [0.05, 0.15];

/// What is below the flange.
const BELOW: [Below; 3] = [Below::Nothing, Below::Wrist, Below::Orientation];

/// Joint 2 of arms that are not exactly straight, so that joint 1 moves the flange \[deg\].
const TILT_DEG: f64 = 30.0;

/// Time of the way, and of the stay behind it \[s\].
const PULL_S: f64 = 4.0;
const STAY_S: f64 = 3.0;

#[derive(Clone, Copy)]
enum Below {
    Nothing,
    /// The wrist keeps x and y.
    Wrist,
    /// The flange keeps its orientation.
    Orientation,
}

/// Number of runs.
#[must_use]
pub fn count() -> usize {
    BENT_DEG.len() * PULLED_M.len() * BELOW.len()
}

/// The run `number` (from 0).
///
/// # Errors
/// An arm without the points that the levels move.
pub fn pull(ground: &Ground, number: usize) -> Result<Case, Invalid> {
    let below = BELOW[number % BELOW.len()];
    let number_of_pull = number / BELOW.len();
    let pulled = PULLED_M[number_of_pull % PULLED_M.len()];
    let bent = BENT_DEG[number_of_pull / PULLED_M.len() % BENT_DEG.len()];
    let start = start(ground, bent);

    let mut levels = vec![ground.flange_level()?];
    let name = match below {
        Below::Nothing => "flange",
        Below::Wrist => {
            levels.push(ground.wrist_level()?);
            "wrist"
        }
        Below::Orientation => {
            levels.push(CaseLevel::orientation(&ground.arm)?);
            "pose"
        }
    };
    let name = format!("bent-{bent}-back-{:.0}-{name}", pulled * 1e3);
    let rests = levels
        .iter()
        .map(|level| truth::rest(&ground.model, &start, &level.task));
    let mut targets: Vec<Target<f64>> = rests.collect();
    let from = targets[0];
    let way = ground.from_shoulder(&start).normalize() * -pulled;
    let stroke = Stroke {
        from_s: 0.0,
        duration_s: PULL_S,
        ramp_s: None,
        hold_s: STAY_S,
    };
    let case = Case::at_rest(name, &ground.arm, start, levels);
    let case = case.following(PULL_S + STAY_S, |t_s| {
        let [b, db, ddb] = stroke.share(t_s);
        if let Target::Position { x, .. } = from {
            targets[0] = Target::Position {
                x: x + way * b,
                dx: way * db,
                ddx: way * ddb,
            };
        }
        targets.clone()
    });
    Ok(Case {
        back_at_s: Some(PULL_S),
        ..case
    })
}

/// The straight arm, bent at the elbow \[deg\] to the side of the sign, or to the other one where
/// its range ends.
fn start(ground: &Ground, bent_deg: f64) -> JointVector<f64> {
    let mut q = ground.straight;
    if bent_deg == 0.0 {
        return q;
    }
    q[1] += TILT_DEG.to_radians();
    let [min, max] = ground.arm.parameters.links[3].position_range;
    let bent = bent_deg.to_radians();
    let inside = (min..=max).contains(&(q[3] + bent));
    q[3] += if inside { bent } else { -bent };
    q
}
