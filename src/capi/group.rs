//! Calls that make groups of surfaces and place them. The rules of `describe` hold here too.

use std::ffi::c_char;

use super::boundary::{items, need, on, optional_text};
use super::describe::{find, find_surface};
use super::motion::motion;
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::surface::{find_number, optional_transform};
use super::types::etd_motion_key;
use crate::desc::PlacementDesc;

/// Makes a group of copies of surfaces, as they are at this moment, to be placed as often as wanted. The frame of the group is the world's.
/// The surfaces themselves stay what they are; those that were only made for the group can be removed.
///
/// `name`: UTF-8, not the name of another group; NULL or an empty text: none. `surfaces`: `count` numbers of surfaces, at least one. `*out_group`
/// receives the number of the group. No picture depends on a group that is not placed. Errors: `ETD_INVALID_SCENE` for a name that is
/// taken and for a surface that was removed; `ETD_UNSUPPORTED` for a surface that moves by keyframes. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, `surfaces` to `count` of them, and `name` to a text with a NUL at its end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_group(
    scene: *mut etd_scene,
    name: *const c_char,
    surfaces: *const u32,
    count: usize,
    out_group: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_group, "out_group")?;
            let name = optional_text(name, "name")?;
            let numbers = items(surfaces, count, "surfaces")?;
            if numbers.is_empty() {
                return Err(Failure::argument("count is 0, expected one surface at least"));
            }
            for number in numbers {
                find_surface(&scene.desc().surfaces, *number)?;
            }
            let numbers: Vec<usize> = numbers.iter().map(|number| *number as usize).collect();
            let group = scene.edit(|desc| desc.add_group(name, &numbers))?;
            out_group.write(group as u32);
            Ok(())
        })
    }
}

/// Places a group: adds a copy of each of its surfaces. Each is a surface like any other, with a number of its own, and can be changed and removed
/// by itself.
///
/// `transform`: from the group's frame to the world, three rows of four numbers, invertible; NULL: the identity. `*out_placement` receives the
/// number of the placement, and `*out_first_surface` that of the first of its surfaces, which follow one another in the order of the
/// group's; it may be NULL. Memory and time to build grow with the number of surfaces. The triangles of meshes, and the hierarchy over all
/// meshes of a group, are shared between its placements where they are many (docs/c-api.md). Errors: those of
/// `etd_scene_set_transform`; `ETD_INVALID_SCENE` for a group that was removed; `ETD_UNSUPPORTED` where scene and groups would have more than
/// 4194304 surfaces, removed ones among them. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `transform` to twelve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_place_group(
    scene: *mut etd_scene,
    group: u32,
    transform: *const f64,
    out_placement: *mut u32,
    out_first_surface: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_placement, "out_placement")?;
            if !out_first_surface.is_null() {
                need(out_first_surface, "out_first_surface")?;
            }
            find(&scene.desc().groups, group, "group")?;
            let transform = optional_transform(transform)?;
            let mut first = 0;
            let placement = scene.edit(|desc| {
                let placement = desc.place_group(group as usize, transform)?;
                first = desc.placements[placement].surfaces.start;
                Ok(placement)
            })?;
            out_placement.write(placement as u32);
            if !out_first_surface.is_null() {
                out_first_surface.write(first as u32);
            }
            Ok(())
        })
    }
}

/// Moves a placement as a whole. `transform`: from the group's frame to the world, three rows of four numbers, invertible. It replaces the
/// previous one. Surfaces of the placement that were moved by themselves come back to their places in the group. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `transform` to twelve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_placement_transform(
    scene: *mut etd_scene,
    placement: u32,
    transform: *const f64,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            live(&scene.desc().placements, placement)?;
            need(transform, "transform")?;
            let transform = optional_transform(transform)?;
            scene.edit(|desc| desc.set_placement_transform(placement as usize, transform))
        })
    }
}

/// Sets the keyframes of a placement, which move all of its surfaces after their transforms. 0 of them: it rests. The errors are those of
/// `etd_scene_set_surface_motion`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `keys` to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_placement_motion(
    scene: *mut etd_scene,
    placement: u32,
    keys: *const etd_motion_key,
    count: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            live(&scene.desc().placements, placement)?;
            let motion = motion(keys, count)?;
            scene.edit(|desc| desc.set_placement_motion(placement as usize, motion))
        })
    }
}

/// Removes a placement with its surfaces. Its number and those of its surfaces are not used again, and no other number changes. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_remove_placement(scene: *mut etd_scene, placement: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            live(&scene.desc().placements, placement)?;
            scene.edit(|desc| desc.remove_placement(placement as usize))
        })
    }
}

/// Removes a group that is placed nowhere any more, and frees what it keeps. Its number is not used again. Errors: `ETD_INVALID_SCENE` while
/// it is placed, and for a group that was removed. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_remove_group(scene: *mut etd_scene, group: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find(&scene.desc().groups, group, "group")?;
            scene.edit(|desc| desc.remove_group(group as usize))
        })
    }
}

/// Returns which group is placed, the number of the first of its surfaces here, how many there are, and the placement's transform as
/// described now: three rows of four numbers. Each of the four may be NULL. It is an error if the placement was removed. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `out_transform` to twelve.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_placement(
    scene: *const etd_scene,
    placement: u32,
    out_group: *mut u32,
    out_first_surface: *mut u32,
    out_surface_count: *mut u32,
    out_transform: *mut f64,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it = live(&desc.placements, placement)?;
            let numbers = [
                (out_group, "out_group", it.group),
                (out_first_surface, "out_first_surface", it.surfaces.start),
                (out_surface_count, "out_surface_count", it.surfaces.len()),
            ];
            for (out, name, _) in numbers.iter().filter(|(out, ..)| !out.is_null()) {
                need(*out, name)?;
            }
            if !out_transform.is_null() {
                need(out_transform, "out_transform")?;
            }
            for (out, _, value) in numbers.iter().filter(|(out, ..)| !out.is_null()) {
                out.write(*value as u32);
            }
            if !out_transform.is_null() {
                out_transform.cast::<[f64; 12]>().write(read::transform_out(&it.transform));
            }
            Ok(())
        })
    }
}

/// Returns the number of the group with a name. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_find_group(
    scene: *const etd_scene,
    name: *const c_char,
    out_group: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { find_number(scene, name, out_group, "group", |scene, name| scene.desc().find_group(name)) }
}

/// The placement of a number that was not removed.
fn live(placements: &[PlacementDesc], number: u32) -> Result<&PlacementDesc> {
    let it = find(placements, number, "placement")?;
    if it.hidden { Err(Failure::argument(format!("placement {number} was removed"))) } else { Ok(it) }
}
