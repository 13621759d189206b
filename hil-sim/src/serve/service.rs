//! What serving is: to whom, how, and how it ends.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::{Duration, Instant as Clock};

use crate::link::Fault;
use crate::robot::{ControlBox, Robot};

/// How a robot is served.
#[derive(Clone, Debug)]
pub struct Service {
    /// Where the client is.
    pub client: Client,
    /// Virtual time instead of the wall clock.
    pub lockstep: bool,
    /// What happens to datagrams.
    pub faults: Vec<Fault>,
    /// How long to wait for the first answer, and from there for command state
    /// \[s\].
    pub wait_s: f64,
}

/// Where the client is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Client {
    /// At an address, reached from an own port; 0: any.
    Udp {
        /// The client's address.
        remote: SocketAddr,
        /// Own port; 0: any.
        local_port: u16,
    },
    /// At the other end of a serial line: a device or a pseudo terminal.
    Serial(PathBuf),
}

impl fmt::Display for Client {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Udp { remote, .. } => write!(f, "{remote}"),
            Self::Serial(path) => write!(f, "{}", path.display()),
        }
    }
}

/// How a service ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The scenario is over, or something stopped it.
    Finished,
    /// There was no client that came into command state; why.
    NoClient(String),
}

impl Service {
    /// Whether to wait no longer: for the first answer by the wall clock, for
    /// command state by the robot's.
    pub(super) fn hopeless<B: ControlBox>(&self, robot: &Robot<B>, begun: Clock) -> Option<End> {
        if !robot.has_begun() {
            let over = begun.elapsed() > Duration::from_secs_f64(self.wait_s);
            return over.then(|| {
                let seen = robot.refused().unwrap_or_default();
                End::NoClient(format!(
                    "no answer from {} within {} s{seen}",
                    self.client, self.wait_s
                ))
            });
        }
        let over = robot.control_box().has_never_commanded() && robot.robot_time_s() > self.wait_s;
        over.then(|| {
            let last = robot.events().last().map(|event| event.text.clone());
            let why = last.unwrap_or_else(|| robot.control_box().link());
            End::NoClient(format!(
                "no command state with {} within {} s: {why}",
                self.client, self.wait_s
            ))
        })
    }
}
