//! The damaged datagrams of the example `mutate_session`, as many as a test run can afford.

#[path = "../examples/mutate_session/mutator.rs"]
mod mutator;

use hostile::{missing, run};

use mutator::{Franka, Kuka, Robot, Sessions};

fn check<R: Robot>(count: u64) {
    let tables = run(count, 7, Sessions::<R>::new).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(missing(&tables), None, "{tables:?}");
}

#[test]
fn damaged_measurements_never_harm_a_session_with_the_lwr() {
    check::<Kuka>(100_000);
}

#[test]
fn damaged_states_never_harm_a_session_with_a_franka_arm() {
    check::<Franka>(100_000);
}
