//! A hierarchy of lights: one is chosen by what the receiver may get from it.
//!
//! Every node bounds its emitters by a sphere around their places, a cone around their normals and the sum of their
//! intensities. On the way down a child is taken in proportion to what it could send at most, more or less: intensity, times
//! the largest cosine at the emitter, times the largest at the receiver, over the squared distance. Only what cannot send
//! anything has probability 0.
//!
//! Nodes have four children, weighed side by side: half as many steps as with two, and each decides on tighter bounds.
//!
//! Source: Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (without the
//! splitting: one sample is one ray). The bound of a node is that of pbrt, Pharr, Jakob and Humphreys 2023, Sec. 12.6.3.

mod build;
mod cone;

use super::Receiver;
use crate::math::Vec3;

/// Children of a node.
const WIDTH: usize = 4;

/// No parent, or no child.
const NONE: u32 = u32::MAX;

/// In `Node::child`: what is left is the number of an emitter, not of a node.
const IS_EMITTER: u32 = 1 << 31;

/// Share of the choices that goes evenly to all emitters. Bounds know nothing of walls: where all that they favour is behind
/// one, what is left must not be left to chance. It also keeps every probability away from 0.
const EVEN_SHARE: f64 = 0.05;

/// Cosines of bounds are off by at most this, for sines are taken from rounded cosines: what is less below the horizon is
/// not known to be dark, and what is less above it counts as this.
const SLACK: f32 = 2e-3;

/// Farther away than this, in sizes of the tree, all receivers in one direction are the same.
const FAR: f32 = 1e6;

/// Children side by side. Lengths are in sizes of the tree, from its middle; intensities are shares of their sum.
#[derive(Clone, Debug)]
struct Node {
    centre: [[f32; WIDTH]; 3],
    radius2: [f32; WIDTH],
    /// Middle of the cone of normals.
    axis: [[f32; WIDTH]; 3],
    /// Its half angle; a cosine of -1 where light goes everywhere.
    cos: [f32; WIDTH],
    sin: [f32; WIDTH],
    /// Sum over the emitters, each in its brightest direction. 0 where there is no child.
    intensity: [f32; WIDTH],
    child: [u32; WIDTH],
    /// Four times the number of the parent plus the place there.
    parent: u32,
}

/// All emitters that shine, as a tree.
///
/// 180 bytes a node, and fewer nodes than emitters: a third as many where all are full. 8 bytes more an emitter. While it is
/// built, 64 bytes an emitter and 80 a node on top.
#[derive(Debug)]
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// Where each emitter is: four times the number of the node plus the place there. `NONE`: it does not shine.
    place: Vec<u32>,
    /// Numbers of those that shine.
    shining: Vec<u32>,
    /// Middle and inverse size in the scene frame.
    middle: Vec3,
    per_size: f32,
}

/// A receiver in the tree's frame.
struct Query {
    p: Vec3,
    normal: Vec3,
    /// Light from any side counts.
    is_open: bool,
}

impl Node {
    /// What each child may send to the receiver, more or less; 0 only where it cannot send anything.
    #[inline]
    fn importances(&self, query: &Query) -> [f32; WIDTH] {
        let (p, n) = (query.p, query.normal);
        let mut importances = [0.0; WIDTH];
        // Without a branch, so that the compiler computes all at once.
        for (k, importance) in importances.iter_mut().enumerate() {
            let (x, y, z) = (p.x - self.centre[0][k], p.y - self.centre[1][k], p.z - self.centre[2][k]);
            let distance2 = x * x + y * y + z * z;
            let beyond2 = distance2.max(self.radius2[k]);
            let is_within = distance2 <= self.radius2[k];
            let per_distance = 1.0 / beyond2.sqrt();
            // The angle under which the receiver sees the sphere.
            let sin2 = self.radius2[k] / beyond2;
            let (sin_seen, cos_seen) = (sin2.sqrt(), (1.0 - sin2).sqrt());
            // Between the cone's axis and the way to the receiver, less the cone's own angle, less that of the sphere.
            let cos_off = (x * self.axis[0][k] + y * self.axis[1][k] + z * self.axis[2][k]) * per_distance;
            let sin_off = (1.0 - cos_off * cos_off).max(0.0).sqrt();
            let is_in_cone = cos_off >= self.cos[k];
            let cos_left = if is_in_cone { 1.0 } else { cos_off * self.cos[k] + sin_off * self.sin[k] };
            let sin_left = if is_in_cone { 0.0 } else { sin_off * self.cos[k] - cos_off * self.sin[k] };
            let leaving = less(cos_left, sin_left, cos_seen, sin_seen);
            let cos_in = -(x * n.x + y * n.y + z * n.z) * per_distance;
            let sin_in = (1.0 - cos_in * cos_in).max(0.0).sqrt();
            let arriving = less(cos_in, sin_in, cos_seen, sin_seen);
            let arriving = if query.is_open { 1.0 } else { arriving };
            let cosines = if is_within { 1.0 } else { lifted(leaving) * lifted(arriving) };
            *importance = self.intensity[k] * cosines / beyond2;
        }
        importances
    }
}

