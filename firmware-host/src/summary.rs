//! What a run was: the file that `--summary` writes.

use std::collections::BTreeMap;

use bridge::audit::{Agreement, Audit};
use bridge::lwr::{Lwr, RobotState};
use bridge::protocol::Protocol;
use bridge::session::{Phase, Session, StopReason};
use fri::{ControlScheme, InterfaceState};
use serde::Serialize;

use crate::fci::model::UrdfAudit;
use crate::stream::StreamFigures;
use cell::realtime::Realtime;
use cell::timing::TimeFigures;

/// The whole run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Where the motion came from.
    pub scenario: String,
    /// Why it ended.
    pub reason: String,
    /// Exit code of the program.
    pub exit_code: u8,
    /// Cycle of the robot \[ms\].
    pub cycle_ms: f64,
    /// Answered measurements.
    pub answered: u64,
    /// Cycles per phase.
    pub phases: BTreeMap<&'static str, u64>,
    /// Tracking as the bridge sees it, from measured positions.
    pub levels: Vec<LevelSummary>,
    /// Datagrams that were not answered, and measurements that never came.
    pub link: LinkSummary,
    /// The robot's model against the controller's.
    pub audit: AuditSummary,
    /// From the datagram's arrival in the program to the finished answer.
    pub compute: TimeFigures,
    /// The same to the end of sending.
    pub latency: TimeFigures,
    /// What the system gave.
    pub realtime: Realtime,
    /// References that were streamed; none where the scenario is followed.
    pub references: Option<StreamFigures>,
    /// Recorded cycles that found the queue full.
    pub recorder_dropped: u64,
    /// What only a Franka robot has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fci: Option<FciSummary>,
}

/// A run with a Franka robot.
#[derive(Clone, Debug, Serialize)]
pub struct FciSummary {
    /// Version of the connection.
    pub version: u16,
    /// What ended it: an event of the table in docs/robots.md.
    pub event: &'static str,
    /// Commands whose torque was limited to the step that the robot bears.
    pub limited_cycles: u64,
    /// The lowest share of commands that came in time, of 100 each, 0 to 1, from the hundredth
    /// on; none of a shorter motion.
    pub success_rate_min: Option<f64>,
    /// States that waited behind newer ones.
    pub overtaken: u64,
    /// Replies that nobody had asked for.
    pub strays: u32,
    /// What came of AutomaticErrorRecovery, if it was asked for.
    pub recovery: Option<&'static str>,
    /// The robot's URDF against the table; none without one.
    pub urdf: Option<UrdfAudit>,
}

impl std::fmt::Display for FciSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "FCI version {}, {} commands limited to a step of 1 Nm",
            self.version, self.limited_cycles
        )?;
        if let Some(rate) = self.success_rate_min {
            write!(f, ", success rate at least {rate:.2}")?;
        }
        if let Some(recovery) = self.recovery {
            write!(f, ", recovery: {recovery}")?;
        }
        Ok(())
    }
}

/// Tracking of one level from time 0 on.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LevelSummary {
    /// Point and axes.
    pub name: String,
    /// rms \[mm\], or \[mrad\] of an orientation; none if there was no motion.
    pub rms: Option<f64>,
    /// Largest, likewise.
    pub max: Option<f64>,
}

/// Counts of the link.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LinkSummary {
    /// Measurements that did not come, by their counters.
    pub lost: u64,
    /// Repeated or overtaken measurements.
    pub stale: u64,
    /// Datagrams that are not usable measurements, by reason.
    pub rejected: BTreeMap<String, u64>,
    /// Datagrams from other addresses than the robot's.
    pub strangers: u64,
    /// Measurements from addresses that did not send enough of them in a row.
    pub unproven: u64,
}

/// The audit in words and numbers.
#[derive(Clone, Debug, Serialize)]
pub struct AuditSummary {
    /// Postures compared.
    pub samples: u32,
    /// "agrees", "not sent", "opposite sign" or "differs".
    pub gravity: &'static str,
    /// Largest difference \[Nm\].
    pub gravity_nm: f64,
    /// The same of the mass matrix.
    pub mass_matrix: &'static str,
    /// Largest difference over the largest entry.
    pub mass_share: f64,
    /// The same of the Jacobian.
    pub jacobian: &'static str,
    /// Largest difference, \[m\] or \[1\].
    pub jacobian_error: f64,
    /// The same of the end effector's pose, where the robot says it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<&'static str>,
    /// Largest difference, \[m\] or \[1\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose_error: Option<f64>,
    /// The same of the joint torque at rest, where the robot measures it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holding: Option<&'static str>,
    /// Largest difference \[Nm\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holding_nm: Option<f64>,
}

