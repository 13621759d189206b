//! Inputs of the timing table: random ones within the limits of the arm, and
//! those that look hardest. The same numbers on host and target.

use arms::LWR_IV;
use controller_core::joint::{DOF, JointState, JointVector, Vector3};
use controller_core::ranges::{POSITION_MARGIN, SPEED_FACTOR};
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, Target};

use crate::scenario::CYCLE_S;

/// The kinds of inputs and how many there are of each.
pub const KINDS: [(Kind, u32); 7] = [
    (Kind::Random, 2000),
    (Kind::Limits, 128),
    (Kind::Fast, 128),
    (Kind::Singular, 64),
    (Kind::Saturated, 32),
    (Kind::Tiny, 32),
    (Kind::Zero, 4),
];

/// All of them.
pub const COUNT: u32 = {
    let (mut count, mut i) = (0, 0);
    while i < KINDS.len() {
        count += KINDS[i].1;
        i += 1;
    }
    count
};

/// What is special about an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Positions uniform within the limits; every other one with speeds and
    /// references all over the place, the others slow and where they should be;
    /// intervals as believed.
    Random,
    /// Every corner of what is believed: positions and speeds at the border.
    Limits,
    /// Every combination of largest speeds, positions random.
    Fast,
    /// Joints 2, 4 and 6 stretched, or nearly.
    Singular,
    /// References so far away that every torque is cut.
    Saturated,
    /// Denormal numbers.
    Tiny,
    /// Zeros of either sign.
    Zero,
}

impl Kind {
    /// Name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Limits => "limits",
            Self::Fast => "fast",
            Self::Singular => "singular",
            Self::Saturated => "saturated",
            Self::Tiny => "tiny",
            Self::Zero => "zero",
        }
    }

    /// Kind of input `index`, and its number among its kind.
    #[must_use]
    pub fn of(index: u32) -> (Self, u32) {
        let mut rest = index;
        for (kind, count) in KINDS {
            if rest < count {
                return (kind, rest);
            }
            rest -= count;
        }
        (Self::Zero, 0)
    }
}

/// SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A whole number below `end`.
    pub(crate) fn below(&mut self, end: u32) -> u32 {
        ((self.next() >> 32) as u32) % end.max(1)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in -1..1.
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector<T: Real, const N: usize>(&mut self, scale: f64) -> [T; N] {
        core::array::from_fn(|_| T::from_f64(self.signed() * scale))
    }
}

/// Input `index` of [`COUNT`] for a controller.
#[must_use]
pub fn input<T: Real>(controller: &Controller<T>, index: u32) -> (Measurement<T>, Reference<T>) {
    let (kind, number) = Kind::of(index);
    let mut random = Random(u64::from(index) << 32);
    let sign = |joint: usize| if number >> joint & 1 == 0 { 1.0 } else { -1.0 };
    let (mut q, mut dq) = ([0.0; DOF], [0.0; DOF]);
    // Just inside what is believed, in single precision too.
    let believed = 1.0 - 1e-6;
    for (joint, link) in LWR_IV.links.iter().enumerate() {
        let (position, speed) = (link.position_range[1], link.speed_limit);
        let edge = (position + POSITION_MARGIN) * believed;
        let fastest = speed * SPEED_FACTOR * believed;
        let (some_q, some_dq) = (random.signed() * position, random.signed() * speed);
        let slow_dq = some_dq * 0.02;
        let quarter = [0.0, 1e-9, -1e-5, core::f64::consts::FRAC_PI_2];
        (q[joint], dq[joint]) = match kind {
            Kind::Random if number % 2 == 0 => (some_q, slow_dq),
            Kind::Random | Kind::Saturated => (some_q, some_dq),
            Kind::Limits => (sign(joint) * edge, -sign(6 - joint) * fastest),
            Kind::Fast => (some_q, sign(joint) * fastest),
            Kind::Singular if joint % 2 == 1 => {
                (quarter[(number >> (joint - 1) & 3) as usize], some_dq)
            }
            Kind::Singular => (some_q, some_dq),
            Kind::Tiny => (some_q * 1e-42, some_dq * 1e-310),
            Kind::Zero => (0.0 * sign(0), 0.0 * sign(1)),
        };
    }
    let interval_s = match kind {
        Kind::Random => CYCLE_S * (0.5 + 9.7 * (random.signed() + 1.0)),
        Kind::Limits => CYCLE_S * if number % 2 == 0 { 0.501 } else { 19.9 },
        _ => CYCLE_S,
    };
    let measurement = Measurement {
        q: JointVector::from(q.map(T::from_f64)),
        dq: JointVector::from(dq.map(T::from_f64)),
        interval_s: T::from_f64(interval_s),
    };
    if kind == Kind::Random && number % 2 == 0 {
        // Every other one follows its reference closely: no torque is cut.
        let Measurement { q, dq, .. } = measurement;
        let reference = controller.moving_reference(&JointState { q, dq });
        return (measurement, reference);
    }
    let posture = random.vector::<T, DOF>(2.0);
    let mut reference = Reference::hold(controller.level_count(), posture);
    // Within what may be asked for; the fastest of it saturates every torque.
    let [reach, speed, acceleration] = match kind {
        Kind::Saturated => [0.5, 10.0, 250.0],
        Kind::Tiny => [1e-310; 3],
        Kind::Zero => [0.0; 3],
        _ => [0.5, 1.0, 10.0],
    };
    for target in reference.targets_mut() {
        // Drawn in this order.
        *target = Target::Position {
            x: Vector3::from(random.vector::<T, 3>(reach)),
            dx: Vector3::from(random.vector::<T, 3>(speed)),
            ddx: Vector3::from(random.vector::<T, 3>(acceleration)),
        };
    }
    (measurement, reference)
}
