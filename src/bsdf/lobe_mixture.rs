//! A Bsdf of any lobes, for tests of integrators.

use std::f32::consts::{FRAC_1_PI, TAU};

use super::lobes::{Lobes, TransportMode};
use super::local::{reflect, same_side};
use super::model::{BsdfSample, Model, SpecularLobes};
use super::parts::{Parts, lobes_of};
use crate::math::{Frame, Vec3};
use crate::sampling::warps;
use crate::spectrum::{Rgb, Spectrum};

/// A sum of lobes, at most one of each kind that [`Lobes`] names.
///
/// Diffuse lobes are Lambertian, on both sides of the surface. Glossy lobes are those of the modified Phong model about the
/// mirror direction and about the direction straight through: f = k (n + 2) / (2 pi) cos^n, of which a surface that is seen
/// along its normal scatters k. Specular lobes are a mirror, and a hole of which the light goes straight through. All lobes
/// that are there are equally likely to be sampled, whatever their weights, so that weights of samples differ from 1.
///
/// Source: Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeMixture<C: Spectrum = Rgb> {
    /// Weights of the lobes, in the order of the bits of [`Lobes`].
    weights: [C; LOBES],
    lobes: Lobes,
    /// Exponent of the glossy lobes.
    exponent: f32,
}

const LOBES: usize = 6;

/// The place of a single lobe among the weights.
fn place(lobe: Lobes) -> usize {
    lobe.bits().trailing_zeros() as usize
}

impl LobeMixture {
    /// A mixture of these lobes, each with its weight in [0, 1] per channel; weights sum to 1 at most. `exponent` is that of
    /// the glossy lobes, 0 or more.
    pub(crate) fn new(weights: &[(Lobes, Rgb)], exponent: f32) -> Self {
        let mut mixture = Self { weights: [Rgb::ZERO; LOBES], lobes: Lobes::empty(), exponent };
        for &(lobe, weight) in weights {
            mixture.weights[place(lobe)] = weight;
            mixture.lobes |= lobe;
        }
        mixture
    }

    #[inline(always)]
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> LobeMixture<C> {
        let weights = self.weights.map(|weight| C::from_reflectance(weight, wavelengths));
        LobeMixture { weights, lobes: self.lobes, exponent: self.exponent }
    }
}

impl<C: Spectrum> LobeMixture<C> {
    /// Width of the glossy lobes: Walter et al. 2007, Sec. 5.2, gives that of Blinn's distribution of this exponent, and the exponent of
    /// Phong's lobe is about a quarter of Blinn's.
    fn width(&self) -> f32 {
        (2.0 / (4.0 * self.exponent + 2.0)).sqrt()
    }

    pub(super) fn parts(&self, narrow_below: f32) -> Parts {
        let has = |part: &Parts| self.lobes.intersects(lobes_of(*part, self.width() < narrow_below));
        Parts::all().iter().filter(has).collect()
    }

    pub(super) fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        let lobes = self.lobes & lobes_of(part, self.width() < narrow_below);
        let mut weights = self.weights;
        for lobe in (self.lobes - lobes).iter() {
            weights[place(lobe)] = C::ZERO;
        }
        (!lobes.is_empty()).then_some(Self { weights, lobes, exponent: self.exponent })
    }

    fn weight(&self, lobe: Lobes) -> C {
        self.weights[place(lobe)]
    }

    /// Probability with which a lobe that is there is sampled.
    fn probability(&self) -> f32 {
        1.0 / self.lobes.iter().count() as f32
    }

    /// Power of the cosine to the direction about which the glossy lobe of `wi`'s side lies.
    fn power(&self, wo: Vec3, wi: Vec3) -> f32 {
        let axis = if same_side(wo, wi) { reflect(wo) } else { -wo };
        axis.dot(wi).max(0.0).powf(self.exponent)
    }

    /// The diffuse and the glossy lobe that connect these directions.
    fn smooth_lobes(wo: Vec3, wi: Vec3) -> Option<[Lobes; 2]> {
        if same_side(wo, wi) {
            Some([Lobes::DIFFUSE_REFLECTION, Lobes::GLOSSY_REFLECTION])
        } else if wo.z * wi.z < 0.0 {
            Some([Lobes::DIFFUSE_TRANSMISSION, Lobes::GLOSSY_TRANSMISSION])
        } else {
            None
        }
    }

    fn specular(&self, wo: Vec3, lobe: Lobes) -> Option<BsdfSample<C>> {
        let wi = if lobe == Lobes::SPECULAR_REFLECTION { reflect(wo) } else { -wo };
        let weight = self.weight(lobe);
        self.lobes.contains(lobe).then_some(BsdfSample { wi, weight, pdf: 0.0, lobe, eta: 1.0 })
    }
}

