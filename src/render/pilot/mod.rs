//! A pilot: small parts of the picture that are rendered in several ways, and some light paths, which say in which way the render takes
//! least time to the same error.
//!
//! Where light paths are open, the squares are rendered with the weights that paths from the camera have beside light paths, so that their
//! error is of all else; 16 samples would tell little of how rarely such paths meet a caustic. What that comes to is told by light paths.
//! Where one of them arrives, both its density and the density a with which paths from the camera find the same light are known. With
//! contributions x = f / b for the density b of N light paths, second moments are sums over them: f^2 / a, of paths from the camera
//! alone, is the sum of x^2 b / a; a f^2 / (a + b)^2, of these with their weights, that of x^2 a b / (a + b)^2; and f^2 / (a + b), of both
//! together, that of x^2 b / (a + b). With k times as many light paths, b becomes k b.
//!
//! Where a bias is allowed, the best of these ways is compared with the irradiance cache ([`cached`]).
//!
//! Every other square is rendered once more with several light samples for each at the hits that the camera sees. The error is A + B / n
//! for n times as many, so that both errors give B.
//!
//! Source: Grittmann, Yazici, Georgiev, Slusallek 2022, "Efficiency-Aware Multiple Importance Sampling for Bidirectional Rendering
//! Algorithms".

mod cached;
mod gain;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use cached::{Asked, try_cache};
use gain::{
    Caustics, Cost, NO_ERROR, SAMPLES_TRIED, Square, TIME_OF_A_LIGHT_RAY, TIME_OF_A_RAY_AMONG_SHARED, TIMES_AS_MANY,
    compare, mean_error,
};
pub(super) use gain::{Found, MOST_TIMES};

use super::method::Method;
use super::order::SQUARE;
use super::pass::{Light, Pass, PassInput};
use super::ways::{LIGHT_SEED, SAMPLES, Undecided};
use crate::control::{Cancel, Parallel};
use crate::desc::RenderDesc;
use crate::error::Result;
use crate::film::{Film, FilmOptions, Placement};
use crate::integrator::aim::Aims;
use crate::integrator::light_tracing::{LightPaths, LightPictures, PATHS_A_BLOCK};
use crate::integrator::photon::Plan;
use crate::spectrum::LUMINANCE_WEIGHTS;

/// Least and greatest number of squares of a pilot in a row and in a column.
pub(super) const ACROSS: [u32; 2] = [6, 10];

/// Number of samples of a picture over those of its pilot. All ways together take about the time of four paths for each sample of the
/// pilot, which then is a thirtieth of the picture's.
pub(super) const TIMES_LONGER: u64 = 110;

/// Number of samples of a picture for each light path of its pilot.
const SAMPLES_A_LIGHT_PATH: u64 = 48;

