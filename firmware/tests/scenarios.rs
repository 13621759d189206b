//! The constants are those of the built-in scenarios.

use cell::scenario::Scenario;
use controller_core::Target;
use controller_core::joint::Vector3;
use firmware::scenario::{CYCLE_S, FixedScenario, ReadyScenario, config};
use hil_sim::arm_points::origins;

type Parts = (Vector3<f64>, Vector3<f64>, Vector3<f64>);

fn parts(target: &Target<f64>) -> Parts {
    match *target {
        Target::Position { x, dx, ddx } => (x, dx, ddx),
        _ => panic!("not a position: {target:?}"),
    }
}

#[test]
fn jobs_are_the_scenarios_of_their_name() {
    for scenario in FixedScenario::ALL {
        let built_in = Scenario::find(scenario.name()).expect("built in");
        let wanted = built_in.controller_config(0).expect("a valid scenario");
        assert_eq!(config(scenario), Ok(wanted));
        assert_eq!(built_in.cycle_s(), CYCLE_S);
        let ready = ReadyScenario::<f64>::new(scenario).expect("a valid scenario");
        assert_eq!(ready.origin.posture, built_in.start());
        let origins = origins(&built_in, &built_in.start());
        for cycle in (0..10_000).step_by(37) {
            let t_s = f64::from(cycle) * CYCLE_S;
            let wanted = built_in.reference(&origins, &built_in.start(), t_s);
            let found = ready.reference(cycle);
            let (found, wanted) = (found.targets(), wanted.targets());
            assert_eq!(found.len(), wanted.len());
            for (found, wanted) in found.iter().zip(wanted) {
                let (x, dx, ddx) = parts(found);
                let (wanted_x, wanted_dx, wanted_ddx) = parts(wanted);
                // The start is placed by another order of the same sums.
                assert!((x - wanted_x).amax() < 1e-14);
                assert_eq!(ddx, wanted_ddx);
                // A level that holds is placed with the velocity at hand, zero.
                assert_eq!(dx, wanted_dx);
            }
        }
    }
}
