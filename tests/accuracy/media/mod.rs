//! Media inside surfaces: what they absorb, and which of them fills the overlap of bodies.

mod liquid;
mod rough;
mod textured;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::scenes::{Job, add, box_inside, camera, point_light, render_scene, scene};
use crate::record::{Case, Entry};
use crate::stats;
use crate::transport::{MESH, ball, glass, grey, parallelogram, pick, plane, turned};
use etendue::Alone;
use etendue::Cancel;
use etendue::bsdf::fresnel_dielectric;
use etendue::desc::{BsdfDesc, IntegratorDesc, MediumDesc, RenderDesc, SceneDesc};
use etendue::film::Image;
use etendue::integrator::photon::{MapKind, NARROW, PhotonJob, shoot};
use etendue::integrator::{Irradiance, Path, Piece, SceneTracer, Sites};
use etendue::math::DVec3;
use etendue::sampling::{Sampler as _, SobolSampler};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    let own = vec![
        Entry { id: "A1", title: "absorbing slab", run: slab },
        Entry { id: "A2", title: "camera in an absorbing ball", run: inside },
        Entry { id: "A3", title: "furnace of nested media", run: furnace },
        Entry { id: "A4", title: "lamp and surface in one medium", run: submerged },
        Entry { id: "A5", title: "photons through an absorbing slab", run: photons },
        Entry { id: "A6", title: "irradiance under an absorbing slab", run: irradiance },
    ];
    own.into_iter().chain(liquid::cases()).chain(rough::cases()).chain(textured::cases()).collect()
}

/// Absorption coefficients: different ones in the channels.
const ABSORPTION: Rgb = Rgb::new(0.2, 0.7, 1.5);

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// Rays start a little off the surface that they leave, by as much as a millionth of a triangle's extent. The way through a
/// medium is shorter by so much, relative to what is seen.
const OFFSET: f64 = 1e-4;

/// The same for the faces of slabs that are 400 times as wide as thick.
const LARGE_OFFSET: f64 = 1e-3;

/// Gives materials a medium.
fn fill(desc: &mut SceneDesc, materials: impl IntoIterator<Item = usize>, absorption: Rgb, priority: u32) {
    for material in materials {
        desc.set_medium(material, Some(MediumDesc { absorption, priority })).expect("a medium of the test");
    }
}

/// Mean of a channel and its standard error; pixels are independent.
fn channel(image: &Image, channel: usize) -> (f64, f64) {
    let variance = &image.layer("variance").expect("always there").data;
    let sum: f64 = variance.iter().skip(channel).step_by(3).map(|v| f64::from(*v)).sum();
    (image.mean()[channel], sum.sqrt() * 3.0 / image.rgb.len() as f64)
}

/// The shares of light that a medium leaves after a distance.
fn left_after(distance: f64) -> [f64; 3] {
    ABSORPTION.to_f64().to_array().map(|coefficient| (-coefficient * distance).exp())
}

fn image(scene: &Scene, integrator: IntegratorDesc, samples: u64, seed: u64) -> Image {
    let job = Job { resolution: [16, 16], samples: samples as u32, integrator, seed, ..Job::default() };
    render_scene(scene, job.desc()).0
}

/// The reflectance of a face of glass of index 1.5 and the share that a way of `thickness` straight through leaves, at an
/// angle outside.
fn face(cos: f64) -> (f64, f64) {
    let sin2 = (1.0 - cos * cos) / 2.25;
    (fresnel_dielectric(cos, 1.5), (1.0 - sin2).sqrt())
}

/// What a slab of glass of thickness 1 lets through, and what it reflects, with all reflections inside.
fn through(cos: f64, coefficient: f64) -> (f64, f64) {
    let (f, inner_cos) = face(cos);
    let a = (-coefficient / inner_cos).exp();
    let transmitted = (1.0 - f) * (1.0 - f) * a / (1.0 - f * f * a * a);
    (transmitted, f + f * a * transmitted)
}

/// Mean of a function of the cosine over the hemisphere, weighted by the cosine.
fn mean_over_hemisphere(f: impl Fn(f64) -> f64) -> f64 {
    const N: u32 = 100_000;
    // The square of the sine is uniform.
    (0..N).map(|i| f((1.0 - (f64::from(i) + 0.5) / f64::from(N)).sqrt())).sum::<f64>() / f64::from(N)
}

