//! Meshes in arrays of the host, which are copied or read in place.

use std::any::Any;
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::ptr::null_mut;
use std::sync::Arc;

use super::boundary::{UserData, need, on, optional_text, read_sized, share, text};
use super::describe::find;
use super::progress::HostProgress;
use super::read::enumeration;
use super::scene::etd_scene;
use super::sharing::shared;
use super::status::{Failure, Result, etd_status};
use super::types::{ETD_COPY, ETD_POSITION_DOUBLE3, ETD_POSITION_FLOAT3, ETD_SHARE, etd_mesh, etd_progress_fn};
use crate::buffer::{Buffer, Element};
use crate::desc::{HostMesh, LoadOptions, MeshDesc};
use crate::math::DVec3;

/// Number of bytes that Embree loads for each vertex.
const LAST_LOAD: usize = 16;

/// Adds a mesh from arrays. `*out_mesh` receives its number, for `etd_scene_add_mesh_surface`.
///
/// Errors: `ETD_INVALID_ARGUMENT` for sizes, strides or pointers that are not possible, `ETD_INVALID_SCENE` for a number that
/// is not finite or an index without a vertex, with its place. Triangles without area are allowed. Thread-safe.
///
/// # Safety
/// The arrays must be readable as `mesh` describes them. With `ETD_SHARE`, they must be readable, and must not be written to,
/// until `release` is called.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_mesh(
    scene: *mut etd_scene,
    mesh: *const etd_mesh,
    out_mesh: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_mesh, "out_mesh")?;
            let number = with_mesh(mesh, |mesh| scene.edit(|desc| desc.add_mesh(mesh)))?;
            out_mesh.write(number as u32);
            Ok(())
        })
    }
}

/// Adds a mesh from a Wavefront OBJ, PLY or STL file, told apart by the name's extension or else by the content. `name`: name for `etd_scene_find_mesh`, unique among meshes; NULL: none. `path`:
/// UTF-8, relative to the current folder. `*out_mesh` receives the mesh's number. Other calls on the scene do not wait while the file is
/// read. `etd_scene_add_mesh_file_with_progress` says how far it is. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_mesh_file(
    scene: *mut etd_scene,
    name: *const c_char,
    path: *const c_char,
    out_mesh: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { etd_scene_add_mesh_file_with_progress(scene, name, path, None, null_mut(), out_mesh) }
}

/// Adds a mesh from a file as `etd_scene_add_mesh_file` does, and says meanwhile how far the reading is.
///
/// `progress` is called on the calling thread, with the fraction of the file's bytes that are read and with 1 before the mesh is added,
/// and cancels the reading if it returns anything but 0; NULL: none. It may call the library, on this scene too. `user_data` is passed to
/// it. A file that is as good as read may go on for a while after a cancel: of an OBJ file, what is put together after its last byte.
/// Errors: those of `etd_scene_add_mesh_file`, and `ETD_CANCELLED`, after which the scene is as it was. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `progress` must be NULL or a function of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_mesh_file_with_progress(
    scene: *mut etd_scene,
    name: *const c_char,
    path: *const c_char,
    progress: etd_progress_fn,
    user_data: *mut c_void,
    out_mesh: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_mesh, "out_mesh")?;
            let (name, path) = (optional_text(name, "name")?, text(path, "path")?);
            let progress = HostProgress::new(progress, UserData(user_data));
            let options =
                LoadOptions { cancel: progress.cancel().clone(), progress: progress.build(), ..LoadOptions::default() };
            // The scene is not locked while the file is read.
            let file = scene.desc().mesh_file(name, Path::new(path))?;
            let mesh = file.read(&options)?;
            let number = scene.edit(|desc| desc.add_read_mesh(mesh))?;
            out_mesh.write(number as u32);
            Ok(())
        })
    }
}

