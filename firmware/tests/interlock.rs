//! Emergency stop, drive enable and heartbeat on pins that check every call.

use controller_core::joint::JointVector;
use controller_core::{Measurement, Reference};
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use firmware::interlock::{Cause, Interlock};
use firmware::interlocked_controller::InterlockedController;
use firmware::scenario::{CYCLE_S, FixedScenario, ReadyScenario};

const HIGH: State = State::High;
const LOW: State = State::Low;

/// An input that gives these levels, one per cycle, an output that expects these.
fn input(levels: &[State]) -> Mock {
    let calls: Vec<_> = levels.iter().copied().map(Transaction::get).collect();
    Mock::new(&calls)
}

fn output(levels: &[State]) -> Mock {
    let calls: Vec<_> = levels.iter().copied().map(Transaction::set).collect();
    Mock::new(&calls)
}

/// Plays the cycles, then releases (which makes safe once more) and checks that
/// every expected call was made.
fn play(
    stop: &[State],
    drives: &[State],
    heartbeat: &[State],
    script: impl FnOnce(&mut Interlock<Mock, Mock, Mock>),
) {
    let mut interlock = Interlock::new(input(stop), output(drives), output(heartbeat));
    script(&mut interlock);
    let (mut stop, mut drives, mut heartbeat) = interlock.release();
    stop.done();
    drives.done();
    heartbeat.done();
}

#[test]
fn drives_wait_for_a_request_and_the_heart_beats_without() {
    play(
        &[HIGH; 4],
        &[LOW, LOW, LOW, HIGH, HIGH, LOW],
        &[LOW, HIGH, LOW, HIGH, LOW, LOW],
        |interlock| {
            assert_eq!(interlock.cycle(true), Err(Cause::NotEnabled));
            assert_eq!(interlock.cycle(true), Err(Cause::NotEnabled));
            interlock.enable();
            assert_eq!(interlock.cycle(true), Ok(()));
            assert_eq!(interlock.cycle(true), Ok(()));
        },
    );
}

#[test]
fn the_emergency_stop_is_safe_in_its_cycle_and_stays_so_when_let_go() {
    play(
        &[HIGH, LOW, HIGH, HIGH],
        &[LOW, HIGH, LOW, LOW, HIGH, LOW],
        &[LOW, HIGH, LOW, HIGH, LOW, LOW],
        |interlock| {
            interlock.enable();
            assert_eq!(interlock.cycle(true), Ok(()));
            assert_eq!(interlock.cycle(true), Err(Cause::EmergencyStop));
            assert_eq!(interlock.cycle(true), Err(Cause::NotEnabled));
            interlock.enable();
            assert_eq!(interlock.cycle(true), Ok(()));
        },
    );
}

#[test]
fn a_request_while_the_stop_is_pressed_counts_for_nothing() {
    play(
        &[LOW, HIGH],
        &[LOW, LOW, LOW, LOW],
        &[LOW, LOW, HIGH, LOW],
        |interlock| {
            interlock.enable();
            assert_eq!(interlock.cycle(true), Err(Cause::EmergencyStop));
            assert_eq!(interlock.cycle(true), Err(Cause::NotEnabled));
        },
    );
}

#[test]
fn a_fault_is_safe_in_its_cycle_and_the_heart_stands_still() {
    play(
        &[HIGH; 4],
        &[LOW, HIGH, LOW, LOW, LOW, LOW],
        &[LOW, HIGH, LOW, LOW, HIGH, LOW],
        |interlock| {
            interlock.enable();
            assert_eq!(interlock.cycle(true), Ok(()));
            assert_eq!(interlock.cycle(false), Err(Cause::Controller));
            assert_eq!(interlock.cycle(false), Err(Cause::Controller));
            assert_eq!(interlock.cycle(true), Err(Cause::NotEnabled));
        },
    );
}

#[test]
fn a_stop_that_cannot_be_read_counts_as_pressed() {
    let broken = Transaction::get(HIGH).with_error(MockError::Io(std::io::ErrorKind::Other));
    let stop = Mock::new(&[Transaction::get(HIGH), broken]);
    let mut interlock = Interlock::new(
        stop,
        output(&[LOW, HIGH, LOW, LOW]),
        output(&[LOW, HIGH, LOW, LOW]),
    );
    interlock.enable();
    assert_eq!(interlock.cycle(true), Ok(()));
    assert_eq!(interlock.cycle(true), Err(Cause::EmergencyStop));
    let (mut stop, mut drives, mut heartbeat) = interlock.release();
    stop.done();
    drives.done();
    heartbeat.done();
}

#[test]
fn an_output_that_fails_takes_the_other_one_down() {
    let broken = Transaction::set(HIGH).with_error(MockError::Io(std::io::ErrorKind::Other));
    let drives = Mock::new(&[
        Transaction::set(LOW),
        broken,
        Transaction::set(LOW),
        Transaction::set(LOW),
    ]);
    let mut interlock = Interlock::new(input(&[HIGH]), drives, output(&[LOW, HIGH, LOW, LOW]));
    interlock.enable();
    assert_eq!(interlock.cycle(true), Err(Cause::Output));
    let (mut stop, mut drives, mut heartbeat) = interlock.release();
    stop.done();
    drives.done();
    heartbeat.done();
}