fn slab(case: &mut Case) {
    let lamp = || (plane(DVec3::Z * 3.0, DVec3::NEG_Z, 1e3), BsdfDesc::Black, Some(Rgb::ONE));
    for degrees in [0.0_f64, 50.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let view = camera(DVec3::new(0.0, 0.0, -2.0), DVec3::new(2.0 * sin, 0.0, 2.0 * cos - 2.0), 0.01);
        let faces = [DVec3::ZERO, DVec3::Z].map(|at| {
            let normal = if at.z > 0.5 { DVec3::Z } else { DVec3::NEG_Z };
            (plane(at, normal, 20.0), glass(1.5, 1.0), None)
        });
        // Two faces are open at their edges; a box of the same thickness is closed.
        let mut open = scene(view, faces.into_iter().chain([lamp()]).collect());
        fill(&mut open, [0, 1], ABSORPTION, 0);
        let mut closed = scene(view, vec![(MESH, glass(1.5, 1.0), None), lamp()]);
        let mesh = box_inside(DVec3::new(-40.0, -40.0, 0.0), DVec3::new(40.0, 40.0, 1.0));
        closed.meshes.push(Arc::new(turned(mesh, DVec3::Z * 0.5, false)));
        fill(&mut closed, [0], ABSORPTION, 0);
        for (what, desc) in [("open", &open), ("closed", &closed)] {
            let scene = build(desc);
            for (integrator, samples) in [(IntegratorDesc::Path, 512), (IntegratorDesc::Whitted, 64)] {
                let image = image(&scene, integrator, case.count(samples, 32 * samples), 1);
                for (i, coefficient) in ABSORPTION.to_f64().to_array().into_iter().enumerate() {
                    let exact = through(cos, coefficient).0;
                    let what = format!("{what}, {degrees}°, {}, absorption {coefficient:.1}", integrator.name());
                    case.biased_mean(what, channel(&image, i), exact, (OFFSET, pick(case, 4e-3, 8e-4)));
                }
            }
        }
    }
}

fn inside(case: &mut Case) {
    let radiance = 1.0;
    let (sin, cos) = 50.0_f64.to_radians().sin_cos();
    for off in [0.0, 0.5] {
        // From a point off the centre, a ray at this angle to the radius keeps its angle to the surface for ever.
        let eye = DVec3::new(0.0, 0.0, off);
        let view = camera(eye, eye + DVec3::new(sin, 0.0, cos), 0.01);
        let mut desc =
            scene(view, vec![(ball(DVec3::ZERO, 1.0), glass(1.5, 1.0), None), (MESH, BsdfDesc::Black, None)]);
        desc.surfaces[1].emission = Some(Rgb::splat(radiance));
        desc.meshes.push(Arc::new(box_inside(DVec3::splat(-3.0), DVec3::splat(3.0))));
        fill(&mut desc, [0], ABSORPTION, 0);
        let scene = build(&desc);
        let sine = off * sin;
        let cosine = (1.0 - sine * sine).sqrt();
        let f = fresnel_dielectric(cosine, 1.0 / 1.5);
        let first = left_after(cosine - off * cos);
        let chord = left_after(2.0 * cosine);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Sppm] {
            let image = image(&scene, integrator, case.count(128, 4096), 1);
            for i in 0..3 {
                let exact = 2.25 * (1.0 - f) * first[i] / (1.0 - f * chord[i]);
                let what = format!("at {off} of the radius, {}, channel {i}", integrator.name());
                case.biased_mean(what, channel(&image, i), exact, (OFFSET, pick(case, 4e-3, 8e-4)));
            }
        }
    }
}

fn furnace(case: &mut Case) {
    nested(case, &[IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Sppm], 1, 0.0, |_, _| {});
}

