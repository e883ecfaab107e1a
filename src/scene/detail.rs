//! Texture coordinates, tangents and footprints, for materials that ask for them.
//!
//! Nothing here is computed for a material that is the same all over its surfaces.

use super::describe::in_order;
use super::geometry::Geometry;
use super::hit::Hit;
use super::interaction::Triangles;
use super::record::GeometryRecord;
use super::{Scene, SurfaceInteraction};
use crate::math::{DVec3, Frame, RayCone, Vec3, shutter_time};
use crate::texture::{Texel, WHITE};

/// Where a point lies on its surface, and how much of the surface a pixel sees there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDetail {
    /// Texture coordinates. Where a mesh has its own, they are interpolated. Other triangles have the barycentric weights
    /// of their second and third vertex. Quads have (0, 0), (1, 0), (1, 1) and (0, 1) at their vertices. Those of spheres, disks and
    /// quadrics are in `docs/scene-format.md`.
    pub uv: [f32; 2],
    /// Derivative of the position by the first texture coordinate, scene frame: a tangent. Where texture coordinates do not
    /// vary, it is any unit vector in the plane.
    pub dpdu: Vec3,
    /// Derivative of the position by the second texture coordinate.
    pub dpdv: Vec3,
    /// The colour of the mesh's vertices, interpolated over the triangle: red, green and blue in linear light, and opacity. 1 where
    /// the mesh has none, and in scenes without textures that read it.
    pub color: Texel,
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
    /// The direction along which normal maps have their x axis, of any length but 0: on smooth meshes with a normal map that of
    /// MikkTSpace, and on other surfaces that in which the first texture coordinate grows.
    pub map_tangent: Vec3,
}

