//! Differences between two images.

use serde::Serialize;

use crate::film::Image;
use crate::{Error, ErrorKind, Result};

/// Added to the squared reference in [`Metrics::rel_mse`]: 0.01, so that values below about 0.1 count by their absolute
/// error, and black pixels do not divide by zero. The constant of the image viewer tev.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// Differences between an image a and a reference b, from [`compare`].
///
/// Sums run in double precision over the pixels whose channels are all finite in both images; where there is none, the
/// means are NaN. Serialised to JSON, values that are not finite become `null`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Mean of (a - b)^2 over pixels and channels.
    pub mse: f64,
    /// Mean of (a - b)^2 / (b^2 + [`REL_MSE_EPSILON`]) over pixels and channels.
    pub rel_mse: f64,
    /// The same with 1 % of the squared mean of b, over all its values, in place of [`REL_MSE_EPSILON`]: the relMSE that renders
    /// estimate and benchmarks measure, which does not depend on how bright the image is.
    pub rel_mse_to_mean: f64,
    /// Peak signal-to-noise ratio 10 log10(peak^2 / mse) in decibels, where peak is the largest value of the reference;
    /// infinite for equal images. NaN where the reference has no value above zero.
    pub psnr: f64,
    /// Largest |a - b| of any channel.
    pub max_abs_difference: f64,
    /// Column and row of the first pixel that has it; row 0 on top.
    pub max_at: [u32; 2],
    /// Mean of each channel of a.
    pub mean_a: [f64; 3],
    /// Mean of each channel of b.
    pub mean_b: [f64; 3],
    /// `mean_a / mean_b` per channel: 1 for an unbiased estimate, up to noise.
    pub ratio: [f64; 3],
    /// Pixels left out of everything above because a channel is infinite or NaN in either image.
    pub non_finite: u64,
}

/// Compares `a` with the reference `b`; layers are ignored.
///
/// Errors: [`ErrorKind::InvalidScene`] when the sizes differ, [`ErrorKind::Unsupported`] for images without pixels,
/// [`ErrorKind::Internal`] when an image's slices do not fit its size.
pub fn compare(a: &Image, b: &Image) -> Result<Metrics> {
    if (a.width, a.height) != (b.width, b.height) {
        let message = format!(
            "images of different size cannot be compared: {} x {} and {} x {} pixels",
            a.width, a.height, b.width, b.height
        );
        return Err(Error::new(ErrorKind::InvalidScene, message));
    }
    for image in [a, b] {
        super::check_image(image)?;
    }

    let mut counted = 0_u64;
    let mut non_finite = 0_u64;
    let (mut squares, mut relative) = (0.0_f64, 0.0_f64);
    let (mut sum_a, mut sum_b) = ([0.0_f64; 3], [0.0_f64; 3]);
    let (mut max, mut max_index, mut peak) = (0.0_f64, 0_usize, 0.0_f64);
    for (index, (a, b)) in a.rgb.chunks_exact(3).zip(b.rgb.chunks_exact(3)).enumerate() {
        if a.iter().chain(b).any(|value| !value.is_finite()) {
            non_finite += 1;
            continue;
        }
        counted += 1;
        for channel in 0..3 {
            let (a, b) = (f64::from(a[channel]), f64::from(b[channel]));
            let difference = a - b;
            squares += difference * difference;
            relative += difference * difference / (b * b + REL_MSE_EPSILON);
            sum_a[channel] += a;
            sum_b[channel] += b;
            peak = peak.max(b);
            if difference.abs() > max {
                (max, max_index) = (difference.abs(), index);
            }
        }
    }

    let pixels = counted as f64;
    let values = 3.0 * pixels;
    let mse = squares / values;
    let (mean_a, mean_b) = (sum_a.map(|sum| sum / pixels), sum_b.map(|sum| sum / pixels));
    let mean = mean_b.iter().sum::<f64>() / 3.0;
    let floor = 1e-2 * mean * mean;
    let pairs = a.rgb.chunks_exact(3).zip(b.rgb.chunks_exact(3));
    let finite = pairs.filter(|(a, b)| a.iter().chain(*b).all(|value| value.is_finite()));
    let to_mean: f64 = finite
        .flat_map(|(a, b)| a.iter().zip(b))
        .map(|(&a, &b)| (f64::from(a), f64::from(b)))
        // The images are equal where both are black.
        .map(|(a, b)| if a == b { 0.0 } else { (a - b) * (a - b) / (b * b + floor) })
        .sum();
    let width = a.width as usize;
    Ok(Metrics {
        mse,
        rel_mse: relative / values,
        rel_mse_to_mean: to_mean / values,
        psnr: if peak > 0.0 { 10.0 * (peak * peak / mse).log10() } else { f64::NAN },
        max_abs_difference: if counted > 0 { max } else { f64::NAN },
        max_at: [(max_index % width) as u32, (max_index / width) as u32],
        mean_a,
        mean_b,
        ratio: std::array::from_fn(|channel| mean_a[channel] / mean_b[channel]),
        non_finite,
    })
}
