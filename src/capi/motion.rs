//! Calls that make things move, and that say when the shutter is open. The rules of `describe` hold here too.

use super::boundary::{items, on, read_sized, write_sized};
use super::describe::{find, find_surface};
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{etd_motion_key, etd_shutter};
use crate::desc::{KeyPlace, MeshStep, MotionDesc, MotionKey, ShutterDesc};
use crate::math::{DQuat, DVec3};

/// Sets when the shutter is open. Errors: `ETD_INVALID_SCENE` for one that closes before it opens, and for a curve with a number below 0
/// or without one above it. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `curve` of the shutter to `curve_count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_shutter(scene: *mut etd_scene, shutter: *const etd_shutter) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let it = read_sized(shutter, "shutter")?;
            let curve = items(it.curve, it.curve_count, "shutter.curve")?.to_vec();
            let shutter = ShutterDesc { open: it.open, close: it.close, curve };
            scene.edit(|desc| desc.set_shutter(shutter))
        })
    }
}

/// Returns when the shutter is open as described now, without the numbers of its curve. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_shutter(scene: *const etd_scene, out_shutter: *mut etd_shutter) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let ShutterDesc { open, close, curve } = &desc.motion.shutter;
            let value = etd_shutter {
                struct_size: size_of::<etd_shutter>(),
                open: *open,
                close: *close,
                curve: std::ptr::null(),
                curve_count: curve.len(),
            };
            write_sized(out_shutter, "out_shutter", value)
        })
    }
}

/// Sets the keyframes of the camera, which move it from where `etd_scene_set_camera` has it and keep lengths. 0 of them: it rests.
/// Errors: `ETD_INVALID_SCENE` for keyframes out of order, numbers out of range, and a camera that is stretched or mirrored. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `keys` to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_camera_motion(
    scene: *mut etd_scene,
    keys: *const etd_motion_key,
    count: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let motion = motion(keys, count)?;
            scene.edit(|desc| desc.set_camera_motion(motion))
        })
    }
}

/// Sets the keyframes of a surface, which move it after its transform. 0 of them: it rests. The errors are those of
/// `etd_scene_set_camera_motion`, and `ETD_INVALID_SCENE` for a surface that is flattened between two keyframes. A surface whose emission
/// a texture varies cannot move; the build refuses it with `ETD_UNSUPPORTED`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `keys` to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_surface_motion(
    scene: *mut etd_scene,
    surface: u32,
    keys: *const etd_motion_key,
    count: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find_surface(&scene.desc().surfaces, surface)?;
            let motion = motion(keys, count)?;
            scene.edit(|desc| desc.set_surface_motion(surface as usize, motion))
        })
    }
}

/// Sets the keyframes of a point light of any kind, which move it and turn the direction in which it shines. 0 of them: it rests. The
/// errors are those of `etd_scene_set_camera_motion`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type, and `keys` to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_light_motion(
    scene: *mut etd_scene,
    light: u32,
    keys: *const etd_motion_key,
    count: usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find(&scene.desc().lights, light, "point light")?;
            let motion = motion(keys, count)?;
            scene.edit(|desc| desc.set_light_motion(light as usize, motion))
        })
    }
}

/// Sets the vertices of a mesh at some moments, between which they move along straight lines. 0 of them: the mesh does not deform.
///
/// `times`: `count` times in seconds, each later than the one before. `positions`: for each of them three numbers for each vertex of the
/// mesh, one moment after another. `normals`: the same for normals, or NULL, where smooth surfaces have those of their faces. The arrays
/// are copied. Errors: `ETD_INVALID_SCENE` for times out of order and numbers out of range, `ETD_UNSUPPORTED` for a mesh that is read in
/// the host's memory (`ETD_SHARE`). `etd_scene_set_mesh` removes the moments. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to as many numbers as said above.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_mesh_steps(
    scene: *mut etd_scene,
    mesh: u32,
    times: *const f64,
    count: usize,
    positions: *const f64,
    normals: *const f32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let vertices = find(&scene.desc().meshes, mesh, "mesh")?.vertex_count();
            let all = vertices.saturating_mul(count);
            let times = items(times, count, "times")?;
            let positions = items(positions.cast::<[f64; 3]>(), all, "positions")?;
            let normals = if normals.is_null() { &[][..] } else { items(normals.cast::<[f32; 3]>(), all, "normals")? };
            let step = |(i, time): (usize, &f64)| {
                let own = i * vertices..(i + 1) * vertices;
                MeshStep {
                    time: *time,
                    positions: positions[own.clone()].iter().copied().map(DVec3::from_array).collect(),
                    normals: normals.get(own).unwrap_or_default().to_vec(),
                }
            };
            let steps = times.iter().enumerate().map(step).collect();
            scene.edit(|desc| desc.set_mesh_steps(mesh as usize, steps))
        })
    }
}

/// The motion of an array of keyframes; `None` for an empty one.
///
/// # Safety
/// `count` keyframes must be readable at `keys`, unless it is NULL.
pub(super) unsafe fn motion(keys: *const etd_motion_key, count: usize) -> Result<Option<MotionDesc>> {
    // SAFETY: the caller keeps this function's contract.
    let keys = unsafe { items(keys, count, "keys") }?;
    let key = |(i, key): (usize, &etd_motion_key)| {
        if key.reserved != 0 {
            return Err(Failure::argument(format!("keys[{i}].reserved is {}, expected 0", key.reserved)));
        }
        let place = if key.use_matrix != 0 {
            if key.matrix == [0.0; 12] {
                return Err(Failure::argument(format!("keys[{i}].matrix is all zero")));
            }
            KeyPlace::Matrix(read::transform(&key.matrix))
        } else {
            KeyPlace::Parts {
                translation: DVec3::from_array(key.translation),
                rotation: DQuat::from_array(key.rotation),
                scale: DVec3::from_array(key.scale),
            }
        };
        Ok(MotionKey { time: key.time, place })
    };
    let keys: Vec<_> = keys.iter().enumerate().map(key).collect::<Result<_>>()?;
    Ok((!keys.is_empty()).then_some(MotionDesc { keys }))
}
