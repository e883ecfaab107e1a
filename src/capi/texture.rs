//! Textures: images of files or of the host's memory, patterns, and what of a material they vary.

use std::any::Any;
use std::ffi::c_char;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use half::f16;

use super::boundary::{UserData, need, on, optional_text, read_sized, text, write_sized};
use super::describe::find;
use super::read::{enumeration, flag};
use super::scene::etd_scene;
use super::sharing::shared;
use super::status::{ETD_OUT_OF_MEMORY, Failure, Result, etd_status};
use super::surface::find_number;
use super::types::*;
use crate::buffer::{Buffer, Element};
use crate::desc::{
    ImageTextureDesc, Projection, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource,
};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::texture::{ColorSpace, Pattern, Procedural, TexelImage, Texels, TextureFilter, Wrap, read_image};

/// Adds a texture, which materials may then use (`etd_scene_set_material_texture`).
///
/// `name`: name for `etd_scene_find_texture`, unique among textures; NULL: none. `*out_texture` receives the texture's number.
/// Errors: `ETD_INVALID_ARGUMENT` for sizes, strides or pointers that are not possible, `ETD_IO` and `ETD_UNSUPPORTED` for a
/// file, `ETD_INVALID_SCENE` for a number out of range or a texel that is not finite. Thread-safe.
///
/// # Safety
/// The texels must be readable as `texture` describes them; with `ETD_SHARE` until `release` is called, and no texel may be
/// written to but as the documentation of `sharing` allows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_add_texture(
    scene: *mut etd_scene,
    name: *const c_char,
    texture: *const etd_texture,
    out_texture: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            need(out_texture, "out_texture")?;
            let name = optional_text(name, "name")?;
            let path = format!("textures[{}]", scene.desc().textures.len());
            let number = with_texture(texture, &path, |it| {
                scene.edit(|desc| desc.add_texture(TextureDesc { name: name.to_owned(), ..it }))
            })?;
            out_texture.write(number as u32);
            Ok(())
        })
    }
}

/// Replaces a texture, for all materials that use it. Only this texture is prepared again in the next build. Texels that were
/// shared before are released once no build and no render reads them any more. Thread-safe.
///
/// # Safety
/// The contract of `etd_scene_add_texture`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_texture(
    scene: *mut etd_scene,
    texture: u32,
    value: *const etd_texture,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            // The old texture is dropped once no lock is held, because the drop may call the host's release function.
            let old = Arc::clone(find(&scene.desc().textures, texture, "texture")?);
            with_texture(value, &old.path, |it| scene.edit(|desc| desc.set_texture(texture as usize, it)))
        })
    }
}

/// Takes note that the host has changed texels that it shares with this texture. Only this texture is prepared again in the
/// next build. Errors: `ETD_INVALID_SCENE` for a pattern, and for a texel that is not finite. Thread-safe.
///
/// # Safety
/// `scene` must be NULL or a scene.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_update_texture(scene: *mut etd_scene, texture: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find(&scene.desc().textures, texture, "texture")?;
            scene.edit(|desc| desc.update_texture(texture as usize))
        })
    }
}

/// Returns a texture as described now. `file`, `texels`, `release` and `user_data` are NULL; size, channels and format are
/// those of the image. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_texture(
    scene: *const etd_scene,
    texture: u32,
    out_texture: *mut etd_texture,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            write_sized(out_texture, "out_texture", texture_out(find(&desc.textures, texture, "texture")?))
        })
    }
}

/// Returns the number of the texture with a name. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_find_texture(
    scene: *const etd_scene,
    name: *const c_char,
    out_texture: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe { find_number(scene, name, out_texture, "texture", |scene, name| scene.desc().find_texture(name)) }
}

/// Sets the texture of one parameter of a material, or removes it.
///
/// `parameter`: the name that scene files use in a material's `textures`, such as "color", "roughness", "base_color",
/// "opacity", "emission", "normal". `binding`: NULL, or a texture of `ETD_NONE`, for none. Errors: `ETD_INVALID_SCENE` for a parameter that
/// the material does not have. `etd_scene_set_material` keeps the textures of a material. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_set_material_texture(
    scene: *mut etd_scene,
    material: u32,
    parameter: *const c_char,
    binding: *const etd_texture_binding,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            find(&scene.desc().materials, material, "material")?;
            let key = key(text(parameter, "parameter")?)?;
            let to = if binding.is_null() { None } else { bound(key, &read_sized(binding, "binding")?)? };
            scene.edit(|desc| desc.set_material_texture(material as usize, key, to))
        })
    }
}

