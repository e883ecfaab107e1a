//! Tessellates Martin Newell's teapot to a Wavefront OBJ: y up, wound outwards, with exact normals and uv.
//!
//! `cargo run --release --example teapot -- --segments 8 scenes/meshes/teapot.obj`
//!
//! The teapot is 32 bicubic Bezier patches over 306 control points. They are all symmetric: body, lid and bottom are
//! cubic profiles turned about the axis in four quarters, handle and spout are halves mirrored at the plane y = 0. So
//! the data below are the six profiles and the two times two halves, with z up as published; the patches follow from
//! them. The pot is open where the original is: at the tip of the spout, between lid and rim, and inside the body
//! where handle and spout start.
//!
//! Source: M. E. Newell, "The Utilization of Procedure Models in Digital Image Synthesis", PhD thesis, University of
//! Utah, 1975, with the proportions of J. F. Blinn and the bottom of F. C. Crow, "The Origins of the Teapot", IEEE
//! CG&A 7 (1), 1987.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Parser;
use etendue::math::DVec3;

/// A profile: distance from the axis and height of four control points, from the top (or the middle) outwards.
type Profile = [[f64; 2]; 4];

const RIM: Profile = [[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]];
const UPPER_BODY: Profile = [[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]];
const LOWER_BODY: Profile = [[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]];
const KNOB: Profile = [[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]];
const LID: Profile = [[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]];
const BOTTOM: Profile = [[0.0, 0.0], [1.425, 0.0], [1.5, 0.075], [1.5, 0.15]];

/// Newell's control points make a quarter of a circle with arms of this length (a closest circle has 0.5523).
const ARM: f64 = 0.56;
/// The one ring that departs from it: the knob's, 0.45 for a radius of 0.8.
const KNOB_ARM: f64 = 0.5625;

/// Half of a tube: rows follow the tube, and each goes from one point of the plane y = 0 to another through y < 0, as
/// (x, -y, z).
type Half = [[[f64; 3]; 4]; 4];

const HANDLE: [Half; 2] = [
    [
        [[-1.6, 0.0, 2.025], [-1.6, 0.3, 2.025], [-1.5, 0.3, 2.25], [-1.5, 0.0, 2.25]],
        [[-2.3, 0.0, 2.025], [-2.3, 0.3, 2.025], [-2.5, 0.3, 2.25], [-2.5, 0.0, 2.25]],
        [[-2.7, 0.0, 2.025], [-2.7, 0.3, 2.025], [-3.0, 0.3, 2.25], [-3.0, 0.0, 2.25]],
        [[-2.7, 0.0, 1.8], [-2.7, 0.3, 1.8], [-3.0, 0.3, 1.8], [-3.0, 0.0, 1.8]],
    ],
    [
        [[-2.7, 0.0, 1.8], [-2.7, 0.3, 1.8], [-3.0, 0.3, 1.8], [-3.0, 0.0, 1.8]],
        [[-2.7, 0.0, 1.575], [-2.7, 0.3, 1.575], [-3.0, 0.3, 1.35], [-3.0, 0.0, 1.35]],
        [[-2.5, 0.0, 1.125], [-2.5, 0.3, 1.125], [-2.65, 0.3, 0.9375], [-2.65, 0.0, 0.9375]],
        [[-2.0, 0.0, 0.9], [-2.0, 0.3, 0.9], [-1.9, 0.3, 0.6], [-1.9, 0.0, 0.6]],
    ],
];

const SPOUT: [Half; 2] = [
    [
        [[1.7, 0.0, 1.425], [1.7, 0.66, 1.425], [1.7, 0.66, 0.6], [1.7, 0.0, 0.6]],
        [[2.6, 0.0, 1.425], [2.6, 0.66, 1.425], [3.1, 0.66, 0.825], [3.1, 0.0, 0.825]],
        [[2.3, 0.0, 2.1], [2.3, 0.25, 2.1], [2.4, 0.25, 2.025], [2.4, 0.0, 2.025]],
        [[2.7, 0.0, 2.4], [2.7, 0.25, 2.4], [3.3, 0.25, 2.4], [3.3, 0.0, 2.4]],
    ],
    [
        [[2.7, 0.0, 2.4], [2.7, 0.25, 2.4], [3.3, 0.25, 2.4], [3.3, 0.0, 2.4]],
        [[2.8, 0.0, 2.475], [2.8, 0.25, 2.475], [3.525, 0.25, 2.49375], [3.525, 0.0, 2.49375]],
        [[2.9, 0.0, 2.475], [2.9, 0.15, 2.475], [3.45, 0.15, 2.5125], [3.45, 0.0, 2.5125]],
        [[2.8, 0.0, 2.4], [2.8, 0.15, 2.4], [3.2, 0.15, 2.4], [3.2, 0.0, 2.4]],
    ],
];

