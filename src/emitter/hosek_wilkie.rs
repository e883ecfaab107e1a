//! The clear sky of Hosek and Wilkie, and the radiance of the sun through its air.
//!
//! The formula and its tables for linear Rec. 709 are published: Hosek, Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome
//! Radiance"; so is the spectral radiance of the sun: Hosek, Wilkie 2013, "Adding a Solar-Radiance Function to the Hošek-Wilkie Skylight
//! Model". Étendue's own are: the sun's radiance as a table for Rec. 709, by the weights of the sky's, which are linear; a disk of one
//! radiance, without the darkening of its edge; its angular diameter. `scripts/sky_tables.py` makes the tables.

use std::f64::consts::{FRAC_PI_2, PI};

use super::SkyModel;
use super::cie_sky::upper_hemisphere;
use crate::math::{DVec3, Vec3};
use crate::spectrum::Rgb;

/// The numbers of the sky: by channel, albedo 0 and 1, turbidity 1 to 10, control point by elevation, and number.
const SKY: &[[u8; 4]] = include_bytes!("hosek_wilkie/sky.f32").as_chunks().0;

/// The coefficients of the sun's radiance: by turbidity 1 to 10, piece by elevation, channel, and power of the elevation.
const SUN: &[[u8; 4]] = include_bytes!("hosek_wilkie/sun.f32").as_chunks().0;

/// The table is for turbidities from 1 to this.
const TURBIDITIES: usize = 10;

/// Control points of the polynomial in the elevation.
const POINTS: usize = 6;

/// Numbers A to I of the formula, and the radiance that it is a factor on.
const NUMBERS: usize = 10;

/// Pieces by elevation of the sun's radiance, and coefficients of each.
const PIECES: usize = 45;
const COEFFICIENTS: usize = 4;

/// The mean angular diameter of the sun \[degree\].
pub const SUN_DIAMETER_DEG: f64 = 0.533;

/// The lower of two turbidities of the tables, counted from 0, and how far it is from there to the next, in [0, 1].
fn between_turbidities(turbidity: f64) -> (usize, f64) {
    let from_one = turbidity.clamp(1.0, TURBIDITIES as f64) - 1.0;
    let lower = (from_one as usize).min(TURBIDITIES - 2);
    (lower, from_one - lower as f64)
}

/// The elevation of the sun, in [0, pi / 2], as both tables have it: the cube root of its share of the quarter circle.
fn rooted(elevation: f64) -> f64 {
    (elevation.clamp(0.0, FRAC_PI_2) / FRAC_PI_2).cbrt()
}

/// The numbers of one channel for a turbidity, an albedo of the ground in [0, 1] and an elevation of the sun.
fn numbers(channel: usize, turbidity: f64, albedo: f64, elevation: f64) -> [f64; NUMBERS] {
    const BINOMIAL: [f64; POINTS] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let x = rooted(elevation);
    let (lower, beyond) = between_turbidities(turbidity);
    let mut numbers = [0.0; NUMBERS];
    for (ground, of_ground) in [1.0 - albedo, albedo].into_iter().enumerate() {
        for (air, of_air) in [1.0 - beyond, beyond].into_iter().enumerate() {
            let first = ((channel * 2 + ground) * TURBIDITIES + lower + air) * POINTS;
            for (point, factor) in BINOMIAL.into_iter().enumerate() {
                let (up, down) = (point as i32, (POINTS - 1 - point) as i32);
                let weight = of_ground * of_air * factor * x.powi(up) * (1.0 - x).powi(down);
                for (i, number) in numbers.iter_mut().enumerate() {
                    *number += weight * f64::from(f32::from_le_bytes(SKY[(first + point) * NUMBERS + i]));
                }
            }
        }
    }
    numbers
}

/// The mean radiance of the sun's disk [W m^-2 sr^-1] through air of this turbidity, in [1, 10], where the sun stands at this elevation
/// \[rad\] above the horizon, in [0, pi / 2]. A colour outside of Rec. 709, such as the deep red at the horizon, is cut to 0.
pub fn solar_radiance(turbidity: f64, elevation: f64) -> DVec3 {
    let elevation = elevation.clamp(0.0, FRAC_PI_2);
    let piece = ((rooted(elevation) * PIECES as f64) as usize).min(PIECES - 1);
    // A cubic polynomial from where the piece begins.
    let x = elevation - (piece as f64 / PIECES as f64).powi(3) * FRAC_PI_2;
    let (lower, beyond) = between_turbidities(turbidity);
    let at = |air: usize, channel: usize| {
        let first = ((air * PIECES + piece) * 3 + channel) * COEFFICIENTS;
        let coefficients = SUN[first..first + COEFFICIENTS].iter().rev();
        coefficients.fold(0.0, |sum, bytes| sum * x + f64::from(f32::from_le_bytes(*bytes)))
    };
    let channel = |channel| (1.0 - beyond) * at(lower, channel) + beyond * at(lower + 1, channel);
    DVec3::new(channel(0), channel(1), channel(2)).max(DVec3::ZERO)
}

