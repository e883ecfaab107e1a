//! Maps that are odd: all photons in a plane or in a point, one, none; radii of nothing and beyond the scene.

use std::f64::consts::PI;

use super::{METHODS, asked, build, fixed, grey_mean, images, load, method, unseen};
use crate::common::scenes::{camera, mean_and_error, point_light, scene};
use crate::record::{Case, Entry, Within};
use crate::transport::{ball, glass, grey, parallelogram};
use etendue::desc::{BsdfDesc, IntegratorDesc, KernelDesc, PhotonDesc, RenderDesc};
use etendue::integrator::photon::{Kernel, MapQuery, Photon, PhotonMap};
use etendue::math::{DVec3, Vec3};
use etendue::render::{Render, RenderSettings};
use etendue::spectrum::Rgb;
use etendue::{Cancel, ErrorKind};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M68", title: "odd photon maps", run: maps },
        Entry { id: "M68b", title: "odd radii", run: radii },
        Entry { id: "M68c", title: "scenes without photons", run: dark },
    ]
}

fn build_map(count: u32, place: impl Fn(u32) -> Vec3) -> PhotonMap {
    let one = |i: u32| Photon::new(place(i), Vec3::Y, Vec3::Y, Rgb::splat(1.0));
    PhotonMap::build((0..count).map(one).collect(), &Cancel::new()).expect("nothing stops it")
}

fn maps(case: &mut Case) {
    let flat = Kernel::new(KernelDesc::Flat);
    // A million in a plane, 1000 x 1000 of them.
    let coplanar = build_map(1_000_000, |i| Vec3::new((i % 1000) as f32, 0.0, (i / 1000) as f32));
    let p = Vec3::new(500.3, 0.0, 499.8);
    case.exact("10^6 in a plane", fixed(&coplanar, p, Vec3::Y, KernelDesc::Flat, 50.0), 1.0, Within::Relative(5e-3));
    let query = MapQuery { kernel: flat, radius: 1e6, neighbours: Some(1000) };
    case.exact("10^6 in a plane, 1000 nearest", asked(&coplanar, p, Vec3::Y, query), 1.0, Within::Relative(1e-2));
    // Ten thousand in one point.
    let same = build_map(10_000, |_| Vec3::ONE);
    let exact = 10_000.0 / (PI * 0.25);
    let beside = Vec3::new(1.1, 1.0, 1.0);
    for (what, p) in [("in it", Vec3::ONE), ("beside it", beside)] {
        let got = fixed(&same, p, Vec3::Y, KernelDesc::Flat, 0.5);
        case.exact(format!("10^4 in one point, {what}"), got, exact, Within::Relative(2e-5));
    }
    // A point has no density: asked for the nearest in it, all within the widest disk count.
    let query = MapQuery { kernel: flat, radius: 0.5, neighbours: Some(50) };
    case.exact("10^4 in one point, 50 nearest", asked(&same, Vec3::ONE, Vec3::Y, query), exact, Within::Relative(2e-5));
    // And beside it, where all are as far as the farthest, there is none of them within.
    case.exact("50 nearest beside it", asked(&same, beside, Vec3::Y, query), 0.0, Within::Absolute(0.0));
    // A million within the disk: too many small numbers for a sum in single precision.
    let all = build_map(1_000_000, |i| Vec3::new((i % 1000) as f32 * 1e-4, 0.0, (i / 1000) as f32 * 1e-4));
    let got = fixed(&all, Vec3::new(0.05, 0.0, 0.05), Vec3::Y, KernelDesc::Flat, 0.3);
    case.exact("10^6 within a disk", got, 1e6 / (PI * 0.09), Within::Relative(2e-5));
    let one = build_map(1, |_| Vec3::ZERO);
    for neighbours in [None, Some(2), Some(50)] {
        let query = MapQuery { kernel: flat, radius: 2.0, neighbours };
        let got = asked(&one, Vec3::X, Vec3::Y, query);
        let how = neighbours.map_or("all".to_owned(), |k| format!("{k} nearest"));
        case.exact(format!("one photon, {how}"), got, 1.0 / (4.0 * PI), Within::Relative(1e-6));
    }
    let none = build_map(0, |_| Vec3::ZERO);
    for neighbours in [None, Some(50)] {
        let query = MapQuery { kernel: flat, radius: 2.0, neighbours };
        let how = neighbours.map_or("all".to_owned(), |k| format!("{k} nearest"));
        case.exact(format!("no photon, {how}"), asked(&none, Vec3::X, Vec3::Y, query), 0.0, Within::Absolute(0.0));
    }
}

