//! What a cycle costs, and each of its parts, over the inputs of [`workload`].
//!
//! Arguments and results pass `black_box` between the two readings of the clock,
//! so that nothing is computed before or after them, or not at all.

use core::hint::black_box;

use controller_core::controller::{Controller, ControllerState, Step};
use controller_core::dynamics::Dynamics;
use controller_core::hierarchy::Hierarchy;
use controller_core::joint::{DOF, JointState, JointVector, zeros};
use controller_core::kinematics::Kinematics;
use controller_core::law::{Command, Cycle, TaskMotion, TorqueDemand};
use controller_core::limits::TorqueCommand;
use controller_core::measurement::{Measurement, Reference};
use controller_core::observer::Observer;
use controller_core::real::Real;
use controller_core::record::Recorder;
use controller_core::task::TaskRows;

use crate::log::Number;
use crate::workload;

/// Cycles in the recorder of the measurement.
pub const RECORDED: usize = 64;

/// The parts of a cycle, in its order.
pub const STAGES: [&str; 10] = [
    "kinematics",
    "dynamics",
    "observer",
    "task rows",
    "hierarchy",
    "motion",
    "command",
    "demand",
    "limits",
    "observer input",
];

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
}

impl Extremes {
    const NONE: Self = Self {
        min: u32::MAX,
        max: 0,
        at: 0,
    };

    fn add(&mut self, count: u32, index: u32) {
        self.min = self.min.min(count);
        if count > self.max {
            self.max = count;
            self.at = index;
        }
    }
}

/// What all inputs together gave.
#[derive(Clone, Copy, Debug)]
pub struct Survey {
    /// Full cycle: checks, law, limits, observer and record.
    pub cycle: Extremes,
    /// The parts alone, as in [`STAGES`].
    pub stages: [Extremes; STAGES.len()],
    /// Cycles with a fault, with a torque that was cut, with a row not resolved.
    pub faults: u32,
    /// See `faults`.
    pub saturated: u32,
    /// See `faults`.
    pub deficient: u32,
    /// FNV-1a of all torques: equal where all bits are.
    pub checksum: u64,
}

/// Controller, state and recorder of a measurement.
#[derive(Debug)]
pub struct Rig<T: Real> {
    /// The controller.
    pub controller: Controller<T>,
    /// Its state.
    pub state: ControllerState<T>,
    /// The last cycles.
    pub recorder: Recorder<T, RECORDED>,
}

impl<T: Real> Rig<T> {
    /// Before the first cycle.
    #[must_use]
    pub fn new(controller: Controller<T>) -> Self {
        Self {
            controller,
            state: ControllerState::new(),
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
    let net = |start: u32, end: u32| {
        let count = clock.instructions(end.wrapping_sub(start));
        count.saturating_sub(empty)
    };
    let mut survey = Survey {
        cycle: Extremes::NONE,
        stages: [Extremes::NONE; STAGES.len()],
        faults: 0,
        saturated: 0,
        deficient: 0,
        checksum: 0xcbf2_9ce4_8422_2325,
    };
    // The first cycle of all only takes the momentum.
    let mut observer = Observer::new();
    observer.update(&zeros(), T::ONE, &zeros());
    let (measurement, reference) = workload::input(&rig.controller, 0);
    let _ = cycle(rig, &measurement, &reference);
    for index in 0..workload::COUNT {
        let (measurement, reference) = workload::input(&rig.controller, index);
        let start = clock.ticks();
        let step = cycle(
            black_box(&mut *rig),
            black_box(&measurement),
            black_box(&reference),
        );
        let step = black_box(&step);
        survey.cycle.add(net(start, clock.ticks()), index);

        survey.faults += u32::from(step.status.fault.is_some());
        survey.saturated += u32::from(step.status.saturated.any());
        survey.deficient += u32::from(step.status.rank.any());
        for byte in step.torque.iter().flat_map(|x| x.pattern().to_le_bytes()) {
            survey.checksum = (survey.checksum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }

        let joints = JointState {
            q: measurement.q,
            dq: measurement.dq,
        };
        let costs = stage_costs(&rig.controller, &mut observer, &joints, &reference, clock);
        for (stage, (start, end)) in survey.stages.iter_mut().zip(costs) {
            stage.add(net(start, end), index);
        }
    }
    survey
}

/// One part between two readings: its result is a new variable, its times another.
macro_rules! timed {
    ($clock:ident, $times:ident, $function:path, $($argument:expr),+) => {{
        #[inline(never)]
        fn call<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        let start = $clock.ticks();
        let result = call(|| $function($(black_box($argument)),+));
        black_box(&result);
        // There are as many places as parts.
        let _ = $times.push((start, $clock.ticks()));
        result
    }};
}

fn stage_costs<T: Real>(
    controller: &Controller<T>,
    observer: &mut Observer<T>,
    joints: &JointState<T>,
    reference: &Reference<T>,
    clock: &impl Clock,
) -> heapless::Vec<(u32, u32), { STAGES.len() }> {
    let mut times = heapless::Vec::new();
    let model = controller.model();
    let gain = JointVector::from([T::from_f64(50.0); DOF]);
    let interval_s = T::from_f64(crate::job::CYCLE_S);
    let null_space = controller.null_space();
    let posture = &reference.posture;

    let kinematics = timed!(clock, times, Kinematics::new, model, joints);
    let mut dynamics = Dynamics::empty();
    timed!(
        clock,
        times,
        Dynamics::update,
        &mut dynamics,
        model,
        &kinematics,
        joints
    );
    let residual = timed!(
        clock,
        times,
        Observer::update,
        &mut *observer,
        &gain,
        interval_s,
        &dynamics.momentum
    );
    let mut rows = TaskRows::empty();
    timed!(
        clock,
        times,
        TaskRows::stack,
        &mut rows,
        controller.tasks(),
        &reference.tasks,
        &kinematics,
        joints
    );
    let hierarchy = timed!(clock, times, Hierarchy::new, &rows, &dynamics.cholesky);
    let motion = timed!(clock, times, TaskMotion::new, &dynamics, &hierarchy, joints);
    let command = timed!(
        clock,
        times,
        Command::new,
        null_space,
        &dynamics,
        &rows,
        &hierarchy,
        &motion,
        joints,
        posture
    );
    let cycle = Cycle {
        state: joints,
        kinematics: &kinematics,
        dynamics: &dynamics,
        rows: &rows,
        hierarchy: &hierarchy,
        motion: &motion,
        posture,
        command: &command,
        residual: &residual,
    };
    let demand = timed!(clock, times, TorqueDemand::hierarchical, &cycle);
    let limit = model.torque_limit();
    let limited = timed!(clock, times, TorqueCommand::new, &demand, limit);
    let torque = limited.map_or(zeros(), |command| command.torque);
    timed!(
        clock,
        times,
        Observer::apply,
        &mut *observer,
        &dynamics,
        joints,
        &torque
    );
    times
}
