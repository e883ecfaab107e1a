//! Skies whose luminance is given by a formula of the angles to the zenith and to the sun.
//!
//! Sources: CIE S 011/E:2003 (ISO 15469:2004), "Spatial Distribution of Daylight - CIE Standard General Sky"; Perez, Seals, Michalsky
//! 1993, "All-Weather Model for Sky Luminance Distribution".

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{AddAssign, Mul};

use super::SkyModel;
use crate::math::{DVec3, Vec3};
use crate::spectrum::Rgb;

/// The relative luminance of a sky: (1 + a exp(b / cos Z)) times (1 + c (exp(d chi) - exp(d pi / 2)) + e cos^2 chi), Z being the angle
/// to the zenith and chi that to the sun. Perez and others have no term exp(d pi / 2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyFormula {
    /// The numbers a, b, c, d and e.
    pub numbers: [f64; 5],
    /// Whether the term exp(d pi / 2) is there.
    pub is_cie: bool,
}

/// a to e of the 15 types of the CIE's general sky.
const CIE_TYPES: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.0],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.0],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.0, 0.0, -1.0, 0.0],
    [0.0, -1.0, 2.0, -1.5, 0.15],
    [0.0, -1.0, 5.0, -2.5, 0.30],
    [0.0, -1.0, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

impl SkyFormula {
    /// The sky of a CIE type, 1 to 15: 1 is the overcast sky, 5 is even, 12 is the clear sky.
    pub fn cie(number: u32) -> Option<Self> {
        let numbers = *CIE_TYPES.get((number as usize).checked_sub(1)?)?;
        Some(Self { numbers, is_cie: true })
    }

    /// Which CIE type it is.
    pub fn cie_number(&self) -> Option<u32> {
        let found = CIE_TYPES.iter().position(|numbers| self.is_cie && *numbers == self.numbers)?;
        Some(found as u32 + 1)
    }

    /// Whether the sun's place matters.
    pub fn asks_sun(&self) -> bool {
        self.numbers[2] != 0.0 || self.numbers[4] != 0.0
    }

    /// A number that the relative luminance is nowhere above, for b <= 0.
    fn bound(&self) -> f64 {
        let [a, _, c, d, e] = self.numbers;
        (1.0 + a.abs()) * (1.0 + c.abs() * (1.0 + (d * PI).exp()) + e.abs())
    }

    /// The relative luminance where `cos_zenith` > 0 is the cosine of the angle to the zenith and `cos_sun` that of the angle to the
    /// sun; not below 0.
    pub fn at(&self, cos_zenith: f64, cos_sun: f64) -> f64 {
        let [a, b, c, d, e] = self.numbers;
        let chi = cos_sun.clamp(-1.0, 1.0).acos();
        let beyond = if self.is_cie { (d * FRAC_PI_2).exp() } else { 0.0 };
        let gradation = 1.0 + a * (b / cos_zenith).exp();
        let indicatrix = 1.0 + c * ((d * chi).exp() - beyond) + e * cos_sun * cos_sun;
        (gradation * indicatrix).max(0.0)
    }
}

/// A sky by a formula over a ground of one radiance. The frame has y up.
#[derive(Clone, Debug)]
pub struct FormulaSky {
    formula: SkyFormula,
    /// Unit direction to the sun.
    sun: DVec3,
    /// Radiance of a relative luminance of 1.
    scale: DVec3,
    ground: Rgb,
}

impl FormulaSky {
    /// A sky whose radiance at the zenith [W m^-2 sr^-1], or whose irradiance of a horizontal surface [W m^-2] if `is_horizontal`, is
    /// `radiance`, over a ground that sends back the share `albedo` of that irradiance evenly. `sun`: the unit direction to the sun, in
    /// the frame of the sky. `None` for a formula that is 0 there, and for light that may be beyond single precision.
    pub fn new(formula: SkyFormula, sun: DVec3, radiance: Rgb, is_horizontal: bool, albedo: Rgb) -> Option<Self> {
        // The irradiance takes half a million evaluations.
        let is_asked = is_horizontal || albedo != Rgb::ZERO;
        let horizontal = if is_asked { horizontal(&formula, sun) } else { 0.0 };
        let whole = if is_horizontal { horizontal } else { formula.at(1.0, sun.y) };
        let scale = radiance.to_f64() / whole;
        let ground = Rgb::from_f64(scale * horizontal / PI * albedo.to_f64());
        let brightest = Rgb::from_f64(scale * formula.bound());
        let holds = whole > 0.0 && scale.is_finite() && brightest.is_finite() && ground.is_finite();
        holds.then_some(Self { formula, sun, scale, ground })
    }

    /// The irradiance of a horizontal surface [W m^-2], without that of the sun itself.
    pub fn horizontal(&self) -> DVec3 {
        self.scale * horizontal(&self.formula, self.sun)
    }
}

impl SkyModel for FormulaSky {
    fn radiance(&self, direction: Vec3) -> Rgb {
        if direction.y <= 0.0 {
            return self.ground;
        }
        let d = direction.as_dvec3();
        Rgb::from_f64(self.scale * self.formula.at(d.y, d.dot(self.sun)))
    }
}

/// The irradiance of a horizontal surface by the relative luminance.
fn horizontal(formula: &SkyFormula, sun: DVec3) -> f64 {
    upper_hemisphere(sun, |cos_zenith, cos_sun| formula.at(cos_zenith, cos_sun))
}

/// The irradiance of a horizontal surface by a radiance that the cosines of the angles to the zenith and to the sun say, by midpoints: the
/// error is about 10^-6 of it. `sun`: a unit direction in a frame with y up.
pub(super) fn upper_hemisphere<T>(sun: DVec3, radiance: impl Fn(f64, f64) -> T) -> T
where
    T: Default + AddAssign + Mul<f64, Output = T>,
{
    // The sky is smooth around, where few midpoints do.
    const AROUND: u32 = 256;
    const UP: u32 = 2048;
    let mut sum = T::default();
    for j in 0..UP {
        let (sine, cosine) = (FRAC_PI_2 * (f64::from(j) + 0.5) / f64::from(UP)).sin_cos();
        for i in 0..AROUND {
            let (sin_phi, cos_phi) = (2.0 * PI * (f64::from(i) + 0.5) / f64::from(AROUND)).sin_cos();
            let cos_sun = sine * (cos_phi * sun.x + sin_phi * sun.z) + cosine * sun.y;
            sum += radiance(cosine, cos_sun) * (sine * cosine);
        }
    }
    // With the sine of a ring's height for the height, every ring weighs what it does, so that an even sky is exact.
    sum * (2.0 * PI / f64::from(AROUND) * (FRAC_PI_2 / f64::from(UP)).sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies_have_the_luminances_of_the_standard() {
        let sun = DVec3::new(0.6, 0.8, 0.0);
        // The overcast sky of Moon and Spencer: near the horizon a third of the zenith; the standard's type 1 is an exponential one
        // that is near it.
        let overcast = SkyFormula::cie(1).unwrap();
        assert!((overcast.at(1e-9, 0.0) / overcast.at(1.0, 0.8) - 1.0 / (1.0 + 4.0 * (-0.7_f64).exp())).abs() < 1e-12);
        assert!(!overcast.asks_sun() && SkyFormula::cie(12).unwrap().asks_sun());
        // An even sky of radiance L gives pi L.
        let even = FormulaSky::new(SkyFormula::cie(5).unwrap(), sun, Rgb::splat(2.0), false, Rgb::ZERO).unwrap();
        assert!((even.horizontal().x / (2.0 * PI) - 1.0).abs() < 1e-9);
        // The clear sky is brightest at the sun, and darkest about a right angle from it.
        let clear = SkyFormula::cie(12).unwrap();
        assert!(clear.at(0.8, 1.0) > 5.0 * clear.at(0.8, 0.0));
        assert_eq!((0..17).filter(|n| SkyFormula::cie(*n).is_some()).count(), 15);
        assert_eq!(clear.cie_number(), Some(12));
        assert_eq!(SkyFormula { is_cie: false, ..clear }.cie_number(), None);
    }

    #[test]
    fn a_sky_is_scaled_by_its_zenith_or_by_what_falls_on_the_ground() {
        let sun = DVec3::new(0.48, 0.8, 0.36);
        for number in 1..=15 {
            let formula = SkyFormula::cie(number).unwrap();
            let by_zenith = FormulaSky::new(formula, sun, Rgb::splat(3.0), false, Rgb::splat(0.5)).unwrap();
            assert!((by_zenith.radiance(Vec3::Y).g() / 3.0 - 1.0).abs() < 1e-5, "{number}");
            let by_ground = FormulaSky::new(formula, sun, Rgb::splat(3.0), true, Rgb::splat(0.5)).unwrap();
            assert!((by_ground.horizontal().y / 3.0 - 1.0).abs() < 1e-12, "{number}");
            assert!((by_ground.radiance(-Vec3::Y).g() - 0.5 * 3.0 / PI as f32).abs() < 1e-6, "{number}");
        }
        for formula in (1..=15).filter_map(SkyFormula::cie) {
            let most =
                (1..=100).flat_map(|z| (0..=100).map(move |s| (f64::from(z) / 100.0, f64::from(s) / 50.0 - 1.0)));
            let most = most.map(|(zenith, sun)| formula.at(zenith, sun)).fold(0.0, f64::max);
            assert!(most <= formula.bound(), "{formula:?}: {most}");
        }
        let nothing = SkyFormula { numbers: [-1.0, 0.0, 0.0, 0.0, 0.0], is_cie: false };
        assert!(FormulaSky::new(nothing, sun, Rgb::ONE, false, Rgb::ZERO).is_none());
    }
}
