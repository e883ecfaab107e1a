//! Emitters, and the sampling of one among them.
//!
//! Area emitters emit on the side of their normal only, with the same radiance in every direction; a texture may vary it from point to
//! point, or a photometric web by direction. A surface that emits on both sides has two emitters, of which the second is found from hits on the back of the first. One
//! emitter is chosen first: among few emitters mostly in proportion to power, among many by a bound of what the receiver may get
//! from each. Then a point on it (or a direction towards it) is sampled. Every density here is per solid angle at the
//! reference point and includes the probability of the choice.

mod cie_sky;
mod directed;
mod disk;
mod distant;
mod environment;
mod environment_map;
mod hosek_wilkie;
mod infinite_ball;
mod inner_tube;
mod moving;
mod portals;
mod receiver;
mod sample;
mod sides;
mod spectra;
mod sphere;
mod spot;
mod textured;
mod textured_part;
mod textured_radiance;
mod textured_sphere;
mod tree;
mod triangle;
mod tube;
mod web;
mod web_area;

pub use cie_sky::{FormulaSky, SkyFormula};
pub use directed::{DirectedPoint, Distribution};
pub use disk::DiskEmitter;
pub use distant::DistantEmitter;
pub use environment::EnvironmentEmitter;
pub use environment_map::{EnvironmentMap, EnvironmentMapEmitter, EvenSky, Sky, SkyModel, SkyTexture};
pub use hosek_wilkie::{HosekWilkieSky, SUN_DIAMETER_DEG, solar_irradiance, solar_radiance};
pub use infinite_ball::InfiniteBall;
pub use inner_tube::InnerTubeEmitter;
pub use moving::{MovingEmitter, MovingPoint};
pub use portals::Portals;
pub use receiver::Receiver;
pub use sample::{Departure, EmitterSample};
pub use spectra::PLANCKIAN;
pub use sphere::SphereEmitter;
pub use spot::Spot;
pub use textured::{TextureCorners, TexturedTriangle};
pub use textured_part::PartRadiance;
pub use textured_radiance::TexturedRadiance;
pub use textured_sphere::{SphereTexture, TexturedSphere};
pub use triangle::TriangleEmitter;
pub use tube::TubeEmitter;
pub use web::TurnedWeb;
pub use web_area::{FlatEmitter, WebArea};

use std::f64::consts::PI;
use std::sync::Arc;

use crate::math::{DVec3, HitPoint, Vec3};
use crate::room::with_room;
use crate::sampling::Distribution1D;
use crate::shape::{Sphere, Triangle};
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb};
use crate::{Cancel, Result};
use tree::LightTree;

/// A light source in the scene frame.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A point with the same radiant intensity in all directions.
    Point {
        /// Position.
        position: Vec3,
        /// Radiant intensity [W sr^-1].
        intensity: Rgb,
    },
    /// A point whose radiant intensity varies by direction.
    Directed(Box<DirectedPoint>),
    /// A one-sided triangle.
    Triangle(TriangleEmitter),
    /// A one-sided triangle whose radiance a texture varies.
    Textured(Box<TexturedTriangle>),
    /// A sphere that emits outwards.
    Sphere(SphereEmitter),
    /// A sphere that emits outwards, whose radiance a texture varies.
    TexturedSphere(Box<TexturedSphere>),
    /// A one-sided disk.
    Disk(Box<DiskEmitter>),
    /// A cylinder without lids that emits outwards.
    Tube(Box<TubeEmitter>),
    /// A cylinder without lids that emits inwards.
    InnerTube(Box<InnerTubeEmitter>),
    /// An emitter that moves while the shutter is open.
    Moving(Box<MovingEmitter>),
    /// Light from infinity, the same from all directions.
    Environment(EnvironmentEmitter),
    /// Light from infinity that varies by direction.
    EnvironmentMap(EnvironmentMapEmitter),
    /// A disk of light at infinity, or parallel light.
    Distant(DistantEmitter),
    /// A one-sided triangle or disk that shines as a photometric web says.
    Web(Box<WebArea>),
}

