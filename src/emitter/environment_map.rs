//! Light from infinity that a texture varies by direction.

use std::f64::consts::PI;
use std::fmt::Debug;
use std::sync::Arc;

use super::infinite_ball::InfiniteBall;
use super::portals::Portals;
use super::textured_radiance::TexturedRadiance;
use super::{EmitterSample, Receiver};
use crate::math::{DMat3, DVec3, Vec3};
use crate::rows::rows;
use crate::sampling::BilinearGrid;
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb, luminance};
use crate::texture::{Texture, TexturePoint};
use crate::{Cancel, Result};

/// Most columns and rows of the grid that directions are sampled by. Larger images are sampled by means over squares of texels.
const MOST_ACROSS: [u32; 2] = [4096, 2048];

/// Columns and rows of the grid of a pattern.
const OF_PATTERN: [u32; 2] = [512, 256];

/// A pattern is known at points alone, as is an image in another order than that of the grid. Between the points this share of the
/// pattern's brightest light, or of the image's mean, is sampled in any case.
const SHARE_BETWEEN: f32 = 0.02;

/// The least polar angle [rad] from either pole. The density per solid angle has a limit at the poles, but cannot be computed there.
const LEAST_ANGLE: f32 = 1e-6;

/// What a texture reads in a direction.
pub trait SkyTexture: Debug + Send + Sync {
    /// What is read in this direction (unit, scene frame) with these texture coordinates.
    fn point(&self, direction: Vec3, uv: [f32; 2]) -> TexturePoint;
}

/// Radiance by direction that a formula gives.
pub trait SkyModel: Debug + Send + Sync {
    /// The radiance from a unit direction in the frame of the sky, whose y is up: finite and from 0 on.
    fn radiance(&self, direction: Vec3) -> Rgb;
}

/// The same radiance from all directions.
#[derive(Debug)]
pub struct EvenSky(pub Rgb);

impl SkyModel for EvenSky {
    fn radiance(&self, _: Vec3) -> Rgb {
        self.0
    }
}

/// What light from infinity shows.
#[derive(Debug)]
pub enum Sky {
    /// A texture over longitude and latitude.
    Texture(TexturedRadiance),
    /// A texture that lies otherwise.
    Unfolded(TexturedRadiance, Arc<dyn SkyTexture>),
    /// A formula.
    Model(Box<dyn SkyModel>),
}

/// The radiance that comes from all directions, and how directions are sampled by it.
///
/// The image's frame has y up. The middle of the image lies towards -z and its right half towards +x, as one sees it from within; the
/// top row is around +y. Texture coordinates go with it: u = 1/2 + atan2(x, -z) / 2 pi, v = 1 - acos(y) / pi.
///
/// Directions are sampled by the luminance of the bilinear image times the sine of the polar angle, which [`BilinearGrid`] interpolates
/// between texels, so that the density of a sampled direction is exact. Light samples beside samples of a Bsdf take the part of the
/// luminance above its mean (Karlík, Šik, Vévoda, Skřivan, Křivánek 2019, "MIS Compensation"): what is as bright as the mean or
/// less, the samples of the Bsdf find.
#[derive(Debug)]
pub struct EnvironmentMap {
    sky: Sky,
    /// Axes of the image's frame in the scene frame.
    axes: [Vec3; 3],
    all: BilinearGrid,
    /// `None` where nothing is brighter than the mean.
    above_mean: Option<BilinearGrid>,
    mean: DVec3,
}

