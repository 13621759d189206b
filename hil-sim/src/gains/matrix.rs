//! Matrices of any size, and how fast what they stand for grows.

/// A matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

/// Squarings of a spectral radius: a power of 2^30 leaves of a constant of 1e6 1e-8.
const SQUARINGS: u32 = 30;

/// Terms of an exponential whose exponent has a norm below 1/2: the next one is below rounding.
const TERMS: u32 = 14;

impl Matrix {
    /// All zero.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
        }
    }

    /// `value` on the diagonal.
    #[must_use]
    pub fn scalar(size: usize, value: f64) -> Self {
        Self::diagonal(&vec![value; size])
    }

    /// These on the diagonal.
    #[must_use]
    pub fn diagonal(values: &[f64]) -> Self {
        let mut matrix = Self::zeros(values.len(), values.len());
        for (place, value) in values.iter().enumerate() {
            matrix.entries[place * (values.len() + 1)] = *value;
        }
        matrix
    }

    /// Entry by entry.
    #[must_use]
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        Self {
            rows,
            columns,
            entries: places.map(|(row, column)| entry(row, column)).collect(),
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The entry at a place, counted from 0.
    #[must_use]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.columns + column]
    }

    /// Adds `block`, its first entry at (`row`, `column`).
    pub fn add_block(&mut self, row: usize, column: usize, block: &Self) {
        for i in 0..block.rows {
            for j in 0..block.columns {
                self.entries[(row + i) * self.columns + column + j] += block.at(i, j);
            }
        }
    }

    /// Rows `from` to `from + rows`, columns `column` to `column + columns`.
    #[must_use]
    pub fn block(&self, from: usize, column: usize, rows: usize, columns: usize) -> Self {
        Self::from_fn(rows, columns, |i, j| self.at(from + i, column + j))
    }

    /// The product.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::zeros(self.rows, other.columns);
        for row in 0..self.rows {
            for inner in 0..self.columns {
                let factor = self.at(row, inner);
                if factor == 0.0 {
                    continue;
                }
                let to = row * other.columns..(row + 1) * other.columns;
                let from = inner * other.columns..(inner + 1) * other.columns;
                let entries = product.entries[to].iter_mut();
                for (entry, of_other) in entries.zip(&other.entries[from]) {
                    *entry += factor * of_other;
                }
            }
        }
        product
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| {
            self.at(i, j) + other.at(i, j)
        })
    }

    /// Times a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::from_fn(self.rows, self.columns, |i, j| factor * self.at(i, j))
    }

    /// Frobenius norm.
    #[must_use]
    pub fn norm(&self) -> f64 {
        let squares: f64 = self.entries.iter().map(|entry| entry * entry).sum();
        squares.sqrt()
    }

    /// e^A of a square matrix, by its series, halved and squared.
    #[must_use]
    pub fn exponential(&self) -> Self {
        let mut halvings = 0;
        while self.norm() > 0.5 * f64::powi(2.0, halvings) {
            halvings += 1;
        }
        let small = self.scaled(f64::powi(0.5, halvings));
        let mut term = Self::scalar(self.rows, 1.0);
        let mut sum = term.clone();
        for number in 1..=TERMS {
            term = term.times(&small).scaled(1.0 / f64::from(number));
            sum = sum.plus(&term);
        }
        for _ in 0..halvings {
            sum = sum.times(&sum);
        }
        sum
    }

    /// Largest magnitude of the eigenvalues of a square matrix: |A^m|^(1/m) with a large m.
    /// Not a number where an entry is none.
    #[must_use]
    pub fn spectral_radius(&self) -> f64 {
        let (mut power, mut exponent, mut logarithm) = (self.clone(), 1.0, 0.0);
        for _ in 0..=SQUARINGS {
            let norm = power.norm();
            if norm == 0.0 || !norm.is_finite() {
                return norm;
            }
            logarithm += libm::log(norm) / exponent;
            let unit = power.scaled(1.0 / norm);
            power = unit.times(&unit);
            exponent *= 2.0;
        }
        libm::exp(logarithm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_an_exponential_and_its_radius_is_its_growth() {
        for angle in [0.3, 2.0, 20.0] {
            let growth = -0.01;
            let rate = Matrix::from_fn(2, 2, |i, j| match (i, j) {
                (0, 1) => -angle,
                (1, 0) => angle,
                _ => growth,
            });
            let turn = rate.exponential();
            let (sine, cosine) = f64::sin_cos(angle);
            // A few dozen roundings, doubled with every halving.
            assert!((turn.at(0, 0) - growth.exp() * cosine).abs() < 1e-13);
            assert!((turn.at(1, 0) - growth.exp() * sine).abs() < 1e-13);
            // The norm of a turn is sqrt(2), to the power of 2^-30.
            assert!((turn.spectral_radius() / growth.exp() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_radius_of_a_chain_is_that_of_its_links() {
        // Not normal at all: 1e3 off the diagonal, eigenvalues 0.999 and 0.5.
        let chain = Matrix::from_fn(4, 4, |i, j| match (i, j) {
            (i, j) if i == j => [0.999, 0.5, 0.999, 0.5][i],
            (i, j) if i + 1 == j => 1e3,
            _ => 0.0,
        });
        // |A^m| of a pair of equal eigenvalues grows with m: log(m)/m of 2^30.
        assert!((chain.spectral_radius() - 0.999).abs() < 1e-7);
        assert_eq!(Matrix::zeros(3, 3).spectral_radius(), 0.0);
    }
}
