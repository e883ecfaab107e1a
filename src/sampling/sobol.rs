//! Owen-scrambled Sobol' points.

use super::Sampler;
use super::rng::hash;

/// Owen-scrambled Sobol' points in every dimension.
#[derive(Clone, Debug)]
pub struct SobolSampler {
    seed: u64,
    replicate_size: u32,
    index: u32,
    key: u64,
    set: u32,
}

impl SobolSampler {
    /// `replicate_size`: samples of a pixel that share one scramble.
    pub fn new(seed: u64, replicate_size: u32) -> Self {
        Self { seed, replicate_size: replicate_size.max(1), index: 0, key: 0, set: 0 }
    }
}

impl Sampler for SobolSampler {
    #[inline]
    fn start(&mut self, pixel: u32, sample: u32) {
        let replicate = sample / self.replicate_size;
        let index = sample % self.replicate_size;
        self.index = index & 0xffff;
        let block = u64::from(replicate) << 16 | u64::from(index >> 16);
        self.key = hash(hash(self.seed, u64::from(pixel)), block);
        self.set = 0;
    }

    #[inline]
    fn pixel_2d(&mut self) -> [f32; 2] {
        let [a, b, _, _] = sobol_burley::sample_4d(self.index, 0, self.key as u32);
        [a, b]
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        let [a, b, _, _] = self.next_4d();
        [a, b]
    }

    #[inline]
    fn next_4d(&mut self) -> [f32; 4] {
        self.set += 1;
        let (set, block) =
            (self.set % sobol_burley::NUM_DIMENSION_SETS_4D, self.set / sobol_burley::NUM_DIMENSION_SETS_4D);
        sobol_burley::sample_4d(self.index, set, self.key as u32 ^ block)
    }
}
