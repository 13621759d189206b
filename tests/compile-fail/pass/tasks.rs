//! Tasks as constants, and how they become a set.

use arms::LWR_IV_FLANGE;
use controller_core::{Axes, ConfigError, Link, LinkPoint, Task, TaskGains, TaskSet};

const GAINS: TaskGains = TaskGains::uniform(400.0, 40.0);
const FLANGE: Task = Task::position(LWR_IV_FLANGE, Axes::XYZ, GAINS);
const TOOL: Task = Task::orientation(Link::L7.frame(), Axes::Z, GAINS);
const ELBOW: LinkPoint = LinkPoint {
    link: Link::L3,
    offset: [0.0; 3],
};

fn main() -> Result<(), ConfigError> {
    let elbow = Task::position(ELBOW, Axes::X | Axes::Y, GAINS);
    let set = TaskSet::new(&[FLANGE, TOOL, elbow])?;
    assert_eq!(set.tasks(), [FLANGE, TOOL, elbow]);
    assert_eq!(Axes::from_bits(3), Some(Axes::XY));
    assert_eq!(Axes::from_bits(0), None);
    assert_eq!(Link::from_number(8), None);
    Ok(())
}
