//! Surfaces that emit on both sides.

use std::f64::consts::{PI, TAU};

use etendue::desc::{
    BsdfDesc, IntegratorDesc, KeyPlace, MeshDesc, MotionDesc, MotionKey, SceneDesc, ShapeDesc, ShutterDesc,
};
use etendue::emitter::{DiskEmitter, Emitter, EmitterSet, InnerTubeEmitter, TubeEmitter};
use etendue::math::{DAffine3, DMat3, DVec3, Vec3};
use etendue::sampling::{Sampler as _, SobolSampler};
use etendue::scene::{BuildOptions, Scene};
use etendue::shape::Disk;
use etendue::spectrum::Rgb;

use super::round::{bent, by_all_methods, consistency, disk_factor, placed, thousand_places, tube_factor, turns};
use super::sky::METHODS;
use super::{WHITE, convergence, irradiance, lit, polygon_factor, rendered};
use crate::common::scenes::{Job, box_inside, camera, mean_and_error, render, scene};
use crate::record::{Case, Entry, Within};
use crate::textures::emission;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L80", title: "lamps of both sides, over a floor", run: floors },
        Entry { id: "L81", title: "inner sides of tubes", run: inner_sides },
        Entry { id: "L82", title: "furnace of both sides", run: furnace },
        Entry { id: "L83", title: "lamps of both sides, their whole light", run: whole },
        Entry { id: "L84", title: "lamps of both sides, by all methods", run: pictures },
        Entry { id: "L85", title: "choice among a thousand backs and inner sides", run: many },
        Entry { id: "L87", title: "textured lamps of both sides", run: textured },
    ]
}

/// A scene of [`lit`] whose lamps emit on both sides.
fn lit_both(eye: f64, size: f64, lights: Vec<ShapeDesc>) -> SceneDesc {
    let mut desc = lit(eye, size, lights);
    for lamp in 1..desc.surfaces.len() {
        desc.set_emits_both(lamp, true).expect("a lamp of the test");
    }
    desc
}

/// A parallelogram over the floor, as its four corners.
fn corners() -> [DVec3; 4] {
    let (a, u, v) = (DVec3::new(-0.3, -0.6, 0.8), DVec3::new(1.1, 0.1, 0.3), DVec3::new(-0.2, 0.9, 0.1));
    [a, a + u, a + u + v, a + v]
}

/// A mesh of this quadrilateral.
fn mesh_of([a, b, c, d]: [DVec3; 4]) -> MeshDesc {
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    MeshDesc { path: "meshes[0]".into(), positions: vec![a, b, c, d], triangles, ..MeshDesc::default() }
}

fn vertical_tube(radius: f64, base: f64, height: f64) -> (ShapeDesc, DAffine3) {
    ShapeDesc::cylinder(DVec3::Z * base, DVec3::Z, radius, height).expect("a tube")
}

/// The factor of a tube of both sides that stands over the receiver: that of its lower opening without its upper one.
fn chimney(radius: f64, base: f64, height: f64) -> f64 {
    let lid = |z: f64| radius * radius / (radius * radius + z * z);
    lid(base) - lid(base + height)
}

