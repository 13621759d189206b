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
//! A target jumps where |x_d(k) - x_d(k-1) - h dx_d(k)| is above [`JUMP`]. What is followed
//! then leaves the motion until now, which goes on as it was, for the wanted one: their
//! difference dies out in max([`JOIN_S`], distance / [`JOIN_SPEED`]) ([`Decay`]), with neither
//! a step of the velocity nor one of the acceleration. Before the first target the motion
//! until now is that of the arm.

use super::decay::Decay;
use super::level::{LevelPoint, Levels};
use super::orientation::{self, Quaternion};
use super::target::{Reference, Target};
use super::trajectory::quintic;
use crate::arm::kinematics::Kinematics;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, Vector3, zeros};
use crate::ranges::{HOLD_S, JOIN_S, JOIN_SPEED, JUMP, MAX_LEVELS, POSTURE_JUMP};
use crate::real::Real;

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

    /// The reference of a cycle, `interval_s` after the one before; the arm is at `q`.
    #[inline]
    pub(crate) fn update(
        &mut self,
        levels: &Levels<T>,
        reference: &Reference<T>,
        kinematics: &Kinematics<T>,
        q: &JointVector<T>,
        interval_s: T,
    ) {
        let (targets, at_once) = (reference.targets(), self.at_once);
        let mut joining = IndexSet::NONE;
        let all = self.levels.iter_mut().zip(levels.as_slice()).zip(targets);
        for (index, ((followed, level), target)) in all.enumerate() {
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
                        followed.now.place = *q;
                        followed.follow(Kind::Orientation, w, dw);
                    }
                    goes_on
                }
            };
            if !goes_on {
                followed.join(&level.tracked, target, kinematics, interval_s);
            }
            joining.insert_if(index, followed.decay.lasts());
        }
        self.posture
            .advance(&reference.posture, q, interval_s, at_once);
        joining.insert_if(POSTURE_BIT, self.posture.duration_s > T::ZERO);
        self.joining = joining;
        self.at_once = false;
    }

    /// What the levels follow, highest priority first.
    #[inline(always)]
    pub(crate) fn levels(&self) -> &[FollowedLevel<T>; MAX_LEVELS] {
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
        let joining = self.posture.duration_s > T::ZERO;
        joining.then(|| self.posture.offset())
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

/// Place, velocity and acceleration of a level. Of a position the place is (x, y, z, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion<T: Real> {
    pub place: Quaternion<T>,
    pub velocity: Vector3<T>,
    pub acceleration: Vector3<T>,
}

impl<T: Real> Motion<T> {
    const NOWHERE: Self = Self {
        place: zeros(),
        velocity: zeros(),
        acceleration: zeros(),
    };

    /// Of a target; nowhere of one that holds.
    fn of(target: &Target<T>) -> Self {
        let (place, velocity, acceleration) = match target {
            Target::Position { x, dx, ddx } => {
                (Quaternion::from([x.x, x.y, x.z, T::ZERO]), dx, ddx)
            }
            Target::Orientation { q, w, dw } => (*q, w, dw),
            Target::Hold => return Self::NOWHERE,
        };
        Self {
            place,
            velocity: *velocity,
            acceleration: *acceleration,
        }
    }

    /// The place as a position \[m\].
    #[inline(always)]
    pub fn position(&self) -> Vector3<T> {
        Vector3::from([self.place[0], self.place[1], self.place[2]])
    }
}

/// What a level is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing yet.
    Fresh,
    /// It follows a target of this kind.
    Following(Kind),
    /// It came to rest, or does.
    Holding(Kind),
}

/// What a place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Position,
    Orientation,
}

impl Kind {
    fn of<T: Real>(tracked: &LevelPoint<T>) -> Self {
        match tracked {
            LevelPoint::Position(..) => Self::Position,
            LevelPoint::Orientation(..) => Self::Orientation,
        }
    }

    /// The first for positions, the second for orientations.
    #[inline(always)]
    fn pick(self, [position, orientation]: [f64; 2]) -> f64 {
        match self {
            Self::Position => position,
            Self::Orientation => orientation,
        }
    }

    /// From a place to another: position \[m\] or chord.
    fn way<T: Real>(self, to: &Quaternion<T>, from: &Quaternion<T>) -> Vector3<T> {
        match self {
            Self::Position => Vector3::from([to[0] - from[0], to[1] - from[1], to[2] - from[2]]),
            Self::Orientation => turn(to, from),
        }
    }

