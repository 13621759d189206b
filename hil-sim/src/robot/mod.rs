//! The robot's side of the LWR FRI: an arm, its controller, and what they report.
//!
//! A [`Robot`] is driven cycle by cycle and passes byte arrays, so that a
//! datagram socket and a client in the same process see exactly the same:
//!
//! ```text
//! loop {
//!     robot.measurement(&mut msr);       // cycle n, at t_n
//!     // ... the client's answers, in the order in which they arrive:
//!     robot.command(&cmd, since_t_n);
//!     robot.advance();                   // the newest command acts from t_n to t_n+1
//! }
//! ```
//!
//! An answer to the measurement of cycle n that arrives before the next one acts
//! in cycle n: there is no dead time. Dead cycles of the plant's options delay
//! the added torque; the robot's own gravity, springs and dampers act at once.
//!
//! Scenario time 0 is `settle_s` (1 s) after the cycle whose measurement first said
//! command state. References and q_d start from the position of that measurement,
//! as the binary32 numbers that the client saw. From time 0 on contacts act and
//! figures count; losing command state does not stop that clock.

mod arm;
mod counters;
mod cycle;
mod driving;
mod figures;
mod inbox;
mod krc;
mod model;
mod options;
mod order;
mod rating;
mod report;
mod summary;

pub use arm::{Robot, RobotSetup};
pub(crate) use driving::Driving;
pub use figures::{
    Event, LatencyFigures, LinkFigures, OwnLateness, QualityCycles, Rejected, Stamp, StateCycles,
};
pub use fri::InterfaceState as State;
pub use fri::measurement::LEN as MEASUREMENT_BYTES;
pub use inbox::Answer;
pub use krc::Krc;
pub use model::RobotModel;
pub(crate) use options::cycles;
pub use options::{Krl, POSITION_STIFFNESS, RatingOptions, RobotAdds, RobotOptions, scheme_named};
pub use order::Order;
pub use rating::{Rating, Statistics};
