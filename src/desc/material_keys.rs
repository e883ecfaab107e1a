//! Reads materials of the native format.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, Whole, join};
use super::{
    BsdfDesc, ConductorDesc, Distribution, METALS, Masking, MaterialDesc, MediumDesc, Metal, MicrofacetsDesc,
    PrincipledDesc, material_check, validate,
};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// How a diffuse surface scatters.
#[derive(Clone, Copy, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Brdf {
    /// The same radiance in all directions.
    #[default]
    Lambertian,
    /// Fujii's improved Oren-Nayar model, by `roughness`.
    OrenNayar,
    /// Oren and Nayar's qualitative model, by `sigmaDeg`.
    OrenNayarQualitative,
    /// Portsmouth, Kutz and Hill's energy-preserving model, by `roughness`.
    Eon,
}

/// Scatters light in all directions.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Diffuse {
    name: String,
    #[serde(rename = "type")]
    _type: DiffuseTag,
    /// Albedo, [0, 1] per channel.
    color: [f64; 3],
    /// `lambertian` (default), `oren-nayar`, `oren-nayar-qualitative` or `eon`.
    #[serde(default, deserialize_with = "json::name")]
    brdf: Option<Brdf>,
    /// For `oren-nayar`: Fujii's sigma', in [0, 1]; for `eon`: roughness, in [0, 1].
    roughness: Option<f64>,
    /// For `oren-nayar-qualitative`: standard deviation of the facets' slope angle, degrees, in [0, 90].
    sigma_deg: Option<f64>,
    /// Russian roulette's survival probability, above 0 and up to 1, for renders with `"roulette": "file"`. Changes noise and
    /// time, never the image.
    reflection_rate: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum DiffuseTag {
    Diffuse,
}

/// A perfect mirror.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Reflective {
    name: String,
    #[serde(rename = "type")]
    _type: ReflectiveTag,
    /// Reflectance, [0, 1] per channel. Default [1, 1, 1].
    color: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ReflectiveTag {
    Reflective,
}

/// Clear glass, water and the like, smooth or rough.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Refractive {
    name: String,
    #[serde(rename = "type")]
    _type: RefractiveTag,
    /// Index of refraction inside, > 0.
    refraction_index: f64,
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
    /// Perceptual roughness in [0, 1]; its square is the width alpha of the facets. Default 0, a smooth surface.
    roughness: Option<f64>,
    /// How much narrower facets are spread across the tangent than along it, in [0, 0.99]. Default 0.
    anisotropy: Option<f64>,
    /// Angle from the tangent to the direction of the larger spread, degrees. Default 0.
    rotation: Option<f64>,
    /// `ggx` (default) or `beckmann`.
    #[serde(default, deserialize_with = "json::name")]
    distribution: Option<FacetDistribution>,
    /// `smith` (default), `smith-separable` or `v-cavity`.
    #[serde(default, deserialize_with = "json::name")]
    masking: Option<FacetMasking>,
    /// Whether light that facets scatter more than once is made up for. Default true, except with `v-cavity`.
    multiple_scattering: Option<bool>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum RefractiveTag {
    Refractive,
}

/// Absorbs everything.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Black {
    name: String,
    #[serde(rename = "type")]
    _type: BlackTag,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum BlackTag {
    Black,
}

/// The distribution of facets.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum FacetDistribution {
    /// Trowbridge and Reitz's, which has long tails.
    Ggx,
    /// Beckmann's: normally distributed slopes.
    Beckmann,
}

/// Which facets hide others.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum FacetMasking {
    /// Smith's, correlated by height.
    Smith,
    /// Smith's, for the two directions apart.
    SmithSeparable,
    /// Torrance and Sparrow's grooves.
    VCavity,
}

/// What a metal reflects: a metal's name, an index, or colours.
struct MetalKeys<'a> {
    metal: &'a Option<String>,
    eta: Option<[f64; 3]>,
    k: Option<[f64; 3]>,
    reflectance: Option<[f64; 3]>,
    edge_tint: Option<[f64; 3]>,
}

