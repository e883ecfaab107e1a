//! The boundary between C and Rust: checks of pointers and handles, conversion of panics to errors, the floating-point state,
//! and storage of failures.

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::float_state::{in_default_state, in_host_state};
use super::status::{
    ETD_INVALID_HANDLE, ETD_OK, ETD_PANIC, Failure, Result, c_string, etd_last_error_message, etd_status, remember,
};
use super::types::{etd_error_fn, etd_log_fn, etd_log_level};

/// Locks a mutex whose data no panic can leave inconsistent, and therefore ignores poisoning.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A pointer of the host, which the library only passes back to functions of the host.
#[derive(Clone, Copy, Debug)]
pub(super) struct UserData(pub *mut c_void);

// SAFETY: the library never dereferences the pointer. The documentation says on which threads the host's functions receive it.
unsafe impl Send for UserData {}
// SAFETY: as for `Send`.
unsafe impl Sync for UserData {}

/// The functions of the host that a device calls with messages.
#[derive(Debug)]
pub(super) struct Callbacks {
    pub log: etd_log_fn,
    /// The least important messages that the host wants.
    pub least: etd_log_level,
    pub error: etd_error_fn,
    pub user_data: UserData,
}

thread_local! {
    /// Whether this thread is inside the error callback, in which failing calls are not reported.
    static REPORTING: Cell<bool> = const { Cell::new(false) };
}

thread_local! {
    /// The addresses of the work that this thread does, or for which it calls the host, innermost last.
    static ACTIVE_WORK: RefCell<Vec<usize>> = const { RefCell::new(Vec::new()) };
}

/// Marks this thread as doing some work until the value is dropped.
pub(super) struct ActiveWork;

impl ActiveWork {
    pub fn enter(work: usize) -> Self {
        ACTIVE_WORK.with(|active| active.borrow_mut().push(work));
        Self
    }
}

impl Drop for ActiveWork {
    fn drop(&mut self) {
        ACTIVE_WORK.with(|active| active.borrow_mut().pop());
    }
}

/// Whether this thread is doing the work at this address. Such a thread cannot wait for the end of the work.
pub(super) fn is_active(work: usize) -> bool {
    ACTIVE_WORK.with(|active| active.borrow().contains(&work))
}

impl Callbacks {
    pub fn log(&self, level: etd_log_level, message: &str) {
        if let Some(log) = self.log.filter(|_| level as u32 <= self.least as u32) {
            let message = c_string(message);
            // SAFETY: the host provided the function for these calls; the string lives during the call.
            in_host_state(|| unsafe { log(self.user_data.0, level, message.as_ptr()) });
        }
    }

    fn error(&self, failure: &Failure) {
        let Some(error) = self.error else { return };
        if REPORTING.replace(true) {
            return;
        }
        let message = c_string(&failure.message);
        // SAFETY: as in `log`.
        in_host_state(|| unsafe { error(self.user_data.0, failure.status, message.as_ptr()) });
        REPORTING.set(false);
    }
}

/// The part that all objects have in common.
#[derive(Debug)]
pub(super) struct Header {
    /// The kind of the object. The tag is cleared when the object is dropped. That only helps debugging, because the memory is
    /// freed at the same time.
    tag: AtomicU32,
    /// Whether a call on the object has panicked. Such an object can only be released.
    poisoned: AtomicBool,
    /// The first failure since the last time that the host asked for the object's status.
    first_failure: Mutex<Option<Failure>>,
    pub callbacks: Arc<Callbacks>,
}

impl Header {
    pub const TAG_AT: usize = std::mem::offset_of!(Self, tag);

    pub fn new<T: Object>(callbacks: &Arc<Callbacks>) -> Self {
        Self {
            tag: AtomicU32::new(T::TAG),
            poisoned: AtomicBool::new(false),
            first_failure: Mutex::new(None),
            callbacks: Arc::clone(callbacks),
        }
    }

