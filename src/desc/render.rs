//! Render settings: resolution, samples, sampler, filter, integrator and roulette.

use super::integrator::IntegratorDesc;
use super::photon::{CacheDesc, PhotonDesc};
use super::radiosity::RadiosityDesc;

/// Number of pixels of the largest image that is rendered. The film takes about 200 bytes for each pixel.
pub const MAX_PIXELS: u64 = 1 << 26;

/// Greatest number of light samples per hit. More samples cannot be interrupted, and their time is better spent on more
/// samples per pixel.
pub const MAX_SHADOW_RAYS: u32 = 1 << 10;

/// A rectangle of the picture, which is rendered in place of the whole. Its pixels are those of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropDesc {
    /// The first column, from 0.
    pub left: u32,
    /// The first row, from 0 at the top.
    pub top: u32,
    /// Columns, from 1; the last is inside the picture.
    pub width: u32,
    /// Rows, from 1; the last is inside the picture.
    pub height: u32,
}

/// Render settings.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDesc {
    /// Width and height of the picture in pixels, each >= 1.
    pub resolution: [u32; 2],
    /// The part of the picture that is rendered; `None` renders all of it.
    ///
    /// Its pixels are the same to the last bit as in the whole picture, with every integrator: samples depend on where a pixel is in
    /// the picture, and photon maps and irradiance caches are made for all of it. What looks at all pixels that are rendered sees
    /// other pixels, so that adaptive sample counts, target errors and time limits end elsewhere.
    pub crop: Option<CropDesc>,
    /// Samples per pixel, >= 1. Grid and jittered patterns round the number up to the next square.
    pub samples: u32,
    /// The sampler, which places the samples of a pixel.
    pub sampler: SamplerDesc,
    /// The pixel filter, which weighs the samples of a pixel.
    pub filter: FilterDesc,
    /// The light transport algorithm.
    pub integrator: IntegratorDesc,
    /// Whether pixels in groups of 16 share the second hits of their paths, which takes less time to the same error in most scenes and
    /// leaves the picture unbiased. The errors of neighbouring pixels, within squares of 8 x 8, are then correlated.
    ///
    /// They can with [`IntegratorDesc::Path`], in three channels, with the same number of samples for all pixels, in scenes at rest whose
    /// surfaces are opaque and whose media neither absorb nor have priorities. `Some(true)` is refused where they cannot. `None` leaves it
    /// to a pilot where they can and the render is long, also where [`IntegratorDesc::Auto`] chooses paths; in other renders they do not.
    ///
    /// Source: Bekaert, Sbert and Halton 2002, "Accelerating Path Tracing by Re-Using Paths".
    pub reuse: Option<bool>,
    /// Whether light paths, from lamps by way of mirrors and glass to what the camera sees, find caustics beside the paths from the camera.
    /// The picture stays unbiased.
    ///
    /// They can with [`IntegratorDesc::Path`], in three channels, with the same number of samples for all pixels, no
    /// [`max_depth`](RenderDesc::max_depth), a filter that is nowhere negative and reaches 4 pixels at most, a camera in perspective without a lens, in scenes at rest
    /// whose surfaces are opaque, whose media neither absorb nor have priorities and whose textures no footprint filters. `Some(true)` is refused
    /// where they cannot. `None` leaves it to a pilot where they can and the render is long, also where [`IntegratorDesc::Auto`] chooses paths; in other renders
    /// there are none. They start from triangles, spheres and disks that shine evenly; the caustics of other lamps are left to paths from
    /// the camera.
    ///
    /// Source: Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*, Sec. 10.
    pub light_paths: Option<bool>,
    /// Whether [`IntegratorDesc::Auto`] may choose the irradiance cache, whose bias error estimates do not know. A pilot of a long render
    /// then measures its bias, noise and time, and it is taken where the whole error times the time is least. `true` is refused with the
    /// other integrators, which choose nothing.
    pub allow_bias: bool,
    /// Whether paths carry wavelengths instead of three channels. Colours become smooth spectra, lights those times D65, and glass
    /// with a [`Dispersion`](super::Dispersion) disperses light; the film has the colours that the standard observer sees.
    pub spectral: bool,
    /// The chromaticity (CIE 1931 x and y) of the light under which white surfaces are grey in the picture; `None` for that of D65. Light
    /// maps and light at given points have no white.
    pub white_balance: Option<[f64; 2]>,
    /// Greatest number of surface hits on a path, counting the first visible one; `None` sets no limit.
    pub max_depth: Option<u32>,
    /// Light samples per hit, from 1 to [`MAX_SHADOW_RAYS`].
    pub shadow_rays: u32,
    /// Light samples at the hits that the camera sees itself or by way of perfectly specular surfaces alone, from 1 to [`MAX_SHADOW_RAYS`],
    /// with [`IntegratorDesc::Path`]; `Some` is refused with others. `None`: as many as at other hits, or up to eight times as many, where a
    /// pilot says so that is made for [`reuse`](Self::reuse) or [`light_paths`](Self::light_paths).
    pub first_shadow_rays: Option<u32>,
    /// The survival probability by which Russian roulette ends paths.
    pub roulette: RouletteDesc,
    /// Settings of photon maps.
    pub photons: PhotonDesc,
    /// Settings of the irradiance cache.
    pub cache: CacheDesc,
    /// Settings of radiosity.
    pub radiosity: RadiosityDesc,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for RenderDesc {
    fn default() -> Self {
        Self {
            resolution: [256, 256],
            crop: None,
            samples: 64,
            sampler: SamplerDesc::Sobol,
            filter: FilterDesc::Box,
            integrator: IntegratorDesc::Path,
            reuse: None,
            light_paths: None,
            allow_bias: false,
            spectral: false,
            white_balance: None,
            max_depth: None,
            shadow_rays: 1,
            first_shadow_rays: None,
            roulette: RouletteDesc::Own,
            photons: PhotonDesc::default(),
            cache: CacheDesc::default(),
            radiosity: RadiosityDesc::default(),
            seed: 0,
        }
    }
}

