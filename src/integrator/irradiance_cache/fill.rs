//! Filling the cache: the image plane is sampled on grids of pixels, from coarse to fine.
//!
//! Each grid has half the spacing of the one before it. The camera ray of each grid point is followed to the first
//! diffuse hit. Where the existing records do not cover that hit, incident light is gathered for a new record.
//! Gathering happens in batches, and the threads share the sites of one batch. No site's membership in a batch depends
//! on another site of that batch, and the new records are added in the order of their sites. The records are therefore
//! the same for any number of threads.

use std::sync::{Arc, PoisonError, RwLock};

use super::super::SceneTracer;
use super::super::photon::Gather;
use super::cache::{CacheQuery, IrradianceCache};
use super::hemisphere::{Estimate, Strata};
use super::octree::GrowingOctree;
use super::record::{IrradianceRecord, MAX_WALLS, RecordSphere};
use super::site::{Site, first_diffuse_hits};
use crate::camera::Camera;
use crate::control::Parallel;
use crate::desc::{CacheDesc, RenderDesc};
use crate::error::Result;
use crate::math::{Frame, Vec3};
use crate::sampling::{SobolSampler, hash};
use crate::scene::Scene;

/// Spacing of the first grid [pixels].
const FIRST_SPACING: f64 = 16.0;

/// Most grid points that are processed at a time.
const MAX_GRID_POINTS: usize = 1 << 16;

/// Grid points that one task of the thread pool processes.
const GRID_POINTS_PER_TASK: usize = 1 << 9;

/// Sites whose light is gathered side by side.
const RECORDS_PER_BATCH: usize = 128;

/// The number of records is limited to one for this many pixels, within `RECORD_LIMITS`. A scene that needs more
/// records is rendered better by plain paths. A record takes a kilobyte at worst.
const PIXELS_PER_RECORD: usize = 8;
const RECORD_LIMITS: [usize; 2] = [1 << 12, 1 << 18];

/// Most entries in the leaves of the octree, for each record that is allowed.
const LISTINGS_PER_RECORD: usize = 24;

/// A site is covered where the best record has at least this weight. The threshold is above 0 so that records overlap:
/// at the rim of a record there is always another one.
const COVERED_WEIGHT: f32 = 0.3;

/// Allowed error and spacing of the coarse cache, in those of the fine cache.
const COARSE_FACTOR: f64 = 2.0;

/// The smallest radius of a record is at most this fraction of the largest radius.
const MIN_RADIUS_FRACTION: f32 = 0.25;

/// Salt of the seed, which separates these random numbers from those of other stages.
const SEED_SALT: u64 = 0x0069_7272_6164;

/// The point on the lens through which a grid point is followed, where the camera has one: any, so that the grid points together see
/// what the whole lens sees.
fn lens_point(grid_point: usize) -> [f32; 2] {
    let bits = hash(SEED_SALT, grid_point as u64);
    [bits >> 40, bits >> 8].map(|bits| (bits & 0xff_ffff) as f32 * 2.0_f32.powi(-24))
}

/// A cache that is being filled.
#[derive(Debug)]
pub(super) struct GrowingCache {
    pub octree: GrowingOctree,
    pub records: Vec<IrradianceRecord>,
    /// For each record, the smallest radius to which neighbour clamping may shrink it.
    min_radii: Vec<f32>,
    pub query: CacheQuery,
}

/// A record that was gathered at one site, before it is added.
struct NewRecord {
    site: Site,
    record: IrradianceRecord,
    radius: f32,
    min_radius: f32,
    rays: u64,
}

/// The settings of a fill and the light source of its gather rays.
#[derive(Clone)]
pub(super) struct CacheFiller {
    pub scene: Scene,
    pub camera: Camera,
    pub resolution: [u32; 2],
    pub seed: u64,
    pub cache: CacheDesc,
    pub source: Gather,
    /// Side of the cube around the scene.
    pub extent: f32,
    /// Number of rays after which filling is given up.
    pub most_rays: u64,
}

/// Cost and outcome of a fill.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FillStats {
    pub rays: u64,
    /// Whether filling stopped at the limit of records while sites were still uncovered.
    pub hit_record_limit: bool,
    /// Whether filling was given up at the limit of rays.
    pub hit_ray_limit: bool,
}

impl CacheFiller {
    pub fn new(scene: &Scene, camera: &Camera, desc: &RenderDesc, source: &Gather, extent: f32) -> Self {
        Self {
            scene: scene.clone(),
            camera: *camera,
            resolution: desc.resolution,
            seed: desc.seed ^ SEED_SALT,
            cache: desc.cache.clone(),
            source: source.clone(),
            extent,
            most_rays: u64::MAX,
        }
    }

    /// The settings of the coarse cache: fewer records, and fewer rays for each.
    pub fn coarse(&self) -> Self {
        let CacheDesc { error, rays, max_spacing, .. } = self.cache;
        let cache = CacheDesc {
            error: COARSE_FACTOR * error,
            rays: (rays / 4).max(16),
            max_spacing: (COARSE_FACTOR * max_spacing).min(1.0),
            ..self.cache.clone()
        };
        Self { cache, ..self.clone() }
    }

