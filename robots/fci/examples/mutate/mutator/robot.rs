//! The robot's machine under attack, at every place of conversations in good order.

use std::mem::size_of;

use fci::robot::{Broken, Handled, Received, Refused, Robot};
use fci::stream::REQUEST_LEN_MAX;
use fci::{Error, Kind, Reply, Stream, Version};
use hostile::{Cases, Random, Table};

use super::datagrams::{self, Datagram};
use super::pair::{Machine, RobotSaid, ToRobot, URDF};
use super::script::{NUMBER, Script, VERSIONS, conversations, damages, message_id, renumber};
use super::streams::{self, Direction, Piece};
use super::{Outcome, data};

/// What becomes of a command. Only the last three may change anything.
const COMMANDS: [&str; 9] = [
    "length",
    "bool",
    "not finite",
    "no motion",
    "late",
    "repeated",
    "reflex",
    "accepted",
    "last",
];

/// The first of those that act.
const ACTS: usize = 6;

/// What becomes of a request. The first four break the connection, the last one is done,
/// the others are refused.
const REQUESTS: [&str; 18] = [
    "broken: length",
    "broken: code",
    "broken: not connected",
    "broken: connected",
    "version",
    "mode",
    "in motion",
    "no motion",
    "motion",
    "asynchronous",
    "code",
    "bool",
    "not finite",
    "range",
    "beyond",
    "wall",
    "absent",
    "done",
];

/// The one that is done, the one behind which only another connection helps, and those that not
/// every version has.
const DONE: usize = 17;
const VERSION: usize = 4;
const ASYNCHRONOUS: usize = 9;
const WALL: usize = 15;

fn command_row(received: Received) -> Result<usize, String> {
    Ok(match received {
        Received::Unreadable(Error::Length { .. }) => 0,
        Received::Unreadable(Error::Bool { .. }) => 1,
        Received::Unreadable(Error::NotFinite { .. }) => 2,
        Received::NoMotion => 3,
        Received::Late => 4,
        Received::Repeated => 5,
        Received::Reflex(_) => 6,
        Received::Accepted => 7,
        Received::Last => 8,
        Received::Unreadable(error) => return Err(format!("unknown error: {error}")),
    })
}

fn request_row(handled: &Result<Handled, Broken>) -> Result<usize, String> {
    Ok(match handled {
        Err(Broken::Stream(Error::Length { .. })) => 0,
        Err(Broken::Stream(Error::Code { .. })) => 1,
        Err(Broken::NotConnected(_)) => 2,
        Err(Broken::Connected) => 3,
        Err(Broken::Stream(error)) => return Err(format!("unknown error: {error}")),
        Ok(handled) => match handled.refused {
            Some(Refused::Version { .. }) => 4,
            Some(Refused::Mode(_)) => 5,
            Some(Refused::InMotion) => 6,
            Some(Refused::NoMotion) => 7,
            Some(Refused::Motion(..)) => 8,
            Some(Refused::Asynchronous) => 9,
            Some(Refused::Argument(Error::Code { .. })) => 10,
            Some(Refused::Argument(Error::Bool { .. })) => 11,
            Some(Refused::Argument(Error::NotFinite { .. })) => 12,
            Some(Refused::Argument(Error::Range { .. })) => 13,
            Some(Refused::Beyond { .. }) => 14,
            Some(Refused::Wall(_)) => 15,
            Some(Refused::Absent(_)) => 16,
            None => 17,
            Some(Refused::Argument(error)) => return Err(format!("unknown error: {error}")),
        },
    })
}

/// The machine, where it is attacked, and what became of that.
pub struct Robots {
    scripts: Vec<Script<Robot<&'static [u8]>>>,
    /// For each place of each of them the number of the last state, and a command to it.
    before: Vec<Vec<Before>>,
    kinds: [datagrams::Kind; VERSIONS.len()],
    requests: [Vec<Vec<u8>>; VERSIONS.len()],
    datagram: Datagram,
    bytes: Vec<u8>,
    damages: [Table; 2],
    commands: Table,
    handled: Table,
    streams: Table,
}

#[derive(Clone, Default)]
struct Before {
    state: u64,
    command: Vec<u8>,
    /// The next request of the conversation.
    request: Vec<u8>,
}

