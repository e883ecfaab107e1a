//! Ray queries of hosts, for picking, visibility and collision.

use super::boundary::{items, need, on_quickly};
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{ETD_NONE, etd_hit, etd_ray};
use crate::math::{DVec3, Ray, Vec3};
use crate::scene::Scene;

/// Range of the largest component of a direction. Within it, products of three lengths neither overflow nor underflow in
/// Embree.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// Converts a ray to the scene frame. The second value is the factor from the host's t to that of the converted ray.
#[inline]
fn in_scene(ray: &etd_ray, centre: DVec3) -> (Ray, f32) {
    let direction = Vec3::from_array(ray.direction);
    let origin = (DVec3::from_array(ray.origin.map(f64::from)) - centre).as_vec3a();
    let length = direction.abs().max_element();
    if LENGTHS.contains(&length) {
        return (Ray { tnear: ray.tnear, ..Ray::segment(origin, direction, ray.tfar) }, 1.0);
    }
    rescaled(ray, origin, length)
}

/// Scales a ray of a very long or very short direction to a direction of about unit length.
#[cold]
fn rescaled(ray: &etd_ray, origin: Vec3, length: f32) -> (Ray, f32) {
    let scale = f64::from(length);
    let direction = Vec3::from_array(ray.direction.map(|d| (f64::from(d) / scale) as f32));
    // Values beyond single precision become infinite, or 0.
    let (tnear, tfar) = ((f64::from(ray.tnear) * scale) as f32, (f64::from(ray.tfar) * scale) as f32);
    (Ray { tnear, ..Ray::segment(origin, direction, tfar) }, length)
}

/// The result for a ray that hits nothing.
const MISS: etd_hit = etd_hit {
    t: f32::INFINITY,
    barycentric: [0.0; 2],
    uv: [0.0; 2],
    ng: [0.0; 3],
    ns: [0.0; 3],
    surface: ETD_NONE,
    material: ETD_NONE,
    primitive: 0,
};

/// Finds the first hit of each of `count` rays, in the scene as last built.
///
/// `hits`: receives one hit for each ray, in the order of the rays. Rays that cannot be traced hit nothing: those with NaN or
/// infinity in origin or direction, a zero direction, or a negative or NaN interval. All other rays are still traced, and the
/// call then returns `ETD_INVALID_ARGUMENT` with a message about the first ray that cannot be traced. Error:
/// `ETD_INVALID_OPERATION` before the first build. The call traces all rays on the calling thread. Any number of threads may
/// call it at the same time, so a host may divide large batches over its own threads. Thread-safe.
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
            let rays = items(rays, count, "rays")?;
            if count > 0 {
                need(hits, "hits")?;
            }
            scene.with_built(|scene| {
                for_each(rays, scene, |index, ray| {
                    // A write through the pointer, because the memory need not be initialised.
                    hits.add(index).write(ray.map_or(MISS, |(ray, length)| hit(scene, &ray, length)));
                })
            })?
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
            let rays = items(rays, count, "rays")?;
            if count > 0 {
                need(occluded, "occluded")?;
            }
            scene.with_built(|scene| {
                for_each(rays, scene, |index, ray| {
                    occluded.add(index).write(u8::from(ray.is_some_and(|(ray, _)| !scene.unoccluded(&ray))));
                })
            })?
        })
    }
}

/// Calls `answer` for every ray, with `None` for rays that cannot be traced. The error is about the first of these.
#[inline]
fn for_each(rays: &[etd_ray], scene: &Scene, mut answer: impl FnMut(usize, Option<(Ray, f32)>)) -> Result {
    let centre = scene.centre();
    let mut bad = None;
    for (index, ray) in rays.iter().enumerate() {
        let (ray, length) = in_scene(ray, centre);
        let ok = ray.is_valid();
        if !ok {
            bad.get_or_insert(index);
        }
        answer(index, ok.then_some((ray, length)));
    }
    match bad {
        None => Ok(()),
        Some(index) => Err(Failure::argument(format!("ray {index} cannot be traced: {:?}", rays[index]))),
    }
}

#[inline]
fn hit(scene: &Scene, ray: &Ray, length: f32) -> etd_hit {
    let Some(hit) = scene.intersect(ray) else { return MISS };
    let it = scene.describe_hit(ray, &hit);
    etd_hit {
        // Infinity would mean that the ray hit nothing.
        t: if length == 1.0 { it.t } else { ((f64::from(it.t) / f64::from(length)) as f32).min(f32::MAX) },
        barycentric: it.barycentric,
        uv: it.uv,
        ng: it.ng.to_array(),
        ns: it.ns.to_array(),
        surface: it.surface,
        material: it.material.unwrap_or(ETD_NONE),
        primitive: it.primitive,
    }
}
