//! The maps of a plan, from the wish for one to the map that can be queried.

use std::sync::{Arc, Mutex, PoisonError};

use super::super::estimate::MapQuery;
use super::super::gather::MapLayer;
use super::super::{MapKind, Photon, PhotonBatch, PhotonMap, Tally};
use crate::control::{Cancel, Parallel};
use crate::error::Result;
use crate::spectrum::Spectrum;

/// Number of photons of the caustic map beyond the first diffuse hit, and the factor by which its radius is wider.
const LATER_PHOTONS: usize = 1 << 14;
const LATER_WIDTH: f32 = 4.0;

/// A map that is to be shot, and the parameters of its queries.
pub(super) struct WantedMap {
    pub kind: MapKind,
    /// Number of light paths.
    pub paths: u32,
    pub query: MapQuery,
}

/// The photons of a map, not yet sorted.
pub(super) struct ShotMap<C: Spectrum> {
    pub wanted: WantedMap,
    /// Number of photons that the memory limit allows.
    pub most: usize,
    pub batch: PhotonBatch<C>,
}

/// A map that can be queried, and how it was made.
pub(super) struct BuiltMap<C: Spectrum> {
    pub kind: MapKind,
    /// Number of light paths that were asked for.
    pub paths: u32,
    /// Number of photons that the memory limit allows.
    pub most: usize,
    pub tally: Tally,
    pub layer: MapLayer<C>,
}

/// Builds the maps in parallel, each map on one thread.
pub(super) fn build_maps<C: Spectrum>(
    shot: Vec<ShotMap<C>>,
    shrunk: f32,
    parallel: &mut impl Parallel,
) -> Result<Vec<BuiltMap<C>>> {
    let mut photons = Vec::new();
    let mut made_of = Vec::new();
    for ShotMap { wanted, most, batch } in shot {
        photons.push(Mutex::new(batch.photons));
        made_of.push((wanted, most, batch.tally));
    }
    let token = parallel.token();
    let built = parallel.map(photons.len(), move |index| {
        let photons = std::mem::take(&mut *photons[index].lock().unwrap_or_else(PoisonError::into_inner));
        PhotonMap::build(photons, &token)
    })?;
    let mut maps = Vec::new();
    for ((WantedMap { kind, paths, query }, most, tally), map) in made_of.into_iter().zip(built) {
        let layer = MapLayer { map: Arc::new(map?), query, widest: query.radius / shrunk };
        maps.push(BuiltMap { kind, paths, most, tally, layer });
    }
    Ok(maps)
}

impl<C: Spectrum> BuiltMap<C> {
    pub fn is_of_indirect_light(&self) -> bool {
        matches!(self.kind, MapKind::Indirect | MapKind::Global)
    }

    /// The message about the map for the user; `by_pixel` says that each pixel has radii of its own.
    pub fn note(&self, by_pixel: bool) -> String {
        let Self { kind, tally, layer, .. } = self;
        let photons = layer.map.len();
        let shadows = if tally.shadows > 0 { format!(" and {} shadow photons", tally.shadows) } else { String::new() };
        let radius = if by_pixel && *kind != MapKind::Direct { "radius, at most," } else { "radius" };
        let lost = if tally.emitted.max_element() > 0.0 {
            100.0 * tally.escaped.max_element() / tally.emitted.max_element()
        } else {
            0.0
        };
        format!(
            "{} photon map: {} photons{shadows} of {} light paths, {lost:.0} % of their light left the scene; {:.1} MiB, {:.0} \
             bytes a photon; {radius} {:.3e}",
            kind.name(),
            tally.stored,
            tally.paths,
            layer.map.bytes() as f64 / 1_048_576.0,
            layer.map.bytes() as f64 / photons.max(1) as f64,
            layer.query.radius
        )
    }
}

/// The same light in fewer photons, for a wider radius: every n-th photon in the map's order, which keeps them well spread.
pub(super) fn thinned<C: Spectrum>(layer: &MapLayer<C>, cancel: &Cancel) -> Result<MapLayer<C>> {
    let stride = layer.map.len().div_ceil(LATER_PHOTONS).max(1);
    let mut photons: Vec<Photon<C>> = layer.map.photons().iter().skip(stride / 2).step_by(stride).copied().collect();
    let factor = layer.map.len() as f32 / photons.len().max(1) as f32;
    for photon in &mut photons {
        photon.scale(factor.into());
    }
    let map = Arc::new(PhotonMap::build(photons, cancel)?);
    let query = MapQuery { neighbours: None, ..layer.query };
    Ok(MapLayer { map, query, widest: LATER_WIDTH * layer.query.radius })
}
