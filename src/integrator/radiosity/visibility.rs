//! Visibility of links: rays between two nodes, and between a vertex and a node.
//!
//! Rays that decide whether a pair is divided are others than those that say how much of it is visible: a share that had to pass
//! that test would be a biased one. Rays count by the light that they bring, not by their number.

use super::elements::NONE;
use super::judge::Judge;
use super::links::{Kind, Link, POINT, point_factor};
use crate::math::{DVec3, HitPoint, Ray, Vec3};
use crate::sampling::hash;

/// Rays that say what is visible of a link: of little light, and of much.
const LOOKS: [u32; 2] = [16, 64];

/// Rays that decide, and others that say how much is seen.
const DECIDING: u64 = 1;
const KEPT: u64 = 2;

/// Rays keep this share of the way to the middle from an element's sides: where two walls meet at less than a right angle,
/// what is moved off the one by a rounding error may be behind the other.
const INWARDS: f64 = 1e-3;

/// So far above an element, in its radii, rays find what stands on it.
const ABOVE: f64 = 3e-3;

impl Judge {
    /// What is visible of a link, by what is sent now and by rays that had no say in whether to divide.
    pub fn look_again(&self, link: &Link) -> f32 {
        if link.kind == Kind::Dim {
            return link.visible;
        }
        let is_much = self.stake(link) > self.threshold;
        self.visible(link.receiver, link.source, LOOKS[usize::from(is_much)], KEPT) as f32
    }

    /// The share of the light between two nodes that nothing blocks, by `count` rays that may decide what becomes of the pair.
    pub fn seen(&self, receiver: u32, source: u32, count: u32) -> f64 {
        self.visible(receiver, source, count, DECIDING)
    }

    /// The same by rays of one leaf below a link's receiver, which may see more or less of the source than the whole.
    pub fn visible_from(&self, leaf: u32, source: u32, count: u32) -> f64 {
        self.visible(leaf, source, count, KEPT)
    }

    fn visible(&self, receiver: u32, source: u32, count: u32, salt: u64) -> f64 {
        let key = hash(hash(u64::from(receiver), u64::from(source)), salt);
        let towards = self.centre(source);
        self.share_seen(|u, random| self.place(receiver, u, random, towards), self.centre(receiver), source, count, key)
    }

    /// The share of a source's light that nothing blocks on its way to a point, by `count` rays; `key`: a random number.
    pub fn visible_at(&self, at: HitPoint, n: Vec3, source: u32, count: u32, key: u64) -> f64 {
        let place = Place { at, n, leaf: NONE, weights: [0.0; 2], area: 1.0 };
        self.share_seen(|_, _| Some(place), at.p.as_dvec3(), source, count, key)
    }

    /// The share of a source's light that nothing blocks on its way to where `receiver` says, which is around `centre`.
    ///
    /// Of the light: what is hidden of a source is often what is dark of it, such as the floor under a box, of which the
    /// source's mean radiosity knows already.
    fn share_seen(
        &self,
        receiver: impl Fn([f64; 2], u64) -> Option<Place>,
        centre: DVec3,
        source: u32,
        count: u32,
        key: u64,
    ) -> f64 {
        // A sequence of low discrepancy in four dimensions: powers of the root of x^5 = x + 1. (Roberts 2018.)
        const STEPS: [f64; 4] =
            [0.856_674_883_854_502_9, 0.733_891_856_627_126_2, 0.628_706_721_037_808_3, 0.538_597_257_472_236_5];
        let start: [f64; 4] = std::array::from_fn(|i| (hash(key, i as u64) >> 11) as f64 / (1_u64 << 53) as f64);
        // By light, and by form factor alone.
        let (mut sum, mut total) = ([0.0; 2], [0.0; 2]);
        for i in 0..count {
            let u: [f64; 4] = std::array::from_fn(|k| (start[k] + f64::from(i) * STEPS[k]).fract());
            let random = hash(key, 16 + u64::from(i));
            let Some(Place { at: p, n, area, .. }) = receiver([u[0], u[1]], random) else { continue };
            let (weight, b, shadow) = if source >= POINT {
                let light = self.lights[(source - POINT) as usize].position;
                let origin = p.offset(n);
                // Not quite there, as for other shadow rays.
                let direction = (light.as_vec3a() - origin) * (1.0 - 16.0 * f32::EPSILON);
                let weight = point_factor(light - p.p.as_dvec3(), n.as_dvec3());
                (weight, 1.0, Ray { origin, direction, tnear: 0.0, tfar: 1.0 })
            } else {
                let other = self.place(source, [u[2], u[3]], hash(random, 1), centre);
                let Some(Place { at: q, n: m, leaf, weights, area }) = other else { continue };
                let way = q.p - p.p;
                let distance2 = f64::from(way.length_squared());
                let cosines = f64::from(way.dot(n).max(0.0)) * f64::from((-way.dot(m)).max(0.0));
                let origin = p.offset(n);
                let target = q.seen_from(way.length()).offset(m);
                let weight = if cosines > 0.0 { cosines / (distance2 * distance2) } else { 0.0 };
                let b = self.brightness(leaf, weights);
                (weight * area, b, Ray { origin, direction: target - origin, tnear: 0.0, tfar: 1.0 })
            };
            if weight > 0.0 && weight.is_finite() {
                let weight = weight * area;
                let weights = [weight * b, weight];
                let share = if self.scene.unoccluded(&shadow) { 1.0 } else { 0.0 };
                for k in 0..2 {
                    total[k] += weights[k];
                    sum[k] += share * weights[k];
                }
            }
        }
        // Where no ray could say, nothing is known to be in between, and little light to be lost.
        let ratio = |k: usize| (total[k] > 0.0).then(|| sum[k] / total[k]);
        ratio(0).or_else(|| ratio(1)).unwrap_or(1.0)
    }

