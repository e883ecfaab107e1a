//! Surfaces as triangles, for algorithms that visit all surfaces of a scene instead of tracing rays.
//!
//! Surfaces are given as they were described: each surface is a mesh with its own vertices and their numbers, and
//! curved shapes are tessellated into parts that are nearly flat. The module `faces` has the single primitives that
//! rays hit instead.

use super::describe::in_order;
use super::geometry::Geometry;
use super::hit::{Hit, IN_LIST};
use super::interaction::Triangles;
use super::lower::is_mirrored;
use super::{Scene, SurfaceInteraction};
use crate::control::{Cancel, WorkProgress};
use crate::error::Result;
use crate::math::{DVec3, Vec3};
use crate::shape::Analytic;

/// A triangle of a surface: either a triangle that rays can hit, or a nearly flat part of an analytic shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    geometry: u32,
    primitive: u32,
    /// Corners of a part of an analytic shape, in the scene frame. They are not read for triangles.
    corners: [[f32; 3]; 3],
    /// Whether the second and third corner are the third and second of the triangle that rays hit, as in mirrored instances.
    is_swapped: bool,
}

/// A surface as triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// Index in [`crate::desc::SceneDesc::surfaces`].
    pub surface: u32,
    /// Whether the surface is a mesh, rather than a triangle, a quad or an analytic shape.
    pub is_mesh: bool,
    /// Vertices in the world frame. A mesh has all of its vertices, in the order in which they were given; a triangle
    /// or a quad has its corners; an analytic shape has points on its surface.
    pub positions: Vec<DVec3>,
    /// Shading unit normal of each vertex on the outer side, where the surface is smooth. It is zero where a mesh has
    /// no normal.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates of each vertex, where a mesh has them.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Three vertex numbers for each triangle, counter-clockwise seen from outside. Triangles without area are left
    /// out.
    pub triangles: Vec<[u32; 3]>,
    /// The number of each triangle in its mesh as the mesh was given; 0 or 1 for the half of a quad; consecutive
    /// numbers for analytic shapes.
    pub primitives: Vec<u32>,
    /// The facet of each triangle, with its corners in the same order.
    pub facets: Vec<Facet>,
}

