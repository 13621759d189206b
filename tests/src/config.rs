//! The reference configurations of the experiments.

use arms::{LWR_IV, LWR_IV_FLANGE};
use controller_core::{Axes, ControllerConfig, LinkPoint, NullSpace, Task, TaskGains, TaskSet};

pub use arms::{LWR_IV_DAMPING as REFERENCE_DAMPING, LWR_IV_STIFFNESS as REFERENCE_STIFFNESS};

/// K_p = 400 /s2, K_d = 40 /s on every axis.
pub const REFERENCE_GAINS: TaskGains = TaskGains::uniform(400.0, 40.0);

/// 0.078 m beyond the wrist.
pub const FLANGE: LinkPoint = LWR_IV_FLANGE;
/// End of the upper arm.
pub const ELBOW: LinkPoint = LWR_IV.points[1].point;
/// End of the forearm.
pub const WRIST: LinkPoint = LWR_IV.points[3].point;

/// The tasks as levels, the null space of the experiments, 2 ms cycle.
///
/// # Panics
/// Tasks that make no set.
#[must_use]
pub fn with_tasks(tasks: &[Task]) -> ControllerConfig {
    ControllerConfig {
        tasks: TaskSet::new(tasks).expect("tasks that make a set"),
        null_space: NullSpace::diagonal(REFERENCE_STIFFNESS, REFERENCE_DAMPING),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    }
}

/// Flange position above a compliant null space.
#[must_use]
pub fn two_level() -> ControllerConfig {
    with_tasks(&[Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS)])
}

/// Flange position, then the wrist in the horizontal plane.
#[must_use]
pub fn three_level() -> ControllerConfig {
    with_tasks(&[
        Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS),
        Task::position(WRIST, Axes::XY, REFERENCE_GAINS),
    ])
}
