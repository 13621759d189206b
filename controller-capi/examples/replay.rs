//! The sequence of `c/replay.c` through the core in Rust: the same lines.

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use controller_core::joint::JointVector;
use controller_core::real::Real;
use controller_core::task::{AfterStale, Stale};
use controller_core::{
    Axes, Change, Controller, ControllerConfig, Link, LinkPoint, Measurement, NullSpace, Order,
    State, Target, Task, TaskGains, TaskSet,
};
use std::fmt::Write;
use stratum::Scalar;

const CYCLES: u32 = 5000;
const CENTRE: [f64; 7] = [0.0, 0.625, 0.0, -1.375, 0.375, 1.0, 0.0];

/// Triangle wave between -0x4000 and 0x3fff.
fn wave(phase: u32) -> f64 {
    let phase = (phase & 0xffff) as i32;
    f64::from(phase.min(0xffff - phase) - 0x4000)
}

fn measure(cycle: u32) -> ([f64; 7], [f64; 7]) {
    let mut joints = ([0.0; 7], [0.0; 7]);
    for (i, centre) in CENTRE.into_iter().enumerate() {
        let step = i as u32 + 2;
        let phase = cycle * step + 0x1357 * i as u32;
        let speed = f64::from(step) / 64.0;
        joints.0[i] = centre + wave(phase) / 32768.0;
        joints.1[i] = if phase & 0xffff < 0x8000 {
            speed
        } else {
            -speed
        };
    }
    joints
}

/// FNV-1a over bytes.
fn hash_bits(hash: u64, bits: u64) -> u64 {
    bits.to_le_bytes().into_iter().fold(hash, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Stale after a quarter of a second, and released then.
fn stale(task: Task) -> Task {
    Task {
        stale: Some(Stale {
            age_s: 0.25,
            then: AfterStale::Release,
        }),
        ..task
    }
}

/// What changes at a cycle.
fn changes(cycle: u32, config: &ControllerConfig, wrist: Task) -> Option<Change> {
    let add = |slot, task, place| Change::Add { slot, task, place };
    Some(match cycle {
        600 => add(3, wrist, 1),
        700 => Change::Gains {
            slot: 0,
            gains: TaskGains::uniform(100.0, 20.0),
        },
        1000 => Change::Reorder(Order::new(&[2, 0, 3, 1])?),
        1700 => Change::Remove { slot: 0 },
        2600 => add(0, config.tasks.tasks()[0], 0),
        2800 => Change::Remove { slot: 3 },
        3600 => Change::NullSpace(config.null_space.stiffened(0.5)),
        _ => return None,
    })
}

fn replay() -> Result<String, Box<dyn std::error::Error>> {
    let vector = |values: [f64; 7]| JointVector::from(values.map(Scalar::from_f64));
    let gains = TaskGains::uniform(400.0, 40.0);
    let elbow = LinkPoint {
        link: Link::L3,
        offset: [0.0; 3],
    };
    let wrist = LinkPoint {
        link: Link::L5,
        offset: [0.0; 3],
    };
    let wrist = Task::position(wrist, Axes::Z, gains);
    let config = ControllerConfig {
        tasks: TaskSet::new(&[
            Task::position(LWR_IV_FLANGE, Axes::XYZ, gains),
            stale(Task::position(elbow, Axes::XY, gains)),
            Task::orientation(Link::L7.frame(), Axes::Z, gains),
            wrist,
        ])?
        .without(3),
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    let controller = Controller::<Scalar>::new(&LWR_IV, &config)?;
    let mut state = State::new();
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let (mut saturated, mut age_s) = (0, 0.0);
    let bits = Scalar::default().to_bits().count_zeros();
    let mut lines = format!("stratum {} f{bits}\n", env!("CARGO_PKG_VERSION"));
    for cycle in 0..CYCLES {
        let (q, dq) = measure(cycle);
        let mut reference = controller.rest_reference_of(&state, &vector(q));
        if let [
            Target::Position { x, .. },
            elbow,
            Target::Orientation { q, w, .. },
            _,
        ] = reference.targets_mut()
        {
            x.z = Scalar::from_f64(x.z.to_f64() + wave(64 * cycle) / 2_097_152.0);
            if (2000..2500).contains(&cycle) {
                *elbow = Target::Hold;
            }
            q[1] = Scalar::from_f64(q[1].to_f64() + wave(32 * cycle) / 1_048_576.0);
            w.z = Scalar::from_f64(wave(64 * cycle) / 1_048_576.0);
        }
        reference.posture = vector(CENTRE);
        if cycle == 3010 {
            state.reset();
        }
        if let Some(change) = changes(cycle, &config, wrist) {
            let duration_s = if cycle == 2800 { 1.0 } else { 0.5 };
            let transition = controller.transition(&change, duration_s)?;
            controller.begin(&mut state, &transition)?;
            // A level that comes holds until it has a reference.
            if let Change::Add { slot, .. } = change {
                reference.targets_mut()[slot] = Target::Hold;
            }
        }
        if cycle >= 4000 {
            age_s = f64::from(cycle - 4000) / 512.0;
        }
        reference.set_age(1, Scalar::from_f64(age_s));
        let interval_s = if cycle == 3000 { -1.0 } else { 1.0 / 512.0 };
        let measurement = Measurement {
            q: vector(q),
            dq: vector(dq),
            interval_s: Scalar::from_f64(interval_s),
        };
        let step = controller.step(&mut state, &measurement, &reference);
        state.set_applied_torque(&step.gravity);
        let fault = step
            .status
            .fault
            .map_or(0, |fault| u64::from(fault.kind.number()));
        saturated += u32::from(step.status.saturated.any());
        let numbers = step.torque.iter().chain(&step.residual);
        let numbers = numbers.map(|number| number.to_f64().to_bits());
        hash = std::iter::once(fault).chain(numbers).fold(hash, hash_bits);
        if cycle % 500 < 2 {
            write!(lines, "cycle {cycle}")?;
            for torque in &step.torque {
                write!(lines, " {:016x}", torque.to_f64().to_bits())?;
            }
            lines.push('\n');
        }
    }
    write!(lines, "saturated cycles {saturated}\nhash {hash:016x}\n")?;
    Ok(lines)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", replay()?);
    Ok(())
}
