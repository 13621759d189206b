//! Figures of a run, accumulated cycle by cycle.

mod changes;
mod figures;

use cell::scenario::{Interval, LevelSpec, Scenario, TaskSpec};
use controller_core::arm::{ArmParameters, LinkParameters};
use controller_core::joint::{DOF, JointVector};

use crate::limit_events::LimitEvents;
use record::run::Sample;

use self::changes::Presence;

pub use changes::ChangeFigures;
pub use figures::{
    Beyond, FaultCounts, JointFigures, LevelFigures, LimitCounts, ResidualFigures, TorqueFigures,
    TorqueStep, value,
};

/// Beyond its range by less a joint is at its end: degrees became radians \[rad\].
const ROUNDING_RAD: f64 = 1e-9;

/// From this share of what the arm's rate limit lets through in a cycle on, the torque
/// steps: motion, contacts and noise of the built-in scenarios stay below it, a reference
/// that jumps does not.
const STEP_SHARE: f64 = 0.5;

/// Mean of what was added.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn value(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }

    /// Of squares: root mean square.
    fn root(&self) -> Option<f64> {
        self.value().map(f64::sqrt)
    }
}

#[derive(Clone, Debug, Default)]
struct LevelSums {
    /// Of squares.
    all: Mean,
    /// Of squares, during contacts and otherwise.
    inside: Mean,
    outside: Mean,
    max: Option<f64>,
    leak: Option<f64>,
    plateaus: Vec<Mean>,
}

/// Running figures of a run.
#[derive(Clone, Debug)]
pub struct Metrics {
    contacts: Vec<Interval>,
    levels: Vec<LevelSums>,
    /// Of squares.
    residual_error: Mean,
    /// Of squares.
    residual: Mean,
    max_torque: [f64; DOF],
    lowest: [f64; DOF],
    highest: [f64; DOF],
    joints: [&'static str; DOF],
    position_range: [JointVector<f64>; 2],
    /// Of the change of torque in a cycle \[Nm\].
    step_bound: JointVector<f64>,
    last_torque: Option<JointVector<f64>>,
    /// Of each event of the scenario.
    pub(crate) changes: Vec<ChangeFigures>,
    presence: Presence,
    step: Option<TorqueStep>,
    first: JointVector<f64>,
    last: JointVector<f64>,
    /// Largest force of a hand \[N\].
    pub(crate) hand_force: f64,
    /// Cycles in which limits were active.
    pub(crate) limits: LimitCounts,
    /// What the law within limits did.
    pub(crate) limit_events: LimitEvents,
    arm: ArmParameters,
    cycle_s: f64,
    /// Cycles added.
    pub(crate) cycles: usize,
}

/// Levels with whether they rotate.
fn names(levels: &[LevelSpec]) -> Vec<(String, bool)> {
    let name = |level: &LevelSpec| (level.label(), level.task == TaskSpec::Orientation);
    levels.iter().map(name).collect()
}

impl Metrics {
    /// No cycle of `scenario` with `arm` yet.
    #[must_use]
    pub fn new(scenario: &Scenario, contacts: &[Interval], arm: &ArmParameters) -> Self {
        let cycle_s = scenario.cycle_s();
        let limit =
            |value: fn(&LinkParameters) -> f64| JointVector::from_fn(|i, _| value(&arm.links[i]));
        let sums = LevelSums {
            plateaus: vec![Mean::default(); contacts.len()],
            ..LevelSums::default()
        };
        Self {
            contacts: contacts.to_vec(),
            levels: vec![sums; scenario.levels.len()],
            residual_error: Mean::default(),
            residual: Mean::default(),
            max_torque: [0.0; DOF],
            lowest: [f64::INFINITY; DOF],
            highest: [f64::NEG_INFINITY; DOF],
            joints: arm.links.map(|link| link.name),
            position_range: [
                limit(|link| link.position_range[0]),
                limit(|link| link.position_range[1]),
            ],
            step_bound: limit(|link| link.torque_rate_limit) * (STEP_SHARE * cycle_s),
            last_torque: None,
            changes: ChangeFigures::of(scenario),
            presence: Presence::of(scenario),
            step: None,
            first: JointVector::zeros(),
            last: JointVector::zeros(),
            hand_force: 0.0,
            limits: LimitCounts::default(),
            limit_events: LimitEvents::default(),
            arm: *arm,
            cycle_s,
            cycles: 0,
        }
    }

    /// Adds a cycle.
    pub fn add(&mut self, sample: &Sample) {
        if self.cycles == 0 {
            self.first = sample.state.q;
        }
        self.last = sample.state.q;
        self.cycles += 1;
        self.hand_force = self.hand_force.max(sample.hand_force_n);
        let inside = |contact: &Interval| contact.inside(sample.t_s);
        let inside = self.contacts.iter().any(inside);
        let larger = |of: Option<f64>, value: f64| Some(of.map_or(value, |most| most.max(value)));
        for (index, (level, shown)) in self.levels.iter_mut().zip(&sample.levels).enumerate() {
            if !self.presence.is_there(index, sample.t_s) {
                continue;
            }
            if !shown.leak.is_nan() {
                level.leak = larger(level.leak, shown.leak);
            }
            let error = shown.error * 1e3;
            level.max = larger(level.max, error);
            level.all.add(error * error);
            let part = if inside {
                &mut level.inside
            } else {
                &mut level.outside
            };
            part.add(error * error);
            for (plateau, contact) in level.plateaus.iter_mut().zip(&self.contacts) {
                if contact.plateau(sample.t_s) {
                    plateau.add(error);
                }
            }
        }
        let mut beyond = false;
        for joint in 0..DOF {
            let (q, torque) = (sample.state.q[joint], sample.torque[joint]);
            let residual = sample.residual[joint];
            self.residual.add(residual * residual);
            self.residual_error
                .add((residual + sample.tau_ext[joint]).powi(2));
            self.max_torque[joint] = self.max_torque[joint].max(torque.abs());
            self.lowest[joint] = self.lowest[joint].min(q);
            self.highest[joint] = self.highest[joint].max(q);
            beyond |= self.excess(joint, q) > ROUNDING_RAD;
        }
        self.add_step(sample);
        self.limit_events.add(sample, &self.arm, self.cycle_s);
        self.limits.position += usize::from(beyond);
        self.limits.torque += usize::from(sample.saturated);
        self.limits.rank += usize::from(sample.rank);
    }

