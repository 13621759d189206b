//! A frame has an orientation, a point has none.

use arms::LWR_IV_FLANGE;
use controller_core::{Axes, Task, TaskGains};

fn main() {
    let _ = Task::orientation(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
}
