//! Where the surface covers the whole disk of an estimate's kernel.
//!
//! A kernel that reaches over an edge, into a corner or through a thin wall misses light or counts light from elsewhere,
//! which shows as dark seams and leaks. Before a map is read, small cells of space are therefore tested: does the surface
//! cover the disk around every point of the cell? Rays along the surface must meet no wall, and rays down onto the surface
//! from the disk's rim and from half way to the rim must meet it. Where the test fails, along edges and contacts, no density
//! is estimated. The path continues there instead, which is unbiased and costs a little noise in a narrow strip.
//!
//! A cell is tested at a photon in it or nearby, so cells far from photons do not count as covered either: where there are
//! hardly any photons, path tracing does better. The photons that choose the cells must not be those that are gathered.
//! Otherwise estimates would be made where there happen to be photons and paths followed where there happen to be none, and
//! this correlation would make the image too bright.

use std::collections::{HashMap, HashSet};
use std::f32::consts::TAU;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::Arc;

use super::super::{SceneTracer, Tracer as _};
use super::Photon;
use super::estimate::THICKNESS;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::{Frame, HitPoint, Ray, Vec3};
use crate::sampling::{hash, mix};
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// Cells per radius.
const FINENESS: f32 = 2.0;

/// Number of directions along the surface in which the test traces rays.
const DIRECTIONS: usize = 16;

/// Cells that one thread tests at a time.
const BLOCK: usize = 256;

/// Most cells of a level that are tested before a pass, so that a first picture appears soon.
const MOST_AT_ONCE: usize = 1 << 14;

/// Photons between two checks for cancellation.
const LOOK_UP: usize = 1 << 14;

/// Most cells of a level that are stored, at 16 bytes each.
const MOST: usize = 1 << 22;

/// Most cells that a level ever has: those and the neighbours of the last ones that were tested.
const MOST_STORED: usize = MOST + 10 * MOST_AT_ONCE;

/// Number of levels above the finest one that is asked for, each of twice the radius of the next. In the middle of a wall a
/// few large covered cells make tests of all smaller ones unnecessary.
const COARSER: i32 = 4;

/// Smallest radius that single precision resolves, as a share of the point's largest coordinate: 64 roundings. Which photons
/// a smaller disk holds would depend on rounding.
const RESOLUTION: f32 = 64.0 * f32::EPSILON;

/// Cells, and whether the surface covers the disks around their points, for a few radii.
#[derive(Clone, Debug, Default)]
pub(crate) struct DiskCoverage {
    /// Levels from the largest radius down, each of half the radius of the one before.
    levels: Vec<Arc<Level>>,
    /// The moment at which the surface is as it is known ([`Ray::time`]).
    time: f32,
}

/// The cells for disks of one radius.
#[derive(Clone, Debug)]
struct Level {
    radius: f32,
    cells: HashMap<u64, bool, BuildHasherDefault<Mixed>>,
}

/// A hasher that returns the key, since keys are hashes already.
#[derive(Clone, Copy, Debug, Default)]
struct Mixed(u64);

impl Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = mix(self.0 ^ u64::from(*byte));
        }
    }

    fn write_u64(&mut self, key: u64) {
        self.0 = key;
    }
}

impl DiskCoverage {
    /// Creates an empty record for disks up to `radius` at a moment ([`Ray::time`]); smaller disks are added by [`DiskCoverage::learn`].
    pub fn new(radius: f32, time: f32) -> Self {
        let level = |k| Arc::new(Level { radius: radius * 2.0_f32.powi(k), cells: HashMap::default() });
        Self { levels: (0..=COARSER).rev().map(level).collect(), time }
    }

    /// What is known, for a file: the moment, and the radius of each level with its cells in the order of their keys.
    pub fn parts(&self) -> (f32, impl Iterator<Item = (f32, Vec<(u64, bool)>)>) {
        let level = |level: &Arc<Level>| {
            let mut cells: Vec<(u64, bool)> = level.cells.iter().map(|(key, is_covered)| (*key, *is_covered)).collect();
            cells.sort_unstable();
            (level.radius, cells)
        };
        (self.time, self.levels.iter().map(level))
    }

