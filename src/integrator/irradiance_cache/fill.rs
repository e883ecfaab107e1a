//! Filling: from the camera, coarse to fine.
//!
//! Grids of pixels, each of half the spacing of the one before, are followed to the first diffuse hit. Where the records so
//! far do not say enough, light is gathered: in batches, since the places of one batch are gathered side by side by
//! however many threads there are. Which places make a batch depends on none of them, and what they find is added in their
//! order, so that the records are the same for any number of threads.

use std::sync::{Arc, PoisonError, RwLock};

use super::super::SceneTracer;
use super::super::photon::Gather;
use super::hemisphere::{Estimate, Strata};
use super::record::{Ball, Record, WALLS};
use super::site::{Site, seen};
use super::tree::Growing;
use super::{Ask, IrradianceCache};
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::{CacheDesc, RenderDesc};
use crate::error::Result;
use crate::math::{Frame, Vec3};
use crate::sampling::{SobolSampler, hash};
use crate::scene::Scene;

/// Pixels between the looks of the first grid.
const FIRST_SPACING: f64 = 16.0;

/// Most looks that are held at a time.
const BAND: usize = 1 << 16;

/// Looks of one thread at a time.
const BLOCK: usize = 1 << 9;

/// Places that are gathered side by side.
const BATCH: usize = 128;

/// Most records: one for so many pixels, within these limits. Where it takes more, paths do better; a kilobyte each at worst.
const PIXELS_A_RECORD: usize = 8;
const MOST_RECORDS: [usize; 2] = [1 << 12, 1 << 18];

/// Most listings of records in the tree, for each record that is allowed.
const LISTINGS: usize = 24;

/// The weight that the best record must have where a place is left as it is: so that at the rim of a record there is
/// always another.
const ENOUGH: f32 = 0.3;

/// Allowed error and spacing of a coarse cache, in those of the fine one.
const COARSENESS: f64 = 2.0;

/// Smallest radius at most, in largest radii.
const LEAST_RANGE: f32 = 0.25;

/// The random numbers' family.
const FAMILY: u64 = 0x0069_7272_6164;

/// A cache that grows.
#[derive(Debug)]
pub(super) struct Grown {
    pub tree: Growing,
    pub records: Vec<Record>,
    /// Of each record: the smallest radius that others may shrink it to.
    floors: Vec<f32>,
    pub ask: Ask,
}

/// What one place found.
struct Found {
    site: Site,
    record: Record,
    radius: f32,
    floor: f32,
    rays: u64,
}

/// What filling needs to know.
#[derive(Clone)]
pub(super) struct Filling {
    pub scene: Scene,
    pub camera: Camera,
    pub resolution: [u32; 2],
    pub seed: u64,
    pub cache: CacheDesc,
    pub source: Gather,
    /// Side of the cube around the scene.
    pub extent: f32,
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spent {
    pub rays: u64,
    /// Whether there were more places than records are allowed.
    pub is_cut: bool,
}

impl Filling {
    pub fn new(scene: &Scene, camera: &Camera, desc: &RenderDesc, source: &Gather, extent: f32) -> Self {
        Self {
            scene: scene.clone(),
            camera: *camera,
            resolution: desc.resolution,
            seed: desc.seed ^ FAMILY,
            cache: desc.cache.clone(),
            source: source.clone(),
            extent,
        }
    }

    /// Of a cache of fewer records, each of fewer rays.
    pub fn coarse(&self) -> Self {
        let CacheDesc { error, rays, max_spacing, .. } = self.cache;
        let cache = CacheDesc {
            error: COARSENESS * error,
            rays: (rays / 4).max(16),
            max_spacing: (COARSENESS * max_spacing).min(1.0),
            ..self.cache.clone()
        };
        Self { cache, ..self.clone() }
    }

