//! Solving: light goes over the links until what is left is small.
//!
//! The system is B = M + rho K B, K being the links: what a node gathers is pushed down to the leaves below it, and what these
//! send is pulled up. *Gathering* a fixed number of times is Jacobi's iteration, each of which is a bounce of light. Until what is
//! left is small, it is Gauss and Seidel's from patch to patch. *Shooting* distributes the light of the patch that has most of it
//! left.

use std::cell::Cell;
use std::sync::{Arc, PoisonError};

use super::elements::{Elements, NONE};
use super::form_factor;
use super::judge::Judge;
use super::light::{Moments, Sent};
use super::links::{Kind, Link, POINT, intensity};
use super::refine::{Network, Shared};
use super::vertices::gather_over;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// Patches, clusters or leaves of one thread at a time.
const BLOCK: usize = 64;

/// Rays from a leaf to what its parents see in part, in proportion to the share of its light. Of fewer the nearest parts of a
/// source, which are the strongest and seldom hidden, would not weigh enough.
const RAYS: f64 = 64.0;
const FEWEST_RAYS: f64 = 8.0;
const MOST_RAYS: f64 = 16.0;

/// Leaves are scaled by no less, since what is scaled to nothing could not be balanced again; and by no more, since what is found
/// by a glimmer would be too much for the light that comes later.
const SCALES: [f64; 2] = [1e-3, 8.0];

/// Iterations after which nothing is waited for any more.
const MOST_SWEEPS: u32 = 100_000;

/// How a solution was come to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Course {
    pub iterations: u32,
    /// What the last iteration changed, in the sum of area times radiosity, over that sum.
    pub residual: f64,
    /// Bound on the distance to the solution of the system in the same measure.
    pub bound: f64,
}

/// Irradiance that one link brings to an element, per light that it takes.
#[inline]
fn strength(judge: &Judge, sent: &Sent, link: &Link) -> DVec3 {
    if link.source >= POINT {
        return judge.lights[(link.source - POINT) as usize].intensity;
    }
    let source = &judge.elements.nodes[link.source as usize];
    if source.is_cluster() {
        let d = judge.elements.nodes[link.receiver as usize].centre - source.centre;
        intensity(source, sent, d.normalize_or_zero())
    } else {
        link.shares.mean(source, &sent.b, sent.b[link.source as usize])
    }
}

/// Irradiance that an element gathers over its own links.
#[inline]
pub(super) fn gathered(network: &Network, node: u32) -> DVec3 {
    let judge = &network.judge;
    let one = |link: &Link| match link.kind {
        Kind::Dim => DVec3::ZERO,
        _ => f64::from(link.factor) * f64::from(link.visible) * strength(judge, &judge.sent, link),
    };
    network.links_of(node).iter().map(one).sum()
}

/// What each cluster brings to the surfaces below it, that from above included.
pub(super) fn received(shared: &Shared, parallel: &mut impl Parallel) -> Result<Vec<Moments>> {
    let count = shared.read().unwrap_or_else(PoisonError::into_inner).clusters.len();
    let network = Arc::clone(shared);
    let own = parallel.map(count.div_ceil(BLOCK), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let clusters = network.clusters[block * BLOCK..].iter().take(BLOCK);
        clusters.map(|&node| cluster_gathered(&network, node)).collect::<Vec<_>>()
    })?;
    let network = shared.read().unwrap_or_else(PoisonError::into_inner);
    let nodes = &network.judge.elements.nodes;
    let mut received = vec![Moments::default(); count];
    for (&node, own) in network.clusters.iter().zip(own.into_iter().flatten()) {
        let Some(node) = nodes.get(node as usize) else { continue };
        let mut sum = own;
        if node.parent != NONE {
            sum += &received[nodes[node.parent as usize].corners[2] as usize];
        }
        received[node.corners[2] as usize] = sum;
    }
    Ok(received)
}