/// The irradiance [W m^-2] of a surface across the light of the sun's disk, for the arguments of [`solar_radiance`].
pub fn solar_irradiance(turbidity: f64, elevation: f64) -> DVec3 {
    let sine = (0.5 * SUN_DIAMETER_DEG.to_radians()).sin();
    PI * sine * sine * solar_radiance(turbidity, elevation)
}

/// A clear sky over a ground of one radiance. The frame has y up.
#[derive(Clone, Debug)]
pub struct HosekWilkieSky {
    channels: [[f64; NUMBERS]; 3],
    /// Unit direction to the sun.
    sun: DVec3,
    /// Factor on the radiance of the model.
    factor: DVec3,
    ground: Rgb,
}

impl HosekWilkieSky {
    /// The sky for a turbidity in [1, 10], over a ground of this albedo, in [0, 1] per channel. `sun`: the unit direction to the sun, in
    /// the frame of the sky, not below its horizon. `factor`: on the radiance of the model. The ground is black until
    /// [`Self::light_ground`].
    pub fn new(turbidity: f64, sun: DVec3, albedo: Rgb, factor: Rgb) -> Self {
        let elevation = sun.y.clamp(0.0, 1.0).asin();
        let albedo = albedo.to_f64().to_array();
        let channels = [0, 1, 2].map(|channel| numbers(channel, turbidity, albedo[channel], elevation));
        Self { channels, sun, factor: factor.to_f64(), ground: Rgb::ZERO }
    }

    /// Lets the ground send back the share `albedo` of its irradiance evenly: by the sky, and `by_sun` [W m^-2].
    pub fn light_ground(&mut self, albedo: Rgb, by_sun: DVec3) {
        // The irradiance takes half a million evaluations.
        if albedo != Rgb::ZERO {
            self.ground = Rgb::from_f64((self.horizontal() + by_sun) / PI * albedo.to_f64());
        }
    }

    /// The irradiance of a horizontal surface [W m^-2], without that of the sun itself.
    pub fn horizontal(&self) -> DVec3 {
        upper_hemisphere(self.sun, |cos_zenith, cos_sun| self.at(cos_zenith, cos_sun))
    }

    /// A radiance [W m^-2 sr^-1] that no direction is above.
    pub fn bound(&self) -> DVec3 {
        let channel = |numbers: [f64; NUMBERS]| {
            let [a, b, c, d, e, f, g, h, i, radiance] = numbers;
            let gradation = 1.0 + a.abs() * (b.max(0.0) / 0.01).exp();
            let mie = 2.0 / (1.0 - i.abs()).abs().powi(3);
            let aureole = c.abs() + d.abs() * (e.max(0.0) * PI).exp() + f.abs() + g.abs() * mie + h.abs();
            radiance.abs() * gradation * aureole
        };
        self.factor * DVec3::from_array(self.channels.map(channel))
    }

    /// The radiance [W m^-2 sr^-1] where `cos_zenith` >= 0 is the cosine of the angle to the zenith and `cos_sun` that of the angle to the
    /// sun (Hosek and Wilkie 2012, equations 8 to 10); not below 0.
    pub fn at(&self, cos_zenith: f64, cos_sun: f64) -> DVec3 {
        let cos_sun = cos_sun.clamp(-1.0, 1.0);
        let gamma = cos_sun.acos();
        let squared = cos_sun * cos_sun;
        let channel = |numbers: [f64; NUMBERS]| {
            let [a, b, c, d, e, f, g, h, i, radiance] = numbers;
            let mie = (1.0 + squared) / (1.0 + i * i - 2.0 * i * cos_sun).powf(1.5);
            let gradation = 1.0 + a * (b / (cos_zenith + 0.01)).exp();
            let aureole = c + d * (e * gamma).exp() + f * squared + g * mie + h * cos_zenith.sqrt();
            (radiance * gradation * aureole).max(0.0)
        };
        self.factor * DVec3::from_array(self.channels.map(channel))
    }
}

