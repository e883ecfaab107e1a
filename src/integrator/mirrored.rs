//! Light samples that look for lamps in flat mirrors.
//!
//! A lamp in a flat mirror is where its image is, behind the mirror. Seen from there, the lamp is where it is, and the vertex behind the
//! mirror: a light sample for the image of a vertex, by the same choice of a lamp and with the same density, is one for the vertex by way of
//! the mirror. Bsdf samples that meet the mirror find the same light, and both are weighted by the power heuristic. By way of two mirrors, the
//! image is mirrored once more.
//!
//! Sources: Wallace, Cohen, Greenberg 1987, "A Two-Pass Solution to the Rendering Equation" (mirrors as windows to a second world); Veach
//! 1997, *Robust Monte Carlo Methods for Light Transport Simulation*, Sec. 9.2.

use super::aim::Aims;
use super::tracer::Tracer;
use super::vertex::{PreviousBounce, Vertex};
use crate::emitter::Receiver;
use crate::math::Ray;
use crate::sampling::mis::power_heuristic;
use crate::scene::{FlatMirrors, Scene};
use crate::spectrum::Spectrum;

/// Most mirrors on the way to a lamp that light samples look for.
pub(super) const MOST_MIRRORS: u32 = 2;

/// The way that must be clear for a light sample to count.
pub(super) enum Way {
    Straight(Ray),
    /// By one or two mirrors.
    ByMirrors(Folded),
}

/// A way by mirrors: to the first of them, from there to the second if there is one, and to the lamp.
#[derive(Clone, Copy)]
pub(super) struct Folded {
    first: Ray,
    between: Option<Ray>,
    last: Ray,
}

impl Folded {
    /// Its rays, in the order in which a path would take them.
    #[inline]
    pub fn rays(&self) -> [Option<Ray>; MOST_MIRRORS as usize + 1] {
        [Some(self.first), self.between, Some(self.last)]
    }
}

/// Probability with which a light sample looks for a lamp in a mirror as well. Their light is a small part of all: in the report's room
/// and among mirrors and glass, looking each time, or each tenth time, takes longer to the same error.
const CHANCE: f32 = 0.25;

/// Whether a light sample with these numbers, uniform in [0, 1)^4, looks for a lamp in a mirror as well, and by which numbers. Its last number
/// is of no use but among very many lamps.
#[inline(always)]
pub(super) fn chosen([a, b, c, d]: [f32; 4]) -> Option<[f32; 4]> {
    (d < CHANCE).then_some([a, b, c, d / CHANCE])
}

/// Share of these samples that look for a lamp by way of two mirrors, where there are two.
const SHARE_BY_TWO: f32 = 0.25;

/// The mirrors that a light sample looks into.
struct Choice {
    /// The planes in the order in which a path would meet them.
    first: usize,
    second: Option<usize>,
    probability: f32,
    /// What is left of the random number, uniform in [0, 1).
    digits: f32,
}

impl Choice {
    /// `u`: uniform in [0, 1).
    #[inline]
    fn new(mirrors: &FlatMirrors, u: f32) -> Self {
        let count = mirrors.count();
        let by_one = probability(mirrors, 1) * count as f32;
        if u < by_one || count == 1 {
            let scaled = u / by_one * count as f32;
            let first = (scaled as usize).min(count - 1);
            return Self { first, second: None, probability: probability(mirrors, 1), digits: scaled - first as f32 };
        }
        let pairs = count * (count - 1);
        let scaled = (u - by_one) / (1.0 - by_one) * pairs as f32;
        let pair = (scaled as usize).min(pairs - 1);
        let (first, other) = (pair / (count - 1), pair % (count - 1));
        let second = Some(other + usize::from(other >= first));
        Self { first, second, probability: probability(mirrors, 2), digits: scaled - pair as f32 }
    }
}

/// Probability with which a light sample that looks into mirrors looks by way of these one or two.
#[inline]
fn probability(mirrors: &FlatMirrors, met: u32) -> f32 {
    let count = mirrors.count() as f32;
    match (met, mirrors.count()) {
        (1, 1) => 1.0,
        (1, _) => (1.0 - SHARE_BY_TWO) / count,
        _ => SHARE_BY_TWO / (count * (count - 1.0)),
    }
}