    /// Stores a failure of a call on the object, unless an earlier one is stored, and reports it to the host.
    pub fn store(&self, failure: &Failure) {
        if failure.status == ETD_PANIC {
            self.poisoned.store(true, Ordering::Relaxed);
        }
        lock(&self.first_failure).get_or_insert_with(|| failure.clone());
        self.callbacks.error(failure);
    }

    /// Takes the first failure since the last time that it was taken.
    pub fn take(&self) -> Option<Failure> {
        lock(&self.first_failure).take()
    }
}

impl Drop for Header {
    fn drop(&mut self) {
        self.tag.store(0, Ordering::Relaxed);
    }
}

/// An object that C holds by a pointer.
///
/// # Safety
/// `TAG_AT` is the offset of the header's tag in the object, and no other kind of object has the same tag.
pub(super) unsafe trait Object: Send + Sync + Sized + 'static {
    const TAG: u32;
    const TAG_AT: usize;
    const NAME: &'static str;
    fn header(&self) -> &Header;
}

/// Makes a structure with a field `header` an [`Object`].
macro_rules! object {
    ($type:ty, $tag:literal, $name:literal) => {
        // SAFETY: `offset_of` gives the offset, and each tag is used once.
        unsafe impl Object for $type {
            const TAG: u32 = u32::from_be_bytes(*$tag);
            const TAG_AT: usize = std::mem::offset_of!($type, header) + Header::TAG_AT;
            const NAME: &'static str = $name;
            fn header(&self) -> &Header {
                &self.header
            }
        }
    };
}
pub(super) use object;

/// Gives the host one reference to an object.
pub(super) fn give<T: Object>(object: Arc<T>, out: *mut *mut T) {
    // SAFETY: the caller has checked `out`.
    unsafe { out.write(Arc::into_raw(object).cast_mut()) }
}

/// Returns the object of this kind at `pointer`, or an error for NULL and for an object of another kind.
///
/// # Safety
/// `pointer` must be NULL, point to a living object of this library, or point to readable memory of at least the size of such
/// an object. A pointer to an object whose last reference was released is none of these: the memory is freed, and to read it
/// is undefined behaviour.
pub(super) unsafe fn peek<'a, T: Object>(pointer: *const T) -> Result<&'a T> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("the {} is NULL", T::NAME)));
    }
    let tag = if pointer.is_aligned() {
        // SAFETY: the memory is readable by the caller's contract, and an object of this kind has its tag at this offset.
        unsafe { ptr::read_volatile(pointer.byte_add(T::TAG_AT).cast::<u32>()) }
    } else {
        0
    };
    if tag != T::TAG {
        let message = format!("the pointer is no {}", T::NAME);
        return Err(Failure::new(ETD_INVALID_HANDLE, message));
    }
    // SAFETY: the object is of this kind, and it is alive by the caller's contract.
    Ok(unsafe { &*pointer })
}

/// The same as [`peek`], with an error for an object in whose use the library panicked.
///
/// # Safety
/// The contract of [`peek`].
pub(super) unsafe fn get<'a, T: Object>(pointer: *const T) -> Result<&'a T> {
    // SAFETY: the caller keeps this function's contract.
    let object = unsafe { peek(pointer) }?;
    if object.header().poisoned.load(Ordering::Relaxed) {
        let message = format!("the {} was in use when the library panicked: it can only be released", T::NAME);
        return Err(Failure::new(ETD_PANIC, message));
    }
    Ok(object)
}

/// The same as [`get`], with a reference that keeps the object alive.
///
/// # Safety
/// The contract of [`peek`].
pub(super) unsafe fn share<T: Object>(pointer: *const T) -> Result<Arc<T>> {
    // SAFETY: the caller keeps this function's contract.
    unsafe { get(pointer) }?;
    // SAFETY: a living object came from `Arc::into_raw`.
    unsafe {
        Arc::increment_strong_count(pointer);
        Ok(Arc::from_raw(pointer))
    }
}

