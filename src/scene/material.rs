//! Materials in the form that shading uses.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use super::SurfaceDetail;
use crate::bsdf::{Bsdf, Lobes, Model as _, Parts};
use crate::math::{Frame, Vec3};
use crate::spectrum::{Rgb, Spectrum};

/// A material that is not the same all over its surfaces.
///
/// All rendering threads call the functions concurrently. They have to be functions of their arguments alone.
pub trait VaryingMaterial: Debug + Send + Sync {
    /// The Bsdf at a point, as a colour.
    fn bsdf(&self, at: &SurfaceDetail) -> Bsdf;

    /// As [`Self::bsdf`], for the surface of a body in a medium of this index of refraction.
    fn bsdf_in(&self, at: &SurfaceDetail, _around: f32) -> Bsdf {
        self.bsdf(at)
    }

    /// As [`Self::bsdf`], for paths in wavelengths: colours that it interpolates may become spectra first.
    fn bsdf_by_wavelength(&self, at: &SurfaceDetail) -> Bsdf {
        self.bsdf(at)
    }

    /// The Bsdf whose colours are the means over the surface, for solvers that have one value for each element.
    fn mean(&self) -> Bsdf;

    /// Bsdfs among which are those with the narrowest lobes that the material has anywhere.
    fn extremes(&self) -> Vec<Bsdf> {
        vec![self.mean()]
    }

    /// All lobes that the material has anywhere.
    fn lobes(&self) -> Lobes {
        self.mean().lobes()
    }

    /// Whether the material covers its surfaces everywhere.
    fn is_opaque(&self) -> bool {
        true
    }

    /// The share of the surface that is there around a point, in [0, 1]; called where the material is not opaque. The
    /// footprint is 0 here, so that shadow rays, which carry no cones, see the same surface as all other rays.
    fn opacity(&self, _at: &SurfaceDetail) -> f32 {
        1.0
    }

    /// Whether what the material reflects depends on the place.
    fn is_textured(&self) -> bool {
        false
    }

    /// Whether the material has shading normals of its own.
    fn has_normals(&self) -> bool {
        false
    }

    /// The unit shading normal at a point, on the outer side; called where the material has some. [`SurfaceDetail::ns`] is that of the
    /// surface. The local frame of [`Self::bsdf`] is that of the result.
    fn normal(&self, at: &SurfaceDetail) -> Vec3 {
        at.ns
    }

    /// Whether the material reads the tangents of [`SurfaceDetail`].
    fn asks_tangents(&self) -> bool {
        true
    }

    /// Whether the material reads [`SurfaceDetail::footprint`].
    fn asks_footprint(&self) -> bool {
        false
    }
}

/// An anisotropic material: its Bsdf turns with the tangents of the surface.
#[derive(Debug)]
struct Turned {
    bsdf: Bsdf,
}

/// The Bsdf turned with the tangents of the surface.
pub(super) fn turned_with_tangents(bsdf: &Bsdf, at: &SurfaceDetail) -> Bsdf {
    let local = Frame::from_normal(at.ns).to_local(at.tangent);
    let length = local.x.hypot(local.y);
    if length > 1e-6 { bsdf.turned([local.x / length, local.y / length]) } else { bsdf.clone() }
}

impl VaryingMaterial for Turned {
    fn bsdf(&self, at: &SurfaceDetail) -> Bsdf {
        turned_with_tangents(&self.bsdf, at)
    }

    fn mean(&self) -> Bsdf {
        self.bsdf.clone()
    }
}

/// A material whose constants are precomputed. At a hit, [`Material::at`] returns the Bsdf of the surface there.
///
/// A material that is the same all over its surfaces stores its [`Bsdf`] when the scene is built, and paths that carry
/// colours refer to that Bsdf.
#[derive(Clone, Debug)]
pub struct Material {
    /// The Bsdf everywhere, or its mean where the material varies.
    bsdf: Bsdf,
    /// The lobes of this Bsdf that scatter any light.
    lobes: Lobes,
    varying: Option<Arc<dyn VaryingMaterial>>,
    /// Probability with which a path survives a bounce at this material, where Russian roulette uses the probability
    /// that the scene states.
    pub survival: Option<f32>,
    /// The opacity everywhere, where it does not vary.
    opacity: f32,
}

