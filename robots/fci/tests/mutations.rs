//! The damaged datagrams and streams of the example `mutate`, as many as a test run can afford.

#[path = "../examples/mutate/mutator.rs"]
mod mutator;

use hostile::{Cases, missing, run};

use mutator::{Clients, Datagrams, Robots, Streams};

fn check<C: Cases>(count: u64, new: impl Fn() -> C + Sync) {
    let tables = run(count, 2018, new).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(missing(&tables), None, "{tables:?}");
}

#[test]
fn damaged_datagrams_into_the_codec() {
    check(100_000, Datagrams::new);
}

#[test]
fn damaged_streams_into_the_codec() {
    check(100_000, Streams::new);
}

#[test]
fn hostile_states_and_streams_into_the_client() {
    check(100_000, Clients::new);
}

#[test]
fn hostile_commands_and_streams_into_the_robot() {
    check(100_000, Robots::new);
}
