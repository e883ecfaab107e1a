//! Irradiance at the vertices of elements, between which the solution is interpolated.
//!
//! Each leaf gathers once more at its three corners over its links, with the form factor at the corner and, for
//! important links, the visibility at the corner; sampled light has its value there. A vertex has the mean of the values that its leaves find. A hanging
//! vertex on the side of a larger leaf has the mean of the side's ends, so that the interpolation has no cracks. At
//! last, vertices are moved towards values whose interpolation holds the irradiance that the elements gathered
//! ([`conserve`]).

use std::sync::{Arc, PoisonError};

use super::elements::Elements;
use super::gather::gather_over;
use super::light::DirectionalPolynomial;
use super::links::Link;
use super::node_irradiance::received;
use super::refine::{LinkHierarchy, SharedHierarchy};
use super::rows;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;
use crate::sampling::hash;
use crate::spectrum::Rgb;

/// Leaves that one task of the thread pool processes.
pub(super) const LEAVES_PER_TASK: usize = 64;

/// Light for a corner is gathered at this distance from it towards the centre of its element, because on an edge that
/// two walls share, Lambert's formula is one of several limits.
const INWARDS: f64 = 1e-3;

/// Visibility rays from a corner to the source of a link. They are traced where the link brings more than the allowed
/// error, or more than `PARTLY_VISIBLE` of the allowed error and is partly visible.
const RAYS: u32 = 16;
const PARTLY_VISIBLE: f64 = 0.1;

/// Number of iterations of [`conserve`].
const CONSERVE_ITERATIONS: usize = 2;

/// Means over elements have at least this relative uncertainty.
const MEAN_UNCERTAINTY: f64 = 2e-3;

/// Irradiance at every vertex.
pub(super) fn vertices(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Vec<Rgb>> {
    let received = Arc::new(received(shared, parallel)?);
    rows::update(shared, parallel)?;
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

/// The mean irradiance of the leaves around each vertex, which takes hardly any time.
pub(super) fn means(elements: &Elements, leaves: &[(u32, DVec3)]) -> Vec<Rgb> {
    let found = leaves.iter().map(|&(leaf, mean)| (leaf, [mean; 3]));
    means_at_vertices(elements, found).into_iter().map(Rgb::from_f64).collect()
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
    let gathered = gather_over(hierarchy, leaf, &places, received, |_| false, &visible);
    let sampled = hierarchy.sampled_at_corners(leaf);
    let rows = hierarchy.rows.as_deref();
    let balance = rows.map_or(DVec3::ONE, |rows| rows.balance);
    std::array::from_fn(|k| {
        let [of_points, of_surfaces] = gathered.at(k, leaf, rows.map(|rows| (rows, rows.shift(leaf))));
        of_points + balance * of_surfaces + sampled[k]
    })
}
