//! The time series of a run that a report shows.
//!
//! One series per quantity, all on the same times. A run may be long: the
//! recording is told its number of cycles beforehand and keeps at most
//! [`CAPACITY`] rows, two for every block of cycles, the extremes in the order
//! in which they came. A peak of one cycle is kept, whatever the length.

use cell::scenario::{EquippedArm, Scenario};
use record::channel::{Channel, Value};
use record::run::{CHANNELS, LEVEL_CHANNELS, Sample};

use super::met::Met;
use super::plot::{Series, Style};
use crate::arm_points::outline;
use crate::contact::Contacts;
use crate::plant::PlantModel;

/// Most rows that are kept.
pub const CAPACITY: usize = 1 << 15;

/// Instants of arm postures where no contact says when to look.
const FREE_SNAPSHOTS: usize = 5;

/// The drawn arm at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSnapshot {
    /// Time \[s\].
    pub t_s: f64,
    /// Base plate to flange or tool \[m\], base-plate frame ([`outline`]).
    pub corners: Vec<[f64; 3]>,
}

/// Time series of a run. Filled by [`Recording::push`], closed by
/// [`Recording::finish`].
#[derive(Clone, Debug)]
pub struct Recording {
    t: Vec<f64>,
    /// The columns of the series channels, those of the levels behind them.
    columns: Vec<Vec<f64>>,
    block: Vec<Vec<f64>>,
    block_t: Vec<f64>,
    block_len: usize,
    levels: usize,
    rows: usize,
    has_hands: bool,
    snapshots_due: Vec<f64>,
    arm: EquippedArm,
    plant: PlantModel,
    met: Met,
    /// Postures at the start and while the contacts press.
    pub arms: Vec<ArmSnapshot>,
}

/// Series of a run: time apart, it is what they are drawn over.
fn series<S>(channels: &[Channel<S>]) -> impl Iterator<Item = &Channel<S>> {
    let drawn = channels
        .iter()
        .filter(|channel| channel.place.is_in_series());
    drawn.filter(|channel| channel.columns != "t")
}

/// Axes of a point in series: x, y, z.
const AXES: usize = 3;

/// Number of columns of series.
fn width<S>(channels: &[Channel<S>]) -> usize {
    series(channels).map(|channel| channel.width(AXES)).sum()
}

/// Index of the first column of the channel with these columns.
fn place<S>(channels: &[Channel<S>], columns: &str) -> usize {
    let before = series(channels).take_while(|channel| channel.columns != columns);
    before.map(|channel| channel.width(AXES)).sum()
}

/// A value in the unit that a report shows: degrees, thousandths of an error.
fn shown(columns: &str, value: f64) -> f64 {
    match columns {
        "q{joint}" => value.to_degrees(),
        "e{level}" => value * 1e3,
        _ => value,
    }
}

impl Recording {
    /// An empty recording for all cycles of `scenario`. `contacts` says
    /// whether its scripted contacts act.
    #[must_use]
    pub fn new(scenario: &Scenario, contacts: bool) -> Self {
        let arm = scenario.arm();
        let levels = scenario.levels.len();
        let columns = width(CHANNELS) + levels * width(LEVEL_CHANNELS);
        Self {
            t: Vec::new(),
            columns: vec![Vec::new(); columns],
            block: vec![Vec::new(); columns],
            block_t: Vec::new(),
            block_len: block_len(scenario.cycles()),
            levels,
            rows: scenario.levels.iter().map(|level| level.axes.len()).sum(),
            has_hands: !scenario.hands.is_empty(),
            snapshots_due: snapshot_times(scenario, contacts),
            plant: PlantModel::new(&arm.parameters),
            met: Met::new(levels, scenario.duration_s, scenario.cycle_s()),
            arm,
            arms: Vec::new(),
        }
    }

