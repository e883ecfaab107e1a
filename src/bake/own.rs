//! A mesh's own texture coordinates as the layout of its light map.

use super::chart::Chart;
use super::overlap::{Cover, Flat};
use crate::Result;
use crate::control::Watch;
use crate::scene::SurfaceMesh;

/// Overlaps no deeper than this share of the square are none: exporters round, and it is a hundredth of a texel of a map of ten
/// thousand.
const TOLERANCE: f64 = 1e-6;

/// One chart of all of a mesh, laid out as its own texture coordinates say; or why they are no layout of a light map, which needs
/// a place of its own in [0, 1]^2 for every point. A unit of work is a triangle.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`].
pub(super) fn layout(number: usize, mesh: &SurfaceMesh, watch: &Watch) -> Result<std::result::Result<Chart, String>> {
    let Some(uvs) = &mesh.uvs else { return Ok(Err("the mesh has no texture coordinates".to_owned())) };
    let mut chart = Chart {
        mesh: number,
        triangles: (0..mesh.triangles.len() as u32).collect(),
        flat: Vec::with_capacity(mesh.triangles.len()),
        size: [1.0, 1.0],
        unit: 1.0,
        is_own: true,
    };
    let (mut area, mut flat_area) = (0.0, 0.0);
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        watch.check()?;
        let original = mesh.primitives[i];
        for &corner in triangle {
            let [u, v] = uvs[corner as usize];
            // Written so that NaN fails.
            if !((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
                let message = format!("({u}, {v}) of vertex {corner} is outside of [0, 1]");
                return Ok(Err(format!("the texture coordinate {message} (triangle {original})")));
            }
        }
        let flat: Flat = triangle.map(|corner| uvs[corner as usize].map(f64::from));
        let twice = doubled_area(&flat).abs();
        if twice < f64::from(f32::MIN_POSITIVE) {
            return Ok(Err(format!("triangle {original} has no area in texture coordinates")));
        }
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        area += 0.5 * (b - a).cross(c - a).length();
        flat_area += 0.5 * twice;
        chart.flat.push(flat);
    }
    let mut cover = Cover::new(2.0 * (flat_area / chart.flat.len().max(1) as f64).sqrt(), TOLERANCE);
    for (i, flat) in chart.flat.iter().enumerate() {
        watch.check()?;
        let original = mesh.primitives[i];
        if let Some(other) = cover.overlapped(flat) {
            return Ok(Err(format!("triangles {other} and {original} overlap in texture coordinates")));
        }
        cover.add(*flat, original);
        watch.spend(1);
    }
    chart.unit = (area / flat_area).sqrt();
    Ok(Ok(chart))
}

/// Twice the area, positive where the corners go counter-clockwise.
pub(super) fn doubled_area([a, b, c]: &Flat) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
