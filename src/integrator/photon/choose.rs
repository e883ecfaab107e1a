//! Which of the methods suits a scene.

use super::super::light::Vertex;
use super::super::{SceneTracer, Tracer as _};
use crate::desc::IntegratorDesc;
use crate::emitter::Emitter;
use crate::math::Ray;
use crate::sampling::{Rng, warps};
use crate::scene::Scene;
use crate::spectrum::LUMINANCE_WEIGHTS;

/// A choice, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// One of path, caustic and sppm.
    pub integrator: IntegratorDesc,
    /// One sentence without a full stop.
    pub why: String,
}

/// Lights that take up at least this share of what a diffuse point sees are found by chance often enough: paths that reach
/// them by way of glass are then no noisier than others.
const LARGE: f64 = 4e-3;

/// Share of the light that may leave a scene which counts as closed.
const OPEN: f64 = 0.25;

/// Light paths that are looked at.
const LOOKS: u64 = 1024;

/// Chooses among path tracing, path tracing with a caustic map, and stochastic progressive photon mapping.
///
/// Photons are worth their while where light reaches diffuse surfaces by mirrors and glass from lights so small that paths
/// hardly ever find them that way. Then indirect light comes from photons too, if the scene is closed, so that they stay in
/// it; in the open most would be lost, and paths gather it instead.
pub fn choose(scene: &Scene) -> Choice {
    let choice = |integrator, why: String| Choice { integrator, why };
    let kinds = scene.kinds();
    if scene.emitters().is_dark() {
        return choice(IntegratorDesc::Path, "nothing shines".to_owned());
    }
    if !kinds.specular {
        return choice(IntegratorDesc::Path, "no mirror and no glass could make caustics".to_owned());
    }
    if !kinds.diffuse {
        return choice(IntegratorDesc::Path, "there is no diffuse surface for caustics to fall on".to_owned());
    }
    let seen = look(scene);
    if seen.specular == 0 {
        return choice(IntegratorDesc::Path, format!("none of {LOOKS} light paths met a mirror or glass first"));
    }
    if seen.share >= LARGE {
        let why = format!(
            "lights fill {:.2} % of what diffuse surfaces see, enough for paths to find them through glass and mirrors",
            100.0 * seen.share
        );
        return choice(IntegratorDesc::Path, why);
    }
    let small = if seen.share > 0.0 {
        format!("lights fill only {:.1e} of what diffuse surfaces see", seen.share)
    } else {
        "lights are points, or as good as".to_owned()
    };
    let lost = 100.0 * seen.escaped;
    if seen.escaped > OPEN {
        let why = format!(
            "{small}, so paths do not find them by mirrors and glass; {lost:.0} % of photons would leave the scene"
        );
        return choice(IntegratorDesc::Caustic, why);
    }
    choice(
        IntegratorDesc::Sppm,
        format!("{small}, so paths do not find them by mirrors and glass; photons stay in the scene"),
    )
}

/// What light paths show.
struct Seen {
    /// Those that met something specular first.
    specular: u64,
    /// Share of those that left the scene sooner or later.
    escaped: f64,
    /// Share of the sphere of directions that the lights fill, from where their light falls; in the mean by power.
    share: f64,
}

fn look(scene: &Scene) -> Seen {
    let emitters = scene.emitters().emitters();
    let powers: Vec<f64> = emitters.iter().map(|emitter| emitter.power().dot(LUMINANCE_WEIGHTS.as_dvec3())).collect();
    let total: f64 = powers.iter().sum();
    let mut tracer = SceneTracer::new(scene);
    let (mut specular, mut escaped, mut paths) = (0, 0, 0);
    // The distance over which light travels before it falls on something, squared.
    let (mut reach2, mut reached) = (0.0, 0_u32);
    // By power: the emitters in proportion to it, evenly spaced.
    let mut index = 0;
    let mut below = 0.0;
    for path in 0..LOOKS {
        let at = (path as f64 + 0.5) / LOOKS as f64 * total;
        while index + 1 < emitters.len() && below + powers[index] < at {
            below += powers[index];
            index += 1;
        }
        let mut rng = Rng::new(0x6c6f_6f6b, path);
        let departure = emitters[index].sample_departure(rng.next_2d());
        let u = rng.next_2d();
        let mut ray = match departure.normal {
            Some(normal) => {
                let direction = crate::math::Frame::from_normal(normal).to_world(warps::cosine_hemisphere(u));
                Ray::new(departure.point.offset(normal), direction)
            }
            None => Ray::new(departure.point.p, warps::uniform_sphere(u)),
        };
        paths += 1;
        for depth in 0..16 {
            let Some(hit) = tracer.intersect(&ray) else {
                escaped += 1;
                break;
            };
            let vertex = Vertex::new(scene, &ray, &hit);
            if depth == 0 {
                specular += u64::from(vertex.material.bsdf.is_delta());
                reach2 += f64::from(hit.t) * f64::from(hit.t);
                reached += 1;
            }
            let Some(bounce) = vertex.sample_bounce(rng.next_4d()) else { break };
            if rng.next_f32() >= bounce.weight.max_element().min(1.0) {
                break;
            }
            ray = bounce.ray;
        }
    }
    // Paths find all lights together: each fills its area over the squared distance, of which half the directions and half the
    // cosine face it.
    let area: f64 = emitters.iter().map(Emitter::area).sum();
    let reach2 = if reached > 0 { reach2 / f64::from(reached) } else { f64::INFINITY };
    Seen {
        specular,
        escaped: escaped as f64 / paths as f64,
        share: (0.25 * area / (reach2 * 4.0 * std::f64::consts::PI)).min(1.0),
    }
}