/// The factor that both sides of the unit tube under a transform fill, seen from a point below it and beside its prolongation: the
/// outer side, and the lower opening without what is seen of the upper one through it.
fn both_sides_factor(to_scene: &DAffine3, p: DVec3, n: DVec3) -> f64 {
    let own = to_scene.inverse().transform_point3(p);
    // The upper rim on the plane of the lower one, as the point sees it.
    let t = -own.z / (1.0 - own.z);
    let middle = (1.0 - t) * own.truncate();
    let inside = |q: [f64; 2], centre: [f64; 2], radius: f64| {
        (q[0] - centre[0]).hypot(q[1] - centre[1]) <= radius * (1.0 + 1e-12)
    };
    let middle = [middle.x, middle.y];
    let upper = turns(0.0, TAU).skip(1).map(|a| [middle[0] + t * a.cos(), middle[1] + t * a.sin()]);
    let lower = turns(0.0, TAU).skip(1).map(|a| [a.cos(), a.sin()]);
    let mut lens: Vec<[f64; 2]> = upper.filter(|q| inside(*q, [0.0; 2], 1.0)).collect();
    lens.extend(lower.filter(|q| inside(*q, middle, t)));
    let opening = disk_polygon(to_scene, p, n);
    if lens.len() < 3 {
        return tube_factor(to_scene, p, n) + opening;
    }
    let count = lens.len() as f64;
    let (x, y) = lens.iter().fold((0.0, 0.0), |(x, y), q| (x + q[0] / count, y + q[1] / count));
    lens.sort_by(|a, b| (a[1] - y).atan2(a[0] - x).total_cmp(&(b[1] - y).atan2(b[0] - x)));
    let lens: Vec<DVec3> = lens.iter().map(|q| to_scene.transform_point3(DVec3::new(q[0], q[1], 0.0))).collect();
    tube_factor(to_scene, p, n) + opening - polygon_factor(p, n, &lens)
}

/// The factor of the unit disk under a transform, seen from either side.
fn disk_polygon(to_scene: &DAffine3, p: DVec3, n: DVec3) -> f64 {
    let rim: Vec<DVec3> =
        turns(0.0, TAU).skip(1).map(|t| to_scene.transform_point3(DVec3::new(t.cos(), t.sin(), 0.0))).collect();
    polygon_factor(p, n, &rim)
}

/// The factor of the inner side of the unit tube under a transform, as if it did not hide itself.
fn inner_factor(to_scene: &DAffine3, p: DVec3, n: DVec3) -> f64 {
    let own = to_scene.inverse().transform_point3(p);
    let distance = own.x.hypot(own.y);
    if distance <= 1.0 {
        let upper = *to_scene * DAffine3::from_translation(DVec3::Z);
        let [below, above] = [to_scene, &upper].map(|lid| disk_polygon(lid, p, n));
        return if (0.0..=1.0).contains(&own.z) { 1.0 - below - above } else { (below - above).abs() };
    }
    let (middle, half) = (own.y.atan2(own.x), (1.0 / distance).acos());
    let at = |t: f64, z: f64| to_scene.transform_point3(DVec3::new(t.cos(), t.sin(), z));
    let below = turns(middle + half, middle + TAU - half).map(|t| at(t, 0.0));
    let above = turns(middle + TAU - half, middle + half).map(|t| at(t, 1.0));
    polygon_factor(p, n, &below.chain(above).collect::<Vec<_>>())
}

fn inner_light(to_scene: DAffine3) -> Emitter {
    Emitter::InnerTube(Box::new(InnerTubeEmitter::new(TubeEmitter::new(to_scene, Rgb::ONE))))
}

/// Shapes whose normal points at the receiver, and away from it, with the factor of both.
fn flat_shapes() -> Vec<(&'static str, [ShapeDesc; 2], f64)> {
    let [a, b, c, d] = corners();
    let factor = |polygon: &[DVec3]| polygon_factor(DVec3::ZERO, DVec3::Z, polygon);
    let disk = |normal| ShapeDesc::Disk { centre: DVec3::new(0.5, 0.0, 1.0), normal, radius: 1.0 };
    // Source: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12, at height 1 and half a radius off the axis.
    let of_disk = 0.5 * (1.0 - 0.25 / (2.25_f64 * 2.25 - 1.0).sqrt());
    vec![
        ("triangle", [ShapeDesc::Triangle([a, c, b]), ShapeDesc::Triangle([a, b, c])], factor(&[a, b, c])),
        ("quad", [ShapeDesc::Quad([a, d, c, b]), ShapeDesc::Quad([a, b, c, d])], factor(&[a, b, c, d])),
        ("disk", [disk(DVec3::NEG_Z), disk(DVec3::Z)], of_disk),
    ]
}

