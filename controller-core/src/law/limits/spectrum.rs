//! The directions in which each level can move the arm, and how easily.
//!
//! ```text
//! A_i  = J_i L^-T                                             whitened rows, M = L L^T
//! Ah_i = A_i - sum over directions k above of p_k (A_i y_k) y_k^T   what the levels above leave
//! S_i  = Ah_i A_i^T = E diag(z) E^T,   y = rows of E^T Ah_i
//! ```
//!
//! z \[1/kg\] is the mobility of a direction: the acceleration along it of a unit force. At a
//! singularity it goes to zero, and 1/z with which the exact law drives it grows without bound.
//! Two filters take the place of 1/z, equal to it above their thresholds: d, with which a
//! direction is driven, and p, with which it is kept from the levels below. Both are multiplied by
//! h, the activation of the level: where it comes or goes the levels below get the rest.

use super::eigen::Eigen;
use crate::cells::Cells;
use crate::fault::IndexSet;
use crate::joint::{DOF, JointVector, zeros};
use crate::linalg::Cholesky;
use crate::ranges::MAX_ROWS;
use crate::real::Real;
use crate::task::level::{Level, Levels};
use crate::task::rows::TaskRows;

/// A direction of a level, and the row of the level in the same place.
#[derive(Clone, Copy, Debug)]
pub struct Direction<T: Real> {
    /// The row of A, J L^-T.
    pub row: JointVector<T>,
    /// y: the direction, of what the levels above leave.
    pub along: JointVector<T>,
    /// p: 1/z, or less where the level is released.
    pub keep: T,
    /// d: 1/z, or less where the level is degraded.
    pub drive: T,
    /// z \[1/kg\], of an orientation \[1/(kg m2)\].
    pub mobility: T,
    /// Its column of E: the direction in the rows of the level.
    pub column: [T; 3],
    /// The row of A along the directions of the levels above.
    pub of_above: [T; MAX_ROWS],
}

impl<T: Real> Direction<T> {
    const NONE: Self = Self {
        row: zeros(),
        along: zeros(),
        keep: T::ZERO,
        drive: T::ZERO,
        mobility: T::ZERO,
        column: [T::ZERO; 3],
        of_above: [T::ZERO; MAX_ROWS],
    };

    /// The part of numbers per row of the level along the direction.
    #[inline(always)]
    pub fn part(&self, rows: &[T; 3]) -> T {
        let ([a, b, c], [x, y, z]) = (&self.column, rows);
        *a * *x + *b * *y + *c * *z
    }

    /// Adds `part` along the direction to numbers per row of the level.
    #[inline(always)]
    pub fn add_part(&self, part: T, rows: &mut [T; 3]) {
        for (row, &entry) in rows.iter_mut().zip(&self.column) {
            *row += entry * part;
        }
    }
}

/// Directions of all levels, as many per level as it has rows. Behind the last one they have
/// no meaning.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum<T: Real> {
    count: usize,
    directions: [Direction<T>; MAX_ROWS],
    /// rho: the square of how far the most released direction is below its threshold, times h; 0
    /// to 1.
    pub release: T,
    /// Slots of levels with a direction that is driven by less than 1/z.
    pub degraded: IndexSet,
    /// Slots of levels in force with a direction of which the levels below get a share.
    pub released: IndexSet,
    /// Whether commands along any direction have a limit, as it is lost or nearly so.
    pub limits_commands: bool,
    /// Whether the levels below get a share of any direction: a level is released, comes or goes.
    pub shares: bool,
}

