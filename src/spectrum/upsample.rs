//! Smooth spectra for colours of three channels.
//!
//! A reflectance is a sigmoid of a quadratic polynomial in the wavelength, whose three coefficients are found so that the surface has
//! its colour under D65. They are found by Newton's method for the colours of a grid when the first spectral scene is built, and
//! interpolated for other colours.
//!
//! Source: Jakob and Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral Upsampling". What is interpolated here
//! are coefficients times sqrt(z (1 - z)) for the largest channel z: they stay finite towards black and white, and those of
//! greys are linear in z, so that greys have constant spectra.

use std::sync::LazyLock;

use super::Rgb;
use super::illuminant::Illuminant;
use super::observer::{REC_709_FROM_XYZ, VISIBLE, XYZ_FROM_REC_709, color_matching};
use crate::math::{DMat3, DVec3, Vec4};

/// Colours of the grid along each axis: the largest channel, and the ratios of the other two to it.
const SIDE: usize = 32;

/// The largest channel of the first and of the last colours of the grid. Black and white have no finite coefficients.
const LEAST: f64 = 1e-4;
const MOST: f64 = 0.995;

/// Distance of the wavelengths at which a spectrum is summed \[nm\].
const STEP: f64 = 5.0;

/// Most steps of Newton's method.
const STEPS: u32 = 40;

/// A smooth reflectance: 1/2 + p / (2 sqrt(1 + p^2)), with p a polynomial in the wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothSpectrum {
    /// Coefficients of t^2, t and 1, where t is the wavelength, -1 at 360 nm and 1 at 830 nm.
    pub coefficients: [f32; 3],
}

/// Wavelengths \[nm\] as the polynomials have them: in [-1, 1].
#[inline(always)]
pub(super) fn normalised(nanometres: Vec4) -> Vec4 {
    const MIDDLE: f32 = ((VISIBLE[0] + VISIBLE[1]) / 2.0) as f32;
    const HALF: f32 = ((VISIBLE[1] - VISIBLE[0]) / 2.0) as f32;
    (nanometres - Vec4::splat(MIDDLE)) * (1.0 / HALF)
}

impl SmoothSpectrum {
    /// The reflectance at four wavelengths, which are those of [`normalised`].
    #[inline(always)]
    pub(super) fn at_normalised(self, t: Vec4) -> Vec4 {
        let [a, b, c] = self.coefficients;
        let p = (Vec4::splat(a) * t + Vec4::splat(b)) * t + Vec4::splat(c);
        let root = p * p + Vec4::ONE;
        Vec4::splat(0.5) + p * 0.5 / Vec4::from_array(root.to_array().map(f32::sqrt))
    }

    /// The reflectance at a wavelength \[nm\], in [0, 1].
    pub fn at(self, nanometres: f32) -> f32 {
        self.at_normalised(normalised(Vec4::splat(nanometres))).x
    }

    /// The reflectance whose colour under D65 is this one, with channels in [0, 1]; those outside are brought there.
    ///
    /// Its colour is off by 1e-3 of white in the mean, and by 7e-3 at most. Below a tenth of white it is off by 2e-3 of the tenth in the
    /// mean, most where it is saturated.
    #[inline]
    pub fn of_color(color: Rgb) -> Self {
        GRID.find(color)
    }
}

/// What a spectrum is at one of the wavelengths of the sum: the place t of the polynomial, and the weight of the spectrum there in
/// linear Rec. 709 under D65.
struct Node {
    t: f64,
    weight: DVec3,
}

/// The wavelengths of the sum. White has the sum (1, 1, 1).
static NODES: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let [low, high] = VISIBLE;
    let count = ((high - low) / STEP) as usize;
    let at = |i: usize| low + STEP * i as f64;
    let weight = |nanometres: f64| *REC_709_FROM_XYZ * color_matching(nanometres) * Illuminant::D65.power(nanometres);
    let sum: DVec3 = (0..=count).map(|i| weight(at(i))).sum();
    let place = |nanometres: f64| (2.0 * nanometres - low - high) / (high - low);
    (0..=count).map(|i| Node { t: place(at(i)), weight: weight(at(i)) / sum }).collect()
});

/// The colour of the spectrum of these coefficients, and its derivatives by them as columns.
fn color_of(coefficients: DVec3) -> (DVec3, DMat3) {
    let (mut color, mut derivatives) = (DVec3::ZERO, DMat3::ZERO);
    for &Node { t, weight } in NODES.iter() {
        let p = (coefficients.x * t + coefficients.y) * t + coefficients.z;
        let root = (1.0 + p * p).sqrt();
        color += weight * (0.5 + 0.5 * p / root);
        let slope = weight * (0.5 / (root * root * root));
        derivatives.x_axis += slope * (t * t);
        derivatives.y_axis += slope * t;
        derivatives.z_axis += slope;
    }
    (color, derivatives)
}

