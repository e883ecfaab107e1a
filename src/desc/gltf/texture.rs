//! Where materials name textures: the image, how it is repeated and transformed, and which parameter it changes.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use serde::Deserialize;

use super::super::json::{self, elided};
use super::super::{
    ImageTextureDesc, MeshDesc, SceneDesc, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource, texture_check,
};
use super::buffers::{Buffers, Uri};
use super::document::{Document, TextureInfo, element};
use crate::control::WorkProgress;
use crate::texture::{ColorSpace, ImageSource, ReadingTogether, TexelImage, TextureFilter, Wrap, read_images};
use crate::{Error, ErrorKind, Result};

/// Most texels of all images of a document.
const TEXELS_LIMIT: u64 = 1 << 30;

/// The extension that moves texture coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// The extension that names an image in the WebP format.
const WEBP: &str = "EXT_texture_webp";

#[derive(Deserialize)]
struct Webp {
    source: Option<u64>,
}

/// What a texture changes of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    /// Green is the roughness, blue the metalness.
    MetallicRoughness,
    Normal,
    Transmission,
    Coat,
    CoatRoughness,
    SheenColor,
    SheenRoughness,
    SpecularWeight,
    Emission,
    /// Something that textures cannot vary.
    NotDrawn,
}

impl Slot {
    /// The keys that it varies, and by which numbers of the texture.
    fn keys(self) -> &'static [(TextureKey, TextureChannel)] {
        match self {
            Self::BaseColor => &[(TextureKey::BaseColor, TextureChannel::Default)],
            Self::MetallicRoughness => &[
                (TextureKey::SpecularRoughness, TextureChannel::Green),
                (TextureKey::BaseMetalness, TextureChannel::Blue),
            ],
            Self::Normal => &[(TextureKey::Normal, TextureChannel::Default)],
            Self::Transmission => &[(TextureKey::TransmissionWeight, TextureChannel::Red)],
            Self::Coat => &[(TextureKey::CoatWeight, TextureChannel::Red)],
            Self::CoatRoughness => &[(TextureKey::CoatRoughness, TextureChannel::Green)],
            Self::SheenColor => &[(TextureKey::FuzzColor, TextureChannel::Default)],
            Self::SheenRoughness => &[(TextureKey::FuzzRoughness, TextureChannel::Alpha)],
            Self::SpecularWeight => &[(TextureKey::SpecularWeight, TextureChannel::Alpha)],
            Self::Emission => &[(TextureKey::Emission, TextureChannel::Default)],
            Self::NotDrawn => &[],
        }
    }
}

/// A reference to a texture.
#[derive(Clone, Debug)]
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

impl TextureUse {
    /// Where the image lies. glTF has v downwards from the upper edge, and turns, before it moves, from u towards the top of the image;
    /// here v goes upwards, as in the vertices that were read.
    /// `set` is the number of the texture coordinates in the scene.
    fn mapping(&self, set: u32) -> TextureMapping {
        let Some(Transform { offset, rotation, scale, .. }) = self.transform else {
            return TextureMapping::Uv { set, scale: [1.0; 2], rotation: 0.0, offset: [0.0; 2] };
        };
        let (sin, cos) = rotation.sin_cos();
        let offset = [offset[0] + sin * scale[1], 1.0 - offset[1] - cos * scale[1]];
        TextureMapping::Uv { set, scale, rotation, offset }
    }
}

/// An image that was read, and what its format says of its colours.
type Read = (Arc<TexelImage>, ColorSpace);

/// Where the bytes of an image are.
fn source<'a>(document: &'a Document<'a>, buffers: &'a Buffers<'a>, number: usize) -> Result<ImageSource<'a>> {
    let path = format!("images[{number}]");
    let image = &document.images[number];
    Ok(match (image.uri, image.buffer_view) {
        (Some(uri), _) => {
            let path = format!("{path}.uri");
            match buffers.uri(&path, uri)? {
                Uri::Data(bytes) => ImageSource::Bytes(bytes.into(), None),
                Uri::File(file) => {
                    buffers.open(&path, &file, None)?;
                    ImageSource::File(file.into())
                }
            }
        }
        (None, Some(view)) => ImageSource::Bytes(buffers.view(&format!("{path}.bufferView"), view)?.0.into(), None),
        (None, None) => return Err(super::document::missing(&path, "uri")),
    })
}

