//! The `render` block of the native format as it is written: its keys and the names that they accept.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::RouletteDesc;
use super::json::{self, Whole};

/// How to render; every key is optional.
#[derive(Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Render<'a> {
    /// Width and height, pixels. Default [256, 256].
    pub(super) resolution: Option<[Whole; 2]>,
    /// The rectangle of the picture that is rendered: first column, first row, width and height, pixels; null: all of it. Default
    /// null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<[Whole; 4]>"))]
    pub(super) crop: Option<Option<[Whole; 4]>>,
    /// Samples per pixel, from 1. Default 64.
    pub(super) samples: Option<Whole>,
    /// Positions of the samples of a pixel. Default `sobol`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) sampler: Option<Sampler>,
    /// Pixel filter. Default `box`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::filter::schema::Filter>"))]
    pub(super) filter: Option<&'a RawValue>,
    /// Whether paths carry wavelengths instead of three channels. Default false.
    pub(super) spectral: Option<bool>,
    /// The light under which white surfaces are grey in the picture: an illuminant's name, a temperature in kelvin, or its chromaticity x
    /// and y. Default `D65`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<super::white_balance::WhiteBalance>"))]
    pub(super) white_balance: Option<&'a RawValue>,
    /// Greatest number of surface hits on a path, counting the first visible one; null sets no limit. Default null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Whole>"))]
    pub(super) max_depth: Option<Option<Whole>>,
    /// Light samples per hit, from 1. Default 1.
    pub(super) shadow_rays: Option<Whole>,
    /// Survival probability by which Russian roulette ends paths. Default `own`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) roulette: Option<Roulette>,
    /// Light transport algorithm. Default `path`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Integrator>"))]
    pub(super) integrator: Option<&'a RawValue>,
    /// Seed of all random numbers. Default 0.
    pub(super) seed: Option<Whole>,

    /// Number of light paths of a photon map (of each pass, where maps are built for every pass), 1 to 2^29. Default: chosen by the
    /// integrator.
    pub(super) photon_count: Option<Whole>,
    /// Another name of `photonCount`.
    #[serde(rename = "photon_count")]
    pub(super) photon_count_alias: Option<Whole>,
    /// Radius of a density estimate, scene units, 1e-18 to 1e18; where the radius shrinks, this is the first one. Default: 0.1 for
    /// `photon_direct`, otherwise from the extent that a pixel sees.
    pub(super) photon_radius: Option<f64>,
    /// Another name of `photonRadius`.
    #[serde(rename = "photon_radius")]
    pub(super) photon_radius_alias: Option<f64>,
    /// For `photon_direct`: smallest number of photons within the radius that makes an estimate; shadow rays are sent where there
    /// are fewer; 1 to 2^29. Default 10.
    pub(super) min_photons: Option<Whole>,
    /// Another name of `minPhotons`.
    #[serde(rename = "min_photons")]
    pub(super) min_photons_alias: Option<Whole>,
    /// Number of light paths of the caustic map, 1 to 2^29. Default: chosen by the integrator.
    pub(super) caustic_count: Option<Whole>,
    /// Radius of density estimates in the caustic map, scene units, 1e-18 to 1e18. Default: from the extent that a pixel sees.
    pub(super) caustic_radius: Option<f64>,
    /// Number of nearest photons that make an estimate, without those beyond the radius, 2 to 65536; 0: all photons within the
    /// radius. Default: all photons within a radius, where each pixel has its own radius.
    pub(super) photon_neighbours: Option<Whole>,
    /// Kernel that weighs photons by their distance. Default: `cone` with `photon_direct`, otherwise `epanechnikov`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Kernel>"))]
    pub(super) photon_kernel: Option<&'a RawValue>,
    /// For `caustic`, `ppm` and `sppm`: share of the photons that is kept as radii shrink, above 0 and below 1. Default 2/3.
    pub(super) photon_alpha: Option<f64>,
    /// How the photons are divided between the emitters. Default `power`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) photon_sharing: Option<Sharing>,
    /// Whether caustic photons are aimed at the specular surfaces. Default true.
    pub(super) photons_guided: Option<bool>,
    /// Whether the map of `caustic` is built anew for every pass, with a shrinking radius. Default true.
    pub(super) photons_progressive: Option<bool>,
    /// For `photon`: number of rays of a final gather, 1 to 1024. Default 1.
    pub(super) gather_rays: Option<Whole>,
    /// Memory limit of all maps that exist at a time, MiB, 1 to 2^20. Default 4096.
    pub(super) photon_memory: Option<Whole>,
    /// For `irradiance_cache`: greatest error of Ward's estimate at which records are interpolated, above 0 and up to 10. Default
    /// 0.25.
    pub(super) cache_error: Option<f64>,
    /// For `irradiance_cache`: number of rays of a record's final gather, 16 to 2^20. Default 512.
    pub(super) cache_rays: Option<Whole>,
    /// For `irradiance_cache`: smallest distance over which a record is used, in pixels, above 0 and up to 1000. Default 3.
    pub(super) cache_min_spacing: Option<f64>,
    /// For `irradiance_cache`: greatest distance over which a record is used, as a share of the scene's extent, above 0 and up to
    /// 1. Default 0.1.
    pub(super) cache_max_spacing: Option<f64>,
    /// For `irradiance_cache`: source of the light that gather rays find. Default `paths`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) cache_source: Option<Source>,
    /// For `radiosity`: elements whose longest side is at most this long are not subdivided, scene units. Default: a 64th of the
    /// scene's extent.
    pub(super) radiosity_element_size: Option<f64>,
    /// For `radiosity`: greatest error of one link between elements, in thousandths of all irradiance, above 0 and up to 1000.
    /// Default 1.
    pub(super) radiosity_error: Option<f64>,
    /// For `radiosity`: number of iterations, 0 to 2^24; null: the iteration ends at `radiosityTolerance`. Default null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Whole>"))]
    pub(super) radiosity_iterations: Option<Option<Whole>>,
    /// For `radiosity`: fraction of the solution that may be missing when the iteration ends, above 0 and below 1. Default 0.0001.
    pub(super) radiosity_tolerance: Option<f64>,
    /// For `radiosity`: how the system is solved. Default `gather`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) radiosity_solver: Option<Solver>,
    /// For `radiosity`: whether the image of a solution that `radiosityIterations` has ended includes the mean of the light that
    /// was not yet distributed. Default false.
    pub(super) radiosity_ambient: Option<bool>,
    /// For `radiosity`: whether images take direct light from light samples and indirect light from one ray into the solution,
    /// instead of interpolating the solution. Default false.
    pub(super) radiosity_final_gather: Option<bool>,
    /// For `radiosity`: memory limit of elements and links, MiB, 1 to 2^20. Default 1024.
    pub(super) radiosity_memory: Option<Whole>,
}

