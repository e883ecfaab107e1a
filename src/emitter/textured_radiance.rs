//! The radiance that a texture gives to an emitter.

use std::sync::Arc;

use crate::spectrum::Rgb;
use crate::texture::{Texel, Texture, TextureLight, TexturePoint};

/// The mean that chooses emitters is not below this share of the brightest radiance: what the rule for the mean missed is found all the
/// same.
const LEAST_SHARE: f32 = 1e-3;

/// An emitter has parts where the brightest part has this many times the mean radiance.
pub(super) const CONTRAST: f64 = 1.5;

/// Looking for parts in vain takes this share of the room that they would take, so that the work is bounded.
pub(super) const VAIN_SHARE: usize = 16;

/// Share of the choices of parts that is uniform.
pub(super) const UNIFORM_SHARE: f64 = 0.1;

/// A factor times the colours of a texture, or times one of its numbers.
#[derive(Clone, Debug)]
pub struct TexturedRadiance {
    texture: Arc<Texture>,
    factor: Rgb,
    channel: Option<usize>,
}

impl TexturedRadiance {
    /// The radiance `factor` times the texture. `channel`: the number that all channels take; `None` for one each.
    pub fn new(light: &TextureLight, factor: Rgb, channel: Option<usize>) -> Self {
        Self { texture: Arc::clone(light.texture()), factor, channel }
    }

    /// The radiance `factor` times a texture that is not asked for the light of its parts.
    pub fn of_texture(texture: Arc<Texture>, factor: Rgb, channel: Option<usize>) -> Self {
        Self { texture, factor, channel }
    }

    /// The brightest radiance of all.
    pub(super) fn brightest_at_all(&self) -> Rgb {
        self.colored(self.texture.range()[1])
    }

    /// The texture.
    pub fn texture(&self) -> &Arc<Texture> {
        &self.texture
    }

    /// The radiance at a point.
    pub(super) fn at(&self, at: &TexturePoint) -> Rgb {
        self.colored(self.texture.at(at))
    }

    /// The radiance near a point, as [`TextureLight::near`] gives it.
    pub(super) fn near(&self, at: &TexturePoint, light: &TextureLight, level: usize) -> Rgb {
        self.colored(light.near(at, level))
    }

    /// The brightest radiance within a box of texture coordinates, as [`TextureLight::most_within`] gives it: black only where nothing
    /// in the box shines. Without a box, the brightest of all.
    pub(super) fn brightest(&self, within: Option<[[f32; 2]; 2]>, light: &TextureLight) -> Rgb {
        self.colored(match within {
            Some([low, high]) => light.most_within(low, high),
            None => return self.brightest_at_all(),
        })
    }

    /// The radiance by which an emitter is chosen, from its mean by a rule and its brightest.
    pub(super) fn by_choice(mean: Rgb, brightest: Rgb) -> Rgb {
        mean.max(brightest * LEAST_SHARE)
    }

    fn colored(&self, texel: Texel) -> Rgb {
        let color = match self.channel {
            None => Rgb::new(texel[0], texel[1], texel[2]),
            Some(channel) => Rgb::splat(texel[channel]),
        };
        (self.factor * color).max(Rgb::ZERO)
    }
}