/// The textures of a document's materials.
pub(super) struct Textures<'a> {
    document: &'a Document<'a>,
    buffers: &'a Buffers<'a>,
    /// The images that materials ask for, as long as these are not read.
    wanted: Option<BTreeSet<usize>>,
    /// The images that were read; `None` for those that cannot be.
    images: HashMap<usize, Option<Read>>,
    /// The textures of the scene, which are put into it before the materials that have them.
    made: Vec<TextureDesc>,
    put: usize,
    /// What the material that is being read has.
    pub bindings: Vec<TextureBinding>,
    /// Which sets of texture coordinates the textures of this material use. Their places are their numbers in the scene.
    pub uv_sets: Vec<u64>,
    /// Whether the base colour of this material is multiplied by the colours of vertices.
    pub vertex_colors: bool,
    /// Whether these say how opaque the surface is.
    pub vertex_opacity: bool,
    left_out: Vec<(&'static str, Vec<String>)>,
    unread: Vec<String>,
}

impl<'a> Textures<'a> {
    /// Textures whose images are not read: what asks for them is noted for [`Self::with_images`].
    pub fn new(document: &'a Document<'a>, buffers: &'a Buffers<'a>) -> Self {
        Self {
            document,
            buffers,
            wanted: Some(BTreeSet::new()),
            images: HashMap::new(),
            made: Vec::new(),
            put: 0,
            bindings: Vec::new(),
            uv_sets: Vec::new(),
            vertex_colors: false,
            vertex_opacity: false,
            left_out: Vec::new(),
            unread: Vec::new(),
        }
    }

    /// Puts a texture on what it changes of a material.
    pub fn bind(&mut self, it: TextureUse) -> Result<()> {
        let keys = it.slot.keys();
        if keys.is_empty() {
            self.leave_out("textures of these parameters are not drawn", it.path);
            return Ok(());
        }
        let Some((image, suggested_space)) = it.image.and_then(|image| self.image(image)) else {
            self.leave_out("textures whose image is not read are not drawn", it.path);
            return Ok(());
        };
        let color_space = match it.slot {
            Slot::BaseColor | Slot::SheenColor | Slot::Emission => ColorSpace::Srgb,
            _ => ColorSpace::Raw,
        };
        let filter = if it.nearest { TextureFilter::Nearest } else { TextureFilter::default() };
        let known = self.uv_sets.iter().position(|set| *set == it.tex_coord);
        let set = known.unwrap_or(self.uv_sets.len());
        if set >= MeshDesc::MOST_UV_SETS {
            self.leave_out("textures by more than eight sets of coordinates of their material are not drawn", it.path);
            return Ok(());
        }
        if known.is_none() {
            self.uv_sets.push(it.tex_coord);
        }
        let mapping = it.mapping(set as u32);
        let image = ImageTextureDesc {
            image,
            file: None,
            color_space: Some(color_space),
            suggested_space,
            wrap: it.wrap,
            filter,
        };
        let source = TextureSource::Image(image);
        let vertex_colors = self.vertex_colors && it.slot == Slot::BaseColor;
        let made = TextureDesc { name: String::new(), path: it.path, source, mapping, vertex_colors };
        let texture = self.make(made)?;
        let strength = if it.slot == Slot::Normal { it.factor as f32 } else { 1.0 };
        self.bindings.extend(keys.iter().map(|&(key, channel)| TextureBinding {
            key,
            texture,
            channel,
            strength,
            cutoff: 0.0,
        }));
        Ok(())
    }

