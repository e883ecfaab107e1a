//! Textures from formulas.

use super::noise::{octaves, perlin};
use super::{Texel, TexturePoint};
use crate::math::DVec3;
use crate::spectrum::Rgb;

/// How a formula mixes two colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// Squares (cubes in space) of side 1, in turns.
    Checker,
    /// Lines of the second colour along the edges of squares of side 1.
    Grid {
        /// Width of the lines, in (0, 1).
        width: f32,
    },
    /// From the first colour at 0 to the second at 1 along the first coordinate, and on as it is beyond.
    Gradient,
    /// Perlin's noise, summed over octaves.
    Noise {
        /// Number of octaves, 1 to 16.
        octaves: u32,
        /// Whether magnitudes are summed (turbulence) instead of the noise itself (fractional Brownian motion).
        turbulent: bool,
    },
    /// Veins across the first coordinate, turned by turbulence (Perlin 1985).
    Marble {
        /// Number of octaves, 1 to 16.
        octaves: u32,
        /// How far the veins are turned, in periods.
        turbulence: f32,
    },
    /// Rings around the second axis of space (around the origin of texture coordinates), turned by noise.
    Wood {
        /// Number of octaves, 1 to 16.
        octaves: u32,
        /// How far rings are turned, in rings.
        turbulence: f32,
    },
}

/// A pattern of two colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Procedural {
    /// How the colours are mixed.
    pub pattern: Pattern,
    /// The colours.
    pub colors: [Rgb; 2],
    /// Whether the pattern lies in space instead of on the surface.
    pub in_space: bool,
}

impl Procedural {
    /// The share of the second colour.
    fn share(&self, at: DVec3) -> f64 {
        match self.pattern {
            Pattern::Checker => {
                let squares = if self.in_space { at.floor().element_sum() } else { at.x.floor() + at.y.floor() };
                squares.rem_euclid(2.0)
            }
            Pattern::Grid { width } => {
                // Lines lie half on either side of the edges.
                let edge = |x: f64| {
                    let x = x - x.floor();
                    x.min(1.0 - x) < 0.5 * f64::from(width)
                };
                let on_line = edge(at.x) || edge(at.y) || self.in_space && edge(at.z);
                f64::from(u8::from(on_line))
            }
            Pattern::Gradient => at.x.clamp(0.0, 1.0),
            Pattern::Noise { octaves: count, turbulent: false } => 0.5 + 0.5 * octaves(at, count, |n| n),
            Pattern::Noise { octaves: count, turbulent: true } => octaves(at, count, f64::abs),
            Pattern::Marble { octaves: count, turbulence } => {
                let turned = f64::from(turbulence) * octaves(at, count, f64::abs);
                0.5 + 0.5 * (std::f64::consts::TAU * (at.x + turned)).sin()
            }
            Pattern::Wood { octaves: count, turbulence } => {
                let turned = f64::from(turbulence) * octaves(at, count, |n| n);
                let radius = if self.in_space { at.x.hypot(at.z) } else { at.x.hypot(at.y) };
                // A ring grows fast in spring and ends in a thin dark line.
                let ring = radius + turned + 0.02 * perlin(at * 20.0);
                let ring = ring - ring.floor();
                ring * ring * (2.0 - ring)
            }
        }
        .clamp(0.0, 1.0)
    }

    pub(super) fn at(&self, at: &TexturePoint) -> Texel {
        let place = if self.in_space { at.p.as_dvec3() } else { DVec3::new(at.uv[0].into(), at.uv[1].into(), 0.0) };
        self.mixed(if place.is_finite() { self.share(place) as f32 } else { 0.0 })
    }

    fn mixed(&self, share: f32) -> Texel {
        let [a, b] = self.colors;
        let [r, g, b] = (a + (b - a) * share).to_array();
        [r, g, b, 1.0]
    }

    /// The mean over many periods.
    pub(super) fn mean(&self) -> Texel {
        let share = match self.pattern {
            Pattern::Checker | Pattern::Gradient => 0.5,
            Pattern::Grid { width } => {
                let free = 1.0 - f64::from(width);
                1.0 - if self.in_space { free.powi(3) } else { free.powi(2) }
            }
            Pattern::Noise { .. } | Pattern::Marble { .. } | Pattern::Wood { .. } => {
                /// Points of a sequence that fills a cube evenly (Roberts 2018), and the length of its edge.
                const POINTS: u32 = 4096;
                const EDGE: f64 = 16.0;
                let plastic = 1.220_744_084_605_759_5_f64;
                let steps = DVec3::new(plastic.powi(-1), plastic.powi(-2), plastic.powi(-3));
                let place = |i: u32| {
                    let p = (f64::from(i) + 0.5) * steps;
                    let p = EDGE * (p - p.floor());
                    if self.in_space { p } else { p.with_z(0.0) }
                };
                (0..POINTS).map(|i| self.share(place(i))).sum::<f64>() / f64::from(POINTS)
            }
        };
        self.mixed(share as f32)
    }

    pub(super) fn range(&self) -> [Texel; 2] {
        let [a, b] = self.colors.map(|color| color.to_array());
        [[a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2]), 1.0], [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2]), 1.0]]
    }
}