/// A metal, smooth or rough.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Conductor {
    name: String,
    #[serde(rename = "type")]
    _type: ConductorTag,
    /// Symbol of a measured metal: Ag, Al, Au, Cr, Cu, Fe, Hg, Ir, Ni, Rh, TiN or W.
    metal: Option<String>,
    /// Index of refraction per channel, > 0, instead of `metal`.
    eta: Option<[f64; 3]>,
    /// Extinction coefficient per channel, >= 0, with `eta`.
    k: Option<[f64; 3]>,
    /// Reflectance at normal incidence, [0, 1] per channel, instead of `metal`.
    reflectance: Option<[f64; 3]>,
    /// With `reflectance`: tint of the edge, [0, 1] per channel. Default [1, 1, 1].
    edge_tint: Option<[f64; 3]>,
    /// Perceptual roughness in [0, 1]; its square is the width alpha of the facets. Default 0, a smooth surface.
    roughness: Option<f64>,
    /// How much narrower facets are spread across the tangent than along it, in [0, 0.99]. Default 0.
    anisotropy: Option<f64>,
    /// Angle from the tangent to the direction of the larger spread, degrees. Default 0.
    rotation: Option<f64>,
    /// `ggx` (default) or `beckmann`.
    #[serde(default, deserialize_with = "json::name")]
    distribution: Option<FacetDistribution>,
    /// `smith` (default), `smith-separable` or `v-cavity`.
    #[serde(default, deserialize_with = "json::name")]
    masking: Option<FacetMasking>,
    /// Whether light that facets reflect more than once is made up for. Default true, except with `v-cavity`.
    multiple_scattering: Option<bool>,
}

/// Kinds of metals.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ConductorTag {
    /// Today's microfacet model.
    Conductor,
    /// Torrance and Sparrow 1967: facets in symmetric grooves.
    TorranceSparrow,
    /// Cook and Torrance 1982: Beckmann's facets in symmetric grooves.
    CookTorrance,
}

/// A thin sheet of clear or tinted glass.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct ThinRefractive {
    name: String,
    #[serde(rename = "type")]
    _type: ThinRefractiveTag,
    /// Index of refraction of the sheet, > 0.
    refraction_index: f64,
    /// Index of refraction around it, > 0. Default 1.
    exterior_index: Option<f64>,
    /// What is left of light that crossed the sheet once along its normal, [0, 1] per channel. Default [1, 1, 1].
    transmittance: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ThinRefractiveTag {
    ThinRefractive,
}

/// A diffuse surface under a clear coat, such as plastic.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct CoatedDiffuse {
    name: String,
    #[serde(rename = "type")]
    _type: CoatedDiffuseTag,
    /// Albedo of the diffuse surface, [0, 1] per channel.
    color: [f64; 3],
    /// Index of refraction of the coat, > 0. Default 1.5.
    refraction_index: Option<f64>,
    /// Index of refraction outside, > 0. Default 1.
    exterior_index: Option<f64>,
    /// Perceptual roughness of the coat in [0, 1]; its square is the width alpha of its facets. Default 0, a smooth coat.
    roughness: Option<f64>,
    /// How much narrower facets are spread across the tangent than along it, in [0, 0.99]. Default 0.
    anisotropy: Option<f64>,
    /// Angle from the tangent to the direction of the larger spread, degrees. Default 0.
    rotation: Option<f64>,
    /// `ggx` (default) or `beckmann`.
    #[serde(default, deserialize_with = "json::name")]
    distribution: Option<FacetDistribution>,
    /// `smith` (default) or `smith-separable`.
    #[serde(default, deserialize_with = "json::name")]
    masking: Option<FacetMasking>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum CoatedDiffuseTag {
    CoatedDiffuse,
}

/// Fibres that stand up from a surface that absorbs light.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Sheen {
    name: String,
    #[serde(rename = "type")]
    _type: SheenTag,
    /// Colour of the fibres, [0, 1] per channel.
    color: [f64; 3],
    /// Perceptual roughness, above 0 and up to 1. Default 0.5.
    roughness: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum SheenTag {
    Sheen,
}

/// A thin sheet that reflects and transmits diffusely.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct DiffuseTransmission {
    name: String,
    #[serde(rename = "type")]
    _type: DiffuseTransmissionTag,
    /// The share of the light that is reflected, [0, 1] per channel. Default [0, 0, 0].
    color: Option<[f64; 3]>,
    /// The share of the light that is transmitted, [0, 1] per channel; with `color` 1 at most.
    transmittance: [f64; 3],
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum DiffuseTransmissionTag {
    DiffuseTransmission,
}

/// Two materials, mixed.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Mix {
    name: String,
    #[serde(rename = "type")]
    _type: MixTag,
    /// Names of two materials that come before this one.
    materials: [String; 2],
    /// Share of the second, in [0, 1]. Default 0.5.
    weight: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum MixTag {
    Mix,
}