/// Returns the texture of one parameter of a material as described now: `ETD_NONE` where it has none. `parameter`: as for
/// `etd_scene_set_material_texture`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_material_texture(
    scene: *const etd_scene,
    material: u32,
    parameter: *const c_char,
    out_binding: *mut etd_texture_binding,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let key = key(text(parameter, "parameter")?)?;
            let desc = scene.desc();
            let it = find(&desc.materials, material, "material")?.textured(key);
            let channel = it.map_or(ETD_CHANNEL_DEFAULT, |it| match it.channel {
                TextureChannel::Default => ETD_CHANNEL_DEFAULT,
                TextureChannel::Red => ETD_CHANNEL_RED,
                TextureChannel::Green => ETD_CHANNEL_GREEN,
                TextureChannel::Blue => ETD_CHANNEL_BLUE,
                TextureChannel::Alpha => ETD_CHANNEL_ALPHA,
            });
            let value = etd_texture_binding {
                struct_size: size_of::<etd_texture_binding>(),
                texture: it.map_or(ETD_NONE, |it| it.texture as u32),
                channel: channel.number(),
                strength: it.map_or(1.0, |it| it.strength),
                cutoff: it.map_or(0.0, |it| it.cutoff),
            };
            write_sized(out_binding, "out_binding", value)
        })
    }
}

/// The parameter of a name.
fn key(name: &str) -> Result<TextureKey> {
    TextureKey::by_name(name).ok_or_else(|| {
        let known: Vec<&str> = TextureKey::ALL.iter().map(|key| key.name()).collect();
        let given: String = name.chars().take(32).collect();
        Failure::argument(format!("parameter is '{given}', expected one of {}", known.join(", ")))
    })
}

/// Reads what a parameter takes from a texture; `None` stands for no texture.
fn bound(key: TextureKey, it: &etd_texture_binding) -> Result<Option<TextureBinding>> {
    let channel = match enumeration("binding.channel", it.channel)? {
        ETD_CHANNEL_DEFAULT => TextureChannel::Default,
        ETD_CHANNEL_RED => TextureChannel::Red,
        ETD_CHANNEL_GREEN => TextureChannel::Green,
        ETD_CHANNEL_BLUE => TextureChannel::Blue,
        ETD_CHANNEL_ALPHA => TextureChannel::Alpha,
    };
    let binding =
        TextureBinding { key, texture: it.texture as usize, channel, strength: it.strength, cutoff: it.cutoff };
    Ok((it.texture != ETD_NONE).then_some(binding))
}

/// Reads a texture, which has this JSON path, and passes it to `take`. If that succeeds, the host's release function is called later; otherwise it is
/// never called.
///
/// # Safety
/// The contract of `etd_scene_add_texture`.
unsafe fn with_texture<R>(
    pointer: *const etd_texture,
    path: &str,
    take: impl FnOnce(TextureDesc) -> Result<R>,
) -> Result<R> {
    // SAFETY: the caller keeps this function's contract.
    let it = unsafe { read_sized(pointer, "texture") }?;
    let vertex_colors = flag("texture.vertex_colors", it.vertex_colors)?;
    let made = |source| {
        let (name, path) = (String::new(), String::new());
        Ok(TextureDesc { name, path, source, mapping: mapping(&it)?, vertex_colors })
    };
    let kind = enumeration::<etd_texture_kind>("texture.kind", it.kind)?;
    if kind == ETD_TEXTURE_VERTEX_COLORS {
        return take(TextureDesc::of_vertex_colors(String::new(), String::new()));
    }
    if kind != ETD_TEXTURE_IMAGE {
        return take(made(TextureSource::Procedural(pattern(&it)?))?);
    }
    if enumeration::<etd_coordinates>("texture.coordinates", it.coordinates)? == ETD_COORDINATES_SPACE {
        return Err(Failure::argument("texture.coordinates are those of space, but an image lies on surfaces"));
    }
    // SAFETY: the caller keeps this function's contract.
    let file = unsafe { optional_text(it.file, "texture.file") }?;
    if !file.is_empty() {
        let (image, suggested) = read_image(Path::new(file)).map_err(|error| error.at(format!("{path}.file")))?;
        return take(made(TextureSource::Image(image_of(&it, image, suggested, Some(file.into()))?))?);
    }
    let is_shared = match enumeration("texture.sharing", it.sharing)? {
        ETD_COPY => false,
        ETD_SHARE => true,
    };
    let release = if is_shared { it.release } else { None };
    let read = |owner: &_| {
        // SAFETY: the caller keeps this function's contract; copies are finished before this function ends.
        let (image, suggested) = unsafe { texels(&it, is_shared, owner, path) }?;
        made(TextureSource::Image(image_of(&it, image, suggested, None)?))
    };
    shared(release, UserData(it.user_data), read, take)
}