    /// The same with the rotation vector \[rad\] of the chord.
    fn vector<T: Real>(self, to: &Quaternion<T>, from: &Quaternion<T>) -> Vector3<T> {
        let way = self.way(to, from);
        match self {
            Self::Position => way,
            Self::Orientation => orientation::rotation_vector(&way.map(T::to_f64)).map(T::from_f64),
        }
    }

    /// A place moved by a position \[m\], or turned by a rotation vector \[rad\].
    fn displaced<T: Real>(self, place: &Quaternion<T>, by: &Vector3<T>) -> Quaternion<T> {
        match self {
            Self::Position => place + Quaternion::from([by.x, by.y, by.z, T::ZERO]),
            Self::Orientation => orientation::turned(place, by),
        }
    }
}

/// The chord from an orientation to another, both of any length.
#[inline(never)]
fn turn<T: Real>(to: &Quaternion<T>, from: &Quaternion<T>) -> Vector3<T> {
    orientation::chord(to, &orientation::unit(from))
}

/// One level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FollowedLevel<T: Real> {
    phase: Phase,
    /// What is followed now.
    pub now: Motion<T>,
    /// Where it is wanted or will rest, while there is a difference.
    goal: Quaternion<T>,
    /// What is followed less what is wanted; of an orientation a rotation vector.
    decay: Decay<T>,
}

impl<T: Real> FollowedLevel<T> {
    const FRESH: Self = Self {
        phase: Phase::Fresh,
        now: Motion::NOWHERE,
        goal: zeros(),
        decay: Decay::NONE,
    };

    /// Whether a target that is `way` from where the one before leads to is followed without
    /// more ado.
    #[inline(always)]
    fn goes_on(&self, way: &Vector3<T>, kind: Kind) -> bool {
        let allowed = kind.pick(JUMP);
        self.phase == Phase::Following(kind)
            && !self.decay.lasts()
            && way.dot(way) <= T::from_f64(allowed * allowed)
    }

    /// The place is that of the target already.
    #[inline(always)]
    fn follow(&mut self, kind: Kind, velocity: &Vector3<T>, acceleration: &Vector3<T>) {
        self.decay.end();
        self.phase = Phase::Following(kind);
        self.now.velocity = *velocity;
        self.now.acceleration = *acceleration;
    }

    /// Leaves the motion until now for the wanted one, or goes on with that.
    #[cold]
    #[inline(never)]
    fn join(
        &mut self,
        tracked: &LevelPoint<T>,
        target: &Target<T>,
        kinematics: &Kinematics<T>,
        interval_s: T,
    ) {
        let kind = Kind::of(tracked);
        let Motion {
            place,
            velocity,
            acceleration,
        } = Motion::of(target);
        let until_now = self.until_now(tracked, kinematics, interval_s);
        let (before, since_s) = match self.phase {
            Phase::Following(same) if same == kind && self.decay.lasts() => {
                (&self.goal, interval_s)
            }
            Phase::Following(same) if same == kind => (&self.now.place, interval_s),
            _ => (&until_now.place, T::ZERO),
        };
        let jump = kind.way(&place, before) - velocity * since_s;
        let allowed = T::from_f64(kind.pick(JUMP));
        if self.phase == Phase::Holding(kind) || jump.dot(&jump) > allowed * allowed {
            let way = kind.vector(&until_now.place, &place);
            let speed = T::from_f64(kind.pick(JOIN_SPEED));
            let duration_s = (way.dot(&way).square_root() / speed).larger(T::from_f64(JOIN_S));
            let start = [
                way,
                until_now.velocity - velocity,
                until_now.acceleration - acceleration,
            ];
            self.decay = Decay::new(start, duration_s);
        } else {
            self.decay.advance(interval_s);
        }
        self.phase = Phase::Following(kind);
        self.goal = place;
        self.leave(kind, &velocity, &acceleration);
    }

    /// The level comes to rest from the motion until now, or rests; at once where it is.
    #[cold]
    #[inline(never)]
    fn hold(
        &mut self,
        tracked: &LevelPoint<T>,
        kinematics: &Kinematics<T>,
        interval_s: T,
        at_once: bool,
    ) {
        let kind = Kind::of(tracked);
        if self.phase == Phase::Holding(kind) {
            if self.decay.lasts() {
                self.decay.advance(interval_s);
                self.leave(kind, &zeros(), &zeros());
            }
            return;
        }
        if at_once {
            self.decay.end();
            self.goal = Motion::of(&tracked.target(kinematics)).place;
        } else {
            let Motion {
                place,
                velocity,
                acceleration,
            } = self.until_now(tracked, kinematics, interval_s);
            let time = T::from_f64(HOLD_S);
            // So far its velocity falls without turning, on the polynomial of least degree.
            let way =
                velocity * (T::HALF * time) + acceleration * (time * time / T::from_f64(12.0));
            self.decay = Decay::new([-way, velocity, acceleration], time);
            self.goal = kind.displaced(&place, &way);
        }
        self.phase = Phase::Holding(kind);
        self.leave(kind, &zeros(), &zeros());
    }

