//! Triangles whose radiance a texture varies.

use std::sync::Arc;

use super::textured_radiance::{CONTRAST, TexturedRadiance, UNIFORM_SHARE, VAIN_SHARE};
use super::{Departure, EmitterSample, TriangleEmitter};
use crate::math::{DVec3, Vec3};
use crate::sampling::Distribution1D;
use crate::shape::{Triangle, centroids};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb, luminance};
use crate::texture::{Texture, TextureLight, TexturePoint};

/// What the texture of an emitter reads at the corners of its triangle: texture coordinates, or points of the pattern's space.
#[derive(Clone, Copy, Debug)]
pub enum TextureCorners {
    /// Texture coordinates, after all mappings.
    Uv([[f32; 2]; 3]),
    /// Points in the space of a pattern.
    Space([Vec3; 3]),
}

/// Equal parts of a triangle, of which one is chosen by its share of the light.
#[derive(Clone, Debug)]
struct Pieces {
    /// Parts along a side.
    count: usize,
    /// Two for each square of the grid over both sides: the upright one, and the one on its tip.
    shapes: Box<[Option<TriangleEmitter>]>,
    choice: Distribution1D,
}

/// A triangle that emits the same radiance in all directions of its normal's side, but not at all of its points.
///
/// Where the texture varies much over the triangle, a light sample (or a photon) first chooses a part of the triangle by its share of the
/// light, then a point of this part; otherwise any point.
#[derive(Clone, Debug)]
pub struct TexturedTriangle {
    /// Shape, and the mean of the radiance.
    pub mean: TriangleEmitter,
    pieces: Option<Pieces>,
    radiance: TexturedRadiance,
    corners: TextureCorners,
}

/// Most points of the rule for the mean, along a side. Where a triangle has more texels, means over squares of them are read.
const MOST_STEPS: f32 = 16.0;

/// A triangle of fewer texels along its longest side has no parts.
const LEAST_TEXELS: f32 = 3.0;

/// About how many parts along a side there are at least, and how many at most.
const FEW_PIECES: f32 = 8.0;
const MOST_PIECES: f32 = 32.0;

impl TexturedTriangle {
    /// An emitter; `error` is the bound of [`crate::math::HitPoint`] for points on it. It has parts where they pay, which are taken
    /// from `left`, the number that there is room for.
    pub fn new(
        triangle: Triangle,
        error: f32,
        radiance: TexturedRadiance,
        light: &TextureLight,
        corners: TextureCorners,
        left: &mut usize,
    ) -> Self {
        let mean = TriangleEmitter::new(triangle, Rgb::ZERO, error);
        let mut emitter = Self { mean, pieces: None, radiance, corners };
        let brightest = emitter.brightest(light);
        if brightest == Rgb::ZERO {
            return emitter;
        }
        emitter.mean.radiance = TexturedRadiance::by_choice(emitter.mean_radiance(light), brightest);
        if f64::from(luminance(brightest)) >= CONTRAST * f64::from(luminance(emitter.mean.radiance)) {
            emitter.divide(error, light, left);
        }
        emitter
    }

    /// The brightest radiance, or of squares of texels the mean; black only where the triangle emits nothing at all.
    fn brightest(&self, light: &TextureLight) -> Rgb {
        let within = match &self.corners {
            TextureCorners::Uv(corners) => {
                let bound =
                    |pick: fn(f32, f32) -> f32| [0, 1].map(|i: usize| corners.map(|uv| uv[i]).into_iter().reduce(pick));
                Some([bound(f32::min), bound(f32::max)].map(|uv| uv.map(|x| x.unwrap_or(f32::NAN))))
            }
            TextureCorners::Space(_) => None,
        };
        self.radiance.brightest(within, light)
    }

