//! Memory that is asked for before it is needed, so that a lack of it is an error and does not end the process.
//!
//! Rust ends the process where a vector cannot grow. What a host's data may make large is therefore reserved by these functions,
//! or its memory is asked for at once, before work whose many allocations are small.

use crate::error::{Error, ErrorKind, Result};

/// Fails where this many bytes cannot be had at once. They are given back, for the allocations that follow.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn check_room(bytes: usize) -> Result<()> {
    // The compiler may leave out an allocation that nobody uses.
    with_room::<u8>(bytes).map(|list| drop(std::hint::black_box(list)))
}

/// An empty vector with room for `count` items.
///
/// # Errors
/// [`ErrorKind::OutOfMemory`].
pub(crate) fn with_room<T>(count: usize) -> Result<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(|error| {
        let bytes = count.saturating_mul(size_of::<T>());
        Error::new(ErrorKind::OutOfMemory, format!("no room for {bytes} bytes")).because(error)
    })?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_there_is_is_refused() {
        let outcome = check_room(isize::MAX as usize);
        assert_eq!(outcome.unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(filled(0_u64, usize::MAX).unwrap_err().kind(), ErrorKind::OutOfMemory);
        assert_eq!(filled(7_u8, 3).unwrap(), [7; 3]);
    }
}
