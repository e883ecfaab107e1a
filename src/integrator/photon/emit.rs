//! Where photons come from: the emitters' shares, places and directions.
//!
//! An emitter is chosen mostly in proportion to its power, a place on it by area, a direction by the cosine (from a point
//! all around), so that all photons carry the same but for the colour. Caustic photons may be aimed instead: at balls
//! that hold all specular surfaces. What is left out then could not have made a caustic, and each photon carries what its
//! direction would have had anyway, so the map is as before, of more photons.
//!
//! Sources: Jensen 2001, *Realistic Image Synthesis Using Photon Mapping*, Sec. 5.1 to 5.3 (projection maps).

use std::f64::consts::PI;

use super::aim::Cone;
use crate::desc::PhotonSharing;
use crate::emitter::Emitter;
use crate::error::{Error, Result};
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::{Distribution1D, warps};
use crate::scene::{Ball, Scene};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};

/// Most balls that photons are aimed at: each costs every aimed photon a test.
const MOST_BALLS: usize = 16;

/// Share of the aimed photons that emitters get by power alone, in case their middles see less of the balls than they do.
const BY_POWER: f64 = 0.05;

/// How light paths begin.
pub(in crate::integrator) struct Emission {
    choice: Distribution1D,
    /// What to aim at; empty where photons go everywhere.
    balls: Vec<Ball>,
}

impl Emission {
    /// How light paths of the scene begin; `None` where nothing shines, or where photons are to be aimed and there is
    /// nothing to aim at.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for points that are to share photons by area.
    pub fn new(scene: &Scene, sharing: PhotonSharing, aims: Aim) -> Result<Option<Self>> {
        let emitters = scene.emitters().emitters();
        let balls = match aims {
            Aim::Everywhere => Vec::new(),
            Aim::AtSpecular => scene.specular_balls(MOST_BALLS),
        };
        if balls.is_empty() && matches!(aims, Aim::AtSpecular) {
            return Ok(None);
        }
        let weights: Vec<f64> = match sharing {
            PhotonSharing::Power => {
                let power = |emitter: &Emitter| emitter.power().dot(LUMINANCE_WEIGHTS.to_f64());
                let seen: Vec<f64> =
                    emitters.iter().map(|emitter| power(emitter) * share_aimed(emitter, &balls)).collect();
                let (all, aimed) = (emitters.iter().map(power).sum::<f64>(), seen.iter().sum::<f64>());
                let even = if balls.is_empty() || all == 0.0 { 0.0 } else { BY_POWER * (aimed / all).max(1e-6) };
                emitters.iter().zip(seen).map(|(emitter, seen)| seen + even * power(emitter)).collect()
            }
            PhotonSharing::Area => {
                let shines = |emitter: &Emitter| emitter.power().max_element() > 0.0;
                if emitters.iter().any(|emitter| matches!(emitter, Emitter::Point { .. }) && shines(emitter)) {
                    let message = "area; points have none: expected power in a scene with point lights";
                    return Err(Error::invalid("render.photonSharing", message));
                }
                emitters.iter().map(|emitter| if shines(emitter) { emitter.area() } else { 0.0 }).collect()
            }
        };
        Ok(Distribution1D::new(&weights).map(|choice| Self { choice, balls }))
    }

    /// Begins one of `1 / share` light paths: a ray and the power that travels along it (W). `None` for one that leads
    /// nowhere, which counts all the same.
    ///
    /// `u`, `d` uniform in [0, 1)^4: the emitter, the place on it, and what is aimed at; and the direction, its first two.
    #[inline]
    pub fn begin(&self, scene: &Scene, u: [f32; 4], d: [f32; 4], share: f64) -> Option<(Ray, Rgb)> {
        let (index, probability, _) = self.choice.sample(choice_number(u, d));
        let emitter = &scene.emitters().emitters()[index];
        let departure = emitter.sample_departure([u[1], u[2]]);
        let p = departure.point.p;
        // Over the density that the plain choice of a direction has.
        let (direction, ratio) = match self.aim(p, u[3], [d[0], d[1]]) {
            Some((direction, pdf)) => {
                let plain = match departure.normal {
                    Some(normal) => f64::from(direction.dot(normal)).max(0.0) / PI,
                    None => 0.25 / PI,
                };
                (direction, plain / pdf)
            }
            None => match departure.normal {
                Some(normal) => (Frame::from_normal(normal).to_world(warps::cosine_hemisphere([d[0], d[1]])), 1.0),
                None => (warps::uniform_sphere([d[0], d[1]]), 1.0),
            },
        };
        if ratio <= 0.0 {
            return None;
        }
        let origin = departure.normal.map_or(p, |normal| departure.point.offset(normal));
        let power = emitter.power() * (ratio * share / f64::from(probability));
        Some((Ray::new(origin, direction.normalize()), Rgb::from_f64(power)))
    }

    /// The number of the emitter from which [`Emission::begin`] begins with these numbers.
    pub fn chosen(&self, u: [f32; 4], d: [f32; 4]) -> usize {
        self.choice.sample(choice_number(u, d)).0
    }

    /// A direction towards one of the balls and its density; `None` where there is nothing to aim at, or `p` is within a
    /// ball, so that all directions are as good.
    #[inline]
    fn aim(&self, p: Vec3, choice: f32, u: [f32; 2]) -> Option<(Vec3, f64)> {
        if self.balls.is_empty() {
            return None;
        }
        let mut cones = [Cone { axis: Vec3::ZERO, one_minus_cos: 0.0 }; MOST_BALLS];
        let mut total = 0.0;
        for (cone, ball) in cones.iter_mut().zip(&self.balls) {
            *cone = Cone::new(p, ball)?;
            total += cone.one_minus_cos;
        }
        let cones = &cones[..self.balls.len()];
        // By solid angle, so that the density is that of all balls together, counted as often as they overlap.
        let mut left = choice * total;
        let mut chosen = cones.len() - 1;
        for (index, cone) in cones.iter().enumerate() {
            if left < cone.one_minus_cos {
                chosen = index;
                break;
            }
            left -= cone.one_minus_cos;
        }
        let cone = cones[chosen];
        let direction = cone.sample(u);
        let count =
            cones.iter().enumerate().filter(|(index, other)| *index == chosen || other.holds(direction)).count();
        Some((direction, count as f64 / (2.0 * PI * f64::from(total))))
    }
}

/// The number that chooses the emitter, with more digits than a single one has.
#[inline]
fn choice_number(u: [f32; 4], d: [f32; 4]) -> f64 {
    f64::from(u[0]) + f64::from(d[3]) * (-24_f64).exp2()
}

/// Where photons are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrator) enum Aim {
    /// Wherever light goes.
    Everywhere,
    /// At the specular surfaces only.
    AtSpecular,
}

/// The share of an emitter's light that goes to the balls, as its middle sees it; 1 where there are none.
fn share_aimed(emitter: &Emitter, balls: &[Ball]) -> f64 {
    if balls.is_empty() {
        return 1.0;
    }
    let p = emitter.centre();
    let one_minus_cos = |ball| Cone::new(p, ball).map_or(1.0, |cone| f64::from(cone.one_minus_cos));
    // A cone around the normal holds sin^2 of a cosine's light, and 2 (1 - cos) is no less.
    balls.iter().map(|ball| 2.0 * one_minus_cos(ball)).sum::<f64>().min(1.0)
}
