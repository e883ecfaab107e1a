//! Films that are saved, loaded and merged, and what the options of a render say about parts of pictures and about going on.
//!
//! A film keeps the state of the last render to it, which is a [`Checkpoint`]. There is no object for that state alone.

use std::ffi::{c_char, c_void};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::boundary::{Object, boundary, give, items, need, on, read_sized, share, text};
use super::device::etd_device;
use super::film::{FIRST_HIT, LIGHT_PARTS, check_layers, etd_film};
use super::film_size::charge;
use super::read::in_options;
use super::status::{ETD_INVALID_ARGUMENT, ETD_INVALID_SCENE, Failure, Result, etd_status};
use super::types::{etd_film_options, etd_render_options};
use crate::film::FilmOptions;
use crate::output::check_text_target;
use crate::render::{Checkpoint, CheckpointPlan, Share};
use crate::{Error, ErrorKind};

/// Time from one checkpoint to the next, where the options say none.
const CHECKPOINT_TIME: Duration = Duration::from_secs(60);

/// What the options of a render say about parts of pictures and about checkpoints.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub share: Option<Share>,
    pub plan: Option<CheckpointPlan>,
}

impl Parts {
    /// # Safety
    /// `options.checkpoint_file` must be NULL or a string that ends with a zero byte.
    pub unsafe fn read(options: &etd_render_options) -> Result<Self> {
        let share = match (options.share_number, options.share_count) {
            (0, 0) => None,
            (number, count) => Some(Share::new(number, count).map_err(in_options)?),
        };
        let seconds = options.checkpoint_seconds;
        if !(seconds >= 0.0 && seconds.is_finite()) {
            let message = format!("options.checkpoint_seconds is {seconds}, expected 0 or a finite number above it");
            return Err(Failure::argument(message));
        }
        let plan = if options.checkpoint_file.is_null() {
            None
        } else {
            // SAFETY: the caller keeps this function's contract.
            let path = Path::new(unsafe { text(options.checkpoint_file, "options.checkpoint_file") }?);
            if path.as_os_str().is_empty() {
                return Err(Failure::argument("options.checkpoint_file is empty, expected the name of a file"));
            }
            // A render of hours must not find out at its end.
            check_text_target(path)?;
            let given = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
            let every = if seconds == 0.0 { CHECKPOINT_TIME } else { given };
            Some(CheckpointPlan { path: path.to_owned(), every })
        };
        Ok(Self { share, plan })
    }

    /// Refuses what is for pictures alone.
    pub fn refuse(options: &etd_render_options) -> Result {
        let given = [
            ("share_number", options.share_number != 0),
            ("share_count", options.share_count != 0),
            ("checkpoint_file", !options.checkpoint_file.is_null()),
            ("checkpoint_seconds", options.checkpoint_seconds != 0.0),
            ("resume", !options.resume.is_null()),
        ];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((name, _)) => {
                let message = format!("options.{name} is for renders of pictures, expected 0 or NULL");
                Err(Failure::argument(message))
            }
            None => Ok(()),
        }
    }

    /// Whether the state of the render is to know the scene by its fingerprint.
    pub fn are_given(&self) -> bool {
        self.share.is_some() || self.plan.is_some()
    }
}

/// The film of `options.resume`.
///
/// # Safety
/// `options.resume` must be NULL or a film.
pub(super) unsafe fn resumed_film(options: &etd_render_options) -> Result<Option<Arc<etd_film>>> {
    if options.resume.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller keeps this function's contract.
    let film = unsafe { share(options.resume) };
    film.map(Some).map_err(|failure| Failure { message: format!("options.resume: {}", failure.message), ..failure })
}

/// The state of a film's last render. No render changes it meanwhile.
pub(super) struct Held {
    checkpoint: Option<Checkpoint>,
    /// The film, where it is reserved by this.
    film: Option<Arc<etd_film>>,
}

impl Held {
    pub fn of(film: &Arc<etd_film>) -> Result<Self> {
        film.begin_reading()?;
        let mut held = Self { checkpoint: None, film: Some(Arc::clone(film)) };
        held.checkpoint = Some(film.kept()?);
        Ok(held)
    }

    /// The state of a film that is reserved for the render that goes on.
    pub fn of_reserved(film: &etd_film) -> Result<Self> {
        Ok(Self { checkpoint: Some(film.kept()?), film: None })
    }

    /// The state, once.
    pub fn take(&mut self) -> Option<Checkpoint> {
        self.checkpoint.take()
    }

    fn get(&self) -> Result<&Checkpoint> {
        self.checkpoint.as_ref().ok_or_else(|| Failure::operation("the film's state was taken"))
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        if let Some(film) = &self.film {
            film.end_reading();
        }
    }
}