impl Material {
    /// Makes a material that is the same everywhere, except that an anisotropic one follows the tangents of its surfaces, and at which paths end by the library's own roulette.
    pub fn uniform(bsdf: Bsdf) -> Self {
        let varying =
            bsdf.is_anisotropic().then(|| Arc::new(Turned { bsdf: bsdf.clone() }) as Arc<dyn VaryingMaterial>);
        Self { lobes: bsdf.lit_lobes(), bsdf, varying, survival: None, opacity: 1.0 }
    }

    /// Makes a material that is asked at every hit.
    pub fn varying(varying: Arc<dyn VaryingMaterial>) -> Self {
        let bsdf = varying.mean();
        Self { lobes: bsdf.lit_lobes(), bsdf, varying: Some(varying), survival: None, opacity: 1.0 }
    }

    /// The same material with this opacity, which is a factor on the opacity of a material that varies.
    pub(super) fn with_opacity(self, opacity: f32) -> Self {
        Self { opacity, ..self }
    }

    /// The same material with this probability of survival.
    pub(super) fn with_survival(self, survival: Option<f32>) -> Self {
        Self { survival, ..self }
    }

    /// Returns the Bsdf of this material at a hit, in the channels of a path. `detail` computes
    /// [`Scene::detail`](super::Scene::detail) of the hit, with tangents where they are asked for, and is called only if the
    /// material varies.
    ///
    /// The result is the material's own Bsdf where that serves. Otherwise the Bsdf is put into `slot`. The lobes are those that
    /// scatter any light.
    #[inline(always)]
    pub fn at<'a, 'd, C: Spectrum>(
        &'a self,
        detail: impl FnOnce(bool) -> SurfaceDetail<'d>,
        wavelengths: &C::Wavelengths,
        slot: &'a mut Option<Bsdf<C>>,
    ) -> (&'a Bsdf<C>, Lobes) {
        if let Some(constant) = self.constant() {
            return constant;
        }
        let bsdf: &Bsdf<C> = match &self.varying {
            None => slot.insert(self.bsdf.in_spectrum(wavelengths)),
            Some(varying) if C::HAS_WAVELENGTHS => {
                slot.insert(ask_by_wavelength(&**varying, detail).in_spectrum(wavelengths))
            }
            Some(varying) => slot.insert(ask(&**varying, detail).in_spectrum(wavelengths)),
        };
        (bsdf, bsdf.lit_lobes())
    }

    /// The material's own Bsdf and its lit lobes, where it is the same everywhere and paths carry colours.
    #[inline(always)]
    pub(crate) fn constant<C: Spectrum>(&self) -> Option<(&Bsdf<C>, Lobes)> {
        // The compiler decides this at compile time: a path that carries colours uses the Bsdf of the scene.
        let bsdf = (&self.bsdf as &dyn Any).downcast_ref()?;
        if self.varying.is_none() { Some((bsdf, self.lobes)) } else { None }
    }

