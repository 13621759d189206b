//! A proposal: the largest bandwidths that all bounds allow, or the one that is asked for.

use std::fmt;

use cell::invalid::Invalid;
use cell::ranges::Range;
use cell::scenario::{AxisGain, Scenario, TaskSpec};
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::DOF;

use super::bounds::{self, Bound, Cause};
use super::kind::{Ask, Kind};
use super::link::{Departure, Link};
use super::null_space::{Compliance, median};
use super::workspace::{self, Found, Gains};
use crate::model::at_rest::at_rest;
use crate::model::figures::shown;
use crate::model::search::drawn;
use crate::plant::realistic;

/// Postures that torque, noise and inertias are looked at in, drawn with a fixed seed.
pub const POSTURES: usize = 1000;

/// What the fastest rates are lowered by until the workspace bears them.
const LOWERED: f64 = 0.95;

/// Below this share of what the other bounds allow the workspace bears nothing of use.
const LEAST_SHARE: f64 = 0.01;

/// Bandwidths that can be asked for \[Hz\].
pub const BANDWIDTH_HZ: Range<f64> = Range::new(0.05, 1000.0);

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// h \[s\].
    pub cycle_s: f64,
    /// w \[rad/s\] of all levels; none: the largest of each kind.
    pub bandwidth: Option<f64>,
    /// What the realistic arm has besides its own.
    pub departure: Departure,
}

/// The gains of one kind of level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelGains {
    /// Which kind.
    pub kind: Kind,
    /// w \[rad/s\].
    pub bandwidth: f64,
    /// What bounds it, the least first; empty of what was asked for.
    pub bounds: [Bound; 3],
    /// Whether the workspace lowered it below all of these.
    pub is_lowered: bool,
    /// Error \[m\], \[rad\] when every joint turns back at once, in the median posture: its
    /// Coulomb friction changes sign.
    pub reversal_error: f64,
}

/// Gains for an arm.
#[derive(Clone, Debug)]
pub struct Proposal<'a> {
    /// The arm.
    pub arm: &'a ArmParameters,
    /// What was asked for.
    pub request: Request,
    /// What its links to the controller are.
    pub links: [Link; 2],
    /// By kind of level.
    pub levels: [LevelGains; 2],
    /// All of them.
    pub gains: Gains,
    /// F_c \[Nm\].
    pub friction: [f64; DOF],
    /// The loop in the worst of the postures.
    pub found: Found,
}

/// What cannot be had.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// An arm or a cycle that the core refuses.
    Invalid(Invalid),
    /// A bandwidth \[rad/s\] of a kind of level, beyond its bound.
    Bandwidth(Kind, f64, Bound),
    /// A joint that does not hold the weight of the arm in this posture \[rad\].
    Weight(&'static str, [f64; DOF]),
    /// No bandwidth is stable in this posture \[rad\]; the largest radius with the least one tried.
    Unstable(f64, [f64; DOF]),
}

impl From<Invalid> for Refusal {
    fn from(invalid: Invalid) -> Self {
        Self::Invalid(invalid)
    }
}

/// To three digits, downwards: what is printed is what was looked at.
fn rounded(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return value;
    }
    let scale = f64::powi(10.0, 2 - value.log10().floor() as i32);
    // 0.3 must not become 0.299.
    ((value * scale) * (1.0 + 1e-12)).floor() / scale
}

/// rad/s as Hz.
#[must_use]
pub fn hertz(bandwidth: f64) -> f64 {
    bandwidth / std::f64::consts::TAU
}

/// Peak of the error \[per 1/s2 of disturbance\] behind a step of the disturbance that the
/// observer follows with K_I = c w: of 1 / ((s + c w) (s + w)^2),
/// (e^(-c t) - e^(-t) + (c - 1) t e^(-t)) / ((c - 1) w)^2 with t in 1/w. By c = 2: 0.162 / w^2.
#[must_use]
pub fn step_peak(bandwidth: f64, observer_gain: f64) -> f64 {
    let c = observer_gain / bandwidth;
    // Where both are equal the limit is as near as this.
    let c = if (c - 1.0).abs() < 1e-3 { 1.001 } else { c };
    let at = |t: f64| {
        let [fast, slow] = [-c * t, -t].map(libm::exp);
        (fast - slow + (c - 1.0) * t * slow) / ((c - 1.0) * (c - 1.0))
    };
    // It peaks between 1 and 3.2 for every c; to 1e-4 of its value.
    let times = (0..2000).map(|place| 0.01 * f64::from(place));
    times.map(at).fold(0.0, f64::max) / (bandwidth * bandwidth)
}

