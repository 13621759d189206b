//! One run: plant, controller and contacts in lock-step, in this process.

use std::io::{self, Write};

use controller_core::controller::{Controller, ControllerState};
use controller_core::fault::{Fault, FaultKind};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::measurement::{Measurement, Reference, SPEED_FACTOR};
use controller_core::model::ArmModel;
use controller_core::orientation;
use controller_core::task::Axes;

use crate::contact::Contacts;
use crate::controllers::{ControllerKind, LawGains};
use crate::invalid::Invalid;
use crate::metrics::{FaultCounts, Metrics, Sample};
use crate::names::{Named, NullStiffness};
use crate::plant::{Plant, PlantKind};
use crate::scenario::{self, Scenario, TaskSpec};
use crate::summary::{self, Summary, Verdict};
use crate::trace::{LevelRow, Row, Trace};

/// A scenario and the choices that a run adds to it.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// What is to be done.
    pub scenario: Scenario,
    /// On which plant.
    pub plant: PlantKind,
    /// Whether the scripted contacts act.
    pub contacts: bool,
    /// Which law.
    pub controller: ControllerKind,
    /// Factor on the null-space stiffness.
    pub null_stiffness: NullStiffness,
    /// Seed of mismatch and noise.
    pub seed: u64,
}

/// Why a run ended early.
#[derive(Clone, Debug)]
enum Stop {
    Safety(String),
    Fault(Fault),
}

impl Experiment {
    /// The controller of this run.
    ///
    /// # Errors
    /// A configuration that the core refuses, for example a damping that is too
    /// strong for the cycle.
    pub fn controller(&self) -> Result<Controller<f64>, Invalid> {
        let model = ArmModel::new(self.scenario.arm()).map_err(Invalid::line)?;
        let mut config = self.scenario.controller_config(0);
        config.null_space.stiffness *= self.null_stiffness.factor();
        Controller::new(&model, &config)
            .map_err(|error| Invalid::line(error).within(&self.scenario.name))
    }

    /// Runs it and writes the trace. `progress` is told the share done, 0 to 1.
    ///
    /// # Errors
    /// Those of `trace`.
    pub fn run<W: Write>(
        &self,
        controller: &Controller<f64>,
        trace: W,
        mut progress: impl FnMut(f64),
    ) -> io::Result<(Summary, W)> {
        let scenario = &self.scenario;
        let (cycle_s, cycles) = (scenario.cycle_s(), scenario.cycles());
        let mut contacts = if self.contacts {
            scenario.contacts()
        } else {
            Contacts::none()
        };
        let origins = scenario.origins();
        let gains = LawGains {
            rate: JointVector::repeat(scenario.null_space.rate_gain),
            stiffness: controller.null_space().stiffness,
        };
        let mut plant = Plant::new(
            self.plant,
            scenario.arm(),
            scenario.start(),
            cycle_s,
            self.seed,
        );
        let mut state = ControllerState::new();
        let mut metrics = Metrics::new(
            scenario.levels.len(),
            &contacts.intervals(),
            controller.model().position_limit(),
        );
        let mut trace = Trace::new(trace, scenario)?;
        let mut stop = None;

        for cycle in 0..cycles {
            let t_s = cycle as f64 * cycle_s;
            let truth = *plant.state();
            stop = unsafe_motion(&truth, controller.model()).map(Stop::Safety);
            if stop.is_some() {
                break;
            }
            let JointState { q, dq } = plant.measure();
            let measurement = Measurement {
                q,
                dq,
                interval_s: cycle_s,
            };
            let reference = scenario.reference(&origins, t_s);
            let step = controller.step_with(&mut state, &measurement, &reference, |cycle| {
                self.controller.decide(cycle, &gains).demand(cycle.dynamics)
            });
            stop = step.status.fault.map(Stop::Fault);
            if stop.is_some() {
                break;
            }

            contacts.take_hold(t_s, plant.model(), &truth);
            let (contact_torque, hand_force) = contacts.joint_torque(t_s, plant.model(), &truth);
            let levels = self.level_rows(&plant, &truth, &reference);
            let errors: Vec<_> = levels.iter().map(|level| level.error).collect();
            metrics.add(&Sample {
                t_s,
                state: &truth,
                errors: &errors,
                contact_torque: &contact_torque,
                hand_force,
                step: &step,
            });
            trace.push(&Row {
                t_s,
                state: &truth,
                torque: &step.torque,
                tau_ext: &-contact_torque,
                residual: &step.residual,
                levels: &levels,
            })?;
            plant.advance(t_s, &step.torque, |t, model, state| {
                contacts.joint_torque(t, model, state).0
            });
            if cycle % 512 == 0 {
                progress(cycle as f64 / cycles as f64);
            }
        }
        Ok((self.summary(&metrics, &contacts, stop), trace.finish()))
    }

