//! Whether the pixels of a render share hits: by its settings, or by a pilot that tries both ways in small parts of the picture.

use std::sync::Arc;
use std::time::Duration;

use super::method::Method;
use super::order::SQUARE;
use super::pass::{Pass, PassInput};
use super::settings::RenderSettings;
use crate::control::Parallel;
use crate::desc::{IntegratorDesc, RenderDesc};
use crate::error::Result;
use crate::film::{ErrorEstimate, Film, FilmOptions, Placement};
use crate::integrator::reuse::PathReuse;
use crate::integrator::{check_reuse, no_reuse};
use crate::scene::Scene;

/// Least and greatest number of squares of a pilot in a row and in a column.
const ACROSS: [u32; 2] = [6, 10];

/// Number of samples per pixel of a pilot: two for each replicate.
const SAMPLES: u32 = 16;

/// Number of samples of a picture over those of its pilot. Both ways together take about the time of three paths for each sample of the
/// pilot, which then is a thirtieth of the picture's.
const TIMES_LONGER: u64 = 90;

/// Shortest time limit with which a pilot is made.
const LEAST_TIME: Duration = Duration::from_secs(10);

/// Random numbers of the pilot. They do not depend on the seed of the render, so that renders of the same settings choose alike.
const SEED: u64 = 0x70_696c_6f74;

/// Time of a ray of sharing over the time of a path's ray without. The rays that sharing adds are shadow rays to common ends.
const TIME_OF_A_RAY: f64 = 0.45;

/// The gain in time from which on hits are shared. Pilots promise a little more than pictures keep.
const LEAST_GAIN: f64 = 1.1;

/// A square of which few pixels have most of the error is left out where one way has so many times the error of the other.
const FEW_TIMES: f64 = 4.0;

/// Whether pixels share hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sharing {
    No,
    Yes,
    /// A pilot says, of so many squares in a row and in a column.
    ByPilot(u32),
}

impl Sharing {
    /// What the settings say. `place`: what is rendered, where that is no picture.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Unsupported`] where the settings ask for what cannot be done.
    pub fn of(
        scene: &Scene,
        settings: &RenderSettings,
        integrator: IntegratorDesc,
        place: Option<&'static str>,
    ) -> Result<Self> {
        let desc = &settings.desc;
        // Whether a picture that was asked for can be rendered must not depend on what is chosen for the scene.
        let asked = if desc.reuse == Some(true) { desc.integrator } else { integrator };
        let allowed = || {
            match place {
                Some(place) => no_reuse(&format!("{place} has no neighbouring pixels"), "false")?,
                None => check_reuse(scene, asked, desc)?,
            }
            if settings.adaptive == Some(true) {
                let why = "adaptive sampling gives neighbouring pixels different numbers of samples";
                no_reuse(why, "false, or the same number of samples in all pixels")?;
            }
            Ok(())
        };
        match desc.reuse {
            Some(true) => allowed().map(|()| Self::Yes),
            Some(false) => Ok(Self::No),
            None => Ok(match squares_across(settings).filter(|_| allowed().is_ok()) {
                Some(across) => Self::ByPilot(across),
                None => Self::No,
            }),
        }
    }
}

/// Number of squares of the pilot in a row and in a column, for a render that is so long that the pilot is a small part of it. `None` for
/// others, and for adaptive renders.
///
/// It is the picture that counts, whatever part of it is rendered: each part is to show what the whole picture does.
fn squares_across(settings: &RenderSettings) -> Option<u32> {
    let [width, height] = settings.desc.resolution;
    let samples = u64::from(width) * u64::from(height) * u64::from(settings.desc.samples);
    let affordable = (samples / (TIMES_LONGER * u64::from(SQUARE * SQUARE * SAMPLES))).isqrt();
    let across = affordable.min(u64::from(ACROSS[1])).min(u64::from(width.min(height) / SQUARE)) as u32;
    // How many samples there will be is not known.
    let across = if settings.time_limit.is_some() { across.min(ACROSS[0]) } else { across };
    let is_short = settings.time_limit.is_some_and(|limit| limit < LEAST_TIME);
    let is_adaptive = settings.adaptive.unwrap_or(settings.target_error.is_some());
    (across >= ACROSS[0] && !is_short && !is_adaptive).then_some(across)
}

/// What a pilot found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// How many times longer a picture takes without shared hits to the same error.
    pub gain: f64,
    /// Number of rays of the pilot.
    pub rays: u64,
}

impl Found {
    pub fn shares(&self) -> bool {
        self.gain >= LEAST_GAIN
    }
}

const NO_ERROR: ErrorEstimate = ErrorEstimate { value: 0.0, standard_error: 0.0 };

/// What a square of the pilot came to.
#[derive(Clone, Copy, Debug)]
struct Cost {
    /// Estimated relMSE, or [`NO_ERROR`] where the square is black.
    error: ErrorEstimate,
    rays: u64,
}

/// Whether the error of a square says nothing about the ways: rare bright paths were met by one of them only.
fn is_by_chance(square: &[Cost; 2]) -> bool {
    let [mut less, mut more] = square.map(|cost| cost.error);
    if less.value > more.value {
        std::mem::swap(&mut less, &mut more);
    }
    more.is_heavy_tailed() && more.value > FEW_TIMES * less.value
}

