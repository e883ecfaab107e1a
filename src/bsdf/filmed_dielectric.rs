//! Smooth interface between two dielectrics with a thin film.

use std::sync::Arc;

use super::dielectric::{reflection, refract, refraction};
use super::dispersive::Index;
use super::lobes::{Lobes, TransportMode};
use super::model::{BsdfSample, Model, SpecularLobes};
use super::thin_film::{FilmedInterface, Shares};
use crate::desc::ThinFilmDesc;
use crate::math::Vec3;
use crate::spectrum::{Rgb, Spectrum};

/// A smooth interface with a film, which reflects what interference in the film leaves and refracts the rest by Snell's law, straight
/// on where the media on both sides have the same index, as a soap film does.
///
/// All channels have one direction, unless the media disperse light: then what is refracted is the first wavelength alone, as at
/// a [`super::Dispersive`] interface.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmedDielectric<C: Spectrum = Rgb> {
    interface: Arc<FilmedInterface>,
    wavelengths: C::Wavelengths,
}

impl FilmedDielectric {
    /// A film between media with these indices on the inner side (z < 0) and on the outer side.
    pub fn new(inner: Index, outer: Index, film: ThinFilmDesc) -> Self {
        Self { interface: Arc::new(FilmedInterface::new(inner, outer, film)), wavelengths: () }
    }

    /// This interface.
    pub(super) fn of(interface: Arc<FilmedInterface>) -> Self {
        Self { interface, wavelengths: () }
    }

    /// As [`super::Bsdf::dispersing`].
    pub(super) fn dispersing(&self, inner: Index, outer: Index) -> Self {
        Self { interface: Arc::new(self.interface.dispersing(inner, outer)), wavelengths: () }
    }

    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> FilmedDielectric<C> {
        FilmedDielectric { interface: self.interface.clone(), wavelengths: *wavelengths }
    }
}

impl<C: Spectrum> FilmedDielectric<C> {
    /// The shares of both ways, and the refracted direction with the index on the far side over that on `wo`'s side.
    fn branches(&self, wo: Vec3) -> (Shares<C>, Option<Vec3>, f64) {
        let front = wo.z > 0.0;
        let eta = self.interface.eta(C::first_wavelength(&self.wavelengths));
        let eta = if front { eta } else { 1.0 / eta };
        (self.interface.shares(wo.z, front, &self.wavelengths), refract(wo, eta), eta)
    }
}

/// Factor on what is refracted, for what [`TransportMode`] says.
fn scale(eta: f64, mode: TransportMode) -> f32 {
    match mode {
        TransportMode::Radiance => (1.0 / (eta * eta)) as f32,
        TransportMode::Importance => 1.0,
    }
}

impl<C: Spectrum> Model<C> for FilmedDielectric<C> {
    fn lobes(&self) -> Lobes {
        Lobes::SPECULAR
    }

    fn albedo(&self) -> C {
        C::ONE
    }

    fn disperses(&self) -> bool {
        self.interface.disperses()
    }

