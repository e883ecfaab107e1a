//! Disks and tubes that shine, against the light of their outlines.

use std::f64::consts::{PI, TAU};

use etendue::desc::{IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::emitter::{DiskEmitter, Emitter, EmitterSet, TubeEmitter};
use etendue::math::{DAffine3, DMat3, DVec3, Vec3};
use etendue::sampling::Rng;
use etendue::shape::Disk;
use etendue::spectrum::Rgb;

use super::sky::{METHODS, drawn};
use super::{aim, convergence, irradiance, lit, polygon_factor, rendered, sphere_factor, tilted};
use crate::common::scenes::mean_and_error;
use crate::record::{Case, Entry, Within};
use etendue::sampling::{Sampler as _, SobolSampler};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L64", title: "disks that shine", run: disks },
        Entry { id: "L65", title: "tubes that shine", run: tubes },
        Entry { id: "L66", title: "disks and tubes, their whole light", run: whole },
        Entry { id: "L67", title: "disks and tubes, by all methods", run: pictures },
        Entry { id: "L68", title: "choice among a thousand disks and tubes", run: many },
    ]
}

/// Sides of the polygons that stand for round outlines.
const SIDES: u32 = 20_000;

pub(super) fn turns(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..=SIDES).map(move |i| from + (to - from) * f64::from(i) / f64::from(SIDES))
}

fn disk_light(to_scene: &DAffine3) -> Emitter {
    Emitter::Disk(Box::new(DiskEmitter::new(Disk::new(DVec3::ZERO, DVec3::Z, 1.0, to_scene), Rgb::ONE)))
}

fn tube_light(to_scene: DAffine3) -> Emitter {
    Emitter::Tube(Box::new(TubeEmitter::new(to_scene, Rgb::ONE)))
}

/// The factor of the unit disk under a transform, seen from `p` with normal `n`.
pub(super) fn disk_factor(to_scene: &DAffine3, p: DVec3, n: DVec3) -> f64 {
    if to_scene.inverse().transform_point3(p).z <= 0.0 {
        return 0.0;
    }
    let rim: Vec<DVec3> =
        turns(0.0, TAU).skip(1).map(|t| to_scene.transform_point3(DVec3::new(t.cos(), t.sin(), 0.0))).collect();
    polygon_factor(p, n, &rim)
}

/// The factor of what a point sees of the outer side of the unit tube under a transform: two arcs, and the two lines between them.
pub(super) fn tube_factor(to_scene: &DAffine3, p: DVec3, n: DVec3) -> f64 {
    let own = to_scene.inverse().transform_point3(p);
    let distance = own.x.hypot(own.y);
    if distance <= 1.0 {
        return 0.0;
    }
    let (middle, half) = (own.y.atan2(own.x), (1.0 / distance).acos());
    let at = |t: f64, z: f64| to_scene.transform_point3(DVec3::new(t.cos(), t.sin(), z));
    let below = turns(middle - half, middle + half).map(|t| at(t, 0.0));
    let above = turns(middle + half, middle - half).map(|t| at(t, 1.0));
    polygon_factor(p, n, &below.chain(above).collect::<Vec<_>>())
}

pub(super) fn placed(matrix3: DMat3, translation: DVec3) -> DAffine3 {
    DAffine3 { matrix3, translation }
}

/// Stretched, sheared and mirrored.
pub(super) fn bent() -> DMat3 {
    DMat3::from_cols(DVec3::new(1.5, 0.2, 0.0), DVec3::new(0.1, -0.4, 0.3), DVec3::new(0.2, 0.3, 0.9))
}

/// Densities of samples, against those for the points where they end, and where shadow rays end.
pub(super) fn consistency(case: &mut Case, what: &str, set: &EmitterSet, p: Vec3) {
    let mut sampler = SobolSampler::new(64, u32::MAX);
    let (mut different, mut all, mut off) = (0.0_f64, 0.0_f64, 0.0_f64);
    for i in 0..case.count(2_000, 1_000_000) {
        sampler.start(1, i as u32);
        if let Some(sample) = set.sample(p, sampler.next_4d()) {
            // By solid angle: where a tube turns away, rounding of the point moves a density that is as good as infinite.
            let solid_angle = 1.0 / f64::from(sample.pdf);
            different += solid_angle * f64::from((set.pdf(0, p, sample.target) / sample.pdf - 1.0).abs());
            all += solid_angle;
            off = off.max(aim(p, sample.wi, sample.target));
        }
    }
    case.at_most(format!("{what}: density off that of the point, mean over directions"), different / all, 1e-3);
    case.at_most(format!("{what}: shadow ray off the direction, rad"), off, 1e-4);
}

