//! Irradiance of elements and clusters by the current radiosities, gathered over the links.

use std::sync::{Arc, PoisonError};

use super::elements::NONE;
use super::light::{DirectionalPolynomial, NodeRadiosity};
use super::links::{Link, LinkKind, POINT, intensity};
use super::oracle::RefinementOracle;
use super::refine::{LinkHierarchy, SharedHierarchy};
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;

/// Patches or clusters that one task of the thread pool processes.
const ITEMS_PER_TASK: usize = 64;

/// Strength of a link's source: radiosity, or radiant intensity towards the receiver.
#[inline]
pub(super) fn strength(oracle: &RefinementOracle, radiosity: &NodeRadiosity, link: &Link) -> DVec3 {
    if link.source >= POINT {
        return oracle.lights[(link.source - POINT) as usize].intensity;
    }
    let source = &oracle.elements.nodes[link.source as usize];
    if source.is_cluster() {
        let d = oracle.elements.nodes[link.receiver as usize].centre - source.centre;
        intensity(source, radiosity, d.normalize_or_zero())
    } else {
        link.quarter_weights.mean(source, &radiosity.b, radiosity.b[link.source as usize])
    }
}

/// Irradiance that an element gathers over its own links.
#[inline]
fn gathered(hierarchy: &LinkHierarchy, node: u32) -> DVec3 {
    let oracle = &hierarchy.oracle;
    let one = |link: &Link| match link.kind {
        LinkKind::Negligible => DVec3::ZERO,
        _ => f64::from(link.factor) * f64::from(link.visible) * strength(oracle, &oracle.radiosity, link),
    };
    hierarchy.links_of(node).iter().map(one).sum()
}

/// Irradiance that each cluster brings to the surfaces below it, including that of the clusters above.
pub(super) fn received(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Vec<DirectionalPolynomial>> {
    let count = {
        let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
        // Every step that gathers begins here.
        hierarchy.check_step(0)?;
        hierarchy.clusters.len()
    };
    received_by(shared, count, parallel, |hierarchy, link| {
        let oracle = &hierarchy.oracle;
        Some(strength(oracle, &oracle.radiosity, link))
    })
}

/// What each of `count` clusters brings to the surfaces below it, where links have these strengths and those without one bring nothing.
pub(super) fn received_by(
    shared: &SharedHierarchy,
    count: usize,
    parallel: &mut impl Parallel,
    strength: impl Fn(&LinkHierarchy, &Link) -> Option<DVec3> + Send + Sync + 'static,
) -> Result<Vec<DirectionalPolynomial>> {
    let hierarchy = Arc::clone(shared);
    let own = parallel.map(count.div_ceil(ITEMS_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let clusters = hierarchy.clusters[block * ITEMS_PER_TASK..].iter().take(ITEMS_PER_TASK);
        clusters.map(|&node| gathered_by_cluster(&hierarchy, node, &strength)).collect::<Vec<_>>()
    })?;
    let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
    let nodes = &hierarchy.oracle.elements.nodes;
    let mut received = vec![DirectionalPolynomial::default(); count];
    for (&node, own) in hierarchy.clusters.iter().zip(own.into_iter().flatten()) {
        let Some(node) = nodes.get(node as usize) else { continue };
        let mut sum = own;
        if node.parent != NONE {
            sum += &received[nodes[node.parent as usize].corners[2] as usize];
        }
        received[node.corners[2] as usize] = sum;
    }
    Ok(received)
}

fn gathered_by_cluster(
    hierarchy: &LinkHierarchy,
    node: u32,
    strength: &impl Fn(&LinkHierarchy, &Link) -> Option<DVec3>,
) -> DirectionalPolynomial {
    let oracle = &hierarchy.oracle;
    let mut moments = DirectionalPolynomial::default();
    let centre = oracle.elements.nodes[node as usize].centre;
    for link in hierarchy.links_of(node) {
        if link.kind == LinkKind::Negligible {
            continue;
        }
        let Some(strength) = strength(hierarchy, link) else { continue };
        let from = match link.source {
            point @ POINT.. => oracle.lights[(point - POINT) as usize].position,
            source => oracle.elements.nodes[source as usize].centre,
        };
        let weight = f64::from(link.factor) * f64::from(link.visible) * strength;
        let d = (from - centre).normalize_or_zero();
        if link.kind == LinkKind::Facing { moments.add_linear(d, weight) } else { moments.add_lobe(d, weight) }
    }
    moments
}

/// Pushes irradiance down: visits the leaves below an element with the irradiance gathered at them and at all elements
/// above. `above` is what the elements above gathered.
fn push(hierarchy: &LinkHierarchy, node: u32, above: DVec3, visit: &mut impl FnMut(u32, DVec3)) {
    let irradiance = above + gathered(hierarchy, node);
    let element = &hierarchy.oracle.elements.nodes[node as usize];
    if element.is_leaf() {
        visit(node, irradiance);
    } else {
        for child in element.range() {
            push(hierarchy, child as u32, irradiance, visit);
        }
    }
}

/// The same for a patch, with the irradiance that clusters above it received, what no link brings, and what comes back to hollow leaves.
pub(super) fn push_patch(
    hierarchy: &LinkHierarchy,
    patch: u32,
    received: &[DirectionalPolynomial],
    visit: &mut impl FnMut(u32, DVec3),
) {
    let elements = &hierarchy.oracle.elements;
    let root = elements.patches[patch as usize].node;
    let node = &elements.nodes[root as usize];
    let from_clusters = match node.parent {
        NONE => None,
        parent => Some(&received[elements.nodes[parent as usize].corners[2] as usize]),
    };
    let visit = &mut |leaf, irradiance: DVec3| {
        visit(leaf, elements.kept(leaf, hierarchy.scale_of(leaf) * irradiance, hierarchy.sampled_over(leaf)));
    };
    // A flat element has one normal, so the clusters' irradiance is the same for all of its leaves.
    match from_clusters {
        Some(moments) if elements.shape(patch).is_some() => {
            push(hierarchy, root, DVec3::ZERO, &mut |leaf, irradiance| {
                visit(leaf, irradiance + moments.at(elements.nodes[leaf as usize].normal));
            })
        }
        Some(moments) => push(hierarchy, root, moments.at(node.normal), visit),
        None => push(hierarchy, root, DVec3::ZERO, visit),
    }
}

/// Irradiance of all leaves by the current radiosities, patch by patch.
pub(super) fn leaf_irradiances(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Vec<(u32, DVec3)>> {
    let received = Arc::new(received(shared, parallel)?);
    leaf_irradiances_with(shared, &received, parallel)
}

/// The same with the irradiance that clusters received.
pub(super) fn leaf_irradiances_with(
    shared: &SharedHierarchy,
    received: &Arc<Vec<DirectionalPolynomial>>,
    parallel: &mut impl Parallel,
) -> Result<Vec<(u32, DVec3)>> {
    let received = Arc::clone(received);
    let count = shared.read().unwrap_or_else(PoisonError::into_inner).oracle.elements.patches.len();
    let hierarchy = Arc::clone(shared);
    let found = parallel.map(count.div_ceil(ITEMS_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let mut found = Vec::new();
        for patch in block * ITEMS_PER_TASK..((block + 1) * ITEMS_PER_TASK).min(count) {
            push_patch(&hierarchy, patch as u32, &received, &mut |leaf, irradiance| found.push((leaf, irradiance)));
        }
        found
    })?;
    Ok(found.into_iter().flatten().collect())
}
