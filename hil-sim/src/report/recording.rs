//! The time series of a run that a report shows.
//!
//! One series per quantity, all on the same times. A run may be long: the
//! recording is told its number of cycles beforehand and keeps at most
//! [`CAPACITY`] rows, two for every block of cycles, the extremes in the order
//! in which they came. A peak of one cycle is kept, whatever the length.

use controller_core::joint::{DOF, JointState, JointVector};

use crate::plant::PlantModel;
use crate::sample::{LevelSample, Sample};
use cell::scenario::Scenario;

/// Most rows that are kept.
pub const CAPACITY: usize = 1 << 15;

/// Instants of arm postures where no contact says when to look.
const FREE_SNAPSHOTS: usize = 5;

/// What one cycle adds, in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Cycle<'a> {
    /// Time \[s\].
    pub t_s: f64,
    /// True joint positions \[rad\].
    pub q: &'a JointVector<f64>,
    /// r \[Nm\], tends to -tau_ext.
    pub residual: &'a JointVector<f64>,
    /// True tau_ext \[Nm\] of M ddq + C dq + g = tau - tau_ext.
    pub tau_ext: &'a JointVector<f64>,
    /// |R_kk| per task row; the rest is not looked at. May be empty.
    pub conditioning: &'a [f64],
    /// Every level's part, highest priority first.
    pub levels: &'a [LevelCycle],
    /// Force of a person's hand \[N\], where one is simulated.
    pub hand_force_n: Option<f64>,
}

/// What one cycle adds to a level.
#[derive(Clone, Copy, Debug, Default)]
pub struct LevelCycle {
    /// Norm of the task error \[m\], or \[rad\].
    pub error: f64,
    /// Norm of the task acceleration that lower levels cause \[m/s2\]; NaN
    /// where it is not known.
    pub leak: f64,
    /// Desired position of the level's point \[m\].
    pub desired: [f64; 3],
    /// Its true position \[m\].
    pub actual: [f64; 3],
}

/// The arm's joint centres at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSnapshot {
    /// Time \[s\].
    pub t_s: f64,
    /// Shoulder, elbow, wrist, flange \[m\], base-plate frame.
    pub joints: [[f64; 3]; 4],
}

impl ArmSnapshot {
    /// The posture of `model` at `state`.
    #[must_use]
    pub fn new(t_s: f64, model: &PlantModel, state: &JointState<f64>, scenario: &Scenario) -> Self {
        let arm = scenario.arm();
        let centre = |link: usize, z: f64| {
            let (x, _) = model.point(state, link, &[0.0, 0.0, z].into());
            [x.x, x.y, x.z]
        };
        Self {
            t_s,
            joints: [
                [0.0, 0.0, arm.base_height],
                centre(3, 0.0),
                centre(5, 0.0),
                centre(7, arm.flange),
            ],
        }
    }
}

/// Time series of a run. Filled by [`Recording::push`], closed by
/// [`Recording::finish`].
#[derive(Clone, Debug)]
pub struct Recording {
    t: Vec<f64>,
    columns: Vec<Vec<f64>>,
    block: Vec<Vec<f64>>,
    block_t: Vec<f64>,
    block_len: usize,
    levels: usize,
    rows: usize,
    snapshots_due: Vec<f64>,
    /// Postures at the start and while the contacts press.
    pub arms: Vec<ArmSnapshot>,
}

// Columns: residual, tau_ext, q and conditioning take one per joint or row,
// then the hand, then the levels.
const RESIDUAL: usize = 0;
const TAU_EXT: usize = DOF;
const Q: usize = 2 * DOF;
const CONDITIONING: usize = 3 * DOF;
const HAND: usize = 4 * DOF;
const LEVELS: usize = HAND + 1;
const PER_LEVEL: usize = 8;

impl Recording {
    /// An empty recording for all cycles of `scenario`. `contacts` says
    /// whether its scripted contacts act.
    #[must_use]
    pub fn new(scenario: &Scenario, contacts: bool) -> Self {
        let levels = scenario.levels.len();
        let columns = LEVELS + PER_LEVEL * levels;
        Self {
            t: Vec::new(),
            columns: vec![Vec::new(); columns],
            block: vec![Vec::new(); columns],
            block_t: Vec::new(),
            block_len: block_len(scenario.cycles()),
            levels,
            rows: scenario.levels.iter().map(|level| level.axes.len()).sum(),
            snapshots_due: snapshot_times(scenario, contacts),
            arms: Vec::new(),
        }
    }

