//! `[joint_limits]` with some of its keys: the others are what they are without the table.

use cell::scenario::Scenario;
use controller_core::arm::{ArmModel, JointLimits};
use controller_core::law::limits::{joint_limits, own_joint_limits};

use super::scenario;

const TOOL: &str = "tool = { mass_kg = 1.5, center_of_mass_m = [0, 0, 0.1], \
                    inertia_kg_m2 = [0.01, 0, 0, 0.01, 0, 0.01] }\n";

/// What a controller of `robot` with a tool holds the joints to, with these tables.
fn held(robot: &str, tables: &str, cycle_s: f64, dead_cycles: u8) -> JointLimits {
    let scenario = Scenario::parse(&scenario(robot, TOOL, tables, "")).expect(robot);
    assert_eq!(scenario.joint_limits.is_some(), !tables.is_empty());
    let arm = scenario.arm().parameters;
    let model = ArmModel::<f64>::new(&arm).expect("an arm");
    joint_limits(&arm, &model, cycle_s, dead_cycles)
}

/// The LWR says it of itself; of the others the rule knows the tool, and every controller its
/// own cycle and dead time.
#[test]
fn keys_that_are_missing_are_what_they_are_without_the_table() {
    for robot in ["lwr_iv", "iiwa_14", "gen3"] {
        for (cycle_s, dead_cycles) in [(0.002, 0), (0.002, 3), (0.02, 8)] {
            let with = |tables: &str| held(robot, tables, cycle_s, dead_cycles);
            let without = with("");
            assert_eq!(with("[joint_limits]\n"), without, "{robot}");
            let margin = JointLimits {
                margin: 3.0_f64.to_radians(),
                ..without
            };
            assert_eq!(with("[joint_limits]\nmargin_deg = 3\n"), margin, "{robot}");
        }
    }
}

/// A larger alpha keeps the kv of the arm, and where the cycle bounds that one, alpha is less by
/// the same share.
#[test]
fn what_is_given_is_bounded_by_the_cycle_as_what_is_not() {
    for robot in ["lwr_iv", "iiwa_14", "gen3"] {
        let own = held(robot, "", 1e-4, 0);
        let twice = own.acceleration.map(|alpha| 2.0 * alpha);
        let tables = format!("[joint_limits]\nacceleration = {twice:?}\n");
        for (cycle_s, dead_cycles) in [(0.002, 0), (0.002, 3), (0.02, 8)] {
            let without = held(robot, "", cycle_s, dead_cycles);
            let limits = held(robot, &tables, cycle_s, dead_cycles);
            assert_eq!(limits.speed_gain, without.speed_gain, "{robot}");
            for (given, own) in limits.acceleration.iter().zip(without.acceleration) {
                assert!((given / own - 2.0).abs() < 1e-14, "{robot} {given} {own}");
            }
        }
    }
}

/// Every arm is answered for itself, however many were asked before it: without and with a tool,
/// and again.
#[test]
fn answers_of_arms_are_not_mixed_up() {
    let margin = "[joint_limits]\nmargin_deg = 3\n";
    for _ in 0..2 {
        for robot in arms::ALL.map(|arm| arm.name) {
            for keys in ["", TOOL] {
                let of = |tables: &str| {
                    let text = scenario(robot, keys, tables, "");
                    Scenario::parse(&text).expect(robot).arm().parameters
                };
                let bare = of("");
                let model = ArmModel::<f64>::new(&bare).expect("an arm");
                let expected = JointLimits {
                    margin: 3.0_f64.to_radians(),
                    ..own_joint_limits(&bare, &model)
                };
                assert_eq!(of(margin).limits, Some(expected), "{robot}");
            }
        }
    }
}
