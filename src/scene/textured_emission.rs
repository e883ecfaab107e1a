//! Textures of emission: what of them lies on each triangle and on each sphere that emits.

use std::f32::consts::PI;
use std::sync::Arc;

use super::SurfaceDetail;
use super::prepared_textures::color_space;
use super::projection::Coordinates;
use super::textured::{Placement, channel_of};
use crate::desc::{
    ImageTextureDesc, MaterialDesc, SceneDesc, ShapeDesc, SpectrumDesc, SpectrumKey, SurfaceDesc, TextureBinding,
    TextureKey, TextureSource,
};
use crate::emitter::{Emitter, SphereTexture, TextureCorners, TexturedRadiance, TexturedSphere, TexturedTriangle};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{DAffine3, DVec3, Vec3};
use crate::shape::{Sphere, Triangle};
use crate::spectrum::{BLACK_BODY_TEMPERATURES, Rgb, black_body_color, black_body_luminance, luminance};
use crate::texture::{
    ColorSpace, ImageTexture, TexelImage, Texels, Texture, TextureFilter, TextureLight, TexturePoint,
};

/// Most parts of triangles and spheres in a scene: a hundred megabytes.
pub(super) const MOST_PIECES: usize = 1 << 20;

/// The texture of a material's emission.
#[derive(Clone, Debug)]
pub(super) struct EmissionTexture {
    light: TextureLight,
    coordinates: Coordinates,
    placement: Placement,
    channel: Option<usize>,
    /// Whether it is that of a black body.
    is_planckian: bool,
}

/// The texture that varies the emission of a surface, if any does.
pub(super) fn binding_of<'a>(desc: &'a SceneDesc, surface: &SurfaceDesc) -> Option<&'a TextureBinding> {
    surface.emission.and(texture_of_light(desc.material_of(surface)?))
}

/// The texture that varies what a material emits: the radiance, or the temperature of a black body.
pub(super) fn texture_of_light(material: &MaterialDesc) -> Option<&TextureBinding> {
    material.textured(TextureKey::Emission).or_else(|| material.textured(TextureKey::Temperature))
}

/// The temperature \[K\] of a material that emits as a black body.
fn kelvin_of(material: &MaterialDesc) -> Option<f64> {
    match material.spectrum(SpectrumKey::Emission) {
        Some(SpectrumDesc::BlackBody(kelvin)) => Some(*kelvin),
        _ => None,
    }
}

/// Bytes of an image of the light of temperatures.
pub(super) fn bytes_of_light(image: &TexelImage) -> usize {
    3 * size_of::<f32>() * image.width() as usize * image.height() as usize
}

/// The textures of emission by material; empty where there are none. `centre` is the origin of the scene frame.
///
/// # Errors
/// [`ErrorKind::InvalidScene`] for a radiance beyond single precision.
pub(super) fn emission_textures(
    desc: &SceneDesc,
    centre: DVec3,
    threads: usize,
) -> Result<Vec<Option<EmissionTexture>>> {
    if desc.materials.iter().all(|material| texture_of_light(material).is_none()) {
        return Ok(Vec::new());
    }
    let all = desc.materials.iter().map(|material| {
        let Some(binding) = texture_of_light(material) else { return Ok(None) };
        let made = EmissionTexture::new(desc, material, binding, centre, threads);
        made.map_err(|error| error.at(format!("{}.textures.{}", material.path, binding.key.name())))
    });
    let all: Vec<Option<EmissionTexture>> = all.collect::<Result<_>>()?;
    let lamps = desc.surfaces.of_blocks(|facts| facts.emits);
    for (_, surface) in lamps.filter(|(_, surface)| !surface.hidden) {
        let texture = surface.material.and_then(|material| all.get(material)?.as_ref());
        if let (Some(texture), Some(factor)) = (texture, surface.emission) {
            if matches!(surface.shape, ShapeDesc::Disk { .. } | ShapeDesc::Quadric { .. }) {
                let message =
                    "a texture varies the emission, which it can on spheres, triangles, quads and meshes only";
                return Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.emission", surface.path)));
            }
            if texture.is_planckian
                && surface.spectrum.as_ref()
                    != desc.material_of(surface).and_then(|it| it.spectrum(SpectrumKey::Emission))
            {
                let message = "a texture varies the temperature of the material, expected a surface without an emission of its own";
                return Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.emission", surface.path)));
            }
            texture.check(factor).map_err(|error| error.at(format!("{}.emission", surface.path)))?;
        }
    }
    Ok(all)
}

impl EmissionTexture {
    fn new(
        desc: &SceneDesc,
        material: &MaterialDesc,
        binding: &TextureBinding,
        centre: DVec3,
        threads: usize,
    ) -> Result<Option<Self>> {
        let Some(texture) = desc.textures.get(binding.texture) else { return Ok(None) };
        let is_planckian = binding.key == TextureKey::Temperature;
        let shown = match &texture.source {
            TextureSource::Image(it) => {
                // Light samples, rays and photons have to see the same radiance, and know no footprints.
                let filter = if it.filter.asks_footprint() { TextureFilter::Bilinear } else { it.filter };
                let (image, space) = match kelvin_of(material).filter(|_| is_planckian) {
                    Some(kelvin) => (Arc::new(light_of(it, kelvin, channel_of(binding.channel))?), ColorSpace::Linear),
                    None => (Arc::clone(&it.image), color_space(it, true)),
                };
                Texture::Image(ImageTexture::by_threads(image, space, it.wrap, filter, threads))
            }
            TextureSource::Procedural(it) => Texture::procedural(*it),
            TextureSource::White => Texture::White,
        };
        Ok(Some(Self {
            light: TextureLight::new(Arc::new(shown), threads),
            coordinates: Coordinates::new(&texture.mapping, centre),
            placement: Placement::new(&texture.mapping, centre),
            channel: if is_planckian { None } else { channel_of(binding.channel) },
            is_planckian,
        }))
    }

