//! Descriptions of materials.

use super::{
    ConductorDesc, Dispersion, MicrofacetsDesc, PrincipledDesc, SpectrumDesc, SpectrumKey, TextureBinding, TextureKey,
    ThinFilmDesc,
};
use crate::spectrum::Rgb;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// The material's name.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// The scattering model and its parameters.
    pub bsdf: BsdfDesc,
    /// The survival probability of Russian roulette at this material in (0, 1], where the scene states one (the
    /// report's `reflectionRate`). Paths use it only with [`super::RouletteDesc::File`]. It changes noise and time, never the
    /// image.
    pub survival: Option<f32>,
    /// The medium inside bodies of this material; `None` for one that absorbs nothing and has priority 0. Only models that have an
    /// inside can have a medium: [`BsdfDesc::Dielectric`], [`BsdfDesc::RoughDielectric`], and a [`BsdfDesc::Principled`] one that
    /// transmits and is not thin, whose own absorption is added.
    pub medium: Option<MediumDesc>,
    /// How the index of refraction inside depends on the wavelength; `None` for one that does not. Only for
    /// [`BsdfDesc::Dielectric`] and [`BsdfDesc::RoughDielectric`].
    pub dispersion: Option<Dispersion>,
    /// A thin film on the outer side. Only for [`BsdfDesc::Dielectric`], [`BsdfDesc::RoughDielectric`] and [`BsdfDesc::Conductor`]; no
    /// texture varies the colours of a metal with a film.
    pub film: Option<ThinFilmDesc>,
    /// The probability with which a ray meets a surface of this material, in [0, 1]; other rays pass straight on. Only materials
    /// that are named by surfaces have an opacity, and parts of other materials have none.
    pub opacity: f32,
    /// Emitted radiance [W m^-2 sr^-1] on the normal's side of all surfaces of this material that have no emission of their own.
    /// The same materials as for [`Self::opacity`] can emit, and only opaque ones.
    pub emission: Option<Rgb>,
    /// The parameters that have spectra of their own, each at most once: renders in wavelengths use them, and others the colours of these
    /// spectra, which the parameters of `bsdf`, `medium` and `emission` become.
    pub spectra: Vec<(SpectrumKey, SpectrumDesc)>,
    /// The parameters that textures vary, each at most once. Textures that vary the normal or the opacity belong to materials that are
    /// named by surfaces, not to parts of other materials.
    pub textures: Vec<TextureBinding>,
}

impl Default for MaterialDesc {
    /// An opaque black material without a name.
    fn default() -> Self {
        Self {
            name: String::new(),
            path: String::new(),
            bsdf: BsdfDesc::Black,
            survival: None,
            medium: None,
            dispersion: None,
            film: None,
            opacity: 1.0,
            emission: None,
            spectra: Vec::new(),
            textures: Vec::new(),
        }
    }
}

impl MaterialDesc {
    /// A diffuse material without a name that reflects what a texture says.
    pub(super) fn textured_diffuse(texture: usize) -> Self {
        let (bsdf, textures) =
            (BsdfDesc::Lambert { albedo: Rgb::ONE }, vec![TextureBinding::whole(TextureKey::Color, texture)]);
        Self { bsdf, textures, ..Self::default() }
    }

    /// Whether rays meet all surfaces of this material.
    pub fn is_opaque(&self) -> bool {
        self.opacity >= 1.0 && self.textured(TextureKey::Opacity).is_none()
    }

    /// The spectrum that a parameter has of its own.
    pub fn spectrum(&self, key: SpectrumKey) -> Option<&SpectrumDesc> {
        self.spectra.iter().find(|(known, _)| *known == key).map(|(_, spectrum)| spectrum)
    }

    /// The texture that varies a parameter.
    pub fn textured(&self, key: TextureKey) -> Option<&TextureBinding> {
        self.textures.iter().find(|binding| binding.key == key)
    }

    /// What fills bodies of this material, whose parts are among `materials`; `None` for surfaces that have no inside.
    ///
    /// A mixture has the body of its parts. Where they have different ones, it is that of the first; scenes that follow media
    /// refuse such mixtures ([`Self::is_one_body`]).
    pub(crate) fn body(&self, materials: &[Self]) -> Option<Body> {
        let mut found = None;
        self.each_body(materials, &mut |body| {
            found.get_or_insert(body);
        });
        found
    }

