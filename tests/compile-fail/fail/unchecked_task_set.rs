//! Tasks become a set by being checked.

use controller_core::{Axes, Link, Task, TaskGains, TaskSet};

fn main() {
    let task = Task::orientation(Link::L7.frame(), Axes::XYZ, TaskGains::uniform(-1.0, 0.0));
    let _ = TaskSet {
        tasks: [task; 7],
        count: 9,
    };
}