    /// Adds a cycle.
    pub fn push(&mut self, cycle: &Cycle<'_>) {
        self.block_t.push(cycle.t_s);
        let mut columns = self.block.iter_mut();
        let mut put = |value: f64| {
            if let Some(column) = columns.next() {
                column.push(value);
            }
        };
        cycle.residual.iter().copied().for_each(&mut put);
        cycle.tau_ext.iter().copied().for_each(&mut put);
        cycle.q.iter().map(|q| q.to_degrees()).for_each(&mut put);
        for row in 0..DOF {
            let known = cycle.conditioning.get(row).filter(|_| row < self.rows);
            put(known.copied().unwrap_or(f64::NAN));
        }
        put(cycle.hand_force_n.unwrap_or(f64::NAN));
        for index in 0..self.levels {
            let level = cycle.levels.get(index).copied().unwrap_or_default();
            put(level.error * 1e3);
            put(level.leak);
            level.desired.into_iter().for_each(&mut put);
            level.actual.into_iter().for_each(&mut put);
        }
        if self.block_t.len() == self.block_len {
            self.close_block();
        }
    }

    /// Adds a cycle of an experiment.
    pub fn record(&mut self, scenario: &Scenario, instant: &Sample<'_>) {
        let level = |level: &LevelSample| LevelCycle {
            error: level.error,
            leak: level.leak,
            desired: level.desired_point,
            actual: level.actual_point,
        };
        let hands = !scenario.hands.is_empty();
        self.push(&Cycle {
            t_s: instant.t_s,
            q: &instant.state.q,
            residual: instant.residual,
            tau_ext: instant.tau_ext,
            conditioning: instant.conditioning,
            levels: &instant.levels.iter().map(level).collect::<Vec<_>>(),
            hand_force_n: hands.then_some(instant.hand_force_n),
        });
        if self.snapshot_due(instant.t_s) {
            self.arms.push(ArmSnapshot::new(
                instant.t_s,
                instant.plant,
                instant.state,
                scenario,
            ));
        }
    }

    /// Whether the arm's posture at `t_s` is to be kept; then give it to
    /// [`Recording::arms`]. True once per instant.
    pub fn snapshot_due(&mut self, t_s: f64) -> bool {
        let due = self
            .snapshots_due
            .first()
            .is_some_and(|&next| t_s >= next - 1e-9);
        if due {
            self.snapshots_due.retain(|&next| t_s < next - 1e-9);
        }
        due
    }

    /// Takes in the last cycles of a run that did not fill a block.
    pub fn finish(&mut self) {
        if !self.block_t.is_empty() {
            self.close_block();
        }
    }

    fn close_block(&mut self) {
        if self.block_t.len() == 1 {
            self.t.append(&mut self.block_t);
            for (column, block) in self.columns.iter_mut().zip(&mut self.block) {
                column.append(block);
            }
            return;
        }
        let (first, last) = (self.block_t[0], self.block_t[self.block_t.len() - 1]);
        self.t.extend([first, 0.5 * (first + last)]);
        self.block_t.clear();
        for (column, block) in self.columns.iter_mut().zip(&mut self.block) {
            column.extend(extremes(block));
            block.clear();
        }
    }

    /// Times \[s\] of all series.
    #[must_use]
    pub fn t(&self) -> &[f64] {
        &self.t
    }

    /// Number of task levels.
    #[must_use]
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// Number of task rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// r of a joint \[Nm\].
    #[must_use]
    pub fn residual(&self, joint: usize) -> &[f64] {
        &self.columns[RESIDUAL + joint]
    }

    /// True tau_ext of a joint \[Nm\].
    #[must_use]
    pub fn tau_ext(&self, joint: usize) -> &[f64] {
        &self.columns[TAU_EXT + joint]
    }

    /// Position of a joint \[deg\].
    #[must_use]
    pub fn q_deg(&self, joint: usize) -> &[f64] {
        &self.columns[Q + joint]
    }

