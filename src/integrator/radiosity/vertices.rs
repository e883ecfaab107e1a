//! Irradiance at the vertices of elements, between which the solution is interpolated.
//!
//! Each leaf gathers once more at its three corners over its links, with the form factor at the corner and, for
//! important links, the visibility at the corner; sampled light has its value there. A vertex has the mean of the values that its leaves find. A hanging
//! vertex on the side of a larger leaf has the mean of the side's ends, so that the interpolation has no cracks. At
//! last, vertices are moved towards values whose interpolation holds the irradiance that the elements gathered
//! ([`conserve`]).

use std::f64::consts::FRAC_1_PI;
use std::sync::{Arc, PoisonError};

use super::elements::{Elements, NONE, Node};
use super::light::DirectionalPolynomial;
use super::links::{Link, LinkKind, POINT, intensity, point_factor};
use super::node_irradiance::received;
use super::oracle::RefinementOracle;
use super::refine::{LinkHierarchy, SharedHierarchy};
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;
use crate::sampling::hash;
use crate::spectrum::Rgb;

/// Leaves that one task of the thread pool processes.
const LEAVES_PER_TASK: usize = 64;

/// Light for a corner is gathered at this distance from it towards the centre of its element, because on an edge that
/// two walls share, Lambert's formula is one of several limits.
const INWARDS: f64 = 1e-3;

/// Visibility rays from a corner to the source of a link. They are traced where the link brings more than the allowed
/// error, or more than `PARTLY_VISIBLE` of the allowed error and is partly visible.
const RAYS: u32 = 16;
const PARTLY_VISIBLE: f64 = 0.1;

/// Farther from a point than this, in its radii, an element is treated as a point.
const FAR: f64 = 12.0;

/// Number of iterations of [`conserve`].
const CONSERVE_ITERATIONS: usize = 2;

/// Means over elements have at least this relative uncertainty.
const MEAN_UNCERTAINTY: f64 = 2e-3;

/// A source's radiosity is uneven where it varies by more than this fraction of its mean. At distances below `NEAR`, in
/// radii of the source, the kernel is uneven as well, and its values at the corners do not describe it.
const UNEVEN: f64 = 0.02;
const NEAR: f64 = 2.0;

/// Irradiance at every vertex.
pub(super) fn vertices(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Vec<Rgb>> {
    let received = Arc::new(received(shared, parallel)?);
    let leaves: Arc<[u32]> = leaves(&shared.read().unwrap_or_else(PoisonError::into_inner).oracle.elements).collect();
    let (hierarchy, shared_leaves) = (Arc::clone(shared), Arc::clone(&leaves));
    let found = parallel.map(leaves.len().div_ceil(LEAVES_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let leaves = shared_leaves[block * LEAVES_PER_TASK..].iter().take(LEAVES_PER_TASK);
        leaves.map(|&leaf| leaf_corners(&hierarchy, leaf, &received)).collect::<Vec<_>>()
    })?;
    let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
    let found = leaves.iter().copied().zip(found.into_iter().flatten());
    let irradiance = means_at_vertices(&hierarchy.oracle.elements, found);
    Ok(irradiance.into_iter().map(Rgb::from_f64).collect())
}

/// The mean at each vertex of what leaves find at their corners.
pub(super) fn means_at_vertices(elements: &Elements, found: impl Iterator<Item = (u32, [DVec3; 3])>) -> Vec<DVec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); elements.vertices.len()];
    for (leaf, at_corners) in found {
        let node = &elements.nodes[leaf as usize];
        // The smaller neighbour is more accurate.
        let weight = 1.0 / node.radius;
        for (vertex, irradiance) in node.corners.into_iter().zip(at_corners) {
            let (sum, total) = &mut sums[vertex as usize];
            *sum += weight * irradiance;
            *total += weight;
        }
    }
    let mut irradiance: Vec<DVec3> =
        sums.into_iter().map(|(sum, total)| if total > 0.0 { sum / total } else { DVec3::ZERO }).collect();
    set_hanging(elements, &hanging(elements), &mut irradiance, |a, b| 0.5 * (a + b));
    irradiance
}

