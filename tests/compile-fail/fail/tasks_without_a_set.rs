//! A configuration takes tasks that have been checked.

use controller_core::{Axes, ControllerConfig, Link, NullSpace, Task, TaskGains};

fn main() {
    let task = Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    let _ = ControllerConfig {
        tasks: [task],
        null_space: NullSpace::diagonal([1.0; 7], [1.0; 7]),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
}