impl RenderDesc {
    /// The chromaticity of light for [`Self::white_balance`] by the name of an illuminant of the CIE (A, D50, D55, D65, D75, E, FL1 to FL12)
    /// or a temperature in kelvin: a black body's from 1000 on, and daylight's from 4000 to 25000. `None` for other texts.
    pub fn white_of(light: &str) -> Option<[f64; 2]> {
        super::white_of(light)
    }

    /// Width and height of what is rendered: the crop, or the whole picture.
    pub fn film_size(&self) -> [u32; 2] {
        self.crop.map_or(self.resolution, |crop| [crop.width, crop.height])
    }
}

/// The positions of the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerDesc {
    /// Owen-scrambled Sobol' points, in every dimension.
    #[default]
    Sobol,
    /// Independent random numbers.
    Random,
    /// The pixel is divided into n x n cells, and each cell has one random position.
    Jittered,
    /// The pixel is divided into n x n cells, and the positions are the cell centres.
    Grid,
    /// Positions are normally distributed around the pixel's centre with a standard deviation of half a pixel (the
    /// report's Figure 11). Some positions lie outside the pixel.
    Gaussian,
}

/// A pixel filter. Lengths are in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FilterDesc {
    /// Box filter, one pixel wide.
    #[default]
    Box,
    /// Triangle filter, radius 1.
    Tent,
    /// Gaussian of this standard deviation, truncated at three standard deviations.
    Gaussian {
        /// Standard deviation in pixels, > 0.
        sigma: f32,
    },
    /// Blackman-Harris window, radius 2.
    BlackmanHarris,
    /// Mitchell-Netravali, radius 2.
    Mitchell {
        /// The parameter B.
        b: f32,
        /// The parameter C.
        c: f32,
    },
}

/// The survival probability by which Russian roulette ends paths. The choice changes noise and time, never the expected
/// image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RouletteDesc {
    /// The library's own probability: a path survives in proportion to the throughput that it still carries.
    #[default]
    Own,
    /// The probability that the material states ([`super::MaterialDesc::survival`]), for the first 64 hits of a path. At
    /// materials that state none, the library's own probability is used. A probability below the albedo makes the noise
    /// of bright closed scenes grow without bound.
    File,
}

impl RouletteDesc {
    /// All values.
    pub const ALL: [Self; 2] = [Self::Own, Self::File];

    /// The value's name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::File => "file",
        }
    }
}
