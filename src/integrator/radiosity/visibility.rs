//! Visibility of links: rays between two nodes, and between a vertex and a node.
//!
//! The rays that decide whether a pair is subdivided are independent of the rays that measure its visible fraction,
//! because a fraction that had to pass that test would be biased. Rays are weighted by the light that they carry.

use super::elements::NONE;
use super::links::{Link, LinkKind, POINT, point_factor};
use super::oracle::RefinementOracle;
use crate::math::{DVec3, HitPoint, Ray, Vec3};
use crate::sampling::hash;

/// Rays that measure the visible fraction of a link that carries little light, and of one that carries much.
const MEASURING_RAYS: [u32; 2] = [16, 64];

/// Salts of the random numbers: for the rays that decide, and for the rays that measure the visible fraction.
const DECIDING_SALT: u64 = 1;
const MEASURING_SALT: u64 = 2;

/// Points of rays keep this fraction of the distance to the centre from an element's sides. Where two walls meet at
/// less than a right angle, a point that is offset from one wall by a rounding error may be behind the other.
const INWARDS: f64 = 1e-3;

/// Height over an element, in its radii, at which rays find surfaces that touch it.
const CONTACT_HEIGHT: f64 = 3e-3;

impl RefinementOracle {
    /// The visible fraction of a link, by the current radiosities and by rays that did not decide whether to subdivide.
    pub fn measure_visibility(&self, link: &Link) -> f32 {
        if link.kind == LinkKind::Negligible {
            return link.visible;
        }
        let is_much = self.unoccluded_transport(link) > self.threshold;
        self.visible(link.receiver, link.source, MEASURING_RAYS[usize::from(is_much)], MEASURING_SALT) as f32
    }

    /// The visible fraction of the light between two nodes, by `count` rays that may decide what happens to the pair.
    pub fn trial_visibility(&self, receiver: u32, source: u32, count: u32) -> f64 {
        self.visible(receiver, source, count, DECIDING_SALT)
    }

    /// The same by rays from one leaf below a link's receiver, which may see more or less of the source than the
    /// receiver.
    pub fn leaf_visibility(&self, leaf: u32, source: u32, count: u32) -> f64 {
        self.visible(leaf, source, count, MEASURING_SALT)
    }

    fn visible(&self, receiver: u32, source: u32, count: u32, salt: u64) -> f64 {
        let key = hash(hash(u64::from(receiver), u64::from(source)), salt);
        let towards = self.centre(source);
        self.visible_fraction(
            |u, random| self.sample_point(receiver, u, random, towards),
            self.centre(receiver),
            source,
            count,
            key,
        )
    }

    /// The visible fraction of a source's light at a point, by `count` rays; `key`: a random number.
    pub fn point_visibility(&self, at: HitPoint, n: Vec3, source: u32, count: u32, key: u64) -> f64 {
        let sample_point = SampledPoint { at, n, leaf: NONE, weights: [0.0; 2], area: 1.0 };
        self.visible_fraction(|_, _| Some(sample_point), at.p.as_dvec3(), source, count, key)
    }

