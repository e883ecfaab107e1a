//! An octree of the records' spheres, which finds the spheres that hold a point.
//!
//! A sphere is listed in every leaf that it overlaps, so a query is one descent and one short list. A leaf is split
//! where several spheres smaller than the leaf come together; splitting for larger spheres would only list them more
//! often.

use std::ops::Range;

use super::record::RecordSphere;
use crate::math::Vec3;

/// A leaf is split when it lists more spheres smaller than itself than this.
const SPLIT_THRESHOLD: usize = 6;

/// Most levels below the root.
const MAX_DEPTH: u32 = 20;

/// A node of the octree.
#[derive(Clone, Debug)]
enum Node {
    /// Index of the first of eight children. Bit 0 of their order is x, bit 1 y, bit 2 z; a set bit is the upper half.
    Inner(u32),
    /// Indices of spheres.
    Leaf(Vec<u32>),
}

/// The cube that the octree divides.
#[derive(Clone, Copy, Debug, Default)]
struct Cube {
    min: Vec3,
    side: f32,
    /// 2^MAX_DEPTH / side.
    scale: f32,
}

/// An octree to which spheres can be added.
#[derive(Clone, Debug)]
pub(super) struct GrowingOctree {
    cube: Cube,
    nodes: Vec<Node>,
    spheres: Vec<RecordSphere>,
    listing_count: usize,
}

/// A compact octree for fast queries.
#[derive(Clone, Debug, Default)]
pub(super) struct PackedOctree {
    cube: Cube,
    nodes: Vec<PackedNode>,
    lists: Vec<RecordSphere>,
}

/// `count` of an inner node.
const INNER: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct PackedNode {
    /// Index of the first child, or of the first entry of the list.
    first: u32,
    count: u32,
}

/// The region of a node, as a traversal computes it.
#[derive(Clone, Copy)]
struct Cell {
    node: usize,
    middle: Vec3,
    half: f32,
    depth: u32,
}

impl Cell {
    fn child(&self, first: u32, number: usize) -> Self {
        let half = 0.5 * self.half;
        let side = |bit: usize| if number >> bit & 1 == 1 { half } else { -half };
        let middle = self.middle + Vec3::new(side(0), side(1), side(2));
        Self { node: first as usize + number, middle, half, depth: self.depth + 1 }
    }

    /// Whether a sphere overlaps the cell. The test is enlarged a little for the rounding of queries.
    fn is_reached(&self, p: Vec3, radius: f32) -> bool {
        let beyond = ((p - self.middle).abs() - self.half).max(Vec3::ZERO);
        let radius = radius * 1.0001 + self.half * 1e-5;
        beyond.length_squared() <= radius * radius
    }
}

impl Cube {
    fn root(&self) -> Cell {
        let half = 0.5 * self.side;
        Cell { node: 0, middle: self.min + half, half, depth: 0 }
    }

    /// The point in units of the finest cells; `None` outside the cube.
    #[inline]
    fn grid_cell(&self, p: Vec3) -> Option<[u32; 3]> {
        let place = (p - self.min) * self.scale;
        let is_inside = place.cmpge(Vec3::ZERO).all() && place.cmplt(Vec3::splat((1_u32 << MAX_DEPTH) as f32)).all();
        is_inside.then(|| place.to_array().map(|v| v as u32))
    }
}