fn disks(case: &mut Case) {
    // On the axis a disk covers what a ball of the same angle covers.
    for height in [1e-2, 0.3, 1.0, 30.0, 1e4] {
        let p = Vec3::new(0.1, -0.2, 0.05);
        let towards = DVec3::new(0.36, 0.48, 0.8);
        let frame = DMat3::from_cols(towards.any_orthonormal_pair().0, towards.any_orthonormal_pair().1, -towards);
        let to_scene = placed(frame, p.as_dvec3() + height * towards);
        let set = EmitterSet::new(vec![disk_light(&to_scene)]);
        for degrees in [0.0, 40.0, 80.0] {
            let exact = sphere_factor(1.0 / 1_f64.hypot(height), f64::to_radians(degrees));
            let normal = tilted(towards, degrees);
            let what = format!("{height:e} over the middle, {degrees} degrees off");
            let outline = disk_factor(&to_scene, p.as_dvec3(), normal);
            case.exact(format!("{what}: outline"), outline, exact, Within::Relative(1e-6));
            case.mean(what, irradiance(case, &set, p, normal), exact, 4e-3);
        }
    }
    let to_scene = placed(bent(), DVec3::new(0.5, 0.2, -0.1));
    let set = EmitterSet::new(vec![disk_light(&to_scene)]);
    let axis = (to_scene.matrix3.inverse().transpose() * DVec3::Z).normalize();
    for (what, p) in [
        ("beside an ellipse", DVec3::new(3.0, 1.0, 0.0) + 2.0 * axis),
        ("close to an ellipse's rim", to_scene.transform_point3(DVec3::X * 0.98) + 0.05 * axis),
        ("behind an ellipse", -2.0 * axis),
    ] {
        let receiver = p.as_vec3a();
        for normal in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z, DVec3::NEG_Z, -axis] {
            let exact = disk_factor(&to_scene, receiver.as_dvec3(), normal);
            let found = irradiance(case, &set, receiver, normal);
            let what = format!("{what}, towards {normal}");
            if exact < 1e-6 {
                case.at_most(what, found.0, 1e-6);
            } else {
                case.mean(what, found, exact, 6e-3);
            }
        }
        if what != "behind an ellipse" {
            consistency(case, what, &set, receiver);
        }
    }
    convergence(
        case,
        "disk, 0.3 over the middle",
        &EmitterSet::new(vec![disk_light(&placed(DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)), DVec3::Z * 0.3))]),
        Vec3::ZERO,
        DVec3::Z,
        1.0 / 1.09,
    );
    for (height, offset) in [(0.2, 0.0), (1.0, 0.5), (30.0, 0.0)] {
        let disk = ShapeDesc::Disk { centre: DVec3::new(offset, 0.0, height), normal: DVec3::NEG_Z, radius: 1.0 };
        let (h2, a2) = (height * height, offset * offset);
        // Source: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12.
        let exact = 0.5 * (1.0 - (h2 + a2 - 1.0) / ((h2 + a2 + 1.0).powi(2) - 4.0 * a2).sqrt());
        rendered(case, &format!("{height} below, {offset} off the axis"), &lit(0.1, 1e-3, vec![disk]), exact, 4e-3);
    }
}

