//! The robot's side: an arm, its control box, and what they report. What differs from robot
//! to robot is behind [`ControlBox`]; the LWR is [`LwrBox`], Panda
//! and FR3 are [`FciBox`].
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
//! that answers move the arm. References and q_d start from the position of that
//! measurement, as the numbers that the client saw. From time 0 on contacts act and
//! figures count; that answers move the arm no more does not stop that clock.

mod arm;
mod control_box;
mod counters;
mod cycle;
mod driving;
mod fci;
mod figures;
mod lwr;
mod model;
mod summary;

pub use self::fci::{
    Broken, FciBox, FciFigures, FciOptions, Handled, Received, StateDatagram, urdf,
};
pub use arm::{Robot, RobotSetup};
pub(crate) use control_box::cycles;
pub use control_box::{Answer, ControlBox, Figures, Now, Seen, Surroundings, Told, Turn};
pub use counters::Counters;
pub use driving::Driving;
pub use figures::{Counted, Event, LatencyFigures, OwnLateness, Stamp, StateCycles};
pub use fri::InterfaceState as State;
pub use fri::measurement::LEN as MEASUREMENT_BYTES;
pub use lwr::{
    Krc, Krl, LinkFigures, LwrBox, Order, POSITION_STIFFNESS, QualityCycles, Rating, RatingOptions,
    Rejected, RobotAdds, RobotOptions, Statistics, scheme_named,
};
pub use model::RobotModel;

/// The LWR.
pub type LwrRobot = Robot<LwrBox>;

/// A Panda or FR3.
pub type FciRobot = Robot<FciBox>;
