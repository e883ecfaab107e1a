//! Ray queries of hosts, for picking, visibility and collision.

use std::ptr::null_mut;

use super::boundary::{array, items, need, on, on_quickly, read_sized};
use super::host_rays::{HostRay, HostRays, RayArray, trace};
use super::ray_columns::RayColumns;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{etd_hit, etd_ray, etd_ray_query};
use crate::camera::Camera;
use crate::desc::MAX_PIXELS;
use crate::render::{MAX_THREADS, Workers};
use crate::scene::Scene;

/// Rays that a thread takes at a time. A thread is worth waking for not much fewer.
const SHARE: usize = 2048;

/// Finds the first hit of each of `count` rays, in the scene as last built.
///
/// `hits`: receives one hit for each ray, in the order of the rays. Rays that cannot be traced hit nothing: those with NaN or
/// infinity in origin or direction, a zero direction, or a negative or NaN interval. All other rays are still traced, and the
/// call then returns `ETD_INVALID_ARGUMENT` with a message about the first ray that cannot be traced. Error:
/// `ETD_INVALID_OPERATION` before the first build. Many rays in a call are faster than a call for each. The call traces all rays on
/// the calling thread. Any number of threads may call it at the same time; `etd_scene_query` uses several threads by itself, and
/// computes only what is wanted. Thread-safe.
///
/// # Safety
/// `count` rays must be readable and as many hits writable; `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_intersect(
    scene: *const etd_scene,
    rays: *const etd_ray,
    count: usize,
    hits: *mut etd_hit,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on_quickly(scene, |scene| {
            items(rays, count, "rays")?;
            if count > 0 {
                need(hits, "hits")?;
            }
            scene.with_built(|scene| here(scene, &RayArray { rays, hits, occluded: null_mut() }, count))?
        })
    }
}

/// Finds for each of `count` rays whether anything lies in its segment, in the scene as last built.
///
/// `occluded`: receives one byte for each ray, 1 or 0. Rays, errors and threads are as for `etd_scene_intersect`. Thread-safe.
///
/// # Safety
/// `count` rays must be readable and as many bytes writable; `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_occluded(
    scene: *const etd_scene,
    rays: *const etd_ray,
    count: usize,
    occluded: *mut u8,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on_quickly(scene, |scene| {
            items(rays, count, "rays")?;
            if count > 0 {
                need(occluded, "occluded")?;
            }
            scene.with_built(|scene| here(scene, &RayArray { rays, hits: null_mut(), occluded }, count))?
        })
    }
}

/// Traces the rays of a query in the scene as last built, and writes what it wants of their hits.
///
/// Only what is wanted is computed: numbers of surfaces, for example, need no data of the triangle that was hit. Results are the
/// same for any number of threads, and those of `etd_scene_intersect`. Rays that cannot be traced are as there; one at a time outside
/// [0, 1] cannot be traced either. Several threads are shared with the renders of the device, with which they take turns; in a process
/// that was forked from the device's there is only the calling thread. Errors:
/// `ETD_INVALID_OPERATION` before the first build, `ETD_INVALID_ARGUMENT` for a column that is not aligned or has a wrong stride, and
/// for rays without origins or directions. Thread-safe.
///
/// # Safety
/// All columns that are not NULL must be readable or writable for `count` rays; `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_query(scene: *const etd_scene, query: *const etd_ray_query) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        // The threads of a host may give the scene back meanwhile.
        on(scene, |scene| {
            let query = read_sized(query, "query")?;
            if query.reserved != 0 {
                return Err(Failure::argument("query.reserved is not 0"));
            }
            let threads = query.threads as usize;
            if threads > MAX_THREADS {
                return Err(Failure::argument(format!("query.threads is {threads}, expected at most {MAX_THREADS}")));
            }
            let columns = RayColumns::of_query(&query)?;
            let workers = &scene.device.workers;
            let threads = if workers.are_there() { threads.min(workers.threads()) } else { 1 };
            match threads.min(columns.count.div_ceil(SHARE)) {
                0 | 1 => scene.with_built(|scene| here(scene, &columns, columns.count))?,
                threads => on_threads(scene.with_built(Scene::clone)?, columns, workers, threads),
            }
        })
    }
}