/// Bodies of this roughness that overlap, in a furnace; `effort` multiplies the samples, and `change` changes materials.
fn nested(
    case: &mut Case,
    integrators: &[IntegratorDesc],
    effort: u64,
    roughness: f32,
    change: impl Fn(&mut SceneDesc, usize),
) {
    let view = camera(DVec3::new(0.3, 0.5, 2.7), DVec3::new(0.1, 0.0, 0.0), 40.0);
    let balls = [
        (DVec3::new(0.0, 0.0, 0.0), 0.8, 1.5, 1),
        (DVec3::new(0.6, 0.1, 0.2), 0.6, 1.33, 0),
        (DVec3::new(-0.3, 0.2, 0.5), 0.5, 1.8, 2),
        (DVec3::new(-0.2, 0.1, -0.1), 0.3, 1.2, 1),
        (DVec3::new(0.3, -0.5, 0.4), 0.4, 1.33, 0),
    ];
    let surfaces = balls
        .iter()
        .map(|(centre, radius, ior, _)| (ball(*centre, *radius), rough::frosted(*ior, 1.0, roughness), None));
    let mut desc = scene(view, surfaces.chain([(MESH, BsdfDesc::Black, Some(Rgb::ONE))]).collect());
    desc.meshes.push(Arc::new(box_inside(DVec3::splat(-3.0), DVec3::splat(3.0))));
    for (material, (.., priority)) in balls.iter().enumerate() {
        fill(&mut desc, [material], Rgb::ZERO, *priority);
        change(&mut desc, material);
    }
    for (what, eye, exact) in
        [("from outside", None, 1.0), ("in the middle of the first ball", Some(DVec3::ZERO), 2.25)]
    {
        let mut desc = desc.clone();
        if let Some(eye) = eye {
            // Without the balls that would trap light: their light is the same, but not that of every direction.
            desc.camera = camera(eye, DVec3::new(0.0, -1.0, -1.0), 1.0);
            desc.surfaces.truncate(1);
            desc.surfaces.push(etendue::desc::SurfaceDesc {
                material: Some(5),
                emission: Some(Rgb::ONE),
                ..desc.surfaces[0].clone()
            });
            desc.surfaces[1].shape = MESH;
        }
        let scene = build(&desc);
        for integrator in integrators {
            let image = image(&scene, *integrator, effort * case.count(64, 1024), 1);
            let what = format!("{what}, {}", integrator.name());
            case.mean(what, channel(&image, 0), exact, pick(case, 4e-3, 1e-3));
        }
    }
}