    /// Fills a cache with looks down to every `finest` pixels.
    pub fn fill(self, min: Vec3, finest: f64, parallel: &mut impl Parallel) -> Result<(IrradianceCache, Spent)> {
        let ask = Ask::new(self.cache.error as f32);
        let grown = Grown { tree: Growing::new(min, self.extent), records: Vec::new(), floors: Vec::new(), ask };
        let grown = Arc::new(RwLock::new(grown));
        let filling = Arc::new(self);
        let mut spent = Spent::default();
        let mut number = 0;
        let mut spacing = FIRST_SPACING.max(finest);
        while !spent.is_cut {
            let [columns, rows] = filling.resolution.map(|n| ((f64::from(n) / spacing).ceil() as usize).max(1));
            for from in (0..columns * rows).step_by(BAND) {
                let looks = from..(from + BAND).min(columns * rows);
                let at =
                    move |look: usize| [look % columns, look / columns].map(|i| ((i as f64 + 0.5) * spacing) as f32);
                let sites = filling.bare(&grown, looks, at, &mut spent, parallel)?;
                filling.gather(&grown, sites, &mut number, &mut spent, parallel)?;
            }
            if spacing <= finest {
                break;
            }
            spacing = (0.5 * spacing).max(finest);
        }
        let grown = grown.read().unwrap_or_else(PoisonError::into_inner);
        Ok((grown.pack(), spent))
    }

    /// The places behind some looks that need a record, in random order.
    fn bare(
        self: &Arc<Self>,
        grown: &Arc<RwLock<Grown>>,
        looks: std::ops::Range<usize>,
        at: impl Fn(usize) -> [f32; 2] + Send + Sync + 'static,
        spent: &mut Spent,
        parallel: &mut impl Parallel,
    ) -> Result<Vec<Site>> {
        let (filling, grown) = (Arc::clone(self), Arc::clone(grown));
        let (start, end) = (looks.start, looks.end);
        let found = parallel.map((end - start).div_ceil(BLOCK), move |block| {
            let from = start + block * BLOCK;
            let mut tracer = SceneTracer::new(&filling.scene);
            let (mut sites, mut one) = (Vec::new(), Vec::new());
            let grown = grown.read().unwrap_or_else(PoisonError::into_inner);
            for look in from..(from + BLOCK).min(end) {
                let [x, y] = at(look);
                let [width, height] = filling.resolution.map(|n| n as f32);
                if x >= width || y >= height {
                    continue;
                }
                seen(&filling.scene, &filling.camera, [x, y], &mut tracer, &mut one);
                let bare = one.drain(..).enumerate().filter(|(_, site)| !grown.is_enough(site));
                sites.extend(bare.map(|(way, site)| (hash(look as u64, way as u64), site)));
            }
            (sites, tracer.rays)
        })?;
        let mut sites = Vec::new();
        for (some, rays) in found {
            sites.extend(some);
            spent.rays += rays;
        }
        sites.sort_by_key(|(order, _)| *order);
        Ok(sites.into_iter().map(|(_, site)| site).collect())
    }

    fn gather(
        self: &Arc<Self>,
        grown: &Arc<RwLock<Grown>>,
        sites: Vec<Site>,
        number: &mut u32,
        spent: &mut Spent,
        parallel: &mut impl Parallel,
    ) -> Result<()> {
        let mut waiting = std::collections::VecDeque::from(sites);
        while !waiting.is_empty() {
            let mut batch: Vec<Site> = Vec::new();
            let mut later = Vec::new();
            {
                let grown = grown.read().unwrap_or_else(PoisonError::into_inner);
                let room = BATCH.min(self.most_records().saturating_sub(grown.records.len()));
                if room == 0 {
                    spent.is_cut = true;
                    return Ok(());
                }
                while batch.len() < room
                    && let Some(site) = waiting.pop_front()
                {
                    if grown.is_enough(&site) {
                        continue;
                    }
                    // Neighbours would find the same; one of them waits until it is known how far the other speaks.
                    let near = |other: &Site| other.n.dot(site.n) > 0.5 && other.p.distance(site.p) < self.floor(&site);
                    if batch.iter().any(near) { later.push(site) } else { batch.push(site) }
                }
            }
            later.into_iter().rev().for_each(|site| waiting.push_front(site));
            let (filling, first) = (Arc::clone(self), *number);
            let most = LISTINGS * self.most_records();
            *number = number.wrapping_add(batch.len() as u32);
            let sites = Arc::new(batch);
            let count = sites.len();
            let found = parallel.map(count, move |i| filling.found(sites[i], first.wrapping_add(i as u32)))?;
            let mut grown = grown.write().unwrap_or_else(PoisonError::into_inner);
            for found in found {
                spent.rays += found.rays;
                grown.add(found, most);
            }
        }
        Ok(())
    }

