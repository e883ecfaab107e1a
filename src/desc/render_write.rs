//! Writes the `render` block of the native format.

use serde_json::value::RawValue;

use super::json::Whole;
use super::numbers::unless;
use super::render_block::{Bias, Integrator, Render, Roulette, Sampler, Sharing, Solver, Source};
use super::save::raw;
use super::{
    CacheDesc, CacheSource, IntegratorDesc, PhotonDesc, PhotonSharing, RadiosityDesc, RadiositySolver, RenderDesc,
    RouletteDesc, SamplerDesc, filter, photon_keys, white_balance,
};
use crate::{Error, ErrorKind, Result};

/// Writes render settings, whose numbers have been checked: resolution, samples, sampler and integrator, and what differs from its
/// default.
pub(super) fn write(render: &RenderDesc) -> Result<Box<RawValue>> {
    let default = RenderDesc::default();
    let filter = filter::write(render.filter)?;
    let integrator = integrator(render)?;
    let kernel = render.photons.kernel.map(photon_keys::write_kernel).transpose()?;
    let white = white_balance::write(render.white_balance)?;
    let block = Render {
        resolution: Some(render.resolution.map(whole)),
        crop: render.crop.map(|it| Some([it.left, it.top, it.width, it.height].map(whole))),
        samples: Some(whole(render.samples)),
        sampler: Some(match render.sampler {
            SamplerDesc::Sobol => Sampler::Sobol,
            SamplerDesc::Random => Sampler::Random,
            SamplerDesc::Jittered => Sampler::Jittered,
            SamplerDesc::Grid => Sampler::Grid,
            SamplerDesc::Gaussian => Sampler::Gaussian,
        }),
        filter: (render.filter != default.filter).then_some(&*filter),
        spectral: flag(render.spectral, default.spectral),
        white_balance: white.as_deref(),
        max_depth: render.max_depth.map(|depth| Some(whole(depth))),
        shadow_rays: number(render.shadow_rays, default.shadow_rays),
        roulette: (render.roulette == RouletteDesc::File).then_some(Roulette::File),
        integrator: Some(&*integrator),
        seed: (render.seed != default.seed).then_some(Whole(render.seed)),
        photon_kernel: kernel.as_deref(),
        ..Render::default()
    };
    let block = with_photons(block, &render.photons);
    let block = with_cache(block, &render.cache);
    raw(&with_radiosity(block, &render.radiosity))
}

impl RenderDesc {
    /// The `render` block that a scene file has for these settings.
    pub(crate) fn to_value(&self) -> Result<serde_json::Value> {
        serde_json::from_str(write(self)?.get())
            .map_err(|error| Error::new(ErrorKind::Internal, format!("the settings are no JSON: {error}")))
    }
}

/// Writes an integrator: its name, or an object where it has settings that differ from their defaults.
fn integrator(render: &RenderDesc) -> Result<Box<RawValue>> {
    let name = IntegratorDesc::name(render.integrator);
    let bias = render.allow_bias.then_some(Bias::Allowed);
    match (render.reuse, render.light_paths, render.first_shadow_rays, bias) {
        (None, None, None, None) => raw(&name),
        (reuse, light_paths, first, bias) => {
            raw(&Integrator { name: name.to_owned(), reuse, light_paths, first_shadow_rays: first.map(whole), bias })
        }
    }
}

fn whole(value: u32) -> Whole {
    Whole(value.into())
}

fn number(value: u32, default: u32) -> Option<Whole> {
    (value != default).then(|| whole(value))
}

fn flag(value: bool, default: bool) -> Option<bool> {
    (value != default).then_some(value)
}

fn with_photons<'a>(block: Render<'a>, it: &PhotonDesc) -> Render<'a> {
    let default = PhotonDesc::default();
    Render {
        photon_count: it.count.map(whole),
        photon_radius: it.radius,
        min_photons: number(it.min_photons, default.min_photons),
        caustic_count: it.caustic_count.map(whole),
        caustic_radius: it.caustic_radius,
        photon_neighbours: it.neighbours.map(whole),
        photon_alpha: unless(it.alpha, default.alpha),
        photon_sharing: (it.sharing != default.sharing).then_some(match it.sharing {
            PhotonSharing::Power => Sharing::Power,
            PhotonSharing::Area => Sharing::Area,
        }),
        photons_guided: flag(it.guided, default.guided),
        photons_progressive: flag(it.progressive, default.progressive),
        gather_rays: number(it.gather_rays, default.gather_rays),
        photon_memory: number(it.memory, default.memory),
        ..block
    }
}

fn with_cache<'a>(block: Render<'a>, it: &CacheDesc) -> Render<'a> {
    let default = CacheDesc::default();
    Render {
        cache_error: unless(it.error, default.error),
        cache_rays: number(it.rays, default.rays),
        cache_min_spacing: unless(it.min_spacing, default.min_spacing),
        cache_max_spacing: unless(it.max_spacing, default.max_spacing),
        cache_source: (it.source != default.source).then_some(match it.source {
            CacheSource::Paths => Source::Paths,
            CacheSource::Photons => Source::Photons,
        }),
        ..block
    }
}

fn with_radiosity<'a>(block: Render<'a>, it: &RadiosityDesc) -> Render<'a> {
    let default = RadiosityDesc::default();
    Render {
        radiosity_element_size: it.element_size,
        radiosity_error: unless(it.error, default.error),
        radiosity_iterations: it.iterations.map(|count| Some(whole(count))),
        radiosity_tolerance: unless(it.tolerance, default.tolerance),
        radiosity_solver: (it.solver != default.solver).then_some(match it.solver {
            RadiositySolver::Gather => Solver::Gather,
            RadiositySolver::Shoot => Solver::Shoot,
        }),
        radiosity_ambient: flag(it.ambient, default.ambient),
        radiosity_final_gather: flag(it.final_gather, default.final_gather),
        radiosity_memory: number(it.memory, default.memory),
        ..block
    }
}
