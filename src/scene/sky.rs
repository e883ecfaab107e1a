//! Light from infinity that varies by direction.

use std::sync::Arc;

use super::SurfaceDetail;
use super::prepared_textures::color_space;
use super::textured::Placement;
use crate::Cancel;
use crate::desc::{
    EnvironmentDesc, EnvironmentMapDesc, SceneDesc, SkyDesc, SkyProjection, TextureMapping, TextureSource,
};
use crate::emitter::{EnvironmentMap, EvenSky, Sky, SkyTexture, TexturedRadiance};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{DMat3, DVec3, Vec3};
use crate::spectrum::Rgb;
use crate::texture::{ImageTexture, Texture, TextureFilter, TexturePoint, Wrap};

/// The light of an environment that varies by direction; `None` where it is black. Its tables are made by at most `threads` threads.
///
/// # Errors
/// [`ErrorKind::InvalidScene`] for a radiance beyond single precision; [`ErrorKind::Cancelled`].
pub(super) fn environment_map(
    desc: &SceneDesc,
    environment: &EnvironmentDesc,
    threads: usize,
    cancel: &Cancel,
) -> Result<Option<EnvironmentMap>> {
    let map = match &environment.sky {
        SkyDesc::Even => {
            // Without portals it would be a light of its own.
            let sky = Sky::Model(Box::new(EvenSky(environment.radiance)));
            return EnvironmentMap::new(sky, &DMat3::IDENTITY, threads, cancel);
        }
        SkyDesc::Formula(sky) => {
            let Some(model) = sky.model(environment.radiance) else { return Ok(None) };
            return EnvironmentMap::new(Sky::Model(Box::new(model)), &sky.to_world(), threads, cancel);
        }
        SkyDesc::HosekWilkie(sky) => {
            let model = sky.model(environment.radiance);
            return EnvironmentMap::new(Sky::Model(Box::new(model)), &sky.to_world(), threads, cancel);
        }
        SkyDesc::Map(map) => map,
    };
    let Some(texture) = desc.textures.get(map.texture) else { return Ok(None) };
    let shown = match &texture.source {
        TextureSource::Image(it) => {
            // Light samples, rays and photons have to see the same radiance, and know no footprints.
            let filter = if it.filter.asks_footprint() { TextureFilter::Bilinear } else { it.filter };
            // The image goes around the sphere and ends at the poles.
            let wrap = [Wrap::Repeat, Wrap::Clamp];
            Texture::Image(ImageTexture::by_threads(
                Arc::clone(&it.image),
                color_space(it, true),
                wrap,
                filter,
                threads,
            ))
        }
        TextureSource::Procedural(it) => Texture::procedural(*it),
        TextureSource::White => Texture::White,
    };
    let most = shown.range()[1];
    if !(environment.radiance * Rgb::new(most[0], most[1], most[2])).is_finite() {
        let [factor, most] = [environment.radiance.to_array(), [most[0], most[1], most[2]]];
        let message = format!("{factor:?} times its texture, which is up to {most:?}, is beyond single precision");
        return Err(Error::new(ErrorKind::InvalidScene, message).at(format!("{}.color", environment.path)));
    }
    let to_world = map.to_world();
    let place: Option<Arc<dyn SkyTexture>> = match texture.mapping {
        _ if map.projection != SkyProjection::LatLong => Some(Arc::new(Unfolded::new(&shown, map, &to_world))),
        mapping if mapping == TextureMapping::default() => None,
        // A direction is a point of the unit sphere, wherever the scene's origin is.
        mapping => Some(Arc::new(InSky(Placement::new(&mapping, DVec3::ZERO)))),
    };
    let radiance = TexturedRadiance::of_texture(Arc::new(shown), environment.radiance, None);
    let sky = match place {
        None => Sky::Texture(radiance),
        Some(place) => Sky::Unfolded(radiance, place),
    };
    EnvironmentMap::new(sky, &to_world, threads, cancel)
}

/// A texture that lies otherwise than by longitude and latitude.
#[derive(Debug)]
struct InSky(Placement);

impl SkyTexture for InSky {
    fn point(&self, direction: Vec3, uv: [f32; 2]) -> TexturePoint {
        let vectors = [direction, direction, direction, direction];
        self.0.point(&SurfaceDetail::without_tangents(uv, 0.0, vectors), false)
    }
}

