//! Texels as they are stored: 8, 16 or 32 bits a channel, one to four channels.

use std::sync::LazyLock;

use half::f16;

use super::Texel;
use crate::spectrum::srgb_decode;

/// What the numbers of an image mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// Colours with the curve of sRGB (IEC 61966-2-1); opacity is linear.
    #[default]
    Srgb,
    /// Colours in linear light, with the primaries of sRGB.
    Linear,
    /// Numbers that are no colours, such as roughness or normals.
    Raw,
}

/// The number format of texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TexelFormat {
    /// 8 bits, 255 is 1.
    U8,
    /// 16 bits, 65535 is 1.
    U16,
    /// Half precision.
    F16,
    /// Single precision.
    F32,
}

/// The numbers of an image, row after row from the top, channels beside each other.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// See [`TexelFormat::U8`].
    U8(Box<[u8]>),
    /// See [`TexelFormat::U16`].
    U16(Box<[u16]>),
    /// See [`TexelFormat::F16`].
    F16(Box<[f16]>),
    /// See [`TexelFormat::F32`].
    F32(Box<[f32]>),
}

impl Texels {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::F16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Their format.
    pub fn format(&self) -> TexelFormat {
        match self {
            Self::U8(_) => TexelFormat::U8,
            Self::U16(_) => TexelFormat::U16,
            Self::F16(_) => TexelFormat::F16,
            Self::F32(_) => TexelFormat::F32,
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => 2 * values.len(),
            Self::F16(values) => 2 * values.len(),
            Self::F32(values) => 4 * values.len(),
        }
    }

    /// A value as it is stored, in [0, 1] for integers.
    #[inline]
    fn value(&self, index: usize) -> f32 {
        match self {
            Self::U8(values) => f32::from(values[index]) / 255.0,
            Self::U16(values) => f32::from(values[index]) / 65535.0,
            Self::F16(values) => values[index].to_f32(),
            Self::F32(values) => values[index],
        }
    }

    /// A value that has the curve of sRGB, in linear light.
    #[inline]
    fn decoded(&self, index: usize) -> f32 {
        match self {
            Self::U8(values) => SRGB_8[usize::from(values[index])],
            Self::U16(values) => SRGB_16[usize::from(values[index])],
            // Values beyond 1 go on along the curve.
            Self::F16(values) => srgb_decode(values[index].to_f32().max(0.0)),
            Self::F32(values) => srgb_decode(values[index].max(0.0)),
        }
    }
}

static SRGB_8: LazyLock<Box<[f32]>> =
    LazyLock::new(|| (0..=255_u8).map(|v| srgb_decode(f32::from(v) / 255.0)).collect());
static SRGB_16: LazyLock<Box<[f32]>> =
    LazyLock::new(|| (0..=65535_u16).map(|v| srgb_decode(f32::from(v) / 65535.0)).collect());

/// An image as it is stored. Its texels are (channel, opacity), or (red, green, blue, opacity), where the opacity may be missing.
#[derive(Clone, Debug, PartialEq)]
pub struct TexelImage {
    width: u32,
    height: u32,
    channels: u32,
    texels: Texels,
}

/// Most texels of an image: 16,384 x 16,384.
pub(super) const MOST_TEXELS: u64 = 1 << 28;

impl TexelImage {
    /// An image of `width` x `height` texels of 1 to 4 channels, of which floating-point ones are finite.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn new(width: u32, height: u32, channels: u32, texels: Texels) -> Result<Self, String> {
        check_size(width, height)?;
        if !(1..=4).contains(&channels) {
            return Err(format!("the image has {channels} channels, expected 1 to 4"));
        }
        let expected = u64::from(width) * u64::from(height) * u64::from(channels);
        if texels.len() as u64 != expected {
            return Err(format!(
                "the image has {} values, expected {width} x {height} texels of {channels} channels, which are {expected}",
                texels.len()
            ));
        }
        let broken = match &texels {
            Texels::U8(_) | Texels::U16(_) => None,
            Texels::F16(values) => values.iter().position(|v| !v.is_finite()),
            Texels::F32(values) => values.iter().position(|v| !v.is_finite()),
        };
        if let Some(index) = broken {
            let texel = index as u64 / u64::from(channels);
            let (x, y) = (texel % u64::from(width), texel / u64::from(width));
            return Err(format!("the texel at column {x}, row {y} is not finite"));
        }
        Ok(Self { width, height, channels, texels })
    }

    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of channels: 1 to 4.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// The stored values.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Whether the image has an opacity.
    pub fn has_opacity(&self) -> bool {
        self.channels.is_multiple_of(2)
    }

    /// The texel of a column and a row from the top, both in range. Images of one channel have the same in red, green and blue.
    #[inline]
    pub fn texel(&self, x: u32, y: u32, space: ColorSpace) -> Texel {
        let first = (y as usize * self.width as usize + x as usize) * self.channels as usize;
        let color = |channel: usize| match space {
            ColorSpace::Srgb => self.texels.decoded(first + channel),
            ColorSpace::Linear | ColorSpace::Raw => self.texels.value(first + channel),
        };
        let other = |channel: usize| self.texels.value(first + channel);
        match self.channels {
            1 => {
                let grey = color(0);
                [grey, grey, grey, 1.0]
            }
            2 => {
                let grey = color(0);
                [grey, grey, grey, other(1)]
            }
            3 => [color(0), color(1), color(2), 1.0],
            _ => [color(0), color(1), color(2), other(3)],
        }
    }
}

/// Checks the size of an image before it is decoded.
pub(super) fn check_size(width: u32, height: u32) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err(format!("the image has {width} x {height} texels, expected at least one"));
    }
    if u64::from(width) * u64::from(height) > MOST_TEXELS {
        return Err(format!("the image has {width} x {height} texels, expected {MOST_TEXELS} at most"));
    }
    Ok(())
}
