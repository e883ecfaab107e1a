//! Triangles that are inscribed in analytic shapes: where their sides lie on the shape, and the areas that they stand for.

use crate::math::DVec3;
use crate::shape::{Analytic, ClipFaces};

/// The point of a shape near `p`, and the outer unit normal there. A step of [`Analytic::project`] brings points onto a quadric that are
/// almost there; from the middle of a chord it goes beyond, where the shape itself would be in the way of all rays.
pub(super) fn settle(shape: &Analytic, p: DVec3) -> (DVec3, DVec3) {
    match shape {
        Analytic::Quadric(quadric) => quadric.settle(p, ClipFaces::default()),
        _ => shape.project(p),
    }
}

/// The point of a shape that replaces the middle of a chord. Between two points of an edge of the shape it is on the edge too: another
/// shape begins there, which must leave no gap.
pub(super) fn middle_on(shape: &Analytic, a: DVec3, b: DVec3) -> DVec3 {
    let middle = 0.5 * (a + b);
    match shape {
        Analytic::Sphere(sphere) => sphere.project(middle).0,
        Analytic::Quadric(quadric) => quadric.settle(middle, quadric.faces_at(a).and(quadric.faces_at(b))).0,
        Analytic::Disk(disk) if disk.is_on_edge(a) && disk.is_on_edge(b) => disk.middle_of_arc(a, b),
        Analytic::Disk(_) => middle,
    }
}

/// The bend of a side that stands for its arc: the two chords that meet there enclose as much with the side as an arc does, four thirds as
/// high as its middle. Two chords to the middle itself would be seen inside of the arc, and the sides of neighbours that are divided
/// otherwise would leave a gap.
pub(super) fn bend_of(shape: &Analytic, a: DVec3, b: DVec3) -> DVec3 {
    let chord = 0.5 * (a + b);
    chord + 4.0 / 3.0 * (middle_on(shape, a, b) - chord)
}

/// Area of the part of a shape that an inscribed triangle represents: the areas of flat triangles of two finer levels,
/// extrapolated.
pub(super) fn curved_area(shape: &Analytic, triangle: &[DVec3; 3]) -> f64 {
    let area = |t: &[DVec3; 3]| 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).length();
    let divided = |t: &[DVec3; 3]| {
        let [a, b, c] = *t;
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[a, b]| middle_on(shape, a, b));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
    };
    let once = divided(triangle);
    let coarse: f64 = once.iter().map(area).sum();
    let fine: f64 = once.iter().flat_map(divided).map(|t| area(&t)).sum();
    // The error falls by a factor of four with each level.
    fine + (fine - coarse) / 3.0
}
