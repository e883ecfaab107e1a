//! Triangles inscribed in analytic shapes: the first elements of these shapes.

use crate::math::DVec3;
use crate::shape::Analytic;

/// Triangles whose corners lie on the shape and that together represent all of it. Their winding has no meaning.
pub(super) fn tessellate(shape: &Analytic) -> Vec<[DVec3; 3]> {
    match shape {
        Analytic::Sphere(sphere) => {
            let place = |p: DVec3| sphere.centre + sphere.radius * p;
            ball().into_iter().map(|t| t.map(place)).collect()
        }
        Analytic::Disk(disk) => disk.fan(DISK_SECTORS),
        Analytic::Quadric(quadric) => quadric.triangles(QUADRIC_CELLS),
    }
}

/// Triangles around the centre of a disk.
const DISK_SECTORS: u32 = 32;

/// Cells along each axis in which a quadric is searched for.
const QUADRIC_CELLS: u32 = 8;

/// An icosahedron on the unit sphere whose sides were halved once.
fn ball() -> Vec<[DVec3; 3]> {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)] {
        corners.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let is_side = |a: DVec3, b: DVec3| (a.distance_squared(b) - 4.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [corners[i], corners[j], corners[k]];
                if is_side(a, b) && is_side(b, c) && is_side(c, a) {
                    let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
                    let [a, b, c] = [a, b, c].map(DVec3::normalize);
                    triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]);
                }
            }
        }
    }
    triangles
}
