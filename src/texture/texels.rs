//! Texels as they are stored: 8, 16 or 32 bits a channel, one to four channels.

use std::sync::LazyLock;

use half::f16;

use super::Texel;
use crate::buffer::{Buffer, Element};
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

/// The numbers of an image, row after row from the top, channels beside each other. They may lie in the host's memory.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// See [`TexelFormat::U8`].
    U8(Buffer<u8>),
    /// See [`TexelFormat::U16`].
    U16(Buffer<u16>),
    /// See [`TexelFormat::F16`].
    F16(Buffer<f16>),
    /// See [`TexelFormat::F32`].
    F32(Buffer<f32>),
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

    /// Bytes of this library's memory: none where they lie in the host's.
    pub fn bytes(&self) -> usize {
        match self {
            Self::U8(values) => values.memory_bytes(),
            Self::U16(values) => values.memory_bytes(),
            Self::F16(values) => values.memory_bytes(),
            Self::F32(values) => values.memory_bytes(),
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
    /// Values from one row to the next.
    row: usize,
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
        Self::with_rows(width, height, channels, width as usize * channels as usize, texels)
    }

    /// As [`Self::new`], where a row begins `row` values after the one above. The last row has no gap after it.
    ///
    /// # Errors
    /// Those of [`Self::new`], and one for rows that overlap.
    pub fn with_rows(width: u32, height: u32, channels: u32, row: usize, texels: Texels) -> Result<Self, String> {
        check_size(width, height)?;
        if !(1..=4).contains(&channels) {
            return Err(format!("the image has {channels} channels, expected 1 to 4"));
        }
        let used = width as usize * channels as usize;
        if row < used {
            return Err(format!("rows begin {row} values apart, expected {used} or more"));
        }
        let expected = (height as usize - 1).checked_mul(row).and_then(|before| before.checked_add(used));
        if expected != Some(texels.len()) {
            return Err(format!(
                "the image has {} values, expected those of {width} x {height} texels of {channels} channels",
                texels.len()
            ));
        }
        let image = Self { width, height, channels, row, texels };
        image.check_values()?;
        Ok(image)
    }

    /// The same image after the host has changed texels that lie in its own memory.
    ///
    /// # Errors
    /// A sentence that says which texel is not finite.
    pub(crate) fn changed(&self) -> Result<Self, String> {
        self.check_values()?;
        Ok(self.clone())
    }

    /// Checks that all texels are finite.
    fn check_values(&self) -> Result<(), String> {
        let used = self.width as usize * self.channels as usize;
        let broken = |is_finite: &dyn Fn(usize) -> bool| {
            let places = (0..self.height as usize).flat_map(|y| (0..used).map(move |x| (x, y)));
            let broken = places.into_iter().find(|&(x, y)| !is_finite(y * self.row + x));
            broken.map_or(Ok(()), |(x, y)| {
                Err(format!("the texel at column {}, row {y} is not finite", x / self.channels as usize))
            })
        };
        match &self.texels {
            Texels::U8(_) | Texels::U16(_) => Ok(()),
            Texels::F16(values) => broken(&|i| values.get(i).is_finite()),
            Texels::F32(values) => broken(&|i| values.get(i).is_finite()),
        }
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

    /// The stored values without the gaps between rows, of which `values` are those of the image.
    pub(crate) fn without_gaps<T: Element>(&self, values: &Buffer<T>) -> impl Iterator<Item = T> + Clone {
        let used = self.width as usize * self.channels as usize;
        let values = values.clone();
        let row = self.row;
        (0..self.height as usize).flat_map(move |y| {
            let values = values.clone();
            (y * row..y * row + used).map(move |i| values.get(i))
        })
    }

    /// Number of values without the gaps between rows.
    pub(crate) fn value_count(&self) -> usize {
        self.width as usize * self.height as usize * self.channels as usize
    }

    /// Whether the image has an opacity.
    pub fn has_opacity(&self) -> bool {
        self.channels.is_multiple_of(2)
    }

    /// The texel of a column and a row from the top, both in range. Images of one channel have the same in red, green and blue.
    #[inline]
    pub fn texel(&self, x: u32, y: u32, space: ColorSpace) -> Texel {
        let first = y as usize * self.row + x as usize * self.channels as usize;
        // The format and the space are asked once for all channels.
        let is_srgb = space == ColorSpace::Srgb;
        match &self.texels {
            Texels::U8(values) if is_srgb => {
                let table: &[f32] = &SRGB_8;
                self.read(values, first, |v| table[usize::from(v)], u8_value)
            }
            Texels::U8(values) => self.read(values, first, u8_value, u8_value),
            Texels::U16(values) if is_srgb => {
                let table: &[f32] = &SRGB_16;
                self.read(values, first, |v| table[usize::from(v)], u16_value)
            }
            Texels::U16(values) => self.read(values, first, u16_value, u16_value),
            // Values beyond 1 go on along the curve.
            Texels::F16(values) if is_srgb => {
                self.read(values, first, |v| srgb_decode(v.to_f32().max(0.0)), f16::to_f32)
            }
            Texels::F16(values) => self.read(values, first, f16::to_f32, f16::to_f32),
            Texels::F32(values) if is_srgb => self.read(values, first, |v| srgb_decode(v.max(0.0)), |v| v),
            Texels::F32(values) => self.read(values, first, |v| v, |v| v),
        }
    }

    /// The texel whose values begin at `first`: colours and opacity by these functions.
    #[inline(always)]
    fn read<T: Element>(
        &self,
        values: &Buffer<T>,
        first: usize,
        color: impl Fn(T) -> f32,
        opacity: impl Fn(T) -> f32,
    ) -> Texel {
        match self.channels {
            1 => {
                let grey = color(values.get(first));
                [grey, grey, grey, 1.0]
            }
            2 => {
                let [grey, a] = values.array(first);
                let grey = color(grey);
                [grey, grey, grey, opacity(a)]
            }
            3 => {
                let [r, g, b] = values.array(first);
                [color(r), color(g), color(b), 1.0]
            }
            _ => {
                let [r, g, b, a] = values.array(first);
                [color(r), color(g), color(b), opacity(a)]
            }
        }
    }
}

/// A number of 8 bits, of which 255 is 1.
fn u8_value(value: u8) -> f32 {
    f32::from(value) / 255.0
}

/// A number of 16 bits, of which 65535 is 1.
fn u16_value(value: u16) -> f32 {
    f32::from(value) / 65535.0
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
