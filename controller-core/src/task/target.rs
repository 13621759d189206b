//! What the levels should do at one instant.

use super::orientation::Quaternion;
use crate::joint::{JointVector, Vector3, zeros};
use crate::ranges::MAX_LEVELS;
use crate::real::Real;

/// Desired motion of one level, base-plate frame. Axes that the task does not
/// control have no influence, but the bounds of [`crate::ranges`] hold for all three. The variant must fit the task:
/// another one is a fault ([`crate::fault::FaultKind::WrongTarget`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<T: Real> {
    /// For any task: come to rest from what was followed, or without a target before from
    /// how the arm moves, within [`HOLD_S`](crate::ranges::HOLD_S), and stay there.
    Hold,
    /// For a position task.
    Position {
        /// x_d \[m\].
        x: Vector3<T>,
        /// dx_d \[m/s\].
        dx: Vector3<T>,
        /// ddx_d \[m/s2\].
        ddx: Vector3<T>,
    },
    /// For an orientation task.
    Orientation {
        /// Desired orientation (w, x, y, z), norm 0.5 to 2; the sign does not matter.
        q: Quaternion<T>,
        /// Desired angular velocity \[rad/s\].
        w: Vector3<T>,
        /// Desired angular acceleration \[rad/s2\].
        dw: Vector3<T>,
    },
}

impl<T: Real> Target<T> {
    /// Rest at a position \[m\].
    #[must_use]
    pub fn position(x: impl Into<Vector3<T>>) -> Self {
        Self::Position {
            x: x.into(),
            dx: zeros(),
            ddx: zeros(),
        }
    }

    /// Rest in an orientation (w, x, y, z).
    #[must_use]
    pub fn orientation(q: impl Into<Quaternion<T>>) -> Self {
        Self::Orientation {
            q: q.into(),
            w: zeros(),
            dw: zeros(),
        }
    }

    /// The same in another precision.
    #[must_use]
    pub fn cast<U: Real>(&self) -> Target<U> {
        let vector = |v: &Vector3<T>| v.map(|x| U::from_f64(x.to_f64()));
        match self {
            Self::Hold => Target::Hold,
            Self::Position { x, dx, ddx } => Target::Position {
                x: vector(x),
                dx: vector(dx),
                ddx: vector(ddx),
            },
            Self::Orientation { q, w, dw } => Target::Orientation {
                q: q.map(|x| U::from_f64(x.to_f64())),
                w: vector(w),
                dw: vector(dw),
            },
        }
    }
}

/// What the arm should do at one instant: a target per slot, and a posture. Slots are the levels
/// in their first order of priority ([`TaskSet`](crate::task::TaskSet)).
#[derive(Clone, Debug, PartialEq)]
pub struct Reference<T: Real> {
    targets: [Target<T>; MAX_LEVELS],
    count: usize,
    ages_s: [T; MAX_LEVELS],
    /// q_d \[rad\], posture towards which the null space is compliant. With an
    /// integrated posture it counts at the first cycle only.
    pub posture: JointVector<T>,
}

impl<T: Real> Reference<T> {
    /// One target per slot, and q_d \[rad\]. More targets than
    /// [`MAX_LEVELS`] do not compile; a number that is not the controller's is a fault.
    #[must_use]
    pub fn new<const N: usize>(
        targets: [Target<T>; N],
        posture: impl Into<JointVector<T>>,
    ) -> Self {
        const { assert!(N <= MAX_LEVELS, "more targets than a controller has levels") };
        Self::filled(&targets, posture)
    }

    /// The same from a slice; none where it is longer than [`MAX_LEVELS`].
    #[must_use]
    pub fn from_targets(targets: &[Target<T>], posture: impl Into<JointVector<T>>) -> Option<Self> {
        (targets.len() <= MAX_LEVELS).then(|| Self::filled(targets, posture))
    }

    fn filled(targets: &[Target<T>], posture: impl Into<JointVector<T>>) -> Self {
        let mut reference = Self::hold(targets.len(), posture);
        for (place, target) in reference.targets.iter_mut().zip(targets) {
            *place = *target;
        }
        reference
    }

    /// `levels` targets, at most [`MAX_LEVELS`], that hold where they are; q_d \[rad\].
    #[must_use]
    pub fn hold(levels: usize, posture: impl Into<JointVector<T>>) -> Self {
        Self {
            targets: [Target::Hold; MAX_LEVELS],
            count: levels.min(MAX_LEVELS),
            ages_s: [T::ZERO; MAX_LEVELS],
            posture: posture.into(),
        }
    }

    /// How old the target of a slot is \[s\], 0 unless said otherwise; of a slot that there is
    /// not, nothing. What that means the task says ([`Stale`](crate::task::Stale)).
    pub fn set_age(&mut self, slot: usize, age_s: T) {
        if let Some(age) = self.ages_s.get_mut(slot) {
            *age = age_s;
        }
    }

    /// Age of the target of each slot \[s\].
    #[must_use]
    pub fn ages_s(&self) -> &[T; MAX_LEVELS] {
        &self.ages_s
    }

    /// The targets, by slots.
    #[must_use]
    #[inline]
    pub fn targets(&self) -> &[Target<T>] {
        self.targets.get(..self.count).unwrap_or(&[])
    }

    /// The targets, to change them.
    #[must_use]
    pub fn targets_mut(&mut self) -> &mut [Target<T>] {
        self.targets.get_mut(..self.count).unwrap_or(&mut [])
    }
}
