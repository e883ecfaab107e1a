//! The textures of a scene as they were prepared, which a rebuilt scene keeps where they did not change.

use std::sync::Arc;

use super::textured_emission::{bytes_of_light, texture_of_light};
use crate::desc::{ImageTextureDesc, MaterialDesc, SceneDesc, TextureDesc, TextureKey, TextureSource};
use crate::embree::{Charge, Device};
use crate::emitter::EnvironmentMap;
use crate::error::Result;
use crate::texture::{ColorSpace, ImageTexture, SlopesOf, Texel, Texture, WHITE};

/// A texture as it was prepared, for scenes that are built from the same description again.
#[derive(Clone, Debug)]
pub(super) struct PreparedTexture {
    desc: Arc<TextureDesc>,
    space: ColorSpace,
    slopes: Option<SlopesOf>,
    texture: Arc<Texture>,
    /// What the texture takes of the device's allowance, and what its image takes, which other textures may share.
    _levels: Option<Arc<Charge>>,
    image: Option<Arc<Charge>>,
}

/// What a material reads of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reads {
    Color,
    /// Numbers that are no colour.
    Numbers,
    /// Slopes of a surface and their squares, which the texture's filter averages.
    Slopes(SlopesOf),
}

/// The textures that materials of a scene use.
#[derive(Clone, Debug, Default)]
pub(super) struct PreparedTextures {
    all: Vec<PreparedTexture>,
    colors: Option<VertexColors>,
    /// The light from infinity that a texture varies, and what its tables take of the device's allowance.
    sky: Option<(Arc<EnvironmentMap>, Option<Arc<Charge>>)>,
    /// What images of the light of temperatures take of the device's allowance.
    light: Vec<Arc<Charge>>,
}

/// What is known of the colours of all vertices before a point is known. Vertices without colours, which are white, count for the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VertexColors {
    pub mean: Texel,
    /// The least and greatest of each channel.
    pub range: [Texel; 2],
}

impl VertexColors {
    fn new(desc: &SceneDesc) -> Self {
        let (mut sum, mut range, mut count) = ([0.0_f64; 4], [WHITE; 2], 0.0_f64);
        for color in desc.meshes.iter().flat_map(|mesh| &mesh.colors) {
            for i in 0..4 {
                sum[i] += f64::from(color[i]);
                range[0][i] = range[0][i].min(color[i]);
                range[1][i] = range[1][i].max(color[i]);
            }
            count += 1.0;
        }
        let mean = if count == 0.0 { WHITE } else { sum.map(|sum| (sum / count) as f32) };
        Self { mean, range }
    }
}

impl PreparedTextures {
    /// What is known of the colours of vertices, which are gone through once.
    pub fn vertex_colors(&mut self, desc: &SceneDesc) -> VertexColors {
        *self.colors.get_or_insert_with(|| VertexColors::new(desc))
    }

    /// Charges the texture of a material's emission, which emitters read.
    pub fn add_emission(
        &mut self,
        desc: &SceneDesc,
        material: &MaterialDesc,
        before: Option<&Self>,
        device: &Device,
    ) -> Result<()> {
        let Some(binding) = texture_of_light(material) else { return Ok(()) };
        let Some(texture) = desc.textures.get(binding.texture) else { return Ok(()) };
        if let (TextureKey::Temperature, TextureSource::Image(it)) = (binding.key, &texture.source) {
            let charge = device.charge(bytes_of_light(&it.image)).map_err(|error| error.at(&texture.path))?;
            self.light.extend(charge.map(Arc::new));
        }
        let reads = if binding.key.is_color() { Reads::Color } else { Reads::Numbers };
        self.get(texture, reads, before, device).map(|_| ())
    }

    /// Charges the texture of the environment, and the tables by which its light is sampled.
    pub fn add_environment(
        &mut self,
        desc: &SceneDesc,
        map: Option<&Arc<EnvironmentMap>>,
        before: Option<&Self>,
        device: &Device,
    ) -> Result<()> {
        let (Some(map), Some(environment)) = (map, &desc.environment) else { return Ok(()) };
        let texture = environment.map().and_then(|map| desc.textures.get(map.texture));
        if let Some(texture) = texture {
            self.get(texture, Reads::Color, before, device)?;
        }
        let known = before.and_then(|before| before.sky.as_ref()).filter(|(known, _)| Arc::ptr_eq(known, map));
        let charge = match known {
            Some((_, charge)) => charge.clone(),
            None => device.charge(map.bytes()).map_err(|error| error.at(&environment.path))?.map(Arc::new),
        };
        self.sky = Some((Arc::clone(map), charge));
        Ok(())
    }

    /// The texture for this use, prepared or taken from `before`. Its bytes are charged to the allowance of `device`.
    pub fn get(
        &mut self,
        desc: &Arc<TextureDesc>,
        reads: Reads,
        before: Option<&Self>,
        device: &Device,
    ) -> Result<Arc<Texture>> {
        let slopes = if let Reads::Slopes(of) = reads { Some(of) } else { None };
        let space = match &desc.source {
            TextureSource::Image(image) => color_space(image, reads == Reads::Color),
            TextureSource::Procedural(_) | TextureSource::White => ColorSpace::Linear,
        };
        let same = |it: &&PreparedTexture| it.space == space && it.slopes == slopes && it.desc.source == desc.source;
        if let Some(known) = self.all.iter().find(same) {
            return Ok(Arc::clone(&known.texture));
        }
        let prepared = match before.and_then(|before| before.all.iter().find(same)) {
            Some(known) => PreparedTexture { desc: Arc::clone(desc), ..known.clone() },
            None => self.prepare(desc, space, slopes, before, device).map_err(|error| error.at(&desc.path))?,
        };
        let texture = Arc::clone(&prepared.texture);
        self.all.push(prepared);
        Ok(texture)
    }

