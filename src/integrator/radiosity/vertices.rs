//! The solution between elements: irradiance at their vertices.
//!
//! Each leaf gathers once more at its three corners, over the links that it has: form factors are those at the corner, and so is
//! the visibility of what matters. A vertex has the mean of what the leaves around it find. One that hangs on the side of a
//! larger leaf has the mean of the side's ends, so that the interpolation has no cracks. At last vertices are moved towards where
//! the interpolation holds as much light as came to the elements ([`conserve`]).

use std::f64::consts::FRAC_1_PI;
use std::sync::{Arc, PoisonError};

use super::elements::{Elements, NONE, Node};
use super::form_factor::point_to_front;
use super::judge::Judge;
use super::light::Moments;
use super::links::{Kind, Link, POINT, intensity, point_factor};
use super::refine::{Network, Shared};
use super::solve::received;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;
use crate::sampling::hash;
use crate::spectrum::Rgb;

/// Leaves of one thread at a time.
const BLOCK: usize = 64;

/// So far from a corner towards the middle of its element light is gathered for it: on an edge that two walls share, Lambert's
/// formula is any of its limits.
const INWARDS: f64 = 1e-3;

/// Rays from a corner to the source of a link: where it brings more than is allowed to be wrong, or this share of it and is
/// seen in part.
const RAYS: u32 = 16;
const PARTLY: f64 = 0.1;

/// Farther from a point than this, in its radii, an element sends what a point would.
const FAR: f64 = 12.0;

/// How often vertices are moved to where they hold the light of the elements around them.
const CONSERVED: usize = 2;

/// Means over elements are known to no less than this share of them.
const KNOWN: f64 = 2e-3;

/// A source whose radiosities differ by more than this share of their mean is uneven; nearer than this, in its radii, so is the
/// kernel, and its values at the corners do not tell how.
const UNEVEN: f64 = 0.02;
const NEAR: f64 = 2.0;

/// Irradiance at every vertex.
pub(super) fn vertices(shared: &Shared, parallel: &mut impl Parallel) -> Result<Vec<Rgb>> {
    let received = Arc::new(received(shared, parallel)?);
    let leaves: Arc<[u32]> = leaves(&shared.read().unwrap_or_else(PoisonError::into_inner).judge.elements).collect();
    let network = Arc::clone(shared);
    let found = parallel.map(leaves.len().div_ceil(BLOCK), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let leaves = leaves[block * BLOCK..].iter().take(BLOCK);
        leaves.map(|&leaf| leaf_corners(&network, leaf, &received)).collect::<Vec<_>>()
    })?;
    let network = shared.read().unwrap_or_else(PoisonError::into_inner);
    let elements = &network.judge.elements;
    let mut sums = vec![(DVec3::ZERO, 0.0); elements.vertices.len()];
    for Corner { vertex, weight, irradiance } in found.into_iter().flatten().flatten() {
        let (sum, total) = &mut sums[vertex as usize];
        *sum += weight * irradiance;
        *total += weight;
    }
    let mut irradiance: Vec<DVec3> =
        sums.into_iter().map(|(sum, total)| if total > 0.0 { sum / total } else { DVec3::ZERO }).collect();
    hang(elements, &hanging(elements), &mut irradiance, |a, b| 0.5 * (a + b));
    Ok(irradiance.into_iter().map(Rgb::from_f64).collect())
}

/// Moves vertices towards where the means over elements, interpolated, are those of `leaves`: light's peaks are rounder between
/// corners than the interpolation is, which would lack some. What is missing from an element, beyond what its mean is known to,
/// goes to its corners and so to all elements around them: in sum none of it is lost.
pub(super) fn conserve(elements: &Elements, irradiance: &mut [Rgb], leaves: &[(u32, DVec3)]) {
    let hanging = hanging(elements);
    for _ in 0..CONSERVED {
        // Of each vertex: what it lacks times the area that it stands for, and that area.
        let mut lacks = vec![(DVec3::ZERO, 0.0); irradiance.len()];
        for &(leaf, mean) in leaves {
            let node = &elements.nodes[leaf as usize];
            let corners = node.corners.map(|vertex| irradiance[vertex as usize].to_f64());
            let lack = mean - (corners[0] + corners[1] + corners[2]) / 3.0;
            let known = KNOWN * mean;
            let lack = lack - lack.clamp(-known, known);
            for vertex in node.corners {
                let (sum, area) = &mut lacks[vertex as usize];
                *sum += node.area * lack;
                *area += node.area;
            }
        }
        // A middle's share is that of its ends, which come before it.
        for vertex in (0..irradiance.len()).rev().filter(|&vertex| hanging[vertex]) {
            let (sum, area) = std::mem::take(&mut lacks[vertex]);
            for end in elements.ends[vertex] {
                let (sum_of_end, area_of_end) = &mut lacks[end as usize];
                *sum_of_end += 0.5 * sum;
                *area_of_end += 0.5 * area;
            }
        }
        for (irradiance, (sum, area)) in irradiance.iter_mut().zip(lacks) {
            if area > 0.0 {
                *irradiance = (*irradiance + Rgb::from_f64(sum / area)).max(Rgb::ZERO);
            }
        }
        hang(elements, &hanging, irradiance, |a, b| 0.5 * (a + b));
    }
}