impl EnvironmentMap {
    /// The light of a sky. `to_scene` turns directions from the frame of the image to the scene's. `None` for one that is black
    /// everywhere. Texels are read by at most `threads` threads.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn new(sky: Sky, to_scene: &DMat3, threads: usize, cancel: &Cancel) -> Result<Option<Self>> {
        let axes = [to_scene.x_axis, to_scene.y_axis, to_scene.z_axis].map(|axis| axis.normalize().as_vec3a());
        let (size, squares) = sky.grid();
        let lookup = |u: f64, t: f64| sky.at(&axes, [u as f32, t as f32]);
        let [width, height] = size;
        // Luminance at the points of the grid, their mean colours and the sines of their polar angles.
        let row = |y: u32| {
            let mut luminances = Vec::with_capacity(width as usize);
            let mut sum = DVec3::ZERO;
            if cancel.is_cancelled() {
                return (luminances, sum);
            }
            for x in 0..width {
                let mut mean = DVec3::ZERO;
                for j in 0..squares[1] {
                    for i in 0..squares[0] {
                        let inside = |n: u32, part: u32, count: u32, parts: u32| {
                            (f64::from(n) + (f64::from(part) + 0.5) / f64::from(parts)) / f64::from(count)
                        };
                        mean += lookup(inside(x, i, width, squares[0]), inside(y, j, height, squares[1])).to_f64();
                    }
                }
                mean /= f64::from(squares[0] * squares[1]);
                luminances.push(mean.dot(LUMINANCE_WEIGHTS.to_f64()) as f32);
                sum += mean;
            }
            (luminances, sum)
        };
        let read = rows(height, threads, row);
        cancel.check()?;
        let sine = |y: usize| (PI * (y as f64 + 0.5) / f64::from(height)).sin();
        let mean = read.iter().enumerate().map(|(y, (_, sum))| *sum * row_share(y as u32, height)).sum::<DVec3>();
        let mean = mean / f64::from(width);
        let mut luminances: Vec<f32> = read.into_iter().flat_map(|(row, _)| row).collect();
        let mean_luminance = mean.dot(LUMINANCE_WEIGHTS.to_f64()) as f32;
        let between = sky.light_between(mean_luminance);
        if let Some(light) = between {
            let least = SHARE_BETWEEN * light;
            luminances.iter_mut().for_each(|value| *value += least);
        }
        let grid = |value: &dyn Fn(f32) -> f32| {
            let values = luminances.iter().enumerate();
            let values = values.map(|(i, luminance)| value(*luminance) * sine(i / width as usize) as f32);
            BilinearGrid::new(width as usize, values.collect(), cancel)
        };
        let Some(all) = grid(&|luminance| luminance)? else { return Ok(None) };
        let above_mean = grid(&|luminance| (luminance - mean_luminance).max(0.0))?;
        Ok(Some(Self { sky, axes, all, above_mean, mean }))
    }

    /// Mean of the radiance over all directions; of an image that is reduced or not interpolated, and of a pattern, about.
    pub fn mean(&self) -> DVec3 {
        self.mean
    }

    /// Columns and rows of the points by whose luminance directions are sampled.
    pub fn grid_size(&self) -> [usize; 2] {
        self.all.size()
    }

    /// Memory of the tables that directions are sampled by, bytes.
    pub fn bytes(&self) -> usize {
        self.all.bytes() + self.above_mean.as_ref().map_or(0, BilinearGrid::bytes)
    }

    /// The radiance that comes from a unit direction of the scene.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        self.sky.towards(&self.axes, direction, || self.place_of(direction).0)
    }

    /// A direction (unit, scene frame) and its density \[sr^-1\], by all of the light or only by what is above its mean; `u` uniform in
    /// [0, 1)^2. The radiance is that of the direction.
    #[inline]
    pub fn sample(&self, u: [f32; 2], beside_bsdf: bool) -> (Vec3, f32, Rgb) {
        let sample = self.grid(beside_bsdf).sample(u);
        let [x, t] = [sample.at[0], sample.at[1].clamp(LEAST_ANGLE, 1.0 - LEAST_ANGLE)];
        let direction = direction(&self.axes, [x, t]);
        let sine = (t.min(1.0 - t) * PI as f32).sin();
        let radiance = self.sky.at(&self.axes, [x, t]);
        (direction, sample.pdf / (2.0 * (PI * PI) as f32 * sine), radiance)
    }

    /// The density \[sr^-1\] with which [`Self::sample`] gives a unit direction.
    #[inline]
    pub fn pdf(&self, direction: Vec3, beside_bsdf: bool) -> f32 {
        let (at, sine) = self.place_of(direction);
        self.grid(beside_bsdf).pdf(at) / (2.0 * (PI * PI) as f32 * sine)
    }

    fn grid(&self, beside_bsdf: bool) -> &BilinearGrid {
        match &self.above_mean {
            Some(above_mean) if beside_bsdf => above_mean,
            _ => &self.all,
        }
    }

    /// The place of a direction in the image, to the right and down in [0, 1], and the sine of its polar angle.
    #[inline]
    fn place_of(&self, direction: Vec3) -> ([f32; 2], f32) {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        let sine = x.hypot(z);
        let angle = sine.atan2(y);
        let u = 0.5 + x.atan2(-z) * (0.5 / PI) as f32;
        let least = LEAST_ANGLE * PI as f32;
        if sine < least {
            // The pole itself.
            return ([u, if y > 0.0 { LEAST_ANGLE } else { 1.0 - LEAST_ANGLE }], least);
        }
        ([u, angle * (1.0 / PI) as f32], sine)
    }
}

