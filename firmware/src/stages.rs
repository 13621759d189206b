//! What a cycle costs, and each of its stages, over the inputs of [`workload`].
//!
//! Arguments and results pass `black_box` between the two readings of the clock,
//! so that nothing is computed before or after them, or not at all.

use core::hint::black_box;

use controller_core::cycle::record::Recorder;
use controller_core::cycle::stages::{Run, STAGE_COUNT};
use controller_core::cycle::{Data, Input};
use controller_core::ranges::PIVOTS;
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State, Step};

use crate::interlocked_controller::RECORDED;
use crate::log::Number;
use crate::workload;

/// A free-running counter, and how much of it an instruction is.
pub trait Clock {
    /// Present reading, wrapping around.
    fn ticks(&self) -> u32;
    /// Instructions in so many ticks.
    fn instructions(&self, ticks: u32) -> u32;
}

/// Smallest and largest number of instructions, and the input of the largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extremes {
    /// Smallest.
    pub min: u32,
    /// Largest.
    pub max: u32,
    /// Index of the first input with the largest.
    pub at: u32,
    /// How many inputs there were.
    pub inputs: u32,
}

impl Extremes {
    pub(crate) const NONE: Self = Self {
        min: u32::MAX,
        max: 0,
        at: 0,
        inputs: 0,
    };

    pub(crate) fn add(&mut self, count: u32, index: u32) {
        self.inputs += 1;
        self.min = self.min.min(count);
        if count > self.max {
            self.max = count;
            self.at = index;
        }
    }
}

/// Numbers of pivots that a cycle can take.
pub const PIVOT_COUNTS: usize = PIVOTS as usize + 1;

/// What all inputs together gave.
#[derive(Clone, Copy, Debug)]
pub struct Survey {
    /// Full cycle: checks, all stages and record.
    pub cycle: Extremes,
    /// The same by what decides on its path: whether commands have a limit near lost directions, then
    /// whether a level is released as well, then whether the arm is bent for it, and the pivots of
    /// the projection.
    pub paths: [[Extremes; PIVOT_COUNTS]; 4],
    /// The stages alone, in the order of [`Controller::STAGES`].
    pub stages: [Extremes; STAGE_COUNT],
    /// Cycles with a fault, with a torque that was cut, with a level released.
    pub faults: u32,
    /// See `faults`.
    pub saturated: u32,
    /// See `faults`.
    pub released: u32,
    /// FNV-1a of all torques: equal where all bits are.
    pub checksum: u64,
}

/// Controller, state and recorder of a measurement.
#[derive(Debug)]
pub struct Rig<T: Real> {
    /// The controller.
    pub controller: Controller<T>,
    /// Its state.
    pub state: State<T>,
    /// The last cycles.
    pub recorder: Recorder<T, RECORDED>,
}

impl<T: Real> Rig<T> {
    /// Before the first cycle.
    #[must_use]
    pub fn new(controller: Controller<T>) -> Self {
        Self {
            controller,
            state: State::new(),
            recorder: Recorder::new(),
        }
    }

    /// The full cycle that is measured.
    #[inline(always)]
    pub fn cycle(&mut self, measurement: &Measurement<T>, reference: &Reference<T>) -> Step<T> {
        let step = self
            .controller
            .step(&mut self.state, measurement, reference);
        self.recorder.push(measurement, &step);
        step
    }
}

/// Instructions that two readings of the clock count with an empty call between.
pub fn overhead(clock: &impl Clock) -> u32 {
    #[inline(never)]
    fn nothing(_: &u64) {}
    let measured = || {
        let start = clock.ticks();
        nothing(black_box(&0));
        clock.instructions(clock.ticks().wrapping_sub(start))
    };
    measured().min(measured())
}

/// Runs every input. `cycle` is [`Rig::cycle`] behind a call.
pub fn survey<T: Number>(
    rig: &mut Rig<T>,
    clock: &impl Clock,
    cycle: impl Fn(&mut Rig<T>, &Measurement<T>, &Reference<T>) -> Step<T>,
) -> Survey {
    let empty = overhead(clock);
    let mut survey = Survey {
        cycle: Extremes::NONE,
        paths: [[Extremes::NONE; PIVOT_COUNTS]; 4],
        stages: [Extremes::NONE; STAGE_COUNT],
        faults: 0,
        saturated: 0,
        released: 0,
        checksum: 0xcbf2_9ce4_8422_2325,
    };
    // The first cycle of all only takes the momentum.
    let mut data = Data::new();
    let (measurement, reference) = workload::input(&rig.controller, 0);
    let _ = cycle(rig, &measurement, &reference);
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    rig.controller.evaluate(&input, &mut data);
    let empty_stage = instructions(clock, |_, _, _| {}, &rig.controller, &input, &mut data);
    for index in 0..workload::COUNT {
        let (measurement, reference) = workload::input(&rig.controller, index);
        // References of random places are no motion: joining them is another path.
        rig.state.follow_at_once();
        let start = clock.ticks();
        let step = cycle(
            black_box(&mut *rig),
            black_box(&measurement),
            black_box(&reference),
        );
        let step = black_box(&step);
        let count = clock.instructions(clock.ticks().wrapping_sub(start));
        let count = count.saturating_sub(empty);
        survey.cycle.add(count, index);
        let (released, pivots) = (step.status.released.any(), step.status.pivots);
        let seen = rig.state.data();
        let (limited, bent) = (seen.spectrum.limits_commands, seen.way_out.bends());
        let way = usize::from(limited) + usize::from(released) + usize::from(bent);
        let paths = survey.paths.get_mut(way);
        if let Some(path) = paths.and_then(|paths| paths.get_mut(usize::from(pivots))) {
            path.add(count, index);
        }

        survey.faults += u32::from(step.status.fault.is_some());
        survey.saturated += u32::from(step.status.saturated.any());
        survey.released += u32::from(released);
        for byte in step.torque.iter().flat_map(|x| x.pattern().to_le_bytes()) {
            survey.checksum = (survey.checksum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }

        let input = Input {
            measurement: &measurement,
            reference: &reference,
        };
        data.follow_at_once();
        for (cost, (_, run)) in survey.stages.iter_mut().zip(Controller::<T>::STAGES) {
            let count = instructions(clock, run, &rig.controller, &input, &mut data);
            cost.add(count.saturating_sub(empty_stage), index);
        }
    }
    survey
}

/// Instructions of a stage and of what surrounds it, the same for every one.
#[inline(never)]
fn instructions<T: Real>(
    clock: &impl Clock,
    run: Run<T>,
    controller: &Controller<T>,
    input: &Input<'_, T>,
    data: &mut Data<T>,
) -> u32 {
    let start = clock.ticks();
    black_box(run)(
        black_box(controller),
        black_box(input),
        black_box(&mut *data),
    );
    black_box(data);
    clock.instructions(clock.ticks().wrapping_sub(start))
}
