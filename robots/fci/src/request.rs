//! Requests: what the client asks of the robot over TCP.
//!
//! Payloads are the fields of the types here in their order, little endian, reals in
//! binary64, truth values in a byte, codes of Move in 4 and of LoadModelLibrary in 1.

use core::f64::consts::TAU;

use crate::bytes::{Reader, Writer, check_finite};
use crate::error::Error;
use crate::kind::Kind;
use crate::listed::listed;
use crate::modes::{Controller, Generator};
use crate::state::{DOF, Pose};
use crate::stream::{Message, emit};
use crate::version::Version;

/// A request.
#[allow(clippy::large_enum_variant)] // there is no box
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// First of all.
    Connect(Connect),
    /// Starts a motion.
    Move(Move),
    /// Stops it at once.
    StopMove,
    /// Asks for a virtual wall.
    GetCartesianLimit {
        /// Number of the wall.
        limit: i32,
    },
    /// Thresholds of contact and collision.
    SetCollisionBehavior(CollisionBehavior),
    /// Stiffness of the joints \[Nm/rad\], 0 to 14250.
    SetJointImpedance([f64; DOF]),
    /// Stiffness along x y z \[N/m\], 10 to 3000, and about them \[Nm/rad\], 1 to 300.
    SetCartesianImpedance([f64; 6]),
    /// What moves by hand.
    SetGuidingMode(GuidingMode),
    /// Stiffness frame in the end effector.
    SetEeToK(Pose),
    /// End effector in the nominal end effector.
    SetNeToEe(Pose),
    /// Load.
    SetLoad(Load),
    /// Cut-off frequencies \[Hz\] of what is commanded: joint positions, joint speeds,
    /// Cartesian positions, Cartesian speeds, the controller.
    SetFilters([f64; 5]),
    /// Back to idle from a reflex.
    AutomaticErrorRecovery,
    /// Asks for native code of the robot's model.
    LoadModelLibrary {
        /// Processor.
        architecture: Architecture,
        /// Operating system.
        system: System,
    },
    /// Asks for the robot's model as URDF.
    GetRobotModel,
}

/// Connect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Connect {
    /// Version of the client.
    pub version: u16,
    /// Port of the client that states go to.
    pub udp_port: u16,
}

/// Move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Who turns the wanted motion into torque.
    pub controller: Controller,
    /// What the client commands.
    pub generator: Generator,
    /// How far the arm may be from its path: \[m\], \[rad\], elbow \[rad\].
    pub maximum_path_deviation: [f64; 3],
    /// How far it may be from its goal: \[m\], \[rad\], elbow \[rad\].
    pub maximum_goal_pose_deviation: [f64; 3],
    /// Commands need not come every cycle; before version 10 it is not sent.
    pub use_async_motion_generator: bool,
    /// Joint speeds of that \[rad/s\]; before version 10 they are not sent.
    pub maximum_velocity: [f64; DOF],
}

impl Move {
    /// A motion, with the deviations that the vendor's client always sends.
    #[must_use]
    pub const fn new(controller: Controller, generator: Generator) -> Self {
        let deviation = [10.0, 3.12, TAU];
        Self {
            controller,
            generator,
            maximum_path_deviation: deviation,
            maximum_goal_pose_deviation: deviation,
            use_async_motion_generator: false,
            maximum_velocity: [0.0; DOF],
        }
    }

    /// A motion of torque alone, as the vendor's client asks for it: up to version 9 with
    /// joint speeds of 0 beside the torque.
    #[must_use]
    pub const fn torque(version: Version) -> Self {
        let generator = if version.has_torque_alone() {
            Generator::None
        } else {
            Generator::JointVelocity
        };
        Self::new(Controller::External, generator)
    }
}

/// Thresholds: above the lower one there is contact, above the upper one a collision, by which
/// the motion is aborted; *acceleration* while a motion speeds up or slows down, *nominal* else.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // by their names
pub struct CollisionBehavior {
    /// \[Nm\].
    pub lower_torque_acceleration: [f64; DOF],
    pub upper_torque_acceleration: [f64; DOF],
    pub lower_torque_nominal: [f64; DOF],
    pub upper_torque_nominal: [f64; DOF],
    /// Along x y z \[N\] and about them \[Nm\].
    pub lower_force_acceleration: [f64; 6],
    pub upper_force_acceleration: [f64; 6],
    pub lower_force_nominal: [f64; 6],
    pub upper_force_nominal: [f64; 6],
}

/// What moves when the arm is guided by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct GuidingMode {
    /// Along x y z and about them.
    pub axes: [bool; 6],
    /// The elbow.
    pub null_space: bool,
}

/// A load on the flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass \[kg\].
    pub m_load: f64,
    /// Centre of mass in the flange frame \[m\].
    pub f_x_cload: [f64; 3],
    /// Inertia about it \[kg m2\], 3 by 3, column by column.
    pub i_load: [f64; 9],
}

