//! Building the tree: top-down by the smallest expected cost of the two sides of a split, then bounds bottom-up.
//!
//! The cost of a set of emitters is its intensity times the square of its diagonal times a measure of the spread of its
//! normals (Conty Estevez and Kulla 2018, Sec. 4.4, with a measure that needs no trigonometry).

use super::cone::Cone;
use super::{IS_EMITTER, LightTree, NONE, Node, WIDTH};
use crate::emitter::Emitter;
use crate::math::{Bounds, DVec3, Vec3};
use crate::room::check_room;
use crate::{Cancel, Result};

/// Bins for splits along each axis.
const BINS: usize = 12;

/// An intensity is at least this fraction of the sum, so that no product underflows.
const MIN_INTENSITY: f32 = 1e-9;

/// Bounding spheres are enlarged by this, in sizes of the tree, for rounding to single precision.
const RADIUS_ROUNDING: f64 = 4e-7;

/// Emitters between two checks for cancellation.
const EMITTERS_PER_CHECK: usize = 1 << 14;

/// An emitter while the tree is built; lengths as in the tree.
#[derive(Clone, Copy)]
struct BuildItem {
    min: Vec3,
    max: Vec3,
    /// Normal times intensity; 0 where the emitter emits in all directions.
    aim: Vec3,
    intensity: f32,
    emitter: u32,
}

/// The combined bounds and intensity of some items.
#[derive(Clone, Copy)]
struct Extent {
    min: Vec3,
    max: Vec3,
    aim: Vec3,
    intensity: f32,
}

impl Extent {
    const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY), aim: Vec3::ZERO, intensity: 0.0 };

    fn of(items: &[BuildItem], cancel: &Cancel) -> Result<Self> {
        items.chunks(EMITTERS_PER_CHECK).try_fold(Self::EMPTY, |all, block| {
            cancel.check()?;
            Ok(block.iter().fold(all, |all, item| all.with(&item.extent())))
        })
    }

    #[inline]
    fn with(self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            aim: self.aim + other.aim,
            intensity: self.intensity + other.intensity,
        }
    }

    #[inline]
    fn cost(&self) -> f32 {
        if self.intensity == 0.0 {
            return 0.0;
        }
        // The mean of equal normals has length 1, and that of normals in all directions has length 0. In the latter
        // case light goes to four times as many directions.
        let spread = 4.0 - 3.0 * (self.aim.length() / self.intensity).min(1.0);
        self.intensity * (self.max - self.min).length_squared() * spread
    }
}

impl BuildItem {
    #[inline]
    fn extent(&self) -> Extent {
        Extent { min: self.min, max: self.max, aim: self.aim, intensity: self.intensity }
    }

