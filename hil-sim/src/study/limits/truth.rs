//! Where levels really are, by the plant's own geometry.

use controller_core::joint::{JointState, JointVector, Matrix3, Vector3};
use controller_core::task::Tracked;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::{LinkPoint, Target, Task};

use crate::plant::PlantModel;

/// Position \[m\] of a point of the arm in the posture `q` \[rad\], base-plate frame.
#[must_use]
pub fn position(plant: &PlantModel, q: &JointVector<f64>, point: &LinkPoint) -> Vector3<f64> {
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let (x, _) = plant.point(&state, point.link.number(), &point.offset.into());
    x
}

/// Orientation of the frame of `link`, 1 to 7, from the ends of its axes.
#[must_use]
pub fn orientation(plant: &PlantModel, q: &JointVector<f64>, link: usize) -> Quaternion<f64> {
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let place = |offset: Vector3<f64>| plant.point(&state, link, &offset).0;
    let origin = place(Vector3::zeros());
    let axis = |index| place(Vector3::from_fn(|i, _| f64::from(i == index))) - origin;
    orientation::of_rotation(&Matrix3::from_columns(&[axis(0), axis(1), axis(2)]))
}

/// At rest where the level is in the posture `q` \[rad\].
#[must_use]
pub fn rest(plant: &PlantModel, q: &JointVector<f64>, task: &Task) -> Target<f64> {
    match &task.tracked {
        Tracked::Position(point) => Target::position(position(plant, q, point)),
        Tracked::Orientation(link) => Target::orientation(orientation(plant, q, link.number())),
    }
}

/// How far the level is from its target on the axes that it controls \[m\], \[rad\]; none of one
/// that holds.
#[must_use]
pub fn error(
    plant: &PlantModel,
    q: &JointVector<f64>,
    task: &Task,
    target: &Target<f64>,
) -> Option<f64> {
    let off = match (&task.tracked, target) {
        (Tracked::Position(point), Target::Position { x, .. }) => x - position(plant, q, point),
        (Tracked::Orientation(link), Target::Orientation { q: wanted, .. }) => {
            let actual = orientation(plant, q, link.number());
            orientation::rotation_vector(&orientation::chord(wanted, &actual))
        }
        _ => return None,
    };
    let controlled = (0..3).filter(|&axis| task.axes.contains(axis));
    Some(
        controlled
            .map(|axis| off[axis] * off[axis])
            .sum::<f64>()
            .sqrt(),
    )
}