    /// What is followed: the goal, its velocity and acceleration, and the difference to them.
    fn leave(&mut self, kind: Kind, velocity: &Vector3<T>, acceleration: &Vector3<T>) {
        self.now = if self.decay.lasts() {
            let [e, de, dde] = self.decay.now();
            Motion {
                place: kind.displaced(&self.goal, &e),
                velocity: velocity + de,
                acceleration: acceleration + dde,
            }
        } else {
            Motion {
                place: self.goal,
                velocity: *velocity,
                acceleration: *acceleration,
            }
        };
    }

    /// The motion until now, where it would be now; that of the arm where there was none of
    /// this kind.
    fn until_now(
        &self,
        tracked: &LevelPoint<T>,
        kinematics: &Kinematics<T>,
        interval_s: T,
    ) -> Motion<T> {
        let kind = Kind::of(tracked);
        if ![Phase::Following(kind), Phase::Holding(kind)].contains(&self.phase) {
            return Motion::of(&tracked.target(kinematics));
        }
        let last = &self.now;
        let way =
            last.velocity * interval_s + last.acceleration * (T::HALF * interval_s * interval_s);
        Motion {
            place: kind.displaced(&last.place, &way),
            velocity: last.velocity + last.acceleration * interval_s,
            acceleration: last.acceleration,
        }
    }

    fn target(&self) -> Target<T> {
        let Motion {
            place,
            velocity,
            acceleration,
        } = self.now;
        match self.phase {
            Phase::Fresh => Target::Hold,
            Phase::Following(Kind::Position) | Phase::Holding(Kind::Position) => Target::Position {
                x: self.now.position(),
                dx: velocity,
                ddx: acceleration,
            },
            Phase::Following(Kind::Orientation) | Phase::Holding(Kind::Orientation) => {
                Target::Orientation {
                    q: place,
                    w: velocity,
                    dw: acceleration,
                }
            }
        }
    }
}

/// The posture. It has no velocity: its difference leaves at rest, on b of [`quintic`].
#[derive(Clone, Copy, Debug)]
struct FollowedPosture<T: Real> {
    known: bool,
    wanted: JointVector<T>,
    /// What was followed less what is wanted, where it jumped \[rad\].
    from: JointVector<T>,
    elapsed_s: T,
    /// 0 where nothing is joined.
    duration_s: T,
}

impl<T: Real> FollowedPosture<T> {
    const FRESH: Self = Self {
        known: false,
        wanted: zeros(),
        from: zeros(),
        elapsed_s: T::ZERO,
        duration_s: T::ZERO,
    };

    #[inline(always)]
    fn advance(
        &mut self,
        wanted: &JointVector<T>,
        q: &JointVector<T>,
        interval_s: T,
        at_once: bool,
    ) {
        let before = if self.known { &self.wanted } else { q };
        let allowed = T::from_f64(POSTURE_JUMP);
        let mut jumps = false;
        for i in 0..DOF {
            jumps |= (wanted[i] - before[i]).magnitude() > allowed;
        }
        if at_once {
            self.duration_s = T::ZERO;
        } else if jumps {
            let before = *before;
            self.join(wanted, &before);
        } else {
            self.elapsed_s += interval_s;
            if self.elapsed_s >= self.duration_s {
                self.duration_s = T::ZERO;
            }
        }
        self.wanted = *wanted;
        self.known = true;
    }

    #[cold]
    #[inline(never)]
    fn join(&mut self, wanted: &JointVector<T>, before: &JointVector<T>) {
        self.from = before - wanted + self.offset();
        let mut largest = T::ZERO;
        for value in &self.from {
            largest = largest.larger(value.magnitude());
        }
        let [_, speed] = JOIN_SPEED.map(T::from_f64);
        self.duration_s = (largest / speed).larger(T::from_f64(JOIN_S));
        self.elapsed_s = T::ZERO;
    }

    #[cold]
    #[inline(never)]
    fn offset(&self) -> JointVector<T> {
        if self.duration_s > T::ZERO {
            let [share, ..] = quintic(self.elapsed_s / self.duration_s);
            self.from * (T::ONE - share)
        } else {
            zeros()
        }
    }
}