/// A bicubic Bezier patch with its place in the texture. S_u x S_v points outwards.
struct Patch {
    /// Control points, `[row][column]`: u runs along a row, v over the rows.
    points: [[DVec3; 4]; 4],
    /// Texture coordinates of the corners u = v = 0 and u = v = 1.
    uv: [[f64; 2]; 2],
}

/// A point of a patch.
struct Vertex {
    position: DVec3,
    normal: DVec3,
    uv: [f64; 2],
}

/// Bernstein polynomials of degree three, and their derivatives.
fn bernstein(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t],
    )
}

impl Patch {
    /// The point at (u, v) in [0, 1]^2.
    fn evaluate(&self, u: f64, v: f64) -> Vertex {
        let ((bu, du), (bv, dv)) = (bernstein(u), bernstein(v));
        let sum = |along_u: &[f64; 4], along_v: &[f64; 4]| -> DVec3 {
            (0..4)
                .flat_map(|i| (0..4).map(move |j| (i, j)))
                .map(|(i, j)| along_v[i] * along_u[j] * self.points[i][j])
                .sum()
        };
        let (mut s_u, s_v) = (sum(&du, &bv), sum(&bu, &dv));
        // At a pole the row v = 0 is one point and S_u vanishes; just beside it S_u is v S_uv.
        if s_u.length_squared() < 1e-18 {
            s_u = sum(&du, &dv);
        }
        let ([u0, v0], [u1, v1]) = (self.uv[0], self.uv[1]);
        Vertex {
            position: sum(&bu, &bv),
            normal: s_u.cross(s_v).normalize(),
            uv: [u0 + u * (u1 - u0), v0 + v * (v1 - v0)],
        }
    }
}

/// Turns profiles, one after the other, into four quarters each.
///
/// `turn` is -1 for clockwise seen from above, which makes a profile that runs outwards over the top and down face
/// outwards; 1 is for the bottom.
fn revolve(profiles: &[Profile], turn: f64, patches: &mut Vec<Patch>) {
    for (k, profile) in profiles.iter().enumerate() {
        for quarter in 0..4 {
            // Multiples of a right angle, exactly.
            let [x_axis, y_axis] = [
                [DVec3::X, DVec3::Y],
                [DVec3::Y, DVec3::NEG_X],
                [DVec3::NEG_X, DVec3::NEG_Y],
                [DVec3::NEG_Y, DVec3::X],
            ][quarter]
                .map(|axis| DVec3::new(axis.x, turn * axis.y, 0.0));
            let points = profile.map(|[radius, height]| {
                let arm = radius * if radius == 0.8 { KNOB_ARM } else { ARM };
                [[radius, 0.0], [radius, arm], [arm, radius], [0.0, radius]]
                    .map(|[x, y]| x * x_axis + y * y_axis + height * DVec3::Z)
            });
            let (quarter, n) = (quarter as f64, profiles.len() as f64);
            let v = |k: usize| 1.0 - k as f64 / n;
            patches.push(Patch { points, uv: [[quarter / 4.0, v(k)], [(quarter + 1.0) / 4.0, v(k + 1)]] });
        }
    }
}

/// Adds both halves of a tube.
fn mirror(halves: &[Half], patches: &mut Vec<Patch>) {
    for (k, half) in halves.iter().enumerate() {
        let v = [k as f64 / halves.len() as f64, (k + 1) as f64 / halves.len() as f64];
        let points = half.map(|row| row.map(|[x, y, z]| DVec3::new(x, -y, z)));
        patches.push(Patch { points, uv: [[0.0, v[0]], [0.5, v[1]]] });
        // Mirrored, and run through backwards so that it still faces outwards.
        let points = half.map(|[a, b, c, d]| [d, c, b, a].map(|[x, y, z]| DVec3::new(x, y, z)));
        patches.push(Patch { points, uv: [[0.5, v[0]], [1.0, v[1]]] });
    }
}