    /// Fills a cache from grids down to a spacing of `finest` pixels. `min` is the least corner of the cube around the
    /// scene.
    pub fn fill(self, min: Vec3, finest: f64, parallel: &mut impl Parallel) -> Result<(IrradianceCache, FillStats)> {
        let query = CacheQuery::new(self.cache.error as f32);
        let growing = GrowingCache {
            octree: GrowingOctree::new(min, self.extent),
            records: Vec::new(),
            min_radii: Vec::new(),
            query,
        };
        let growing = Arc::new(RwLock::new(growing));
        let filler = Arc::new(self);
        let mut stats = FillStats::default();
        let mut number = 0;
        let mut spacing = FIRST_SPACING.max(finest);
        while !(stats.hit_record_limit || stats.hit_ray_limit) {
            let [columns, rows] = filler.resolution.map(|n| ((f64::from(n) / spacing).ceil() as usize).max(1));
            for from in (0..columns * rows).step_by(MAX_GRID_POINTS) {
                let grid_points = from..(from + MAX_GRID_POINTS).min(columns * rows);
                let at = move |grid_point: usize| {
                    [grid_point % columns, grid_point / columns].map(|i| ((i as f64 + 0.5) * spacing) as f32)
                };
                let sites = filler.uncovered_sites(&growing, grid_points, at, &mut stats, parallel)?;
                filler.gather(&growing, sites, &mut number, &mut stats, parallel)?;
            }
            if spacing <= finest {
                break;
            }
            spacing = (0.5 * spacing).max(finest);
        }
        let growing = growing.read().unwrap_or_else(PoisonError::into_inner);
        Ok((growing.pack(), stats))
    }

    /// The sites behind some grid points that no record covers yet, in random order.
    fn uncovered_sites(
        self: &Arc<Self>,
        growing: &Arc<RwLock<GrowingCache>>,
        grid_points: std::ops::Range<usize>,
        at: impl Fn(usize) -> [f32; 2] + Send + Sync + 'static,
        stats: &mut FillStats,
        parallel: &mut impl Parallel,
    ) -> Result<Vec<Site>> {
        let (filler, growing) = (Arc::clone(self), Arc::clone(growing));
        let (start, end) = (grid_points.start, grid_points.end);
        let found = parallel.map((end - start).div_ceil(GRID_POINTS_PER_TASK), move |block| {
            let from = start + block * GRID_POINTS_PER_TASK;
            let mut tracer = SceneTracer::new(&filler.scene);
            let (mut sites, mut behind_pixel) = (Vec::new(), Vec::new());
            let growing = growing.read().unwrap_or_else(PoisonError::into_inner);
            for grid_point in from..(from + GRID_POINTS_PER_TASK).min(end) {
                let [x, y] = at(grid_point);
                let [width, height] = filler.resolution.map(|n| n as f32);
                if x >= width || y >= height {
                    continue;
                }
                let lens = lens_point(grid_point);
                first_diffuse_hits(&filler.scene, &filler.camera, [x, y], lens, &mut tracer, &mut behind_pixel);
                let uncovered = behind_pixel.drain(..).enumerate().filter(|(_, site)| !growing.is_covered(site));
                sites.extend(uncovered.map(|(branch, site)| (hash(grid_point as u64, branch as u64), site)));
            }
            (sites, tracer.rays)
        })?;
        let mut sites = Vec::new();
        for (block_sites, rays) in found {
            sites.extend(block_sites);
            stats.rays += rays;
        }
        sites.sort_by_key(|(order, _)| *order);
        Ok(sites.into_iter().map(|(_, site)| site).collect())
    }

    fn gather(
        self: &Arc<Self>,
        growing: &Arc<RwLock<GrowingCache>>,
        sites: Vec<Site>,
        number: &mut u32,
        stats: &mut FillStats,
        parallel: &mut impl Parallel,
    ) -> Result<()> {
        let mut waiting = std::collections::VecDeque::from(sites);
        while !waiting.is_empty() {
            if stats.rays > self.most_rays {
                stats.hit_ray_limit = true;
                return Ok(());
            }
            let mut batch: Vec<Site> = Vec::new();
            let mut later = Vec::new();
            {
                let growing = growing.read().unwrap_or_else(PoisonError::into_inner);
                let room = RECORDS_PER_BATCH.min(self.max_records().saturating_sub(growing.records.len()));
                if room == 0 {
                    stats.hit_record_limit = true;
                    return Ok(());
                }
                while batch.len() < room
                    && let Some(site) = waiting.pop_front()
                {
                    if growing.is_covered(&site) {
                        continue;
                    }
                    // Neighbouring sites would produce the same record. One of them waits until the radius of the other
                    // is known.
                    let near =
                        |other: &Site| other.n.dot(site.n) > 0.5 && other.p.distance(site.p) < self.min_radius(&site);
                    if batch.iter().any(near) { later.push(site) } else { batch.push(site) }
                }
            }
            later.into_iter().rev().for_each(|site| waiting.push_front(site));
            let (filler, first) = (Arc::clone(self), *number);
            let max_listings = LISTINGS_PER_RECORD * self.max_records();
            *number = number.wrapping_add(batch.len() as u32);
            let sites = Arc::new(batch);
            let count = sites.len();
            let records = parallel.map(count, move |i| filler.make_record(sites[i], first.wrapping_add(i as u32)))?;
            let mut growing = growing.write().unwrap_or_else(PoisonError::into_inner);
            for new in records {
                stats.rays += new.rays;
                growing.add(new, max_listings);
            }
        }
        Ok(())
    }

