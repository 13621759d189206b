//! Plain dense matrices of any shape, for formulas that are to be read rather
//! than to be fast. A vector is a matrix of one column.

use std::ops::{Add, Mul, Neg, Sub};

/// A dense matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl Matrix {
    /// Entry (i, j) is `entry(i, j)`.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let entries = (0..rows * columns)
            .map(|k| entry(k / columns, k % columns))
            .collect();
        Self {
            rows,
            columns,
            entries,
        }
    }

    /// Zeros.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self::from_fn(rows, columns, |_, _| 0.0)
    }

    /// The identity.
    #[must_use]
    pub fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |i, j| f64::from(u8::from(i == j)))
    }

    /// A fixed-size matrix as it is.
    #[must_use]
    pub fn of<const R: usize, const C: usize>(matrix: &nalgebra::SMatrix<f64, R, C>) -> Self {
        Self::from_fn(R, C, |i, j| matrix[(i, j)])
    }

    /// The given rows on top of each other.
    #[must_use]
    pub fn from_rows<const C: usize>(rows: &[nalgebra::SVector<f64, C>]) -> Self {
        Self::from_fn(rows.len(), C, |i, j| rows[i][j])
    }

    /// One column.
    #[must_use]
    pub fn column(values: &[f64]) -> Self {
        Self::from_fn(values.len(), 1, |i, _| values[i])
    }

    /// Matrices of the same width on top of each other.
    #[must_use]
    pub fn stack<'a>(columns: usize, blocks: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut stacked = Self::zeros(0, columns);
        for block in blocks {
            assert_eq!(block.columns, columns);
            stacked.rows += block.rows;
            stacked.entries.extend(&block.entries);
        }
        stacked
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Entry (i, j).
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[i * self.columns + j]
    }

    /// All entries, row by row.
    #[must_use]
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// The columns of the given numbers, in that order.
    #[must_use]
    pub fn selected(&self, columns: &[usize]) -> Self {
        Self::from_fn(self.rows, columns.len(), |i, j| self.at(i, columns[j]))
    }

    /// The transpose.
    #[must_use]
    pub fn t(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i))
    }

    /// Every entry times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| factor * self.at(i, j))
    }

    /// Largest |entry|; 0 of an empty matrix, infinite if one is NaN.
    #[must_use]
    pub fn amax(&self) -> f64 {
        self.entries.iter().fold(0.0, |largest: f64, x| {
            if x.is_nan() {
                f64::INFINITY
            } else {
                largest.max(x.abs())
            }
        })
    }

    /// Inverse and determinant by Gauss-Jordan elimination, the largest entry of
    /// each column as pivot. A singular matrix gives entries that are not finite.
    #[must_use]
    pub fn inverse_and_determinant(&self) -> (Self, f64) {
        assert_eq!(self.rows, self.columns);
        let n = self.rows;
        let (mut left, mut right, mut determinant) = (self.clone(), Self::identity(n), 1.0);
        for k in 0..n {
            let pivot_row = (k..n)
                .max_by(|&a, &b| left.at(a, k).abs().total_cmp(&left.at(b, k).abs()))
                .unwrap_or(k);
            if pivot_row != k {
                determinant = -determinant;
            }
            let pivot = left.at(pivot_row, k);
            determinant *= pivot;
            for matrix in [&mut left, &mut right] {
                for j in 0..n {
                    matrix.entries.swap(k * n + j, pivot_row * n + j);
                    matrix.entries[k * n + j] /= pivot;
                }
            }
            for i in (0..n).filter(|&i| i != k) {
                let factor = left.at(i, k);
                for matrix in [&mut left, &mut right] {
                    for j in 0..n {
                        matrix.entries[i * n + j] -= factor * matrix.entries[k * n + j];
                    }
                }
            }
        }
        (right, determinant)
    }

    /// The inverse.
    #[must_use]
    pub fn inverse(&self) -> Self {
        self.inverse_and_determinant().0
    }

    fn combined(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        assert_eq!(
            (self.rows, self.columns),
            (other.rows, other.columns),
            "shapes"
        );
        Self::from_fn(self.rows, self.columns, |i, j| {
            combine(self.at(i, j), other.at(i, j))
        })
    }
}

impl Mul for &Matrix {
    type Output = Matrix;
    fn mul(self, other: &Matrix) -> Matrix {
        assert_eq!(self.columns, other.rows, "shapes");
        Matrix::from_fn(self.rows, other.columns, |i, j| {
            (0..self.columns)
                .map(|k| self.at(i, k) * other.at(k, j))
                .sum()
        })
    }
}

impl Add for &Matrix {
    type Output = Matrix;
    fn add(self, other: &Matrix) -> Matrix {
        self.combined(other, |a, b| a + b)
    }
}

impl Sub for &Matrix {
    type Output = Matrix;
    fn sub(self, other: &Matrix) -> Matrix {
        self.combined(other, |a, b| a - b)
    }
}

impl Neg for &Matrix {
    type Output = Matrix;
    fn neg(self) -> Matrix {
        self.scaled(-1.0)
    }
}

/// Owned operands, so that formulas read as they are printed.
macro_rules! owned_operators {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator<Matrix> for Matrix {
            type Output = Matrix;
            fn $method(self, other: Matrix) -> Matrix {
                (&self).$method(&other)
            }
        }
        impl $operator<&Matrix> for Matrix {
            type Output = Matrix;
            fn $method(self, other: &Matrix) -> Matrix {
                (&self).$method(other)
            }
        }
        impl $operator<Matrix> for &Matrix {
            type Output = Matrix;
            fn $method(self, other: Matrix) -> Matrix {
                self.$method(&other)
            }
        }
    )*};
}
owned_operators!(Mul mul, Add add, Sub sub);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_undoes_a_matrix_and_its_determinant_has_the_sign_of_the_rows() {
        let a = Matrix::from_fn(3, 3, |i, j| {
            [[0.0, 2.0, 1.0], [1.0, 0.0, 0.0], [3.0, 1.0, 4.0]][i][j]
        });
        let (inverse, determinant) = a.inverse_and_determinant();
        // Expanded by hand along the second row: -1 (2 * 4 - 1 * 1).
        assert!((determinant + 7.0).abs() < 1e-14);
        // Nine products of numbers of order 1.
        assert!((&a * &inverse - Matrix::identity(3)).amax() < 1e-15);
        assert_eq!(Matrix::zeros(0, 0).inverse_and_determinant().1, 1.0);
    }

    #[test]
    fn a_matrix_that_is_not_a_number_has_no_small_norm() {
        assert_eq!(Matrix::column(&[1.0, f64::NAN, 2.0]).amax(), f64::INFINITY);
    }
}