/// Controller and interlock: torque only while the drives run, zero from the cycle of a
/// fault on, and again after it is cleared on purpose.
#[test]
fn a_measurement_that_cannot_be_true_stops_the_arm_within_its_cycle() {
    let ready = ReadyScenario::<f64>::new(FixedScenario::TwoLevel).expect("a valid scenario");
    let interlock = Interlock::new(
        input(&[HIGH; 7]),
        output(&[LOW, LOW, HIGH, LOW, LOW, HIGH, LOW, LOW, LOW]),
        output(&[LOW, HIGH, LOW, LOW, LOW, HIGH, LOW, HIGH, LOW]),
    );
    let mut interlocked = InterlockedController::new(ready.controller.clone(), interlock);
    let good = Measurement {
        q: ready.origin.posture,
        dq: JointVector::zeros(),
        interval_s: CYCLE_S,
    };
    let mut bad = good;
    bad.dq[3] = f64::NAN;

    let waiting = interlocked.cycle(&good, &ready.reference(0));
    assert_eq!(waiting.stopped, Some(Cause::NotEnabled));
    assert_eq!(waiting.torque, JointVector::zeros());
    interlocked.enable();
    let running = interlocked.cycle(&good, &ready.reference(1));
    assert_eq!(running.stopped, None);
    assert_eq!(running.torque, running.step.torque);
    assert!(running.torque[1].abs() > 10.0);
    let stopped = interlocked.cycle(&bad, &ready.reference(2));
    assert_eq!(stopped.stopped, Some(Cause::Controller));
    assert_eq!(stopped.torque, JointVector::zeros());
    let latched = interlocked.cycle(&good, &ready.reference(3));
    assert_eq!(latched.stopped, Some(Cause::Controller));
    interlocked.enable();
    assert_eq!(interlocked.cycle(&good, &ready.reference(4)).stopped, None);

    // No measurement at all: off, and off it stays.
    interlocked.blind();
    let after = interlocked.cycle(&good, &ready.reference(5));
    assert_eq!(after.stopped, Some(Cause::NotEnabled));

    let numbers: Vec<_> = interlocked
        .recorder()
        .iter()
        .map(|cycle| cycle.number)
        .collect();
    assert_eq!(numbers, [0, 1, 2, 3, 4, 5]);
    let (mut stop, mut drives, mut heartbeat) = interlocked.release();
    stop.done();
    drives.done();
    heartbeat.done();
}

/// A fault of the reference: the measurement is good, so the drives stay on and hold.
#[test]
fn a_fault_that_is_seen_is_braked_by_the_drives() {
    let ready = ReadyScenario::<f64>::new(FixedScenario::TwoLevel).expect("a valid scenario");
    let interlock = Interlock::new(
        input(&[HIGH; 4]),
        output(&[LOW, HIGH, HIGH, HIGH, LOW, LOW]),
        output(&[LOW, HIGH, LOW, HIGH, LOW, LOW]),
    );
    let mut interlocked = InterlockedController::new(ready.controller.clone(), interlock);
    let good = Measurement {
        q: ready.origin.posture,
        dq: JointVector::zeros(),
        interval_s: CYCLE_S,
    };
    let wrong = Reference::hold(2, good.q);
    interlocked.enable();
    for cycle in 0..3 {
        let reference = if cycle == 0 {
            &ready.reference(0)
        } else {
            &wrong
        };
        let output = interlocked.cycle(&good, reference);
        assert_eq!(output.stopped, None);
        assert_eq!(output.step.status.fault.is_some(), cycle > 0);
        assert_eq!(output.torque, output.step.torque);
        assert!(output.torque[1].abs() > 10.0);
    }
    // Blind, the drives' own brakes are left.
    let mut bad = good;
    bad.q[0] = f64::NAN;
    let output = interlocked.cycle(&bad, &wrong);
    assert_eq!(output.stopped, Some(Cause::Controller));
    assert_eq!(output.torque, JointVector::zeros());
    let (mut stop, mut drives, mut heartbeat) = interlocked.release();
    stop.done();
    drives.done();
    heartbeat.done();
}

/// What a board without a planner sends: the arm sinks while the drives are off, and is
/// held where it is when they are asked for, not where the first measurement was.
#[test]
fn levels_hold_where_the_drives_are_asked_for() {
    let ready = ReadyScenario::<f64>::new(FixedScenario::Case1).expect("a valid scenario");
    let at = |q| Measurement {
        q,
        dq: JointVector::zeros(),
        interval_s: CYCLE_S,
    };
    let first = ready.origin.posture;
    let sunk = first + JointVector::repeat(0.1);
    let asked = |before: usize, reference: &mut Reference<f64>| {
        let off = vec![LOW; before];
        let beats: Vec<State> = [HIGH, LOW].into_iter().cycle().take(before + 1).collect();
        let interlock = Interlock::new(
            input(&vec![HIGH; before + 1]),
            output(&[&[LOW], &off[..], &[HIGH, LOW]].concat()),
            output(&[&[LOW], &beats[..], &[LOW]].concat()),
        );
        let mut interlocked = InterlockedController::new(ready.controller.clone(), interlock);
        for _ in 0..before {
            let waiting = interlocked.cycle(&at(first), reference);
            assert_eq!(waiting.stopped, Some(Cause::NotEnabled));
        }
        reference.posture = sunk;
        interlocked.enable();
        let output = interlocked.cycle(&at(sunk), reference);
        assert_eq!(output.stopped, None);
        let (mut stop, mut drives, mut heartbeat) = interlocked.release();
        stop.done();
        drives.done();
        heartbeat.done();
        output.torque
    };
    let levels = ready.controller.level_count();
    let held = asked(3, &mut Reference::hold(levels, JointVector::zeros()));
    assert_eq!(held, asked(0, &mut ready.controller.rest_reference(&sunk)));
}
