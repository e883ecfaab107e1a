//! Stratified sampling of a hemisphere: irradiance, its rotation and translation gradients, and the mean distance to
//! the surfaces that light it.
//!
//! The directions are distributed by the cosine: `rings` rings of equal projected solid angle, each divided into
//! `sectors`. Sector k of ring j holds the polar angles between asin(sqrt(j / M)) and asin(sqrt((j + 1) / M)) and the
//! azimuths between 2 pi k / N and 2 pi (k + 1) / N.
//!
//! Source: Ward and Heckbert 1992, "Irradiance Gradients", Eq. 1 to 4.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::math::{DVec3, Vec3};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};

/// The division of a hemisphere into strata.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strata {
    rings: u32,
    sectors: u32,
}

/// The light that the ray of one stratum finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Radiance [W m^-2 sr^-1].
    pub radiance: Rgb,
    /// Distance to the surface that the ray met, scene units; infinite where it met none.
    pub distance: f32,
}

/// Irradiance and its gradients from all strata, in the frame whose z axis is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Irradiance [W m^-2].
    pub irradiance: Rgb,
    /// Change of irradiance for a rotation about x and about y by one radian (right-handed).
    pub rotation: [Rgb; 2],
    /// Change of irradiance for a step of one scene unit along x and along y.
    pub translation: [Rgb; 2],
    /// Harmonic mean of the distances; infinite where no ray met a surface.
    pub mean_distance: f32,
}

/// Distances that divide differences of radiance are at least this fraction of their harmonic mean. Otherwise a single
/// ray in a corner would dominate the gradient.
const MIN_DISTANCE_RATIO: f64 = 1e-2;

impl Strata {
    /// About as many strata as `rays` (at least 4), chosen so that they are about as high as they are wide: N = pi M.
    pub fn new(rays: u32) -> Self {
        let rays = rays.clamp(4, 1 << 24);
        let rings = ((f64::from(rays) / PI).sqrt().round() as u32).max(1);
        Self { rings, sectors: (rays / rings).max(1) }
    }

    /// Number of strata; number i is sector i mod N of ring i / N.
    pub fn count(&self) -> u32 {
        self.rings * self.sectors
    }

    /// A cosine-distributed direction in stratum `number`: unit, z up. `u` in [0, 1)^2.
    #[inline]
    pub fn direction(&self, number: u32, u: [f32; 2]) -> Vec3 {
        let (j, k) = (number / self.sectors, number % self.sectors);
        let sin2 = (f64::from(j) + f64::from(u[0])) / f64::from(self.rings);
        let azimuth = TAU * (f64::from(k) + f64::from(u[1])) / f64::from(self.sectors);
        let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
        DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos).as_vec3a()
    }

    /// Irradiance and its gradients from one ray for each stratum, in the order of the strata.
    ///
    /// The translation gradient follows from the differences of radiance between neighbouring strata: as the point
    /// moves, their common border moves over the light and dark behind it. The nearer of the two surfaces decides how
    /// fast.
    ///
    /// # Panics
    /// If `rays` are not as many as there are strata.
    pub fn estimate(&self, rays: &[Incident]) -> Estimate {
        assert_eq!(rays.len(), self.count() as usize, "rays and strata");
        let (rings, sectors) = (self.rings as usize, self.sectors as usize);
        let (m, n) = (f64::from(self.rings), f64::from(self.sectors));
        let inverse: f64 = rays.iter().map(|ray| 1.0 / f64::from(ray.distance)).sum();
        let mean_distance = m * n / inverse;
        let min_distance = if mean_distance.is_finite() { MIN_DISTANCE_RATIO * mean_distance } else { 0.0 };
        let at = |j: usize, k: usize| {
            let ray = &rays[j * sectors + k];
            (ray.radiance.to_f64(), f64::from(ray.distance).max(min_distance))
        };
        // `sin_below` is the sine at the border below ring j. `mean_tan` is the mean of the tangent in ring j: its
        // integral over sin^2 in closed form.
        let sin_below = |j: usize| (j as f64 / m).sqrt();
        let integral = |sin: f64| sin.asin() - sin * (1.0 - sin * sin).sqrt();
        let mean_tan = |j: usize| m * (integral(sin_below(j + 1)) - integral(sin_below(j)));
        let mut sum = DVec3::ZERO;
        let (mut rotation, mut translation) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        let add = |to: &mut [DVec3; 2], azimuth: f64, value: DVec3| {
            let (sin, cos) = azimuth.sin_cos();
            to[0] += value * cos;
            to[1] += value * sin;
        };
        for k in 0..sectors {
            let middle = TAU * (k as f64 + 0.5) / n;
            let border = TAU * k as f64 / n;
            let before = (k + sectors - 1) % sectors;
            let mut turned = DVec3::ZERO;
            let mut outward = DVec3::ZERO;
            let mut around = DVec3::ZERO;
            for j in 0..rings {
                let (radiance, distance) = at(j, k);
                sum += radiance;
                turned += mean_tan(j) * radiance;
                if j > 0 {
                    let (inner, inner_distance) = at(j - 1, k);
                    let sin = sin_below(j);
                    let rate = sin * (1.0 - sin * sin) / distance.min(inner_distance);
                    outward += rate * (radiance - inner);
                }
                if sectors > 1 {
                    let (other, other_distance) = at(j, before);
                    let rate = (sin_below(j + 1) - sin_below(j)) / distance.min(other_distance);
                    around += rate * (radiance - other);
                }
            }
            add(&mut rotation, middle + FRAC_PI_2, PI / (m * n) * turned);
            add(&mut translation, middle, TAU / n * outward);
            add(&mut translation, border + FRAC_PI_2, around);
        }
        Estimate {
            irradiance: Rgb::from_f64(PI / (m * n) * sum),
            rotation: rotation.map(Rgb::from_f64),
            translation: translation.map(Rgb::from_f64),
            mean_distance: mean_distance as f32,
        }
    }
}

impl Estimate {
    /// The distance over which the translation gradient, in luminance, changes the irradiance by its own value.
    pub fn doubling_distance(&self) -> f32 {
        let [x, y] = self.translation.map(|v| v.dot(LUMINANCE_WEIGHTS));
        self.irradiance.dot(LUMINANCE_WEIGHTS) / x.hypot(y)
    }
}