/// An image with what is said of it.
fn image_of(
    it: &etd_texture,
    image: TexelImage,
    suggested_space: ColorSpace,
    file: Option<PathBuf>,
) -> Result<ImageTextureDesc> {
    let wrap = |name, number| -> Result<Wrap> {
        Ok(match enumeration(name, number)? {
            ETD_WRAP_REPEAT => Wrap::Repeat,
            ETD_WRAP_MIRROR => Wrap::Mirror,
            ETD_WRAP_CLAMP => Wrap::Clamp,
            ETD_WRAP_BLACK => Wrap::Black,
        })
    };
    Ok(ImageTextureDesc {
        image: Arc::new(image),
        file,
        color_space: match enumeration("texture.color_space", it.color_space)? {
            ETD_COLOR_SPACE_BY_USE => None,
            ETD_COLOR_SPACE_SRGB => Some(ColorSpace::Srgb),
            ETD_COLOR_SPACE_LINEAR => Some(ColorSpace::Linear),
            ETD_COLOR_SPACE_RAW => Some(ColorSpace::Raw),
        },
        suggested_space,
        wrap: [wrap("texture.wrap_u", it.wrap_u)?, wrap("texture.wrap_v", it.wrap_v)?],
        filter: match enumeration("texture.filter", it.filter)? {
            ETD_TEXTURE_FILTER_BILINEAR => TextureFilter::Bilinear,
            ETD_TEXTURE_FILTER_NEAREST => TextureFilter::Nearest,
            ETD_TEXTURE_FILTER_MIP => TextureFilter::Mip,
            ETD_TEXTURE_FILTER_EWA => TextureFilter::Ewa,
            ETD_TEXTURE_FILTER_STOCHASTIC => TextureFilter::Stochastic,
        },
    })
}

/// The host's texels of the texture with this JSON path, in place or copied, and the colour space that their format suggests.
///
/// # Safety
/// The contract of `etd_scene_add_texture`.
unsafe fn texels(
    it: &etd_texture,
    is_shared: bool,
    owner: &Arc<dyn Any + Send + Sync>,
    path: &str,
) -> Result<(TexelImage, ColorSpace)> {
    // SAFETY: the caller keeps this function's contract.
    let (texels, row, space) = unsafe {
        match enumeration("texture.texel_format", it.texel_format)? {
            ETD_TEXEL_UINT8 => {
                let (values, row) = values::<u8>(it, is_shared, owner)?;
                (Texels::U8(values), row, ColorSpace::Srgb)
            }
            ETD_TEXEL_UINT16 => {
                let (values, row) = values::<u16>(it, is_shared, owner)?;
                (Texels::U16(values), row, ColorSpace::Srgb)
            }
            ETD_TEXEL_HALF => {
                let (values, row) = values::<f16>(it, is_shared, owner)?;
                (Texels::F16(values), row, ColorSpace::Linear)
            }
            ETD_TEXEL_FLOAT => {
                let (values, row) = values::<f32>(it, is_shared, owner)?;
                (Texels::F32(values), row, ColorSpace::Linear)
            }
        }
    };
    let image = TexelImage::with_rows(it.width, it.height, it.channels, row, texels);
    image.map(|image| (image, space)).map_err(|message| crate::Error::invalid(path, message).into())
}

/// The values of an image, and their number from one row to the next. Copies have rows without gaps.
///
/// # Safety
/// The contract of `etd_scene_add_texture`.
unsafe fn values<T: Element>(
    it: &etd_texture,
    is_shared: bool,
    owner: &Arc<dyn Any + Send + Sync>,
) -> Result<(Buffer<T>, usize)> {
    if it.width == 0 || it.height == 0 || !(1..=4).contains(&it.channels) {
        let message = format!(
            "texture.width, height and channels are {}, {} and {}, expected 1 or more, 1 or more, and 1 to 4",
            it.width, it.height, it.channels
        );
        return Err(Failure::argument(message));
    }
    let used = it.width as usize * it.channels as usize;
    let bytes = size_of::<T>();
    let stride = if it.row_stride == 0 { used * bytes } else { it.row_stride };
    if !stride.is_multiple_of(bytes) || stride < used * bytes {
        let message =
            format!("texture.row_stride is {stride}, expected a multiple of {bytes}, {} or more", used * bytes);
        return Err(Failure::argument(message));
    }
    let row = stride / bytes;
    let count = (it.height as usize - 1).checked_mul(row).and_then(|before| before.checked_add(used));
    let count = count.ok_or_else(|| Failure::argument("texture: the image is larger than any memory"))?;
    // SAFETY: the caller keeps this function's contract.
    let all = unsafe { Buffer::foreign(it.texels.cast::<T>(), count, bytes, Arc::clone(owner)) };
    let all = all.map_err(|error| Failure::argument(format!("texture.texels: {}", error.message())))?;
    if is_shared {
        return Ok((all, row));
    }
    let count = used * it.height as usize;
    let mut values = Vec::new();
    values
        .try_reserve_exact(count)
        .map_err(|_| Failure::new(ETD_OUT_OF_MEMORY, format!("no room for {count} values of an image")))?;
    for y in 0..it.height as usize {
        values.extend((y * row..y * row + used).map(|i| all.get(i)));
    }
    Ok((values.into(), used))
}

