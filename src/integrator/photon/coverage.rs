//! Where on the surfaces a disk of the estimate's radius is whole.
//!
//! A kernel that reaches over an edge, into a corner or through a thin wall counts too little light, or light that is not
//! there: dark seams and leaks. So before a map is read it is known, for small cells of space, whether a disk around any
//! point of them is whole: rays along the surface meet no wall, and rays down on it from the disk's rim and half way there
//! meet the surface. Elsewhere, along edges and contacts, no density is estimated; there the path goes on instead, which has no
//! bias and costs a little noise in a narrow strip.
//!
//! A cell is judged from a photon in it or near by, so a cell far from photons is not whole either: where there are hardly any
//! photons, paths do better. They must be other photons than those that are gathered. Else estimates would be made where there
//! happen to be some and paths followed where there happen to be none, and the image too bright by the chance of that.

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

/// Cells to a radius.
const FINENESS: f32 = 2.0;

/// Directions along the surface.
const DIRECTIONS: usize = 16;

/// Cells that are judged by one thread at a time.
const BLOCK: usize = 256;

/// Most cells of a level that are judged before a pass, so that a first picture is not long in coming.
const MOST_AT_ONCE: usize = 1 << 14;

/// Photons between two looks at whether all this is still wanted.
const LOOK_UP: usize = 1 << 14;

/// Most cells of a level that are remembered: 16 bytes each.
const MOST: usize = 1 << 22;

/// Levels above the finest that is asked for, each of twice the radius: in the middle of a wall a few large cells tell for
/// all smaller ones.
const COARSER: i32 = 4;

/// Smallest radius that places are fine enough for, as a share of their largest coordinate: 64 roundings. A smaller disk would
/// hold photons by the luck of rounding only.
const RESOLUTION: f32 = 64.0 * f32::EPSILON;

/// Cells and whether disks in them are whole, for a few radii.
#[derive(Clone, Debug, Default)]
pub(super) struct DiskCoverage {
    /// From the largest radius down, each half of the one before.
    levels: Vec<Arc<Level>>,
}

/// Disks of one radius.
#[derive(Clone, Debug)]
struct Level {
    radius: f32,
    cells: HashMap<u64, bool, BuildHasherDefault<Mixed>>,
}

/// Keys are well mixed already.
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
    /// Nothing is known yet, of disks up to `radius` and smaller ones.
    pub fn new(radius: f32) -> Self {
        let level = |k| Arc::new(Level { radius: radius * 2.0_f32.powi(k), cells: HashMap::default() });
        Self { levels: (0..=COARSER).rev().map(level).collect() }
    }

    /// Whether the disk of this radius around `p` on the side `normal` is known to be whole.
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

    /// Judges the cells of photons that were not met before, down to disks of this radius (> 0); returns the rays it took.
    /// All of them, or those of a few, so that a first picture is not long in coming.
    pub fn learn<C: Spectrum>(
        &mut self,
        scene: &Scene,
        photons: &[Photon<C>],
        radius: f32,
        is_all: bool,
        parallel: &mut impl Parallel,
    ) -> Result<u64> {
        // The next finer level begins where this radius is less than it.
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

    /// How many cells with photons it judged, and the rays it took.
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
        // Cells are not known before they are judged, or a stop in between would leave them so.
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
            // Nothing is left to be known where a coarser disk is whole, or not known itself.
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
        let (verdicts, mut rays) = judge(scene, fresh, radius, parallel)?;
        // Around cells that are whole, those as well where no photon was met.
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
        let (others, spent) = judge(scene, around, radius, parallel)?;
        rays += spent;
        // A place beside the surface tells nothing of it, where it is found not to be whole.
        let coverage = others.into_iter().filter(|(_, is_covered)| *is_covered);
        level.cells.extend(verdicts.into_iter().chain(coverage).map(|((key, ..), is_covered)| (key, is_covered)));
        Ok((judged, rays))
    }
}

/// A cell's key, and a point of a surface in it with its normal.
type Cell = (u64, Vec3, Vec3);

/// Whether disks around the cells' points are whole, and the rays that it took to know.
fn judge(
    scene: &Scene,
    cells: Vec<Cell>,
    radius: f32,
    parallel: &mut impl Parallel,
) -> Result<(Vec<(Cell, bool)>, u64)> {
    let count = cells.len().div_ceil(BLOCK);
    let cells = Arc::new(cells);
    let (judged, scene) = (Arc::clone(&cells), scene.clone());
    let blocks = parallel.map(count, move |block| {
        let mut tracer = SceneTracer::new(&scene);
        let end = (BLOCK * (block + 1)).min(judged.len());
        let judge = |cell: &Cell| (*cell, is_covered(&mut tracer, cell.1, cell.2, radius));
        (judged[BLOCK * block..end].iter().map(judge).collect::<Vec<_>>(), tracer.rays)
    })?;
    let rays = blocks.iter().map(|(_, rays)| rays).sum();
    Ok((blocks.into_iter().flat_map(|(verdicts, _)| verdicts).collect(), rays))
}

/// Whether places like this one are fine enough for disks of this radius.
#[inline]
fn is_resolved(p: Vec3, radius: f32) -> bool {
    radius > RESOLUTION * p.abs().max_element()
}

/// The cell that a point on this side of a surface is in.
#[inline]
fn key(p: Vec3, normal: Vec3, radius: f32) -> u64 {
    let cell = (p * (FINENESS / radius)).floor();
    // A corner has cells that several walls share: told apart by the axis that the normal is nearest to.
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        u64::from(normal.x > 0.0)
    } else if size.y >= size.z {
        2 + u64::from(normal.y > 0.0)
    } else {
        4 + u64::from(normal.z > 0.0)
    };
    // No coordinate saturates where places are fine enough for the radius.
    let [x, y, z] = cell.to_array().map(|v| u64::from(v as i32 as u32));
    hash(hash(x << 32 | y, z), axis)
}

/// Whether every disk of this radius around a point of the cell that `p` lies in is whole.
fn is_covered(tracer: &mut SceneTracer, p: Vec3, normal: Vec3, radius: f32) -> bool {
    let reach = radius * (1.0 + 1.5 / FINENESS);
    let height = THICKNESS * radius;
    let frame = Frame::from_normal(normal);
    // Over the surface by half of what the disk may bend, and by what rounding needs.
    let error = HitPoint::rounding_error(p, normal);
    let above = p + normal * (0.5 * height + error);
    (0..DIRECTIONS).all(|i| {
        let (sin, cos) = (TAU * (i as f32 + 0.5) / DIRECTIONS as f32).sin_cos();
        let along = frame.s * cos + frame.t * sin;
        let level = Ray { origin: above, direction: along * reach, tnear: 0.0, tfar: 1.0 };
        if !tracer.unoccluded(&level) {
            return false;
        }
        // The rim, and alternately nearer.
        let near = if i % 2 == 0 { 0.5 } else { 0.75 };
        [1.0, near].into_iter().all(|share| {
            let origin = above + along * (reach * share);
            let down = Ray { origin, direction: normal * (-1.5 * height - 2.0 * error), tnear: 0.0, tfar: 1.0 };
            !tracer.unoccluded(&down)
        })
    })
}
