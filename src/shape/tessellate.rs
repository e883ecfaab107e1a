//! Analytic shapes as triangles whose corners lie on them, for algorithms that enumerate surfaces instead of tracing
//! rays.

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::{Analytic, Disk, Quadric, Sphere};
use crate::math::DVec3;

/// Cells along each edge of the cube around a sphere.
const CUBE_CELLS: usize = 12;

/// Corners of a disk's edge.
const DISK_CORNERS: usize = 64;

/// Cells along each edge of a quadric's box; an even number, so that an axis in the middle is sampled.
const QUADRIC_CELLS: u32 = 10;

impl Analytic {
    /// No shape is divided into more triangles than this.
    pub const MAX_TRIANGLES: usize = 64 * (QUADRIC_CELLS * QUADRIC_CELLS) as usize;

    /// Points of the shape, and triangles of them, counter-clockwise seen from outside; each has an area. A sphere or a
    /// quadric has a few hundred, which deviate from the surface by at most a few hundredths of its size; scene frame.
    pub fn tessellate(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut mesh = match self {
            Self::Sphere(sphere) => tessellate_sphere(sphere),
            Self::Disk(disk) => tessellate_disk(disk),
            Self::Quadric(quadric) => tessellate_quadric(quadric),
        };
        // The outer side is the one to which the normals point.
        for triangle in &mut mesh.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.points[corner as usize]);
            if (b - a).cross(c - a).dot(self.project((a + b + c) / 3.0).1) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        mesh.remove_degenerate();
        (mesh.points, mesh.triangles)
    }
}

#[derive(Default)]
struct TessellatedMesh {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl TessellatedMesh {
    /// Removes triangles without area.
    fn remove_degenerate(&mut self) {
        let points = &self.points;
        self.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            let (e, f) = (b - a, c - a);
            let long2 = e.length_squared().max(f.length_squared());
            e.cross(f).length() > 1e-9 * long2
        });
    }
}

/// A cube's faces, divided by equal angles and projected onto the sphere: corners of faces at the same position are
/// one.
fn tessellate_sphere(sphere: &Sphere) -> TessellatedMesh {
    let mut mesh = TessellatedMesh::default();
    let mut known: HashMap<[i32; 3], u32> = HashMap::new();
    let half = CUBE_CELLS as i32;
    for axis in 0..3 {
        for side in [-half, half] {
            let mut corner = |i: usize, j: usize| {
                let mut at = [0; 3];
                at[axis] = side;
                at[(axis + 1) % 3] = 2 * i as i32 - half;
                at[(axis + 2) % 3] = 2 * j as i32 - half;
                *known.entry(at).or_insert_with(|| {
                    // Equal angles seen from the centre.
                    let equal = at.map(|x| (f64::from(x) / f64::from(half) * (TAU / 8.0)).tan());
                    let direction = DVec3::from_array(equal).normalize();
                    mesh.points.push(sphere.centre + sphere.radius * direction);
                    mesh.points.len() as u32 - 1
                })
            };
            for i in 0..CUBE_CELLS {
                for j in 0..CUBE_CELLS {
                    let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                    mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    mesh
}

fn tessellate_disk(disk: &Disk) -> TessellatedMesh {
    let (centre, mut points) = disk.rim((0..DISK_CORNERS).map(|i| TAU * i as f64 / DISK_CORNERS as f64));
    points.push(centre);
    let n = DISK_CORNERS as u32;
    TessellatedMesh { points, triangles: (0..n).map(|i| [n, i, (i + 1) % n]).collect() }
}

fn tessellate_quadric(quadric: &Quadric) -> TessellatedMesh {
    let mut mesh = TessellatedMesh::default();
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    for triangle in quadric.triangles(QUADRIC_CELLS) {
        mesh.triangles.push(triangle.map(|p| {
            *known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                mesh.points.push(p);
                mesh.points.len() as u32 - 1
            })
        }));
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Bounds, DAffine3};

    fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|corner| points[corner as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        triangles.iter().map(of).sum()
    }

    #[test]
    fn areas_and_places() {
        use std::f64::consts::PI;
        let wide = DVec3::new(1.001, 1.001, 1.0);
        let tube = Bounds { min: DVec3::new(-1.001, -1.001, 0.0), max: wide };
        let everywhere = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        let place = DAffine3::from_translation(DVec3::new(3.0, -2.0, 1.0));
        let quadric =
            |coefficients: [f64; 10], clip| Analytic::Quadric(Box::new(Quadric::new(&coefficients, clip, place)));
        let cone = [1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0];
        for (shape, expected) in [
            (Analytic::Sphere(Sphere { centre: DVec3::X, radius: 2.0 }), 16.0 * PI),
            (Analytic::Disk(Disk::new(DVec3::Y, DVec3::Z, 0.5, &place)), 0.25 * PI),
            (quadric([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], tube), 2.0 * PI),
            (quadric(cone, tube), PI * 2.0_f64.sqrt()),
            (quadric([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], everywhere), 4.0 * PI),
        ] {
            let (points, triangles) = shape.tessellate();
            assert!(triangles.len() <= Analytic::MAX_TRIANGLES, "{}", triangles.len());
            let found = area(&points, &triangles);
            // Chords are shorter than arcs.
            assert!(found < expected * (1.0 + 1e-9) && found > 0.98 * expected, "{shape:?}: {found} of {expected}");
            for triangle in &triangles {
                let [a, b, c] = triangle.map(|corner| points[corner as usize]);
                let middle = (a + b + c) / 3.0;
                let (near, normal) = shape.project(middle);
                assert!((near - middle).length() < 0.05, "{shape:?}: {near} {middle}");
                assert!((b - a).cross(c - a).dot(normal) > 0.0, "{shape:?} turned round");
            }
            assert!(points.iter().all(|&p| (shape.project(p).0 - p).length() < 1e-9), "{shape:?}");
        }
    }
}