/// The share of the sphere that a row of an image of so many rows counts for, where the image is linear between its rows and ends at
/// the poles.
fn row_share(y: u32, height: u32) -> f64 {
    if height == 1 {
        return 1.0;
    }
    let step = PI / f64::from(height);
    // Half the integrals of sine times what is 1 at the row and 0 at the next, and 1 from the first row to the pole.
    let from = step * (f64::from(y.min(height - 1 - y)) + 0.5);
    if y == 0 || y == height - 1 {
        return 0.5 * (1.0 - ((from + step).sin() - from.sin()) / step);
    }
    from.sin() * 2.0 * (0.5 * step).sin().powi(2) / step
}

impl Sky {
    /// Columns and rows of the grid that directions are sampled by, and the points in each of its texels, across and down.
    fn grid(&self) -> ([u32; 2], [u32; 2]) {
        let texels = |radiance: &TexturedRadiance| match &**radiance.texture() {
            Texture::Image(_) => Some(radiance.texture().texels()),
            Texture::Procedural(..) | Texture::White => None,
        };
        match self {
            Self::Texture(radiance) => match texels(radiance) {
                Some(texels) => {
                    let squares = [0, 1].map(|i| texels[i].div_ceil(MOST_ACROSS[i]));
                    ([0, 1].map(|i| texels[i].div_ceil(squares[i])), squares)
                }
                None => (OF_PATTERN, [1; 2]),
            },
            Self::Unfolded(radiance, _) => match texels(radiance) {
                // As fine as the image where it is widest, and four points for each.
                Some([width, _]) => {
                    ([0, 1].map(|i| (width.saturating_mul([4, 2][i])).clamp(OF_PATTERN[i], MOST_ACROSS[i])), [2; 2])
                }
                None => (OF_PATTERN, [1; 2]),
            },
            Self::Model(_) => (OF_PATTERN, [1; 2]),
        }
    }

    /// The luminance of which a share is sampled everywhere, where the points of the grid do not say all; `mean` is theirs.
    fn light_between(&self, mean: f32) -> Option<f32> {
        match self {
            Self::Texture(radiance) | Self::Unfolded(radiance, _) => match &**radiance.texture() {
                Texture::Image(_) => matches!(self, Self::Unfolded(..)).then_some(mean),
                Texture::Procedural(..) | Texture::White => Some(luminance(radiance.brightest_at_all())),
            },
            Self::Model(_) => Some(mean),
        }
    }

    /// The radiance at a place of the image by longitude and latitude, to the right and down in [0, 1].
    #[inline]
    fn at(&self, axes: &[Vec3; 3], place: [f32; 2]) -> Rgb {
        match self {
            // Its direction is not asked for.
            Self::Texture(_) => self.towards(axes, Vec3::Y, || place),
            Self::Unfolded(..) | Self::Model(_) => self.towards(axes, direction(axes, place), || place),
        }
    }

    /// The radiance from a unit direction of the scene, which is at this place of the image.
    #[inline]
    fn towards(&self, axes: &[Vec3; 3], direction: Vec3, place: impl FnOnce() -> [f32; 2]) -> Rgb {
        let uv = || {
            let [u, t] = place();
            [u, 1.0 - t]
        };
        match self {
            Self::Texture(radiance) => radiance.at(&TexturePoint { uv: uv(), ..TexturePoint::default() }),
            Self::Unfolded(radiance, place) => radiance.at(&place.point(direction, uv())),
            Self::Model(model) => model.radiance(Vec3::from_array(axes.map(|axis| axis.dot(direction)))),
        }
    }
}

/// The direction in the scene frame of a place in the image.
#[inline]
fn direction(axes: &[Vec3; 3], [u, t]: [f32; 2]) -> Vec3 {
    let (sin_phi, cos_phi) = ((u - 0.5) * 2.0 * PI as f32).sin_cos();
    // From the nearer pole, near which single precision is finer.
    let (sine, cosine) = (t.min(1.0 - t) * PI as f32).sin_cos();
    let cosine = if t < 0.5 { cosine } else { -cosine };
    (sine * sin_phi * axes[0] + cosine * axes[1] - sine * cos_phi * axes[2]).normalize()
}

