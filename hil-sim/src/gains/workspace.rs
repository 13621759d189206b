//! The loop as a whole, posture by posture: every set of levels, every link, every answer of the
//! arm.

use controller_core::arm::ArmParameters;
use controller_core::gain::diagonal;
use controller_core::joint::DOF;
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::{Controller, ControllerConfig, Task, TaskGains, TaskSet};

use super::kind::Kind;
use super::link::Link;
use super::near_rest::NearRest;
use super::null_space::Compliance;
use super::sampled::transition;
use crate::model::search::drawn;
use cell::invalid::Invalid;

/// Postures that are looked at, drawn with a fixed seed.
pub const POSTURES: usize = 60;

/// Share of the ranges they are drawn from: at an end the law pushes away from it.
const RANGE_SHARE: f64 = 0.9;

/// Sets of levels, highest first.
const SETS: [&[Kind]; 3] = [
    &[Kind::Position],
    &[Kind::Orientation],
    &[Kind::Position, Kind::Orientation],
];

/// The gains of a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// K_p \[1/s2\] and K_d \[1/s\] of levels, in the order of [`Kind::ALL`].
    pub levels: [[f64; 2]; 2],
    /// The null space.
    pub null_space: Compliance,
    /// K_I \[1/s\], every joint.
    pub observer_gain: f64,
}

impl Gains {
    /// K_p and K_d of a kind of level.
    #[must_use]
    pub fn of(&self, kind: Kind) -> [f64; 2] {
        self.levels[kind as usize]
    }

    fn tasks(&self, arm: &ArmParameters, kinds: &[Kind]) -> Vec<Task> {
        let task = |kind: &Kind| {
            let [stiffness, damping] = self.of(*kind);
            kind.task(arm, TaskGains::uniform(stiffness, damping))
        };
        kinds.iter().map(task).collect()
    }

    fn config(&self, tasks: &[Task], link: &Link) -> Result<ControllerConfig, Invalid> {
        let Compliance {
            stiffness,
            damping,
            damping_rate,
            ..
        } = self.null_space;
        let dead_cycles = link.timing.dead_cycles;
        Ok(ControllerConfig {
            tasks: TaskSet::new(tasks).map_err(Invalid::line)?,
            null_space: NullSpace {
                stiffness: diagonal(stiffness),
                damping: match dead_cycles {
                    0 => NullDamping::Joint(diagonal(damping)),
                    _ => NullDamping::Inertia(damping_rate),
                },
                posture: Posture::Constant,
            },
            observer_gain: [self.observer_gain; DOF],
            cycle_s: link.timing.cycle_s,
            dead_cycles,
        })
    }
}

/// A loop in a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Largest spectral radius of the loop, the arm as believed.
    pub radius: f64,
    /// The same of an arm that answers half or twice as much.
    pub radius_off: f64,
    /// Where the larger of both is \[rad\].
    pub posture: [f64; DOF],
}

/// The arm with its ranges without their ends.
#[must_use]
pub fn inner(arm: &ArmParameters) -> ArmParameters {
    let mut inner = *arm;
    for link in &mut inner.links {
        let [min, max] = link.position_range;
        let (middle, half) = (0.5 * (min + max), 0.5 * (max - min));
        link.position_range = [-1.0, 1.0].map(|end| middle + end * RANGE_SHARE * half);
    }
    inner
}

/// The postures \[rad\].
#[must_use]
pub fn postures(arm: &ArmParameters) -> Vec<[f64; DOF]> {
    drawn(&inner(arm), POSTURES)
}

/// The loops of all `links` in these postures. Ends with the first posture that is unstable, and
/// puts it first: what is tried next is likely to fail there.
///
/// # Errors
/// Gains that the core refuses.
pub fn look(
    arm: &ArmParameters,
    gains: &Gains,
    links: &[Link],
    postures: &mut [[f64; DOF]],
) -> Result<Found, Invalid> {
    let mut worst = Found {
        radius: 0.0,
        radius_off: 0.0,
        posture: [0.0; DOF],
    };
    let mut loops = Vec::new();
    for link in links {
        for kinds in SETS {
            let tasks = gains.tasks(arm, kinds);
            let config = gains.config(&tasks, link)?;
            let controller = Controller::new(arm, &config).map_err(Invalid::line)?;
            loops.push((link, tasks, controller));
        }
    }
    for place in 0..postures.len() {
        let posture = postures[place];
        for (link, tasks, controller) in &loops {
            let gain = gains.observer_gain;
            let near = NearRest::of(arm, controller, tasks, gain, link, &posture.into());
            let radius = |answer: f64| match &near {
                // Not a number is no radius either.
                None => f64::NAN,
                Some(near) => {
                    let arm = near.arm.answering(answer);
                    transition(&arm, &link.timing, &near.law).spectral_radius()
                }
            };
            for answer in link.answers() {
                let here = radius(answer);
                let before = worst.radius.max(worst.radius_off);
                let most = match answer == 1.0 {
                    true => &mut worst.radius,
                    false => &mut worst.radius_off,
                };
                if here.is_nan() || here > *most {
                    *most = here;
                }
                if here.is_nan() || here > before {
                    worst.posture = posture;
                }
                if here.is_nan() || here >= 1.0 {
                    postures.swap(0, place);
                    return Ok(worst);
                }
            }
        }
    }
    Ok(worst)
}

impl Found {
    /// Whether all loops are stable, with the margin.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.radius < 1.0 && self.radius_off < 1.0
    }
}
