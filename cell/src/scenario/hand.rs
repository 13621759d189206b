//! A person's hand: a spring and damper along one direction, whose far end
//! moves away and comes back, and which only pushes.

use controller_core::joint::Vector3;
use controller_core::task::trajectory::quintic;
use serde::Deserialize;

use super::arm::EquippedArm;
use super::contact::{AFTER_START, BEFORE_END, HALF_INTERVAL, Interval, length};
use super::point::{POINT, PointSpec};
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Choice, Said};
use crate::keys::keys;
use crate::ranges::{HAND_DAMPING_NS_M, HAND_STIFFNESS_N_M, HAND_TRAVEL_M, Range, TIME_S};

keys! {
    /// F = max(0, k (y0 + travel b((t - from) / approach) b((to - t) / approach) - y) - d dy),
    /// y the point's coordinate along `direction`, y0 its value at the start.
    #[derive(Clone, Debug)]
    pub struct Hand {
        /// Where the hand lies.
        pub point: PointSpec, "", Said(POINT);
        /// Start.
        pub from_s: f64, "s", And(TIME_S, BEFORE_END);
        /// End.
        pub to_s: f64, "s", And(TIME_S, AFTER_START);
        /// Base-plate axis along which it pushes.
        pub direction: Direction, "", Choice;
        /// k of its spring.
        pub stiffness_n_m: f64, "N/m", HAND_STIFFNESS_N_M;
        /// d of its damper.
        pub damping_ns_m: f64, "Ns/m", HAND_DAMPING_NS_M;
        /// How far it moves the point, if that gave no resistance.
        pub travel_m: f64, "m", HAND_TRAVEL_M;
        /// Time to move there, and to go back.
        pub approach_s: f64, "s", Said(HALF_INTERVAL);
    }
}

/// A base-plate axis.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
}

impl Hand {
    /// Checks point, times, spring and damper.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        self.point.validate(arm)?;
        self.check_keys()?;
        let half = length(self.from_s, self.to_s)? / 2.0;
        Range::above(0.0, half)
            .check("approach_s", self.approach_s)
            .map(drop)
    }

    /// When it acts.
    #[must_use]
    pub fn interval(&self) -> Interval {
        Interval {
            from_s: self.from_s,
            to_s: self.to_s,
            ramp_s: self.approach_s,
        }
    }

    /// Coordinate along the direction.
    #[must_use]
    pub fn along(&self, v: &Vector3<f64>) -> f64 {
        v[self.direction as usize]
    }

    /// Size of the force at time `t_s` \[N\], with the point at `x` \[m\], moving with
    /// `dx` \[m/s\], and `origin` its coordinate at the start \[m\].
    #[must_use]
    pub fn size(&self, t_s: f64, origin: f64, x: &Vector3<f64>, dx: &Vector3<f64>) -> f64 {
        if t_s < self.from_s || t_s > self.to_s {
            return 0.0;
        }
        let [there, ..] = quintic((t_s - self.from_s) / self.approach_s);
        let [back, ..] = quintic((self.to_s - t_s) / self.approach_s);
        let stretch = origin + self.travel_m * there * back - self.along(x);
        (self.stiffness_n_m * stretch - self.damping_ns_m * self.along(dx)).max(0.0)
    }

    /// That force as a vector \[N\], base-plate axes.
    #[must_use]
    pub fn vector(&self, size: f64) -> Vector3<f64> {
        let mut force = Vector3::zeros();
        force[self.direction as usize] = size;
        force
    }
}