fn cluster_gathered(network: &Network, node: u32) -> Moments {
    let judge = &network.judge;
    let mut moments = Moments::default();
    let centre = judge.elements.nodes[node as usize].centre;
    for link in network.links_of(node) {
        if link.kind == Kind::Dim {
            continue;
        }
        let from = match link.source {
            point @ POINT.. => judge.lights[(point - POINT) as usize].position,
            source => judge.elements.nodes[source as usize].centre,
        };
        let weight = f64::from(link.factor) * f64::from(link.visible) * strength(judge, &judge.sent, link);
        let d = (from - centre).normalize_or_zero();
        if link.kind == Kind::Facing { moments.add_linear(d, weight) } else { moments.add_lobe(d, weight) }
    }
    moments
}

/// Visits the leaves below an element with the irradiance gathered at it and above, `above` being that from above.
fn leaves(network: &Network, node: u32, above: DVec3, visit: &mut impl FnMut(u32, DVec3)) {
    let irradiance = above + gathered(network, node);
    let element = &network.judge.elements.nodes[node as usize];
    if element.is_leaf() {
        visit(node, network.scale_of(node) * irradiance);
    } else {
        for child in element.range() {
            leaves(network, child as u32, irradiance, visit);
        }
    }
}

/// The same for a patch, with what clusters above it received.
pub(super) fn leaves_of_patch(network: &Network, patch: u32, received: &[Moments], visit: &mut impl FnMut(u32, DVec3)) {
    let elements = &network.judge.elements;
    let root = elements.patches[patch as usize].node;
    let node = &elements.nodes[root as usize];
    let from_clusters = match node.parent {
        NONE => None,
        parent => Some(&received[elements.nodes[parent as usize].corners[2] as usize]),
    };
    // Flat elements have one normal.
    match from_clusters {
        Some(moments) if elements.shape(patch).is_some() => {
            leaves(network, root, DVec3::ZERO, &mut |leaf, irradiance| {
                let above = moments.at(elements.nodes[leaf as usize].normal);
                visit(leaf, irradiance + network.scale_of(leaf) * above);
            })
        }
        Some(moments) => leaves(network, root, moments.at(node.normal), visit),
        None => leaves(network, root, DVec3::ZERO, visit),
    }
}

/// Irradiance of all leaves by what is sent now, patch by patch.
pub(super) fn irradiances(shared: &Shared, parallel: &mut impl Parallel) -> Result<Vec<(u32, DVec3)>> {
    let received = Arc::new(received(shared, parallel)?);
    irradiances_with(shared, &received, parallel)
}

/// The same with what clusters received.
fn irradiances_with(
    shared: &Shared,
    received: &Arc<Vec<Moments>>,
    parallel: &mut impl Parallel,
) -> Result<Vec<(u32, DVec3)>> {
    let received = Arc::clone(received);
    let count = shared.read().unwrap_or_else(PoisonError::into_inner).judge.elements.patches.len();
    let network = Arc::clone(shared);
    let found = parallel.map(count.div_ceil(BLOCK), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let mut found = Vec::new();
        for patch in block * BLOCK..((block + 1) * BLOCK).min(count) {
            leaves_of_patch(&network, patch as u32, &received, &mut |leaf, irradiance| found.push((leaf, irradiance)));
        }
        found
    })?;
    Ok(found.into_iter().flatten().collect())
}

/// One Jacobi iteration: a bounce. What it changed, as [`Course::residual`].
pub(super) fn bounce(shared: &Shared, parallel: &mut impl Parallel) -> Result<f64> {
    let found = irradiances(shared, parallel)?;
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    let Judge { elements, sent, .. } = &mut network.judge;
    let mut changes = [0.0; 2];
    for (leaf, irradiance) in found {
        set(elements, sent, leaf, irradiance, &mut changes);
    }
    sent.pull(elements);
    Ok(share(changes))
}

fn share([changed, sum]: [f64; 2]) -> f64 {
    if sum > 0.0 { changed / sum } else { 0.0 }
}