/// Most light paths of a pilot.
const MOST_LIGHT_PATHS: u64 = 1 << 20;

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
    let across = undecided.across;
    let token = parallel.token();
    let asked = f64::from(input.desc.samples);
    let samples = input.desc.resolution.map(u64::from).iter().product::<u64>() * u64::from(input.desc.samples);
    let desc = Arc::new(RenderDesc { seed: SEED, samples: SAMPLES, ..(*input.desc).clone() });
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
    let squares = {
        let (input, methods) = (input.clone(), methods.clone());
        parallel.map((across * across) as usize, move |number| {
            let origin = place(&input, across, number as u32);
            let mut square = Square { origin, costs: Vec::new(), pixels: Vec::new(), caustics: Vec::new() };
            let is_even = (number as u32 / across + number as u32 % across).is_multiple_of(2);
            for (method, first_shadow_rays) in methods.iter().take(if is_even { methods.len() } else { kinds }) {
                let (method, first_shadow_rays) = (method.clone(), *first_shadow_rays);
                let has_light = input.light.is_some();
                let input = PassInput { method, first_shadow_rays, ..input.clone() };
                let (film, cost) = render_square(input, origin, token.clone())?;
                square.costs.push(cost);
                square.pixels.extend(has_light.then(|| film.luminances()));
            }
            Ok(square)
        })?
    };
    let mut squares = squares.into_iter().collect::<Result<Vec<_>>>()?;
    let mut light_rays = (0, 1);
    if let Some(paths) = &undecided.light {
        let count = (samples / SAMPLES_A_LIGHT_PATH).clamp(u64::from(PATHS_A_BLOCK), MOST_LIGHT_PATHS) as u32;
        let rays = trace_light(&input, paths, count, &aims, &mut squares, parallel)?;
        light_rays = (rays, count);
    }
    let pixels = input.desc.resolution.map(f64::from).iter().product::<f64>();
    let light = undecided.light.as_ref().map(|paths| {
        // Of a sample of the squares' pixels.
        let rays = light_rays.0 as f64 / f64::from(light_rays.1) * f64::from(paths.count()) / pixels;
        (paths.count(), rays * f64::from(across * across * SQUARE * SQUARE * SAMPLES))
    });
    let ray = if matches!(input.method, Method::Reuse(_)) { TIME_OF_A_RAY_AMONG_SHARED } else { 1.0 };
    let mut found = compare(&squares, kinds, light, ray);
    found.rays += light_rays.0;
    found.time += TIME_OF_A_LIGHT_RAY * light_rays.0 as f64;
    if let Some(CacheToTry { plan, time_left }) = cache {
        let asked = match time_left {
            None => Asked { samples: asked, pixels },
            Some(left) => {
                let rendered = input.film.options().resolution.map(f64::from).iter().product::<f64>();
                let ray = start.elapsed().as_secs_f64() / found.time.max(1.0);
                let left = left.saturating_sub(start.elapsed()).as_secs_f64();
                let in_time = left / (ray * found.best.rays * rendered);
                Asked { samples: asked.min(in_time).max(1.0), pixels: rendered }
            }
        };
        let (cached, rays) = try_cache(&input, plan, (across, &squares, found.best), asked, parallel)?;
        found.rays += rays;
        found.cached = Some(cached);
    }
    Ok(found)
}

