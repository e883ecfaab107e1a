//! Reads and writes textures of the native format, and the `textures` of a material.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, Whole, join};
use super::numbers::{self, shortest, single, unless};
use super::save::{self, Names};
use super::{
    ImageTextureDesc, Projection, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource, texture_check, validate,
};
use crate::math::DVec3;
use crate::texture::{ColorSpace, Pattern, Procedural, TexelFormat, TextureFilter, Wrap};
use crate::{Error, Result};

/// The kinds of textures, by `type`.
const KINDS: [&str; 9] =
    ["image", "checker", "grid", "gradient", "noise", "turbulence", "marble", "wood", "vertex-colors"];

/// What the numbers of an image mean.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Space {
    /// Colours with sRGB's curve.
    Srgb,
    /// Colours in linear light.
    Linear,
    /// No colours.
    Raw,
}

/// What lies beyond the edges of an image.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum WrapKey {
    /// The image again.
    #[default]
    Repeat,
    /// The image in a mirror.
    Mirror,
    /// The texels of the edge.
    Clamp,
    /// Black, without opacity.
    Black,
}

/// How an image is filtered.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum FilterKey {
    /// The nearest texel.
    Nearest,
    /// Linear between the four nearest texels: no bias.
    #[default]
    Bilinear,
    /// Smaller images for smaller pixels; blurs.
    Mip,
    /// A Gaussian over the ellipse that a pixel covers.
    Ewa,
    /// One texel drawn from that Gaussian.
    Stochastic,
}

/// Where a texture lies.
#[derive(Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum Coordinates {
    /// On the surface, by its texture coordinates.
    #[default]
    Uv,
    /// On the surface, by the world's coordinates from the side of a box that the face looks to.
    Box,
    /// On the surface, by the world's coordinates along the x axis.
    PlanarX,
    /// On the surface, by the world's coordinates from above.
    PlanarY,
    /// On the surface, by the world's coordinates along the z axis.
    PlanarZ,
    /// In world space.
    Space,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ImageTag {
    Image,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum VertexColorsTag {
    VertexColors,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum PatternTag {
    Checker,
    Grid,
    Gradient,
    Noise,
    Turbulence,
    Marble,
    Wood,
}

/// An image on surfaces.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct Image {
    /// What materials call it.
    name: String,
    #[serde(rename = "type")]
    _type: ImageTag,
    /// PNG, JPEG, TGA, BMP, WebP, TIFF, Radiance HDR or OpenEXR file, relative to the scene file's folder.
    file: String,
    /// `srgb`, `linear` or `raw`. Default: for colours what the format suggests (`srgb` for integers, `linear` for floating point), `raw`
    /// for everything else.
    #[serde(default, deserialize_with = "json::name")]
    color_space: Option<Space>,
    /// `repeat` (default), `mirror`, `clamp` or `black`: what lies beyond the edges.
    #[serde(default, deserialize_with = "json::name")]
    wrap: Option<WrapKey>,
    /// The same for up and down. Default: as `wrap`.
    #[serde(default, deserialize_with = "json::name")]
    wrap_v: Option<WrapKey>,
    /// `nearest`, `bilinear` (default), `mip`, `ewa` or `stochastic`.
    #[serde(default, deserialize_with = "json::name")]
    filter: Option<FilterKey>,
    /// `uv` (default), or for surfaces without texture coordinates `box`, `planar-x`, `planar-y` or `planar-z`.
    #[serde(default, deserialize_with = "json::name")]
    coordinates: Option<Coordinates>,
    /// Factors on u and v, applied first. Default [1, 1].
    scale: Option<[f64; 2]>,
    /// Degrees by which texture coordinates are turned about (0, 0), counter-clockwise. Default 0.
    rotation: Option<f64>,
    /// Added to u and v at last. Default [0, 0].
    offset: Option<[f64; 2]>,
    /// Of the coordinates `uv`: the set of texture coordinates, 0 to 7. Default 0.
    uv_set: Option<Whole>,
    /// Whether it is multiplied by the colours of vertices. Default false.
    vertex_colors: Option<bool>,
}

/// A pattern of two colours.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct PatternTexture {
    /// What materials call it.
    name: String,
    /// `checker`, `grid`, `gradient`, `noise`, `turbulence`, `marble` or `wood`.
    r#type: PatternTag,
    /// The two colours, [0, 1] per channel. Default black and white.
    colors: Option<[[f64; 3]; 2]>,
    /// `uv` (default), `space`, or `box`, `planar-x`, `planar-y` or `planar-z`.
    #[serde(default, deserialize_with = "json::name")]
    coordinates: Option<Coordinates>,
    /// Of a `grid`: width of the lines, in [0, 1] of a square. Default 0.1.
    line_width: Option<f64>,
    /// Of noise, turbulence, marble and wood: number of octaves, 1 to 16. Default 4.
    octaves: Option<Whole>,
    /// Of marble and wood: how far veins or rings are turned. Default 1 and 0.2.
    turbulence: Option<f64>,
    /// Factors on the coordinates, applied first: three for `space`, two for all others. Default 1.
    scale: Option<Vec<f64>>,
    /// Of all but `space`: degrees by which texture coordinates are turned. Default 0.
    rotation: Option<f64>,
    /// Added at last: three numbers for `space`, two for all others. Default 0.
    offset: Option<Vec<f64>>,
    /// Of the coordinates `uv`: the set of texture coordinates, 0 to 7. Default 0.
    uv_set: Option<Whole>,
    /// Whether it is multiplied by the colours of vertices. Default false.
    vertex_colors: Option<bool>,
}

