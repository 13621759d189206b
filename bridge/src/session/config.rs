//! What a session is made of.

use controller_core::arm::ArmParameters;
use controller_core::{Controller, ControllerConfig, LinkPoint, MakeController};

/// What the robot adds to the torque that it is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotAdds {
    /// Gravity g(q).
    #[default]
    Gravity,
    /// Gravity and Coriolis torque.
    GravityAndCoriolis,
}

/// What a session is made of. Times are in s, counts in cycles.
#[derive(Clone, Debug)]
pub struct SessionConfig {
    /// The arm that the controller believes in.
    pub arm: ArmParameters,
    /// Tasks and gains. The cycle comes from the robot.
    pub controller: ControllerConfig,
    /// What makes the controller, and with it its law.
    pub law: MakeController<f64>,
    /// The flange, for the audit of the robot's Jacobian.
    pub flange: LinkPoint,
    /// What must not be sent.
    pub robot_adds: RobotAdds,
    /// Between the first command state and time 0 of the motion; the posture is held.
    pub settle_s: f64,
    /// In which the torque grows from zero on entering command state.
    pub ramp_s: f64,
    /// Length of the motion, from time 0; of a dry session, from the first datagram.
    pub duration_s: f64,
    /// Lost measurements, or commands that the robot does not have, after which
    /// the arm is held.
    pub hold_after: u16,
    /// Clean cycles after which a held arm moves on.
    pub resume_after: u16,
    /// Time held after which the session stops.
    pub stop_after_s: f64,
    /// Measurements in a row with a position that the arm cannot have reached, or a measured
    /// speed that it cannot have, which count as lost; the next one is believed, and a fault
    /// of the controller. 0: so is the first.
    pub doubted_max: u8,
    /// Never move the robot: audit, and torques as they would be.
    pub dry: bool,
}

impl SessionConfig {
    /// With the times and counts of a robot on a wired network.
    #[must_use]
    pub fn new(
        arm: &ArmParameters,
        controller: ControllerConfig,
        flange: LinkPoint,
        duration_s: f64,
    ) -> Self {
        Self {
            arm: *arm,
            controller,
            law: Controller::new,
            flange,
            robot_adds: RobotAdds::Gravity,
            settle_s: 1.0,
            ramp_s: 0.5,
            duration_s,
            hold_after: 5,
            resume_after: 50,
            stop_after_s: 2.0,
            doubted_max: 0,
            dry: false,
        }
    }
}
