//! Smooth interface between two dielectrics of which one disperses light.

use super::dielectric::Dielectric;
use super::fresnel::fresnel_dielectric;
use super::lobes::{Lobes, TransportMode};
use super::model::{BsdfSample, Model, SpecularLobes};
use crate::desc::{Dispersion, LINE_D};
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// The index of refraction of a medium by the wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Index {
    /// The index at the line d, 587.56 nm.
    pub ior: f32,
    /// How it depends on the wavelength; `None` for the same index everywhere.
    pub dispersion: Option<Dispersion>,
}

impl Index {
    /// The index at a wavelength \[nm\]; `None` stands for the line d.
    pub fn at(&self, nanometres: Option<f32>) -> f64 {
        let ior = f64::from(self.ior);
        let at = nanometres.map_or(LINE_D, f64::from);
        self.dispersion.map_or(ior, |dispersion| dispersion.index(ior, at))
    }
}

/// The media on the inner and on the outer side of an interface of which one disperses light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Indices {
    inner: Index,
    outer: Index,
}

impl Indices {
    /// The indices on the inner and on the outer side.
    pub fn new(inner: Index, outer: Index) -> Self {
        Self { inner, outer }
    }

    /// The indices on the inner and on the outer side.
    pub fn both(&self, nanometres: Option<f32>) -> [f64; 2] {
        [self.inner.at(nanometres), self.outer.at(nanometres)]
    }

    /// Whether the ratio of the indices depends on the wavelength.
    pub fn disperse(&self) -> bool {
        self.inner != self.outer && (self.inner.dispersion.is_some() || self.outer.dispersion.is_some())
    }

    /// Index on the inner side over index on the outer side.
    pub fn eta(&self, nanometres: Option<f32>) -> f64 {
        self.inner.at(nanometres) / self.outer.at(nanometres)
    }

    /// Of a path of these wavelengths: how much more of each is reflected than of the first one, by the cosine of the angle to the
    /// normal of a facet or the surface, on the outer side (`front`) or on the inner side. 0 where the first one is not reflected at all.
    pub fn reflected<C: Spectrum>(&self, cos: f32, front: bool, wavelengths: &C::Wavelengths) -> C {
        let reflectance = |nanometres| {
            let eta = self.eta(nanometres);
            fresnel_dielectric(f64::from(cos), if front { eta } else { 1.0 / eta }) as f32
        };
        let first = reflectance(C::first_wavelength(wavelengths));
        if first <= 0.0 {
            // The same index on both sides: no path is reflected.
            return C::ZERO;
        }
        C::at_wavelengths(wavelengths, reflectance) / first
    }
}

/// A smooth, colourless interface between media of which one disperses light.
///
/// A path takes its direction from its first wavelength. The reflection is the same for all of them and each has its share by
/// Fresnel's equations; what is refracted is the first wavelength alone ([`Model::disperses`]). In RGB it is a [`Dielectric`] with
/// the indices of the line d.
#[derive(Clone, Debug, PartialEq)]
pub struct Dispersive<C: Spectrum = Rgb> {
    /// The interface for the first wavelength.
    first: Dielectric,
    indices: Box<Indices>,
    wavelengths: C::Wavelengths,
}

impl Dispersive {
    /// An interface between media with these indices on the inner side (z < 0) and on the outer side.
    pub fn new(inner: Index, outer: Index) -> Self {
        let indices = Box::new(Indices::new(inner, outer));
        Self { first: Dielectric::of_ratio(indices.eta(None)), indices, wavelengths: () }
    }

    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Dispersive<C> {
        Dispersive {
            first: Dielectric::of_ratio(self.indices.eta(C::first_wavelength(wavelengths))),
            indices: self.indices.clone(),
            wavelengths: *wavelengths,
        }
    }
}

impl<C: Spectrum> Dispersive<C> {
    /// A sample of the first wavelength, with the shares of the others where it is a reflection.
    fn shared(&self, wo: Vec3, sample: BsdfSample<C>) -> BsdfSample<C> {
        if sample.lobe != Lobes::SPECULAR_REFLECTION {
            return sample;
        }
        let shares = self.indices.reflected::<C>(wo.z, wo.z > 0.0, &self.wavelengths);
        BsdfSample { weight: sample.weight * shares, ..sample }
    }
}

