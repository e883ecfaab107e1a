//! Traces rays that are in the memory of a host, and writes what they hit to it.

use std::ops::Range;

use super::types::{ETD_NONE, etd_hit, etd_ray};
use crate::embree::PACKET;
use crate::math::{DVec3, Ray, Vec3};
use crate::scene::{Hit, Scene};

/// Range of the largest component of a direction. Within it, products of three lengths neither overflow nor underflow in
/// Embree.
const LENGTHS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// A ray as a host gives it, world frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct HostRay {
    pub origin: [f32; 3],
    pub direction: [f32; 3],
    pub tnear: f32,
    pub tfar: f32,
    pub time: f32,
}

/// Rays in the memory of a host, and the memory for what it wants to know of them. The functions that read and write it are safe where
/// a ray of this number is readable, and what is wanted of it writable.
pub(super) trait HostRays {
    /// Whether anything is wanted that only the first hit tells.
    fn wants_first_hit(&self) -> bool;

    /// Whether anything is wanted that is computed from the arrays of a mesh.
    fn wants_data_of_triangles(&self) -> bool;

    /// Whether a ray is to be traced.
    ///
    /// # Safety
    /// See the trait.
    unsafe fn is_active(&self, number: usize) -> bool;

    /// # Safety
    /// See the trait.
    unsafe fn ray(&self, number: usize) -> HostRay;

    /// Writes what is wanted of a hit. `ray`: as it was traced; `length`: the factor from the host's t to that of the ray.
    ///
    /// # Safety
    /// See the trait.
    unsafe fn write_hit(&self, number: usize, scene: &Scene, ray: &Ray, length: f32, hit: &Hit);

    /// Writes what is wanted of a ray that hits nothing.
    ///
    /// # Safety
    /// See the trait.
    unsafe fn write_miss(&self, number: usize);

    /// Writes whether a ray hits anything, where nothing else is wanted.
    ///
    /// # Safety
    /// See the trait.
    unsafe fn write_occluded(&self, number: usize, is_occluded: bool);
}

/// Rays that can be traced, in the scene frame, and what they hit.
struct Packet<const N: usize> {
    rays: [Ray; N],
    /// The number of each ray among those of the host.
    numbers: [usize; N],
    /// The factor from the host's t to that of the ray.
    lengths: [f32; N],
    hits: [Option<Hit>; N],
}

/// Traces some of the rays and writes what is wanted of them. Rays that cannot be traced hit nothing; the number of the first of these is
/// returned.
///
/// # Safety
/// All of these rays must be readable and what is wanted of them writable, and no other thread may use what is written.
#[inline(always)]
pub(super) unsafe fn trace(host: &impl HostRays, scene: &Scene, rays: Range<usize>) -> Option<usize> {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        // The memory of a packet would cost as much as a short ray.
        if rays.len() == 1 { trace_packets::<1>(host, scene, rays) } else { trace_packets::<PACKET>(host, scene, rays) }
    }
}

/// Traces rays `N` at a time.
///
/// # Safety
/// As for [`trace`].
#[inline(always)]
unsafe fn trace_packets<const N: usize>(host: &impl HostRays, scene: &Scene, rays: Range<usize>) -> Option<usize> {
    let mut bad = None;
    let centre = scene.centre();
    let nothing = Ray::new(Vec3::ZERO, Vec3::ZERO);
    let mut packet = Packet { rays: [nothing; N], numbers: [0; N], lengths: [1.0; N], hits: [None; N] };
    let mut next = rays.start;
    while next < rays.end {
        let mut count = 0;
        while next < rays.end && count < N {
            let number = next;
            next += 1;
            // SAFETY: the caller keeps this function's contract.
            unsafe {
                if !host.is_active(number) {
                    continue;
                }
                match in_scene(&host.ray(number), centre) {
                    Some((ray, length)) => {
                        packet.rays[count] = ray;
                        packet.lengths[count] = length;
                        packet.numbers[count] = number;
                        count += 1;
                    }
                    None => {
                        bad.get_or_insert(number);
                        host.write_miss(number);
                    }
                }
            }
        }
        // SAFETY: as above.
        unsafe { trace_packet(host, scene, &mut packet, count) };
    }
    bad
}

