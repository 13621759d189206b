//! The client's machine under attack, at every place of conversations in good order.

use std::mem::size_of;

use fci::client::{Cause, Client, Duty, Facts, Phase};
use fci::stream::{HEADER_LEN, REQUEST_LEN_MAX};
use fci::{ControllerMode, Error, RobotMode, StatePacket};
use hostile::{Cases, Random, Table};

use super::Outcome;
use super::datagrams::{Datagram, Kind};
use super::pair::ToClient;
use super::script::{NUMBER, Script, VERSIONS, conversations, damages, message_id, renumber};
use super::streams;

/// Bytes that wait for the robot at most: a request of any kind, and StopMove.
const WAITING_MAX: usize = REQUEST_LEN_MAX + HEADER_LEN;

/// The largest size of a message: that of the longest model.
const SIZE_MAX: usize = HEADER_LEN + 1 + fci::client::MODEL_LEN_MAX;

/// What becomes of a datagram. Only the last two may change anything.
#[derive(Clone, Copy)]
enum State {
    Length,
    Code,
    Bool,
    /// Nobody listens yet, or any more.
    Unheard,
    Old,
    Heard,
    Answered,
}

const STATES: [&str; 7] = [
    "length", "code", "bool", "unheard", "old", "heard", "answered",
];

/// What becomes of a stream. The first two change nothing.
#[derive(Clone, Copy)]
enum Said {
    Unheard,
    /// Nobody asked for it.
    Stray,
    /// Ends within a message.
    Partial,
    Length,
    Code,
    /// A status that says no.
    Refused,
    /// The robot has another version, that is tried.
    OtherVersion,
    /// The robot has a version that there is not, or another one again.
    NoVersion,
    /// The recovery behind a reflex is there, which ends the conversation.
    Ended,
    /// The motion has ended, or what was asked for is there.
    Taken,
}

const SAID: [&str; 10] = [
    "unheard",
    "stray",
    "partial",
    "length",
    "code",
    "refused",
    "other version",
    "no version",
    "ended",
    "taken",
];

/// The machine, where it is attacked, and what became of that.
pub struct Clients {
    scripts: Vec<Script<Client>>,
    /// For each place of each of them the number of the newest state that was heard, and the
    /// requests that were sent: id, code.
    before: Vec<Vec<Before>>,
    kinds: [Kind; VERSIONS.len()],
    replies: [Vec<Vec<u8>>; VERSIONS.len()],
    datagram: Datagram,
    bytes: Vec<u8>,
    damages: [Table; 2],
    states: Table,
    said: Table,
}

#[derive(Clone, Default)]
struct Before {
    newest: Option<u64>,
    asked: Vec<(u32, u32)>,
    /// A state of the conversation, near this place.
    datagram: Vec<u8>,
}

/// What a client knows at each place of its conversation.
fn before(script: &Script<Client>) -> Vec<Before> {
    let is_state = |event: &ToClient| match event {
        ToClient::State(datagram) => Some(datagram.clone()),
        _ => None,
    };
    let first = script
        .places
        .iter()
        .find_map(|place| is_state(&place.event));
    let mut now = Before {
        datagram: first.unwrap_or_default(),
        ..Before::default()
    };
    let mut all = Vec::new();
    for place in &script.places {
        all.push(now.clone());
        match &place.event {
            ToClient::Connected => (now.newest, now.asked) = (None, Vec::new()),
            ToClient::State(datagram) => {
                now.datagram.clone_from(datagram);
                if listens(place.machine.phase()) {
                    now.newest = message_id(datagram);
                }
            }
            _ => {}
        }
        for message in streams::pieces(&place.said.sent, SIZE_MAX).messages {
            now.asked.push((message.id, message.code));
        }
    }
    all
}

/// Whether states are looked at.
fn listens(phase: Phase) -> bool {
    !matches!(phase, Phase::Connecting | Phase::Stopped(_))
}