    /// Most records.
    pub fn most_records(&self) -> usize {
        let [width, height] = self.resolution.map(|n| n as usize);
        let [least, most] = MOST_RECORDS;
        (width.saturating_mul(height) / PIXELS_A_RECORD).clamp(least, most)
    }

    /// The smallest radius of a record there.
    fn floor(&self, site: &Site) -> f32 {
        // In a small image a few pixels may be as large as all that is seen in them.
        (self.cache.min_spacing as f32 * site.pixel).min(LEAST_RANGE * self.widest())
    }

    fn widest(&self) -> f32 {
        self.cache.max_spacing as f32 * self.extent
    }

    fn found(&self, site: Site, number: u32) -> Found {
        let mut tracer = SceneTracer::new(&self.scene);
        let estimate = self.estimate(&site, number, &mut tracer);
        let frame = Frame::from_normal(site.n);
        let (floor, widest) = (self.floor(&site), self.widest());
        // Ward's radius: the error over the mean distance, or what the gradient says if that is less.
        let wanted = self.cache.error as f32 * estimate.mean_distance.min(estimate.doubling_distance());
        // Dark all around: nothing limits it.
        let wanted = if wanted.is_nan() { widest } else { wanted };
        let radius = wanted.max(floor).min(widest);
        // A record that is used farther than it should be must not extrapolate as far.
        let fading = (wanted / radius).min(1.0);
        let (walls, reach) = site.walls(radius, &mut tracer);
        let record = Record::new(&estimate, &frame, fading, walls);
        Found { site, record, radius: reach.max(1e-3 * radius), floor, rays: tracer.rays }
    }

    fn estimate(&self, site: &Site, number: u32, tracer: &mut SceneTracer) -> Estimate {
        let strata = Strata::new(self.cache.rays);
        let mut sampler = SobolSampler::new(self.seed, u32::MAX);
        strata.estimate(&site.gather(&self.source, strata, number, &mut sampler, tracer))
    }
}

impl Grown {
    /// Whether a place needs no record.
    fn is_enough(&self, site: &Site) -> bool {
        self.tree.around(site.p).any(|ball| {
            ball.weight(site.p, site.n, self.ask.inverse_error) >= ENOUGH
                && self.records[ball.record as usize].at(ball, site.p, site.n).is_some()
        })
    }

    /// Adds a record; `most`: listings in the tree. Distances to surfaces change no faster than places do, and neither may radii: where a neighbour's is
    /// less than that allows, it has seen something that this record missed, or the other way round.
    ///
    /// Source: Křivánek et al. 2006, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and Neighbor
    /// Clamping", Sec. 4.
    fn add(&mut self, found: Found, most: usize) {
        let Found { site, record, mut radius, floor, .. } = found;
        let slope = self.ask.error.min(1.0);
        for number in self.tree.near(site.p, radius) {
            let number = number as usize;
            let ball = &self.tree.balls()[number];
            let distance = ball.position().distance(site.p);
            if ball.normal().dot(site.n) < SAME_SIDE || distance >= radius.max(ball.radius()) {
                continue;
            }
            let other = ball.radius();
            if radius > other + slope * distance {
                radius = (other + slope * distance).max(floor.min(radius));
            } else if other > radius + slope * distance {
                let least = self.floors[number].min(other);
                self.tree.shrink(number, (radius + slope * distance).max(least));
            }
        }
        let number = self.records.len() as u32;
        self.tree.add(Ball::new(site.p, site.n, radius, number), most);
        self.records.push(record);
        self.floors.push(floor);
    }

    /// The cache as it is.
    pub fn pack(&self) -> IrradianceCache {
        IrradianceCache { tree: self.tree.pack(), records: self.records.clone(), ask: self.ask }
    }
}

/// Cosine of the normals of records that clamp each other.
const SAME_SIDE: f32 = 0.5;

const _: () = assert!(WALLS == 2, "two walls are a corner's");
