//! Where points and links of the arm are in a posture, by the plant's own geometry. Mismatched
//! plants have the same.

use cell::scenario::{EquippedArm, LevelSpec, Scenario, TOOL_POINT, TaskSpec};
use controller_core::joint::{DOF, JointState, JointVector, Matrix3, Vector3};
use controller_core::{LinkFrame, LinkPoint, Target};

use crate::plant::PlantModel;
use controller_core::task::orientation::{self, Quaternion};

/// Corners of the drawn arm closer than this are one \[m\].
const CORNER: f64 = 1e-9;

/// Orientation of a frame of the arm in a posture \[rad\], base-plate frame.
#[must_use]
pub fn orientation(plant: &PlantModel, q: &JointVector<f64>, frame: &LinkFrame) -> Quaternion<f64> {
    // nalgebra takes columns.
    let turn = Matrix3::from(frame.rotation).transpose();
    orientation::of_rotation(&(plant.orientation(q, frame.link.number()) * turn))
}

/// At rest where the levels of a scenario are in the posture `q` \[rad\], base-plate
/// frame.
#[must_use]
pub fn origins(scenario: &Scenario, q: &JointVector<f64>) -> Vec<Target<f64>> {
    let arm = scenario.arm();
    let plant = PlantModel::new(&arm.parameters);
    let levels = scenario.levels.iter();
    levels
        .map(|level| rest_at(level, &arm, &plant, q))
        .collect()
}

/// At rest where the level's point or frame is in a posture \[rad\].
fn rest_at(
    level: &LevelSpec,
    arm: &EquippedArm,
    plant: &PlantModel,
    q: &JointVector<f64>,
) -> Target<f64> {
    match level.task {
        TaskSpec::Position => Target::position(at_rest(plant, q, &level.point.resolve(arm))),
        TaskSpec::Orientation => {
            Target::orientation(orientation(plant, q, &level.point.frame(arm)))
        }
    }
}

/// Where a point is in a posture \[rad\], base-plate frame \[m\].
#[must_use]
pub fn at_rest(plant: &PlantModel, q: &JointVector<f64>, point: &LinkPoint) -> Vector3<f64> {
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let (x, _) = plant.point(&state, point.link.number(), &point.offset.into());
    x
}

/// The arm as a line of corners in a posture \[rad\], base-plate frame \[m\]: base plate, the
/// ends of all lengths d and a of the DH table, flange, tool. Corners at the same place are
/// one.
#[must_use]
pub fn outline(arm: &EquippedArm, plant: &PlantModel, q: &JointVector<f64>) -> Vec<[f64; 3]> {
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let at = |link, offset: [f64; 3]| plant.point(&state, link, &offset.into()).0;
    let table = &arm.parameters;
    let lengths = (0..DOF).flat_map(|link| {
        let along_axis = at(link, [0.0, 0.0, table.links[link].d]);
        [along_axis, at(link + 1, [0.0; 3])]
    });
    let ends = [Some(table.flange_point()), arm.point(TOOL_POINT)];
    let ends = ends.iter().flatten().map(|point| at_rest(plant, q, point));
    let foot = at(0, [0.0; 3]);
    let mut corners = vec![Vector3::zeros()];
    for corner in std::iter::once(foot).chain(lengths).chain(ends) {
        let last = corners.last();
        if last.is_none_or(|last| (corner - last).norm() >= CORNER) {
            corners.push(corner);
        }
    }
    corners.into_iter().map(Into::into).collect()
}

/// Angular velocity of a link \[rad/s\], from the velocities of its frame's origin
/// and of the ends of its unit axes: w = sum of e_i x (de_i) / 2.
#[must_use]
pub fn angular_velocity(plant: &PlantModel, state: &JointState<f64>, link: usize) -> Vector3<f64> {
    let (origin, origin_rate) = plant.point(state, link, &Vector3::zeros());
    let mut sum = Vector3::zeros();
    for axis in 0..3 {
        let mut end = Vector3::zeros();
        end[axis] = 1.0;
        let (tip, tip_rate) = plant.point(state, link, &end);
        sum += (tip - origin).cross(&(tip_rate - origin_rate));
    }
    sum / 2.0
}