/// Different materials on the two sides of a surface.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct TwoSided {
    name: String,
    #[serde(rename = "type")]
    _type: TwoSidedTag,
    /// Name of the material on the normal's side, which comes before this one and does not transmit light.
    front: String,
    /// Name of the material on the other side.
    back: String,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum TwoSidedTag {
    TwoSided,
}

/// One model with the parameters of OpenPBR, in its names.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Principled {
    name: String,
    #[serde(rename = "type")]
    _type: PrincipledTag,
    /// Factor on `base_color`. Default 1.
    base_weight: Option<f64>,
    /// Colour of the diffuse part, and of the metal at normal incidence. Default [0.8, 0.8, 0.8].
    base_color: Option<[f64; 3]>,
    /// Roughness of the diffuse part. Default 0.
    base_diffuse_roughness: Option<f64>,
    /// Share of metal. Default 0.
    base_metalness: Option<f64>,
    /// Factor on the reflectance of metal and dielectric. Default 1.
    specular_weight: Option<f64>,
    /// Tint of the edge of the metal. Default [1, 1, 1].
    specular_color: Option<[f64; 3]>,
    /// Perceptual roughness of metal and dielectric. Default 0.3.
    specular_roughness: Option<f64>,
    /// In [0, 0.99]. Default 0.
    specular_roughness_anisotropy: Option<f64>,
    /// Degrees; a key that OpenPBR leaves to the tangent. Default 0.
    specular_rotation: Option<f64>,
    /// Index of refraction of the dielectric, > 0. Default 1.5.
    specular_ior: Option<f64>,
    /// Share of the dielectric that is clear. Default 0.
    transmission_weight: Option<f64>,
    /// Colour of what is left of light that enters and leaves. Default [1, 1, 1].
    transmission_color: Option<[f64; 3]>,
    /// Share of the surface that has a coat. Default 0.
    coat_weight: Option<f64>,
    /// Colour of what is left of light that passes the coat down and up. Default [1, 1, 1].
    coat_color: Option<[f64; 3]>,
    /// Perceptual roughness of the coat. Default 0.
    coat_roughness: Option<f64>,
    /// In [0, 0.99]. Default 0.
    coat_roughness_anisotropy: Option<f64>,
    /// Index of refraction of the coat, > 0. Default 1.6.
    coat_ior: Option<f64>,
    /// How much light that bounces under the coat darkens the base. Default 1.
    coat_darkening: Option<f64>,
    /// Share of the surface that is covered by fuzz. Default 0.
    fuzz_weight: Option<f64>,
    /// Colour of the fuzz. Default [1, 1, 1].
    fuzz_color: Option<[f64; 3]>,
    /// Perceptual roughness of the fuzz, above 0 and up to 1. Default 0.5.
    fuzz_roughness: Option<f64>,
    /// Whether the surface is a thin sheet, which refracts nothing. Default false. OpenPBR calls it `geometry_thin_walled`.
    thin_walled: Option<bool>,
    /// Whether light that facets scatter more than once is made up for. Default true.
    #[serde(rename = "multipleScattering")]
    multiple_scattering: Option<bool>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum PrincipledTag {
    Principled,
}

/// The kinds of materials, by `type`.
const KINDS: [&str; 14] = [
    "diffuse",
    "reflective",
    "refractive",
    "black",
    "conductor",
    "torrance-sparrow",
    "cook-torrance",
    "thin-refractive",
    "coated-diffuse",
    "sheen",
    "diffuse-transmission",
    "principled",
    "mix",
    "two-sided",
];

