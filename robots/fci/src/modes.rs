//! What the robot is doing, and what it can be asked to do.

use crate::listed::listed;

listed!(
    /// State of the robot.
    #[derive(Default)]
    RobotMode, "robot mode", {
        /// Brakes, start-up, or nothing of the others.
        #[default]
        Other = "other",
        /// Takes a Move.
        Idle = "idle",
        /// A motion runs.
        Move = "move",
        /// Guided by hand.
        Guiding = "guiding",
        /// A motion was aborted; AutomaticErrorRecovery leads back to idle.
        Reflex = "reflex",
        /// The external enabling device is let go.
        UserStopped = "user stopped",
        /// On the way back.
        AutomaticErrorRecovery = "automatic error recovery",
    }
);

listed!(
    /// Motion generator that runs, as the state has it.
    #[derive(Default)]
    MotionGeneratorMode, "motion generator mode", {
        /// No motion.
        #[default]
        Idle = "idle",
        JointPosition = "joint position",
        JointVelocity = "joint velocity",
        CartesianPosition = "cartesian position",
        CartesianVelocity = "cartesian velocity",
        /// A motion of torque alone.
        None = "none" in V6..V10,
    }
);

listed!(
    /// Controller that runs, as the state has it.
    #[derive(Default)]
    ControllerMode, "controller mode", {
        JointImpedance = "joint impedance",
        CartesianImpedance = "cartesian impedance",
        /// Torque of the client.
        External = "external",
        /// No motion.
        #[default]
        Other = "other",
    }
);

listed!(
    /// Motion generator that Move asks for. Its codes are not those of
    /// [`MotionGeneratorMode`].
    Generator, "motion generator of Move", {
        JointPosition = "joint position",
        JointVelocity = "joint velocity",
        CartesianPosition = "cartesian position",
        CartesianVelocity = "cartesian velocity",
        /// Torque alone.
        None = "none" in V6..V10,
    }
);

listed!(
    /// Controller that Move asks for.
    Controller, "controller of Move", {
        JointImpedance = "joint impedance",
        CartesianImpedance = "cartesian impedance",
        /// Torque of the client.
        External = "external",
    }
);

impl From<Generator> for MotionGeneratorMode {
    /// What the state has while the generator runs.
    fn from(generator: Generator) -> Self {
        match generator {
            Generator::JointPosition => Self::JointPosition,
            Generator::JointVelocity => Self::JointVelocity,
            Generator::CartesianPosition => Self::CartesianPosition,
            Generator::CartesianVelocity => Self::CartesianVelocity,
            Generator::None => Self::None,
        }
    }
}

impl From<Controller> for ControllerMode {
    /// What the state has while the controller runs.
    fn from(controller: Controller) -> Self {
        match controller {
            Controller::JointImpedance => Self::JointImpedance,
            Controller::CartesianImpedance => Self::CartesianImpedance,
            Controller::External => Self::External,
        }
    }
}
