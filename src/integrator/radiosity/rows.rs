//! Rows of the system in closed rooms: where all radiosities are one, a leaf that sees nothing but elements gathers an irradiance of one.
//!
//! What a row lacks, or has too much of, is distributed to its links: each is multiplied by 1 + shift x doubt, where the *doubt* is the
//! fraction of itself by which a link may be wrong, and the *shift* of a leaf makes its row sum to one. Links between elements have the
//! closed form of their form factor and little doubt; those of clusters are links of points. Only light that surfaces reflect is changed:
//! light of points is in no row, and links of lamps are the most accurate ones. Otherwise lamps would make up for dark
//! surfaces whose links are left out.
//!
//! What leaves surfaces in a closed room meets surfaces: the *balance* multiplies all of their light by what is missing of that. A leaf
//! that sees no elements, such as the outer side of a wall, is *blind*: it has light of points and of lamps, which may be too small
//! for the rays that tell, but what approximate links bring to it of reflected light comes from nowhere.
//!
//! Which leaves are closed or blind, rays tell: those of all leaves around count, so that a small window is not taken for a wall.

use std::sync::{Arc, PoisonError};

use super::elements::{Elements, NONE, Node};
use super::light::{DirectionalPolynomial, intensities};
use super::links::{Link, POINT, intensity_by};
use super::node_irradiance::{received_by, strength};
use super::oracle::FEW_PATCHES;
use super::refine::{LinkHierarchy, SharedHierarchy};
use super::vertices::{LEAVES_PER_TASK, leaves};
use crate::control::Parallel;
use crate::error::Result;
use crate::math::{DVec3, Frame, Ray};
use crate::room::filled;
use crate::sampling::hash;
use crate::sampling::warps::cosine_hemisphere;

/// Fewest rays from each leaf, and rays from a leaf and its neighbours by which it is judged.
const MIN_RAYS: usize = 16;
const RAYS_AROUND: usize = 1024;

/// Limits of the shift. Doubts are at most a half, so no link becomes negative, or more than three times as strong.
const SHIFT_LIMITS: [f64; 2] = [-1.0, 4.0];

/// The balance has no effect where elements that see more than elements have this fraction of all light: it escapes.
const MAX_OPEN: f64 = 5e-3;

/// Limits of the balance.
const BALANCE_LIMITS: [f64; 2] = [0.9, 1.1];

/// What a leaf sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    /// Nothing but elements.
    Closed,
    /// No elements.
    Blind,
    /// Elements and others: the sky, mirrors, glass, black surfaces.
    Open,
}

/// What is known of the rows of a linked hierarchy.
#[derive(Debug)]
pub(super) struct Rows {
    /// Intensity of each cluster where each radiosity is one.
    pub intensity: Arc<[DirectionalPolynomial]>,
    /// Intensity of each cluster by what it emits; empty without lamps.
    emission: Arc<[DirectionalPolynomial]>,
    /// What each cluster brings to the surfaces below it where each radiosity is one: in the first channel as it is, in the second with each
    /// link times the doubt in it.
    pub unit: Vec<DirectionalPolynomial>,
    /// What each cluster brings of the light that surfaces reflect now, with each link times the doubt in it.
    pub in_doubt: Vec<DirectionalPolynomial>,
    /// What each cluster brings of the light of points; empty where there are none.
    pub from_points: Vec<DirectionalPolynomial>,
    /// The same of lamps that are surfaces.
    pub from_lamps: Vec<DirectionalPolynomial>,
    /// Of each node that is a leaf.
    sight: Vec<Sight>,
    /// The same; found with the last balance.
    shifts: Vec<f32>,
    /// The factor on what surfaces bring, for each channel; found with the last balance.
    pub balance: DVec3,
}

/// Memory of [`Rows`] for a cluster and for a node.
const CLUSTER_BYTES: usize = 6 * size_of::<DirectionalPolynomial>();
const NODE_BYTES: usize = size_of::<Sight>() + size_of::<f32>();