/// Reads one of `materials`.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let kind = json::tag(raw, path, "type", &KINDS)?;
    let mut inside = None;
    let (name, bsdf, survival) = match kind.as_str() {
        "diffuse" => diffuse(json::object(raw, path)?, path)?,
        "reflective" => {
            let mirror: Reflective = json::object(raw, path)?;
            let reflectance = validate::reflectance(&at("color"), mirror.color.unwrap_or([1.0; 3]))?;
            (mirror.name, BsdfDesc::Mirror { reflectance }, None)
        }
        "refractive" => {
            let glass: Refractive = json::object(raw, path)?;
            inside = medium(&glass, path)?;
            refractive(glass, path)?
        }
        "conductor" | "torrance-sparrow" | "cook-torrance" => conductor(json::object(raw, path)?, path)?,
        "thin-refractive" => {
            let sheet: ThinRefractive = json::object(raw, path)?;
            let [ior, exterior_ior] = indices(path, sheet.refraction_index, sheet.exterior_index)?;
            let transmittance = color(&at("transmittance"), sheet.transmittance, 1.0)?;
            (sheet.name, BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance }, None)
        }
        "coated-diffuse" => {
            let it: CoatedDiffuse = json::object(raw, path)?;
            let [ior, exterior_ior] = indices(path, it.refraction_index.unwrap_or(1.5), it.exterior_index)?;
            let microfacets =
                facets(path, [it.roughness, it.anisotropy, it.rotation], it.distribution, it.masking, Some(false))?;
            let albedo = validate::reflectance(&at("color"), it.color)?;
            (it.name, BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, microfacets }, None)
        }
        "sheen" => {
            let it: Sheen = json::object(raw, path)?;
            let color = validate::reflectance(&at("color"), it.color)?;
            let roughness = validate::number(&at("roughness"), it.roughness.unwrap_or(0.5))? as f32;
            (it.name, BsdfDesc::Sheen { color, roughness }, None)
        }
        "diffuse-transmission" => {
            let it: DiffuseTransmission = json::object(raw, path)?;
            let reflectance = color(&at("color"), it.color, 0.0)?;
            let transmittance = validate::reflectance(&at("transmittance"), it.transmittance)?;
            (it.name, BsdfDesc::DiffuseTransmission { reflectance, transmittance }, None)
        }
        "principled" => principled(json::object(raw, path)?, path)?,
        "mix" => {
            let it: Mix = json::object(raw, path)?;
            let [first, second] = &it.materials;
            let materials =
                [builder.material(&at("materials[0]"), first)?, builder.material(&at("materials[1]"), second)?];
            let weight = validate::within(&at("weight"), it.weight.unwrap_or(0.5), 0.0, 1.0)?;
            (it.name, BsdfDesc::Mix { materials, weight }, None)
        }
        "two-sided" => {
            let it: TwoSided = json::object(raw, path)?;
            let front = builder.material(&at("front"), &it.front)?;
            let back = builder.material(&at("back"), &it.back)?;
            (it.name, BsdfDesc::TwoSided { front, back }, None)
        }
        _ => (json::object::<Black>(raw, path)?.name, BsdfDesc::Black, None),
    };
    material_check::check(path, &bsdf, survival, &builder.scene.materials)?;
    if let Some(medium) = inside {
        material_check::medium(path, &bsdf, medium)?;
    }
    builder.scene.put_material(MaterialDesc { name, path: path.to_owned(), bsdf, survival, medium: inside }).map(|_| ())
}

/// A colour with a default for all channels.
fn color(path: &str, value: Option<[f64; 3]>, default: f64) -> Result<Rgb> {
    validate::reflectance(path, value.unwrap_or([default; 3]))
}

/// The indices of refraction inside and outside.
fn indices(path: &str, inside: f64, outside: Option<f64>) -> Result<[f32; 2]> {
    Ok([
        validate::positive(&join(path, "refractionIndex"), inside)? as f32,
        validate::positive(&join(path, "exteriorIndex"), outside.unwrap_or(1.0))? as f32,
    ])
}

/// Facets from roughness, anisotropy and rotation (degrees), and the names of their distribution and masking.
fn facets(
    path: &str,
    [roughness, anisotropy, rotation]: [Option<f64>; 3],
    distribution: Option<FacetDistribution>,
    masking: Option<FacetMasking>,
    multiple_scattering: Option<bool>,
) -> Result<MicrofacetsDesc> {
    let number = |key: &str, value: Option<f64>| validate::number(&join(path, key), value.unwrap_or(0.0));
    let masking = match masking {
        None | Some(FacetMasking::Smith) => Masking::Smith,
        Some(FacetMasking::SmithSeparable) => Masking::SmithSeparable,
        Some(FacetMasking::VCavity) => Masking::VCavity,
    };
    Ok(MicrofacetsDesc {
        roughness: validate::within(&join(path, "roughness"), roughness.unwrap_or(0.0), 0.0, 1.0)?,
        anisotropy: number("anisotropy", anisotropy)? as f32,
        rotation: number("rotation", rotation)?.to_radians() as f32,
        distribution: match distribution {
            None | Some(FacetDistribution::Ggx) => Distribution::Ggx,
            Some(FacetDistribution::Beckmann) => Distribution::Beckmann,
        },
        masking,
        multiple_scattering: multiple_scattering.unwrap_or(masking != Masking::VCavity),
    })
}

