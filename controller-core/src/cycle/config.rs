//! What a controller is made of, and its validation.

use crate::arm::ArmModel;
use crate::error::ConfigError;
use crate::joint::DOF;
use crate::law::gain_bound;
use crate::law::null_space::{NullDamping, NullSpace, matrix};
use crate::law::sampling::{self, DampingRate};
use crate::ranges::{CYCLE_RANGE_S, DEAD_CYCLES_MAX, GAIN_MAX, INERTIA_DAMPING_BOUND};
use crate::real::Real;
use crate::task::TaskSet;

/// What a controller is made of, besides the arm. Plain `f64` data, usable as a
/// constant but for the tasks, which are checked when the set is made.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerConfig {
    /// The tasks in priority order.
    pub tasks: TaskSet,
    /// Compliance of what the tasks leave.
    pub null_space: NullSpace,
    /// K_I \[1/s\] per joint, diagonal: bandwidth of the external-torque estimate.
    pub observer_gain: [f64; DOF],
    /// Nominal cycle \[s\].
    pub cycle_s: f64,
    /// Cycles between a measurement and the moment its torque acts, beyond the
    /// zero-order hold: 0 for a direct link. Lowers the damping that is allowed,
    /// see [`sampling::bound`].
    pub dead_cycles: u8,
}

/// Whether a nominal cycle \[s\] makes sense, of a controller or of a resolver.
pub(crate) fn check_cycle(cycle_s: f64) -> Result<(), ConfigError> {
    let [min, max] = CYCLE_RANGE_S;
    if cycle_s >= min && cycle_s <= max {
        Ok(())
    } else {
        Err(ConfigError::Cycle { value: cycle_s })
    }
}

impl ControllerConfig {
    /// Checks everything and returns the fastest null-space mode.
    ///
    /// # Errors
    /// The first thing that cannot be, with its value and what is allowed.
    pub fn validate<T: Real>(&self, arm: &ArmModel<T>) -> Result<DampingRate, ConfigError> {
        check_cycle(self.cycle_s)?;
        if self.dead_cycles > DEAD_CYCLES_MAX {
            return Err(ConfigError::DeadCycles {
                value: self.dead_cycles,
            });
        }
        // The exact form of (30) is stable for any gain; what it makes of a torque that
        // acts late is not.
        let bound = match self.dead_cycles {
            0 => GAIN_MAX,
            late => sampling::bound(late) / self.cycle_s,
        };
        for (joint, &value) in (1..).zip(&self.observer_gain) {
            if !(value > 0.0 && value <= bound) {
                return Err(ConfigError::ObserverGain {
                    joint,
                    value,
                    bound,
                });
            }
        }
        for (level, task) in (1..).zip(self.tasks.tasks()) {
            gain_bound::check(
                &task.gains,
                task.axes,
                level,
                self.cycle_s,
                self.dead_cycles,
            )?;
        }
        self.null_space.validate()?;
        check_damping(arm, &self.null_space, self.cycle_s, self.dead_cycles)
    }

    /// What h lambda must stay below. An inertia-shaped damping is held to half
    /// a cycle's decay: it is the same everywhere and never needs more.
    #[must_use]
    pub fn damping_bound(&self) -> f64 {
        damping_bound(&self.null_space.damping, self.dead_cycles)
    }
}

fn damping_bound(damping: &NullDamping, dead_cycles: u8) -> f64 {
    let stable = sampling::bound(dead_cycles);
    match damping {
        NullDamping::Joint(_) => stable,
        NullDamping::Inertia(_) => stable.min(INERTIA_DAMPING_BOUND),
    }
}

/// Whether a cycle carries the damping of a null space anywhere; returns its fastest mode.
///
/// # Errors
/// Where it does not, and by how much.
pub(super) fn check_damping<T: Real>(
    arm: &ArmModel<T>,
    null_space: &NullSpace,
    cycle_s: f64,
    dead_cycles: u8,
) -> Result<DampingRate, ConfigError> {
    let fastest = match &null_space.damping {
        NullDamping::Joint(damping) => sampling::fastest_mode(arm, &matrix(damping)),
        NullDamping::Inertia(rate) => DampingRate {
            rate: *rate,
            joint: 1,
            posture: [0.0; DOF],
        },
    };
    let value = fastest.rate * cycle_s;
    let bound = damping_bound(&null_space.damping, dead_cycles);
    if value < bound {
        return Ok(fastest);
    }
    let DampingRate { joint, posture, .. } = fastest;
    Err(ConfigError::Damping {
        joint,
        value,
        bound,
        posture,
    })
}
