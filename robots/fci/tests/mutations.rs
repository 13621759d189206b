//! The damaged datagrams and streams of the example `mutate`, as many as a test run can afford.

#[path = "../examples/mutate/mutator.rs"]
mod mutator;

#[test]
fn damaged_datagrams_and_streams() {
    let table = mutator::run(100_000, 2018).unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(table.missing(), None, "\n{table}");
}

/// The same seed gives the same cases, another one others.
#[test]
fn the_seed_decides() {
    let text = |seed| mutator::run(10_000, seed).map(|table| table.to_string());
    assert_eq!(text(1), text(1));
    assert_ne!(text(1), text(2));
}