/// Gains for `arm`.
///
/// # Errors
/// What cannot be had.
pub fn propose<'a>(arm: &'a ArmParameters, request: Request) -> Result<Proposal<'a>, Refusal> {
    let model = ArmModel::new(arm).map_err(|error| Refusal::Invalid(Invalid::line(error)))?;
    let Request {
        cycle_s, departure, ..
    } = request;
    let links = [
        Link::ideal(cycle_s),
        Link::realistic(arm, cycle_s, departure),
    ];
    let drawn = drawn(arm, POSTURES);
    let sampling = bounds::sampling(&links);
    let asks = Kind::ALL.map(|kind| -> Vec<Ask> {
        let ask = |q| Ask::of(kind, &model, arm, q);
        drawn.iter().filter_map(ask).collect()
    });
    let bounds: [[Bound; 3]; 2] = std::array::from_fn(|number| {
        let (kind, asks) = (Kind::ALL[number], &asks[number]);
        let torque = bounds::torque(kind, arm, asks);
        let noise = bounds::noise(arm, asks, &links[1]);
        let mut all = [sampling, torque, noise];
        all.sort_by(|one, other| one.bandwidth.total_cmp(&other.bandwidth));
        all
    });
    for [least, ..] in &bounds {
        if let (true, Some((joint, posture))) = (least.bandwidth <= 0.0, least.place) {
            return Err(Refusal::Weight(arm.links[joint].name, posture));
        }
    }
    let null_space = compliance(arm, &model, &drawn, &links);
    let friction = realistic(arm).friction.map(|friction| friction.coulomb);

    let mut postures = workspace::postures(arm);
    let [position, orientation] = bounds.map(|[least, ..]| least.bandwidth);
    let widest = position.max(orientation);
    let mut cap = widest;
    let (most, null_space, found) = loop {
        let most = [position.min(cap), orientation.min(cap)];
        let null_space = null_space.within(cap);
        let gains = gains(most, null_space);
        let found = workspace::look(arm, &gains, &links, &mut postures)?;
        if found.is_stable() {
            break (most, null_space, found);
        }
        cap *= LOWERED;
        if cap < LEAST_SHARE * widest {
            let radius = found.radius.max(found.radius_off);
            return Err(Refusal::Unstable(radius, found.posture));
        }
    };
    let (mut bandwidths, mut found) = (most, found);
    if let Some(asked) = request.bandwidth {
        for (number, kind) in Kind::ALL.into_iter().enumerate() {
            if asked > most[number] {
                let least = bounds[number][0];
                let bound = match most[number] < least.bandwidth {
                    true => Bound {
                        cause: Cause::Workspace,
                        bandwidth: most[number],
                        place: None,
                    },
                    false => least,
                };
                return Err(Refusal::Bandwidth(kind, asked, bound));
            }
        }
        bandwidths = [asked; 2];
        let gains = gains(bandwidths, null_space);
        found = workspace::look(arm, &gains, &links, &mut postures)?;
        if !found.is_stable() {
            let radius = found.radius.max(found.radius_off);
            return Err(Refusal::Unstable(radius, found.posture));
        }
    }
    let gains = gains(bandwidths, null_space);
    let levels = std::array::from_fn(|number| {
        let reversal = |ask: &Ask| -> f64 {
            let kicks = ask.answer.iter().zip(friction);
            let all: f64 = kicks
                .map(|(answer, friction)| answer * 2.0 * friction)
                .sum();
            all * step_peak(bandwidths[number], gains.observer_gain)
        };
        LevelGains {
            kind: Kind::ALL[number],
            bandwidth: bandwidths[number],
            bounds: bounds[number],
            is_lowered: most[number] < bounds[number][0].bandwidth,
            reversal_error: median(asks[number].iter().map(reversal).collect()),
        }
    });
    Ok(Proposal {
        arm,
        request,
        links,
        levels,
        gains,
        friction,
        found,
    })
}

/// The gains with these bandwidths \[rad/s\]. The observer is as fast as the slower speed loop.
fn gains([position, orientation]: [f64; 2], null_space: Compliance) -> Gains {
    let of = |w: f64| [rounded(w * w), rounded(2.0 * w)];
    Gains {
        levels: [of(position), of(orientation)],
        null_space: Compliance {
            stiffness: null_space.stiffness.map(rounded),
            damping: null_space.damping.map(rounded),
            damping_rate: rounded(null_space.damping_rate),
            ..null_space
        },
        observer_gain: rounded(2.0 * position.min(orientation)),
    }
}

fn compliance(
    arm: &ArmParameters,
    model: &ArmModel<f64>,
    postures: &[[f64; DOF]],
    [ideal, realistic]: &[Link; 2],
) -> Compliance {
    let mass_matrix = |q| at_rest(model, q).1.mass_matrix;
    let mass_matrices: Vec<_> = postures.iter().map(mass_matrix).collect();
    let [direct, late] = [ideal, realistic].map(bounds::damping_rate);
    // Without dead time both have the constant D.
    let direct = match realistic.timing.dead_cycles {
        0 => direct.min(late),
        _ => direct,
    };
    Compliance::of(arm, model, &mass_matrices, [direct, late])
}

impl Proposal<'_> {
    /// Puts the gains in the place of those of a scenario.
    pub fn apply(&self, scenario: &mut Scenario) {
        for level in &mut scenario.levels {
            let [stiffness, damping] = self.gains.of(match level.task {
                TaskSpec::Position => Kind::Position,
                TaskSpec::Orientation => Kind::Orientation,
            });
            level.stiffness = AxisGain::Uniform(stiffness);
            level.damping = AxisGain::Uniform(damping);
        }
        let Compliance {
            stiffness,
            damping,
            damping_rate,
            ..
        } = self.gains.null_space;
        scenario.null_space.stiffness = stiffness;
        scenario.null_space.damping = damping;
        scenario.null_space.damping_rate = damping_rate;
        scenario.observer.gain = self.gains.observer_gain;
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid(invalid) => invalid.fmt(f),
            Self::Bandwidth(kind, asked, bound) => {
                let [asked, most] = [*asked, bound.bandwidth].map(hertz);
                let (kind, cause) = (kind.name(), bound.cause.name());
                write!(
                    f,
                    "bandwidth of {kind} levels: {asked:.3} Hz; allowed: {} to {most:.3}, by the {cause}",
                    BANDWIDTH_HZ.min
                )
            }
            Self::Weight(joint, posture) => {
                let posture = shown(posture);
                write!(
                    f,
                    "weight of the arm: more than {joint} holds at {posture}; allowed: below its \
                     torque limit in the whole range"
                )
            }
            Self::Unstable(radius, posture) => {
                write!(
                    f,
                    "spectral radius of the loop: {radius:.6} at {} with the least bandwidth; \
                     allowed: below 1",
                    shown(posture)
                )
            }
        }
    }
}
