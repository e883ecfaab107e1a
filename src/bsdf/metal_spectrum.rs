//! Metals by the wavelength.

use std::sync::{Arc, LazyLock};

use super::fresnel::fresnel_conductor;
use super::microfacet::average_of;
use crate::desc::{ConductorDesc, METALS, SpectrumDesc, SpectrumKey};
use crate::math::DVec3;
use crate::spectrum::{Beyond, Rgb, SpectralCurve, Spectrum, VISIBLE};

/// The optical constants of [`METALS`] but for iron, by [`STEP`] nm; see `scripts/metal_tables.py`.
const MEASURED: &[[u8; 8]] = include_bytes!("../spectrum/tables/metals.f32").as_chunks().0;

/// Distance of the wavelengths of [`MEASURED`], nm.
const STEP: f64 = 5.0;

/// Number of wavelengths of [`MEASURED`].
const COUNT: usize = ((VISIBLE[1] - VISIBLE[0]) / STEP) as usize + 1;

/// The metals of [`METALS`] that are in [`MEASURED`], by their numbers among the former.
static KNOWN: LazyLock<[Option<MetalSpectrum>; METALS.len()]> = LazyLock::new(|| {
    let mut tables = MEASURED.chunks_exact(COUNT);
    METALS.map(|metal| {
        // Iron was measured at three wavelengths only.
        let table = if metal.symbol == "Fe" { None } else { tables.next() }?;
        let curve = |part: usize| {
            let number = |row: &[u8; 8]| f64::from(f32::from_le_bytes(std::array::from_fn(|i| row[4 * part + i])));
            let row = |(i, row): (usize, &[u8; 8])| [VISIBLE[0] + STEP * i as f64, number(row)];
            table.iter().enumerate().map(row).collect::<Vec<_>>()
        };
        Some(MetalSpectrum::new(linear(&curve(0)), linear(&curve(1))))
    })
});

/// The curve through points at regular wavelengths.
fn linear(points: &[[f64; 2]]) -> SpectralCurve {
    SpectralCurve::of(|nanometres| {
        let place = (nanometres - points[0][0]) / STEP;
        let lower = (place as usize).min(points.len() - 2);
        let ([_, before], [_, after]) = (points[lower], points[lower + 1]);
        before + (after - before) * (place - lower as f64)
    })
}

/// The complex index of a metal by the wavelength, over that of what is in front of it, and its mean reflectance for light from all
/// sides.
#[derive(Debug, PartialEq)]
pub struct MetalSpectrum {
    eta: SpectralCurve,
    k: SpectralCurve,
    mean: SpectralCurve,
}

impl MetalSpectrum {
    fn new(eta: SpectralCurve, k: SpectralCurve) -> Self {
        // The mean is smooth where the index is; by 10 nm it is off by less than 1e-4.
        const EACH: f64 = 10.0;
        let mean_at = |nanometres: f64| {
            let [eta, k] = [&eta, &k].map(|curve| curve.at(nanometres as f32));
            average_of(|mu| DVec3::splat(f64::from(fresnel_conductor(mu as f32, eta, k)))).x
        };
        let count = ((VISIBLE[1] - VISIBLE[0]) / EACH) as usize;
        let means: Vec<f64> = (0..=count).map(|i| mean_at(VISIBLE[0] + EACH * i as f64)).collect();
        let mean = SpectralCurve::of(|nanometres| {
            let place = (nanometres - VISIBLE[0]) / EACH;
            let lower = (place as usize).min(count - 1);
            means[lower] + (means[lower + 1] - means[lower]) * (place - lower as f64)
        });
        Self { eta, k, mean }
    }
}

/// A metal by the wavelength: a known one, or one of a scene.
#[derive(Clone, Debug)]
pub enum MetalCurves {
    /// One of [`METALS`].
    Known(&'static MetalSpectrum),
    /// Of spectra in the description.
    Own(Arc<MetalSpectrum>),
}

impl PartialEq for MetalCurves {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.get(), other.get())
    }
}

impl MetalCurves {
    fn get(&self) -> &MetalSpectrum {
        match self {
            Self::Known(metal) => metal,
            Self::Own(metal) => metal,
        }
    }

    /// The numbers by which tables of metals are told apart.
    pub(super) fn bits(&self) -> impl Iterator<Item = u32> {
        let MetalSpectrum { eta, k, .. } = self.get();
        eta.values().iter().chain(k.values()).map(|value| value.to_bits())
    }

    /// n and k at a wavelength \[nm\].
    pub(super) fn index(&self, nanometres: f32) -> [f32; 2] {
        let metal = self.get();
        [metal.eta.at(nanometres), metal.k.at(nanometres)]
    }

