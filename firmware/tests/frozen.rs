//! The frozen cycles give what the generic ones give.

use controller_core::{ConfigError, Controller};
use firmware::comparison::{HOSTILE, compare};
use firmware::scenario::{FixedScenario, controller};
use firmware::stages::Clock;
use frozen::{Case1F32, Case1F64, FrozenCycle, TwoLevelF32, TwoLevelF64};

/// The host counts nothing.
struct Still;

impl Clock for Still {
    fn ticks(&self) -> u32 {
        0
    }
    fn instructions(&self, ticks: u32) -> u32 {
        ticks
    }
}

fn check<F: FrozenCycle>(made: Result<Controller<F::Number>, ConfigError>) {
    let found = compare(
        &made.expect("valid"),
        &mut { F::NEW },
        &Still,
        |cycle: &mut F, input| cycle.run(input),
    );
    assert_eq!(found.differing, 0, "{found:?}");
    // Most hostile inputs end in a fault, not all.
    assert!(
        found.faults > HOSTILE / 2 && found.faults < HOSTILE,
        "{found:?}"
    );
}

#[test]
fn every_input_gives_the_same_bits_limits_and_faults() {
    check::<TwoLevelF64>(controller(FixedScenario::TwoLevel));
    check::<TwoLevelF32>(controller(FixedScenario::TwoLevel));
    check::<Case1F64>(controller(FixedScenario::Case1));
    check::<Case1F32>(controller(FixedScenario::Case1));
}
