//! The reflectance of a film in three channels, as a sensor sees it under D65.

use crate::math::DVec3;
use crate::spectrum::{Illuminant, REC_709_FROM_XYZ, Rgb, VISIBLE, color_matching};

/// Number of cosines of a table, at equal distances from 0 to 1.
const COSINES: usize = 1024;

/// Smallest and greatest number of wavelengths of the quadrature. Films of an optical thickness of up to 30 micrometres have as many
/// for each fringe as [`PER_FRINGE`] says; the thickest of the highest index still have more than two.
const WAVELENGTHS: [usize; 2] = [512, 8192];

/// Number of wavelengths for each fringe between the ends of the spectrum. Near grazing incidence, fringes are sharp.
const PER_FRINGE: f64 = 80.0;

/// A reflectance by the cosine of the angle of incidence, linear between 1024 cosines.
///
/// Each channel is the mean of the reflectance over the wavelengths, weighed by the sensor's response to D65 in linear Rec. 709, so that
/// a reflectance of 1 is white. The response is negative at some wavelengths: a mean beyond [0, 1], which a reflectance that is
/// large at one wavelength alone can have, is clamped to it. The
/// error is below 5e-4 (tests beside this), but for films of a lower index than both media next to their own critical angle, where
/// fringes are narrower than a step of the table: there it can be 1e-2.
#[derive(Debug, PartialEq)]
pub struct Observed {
    values: Box<[Rgb]>,
}

impl Observed {
    /// The table of a reflectance by cosine and wavelength \[nm\]. `path`: optical thickness of the film \[nm\].
    pub fn new(path: f64, reflectance: impl Fn(f64, f64) -> f64) -> Self {
        let nodes = nodes(path);
        let value = |i: usize| {
            let cos = i as f64 / (COSINES - 1) as f64;
            let mean: DVec3 = nodes.iter().map(|(nanometres, weight)| *weight * reflectance(cos, *nanometres)).sum();
            Rgb::from_f64(mean.clamp(DVec3::ZERO, DVec3::ONE))
        };
        Self { values: (0..COSINES).map(value).collect() }
    }

    /// The reflectance at a cosine in [0, 1].
    #[inline]
    pub fn at(&self, cos: f32) -> Rgb {
        let place = cos.clamp(0.0, 1.0) * (COSINES - 1) as f32;
        let lower = (place as usize).min(COSINES - 2);
        let between = place - lower as f32;
        self.values[lower] * (1.0 - between) + self.values[lower + 1] * between
    }
}

/// Wavelengths \[nm\] at equal distances of the wave number, in which fringes are, and their weights, which sum to 1 per channel.
pub(super) fn nodes(path: f64) -> Vec<(f64, DVec3)> {
    let [low, high] = VISIBLE.map(|nanometres| 1.0 / nanometres);
    let fringes = 2.0 * path * (low - high);
    let [fewest, most] = WAVELENGTHS;
    let count = ((PER_FRINGE * fringes).min(most as f64).ceil() as usize).clamp(fewest, most);
    let at = |i: usize| {
        let nanometres = 1.0 / (high + (i as f64 + 0.5) / count as f64 * (low - high));
        let seen = *REC_709_FROM_XYZ * color_matching(nanometres) * Illuminant::D65.power(nanometres);
        (nanometres, seen * (nanometres * nanometres))
    };
    let mut nodes: Vec<(f64, DVec3)> = (0..count).map(at).collect();
    let sum: DVec3 = nodes.iter().map(|(_, weight)| *weight).sum();
    nodes.iter_mut().for_each(|(_, weight)| *weight /= sum);
    nodes
}
