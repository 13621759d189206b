//! What the robot says to a request.

use crate::listed::listed;

listed!(
    /// Reply to Connect.
    ConnectStatus, "status of Connect", {
        /// States follow.
        Success = "success",
        /// The robot has another version, which the reply names.
        IncompatibleVersion = "incompatible version",
    }
);

listed!(
    /// Reply to the setters and to GetCartesianLimit.
    SetterStatus, "status of a setter", {
        Success = "success",
        /// For instance in a motion.
        NotPossible = "not possible",
        InvalidArgument = "invalid argument",
        Rejected = "rejected by a safety function" in V6..V10,
    }
);

listed!(
    /// Reply to GetRobotModel.
    ModelStatus, "status of GetRobotModel", {
        Success = "success",
        NotPossible = "not possible",
        Rejected = "rejected by a safety function",
    }
);

listed!(
    /// Reply to LoadModelLibrary.
    LibraryStatus, "status of LoadModelLibrary", {
        Success = "success",
        Error = "error",
    }
);

listed!(
    /// Replies to Move: one at its start, one at its end.
    MoveStatus, "status of Move", {
        /// Ended as the client wished.
        Success = "success",
        /// The first reply, before the state shows the motion. Another one follows.
        MotionStarted = "motion started",
        /// Ended by StopMove.
        Preempted = "preempted",
        PreemptedBySafety = "preempted by a safety function" in V6..V10,
        Rejected = "rejected by a safety function" in V6..V10,
        /// For instance before recovery.
        NotPossible = "not possible",
        StartAtSingularPose = "start at a singular pose",
        InvalidArgument = "invalid argument",
        /// `reflex_reason` of the state says why.
        ReflexAborted = "aborted by a reflex",
        EmergencyAborted = "aborted by the emergency stop",
        InputErrorAborted = "aborted by an input error",
        Aborted = "aborted",
    }
);

listed!(
    /// Reply to StopMove.
    StopMoveStatus, "status of StopMove", {
        Success = "success",
        NotPossible = "not possible",
        Rejected = "rejected by a safety function" in V6..V10,
        EmergencyAborted = "aborted by the emergency stop",
        ReflexAborted = "aborted by a reflex",
        Aborted = "aborted",
    }
);

listed!(
    /// Reply to AutomaticErrorRecovery.
    RecoveryStatus, "status of AutomaticErrorRecovery", {
        Success = "success",
        NotPossible = "not possible",
        Rejected = "rejected by a safety function" in V6..V10,
        /// By hand, in the vendor's web interface.
        ManualRecoveryRequired = "manual recovery required",
        ReflexAborted = "aborted by a reflex",
        EmergencyAborted = "aborted by the emergency stop",
        Aborted = "aborted",
    }
);

impl MoveStatus {
    /// Whether another reply to the same Move follows.
    #[must_use]
    pub fn is_running(self) -> bool {
        self == Self::MotionStarted
    }
}
