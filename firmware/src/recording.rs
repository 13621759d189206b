//! What the host runs to make the log of the self-test: closed loops with the realistic plant
//! and its contacts, and behind them cycles at the limits, the controller in either precision.

use std::io::{self, Write};

use cell::names::PlantKind;
use cell::scenario::Scenario;
use controller_core::fault::Status;
use controller_core::joint::JointState;
use controller_core::{Measurement, State};
use hil_sim::contact::Contacts;
use hil_sim::plant::{Plant, PlantOptions};

use crate::log::{Entry, Header, Number};
use crate::scenario::{CYCLE_S, FixedScenario, ReadyScenario};
use crate::workload;

/// Seed of mismatch and noise.
const SEED: u64 = 1;

/// One cycle in so many has its measurement from [`workload`]: singular postures, joints at the
/// ends of their ranges, far too fast.
const AT_LIMITS: u16 = 5;

/// Which limits the cycles of a log have met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Met {
    /// Cycles with the wish projected onto the bounds of the joints.
    pub projected: u32,
    /// Most pivots of one.
    pub pivots: u8,
    /// Cycles with a level released.
    pub released: u32,
}

impl Met {
    fn add(&mut self, status: &Status) {
        self.projected += u32::from(status.pivots > 0);
        self.pivots = self.pivots.max(status.pivots);
        self.released += u32::from(status.released.any());
    }
}

/// Writes one run of `cycles` cycles.
///
/// # Errors
/// Those of the writer, and a cycle with a fault, of which there is none.
pub fn write_run<T: Number>(
    out: &mut impl Write,
    scenario: FixedScenario,
    cycles: u16,
    met: &mut Met,
) -> io::Result<()> {
    let ready = ReadyScenario::<T>::new(scenario).map_err(io::Error::other)?;
    let built_in = Scenario::find(scenario.name()).map_err(io::Error::other)?;
    let mut contacts = Contacts::of(&built_in);
    let mut plant = Plant::with_options(
        PlantKind::Realistic,
        &built_in.arm().parameters,
        built_in.start(),
        CYCLE_S,
        SEED,
        PlantOptions::default(),
    );
    let mut state = State::new();
    let header = Header {
        scenario,
        bytes: T::BYTES as u8,
        cycles,
    };
    out.write_all(&header.encode())?;
    let at_limits = cycles / AT_LIMITS;
    let driven = cycles - at_limits;
    for cycle in 0..cycles {
        let t_s = f64::from(cycle) * CYCLE_S;
        let truth = *plant.state();
        let JointState { q, dq } = plant.measure();
        let measurement = if cycle < driven {
            Measurement {
                q: q.map(T::from_f64),
                dq: dq.map(T::from_f64),
                interval_s: T::from_f64(CYCLE_S),
            }
        } else {
            // Some of every kind.
            let index = u32::from(cycle - driven) * workload::COUNT / u32::from(at_limits);
            workload::input(&ready.controller, index).0
        };
        let reference = ready.reference(u32::from(cycle));
        let step = ready.controller.step(&mut state, &measurement, &reference);
        if let Some(fault) = step.status.fault {
            return Err(io::Error::other(std::format!("cycle {cycle}: {fault}")));
        }
        met.add(&step.status);
        let entry = Entry {
            measurement,
            torque: step.torque,
        };
        let length = crate::log::NUMBERS * T::BYTES;
        out.write_all(entry.encode().get(..length).unwrap_or_default())?;
        contacts.take_hold(t_s, plant.model(), &truth);
        plant.advance(t_s, &step.torque.map(T::to_f64), |t, model, state| {
            contacts.joint_torque(t, model, state).0
        });
    }
    Ok(())
}

/// Writes both scenarios in both precisions.
///
/// # Errors
/// As [`write_run`].
pub fn write_log(out: &mut impl Write, cycles: u16) -> io::Result<Met> {
    let mut met = Met::default();
    for scenario in FixedScenario::ALL {
        write_run::<f64>(out, scenario, cycles, &mut met)?;
        write_run::<f32>(out, scenario, cycles, &mut met)?;
    }
    Ok(met)
}
