//! Which request a message is, or answers.

use crate::listed::listed;
use crate::version::Version;

listed!(
    /// Requests. Their codes depend on the version.
    Kind, "request", {
        /// First of all: version, port for the states.
        Connect = "Connect",
        /// Starts a motion; two replies.
        Move = "Move",
        /// Stops it at once.
        StopMove = "StopMove",
        /// A virtual wall.
        GetCartesianLimit = "GetCartesianLimit" in V5..V5,
        /// Thresholds of contact and collision.
        SetCollisionBehavior = "SetCollisionBehavior",
        /// Stiffness of the joint impedance controller.
        SetJointImpedance = "SetJointImpedance",
        /// Stiffness of the Cartesian impedance controller.
        SetCartesianImpedance = "SetCartesianImpedance",
        /// What moves when the arm is guided by hand.
        SetGuidingMode = "SetGuidingMode",
        /// Stiffness frame.
        SetEeToK = "SetEEToK",
        /// End effector.
        SetNeToEe = "SetNEToEE",
        /// Load.
        SetLoad = "SetLoad",
        /// Filters of what is commanded.
        SetFilters = "SetFilters" in V5..V5,
        /// Back to idle from a reflex.
        AutomaticErrorRecovery = "AutomaticErrorRecovery",
        /// Native code of the robot's model.
        LoadModelLibrary = "LoadModelLibrary" in V5..V9,
        /// The robot's model as URDF.
        GetRobotModel = "GetRobotModel" in V8..V10,
    }
);

impl Kind {
    /// Bytes of a request behind its header.
    #[must_use]
    pub const fn request_len(self, version: Version) -> usize {
        match self {
            Self::Connect | Self::GetCartesianLimit => 4,
            Self::Move if version.has_asynchronous() => 113,
            Self::Move | Self::SetJointImpedance => 56,
            Self::StopMove | Self::AutomaticErrorRecovery | Self::GetRobotModel => 0,
            Self::SetCollisionBehavior => 416,
            Self::SetCartesianImpedance => 48,
            Self::SetGuidingMode => 7,
            Self::SetEeToK | Self::SetNeToEe => 128,
            Self::SetLoad => 104,
            Self::SetFilters => 40,
            Self::LoadModelLibrary => 2,
        }
    }

    /// Bytes of a reply behind its header; robots may send more.
    #[must_use]
    pub const fn reply_len(self) -> usize {
        match self {
            Self::Connect => 3,
            Self::GetCartesianLimit => 154,
            _ => 1,
        }
    }
}
