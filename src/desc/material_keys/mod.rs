//! Reads and writes materials of the native format, a file for each family.

mod combined;
mod dielectric;
mod diffuse;
mod dispersion;
mod facets;
mod film;
mod metal;
mod principled;

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::numbers::{self, single, unless};
use super::save::{Names, raw};
use super::{
    BsdfDesc, Dispersion, MaterialDesc, MediumDesc, MicrofacetsDesc, SpectrumKey, ThinFilmDesc, material_check,
    photometric, spectrum_keys, texture_check, texture_keys, validate,
};
use crate::spectrum::Rgb;
use crate::{Error, Result};

pub(super) use combined::{Black, Mix, TwoSided};
pub(super) use dielectric::{CoatedDiffuse, Refractive, ThinRefractive};
use diffuse::Brdf;
pub(super) use diffuse::{Diffuse, DiffuseTransmission, Sheen};
pub(super) use metal::{Conductor, Reflective};
pub(super) use principled::Principled;

/// Declares the keys of one kind of material, after those that all kinds share: `material!(Name, Tag, { keys })`, or
/// `material!(Name, Tag, facets, { keys })` for a kind with the keys of facets as well.
macro_rules! material {
    ($(#[$meta:meta])* $name:ident, $tag:ident, facets, { $($keys:tt)* }) => {
        material! {
            $(#[$meta])* $name, $tag, {
                $($keys)*
                /// Perceptual roughness in [0, 1]; its square is the width alpha of the facets. Default 0, a smooth surface.
                roughness: Option<f64>,
                /// How much narrower facets are spread across the tangent than along it, in [0, 0.99]. Default 0.
                anisotropy: Option<f64>,
                /// Angle from the tangent to the direction of the larger spread, degrees. Default 0.
                rotation: Option<f64>,
                /// `ggx` (default) or `beckmann`.
                #[serde(default, deserialize_with = "crate::desc::json::name")]
                distribution: Option<super::facets::FacetDistribution>,
                /// `smith` (default), `smith-separable` or `v-cavity`.
                #[serde(default, deserialize_with = "crate::desc::json::name")]
                masking: Option<super::facets::FacetMasking>,
            }
        }

        impl $name {
            fn facet_keys(&self, multiple_scattering: Option<bool>) -> super::facets::FacetKeys {
                super::facets::FacetKeys {
                    numbers: [self.roughness, self.anisotropy, self.rotation],
                    distribution: self.distribution,
                    masking: self.masking,
                    multiple_scattering,
                }
            }
        }
    };
    ($(#[$meta:meta])* $name:ident, $tag:ident, { $($keys:tt)* }) => {
        #[derive(serde::Deserialize, serde::Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub(in crate::desc) struct $name {
            name: String,
            #[serde(rename = "type")]
            _type: super::tags::$tag,
            /// Probability with which a ray meets a surface of this material, in [0, 1]; other rays pass straight on. Default 1.
            opacity: Option<f64>,
            /// Emitted radiance on the normal's side, W/(m^2 sr) per channel, of all surfaces of this material that have no
            /// emission of their own. Default: none.
            emission: Option<[f64; 3]>,
            /// Luminance on the normal's side, cd/m^2, above 0, in place of `emission`. Default: none.
            luminance: Option<f64>,
            /// With `luminance`: colour temperature in kelvin, in [1000, 15000]: that of a Planckian radiator. Default: white.
            temperature: Option<f64>,
            /// Spectra of parameters of this material, by the names of the parameters: `color`, `transmittance`, `reflectance`, `eta`, `k`,
            /// `absorption` and `emission`. The value of the parameter is then that of its spectrum.
            #[cfg_attr(feature = "schema", schemars(with = "Option<std::collections::BTreeMap<String, crate::desc::spectrum_keys::Spectrum>>"))]
            spectra: Option<std::collections::BTreeMap<String, Box<serde_json::value::RawValue>>>,
            /// Textures that vary parameters of this material, by the names of the parameters: the name of a texture, or an object. The
            /// value of the parameter is then a factor on that of the texture.
            #[cfg_attr(feature = "schema", schemars(with = "Option<std::collections::BTreeMap<String, crate::desc::texture_keys::BindingOrName>>"))]
            textures: Option<std::collections::BTreeMap<String, Box<serde_json::value::RawValue>>>,
            $($keys)*
        }

        impl super::Shared for $name {
            fn shared(self) -> super::SharedKeys {
                super::SharedKeys {
                    name: self.name,
                    opacity: self.opacity,
                    emission: self.emission,
                    luminance: self.luminance,
                    temperature: self.temperature,
                    spectra: self.spectra,
                    textures: self.textures,
                }
            }
        }
    };
}
use material;

/// The keys of a kind of material: `keys!(Name, tag, shared keys, { keys })`, or with `facets` before the keys for a kind that has
/// those of facets.
macro_rules! keys {
    ($name:ident, $tag:expr, $shared:expr, facets $facets:expr, { $($field:ident: $value:expr,)* }) => {{
        let [roughness, anisotropy, rotation] = $facets.numbers;
        keys!($name, $tag, $shared, {
            $($field: $value,)*
            roughness: roughness,
            anisotropy: anisotropy,
            rotation: rotation,
            distribution: $facets.distribution,
            masking: $facets.masking,
        })
    }};
    ($name:ident, $tag:expr, $shared:expr, { $($field:ident: $value:expr,)* }) => {
        $name {
            name: $shared.name,
            _type: $tag,
            opacity: $shared.opacity,
            emission: $shared.emission,
            luminance: $shared.luminance,
            temperature: $shared.temperature,
            spectra: $shared.spectra,
            textures: $shared.textures,
            $($field: $value,)*
        }
    };
}
use keys;

/// The values of `type`, one type each so that the schema ties keys to kinds.
mod tags {
    macro_rules! tags {
        ($($tag:ident)*) => {$(
            #[derive(serde::Deserialize, serde::Serialize)]
            #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
            #[serde(rename_all = "kebab-case")]
            pub(in crate::desc) enum $tag {
                $tag,
            }
        )*};
    }
    tags!(Diffuse Reflective Refractive Black ThinRefractive CoatedDiffuse Sheen DiffuseTransmission Mix TwoSided);
    tags!(Principled);

    /// Kinds of metals.
    #[derive(serde::Deserialize, serde::Serialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
    #[serde(rename_all = "kebab-case")]
    pub(in crate::desc) enum Metal {
        /// Today's microfacet model.
        Conductor,
        /// Torrance and Sparrow 1967: facets in symmetric grooves.
        TorranceSparrow,
        /// Cook and Torrance 1982: Beckmann's facets in symmetric grooves.
        CookTorrance,
    }
}

/// The keys that all kinds of materials have.
struct SharedKeys {
    name: String,
    opacity: Option<f64>,
    emission: Option<[f64; 3]>,
    luminance: Option<f64>,
    temperature: Option<f64>,
    spectra: Option<BTreeMap<String, Box<RawValue>>>,
    textures: Option<BTreeMap<String, Box<RawValue>>>,
}

trait Shared {
    fn shared(self) -> SharedKeys;
}

/// The keys of one kind of material.
trait Kind: Shared + DeserializeOwned {
    /// The scattering model. `builder` finds the materials that this one names.
    fn bsdf(&self, path: &str, builder: &Builder<'_>) -> Result<BsdfDesc>;

    /// The stated probability of survival.
    fn survival(&self, _path: &str) -> Result<Option<f32>> {
        Ok(None)
    }

    /// The medium inside.
    fn medium(&self, _path: &str) -> Result<Option<MediumDesc>> {
        Ok(None)
    }

    /// How the index of refraction depends on the wavelength.
    fn dispersion(&self, _path: &str) -> Result<Option<Dispersion>> {
        Ok(None)
    }

    /// The film on the outer side.
    fn film(&self, _path: &str) -> Result<Option<ThinFilmDesc>> {
        Ok(None)
    }
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
    match json::tag(raw, path, "type", &KINDS)?.as_str() {
        "diffuse" => add::<diffuse::Diffuse>(raw, path, builder),
        "reflective" => add::<metal::Reflective>(raw, path, builder),
        "refractive" => add::<dielectric::Refractive>(raw, path, builder),
        "conductor" | "torrance-sparrow" | "cook-torrance" => add::<metal::Conductor>(raw, path, builder),
        "thin-refractive" => add::<dielectric::ThinRefractive>(raw, path, builder),
        "coated-diffuse" => add::<dielectric::CoatedDiffuse>(raw, path, builder),
        "sheen" => add::<diffuse::Sheen>(raw, path, builder),
        "diffuse-transmission" => add::<diffuse::DiffuseTransmission>(raw, path, builder),
        "principled" => add::<principled::Principled>(raw, path, builder),
        "mix" => add::<combined::Mix>(raw, path, builder),
        "two-sided" => add::<combined::TwoSided>(raw, path, builder),
        _ => add::<combined::Black>(raw, path, builder),
    }
}

fn add<K: Kind>(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let keys: K = json::object(raw, path)?;
    let medium = keys.medium(path)?;
    let dispersion = keys.dispersion(path)?;
    let film = keys.film(path)?;
    let bsdf = keys.bsdf(path, builder)?;
    let survival = keys.survival(path)?;
    let SharedKeys { name, opacity, emission, luminance, temperature, spectra, textures } = keys.shared();
    let spectra = spectrum_keys::of_material(spectra.as_ref(), path, builder)?;
    let textures = texture_keys::bindings(textures.as_ref(), path, builder)?;
    let opacity = validate::within(&join(path, "opacity"), opacity.unwrap_or(1.0), 0.0, 1.0)?;
    if temperature.is_some() && spectra.iter().any(|(key, _)| *key == SpectrumKey::Emission) {
        let message = "a spectrum of `emission` says the colour already, expected one of both";
        return Err(Error::invalid(join(path, "temperature"), message));
    }
    let emission = photometric::emission(path, emission, luminance, temperature, None)?;
    let path = path.to_owned();
    let mut material =
        MaterialDesc { name, path, bsdf, survival, medium, dispersion, film, opacity, emission, spectra, textures };
    material_check::check(&mut material, &builder.scene.materials)?;
    texture_check::bindings(&material, &builder.scene.textures, &builder.scene.materials)?;
    builder.scene.put_material(material).map(|_| ())
}

/// Writes a material whose parts and textures have these names. Its numbers have been checked.
pub(super) fn write(number: usize, material: &MaterialDesc, names: &Names) -> Result<Box<RawValue>> {
    let shared = SharedKeys {
        name: names.materials[number].clone(),
        opacity: unless(single(material.opacity), 1.0),
        emission: material.emission.map(numbers::color),
        luminance: None,
        temperature: None,
        spectra: spectrum_keys::write_of_material(&material.spectra)?,
        textures: texture_keys::write_bindings(&material.textures, names)?,
    };
    let name_of = |part: usize| names.materials[part].clone();
    let diffuse = |shared, albedo, model| raw(&Diffuse::of(shared, albedo, model, material.survival));
    match material.bsdf {
        BsdfDesc::Black => raw(&Black::of(shared)),
        BsdfDesc::Lambert { albedo } => diffuse(shared, albedo, None),
        BsdfDesc::OrenNayar { albedo, roughness } => diffuse(shared, albedo, Some((Brdf::OrenNayar, roughness))),
        BsdfDesc::Eon { albedo, roughness } => diffuse(shared, albedo, Some((Brdf::Eon, roughness))),
        BsdfDesc::OrenNayarQualitative { albedo, sigma } => {
            diffuse(shared, albedo, Some((Brdf::OrenNayarQualitative, sigma)))
        }
        BsdfDesc::Mirror { reflectance } => raw(&Reflective::of(shared, reflectance)),
        BsdfDesc::Dielectric { ior, exterior_ior } => {
            let smooth = MicrofacetsDesc::default();
            raw(&Refractive::of(shared, [ior, exterior_ior], &smooth, material)?)
        }
        BsdfDesc::RoughDielectric { ior, exterior_ior, ref microfacets } => {
            raw(&Refractive::of(shared, [ior, exterior_ior], microfacets, material)?)
        }
        BsdfDesc::DiffuseTransmission { reflectance, transmittance } => {
            raw(&DiffuseTransmission::of(shared, reflectance, transmittance))
        }
        BsdfDesc::Sheen { color, roughness } => raw(&Sheen::of(shared, color, roughness)),
        BsdfDesc::Conductor { ref conductor, ref microfacets } => {
            raw(&Conductor::of(shared, conductor, microfacets, material.film.as_ref())?)
        }
        BsdfDesc::ThinDielectric { ior, exterior_ior, transmittance, ref microfacets } => {
            raw(&ThinRefractive::of(shared, [ior, exterior_ior], transmittance, microfacets))
        }
        BsdfDesc::CoatedDiffuse { albedo, ior, exterior_ior, ref microfacets } => {
            raw(&CoatedDiffuse::of(shared, [ior, exterior_ior], albedo, microfacets))
        }
        BsdfDesc::Principled(ref it) => raw(&Principled::of(shared, it, material.medium)),
        BsdfDesc::Mix { materials, weight } => raw(&Mix::of(shared, materials.map(name_of), weight)),
        BsdfDesc::TwoSided { front, back } => raw(&TwoSided::of(shared, name_of(front), name_of(back))),
    }
}

/// A colour with a default for all channels.
fn color(path: &str, value: Option<[f64; 3]>, default: f64) -> Result<Rgb> {
    validate::reflectance(path, value.unwrap_or([default; 3]))
}

/// A colour that a material has to have, unless it has a spectrum of it, which says it later.
fn required(
    path: &str,
    key: &str,
    value: Option<[f64; 3]>,
    spectra: Option<&BTreeMap<String, Box<RawValue>>>,
) -> Result<Rgb> {
    match value {
        Some(value) => validate::reflectance(&join(path, key), value),
        None if spectra.is_some_and(|spectra| spectra.contains_key(key)) => Ok(Rgb::ONE),
        None => Err(Error::invalid(path, format!("missing key `{key}`"))),
    }
}