    /// Whether all parts that have an inside have the same one.
    pub(crate) fn is_one_body(&self, materials: &[Self]) -> bool {
        let (mut first, mut is_one) = (None, true);
        self.each_body(materials, &mut |body| is_one &= *first.get_or_insert_with(|| body.clone()) == body);
        is_one
    }

    fn each_body(&self, materials: &[Self], each: &mut dyn FnMut(Body)) {
        if let BsdfDesc::Mix { materials: parts, weight } = self.bsdf {
            // A texture makes the weight anything from 0 to its own.
            let is_textured = self.textured(TextureKey::Weight).is_some();
            for (part, weight) in parts.into_iter().zip([1.0 - weight, weight]) {
                if let Some(material) = materials.get(part).filter(|_| weight > 0.0 || is_textured) {
                    material.each_body(&materials[..part], each);
                }
            }
            return;
        }
        let mut bsdf = self.bsdf;
        if let BsdfDesc::Principled(it) = &mut bsdf
            && self.textured(TextureKey::BaseMetalness).is_some()
        {
            // Where the texture is dark there is no metal.
            it.base_metalness = 0.0;
        }
        if let Some([ior, exterior_ior]) = bsdf.interior() {
            let MediumDesc { absorption, priority } = self.medium.unwrap_or_default();
            // That of a principled material comes from its own colour and depth.
            let own = match &bsdf {
                BsdfDesc::Principled(it) => it.absorption().unwrap_or(Rgb::ZERO),
                _ => Rgb::ZERO,
            };
            let medium = MediumDesc { absorption: absorption + own, priority };
            let absorption = self.spectra.iter().find(|(key, _)| *key == SpectrumKey::Absorption);
            let absorption = absorption.map(|(_, spectrum)| spectrum.clone());
            each(Body { ior, exterior_ior, medium, dispersion: self.dispersion, absorption });
        }
    }
}

/// What fills a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    /// Index of refraction.
    pub ior: f32,
    /// Index of refraction around it, where it lies in no other medium.
    pub exterior_ior: f32,
    /// Absorption and priority.
    pub medium: MediumDesc,
    /// How the index depends on the wavelength.
    pub dispersion: Option<Dispersion>,
    /// How the absorption does.
    pub absorption: Option<SpectrumDesc>,
}

impl Body {
    /// Whether the medium absorbs or has a priority.
    pub fn uses_medium(&self) -> bool {
        self.medium != MediumDesc::default()
    }
}

/// The medium inside bodies of a material, on the side opposite to the normal.
///
/// Where bodies overlap, the medium of the highest priority fills the overlap; among equal priorities, it is the medium that a
/// path entered last. Surfaces at which the medium does not change are not there for rays (Schmidt and Budge 2002, "Simple
/// Nested Dielectrics in Ray Traced Images").
///
/// If any material that a surface has has a medium other than the default, all materials that can have a medium have one, and the
/// index of refraction outside of a body is that of the medium around it. [`BsdfDesc::Dielectric`]'s `exterior_ior` then only
/// counts where the body lies in no other medium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MediumDesc {
    /// Absorption coefficient [1 / scene unit], >= 0 per channel: after a distance d, exp(-absorption d) of the light is left
    /// (the law of Beer and Lambert).
    pub absorption: Rgb,
    /// The priority; larger numbers win.
    pub priority: u32,
}

