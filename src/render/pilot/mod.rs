//! A pilot: small parts of the picture that are rendered in several ways, and some light paths, which say in which way the render takes
//! least time to the same error.
//!
//! Where light paths are open, the squares are rendered with the weights that paths from the camera have beside light paths, so that their
//! error is of all else; few samples would tell little of how rarely such paths meet a caustic. What that comes to is told by light paths.
//! Where one of them arrives, both its density and the density a with which paths from the camera find the same light are known. With
//! contributions x = f / b for the density b of N light paths, second moments are sums over them: f^2 / a, of paths from the camera
//! alone, is the sum of x^2 b / a; a f^2 / (a + b)^2, of these with their weights, that of x^2 a b / (a + b)^2; and f^2 / (a + b), of both
//! together, that of x^2 b / (a + b). With k times as many light paths, b becomes k b.
//!
//! Where a bias is allowed, the best of these ways is compared with the irradiance cache ([`cached`]).
//!
//! Errors are those of most pixels ([`measure`]), because the few that have much more are met by chance.
//!
//! Every other square, or of a small pilot every one, is rendered once more with several light samples for each at the hits that the camera
//! sees. The error is A + B / n for n times as many, so that both errors give B.
//!
//! Source: Grittmann, Yazici, Georgiev, Slusallek 2022, "Efficiency-Aware Multiple Importance Sampling for Bidirectional Rendering
//! Algorithms".

mod cached;
mod gain;
mod light;
mod measure;
mod size;

use std::sync::Arc;
use std::time::{Duration, Instant};

use cached::{Asked, try_cache};
use gain::{Cost, Given, SAMPLES_TRIED, Square, TIME_OF_A_LIGHT_RAY, TIME_OF_A_RAY_AMONG_SHARED, compare};
pub(super) use gain::{Found, MOST_TIMES};
use light::{Traced, trace_light};
use measure::{Measure, Pixels};
pub(super) use size::Size;

use super::method::Method;
use super::order::SQUARE;
use super::pass::{Light, Pass, PassInput};
use super::ways::Undecided;
use crate::control::{Cancel, Parallel};
use crate::desc::RenderDesc;
use crate::error::Result;
use crate::film::{Film, FilmOptions, Placement};
use crate::integrator::aim::Aims;
use crate::integrator::light_tracing::LightPictures;
use crate::integrator::photon::Plan;

/// Number of samples of a picture for which a pilot is large enough, for each light path of the pilot.
const SAMPLES_A_LIGHT_PATH: u64 = 48;

/// Random numbers of the pilot. They do not depend on the seed of the render, so that renders of the same settings choose alike.
const SEED: u64 = 0x70_696c_6f74;

/// What is to be compared with paths: the irradiance cache, in the time that is left, where there is a limit.
pub(super) struct CacheToTry<'a> {
    pub plan: &'a mut Plan,
    pub time_left: Option<Duration>,
}