fn refractive(glass: Refractive, path: &str) -> Result<(String, BsdfDesc, Option<f32>)> {
    let [ior, exterior_ior] = indices(path, glass.refraction_index, glass.exterior_index)?;
    let numbers = [glass.roughness, glass.anisotropy, glass.rotation];
    let microfacets = facets(path, numbers, glass.distribution, glass.masking, glass.multiple_scattering)?;
    let bsdf = if microfacets.roughness == 0.0 {
        material_check::check(path, &BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets }, None, &[])?;
        BsdfDesc::Dielectric { ior, exterior_ior }
    } else {
        BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets }
    };
    Ok((glass.name, bsdf, None))
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

fn conductor(it: Conductor, path: &str) -> Result<(String, BsdfDesc, Option<f32>)> {
    let at = |key: &str| join(path, key);
    // The two historical models are named by what they fix.
    let (distribution, masking, multiple_scattering) = match it._type {
        ConductorTag::Conductor => (it.distribution, it.masking, it.multiple_scattering),
        ConductorTag::TorranceSparrow | ConductorTag::CookTorrance => {
            let fixed = [("masking", it.masking.is_some()), ("multipleScattering", it.multiple_scattering.is_some())];
            let is_beckmann = matches!(it._type, ConductorTag::CookTorrance);
            let fixed = fixed.into_iter().chain([("distribution", is_beckmann && it.distribution.is_some())]);
            if let Some((key, _)) = fixed.into_iter().find(|(_, given)| *given) {
                return Err(Error::invalid(at(key), "the model says this already; only type 'conductor' has this key"));
            }
            let distribution = if is_beckmann { Some(FacetDistribution::Beckmann) } else { it.distribution };
            (distribution, Some(FacetMasking::VCavity), None)
        }
    };
    let keys =
        MetalKeys { metal: &it.metal, eta: it.eta, k: it.k, reflectance: it.reflectance, edge_tint: it.edge_tint };
    let conductor = metal(keys, path)?;
    let numbers = [it.roughness, it.anisotropy, it.rotation];
    let microfacets = facets(path, numbers, distribution, masking, multiple_scattering)?;
    Ok((it.name, BsdfDesc::Conductor { conductor, microfacets }, None))
}

/// What the facets of a metal reflect, from one of three groups of keys.
fn metal(keys: MetalKeys<'_>, path: &str) -> Result<ConductorDesc> {
    let at = |key: &str| join(path, key);
    let vector = |key: &str, value: [f64; 3]| validate::vector(&at(key), value).map(Rgb::from_f64);
    match keys {
        MetalKeys { metal: Some(symbol), eta: None, k: None, reflectance: None, edge_tint: None } => {
            Metal::by_symbol(symbol).map(Metal::conductor).ok_or_else(|| {
                let known: Vec<&str> = METALS.iter().map(|metal| metal.symbol).collect();
                let message = format!("unknown metal '{}', expected one of {}", json::elided(symbol), known.join(", "));
                Error::invalid(at("metal"), message)
            })
        }
        MetalKeys { metal: None, eta: Some(eta), k: Some(k), reflectance: None, edge_tint: None } => {
            Ok(ConductorDesc::Index { eta: vector("eta", eta)?, k: vector("k", k)? })
        }
        MetalKeys { metal: None, eta: None, k: None, reflectance: Some(normal), edge_tint } => {
            let normal = validate::reflectance(&at("reflectance"), normal)?;
            Ok(ConductorDesc::Reflectance { normal, edge: color(&at("edgeTint"), edge_tint, 1.0)? })
        }
        _ => {
            let message = "expected one of: `metal`, `eta` with `k`, or `reflectance` with or without `edgeTint`";
            Err(Error::invalid(path, message))
        }
    }
}

