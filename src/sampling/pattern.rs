//! Patterns of positions in the pixel, with independent random numbers for everything else.

use std::f32::consts::TAU;

use super::Sampler;
use super::rng::{Rng, hash};

/// Distribution of positions in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Independent and uniform.
    Random,
    /// n x n cells, one uniform position in each.
    Jittered,
    /// The centres of n x n cells.
    Grid,
    /// Normally distributed around the pixel's centre, standard deviation half a pixel. About a third of the positions
    /// along each axis lie outside the pixel.
    Gaussian,
}

/// Samples whose position in the pixel follows a [`Pattern`] and whose other dimensions are independent random numbers.
///
/// Jittered and grid patterns visit their cells in an order that is shuffled for each pixel, so that any number of
/// first samples covers the pixel without preference. Once all n x n cells have been visited they are visited again, in
/// a new order and at new positions.
#[derive(Clone, Debug)]
pub struct PatternSampler {
    pattern: Pattern,
    seed: u64,
    /// Cells along one side of the pixel.
    side: u32,
    position: [f32; 2],
    rng: Rng,
}

impl PatternSampler {
    /// A sampler for `samples` samples per pixel; n is the smallest integer whose square holds them.
    pub fn new(pattern: Pattern, seed: u64, samples: u32) -> Self {
        Self { pattern, seed, side: square_side(samples), position: [0.5; 2], rng: Rng::new(seed, 0) }
    }

    /// Cell of this sample, shuffled within its pass over the pixel.
    #[inline]
    fn cell(&self, pixel_key: u64, sample: u32) -> (u32, u32) {
        // The side is at most 2^16; its square may not fit 32 bits.
        let cells = u64::from(self.side) * u64::from(self.side);
        let pass = u64::from(sample) / cells;
        let cells = u32::try_from(cells).unwrap_or(u32::MAX);
        let cell = permute(sample % cells, cells, hash(pixel_key, pass) as u32);
        (cell % self.side, cell / self.side)
    }
}

/// The smallest n with n x n >= `samples`, at least 1.
pub(crate) fn square_side(samples: u32) -> u32 {
    let root = samples.isqrt();
    if root * root < samples { root + 1 } else { root.max(1) }
}

impl Sampler for PatternSampler {
    #[inline]
    fn start(&mut self, pixel: u32, sample: u32) {
        let pixel_key = hash(self.seed, u64::from(pixel));
        self.rng = Rng::new(pixel_key, u64::from(sample));
        let [u, v] = self.rng.next_2d();
        let side = self.side as f32;
        self.position = match self.pattern {
            Pattern::Random => [u, v],
            Pattern::Jittered => {
                let (x, y) = self.cell(pixel_key, sample);
                [within_cell(x, u, side), within_cell(y, v, side)]
            }
            Pattern::Grid => {
                let (x, y) = self.cell(pixel_key, sample);
                [(x as f32 + 0.5) / side, (y as f32 + 0.5) / side]
            }
            Pattern::Gaussian => {
                let [x, y] = normal_2d([u, v]);
                [0.5 + 0.5 * x, 0.5 + 0.5 * y]
            }
        };
    }

    #[inline]
    fn pixel_2d(&mut self) -> [f32; 2] {
        self.position
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.rng.next_2d()
    }

    #[inline]
    fn next_4d(&mut self) -> [f32; 4] {
        self.rng.next_4d()
    }
}

/// Position `u` in [0, 1) of cell `x` out of `side`, below the next cell's first position: rounding must not carry it
/// there.
#[inline]
fn within_cell(x: u32, u: f32, side: f32) -> f32 {
    let x = x as f32;
    ((x + u) / side).min(((x + 1.0) / side).next_down())
}

/// Two independent standard normal numbers.
///
/// Source: Box and Muller 1958.
#[inline]
fn normal_2d([u, v]: [f32; 2]) -> [f32; 2] {
    // 1 - u is in (0, 1], so the logarithm is finite.
    let radius = (-2.0 * (1.0 - u).ln()).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    [radius * cos, radius * sin]
}

/// Element `i` of a random permutation of 0..`n` (n >= 1), chosen by `key`, in constant memory.
///
/// A bijection of the integers below the next power of two is repeated until it lands in range.
/// Source: Kensler 2013, "Correlated Multi-Jittered Sampling", Sec. 3.
fn permute(mut i: u32, n: u32, key: u32) -> u32 {
    let mask = u32::MAX.checked_shr((n - 1).leading_zeros()).unwrap_or(0);
    loop {
        i ^= key;
        i = i.wrapping_mul(0xe170_893d);
        i ^= key >> 16;
        i ^= (i & mask) >> 4;
        i ^= key >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= key >> 23;
        i ^= (i & mask) >> 1;
        i = i.wrapping_mul(1 | key >> 27);
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & mask) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= mask;
        i ^= i >> 5;
        if i < n {
            break;
        }
    }
    // Rotates without wrapping at 2^32, which would map two numbers to one.
    ((u64::from(i) + u64::from(key)) % u64::from(n)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_are_one_to_one() {
        for n in [1, 2, 3, 4, 25, 64, 1000] {
            // Keys near the end of the range too, where a sum would wrap.
            for key in [0, 1, 0x1234_5678, 0x8000_0000, u32::MAX - 7, u32::MAX] {
                let mut images: Vec<u32> = (0..n).map(|i| permute(i, n, key)).collect();
                images.sort_unstable();
                assert!(images.iter().copied().eq(0..n), "n = {n}, key {key:#x}");
            }
        }
        assert!(permute(u32::MAX - 1, u32::MAX, 7) < u32::MAX);
    }

    #[test]
    fn positions_stay_in_their_cells() {
        for side in [1_u16, 2, 3, 7, 32, 1000, u16::MAX].map(f32::from) {
            for x in [0, 1, side as u32 / 2, side as u32 - 1] {
                let (first, next) = (x as f32 / side, (x + 1) as f32 / side);
                for u in [0.0, 0.5, 1.0_f32.next_down()] {
                    let position = within_cell(x, u, side);
                    assert!(first <= position && position < next, "{u} of cell {x} of {side}: {position}");
                }
            }
        }
    }

    #[test]
    fn the_side_is_the_next_root() {
        let sides = [(0, 1), (1, 1), (2, 2), (4, 2), (5, 3), (9, 3), (10, 4), (u32::MAX, 65_536)];
        for (samples, side) in sides {
            assert_eq!(square_side(samples), side);
        }
    }
}