    /// |R_kk| of a task row \[1/sqrt(kg)\].
    #[must_use]
    pub fn conditioning(&self, row: usize) -> &[f64] {
        &self.columns[CONDITIONING + row]
    }

    /// Hand force \[N\]; NaN where there is no hand.
    #[must_use]
    pub fn hand_force_n(&self) -> &[f64] {
        &self.columns[HAND]
    }

    /// Norm of a level's task error \[mm\].
    #[must_use]
    pub fn error_milli(&self, level: usize) -> &[f64] {
        self.level(level, 0)
    }

    /// Task acceleration of a level that lower levels cause \[m/s2\].
    #[must_use]
    pub fn leak(&self, level: usize) -> &[f64] {
        self.level(level, 1)
    }

    /// Desired coordinate `axis` of a level's point \[m\].
    #[must_use]
    pub fn desired(&self, level: usize, axis: usize) -> &[f64] {
        self.level(level, 2 + axis)
    }

    /// True coordinate `axis` of a level's point \[m\].
    #[must_use]
    pub fn actual(&self, level: usize, axis: usize) -> &[f64] {
        self.level(level, 5 + axis)
    }

    fn level(&self, level: usize, part: usize) -> &[f64] {
        &self.columns[LEVELS + PER_LEVEL * level + part]
    }
}

/// Cycles per block, so that two rows per block stay within the capacity.
fn block_len(cycles: usize) -> usize {
    if cycles <= CAPACITY {
        1
    } else {
        (2 * cycles).div_ceil(CAPACITY)
    }
}

/// Start, and before each contact's force ramps down; evenly spread without.
fn snapshot_times(scenario: &Scenario, contacts: bool) -> Vec<f64> {
    let mut times = vec![0.0];
    let intervals = scenario.intervals();
    if contacts && !intervals.is_empty() {
        times.extend(intervals.iter().map(|c| c.to_s - c.ramp_s));
    } else {
        let step = scenario.duration_s / FREE_SNAPSHOTS as f64;
        times.extend((1..FREE_SNAPSHOTS).map(|k| k as f64 * step));
    }
    times.sort_by(f64::total_cmp);
    times
}

/// Smallest and largest of `values` in the order in which they occur; NaN only
/// if there is nothing else.
fn extremes(values: &[f64]) -> [f64; 2] {
    let mut low = (0, f64::NAN);
    let mut high = (0, f64::NAN);
    for (index, &value) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
        if low.1.is_nan() || value < low.1 {
            low = (index, value);
        }
        if high.1.is_nan() || value > high.1 {
            high = (index, value);
        }
    }
    if low.0 <= high.0 {
        [low.1, high.1]
    } else {
        [high.1, low.1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_is_bounded_and_keeps_its_peak() {
        let mut scenario = Scenario::find("two-level").unwrap();
        scenario.duration_s = 400.0;
        let mut recording = Recording::new(&scenario, true);
        let zero = JointVector::zeros();
        for k in 0..scenario.cycles() {
            let peak = if k == 123_457 { 0.25 } else { 1e-4 };
            let level = LevelCycle {
                error: peak,
                leak: f64::NAN,
                ..LevelCycle::default()
            };
            recording.push(&Cycle {
                t_s: k as f64 * scenario.cycle_s(),
                q: &zero,
                residual: &zero,
                tau_ext: &zero,
                conditioning: &[1.0; DOF],
                levels: &[level],
                hand_force_n: None,
            });
        }
        recording.finish();
        let error = recording.error_milli(0);
        assert!(error.len() <= CAPACITY && error.len() == recording.t().len());
        assert!(error.contains(&250.0));
        assert!(recording.t().windows(2).all(|pair| pair[0] < pair[1]));
        assert!(recording.leak(0).iter().all(|leak| leak.is_nan()));
        assert!(recording.conditioning(3).iter().all(|row| row.is_nan()));
    }

    #[test]
    fn postures_are_due_once_each() {
        let scenario = Scenario::find("two-level").unwrap();
        let mut recording = Recording::new(&scenario, true);
        let due = (0..scenario.cycles())
            .filter(|&k| recording.snapshot_due(k as f64 * scenario.cycle_s()));
        let times: Vec<_> = due.map(|k| k as f64 * scenario.cycle_s()).collect();
        assert_eq!(times.len(), 5, "{times:?}");
    }
}
