//! Calls that add, change and remove surfaces, and calls that find elements by name. The rules of `describe` hold here too.

use std::ffi::c_char;
use std::path::Path;
use std::ptr;
use std::sync::Arc;

use super::boundary::{array, copy_text, need, on, optional_text, read_sized, text, write_sized};
use super::describe::{find, find_surface, vector};
use super::light::contents;
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{ETD_NONE, etd_surface, etd_surface_web};
use crate::desc::{AreaWebDesc, ShapeDesc, SurfaceDesc, SurfaceLook, Surfaces, below};
use crate::math::{Bounds, DAffine3, DVec3};

/// Adds a sphere with its normals outwards. `centre`: three numbers; `radius` > 0. A transform that stretches the sphere makes
/// it an ellipsoid, which cannot emit.
///
/// The following holds for all calls that add a surface. `surface` contains material, emission and transform. `*out_surface`
/// receives the surface's number. Errors are `ETD_INVALID_SCENE` and `ETD_UNSUPPORTED`, with the JSON path that a file would
/// have. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_sphere(
    scene: *mut etd_scene,
    centre: *const f64,
    radius: f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { add(scene, surface, out_surface, || Ok(ShapeDesc::sphere(vector(centre, "centre")?, radius))) }
}

/// Adds a triangle with normal (v1 - v0) x (v2 - v0). `vertices`: three positions, nine numbers. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_triangle(
    scene: *mut etd_scene,
    vertices: *const f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { add(scene, surface, out_surface, || Ok(ShapeDesc::triangle(vectors(vertices, "vertices")?))) }
}

/// Adds a flat convex quadrilateral with the normal (v1 - v0) x (v2 - v0). `vertices`: four positions in order around the edge,
/// twelve numbers. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_quad(
    scene: *mut etd_scene,
    vertices: *const f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { add(scene, surface, out_surface, || Ok(ShapeDesc::quad(vectors(vertices, "vertices")?))) }
}

/// Adds a flat round disk. `normal`: any length. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_disk(
    scene: *mut etd_scene,
    centre: *const f64,
    normal: *const f64,
    radius: f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            Ok(ShapeDesc::disk(vector(centre, "centre")?, vector(normal, "normal")?, radius))
        })
    }
}

/// Adds a cylinder without caps, normals outwards. `base`: centre of one end; `axis`: direction to the other end, any length.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_cylinder(
    scene: *mut etd_scene,
    base: *const f64,
    axis: *const f64,
    radius: f64,
    height: f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            Ok(ShapeDesc::cylinder(vector(base, "base")?, vector(axis, "axis")?, radius, height))
        })
    }
}

/// Adds a cone without its base disk, normals outwards. `base`: centre of the base; `axis`: direction to the apex, any length.
/// A cone cannot emit. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_cone(
    scene: *mut etd_scene,
    base: *const f64,
    axis: *const f64,
    radius: f64,
    height: f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            Ok(ShapeDesc::cone(vector(base, "base")?, vector(axis, "axis")?, radius, height))
        })
    }
}

/// Adds a paraboloid of revolution, open at its wide end, normals away from its axis. `axis`: direction from the apex
/// into the paraboloid; `radius`: radius at `height`. A paraboloid cannot emit. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_paraboloid(
    scene: *mut etd_scene,
    apex: *const f64,
    axis: *const f64,
    radius: f64,
    height: f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            Ok(ShapeDesc::paraboloid(vector(apex, "apex")?, vector(axis, "axis")?, radius, height))
        })
    }
}

/// Adds an ellipsoid with its axes along x, y and z, normals outwards. `radii`: three numbers > 0. An
/// ellipsoid cannot emit. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_ellipsoid(
    scene: *mut etd_scene,
    centre: *const f64,
    radii: *const f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            Ok(ShapeDesc::ellipsoid(vector(centre, "centre")?, vector(radii, "radii")?))
        })
    }
}

/// Adds a quadric: a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0, normals along the gradient.
///
/// `coefficients`: ten numbers, a to j. `clip_min`, `clip_max`: corners of a box that clips the quadric; both may be NULL for
/// an ellipsoid, which is bounded. A quadric cannot emit. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_quadric(
    scene: *mut etd_scene,
    coefficients: *const f64,
    clip_min: *const f64,
    clip_max: *const f64,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        add(scene, surface, out_surface, || {
            let clip = match (clip_min.is_null(), clip_max.is_null()) {
                (true, true) => None,
                _ => Some(Bounds { min: vector(clip_min, "clip_min")?, max: vector(clip_max, "clip_max")? }),
            };
            Ok(ShapeDesc::quadric(array(coefficients, "coefficients")?, clip))
        })
    }
}

