//! Models whose colours have spectra of their own.

use std::sync::Arc;

use super::lobes::{Lobes, TransportMode};
use super::metal_spectrum::MetalCurves;
use super::model::{BsdfSample, Model, SpecularLobes};
use super::thin_film::{FilmRange, FilmedInterface};
use super::{Bsdf, Conductor, FilmedDielectric, FilmedMetal, Index, Lambert, Mirror};
use crate::desc::{BsdfDesc, Dispersion, MaterialDesc, SpectrumKey};
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
    film: Option<Arc<FilmedInterface>>,
    /// A metal with a film.
    filmed: Option<Arc<FilmedMetal>>,
}

impl ByWavelength {
    /// That of a checked material.
    pub fn new(material: &MaterialDesc) -> Self {
        Self::with_film(material, material.film.map(FilmRange::from))
    }

    /// That of a checked material of which the film, where it has one, is of this range.
    pub fn with_film(material: &MaterialDesc, film: Option<FilmRange>) -> Self {
        let conductor = match &material.bsdf {
            BsdfDesc::Conductor { conductor, .. } => Some(conductor),
            _ => None,
        };
        let metal = conductor.and_then(|conductor| MetalCurves::new(conductor, &material.spectra));
        let sides = material.bsdf.interior().map(|[ior, exterior_ior]| {
            [Index { ior, dispersion: material.dispersion }, Index { ior: exterior_ior, dispersion: None }]
        });
        let filmed = conductor.zip(film).map(|(it, film)| Arc::new(FilmedMetal::of(it, metal.as_ref(), film)));
        let film = sides.zip(film).map(|([inner, outer], film)| Arc::new(FilmedInterface::new(inner, outer, film)));
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
    /// [`Self::within`]; `thickness`: that of the film \[nm\], where it varies.
    pub(crate) fn by_wavelength(
        self,
        desc: &BsdfDesc,
        by: &ByWavelength,
        around: Option<f32>,
        thickness: Option<f32>,
    ) -> Self {
        let ByWavelength { dispersion, colors, metal, film, filmed } = by;
        if let Some([ior, exterior_ior]) = desc.interior() {
            let inner = Index { ior, dispersion: *dispersion };
            let outer = Index { ior: around.unwrap_or(exterior_ior), dispersion: None };
            let Some(film) = film else { return self.dispersing(inner, outer) };
            let is_around = outer.ior == exterior_ior;
            let film =
                if is_around { Arc::clone(film) } else { Arc::new(FilmedInterface::new(inner, outer, film.range())) };
            return self.filmed(thickness.map_or(film.clone(), |nanometres| Arc::new(film.with_thickness(nanometres))));
        }
        let filmed = filmed.as_ref().map(|metal| match thickness {
            Some(nanometres) => Arc::new(metal.with_thickness(nanometres)),
            None => Arc::clone(metal),
        });
        match self {
            Self::Conductor(it) => Self::Conductor(match (filmed, metal) {
                (Some(filmed), _) => Conductor::filmed(filmed),
                (None, Some(metal)) => it.measured(metal.clone()),
                (None, None) => it,
            }),
            Self::RoughConductor(it) => Self::RoughConductor(match (filmed, metal) {
                (Some(filmed), _) => it.filmed(filmed),
                (None, Some(metal)) => it.measured(metal.clone()),
                (None, None) => it,
            }),
            model => match colors {
                Some(colors) => {
                    let colors = Some(Colors::Curves(Arc::clone(colors)));
                    Self::Measured(Measured { model: Box::new(model), colors })
                }
                None => model,
            },
        }
    }

    /// The same model, of which paths in wavelengths see for each of these parameters the mean of the spectra of its colours by their
    /// weights. In three channels the model has the mean colours already.
    pub(crate) fn with_interpolated_colors(self, colors: Vec<(SpectrumKey, f32, Rgb)>) -> Self {
        Self::Measured(Measured { model: Box::new(self), colors: Some(Colors::Interpolated(colors.into())) })
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
    /// `None` once the model has the values at the wavelengths of a path.
    colors: Option<Colors>,
}

/// Spectra of colours.
#[derive(Clone, Debug, PartialEq)]
enum Colors {
    /// Of parameters, by the wavelength.
    Curves(Arc<[(SpectrumKey, SpectralCurve)]>),
    /// Of parameters, the mean of the smooth spectra of these colours by their weights.
    Interpolated(Box<[(SpectrumKey, f32, Rgb)]>),
}

impl Measured {
    pub(super) fn in_spectrum<C: Spectrum>(&self, wavelengths: &C::Wavelengths) -> Measured<C> {
        if !C::HAS_WAVELENGTHS {
            return Measured { model: Box::new(self.model.in_spectrum(wavelengths)), colors: self.colors.clone() };
        }
        let mut model = self.model.in_spectrum::<C>(wavelengths);
        match &self.colors {
            Some(Colors::Curves(curves)) => {
                for (key, curve) in curves.iter() {
                    let color = C::at_wavelengths(wavelengths, |nanometres| curve.at(nanometres.unwrap_or(0.0)));
                    model = model.with_color(*key, color);
                }
            }
            Some(Colors::Interpolated(colors)) => {
                for of in colors.chunk_by(|a, b| a.0 == b.0) {
                    let sum = |sum, (_, weight, color): &(SpectrumKey, f32, Rgb)| {
                        sum + C::from_reflectance(*color, wavelengths) * *weight
                    };
                    model = model.with_color(of[0].0, of.iter().fold(C::ZERO, sum));
                }
            }
            None => {}
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
