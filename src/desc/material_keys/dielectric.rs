//! Keys of dielectrics: glass, smooth or rough, thin sheets of it, and coats of it over diffuse surfaces.

use super::super::builder::Builder;
use super::super::json::{Whole, join};
use super::super::numbers::{self, single, unless, unless_color};
use super::super::{
    BsdfDesc, Dispersion, MaterialDesc, MediumDesc, MicrofacetsDesc, TextureKey, ThinFilmDesc, material_check, validate,
};
use super::facets::FacetKeys;
use super::{Kind, SharedKeys, color, dispersion, film, keys, material, tags};
use crate::spectrum::Rgb;
use crate::{Error, Result};

material!(
    /// Clear glass, water and the like, smooth or rough.
    #[serde(rename_all = "camelCase")]
    Refractive, Refractive, facets, {
    /// Index of refraction inside, > 0. Required, or a `dispersion` that states it.
    refraction_index: Option<f64>,
    /// How the index depends on the wavelength, which only renders in wavelengths show: the Abbe number above 0; or the name of a
    /// medium, or the numbers of Sellmeier's formula, which state the index. Default: the same index for all wavelengths.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::dispersion::DispersionKeys>"))]
    dispersion: Option<Box<serde_json::value::RawValue>>,
    /// A thin film on the outer side, whose two faces reflect light that interferes. Default: none.
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::film::ThinFilm>"))]
    film: Option<Box<serde_json::value::RawValue>>,
    /// Index of refraction outside, > 0. Default 1. In a scene with `absorption`, `transmittance` or `priority` it only counts
    /// where the body lies in no other medium.
    exterior_index: Option<f64>,
    /// Absorption coefficient inside, 1 / scene unit, 0 or more per channel. Default [0, 0, 0].
    absorption: Option<[f64; 3]>,
    /// Instead of `absorption`: the share of light that is left after `transmittanceDistance`, above 0 and up to 1 per channel.
    transmittance: Option<[f64; 3]>,
    /// The distance after which `transmittance` is left, > 0.
    transmittance_distance: Option<f64>,
    /// Which medium fills the overlap of bodies: the one with the larger priority. Default 0.
    priority: Option<Whole>,
    /// Whether light that facets scatter more than once is made up for. Default true, except with `v-cavity`.
    multiple_scattering: Option<bool>,
});

material!(
    /// A thin sheet of clear or tinted glass, smooth or rough.
    #[serde(rename_all = "camelCase")]
    ThinRefractive, ThinRefractive, facets, {
    /// Index of refraction of the sheet, > 0.
    refraction_index: f64,
    /// Index of refraction around it, > 0. Default 1.
    exterior_index: Option<f64>,
    /// What is left of light that crossed the sheet once along its normal, [0, 1] per channel. Default [1, 1, 1].
    transmittance: Option<[f64; 3]>,
    /// Whether light that facets scatter more than once is made up for. Default true, except with `v-cavity`.
    multiple_scattering: Option<bool>,
});

material!(
    /// A diffuse surface under a clear coat, such as plastic.
    #[serde(rename_all = "camelCase")]
    CoatedDiffuse, CoatedDiffuse, facets, {
    /// Albedo of the diffuse surface, [0, 1] per channel.
    color: [f64; 3],
    /// Index of refraction of the coat, > 0. Default 1.5.
    refraction_index: Option<f64>,
    /// Index of refraction outside, > 0. Default 1.
    exterior_index: Option<f64>,
});

impl Refractive {
    /// The keys of glass with these indices inside and outside.
    pub(super) fn of(
        shared: SharedKeys,
        [ior, exterior_ior]: [f32; 2],
        microfacets: &MicrofacetsDesc,
        material: &MaterialDesc,
    ) -> Result<Self> {
        let facets = FacetKeys::of(microfacets);
        let medium = material.medium;
        let dispersion = material.dispersion.as_ref().map(dispersion::write).transpose()?;
        let film = material.film.as_ref().map(film::write).transpose()?;
        Ok(keys!(Self, tags::Refractive::Refractive, shared, facets facets, {
            refraction_index: Some(single(ior)),
            dispersion: dispersion,
            film: film,
            exterior_index: unless(single(exterior_ior), 1.0),
            absorption: medium.map(|medium| numbers::color(medium.absorption)),
            transmittance: None,
            transmittance_distance: None,
            priority: medium.map(|medium| Whole(medium.priority.into())),
            multiple_scattering: facets.multiple_scattering,
        }))
    }
}

impl ThinRefractive {
    /// The keys of a sheet with these indices inside and outside.
    pub(super) fn of(
        shared: SharedKeys,
        [ior, exterior_ior]: [f32; 2],
        transmittance: Rgb,
        microfacets: &MicrofacetsDesc,
    ) -> Self {
        let facets = FacetKeys::of(microfacets);
        keys!(Self, tags::ThinRefractive::ThinRefractive, shared, facets facets, {
            refraction_index: single(ior),
            exterior_index: unless(single(exterior_ior), 1.0),
            transmittance: unless_color(transmittance, Rgb::ONE),
            multiple_scattering: facets.multiple_scattering,
        })
    }
}

