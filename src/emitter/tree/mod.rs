//! A light hierarchy, from which an emitter is chosen by a bound of what the receiver may get from it.
//!
//! Every node bounds its emitters by a sphere around their positions, a cone around their normals and the sum of their
//! intensities. The traversal chooses a child in proportion to its importance, which is approximately the most that the
//! child could send: intensity, times the largest cosine at the emitter, times the largest cosine at the receiver, over
//! the squared distance. Only a child that cannot send any light has probability 0.
//!
//! Nodes have four children, whose importances are computed side by side. The traversal takes half as many steps as in
//! a binary tree, and each step uses tighter bounds.
//!
//! Source: Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (without the
//! splitting: one sample is one ray). The bound of a node is that of pbrt, Pharr, Jakob and Humphreys 2023, Sec.
//! 12.6.3.

mod build;
mod cone;

pub(super) use cone::Cone;

use super::Receiver;
use crate::math::{Vec3, Vec4};

/// Children of a node.
const WIDTH: usize = 4;

/// No parent, or no child.
const NONE: u32 = u32::MAX;

/// Flag in `Node::child`: the remaining bits are the index of an emitter, not of a node.
const IS_EMITTER: u32 = 1 << 31;

/// Fraction of the choices that is uniform over all emitters. The bounds do not include occlusion: where all emitters
/// that they favour are hidden, the other emitters need samples too. The fraction also keeps every probability away
/// from 0.
const UNIFORM_FRACTION: f64 = 0.05;

/// Cosines of bounds have at most this error, because sines are computed from rounded cosines. A cosine that is less
/// below 0 is not known to be dark, and one that is less above 0 counts as this.
const COSINE_ERROR: f32 = 2e-3;

/// Beyond this distance, in sizes of the tree, all receivers in one direction are treated alike.
const MAX_DISTANCE: f32 = 1e6;

/// A node with its children side by side. Lengths are in sizes of the tree, relative to its centre; intensities are
/// fractions of their sum.
#[derive(Clone, Debug)]
struct Node {
    centre: [[f32; WIDTH]; 3],
    radius2: [f32; WIDTH],
    /// Axis of the cone of normals.
    axis: [[f32; WIDTH]; 3],
    /// Half angle of the cone; its cosine is -1 where light goes in all directions.
    cos: [f32; WIDTH],
    sin: [f32; WIDTH],
    /// Sum over the emitters, each in its brightest direction; 0 where there is no child.
    intensity: [f32; WIDTH],
    child: [u32; WIDTH],
    /// Four times the index of the parent, plus the position there.
    parent: u32,
}

/// All emitters with power above 0, as a tree.
///
/// A node takes 180 bytes, and there are fewer nodes than emitters: a third as many where all nodes are full. An
/// emitter takes 8 bytes more. While the tree is built, an emitter takes 64 bytes and a node 80 bytes in addition.
#[derive(Debug)]
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// Position of each emitter: four times the index of its node, plus the position there. `NONE`: it has no power.
    slot: Vec<u32>,
    /// Indices of the emitters with power above 0.
    emitting: Vec<u32>,
    /// Centre and inverse size in the scene frame.
    centre: Vec3,
    inverse_size: f32,
}

/// A receiver in the tree's frame.
struct Query {
    p: Vec3,
    normal: Vec3,
    /// Whether light from all sides counts.
    all_sides: bool,
}

impl Node {
    /// Importance of each child: approximately the most that it may send to the receiver; 0 only where it cannot send
    /// any light.
    #[inline]
    fn importances(&self, query: &Query) -> [f32; WIDTH] {
        let (p, n) = (query.p, query.normal);
        let from = |at: f32, axis: usize| Vec4::splat(at) - Vec4::from_array(self.centre[axis]);
        let (x, y, z) = (from(p.x, 0), from(p.y, 1), from(p.z, 2));
        let (axis, cos, sin) = (self.axis.map(Vec4::from_array), Vec4::from(self.cos), Vec4::from(self.sin));
        let radius2 = Vec4::from(self.radius2);
        let distance2 = x * x + y * y + z * z;
        let beyond2 = distance2.max(radius2);
        let is_within = distance2.cmple(radius2);
        let per_distance = Vec4::ONE / beyond2.sqrt();
        // The angle under which the receiver sees the sphere.
        let sin2 = radius2 / beyond2;
        let (sin_seen, cos_seen) = (sin2.sqrt(), (Vec4::ONE - sin2).sqrt());
        // The angle between the cone's axis and the direction to the receiver, minus the cone's half angle, minus
        // that of the sphere.
        let cos_off = (x * axis[0] + y * axis[1] + z * axis[2]) * per_distance;
        let sin_off = sine(cos_off);
        let is_in_cone = cos_off.cmpge(cos);
        let cos_left = Vec4::select(is_in_cone, Vec4::ONE, cos_off * cos + sin_off * sin);
        let sin_left = Vec4::select(is_in_cone, Vec4::ZERO, sin_off * cos - cos_off * sin);
        let leaving = cos_of_difference(cos_left, sin_left, cos_seen, sin_seen);
        let arriving = if query.all_sides {
            Vec4::ONE
        } else {
            let cos_in = -(x * n.x + y * n.y + z * n.z) * per_distance;
            cosine_factor(cos_of_difference(cos_in, sine(cos_in), cos_seen, sin_seen))
        };
        let cosines = Vec4::select(is_within, Vec4::ONE, cosine_factor(leaving) * arriving);
        (Vec4::from(self.intensity) * cosines / beyond2).to_array()
    }
}