fn floors(case: &mut Case) {
    for (what, shapes, exact) in flat_shapes() {
        for (side, shape) in ["front", "back"].into_iter().zip(shapes) {
            rendered(case, &format!("{what}, its {side}"), &lit_both(0.1, 1e-3, vec![shape]), exact, 4e-3);
        }
        let (image, _) = render(&lit(0.1, 1e-3, vec![shapes[1]]), &Job { resolution: [8, 8], ..Job::default() });
        case.exact(format!("{what} that emits on one side, its back"), image.mean()[0], 0.0, Within::Absolute(0.0));
    }
    let [a, b, c, d] = corners();
    let exact = polygon_factor(DVec3::ZERO, DVec3::Z, &[a, b, c, d]);
    for (what, corners) in [("front", [a, d, c, b]), ("back", [a, b, c, d])] {
        let mut desc = lit_both(0.1, 1e-3, vec![ShapeDesc::Mesh { mesh: 0, smooth: false }]);
        desc.meshes.push(mesh_of(corners).into());
        rendered(case, &format!("mesh, its {what}"), &desc, exact, 4e-3);
    }
    for (radius, base, height) in [(1.0, 0.5, 1.0), (0.2, 0.1, 3.0), (3.0, 0.5, 0.2)] {
        let (shape, local) = vertical_tube(radius, base, height);
        let mut desc = lit_both(0.1, 1e-3, vec![shape]);
        desc.surfaces[1].local = local;
        let what = format!("inner side of a tube, radius {radius}, from {base} to {}", base + height);
        rendered(case, &what, &desc, chimney(radius, base, height), 6e-3);
    }
    for (what, base, axis, radius, height) in [
        ("beside its prolongation", DVec3::new(0.7, 0.0, 0.5), DVec3::new(0.3, 0.1, 1.0), 0.4, 0.5),
        ("far beside it", DVec3::new(1.5, 0.4, 0.6), DVec3::new(-0.2, 0.1, 1.0), 0.5, 2.0),
    ] {
        let (shape, local) = ShapeDesc::cylinder(base, axis, radius, height).expect("a tube");
        let mut desc = lit_both(0.1, 1e-3, vec![shape]);
        desc.surfaces[1].local = local;
        let exact = both_sides_factor(&local, DVec3::ZERO, DVec3::Z);
        rendered(case, &format!("both sides of a tube, {what}"), &desc, exact, 6e-3);
    }
    moving(case);
}

/// A quad that moves shines on its back as on its front, the mean of its places.
fn moving(case: &mut Case) {
    let [a, b, c, d] = corners();
    let shift = DVec3::new(0.4, -0.3, 0.5);
    const PLACES: u32 = 20_000;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(PLACES) * shift;
    let factor = |i| polygon_factor(DVec3::ZERO, DVec3::Z, &[a, b, c, d].map(|corner| corner + at(i)));
    let exact = (0..PLACES).map(factor).sum::<f64>() / f64::from(PLACES);
    for (what, corners) in [("front", [a, d, c, b]), ("back", [a, b, c, d])] {
        let mut desc = lit_both(0.1, 1e-3, vec![ShapeDesc::Quad(corners)]);
        desc.set_shutter(ShutterDesc { open: 0.0, close: 1.0, ..ShutterDesc::default() }).expect("a shutter");
        let key = |time: f64| {
            let place = KeyPlace::Matrix(DAffine3::from_translation(time * shift));
            MotionKey { time, place }
        };
        desc.set_surface_motion(1, Some(MotionDesc { keys: vec![key(0.0), key(1.0)] })).expect("a motion");
        let job = Job { resolution: [8, 8], samples: case.count(2048, 8192) as u32, ..Job::default() };
        case.mean(format!("moving quad, its {what}"), mean_and_error(&render(&desc, &job).0), exact, 4e-3);
    }
}

