//! The URDF that the robot answers with, read again by the reader of URDFs.

use cell::model::agreement::Agreement;
use cell::model::chain::{Angles, Chain, Choice, Impossible};
use cell::model::urdf::Urdf;
use controller_core::arm::{ArmModel, ArmParameters};
use hil_sim::model::search::states;
use hil_sim::robot::urdf;

fn chain(arm: &ArmParameters) -> Chain {
    let text = urdf::text(arm);
    let urdf = Urdf::parse(&text).expect("a URDF");
    let choice = Choice {
        base: None,
        tip: None,
        continuous: std::f64::consts::TAU,
        impossible: Impossible::Refused,
    };
    Chain::new(&urdf, &choice, Angles::AsPrinted).expect("seven joints in a row")
}

#[test]
fn it_is_the_arm_of_the_table() {
    for arm in arms::ALL {
        let model = ArmModel::new(arm).expect("a table");
        let agreement = Agreement::of(arm, &model, &chain(arm), states(arm, 100));
        let Agreement {
            mass_matrix,
            gravity,
            coriolis,
            position,
            rotation,
        } = &agreement;
        for apart in [mass_matrix, gravity, coriolis, position, rotation] {
            assert!(apart.share() < 1e-12, "{}: {agreement:?}", arm.name);
        }
    }
}

#[test]
fn names_are_those_that_the_vendors_client_looks_for() {
    let text = urdf::text(&arms::FR3);
    for name in (0..=8).map(|i| format!("<link name=\"link{i}\"")) {
        assert!(text.contains(&name), "{name}");
    }
    for name in (1..=7).map(|i| format!("<joint name=\"joint{i}\" type=\"revolute\"")) {
        assert!(text.contains(&name), "{name}");
    }
    assert_eq!(text.matches("<position_based_velocity_limits").count(), 7);
    assert!(text.contains("velocity_offset=\"0.3\" deceleration_limit=\"6\""));
    let panda = urdf::text(&arms::PANDA);
    assert_eq!(panda.matches("<position_based_velocity_limits").count(), 0);
}
