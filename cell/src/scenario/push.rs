//! A scripted push: constant force between two linear ramps.

use controller_core::joint::Vector3;

use super::arm::EquippedArm;
use super::contact::{AFTER_START, BEFORE_END, HALF_INTERVAL, Interval, length};
use super::point::{POINT, PointSpec};
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Said};
use crate::keys::keys;
use crate::ranges::{FORCE_N, Range, TIME_S};

keys! {
    /// Force on a point of the arm, by the clock.
    #[derive(Clone, Debug)]
    pub struct Push {
        /// Where the force acts.
        pub point: PointSpec, "", Said(POINT);
        /// Start.
        pub from_s: f64, "s", And(TIME_S, BEFORE_END);
        /// End.
        pub to_s: f64, "s", And(TIME_S, AFTER_START);
        /// Length of each of the two linear ramps, inside the interval.
        pub ramp_s: f64, "s", Said(HALF_INTERVAL);
        /// Force on the arm, base-plate axes.
        pub force_n: [f64; 3], "N", FORCE_N;
    }
}

impl Push {
    /// Checks point, times and force.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        self.point.validate(arm)?;
        self.check_keys()?;
        let half = length(self.from_s, self.to_s)? / 2.0;
        Range::above(0.0, half)
            .check("ramp_s", self.ramp_s)
            .map(drop)
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