/// The colours of vertices.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct VertexColors {
    /// What materials call it.
    name: String,
    #[serde(rename = "type")]
    _type: VertexColorsTag,
}

/// What a parameter takes from a texture.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Binding {
    /// Name of a texture.
    texture: String,
    /// `r`, `g`, `b` or `a`. Default: colours take all three; an opacity takes that of the image if it has one; other numbers take `r`.
    #[serde(default, deserialize_with = "json::name")]
    channel: Option<ChannelKey>,
    /// For `normal`: factor on the slopes. For `bump`: height of a 1, scene units. Default 1.
    strength: Option<f64>,
    /// For `opacity`, in [0, 1]: above 0, a mask, which is opaque where the texture has this value or more. Default 0.
    cutoff: Option<f64>,
}

/// One number of a texture.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum ChannelKey {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Opacity.
    A,
}

/// A texture's name, or more.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
#[cfg(feature = "schema")]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) enum BindingOrName {
    /// The name of a texture.
    Name(String),
    /// A texture and what is taken of it.
    Binding(Binding),
}

/// The names of the image files of `textures`, as far as these can be read.
pub(super) fn image_files(raw: Option<&RawValue>) -> Vec<String> {
    #[derive(Deserialize)]
    struct File {
        file: String,
    }
    let mut files = Vec::new();
    // What is wrong is an error where the textures themselves are read.
    let _ = json::each(raw, "", |_, raw| {
        files.extend(serde_json::from_str::<File>(raw.get()).ok().map(|it| it.file));
        Ok(())
    });
    files
}

/// Reads one of `textures` of a scene.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let texture = match json::tag(raw, path, "type", &KINDS)?.as_str() {
        "image" => image(json::object(raw, path)?, path, builder)?,
        "vertex-colors" => {
            let VertexColors { name, .. } = json::object(raw, path)?;
            TextureDesc::of_vertex_colors(name, path.to_owned())
        }
        _ => pattern(json::object(raw, path)?, path)?,
    };
    texture_check::texture(&texture)?;
    builder.scene.put_texture(texture).map(|_| ())
}