/// Saves the state of the last render to a film, so that `etd_film_load` can read it on any machine: all sums of all pixels, the layers,
/// the estimated errors, and what further samples depend on.
///
/// A file at `path` is replaced in one step, and stays as it is on an error. A render that was cancelled may be saved, and one that is
/// done. The film is reserved meanwhile: a render to it is refused. So that nobody goes on with another scene, the state knows its scene
/// by a fingerprint. That of a render without `share_count`, `checkpoint_file` and `resume` is made now, of the scene as it was
/// rendered. `path`: UTF-8. Errors: `ETD_IO`; `ETD_INVALID_OPERATION` before the first render, while a render uses the film, and where the
/// fingerprint is still to be made of a scene that was edited or released since. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film, and `path` NULL or a string that ends with a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_save(film: *const etd_film, path: *const c_char) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            let path = text(path, "path")?;
            Ok(Held::of(film)?.get()?.write(Path::new(path))?)
        })
    }
}

/// Saves the state of the last render to a film in the host's memory, with the bytes that `etd_film_save` writes to a file.
///
/// `buffer`: receives the bytes, `capacity` at most; NULL to ask for their number alone. `out_size`: receives their number, unless it is
/// NULL. Errors: `ETD_INVALID_ARGUMENT` for a buffer that is too small, of which nothing is written, and those of `etd_film_save`.
/// Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film, and `capacity` bytes writable at `buffer` unless it is NULL; one number at `out_size`, unless it is
/// NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_save_memory(
    film: *const etd_film,
    buffer: *mut c_void,
    capacity: usize,
    out_size: *mut usize,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            if !out_size.is_null() {
                need(out_size, "out_size")?;
            } else if buffer.is_null() {
                return Err(Failure::argument("buffer and out_size are NULL"));
            }
            let held = Held::of(film)?;
            let mut count = Bytes { at: std::ptr::null_mut(), size: 0 };
            held.get()?.write_to(&mut count)?;
            if !buffer.is_null() {
                if count.size > capacity {
                    let message = format!("capacity is {capacity}, expected {} at least", count.size);
                    return Err(Failure::argument(message));
                }
                held.get()?.write_to(&mut Bytes { at: buffer.cast(), size: 0 })?;
            }
            if !out_size.is_null() {
                out_size.write(count.size);
            }
            Ok(())
        })
    }
}

/// A writer to memory of the host, or one that counts alone.
struct Bytes {
    /// Where the first byte goes; NULL to count.
    at: *mut u8,
    size: usize,
}

impl Write for Bytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.at.is_null() {
            // SAFETY: the caller has counted what comes, and the host's memory has room for it. Nobody changes the state meanwhile.
            unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.at.add(self.size), bytes.len()) };
        }
        self.size += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Reads a film that `etd_film_save`, a render with `checkpoint_file`, or the command line has written. It may be mapped, copied, written
/// as an image, saved, merged, and given to a render as the state to go on from.
///
/// `options`: NULL for a film without layers besides the colour. Otherwise width and height are those of the file or both 0, and the layers
/// are kept as by `etd_film_new`. Any bytes may be read: those of no film, cut, or changed anywhere are refused, and take no more memory
/// than the film that they name. The summary of the film has the numbers of samples and rays and the errors; its times are 0, and it
/// says `ETD_ENDED_SAMPLES`. On `ETD_OK`, `*out_film` is one reference. Errors: `ETD_IO` for a file that cannot be read,
/// `ETD_INVALID_SCENE` for one that is damaged or no film, `ETD_UNSUPPORTED` for another version of the format, another size, and layers of
/// first hits that the file does not keep, `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit; all name the file.
/// Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_load(
    device: *mut etd_device,
    path: *const c_char,
    options: *const etd_film_options,
    out_film: *mut *mut etd_film,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(device, |device| {
            need(out_film, "out_film")?;
            let path = text(path, "path")?;
            let film = load(device, options, |admit| Checkpoint::read_admitted(Path::new(path), admit))?;
            give(film, out_film);
            Ok(())
        })
    }
}

/// Reads a film from memory, as `etd_film_load` does from a file. `bytes`: `size` of them. Thread-safe.
///
/// # Safety
/// `size` bytes must be readable at `bytes`; each other pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_load_memory(
    device: *mut etd_device,
    bytes: *const c_void,
    size: usize,
    options: *const etd_film_options,
    out_film: *mut *mut etd_film,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(device, |device| {
            need(out_film, "out_film")?;
            need(bytes.cast::<u8>(), "bytes")?;
            let bytes = items(bytes.cast::<u8>(), size, "bytes")?;
            let film = load(device, options, |admit| Checkpoint::of_bytes(bytes, admit))?;
            give(film, out_film);
            Ok(())
        })
    }
}

/// Says whether a film of these options is wanted.
type Admit<'a> = &'a mut dyn FnMut(&FilmOptions) -> crate::Result<()>;