    /// Most records of this cache.
    pub fn max_records(&self) -> usize {
        let [width, height] = self.resolution.map(|n| n as usize);
        let [least, most] = RECORD_LIMITS;
        (width.saturating_mul(height) / PIXELS_PER_RECORD).clamp(least, most)
    }

    /// The smallest radius that a record at the site may have.
    fn min_radius(&self, site: &Site) -> f32 {
        // In a small image a few pixels may be as large as everything that is visible in them.
        (self.cache.min_spacing as f32 * site.pixel_size).min(MIN_RADIUS_FRACTION * self.max_radius())
    }

    fn max_radius(&self) -> f32 {
        self.cache.max_spacing as f32 * self.extent
    }

    fn make_record(&self, site: Site, number: u32) -> NewRecord {
        let mut tracer = SceneTracer::new(&self.scene);
        let estimate = self.estimate(&site, number, &mut tracer);
        let frame = Frame::from_normal(site.n);
        let (min_radius, max_radius) = (self.min_radius(&site), self.max_radius());
        // Ward's radius: the allowed error times the harmonic mean distance, or the distance that the gradient gives if
        // that is less.
        let error_radius = self.cache.error as f32 * estimate.mean_distance.min(estimate.doubling_distance());
        // The surroundings are dark, so nothing limits the radius.
        let error_radius = if error_radius.is_nan() { max_radius } else { error_radius };
        let radius = error_radius.max(min_radius).min(max_radius);
        // A record that is used farther away than its error radius must extrapolate less, so its gradient is scaled
        // down.
        let gradient_scale = (error_radius / radius).min(1.0);
        let (walls, reach) = site.walls(radius, &mut tracer);
        let record = IrradianceRecord::new(&estimate, &frame, gradient_scale, walls);
        NewRecord { site, record, radius: reach.max(1e-3 * radius), min_radius, rays: tracer.rays }
    }

    fn estimate(&self, site: &Site, number: u32, tracer: &mut SceneTracer) -> Estimate {
        let strata = Strata::new(self.cache.rays);
        let mut sampler = SobolSampler::new(self.seed, u32::MAX);
        strata.estimate(&site.gather(&self.source, strata, number, &mut sampler, tracer))
    }
}

impl GrowingCache {
    /// Whether the records cover a site, so that it needs none of its own.
    fn is_covered(&self, site: &Site) -> bool {
        self.octree.candidates(site.p).any(|sphere| {
            sphere.weight(site.p, site.n, self.query.inverse_error) >= COVERED_WEIGHT
                && self.records[sphere.record as usize].extrapolate(sphere, site.p, site.n).is_some()
        })
    }

    /// Adds a record; `max_listings` limits the entries of the octree. A distance to a surface changes no faster than
    /// the position does, so radii must not change faster either. Where a neighbour's radius violates that, one of the
    /// two records missed a surface that the other has seen, and the larger radius is clamped.
    ///
    /// Source: Křivánek et al. 2006, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and Neighbor
    /// Clamping", Sec. 4.
    fn add(&mut self, new: NewRecord, max_listings: usize) {
        let NewRecord { site, record, mut radius, min_radius, .. } = new;
        let slope = self.query.error.min(1.0);
        for number in self.octree.overlapping(site.p, radius) {
            let number = number as usize;
            let sphere = &self.octree.spheres()[number];
            let distance = sphere.position().distance(site.p);
            if sphere.normal().dot(site.n) < CLAMPING_COSINE || distance >= radius.max(sphere.radius()) {
                continue;
            }
            let other = sphere.radius();
            if radius > other + slope * distance {
                radius = (other + slope * distance).max(min_radius.min(radius));
            } else if other > radius + slope * distance {
                let least = self.min_radii[number].min(other);
                self.octree.shrink(number, (radius + slope * distance).max(least));
            }
        }
        let number = self.records.len() as u32;
        self.octree.add(RecordSphere::new(site.p, site.n, radius, number), max_listings);
        self.records.push(record);
        self.min_radii.push(min_radius);
    }

    /// The cache in its compact form for queries.
    pub fn pack(&self) -> IrradianceCache {
        IrradianceCache { octree: self.octree.pack(), records: self.records.clone(), query: self.query }
    }
}

/// Records clamp each other's radius only where the cosine of their normals is at least this.
const CLAMPING_COSINE: f32 = 0.5;

const _: () = assert!(MAX_WALLS == 2, "two walls are a corner's");
