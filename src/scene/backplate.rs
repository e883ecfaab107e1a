//! The picture that the camera sees behind everything.
//!
//! It belongs to the camera: light transport does not know of it, so that it lights nothing, and a scene without one pays nothing. A
//! pass looks it up for each camera ray that met nothing (`render/pass/measurement.rs`).

use std::sync::Arc;

use super::SurfaceDetail;
use super::prepared_textures::{PreparedTextures, Reads};
use super::textured::Placement;
use crate::desc::{ImageTextureDesc, SceneDesc, TextureDesc, TextureMapping, TextureSource};
use crate::embree::Device;
use crate::error::{Error, Result};
use crate::math::{DVec3, Vec3};
use crate::spectrum::Rgb;
use crate::texture::{Texture, Wrap};

/// A picture in film coordinates.
#[derive(Debug)]
pub(crate) struct Backplate {
    radiance: Rgb,
    /// What varies the radiance, and where it lies.
    texture: Option<(Arc<Texture>, Placement)>,
}

impl Backplate {
    /// The backplate of a description whose textures have been checked; `None` where there is none.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for a radiance beyond single precision; `OutOfMemory` beyond the device's allowance.
    pub(super) fn new(
        desc: &SceneDesc,
        textures: &mut PreparedTextures,
        before: Option<&PreparedTextures>,
        device: &Device,
    ) -> Result<Option<Self>> {
        let Some(backplate) = &desc.backplate else { return Ok(None) };
        let radiance = backplate.radiance;
        let Some(described) = backplate.texture.and_then(|number| desc.textures.get(number)) else {
            return Ok(Some(Self { radiance, texture: None }));
        };
        let texture = textures.get(&shown_once(described), Reads::Color, before, device)?;
        let most = texture.range()[1];
        if !(radiance * Rgb::new(most[0], most[1], most[2])).is_finite() {
            let [factor, most] = [radiance.to_array(), [most[0], most[1], most[2]]];
            let message = format!("{factor:?} times its texture, which is up to {most:?}, is beyond single precision");
            return Err(Error::invalid("backplate.color", message));
        }
        // A pattern in space lies on the film, wherever the scene's origin is.
        let placement = Placement::new(&described.mapping, DVec3::ZERO);
        Ok(Some(Self { radiance, texture: Some((texture, placement)) }))
    }

    /// The radiance at a place of a picture, both in pixels from the upper left corner.
    pub fn radiance_at(&self, [x, y]: [f32; 2], picture: [u32; 2]) -> Rgb {
        let Some((texture, placement)) = &self.texture else { return self.radiance };
        let [width, height] = picture.map(|pixels| pixels.max(1) as f32);
        // Rows go down and v goes up.
        let [u, v] = [x / width, 1.0 - y / height];
        let place = Vec3::new(u, v, 0.0);
        let detail =
            SurfaceDetail::without_tangents([u, v], 1.0 / width.max(height), [Vec3::Z, Vec3::Z, place, Vec3::Z]);
        let mut point = placement.point(&detail, false);
        if let Placement::Uv { matrix, .. } = placement {
            point.axes = [[1.0 / width, 0.0], [0.0, 1.0 / height]].map(|[u, v]| matrix.map(|[a, b]| a * u + b * v));
        }
        let [r, g, b, _] = texture.at(&point);
        (self.radiance * Rgb::new(r, g, b)).max(Rgb::ZERO)
    }
}

/// The texture as a backplate reads it. An image that is neither scaled, turned nor moved is in the picture once and whole, so that its
/// edges must not show what is at the opposite ones.
fn shown_once(desc: &Arc<TextureDesc>) -> Arc<TextureDesc> {
    match &desc.source {
        TextureSource::Image(image) if desc.mapping == TextureMapping::default() => {
            let source = TextureSource::Image(ImageTextureDesc { wrap: [Wrap::Clamp; 2], ..image.clone() });
            Arc::new(TextureDesc { source, ..TextureDesc::clone(desc) })
        }
        _ => Arc::clone(desc),
    }
}