impl Clients {
    pub fn new() -> Self {
        // What is kept of messages and what waits to be sent are part of the value.
        assert!(size_of::<Client>() < 2048, "{}", size_of::<Client>());
        let scripts = conversations().clients;
        let mut states = Table::new("client: state", &STATES);
        let mut said = Table::new("client: stream", &SAID);
        for version in VERSIONS {
            states = states.with(format!("version {}", version.number()), &[]);
            said = said.with(format!("version {}", version.number()), &[]);
        }
        Self {
            before: scripts.iter().map(before).collect(),
            scripts,
            kinds: VERSIONS.map(Kind::state),
            replies: VERSIONS.map(|version| {
                let [_, replies] = streams::messages(version);
                replies
            }),
            datagram: Datagram::new(),
            bytes: Vec::new(),
            damages: damages("state"),
            states,
            said,
        }
    }

    /// A state, damaged or not.
    fn state(&mut self, script: usize, at: usize, random: &mut Random) -> Result<(), String> {
        let (script, before) = (&self.scripts[script], &self.before[script][at]);
        let own = &self.kinds[script.column];
        let datagram = &mut self.datagram;
        datagram.set(&before.datagram);
        for _ in 0..random.below(4) {
            let other = &self.kinds[random.below(self.kinds.len())];
            self.damages[0].count(datagram.damage(own, other, random), 0);
        }
        if random.below(2) == 0 {
            renumber(datagram, before.newest.unwrap_or_default(), random);
            self.damages[0].count(NUMBER, 0);
        }
        let mut client = script.places[at].machine.clone();
        // Before it knows better it tries version 10, and hears nothing.
        let heard = listens(client.phase());
        let bytes = self.datagram.bytes();
        self.bytes.clear();
        self.bytes.extend(bytes);
        let read = StatePacket::new_checked(script.version, bytes);
        let (outcome, packet) = match (own.expected(bytes), read) {
            (Outcome::Length, Err(Error::Length { .. })) => (State::Length, None),
            (Outcome::Code, Err(Error::Code { .. })) => (State::Code, None),
            (Outcome::Bool, Err(Error::Bool { .. })) => (State::Bool, None),
            // Nothing that the machine looks at is a real.
            (Outcome::Accepted | Outcome::NotFinite, Ok(packet)) => {
                let old = before
                    .newest
                    .is_some_and(|newest| packet.message_id() <= newest);
                let outcome = match (heard, old) {
                    (false, _) => State::Unheard,
                    (_, true) => State::Old,
                    _ => State::Heard,
                };
                (outcome, Some(packet))
            }
            (expected, read) => return Err(format!("{:?}; expected: {expected:?}", read.err())),
        };
        let Some(packet) = packet else {
            self.states.count(outcome as usize, script.column);
            return Ok(());
        };
        let duty = client.state(&Facts::of(&packet));
        if client.transmit().len() > WAITING_MAX {
            return Err(format!("{} bytes wait", client.transmit().len()));
        }
        if !matches!(outcome, State::Heard) {
            if duty != Duty::Listen {
                return Err(format!("{duty:?} to a state that does not count"));
            }
            self.states.count(outcome as usize, script.column);
            return script.follow(at, client, random, |_| true);
        }
        let outcome = if duty == Duty::Listen {
            State::Heard
        } else {
            State::Answered
        };
        let shown = (packet.robot_mode(), packet.controller_mode());
        if duty != Duty::Listen && shown != (RobotMode::Move, ControllerMode::External) {
            return Err(format!("{duty:?} to a state that shows {shown:?}"));
        }
        self.states.count(outcome as usize, script.column);
        Ok(())
    }