/// Adds a reference to an object.
///
/// # Safety
/// The contract of [`peek`].
pub(super) unsafe fn retain<T: Object>(pointer: *const T) -> etd_status {
    boundary(None, || {
        // SAFETY: the caller keeps this function's contract; a living object came from `Arc::into_raw`.
        unsafe {
            peek(pointer)?;
            Arc::increment_strong_count(pointer);
        }
        Ok(())
    })
}

/// Releases a reference to an object. It does nothing for NULL and for a pointer to no object of this kind.
///
/// # Safety
/// The contract of [`peek`].
pub(super) unsafe fn release<T: Object>(pointer: *const T) {
    if pointer.is_null() {
        return;
    }
    boundary(None, || {
        // SAFETY: as in `retain`.
        unsafe {
            peek(pointer)?;
            drop(Arc::from_raw(pointer));
        }
        Ok(())
    });
}

/// Takes the first failure of an object since the last time that it was taken, and copies its message.
///
/// # Safety
/// The contracts of [`peek`] and [`copy_text`].
pub(super) unsafe fn take_status<T: Object>(pointer: *const T, message: *mut c_char, capacity: usize) -> etd_status {
    let mut first = ETD_OK;
    let status = boundary(None, || {
        // SAFETY: the caller keeps this function's contract.
        let object = unsafe { peek(pointer) }?;
        let failure = object.header().take();
        let text = failure.as_ref().map_or("", |failure| failure.message.as_str());
        if !message.is_null() {
            // SAFETY: the caller keeps this function's contract.
            unsafe { copy_text(text, message, capacity, ptr::null_mut()) }?;
        }
        first = failure.map_or(ETD_OK, |failure| failure.status);
        Ok(())
    });
    if status == ETD_OK { first } else { status }
}

/// Runs the body of a call and catches panics. A failure becomes the thread's last error. It is also stored in the object,
/// where there is one.
pub(super) fn boundary(object: Option<&Header>, body: impl FnOnce() -> Result) -> etd_status {
    match catch(body) {
        Ok(()) => ETD_OK,
        Err(failure) => fail(object, &failure),
    }
}

/// Runs a call on an object: checks the handle, runs the body and stores a failure in the object. A reference keeps the
/// object alive during the call, because a callback may release the host's reference.
///
/// # Safety
/// The contract of [`peek`].
pub(super) unsafe fn on<T: Object>(pointer: *const T, body: impl FnOnce(&Arc<T>) -> Result) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    match unsafe { share(pointer) } {
        Ok(object) => boundary(Some(object.header()), || body(&object)),
        Err(failure) => fail(None, &failure),
    }
}

/// The same as [`on`] for calls whose overhead must be small. It takes a reference to the object only when the call fails.
///
/// # Safety
/// The contract of [`peek`].
#[inline]
pub(super) unsafe fn on_quickly<T: Object>(pointer: *const T, body: impl FnOnce(&T) -> Result) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    let failure = match unsafe { get(pointer) } {
        Ok(object) => match catch(|| body(object)) {
            Ok(()) => return ETD_OK,
            Err(failure) => failure,
        },
        Err(failure) => return fail(None, &failure),
    };
    // SAFETY: the caller keeps this function's contract.
    let object = unsafe { share(pointer) }.ok();
    fail(object.as_deref().map(Object::header), &failure)
}

/// Stores a failure as the thread's last error and in the object, and returns its status.
fn fail(object: Option<&Header>, failure: &Failure) -> etd_status {
    remember(failure);
    if let Some(object) = object {
        let message = etd_last_error_message();
        // The error callback is called as all functions of the host are, from the default state.
        in_default_state(|| object.store(failure));
        // Calls inside the error callback may have failed too. The last error is that of the outer call.
        if etd_last_error_message() != message {
            remember(failure);
        }
    }
    failure.status
}

/// Runs the body of a call in the default floating-point state, and turns a panic into a failure.
pub(super) fn catch<R>(body: impl FnOnce() -> Result<R>) -> Result<R> {
    in_default_state(|| catch_unwind(AssertUnwindSafe(body))).unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".to_owned());
        // The destructor of the payload may panic as well.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(panic)));
        Err(Failure::new(ETD_PANIC, format!("the library panicked, please report it: {text}")))
    })
}

