//! Light from infinity that a texture varies.

use std::sync::Arc;

use super::SurfaceDetail;
use super::prepared_textures::color_space;
use super::textured::Placement;
use crate::Cancel;
use crate::desc::{EnvironmentDesc, EnvironmentMapDesc, SceneDesc, TextureMapping, TextureSource};
use crate::emitter::{EnvironmentMap, SkyTexture, TexturedRadiance};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{DVec3, Vec3};
use crate::spectrum::Rgb;
use crate::texture::{ImageTexture, Texture, TextureFilter, TexturePoint, Wrap};

/// The light of an environment with a texture; `None` where it is black. Its tables are made by at most `threads` threads.
///
/// # Errors
/// [`ErrorKind::InvalidScene`] for a radiance beyond single precision; [`ErrorKind::Cancelled`].
pub(super) fn environment_map(
    desc: &SceneDesc,
    environment: &EnvironmentDesc,
    map: &EnvironmentMapDesc,
    threads: usize,
    cancel: &Cancel,
) -> Result<Option<EnvironmentMap>> {
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
    let place: Option<Arc<dyn SkyTexture>> = match texture.mapping {
        mapping if mapping == TextureMapping::default() => None,
        // A direction is a point of the unit sphere, wherever the scene's origin is.
        mapping => Some(Arc::new(InSky(Placement::new(&mapping, DVec3::ZERO)))),
    };
    let radiance = TexturedRadiance::of_texture(Arc::new(shown), environment.radiance, None);
    EnvironmentMap::new(radiance, place, &map.to_world(), threads, cancel)
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
