//! Random numbers that a seed fixes on every machine: ChaCha8, uniform numbers
//! from 53 bits, Gaussian ones by the Box-Muller transform with functions that
//! do not depend on the platform.

use controller_core::real::Real;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Stream numbers: one seed gives independent numbers for each purpose, so that
/// drawing more of one leaves the others as they were.
pub mod stream {
    /// Wrong masses, inertias and centres of mass.
    pub const MISMATCH: u64 = 1;
    /// Torque noise.
    pub const TORQUE: u64 = 2;
    /// Faults of the link on the way to the client.
    pub const TO_CLIENT: u64 = 3;
    /// Faults of the link on the way to the robot.
    pub const TO_ROBOT: u64 = 4;
    /// Runs of studies.
    pub const STUDY: u64 = 5;
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Rng {
    generator: ChaCha8Rng,
    /// The second number of the last Box-Muller pair.
    spare: Option<f64>,
}

impl Rng {
    /// The stream of number `stream` under `seed`.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        // The key is laid out here rather than by the library's own expansion
        // of an integer, which its next version may change.
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(stream);
        Self {
            generator,
            spare: None,
        }
    }

    /// Uniform on 0 <= u < 1, a multiple of 2^-53.
    pub fn uniform(&mut self) -> f64 {
        const SCALE: f64 = 1.0 / (1u64 << 53) as f64;
        (self.generator.next_u64() >> 11) as f64 * SCALE
    }

    /// +1 or -1 with equal chance.
    pub fn sign(&mut self) -> f64 {
        if self.uniform() < 0.5 { -1.0 } else { 1.0 }
    }

    /// Gaussian with mean 0 and standard deviation 1.
    pub fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // 1 - u is never 0, where the logarithm ends.
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        let (sine, cosine) = (core::f64::consts::TAU * self.uniform()).sine_cosine();
        self.spare = Some(radius * sine);
        radius * cosine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 200_000;

    /// Mean of f over fresh draws.
    fn mean(mut draw: impl FnMut() -> f64) -> f64 {
        (0..COUNT).map(|_| draw()).sum::<f64>() / COUNT as f64
    }

    // Each bound is about four standard errors of the mean it checks.

    #[test]
    fn uniform_moments() {
        let mut rng = Rng::new(7, stream::TORQUE);
        assert!((mean(|| rng.uniform()) - 0.5).abs() < 0.003);
        let square = mean(|| {
            let u = rng.uniform();
            assert!((0.0..1.0).contains(&u));
            u * u
        });
        assert!((square - 1.0 / 3.0).abs() < 0.003);
        assert!(mean(|| rng.sign()).abs() < 0.009);
    }

    #[test]
    fn gaussian_moments() {
        let mut rng = Rng::new(7, stream::TORQUE);
        assert!(mean(|| rng.gaussian()).abs() < 0.009);
        assert!((mean(|| rng.gaussian().powi(2)) - 1.0).abs() < 0.013);
        assert!(mean(|| rng.gaussian().powi(3)).abs() < 0.035);
        assert!((mean(|| rng.gaussian().powi(4)) - 3.0).abs() < 0.09);
        // Neighbours do not know of each other, within a pair or across.
        assert!(mean(|| rng.gaussian() * rng.gaussian()).abs() < 0.009);
        let _ = rng.gaussian();
        assert!(mean(|| rng.gaussian() * rng.gaussian()).abs() < 0.009);
        let tail = mean(|| f64::from(u8::from(rng.gaussian().abs() > 2.0)));
        assert!((tail - 0.0455).abs() < 0.002, "{tail}");
    }

    #[test]
    fn streams_and_seeds_are_independent() {
        let draws = |seed, stream| {
            let mut rng = Rng::new(seed, stream);
            (0..1000).map(|_| rng.gaussian()).collect::<Vec<_>>()
        };
        assert_eq!(draws(1, 1), draws(1, 1));
        let correlation = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
        };
        for (seed, stream) in [(1, 2), (2, 1), (2, 2)] {
            assert!(correlation(&draws(1, 1), &draws(seed, stream)).abs() < 0.13);
        }
    }

    /// The first numbers of a seed are part of the interface: scenarios name
    /// seeds and expect the same run for ever.
    #[test]
    fn the_first_draws_stay() {
        let mut rng = Rng::new(1, stream::TORQUE);
        let draws = [rng.uniform(), rng.uniform(), rng.gaussian(), rng.gaussian()];
        let first = [
            0.3761577612785394,
            0.1098453758323572,
            -0.07595629207949418,
            1.0185812624414312,
        ];
        assert_eq!(draws, first);
    }
}