/// Reads a pattern.
fn pattern(it: &etd_texture) -> Result<Procedural> {
    let octaves = if it.octaves == 0 { 4 } else { it.octaves };
    let turbulence = it.turbulence;
    let pattern = match enumeration("texture.kind", it.kind)? {
        // The other two are no patterns, and not asked for here.
        ETD_TEXTURE_IMAGE | ETD_TEXTURE_VERTEX_COLORS | ETD_TEXTURE_CHECKER => Pattern::Checker,
        ETD_TEXTURE_GRID => Pattern::Grid { width: it.line_width },
        ETD_TEXTURE_GRADIENT => Pattern::Gradient,
        ETD_TEXTURE_NOISE => Pattern::Noise { octaves, turbulent: false },
        ETD_TEXTURE_TURBULENCE => Pattern::Noise { octaves, turbulent: true },
        ETD_TEXTURE_MARBLE => Pattern::Marble { octaves, turbulence },
        ETD_TEXTURE_WOOD => Pattern::Wood { octaves, turbulence },
    };
    let in_space = enumeration::<etd_coordinates>("texture.coordinates", it.coordinates)? == ETD_COORDINATES_SPACE;
    Ok(Procedural { pattern, colors: it.colors.map(Rgb::from_array), in_space })
}

/// Reads where a texture lies.
fn mapping(it: &etd_texture) -> Result<TextureMapping> {
    let scale = if it.scale == [0.0; 3] { [1.0; 3] } else { it.scale };
    let ([su, sv, _], [u, v, _]) = (scale, it.offset);
    let (scale2, offset2, rotation) = ([su, sv], [u, v], it.rotation_deg.to_radians());
    let projection = match enumeration("texture.coordinates", it.coordinates)? {
        ETD_COORDINATES_UV => {
            return Ok(TextureMapping::Uv { set: it.uv_set, scale: scale2, rotation, offset: offset2 });
        }
        ETD_COORDINATES_SPACE if it.rotation_deg != 0.0 => {
            return Err(Failure::argument("texture.rotation_deg is not 0: only coordinates on surfaces are turned"));
        }
        ETD_COORDINATES_SPACE => {
            let (scale, offset) = (DVec3::from_array(scale), DVec3::from_array(it.offset));
            return Ok(TextureMapping::Space { scale, offset });
        }
        ETD_COORDINATES_BOX => Projection::Box,
        ETD_COORDINATES_PLANAR_X => Projection::X,
        ETD_COORDINATES_PLANAR_Y => Projection::Y,
        ETD_COORDINATES_PLANAR_Z => Projection::Z,
    };
    Ok(TextureMapping::Projected { projection, scale: scale2, rotation, offset: offset2 })
}

