//! The photon map: a tree of boxes that finds the photons near a point.
//!
//! Photons are sorted along a Morton curve and cut into blocks of [`BLOCK`]. A box around each block, and a box around every
//! [`WIDTH`] boxes, level by level, form a tree without pointers: the indices of boxes tell which box contains which. A
//! query visits the boxes that its ball touches. The tree does not depend on a radius chosen beforehand, and a dense caustic
//! has as many blocks as it needs, whereas the cells of a grid are either too full or too many.
//!
//! Sources: Jensen 2001, "Realistic Image Synthesis Using Photon Mapping" (photons stored apart from geometry, queries of
//! the k nearest photons); Lauterbach et al. 2009, "Fast BVH Construction on GPUs" (boxes along a Morton curve); Kamel and
//! Faloutsos 1993, "On Packing R-trees" (full nodes bottom-up). `docs/performance.md` lists the alternatives that were
//! measured.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Photon;
use super::order::order;
use crate::math::{Vec3, Vec4};
use crate::room::check_room;
use crate::spectrum::{Rgb, Spectrum};
use crate::{Cancel, Result};

/// Photons in a block.
const BLOCK: usize = 16;

/// Boxes in a node.
const WIDTH: usize = 8;

/// Number of levels, more than 2^32 photons need.
const LEVELS: usize = 16;

/// The boxes of a node, stored by coordinate. An empty box has its corners at infinity, the minimum at the positive end.
#[derive(Clone, Copy, Debug)]
struct Boxes {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
}

impl Boxes {
    const EMPTY: Self = Self { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };

    /// Grows box `i` to contain `min` and `max`.
    #[inline]
    fn include(&mut self, i: usize, min: [f32; 3], max: [f32; 3]) {
        for axis in 0..3 {
            self.min[axis][i] = smaller(min[axis], self.min[axis][i]);
            self.max[axis][i] = larger(max[axis], self.max[axis][i]);
        }
    }

    /// The box around all boxes of the node.
    fn around(&self) -> ([f32; 3], [f32; 3]) {
        let min = self.min.map(|side| side.into_iter().fold(f32::INFINITY, |a, b| smaller(b, a)));
        let max = self.max.map(|side| side.into_iter().fold(f32::NEG_INFINITY, |a, b| larger(b, a)));
        (min, max)
    }

    /// Squared distances from the query to the boxes. A distance is never larger than that of a photon inside as
    /// [`PhotonMap::block_distances2`] computes it, since rounding is monotonic and both compute the same sum.
    #[inline]
    fn distance2(&self, query: &Query) -> [f32; WIDTH] {
        let mut sum = [0.0; WIDTH];
        for axis in 0..3 {
            for (i, sum) in sum.iter_mut().enumerate() {
                let (below, above) = (self.min[axis][i] - query.p[axis], query.p[axis] - self.max[axis][i]);
                let d = larger(larger(below, above), 0.0) * query.scale;
                *sum += d * d;
            }
        }
        sum
    }
}

/// `a` if it is smaller, else `b`; one instruction.
#[inline]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `a` if it is larger, else `b`; one instruction.
#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The positions of a block's photons; infinite where the block has no photon.
type Places = [[f32; BLOCK]; 3];

/// The centre of a query, and the power of two that scales differences so that their squares neither overflow nor underflow.
#[derive(Clone, Copy, Debug)]
struct Query {
    p: [f32; 3],
    scale: f32,
    /// Square of the scaled radius: a photon is inside if its squared distance is smaller.
    radius2: f32,
    /// Factor that is applied twice to turn a scaled square into the square of a length, since the product of both factors
    /// may overflow.
    unscale: f32,
}

impl Query {
    /// Creates a query around `p`; `None` if no photon can be inside. No photon is farther away than `reach`.
    #[inline]
    fn new(p: Vec3, radius: f32, reach: f32) -> Option<Self> {
        if !p.is_finite() || radius.is_nan() || radius <= 0.0 {
            return None;
        }
        let length = radius.min(reach);
        // Ordinary lengths need no scaling.
        let scale = if (1e-15..1e15).contains(&length) { 1.0 } else { Self::scale(length) };
        let scaled = radius * scale;
        let radius2 = if radius > reach { f32::INFINITY } else { scaled * scaled };
        Some(Self { p: p.to_array(), scale, radius2, unscale: 1.0 / scale })
    }

