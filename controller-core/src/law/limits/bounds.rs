//! What acceleration each joint may have now, so that it keeps its range and its speed limit in
//! the cycles to come.
//!
//! With the distance d to an end of the range and the speed v towards it a joint may go at most
//!
//! ```text
//! v_p(d) = k d                                 near the end,       slope v_p' = k
//!          sqrt(2 A (d - d0)),  d0 = A/(2 k^2) beyond 2 d0 of it,  slope v_p' = A/v_p
//! a      <= min(kv (v_p - v) - v_p' v, kv (V - v)),    -alpha <= a <= alpha
//! ```
//!
//! so it brakes with A, and comes to the end exponentially. Both ends bound from their side; where
//! they contradict each other each gives way to the other.

use crate::arm::{ArmModel, JointLimits};
use crate::cells::Cells;
use crate::joint::{DOF, JointState, JointVector, in_turn, zeros};
use crate::real::Real;

/// What the bounds are made from, in the precision of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointBounds<T: Real> {
    /// Ends of the ranges less the margin \[rad\].
    ends: [JointVector<T>; 2],
    /// V \[rad/s\].
    speed: JointVector<T>,
    /// alpha \[rad/s2\].
    acceleration: JointVector<T>,
    /// 1/alpha \[s2/rad\].
    pub(super) inverse_acceleration: JointVector<T>,
    /// A \[rad/s2\].
    braking: JointVector<T>,
    /// kv \[1/s\].
    speed_gain: JointVector<T>,
    /// k \[1/s\].
    position_gain: T,
    /// d0 = A/(2 k^2) \[rad\].
    turn: JointVector<T>,
}

impl<T: Real> JointBounds<T> {
    /// Of no joint: for a law without bounds.
    pub(crate) const fn none() -> Self {
        Self {
            ends: [zeros(); 2],
            speed: zeros(),
            acceleration: zeros(),
            inverse_acceleration: zeros(),
            braking: zeros(),
            speed_gain: zeros(),
            position_gain: T::ZERO,
            turn: zeros(),
        }
    }

    pub(crate) fn new(arm: &ArmModel<T>, limits: &JointLimits) -> Self {
        let k = limits.position_gain;
        let [least, greatest] = arm.position_range();
        let margin = T::from_f64(limits.margin);
        let speed_share = T::from_f64(limits.speed_share);
        let mut bounds = Self::none();
        bounds.position_gain = T::from_f64(k);
        for i in in_turn::<DOF>(DOF) {
            let (alpha, braking) = (limits.acceleration[i], limits.braking[i]);
            bounds.ends[0][i] = least[i] + margin;
            bounds.ends[1][i] = greatest[i] - margin;
            bounds.speed[i] = arm.speed_limit()[i] * speed_share;
            bounds.acceleration[i] = T::from_f64(alpha);
            bounds.inverse_acceleration[i] = T::from_f64(1.0 / alpha);
            bounds.braking[i] = T::from_f64(braking);
            bounds.speed_gain[i] = T::from_f64(limits.speed_gain[i]);
            bounds.turn[i] = T::from_f64(braking / (2.0 * k * k));
        }
        bounds
    }

    /// Its numbers.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        let [low, high] = &mut self.ends;
        cells.numbers("low_end", low.as_mut_slice());
        cells.numbers("high_end", high.as_mut_slice());
        cells.numbers("greatest_speed", self.speed.as_mut_slice());
        cells.numbers("greatest_acceleration", self.acceleration.as_mut_slice());
        cells.numbers(
            "inverse_acceleration",
            self.inverse_acceleration.as_mut_slice(),
        );
        cells.numbers("braking", self.braking.as_mut_slice());
        cells.numbers("speed_gain", self.speed_gain.as_mut_slice());
        cells.numbers("turn", self.turn.as_mut_slice());
        let gain = core::slice::from_mut(&mut self.position_gain);
        cells.numbers("position_gain", gain);
    }

    /// How far a joint at `q` \[rad\] is from the ends of its range less the margin \[rad\]: way
    /// down and way up, negative beyond.
    #[inline(always)]
    pub(super) fn room(&self, joint: usize, q: T) -> [T; 2] {
        let [low, high] = &self.ends;
        [q - low[joint], high[joint] - q]
    }

    /// Largest acceleration \[rad/s2\] of a joint towards an end `distance` \[rad\] away that
    /// it approaches at `speed` \[rad/s\].
    #[inline(always)]
    fn towards(&self, joint: usize, distance: T, speed: T) -> T {
        let (braking, turn) = (self.braking[joint], self.turn[joint]);
        let (gain, near) = (self.speed_gain[joint], self.position_gain);
        let beyond = (braking + braking) * (distance - turn);
        let root = beyond.most(T::from_f64(1e-12)).square_root();
        let linear_below = turn + turn;
        let allowed = distance.choose_below(linear_below, near * distance, root);
        let slope = distance.choose_below(linear_below, near, braking / root);
        let by_range = gain * (allowed - speed) - slope * speed;
        let by_speed = gain * (self.speed[joint] - speed);
        let alpha = self.acceleration[joint];
        by_range.least(by_speed).most(-alpha).least(alpha)
    }
}

/// Bounds of the joint accelerations in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerationBounds<T: Real> {
    /// lo \[rad/s2\].
    pub least: JointVector<T>,
    /// hi \[rad/s2\].
    pub greatest: JointVector<T>,
}

impl<T: Real> AccelerationBounds<T> {
    /// No motion allowed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            least: zeros(),
            greatest: zeros(),
        }
    }

    /// Of arms that move like this.
    #[inline]
    pub(crate) fn update(&mut self, bounds: &JointBounds<T>, joints: &JointState<T>) {
        let [low, high] = &bounds.ends;
        for i in 0..DOF {
            let (q, dq) = (joints.q[i], joints.dq[i]);
            let up = bounds.towards(i, high[i] - q, dq);
            let down = -bounds.towards(i, q - low[i], -dq);
            self.greatest[i] = up.most(down);
            self.least[i] = up.least(down);
        }
    }

    /// Whether `acceleration` \[rad/s2\] is within all bounds.
    #[must_use]
    #[inline]
    pub fn contain(&self, acceleration: &JointVector<T>) -> bool {
        let mut within = true;
        for i in 0..DOF {
            let a = acceleration[i];
            within &= (a >= self.least[i]) & (a <= self.greatest[i]);
        }
        within
    }
}

impl<T: Real> Default for AccelerationBounds<T> {
    fn default() -> Self {
        Self::new()
    }
}