/// # Safety
/// The contract of [`read_sized`].
unsafe fn load(
    device: &Arc<etd_device>,
    options: *const etd_film_options,
    read: impl FnOnce(Admit<'_>) -> crate::Result<Checkpoint>,
) -> Result<Arc<etd_film>> {
    let (size, layers) = if options.is_null() {
        ([0; 2], 0)
    } else {
        // SAFETY: the caller keeps this function's contract.
        let it = unsafe { read_sized(options, "options") }?;
        check_layers(&it)?;
        ([it.width, it.height], it.layers)
    };
    let mut charged = None;
    let checkpoint = read(&mut |film| {
        let refuse = |message: String| Err(Error::new(ErrorKind::Unsupported, message));
        if size != [0; 2] && size != film.resolution {
            let [[width, height], [asked_width, asked_height]] = [film.resolution, size];
            return refuse(format!(
                "a film of {width} x {height} pixels; the options expect {asked_width} x {asked_height}"
            ));
        }
        if layers & FIRST_HIT != 0 && !film.auxiliary {
            return refuse("the film keeps no first hits, of which the options expect layers".to_owned());
        }
        if layers & LIGHT_PARTS != 0 && !film.light_parts {
            return refuse("the film keeps no parts of the light, of which the options expect layers".to_owned());
        }
        charged = Some(charge(device, film, layers)?);
        Ok(())
    })?;
    let charged = charged.ok_or_else(|| Failure::operation("the film was not asked for"))?;
    etd_film::of_state(device, layers, charged, checkpoint)
}

/// Makes the film of a whole picture from those of all its parts, in any order: what one render would have come to, to the last bit.
///
/// `films`: `count` films, rendered here with `share_number` and `share_count` or loaded; they stay as they are. The new film is of
/// the device of the first of them and keeps its layers. Parts that were stopped have fewer samples; a render with the new film as
/// `resume` makes up for what is missing. Its summary is as that of a film that was loaded. On `ETD_OK`, `*out_film` is one reference.
/// Errors: `ETD_INVALID_ARGUMENT` for parts that are missing or given twice, and for a film that is no part, `ETD_UNSUPPORTED` for parts
/// of different renders with what differs, `ETD_OUT_OF_MEMORY` if the film exceeds the device's memory limit, and those of
/// `etd_film_save`. Thread-safe.
///
/// # Safety
/// `count` pointers must be readable at `films`, each NULL or a film; `out_film` must be NULL or point to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_merge(
    films: *const *mut etd_film,
    count: usize,
    out_film: *mut *mut etd_film,
) -> etd_status {
    // Where there is a film, it hears of a failure, and so does the host.
    let first = match (need(films, "films"), count) {
        // SAFETY: the caller keeps this function's contract.
        (Ok(()), 1..) => unsafe { share(films.read().cast_const()) }.ok(),
        _ => None,
    };
    boundary(first.as_deref().map(Object::header), || {
        need(films, "films")?;
        need(out_film, "out_film")?;
        // SAFETY: the caller keeps this function's contract.
        let films = unsafe { items(films, count, "films") }?;
        let in_films = |number: usize, failure: Failure| Failure {
            message: format!("films[{number}]: {}", failure.message),
            ..failure
        };
        let of = |(number, film): (usize, &*mut etd_film)| {
            // SAFETY: the caller keeps this function's contract.
            unsafe { share(film.cast_const()) }.map_err(|failure| in_films(number, failure))
        };
        let films = films.iter().enumerate().map(of).collect::<Result<Vec<_>>>()?;
        let Some(first) = films.first() else { return Err(Failure::argument("count is 0, expected 1 or more")) };
        let hold = |(number, film)| Held::of(film).map_err(|failure| in_films(number, failure));
        let mut held = films.iter().enumerate().map(hold).collect::<Result<Vec<_>>>()?;
        let parts: Vec<Checkpoint> = held.iter_mut().filter_map(Held::take).collect();
        let device = first.device();
        let options = parts.first().map(|part| *part.film().options());
        let options = options.ok_or_else(|| Failure::operation("nothing was rendered to the films"))?;
        let charged = charge(device, &options, first.layers())?;
        let whole = Checkpoint::merge(parts).map_err(|error| match Failure::from(error) {
            failure if failure.status == ETD_INVALID_SCENE => Failure { status: ETD_INVALID_ARGUMENT, ..failure },
            failure => failure,
        })?;
        give(etd_film::of_state(device, first.layers(), charged, whole)?, out_film);
        Ok(())
    })
}

/// Returns the number of pixels in a row of a film and its number of rows. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_get_resolution(
    film: *const etd_film,
    out_width: *mut u32,
    out_height: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            need(out_width, "out_width")?;
            need(out_height, "out_height")?;
            let [width, height] = film.resolution();
            out_width.write(width);
            out_height.write(height);
            Ok(())
        })
    }
}

/// Returns which part of the picture the last render to a film was of, as `share_number` and `share_count` of its options; 0 and 0 for
/// all of it. Error: `ETD_INVALID_OPERATION` before the first render and while a render uses the film. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_get_share(
    film: *const etd_film,
    out_number: *mut u32,
    out_count: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            need(out_number, "out_number")?;
            need(out_count, "out_count")?;
            let share = film.share()?;
            out_number.write(share.map_or(0, Share::number));
            out_count.write(share.map_or(0, Share::count));
            Ok(())
        })
    }
}
