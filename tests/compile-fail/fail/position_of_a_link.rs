//! The position of a link needs a point on it.

use controller_core::{Axes, Link, Task, TaskGains};

fn main() {
    let _ = Task::position(Link::L7, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
}
