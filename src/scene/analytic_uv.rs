//! Texture coordinates of spheres, disks and quadrics.

use std::f64::consts::{PI, TAU};

use super::Scene;
use super::geometry::Geometry;
use super::hit::{Hit, IN_LIST};
use crate::desc::ShapeDesc;
use crate::math::{DAffine3, DVec3, Vec3};
use crate::shape::Sphere;

/// Texture coordinates and the derivatives of the position by them.
pub(super) type Parameters = ([f32; 2], Option<[Vec3; 2]>);

impl Scene {
    /// The texture coordinates of a point of an analytic shape, by the point in the frame of the shape; `None` for other shapes.
    ///
    /// - Spheres: the image goes once around the y axis, to the right as it is seen from outside, with its middle towards +z; v grows
    ///   with the latitude, from 0 at -y to 1 at +y.
    /// - Disks: the image lies in the square around the disk, upright where y is upwards, to the right as it is seen from the normal's
    ///   side.
    /// - Quadrics: u goes once around the z axis of the quadric's own frame (the axis of a cylinder, cone or paraboloid), from the x axis
    ///   to the y axis; v grows along z, from 0 to 1 between the faces of the clip box.
    pub(super) fn analytic_parameters(&self, hit: &Hit, p: Vec3, time: f32) -> Option<Parameters> {
        let owner = if hit.geometry == IN_LIST {
            self.bindings.list_owners.get(hit.primitive as usize)?
        } else {
            &self.bindings.owners.get(hit.geometry as usize)?.of(hit.primitive)
        };
        let (shape, to_world) = self.record.placed(owner.surface)?;
        let to_world = match self.geometries.get(hit.geometry as usize) {
            Some(Geometry::Analytic { shapes, .. }) if !shapes.moving.is_empty() => {
                DAffine3::from_translation(self.centre) * shapes.moving[hit.primitive as usize].to_scene(time)
            }
            _ => to_world,
        };
        let local = to_world.inverse().transform_point3(p.as_dvec3() + self.centre);
        let (uv, tangents) = match *shape {
            ShapeDesc::Sphere { centre, radius } => on_sphere(local - centre, radius),
            ShapeDesc::Disk { centre, normal, radius } => on_disk(local - centre, normal, radius),
            ShapeDesc::Quadric { ref coefficients, clip } => {
                let heights = [clip.min.z, clip.max.z];
                let heights = if heights.iter().all(|z| z.is_finite()) { heights } else { [0.0, 1.0] };
                on_quadric(local, coefficients, heights)
            }
            _ => return None,
        };
        let tangents = tangents.map(|tangents| tangents.map(|tangent| (to_world.matrix3 * tangent).as_vec3a()));
        Some((uv.map(|x| x as f32), tangents.filter(|both| both.iter().all(|t| t.is_finite() && *t != Vec3::ZERO))))
    }
}

fn on_sphere(p: DVec3, radius: f64) -> ([f64; 2], Option<[DVec3; 2]>) {
    let d = p.normalize_or_zero();
    let level = d.x.hypot(d.z);
    let uv = Sphere::texture_coordinates(d);
    // At the poles u has no direction.
    let tangents = (level > 1e-9).then(|| {
        let upwards = DVec3::new(-d.x * d.y / level, level, -d.z * d.y / level);
        [TAU * radius * DVec3::new(d.z, 0.0, -d.x), PI * radius * upwards]
    });
    (uv, tangents)
}

fn on_disk(p: DVec3, normal: DVec3, radius: f64) -> ([f64; 2], Option<[DVec3; 2]>) {
    let right = DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X);
    let up = normal.cross(right);
    let uv = [right, up].map(|axis| 0.5 + 0.5 * p.dot(axis) / radius);
    (uv, Some([2.0 * radius * right, 2.0 * radius * up]))
}

fn on_quadric(
    p: DVec3,
    [a, b, c, d, e, f, g, h, i, _]: &[f64; 10],
    [low, high]: [f64; 2],
) -> ([f64; 2], Option<[DVec3; 2]>) {
    let turn = p.y.atan2(p.x) / TAU;
    let uv = [turn - turn.floor(), (p.z - low) / (high - low)];
    let gradient =
        DVec3::new(a * p.x + d * p.y + f * p.z + g, d * p.x + b * p.y + e * p.z + h, f * p.x + e * p.y + c * p.z + i);
    let n = gradient.normalize_or_zero();
    let radius2 = p.x * p.x + p.y * p.y;
    // Along the surface at one height, and along it in a plane through the axis.
    let around = DVec3::Z.cross(n);
    let rate = (p.x * around.y - p.y * around.x) / radius2;
    let upwards = n.cross(DVec3::new(-p.y, p.x, 0.0));
    let tangents = [around * (TAU / rate), upwards * ((high - low) / upwards.z)];
    (uv, Some(tangents))
}