/// Looks for a lamp by way of one or two mirrors, as one of `samples`: the way that must be clear, and the radiance that is then scattered
/// back along the path; `None` where it is 0, or more than `most` mirrors were chosen. `aims`: what another ray of the vertex is aimed at.
#[inline(never)]
pub(super) fn sample<C: Spectrum>(
    vertex: &Vertex<'_, C>,
    scene: &Scene,
    (mirrors, most): (&FlatMirrors, u32),
    aims: Option<&Aims>,
    u: [f32; 4],
    samples: u32,
) -> Option<(Folded, C)> {
    let Choice { first, second, probability, digits } = Choice::new(mirrors, u[3]);
    if second.is_some() && most < 2 {
        return None;
    }
    let point = &vertex.surface.point;
    let in_first = mirrors.image(first, vertex.receiver());
    let image = second.map_or(in_first, |second| mirrors.image(second, in_first));
    let light = scene.emitters().sample_for(image, point.time, [u[0], u[1], u[2], digits], true)?;
    // What a path from the camera cannot meet is not shown in mirrors either.
    if light.is_delta {
        return None;
    }
    let from_first = second.map_or(light.wi, |second| mirrors.turn(second, light.wi));
    let w = mirrors.turn(first, from_first);
    let local = vertex.consistent(w)?;
    // From behind: in the first mirror the place in the second is seen, where there is one.
    let at_second = match second {
        Some(second) => Some(mirrors.between(second, in_first.p, light.target)?),
        None => None,
    };
    let seen = at_second.as_ref().map_or(light.target, |place| place.offset());
    let at_first = mirrors.between(first, point.p, seen)?;
    let (f, mut own) = vertex.f_pdf(local);
    if f == C::ZERO {
        return None;
    }
    if let Some(aims) = aims {
        own += aims.pdf(point.p, vertex.facing(), w);
    }
    let pdf = light.pdf * (CHANCE * probability * samples as f32);
    let mut reflectance = at_first.reflectance::<C>(scene, w, &vertex.wavelengths);
    if let Some(place) = &at_second {
        reflectance *= place.reflectance::<C>(scene, from_first, &vertex.wavelengths);
    }
    let radiance = scene.emitters().in_spectrum::<C>(light.emitter, light.radiance, &vertex.wavelengths);
    let sent = f * radiance * reflectance * (local.z.abs() * power_heuristic(pdf, own) / pdf);
    if sent == C::ZERO {
        return None;
    }
    let way = Folded {
        first: point.leave_to(vertex.side(w), at_first.offset()),
        between: at_second.as_ref().map(|place| at_first.leave_to(place.offset(), point.time)),
        last: at_second.as_ref().unwrap_or(&at_first).leave_to(light.target, point.time),
    };
    Some((way, sent))
}

/// The bounce with this density from a receiver to the mirror where the path has arrived, as the receiver's image would have made it.
/// `met`: the number of mirrors on the way, this one included, up to [`MOST_MIRRORS`].
#[inline]
pub(super) fn previous<C: Spectrum>(
    vertex: &Vertex<'_, C>,
    mirrors: &FlatMirrors,
    (receiver, pdf): (Receiver, f32),
    met: u32,
) -> PreviousBounce {
    if met > 1 && mirrors.count() == 1 {
        return None;
    }
    let plane = mirrors.plane_of(vertex.hit()?)?;
    // Over the probability of the choice, in place of that of one mirror less.
    let before = if met == 1 { CHANCE.recip() } else { probability(mirrors, met - 1) };
    Some((mirrors.image(plane, receiver), pdf * (before / probability(mirrors, met))))
}

/// Whether light samples look for lamps in the mirror that a vertex is.
#[inline]
pub(super) fn is_looked_at<C: Spectrum>(scene: &Scene, vertex: &Vertex<'_, C>) -> bool {
    let of = |mirrors: &FlatMirrors| mirrors.plane_of(vertex.hit()?);
    scene.flat_mirrors().and_then(of).is_some()
}

/// Hands over what is sent along each of the ways to lamps by flat mirrors that are clear, and empties their list. `shadows` and `clear` are
/// memory for the rays.
#[cold]
#[inline(never)]
pub(super) fn unoccluded_by_mirrors<A, T: Tracer>(
    tracer: &mut T,
    ways: &mut Vec<(Folded, A)>,
    shadows: &mut Vec<Ray>,
    clear: &mut Vec<bool>,
    mut arrive: impl FnMut(&A),
) {
    for leg in 0..=MOST_MIRRORS as usize {
        let ray = |way: &Folded| way.rays()[leg];
        shadows.clear();
        shadows.extend(ways.iter().filter_map(|(way, _)| ray(way)));
        clear.resize(shadows.len(), false);
        tracer.unoccluded_many(shadows, clear);
        let mut answers = clear.iter();
        ways.retain(|(way, _)| ray(way).is_none() || answers.next().is_some_and(|clear| *clear));
    }
    ways.iter().for_each(|(_, arrival)| arrive(arrival));
    ways.clear();
}