    /// A power of two that scales a length to about 1, as far as the power and its inverse are normal numbers.
    #[cold]
    fn scale(length: f32) -> f32 {
        let exponent = (length.to_bits() >> 23) as i32 - 127;
        2_f32.powi((-exponent).clamp(-126, 126))
    }

    /// Squared distance without the scaling.
    #[inline]
    fn unscaled(&self, distance2: f32) -> f32 {
        distance2 * self.unscale * self.unscale
    }
}

/// Photons that can be queried by position. Any number of photons is allowed, including 0, at any positions: even all in one
/// plane or all in one point.
#[derive(Debug, Default)]
pub struct PhotonMap<C: Spectrum = Rgb> {
    photons: Vec<Photon<C>>,
    /// The photons' positions once more, block by block and by coordinate. Most photons that a query tests are too far away,
    /// so the distances of a block are computed together.
    places: Vec<Places>,
    /// The nodes of all levels, the lowest first: box i of node n contains block `n * WIDTH + i` on the lowest level, and
    /// the node of that index of the level below on all others.
    nodes: Vec<Boxes>,
    /// Index in `nodes` at which each level begins.
    levels: [u32; LEVELS],
    /// The level that consists of one node; without photons there is no node.
    top: usize,
    /// Corners of the box around all photons.
    bounds: ([f32; 3], [f32; 3]),
}

/// The photons nearest to a point, by index in [`PhotonMap::photons`], with their squared distances. Keeps its memory
/// between uses.
#[derive(Clone, Debug, Default)]
pub struct Nearest {
    found: Vec<(f32, u32)>,
    /// Keys of the candidates: the bits of the squared distance, which for positive numbers sort as the numbers do, above
    /// the index. The list grows to at most about twice the number wanted and is then cut down to the nearest.
    candidates: Vec<u64>,
    /// Nodes to be visited, the nearest first.
    waiting: BinaryHeap<Reverse<Waiting>>,
}

impl Nearest {
    /// Squared distances and indices, nearest first.
    pub fn found(&self) -> &[(f32, u32)] {
        &self.found
    }
}

impl<C: Spectrum> PhotonMap<C> {
    /// Builds a map. The order of its photons, and so every sum over them, depends only on the photons and their given
    /// order.
    ///
    /// All photons are kept; those whose position is not a number are never found. The build needs 2.4 times the bytes of
    /// the photons.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`]; [`crate::ErrorKind::Unsupported`] for 2^32 photons or more.
    pub fn build(photons: Vec<Photon<C>>, cancel: &Cancel) -> Result<Self> {
        cancel.check()?;
        // The photons in order, their places once more, and the numbers by which they are sorted.
        check_room(photons.len().saturating_mul(size_of::<Photon<C>>() + 64))?;
        let order = order(&photons, BLOCK, cancel)?;
        let blocks = photons.len().div_ceil(BLOCK);
        let mut sorted = Vec::with_capacity(photons.len());
        let mut places = Vec::with_capacity(blocks);
        let mut nodes = Vec::with_capacity(blocks.div_ceil(WIDTH - 1) + LEVELS);
        for order in order.chunks(BLOCK * WIDTH) {
            if nodes.len() % 32 == 0 {
                cancel.check()?;
            }
            let mut node = Boxes::EMPTY;
            for (i, block) in order.chunks(BLOCK).enumerate() {
                let mut place = [[f32::INFINITY; BLOCK]; 3];
                for (lane, item) in block.iter().enumerate() {
                    let photon = photons[*item as u32 as usize];
                    // Photons at positions that are not finite are never found, so boxes do not contain them.
                    if photon.position().is_finite() {
                        node.include(i, photon.p, photon.p);
                    }
                    for (side, p) in place.iter_mut().zip(photon.p) {
                        side[lane] = p;
                    }
                    sorted.push(photon);
                }
                places.push(place);
            }
            nodes.push(node);
        }
        drop((photons, order));

        let (mut levels, mut top) = ([0; LEVELS], 0);
        while nodes.len() > levels[top] as usize + 1 {
            cancel.check()?;
            let (start, end) = (levels[top] as usize, nodes.len());
            for below in (start..end).step_by(WIDTH) {
                let mut node = Boxes::EMPTY;
                for (i, below) in nodes[below..end.min(below + WIDTH)].iter().enumerate() {
                    let (min, max) = below.around();
                    node.include(i, min, max);
                }
                nodes.push(node);
            }
            top += 1;
            levels[top] = end as u32;
        }
        let bounds = nodes.last().map_or_else(Default::default, Boxes::around);
        Ok(Self { photons: sorted, places, nodes, levels, top, bounds })
    }

