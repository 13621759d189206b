//! What the levels follow: the wanted motion without its jumps.
//!
//! ```text
//!            a target near the arm, or far: joined           a jump: joined
//!   fresh ------------------------------------> following <---------------+
//!     |                                          |     ^                  |
//!     | Hold: comes to rest                 Hold |     | a target: joined |
//!     +----------------------------------------> holding                  +
//! ```
//!
//! A target jumps where |x_d(k) - x_d(k-1) - h dx_d(k)| is above
//! [`JUMP`](crate::ranges::JUMP), on the axes that the level controls. What is followed then leaves the motion until now, which goes on as it was, for the wanted one: their
//! difference dies out in max([`JOIN_S`](crate::ranges::JOIN_S), distance /
//! [`JOIN_SPEED`](crate::ranges::JOIN_SPEED)) ([`Decay`](super::decay::Decay)), with neither a step
//! of the velocity nor one of the acceleration. Before the first target the motion
//! until now is that of the arm.

mod level;
mod posture;

use super::level::{Level, Levels};
use super::target::{Reference, Target};
use crate::arm::kinematics::Kinematics;
use crate::cells::Cells;
use crate::fault::IndexSet;
use crate::joint::{JointVector, zeros};
use crate::ranges::MAX_LEVELS;
use crate::real::Real;

pub(crate) use self::level::{FollowedLevel, Motion};
use self::level::{Kind, turn};
use self::posture::FollowedPosture;

/// Bit of the posture beside those of the levels in [`Followed::joining`].
const POSTURE_BIT: usize = MAX_LEVELS;

/// What all levels and the posture follow in this cycle, and what they leave.
#[derive(Clone, Debug)]
pub struct Followed<T: Real> {
    levels: [FollowedLevel<T>; MAX_LEVELS],
    posture: FollowedPosture<T>,
    joining: IndexSet,
    /// The next reference is followed whatever jump it is.
    at_once: bool,
}

impl<T: Real> Followed<T> {
    /// Nothing is followed yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            levels: [FollowedLevel::FRESH; MAX_LEVELS],
            posture: FollowedPosture::FRESH,
            joining: IndexSet::NONE,
            at_once: false,
        }
    }

    /// The next reference is followed as it is, whatever jump it is.
    pub(crate) fn follow_at_once(&mut self) {
        self.at_once = true;
    }

    /// The next targets are joined from how the arm moves.
    pub(crate) fn forget_levels(&mut self) {
        self.levels = [FollowedLevel::FRESH; MAX_LEVELS];
    }

    /// What is followed in this cycle, as a reference; of a level that followed nothing yet
    /// [`Target::Hold`].
    pub(crate) fn reference(&self, levels: usize) -> Reference<T> {
        let offset = self.posture_offset().unwrap_or(zeros());
        let mut reference = Reference::hold(levels, self.posture.wanted + offset);
        for (target, followed) in reference.targets_mut().iter_mut().zip(&self.levels) {
            *target = followed.target();
        }
        reference
    }

    /// The reference of a cycle, `interval_s` after the one before; the arm is at `q`. Levels of
    /// `stale` slots hold.
    #[inline]
    pub(crate) fn update(
        &mut self,
        levels: &Levels<T>,
        reference: &Reference<T>,
        stale: IndexSet,
        kinematics: &Kinematics<T>,
        q: &JointVector<T>,
        interval_s: T,
    ) {
        self.joining = IndexSet::NONE;
        for level in levels.in_order() {
            self.follow_target(level, reference, stale, kinematics, interval_s);
        }
        self.follow_posture(&reference.posture, q, interval_s);
    }

    /// The part of [`Followed::update`] that is about one level.
    #[inline(always)]
    pub(crate) fn follow_target(
        &mut self,
        level: &Level<T>,
        reference: &Reference<T>,
        stale: IndexSet,
        kinematics: &Kinematics<T>,
        interval_s: T,
    ) {
        let (slot, at_once) = (level.slot, self.at_once);
        let (Some(followed), Some(target)) =
            (self.levels.get_mut(slot), reference.targets().get(slot))
        else {
            return;
        };
        let target = if stale.contains(slot) {
            &Target::Hold
        } else {
            target
        };
        let goes_on = match target {
            Target::Hold => {
                followed.hold(&level.tracked, kinematics, interval_s, at_once);
                true
            }
            Target::Position { x, dx, ddx } => {
                let way = x - followed.now.position() - dx * interval_s;
                let goes_on = at_once | followed.goes_on(&way, Kind::Position);
                if goes_on {
                    for axis in 0..3 {
                        followed.now.place[axis] = x[axis];
                    }
                    followed.follow(Kind::Position, dx, ddx);
                }
                goes_on
            }
            Target::Orientation { q, w, dw } => {
                let way = turn(q, &followed.now.place) - w * interval_s;
                let goes_on = at_once | followed.goes_on(&way, Kind::Orientation);
                if goes_on {
                    for entry in 0..4 {
                        followed.now.place[entry] = q[entry];
                    }
                    followed.follow(Kind::Orientation, w, dw);
                }
                goes_on
            }
        };
        if !goes_on {
            followed.join(level, target, kinematics, interval_s);
        }
        self.joining.insert_if(slot, followed.decay.lasts());
    }

    /// The part of [`Followed::update`] that is about the posture, behind the levels.
    #[inline(always)]
    pub(crate) fn follow_posture(
        &mut self,
        wanted: &JointVector<T>,
        q: &JointVector<T>,
        interval_s: T,
    ) {
        self.posture.advance(wanted, q, interval_s, self.at_once);
        self.joining.insert_if(POSTURE_BIT, self.posture.joins());
        self.at_once = false;
    }

    /// What the slot of a level remembers.
    pub(crate) fn visit_level(&mut self, level: &Level<T>, cells: &mut impl Cells<T>) {
        if let Some(followed) = self.levels.get_mut(level.slot) {
            followed.visit(&level.tracked, cells);
        }
    }

    /// What is told of all.
    pub(crate) fn visit_joining(&mut self, cells: &mut impl Cells<T>) {
        cells.set("joining", &mut self.joining.0);
    }

    /// What the posture remembers.
    pub(crate) fn visit_posture(&mut self, cells: &mut impl Cells<T>) {
        self.posture.visit(cells);
        cells.flag("at_once", &mut self.at_once);
    }

    /// What the level of a slot follows is forgotten.
    pub(crate) fn forget(&mut self, slot: usize) {
        if let Some(level) = self.levels.get_mut(slot) {
            *level = FollowedLevel::FRESH;
        }
    }

    /// What the levels follow, by slots.
    #[inline(always)]
    pub(crate) fn of_slots(&self) -> &[FollowedLevel<T>; MAX_LEVELS] {
        &self.levels
    }

    /// q_d \[rad\] as wanted.
    #[inline(always)]
    pub(crate) fn posture(&self) -> &JointVector<T> {
        &self.posture.wanted
    }

    /// What is to be added to q_d while it is joined \[rad\].
    #[inline(always)]
    pub(crate) fn posture_offset(&self) -> Option<JointVector<T>> {
        self.posture.joins().then(|| self.posture.offset())
    }

    /// The levels whose reference is not the wanted one yet, and the posture behind
    /// the last of them.
    #[inline(always)]
    pub(crate) fn joining(&self) -> IndexSet {
        self.joining
    }
}

impl<T: Real> Default for Followed<T> {
    fn default() -> Self {
        Self::new()
    }
}
