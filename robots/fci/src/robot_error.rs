//! What went wrong in the robot, by the vendor's names.

use core::fmt;

use crate::bytes::get;
use crate::listed::listed;

listed!(
    /// An error of the robot; its code is its place in `errors` and `reflex_reason` of the
    /// state.
    RobotError, "robot error", {
        JointPositionLimitsViolation = "joint_position_limits_violation",
        CartesianPositionLimitsViolation = "cartesian_position_limits_violation",
        SelfCollisionAvoidanceViolation = "self_collision_avoidance_violation",
        JointVelocityViolation = "joint_velocity_violation",
        CartesianVelocityViolation = "cartesian_velocity_violation",
        ForceControlSafetyViolation = "force_control_safety_violation",
        JointReflex = "joint_reflex",
        CartesianReflex = "cartesian_reflex",
        MaxGoalPoseDeviationViolation = "max_goal_pose_deviation_violation",
        MaxPathPoseDeviationViolation = "max_path_pose_deviation_violation",
        CartesianVelocityProfileSafetyViolation = "cartesian_velocity_profile_safety_violation",
        JointPositionMotionGeneratorStartPoseInvalid = "joint_position_motion_generator_start_pose_invalid",
        JointMotionGeneratorPositionLimitsViolation = "joint_motion_generator_position_limits_violation",
        JointMotionGeneratorVelocityLimitsViolation = "joint_motion_generator_velocity_limits_violation",
        JointMotionGeneratorVelocityDiscontinuity = "joint_motion_generator_velocity_discontinuity",
        JointMotionGeneratorAccelerationDiscontinuity = "joint_motion_generator_acceleration_discontinuity",
        CartesianPositionMotionGeneratorStartPoseInvalid = "cartesian_position_motion_generator_start_pose_invalid",
        CartesianMotionGeneratorElbowLimitViolation = "cartesian_motion_generator_elbow_limit_violation",
        CartesianMotionGeneratorVelocityLimitsViolation = "cartesian_motion_generator_velocity_limits_violation",
        CartesianMotionGeneratorVelocityDiscontinuity = "cartesian_motion_generator_velocity_discontinuity",
        CartesianMotionGeneratorAccelerationDiscontinuity = "cartesian_motion_generator_acceleration_discontinuity",
        CartesianMotionGeneratorElbowSignInconsistent = "cartesian_motion_generator_elbow_sign_inconsistent",
        CartesianMotionGeneratorStartElbowInvalid = "cartesian_motion_generator_start_elbow_invalid",
        ForceControllerDesiredForceToleranceViolation = "force_controller_desired_force_tolerance_violation",
        StartElbowSignInconsistent = "start_elbow_sign_inconsistent",
        CommunicationConstraintsViolation = "communication_constraints_violation",
        PowerLimitViolation = "power_limit_violation",
        CartesianMotionGeneratorJointPositionLimitsViolation = "cartesian_motion_generator_joint_position_limits_violation",
        CartesianMotionGeneratorJointVelocityLimitsViolation = "cartesian_motion_generator_joint_velocity_limits_violation",
        CartesianMotionGeneratorJointVelocityDiscontinuity = "cartesian_motion_generator_joint_velocity_discontinuity",
        CartesianMotionGeneratorJointAccelerationDiscontinuity = "cartesian_motion_generator_joint_acceleration_discontinuity",
        CartesianPositionMotionGeneratorInvalidFrameFlag = "cartesian_position_motion_generator_invalid_frame_flag",
        ControllerTorqueDiscontinuity = "controller_torque_discontinuity",
        JointP2pInsufficientTorqueForPlanning = "joint_p2p_insufficient_torque_for_planning",
        TauJRangeViolation = "tau_J_range_violation",
        InstabilityDetected = "instability_detected",
        JointMoveInWrongDirection = "joint_move_in_wrong_direction",
        CartesianSplineMotionGeneratorViolation = "cartesian_spline_motion_generator_violation",
        JointViaMotionGeneratorPlanningJointLimitViolation = "joint_via_motion_generator_planning_joint_limit_violation",
        BaseAccelerationInitializationTimeout = "base_acceleration_initialization_timeout",
        BaseAccelerationInvalidReading = "base_acceleration_invalid_reading",
    }
);

/// Errors there are.
pub const COUNT: usize = 41;

/// A set of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct RobotErrors(u64);

impl RobotErrors {
    /// None.
    pub const NONE: Self = Self(0);

    /// One more.
    #[must_use]
    pub const fn with(self, error: RobotError) -> Self {
        Self(self.0 | 1 << error as u64)
    }

    /// Whether it is among them.
    #[must_use]
    pub const fn contains(self, error: RobotError) -> bool {
        self.0 >> error as u64 & 1 == 1
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Bit i is the error with code i.
    #[must_use]
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// In the order of their codes.
    pub fn iter(self) -> impl Iterator<Item = RobotError> {
        RobotError::all().filter(move |&error| self.contains(error))
    }

    /// From bytes of 0 and 1.
    pub(crate) fn read(bytes: &[u8], at: usize) -> Self {
        let bytes = get::<COUNT>(bytes, at).into_iter();
        Self(
            bytes
                .rev()
                .fold(0, |bits, byte| bits << 1 | u64::from(byte & 1)),
        )
    }

    pub(crate) fn bytes(self) -> [u8; COUNT] {
        let mut rest = self.0;
        [0; COUNT].map(|_: u8| {
            let byte = (rest & 1) as u8;
            rest >>= 1;
            byte
        })
    }
}

impl FromIterator<RobotError> for RobotErrors {
    fn from_iter<I: IntoIterator<Item = RobotError>>(errors: I) -> Self {
        errors.into_iter().fold(Self::NONE, Self::with)
    }
}

impl fmt::Display for RobotErrors {
    /// Their names with commas between, or `none`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        for (i, error) in self.iter().enumerate() {
            write!(f, "{}{error}", if i == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}
