//! A scripted push: constant force between two linear ramps.

use controller_core::joint::Vector3;
use serde::Deserialize;

use super::arm::EquippedArm;
use super::contact::{Interval, validate_times};
use super::point::PointSpec;
use crate::invalid::Invalid;
use crate::ranges::{FORCE_N, Range};

/// Force on a point of the arm, by the clock.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// Where the force acts.
    pub point: PointSpec,
    /// Start \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Length of each ramp, inside the interval \[s\].
    pub ramp_s: f64,
    /// Force on the arm \[N\], base-plate axes.
    pub force_n: [f64; 3],
}

impl Push {
    /// Checks point, times and force.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        self.point.validate(arm)?;
        let half = validate_times(self.from_s, self.to_s)? / 2.0;
        Range::above(0.0, half).check("ramp_s", self.ramp_s)?;
        self.force_n
            .iter()
            .try_for_each(|&force| FORCE_N.check("force_n", force).map(drop))
    }

    /// When it acts.
    #[must_use]
    pub fn interval(&self) -> Interval {
        Interval {
            from_s: self.from_s,
            to_s: self.to_s,
            ramp_s: self.ramp_s,
        }
    }

    /// Force on the arm at time `t_s` \[N\].
    #[must_use]
    pub fn force(&self, t_s: f64) -> Vector3<f64> {
        let ramp = ((t_s - self.from_s) / self.ramp_s).min((self.to_s - t_s) / self.ramp_s);
        Vector3::from(self.force_n) * ramp.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_ramps_inside_its_interval() {
        let push = Push {
            point: PointSpec::Name("elbow".into()),
            from_s: 3.0,
            to_s: 6.0,
            ramp_s: 0.3,
            force_n: [0.0, 35.0, 0.0],
        };
        for (t, share) in [
            (2.9, 0.0),
            (3.0, 0.0),
            (3.15, 0.5),
            (3.3, 1.0),
            (5.7, 1.0),
            (5.85, 0.5),
            (6.0, 0.0),
            (7.0, 0.0),
        ] {
            assert!((push.force(t).y - 35.0 * share).abs() < 1e-9, "{t}");
        }
    }
}
