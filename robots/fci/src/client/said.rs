//! What the robot says, as far as it was asked.

use crate::error::Error;
use crate::kind::Kind;
use crate::reply::Reply;
use crate::status::{ConnectStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus};
use crate::stream::Message;
use crate::version::Version;

/// A reply that was waited for.
pub(super) enum Said {
    Connect(ConnectStatus, u16),
    Model(ModelStatus),
    Setter(Kind, SetterStatus),
    /// First reply to the Move with this id.
    Started(u32, MoveStatus),
    /// Its second one.
    Ended(MoveStatus),
    Recovery(RecoveryStatus),
}

/// Whether a message answers the request that waits, if that is of this kind.
pub(super) fn is_reply(
    version: Version,
    asked: Option<(u32, Kind)>,
    kind: Kind,
    (id, code): (u32, u32),
) -> bool {
    asked == Some((id, kind)) && kind.code(version) == Ok(code)
}

/// What a message says, if it is a reply that is waited for.
pub(super) fn said(
    version: Version,
    asked: Option<(u32, Kind)>,
    motion: Option<u32>,
    message: &Message<'_>,
) -> Result<Option<Said>, Error> {
    let waiting =
        asked.filter(|&(_, kind)| is_reply(version, asked, kind, (message.id, message.code)));
    let ended = motion.map(|id| (id, Kind::Move));
    let ends = is_reply(version, ended, Kind::Move, (message.id, message.code));
    if waiting.is_none() && !ends {
        return Ok(None);
    }
    Ok(Some(match Reply::parse(version, message)? {
        Reply::Connect { status, version } => Said::Connect(status, version),
        Reply::RobotModel { status, .. } => Said::Model(status),
        Reply::Setter { setter, status } => Said::Setter(setter.kind(), status),
        Reply::Move(status) if ends => Said::Ended(status),
        Reply::Move(status) => Said::Started(message.id, status),
        Reply::Recovery(status) => Said::Recovery(status),
        // None of them is asked for, but for StopMove, whose reply is not waited for.
        Reply::StopMove(_) | Reply::CartesianLimit { .. } | Reply::ModelLibrary { .. } => {
            return Ok(None);
        }
    }))
}
