//! Lookups against closed forms and brute force.

use std::sync::Arc;

use etendue::sampling::Rng;
use etendue::spectrum::Rgb;
use etendue::texture::{
    ColorSpace, Pattern, Procedural, TexelImage, Texels, Texture, TextureFilter, TexturePoint, Wrap,
};

use super::{FILTERS, image, texture};
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "X1", title: "linear ramp", run: ramp },
        Entry { id: "X2", title: "checker seen from far", run: checker },
        Entry { id: "X3", title: "mean of every level", run: levels },
        Entry { id: "X4", title: "elliptical footprints against brute force", run: ellipses },
        Entry { id: "X5", title: "numbers as they are stored", run: stored },
        Entry { id: "X11", title: "coordinates and footprints of any size", run: anywhere },
        Entry { id: "X12", title: "means of patterns", run: patterns },
    ]
}

fn at(u: f32, v: f32) -> TexturePoint {
    TexturePoint { uv: [u, v], ..TexturePoint::default() }
}

/// Values that grow along the columns and fall along the rows: between the centres of texels a lookup is exact.
fn ramp(case: &mut Case) {
    const SIZE: [u32; 2] = [37, 23];
    let ramp = image(SIZE[0], SIZE[1], 1, |x, y, _| (2 * x) as f32 + 3.0 * y as f32);
    let mut rng = Rng::new(1, 0);
    let tries = case.count(2_000, 200_000);
    for filter in [TextureFilter::Bilinear, TextureFilter::Mip, TextureFilter::Ewa] {
        let texture = texture(&ramp, ColorSpace::Raw, Wrap::Clamp, filter);
        let mut largest = 0.0_f64;
        for _ in 0..tries {
            let [a, b] = rng.next_2d();
            // Places between the centres of the first and the last texel.
            let place = [a * (SIZE[0] - 1) as f32, b * (SIZE[1] - 1) as f32];
            let uv = [(place[0] + 0.5) / SIZE[0] as f32, 1.0 - (place[1] + 0.5) / SIZE[1] as f32];
            let expected = 2.0 * f64::from(place[0]) + 3.0 * f64::from(place[1]);
            largest = largest.max((f64::from(texture.at(&at(uv[0], uv[1]))[0]) - expected).abs());
        }
        // Coordinates in single precision know a place to 37 times 2^-24.
        case.at_most(format!("{filter:?}, without a footprint: largest error"), largest, 3e-5);
    }
}

/// Footprints of many squares, anywhere: the mean over places is 1/2 with every filter.
fn checker(case: &mut Case) {
    let squares = image(16, 16, 1, |x, y, _| ((x + y) % 2) as f32);
    let places = case.count(4_000, 100_000);
    for filter in FILTERS {
        let texture = texture(&squares, ColorSpace::Raw, Wrap::Repeat, filter);
        let mut rng = Rng::new(2, 0);
        let mut values = Vec::new();
        for _ in 0..places {
            let [a, b] = rng.next_2d();
            let [turn, size] = rng.next_2d();
            let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
            let size = 1.0 + size;
            let axes = [[size * cos, size * sin], [-0.2 * size * sin, 0.2 * size * cos]];
            values.push(f64::from(texture.at(&TexturePoint { uv: [a, b], axes, ..TexturePoint::default() })[0]));
        }
        let (mean, error) = stats::mean_and_error(&values);
        // Filters that average have no noise left.
        case.mean(format!("{filter:?}"), (mean, error.max(1e-7)), 0.5, 0.02);
        if matches!(filter, TextureFilter::Mip | TextureFilter::Ewa) {
            let spread = values.iter().map(|v| (v - 0.5).abs()).fold(0.0, f64::max);
            case.at_most(format!("{filter:?}: largest error of one lookup"), spread, 0.01);
        }
    }
}

/// The mean over all texels of each level is the mean of the image, for sizes that are no powers of two.
fn levels(case: &mut Case) {
    for (width, height) in [(64, 64), (37, 23), (1, 19), (100, 3)] {
        let mut rng = Rng::new(3, 0);
        let numbers: Vec<f32> = (0..width * height).map(|_| rng.next_f32()).collect();
        let exact = numbers.iter().map(|v| f64::from(*v)).sum::<f64>() / numbers.len() as f64;
        let floats = image(width, height, 1, |x, y, _| numbers[(y * width + x) as usize]);
        let bytes: Vec<u8> = numbers.iter().map(|v| (v * 255.0).round() as u8).collect();
        let exact_of_bytes = bytes.iter().map(|v| f64::from(*v) / 255.0).sum::<f64>() / bytes.len() as f64;
        let bytes =
            Arc::new(TexelImage::new(width, height, 1, Texels::U8(bytes.into())).expect("an image of the test"));
        // Levels of bytes have 16 bits.
        for (image, exact, tolerance) in [(&floats, exact, 1e-6), (&bytes, exact_of_bytes, 1e-5)] {
            let texture = texture(image, ColorSpace::Raw, Wrap::Repeat, TextureFilter::Mip);
            let mut largest = 0.0_f64;
            let mut size = [width, height];
            let mut level = 0;
            while size != [1, 1] {
                size = size.map(|n| n.div_ceil(2));
                level += 1;
                // A footprint as wide as the texels of this level, at their centres.
                let wide = (1_u32 << level) as f32 / width as f32;
                let mut sum = 0.0;
                for y in 0..size[1] {
                    for x in 0..size[0] {
                        let uv = [(x as f32 + 0.5) / size[0] as f32, (y as f32 + 0.5) / size[1] as f32];
                        let axes = [[wide, 0.0], [0.0, 0.0]];
                        sum += f64::from(texture.at(&TexturePoint { uv, axes, ..TexturePoint::default() })[0]);
                    }
                }
                largest = largest.max((sum / f64::from(size[0] * size[1]) - exact).abs());
            }
            let format = image.texels().format();
            case.at_most(
                format!("{width} x {height}, {format:?}: largest error of a level's mean"),
                largest,
                tolerance,
            );
        }
    }
}