/// Adds a mesh that another scene has, without a copy: both scenes read the same arrays, and an array of the host's memory (`ETD_SHARE`)
/// is released once, when neither scene and no build or render reads it any more.
///
/// Steps in which the mesh deforms come along. Later changes of the mesh in one scene, by `etd_scene_set_mesh`,
/// `etd_scene_set_mesh_steps` or `etd_scene_remove_mesh`, are none in the other. The scenes build hierarchies, and the vertices that they
/// place, each for itself, which their devices' memory limits count. The devices may be different ones. `source` may be `scene` itself,
/// for the same mesh with other steps; for more surfaces of a mesh, `etd_scene_add_mesh_surface` is enough. Messages about the arrays
/// name the mesh as the first scene does. `name`: name for `etd_scene_find_mesh` in `scene`, unique among its meshes; NULL: none.
/// `*out_mesh` receives the number of the mesh in `scene`. Errors: `ETD_INVALID_ARGUMENT` for a number that no mesh of `source` has,
/// `ETD_INVALID_SCENE` for a mesh that was removed and for a name that is taken. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_mesh_from(
    scene: *mut etd_scene,
    name: *const c_char,
    source: *const etd_scene,
    source_mesh: u32,
    out_mesh: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_mesh, "out_mesh")?;
            let name = optional_text(name, "name")?;
            let of_source = |failure: Failure| Failure { message: format!("source: {}", failure.message), ..failure };
            let source = share(source).map_err(of_source)?;
            // No two scenes are locked at the same time, so that two threads may share meshes in either direction. The mesh is dropped
            // once no lock is held, because the drop may call the host's release function.
            let shared = {
                let desc = source.desc();
                find(&desc.meshes, source_mesh, "mesh").map_err(of_source)?;
                desc.shared_mesh(source_mesh as usize).map_err(|error| of_source(error.into()))?
            };
            let number = scene.edit(|desc| desc.add_shared_mesh(name, &shared))?;
            out_mesh.write(number as u32);
            Ok(())
        })
    }
}

/// Replaces the arrays of a mesh, for all surfaces that use it. Arrays that were shared before are released once no build and
/// no render reads them any more. The `name` in `value` is ignored. Thread-safe.
///
/// # Safety
/// The contract of `etd_scene_add_mesh`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_mesh(scene: *mut etd_scene, mesh: u32, value: *const etd_mesh) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            // The old mesh is dropped once no lock is held, because the drop may call the host's release function.
            let _old = find(&scene.desc().meshes, mesh, "mesh")?.clone();
            with_mesh(value, |value| scene.edit(|desc| desc.set_mesh(mesh as usize, value)))
        })
    }
}

/// Removes a mesh that no surface and no group uses any more, and frees its memory. Its number is not used again. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_remove_mesh(scene: *mut etd_scene, mesh: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            // As in `etd_scene_set_mesh`.
            let _old = find(&scene.desc().meshes, mesh, "mesh")?.clone();
            scene.edit(|desc| desc.remove_mesh(mesh as usize))
        })
    }
}

/// Reads a mesh and passes it to `take`. If that succeeds, the host's release function is called later; otherwise it is never
/// called.
///
/// # Safety
/// The contract of `etd_scene_add_mesh`.
unsafe fn with_mesh<R>(pointer: *const etd_mesh, take: impl FnOnce(MeshDesc) -> Result<R>) -> Result<R> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(pointer, "mesh") }?;
    // SAFETY: the caller keeps this function's contract.
    let name = unsafe { optional_text(it.name, "mesh.name") }?;
    for (what, count) in [("vertex_count", it.vertex_count), ("triangle_count", it.triangle_count)] {
        if count == 0 || count >= u32::MAX as usize {
            return Err(Failure::argument(format!("mesh.{what} is {count}, expected 1 to 2^32 - 2")));
        }
    }
    let is_double = match enumeration("mesh.position_format", it.position_format)? {
        ETD_POSITION_FLOAT3 => false,
        ETD_POSITION_DOUBLE3 => true,
    };
    let is_shared = match enumeration("mesh.sharing", it.sharing)? {
        ETD_COPY => false,
        ETD_SHARE => true,
    };
    if is_shared && is_double {
        return Err(Failure::argument("mesh.positions of double cannot be shared, only copied"));
    }
    if is_shared {
        let stride = if it.position_stride == 0 { size_of::<[f32; 3]>() } else { it.position_stride };
        let readable = if it.position_bytes == 0 { it.vertex_count.saturating_mul(stride) } else { it.position_bytes };
        let needed = (it.vertex_count - 1).saturating_mul(stride).saturating_add(LAST_LOAD);
        if readable < needed {
            let message = format!(
                "mesh.positions: {readable} bytes can be read, expected {needed}: 16 from the last position on. Lengthen \
                 the array and say so in mesh.position_bytes, or copy"
            );
            return Err(Failure::argument(message));
        }
    }
    let release = if is_shared { it.release } else { None };
    // SAFETY: the caller keeps this function's contract; copies are finished before this function ends.
    let read = |owner: &_| unsafe { read_arrays(&it, name, is_double, is_shared, owner) };
    shared(release, UserData(it.user_data), read, take)
}

