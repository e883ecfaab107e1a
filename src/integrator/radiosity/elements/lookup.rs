//! The leaf at a point of a surface.

use super::{Elements, NONE, Node, Patch};
use crate::math::DVec3;

impl Elements {
    /// The leaf at a point on one side of a face, and the barycentric weights of the leaf's second and third corner.
    /// The point is given by the `weights` of the second and third corner of a triangle, and on a shape by `p`, scene
    /// frame.
    pub fn leaf_at(&self, face: u32, is_front: bool, weights: [f32; 2], p: DVec3) -> Option<(u32, [f64; 2])> {
        let side = self.sides.get(face as usize)?[usize::from(!is_front)];
        let patches = &self.patches[side.first as usize..(side.first + side.count) as usize];
        let patch = patches.first()?;
        if patch.shape != NONE {
            return self.leaf_on_shape(patches, p);
        }
        let (number, at) = self.leaf_below(patch.node, weights.map(|w| f64::from(w).clamp(0.0, 1.0)));
        Some((number, inside(at)))
    }

    /// The leaf below an element at weights of its second and third corner, and the weights of the leaf's corners.
    pub fn leaf_below(&self, mut number: u32, [mut s, mut t]: [f64; 2]) -> (u32, [f64; 2]) {
        while let Node { first, children: 4, .. } = self.nodes[number as usize] {
            let child;
            let r = 1.0 - s - t;
            (child, s, t) = if r > 0.5 {
                (0, 2.0 * s, 2.0 * t)
            } else if s > 0.5 {
                (1, 2.0 * s - 1.0, 2.0 * t)
            } else if t > 0.5 {
                (2, 2.0 * s, 2.0 * t - 1.0)
            } else {
                // The corners of the middle child are opposite to the first, second and third corner.
                (3, 1.0 - 2.0 * s, 1.0 - 2.0 * t)
            };
            number = first + child;
        }
        (number, [s, t])
    }

    fn leaf_on_shape(&self, patches: &[Patch], p: DVec3) -> Option<(u32, [f64; 2])> {
        let best = |numbers: &mut dyn Iterator<Item = u32>| {
            let mut best = (f64::NEG_INFINITY, NONE, [0.0; 2]);
            for number in numbers {
                let node = &self.nodes[number as usize];
                let [s, t] = weights(&self.triangle(node), p);
                // The point should be inside the triangle, and not on the far side of the shape.
                let height = (p - node.centre).dot(node.normal).abs() / node.radius;
                let least = s.min(t).min(1.0 - s - t) - 4.0 * (height - 1.0).max(0.0);
                if least > best.0 {
                    best = (least, number, [s, t]);
                }
            }
            best
        };
        let (_, mut number, mut at) = best(&mut patches.iter().map(|patch| patch.node));
        while number != NONE && !self.nodes[number as usize].is_leaf() {
            let range = self.nodes[number as usize].range();
            (_, number, at) = best(&mut range.map(|number| number as u32));
        }
        (number != NONE).then_some((number, inside(at)))
    }
}

/// Barycentric weights of the second and third corner for the projection of `p` to a triangle's plane.
fn weights(&[a, b, c]: &[DVec3; 3], p: DVec3) -> [f64; 2] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let n = ab.cross(ac);
    let n2 = n.length_squared();
    if n2 > 0.0 { [ap.cross(ac).dot(n) / n2, ab.cross(ap).dot(n) / n2] } else { [0.0; 2] }
}

/// Weights of a point close to the triangle, clamped to the triangle.
fn inside([s, t]: [f64; 2]) -> [f64; 2] {
    let (s, t) = (s.max(0.0), t.max(0.0));
    let sum = s + t;
    if sum > 1.0 { [s / sum, t / sum] } else { [s, t] }
}
