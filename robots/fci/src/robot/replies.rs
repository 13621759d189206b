//! Replies that are due, as bytes in their order; how many there can be is fixed.

use crate::bytes::put;
use crate::reply::{Reply, Setter};
use crate::robot::settings::Walls;
use crate::status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus,
    StopMoveStatus,
};
use crate::stream::HEADER_LEN;
use crate::version::Version;

/// Replies that can wait.
const ROOM: usize = 8;

/// Replies that come without a request at that moment: of a Move and of a recovery that end.
/// Two more are those of StopMove and of the Move that it ends.
const RESERVED: usize = 4;

/// The longest reply but for the model: that of GetCartesianLimit.
const SHORT_MAX: usize = HEADER_LEN + 154;

/// A reply without the text that the robot has only once.
#[derive(Clone, Copy, Debug)]
pub(super) enum Due {
    Connect(ConnectStatus),
    Move(MoveStatus),
    StopMove(StopMoveStatus),
    /// With the number of the wall, none where there is none with it.
    Wall(Option<usize>),
    Setter(Setter, SetterStatus),
    Recovery(RecoveryStatus),
    Library(LibraryStatus),
    Model(ModelStatus),
}

impl Due {
    /// The reply; the text of the model follows it where it is a success.
    fn reply(&self, version: Version, walls: &Walls) -> Reply<'static> {
        match *self {
            Self::Connect(status) => Reply::Connect {
                status,
                version: version.number(),
            },
            Self::Move(status) => Reply::Move(status),
            Self::StopMove(status) => Reply::StopMove(status),
            Self::Wall(number) => {
                let wall = number.and_then(|number| walls.get(number).copied().flatten());
                Reply::CartesianLimit {
                    status: match wall {
                        Some(_) => SetterStatus::Success,
                        None => SetterStatus::InvalidArgument,
                    },
                    limit: wall.unwrap_or_default(),
                }
            }
            Self::Setter(setter, status) => Reply::Setter { setter, status },
            Self::Recovery(status) => Reply::Recovery(status),
            Self::Library(status) => Reply::ModelLibrary {
                status,
                library: &[],
            },
            Self::Model(status) => Reply::RobotModel { status, urdf: &[] },
        }
    }
}

/// A queue. The first one may have gone out in part.
#[derive(Clone, Debug)]
pub(super) struct Replies {
    due: [Option<(u32, Due)>; ROOM],
    /// Bytes of the first one that are out.
    out: usize,
}

impl Replies {
    pub(super) const fn new() -> Self {
        Self {
            due: [None; ROOM],
            out: 0,
        }
    }

    /// Whether another request may be taken: its replies have room.
    pub(super) fn has_room(&self) -> bool {
        self.due.iter().filter(|due| due.is_none()).count() >= RESERVED
    }

    /// Whether a reply to the request with this id waits.
    pub(super) fn waits(&self, id: u32) -> bool {
        self.due.iter().flatten().any(|&(due, _)| due == id)
    }

    /// One more, behind the others.
    pub(super) fn push(&mut self, id: u32, due: Due) {
        if let Some(place) = self.due.iter_mut().find(|place| place.is_none()) {
            *place = Some((id, due));
        }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// The next bytes: how many are written, 0 when nothing is due.
    pub(super) fn take(
        &mut self,
        version: Version,
        walls: &Walls,
        model: &[u8],
        out: &mut [u8],
    ) -> usize {
        let mut written = 0;
        while let Some((id, due)) = self.due.first().copied().flatten() {
            let mut room = [0; SHORT_MAX];
            // Every status here is one of the version.
            let short = due.reply(version, walls).emit(version, id, &mut room);
            let short_len = short.map_or(0, <[u8]>::len);
            let tail = match due {
                Due::Model(ModelStatus::Success) => model,
                _ => &[],
            };
            let len = short_len + tail.len();
            // The size in the header is that of all.
            let size = u32::try_from(len).unwrap_or(u32::MAX);
            put(&mut room, HEADER_LEN - 4, size.to_le_bytes());
            let bytes = room.iter().take(short_len).chain(tail).skip(self.out);
            let places = out.iter_mut().skip(written);
            let count = bytes
                .zip(places)
                .map(|(&byte, place)| *place = byte)
                .count();
            written += count;
            self.out += count;
            if self.out < len {
                break;
            }
            let [_, rest @ ..] = self.due;
            self.due = [None; ROOM];
            for (place, due) in self.due.iter_mut().zip(rest) {
                *place = due;
            }
            self.out = 0;
        }
        written
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::settings::WALLS;
    use crate::stream::Stream;
    use std::vec::Vec;

    /// Everything that is due, in pieces of so many bytes.
    fn drained(replies: &mut Replies, model: &[u8], piece: usize) -> Vec<u8> {
        let (mut all, mut room) = (Vec::new(), [0; 64]);
        loop {
            let count = replies.take(Version::V10, &[None; WALLS], model, &mut room[..piece]);
            if count == 0 {
                return all;
            }
            all.extend(&room[..count]);
        }
    }

    #[test]
    fn pieces_of_any_size_are_the_same_bytes() {
        let model = b"<robot name=\"arm\"></robot>";
        let filled = || {
            let mut replies = Replies::new();
            replies.push(1, Due::Move(MoveStatus::MotionStarted));
            replies.push(2, Due::Model(ModelStatus::Success));
            replies.push(3, Due::Setter(Setter::Load, SetterStatus::InvalidArgument));
            replies
        };
        let whole = drained(&mut filled(), model, 64);
        assert_eq!(whole.len(), 13 + 13 + model.len() + 13);
        for piece in 1..20 {
            let mut replies = filled();
            assert_eq!(drained(&mut replies, model, piece), whole);
            assert_eq!(
                replies.take(Version::V10, &[None; WALLS], model, &mut [0; 64]),
                0
            );
        }
        let mut stream = Stream::new([0; 64], 64).expect("room");
        let mut rest = &whole[..];
        let mut ids = Vec::new();
        while let Some(message) = stream.next(&mut rest).expect("sizes") {
            let reply = Reply::parse(Version::V10, &message).expect("a reply");
            if let Reply::RobotModel { status, urdf } = reply {
                assert_eq!((status, urdf), (ModelStatus::Success, &model[..]));
            }
            ids.push(message.id);
        }
        assert_eq!(ids, [1, 2, 3]);
    }

    #[test]
    fn a_model_that_is_refused_has_no_text() {
        let mut replies = Replies::new();
        replies.push(1, Due::Model(ModelStatus::NotPossible));
        assert_eq!(drained(&mut replies, b"text", 64).len(), 13);
    }
}
