//! Messages in a stream of bytes: both directions of the TCP connection.
//!
//! A message is a header of 12 bytes (code of the request, id, size of header and payload,
//! u32 each, little endian) and a payload. Ids are the client's, counted up from 0; a reply
//! has code and id of its request. Replies may come in any order.

use crate::bytes::{Reader, Writer};
use crate::error::Error;
use crate::kind::Kind;
use crate::version::Version;

/// Bytes of a header.
pub const HEADER_LEN: usize = 12;

/// Bytes of the longest request: no robot needs a larger buffer.
pub const REQUEST_LEN_MAX: usize = HEADER_LEN + 416;

/// A message whose header is read and whose payload is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Code of the request: [`Kind::from_code`].
    pub code: u32,
    /// Id of the request.
    pub id: u32,
    /// Bytes behind the header, as far as the buffer has them.
    pub payload: &'a [u8],
    /// Bytes of the payload that the buffer had no room for.
    pub skipped: usize,
}

/// Bytes of a payload, as they come: of a message that is longer than any buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// Code of the request: [`Kind::from_code`].
    pub code: u32,
    /// Id of the request.
    pub id: u32,
    /// Place of the first byte in the payload, from 0.
    pub at: usize,
    /// The bytes, at least one.
    pub bytes: &'a [u8],
}

/// Finds the messages in a stream, whatever the pieces in which it comes.
///
/// ```
/// # use fci::stream::{REQUEST_LEN_MAX, Stream};
/// # fn receive() -> &'static [u8] { &[2, 0, 0, 0, 7, 0, 0, 0, 12, 0, 0, 0] }
/// # fn main() -> Result<(), fci::Error> {
/// let mut stream = Stream::new([0; REQUEST_LEN_MAX], REQUEST_LEN_MAX)?;
/// let mut bytes = receive();
/// while let Some(message) = stream.next(&mut bytes)? {
///     assert_eq!((message.code, message.id), (2, 7));
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Stream<B> {
    buffer: B,
    size_max: usize,
    /// Bytes of the current message that have come.
    seen: usize,
    state: Progress,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// Header or payload are not there yet.
    Partial,
    /// The message has been given out.
    Complete,
    /// A header with this size: where the next message begins is not known.
    Lost(usize),
}

impl<const N: usize> Stream<[u8; N]> {
    /// A stream at its beginning with a buffer of N bytes, into which a header must fit: see
    /// [`Self::new`].
    #[must_use]
    pub const fn with_room(size_max: usize) -> Self {
        const { assert!(N >= HEADER_LEN) };
        Self {
            buffer: [0; N],
            size_max,
            seen: 0,
            state: Progress::Partial,
        }
    }
}

impl<B: AsRef<[u8]> + AsMut<[u8]>> Stream<B> {
    /// A stream at its beginning. Of messages that are longer than the buffer the end is
    /// skipped; `size_max` is what a header may say at most, for a robot the length of its
    /// buffer.
    ///
    /// # Errors
    /// A buffer that no header fits into.
    pub fn new(buffer: B, size_max: usize) -> Result<Self, Error> {
        let found = buffer.as_ref().len();
        if found < HEADER_LEN {
            return Err(Error::Room {
                found,
                needed: HEADER_LEN,
            });
        }
        Ok(Self {
            buffer,
            size_max,
            seen: 0,
            state: Progress::Partial,
        })
    }

    /// Takes bytes from the front of `bytes` until a message is complete; `None` where all are
    /// taken before that.
    ///
    /// # Errors
    /// A size of less than a header or more than allowed. The stream is of no use any more,
    /// and every later call says the same, until [`Self::reset`].
    pub fn next(&mut self, bytes: &mut &[u8]) -> Result<Option<Message<'_>>, Error> {
        self.next_in_pieces(bytes, |_| ())
    }

    /// The same, and `piece` sees the bytes of the payload as they are taken: also those that
    /// the buffer has no room for.
    ///
    /// # Errors
    /// Those of [`Self::next`].
    pub fn next_in_pieces(
        &mut self,
        bytes: &mut &[u8],
        mut piece: impl FnMut(Piece<'_>),
    ) -> Result<Option<Message<'_>>, Error> {
        if self.state == Progress::Complete {
            self.reset();
        }
        if let Progress::Lost(size) = self.state {
            return Err(self.wrong(size));
        }
        self.take(bytes, HEADER_LEN);
        if self.seen < HEADER_LEN {
            return Ok(None);
        }
        let mut header = Reader::new(self.buffer.as_ref());
        let (code, id, size) = (header.u32(), header.u32(), header.u32() as usize);
        if !(HEADER_LEN..=self.size_max).contains(&size) {
            self.state = Progress::Lost(size);
            return Err(self.wrong(size));
        }
        let at = self.seen - HEADER_LEN;
        let taken = self.take(bytes, size);
        if !taken.is_empty() {
            piece(Piece {
                code,
                id,
                at,
                bytes: taken,
            });
        }
        if self.seen < size {
            return Ok(None);
        }
        self.state = Progress::Complete;
        let buffer = self.buffer.as_ref();
        let kept = size.min(buffer.len());
        Ok(Some(Message {
            code,
            id,
            payload: buffer.get(HEADER_LEN..kept).unwrap_or(&[]),
            skipped: size - kept,
        }))
    }

    /// At the beginning of a message again: another connection.
    pub fn reset(&mut self) {
        self.seen = 0;
        self.state = Progress::Partial;
    }

    /// Takes bytes until so many of the message have come: those bytes.
    fn take<'a>(&mut self, bytes: &mut &'a [u8], until: usize) -> &'a [u8] {
        let wanted = until.saturating_sub(self.seen).min(bytes.len());
        let Some((taken, rest)) = bytes.split_at_checked(wanted) else {
            return &[];
        };
        let places = self.buffer.as_mut().iter_mut().skip(self.seen);
        for (place, byte) in places.zip(taken) {
            *place = *byte;
        }
        self.seen += wanted;
        *bytes = rest;
        taken
    }

    fn wrong(&self, found: usize) -> Error {
        Error::Length {
            what: "message",
            found,
            min: HEADER_LEN,
            max: self.size_max,
        }
    }
}

impl Message<'_> {
    /// Which request it is or answers, and that its payload has an allowed length.
    pub(crate) fn kind(
        &self,
        version: Version,
        lengths: impl Fn(Kind) -> (usize, usize),
    ) -> Result<Kind, Error> {
        let kind = Kind::from_code(version, self.code)?;
        let (min, max) = lengths(kind);
        // What is read must have been kept; what is skipped counts as well.
        let kept = self.payload.len();
        let found = if kept < min {
            kept
        } else {
            kept.saturating_add(self.skipped)
        };
        if !(min..=max).contains(&found) {
            return Err(Error::Length {
                what: kind.name(),
                found,
                min,
                max,
            });
        }
        Ok(kind)
    }
}

/// Writes a message: its header around what `payload` writes.
pub(crate) fn emit(
    code: u32,
    id: u32,
    bytes: &mut [u8],
    payload: impl FnOnce(&mut Writer<'_>) -> Result<(), Error>,
) -> Result<&[u8], Error> {
    let mut to = Writer::new(bytes);
    to.put([0; HEADER_LEN]);
    payload(&mut to)?;
    let size = to.written();
    to.finish()?;
    let mut header = Writer::new(bytes);
    header.u32(code);
    header.u32(id);
    // A buffer of 4 GiB is no message.
    header.u32(u32::try_from(size).unwrap_or(u32::MAX));
    Ok(bytes.get(..size).unwrap_or(&[]))
}