    /// A record without cells, as [`DiskCoverage::parts`] names its levels.
    pub fn with_levels(time: f32, radii: impl Iterator<Item = f32>) -> Self {
        let level = |radius| Arc::new(Level { radius, cells: HashMap::default() });
        Self { levels: radii.map(level).collect(), time }
    }

    /// Adds cells to a level; `false` where memory is short, and where there would be more than are ever stored.
    pub fn add_cells(&mut self, level: usize, cells: impl ExactSizeIterator<Item = (u64, bool)>) -> bool {
        let Some(level) = self.levels.get_mut(level).map(Arc::make_mut) else { return false };
        let has_room = level.cells.len() + cells.len() <= MOST_STORED && level.cells.try_reserve(cells.len()).is_ok();
        if has_room {
            level.cells.extend(cells);
        }
        has_room
    }

    /// Whether the surface is known to cover the disk of this radius around `p` on the side `normal`.
    #[inline]
    pub fn is_covered(&self, p: Vec3, normal: Vec3, radius: f32) -> bool {
        if !is_resolved(p, radius) {
            return false;
        }
        for level in self.levels.iter().take_while(|level| level.radius >= radius) {
            match level.cells.get(&key(p, normal, level.radius)) {
                Some(true) => return true,
                Some(false) => {}
                None => return false,
            }
        }
        false
    }

    /// Tests the cells of photons that have not been tested before, down to disks of this radius (> 0), and returns the
    /// number of rays traced. `is_all` tests all of these cells; otherwise only a few are tested, so that a first picture
    /// appears soon.
    pub fn learn<C: Spectrum>(
        &mut self,
        scene: &Scene,
        photons: &[Photon<C>],
        radius: f32,
        is_all: bool,
        parallel: &mut impl Parallel,
    ) -> Result<u64> {
        // Finer levels are added as long as their radius is at least this radius.
        while let Some(last) = self.levels.last()
            && 0.5 * last.radius >= radius
        {
            self.levels.push(Arc::new(Level { radius: 0.5 * last.radius, cells: HashMap::default() }));
        }
        let mut rays = 0;
        for place in 0..self.levels.len() {
            if self.levels[place].radius < radius {
                break;
            }
            loop {
                let (judged, spent) = self.learn_level(scene, photons, place, parallel)?;
                rays += spent;
                if !is_all || judged == 0 {
                    break;
                }
            }
        }
        Ok(rays)
    }

    /// Tests the cells of one level; returns the number of tested cells with photons, and the number of rays traced.
    fn learn_level<C: Spectrum>(
        &mut self,
        scene: &Scene,
        photons: &[Photon<C>],
        place: usize,
        parallel: &mut impl Parallel,
    ) -> Result<(usize, u64)> {
        let (coarser, rest) = self.levels.split_at_mut(place);
        let Some(level) = rest.first_mut() else { return Ok((0, 0)) };
        let level = Arc::make_mut(level);
        let radius = level.radius;
        let mut fresh = Vec::new();
        // Cells are stored only after their test, since a cancelled pass would otherwise leave them without a result.
        let mut query = HashSet::<u64, BuildHasherDefault<Mixed>>::default();
        for (number, photon) in photons.iter().enumerate() {
            if number % LOOK_UP == 0 {
                parallel.check()?;
            }
            if fresh.len() == MOST_AT_ONCE || level.cells.len() + fresh.len() >= MOST {
                break;
            }
            let (p, normal) = (photon.position(), photon.normal.get());
            if !is_resolved(p, radius) {
                continue;
            }
            let mut above = coarser.iter().rev();
            // No test is needed where a coarser disk is covered, or where a coarser disk has to be tested first.
            if above
                .any(|coarser| coarser.cells.get(&key(p, normal, coarser.radius)).is_none_or(|is_covered| *is_covered))
            {
                continue;
            }
            let key = key(p, normal, radius);
            if !level.cells.contains_key(&key) && query.insert(key) {
                fresh.push((key, p, normal));
            }
        }
        let judged = fresh.len();
        let (verdicts, mut rays) = judge(scene, fresh, radius, self.time, parallel)?;
        // The neighbours of covered cells are tested as well, even where they hold no photon.
        let mut around = Vec::new();
        for ((_, p, normal), _) in verdicts.iter().filter(|(_, is_covered)| *is_covered) {
            let frame = Frame::from_normal(*normal);
            for (i, j) in (-1_i8..=1).flat_map(|i| (-1_i8..=1).map(move |j| (i, j))) {
                let p = *p + (frame.s * f32::from(i) + frame.t * f32::from(j)) * (radius / FINENESS);
                let key = key(p, *normal, radius);
                if !level.cells.contains_key(&key) && query.insert(key) {
                    around.push((key, p, *normal));
                }
            }
        }
        let (others, spent) = judge(scene, around, radius, self.time, parallel)?;
        rays += spent;
        // A negative result beside a photon is dropped: the tested point may lie off the surface.
        let coverage = others.into_iter().filter(|(_, is_covered)| *is_covered);
        level.cells.extend(verdicts.into_iter().chain(coverage).map(|((key, ..), is_covered)| (key, is_covered)));
        Ok((judged, rays))
    }
}

