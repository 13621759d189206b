//! Arms and tools as plain structs: every table of the crate `arms`, and tables of one's own.

use core::ffi::c_char;
use core::mem::MaybeUninit;

use arms::LWR_IV;
use controller_core::arm::{
    ArmError, ArmParameters, EndApproach, Friction, JointLimits, LinkParameters, Pose, Tool,
};
use controller_core::{ConfigError, Controller, ControllerConfig, MakeController};

use crate::scalar::Scalar;

/// Joints of an arm.
pub const STRATUM_JOINTS: usize = 7;
/// Bytes of a name, its end included.
pub const STRATUM_NAME_SIZE: usize = 24;

/// Pose of a frame in a parent frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumPose {
    /// Takes axes of the frame to those of the parent: its columns are the frame's axes.
    pub rotation: [[f64; 3]; 3],
    /// Origin of the frame, axes of the parent, m.
    pub shift: [f64; 3],
}

/// Friction of a joint: coulomb tanh(dq / smoothing) + viscous dq.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumFriction {
    /// Nm.
    pub coulomb: f64,
    /// Nms/rad.
    pub viscous: f64,
    /// Speed within which the Coulomb part changes its sign, rad/s; above 0.
    pub smoothing: f64,
}

/// What a data sheet allows near the ends of the range: towards an end at most
/// -margin + sqrt(2 deceleration x the way to that end). None where the deceleration is 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumEndApproach {
    /// Speed that is taken off, rad/s.
    pub margin: f64,
    /// rad/s2.
    pub deceleration: f64,
    /// The ends, rad.
    pub ends: [f64; 2],
}

/// Tables of one link and of the joint that moves it, by the standard
/// Denavit-Hartenberg convention.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumLink {
    /// The maker's name of the joint, for the caller's logs; not read.
    pub name: [c_char; STRATUM_NAME_SIZE],
    /// Length along the new x axis, m.
    pub a: f64,
    /// Twist about the new x axis, rad.
    pub alpha: f64,
    /// Offset along the joint axis, m.
    pub d: f64,
    /// Angle about the joint axis at q = 0, rad.
    pub angle_offset: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the link's frame, m.
    pub com: [f64; 3],
    /// Inertia about the centre of mass, axes of the link's frame, kg m2:
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
    /// Inertia of the rotor as the joint feels it, gear ratio squared, kg m2.
    pub rotor_inertia: f64,
    /// Friction.
    pub friction: StratumFriction,
    /// Smallest and largest q, rad.
    pub position_range: [f64; 2],
    /// Largest |dq| of the data sheet, rad/s.
    pub speed_limit: f64,
    /// What the data sheet allows near the ends of the range.
    pub end_approach: StratumEndApproach,
    /// Largest |torque|, Nm.
    pub torque_limit: f64,
    /// Largest change of the torque while the law runs, Nm/s.
    pub torque_rate_limit: f64,
    /// The same while the arm is braked after a fault, Nm/s.
    pub brake_rate_limit: f64,
}

/// How the law keeps joints within their ranges and speed limits. All zeros: a rule makes it
/// from the rest of the tables.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumJointLimits {
    /// Largest acceleration that is asked of a joint, rad/s2.
    pub acceleration: [f64; STRATUM_JOINTS],
    /// Braking before the end of a range, rad/s2.
    pub braking: [f64; STRATUM_JOINTS],
    /// How fast the speed of a joint comes to what it may be, 1/s.
    pub speed_gain: [f64; STRATUM_JOINTS],
    /// How fast the last bit of the way to an end is gone, 1/s.
    pub position_gain: f64,
    /// So far before the end of its range a joint stops, rad.
    pub margin: f64,
    /// Share of the speed limit that a joint may use.
    pub speed_share: f64,
}

impl StratumJointLimits {
    const BY_RULE: Self = Self {
        acceleration: [0.0; STRATUM_JOINTS],
        braking: [0.0; STRATUM_JOINTS],
        speed_gain: [0.0; STRATUM_JOINTS],
        position_gain: 0.0,
        margin: 0.0,
        speed_share: 0.0,
    };

    const fn new(limits: Option<&JointLimits>) -> Self {
        match limits {
            None => Self::BY_RULE,
            Some(limits) => Self {
                acceleration: limits.acceleration,
                braking: limits.braking,
                speed_gain: limits.speed_gain,
                position_gain: limits.position_gain,
                margin: limits.margin,
                speed_share: limits.speed_share,
            },
        }
    }

    fn limits(&self) -> Option<JointLimits> {
        (*self != Self::BY_RULE).then_some(JointLimits {
            acceleration: self.acceleration,
            braking: self.braking,
            speed_gain: self.speed_gain,
            position_gain: self.position_gain,
            margin: self.margin,
            speed_share: self.speed_share,
        })
    }
}

/// Tables of an arm and how it is mounted.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumArm {
    /// Its name, for the caller's logs; not read.
    pub name: [c_char; STRATUM_NAME_SIZE],
    /// Pose of frame 0 in the base-plate frame: how the arm is mounted.
    pub base: StratumPose,
    /// Pose of the flange in frame 7.
    pub flange: StratumPose,
    /// Gravitational acceleration, base-plate axes, m/s2.
    pub gravity: [f64; 3],
    /// Links, base to flange.
    pub links: [StratumLink; STRATUM_JOINTS],
    /// What the law may do with the joints.
    pub limits: StratumJointLimits,
}