impl Emitter {
    /// Emitted power \[W\]: 4 pi I of an even point light, pi L A of an area emitter. The result is in double precision,
    /// because single precision may overflow for a product of a radiance and an area.
    pub fn power(&self) -> DVec3 {
        match self {
            Self::Point { intensity, .. } => 4.0 * PI * intensity.to_f64(),
            Self::Directed(emitter) => emitter.power(),
            Self::Triangle(emitter) => emitter.power(),
            Self::Textured(emitter) => emitter.mean.power(),
            Self::Sphere(emitter) => emitter.power(),
            Self::TexturedSphere(emitter) => emitter.mean.power(),
            Self::Disk(emitter) => emitter.power(),
            Self::Tube(emitter) => emitter.power(),
            Self::InnerTube(emitter) => emitter.outer.power(),
            Self::Moving(emitter) => emitter.power(),
            Self::Environment(emitter) => emitter.power(),
            Self::EnvironmentMap(emitter) => emitter.power(),
            Self::Distant(emitter) => emitter.power(),
            Self::Web(emitter) => emitter.power(),
        }
    }

    /// Emitting area [length^2]; 0 for a point light.
    pub fn area(&self) -> f64 {
        match self {
            Self::Point { .. } | Self::Directed(_) => 0.0,
            Self::Triangle(emitter) => f64::from(emitter.triangle.area),
            Self::Textured(emitter) => f64::from(emitter.mean.triangle.area),
            Self::Sphere(emitter) => emitter.sphere.area(),
            Self::TexturedSphere(emitter) => emitter.mean.sphere.area(),
            Self::Disk(emitter) => emitter.area(),
            Self::Tube(emitter) => emitter.area(),
            Self::InnerTube(emitter) => emitter.outer.area(),
            Self::Moving(emitter) => emitter.area(),
            Self::Environment(emitter) => emitter.ball.area(),
            Self::EnvironmentMap(emitter) => emitter.ball.area(),
            Self::Distant(emitter) => emitter.ball.cross_section(),
            Self::Web(emitter) => emitter.area(),
        }
    }

    /// The shape of a triangle that emits.
    pub fn triangle(&self) -> Option<&Triangle> {
        match self {
            Self::Triangle(emitter) => Some(&emitter.triangle),
            Self::Textured(emitter) => Some(&emitter.mean.triangle),
            Self::Web(emitter) => emitter.triangle(),
            _ => None,
        }
    }

    /// The shape of a sphere that emits.
    pub fn sphere(&self) -> Option<&Sphere> {
        match self {
            Self::Sphere(emitter) => Some(&emitter.sphere),
            Self::TexturedSphere(emitter) => Some(&emitter.mean.sphere),
            _ => None,
        }
    }

    /// The unit normal of an emitter that is flat.
    pub fn normal(&self) -> Option<Vec3> {
        match self {
            Self::Disk(emitter) => Some(emitter.disk.normal().as_vec3a()),
            Self::Web(emitter) => Some(emitter.normal()),
            flat => flat.triangle().map(|triangle| triangle.normal),
        }
    }

    /// The radiance [W m^-2 sr^-1] that leaves an area emitter, or its mean where a texture varies it; of one that varies by direction
    /// that of an even one of the same power; 0 of points and light from infinity.
    pub fn mean_radiance(&self) -> Rgb {
        match self {
            Self::Triangle(emitter) => emitter.radiance,
            Self::Textured(emitter) => emitter.mean.radiance,
            Self::Sphere(emitter) => emitter.radiance,
            Self::TexturedSphere(emitter) => emitter.mean.radiance,
            Self::Disk(emitter) => emitter.radiance,
            Self::Tube(emitter) => emitter.radiance,
            Self::InnerTube(emitter) => emitter.outer.radiance,
            Self::Moving(emitter) => emitter.radiance(),
            Self::Web(emitter) => emitter.mean_radiance(),
            Self::Point { .. }
            | Self::Directed(_)
            | Self::Environment(_)
            | Self::EnvironmentMap(_)
            | Self::Distant(_) => Rgb::ZERO,
        }
    }

    /// The shape and the moments of an emitter that moves.
    pub fn moving(&self) -> Option<&MovingEmitter> {
        match self {
            Self::Moving(emitter) => Some(emitter),
            _ => None,
        }
    }