    /// The Bsdf in the channels of a path, where it is the same everywhere; it is put into `slot` where the material's own does not serve.
    #[inline]
    pub(super) fn everywhere<'a, C: Spectrum>(
        &'a self,
        wavelengths: &C::Wavelengths,
        slot: &'a mut Option<Bsdf<C>>,
    ) -> Option<&'a Bsdf<C>> {
        if self.is_varying() {
            return None;
        }
        match self.constant() {
            Some((bsdf, _)) => Some(bsdf),
            None => Some(slot.insert(self.bsdf.in_spectrum(wavelengths))),
        }
    }

    /// The Bsdf at a hit on the surface of a body in a medium of this index of refraction.
    pub(super) fn at_body<'d>(&self, detail: impl FnOnce(bool) -> SurfaceDetail<'d>, around: f32) -> Bsdf {
        match &self.varying {
            Some(varying) => varying.bsdf_in(&detail(varying.asks_tangents()), around),
            None => self.bsdf.clone(),
        }
    }

    /// All lobes that the material has anywhere. There are none where the material is black everywhere.
    pub fn lobes(&self) -> Lobes {
        match &self.varying {
            Some(varying) => varying.lobes(),
            None => self.lobes,
        }
    }

    /// The Bsdf whose colours are the means over the surface, for solvers that have one value for each element.
    pub fn mean(&self) -> &Bsdf {
        &self.bsdf
    }

    /// Whether the Bsdf is another one at every hit.
    pub(crate) fn is_varying(&self) -> bool {
        self.varying.is_some()
    }

    /// Whether glossy lobes below this width or delta lobes scatter light.
    pub(crate) fn is_narrow(&self, narrow_below: f32) -> bool {
        self.anywhere(|bsdf| bsdf.parts(narrow_below).contains(Parts::NARROW))
    }

    /// Whether glossy lobes below this width scatter light.
    pub(crate) fn is_narrow_glossy(&self, narrow_below: f32) -> bool {
        self.anywhere(|bsdf| {
            let narrow = bsdf.part(Parts::NARROW, narrow_below);
            narrow.is_some_and(|narrow| narrow.lobes().intersects(Lobes::GLOSSY))
        })
    }

    /// Whether textures vary a material with diffuse lobes.
    pub(crate) fn is_textured_diffuse(&self) -> bool {
        self.varying.as_ref().is_some_and(|varying| varying.is_textured() && varying.lobes().have_diffuse())
    }

    /// Whether something holds for the Bsdf anywhere.
    fn anywhere(&self, holds: impl Fn(&Bsdf) -> bool) -> bool {
        match &self.varying {
            Some(varying) => varying.extremes().iter().any(holds),
            None => holds(&self.bsdf),
        }
    }

    /// The shading normal at a hit, where the material has its own.
    #[inline(always)]
    pub(crate) fn normal<'a>(&self, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> Option<Vec3> {
        let varying = self.varying.as_deref()?;
        own_normal(varying, detail)
    }

    /// The share of the irradiance that the diffuse lobes reflect at a hit, as a colour, on the outer and on the inner side.
    /// Other lobes give 0.
    pub fn diffuse_albedos<'a>(&self, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> [Rgb; 2] {
        let mut slot = None;
        let (bsdf, _) = self.at::<Rgb>(detail, &(), &mut slot);
        [true, false].map(|front| bsdf.on_side(front).diffuse_albedo())
    }

    /// Whether rays meet all surfaces of this material.
    pub fn is_opaque(&self) -> bool {
        self.opacity >= 1.0 && self.varying.as_ref().is_none_or(|varying| varying.is_opaque())
    }

    /// The probability with which a ray meets the surface at a hit, in [0, 1].
    pub fn opacity<'a>(&self, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> f32 {
        match &self.varying {
            Some(varying) if !varying.is_opaque() => self.opacity * varying.opacity(&detail(varying.asks_tangents())),
            _ => self.opacity,
        }
    }
}

#[cold]
#[inline(never)]
fn own_normal<'a>(varying: &dyn VaryingMaterial, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> Option<Vec3> {
    varying.has_normals().then(|| varying.normal(&detail(true)))
}

#[cold]
#[inline(never)]
fn ask<'a>(varying: &dyn VaryingMaterial, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> Bsdf {
    varying.bsdf(&detail(varying.asks_tangents()))
}

#[cold]
#[inline(never)]
fn ask_by_wavelength<'a>(varying: &dyn VaryingMaterial, detail: impl FnOnce(bool) -> SurfaceDetail<'a>) -> Bsdf {
    varying.bsdf_by_wavelength(&detail(varying.asks_tangents()))
}

/// What the materials of a scene need to know of a hit. What none of them needs is not computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaterialNeeds {
    /// Opacity, before a hit counts.
    pub opacity: bool,
    /// Footprints of rays.
    pub footprints: bool,
}

impl MaterialNeeds {
    pub(super) fn of(materials: &[Material]) -> Self {
        let mut varying = materials.iter().filter_map(|material| material.varying.as_deref());
        Self {
            opacity: materials.iter().any(|material| !material.is_opaque()),
            footprints: varying.any(VaryingMaterial::asks_footprint),
        }
    }
}