/// The 32 patches, y up.
fn teapot() -> Vec<Patch> {
    let mut patches = Vec::with_capacity(32);
    revolve(&[RIM, UPPER_BODY, LOWER_BODY], -1.0, &mut patches);
    revolve(&[KNOB, LID], -1.0, &mut patches);
    revolve(&[BOTTOM], 1.0, &mut patches);
    mirror(&HANDLE, &mut patches);
    mirror(&SPOUT, &mut patches);
    for point in patches.iter_mut().flat_map(|patch| patch.points.as_flattened_mut()) {
        *point = DVec3::new(point.x, point.z, -point.y);
    }
    patches
}

/// Distinct rows of numbers in order of appearance; equal ones share an index.
#[derive(Default)]
struct Table {
    index: HashMap<Vec<i64>, usize>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Finer than any feature, coarser than rounding: the corners of neighbouring patches fall together.
    const GRID: f64 = 1e6;

    fn add(&mut self, row: &[f64]) -> usize {
        let key = row.iter().map(|x| (x * Self::GRID).round() as i64).collect();
        *self.index.entry(key).or_insert_with(|| {
            self.rows.push(row.to_vec());
            self.rows.len() - 1
        })
    }
}

/// A mesh with indices of its own for positions, uv and normals, as OBJ has them.
#[derive(Default)]
struct Mesh {
    positions: Table,
    uvs: Table,
    normals: Table,
    /// Position, uv and normal of three corners.
    triangles: Vec<[[usize; 3]; 3]>,
}

/// Cuts every patch into `segments` x `segments` quadrilaterals and these into triangles; those without area at the
/// poles are left out.
fn tessellate(patches: &[Patch], segments: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for patch in patches {
        let corner = |mesh: &mut Mesh, i: usize, j: usize| {
            let vertex = patch.evaluate(i as f64 / segments as f64, j as f64 / segments as f64);
            [
                mesh.positions.add(&vertex.position.to_array()),
                mesh.uvs.add(&vertex.uv),
                mesh.normals.add(&vertex.normal.to_array()),
            ]
        };
        for j in 0..segments {
            for i in 0..segments {
                let [a, b] = [i, i + 1].map(|i| corner(&mut mesh, i, j));
                let [d, c] = [i, i + 1].map(|i| corner(&mut mesh, i, j + 1));
                for triangle in [[a, b, c], [a, c, d]] {
                    let [p, q, r] = triangle.map(|corner| corner[0]);
                    if p != q && q != r && r != p {
                        mesh.triangles.push(triangle);
                    }
                }
            }
        }
    }
    mesh
}