    /// Keeps the step of torque that is farthest above its bound.
    fn add_step(&mut self, sample: &Sample) {
        let last = self.last_torque.replace(sample.torque);
        let Some(last) = last else { return };
        let steps: [f64; DOF] = (sample.torque - last).abs().into();
        for change in &mut self.changes {
            change.add(sample, &steps, &self.presence);
        }
        for (joint, step_nm) in steps.into_iter().enumerate() {
            let bound_nm = self.step_bound[joint];
            let most = self.step.map_or(1.0, |step| step.step_nm / step.bound_nm);
            if step_nm / bound_nm > most {
                self.step = Some(TorqueStep {
                    joint: joint + 1,
                    name: self.joints[joint],
                    step_nm,
                    bound_nm,
                    t_s: sample.t_s,
                });
            }
        }
    }

    /// Tracking figures of the levels.
    #[must_use]
    pub fn levels(&self, levels: &[LevelSpec]) -> Vec<LevelFigures> {
        let figures = |(sums, level): (&LevelSums, &LevelSpec)| {
            let position = level.task == TaskSpec::Position;
            let split = |value: Option<f64>| match position {
                true => (value, None),
                false => (None, value),
            };
            let (rms_mm, rms_mrad) = split(sums.all.root());
            let (max_mm, max_mrad) = split(sums.max);
            let plateaus = sums.plateaus.iter().map(Mean::value);
            let (plateau_mm, plateau_mrad) = match position {
                true => (plateaus.collect(), Vec::new()),
                false => (Vec::new(), plateaus.collect()),
            };
            LevelFigures {
                name: level.label(),
                rms_mm,
                max_mm,
                rms_inside_mm: split(sums.inside.root()).0,
                rms_outside_mm: split(sums.outside.root()).0,
                plateau_mm,
                leak_max: sums.leak,
                rms_mrad,
                max_mrad,
                plateau_mrad,
            }
        };
        self.levels.iter().zip(levels).map(figures).collect()
    }

    /// Levels that are stuck at the end, in sentences.
    #[must_use]
    pub fn unreached(&self, levels: &[LevelSpec]) -> Vec<String> {
        self.limit_events.unreached(&names(levels))
    }

    /// What the law within limits did, in sentences.
    #[must_use]
    pub fn limit_sentences(&self, levels: &[LevelSpec]) -> Vec<String> {
        self.limit_events
            .sentences(&self.arm, &names(levels), self.cycle_s)
    }

    /// The observer's figures.
    #[must_use]
    pub fn residual(&self) -> ResidualFigures {
        ResidualFigures {
            rms_error_nm: self.residual_error.root(),
            rms_nm: self.residual.root(),
        }
    }

    /// The intervals of the contacts that the run was to have.
    #[must_use]
    pub fn contacts(&self) -> &[Interval] {
        &self.contacts
    }

    /// Joints that were beyond their range, how far they came and what they may \[rad\].
    pub fn beyond(&self) -> impl Iterator<Item = Beyond> {
        (0..DOF).filter_map(|index| {
            let (lowest, highest) = (self.lowest[index], self.highest[index]);
            let [low, high] = [lowest, highest].map(|q| self.excess(index, q));
            let reached = if low > high { lowest } else { highest };
            let is_beyond = low.max(high) > ROUNDING_RAD && self.cycles > 0;
            is_beyond.then_some(Beyond {
                joint: self.joints[index],
                reached,
                range: self.position_range.map(|end| end[index]),
            })
        })
    }

    /// How far `q` \[rad\] of a joint is outside its range; negative inside.
    fn excess(&self, index: usize, q: f64) -> f64 {
        let [least, greatest] = self.position_range.map(|end| end[index]);
        (least - q).max(q - greatest)
    }

    /// Torque figures.
    #[must_use]
    pub fn torque(&self) -> TorqueFigures {
        TorqueFigures {
            max_abs_nm: self.max_torque,
            saturated_cycles: self.limits.torque,
            step: self.step,
        }
    }

    /// Joint figures.
    #[must_use]
    pub fn joints(&self) -> JointFigures {
        let range = |i: usize| (self.highest[i] - self.lowest[i]).max(0.0).to_degrees();
        let offset = |i: usize| (self.last[i] - self.first[i]).abs().to_degrees();
        JointFigures {
            range_deg: std::array::from_fn(range),
            end_offset_deg: std::array::from_fn(offset),
        }
    }
}
