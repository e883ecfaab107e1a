//! Models whose colours have spectra of their own.

use std::sync::Arc;

use super::lobes::{Lobes, TransportMode};
use super::metal_spectrum::MetalCurves;
use super::model::{BsdfSample, Model, SpecularLobes};
use super::thin_film::FilmedInterface;
use super::{Bsdf, Conductor, FilmedDielectric, FilmedMetal, Index, Lambert, Mirror};
use crate::desc::{BsdfDesc, Dispersion, MaterialDesc, SpectrumKey, ThinFilmDesc};
use crate::math::Vec3;
use crate::spectrum::{Rgb, SpectralCurve, Spectrum};

/// What of a material depends on the wavelength other than by its colours.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByWavelength {
    /// How the index of refraction does.
    dispersion: Option<Dispersion>,
    /// The colours that have spectra of their own.
    colors: Option<Arc<[(SpectrumKey, SpectralCurve)]>>,
    /// The index of a metal.
    metal: Option<MetalCurves>,
    /// A film on a dielectric, as it is between the media that the description states.
    film: Option<(ThinFilmDesc, Arc<FilmedInterface>)>,
    /// A metal with a film.
    filmed: Option<Arc<FilmedMetal>>,
}

impl ByWavelength {
    /// That of a checked material.
    pub fn new(material: &MaterialDesc) -> Self {
        let conductor = match &material.bsdf {
            BsdfDesc::Conductor { conductor, .. } => Some(conductor),
            _ => None,
        };
        let metal = conductor.and_then(|conductor| MetalCurves::new(conductor, &material.spectra));
        let sides = material.bsdf.interior().map(|[ior, exterior_ior]| {
            [Index { ior, dispersion: material.dispersion }, Index { ior: exterior_ior, dispersion: None }]
        });
        let film = sides
            .zip(material.film)
            .map(|([inner, outer], film)| (film, Arc::new(FilmedInterface::new(inner, outer, film))));
        let filmed = conductor.zip(material.film).map(|(it, film)| Arc::new(FilmedMetal::of(it, metal.as_ref(), film)));
        let is_color = |key: SpectrumKey| matches!(key, SpectrumKey::Color | SpectrumKey::Transmittance);
        let of_colors = material.spectra.iter().filter(|(key, _)| is_color(*key));
        let colors: Arc<[_]> =
            of_colors.filter_map(|(key, spectrum)| Some((*key, spectrum.curve(key.name()).ok()?))).collect();
        let colors = (!colors.is_empty()).then_some(colors);
        Self { dispersion: material.dispersion, colors, metal, film, filmed }
    }
}

impl Bsdf {
    /// The model that was made from a description, of a material that depends on the wavelength like this. `around`: as for
    /// [`Self::within`].
    pub(crate) fn by_wavelength(self, desc: &BsdfDesc, by: &ByWavelength, around: Option<f32>) -> Self {
        let ByWavelength { dispersion, colors, metal, film, filmed } = by;
        if let Some([ior, exterior_ior]) = desc.interior() {
            let inner = Index { ior, dispersion: *dispersion };
            let outer = Index { ior: around.unwrap_or(exterior_ior), dispersion: None };
            return match film {
                Some((_, made)) if outer.ior == exterior_ior => self.filmed(Arc::clone(made)),
                Some((film, _)) => self.filmed(Arc::new(FilmedInterface::new(inner, outer, *film))),
                None => self.dispersing(inner, outer),
            };
        }
        match self {
            Self::Conductor(it) => Self::Conductor(match (filmed, metal) {
                (Some(filmed), _) => Conductor::filmed(Arc::clone(filmed)),
                (None, Some(metal)) => it.measured(metal.clone()),
                (None, None) => it,
            }),
            Self::RoughConductor(it) => Self::RoughConductor(match (filmed, metal) {
                (Some(filmed), _) => it.filmed(Arc::clone(filmed)),
                (None, Some(metal)) => it.measured(metal.clone()),
                (None, None) => it,
            }),
            model => match colors {
                Some(colors) => Self::Measured(Measured { model: Box::new(model), colors: Some(Arc::clone(colors)) }),
                None => model,
            },
        }
    }