/// A scattering model and its parameters. Reflectances are in [0, 1] per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BsdfDesc {
    /// A surface that absorbs all light.
    Black,
    /// Lambert's model.
    Lambert {
        /// Albedo.
        albedo: Rgb,
    },
    /// Oren and Nayar's qualitative model (the report's equations 2 and 3).
    OrenNayarQualitative {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Standard deviation of the facets' slope angle, radians, >= 0.
        sigma: f32,
    },
    /// Fujii's improved Oren-Nayar model.
    OrenNayar {
        /// Albedo of the facets.
        albedo: Rgb,
        /// Fujii's roughness sigma' in [0, 1], which is not an angle.
        roughness: f32,
    },
    /// Perfect mirror.
    Mirror {
        /// Reflectance.
        reflectance: Rgb,
    },
    /// A smooth dielectric, which reflects by Fresnel's equations and refracts by Snell's law.
    Dielectric {
        /// Index of refraction on the side opposite to the normal, > 0.
        ior: f32,
        /// Index of refraction on the normal's side, > 0; 1 unless the object is inside another dielectric.
        exterior_ior: f32,
    },
    /// Portsmouth, Kutz and Hill's rough diffuse model, whose facets lose no light (EON).
    Eon {
        /// Albedo.
        albedo: Rgb,
        /// Roughness in [0, 1].
        roughness: f32,
    },
    /// A thin sheet that reflects and transmits light diffusely, such as paper or a leaf.
    DiffuseTransmission {
        /// The share of the light that is reflected.
        reflectance: Rgb,
        /// The share of the light that is transmitted; both shares sum to 1 at most.
        transmittance: Rgb,
    },
    /// Fibres that stand up from a surface, such as velvet (Estevez and Kulla 2017).
    Sheen {
        /// Colour of the fibres.
        color: Rgb,
        /// Roughness, in (0, 1].
        roughness: f32,
    },
    /// A metal, smooth or rough.
    Conductor {
        /// What its facets reflect.
        conductor: ConductorDesc,
        /// The facets.
        microfacets: MicrofacetsDesc,
    },
    /// A rough interface between two dielectrics, such as frosted glass; smooth where its roughness is 0.
    RoughDielectric {
        /// Index of refraction on the side opposite to the normal, > 0.
        ior: f32,
        /// Index of refraction on the normal's side, > 0.
        exterior_ior: f32,
        /// The facets.
        microfacets: MicrofacetsDesc,
    },
    /// A sheet of clear or tinted glass with parallel faces, smooth or rough, so thin that its faces count as one surface.
    ThinDielectric {
        /// Index of refraction of the sheet, > 0.
        ior: f32,
        /// Index of refraction on both sides of it, > 0.
        exterior_ior: f32,
        /// The share of the light that is left after it has crossed the sheet once along the normal.
        transmittance: Rgb,
        /// The facets, each of which is a thin sheet.
        microfacets: MicrofacetsDesc,
    },
    /// A diffuse surface under a clear smooth or rough coat, such as plastic or varnished wood. Light that bounces between the
    /// two is included.
    CoatedDiffuse {
        /// Albedo of the diffuse surface.
        albedo: Rgb,
        /// Index of refraction of the coat, > 0.
        ior: f32,
        /// Index of refraction outside, > 0.
        exterior_ior: f32,
        /// The facets of the coat.
        microfacets: MicrofacetsDesc,
    },
    /// One model with the parameters of OpenPBR, at which importers of other formats can aim.
    Principled(PrincipledDesc),
    /// A sum of two materials.
    Mix {
        /// Numbers of the materials, which come before this one.
        materials: [usize; 2],
        /// The share of the second, in [0, 1].
        weight: f32,
    },
    /// Different materials on the two sides of a surface.
    TwoSided {
        /// Number of the material on the normal's side.
        front: usize,
        /// Number of the material on the other side.
        back: usize,
    },
}

impl BsdfDesc {
    /// The kind of material, as files call it (`type`).
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Black => "black",
            Self::Lambert { .. } | Self::OrenNayarQualitative { .. } | Self::OrenNayar { .. } | Self::Eon { .. } => {
                "diffuse"
            }
            Self::Mirror { .. } => "reflective",
            Self::Dielectric { .. } | Self::RoughDielectric { .. } => "refractive",
            Self::DiffuseTransmission { .. } => "diffuse-transmission",
            Self::Sheen { .. } => "sheen",
            Self::Conductor { .. } => "conductor",
            Self::ThinDielectric { .. } => "thin-refractive",
            Self::CoatedDiffuse { .. } => "coated-diffuse",
            Self::Principled(_) => "principled",
            Self::Mix { .. } => "mix",
            Self::TwoSided { .. } => "two-sided",
        }
    }

    /// The indices of refraction inside and outside of a body with this surface; `None` for models that have no inside, whose
    /// materials can have no medium.
    pub(crate) fn interior(&self) -> Option<[f32; 2]> {
        match *self {
            Self::Dielectric { ior, exterior_ior } | Self::RoughDielectric { ior, exterior_ior, .. } => {
                Some([ior, exterior_ior])
            }
            Self::Principled(ref it) => it.has_inside().then_some([it.specular_ior, 1.0]),
            _ => None,
        }
    }
}