/// An [`EnvironmentMap`] around the ball that holds the scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMapEmitter {
    /// The light.
    pub map: Arc<EnvironmentMap>,
    /// Whether camera rays see it.
    pub visible: bool,
    /// The ball that holds the scene.
    pub ball: InfiniteBall,
    /// Openings through which it comes in, scene frame.
    pub portals: Option<Arc<Portals>>,
}

impl EnvironmentMapEmitter {
    /// Light that camera rays see, around everything that lies in the ball, scene frame.
    pub fn new(map: Arc<EnvironmentMap>, ball: InfiniteBall) -> Self {
        Self { map, visible: true, ball, portals: None }
    }

    /// Power that enters the ball (W): pi A times the mean radiance.
    pub(super) fn power(&self) -> DVec3 {
        PI * self.ball.area() * self.map.mean()
    }

    /// Samples a direction for a receiver.
    #[inline]
    pub(super) fn sample(&self, receiver: &Receiver, u: [f32; 2], beside_bsdf: bool) -> EmitterSample {
        let (wi, pdf, radiance) = match &self.portals {
            None => self.map.sample(u, beside_bsdf),
            Some(portals) => self.sample_through(portals, receiver.p, u, beside_bsdf),
        };
        EmitterSample { wi, target: self.ball.beyond(receiver.p, wi), radiance, pdf, emitter: 0, is_delta: false }
    }

    /// The density \[sr^-1\] with which [`Self::sample`] gives a unit direction for a receiver at `p`.
    #[inline]
    pub(super) fn pdf(&self, p: Vec3, direction: Vec3, beside_bsdf: bool) -> f32 {
        let plain = self.map.pdf(direction, beside_bsdf);
        self.portals.as_ref().map_or(plain, |portals| portals.pdf(p, direction, plain))
    }