/// A tool, gripper or load fixed to the flange. Without mass and inertia it is only a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StratumTool {
    /// Pose of the tool frame in the flange.
    pub pose: StratumPose,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the tool frame, m.
    pub com: [f64; 3],
    /// Inertia about the centre of mass, axes of the tool frame, kg m2:
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
}

impl StratumPose {
    const IDENTITY: Self = Self::new(&Pose::IDENTITY);

    const fn new(pose: &Pose) -> Self {
        Self {
            rotation: pose.rotation,
            shift: pose.shift,
        }
    }

    pub(crate) fn pose(&self) -> Pose {
        Pose {
            rotation: self.rotation,
            shift: self.shift,
        }
    }
}

/// As much of a name as there is place for, with a zero behind it.
const fn name(text: &str) -> [c_char; STRATUM_NAME_SIZE] {
    let (mut name, text) = ([0; STRATUM_NAME_SIZE], text.as_bytes());
    let mut i = 0;
    while i < text.len() && i < STRATUM_NAME_SIZE - 1 {
        name[i] = text[i] as c_char;
        i += 1;
    }
    name
}

impl StratumLink {
    const fn new(link: &LinkParameters) -> Self {
        let end_approach = match link.end_approach {
            Some(EndApproach {
                margin,
                deceleration,
                ends,
            }) => StratumEndApproach {
                margin,
                deceleration,
                ends,
            },
            None => StratumEndApproach {
                margin: 0.0,
                deceleration: 0.0,
                ends: [0.0; 2],
            },
        };
        Self {
            name: name(link.name),
            a: link.a,
            alpha: link.alpha,
            d: link.d,
            angle_offset: link.angle_offset,
            mass: link.mass,
            com: link.com,
            inertia: link.inertia,
            rotor_inertia: link.rotor_inertia,
            friction: StratumFriction {
                coulomb: link.friction.coulomb,
                viscous: link.friction.viscous,
                smoothing: link.friction.smoothing,
            },
            position_range: link.position_range,
            speed_limit: link.speed_limit,
            end_approach,
            torque_limit: link.torque_limit,
            torque_rate_limit: link.torque_rate_limit,
            brake_rate_limit: link.brake_rate_limit,
        }
    }

    fn parameters(&self) -> LinkParameters {
        let StratumEndApproach {
            margin,
            deceleration,
            ends,
        } = self.end_approach;
        LinkParameters {
            name: "joint",
            a: self.a,
            alpha: self.alpha,
            d: self.d,
            angle_offset: self.angle_offset,
            mass: self.mass,
            com: self.com,
            inertia: self.inertia,
            rotor_inertia: self.rotor_inertia,
            friction: Friction {
                coulomb: self.friction.coulomb,
                viscous: self.friction.viscous,
                smoothing: self.friction.smoothing,
            },
            position_range: self.position_range,
            speed_limit: self.speed_limit,
            end_approach: (deceleration != 0.0).then_some(EndApproach {
                margin,
                deceleration,
                ends,
            }),
            torque_limit: self.torque_limit,
            torque_rate_limit: self.torque_rate_limit,
            brake_rate_limit: self.brake_rate_limit,
        }
    }
}

impl StratumArm {
    pub(crate) const fn new(arm: &ArmParameters) -> Self {
        let [first, second, third, fourth, fifth, sixth, seventh] = &arm.links;
        Self {
            name: name(arm.name),
            base: StratumPose::new(&arm.base),
            flange: StratumPose::new(&arm.flange),
            gravity: arm.gravity,
            links: [
                StratumLink::new(first),
                StratumLink::new(second),
                StratumLink::new(third),
                StratumLink::new(fourth),
                StratumLink::new(fifth),
                StratumLink::new(sixth),
                StratumLink::new(seventh),
            ],
            limits: StratumJointLimits::new(arm.limits.as_ref()),
        }
    }

    /// With a tool. Behind a call, and link by link: work sets take turns on the stack.
    #[inline(never)]
    fn parameters(&self, tool: &StratumTool) -> ArmParameters {
        let mut arm = ArmParameters {
            name: "settings",
            base: self.base.pose(),
            flange: self.flange.pose(),
            points: &[],
            limits: self.limits.limits(),
            damping_postures: &[],
            gravity: self.gravity,
            links: LWR_IV.links,
        };
        for (link, own) in arm.links.iter_mut().zip(&self.links) {
            *link = own.parameters();
        }
        if tool.mass > 0.0 {
            arm = arm.with_tool(&tool.tool());
        }
        arm
    }

    /// Makes a controller of the arm with its tool in its place.
    #[inline(never)]
    pub(crate) fn controller<'a>(
        &self,
        law: MakeController<Scalar>,
        tool: &StratumTool,
        config: &ControllerConfig,
        place: &'a mut MaybeUninit<Controller<Scalar>>,
    ) -> Result<&'a mut Controller<Scalar>, ConfigError> {
        match law(&self.parameters(tool), config) {
            Ok(controller) => Ok(place.write(controller)),
            Err(error) => Err(error),
        }
    }
}

impl StratumTool {
    /// None: the tool frame is the flange.
    pub(crate) const NONE: Self = Self {
        pose: StratumPose::IDENTITY,
        mass: 0.0,
        com: [0.0; 3],
        inertia: [0.0; 6],
    };

    fn tool(&self) -> Tool {
        Tool {
            pose: self.pose.pose(),
            mass: self.mass,
            com: self.com,
            inertia: self.inertia,
        }
    }

    /// Whether a body can have these numbers, or without mass a frame.
    #[inline(never)]
    pub(crate) fn validate(&self) -> Result<(), ArmError> {
        self.tool().validate()
    }
}