    /// Whether it is a point.
    #[inline]
    pub fn is_point(&self) -> bool {
        match self {
            Self::Point { .. } | Self::Directed(_) => true,
            Self::Moving(emitter) => matches!(**emitter, MovingEmitter::Point(_)),
            _ => false,
        }
    }

    /// Whether a texture varies its radiance.
    pub fn is_textured(&self) -> bool {
        matches!(self, Self::Textured(_) | Self::TexturedSphere(_))
    }

    /// The emitter's centre.
    pub fn centre(&self) -> Vec3 {
        match self {
            Self::Point { position, .. } => *position,
            Self::Directed(emitter) => emitter.position,
            Self::Triangle(emitter) => emitter.triangle.at(1.0 / 3.0, 1.0 / 3.0),
            Self::Textured(emitter) => emitter.mean.triangle.at(1.0 / 3.0, 1.0 / 3.0),
            Self::Sphere(emitter) => emitter.sphere.centre.as_vec3a(),
            Self::TexturedSphere(emitter) => emitter.mean.sphere.centre.as_vec3a(),
            Self::Disk(emitter) => emitter.disk.centre().as_vec3a(),
            Self::Tube(emitter) => emitter.centre().as_vec3a(),
            Self::InnerTube(emitter) => emitter.outer.centre().as_vec3a(),
            Self::Moving(emitter) => emitter.centre(),
            Self::Environment(emitter) => emitter.ball.centre(),
            Self::EnvironmentMap(emitter) => emitter.ball.centre(),
            Self::Distant(emitter) => emitter.ball.centre(),
            Self::Web(emitter) => emitter.centre(),
        }
    }

    /// The power \[W\] that all photons of the emitter together would have if each were like one that leaves from this sampled point.
    #[inline]
    pub fn power_from(&self, departure: &Departure) -> DVec3 {
        match self {
            Self::Textured(emitter) => emitter.power_from(departure.point.p),
            Self::TexturedSphere(emitter) => emitter.power_from(departure.point.p),
            Self::Tube(emitter) => emitter.power_from(departure.point.p),
            Self::InnerTube(emitter) => emitter.outer.power_from(departure.point.p),
            _ => self.power(),
        }
    }

    /// Whether its light comes from infinity, so that rays find it by meeting nothing.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Environment(_) | Self::EnvironmentMap(_) | Self::Distant(_))
    }

    /// Samples a point from which light leaves, uniformly by area, or where a texture varies the radiance by the light of its parts; `u`
    /// uniform in [0, 1)^2.
    #[inline]
    pub fn sample_departure(&self, u: [f32; 2]) -> Departure {
        match self {
            Self::Point { position, .. } => Departure { point: HitPoint::new(*position, 0.0), normal: None },
            Self::Directed(emitter) => Departure { point: HitPoint::new(emitter.position, 0.0), normal: None },
            Self::Triangle(emitter) => emitter.sample_departure(u),
            Self::Textured(emitter) => emitter.sample_departure(u),
            Self::Sphere(emitter) => emitter.sample_departure(u),
            Self::TexturedSphere(emitter) => emitter.sample_departure(u),
            Self::Disk(emitter) => emitter.sample_departure(u),
            Self::Tube(emitter) => emitter.sample_departure(u),
            Self::InnerTube(emitter) => emitter.sample_departure(u),
            Self::Moving(emitter) => emitter.sample_departure(u),
            Self::Environment(emitter) => emitter.sample_departure(u),
            Self::Web(emitter) => emitter.sample_departure(u),
            // Directions are chosen before places.
            Self::EnvironmentMap(EnvironmentMapEmitter { ball, .. }) | Self::Distant(DistantEmitter { ball, .. }) => {
                Departure { point: HitPoint::new(ball.centre(), 0.0), normal: None }
            }
        }
    }
}

/// A shadow ray to a point light ends this fraction of its length before the light, so that a surface exactly at the
/// light does not block it by rounding. 16 units of f32.
const SHADOW_END: f32 = 1.0 - 16.0 * f32::EPSILON;

/// The direction from `p` to a point of this radiant intensity; `None` where `p` is the point.
#[inline(always)]
fn sample_point(p: Vec3, position: Vec3, intensity: Rgb) -> Option<EmitterSample> {
    let to_light = position - p;
    let distance2 = to_light.length_squared();
    if distance2 <= 0.0 {
        return None;
    }
    Some(EmitterSample {
        wi: to_light / distance2.sqrt(),
        target: p + SHADOW_END * to_light,
        radiance: intensity / distance2,
        pdf: 1.0,
        emitter: 0,
        is_delta: true,
    })
}

