//! Bytes on their way to the robot.

use crate::error::Error;
use crate::request::Request;
use crate::stream::{HEADER_LEN, REQUEST_LEN_MAX};
use crate::version::Version;

/// One request of any kind and a StopMove behind it, which does not wait for its turn.
const ROOM: usize = REQUEST_LEN_MAX + HEADER_LEN;

/// Messages that are not sent yet, and the id of the next one.
#[derive(Clone, Debug)]
pub(super) struct Outgoing {
    bytes: [u8; ROOM],
    from: usize,
    until: usize,
    next_id: u32,
}

impl Outgoing {
    pub(super) const fn new() -> Self {
        Self {
            bytes: [0; ROOM],
            from: 0,
            until: 0,
            next_id: 0,
        }
    }

    /// Another connection: nothing is sent, ids start anew.
    pub(super) fn reset(&mut self) {
        (self.from, self.until, self.next_id) = (0, 0, 0);
    }

    /// Behind what waits: the id of the request.
    pub(super) fn push(&mut self, version: Version, request: &Request) -> Result<u32, Error> {
        request.check()?;
        if self.from == self.until {
            (self.from, self.until) = (0, 0);
        }
        let id = self.next_id;
        let room = self.bytes.get_mut(self.until..).unwrap_or_default();
        self.until += request.emit(version, id, room)?.len();
        self.next_id = id.wrapping_add(1);
        Ok(id)
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(self.from..self.until).unwrap_or_default()
    }

    pub(super) fn sent(&mut self, count: usize) {
        self.from = self.from.saturating_add(count).min(self.until);
    }
}
