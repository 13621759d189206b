//! The frozen cycles of the firmware's scenarios, each in both precisions, written anew by every
//! build from the text of the core.

#![no_std]

use controller_core::real::Real;
use controller_core::{Measurement, Reference, Step, Target};

/// A frozen cycle with its state, as what compares and measures sees it.
pub trait FrozenCycle {
    /// The scalar.
    type Number: Real;
    /// What comes into a cycle.
    type Input;
    /// What comes out.
    type Output;
    /// Before the first cycle.
    const NEW: Self;
    /// Numbers of a measurement and of a reference for positions.
    fn input(
        measurement: &Measurement<Self::Number>,
        reference: &Reference<Self::Number>,
    ) -> Self::Input;
    /// The next reference is followed as it is.
    fn follow_at_once(&mut self);
    /// One cycle.
    fn run(&mut self, input: &Self::Input) -> Self::Output;
    /// Whether it gave what the generic one gave: torques and residuals to the last bit but the sign
    /// of a zero, all limits, the fault.
    fn gave(output: &Self::Output, step: &Step<Self::Number>) -> bool;
    /// Its torque \[Nm\].
    fn torque(output: &Self::Output) -> [Self::Number; 7];
}

fn three<T: Real>(vector: &controller_core::joint::Vector3<T>) -> [T; 3] {
    [vector.x, vector.y, vector.z]
}

macro_rules! frozen {
    ($module:ident, $cycle:ident, $number:ident, [$($target:ident)*]) => {
        #[allow(missing_docs, clippy::all, clippy::pedantic)]
        #[rustfmt::skip]
        pub mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));
        }

        #[doc = concat!("The cycle of `", stringify!($module), "`.")]
        #[derive(Debug)]
        pub struct $cycle {
            /// Gains and limits.
            pub parameters: $module::Parameters,
            /// What is remembered.
            pub state: $module::State,
        }

        impl FrozenCycle for $cycle {
            type Number = $number;
            type Input = ($module::Measurement, $module::Reference);
            type Output = $module::Step;
            const NEW: Self = Self {
                parameters: $module::Parameters::FROZEN,
                state: $module::State::NEW,
            };

            fn input(
                measurement: &Measurement<$number>,
                reference: &Reference<$number>,
            ) -> Self::Input {
                let position = |target: Option<&Target<$number>>| match target {
                    Some(Target::Position { x, dx, ddx }) => $module::Position {
                        holds: false,
                        x: three(x),
                        dx: three(dx),
                        ddx: three(ddx),
                    },
                    _ => $module::Position {
                        holds: true,
                        x: [0.0; 3],
                        dx: [0.0; 3],
                        ddx: [0.0; 3],
                    },
                };
                let mut targets = reference.targets().iter();
                let measurement = $module::Measurement {
                    q: measurement.q.into(),
                    dq: measurement.dq.into(),
                    interval_s: measurement.interval_s,
                };
                let reference = $module::Reference {
                    $($target: position(targets.next()),)*
                    posture: reference.posture.into(),
                };
                (measurement, reference)
            }

            fn follow_at_once(&mut self) {
                self.state.follow_at_once();
            }

            #[inline(always)]
            fn run(&mut self, (measurement, reference): &Self::Input) -> Self::Output {
                $module::step(&self.parameters, &mut self.state, measurement, reference)
            }

            fn gave(output: &Self::Output, step: &Step<$number>) -> bool {
                let same = |a: &[$number; 7], b: &[$number]| {
                    a.iter().zip(b).all(|(a, b)| {
                        a.to_bits() == b.to_bits() || (*a == 0.0 && *b == 0.0)
                    })
                };
                let status = &step.status;
                let sets = [
                    (output.saturated, status.saturated),
                    (output.rate_limited, status.rate_limited),
                    (output.joining, status.joining),
                    (output.rank, status.rank),
                    (output.degraded, status.degraded),
                    (output.released, status.released),
                    (output.shaped, status.shaped),
                    (output.scaled, status.scaled),
                    (output.at_least, status.at_least),
                    (output.at_greatest, status.at_greatest),
                    (output.stuck, status.stuck),
                ];
                let fault = match &status.fault {
                    None => output.fault == $module::Fault::NONE,
                    Some(fault) => {
                        let own = &output.fault;
                        let both = [
                            (own.value, fault.value),
                            (own.min, fault.min),
                            (own.max, fault.max),
                        ];
                        own.kind == fault.kind.number()
                            && own.quantity == fault.quantity as u8
                            && own.index == fault.index
                            && both.iter().all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
                    }
                };
                same(&output.torque, step.torque.as_slice())
                    && same(&output.residual, step.residual.as_slice())
                    && same(&output.gravity, step.gravity.as_slice())
                    && same(&output.coriolis, step.coriolis.as_slice())
                    && sets.iter().all(|(own, set)| *own == set.0)
                    && output.unresolved == status.unresolved
                    && output.pivots == status.pivots
                    && output.mode == status.mode.number()
                    && fault
            }

            fn torque(output: &Self::Output) -> [$number; 7] {
                output.torque
            }
        }
    };
}

frozen!(two_level_f64, TwoLevelF64, f64, [target_1]);
frozen!(two_level_f32, TwoLevelF32, f32, [target_1]);
frozen!(case_1_f64, Case1F64, f64, [target_1 target_2]);
frozen!(case_1_f32, Case1F32, f32, [target_1 target_2]);