impl CoatedDiffuse {
    /// The keys of a coat with these indices inside and outside. Whether it makes up for light that its facets scatter more than
    /// once has no key, because it never does.
    pub(super) fn of(
        shared: SharedKeys,
        [ior, exterior_ior]: [f32; 2],
        albedo: Rgb,
        microfacets: &MicrofacetsDesc,
    ) -> Self {
        let facets = FacetKeys::of(microfacets);
        keys!(Self, tags::CoatedDiffuse::CoatedDiffuse, shared, facets facets, {
            color: numbers::color(albedo),
            refraction_index: Some(single(ior)),
            exterior_index: unless(single(exterior_ior), 1.0),
        })
    }
}

impl Kind for Refractive {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let stated = match self.dispersion(path)? {
            Some(dispersion) => dispersion.own_index(),
            None => None,
        };
        let Some(inside) = self.refraction_index.or(stated) else {
            let needs = if self.dispersion.is_some() { ", which an Abbe number needs" } else { "" };
            return Err(Error::invalid(path, format!("missing key `refractionIndex`{needs}")));
        };
        let [ior, exterior_ior] = indices(path, inside, self.exterior_index)?;
        let microfacets = self.facet_keys(self.multiple_scattering).read(path)?;
        let rough = BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets };
        // A parameter of facets that has a texture needs facets, even where the texture is a factor on 0.
        let is_of_facets = |name: &String| TextureKey::by_name(name).is_some_and(|key| !key.is_of_surface());
        let has_textures = self.textures.iter().flat_map(|textures| textures.keys()).any(is_of_facets);
        if microfacets.roughness == 0.0 && !has_textures {
            material_check::model(path, &rough, &[])?;
            return Ok(BsdfDesc::Dielectric { ior, exterior_ior });
        }
        Ok(rough)
    }

    fn medium(&self, path: &str) -> Result<Option<MediumDesc>> {
        medium(self, path)
    }

    fn dispersion(&self, path: &str) -> Result<Option<Dispersion>> {
        let read = |value: &serde_json::value::RawValue| dispersion::read(value, &join(path, "dispersion"));
        self.dispersion.as_deref().map(read).transpose()
    }

    fn film(&self, path: &str) -> Result<Option<ThinFilmDesc>> {
        self.film.as_deref().map(|value| film::read(value, &join(path, "film"))).transpose()
    }
}

impl Kind for ThinRefractive {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let [ior, exterior_ior] = indices(path, self.refraction_index, self.exterior_index)?;
        let transmittance = color(&join(path, "transmittance"), self.transmittance, 1.0)?;
        let microfacets = self.facet_keys(self.multiple_scattering).read(path)?;
        Ok(BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, microfacets })
    }
}

impl Kind for CoatedDiffuse {
    fn bsdf(&self, path: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        let [ior, exterior_ior] = indices(path, self.refraction_index.unwrap_or(1.5), self.exterior_index)?;
        let microfacets = self.facet_keys(Some(false)).read(path)?;
        let albedo = validate::reflectance(&join(path, "color"), self.color)?;
        Ok(BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, microfacets })
    }
}

/// The medium inside a body of glass; `None` where no key says anything of it.
fn medium(glass: &Refractive, path: &str) -> Result<Option<MediumDesc>> {
    let at = |key: &str| join(path, key);
    let absorption = match (glass.absorption, glass.transmittance, glass.transmittance_distance) {
        (Some(_), Some(_), _) => {
            let message = "the absorption is given twice, expected `absorption` or `transmittance`";
            return Err(Error::invalid(at("transmittance"), message));
        }
        (Some(absorption), None, None) => Some(validate::absorption(&at("absorption"), absorption)?),
        (None, Some(share), Some(distance)) => {
            Some(validate::transmittance([&at("transmittance"), &at("transmittanceDistance")], share, distance)?)
        }
        (None, Some(_), None) => {
            return Err(Error::invalid(path, "missing key `transmittanceDistance`, which `transmittance` needs"));
        }
        (_, None, Some(_)) => {
            return Err(Error::invalid(
                at("transmittanceDistance"),
                "only a material with `transmittance` has this key",
            ));
        }
        (None, None, None) => None,
    };
    let priority = match glass.priority {
        None => None,
        Some(priority) => Some(validate::whole(&at("priority"), priority, 0, u32::MAX.into())?),
    };
    if absorption.is_none() && priority.is_none() {
        return Ok(None);
    }
    Ok(Some(MediumDesc { absorption: absorption.unwrap_or(Rgb::ZERO), priority: priority.unwrap_or(0) }))
}

/// The indices of refraction inside and outside.
fn indices(path: &str, inside: f64, outside: Option<f64>) -> Result<[f32; 2]> {
    Ok([
        validate::positive(&join(path, "refractionIndex"), inside)? as f32,
        validate::positive(&join(path, "exteriorIndex"), outside.unwrap_or(1.0))? as f32,
    ])
}