/// A camera, a lamp and a diffuse floor in a large absorbing body, and bodies of lower priority in between.
fn submerged(case: &mut Case) {
    let (albedo, height, intensity) = (0.5, 1.5, 2.0);
    let eye = DVec3::new(0.0, 2.0, 1.0);
    let floor = parallelogram(DVec3::new(-1.0, 0.0, 1.0), DVec3::X * 2.0, DVec3::NEG_Z * 2.0);
    let direct = [
        IntegratorDesc::Path,
        IntegratorDesc::Whitted,
        IntegratorDesc::Direct,
        IntegratorDesc::PhotonDirect,
        IntegratorDesc::Caustic,
        IntegratorDesc::Photon,
        IntegratorDesc::IrradianceCache,
        IntegratorDesc::Sppm,
    ];
    for hidden in [false, true] {
        let mut surfaces = vec![(ball(DVec3::ZERO, 60.0), glass(1.33, 1.0), None), (floor, grey(albedo), None)];
        if hidden {
            // One on the way of the light, one on the way to the eye, one around the eye and one around the lamp.
            surfaces.push((ball(DVec3::Y * 0.7, 0.3), glass(1.5, 1.0), None));
            surfaces.push((ball(0.5 * eye, 0.3), glass(1.7, 1.0), None));
            surfaces.push((ball(eye, 0.4), glass(1.6, 1.0), None));
            surfaces.push((ball(DVec3::Y * height, 0.2), glass(1.4, 1.0), None));
        }
        let mut desc = scene(camera(eye, DVec3::ZERO, 0.02), surfaces);
        desc.lights.push(point_light(DVec3::Y * height, intensity));
        fill(&mut desc, [0], ABSORPTION, 1);
        let scene = build(&desc);
        // With the balls, all is asked for that there is without.
        let methods = if hidden || case.is_full() { &direct[..] } else { &direct[..3] };
        for &integrator in methods {
            let mut settings = Job { resolution: [16, 16], samples: 16, integrator, ..Job::default() }.desc();
            // What is seen is direct light, which only `PhotonDirect` takes from photons.
            let needs_few = !case.is_full() && integrator != IntegratorDesc::PhotonDirect;
            settings.photons.count = needs_few.then_some(1 << 14);
            let (image, _) = render_scene(&scene, settings);
            for (i, coefficient) in ABSORPTION.to_f64().to_array().into_iter().enumerate() {
                let way = (-coefficient * (height + eye.length())).exp();
                let exact = f64::from(albedo) / PI * f64::from(intensity) / (height * height) * way;
                let what = if hidden { "behind hidden balls" } else { "plain" };
                let what = format!("{what}, {}, channel {i}", integrator.name());
                // Photons of direct light are averaged over a disk.
                let bias = if integrator == IntegratorDesc::PhotonDirect { 1e-2 } else { OFFSET };
                case.biased_mean(what, channel(&image, i), exact, (bias, 1e-3));
            }
        }
    }
    // A lamp with an area, which light samples and Bsdf samples find.
    let radius = 0.2;
    let mut surfaces = vec![(ball(DVec3::ZERO, 60.0), glass(1.33, 1.0), None), (floor, grey(albedo), None)];
    surfaces.push((ball(DVec3::Y * height, radius), BsdfDesc::Black, Some(Rgb::ONE)));
    surfaces.push((ball(DVec3::Y * 0.6, 0.4), glass(1.5, 1.0), None));
    let mut desc = scene(camera(eye, DVec3::ZERO, 0.02), surfaces);
    fill(&mut desc, [0], ABSORPTION, 1);
    let scene = build(&desc);
    // Irradiance right below a ball, with the distance to each of its points: by quadrature.
    let sin2 = (f64::from(radius as f32) / height).powi(2);
    let methods = [IntegratorDesc::Path, IntegratorDesc::Direct, IntegratorDesc::Whitted, IntegratorDesc::Sppm];
    let images = methods.map(|integrator| (integrator, image(&scene, integrator, case.count(32, 2048), 1)));
    for (i, coefficient) in ABSORPTION.to_f64().to_array().into_iter().enumerate() {
        const N: u32 = 100_000;
        let ring = |k: u32| {
            let s2 = sin2 * (f64::from(k) + 0.5) / f64::from(N);
            let distance = height * (1.0 - s2).sqrt() - (radius * radius - height * height * s2).sqrt();
            (-coefficient * distance).exp()
        };
        let irradiance = PI * sin2 * (0..N).map(ring).sum::<f64>() / f64::from(N);
        let exact = f64::from(albedo) / PI * irradiance * (-coefficient * eye.length()).exp();
        for (integrator, image) in &images {
            let what = format!("ball that shines, {}, channel {i}", integrator.name());
            case.biased_mean(what, channel(image, i), exact, (OFFSET, pick(case, 4e-3, 1e-3)));
        }
    }
}

fn photons(case: &mut Case) {
    // A point light above an endless slab, and a floor below it.
    let floor = (plane(DVec3::NEG_Y, DVec3::Y, 200.0), grey(0.5), None);
    let faces =
        [(DVec3::ZERO, DVec3::NEG_Y), (DVec3::Y, DVec3::Y)].map(|(at, n)| (plane(at, n, 200.0), glass(1.5, 1.0), None));
    let view = camera(DVec3::Y * 3.0, DVec3::ZERO, 10.0);
    let mut desc = scene(view, faces.into_iter().chain([floor]).collect());
    fill(&mut desc, [0, 1], ABSORPTION, 0);
    desc.lights.push(point_light(DVec3::Y * 1.5, 1.0));
    let scene = build(&desc);
    let paths = case.count(1 << 14, 1 << 18) as u32;
    let runs: Vec<[f64; 3]> = (1..=16)
        .map(|seed| {
            let desc = RenderDesc { seed, ..RenderDesc::default() };
            let job =
                PhotonJob { kind: MapKind::Caustic, paths, pass: 0, most: usize::MAX, narrow_below: NARROW, time: 0.0 };
            let shot = shoot(&scene, &desc, job, &mut Alone::default()).expect("nothing stops it");
            let tally = shot.tally;
            let found = tally.absorbed + tally.escaped + tally.left;
            assert!((found / tally.emitted - 1.0).abs().max_element() < 1e-6, "the balance of light");
            [0, 1, 2].map(|i| shot.photons.iter().map(|photon| f64::from(photon.power[i])).sum())
        })
        .collect();
    for (i, coefficient) in ABSORPTION.to_f64().to_array().into_iter().enumerate() {
        const N: u32 = 100_000;
        let cos = |k: u32| (f64::from(k) + 0.5) / f64::from(N);
        let exact = 2.0 * PI * (0..N).map(|k| through(cos(k), coefficient).0).sum::<f64>() / f64::from(N);
        let found = stats::mean_and_error(&runs.iter().map(|run| run[i]).collect::<Vec<_>>());
        case.biased_mean(
            format!("power on the floor, channel {i}"),
            found,
            exact,
            (LARGE_OFFSET, pick(case, 4e-3, 1e-3)),
        );
    }
}