/// Fraction of the choices by power that is uniform over the emitters.
const UNIFORM_FRACTION: f64 = 0.1;

/// Up to this many emitters are chosen by power. The choice by receiver would increase the instructions of the report's
/// room, where one lamp is four triangles, by a tenth.
const MAX_CHOSEN_BY_POWER: usize = 4;

/// From this number on, the indices of emitters do not fit the tree.
const INDEX_LIMIT: usize = 1 << 29;

/// How an emitter is chosen.
#[derive(Debug)]
enum EmitterChoice {
    /// With the same probabilities for all receivers.
    ByPower(Distribution1D),
    /// By what the receiver may get, among those that have a place. Those at infinity together are as likely as each of
    /// n + 1 equal choices would make n of them.
    ByReceiver { tree: LightTree, infinite: f32 },
}

/// All emitters of a scene with their probabilities.
#[derive(Debug, Default)]
pub struct EmitterSet {
    emitters: Vec<Emitter>,
    point_lights: usize,
    /// Numbers of those at infinity.
    infinite: Vec<u32>,
    /// `None` where there is nothing to sample.
    choice: Option<EmitterChoice>,
    /// For each emitter the number of that on the other side of its surface, or [`sides::NO_BACK`]; empty where no surface emits on both sides.
    backs: Vec<u32>,
    /// `None` where no emitter has a spectrum of its own.
    spectra: Option<Box<spectra::EmissionSpectra>>,
}

impl EmitterSet {
    /// A set of emitters. Few emitters are chosen by luminous power, with a tenth of the choices uniform over them:
    /// power does not say which of them a point sees, and a dim lamp beside a bright hidden one needs samples too. More
    /// emitters are chosen by a bound of what the receiver may get from each.
    pub fn new(emitters: Vec<Emitter>) -> Self {
        Self::cancellable(emitters, &Cancel::new()).unwrap_or_default()
    }

    /// As [`EmitterSet::new`], cancellable by `cancel`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Cancelled`].
    pub fn cancellable(emitters: Vec<Emitter>, cancel: &Cancel) -> Result<Self> {
        let mut powers = with_room(emitters.len())?;
        let weights = LUMINANCE_WEIGHTS.to_f64();
        for block in emitters.chunks(1 << 14) {
            cancel.check()?;
            powers.extend(block.iter().map(|emitter| emitter.power().dot(weights)));
        }
        let total: f64 = powers.iter().sum();
        let emitting = powers.iter().filter(|&&power| power > 0.0).count();
        let is_infinite = |&number: &usize| emitters[number].is_infinite() && powers[number] > 0.0;
        let mut infinite: Vec<u32> = (0..emitters.len()).filter(is_infinite).map(|number| number as u32).collect();
        let choice = if total > 0.0
            && total.is_finite()
            && emitting - infinite.len() > MAX_CHOSEN_BY_POWER
            && emitters.len() < INDEX_LIMIT
        {
            // What is at infinity has no place in the tree.
            infinite.iter().for_each(|&number| powers[number as usize] = 0.0);
            let share = infinite.len() as f32 / (infinite.len() as f32 + 1.0);
            Some(EmitterChoice::ByReceiver { tree: LightTree::new(&emitters, &powers, cancel)?, infinite: share })
        } else {
            let uniform = UNIFORM_FRACTION * total / emitting.max(1) as f64;
            // Powers become weights in place.
            for power in &mut powers {
                *power = if *power > 0.0 { (1.0 - UNIFORM_FRACTION) * *power + uniform } else { 0.0 };
            }
            Distribution1D::cancellable(&powers, cancel)?.map(EmitterChoice::ByPower)
        };
        let point_lights = emitters.iter().filter(|emitter| emitter.is_point()).count();
        if choice.is_none() {
            // Light that cannot be sampled is not found by chance either.
            infinite.clear();
        }
        Ok(Self { emitters, point_lights, infinite, choice, backs: Vec::new(), spectra: None })
    }