    /// The metal of a checked description with these spectra; `None` where only three channels are known.
    pub(super) fn new(conductor: &ConductorDesc, spectra: &[(SpectrumKey, SpectrumDesc)]) -> Option<Self> {
        let curve = |key: SpectrumKey| {
            let (_, spectrum) = spectra.iter().find(|(known, _)| *known == key)?;
            spectrum.curve(key.name()).ok()
        };
        let index = [curve(SpectrumKey::Eta), curve(SpectrumKey::K)];
        if let ([Some(_), _] | [_, Some(_)], ConductorDesc::Index { eta, k }) = (&index, conductor) {
            // What has no spectrum is linear between the wavelengths of the channels.
            let of_channels = |channels: Rgb| {
                let [red, green, blue] = channels.to_array().map(f64::from);
                SpectralCurve::of_samples(&[[450.0, blue], [550.0, green], [650.0, red]], Beyond::Ends)
            };
            let [eta_curve, k_curve] = index;
            let (eta, k) = (eta_curve.unwrap_or_else(|| of_channels(*eta)), k_curve.unwrap_or_else(|| of_channels(*k)));
            return Some(Self::Own(Arc::new(MetalSpectrum::new(eta, k))));
        }
        if let Some(reflectance) = curve(SpectrumKey::Reflectance) {
            // The tint of the edge is a colour, of which the mean is taken.
            let edge = match conductor {
                ConductorDesc::Reflectance { edge, .. } => *edge,
                ConductorDesc::Index { .. } => Rgb::ONE,
            };
            let edge = Rgb::splat(edge.element_sum() / 3.0);
            let part = |part: usize| {
                SpectralCurve::of(|nanometres| {
                    // What reflects everything has no index.
                    let normal = Rgb::splat(reflectance.at(nanometres as f32).min(0.9999));
                    let index = ConductorDesc::Reflectance { normal, edge }.index(0);
                    index.map_or(1.0, |index| f64::from(index[part]))
                })
            };
            return Some(Self::Own(Arc::new(MetalSpectrum::new(part(0), part(1)))));
        }
        let number = METALS.iter().position(|metal| metal.conductor() == *conductor)?;
        KNOWN[number].as_ref().map(Self::Known)
    }
}

/// A metal at the wavelengths of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetalAt<C> {
    eta: C,
    k: C,
    /// Mean reflectance for light from all sides.
    pub mean: C,
}

impl<C: Spectrum> MetalAt<C> {
    /// The reflectance at this cosine of the angle of incidence.
    pub fn reflectance(&self, cos: f32) -> C {
        self.eta.zip(self.k, |eta, k| fresnel_conductor(cos, eta, k))
    }
}

/// What a model of a metal knows of it by the wavelength.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum MetalInSpectrum<C: Spectrum> {
    /// Nothing.
    #[default]
    Unknown,
    /// The curves, of a model whose paths carry colours.
    Curves(MetalCurves),
    /// The values at the wavelengths of a path.
    At(Box<MetalAt<C>>),
}

impl<C: Spectrum> MetalInSpectrum<C> {
    /// The values at the wavelengths of a path, for a model of which some are known.
    #[inline(always)]
    pub(super) fn at(&self) -> Option<&MetalAt<C>> {
        match self {
            Self::At(at) if C::HAS_WAVELENGTHS => Some(at),
            _ => None,
        }
    }

    pub(super) fn in_spectrum<D: Spectrum>(&self, wavelengths: &D::Wavelengths) -> MetalInSpectrum<D> {
        let Self::Curves(curves) = self else { return MetalInSpectrum::Unknown };
        if !D::HAS_WAVELENGTHS {
            return MetalInSpectrum::Curves(curves.clone());
        }
        let metal = curves.get();
        let at =
            |curve: &SpectralCurve| D::at_wavelengths(wavelengths, |nanometres| curve.at(nanometres.unwrap_or(0.0)));
        MetalInSpectrum::At(Box::new(MetalAt { eta: at(&metal.eta), k: at(&metal.k), mean: at(&metal.mean) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::SampledSpectrum;

    /// The tables have the numbers that the metals have in three channels.
    #[test]
    fn known_metals_are_those_of_the_channels() {
        for (metal, known) in METALS.iter().zip(KNOWN.iter()) {
            let Some(known) = known else {
                assert_eq!(metal.symbol, "Fe");
                continue;
            };
            for (channel, nanometres) in [650.0, 550.0, 450.0].into_iter().enumerate() {
                let [eta, k] = [&known.eta, &known.k].map(|curve| curve.at(nanometres));
                assert!((eta - metal.eta[channel]).abs() < 1e-4, "{}: {eta}", metal.symbol);
                assert!((k - metal.k[channel]).abs() < 1e-4, "{}: {k}", metal.symbol);
            }
        }
    }

    #[test]
    fn a_metal_reflects_by_fresnels_equations_at_each_wavelength() {
        let gold = METALS.iter().find(|metal| metal.symbol == "Au").unwrap().conductor();
        let curves = MetalCurves::new(&gold, &[]).unwrap();
        let wavelengths = SampledSpectrum::sample_wavelengths(|| 0.6);
        let metal = MetalInSpectrum::<Rgb>::Curves(curves.clone()).in_spectrum::<SampledSpectrum>(&wavelengths);
        for cos in [1.0_f32, 0.6, 0.1] {
            let found = metal.at().unwrap().reflectance(cos).to_array();
            for (value, nanometres) in found.into_iter().zip(wavelengths.nanometres.to_array()) {
                let [eta, k] = [&curves.get().eta, &curves.get().k].map(|curve| curve.at(nanometres));
                assert!((value - fresnel_conductor(cos, eta, k)).abs() < 1e-6);
            }
        }
        // By a reflectance, that is what it reflects along the normal.
        let samples: SpectrumDesc = SpectrumDesc::samples("", [[400.0, 0.2], [700.0, 0.8]]).unwrap();
        let own = ConductorDesc::Reflectance { normal: Rgb::ONE, edge: Rgb::ONE };
        let own = MetalCurves::new(&own, &[(SpectrumKey::Reflectance, samples)]).unwrap();
        let metal = MetalInSpectrum::<Rgb>::Curves(own).in_spectrum::<SampledSpectrum>(&wavelengths);
        for (value, nanometres) in
            metal.at().unwrap().reflectance(1.0).to_array().into_iter().zip(wavelengths.nanometres.to_array())
        {
            let expected = (0.2 + 0.6 * (nanometres - 400.0) / 300.0).clamp(0.2, 0.8);
            assert!((value - expected).abs() < 2e-3, "{nanometres}: {value}");
        }
        assert!(MetalCurves::new(&ConductorDesc::Index { eta: Rgb::ONE, k: Rgb::ONE }, &[]).is_none());
    }
}
