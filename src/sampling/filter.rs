//! Pixel filters and how to sample them.
//!
//! A filter is importance sampled, not splatted: the camera ray leaves through the pixel's centre plus a sampled
//! offset, and the pixel's value is the mean of radiance times weight. Pixels then share no samples, so their errors
//! are independent.
//!
//! Source: Ernst, Stamminger, Greiner 2006, "Filter Importance Sampling".

use std::f64::consts::PI;

use crate::desc::FilterDesc;

/// A separable pixel filter, normalised so that its integral over the plane is 1. Lengths in pixels.
#[derive(Clone, Debug)]
pub struct Filter {
    kernel: Kernel,
    radius: f32,
    /// One over the integral along one axis.
    scale: f64,
    /// The table of a kernel that has no closed-form sampling.
    table: Option<Table>,
}

/// The filter along one axis, before normalisation.
#[derive(Clone, Copy, Debug)]
enum Kernel {
    Box,
    Tent,
    Gaussian { sigma: f64 },
    BlackmanHarris,
    Mitchell { b: f64, c: f64 },
}

impl Kernel {
    fn radius(&self) -> f64 {
        match *self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian { sigma } => 3.0 * sigma,
            Self::BlackmanHarris | Self::Mitchell { .. } => 2.0,
        }
    }

    fn at(&self, x: f64) -> f64 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - x,
            Self::Gaussian { sigma } => (-0.5 * (x / sigma) * (x / sigma)).exp(),
            // Harris 1978, "On the Use of Windows for Harmonic Analysis", minimum 4-term.
            Self::BlackmanHarris => {
                let t = PI * x / 2.0;
                0.35875 + 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() + 0.01168 * (3.0 * t).cos()
            }
            // Mitchell and Netravali 1988, "Reconstruction Filters in Computer Graphics", Eq. 8.
            Self::Mitchell { b, c } => {
                if x < 1.0 {
                    ((12.0 - 9.0 * b - 6.0 * c) * x * x * x + (-18.0 + 12.0 * b + 6.0 * c) * x * x + (6.0 - 2.0 * b))
                        / 6.0
                } else {
                    ((-b - 6.0 * c) * x * x * x
                        + (6.0 * b + 30.0 * c) * x * x
                        + (-12.0 * b - 48.0 * c) * x
                        + (8.0 * b + 24.0 * c))
                        / 6.0
                }
            }
        }
    }
}

impl Filter {
    /// The filter of a checked description.
    pub fn new(desc: &FilterDesc) -> Self {
        let kernel = match *desc {
            FilterDesc::Box => Kernel::Box,
            FilterDesc::Tent => Kernel::Tent,
            FilterDesc::Gaussian { sigma } => Kernel::Gaussian { sigma: f64::from(sigma) },
            FilterDesc::BlackmanHarris => Kernel::BlackmanHarris,
            FilterDesc::Mitchell { b, c } => Kernel::Mitchell { b: f64::from(b), c: f64::from(c) },
        };
        let (table, scale) = match kernel {
            Kernel::Box | Kernel::Tent => (None, 1.0),
            _ => {
                let table = Table::new(&kernel);
                let scale = 1.0 / table.integral;
                (Some(table), scale)
            }
        };
        Self { kernel, radius: kernel.radius() as f32, scale, table }
    }

    /// Half the width of the square outside which the filter is 0.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Its value at an offset from the pixel's centre (pixel^-2).
    pub fn evaluate(&self, x: f32, y: f32) -> f32 {
        (self.kernel.at(f64::from(x)) * self.kernel.at(f64::from(y)) * self.scale * self.scale) as f32
    }