    /// Whether no emitter emits any light.
    pub fn is_dark(&self) -> bool {
        self.choice.is_none()
    }

    /// Whether they are so many that a sample is chosen among them by what the receiver may get from each.
    pub(crate) fn are_chosen_by_receiver(&self) -> bool {
        matches!(self.choice, Some(EmitterChoice::ByReceiver { .. }))
    }

    /// The emitters, in the order of their indices.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether some of them move while the shutter is open.
    pub fn has_moving(&self) -> bool {
        self.emitters.iter().any(|emitter| matches!(emitter, Emitter::Moving(_)))
    }

    /// Whether textures vary the radiance of some of them.
    pub fn has_textured(&self) -> bool {
        self.emitters.iter().any(Emitter::is_textured)
    }

    /// Whether some of them are points whose radiant intensity varies by direction.
    pub fn has_directed(&self) -> bool {
        self.emitters.iter().any(|emitter| matches!(emitter, Emitter::Directed(_)))
    }

    /// Whether some of them are surfaces whose radiance a photometric web varies by direction.
    pub fn has_web_areas(&self) -> bool {
        self.emitters.iter().any(|emitter| matches!(emitter, Emitter::Web(_)))
    }

    /// Number of point lights.
    pub fn point_lights(&self) -> usize {
        self.point_lights
    }

    /// Samples a direction from the receiver (or a point, which receives light from all sides) towards some emitter;
    /// `u` uniform in [0, 1)^4. The first number chooses the emitter. The last number supplies further digits of the
    /// choice, so that each of millions of emitters can be chosen.
    ///
    /// `None` where the sampled emitter cannot light the receiver: it contributes nothing, and the estimate stays
    /// unbiased.
    #[inline]
    pub fn sample(&self, receiver: impl Into<Receiver>, u: [f32; 4]) -> Option<EmitterSample> {
        self.sample_for(receiver.into(), 0.0, u, false)
    }

    /// As [`EmitterSet::sample`] where `beside_bsdf` is false, at a time ([`crate::math::Ray::time`]) that only emitters that move
    /// read. Otherwise the sample is one of two by multiple importance sampling, the
    /// other being of a Bsdf that finds light from infinity wherever this one does not look for it.
    #[inline]
    pub(crate) fn sample_for(
        &self,
        receiver: Receiver,
        time: f32,
        u: [f32; 4],
        beside_bsdf: bool,
    ) -> Option<EmitterSample> {
        let choice_u = f64::from(u[0]) + f64::from(u[3]) * (-24_f64).exp2();
        let (index, probability) = match self.choice.as_ref()? {
            EmitterChoice::ByPower(choice) => {
                let (index, probability, _) = choice.sample(choice_u);
                (index, probability)
            }
            EmitterChoice::ByReceiver { tree, infinite } => {
                let infinite = f64::from(*infinite);
                if choice_u < infinite {
                    let count = self.infinite.len();
                    let chosen = ((choice_u / infinite * count as f64) as usize).min(count - 1);
                    (self.infinite[chosen] as usize, infinite as f32 / count as f32)
                } else {
                    let (index, probability) = tree.sample(&receiver, (choice_u - infinite) / (1.0 - infinite))?;
                    (index, probability * (1.0 - infinite as f32))
                }
            }
        };
        self.sample_of((index as u32, probability), receiver, time, [u[1], u[2]], beside_bsdf)
    }