/// The mean over an ellipse, weighed by the Gaussian of the filter: by a sum over places of the bilinear texture, by the filter of
/// levels, and by texels that are drawn.
fn ellipses(case: &mut Case) {
    // A texture of several waves.
    let wave = image(64, 64, 1, |x, y, _| {
        let (x, y) = (x as f32 / 64.0, y as f32 / 64.0);
        let tau = std::f32::consts::TAU;
        0.5 + 0.25 * (tau * (3.0 * x + y)).sin() + 0.25 * (tau * (2.0 * y - x)).cos()
    });
    let of = |filter| texture(&wave, ColorSpace::Raw, Wrap::Repeat, filter);
    let [bilinear, ewa, stochastic] = [TextureFilter::Bilinear, TextureFilter::Ewa, TextureFilter::Stochastic].map(of);
    let mut rng = Rng::new(4, 0);
    let draws = case.count(20_000, 100_000);
    let mut p_values = Vec::new();
    let (mut largest, mut count) = (0.0_f64, 0);
    for (length, share) in [(0.05, 1.0), (0.1, 0.5), (0.2, 0.25), (0.3, 0.1)] {
        for turn in [0.1_f32, 0.9, 2.0] {
            let (sin, cos) = turn.sin_cos();
            let axes = [[length * cos, length * sin], [-share * length * sin, share * length * cos]];
            let [u, v] = rng.next_2d();
            // Half axes widened by the pixel of the texture, as the filters do.
            let wider = |l: f32| (l * l + 1.0 / (64.0 * 64.0)).sqrt() / l;
            let (a, b) = (axes[0].map(|x| x * wider(length)), axes[1].map(|x| x * wider(share * length)));
            let (mut sum, mut weights) = (0.0, 0.0);
            const N: i32 = 60;
            for i in -N..=N {
                for j in -N..=N {
                    let (s, t) = (i as f32 / N as f32, j as f32 / N as f32);
                    let r2 = s * s + t * t;
                    if r2 < 1.0 {
                        let weight = f64::from((-2.0 * r2).exp());
                        let there = at(u + s * a[0] + t * b[0], v + s * a[1] + t * b[1]);
                        sum += weight * f64::from(bilinear.at(&there)[0]);
                        weights += weight;
                    }
                }
            }
            let exact = sum / weights;
            let here = TexturePoint { uv: [u, v], axes, ..TexturePoint::default() };
            largest = largest.max((f64::from(ewa.at(&here)[0]) - exact).abs());
            // A draw is a function of the place: the places lie within a tenth of a texel.
            let values: Vec<f64> = (0..draws)
                .map(|_| {
                    let [s, t] = rng.next_2d();
                    let uv = [u + 2e-3 * (s - 0.5), v + 2e-3 * (t - 0.5)];
                    f64::from(stochastic.at(&TexturePoint { uv, axes, ..TexturePoint::default() })[0])
                })
                .collect();
            p_values.push(stats::t_test(stats::mean_and_error(&values), exact, draws as u32));
            count += 1;
        }
    }
    // Levels are means over squares, which blurs by a fraction of the footprint.
    case.at_most("filter of levels: largest error, of an amplitude of 0.5", largest, 0.02);
    let smallest = p_values.into_iter().fold(1.0, f64::min);
    case.p_value("drawn texels", smallest, count);
}