/// Adds a surface that uses a mesh. Any number of surfaces may use a mesh, which is stored once.
///
/// `smooth`: if not 0, normals are interpolated between vertices; a mesh without vertex normals gets them from its faces.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_mesh_surface(
    scene: *mut etd_scene,
    mesh: u32,
    smooth: u32,
    surface: *const etd_surface,
    out_surface: *mut u32,
) -> etd_status {
    let shape = ShapeDesc::Mesh { mesh: mesh as usize, smooth: smooth != 0 };
    // SAFETY: the caller keeps this function's contract.
    unsafe { add(scene, surface, out_surface, || Ok(Ok((shape, DAffine3::IDENTITY)))) }
}

/// Adds the surfaces of a Wavefront OBJ file with the materials that the file names (`usemtl`) in its material libraries
/// (`mtllib`): a mesh, a material and a surface for each material that faces have.
///
/// `path`: UTF-8, relative to the current folder. `smooth` is as in `etd_scene_add_mesh_surface`. `transform`: three rows of four
/// numbers, invertible; NULL: the identity. `*out_first` receives the number of the first surface and `*out_count` how many
/// there are; their numbers follow one another, and `etd_scene_get_surface` returns the number of their material. A material is
/// named after the file and the library's name for it, as in `car.obj:paint`; where that name is taken, it has none.
/// Errors: `ETD_IO` for a file that cannot be read, `ETD_INVALID_SCENE` for a face without a material, for a material that no
/// library has, and for a file with invalid content. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `transform` to twelve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_file_surfaces(
    scene: *mut etd_scene,
    path: *const c_char,
    smooth: u32,
    transform: *const f64,
    out_first: *mut u32,
    out_count: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_first, "out_first")?;
            need(out_count, "out_count")?;
            let path = text(path, "path")?;
            let transform = optional_transform(transform)?;
            let numbers = scene.edit(|desc| desc.add_file_surfaces(Path::new(path), smooth != 0, transform))?;
            out_first.write(numbers.start as u32);
            out_count.write(numbers.len() as u32);
            Ok(())
        })
    }
}

/// The transform of three rows of four numbers, not all of them zero; the identity for NULL.
///
/// # Safety
/// `transform` must be NULL or point to twelve numbers.
pub(super) unsafe fn optional_transform(transform: *const f64) -> Result<DAffine3> {
    if transform.is_null() {
        return Ok(DAffine3::IDENTITY);
    }
    // SAFETY: the caller keeps this function's contract.
    let rows: [f64; 12] = unsafe { array(transform, "transform") }?;
    if rows == [0.0; 12] { Err(Failure::argument("transform is all zero")) } else { Ok(read::transform(&rows)) }
}

/// Removes a surface. Its number is not used again, and the numbers of other surfaces do not change. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_remove_surface(scene: *mut etd_scene, surface: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            scene.edit(|desc| desc.remove_surface(surface as usize))
        })
    }
}

/// Sets the transform of a surface from its object frame to the world frame. `transform`: three rows of four numbers,
/// invertible. It replaces the previous transform. The position that a shape was added with (such as a cylinder's base) is one
/// in the object frame, so the transform moves the whole shape. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_transform(
    scene: *mut etd_scene,
    surface: u32,
    transform: *const f64,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            need(transform, "transform")?;
            let transform = optional_transform(transform)?;
            scene.edit(|desc| desc.set_transform(surface as usize, transform))
        })
    }
}

/// Gives a surface another material. `ETD_NONE` is allowed for a surface that emits, which then reflects nothing. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_surface_material(
    scene: *mut etd_scene,
    surface: u32,
    material: u32,
) -> etd_status {
    let number = material;
    let material = (material != ETD_NONE).then_some(material as usize);
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            find_material(scene, number)?;
            scene.edit(|desc| desc.set_surface_material(surface as usize, material))
        })
    }
}

/// Sets the radiance that a surface emits [W m^-2 sr^-1]. `radiance`: three numbers >= 0; NULL or three zeros for a surface
/// that has no emission of its own. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_emission(
    scene: *mut etd_scene,
    surface: u32,
    radiance: *const f32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            let radiance = if radiance.is_null() { [0.0; 3] } else { array(radiance, "radiance")? };
            scene.edit(|desc| desc.set_emission(surface as usize, read::emission(radiance)))
        })
    }
}