    /// Samples a direction from the receiver towards emitter `index`, which was chosen with this probability; `u` uniform in [0, 1)^2. The
    /// other arguments are those of [`EmitterSet::sample_for`].
    // The probability is multiplied in here, because a sample that is handed on to be changed is copied.
    #[inline(always)]
    pub(crate) fn sample_of(
        &self,
        (index, probability): (u32, f32),
        receiver: Receiver,
        time: f32,
        u: [f32; 2],
        beside_bsdf: bool,
    ) -> Option<EmitterSample> {
        let p = receiver.p;
        let mut sample = match &self.emitters[index as usize] {
            Emitter::Point { position, intensity } => sample_point(p, *position, *intensity)?,
            Emitter::Directed(emitter) => {
                let even = sample_point(p, emitter.position, emitter.intensity)?;
                let factor = emitter.distribution.factor(-even.wi);
                if factor <= 0.0 {
                    return None;
                }
                EmitterSample { radiance: even.radiance * factor, ..even }
            }
            Emitter::Triangle(emitter) => emitter.sample(p, u)?,
            Emitter::Textured(emitter) => emitter.sample(p, u)?,
            Emitter::Sphere(emitter) => emitter.sample(p, u)?,
            Emitter::TexturedSphere(emitter) => emitter.sample(p, u)?,
            Emitter::Disk(emitter) => emitter.sample(p, u)?,
            Emitter::Tube(emitter) => emitter.sample(p, u)?,
            Emitter::InnerTube(emitter) => emitter.sample(p, u)?,
            Emitter::Moving(emitter) => emitter.sample(p, u, time)?,
            Emitter::Environment(emitter) => emitter.sample(&receiver, u),
            Emitter::EnvironmentMap(emitter) => emitter.sample(&receiver, u, beside_bsdf),
            Emitter::Distant(emitter) => emitter.sample(&receiver, u),
            Emitter::Web(emitter) => emitter.sample(p, u)?,
        };
        sample.pdf *= probability;
        sample.emitter = index;
        (sample.pdf > 0.0 && sample.pdf.is_finite()).then_some(sample)
    }

    /// Probability with which [`EmitterSet::sample`] chooses emitter `index` for this receiver. The probabilities sum
    /// to 1 minus that of choices that give no emitter.
    #[inline]
    pub fn probability(&self, index: u32, receiver: impl Into<Receiver>) -> f32 {
        match &self.choice {
            None => 0.0,
            Some(EmitterChoice::ByPower(choice)) => choice.pmf(index as usize),
            Some(EmitterChoice::ByReceiver { tree, infinite }) => {
                if self.emitters[index as usize].is_infinite() {
                    let is_chosen = self.infinite.contains(&index);
                    if is_chosen { infinite / self.infinite.len() as f32 } else { 0.0 }
                } else {
                    (1.0 - infinite) * tree.probability(index as usize, &receiver.into())
                }
            }
        }
    }

    /// Density with which [`EmitterSet::sample`] for this receiver returns the direction towards the point `hit` of
    /// emitter `index`.
    #[inline]
    pub fn pdf(&self, index: u32, receiver: impl Into<Receiver>, hit: Vec3) -> f32 {
        self.pdf_at(index, receiver, hit, 0.0)
    }

    /// [`EmitterSet::pdf`] at a time ([`crate::math::Ray::time`]), which only emitters that move read.
    #[inline]
    pub(crate) fn pdf_at(&self, index: u32, receiver: impl Into<Receiver>, hit: Vec3, time: f32) -> f32 {
        let receiver = receiver.into();
        let p = receiver.p;
        let pdf = match &self.emitters[index as usize] {
            Emitter::Point { .. }
            | Emitter::Directed(_)
            | Emitter::Environment(_)
            | Emitter::EnvironmentMap(_)
            | Emitter::Distant(_) => 0.0,
            Emitter::Triangle(emitter) => emitter.pdf(p, hit),
            Emitter::Textured(emitter) => emitter.pdf(p, hit),
            Emitter::Sphere(emitter) => emitter.pdf(p),
            Emitter::TexturedSphere(emitter) => emitter.mean.pdf(p),
            Emitter::Disk(emitter) => emitter.pdf(p, hit),
            Emitter::Tube(emitter) => emitter.pdf(p, hit),
            Emitter::InnerTube(emitter) => emitter.pdf(p, hit),
            Emitter::Moving(emitter) => emitter.pdf(p, hit, time),
            Emitter::Web(emitter) => emitter.pdf(p, hit),
        };
        pdf * self.probability(index, receiver)
    }

    /// The light from infinity that varies by direction, where there is any.
    pub fn environment_map(&self) -> Option<&Arc<EnvironmentMap>> {
        self.emitters.iter().rev().find_map(|emitter| match emitter {
            Emitter::EnvironmentMap(emitter) => Some(&emitter.map),
            _ => None,
        })
    }