    /// All photons, in the map's order.
    pub fn photons(&self) -> &[Photon<C>] {
        &self.photons
    }

    /// Number of photons.
    pub fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether the map has no photons.
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// Memory of the map in bytes.
    pub fn bytes(&self) -> usize {
        self.photons.capacity() * size_of::<Photon<C>>()
            + self.places.capacity() * size_of::<Places>()
            + self.nodes.capacity() * size_of::<Boxes>()
    }

    /// Scaled squared distances of the photons in a block; infinite where the block has no photon.
    #[inline(always)]
    fn block_distances2(&self, block: usize, query: &Query) -> [f32; BLOCK] {
        let mut distances2 = [0.0; BLOCK];
        for (side, p) in self.places[block].iter().zip(query.p) {
            for (sum, place) in distances2.iter_mut().zip(side) {
                let d = (place - p) * query.scale;
                *sum += d * d;
            }
        }
        distances2
    }

    /// Visits every photon within `radius` (> 0) of `p`, with the square of its distance, always in the same order.
    ///
    /// The square is computed in single precision: it is 0 for distances below 1e-23 and infinite for those above 1e19, but
    /// the set of visited photons does not depend on this.
    #[inline]
    pub fn within(&self, p: Vec3, radius: f32, mut visit: impl FnMut(&Photon<C>, f32)) {
        // The distance to the farthest photon matters only for large radii.
        let reach = if radius < 1e15 { f32::INFINITY } else { self.reach(p) };
        let Some(query) = Query::new(p, radius, reach) else { return };
        if self.nodes.is_empty() {
            return;
        }
        let touched = |level: usize, node: usize| {
            let distances2 = self.nodes[self.levels[level] as usize + node].distance2(&query);
            below(&distances2, query.radius2)
        };
        // For each level, the remaining boxes of the node that is being visited, as bits.
        let mut waiting = [0; LEVELS];
        let (mut level, mut node) = (self.top, 0);
        let mut boxes = touched(level, node);
        loop {
            if boxes == 0 {
                if level == self.top {
                    return;
                }
                level += 1;
                node /= WIDTH;
                boxes = waiting[level];
                continue;
            }
            let child = node * WIDTH + boxes.trailing_zeros() as usize;
            boxes &= boxes - 1;
            if level > 0 {
                waiting[level] = boxes;
                level -= 1;
                node = child;
                boxes = touched(level, node);
                continue;
            }
            let distances2 = self.block_distances2(child, &query);
            let mut inside = below(&distances2, query.radius2);
            while inside != 0 {
                let i = inside.trailing_zeros() as usize;
                inside &= inside - 1;
                if let Some(photon) = self.photons.get(child * BLOCK + i) {
                    visit(photon, query.unscaled(distances2[i]));
                }
            }
        }
    }

