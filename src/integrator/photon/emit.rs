//! Emission of photons: the choice of the emitter, the position on it and the direction.
//!
//! An emitter is chosen mostly in proportion to its power, a position on it by area, and a direction by the cosine (from a
//! point light uniformly over the sphere; from a lamp with a distribution as that is), so that all photons carry the same power except for their colour. Caustic photons
//! may be aimed instead: at balls that bound all specular surfaces. Directions that miss all balls could not have made a
//! caustic. An aimed photon carries the power weighted by the ratio of the plain density of its direction to the aimed one,
//! so that the map has the same mean with more photons.
//!
//! Sources: Jensen 2001, *Realistic Image Synthesis Using Photon Mapping*, Sec. 5.1 to 5.3 (projection maps).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::desc::PhotonSharing;
use crate::emitter::{DistantEmitter, Emitter, EnvironmentMapEmitter, InfiniteBall, Portals};
use crate::error::{Error, Result};
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::{DirectionCone, Distribution1D, warps};
use crate::scene::{Ball, Scene};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};

/// Most balls that photons are aimed at, since every aimed photon is tested against each ball.
const MOST_BALLS: usize = 16;

/// Share of the aimed photons that emitters get by power alone, in case an emitter's centre sees less of the balls than the
/// rest of the emitter.
const BY_POWER: f64 = 0.05;

/// The distribution of the first rays of light paths.
pub(in crate::integrator) struct Emission {
    choice: Distribution1D,
    /// The moment that all light paths see ([`Ray::time`]), and the emitters that move, by their numbers, where they are then.
    time: f32,
    moved: BTreeMap<usize, Emitter>,
    /// The balls to aim at; empty where photons are sent in all directions.
    balls: Vec<Ball>,
}

impl Emission {
    /// Creates the distribution for a scene at rest, or as its shutter opens; see [`Emission::at`].
    ///
    /// # Errors
    /// Those of [`Emission::at`].
    pub fn new(scene: &Scene, sharing: PhotonSharing, aims: Aim) -> Result<Option<Self>> {
        Self::at(scene, sharing, aims, 0.0)
    }

    /// Creates the distribution for a scene at a moment ([`Ray::time`]); `None` where nothing emits light, or where photons are to be
    /// aimed and there is nothing to aim at.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for point lights that are to share photons by area.
    pub fn at(scene: &Scene, sharing: PhotonSharing, aims: Aim, time: f32) -> Result<Option<Self>> {
        let mut moved = BTreeMap::new();
        if scene.emitters().has_moving() {
            for (index, emitter) in scene.emitters().emitters().iter().enumerate() {
                if let Emitter::Moving(moving) = emitter {
                    // A triangle that has no area at the moment has no power either.
                    let dark = Emitter::Point { position: emitter.centre(), intensity: Rgb::ZERO };
                    moved.insert(index, moving.at(time).unwrap_or(dark));
                }
            }
        }
        let emitters: Vec<&Emitter> = scene
            .emitters()
            .emitters()
            .iter()
            .enumerate()
            .map(|(index, emitter)| moved.get(&index).unwrap_or(emitter))
            .collect();
        let balls = match aims {
            Aim::Everywhere => Vec::new(),
            Aim::AtSpecular { narrow_below } => scene.specular_balls(narrow_below, MOST_BALLS),
        };
        if balls.is_empty() && matches!(aims, Aim::AtSpecular { .. }) {
            return Ok(None);
        }
        let weights: Vec<f64> = match sharing {
            PhotonSharing::Power => {
                let power = |emitter: &Emitter| emitter.power().dot(LUMINANCE_WEIGHTS.to_f64());
                let seen: Vec<f64> =
                    emitters.iter().map(|emitter| power(emitter) * share_aimed(emitter, &balls)).collect();
                let (all, aimed) =
                    (emitters.iter().map(|emitter| power(emitter)).sum::<f64>(), seen.iter().sum::<f64>());
                let even = if balls.is_empty() || all == 0.0 { 0.0 } else { BY_POWER * (aimed / all).max(1e-6) };
                emitters.iter().zip(seen).map(|(emitter, seen)| seen + even * power(emitter)).collect()
            }
            PhotonSharing::Area => {
                let shines = |emitter: &Emitter| emitter.power().max_element() > 0.0;
                if emitters.iter().any(|emitter| emitter.is_point() && shines(emitter)) {
                    let message = "area; points have none: expected power in a scene with point lights";
                    return Err(Error::invalid("render.photonSharing", message));
                }
                emitters.iter().map(|emitter| if shines(emitter) { emitter.area() } else { 0.0 }).collect()
            }
        };
        Ok(Distribution1D::new(&weights).map(|choice| Self { choice, time, moved, balls }))
    }

