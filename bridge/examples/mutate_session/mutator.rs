//! A session between good and damaged measurements, and its twin that gets only what the session has
//! taken: what is refused must not change a byte of any later answer.

#[path = "mutator/fci.rs"]
mod fci;
#[path = "mutator/lwr.rs"]
mod lwr;

use std::mem::size_of_val;

use bridge::protocol::Protocol;
use bridge::session::{Outcome, Phase, Session};
use bridge::source::ReferenceSource;
use controller_core::Reference;
use hostile::{Cases, Random, Table};

pub use fci::Franka;
pub use lwr::Kuka;

/// A session is begun anew after so many datagrams: a fault or a stop ends one.
const SESSION: u32 = 1_000;

/// A datagram in so many is a good one.
const GOOD: usize = 4;

/// More bytes than the session itself has: it keeps nothing elsewhere.
const SIZE_MAX: usize = 96 * 1024;

/// A robot: its measurements, how they are damaged, and what it makes of answers.
pub trait Robot: Sized {
    type Protocol: Protocol + Clone;

    /// What it may be: heads of the columns.
    const HEADS: &'static [&'static str];
    const DAMAGES: &'static [&'static str];
    /// Errors of its codec.
    const ERRORS: &'static [&'static str];
    /// Rows of [`OUTCOMES`] behind them that cannot be.
    const IMPOSSIBLE: &'static [usize];

    /// At the beginning of a conversation, and the session that it is with.
    fn new(column: usize) -> (Self, Session<Self::Protocol>);

    /// The next measurement; the arm has moved a little.
    fn report(&mut self, bytes: &mut Vec<u8>, random: &mut Random);

    /// Damages a measurement: which damage it was.
    fn damage(&self, bytes: &mut Vec<u8>, random: &mut Random) -> usize;

    /// What is due to the next measurement.
    fn attend(&self, session: &mut Session<Self::Protocol>);

    /// What the codec says to a datagram.
    fn error(&self, bytes: &[u8]) -> Option<<Self::Protocol as Protocol>::Error>;

    /// Its row in [`Self::ERRORS`].
    fn row(error: <Self::Protocol as Protocol>::Error) -> Option<usize>;

    /// An answer of a session in this phase: whether it carries torque.
    fn hear(&mut self, answer: &[u8], in_command: bool) -> Result<bool, String>;
}

/// Behind the errors of the codec. The first three are refused.
pub const OUTCOMES: [&str; 6] = [
    "stale",
    "doubted",
    "unusable",
    "heard",
    "answered",
    "with torque",
];

const TAKEN: usize = 3;

/// Holds where it starts.
#[derive(Clone)]
struct Rest(Reference<f64>);

impl ReferenceSource for Rest {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        Some(self.0.clone())
    }
}

/// A conversation.
struct Walk<R: Robot> {
    robot: R,
    session: Box<Session<R::Protocol>>,
    rest: Rest,
    /// The same without what was refused, while anything was.
    twin: Box<Session<R::Protocol>>,
    twins_rest: Rest,
    has_twin: bool,
    /// What the robot says now, and whether the next is due: it has been taken, or has come
    /// as it is.
    measurement: Vec<u8>,
    is_due: bool,
    datagrams: u32,
}

impl<R: Robot> Walk<R> {
    fn new(column: usize) -> Self {
        let (robot, session) = R::new(column);
        let (twin, rest) = (session.clone(), Rest(Reference::hold(0, [0.0; 7])));
        Self {
            robot,
            session: Box::new(session),
            rest: rest.clone(),
            twin: Box::new(twin),
            twins_rest: rest,
            has_twin: false,
            measurement: Vec::new(),
            is_due: true,
            datagrams: 0,
        }
    }
}

/// Conversations of every kind of a robot, and what became of their datagrams.
pub struct Sessions<R: Robot> {
    walks: Vec<Walk<R>>,
    bytes: Vec<u8>,
    damages: Table,
    errors: Table,
    outcomes: Table,
    ends: Table,
}

