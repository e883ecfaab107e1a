//! The `render` block of the native format as it is written: its keys and the names that they accept.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::RouletteDesc;
use super::json::{self, Whole};

/// How to render; every key is optional.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Render<'a> {
    /// Width and height, pixels. Default [256, 256].
    pub(super) resolution: Option<[Whole; 2]>,
    /// Samples per pixel, from 1. Default 64.
    pub(super) samples: Option<Whole>,
    /// Where samples come from. Default `sobol`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) sampler: Option<Sampler>,
    /// How samples weigh in a pixel. Default `box`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::filter::schema::Filter>"))]
    pub(super) filter: Option<&'a RawValue>,
    /// Greatest number of surface hits on a path, counting the first visible one; null cuts nothing. Default null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Whole>"))]
    pub(super) max_depth: Option<Option<Whole>>,
    /// Light samples per hit, from 1. Default 1.
    pub(super) shadow_rays: Option<Whole>,
    /// Which survival probability Russian roulette ends paths by. Default `own`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) roulette: Option<Roulette>,
    /// Light transport. Default `path`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Integrator>"))]
    pub(super) integrator: Option<&'a RawValue>,
    /// Seed of all randomness. Default 0.
    pub(super) seed: Option<Whole>,

    /// Light paths of a photon map (of each pass, where maps are made anew), 1 to 2^29. Default: chosen by the integrator.
    pub(super) photon_count: Option<Whole>,
    /// `photonCount` in other words.
    #[serde(rename = "photon_count")]
    pub(super) photon_count_alias: Option<Whole>,
    /// Radius of a density estimate, scene units, 1e-18 to 1e18; where it shrinks, the first one. Default: 0.1
    /// for `photon_direct`, else from what a pixel sees.
    pub(super) photon_radius: Option<f64>,
    /// `photonRadius` in other words.
    #[serde(rename = "photon_radius")]
    pub(super) photon_radius_alias: Option<f64>,
    /// Of `photon_direct`: fewer photons than this within the radius are no estimate, and shadow rays are sent instead,
    /// 1 to 2^29. Default 10.
    pub(super) min_photons: Option<Whole>,
    /// `minPhotons` in other words.
    #[serde(rename = "min_photons")]
    pub(super) min_photons_alias: Option<Whole>,
    /// Light paths of a caustic map, 1 to 2^29. Default: chosen by the integrator.
    pub(super) caustic_count: Option<Whole>,
    /// Radius of caustics, scene units, 1e-18 to 1e18. Default: from what a pixel sees.
    pub(super) caustic_radius: Option<f64>,
    /// So many nearest photons make an estimate, those beyond the radius left out, 2 to 65536; 0: all within the
    /// radius. Default: all within a radius of each pixel's own.
    pub(super) photon_neighbours: Option<Whole>,
    /// How photons weigh by their distance. Default: `cone` with `photon_direct`, else `epanechnikov`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Kernel>"))]
    pub(super) photon_kernel: Option<&'a RawValue>,
    /// Of `caustic`, `ppm` and `sppm`: the share of photons kept as radii shrink, above 0 and below 1. Default 2/3.
    pub(super) photon_alpha: Option<f64>,
    /// How emitters share the photons. Default `power`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) photon_sharing: Option<Sharing>,
    /// Whether caustic photons are aimed at the specular surfaces. Default true.
    pub(super) photons_guided: Option<bool>,
    /// Whether the map of `caustic` is made anew for every pass, with a shrinking radius. Default true.
    pub(super) photons_progressive: Option<bool>,
    /// Of `photon`: rays of a final gather, 1 to 1024. Default 1.
    pub(super) gather_rays: Option<Whole>,
    /// Most memory of all maps at a time, MiB, 1 to 2^20. Default 4096.
    pub(super) photon_memory: Option<Whole>,
    /// Of `irradiance_cache`: greatest error that is allowed where records are interpolated, above 0 and up to 10.
    /// Default 0.25.
    pub(super) cache_error: Option<f64>,
    /// Of `irradiance_cache`: rays of a record's final gather, 16 to 2^20. Default 512.
    pub(super) cache_rays: Option<Whole>,
    /// Of `irradiance_cache`: smallest distance between records, pixels, above 0 and up to 1000. Default 3.
    pub(super) cache_min_spacing: Option<f64>,
    /// Of `irradiance_cache`: greatest distance over which a record is used, as a share of the scene's extent, above 0
    /// and up to 1. Default 0.1.
    pub(super) cache_max_spacing: Option<f64>,
    /// Of `irradiance_cache`: what the gather's rays bring back. Default `paths`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) cache_source: Option<Source>,
    /// Of `radiosity`: elements whose longest side is no longer than this are not divided any more, scene units. Default: a
    /// 64th of the extent of the scene.
    pub(super) radiosity_element_size: Option<f64>,
    /// Of `radiosity`: what one link between elements may be wrong by, in thousandths of all irradiance, above 0 and up to
    /// 1000. Default 1.
    pub(super) radiosity_error: Option<f64>,
    /// Of `radiosity`: iterations, 0 to 2^24; null: until what is left is below `radiosityTolerance`. Default null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Whole>"))]
    pub(super) radiosity_iterations: Option<Option<Whole>>,
    /// Of `radiosity`: share of the solution that may be left to iterate for, above 0 and below 1. Default 0.0001.
    pub(super) radiosity_tolerance: Option<f64>,
    /// Of `radiosity`: how the system is solved. Default `gather`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) radiosity_solver: Option<Solver>,
    /// Of `radiosity`: whether a solution stopped by `radiosityIterations` is shown with the mean of the light that was not
    /// yet distributed. Default false.
    pub(super) radiosity_ambient: Option<bool>,
    /// Of `radiosity`: whether pictures take indirect light from one ray into the solution at what the camera sees, and direct
    /// light from light samples. Default false.
    pub(super) radiosity_final_gather: Option<bool>,
    /// Of `radiosity`: most memory of elements and links, MiB, 1 to 2^20. Default 1024.
    pub(super) radiosity_memory: Option<Whole>,
}

