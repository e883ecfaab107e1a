//! Shared immutable arrays, which may be the host's own memory, read in place.
//!
//! Geometry and texels are stored in [`Buffer`]s. A buffer is made of a vector, or of memory of the program that links this
//! library; the host's memory is not moved and is read with its own stride. Cloning a buffer shares it. Nothing here
//! writes to the memory.
#![allow(unsafe_code)]

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use half::f16;

use crate::{Error, ErrorKind, Result};

/// Types that a [`Buffer`] may hold: plain numbers of one to eight bytes, for which every bit pattern is a value.
pub trait Element: Copy + Send + Sync + sealed::Plain + 'static {}

mod sealed {
    pub trait Plain {}
}

macro_rules! elements {
    ($($type:ty),*) => {$(
        impl sealed::Plain for $type {}
        impl Element for $type {}
    )*};
}
elements!([f32; 2], [f32; 3], [f32; 4], [f64; 3], [u32; 3], u8, u16, f16, f32);

/// Immutable items at a fixed distance from each other, shared by clones.
#[derive(Clone)]
pub struct Buffer<T> {
    start: *const u8,
    len: usize,
    stride: usize,
    is_foreign: bool,
    /// Keeps the memory alive; dropped with the last clone.
    _owner: Arc<dyn Any + Send + Sync>,
    items: PhantomData<T>,
}

// SAFETY: the memory is never written to while a `Buffer` exists (a vector without other owners, or the guarantee of
// `Buffer::foreign`), and its owner is `Send` and `Sync`.
unsafe impl<T: Element> Send for Buffer<T> {}
// SAFETY: as for `Send`.
unsafe impl<T: Element> Sync for Buffer<T> {}

impl<T: Element> Buffer<T> {
    /// Items in the host's memory, `stride` bytes from one to the next; read in place, never written.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for a null pointer, an address or stride that does not suit the items' alignment, a
    /// stride smaller than an item, or a size that no address space holds.
    ///
    /// # Safety
    /// From now until `owner` is dropped, `len` items must be readable at `start`, and nothing may write to them. Where
    /// the items are vertices of a mesh, sixteen bytes must be readable from the last one on, because the ray kernel
    /// reads as many.
    pub unsafe fn foreign(
        start: *const T,
        len: usize,
        stride: usize,
        owner: Arc<dyn Any + Send + Sync>,
    ) -> Result<Self> {
        let refused = |message: String| Err(Error::new(ErrorKind::InvalidScene, message));
        if start.is_null() && len > 0 {
            return refused("the pointer is null".to_owned());
        }
        let align = align_of::<T>();
        if !start.is_aligned() {
            return refused(format!("the address {start:?} is not aligned to {align} bytes"));
        }
        if !stride.is_multiple_of(align) {
            return refused(format!("a stride of {stride} bytes is not a multiple of {align}"));
        }
        if stride < size_of::<T>() {
            return refused(format!("a stride of {stride} bytes is less than an item's {}", size_of::<T>()));
        }
        if len.checked_mul(stride).is_none_or(|bytes| isize::try_from(bytes).is_err()) {
            return refused(format!("{len} items of {stride} bytes are more than any memory holds"));
        }
        Ok(Self { start: start.cast(), len, stride, is_foreign: true, _owner: owner, items: PhantomData })
    }

    /// Number of items.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no item.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The item `index`.
    ///
    /// # Panics
    /// If there is no such item.
    #[inline]
    pub fn get(&self, index: usize) -> T {
        assert!(index < self.len, "item {index} of {}", self.len);
        // SAFETY: the item lies inside the memory, by the check above and the promise behind `start`, `len` and
        // `stride`; it is aligned because the start and the stride are.
        unsafe { self.start.add(index * self.stride).cast::<T>().read() }
    }

    /// `N` items from `first` on.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline]
    pub(crate) fn array<const N: usize>(&self, first: usize) -> [T; N] {
        assert!(first <= self.len && N <= self.len - first, "items from {first} on of {}", self.len);
        // SAFETY: as in `get`, for each of the items.
        std::array::from_fn(|i| unsafe { self.start.add((first + i) * self.stride).cast::<T>().read() })
    }