fn inner_sides(case: &mut Case) {
    let round = |radius: f64, height: f64| {
        placed(DMat3::from_diagonal(DVec3::new(radius, radius, height)), DVec3::NEG_Z * 0.5 * height)
    };
    let (short, long) = (round(0.5, 1.0), round(0.5, 1e3));
    let bent = placed(bent(), DVec3::new(0.5, 0.2, -0.1));
    let within = bent.transform_point3(DVec3::new(0.3, -0.2, 0.6));
    for (what, to_scene, p) in [
        ("in the middle", short, DVec3::ZERO),
        ("off the axis", short, DVec3::new(0.2, 0.35, 0.1)),
        ("close to the mantle", short, DVec3::new(0.4999, 0.0, 0.2)),
        ("on the mantle", short, DVec3::new(0.5, 0.0, 0.2)),
        ("below its opening", short, DVec3::new(0.1, 0.2, -1.0)),
        ("far below its opening", short, DVec3::new(0.3, 0.2, -300.0)),
        ("beside it", short, DVec3::new(0.8, 0.3, 0.1)),
        ("in a long one", long, DVec3::new(0.1, -0.3, 3.0)),
        ("in a bent one", bent, within),
        ("beside a bent one", bent, DVec3::new(2.5, 0.0, 0.0)),
    ] {
        let (set, p) = (EmitterSet::new(vec![inner_light(to_scene)]), p.as_vec3a());
        for normal in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::new(-0.8, 0.0, 0.6)] {
            // Others see what is behind the mantle too.
            if what == "on the mantle" && normal != DVec3::NEG_X {
                continue;
            }
            let exact = inner_factor(&to_scene, p.as_dvec3(), normal);
            let found = irradiance(case, &set, p, normal);
            let name = format!("{what}, towards {normal}");
            if exact < 1e-9 {
                case.at_most(name, found.0, 1e-9);
            } else {
                case.mean(name, found, exact, 1e-2);
            }
        }
        if !what.contains("mantle") {
            consistency(case, what, &set, p);
        }
    }
    convergence(
        case,
        "inner side, off the axis",
        &EmitterSet::new(vec![inner_light(short)]),
        Vec3::new(0.2, 0.35, 0.1),
        DVec3::X,
        inner_factor(&short, Vec3::new(0.2, 0.35, 0.1).as_dvec3(), DVec3::X),
    );
}