    /// An offset from the pixel's centre and its weight, for `u` in [0, 1)^2.
    ///
    /// The weight is exactly 1 where the filter is nowhere negative. Negative lobes are sampled by their magnitude and
    /// have a negative constant weight; the mean weight is 1. Box and tent are inverted exactly, the others through a
    /// table of 1024 linear pieces, whose density is off by about 1e-5 of its greatest value.
    ///
    /// The box passes a `u` outside the unit square through, so that a position pattern wider than the pixel keeps its
    /// shape; the others clamp it.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let ((x, wx), (y, wy)) = (self.sample_1d(u[0]), self.sample_1d(u[1]));
        ([x, y], wx * wy)
    }

    #[inline]
    fn sample_1d(&self, u: f32) -> (f32, f32) {
        match (&self.table, self.kernel) {
            (Some(table), _) => table.sample(f64::from(u)),
            (None, Kernel::Tent) => {
                let u = u.clamp(0.0, 1.0);
                (if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }, 1.0)
            }
            (None, _) => (u - 0.5, 1.0),
        }
    }
}

/// A density in linear pieces between nodes, of the magnitude of a kernel; its sign changes at nodes only.
#[derive(Clone, Debug)]
struct Table {
    x: Vec<f64>,
    /// Signed kernel at the nodes.
    f: Vec<f64>,
    /// Integral of the magnitude up to each node, last 1.
    cdf: Vec<f64>,
    /// Weight of a sample in a positive piece: integral of the magnitude over the signed one.
    weight: f32,
    /// Signed integral.
    integral: f64,
}

/// Pieces of a table.
const TABLE_PIECES: usize = 1024;

impl Table {
    fn new(kernel: &Kernel) -> Self {
        let radius = kernel.radius();
        let (mut x, mut f) = (Vec::with_capacity(TABLE_PIECES + 8), Vec::with_capacity(TABLE_PIECES + 8));
        for i in 0..=TABLE_PIECES {
            let node = radius * (2.0 * i as f64 / TABLE_PIECES as f64 - 1.0);
            let value = kernel.at(node);
            if let (Some(&last_x), Some(&last_f)) = (x.last(), f.last())
                && value * last_f < 0.0
            {
                x.push(root(kernel, last_x, node));
                f.push(0.0);
            }
            x.push(node);
            f.push(value);
        }
        let (mut cdf, mut magnitude, mut integral) = (vec![0.0], 0.0, 0.0);
        for (x, f) in x.windows(2).zip(f.windows(2)) {
            let area = 0.5 * (f[0] + f[1]) * (x[1] - x[0]);
            magnitude += area.abs();
            integral += area;
            cdf.push(magnitude);
        }
        cdf.iter_mut().for_each(|c| *c /= magnitude);
        Self { x, f, cdf, weight: (magnitude / integral) as f32, integral }
    }

    #[inline]
    fn sample(&self, u: f64) -> (f32, f32) {
        let u = u.clamp(0.0, 1.0 - f64::EPSILON);
        // The piece that u falls into; the first cdf entry is 0 and the last 1, so both neighbours exist.
        let i = self.cdf.partition_point(|&c| c <= u).clamp(1, self.cdf.len() - 1) - 1;
        let fraction = (u - self.cdf[i]) / (self.cdf[i + 1] - self.cdf[i]);
        let (f0, f1) = (self.f[i].abs(), self.f[i + 1].abs());
        // Solves f0 t + (f1 - f0) t^2 / 2 = share (f0 + f1) / 2 for t in [0, 1], in the form that does not cancel.
        let mass = fraction * (f0 + f1);
        let denominator = f0 + (f0 * f0 + (f1 - f0) * mass).max(0.0).sqrt();
        let t = if denominator > 0.0 { mass / denominator } else { 0.0 };
        let x = self.x[i] + (self.x[i + 1] - self.x[i]) * t.clamp(0.0, 1.0);
        let positive = self.f[i] + self.f[i + 1] >= 0.0;
        (x as f32, if positive { self.weight } else { -self.weight })
    }
}

/// The root of `kernel` between two points at which its sign differs, by bisection.
fn root(kernel: &Kernel, mut low: f64, mut high: f64) -> f64 {
    let rises = kernel.at(high) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (kernel.at(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