impl Scene {
    /// Returns every surface that rays can hit, in the order of the description.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn surface_meshes(&self, cancel: &Cancel) -> Result<Vec<SurfaceMesh>> {
        self.watched_surface_meshes(&WorkProgress::new(cancel))
    }

    /// Does the work of [`Scene::surface_meshes`] and reports progress. A unit of work is a vertex or a triangle of a
    /// mesh, of which there are [`Scene::surface_mesh_items`].
    pub(crate) fn watched_surface_meshes(&self, progress: &WorkProgress) -> Result<Vec<SurfaceMesh>> {
        let mut meshes = Vec::new();
        for (number, geometry) in self.geometries.iter().enumerate() {
            progress.check()?;
            let geometry_number = number as u32;
            match geometry {
                Geometry::Loose { triangles, parts, .. } => {
                    // The halves of a quad follow each other.
                    let mut begin = 0;
                    for group in parts.chunk_by(|a, b| a.surface == b.surface) {
                        progress.check()?;
                        let range = begin..begin + group.len();
                        begin = range.end;
                        let mut mesh = SurfaceMesh { surface: group[0].surface, ..SurfaceMesh::default() };
                        let mirrored = group[0].is_mirrored;
                        for primitive in range {
                            let facet = Facet::triangle(geometry_number, primitive as u32);
                            let corners = triangles.corners(primitive as u32, 0.0).map(|corner| corner + self.centre);
                            mesh.add_loose(facet, corners, parts[primitive].half, mirrored);
                        }
                        meshes.push(mesh);
                    }
                }
                &Geometry::Flat { ref triangles, surface, .. } => {
                    meshes.push(self.mesh(geometry_number, surface, triangles, |p| p, |n| n, progress)?);
                }
                Geometry::Instance { triangles, surface, instance_path } => {
                    let to_scene = instance_path.start().to_scene;
                    let normals = to_scene.matrix3.inverse().transpose();
                    let place = |p: DVec3| to_scene.transform_point3(p);
                    let turn = |n: Vec3| (normals * n.as_dvec3()).as_vec3a();
                    let mut mesh = self.mesh(geometry_number, *surface, triangles, place, turn, progress)?;
                    if is_mirrored(&to_scene) {
                        mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
                        mesh.facets.iter_mut().for_each(|facet| facet.is_swapped = true);
                    }
                    meshes.push(mesh);
                }
                Geometry::Analytic { shapes, surfaces } => {
                    for (primitive, (shape, surface)) in shapes.start.iter().zip(surfaces.iter()).enumerate() {
                        progress.check()?;
                        meshes.push(self.curved(geometry_number, primitive as u32, *surface, shape));
                    }
                }
            }
        }
        for (primitive, shape) in self.list.shapes().iter().enumerate() {
            let surface = self.bindings.list_owners[primitive].surface;
            meshes.push(self.curved(IN_LIST, primitive as u32, surface, shape));
        }
        meshes.sort_by_key(|mesh| mesh.surface);
        Ok(meshes)
    }

    /// The number of vertices and triangles of all meshes.
    pub(crate) fn surface_mesh_items(&self) -> usize {
        let items = |geometry: &Geometry| match geometry {
            Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. } => {
                triangles.mesh.vertices().len() + triangles.mesh.indices().len()
            }
            Geometry::Loose { .. } | Geometry::Analytic { .. } => 0,
        };
        self.geometries.iter().map(items).sum()
    }

    /// The greatest amount of memory that [`Scene::surface_meshes`] takes, in bytes.
    pub fn surface_mesh_bytes(&self) -> usize {
        let triangle = size_of::<[u32; 3]>() + size_of::<u32>() + size_of::<Facet>();
        let vertex = size_of::<DVec3>() + size_of::<Vec3>() + size_of::<[f32; 2]>();
        let of = |triangles: &Triangles| {
            triangles.mesh.indices().len() * triangle + triangles.mesh.vertices().len() * vertex
        };
        let geometry = |geometry: &Geometry| match geometry {
            Geometry::Loose { triangles, parts, .. } => of(triangles) + parts.len() * size_of::<SurfaceMesh>(),
            Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. } => of(triangles),
            Geometry::Analytic { shapes, .. } => shapes.start.len() * Analytic::MAX_TRIANGLES * (triangle + vertex),
        };
        let listed = self.list.shapes().len() * Analytic::MAX_TRIANGLES * (triangle + vertex);
        self.geometries.iter().map(geometry).sum::<usize>() + listed
    }

    fn mesh(
        &self,
        geometry: u32,
        surface: u32,
        triangles: &Triangles,
        place: impl Fn(DVec3) -> DVec3,
        turn: impl Fn(Vec3) -> Vec3,
        progress: &WorkProgress,
    ) -> Result<SurfaceMesh> {
        let (vertices, indices) = (triangles.mesh.vertices(), triangles.mesh.indices());
        let mut mesh = SurfaceMesh { surface, is_mesh: true, ..SurfaceMesh::default() };
        let described = self.record.uv_mesh(surface);
        mesh.positions.reserve_exact(vertices.len());
        mesh.normals = triangles.normals.as_ref().map(|_| Vec::with_capacity(vertices.len()));
        mesh.uvs = described.map(|_| Vec::with_capacity(vertices.len()));
        progress.each(vertices.len(), 1.0, |vertex| {
            let p = DVec3::from(vertices.get(vertex).map(f64::from));
            mesh.positions.push(place(p) + self.centre);
            if let (Some(normals), Some(given)) = (&mut mesh.normals, &triangles.normals) {
                normals.push(turn(Vec3::from(given.get(vertex))).normalize_or_zero());
            }
            if let (Some(uvs), Some(described)) = (&mut mesh.uvs, &described) {
                uvs.push(described.uv(vertex).unwrap_or_default());
            }
        })?;
        progress.each(indices.len(), 1.0, |primitive| {
            mesh.triangles.push(indices.get(primitive));
            let original = triangles.original.as_ref().map_or(primitive as u32, |original| original[primitive]);
            mesh.primitives.push(original);
            mesh.facets.push(Facet::triangle(geometry, primitive as u32));
        })?;
        Ok(mesh)
    }

    fn curved(&self, geometry: u32, primitive: u32, surface: u32, shape: &Analytic) -> SurfaceMesh {
        let (points, triangles) = shape.tessellate();
        let single: Vec<[f32; 3]> = points.iter().map(|p| p.as_vec3a().to_array()).collect();
        SurfaceMesh {
            surface,
            normals: Some(points.iter().map(|&p| shape.project(p).1.as_vec3a()).collect()),
            positions: points.into_iter().map(|p| p + self.centre).collect(),
            is_mesh: false,
            uvs: None,
            primitives: (0..triangles.len() as u32).collect(),
            facets: triangles
                .iter()
                .map(|t| Facet {
                    geometry,
                    primitive,
                    corners: t.map(|corner| single[corner as usize]),
                    is_swapped: false,
                })
                .collect(),
            triangles,
        }
    }

    /// Returns the interaction at a point of a facet of this scene, as if a ray had hit that point. The point is given
    /// by the weights of the facet's second and third corner, which are >= 0 and sum up to 1 at most.
    #[inline]
    pub fn facet_point(&self, facet: &Facet, b1: f32, b2: f32) -> SurfaceInteraction {
        self.point_of(&facet.hit(b1, b2), 0.0, |shape| facet.near(shape, b1, b2))
    }
}