/// What preparing a render with these photons says.
fn refusal(photons: PhotonDesc, integrator: IntegratorDesc) -> String {
    let desc = RenderDesc { integrator, photons, ..RenderDesc::default() };
    let scene = build(&load("cornell.json"));
    match Render::new(&scene, RenderSettings { desc, threads: 1, ..RenderSettings::default() }) {
        Ok(_) => "no error".to_owned(),
        Err(error) if error.kind() == ErrorKind::InvalidScene => error.to_string(),
        Err(error) => format!("another error: {error}"),
    }
}

fn radii(case: &mut Case) {
    let default = PhotonDesc::default;
    for (what, photons, place) in [
        ("radius 0", PhotonDesc { radius: Some(0.0), ..default() }, "render.photonRadius"),
        ("radius below 0", PhotonDesc { radius: Some(-1.0), ..default() }, "render.photonRadius"),
        ("radius of no number", PhotonDesc { caustic_radius: Some(f64::NAN), ..default() }, "render.causticRadius"),
        ("radius 1e30", PhotonDesc { radius: Some(1e30), ..default() }, "render.photonRadius"),
        ("alpha 1.5", PhotonDesc { alpha: 1.5, ..default() }, "render.photonAlpha"),
        ("1 neighbour", PhotonDesc { neighbours: Some(1), ..default() }, "render.photonNeighbours"),
        ("no light paths", PhotonDesc { count: Some(0), ..default() }, "render.photonCount"),
        ("no gather rays", PhotonDesc { gather_rays: 0, ..default() }, "render.gatherRays"),
    ] {
        for integrator in METHODS {
            let got = refusal(photons.clone(), integrator);
            let passes = got.contains(place);
            case.holds(format!("{what}, {}", integrator.name()), &format!("an error at {place}"), got, passes);
        }
    }
    // Radii of which no disk is whole, or which hold no photon: then paths do it all.
    let scene = build(&load("cornell.json"));
    let (path, _) = crate::common::scenes::render_scene(&scene, method(IntegratorDesc::Path, 16, 64, (1, 1.0)));
    let (path, path_error) = mean_and_error(&path);
    for integrator in METHODS {
        for radius in [1e-10, 1e5, 1e15] {
            let desc = method(integrator, 16, 64, (1 << 10, radius));
            let image = &images(&scene, &desc, 1)[0];
            let (mean, error) = mean_and_error(image);
            let what = format!("radius {radius:e} in a room of 555, {}", integrator.name());
            case.mean(what, (mean, error.hypot(path_error)), path, 3e-2);
        }
    }
}

fn dark(case: &mut Case) {
    let floor = || (parallelogram(DVec3::new(-1.0, 0.0, 1.0), DVec3::X * 2.0, DVec3::Z * -2.0), grey(0.5), None);
    let above = camera(DVec3::new(0.1, 2.0, 0.2), DVec3::ZERO, 40.0);
    let nothing = scene(above, vec![floor(), (ball(DVec3::Y * 0.5, 0.2), glass(1.5, 1.0), None)]);
    let lamp = parallelogram(DVec3::new(5.0, 1.0, 0.2), DVec3::X * 0.4, DVec3::Z * -0.4);
    let away = scene(above, vec![floor(), (lamp, BsdfDesc::Black, Some(Rgb::ONE))]);
    let mut black = scene(above, vec![(ball(DVec3::ZERO, 0.5), BsdfDesc::Black, None)]);
    black.lights.push(point_light(DVec3::Y, 1.0));
    let empty = unseen(Vec::new());
    for (what, desc) in [
        ("nothing shines", nothing),
        ("the lamp shines away", away),
        ("all is black", black),
        ("nothing is there", empty),
    ] {
        let scene = build(&desc);
        for integrator in METHODS {
            let image = &images(&scene, &method(integrator, 8, 8, (1 << 10, 0.1)), 1)[0];
            case.exact(format!("{what}, {}", integrator.name()), grey_mean(image), 0.0, Within::Absolute(0.0));
        }
    }
}