impl<T: Real> Spectrum<T> {
    /// No directions yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            count: 0,
            directions: [Direction::NONE; MAX_ROWS],
            release: T::ZERO,
            degraded: IndexSet::NONE,
            released: IndexSet::NONE,
            limits_commands: false,
            shares: false,
        }
    }

    /// Level by level. Behind a call: what it reads lies far apart.
    #[inline(never)]
    pub(crate) fn update(
        &mut self,
        levels: &Levels<T>,
        rows: &TaskRows<T>,
        cholesky: &Cholesky<T>,
    ) {
        self.count = rows.count();
        self.release = T::ZERO;
        self.limits_commands = false;
        (self.degraded, self.released) = (IndexSet::NONE, IndexSet::NONE);
        let placed = self.directions.iter_mut().zip(&rows.jacobian);
        for (direction, row) in placed.take(self.count) {
            let row = cholesky.solve_lower(row);
            (direction.row, direction.along) = (row, row);
        }
        for level in levels.in_order() {
            self.split(level);
        }
        self.shares = levels.fades | self.released.any();
    }

    /// The directions of a level, those of the levels above it known.
    #[inline(always)]
    fn split(&mut self, level: &Level<T>) {
        let Some((above, from)) = self.directions.split_at_mut_checked(level.start) else {
            return;
        };
        let Some(own) = from.get_mut(..level.size) else {
            return;
        };
        if !above.is_empty() {
            for direction in &mut *own {
                direction.along = left_by(above, &direction.row, &mut direction.of_above);
            }
        }
        let mut eigen = Eigen::of(&gram(own));
        eigen.solve(level.size);
        turn(own, &eigen);
        let filters = &level.filters;
        let mut least = T::INFINITE;
        for (k, direction) in own.iter_mut().enumerate().take(3) {
            let z = eigen.values[k];
            direction.mobility = z;
            direction.column = eigen.column(k);
            [direction.drive, direction.keep] = filters.of(z);
            least = z.least(least);
        }
        let mut release = filters.release(least);
        if level.activation < T::ONE {
            fade(own, level.activation);
            release *= level.activation;
        }
        self.limits_commands |= filters.nearness(least) < T::ONE;
        let [degraded, released] = filters.lost(least);
        self.degraded.insert_if(level.slot, degraded);
        self.released.insert_if(level.slot, released);
        self.release = self.release.most(release);
    }

    /// What is told of the directions, and by which the next stages go.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.set("degraded", &mut self.degraded.0);
        cells.set("released", &mut self.released.0);
        cells.flag("limits_commands", &mut self.limits_commands);
        cells.flag("shares", &mut self.shares);
    }

    /// How near each direction is to have a limit of its command, at 1; 0 behind the last one.
    #[must_use]
    pub(crate) fn nearness(&self, levels: &Levels<T>) -> [T; MAX_ROWS] {
        let mut nearness = [T::ZERO; MAX_ROWS];
        for level in levels.in_order() {
            let places = nearness.get_mut(level.rows()).unwrap_or(&mut []);
            for (place, direction) in places.iter_mut().zip(self.of(level)) {
                *place = level.filters.nearness(direction.mobility);
            }
        }
        nearness
    }

    /// All directions, level by level.
    #[must_use]
    #[inline(always)]
    pub fn directions(&self) -> &[Direction<T>] {
        self.directions.get(..self.count).unwrap_or(&[])
    }

    /// Those of the levels above a level.
    #[inline(always)]
    pub(super) fn above(&self, level: &Level<T>) -> &[Direction<T>] {
        self.directions.get(..level.start).unwrap_or(&[])
    }

    /// Those of a level: at most three.
    #[inline(always)]
    pub(super) fn of(&self, level: &Level<T>) -> &[Direction<T>] {
        self.directions.get(level.rows()).unwrap_or(&[])
    }
}

/// Of a level that comes or goes.
#[cold]
#[inline(never)]
fn fade<T: Real>(own: &mut [Direction<T>], activation: T) {
    for direction in own {
        direction.drive *= activation;
        direction.keep *= activation;
    }
}

/// x less what directions keep of it: 1 - sum of p y y^T, applied; `along` becomes y^T x of each.
/// Behind a call: it is in the flash once.
#[inline(never)]
pub(super) fn left_by<T: Real>(
    directions: &[Direction<T>],
    x: &JointVector<T>,
    along: &mut [T; MAX_ROWS],
) -> JointVector<T> {
    let used = along.get_mut(..directions.len()).unwrap_or(&mut []);
    let mut left = *x;
    for (direction, along) in directions.iter().zip(&mut *used) {
        *along = direction.along.dot(&left);
    }
    for (direction, along) in directions.iter().zip(used) {
        let kept = direction.keep * *along;
        for i in 0..DOF {
            left[i] -= direction.along[i] * kept;
        }
    }
    left
}

/// S of a level whose directions are still what its rows leave: its diagonal, and its entries
/// off it, each at the place of the row that it has not to do with.
#[inline(always)]
fn gram<T: Real>(own: &[Direction<T>]) -> [[T; 3]; 2] {
    let product = |a: &Direction<T>, b: &Direction<T>| a.along.dot(&b.row);
    let zero = T::ZERO;
    match own {
        [a] => [[product(a, a), zero, zero], [zero; 3]],
        [a, b] => [
            [product(a, a), product(b, b), zero],
            [zero, zero, product(b, a)],
        ],
        [a, b, c] => [
            [product(a, a), product(b, b), product(c, c)],
            [product(c, b), product(c, a), product(b, a)],
        ],
        _ => [[zero; 3]; 2],
    }
}

/// E^T: from what the rows leave to the directions.
#[inline(always)]
fn turn<T: Real>(own: &mut [Direction<T>], eigen: &Eigen<T>) {
    let [p, q, r] = eigen.vectors;
    match own {
        [a, b] => {
            for i in 0..DOF {
                let (x, y) = (a.along[i], b.along[i]);
                a.along[i] = p[0] * x + q[0] * y;
                b.along[i] = p[1] * x + q[1] * y;
            }
        }
        [a, b, c] => {
            for i in 0..DOF {
                let (x, y, z) = (a.along[i], b.along[i], c.along[i]);
                a.along[i] = p[0] * x + q[0] * y + r[0] * z;
                b.along[i] = p[1] * x + q[1] * y + r[1] * z;
                c.along[i] = p[2] * x + q[2] * y + r[2] * z;
            }
        }
        _ => {}
    }
}

impl<T: Real> Default for Spectrum<T> {
    fn default() -> Self {
        Self::new()
    }
}
