//! The constants of the jobs are the built-in scenarios.

use cell::scenario::Scenario;
use controller_core::Target;
use controller_core::joint::Vector3;
use firmware::job::{CYCLE_S, Job, JobKind, config};
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
    for kind in JobKind::ALL {
        let scenario = Scenario::find(kind.name()).expect("built in");
        let wanted = scenario.controller_config(0).expect("a valid scenario");
        assert_eq!(config(kind), Ok(wanted));
        assert_eq!(scenario.cycle_s(), CYCLE_S);
        let job = Job::<f64>::new(kind).expect("a valid job");
        assert_eq!(job.origin.posture, scenario.start());
        let origins = origins(&scenario, &scenario.start());
        for cycle in (0..10_000).step_by(37) {
            let t_s = f64::from(cycle) * CYCLE_S;
            let wanted = scenario.reference(&origins, &scenario.start(), t_s);
            let found = job.reference(cycle);
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