    /// Replies: what the robot would say, or anything.
    fn stream(&mut self, script: usize, at: usize, random: &mut Random) -> Result<(), String> {
        let (script, before) = (&self.scripts[script], &self.before[script][at]);
        let bytes = &mut self.bytes;
        bytes.clear();
        let valid = &self.replies[script.column];
        let mut begins = [0; 3];
        let count = 1 + random.below(3);
        for begin in &mut begins[..count] {
            *begin = bytes.len();
            bytes.extend(&valid[random.below(valid.len())]);
            // To something that was asked, or to nothing.
            let number = match before.asked.len() {
                0 => random.bits(),
                asked => match random.below(4) {
                    0 => before.asked[asked - 1].0,
                    1 => before.asked[random.below(asked)].0,
                    2 => asked as u32 + random.bits() % 100,
                    _ => random.bits(),
                },
            };
            bytes[*begin + 4..*begin + 8].copy_from_slice(&number.to_le_bytes());
            // To Connect the robot names a version.
            if bytes[*begin..*begin + 4] == [0; 4] {
                bytes[*begin + 13] = 4 + random.below(8) as u8;
                bytes[*begin + 14] = 0;
            }
        }
        if let (Some(&(id, code)), 0) = (before.asked.last(), random.below(3)) {
            bytes[..4].copy_from_slice(&code.to_le_bytes());
            bytes[4..8].copy_from_slice(&id.to_le_bytes());
        }
        for _ in 0..random.below(3) {
            let damage = streams::damage(bytes, &begins[..count], random);
            self.damages[1].count(damage, 0);
        }
        let place = &script.places[at].machine;
        let mut client = place.clone();
        let heard = client.stopped().is_none() && !client.wants_new_connection();
        let mut begin = 0;
        for cut in random.cuts(bytes.len()) {
            client.receive(&bytes[begin..cut], &mut ());
            begin = cut;
        }
        if client.transmit().len() > WAITING_MAX {
            return Err(format!("{} bytes wait", client.transmit().len()));
        }
        let pieces = streams::pieces(bytes, SIZE_MAX);
        let strays = (client.strays() - place.strays()) as usize;
        // By what was sent before, without the machine.
        let asked = |piece: &streams::Piece<'_>| before.asked.contains(&(piece.id, piece.code));
        let must_be_strays = heard && !pieces.messages.iter().any(asked);
        if must_be_strays && strays != pieces.messages.len() {
            let expected = pieces.messages.len();
            return Err(format!("{strays} strays; expected: {expected}"));
        }
        let whole = strays == pieces.messages.len() && pieces.rest == 0;
        let outcome = match client.stopped() {
            _ if !heard => Said::Unheard,
            Some(stop) => match stop.cause {
                Cause::Protocol(Error::Length { .. }) => Said::Length,
                Cause::Protocol(Error::Code { .. }) => Said::Code,
                Cause::Refused { .. } => Said::Refused,
                Cause::Version { .. } => Said::NoVersion,
                Cause::Reflex(_) => Said::Ended,
                other => return Err(format!("an end by {other:?}")),
            },
            None if client.wants_new_connection() => Said::OtherVersion,
            None if whole => Said::Stray,
            None if strays == pieces.messages.len() => Said::Partial,
            None => Said::Taken,
        };
        if must_be_strays && pieces.is_lost != matches!(outcome, Said::Length) {
            return Err(format!(
                "{:?}; sizes are wrong: {}",
                client.phase(),
                pieces.is_lost
            ));
        }
        self.said.count(outcome as usize, script.column);
        match outcome {
            Said::Unheard | Said::Stray => script.follow(at, client, random, |_| true),
            _ if client.stopped().is_some() => closed(client, &script.places[at].event),
            _ => Ok(()),
        }
    }
}

/// Behind an end nothing is said and nothing is heard.
fn closed(mut client: Client, event: &ToClient) -> Result<(), String> {
    let stop = client.stopped();
    let silent = client.transmit().is_empty();
    if let ToClient::Bytes(bytes) = event {
        client.receive(bytes, &mut ());
    }
    let facts = Facts {
        message_id: u64::MAX,
        ..Facts::default()
    };
    let duty = client.state(&facts);
    let still = client.stopped() == stop && client.transmit().is_empty();
    if !silent || !still || duty != Duty::Listen {
        return Err(format!("behind {stop:?}: {:?}, {duty:?}", client.stopped()));
    }
    Ok(())
}

impl Cases for Clients {
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let script = random.below(self.scripts.len());
        // The first places are few: there the versions are agreed on.
        let places = self.scripts[script].places.len();
        let at = {
            let most = random.pick(&[4, places, places, places]);
            random.below(most)
        };
        match random.below(2) {
            0 => self.state(script, at, random),
            _ => self.stream(script, at, random),
        }
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn tables(self) -> Vec<Table> {
        let [states, streams] = self.damages;
        vec![states, streams, self.states, self.said]
    }
}
