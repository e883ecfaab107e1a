//! Texture coordinates, tangents and footprints, for materials that ask for them.
//!
//! Nothing here is computed for a material that is the same all over its surfaces.

use super::describe::in_order;
use super::geometry::Geometry;
use super::hit::Hit;
use super::interaction::Triangles;
use super::record::GeometryRecord;
use super::{Scene, SurfaceInteraction};
use crate::desc::MeshDesc;
use crate::math::{DVec3, Frame, RayCone, Vec3, shutter_time};
use crate::texture::{Texel, WHITE};

/// Where a point lies on its surface, and how much of the surface a pixel sees there.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceDetail<'a> {
    /// Texture coordinates. Where a mesh has its own, they are interpolated. Other triangles have the barycentric weights
    /// of their second and third vertex. Quads have (0, 0), (1, 0), (1, 1) and (0, 1) at their vertices. Those of spheres, disks and
    /// quadrics are in `docs/scene-format.md`.
    pub uv: [f32; 2],
    /// Derivative of the position by the first texture coordinate, scene frame: a tangent. Where texture coordinates do not
    /// vary, it is any unit vector in the plane.
    pub dpdu: Vec3,
    /// Derivative of the position by the second texture coordinate.
    pub dpdv: Vec3,
    /// Diameter of the cone of the path's ray where it meets the surface, across the ray; 0 where rays carry no cones.
    pub footprint: f32,
    /// The point, scene frame.
    pub p: Vec3,
    /// Unit direction back along the path, scene frame.
    pub wo: Vec3,
    /// The unit normal of the face on the outer side.
    pub ng: Vec3,
    /// The unit shading normal on the outer side. The local frame of a Bsdf is [`Frame::from_normal`] of it.
    pub ns: Vec3,
    /// The direction along which an anisotropic surface is brushed, of any length but 0: that in which the first texture coordinate
    /// grows. Around surfaces that have no texture coordinates of their own (spheres, disks, quadrics, and meshes without any), it
    /// runs around the world's y axis.
    pub tangent: Vec3,
    /// The direction along which normal maps have their x axis, of any length but 0, on smooth meshes with a normal map: that of
    /// the mesh, or of MikkTSpace. On other surfaces it is that in which the first texture coordinate grows.
    pub map_tangent: Option<Vec3>,
    /// The point on its mesh, in scenes with textures that read colours of vertices or a further set of texture coordinates.
    pub(super) mesh: Option<MeshPoint<'a>>,
}

/// A point of a triangle of a mesh that has more at its vertices than positions, normals and one set of texture coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshPoint<'a> {
    mesh: &'a MeshDesc,
    /// The corners of the triangle, and the weights of them, in the order in which the kernel has them.
    corners: [u32; 3],
    weights: [f32; 3],
    /// The sides of the triangle from its first corner to the others, scene frame; 0 where no tangents are asked for.
    sides: [Vec3; 2],
}

impl MeshPoint<'_> {
    /// What the mesh has at the three corners; `None` where it has nothing there.
    fn at_corners<T>(&self, of_vertex: impl Fn(usize) -> Option<T>) -> Option<[T; 3]> {
        let [a, b, c] = self.corners.map(|vertex| of_vertex(vertex as usize));
        Some([a?, b?, c?])
    }
}

/// The sum of the numbers of three corners by their weights.
fn interpolated<const N: usize>([a, b, c]: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i])
}