/// Makes the rays that the camera of the scene as last built sends through the pixels of a film of `width` x `height`.
///
/// With `etd_scene_query` they give images that a film does not keep, at the cost of a ray a pixel: numbers of surfaces, materials and
/// triangles, positions, texture coordinates. `offset`: place in the pixel from its top left corner, two floats in [0, 1]; NULL for the
/// middle. `rays`: receives `width` * `height` rays, row by row from the top, of unit direction and without an end. Rays of a lens go
/// through its middle, and a camera that moves is where it is as the shutter opens. A pixel that shows nothing, beside the circle of a
/// fisheye, has a ray that ends where it begins. Origins are rounded to single precision. Errors: `ETD_INVALID_OPERATION` before the
/// first build, `ETD_INVALID_ARGUMENT` for a resolution or an offset out of range, `ETD_INVALID_SCENE` where the camera makes no image
/// of this shape. Thread-safe.
///
/// # Safety
/// `offset` must be NULL or readable, `width` * `height` rays writable; `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_camera_rays(
    scene: *const etd_scene,
    width: u32,
    height: u32,
    offset: *const f32,
    rays: *mut etd_ray,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let pixels = u64::from(width) * u64::from(height);
            if pixels == 0 || pixels > MAX_PIXELS {
                let message = format!("{width} x {height} pixels, expected at least 1 and at most {MAX_PIXELS}");
                return Err(Failure::argument(message));
            }
            let [across, down] = if offset.is_null() { [0.5; 2] } else { array(offset, "offset")? };
            if !(0.0..=1.0).contains(&across) || !(0.0..=1.0).contains(&down) {
                return Err(Failure::argument(format!("offset is {across}, {down}, expected numbers in [0, 1]")));
            }
            need(rays, "rays")?;
            scene.with_built(|scene| {
                let camera = Camera::new(scene.camera(), [width, height], scene.centre())?;
                let places = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32 + across, y as f32 + down)));
                for (number, (x, y)) in places.enumerate() {
                    let ray = camera.ray(x, y);
                    let ray = etd_ray {
                        origin: (ray.origin.as_dvec3() + scene.centre()).as_vec3().to_array(),
                        tnear: ray.tnear,
                        direction: ray.direction.to_array(),
                        tfar: if camera.sees(x, y) { ray.tfar } else { ray.tnear },
                    };
                    rays.add(number).write(ray);
                }
                Ok(())
            })?
        })
    }
}

/// Traces all rays on the calling thread.
///
/// # Safety
/// The contract of [`trace`].
#[inline(always)]
unsafe fn here(scene: &Scene, rays: &impl HostRays, count: usize) -> Result {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        match trace(rays, scene, 0..count) {
            None => Ok(()),
            Some(number) => Err(untraceable(rays, number)),
        }
    }
}

/// Traces the rays on several threads, which keep a scene of their own because jobs of a pool borrow nothing.
///
/// # Safety
/// The contract of [`trace`].
unsafe fn on_threads(scene: Scene, columns: RayColumns, workers: &Workers, threads: usize) -> Result {
    let bad = workers.map(columns.count.div_ceil(SHARE), threads, move |share| {
        let rays = share * SHARE..columns.count.min((share + 1) * SHARE);
        // SAFETY: by the contract of the outer function, which does not return before all threads have ended this; no ray is
        // in two shares.
        unsafe { trace(&columns, &scene, rays) }
    })?;
    match bad.into_iter().flatten().min() {
        None => Ok(()),
        // SAFETY: by this function's contract.
        Some(number) => Err(unsafe { untraceable(&columns, number) }),
    }
}

/// # Safety
/// The ray must be readable.
#[cold]
unsafe fn untraceable(rays: &impl HostRays, number: usize) -> Failure {
    // SAFETY: the caller keeps this function's contract.
    let HostRay { origin, direction, tnear, tfar, time } = unsafe { rays.ray(number) };
    let at_time = if time == 0.0 { String::new() } else { format!(", time {time:?}") };
    Failure::argument(format!(
        "ray {number} cannot be traced: origin {origin:?}, direction {direction:?}, tnear {tnear:?}, tfar {tfar:?}{at_time}"
    ))
}
