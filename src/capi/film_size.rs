//! How large films are: what sizes are possible, how much memory they take, and how a film gets another one.

use super::boundary::on;
use super::device::etd_device;
use super::film::{FIRST_HIT, LAYERS, LIGHT_PARTS, etd_film};
use super::status::{Failure, Result, etd_status};
use crate::desc::MAX_PIXELS;
use crate::embree::Charge;
use crate::film::{FilmOptions, TILE};

/// Gives a film another resolution. The film is then as `etd_film_new` makes it: black, without samples, state and summary. It
/// keeps its handle and its layers.
///
/// Mapped images stay as they are until they are unmapped; they do not count for the device's memory limit. A task that was cancelled or
/// cut short cannot be resumed while the film has another resolution than when the task was begun, and keeps its samples,
/// which do not count either, until it is released. `images` of `etd_progress` goes on
/// counting with the next image that is rendered; the black one is not counted. Errors, after all of which the film is as
/// it was: `ETD_INVALID_ARGUMENT` for a resolution out of range, `ETD_INVALID_OPERATION` while a render uses the film and while it is
/// saved, merged or gone on from, `ETD_OUT_OF_MEMORY` if the film would exceed the device's memory limit. Thread-safe.
///
/// # Safety
/// `film` must be NULL or a film.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_film_resize(film: *mut etd_film, width: u32, height: u32) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(film, |film| {
            let resolution = [width, height];
            check_size(resolution, "")?;
            film.resize(resolution, bytes_when_new(resolution, film.layers()))
        })
    }
}

/// Takes a film's part of the device's memory limit: the sums and two images, one that is shown and one that is being developed.
pub(super) fn charge(device: &etd_device, film: &FilmOptions, layers: u32) -> crate::Result<Charge> {
    device.budget.try_charge(bytes(film, layers))
}

/// Bytes of a film before the first render.
pub(super) fn bytes_when_new(resolution: [u32; 2], layers: u32) -> usize {
    let film = FilmOptions {
        resolution,
        placement: None,
        auxiliary: layers & FIRST_HIT != 0,
        light_parts: layers & LIGHT_PARTS != 0,
        share: 1,
        weighted: false,
        gathering: false,
    };
    bytes(&film, layers)
}

/// Bytes of the sums and of two images.
fn bytes(film: &FilmOptions, layers: u32) -> usize {
    let channels: usize =
        LAYERS.iter().filter(|(layer, _)| layers & *layer as u32 != 0).map(|(_, kind)| kind.channels()).sum();
    // What photons leave in a pixel is not known when a film is made.
    let kept = FilmOptions { gathering: false, ..*film }.bytes_in_memory();
    let pixels: u64 = film.resolution.map(u64::from).iter().product();
    let in_tiles: u64 = film.resolution.map(|side| u64::from(side.div_ceil(TILE) * TILE)).iter().product();
    let bytes = in_tiles * kept as u64 + pixels * 2 * 4 * (4 + channels as u64);
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

/// Checks the width and height of a film. `of` is what messages put before these names.
pub(super) fn check_size(sides: [u32; 2], of: &str) -> Result {
    let names = ["width", "height"];
    if let Some((name, _)) = names.iter().zip(sides).find(|(_, side)| *side == 0) {
        return Err(Failure::argument(format!("{of}{name} is 0, expected 1 or more")));
    }
    // The longer side is the one that is too long.
    let longer = usize::from(sides[1] > sides[0]);
    let (long, short) = (sides[longer], u64::from(sides[1 - longer]));
    let tiles = |length: u64| length.div_ceil(TILE.into());
    let most = |short: u64| {
        let in_tiles = 2 * MAX_PIXELS / u64::from(TILE * TILE) / tiles(short) * u64::from(TILE);
        in_tiles.min(MAX_PIXELS / short)
    };
    let refused = |limit: u64, beside: String| {
        let message = format!("{of}{} is {long}, expected {limit} at most{beside}", names[longer]);
        Err(Failure::argument(message))
    };
    if u64::from(long) > most(1) {
        return refused(most(1), String::new());
    }
    if u64::from(long) > most(short) {
        return refused(most(short), format!(" beside a {} of {short}", names[1 - longer]));
    }
    Ok(())
}
