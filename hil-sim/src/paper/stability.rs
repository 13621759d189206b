//! Stability as the paper argues it: Lyapunov functions along runs of the ideal
//! arm that start off their references.
//!
//! The loop is sampled and the arm is not: a function that decreases in
//! continuous time may rise by a sampling term in a cycle. Every run is made at
//! three cycle times; the rises must shrink with the cycle.
//!
//! - V_i (43), one per level, gains diagonal, x~ and dx~ the errors of the level:
//!   `x~^T (K_d / K_p + K_p / K_d + 1 / K_d) x~ / 2 + x~^T K_p^-1 dx~
//!   + dx~^T (1 + 1 / K_p) / K_d dx~ / 2`, whose derivative along
//!   `ddx~ + K_d dx~ + K_p x~ = 0` is `-x~^T x~ - dx~^T dx~`.
//! - V_1 (41): the same of the first level plus c r~^T K_I^-1 r~ / 2 with r~ = r +
//!   tau_ext, for a constant tau_ext. c is chosen large enough for the cross terms.
//! - V_l (46): n^T M n / 2 + q~*^T K_q q~* / 2 with n the null-space velocity and
//!   q~* the distance from the integrated posture (51), coupled form; its
//!   derivative is -n^T D n.

use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointVector, Vector3};
use controller_core::law::control::TorqueDemand;
use controller_core::law::null_space::{Compliance, Posture};
use controller_core::{Controller, ControllerConfig, Measurement, Reference, State, Target};
use serde::Serialize;

use crate::arm_points::origins;
use crate::plant::Plant;
use crate::spread;
use cell::invalid::Invalid;
use cell::names::PlantKind;
use cell::scenario::Scenario;

/// Cycle times of the runs \[ms\].
pub const CYCLES_MS: [f64; 3] = [2.0, 1.0, 0.5];

/// Length of a run \[s\]: 40 time constants of the task error.
const DURATION_S: f64 = 2.0;

/// How far the tasks start from their references \[m\].
const TASK_OFFSET_M: f64 = 5e-3;

/// How far the arm starts from the null space's posture, along the null space \[rad\].
const POSTURE_OFFSET_RAD: f64 = 0.1;

/// Constant external joint torque \[Nm\] for V_1.
const EXTERNAL_TORQUE: [f64; 7] = [5.0, -6.0, 4.0, 3.0, -0.5, 0.4, 0.0];

/// c of V_1: above (|K_p^-1 J M^-1|^2 + |(1 + 1/K_p) / K_d J M^-1|^2) / 4 for the
/// arm's first level, where |J M^-1| stays below 60.
const RESIDUAL_WEIGHT: f64 = 2.0;

/// Below this share of its start value a rise is rounding.
const ROUNDING: f64 = 1e-13;

/// One Lyapunov function along one run.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// "V1", "V2", .., "Vl".
    pub name: String,
    /// Cycle time \[ms\].
    pub cycle_ms: f64,
    /// Times \[s\].
    #[serde(skip)]
    pub t: Vec<f64>,
    /// Values, relative to the first.
    #[serde(skip)]
    pub value: Vec<f64>,
    /// Cycles in which it rises beyond rounding.
    pub rises: usize,
    /// Largest rise in a cycle, relative to the first value.
    pub largest_rise: f64,
}

/// Which function a run is for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    WithResidual,
    Tasks,
    NullSpace,
}

/// All functions at all cycle times, on the first case's arm and levels, by `workers` runs at the
/// same time. None where a signal ended it.
///
/// # Errors
/// None for the built-in scenario.
pub fn evidence(workers: usize) -> Result<Option<Vec<Evidence>>, Invalid> {
    let kinds = [Kind::WithResidual, Kind::Tasks, Kind::NullSpace];
    let runs = kinds.map(|kind| CYCLES_MS.map(|cycle_ms| (kind, cycle_ms)));
    let progress = |_, _| ();
    let made = spread::in_order(
        runs.as_flattened(),
        workers,
        progress,
        |&(kind, cycle_ms)| run(kind, cycle_ms),
    )?;
    Ok(made.map(|made| made.into_iter().flatten().collect()))
}

