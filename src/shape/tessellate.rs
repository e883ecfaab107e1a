//! Analytic shapes as triangles whose corners lie on them, for whoever has to go over a surface instead of asking rays.

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::{Analytic, Disk, Quadric, Sphere};
use crate::math::{Bounds, DVec3};

/// Cells along each edge of the cube around a sphere.
const CUBE: usize = 12;

/// Corners of a disk's edge.
const RIM: usize = 64;

/// Cells along each edge of a quadric's box; even, so that an axis in the middle is met.
const CELLS: usize = 10;

impl Analytic {
    /// No shape is cut into more triangles than this.
    pub const MOST_TRIANGLES: usize = 64 * CELLS * CELLS;

    /// Points of the shape, and triangles of them, counter-clockwise seen from outside; each has an area. A few hundred for a
    /// sphere or a quadric, off the surface by less than a hundredth of its size; scene frame.
    pub fn tessellate(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut mesh = match self {
            Self::Sphere(sphere) => of_sphere(sphere),
            Self::Disk(disk) => of_disk(disk),
            Self::Quadric(quadric) => of_quadric(quadric),
        };
        // Outside is where the normals point.
        for triangle in &mut mesh.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.points[corner as usize]);
            if (b - a).cross(c - a).dot(self.project((a + b + c) / 3.0).1) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        mesh.keep_whole();
        (mesh.points, mesh.triangles)
    }
}

#[derive(Default)]
struct Mesh {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Leaves out triangles without an area.
    fn keep_whole(&mut self) {
        let points = &self.points;
        self.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            let (e, f) = (b - a, c - a);
            let long2 = e.length_squared().max(f.length_squared());
            e.cross(f).length() > 1e-9 * long2
        });
    }
}

/// A cube's faces in equal angles, moved onto the sphere: corners of faces at the same place are one.
fn of_sphere(sphere: &Sphere) -> Mesh {
    let mut mesh = Mesh::default();
    let mut known: HashMap<[i32; 3], u32> = HashMap::new();
    let half = CUBE as i32;
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
            for i in 0..CUBE {
                for j in 0..CUBE {
                    let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                    mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    mesh
}

fn of_disk(disk: &Disk) -> Mesh {
    let (centre, mut points) = disk.rim((0..RIM).map(|i| TAU * i as f64 / RIM as f64));
    points.push(centre);
    let n = RIM as u32;
    Mesh { points, triangles: (0..n).map(|i| [n, i, (i + 1) % n]).collect() }
}

/// Marching tetrahedra: each cell of a grid is cut into six, and each tetrahedron that the surface passes through gives one or
/// two triangles. The grid ends where the clip box does, so the surface ends there too.
///
/// Source: Doi and Koide 1991, "An Efficient Method of Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells".
fn of_quadric(quadric: &Quadric) -> Mesh {
    /// Corners of a cell along its diagonal from 0 to 7, one tetrahedron for each order of the axes.
    const TETRAHEDRA: [[usize; 4]; 6] =
        [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];
    let Bounds { min, max } = quadric.own_box();
    let side = CELLS + 1;
    let place = |at: usize| {
        let [x, y, z] = [at % side, at / side % side, at / side / side].map(|i| i as f64 / CELLS as f64);
        let share = DVec3::new(x, y, z);
        min * (1.0 - share) + max * share
    };
    let values: Vec<f64> = (0..side * side * side).map(|at| quadric.value(place(at))).collect();
    let mut mesh = Mesh::default();
    let mut known: HashMap<(usize, usize), u32> = HashMap::new();
    // The corner of the mesh on an edge from outside to inside.
    let mut crossing = |mesh: &mut Mesh, outer: usize, inner: usize| {
        // What is exactly on the surface is outside, and one corner for all edges that end there.
        let key = if values[outer] == 0.0 { (outer, outer) } else { (outer, inner) };
        *known.entry(key).or_insert_with(|| {
            let (mut out, mut inside) = (place(outer), place(inner));
            if values[outer] == 0.0 {
                inside = out;
            }
            for _ in 0..52 {
                let middle = 0.5 * (out + inside);
                if quadric.value(middle) >= 0.0 { out = middle } else { inside = middle }
            }
            mesh.points.push(quadric.frame().transform_point3(out));
            mesh.points.len() as u32 - 1
        })
    };
    for cell in 0..CELLS * CELLS * CELLS {
        let first = cell % CELLS + side * (cell / CELLS % CELLS + side * (cell / CELLS / CELLS));
        let corner = |i: usize| first + (i & 1) + side * (i >> 1 & 1) + side * side * (i >> 2);
        for tetrahedron in TETRAHEDRA {
            let (mut outer, mut inner) = (Vec::with_capacity(4), Vec::with_capacity(4));
            for at in tetrahedron.map(corner) {
                if values[at] >= 0.0 { outer.push(at) } else { inner.push(at) }
            }
            match (&outer[..], &inner[..]) {
                (&[a], &[b, c, d]) => {
                    let triangle = [b, c, d].map(|inner| crossing(&mut mesh, a, inner));
                    mesh.triangles.push(triangle);
                }
                (&[b, c, d], &[a]) => {
                    let triangle = [b, c, d].map(|outer| crossing(&mut mesh, outer, a));
                    mesh.triangles.push(triangle);
                }
                (&[a, b], &[c, d]) => {
                    let [p, q, r, s] = [(a, c), (a, d), (b, d), (b, c)].map(|(o, i)| crossing(&mut mesh, o, i));
                    mesh.triangles.extend([[p, q, r], [p, r, s]]);
                }
                _ => {}
            }
        }
    }
    mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DAffine3;

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
            assert!(triangles.len() <= Analytic::MOST_TRIANGLES, "{}", triangles.len());
            let found = area(&points, &triangles);
            // Chords are shorter than arcs.
            assert!(found < expected * (1.0 + 1e-9) && found > 0.985 * expected, "{shape:?}: {found} of {expected}");
            for triangle in &triangles {
                let [a, b, c] = triangle.map(|corner| points[corner as usize]);
                let middle = (a + b + c) / 3.0;
                let (near, normal) = shape.project(middle);
                assert!((near - middle).length() < 0.02, "{shape:?}: {near} {middle}");
                assert!((b - a).cross(c - a).dot(normal) > 0.0, "{shape:?} turned round");
            }
            assert!(points.iter().all(|&p| (shape.project(p).0 - p).length() < 1e-9), "{shape:?}");
        }
    }
}