/// A leaf's new radiosity.
fn set(elements: &Elements, sent: &mut Sent, leaf: u32, irradiance: DVec3, changes: &mut [f64; 2]) {
    let node = &elements.nodes[leaf as usize];
    let patch = &elements.patches[node.patch as usize];
    let b = patch.emitted + patch.albedo * irradiance;
    let old = std::mem::replace(&mut sent.b[leaf as usize], b);
    changes[0] += node.area * (b - old).abs().element_sum();
    changes[1] += node.area * b.element_sum();
}

/// One iteration of Gauss and Seidel's from patch to patch; clusters lag behind by one.
pub(super) fn sweep(shared: &Shared, parallel: &mut impl Parallel) -> Result<f64> {
    let received = received(shared, parallel)?;
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    let mut changes = [0.0; 2];
    let mut found = Vec::new();
    for patch in 0..network.judge.elements.patches.len() as u32 {
        if patch % 256 == 0 {
            parallel.check()?;
        }
        leaves_of_patch(&network, patch, &received, &mut |leaf, irradiance| found.push((leaf, irradiance)));
        let Judge { elements, sent, .. } = &mut network.judge;
        for (leaf, irradiance) in found.drain(..) {
            set(elements, sent, leaf, irradiance, &mut changes);
        }
        pull_patch(elements, sent, elements.patches[patch as usize].node);
    }
    let Judge { elements, sent, .. } = &mut network.judge;
    sent.pull(elements);
    Ok(share(changes))
}

/// Finds by what leaves gather too much or too little, by what is sent now.
///
/// An element that was divided for some of its links has the others as a whole, whose light is in truth spread over it unevenly:
/// where one part is nearer to the ones, it is farther from the others. What leaves gather is scaled by what they would if all
/// that came to the elements above them had come to themselves. In a closed room, rows so sum to one.
///
/// `looks`: each leaf sees for itself what is hidden of sources that elements above it have in part; else it is as for those.
pub(super) fn balance(shared: &Shared, looks: bool, parallel: &mut impl Parallel) -> Result<()> {
    let received = Arc::new(received(shared, parallel)?);
    let leaves = Arc::new(irradiances_with(shared, &received, parallel)?);
    let network = Arc::clone(shared);
    let found = parallel.map(leaves.len().div_ceil(BLOCK), move |block| {
        let network = network.read().unwrap_or_else(PoisonError::into_inner);
        let scale = |&(leaf, irradiance): &(u32, DVec3)| {
            // Each channel by itself: light that comes straight and light that was reflected want different scales.
            let about = looks.then(|| irradiance.max_element());
            let better = irradiance_of_leaf(&network, leaf, &received, about);
            let scale = network.scale_of(leaf) * better / irradiance;
            let bounded = |scale: f64| if scale.is_finite() { scale.clamp(SCALES[0], SCALES[1]) } else { 1.0 };
            (leaf, Rgb::from_f64(DVec3::from(scale.to_array().map(bounded))))
        };
        leaves[block * BLOCK..].iter().take(BLOCK).map(scale).collect::<Vec<_>>()
    })?;
    let mut network = shared.write().unwrap_or_else(PoisonError::into_inner);
    let mut scale = vec![Rgb::ONE; network.judge.elements.nodes.len()];
    for (leaf, of_leaf) in found.into_iter().flatten() {
        scale[leaf as usize] = of_leaf;
    }
    network.scale = scale;
    Ok(())
}