    /// Whether all of its light is that of black bodies.
    pub fn is_planckian(&self) -> bool {
        self.is_planckian
    }

    /// What the texture is multiplied by, for a surface of this emission. The light of temperatures has its own colours.
    fn factor(&self, emission: Rgb) -> Rgb {
        if self.is_planckian { Rgb::splat(luminance(emission)) } else { emission }
    }

    /// Checks that single precision holds the brightest radiance.
    fn check(&self, emission: Rgb) -> Result<()> {
        let factor = self.factor(emission);
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
        emission: Rgb,
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
        let radiance = TexturedRadiance::new(&self.light, self.factor(emission), self.channel);
        let emitter = TexturedTriangle::new(triangle, error, radiance, &self.light, corners, pieces_left);
        if emitter.is_dark() {
            // It keeps its number, but nothing asks its texture.
            return Emitter::Triangle(emitter.mean);
        }
        Emitter::Textured(Box::new(emitter))
    }

    /// The emitter of a sphere of the scene frame, of which `to_world` is the transform from the surface's own frame.
    pub fn sphere_emitter(
        &self,
        sphere: Sphere,
        to_world: &DAffine3,
        emission: Rgb,
        pieces_left: &mut usize,
    ) -> Emitter {
        // What a sphere may be transformed by and still emit scales all directions alike.
        let to_scene = to_world.matrix3 * (1.0 / to_world.matrix3.determinant().abs().cbrt());
        let radiance = TexturedRadiance::new(&self.light, self.factor(emission), self.channel);
        let texture = Arc::new(OnSphere::new(self, &sphere));
        let emitter = TexturedSphere::new(sphere, to_scene, radiance, &self.light, texture, pieces_left);
        if emitter.is_dark() {
            return Emitter::Sphere(emitter.mean);
        }
        Emitter::TexturedSphere(Box::new(emitter))
    }
}

/// The light of an image of temperatures, over the luminance of a black body of this temperature \[K\]: each texel times the
/// temperature is that of another black body. So texels are light before they are interpolated.
fn light_of(it: &ImageTextureDesc, kelvin: f64, channel: Option<usize>) -> Result<TexelImage> {
    let (image, space, channel) = (&it.image, color_space(it, false), channel.unwrap_or(0));
    let unit = 1.0 / black_body_luminance(kelvin);
    let most = BLACK_BODY_TEMPERATURES[1];
    let places = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let texels = places.flat_map(|(x, y)| {
        let temperature = kelvin * f64::from(image.texel(x, y, space)[channel]);
        (black_body_color(temperature.min(most)) * unit).as_vec3().to_array()
    });
    let texels = Texels::F32(texels.collect::<Vec<f32>>().into());
    TexelImage::new(image.width(), image.height(), 3, texels).map_err(|message| {
        let message = format!("{message}: the light of its temperature is beyond single precision");
        Error::new(ErrorKind::InvalidScene, message)
    })
}

/// A texture of emission as it lies on a sphere.
#[derive(Clone, Debug)]
struct OnSphere {
    coordinates: Coordinates,
    placement: Placement,
    bounds: Option<[[f32; 2]; 2]>,
    texels: [f32; 2],
}

impl OnSphere {
    fn new(texture: &EmissionTexture, sphere: &Sphere) -> Self {
        let (coordinates, placement) = (texture.coordinates, texture.placement);
        let mut on_sphere = Self { coordinates, placement, bounds: None, texels: [0.0; 2] };
        let Placement::Uv { matrix: [[a, b], [c, d]], .. } = placement else {
            // About what resolves the squares of a pattern.
            on_sphere.texels = [64.0, 32.0];
            return on_sphere;
        };
        // Coordinates are linear in the point and in those of the sphere, and so have their bounds at corners of boxes.
        let (centre, radius) = (sphere.centre.as_vec3a(), sphere.radius as f32);
        let sides = [Vec3::X, Vec3::Y, Vec3::Z];
        let mut corners = Vec::new();
        for n in sides.into_iter().chain(sides.map(|side| -side)) {
            for corner in 0..8 {
                let [x, y, z] = [0, 1, 2].map(|bit| if corner >> bit & 1 == 1 { 1.0_f32 } else { -1.0 });
                let uv = [0.5 + 0.5 * x, 0.5 + 0.5 * y];
                corners.push(on_sphere.point(centre + radius * Vec3::new(x, y, z), n, uv).uv);
            }
        }
        let bound =
            |pick: fn(f32, f32) -> f32, from: f32| [0, 1].map(|i| corners.iter().map(|uv| uv[i]).fold(from, pick));
        on_sphere.bounds = Some([bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY)]);
        let [width, height] = texture.light.texture().texels().map(|n| n as f32);
        let [along_u, along_v] = [(a * width).hypot(c * height), (b * width).hypot(d * height)];
        on_sphere.texels = match coordinates {
            Coordinates::Own | Coordinates::Set(_) => [along_u, along_v],
            Coordinates::Projected(_) => [2.0, 1.0].map(|turn| turn * PI * radius * along_u.max(along_v)),
        };
        on_sphere
    }
}

impl SphereTexture for OnSphere {
    fn point(&self, p: Vec3, n: Vec3, uv: [f32; 2]) -> TexturePoint {
        let at = SurfaceDetail::without_tangents(uv, 0.0, [n, n, p, n]);
        self.placement.point(&self.coordinates.apply(&at), false)
    }

    fn bounds(&self) -> Option<[[f32; 2]; 2]> {
        self.bounds
    }

    fn texels(&self) -> [f32; 2] {
        self.texels
    }
}
