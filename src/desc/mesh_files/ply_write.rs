//! Writes meshes as binary PLY files, from which [`super::ply`] reads the same numbers.

use std::io::{self, Write};

use super::{CORNER_LIMIT, SIZE_LIMIT};
use crate::desc::MeshDesc;

/// Whether triangles name a vertex twice. Readers leave these out unless they are told to keep them.
pub(in crate::desc) fn is_degenerate(mesh: &MeshDesc) -> bool {
    (0..mesh.triangle_count()).map(|i| mesh.triangle(i)).any(|[a, b, c]| a == b || b == c || c == a)
}

/// Checks that the file of a mesh would be one that is read. The error is a sentence.
pub(in crate::desc) fn check_size(mesh: &MeshDesc) -> Result<(), String> {
    let (vertices, corners) = (mesh.vertex_count(), mesh.triangle_count().saturating_mul(3));
    for (count, what) in [(vertices, "vertices"), (corners, "corners of triangles")] {
        if count > CORNER_LIMIT {
            return Err(format!("the mesh has {count} {what}, and a file may have {CORNER_LIMIT} of them"));
        }
    }
    let of_normals = if mesh.has_normals() { 12 } else { 0 };
    let of_uvs = 8 * (u64::from(mesh.has_uvs()) + further_sets(mesh).count() as u64);
    let of_colors = if mesh.colors.is_empty() { 0 } else { 16 };
    let of_tangents = if mesh.tangents.is_empty() { 0 } else { 12 };
    let of_vertex = 24 + of_normals + of_uvs + of_colors + of_tangents;
    // A thousand bytes for the header.
    let bytes = 1000 + of_vertex * vertices as u64 + 13 * mesh.triangle_count() as u64;
    if bytes > SIZE_LIMIT {
        return Err(format!("the mesh would take {bytes} bytes, and a file may have {SIZE_LIMIT}"));
    }
    Ok(())
}

/// The further sets of texture coordinates that a mesh has, with their numbers.
fn further_sets(mesh: &MeshDesc) -> impl Iterator<Item = (usize, &[[f32; 2]])> {
    (1..).zip(&mesh.further_uvs).map(|(set, uvs)| (set, uvs.as_slice())).filter(|(_, uvs)| !uvs.is_empty())
}

/// Writes a mesh. Positions are in single precision where that is all they have.
pub(in crate::desc) fn write(mesh: &MeshDesc, file: &mut impl Write) -> io::Result<()> {
    let (vertices, triangles) = (mesh.vertex_count(), mesh.triangle_count());
    let is_single = |x: f64| f64::from(x as f32).to_bits() == x.to_bits();
    let are_single = (0..vertices).all(|i| mesh.position(i).to_array().into_iter().all(is_single));
    let kind = if are_single { "float" } else { "double" };
    writeln!(file, "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}")?;
    ["x", "y", "z"].iter().try_for_each(|name| writeln!(file, "property {kind} {name}"))?;
    if mesh.has_normals() {
        ["nx", "ny", "nz"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
    }
    if mesh.has_uvs() {
        ["u", "v"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
    }
    let further: Vec<_> = further_sets(mesh).collect();
    for (set, _) in &further {
        ["u", "v"].iter().try_for_each(|name| writeln!(file, "property float {name}{set}"))?;
    }
    if !mesh.colors.is_empty() {
        // In floating point, which is linear light.
        ["red", "green", "blue", "alpha"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
    }
    if !mesh.tangents.is_empty() {
        ["tx", "ty", "tz"].iter().try_for_each(|name| writeln!(file, "property float {name}"))?;
    }
    writeln!(file, "element face {triangles}\nproperty list uchar int vertex_indices\nend_header")?;
    for i in 0..vertices {
        for x in mesh.position(i).to_array() {
            if are_single {
                file.write_all(&(x as f32).to_le_bytes())?;
            } else {
                file.write_all(&x.to_le_bytes())?;
            }
        }
        let normal = mesh.normal(i).into_iter().flatten();
        let color = mesh.colors.get(i).copied().into_iter().flatten();
        let uvs = mesh.uv(i).into_iter().chain(further.iter().map(|(_, uvs)| uvs[i])).flatten();
        let tangent = mesh.tangents.get(i).copied().into_iter().flatten();
        for x in normal.chain(uvs).chain(color).chain(tangent) {
            file.write_all(&x.to_le_bytes())?;
        }
    }
    for i in 0..triangles {
        file.write_all(&[3])?;
        mesh.triangle(i).iter().try_for_each(|corner| file.write_all(&corner.to_le_bytes()))?;
    }
    Ok(())
}
