//! Reads textures of the native format, and the `textures` of a material.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, Whole, join};
use super::{
    ImageTextureDesc, Projection, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource, texture_check, validate,
};
use crate::math::DVec3;
use crate::texture::{ColorSpace, Pattern, Procedural, TextureFilter, Wrap};
use crate::{Error, Result};

/// The kinds of textures, by `type`.
const KINDS: [&str; 8] = ["image", "checker", "grid", "gradient", "noise", "turbulence", "marble", "wood"];

/// What the numbers of an image mean.
#[derive(Clone, Copy, Deserialize)]
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
#[derive(Clone, Copy, Default, Deserialize)]
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
#[derive(Clone, Copy, Default, Deserialize)]
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
#[derive(Clone, Copy, Default, Deserialize)]
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

#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum ImageTag {
    Image,
}

#[derive(Clone, Copy, Deserialize)]
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
#[derive(Deserialize)]
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
}

/// A pattern of two colours.
#[derive(Deserialize)]
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
}

/// What a parameter takes from a texture.
#[derive(Deserialize)]
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
}

/// One number of a texture.
#[derive(Clone, Copy, Deserialize)]
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

/// Reads one of `textures` of a scene.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let texture = match json::tag(raw, path, "type", &KINDS)?.as_str() {
        "image" => image(json::object(raw, path)?, path, builder)?,
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
        on_surface => mapping(on_surface, scale, rotation, offset),
    };
    Ok(TextureDesc { name: keys.name, path: path.to_owned(), source, mapping })
}

/// The mapping of a texture that lies on surfaces.
fn mapping(coordinates: Coordinates, scale: [f64; 2], rotation: f64, offset: [f64; 2]) -> TextureMapping {
    let projection = match coordinates {
        Coordinates::Uv | Coordinates::Space => return TextureMapping::Uv { scale, rotation, offset },
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
        mapping(keys.coordinates.unwrap_or_default(), scale, rotation, offset)
    };
    Ok(TextureDesc { name: keys.name, path: path.to_owned(), source, mapping })
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
            Binding { texture, channel: None, strength: None }
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
        })
    };
    raw.into_iter().flatten().map(|(name, raw)| one((name, raw))).collect()
}