/// A closed room of any shape, of which each side emits and reflects: Le / (1 - albedo) everywhere, whichever side the normals are on.
fn furnace(case: &mut Case) {
    let (albedo, emission) = (0.5, 0.5);
    let samples = case.count(64, 1024) as u32;
    for outwards in [false, true] {
        let mut room = box_inside(DVec3::splat(-1.0), DVec3::new(1.0, 1.5, 1.0));
        if outwards {
            room.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let wall = BsdfDesc::Lambert { albedo: Rgb::splat(albedo) };
        let walls = (ShapeDesc::Mesh { mesh: 0, smooth: false }, wall, Some(Rgb::splat(emission)));
        let mut desc = scene(camera(DVec3::new(0.3, 0.2, 0.1), DVec3::NEG_Z, 60.0), vec![walls]);
        desc.meshes.push(room.into());
        desc.set_emits_both(0, true).expect("a lamp of the test");
        let exact = f64::from(emission) / (1.0 - f64::from(albedo));
        for (integrator, bias) in
            [(IntegratorDesc::Path, 0.0_f64), (IntegratorDesc::Photon, 2e-2), (IntegratorDesc::Radiosity, 1e-2)]
        {
            let (mean, error) = mean_and_error(&super::drawn(case, &desc, integrator, samples));
            let what = format!("normals {}, by {integrator:?}", if outwards { "outwards" } else { "inwards" });
            case.biased_mean(what, (mean, error), exact, (bias.max(1e-4), 1e-2));
        }
        // From outside the emission alone is seen, by what it reflects of nothing.
        desc.camera = camera(DVec3::new(0.3, 0.2, 9.0), DVec3::ZERO, 5.0);
        let (mean, error) = mean_and_error(&super::drawn(case, &desc, IntegratorDesc::Path, samples));
        let what = format!("normals {}, from outside", if outwards { "outwards" } else { "inwards" });
        case.biased_mean(what, (mean, error), f64::from(emission), (1e-4, 1e-2));
    }
}

/// The power of all emitters of a scene, and that of photons by where they start.
fn whole(case: &mut Case) {
    let [a, b, c, d] = corners();
    let area_of_quad = (b - a).cross(d - a).length();
    let (tube, local) = vertical_tube(0.4, 0.5, 2.0);
    for (what, shape, local, area) in [
        ("triangle", ShapeDesc::Triangle([a, b, c]), DAffine3::IDENTITY, 0.5 * area_of_quad),
        ("quad", ShapeDesc::Quad([a, b, c, d]), DAffine3::IDENTITY, area_of_quad),
        ("disk", ShapeDesc::Disk { centre: DVec3::Y, normal: DVec3::Z, radius: 0.7 }, DAffine3::IDENTITY, 0.49 * PI),
        ("tube", tube, local, TAU * 0.4 * 2.0),
    ] {
        let mut desc = lit_both(0.1, 1e-3, vec![shape]);
        desc.surfaces[1].local = local;
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let emitters = scene.emitters().emitters();
        let power: f64 = emitters.iter().map(|emitter| emitter.power().x).sum();
        case.exact(format!("{what}: power"), power, 2.0 * PI * area, Within::Relative(1e-6));
        // Photons of each side leave on it.
        let mut sampler = SobolSampler::new(83, u32::MAX);
        let count = case.count(1024, 1 << 18);
        let fronts = emitters.len() / 2;
        let (mut sums, mut wrong) = ([0.0; 2], 0);
        for i in 0..count {
            sampler.start(2, i as u32);
            let u = sampler.next_2d();
            for front in 0..fronts as u32 {
                let back = scene.emitters().back_of(front).expect("a back");
                let starts = [front, back].map(|number| emitters[number as usize].sample_departure(u));
                let normals = starts.map(|start| start.normal.expect("a surface"));
                // Only the first of each pair is at the same place, but all of a flat lamp have the same normals.
                wrong += u64::from((normals[0].dot(normals[1]) + 1.0).abs() > 1e-5);
                for ((sum, number), start) in sums.iter_mut().zip([front, back]).zip(&starts) {
                    *sum += emitters[number as usize].power_from(start).x / count as f64;
                }
            }
        }
        for (side, sum) in ["front", "back"].into_iter().zip(sums) {
            case.exact(format!("{what}: power of photons of its {side}"), sum, PI * area, Within::Relative(1e-6));
        }
        case.never(format!("{what}: photons of both sides that do not leave opposite ways"), wrong, count);
    }
}

fn pictures(case: &mut Case) {
    for (what, shapes, exact) in flat_shapes() {
        by_all_methods(case, &format!("back of a {what}"), &lit_both(0.5, 0.05, vec![shapes[1]]), exact);
    }
    let (shape, local) = vertical_tube(1.0, 0.5, 1.0);
    let mut desc = lit_both(1.0, 0.05, vec![shape]);
    desc.surfaces[1].local = local;
    for (integrator, bias) in METHODS {
        let (mean, error) = mean_and_error(&super::drawn(case, &desc, integrator, case.count(64, 1024) as u32));
        let what = format!("inner side of a tube, by {integrator:?}");
        case.biased_mean(what, (mean, error), chimney(1.0, 0.5, 1.0), (bias.max(1e-4), 1e-2));
    }
    // Both receivers of one lamp between them: a floor in front of it, and a ceiling behind it that the camera looks up to.
    let quad = ShapeDesc::Quad(corners());
    let mut desc = lit_both(1.0, 0.05, vec![quad]);
    let (up, size) = (3.0, 0.05);
    let at = |x: f64, y: f64| DVec3::new(x * size, y * size, up);
    let above = ShapeDesc::Quad([at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)]);
    crate::common::scenes::add(&mut desc, 2, above, WHITE, None);
    desc.camera = camera(DVec3::new(0.0, 0.0, 2.0), DVec3::Z * up, 0.02);
    by_all_methods(case, "ceiling over a quad", &desc, polygon_factor(DVec3::Z * up, DVec3::NEG_Z, &corners()));
}

