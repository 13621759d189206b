//! The reference configurations of the experiments, in either precision.

use controller_core::config::ControllerConfig;
use controller_core::joint::{JointVector, diagonal};
use controller_core::kinematics::LinkPoint;
use controller_core::law::{NullDamping, NullSpace, Posture};
use controller_core::real::Real;
use controller_core::task::{Axes, Task};

/// D \[Nms/rad\].
pub const REFERENCE_DAMPING: [f64; 7] = [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03];

/// K_q \[Nm/rad\].
pub const REFERENCE_STIFFNESS: [f64; 7] = [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2];

/// The point of a task: link and offset in its frame \[m\].
pub type Point = (usize, [f64; 3]);

/// 0.078 m beyond the wrist.
pub const FLANGE: Point = (7, [0.0, 0.0, 0.078]);
/// End of the upper arm.
pub const ELBOW: Point = (3, [0.0, 0.0, 0.0]);
/// End of the forearm.
pub const WRIST: Point = (5, [0.0, 0.0, 0.0]);

/// Reference gains on the given levels, 2 ms cycle.
#[must_use]
pub fn reference<T: Real>(levels: &[(Point, Axes)]) -> ControllerConfig<T> {
    let task = |&((link, offset), axes): &(Point, Axes)| {
        let point = LinkPoint {
            link,
            offset: offset.map(T::from_f64).into(),
        };
        Task::uniform(point, axes, 400.0, 40.0)
    };
    ControllerConfig {
        tasks: levels.iter().map(task).collect(),
        null_space: NullSpace {
            stiffness: diagonal(REFERENCE_STIFFNESS),
            damping: NullDamping::Joint(diagonal(REFERENCE_DAMPING)),
            posture: Posture::Constant,
        },
        observer_gain: JointVector::from([T::from_f64(50.0); 7]),
        cycle_s: T::from_f64(0.002),
        dead_cycles: 0,
    }
}

/// Flange position above a compliant null space.
#[must_use]
pub fn two_level<T: Real>() -> ControllerConfig<T> {
    reference(&[(FLANGE, Axes::XYZ)])
}

/// Flange position, then the wrist in the horizontal plane.
#[must_use]
pub fn three_level<T: Real>() -> ControllerConfig<T> {
    reference(&[(FLANGE, Axes::XYZ), (WRIST, Axes::XY)])
}