/// Moves vertices towards values whose interpolation has the means of `leaves`. Irradiance between corners has rounder
/// peaks than the interpolation, which would lose some of it. The deficit of an element, beyond the uncertainty of its
/// mean, is distributed to its corners and thereby to all elements around them: in sum no light is lost.
pub(super) fn conserve(elements: &Elements, irradiance: &mut [Rgb], leaves: &[(u32, DVec3)]) {
    let hanging = hanging(elements);
    for _ in 0..CONSERVE_ITERATIONS {
        // For each vertex, the deficit times the area around the vertex, and that area.
        let mut deficits = vec![(DVec3::ZERO, 0.0); irradiance.len()];
        for &(leaf, mean) in leaves {
            let node = &elements.nodes[leaf as usize];
            let corners = node.corners.map(|vertex| irradiance[vertex as usize].to_f64());
            let deficit = mean - (corners[0] + corners[1] + corners[2]) / 3.0;
            let uncertainty = MEAN_UNCERTAINTY * mean;
            let deficit = deficit - deficit.clamp(-uncertainty, uncertainty);
            for vertex in node.corners {
                let (sum, area) = &mut deficits[vertex as usize];
                *sum += node.area * deficit;
                *area += node.area;
            }
        }
        // A hanging vertex passes its deficit to its ends, which come before it.
        for vertex in (0..irradiance.len()).rev().filter(|&vertex| hanging[vertex]) {
            let (sum, area) = std::mem::take(&mut deficits[vertex]);
            for end in elements.side_ends[vertex] {
                let (sum_of_end, area_of_end) = &mut deficits[end as usize];
                *sum_of_end += 0.5 * sum;
                *area_of_end += 0.5 * area;
            }
        }
        for (irradiance, (sum, area)) in irradiance.iter_mut().zip(deficits) {
            if area > 0.0 {
                *irradiance = (*irradiance + Rgb::from_f64(sum / area)).max(Rgb::ZERO);
            }
        }
        set_hanging(elements, &hanging, irradiance, |a, b| 0.5 * (a + b));
    }
}

/// Sets hanging vertices to the mean of their ends.
fn set_hanging<T: Copy>(elements: &Elements, hanging: &[bool], values: &mut [T], mean: impl Fn(T, T) -> T) {
    // Ends come before their middle.
    for vertex in (0..values.len()).filter(|&vertex| hanging[vertex]) {
        let [a, b] = elements.side_ends[vertex].map(|end| values[end as usize]);
        values[vertex] = mean(a, b);
    }
}

/// Indices of all elements that are not subdivided.
pub(super) fn leaves(elements: &Elements) -> impl Iterator<Item = u32> {
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

/// Irradiance that a leaf finds at its corners.
fn leaf_corners(hierarchy: &LinkHierarchy, leaf: u32, received: &[DirectionalPolynomial]) -> [DVec3; 3] {
    let oracle = &hierarchy.oracle;
    let elements = &oracle.elements;
    let node = &elements.nodes[leaf as usize];
    // Barycentric weights of the second and third corner.
    let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|at: [f64; 2]| at.map(|w| w + INWARDS * (1.0 / 3.0 - w)));
    let places = elements.triangle(node).map(|p| p + INWARDS * (node.centre - p));
    let hits = weights.map(|at| elements.point(node, at));
    let root = node.area.sqrt();
    let visible = |link: &Link, k: usize, strength: DVec3| {
        let unoccluded_transport = f64::from(link.factor) * strength.max_element() * root;
        let is_partly = link.visible > 0.0 && link.visible < 1.0;
        if unoccluded_transport < oracle.threshold * if is_partly { PARTLY_VISIBLE } else { 1.0 } {
            return f64::from(link.visible);
        }
        let (at, n) = hits[k];
        let key = hash(hash(u64::from(leaf), k as u64), u64::from(link.source));
        oracle.point_visibility(at, n, link.source, RAYS, key)
    };
    let (sums, from_clusters) = gather_over(hierarchy, leaf, &places, received, |_| false, &visible);
    let sampled = hierarchy.sampled_at_corners(leaf);
    std::array::from_fn(|k| sums[k] + from_clusters + sampled[k])
}