fn principled(it: Principled, path: &str) -> Result<(String, BsdfDesc, Option<f32>)> {
    let default = PrincipledDesc::default();
    let number = |key: &str, value: Option<f64>, default: f32| match value {
        Some(value) => validate::number(&join(path, key), value).map(|value| value as f32),
        None => Ok(default),
    };
    let color = |key: &str, value: Option<[f64; 3]>, default: Rgb| match value {
        Some(value) => validate::reflectance(&join(path, key), value),
        None => Ok(default),
    };
    let rotation = number("specular_rotation", it.specular_rotation, 0.0)?.to_radians();
    let desc = PrincipledDesc {
        base_weight: number("base_weight", it.base_weight, default.base_weight)?,
        base_color: color("base_color", it.base_color, default.base_color)?,
        base_diffuse_roughness: number("base_diffuse_roughness", it.base_diffuse_roughness, 0.0)?,
        base_metalness: number("base_metalness", it.base_metalness, default.base_metalness)?,
        specular_weight: number("specular_weight", it.specular_weight, default.specular_weight)?,
        specular_color: color("specular_color", it.specular_color, default.specular_color)?,
        specular_roughness: number("specular_roughness", it.specular_roughness, default.specular_roughness)?,
        specular_roughness_anisotropy: number("specular_roughness_anisotropy", it.specular_roughness_anisotropy, 0.0)?,
        specular_rotation: rotation,
        specular_ior: number("specular_ior", it.specular_ior, default.specular_ior)?,
        transmission_weight: number("transmission_weight", it.transmission_weight, default.transmission_weight)?,
        transmission_color: color("transmission_color", it.transmission_color, default.transmission_color)?,
        coat_weight: number("coat_weight", it.coat_weight, default.coat_weight)?,
        coat_color: color("coat_color", it.coat_color, default.coat_color)?,
        coat_roughness: number("coat_roughness", it.coat_roughness, default.coat_roughness)?,
        coat_roughness_anisotropy: number("coat_roughness_anisotropy", it.coat_roughness_anisotropy, 0.0)?,
        coat_ior: number("coat_ior", it.coat_ior, default.coat_ior)?,
        coat_darkening: number("coat_darkening", it.coat_darkening, default.coat_darkening)?,
        fuzz_weight: number("fuzz_weight", it.fuzz_weight, default.fuzz_weight)?,
        fuzz_color: color("fuzz_color", it.fuzz_color, default.fuzz_color)?,
        fuzz_roughness: number("fuzz_roughness", it.fuzz_roughness, default.fuzz_roughness)?,
        thin_walled: it.thin_walled.unwrap_or(default.thin_walled),
        multiple_scattering: it.multiple_scattering.unwrap_or(default.multiple_scattering),
    };
    Ok((it.name, BsdfDesc::Principled(desc), None))
}

fn diffuse(diffuse: Diffuse, path: &str) -> Result<(String, BsdfDesc, Option<f32>)> {
    let at = |key: &str| join(path, key);
    let albedo = validate::reflectance(&at("color"), diffuse.color)?;
    let brdf = diffuse.brdf.unwrap_or_default();
    // A parameter of another model is an error, because the author was mistaken about which model is used.
    let misplaced = match brdf {
        Brdf::Lambertian => [("roughness", diffuse.roughness), ("sigmaDeg", diffuse.sigma_deg)],
        Brdf::OrenNayar | Brdf::Eon => [("sigmaDeg", diffuse.sigma_deg), ("", None)],
        Brdf::OrenNayarQualitative => [("roughness", diffuse.roughness), ("", None)],
    };
    if let Some((key, _)) = misplaced.into_iter().find(|(_, value)| value.is_some()) {
        let owner = if key == "roughness" { "'oren-nayar' or 'eon'" } else { "'oren-nayar-qualitative'" };
        return Err(Error::invalid(at(key), format!("only a material with brdf {owner} has this key")));
    }
    let needed = |key: &str, value: Option<f64>| {
        value.ok_or_else(|| Error::invalid(path, format!("missing key `{key}`, which this brdf needs")))
    };
    let bsdf = match brdf {
        Brdf::Lambertian => BsdfDesc::Lambert { albedo },
        Brdf::OrenNayar => {
            let roughness = needed("roughness", diffuse.roughness)?;
            BsdfDesc::OrenNayar { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
        }
        Brdf::Eon => {
            let roughness = needed("roughness", diffuse.roughness)?;
            BsdfDesc::Eon { albedo, roughness: validate::within(&at("roughness"), roughness, 0.0, 1.0)? }
        }
        Brdf::OrenNayarQualitative => {
            let degrees = needed("sigmaDeg", diffuse.sigma_deg)?;
            validate::within(&at("sigmaDeg"), degrees, 0.0, 90.0)?;
            BsdfDesc::OrenNayarQualitative { albedo, sigma: degrees.to_radians() as f32 }
        }
    };
    let survival = match diffuse.reflection_rate {
        None => None,
        Some(rate) => Some(validate::survival_rate(&at("reflectionRate"), rate)?),
    };
    Ok((diffuse.name, bsdf, survival))
}