listed!(
    /// Processor of a model library.
    Architecture, "architecture of LoadModelLibrary", {
        X64 = "x64",
        X86 = "x86",
        Arm = "ARM",
        Arm64 = "ARM64",
    }
);

listed!(
    /// Operating system of a model library.
    System, "system of LoadModelLibrary", {
        Linux = "Linux",
        Windows = "Windows",
    }
);

impl Request {
    /// Which one it is.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Connect(_) => Kind::Connect,
            Self::Move(_) => Kind::Move,
            Self::StopMove => Kind::StopMove,
            Self::GetCartesianLimit { .. } => Kind::GetCartesianLimit,
            Self::SetCollisionBehavior(_) => Kind::SetCollisionBehavior,
            Self::SetJointImpedance(_) => Kind::SetJointImpedance,
            Self::SetCartesianImpedance(_) => Kind::SetCartesianImpedance,
            Self::SetGuidingMode(_) => Kind::SetGuidingMode,
            Self::SetEeToK(_) => Kind::SetEeToK,
            Self::SetNeToEe(_) => Kind::SetNeToEe,
            Self::SetLoad(_) => Kind::SetLoad,
            Self::SetFilters(_) => Kind::SetFilters,
            Self::AutomaticErrorRecovery => Kind::AutomaticErrorRecovery,
            Self::LoadModelLibrary { .. } => Kind::LoadModelLibrary,
            Self::GetRobotModel => Kind::GetRobotModel,
        }
    }

    /// Everything in a message that a client has sent, reals as they are. A robot reads
    /// Connect with its own version: it is the same in all.
    ///
    /// # Errors
    /// A request that this version does not have, another length, a code that means nothing,
    /// a truth value that is neither 0 nor 1.
    pub fn parse(version: Version, message: &Message<'_>) -> Result<Self, Error> {
        let kind = message.kind(version, |kind| {
            let len = kind.request_len(version);
            (len, len)
        })?;
        let mut from = Reader::new(message.payload);
        let from = &mut from;
        Ok(match kind {
            Kind::Connect => Self::Connect(Connect {
                version: from.u16(),
                udp_port: from.u16(),
            }),
            Kind::Move => Self::Move(Move {
                controller: Controller::from_code(version, from.u32())?,
                generator: Generator::from_code(version, from.u32())?,
                maximum_path_deviation: from.reals(),
                maximum_goal_pose_deviation: from.reals(),
                use_async_motion_generator: version.has_asynchronous()
                    && from.bool("use_async_motion_generator")?,
                // Zeros where there are none.
                maximum_velocity: from.reals(),
            }),
            Kind::StopMove => Self::StopMove,
            Kind::GetCartesianLimit => Self::GetCartesianLimit {
                limit: from.u32().cast_signed(),
            },
            Kind::SetCollisionBehavior => Self::SetCollisionBehavior(CollisionBehavior {
                lower_torque_acceleration: from.reals(),
                upper_torque_acceleration: from.reals(),
                lower_torque_nominal: from.reals(),
                upper_torque_nominal: from.reals(),
                lower_force_acceleration: from.reals(),
                upper_force_acceleration: from.reals(),
                lower_force_nominal: from.reals(),
                upper_force_nominal: from.reals(),
            }),
            Kind::SetJointImpedance => Self::SetJointImpedance(from.reals()),
            Kind::SetCartesianImpedance => Self::SetCartesianImpedance(from.reals()),
            Kind::SetGuidingMode => Self::SetGuidingMode(GuidingMode {
                axes: from.bools("guiding_mode")?,
                null_space: from.bool("nullspace")?,
            }),
            Kind::SetEeToK => Self::SetEeToK(from.reals()),
            Kind::SetNeToEe => Self::SetNeToEe(from.reals()),
            Kind::SetLoad => Self::SetLoad(Load {
                m_load: from.real(),
                f_x_cload: from.reals(),
                i_load: from.reals(),
            }),
            Kind::SetFilters => Self::SetFilters(from.reals()),
            Kind::AutomaticErrorRecovery => Self::AutomaticErrorRecovery,
            Kind::LoadModelLibrary => Self::LoadModelLibrary {
                architecture: Architecture::from_code(version, from.u8().into())?,
                system: System::from_code(version, from.u8().into())?,
            },
            Kind::GetRobotModel => Self::GetRobotModel,
        })
    }

    /// The message: the first bytes of `bytes`, of which
    /// [`REQUEST_LEN_MAX`](crate::stream::REQUEST_LEN_MAX) are enough for all. Reals are sent
    /// as they are.
    ///
    /// # Errors
    /// A request, or a generator, that this version does not have; too short a buffer.
    pub fn emit<'a>(
        &self,
        version: Version,
        id: u32,
        bytes: &'a mut [u8],
    ) -> Result<&'a [u8], Error> {
        let code = self.kind().code(version)?;
        emit(code, id, bytes, |to| self.write(version, to))
    }

    fn write(&self, version: Version, to: &mut Writer<'_>) -> Result<(), Error> {
        match self {
            Self::StopMove | Self::AutomaticErrorRecovery | Self::GetRobotModel => {}
            Self::Connect(connect) => {
                to.u16(connect.version);
                to.u16(connect.udp_port);
            }
            Self::Move(motion) => {
                to.u32(motion.controller.code(version)?);
                to.u32(motion.generator.code(version)?);
                to.reals(&motion.maximum_path_deviation);
                to.reals(&motion.maximum_goal_pose_deviation);
                if version.has_asynchronous() {
                    to.bools(&[motion.use_async_motion_generator]);
                    to.reals(&motion.maximum_velocity);
                }
            }
            Self::GetCartesianLimit { limit } => to.put(limit.to_le_bytes()),
            Self::SetCollisionBehavior(behavior) => {
                for (_, thresholds) in behavior.fields() {
                    to.reals(thresholds);
                }
            }
            Self::SetJointImpedance(stiffness) => to.reals(stiffness),
            Self::SetCartesianImpedance(stiffness) => to.reals(stiffness),
            Self::SetGuidingMode(mode) => {
                to.bools(&mode.axes);
                to.bools(&[mode.null_space]);
            }
            Self::SetEeToK(pose) | Self::SetNeToEe(pose) => to.reals(pose),
            Self::SetLoad(load) => {
                to.reals(&[load.m_load]);
                to.reals(&load.f_x_cload);
                to.reals(&load.i_load);
            }
            Self::SetFilters(frequencies) => to.reals(frequencies),
            Self::LoadModelLibrary {
                architecture,
                system,
            } => {
                // Both codes are below 256.
                to.u8(architecture.code(version)? as u8);
                to.u8(system.code(version)? as u8);
            }
        }
        Ok(())
    }

    /// Whether the numbers in it are finite and, where the vendor says a range, within it. A
    /// client asks before it sends; a robot answers *invalid argument* to what does not pass.
    ///
    /// # Errors
    /// The first number that is not.
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::Connect(_)
            | Self::StopMove
            | Self::GetCartesianLimit { .. }
            | Self::SetGuidingMode(_)
            | Self::AutomaticErrorRecovery
            | Self::LoadModelLibrary { .. }
            | Self::GetRobotModel => Ok(()),
            Self::Move(motion) => {
                check_finite("maximum_path_deviation", &motion.maximum_path_deviation)?;
                check_finite(
                    "maximum_goal_pose_deviation",
                    &motion.maximum_goal_pose_deviation,
                )?;
                check_finite("maximum_velocity", &motion.maximum_velocity)
            }
            Self::SetCollisionBehavior(behavior) => {
                let mut fields = behavior.fields().into_iter();
                fields.try_for_each(|(field, values)| check_finite(field, values))
            }
            Self::SetJointImpedance(stiffness) => {
                check_range("K_theta", 0, stiffness, 0.0, 14_250.0)
            }
            Self::SetCartesianImpedance([x, y, z, about @ ..]) => {
                check_range("K_x", 0, &[*x, *y, *z], 10.0, 3000.0)?;
                check_range("K_x", 3, about, 1.0, 300.0)
            }
            Self::SetEeToK(pose) => check_finite("EE_T_K", pose),
            Self::SetNeToEe(pose) => check_finite("NE_T_EE", pose),
            Self::SetLoad(load) => {
                check_finite("m_load", &[load.m_load])?;
                check_finite("F_x_Cload", &load.f_x_cload)?;
                check_finite("I_load", &load.i_load)
            }
            Self::SetFilters(frequencies) => check_finite("cut-off frequency", frequencies),
        }
    }
}

impl CollisionBehavior {
    /// In the order of the wire.
    fn fields(&self) -> [(&'static str, &[f64]); 8] {
        [
            (
                "lower_torque_acceleration",
                &self.lower_torque_acceleration[..],
            ),
            ("upper_torque_acceleration", &self.upper_torque_acceleration),
            ("lower_torque_nominal", &self.lower_torque_nominal),
            ("upper_torque_nominal", &self.upper_torque_nominal),
            ("lower_force_acceleration", &self.lower_force_acceleration),
            ("upper_force_acceleration", &self.upper_force_acceleration),
            ("lower_force_nominal", &self.lower_force_nominal),
            ("upper_force_nominal", &self.upper_force_nominal),
        ]
    }
}

/// Whether numbers are in a range; `first` is the index of the first.
fn check_range(
    field: &'static str,
    first: usize,
    values: &[f64],
    min: f64,
    max: f64,
) -> Result<(), Error> {
    for (i, &found) in values.iter().enumerate() {
        let index = first + i;
        if !found.is_finite() {
            return Err(Error::NotFinite { field, index });
        }
        if !(min..=max).contains(&found) {
            return Err(Error::Range {
                field,
                index,
                found,
                min,
                max,
            });
        }
    }
    Ok(())
}