fn tubes(case: &mut Case) {
    let round = |radius: f64, height: f64| {
        placed(DMat3::from_diagonal(DVec3::new(radius, radius, height)), DVec3::NEG_Z * 0.5 * height)
    };
    // An endless tube has the factor r / d for a receiver that faces it.
    for (radius, distance) in [(0.5, 1.0), (0.01, 1.0), (1.0, 1.001)] {
        let set = EmitterSet::new(vec![tube_light(round(radius, 1e5))]);
        let p = Vec3::new(distance as f32, 0.0, 0.0);
        let exact = radius / f64::from(p.x);
        let outline = tube_factor(&round(radius, 1e5), p.as_dvec3(), DVec3::NEG_X);
        case.exact(format!("endless, radius {radius} at {distance}: outline"), outline, exact, Within::Relative(1e-5));
        case.mean(
            format!("endless, radius {radius} at {distance}"),
            irradiance(case, &set, p, DVec3::NEG_X),
            exact,
            4e-3,
        );
    }
    let short = round(0.5, 1.0);
    let thin = round(0.0013, 1.2);
    let bent = placed(bent(), DVec3::new(0.5, 0.2, -0.1));
    for (what, to_scene, p) in [
        ("short, before its middle", short, DVec3::new(2.0, 0.0, 0.0)),
        ("short, 1e-4 before it", short, DVec3::new(0.5001, 0.0, 0.2)),
        ("short, beyond its end", short, DVec3::new(0.8, 0.3, 3.0)),
        ("short, far away", short, DVec3::new(3e3, 4e3, 2e3)),
        ("short, inside", short, DVec3::new(0.1, 0.2, 0.0)),
        ("short, before the open end", short, DVec3::new(0.1, 0.2, 1.0)),
        ("thin, close", thin, DVec3::new(0.02, 0.01, 0.1)),
        ("thin, beyond its end", thin, DVec3::new(0.05, 0.0, 0.7)),
        ("bent", bent, DVec3::new(2.5, 0.0, 0.0)),
        ("bent, from the other side", bent, DVec3::new(-2.5, 1.0, 1.0)),
    ] {
        let (set, p) = (EmitterSet::new(vec![tube_light(to_scene)]), p.as_vec3a());
        for normal in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::new(-0.8, 0.0, 0.6)] {
            let exact = tube_factor(&to_scene, p.as_dvec3(), normal);
            let found = irradiance(case, &set, p, normal);
            let name = format!("{what}, towards {normal}");
            if exact < 1e-9 {
                case.at_most(name, found.0, 1e-9);
            } else {
                case.mean(name, found, exact, 6e-3);
            }
        }
        if !["inside", "open end", "1e-4"].iter().any(|odd| what.contains(odd)) {
            consistency(case, what, &set, p);
        }
    }
    convergence(
        case,
        "tube, 0.02 before a thin one",
        &EmitterSet::new(vec![tube_light(thin)]),
        Vec3::X * 0.02,
        DVec3::NEG_X,
        tube_factor(&thin, DVec3::X * f64::from(0.02_f32), DVec3::NEG_X),
    );
    for (what, base, radius, height) in [("near", 0.4, 0.2, 0.6), ("long", 1.0, 0.01, 100.0)] {
        let (shape, local) =
            ShapeDesc::cylinder(DVec3::new(-0.5 * height, 0.0, base), DVec3::X, radius, height).expect("a tube");
        let mut desc = lit(0.1, 1e-3, vec![shape]);
        desc.surfaces[1].local = local;
        let exact = tube_factor(&local, DVec3::ZERO, DVec3::Z);
        rendered(case, &format!("{what} tube over a floor"), &desc, exact, 4e-3);
    }
}

/// The power, and that of photons by where they start.
fn whole(case: &mut Case) {
    let bent = placed(bent(), DVec3::ZERO);
    let flat = placed(DMat3::from_diagonal(DVec3::new(1.0, 1e-3, 2.0)), DVec3::ZERO);
    let piece = |m: &DMat3, t: f64| (t.cos() * m.y_axis - t.sin() * m.x_axis).cross(m.z_axis).length();
    let area_of_tube = |to_scene: &DAffine3| {
        const N: u32 = 1 << 20;
        (0..N).map(|i| piece(&to_scene.matrix3, TAU * (f64::from(i) + 0.5) / f64::from(N))).sum::<f64>() * TAU
            / f64::from(N)
    };
    let area_of_disk = |to_scene: &DAffine3| PI * to_scene.matrix3.x_axis.cross(to_scene.matrix3.y_axis).length();
    for (what, light, area) in [
        ("disk", disk_light(&bent), area_of_disk(&bent)),
        ("tube", tube_light(bent), area_of_tube(&bent)),
        ("flat tube", tube_light(flat), area_of_tube(&flat)),
    ] {
        case.exact(format!("{what}: area"), light.area(), area, Within::Relative(1e-9));
        case.exact(format!("{what}: power"), light.power().x, PI * area, Within::Relative(1e-9));
        let mut sampler = SobolSampler::new(65, u32::MAX);
        let count = case.count(4096, 1 << 20);
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..count {
            sampler.start(2, i as u32);
            let power = light.power_from(&light.sample_departure(sampler.next_2d())).x;
            sum += power;
            squares += power * power;
        }
        let (n, mean) = (count as f64, sum / count as f64);
        let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
        case.biased_mean(format!("{what}: power of photons"), (mean, error), PI * area, (1e-6, 2e-2));
    }
}

