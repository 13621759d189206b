//! A controller as constant data, a state in static memory, one cycle.

use arms::{LWR_IV, LWR_IV_FLANGE};
use controller_core::{
    Axes, ConfigError, Controller, ControllerConfig, Measurement, NullSpace, Reference, State,
    Target, Task, TaskGains, TaskSet,
};

static STATE: State<f32> = State::new();
const NULL_SPACE: NullSpace = NullSpace::diagonal(
    [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2],
    [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03],
);

fn main() -> Result<(), ConfigError> {
    let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    let config = ControllerConfig {
        tasks: TaskSet::new(&[flange])?,
        null_space: NULL_SPACE,
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    let controller = Controller::<f32>::new(&LWR_IV, &config)?;
    let mut state = STATE.clone();
    let q = [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0];
    let measurement = Measurement {
        q: q.into(),
        dq: [0.0; 7].into(),
        interval_s: 0.002,
    };
    for reference in [
        Reference::new([Target::Hold], q),
        Reference::hold(controller.level_count(), q),
        controller.rest_reference(&measurement.q),
    ] {
        let step = controller.step(&mut state, &measurement, &reference);
        assert!(step.status.is_clear());
    }
    Ok(())
}
