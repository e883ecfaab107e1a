//! Spheres that emit outwards.

use std::f64::consts::PI;

use super::{Departure, EmitterSample};
use crate::math::{DVec3, Frame, HitPoint, Vec3};
use crate::sampling::warps;
use crate::shape::Sphere;
use crate::spectrum::Rgb;

/// A sphere with the same radiance from every point in every outward direction.
#[derive(Clone, Copy, Debug)]
pub struct SphereEmitter {
    /// Its geometry.
    pub sphere: Sphere,
    /// Emitted radiance [W m^-2 sr^-1].
    pub radiance: Rgb,
}

/// The cone of directions under which a sphere is seen from outside.
struct VisibleCone {
    /// Centre minus reference point.
    axis: DVec3,
    /// 1 - cos of the half angle, without cancellation for small cones.
    one_minus_cos: f64,
}

impl SphereEmitter {
    /// The cone seen from `p`, or `None` inside the sphere, where its outer side cannot be seen.
    #[inline(always)]
    fn cone(&self, p: Vec3) -> Option<VisibleCone> {
        let axis = self.sphere.centre - p.as_dvec3();
        let distance = axis.length();
        // cos^2 = 1 - r^2 / d^2 as a product, which is exact also right above the surface.
        let cos2 = (distance - self.sphere.radius) * (distance + self.sphere.radius) / (distance * distance);
        if cos2 <= 0.0 || cos2.is_nan() {
            return None;
        }
        let sin = self.sphere.radius / distance;
        Some(VisibleCone { axis, one_minus_cos: sin * sin / (1.0 + cos2.sqrt()) })
    }

    /// Samples a direction from `p` uniformly in the cone; `None` inside the sphere.
    // Always inlined: spheres that move call it too, and those that rest are not to pay a call for that.
    #[inline(always)]
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let cone = self.cone(p)?;
        let distance = cone.axis.length();
        let frame = Frame::from_normal((cone.axis / distance).as_vec3a());
        let wi = frame.to_world(warps::uniform_cone(u, cone.one_minus_cos as f32));
        // The intersection of that direction with the sphere. A direction on the cone's rim may miss the sphere by
        // rounding, so the discriminant is clamped to the tangent point.
        // One Newton step makes the direction unit length in double precision too: seen from close to a large sphere, a
        // ten-millionth of its radius is a large distance.
        let direction = wi.as_dvec3();
        let direction = direction * (1.5 - 0.5 * direction.length_squared());
        let along = direction.dot(cone.axis);
        let off_axis2 = (cone.axis - along * direction).length_squared();
        let half_chord = (self.sphere.radius * self.sphere.radius - off_axis2).max(0.0).sqrt();
        let (point, normal) = self.sphere.project(p.as_dvec3() + (along - half_chord) * direction);
        let point = point.as_vec3a();
        let normal = normal.as_vec3a();
        let mut target =
            HitPoint::new(point, HitPoint::rounding_error(point, normal)).seen_from((along - half_chord) as f32);
        // A shadow ray must not end behind `p`.
        target.error = target.error.min((0.5 * (distance - self.sphere.radius)) as f32);
        let target = target.offset(normal);
        let pdf = (1.0 / (2.0 * PI * cone.one_minus_cos)) as f32;
        Some(EmitterSample { wi, target, radiance: self.radiance, pdf, emitter: 0, is_delta: false })
    }

    /// Samples a point uniformly by area.
    #[inline]
    pub(super) fn sample_departure(&self, u: [f32; 2]) -> Departure {
        self.departure_towards(warps::uniform_sphere(u).as_dvec3())
    }

    /// The departure from the point with this outward unit normal.
    #[inline]
    pub(super) fn departure_towards(&self, normal: DVec3) -> Departure {
        let (p, normal) = self.sphere.project(self.sphere.centre + normal * self.sphere.radius);
        Departure::of_surface(p, normal)
    }

    /// Emitted power \[W\].
    pub(super) fn power(&self) -> DVec3 {
        PI * self.sphere.area() * self.radiance.to_f64()
    }

    /// Density per solid angle at `p`, the same for all directions that meet the sphere.
    #[inline(always)]
    pub(super) fn pdf(&self, p: Vec3) -> f32 {
        self.cone(p).map_or(0.0, |cone| (1.0 / (2.0 * PI * cone.one_minus_cos)) as f32)
    }
}