    /// Desired and true coordinates of every level.
    fn level_rows(
        &self,
        plant: &Plant,
        truth: &JointState<f64>,
        reference: &Reference<f64>,
    ) -> Vec<LevelRow> {
        let levels = self.scenario.levels.iter().zip(&reference.tasks);
        levels
            .map(|(level, reference)| {
                let point = level.point.resolve();
                let axes = Axes::from_name(&level.axes).unwrap_or(Axes::XYZ);
                let chosen = || (0..3).filter(|&axis| axes.xyz[axis]);
                let pick = |v: &Vector3<f64>| chosen().map(|axis| v[axis]).collect::<Vec<_>>();
                let (desired, actual, difference) = match level.task {
                    TaskSpec::Position => {
                        let (x, _) = plant.model().point(truth, point.link, &point.offset);
                        (pick(&reference.x), pick(&x), reference.x - x)
                    }
                    TaskSpec::Orientation => {
                        let desired = reference.orientation;
                        let actual = scenario::orientation(&truth.q, point.link);
                        let error = orientation::error(&desired, &actual);
                        (
                            desired.as_slice().to_vec(),
                            actual.as_slice().to_vec(),
                            error,
                        )
                    }
                };
                let error = chosen()
                    .map(|axis| difference[axis].powi(2))
                    .sum::<f64>()
                    .sqrt();
                LevelRow {
                    desired,
                    actual,
                    error,
                }
            })
            .collect()
    }

    fn summary(&self, metrics: &Metrics, contacts: &Contacts, stop: Option<Stop>) -> Summary {
        let scenario = &self.scenario;
        let levels = metrics.levels(&scenario.levels);
        let acceptance = summary::judge(scenario, self.plant, self.contacts, &levels);
        let mut faults = FaultCounts::default();
        let (verdict, reason) = match stop {
            None => summary::verdict(&acceptance),
            Some(Stop::Safety(reason)) => (Verdict::Stopped, Some(reason)),
            Some(Stop::Fault(fault)) => {
                match fault.kind {
                    FaultKind::NonFiniteTorque => faults.non_finite_torque += 1,
                    _ => faults.implausible += 1,
                }
                (Verdict::Stopped, Some(fault.to_string()))
            }
        };
        Summary {
            scenario: scenario.name.clone(),
            controller: self.controller.name(),
            plant: Named::name(self.plant),
            contacts: self.contacts,
            seed: self.seed,
            cycle_ms: scenario.cycle_ms,
            duration_s: scenario.duration_s,
            cycles: metrics.cycles(),
            verdict,
            reason,
            acceptance,
            levels,
            residual: metrics.residual(),
            torque: metrics.torque(),
            joints: metrics.joints(),
            hand_force_max_n: contacts.has_hands().then(|| metrics.hand_force()),
            limits: metrics.limits(),
            faults,
        }
    }
}

/// Why the true motion must be stopped, if it must.
fn unsafe_motion(state: &JointState<f64>, model: &ArmModel<f64>) -> Option<String> {
    for joint in 0..model.speed_limit().len() {
        let (q, dq) = (state.q[joint], state.dq[joint]);
        let limit = SPEED_FACTOR * model.speed_limit()[joint];
        if !(q.is_finite() && dq.is_finite()) {
            return Some(format!(
                "joint {} is not finite: q = {q} rad, dq = {dq} rad/s",
                joint + 1
            ));
        }
        if dq.abs() > limit {
            return Some(format!(
                "speed of joint {} is {dq:.3} rad/s; allowed -{limit:.3} to {limit:.3}",
                joint + 1
            ));
        }
    }
    None
}
