//! Hits in the terms of the scene's description: surfaces, materials and primitives have the numbers that the host gave
//! them.

use super::Scene;
use super::geometry::Geometry;
use super::hit::Hit;
use crate::math::{Ray, Vec3};

/// A hit of a ray in terms of the scene's description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitDescription {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Weights of the second and third vertex of the triangle, with the vertices in the order in which they were given;
    /// 0 for spheres, disks and quadrics. For a quad, the weights are those of the half that was hit, with vertices 1,
    /// 2, 3 or 1, 3, 4.
    pub barycentric: [f32; 2],
    /// Texture coordinates. Where a mesh has its own, they are interpolated. Other triangles have the same values as
    /// `barycentric`. Quads have (0, 0), (1, 0), (1, 1) and (0, 1) at their vertices, and the coordinates are linear on
    /// each half. Other shapes have 0.
    pub uv: [f32; 2],
    /// Geometric unit normal on the outer side. It is the same in the scene frame and in the world frame.
    pub ng: Vec3,
    /// Shading unit normal on the outer side.
    pub ns: Vec3,
    /// Index in [`crate::desc::SceneDesc::surfaces`].
    pub surface: u32,
    /// Index in [`crate::desc::SceneDesc::materials`]; `None` on a surface without a material.
    pub material: Option<u32>,
    /// The number of the triangle in its mesh as the mesh was given; 0 or 1 for the half of a quad; 0 for all other
    /// shapes.
    pub primitive: u32,
}

impl Scene {
    /// Describes the surface point that `ray` hit. The hit must come from the same ray and scene.
    pub fn describe_hit(&self, ray: &Ray, hit: &Hit) -> HitDescription {
        let interaction = self.interaction(ray, hit);
        let (surface, material) = self.hit_owner(hit);
        let (barycentric, primitive) = self.hit_part(hit);
        HitDescription {
            t: hit.t,
            barycentric,
            uv: self.uv(hit),
            ng: interaction.ng,
            ns: interaction.ns,
            surface,
            material,
            primitive,
        }
    }

    /// The surface that was hit and its material, as [`HitDescription`] has them.
    #[inline]
    pub fn hit_owner(&self, hit: &Hit) -> (u32, Option<u32>) {
        let owner = self.owner(hit);
        // The last of the scene's materials is none of the description.
        (owner.surface, (owner.material as usize + 1 < self.materials.len()).then_some(owner.material))
    }

    /// The weights of the triangle's vertices and the number of the triangle, as [`HitDescription`] has them.
    #[inline]
    pub fn hit_part(&self, hit: &Hit) -> ([f32; 2], u32) {
        match self.geometries.get(hit.geometry as usize) {
            Some(Geometry::Loose { parts, .. }) => {
                let part = parts[hit.primitive as usize];
                (in_order(part.is_mirrored, [hit.u, hit.v]), part.half)
            }
            Some(Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. }) => {
                let original = triangles.original.as_ref();
                let original = original.map_or(hit.primitive, |original| original[hit.primitive as usize]);
                (in_order(triangles.swapped, [hit.u, hit.v]), original)
            }
            Some(Geometry::Analytic { .. }) | None => ([0.0; 2], 0),
        }
    }

    /// Returns whether a ray can be traced at all: its numbers are finite (`tfar` may be infinite), its direction is
    /// not zero, and its `tnear` is not negative. A ray that cannot be traced hits nothing, like a ray that misses.
    pub fn is_traceable(ray: &Ray) -> bool {
        ray.is_valid()
    }
}

/// Converts the kernel's barycentric coordinates to the order in which the vertices were given.
pub(super) fn in_order(swapped: bool, [u, v]: [f32; 2]) -> [f32; 2] {
    if swapped { [v, u] } else { [u, v] }
}