/// Renders small squares of the picture with and without shared hits.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`] if the work was stopped, `OutOfMemory` for films of squares that do not fit.
pub(super) fn pilot(
    input: &PassInput,
    (sharing, across): &(PathReuse, u32),
    parallel: &mut impl Parallel,
) -> Result<Found> {
    let across = *across;
    let token = parallel.token();
    let desc = Arc::new(RenderDesc { seed: SEED, samples: SAMPLES, ..(*input.desc).clone() });
    let input = PassInput { desc, ..input.clone() };
    let methods = [Method::Path, Method::Reuse(sharing.clone())];
    let squares = parallel.map((across * across) as usize, move |number| {
        let cost = |method: &Method| {
            let film = Arc::new(square(&input, across, number as u32)?);
            let input = PassInput { method: method.clone(), film: Arc::clone(&film), ..input.clone() };
            let rays = Pass::new(input, SAMPLES, None, token.clone()).into_rays();
            Ok(Cost { error: film.rel_mse().unwrap_or(NO_ERROR), rays })
        };
        Ok([cost(&methods[0])?, cost(&methods[1])?])
    })?;
    Ok(compare(squares.into_iter().collect::<Result<_>>()?))
}

/// The film of a square of the pilot. Each cell of the picture has a square, at places that are spread evenly and differ from cell to
/// cell.
fn square(input: &PassInput, across: u32, number: u32) -> Result<Film> {
    // Multiples of the generalised golden ratio (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences").
    let spread = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2].map(|step| (f64::from(number + 1) * step).fract());
    let cell = [number % across, number / across];
    let picture = input.desc.resolution;
    let origin = [0, 1].map(|axis| {
        let size = f64::from(picture[axis]) / f64::from(across);
        let place = f64::from(cell[axis]) * size + spread[axis] * (size - f64::from(SQUARE));
        place as u32 / SQUARE * SQUARE
    });
    let placement = Some(Placement { origin, picture, pixel_aspect: 1.0 });
    let options = input.film.options();
    Film::new(FilmOptions { resolution: [SQUARE; 2], placement, auxiliary: false, ..*options })
}

/// The gain of sharing by the squares' costs without and with it.
fn compare(mut squares: Vec<[Cost; 2]>) -> Found {
    let rays = [0, 1].map(|way| squares.iter().map(|square| square[way].rays).sum::<u64>());
    squares.retain(|square| !is_by_chance(square));
    let [alone, shared] = [0, 1].map(|way| squares.iter().map(|square| square[way].error.value).sum::<f64>());
    let times_rays = rays[1] as f64 / (rays[0] as f64).max(1.0);
    let times_longer = 1.0 + TIME_OF_A_RAY * (times_rays - 1.0);
    // Black squares, and those without noise, gain nothing.
    let gain = if alone > 0.0 { alone / (shared * times_longer).max(f64::MIN_POSITIVE) } else { 0.0 };
    Found { gain, rays: rays[0] + rays[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares with errors [value, standard error] without and with shared hits.
    fn squares(errors: &[[[f64; 2]; 2]], rays: [u64; 2]) -> Vec<[Cost; 2]> {
        let cost = |[value, standard_error]: [f64; 2], rays| {
            let error = ErrorEstimate { value, standard_error };
            Cost { error, rays }
        };
        errors.iter().map(|errors| [0, 1].map(|way| cost(errors[way], rays[way]))).collect()
    }

    #[test]
    fn the_gain_is_that_of_errors_over_that_of_rays() {
        let found = compare(squares(&[[[0.3, 0.01], [0.1, 0.01]]; 36], [100, 300]));
        assert!((found.gain - 3.0 / 1.9).abs() < 1e-12, "{found:?}");
        assert_eq!(found.rays, 36 * 400);
        assert!(found.shares());
        assert!(!compare(squares(&[[[0.3, 0.01], [0.2, 0.01]]; 36], [100, 300])).shares());
    }

    #[test]
    fn rare_bright_paths_do_not_decide() {
        let mut errors = [[[0.3, 0.01], [0.1, 0.01]]; 36];
        errors[7][1] = [1e6, 9e5];
        errors[20][0] = [1e9, 9e8];
        let found = compare(squares(&errors, [100, 100]));
        assert!((found.gain - 3.0).abs() < 1e-12, "{found:?}");
        // Both ways have the same few noisy pixels, as at the edges of lamps.
        errors[7] = [[300.0, 200.0]; 2];
        assert!(compare(squares(&errors, [100, 100])).gain < 1.1);
    }

    #[test]
    fn squares_without_light_or_noise_share_nothing() {
        let of = |errors, rays| compare(squares(&[errors; 36], rays)).shares();
        assert!(!of([[0.0; 2]; 2], [100, 100]));
        assert!(!of([[0.0; 2]; 2], [0, 0]));
        assert!(of([[0.1, 0.0], [0.0; 2]], [100, 100]));
    }
}
