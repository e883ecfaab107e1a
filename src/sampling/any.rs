//! A sampler that is chosen at run time.

use super::{PatternSampler, Sampler, SobolSampler};

/// Any of the samplers: for code that is compiled once for all of them, at the price of a branch for each draw.
#[derive(Clone, Debug)]
pub enum AnySampler {
    /// Owen-scrambled Sobol' points.
    Sobol(SobolSampler),
    /// A pattern in the pixel.
    Pattern(PatternSampler),
}

/// Asks whichever sampler there is.
macro_rules! of_sampler {
    ($any:expr, $sampler:ident => $answer:expr) => {
        match $any {
            AnySampler::Sobol($sampler) => $answer,
            AnySampler::Pattern($sampler) => $answer,
        }
    };
}

impl Sampler for AnySampler {
    #[inline]
    fn start(&mut self, pixel: u32, sample: u32) {
        of_sampler!(self, sampler => sampler.start(pixel, sample));
    }

    #[inline]
    fn pixel_2d(&mut self) -> [f32; 2] {
        of_sampler!(self, sampler => sampler.pixel_2d())
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        of_sampler!(self, sampler => sampler.next_2d())
    }

    #[inline]
    fn next_4d(&mut self) -> [f32; 4] {
        of_sampler!(self, sampler => sampler.next_4d())
    }
}