    /// Puts the colours of vertices on the base colour, where no texture has done so.
    pub fn bind_vertex_colors(&mut self, path: &str) -> Result<()> {
        let is_bound = self.bindings.iter().any(|binding| binding.key == TextureKey::BaseColor);
        if self.vertex_colors && !is_bound {
            let texture = self.make(TextureDesc::of_vertex_colors(String::new(), path.to_owned()))?;
            self.bindings.push(TextureBinding::whole(TextureKey::BaseColor, texture));
        }
        Ok(())
    }

    /// The number of a texture, which is made once.
    fn make(&mut self, it: TextureDesc) -> Result<usize> {
        let is_same = |known: &TextureDesc| {
            known.source == it.source && known.mapping == it.mapping && known.vertex_colors == it.vertex_colors
        };
        if let Some(known) = self.made.iter().position(is_same) {
            return Ok(known);
        }
        let made = TextureDesc { name: format!("texture {}", self.made.len()), ..it };
        texture_check::texture(&made)?;
        self.made.push(made);
        Ok(self.made.len() - 1)
    }

    /// Whether the image of a texture that was bound, or the colours of vertices, say how opaque it is.
    pub fn has_opacity(&self, texture: usize) -> bool {
        self.made.get(texture).is_some_and(|texture| {
            texture.vertex_colors && self.vertex_opacity
                || matches!(&texture.source, TextureSource::Image(it) if it.image.has_opacity())
        })
    }

    /// Puts the textures that were made into the scene.
    pub fn put(&mut self, scene: &mut SceneDesc) -> Result<()> {
        for texture in &self.made[self.put..] {
            scene.put_texture(texture.clone())?;
        }
        self.put = self.made.len();
        Ok(())
    }

    /// The texels of an image.
    fn image(&mut self, number: usize) -> Option<Read> {
        if let Some(wanted) = &mut self.wanted {
            wanted.insert(number);
        }
        self.images.get(&number).cloned().flatten()
    }

    /// Reads the images that were asked for, several at a time, and forgets all else.
    pub fn with_images(self, work: &WorkProgress<'_>) -> Result<Self> {
        let mut with = Self { wanted: None, ..Self::new(self.document, self.buffers) };
        let (mut numbers, mut sources) = (Vec::new(), Vec::new());
        for number in self.wanted.unwrap_or_default() {
            match self.document.images.get(number).map(|_| source(self.document, self.buffers, number)) {
                Some(Ok(source)) => {
                    numbers.push(number);
                    sources.push(source);
                }
                Some(Err(error)) => with.unread.push(elided(&error.to_string())),
                None => {}
            }
        }
        let how = ReadingTogether { most_texels: TEXELS_LIMIT, stops_at_error: false };
        let mut texels_left = TEXELS_LIMIT;
        for ((number, source), read) in numbers.into_iter().zip(&sources).zip(read_images(&sources, how, work)?) {
            let path = format!("images[{number}]");
            // What was not begun is past the limit, or beside an image that is.
            let read = read.unwrap_or_else(|| source.read(work)).and_then(|(image, space)| {
                let texels = u64::from(image.width()) * u64::from(image.height());
                texels_left = texels_left.checked_sub(texels).ok_or_else(|| {
                    let message = format!("the images are too large, expected {TEXELS_LIMIT} texels of all at most");
                    Error::new(ErrorKind::InvalidScene, message)
                })?;
                Ok((Arc::new(image), space))
            });
            match read {
                Ok(read) => {
                    with.images.insert(number, Some(read));
                }
                Err(error) => with.unread.push(elided(&error.at(path).to_string())),
            }
        }
        Ok(with)
    }

    fn leave_out(&mut self, why: &'static str, path: String) {
        match self.left_out.iter_mut().find(|(known, _)| *known == why) {
            Some((_, places)) => places.push(path),
            None => self.left_out.push((why, vec![path])),
        }
    }

    /// What is not drawn, in one sentence for each reason.
    pub fn warnings(self) -> Vec<String> {
        let mut warnings: Vec<_> =
            self.left_out.into_iter().map(|(why, places)| format!("{why}: {}", super::listed(places))).collect();
        if !self.unread.is_empty() {
            warnings.push(format!("images are not read: {}", super::listed(self.unread)));
        }
        warnings
    }
}
