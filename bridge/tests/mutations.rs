//! The damaged datagrams of the example `mutate`, as many as a test run can afford.

#[path = "../examples/mutate_session/mutator.rs"]
mod mutator;

#[test]
fn damaged_datagrams_never_harm_a_session() {
    let table = mutator::run(50_000, 7).unwrap_or_else(|failure| panic!("{failure}"));
    let all = [
        table.answered,
        table.with_torque,
        table.rejected,
        table.stale,
    ];
    assert!(all.iter().all(|count| *count > 100), "{table}");
    // Single damaged datagrams end no session: only rows of them do.
    assert!((1..100).contains(&table.ended), "{table}");
}