    /// Samples the start of one of `1 / share` light paths: a ray and the power that it carries (W). `None` for a path that
    /// carries no power, which counts as one of the paths all the same.
    ///
    /// `u` and `d` are uniform in [0, 1)^4: `u` chooses the emitter, the position on it and the ball that is aimed at; the
    /// first two of `d` choose the direction.
    #[inline]
    pub fn begin(&self, scene: &Scene, u: [f32; 4], d: [f32; 4], share: f64) -> Option<(Ray, Rgb)> {
        let (index, probability, _) = self.choice.sample(choice_number(u, d));
        let emitter = match self.moved.get(&index) {
            Some(moved) => moved,
            None => &scene.emitters().emitters()[index],
        };
        let share_of_all = share / f64::from(probability);
        match emitter {
            Emitter::EnvironmentMap(sky) => {
                let sample = sky.map.sample([u[1], u[2]], false);
                return self.begin_in_sky(
                    (&sky.ball, sky.portals.as_deref()),
                    sample,
                    [d[0], d[1]],
                    u[3],
                    share_of_all,
                );
            }
            Emitter::Distant(light) => {
                let sample = light.sample_direction([u[1], u[2]]);
                return self.begin_in_sky((&light.ball, None), sample, [d[0], d[1]], u[3], share_of_all);
            }
            _ => {}
        }
        let departure = emitter.sample_departure([u[1], u[2]]);
        let p = departure.point.p;
        // The direction, and the ratio of the density of the plain choice of directions to the density with which it was
        // sampled.
        let (direction, ratio) = match self.aim(p, u[3], [d[0], d[1]], solid_angle(emitter)) {
            Some((direction, pdf)) => {
                let plain = match (departure.normal, emitter) {
                    (_, Emitter::Web(emitter)) => emitter.pdf_of_direction(direction),
                    (Some(normal), _) => f64::from(direction.dot(normal)).max(0.0) / PI,
                    (None, Emitter::Directed(emitter)) => emitter.distribution.pdf(direction),
                    (None, _) => 0.25 / PI,
                };
                (direction, plain / pdf)
            }
            None => match (departure.normal, emitter) {
                (_, Emitter::Web(emitter)) => (emitter.sample_direction([d[0], d[1]], [u[1], u[2]]), 1.0),
                (Some(normal), _) => (Frame::from_normal(normal).to_world(warps::cosine_hemisphere([d[0], d[1]])), 1.0),
                (None, Emitter::Directed(emitter)) => (emitter.distribution.sample([d[0], d[1]], [u[1], u[2]]), 1.0),
                (None, _) => (warps::uniform_sphere([d[0], d[1]]), 1.0),
            },
        };
        if ratio <= 0.0 {
            return None;
        }
        let origin = departure.normal.map_or(p, |normal| departure.point.offset(normal));
        let power = emitter.power_from(&departure) * (ratio * share_of_all);
        Some((Ray::new(origin, direction.normalize()).at_time(self.time), Rgb::from_f64(power)))
    }

    /// [`Emission::begin`] for light from infinity that varies by direction: the direction is chosen first, with this density and
    /// radiance, then the place on the disk across it or in one of the portals, by `d` and, for one of the shadows of the balls that photons are aimed at,
    /// `choice`.
    fn begin_in_sky(
        &self,
        (sky, portals): (&InfiniteBall, Option<&Portals>),
        (from, pdf, radiance): (Vec3, f32, Rgb),
        d: [f32; 2],
        choice: f32,
        share: f64,
    ) -> Option<(Ray, Rgb)> {
        if pdf.is_nan() || pdf <= 0.0 {
            return None;
        }
        let disk = f64::from(sky.radius()) * f64::from(sky.radius());
        let (offset, area) = if let (Some(portals), true) = (portals, self.balls.is_empty()) {
            let passed = portals.passed(from, d, choice);
            let offset = passed.map_or_else(|| sky.disk(d), |p| sky.offset_of(from, p));
            let on_line = sky.photon_start(from, offset);
            let is_in_disk = f64::from(offset[0]).hypot(f64::from(offset[1])) <= f64::from(sky.radius());
            let plain = if passed.is_none() || is_in_disk { 1.0 / (PI * disk) } else { 0.0 };
            (offset, 1.0 / (PI * portals.density(from, on_line, plain, passed.is_some())))
        } else if self.balls.is_empty() {
            (sky.disk(d), disk)
        } else {
            let shadow = |ball: &Ball| ball.radius * ball.radius;
            let area: f32 = self.balls.iter().map(shadow).sum();
            let ball = &self.balls[chosen_by(self.balls.iter().map(shadow), choice * area)];
            let (middle, radius) = (sky.offset_of(from, ball.centre), ball.radius);
            let [x, y] = warps::uniform_disk(d);
            let offset = [middle[0] + radius * x, middle[1] + radius * y];
            let holds = |ball: &&Ball| {
                let [x, y] = sky.offset_of(from, ball.centre);
                (offset[0] - x).hypot(offset[1] - y) <= ball.radius
            };
            // The one that was chosen holds the point, whatever rounding says of its edge.
            let count = self.balls.iter().filter(holds).count().max(1);
            (offset, f64::from(area) / count as f64)
        };
        let power = PI * area * share / f64::from(pdf) * radiance.to_f64();
        Some((Ray::new(sky.photon_start(from, offset), -from).at_time(self.time), Rgb::from_f64(power)))
    }