/// Converts a texture to the host's structure.
fn texture_out(texture: &TextureDesc) -> etd_texture {
    let mut it = etd_texture {
        struct_size: size_of::<etd_texture>(),
        kind: ETD_TEXTURE_IMAGE.number(),
        color_space: ETD_COLOR_SPACE_BY_USE.number(),
        file: std::ptr::null(),
        texels: std::ptr::null(),
        row_stride: 0,
        width: 0,
        height: 0,
        channels: 0,
        texel_format: ETD_TEXEL_UINT8.number(),
        sharing: ETD_COPY.number(),
        filter: ETD_TEXTURE_FILTER_BILINEAR.number(),
        release: None,
        user_data: std::ptr::null_mut(),
        wrap_u: ETD_WRAP_REPEAT.number(),
        wrap_v: ETD_WRAP_REPEAT.number(),
        colors: [[0.0; 3], [1.0; 3]],
        line_width: 0.1,
        turbulence: 1.0,
        octaves: 4,
        coordinates: ETD_COORDINATES_UV.number(),
        scale: [1.0; 3],
        rotation_deg: 0.0,
        offset: [0.0; 3],
        vertex_colors: texture.vertex_colors.into(),
        uv_set: texture.mapping.uv_set(),
    };
    match texture.mapping {
        TextureMapping::Uv { scale: [su, sv], rotation, offset: [u, v], .. }
        | TextureMapping::Projected { scale: [su, sv], rotation, offset: [u, v], .. } => {
            (it.scale, it.offset, it.rotation_deg) = ([su, sv, 1.0], [u, v, 0.0], rotation.to_degrees());
        }
        TextureMapping::Space { scale, offset } => {
            (it.scale, it.offset) = (scale.to_array(), offset.to_array());
        }
    }
    it.coordinates = match texture.mapping {
        TextureMapping::Uv { .. } => ETD_COORDINATES_UV,
        TextureMapping::Space { .. } => ETD_COORDINATES_SPACE,
        TextureMapping::Projected { projection, .. } => match projection {
            Projection::Box => ETD_COORDINATES_BOX,
            Projection::X => ETD_COORDINATES_PLANAR_X,
            Projection::Y => ETD_COORDINATES_PLANAR_Y,
            Projection::Z => ETD_COORDINATES_PLANAR_Z,
        },
    }
    .number();
    match &texture.source {
        TextureSource::Image(desc) => image_out(desc, &mut it),
        TextureSource::Procedural(desc) => pattern_out(desc, &mut it),
        TextureSource::White => it.kind = ETD_TEXTURE_VERTEX_COLORS.number(),
    }
    it
}

fn image_out(desc: &ImageTextureDesc, it: &mut etd_texture) {
    (it.width, it.height, it.channels) = (desc.image.width(), desc.image.height(), desc.image.channels());
    let (format, is_foreign) = match desc.image.texels() {
        Texels::U8(values) => (ETD_TEXEL_UINT8, values.is_foreign()),
        Texels::U16(values) => (ETD_TEXEL_UINT16, values.is_foreign()),
        Texels::F16(values) => (ETD_TEXEL_HALF, values.is_foreign()),
        Texels::F32(values) => (ETD_TEXEL_FLOAT, values.is_foreign()),
    };
    it.texel_format = format.number();
    it.sharing = if is_foreign { ETD_SHARE } else { ETD_COPY }.number();
    it.color_space = match desc.color_space {
        None => ETD_COLOR_SPACE_BY_USE,
        Some(ColorSpace::Srgb) => ETD_COLOR_SPACE_SRGB,
        Some(ColorSpace::Linear) => ETD_COLOR_SPACE_LINEAR,
        Some(ColorSpace::Raw) => ETD_COLOR_SPACE_RAW,
    }
    .number();
    it.filter = match desc.filter {
        TextureFilter::Bilinear => ETD_TEXTURE_FILTER_BILINEAR,
        TextureFilter::Nearest => ETD_TEXTURE_FILTER_NEAREST,
        TextureFilter::Mip => ETD_TEXTURE_FILTER_MIP,
        TextureFilter::Ewa => ETD_TEXTURE_FILTER_EWA,
        TextureFilter::Stochastic => ETD_TEXTURE_FILTER_STOCHASTIC,
    }
    .number();
    [it.wrap_u, it.wrap_v] = desc.wrap.map(|wrap| {
        match wrap {
            Wrap::Repeat => ETD_WRAP_REPEAT,
            Wrap::Mirror => ETD_WRAP_MIRROR,
            Wrap::Clamp => ETD_WRAP_CLAMP,
            Wrap::Black => ETD_WRAP_BLACK,
        }
        .number()
    });
}

fn pattern_out(desc: &Procedural, it: &mut etd_texture) {
    it.colors = desc.colors.map(|color| color.to_array());
    it.kind = match desc.pattern {
        Pattern::Checker => ETD_TEXTURE_CHECKER,
        Pattern::Grid { width } => {
            it.line_width = width;
            ETD_TEXTURE_GRID
        }
        Pattern::Gradient => ETD_TEXTURE_GRADIENT,
        Pattern::Noise { octaves, turbulent } => {
            it.octaves = octaves;
            if turbulent { ETD_TEXTURE_TURBULENCE } else { ETD_TEXTURE_NOISE }
        }
        Pattern::Marble { octaves, turbulence } => {
            (it.octaves, it.turbulence) = (octaves, turbulence);
            ETD_TEXTURE_MARBLE
        }
        Pattern::Wood { octaves, turbulence } => {
            (it.octaves, it.turbulence) = (octaves, turbulence);
            ETD_TEXTURE_WOOD
        }
    }
    .number();
}
