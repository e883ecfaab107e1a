//! Where materials name textures: the image, how it is repeated and transformed, and which parameter it changes.

use serde::Deserialize;

use super::super::json;
use super::document::{Document, TextureInfo, element};
use crate::{Error, Result};

/// The extension that moves texture coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// The extension that names an image in the WebP format.
const WEBP: &str = "EXT_texture_webp";

#[derive(Deserialize)]
struct Webp {
    source: Option<u64>,
}

/// The parameter of a material that a texture changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    MetallicRoughness,
    Normal,
    Occlusion,
    Emissive,
    /// A parameter of an extension.
    Other,
}

/// How a texture goes on beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrap {
    Clamp,
    Mirror,
    Repeat,
}

/// A reference to a texture.
#[derive(Clone, Debug)]
#[expect(dead_code, reason = "what binds a texture to a key of a material reads them")]
pub(super) struct TextureUse {
    /// The path of the reference.
    pub path: String,
    pub slot: Slot,
    /// Index into the document's images; `None` for a texture that only extensions describe.
    pub image: Option<usize>,
    /// Which set of texture coordinates is used.
    pub tex_coord: u64,
    pub wrap: [Wrap; 2],
    /// Whether texels are shown as squares.
    pub nearest: bool,
    /// Applied to texture coordinates: a scale, a rotation [radian] from u to -v, and an offset.
    pub transform: Option<Transform>,
    /// Factor on the slopes of normal maps, or the strength of occlusion.
    pub factor: f64,
}

/// A change of texture coordinates.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "camelCase")]
pub(super) struct Transform {
    #[serde(default)]
    pub offset: [f64; 2],
    #[serde(default)]
    pub rotation: f64,
    #[serde(default = "one")]
    pub scale: [f64; 2],
    tex_coord: Option<u64>,
}

fn one() -> [f64; 2] {
    [1.0; 2]
}

/// Reads a reference to a texture, which may be missing.
pub(super) fn read(
    document: &Document<'_>,
    path: String,
    info: Option<&TextureInfo<'_>>,
    slot: Slot,
) -> Result<Option<TextureUse>> {
    let Some(info) = info else { return Ok(None) };
    let at = |key: &str| format!("{path}.{key}");
    let index = info.index.ok_or_else(|| super::document::missing(&path, "index"))?;
    let (number, texture) = element(&document.textures, "textures", &at("index"), index)?;
    let at_texture = format!("textures[{number}]");
    // An image of the extension is the one to take where there are two; it can be read wherever the other can.
    let (image, image_path) = match texture.extensions.get(WEBP) {
        Some(raw) => {
            let path = format!("{at_texture}.extensions.{WEBP}");
            (json::object::<Webp>(raw, &path)?.source, format!("{path}.source"))
        }
        None => (texture.source, format!("{at_texture}.source")),
    };
    let image = image.map(|index| element(&document.images, "images", &image_path, index)).transpose()?.map(|(i, _)| i);
    let (mut wrap, mut nearest) = ([Wrap::Repeat; 2], false);
    if let Some(index) = texture.sampler {
        let path = format!("textures[{number}].sampler");
        let (number, sampler) = element(&document.samplers, "samplers", &path, index)?;
        let path = format!("samplers[{number}]");
        wrap = [wrap_of(&format!("{path}.wrapS"), sampler.wrap_s)?, wrap_of(&format!("{path}.wrapT"), sampler.wrap_t)?];
        nearest = sampler.mag_filter == Some(9728);
    }
    let transform = match info.extensions.get(TRANSFORM) {
        Some(raw) => {
            let path = at(&format!("extensions.{TRANSFORM}"));
            let it: Transform = json::object(raw, &path)?;
            let numbers = [it.offset[0], it.offset[1], it.rotation, it.scale[0], it.scale[1]];
            for number in numbers {
                super::super::validate::number(&path, number)?;
            }
            Some(it)
        }
        None => None,
    };
    let tex_coord = transform.and_then(|it| it.tex_coord).unwrap_or(info.tex_coord);
    let factor = info.scale.or(info.strength).unwrap_or(1.0);
    Ok(Some(TextureUse { path, slot, image, tex_coord, wrap, nearest, transform, factor }))
}

fn wrap_of(path: &str, code: Option<u32>) -> Result<Wrap> {
    match code {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::Clamp),
        Some(33648) => Ok(Wrap::Mirror),
        Some(other) => Err(Error::invalid(path, format!("{other} is no wrapping, expected 33071, 33648 or 10497"))),
    }
}

/// The textures of a document's materials.
#[derive(Debug, Default)]
pub(super) struct Textures {
    not_drawn: Vec<String>,
}

impl Textures {
    /// Puts a texture on a parameter of a material. Until materials have textures, it is named in a warning.
    pub fn bind(&mut self, it: TextureUse) {
        self.not_drawn.push(it.path);
    }

    /// Warns of what is not drawn, in one sentence.
    pub fn warn(self, warnings: &mut Vec<String>) {
        if !self.not_drawn.is_empty() {
            super::warn(warnings, format!("textures are not drawn yet: {}", super::listed(self.not_drawn)));
        }
    }
}