fn image(keys: Image, path: &str, builder: &mut Builder<'_>) -> Result<TextureDesc> {
    let wrap = |key: WrapKey| match key {
        WrapKey::Repeat => Wrap::Repeat,
        WrapKey::Mirror => Wrap::Mirror,
        WrapKey::Clamp => Wrap::Clamp,
        WrapKey::Black => Wrap::Black,
    };
    let across = keys.wrap.unwrap_or_default();
    let (file, image, suggested_space) = builder.image_file(&join(path, "file"), &keys.file)?;
    let source = TextureSource::Image(ImageTextureDesc {
        image,
        file: Some(file),
        color_space: keys.color_space.map(|space| match space {
            Space::Srgb => ColorSpace::Srgb,
            Space::Linear => ColorSpace::Linear,
            Space::Raw => ColorSpace::Raw,
        }),
        suggested_space,
        wrap: [wrap(across), wrap(keys.wrap_v.unwrap_or(across))],
        filter: match keys.filter.unwrap_or_default() {
            FilterKey::Nearest => TextureFilter::Nearest,
            FilterKey::Bilinear => TextureFilter::Bilinear,
            FilterKey::Mip => TextureFilter::Mip,
            FilterKey::Ewa => TextureFilter::Ewa,
            FilterKey::Stochastic => TextureFilter::Stochastic,
        },
    });
    let (scale, offset) = (keys.scale.unwrap_or([1.0; 2]), keys.offset.unwrap_or_default());
    let rotation = keys.rotation.unwrap_or(0.0).to_radians();
    let mapping = match keys.coordinates.unwrap_or_default() {
        // Refused by the check that follows, with its reason.
        Coordinates::Space => TextureMapping::Space { scale: DVec3::ONE, offset: DVec3::ZERO },
        on_surface => mapping(on_surface, uv_set(path, keys.uv_set, on_surface)?, scale, rotation, offset),
    };
    let vertex_colors = keys.vertex_colors.unwrap_or_default();
    Ok(TextureDesc { name: keys.name, path: path.to_owned(), source, mapping, vertex_colors })
}

/// The set of texture coordinates, which only the coordinates `uv` have.
fn uv_set(path: &str, given: Option<Whole>, coordinates: Coordinates) -> Result<u32> {
    match (given, coordinates) {
        (None, _) => Ok(0),
        (Some(Whole(set)), Coordinates::Uv) => Ok(u32::try_from(set).unwrap_or(u32::MAX)),
        (Some(_), _) => Err(Error::invalid(join(path, "uvSet"), "only the coordinates 'uv' have sets")),
    }
}

/// The mapping of a texture that lies on surfaces.
fn mapping(coordinates: Coordinates, set: u32, scale: [f64; 2], rotation: f64, offset: [f64; 2]) -> TextureMapping {
    let projection = match coordinates {
        Coordinates::Uv | Coordinates::Space => return TextureMapping::Uv { set, scale, rotation, offset },
        Coordinates::Box => Projection::Box,
        Coordinates::PlanarX => Projection::X,
        Coordinates::PlanarY => Projection::Y,
        Coordinates::PlanarZ => Projection::Z,
    };
    TextureMapping::Projected { projection, scale, rotation, offset }
}

