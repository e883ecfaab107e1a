//! Reads the `render` block of the native format, and checks render settings.

use serde_json::value::RawValue;

use super::json::{self, Whole, join};
use super::render_block::{Bias, Integrator, Render, Sampler};
use super::{
    CropDesc, IntegratorDesc, MAX_SHADOW_RAYS, RenderDesc, SamplerDesc, filter, photon_keys, radiosity_keys, validate,
    white_balance,
};
use crate::Result;

/// Most samples per pixel, 2^31.
pub(super) const SAMPLE_LIMIT: u64 = 1 << 31;

/// Reads the `render` block. Settings that the block does not contain keep their values from `base`.
pub(super) fn read(raw: &RawValue, path: &str, base: &RenderDesc) -> Result<RenderDesc> {
    let block: Render<'_> = json::object(raw, path)?;
    let at = |key: &str| join(path, key);
    let mut render = base.clone();
    if let Some(resolution) = block.resolution {
        render.resolution = validate::resolution(&at("resolution"), resolution)?;
    }
    if let Some(crop) = block.crop {
        render.crop = crop.map(|crop| self::crop(&at("crop"), crop, render.resolution)).transpose()?;
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
    render.spectral = block.spectral.unwrap_or(render.spectral);
    if let Some(raw) = block.white_balance {
        render.white_balance = white_balance::read(raw, &at("whiteBalance"))?;
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
        integrator(raw, &at("integrator"), &mut render)?;
    }
    if let Some(seed) = block.seed {
        render.seed = seed.0;
    }
    render.photons = photon_keys::photons(&block, path, &base.photons)?;
    render.cache = photon_keys::cache(&block, path, &base.cache)?;
    render.radiosity = radiosity_keys::radiosity(&block, path, &base.radiosity)?;
    Ok(render)
}

impl RenderDesc {
    /// Whether the format could have given these numbers: the image's size and crop, samples, depth, shadow rays, filter,
    /// photon maps, irradiance cache and radiosity.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `render.resolution`, `render.crop`, `render.samples`, `render.filter.sigma` and so on.
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
        if let Some(CropDesc { left, top, width, height }) = self.crop {
            crop(&at("crop"), [left, top, width, height].map(whole), self.resolution)?;
        }
        validate::whole(&at("samples"), whole(self.samples), 1, SAMPLE_LIMIT)?;
        filter::check(&at("filter"), self.filter)?;
        if let Some(depth) = self.max_depth {
            max_depth(&at("maxDepth"), whole(depth))?;
        }
        shadow_rays(&at("shadowRays"), whole(self.shadow_rays))?;
        if let Some(count) = self.first_shadow_rays {
            shadow_rays(&at("integrator.firstShadowRays"), whole(count))?;
        }
        if let Some(white) = self.white_balance {
            white_balance::check(&at("whiteBalance"), white)?;
        }
        photon_keys::check_photons(path, &self.photons)?;
        photon_keys::check_cache(path, &self.cache)?;
        radiosity_keys::check_radiosity(path, &self.radiosity)
    }
}

/// Checks a rectangle of a picture: first column and row, width and height.
fn crop(path: &str, value: [Whole; 4], resolution: [u32; 2]) -> Result<CropDesc> {
    let [columns, rows] = resolution.map(u64::from);
    let at = |i: usize| format!("{path}[{i}]");
    let [x, y, w, h] = value;
    let left = validate::whole(&at(0), x, 0, columns.saturating_sub(1))?;
    let top = validate::whole(&at(1), y, 0, rows.saturating_sub(1))?;
    let width = validate::whole(&at(2), w, 1, columns - u64::from(left))?;
    let height = validate::whole(&at(3), h, 1, rows - u64::from(top))?;
    Ok(CropDesc { left, top, width, height })
}

/// Checks a greatest number of hits on a path.
pub(super) fn max_depth(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(u32::MAX))
}

/// Checks a number of light samples per hit.
pub(super) fn shadow_rays(path: &str, value: Whole) -> Result<u32> {
    validate::whole(path, value, 1, u64::from(MAX_SHADOW_RAYS))
}

/// Reads an integrator and its settings.
fn integrator(raw: &RawValue, path: &str, render: &mut RenderDesc) -> Result<()> {
    let names = IntegratorDesc::ALL.map(IntegratorDesc::name);
    let (name, block) = json::named(raw, path, &names)?;
    render.integrator = IntegratorDesc::from_name(&name).unwrap_or_default();
    (render.reuse, render.light_paths, render.first_shadow_rays, render.allow_bias) = (None, None, None, false);
    if block {
        let Integrator { reuse, light_paths, first_shadow_rays, bias, .. } = json::object(raw, path)?;
        (render.reuse, render.light_paths) = (reuse, light_paths);
        render.allow_bias = bias == Some(Bias::Allowed);
        let first = first_shadow_rays.map(|count| shadow_rays(&join(path, "firstShadowRays"), count));
        render.first_shadow_rays = first.transpose()?;
    }
    Ok(())
}