/// What there is at each place of a robot's conversation.
fn before(script: &Script<Robot<&'static [u8]>>) -> Vec<Before> {
    let command = |event: &ToRobot| match event {
        ToRobot::Command(datagram) => Some(datagram.clone()),
        _ => None,
    };
    let request = |event: &ToRobot| match event {
        ToRobot::Bytes(bytes) => Some(bytes.clone()),
        _ => None,
    };
    let places = &script.places;
    let mut now = Before {
        command: places
            .iter()
            .find_map(|place| command(&place.event))
            .unwrap_or_default(),
        ..Before::default()
    };
    let mut all = Vec::new();
    for (at, place) in places.iter().enumerate() {
        let next = places[at..].iter().find_map(|place| request(&place.event));
        if let Some(next) = next {
            now.request = next;
        }
        all.push(now.clone());
        if let Some(datagram) = command(&place.event) {
            now.command = datagram;
        }
        if let Some(id) = message_id(&place.said.state) {
            now.state = id;
        }
    }
    all
}

impl Robots {
    pub fn new() -> Self {
        // The model is the caller's; everything else is in here.
        let size = size_of::<Robot<&[u8]>>();
        assert!(size < 8 * 1024, "{size} bytes");
        let scripts = conversations().robots;
        let mut commands = Table::new("robot: command", &COMMANDS);
        let mut handled = Table::new("robot: request", &REQUESTS);
        let mut streams = Table::new("robot: stream", &["whole", "partial"]);
        for version in VERSIONS {
            let head = format!("version {}", version.number());
            let lacks: &[usize] = match version {
                Version::V5 => &[ASYNCHRONOUS],
                Version::V10 => &[WALL],
                _ => &[ASYNCHRONOUS, WALL],
            };
            commands = commands.with(&head, &[]);
            handled = handled.with(&head, lacks);
            streams = streams.with(&head, &[]);
        }
        Self {
            before: scripts.iter().map(before).collect(),
            scripts,
            kinds: VERSIONS.map(datagrams::Kind::command),
            requests: VERSIONS.map(|version| {
                let [requests, _] = streams::messages(version);
                requests
            }),
            datagram: Datagram::new(),
            bytes: Vec::new(),
            damages: damages("command"),
            commands,
            handled,
            streams,
        }
    }

    /// A command, damaged or not.
    fn command(&mut self, script: usize, at: usize, random: &mut Random) -> Result<(), String> {
        let (script, before) = (&self.scripts[script], &self.before[script][at]);
        let own = &self.kinds[script.column];
        let datagram = &mut self.datagram;
        datagram.set(&before.command);
        datagram.put(0, &before.state.to_le_bytes());
        for _ in 0..random.below(4) {
            let other = &self.kinds[random.below(self.kinds.len())];
            self.damages[0].count(datagram.damage(own, other, random), 0);
        }
        if random.below(2) == 0 {
            renumber(datagram, before.state, random);
            self.damages[0].count(NUMBER, 0);
        }
        let bytes = datagram.bytes();
        self.bytes.clear();
        self.bytes.extend(bytes);
        let mut robot = script.places[at].machine.clone();
        let received = robot.command(bytes);
        let row = command_row(received)?;
        let expected = match own.expected(bytes) {
            Outcome::Length => 0..=0,
            Outcome::Bool => 1..=1,
            Outcome::NotFinite => 2..=2,
            _ if message_id(bytes) != Some(before.state) => 3..=4,
            _ => 3..=8,
        };
        // A command to this state is late only where another one has been made meanwhile.
        if !expected.contains(&row) || (row == 4 && message_id(bytes) == Some(before.state)) {
            let names = &COMMANDS[expected];
            return Err(format!("{received:?}; expected: {names:?}"));
        }
        self.commands.count(row, script.column);
        if row >= ACTS {
            return Ok(());
        }
        script.follow(at, robot, random, |_| true)
    }

