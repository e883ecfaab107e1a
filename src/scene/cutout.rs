//! Surfaces that are not opaque everywhere: rays pass through them with a probability.
//!
//! A surface of opacity a is met by a ray with probability a, which is decided before the hit counts. A ray that passes
//! goes on behind the surface. The decision is a hash of the ray and the hit, so that a ray sees the same surfaces each time
//! it is traced (Pharr, Jakob, Humphreys 2023, Sec. 7.1.1). In scenes with such surfaces each path has a time of its own even
//! where nothing moves, so that two samples of a pixel decide independently where they have the same camera ray.

use super::hit::Hit;
use super::{Scene, SurfaceDetail};
use crate::math::Ray;

impl Scene {
    /// Returns the first hit along the ray that counts, beginning with this one.
    #[cold]
    #[inline(never)]
    pub(super) fn first_opaque(&self, ray: &Ray, hit: Hit) -> Option<Hit> {
        let mut hit = hit;
        loop {
            if self.meets(ray, &hit) {
                return Some(hit);
            }
            // The segment begins just behind this hit, and has the same origin, so that no distance is rounded anew. It
            // does not begin at a denormal number, which a thread may take for 0. Robust traversal compares the very
            // distance that it returned, so that no hit is found twice.
            let tnear = hit.t.next_up().max(f32::MIN_POSITIVE);
            hit = self.nearest(&Ray { tnear, ..*ray })?;
        }
    }

    /// Decides whether the ray meets the surface.
    fn meets(&self, ray: &Ray, hit: &Hit) -> bool {
        let material = self.material(self.owner(hit).material);
        if material.is_opaque() {
            return true;
        }
        let opacity = material.opacity(|_| {
            // Without a footprint nothing reads the tangents.
            let at = self.interaction(ray, hit);
            let vectors = [at.ng, at.ns, at.point.p, at.ns];
            SurfaceDetail { footprint: 0.0, ..self.detail_at(hit, vectors, at.point.time, at.point.cone, false) }
        });
        opacity >= 1.0 || opacity > 0.0 && uniform(ray, hit) < opacity
    }
}

/// A number in [0, 1) that the ray, the primitive and the distance determine: a ray may meet a shape twice.
fn uniform(ray: &Ray, hit: &Hit) -> f32 {
    let floats = ray.origin.to_array().into_iter().chain(ray.direction.to_array()).chain([ray.time]);
    let words = floats.map(f32::to_bits).chain([hit.geometry, hit.primitive, hit.t.to_bits()]);
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for word in words {
        // The finaliser of SplitMix64, which lets every bit of the input reach every bit of the result.
        state = (state ^ u64::from(word)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        state ^= state >> 31;
    }
    (state >> 40) as f32 / (1 << 24) as f32
}
