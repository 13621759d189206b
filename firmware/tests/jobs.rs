//! The constants of the jobs are the built-in scenarios.

use firmware::job::{CYCLE_S, Job, JobKind, config};
use hil_sim::scenario::Scenario;

#[test]
fn jobs_are_the_scenarios_of_their_name() {
    for kind in JobKind::ALL {
        let scenario = Scenario::find(kind.name()).expect("built in");
        assert_eq!(config::<f64>(kind), scenario.controller_config(0));
        assert_eq!(scenario.cycle_s(), CYCLE_S);
        let job = Job::<f64>::new(kind).expect("a valid job");
        assert_eq!(job.origin.posture, scenario.start());
        let origins = scenario.origins_at(&scenario.start());
        for cycle in (0..10_000).step_by(37) {
            let t_s = f64::from(cycle) * CYCLE_S;
            let wanted = scenario.reference(&origins, &scenario.start(), t_s);
            let found = job.reference(cycle);
            assert_eq!(found.tasks.len(), wanted.tasks.len());
            for (found, wanted) in found.tasks.iter().zip(&wanted.tasks) {
                // The start is placed by another order of the same sums.
                assert!((found.x - wanted.x).amax() < 1e-14);
                assert_eq!(found.ddx, wanted.ddx);
                // A level that holds is placed with the velocity at hand, zero.
                assert_eq!(found.dx, wanted.dx);
            }
        }
    }
}
