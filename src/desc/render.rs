//! The `render` block of the native format.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::json::{self, Whole, did_you_mean, join};
use super::{FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc, validate};
use crate::{Error, Result};

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
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Filter>"))]
    filter: Option<&'a RawValue>,
    /// Greatest number of surface hits on a path, counting the first visible one; null cuts nothing. Default null.
    max_depth: Option<Whole>,
    /// Light samples per hit, from 1. Default 1.
    shadow_rays: Option<Whole>,
    /// Light transport. Default `path`.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<schema::Integrator>"))]
    integrator: Option<&'a RawValue>,
    /// Seed of all randomness. Default 0.
    seed: Option<Whole>,
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

/// What `filter` and `integrator` accept, for the schema.
#[cfg(feature = "schema")]
#[expect(dead_code, reason = "only the schema of these types is used")]
mod schema {
    #[derive(schemars::JsonSchema)]
    #[schemars(untagged)]
    pub enum Filter {
        /// Its name, with default parameters.
        Name(super::FilterName),
        /// Name and parameters.
        Block(FilterBlock),
    }

    #[derive(schemars::JsonSchema)]
    #[schemars(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
    pub enum FilterBlock {
        /// One pixel wide.
        Box,
        /// Triangle, radius 1 pixel.
        Tent,
        /// Cut at three standard deviations.
        Gaussian {
            /// Standard deviation, pixels, above 0 and up to 16. Default 0.5.
            sigma: Option<f64>,
        },
        /// Blackman-Harris window, radius 2 pixels.
        BlackmanHarris,
        /// Mitchell-Netravali, radius 2 pixels.
        Mitchell {
            /// B, in [0, 1]. Default 1/3.
            b: Option<f64>,
            /// C, in [0, 1]. Default 1/3.
            c: Option<f64>,
        },
    }

    #[derive(schemars::JsonSchema)]
    #[schemars(untagged)]
    pub enum Integrator {
        /// Its name.
        Name(super::IntegratorName),
        /// Its name, in an object.
        Block(IntegratorBlock),
    }

    #[derive(schemars::JsonSchema)]
    #[schemars(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
    pub enum IntegratorBlock {
        /// Everything.
        Path,
        /// Direct light, perfect mirrors and glass.
        Whitted,
        /// Emission and light scattered once.
        Direct,
    }
}

#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[expect(dead_code, reason = "only its schema is used")]
enum FilterName {
    Box,
    Tent,
    Gaussian,
    BlackmanHarris,
    Mitchell,
}

#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[expect(dead_code, reason = "only its schema is used")]
enum IntegratorName {
    Path,
    Whitted,
    Direct,
}

const FILTERS: [&str; 5] = ["box", "tent", "gaussian", "blackman-harris", "mitchell"];

/// A block that says its type and nothing else.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plain {
    #[serde(rename = "type")]
    _type: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Gaussian {
    #[serde(rename = "type")]
    _type: String,
    sigma: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mitchell {
    #[serde(rename = "type")]
    _type: String,
    b: Option<f64>,
    c: Option<f64>,
}

/// Reads the block.
pub(super) fn read(raw: &RawValue, path: &str) -> Result<RenderDesc> {
    let block: Render<'_> = json::object(raw, path)?;
    let at = |key: &str| join(path, key);
    let mut render = RenderDesc::default();
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
        render.filter = filter(raw, &at("filter"))?;
    }
    if let Some(depth) = block.max_depth {
        render.max_depth = Some(max_depth(&at("maxDepth"), depth)?);
    }
    if let Some(count) = block.shadow_rays {
        render.shadow_rays = shadow_rays(&at("shadowRays"), count)?;
    }
    if let Some(raw) = block.integrator {
        render.integrator = integrator(raw, &at("integrator"))?;
    }
    if let Some(seed) = block.seed {
        render.seed = seed.0;
    }
    Ok(render)
}

impl RenderDesc {
    /// Whether the format could have given these numbers: the image's size, samples, depth, shadow rays and filter.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `render.resolution`, `render.samples`, `render.filter.sigma` and so on.
    pub fn check(&self) -> Result<()> {
        let whole = |value: u32| Whole(u64::from(value));
        validate::resolution("render.resolution", self.resolution.map(whole))?;
        validate::whole("render.samples", whole(self.samples), 1, SAMPLE_LIMIT)?;
        match self.filter {
            FilterDesc::Gaussian { sigma } => gaussian("render.filter", sigma.into())?,
            FilterDesc::Mitchell { b, c } => mitchell("render.filter", b.into(), c.into())?,
            other => other,
        };
        if let Some(depth) = self.max_depth {
            max_depth("render.maxDepth", whole(depth))?;
        }
        shadow_rays("render.shadowRays", whole(self.shadow_rays)).map(|_| ())
    }
}

/// A greatest number of hits on a path.
pub(super) fn max_depth(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(u32::MAX))
}

/// A number of light samples per hit.
pub(super) fn shadow_rays(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(super::MAX_SHADOW_RAYS))
}

fn gaussian(path: &str, sigma: f64) -> Result<FilterDesc> {
    let at = join(path, "sigma");
    validate::positive(&at, sigma)?;
    Ok(FilterDesc::Gaussian { sigma: validate::within(&at, sigma, 0.0, 16.0)? })
}

fn mitchell(path: &str, b: f64, c: f64) -> Result<FilterDesc> {
    let within = |key: &str, value: f64| validate::within(&join(path, key), value, 0.0, 1.0);
    Ok(FilterDesc::Mitchell { b: within("b", b)?, c: within("c", c)? })
}

/// A name, or an object whose `type` is the name; says whether there is an object with more in it.
fn named(raw: &RawValue, path: &str, known: &[&str]) -> Result<(String, bool)> {
    if json::kind(raw.get()) != "a string" {
        return json::tag(raw, path, "type", known).map(|name| (name, true));
    }
    let name: String = json::value(raw, path)?;
    if known.contains(&name.as_str()) {
        return Ok((name, false));
    }
    let hint = did_you_mean(&name, known.iter().copied());
    Err(Error::invalid(
        path,
        format!("unknown name '{}', expected one of {}{hint}", json::elided(&name), known.join(", ")),
    ))
}

fn filter(raw: &RawValue, path: &str) -> Result<FilterDesc> {
    let (name, block) = named(raw, path, &FILTERS)?;
    match name.as_str() {
        "gaussian" => {
            let sigma = if block { json::object::<Gaussian>(raw, path)?.sigma } else { None }.unwrap_or(0.5);
            gaussian(path, sigma)
        }
        "mitchell" => {
            let (b, c) = if block {
                let given: Mitchell = json::object(raw, path)?;
                (given.b, given.c)
            } else {
                (None, None)
            };
            mitchell(path, b.unwrap_or(1.0 / 3.0), c.unwrap_or(1.0 / 3.0))
        }
        name => {
            if block {
                json::object::<Plain>(raw, path)?;
            }
            Ok(match name {
                "tent" => FilterDesc::Tent,
                "blackman-harris" => FilterDesc::BlackmanHarris,
                _ => FilterDesc::Box,
            })
        }
    }
}

fn integrator(raw: &RawValue, path: &str) -> Result<IntegratorDesc> {
    let names = IntegratorDesc::ALL.map(IntegratorDesc::name);
    let (name, block) = named(raw, path, &names)?;
    if block {
        json::object::<Plain>(raw, path)?;
    }
    Ok(IntegratorDesc::ALL.into_iter().find(|integrator| integrator.name() == name).unwrap_or_default())
}
