//! The damaged datagrams of the example `mutate`, as many as a test run can afford.

#[path = "../examples/mutate/mutator.rs"]
mod mutator;

use mutator::Datagrams;

#[test]
fn damaged_datagrams() {
    let tables = hostile::run(100_000, 2018, Datagrams::new);
    let tables = tables.unwrap_or_else(|failure| panic!("{failure}"));
    assert_eq!(hostile::missing(&tables), None, "{tables:?}");
}