/// The child that holds a point.
#[inline]
fn octant([x, y, z]: [u32; 3], depth: u32) -> u32 {
    let bit = MAX_DEPTH - 1 - depth;
    (x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2
}

impl GrowingOctree {
    /// An empty octree for points in the cube of this side whose least corner is `min`.
    pub fn new(min: Vec3, side: f32) -> Self {
        let cube = Cube { min, side, scale: (1_u32 << MAX_DEPTH) as f32 / side };
        Self { cube, nodes: vec![Node::Leaf(Vec::new())], spheres: Vec::new(), listing_count: 0 }
    }

    pub fn spheres(&self) -> &[RecordSphere] {
        &self.spheres
    }

    /// Gives a sphere a smaller radius.
    pub fn shrink(&mut self, number: usize, radius: f32) {
        self.spheres[number].inverse_radius = 1.0 / radius;
    }

    /// Spheres that may hold `p`.
    pub fn candidates(&self, p: Vec3) -> impl Iterator<Item = &RecordSphere> {
        let list: &[u32] = self.cube.grid_cell(p).map_or(&[], |place| {
            let mut node = 0;
            for depth in 0.. {
                match &self.nodes[node] {
                    Node::Leaf(list) => return list,
                    Node::Inner(first) => node = (first + octant(place, depth)) as usize,
                }
            }
            &[]
        });
        list.iter().map(|&number| &self.spheres[number as usize])
    }

    /// Indices of the spheres that are listed where a sphere around `p` overlaps, each once, in order.
    pub fn overlapping(&self, p: Vec3, radius: f32) -> Vec<u32> {
        let mut found = Vec::new();
        self.leaves(p, radius, |_, list| found.extend_from_slice(list));
        found.sort_unstable();
        found.dedup();
        found
    }

    fn leaves(&self, p: Vec3, radius: f32, mut visit: impl FnMut(Cell, &[u32])) {
        let mut stack = vec![self.cube.root()];
        while let Some(cell) = stack.pop() {
            if !cell.is_reached(p, radius) {
                continue;
            }
            match &self.nodes[cell.node] {
                Node::Leaf(list) => visit(cell, list),
                Node::Inner(first) => stack.extend((0..8).map(|number| cell.child(*first, number))),
            }
        }
    }

    /// Adds a sphere; its record's index is the number of spheres before it. No leaf is split when that would make more
    /// than `max_listings` entries.
    pub fn add(&mut self, sphere: RecordSphere, max_listings: usize) {
        let number = self.spheres.len() as u32;
        self.spheres.push(sphere);
        let mut cells = Vec::new();
        self.leaves(sphere.position(), sphere.radius(), |cell, _| cells.push(cell));
        for cell in cells {
            if let Node::Leaf(list) = &mut self.nodes[cell.node] {
                list.push(number);
                self.listing_count += 1;
            }
            self.split(cell, max_listings);
        }
    }

    fn split(&mut self, cell: Cell, max_listings: usize) {
        let Node::Leaf(list) = &self.nodes[cell.node] else { return };
        let is_small = |number: &&u32| self.spheres[**number as usize].radius() < cell.half;
        if list.iter().filter(is_small).count() <= SPLIT_THRESHOLD
            || cell.depth == MAX_DEPTH
            || self.listing_count + 8 * list.len() > max_listings
        {
            return;
        }
        let first = self.nodes.len() as u32;
        let Node::Leaf(list) = std::mem::replace(&mut self.nodes[cell.node], Node::Inner(first)) else { return };
        self.listing_count -= list.len();
        let children = (0..8).map(|number| cell.child(first, number));
        for child in children.clone() {
            let reaches = |number: &u32| {
                let sphere = &self.spheres[*number as usize];
                child.is_reached(sphere.position(), sphere.radius())
            };
            let list: Vec<u32> = list.iter().copied().filter(reaches).collect();
            self.listing_count += list.len();
            self.nodes.push(Node::Leaf(list));
        }
        for child in children {
            self.split(child, max_listings);
        }
    }

    /// The octree in its compact form for queries.
    pub fn pack(&self) -> PackedOctree {
        let mut tree =
            PackedOctree { cube: self.cube, nodes: vec![PackedNode { first: 0, count: 0 }], lists: Vec::new() };
        let mut stack = vec![(self.cube.root(), 0)];
        while let Some((cell, place)) = stack.pop() {
            tree.nodes[place] = match &self.nodes[cell.node] {
                Node::Inner(first) => {
                    let packed = tree.nodes.len();
                    tree.nodes.resize(packed + 8, PackedNode { first: 0, count: 0 });
                    stack.extend((0..8).map(|number| (cell.child(*first, number), packed + number)));
                    PackedNode { first: packed as u32, count: INNER }
                }
                Node::Leaf(list) => {
                    let from = tree.lists.len();
                    let spheres = list.iter().map(|&number| self.spheres[number as usize]);
                    // Radii may have shrunk since the sphere was listed.
                    tree.lists.extend(spheres.filter(|sphere| cell.is_reached(sphere.position(), sphere.radius())));
                    PackedNode { first: from as u32, count: (tree.lists.len() - from) as u32 }
                }
            };
        }
        tree
    }
}

impl PackedOctree {
    /// Spheres that may hold `p`.
    #[inline]
    pub fn candidates(&self, p: Vec3) -> &[RecordSphere] {
        let Some(place) = self.cube.grid_cell(p) else { return &[] };
        let Some(mut node) = self.nodes.first() else { return &[] };
        let mut depth = 0;
        while node.count == INNER {
            node = &self.nodes[(node.first + octant(place, depth)) as usize];
            depth += 1;
        }
        let range: Range<usize> = node.first as usize..(node.first + node.count) as usize;
        &self.lists[range]
    }

    /// Memory of the octree, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.lists)
    }
}