impl SurfaceDetail<'_> {
    /// The colour of the mesh's vertices, interpolated over the triangle: red, green and blue in linear light, and opacity. 1 where
    /// the mesh has none, and in scenes without textures that read it.
    pub fn vertex_color(&self) -> Texel {
        let color = |mesh: MeshPoint<'_>| {
            let colors = mesh.at_corners(|vertex| mesh.mesh.colors.get(vertex).copied())?;
            Some(interpolated(colors, mesh.weights))
        };
        self.mesh.and_then(color).unwrap_or(WHITE)
    }

    /// The same point with the texture coordinates and tangents of another set, where the mesh has it. Where they do not span the
    /// surface, the tangents stay.
    pub(super) fn with_set(&self, set: u32) -> Self {
        let Some(mesh) = self.mesh else { return *self };
        let Some(corners) = mesh.at_corners(|vertex| mesh.mesh.uv_of_set(set, vertex)) else { return *self };
        let tangents = tangents_of(mesh.sides.map(|side| side.as_dvec3()), corners);
        let [dpdu, dpdv] = tangents.unwrap_or([self.dpdu, self.dpdv]);
        Self { uv: interpolated(corners, mesh.weights), dpdu, dpdv, ..*self }
    }

    /// A point for what reads no tangents: they are 0.
    pub(super) fn without_tangents(uv: [f32; 2], footprint: f32, [ng, ns, p, wo]: [Vec3; 4]) -> Self {
        let none = Vec3::ZERO;
        Self { uv, dpdu: none, dpdv: none, footprint, p, wo, ng, ns, tangent: none, map_tangent: None, mesh: None }
    }

    /// The axes of the ellipse that the cone of the path's ray covers on the surface, in texture coordinates: the changes of the
    /// coordinates along its full diameters. Across the ray the ellipse is as wide as the cone, along it as much longer as the
    /// surface is seen at an angle.
    pub fn uv_axes(&self) -> [[f32; 2]; 2] {
        /// Where the surface is seen along its edge, an ellipse is this much longer than wide at most.
        const LONGEST: f32 = 1e4;
        let cos = self.wo.dot(self.ng).abs().max(1.0 / LONGEST);
        let across = self.ng.cross(self.wo).try_normalize().unwrap_or_else(|| self.ng.any_orthonormal_vector());
        let along = across.cross(self.ng);
        // Lengths along the surface in terms of dpdu and dpdv.
        let (u, v) = (self.dpdu, self.dpdv);
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let determinant = uu * vv - uv * uv;
        if determinant.is_nan() || determinant <= 0.0 {
            return [[0.0; 2]; 2];
        }
        [along * (self.footprint / cos), across * self.footprint].map(|axis| {
            let (au, av) = (axis.dot(u), axis.dot(v));
            [(vv * au - uv * av) / determinant, (uu * av - uv * au) / determinant]
        })
    }
}