/// # Safety
/// As for [`trace`].
#[inline(always)]
unsafe fn trace_packet<const N: usize>(host: &impl HostRays, scene: &Scene, packet: &mut Packet<N>, count: usize) {
    let rays = &packet.rays[..count];
    if host.wants_first_hit() {
        match rays {
            [ray] => packet.hits[0] = scene.intersect(ray),
            _ => scene.intersect_many(rays, &mut packet.hits[..count]),
        }
        if N > 1 && host.wants_data_of_triangles() {
            scene.prefetch(&packet.hits[..count]);
        }
        for lane in 0..count {
            let number = packet.numbers[lane];
            // SAFETY: the caller keeps this function's contract.
            unsafe {
                match &packet.hits[lane] {
                    Some(hit) => host.write_hit(number, scene, &packet.rays[lane], packet.lengths[lane], hit),
                    None => host.write_miss(number),
                }
            }
        }
    } else {
        let mut is_clear = [true; N];
        match rays {
            [ray] => is_clear[0] = scene.unoccluded(ray),
            _ => scene.unoccluded_many(rays, &mut is_clear[..count]),
        }
        for (&number, is_clear) in packet.numbers[..count].iter().zip(is_clear) {
            // SAFETY: the caller keeps this function's contract.
            unsafe { host.write_occluded(number, !is_clear) };
        }
    }
}

/// A ray in the scene frame, and the factor from the host's t to that of the ray; `None` for one that cannot be traced.
#[inline(always)]
fn in_scene(ray: &HostRay, centre: DVec3) -> Option<(Ray, f32)> {
    let &HostRay { origin, direction, tnear, tfar, time } = ray;
    let origin = (DVec3::from_array(origin.map(f64::from)) - centre).as_vec3a();
    let direction = Vec3::from_array(direction);
    let ray = Ray { tnear, time, ..Ray::segment(origin, direction, tfar) };
    let length = direction.abs().max_element();
    let (ray, length) = if LENGTHS.contains(&length) { (ray, 1.0) } else { rescaled(&ray, length) };
    (ray.is_valid() && (0.0..=1.0).contains(&time)).then_some((ray, length))
}

/// Scales a ray of a very long or very short direction to a direction of about unit length.
#[cold]
fn rescaled(ray: &Ray, length: f32) -> (Ray, f32) {
    let scale = f64::from(length);
    let direction = (ray.direction.as_dvec3() / scale).as_vec3a();
    // Values beyond single precision become infinite, or 0.
    let (tnear, tfar) = ((f64::from(ray.tnear) * scale) as f32, (f64::from(ray.tfar) * scale) as f32);
    (Ray { direction, tnear, tfar, ..*ray }, length)
}

/// The t of a hit in the host's unit, of which the ray's is this fraction. Infinity would mean that the ray hit nothing.
#[inline(always)]
pub(super) fn in_lengths(t: f32, length: f32) -> f32 {
    if length == 1.0 { t } else { ((f64::from(t) / f64::from(length)) as f32).min(f32::MAX) }
}

/// An array of rays, with an array that receives their hits or one that receives whether they hit anything; one of the two is not NULL.
pub(super) struct RayArray {
    pub rays: *const etd_ray,
    pub hits: *mut etd_hit,
    pub occluded: *mut u8,
}

impl HostRays for RayArray {
    #[inline(always)]
    fn wants_first_hit(&self) -> bool {
        !self.hits.is_null()
    }

    #[inline(always)]
    fn wants_data_of_triangles(&self) -> bool {
        true
    }

    #[inline(always)]
    unsafe fn is_active(&self, _: usize) -> bool {
        true
    }

    #[inline(always)]
    unsafe fn ray(&self, number: usize) -> HostRay {
        // SAFETY: the caller keeps the trait's contract.
        let etd_ray { origin, tnear, direction, tfar } = unsafe { self.rays.add(number).read() };
        HostRay { origin, direction, tnear, tfar, time: 0.0 }
    }

    #[inline(always)]
    unsafe fn write_hit(&self, number: usize, scene: &Scene, ray: &Ray, length: f32, hit: &Hit) {
        let it = scene.describe_hit(ray, hit);
        let hit = etd_hit {
            t: in_lengths(it.t, length),
            barycentric: it.barycentric,
            uv: it.uv,
            ng: it.ng.to_array(),
            ns: it.ns.to_array(),
            surface: it.surface,
            material: it.material.unwrap_or(ETD_NONE),
            primitive: it.primitive,
        };
        // SAFETY: the caller keeps the trait's contract. The memory need not be initialised.
        unsafe { self.hits.add(number).write(hit) };
    }

    #[inline(always)]
    unsafe fn write_miss(&self, number: usize) {
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
        // SAFETY: the caller keeps the trait's contract.
        unsafe {
            if self.hits.is_null() {
                self.write_occluded(number, false);
            } else {
                self.hits.add(number).write(MISS);
            }
        }
    }

    #[inline(always)]
    unsafe fn write_occluded(&self, number: usize, is_occluded: bool) {
        // SAFETY: the caller keeps the trait's contract.
        unsafe { self.occluded.add(number).write(u8::from(is_occluded)) };
    }
}
