//! Requests and replies in a stream that comes in pieces.

use fci::{Message, Reply, Request, Stream, Version};
use hostile::{Cases, Random, Table};

use super::{OUTCOMES, Outcome, data};

/// The buffer of the receiver, and the largest size that it allows: messages of the client fit,
/// long replies do not.
const BUFFER: usize = 512;
const SIZE_MAX: usize = 1024;

pub const DAMAGES: [&str; 5] = ["bits", "bytes", "header", "payload", "length"];

#[derive(Clone, Copy, PartialEq)]
pub enum Direction {
    ToRobot,
    ToClient,
}

/// A message of a stream, told apart without the codec.
pub struct Piece<'a> {
    pub code: u32,
    pub id: u32,
    pub payload: &'a [u8],
}

/// What there is in the bytes of a stream.
pub struct Pieces<'a> {
    pub messages: Vec<Piece<'a>>,
    /// A size stops it behind them.
    pub is_lost: bool,
    /// Bytes of a message that is not complete, or of a lost stream.
    pub rest: usize,
}

/// Messages of at most so many bytes.
pub fn pieces(mut bytes: &[u8], size_max: usize) -> Pieces<'_> {
    let (mut messages, mut is_lost) = (Vec::new(), false);
    while bytes.len() >= 12 {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
        let size = word(8) as usize;
        is_lost = !(12..=size_max).contains(&size);
        if is_lost || bytes.len() < size {
            break;
        }
        messages.push(Piece {
            code: word(0),
            id: word(4),
            payload: &bytes[12..size],
        });
        bytes = &bytes[size..];
    }
    Pieces {
        messages,
        is_lost,
        rest: bytes.len(),
    }
}

/// What a reader must say to a message.
pub fn expected(version: Version, direction: Direction, piece: &Piece<'_>) -> Outcome {
    let Some(exchange) = data::exchange(version, piece.code) else {
        return Outcome::Code;
    };
    let payload = piece.payload;
    if direction == Direction::ToClient {
        if payload.len() < exchange.reply_len {
            return Outcome::Length;
        }
        if payload[0] > exchange.status_max(version) {
            return Outcome::Code;
        }
        return match exchange.reply_bool {
            Some(at) if payload[at] > 1 => Outcome::Bool,
            _ => Outcome::Accepted,
        };
    }
    if payload.len() != exchange.request_len(version) {
        return Outcome::Length;
    }
    for field in exchange.fields {
        let &(at, len, ..) = field;
        let max = data::Exchange::field_max(version, field);
        if payload[at] > max || payload[at + 1..at + len].iter().any(|&byte| byte != 0) {
            return Outcome::Code;
        }
    }
    let mut bools = exchange.bools.iter().filter_map(|&at| payload.get(at));
    // Without its last fields Move has reals there.
    let has_bools = exchange.name != "Move" || version == Version::V10;
    if has_bools && bools.any(|&byte| byte > 1) {
        return Outcome::Bool;
    }
    Outcome::Accepted
}

/// What the codec says to a message, and that what it accepts comes back.
fn outcome(
    version: Version,
    direction: Direction,
    message: &Message<'_>,
    piece: &Piece<'_>,
) -> Result<Outcome, String> {
    let kept = piece.payload.len().min(BUFFER - 12);
    let (found, skipped) = (message.payload, message.skipped);
    if (message.code, message.id) != (piece.code, piece.id)
        || found != &piece.payload[..kept]
        || skipped != piece.payload.len() - kept
    {
        return Err(format!(
            "{message:?}; expected: code {}, {kept} bytes",
            piece.code
        ));
    }
    let mut again = [0xAA; SIZE_MAX];
    let emitted = match direction {
        Direction::ToRobot => match Request::parse(version, message) {
            Err(error) => return Outcome::of(error),
            Ok(request) => request.emit(version, message.id, &mut again),
        },
        Direction::ToClient => match Reply::parse(version, message) {
            Err(error) => return Outcome::of(error),
            Ok(reply) => reply.emit(version, message.id, &mut again),
        },
    };
    let emitted = emitted.map_err(|error| error.to_string())?;
    // What a robot fills up with is not read.
    let exchange = data::exchange(version, piece.code).ok_or("an unknown code is accepted")?;
    let read = match direction {
        Direction::ToClient if !exchange.is_open => exchange.reply_len,
        _ => kept,
    };
    let wanted = data::message(piece.code, piece.id, &piece.payload[..read]);
    if emitted != wanted {
        return Err(format!("{emitted:02x?}; expected: {wanted:02x?}"));
    }
    Ok(Outcome::Accepted)
}

const VERSIONS: [Version; 4] = [Version::V5, Version::V7, Version::V8, Version::V10];

/// Valid messages of a version: requests, and replies with every status.
pub fn messages(version: Version) -> [Vec<Vec<u8>>; 2] {
    let mut messages = [Vec::new(), Vec::new()];
    for (exchange, id) in data::EXCHANGES.iter().zip(0..) {
        let Some(code) = exchange.code(version) else {
            continue;
        };
        let request = data::request(exchange, version);
        messages[0].push(data::message(code, id, &request));
        for status in 0..=exchange.status_max(version) {
            let more = [0, 3, 700][usize::from(status % 3)];
            let reply = data::reply(exchange, status, more);
            messages[1].push(data::message(code, id, &reply));
        }
    }
    messages
}