/// Gives hanging vertices the mean of their ends.
fn hang<T: Copy>(elements: &Elements, hanging: &[bool], values: &mut [T], mean: impl Fn(T, T) -> T) {
    // Ends come before their middle.
    for vertex in (0..values.len()).filter(|&vertex| hanging[vertex]) {
        let [a, b] = elements.ends[vertex].map(|end| values[end as usize]);
        values[vertex] = mean(a, b);
    }
}

/// Numbers of all elements that are not divided.
fn leaves(elements: &Elements) -> impl Iterator<Item = u32> {
    let nodes = elements.nodes.iter().zip(0..);
    nodes.filter(|(node, _)| node.is_leaf() && !node.is_cluster()).map(|(_, number)| number)
}

/// Which vertices are in the middle of a side of some leaf.
fn hanging(elements: &Elements) -> Vec<bool> {
    let mut hanging = vec![false; elements.vertices.len()];
    for leaf in leaves(elements) {
        let [a, b, c] = elements.nodes[leaf as usize].corners;
        let mut sides = vec![[a, b], [b, c], [c, a]];
        while let Some([a, b]) = sides.pop() {
            if let Some(middle) = elements.known_middle([a, b]) {
                hanging[middle as usize] = true;
                sides.extend([[a, middle], [middle, b]]);
            }
        }
    }
    hanging
}

/// What a leaf finds at one of its corners.
struct Corner {
    vertex: u32,
    weight: f64,
    irradiance: DVec3,
}

fn leaf_corners(network: &Network, leaf: u32, received: &[Moments]) -> [Corner; 3] {
    let judge = &network.judge;
    let elements = &judge.elements;
    let node = &elements.nodes[leaf as usize];
    // Of the second and third corner.
    let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|at: [f64; 2]| at.map(|w| w + INWARDS * (1.0 / 3.0 - w)));
    let places = elements.triangle(node).map(|p| p + INWARDS * (node.centre - p));
    let hits = weights.map(|at| elements.point(node, at));
    let root = node.area.sqrt();
    let visible = |link: &Link, k: usize, strength: DVec3| {
        let stake = f64::from(link.factor) * strength.max_element() * root;
        let is_partly = link.visible > 0.0 && link.visible < 1.0;
        if stake < judge.threshold * if is_partly { PARTLY } else { 1.0 } {
            return f64::from(link.visible);
        }
        let (at, n) = hits[k];
        let key = hash(hash(u64::from(leaf), k as u64), u64::from(link.source));
        judge.visible_at(at, n, link.source, RAYS, key)
    };
    let (sums, from_clusters) = gather_over(network, leaf, &places, received, |_| false, &visible);
    let sums = sums.map(|sum| sum + from_clusters);
    // The smaller neighbour knows better.
    let weight = 1.0 / node.radius;
    std::array::from_fn(|k| Corner { vertex: node.corners[k], weight, irradiance: sums[k] })
}

