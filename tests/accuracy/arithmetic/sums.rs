//! Long sums of a pixel.

use etendue::film::Pixel;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;

use crate::record::{Case, Entry, Within};
use crate::stats::mean_and_error;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "P53", title: "Long sums", run: sums },
        Entry { id: "P53c", title: "Errors of long sums", run: errors },
    ]
}

/// A pixel of these samples, 2^16 at a time to each replicate.
fn pixel(samples: impl IntoIterator<Item = f32>) -> Pixel {
    let mut pixel = Pixel::default();
    samples.into_iter().for_each(|value| pixel.add(Rgb::splat(value), 1.0, 1 << 16));
    pixel
}

fn mean(pixel: &Pixel) -> f64 {
    f64::from(pixel.mean(false)[0])
}

fn sums(case: &mut Case) {
    // In single precision 2^24 + 1 is 2^24.
    case.exact("2^25 samples of 1", mean(&pixel((0..1 << 25).map(|_| 1.0))), 1.0, Within::Absolute(1e-6));
    let tenths = mean(&pixel((0..10_000_000).map(|_| 0.1)));
    case.exact("10^7 samples of 0.1", tenths, f64::from(0.1_f32), Within::Ulps(0.5));
    let exact = 1e4 + 1e6 * f64::from(1e-4_f32);
    for (order, first) in [("before", true), ("after", false)] {
        let one = std::iter::once(1e4).filter(move |_| first);
        let other = std::iter::once(1e4).filter(move |_| !first);
        let found = mean(&pixel(one.chain((0..1_000_000).map(|_| 1e-4)).chain(other)));
        case.exact(format!("one of 10^4 {order} 10^6 of 10^-4"), found, exact / 1_000_001.0, Within::Ulps(0.5));
    }
    // Values over sixteen powers of ten, in multiples of 2^-70, of which 128 bits hold 2^24 exactly.
    let count = case.count(1_000_000, 10_000_000);
    let mut rng = Rng::new(53, 0);
    let values: Vec<f32> = (0..count).map(|_| 10_f32.powf(16.0 * rng.next_f32() - 10.0)).collect();
    let exact: i128 = values.iter().map(|value| (f64::from(*value) * 70_f64.exp2()) as i128).sum();
    let exact = exact as f64 / 70_f64.exp2() / count as f64;
    case.exact("samples from 10^-10 to 10^6", mean(&pixel(values)), exact, Within::Ulps(0.5));
    // Radiance near both ends of single precision.
    case.exact(
        "10^6 samples of 10^38",
        mean(&pixel((0..1_000_000).map(|_| 1e38))),
        f64::from(1e38_f32),
        Within::Ulps(0.5),
    );
    let least = f32::from_bits(1);
    case.exact(
        "10^6 samples of the least number above 0, in it",
        mean(&pixel((0..1_000_000).map(|_| least))) / f64::from(least),
        1.0,
        Within::Absolute(0.0),
    );

    let mut pixel = Pixel::default();
    let bad = [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0, 0.0, f32::NEG_INFINITY]];
    for radiance in bad.into_iter().cycle().take(3000) {
        pixel.add(Rgb::from_array(radiance), 1.0, 16);
        pixel.add(Rgb::ONE, 1.0, 16);
    }
    case.exact(
        "NaN and infinite samples counted, of 3000",
        f64::from(pixel.non_finite()),
        3000.0,
        Within::Absolute(0.0),
    );
    let finite = pixel.mean(false).iter().chain(&pixel.variance(16).map(|v| v as f32)).all(|value| value.is_finite());
    case.holds("mean and variance beside them", "finite", if finite { "finite" } else { "not" }, finite);
}

fn errors(case: &mut Case) {
    // The variance of a mean is of small differences of large sums: of replicates that are 1 but for so much. Where the
    // scatter is hardly more than the rounding of a sample, two digits are left.
    for (scatter, tolerance) in [(1e-2, 1e-6), (1e-4, 1e-4), (1e-6, 1e-2)] {
        let mut rng = Rng::new(54, 0);
        let mut pixel = Pixel::default();
        let mut means = Vec::new();
        for _ in 0..64 {
            // What single precision makes of it is the exact value.
            let value = (1.0 + scatter * (f64::from(rng.next_f32()) - 0.5)) as f32;
            (0..1 << 10).for_each(|_| pixel.add(Rgb::splat(value), 1.0, 1 << 10));
            means.push(f64::from(value));
        }
        // Of eight that take turns.
        let replicate = |r: usize| means.iter().skip(r).step_by(8).sum::<f64>() / 8.0;
        let (_, error) = mean_and_error(&(0..8).map(replicate).collect::<Vec<_>>());
        case.exact(
            format!("error, replicates off by {scatter:e}"),
            pixel.variance(1 << 10)[0].sqrt(),
            error,
            Within::Relative(tolerance),
        );
    }
    // Light that is 10^20 times as strong has an error that is too.
    for power in [-66, 66] {
        let mut rng = Rng::new(55, 0);
        let mut plain = Pixel::default();
        let mut scaled = Pixel::default();
        for _ in 0..1024 {
            let value = rng.next_f32();
            plain.add(Rgb::splat(value), 1.0, 64);
            scaled.add(Rgb::splat(value * (power as f32).exp2()), 1.0, 64);
        }
        let ratio = (scaled.variance(64)[0] / plain.variance(64)[0]).sqrt().log2();
        case.exact(format!("error, light times 2^{power}: power of 2"), ratio, f64::from(power), Within::Absolute(0.0));
    }
}
