//! What bounds the bandwidth of a level: sampling, torque, noise. docs/gains.md derives them.
//!
//! A bandwidth is w \[rad/s\] of K_p = w^2, K_d = K_I = 2 w: two equal poles at w, and an
//! observer as fast as the speed loop.

use controller_core::arm::ArmParameters;
use controller_core::joint::DOF;

use super::kind::{Ask, Kind};
use super::link::Link;
use super::matrix::Matrix;
use super::sampled::{Arm, Slopes, transition};

/// Share of the torque beside the weight that the largest sudden error may take.
pub const TORQUE_SHARE: f64 = 0.5;

/// Share of the torque limit that the rounding of what is read may make of the torque, as a
/// standard deviation.
pub const NOISE_SHARE: f64 = 0.02;

/// Bandwidths and rates that are looked at, per cycle.
const NARROWEST: f64 = 2e-3;
const WIDEST: f64 = 10.0;

/// A bound by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A row of a task as a sampled loop.
    Sampling,
    /// A joint at its torque limit.
    Torque,
    /// A joint that what is read shakes.
    Noise,
    /// The whole loop in some posture.
    Workspace,
}

impl Cause {
    /// As proposals say it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sampling => "sampling",
            Self::Torque => "torque",
            Self::Noise => "noise",
            Self::Workspace => "workspace",
        }
    }
}

/// Where a bound comes from: a joint, counted from 0, in a posture \[rad\].
pub type Place = (usize, [f64; DOF]);

/// A largest bandwidth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// By what.
    pub cause: Cause,
    /// w \[rad/s\].
    pub bandwidth: f64,
    /// Where, of torque and noise.
    pub place: Option<Place>,
}

/// The bandwidth up to which `holds` in a loop with the cycle `cycle_s` \[s\]: to 1e-4 of it.
fn largest(cycle_s: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let mut good = NARROWEST / cycle_s;
    while good < WIDEST / cycle_s && holds(1.2 * good) {
        good *= 1.2;
    }
    let mut bad = 1.2 * good;
    while bad > (1.0 + 1e-4) * good {
        let middle = 0.5 * (good + bad);
        if holds(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    good
}

fn bears(link: &Link, law: &Slopes) -> bool {
    link.answers().into_iter().all(|answer| {
        let arm = Arm::unit().answering(answer);
        transition(&arm, &link.timing, law).spectral_radius() < 1.0
    })
}

/// The law of one row of a task: stiffness K_p \[1/s2\], damping K_d \[1/s\], K_I \[1/s\].
#[must_use]
pub fn row_law(stiffness: f64, damping: f64, observer_gain: f64) -> Slopes {
    Slopes {
        position: Matrix::scalar(1, -stiffness),
        speed: Matrix::scalar(1, -damping),
        residual: Matrix::scalar(1, -1.0),
        observer_gain,
    }
}

/// Of a row of a task over all `links`. With an exact model every row of every level is this loop
/// in every posture, since what is read, observed and delayed is the same for all joints.
#[must_use]
pub fn sampling(links: &[Link; 2]) -> Bound {
    let holds = |w: f64| {
        let law = row_law(w * w, 2.0 * w, 2.0 * w);
        links.iter().all(|link| bears(link, &law))
    };
    Bound {
        cause: Cause::Sampling,
        bandwidth: largest(links[0].timing.cycle_s, holds),
        place: None,
    }
}

/// The largest rate \[1/s\] of a damping of the null space, whose mode has a spring of a
/// sixteenth of its square and no compensation.
#[must_use]
pub fn damping_rate(link: &Link) -> f64 {
    largest(link.timing.cycle_s, |rate| {
        let law = Slopes {
            residual: Matrix::zeros(1, 1),
            ..row_law(rate * rate / 16.0, rate, rate)
        };
        bears(link, &law)
    })
}

/// Of the torque limits: the largest sudden error, in the worst direction, takes
/// [`TORQUE_SHARE`] of what a joint has beside the weight.
#[must_use]
pub fn torque(kind: Kind, arm: &ArmParameters, asks: &[Ask]) -> Bound {
    smallest(Cause::Torque, asks, |ask, joint| {
        let free = arm.links[joint].torque_limit - ask.gravity[joint].abs();
        let stiffness = TORQUE_SHARE * free / (kind.jump() * ask.torque[joint]);
        stiffness.max(0.0).sqrt()
    })
}

/// Of the rounding of what is read: its torque is [`NOISE_SHARE`] of the limit.
#[must_use]
pub fn noise(arm: &ArmParameters, asks: &[Ask], link: &Link) -> Bound {
    let [position, speed] = link.rounding;
    let h = link.timing.cycle_s;
    smallest(Cause::Noise, asks, |ask, joint| {
        let row = ask.inertia.row(joint).transpose();
        let [by_position, by_speed] = [position, speed].map(|of| row.component_mul(&of).norm());
        let most = NOISE_SHARE * arm.links[joint].torque_limit;
        // The estimate follows a jump of the momentum by (1 - e^(-K_I h)) / h.
        largest(h, |w| {
            let observed = -libm::expm1(-2.0 * w * h) / h;
            f64::hypot(w * w * by_position, (2.0 * w + observed) * by_speed) < most
        })
    })
}

/// The least of all joints in all postures.
fn smallest(cause: Cause, asks: &[Ask], bandwidth: impl Fn(&Ask, usize) -> f64) -> Bound {
    let mut least = Bound {
        cause,
        bandwidth: f64::INFINITY,
        place: None,
    };
    for ask in asks {
        for joint in 0..DOF {
            let here = bandwidth(ask, joint);
            if here < least.bandwidth {
                least.bandwidth = here;
                least.place = Some((joint, ask.posture));
            }
        }
    }
    least
}
