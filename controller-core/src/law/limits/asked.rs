//! What a level asks for along its directions, and how that is cut where levels come and go, or have
//! more rows than there are joints.

use super::spectrum::Direction;
use crate::joint::JointVector;
use crate::real::Real;
use crate::task::level::Level;

/// What a level asks for along a direction.
pub(super) struct Asked<T: Real> {
    /// c \[m/s2\], uncut.
    pub command: T,
    /// p times the residual: what of it the level compensates.
    pub kept: T,
    /// e.
    pub own: T,
}

impl<T: Real> Asked<T> {
    #[inline(always)]
    pub fn of(
        direction: &Direction<T>,
        wanted: &[T; 3],
        damped: &[T; 3],
        residual: &JointVector<T>,
        first: bool,
    ) -> Self {
        let residual = direction.along.dot(residual);
        let kept = direction.keep * residual;
        let own = direction.part(damped);
        // The residual has acted on the rows above, all of it, but what the level compensates does
        // not. Nothing but the residual has acted on those of the first.
        let mut command = direction.part(wanted) + direction.mobility * kept + own;
        if first {
            command -= residual;
        }
        Self { command, kept, own }
    }
}

/// Where mobilities go fast directions turn fast, and a command that is cut direction by direction
/// turns with them: it is cut together with those that may have no more. The forces, and whether
/// they were cut.
#[cold]
#[inline(never)]
pub(super) fn cut_together<T: Real>(
    level: &Level<T>,
    directions: &[Direction<T>],
    asked: impl Fn(&Direction<T>) -> Asked<T>,
) -> ([T; 3], bool) {
    let most = |direction: &Direction<T>| level.filters.most_command(direction.mobility);
    let (mut forces, mut is_cut) = ([T::ZERO; 3], false);
    for (force, direction) in forces.iter_mut().zip(directions) {
        let (of_own, limit) = (asked(direction), most(direction));
        let mut squared = T::ZERO;
        for other in directions.iter().take(3) {
            let share = asked(other).command / most(other).most(limit);
            squared += share * share;
        }
        let excess = squared.square_root().most(T::ONE);
        is_cut |= excess > T::ONE;
        *force = direction.drive * (of_own.command / excess) - direction.keep * of_own.own;
    }
    (forces, is_cut)
}
