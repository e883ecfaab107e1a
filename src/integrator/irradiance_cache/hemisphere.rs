//! A hemisphere sampled in strata: irradiance, how it changes as the surface turns and moves, and how far away what
//! lights it is.
//!
//! The directions are those of a cosine: `rings` rings of equal projected solid angle, each cut into `sectors`. Sector k
//! of ring j holds the polar angles between asin(sqrt(j / M)) and asin(sqrt((j + 1) / M)) and the azimuths between
//! 2 pi k / N and 2 pi (k + 1) / N.
//!
//! Source: Ward and Heckbert 1992, "Irradiance Gradients", Eq. 1 to 4.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::math::{DVec3, Vec3};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};

/// How a hemisphere is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strata {
    rings: u32,
    sectors: u32,
}

/// What came back along the ray of one stratum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Radiance [W m^-2 sr^-1].
    pub radiance: Rgb,
    /// Distance to what the ray met, scene units; infinite for nothing.
    pub distance: f32,
}

/// What all strata come to, in the frame whose z axis is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Irradiance [W m^-2].
    pub irradiance: Rgb,
    /// Its change for a rotation about x and about y by one radian (right-handed).
    pub rotation: [Rgb; 2],
    /// Its change for a step of one scene unit along x and along y.
    pub translation: [Rgb; 2],
    /// Harmonic mean of the distances; infinite where nothing was met.
    pub mean_distance: f32,
}

/// Distances are no less than this share of their harmonic mean where they divide differences of radiance: in a
/// corner a single ray would be all the gradient.
const NEAREST: f64 = 1e-2;

impl Strata {
    /// About so many strata (at least 4), about as high as they are wide: N = pi M.
    pub fn new(rays: u32) -> Self {
        let rays = rays.clamp(4, 1 << 24);
        let rings = ((f64::from(rays) / PI).sqrt().round() as u32).max(1);
        Self { rings, sectors: (rays / rings).max(1) }
    }

    /// How many there are; number i is sector i mod N of ring i / N.
    pub fn count(&self) -> u32 {
        self.rings * self.sectors
    }

    /// A direction in stratum `number`, cosine distributed there: unit, z up. `u` in [0, 1)^2.
    #[inline]
    pub fn direction(&self, number: u32, u: [f32; 2]) -> Vec3 {
        let (j, k) = (number / self.sectors, number % self.sectors);
        let sin2 = (f64::from(j) + f64::from(u[0])) / f64::from(self.rings);
        let azimuth = TAU * (f64::from(k) + f64::from(u[1])) / f64::from(self.sectors);
        let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
        DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos).as_vec3a()
    }

    /// Irradiance and its gradients from one ray a stratum, in the order of their numbers.
    ///
    /// The translation gradient takes the differences of radiance between neighbouring strata for the light and dark that
    /// moves across their border as the point moves; the nearer of the two surfaces decides how fast.
    ///
    /// # Panics
    /// If `rays` are not as many as there are strata.
    pub fn estimate(&self, rays: &[Incident]) -> Estimate {
        assert_eq!(rays.len(), self.count() as usize, "rays and strata");
        let (rings, sectors) = (self.rings as usize, self.sectors as usize);
        let (m, n) = (f64::from(self.rings), f64::from(self.sectors));
        let inverse: f64 = rays.iter().map(|ray| 1.0 / f64::from(ray.distance)).sum();
        let mean_distance = m * n / inverse;
        let nearest = if mean_distance.is_finite() { NEAREST * mean_distance } else { 0.0 };
        let at = |j: usize, k: usize| {
            let ray = &rays[j * sectors + k];
            (ray.radiance.to_f64(), f64::from(ray.distance).max(nearest))
        };
        // Of the border below ring j; and the mean of the tangent in ring j, its integral over sin^2 in closed form.
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
    /// The distance over which the translation gradient, in luminance, is as much as the irradiance itself.
    pub fn doubling_distance(&self) -> f32 {
        let [x, y] = self.translation.map(|v| v.dot(LUMINANCE_WEIGHTS));
        self.irradiance.dot(LUMINANCE_WEIGHTS) / x.hypot(y)
    }
}
