//! Where points and links of the arm are in a posture, by the plant's own geometry.

use arms::LWR_IV;
use cell::scenario::{LevelSpec, Scenario, TaskSpec};
use controller_core::Target;
use controller_core::joint::{JointState, JointVector, Matrix3, Vector3};
use controller_core::real::Real;

use crate::plant::PlantModel;
use controller_core::task::orientation::{self, Quaternion};

/// Orientation of the DH frame of `link` (1..=7) in a posture \[rad\], base-plate
/// frame. Mismatched plants have the same geometry.
#[must_use]
pub fn orientation(q: &JointVector<f64>, link: usize) -> Quaternion<f64> {
    let mut rotation = Matrix3::identity();
    for (angle, link) in q.iter().zip(&LWR_IV.links).take(link) {
        let (sin, cos) = angle.sine_cosine();
        let (sin_twist, cos_twist) = link.alpha.sine_cosine();
        let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let twist = Matrix3::new(
            1.0, 0.0, 0.0, 0.0, cos_twist, -sin_twist, 0.0, sin_twist, cos_twist,
        );
        rotation = rotation * turn * twist;
    }
    orientation::of_rotation(&rotation)
}

/// At rest where the levels of a scenario are in the posture `q` \[rad\], base-plate
/// frame.
#[must_use]
pub fn origins(scenario: &Scenario, q: &JointVector<f64>) -> Vec<Target<f64>> {
    scenario
        .levels
        .iter()
        .map(|level| rest_at(level, q))
        .collect()
}

/// At rest where the level's point or frame is in a posture \[rad\].
#[must_use]
fn rest_at(level: &LevelSpec, q: &JointVector<f64>) -> Target<f64> {
    let point = level.point.resolve();
    let link = point.link.number();
    match level.task {
        TaskSpec::Position => {
            let state = JointState {
                q: *q,
                dq: JointVector::zeros(),
            };
            let (x, _) = PlantModel::new(&LWR_IV).point(&state, link, &point.offset.into());
            Target::position(x)
        }
        TaskSpec::Orientation => Target::orientation(orientation(q, link)),
    }
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