impl Rows {
    /// Looks at the rows of a hierarchy whose links are final. `None` where no leaf is closed, and where so few patches are linked that
    /// clusters bring only what is dark.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`]; `Cancelled`.
    pub fn new(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<Option<Self>> {
        let (leaves, count, nodes) = {
            let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
            let elements = &hierarchy.oracle.elements;
            if elements.patches.len() <= FEW_PATCHES {
                return Ok(None);
            }
            let (clusters, nodes) = (hierarchy.clusters.len(), elements.nodes.len());
            // What is found of clusters takes as much again while it is found.
            hierarchy.check_step(2 * (CLUSTER_BYTES * clusters + NODE_BYTES * nodes))?;
            (leaves(elements).collect::<Arc<[u32]>>(), clusters, nodes)
        };
        let rays = MIN_RAYS.max(RAYS_AROUND.div_ceil(leaves.len().max(1)));
        let (hierarchy, shared_leaves) = (Arc::clone(shared), Arc::clone(&leaves));
        let escaped = parallel.map(leaves.len().div_ceil(LEAVES_PER_TASK), move |block| {
            let hierarchy = hierarchy.read().unwrap_or_else(PoisonError::into_inner);
            let leaves = shared_leaves[block * LEAVES_PER_TASK..].iter().take(LEAVES_PER_TASK);
            leaves.map(|&leaf| escaping(&hierarchy, leaf, rays)).collect::<Vec<_>>()
        })?;
        let (sight, intensity, emission, has_points): (_, Arc<[_]>, Arc<[_]>, _) = {
            let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
            let elements = &hierarchy.oracle.elements;
            let sight = sights(elements, &leaves, escaped.into_iter().flatten(), rays)?;
            if !sight.contains(&Sight::Closed) {
                return Ok(None);
            }
            let emitted = |patch: u32| elements.patches[patch as usize].emitted;
            let has_lamps = elements.patches.iter().any(|patch| patch.emitted != DVec3::ZERO);
            let emission = if has_lamps { intensities(elements, emitted)? } else { Vec::new() };
            let unit = intensities(elements, |_| DVec3::ONE)?;
            (sight, unit.into(), emission.into(), !hierarchy.oracle.lights.is_empty())
        };
        let unit = Arc::clone(&intensity);
        let unit = received_by(shared, count, parallel, move |hierarchy, link| {
            let nodes = &hierarchy.oracle.elements.nodes;
            if link.source >= POINT {
                return None;
            }
            let source = &nodes[link.source as usize];
            let d = (nodes[link.receiver as usize].centre - source.centre).normalize_or_zero();
            let strength = if source.is_cluster() { intensity_by(source, &unit, d).x } else { 1.0 };
            Some(strength * DVec3::new(1.0, link.doubt(true), 0.0))
        })?;
        let of_point = |hierarchy: &LinkHierarchy, link: &Link| {
            (link.source >= POINT).then(|| hierarchy.oracle.lights[(link.source - POINT) as usize].intensity)
        };
        let from_points = if has_points { received_by(shared, count, parallel, of_point)? } else { Vec::new() };
        let lamps = Arc::clone(&emission);
        let of_lamp = move |hierarchy: &LinkHierarchy, link: &Link| {
            (link.source < POINT).then(|| emitted(hierarchy, link, &lamps))
        };
        let from_lamps = if emission.is_empty() { Vec::new() } else { received_by(shared, count, parallel, of_lamp)? };
        let in_doubt = filled(DirectionalPolynomial::default(), count)?;
        let shifts = filled(0.0, nodes)?;
        Ok(Some(Self {
            intensity,
            emission,
            unit,
            in_doubt,
            from_points,
            from_lamps,
            sight,
            shifts,
            balance: DVec3::ONE,
        }))
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        let found = [&self.unit, &self.in_doubt, &self.from_points, &self.from_lamps].map(Vec::len);
        let intensities = self.intensity.len() + self.emission.len();
        size_of::<DirectionalPolynomial>() * (found.iter().sum::<usize>() + intensities) + NODE_BYTES * self.sight.len()
    }

    /// Intensity that a cluster emits in the unit direction `d`.
    pub fn emitted(&self, cluster: &Node, d: DVec3) -> DVec3 {
        if self.emission.is_empty() { DVec3::ZERO } else { intensity_by(cluster, &self.emission, d) }
    }

    /// Whether a leaf sees no elements.
    pub fn is_blind(&self, leaf: u32) -> bool {
        self.sight[leaf as usize] == Sight::Blind
    }

    /// The factor by which surfaces bring as much light to each other as leaves them, as far as none escapes. `of_surfaces`: the
    /// irradiance of each leaf by surfaces.
    pub fn balanced(
        &self,
        elements: &Elements,
        radiosity: &[DVec3],
        of_surfaces: impl Iterator<Item = (u32, DVec3)>,
    ) -> DVec3 {
        let (mut left, mut met) = (DVec3::ZERO, DVec3::ZERO);
        let (mut all, mut open) = (0.0, 0.0);
        for (leaf, irradiance) in of_surfaces {
            let b = radiosity[leaf as usize];
            let window = elements.nodes[leaf as usize].window();
            let light = window * (b + irradiance).element_sum();
            all += light;
            match self.sight[leaf as usize] {
                Sight::Closed => {
                    left += window * b;
                    met += window * irradiance;
                }
                Sight::Blind => {}
                Sight::Open => open += light,
            }
        }
        // The effect fades with the light that may escape, so that pictures do not jump where a scene changes.
        let effect = (1.0 - open / (MAX_OPEN * all)).max(0.0);
        let factor = |left: f64, met: f64| {
            let ratio = left / met;
            if !ratio.is_finite() || !effect.is_finite() {
                return 1.0;
            }
            1.0 + effect * (ratio.clamp(BALANCE_LIMITS[0], BALANCE_LIMITS[1]) - 1.0)
        };
        DVec3::new(factor(left.x, met.x), factor(left.y, met.y), factor(left.z, met.z))
    }

    /// The shift of a leaf that makes its row sum to one. `row`: the row and the doubt in it.
    pub fn shift_of(&self, leaf: u32, [row, in_doubt]: [f64; 2]) -> f64 {
        let shift = (1.0 - row) / in_doubt;
        if self.sight[leaf as usize] != Sight::Closed || !shift.is_finite() {
            return 0.0;
        }
        shift.clamp(SHIFT_LIMITS[0], SHIFT_LIMITS[1])
    }

    /// The shift of a leaf.
    pub fn shift(&self, leaf: u32) -> f64 {
        f64::from(self.shifts[leaf as usize])
    }

    /// Keeps what a balance found.
    pub fn keep(&mut self, balance: DVec3, shifts: impl Iterator<Item = (u32, f64)>) {
        self.balance = balance;
        for (leaf, shift) in shifts {
            self.shifts[leaf as usize] = shift as f32;
        }
    }
}

/// What a link's source, which is no point, emits: radiosity, or radiant intensity towards the receiver.
fn emitted(hierarchy: &LinkHierarchy, link: &Link, emission: &[DirectionalPolynomial]) -> DVec3 {
    let oracle = &hierarchy.oracle;
    let source = oracle.node(link.source);
    if !source.is_cluster() {
        oracle.elements.emitted(link.source)
    } else if emission.is_empty() {
        DVec3::ZERO
    } else {
        intensity_by(source, emission, (oracle.node(link.receiver).centre - source.centre).normalize_or_zero())
    }
}

/// Finds what is in doubt by the current radiosities.
pub(super) fn update(shared: &SharedHierarchy, parallel: &mut impl Parallel) -> Result<()> {
    let (count, emission) = {
        let hierarchy = shared.read().unwrap_or_else(PoisonError::into_inner);
        let Some(rows) = &hierarchy.rows else { return Ok(()) };
        (hierarchy.clusters.len(), Arc::clone(&rows.emission))
    };
    let in_doubt = received_by(shared, count, parallel, move |hierarchy, link| {
        let oracle = &hierarchy.oracle;
        if link.source >= POINT {
            return None;
        }
        let reflected = strength(oracle, &oracle.radiosity, link) - emitted(hierarchy, link, &emission);
        Some(link.doubt(true) * reflected.max(DVec3::ZERO))
    })?;
    if let Some(rows) = &mut shared.write().unwrap_or_else(PoisonError::into_inner).rows {
        rows.in_doubt = in_doubt;
    }
    Ok(())
}

/// How many of a leaf's rays meet no element.
fn escaping(hierarchy: &LinkHierarchy, leaf: u32, count: usize) -> u32 {
    let oracle = &hierarchy.oracle;
    let (elements, scene) = (&oracle.elements, &oracle.scene);
    let node = oracle.node(leaf);
    let numbers = scene.face_numbers();
    let unit = |bits: u64| (bits >> 40) as f32 / (1_u64 << 24) as f32;
    let ray = |k: usize| {
        let key = hash(u64::from(leaf), k as u64);
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| unit(hash(key, i)));
        let place = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
        let (at, n) = elements.point(node, place.map(f64::from));
        let local = cosine_hemisphere([(k as f32 + c) / count as f32, d]);
        Ray::new(at.offset(n), Frame::from_normal(n).to_world(local))
    };
    let rays: Vec<Ray> = (0..count).map(ray).collect();
    let mut hits = vec![None; count];
    scene.intersect_many(&rays, &mut hits);
    let is_element = |(ray, hit): (&Ray, &Option<_>)| {
        hit.as_ref().is_some_and(|hit| {
            let at = scene.interaction(ray, hit);
            let (face, weights) = numbers.of(hit);
            elements.leaf_at(face, at.ng.dot(ray.direction) < 0.0, weights, at.point.p.as_dvec3()).is_some()
        })
    };
    (count - rays.iter().zip(&hits).filter(|&it| is_element(it)).count()) as u32
}

