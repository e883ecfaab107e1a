//! Spheres whose radiance a texture varies.

use std::f64::consts::PI;
use std::fmt::Debug;
use std::sync::Arc;

use super::textured_radiance::{CONTRAST, TexturedRadiance, UNIFORM_SHARE, VAIN_SHARE};
use super::{Departure, EmitterSample, SphereEmitter};
use crate::math::{DMat3, DVec3, Vec3};
use crate::sampling::Distribution1D;
use crate::shape::Sphere;
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb, luminance};
use crate::texture::{Texture, TextureLight, TexturePoint};

/// What a texture reads at points of a sphere.
pub trait SphereTexture: Debug + Send + Sync {
    /// What is read at the point `p`, scene frame, with the outward unit normal `n` and the texture coordinates `uv` of the sphere.
    fn point(&self, p: Vec3, n: Vec3, uv: [f32; 2]) -> TexturePoint;

    /// A box that holds the texture coordinates of all that is read, as its lower and upper corner; `None` for points in the space of a
    /// pattern.
    fn bounds(&self) -> Option<[[f32; 2]; 2]>;

    /// Texels once around the sphere, and from pole to pole.
    fn texels(&self) -> [f32; 2];
}

/// A sphere that emits the same radiance in all outward directions, but not at all of its points.
///
/// Light samples are those of a sphere that shines evenly: directions in the cone under which it is seen. Where the texture varies much
/// over the sphere, photons first choose a part of it by its share of the light, then a point of this part.
#[derive(Clone, Debug)]
pub struct TexturedSphere {
    /// Shape, and the mean of the radiance over the sphere's area.
    pub mean: SphereEmitter,
    radiance: TexturedRadiance,
    place: Arc<dyn SphereTexture>,
    /// From the frame of the sphere's texture coordinates to the scene's: a rotation, or one with a reflection.
    to_scene: DMat3,
    parts: Option<Parts>,
    /// See [`TexturedSphere::intensity_share`].
    intensity_share: f64,
}

/// Parts of a sphere between lines of equal texture coordinates, of which one is chosen by its share of the light.
#[derive(Clone, Debug)]
struct Parts {
    grid: Grid,
    /// Row by row from v = 0.
    choice: Distribution1D,
}

/// Columns and rows of parts over the texture coordinates of a sphere.
#[derive(Clone, Copy, Debug)]
struct Grid {
    columns: usize,
    rows: usize,
}

/// Least and most parts around the sphere or from pole to pole, but for textures of a few texels, and points in each of them.
const FEW_PARTS: f32 = 16.0;
const MOST_PARTS: f32 = 32.0;
const POINTS: usize = 4;

/// The light of the parts, and how it is distributed over directions.
struct Light {
    /// The integral of radiance over each part of the unit sphere.
    of_parts: Vec<DVec3>,
    /// Integrals of luminance times the normal, and times the products of its components.
    first: DVec3,
    second: DMat3,
}

impl Grid {
    /// Parts along one direction in which there are so many squares that are read. Edges of parts are edges of squares, if that is
    /// possible.
    fn parts(squares: f32) -> usize {
        let squares = squares.ceil().max(1.0);
        let parts = if squares <= MOST_PARTS {
            squares * (FEW_PARTS / squares).round().max(1.0)
        } else {
            // Several squares each.
            let each = (squares / MOST_PARTS).ceil();
            (squares / each).ceil()
        };
        parts.min(MOST_PARTS) as usize
    }

    fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The heights along the axis, in radii, between which a row of `rows` lies.
    fn heights(row: usize, rows: usize) -> [f64; 2] {
        [row, row + 1].map(|edge| Sphere::height(edge as f64 / rows as f64))
    }

    /// Share of a part in the area of the sphere.
    fn area(&self, part: usize) -> f64 {
        let [low, high] = Self::heights(part / self.columns, self.rows);
        0.5 * (high - low) / self.columns as f64
    }

    /// The part that holds a point with these texture coordinates.
    fn part_at(&self, [u, v]: [f64; 2]) -> usize {
        let place = |x: f64, count: usize| ((x * count as f64).max(0.0) as usize).min(count - 1);
        place(v, self.rows) * self.columns + place(u, self.columns)
    }

    /// The direction of a point of a part, in the frame of texture coordinates; uniform by area for uniform numbers.
    fn direction(&self, part: usize, [a, b]: [f32; 2]) -> DVec3 {
        let [low, high] = Self::heights(part / self.columns, self.rows);
        let u = ((part % self.columns) as f64 + f64::from(a)) / self.columns as f64;
        Sphere::direction(u, low + f64::from(b) * (high - low))
    }
}

