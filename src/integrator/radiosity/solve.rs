//! Solving: light is transported over the links until the rest is small.
//!
//! The system is B = M + rho K B, where K are the links. Irradiance that a node gathers is pushed down to the leaves
//! below it (`node_irradiance`), and radiosities of the leaves are pulled up. *Gathering* a fixed number of times is the Jacobi iteration,
//! in which each iteration is one bounce of light. Gathering until the rest is small is the Gauss-Seidel iteration from
//! patch to patch. *Shooting* distributes the light of the patch that has most unshot light.

use std::cell::Cell;
use std::sync::{Arc, PoisonError};

use super::elements::Elements;
use super::form_factor;
use super::gather::gather_over;
use super::light::{DirectionalPolynomial, NodeRadiosity};
use super::links::Link;
use super::node_irradiance::{leaf_irradiances, leaf_irradiances_with, push_patch, received};
use super::oracle::RefinementOracle;
use super::refine::{LinkHierarchy, SharedHierarchy};
use super::rows;
use super::vertices::LEAVES_PER_TASK;
use crate::control::Parallel;
use crate::error::Result;
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// Rays from a leaf to a source that is partly visible from the leaf's parents, in proportion to the source's fraction
/// of the leaf's light. With fewer rays, the nearest parts of a source, which are the strongest and seldom hidden,
/// would be underestimated.
const RAYS_PER_FRACTION: f64 = 64.0;
const MIN_RAYS: f64 = 8.0;
const MAX_RAYS: f64 = 16.0;

/// Limits of a leaf's scale. A leaf that is scaled to nothing could not be balanced again, and a factor that was found
/// in very weak light would be too large for the light that arrives later.
const SCALE_LIMITS: [f64; 2] = [1e-3, 8.0];

/// The iteration ends after this many iterations in any case.
pub(super) const MAX_ITERATIONS: u32 = 100_000;

/// Convergence of a solution.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Convergence {
    pub iterations: u32,
    /// Change by the last iteration, in the sum of area times radiosity, over that sum.
    pub residual: f64,
    /// Bound on the distance to the solution of the system in the same measure.
    pub bound: f64,
}

