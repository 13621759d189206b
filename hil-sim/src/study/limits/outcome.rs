//! What a run reached.

use controller_core::Status;
use controller_core::arm::{ArmParameters, LinkParameters};
use controller_core::cycle::Data;
use controller_core::fault::IndexSet;
use controller_core::joint::{DOF, JointState, JointVector};
use controller_core::real::Real;
use controller_core::task::Tracked;
use serde::Serialize;

use super::case::Case;
use super::truth;
use crate::plant::PlantModel;

/// How long after the references are back a level has to be there \[s\].
pub const RECOVERY_S: f64 = 1.0;

/// The end of a run that counts as its end \[s\].
const END_S: f64 = 0.2;

/// The figures of one run. Errors are in mm, of orientations in mrad; the true motion is what
/// counts.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The run.
    pub run: String,
    /// Why it ended before its time.
    pub stop: Option<String>,
    /// Cycles that it lasted.
    pub cycles: usize,
    /// Largest |torque| \[Nm\].
    pub torque_nm: f64,
    /// Largest change of a torque from one cycle to the next.
    pub step: Step,
    /// Largest |dq| of each joint, as a share of its speed limit where it was.
    pub speed_shares: [f64; DOF],
    /// The position farthest beyond the range of its joint \[deg\]; negative inside.
    pub beyond_deg: f64,
    /// Largest distance from the start, joint by joint \[deg\].
    pub travel_deg: [f64; DOF],
    /// Largest |dq| while the reference rests far out \[rad/s\].
    pub hold_speed: Option<f64>,
    /// Level by level, highest priority first.
    pub levels: Vec<LevelOutcome>,
    /// Most exchanges of the projection in a cycle.
    pub pivots: u8,
    /// Least and largest power of the bounds on the null-space motion \[W\].
    pub null_power_w: [f64; 2],
    /// Cycles in which limits were active.
    pub limited: LimitedCycles,
}

/// The largest step of a torque.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Step {
    /// By how much \[Nm\].
    pub nm: f64,
    /// Of which joint, from 1; 0 where there was none.
    pub joint: usize,
    /// In the cycle at this time \[s\].
    pub t_s: f64,
}

/// What became of a level.
#[derive(Clone, Debug, Serialize)]
pub struct LevelOutcome {
    /// Which it is, such as "flange xyz".
    pub level: String,
    /// Whether its errors are in mrad.
    pub turns: bool,
    /// Largest error.
    pub max: f64,
    /// rms error.
    pub rms: f64,
    /// Largest error from 1 s after the references are back.
    pub back: Option<f64>,
    /// Mean error while the reference of the first level rests far out.
    pub hold: Option<f64>,
    /// Largest error in the last 0.2 s.
    pub end: f64,
    /// Largest acceleration that the bounds of the joints took from it \[m/s2\].
    pub disturbance: f64,
    /// Largest acceleration that it got from what stands below it, in cycles in which neither it
    /// nor a level above was released \[m/s2\].
    pub leak: f64,
}

/// Cycles in which each limit was active.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "named as the limits of the core")]
pub struct LimitedCycles {
    pub any: usize,
    pub saturated: usize,
    pub torque_rate: usize,
    pub joining: usize,
    pub degraded: usize,
    pub released: usize,
    pub shaped: usize,
    pub scaled: usize,
    pub bounded: usize,
    pub unresolved: usize,
    pub stuck: usize,
}

impl Outcome {
    /// Largest |dq| of any joint, as a share of its speed limit where it was.
    #[must_use]
    pub fn speed_share(&self) -> f64 {
        self.speed_shares.into_iter().fold(0.0, f64::max)
    }
}

impl LimitedCycles {
    fn add(&mut self, status: &Status) {
        let on = |set: IndexSet| usize::from(set.any());
        self.any += usize::from(!status.is_clear());
        self.saturated += on(status.saturated);
        self.torque_rate += on(status.rate_limited);
        self.joining += on(status.joining);
        self.degraded += on(status.degraded);
        self.released += on(status.released);
        self.shaped += on(status.shaped);
        self.scaled += on(status.scaled);
        self.bounded += usize::from(status.at_least.any() || status.at_greatest.any());
        self.unresolved += usize::from(status.unresolved);
        self.stuck += on(status.stuck);
    }
}

/// Figures of a run on its way.
pub struct Tally<'a> {
    case: &'a Case,
    outcome: Outcome,
    sums: Vec<Sums>,
    last_torque: Option<JointVector<f64>>,
}

#[derive(Clone, Default)]
struct Sums {
    squares: f64,
    hold: f64,
    holding: usize,
}

/// One cycle of a run.
pub struct Cycle<'a> {
    /// Its number, from 0.
    pub number: usize,
    /// How the arm really moves.
    pub truth: &'a JointState<f64>,
    /// The torque \[Nm\].
    pub torque: &'a JointVector<f64>,
    /// What the controller says of it.
    pub status: &'a Status,
}

