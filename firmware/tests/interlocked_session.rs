//! The controller at the end of a datagram link, with pins and a link that write down
//! what happens in which order.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use bridge::session::Phase;
use bridge::transport::DatagramLink;
use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::joint::zeros;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use firmware::interlock::{Cause, Interlock};
use firmware::interlocked_session::{self, Event, FixedScenarioSource, InterlockedSession};
use firmware::scenario::{CYCLE_S, FixedScenario, ReadyScenario};
use fri::{Command, CommandPacket, ControlScheme, InterfaceState, Measurement, Quality};

const SILENCE_S: f64 = 2.0;

/// What happened, in its order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Entry {
    Drives(bool),
    Heartbeat(bool),
    Sent,
}

type Journal = Rc<RefCell<Vec<Entry>>>;

/// The emergency stop: true is released.
struct Stop(Rc<Cell<bool>>);

impl ErrorType for Stop {
    type Error = Infallible;
}

impl InputPin for Stop {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.get())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.get())
    }
}

/// An output that writes down its levels.
struct Output(Journal, fn(bool) -> Entry);

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().push(self.1(true));
        Ok(())
    }

    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().push(self.1(false));
        Ok(())
    }
}

/// A link whose other end is the test.
struct Line {
    coming: VecDeque<Vec<u8>>,
    answer: Option<Vec<u8>>,
    journal: Journal,
}

impl DatagramLink for Line {
    type Error = Infallible;

    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Infallible> {
        Ok(self.coming.pop_front().map(|datagram| {
            buffer[..datagram.len()].copy_from_slice(&datagram);
            datagram.len()
        }))
    }

    fn send(&mut self, datagram: &[u8]) -> Result<(), Infallible> {
        self.journal.borrow_mut().push(Entry::Sent);
        self.answer = Some(datagram.to_vec());
        Ok(())
    }
}

/// A robot that stands still, the controller, and what came of them.
struct Rig {
    interlocked: InterlockedSession<Line, Stop, Output, Output>,
    measurement: Measurement,
    released: Rc<Cell<bool>>,
    journal: Journal,
}

impl Rig {
    fn new() -> Self {
        let scenario = FixedScenario::TwoLevel;
        let journal = Journal::default();
        let released = Rc::new(Cell::new(true));
        let interlock = Interlock::new(
            Stop(released.clone()),
            Output(journal.clone(), Entry::Drives),
            Output(journal.clone(), Entry::Heartbeat),
        );
        let line = Line {
            coming: VecDeque::new(),
            answer: None,
            journal: journal.clone(),
        };
        let config = interlocked_session::config(scenario).expect("a valid scenario");
        let source = FixedScenarioSource::new(scenario).expect("a valid scenario");
        Self {
            interlocked: InterlockedSession::new(config, source, line, interlock, SILENCE_S),
            measurement: standing(scenario),
            released,
            journal,
        }
    }

    /// A poll; what happened in it.
    fn poll(&mut self) -> (Event, Vec<Entry>) {
        self.journal.borrow_mut().clear();
        let Ok(event) = self.interlocked.poll(CYCLE_S);
        (event, self.journal.borrow().clone())
    }

    /// A measurement comes and is polled for.
    fn cycle(&mut self) -> (Event, Vec<Entry>) {
        let header = &mut self.measurement.header;
        header.counter = header.counter.wrapping_add(1);
        let mut bytes = [0; Measurement::LEN];
        self.measurement.emit(&mut bytes);
        self.interlocked.link().coming.push_back(bytes.to_vec());
        let seen = self.poll();
        if let Some(answer) = self.interlocked.link().answer.take() {
            let packet = CommandPacket::new_checked(answer).expect("a good answer");
            self.measurement.header.reflected = Command::parse(&packet).header.counter;
        }
        seen
    }

    fn phase(&self) -> Phase {
        self.interlocked.session().phase()
    }

    /// Until the arm moves.
    fn move_on(&mut self) {
        for _ in 0..10 {
            self.cycle();
        }
        self.measurement.state = InterfaceState::Command;
        for _ in 0..1000 {
            if self.phase() == Phase::Moving {
                return;
            }
            self.cycle();
        }
        panic!("does not move: {:?}", self.phase());
    }
}