impl<C: Spectrum> Model<C> for LobeMixture<C> {
    fn lobes(&self) -> Lobes {
        self.lobes
    }

    fn albedo(&self) -> C {
        self.weights.into_iter().fold(C::ZERO, |sum, weight| sum + weight)
    }

    fn diffuse_albedo(&self) -> C {
        self.weight(Lobes::DIFFUSE_REFLECTION)
    }

    fn narrowest(&self) -> f32 {
        match (self.lobes.have_specular(), self.lobes.intersects(Lobes::GLOSSY)) {
            (true, _) => 0.0,
            (false, true) => self.width(),
            (false, false) => 1.0,
        }
    }

    fn f(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> C {
        let Some([diffuse, glossy]) = Self::smooth_lobes(wo, wi) else { return C::ZERO };
        let phong = (self.exponent + 2.0) / TAU * self.power(wo, wi);
        self.weight(diffuse) * FRAC_1_PI + self.weight(glossy) * phong
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some([diffuse, glossy]) = Self::smooth_lobes(wo, wi) else { return 0.0 };
        let mut pdf = 0.0;
        if self.lobes.contains(diffuse) {
            pdf += warps::cosine_hemisphere_pdf(wi.z.abs());
        }
        if self.lobes.contains(glossy) {
            pdf += (self.exponent + 1.0) / TAU * self.power(wo, wi);
        }
        pdf * self.probability()
    }

    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let count = self.lobes.iter().count();
        let lobe = self.lobes.iter().nth(((u[2] * count as f32) as usize).min(count - 1))?;
        if lobe.have_specular() {
            let sample = self.specular(wo, lobe)?;
            return Some(BsdfSample { weight: sample.weight / self.probability(), ..sample });
        }
        let is_reflection = Lobes::REFLECTION.contains(lobe);
        let wi = if lobe.have_diffuse() {
            let up = warps::cosine_hemisphere([u[0], u[1]]);
            Vec3::new(up.x, up.y, up.z.copysign(if is_reflection { wo.z } else { -wo.z }))
        } else {
            let axis = if is_reflection { reflect(wo) } else { -wo };
            let cos = (1.0 - u[0]).powf(1.0 / (self.exponent + 1.0));
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (sin_turn, cos_turn) = (TAU * u[1]).sin_cos();
            Frame::from_normal(axis).to_world(Vec3::new(sin * cos_turn, sin * sin_turn, cos)).normalize()
        };
        // The part of a glossy lobe that lies behind the surface is lost.
        if same_side(wo, wi) != is_reflection {
            return None;
        }
        let pdf = self.pdf(wo, wi);
        let weight = self.f(wo, wi, mode) * (wi.z.abs() / pdf);
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    fn constant_f(&self) -> Option<C> {
        let is_constant = !self.lobes.contains(Lobes::GLOSSY_REFLECTION);
        self.mean_f(Vec3::Z).filter(|_| is_constant)
    }

    fn mean_f(&self, _: Vec3) -> Option<C> {
        let diffuse = self.diffuse_albedo() * FRAC_1_PI;
        self.lobes.contains(Lobes::DIFFUSE_REFLECTION).then_some(diffuse)
    }

    fn specular_lobes(&self, wo: Vec3, _: TransportMode) -> SpecularLobes<C> {
        [self.specular(wo, Lobes::SPECULAR_REFLECTION), None, self.specular(wo, Lobes::SPECULAR_TRANSMISSION)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Bsdf;
    use crate::math::DVec3;
    use crate::sampling::{Sampler as _, SobolSampler};

    const MODE: TransportMode = TransportMode::Radiance;

    /// Mixtures of one lobe, of two and of all.
    fn mixtures() -> Vec<(LobeMixture, Rgb)> {
        let all = [
            (Lobes::DIFFUSE_REFLECTION, Rgb::new(0.1, 0.2, 0.3)),
            (Lobes::GLOSSY_REFLECTION, Rgb::splat(0.25)),
            (Lobes::SPECULAR_REFLECTION, Rgb::splat(0.05)),
            (Lobes::DIFFUSE_TRANSMISSION, Rgb::splat(0.15)),
            (Lobes::GLOSSY_TRANSMISSION, Rgb::splat(0.125)),
            (Lobes::SPECULAR_TRANSMISSION, Rgb::splat(0.0625)),
        ];
        let mut chosen: Vec<Vec<_>> = all.iter().map(|lobe| vec![*lobe]).collect();
        chosen.push(vec![all[0], all[2]]);
        chosen.push(vec![all[0], all[3]]);
        chosen.push(vec![all[1], all[2]]);
        chosen.push(all.to_vec());
        let sum = |lobes: &[(Lobes, Rgb)]| lobes.iter().fold(Rgb::ZERO, |sum, (_, weight)| sum + *weight);
        chosen.iter().map(|lobes| (LobeMixture::new(lobes, 20.0), sum(lobes))).collect()
    }

    fn seen_at(degrees: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(0.6 * sin, -0.8 * sin, cos)
    }

    /// Directions of a grid of equal solid angles over the sphere, and the solid angle of one.
    fn sphere() -> (impl Iterator<Item = Vec3>, f64) {
        const N: u32 = 1024;
        let at = |i: u32| (i as f32 + 0.5) / N as f32;
        let solid_angle = 4.0 * std::f64::consts::PI / f64::from(N * N);
        ((0..N * N).map(move |i| warps::uniform_sphere([at(i / N), at(i % N)])), solid_angle)
    }

    #[test]
    fn weights_are_f_cos_over_pdf_and_lobes_say_what_is_sampled() {
        for (mixture, _) in mixtures() {
            let bsdf = Bsdf::LobeMixture(mixture);
            for degrees in [0.0, 30.0, 75.0, 105.0, 160.0] {
                let wo = seen_at(degrees);
                let mut met = Lobes::empty();
                let mut sampler = SobolSampler::new(1, u32::MAX);
                for i in 0..4096 {
                    sampler.start(0, i);
                    let [a, b, c, _] = sampler.next_4d();
                    let Some(sample) = bsdf.sample(wo, [a, b, c], MODE) else { continue };
                    met |= sample.lobe;
                    let (f, pdf) = bsdf.f_pdf(wo, sample.wi, MODE);
                    assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{mixture:?}: {}", sample.wi);
                    assert_eq!(Lobes::REFLECTION.contains(sample.lobe), sample.wi.z * wo.z > 0.0);
                    if sample.is_specular() {
                        assert_eq!(sample.pdf, 0.0);
                        let whole = mixture.weight(sample.lobe) / mixture.probability();
                        assert_eq!(sample.weight, whole);
                    } else {
                        assert_eq!(sample.pdf, pdf);
                        let error = (sample.weight - f * (sample.wi.z.abs() / pdf)).max_element();
                        assert!(error.abs() < 1e-5, "{mixture:?}: {error}");
                    }
                }
                assert_eq!(met, mixture.lobes);
            }
        }
    }

    /// The density and the samples that are lost or specular make up 1; f and the specular lobes make up the albedo.
    #[test]
    fn densities_and_albedos_are_whole() {
        for (mixture, albedo) in mixtures() {
            let bsdf = Bsdf::LobeMixture(mixture);
            assert_eq!(bsdf.albedo(), albedo);
            for degrees in [0.0, 60.0, 120.0] {
                let wo = seen_at(degrees);
                let (directions, solid_angle) = sphere();
                let (mut density, mut scattered) = (0.0, DVec3::ZERO);
                for wi in directions {
                    density += f64::from(bsdf.pdf(wo, wi)) * solid_angle;
                    scattered += f64::from(wi.z.abs()) * solid_angle * bsdf.f(wo, wi, MODE).to_f64();
                }
                const SAMPLES: u32 = 1 << 16;
                let (mut without, mut sampled) = (0_u32, DVec3::ZERO);
                let mut sampler = SobolSampler::new(1, u32::MAX);
                for i in 0..SAMPLES {
                    sampler.start(0, i);
                    let [a, b, c, _] = sampler.next_4d();
                    match bsdf.sample(wo, [a, b, c], MODE) {
                        Some(sample) => {
                            without += u32::from(sample.is_specular());
                            sampled += sample.weight.to_f64() / f64::from(SAMPLES);
                        }
                        None => without += 1,
                    }
                }
                let whole = density + f64::from(without) / f64::from(SAMPLES);
                assert!((whole - 1.0).abs() < 2e-3, "{mixture:?} at {degrees} degrees: {whole}");
                for lobe in bsdf.specular_lobes(wo, MODE).into_iter().flatten() {
                    scattered += lobe.weight.to_f64();
                }
                let error = (sampled - scattered).abs().max_element();
                assert!(error < 2e-3, "{mixture:?} at {degrees} degrees: {sampled} by samples, {scattered} by f");
                if degrees == 0.0 || !mixture.lobes.intersects(Lobes::GLOSSY) {
                    let error = (scattered - albedo.to_f64()).abs().max_element();
                    assert!(error < 1e-3, "{mixture:?} at {degrees} degrees: {scattered} of {albedo:?}");
                }
            }
        }
    }
}