/// By the same places for all links, so that what they miss of one they have of another. `about`: roughly what comes
/// out, where the leaf looks for itself.
fn irradiance_of_leaf(network: &Network, leaf: u32, received: &[Moments], about: Option<f64>) -> DVec3 {
    let elements = &network.judge.elements;
    let node = &elements.nodes[leaf as usize];
    let (places, weights) = form_factor::places(&elements.triangle(node));
    let is_hidden = |link: &Link| link.visible == 0.0;
    let last = Cell::new((u32::MAX, 0.0));
    let visible = |link: &Link, _, strength: DVec3| {
        let Some(about) = about.filter(|_| link.receiver != leaf && link.visible < 1.0) else {
            return f64::from(link.visible);
        };
        if last.get().0 != link.source {
            let share = f64::from(link.factor) * strength.max_element() / about;
            let rays = (RAYS * share).clamp(FEWEST_RAYS, MOST_RAYS) as u32;
            last.set((link.source, network.judge.visible_from(leaf, link.source, rays)));
        }
        last.get().1
    };
    let (sums, from_clusters) = gather_over(network, leaf, &places, received, is_hidden, &visible);
    sums.iter().zip(weights).map(|(sum, weight)| weight * sum).sum::<DVec3>() + from_clusters
}

fn pull_patch(elements: &Elements, sent: &mut Sent, number: u32) {
    let node = &elements.nodes[number as usize];
    if node.is_leaf() {
        return;
    }
    let mut sum = DVec3::ZERO;
    let mut area = 0.0;
    for child in node.range() {
        pull_patch(elements, sent, child as u32);
        sum += elements.nodes[child].area * sent.b[child];
        area += elements.nodes[child].area;
    }
    sent.b[number as usize] = sum / area;
}

/// Largest albedo of any patch.
pub(super) fn largest_albedo(elements: &Elements) -> f64 {
    elements.patches.iter().map(|patch| patch.albedo.max_element()).fold(0.0, f64::max)
}

/// Gathers `iterations` times from what is emitted, or until no more than `tolerance` is left. `balanced`: of a number of iterations,
/// how many of the first are balanced each by itself.
pub(super) fn gather(
    shared: &Shared,
    iterations: Option<u32>,
    balanced: u32,
    tolerance: f64,
    parallel: &mut impl Parallel,
) -> Result<Course> {
    let albedo = largest_albedo(&shared.read().unwrap_or_else(PoisonError::into_inner).judge.elements);
    // No iteration leaves more than this share of what it changed: light that meets a surface is scattered once more.
    let left = if albedo < 1.0 { albedo / (1.0 - albedo) } else { f64::INFINITY };
    let mut course = Course { residual: 1.0, bound: f64::INFINITY, ..Course::default() };
    if iterations.is_some() {
        shared.write().unwrap_or_else(PoisonError::into_inner).emit();
    }
    let mut before = f64::INFINITY;
    while course.iterations < iterations.unwrap_or(MOST_SWEEPS) {
        if iterations.is_some() && course.iterations < balanced {
            balance(shared, true, parallel)?;
        }
        course.residual = if iterations.is_some() { bounce(shared, parallel)? } else { sweep(shared, parallel)? };
        course.iterations += 1;
        parallel.progress(match iterations {
            Some(count) => f64::from(course.iterations) / f64::from(count),
            None => course.residual.ln() / tolerance.ln(),
        });
        course.bound = course.residual * left;
        // What is left if it goes on shrinking as it does, which is less than the bound where light escapes.
        let shrinking = (course.residual / before).min(1.0);
        let rest = course.residual * shrinking / (1.0 - shrinking);
        before = course.residual;
        // Nothing more is to be had of what is not finite.
        let is_over = course.residual == 0.0 || !course.residual.is_finite();
        let is_done = is_over || (course.residual < tolerance && rest.min(course.bound) < tolerance);
        if iterations.is_none() && is_done {
            break;
        }
    }
    Ok(course)
}

#[cfg(test)]
mod tests {
    use std::sync::RwLock;

    use super::super::elements::{Node, Patch, empty};
    use super::super::links::Shares;
    use super::super::shoot::shoot;
    use super::*;
    use crate::control::Alone;
    use crate::desc::SceneDesc;
    use crate::scene::{BuildOptions, Scene};

