//! Analytic shapes in double precision, with exact hits where a triangle mesh would only approximate.
//!
//! A kernel in single precision loses a sphere whose distance is large against its radius, or the other way round:
//! b^2 - ac cancels. Everything here is therefore computed in f64 from the ray's f32 numbers, and hit points are projected
//! onto the surface.

mod disk;
mod quadric;
mod ray;
mod roots;
mod sphere;
mod tessellate;
mod triangle;

pub use disk::Disk;
pub(crate) use quadric::ClipFaces;
pub use quadric::Quadric;
pub use ray::DRay;
pub use sphere::Sphere;
pub use triangle::{Triangle, centroids};

use crate::math::{Bounds, DVec3, Ray};

/// Beyond this distance, in sizes of a shape, a t in single precision is too coarse for its normals: half a unit in its
/// last place moves the point by 2^-20 of the size.
const SINGLE_PRECISION_RANGE: f64 = 16.0;

/// An analytic shape of a scene, in the scene frame.
#[derive(Clone, Debug)]
pub enum Analytic {
    /// A sphere.
    Sphere(Sphere),
    /// A clipped quadric; boxed, so that scenes of spheres stay compact.
    Quadric(Box<Quadric>),
    /// A flat disk.
    Disk(Disk),
}

impl Analytic {
    /// The nearest t in (tnear, tfar) at which the ray intersects the surface.
    #[inline]
    pub fn intersect(&self, ray: &DRay) -> Option<f64> {
        match self {
            Self::Sphere(sphere) => sphere.intersect(ray),
            Self::Quadric(quadric) => quadric.intersect(ray),
            Self::Disk(disk) => disk.intersect(ray),
        }
    }

    /// The point at which the ray intersects the surface, from the rounded t of [`Analytic::intersect`]. A shape that
    /// is small against its distance is intersected once more, to get all digits of t.
    #[inline]
    pub fn point(&self, ray: &Ray, t: f32) -> DVec3 {
        let way = f64::from(t) * ray.direction.as_dvec3();
        let size = match self {
            Self::Sphere(sphere) => sphere.radius,
            Self::Quadric(quadric) => quadric.size(),
            // The point may be off along the plane, but not away from it, and the normal is the same everywhere.
            Self::Disk(_) => f64::INFINITY,
        };
        if way.length_squared() > SINGLE_PRECISION_RANGE * SINGLE_PRECISION_RANGE * size * size {
            return self.exact_point(ray, t);
        }
        ray.origin.as_dvec3() + way
    }

    /// As [`Analytic::point`], not inlined: most hits do not need it.
    #[cold]
    #[inline(never)]
    fn exact_point(&self, ray: &Ray, t: f32) -> DVec3 {
        let near = DRay { tnear: t.next_down().into(), tfar: t.next_up().into(), ..DRay::from(ray) };
        near.origin + self.intersect(&near).unwrap_or(t.into()) * near.direction
    }

    /// The point of the surface nearest to `p`, which is on the surface except for rounding, and the outward unit
    /// normal there.
    #[inline]
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        match self {
            Self::Sphere(sphere) => sphere.project(p),
            Self::Quadric(quadric) => quadric.project(p),
            Self::Disk(disk) => disk.project(p),
        }
    }

    /// The mean curvature at a point of the surface: positive where it bends away from the outward normal.
    pub fn mean_curvature(&self, p: DVec3) -> f64 {
        match self {
            Self::Sphere(sphere) => 1.0 / sphere.radius,
            Self::Quadric(quadric) => quadric.mean_curvature(p),
            Self::Disk(_) => 0.0,
        }
    }

    /// A bounding box.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Quadric(quadric) => quadric.bounds(),
            Self::Disk(disk) => disk.bounds(),
        }
    }
}
