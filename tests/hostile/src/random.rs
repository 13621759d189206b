//! Choices that follow from a seed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// A sequence of choices: the same for the same seed and lane.
pub struct Random(ChaCha8Rng);

impl Random {
    /// The sequence of a lane; those of two lanes have nothing in common.
    #[must_use]
    pub fn new(seed: u64, lane: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(lane);
        Self(random)
    }

    /// Any 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0.next_u32()
    }

    /// Any byte.
    pub fn byte(&mut self) -> u8 {
        self.bits().to_le_bytes()[0]
    }

    /// 0 to n - 1; 0 for an n of 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// One of several.
    ///
    /// # Panics
    /// There is none.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// Flips one to eight bits; nothing where there are none.
    pub fn flip(&mut self, bytes: &mut [u8]) {
        if bytes.is_empty() {
            return;
        }
        for _ in 0..=self.below(8) {
            let bit = self.below(8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
    }

    /// Sets one to four bytes, mostly to what is special; nothing where there are none.
    pub fn set(&mut self, bytes: &mut [u8]) {
        if bytes.is_empty() {
            return;
        }
        for _ in 0..=self.below(4) {
            let (at, any) = (self.below(bytes.len()), self.byte());
            bytes[at] = self.pick(&[0x00, 0x01, 0x02, 0x7F, 0x80, 0xFF, any]);
        }
    }

    /// Another length of what is `length` bytes long: nearly the same, or any up to `most`.
    pub fn length(&mut self, length: usize, most: usize) -> usize {
        let near = (length + self.below(9)).saturating_sub(4);
        let any = self.below(most + 1);
        self.pick(&[near, any]).min(most)
    }

    /// Places at which `length` bytes are cut into pieces, in their order, the end among them.
    pub fn cuts(&mut self, length: usize) -> Vec<usize> {
        let mut cuts: Vec<usize> = (0..self.below(6)).map(|_| self.below(length + 1)).collect();
        cuts.push(length);
        cuts.sort_unstable();
        cuts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_and_lane_decide() {
        let sequence = |seed, lane| {
            let mut random = Random::new(seed, lane);
            [(); 4].map(|()| random.bits())
        };
        assert_eq!(sequence(1, 0), sequence(1, 0));
        assert_ne!(sequence(1, 0), sequence(2, 0));
        assert_ne!(sequence(1, 0), sequence(1, 1));
    }

    #[test]
    fn choices_stay_within_what_there_is() {
        let mut random = Random::new(3, 0);
        let mut seen = [0; 5];
        for _ in 0..1000 {
            seen[random.below(5)] += 1;
            assert!(random.length(10, 12) <= 12);
            let cuts = random.cuts(7);
            assert!(cuts.is_sorted() && cuts.last() == Some(&7));
            random.flip(&mut []);
            random.set(&mut []);
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
        assert_eq!(random.below(0), 0);
    }
}