impl Scene {
    /// Computes texture coordinates and tangents at a hit, and the diameter of the ray that met the surface. `at` is the
    /// interaction of the same hit.
    pub fn detail(&self, hit: &Hit, at: &SurfaceInteraction) -> SurfaceDetail<'_> {
        self.detail_at(hit, [at.ng, at.ns, at.point.p, at.ns], at.point.time, at.point.cone, true)
    }

    /// [`Scene::detail`] from the parts of an interaction that it needs: the two normals, the point, and the direction back along
    /// the path. Tangents are 0 unless they are asked for.
    pub(crate) fn detail_at(
        &self,
        hit: &Hit,
        [ng, ns, p, wo]: [Vec3; 4],
        time: f32,
        cone: RayCone,
        with_tangents: bool,
    ) -> SurfaceDetail<'_> {
        if !with_tangents {
            let uv = self.analytic_parameters(hit, p, time).map_or_else(|| self.uv(hit), |(uv, _)| uv);
            let mesh = self.mesh_point(hit, None);
            return SurfaceDetail { mesh, ..SurfaceDetail::without_tangents(uv, cone.width(), [ng, ns, p, wo]) };
        }
        let sides = self.sides(hit, time);
        let (uv, tangents) = self.analytic_parameters(hit, p, time).unwrap_or_else(|| {
            let corners = sides.zip(self.corner_uvs(hit));
            (self.uv(hit), corners.and_then(|(sides, corners)| tangents_of(sides, corners)))
        });
        let [dpdu, dpdv] = tangents.unwrap_or_else(|| {
            let frame = Frame::from_normal(ng);
            [frame.s, frame.t]
        });
        let around = Vec3::Y.cross(ns);
        let tangent = if self.has_own_tangents(hit) || around == Vec3::ZERO { dpdu } else { around };
        let map_tangent = if self.tangents.is_empty() { None } else { self.map_tangent(hit, time) };
        let mesh = self.mesh_point(hit, sides);
        SurfaceDetail { uv, dpdu, dpdv, footprint: cone.width(), p, wo, ng, ns, tangent, map_tangent, mesh }
    }

    /// The tangent of a normal map, where the mesh has tangents or some were made for it.
    fn map_tangent(&self, hit: &Hit, time: f32) -> Option<Vec3> {
        let of = |triangles: &Triangles, surface| {
            let tangents = self.tangents.of(surface)?;
            let primitive = hit.primitive;
            let triangle = triangles.original.as_ref().map_or(primitive, |original| original[primitive as usize]);
            let [a, b, c] = tangents.of_triangle(triangle);
            let [u, v] = in_order(triangles.swapped, [hit.u, hit.v]);
            Some(((1.0 - u - v) * a + u * b + v * c).as_dvec3())
        };
        let tangent = match self.geometries.get(hit.geometry as usize)? {
            Geometry::Flat { triangles, surface, moved: Some(path), .. } => {
                let tangent = of(triangles, *surface)?;
                path.with_transform(time, |transform| transform.to_scene.matrix3 * tangent)
            }
            &Geometry::Flat { ref triangles, surface, .. } => {
                self.record.placed(surface)?.1.matrix3 * of(triangles, surface)?
            }
            Geometry::Instance { triangles, surface, instance_path } => {
                let tangent = of(triangles, *surface)?;
                match instance_path.is_of_group() {
                    true => self.record.placed(*surface)?.1.matrix3 * tangent,
                    false => instance_path.with_transform(time, |transform| transform.to_scene.matrix3 * tangent),
                }
            }
            Geometry::Loose { .. } | Geometry::Analytic { .. } => return None,
        };
        let tangent = tangent.as_vec3a();
        (tangent.is_finite() && tangent != Vec3::ZERO).then_some(tangent)
    }

    /// Whether the tangents of a surface are its own: those of texture coordinates, of a triangle or of a quad.
    fn has_own_tangents(&self, hit: &Hit) -> bool {
        match self.geometries.get(hit.geometry as usize) {
            Some(Geometry::Loose { .. }) => true,
            Some(Geometry::Flat { surface, .. } | Geometry::Instance { surface, .. }) => {
                self.record.uv_mesh(*surface).is_some()
            }
            _ => false,
        }
    }

    /// The texture coordinates of a hit, as [`HitDescription`](super::HitDescription) has them.
    #[inline]
    pub fn uv(&self, hit: &Hit) -> [f32; 2] {
        self.corner_uvs(hit).map_or([0.0; 2], |corners| interpolated(corners, hit.weights()))
    }

    /// The texture coordinates of a triangle's corners, in the order in which the kernel has them; `None` for other shapes.
    fn corner_uvs(&self, hit: &Hit) -> Option<[[f32; 2]; 3]> {
        self.record.corner_uvs(self.geometries.get(hit.geometry as usize)?, hit.primitive)
    }

    /// The point on its mesh, where a texture may read what only some meshes have at their vertices; with the sides of the triangle if
    /// they are known.
    fn mesh_point(&self, hit: &Hit, sides: Option<[DVec3; 2]>) -> Option<MeshPoint<'_>> {
        if !self.reads_mesh_points {
            return None;
        }
        let (Geometry::Flat { triangles, surface, .. } | Geometry::Instance { triangles, surface, .. }) =
            self.geometries.get(hit.geometry as usize)?
        else {
            return None;
        };
        let mesh = self.record.whole_mesh(*surface)?;
        let corners = triangles.mesh.indices().get(hit.primitive as usize);
        let sides = sides.unwrap_or_default().map(|side| side.as_vec3a());
        Some(MeshPoint { mesh, corners, weights: hit.weights(), sides })
    }

    /// The sides of the triangle from its first corner to the others, scene frame; `None` for other shapes.
    fn sides(&self, hit: &Hit, time: f32) -> Option<[DVec3; 2]> {
        let &Hit { geometry, primitive, .. } = hit;
        let sides = |triangles: &Triangles| {
            let [a, b, c] = triangles.corners(primitive, shutter_time(time));
            [b - a, c - a]
        };
        Some(match self.geometries.get(geometry as usize)? {
            Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => sides(triangles),
            Geometry::Instance { triangles, instance_path, .. } => instance_path
                .with_transform(time, |transform| sides(triangles).map(|side| transform.to_scene.matrix3 * side)),
            Geometry::Analytic { .. } => return None,
        })
    }
}