    /// The index of the emitter that [`Emission::begin`] chooses for these numbers.
    pub fn chosen(&self, u: [f32; 4], d: [f32; 4]) -> usize {
        self.choice.sample(choice_number(u, d)).0
    }

    /// A direction towards one of the balls and its density; `None` where there is nothing to aim at, or where `p` lies
    /// inside a ball, so that the ball may be hit in every direction, and where the balls fill a larger solid angle than `own`, into
    /// which the light goes by itself.
    #[inline]
    fn aim(&self, p: Vec3, choice: f32, u: [f32; 2], own: f64) -> Option<(Vec3, f64)> {
        if self.balls.is_empty() {
            return None;
        }
        let mut cones = [DirectionCone { axis: Vec3::ZERO, one_minus_cos: 0.0 }; MOST_BALLS];
        let mut total = 0.0;
        for (cone, ball) in cones.iter_mut().zip(&self.balls) {
            *cone = cone_of(p, ball)?;
            total += cone.one_minus_cos;
        }
        if 2.0 * PI * f64::from(total) > own {
            return None;
        }
        let cones = &cones[..self.balls.len()];
        // A ball is chosen by solid angle, so that the density is uniform over each cone, times the number of cones that
        // overlap.
        let chosen = chosen_by(cones.iter().map(|cone| cone.one_minus_cos), choice * total);
        let cone = cones[chosen];
        let direction = cone.sample(u);
        let count =
            cones.iter().enumerate().filter(|(index, other)| *index == chosen || other.holds(direction)).count();
        Some((direction, count as f64 / (2.0 * PI * f64::from(total))))
    }
}

/// The solid angle \[sr\] that a lamp of uneven radiant intensity would fill if its light were all as bright as at its brightest;
/// without bound for others, whose photons are aimed at whatever there is.
#[inline]
fn solid_angle(emitter: &Emitter) -> f64 {
    match emitter {
        Emitter::Directed(emitter) => emitter.distribution.flux() / emitter.distribution.peak(),
        Emitter::Web(emitter) => 1.0 / emitter.peak_share(),
        _ => f64::INFINITY,
    }
}

/// The cone in which a ball is seen from `p`; `None` where `p` lies inside the ball.
#[inline]
fn cone_of(p: Vec3, ball: &Ball) -> Option<DirectionCone> {
    DirectionCone::of_ball(p, ball.centre, ball.radius)
}

/// The number of the weight in which `left` of their sum lies, or of the last one where rounding leaves more.
#[inline]
fn chosen_by(weights: impl ExactSizeIterator<Item = f32>, mut left: f32) -> usize {
    let last = weights.len() - 1;
    for (index, weight) in weights.enumerate() {
        if left < weight {
            return index;
        }
        left -= weight;
    }
    last
}

/// The number that chooses the emitter, with more bits than a single random number has.
#[inline]
fn choice_number(u: [f32; 4], d: [f32; 4]) -> f64 {
    f64::from(u[0]) + f64::from(d[3]) * (-24_f64).exp2()
}

/// Where photons are aimed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) enum Aim {
    /// In all directions of the emitters.
    Everywhere,
    /// Only at surfaces with delta lobes, or with glossy lobes that are narrower than this width.
    AtSpecular {
        /// The width, above 0.
        narrow_below: f32,
    },
}

/// The share of an emitter's light that goes to the balls, as seen from the emitter's centre; 1 where there are no balls.
fn share_aimed(emitter: &Emitter, balls: &[Ball]) -> f64 {
    if balls.is_empty() {
        return 1.0;
    }
    if let Emitter::EnvironmentMap(EnvironmentMapEmitter { ball: sky, .. })
    | Emitter::Distant(DistantEmitter { ball: sky, .. }) = emitter
    {
        let disk = f64::from(sky.radius()) * f64::from(sky.radius());
        let shadows = balls.iter().map(|ball| f64::from(ball.radius) * f64::from(ball.radius));
        return (shadows.sum::<f64>() / disk).min(1.0);
    }
    let p = emitter.centre();
    if let Emitter::Directed(emitter) = emitter {
        let most = |ball| {
            cone_of(p, ball)
                .map_or(1.0, |cone| emitter.distribution.most_into(cone.axis, f64::from(cone.one_minus_cos)))
        };
        return balls.iter().map(most).sum::<f64>().min(1.0);
    }
    if let Emitter::Web(emitter) = emitter {
        let most =
            |ball| cone_of(p, ball).map_or(1.0, |cone| emitter.most_into(cone.axis, f64::from(cone.one_minus_cos)));
        return balls.iter().map(most).sum::<f64>().min(1.0);
    }
    let one_minus_cos = |ball| cone_of(p, ball).map_or(1.0, |cone| f64::from(cone.one_minus_cos));
    // A cone around the normal holds the share sin^2 of cosine-distributed light, and 2 (1 - cos) is no less.
    balls.iter().map(|ball| 2.0 * one_minus_cos(ball)).sum::<f64>().min(1.0)
}