/// Sets whether a surface that emits does so on both of its sides (`both` is not 0), with the same radiance, or on that of its normal
/// only, which is the default. It stays so when the emission changes.
///
/// Errors, for both sides: `ETD_INVALID_SCENE` for a surface that emits no light, neither by itself nor by its material;
/// `ETD_UNSUPPORTED` for a sphere, whose inside is closed. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_emits_both(scene: *mut etd_scene, surface: u32, both: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            scene.edit(|desc| desc.set_emits_both(surface as usize, both != 0))
        })
    }
}

/// The surface of a number that was not removed.
fn live(surfaces: &Surfaces, number: u32) -> Result<&SurfaceDesc> {
    let it = find_surface(surfaces, number)?;
    if it.hidden { Err(Failure::argument(format!("surface {number} was removed"))) } else { Ok(it) }
}

/// Names the object that a surface is, or is a part of, in mattes (`etd_scene_trace_mattes`): all surfaces of one name are one object.
/// NULL or an empty text takes the name away. `name`: UTF-8, which is copied. No picture depends on names, so nothing is built
/// again. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, `name` to a text with a NUL at its end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_surface_name(
    scene: *mut etd_scene,
    surface: u32,
    name: *const c_char,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            let name = optional_text(name, "name")?;
            scene.rename(|desc| desc.set_surface_name(surface as usize, name))
        })
    }
}

/// Copies the name of a surface to the caller's buffer: an empty text for one that has none. `buffer`, `capacity` and `out_needed` are as
/// in `etd_scene_copy_text`. It is an error if the surface was removed. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene, `capacity` bytes writable at `buffer` unless it is NULL, and `out_needed` NULL or a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_surface_name(
    scene: *const etd_scene,
    surface: u32,
    buffer: *mut c_char,
    capacity: usize,
    out_needed: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = live(&desc.surfaces, surface)?;
            copy_text(&it.name, buffer, capacity, out_needed)
        })
    }
}

/// Lets a flat surface shine as a photometric web says, or evenly again where `web` is NULL. With a web, the emission of the surface is a
/// factor on the file's candela over 683 lm/W, 1 in each channel for the lamp as it was measured, and no radiance. A surface keeps its web
/// when its emission changes; without an emission of its own, the web has no effect. Without a file and a text, a surface that has a web
/// keeps its intensities.
///
/// Errors: `ETD_UNSUPPORTED` for a shape that is not flat; `ETD_INVALID_SCENE` for a file with light beyond 90 degrees from the normal on
/// a surface that does not emit on both sides, for contents that are of neither format or wrong, with the line, and for a direction or
/// a tilt out of range; `ETD_INVALID_ARGUMENT` for both a file and a text, or neither where there are no intensities to keep; `ETD_IO` for
/// a file that cannot be read. Meshes that are not flat, motion and textures of emission are refused when the scene is built.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, `file` to a text with a NUL at its end and `text` to `text_bytes` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_surface_web(
    scene: *mut etd_scene,
    surface: u32,
    web: *const etd_surface_web,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            if web.is_null() {
                return scene.edit(|desc| desc.set_surface_web(surface as usize, None));
            }
            let it = read_sized(web, "web")?;
            let desc = scene.desc();
            let known = find_surface(&desc.surfaces, surface)?;
            let intensities = match contents(it.file, it.text, it.text_bytes, &format!("{}.web", known.path))? {
                Some(intensities) => intensities,
                None => match &known.web {
                    Some(known) => Arc::clone(&known.web),
                    None => {
                        let message = "web.file and web.text are NULL, expected one of them";
                        return Err(Failure::argument(message));
                    }
                },
            };
            let value = AreaWebDesc { web: intensities, c0: DVec3::from_array(it.c0), tilt_deg: it.tilt_deg };
            // An edit copies a description that is held elsewhere.
            drop(desc);
            scene.edit(|desc| desc.set_surface_web(surface as usize, Some(value)))
        })
    }
}

/// Returns how the photometric web of a surface is turned, without its intensities. Errors: `ETD_INVALID_ARGUMENT` for a surface that has
/// none or that was removed. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_surface_web(
    scene: *const etd_scene,
    surface: u32,
    out_web: *mut etd_surface_web,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = find_surface(&desc.surfaces, surface)?;
            let Some(web) = it.web.as_ref().filter(|_| !it.hidden) else {
                return Err(Failure::argument(format!("surface {surface} has no photometric web")));
            };
            let value = etd_surface_web {
                struct_size: size_of::<etd_surface_web>(),
                file: ptr::null(),
                text: ptr::null(),
                text_bytes: 0,
                c0: web.c0.to_array(),
                tilt_deg: web.tilt_deg,
            };
            write_sized(out_web, "out_web", value)
        })
    }
}

