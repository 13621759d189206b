//! Equations of motion with numbers, and their solution by the root-free Cholesky factors
//! M = L D L^T.

use controller_core::joint::{DOF, JointMatrix, JointVector};

/// Entries of a column: a row of M each, and the one of [`BIAS`].
pub(super) const LANES: usize = DOF + 1;

/// Row of C dq + g below M.
pub(super) const BIAS: usize = DOF;

/// M ddq + C dq + g = torque at one posture and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equations {
    /// Columns of M \[kg m2\] from the diagonal down, and C dq + g \[Nm\] below them. What is
    /// above the diagonal means nothing.
    pub(super) columns: [[f64; LANES]; DOF],
}

/// M + diag(armature) = L D L^T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    /// L D, from the diagonal down.
    columns: [[f64; LANES]; DOF],
    /// D^-1.
    inverse: [f64; DOF],
}

impl Equations {
    pub(super) const NONE: Self = Self {
        columns: [[0.0; LANES]; DOF],
    };

    /// M \[kg m2\], rotors included.
    #[must_use]
    pub fn mass_matrix(&self) -> JointMatrix<f64> {
        JointMatrix::from_fn(|i, j| self.columns[i.min(j)][i.max(j)])
    }

    /// C dq + g \[Nm\].
    #[must_use]
    pub fn bias(&self) -> JointVector<f64> {
        JointVector::from_fn(|i, _| self.columns[i][BIAS])
    }

    /// ddq \[rad/s2\] of (M + diag(armature)) ddq = torque - C dq - g for `torque` \[Nm\] and
    /// `armature` \[kg m2\].
    #[must_use]
    pub fn accelerations(
        mut self,
        torque: &JointVector<f64>,
        armature: &JointVector<f64>,
    ) -> JointVector<f64> {
        self.solve_in_place(torque, armature).0
    }

    /// The factor of M + diag(armature), `armature` in kg m2.
    #[must_use]
    pub fn factor(&self, armature: &JointVector<f64>) -> Factor {
        let mut reduced = *self;
        let inverse = reduced.reduce(&JointVector::zeros(), armature);
        Factor::reduced(&reduced, inverse)
    }

    /// As [`Equations::accelerations`], with D^-1. Afterwards the columns are those of L D.
    #[inline(always)]
    pub(super) fn solve_in_place(
        &mut self,
        torque: &JointVector<f64>,
        armature: &JointVector<f64>,
    ) -> (JointVector<f64>, [f64; DOF]) {
        let inverse = self.reduce(torque, armature);
        let right = JointVector::from_fn(|i, _| self.columns[i][BIAS]);
        (substitute(&self.columns, &inverse, right), inverse)
    }

    /// Makes the columns those of L D, with the right side torque - C dq - g reduced likewise,
    /// and gives D^-1.
    #[inline(always)]
    fn reduce(&mut self, torque: &JointVector<f64>, armature: &JointVector<f64>) -> [f64; DOF] {
        for i in 0..DOF {
            let column = &mut self.columns[i];
            column[i] += armature[i];
            column[BIAS] = torque[i] - column[BIAS];
        }
        [
            self.pivot::<0>(),
            self.pivot::<1>(),
            self.pivot::<2>(),
            self.pivot::<3>(),
            self.pivot::<4>(),
            self.pivot::<5>(),
            self.pivot::<6>(),
        ]
    }

    /// Eliminates joint `J` and gives 1 / D of it.
    #[inline(always)]
    fn pivot<const J: usize>(&mut self) -> f64 {
        let pivot = self.columns[J];
        let inverse = 1.0 / pivot[J];
        for k in J + 1..DOF {
            let share = pivot[k] * inverse;
            let column = &mut self.columns[k];
            for pair in k / 2..LANES / 2 {
                column[2 * pair] -= pivot[2 * pair] * share;
                column[2 * pair + 1] -= pivot[2 * pair + 1] * share;
            }
        }
        inverse
    }
}

/// x of D L^T x = right, from L D and D^-1.
#[inline(always)]
fn substitute(
    columns: &[[f64; LANES]; DOF],
    inverse: &[f64; DOF],
    right: JointVector<f64>,
) -> JointVector<f64> {
    let mut x = right;
    for j in (0..DOF).rev() {
        let mut rest = x[j];
        for k in j + 1..DOF {
            rest -= columns[j][k] * x[k];
        }
        x[j] = rest * inverse[j];
    }
    x
}

impl Factor {
    /// From equations whose columns are those of L D already.
    pub(super) fn reduced(equations: &Equations, inverse: [f64; DOF]) -> Self {
        let columns = equations.columns;
        Self { columns, inverse }
    }

    /// (M + diag(armature))^-1 torque \[rad/s2\] for `torque` in Nm.
    #[must_use]
    pub fn solve(&self, torque: &JointVector<f64>) -> JointVector<f64> {
        let mut right = *torque;
        for j in 0..DOF {
            let share = right[j] * self.inverse[j];
            for k in j + 1..DOF {
                right[k] -= self.columns[j][k] * share;
            }
        }
        substitute(&self.columns, &self.inverse, right)
    }

    /// (M + diag(armature))^-1 \[rad/s2 per Nm\].
    #[must_use]
    pub fn inverse(&self) -> JointMatrix<f64> {
        let mut inverse = JointMatrix::identity();
        for j in 0..DOF {
            let unit = inverse.column(j).into_owned();
            inverse.set_column(j, &self.solve(&unit));
        }
        inverse
    }
}
