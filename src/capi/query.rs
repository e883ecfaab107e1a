//! Rays that hosts trace themselves: picking, visibility, collision.

use super::boundary::{items, need, on_quickly};
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{ETD_NONE, etd_hit, etd_ray};
use crate::math::{DVec3, Ray, Vec3};
use crate::scene::Scene;

/// Lengths of a direction, by its largest component, that the kernel's products of three lengths bear.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// A ray in the frame of the scene, and by how much its t counts more than the host's.
#[inline]
fn in_scene(ray: &etd_ray, centre: DVec3) -> (Ray, f32) {
    let direction = Vec3::from_array(ray.direction);
    let origin = (DVec3::from_array(ray.origin.map(f64::from)) - centre).as_vec3a();
    let length = direction.abs().max_element();
    if LENGTHS.contains(&length) {
        return (Ray { origin, direction, tnear: ray.tnear, tfar: ray.tfar }, 1.0);
    }
    rescaled(ray, origin, length)
}

/// A ray of a very long or very short direction, made about one long.
#[cold]
fn rescaled(ray: &etd_ray, origin: Vec3, length: f32) -> (Ray, f32) {
    let scale = f64::from(length);
    let direction = Vec3::from_array(ray.direction.map(|d| (f64::from(d) / scale) as f32));
    // What single precision cannot hold is as good as infinite, or as good as nothing.
    let (tnear, tfar) = ((f64::from(ray.tnear) * scale) as f32, (f64::from(ray.tfar) * scale) as f32);
    (Ray { origin, direction, tnear, tfar }, length)
}

/// What no ray has met.
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

/// Finds what each of `count` rays meets first, in the scene as it was last built.
///
/// `hits`: one for each ray, in order. A ray that cannot be traced (NaN, infinity in origin or direction, no direction, a
/// negative or NaN interval) meets nothing; all others are answered, and then `ETD_INVALID_ARGUMENT` names the first such
/// ray. `ETD_INVALID_OPERATION` before the first build. Everything is done on the calling thread, and any number of
/// threads may ask at once: share out large batches over your own. Thread-safe.
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
    // SAFETY: passed on.
    unsafe {
        on_quickly(scene, |scene| {
            let rays = items(rays, count, "rays")?;
            if count > 0 {
                need(hits, "hits")?;
            }
            scene.with_built(|scene| {
                for_each(rays, scene, |index, ray| {
                    // Written through the pointer: what is there before need not be a value.
                    hits.add(index).write(ray.map_or(MISS, |(ray, length)| hit(scene, &ray, length)));
                })
            })?
        })
    }
}

/// Finds for each of `count` rays whether anything is in its segment, in the scene as it was last built.
///
/// `occluded`: one byte for each ray, 1 or 0. All else as for `etd_scene_intersect`. Thread-safe.
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
    // SAFETY: passed on.
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

/// Answers every ray, those that cannot be traced with `None`; an error names the first of these.
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
        // Infinity says that nothing was met.
        t: if length == 1.0 { it.t } else { ((f64::from(it.t) / f64::from(length)) as f32).min(f32::MAX) },
        barycentric: it.barycentric,
        uv: it.uv,
        ng: it.ng.to_array(),
        ns: it.ns.to_array(),
        surface: it.surface,
        material: it.material,
        primitive: it.primitive,
    }
}