    /// Whether camera rays see emitter `index`, which is at infinity.
    #[inline]
    pub fn camera_sees(&self, index: u32) -> bool {
        match &self.emitters[index as usize] {
            Emitter::Environment(emitter) => emitter.visible,
            Emitter::EnvironmentMap(emitter) => emitter.visible,
            Emitter::Distant(emitter) => emitter.visible,
            _ => true,
        }
    }

    /// Number of emitters at infinity that emit.
    pub fn infinite(&self) -> usize {
        self.infinite.len()
    }

    /// Whether light comes from infinity.
    #[inline(always)]
    pub fn has_infinite(&self) -> bool {
        !self.infinite.is_empty()
    }

    /// Hands over the radiance that comes from infinity against `direction` (unit, away from the receiver), and the number
    /// of the emitter that it is of, for each emitter there.
    #[inline]
    pub fn each_infinite(&self, direction: Vec3, mut each: impl FnMut(Rgb, u32)) {
        for &number in &self.infinite {
            match &self.emitters[number as usize] {
                Emitter::Environment(emitter) => each(emitter.radiance, number),
                Emitter::EnvironmentMap(emitter) => each(emitter.map.radiance(direction), number),
                Emitter::Distant(emitter) => {
                    if let Some((radiance, _)) = emitter.seen(direction) {
                        each(radiance, number);
                    }
                }
                _ => {}
            }
        }
    }

    /// Density with which light samples beside samples of a Bsdf give this direction (unit) for this receiver and emitter `index`,
    /// which is at infinity.
    #[inline]
    pub fn pdf_infinite(&self, index: u32, receiver: impl Into<Receiver>, direction: Vec3) -> f32 {
        let receiver = receiver.into();
        match &self.emitters[index as usize] {
            Emitter::Environment(emitter) => emitter.pdf(&receiver, direction) * self.probability(index, receiver),
            Emitter::EnvironmentMap(emitter) => {
                emitter.pdf(receiver.p, direction, true) * self.probability(index, receiver)
            }
            Emitter::Distant(emitter) => {
                emitter.seen(direction).map_or(0.0, |(_, pdf)| pdf * self.probability(index, receiver))
            }
            _ => 0.0,
        }
    }

    /// Radiance that a surface with emitter `index` on its outer side sends along `wo` (unit, leaving it) from the point `p` with
    /// outward normal `ng`.
    #[inline]
    pub fn le(&self, index: u32, ng: Vec3, wo: Vec3, p: Vec3) -> Rgb {
        self.on_side(index, ng, wo).map_or(Rgb::ZERO, |shining| self.radiance(shining, wo, p))
    }

    /// The radiosity [W m^-2] that a surface with emitter `index` on its outer side emits on the side of `wo`, at the point `p` with
    /// outward normal `ng`: of one that shines evenly pi times its radiance.
    pub fn emitted_radiosity(&self, index: u32, ng: Vec3, wo: Vec3, p: Vec3) -> Rgb {
        let radiance =
            self.on_side(index, ng, wo).map_or(Rgb::ZERO, |shining| match &self.emitters[shining as usize] {
                Emitter::Web(emitter) => emitter.mean_radiance(),
                _ => self.radiance(shining, wo, p),
            });
        std::f32::consts::PI * radiance
    }

    /// Radiance that emitter `index` sends from its point `p` along `wo` (unit, leaving it), which is one of the directions into which it
    /// shines.
    #[inline]
    pub(crate) fn radiance(&self, index: u32, wo: Vec3, p: Vec3) -> Rgb {
        match &self.emitters[index as usize] {
            Emitter::Point { .. }
            | Emitter::Directed(_)
            | Emitter::Environment(_)
            | Emitter::EnvironmentMap(_)
            | Emitter::Distant(_) => Rgb::ZERO,
            Emitter::Triangle(emitter) => emitter.radiance,
            Emitter::Textured(emitter) => emitter.radiance(p),
            Emitter::Sphere(emitter) => emitter.radiance,
            Emitter::TexturedSphere(emitter) => emitter.radiance(p),
            Emitter::Disk(emitter) => emitter.radiance,
            Emitter::Tube(emitter) => emitter.radiance,
            Emitter::InnerTube(emitter) => emitter.outer.radiance,
            Emitter::Moving(emitter) => emitter.radiance(),
            Emitter::Web(emitter) => emitter.radiance(wo),
        }
    }
}