    /// Divides the triangle into parts, where they pay.
    fn divide(&mut self, error: f32, light: &TextureLight, left: &mut usize) {
        let texels = self.texels();
        if texels < LEAST_TEXELS {
            return;
        }
        // Of a few texels, several parts each, so that edges of parts are edges of texels.
        let along = self.texels_along().ceil().clamp(1.0, MOST_PIECES);
        let count = (along * (FEW_PIECES / along).round().max(1.0)) as usize;
        if 2 * count * count > *left {
            return;
        }
        // The points of the rule for a part, four along its side, read squares that touch.
        let level = light.level_of(0.5 * texels / count as f32);
        let step = 1.0 / count as f32;
        let (mut shapes, mut weights) = (Vec::with_capacity(2 * count * count), Vec::with_capacity(2 * count * count));
        for place in 0..2 * count * count {
            let (square, is_tip) = (place / 2, place % 2 == 1);
            let [i, j] = [(square / count) as f32, (square % count) as f32].map(|k| k * step);
            let corners = if is_tip {
                [[i + step, j], [i + step, j + step], [i, j + step]]
            } else {
                [[i, j], [i + step, j], [i, j + step]]
            };
            let is_inside = square / count + square % count + usize::from(is_tip) < count;
            let shape = is_inside
                .then(|| Triangle::new(corners.map(|[s, t]| self.mean.triangle.at(s, t))))
                .flatten()
                .map(|triangle| TriangleEmitter::new(triangle, Rgb::ZERO, error));
            weights.push(if shape.is_some() { self.mean_over(&corners, light, level) } else { 0.0 });
            shapes.push(shape);
        }
        let inside = shapes.iter().flatten().count() as f64;
        let (sum, most) = (weights.iter().sum::<f64>(), weights.iter().copied().fold(0.0, f64::max));
        if most * inside < CONTRAST * sum || sum <= 0.0 {
            *left -= (2 * count * count).div_ceil(VAIN_SHARE);
            return;
        }
        for (weight, shape) in weights.iter_mut().zip(&shapes) {
            let uniform = if shape.is_some() { sum / inside } else { 0.0 };
            *weight = (1.0 - UNIFORM_SHARE) * *weight + UNIFORM_SHARE * uniform;
        }
        *left -= 2 * count * count;
        self.pieces = Distribution1D::new(&weights).map(|choice| Pieces { count, shapes: shapes.into(), choice });
    }

    /// The luminance of the mean over a part, of which the corners are given by their weights.
    fn mean_over(&self, corners: &[[f32; 2]; 3], light: &TextureLight, level: usize) -> f64 {
        const STEPS: u32 = 4;
        let mut sum = DVec3::ZERO;
        for [a, b] in centroids(STEPS) {
            let [s, t] = [0, 1].map(|c: usize| (1.0 - a - b) * corners[0][c] + a * corners[1][c] + b * corners[2][c]);
            sum += self.near([1.0 - s - t, s, t], light, level).to_f64();
        }
        sum.dot(LUMINANCE_WEIGHTS.to_f64()) / f64::from(STEPS * STEPS)
    }