    #[inline]
    fn centre(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
}

/// Bounds of a subtree, in double precision until they are stored.
#[derive(Clone)]
struct SubtreeBounds {
    centre: DVec3,
    radius: f64,
    cone: Cone,
    intensity: f32,
}

/// Bounding sphere of an emitter and cone of its normals.
fn bound(emitter: &Emitter) -> (DVec3, f64, Cone) {
    if let Emitter::Web(web) = emitter {
        // As of a point with a web, whose light does not fall off by a cosine: the cone of the axis and of the light itself.
        let (axis, angle) = web.cone();
        let bounds = web.bounds();
        return (bounds.centre(), 0.5 * (bounds.max - bounds.min).length(), Cone { axis, angle });
    }
    if let Some(triangle) = emitter.triangle() {
        let corners = triangle.vertices.map(Vec3::as_dvec3);
        let centre = Bounds::around(corners).centre();
        let radius = corners.iter().map(|corner| corner.distance(centre)).fold(0.0, f64::max);
        return (centre, radius, Cone::along(triangle.normal.as_dvec3().normalize()));
    }
    if let Some(moving) = emitter.moving() {
        let bounds = moving.bounds();
        return (bounds.centre(), 0.5 * (bounds.max - bounds.min).length(), moving.cone());
    }
    if let Some(sphere) = emitter.sphere() {
        return (sphere.centre, sphere.radius, Cone::ALL);
    }
    match emitter {
        Emitter::Point { position, .. } => (position.as_dvec3(), 0.0, Cone::ALL),
        // The cone of the axis and of the light itself: what is outside of it by less than a right angle counts as dim.
        Emitter::Directed(emitter) => {
            let (axis, angle) = emitter.distribution.cone();
            (emitter.position.as_dvec3(), 0.0, Cone { axis, angle })
        }
        Emitter::Disk(emitter) => {
            let radius = 0.5 * (emitter.bounds().max - emitter.bounds().min).length();
            (emitter.disk.centre(), radius, Cone::along(emitter.disk.normal()))
        }
        Emitter::Tube(_) | Emitter::InnerTube(_) => {
            let bounds = bounds(emitter);
            (bounds.centre(), 0.5 * (bounds.max - bounds.min).length(), Cone::ALL)
        }
        // What is at infinity is given to no tree.
        _ => (emitter.centre().as_dvec3(), 0.0, Cone::ALL),
    }
}

fn bounds(emitter: &Emitter) -> Bounds {
    if let Some(triangle) = emitter.triangle() {
        return Bounds::around(triangle.vertices.map(Vec3::as_dvec3));
    }
    if let Some(moving) = emitter.moving() {
        return moving.bounds();
    }
    match emitter {
        Emitter::Disk(emitter) => emitter.bounds(),
        Emitter::Web(emitter) => emitter.bounds(),
        Emitter::Tube(emitter) => emitter.bounds(),
        Emitter::InnerTube(emitter) => emitter.outer.bounds(),
        _ => match emitter.sphere() {
            Some(sphere) => sphere.bounds(),
            None => Bounds::around([emitter.centre().as_dvec3()]),
        },
    }
}

/// Radiant intensity in the brightest direction over the emitted power.
fn intensity_per_power(emitter: &Emitter) -> f64 {
    let per_pi = match emitter {
        Emitter::Directed(emitter) => {
            let distribution = &emitter.distribution;
            return if distribution.flux() > 0.0 { distribution.peak() / distribution.flux() } else { 0.0 };
        }
        Emitter::Web(emitter) => return emitter.peak_share(),
        Emitter::Triangle(_) | Emitter::Textured(_) | Emitter::Disk(_) => 1.0,
        // Over pi, as the others.
        Emitter::Tube(emitter) => emitter.intensity_share(),
        Emitter::InnerTube(emitter) => emitter.outer.intensity_share(),
        Emitter::Point { .. }
        | Emitter::Sphere(_)
        | Emitter::Environment(_)
        | Emitter::EnvironmentMap(_)
        | Emitter::Distant(_) => 0.25,
        Emitter::TexturedSphere(emitter) => emitter.intensity_share(),
        Emitter::Moving(emitter) => emitter.intensity_per_power(),
    };
    per_pi / std::f64::consts::PI
}

impl LightTree {
    /// The tree of those emitters whose power is above 0; `powers` are finite, and one of them is above 0.
    pub(in crate::emitter) fn new(emitters: &[Emitter], powers: &[f64], cancel: &Cancel) -> Result<Self> {
        // Their numbers, the items of them, the nodes and the slots of the nodes.
        check_room(emitters.len().saturating_mul(size_of::<BuildItem>() + size_of::<Node>() / 2 + 16))?;
        let emitting: Vec<u32> = (0..emitters.len() as u32).filter(|&i| powers[i as usize] > 0.0).collect();
        let mut all = Bounds::EMPTY;
        let mut total = 0.0;
        for block in emitting.chunks(EMITTERS_PER_CHECK) {
            cancel.check()?;
            for &i in block {
                let emitter = &emitters[i as usize];
                all = all.union(bounds(emitter));
                total += intensity_per_power(emitter) * powers[i as usize];
            }
        }
        let centre = all.centre().as_vec3a();
        let size = (0.5 * (all.max - all.min)).max_element().clamp(1e-30, 1e30);
        let inverse_size = (1.0 / size) as f32;
        let frame = TreeFrame { centre: centre.as_dvec3(), inverse_size: f64::from(inverse_size) };
        let mut items = Vec::with_capacity(emitting.len());
        for block in emitting.chunks(EMITTERS_PER_CHECK) {
            cancel.check()?;
            items.extend(block.iter().map(|&i| {
                let emitter = &emitters[i as usize];
                let bounds = bounds(emitter);
                let intensity = (intensity_per_power(emitter) * powers[i as usize] / total) as f32;
                let intensity = intensity.max(MIN_INTENSITY);
                let aim = emitter.normal().map_or(Vec3::ZERO, |normal| intensity * normal);
                let (min, max) = (frame.to_tree(bounds.min).as_vec3a(), frame.to_tree(bounds.max).as_vec3a());
                BuildItem { min, max, aim, intensity, emitter: i }
            }));
        }
        let mut nodes = build_nodes(&mut items, cancel)?;
        let mut slot = vec![NONE; emitters.len()];
        compute_bounds(&mut nodes, &mut slot, emitters, &items, &frame, cancel)?;
        Ok(Self { nodes, slot, emitting, centre, inverse_size })
    }
}

/// The transform from the scene frame to the tree's frame.
struct TreeFrame {
    centre: DVec3,
    inverse_size: f64,
}

impl TreeFrame {
    fn to_tree(&self, p: DVec3) -> DVec3 {
        (p - self.centre) * self.inverse_size
    }
}

const EMPTY: Node = Node {
    centre: [[0.0; WIDTH]; 3],
    radius2: [1.0; WIDTH],
    axis: [[0.0; WIDTH]; 3],
    cos: [1.0; WIDTH],
    sin: [0.0; WIDTH],
    intensity: [0.0; WIDTH],
    child: [NONE; WIDTH],
    parent: NONE,
};

/// Nodes without bounds, parents before their children. A child that is an emitter is stored as its index among the
/// items.
fn build_nodes(items: &mut [BuildItem], cancel: &Cancel) -> Result<Vec<Node>> {
    let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
    let mut pending = vec![(0, items.len(), NONE)];
    while let Some((start, end, parent)) = pending.pop() {
        // Splits of more than a few look for themselves.
        if nodes.len().is_multiple_of(EMITTERS_PER_CHECK) {
            cancel.check()?;
        }
        let number = nodes.len() as u32;
        let mut node = Node { parent, ..EMPTY };
        if parent != NONE {
            let above: &mut Node = &mut nodes[parent as usize / WIDTH];
            above.child[parent as usize % WIDTH] = number;
        }
        let mut parts = [(0, 0); WIDTH];
        let count = split_in_four(items, (start, end), &mut parts, cancel)?;
        for (k, &(start, end)) in parts[..count].iter().enumerate() {
            if end - start == 1 {
                node.child[k] = IS_EMITTER | start as u32;
            } else {
                pending.push((start, end, number * WIDTH as u32 + k as u32));
            }
        }
        nodes.push(node);
    }
    Ok(nodes)
}

/// Divides a range of items into up to four parts, and returns their number.
fn split_in_four(
    items: &mut [BuildItem],
    all: (usize, usize),
    parts: &mut [(usize, usize); WIDTH],
    cancel: &Cancel,
) -> Result<usize> {
    parts[0] = all;
    let mut count = 1;
    if all.1 - all.0 <= WIDTH {
        for (k, part) in parts.iter_mut().take(all.1 - all.0).enumerate() {
            *part = (all.0 + k, all.0 + k + 1);
        }
        return Ok(all.1 - all.0);
    }
    let mut costs = [0.0; WIDTH];
    while count < WIDTH {
        // The part with the largest cost is split; among equal costs, the one with the most items. A part with at least
        // two items exists.
        let Some(costliest) = (0..count).filter(|&k| parts[k].1 - parts[k].0 > 1).max_by(|&a, &b| {
            f32::total_cmp(&costs[a], &costs[b]).then((parts[a].1 - parts[a].0).cmp(&(parts[b].1 - parts[b].0)))
        }) else {
            break;
        };
        let (start, end) = parts[costliest];
        let middle = start + split(&mut items[start..end], cancel)?;
        parts[costliest] = (start, middle);
        parts[count] = (middle, end);
        costs[costliest] = Extent::of(&items[start..middle], cancel)?.cost();
        costs[count] = Extent::of(&items[middle..end], cancel)?.cost();
        count += 1;
    }
    Ok(count)
}

/// Partitions two or more items into two sides; returns the number of items on the first side.
fn split(items: &mut [BuildItem], cancel: &Cancel) -> Result<usize> {
    let (mut min, mut max) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    for block in items.chunks(EMITTERS_PER_CHECK) {
        cancel.check()?;
        for item in block {
            let centre = item.centre();
            (min, max) = (min.min(centre), max.max(centre));
        }
    }
    let extent = max - min;
    let longest = extent.max_position();
    if items.len() == 2 || extent[longest] <= 0.0 {
        return Ok(items.len() / 2);
    }
    let bins = BINS.min(items.len());
    // The last bin also holds the greatest. An axis of no extent has one bin, and so no split.
    let per_bin = Vec3::from_array(extent.to_array().map(|extent| {
        let per_bin = 0.9999 * bins as f32 / extent;
        if per_bin.is_finite() { per_bin } else { 0.0 }
    }));
    let bin = |item: &BuildItem| (item.centre() - min) * per_bin;
    let mut slices = [[Extent::EMPTY; BINS]; 3];
    for block in items.chunks(EMITTERS_PER_CHECK) {
        cancel.check()?;
        for item in block {
            let bin = bin(item);
            let extent = item.extent();
            for (axis, slices) in slices.iter_mut().enumerate() {
                let slice = &mut slices[(bin[axis] as usize).min(BINS - 1)];
                *slice = slice.with(&extent);
            }
        }
    }
    let mut best = (f32::INFINITY, longest, 0);
    for (axis, slices) in slices.iter().enumerate() {
        let mut above = [0.0; BINS];
        let mut side = Extent::EMPTY;
        for k in (1..bins).rev() {
            side = side.with(&slices[k]);
            above[k] = if side.intensity > 0.0 { side.cost() } else { f32::INFINITY };
        }
        let mut side = Extent::EMPTY;
        for k in 1..bins {
            side = side.with(&slices[k - 1]);
            if side.intensity > 0.0 {
                let cost = side.cost() + above[k];
                if cost < best.0 {
                    best = (cost, axis, k);
                }
            }
        }
    }
    let (_, axis, first) = best;
    let mut count = 0;
    for k in 0..items.len() {
        if k.is_multiple_of(EMITTERS_PER_CHECK) {
            cancel.check()?;
        }
        if (bin(&items[k])[axis] as usize) < first {
            items.swap(k, count);
            count += 1;
        }
    }
    Ok(if count == 0 || count == items.len() { items.len() / 2 } else { count })
}

/// Computes bounds from the last node to the first, so that children come before their parents, and the position of
/// each emitter in the tree.
fn compute_bounds(
    nodes: &mut [Node],
    slot: &mut [u32],
    emitters: &[Emitter],
    items: &[BuildItem],
    frame: &TreeFrame,
    cancel: &Cancel,
) -> Result<()> {
    // Bounds of nodes whose parent has not been processed yet.
    let mut done: Vec<Option<SubtreeBounds>> = Vec::new();
    done.resize_with(nodes.len(), || None);
    for number in (0..nodes.len()).rev() {
        if number % EMITTERS_PER_CHECK == 0 {
            cancel.check()?;
        }
        let node = &mut nodes[number];
        let mut children: [Option<SubtreeBounds>; WIDTH] = [const { None }; WIDTH];
        for (k, child) in children.iter_mut().enumerate() {
            if node.child[k] == NONE {
                continue;
            }
            *child = if node.child[k] & IS_EMITTER == 0 {
                done[node.child[k] as usize].take()
            } else {
                let item = &items[(node.child[k] & !IS_EMITTER) as usize];
                node.child[k] = IS_EMITTER | item.emitter;
                slot[item.emitter as usize] = (number * WIDTH + k) as u32;
                let (centre, radius, cone) = bound(&emitters[item.emitter as usize]);
                let (centre, radius) = (frame.to_tree(centre), radius * frame.inverse_size);
                Some(SubtreeBounds { centre, radius, cone, intensity: item.intensity })
            };
            if let Some(bound) = child {
                node.store(k, bound);
            }
        }
        done[number] = union_of(children.into_iter().flatten());
    }
    Ok(())
}

impl Node {
    fn store(&mut self, k: usize, bound: &SubtreeBounds) {
        let centre = bound.centre.as_vec3a();
        let radius = bound.radius * (1.0 + RADIUS_ROUNDING) + RADIUS_ROUNDING;
        let axis = bound.cone.axis.as_vec3a();
        for i in 0..3 {
            self.centre[i][k] = centre[i];
            self.axis[i][k] = axis[i];
        }
        self.radius2[k] = (radius * radius) as f32;
        let (sin, cos) = bound.cone.angle.sin_cos();
        (self.sin[k], self.cos[k]) = (sin.max(0.0) as f32, cos as f32);
        if bound.cone.angle >= std::f64::consts::PI {
            // Any cosine is larger, rounded or not.
            self.cos[k] = -2.0;
        }
        self.intensity[k] = bound.intensity;
    }
}

/// The common bounds of all; `None` where there are none.
fn union_of(bounds: impl Iterator<Item = SubtreeBounds> + Clone) -> Option<SubtreeBounds> {
    let spheres = bounds.clone();
    let all = spheres.fold(Bounds::EMPTY, |all, bound| {
        all.union(Bounds { min: bound.centre - bound.radius, max: bound.centre + bound.radius })
    });
    let centre = all.centre();
    bounds.fold(None, |all: Option<SubtreeBounds>, bound| {
        let radius = bound.centre.distance(centre) + bound.radius;
        Some(match all {
            None => SubtreeBounds { centre, radius, ..bound },
            Some(all) => SubtreeBounds {
                centre,
                radius: all.radius.max(radius),
                cone: all.cone.union(bound.cone),
                intensity: all.intensity + bound.intensity,
            },
        })
    })
}