/// More emitters than are chosen by power, of which many face away.
fn many(case: &mut Case) {
    let places = thousand_places(85);
    let light = |(i, to_scene): (usize, &DAffine3)| {
        let disk = DiskEmitter::new(Disk::new(DVec3::ZERO, DVec3::Z, 1.0, to_scene), Rgb::ONE);
        if i % 2 == 0 { Emitter::Disk(Box::new(disk.flipped())) } else { inner_light(*to_scene) }
    };
    let set = EmitterSet::new(places.iter().enumerate().map(light).collect());
    let turned = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    for (what, p, n) in [
        ("below", Vec3::new(0.3, 0.2, 0.0), DVec3::Z),
        ("among them", Vec3::new(1.0, -1.0, 2.0), DVec3::X),
        ("far away", Vec3::new(-60.0, 30.0, 20.0), DVec3::new(60.0, -30.0, -20.0).normalize()),
    ] {
        let factor = |(i, to_scene): (usize, &DAffine3)| match i % 2 {
            0 => disk_factor(&(*to_scene * turned), p.as_dvec3(), n),
            _ => inner_factor(to_scene, p.as_dvec3(), n),
        };
        let exact: f64 = places.iter().enumerate().map(factor).sum();
        case.mean(what, irradiance(case, &set, p, n), exact, 1e-2);
    }
}

/// The ceiling behind a textured lamp, by all methods; the texture is seen through, as it were.
fn textured(case: &mut Case) {
    // Half of the light samples choose the other side.
    let samples = case.count(160, 4096) as u32;
    let mut desc = emission::lamp(None);
    desc.set_emits_both(0, true).expect("a lamp of the test");
    let over = DAffine3::from_translation(2.0 * DVec3::Y) * DAffine3::from_rotation_x(PI);
    desc.set_transform(1, over).expect("a place of the test");
    desc.set_camera(camera(1.1 * DVec3::Y, 2.0 * DVec3::Y, 90.0)).expect("a camera of the test");
    // The part of the ceiling that the camera sees; the ceiling goes on around it.
    const N: u32 = 128;
    let place = |i: u32| 0.9 * (2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0);
    let all = (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
    let irradiance = |(i, j)| emission::exact(DVec3::new(place(i), 2.0, place(j)), DVec3::NEG_Y);
    let exact = 0.5 / PI * all.map(irradiance).sum::<f64>() / f64::from(N * N) * (1.0 + 0.5 + 0.25) / 3.0;
    for (integrator, within) in emission::METHODS.into_iter().chain([(IntegratorDesc::Radiosity, 4e-3)]) {
        let (image, _) = render(&desc, &Job { samples, integrator, ..Job::default() });
        // Elements interpolate the light between their corners.
        let bias = if integrator == IntegratorDesc::Radiosity { 5e-3 } else { 1e-4 };
        case.biased_mean(format!("by {integrator:?}"), mean_and_error(&image), exact, (bias, within));
    }
    let built = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
    let emitters = built.emitters().emitters();
    let fronts = emitters.len() / 2;
    let power = |range: std::ops::Range<usize>| emitters[range].iter().map(|emitter| emitter.power().x).sum::<f64>();
    case.exact("power of both sides", power(fronts..2 * fronts), power(0..fronts), Within::Relative(1e-5));
}