fn run(kind: Kind, cycle_ms: f64) -> Result<Vec<Evidence>, Invalid> {
    let scenario = Scenario {
        cycle_ms,
        ..Scenario::find("case-1")?
    };
    let mut config = scenario.controller_config(0)?;
    if kind == Kind::NullSpace {
        config.null_space.posture = Posture::IntegralCoupled;
    }
    let arm = scenario.arm().parameters;
    let controller = Controller::exact(&arm, &config).map_err(Invalid::line)?;
    let cycle_s = scenario.cycle_s();
    let mut plant = Plant::new(PlantKind::Ideal, &arm, scenario.start(), cycle_s, 1);
    let mut state = State::new();
    let external = if kind == Kind::WithResidual {
        JointVector::from(EXTERNAL_TORQUE)
    } else {
        JointVector::zeros()
    };

    let mut reference = Reference::hold(controller.level_count(), scenario.start());
    let origins = origins(&scenario, &scenario.start());
    for (target, origin) in reference.targets_mut().iter_mut().zip(origins) {
        *target = origin;
        if let (Target::Position { x, .. }, true) = (target, kind != Kind::NullSpace) {
            *x += Vector3::from([TASK_OFFSET_M, -TASK_OFFSET_M, TASK_OFFSET_M]);
        }
    }
    if kind == Kind::NullSpace {
        let direction = null_direction(&controller, &scenario.start(), &reference);
        reference.posture += direction * POSTURE_OFFSET_RAD;
    }

    // The offset is what the functions are about.
    state.follow_at_once();
    let mut values: Vec<Vec<f64>> = Vec::new();
    let mut times = Vec::new();
    for cycle in 0..(DURATION_S / cycle_s) as usize {
        let t_s = cycle as f64 * cycle_s;
        let truth = *plant.state();
        let measurement = Measurement {
            q: truth.q,
            dq: truth.dq,
            interval_s: cycle_s,
        };
        let step = controller.step_with(&mut state, &measurement, &reference, |_, _, data| {
            // Without external torque the residual is sampling error only; the
            // paper's V_i and V_l are for r~ = 0.
            let residual = if kind == Kind::WithResidual {
                *data.residual()
            } else {
                JointVector::zeros()
            };
            let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
            data.demand = TorqueDemand::compensating(dynamics, hierarchy, &data.control, &residual);
        });
        let shown = functions(
            kind,
            &config,
            controller.compliance(),
            state.data(),
            &(step.residual - external),
        );
        times.push(t_s);
        values.resize(shown.len(), Vec::new());
        for (series, value) in values.iter_mut().zip(shown) {
            series.push(value);
        }
        plant.advance(t_s, &step.torque, |_, _, _| external);
    }
    let named = |(index, series): (usize, Vec<f64>)| {
        let name = match kind {
            Kind::WithResidual => "V1".to_string(),
            Kind::Tasks => format!("V{} contact-free", index + 1),
            Kind::NullSpace => "Vl".to_string(),
        };
        summarise(name, cycle_ms, &times, series)
    };
    Ok(values.into_iter().enumerate().map(named).collect())
}

/// A motion of length 1 that the tasks do not notice: the null-space part of the
/// same speed in every joint. An offset across it could never decay.
fn null_direction(
    controller: &Controller<f64>,
    start: &JointVector<f64>,
    reference: &Reference<f64>,
) -> JointVector<f64> {
    let measurement = Measurement {
        q: *start,
        dq: JointVector::repeat(1.0),
        interval_s: 1.0,
    };
    let input = Input {
        measurement: &measurement,
        reference,
    };
    let mut data = Data::new();
    controller.evaluate_until(StageName::MotionSplit, &input, &mut data);
    data.motion.null_velocity.normalize()
}

/// The values of the functions of this kind, from the results of a cycle that saw the
/// true state.
fn functions(
    kind: Kind,
    config: &ControllerConfig,
    compliance: &Compliance<f64>,
    data: &Data<f64>,
    residual_error: &JointVector<f64>,
) -> Vec<f64> {
    let (rows, dq) = (&data.rows, &data.joints.dq);
    let levels = config
        .tasks
        .tasks()
        .iter()
        .enumerate()
        .map(|(level, task)| {
            let (kp, kd) = (task.gains.stiffness[0][0], task.gains.damping[0][0]);
            data.hierarchy
                .level_range(level)
                .map(|row| {
                    let (x, dx) = (rows.error[row], -rows.jacobian[row].dot(dq));
                    0.5 * (kd / kp + (kp + 1.0) / kd) * x * x
                        + x * dx / kp
                        + 0.5 * (1.0 + 1.0 / kp) / kd * dx * dx
                })
                .sum::<f64>()
        });
    match kind {
        Kind::Tasks => levels.collect(),
        Kind::WithResidual => {
            let weighted: f64 = residual_error
                .iter()
                .zip(&config.observer_gain)
                .map(|(r, gain)| RESIDUAL_WEIGHT * r * r / gain)
                .sum();
            levels.take(1).map(|first| first + 0.5 * weighted).collect()
        }
        Kind::NullSpace => {
            let n = data.motion.null_velocity;
            let offset = data.posture - data.joints.q;
            let stiffness = compliance.stiffness;
            let kinetic = n.dot(&(data.dynamics.mass_matrix * n));
            vec![0.5 * (kinetic + offset.dot(&(stiffness * offset)))]
        }
    }
}

fn summarise(name: String, cycle_ms: f64, t: &[f64], mut value: Vec<f64>) -> Evidence {
    let first = value.first().copied().unwrap_or(1.0);
    value.iter_mut().for_each(|v| *v /= first);
    let rises = value
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|rise| *rise > ROUNDING);
    let (count, largest) = rises.fold((0, 0.0f64), |(n, max), rise| (n + 1, max.max(rise)));
    Evidence {
        name,
        cycle_ms,
        t: t.to_vec(),
        value,
        rises: count,
        largest_rise: largest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// V_1 and V_i never rise; V_l rises by a sampling term that at least halves
    /// twice with the cycle.
    #[test]
    fn the_functions_decrease_up_to_a_sampling_term() {
        let all = evidence(2).expect("built-in scenario").expect("no signal");
        assert_eq!(all.len(), 12);
        for e in &all {
            if e.name != "Vl" {
                assert_eq!(e.rises, 0, "{} at {} ms", e.name, e.cycle_ms);
                assert!(e.value.last().expect("cycles") < &1e-12);
            }
        }
        let null: Vec<_> = all.iter().filter(|e| e.name == "Vl").collect();
        // The first cycle's sampling term, of order h^4.
        assert!(null[0].largest_rise < 3e-7);
        for e in &null {
            // What is left lies across the null space: the arm turned meanwhile.
            assert!(e.value.last().expect("cycles") < &1e-3);
        }
        for pair in null.windows(2) {
            assert!(pair[1].largest_rise < 0.25 * pair[0].largest_rise);
        }
    }
}