/// Every stored number is read as the value it stands for.
fn stored(case: &mut Case) {
    let srgb = |v: f64| if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    let read = |texels: Texels, count: u32, space: ColorSpace| {
        let image = Arc::new(TexelImage::new(count, 1, 1, texels).expect("an image of the test"));
        let texture = texture(&image, space, Wrap::Clamp, TextureFilter::Nearest);
        (0..count).map(|i| f64::from(texture.at(&at((i as f32 + 0.5) / count as f32, 0.5))[0])).collect::<Vec<_>>()
    };
    let worst = |got: &[f64], exact: &dyn Fn(usize) -> f64| {
        got.iter().enumerate().map(|(i, v)| (v - exact(i)).abs()).fold(0.0, f64::max)
    };
    let bytes = || Texels::U8((0..=255).collect());
    let shorts = || Texels::U16((0..=u16::MAX).step_by(16).collect());
    for (space, curve) in [(ColorSpace::Srgb, &srgb as &dyn Fn(f64) -> f64), (ColorSpace::Raw, &|v| v)] {
        let got = read(bytes(), 256, space);
        case.at_most(format!("8 bits, {space:?}"), worst(&got, &|i| curve(i as f64 / 255.0)), 1e-6);
        let got = read(shorts(), 4096, space);
        case.at_most(format!("16 bits, {space:?}"), worst(&got, &|i| curve(16.0 * i as f64 / 65535.0)), 1e-6);
    }
    let values = [0.0_f32, 1e-6, 0.25, 1.0, 3.5, 1e4];
    let got = read(Texels::F32(values.to_vec().into()), 6, ColorSpace::Linear);
    case.exact("single precision", worst(&got, &|i| values[i].into()), 0.0, Within::Absolute(0.0));
    // The mean of an sRGB image is that of its light, not of its numbers.
    let image = Arc::new(TexelImage::new(2, 1, 1, Texels::U8(vec![0, 255].into())).expect("an image of the test"));
    let mean = texture(&image, ColorSpace::Srgb, Wrap::Clamp, TextureFilter::Bilinear).at(&at(0.5, 0.5))[0];
    case.exact("between black and white, sRGB", mean.into(), 0.5, Within::Absolute(1e-6));
}

/// Whatever the coordinates and the footprint are, a lookup ends, and gives a number between the smallest and the largest texel.
fn anywhere(case: &mut Case) {
    let numbers = [0.0_f32, 1.0, -1.0, 0.3, 1e-30, 1e5, -1e9, 1e18, -1e30, f32::MAX, f32::INFINITY, f32::NAN];
    let long = image(512, 1, 2, |x, _, _| (x % 7) as f32 / 6.0);
    let small = image(3, 5, 2, |x, y, _| ((x + y) % 2) as f32);
    for filter in FILTERS {
        let (mut bad, mut tried) = (0, 0);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
            for texture in [&long, &small].map(|image| texture(image, ColorSpace::Raw, wrap, filter)) {
                for (i, u) in numbers.into_iter().enumerate() {
                    for (j, v) in numbers.into_iter().enumerate() {
                        let size = numbers[(i + 3 * j) % numbers.len()];
                        let axes = [[size, v], [0.2 * v, u]];
                        let [r, .., a] = texture.at(&TexturePoint { uv: [u, v], axes, ..TexturePoint::default() });
                        tried += 1;
                        bad += u64::from(![r, a].iter().all(|x| (-1e-5..=1.00001).contains(x)));
                    }
                }
            }
        }
        case.never(format!("{filter:?}: lookups without a value"), bad, tried);
    }
    let (mut bad, mut tried) = (0, 0);
    for pattern in PATTERNS {
        for in_space in [false, true] {
            let texture = Texture::procedural(Procedural { pattern, colors: [Rgb::ZERO, Rgb::ONE], in_space });
            for x in numbers {
                for y in numbers {
                    let p = etendue::math::Vec3::new(x, y, -x);
                    let [value, ..] = texture.at(&TexturePoint { uv: [x, y], p, ..TexturePoint::default() });
                    tried += 1;
                    bad += u64::from(!(0.0..=1.0).contains(&value));
                }
            }
        }
    }
    case.never("patterns: lookups without a value", bad, tried);
}

const PATTERNS: [Pattern; 7] = [
    Pattern::Checker,
    Pattern::Grid { width: 0.1 },
    Pattern::Gradient,
    Pattern::Noise { octaves: 16, turbulent: false },
    Pattern::Noise { octaves: 3, turbulent: true },
    Pattern::Marble { octaves: 4, turbulence: 1.0 },
    Pattern::Wood { octaves: 4, turbulence: 0.2 },
];

/// The mean that a pattern states is that of points drawn over many periods.
fn patterns(case: &mut Case) {
    let points = case.count(20_000, 1_000_000);
    for pattern in PATTERNS {
        for in_space in [false, true] {
            let texture = Texture::procedural(Procedural { pattern, colors: [Rgb::ZERO, Rgb::ONE], in_space });
            let mut rng = Rng::new(12, 0);
            let periods = if pattern == Pattern::Gradient { 1.0 } else { 64.0 };
            let values: Vec<f64> = (0..points)
                .map(|_| {
                    let [x, y, z, _] = rng.next_4d().map(|x| periods * x);
                    let p = etendue::math::Vec3::new(x, y, z);
                    f64::from(texture.at(&TexturePoint { uv: [x, y], p, ..TexturePoint::default() })[0])
                })
                .collect();
            let [stated, ..] = texture.mean().map(f64::from);
            let what = format!("{pattern:?}, {}", if in_space { "in space" } else { "on surfaces" });
            // Means without a closed form are those of 4096 points of an even sequence.
            case.biased_mean(what, stats::mean_and_error(&values), stated, (0.02, 0.02));
        }
    }
}
