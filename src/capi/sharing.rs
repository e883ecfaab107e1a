//! Memory of the host that the library reads in place.

use std::any::Any;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::boundary::UserData;
use super::float_state::in_host_state;
use super::status::Result;
use super::types::etd_release_fn;

/// Calls the host's release function, once its memory is no longer read, if what reads the memory was accepted.
struct Sharing {
    release: etd_release_fn,
    user_data: UserData,
    accepted: AtomicBool,
}

impl Drop for Sharing {
    fn drop(&mut self) {
        if let (Some(release), true) = (self.release, *self.accepted.get_mut()) {
            // SAFETY: the host provided the function for these calls.
            in_host_state(|| unsafe { release(self.user_data.0) });
        }
    }
}

/// Passes `read` an owner of the host's memory, and what it returns to `take`. If both succeed, `release` is called when the
/// owner is dropped; otherwise it is never called.
pub(super) fn shared<T, R>(
    release: etd_release_fn,
    user_data: UserData,
    read: impl FnOnce(&Arc<dyn Any + Send + Sync>) -> Result<T>,
    take: impl FnOnce(T) -> Result<R>,
) -> Result<R> {
    let sharing = Arc::new(Sharing { release, user_data, accepted: AtomicBool::new(true) });
    let owner: Arc<dyn Any + Send + Sync> = sharing.clone();
    let refused = || sharing.accepted.store(false, Ordering::Release);
    let value = read(&owner).inspect_err(|_| refused())?;
    drop(owner);

    // Another thread may drop the value at once. `sharing` is held here until it is known whether it was accepted.
    take(value).inspect_err(|_| refused())
}