fn standing(scenario: FixedScenario) -> Measurement {
    let ready = ReadyScenario::<f64>::new(scenario).expect("a valid scenario");
    let start = scenario.start_deg().map(|q| q.to_radians() as f32);
    let measured = controller_core::Measurement {
        q: start.map(f64::from).into(),
        dq: zeros(),
        interval_s: CYCLE_S,
    };
    let input = Input {
        measurement: &measured,
        reference: &ready.origin,
    };
    let mut data = Data::new();
    (ready.controller).evaluate_until(StageName::Dynamics, &input, &mut data);
    let dynamics = data.dynamics;
    let mut measurement = Measurement {
        state: InterfaceState::Monitor,
        quality: Quality::Perfect,
        period_s: CYCLE_S as f32,
        command_period_s: CYCLE_S as f32,
        joint_position: start,
        commanded_position: start,
        gravity: <[f64; 7]>::from(dynamics.gravity).map(|g| g as f32),
        ..Measurement::default()
    };
    measurement.drives.power = 0x7F;
    measurement.drives.control = ControlScheme::JointImpedance;
    for (row, values) in measurement.mass_matrix.iter_mut().enumerate() {
        for (column, value) in values.iter_mut().enumerate() {
            *value = dynamics.mass_matrix[(row, column)] as f32;
        }
    }
    measurement
}

/// The outputs were set low and, where an answer left at all, before it.
fn is_safe(journal: &[Entry]) -> bool {
    let place = |entry| journal.iter().rposition(|&seen| seen == entry);
    let sent = place(Entry::Sent).unwrap_or(journal.len());
    let low = |low, high| place(low).is_some_and(|low| low < sent && place(high) < Some(low));
    low(Entry::Drives(false), Entry::Drives(true))
        && low(Entry::Heartbeat(false), Entry::Heartbeat(true))
}

#[test]
fn drives_run_in_command_state_only() {
    let mut rig = Rig::new();
    for _ in 0..300 {
        let (event, journal) = rig.cycle();
        assert!(matches!(
            event,
            Event::Answered {
                stopped: Some(Cause::NotEnabled),
                ..
            }
        ));
        assert!(!journal.contains(&Entry::Drives(true)), "{journal:?}");
    }
    rig.move_on();
    for _ in 0..10 {
        let (_, journal) = rig.cycle();
        let answer = journal.iter().position(|&entry| entry == Entry::Sent);
        let drives = journal
            .iter()
            .position(|&entry| entry == Entry::Drives(true));
        assert!(drives.is_some() && drives < answer, "{journal:?}");
    }
    // The robot falls back to monitor state: safe at once, and off until it is asked again.
    rig.measurement.state = InterfaceState::Monitor;
    let (_, journal) = rig.cycle();
    assert!(is_safe(&journal), "{journal:?}");
    let (_, journal) = rig.cycle();
    assert!(!journal.contains(&Entry::Drives(true)), "{journal:?}");
}

#[test]
fn the_emergency_stop_acts_before_the_answer_leaves() {
    let mut rig = Rig::new();
    rig.move_on();
    rig.released.set(false);
    let (event, journal) = rig.cycle();
    assert!(matches!(
        event,
        Event::Answered {
            stopped: Some(Cause::EmergencyStop),
            ..
        }
    ));
    assert!(is_safe(&journal), "{journal:?}");
    // Letting go moves nothing.
    rig.released.set(true);
    for _ in 0..100 {
        let (_, journal) = rig.cycle();
        assert!(!journal.contains(&Entry::Drives(true)), "{journal:?}");
    }
}

#[test]
fn a_jump_of_the_measured_position_is_safe_in_its_cycle() {
    let mut rig = Rig::new();
    rig.move_on();
    rig.measurement.joint_position[1] += 0.5;
    let (event, journal) = rig.cycle();
    assert!(
        matches!(
            event,
            Event::Answered {
                stopped: Some(Cause::Controller),
                ..
            }
        ),
        "{event:?}"
    );
    assert!(is_safe(&journal), "{journal:?}");
    assert!(rig.interlocked.session().fault().is_some());
}

#[test]
fn silence_is_safe_in_the_poll_that_notices_it() {
    let mut rig = Rig::new();
    // Nobody was heard yet: nothing to lose.
    for _ in 0..2000 {
        assert_eq!(rig.poll(), (Event::Quiet, Vec::new()));
    }
    rig.move_on();
    let borne = (SILENCE_S / CYCLE_S) as usize;
    for _ in 0..borne - 1 {
        assert_eq!(rig.poll(), (Event::Quiet, Vec::new()));
    }
    let noticed = (0..3)
        .map(|_| rig.poll())
        .find(|(event, _)| *event == Event::Silent);
    let (_, journal) = noticed.expect("the silence is noticed");
    assert!(is_safe(&journal), "{journal:?}");
}

#[test]
fn what_is_no_measurement_is_refused_and_counts_as_silence() {
    let mut rig = Rig::new();
    rig.move_on();
    let mut refused = 0;
    let silent = (0..1100).find(|_| {
        rig.interlocked.link().coming.push_back(vec![7; 100]);
        let (event, journal) = rig.poll();
        refused += usize::from(event == Event::Refused);
        assert!(!journal.contains(&Entry::Sent));
        rig.poll().0 == Event::Silent
    });
    assert!(refused > 900 && silent.is_some(), "{refused} {silent:?}");
}