fn irradiance(case: &mut Case) {
    // Everything above an endless slab shines; the floor below it is seen, and its light map is made.
    let (albedo, half) = (0.4_f32, 200.0);
    let faces =
        [(DVec3::ZERO, DVec3::NEG_Y), (DVec3::Y, DVec3::Y)].map(|(at, n)| (plane(at, n, half), glass(1.5, 1.0), None));
    let lamp = (plane(DVec3::Y * 2.0, DVec3::NEG_Y, half), BsdfDesc::Black, Some(Rgb::ONE));
    let floor = (plane(DVec3::NEG_Y, DVec3::Y, half), grey(albedo), None);
    let view = camera(DVec3::NEG_Y * 0.5, DVec3::new(0.1, -1.0, 0.0), 1.0);
    let mut desc = scene(view, faces.into_iter().chain([lamp, floor]).collect());
    fill(&mut desc, [0, 1], ABSORPTION, 0);
    let scene = build(&desc);
    let radiosity: Vec<f64> = (ABSORPTION.to_f64().to_array().into_iter())
        .map(|coefficient| {
            let transmitted = mean_over_hemisphere(|cos| through(cos, coefficient).0);
            let reflected = mean_over_hemisphere(|cos| through(cos, coefficient).1);
            PI * transmitted / (1.0 - f64::from(albedo) * reflected)
        })
        .collect();
    let seen = image(&scene, IntegratorDesc::Path, case.count(256, 8192), 1);
    for (i, irradiance) in radiosity.iter().enumerate() {
        let exact = f64::from(albedo) / PI * irradiance;
        let within = (LARGE_OFFSET, pick(case, 4e-3, 1e-3));
        case.biased_mean(format!("floor, path, channel {i}"), channel(&seen, i), exact, within);
    }
    // The same as a light map finds it, in a small part of the floor.
    let meshes = scene.surface_meshes(&Cancel::new()).expect("nothing stops it");
    let facet = meshes[3].facets[0];
    // The middle of the diagonal.
    let middle = [[0.0, 0.5], [0.001, 0.499], [0.0, 0.499]];
    let sites = Sites::new(vec![facet], vec![Piece { facet: 0, corners: middle, until: 1.0 }], vec![0, 1]);
    let irradiance = Irradiance::new(Arc::new(sites), Path::new(None, 1), true);
    let mut tracer = SceneTracer::new(&scene);
    let count = case.count(1 << 16, 1 << 20) as u32;
    let mut values = [(); 3].map(|()| Vec::new());
    let mut sampler = SobolSampler::new(5, count);
    for index in 0..count {
        sampler.start(index, 0);
        let place = sampler.pixel_2d();
        let found = irradiance.estimate(&scene, 0, place, &mut sampler, &mut tracer).to_f64();
        (0..3).for_each(|i| values[i].push(found[i]));
    }
    for (i, exact) in radiosity.iter().enumerate() {
        let found = stats::mean_and_error(&values[i]);
        case.biased_mean(format!("light map, channel {i}"), found, *exact, (LARGE_OFFSET, pick(case, 4e-3, 1e-3)));
    }
}