/// The derivatives of the position by the texture coordinates of a triangle's corners; `None` where these do not span it.
fn tangents_of([e1, e2]: [DVec3; 2], corners: [[f32; 2]; 3]) -> Option<[Vec3; 2]> {
    let [a, b, c] = corners.map(|uv| uv.map(f64::from));
    let difference = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
    let ([u1, v1], [u2, v2]) = (difference(a, b), difference(a, c));
    let determinant = u1 * v2 - u2 * v1;
    let tangents = [v2 * e1 - v1 * e2, u1 * e2 - u2 * e1].map(|sum: DVec3| (sum / determinant).as_vec3a());
    tangents.iter().all(|tangent| tangent.is_finite() && *tangent != Vec3::ZERO).then_some(tangents)
}

impl GeometryRecord {
    /// The texture coordinates of a triangle's corners, in the order in which the kernel has them; `None` for other shapes.
    pub(super) fn corner_uvs(&self, geometry: &Geometry, primitive: u32) -> Option<[[f32; 2]; 3]> {
        self.corner_uvs_of_set(geometry, primitive, 0)
    }

    /// The texture coordinates of a triangle's corners in a set, or in the first one where its mesh lacks the set.
    pub(super) fn corner_uvs_of_set(&self, geometry: &Geometry, primitive: u32, set: u32) -> Option<[[f32; 2]; 3]> {
        let plain = |swapped| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|weights| in_order(swapped, weights));
        match geometry {
            Geometry::Loose { parts, .. } => {
                let part = parts[primitive as usize];
                let weights = plain(part.is_mirrored);
                let is_quad = self.is_quad(part.surface);
                Some(if is_quad { weights.map(|weights| quad_uv(part.half, weights)) } else { weights })
            }
            Geometry::Flat { triangles, surface, .. } | Geometry::Instance { triangles, surface, .. } => {
                let of_set = |set| self.mesh_uvs(*surface, triangles, primitive, set);
                Some(of_set(set).or_else(|| of_set(0)).unwrap_or_else(|| plain(triangles.swapped)))
            }
            Geometry::Analytic { .. } => None,
        }
    }

    /// The texture coordinates that a mesh gives to the corners of a triangle, where it has any.
    fn mesh_uvs(&self, surface: u32, triangles: &Triangles, primitive: u32, set: u32) -> Option<[[f32; 2]; 3]> {
        let mesh = self.whole_mesh(surface)?;
        let [a, b, c] = triangles.mesh.indices().get(primitive as usize);
        let uv = |vertex: u32| mesh.uv_of_set(set, vertex as usize);
        Some([uv(a)?, uv(b)?, uv(c)?])
    }
}