impl TexturedSphere {
    /// An emitter. `to_scene` turns directions from the frame of the sphere's texture coordinates to the scene's. It has parts where they
    /// pay, which are taken from `left`, the number that there is room for.
    pub fn new(
        sphere: Sphere,
        to_scene: DMat3,
        radiance: TexturedRadiance,
        light: &TextureLight,
        place: Arc<dyn SphereTexture>,
        left: &mut usize,
    ) -> Self {
        let mean = SphereEmitter { sphere, radiance: Rgb::ZERO };
        let mut emitter = Self { mean, radiance, place, to_scene, parts: None, intensity_share: 0.25 };
        let brightest = emitter.radiance.brightest(emitter.place.bounds(), light);
        if brightest == Rgb::ZERO {
            return emitter;
        }
        // Each point stands for a square of texels.
        let texels = emitter.place.texels();
        let most = MOST_PARTS * POINTS as f32;
        let level = light.level_of(texels[0].max(texels[1]) / most);
        let width = if level == 0 { 1.0 } else { (level as f32).exp2() };
        let [columns, rows] = texels.map(|texels| Grid::parts(texels / width));
        let grid = Grid { columns, rows };
        let found = emitter.light(&grid, light, level);
        let sum: DVec3 = found.of_parts.iter().sum();
        emitter.mean.radiance = TexturedRadiance::by_choice(Rgb::from_f64(sum / (4.0 * PI)), brightest);
        emitter.intensity_share = found.intensity_share();
        if f64::from(luminance(brightest)) >= CONTRAST * f64::from(luminance(emitter.mean.radiance)) {
            emitter.parts = Parts::new(grid, &found, left);
        }
        emitter
    }

    /// Integrates the radiance over all parts, by the rule of the middle with the area of each strip of equal height.
    fn light(&self, grid: &Grid, light: &TextureLight, level: usize) -> Light {
        let (columns, rows) = (POINTS * grid.columns, POINTS * grid.rows);
        let weights = LUMINANCE_WEIGHTS.to_f64();
        let mut of_parts = vec![DVec3::ZERO; grid.count()];
        let (mut first, mut second) = (DVec3::ZERO, DMat3::ZERO);
        for row in 0..rows {
            let [low, high] = Grid::heights(row, rows);
            let area = 2.0 * PI * (high - low) / columns as f64;
            // The middle of the texture coordinate, which is that of texels.
            let height = Sphere::height((row as f64 + 0.5) / rows as f64);
            for column in 0..columns {
                let direction = Sphere::direction((column as f64 + 0.5) / columns as f64, height);
                let n = self.to_scene * direction;
                let value = area * self.radiance.near(&self.point(n), light, level).to_f64();
                of_parts[row / POINTS * grid.columns + column / POINTS] += value;
                let luminance = value.dot(weights);
                first += luminance * n;
                second += DMat3::from_cols(n.x * n, n.y * n, n.z * n) * luminance;
            }
        }
        Light { of_parts, first, second }
    }

    /// What the texture reads where this is the unit normal.
    fn point(&self, n: DVec3) -> TexturePoint {
        let uv = self.texture_coordinates(n).map(|x| x as f32);
        let p = self.mean.sphere.centre + self.mean.sphere.radius * n;
        self.place.point(p.as_vec3a(), n.as_vec3a(), uv)
    }

    /// The texture coordinates where this is the normal.
    fn texture_coordinates(&self, n: DVec3) -> [f64; 2] {
        Sphere::texture_coordinates(self.to_scene.transpose() * n)
    }

    /// The outward unit normal at a point near the sphere.
    fn normal(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.mean.sphere.centre).normalize_or_zero()
    }

    /// Samples a direction from `p` uniformly in the cone; `None` inside the sphere.
    pub(super) fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<EmitterSample> {
        let sample = self.mean.sample(p, u)?;
        Some(EmitterSample { radiance: self.radiance(sample.target), ..sample })
    }

    /// Samples a point from which light leaves.
    pub(super) fn sample_departure(&self, [u, v]: [f32; 2]) -> Departure {
        let Some(parts) = &self.parts else { return self.mean.sample_departure([u, v]) };
        let (part, _, rest) = parts.choice.sample(u);
        self.mean.departure_towards(self.to_scene * parts.grid.direction(part, [rest, v]))
    }

    /// The power \[W\] of a path that leaves from a sampled point: radiance over density, times pi.
    pub(super) fn power_from(&self, p: Vec3) -> DVec3 {
        let density = self.parts.as_ref().map_or(1.0, |parts| {
            let part = parts.grid.part_at(self.texture_coordinates(self.normal(p)));
            f64::from(parts.choice.pmf(part)) / parts.grid.area(part)
        });
        PI * self.mean.sphere.area() / density * self.radiance(p).to_f64()
    }

    /// Radiance from a point on the sphere, or off it along its normal.
    pub fn radiance(&self, p: Vec3) -> Rgb {
        self.radiance.at(&self.point(self.normal(p)))
    }

    /// The radiance near a point on the sphere, as [`TextureLight::near`] gives it.
    pub(super) fn radiance_near(&self, p: Vec3, light: &TextureLight, level: usize) -> Rgb {
        self.radiance.near(&self.point(self.normal(p)), light, level)
    }

    /// The texture.
    pub(super) fn texture(&self) -> &Arc<Texture> {
        self.radiance.texture()
    }

    /// Texels once around the sphere, and from pole to pole.
    pub(super) fn texels(&self) -> [f32; 2] {
        self.place.texels()
    }

    /// Whether the sphere emits no light anywhere.
    pub fn is_dark(&self) -> bool {
        self.mean.radiance == Rgb::ZERO
    }

    /// A bound of the radiant intensity in the brightest direction, times pi and over the power: 1/4 where it is the same in all
    /// directions, 1 where all light comes from one place.
    pub(super) fn intensity_share(&self) -> f64 {
        self.intensity_share
    }
}