/// Writes a Wavefront OBJ.
fn write_obj(mesh: &Mesh, segments: usize, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "# Martin Newell's teapot: 32 bicubic patches of {segments} x {segments} quadrilaterals")?;
    writeln!(out, "# {} triangles, y up, written by examples/teapot.rs", mesh.triangles.len())?;
    for (key, table) in [("v", &mesh.positions), ("vt", &mesh.uvs), ("vn", &mesh.normals)] {
        for row in &table.rows {
            write!(out, "{key}")?;
            for x in row {
                // Five decimals are a hundred-thousandth of the pot; adding zero removes the sign of -0.
                let text = format!("{:.5}", (x * 1e5).round() / 1e5 + 0.0);
                write!(out, " {}", text.trim_end_matches('0').trim_end_matches('.'))?;
            }
            writeln!(out)?;
        }
    }
    for triangle in &mesh.triangles {
        write!(out, "f")?;
        for [v, vt, vn] in triangle {
            write!(out, " {}/{}/{}", v + 1, vt + 1, vn + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Tessellates Newell's teapot to a Wavefront OBJ.
#[derive(Parser)]
struct Args {
    /// Segments along each side of a patch; the mesh has 64 n^2 - 8 n triangles (n = 2 gives 240).
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=512))]
    segments: u32,
    /// Where to write; standard output if left out.
    output: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args = Args::parse();
    let segments = args.segments as usize;
    let mesh = tessellate(&teapot(), segments);
    match args.output {
        Some(path) => {
            let file = File::create(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            let mut out = BufWriter::new(file);
            write_obj(&mesh, segments, &mut out)?;
            out.flush()?;
        }
        None => {
            let mut out = BufWriter::new(io::stdout().lock());
            write_obj(&mesh, segments, &mut out)?;
            out.flush()?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 306 points are shared by 32 patches, and they have the published extent.
    #[test]
    fn control_points_are_newells() {
        let patches = teapot();
        assert_eq!(patches.len(), 32);
        let mut points = Table::default();
        for point in patches.iter().flat_map(|patch| patch.points.as_flattened()) {
            points.add(&point.to_array());
        }
        // 306 are published, some of them twice: the bottom brings its own copy of the edge it shares with the body.
        assert_eq!(points.rows.len(), 290);
        let low = points.rows.iter().fold([f64::INFINITY; 3], |a, p| [0, 1, 2].map(|i| a[i].min(p[i])));
        let high = points.rows.iter().fold([f64::NEG_INFINITY; 3], |a, p| [0, 1, 2].map(|i| a[i].max(p[i])));
        assert_eq!((low, high), ([-3.0, 0.0, -2.0], [3.525, 3.15, 2.0]));
    }

    /// Every edge is shared by two triangles that run through it in opposite directions, except at the six known
    /// openings.
    #[test]
    fn is_closed_but_for_the_known_openings() {
        // One segment would flatten the halves of handle and spout onto each other.
        for segments in [2, 3, 5, 8, 13] {
            let mesh = tessellate(&teapot(), segments);
            assert_eq!(mesh.triangles.len(), 64 * segments * segments - 8 * segments);
            let mut edges: HashMap<[usize; 2], i32> = HashMap::new();
            for triangle in &mesh.triangles {
                for k in 0..3 {
                    let (a, b) = (triangle[k][0], triangle[(k + 1) % 3][0]);
                    *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
            }
            // Rim and lid are open by four patch edges each, both ends of handle and spout by two.
            let open = edges.values().filter(|count| **count != 0).count();
            assert_eq!(open, (4 + 4 + 2 * 2 + 2 * 2) * segments, "{segments} segments");
            assert!(edges.values().all(|count| count.abs() <= 1), "{segments} segments");
        }
    }

    /// Normals have length one and agree with the faces, ever better as these shrink; on the body they point away
    /// from the axis.
    #[test]
    fn faces_outwards() {
        let worst = |segments: usize| {
            let mesh = tessellate(&teapot(), segments);
            let row = |table: &Table, i: usize| DVec3::from_slice(&table.rows[i]);
            let mut worst = f64::INFINITY;
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|corner| row(&mesh.positions, corner[0]));
                let face = (b - a).cross(c - a).normalize();
                for corner in triangle {
                    let normal = row(&mesh.normals, corner[2]);
                    assert!((normal.length() - 1.0).abs() < 1e-12);
                    worst = worst.min(face.dot(normal));
                }
            }
            worst
        };
        // The lip of the spout is rolled tightly, so a face there turns far from its corners' normals.
        let [coarse, fine] = [worst(16), worst(64)];
        assert!(coarse > 0.0 && fine > 0.9, "{coarse} {fine}");
        for (i, patch) in teapot()[4..12].iter().enumerate() {
            let vertex = patch.evaluate(0.3, 0.6);
            let outwards = DVec3::new(vertex.position.x, 0.0, vertex.position.z).normalize();
            assert!(vertex.normal.dot(outwards) > 0.5, "patch {}", i + 4);
        }
    }

    /// Poles have the axis for their normal.
    #[test]
    fn poles_have_normals() {
        let patches = teapot();
        for patch in &patches[12..16] {
            assert!(patch.evaluate(0.4, 0.0).normal.distance(DVec3::Y) < 1e-12);
        }
        for patch in &patches[20..24] {
            assert!(patch.evaluate(0.4, 0.0).normal.distance(DVec3::NEG_Y) < 1e-12);
        }
    }

    /// The normal is that of the surface: perpendicular to small steps on it.
    #[test]
    fn normals_are_the_surfaces() {
        for patch in teapot() {
            for (u, v) in [(0.2, 0.3), (0.5, 0.5), (0.9, 0.7)] {
                let [a, b] = [-1e-4, 1e-4].map(|h| patch.evaluate(u + h, v).position);
                let [c, d] = [-1e-4, 1e-4].map(|h| patch.evaluate(u, v + h).position);
                let normal = patch.evaluate(u, v).normal;
                assert!((b - a).normalize().dot(normal).abs() < 1e-6);
                assert!((d - c).normalize().dot(normal).abs() < 1e-6);
            }
        }
    }
}