/// What each leaf sees, by the rays of the leaf and its neighbours, `escaped` of `rays` each. Where faces lie in one plane, such as the lower
/// side of a box that stands on a floor, all rays of a leaf may start behind the other face: such leaves say nothing of their
/// neighbours.
fn sights(elements: &Elements, leaves: &[u32], escaped: impl Iterator<Item = u32>, rays: usize) -> Result<Vec<Sight>> {
    let nodes = &elements.nodes;
    // For each node and what is below it: rays, those that escaped, and both of leaves that see elements.
    let mut below = filled([0_usize; 4], nodes.len())?;
    for (&leaf, escaped) in leaves.iter().zip(escaped) {
        let escaped = escaped as usize;
        let [seeing, seen_past] = if escaped < rays { [rays, escaped] } else { [0, 0] };
        below[leaf as usize] = [rays, escaped, seeing, seen_past];
    }
    for number in (0..nodes.len()).rev().filter(|&number| nodes[number].parent != NONE) {
        let own = below[number];
        let parent = &mut below[nodes[number].parent as usize];
        *parent = std::array::from_fn(|i| parent[i] + own[i]);
    }
    // The smallest group around a leaf with as many rays as are asked for.
    let around = |leaf: u32, kind: usize| {
        let mut around = leaf as usize;
        while below[around][kind] < RAYS_AROUND && nodes[around].parent != NONE {
            around = nodes[around].parent as usize;
        }
        below[around]
    };
    let mut sight = filled(Sight::Open, nodes.len())?;
    for &leaf in leaves {
        let sees_elements = below[leaf as usize][2] > 0;
        let [all, escaped, ..] = around(leaf, 0);
        let [.., past] = around(leaf, 2);
        sight[leaf as usize] = if sees_elements && past == 0 {
            Sight::Closed
        } else if escaped == all {
            Sight::Blind
        } else {
            Sight::Open
        };
    }
    Ok(sight)
}
