//! Reads the `render` block of the native format.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::json::{self, Plain, Whole, join};
use super::{IntegratorDesc, RenderDesc, RouletteDesc, SamplerDesc, filter, photon_keys, radiosity, validate};
use crate::Result;

/// Most samples per pixel, 2^31.
pub(super) const SAMPLE_LIMIT: u64 = 1 << 31;

/// How to render; every key is optional.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Render<'a> {
    /// Width and height, pixels. Default [256, 256].
    resolution: Option<[Whole; 2]>,
    /// Samples per pixel, from 1. Default 64.
    samples: Option<Whole>,
    /// Where samples come from. Default `sobol`.
    #[serde(default, deserialize_with = "json::name")]
    sampler: Option<Sampler>,
    /// How samples weigh in a pixel. Default `box`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<filter::schema::Filter>"))]
    filter: Option<&'a RawValue>,
    /// Greatest number of surface hits on a path, counting the first visible one; null cuts nothing. Default null.
    #[serde(default, deserialize_with = "json::even_null")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Whole>"))]
    max_depth: Option<Option<Whole>>,
    /// Light samples per hit, from 1. Default 1.
    shadow_rays: Option<Whole>,
    /// Which survival probability Russian roulette ends paths by. Default `own`.
    #[serde(default, deserialize_with = "json::name")]
    roulette: Option<Roulette>,
    /// Light transport. Default `path`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Integrator>"))]
    integrator: Option<&'a RawValue>,
    /// Seed of all randomness. Default 0.
    seed: Option<Whole>,

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
    #[cfg_attr(feature = "schema", schemars(with = "Option<photon_keys::schema::Kernel>"))]
    pub(super) photon_kernel: Option<&'a RawValue>,
    /// Of `caustic`, `ppm` and `sppm`: the share of photons kept as radii shrink, above 0 and below 1. Default 2/3.
    pub(super) photon_alpha: Option<f64>,
    /// How emitters share the photons. Default `power`.
    #[serde(default, deserialize_with = "json::name")]
    pub(super) photon_sharing: Option<photon_keys::Sharing>,
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
    pub(super) cache_source: Option<photon_keys::Source>,
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
    pub(super) radiosity_solver: Option<radiosity::Solver>,
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
enum Sampler {
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

/// What `integrator` accepts, for the schema.
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
}

/// Reads the `render` block. Settings that the block does not contain keep their values from `base`.
pub(super) fn read(raw: &RawValue, path: &str, base: &RenderDesc) -> Result<RenderDesc> {
    let block: Render<'_> = json::object(raw, path)?;
    let at = |key: &str| join(path, key);
    let mut render = base.clone();
    if let Some(resolution) = block.resolution {
        render.resolution = validate::resolution(&at("resolution"), resolution)?;
    }
    if let Some(samples) = block.samples {
        render.samples = validate::whole(&at("samples"), samples, 1, SAMPLE_LIMIT)?;
    }
    if let Some(sampler) = block.sampler {
        render.sampler = match sampler {
            Sampler::Sobol => SamplerDesc::Sobol,
            Sampler::Random => SamplerDesc::Random,
            Sampler::Jittered => SamplerDesc::Jittered,
            Sampler::Grid => SamplerDesc::Grid,
            Sampler::Gaussian => SamplerDesc::Gaussian,
        };
    }
    if let Some(raw) = block.filter {
        render.filter = filter::read(raw, &at("filter"))?;
    }
    if let Some(depth) = block.max_depth {
        render.max_depth = depth.map(|depth| max_depth(&at("maxDepth"), depth)).transpose()?;
    }
    if let Some(count) = block.shadow_rays {
        render.shadow_rays = shadow_rays(&at("shadowRays"), count)?;
    }
    if let Some(roulette) = block.roulette {
        render.roulette = roulette.into();
    }
    if let Some(raw) = block.integrator {
        render.integrator = integrator(raw, &at("integrator"))?;
    }
    if let Some(seed) = block.seed {
        render.seed = seed.0;
    }
    render.photons = photon_keys::photons(&block, path, &base.photons)?;
    render.cache = photon_keys::cache(&block, path, &base.cache)?;
    render.radiosity = radiosity::radiosity(&block, path, &base.radiosity)?;
    Ok(render)
}

impl RenderDesc {
    /// Whether the format could have given these numbers: the image's size, samples, depth, shadow rays, filter,
    /// photon maps, irradiance cache and radiosity.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `render.resolution`, `render.samples`, `render.filter.sigma` and so on.
    pub fn check(&self) -> Result<()> {
        self.check_at("render")
    }

    /// The same; `path` is where the settings stand, for errors.
    ///
    /// This is the one check of a whole `RenderDesc`: [`crate::render::Render::new`], photon plans and the C interface call
    /// it. The reader of files calls the functions that it is made of, key by key.
    pub(crate) fn check_at(&self, path: &str) -> Result<()> {
        let at = |key: &str| join(path, key);
        let whole = |value: u32| Whole(u64::from(value));
        validate::resolution(&at("resolution"), self.resolution.map(whole))?;
        validate::whole(&at("samples"), whole(self.samples), 1, SAMPLE_LIMIT)?;
        filter::check(&at("filter"), self.filter)?;
        if let Some(depth) = self.max_depth {
            max_depth(&at("maxDepth"), whole(depth))?;
        }
        shadow_rays(&at("shadowRays"), whole(self.shadow_rays))?;
        photon_keys::check_photons(path, &self.photons)?;
        photon_keys::check_cache(path, &self.cache)?;
        radiosity::check_radiosity(path, &self.radiosity)
    }
}

/// Checks a greatest number of hits on a path.
pub(super) fn max_depth(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(u32::MAX))
}

/// Checks a number of light samples per hit.
pub(super) fn shadow_rays(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(super::MAX_SHADOW_RAYS))
}

fn integrator(raw: &RawValue, path: &str) -> Result<IntegratorDesc> {
    let names = IntegratorDesc::ALL.map(IntegratorDesc::name);
    let (name, block) = json::named(raw, path, &names)?;
    if block {
        json::object::<Plain>(raw, path)?;
    }
    Ok(IntegratorDesc::from_name(&name).unwrap_or_default())
}