    #[cold]
    #[inline(never)]
    fn sample_through(&self, portals: &Portals, p: Vec3, u: [f32; 2], beside_bsdf: bool) -> (Vec3, f32, Rgb) {
        let plain = |u: [f32; 2]| {
            let (wi, pdf, _) = self.map.sample(u, beside_bsdf);
            (wi, pdf)
        };
        let (wi, pdf) = portals.sample(p, u, plain, |wi| self.map.pdf(wi, beside_bsdf));
        (wi, pdf, self.map.radiance(wi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Rng;
    use crate::texture::{ColorSpace, ImageTexture, TexelImage, Texels, TextureFilter, Wrap};

    /// An image of these luminances, row by row, turned by `to_scene`.
    fn map(width: u32, values: &[f32], filter: TextureFilter, to_scene: &DMat3) -> Option<EnvironmentMap> {
        let image =
            TexelImage::new(width, values.len() as u32 / width, 1, Texels::F32(values.to_vec().into())).unwrap();
        let image = ImageTexture::new(Arc::new(image), ColorSpace::Linear, [Wrap::Repeat, Wrap::Clamp], filter);
        let radiance = TexturedRadiance::of_texture(Arc::new(Texture::Image(image)), Rgb::new(1.0, 1.0, 1.0), None);
        EnvironmentMap::new(Sky::Texture(radiance), to_scene, 2, &Cancel::new()).unwrap()
    }

    fn turned() -> DMat3 {
        DMat3::from_rotation_x(0.7) * DMat3::from_rotation_y(-1.9)
    }

    /// Images with a hot texel, at a pole, at the seam, of one texel, of noise.
    fn images() -> Vec<(u32, Vec<f32>)> {
        let mut rng = Rng::new(3, 1);
        let mut hot = vec![0.0; 32];
        hot[8 + 7] = 1000.0;
        let mut pole = vec![1.0; 32];
        pole[3] = 50.0;
        let noise = (0..128).map(|_| rng.next_f32()).collect();
        vec![(8, hot), (8, pole), (1, vec![2.0]), (2, vec![1.0, 3.0]), (16, noise)]
    }

    #[test]
    fn directions_of_the_image_are_where_the_documentation_says() {
        // Of 4 x 2 texels each in turn.
        for (place, expected) in [
            ([0.5, 0.5], -Vec3::Z),
            ([0.75, 0.5], Vec3::X),
            ([0.25, 0.5], -Vec3::X),
            ([0.0, 0.5], Vec3::Z),
            ([0.3, 1e-7], Vec3::Y),
        ] {
            let map = map(1, &[1.0], TextureFilter::Bilinear, &DMat3::IDENTITY).unwrap();
            assert!(direction(&map.axes, place).distance(expected) < 1e-5, "{place:?}");
            let (again, sine) = map.place_of(expected);
            assert!((again[1] - place[1]).abs() < 1e-5 && sine > 0.0, "{again:?}");
            let across = (again[0] - place[0]).abs();
            assert!(expected == Vec3::Y || across.min(1.0 - across) < 1e-5, "{again:?}");
        }
    }

    /// Densities integrate to 1 over the sphere, estimates of the whole light by samples of either kind have the mean that midpoints
    /// have, and what a sample says of itself is what is said of its direction.
    #[test]
    fn light_is_sampled_with_its_density() {
        for (width, values) in images() {
            for filter in [TextureFilter::Bilinear, TextureFilter::Nearest] {
                let map = map(width, &values, filter, &turned()).unwrap();
                // Midpoints in the image.
                const STEPS: usize = 512;
                let (mut all, mut density, mut second) = (0.0, 0.0, 0.0);
                for y in 0..STEPS {
                    let t = (y as f64 + 0.5) / STEPS as f64;
                    let weight = 2.0 * PI * PI * (PI * t).sin() / (STEPS * STEPS) as f64;
                    for x in 0..STEPS {
                        let direction = direction(&map.axes, [(x as f32 + 0.5) / STEPS as f32, t as f32]);
                        all += weight * f64::from(map.radiance(direction).g());
                        density += weight * f64::from(map.pdf(direction, false));
                        second += weight * f64::from(map.pdf(direction, true));
                    }
                }
                assert!((density - 1.0).abs() < 1e-3 && (second - 1.0).abs() < 1e-3, "{values:?}: {density}, {second}");
                let mut rng = Rng::new(1, 2);
                let (mut sum, mut squares) = (0.0, 0.0);
                const COUNT: usize = 1 << 14;
                for _ in 0..COUNT {
                    for beside_bsdf in [false, true] {
                        let (wi, pdf, radiance) = map.sample([rng.next_f32(), rng.next_f32()], beside_bsdf);
                        assert!(wi.is_normalized() && pdf > 0.0, "{wi} {pdf}");
                        let again = map.pdf(wi, beside_bsdf);
                        assert!(
                            (again / pdf - 1.0).abs() < 2e-3 || (again - pdf).abs() < 1e-4,
                            "{values:?} at {wi}: {pdf}, {again}"
                        );
                        if filter == TextureFilter::Bilinear {
                            let difference = (map.radiance(wi) - radiance).g().abs();
                            assert!(difference <= 1e-3 * radiance.g() + 1e-2, "{values:?} at {wi}: {difference}");
                        }
                        if !beside_bsdf {
                            let value = f64::from(radiance.g()) / f64::from(pdf);
                            sum += value;
                            squares += value * value;
                        }
                    }
                }
                let mean = sum / COUNT as f64;
                let error = ((squares / COUNT as f64 - mean * mean).max(0.0) / COUNT as f64).sqrt();
                assert!((mean - all).abs() < 4.0 * error + 2e-3 * all, "{values:?}: {mean} ± {error}, not {all}");
                assert!(filter == TextureFilter::Nearest || error < 0.004 * mean, "{values:?}: {error} of {mean}");
            }
        }
    }

    #[test]
    fn rows_share_the_sphere() {
        for height in [1, 2, 3, 8, 1000] {
            let all: f64 = (0..height).map(|y| row_share(y, height)).sum();
            assert!((all - 1.0).abs() < 1e-12, "{height}: {all}");
        }
    }

    #[test]
    fn a_black_image_is_no_light_and_an_even_one_has_no_light_above_its_mean() {
        assert!(map(2, &[0.0; 4], TextureFilter::Bilinear, &DMat3::IDENTITY).is_none());
        assert!(map(2, &[-1.0; 4], TextureFilter::Bilinear, &DMat3::IDENTITY).is_none());
        let even = map(4, &[2.0; 8], TextureFilter::Bilinear, &DMat3::IDENTITY).unwrap();
        assert!((even.mean() - DVec3::splat(2.0)).length() < 1e-6);
        for y in [-0.9_f32, -0.3, 0.0, 0.8] {
            let direction = Vec3::new((1.0 - y * y).sqrt(), y, 0.0);
            let pdf = even.pdf(direction, true) * 4.0 * PI as f32;
            assert!((pdf - 1.0).abs() < 0.2, "{y}: {pdf}");
        }
    }
}