/// Irradiance at some places of a leaf by its own links and those of the elements above it, and what clusters bring to all of it.
/// `is_hidden`: links that bring nothing; `visible`: what is seen of another one's source, which is so strong, from one of the
/// places.
pub(super) fn gather_over<const N: usize>(
    network: &Network,
    leaf: u32,
    places: &[DVec3; N],
    received: &[Moments],
    is_hidden: impl Fn(&Link) -> bool,
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
) -> ([DVec3; N], DVec3) {
    let elements = &network.judge.elements;
    let node = &elements.nodes[leaf as usize];
    let mut sums = [DVec3::ZERO; N];
    let mut at = leaf;
    loop {
        for link in network.links_of(at).iter().filter(|link| link.kind == Kind::Element && !is_hidden(link)) {
            gather_at(network, link, node, places, visible, &mut sums);
        }
        match elements.element_above(at) {
            Some(above) => at = above,
            None => break,
        }
    }
    let from_clusters = match elements.nodes[at as usize].parent {
        NONE => DVec3::ZERO,
        cluster => received[elements.nodes[cluster as usize].corners[2] as usize].at(node.normal),
    };
    (sums, from_clusters)
}

/// Adds one link's irradiance at some places of a leaf, the link's receiver or below it.
fn gather_at(
    network: &Network,
    link: &Link,
    leaf: &Node,
    places: &[DVec3],
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
    sums: &mut [DVec3],
) {
    let judge = &network.judge;
    let mut add = |k: usize, factor: f64, strength: DVec3| {
        if factor > 0.0 {
            sums[k] += visible(link, k, strength) * factor * strength;
        }
    };
    if link.source >= POINT {
        let light = &judge.lights[(link.source - POINT) as usize];
        for (k, p) in places.iter().enumerate() {
            add(k, point_factor(light.position - *p, leaf.normal), light.intensity);
        }
        return;
    }
    let source = &judge.elements.nodes[link.source as usize];
    if source.is_cluster() {
        for (k, p) in places.iter().enumerate() {
            let way = source.centre - *p;
            let intensity = intensity(source, &judge.sent, -way.normalize_or_zero());
            add(k, point_factor(way, leaf.normal), intensity);
        }
        return;
    }
    if judge.sent.most[link.source as usize] == 0.0 {
        return;
    }
    for (k, &p) in places.iter().enumerate() {
        let (factor, light) = from_element(judge, p, leaf.normal, link.source);
        if factor > 0.0 {
            add(k, factor, light / factor);
        }
    }
}

/// The form factor of an element from a place with this normal, and the irradiance that it brings if all of it is seen. Where it
/// is near and uneven, its parts are asked.
fn from_element(judge: &Judge, p: DVec3, n: DVec3, number: u32) -> (f64, DVec3) {
    let source = &judge.elements.nodes[number as usize];
    let way = source.centre - p;
    let distance2 = way.length_squared();
    let b = judge.sent.b[number as usize];
    let is_uneven = f64::from(judge.sent.spread[number as usize]) > UNEVEN * b.max_element();
    if is_uneven && distance2 < (NEAR * source.radius).powi(2) {
        let parts = source.range().map(|part| from_element(judge, p, n, part as u32));
        return parts.fold((0.0, DVec3::ZERO), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    }
    let corners = judge.elements.triangle(source);
    let factor = if distance2 > (FAR * source.radius).powi(2) {
        let cosine = (-way.dot(source.normal)).max(0.0) / distance2.sqrt();
        point_factor(way, n) * cosine * source.area * FRAC_1_PI
    } else {
        point_to_front(p, n, &corners, source.normal) * source.swell
    };
    let is_tilted = is_uneven && factor > 0.0;
    (factor, factor * if is_tilted { seen_from(p, n, &corners, source.normal, judge, number) } else { b })
}

/// The mean radiosity of a source as seen from a place: what is near is bright, usually, so that the mean by area would lack
/// some. The kernel is taken to be even between its values at the corners.
fn seen_from(p: DVec3, n: DVec3, corners: &[DVec3; 3], facing: DVec3, judge: &Judge, source: u32) -> DVec3 {
    let kernel = corners.map(|corner| {
        let way = corner - p;
        let cosines = way.dot(n).max(0.0) * (-way.dot(facing)).max(0.0);
        cosines / way.length_squared().powi(2)
    });
    let total = kernel[0] + kernel[1] + kernel[2];
    let b = judge.sent.b[source as usize];
    if total > 0.0 {
        let [first, second] = judge.sent.tilt[source as usize].map(|tilt| tilt.to_f64());
        let more = first * (kernel[0] - kernel[2]) + second * (kernel[1] - kernel[2]);
        (b + 3.0 / total * more).max(DVec3::ZERO)
    } else {
        b
    }
}
