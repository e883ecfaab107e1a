//! Memory that is asked for before it is needed, so that a lack of it is an error and does not end the process.
//!
//! Rust ends the process where a vector cannot grow. What a host's data may make large is therefore reserved by these functions,
//! or its memory is asked for at once, before work whose many allocations are small.

use std::collections::{HashMap, TryReserveError};
use std::hash::Hash;
use std::sync::Arc;

use crate::error::{Error, ErrorKind, Result};

/// Fails where this many bytes cannot be had at once. They are given back, for the allocations that follow.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn check_room(bytes: usize) -> Result<()> {
    // The compiler may leave out an allocation that nobody uses.
    with_room::<u8>(bytes).map(|list| drop(std::hint::black_box(list)))
}

/// Address space that the C library reserves at once for the small allocations of a thread.
const BYTES_OF_A_THREAD: usize = 64 << 20;

/// Most threads for which address space is asked: more than a machine's memory is refused by the system, limit or not.
const MOST_THREADS: usize = 8;

/// The same before work of so many threads, each of which may reserve address space for more small allocations than it makes.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn check_room_of_threads(bytes: usize, threads: usize) -> Result<()> {
    check_room(bytes.saturating_add(BYTES_OF_A_THREAD * threads.min(MOST_THREADS)))
}

/// An empty vector with room for `count` items.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn with_room<T>(count: usize) -> Result<Vec<T>> {
    let mut list = Vec::new();
    add_room(&mut list, count)?;
    Ok(list)
}

/// A list that several share, which takes as much memory again while it is made.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn shared<T: Copy>(list: Vec<T>) -> Result<Arc<[T]>> {
    check_room(size_of_val(&*list))?;
    Ok(list.into())
}

/// Room for `count` further items of a list, and no more.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn add_room<T>(list: &mut Vec<T>, count: usize) -> Result<()> {
    list.try_reserve_exact(count).map_err(|error| lacking::<T>(list.len().saturating_add(count), error))
}

/// Adds an item to a list whose length nobody knows before. The room grows as that of [`Vec::push`] does.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
#[inline]
pub(crate) fn push<T>(list: &mut Vec<T>, item: T) -> Result<()> {
    grow(list, 1)?;
    list.push(item);
    Ok(())
}

/// Room for `count` further items of a list that grows on: where there is none, about twice the room that there was.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
#[inline]
pub(crate) fn grow<T>(list: &mut Vec<T>, count: usize) -> Result<()> {
    list.try_reserve(count).map_err(|error| lacking::<T>(list.len().saturating_add(count), error))
}

/// Room for `count` further entries of a table. The room grows as that of [`HashMap::insert`] does.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
#[inline]
pub(crate) fn add_entries<K: Eq + Hash, V>(table: &mut HashMap<K, V>, count: usize) -> Result<()> {
    table.try_reserve(count).map_err(|error| lacking::<(K, V)>(table.len().saturating_add(count), error))
}

/// Items of which there are `count`, or fewer.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn collected<T>(items: impl Iterator<Item = T>, count: usize) -> Result<Vec<T>> {
    let mut list = with_room(count)?;
    list.extend(items.take(count));
    Ok(list)
}

/// `count` times the same value.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>> {
    let mut list = with_room(count)?;
    list.resize(count, value);
    Ok(list)
}

/// The error of a list for which there is no room.
#[cold]
fn lacking<T>(count: usize, error: TryReserveError) -> Error {
    let bytes = count.saturating_mul(size_of::<T>());
    Error::new(ErrorKind::OutOfMemory, format!("no room for {bytes} bytes")).because(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_there_is_is_refused() {
        let outcome = check_room(isize::MAX as usize);
        assert_eq!(outcome.unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(filled(0_u64, usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(filled(7_u8, 3).unwrap(), [7; 3]);
        assert_eq!(add_room(&mut vec![0_u64], usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(collected(0_u64.., usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(add_entries(&mut HashMap::from([(1, 2)]), usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        let mut list = collected(5.., 2).unwrap();
        push(&mut list, 9).unwrap();
        assert_eq!(list, [5, 6, 9]);
    }
}
