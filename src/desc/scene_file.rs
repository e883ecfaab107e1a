//! Scenes from files: which format a file has, and the scene of a file that holds surfaces alone.

use std::path::Path;

use super::file::read_text;
use super::mesh_files::{self, MeshFormat};
use super::read::{no_choices, parse_watched};
use super::{BsdfDesc, LoadOptions, MaterialDesc, SceneDesc, ShapeDesc, SurfaceLook, TextureDesc, framing, gltf};
use crate::Result;
use crate::control::WorkProgress;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::spectrum::Rgb;

/// Albedo of surfaces of which a file says nothing but their shape: dark enough to stand out from the sky.
const GREY: f32 = 0.5;

/// Reads a scene file of any format, by the extension of its name. What has no extension of another format is text: a scene of
/// either dialect.
///
/// A mesh becomes a scene by itself: of the colours of its vertices, or grey, or with the materials that an OBJ file names, smooth
/// where the file has normals, seen as a whole, under an even sky where nothing else emits a radiance above 1.
///
/// # Errors
/// Those of the format; [`crate::ErrorKind::Unsupported`] for choices in a file that is no glTF file.
pub(super) fn scene_from_file(path: &Path, options: &LoadOptions, work: &WorkProgress<'static>) -> Result<SceneDesc> {
    if gltf::is_named(path) {
        return gltf::load(path, options, work);
    }
    if options.is_choice() {
        return Err(no_choices(Some(path)));
    }
    let format = MeshFormat::of_name(path);
    if format.is_some() {
        mesh_files::announce_file(path, work);
    }
    let mut scene = match format {
        None => return parse_watched(&read_text(path)?, path.parent().unwrap_or(Path::new("")), Some(path), work),
        Some(MeshFormat::Obj) => with_own_materials(path, work)?,
        Some(MeshFormat::Ply) => grey(path, DAffine3::IDENTITY, work)?,
        Some(MeshFormat::Stl) => grey(path, z_to_y(), work)?,
    };
    scene.file = Some(path.to_owned());
    framing::light(&mut scene);
    framing::frame(&mut scene);
    Ok(scene)
}

/// Turns z, which is up in the programs that write STL, to y, which is up in all other formats: +z becomes +y, and what is in
/// front (-y) comes towards +z.
fn z_to_y() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y))
}

fn grey(path: &Path, transform: DAffine3, work: &WorkProgress<'_>) -> Result<SceneDesc> {
    let mut scene = SceneDesc::default();
    let mesh = mesh_files::load(path, "", false, &mut scene.warnings, work)?;
    scene.files.push(path.to_owned());
    let smooth = mesh.has_normals();
    let material = if mesh.colors.is_empty() {
        let bsdf = BsdfDesc::Lambert { albedo: Rgb::splat(GREY) };
        MaterialDesc { name: "grey".to_owned(), bsdf, ..MaterialDesc::default() }
    } else {
        let texture = scene.add_texture(TextureDesc::of_vertex_colors("vertex colors".to_owned(), String::new()))?;
        MaterialDesc { name: "colored".to_owned(), ..MaterialDesc::textured_diffuse(texture) }
    };
    let material = Some(scene.add_material_desc(material)?);
    let mesh = scene.put_mesh(mesh);
    let look = SurfaceLook { material, transform, ..SurfaceLook::default() };
    scene.add_surface(ShapeDesc::Mesh { mesh, smooth }, DAffine3::IDENTITY, look)?;
    Ok(scene)
}

fn with_own_materials(path: &Path, work: &WorkProgress<'_>) -> Result<SceneDesc> {
    let mut scene = SceneDesc::default();
    let parts = mesh_files::load_parts(path, "", &mut scene.warnings, work)?;
    for [material, mesh] in scene.put_parts(path, parts)? {
        let smooth = scene.meshes[mesh].has_normals();
        let look = SurfaceLook { material: Some(material), ..SurfaceLook::default() };
        scene.add_surface(ShapeDesc::Mesh { mesh, smooth }, DAffine3::IDENTITY, look)?;
    }
    Ok(scene)
}