impl<R: Robot> Sessions<R> {
    pub fn new() -> Self {
        let mut damages = Table::new("damage", R::DAMAGES);
        let mut errors = Table::new("rejected", R::ERRORS);
        let mut outcomes = Table::new("session", &OUTCOMES);
        let mut ends = Table::new("session ends", &["by itself", "by the harness"]);
        for head in R::HEADS {
            damages = damages.with(*head, &[]);
            errors = errors.with(*head, &[]);
            outcomes = outcomes.with(*head, R::IMPOSSIBLE);
            ends = ends.with(*head, &[]);
        }
        let walks: Vec<_> = (0..R::HEADS.len()).map(Walk::new).collect();
        let size = size_of_val(&*walks[0].session);
        assert!(size < SIZE_MAX, "{size} bytes");
        Self {
            walks,
            bytes: Vec::new(),
            damages,
            errors,
            outcomes,
            ends,
        }
    }
}

impl<R: Robot> Cases for Sessions<R> {
    fn case(&mut self, random: &mut Random) -> Result<(), String> {
        let column = random.below(self.walks.len());
        let walk = &mut self.walks[column];
        walk.datagrams += 1;
        if walk.is_due {
            walk.robot.report(&mut walk.measurement, random);
        }
        self.bytes.clone_from(&walk.measurement);
        let good = random.below(GOOD) == 0;
        if !good {
            for _ in 0..=random.below(2) {
                let damage = walk.robot.damage(&mut self.bytes, random);
                self.damages.count(damage, column);
            }
        }
        let phase = walk.session.phase();
        let failure = |text: String| Err(format!("{}, {phase:?}: {text}", R::HEADS[column]));
        if !good && !walk.has_twin {
            walk.twin.clone_from(&walk.session);
            walk.twins_rest.clone_from(&walk.rest);
        }
        let mut answer = R::Protocol::EMPTY;
        walk.robot.attend(&mut walk.session);
        let outcome = walk
            .session
            .receive(&self.bytes, &mut walk.rest, &mut answer);
        let empty = answer.as_ref() == R::Protocol::EMPTY.as_ref();
        let must = walk.robot.error(&self.bytes);
        let row = match outcome {
            Outcome::Rejected(error) if must == Some(error) => None,
            Outcome::Rejected(error) => return failure(format!("{error:?}; expected: {must:?}")),
            other if must.is_some() => return failure(format!("{other:?}; expected: {must:?}")),
            Outcome::Stale => Some(0),
            Outcome::Doubted => Some(1),
            Outcome::Unusable(_) => Some(2),
            Outcome::Heard => Some(3),
            Outcome::Answered => {
                let in_command = walk.session.phase().is_in_command();
                match walk.robot.hear(answer.as_ref(), in_command) {
                    Ok(torque) => Some(4 + usize::from(torque)),
                    Err(why) => return failure(why),
                }
            }
        };
        match (row, must.map(R::row)) {
            (Some(row), _) => self.outcomes.count(row, column),
            (None, Some(Some(row))) => self.errors.count(row, column),
            (None, _) => return failure(format!("unknown error: {must:?}")),
        }
        let taken = row.is_some_and(|row| row >= TAKEN);
        if !taken && !empty {
            return failure("an answer to a refused datagram".into());
        }
        walk.is_due = taken || good;
        if good && walk.has_twin {
            let mut same = R::Protocol::EMPTY;
            walk.robot.attend(&mut walk.twin);
            let twins = (walk.twin).receive(&self.bytes, &mut walk.twins_rest, &mut same);
            // Behind a counter or a place that was believed wrongly the twin waits longer: datagrams
            // in a row that do not fit are believed, and it has got fewer of them.
            let takes = matches!(twins, Outcome::Heard | Outcome::Answered);
            let (answer, same) = (answer.as_ref(), same.as_ref());
            if takes && (twins != outcome || same != answer) {
                return failure(format!(
                    "{outcome:?} {answer:02x?}; expected: {twins:?} {same:02x?}"
                ));
            }
        }
        walk.has_twin = !taken && (!good || walk.has_twin);
        if walk.session.phase() == Phase::Finished || walk.datagrams == SESSION {
            self.ends
                .count(usize::from(walk.datagrams == SESSION), column);
            *walk = Walk::new(column);
        }
        Ok(())
    }

    fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn tables(self) -> Vec<Table> {
        vec![self.damages, self.errors, self.outcomes, self.ends]
    }
}
