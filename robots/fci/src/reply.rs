//! Replies: what the robot says to requests over TCP.
//!
//! A payload is a status in a byte and what follows it in the variants of [`Reply`], little
//! endian, reals in binary64.

use crate::bytes::{Reader, Writer};
use crate::error::Error;
use crate::kind::Kind;
use crate::state::Pose;
use crate::status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus,
    StopMoveStatus,
};
use crate::stream::{Message, emit};
use crate::version::Version;

/// A reply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reply<'a> {
    /// To Connect.
    Connect {
        /// What came out.
        status: ConnectStatus,
        /// Version of the robot. Behind *success* it need not be looked at: the vendor's client
        /// does not, and there are emulators that have it one byte later.
        version: u16,
    },
    /// To Move, twice.
    Move(MoveStatus),
    /// To StopMove.
    StopMove(StopMoveStatus),
    /// To GetCartesianLimit.
    CartesianLimit {
        /// What came out.
        status: SetterStatus,
        /// The wall.
        limit: CartesianLimit,
    },
    /// To a setter.
    Setter {
        /// Which one.
        setter: Setter,
        /// What came out.
        status: SetterStatus,
    },
    /// To AutomaticErrorRecovery.
    Recovery(RecoveryStatus),
    /// To LoadModelLibrary.
    ModelLibrary {
        /// What came out.
        status: LibraryStatus,
        /// A shared object, as far as the receiver's buffer has it.
        library: &'a [u8],
    },
    /// To GetRobotModel.
    RobotModel {
        /// What came out.
        status: ModelStatus,
        /// URDF in UTF-8 without an end mark, as far as the receiver's buffer has it.
        urdf: &'a [u8],
    },
}

/// Requests that set something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
#[allow(missing_docs)] // those of `Kind`
pub enum Setter {
    CollisionBehavior,
    JointImpedance,
    CartesianImpedance,
    GuidingMode,
    EeToK,
    NeToEe,
    Load,
    Filters,
}

impl Setter {
    /// All.
    pub const ALL: [Self; 8] = [
        Self::CollisionBehavior,
        Self::JointImpedance,
        Self::CartesianImpedance,
        Self::GuidingMode,
        Self::EeToK,
        Self::NeToEe,
        Self::Load,
        Self::Filters,
    ];

    /// Its request.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::CollisionBehavior => Kind::SetCollisionBehavior,
            Self::JointImpedance => Kind::SetJointImpedance,
            Self::CartesianImpedance => Kind::SetCartesianImpedance,
            Self::GuidingMode => Kind::SetGuidingMode,
            Self::EeToK => Kind::SetEeToK,
            Self::NeToEe => Kind::SetNeToEe,
            Self::Load => Kind::SetLoad,
            Self::Filters => Kind::SetFilters,
        }
    }

    /// The setter of a request, if it is one.
    #[must_use]
    pub fn of(kind: Kind) -> Option<Self> {
        Self::ALL.into_iter().find(|setter| setter.kind() == kind)
    }
}

/// A virtual wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CartesianLimit {
    /// Size of the box \[m\].
    pub size: [f64; 3],
    /// Its centre.
    pub frame: Pose,
    /// Whether it holds.
    pub active: bool,
}

impl<'a> Reply<'a> {
    /// Which request it answers.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Connect { .. } => Kind::Connect,
            Self::Move(_) => Kind::Move,
            Self::StopMove(_) => Kind::StopMove,
            Self::CartesianLimit { .. } => Kind::GetCartesianLimit,
            Self::Setter { setter, .. } => setter.kind(),
            Self::Recovery(_) => Kind::AutomaticErrorRecovery,
            Self::ModelLibrary { .. } => Kind::LoadModelLibrary,
            Self::RobotModel { .. } => Kind::GetRobotModel,
        }
    }

    /// Everything in a message that a robot has sent. Bytes behind what a reply has are not
    /// looked at: some robots fill up.
    ///
    /// # Errors
    /// An answer to a request that this version does not have, too short a payload, a status
    /// that means nothing, a truth value that is neither 0 nor 1.
    pub fn parse(version: Version, message: &Message<'a>) -> Result<Self, Error> {
        let kind = message.kind(version, |kind| (kind.reply_len(), usize::MAX))?;
        let mut from = Reader::new(message.payload);
        let status = u32::from(from.u8());
        if let Some(setter) = Setter::of(kind) {
            let status = SetterStatus::from_code(version, status)?;
            return Ok(Self::Setter { setter, status });
        }
        Ok(match kind {
            Kind::Connect => Self::Connect {
                status: ConnectStatus::from_code(version, status)?,
                version: from.u16(),
            },
            Kind::Move => Self::Move(MoveStatus::from_code(version, status)?),
            Kind::StopMove => Self::StopMove(StopMoveStatus::from_code(version, status)?),
            Kind::GetCartesianLimit => Self::CartesianLimit {
                status: SetterStatus::from_code(version, status)?,
                limit: CartesianLimit {
                    size: from.reals(),
                    frame: from.reals(),
                    active: from.bool("object_activation")?,
                },
            },
            Kind::LoadModelLibrary => Self::ModelLibrary {
                status: LibraryStatus::from_code(version, status)?,
                library: from.rest(),
            },
            Kind::GetRobotModel => Self::RobotModel {
                status: ModelStatus::from_code(version, status)?,
                urdf: from.rest(),
            },
            // The setters are above.
            _ => Self::Recovery(RecoveryStatus::from_code(version, status)?),
        })
    }

    /// The message: the first bytes of `bytes`; `id` is that of the request.
    ///
    /// # Errors
    /// A request, or a status, that this version does not have; too short a buffer.
    pub fn emit<'b>(
        &self,
        version: Version,
        id: u32,
        bytes: &'b mut [u8],
    ) -> Result<&'b [u8], Error> {
        let code = self.kind().code(version)?;
        emit(code, id, bytes, |to| self.write(version, to))
    }

    fn write(&self, version: Version, to: &mut Writer<'_>) -> Result<(), Error> {
        let status = match self {
            Self::Connect { status, .. } => status.code(version)?,
            Self::Move(status) => status.code(version)?,
            Self::StopMove(status) => status.code(version)?,
            Self::CartesianLimit { status, .. } | Self::Setter { status, .. } => {
                status.code(version)?
            }
            Self::Recovery(status) => status.code(version)?,
            Self::ModelLibrary { status, .. } => status.code(version)?,
            Self::RobotModel { status, .. } => status.code(version)?,
        };
        // Every status is below 256.
        to.u8(status as u8);
        match self {
            Self::Connect { version, .. } => to.u16(*version),
            Self::CartesianLimit { limit, .. } => {
                to.reals(&limit.size);
                to.reals(&limit.frame);
                to.bools(&[limit.active]);
            }
            Self::ModelLibrary { library, .. } => to.slice(library),
            Self::RobotModel { urdf, .. } => to.slice(urdf),
            Self::Move(_) | Self::StopMove(_) | Self::Setter { .. } | Self::Recovery(_) => {}
        }
        Ok(())
    }
}