    /// The part of the triangle that a point is on, with the probability of its choice.
    fn piece_at<'p>(&self, pieces: &'p Pieces, p: Vec3) -> Option<(&'p TriangleEmitter, f32)> {
        let [_, s, t] = self.weights(p)?;
        let count = pieces.count as f32;
        let last = pieces.count - 1;
        let [i, j] = [s, t].map(|x| ((x * count).max(0.0) as usize).min(last));
        let is_tip = s * count - i as f32 + (t * count - j as f32) > 1.0;
        let square = i * pieces.count + j;
        let mut place = 2 * square + usize::from(is_tip);
        if pieces.shapes[place].is_none() {
            // Rounded over the long side.
            place = 2 * square;
        }
        let shape = pieces.shapes[place].as_ref();
        shape.map(|shape| (shape, pieces.choice.pmf(place)))
    }

    /// Samples a direction from `p`; `None` where `p` is behind the triangle or in its plane.
    pub(super) fn sample(&self, p: Vec3, [u, v]: [f32; 2]) -> Option<EmitterSample> {
        let (sample, share) = match &self.pieces {
            None => (self.mean.sample(p, [u, v])?, 1.0),
            Some(pieces) => {
                let (place, share, rest) = pieces.choice.sample(u);
                (pieces.shapes[place].as_ref()?.sample(p, [rest, v])?, share)
            }
        };
        Some(EmitterSample { radiance: self.radiance(sample.target), pdf: sample.pdf * share, ..sample })
    }

    /// Samples a point from which light leaves.
    pub(super) fn sample_departure(&self, [u, v]: [f32; 2]) -> Departure {
        let Some(pieces) = &self.pieces else { return self.mean.sample_departure([u, v]) };
        let (place, _, rest) = pieces.choice.sample(u);
        let shape = pieces.shapes[place].as_ref().unwrap_or(&self.mean);
        Departure { normal: Some(self.mean.triangle.normal), ..shape.sample_departure([rest, v]) }
    }

    /// Density per solid angle at `p` of the direction that meets the triangle in `hit`; 0 where `p` is not in front.
    pub(super) fn pdf(&self, p: Vec3, hit: Vec3) -> f32 {
        let piece = self.pieces.as_ref().and_then(|pieces| self.piece_at(pieces, hit));
        piece.map_or_else(|| self.mean.pdf(p, hit), |(shape, share)| share * shape.pdf(p, hit))
    }

    /// The power \[W\] of a path that leaves from a sampled point: radiance over density, times pi.
    pub(super) fn power_from(&self, p: Vec3) -> DVec3 {
        let area = match self.pieces.as_ref().and_then(|pieces| self.piece_at(pieces, p)) {
            Some((shape, share)) => f64::from(shape.triangle.area) / f64::from(share),
            None => f64::from(self.mean.triangle.area),
        };
        std::f64::consts::PI * area * self.radiance(p).to_f64()
    }

    /// Whether the triangle emits no light anywhere.
    pub fn is_dark(&self) -> bool {
        self.mean.radiance == Rgb::ZERO
    }

    fn at(&self, [a, b, c]: [f32; 3]) -> TexturePoint {
        match &self.corners {
            TextureCorners::Uv([u, v, w]) => {
                let uv = [0, 1].map(|i| a * u[i] + b * v[i] + c * w[i]);
                TexturePoint { uv, ..TexturePoint::default() }
            }
            TextureCorners::Space([p, q, r]) => TexturePoint { p: a * *p + b * *q + c * *r, ..TexturePoint::default() },
        }
    }

    /// The radiance near a point, as [`TextureLight::near`] gives it.
    fn near(&self, weights: [f32; 3], light: &TextureLight, level: usize) -> Rgb {
        self.radiance.near(&self.at(weights), light, level)
    }

    /// Radiance from a point on the triangle, or off it along its normal.
    pub fn radiance(&self, p: Vec3) -> Rgb {
        self.weights(p).map_or(self.mean.radiance, |weights| self.radiance.at(&self.at(weights)))
    }

    /// The barycentric weights of a point.
    fn weights(&self, p: Vec3) -> Option<[f32; 3]> {
        let [e1, e2] = self.mean.triangle.sides();
        let to = p - self.mean.triangle.vertices[0];
        // In double precision: slivers have small determinants.
        let [e1, e2, to] = [e1, e2, to].map(Vec3::as_dvec3);
        let (a, b, c) = (e1.length_squared(), e1.dot(e2), e2.length_squared());
        let (d, e) = (to.dot(e1), to.dot(e2));
        let determinant = a * c - b * b;
        let (s, t) = ((c * d - b * e) / determinant, (a * e - b * d) / determinant);
        (s.is_finite() && t.is_finite()).then_some([(1.0 - s - t) as f32, s as f32, t as f32])
    }

    /// Texels along the longer of the two sides from the first corner.
    fn texels_along(&self) -> f32 {
        match &self.corners {
            TextureCorners::Uv([a, b, c]) => self.texels_between(a, b).max(self.texels_between(a, c)),
            TextureCorners::Space(_) => 16.0,
        }
    }

    fn texels_between(&self, p: &[f32; 2], q: &[f32; 2]) -> f32 {
        (p[0] - q[0]).hypot(p[1] - q[1]) * self.radiance.texture().texels_across() as f32
    }

    /// The radiance near a point on the triangle, as [`TextureLight::near`] gives it.
    pub(super) fn radiance_near(&self, p: Vec3, light: &TextureLight, level: usize) -> Rgb {
        self.weights(p).map_or(self.mean.radiance, |weights| self.near(weights, light, level))
    }

    /// The texture.
    pub(super) fn texture(&self) -> &Arc<Texture> {
        self.radiance.texture()
    }

    /// Texels along the longest side; of a pattern, about what resolves its squares.
    pub(super) fn texels(&self) -> f32 {
        match &self.corners {
            TextureCorners::Uv([_, b, c]) => self.texels_along().max(self.texels_between(b, c)),
            TextureCorners::Space(_) => 16.0,
        }
    }

    /// The mean over the triangle, by the rule of the middle over small triangles: two points for each texel.
    fn mean_radiance(&self, light: &TextureLight) -> Rgb {
        let wanted = 2.0 * self.texels();
        let steps = wanted.ceil().clamp(4.0, MOST_STEPS) as u32;
        let level = light.level_of(wanted / MOST_STEPS);
        let sum: DVec3 = centroids(steps).map(|[s, t]| self.near([1.0 - s - t, s, t], light, level).to_f64()).sum();
        Rgb::from_f64(sum / (f64::from(steps) * f64::from(steps)))
    }
}