/// Renders small squares of the picture in the ways that are open, and traces some light paths. `cache` is compared with the best of these
/// ways.
///
/// # Errors
/// [`crate::ErrorKind::Cancelled`] if the work was stopped, `OutOfMemory` for films of squares that do not fit.
pub(super) fn pilot(
    input: &PassInput,
    undecided: &Undecided,
    cache: Option<CacheToTry<'_>>,
    parallel: &mut impl Parallel,
) -> Result<Found> {
    let start = Instant::now();
    let size = undecided.size;
    let token = parallel.token();
    let asked = f64::from(input.desc.samples);
    let desc = Arc::new(RenderDesc { seed: SEED, samples: size.samples, ..(*input.desc).clone() });
    let input = PassInput { desc, ..input.clone() };
    let few = input.first_shadow_rays;
    let mut methods = vec![(input.method.clone(), few)];
    methods.extend(undecided.sharing.clone().map(|reuse| (Method::Reuse(reuse), few)));
    let kinds = methods.len();
    if undecided.first_shadow_rays {
        methods.extend(methods.last().map(|(method, _)| (method.clone(), few * SAMPLES_TRIED)));
    }
    let aims = methods[..kinds].iter().map(|(method, _)| match method {
        Method::Reuse(reuse) => Some(reuse.aims().clone()),
        _ => None,
    });
    let aims: Vec<Option<Aims>> = aims.collect();
    let open = undecided.light.clone().map(|paths| Light { paths, pictures: LightPictures::default() });
    let input = PassInput { light: open.or(input.light), ..input };
    let rendered = {
        let (input, methods) = (input.clone(), methods.clone());
        parallel.map(size.squares(), move |number| {
            let origin = place(&input, size.across, number as u32);
            let is_even = (number as u32 / size.across + number as u32 % size.across).is_multiple_of(2);
            let has_all = is_even || !size.is_large();
            let render = |(method, first_shadow_rays): &(Method, u32)| {
                let (method, first_shadow_rays) = (method.clone(), *first_shadow_rays);
                render_square(PassInput { method, first_shadow_rays, ..input.clone() }, origin, token.clone())
            };
            methods.iter().take(if has_all { methods.len() } else { kinds }).map(render).collect::<Result<Vec<_>>>()
        })?
    };
    // Squares that were cut short say nothing.
    parallel.check()?;
    let rendered = rendered.into_iter().collect::<Result<Vec<_>>>()?;
    let mut traced = Traced::default();
    if let Some(paths) = &undecided.light {
        let count = (size.samples_of_picture() / SAMPLES_A_LIGHT_PATH) as u32;
        let origins = (0..size.squares()).map(|number| place(&input, size.across, number as u32)).collect();
        traced = trace_light(&input, paths, count, &aims, origins, parallel)?;
    }
    let ways: Vec<Vec<&[[f64; 2]]>> =
        rendered.iter().map(|ways| ways.iter().map(|way| way.pixels.as_slice()).collect()).collect();
    let means = means(&ways, kinds, &traced);
    let squares = |measure: &Measure| -> Vec<Square> {
        let square = |(number, ways): (usize, &Vec<Rendered>)| {
            let cost = |way: &Rendered| Cost { error: measure.error(number, &way.pixels), rays: way.rays };
            Square { costs: ways.iter().map(cost).collect(), caustics: traced.caustics(number, kinds, measure, size) }
        };
        rendered.iter().enumerate().map(square).collect()
    };
    let pixels = input.desc.resolution.map(f64::from).iter().product::<f64>();
    let light = undecided.light.as_ref().map(|paths| {
        // Of a sample of the squares' pixels.
        let rays = traced.rays as f64 / f64::from(traced.count) * f64::from(paths.count()) / pixels;
        (paths.count(), rays * size.samples_of(size.squares() as f64))
    });
    let has_aims = aims.last().and_then(Option::as_ref).is_some_and(|aims| !aims.is_empty());
    let is_shared = matches!(input.method, Method::Reuse(_));
    let ray = if is_shared { TIME_OF_A_RAY_AMONG_SHARED[usize::from(has_aims)] } else { 1.0 };
    let has_many_lamps = input.scene.emitters().are_chosen_by_receiver();
    let given = Given { ways: kinds, light, ray, has_aims, has_many_lamps, size };
    let mut found = compare(&squares(&Measure::of(&ways, &means)), &given);
    found.rays += traced.rays;
    found.time += TIME_OF_A_LIGHT_RAY * traced.rays as f64;
    if let Some(CacheToTry { plan, time_left }) = cache {
        let measure = Measure::whole(&means);
        let best = compare(&squares(&measure), &given).best;
        let asked = match time_left {
            None => Asked { samples: asked, pixels, size },
            Some(left) => {
                let rendered = input.film.options().resolution.map(f64::from).iter().product::<f64>();
                let ray = start.elapsed().as_secs_f64() / found.time.max(1.0);
                let left = left.saturating_sub(start.elapsed()).as_secs_f64();
                let in_time = left / (ray * best.rays * rendered);
                Asked { samples: asked.min(in_time).max(1.0), pixels: rendered, size }
            }
        };
        let (cached, rays) = try_cache(&input, plan, (&measure, best), asked, parallel)?;
        found.rays += rays;
        found.cached = Some(cached);
    }
    Ok(found)
}

/// What a square of the pilot came to in one way.
pub(super) struct Rendered {
    pub pixels: Pixels,
    pub rays: u64,
}

/// Means of the squares' pixels, by the last of so many ways, which has the least noise but for that with more light samples, which not
/// all squares have.
fn means(ways: &[Vec<&[[f64; 2]]>], kinds: usize, traced: &Traced) -> Vec<Vec<f64>> {
    let of = |(number, ways): (usize, &Vec<&[[f64; 2]]>)| {
        let pixels = ways[..kinds].last().into_iter().flat_map(|pixels| pixels.iter()).enumerate();
        pixels.map(|(pixel, [mean, _])| mean + traced.light(number, pixel)).collect()
    };
    ways.iter().enumerate().map(of).collect()
}

/// Where a square of the pilot lies. Each cell of the picture has a square, at places that are spread evenly and differ from cell to
/// cell.
fn place(input: &PassInput, across: u32, number: u32) -> [u32; 2] {
    // Multiples of the generalised golden ratio (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences").
    let spread = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2].map(|step| (f64::from(number + 1) * step).fract());
    let cell = [number % across, number / across];
    let picture = input.desc.resolution;
    [0, 1].map(|axis| {
        let size = f64::from(picture[axis]) / f64::from(across);
        let place = f64::from(cell[axis]) * size + spread[axis] * (size - f64::from(SQUARE));
        place as u32 / SQUARE * SQUARE
    })
}

/// Renders a square that begins here, with the samples of a pilot.
fn render_square(input: PassInput, origin: [u32; 2], token: Cancel) -> Result<Rendered> {
    let film = Arc::new(film(&input, origin)?);
    let samples = input.desc.samples;
    let rays = Pass::new(PassInput { film: Arc::clone(&film), ..input }, samples, None, token).into_rays();
    Ok(Rendered { pixels: film.luminances(), rays })
}

/// The film of a square.
fn film(input: &PassInput, origin: [u32; 2]) -> Result<Film> {
    let placement = Some(Placement { origin, picture: input.desc.resolution, pixel_aspect: 1.0 });
    let options = input.film.options();
    Film::new(FilmOptions { resolution: [SQUARE; 2], placement, auxiliary: false, light_parts: false, ..*options })
}