/// An integrator with its settings, in an object.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Integrator {
    #[serde(rename = "type")]
    pub(super) name: String,
    /// See [`RenderDesc::reuse`](super::RenderDesc::reuse).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) reuse: Option<bool>,
    /// See [`RenderDesc::light_paths`](super::RenderDesc::light_paths).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) light_paths: Option<bool>,
    /// See [`RenderDesc::first_shadow_rays`](super::RenderDesc::first_shadow_rays).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) first_shadow_rays: Option<Whole>,
    /// See [`RenderDesc::allow_bias`](super::RenderDesc::allow_bias).
    #[serde(default, deserialize_with = "json::name", skip_serializing_if = "Option::is_none")]
    pub(super) bias: Option<Bias>,
}

/// Whether `auto` may choose an integrator with a bias.
#[derive(Clone, Copy, Deserialize, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Bias {
    /// It may not.
    Refused,
    /// It may.
    Allowed,
}

/// The positions of the samples of a pixel.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sampler {
    /// Owen-scrambled Sobol' points.
    Sobol,
    /// Independent random numbers.
    Random,
    /// One random position in each of n x n cells.
    Jittered,
    /// The centres of n x n cells.
    Grid,
    /// Normally distributed around the pixel's centre.
    Gaussian,
}

/// The survival probability by which Russian roulette ends paths. The choice changes noise and time, never the expected image.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Roulette {
    /// The library's own probability: a path survives in proportion to the throughput that it still carries.
    Own,
    /// The `reflectionRate` of the material, where the material has one.
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

/// How the photons are divided between the emitters.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sharing {
    /// By the emitters' power, so that all photons carry nearly the same power.
    Power,
    /// By the emitters' area, as in the report. Point lights have no area.
    Area,
}

/// The source of the light that the gather rays of an irradiance cache find.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Source {
    /// Gather rays continue as paths. The only bias is that of the interpolation.
    Paths,
    /// Gather rays read the global photon map. This is faster and has the bias of the map.
    Photons,
}

/// How a radiosity system is solved, in a file.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Solver {
    /// In each iteration, every element gathers light from all others.
    Gather,
    /// In each step, the body with most unshot light distributes it.
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
        /// Its name and settings.
        Block(IntegratorBlock),
    }

    #[derive(JsonSchema)]
    #[schemars(deny_unknown_fields, rename_all = "camelCase")]
    pub struct IntegratorBlock {
        /// Its name.
        r#type: IntegratorName,
        /// For `path`: whether pixels in groups of 16 share the second hits of their paths. Default: where a pilot says that it pays.
        reuse: Option<bool>,
        /// For `path`: whether light paths find caustics beside the paths from the camera. Default: where a pilot says that it pays.
        light_paths: Option<bool>,
        /// For `path`: number of light samples at the hits that the camera sees itself or by way of perfectly specular surfaces alone. Default: as many as
        /// at other hits, or more where a pilot says that it pays.
        #[schemars(range(min = 1, max = 1024))]
        first_shadow_rays: Option<u32>,
        /// For `auto`: whether the irradiance cache may be chosen, whose bias error estimates do not know. Default `refused`.
        bias: Option<super::Bias>,
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
        /// The same weight for all photons.
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