/// An image of the faces of a solid.
#[derive(Debug)]
struct Unfolded {
    /// Axes of the image's frame in the scene frame.
    axes: [Vec3; 3],
    is_cube: bool,
    /// Half a texel of a face, by which lookups stay inside of it: beyond its edge lies another face.
    half_texel: f32,
}

impl Unfolded {
    fn new(image: &Texture, map: &EnvironmentMapDesc, to_world: &DMat3) -> Self {
        let axes = [to_world.x_axis, to_world.y_axis, to_world.z_axis].map(|axis| axis.as_vec3a());
        let half_texel = 0.5 / image.texels()[0].max(1) as f32;
        Self { axes, is_cube: map.projection == SkyProjection::Cube, half_texel }
    }
}

impl SkyTexture for Unfolded {
    fn point(&self, direction: Vec3, _: [f32; 2]) -> TexturePoint {
        let d = self.axes.map(|axis| axis.dot(direction));
        let uv = if self.is_cube {
            let (face, place) = on_cube(d);
            let [s, t] = place.map(|x| x.clamp(self.half_texel, 1.0 - self.half_texel));
            [s, 1.0 - (face as f32 + t) / 6.0]
        } else {
            on_octahedron(d).map(|x| x.clamp(self.half_texel, 1.0 - self.half_texel))
        };
        TexturePoint { uv, ..TexturePoint::default() }
    }
}

/// The face of a cube that a direction meets, and the place in it to the right and down (OpenGL 4.6, table 8.19).
fn on_cube([x, y, z]: [f32; 3]) -> (usize, [f32; 2]) {
    let [along_x, along_y, along_z] = [x, y, z].map(f32::abs);
    let (face, right, down, depth) = if along_x >= along_y && along_x >= along_z {
        if x > 0.0 { (0, -z, -y, along_x) } else { (1, z, -y, along_x) }
    } else if along_y >= along_z {
        if y > 0.0 { (2, x, z, along_y) } else { (3, x, -z, along_y) }
    } else if z > 0.0 {
        (4, x, -y, along_z)
    } else {
        (5, -x, -y, along_z)
    };
    (face, [right, down].map(|c| 0.5 + 0.5 * c / depth))
}

/// The place of a direction in the square of the unfolded octahedron, to the right and up.
fn on_octahedron([x, y, z]: [f32; 3]) -> [f32; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let [u, v] = [x / sum, -z / sum];
    let [u, v] = if y >= 0.0 {
        [u, v]
    } else {
        // The lower faces are turned out over the edges of the upper ones.
        [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)]
    };
    [0.5 + 0.5 * u, 0.5 + 0.5 * v]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_a_cube_lie_as_graphics_cards_have_them() {
        // The middle of each face, and where its right and lower edges are.
        for (face, middle, right, down) in [
            (0, Vec3::X, -Vec3::Z, -Vec3::Y),
            (1, -Vec3::X, Vec3::Z, -Vec3::Y),
            (2, Vec3::Y, Vec3::X, Vec3::Z),
            (3, -Vec3::Y, Vec3::X, -Vec3::Z),
            (4, Vec3::Z, Vec3::X, -Vec3::Y),
            (5, -Vec3::Z, -Vec3::X, -Vec3::Y),
        ] {
            assert_eq!(on_cube(middle.to_array()), (face, [0.5, 0.5]));
            let (found, [s, t]) = on_cube((middle + 0.5 * right - 0.25 * down).normalize().to_array());
            assert!(found == face && (s - 0.75).abs() < 1e-6 && (t - 0.375).abs() < 1e-6, "{face}: {found} {s} {t}");
        }
    }

    #[test]
    fn faces_of_an_octahedron_unfold_into_a_square() {
        for (direction, expected) in [
            (Vec3::Y, [0.5, 0.5]),
            (Vec3::X, [1.0, 0.5]),
            (-Vec3::Z, [0.5, 1.0]),
            (Vec3::Z, [0.5, 0.0]),
            (Vec3::new(0.5, 0.0, -0.5), [0.75, 0.75]),
            (Vec3::new(1e-9, -1.0, -1e-9), [1.0, 1.0]),
            (Vec3::new(-1e-9, -1.0, 1e-9), [0.0, 0.0]),
            (Vec3::new(0.5, -0.5, -1e-9), [1.0, 0.75]),
        ] {
            let found = on_octahedron(direction.to_array());
            let near = (found[0] - expected[0]).abs() < 1e-6 && (found[1] - expected[1]).abs() < 1e-6;
            assert!(near, "{direction}: {found:?}");
        }
    }
}