/// The readers, and what they have said.
pub struct Streams {
    /// Version by version, requests before replies.
    messages: [[Vec<Vec<u8>>; 2]; VERSIONS.len()],
    bytes: Vec<u8>,
    damages: Table,
    outcomes: Table,
    streams: Table,
}

impl Streams {
    pub fn new() -> Self {
        let mut outcomes = Table::new("message read as", &OUTCOMES);
        for version in VERSIONS {
            let number = version.number();
            let not_finite = Outcome::NotFinite as usize;
            // Only the wall of version 5 has a truth value.
            let reply: &[usize] = match version {
                Version::V5 => &[not_finite],
                _ => &[not_finite, Outcome::Bool as usize],
            };
            outcomes = outcomes.with(format!("request {number}"), &[not_finite]);
            outcomes = outcomes.with(format!("reply {number}"), reply);
        }
        Self {
            messages: VERSIONS.map(messages),
            bytes: Vec::new(),
            damages: Table::new("damage", &DAMAGES).with("streams", &[]),
            outcomes,
            streams: Table::new("stream", &["sound", "lost"]).with("streams", &[]),
        }
    }
}

impl Cases for Streams {
    /// One stream of one to four messages, in pieces.
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let chosen = random.below(VERSIONS.len());
        let (version, robots) = (VERSIONS[chosen], random.below(2));
        let direction = [Direction::ToRobot, Direction::ToClient][robots];
        let valid = &self.messages[chosen][robots];
        let bytes = &mut self.bytes;
        bytes.clear();
        let mut begins = [0; 4];
        let count = 1 + random.below(4);
        for begin in &mut begins[..count] {
            *begin = bytes.len();
            bytes.extend(&valid[random.below(valid.len())]);
        }
        for _ in 0..=random.below(3) {
            let damage = damage(bytes, &begins[..count], random);
            self.damages.count(damage, 0);
        }
        let (outcomes, lost) = tell(version, direction, bytes, random.cuts(bytes.len()))?;
        for outcome in outcomes {
            self.outcomes.count(outcome as usize, 2 * chosen + robots);
        }
        self.streams.count(usize::from(lost), 0);
        Ok(())
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn tables(self) -> Vec<Table> {
        vec![self.damages, self.outcomes, self.streams]
    }
}

/// What the codec says to the messages of a stream that is cut there, and whether it got lost.
fn tell(
    version: Version,
    direction: Direction,
    bytes: &[u8],
    cuts: Vec<usize>,
) -> Result<(Vec<Outcome>, bool), String> {
    let pieces = pieces(bytes, SIZE_MAX);
    let must_be_lost = pieces.is_lost;
    let mut pieces = pieces.messages.iter();
    let mut stream = Stream::new([0; BUFFER], SIZE_MAX).map_err(|error| error.to_string())?;
    let (mut outcomes, mut lost, mut begin) = (Vec::new(), false, 0);
    for cut in cuts {
        let mut rest = &bytes[begin..cut];
        begin = cut;
        loop {
            match stream.next(&mut rest) {
                Ok(None) if rest.is_empty() => break,
                Ok(None) => return Err(format!("{} bytes are left", rest.len())),
                Err(fci::Error::Length {
                    what: "message", ..
                }) => {
                    lost = true;
                    break;
                }
                Err(error) => return Err(format!("unknown error: {error}")),
                Ok(Some(_)) if lost => return Err("a message behind a wrong size".into()),
                Ok(Some(message)) => {
                    let piece = pieces.next().ok_or("a message too many")?;
                    let found = outcome(version, direction, &message, piece)?;
                    let wanted = expected(version, direction, piece);
                    if found != wanted {
                        return Err(format!("{found:?} for {message:?}; expected: {wanted:?}"));
                    }
                    outcomes.push(found);
                }
            }
        }
    }
    if pieces.next().is_some() || lost != must_be_lost {
        return Err(format!(
            "lost: {lost}; expected: {must_be_lost}, no message left"
        ));
    }
    Ok((outcomes, lost))
}

/// Which damage it was, to messages that begin there.
pub fn damage(bytes: &mut Vec<u8>, begins: &[usize], random: &mut Random) -> usize {
    let begin = random.pick(begins);
    let behind = bytes.len().saturating_sub(begin + 12);
    let damage = random.pick(&[0, 1, 2, 2, 3, 3, 4]);
    match damage {
        0 => random.flip(bytes),
        1 => random.set(bytes),
        // Code, id, size.
        2 if begin + 12 <= bytes.len() => {
            let at = begin + random.pick(&[0, 4, 8, 8]);
            let any = random.bits();
            let values = [
                0,
                1,
                3,
                11,
                12,
                13,
                14,
                16,
                68,
                125,
                428,
                1024,
                1025,
                0x8000_0000,
                any,
            ];
            bytes[at..at + 4].copy_from_slice(&random.pick(&values).to_le_bytes());
        }
        // Its begin: statuses, codes, truth values.
        3 if behind > 0 => {
            let at = begin + 12 + random.pick(&[0, 0, 0, 1, 4, 56, 153]).min(behind - 1);
            bytes[at] = random.below(14) as u8;
        }
        // Cut off, or longer.
        _ => {
            let any = random.below(bytes.len() + 1);
            let len = random.pick(&[any, bytes.len() + 1]);
            bytes.resize(len, 0);
            return 4;
        }
    }
    damage
}