    /// The visible fraction of a source's light at the points that `receiver` samples around `centre`.
    ///
    /// The fraction is one of light: the hidden part of a source is often its dark part, such as the floor under a box,
    /// and the source's mean radiosity accounts for that already.
    fn visible_fraction(
        &self,
        receiver: impl Fn([f64; 2], u64) -> Option<SampledPoint>,
        centre: DVec3,
        source: u32,
        count: u32,
        key: u64,
    ) -> f64 {
        // A sequence of low discrepancy in four dimensions: powers of the root of x^5 = x + 1. (Roberts 2018.)
        const STEPS: [f64; 4] =
            [0.856_674_883_854_502_9, 0.733_891_856_627_126_2, 0.628_706_721_037_808_3, 0.538_597_257_472_236_5];
        let start: [f64; 4] = std::array::from_fn(|i| (hash(key, i as u64) >> 11) as f64 / (1_u64 << 53) as f64);
        // Sums weighted by light, and weighted by form factor alone.
        let (mut sum, mut total) = ([0.0; 2], [0.0; 2]);
        for i in 0..count {
            let u: [f64; 4] = std::array::from_fn(|k| (start[k] + f64::from(i) * STEPS[k]).fract());
            let random = hash(key, 16 + u64::from(i));
            let Some(SampledPoint { at: p, n, area, .. }) = receiver([u[0], u[1]], random) else { continue };
            let (weight, b, shadow) = if source >= POINT {
                let light = self.lights[(source - POINT) as usize].position;
                let origin = p.offset(n);
                // The ray ends just before the light, as other shadow rays do.
                let direction = (light.as_vec3a() - origin) * (1.0 - 16.0 * f32::EPSILON);
                let weight = point_factor(light - p.p.as_dvec3(), n.as_dvec3());
                (weight, 1.0, Ray::segment(origin, direction, 1.0))
            } else {
                let other = self.sample_point(source, [u[2], u[3]], hash(random, 1), centre);
                let Some(SampledPoint { at: q, n: m, leaf, weights, area }) = other else { continue };
                let way = q.p - p.p;
                let distance2 = f64::from(way.length_squared());
                let cosines = f64::from(way.dot(n).max(0.0)) * f64::from((-way.dot(m)).max(0.0));
                let origin = p.offset(n);
                let target = q.seen_from(way.length()).offset(m);
                let weight = if cosines > 0.0 { cosines / (distance2 * distance2) } else { 0.0 };
                let b = self.radiosity_at(leaf, weights);
                (weight * area, b, Ray::segment(origin, target - origin, 1.0))
            };
            if weight > 0.0 && weight.is_finite() {
                let weight = weight * area;
                let weights = [weight * b, weight];
                let is_visible = if self.scene.unoccluded(&shadow) { 1.0 } else { 0.0 };
                for k in 0..2 {
                    total[k] += weights[k];
                    sum[k] += is_visible * weights[k];
                }
            }
        }
        // Where no ray carries any weight, no blocker is known, and little light can be lost.
        let ratio = |k: usize| (total[k] > 0.0).then(|| sum[k] / total[k]);
        ratio(0).or_else(|| ratio(1)).unwrap_or(1.0)
    }

    /// Whether another surface touches an element: rays close above the element, from side to side, hit one.
    pub fn has_contact(&self, number: u32) -> bool {
        let node = self.node(number);
        if self.elements.shape(node.patch).is_some() {
            return false;
        }
        let [a, b, c] = self
            .elements
            .triangle(node)
            .map(|p| p + 0.01 * (node.centre - p) + CONTACT_HEIGHT * node.radius * node.normal);
        let across = [a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        let ends = [(0, 1), (1, 2), (2, 0), (0, 4), (1, 5), (2, 3)];
        ends.iter().any(|&(from, to)| {
            let [origin, target] = [across[from], across[to]].map(|p| p.as_vec3a());
            !self.scene.unoccluded(&Ray::segment(origin, target - origin, 1.0))
        })
    }

    /// Radiosity at a point of a leaf, summed over the channels.
    fn radiosity_at(&self, leaf: u32, [s, t]: [f64; 2]) -> f64 {
        let node = self.node(leaf);
        if self.at_vertices.is_empty() {
            return self.radiosity.b[leaf as usize].element_sum();
        }
        let [a, b, c] = node.corners.map(|vertex| self.at_vertices[vertex as usize].to_f64());
        (self.elements.emitted(leaf) + self.elements.albedo(leaf) * (a * (1.0 - s - t) + b * s + c * t)).element_sum()
    }

    fn centre(&self, number: u32) -> DVec3 {
        if number >= POINT { self.lights[(number - POINT) as usize].position } else { self.node(number).centre }
    }

    /// A random point of a node. For a cluster, the point is on a patch that faces `towards`, if a few tries find one.
    fn sample_point(&self, number: u32, u: [f64; 2], random: u64, towards: DVec3) -> Option<SampledPoint> {
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
        Some(SampledPoint { at, n, leaf, weights, area: node.area })
    }
}

/// A sampled point of an element.
#[derive(Clone, Copy)]
struct SampledPoint {
    at: HitPoint,
    n: Vec3,
    /// The leaf that holds the point.
    leaf: u32,
    /// Barycentric weights of the leaf's second and third corner.
    weights: [f64; 2],
    /// Area of the patch that was chosen.
    area: f64,
}