/// Returns material, own emission and transform of a surface as described now. It is an error if the surface was removed.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_surface(
    scene: *const etd_scene,
    surface: u32,
    out_surface: *mut etd_surface,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = live(&desc.surfaces, surface)?;
            let value = etd_surface {
                struct_size: size_of::<etd_surface>(),
                material: it.material.map_or(ETD_NONE, |material| material as u32),
                emission: read::emission_out(it.emission),
                transform: read::transform_out(&it.transform),
                emits_both: u32::from(it.emits_both),
                reserved: 0,
            };
            write_sized(out_surface, "out_surface", value)
        })
    }
}

/// Returns the number of the material with a name. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_find_material(
    scene: *const etd_scene,
    name: *const c_char,
    out_material: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { find_number(scene, name, out_material, "material", |scene, name| scene.desc().find_material(name)) }
}

/// Returns the number of the mesh with a name. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_find_mesh(
    scene: *const etd_scene,
    name: *const c_char,
    out_mesh: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { find_number(scene, name, out_mesh, "mesh", |scene, name| scene.desc().find_mesh(name)) }
}

/// Returns the number of the surface with a JSON path, such as `surfaces[3]` or, for an area light, `lights[0]`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_find_surface(
    scene: *const etd_scene,
    json_path: *const c_char,
    out_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { find_number(scene, json_path, out_surface, "surface", etd_scene::find_surface) }
}

/// # Safety
/// The contract of the three functions above.
pub(super) unsafe fn find_number(
    scene: *const etd_scene,
    name: *const c_char,
    out: *mut u32,
    what: &str,
    find: impl FnOnce(&etd_scene, &str) -> Option<usize>,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out, "the number's place")?;
            let name = text(name, "name")?;
            let number = find(scene, name);
            let number = number.ok_or_else(|| Failure::argument(format!("there is no {what} '{name}'")))?;
            out.write(number as u32);
            Ok(())
        })
    }
}

/// Adds a surface of a shape. `shape` fails for pointers that cannot be read, and otherwise returns the shape, or what is wrong with
/// its numbers.
///
/// # Safety
/// The contract of the functions that call it.
unsafe fn add(
    scene: *mut etd_scene,
    surface: *const etd_surface,
    out_surface: *mut u32,
    shape: impl FnOnce() -> Result<crate::Result<(ShapeDesc, DAffine3)>>,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_surface, "out_surface")?;
            let it = read_sized(surface, "surface")?;
            if it.reserved != 0 {
                return Err(Failure::argument("surface.reserved is not 0"));
            }
            find_material(scene, it.material)?;
            let look = SurfaceLook {
                material: (it.material != ETD_NONE).then_some(it.material as usize),
                emission: read::emission(it.emission),
                emits_both: it.emits_both != 0,
                transform: read::transform(&it.transform),
            };
            let shape = shape()?;
            if let Ok((ShapeDesc::Mesh { mesh, .. }, _)) = &shape {
                find(&scene.desc().meshes, u32::try_from(*mesh).unwrap_or(u32::MAX), "mesh")?;
            }
            let number = scene.edit(|desc| {
                // A shape by itself knows its keys alone.
                let (shape, local) = shape.map_err(below(&format!("surfaces[{}]", desc.surfaces.len())))?;
                desc.add_surface(shape, local, look)
            })?;
            out_surface.write(number as u32);
            Ok(())
        })
    }
}

/// # Safety
/// 3 N numbers must be readable at `pointer`, unless it is NULL.
unsafe fn vectors<const N: usize>(pointer: *const f64, name: &str) -> Result<[DVec3; N]> {
    need(pointer, name)?;
    // SAFETY: the caller keeps this function's contract; arrays have the alignment of their items.
    let all: [[f64; 3]; N] = unsafe { pointer.cast::<[[f64; 3]; N]>().read() };
    Ok(all.map(DVec3::from_array))
}

/// Refuses a number that no material has. `ETD_NONE` is allowed.
fn find_material(scene: &etd_scene, number: u32) -> Result {
    if number != ETD_NONE {
        find(&scene.desc().materials, number, "material")?;
    }
    Ok(())
}
