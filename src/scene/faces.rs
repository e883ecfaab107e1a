//! The faces of a scene, numbered, for algorithms that store data for each face and look it up where a ray hits the
//! face.
//!
//! A face is a single triangle without adjacency, or a whole analytic shape. The module `facets` has surfaces as meshes
//! instead.

use super::geometry::Geometry;
use super::hit::{Hit, IN_LIST};
use super::interaction::{NO_EMITTER, Owner};
use super::{Facet, Scene};
use crate::math::{DVec3, Vec3};
use crate::shape::Analytic;

/// A triangle or an analytic shape of a built scene, in the scene frame.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    pub body: Body,
    /// The triangle, or with corners of its own a part of the shape.
    pub facet: Facet,
    pub surface: u32,
    pub material: u32,
    /// Number of the emitter that it is, whose light leaves the outer side.
    pub emitter: Option<u32>,
}

/// The geometry of a face.
#[derive(Clone, Debug)]
pub(crate) enum Body {
    Triangle {
        corners: [DVec3; 3],
        /// Geometric unit normal on the outer side.
        normal: Vec3,
        /// Greatest error bound of [`crate::math::HitPoint`] at the triangle's corners.
        error: f32,
        /// Whether the triangle belongs to a surface whose normals are interpolated.
        is_smooth: bool,
    },
    Shape(Analytic),
}

/// The numbering of faces: the faces of all geometries come first, one geometry after another, then those of the list
/// of analytic shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaceNumbers {
    /// The number of the first face of each geometry, and of the list.
    first: Vec<u32>,
}

impl FaceNumbers {
    /// Returns the number of the face that a ray hit, and the hit's position on the face as weights of the second and
    /// third corner.
    #[inline]
    pub fn of(&self, hit: &Hit) -> (u32, [f32; 2]) {
        let last = self.first.len() - 1;
        let group = if hit.geometry == IN_LIST { last } else { hit.geometry as usize };
        (self.first[group] + hit.primitive, [hit.u, hit.v])
    }
}

impl Scene {
    /// The number of faces.
    pub(crate) fn face_count(&self) -> usize {
        self.geometries.iter().map(count).sum::<usize>() + self.list.shapes().len()
    }

    /// The numbering of the scene's faces.
    pub(crate) fn face_numbers(&self) -> FaceNumbers {
        let mut next = 0;
        let mut first = Vec::with_capacity(self.geometries.len() + 1);
        for geometry in &*self.geometries {
            first.push(next);
            next += count(geometry) as u32;
        }
        first.push(next);
        FaceNumbers { first }
    }

    /// Visits all faces in the order of their numbers, until `visit` fails.
    pub(crate) fn each_face<E>(&self, mut visit: impl FnMut(Face) -> Result<(), E>) -> Result<(), E> {
        for (number, (geometry, owners)) in self.geometries.iter().zip(&*self.bindings.owners).enumerate() {
            for primitive in 0..count(geometry) as u32 {
                let facet = Facet::triangle(number as u32, primitive);
                let body = match geometry {
                    Geometry::Analytic { shapes, .. } => Body::Shape(shapes.start[primitive as usize].clone()),
                    Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => {
                        self.triangle(&facet, triangles.corners(primitive, 0.0), triangles.normals.is_some())
                    }
                    Geometry::Instance { triangles, instance_path, .. } => {
                        let place = |corner| instance_path.start().to_scene.transform_point3(corner);
                        self.triangle(&facet, triangles.corners(primitive, 0.0).map(place), triangles.normals.is_some())
                    }
                };
                visit(self.face(facet, body, owners.of(primitive)))?;
            }
        }
        for (primitive, (shape, owner)) in self.list.shapes().iter().zip(&*self.bindings.list_owners).enumerate() {
            let facet = Facet::triangle(IN_LIST, primitive as u32);
            visit(self.face(facet, Body::Shape(shape.clone()), *owner))?;
        }
        Ok(())
    }

    fn triangle(&self, facet: &Facet, corners: [DVec3; 3], is_smooth: bool) -> Body {
        let points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(b1, b2)| self.facet_point(facet, b1, b2));
        let error = points.iter().map(|at| at.point.error).fold(0.0, f32::max);
        Body::Triangle { corners, normal: points[0].ng, error, is_smooth }
    }

    fn face(&self, facet: Facet, body: Body, owner: Owner) -> Face {
        let emitter = (owner.emitter != NO_EMITTER).then_some(owner.emitter);
        Face { body, facet, surface: owner.surface, material: owner.material, emitter }
    }

    /// Returns the number of the face of a surface that has the number `primitive` in [`super::HitDescription`].
    ///
    /// Returns `None` where there is no such surface or primitive, or where the primitive was left out because it has
    /// no area. The flag says whether the second and third corner are swapped relative to the description.
    pub(crate) fn face_of(&self, surface: u32, primitive: u32) -> Option<(u32, bool)> {
        let mut first = 0;
        for geometry in &*self.geometries {
            match geometry {
                Geometry::Loose { parts, .. } => {
                    // Loose triangles are sorted by their surfaces.
                    let key = (surface, primitive);
                    if let Ok(i) = parts.binary_search_by_key(&key, |part| (part.surface, part.half)) {
                        return Some((first + i as u32, parts[i].is_mirrored));
                    }
                }
                Geometry::Flat { triangles, surface: own, .. } | Geometry::Instance { triangles, surface: own, .. }
                    if *own == surface =>
                {
                    let i = match &triangles.original {
                        Some(original) => original.binary_search(&primitive).ok()? as u32,
                        None if (primitive as usize) < triangles.mesh.indices().len() => primitive,
                        None => return None,
                    };
                    return Some((first + i, triangles.swapped));
                }
                Geometry::Analytic { surfaces, .. } => {
                    if let Some(i) = surfaces.iter().position(|own| *own == surface) {
                        return Some((first + i as u32, false));
                    }
                }
                Geometry::Flat { .. } | Geometry::Instance { .. } => {}
            }
            first += count(geometry) as u32;
        }
        let listed = self.bindings.list_owners.iter().position(|owner| owner.surface == surface)?;
        Some((first + listed as u32, false))
    }
}

fn count(geometry: &Geometry) -> usize {
    match geometry {
        Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. } => {
            triangles.mesh.indices().len()
        }
        Geometry::Analytic { shapes, .. } => shapes.start.len(),
    }
}
