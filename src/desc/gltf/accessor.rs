//! Reads the numbers of accessors. Sizes are checked against the bytes that are there before anything is allocated.

use std::cell::Cell;

use super::buffers::Buffers;
use super::document::{Accessor, Document, SparsePart, element, missing};
use crate::{Error, ErrorKind, Result};

/// Most elements of an accessor that has no bytes of its own: all of its elements are zero but for the sparse ones.
const ZEROS_LIMIT: u64 = 1 << 24;

/// Most elements that are read in all. Many parts of a file may name one accessor, so that its size alone bounds no time.
const READ_LIMIT: u64 = 1 << 31;

/// The types of components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(path: &str, code: u32) -> Result<Self> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                let message = format!("{code} is no component type, expected 5120, 5121, 5122, 5123, 5125 or 5126");
                return Err(Error::invalid(path, message));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::I8 => "BYTE",
            Self::U8 => "UNSIGNED_BYTE",
            Self::I16 => "SHORT",
            Self::U16 => "UNSIGNED_SHORT",
            Self::U32 => "UNSIGNED_INT",
            Self::F32 => "FLOAT",
        }
    }

    /// The component at the beginning of `bytes`, which hold it. Normalised integers are fractions of the greatest one.
    fn number(self, bytes: &[u8], normalized: bool) -> f32 {
        let scaled = |value: f32, greatest: f32| if normalized { (value / greatest).max(-1.0) } else { value };
        match self {
            Self::I8 => scaled(f32::from(bytes[0] as i8), 127.0),
            Self::U8 => scaled(f32::from(bytes[0]), 255.0),
            Self::I16 => scaled(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => scaled(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => scaled(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }

    fn whole(self, bytes: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => bytes[0].into(),
            Self::I16 | Self::U16 => u16::from_le_bytes([bytes[0], bytes[1]]).into(),
            Self::U32 | Self::F32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// Which components an attribute may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Allowed {
    /// `FLOAT` alone, and small integers where the file uses `KHR_mesh_quantization`.
    Floats,
    /// `FLOAT`, and normalised unsigned bytes and shorts; all small integers with `KHR_mesh_quantization`.
    Fractions,
    /// `FLOAT` and all normalised integers: values of animations.
    Animated,
    /// Whole numbers.
    Whole,
    /// Whole numbers of two bytes at most.
    SmallWhole,
}

/// Elements in the memory of a buffer.
struct Source<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// All accessors of a document.
pub(super) struct Accessors<'a> {
    document: &'a Document<'a>,
    buffers: &'a Buffers<'a>,
    quantized: bool,
    /// How many more elements may be read.
    left: Cell<u64>,
}

impl<'a> Accessors<'a> {
    pub fn new(document: &'a Document<'a>, buffers: &'a Buffers<'a>) -> Self {
        let mut used = document.extensions_used.iter().chain(&document.extensions_required);
        Self {
            document,
            buffers,
            quantized: used.any(|name| name == "KHR_mesh_quantization"),
            left: Cell::new(READ_LIMIT),
        }
    }

    /// Counts elements before they are read.
    pub fn spend(&self, path: &str, elements: u64) -> Result<()> {
        let left = self.left.get().checked_sub(elements).ok_or_else(|| {
            let message =
                format!("parts of the file are used too often, expected {READ_LIMIT} elements to read at most");
            Error::invalid(path, message)
        })?;
        self.left.set(left);
        Ok(())
    }

    /// The number of elements of the accessor that `path` names.
    pub fn count(&self, path: &str, index: u64) -> Result<u64> {
        Ok(element(&self.document.accessors, "accessors", path, index)?.1.count)
    }

    /// Whether the elements of the accessor that `path` names are of this type, such as `VEC3`.
    pub fn is_of_type(&self, path: &str, index: u64, kind: &str) -> Result<bool> {
        Ok(element(&self.document.accessors, "accessors", path, index)?.1.kind == kind)
    }

    /// Whether the accessor has bytes of its own.
    pub fn has_bytes(&self, path: &str, index: u64) -> Result<bool> {
        let (_, accessor) = element(&self.document.accessors, "accessors", path, index)?;
        Ok(accessor.buffer_view.is_some() || accessor.sparse.is_some())
    }

    /// The numbers of each component of the elements of the accessor that `path` names, which must be finite.
    pub fn floats<const N: usize>(&self, path: &str, index: u64, allowed: Allowed) -> Result<Vec<[f32; N]>> {
        let normalized = element(&self.document.accessors, "accessors", path, index)?.1.normalized;
        let values = self.read(path, index, allowed, |component, bytes| component.number(bytes, normalized))?;
        let bad = |value: &[f32; N]| value.iter().any(|number| !number.is_finite());
        if let Some(i) = values.iter().position(bad) {
            return Err(Error::invalid(path, format!("element {i} is {:?}, expected finite numbers", values[i])));
        }
        Ok(values)
    }

    /// The whole numbers of an accessor.
    pub fn whole<const N: usize>(&self, path: &str, index: u64, allowed: Allowed) -> Result<Vec<[u32; N]>> {
        self.read(path, index, allowed, Component::whole)
    }

    fn read<T: Copy + Default, const N: usize>(
        &self,
        path: &str,
        index: u64,
        allowed: Allowed,
        convert: impl Fn(Component, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>> {
        let (number, accessor) = element(&self.document.accessors, "accessors", path, index)?;
        let at = format!("accessors[{number}]");
        let component = Component::new(&format!("{at}.componentType"), accessor.component_type)?;
        self.check(path, &at, accessor, component, allowed, N)?;
        let element = |bytes: &[u8]| -> [T; N] {
            // Columns of matrices whose components have fewer than four bytes are padded; none of them is read here.
            std::array::from_fn(|i| convert(component, &bytes[i * component.size()..]))
        };
        self.spend(path, accessor.count)?;
        let count = usize::try_from(accessor.count)
            .map_err(|_| Error::invalid(&at, format!("{} elements are too many", accessor.count)))?;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let named = format!("{at}.bufferView");
                let offset = accessor.byte_offset;
                let source = self.source(&at, &named, view, offset, component, N, count)?;
                (0..count).map(|i| element(&source.bytes[i * source.stride..])).collect()
            }
            None if accessor.count > ZEROS_LIMIT => {
                let message = format!("{count} elements without a bufferView, expected {ZEROS_LIMIT} at most");
                return Err(Error::invalid(&at, message));
            }
            None => vec![[T::default(); N]; count],
        };
        if let Some(sparse) = &accessor.sparse {
            let at = format!("{at}.sparse");
            let Some(changes) = usize::try_from(sparse.count).ok().filter(|changes| *changes <= count) else {
                let message = format!("{} of {count} elements are changed", sparse.count);
                return Err(Error::invalid(format!("{at}.count"), message));
            };
            let at_indices = format!("{at}.indices");
            let code = sparse.indices.component_type.ok_or_else(|| missing(&at_indices, "componentType"))?;
            let index_type = Component::new(&format!("{at_indices}.componentType"), code)?;
            if !matches!(index_type, Component::U8 | Component::U16 | Component::U32) {
                let message = format!("indices are of {}, expected an unsigned type", index_type.name());
                return Err(Error::invalid(format!("{at_indices}.componentType"), message));
            }
            let indices = self.part(&at_indices, &sparse.indices, index_type, 1, changes)?;
            let changed = self.part(&format!("{at}.values"), &sparse.values, component, N, changes)?;
            for i in 0..changes {
                let index = index_type.whole(&indices.bytes[i * indices.stride..]);
                let Some(value) = values.get_mut(index as usize) else {
                    let message = format!("element {i} is {index}, expected an index below {count}");
                    return Err(Error::invalid(at_indices, message));
                };
                *value = element(&changed.bytes[i * changed.stride..]);
            }
        }
        Ok(values)
    }

    fn part(
        &self,
        at: &str,
        part: &SparsePart,
        component: Component,
        components: usize,
        count: usize,
    ) -> Result<Source<'_>> {
        let view = part.buffer_view.ok_or_else(|| missing(at, "bufferView"))?;
        self.source(at, &format!("{at}.bufferView"), view, part.byte_offset, component, components, count)
    }

    /// Finds the bytes of `count` elements, all of which are there.
    #[expect(clippy::too_many_arguments, reason = "what an accessor and the parts of a sparse one have in common")]
    fn source(
        &self,
        at: &str,
        view_path: &str,
        view: u64,
        offset: u64,
        component: Component,
        components: usize,
        count: usize,
    ) -> Result<Source<'_>> {
        let (bytes, stride) = self.buffers.view(view_path, view)?;
        let size = component.size();
        let len = size * components;
        let stride = stride.map_or(Some(len), |stride| usize::try_from(stride).ok());
        let Some(stride) = stride.filter(|stride| *stride >= len && stride % size == 0 && *stride <= 1 << 16) else {
            let message = format!(
                "its byteStride does not fit elements of {len} bytes, expected {len} or more and a multiple of {size}"
            );
            return Err(Error::invalid(format!("bufferViews[{view}].byteStride"), message));
        };
        // The offset of the view is counted as well: what has to be aligned is the place in the buffer.
        let view_offset = self.document.buffer_views.get(view as usize).map_or(0, |view| view.byte_offset);
        if !offset.wrapping_add(view_offset).is_multiple_of(size as u64) {
            let place = u128::from(offset) + u128::from(view_offset);
            let message = format!(
                "elements of {} begin at byte {place} of the buffer, which is misaligned; expected a multiple of {size}",
                component.name()
            );
            return Err(Error::invalid(at, message));
        }
        let needed = match count {
            0 => 0,
            _ => (count as u128 - 1) * stride as u128 + len as u128,
        };
        let there = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..));
        match there {
            Some(bytes) if bytes.len() as u128 >= needed => Ok(Source { bytes, stride }),
            _ => {
                let message = format!(
                    "{count} elements need {needed} bytes from byte {offset} on, bufferViews[{view}] has {}",
                    bytes.len()
                );
                Err(Error::invalid(at, message))
            }
        }
    }

    fn check(
        &self,
        path: &str,
        at: &str,
        accessor: &Accessor,
        component: Component,
        allowed: Allowed,
        components: usize,
    ) -> Result<()> {
        let of_kind = match accessor.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            other => {
                let message = format!("'{}' is no type of accessors", super::super::json::elided(other));
                return Err(Error::invalid(format!("{at}.type"), message));
            }
        };
        if of_kind != components || (components == 4 && accessor.kind != "VEC4") {
            let expected = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(components - 1).unwrap_or(&"MAT4");
            let message = format!("{at} is of type {}, expected {expected}", accessor.kind);
            return Err(Error::invalid(path, message));
        }
        let small = matches!(component, Component::I8 | Component::U8 | Component::I16 | Component::U16);
        let unsigned = matches!(component, Component::U8 | Component::U16 | Component::U32);
        let fits = match allowed {
            Allowed::Floats => component == Component::F32 || small && self.quantized,
            Allowed::Fractions => {
                component == Component::F32 || small && self.quantized || small && unsigned && accessor.normalized
            }
            Allowed::Animated => component == Component::F32 || small,
            Allowed::Whole => unsigned,
            Allowed::SmallWhole => unsigned && small,
        };
        if fits {
            return Ok(());
        }
        let expected = match allowed {
            Allowed::Floats if small => "FLOAT, or the extension KHR_mesh_quantization",
            Allowed::Floats => "FLOAT",
            Allowed::Fractions => "FLOAT or a normalised unsigned type",
            Allowed::Animated => "FLOAT or a normalised type",
            Allowed::Whole => "an unsigned type",
            Allowed::SmallWhole => "UNSIGNED_BYTE or UNSIGNED_SHORT",
        };
        let normalized = if accessor.normalized { "normalised " } else { "" };
        let message = format!("{at} is of {normalized}{}, expected {expected}", component.name());
        Err(Error::invalid(path, message))
    }
}

/// The error for what this version does not read.
pub(super) fn unsupported(path: &str, message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Unsupported, message).at(path)
}