fn pattern(keys: PatternTexture, path: &str) -> Result<TextureDesc> {
    let at = |key: &str| join(path, key);
    let is_turned = matches!(keys.r#type, PatternTag::Marble | PatternTag::Wood);
    let is_noisy = is_turned || matches!(keys.r#type, PatternTag::Noise | PatternTag::Turbulence);
    // A parameter of another pattern is an error, because the author was mistaken about which one is used.
    let misplaced = [
        ("lineWidth", keys.line_width.is_some() && !matches!(keys.r#type, PatternTag::Grid)),
        ("octaves", keys.octaves.is_some() && !is_noisy),
        ("turbulence", keys.turbulence.is_some() && !is_turned),
    ];
    if let Some((key, _)) = misplaced.into_iter().find(|(_, is_misplaced)| *is_misplaced) {
        return Err(Error::invalid(at(key), "another kind of texture has this key"));
    }
    let octaves = match &keys.octaves {
        Some(Whole(count)) => u32::try_from(*count).unwrap_or(u32::MAX),
        None => 4,
    };
    let number = |key: &str, value: Option<f64>, default: f64| validate::number(&at(key), value.unwrap_or(default));
    let pattern = match keys.r#type {
        PatternTag::Checker => Pattern::Checker,
        PatternTag::Grid => Pattern::Grid { width: number("lineWidth", keys.line_width, 0.1)? as f32 },
        PatternTag::Gradient => Pattern::Gradient,
        PatternTag::Noise => Pattern::Noise { octaves, turbulent: false },
        PatternTag::Turbulence => Pattern::Noise { octaves, turbulent: true },
        PatternTag::Marble => {
            Pattern::Marble { octaves, turbulence: number("turbulence", keys.turbulence, 1.0)? as f32 }
        }
        PatternTag::Wood => Pattern::Wood { octaves, turbulence: number("turbulence", keys.turbulence, 0.2)? as f32 },
    };
    let colors = keys.colors.unwrap_or([[0.0; 3], [1.0; 3]]);
    let color = |i: usize| validate::reflectance(&at(&format!("colors[{i}]")), colors[i]);
    let in_space = matches!(keys.coordinates.unwrap_or_default(), Coordinates::Space);
    let source = TextureSource::Procedural(Procedural { pattern, colors: [color(0)?, color(1)?], in_space });
    let mapping = if in_space {
        uv_set(path, keys.uv_set, Coordinates::Space)?;
        if keys.rotation.is_some() {
            return Err(Error::invalid(
                at("rotation"),
                "only coordinates on surfaces are turned, expected coordinates other than 'space'",
            ));
        }
        TextureMapping::Space {
            scale: DVec3::from_array(list(&at("scale"), keys.scale, 1.0)?),
            offset: DVec3::from_array(list(&at("offset"), keys.offset, 0.0)?),
        }
    } else {
        let scale = list(&at("scale"), keys.scale, 1.0)?;
        let offset = list(&at("offset"), keys.offset, 0.0)?;
        let rotation = keys.rotation.unwrap_or(0.0).to_radians();
        let coordinates = keys.coordinates.unwrap_or_default();
        mapping(coordinates, uv_set(path, keys.uv_set, coordinates)?, scale, rotation, offset)
    };
    let vertex_colors = keys.vertex_colors.unwrap_or_default();
    Ok(TextureDesc { name: keys.name, path: path.to_owned(), source, mapping, vertex_colors })
}

/// As many numbers as coordinates.
fn list<const N: usize>(path: &str, values: Option<Vec<f64>>, default: f64) -> Result<[f64; N]> {
    let Some(values) = values else { return Ok([default; N]) };
    <[f64; N]>::try_from(values)
        .map_err(|values| Error::invalid(path, format!("{} numbers, expected {N} for these coordinates", values.len())))
}

/// Reads the `textures` of a material.
pub(super) fn bindings(
    raw: Option<&BTreeMap<String, Box<RawValue>>>,
    path: &str,
    builder: &Builder<'_>,
) -> Result<Vec<TextureBinding>> {
    let one = |(name, raw): (&String, &RawValue)| {
        let path = join(&join(path, "textures"), name);
        let Some(key) = TextureKey::by_name(name) else {
            let hint = json::did_you_mean(name, TextureKey::ALL.iter().map(|key| key.name()));
            return Err(Error::invalid(path, format!("no material has a parameter of this name{hint}")));
        };
        let binding = if raw.get().starts_with('"') {
            let texture = serde_json::from_str(raw.get())
                .map_err(|error| Error::invalid(&path, "not a string").because(error))?;
            Binding { texture, channel: None, strength: None, cutoff: None }
        } else {
            json::object(raw, &path)?
        };
        Ok(TextureBinding {
            key,
            texture: builder.texture(&path, &binding.texture)?,
            channel: match binding.channel {
                None => TextureChannel::Default,
                Some(ChannelKey::R) => TextureChannel::Red,
                Some(ChannelKey::G) => TextureChannel::Green,
                Some(ChannelKey::B) => TextureChannel::Blue,
                Some(ChannelKey::A) => TextureChannel::Alpha,
            },
            strength: validate::number(&join(&path, "strength"), binding.strength.unwrap_or(1.0))? as f32,
            cutoff: validate::within(&join(&path, "cutoff"), binding.cutoff.unwrap_or(0.0), 0.0, 1.0)? as f32,
        })
    };
    raw.into_iter().flatten().map(|(name, raw)| one((name, raw))).collect()
}

/// Writes a texture, whose numbers have been checked, under this name; `file` is the name of the file of its image.
pub(super) fn write(texture: &TextureDesc, name: &str, file: &str) -> Result<Box<RawValue>> {
    let TextureDesc { path, source, mapping, .. } = texture;
    match source {
        TextureSource::Image(image) => {
            let [across, up] = image.wrap.map(|wrap| match wrap {
                Wrap::Repeat => WrapKey::Repeat,
                Wrap::Mirror => WrapKey::Mirror,
                Wrap::Clamp => WrapKey::Clamp,
                Wrap::Black => WrapKey::Black,
            });
            let MappingKeys { coordinates, uv_set, scale, rotation, offset } = MappingKeys::of(path, mapping)?;
            let pair = |list: Option<Vec<f64>>| list.and_then(|list| <[f64; 2]>::try_from(list).ok());
            save::raw(&Image {
                name: name.to_owned(),
                _type: ImageTag::Image,
                file: file.to_owned(),
                color_space: space_key(path, image)?,
                wrap: (image.wrap[0] != Wrap::default()).then_some(across),
                wrap_v: (image.wrap[1] != image.wrap[0]).then_some(up),
                filter: match image.filter {
                    TextureFilter::Nearest => Some(FilterKey::Nearest),
                    TextureFilter::Bilinear => None,
                    TextureFilter::Mip => Some(FilterKey::Mip),
                    TextureFilter::Ewa => Some(FilterKey::Ewa),
                    TextureFilter::Stochastic => Some(FilterKey::Stochastic),
                },
                coordinates,
                scale: pair(scale),
                rotation,
                offset: pair(offset),
                uv_set,
                vertex_colors: texture.vertex_colors.then_some(true),
            })
        }
        TextureSource::Procedural(procedural) => {
            let (tag, octaves, turbulence) = match procedural.pattern {
                Pattern::Checker => (PatternTag::Checker, None, None),
                Pattern::Grid { .. } => (PatternTag::Grid, None, None),
                Pattern::Gradient => (PatternTag::Gradient, None, None),
                Pattern::Noise { octaves, turbulent: false } => (PatternTag::Noise, Some(octaves), None),
                Pattern::Noise { octaves, turbulent: true } => (PatternTag::Turbulence, Some(octaves), None),
                Pattern::Marble { octaves, turbulence } => (PatternTag::Marble, Some(octaves), Some(turbulence)),
                Pattern::Wood { octaves, turbulence } => (PatternTag::Wood, Some(octaves), Some(turbulence)),
            };
            let MappingKeys { coordinates, uv_set, scale, rotation, offset } = MappingKeys::of(path, mapping)?;
            save::raw(&PatternTexture {
                name: name.to_owned(),
                r#type: tag,
                colors: Some(procedural.colors.map(numbers::color)),
                coordinates,
                line_width: match procedural.pattern {
                    Pattern::Grid { width } => Some(single(width)),
                    _ => None,
                },
                octaves: octaves.map(|octaves| Whole(octaves.into())),
                turbulence: turbulence.map(single),
                scale,
                rotation,
                offset,
                uv_set,
                vertex_colors: texture.vertex_colors.then_some(true),
            })
        }
        TextureSource::White => {
            save::raw(&VertexColors { name: name.to_owned(), _type: VertexColorsTag::VertexColors })
        }
    }
}

/// The keys of a mapping that differ from their defaults.
struct MappingKeys {
    coordinates: Option<Coordinates>,
    uv_set: Option<Whole>,
    scale: Option<Vec<f64>>,
    rotation: Option<f64>,
    offset: Option<Vec<f64>>,
}

impl MappingKeys {
    fn of(path: &str, mapping: &TextureMapping) -> Result<Self> {
        let list = |values: &[f64], default: f64| {
            values.iter().any(|value| value.to_bits() != default.to_bits()).then(|| values.to_vec())
        };
        let coordinates = match mapping {
            TextureMapping::Uv { .. } => None,
            TextureMapping::Space { .. } => Some(Coordinates::Space),
            TextureMapping::Projected { projection, .. } => Some(match projection {
                Projection::Box => Coordinates::Box,
                Projection::X => Coordinates::PlanarX,
                Projection::Y => Coordinates::PlanarY,
                Projection::Z => Coordinates::PlanarZ,
            }),
        };
        let uv_set = match mapping {
            TextureMapping::Uv { set, .. } if *set > 0 => Some(Whole((*set).into())),
            _ => None,
        };
        match *mapping {
            TextureMapping::Uv { scale, rotation, offset, .. }
            | TextureMapping::Projected { scale, rotation, offset, .. } => {
                let degrees = unless(rotation, 0.0).map(|radians| turned_degrees(radians, scale)).transpose();
                let rotation = degrees.map_err(|message| Error::invalid(join(path, "rotation"), message))?;
                Ok(Self { coordinates, uv_set, scale: list(&scale, 1.0), rotation, offset: list(&offset, 0.0) })
            }
            TextureMapping::Space { scale, offset } => {
                let (scale, offset) = (list(&scale.to_array(), 1.0), list(&offset.to_array(), 0.0));
                Ok(Self { coordinates, uv_set, scale, rotation: None, offset })
            }
        }
    }
}

/// The degrees that are read as this rotation. One in ten angles in radians lies between those that degrees of double precision give;
/// for these it is the nearest ones, which turn texture coordinates, of single precision, in the same way.
fn turned_degrees(radians: f64, scale: [f64; 2]) -> Result<f64, String> {
    let matrix = |radians: f64| {
        let (sin, cos) = radians.sin_cos();
        [cos * scale[0], sin * scale[1], sin * scale[0], cos * scale[1]].map(|x| (x as f32).to_bits())
    };
    let exact = radians.to_degrees();
    shortest(exact, |degrees| degrees.to_radians().to_bits() == radians.to_bits())
        .or_else(|| shortest(exact, |degrees| matrix(degrees.to_radians()) == matrix(radians)))
        .ok_or_else(|| format!("no angle in degrees is exactly {radians} radians, expected another angle"))
}

/// The colour space of an image in a file that keeps its texels: an integer format, which suggests sRGB, or a floating-point one.
fn space_key(path: &str, image: &ImageTextureDesc) -> Result<Option<Space>> {
    let is_integer = matches!(image.image.texels().format(), TexelFormat::U8 | TexelFormat::U16);
    match (image.color_space, image.suggested_space) {
        (Some(ColorSpace::Srgb), _) => Ok(Some(Space::Srgb)),
        (Some(ColorSpace::Linear), _) => Ok(Some(Space::Linear)),
        (Some(ColorSpace::Raw), _) => Ok(Some(Space::Raw)),
        (None, suggested) if (suggested == ColorSpace::Srgb) == is_integer => Ok(None),
        // What is taken as it is, is the same as a colour in linear light.
        (None, ColorSpace::Linear | ColorSpace::Raw) => Ok(Some(Space::Linear)),
        (None, ColorSpace::Srgb) => {
            let message =
                "floating-point texels are sRGB where they are colours and raw where not, expected a colour space";
            Err(Error::invalid(join(path, "colorSpace"), message))
        }
    }
}

/// Writes the `textures` of a material.
pub(super) fn write_bindings(
    bindings: &[TextureBinding],
    names: &Names,
) -> Result<Option<BTreeMap<String, Box<RawValue>>>> {
    let one = |binding: &TextureBinding| {
        let texture = names.textures[binding.texture].clone();
        let channel = match binding.channel {
            TextureChannel::Default => None,
            TextureChannel::Red => Some(ChannelKey::R),
            TextureChannel::Green => Some(ChannelKey::G),
            TextureChannel::Blue => Some(ChannelKey::B),
            TextureChannel::Alpha => Some(ChannelKey::A),
        };
        let strength = unless(single(binding.strength), 1.0);
        let cutoff = unless(single(binding.cutoff), 0.0);
        let value = match (channel, strength, cutoff) {
            (None, None, None) => save::raw(&texture)?,
            _ => save::raw(&Binding { texture, channel, strength, cutoff })?,
        };
        Ok((binding.key.name().to_owned(), value))
    };
    let written: BTreeMap<_, _> = bindings.iter().map(one).collect::<Result<_>>()?;
    Ok((!written.is_empty()).then_some(written))
}