/// Irradiance at some points of a leaf by its own links and those of the elements above it, and the irradiance that
/// clusters bring to the whole leaf. `is_hidden`: links that bring no light; `visible`: the visible fraction of a
/// link's source from one of the points, given the source's strength.
pub(super) fn gather_over<const N: usize>(
    hierarchy: &LinkHierarchy,
    leaf: u32,
    places: &[DVec3; N],
    received: &[DirectionalPolynomial],
    is_hidden: impl Fn(&Link) -> bool,
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
) -> ([DVec3; N], DVec3) {
    let elements = &hierarchy.oracle.elements;
    let node = &elements.nodes[leaf as usize];
    let mut sums = [DVec3::ZERO; N];
    let mut at = leaf;
    loop {
        for link in hierarchy.links_of(at).iter().filter(|link| link.kind == LinkKind::Element && !is_hidden(link)) {
            gather_at(hierarchy, link, node, places, visible, &mut sums);
        }
        match elements.parent_element(at) {
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

/// Adds one link's irradiance at some points of a leaf, where the leaf is the link's receiver or below it.
fn gather_at(
    hierarchy: &LinkHierarchy,
    link: &Link,
    leaf: &Node,
    places: &[DVec3],
    visible: &impl Fn(&Link, usize, DVec3) -> f64,
    sums: &mut [DVec3],
) {
    let oracle = &hierarchy.oracle;
    let mut add = |k: usize, factor: f64, strength: DVec3| {
        if factor > 0.0 {
            sums[k] += visible(link, k, strength) * factor * strength;
        }
    };
    if link.source >= POINT {
        let light = &oracle.lights[(link.source - POINT) as usize];
        for (k, p) in places.iter().enumerate() {
            add(k, point_factor(light.position - *p, leaf.normal), light.intensity);
        }
        return;
    }
    let source = &oracle.elements.nodes[link.source as usize];
    if source.is_cluster() {
        for (k, p) in places.iter().enumerate() {
            let way = source.centre - *p;
            let intensity = intensity(source, &oracle.radiosity, -way.normalize_or_zero());
            add(k, point_factor(way, leaf.normal), intensity);
        }
        return;
    }
    if oracle.radiosity.largest[link.source as usize] == 0.0 {
        return;
    }
    for (k, &p) in places.iter().enumerate() {
        let (factor, light) = from_element(oracle, p, leaf.normal, link.source);
        if factor > 0.0 {
            add(k, factor, light / factor);
        }
    }
}

/// The form factor of an element from a point with this normal, and the irradiance of the fully visible element. Lamps with a texture
/// are evaluated by the children of the element, whose radiosities the link took as accurate: edges of a texture are nothing linear.
fn from_element(oracle: &RefinementOracle, p: DVec3, n: DVec3, number: u32) -> (f64, DVec3) {
    let source = &oracle.elements.nodes[number as usize];
    if oracle.elements.is_uneven_lamp(number) && !source.is_leaf() {
        return sum_of_parts(source, |part| from_part(oracle, p, n, part));
    }
    from_part(oracle, p, n, number)
}

/// The sum of factors and irradiances over the children of an element.
fn sum_of_parts(source: &Node, of: impl Fn(u32) -> (f64, DVec3)) -> (f64, DVec3) {
    let parts = source.range().map(|part| of(part as u32));
    parts.fold((0.0, DVec3::ZERO), |sum, part| (sum.0 + part.0, sum.1 + part.1))
}

/// [`from_element`] of an element whose radiosity varies about linearly. A near and uneven element is evaluated by its children.
fn from_part(oracle: &RefinementOracle, p: DVec3, n: DVec3, number: u32) -> (f64, DVec3) {
    let source = &oracle.elements.nodes[number as usize];
    let way = source.centre - p;
    let distance2 = way.length_squared();
    let b = oracle.radiosity.b[number as usize];
    let is_uneven = f64::from(oracle.radiosity.spread[number as usize]) > UNEVEN * b.max_element();
    if is_uneven && distance2 < (NEAR * source.radius).powi(2) {
        return sum_of_parts(source, |part| from_part(oracle, p, n, part));
    }
    let corners = oracle.elements.triangle(source);
    let factor = if distance2 > (FAR * source.radius).powi(2) {
        let cosine = (-way.dot(source.normal)).max(0.0) / distance2.sqrt();
        point_factor(way, n) * cosine * source.window() * FRAC_1_PI
    } else {
        oracle.elements.factor_at(p, n, source)
    };
    let is_tilted = is_uneven && factor > 0.0;
    (factor, factor * if is_tilted { radiosity_seen_from(p, n, &corners, oracle, number) } else { b })
}

/// The mean radiosity of a source as weighted by the kernel at a point: a part that is near usually is bright as well,
/// so that the mean by area would be too small. The kernel is interpolated linearly between its values at the corners.
fn radiosity_seen_from(p: DVec3, n: DVec3, corners: &[DVec3; 3], oracle: &RefinementOracle, source: u32) -> DVec3 {
    let node = &oracle.elements.nodes[source as usize];
    let kernel = corners.map(|corner| {
        let way = corner - p;
        let facing = oracle.elements.normal_at(corner, node);
        let cosines = way.dot(n).max(0.0) * (-way.dot(facing)).max(0.0);
        cosines / way.length_squared().powi(2)
    });
    let total = kernel[0] + kernel[1] + kernel[2];
    let b = oracle.radiosity.b[source as usize];
    if total > 0.0 {
        let [first, second] = oracle.radiosity.tilt[source as usize].map(|tilt| tilt.to_f64());
        let more = first * (kernel[0] - kernel[2]) + second * (kernel[1] - kernel[2]);
        (b + 3.0 / total * more).max(DVec3::ZERO)
    } else {
        b
    }
}
