//! Chooses the photon method or path tracing that suits a scene.

use std::f64::consts::PI;

use super::super::media::{arrive, left_after};
use super::super::vertex::Vertex;
use super::super::{SceneTracer, check_support};
use super::division::{Division, NARROW, shares};
use super::emit::{Aim, Emission};
use crate::desc::{IntegratorDesc, PhotonSharing};
use crate::emitter::Emitter;
use crate::error::Result;
use crate::sampling::Rng;
use crate::scene::Scene;
use crate::spectrum::{LUMINANCE_WEIGHTS, Rgb, luminance};

/// The chosen integrator and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// One of path, caustic and sppm.
    pub integrator: IntegratorDesc,
    /// One sentence without a full stop.
    pub why: String,
}

impl Choice {
    /// The choice where light is kept apart by how often it was scattered, which paths alone count.
    #[must_use]
    pub(crate) fn for_light_parts(self) -> Self {
        let apart = "light is kept apart by how often it was scattered";
        let why = match self.integrator {
            IntegratorDesc::Path => format!("{apart}, and {}", self.why),
            other => format!("{apart}; without its layers it would be {}, since {}", other.name(), self.why),
        };
        Self { integrator: IntegratorDesc::Path, why }
    }
}

/// Least share of the sphere of directions that a lamp fills, as seen from a diffuse point, for paths to find the lamp often
/// enough by chance: paths that reach it through glass are then not much noisier than others.
const LARGE: f64 = 1e-3;

/// Least share of the caustics' power that has to come from smaller lamps for photons to be worth their time.
const WORTH: f64 = 0.02;

/// Greatest share of the light that may leave a scene which counts as closed.
const OPEN: f64 = 0.25;

/// Number of light paths that are traced for the choice.
const LOOKS: u64 = 1024;

/// Chooses among path tracing, path tracing with a caustic map, and stochastic progressive photon mapping.
///
/// Photons are worth their time where light reaches diffuse surfaces by mirrors and glass from lights so small that paths
/// hardly ever find them that way. Indirect light then comes from photons too if the scene is closed, so that photons stay
/// in it. In an open scene most photons would be lost, and paths gather the indirect light instead.
pub fn choose(scene: &Scene) -> Choice {
    let choice = |integrator, why: String| Choice { integrator, why };
    let lobes = scene.lobes();
    if scene.has_motion() {
        return choice(IntegratorDesc::Path, "something moves, and photons of a pass show one moment".to_owned());
    }
    if scene.emitters().is_dark() {
        return choice(IntegratorDesc::Path, "nothing shines".to_owned());
    }
    if !scene.has_narrow(NARROW) {
        return choice(IntegratorDesc::Path, "no mirror and no glass could make caustics".to_owned());
    }
    if !lobes.have_diffuse() {
        return choice(IntegratorDesc::Path, "there is no diffuse surface for caustics to fall on".to_owned());
    }
    let is_refused = |integrator| check_support(scene, integrator).is_err();
    if [IntegratorDesc::Caustic, IntegratorDesc::Sppm].into_iter().any(is_refused) {
        return choice(IntegratorDesc::Path, "photon maps cannot hold the light of all of its surfaces".to_owned());
    }
    let Ok(seen) = look(scene) else {
        return choice(IntegratorDesc::Path, "its lights cannot be followed".to_owned());
    };
    if seen.caustic == 0.0 {
        let why = format!("none of {LOOKS} light paths sent towards mirrors and glass came to a diffuse surface");
        return choice(IntegratorDesc::Path, why);
    }
    if seen.hidden < WORTH * seen.caustic {
        let why = format!(
            "lamps fill {:.1e} of what surfaces in their caustics see, enough for paths to find them",
            seen.share
        );
        return choice(IntegratorDesc::Path, why);
    }
    let small = if seen.share > 0.0 {
        format!("lamps fill only {:.1e} of what surfaces in their caustics see", seen.share)
    } else {
        "the lamps that make caustics are points".to_owned()
    };
    let lost = 100.0 * seen.escaped;
    if seen.escaped > OPEN {
        let why = format!("{small}: paths hardly find them; {lost:.0} % of photons would leave the scene");
        return choice(IntegratorDesc::Caustic, why);
    }
    choice(IntegratorDesc::Sppm, format!("{small}: paths hardly find them; photons stay in the scene"))
}

/// Greatest share of the caustics' power that smaller lamps may make where paths are aimed at mirrors and glass, since aimed
/// paths find smaller lamps than other paths do.
const WORTH_AIMED: f64 = 0.1;

/// Whether lamps are so large that paths aimed at mirrors and glass find them there. Paths cannot hit point lights by
/// chance. Where no light path finds a caustic, there is none to be mapped.
pub(super) fn aimed_paths_find_caustics(scene: &Scene) -> Result<bool> {
    if scene.emitters().point_lights() > 0 {
        return Ok(false);
    }
    let seen = look(scene)?;
    Ok(seen.hidden <= WORTH_AIMED * seen.caustic)
}

/// Statistics of the light paths.
struct Seen {
    /// Power that came to diffuse parts of surfaces by mirrors and glass only, in any unit. Where a surface is both, its mirror
    /// or glass passes its share of the power on.
    caustic: f64,
    /// The part of this power that comes from lamps too small to be found by chance.
    hidden: f64,
    /// Share of the sphere of directions that lamps fill, as seen from where their caustics fall: the mean weighted by
    /// power.
    share: f64,
    /// Share of the light paths that left the scene.
    escaped: f64,
}