/// One Jacobi iteration, which is one bounce. Returns the change, as [`Convergence::residual`].
pub(super) fn jacobi_iteration(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<f64> {
    let found = leaf_irradiances(shared, parallel)?;
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    let RefinementOracle { elements, radiosity, .. } = &mut hierarchy.oracle;
    let mut changes = [0.0; 2];
    for (leaf, irradiance) in found {
        set_leaf_radiosity(elements, radiosity, leaf, irradiance, &mut changes);
    }
    radiosity.pull(elements);
    Ok(relative_change(changes))
}

fn relative_change([changed, sum]: [f64; 2]) -> f64 {
    if sum > 0.0 { changed / sum } else { 0.0 }
}

/// Sets a leaf's radiosity from its irradiance, and adds up the change and the total.
fn set_leaf_radiosity(
    elements: &Elements,
    radiosity: &mut NodeRadiosity,
    leaf: u32,
    irradiance: DVec3,
    changes: &mut [f64; 2],
) {
    let node = &elements.nodes[leaf as usize];
    let b = elements.emitted(leaf) + elements.albedo(leaf) * irradiance;
    let old = std::mem::replace(&mut radiosity.b[leaf as usize], b);
    changes[0] += node.area * (b - old).abs().element_sum();
    changes[1] += node.area * b.element_sum();
}

/// One Gauss-Seidel iteration from patch to patch, in which clusters use the previous iteration. Returns the change, as
/// [`Convergence::residual`].
pub(super) fn gauss_seidel_iteration(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<f64> {
    let received = received(shared, parallel)?;
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    let mut changes = [0.0; 2];
    let mut found = Vec::new();
    for patch in 0..hierarchy.oracle.elements.patches.len() as u32 {
        if patch % 256 == 0 {
            parallel.check()?;
        }
        push_patch(&hierarchy, patch, &received, &mut |leaf, irradiance| found.push((leaf, irradiance)));
        let RefinementOracle { elements, radiosity, .. } = &mut hierarchy.oracle;
        for (leaf, irradiance) in found.drain(..) {
            set_leaf_radiosity(elements, radiosity, leaf, irradiance, &mut changes);
        }
        pull_patch(elements, radiosity, elements.patches[patch as usize].node);
    }
    let RefinementOracle { elements, radiosity, .. } = &mut hierarchy.oracle;
    radiosity.pull(elements);
    Ok(relative_change(changes))
}

/// Computes the factors by which leaves gather too much or too little, from the current radiosities.
///
/// An element that was subdivided for some of its links keeps other links as a whole, whose light in truth varies over
/// it: where one child is nearer to the first sources, it is farther from the others. The irradiance of each leaf is
/// therefore scaled to what the leaf would gather if all links of the elements above it were evaluated at the leaf
/// itself. In a closed room, its links are also moved until its row sums to one ([`super::rows`]).
///
/// `traces_visibility`: each leaf traces its own visibility to sources that are partly visible from elements above it;
/// otherwise it uses the visibility of those elements.
pub(super) fn balance(shared: &SharedHierarchy, traces_visibility: bool, parallel: &mut impl Parallel) -> Result<()> {
    let received = Arc::new(received(shared, parallel)?);
    rows::update(shared, parallel)?;
    let leaves = Arc::new(leaf_irradiances_with(shared, &received, parallel)?);
    let (hierarchy, leaves_of_task) = (Arc::clone(shared), Arc::clone(&leaves));
    let found = parallel.map(leaves.len().div_ceil(LEAVES_PER_TASK), move |block| {
        let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
        let of_leaf = |&(leaf, irradiance): &(u32, DVec3)| {
            // Each channel has its own scale, because direct light and reflected light need different ones.
            let about = traces_visibility.then(|| irradiance.max_element());
            irradiance_of_leaf(&hierarchy, leaf, &received, about)
        };
        leaves_of_task[block * LEAVES_PER_TASK..].iter().take(LEAVES_PER_TASK).map(of_leaf).collect::<Vec<_>>()
    })?;
    let found: Vec<LeafIrradiance> = found.into_iter().flatten().collect();
    let mut hierarchy = shared.write().unwrap_or_else(PoisonError::into_inner);
    let RefinementOracle { elements, radiosity, .. } = &hierarchy.oracle;
    let of_surfaces = leaves.iter().zip(&found).map(|(&(leaf, _), found)| (leaf, found.of_surfaces));
    let all = hierarchy.rows.as_ref().map_or(DVec3::ONE, |rows| rows.balanced(elements, &radiosity.b, of_surfaces));
    let mut scale = vec![Rgb::ONE; elements.nodes.len()];
    for (&(leaf, irradiance), found) in leaves.iter().zip(&found) {
        // What no link brings, and what comes back to a hollow leaf, is that of the leaf itself.
        let own = elements.kept(leaf, DVec3::ZERO, hierarchy.sampled_over(leaf));
        let better = elements.kept(leaf, found.of_points + all * found.of_surfaces, DVec3::ZERO);
        let of_leaf = hierarchy.scale_of(leaf) * better / (irradiance - own);
        let bounded = |scale: f64| if scale.is_finite() { scale.clamp(SCALE_LIMITS[0], SCALE_LIMITS[1]) } else { 1.0 };
        scale[leaf as usize] = Rgb::from_f64(DVec3::from(of_leaf.to_array().map(bounded)));
    }
    hierarchy.scale = scale;
    if let Some(rows) = &mut hierarchy.rows {
        rows.keep(all, leaves.iter().zip(&found).map(|(&(leaf, _), found)| (leaf, found.shift)));
    }
    Ok(())
}

/// What a leaf gathers where all links end at the leaf itself.
struct LeafIrradiance {
    of_points: DVec3,
    of_surfaces: DVec3,
    /// How far its links are moved, in their doubts, so that its row sums to one.
    shift: f64,
}

/// The irradiance of a leaf, integrated over the same points for all links, so that the quadrature errors of two links
/// cancel, in closed rooms with links that are moved until the row sums to one. `about`: the approximate result where
/// the leaf traces its own visibility.
fn irradiance_of_leaf(
    hierarchy: &LinkHierarchy,
    leaf: u32,
    received: &[DirectionalPolynomial],
    about: Option<f64>,
) -> LeafIrradiance {
    let elements = &hierarchy.oracle.elements;
    let node = &elements.nodes[leaf as usize];
    let (places, weights) = form_factor::places(&elements.triangle(node));
    let is_hidden = |link: &Link| link.visible == 0.0;
    let last = Cell::new((u32::MAX, 0.0));
    let visible = |link: &Link, _, strength: DVec3| {
        let is_partly_seen = link.receiver != leaf && link.visible < 1.0;
        let Some(about) = about.filter(|_| is_partly_seen && strength != DVec3::ZERO) else {
            return f64::from(link.visible);
        };
        if last.get().0 != link.source {
            let relative_change = f64::from(link.factor) * strength.max_element() / about;
            let rays = (RAYS_PER_FRACTION * relative_change).clamp(MIN_RAYS, MAX_RAYS) as u32;
            last.set((link.source, hierarchy.oracle.leaf_visibility(leaf, link.source, rays)));
        }
        last.get().1
    };
    let gathered = gather_over(hierarchy, leaf, &places, received, is_hidden, &visible);
    let rows = hierarchy.rows.as_deref();
    let shift = rows.map_or(0.0, |rows| rows.shift_of(leaf, gathered.row(weights)));
    let mut of = LeafIrradiance { of_points: DVec3::ZERO, of_surfaces: DVec3::ZERO, shift };
    for (k, weight) in weights.into_iter().enumerate() {
        let [of_points, of_surfaces] = gathered.at(k, leaf, rows.map(|rows| (rows, shift)));
        of.of_points += weight * of_points;
        of.of_surfaces += weight * of_surfaces;
    }
    of
}

fn pull_patch(elements: &Elements, radiosity: &mut NodeRadiosity, number: u32) {
    let node = &elements.nodes[number as usize];
    if node.is_leaf() {
        return;
    }
    let mut sum = DVec3::ZERO;
    let mut area = 0.0;
    for child in node.range() {
        pull_patch(elements, radiosity, child as u32);
        sum += elements.nodes[child].area * radiosity.b[child];
        area += elements.nodes[child].area;
    }
    radiosity.b[number as usize] = sum / area;
}

/// Largest albedo of any element.
pub(super) fn largest_albedo(elements: &Elements) -> f64 {
    let all = (0..elements.nodes.len() as u32).filter(|&number| !elements.nodes[number as usize].is_cluster());
    all.map(|element| elements.albedo(element).max_element()).fold(0.0, f64::max)
}

/// How often light is gathered.
#[derive(Clone, Copy, Debug)]
pub(super) enum Iterations {
    /// So many times from the emission alone. The first of them are balanced each by itself.
    Fixed { count: u32, balanced: u32 },
    /// Until the rest is at most this, but no more than so many times.
    Until { tolerance: f64, most: u32 },
}

/// Gathers light until it is solved for.
pub(super) fn gather(
    shared: &SharedHierarchy,
    iterations: Iterations,
    parallel: &mut impl Parallel,
) -> Result<Convergence> {
    let albedo = largest_albedo(&shared.read().unwrap_or_else(PoisonError::into_inner).oracle.elements);
    // The rest after an iteration is at most this fraction of its change: light that meets a surface is scattered once
    // more.
    let left = if albedo < 1.0 { albedo / (1.0 - albedo) } else { f64::INFINITY };
    let mut convergence = Convergence { residual: 1.0, bound: f64::INFINITY, ..Convergence::default() };
    let most = match iterations {
        Iterations::Fixed { count, .. } => {
            shared.write().unwrap_or_else(PoisonError::into_inner).emit();
            count
        }
        Iterations::Until { most, .. } => most,
    };
    let mut before = f64::INFINITY;
    while convergence.iterations < most {
        convergence.residual = match iterations {
            Iterations::Fixed { balanced, .. } => {
                if convergence.iterations < balanced {
                    balance(shared, true, parallel)?;
                }
                jacobi_iteration(shared, parallel)?
            }
            Iterations::Until { .. } => gauss_seidel_iteration(shared, parallel)?,
        };
        convergence.iterations += 1;
        parallel.progress(match iterations {
            Iterations::Fixed { count, .. } => f64::from(convergence.iterations) / f64::from(count),
            Iterations::Until { tolerance, .. } => convergence.residual.ln() / tolerance.ln(),
        });
        convergence.bound = convergence.residual * left;
        // The rest if the change continues to shrink at the present rate. It is less than the bound where light
        // escapes.
        let shrinking = (convergence.residual / before).min(1.0);
        let rest = convergence.residual * shrinking / (1.0 - shrinking);
        before = convergence.residual;
        if let Iterations::Until { tolerance, .. } = iterations {
            // Further iterations cannot repair values that are not finite.
            let is_over = convergence.residual == 0.0 || !convergence.residual.is_finite();
            if is_over || (convergence.residual < tolerance && rest.min(convergence.bound) < tolerance) {
                break;
            }
        }
    }
    Ok(convergence)
}

#[cfg(test)]
mod tests {
    use std::sync::RwLock;

    use super::super::elements::{NONE, Node, Patch, empty};
    use super::super::links::{LinkKind, QuarterWeights};
    use super::super::shoot::shoot;
    use super::*;
    use crate::control::Alone;
    use crate::desc::SceneDesc;
    use crate::scene::{BuildOptions, Scene};

    /// A unit cube with one patch for each face, of which the first emits 1 W m^-2, and the exact form factors.
    fn cube(albedo: f64) -> SharedHierarchy {
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
        let mut hierarchy = LinkHierarchy::new(&scene, elements).unwrap();
        for (receiver, source) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            if receiver != source {
                // Full precision: the factor in single precision, and its rounding error as a second link.
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
                        quarter_weights: QuarterWeights::EVEN,
                        kind: LinkKind::Element,
                    };
                    hierarchy.links.push(link);
                }
            }
        }
        hierarchy.sort().unwrap();
        Arc::new(RwLock::new(hierarchy))
    }

    fn fixed(count: u32) -> Iterations {
        Iterations::Fixed { count, balanced: 0 }
    }

    fn until(tolerance: f64) -> Iterations {
        Iterations::Until { tolerance, most: MAX_ITERATIONS }
    }

    #[test]
    fn cube_with_one_patch_a_face() {
        for (albedo, expected) in [
            (0.5, [1.090_909_098_11, 0.181_745_826_108, 0.181_836_268_946]),
            (0.8, [1.551_724_153_64, 0.689_551_070_738, 0.689_681_193_904]),
        ] {
            let check = |shared: &SharedHierarchy, how: &str, tolerance: f64| {
                let hierarchy = shared.read().unwrap();
                for (face, expected) in [0, 1, 2, 3, 4, 5].into_iter().zip([0, 1, 2, 2, 2, 2].map(|i| expected[i])) {
                    let b = hierarchy.oracle.radiosity.b[face].x;
                    assert!((b - expected).abs() < tolerance, "{how}, albedo {albedo}, face {face}: {b} {expected}");
                }
            };
            let shared = cube(albedo);
            let convergence = gather(&shared, until(1e-9), &mut Alone::default()).unwrap();
            check(&shared, "gathered", 1e-8);
            assert!(convergence.bound < 1e-8 && convergence.iterations < 100, "{convergence:?}");

            let shared = cube(albedo);
            gather(&shared, fixed(150), &mut Alone::default()).unwrap();
            check(&shared, "bounces", 1e-8);

            let shared = cube(albedo);
            let (convergence, _) = shoot(&shared, None, 1e-9, &mut Alone::default()).unwrap();
            check(&shared, "shot", 1e-8);
            assert!(convergence.bound < 1e-8, "{convergence:?}");
        }
    }

    /// After each number of bounces the rest is within the reported bound.
    #[test]
    fn bounds_hold() {
        let exact = cube(0.8);
        gather(&exact, until(1e-12), &mut Alone::default()).unwrap();
        let sum = |shared: &SharedHierarchy| shared.read().unwrap().oracle.radiosity.b.iter().map(|b| b.x).sum::<f64>();
        for iterations in [1, 2, 5, 20] {
            let shared = cube(0.8);
            let convergence = gather(&shared, fixed(iterations), &mut Alone::default()).unwrap();
            let left = (sum(&exact) - sum(&shared)) / sum(&shared);
            assert!(
                left <= convergence.bound && left > 0.2 * convergence.bound,
                "{iterations}: {left} {convergence:?}"
            );

            let shared = cube(0.8);
            let (convergence, ambient) = shoot(&shared, Some(iterations), 0.5, &mut Alone::default()).unwrap();
            let left = sum(&exact) - sum(&shared);
            assert!(left > 0.0 && ambient.x >= 0.0, "{iterations}: {left} {convergence:?}");
        }
    }
}
