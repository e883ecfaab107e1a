//! The same image from any number of threads, with any interruption; the same but for noise whatever the order of a scene's
//! parts, and from another seed.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use etendue::desc::{FilterDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc};
use etendue::film::Image;
use etendue::render::{Render, RenderSettings, Workers};
use etendue::scene::{BuildOptions, Scene};

use super::bits;
use crate::common::scenes::{mean_and_error, render_scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "T66", title: "Threads and interruptions", run: threads },
        Entry { id: "T66b", title: "Order of a scene's parts", run: order },
    ]
}

/// One of the project's own scenes: a room with mirrors, glass, rough walls and a mesh, or the Cornell box.
pub fn load(name: &str) -> SceneDesc {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    etendue::desc::load(&path, None).expect("a scene of the project")
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the project")
}

/// An image by these workers, or so many threads; the first `stops` calls end with their first report.
fn image(scene: &Scene, desc: &RenderDesc, threads: usize, workers: Option<Workers>, stops: usize) -> Image {
    let settings =
        RenderSettings { desc: desc.clone(), threads, workers, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).expect("settings of the test");
    for _ in 0..stops {
        render.run(&mut |_| ControlFlow::Break(())).expect("no worker panics");
    }
    let summary = render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    assert!(!summary.stopped && summary.samples >= desc.samples);
    render.image()
}

fn threads(case: &mut Case) {
    let scene = build(&load("room.json"));
    let samples = case.count(9, 64) as u32;
    let settings = [
        (SamplerDesc::Sobol, FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        (SamplerDesc::Random, FilterDesc::Box),
        (SamplerDesc::Jittered, FilterDesc::Gaussian { sigma: 0.5 }),
        (SamplerDesc::Grid, FilterDesc::Tent),
        (SamplerDesc::Gaussian, FilterDesc::Box),
    ];
    let integrators = [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct];
    let descs: Vec<RenderDesc> = settings
        .iter()
        .flat_map(|&(sampler, filter)| integrators.map(|integrator| (sampler, filter, integrator)))
        // Sides that are no multiples of a tile's.
        .map(|(sampler, filter, integrator)| RenderDesc {
            resolution: [45, 37],
            samples,
            sampler,
            filter,
            integrator,
            reuse: Some(false),
            light_paths: Some(false),
            ..RenderDesc::default()
        })
        .collect();
    // Pixels in groups, which are cut where the picture ends.
    let reuse = RenderDesc { resolution: [45, 37], samples, reuse: Some(true), ..RenderDesc::default() };
    let jittered = RenderDesc { sampler: SamplerDesc::Jittered, ..reuse.clone() };
    let lit = RenderDesc { light_paths: Some(true), ..reuse.clone() };
    let descs: Vec<RenderDesc> = descs.into_iter().chain([reuse, jittered, lit]).collect();
    let references: Vec<Vec<u32>> = descs.iter().map(|desc| bits(&image(&scene, desc, 1, None, 0))).collect();
    let values: usize = references.iter().map(Vec::len).sum();
    let mut row = |what: &str, render: &dyn Fn(&RenderDesc) -> Image| {
        let other = |(desc, reference): (&RenderDesc, &Vec<u32>)| {
            bits(&render(desc)).iter().zip(reference).filter(|(a, b)| a != b).count()
        };
        let others: usize = descs.iter().zip(&references).map(other).sum();
        case.never(format!("{what}: values with other bits"), others as u64, values as u64);
    };
    row("2 threads", &|desc| image(&scene, desc, 2, None, 0));
    row("7 threads", &|desc| image(&scene, desc, 7, None, 0));
    row("stopped once, 1 thread", &|desc| image(&scene, desc, 1, None, 1));
    row("stopped three times, 7 threads", &|desc| image(&scene, desc, 7, None, 3));
    let host = Workers::host(7, |job: Box<dyn FnOnce() + Send>| drop(std::thread::spawn(job)));
    row("threads of a host, stopped twice", &|desc| image(&scene, desc, 0, Some(host.clone()), 2));
    // And with all that, the seed counts.
    let same = descs.iter().zip(&references).filter(|(desc, reference)| {
        bits(&image(&scene, &RenderDesc { seed: 1, ..(*desc).clone() }, 2, None, 0)) == **reference
    });
    case.never("another seed: the same image", same.count() as u64, descs.len() as u64);
}

/// The scene with the order of its surfaces, its lights, its meshes' triangles and their corners reversed or turned.
fn permuted(desc: &SceneDesc) -> SceneDesc {
    let mut desc = desc.clone();
    desc.surfaces = desc.surfaces.iter().rev().cloned().collect();
    desc.lights.reverse();
    for mesh in &mut desc.meshes {
        let mesh = Arc::make_mut(mesh);
        mesh.triangles.reverse();
        mesh.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(1));
    }
    desc
}

fn order(case: &mut Case) {
    let samples = case.count(24, 256) as u32;
    for name in ["room.json", "cornell.json", "many-lights.json"] {
        let desc = load(name);
        let (scene, other) = (build(&desc), build(&permuted(&desc)));
        let plain = RenderDesc { resolution: [64, 48], samples, ..RenderDesc::default() };
        let reference = render_scene(&scene, plain.clone()).0;
        let seeded = RenderDesc { seed: 77, ..plain.clone() };
        // Of another seed, or the two would share most of their noise.
        let images = [
            ("parts reversed", render_scene(&other, seeded.clone()).0),
            ("another seed", render_scene(&scene, seeded).0),
        ];
        for (what, image) in images {
            let tolerance = if case.is_full() { 2e-3 } else { 1e-2 };
            let what = format!("{name}, {what}");
            case.equal_means(format!("{what}: mean"), mean_and_error(&image), mean_and_error(&reference), tolerance);
            // Pixels that are off by more than their errors allow: with eight replicates each, |t| > 15 has a probability below
            // 1 in 10^6 if they are normal, and may be more frequent where they are not.
            let [a, b] = [&image, &reference].map(|image| &image.layer("variance").expect("always there").data);
            let far = (0..image.rgb.len()).step_by(3).filter(|&i| {
                let off = f64::from(image.rgb[i]) - f64::from(reference.rgb[i]);
                off.abs() > 15.0 * f64::from(a[i] + b[i]).sqrt()
            });
            case.rarely(format!("{what}: pixels off by 15 s"), far.count() as u64, image.rgb.len() as u64 / 3, 1e-3);
        }
    }
}