/// Reads the arrays of a mesh, in place or copied.
///
/// # Safety
/// The contract of `etd_scene_add_mesh`.
unsafe fn read_arrays(
    it: &etd_mesh,
    name: &str,
    is_double: bool,
    is_shared: bool,
    owner: &Arc<dyn Any + Send + Sync>,
) -> Result<MeshDesc> {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        let positions = (!is_double)
            .then(|| view::<[f32; 3]>(it.positions.cast(), it.vertex_count, it.position_stride, owner, "positions"))
            .transpose()?;
        let triangles = view::<[u32; 3]>(it.indices.cast(), it.triangle_count, it.index_stride, owner, "indices")?;
        let normals = optional_view::<[f32; 3]>(it.normals, it.vertex_count, it.normal_stride, owner, "normals")?;
        let uvs = optional_view::<[f32; 2]>(it.uvs, it.vertex_count, it.uv_stride, owner, "uvs")?;
        let colors = optional_view::<[f32; 4]>(it.colors, it.vertex_count, it.color_stride, owner, "colors")?;
        let colors = colors.map_or(Ok(Vec::new()), |colors| collect(&colors, |color| color))?;
        let further_uvs = further_uvs(it, owner)?;
        let tangents = optional_view::<[f32; 3]>(it.tangents, it.vertex_count, it.tangent_stride, owner, "tangents")?;
        let tangents = tangents.map_or(Ok(Vec::new()), |tangents| collect(&tangents, |tangent| tangent))?;
        let mut desc = MeshDesc { name: name.to_owned(), further_uvs, colors, tangents, ..MeshDesc::default() };
        match positions {
            Some(positions) if is_shared => desc.host = Some(HostMesh { positions, triangles, normals, uvs }),
            _ => {
                desc.positions = match positions {
                    Some(positions) => collect(&positions, |p| DVec3::from_array(p.map(f64::from)))?,
                    None => {
                        let all = view(it.positions.cast(), it.vertex_count, it.position_stride, owner, "positions")?;
                        collect(&all, DVec3::from_array)?
                    }
                };
                desc.triangles = collect(&triangles, |triangle| triangle)?;
                desc.normals = normals.map_or(Ok(Vec::new()), |normals| collect(&normals, |normal| normal))?;
                desc.uvs = uvs.map_or(Ok(Vec::new()), |uvs| collect(&uvs, |uv| uv))?;
            }
        }
        Ok(desc)
    }
}

/// The further sets of texture coordinates, copied.
///
/// # Safety
/// The contract of `etd_scene_add_mesh`.
unsafe fn further_uvs(it: &etd_mesh, owner: &Arc<dyn Any + Send + Sync>) -> Result<Vec<Vec<[f32; 2]>>> {
    let (count, most) = (it.further_uv_count as usize, MeshDesc::MOST_UV_SETS - 1);
    if count > most {
        return Err(Failure::argument(format!("mesh.further_uv_count is {count}, expected 0 to {most}")));
    }
    if it.further_uvs.is_null() {
        return Ok(Vec::new());
    }
    let set = |set: usize| {
        // SAFETY: the caller keeps this function's contract.
        let uvs = unsafe {
            let start = it.further_uvs.add(set).read();
            optional_view::<[f32; 2]>(start, it.vertex_count, it.further_uv_stride, owner, "further_uvs")
        }?;
        uvs.map_or(Ok(Vec::new()), |uvs| collect(&uvs, |uv| uv))
    };
    (0..count).map(set).collect()
}

/// A view of an array of the host.
///
/// # Safety
/// The contract of [`Buffer::foreign`].
unsafe fn view<T: Element>(
    start: *const T,
    count: usize,
    stride: usize,
    owner: &Arc<dyn Any + Send + Sync>,
    name: &str,
) -> Result<Buffer<T>> {
    let stride = if stride == 0 { size_of::<T>() } else { stride };
    // SAFETY: the caller keeps this function's contract.
    let buffer = unsafe { Buffer::foreign(start, count, stride, Arc::clone(owner)) };
    buffer.map_err(|error| Failure::argument(format!("mesh.{name}: {}", error.message())))
}

/// # Safety
/// The contract of [`view`].
unsafe fn optional_view<T: Element>(
    start: *const f32,
    count: usize,
    stride: usize,
    owner: &Arc<dyn Any + Send + Sync>,
    name: &str,
) -> Result<Option<Buffer<T>>> {
    // SAFETY: the caller keeps this function's contract.
    (!start.is_null()).then(|| unsafe { view(start.cast(), count, stride, owner, name) }).transpose()
}

/// Copies an array, with an error where there is no memory.
fn collect<T: Element, U>(buffer: &Buffer<T>, convert: impl Fn(T) -> U) -> Result<Vec<U>> {
    let mut items = Vec::new();
    items.try_reserve_exact(buffer.len()).map_err(|_| {
        let message = format!("no room for {} items of a mesh", buffer.len());
        Failure::new(super::status::ETD_OUT_OF_MEMORY, message)
    })?;
    items.extend(buffer.iter().map(convert));
    Ok(items)
}