/// Traces light paths, and adds what they tell to the squares where they arrive. `aims` are those of each way that all
/// squares have.
fn trace_light(
    input: &PassInput,
    paths: &LightPaths,
    count: u32,
    aims: &[Option<Aims>],
    squares: &mut [Square],
    parallel: &mut impl Parallel,
) -> Result<u64> {
    let kinds = aims.len();
    let origins: Vec<[u32; 2]> = squares.iter().map(|square| square.origin).collect();
    let (scene, paths, aims, token) = (input.scene.clone(), paths.clone(), aims.to_vec(), parallel.token());
    let shares = f64::from(paths.count()) / f64::from(count);
    let blocks = parallel.map(count.div_ceil(PATHS_A_BLOCK) as usize, move |block| {
        let first = block as u32 * PATHS_A_BLOCK;
        let range = first..count.min(first + PATHS_A_BLOCK);
        let mut told = Vec::new();
        if token.is_cancelled() {
            return (told, 0);
        }
        let rays = paths.connections(&scene, (0, SEED ^ LIGHT_SEED), range, &mut |connection| {
            let inside = |origin: &[u32; 2]| {
                (0..2).all(|axis| {
                    let at = connection.place[axis] - origin[axis] as f32;
                    (0.0..SQUARE as f32).contains(&at)
                })
            };
            let Some(square) = origins.iter().position(inside) else { return };
            let [x, y] = [0, 1].map(|axis| (connection.place[axis] - origins[square][axis] as f32) as u32);
            let pixel = (y.min(SQUARE - 1) * SQUARE + x.min(SQUARE - 1)) as usize;
            let value = f64::from(connection.light.dot(LUMINANCE_WEIGHTS));
            let density = f64::from(connection.density);
            let [p, n, wi] = connection.at;
            let of = aims.iter().map(|aims| {
                let aimed = aims.as_ref().filter(|aims| !aims.is_empty()).map_or(0.0, |aims| aims.pdf(p, n, wi));
                let own = f64::from(connection.seen * (connection.pdf + aimed));
                let both = own + density;
                let moment = shares * value * value * density;
                let beside = TIMES_AS_MANY.map(|times| moment / (own + f64::from(times) * density));
                let caustics = Caustics { alone: moment / own, weighted: moment * own / (both * both), beside };
                (shares * value * density / both, caustics)
            });
            let of: Vec<(f64, Caustics)> = of.collect();
            told.push((square, pixel, of));
        });
        (told, rays)
    })?;
    let mut rays = 0;
    // For each square and pixel the light, by the weights of the last way, and the moments of each way.
    let mut brought: BTreeMap<(usize, usize), (f64, Vec<Caustics>)> = BTreeMap::new();
    for (told, block_rays) in blocks {
        rays += block_rays;
        for (square, pixel, of) in told {
            let (light, moments) =
                brought.entry((square, pixel)).or_insert_with(|| (0.0, vec![Caustics::default(); of.len()]));
            *light += of.last().map_or(0.0, |(light, _)| *light);
            for (sum, (_, of)) in moments.iter_mut().zip(&of).filter(|(_, (_, of))| of.alone.is_finite()) {
                sum.add(of, 1.0);
            }
        }
    }
    for (number, square) in squares.iter_mut().enumerate() {
        square.caustics = vec![Caustics::default(); square.costs.len()];
        let of_pixel = |pixel: usize| brought.get(&(number, pixel));
        // The last way has the least noise, but for the one with more light samples, which not all squares have.
        let means = square.pixels[..square.pixels.len().min(kinds)].last().into_iter().flatten().enumerate();
        let means: Vec<f64> =
            means.map(|(pixel, [mean, _])| mean + of_pixel(pixel).map_or(0.0, |(light, _)| *light)).collect();
        let squared = squared(&means);
        for (cost, pixels) in square.costs.iter_mut().zip(&square.pixels) {
            cost.error = mean_error(pixels.iter().zip(&squared).map(|([_, variance], squared)| variance / squared));
        }
        for (pixel, squared) in squared.iter().enumerate() {
            let Some((_, moments)) = of_pixel(pixel) else { continue };
            // Of the mean of a pixel's samples, and of the square's pixels.
            let scale = 1.0 / (squared * f64::from(SAMPLES * SQUARE * SQUARE));
            square.caustics.iter_mut().zip(moments).for_each(|(sum, of)| sum.add(of, scale));
        }
    }
    Ok(rays)
}

/// Squares of the pixels' means as relMSE divides by them, from means over 3 x 3 pixels, since a pixel's own would be bright where chance
/// made its error large.
fn squared(means: &[f64]) -> Vec<f64> {
    let side = SQUARE as usize;
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let floor = (1e-2 * mean * mean).max(f64::MIN_POSITIVE);
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
    let blurred = |pixel: usize| {
        let (x, y) = (pixel % side, pixel / side);
        let (mut sum, mut count) = (0.0, 0.0);
        for y in around(y) {
            for x in around(x) {
                (sum, count) = (sum + means[y * side + x], count + 1.0);
            }
        }
        let mean: f64 = sum / count;
        mean * mean + floor
    };
    (0..means.len()).map(blurred).collect()
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
fn render_square(input: PassInput, origin: [u32; 2], token: Cancel) -> Result<(Arc<Film>, Cost)> {
    let film = Arc::new(film(&input, origin)?);
    let rays = Pass::new(PassInput { film: Arc::clone(&film), ..input }, SAMPLES, None, token).into_rays();
    let error = film.rel_mse().unwrap_or(NO_ERROR);
    Ok((film, Cost { error, rays }))
}

/// The film of a square.
fn film(input: &PassInput, origin: [u32; 2]) -> Result<Film> {
    let placement = Some(Placement { origin, picture: input.desc.resolution, pixel_aspect: 1.0 });
    let options = input.film.options();
    Film::new(FilmOptions { resolution: [SQUARE; 2], placement, auxiliary: false, light_parts: false, ..*options })
}
