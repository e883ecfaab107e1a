//! False-colour pictures of planes: a cell for each point, a name above, a scale beside.
//!
//! The picture shows a plane with its first side to the right and its second one upwards.

use colorous::VIRIDIS;
use etendue::desc::{GridDesc, PlaneGridDesc};
use etendue::film::Image;
use etendue::lighting::Measured;
use etendue::spectrum::srgb_decode;
use font8x8::UnicodeFonts;

use super::{GridResult, LuxResult, table};

/// Length of a plane's longer side in the picture, pixels.
const SIDE: usize = 480;

/// Pixels between the parts.
const GAP: usize = 16;

/// Width of the scale's bar, and of it with its numbers.
const BAR: usize = 24;
const SCALE: usize = BAR + 4 + 10 * GLYPH;

/// Height of the bar.
const BAR_HEIGHT: usize = 240;

/// Side of a character.
const GLYPH: usize = 8;

/// Numbers beside the bar, but for the one at its lower end.
const TICKS: usize = 5;

/// Most planes in one picture, which is then some sixteen thousand pixels high.
const MOST_PLANES: usize = 32;

/// Checks that the planes among grids can be drawn, each point as a cell of its own.
pub fn check(grids: &[GridDesc]) -> Result<(), String> {
    let planes: Vec<_> = grids.iter().filter_map(|grid| Some((grid, grid.plane()?))).collect();
    if planes.is_empty() {
        return Err("none of the grids is a plane to be drawn".to_owned());
    }
    if planes.len() > MOST_PLANES {
        return Err(format!("{} planes are too many for a picture, expected {MOST_PLANES} at most", planes.len()));
    }
    for (grid, plane) in planes {
        let [across, down] = size(plane);
        let [columns, rows] = plane.counts.map(|count| count as usize);
        if columns > across || rows > down {
            let name = &grid.name;
            return Err(format!(
                "the plane '{name}' has {columns}x{rows} points, of which a picture of it shows {across}x{down} at most"
            ));
        }
    }
    Ok(())
}

/// Draws the planes one under another, all with one scale from 0 to `top`, or to a round number above all values.
pub fn draw(result: &LuxResult, top: Option<f64>) -> Image {
    let planes: Vec<&GridResult> = result.grids.iter().filter(|grid| grid.grid.plane().is_some()).collect();
    let sizes: Vec<[usize; 2]> = planes.iter().filter_map(|grid| grid.grid.plane()).map(size).collect();
    let greatest =
        planes.iter().flat_map(|grid| shown(grid).0.values.iter().map(|x| shown(grid).1 * x)).fold(0.0, f64::max);
    let top = top.unwrap_or_else(|| round_above(greatest));
    let unit = if result.exterior.is_some() { "%" } else { "lx" };
    let widest = sizes.iter().map(|[width, _]| *width).max().unwrap_or(0);
    let titles = planes.iter().map(|grid| title(grid).chars().count() * GLYPH).max().unwrap_or(0);
    let width = (GAP + widest + GAP + SCALE + GAP).max(2 * GAP + titles.min(2 * SIDE));
    let heights: usize = sizes.iter().map(|[_, height]| 2 * GLYPH + height + GAP).sum();
    let mut canvas = Canvas::new(width, (GAP + heights).max(2 * GAP + BAR_HEIGHT + 4 * GLYPH));
    let mut y = GAP;
    for (grid, [across, down]) in planes.iter().zip(&sizes) {
        canvas.text([GAP, y], &title(grid));
        y += 2 * GLYPH;
        cells(&mut canvas, [GAP, y], [*across, *down], grid, top);
        y += down + GAP;
    }
    scale(&mut canvas, [GAP + widest + GAP, GAP + 2 * GLYPH], top, unit);
    canvas.into_image()
}

/// The values that are drawn, and the factor to the unit of the scale.
fn shown(grid: &GridResult) -> (&Measured, f64) {
    grid.factors.as_ref().map_or((&grid.measured, 1.0), |factors| (factors, 100.0))
}

fn title(grid: &GridResult) -> String {
    let (measured, factor) = shown(grid);
    let figures = measured.statistics().map_or_else(String::new, |figures| {
        format!(": mean {}, U0 {:.2}", table::value(factor * figures.mean), figures.uniformity)
    });
    format!("{}{figures}", grid.grid.name)
}