/// Refuses a pointer that is NULL or not aligned.
pub(super) fn need<T>(pointer: *const T, name: &str) -> Result {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(Failure::argument(format!("{name} is not aligned to {} bytes", align_of::<T>())));
    }
    Ok(())
}

/// Returns the items of an array argument.
///
/// # Safety
/// `count` items must be readable at `pointer` for as long as the slice is used, unless it is NULL.
pub(super) unsafe fn items<'a, T>(pointer: *const T, count: usize, name: &str) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    need(pointer, name)?;
    if count.checked_mul(size_of::<T>()).is_none_or(|bytes| isize::try_from(bytes).is_err()) {
        return Err(Failure::argument(format!("{name} of {count} items is more than any memory holds")));
    }
    // SAFETY: the pointer is not NULL and aligned, the size is possible, and the items are readable by the caller's contract.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Returns the items of an array argument of fixed length.
///
/// # Safety
/// `N` items must be readable at `pointer`, unless it is NULL.
pub(super) unsafe fn array<T: Copy, const N: usize>(pointer: *const T, name: &str) -> Result<[T; N]> {
    need(pointer, name)?;
    // SAFETY: by the caller's contract; arrays have the alignment of their items.
    Ok(unsafe { pointer.cast::<[T; N]>().read() })
}

/// Returns a string argument, which is UTF-8 and ends with a zero byte.
///
/// # Safety
/// `pointer` must be NULL or point to a string that ends with a zero byte and lives during the call.
pub(super) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str> {
    need(pointer, name)?;
    // SAFETY: by the caller's contract.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    bytes.to_str().map_err(|error| Failure::argument(format!("{name} is not UTF-8: {error}")))
}

/// The same as [`text`], with an empty string for NULL.
///
/// # Safety
/// The contract of [`text`].
pub(super) unsafe fn optional_text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str> {
    // SAFETY: the caller keeps this function's contract.
    if pointer.is_null() { Ok("") } else { unsafe { text(pointer, name) } }
}

/// Copies a text and a zero byte into the caller's buffer. A text that does not fit is cut after a whole character.
///
/// # Safety
/// `capacity` bytes must be writable at `buffer`, unless it is NULL; one number at `out_needed`, unless it is NULL.
pub(super) unsafe fn copy_text(text: &str, buffer: *mut c_char, capacity: usize, out_needed: *mut usize) -> Result {
    let text = c_string(text);
    let bytes = text.as_bytes();
    if !out_needed.is_null() {
        need(out_needed, "out_needed")?;
        // SAFETY: the caller keeps this function's contract.
        unsafe { out_needed.write(bytes.len() + 1) }
    }
    if buffer.is_null() || capacity == 0 {
        return if out_needed.is_null() { Err(Failure::argument("the buffer is NULL or empty")) } else { Ok(()) };
    }
    let mut length = bytes.len().min(capacity - 1);
    while length < bytes.len() && bytes[length] & 0xc0 == 0x80 {
        length -= 1;
    }
    // SAFETY: `length + 1 <= capacity` bytes are writable, and the host's buffer does not overlap the text.
    unsafe {
        ptr::copy_nonoverlapping(bytes.as_ptr().cast(), buffer, length);
        buffer.add(length).write(0);
    }
    Ok(())
}

/// A structure whose first field is its own size, as `size_t`. All fields are numbers and pointers, for which zero bytes are a
/// valid value that means "default".
///
/// # Safety
/// `#[repr(C)]`, first field `struct_size: usize`, and valid for all-zero bytes.
pub(super) unsafe trait Versioned: Copy {
    /// The size of the structure's first version. No program was compiled with a smaller one.
    const SMALLEST: usize;
}

