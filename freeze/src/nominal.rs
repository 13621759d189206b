//! An ordinary instant of a controller: where a path depends on data, the one taken there is the
//! usual one.

use controller_core::joint::{DOF, JointVector, zeros};
use controller_core::{Controller, Measurement, Reference, State};

use crate::error::FreezeError;

/// Measurement and reference of an arm at rest, and the state some cycles later.
#[derive(Debug)]
pub struct Nominal {
    /// The measurement.
    pub measurement: Measurement<f64>,
    /// The reference.
    pub reference: Reference<f64>,
    /// The state.
    pub state: State<f64>,
}

/// Postures that are tried.
const TRIED: usize = 4000;

/// Cycles until nothing changes any more.
const CYCLES: usize = 5;

impl Nominal {
    /// At the first of some postures in which no limit is active.
    ///
    /// # Errors
    /// There is none.
    pub fn find(controller: &Controller<f64>) -> Result<Self, FreezeError> {
        let [least, greatest] = *controller.arm().position_range();
        (1..=TRIED)
            .find_map(|number| {
                // From the middle of the ranges on, each joint by a way of its own.
                let mut q: JointVector<f64> = zeros();
                for i in 0..DOF {
                    let ratio = [
                        0.618_034, 0.754_878, 0.819_173, 0.856_675, 0.881_271, 0.898_654, 0.911_592,
                    ];
                    let share = (0.5 + number as f64 * ratio[i]).fract();
                    q[i] = least[i] + (greatest[i] - least[i]) * (0.2 + 0.6 * share);
                }
                Self::at(controller, &q)
            })
            .ok_or(FreezeError::NoOrdinaryPosture { tried: TRIED })
    }

    fn at(controller: &Controller<f64>, q: &JointVector<f64>) -> Option<Self> {
        let measurement = Measurement {
            q: *q,
            dq: zeros(),
            interval_s: controller.nominal_interval_s(),
        };
        let reference = controller.rest_reference(q);
        let mut state = State::new();
        for _ in 0..CYCLES {
            let step = controller.step(&mut state, &measurement, &reference);
            if !step.status.is_clear() {
                return None;
            }
        }
        Some(Self {
            measurement,
            reference,
            state,
        })
    }
}
