//! Textures of emission: what of them lies on each triangle that emits.

use std::sync::Arc;

use super::SurfaceDetail;
use super::prepared_textures::color_space;
use super::projection::Coordinates;
use super::textured::{Placement, channel_of};
use crate::desc::{SceneDesc, ShapeDesc, SurfaceDesc, TextureBinding, TextureKey, TextureSource};
use crate::emitter::{Emitter, TextureCorners, TexturedTriangle};
use crate::error::{Error, ErrorKind, Result};
use crate::math::DVec3;
use crate::shape::Triangle;
use crate::spectrum::Rgb;
use crate::texture::{ImageTexture, Texture, TextureFilter, TextureLight};

/// Most parts of triangles in a scene: a hundred megabytes.
pub(super) const MOST_PIECES: usize = 1 << 20;

/// The texture of a material's emission.
#[derive(Clone, Debug)]
pub(super) struct EmissionTexture {
    light: TextureLight,
    coordinates: Coordinates,
    placement: Placement,
    channel: Option<usize>,
}

/// The texture that varies the emission of a surface, if any does.
pub(super) fn binding_of<'a>(desc: &'a SceneDesc, surface: &SurfaceDesc) -> Option<&'a TextureBinding> {
    surface.emission.and(desc.materials.get(surface.material)?.textured(TextureKey::Emission))
}

/// The textures of emission by material; empty where there are none. `centre` is the origin of the scene frame.
///
/// # Errors
/// [`ErrorKind::Unsupported`] for a sphere whose emission a texture varies; [`ErrorKind::InvalidScene`] for a radiance beyond single
/// precision.
pub(super) fn emission_textures(
    desc: &SceneDesc,
    centre: DVec3,
    threads: usize,
) -> Result<Vec<Option<EmissionTexture>>> {
    if desc.materials.iter().all(|material| material.textured(TextureKey::Emission).is_none()) {
        return Ok(Vec::new());
    }
    let mut surfaces = desc.surfaces.iter().filter(|surface| !surface.hidden);
    let is_ball = |surface: &&SurfaceDesc| {
        matches!(surface.shape, ShapeDesc::Sphere { .. }) && binding_of(desc, surface).is_some()
    };
    if let Some(ball) = surfaces.find(is_ball) {
        let message = "a texture cannot vary the emission of a sphere, expected a mesh";
        return Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.emission", ball.path)));
    }
    let of = |binding: &TextureBinding| EmissionTexture::new(desc, binding, centre, threads);
    let all = desc.materials.iter().map(|material| material.textured(TextureKey::Emission).and_then(of));
    let all: Vec<Option<EmissionTexture>> = all.collect();
    for surface in desc.surfaces.iter().filter(|surface| !surface.hidden) {
        if let (Some(Some(texture)), Some(factor)) = (all.get(surface.material), surface.emission) {
            texture.check(factor).map_err(|error| error.at(format!("{}.emission", surface.path)))?;
        }
    }
    Ok(all)
}

impl EmissionTexture {
    fn new(desc: &SceneDesc, binding: &TextureBinding, centre: DVec3, threads: usize) -> Option<Self> {
        let texture = desc.textures.get(binding.texture)?;
        let shown = match &texture.source {
            TextureSource::Image(it) => {
                // Light samples, rays and photons have to see the same radiance, and know no footprints.
                let filter = if it.filter.asks_footprint() { TextureFilter::Bilinear } else { it.filter };
                let space = color_space(it, true);
                Texture::Image(ImageTexture::by_threads(Arc::clone(&it.image), space, it.wrap, filter, threads))
            }
            TextureSource::Procedural(it) => Texture::procedural(*it),
            TextureSource::White => Texture::White,
        };
        Some(Self {
            light: TextureLight::new(Arc::new(shown), threads),
            coordinates: Coordinates::new(&texture.mapping, centre),
            placement: Placement::new(&texture.mapping, centre),
            channel: channel_of(binding.channel),
        })
    }

    /// Checks that single precision holds the brightest radiance.
    fn check(&self, factor: Rgb) -> Result<()> {
        let most = self.light.texture().range()[1];
        let brightest = self.channel.map_or(Rgb::new(most[0], most[1], most[2]), |channel| Rgb::splat(most[channel]));
        if (factor * brightest).is_finite() {
            return Ok(());
        }
        let [factor, brightest] = [factor, brightest].map(Rgb::to_array);
        let message = format!("{factor:?} times its texture, which is up to {brightest:?}, is beyond single precision");
        Err(Error::new(ErrorKind::InvalidScene, message))
    }

    /// The set of texture coordinates that the texture reads.
    pub fn uv_set(&self) -> u32 {
        if let Coordinates::Set(set) = self.coordinates { set } else { 0 }
    }

    /// The emitter of a triangle whose corners have these texture coordinates.
    /// `pieces_left` is the room for parts of triangles.
    pub fn emitter(
        &self,
        triangle: Triangle,
        error: f32,
        factor: Rgb,
        uvs: [[f32; 2]; 3],
        pieces_left: &mut usize,
    ) -> Emitter {
        let ng = triangle.normal;
        let points = [0, 1, 2].map(|i: usize| {
            let at = SurfaceDetail::without_tangents(uvs[i], 0.0, [ng, ng, triangle.vertices[i], ng]);
            self.placement.point(&self.coordinates.apply(&at), false)
        });
        let corners = match self.placement {
            Placement::Uv { .. } => TextureCorners::Uv(points.map(|point| point.uv)),
            Placement::Space { .. } => TextureCorners::Space(points.map(|point| point.p)),
        };
        let light = &self.light;
        let emitter = TexturedTriangle::new(triangle, error, factor, light, self.channel, corners, pieces_left);
        if emitter.is_dark() {
            // It keeps its number, but nothing asks its texture.
            return Emitter::Triangle(emitter.mean);
        }
        Emitter::Textured(Box::new(emitter))
    }
}
