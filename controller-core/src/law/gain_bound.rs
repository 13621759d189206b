//! Whether a cycle carries the gains of a task.
//!
//! A row that follows ddx = -K_p x - K_d dx, held for a cycle h and acting d cycles late,
//! moves as a double integrator between the cycles:
//!
//! ```text
//! z^d (z - 1)^2 + (h K_d + h^2 K_p / 2) z + h^2 K_p / 2 - h K_d = 0
//! ```
//!
//! It is stable where all z are inside the unit circle: without dead time for h K_d < 2
//! and h K_p < 2 K_d. Both gains enter through h K_d and h^2 K_p alone, so a slower cycle
//! is the same as larger gains and every pair has a longest cycle.

use crate::error::ConfigError;
use crate::joint::in_turn;
use crate::ranges::DEAD_CYCLES_MAX;
use crate::real::Real;
use crate::task::{Axes, TaskGains};

/// Checks the gains of a task on its axes, level `level` (from 1), in a loop with the cycle `cycle_s`
/// \[s\].
///
/// # Errors
/// The pair of K_p and K_d that the cycle is too long for. Diagonal gains are looked at axis
/// by axis; of others bounds of the eigenvalues are paired, which is never too lenient.
pub(crate) fn check(
    gains: &TaskGains,
    axes: Axes,
    level: usize,
    cycle_s: f64,
    dead_cycles: u8,
) -> Result<(), ConfigError> {
    let gains = [&gains.stiffness, &gains.damping];
    let used = axes.flags();
    let used = |i: usize| used.get(i).copied().unwrap_or(false);
    let mut coupled = false;
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        coupled |= used(i) && used(j) && gains.iter().any(|gain| gain[i][j] != 0.0);
    }
    let check = |[stiffness, damping]: [f64; 2]| {
        let bound = longest_cycle(stiffness, damping, dead_cycles);
        if cycle_s < bound {
            return Ok(());
        }
        Err(ConfigError::TaskGains {
            level,
            stiffness,
            damping,
            cycle_s,
            bound,
        })
    };
    if coupled {
        let [[least_kp, most_kp], [least_kd, most_kd]] = gains.map(|gain| extremes(gain, used));
        check([most_kp, least_kd])?;
        check([most_kp, most_kd])?;
        check([least_kp, least_kd])?;
        return check([least_kp, most_kd]);
    }
    for axis in (0..3).filter(|&axis| used(axis)) {
        check(gains.map(|gain| gain[axis][axis]))?;
    }
    Ok(())
}

/// Bounds of the eigenvalues of the block of `gain` on the axes in use, which is positive
/// definite: none is above the Frobenius norm F, so none is below det / F^(m - 1).
fn extremes(gain: &[[f64; 3]; 3], used: impl Fn(usize) -> bool) -> [f64; 2] {
    let (mut squares, mut count) = (0.0, 0);
    let mut block = nalgebra::Matrix3::identity();
    for i in (0..3).filter(|&i| used(i)) {
        count += 1;
        for j in (0..3).filter(|&j| used(j)) {
            block[(i, j)] = gain[i][j];
            squares += gain[i][j] * gain[i][j];
        }
    }
    let most = squares.square_root();
    let least = (1..count).fold(block.determinant(), |least, _| least / most);
    [least, most]
}

/// Coefficients of the polynomial: degree d + 2.
const COEFFICIENTS: usize = DEAD_CYCLES_MAX as usize + 3;

/// The longest cycle \[s\] that carries `stiffness` \[1/s2\] and `damping` \[1/s\], both above
/// 0, with `dead_cycles` cycles of dead time; every shorter one does, too.
#[must_use]
pub fn longest_cycle(stiffness: f64, damping: f64, dead_cycles: u8) -> f64 {
    // Without dead time exact, and an upper end with it.
    let [mut low, mut high] = [0.0, (2.0 / damping).min(2.0 * damping / stiffness)];
    if dead_cycles == 0 {
        return high;
    }
    // To 1e-9 of the upper end.
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if is_stable(stiffness, damping, middle, dead_cycles) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The test of Schur and Cohn: p is stable exactly if |p_0| < |p_n| and
/// (p_n p - p_0 p^*) / z is, p^* with the coefficients in reverse.
fn is_stable(stiffness: f64, damping: f64, cycle_s: f64, dead_cycles: u8) -> bool {
    let (by_rate, by_place) = (cycle_s * damping, 0.5 * cycle_s * cycle_s * stiffness);
    let mut p = [0.0; COEFFICIENTS];
    let mut degree = (usize::from(dead_cycles) + 2).min(COEFFICIENTS - 1);
    p[degree] += 1.0;
    p[degree - 1] -= 2.0;
    p[degree - 2] += 1.0;
    p[1] += by_rate + by_place;
    p[0] += by_place - by_rate;
    while degree > 0 {
        let (Some(&last), Some(&first)) = (p.get(degree), p.first()) else {
            return false;
        };
        let inside = first.magnitude() < last.magnitude();
        if !inside {
            return false;
        }
        let (ratio, before) = (first / last, p);
        for index in in_turn::<COEFFICIENTS>(degree) {
            let of = |index: usize| before.get(index).copied().unwrap_or(0.0);
            p[index] = of(index + 1) - ratio * of(degree - 1 - index);
        }
        degree -= 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the loop itself comes to rest, with its state as it is.
    fn comes_to_rest(stiffness: f64, damping: f64, h: f64, dead_cycles: usize) -> bool {
        let (mut x, mut v) = (1.0, 0.0);
        let (mut way, mut swing) = ([0.0; 16], 0.0);
        for cycle in 0..200_000 {
            way[cycle % 16] = -stiffness * x - damping * v;
            let a = if cycle < dead_cycles {
                0.0
            } else {
                way[(cycle - dead_cycles) % 16]
            };
            x += h * v + 0.5 * h * h * a;
            v += h * a;
            if x.magnitude() > 1e9 {
                return false;
            }
            if cycle > 190_000 {
                swing = x.magnitude().most(swing);
            }
        }
        swing < 0.5
    }

    #[test]
    fn the_bound_is_where_the_loop_itself_becomes_unstable() {
        for dead_cycles in 0..=DEAD_CYCLES_MAX {
            for (stiffness, damping) in [(400.0, 40.0), (1e5, 40.0), (90.0, 300.0), (100.0, 20.0)] {
                let bound = longest_cycle(stiffness, damping, dead_cycles);
                let rests = |share: f64| {
                    comes_to_rest(stiffness, damping, share * bound, dead_cycles.into())
                };
                assert!(rests(0.97), "{stiffness} {damping} {dead_cycles}: {bound}");
                assert!(!rests(1.01), "{stiffness} {damping} {dead_cycles}: {bound}");
            }
        }
    }

    #[test]
    fn without_dead_time_it_is_the_closed_form() {
        for (stiffness, damping) in [(400.0, 40.0), (1e5, 40.0), (90.0, 300.0)] {
            let exact = longest_cycle(stiffness, damping, 0);
            assert!(is_stable(stiffness, damping, 0.999 * exact, 0));
            assert!(!is_stable(stiffness, damping, 1.001 * exact, 0));
        }
    }
}
