//! Which records' balls hold a point: an octree whose leaves list them.
//!
//! A ball is listed in every leaf that it reaches into, so a query is one way down and one short list. Leaves are cut where
//! several balls smaller than they are come together; larger ones would only be listed more often.

use std::ops::Range;

use super::record::Ball;
use crate::math::Vec3;

/// Balls that are smaller than a leaf, for which it is cut.
const CROWD: usize = 6;

/// Levels below the root.
const DEPTH: u32 = 20;

/// A place in the tree.
#[derive(Clone, Debug)]
enum Node {
    /// Number of the first of eight children; bit 0 of their order is x, bit 1 y, bit 2 z, the upper half where set.
    Inner(u32),
    /// Numbers of balls.
    Leaf(Vec<u32>),
}

/// The cube that the tree divides.
#[derive(Clone, Copy, Debug, Default)]
struct Cube {
    min: Vec3,
    side: f32,
    /// 2^DEPTH / side.
    scale: f32,
}

/// A tree that balls can be added to.
#[derive(Clone, Debug)]
pub(super) struct Growing {
    cube: Cube,
    nodes: Vec<Node>,
    balls: Vec<Ball>,
    listed: usize,
}

/// A tree to be asked quickly.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    cube: Cube,
    nodes: Vec<Packed>,
    lists: Vec<Ball>,
}

/// `count` of an inner node.
const INNER: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Packed {
    /// First child, or place of the list.
    first: u32,
    count: u32,
}

/// A cell on the way down.
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

    /// Whether a ball reaches into it; a little more than that, for what rounding does to a query.
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

    /// The point in units of the finest cells; `None` outside.
    #[inline]
    fn place(&self, p: Vec3) -> Option<[u32; 3]> {
        let place = (p - self.min) * self.scale;
        let is_inside = place.cmpge(Vec3::ZERO).all() && place.cmplt(Vec3::splat((1_u32 << DEPTH) as f32)).all();
        is_inside.then(|| place.to_array().map(|v| v as u32))
    }
}

/// The child that a point is in.
#[inline]
fn octant([x, y, z]: [u32; 3], depth: u32) -> u32 {
    let bit = DEPTH - 1 - depth;
    (x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2
}

impl Growing {
    /// An empty tree for points in the cube of this side from `min` on.
    pub fn new(min: Vec3, side: f32) -> Self {
        let cube = Cube { min, side, scale: (1_u32 << DEPTH) as f32 / side };
        Self { cube, nodes: vec![Node::Leaf(Vec::new())], balls: Vec::new(), listed: 0 }
    }

    pub fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// Gives a ball a smaller radius.
    pub fn shrink(&mut self, number: usize, radius: f32) {
        self.balls[number].inverse_radius = 1.0 / radius;
    }

    /// Balls that may hold `p`.
    pub fn around(&self, p: Vec3) -> impl Iterator<Item = &Ball> {
        let list: &[u32] = self.cube.place(p).map_or(&[], |place| {
            let mut node = 0;
            for depth in 0.. {
                match &self.nodes[node] {
                    Node::Leaf(list) => return list,
                    Node::Inner(first) => node = (first + octant(place, depth)) as usize,
                }
            }
            &[]
        });
        list.iter().map(|&number| &self.balls[number as usize])
    }

    /// Numbers of the balls that are listed where a ball around `p` reaches, each once, in order.
    pub fn near(&self, p: Vec3, radius: f32) -> Vec<u32> {
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

    /// Adds a ball; its record's number is that of the balls before it. `most`: no leaf is cut beyond so many listings.
    pub fn add(&mut self, ball: Ball, most: usize) {
        let number = self.balls.len() as u32;
        self.balls.push(ball);
        let mut cells = Vec::new();
        self.leaves(ball.position(), ball.radius(), |cell, _| cells.push(cell));
        for cell in cells {
            if let Node::Leaf(list) = &mut self.nodes[cell.node] {
                list.push(number);
                self.listed += 1;
            }
            self.cut(cell, most);
        }
    }

    fn cut(&mut self, cell: Cell, most: usize) {
        let Node::Leaf(list) = &self.nodes[cell.node] else { return };
        let is_small = |number: &&u32| self.balls[**number as usize].radius() < cell.half;
        if list.iter().filter(is_small).count() <= CROWD || cell.depth == DEPTH || self.listed + 8 * list.len() > most {
            return;
        }
        let first = self.nodes.len() as u32;
        let Node::Leaf(list) = std::mem::replace(&mut self.nodes[cell.node], Node::Inner(first)) else { return };
        self.listed -= list.len();
        let children = (0..8).map(|number| cell.child(first, number));
        for child in children.clone() {
            let reaches = |number: &u32| {
                let ball = &self.balls[*number as usize];
                child.is_reached(ball.position(), ball.radius())
            };
            let list: Vec<u32> = list.iter().copied().filter(reaches).collect();
            self.listed += list.len();
            self.nodes.push(Node::Leaf(list));
        }
        for child in children {
            self.cut(child, most);
        }
    }

    /// The tree as it is, to be asked.
    pub fn pack(&self) -> Tree {
        let mut tree = Tree { cube: self.cube, nodes: vec![Packed { first: 0, count: 0 }], lists: Vec::new() };
        let mut stack = vec![(self.cube.root(), 0)];
        while let Some((cell, place)) = stack.pop() {
            tree.nodes[place] = match &self.nodes[cell.node] {
                Node::Inner(first) => {
                    let packed = tree.nodes.len();
                    tree.nodes.resize(packed + 8, Packed { first: 0, count: 0 });
                    stack.extend((0..8).map(|number| (cell.child(*first, number), packed + number)));
                    Packed { first: packed as u32, count: INNER }
                }
                Node::Leaf(list) => {
                    let from = tree.lists.len();
                    let balls = list.iter().map(|&number| self.balls[number as usize]);
                    // Radii may have shrunk since.
                    tree.lists.extend(balls.filter(|ball| cell.is_reached(ball.position(), ball.radius())));
                    Packed { first: from as u32, count: (tree.lists.len() - from) as u32 }
                }
            };
        }
        tree
    }
}

impl Tree {
    /// Balls that may hold `p`.
    #[inline]
    pub fn around(&self, p: Vec3) -> &[Ball] {
        let Some(place) = self.cube.place(p) else { return &[] };
        let Some(mut node) = self.nodes.first() else { return &[] };
        let mut depth = 0;
        while node.count == INNER {
            node = &self.nodes[(node.first + octant(place, depth)) as usize];
            depth += 1;
        }
        let range: Range<usize> = node.first as usize..(node.first + node.count) as usize;
        &self.lists[range]
    }

    /// Memory it takes, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.lists)
    }
}