impl Parts {
    /// The parts, where they pay.
    fn new(grid: Grid, light: &Light, left: &mut usize) -> Option<Self> {
        let count = grid.count();
        if count > *left {
            return None;
        }
        let weights = light.of_parts.iter().map(|value| value.dot(LUMINANCE_WEIGHTS.to_f64()));
        let mut weights: Vec<f64> = weights.collect();
        let sum: f64 = weights.iter().sum();
        let areas: Vec<f64> = (0..count).map(|part| grid.area(part)).collect();
        let is_bright = |(weight, area): (&f64, &f64)| *weight > CONTRAST * sum * area;
        if sum <= 0.0 || !weights.iter().zip(&areas).any(is_bright) {
            *left -= count.div_ceil(VAIN_SHARE);
            return None;
        }
        for (weight, area) in weights.iter_mut().zip(&areas) {
            *weight = (1.0 - UNIFORM_SHARE) * *weight + UNIFORM_SHARE * sum * area;
        }
        *left -= count;
        Distribution1D::new(&weights).map(|choice| Self { grid, choice })
    }
}

impl Light {
    /// See [`TexturedSphere::intensity_share`]. The intensity along d is the mean of max(n . d, 0) = (n . d + |n . d|) / 2, weighed by the
    /// light, and the mean of |n . d| is no more than the root of the mean of (n . d)^2.
    fn intensity_share(&self) -> f64 {
        let total = self.second.x_axis.x + self.second.y_axis.y + self.second.z_axis.z;
        // No eigenvalue is larger than the root of the sum of all squares.
        let second = self.second.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let share = 0.5 * (self.first.length() / total + (second / total).sqrt());
        if share.is_finite() { share.clamp(0.25, 1.0) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bound for light that leaves points with these normals.
    fn share(normals: &[DVec3]) -> f64 {
        let mut light = Light { of_parts: Vec::new(), first: DVec3::ZERO, second: DMat3::ZERO };
        for n in normals {
            light.first += *n;
            light.second += DMat3::from_cols(n.x * *n, n.y * *n, n.z * *n);
        }
        light.intensity_share()
    }

    /// The share of the light of these points in the brightest of many directions.
    fn brightest(normals: &[DVec3], directions: &[DVec3]) -> f64 {
        let share = |d: &DVec3| normals.iter().map(|n| n.dot(*d).max(0.0)).sum::<f64>() / normals.len() as f64;
        directions.iter().map(share).fold(0.0, f64::max)
    }

    #[test]
    fn no_direction_gets_more_than_the_bound() {
        let place =
            |i: u32| Sphere::direction(f64::from(i) * 0.618_033_988_75 % 1.0, f64::from(i) / 1000.0 * 2.0 - 1.0);
        let all: Vec<DVec3> = (0..=1000).map(place).collect();
        let some = |keep: &dyn Fn(&DVec3) -> bool| all.iter().copied().filter(keep).collect::<Vec<_>>();
        for (lit, most) in [
            (all.clone(), 0.4),
            (some(&|n| n.y > 0.0), 0.65),
            (some(&|n| n.x.abs() > 0.95), 0.52),
            (some(&|n| n.z > 0.99), 1.0),
        ] {
            let (bound, exact) = (share(&lit), brightest(&lit, &all));
            assert!(exact <= bound + 1e-9 && bound <= most, "{exact} {bound} {most}");
        }
    }

    #[test]
    fn parts_hold_the_points_that_are_drawn_from_them() {
        for squares in [1.0_f32, 3.0, 7.0, 20.0, 33.0, 100.0, 128.0] {
            let parts = Grid::parts(squares);
            assert!((8..=32).contains(&parts), "{squares}: {parts}");
            assert!(squares > 32.0 || parts.is_multiple_of(squares as usize), "{squares}: {parts}");
        }
        let grid = Grid { columns: 7, rows: 5 };
        let areas: f64 = (0..grid.count()).map(|part| grid.area(part)).sum();
        assert!((areas - 1.0).abs() < 1e-12, "{areas}");
        for part in 0..grid.count() {
            for u in [[0.01, 0.01], [0.5, 0.5], [0.99, 0.99]] {
                assert_eq!(grid.part_at(Sphere::texture_coordinates(grid.direction(part, u))), part);
            }
        }
    }
}
