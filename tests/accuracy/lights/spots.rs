//! Spot lights: irradiance and power against closed forms, by the samplers alone and in renders.

use std::f64::consts::{PI, TAU};

use etendue::desc::{LightDistribution, PointLightDesc, SpotDesc};
use etendue::emitter::{DirectedPoint, Distribution, Emitter, EmitterSet, Spot};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::spectrum::Rgb;

use super::{INTEGRATORS, irradiance, lit};
use crate::common::scenes::{Job, point_light, render};
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L50", title: "spot lights, at points", run: points },
        Entry { id: "L51", title: "spot lights, their whole light", run: whole },
    ]
}

/// Outer and inner angle in degrees, and what they are called.
const SPOTS: [(f64, f64, &str); 7] = [
    (45.0, 0.0, "45 degrees, all edge"),
    (30.0, 20.0, "30 degrees, an edge of 10"),
    (90.0, 60.0, "a hemisphere, an edge of 30"),
    (180.0, 100.0, "all around, an edge of 80"),
    (20.0, 20.0, "20 degrees, a hard edge"),
    (1.0, 0.5, "1 degree"),
    (180.0, 180.0, "all around, even"),
];

/// A direction of no axis.
const AXIS: DVec3 = DVec3::new(2.0 / 7.0, -6.0 / 7.0, 3.0 / 7.0);

/// The factor at so many degrees from the axis.
pub fn factor(outer: f64, inner: f64, angle: f64) -> f64 {
    let [outer, inner, cos] = [outer, inner, angle].map(|degrees: f64| degrees.to_radians().cos());
    if cos >= inner {
        1.0
    } else if cos <= outer {
        0.0
    } else {
        ((cos - outer) / (inner - outer)).powi(2)
    }
}

/// The integrals of the factor, and of the factor times the cosine from the axis, over the sphere.
pub fn integrals(outer: f64, inner: f64) -> [f64; 2] {
    let [outer, inner] = [outer, inner].map(|degrees: f64| degrees.to_radians().cos());
    let edge = inner - outer;
    let light = 1.0 - inner + edge / 3.0;
    let along = 0.5 * (1.0 - inner * inner) + edge * (outer / 3.0 + edge / 4.0);
    [TAU * light, TAU * along]
}

pub fn spot_light(position: DVec3, direction: DVec3, (outer_deg, inner_deg): (f64, f64)) -> PointLightDesc {
    let distribution = LightDistribution::Spot(SpotDesc { direction, outer_deg, inner_deg });
    PointLightDesc { distribution, ..point_light(position, 1.0) }
}

fn emitter(position: DVec3, axis: DVec3, (outer, inner): (f64, f64), intensity: f32) -> Emitter {
    let distribution = Distribution::Spot(Spot::new(axis, inner.to_radians(), outer.to_radians()));
    Emitter::Directed(Box::new(DirectedPoint {
        position: position.as_vec3a(),
        intensity: Rgb::splat(intensity),
        distribution,
    }))
}

/// A unit direction so many degrees from a unit axis.
pub fn turned(axis: DVec3, degrees: f64) -> DVec3 {
    let across = axis.any_orthonormal_vector();
    let (sin, cos) = degrees.to_radians().sin_cos();
    cos * axis + sin * across
}

