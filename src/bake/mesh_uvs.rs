//! A mesh's own texture coordinates as the layout of its light map.

use super::chart::{Chart, bounds};
use super::overlap::{OverlapGrid, PlanarTriangle};
use crate::Result;
use crate::control::WorkProgress;
use crate::scene::SurfaceMesh;

/// An overlap no deeper than this fraction of the layout's size does not count, and neither does such a distance
/// outside of the square: exporters round, and the distance is a hundredth of a texel in a map of ten thousand.
const TOLERANCE: f64 = 1e-6;

/// Least area of the square that a layout must cover: less than a hundred texels of the largest map.
const MIN_COVERED_AREA: f64 = 1e-6;

/// One chart of a whole mesh, laid out by the mesh's own texture coordinates. A message tells why the coordinates are
/// unsuitable for a light map, which needs a distinct position in [0, 1]^2 for every point. A unit of work is a
/// triangle.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`].
pub(super) fn layout(
    number: usize,
    mesh: &SurfaceMesh,
    progress: &WorkProgress,
) -> Result<std::result::Result<Chart, String>> {
    let Some(uvs) = &mesh.uvs else { return Ok(Err("the mesh has no texture coordinates".to_owned())) };
    let mut chart = Chart {
        mesh: number,
        triangles: (0..mesh.triangles.len() as u32).collect(),
        flat: Vec::with_capacity(mesh.triangles.len()),
        size: [1.0, 1.0],
        unit: 1.0,
        uses_mesh_uvs: true,
    };
    let (mut area, mut flat_area, mut flat_length) = (0.0, 0.0, 0.0);
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        progress.check()?;
        let original = mesh.primitives[i];
        for &corner in triangle {
            let [u, v] = uvs[corner as usize];
            // Written so that NaN fails.
            let near = -TOLERANCE..=1.0 + TOLERANCE;
            if !(near.contains(&f64::from(u)) && near.contains(&f64::from(v))) {
                let message = format!("({u}, {v}) of vertex {corner} is outside of [0, 1]");
                return Ok(Err(format!("the texture coordinate {message} (triangle {original})")));
            }
        }
        let flat: PlanarTriangle = triangle.map(|corner| uvs[corner as usize].map(|x| f64::from(x).clamp(0.0, 1.0)));
        let twice = doubled_area(&flat).abs();
        if twice < f64::from(f32::MIN_POSITIVE) {
            return Ok(Err(format!("triangle {original} has no area in texture coordinates")));
        }
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        area += 0.5 * (b - a).cross(c - a).length();
        flat_area += 0.5 * twice;
        flat_length += (0.5 * twice).sqrt();
        chart.flat.push(flat);
    }
    let [min, max] = bounds(chart.flat.iter().flatten().copied());
    let size = (max[0] - min[0]).max(max[1] - min[1]);
    let mut cover = OverlapGrid::new(2.0 * flat_length / chart.flat.len().max(1) as f64, TOLERANCE * size);
    for (i, flat) in chart.flat.iter().enumerate() {
        progress.check()?;
        let original = mesh.primitives[i];
        if let Some(other) = cover.find_overlap(flat) {
            return Ok(Err(format!("triangles {other} and {original} overlap in texture coordinates")));
        }
        cover.add(*flat, original);
        progress.spend(1);
    }
    if flat_area < MIN_COVERED_AREA {
        return Ok(Err(format!("its triangles cover no more than {flat_area:.0e} of the square")));
    }
    chart.unit = (area / flat_area).sqrt();
    Ok(Ok(chart))
}

/// Twice the area, positive where the corners run counter-clockwise.
pub(super) fn doubled_area([a, b, c]: &PlanarTriangle) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
