//! Reads the settings of photon maps and of the irradiance cache in the `render` block, and checks the limits on their
//! numbers.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::json::{self, Plain, Whole, join};
use super::numbers::single;
use super::render_block::{Render, Sharing, Source};
use super::{
    CacheDesc, CacheSource, KernelDesc, MAX_GATHER_RAYS, MAX_NEIGHBOURS, MAX_PHOTON_MEMORY, MAX_PHOTONS, PhotonDesc,
    PhotonSharing, save, validate,
};
use crate::{Error, Result};

/// Smallest and greatest number.
type Limits = (u32, u32);

const COUNT: Limits = (1, MAX_PHOTONS);
const NEIGHBOURS: Limits = (0, MAX_NEIGHBOURS);
const GATHER_RAYS: Limits = (1, MAX_GATHER_RAYS);
const MEMORY: Limits = (1, MAX_PHOTON_MEMORY);
const CACHE_RAYS: Limits = (16, 1 << 20);

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Cone {
    #[serde(rename = "type")]
    _type: String,
    k: Option<f64>,
}

/// Reads the settings of photon maps. Settings that the block does not contain keep their values from `base`.
pub(super) fn photons(block: &Render<'_>, path: &str, base: &PhotonDesc) -> Result<PhotonDesc> {
    let at = |key: &str| join(path, key);
    let number =
        |key: &str, value: Option<Whole>, limits| value.map(|value| whole(&at(key), value, limits)).transpose();
    let (count_key, count) =
        either(path, ["photonCount", "photon_count"], [block.photon_count, block.photon_count_alias])?;
    let (radius_key, radius) =
        either(path, ["photonRadius", "photon_radius"], [block.photon_radius, block.photon_radius_alias])?;
    let (least_key, least) = either(path, ["minPhotons", "min_photons"], [block.min_photons, block.min_photons_alias])?;
    // The radius is checked here, where the key under which it was given is known.
    radius.map(|radius| validate::radius(&at(radius_key), radius)).transpose()?;
    let photons = PhotonDesc {
        count: number(count_key, count, COUNT)?.or(base.count),
        radius: radius.or(base.radius),
        min_photons: number(least_key, least, COUNT)?.unwrap_or(base.min_photons),
        caustic_count: number("causticCount", block.caustic_count, COUNT)?.or(base.caustic_count),
        caustic_radius: block.caustic_radius.or(base.caustic_radius),
        neighbours: number("photonNeighbours", block.photon_neighbours, NEIGHBOURS)?.or(base.neighbours),
        kernel: block.photon_kernel.map(|raw| kernel(raw, &at("photonKernel"))).transpose()?.or(base.kernel),
        alpha: block.photon_alpha.unwrap_or(base.alpha),
        sharing: block.photon_sharing.map_or(base.sharing, |sharing| match sharing {
            Sharing::Power => PhotonSharing::Power,
            Sharing::Area => PhotonSharing::Area,
        }),
        guided: block.photons_guided.unwrap_or(base.guided),
        progressive: block.photons_progressive.unwrap_or(base.progressive),
        gather_rays: number("gatherRays", block.gather_rays, GATHER_RAYS)?.unwrap_or(base.gather_rays),
        memory: number("photonMemory", block.photon_memory, MEMORY)?.unwrap_or(base.memory),
    };
    check_photons(path, &photons)?;
    Ok(photons)
}

/// Reads the settings of the irradiance cache. Settings that the block does not contain keep their values from `base`.
pub(super) fn cache(block: &Render<'_>, path: &str, base: &CacheDesc) -> Result<CacheDesc> {
    let rays = block.cache_rays.map(|rays| whole(&join(path, "cacheRays"), rays, CACHE_RAYS)).transpose()?;
    let cache = CacheDesc {
        error: block.cache_error.unwrap_or(base.error),
        rays: rays.unwrap_or(base.rays),
        min_spacing: block.cache_min_spacing.unwrap_or(base.min_spacing),
        max_spacing: block.cache_max_spacing.unwrap_or(base.max_spacing),
        source: block.cache_source.map_or(base.source, |source| match source {
            Source::Paths => CacheSource::Paths,
            Source::Photons => CacheSource::Photons,
        }),
    };
    check_cache(path, &cache)?;
    Ok(cache)
}