impl From<&Audit> for AuditSummary {
    fn from(audit: &Audit) -> Self {
        let name = |agreement: Agreement| match audit.samples {
            0 => "not compared",
            _ => agreement.name(),
        };
        Self {
            samples: audit.samples,
            gravity: name(audit.gravity),
            gravity_nm: audit.gravity_nm,
            mass_matrix: name(audit.mass),
            mass_share: audit.mass_share,
            jacobian: name(audit.jacobian),
            jacobian_error: audit.jacobian_error,
            pose: audit.pose.map(Agreement::name),
            pose_error: audit.pose.map(|_| audit.pose_error),
            holding: audit.holding.map(Agreement::name),
            holding_nm: audit.holding.map(|_| audit.holding_nm),
        }
    }
}

impl std::fmt::Display for AuditSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "gravity {} ({:.2} Nm), mass matrix {} ({:.1} %), Jacobian {} ({:.4})",
            self.gravity,
            self.gravity_nm,
            self.mass_matrix,
            self.mass_share * 100.0,
            self.jacobian,
            self.jacobian_error
        )?;
        if let (Some(pose), Some(error)) = (self.pose, self.pose_error) {
            write!(f, ", end effector {pose} ({error:.4})")?;
        }
        if let (Some(holding), Some(nm)) = (self.holding, self.holding_nm) {
            write!(f, ", torque at rest {holding} ({nm:.2} Nm)")?;
        }
        Ok(())
    }
}

/// What keeps a robot in command state from taking torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// Its control scheme.
    Scheme(ControlScheme),
    /// Its drives.
    DrivesOff,
}

impl Obstacle {
    /// That of a robot, if it is in command state and has one.
    #[must_use]
    pub fn of(robot: &RobotState) -> Option<Self> {
        if robot.state != InterfaceState::Command || robot.takes_torque() {
            None
        } else if robot.control == ControlScheme::JointImpedance {
            Some(Self::DrivesOff)
        } else {
            Some(Self::Scheme(robot.control))
        }
    }
}

impl std::fmt::Display for Obstacle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let scheme = match self {
            Self::DrivesOff => return write!(f, "in command state with its drives off"),
            Self::Scheme(scheme) => scheme,
        };
        let name = match scheme {
            ControlScheme::Position => "position",
            ControlScheme::CartesianImpedance => "Cartesian impedance",
            _ => "other",
        };
        write!(
            f,
            "in command state with control scheme {name}; joint impedance is needed"
        )
    }
}

/// Exit code and reason of a session that has ended, or of one that never began.
#[must_use]
pub fn ending(session: &Session<Lwr>) -> (u8, String) {
    match (wished_end(session), session.phase()) {
        (_, Phase::Waiting) => (4, "no robot: no measurement arrived".into()),
        (Some(ending), _) => ending,
        (None, Phase::Ready) => match session.last().and_then(|cycle| Obstacle::of(&cycle.robot)) {
            Some(obstacle) => (4, format!("the robot fell silent {obstacle}")),
            None => (4, "the robot fell silent without command state".into()),
        },
        (None, _) => (4, "the robot fell silent".into()),
    }
}

/// Exit code and reason of a session that has stopped by itself.
#[must_use]
pub fn wished_end<P: Protocol>(session: &Session<P>) -> Option<(u8, String)> {
    Some(match session.stop_reason()? {
        StopReason::Done => (0, "the motion is over".into()),
        StopReason::Asked => (0, "stopped by request".into()),
        StopReason::Link => (3, "the link was lost".into()),
        StopReason::Fault => {
            let fault = session.fault();
            let fault = fault.map(|fault| fault.named(session.arm()).to_string());
            (3, fault.unwrap_or_else(|| "fault".into()))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fri::Quality;

    #[test]
    fn what_keeps_a_robot_from_taking_torque_is_said() {
        let mut robot = RobotState {
            state: InterfaceState::Monitor,
            quality: Quality::Perfect,
            control: ControlScheme::Position,
            drives_on: false,
        };
        assert_eq!(Obstacle::of(&robot), None);
        robot.state = InterfaceState::Command;
        let text = Obstacle::of(&robot).expect("two of them").to_string();
        let expected = "in command state with control scheme position; joint impedance is needed";
        assert_eq!(text, expected);
        robot.control = ControlScheme::JointImpedance;
        assert_eq!(Obstacle::of(&robot), Some(Obstacle::DrivesOff));
        robot.drives_on = true;
        assert_eq!(Obstacle::of(&robot), None);
    }
}