/// Returns the position on a quad whose vertices are (0, 0), (1, 0), (1, 1), (0, 1), from the barycentric coordinates
/// of its half.
fn quad_uv(half: u32, [b1, b2]: [f32; 2]) -> [f32; 2] {
    if half == 0 { [b1 + b2, b2] } else { [b1, b1 + b2] }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{BuildOptions, Scene};
    use crate::desc;
    use crate::math::{DVec3, Ray};
    use crate::sampling::Rng;

    /// At each point of a triangle the colour is that of its corners by the barycentric weights, however the triangle is placed,
    /// and a texture and the material's own colour are factors on it.
    #[test]
    fn colors_of_vertices_are_interpolated_and_multiplied() {
        let corners = [[-1.0, -0.8, 0.0], [1.2, -1.0, 0.3], [0.1, 0.9, -0.2]];
        let colors = [[0.9, 0.1, 0.25, 1.0], [0.05, 0.8, 0.5, 0.5], [0.3, 0.6, 0.0, 0.25]];
        let factors = [0.5, 0.25, 1.0];
        let mut met = 0;
        for (transform, dynamic, texture) in [
            (json!([]), false, json!({"name": "t", "type": "vertex-colors"})),
            (json!([{"scale": [-1.5, 1.2, 0.8]}]), false, json!({"name": "t", "type": "vertex-colors"})),
            (
                json!([{"scale": [-1.0, 1.0, 1.0]}, {"rotate": [20, 50, 10]}]),
                true,
                json!({"name": "t", "type": "checker", "colors": [[1, 0.5, 0.75], [1, 0.5, 0.75]], "vertexColors": true}),
            ),
        ] {
            let of_texture = if texture["type"] == "checker" { [1.0, 0.5, 0.75] } else { [1.0; 3] };
            let scene = json!({
                "etendue": 1, "camera": {}, "textures": [texture],
                "materials": [{"name": "m", "type": "diffuse", "color": factors, "textures": {"color": "t", "opacity": "t"}}],
                "surfaces": [{"geometry": "mesh", "material": "m", "positions": corners, "triangles": [[0, 1, 2]],
                    "colors": colors, "transform": transform}],
            });
            let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
            let scene = Scene::build(&desc, &BuildOptions { dynamic, ..BuildOptions::default() }).unwrap();
            let place = scene.record.placed(0).unwrap().1;
            let mut rng = Rng::new(7, 3);
            for _ in 0..500 {
                let (a, b) = (f64::from(rng.next_f32()).sqrt(), f64::from(rng.next_f32()));
                let weights = [1.0 - a, a * (1.0 - b), a * b];
                let at = |i: usize| (0..3).map(|k| weights[k] * corners[k][i]).sum::<f64>();
                let p = place.transform_point3(DVec3::new(at(0), at(1), at(2)));
                let from = p + DVec3::new(0.3, 0.2, 4.0);
                let direction = (scene.to_scene(p) - scene.to_scene(from)).normalize();
                let ray = Ray::new(scene.to_scene(from), direction);
                // Where it lets light through, rays may meet nothing.
                let Some(hit) = scene.intersect(&ray) else { continue };
                let interaction = scene.interaction(&ray, &hit);
                let detail = scene.detail(&hit, &interaction);
                let material = scene.material(interaction.material);
                let [albedo, _] = material.diffuse_albedos(|_| detail);
                let expected = |i: usize| (0..3).map(|k| weights[k] * colors[k][i]).sum::<f64>();
                for i in 0..3 {
                    let exact = expected(i) * factors[i] * of_texture[i];
                    let found = f64::from(albedo.to_array()[i]);
                    assert!((found - exact).abs() < 2e-6, "{found}, not {exact}: {transform}");
                }
                let opacity = f64::from(material.opacity(|_| detail));
                assert!((opacity - expected(3)).abs() < 2e-6, "{opacity}, not {}", expected(3));
                met += 1;
            }
        }
        assert!(met > 600, "{met}");
    }

    /// A texture of a further set shows what one of the first set shows on a mesh that has this set first, with its normals. A mesh
    /// that lacks the set has the first one.
    #[test]
    fn further_sets_are_read_as_the_first_one() {
        let corners = [[-1.0, -0.8, 0.0], [1.2, -1.0, 0.3], [0.1, 0.9, -0.2], [1.4, 1.0, 0.4]];
        let [first, second] =
            [[[0.1, 0.2], [0.7, 0.3], [0.2, 0.9], [0.8, 0.8]], [[0.9, 0.1], [0.4, 0.8], [0.05, 0.15], [0.5, 0.6]]];
        let built = |uvs: serde_json::Value, further: serde_json::Value, set: u32, smooth: bool, dynamic: bool| {
            let scene = json!({
                "etendue": 1, "camera": {},
                "textures": [{"name": "t", "type": "gradient", "scale": [1.5, 2], "rotation": 30, "uvSet": set},
                    {"name": "n", "type": "noise", "scale": [3, 4], "uvSet": set}],
                "materials": [{"name": "m", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "t", "normal": "n"}}],
                "surfaces": [{"geometry": "mesh", "material": "m", "positions": corners, "triangles": [[0, 1, 2], [2, 1, 3]],
                    "uvs": uvs, "furtherUvs": further, "shading": if smooth { "smooth" } else { "flat" },
                    "transform": [{"scale": [-1.5, 1.2, 0.8]}]}],
            });
            let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
            Scene::build(&desc, &BuildOptions { dynamic, ..BuildOptions::default() }).unwrap()
        };
        let none = || json!([]);
        for (smooth, dynamic) in [(false, false), (true, false), (true, true)] {
            let plain = built(json!(second), none(), 0, smooth, dynamic);
            let other = built(json!(first), none(), 0, smooth, dynamic);
            let with_sets = [
                built(json!(first), json!([second]), 1, smooth, dynamic),
                built(json!(first), json!([[], first, second]), 3, smooth, dynamic),
                built(json!(null), json!([second]), 1, smooth, dynamic),
                built(json!(second), none(), 5, smooth, dynamic),
                built(json!(second), json!([first]), 2, smooth, dynamic),
            ];
            let mut rng = Rng::new(3, 9);
            let (mut met, mut differs) = (0, false);
            for _ in 0..400 {
                let mut from = || f64::from(rng.next_f32()) * 3.0 - 1.5;
                let from = DVec3::new(from(), from(), 4.0);
                let seen = |scene: &Scene| {
                    let ray = Ray::new(scene.to_scene(from), crate::math::Vec3::NEG_Z);
                    let hit = scene.intersect(&ray)?;
                    let at = scene.interaction(&ray, &hit);
                    let detail = scene.detail(&hit, &at);
                    let material = scene.material(at.material);
                    let normal = material.normal(|_| detail)?;
                    Some((material.diffuse_albedos(|_| detail)[0].to_array(), normal))
                };
                let Some((albedo, normal)) = seen(&plain) else { continue };
                for scene in &with_sets {
                    let (found, turned) = seen(scene).unwrap();
                    let error = (0..3).map(|i| (found[i] - albedo[i]).abs()).fold(0.0, f32::max);
                    assert!(error < 1e-6, "{found:?}, not {albedo:?}");
                    assert!((turned - normal).length() < 1e-5, "{turned}, not {normal}");
                }
                differs |= (seen(&other).unwrap().0[0] - albedo[0]).abs() > 0.1;
                met += 1;
            }
            assert!(met > 50 && differs, "{met}");
        }
    }

    #[test]
    fn colors_of_vertices_are_asked_for_where_a_texture_reads_them_alone() {
        let scene = json!({
            "etendue": 1, "camera": {}, "textures": [{"name": "t", "type": "checker"}],
            "materials": [{"name": "m", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "t"}}],
            "surfaces": [{"geometry": "mesh", "material": "m", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
                "triangles": [[0, 1, 2]], "colors": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]}],
        });
        let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        assert!(!scene.reads_mesh_points);
    }
}