impl<C: Spectrum> Model<C> for Dispersive<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR
    }

    fn albedo(&self) -> C {
        C::ONE
    }

    fn disperses(&self) -> bool {
        true
    }

    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        Model::<C>::sample(&self.first, wo, u, mode).map(|sample| self.shared(wo, sample))
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let lobes: SpecularLobes<C> = self.first.specular_lobes(wo, mode);
        lobes.map(|lobe| lobe.map(|sample| self.shared(wo, sample)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{GLASSES, Glass};
    use crate::spectrum::SampledSpectrum;

    /// The shares of all wavelengths are Fresnel's, on both sides, and the direction is Snell's at the first one.
    #[test]
    fn each_wavelength_has_its_share_and_the_first_its_direction() {
        let inner = Index { ior: 1.6, dispersion: Some(Dispersion::Abbe(20.0)) };
        let outer = Index { ior: 1.0, dispersion: None };
        let colours = Dispersive::new(inner, outer);
        for u in [0.02, 0.3, 0.77] {
            let wavelengths = SampledSpectrum::sample_wavelengths(|| u);
            let glass = colours.in_spectrum::<SampledSpectrum>(&wavelengths);
            for degrees in [0.0_f32, 20.0, 35.0, 60.0, -20.0, -30.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                // Negative angles are on the inner side.
                let front = degrees >= 0.0;
                let wo = Vec3::new(sin, 0.0, if front { cos } else { -cos });
                let nanometres = wavelengths.nanometres.to_array();
                let eta = |i: usize| {
                    let eta = inner.at(Some(nanometres[i]));
                    if front { eta } else { 1.0 / eta }
                };
                let [reflection, refraction, _] = glass.specular_lobes(wo, TransportMode::Importance);
                let weights = reflection.unwrap().weight.to_array();
                for (i, weight) in weights.into_iter().enumerate() {
                    let expected = fresnel_dielectric(f64::from(wo.z), eta(i)) as f32;
                    assert!((weight - expected).abs() < 1e-6, "{degrees}: {weight} for {expected}");
                }
                let wi = refraction.unwrap().wi;
                let sine = f64::from(wi.x.hypot(wi.y)) * eta(0);
                assert!((sine - f64::from(sin.abs())).abs() < 1e-6, "{degrees}: {sine}");
            }
        }
        // In colours it is the interface of the line d.
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let plain: SpecularLobes<Rgb> = Dielectric::new(1.6, 1.0).specular_lobes(wo, TransportMode::Radiance);
        assert_eq!(Model::<Rgb>::specular_lobes(&colours, wo, TransportMode::Radiance), plain);
        // The same media on both sides reflect nothing.
        let none = Dispersive::new(inner, inner).in_spectrum(&SampledSpectrum::sample_wavelengths(|| 0.5));
        let lobes: SpecularLobes<SampledSpectrum> = none.specular_lobes(wo, TransportMode::Radiance);
        assert_eq!(lobes[0].map(|lobe| lobe.weight), Some(SampledSpectrum::ZERO));
    }

    /// A prism of 40 degrees turns each wavelength by a + b - 40 degrees, where sin(a) = n sin(a') and sin(b) = n sin(40 degrees - a').
    #[test]
    fn a_prism_deviates_each_wavelength_by_snells_law() {
        let apex = 40.0_f64.to_radians();
        let air = Index { ior: 1.0, dispersion: None };
        for Glass { name, dispersion, .. } in GLASSES {
            let ior = dispersion.own_index().unwrap() as f32;
            let inner = Index { ior, dispersion: Some(dispersion) };
            let mut turned = Vec::new();
            for i in 0..64 {
                let wavelengths = SampledSpectrum::sample_wavelengths(|| (i as f32 + 0.5) / 64.0);
                let nanometres = wavelengths.nanometres.to_array()[0];
                let surface = Dispersive::new(inner, air).in_spectrum::<SampledSpectrum>(&wavelengths);
                let through = |wo: Vec3| surface.specular_lobes(wo, TransportMode::Radiance)[1].unwrap().wi;
                let incident = 20.0_f64.to_radians();
                let n = dispersion.index(f64::from(ior), nanometres.into());
                let exact = |n: f64| {
                    let first = (incident.sin() / n).asin();
                    incident + (n * (apex - first).sin()).asin() - apex
                };
                if exact(n).is_nan() {
                    // Diamond reflects everything.
                    assert_eq!(name, "diamond");
                    continue;
                }
                let (sin, cos) = incident.sin_cos();
                let within = through(Vec3::new(sin as f32, 0.0, cos as f32));
                // Into the frame of the second face: the angle to its normal is that to the first one less the apex.
                let first = f64::from(-within.x).atan2(f64::from(-within.z));
                let (sin, cos) = (apex - first).sin_cos();
                let out = through(Vec3::new(sin as f32, 0.0, -cos as f32));
                let leaving = f64::from(-out.x).atan2(f64::from(out.z));
                let found = incident + leaving - apex;
                assert!((found - exact(n)).abs() < 1e-5, "{name} {nanometres}: {found} for {}", exact(n));
                assert!((found - exact(1.0 + 1.02 * (n - 1.0))).abs() > 1e-3);
                turned.push((nanometres, found));
            }
            turned.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert!(
                turned.windows(2).all(|pair| pair[0].1 > pair[1].1 - 1e-6),
                "{name}: shorter waves are turned more"
            );
        }
    }
}