/// Reads a structure of the size that the caller was compiled with. Fields that the caller does not know are zero. Bytes other
/// than zero in fields that this library does not know are refused, because they would be ignored.
///
/// # Safety
/// `pointer` must be NULL or point to as many readable bytes as its first field says.
pub(super) unsafe fn read_sized<T: Versioned>(pointer: *const T, name: &str) -> Result<T> {
    need(pointer, name)?;
    // SAFETY: the first field is readable by the caller's contract.
    let given = unsafe { pointer.cast::<usize>().read() };
    check_size::<T>(given, name)?;
    // SAFETY: zero bytes are a value of `T`. `given` bytes are readable, and at most the size of `T` is copied.
    unsafe {
        let mut value: T = std::mem::zeroed();
        ptr::copy_nonoverlapping(pointer.cast::<u8>(), (&raw mut value).cast(), given.min(size_of::<T>()));
        for at in size_of::<T>()..given {
            if pointer.cast::<u8>().add(at).read() != 0 {
                let message = format!("{name} sets byte {at}, a field that this version does not know");
                return Err(Failure::argument(message));
            }
        }
        Ok(value)
    }
}

/// Writes the fields of a structure that the caller knows. Its `struct_size` is not changed.
///
/// # Safety
/// The contract of [`read_sized`]; the bytes must also be writable.
pub(super) unsafe fn write_sized<T: Versioned>(pointer: *mut T, name: &str, value: T) -> Result {
    need(pointer, name)?;
    // SAFETY: the first field is readable by the caller's contract.
    let given = unsafe { pointer.cast::<usize>().read() };
    check_size::<T>(given, name)?;
    let (start, end) = (size_of::<usize>(), given.min(size_of::<T>()));
    // SAFETY: `given` bytes are writable, and `end` is at most the size of both structures.
    unsafe {
        let from = (&raw const value).cast::<u8>();
        ptr::copy_nonoverlapping(from.add(start), pointer.cast::<u8>().add(start), end - start);
    }
    Ok(())
}

