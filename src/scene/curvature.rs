//! How much surfaces bend, for the cones of rays that they reflect and refract.

use super::Scene;
use super::geometry::Geometry;
use super::hit::{Hit, IN_LIST};
use super::interaction::Triangles;
use crate::math::{DMat3, Ray, RayCone, Vec3, shutter_time};
use crate::shape::Analytic;

impl Scene {
    /// The cone of a ray where it meets a surface at `p`, and the curvature there. The arguments are values, since a reference to the
    /// interaction would keep all of it in memory at every hit.
    #[cold]
    #[inline(never)]
    pub(super) fn cone_at(&self, ray: &Ray, hit: &Hit, p: Vec3, time: f32) -> (RayCone, f32) {
        let cone = ray.cone.after(hit.t * ray.direction.length());
        (cone, if ray.cone.is_none() { 0.0 } else { self.curvature(hit, p, time) })
    }

    /// The mean curvature at a hit [1 / scene unit]: positive where the surface bends away from its outer normal, as a ball does, and 0
    /// where it is flat. That of a smooth mesh is the one of its interpolated normals.
    fn curvature(&self, hit: &Hit, p: Vec3, time: f32) -> f32 {
        let of_shape = |shape: &Analytic| shape.mean_curvature(p.as_dvec3()) as f32;
        if hit.geometry == IN_LIST {
            return self.list.shapes().get(hit.primitive as usize).map_or(0.0, of_shape);
        }
        let curvature = match &self.geometries[hit.geometry as usize] {
            Geometry::Analytic { shapes, .. } => {
                return match shapes.moving.get(hit.primitive as usize) {
                    Some(moving) => of_shape(&moving.at(time)),
                    None => shapes.start.get(hit.primitive as usize).map_or(0.0, of_shape),
                };
            }
            Geometry::Loose { triangles, .. } | Geometry::Flat { triangles, .. } => {
                triangles.curvature(hit.primitive, time, [DMat3::IDENTITY; 2])
            }
            Geometry::Instance { triangles, instance_path, .. } => instance_path.with_transform(time, |transform| {
                triangles.curvature(hit.primitive, time, [transform.to_scene.matrix3, transform.normals])
            }),
        };
        if curvature.is_finite() { curvature as f32 } else { 0.0 }
    }
}

impl Triangles {
    /// The mean curvature of a triangle: that of its sides, along each of which the normal turns from one vertex to the other. The
    /// matrices take places and normals to the scene frame.
    fn curvature(&self, primitive: u32, time: f32, [places, leanings]: [DMat3; 2]) -> f64 {
        let Some(normals) = self.normals_at(primitive, time) else { return 0.0 };
        let normals = normals.map(|normal| (leanings * normal.as_dvec3()).normalize_or_zero());
        let [a, b, c] = self.corners(primitive, shutter_time(time));
        let face = leanings * (b - a).cross(c - a);
        // Where normals face away from the viewer who sees the face, it is shaded as it is.
        if normals.iter().any(|normal| normal.dot(face) <= 0.0) {
            return 0.0;
        }
        let corners = [a, b, c].map(|corner| places * corner);
        let along = |from: usize, to: usize| {
            let side = corners[to] - corners[from];
            (normals[to] - normals[from]).dot(side) / side.length_squared()
        };
        (along(0, 1) + along(1, 2) + along(2, 0)) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{BuildOptions, Scene};
    use crate::desc;
    use crate::math::{DVec3, HitPoint, Ray, Vec3};

    fn built(surface: &serde_json::Value, dynamic: bool) -> Scene {
        let scene = json!({
            "etendue": 1, "camera": {}, "textures": [{"name": "t", "type": "checker"}],
            "materials": [{"name": "m", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "t"}}],
            "surfaces": [surface],
        });
        let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
        Scene::build(&desc, &BuildOptions { dynamic, ..BuildOptions::default() }).unwrap()
    }

    fn curvature(scene: &Scene, from: [f64; 3], towards: [f64; 3]) -> f32 {
        let (from, towards) = (DVec3::from(from), DVec3::from(towards));
        let direction: Vec3 = (scene.to_scene(towards) - scene.to_scene(from)).normalize();
        let ray = Ray::new(scene.to_scene(from), direction);
        let hit = scene.intersect(&ray).unwrap();
        let HitPoint { p, time, .. } = scene.interaction(&ray, &hit).point;
        scene.curvature(&hit, p, time)
    }

    #[test]
    fn shapes_bend_as_their_formulas_say() {
        let ball = json!({"geometry": "sphere", "origin": [1, 2, 3], "radius": 0.5, "material": "m"});
        assert!((curvature(&built(&ball, false), [1.2, 2.1, 9.0], [1.2, 2.1, 0.0]) - 2.0).abs() < 1e-4);
        // A cylinder bends one way only; an ellipsoid of half axes a, a, c bends by c / a^2 in both at its end on the axis of c.
        let pipe = json!({"geometry": "cylinder", "base": [0, 0, -1], "axis": [0, 0, 1], "radius": 0.25, "height": 2, "material": "m"});
        assert!((curvature(&built(&pipe, false), [9.0, 0.1, 0.1], [0.0, 0.1, 0.1]) - 2.0).abs() < 1e-3);
        let egg = json!({"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "m",
            "transform": [{"scale": [2, 2, 3]}]});
        assert!((curvature(&built(&egg, false), [0.0, 0.0, 9.0], [0.0, 0.0, 0.0]) - 0.75).abs() < 1e-4);
        let flat = json!({"geometry": "disk", "origin": [0, 0, 0], "normal": [0, 0, 1], "radius": 1, "material": "m"});
        assert_eq!(curvature(&built(&flat, false), [0.1, 0.1, 9.0], [0.1, 0.1, 0.0]), 0.0);
    }

    /// A mesh with the normals of a ball bends as the ball, also where it is scaled; without normals it is flat.
    #[test]
    fn smooth_meshes_bend_by_their_normals() {
        let corners =
            [[0.1, 0.05], [-0.1, 0.08], [0.02, -0.12]].map(|[x, y]: [f64; 2]| [x, y, (4.0 - x * x - y * y).sqrt()]);
        for (smooth, dynamic, scale) in
            [(true, false, 1.0), (true, true, 1.0), (true, false, 3.0), (true, true, -3.0), (false, false, 1.0)]
        {
            let mesh = json!({"geometry": "mesh", "material": "m", "positions": corners, "normals": corners,
                "triangles": [[0, 1, 2]], "shading": if smooth { "smooth" } else { "flat" }, "transform": [{"scale": scale}]});
            let expected = if smooth { 0.5 / f64::abs(scale) } else { 0.0 };
            let [from, towards] = [9.0_f64, 0.0].map(|z| [0.0, 0.0, z.copysign(scale)]);
            let found = f64::from(curvature(&built(&mesh, dynamic), from, towards));
            assert!((found - expected).abs() < 1e-3 * expected.max(1e-3), "{found}, not {expected}: {dynamic} {scale}");
        }
    }
}