/// The coefficients of a colour by Newton's method from these ones on, with damping (Levenberg 1944, Marquardt 1963) by the
/// squared difference of colours in the units of CIELAB, which matters for the colours that no such spectrum has.
fn solve(target: DVec3, start: DVec3) -> DVec3 {
    let white = XYZ_FROM_REC_709.mul_vec3(DVec3::ONE);
    // Lightness and its slope, of a tristimulus value over that of white.
    let root = |t: f64| {
        const BEND: f64 = 6.0 / 29.0;
        if t > BEND.powi(3) {
            (t.cbrt(), 1.0 / (3.0 * t.cbrt().powi(2)))
        } else {
            (t / (3.0 * BEND * BEND) + 4.0 / 29.0, 1.0 / (3.0 * BEND * BEND))
        }
    };
    let lab = |color: DVec3| {
        let f = (XYZ_FROM_REC_709.mul_vec3(color) / white).to_array().map(root);
        let value = |i: usize| f[i].0;
        let slopes = DVec3::from_array(f.map(|(_, slope)| slope)) / white;
        let to_lab = DMat3::from_cols_array_2d(&[[0.0, 500.0, 0.0], [116.0, -500.0, 200.0], [0.0, 0.0, -200.0]]);
        (to_lab * DVec3::new(value(0), value(1), value(2)), to_lab * DMat3::from_diagonal(slopes) * *XYZ_FROM_REC_709)
    };
    let (wanted, _) = lab(target);
    let mut at = start;
    let mut damping = 1e-3;
    let (mut color, mut derivatives) = color_of(at);
    for _ in 0..STEPS {
        let (value, slopes) = lab(color);
        let residual = wanted - value;
        if residual.length_squared() < 1e-12 {
            break;
        }
        let jacobian = slopes * derivatives;
        let squared = jacobian.transpose() * jacobian;
        let downhill = jacobian.transpose() * residual;
        let mut has_moved = false;
        while damping < 1e12 {
            let diagonal = DVec3::new(squared.x_axis.x, squared.y_axis.y, squared.z_axis.z);
            let damped = squared + DMat3::from_diagonal(diagonal * damping + DVec3::splat(1e-12));
            let next = (at + damped.inverse() * downhill).clamp(DVec3::splat(-LIMIT), DVec3::splat(LIMIT));
            let (next_color, next_derivatives) = color_of(next);
            if (wanted - lab(next_color).0).length_squared() < residual.length_squared() {
                has_moved = next != at;
                (at, color, derivatives) = (next, next_color, next_derivatives);
                damping *= 0.1;
                break;
            }
            damping *= 10.0;
        }
        if !has_moved {
            break;
        }
    }
    at
}

/// Largest coefficient: the sigmoid is 0 or 1 in single precision far below.
const LIMIT: f64 = 1e4;

/// The coefficients of the grid, times sqrt(z (1 - z)), padded to four for aligned loads.
struct Grid {
    /// By the number of the largest channel, the two ratios and the largest channel.
    nodes: Vec<[f32; 4]>,
    /// The largest channels of the grid's colours.
    levels: [f32; SIDE],
    /// For the largest channel in equal parts of [0, 1]: the number of the level at or below the lower end of the part.
    parts: [u8; PARTS],
}

/// Number of [`Grid::parts`].
const PARTS: usize = 256;

static GRID: LazyLock<Grid> = LazyLock::new(Grid::new);

/// The largest channel of the grid's colours with this number. The colours are closer to each other towards black and white.
fn level(number: usize) -> f64 {
    let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
    let x = smooth(smooth(number as f64 / (SIDE - 1) as f64));
    LEAST + x * (MOST - LEAST)
}

impl Grid {
    fn new() -> Self {
        let mut nodes = vec![[0.0; 4]; 3 * SIDE * SIDE * SIDE];
        // On this thread alone: others of a pool may wait for the grid, and one that waits for them in turn would wait for ever.
        for (number, column) in nodes.chunks_mut(SIDE).enumerate() {
            let (channel, second, first) = (number / (SIDE * SIDE), number / SIDE % SIDE, number % SIDE);
            let ratio = |number: usize| number as f64 / (SIDE - 1) as f64;
            let mut color = [0.0; 3];
            color[channel] = 1.0;
            color[(channel + 1) % 3] = ratio(first);
            color[(channel + 2) % 3] = ratio(second);
            let color = DVec3::from_array(color);
            // From a medium level, where any colour is found from the spectrum of a grey, to both ends.
            let middle = SIDE / 2;
            let middle_solution = solve(color * level(middle), DVec3::ZERO);
            let mut fill = |levels: &mut dyn Iterator<Item = usize>| {
                let mut solution = middle_solution;
                let mut former = level(middle);
                for number in levels {
                    let z = level(number);
                    let scale = |z: f64| (z * (1.0 - z)).sqrt();
                    solution = solve(color * z, solution * (scale(former) / scale(z)));
                    former = z;
                    column[number] = (solution * scale(z)).as_vec3().extend(0.0).to_array();
                }
            };
            fill(&mut (middle..SIDE));
            fill(&mut (0..middle).rev());
        }
        let levels = std::array::from_fn(|number| level(number) as f32);
        let below = |z: f32| levels.iter().take(SIDE - 1).rposition(|level| *level <= z).unwrap_or(0);
        let parts = std::array::from_fn(|part| below(part as f32 / PARTS as f32) as u8);
        Self { nodes, levels, parts }
    }