    /// A unit cube with one patch a face, of which the first emits 1 W m^-2; its exact form factors.
    fn cube(albedo: f64) -> Shared {
        const OPPOSITE: f64 = 0.199_824_895_698_387_4;
        const BESIDE: f64 = 0.200_043_776_075_403_2;
        let mut elements = Elements::default();
        elements.top = NONE;
        for face in 0..6_u32 {
            elements.nodes.push(Node { patch: face, area: 1.0, parent: NONE, ..empty() });
            elements.patches.push(Patch {
                surface: face,
                is_front: true,
                albedo: DVec3::splat(albedo),
                emitted: if face == 0 { DVec3::ONE } else { DVec3::ZERO },
                shape: NONE,
                node: face,
                error: 0.0,
            });
        }
        let scene = Scene::build(&SceneDesc::default(), &BuildOptions::default()).unwrap();
        let mut network = Network::new(&scene, elements);
        for (receiver, source) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            if receiver != source {
                // In full precision: a factor of single precision, and what it lacks as a second link.
                let exact = if receiver / 2 == source / 2 { OPPOSITE } else { BESIDE };
                let coarse = exact as f32;
                for factor in [coarse, (exact - f64::from(coarse)) as f32] {
                    let link = Link {
                        receiver,
                        source,
                        factor,
                        visible: 1.0,
                        seen: 1.0,
                        error: 0.0,
                        shares: Shares::EVEN,
                        kind: Kind::Element,
                    };
                    network.links.push(link);
                }
            }
        }
        network.sort();
        Arc::new(RwLock::new(network))
    }

    #[test]
    fn cube_with_one_patch_a_face() {
        for (albedo, expected) in [
            (0.5, [1.090_909_098_11, 0.181_745_826_108, 0.181_836_268_946]),
            (0.8, [1.551_724_153_64, 0.689_551_070_738, 0.689_681_193_904]),
        ] {
            let check = |shared: &Shared, how: &str, tolerance: f64| {
                let network = shared.read().unwrap();
                for (face, expected) in [0, 1, 2, 3, 4, 5].into_iter().zip([0, 1, 2, 2, 2, 2].map(|i| expected[i])) {
                    let b = network.judge.sent.b[face].x;
                    assert!((b - expected).abs() < tolerance, "{how}, albedo {albedo}, face {face}: {b} {expected}");
                }
            };
            let shared = cube(albedo);
            let course = gather(&shared, None, 0, 1e-9, &mut Alone::default()).unwrap();
            check(&shared, "gathered", 1e-8);
            assert!(course.bound < 1e-8 && course.iterations < 100, "{course:?}");

            let shared = cube(albedo);
            gather(&shared, Some(150), 0, 0.5, &mut Alone::default()).unwrap();
            check(&shared, "bounces", 1e-8);

            let shared = cube(albedo);
            let (course, _) = shoot(&shared, None, 1e-9, &mut Alone::default()).unwrap();
            check(&shared, "shot", 1e-8);
            assert!(course.bound < 1e-8, "{course:?}");
        }
    }

    /// After so many bounces the rest is within the bound that was told.
    #[test]
    fn bounds_hold() {
        let exact = cube(0.8);
        gather(&exact, None, 0, 1e-12, &mut Alone::default()).unwrap();
        let sum = |shared: &Shared| shared.read().unwrap().judge.sent.b.iter().map(|b| b.x).sum::<f64>();
        for iterations in [1, 2, 5, 20] {
            let shared = cube(0.8);
            let course = gather(&shared, Some(iterations), 0, 0.5, &mut Alone::default()).unwrap();
            let left = (sum(&exact) - sum(&shared)) / sum(&shared);
            assert!(left <= course.bound && left > 0.2 * course.bound, "{iterations}: {left} {course:?}");

            let shared = cube(0.8);
            let (course, ambient) = shoot(&shared, Some(iterations), 0.5, &mut Alone::default()).unwrap();
            let left = sum(&exact) - sum(&shared);
            assert!(left > 0.0 && ambient.x >= 0.0, "{iterations}: {left} {course:?}");
        }
    }
}
