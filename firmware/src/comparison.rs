//! A frozen cycle beside the generic one: the same inputs, the same results, and how many
//! instructions it takes.

use core::hint::black_box;

use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State, Target};
use frozen::FrozenCycle;

use crate::stages::{Clock, Extremes, overhead};
use crate::workload::{self, Random};

/// Hostile inputs of a comparison.
pub const HOSTILE: u32 = 2000;

/// What a comparison found.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Inputs on which the results differ.
    pub differing: u32,
    /// Cycles with a fault.
    pub faults: u32,
    /// Instructions of cycles with nothing at a limit or with joints cut to their torque only.
    pub idle: Extremes,
    /// Of all.
    pub all: Extremes,
}

/// Every input of [`workload`], then [`HOSTILE`] with numbers in them that cannot be.
pub fn compare<F: FrozenCycle>(
    controller: &Controller<F::Number>,
    cycle: &mut F,
    clock: &impl Clock,
    run: impl Fn(&mut F, &F::Input) -> F::Output,
) -> Comparison {
    let empty = overhead(clock);
    let mut found = Comparison {
        differing: 0,
        faults: 0,
        idle: Extremes::NONE,
        all: Extremes::NONE,
    };
    let mut state = State::new();
    let mut random = Random::new(1);
    for index in 0..workload::COUNT + HOSTILE {
        let is_hostile = index >= workload::COUNT;
        let (mut measurement, mut reference) = workload::input(controller, index % workload::COUNT);
        let mut at_once = true;
        if is_hostile {
            // Every few cycles anew, for a fault is latched; in between motions are joined.
            if random.below(5) == 0 {
                state = State::new();
                *cycle = F::NEW;
            }
            spoil(&mut random, &mut measurement, &mut reference);
            at_once = random.below(3) == 0;
        }
        if at_once {
            state.follow_at_once();
            cycle.follow_at_once();
        }
        let input = F::input(&measurement, &reference);
        let step = controller.step(&mut state, &measurement, &reference);
        let start = clock.ticks();
        let output = run(black_box(&mut *cycle), black_box(&input));
        let output = black_box(output);
        let count = clock.instructions(clock.ticks().wrapping_sub(start));
        let count = count.saturating_sub(empty);
        found.differing += u32::from(!F::gave(&output, &step));
        found.faults += u32::from(step.status.fault.is_some());
        if !is_hostile {
            found.all.add(count, index);
            let seen = state.data();
            let is_idle = !seen.spectrum.limits_commands
                && !step.status.released.any()
                && step.status.pivots == 0;
            if is_idle {
                found.idle.add(count, index);
            }
        }
    }
    found
}

/// Puts up to two numbers into an input that cannot be, or hardly; or holds a level.
fn spoil<T: Real>(
    random: &mut Random,
    measurement: &mut Measurement<T>,
    reference: &mut Reference<T>,
) {
    const ODD: [f64; 10] = [
        1e300,
        -1e300,
        1e-310,
        f64::NAN,
        f64::INFINITY,
        -0.0,
        3.0,
        1e-40,
        -5.0,
        1e20,
    ];
    for _ in 0..random.below(3) {
        let value = T::from_f64(ODD[random.below(10) as usize]);
        let place = random.below(7) as usize;
        let of = random.below(8);
        let targets = reference.targets_mut();
        let slot = random.below(targets.len() as u32) as usize;
        match (of, &mut targets[slot]) {
            (0, _) => measurement.q[place] = value,
            (1, _) => measurement.dq[place] = value,
            (2, _) => measurement.interval_s = value,
            (3, _) => reference.posture[place] = value,
            (4, target) => *target = Target::Hold,
            (5, Target::Position { x, .. }) => x[place % 3] = value,
            (6, Target::Position { dx, .. }) => dx[place % 3] = value,
            (_, Target::Position { ddx, .. }) => ddx[place % 3] = value,
            _ => {}
        }
    }
}