    /// Requests, damaged or not, in pieces.
    fn stream(&mut self, script: usize, at: usize, random: &mut Random) -> Result<(), String> {
        let (script, before) = (&self.scripts[script], &self.before[script][at]);
        let bytes = &mut self.bytes;
        bytes.clear();
        let valid = &self.requests[script.column];
        let mut begins = [0; 8];
        let count = 1 + random.below(3) + random.below(2) * random.below(5);
        for begin in &mut begins[..count] {
            *begin = bytes.len();
            match random.below(8) {
                0 => bytes.extend(&before.request),
                _ => bytes.extend(&valid[random.below(valid.len())]),
            }
        }
        for _ in 0..random.below(3) {
            let damage = streams::damage(bytes, &begins[..count], random);
            self.damages[1].count(damage, 0);
        }
        let mut robot = script.places[at].machine.clone();
        let (mut said, mut begin) = (RobotSaid::default(), 0);
        for cut in random.cuts(bytes.len()) {
            let more = robot.tell(&ToRobot::Bytes(bytes[begin..cut].to_vec()));
            said.replies.extend(more.replies);
            said.handled.extend(more.handled);
            begin = cut;
            if said.handled.last().is_some_and(Result::is_err) {
                break;
            }
        }
        let version = script.version;
        let pieces = streams::pieces(bytes, REQUEST_LEN_MAX);
        let (mut done, mut closes, mut broken) = (false, false, None);
        for (index, handled) in said.handled.iter().enumerate() {
            let row = request_row(handled)?;
            let expected = match pieces.messages.get(index) {
                Some(piece) => expected(version, piece),
                None if pieces.is_lost => &[0][..],
                None => return Err(format!("{handled:?} to nothing")),
            };
            if !expected.is_empty() && !expected.contains(&row) {
                let names: Vec<_> = expected.iter().map(|&row| REQUESTS[row]).collect();
                return Err(format!("{handled:?}; expected: {names:?}"));
            }
            if expected.is_empty() && (row <= 1 || (10..=11).contains(&row)) {
                return Err(format!("{handled:?} to what can be read"));
            }
            self.handled.count(row, script.column);
            done |= row == DONE;
            closes |= row == VERSION;
            broken = handled.err();
        }
        let all = pieces.messages.len() + usize::from(pieces.is_lost);
        if broken.is_none() && said.handled.len() != all {
            return Err(format!("{} requests; expected: {all}", said.handled.len()));
        }
        check_replies(&said, script)?;
        let partial = broken.is_none() && pieces.rest > 0;
        self.streams.count(usize::from(partial), script.column);
        if let Some(broken) = broken {
            let again = robot.tell(&ToRobot::Bytes(before.request.clone()));
            if again.handled != [Err(broken)] || !again.replies.is_empty() {
                return Err(format!("{again:?} behind {broken}"));
            }
        }
        if done {
            return Ok(());
        }
        // Behind a broken connection, another version or half a request, what comes by TCP is lost; the motion
        // goes on until the host closes it.
        let heard = broken.is_none() && !closes && !partial;
        let by_tcp = |event: &ToRobot| matches!(event, ToRobot::Bytes(_) | ToRobot::Disconnected);
        script.follow(at, robot, random, |event| heard || !by_tcp(event))
    }
}

/// Rows that a message must be in by its bytes alone; none where that depends on the robot.
fn expected(version: Version, piece: &Piece<'_>) -> &'static [usize] {
    let known = data::exchange(version, piece.code).is_some();
    match streams::expected(version, Direction::ToRobot, piece) {
        Outcome::Length => &[0],
        Outcome::Code if !known => &[1],
        // To one that is not connected the connection counts more.
        Outcome::Code => &[2, 3, 10],
        Outcome::Bool => &[2, 3, 11],
        Outcome::Accepted | Outcome::NotFinite => &[],
    }
}

/// Whole replies, one to each request, and those of motions and of a recovery that end.
fn check_replies(said: &RobotSaid, script: &Script<Robot<&'static [u8]>>) -> Result<(), String> {
    let mut stream = Stream::new([0; 256], 256).map_err(|error| error.to_string())?;
    let (mut rest, mut count) = (&said.replies[..], 0);
    while let Some(message) = stream.next(&mut rest).map_err(|error| error.to_string())? {
        Reply::parse(script.version, &message).map_err(|error| error.to_string())?;
        count += 1;
    }
    let asked = said.handled.iter().flatten();
    // The reply to a recovery comes when it is over.
    let waits = |it: &&Handled| it.kind == Kind::AutomaticErrorRecovery && it.refused.is_none();
    let later = asked.clone().filter(waits).count();
    // Each StopMove ends a motion, whose second reply comes with its own.
    let stops = |it: &&Handled| it.kind == Kind::StopMove && it.refused.is_none();
    let stops = asked.clone().filter(stops).count();
    let asked = asked.count();
    // One more: of a recovery before.
    if !rest.is_empty() || count + later < asked || count > asked + stops + 1 {
        return Err(format!("{count} replies to {asked} requests"));
    }
    // None is longer than that of a wall; the model comes with a few more.
    let most = count * (12 + 154 + URDF.len());
    match said.replies.len() <= most {
        true => Ok(()),
        false => Err(format!("{} bytes; at most: {most}", said.replies.len())),
    }
}

impl Cases for Robots {
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let script = random.below(self.scripts.len());
        let at = random.below(self.scripts[script].places.len());
        match random.below(2) {
            0 => self.command(script, at, random),
            _ => self.stream(script, at, random),
        }
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn tables(self) -> Vec<Table> {
        let [commands, streams] = self.damages;
        vec![commands, streams, self.commands, self.handled, self.streams]
    }
}
