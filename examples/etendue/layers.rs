//! Spectral layers of `render`: films of three bands, rendered one after another.

use std::ops::{ControlFlow, Range};

use etendue::film::Layer;
use etendue::output;
use etendue::render::{Render, RenderSettings};
use etendue::scene::Scene;
use etendue::spectrum::Sensor;

use crate::args::{RenderArgs, WavelengthRange};
use crate::console::{self, Bar};
use crate::failure::check_room;
use crate::{Failure, interrupt};

/// Number of bands of a film.
const A_FILM: usize = 3;

/// Bands of equal width, of which an image has layers.
#[derive(Clone, Copy, Debug)]
pub struct Bands {
    /// Number of bands, 3 or more.
    pub count: usize,
    /// First and last wavelength \[nm\] of all.
    range: [f64; 2],
}

impl Bands {
    /// The bands that are wanted.
    pub fn of(args: &RenderArgs) -> Result<Option<Self>, Failure> {
        let Some(count) = args.spectral_layers else { return Ok(None) };
        let WavelengthRange(range) = args.spectral_range;
        let width = (range[1] - range[0]) / f64::from(count);
        let least = Sensor::LEAST_WIDTH;
        // A little more, so that no band is refused for its rounding.
        if width < 1.001 * least {
            let message = format!(
                "--spectral-layers {count}: bands of {width:.3} nm are too narrow, expected fewer ones that are wider than {least} nm"
            );
            return Err(Failure::usage(message));
        }
        Ok(Some(Self { count: count as usize, range }))
    }
}

/// The first bands of the films, and which bands each of them is for. The last film repeats bands of the one before it where the number is
/// no multiple of three.
fn films(count: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
    (0..count).step_by(A_FILM).map(move |from| (from.min(count - A_FILM), from..(from + A_FILM).min(count)))
}

/// Renders all bands of a scene as `settings` say. A run that is stopped leaves out those that are not complete, and warns.
pub fn render(scene: &Scene, settings: &RenderSettings, bands: Bands, quiet: bool) -> Result<Vec<Layer>, Failure> {
    let Bands { count, range: [first, last] } = bands;
    let width = (last - first) / count as f64;
    // The last band ends where the range does, to the last bit.
    let edge = |number: usize| if number == count { last } else { first + width * number as f64 };
    let mut layers = Vec::new();
    let number = count.div_ceil(A_FILM);
    for (place, (begin, wanted)) in films(count).enumerate() {
        let sensor = Sensor::Bands { range: [edge(begin), edge(begin + A_FILM)] };
        let mut render =
            Render::new(scene, RenderSettings { sensor, auxiliary: false, light_parts: false, ..settings.clone() })?;
        let bar = Bar::new(quiet);
        let summary = render
            .run(&mut |progress| {
                bar.show((place as f64 + progress.fraction) / number as f64, format!("spectral layers of {count}"));
                if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .map_err(Failure::running)?;
        drop(bar);
        if summary.stopped {
            console::warn(format!("stopped: {} of {count} spectral layers are written", layers.len()));
            break;
        }
        let rgb = render.film().try_develop(1).map_err(Failure::running)?.rgb;
        for band in wanted {
            let name = output::spectral_layer(first + width * (band as f64 + 0.5));
            check_room(rgb.len() / A_FILM * size_of::<f32>())?;
            let data = rgb.iter().skip(band - begin).step_by(A_FILM).copied().collect();
            layers.push(Layer { name, channels: 1, data });
        }
    }
    Ok(layers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_band_has_one_film() {
        for count in 3..20 {
            let bands: Vec<usize> = films(count).flat_map(|(_, bands)| bands).collect();
            assert_eq!(bands, (0..count).collect::<Vec<_>>());
            assert!(films(count).all(|(begin, bands)| begin + A_FILM <= count && bands.end <= begin + A_FILM));
            assert!(films(count).all(|(begin, bands)| begin <= bands.start));
        }
    }
}