impl SkyModel for HosekWilkieSky {
    fn radiance(&self, direction: Vec3) -> Rgb {
        if direction.y <= 0.0 {
            return self.ground;
        }
        let d = direction.as_dvec3();
        Rgb::from_f64(self.at(d.y, d.dot(self.sun)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(elevation_deg: f64) -> DVec3 {
        let (sine, cosine) = elevation_deg.to_radians().sin_cos();
        DVec3::new(cosine, sine, 0.0)
    }

    #[test]
    fn tables_are_whole() {
        assert_eq!(SKY.len(), 3 * 2 * TURBIDITIES * POINTS * NUMBERS);
        assert_eq!(SUN.len(), TURBIDITIES * PIECES * 3 * COEFFICIENTS);
        assert_eq!(between_turbidities(1.0), (0, 0.0));
        assert_eq!(between_turbidities(4.25), (3, 0.25));
        assert_eq!(between_turbidities(10.0), (TURBIDITIES - 2, 1.0));
    }

    /// Over the whole domain light is finite, not negative and within the bound.
    #[test]
    fn skies_hold_over_their_domain() {
        for turbidity in [1.0, 1.5, 2.0, 3.7, 6.2, 9.9, 10.0] {
            for elevation in [0.0, 0.01, 0.5, 2.0, 7.0, 20.0, 45.0, 80.0, 90.0] {
                for albedo in [0.0, 0.5, 1.0] {
                    let sky = HosekWilkieSky::new(turbidity, sun(elevation), Rgb::splat(albedo), Rgb::splat(2.0));
                    let bound = sky.bound();
                    assert!(bound.is_finite() && bound.max_element() < 1e4, "{turbidity} {elevation}: {bound}");
                    for zenith in 0..=45 {
                        for around in 0..=90 {
                            let [z, g] = [zenith, around].map(|it| f64::from(it) * 2_f64.to_radians());
                            let light = sky.at(z.cos().max(0.0), g.cos());
                            assert!(light.is_finite() && light.min_element() >= 0.0, "{turbidity} {elevation}");
                            assert!(light.cmple(bound).all(), "{turbidity} {elevation}: {light} above {bound}");
                        }
                    }
                }
            }
        }
    }

    /// The sun is brighter the higher it stands, without steps between the pieces, and the clearer the air is.
    #[test]
    fn the_sun_is_dimmed_by_the_air_it_is_seen_through() {
        for turbidity in [1.0, 2.5, 6.0, 10.0] {
            let mut before = DVec3::ZERO;
            for step in 0..=9000 {
                let here = solar_radiance(turbidity, (f64::from(step) * 0.01).to_radians());
                let rise = (here - before) / solar_radiance(turbidity, FRAC_PI_2);
                assert!(rise.min_element() > -1e-4, "{turbidity}, {step}: {rise}");
                assert!(step == 0 || rise.max_element() < 6e-3, "{turbidity}, {step}: {rise}");
                before = here;
            }
        }
        let through = |turbidity| solar_radiance(turbidity, 0.7).to_array();
        assert!((0..3).all(|channel| through(2.0)[channel] > through(3.0)[channel]));
        // About 100,000 lx across the sun of a clear day.
        let lux = 683.0 * solar_irradiance(3.0, 40_f64.to_radians()).dot(crate::spectrum::LUMINANCE_WEIGHTS.to_f64());
        assert!((9e4..1.1e5).contains(&lux), "{lux}");
    }

    #[test]
    fn the_ground_sends_back_what_it_gets() {
        let albedo = Rgb::new(0.0, 0.5, 1.0);
        let mut sky = HosekWilkieSky::new(3.0, sun(30.0), albedo, Rgb::ONE);
        assert_eq!(sky.radiance(-Vec3::Y), Rgb::ZERO);
        let by_sun = DVec3::new(1.0, 2.0, 3.0);
        sky.light_ground(albedo, by_sun);
        let exact = Rgb::from_f64((sky.horizontal() + by_sun) * DVec3::new(0.0, 0.5, 1.0) / PI);
        assert_eq!(sky.radiance(Vec3::new(0.6, -0.8, 0.0)), exact);
        assert!(sky.radiance(Vec3::Y).b() > sky.radiance(Vec3::Y).r());
    }
}