/// Where the samples of a pixel come from.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sampler {
    /// Owen-scrambled Sobol' points.
    Sobol,
    /// Independent random numbers.
    Random,
    /// n x n cells, one random position in each.
    Jittered,
    /// n x n regular positions, cell centres.
    Grid,
    /// Normally distributed around the pixel's centre.
    Gaussian,
}

/// Which survival probability Russian roulette ends paths by. Changes noise and time, never the expected image.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Roulette {
    /// The library's own: a path survives in proportion to the throughput that it still carries.
    Own,
    /// The `reflectionRate` of the material that the path met, where that has one.
    File,
}

impl From<Roulette> for RouletteDesc {
    fn from(roulette: Roulette) -> Self {
        match roulette {
            Roulette::Own => Self::Own,
            Roulette::File => Self::File,
        }
    }
}

/// How emitters share the photons.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sharing {
    /// By their power, so that all photons carry nearly the same.
    Power,
    /// By their area, as in the report. Points have none.
    Area,
}

/// What the gather's rays of an irradiance cache bring back.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Source {
    /// The light of paths: no bias but the interpolation's.
    Paths,
    /// The light of the global photon map: faster, with its bias.
    Photons,
}

/// How a radiosity system is solved, in a file.
#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Solver {
    /// Every element gathers from all others, again and again.
    Gather,
    /// The body that has most light left shoots it.
    Shoot,
}

/// What `integrator` and `photonKernel` accept, for the schema.
#[cfg(feature = "schema")]
#[expect(dead_code, reason = "only the schema of these types is used")]
mod schema {
    use std::borrow::Cow;

    use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
    use serde_json::json;

    use crate::desc::IntegratorDesc;

    #[derive(JsonSchema)]
    #[schemars(untagged)]
    pub enum Integrator {
        /// Its name.
        Name(IntegratorName),
        /// Its name, in an object.
        Block(IntegratorBlock),
    }

    #[derive(JsonSchema)]
    #[schemars(deny_unknown_fields)]
    pub struct IntegratorBlock {
        /// Its name.
        r#type: IntegratorName,
    }

    /// One of the names in the table of integrators.
    pub struct IntegratorName;

    impl JsonSchema for IntegratorName {
        fn schema_name() -> Cow<'static, str> {
            "IntegratorName".into()
        }

        fn json_schema(_: &mut SchemaGenerator) -> Schema {
            let names = IntegratorDesc::ALL.map(|integrator| {
                let info = integrator.info();
                json!({"description": info.description, "type": "string", "const": info.name})
            });
            json_schema!({"oneOf": names})
        }
    }

    #[derive(JsonSchema)]
    #[schemars(untagged)]
    pub enum Kernel {
        /// Its name, with default parameters.
        Name(KernelName),
        /// Name and parameters.
        Block(KernelBlock),
    }

    #[derive(JsonSchema)]
    #[schemars(rename_all = "kebab-case")]
    pub enum KernelName {
        Flat,
        Cone,
        Epanechnikov,
    }

    #[derive(JsonSchema)]
    #[schemars(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
    pub enum KernelBlock {
        /// All photons weigh the same.
        Flat,
        /// 1 - d / (k r).
        Cone {
            /// k, 1 or more. Default 1.
            k: Option<f64>,
        },
        /// 1 - d^2 / r^2.
        Epanechnikov,
    }
}
