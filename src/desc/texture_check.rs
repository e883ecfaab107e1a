//! Checks of textures, and of what materials do with them.

use std::sync::Arc;

use super::json::{elided, join};
use super::validate::{number, reflectance};
use super::{
    EnvironmentDesc, MaterialDesc, MeshDesc, SkyDesc, SkyProjection, SpectrumDesc, SpectrumKey, TextureDesc,
    TextureKey, TextureMapping, TextureSource,
};
use crate::texture::{Pattern, TextureFilter};
use crate::{Error, Result};

/// Most octaves of noise: beyond, their size is below single precision.
const MOST_OCTAVES: u32 = 16;

/// Checks the numbers of a texture.
pub(super) fn texture(texture: &TextureDesc) -> Result<()> {
    let TextureDesc { path, source, mapping, .. } = texture;
    let at = |key: &str| join(path, key);
    if let TextureMapping::Uv { set, .. } = *mapping
        && set as usize >= MeshDesc::MOST_UV_SETS
    {
        let last = MeshDesc::MOST_UV_SETS - 1;
        return Err(Error::invalid(
            at("uvSet"),
            format!("{set} is out of range, expected a whole number from 0 to {last}"),
        ));
    }
    match *mapping {
        TextureMapping::Uv { scale, rotation, offset, .. }
        | TextureMapping::Projected { scale, rotation, offset, .. } => {
            for (i, value) in scale.into_iter().enumerate() {
                number(&at(&format!("scale[{i}]")), value)?;
            }
            number(&at("rotation"), rotation)?;
            for (i, value) in offset.into_iter().enumerate() {
                number(&at(&format!("offset[{i}]")), value)?;
            }
        }
        TextureMapping::Space { scale, offset } => {
            super::validate::vector(&at("scale"), scale.to_array())?;
            super::validate::vector(&at("offset"), offset.to_array())?;
        }
    }
    let procedural = match source {
        TextureSource::Procedural(procedural) => procedural,
        TextureSource::Image(_) if matches!(mapping, TextureMapping::Space { .. }) => {
            return Err(Error::invalid(
                at("coordinates"),
                "an image lies on surfaces, expected `uv`, `box` or `planar-…`",
            ));
        }
        TextureSource::White if !texture.vertex_colors => {
            return Err(Error::invalid(
                at("vertexColors"),
                "the texture is white everywhere, expected colours of vertices",
            ));
        }
        TextureSource::Image(_) | TextureSource::White => return Ok(()),
    };
    if procedural.in_space != matches!(mapping, TextureMapping::Space { .. }) {
        return Err(Error::invalid(
            at("coordinates"),
            "the pattern and its mapping disagree, expected both in space or neither",
        ));
    }
    for (i, color) in procedural.colors.into_iter().enumerate() {
        reflectance(&at(&format!("colors[{i}]")), color.to_f64())?;
    }
    let octaves = |octaves: u32| {
        if (1..=MOST_OCTAVES).contains(&octaves) {
            return Ok(());
        }
        let message = format!("{octaves} is out of range, expected a whole number from 1 to {MOST_OCTAVES}");
        Err(Error::invalid(at("octaves"), message))
    };
    match procedural.pattern {
        Pattern::Checker | Pattern::Gradient => Ok(()),
        Pattern::Grid { width } => super::validate::within(&at("lineWidth"), width.into(), 0.0, 1.0).map(|_| ()),
        Pattern::Noise { octaves: count, .. } => octaves(count),
        Pattern::Marble { octaves: count, turbulence } | Pattern::Wood { octaves: count, turbulence } => {
            octaves(count)?;
            number(&at("turbulence"), turbulence.into()).map(|_| ())
        }
    }
}

/// Checks an environment: its radiance, and its texture if it has one.
pub(super) fn environment(environment: &EnvironmentDesc, textures: &[Arc<TextureDesc>]) -> Result<()> {
    let path = &environment.path;
    super::validate::environment(path, environment.radiance.to_f64(), 1.0)?;
    let map = match &environment.sky {
        SkyDesc::Even => return Ok(()),
        SkyDesc::Formula(sky) => return super::validate::formula_sky(path, sky, environment.radiance),
        SkyDesc::HosekWilkie(sky) => return sky.check(path, environment.radiance),
        SkyDesc::Map(map) => map,
    };
    super::validate::environment_map(path, map)?;
    let at = join(path, "texture");
    let Some(texture) = textures.get(map.texture) else {
        let message = format!("texture {} of {} does not exist", map.texture, textures.len());
        return Err(Error::invalid(at, message));
    };
    let refused = |what: &str| Err(Error::invalid(&at, format!("the texture '{}' {what}", elided(&texture.name))));
    if texture.vertex_colors {
        return refused("is multiplied by the colours of vertices, which a sky has not");
    }
    match (&texture.source, texture.mapping) {
        (_, TextureMapping::Projected { .. }) => refused("is projected on surfaces, expected the coordinates `uv`"),
        (TextureSource::Image(_), mapping) if mapping != TextureMapping::default() => {
            refused("is scaled, turned or moved; a sky shows an image once and whole, and turns by `up` and `rotation`")
        }
        (TextureSource::Image(it), _) => {
            let [width, height] = [it.image.width(), it.image.height()];
            let wrong = |expected: &str| refused(&format!("is {width} x {height} texels large, expected {expected}"));
            match map.projection {
                SkyProjection::Octahedral if width != height => wrong("a square for an octahedron"),
                SkyProjection::Cube if width.checked_mul(6) != Some(height) => {
                    wrong("six squares one under another for a cube")
                }
                _ => Ok(()),
            }
        }
        _ if map.projection != SkyProjection::LatLong => refused("is no image, which this projection is for"),
        _ => Ok(()),
    }
}