    /// The same interface between dielectrics with a thin film; other models as they are.
    fn filmed(self, film: Arc<FilmedInterface>) -> Self {
        match self {
            Self::Dielectric(_) => Self::FilmedDielectric(FilmedDielectric::of(film)),
            Self::RoughDielectric(rough) => Self::RoughDielectric(rough.filmed(FilmedInterface::clone(&film))),
            other => other,
        }
    }
}

/// A model of which some colours have spectra of their own. In three channels it is the model with the colours of these spectra.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured<C: Spectrum = Rgb> {
    model: Box<Bsdf<C>>,
    colors: Option<Arc<[(SpectrumKey, SpectralCurve)]>>,
}

impl Measured {
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Measured<C> {
        if !C::HAS_WAVELENGTHS {
            return Measured { model: Box::new(self.model.in_spectrum(wavelengths)), colors: self.colors.clone() };
        }
        let mut model = self.model.in_spectrum::<C>(wavelengths);
        for (key, curve) in self.colors.iter().flat_map(|colors| colors.iter()) {
            let color = C::at_wavelengths(wavelengths, |nanometres| curve.at(nanometres.unwrap_or(0.0)));
            model = model.with_color(*key, color);
        }
        Measured { model: Box::new(model), colors: None }
    }
}

impl<C: Spectrum> Bsdf<C> {
    /// The same model with another colour.
    fn with_color(self, key: SpectrumKey, color: C) -> Self {
        match (self, key) {
            (Self::Lambert(_), SpectrumKey::Color) => Self::Lambert(Lambert::new(color)),
            (Self::OrenNayar(it), SpectrumKey::Color) => Self::OrenNayar(it.with_albedo(color)),
            (Self::OrenNayarQualitative(it), SpectrumKey::Color) => Self::OrenNayarQualitative(it.with_albedo(color)),
            (Self::Eon(it), SpectrumKey::Color) => Self::Eon(it.with_albedo(color)),
            (Self::Mirror(_), SpectrumKey::Color) => Self::Mirror(Mirror::new(color)),
            (Self::Sheen(it), SpectrumKey::Color) => Self::Sheen(it.with_color(color)),
            (Self::DiffuseTransmission(it), SpectrumKey::Color) => {
                Self::DiffuseTransmission(it.with_reflectance(color))
            }
            (Self::DiffuseTransmission(it), SpectrumKey::Transmittance) => {
                Self::DiffuseTransmission(it.with_transmittance(color))
            }
            (same, _) => same,
        }
    }
}

impl<C: Spectrum> Model<C> for Measured<C> {
    fn lobes(&self) -> Lobes {
        self.model.lobes()
    }

    fn albedo(&self) -> C {
        self.model.albedo()
    }

    fn diffuse_albedo(&self) -> C {
        self.model.diffuse_albedo()
    }

    fn narrowest(&self) -> f32 {
        self.model.narrowest()
    }

    fn is_anisotropic(&self) -> bool {
        self.model.is_anisotropic()
    }

    fn share(&self, wo: Vec3) -> f32 {
        self.model.share(wo)
    }

    fn f(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> C {
        self.model.f(wo, wi, mode)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.model.pdf(wo, wi)
    }

    fn f_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (C, f32) {
        self.model.f_pdf(wo, wi, mode)
    }

    fn sample(&self, wo: Vec3, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample<C>> {
        self.model.sample(wo, u, mode)
    }

    fn constant_f(&self) -> Option<C> {
        self.model.constant_f()
    }

    fn mean_f(&self, wo: Vec3) -> Option<C> {
        self.model.mean_f(wo)
    }

    fn is_even(&self) -> bool {
        self.model.is_even()
    }

    fn specular_lobes(&self, wo: Vec3, mode: TransportMode) -> SpecularLobes<C> {
        self.model.specular_lobes(wo, mode)
    }
}