/// Greatest number of successive mirrors and glass surfaces through which light is followed.
const MOST_HITS: u32 = 16;

fn look(scene: &Scene) -> Result<Seen> {
    let mut seen = Seen { caustic: 0.0, hidden: 0.0, share: 0.0, escaped: 0.0 };
    let areas = areas(scene.emitters().emitters());
    let division = Division::<Rgb>::new(scene, NARROW, &());
    let mut tracer = SceneTracer::new(scene);
    let begin = |emission: &Emission, rng: &mut Rng| emission.begin(scene, rng.next_4d(), rng.next_4d(), 1.0);
    // The light paths are aimed at specular surfaces, so that small glass is not missed.
    if let Some(emission) = Emission::new(scene, PhotonSharing::Power, Aim::AtSpecular { narrow_below: NARROW })? {
        for path in 0..LOOKS {
            let mut rng = Rng::new(0x6c6f_6f6b, path);
            let (u, d) = (rng.next_4d(), rng.next_4d());
            let Some((mut ray, mut power)) = emission.begin(scene, u, d, 1.0) else { continue };
            let mut way = 0.0;
            let mut media = scene.media_at(&ray);
            for hits in 0..MOST_HITS {
                let Some(hit) = arrive(scene, &mut tracer, &ray, &mut media) else { break };
                if media.is_some() {
                    power *= left_after::<Rgb>(scene, &ray, Some(&hit), media, &());
                }
                way += f64::from(hit.t);
                let mut slot = None;
                let vertex = Vertex::<Rgb>::of_light_path(scene, &ray, &hit, (), media, &mut slot);
                let mut apart = None;
                let divided = division.at(&vertex, &mut apart);
                let mut slots = [None, None, None];
                let parts = divided.parts(&vertex, &mut slots);
                let scattered = shares(parts);
                if hits > 0 && scattered[0] > 0.0 {
                    // A caustic shows as far as the diffuse part makes up the surface.
                    let shown = scattered[0] / scattered.iter().sum::<f32>();
                    let power = f64::from(shown * luminance(power));
                    // From the diffuse point, the lamp fills its area over the squared path length, of which a quarter
                    // faces the point.
                    let area = areas[emission.chosen(u, d)];
                    let share = (0.25 * area / (4.0 * PI * way * way)).min(1.0);
                    seen.caustic += power;
                    seen.hidden += if share < LARGE { power } else { 0.0 };
                    seen.share += power * share;
                }
                // The narrow part scatters its share of the power, as if it alone were the surface.
                let Some(vertex) = parts[2] else { break };
                let Some(bounce) = vertex.sample_bounce(rng.next_4d()) else { break };
                power *= bounce.weight;
                ray = bounce.ray;
                media = vertex.media_beyond(scene, &ray);
            }
        }
    }
    if seen.caustic > 0.0 {
        seen.share /= seen.caustic;
    }
    if let Some(emission) = Emission::new(scene, PhotonSharing::Power, Aim::Everywhere)? {
        let mut escaped = 0_u32;
        for path in 0..LOOKS {
            let mut rng = Rng::new(0x6c65_6176, path);
            let Some((mut ray, _)) = begin(&emission, &mut rng) else { continue };
            let mut media = scene.media_at(&ray);
            for _ in 0..MOST_HITS {
                let Some(hit) = arrive(scene, &mut tracer, &ray, &mut media) else {
                    escaped += 1;
                    break;
                };
                if media.is_some() {
                    let left = left_after::<Rgb>(scene, &ray, Some(&hit), media, &()).max_element();
                    if left < 1.0 && rng.next_f32() >= left {
                        break;
                    }
                }
                let mut slot = None;
                let vertex = Vertex::<Rgb>::of_light_path(scene, &ray, &hit, (), media, &mut slot);
                let Some(bounce) = vertex.sample_bounce(rng.next_4d()) else { break };
                if rng.next_f32() >= bounce.weight.max_element().min(1.0) {
                    break;
                }
                ray = bounce.ray;
                media = vertex.media_beyond(scene, &ray);
            }
        }
        seen.escaped = f64::from(escaped) / LOOKS as f64;
    }
    Ok(seen)
}

/// For each emitter, the area of all emitters that are at least half as bright, except points. A lamp of many triangles acts
/// as one lamp for paths, and so do many lamps of a kind; but a large dim panel does not make a small bright lamp any easier
/// to find.
fn areas(emitters: &[Emitter]) -> Vec<f64> {
    let radiance = |emitter: &Emitter| match emitter {
        emitter if emitter.is_point() => f64::INFINITY,
        _ => emitter.power().dot(LUMINANCE_WEIGHTS.to_f64()) / emitter.area(),
    };
    let mut order: Vec<(f64, usize)> = emitters.iter().map(radiance).zip(0..).collect();
    order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let mut areas = vec![0.0; emitters.len()];
    let (mut sum, mut next) = (0.0, 0);
    for &(brightness, index) in &order {
        while let Some(&(other, place)) = order.get(next)
            && other >= 0.5 * brightness
        {
            // Points add no area, since paths cannot hit point lights by chance.
            sum += emitters[place].area();
            next += 1;
        }
        areas[index] = if brightness.is_finite() { sum } else { 0.0 };
    }
    areas
}
