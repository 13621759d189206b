//! What the law within limits made of a state, as JSON.

use controller_core::Task;
use controller_core::cycle::Data;
use controller_core::fault::IndexSet;
use controller_core::joint::{DOF, JointVector};
use controller_core::ranges::MAX_LEVELS;
use serde::Serialize;

use cell::scenario::EquippedArm;

/// From directions to the torque within bounds, docs/hierarchy.md 8. SI units.
#[derive(Clone, Debug, Serialize)]
pub struct WithinLimits {
    /// Highest priority first.
    pub levels: Vec<LevelWithin>,
    /// What the levels leave.
    pub null_space: NullWithin,
    /// w \[rad/s\].
    pub task_velocity: Vec<f64>,
    /// Acceleration \[rad/s2\] that bends a straight arm.
    pub way_out: Vec<f64>,
    /// Base to flange.
    pub joints: Vec<JointWithin>,
    /// Of the projection.
    pub exchanges: u8,
    /// Whether bounds were kept by a cut.
    pub unresolved: bool,
}

/// One level.
#[derive(Clone, Debug, Serialize)]
pub struct LevelWithin {
    /// As many as rows.
    pub directions: Vec<DirectionWithin>,
    /// (12) before -(dJ/dt) dq and r \[m/s2\], its error shortened.
    pub command: Vec<f64>,
    /// k of what it asks the joints for.
    pub share: f64,
    /// By what stands below it \[m/s2\].
    pub leak: f64,
    /// By the bounds of the joints \[m/s2\].
    pub disturbance: f64,
    /// Names of the limits that it met.
    pub met: Vec<&'static str>,
}

/// One direction of a level.
#[derive(Clone, Debug, Serialize)]
pub struct DirectionWithin {
    /// Column of E: in the axes of the level.
    pub axes: Vec<f64>,
    /// z \[1/kg\].
    pub mobility: f64,
    /// y^T s \[m/s\]: the motion along it.
    pub speed: f64,
    /// d z: share of 1/z with which it is driven.
    pub driven: f64,
    /// p z: share that the levels below do not get.
    pub kept: f64,
}

/// What the levels leave free.
#[derive(Clone, Debug, Serialize)]
pub struct NullWithin {
    /// n \[rad/s\].
    pub velocity: Vec<f64>,
    /// rho.
    pub release: f64,
    /// k of what it asks the joints for.
    pub share: f64,
    /// By the bounds of the joints \[W\].
    pub power: f64,
}

/// One joint.
#[derive(Clone, Debug, Serialize)]
pub struct JointWithin {
    /// Its maker's name.
    pub joint: &'static str,
    /// a* \[rad/s2\].
    pub wish: f64,
    /// lo \[rad/s2\].
    pub least: f64,
    /// hi \[rad/s2\].
    pub greatest: f64,
    /// a \[rad/s2\].
    pub acceleration: f64,
    /// 1 where it may not go further up, -1 further down, else 0.
    pub at_bound: i8,
    /// Of M (a - a*) \[Nm\].
    pub bound_torque: f64,
}

impl WithinLimits {
    pub(super) fn new(data: &Data<f64>, tasks: &[Task], arm: &EquippedArm) -> Self {
        let (wish, projection) = (&data.wish, &data.projection);
        let mut start = 0;
        let levels = tasks.iter().take(MAX_LEVELS).enumerate();
        let levels = levels.map(|(place, task)| {
            let rows = start..start + task.axes.count();
            start = rows.end;
            LevelWithin {
                directions: rows
                    .clone()
                    .map(|row| direction(data, row, rows.len()))
                    .collect(),
                command: data.rows.commanded[rows].to_vec(),
                share: wish.level_share[place],
                leak: wish.leak[place],
                disturbance: projection.disturbance[place],
                met: met(data, place),
            }
        });
        Self {
            levels: levels.collect(),
            null_space: NullWithin {
                velocity: list(&data.motion.null_velocity),
                release: data.spectrum.release,
                share: wish.null_share,
                power: projection.power,
            },
            task_velocity: list(&data.motion.task_velocity),
            way_out: list(&data.way_out.acceleration),
            joints: (0..DOF)
                .map(|joint| JointWithin::new(data, joint, arm))
                .collect(),
            exchanges: projection.pivots,
            unresolved: projection.unresolved,
        }
    }
}

fn direction(data: &Data<f64>, row: usize, rows: usize) -> DirectionWithin {
    let direction = &data.spectrum.directions()[row];
    let z = direction.mobility;
    DirectionWithin {
        axes: direction.column[..rows].to_vec(),
        mobility: z,
        speed: data.whitened_motion.along[row],
        driven: direction.drive * z,
        kept: direction.keep * z,
    }
}

/// The flags of a level, by the names of their limits.
fn met(data: &Data<f64>, level: usize) -> Vec<&'static str> {
    let (spectrum, wish) = (&data.spectrum, &data.wish);
    let flags: [(&str, IndexSet); 5] = [
        ("degraded", spectrum.degraded),
        ("released", spectrum.released),
        ("shaped", wish.shaped),
        ("scaled", wish.scaled),
        ("stuck", data.way_out.stuck),
    ];
    let met = flags.into_iter().filter(|(_, set)| set.contains(level));
    met.map(|(name, _)| name).collect()
}

impl JointWithin {
    fn new(data: &Data<f64>, joint: usize, arm: &EquippedArm) -> Self {
        let (wish, projection) = (&data.wish, &data.projection);
        let [low, high] = projection.at_bound;
        Self {
            joint: arm.joint(joint),
            wish: wish.acceleration[joint],
            least: data.bounds.least[joint],
            greatest: data.bounds.greatest[joint],
            acceleration: projection.acceleration[joint],
            at_bound: i8::from(high.contains(joint)) - i8::from(low.contains(joint)),
            bound_torque: projection.torque[joint] - wish.torque[joint],
        }
    }
}

fn list(vector: &JointVector<f64>) -> Vec<f64> {
    vector.iter().copied().collect()
}
