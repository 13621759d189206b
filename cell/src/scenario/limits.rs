//! Scenarios near and beyond what an arm can do.

/// Name and TOML text of each, beside the built-in ones: `run` takes them as files.
pub const NEAR_LIMITS: &[(&str, &str)] = &[
    (
        "reach-30-inside",
        include_str!("../../scenarios/limits/reach-30-inside.toml"),
    ),
    (
        "reach-3-inside",
        include_str!("../../scenarios/limits/reach-3-inside.toml"),
    ),
    ("reach", include_str!("../../scenarios/limits/reach.toml")),
    (
        "reach-30-beyond",
        include_str!("../../scenarios/limits/reach-30-beyond.toml"),
    ),
    (
        "fast-30-beyond",
        include_str!("../../scenarios/limits/fast-30-beyond.toml"),
    ),
    (
        "chord-40-beyond",
        include_str!("../../scenarios/limits/chord-40-beyond.toml"),
    ),
    (
        "overhead",
        include_str!("../../scenarios/limits/overhead.toml"),
    ),
    (
        "wrist-beyond",
        include_str!("../../scenarios/limits/wrist-beyond.toml"),
    ),
    (
        "wrist-beyond-y",
        include_str!("../../scenarios/limits/wrist-beyond-y.toml"),
    ),
    (
        "wrist-beyond-circle",
        include_str!("../../scenarios/limits/wrist-beyond-circle.toml"),
    ),
    (
        "reach-30-beyond-wrist",
        include_str!("../../scenarios/limits/reach-30-beyond-wrist.toml"),
    ),
    (
        "fast-30-beyond-wrist",
        include_str!("../../scenarios/limits/fast-30-beyond-wrist.toml"),
    ),
    (
        "reach-30-beyond-orientation",
        include_str!("../../scenarios/limits/reach-30-beyond-orientation.toml"),
    ),
    (
        "wrist-straight",
        include_str!("../../scenarios/limits/wrist-straight.toml"),
    ),
    (
        "straight-back",
        include_str!("../../scenarios/limits/straight-back.toml"),
    ),
    (
        "straight-back-orientation",
        include_str!("../../scenarios/limits/straight-back-orientation.toml"),
    ),
    (
        "straight-back-below-orientation",
        include_str!("../../scenarios/limits/straight-back-below-orientation.toml"),
    ),
    (
        "upright-back",
        include_str!("../../scenarios/limits/upright-back.toml"),
    ),
    (
        "bent-1-back-wrist",
        include_str!("../../scenarios/limits/bent-1-back-wrist.toml"),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn they_are_valid_and_bear_their_name() {
        for (name, text) in NEAR_LIMITS {
            assert_eq!(Scenario::parse(text).expect(name).name, *name);
        }
    }
}
