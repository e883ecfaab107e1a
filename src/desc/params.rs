//! Reads parameter files of the report's renderer, the second argument of `mcrt`.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::json::{self, Whole, did_you_mean};
use super::warnings::warn;
use super::{
    IntegratorDesc, KernelDesc, PhotonDesc, PhotonSharing, RenderDesc, SamplerDesc, photon_keys, render_block,
    render_keys, validate,
};
use crate::{Error, Result};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Params<'a> {
    resolution: Option<[Whole; 2]>,
    #[serde(borrow)]
    supersamples: Option<&'a RawValue>,
    max_ray_depth: Option<Whole>,
    shadow_rays: Option<Whole>,
    photon_map: Option<f64>,
    scaling_factor: Option<[f64; 2]>,
    #[serde(borrow)]
    parallel_method: Option<&'a RawValue>,
    #[serde(borrow)]
    interpolation: Option<&'a RawValue>,
    #[serde(borrow)]
    progressive_rendering: Option<&'a RawValue>,
    #[serde(borrow)]
    record_statistics: Option<&'a RawValue>,
    photon_map_visualize: Option<f64>,
    photon_amount: Option<Whole>,
    photon_estimation_radius: Option<f64>,
    /// A key that only this library has, for scenes of `mcrt`, which have no `render` block.
    #[serde(default, deserialize_with = "json::name")]
    roulette: Option<render_block::Roulette>,
}

/// The number of photons that `mcrt` emits and the radius of its density estimates, where the file does not give them.
const PHOTONS: u32 = 1_000_000;
const RADIUS: f64 = 0.1;
/// The smallest number of photons that makes an estimate.
const MIN_PHOTONS: u32 = 10;

/// Overrides `render` with the values of the file. `points` says whether the scene has point lights.
pub(super) fn apply(json: &str, points: bool, render: &mut RenderDesc, warnings: &mut Vec<String>) -> Result<()> {
    let document = json::document(json)?;
    let params: Params<'_> = json::object_lenient(document, "", |key| {
        warn(warnings, format!("{}: unknown parameter, ignored", json::elided(&key)));
    })?;
    if let Some(resolution) = params.resolution {
        render.resolution = validate::resolution("resolution", resolution)?;
    }
    if let Some(raw) = params.supersamples {
        (render.samples, render.sampler) = supersamples(raw, "supersamples")?;
    }
    if let Some(depth) = params.max_ray_depth {
        render.max_depth = Some(render_keys::max_depth("maxRayDepth", depth)?);
    }
    if let Some(count) = params.shadow_rays {
        render.shadow_rays = render_keys::shadow_rays("shadowRays", count)?;
    }
    if let Some(roulette) = params.roulette {
        render.roulette = roulette.into();
    }
    let amount = params.photon_amount.map(|count| photon_keys::count("photonAmount", count)).transpose()?;
    let radius = params.photon_estimation_radius;
    radius.map(|radius| validate::radius("photonEstimationRadius", radius)).transpose()?;
    photon_map(params.photon_map.map(|on| on != 0.0), amount, radius, points, render);
    if params.photon_map_visualize.is_some_and(|on| on != 0.0) {
        let message =
            "photonMapVisualize: without effect here, `etendue photons` writes photons to a file or draws them";
        warn(warnings, message.to_owned());
    }
    if params.scaling_factor.is_some_and(|factor| factor != [1.0, 1.0]) {
        warn(warnings, "scalingFactor: not done, the image is written at its resolution".to_owned());
    }
    // These settings belong to a program around a renderer, and this library is not such a program.
    let ignored: Vec<&str> = [
        ("parallelMethod", params.parallel_method),
        ("interpolation", params.interpolation),
        ("progressiveRendering", params.progressive_rendering),
        ("recordStatistics", params.record_statistics),
    ]
    .into_iter()
    .filter_map(|(key, given)| given.map(|_| key))
    .collect();
    if !ignored.is_empty() {
        warn(warnings, format!("parameters without effect here: {}", ignored.join(", ")));
    }
    Ok(())
}

/// Applies the photon map of the report (`photonMap`, `photonAmount`, `photonEstimationRadius`), which has a cone
/// filter and shares photons by the area of the lights. Point lights have no area, and `mcrt` emits no photons from
/// them; in a scene with point lights, photons are shared by power instead.
fn photon_map(on: Option<bool>, amount: Option<u32>, radius: Option<f64>, points: bool, render: &mut RenderDesc) {
    match on {
        None => {}
        Some(false) if render.integrator == IntegratorDesc::PhotonDirect => render.integrator = IntegratorDesc::Path,
        Some(false) => {}
        Some(true) => {
            render.integrator = IntegratorDesc::PhotonDirect;
            render.photons = PhotonDesc {
                count: Some(PHOTONS),
                radius: Some(RADIUS),
                min_photons: MIN_PHOTONS,
                kernel: Some(KernelDesc::Cone { k: 1.0 }),
                neighbours: None,
                sharing: if points { PhotonSharing::Power } else { PhotonSharing::Area },
                ..render.photons.clone()
            };
        }
    }
    render.photons.count = amount.or(render.photons.count);
    render.photons.radius = radius.or(render.photons.radius);
}

/// Reads `[n, pattern]`, which means n * n samples per pixel.
fn supersamples(raw: &RawValue, path: &str) -> Result<(u32, SamplerDesc)> {
    let [n, pattern]: [&RawValue; 2] = json::value(raw, path)?;
    let at = format!("{path}[0]");
    // The largest n whose square is within the limit on samples.
    let n = validate::whole(&at, json::value(n, &at)?, 1, render_keys::SAMPLE_LIMIT.isqrt())?;
    let at = format!("{path}[1]");
    let pattern: String = json::value(pattern, &at)?;
    let sampler = match pattern.as_str() {
        "grid" => SamplerDesc::Grid,
        "rand" => SamplerDesc::Random,
        "norm" => SamplerDesc::Gaussian,
        other => {
            let known = ["grid", "rand", "norm"];
            let hint = did_you_mean(other, known);
            return Err(Error::invalid(
                at,
                format!("unknown pattern '{}', expected grid, rand or norm{hint}", json::elided(other)),
            ));
        }
    };
    Ok((n * n, sampler))
}