/// Checks the texture of a material's temperature.
fn of_temperature(material: &MaterialDesc, texture: &TextureDesc) -> std::result::Result<(), &'static str> {
    if !matches!(material.spectrum(SpectrumKey::Emission), Some(SpectrumDesc::BlackBody(_))) {
        return Err("the material does not emit as a black body, on whose temperature the texture is a factor");
    }
    if material.textured(TextureKey::Emission).is_some() {
        return Err("a texture varies the emission already, expected one of both");
    }
    if !matches!(texture.source, TextureSource::Image(_)) {
        return Err("the texture is no image, expected one: its temperatures are turned into light before it is read");
    }
    Ok(())
}

/// Checks the textures of a material. Its model has been checked, as have `materials`, which come before it.
pub(super) fn bindings(
    material: &MaterialDesc,
    textures: &[Arc<TextureDesc>],
    materials: &[MaterialDesc],
) -> Result<()> {
    let mut model = material.bsdf;
    for (i, binding) in material.textures.iter().enumerate() {
        let key = binding.key;
        let at = join(&join(&material.path, "textures"), key.name());
        let Some(texture) = textures.get(binding.texture) else {
            let message = format!("texture {} of {} does not exist", binding.texture, textures.len());
            return Err(Error::invalid(at, message));
        };
        if material.textures[..i].iter().any(|other| other.key == key) {
            return Err(Error::invalid(at, "this parameter has a texture already"));
        }
        if key == TextureKey::FilmThickness {
            if material.film.is_none() {
                return Err(Error::invalid(at, "the material has no film, on whose thickness the texture is a factor"));
            }
        } else if !key.is_of_surface() && model.parameter(key).is_none() {
            let names: Vec<_> = model.parameters().into_iter().map(TextureKey::name).collect();
            let message = format!(
                "a texture cannot vary `{}` of this {} material, expected one of {}",
                key.name(),
                material.bsdf.kind(),
                names.join(", ")
            );
            return Err(Error::invalid(at, message));
        }
        if key == TextureKey::Emission && material.emission.is_none() {
            let message = "the material has no emission, on which the texture is a factor";
            return Err(Error::invalid(at, message));
        }
        if key == TextureKey::Temperature {
            of_temperature(material, texture).map_err(|message| Error::invalid(&at, message))?;
        }
        number(&join(&at, "strength"), binding.strength.into())?;
        let cutoff = super::validate::within(&join(&at, "cutoff"), binding.cutoff.into(), 0.0, 1.0)?;
        if cutoff > 0.0 && key != TextureKey::Opacity {
            return Err(Error::invalid(join(&at, "cutoff"), "only an opacity has a cutoff, expected 0"));
        }
        // Lamps are sampled by texels, and heights and normals are no colours.
        if texture.vertex_colors
            && matches!(key, TextureKey::Emission | TextureKey::Temperature | TextureKey::Normal | TextureKey::Bump)
        {
            let message =
                format!("`{}` cannot be multiplied by colours of vertices, expected a texture without", key.name());
            return Err(Error::invalid(at, message));
        }
        // Shadow rays would see another surface than the paths that they belong to, and slopes would be those of noise.
        if matches!(key, TextureKey::Opacity | TextureKey::Bump)
            && let TextureSource::Image(image) = &texture.source
            && image.filter == TextureFilter::Stochastic
        {
            let message = format!("`{}` cannot be filtered stochastically, expected another filter", key.name());
            return Err(Error::invalid(at, message));
        }
    }
    if material.textured(TextureKey::Normal).is_some() && material.textured(TextureKey::Bump).is_some() {
        let at = join(&join(&material.path, "textures"), "bump");
        return Err(Error::invalid(at, "the normal has a texture already, expected one of `normal` and `bump`"));
    }
    let [front, back] = match material.bsdf {
        super::BsdfDesc::Mix { materials, .. } => materials,
        super::BsdfDesc::TwoSided { front, back } => [front, back],
        _ => return Ok(()),
    };
    for part in [front, back].into_iter().filter_map(|part| materials.get(part)) {
        if let Some(binding) = part.textures.iter().find(|binding| binding.key.is_of_surface()) {
            let message = format!(
                "the material '{}' has a texture for `{}`, expected a part without: the whole material has one",
                elided(&part.name),
                binding.key.name()
            );
            return Err(Error::invalid(&material.path, message));
        }
    }
    Ok(())
}