/// Width and height of a plane in the picture; as its sides are to each other, but for very long ones.
fn size(plane: &PlaneGridDesc) -> [usize; 2] {
    let lengths = [plane.u.length(), plane.v.length()];
    let longest = lengths[0].max(lengths[1]);
    lengths.map(|length| ((SIDE as f64 * length / longest).round() as usize).max(GLYPH))
}

fn cells(canvas: &mut Canvas, [left, above]: [usize; 2], [across, down]: [usize; 2], grid: &GridResult, top: f64) {
    let Some(plane) = grid.grid.plane() else { return };
    let [columns, rows] = plane.counts.map(|count| count as usize);
    let (measured, factor) = shown(grid);
    for y in 0..down {
        let j = (down - 1 - y) * rows / down;
        for x in 0..across {
            let i = x * columns / across;
            canvas.set([left + x, above + y], colour(factor * measured.values[j * columns + i] / top));
        }
    }
}

fn scale(canvas: &mut Canvas, [left, above]: [usize; 2], top: f64, unit: &str) {
    canvas.text([left, above - 2 * GLYPH], unit);
    for y in 0..BAR_HEIGHT {
        let share = 1.0 - (y as f64 + 0.5) / BAR_HEIGHT as f64;
        (0..BAR).for_each(|x| canvas.set([left + x, above + y], colour(share)));
    }
    for tick in 0..=TICKS {
        let y = above + BAR_HEIGHT * (TICKS - tick) / TICKS;
        let number = top * tick as f64 / TICKS as f64;
        canvas.text([left + BAR + 4, y.saturating_sub(GLYPH / 2)], &table::trimmed(number));
    }
}

/// The colour of a share of the scale, sRGB. Values above the scale have the colour of its end.
fn colour(share: f64) -> [u8; 3] {
    VIRIDIS.eval_continuous(if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }).as_array()
}

/// The least number of one digit, or of a digit and a half, that is no less than `x`.
fn round_above(x: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return 1.0;
    }
    let size = 10_f64.powf(x.log10().floor());
    let steps = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    steps.into_iter().map(|step| step * size).find(|&top| top >= x).unwrap_or(10.0 * size)
}

/// A white picture of 8-bit sRGB.
struct Canvas {
    size: [usize; 2],
    pixels: Vec<[u8; 3]>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self { size: [width, height], pixels: vec![[255; 3]; width * height] }
    }

    fn set(&mut self, [x, y]: [usize; 2], colour: [u8; 3]) {
        if x < self.size[0] && y < self.size[1] {
            self.pixels[y * self.size[0] + x] = colour;
        }
    }

    /// Writes a line of text from its upper left corner on; characters without a glyph are question marks.
    fn text(&mut self, [left, above]: [usize; 2], text: &str) {
        for (place, character) in text.chars().enumerate() {
            let glyph = font8x8::BASIC_FONTS.get(character).or(font8x8::LATIN_FONTS.get(character));
            let Some(glyph) = glyph.or(font8x8::BASIC_FONTS.get('?')) else { continue };
            for (y, row) in glyph.into_iter().enumerate() {
                for x in (0..GLYPH).filter(|x| row >> x & 1 == 1) {
                    self.set([left + place * GLYPH + x, above + y], [0; 3]);
                }
            }
        }
    }

    /// The picture in linear values, from which writing makes the same 8 bits.
    fn into_image(self) -> Image {
        let linear = |byte: u8| srgb_decode(f32::from(byte) / 255.0);
        let rgb = self.pixels.into_iter().flatten().map(linear).collect();
        Image { width: self.size[0] as u32, height: self.size[1] as u32, rgb, ..Image::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_at_round_numbers() {
        assert_eq!([0.0, 0.9, 1.0, 111.1, 160.0, 8100.0].map(round_above), [1.0, 1.0, 1.0, 150.0, 200.0, 10000.0]);
    }

    #[test]
    fn text_is_black_on_white() {
        let mut canvas = Canvas::new(40, 8);
        canvas.text([0, 0], "1²é☃");
        let dark = |from: usize| (0..8 * 40).filter(|i| i % 40 / 8 == from && canvas.pixels[*i] == [0; 3]).count();
        assert!((0..4).all(|place| dark(place) > 3), "{:?}", [dark(0), dark(1), dark(2), dark(3)]);
        assert_eq!(dark(4), 0);
    }
}