impl Facet {
    pub(super) fn triangle(geometry: u32, primitive: u32) -> Self {
        Self { geometry, primitive, corners: [[0.0; 3]; 3], is_swapped: false }
    }

    /// The part of the same analytic shape with these corners.
    pub(crate) fn part(self, corners: [DVec3; 3]) -> Self {
        Self { corners: corners.map(|corner| corner.as_vec3a().to_array()), ..self }
    }

    /// Returns the hit of a ray that arrives at this point.
    pub(crate) fn hit(&self, b1: f32, b2: f32) -> Hit {
        let [u, v] = in_order(self.is_swapped, [b1, b2]);
        Hit { t: 0.0, u, v, primitive: self.primitive, geometry: self.geometry }
    }

    /// Returns the point of an analytic shape above the point of the flat facet.
    fn near(&self, shape: &Analytic, b1: f32, b2: f32) -> DVec3 {
        let [a, b, c] = self.corners.map(|corner| Vec3::from(corner).as_dvec3());
        let flat = a + f64::from(b1) * (b - a) + f64::from(b2) * (c - a);
        // A projection step towards a quadric squares the remaining distance. After these two steps and the one that
        // follows, no distance remains.
        shape.project(shape.project(flat).0).0
    }
}

impl SurfaceMesh {
    /// Adds a triangle that belongs to a surface directly, not to a mesh. Corners that are there already are used
    /// again.
    ///
    /// `mirrored` says that the winding was reversed, while the vertices keep the order in which they were given.
    fn add_loose(&mut self, facet: Facet, corners: [DVec3; 3], half: u32, mirrored: bool) {
        let given = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        let mut numbers = [0; 3];
        for i in given {
            let known = self.positions.iter().position(|p| *p == corners[i]);
            numbers[i] = known.unwrap_or(self.positions.len()) as u32;
            if known.is_none() {
                self.positions.push(corners[i]);
            }
        }
        self.triangles.push(numbers);
        self.primitives.push(half);
        self.facets.push(facet);
    }
}
