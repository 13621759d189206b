//! What the law within limits did in a run, in times and shares; sentences say it.

mod sentences;

use controller_core::arm::ArmParameters;
use controller_core::fault::IndexSet;
use controller_core::joint::DOF;
use controller_core::ranges::MAX_LEVELS;
use record::run::{LevelSample, LimitSample, Sample};
use serde::Serialize;

/// From this share of its speed limit on a joint at a bound is held by the speed limit.
const FAST: f64 = 0.75;

/// So near to an end of its range \[rad\] a joint at a bound is held by the range.
const NEAR: f64 = 0.35;

/// Why joints and levels did not get what was asked of them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LimitEvents {
    /// Joints, base to flange.
    pub joints: Vec<JointEvents>,
    /// Levels, highest priority first.
    pub levels: Vec<LevelEvents>,
    /// How long the null space got less than it asked for \[s\].
    pub null_scaled_s: f64,
    /// The smallest share of it.
    pub null_least_share: f64,
    /// Most exchanges in a cycle.
    pub pivots_max: u8,
    /// Cycles whose bounds were kept by a cut.
    pub unresolved_cycles: usize,
    /// Largest power that the bounds put into the null-space motion \[W\].
    pub null_power_max_w: f64,
}

/// How long a joint was at a bound \[s\].
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct JointEvents {
    /// Near an end of its range.
    pub at_range_s: f64,
    /// Near its speed limit.
    pub at_speed_s: f64,
    /// Anywhere else: it could not be had faster.
    pub at_acceleration_s: f64,
}

/// What a level met.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct LevelEvents {
    /// How long it was driven less than it asked, near a singularity \[s\].
    pub degraded_s: f64,
    /// How long a direction was given to the levels below \[s\].
    pub released_s: f64,
    /// How long no free motion led out of it \[s\].
    pub stuck_s: f64,
    /// Its error where it is so at the end \[m\], or \[rad\].
    pub stuck_at_end: Option<f64>,
    /// How long its command was shortened \[s\].
    pub shaped_s: f64,
    /// How long it got less than it asked the joints for \[s\].
    pub scaled_s: f64,
    /// How long the bounds of the joints took something from it \[s\].
    pub disturbed_s: f64,
    /// The smallest share of what it asked for.
    pub least_share: f64,
    /// Most that the bounds of the joints took \[m/s2\].
    pub disturbance_max: f64,
    /// Its largest error while something of this was so \[m\], or \[rad\].
    pub error_max: f64,
}

/// What a degraded level is.
const NEAR_ONE: &str = "near a singularity";

/// Above this the bounds of the joints disturb a level \[m/s2\]: at K_p = 400 /s2 it is 0.025 mm.
const DISTURBED: f64 = 0.01;

impl LimitEvents {
    /// Adds a cycle of `cycle_s` \[s\] of an arm that has its limits from `arm`.
    pub fn add(&mut self, sample: &Sample, arm: &ArmParameters, cycle_s: f64) {
        let Some(limits) = &sample.limits else { return };
        self.joints.resize(DOF, JointEvents::default());
        for (joint, (events, link)) in self.joints.iter_mut().zip(&arm.links).enumerate() {
            let side = limits.at_bound(joint);
            if side == 0 {
                continue;
            }
            let (q, dq) = (sample.state.q[joint], sample.state.dq[joint]);
            let [least, greatest] = link.position_range;
            let way = if side > 0 { greatest - q } else { q - least };
            let time = if dq * f64::from(side) > FAST * link.speed_limit {
                &mut events.at_speed_s
            } else if way < NEAR {
                &mut events.at_range_s
            } else {
                &mut events.at_acceleration_s
            };
            *time += cycle_s;
        }
        self.levels
            .resize(sample.levels.len(), LevelEvents::default());
        for (level, (events, shown)) in self.levels.iter_mut().zip(&sample.levels).enumerate() {
            events.add(level, shown, limits, cycle_s);
        }
        if limits.status.scaled.contains(MAX_LEVELS) {
            let first = self.null_scaled_s == 0.0;
            self.null_scaled_s += cycle_s;
            self.null_least_share = least(first, self.null_least_share, limits.null_share);
        }
        self.pivots_max = self.pivots_max.max(limits.status.pivots);
        self.unresolved_cycles += usize::from(limits.status.unresolved);
        self.null_power_max_w = self.null_power_max_w.max(limits.null_power);
    }

    /// Whether there was such a law.
    #[must_use]
    pub fn is_known(&self) -> bool {
        !self.joints.is_empty()
    }

    /// Whether a limit was met.
    #[must_use]
    pub fn is_any(&self) -> bool {
        let joints = self.joints.iter().map(JointEvents::times);
        joints.flatten().any(|time| time > 0.0)
            || self.levels.iter().any(LevelEvents::is_any)
            || self.null_scaled_s > 0.0
            || self.unresolved_cycles > 0
    }
}

impl JointEvents {
    /// At the range, at the speed limit, anywhere else \[s\].
    pub(crate) fn times(&self) -> [f64; 3] {
        [self.at_range_s, self.at_speed_s, self.at_acceleration_s]
    }
}

fn least(first: bool, before: f64, now: f64) -> f64 {
    if first { now } else { before.min(now) }
}

impl LevelEvents {
    fn add(&mut self, level: usize, shown: &LevelSample, limits: &LimitSample, cycle_s: f64) {
        let status = &limits.status;
        let time = |set: IndexSet| if set.contains(level) { cycle_s } else { 0.0 };
        let disturbed = shown.disturbance > DISTURBED;
        let scaled = status.scaled.contains(level);
        if scaled {
            self.least_share = least(self.scaled_s == 0.0, self.least_share, shown.share);
        }
        self.degraded_s += time(status.degraded);
        self.released_s += time(status.released);
        self.stuck_s += time(status.stuck);
        self.stuck_at_end = status.stuck.contains(level).then_some(shown.error);
        self.shaped_s += time(status.shaped);
        self.scaled_s += time(status.scaled);
        self.disturbed_s += if disturbed { cycle_s } else { 0.0 };
        self.disturbance_max = self.disturbance_max.max(shown.disturbance);
        let met = disturbed
            || scaled
            || [status.degraded, status.released, status.shaped]
                .iter()
                .any(|set| set.contains(level));
        if met {
            self.error_max = self.error_max.max(shown.error);
        }
    }

    /// How long each was so \[s\], the most important first.
    fn times(&self) -> [(f64, &'static str); 5] {
        [
            (self.stuck_s, "stuck in a singularity"),
            (self.disturbed_s, "disturbed by the bounds of joints"),
            (self.released_s, "in a singularity"),
            (self.degraded_s, NEAR_ONE),
            (self.shaped_s, "with a shortened command"),
        ]
    }

    fn is_any(&self) -> bool {
        self.scaled_s > 0.0 || self.times().iter().any(|(time, _)| *time > 0.0)
    }
}
