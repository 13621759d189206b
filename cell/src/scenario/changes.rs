//! Scenarios whose tasks change on the way.

/// Name and TOML text of each, beside the built-in ones: `run` takes them as files.
pub const CHANGES: &[(&str, &str)] = &[
    (
        "changing-tasks",
        include_str!("../../scenarios/changes/changing-tasks.toml"),
    ),
    (
        "changing-tasks-in-conflict",
        include_str!("../../scenarios/changes/changing-tasks-in-conflict.toml"),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn they_are_valid_and_bear_their_name() {
        for (name, text) in CHANGES {
            assert_eq!(Scenario::parse(text).expect(name).name, *name);
        }
    }
}
