//! The figures of a run: what they are, in which unit, and how some of them read.

use std::fmt;

use cell::scenario::{Metric, Unit};
use controller_core::fault::FaultKind;
use controller_core::joint::DOF;
use serde::Serialize;

/// Tracking figures of one level: norms over its axes, of the true motion, at
/// the cycle instants. Those of a position are in mm, those of an orientation in
/// mrad; the others are null.
#[derive(Clone, Debug, Serialize)]
pub struct LevelFigures {
    /// Point and axes.
    pub name: String,
    /// Over all cycles.
    pub rms_mm: Option<f64>,
    /// Largest.
    pub max_mm: Option<f64>,
    /// During contacts and 0.3 s after them.
    pub rms_inside_mm: Option<f64>,
    /// Over the other cycles.
    pub rms_outside_mm: Option<f64>,
    /// Mean over the last 0.2 s before each contact's force goes down.
    pub plateau_mm: Vec<Option<f64>>,
    /// Largest task acceleration that lower levels cause \[m/s2\], or \[rad/s2\].
    pub leak_max: Option<f64>,
    /// The same of an orientation.
    pub rms_mrad: Option<f64>,
    /// The same of an orientation.
    pub max_mrad: Option<f64>,
    /// The same of an orientation.
    pub plateau_mrad: Vec<Option<f64>>,
}

impl LevelFigures {
    /// In which unit the level is measured.
    #[must_use]
    pub fn unit(&self) -> Unit {
        if self.rms_mrad.is_some() {
            Unit::Milliradian
        } else {
            Unit::Millimetre
        }
    }

    /// rms over all cycles, in the level's unit.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        self.rms_mm.or(self.rms_mrad)
    }

    /// Largest error, in the level's unit.
    #[must_use]
    pub fn max(&self) -> Option<f64> {
        self.max_mm.or(self.max_mrad)
    }

    /// Plateaus of the contacts, in the level's unit; none that was not reached.
    pub fn plateaus(&self) -> impl Iterator<Item = Option<f64>> {
        self.plateau_mm.iter().chain(&self.plateau_mrad).copied()
    }

    /// The largest plateau that was reached, in the level's unit.
    #[must_use]
    pub fn worst_plateau(&self) -> Option<f64> {
        self.plateaus().flatten().reduce(f64::max)
    }
}

/// The value of a metric in the figures of a run; none without samples.
#[must_use]
pub fn value(metric: Metric, levels: &[LevelFigures]) -> Option<f64> {
    match metric {
        Metric::Rms(level) => levels[level].rms(),
        Metric::Max(level) => levels[level].max(),
        Metric::Plateau(level) => levels[level].worst_plateau(),
    }
}

/// The observer's figures \[Nm\], over joints and cycles.
#[derive(Clone, Debug, Serialize)]
pub struct ResidualFigures {
    /// rms of r + tau_ext.
    pub rms_error_nm: Option<f64>,
    /// rms of r.
    pub rms_nm: Option<f64>,
}

/// Torque figures.
#[derive(Clone, Debug, Serialize)]
pub struct TorqueFigures {
    /// Largest |torque| per joint \[Nm\].
    pub max_abs_nm: [f64; DOF],
    /// Cycles in which a joint was cut to its limit.
    pub saturated_cycles: usize,
    /// The largest step of a joint's torque, if one is above its bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<TorqueStep>,
}

/// The torque of a joint changed much from one cycle to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TorqueStep {
    /// The joint, from 1.
    pub joint: usize,
    /// Its maker's name.
    #[serde(skip)]
    pub name: &'static str,
    /// By how much \[Nm\].
    pub step_nm: f64,
    /// Half of its rate limit times the cycle \[Nm\].
    pub bound_nm: f64,
    /// In the cycle at this time \[s\].
    pub t_s: f64,
}

impl fmt::Display for TorqueStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the torque of {} stepped by {:.2} Nm in the cycle at {:.4} s, bound {} Nm",
            self.name, self.step_nm, self.t_s, self.bound_nm
        )
    }
}

/// Joint figures.
#[derive(Clone, Debug, Serialize)]
pub struct JointFigures {
    /// Travel per joint, largest less smallest position \[deg\].
    pub range_deg: [f64; DOF],
    /// Distance from the start posture in the last cycle, per joint \[deg\].
    pub end_offset_deg: [f64; DOF],
}

/// A joint beyond its range: the arm could not have gone there.
#[derive(Clone, Copy, Debug)]
pub struct Beyond {
    /// The joint's name of its maker.
    pub joint: &'static str,
    /// The position farthest outside its range \[rad\].
    pub reached: f64,
    /// What it may be \[rad\].
    pub range: [f64; 2],
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (joint, reached) = (self.joint, self.reached.to_degrees());
        // Back from radians to the number of the data sheet.
        let [min, max] = self.range.map(|end| (end.to_degrees() * 1e9).round() / 1e9);
        write!(
            f,
            "{joint} reached {reached:.4} deg, its range is {min} to {max}"
        )
    }
}

/// Cycles in which each limit was active.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct LimitCounts {
    /// A torque was cut.
    pub torque: usize,
    /// A task row was not resolvable.
    pub rank: usize,
    /// A joint was beyond its position range.
    pub position: usize,
}

/// Faults by kind.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct FaultCounts {
    /// Measurement or reference that cannot be true.
    pub implausible: usize,
    /// Torque that is not finite.
    pub non_finite_torque: usize,
    /// Target that does not fit its level; left out where there is none.
    #[serde(skip_serializing_if = "none")]
    pub wrong_target: usize,
}

fn none(count: &usize) -> bool {
    *count == 0
}

impl FaultCounts {
    /// Counts one. A kind that has no figure of its own is an implausible one.
    pub fn add(&mut self, kind: FaultKind) {
        match kind {
            FaultKind::NonFiniteTorque => self.non_finite_torque += 1,
            FaultKind::WrongTarget => self.wrong_target += 1,
            _ => self.implausible += 1,
        }
    }
}
