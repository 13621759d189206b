//! What a level asks for along its directions, and what is left of it where directions get lost.

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

/// What of commands along the directions of a level is left by the limits that they have near
/// where directions are lost, and whether anything was cut. Not direction by direction: where
/// mobilities cross directions turn by a right angle, and a cut would turn with them. Directions that are
/// lost much more than another one do not matter to it.
#[cold]
#[inline(never)]
pub(super) fn cut_together<T: Real>(
    level: &Level<T>,
    directions: &[Direction<T>],
    commands: [T; 3],
) -> ([T; 3], bool) {
    let mut most = [T::ZERO; 3];
    for (most, direction) in most.iter_mut().zip(directions) {
        *most = level.filters.most_command(direction.mobility);
    }
    let (mut cut, mut is_cut) = (commands, false);
    let used = directions.len().min(3);
    for (cut, &own) in cut.iter_mut().zip(&most).take(used) {
        let mut squared = T::ZERO;
        for (&command, &other) in commands.iter().zip(&most).take(used) {
            let nearer = (other / own).least(T::ONE);
            let share = command / other * (nearer * nearer);
            squared += share * share;
        }
        let excess = squared.square_root().most(T::ONE);
        is_cut |= excess > T::ONE;
        *cut /= excess;
    }
    (cut, is_cut)
}
