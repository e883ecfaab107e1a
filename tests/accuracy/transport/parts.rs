//! Light that is kept apart by how often it was scattered on its way: in rooms of which each bounce is known in closed form.

use std::f64::consts::PI;

use super::rooms::sphere_with_light;
use super::{MESH, ball, grey, mirror, pick};
use crate::arithmetic::repeat::load;
use crate::common::scenes::{Job, box_inside, camera, scene};
use crate::common::stats::mean_and_error;
use crate::record::{Case, Entry, Within};
use etendue::desc::{IntegratorDesc, RenderDesc, SceneDesc};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

const LAYERS: [&str; 3] = ["emission", "direct", "indirect"];

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "R70", title: "emitted, direct and indirect light", run: parts }]
}

fn image(desc: &SceneDesc, render: RenderDesc) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let settings = RenderSettings { desc: render, threads: 2, light_parts: true, ..RenderSettings::default() };
    let mut render = Render::new(&scene, settings).expect("settings of the test");
    render.run(&mut |_| std::ops::ControlFlow::Continue(())).expect("a render of the test");
    render.image()
}

/// Mean of each layer over all pixels and channels, with its standard error.
fn layers(image: &Image) -> [(f64, f64); 3] {
    LAYERS.map(|name| {
        let layer = image.layer(name).expect("a part of the light");
        let pixels: Vec<f64> =
            layer.data.chunks_exact(3).map(|pixel| pixel.iter().map(|it| f64::from(*it) / 3.0).sum()).collect();
        mean_and_error(&pixels)
    })
}

fn compare(case: &mut Case, what: &str, image: &Image, exact: [f64; 3], tolerance: f64) {
    for ((found, name), exact) in layers(image).into_iter().zip(LAYERS).zip(exact) {
        if exact == 0.0 {
            case.exact(format!("{what}: {name}"), found.0, 0.0, Within::Absolute(1e-7));
        } else {
            case.mean(format!("{what}: {name}"), found, exact, tolerance);
        }
    }
    // The parts are those of the same paths.
    let data = LAYERS.map(|name| &image.layer(name).expect("a part of the light").data);
    let off = |(i, whole): (usize, &f32)| (data.iter().map(|part| part[i]).sum::<f32>() - whole).abs() / whole.max(1.0);
    let largest = image.rgb.iter().enumerate().map(off).fold(0.0, f32::max);
    case.at_most(format!("{what}: sum of the layers beside the colour"), largest.into(), 4e-6);
}

fn parts(case: &mut Case) {
    let tolerance = pick(case, 4e-3, 6e-4);
    let samples = case.count(64, 2048) as u32;
    let job = |integrator| Job { resolution: [16, 16], samples, integrator, ..Job::default() }.desc();
    let path = || job(IntegratorDesc::Path);

    // A closed room that emits E and reflects a of what arrives: E, a E and the rest of E / (1 - a).
    let view = camera(DVec3::new(0.1, -0.2, 0.9), DVec3::new(0.0, 0.0, -1.0), 90.0);
    let mut furnace = scene(view, vec![(MESH, grey(0.7), Some(Rgb::splat(0.6)))]);
    furnace.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    let exact = [0.6, 0.7 * 0.6, 0.7 * 0.7 * 0.6 / 0.3];
    compare(case, "furnace", &image(&furnace, path()), exact, tolerance);
    let shadow_rays = RenderDesc { shadow_rays: 3, ..path() };
    compare(case, "furnace, 3 light samples", &image(&furnace, shadow_rays), exact, tolerance);
    let spectral = RenderDesc { spectral: true, ..path() };
    compare(case, "furnace, wavelengths", &image(&furnace, spectral), exact, 4.0 * tolerance);
    let once = RenderDesc { max_depth: Some(1), ..path() };
    compare(case, "furnace, one hit", &image(&furnace, once), [exact[0], exact[1], 0.0], tolerance);
    let local = job(IntegratorDesc::Direct);
    compare(case, "furnace, the integrator direct", &image(&furnace, local), [exact[0], exact[1], 0.0], tolerance);

    // What a mirror shows is scattered once more. The walls' own direct light is less even, since the ball takes some of it.
    let mut shining = scene(
        camera(DVec3::ZERO, DVec3::Z, 2.0),
        vec![(ball(DVec3::Z * 3.0, 1.0), mirror(0.8), None), (MESH, grey(0.5), Some(Rgb::splat(0.4)))],
    );
    shining.meshes.push(box_inside(DVec3::splat(-9.0), DVec3::splat(9.0)).into());
    let found = layers(&image(&shining, path()));
    case.exact("mirror in a furnace: emission", found[0].0, 0.0, Within::Absolute(1e-7));
    case.mean("mirror in a furnace: direct", found[1], 0.8 * 0.4, tolerance);

    // A point light in a ball: what is scattered once is uneven, and the rest is even.
    let (lit, whole) = sphere_with_light(2.0, 0.7, 5.0, DVec3::X * 0.8, DVec3::Y * 2.0);
    let distance2: f64 = 0.8 * 0.8 + 4.0;
    let direct = 0.7 / PI * 5.0 * 2.0 / distance2.powf(1.5);
    compare(case, "sphere with a light", &image(&lit, path()), [0.0, direct, whole - direct], tolerance);

    // A convex body under an even sky scatters its light once, and beside it the sky itself is seen, or the plate before it.
    let sky = |more: &str| {
        let text = format!(
            r#"{{"etendue": 1, "camera": {{"origin": [0, 0, 3], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 2}},
                "materials": [{{"name": "grey", "type": "diffuse", "color": [0.6, 0.6, 0.6]}}],
                "lights": [{{"type": "environment", "color": [0.5, 0.5, 0.5]}}], {more}
                "surfaces": [{{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "grey"}}]}}"#
        );
        etendue::desc::parse(&text, "".as_ref(), None).expect("a scene of the test")
    };
    compare(case, "a ball under the sky", &image(&sky(""), path()), [0.0, 0.3, 0.0], tolerance);
    for (what, more, seen) in
        [("the sky", "", 0.5), ("a backplate", r#""backplate": {"color": [0.2, 0.2, 0.2]},"#, 0.2)]
    {
        let mut desc = sky(more);
        desc.camera = camera(DVec3::Z * 3.0, DVec3::Z * 9.0, 2.0);
        compare(case, what, &image(&desc, path()), [seen, 0.0, 0.0], tolerance);
    }

    // What the room's integrator direct finds, and no more.
    let room = load("room.json");
    let seeds = case.count(8, 32);
    let means = |integrator, first: u64| {
        let render = |seed| RenderDesc { seed: first + seed, resolution: [32, 32], ..job(integrator) };
        let found: Vec<_> = (0..seeds).map(|seed| layers(&image(&room, render(seed)))).collect();
        [0, 1].map(|layer| mean_and_error(&found.iter().map(|of| of[layer].0).collect::<Vec<_>>()))
    };
    let (found, local) = (means(IntegratorDesc::Path, 1), means(IntegratorDesc::Direct, 1000));
    for (i, name) in LAYERS.into_iter().enumerate().take(2) {
        case.equal_means(format!("room.json: {name}"), found[i], local[i], tolerance);
    }
}