/// Sine of an angle in [0, pi], by its cosine.
#[inline]
fn sine(cos: Vec4) -> Vec4 {
    (Vec4::ONE - cos * cos).max(Vec4::ZERO).sqrt()
}

/// Cosine of angle a minus angle b, or of 0 where b is larger.
#[inline]
fn cos_of_difference(cos_a: Vec4, sin_a: Vec4, cos_b: Vec4, sin_b: Vec4) -> Vec4 {
    Vec4::select(cos_a.cmpge(cos_b), Vec4::ONE, cos_a * cos_b + sin_a * sin_b)
}

/// A largest cosine as a factor: 0 only where it is below 0 by more than its error.
#[inline]
fn cosine_factor(cos: Vec4) -> Vec4 {
    let factor = cos.max(Vec4::splat(COSINE_ERROR));
    Vec4::select(cos.cmplt(Vec4::splat(-COSINE_ERROR)), Vec4::ZERO, factor)
}

impl LightTree {
    fn query(&self, receiver: &Receiver) -> Query {
        let p = (receiver.p - self.centre) * self.inverse_size;
        let farthest = p.abs().max_element();
        let p = if farthest > MAX_DISTANCE { p * (MAX_DISTANCE / farthest) } else { p };
        Query { p, normal: receiver.normal, all_sides: receiver.normal == Vec3::ZERO }
    }

    /// The emitter for `u` in [0, 1), and its probability; `None` where none of the children of a chosen node can send
    /// any light.
    #[inline(never)]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<(usize, f32)> {
        if u < UNIFORM_FRACTION {
            let count = self.emitting.len();
            let chosen = ((u / UNIFORM_FRACTION * count as f64) as usize).min(count - 1);
            let emitter = self.emitting[chosen] as usize;
            return Some((emitter, self.probability(emitter, receiver)));
        }
        let query = self.query(receiver);
        let mut left = (u - UNIFORM_FRACTION) / (1.0 - UNIFORM_FRACTION);
        let mut probability = 1.0;
        let mut node = &self.nodes[0];
        loop {
            let importances = node.importances(&query).map(f64::from);
            let ends = running_sums(importances);
            let sum = ends[WIDTH - 1];
            if sum <= 0.0 {
                return None;
            }
            // The child is found by counting without branches, because it cannot be predicted. A child of weight 0 has
            // equal ends.
            let at = left * sum;
            let mut k = ends[..WIDTH - 1].iter().map(|&end| usize::from(end <= at)).sum::<usize>();
            while importances[k] <= 0.0 {
                // Rounding led beyond the last child with a weight.
                k -= 1;
            }
            left = ((at - (ends[k] - importances[k])) / importances[k]).clamp(0.0, 1.0 - f64::EPSILON);
            probability *= importances[k] / sum;
            let child = node.child[k];
            if child & IS_EMITTER != 0 {
                return Some(((child & !IS_EMITTER) as usize, self.mix_uniform(probability)));
            }
            node = &self.nodes[child as usize];
        }
    }

    /// Probability with which [`LightTree::sample`] returns this emitter.
    #[inline(never)]
    pub fn probability(&self, emitter: usize, receiver: &Receiver) -> f32 {
        let mut slot = self.slot[emitter];
        if slot == NONE {
            return 0.0;
        }
        let query = self.query(receiver);
        let mut probability = 1.0;
        // Upwards, with the same factors in another order.
        while slot != NONE {
            let node = &self.nodes[slot as usize / WIDTH];
            let importances = node.importances(&query).map(f64::from);
            let importance = importances[slot as usize % WIDTH];
            if importance <= 0.0 {
                probability = 0.0;
                break;
            }
            probability *= importance / running_sums(importances)[WIDTH - 1];
            slot = node.parent;
        }
        self.mix_uniform(probability)
    }

    /// Mixes in the uniform choice.
    fn mix_uniform(&self, probability: f64) -> f32 {
        (UNIFORM_FRACTION / self.emitting.len() as f64 + (1.0 - UNIFORM_FRACTION) * probability) as f32
    }
}

/// Running sums of the four values. (In double precision, differences of them are as exact as the smallest value
/// needs.)
#[inline]
fn running_sums([a, b, c, d]: [f64; WIDTH]) -> [f64; WIDTH] {
    [a, a + b, a + b + c, a + b + c + d]
}