    fn prepare(
        &self,
        desc: &Arc<TextureDesc>,
        space: ColorSpace,
        slopes: Option<SlopesOf>,
        before: Option<&Self>,
        device: &Device,
    ) -> Result<PreparedTexture> {
        let charge = |bytes: usize| device.charge(bytes).map(|charge| charge.map(Arc::new));
        let (texture, image, levels) = match &desc.source {
            TextureSource::Image(it) => {
                let is_shared = |other: &&PreparedTexture| match &other.desc.source {
                    TextureSource::Image(other) => Arc::ptr_eq(&other.image, &it.image),
                    TextureSource::Procedural(_) | TextureSource::White => false,
                };
                let mut all = self.all.iter().chain(before.iter().flat_map(|before| &before.all));
                let image = match all.find(is_shared) {
                    Some(other) => other.image.clone(),
                    None => charge(it.image.texels().bytes())?,
                };
                let levels = charge(ImageTexture::bytes_of_levels(&it.image, it.filter, slopes.is_some()))?;
                let (image_of, threads) = (Arc::clone(&it.image), device.threads());
                let texture = match slopes {
                    None => ImageTexture::by_threads(image_of, space, it.wrap, it.filter, threads),
                    Some(of) => ImageTexture::of_slopes(image_of, space, it.wrap, it.filter, of, threads),
                };
                (Texture::Image(texture), image, levels)
            }
            TextureSource::Procedural(it) => (Texture::procedural(*it), None, None),
            TextureSource::White => (Texture::White, None, None),
        };
        Ok(PreparedTexture {
            desc: Arc::clone(desc),
            space,
            slopes,
            texture: Arc::new(texture),
            image,
            _levels: levels,
        })
    }

    /// Each texture and what its numbers mean.
    pub fn each(&self) -> impl Iterator<Item = (&TextureDesc, ColorSpace)> {
        self.all.iter().map(|it| (&*it.desc, it.space))
    }

    /// Bytes of memory beyond the images themselves.
    pub fn bytes(&self) -> usize {
        let sky = self.sky.as_ref().map_or(0, |(map, _)| map.bytes());
        self.all.iter().map(|it| it.texture.bytes()).sum::<usize>() + sky
    }

    /// Number of textures, where one image with two colour spaces counts as two.
    pub fn len(&self) -> usize {
        self.all.len()
    }
}

/// What the numbers of an image mean where it is a colour or not.
pub(super) fn color_space(image: &ImageTextureDesc, is_color: bool) -> ColorSpace {
    image.color_space.unwrap_or(if is_color { image.suggested_space } else { ColorSpace::Raw })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{BuildOptions, Scene};
    use super::*;
    use crate::desc::{self, ImageTextureDesc, TextureMapping};
    use crate::texture::{TexelImage, Texels, TextureFilter, Wrap};

    fn texture(name: &str, value: u8) -> TextureDesc {
        let image = TexelImage::new(2, 2, 1, Texels::U8(vec![value; 4].into())).unwrap();
        let source = TextureSource::Image(ImageTextureDesc {
            image: Arc::new(image),
            file: None,
            color_space: None,
            suggested_space: ColorSpace::Srgb,
            wrap: [Wrap::Repeat; 2],
            filter: TextureFilter::Mip,
        });
        let mapping = TextureMapping::default();
        TextureDesc { name: name.to_owned(), path: String::new(), source, mapping, vertex_colors: false }
    }

    #[test]
    fn a_rebuilt_scene_prepares_the_textures_that_changed() {
        let quad = |material: &str| {
            json!({"geometry": "quad", "material": material, "vertex-1": [-1, -1, 0], "vertex-2": [1, -1, 0],
                "vertex-3": [1, 1, 0], "vertex-4": [-1, 1, 0]})
        };
        let named = |name: &str| json!({"name": name, "type": "diffuse", "color": [1, 1, 1]});
        let scene = json!({"etendue": 1, "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0]},
            "materials": [named("one"), named("other")], "surfaces": [quad("one"), quad("other")]});
        let mut desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
        for (material, name) in [(0, "first"), (1, "second")] {
            let number = desc.add_texture(texture(name, 100)).unwrap();
            let binding = desc::TextureBinding {
                key: TextureKey::Color,
                texture: number,
                channel: desc::TextureChannel::Default,
                strength: 1.0,
                cutoff: 0.0,
            };
            desc.set_material_texture(material, TextureKey::Color, Some(binding)).unwrap();
        }
        let of = |scene: &Scene| -> Vec<_> { scene.textures.all.iter().map(|it| Arc::as_ptr(&it.texture)).collect() };
        let options = BuildOptions::default();
        let before = Scene::build(&desc, &options).unwrap();
        desc.set_texture(1, texture("", 200)).unwrap();
        let after = before.rebuild(&desc, &options).unwrap();
        assert!(of(&before)[0] == of(&after)[0] && of(&before)[1] != of(&after)[1]);
        // Texels that a host changed in its own memory are prepared anew, and no others.
        desc.update_texture(0).unwrap();
        let last = after.rebuild(&desc, &options).unwrap();
        assert!(of(&after)[0] != of(&last)[0] && of(&after)[1] == of(&last)[1]);
        assert!(Arc::ptr_eq(&after.geometries, &last.geometries), "no geometry is built again");
    }
}
