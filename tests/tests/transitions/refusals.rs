//! Changes that cannot be are refused by name, value and what is allowed, and change nothing.

use arms::LWR_IV;
use controller_core::gain::diagonal;
use controller_core::law::null_space::NullDamping;
use controller_core::{
    Axes, Capacity, Change, ChangeError, Controller, NullSpace, Order, State, Task, TaskGains,
    TaskSet,
};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, three_level, two_level};

fn controller() -> Controller<f64> {
    let mut config = two_level();
    config.tasks = (config.tasks)
        .with_capacity(Capacity { levels: 3, rows: 7 })
        .expect("room");
    Controller::new(&LWR_IV, &config).expect("valid")
}

/// Why a change is refused, prepared or begun.
fn refusal(controller: &Controller<f64>, change: &Change) -> ChangeError {
    let mut state = State::new();
    let prepared = controller.transition(change, 0.5);
    let begun = prepared.and_then(|prepared| controller.begin(&mut state, &prepared));
    let error = begun.expect_err("refused");
    assert!(!state.data().tasks.changing().any());
    assert_eq!(controller.order(&state), Order::new(&[0]).expect("one"));
    error
}

fn task(axes: Axes) -> Task {
    Task::position(FLANGE, axes, REFERENCE_GAINS)
}

#[test]
fn each_refusal_says_what_was_given_and_what_is_allowed() {
    let add = |slot, place, axes| Change::Add {
        slot,
        task: task(axes),
        place,
    };
    let gains = |slot, stiffness, damping| Change::Gains {
        slot,
        gains: TaskGains::uniform(stiffness, damping),
    };
    let stiff = NullSpace {
        damping: NullDamping::Joint(diagonal([1e4; 7])),
        ..two_level().null_space
    };
    let other = NullSpace {
        damping: NullDamping::Inertia(10.0),
        ..two_level().null_space
    };
    let order = |slots: &[usize]| Change::Reorder(Order::new(slots).expect("an order"));
    for (change, words) in [
        (add(3, 1, Axes::X), "slot 3: allowed 0 to 2"),
        (add(0, 1, Axes::X), "slot 0 has a task"),
        (
            add(1, 2, Axes::X),
            "place 2 among the levels: allowed 0 to 1",
        ),
        (Change::Remove { slot: 1 }, "slot 1 has no task"),
        (gains(1, 400.0, 40.0), "slot 1 has no task"),
        (gains(0, -1.0, 40.0), "level 1: task stiffness [1/s2]"),
        (gains(0, 400.0, 4000.0), "level 1"),
        (
            order(&[1]),
            "order of the slots: 1; allowed: each of 0 once",
        ),
        (
            order(&[]),
            "order of the slots: none; allowed: each of 0 once",
        ),
        (Change::NullSpace(stiff), "null-space damping"),
        (Change::NullSpace(other), "of another kind"),
    ] {
        let text = refusal(&controller(), &change).to_string();
        assert!(text.contains(words), "{change:?}\n{text}");
    }
}

#[test]
fn rows_that_still_leave_count() {
    let mut config = three_level();
    config.tasks = (config.tasks)
        .with_capacity(Capacity { levels: 3, rows: 6 })
        .expect("room");
    let controller = Controller::<f64>::new(&LWR_IV, &config).expect("valid");
    let mut state = State::new();
    let mut begin = |change: Change| {
        let prepared = controller.transition(&change, 0.5).expect("can be");
        controller.begin(&mut state, &prepared)
    };
    begin(Change::Remove { slot: 1 }).expect("there");
    let add = Change::Add {
        slot: 2,
        task: task(Axes::XY),
        place: 0,
    };
    let error = begin(add).expect_err("no room yet");
    assert_eq!(
        error,
        ChangeError::Rows {
            rows: 7,
            allowed: 6
        }
    );
    // Another task in a slot that one is leaving.
    let add = Change::Add {
        slot: 1,
        task: task(Axes::X),
        place: 0,
    };
    assert_eq!(begin(add), Err(ChangeError::SlotTaken { slot: 1 }));
}

#[test]
fn tasks_of_the_exact_law_stay() {
    let controller = Controller::<f64>::exact(&LWR_IV, &three_level()).expect("valid");
    for change in [
        Change::Remove { slot: 1 },
        Change::Reorder(Order::new(&[1, 0]).expect("two")),
    ] {
        let error = controller.transition(&change, 0.5).expect_err("refused");
        assert_eq!(error, ChangeError::ExactLaw);
    }
    let softer = Change::Gains {
        slot: 0,
        gains: TaskGains::uniform(100.0, 20.0),
    };
    assert!(controller.transition(&softer, 0.5).is_ok());
    assert!(controller.transition(&softer, 0.01).is_err());
    assert!(controller.transition(&softer, f64::NAN).is_err());
}

#[test]
fn room_is_what_the_tasks_take_or_more() {
    let set = three_level().tasks;
    for (levels, rows) in [(1, 12), (8, 12), (2, 4), (2, 13)] {
        let error = set
            .with_capacity(Capacity { levels, rows })
            .expect_err("refused");
        let text = error.to_string();
        assert!(
            text.contains("2 to 7 levels") && text.contains("5 to 12 rows"),
            "{text}"
        );
    }
    assert_eq!(
        TaskSet::new(set.tasks()).expect("valid").capacity(),
        set.capacity()
    );
}