fn points(case: &mut Case) {
    for (outer, inner, name) in SPOTS {
        for share in [0.0, 0.3, 0.6, 0.9, 0.99, 1.01] {
            let angle = share * outer;
            if angle > 180.0 {
                continue;
            }
            let expected = factor(outer, inner, angle);
            let away = turned(AXIS, angle);
            let set = EmitterSet::new(vec![emitter(-2.0 * away, AXIS, (outer, inner), 4.0)]);
            let (mean, _) = irradiance(case, &set, Vec3::ZERO, -away);
            // A direction of single precision is off by some 10^-7, and so is its share of a narrow edge.
            let digits = 1e-5 + 1e-6 / outer.to_radians();
            case.exact(format!("{name}, {share} of the way out"), mean * PI, expected, Within::Absolute(digits));
        }
    }
    // Many spot lights, of which some miss the receiver: they are chosen by a tree.
    let mut lights = Vec::new();
    let mut exact = 0.0;
    for (place, (outer, inner, _)) in SPOTS.into_iter().cycle().take(21).enumerate() {
        let around = TAU * place as f64 / 21.0;
        let position = DVec3::new(3.0 * around.cos(), 1.0 + 0.1 * place as f64, 3.0 * around.sin());
        let axis = turned(-position.normalize(), [0.4, 0.7, 1.2][place % 3] * outer);
        lights.push(emitter(position, axis, (outer, inner), 1.0));
        let angle = axis.angle_between(-position).to_degrees();
        exact += factor(outer, inner, angle) * position.y / position.length().powi(3);
    }
    let (mean, error) = irradiance(case, &EmitterSet::new(lights), Vec3::ZERO, DVec3::Y);
    case.mean("21 of them", (mean * PI, error * PI), exact, 5e-3);
    // A floor by each method, which has no variance but for the footprint.
    for (outer, inner, name) in SPOTS {
        for share in [0.3, 0.8] {
            let up = DVec3::new(0.6, 0.0, 0.8);
            let mut desc = lit(0.1, 1e-3, vec![]);
            desc.lights.push(spot_light(2.0 * up, turned(-up, share * outer), (outer, inner)));
            let exact = factor(outer, inner, share * outer) * 0.8 / 4.0 / PI;
            for (whose, integrator) in INTEGRATORS {
                let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
                let (image, _) = render(&desc, &job);
                let within = Within::Relative(1e-4 + 2e-6 / outer.to_radians());
                case.exact(format!("a floor, {name}, {share} of the way out, {whose}"), image.mean()[0], exact, within);
            }
        }
    }
}

fn whole(case: &mut Case) {
    let tries = case.count(1 << 16, 1 << 21) as u32;
    for (outer, inner, name) in SPOTS {
        let [light, along] = integrals(outer, inner);
        let it = emitter(DVec3::ZERO, AXIS, (outer, inner), 3.0);
        case.exact(format!("{name}: power"), it.power().x, 3.0 * light, Within::Relative(1e-5));
        let Emitter::Directed(point) = it else { unreachable!() };
        let distribution = &point.distribution;
        let mut rng = Rng::new(51, 0);
        let directions: Vec<DVec3> =
            (0..tries).map(|_| distribution.sample(rng.next_2d(), rng.next_2d()).as_dvec3()).collect();
        // From 1, so that narrow cones tell.
        let off: Vec<f64> = directions.iter().map(|d| 1.0 - d.dot(AXIS)).collect();
        case.mean(format!("{name}: 1 - cos of its directions"), stats::mean_and_error(&off), 1.0 - along / light, 5e-3);
        let full = directions.iter().map(|d| f64::from(u8::from(d.angle_between(AXIS).to_degrees() < inner)));
        let share = TAU * (1.0 - inner.to_radians().cos()) / light;
        if inner > 0.0 && inner < outer {
            let found = stats::mean_and_error(&full.collect::<Vec<_>>());
            case.mean(format!("{name}: share of them with the full light"), found, share, 5e-3);
        }
        // The density of directions is 1 over the sphere, by directions that are uniform in the cone.
        let size = 2.0 * (0.5 * outer.to_radians()).sin().powi(2);
        let frame = etendue::math::Frame::from_normal(AXIS.as_vec3a());
        let uniform = |_| {
            let d = frame.to_world(warps::uniform_cone(rng.next_2d(), size as f32));
            distribution.pdf(d) * TAU * size
        };
        let densities: Vec<f64> = (0..tries).map(uniform).collect();
        case.mean(format!("{name}: integral of the density"), stats::mean_and_error(&densities), 1.0, 8e-3);
    }
}