    /// Finds the `count` photons nearest to `p` among those within `radius` (may be infinite), or all of these if there are
    /// fewer. Among photons at the same distance those of the lowest index are found.
    pub fn nearest(&self, p: Vec3, count: usize, radius: f32, nearest: &mut Nearest) {
        let Nearest { found, candidates, waiting } = nearest;
        found.clear();
        candidates.clear();
        let Some(query) = Query::new(p, radius, self.reach(p)) else { return };
        if count == 0 || self.nodes.is_empty() {
            return;
        }
        // A photon is a candidate if its key is below this bound.
        let mut bound = key(query.radius2, 0);
        let most = count.saturating_add((count / 2).max(4 * BLOCK));

        waiting.clear();
        waiting.push(Reverse(Waiting::new(0.0, self.top, 0)));
        while let Some(Reverse(next)) = waiting.pop() {
            let (level, node) = next.place();
            if next.distance2() > (bound >> 32) as u32 {
                break;
            }
            let distances2 = self.nodes[self.levels[level] as usize + node].distance2(&query);
            for (i, &distance2) in distances2.iter().enumerate() {
                let child = node * WIDTH + i;
                // The index of the child's first photon, since the number of photons in each child is a power of two.
                let first = key(distance2, child << (BLOCK.ilog2() + WIDTH.ilog2() * level as u32));
                if first >= bound || distance2 == f32::INFINITY {
                    continue;
                }
                if level > 0 {
                    waiting.push(Reverse(Waiting::new(distance2, level - 1, child)));
                    continue;
                }
                let distances2 = self.block_distances2(child, &query);
                for (i, &distance2) in distances2.iter().enumerate() {
                    let key = key(distance2, child * BLOCK + i);
                    if key < bound {
                        candidates.push(key);
                    }
                }
                if candidates.len() >= most {
                    bound = keep(candidates, count);
                }
            }
        }
        if candidates.len() > count {
            keep(candidates, count);
        }
        candidates.sort_unstable();
        let one = |&key: &u64| (query.unscaled(f32::from_bits((key >> 32) as u32)), key as u32);
        found.extend(candidates.iter().map(one));
    }

    /// A distance beyond which no photon lies, as far as the distance is a number.
    fn reach(&self, p: Vec3) -> f32 {
        let (min, max) = self.bounds;
        let mut sum = 0.0;
        for axis in 0..3 {
            let (p, min, max) = (f64::from(p[axis]), f64::from(min[axis]), f64::from(max[axis]));
            sum += (p - min).abs().max((max - p).abs()).powi(2);
        }
        (sum.sqrt() as f32).next_up()
    }
}

/// A node to be visited: the bits of its squared distance, its level and its index, which are compared in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting(u64);

impl Waiting {
    /// Node indices have 27 bits at most, as 2^32 photons have 2^27 nodes.
    #[inline]
    fn new(distance2: f32, level: usize, node: usize) -> Self {
        Self(u64::from(distance2.to_bits()) << 32 | (level as u64) << 28 | node as u64)
    }

    /// Bits of the squared distance.
    #[inline]
    fn distance2(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// Level and index of the node.
    #[inline]
    fn place(self) -> (usize, usize) {
        (self.0 as usize >> 28 & 0xf, self.0 as usize & 0x0fff_ffff)
    }
}

/// The key that orders photons by distance, then by index: the bits of positive numbers sort as the numbers do.
#[inline]
fn key(distance2: f32, index: usize) -> u64 {
    u64::from(distance2.to_bits()) << 32 | index as u64
}

/// Keeps the `count` smallest keys (> 0, fewer than there are), and returns the greatest of those kept.
fn keep(candidates: &mut Vec<u64>, count: usize) -> u64 {
    let (_, &mut last, _) = candidates.select_nth_unstable(count - 1);
    candidates.truncate(count);
    last
}

/// Bit i is set if value i is less than `bound`.
#[inline]
fn below<const N: usize>(of: &[f32; N], bound: f32) -> u32 {
    let fours = of.as_chunks::<4>().0.iter().enumerate();
    let below = |four: &[f32; 4]| Vec4::from_array(*four).cmplt(Vec4::splat(bound)).bitmask();
    fours.fold(0, |bits, (i, four)| bits | below(four) << (4 * i))
}
