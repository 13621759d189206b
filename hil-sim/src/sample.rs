//! What is looked at in a cycle of a run, and why a run is ended.

mod level;

use std::fmt;

use controller_core::Fault;
use controller_core::arm::ArmParameters;
use controller_core::joint::JointState;
use controller_core::ranges::SPEED_FACTOR;

pub(crate) use level::LevelProbes;

/// Why a run ended before its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// The true motion is one that no arm may make.
    Unsafe(UnsafeMotion),
    /// The controller latched a fault.
    Fault(Fault),
    /// The program was told to end.
    Interrupted,
    /// A person typed it.
    Quit,
}

impl Stop {
    /// The reason in words, for `arm`.
    #[must_use]
    pub fn named(&self, arm: &ArmParameters) -> String {
        match self {
            Self::Unsafe(motion) => motion.to_string(),
            Self::Fault(fault) => fault.named(arm).to_string(),
            Self::Interrupted => "interrupted".to_string(),
            Self::Quit => "quit".to_string(),
        }
    }
}

/// A true motion that must be stopped. Joints have the names of their maker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnsafeMotion {
    /// Position \[rad\] or speed \[rad/s\] is infinite or NaN.
    NotFinite {
        /// The joint.
        joint: &'static str,
        /// Its position.
        q: f64,
        /// Its speed.
        dq: f64,
    },
    /// A speed beyond [`SPEED_FACTOR`] times the data sheet \[rad/s\].
    Speed {
        /// The joint.
        joint: &'static str,
        /// Its speed.
        dq: f64,
        /// What it may be.
        limit: f64,
    },
}

impl UnsafeMotion {
    /// The first joint whose motion must be stopped, if there is one.
    #[must_use]
    pub fn of(state: &JointState<f64>, arm: &ArmParameters) -> Option<Self> {
        for (index, link) in arm.links.iter().enumerate() {
            let (joint, q, dq) = (link.name, state.q[index], state.dq[index]);
            let limit = SPEED_FACTOR * link.speed_limit;
            if !(q.is_finite() && dq.is_finite()) {
                return Some(Self::NotFinite { joint, q, dq });
            }
            if dq.abs() > limit {
                return Some(Self::Speed { joint, dq, limit });
            }
        }
        None
    }
}

impl fmt::Display for UnsafeMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { joint, q, dq } => {
                write!(f, "{joint} is not finite: q = {q} rad, dq = {dq} rad/s")
            }
            Self::Speed { joint, dq, limit } => write!(
                f,
                "speed of {joint} is {dq:.3} rad/s; allowed -{limit:.3} to {limit:.3}"
            ),
        }
    }
}
