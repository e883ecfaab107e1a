//! Errors of images against a reference, and the part of them that is noise.

use etendue::film::Image;

use super::reference::Reference;

/// Mean over pixels and channels of (x - r)^2 / (r^2 + e) against a reference r, e = 1 % of its squared mean. The
/// weights are stored, since they apply to every run.
pub struct RelMseScale {
    /// 1 / (r^2 + e) / number of values.
    weights: Vec<f64>,
    /// The contribution of the reference's own noise. It is independent of the measured image, so it adds to the error
    /// and is subtracted.
    pub noise: f64,
}

impl RelMseScale {
    /// The weights for this reference.
    pub fn new(reference: &Reference) -> Self {
        let values = &reference.image.rgb;
        let count = values.len() as f64;
        let mean = values.iter().map(|&value| f64::from(value)).sum::<f64>() / count;
        let floor = 0.01 * mean * mean;
        let weight = |value: &f32| 1.0 / (f64::from(*value) * f64::from(*value) + floor) / count;
        let weights: Vec<_> = values.iter().map(weight).collect();
        let variance = reference.variance.iter().flatten();
        let noise = variance.zip(&weights).map(|(&variance, weight)| f64::from(variance) * weight).sum();
        Self { weights, noise }
    }

    /// relMSE of an image, minus the noise of the reference.
    pub fn rel_mse(&self, image: &Image, reference: &Reference) -> f64 {
        self.errors(image, reference).sum::<f64>() - self.noise
    }

    /// The error of each pixel, whose mean is relMSE including the reference's noise.
    pub fn map(&self, image: &Image, reference: &Reference) -> Vec<f32> {
        let errors: Vec<_> = self.errors(image, reference).collect();
        let pixels = errors.len() / 3;
        errors.chunks_exact(3).map(|pixel| (pixel.iter().sum::<f64>() * pixels as f64) as f32).collect()
    }

    fn errors<'a>(&'a self, image: &'a Image, reference: &'a Reference) -> impl Iterator<Item = f64> + 'a {
        image.rgb.iter().zip(&reference.image.rgb).zip(&self.weights).map(|((&x, &r), weight)| {
            let difference = f64::from(x) - f64::from(r);
            difference * difference * weight
        })
    }
}

/// Statistics over several runs of one case: the mean of each value, and the scatter about it (Welford's sums).
#[derive(Default)]
pub struct Scatter {
    runs: u32,
    mean: Vec<f32>,
    squares: Vec<f32>,
}

impl Scatter {
    /// Adds a run.
    pub fn add(&mut self, image: &Image) {
        self.mean.resize(image.rgb.len(), 0.0);
        self.squares.resize(image.rgb.len(), 0.0);
        self.runs += 1;
        let share = 1.0 / self.runs as f32;
        for ((&x, mean), squares) in image.rgb.iter().zip(&mut self.mean).zip(&mut self.squares) {
            let before = x - *mean;
            *mean += share * before;
            *squares += before * (x - *mean);
        }
    }

    /// The part of one run's relMSE that is noise, from the scatter of the runs; `None` for a single run.
    pub fn noise(&self, scale: &RelMseScale) -> Option<f64> {
        let sum = self.squares.iter().zip(&scale.weights).map(|(&squares, weight)| f64::from(squares) * weight);
        (self.runs > 1).then(|| sum.sum::<f64>() / f64::from(self.runs - 1))
    }

    /// Below this value, a squared bias cannot be distinguished from noise: three standard errors of the squared bias,
    /// as if pixels were normal and independent, and a fifth of the noise of the reference, whose size is itself an
    /// estimate.
    pub fn bias_resolution(&self, noise: f64, scale: &RelMseScale) -> f64 {
        let (runs, values) = (f64::from(self.runs), self.mean.len() as f64);
        3.0 * noise * (2.0 / (values * runs * (runs - 1.0).max(1.0))).sqrt() + 0.2 * scale.noise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(rgb: Vec<f32>) -> Image {
        Image { width: 2, height: 1, rgb, ..Image::default() }
    }

    #[test]
    fn noise_and_bias_add_up_to_the_error() {
        let reference = Reference { image: image(vec![1.0; 6]), variance: Some(vec![0.01; 6]), ..Reference::default() };
        let scale = RelMseScale::new(&reference);
        // Weights are 1 / 1.01; two runs 1.3 and 1.1: errors 0.09 and 0.01, noise 0.02, squared bias 0.04 - 0.01.
        let runs = [image(vec![1.3; 6]), image(vec![1.1; 6])];
        let mut scatter = Scatter::default();
        runs.iter().for_each(|run| scatter.add(run));
        let close = |a: f64, b: f64| assert!((a - b / 1.01).abs() < 1e-6, "{a} is not {b} / 1.01");
        close(scale.noise, 0.01);
        close(scale.rel_mse(&runs[0], &reference), 0.08);
        close(scatter.noise(&scale).unwrap(), 0.02);
        let map = scale.map(&runs[0], &reference);
        assert_eq!(map.len(), 2);
        close(f64::from(map[0]), 0.09);
    }
}
