//! Where levels really are, by the plant's own geometry.

use controller_core::joint::JointVector;
use controller_core::task::{Tracked, orientation};
use controller_core::{Target, Task};

use crate::arm_points::{at_rest, orientation};
use crate::plant::PlantModel;

/// At rest where the level is in the posture `q` \[rad\].
#[must_use]
pub fn rest(plant: &PlantModel, q: &JointVector<f64>, task: &Task) -> Target<f64> {
    match &task.tracked {
        Tracked::Position(point) => Target::position(at_rest(plant, q, point)),
        Tracked::Orientation(frame) => Target::orientation(orientation(plant, q, frame)),
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
        (Tracked::Position(point), Target::Position { x, .. }) => x - at_rest(plant, q, point),
        (Tracked::Orientation(frame), Target::Orientation { q: wanted, .. }) => {
            let actual = orientation(plant, q, frame);
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