/// Cosine of angle a less angle b, of 0 where b is more.
#[inline]
fn less(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> f32 {
    if cos_a >= cos_b { 1.0 } else { cos_a * cos_b + sin_a * sin_b }
}

/// A largest cosine as a factor: 0 only where it is below 0 by more than it may be off.
#[inline]
fn lifted(cos: f32) -> f32 {
    if cos < -SLACK { 0.0 } else { cos.max(SLACK) }
}

impl LightTree {
    fn query(&self, receiver: &Receiver) -> Query {
        let p = (receiver.p - self.middle) * self.per_size;
        let farthest = p.abs().max_element();
        let p = if farthest > FAR { p * (FAR / farthest) } else { p };
        Query { p, normal: receiver.normal, is_open: receiver.normal == Vec3::ZERO }
    }

    /// The emitter that `u` in [0, 1) falls on, and its probability; `None` where what was chosen turns out, closer to,
    /// to send nothing.
    #[inline(never)]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<(usize, f32)> {
        if u < EVEN_SHARE {
            let count = self.shining.len();
            let chosen = ((u / EVEN_SHARE * count as f64) as usize).min(count - 1);
            let emitter = self.shining[chosen] as usize;
            return Some((emitter, self.probability(emitter, receiver)));
        }
        let query = self.query(receiver);
        let mut left = (u - EVEN_SHARE) / (1.0 - EVEN_SHARE);
        let mut probability = 1.0;
        let mut node = &self.nodes[0];
        loop {
            let importances = node.importances(&query).map(f64::from);
            let ends = running(importances);
            let sum = ends[WIDTH - 1];
            if sum <= 0.0 {
                return None;
            }
            // Counted rather than searched: which child it will be cannot be predicted. One of weight 0 has equal ends.
            let at = left * sum;
            let mut k = ends[..WIDTH - 1].iter().map(|&end| usize::from(end <= at)).sum::<usize>();
            while importances[k] <= 0.0 {
                // Rounded beyond the last that has some.
                k -= 1;
            }
            left = ((at - (ends[k] - importances[k])) / importances[k]).clamp(0.0, 1.0 - f64::EPSILON);
            probability *= importances[k] / sum;
            let child = node.child[k];
            if child & IS_EMITTER != 0 {
                return Some(((child & !IS_EMITTER) as usize, self.mixed(probability)));
            }
            node = &self.nodes[child as usize];
        }
    }

    /// Probability with which [`LightTree::sample`] returns this emitter.
    #[inline(never)]
    pub fn probability(&self, emitter: usize, receiver: &Receiver) -> f32 {
        let mut place = self.place[emitter];
        if place == NONE {
            return 0.0;
        }
        let query = self.query(receiver);
        let mut probability = 1.0;
        // Upwards: the same factors in another order.
        while place != NONE {
            let node = &self.nodes[place as usize / WIDTH];
            let importances = node.importances(&query).map(f64::from);
            let importance = importances[place as usize % WIDTH];
            if importance <= 0.0 {
                probability = 0.0;
                break;
            }
            probability *= importance / running(importances)[WIDTH - 1];
            place = node.parent;
        }
        self.mixed(probability)
    }

    /// With the even share.
    fn mixed(&self, probability: f64) -> f32 {
        (EVEN_SHARE / self.shining.len() as f64 + (1.0 - EVEN_SHARE) * probability) as f32
    }
}

/// Sums of the first one, two, three and four. (Differences of them are as exact as the smallest needs in double precision.)
#[inline]
fn running([a, b, c, d]: [f64; WIDTH]) -> [f64; WIDTH] {
    [a, a + b, a + b + c, a + b + c + d]
}