    /// Adds a cycle.
    pub fn push(&mut self, sample: &Sample) {
        self.block_t.push(sample.t_s);
        if let Some(limits) = &sample.limits {
            self.met.add(sample.t_s, limits);
        }
        let mut columns = self.block.iter_mut();
        let mut put = |name: &str, value: Value| {
            let number = match value {
                Value::Count(count) => count as f64,
                Value::Number(number) if name != "hand_force" || self.has_hands => number,
                _ => f64::NAN,
            };
            if let Some(column) = columns.next() {
                column.push(shown(name, number));
            }
        };
        for channel in series(CHANNELS) {
            (channel.values)(sample, &mut |value| put(channel.columns, value));
        }
        for level in &sample.levels {
            for channel in series(LEVEL_CHANNELS) {
                (channel.values)(level, &mut |value| put(channel.columns, value));
            }
        }
        if self.block_t.len() == self.block_len {
            self.close_block();
        }
        if self.snapshot_due(sample.t_s) {
            self.arms.push(ArmSnapshot {
                t_s: sample.t_s,
                corners: outline(&self.arm, &self.plant, &sample.state.q),
            });
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

    /// A line of one of the series over time.
    #[must_use]
    pub fn line(&self, label: impl Into<String>, values: &[f64], style: Style) -> Series {
        Series::new(label, &self.t, values, style)
    }

    /// The arm of the run.
    #[must_use]
    pub fn arm(&self) -> &EquippedArm {
        &self.arm
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
        self.column("r{joint}", joint)
    }

    /// True tau_ext of a joint \[Nm\].
    #[must_use]
    pub fn tau_ext(&self, joint: usize) -> &[f64] {
        self.column("tau_ext{joint}", joint)
    }

    /// Position of a joint \[deg\].
    #[must_use]
    pub fn q_deg(&self, joint: usize) -> &[f64] {
        self.column("q{joint}", joint)
    }

    /// Speed of a joint \[rad/s\].
    #[must_use]
    pub fn dq(&self, joint: usize) -> &[f64] {
        self.column("dq{joint}", joint)
    }

    /// Torque of a joint \[Nm\].
    #[must_use]
    pub fn torque(&self, joint: usize) -> &[f64] {
        self.column("tau{joint}", joint)
    }

    /// When limits were met.
    #[must_use]
    pub fn met(&self) -> &Met {
        &self.met
    }

    /// Exchanges of the projection; NaN without the law within limits.
    #[must_use]
    pub fn pivots(&self) -> &[f64] {
        self.column("pivots", 0)
    }

    /// Share of what it asks for that the null space got; NaN without the law within limits.
    #[must_use]
    pub fn null_share(&self) -> &[f64] {
        self.column("null_share", 0)
    }

    /// The same of a level.
    #[must_use]
    pub fn share(&self, level: usize) -> &[f64] {
        self.level(level, "share{level}", 0)
    }

    /// Task acceleration that the bounds of the joints take from a level \[m/s2\].
    #[must_use]
    pub fn disturbance(&self, level: usize) -> &[f64] {
        self.level(level, "disturbance{level}", 0)
    }

    /// |R_kk| of a task row \[1/sqrt(kg)\].
    #[must_use]
    pub fn conditioning(&self, row: usize) -> &[f64] {
        self.column("conditioning{row}", row)
    }

    /// Hand force \[N\]; NaN where there is no hand.
    #[must_use]
    pub fn hand_force_n(&self) -> &[f64] {
        self.column("hand_force", 0)
    }

    /// Norm of a level's task error \[mm\], of an orientation \[mrad\].
    #[must_use]
    pub fn error_milli(&self, level: usize) -> &[f64] {
        self.level(level, "e{level}", 0)
    }

    /// Task acceleration of a level that lower levels cause \[m/s2\].
    #[must_use]
    pub fn leak(&self, level: usize) -> &[f64] {
        self.level(level, "leak{level}", 0)
    }

    /// Desired coordinate `axis` of a level's point \[m\].
    #[must_use]
    pub fn desired(&self, level: usize, axis: usize) -> &[f64] {
        self.level(level, "point{level}_des_{axis}", axis)
    }

    /// True coordinate `axis` of a level's point \[m\].
    #[must_use]
    pub fn actual(&self, level: usize, axis: usize) -> &[f64] {
        self.level(level, "point{level}_{axis}", axis)
    }

    fn column(&self, columns: &str, index: usize) -> &[f64] {
        &self.columns[place(CHANNELS, columns) + index]
    }

    fn level(&self, level: usize, columns: &str, index: usize) -> &[f64] {
        let start = width(CHANNELS) + level * width(LEVEL_CHANNELS);
        &self.columns[start + place(LEVEL_CHANNELS, columns) + index]
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
    let intervals = Contacts::of(scenario).intervals();
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
    use controller_core::joint::JointState;
    use controller_core::joint::JointVector;
    use record::run::LevelSample;

    fn sample(t_s: f64, level: LevelSample) -> Sample {
        let zero = JointVector::zeros();
        Sample {
            t_s,
            state: JointState { q: zero, dq: zero },
            torque: zero,
            residual: zero,
            mode: None,
            saturated: false,
            rank: false,
            tau_ext: zero,
            hand_force_n: 0.0,
            conditioning: vec![1.0; 3],
            limits: None,
            levels: vec![level],
        }
    }

    #[test]
    fn a_long_run_is_bounded_and_keeps_its_peak() {
        let mut scenario = Scenario::find("two-level").unwrap();
        scenario.duration_s = 400.0;
        let mut recording = Recording::new(&scenario, true);
        for k in 0..scenario.cycles() {
            let peak = if k == 123_457 { 0.25 } else { 1e-4 };
            let level = LevelSample {
                error: peak,
                leak: f64::NAN,
                ..LevelSample::default()
            };
            recording.push(&sample(k as f64 * scenario.cycle_s(), level));
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