    #[inline]
    fn find(&self, color: Rgb) -> SmoothSpectrum {
        let color = color.to_array().map(super::unit);
        let [r, g, b] = color;
        let channel = if r >= g && r >= b {
            0
        } else if g >= b {
            1
        } else {
            2
        };
        let z = color[channel];
        if z <= 0.0 {
            // Black, and what is no number.
            return SmoothSpectrum { coefficients: [0.0, 0.0, -LIMIT as f32] };
        }
        const LAST: f32 = (SIDE - 1) as f32;
        let cell = |place: f32| {
            let lower = (place as usize).min(SIDE - 2);
            (lower, place - lower as f32)
        };
        // Between two levels, coefficients are linear in the channel itself, as those of greys are.
        let within = z.clamp(LEAST as f32, MOST as f32);
        let mut level = usize::from(self.parts[(within * PARTS as f32) as usize]);
        while level < SIDE - 2 && within >= self.levels[level + 1] {
            level += 1;
        }
        let upper = (within - self.levels[level]) / (self.levels[level + 1] - self.levels[level]);
        let (first, right) = cell(color[(channel + 1) % 3] / z * LAST);
        let (second, far) = cell(color[(channel + 2) % 3] / z * LAST);
        let corner = ((channel * SIDE + second) * SIDE + first) * SIDE + level;
        let node = |offset: usize| Vec4::from_array(self.nodes[corner + offset]);
        let along = |offset: usize| node(offset).lerp(node(offset + 1), upper);
        let row = |offset: usize| along(offset).lerp(along(offset + SIDE), right);
        let found = row(0).lerp(row(SIDE * SIDE), far);
        let [a, b, c, _] = (found / (within * (1.0 - within)).sqrt()).to_array();
        SmoothSpectrum { coefficients: [a, b, c] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    fn colors(count: u32) -> impl Iterator<Item = DVec3> {
        let uniform = |i: u32| hash(7, i.into()) as f64 / 2.0_f64.powi(64);
        (0..count).map(move |i| DVec3::new(uniform(3 * i), uniform(3 * i + 1), uniform(3 * i + 2)))
    }

    fn round_trip(color: DVec3) -> DVec3 {
        let c = SmoothSpectrum::of_color(Rgb::from_f64(color)).coefficients.map(f64::from);
        color_of(DVec3::from_array(c)).0
    }

    #[test]
    fn colours_keep_their_colour() {
        for (scale, limits) in [(1.0, [9e-3, 1.2e-3]), (0.1, [2e-2, 2.5e-3])] {
            let (mut worst, mut sum) = (0.0_f64, 0.0);
            for color in colors(10_000).map(|color| color * scale) {
                let error = (round_trip(color) - color).abs().max_element() / scale;
                worst = worst.max(error);
                sum += error * error;
            }
            let mean = (sum / 1e4).sqrt();
            assert!(worst < limits[0] && mean < limits[1], "{scale}: {worst}, {mean}");
        }
    }

    #[test]
    fn greys_and_primaries_are_what_they_are() {
        for grey in [1e-4, 1e-3, 0.02, 0.3, 0.5, 0.9, 0.99] {
            let off = (round_trip(DVec3::splat(grey)) - DVec3::splat(grey)).abs().max_element();
            assert!(off < 1e-6, "{grey}: {off}");
        }
        for color in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 0.0, 1.0)] {
            let off = (round_trip(0.5 * color) - 0.5 * color).abs().max_element();
            assert!(off < 1e-3, "{color}: {off}");
        }
        let dark = SmoothSpectrum::of_color(Rgb::ZERO);
        let bright = SmoothSpectrum::of_color(Rgb::new(2.0, 3.0, f32::INFINITY));
        for nanometres in [360.0, 500.0, 830.0] {
            assert!(dark.at(nanometres) < 1e-6 && bright.at(nanometres) > 0.98, "{nanometres}");
            for none in [Rgb::NAN, Rgb::new(f32::NAN, 0.5, 0.2), Rgb::splat(-1.0)] {
                let at = SmoothSpectrum::of_color(none).at(nanometres);
                assert!((0.0..=1.0).contains(&at), "{none:?}: {at}");
            }
        }
    }
}
