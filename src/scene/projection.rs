//! Texture coordinates by a projection of the world, for surfaces that have none of their own.

use super::SurfaceDetail;
use crate::desc::{Projection, TextureMapping};
use crate::math::{DVec3, Vec3};

/// A projection, and the origin of the scene frame in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    pub projection: Projection,
    pub centre: DVec3,
}

/// Which texture coordinates a texture has.
#[derive(Clone, Copy, Debug)]
pub(super) enum Coordinates {
    /// Those of the surface, or of no surface.
    Own,
    /// Those of a further set of the mesh.
    Set(u32),
    /// Those of a projection.
    Projected(Projected),
}

impl Coordinates {
    /// `centre` is the origin of the scene frame.
    pub fn new(mapping: &TextureMapping, centre: DVec3) -> Self {
        match *mapping {
            TextureMapping::Projected { projection, .. } => Self::Projected(Projected { projection, centre }),
            TextureMapping::Uv { set, .. } if set > 0 => Self::Set(set),
            TextureMapping::Uv { .. } | TextureMapping::Space { .. } => Self::Own,
        }
    }

    /// The same point of the surface with these coordinates and their tangents.
    pub fn apply<'a>(&self, at: &SurfaceDetail<'a>) -> SurfaceDetail<'a> {
        match self {
            Self::Own => *at,
            Self::Set(set) => at.with_set(*set),
            Self::Projected(projected) => projected.apply(at),
        }
    }
}

/// The directions in which the two coordinates grow, for surfaces that face along an axis (0, 1, 2) or against it, so that the image
/// is upright and not mirrored from outside.
fn directions(axis: usize, is_positive: bool) -> [Vec3; 2] {
    let side = if is_positive { 1.0 } else { -1.0 };
    match axis {
        0 => [Vec3::new(0.0, 0.0, -side), Vec3::Y],
        1 => [Vec3::X, Vec3::new(0.0, 0.0, -side)],
        _ => [Vec3::new(side, 0.0, 0.0), Vec3::Y],
    }
}

impl Projected {
    /// The same point of the surface with the coordinates and tangents of the projection.
    pub fn apply<'a>(&self, at: &SurfaceDetail<'a>) -> SurfaceDetail<'a> {
        let normal = at.ng;
        let [eu, ev] = match self.projection {
            Projection::X => directions(0, true),
            Projection::Y => directions(1, true),
            Projection::Z => directions(2, true),
            Projection::Box => {
                let size = normal.abs();
                let axis = if size.x >= size.y && size.x >= size.z {
                    0
                } else if size.y >= size.z {
                    1
                } else {
                    2
                };
                directions(axis, normal.to_array()[axis] >= 0.0)
            }
        };
        let p = at.p.as_dvec3() + self.centre;
        let uv = [eu, ev].map(|e| e.as_dvec3().dot(p) as f32);
        // Along the surface, so that one coordinate changes with the length and the other one does not.
        let [mut dpdu, mut dpdv] = [ev.cross(normal), normal.cross(eu)];
        (dpdu, dpdv) = (dpdu / eu.dot(dpdu), dpdv / ev.dot(dpdv));
        if !(dpdu.is_finite() && dpdv.is_finite()) {
            // The surface is seen along its edge.
            (dpdu, dpdv) = (eu, ev);
        }
        SurfaceDetail { uv, dpdu, dpdv, map_tangent: None, ..*at }
    }
}
