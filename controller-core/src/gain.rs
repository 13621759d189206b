//! Gain matrices as plain data, by rows, and the one check that all of them pass.

use crate::error::{ConfigError, Gain};
use crate::joint::{DOF, in_turn};
use crate::ranges::GAIN_MAX;

/// A diagonal matrix by rows: the usual form of stiffness and damping.
#[must_use]
pub const fn diagonal<const N: usize>(values: [f64; N]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    let mut i = 0;
    while i < N {
        matrix[i][i] = values[i];
        i += 1;
    }
    matrix
}

/// Whether a symmetric gain couples nothing: zeros everywhere off the diagonal. Behind a call: it
/// is in the flash once.
#[inline(never)]
pub(crate) fn is_diagonal(matrix: &[[f64; DOF]; DOF]) -> bool {
    let mut diagonal = true;
    for i in in_turn::<DOF>(DOF) {
        for j in 0..i {
            diagonal &= matrix[i][j] == 0.0;
        }
    }
    diagonal
}

/// Checks that the block of `matrix` on the rows where `used` is true is finite, up to
/// [`GAIN_MAX`], symmetric and positive definite; the rest is not looked at. `level` is
/// 0 for the null space.
///
/// # Errors
/// The first entry, or the first pivot, that is not as it must be.
pub(crate) fn validate<const N: usize>(
    gain: Gain,
    level: usize,
    matrix: &[[f64; N]; N],
    used: [bool; N],
) -> Result<(), ConfigError> {
    const { assert!(N <= DOF, "gains are of joints or of axes") };
    let mut block = Block {
        entries: [[0.0; DOF]; DOF],
        used: [false; DOF],
    };
    for i in 0..N {
        for j in 0..N {
            block.entries[i][j] = matrix[i][j];
        }
        block.used[i] = used[i];
    }
    block.check(gain, level, N)
}

/// Room for the largest gain matrix: one check in the flash for all sizes.
struct Block {
    entries: [[f64; DOF]; DOF],
    used: [bool; DOF],
}

impl Block {
    #[inline(never)]
    fn check(&mut self, gain: Gain, level: usize, size: usize) -> Result<(), ConfigError> {
        let size = size.min(DOF);
        let Self { entries, used } = self;
        let mut scale = 0.0;
        for i in 0..size {
            for j in 0..size {
                if !(used[i] && used[j]) {
                    continue;
                }
                let value = entries[i][j];
                if !(-GAIN_MAX..=GAIN_MAX).contains(&value) {
                    return Err(ConfigError::GainValue { gain, level, value });
                }
                let difference = value - entries[j][i];
                if j < i && difference != 0.0 {
                    return Err(ConfigError::GainSymmetry {
                        gain,
                        level,
                        entry: [i + 1, j + 1],
                        difference,
                    });
                }
                if i == j {
                    scale = f64::max(scale, value.abs());
                }
            }
        }
        // Gaussian elimination: the pivots of a positive definite matrix are positive.
        for k in 0..size {
            if !used[k] {
                continue;
            }
            let above = entries[k];
            let pivot = above[k];
            let definite = pivot > 1e-12 * scale;
            if !definite {
                return Err(ConfigError::GainDefinite {
                    gain,
                    level,
                    index: k + 1,
                    pivot,
                });
            }
            for i in k + 1..size {
                let share = if used[i] { entries[i][k] / pivot } else { 0.0 };
                for j in k + 1..size {
                    entries[i][j] -= share * above[j];
                }
            }
        }
        Ok(())
    }
}