impl<'a> Tally<'a> {
    /// Before the first cycle.
    #[must_use]
    pub fn new(case: &'a Case) -> Self {
        let levels = case.levels.iter().map(|level| LevelOutcome {
            level: level.label.clone(),
            turns: matches!(level.task.tracked, Tracked::Orientation(_)),
            max: 0.0,
            rms: 0.0,
            back: None,
            hold: None,
            end: 0.0,
            disturbance: 0.0,
            leak: 0.0,
        });
        Self {
            case,
            outcome: Outcome {
                run: case.name.clone(),
                stop: None,
                cycles: 0,
                torque_nm: 0.0,
                step: Step::default(),
                speed_shares: [0.0; DOF],
                beyond_deg: f64::NEG_INFINITY,
                travel_deg: [0.0; DOF],
                hold_speed: None,
                levels: levels.collect(),
                pivots: 0,
                null_power_w: [0.0; 2],
                limited: LimitedCycles::default(),
            },
            sums: vec![Sums::default(); case.levels.len()],
            last_torque: None,
        }
    }

    /// Adds a cycle. `model` is the plant's, `data` what the controller made of the cycle.
    pub fn add<T: Real>(&mut self, cycle: &Cycle<'_>, model: &PlantModel, data: &Data<T>) {
        let t_s = cycle.number as f64 * self.case.cycle_s;
        let outcome = &mut self.outcome;
        outcome.cycles += 1;
        outcome.limited.add(cycle.status);
        outcome.pivots = outcome.pivots.max(cycle.status.pivots);
        let power = data.projection.power.to_f64();
        let [least, greatest] = outcome.null_power_w;
        outcome.null_power_w = [least.min(power), greatest.max(power)];
        add_joints(outcome, cycle, &self.case.arm.parameters, &self.case.start);
        if let Some(last) = self.last_torque.replace(*cycle.torque) {
            let change = (cycle.torque - last).abs();
            let (joint, nm) = change.argmax();
            if nm > outcome.step.nm {
                let joint = joint + 1;
                outcome.step = Step { nm, joint, t_s };
            }
        }
        let holding = self
            .case
            .hold_s
            .is_some_and(|[from, to]| (from..to).contains(&t_s));
        if holding {
            let speed = cycle.truth.dq.amax();
            outcome.hold_speed = Some(outcome.hold_speed.map_or(speed, |most| most.max(speed)));
        }
        self.add_levels(cycle, t_s, holding, model, data);
    }

    fn add_levels<T: Real>(
        &mut self,
        cycle: &Cycle<'_>,
        t_s: f64,
        holding: bool,
        model: &PlantModel,
        data: &Data<T>,
    ) {
        let case = self.case;
        let back_s = case
            .back_at_s
            .map_or(f64::INFINITY, |back| back + RECOVERY_S);
        let end_s = case.cycles() as f64 * case.cycle_s - END_S;
        let targets = case.levels.iter().zip(case.targets(cycle.number));
        let figures = self.outcome.levels.iter_mut().zip(&mut self.sums);
        for (index, ((level, target), (figures, sums))) in targets.zip(figures).enumerate() {
            let disturbance = data.projection.disturbance[index].to_f64();
            figures.disturbance = figures.disturbance.max(disturbance);
            if cycle.status.released.0 & ((2 << index) - 1) == 0 {
                figures.leak = figures.leak.max(data.wish.leak[index].to_f64());
            }
            let off = truth::error(model, &cycle.truth.q, &level.task, target);
            let error = off.unwrap_or(0.0) * 1e3;
            figures.max = figures.max.max(error);
            sums.squares += error * error;
            if t_s > back_s {
                figures.back = Some(figures.back.map_or(error, |most| most.max(error)));
            }
            if holding {
                sums.hold += error;
                sums.holding += 1;
            }
            if t_s >= end_s {
                figures.end = figures.end.max(error);
            }
        }
    }

    /// The run is over, for this reason before its time.
    #[must_use]
    pub fn finish(mut self, stop: Option<String>) -> Outcome {
        self.outcome.stop = stop;
        let cycles = self.outcome.cycles.max(1) as f64;
        for (figures, sums) in self.outcome.levels.iter_mut().zip(&self.sums) {
            figures.rms = (sums.squares / cycles).sqrt();
            figures.hold = (sums.holding > 0).then(|| sums.hold / sums.holding as f64);
        }
        self.outcome
    }
}

/// |dq| as a share of what the joint may have at q.
fn speed_share(link: &LinkParameters, q: f64, dq: f64) -> f64 {
    let [least, greatest] = link.speed_range(q);
    let limit = if dq < 0.0 { -least } else { greatest };
    if dq == 0.0 { 0.0 } else { dq.abs() / limit }
}

fn add_joints(
    outcome: &mut Outcome,
    cycle: &Cycle<'_>,
    arm: &ArmParameters,
    start: &JointVector<f64>,
) {
    for (i, link) in arm.links.iter().enumerate() {
        let (q, dq) = (cycle.truth.q[i], cycle.truth.dq[i]);
        let [min, max] = link.position_range;
        outcome.torque_nm = outcome.torque_nm.max(cycle.torque[i].abs());
        let share = speed_share(link, q, dq);
        outcome.speed_shares[i] = outcome.speed_shares[i].max(share);
        outcome.beyond_deg = outcome.beyond_deg.max((min - q).max(q - max).to_degrees());
        let travel = (q - start[i]).abs().to_degrees();
        outcome.travel_deg[i] = outcome.travel_deg[i].max(travel);
    }
}