impl SurfaceDetail {
    /// A point for what reads no tangents: they are 0.
    pub(super) fn without_tangents(uv: [f32; 2], footprint: f32, [ng, ns, p, wo]: [Vec3; 4]) -> Self {
        let none = Vec3::ZERO;
        Self { uv, color: WHITE, dpdu: none, dpdv: none, footprint, p, wo, ng, ns, tangent: none, map_tangent: none }
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
    pub fn detail(&self, hit: &Hit, at: &SurfaceInteraction) -> SurfaceDetail {
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
    ) -> SurfaceDetail {
        if !with_tangents {
            let uv = self.analytic_parameters(hit, p).map_or_else(|| self.uv(hit), |(uv, _)| uv);
            let color = self.vertex_color(hit);
            return SurfaceDetail { color, ..SurfaceDetail::without_tangents(uv, cone.width(), [ng, ns, p, wo]) };
        }
        let (uv, tangents) =
            self.analytic_parameters(hit, p).unwrap_or_else(|| (self.uv(hit), self.tangents(hit, time)));
        let [dpdu, dpdv] = tangents.unwrap_or_else(|| {
            let frame = Frame::from_normal(ng);
            [frame.s, frame.t]
        });
        let around = Vec3::Y.cross(ns);
        let tangent = if self.has_own_tangents(hit) || around == Vec3::ZERO { dpdu } else { around };
        let own = if self.tangents.is_empty() { None } else { self.map_tangent(hit, time) };
        let map_tangent = own.unwrap_or(dpdu);
        let (color, footprint) = (self.vertex_color(hit), cone.width());
        SurfaceDetail { uv, color, dpdu, dpdv, footprint, p, wo, ng, ns, tangent, map_tangent }
    }

    /// The tangent of MikkTSpace, where one was made for the mesh.
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
            &Geometry::Flat { ref triangles, surface, .. } => {
                self.record.placed(surface)?.1.matrix3 * of(triangles, surface)?
            }
            Geometry::Instance { triangles, surface, instance_path } => {
                let tangent = of(triangles, *surface)?;
                instance_path.with_transform(time, |transform| transform.to_scene.matrix3 * tangent)
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

    /// The texture coordinates of a point.
    pub(super) fn uv(&self, hit: &Hit) -> [f32; 2] {
        let Some(corners) = self.corner_uvs(hit) else { return [0.0; 2] };
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let mut uv = [0.0; 2];
        for ([u, v], weight) in corners.into_iter().zip(weights) {
            uv = [uv[0] + weight * u, uv[1] + weight * v];
        }
        uv
    }

    /// The colour of the mesh's vertices at a point.
    fn vertex_color(&self, hit: &Hit) -> Texel {
        if !self.reads_vertex_colors {
            return WHITE;
        }
        let geometry = self.geometries.get(hit.geometry as usize);
        let corners = geometry.and_then(|geometry| self.record.corner_colors(geometry, hit.primitive));
        let Some([a, b, c]) = corners else { return WHITE };
        let w = 1.0 - hit.u - hit.v;
        std::array::from_fn(|i| w * a[i] + hit.u * b[i] + hit.v * c[i])
    }

    /// The texture coordinates of a triangle's corners, in the order in which the kernel has them; `None` for other shapes.
    fn corner_uvs(&self, hit: &Hit) -> Option<[[f32; 2]; 3]> {
        self.record.corner_uvs(self.geometries.get(hit.geometry as usize)?, hit.primitive)
    }

    /// The derivatives of the position by the texture coordinates; `None` where these do not span the surface.
    fn tangents(&self, hit: &Hit, time: f32) -> Option<[Vec3; 2]> {
        let &Hit { geometry, primitive, .. } = hit;
        let sides = |triangles: &Triangles| {
            let [a, b, c] = triangles.corners(primitive, shutter_time(time));
            [b - a, c - a]
        };
        let [e1, e2] = match self.geometries.get(geometry as usize)? {
            Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => sides(triangles),
            Geometry::Instance { triangles, instance_path, .. } => instance_path
                .with_transform(time, |transform| sides(triangles).map(|side| transform.to_scene.matrix3 * side)),
            Geometry::Analytic { .. } => return None,
        };
        let [a, b, c] = self.corner_uvs(hit)?.map(|uv| uv.map(f64::from));
        let difference = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
        let ([u1, v1], [u2, v2]) = (difference(a, b), difference(a, c));
        let determinant = u1 * v2 - u2 * v1;
        let tangents = [v2 * e1 - v1 * e2, u1 * e2 - u2 * e1].map(|sum: DVec3| (sum / determinant).as_vec3a());
        tangents.iter().all(|tangent| tangent.is_finite() && *tangent != Vec3::ZERO).then_some(tangents)
    }
}

impl GeometryRecord {
    /// The texture coordinates of a triangle's corners, in the order in which the kernel has them; `None` for other shapes.
    pub(super) fn corner_uvs(&self, geometry: &Geometry, primitive: u32) -> Option<[[f32; 2]; 3]> {
        let plain = |swapped| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|weights| in_order(swapped, weights));
        match geometry {
            Geometry::Loose { parts, .. } => {
                let part = parts[primitive as usize];
                let weights = plain(self.is_mirrored(part.surface));
                let is_quad = self.is_quad(part.surface);
                Some(if is_quad { weights.map(|weights| quad_uv(part.half, weights)) } else { weights })
            }
            Geometry::Flat { triangles, surface, .. } | Geometry::Instance { triangles, surface, .. } => {
                Some(self.mesh_uvs(*surface, triangles, primitive).unwrap_or_else(|| plain(triangles.swapped)))
            }
            Geometry::Analytic { .. } => None,
        }
    }

    /// The colours that a mesh gives to the corners of a triangle, where it has any.
    pub(super) fn corner_colors(&self, geometry: &Geometry, primitive: u32) -> Option<[Texel; 3]> {
        let (Geometry::Flat { triangles, surface, .. } | Geometry::Instance { triangles, surface, .. }) = geometry
        else {
            return None;
        };
        let colors = &self.whole_mesh(*surface)?.colors;
        let [a, b, c] = triangles.mesh.indices().get(primitive as usize);
        Some([*colors.get(a as usize)?, *colors.get(b as usize)?, *colors.get(c as usize)?])
    }

    /// The texture coordinates that a mesh gives to the corners of a triangle, where it has any.
    fn mesh_uvs(&self, surface: u32, triangles: &Triangles, primitive: u32) -> Option<[[f32; 2]; 3]> {
        let mesh = self.uv_mesh(surface)?;
        let [a, b, c] = triangles.mesh.indices().get(primitive as usize);
        Some([mesh.uv(a as usize)?, mesh.uv(b as usize)?, mesh.uv(c as usize)?])
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
        assert!(!scene.reads_vertex_colors);
    }
}
