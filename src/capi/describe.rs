//! Calls that describe camera, materials and lights of a scene. Calls can describe everything that the JSON format can.
//!
//! Every call checks its arguments as the reader of the format does, and changes nothing if it fails. Materials, lights, meshes
//! and surfaces are numbered from 0 in the order in which they were added; in a scene that was read, that is the order of the
//! file. Numbers never change. A change takes effect in the next build or render.

use std::ffi::c_char;

use super::boundary::{array, need, on, optional_text, write_sized};
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{etd_camera, etd_material};
use super::{camera, read};
use crate::desc::{MaterialDesc, SurfaceDesc, Surfaces};
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// Replaces the camera.
///
/// Errors: `ETD_INVALID_SCENE` if view direction, up vector and angle or width of view do not define an image, or for a lens that
/// is none; `ETD_INVALID_ARGUMENT` for a field that the projection does not have. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_camera(scene: *mut etd_scene, camera: *const etd_camera) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let camera = camera::camera(camera)?;
            scene.edit(|desc| desc.set_camera(camera))
        })
    }
}

/// Returns the camera as described now. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_camera(scene: *const etd_scene, out_camera: *mut etd_camera) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { on(scene, |scene| write_sized(out_camera, "out_camera", camera::camera_out(&scene.desc().camera))) }
}

/// Adds a material.
///
/// `name`: name for `etd_scene_find_material`, unique among materials; NULL: none. `*out_material` receives the material's
/// number. Errors: `ETD_INVALID_SCENE` for a value out of its range, and for a mixture or a two-sided material of materials that
/// do not exist or come later. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_material(
    scene: *mut etd_scene,
    name: *const c_char,
    material: *const etd_material,
    out_material: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_material, "out_material")?;
            let name = optional_text(name, "name")?;
            let it = MaterialDesc { name: name.to_owned(), ..read::material(material)? };
            let number = scene.edit(|desc| desc.add_material_desc(it))?;
            out_material.write(number as u32);
            Ok(())
        })
    }
}

/// Replaces a material, for all surfaces that have it. The change does not require geometry to be rebuilt. The material keeps its
/// textures, and loses its spectra; a model that does not have a parameter that a texture varies is an error. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_material(
    scene: *mut etd_scene,
    material: u32,
    value: *const etd_material,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let textures = find(&scene.desc().materials, material, "material")?.textures.clone();
            let it = MaterialDesc { textures, ..read::material(value)? };
            scene.edit(|desc| desc.set_material_desc(material as usize, it))
        })
    }
}

/// Returns a material as described now, without the parameters of a principled material, which `etd_scene_get_principled`
/// returns. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_material(
    scene: *const etd_scene,
    material: u32,
    out_material: *mut etd_material,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = find(&desc.materials, material, "material")?;
            write_sized(out_material, "out_material", read::material_out(it))
        })
    }
}

/// Adds a point light, which emits equally in all directions.
///
/// `position`: three numbers, world frame. `intensity`: three numbers, radiant intensity [W sr^-1], each >= 0.
/// `*out_light` receives the light's number among point lights. Area lights are surfaces with an emission. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_point_light(
    scene: *mut etd_scene,
    position: *const f64,
    intensity: *const f32,
    out_light: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_light, "out_light")?;
            let position = vector(position, "position")?;
            let intensity = Rgb::from_array(array(intensity, "intensity")?);
            let number = scene.edit(|desc| desc.add_point_light(position, intensity))?;
            out_light.write(number as u32);
            Ok(())
        })
    }
}

/// Changes the position and intensity of a point light, which keeps its cone or web if it has one; the intensity of a measured lamp is
/// its factor. An intensity of 0 switches it off. The arguments are those of
/// `etd_scene_add_point_light`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_point_light(
    scene: *mut etd_scene,
    light: u32,
    position: *const f64,
    intensity: *const f32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find(&scene.desc().lights, light, "point light")?;
            let position = vector(position, "position")?;
            let intensity = Rgb::from_array(array(intensity, "intensity")?);
            scene.edit(|desc| desc.set_point_light(light as usize, position, intensity))
        })
    }
}

/// Returns position and intensity of a point light as described now, three numbers each; the intensity of a measured lamp is its
/// factor. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_point_light(
    scene: *const etd_scene,
    light: u32,
    out_position: *mut f64,
    out_intensity: *mut f32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_position, "out_position")?;
            need(out_intensity, "out_intensity")?;
            let desc = scene.desc();
            let it = find(&desc.lights, light, "point light")?;
            out_position.cast::<[f64; 3]>().write(it.position.to_array());
            out_intensity.cast::<[f32; 3]>().write(it.intensity.to_array());
            Ok(())
        })
    }
}

/// # Safety
/// Three numbers must be readable at `pointer`, unless it is NULL.
pub(super) unsafe fn vector(pointer: *const f64, name: &str) -> Result<DVec3> {
    // SAFETY: the caller keeps this function's contract.
    Ok(DVec3::from_array(unsafe { array(pointer, name) }?))
}

/// Returns an item by its number.
pub(super) fn find<'a, T>(items: &'a [T], number: u32, what: &str) -> Result<&'a T> {
    items.get(number as usize).ok_or_else(|| none_such(what, number, items.len()))
}

/// The surface of a number, removed or not.
pub(super) fn find_surface(surfaces: &Surfaces, number: u32) -> Result<&SurfaceDesc> {
    surfaces.get(number as usize).ok_or_else(|| none_such("surface", number, surfaces.len()))
}

fn none_such(what: &str, number: u32, count: usize) -> Failure {
    Failure::argument(format!("there is no {what} {number}, only {count}"))
}
