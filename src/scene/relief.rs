//! Normals from maps of normals and heights, and what a filter averages of them away.

use super::SurfaceDetail;
use super::textured::{Bound, Placement};
use crate::desc::TextureKey;
use crate::math::Vec3;
use crate::texture::{Texel, Texture, variances};

/// The texture of a material's normals: a map of normals, or of heights.
#[derive(Debug)]
pub(super) struct Relief {
    pub bound: Bound,
    /// Whether the texture gives slopes and their squares, which a filter has averaged.
    pub has_slopes: bool,
}

impl Relief {
    /// The normal at a point, of any length.
    pub fn normal(&self, at: &SurfaceDetail) -> Vec3 {
        let own = self.bound.coordinates.apply(at);
        let slopes = self.has_slopes.then(|| self.bound.texel_at(&own));
        if self.bound.key == TextureKey::Bump {
            return bumped(&self.bound, slopes, &own);
        }
        let direction = slopes.map_or_else(
            || {
                let [x, y, z, _] = self.bound.texel_at(&own);
                [x, y, z].map(|x| 2.0 * x - 1.0)
            },
            |[x, y, ..]| [x, y, 1.0],
        );
        mapped(&self.bound, direction, &own)
    }

    /// The variance of the slopes that a filter has averaged at a point, as the mean of those along two directions of the surface; 0
    /// where nothing is averaged.
    pub fn variance(&self, at: &SurfaceDetail) -> f32 {
        if !self.has_slopes {
            return 0.0;
        }
        let own = self.bound.coordinates.apply(at);
        let [a, b] = variances(self.bound.texel_at(&own));
        let [along, across] = match self.bound.key {
            TextureKey::Bump => {
                // The two slopes of a texture are taken to vary independently. The shading normal may be that of the heights already.
                let Some(directions) = directions(&own, own.ng) else { return 0.0 };
                let [hu, hv] = by_own_coordinates(&self.bound.placement, |[m, n]| m * m * a + n * n * b);
                by_lengths(&own, directions).map(|[m, n]| m * m * hu + n * n * hv)
            }
            _ => [a, b],
        };
        let variance = 0.5 * self.bound.strength * self.bound.strength * (along + across);
        if variance.is_finite() { variance } else { 0.0 }
    }
}

/// The normal of a normal map: its x along the tangent, its y to the side to which the second texture coordinate grows.
fn mapped(bound: &Bound, [x, y, z]: [f32; 3], at: &SurfaceDetail) -> Vec3 {
    let (x, y) = (bound.strength * x, bound.strength * y);
    let frame = |along: Vec3, to_side: Vec3| {
        let tangent = (along - along.dot(at.ns) * at.ns).try_normalize()?;
        let across = at.ns.cross(tangent);
        Some([tangent, if across.dot(to_side) < 0.0 { -across } else { across }])
    };
    // Directions of the image are turned as the tangent of normal maps is from the derivative of the position.
    let frames = frame(at.dpdu, at.dpdv).zip(frame(at.map_tangent.unwrap_or(at.dpdu), at.dpdv));
    let Some(([s, t], [map_s, map_t])) = frames else { return at.ns };
    let [along, to_side] = bound.placement.tangents([at.dpdu, at.dpdv]).map(|it| it.dot(s) * map_s + it.dot(t) * map_t);
    let Some([tangent, across]) = frame(along, to_side) else { return at.ns };
    x * tangent + y * across + z * at.ns
}

/// The growth of a height with the two coordinates of its texture, from that along the surface's own: by the matrix of the texture's
/// placement.
fn by_own_coordinates(placement: &Placement, of_texture: impl Fn([f32; 2]) -> f32) -> [f32; 2] {
    let Placement::Uv { matrix: [[a, b], [c, d]], .. } = *placement else { return [0.0; 2] };
    [of_texture([a, c]), of_texture([b, d])]
}

/// Two unit directions across the normal `n`, the first of them that in which u grows.
fn directions(at: &SurfaceDetail, n: Vec3) -> Option<[Vec3; 2]> {
    let s = (at.dpdu - at.dpdu.dot(n) * n).try_normalize()?;
    Some([s, n.cross(s)])
}

/// The directions of [`directions`] in terms of the derivatives of the position: each row makes the slope along one of them from the
/// growth with u and v.
fn by_lengths(at: &SurfaceDetail, [s, t]: [Vec3; 2]) -> [[f32; 2]; 2] {
    let (u, v) = ([at.dpdu.dot(s), at.dpdu.dot(t)], [at.dpdv.dot(s), at.dpdv.dot(t)]);
    let determinant = u[0] * v[1] - u[1] * v[0];
    [[v[1] / determinant, -u[1] / determinant], [-v[0] / determinant, u[0] / determinant]]
}

/// The normal of a surface that is raised by a height (Blinn 1978): ns - dh/ds over the two directions of the surface.
fn bumped(bound: &Bound, slopes: Option<Texel>, at: &SurfaceDetail) -> Vec3 {
    let Some([s, t]) = directions(at, at.ns) else { return at.ns };
    /// Smallest step, of a coordinate.
    const FINEST_STEP: f32 = 1.0 / (1 << 18) as f32;
    // Half a texel.
    let step = match &*bound.texture {
        Texture::Image(image) => 0.5 / image.texels_across() as f32,
        Texture::Procedural(..) | Texture::White => 1e-3,
    };
    let height = |at: &SurfaceDetail| bound.number(&bound.texel_at(at));
    // The step is in texture coordinates, or in lengths for patterns in space.
    let (along, across) = match bound.placement {
        Placement::Uv { matrix, .. } => {
            let size = matrix.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs())).max(1e-6);
            let moved = |i: usize| {
                // Far from 0 single precision knows no smaller steps; the one that was taken counts.
                let step = (step / size).max(at.uv[i].abs() * FINEST_STEP);
                let (mut there, mut back) = (*at, *at);
                there.uv[i] += step;
                back.uv[i] -= step;
                bound.strength * (height(&there) - height(&back)) / (there.uv[i] - back.uv[i])
            };
            let [hu, hv] = match slopes {
                Some([a, b, ..]) => by_own_coordinates(&bound.placement, |[m, n]| bound.strength * (m * a + n * b)),
                None => [0, 1].map(moved),
            };
            let [along, across] = by_lengths(at, [s, t]).map(|[m, n]| m * hu + n * hv);
            (along, across)
        }
        Placement::Space { scale, .. } => {
            let step = step / scale.abs().max_element().max(1e-6) as f32;
            let step = step.max(at.p.abs().max_element() * FINEST_STEP);
            let slope = |direction: Vec3| {
                let there = SurfaceDetail { p: at.p + step * direction, ..*at };
                let back = SurfaceDetail { p: at.p - step * direction, ..*at };
                bound.strength * (height(&there) - height(&back)) / (2.0 * step)
            };
            (slope(s), slope(t))
        }
    };
    at.ns - along * s - across * t
}