    /// Prefetches the beginning of the item `index` into the processor's cache. Does nothing where there is no such
    /// item, or on processors other than x86-64.
    #[inline]
    pub(crate) fn prefetch(&self, index: usize) {
        #[cfg(target_arch = "x86_64")]
        if index < self.len {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            // SAFETY: the item lies inside the memory; and a prefetch reads nothing that a program could see.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(self.start.add(index * self.stride).cast()) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = index;
    }

    /// All items in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = T> + '_ {
        (0..self.len).map(|index| self.get(index))
    }

    /// Whether the memory belongs to the host.
    pub fn is_foreign(&self) -> bool {
        self.is_foreign
    }

    /// Address of the first item.
    pub fn as_ptr(&self) -> *const T {
        self.start.cast()
    }

    /// Bytes from one item to the next.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Bytes of this library's memory behind it; 0 for foreign memory.
    pub fn memory_bytes(&self) -> usize {
        if self.is_foreign { 0 } else { self.len * self.stride }
    }
}

impl<T: Element + PartialEq> PartialEq for Buffer<T> {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.iter().eq(other.iter())
    }
}

impl<T: Element> FromIterator<T> for Buffer<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        items.into_iter().collect::<Vec<T>>().into()
    }
}

impl<T: Element> From<Vec<T>> for Buffer<T> {
    fn from(items: Vec<T>) -> Self {
        let (start, len) = (items.as_ptr().cast(), items.len());
        // Moving the vector into the owner does not move its items.
        Self { start, len, stride: size_of::<T>(), is_foreign: false, _owner: Arc::new(items), items: PhantomData }
    }
}

impl<T: Element> Default for Buffer<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: Element + fmt::Debug> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    struct CountDrops(Arc<AtomicUsize>);

    impl Drop for CountDrops {
        fn drop(&mut self) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }

    #[test]
    fn foreign_items_are_read_in_place_until_the_last_clone_is_gone() {
        let memory: Vec<f32> = (0..40).map(|i| i as f32).collect();
        let drops = Arc::new(AtomicUsize::new(0));
        let owner = Arc::new(CountDrops(Arc::clone(&drops)));
        // SAFETY: `memory` outlives the buffer and is not written to.
        let buffer = unsafe { Buffer::<[f32; 3]>::foreign(memory.as_ptr().cast(), 10, 16, owner) }.unwrap();
        assert_eq!((buffer.get(0), buffer.get(9)), ([0.0, 1.0, 2.0], [36.0, 37.0, 38.0]));
        assert_eq!((buffer.as_ptr().cast(), buffer.is_foreign(), buffer.memory_bytes()), (memory.as_ptr(), true, 0));
        let clone = buffer.clone();
        drop(buffer);
        assert_eq!((drops.load(Ordering::Relaxed), clone.iter().len()), (0, 10));
        drop(clone);
        assert_eq!(drops.load(Ordering::Relaxed), 1);
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let memory = [0_u32; 16];
        let start = memory.as_ptr();
        let odd = start.wrapping_byte_add(1);
        for (start, len, stride) in
            [(std::ptr::null(), 1, 12), (odd, 1, 12), (start, 1, 13), (start, 1, 8), (start, usize::MAX / 4, 12)]
        {
            // SAFETY: nothing is read; these are refused.
            assert!(unsafe { Buffer::<[u32; 3]>::foreign(start.cast(), len, stride, Arc::new(())) }.is_err());
        }
    }

    #[test]
    fn vectors_stay_where_they_are() {
        let items = vec![[1_u32, 2, 3], [4, 5, 6]];
        let address = items.as_ptr();
        let buffer = Buffer::from(items);
        assert_eq!((buffer.as_ptr(), buffer.len(), buffer.stride()), (address, 2, 12));
        assert_eq!(buffer.iter().collect::<Vec<_>>(), [[1, 2, 3], [4, 5, 6]]);
        assert!(Buffer::<[f64; 3]>::default().is_empty());
    }
}