/// Checks that the format could have given these numbers. `path` is the path of the block.
pub(super) fn check_photons(path: &str, photons: &PhotonDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    let number = |key: &str, value: u32, limits| whole(&at(key), Whole(value.into()), limits).map(|_| ());
    let optional = |key: &str, value: Option<u32>, limits| value.map_or(Ok(()), |value| number(key, value, limits));
    let radius = |key: &str, value: Option<f64>| value.map_or(Ok(()), |value| validate::radius(&at(key), value));
    optional("photonCount", photons.count, COUNT)?;
    radius("photonRadius", photons.radius)?;
    number("minPhotons", photons.min_photons, COUNT)?;
    optional("causticCount", photons.caustic_count, COUNT)?;
    radius("causticRadius", photons.caustic_radius)?;
    optional("photonNeighbours", photons.neighbours, NEIGHBOURS)?;
    if photons.neighbours == Some(1) {
        // The farthest photon gives the radius and does not count, so an estimate of one photon would never find light.
        let message = format!("1 is out of range, expected 0 or from 2 to {MAX_NEIGHBOURS}");
        return Err(Error::invalid(at("photonNeighbours"), message));
    }
    if let Some(KernelDesc::Cone { k }) = photons.kernel {
        validate::cone(&at("photonKernel.k"), k.into())?;
    }
    validate::share(&at("photonAlpha"), photons.alpha)?;
    number("gatherRays", photons.gather_rays, GATHER_RAYS)?;
    number("photonMemory", photons.memory, MEMORY)
}

/// Checks that the format could have given these numbers. `path` is the path of the block.
pub(super) fn check_cache(path: &str, cache: &CacheDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    validate::up_to(&at("cacheError"), cache.error, 10.0)?;
    whole(&at("cacheRays"), Whole(cache.rays.into()), CACHE_RAYS)?;
    validate::up_to(&at("cacheMinSpacing"), cache.min_spacing, 1000.0)?;
    validate::up_to(&at("cacheMaxSpacing"), cache.max_spacing, 1.0)
}

/// Checks a number of light paths of a map.
pub(super) fn count(path: &str, value: Whole) -> Result<u32> {
    whole(path, value, COUNT)
}

fn whole(path: &str, value: Whole, (low, high): Limits) -> Result<u32> {
    validate::whole(path, value, low.into(), high.into())
}

/// A value that has two names, with the one under which it was given.
fn either<'a, T>(path: &str, keys: [&'a str; 2], values: [Option<T>; 2]) -> Result<(&'a str, Option<T>)> {
    match values {
        [Some(_), Some(_)] => {
            Err(Error::invalid(join(path, keys[1]), format!("the key is given twice, as `{}` too", keys[0])))
        }
        [None, Some(value)] => Ok((keys[1], Some(value))),
        [value, None] => Ok((keys[0], value)),
    }
}

fn kernel(raw: &RawValue, path: &str) -> Result<KernelDesc> {
    let (name, block) = json::named(raw, path, &["flat", "cone", "epanechnikov"])?;
    if name == "cone" {
        let k = if block { json::object::<Cone>(raw, path)?.k } else { None };
        return Ok(KernelDesc::Cone { k: validate::cone(&join(path, "k"), k.unwrap_or(1.0))? });
    }
    if block {
        json::object::<Plain>(raw, path)?;
    }
    Ok(if name == "flat" { KernelDesc::Flat } else { KernelDesc::Epanechnikov })
}

/// Writes a kernel, whose number has been checked.
pub(super) fn write_kernel(kernel: KernelDesc) -> Result<Box<RawValue>> {
    match kernel {
        KernelDesc::Flat => save::raw(&"flat"),
        KernelDesc::Epanechnikov => save::raw(&"epanechnikov"),
        KernelDesc::Cone { k } => save::raw(&Cone { _type: "cone".to_owned(), k: Some(single(k)) }),
    }
}