fn pictures(case: &mut Case) {
    let disk = ShapeDesc::Disk { centre: DVec3::new(0.3, 0.0, 1.0), normal: DVec3::NEG_Z, radius: 0.5 };
    let (tube, local) =
        ShapeDesc::cylinder(DVec3::new(-0.7, 0.2, 0.8), DVec3::new(1.0, 0.2, 0.1), 0.15, 1.4).expect("a tube");
    let stretch = DAffine3::from_scale(DVec3::new(1.0, 1.6, 1.0));
    for (what, shape, own, stretch) in [
        ("disk", disk, DAffine3::IDENTITY, DAffine3::IDENTITY),
        ("ellipse", disk, DAffine3::IDENTITY, stretch),
        ("tube", tube, local, DAffine3::IDENTITY),
        ("stretched tube", tube, local, stretch),
    ] {
        let mut desc = lit(1.0, 0.1, vec![shape]);
        desc.surfaces[1].local = own;
        desc.surfaces[1].transform = stretch;
        let to_scene = match shape {
            ShapeDesc::Disk { .. } => {
                stretch * placed(DMat3::from_diagonal(DVec3::new(0.5, -0.5, -0.5)), DVec3::new(0.3, 0.0, 1.0))
            }
            _ => stretch * own,
        };
        let factor = |p| {
            if what.contains("tube") {
                tube_factor(&to_scene, p, DVec3::Z)
            } else {
                disk_factor(&to_scene, p, DVec3::Z)
            }
        };
        by_all_methods(case, what, &desc, factor(DVec3::ZERO));
    }
}

/// The middle of a white floor, whose normal is z, by all methods.
pub(super) fn by_all_methods(case: &mut Case, what: &str, desc: &SceneDesc, exact: f64) {
    let samples = case.count(32, 1024) as u32;
    // Radiosity has inscribed triangles in place of round shapes, as large in sum but a little further away.
    for (integrator, bias) in METHODS.into_iter().chain([(IntegratorDesc::Radiosity, 2e-2)]) {
        let (mean, error) = mean_and_error(&drawn(case, desc, integrator, samples));
        case.biased_mean(format!("{what}, by {integrator:?}"), (mean, error), exact, (bias.max(1e-4), 1e-2));
    }
}

/// Transforms of a thousand slender bodies around a point above the floor, turned anyhow.
pub(super) fn thousand_places(seed: u64) -> Vec<DAffine3> {
    let mut rng = Rng::new(seed, 0);
    let mut next = |scale: f64| scale * f64::from(2.0 * rng.next_f32() - 1.0);
    let mut place = || {
        let matrix = DMat3::from_cols(
            DVec3::new(0.02 + next(0.01), next(0.01), next(0.01)),
            DVec3::new(next(0.01), 0.02 + next(0.01), next(0.01)),
            DVec3::new(next(0.03), next(0.03), 0.05 + next(0.02)),
        );
        let turn = DMat3::from_rotation_x(next(3.0)) * DMat3::from_rotation_z(next(3.0));
        placed(turn * matrix, DVec3::new(next(5.0), next(5.0), 2.0 + next(1.5)))
    };
    (0..1000).map(|_| place()).collect()
}

/// More lamps than are chosen by power.
fn many(case: &mut Case) {
    let places = thousand_places(66);
    let light =
        |(i, to_scene): (usize, &DAffine3)| if i % 2 == 0 { disk_light(to_scene) } else { tube_light(*to_scene) };
    let set = EmitterSet::new(places.iter().enumerate().map(light).collect());
    for (what, p, n) in [
        ("below", Vec3::new(0.3, 0.2, 0.0), DVec3::Z),
        ("among them", Vec3::new(1.0, -1.0, 2.0), DVec3::X),
        ("far away", Vec3::new(-60.0, 30.0, 20.0), DVec3::new(60.0, -30.0, -20.0).normalize()),
    ] {
        let factor = |(i, to_scene): (usize, &DAffine3)| match i % 2 {
            0 => disk_factor(to_scene, p.as_dvec3(), n),
            _ => tube_factor(to_scene, p.as_dvec3(), n),
        };
        let exact: f64 = places.iter().enumerate().map(factor).sum();
        case.mean(what, irradiance(case, &set, p, n), exact, 1e-2);
    }
}