/// A cell's key, and a point of a surface in the cell with its normal.
type Cell = (u64, Vec3, Vec3);

/// Whether the surface covers the disks around the cells' points, and the number of rays traced.
fn judge(
    scene: &Scene,
    cells: Vec<Cell>,
    radius: f32,
    time: f32,
    parallel: &mut impl Parallel,
) -> Result<(Vec<(Cell, bool)>, u64)> {
    let count = cells.len().div_ceil(BLOCK);
    let cells = Arc::new(cells);
    let (judged, scene) = (Arc::clone(&cells), scene.clone());
    let blocks = parallel.map(count, move |block| {
        let mut tracer = SceneTracer::new(&scene);
        let end = (BLOCK * (block + 1)).min(judged.len());
        let judge = |cell: &Cell| (*cell, is_covered(&mut tracer, cell.1, cell.2, radius, time));
        (judged[BLOCK * block..end].iter().map(judge).collect::<Vec<_>>(), tracer.rays)
    })?;
    let rays = blocks.iter().map(|(_, rays)| rays).sum();
    Ok((blocks.into_iter().flat_map(|(verdicts, _)| verdicts).collect(), rays))
}

/// Whether single precision resolves disks of this radius at this point.
#[inline]
fn is_resolved(p: Vec3, radius: f32) -> bool {
    radius > RESOLUTION * p.abs().max_element()
}

/// The key of the cell that holds a point on this side of a surface.
#[inline]
fn key(p: Vec3, normal: Vec3, radius: f32) -> u64 {
    let cell = (p * (FINENESS / radius)).floor();
    // Several walls share the cells of a corner; the axis nearest to the normal tells them apart.
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        u64::from(normal.x > 0.0)
    } else if size.y >= size.z {
        2 + u64::from(normal.y > 0.0)
    } else {
        4 + u64::from(normal.z > 0.0)
    };
    // Coordinates do not saturate where single precision resolves the radius.
    let [x, y, z] = cell.to_array().map(|v| u64::from(v as i32 as u32));
    hash(hash(x << 32 | y, z), axis)
}

/// Whether the surface covers every disk of this radius around a point of the cell that contains `p`.
fn is_covered(tracer: &mut SceneTracer, p: Vec3, normal: Vec3, radius: f32, time: f32) -> bool {
    let reach = radius * (1.0 + 1.5 / FINENESS);
    let height = THICKNESS * radius;
    let frame = Frame::from_normal(normal);
    // The rays along the surface start above it by half of the height that the disk may bend, and by the rounding error.
    let error = HitPoint::rounding_error(p, normal);
    let above = p + normal * (0.5 * height + error);
    (0..DIRECTIONS).all(|i| {
        let (sin, cos) = (TAU * (i as f32 + 0.5) / DIRECTIONS as f32).sin_cos();
        let along = frame.s * cos + frame.t * sin;
        let level = Ray::segment(above, along * reach, 1.0).at_time(time);
        if !tracer.unoccluded(&level) {
            return false;
        }
        // The rays down start at the rim, and alternately at two smaller distances.
        let near = if i % 2 == 0 { 0.5 } else { 0.75 };
        [1.0, near].into_iter().all(|share| {
            let origin = above + along * (reach * share);
            let down = Ray::segment(origin, normal * (-1.5 * height - 2.0 * error), 1.0).at_time(time);
            !tracer.unoccluded(&down)
        })
    })
}
