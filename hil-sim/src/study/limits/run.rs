//! One run in the closed loop.

use cell::invalid::Invalid;
use cell::names::{Named, PlantKind};
use controller_core::joint::{JointState, JointVector};
use controller_core::ranges::POSTURE_JUMP;
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State};

use super::case::Case;
use super::outcome::{Cycle, Outcome, Tally};
use crate::contact::PlacedPush;
use crate::plant::Plant;
use crate::sample::UnsafeMotion;

/// Which law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// [`Controller::exact`].
    Exact,
    /// [`Controller::new`].
    WithinLimits,
}

impl Named for Law {
    const THING: &'static str = "law";
    const ALL: &'static [(&'static str, Self)] = &[
        ("exact", Self::Exact),
        ("within-limits", Self::WithinLimits),
    ];
}

/// Precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double.
    F64,
    /// Single.
    F32,
}

impl Named for Precision {
    const THING: &'static str = "precision";
    const ALL: &'static [(&'static str, Self)] = &[("f64", Self::F64), ("f32", Self::F32)];
}

/// How a run is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditions {
    /// The arm.
    pub plant: PlantKind,
    /// Of the controller.
    pub precision: Precision,
    /// Of the controller.
    pub law: Law,
}

/// Makes a run.
///
/// # Errors
/// A configuration that the core refuses, a point that the arm does not have.
pub fn run(case: &Case, conditions: &Conditions) -> Result<Outcome, Invalid> {
    match conditions.precision {
        Precision::F64 => closed_loop::<f64>(case, conditions),
        Precision::F32 => closed_loop::<f32>(case, conditions),
    }
}

fn closed_loop<T: Real>(case: &Case, conditions: &Conditions) -> Result<Outcome, Invalid> {
    let (arm, config) = (&case.arm.parameters, case.config()?);
    let controller = match conditions.law {
        Law::Exact => Controller::<T>::exact(arm, &config),
        Law::WithinLimits => Controller::<T>::new(arm, &config),
    };
    let controller = controller.map_err(|error| Invalid::line(error).within(&case.name))?;
    let pushes = case.pushes.iter().cloned();
    let pushes: Vec<_> = pushes
        .map(|push| PlacedPush::new(push, &case.arm))
        .collect();
    let mut plant = Plant::new(
        conditions.plant,
        arm,
        case.start,
        case.cycle_s,
        case.plant_seed,
    );
    let mut state = State::<T>::new();
    // A posture that is elsewhere is meant to pull from the first cycle on.
    if (case.posture - case.start).amax() > POSTURE_JUMP {
        state.follow_at_once();
    }
    let mut tally = Tally::new(case);
    for number in 0..case.cycles() {
        let truth = *plant.state();
        if let Some(motion) = UnsafeMotion::of(&truth, arm) {
            return Ok(tally.finish(Some(stopped(number, case, &motion))));
        }
        let JointState { q, dq } = plant.measure();
        let measurement = Measurement {
            q: q.map(T::from_f64),
            dq: dq.map(T::from_f64),
            interval_s: T::from_f64(case.cycle_s),
        };
        if case.jumps {
            state.follow_at_once();
        }
        let step = controller.step(&mut state, &measurement, &reference(case, number));
        if let Some(fault) = &step.status.fault {
            return Ok(tally.finish(Some(stopped(number, case, fault))));
        }
        let torque = step.torque.map(T::to_f64);
        let cycle = Cycle {
            number,
            truth: &truth,
            torque: &torque,
            status: &step.status,
        };
        tally.add(&cycle, plant.model(), state.data());
        let t_s = number as f64 * case.cycle_s;
        plant.advance(t_s, &torque, |t, model, state| {
            let torques = pushes.iter().map(|push| push.torque(t, model, state));
            torques.fold(JointVector::zeros(), |sum, torque| sum + torque)
        });
    }
    Ok(tally.finish(None))
}

fn stopped(number: usize, case: &Case, why: &dyn std::fmt::Display) -> String {
    format!("{:.3} s: {why}", number as f64 * case.cycle_s)
}

/// What the controller is to follow, in its precision.
fn reference<T: Real>(case: &Case, number: usize) -> Reference<T> {
    let wanted = case.targets(number);
    let mut reference = Reference::hold(wanted.len(), case.posture.map(T::from_f64));
    for (target, wanted) in reference.targets_mut().iter_mut().zip(wanted) {
        *target = wanted.cast();
    }
    reference
}
