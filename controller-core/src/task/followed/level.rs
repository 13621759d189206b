//! What one level follows.

use super::super::decay::Decay;
use super::super::level::{Level, LevelPoint};
use super::super::orientation::{self, Quaternion};
use super::super::target::Target;
use crate::arm::kinematics::Kinematics;
use crate::cells::Cells;
use crate::joint::{Vector3, zeros};
use crate::ranges::{HOLD_S, JOIN_S, JOIN_SPEED, JUMP};
use crate::real::Real;

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
pub(super) enum Kind {
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
pub(super) fn turn<T: Real>(to: &Quaternion<T>, from: &Quaternion<T>) -> Vector3<T> {
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
    pub(super) decay: Decay<T>,
}

impl<T: Real> FollowedLevel<T> {
    pub(super) const FRESH: Self = Self {
        phase: Phase::Fresh,
        now: Motion::NOWHERE,
        goal: zeros(),
        decay: Decay::NONE,
    };

    /// What it remembers, of a level that tracks `tracked`.
    pub fn visit(&mut self, tracked: &LevelPoint<T>, cells: &mut impl Cells<T>) {
        let kind = Kind::of(tracked);
        let mut has_begun = self.phase != Phase::Fresh;
        let mut holds = self.phase == Phase::Holding(kind);
        cells.flag("has_begun", &mut has_begun);
        cells.flag("holds", &mut holds);
        self.phase = match (has_begun, holds) {
            (false, _) => Phase::Fresh,
            (true, false) => Phase::Following(kind),
            (true, true) => Phase::Holding(kind),
        };
        cells.numbers("place", self.now.place.as_mut_slice());
        cells.numbers("velocity", self.now.velocity.as_mut_slice());
        cells.numbers("acceleration", self.now.acceleration.as_mut_slice());
        cells.numbers("goal", self.goal.as_mut_slice());
        self.decay.visit(cells);
    }

    /// Whether it holds and rests.
    pub fn rests(&self) -> bool {
        matches!(self.phase, Phase::Holding(_)) && !self.decay.lasts()
    }

    /// Whether a target that is `way` from where the one before leads to is followed without
    /// more ado, whichever axes are controlled.
    #[inline(always)]
    pub(super) fn goes_on(&self, way: &Vector3<T>, kind: Kind) -> bool {
        let allowed = kind.pick(JUMP);
        self.phase == Phase::Following(kind)
            && !self.decay.lasts()
            && way.dot(way) <= T::from_f64(allowed * allowed)
    }

    /// The place is that of the target already.
    #[inline(always)]
    pub(super) fn follow(&mut self, kind: Kind, velocity: &Vector3<T>, acceleration: &Vector3<T>) {
        self.decay.end();
        self.phase = Phase::Following(kind);
        // Number by number: vectors from elsewhere are moved by a call.
        for axis in 0..3 {
            self.now.velocity[axis] = velocity[axis];
            self.now.acceleration[axis] = acceleration[axis];
        }
    }

    /// Leaves the motion until now for the wanted one where that jumps along an axis that the
    /// level controls, or goes on with that.
    #[cold]
    #[inline(never)]
    pub(super) fn join(
        &mut self,
        level: &Level<T>,
        target: &Target<T>,
        kinematics: &Kinematics<T>,
        interval_s: T,
    ) {
        let (tracked, axes) = (&level.tracked, level.axes);
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
        let jump = axes.select(&(kind.way(&place, before) - velocity * since_s));
        let allowed = T::from_f64(kind.pick(JUMP));
        if self.phase == Phase::Holding(kind) || jump.dot(&jump) > allowed * allowed {
            let way = kind.vector(&until_now.place, &place);
            let speed = T::from_f64(kind.pick(JOIN_SPEED));
            let distance = axes.select(&way);
            let duration_s =
                (distance.dot(&distance).square_root() / speed).most(T::from_f64(JOIN_S));
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
    pub(super) fn hold(
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

    /// What is followed in this cycle.
    pub(super) fn target(&self) -> Target<T> {
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