    /// Whether something stands on an element: rays close above it, from side to side, meet it.
    pub fn is_cut(&self, number: u32) -> bool {
        let node = self.node(number);
        if self.elements.shape(node.patch).is_some() {
            return false;
        }
        let [a, b, c] =
            self.elements.triangle(node).map(|p| p + 0.01 * (node.centre - p) + ABOVE * node.radius * node.normal);
        let across = [a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let ends = [(0, 1), (1, 2), (2, 0), (0, 4), (1, 5), (2, 3)];
        ends.iter().any(|&(from, to)| {
            let [origin, target] = [across[from], across[to]].map(|p| p.as_vec3a());
            !self.scene.unoccluded(&Ray { origin, direction: target - origin, tnear: 0.0, tfar: 1.0 })
        })
    }

    /// Radiosity within a leaf, all channels.
    fn brightness(&self, leaf: u32, [s, t]: [f64; 2]) -> f64 {
        let node = self.node(leaf);
        if self.at_vertices.is_empty() {
            return self.sent.b[leaf as usize].element_sum();
        }
        let patch = &self.elements.patches[node.patch as usize];
        let [a, b, c] = node.corners.map(|vertex| self.at_vertices[vertex as usize].to_f64());
        (patch.emitted + patch.albedo * (a * (1.0 - s - t) + b * s + c * t)).element_sum()
    }

    fn centre(&self, number: u32) -> DVec3 {
        if number >= POINT { self.lights[(number - POINT) as usize].position } else { self.node(number).centre }
    }

    /// A point of a node, of a cluster on a patch that faces `towards` if there is one soon.
    fn place(&self, number: u32, u: [f64; 2], random: u64, towards: DVec3) -> Option<Place> {
        let mut number = number;
        let mut node = self.node(number);
        if node.is_cluster() {
            let [start, end, _] = node.corners;
            let mut found = None;
            for i in 0..4 {
                let step = ((hash(random, i) >> 32) * u64::from(end - start)) >> 32;
                let patch = self.elements.order[start as usize + step as usize];
                let root = self.elements.patches[patch as usize].node;
                let member = self.node(root);
                if (towards - member.centre).dot(member.normal) > 0.0 {
                    found = Some(root);
                    break;
                }
            }
            number = found?;
            node = self.node(number);
        }
        let weights = if u[0] + u[1] > 1.0 { [1.0 - u[0], 1.0 - u[1]] } else { u };
        let weights = weights.map(|w| w + INWARDS * (1.0 / 3.0 - w));
        let (at, n) = self.elements.point(node, weights);
        let (leaf, weights) = self.elements.leaf_below(number, weights);
        Some(Place { at, n, leaf, weights, area: node.area })
    }
}

/// A point of an element.
#[derive(Clone, Copy)]
struct Place {
    at: HitPoint,
    n: Vec3,
    /// The leaf that it is of.
    leaf: u32,
    /// Its weights of the leaf's second and third corner.
    weights: [f64; 2],
    /// Of the patch that was chosen.
    area: f64,
}
