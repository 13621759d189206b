//! Which answer belongs to which cycle, and which are too old.

use fri::sequence::{Arrival, Receiver, Sender};
use fri::{Error, Header};

use super::figures::{LinkFigures, Rejected};
use super::krc::Refusal;
use super::order::Order;
use crate::robot::control_box::Answer;

/// Measurements whose answers are still known.
const REMEMBERED: usize = 1024;

/// Counters of both sides.
#[derive(Clone, Debug)]
pub struct Inbox {
    sender: Sender,
    receiver: Receiver,
    /// Cycle of the measurement with a counter, at the counter modulo the length.
    sent: Vec<Option<(u16, u64)>>,
    /// When the measurement of a cycle left, at the cycle modulo the length \[s\]; by the
    /// wall clock only.
    departed: Vec<Option<f64>>,
    /// Cycle of the newest answer.
    answered: Option<u64>,
    /// Latency of the answer to the present cycle \[s\].
    in_time: Option<f64>,
}

impl Inbox {
    /// Nothing sent yet; the first counter is 1.
    pub fn new() -> Self {
        Self {
            sender: Sender::starting_at(1),
            receiver: Receiver::new(),
            sent: vec![None; REMEMBERED],
            departed: vec![None; REMEMBERED],
            answered: None,
            in_time: None,
        }
    }

    /// Counters of the next measurement, which is one of cycle `cycle`.
    pub fn next_header(&mut self, cycle: u64) -> Header {
        let counter = self.sender.advance();
        self.sent[usize::from(counter) % REMEMBERED] = Some((counter, cycle));
        Header {
            counter,
            reflected: self.receiver.newest(),
        }
    }

    /// The measurement of `cycle` left at `at_s` \[s\].
    pub fn departed(&mut self, cycle: u64, at_s: f64) {
        self.departed[cycle as usize % REMEMBERED] = Some(at_s);
    }

    /// From the measurement of cycle `earlier` to that of `later` \[s\], where both are
    /// known.
    pub fn between(&self, earlier: u64, later: u64) -> Option<f64> {
        let at = |cycle: u64| self.departed[cycle as usize % REMEMBERED];
        Some(at(later)? - at(earlier)?)
    }

    /// Whether an answer was accepted.
    pub fn has_begun(&self) -> bool {
        self.answered.is_some()
    }

    /// The cycle whose measurement `order` answers, if it may act.
    pub fn place(&mut self, order: &Order, link: &mut LinkFigures) -> Result<u64, Answer> {
        let sent = self.sent[usize::from(order.reflected) % REMEMBERED];
        let Some((_, cycle)) = sent.filter(|(counter, _)| *counter == order.reflected) else {
            link.rejected.reflection += 1;
            return Err(Answer::Rejected);
        };
        match self.receiver.receive(order.counter) {
            Arrival::Repeated => {
                link.repeated += 1;
                return Err(Answer::Repeated);
            }
            Arrival::Old => {
                link.old += 1;
                return Err(Answer::Old);
            }
            Arrival::First => (),
            Arrival::Next { lost } => link.lost += u64::from(lost),
        }
        match self.answered {
            Some(last) if cycle < last => {
                link.old += 1;
                Err(Answer::Old)
            }
            Some(last) if cycle == last => {
                // Cycle 0 sends again until it has an answer; several are no fault.
                link.repeated += u64::from(cycle > 0);
                Err(Answer::Repeated)
            }
            _ => Ok(cycle),
        }
    }

    /// The answer to `cycle` is the newest; with its latency \[s\] if in time.
    pub fn accepted(&mut self, cycle: u64, in_time: Option<f64>) {
        self.answered = Some(cycle);
        self.in_time = self.in_time.or(in_time);
    }

    /// Whether the present cycle has an answer in time.
    pub fn is_answered(&self) -> bool {
        self.in_time.is_some()
    }

    /// Latency of the answer to this cycle \[s\], if there was one; the next begins.
    pub fn end_of_cycle(&mut self) -> Option<f64> {
        self.in_time.take()
    }

    /// Takes any counter next.
    pub fn forget_counter(&mut self) {
        self.receiver.reset();
    }
}

/// Counts a datagram that cannot be read.
pub fn count_error(rejected: &mut Rejected, error: &Error) {
    match error {
        Error::Length { .. } => rejected.length += 1,
        Error::NotFinite { .. } => rejected.not_finite += 1,
        _ => rejected.header += 1,
    }
}

/// Counts an answer whose content is not used.
pub fn count_refusal(rejected: &mut Rejected, refusal: Refusal) {
    match refusal {
        Refusal::Flags => rejected.flags += 1,
        Refusal::Jump => rejected.jump += 1,
        Refusal::Torque => rejected.torque += 1,
    }
}
