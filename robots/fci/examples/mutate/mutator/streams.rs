//! Requests and replies in a stream that comes in pieces.

use std::panic::catch_unwind;

use fci::{Message, Reply, Request, Stream, Version};

use rand_chacha::rand_core::Rng as _;

use super::{OUTCOMES, Outcome, Random, Row, data};

/// The buffer of the receiver, and the largest size that it allows: messages of the client fit,
/// long replies do not.
const BUFFER: usize = 512;
const SIZE_MAX: usize = 1024;

#[derive(Clone, Copy, PartialEq)]
enum Direction {
    ToRobot,
    ToClient,
}

/// A message of a stream, told apart without the codec.
struct Piece<'a> {
    code: u32,
    id: u32,
    payload: &'a [u8],
}

/// Messages in the bytes, and whether a size stops the stream behind them.
fn pieces(mut bytes: &[u8]) -> (Vec<Piece<'_>>, bool) {
    let mut pieces = Vec::new();
    while bytes.len() >= 12 {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
        let size = word(8) as usize;
        if !(12..=SIZE_MAX).contains(&size) {
            return (pieces, true);
        }
        if bytes.len() < size {
            break;
        }
        pieces.push(Piece {
            code: word(0),
            id: word(4),
            payload: &bytes[12..size],
        });
        bytes = &bytes[size..];
    }
    (pieces, false)
}

/// What a reader must say to a message.
fn expected(version: Version, direction: Direction, piece: &Piece<'_>) -> Outcome {
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

/// The readers, and what they have said.
pub struct Streams {
    /// Valid messages, version by version, requests before replies.
    messages: Vec<[Vec<Vec<u8>>; 2]>,
    pub rows: Vec<Row>,
}

impl Streams {
    pub fn new() -> Self {
        const REQUEST: &[Outcome] = &[
            Outcome::Accepted,
            Outcome::Length,
            Outcome::Code,
            Outcome::Bool,
        ];
        // Only the wall of version 5 has a truth value.
        const REPLY: &[Outcome] = &[Outcome::Accepted, Outcome::Length, Outcome::Code];
        let mut rows = Vec::new();
        for version in VERSIONS {
            let number = version.number();
            let reply = if version == Version::V5 {
                REQUEST
            } else {
                REPLY
            };
            rows.push(Row::new(format!("request {number}"), REQUEST));
            rows.push(Row::new(format!("reply {number}"), reply));
        }
        const STREAM: &[Outcome] = &[Outcome::Accepted, Outcome::Length];
        rows.push(Row::new("stream".into(), STREAM));
        let messages = VERSIONS.map(|version| {
            let exchanges = data::EXCHANGES.iter();
            let mut messages = [Vec::new(), Vec::new()];
            for (exchange, id) in exchanges.zip(0..) {
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
        });
        Self {
            messages: messages.into(),
            rows,
        }
    }

    /// One stream of one to four messages, in pieces.
    pub fn case(&mut self, random: &mut Random) -> Result<(), (String, Vec<u8>)> {
        let chosen = random.below(VERSIONS.len());
        let (version, robots) = (VERSIONS[chosen], random.below(2));
        let direction = [Direction::ToRobot, Direction::ToClient][robots];
        let valid = &self.messages[chosen][robots];
        let mut bytes = Vec::new();
        let mut begins = Vec::new();
        for _ in 0..=random.below(4) {
            begins.push(bytes.len());
            bytes.extend(&valid[random.below(valid.len())]);
        }
        for _ in 0..=random.below(3) {
            damage(&mut bytes, &begins, random);
        }
        let cuts: Vec<usize> = (0..random.below(6))
            .map(|_| random.below(bytes.len() + 1))
            .collect();
        let rows = &mut self.rows[2 * chosen + robots..];
        let told = catch_unwind(|| tell(version, direction, &bytes, cuts));
        let told = told.unwrap_or_else(|_| Err("panic".into()));
        let (outcomes, lost) = told.map_err(|why| (why, bytes))?;
        for outcome in outcomes {
            let place = OUTCOMES.iter().position(|it| it.0 == outcome);
            rows[0].counts[place.expect("in the list")] += 1;
        }
        let stream = self.rows.last_mut().expect("a row");
        stream.counts[usize::from(lost)] += 1;
        Ok(())
    }
}

/// What the codec says to the messages of a stream that is cut there, and whether it got lost.
fn tell(
    version: Version,
    direction: Direction,
    bytes: &[u8],
    mut cuts: Vec<usize>,
) -> Result<(Vec<Outcome>, bool), String> {
    let (pieces, must_be_lost) = pieces(bytes);
    let mut pieces = pieces.iter();
    let mut stream = Stream::new([0; BUFFER], SIZE_MAX).map_err(|error| error.to_string())?;
    let (mut outcomes, mut lost, mut begin) = (Vec::new(), false, 0);
    cuts.push(bytes.len());
    cuts.sort_unstable();
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

fn damage(bytes: &mut Vec<u8>, begins: &[usize], random: &mut Random) {
    let begin = random.pick(begins);
    match random.below(6) {
        0 => random.damage(bytes),
        // A header: code, id, size.
        1 | 2 if begin + 12 <= bytes.len() => {
            let at = begin + random.pick(&[0, 4, 8, 8]);
            let any = random.0.next_u32();
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
        // The begin of a payload: statuses, codes, truth values.
        3 | 4 if begin + 12 < bytes.len() => {
            let len = bytes.len() - begin - 12;
            let at = begin + 12 + random.pick(&[0, 0, 0, 1, 4, 56, 153]).min(len - 1);
            bytes[at] = random.below(14) as u8;
        }
        // Cut off, or longer.
        _ => {
            let any = random.below(bytes.len() + 1);
            let len = random.pick(&[any, bytes.len() + 1]);
            bytes.resize(len, 0);
        }
    }
}