fn check_size<T: Versioned>(given: usize, name: &str) -> Result {
    // A missing or random size differs by far, and the size of a later version is only a few fields larger.
    if given < T::SMALLEST || given > 16 * size_of::<T>() {
        let message = format!("{name}.struct_size is {given}, expected sizeof: {}", size_of::<T>());
        return Err(Failure::argument(message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::*;
    use crate::capi::status::{ETD_INVALID_ARGUMENT, ETD_INVALID_OPERATION};
    use crate::capi::types::etd_film_options;

    struct Thing {
        header: Header,
    }
    object!(Thing, b"Test", "thing");

    unsafe extern "C" fn count(data: *mut c_void, status: etd_status, message: *const c_char) {
        assert_eq!(status, ETD_PANIC);
        // SAFETY: both are what `on_error` was given below.
        unsafe {
            assert!(CStr::from_ptr(message).to_string_lossy().contains("broken"));
            (*data.cast::<AtomicUsize>()).fetch_add(1, Ordering::Relaxed);
        }
    }

    fn message() -> String {
        // SAFETY: a C string of this thread.
        unsafe { CStr::from_ptr(etd_last_error_message()) }.to_string_lossy().into_owned()
    }

    #[test]
    fn a_panic_becomes_a_status_and_poisons_the_object_but_not_its_release() {
        let told = AtomicUsize::new(0);
        let user_data = UserData((&raw const told).cast_mut().cast());
        let callbacks =
            Arc::new(Callbacks { log: None, least: crate::capi::ETD_LOG_INFO, error: Some(count), user_data });
        let pointer = Arc::into_raw(Arc::new(Thing { header: Header::new::<Thing>(&callbacks) }));
        // SAFETY: alive until released at the end.
        unsafe {
            assert_eq!(on(pointer, |_| Ok(())), ETD_OK);
            for number in 0..2 {
                let panicking = |_: &Arc<Thing>| -> Result { panic!("broken {number}") };
                assert_eq!(on(pointer, panicking), ETD_PANIC);
            }
            assert!(message().contains("broken 0") || message().contains("only be released"), "{}", message());
            assert_eq!(on(pointer, |_| Ok(())), ETD_PANIC);
            assert_eq!(on_quickly(pointer, |_| Ok(())), ETD_PANIC);
            assert_eq!(told.load(Ordering::Relaxed), 1, "calls on a poisoned object do not begin");
            let mut text = [1; 64];
            assert_eq!(take_status(pointer, text.as_mut_ptr(), text.len()), ETD_PANIC);
            assert!(CStr::from_ptr(text.as_ptr()).to_string_lossy().starts_with("the library panicked"));
            assert_eq!(take_status(pointer, ptr::null_mut(), 0), ETD_OK, "asked once");
            assert_eq!(retain(pointer), ETD_OK);
            release(pointer);
            release(pointer);
        }
        assert_eq!(Arc::strong_count(&callbacks), 1);
    }

    #[test]
    fn pointers_to_no_object_are_refused() {
        let words = [0_u64; 32];
        // SAFETY: the memory is readable.
        unsafe {
            assert_eq!(on::<Thing>(ptr::null(), |_| Ok(())), ETD_INVALID_ARGUMENT);
            assert_eq!(on::<Thing>(words.as_ptr().cast(), |_| Ok(())), ETD_INVALID_HANDLE);
            assert_eq!(on::<Thing>(words.as_ptr().byte_add(1).cast(), |_| Ok(())), ETD_INVALID_HANDLE);
            release::<Thing>(words.as_ptr().cast());
        }
    }

    #[test]
    fn structures_of_other_versions() {
        let whole = etd_film_options {
            struct_size: size_of::<etd_film_options>(),
            width: 3,
            height: 4,
            layers: 5,
            reserved: 0,
        };
        let mut later = [0_usize; 16];
        // SAFETY: the memory has the sizes that are passed.
        unsafe {
            assert_eq!(read_sized(&raw const whole, "it").unwrap().layers, 5);
            for (size, ok) in [(0, false), (7, false), (8, false), (24, true), (64, true), (1 << 40, false)] {
                ptr::copy_nonoverlapping((&raw const whole).cast::<u8>(), later.as_mut_ptr().cast(), 24);
                later[0] = size;
                assert_eq!(read_sized(later.as_ptr().cast::<etd_film_options>(), "it").is_ok(), ok, "{size}");
            }
            // A later version's field, set to something that this one would ignore.
            later[0] = 64;
            later[5] = 1;
            let refused = read_sized(later.as_ptr().cast::<etd_film_options>(), "it").unwrap_err();
            assert_eq!(refused.status, ETD_INVALID_ARGUMENT);
            assert!(refused.message.contains("byte 40"), "{}", refused.message);
            let written = etd_film_options { width: 9, ..whole };
            write_sized(later.as_mut_ptr().cast::<etd_film_options>(), "it", written).unwrap();
            assert_eq!((later[0], later[5], *later.as_ptr().cast::<u32>().add(2)), (64, 1, 9));
        }
    }

    #[test]
    fn texts_are_cut_between_characters() {
        let mut buffer = [7_i8; 8];
        let mut needed = 0;
        // SAFETY: the buffer has eight bytes.
        unsafe {
            copy_text("Étendue", buffer.as_mut_ptr().cast(), 2, &raw mut needed).unwrap();
            assert_eq!((needed, buffer[0]), (9, 0), "half a character is none");
            copy_text("Étendue", buffer.as_mut_ptr().cast(), 4, ptr::null_mut()).unwrap();
            assert_eq!(CStr::from_ptr(buffer.as_ptr().cast()).to_str(), Ok("Ét"));
            assert_eq!(copy_text("x", ptr::null_mut(), 0, ptr::null_mut()).unwrap_err().status, ETD_INVALID_ARGUMENT);
        }
        let failure = Failure::new(ETD_INVALID_OPERATION, "one\0two");
        assert_eq!(fail(None, &failure), ETD_INVALID_OPERATION);
        assert_eq!(message(), "one");
    }
}