    /// Chooses a lobe with `u[2]`, by one probability for all channels.
    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        let (shares, refracted, eta) = self.branches(wo);
        let Some(wi) = refracted else { return Some(reflection(wo, shares.reflected)) };
        if u[2] >= shares.probability {
            return Some(refraction(wi, shares.transmitted_weight() * scale(eta, mode), eta as f32));
        }
        Some(reflection(wo, shares.reflected_weight()))
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        let (shares, refracted, eta) = self.branches(wo);
        let refraction = refracted.map(|wi| refraction(wi, shares.transmitted * scale(eta, mode), eta as f32));
        [Some(reflection(wo, shares.reflected)), refraction, None]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, ByWavelength, Dielectric};
    use crate::desc::{BsdfDesc, ConductorDesc, Dispersion, MaterialDesc, MicrofacetsDesc};
    use crate::sampling::Rng;
    use crate::spectrum::SampledSpectrum;

    const FILM: ThinFilmDesc = ThinFilmDesc { thickness: 320.0, ior: 1.33 };

    fn index(ior: f32) -> Index {
        Index { ior, dispersion: None }
    }

    fn wo(degrees: f32, front: bool) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(0.6 * sin, -0.8 * sin, if front { cos } else { -cos })
    }

    /// Both lobes together are all light, samples are the lobes on average, and no weight is above 2.
    fn check<C: Spectrum>(model: &FilmedDielectric<C>) {
        for (degrees, front) in [(0.0, true), (50.0, true), (85.0, true), (0.0, false), (35.0, false), (60.0, false)] {
            let wo = wo(degrees, front);
            let [reflected, refracted, _] = model.specular_lobes(wo, TransportMode::Importance);
            let (reflected, refracted) = (reflected.unwrap(), refracted.map_or(C::ZERO, |lobe| lobe.weight));
            if !Model::<C>::disperses(model) {
                let off = (reflected.weight + refracted - C::ONE).map(f32::abs).max_element();
                assert!(off < 1e-6, "{degrees}: {off}");
            }
            const N: u32 = 4096;
            let mut sums = [C::ZERO; 2];
            for i in 0..N {
                let u = (i as f32 + 0.5) / N as f32;
                let sample = model.sample(wo, [0.5, 0.5, u], TransportMode::Importance).unwrap();
                assert!(sample.weight.max_element() <= 2.0 + 1e-5, "{sample:?}");
                sums[usize::from(sample.lobe != Lobes::SPECULAR_REFLECTION)] += sample.weight / N as f32;
            }
            // The probability is met to one of the samples, each of which weighs 2 at most.
            for (sum, exact) in sums.into_iter().zip([reflected.weight, refracted]) {
                let off = (sum - exact).map(f32::abs).max_element();
                assert!(off < 2.5 / N as f32, "{degrees} {front}: {sum:?} for {exact:?}");
            }
        }
    }

    #[test]
    fn samples_are_the_lobes_on_average() {
        let disperses = Index { ior: 1.6, dispersion: Some(Dispersion::Abbe(15.0)) };
        for (inner, outer) in [(index(1.0), index(1.0)), (index(1.5), index(1.0)), (disperses, index(1.0))] {
            let model = FilmedDielectric::new(inner, outer, FILM);
            check(&model);
            for u in [0.1, 0.4, 0.8] {
                check(&model.in_spectrum::<SampledSpectrum>(&SampledSpectrum::sample_wavelengths(|| u)));
            }
        }
    }

    /// A soap film lets light pass straight on.
    #[test]
    fn a_soap_film_does_not_bend_light() {
        let model = FilmedDielectric::new(index(1.0), index(1.0), FILM);
        let wo = wo(70.0, false);
        let [_, through, _]: SpecularLobes<Rgb> = model.specular_lobes(wo, TransportMode::Radiance);
        assert_eq!(through.map(|lobe| (lobe.wi, lobe.eta)), Some((-wo, 1.0)));
    }

    /// Refracted directions are those without a film, and radiance is scaled by the indices.
    #[test]
    fn light_is_refracted_as_without_a_film() {
        let film = Bsdf::FilmedDielectric(FilmedDielectric::new(index(1.5), index(1.2), FILM));
        let none = Bsdf::new(&BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.2 });
        for front in [true, false] {
            let lobes = [&film, &none].map(|bsdf| bsdf.specular_lobes(wo(40.0, front), TransportMode::Radiance));
            let [film, none] = lobes.map(|lobes| lobes[1].unwrap());
            assert_eq!((film.wi, film.eta), (none.wi, none.eta));
            let passes = 1.0 - lobes[0][0].unwrap().weight.to_array()[1];
            assert!((film.weight.to_array()[1] * film.eta * film.eta - passes).abs() < 1e-6);
        }
    }

    #[test]
    fn a_film_makes_no_bsdf_larger() {
        assert!(size_of::<FilmedDielectric>() <= size_of::<Dielectric>());
        assert!(
            size_of::<FilmedDielectric<SampledSpectrum>>() <= size_of::<super::super::Dispersive<SampledSpectrum>>()
        );
        // As it was before there were films.
        assert_eq!([size_of::<Bsdf>(), size_of::<Bsdf<SampledSpectrum>>()], [496, 544]);
    }

    fn rough(film: Option<ThinFilmDesc>, dispersion: Option<Dispersion>, roughness: f32) -> Bsdf {
        let microfacets = MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() };
        let desc = BsdfDesc::RoughDielectric { ior: 1.5, exterior_ior: 1.0, microfacets };
        let material = MaterialDesc { bsdf: desc, film, dispersion, ..MaterialDesc::default() };
        Bsdf::new(&desc).by_wavelength(&desc, &ByWavelength::new(&material), None, None)
    }

    /// The mean weight of samples of light from one direction, which have the f and the density that the model states.
    fn albedo<C: Spectrum>(bsdf: &Bsdf<C>, wo: Vec3) -> C {
        let mut rng = Rng::new(3, 5);
        const N: u32 = 1 << 16;
        let mut sum = C::Wide::default();
        for _ in 0..N {
            let [a, b, c, _] = rng.next_4d();
            if let Some(sample) = bsdf.sample(wo, [a, b, c], TransportMode::Importance) {
                sum += (sample.weight / N as f32).widen();
                let (f, pdf) = bsdf.f_pdf(wo, sample.wi, TransportMode::Importance);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-2, "{wo} {pdf} {}", sample.pdf);
                let off = (f * (sample.wi.z.abs() / pdf) - sample.weight).map(f32::abs).max_element();
                assert!(off < 2e-2, "{wo}: {off}");
            }
        }
        C::narrow(sum)
    }

    /// Rough glass with a film scatters all light of each channel, as it does without one.
    #[test]
    fn rough_films_lose_nothing() {
        let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.3);
        for roughness in [0.3, 0.7] {
            let bsdf = rough(Some(FILM), None, roughness);
            for (degrees, front) in [(10.0, true), (60.0, true), (20.0, false), (60.0, false)] {
                let rgb = albedo(&bsdf, wo(degrees, front));
                let spectral = albedo(&bsdf.in_spectrum::<SampledSpectrum>(&wavelengths), wo(degrees, front));
                // Colours of what facets scatter more than once are left out; and what is drawn varies by 1 / 256.
                for off in [
                    (rgb - Rgb::ONE).abs().max_element(),
                    (spectral - SampledSpectrum::ONE).map(f32::abs).max_element(),
                ] {
                    assert!(off < 1.5e-2, "{roughness} {degrees} {front}: {off}");
                }
            }
        }
    }

    /// f(i -> o) / n_o^2 = f(o -> i) / n_i^2, in each channel.
    #[test]
    fn rough_films_are_reciprocal() {
        let bsdf = rough(Some(FILM), None, 0.5);
        let directions = [wo(20.0, true), wo(65.0, true), wo(15.0, false), wo(50.0, false)];
        for a in directions {
            for b in directions.map(|b| Vec3::new(-b.x, -b.y, b.z)) {
                let n2 = |w: Vec3| if w.z > 0.0 { 1.0 } else { 2.25 };
                let there = bsdf.f(a, b, TransportMode::Importance) * n2(a);
                let back = bsdf.f(b, a, TransportMode::Importance) * n2(b);
                let off = (there - back).abs().max_element();
                assert!(off < 1e-4 * there.max_element().max(1e-3), "{a} {b}: {there:?} {back:?}");
            }
        }
    }

    /// Facets that are nearly smooth reflect what smooth ones do; those of a metal too.
    #[test]
    fn narrow_facets_reflect_as_smooth_ones() {
        let metal = |roughness: f32| {
            let microfacets = MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() };
            let conductor = ConductorDesc::Index { eta: Rgb::new(0.2, 0.9, 1.3), k: Rgb::new(3.6, 2.4, 2.0) };
            let desc = BsdfDesc::Conductor { conductor, microfacets };
            let film = Some(ThinFilmDesc { thickness: 60.0, ior: 2.2 });
            let material = MaterialDesc { bsdf: desc, film, ..MaterialDesc::default() };
            Bsdf::new(&desc).by_wavelength(&desc, &ByWavelength::new(&material), None, None)
        };
        let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.7);
        for degrees in [5.0, 40.0] {
            let wo = wo(degrees, true);
            let found = albedo(&metal(0.08), wo);
            let exact: Rgb = metal(0.0).specular_lobes(wo, TransportMode::Radiance)[0].unwrap().weight;
            assert!((found - exact).abs().max_element() < 3e-3, "{found:?} {exact:?}");
            let found = albedo(&metal(0.08).in_spectrum::<SampledSpectrum>(&wavelengths), wo);
            let smooth = metal(0.0).in_spectrum::<SampledSpectrum>(&wavelengths);
            let exact: SampledSpectrum = smooth.specular_lobes(wo, TransportMode::Radiance)[0].unwrap().weight;
            assert!((found - exact).map(f32::abs).max_element() < 3e-3, "{found:?} {exact:?}");
        }
    }
}
