//! Light maps in files: the map as an image, its coordinates as OBJ, and irradiance at vertices as PLY.

use std::io::Write;
use std::path::Path;

use crate::bake::{Atlas, LightMap, Vertices};
use crate::film::{Image, Layer};
use crate::replace::{self, Target};
use crate::spectrum::srgb_encode;
use crate::{Error, ErrorKind, Result};

/// The light map as an image: irradiance [W m^-2] as its colour, and the layers `error` (standard error of each
/// channel) and `coverage` (fraction of a texel that triangles cover, 0 for padding).
///
/// In files v points upwards: the image's bottom row is at v = 0, as programs that read the OBJ of [`write_atlas`]
/// expect.
pub fn light_map_image(map: &LightMap) -> Image {
    let side = map.side as usize;
    let rows = || (0..side).rev().map(|row| row * side..(row + 1) * side);
    let flipped = |values: &[[f32; 3]]| rows().flat_map(|row| values[row].iter().flatten().copied()).collect();
    Image {
        width: map.side,
        height: map.side,
        rgb: flipped(&map.irradiance),
        layers: vec![
            Layer { name: "error".to_owned(), channels: 3, data: flipped(&map.standard_error) },
            Layer {
                name: "coverage".to_owned(),
                channels: 1,
                data: rows().flat_map(|row| map.coverage[row].iter().copied()).collect(),
            },
        ],
        ..Image::default()
    }
}

/// Writes all triangles of an atlas with their positions in the light map as Wavefront OBJ, an object for each surface
/// (`surface_3`); an existing file is replaced in one step. Positions are those of the world.
///
/// # Errors
/// [`ErrorKind::Io`] for any error of the file system; then an existing file is unchanged.
pub fn write_atlas(atlas: &Atlas, path: &Path) -> Result<()> {
    replace::replace(path, "the atlas", |file| obj(atlas, file).map_err(|error| failed("the atlas", error)))
}

fn obj(atlas: &Atlas, file: &mut Target) -> std::io::Result<()> {
    writeln!(file, "# a light map's coordinates, made by etendue {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(file, "# {0} x {0} texels, {1} texels per unit", atlas.side(), atlas.texels_per_unit())?;
    for surface in atlas.surfaces() {
        writeln!(file, "o surface_{}", surface.surface)?;
        let vertices = &atlas.vertices()[surface.vertices.start as usize..surface.vertices.end as usize];
        for vertex in vertices {
            let [x, y, z] = vertex.position.to_array();
            writeln!(file, "v {x} {y} {z}")?;
        }
        for vertex in vertices {
            let [u, v] = vertex.uv;
            writeln!(file, "vt {u} {v}")?;
        }
        for vertex in vertices {
            let [x, y, z] = vertex.normal.to_array();
            writeln!(file, "vn {x} {y} {z}")?;
        }
        for triangle in &atlas.triangles()[surface.triangles.start as usize..surface.triangles.end as usize] {
            let [a, b, c] = triangle.map(|corner| corner + 1);
            writeln!(file, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?;
        }
    }
    Ok(())
}

/// Values of each vertex, in the order of [`Vertices::vertices`]; three slices of one length.
#[derive(Clone, Copy, Debug)]
pub struct VertexValues<'a> {
    /// Irradiance [W m^-2].
    pub irradiance: &'a [[f32; 3]],
    /// Standard error of the irradiance [W m^-2].
    pub standard_error: &'a [[f32; 3]],
    /// Radiosity [W m^-2].
    pub radiosity: &'a [[f32; 3]],
}

/// Writes lit vertices and their triangles as PLY, binary, little-endian; an existing file is replaced in one step.
///
/// Each vertex has `double x, y, z` (world), `float nx, ny, nz`, `uchar red, green, blue` (sRGB of radiosity / pi,
/// which is the radiance of a diffuse surface, times 2^`exposure`, clamped), `float irradiance_r, _g, _b`,
/// `float radiosity_r, _g, _b`, `float error_r, _g, _b` (standard error of the irradiance), `int surface`. Each
/// triangle has `list uchar int vertex_indices`.
///
/// # Errors
/// [`ErrorKind::Io`] for any error of the file system; then an existing file is unchanged. [`ErrorKind::Internal`] for
/// slices of another length than there are vertices.
pub fn write_vertices(vertices: &Vertices, values: VertexValues, exposure: f32, path: &Path) -> Result<()> {
    super::tone::check_exposure(exposure)?;
    let count = vertices.vertices().len();
    if [values.irradiance, values.standard_error, values.radiosity].iter().any(|values| values.len() != count) {
        return Err(Error::new(ErrorKind::Internal, format!("values are not as many as the {count} vertices")));
    }
    let what = "the vertices";
    replace::replace(path, what, |file| ply(vertices, values, exposure, file).map_err(|error| failed(what, error)))
}

fn ply(vertices: &Vertices, values: VertexValues, exposure: f32, file: &mut Target) -> std::io::Result<()> {
    writeln!(file, "ply\nformat binary_little_endian 1.0")?;
    writeln!(file, "comment irradiance and radiosity, made by etendue {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(file, "element vertex {}", vertices.vertices().len())?;
    for (kind, names) in [
        ("double", ["x", "y", "z"]),
        ("float", ["nx", "ny", "nz"]),
        ("uchar", ["red", "green", "blue"]),
        ("float", ["irradiance_r", "irradiance_g", "irradiance_b"]),
        ("float", ["radiosity_r", "radiosity_g", "radiosity_b"]),
        ("float", ["error_r", "error_g", "error_b"]),
    ] {
        for name in names {
            writeln!(file, "property {kind} {name}")?;
        }
    }
    writeln!(file, "property int surface\nelement face {}", vertices.triangles().len())?;
    writeln!(file, "property list uchar int vertex_indices\nend_header")?;
    let brightness = exposure.exp2() / std::f32::consts::PI;
    for (i, vertex) in vertices.vertices().iter().enumerate() {
        for value in vertex.position.to_array() {
            file.write_all(&value.to_le_bytes())?;
        }
        for value in vertex.normal.to_array() {
            file.write_all(&value.to_le_bytes())?;
        }
        let shown = values.radiosity[i].map(|value| (255.0 * srgb_encode(brightness * value)).round() as u8);
        file.write_all(&shown)?;
        for value in [values.irradiance[i], values.radiosity[i], values.standard_error[i]].as_flattened() {
            file.write_all(&value.to_le_bytes())?;
        }
        file.write_all(&(vertex.surface as i32).to_le_bytes())?;
    }
    for triangle in vertices.triangles() {
        file.write_all(&[3])?;
        for corner in triangle {
            file.write_all(&(*corner as i32).to_le_bytes())?;
        }
    }
    Ok(())
}

fn failed(what: &str, error: std::io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("cannot write {what}: {error}")).because(error)
}
