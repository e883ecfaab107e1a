//! The same bits whoever does the work, whoever looks on, wherever the world is. Numbers of threads and interruptions, for
//! every sampler and integrator, are in `accuracy/arithmetic/repeat.rs`.

mod common;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use common::scenes::{box_inside, camera, scene};
use etendue::Cancel;
use etendue::desc::{BsdfDesc, CameraDesc, FilmDesc, FocusDesc, FovAxis, LensDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::film::{ErrorMeasure, Image};
use etendue::math::DVec3;
use etendue::render::{Ended, Progress, Render, RenderSettings, Workers};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

fn room() -> SceneDesc {
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let mut desc = scene(
        camera(DVec3::ZERO, DVec3::NEG_Z, 90.0),
        vec![
            (
                ShapeDesc::Mesh { mesh: 0, smooth: false },
                BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) },
                Some(Rgb::splat(0.1)),
            ),
            (ShapeDesc::Sphere { centre: DVec3::new(0.25, 0.125, -0.75), radius: 0.3 }, glass, None),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc.lights.push(common::scenes::point_light(DVec3::new(0.0, 0.875, -0.5), 0.5));
    desc
}

fn image(scene: &Scene, desc: &RenderDesc, threads: usize, stops: usize) -> Image {
    let settings = RenderSettings { threads, ..RenderSettings::default() };
    image_by(scene, desc, settings, stops)
}

fn image_by(scene: &Scene, desc: &RenderDesc, settings: RenderSettings, stops: usize) -> Image {
    let settings = RenderSettings { desc: desc.clone(), auxiliary: true, ..settings };
    let mut render = Render::new(scene, settings).unwrap();
    // Every interruption ends the call after its first report; the next call goes on.
    for _ in 0..stops {
        render.run(&mut |_| ControlFlow::Break(())).unwrap();
    }
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert!(!summary.stopped && summary.samples >= desc.samples);
    render.image()
}

/// Bit patterns, so that NaN equals itself and -0 differs from 0.
fn bits(image: &Image) -> Vec<u32> {
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}

type Job = Box<dyn FnOnce() + Send>;

/// Executors as hosts have them: prompt, late, backwards, and ones that forget.
fn executors() -> Vec<(&'static str, Workers)> {
    let prompt = |job: Job| drop(std::thread::spawn(job));
    let at_once = |job: Job| job();
    let late = |job: Job| {
        drop(std::thread::spawn(|| {
            std::thread::sleep(Duration::from_millis(20));
            job();
        }));
    };
    let kept: Arc<Mutex<Vec<Job>>> = Arc::default();
    let backwards = move |job: Job| {
        let mut kept = kept.lock().unwrap();
        kept.push(job);
        if kept.len() == 3 {
            let jobs: Vec<Job> = kept.drain(..).rev().collect();
            drop(std::thread::spawn(|| jobs.into_iter().for_each(|job| job())));
        }
    };
    vec![
        ("calling thread", Workers::calling_thread()),
        ("a shared pool", Workers::pool(2).unwrap()),
        ("prompt", Workers::host(3, prompt)),
        ("at once", Workers::host(3, at_once)),
        ("late", Workers::host(4, late)),
        ("backwards", Workers::host(4, backwards)),
        ("never", Workers::host(4, std::mem::forget::<Job>)),
        ("dropped", Workers::host(4, drop::<Job>)),
    ]
}

#[test]
fn executors_change_nothing() {
    let scene = Scene::build(&room(), &BuildOptions::default()).unwrap();
    let desc = RenderDesc { resolution: [45, 37], samples: 25, ..RenderDesc::default() };
    let reference = bits(&image(&scene, &desc, 1, 0));
    for (name, workers) in executors() {
        for stops in [0, 2] {
            let settings = RenderSettings { workers: Some(workers.clone()), ..RenderSettings::default() };
            assert!(bits(&image_by(&scene, &desc, settings, stops)) == reference, "{name}, {stops} stops");
        }
    }
}

/// Threads estimate errors together, by which adaptive samples are distributed and renders end.
#[test]
fn executors_change_no_estimate() {
    let scene = Scene::build(&room(), &BuildOptions::default()).unwrap();
    let settings = |samples, adaptive, target_error| RenderSettings {
        desc: RenderDesc { resolution: [45, 37], samples, ..RenderDesc::default() },
        adaptive: Some(adaptive),
        target_error,
        error_measure: ErrorMeasure::RelMse,
        ..RenderSettings::default()
    };
    for (settings, ended) in
        [(settings(40, true, None), Ended::Samples), (settings(4096, false, Some(0.05)), Ended::Error)]
    {
        let estimates = |workers: Workers| {
            let mut render =
                Render::new(&scene, RenderSettings { workers: Some(workers), ..settings.clone() }).unwrap();
            let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
            let counts = summary.sample_counts.unwrap();
            assert_eq!((summary.ended, counts.min < counts.max), (ended, summary.adaptive), "{counts:?}");
            (summary.rel_mse.unwrap(), summary.display_error.unwrap(), counts, bits(&render.image()))
        };
        let reference = estimates(Workers::pool(1).unwrap());
        for (name, workers) in executors() {
            assert!(estimates(workers) == reference, "{name}");
        }
    }
}

/// Two renders of very different size share a pool's threads: the small one does not wait for passes of the large one.
#[test]
fn renders_that_share_a_pool_take_turns() {
    let scene = Scene::build(&room(), &BuildOptions::default()).unwrap();
    let workers = Workers::pool(1).unwrap();
    let settings = |resolution, samples| RenderSettings {
        desc: RenderDesc { resolution, samples, ..RenderDesc::default() },
        workers: Some(workers.clone()),
        ..RenderSettings::default()
    };
    let mut large = Render::new(&scene, settings([512, 512], 1 << 20)).unwrap();
    let cancel = Cancel::new();
    large.set_cancel(cancel.clone());
    let passes = AtomicU32::new(0);
    std::thread::scope(|scope| {
        let large = scope.spawn(|| {
            let count = |progress: &Progress| {
                passes.fetch_add(u32::from(progress.image.is_some()), Ordering::Relaxed);
                ControlFlow::Continue(())
            };
            large.run(&mut { count }).unwrap()
        });
        // A pass of every pixel takes long by itself.
        while passes.load(Ordering::Relaxed) < 2 {
            std::thread::sleep(Duration::from_millis(1));
        }
        let small = || {
            let before = passes.load(Ordering::Relaxed);
            let mut small = Render::new(&scene, settings([16, 16], 16)).unwrap();
            let mut own = 0;
            let summary = small
                .run(&mut |progress| {
                    own += u32::from(progress.image.is_some());
                    ControlFlow::Continue(())
                })
                .unwrap();
            assert_eq!((summary.samples, summary.ended), (16, Ended::Samples));
            (own, passes.load(Ordering::Relaxed) - before)
        };
        // Other processes may keep one of a few waiting, not all.
        let tries: Vec<(u32, u32)> = (0..4).map(|_| small()).collect();
        cancel.cancel();
        assert_eq!(large.join().unwrap().ended, Ended::Cancelled);
        let is_fair = tries.iter().any(|&(own, others)| own >= 5 && others <= 2);
        assert!(is_fair, "so many small passes took as long as so many large ones: {tries:?}");
    });
}

/// Whoever looks on while a film is being filled sees finished pixels only, and changes nothing.
#[test]
fn looking_on_changes_nothing() {
    let scene = Scene::build(&room(), &BuildOptions::default()).unwrap();
    let desc = RenderDesc { resolution: [45, 37], samples: 64, ..RenderDesc::default() };
    let reference = bits(&image(&scene, &desc, 1, 0));
    let settings = RenderSettings { desc, threads: 2, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(&scene, settings).unwrap();
    let film = Arc::clone(render.film());
    let done = Cancel::new();
    std::thread::scope(|scope| {
        let looks = scope.spawn(|| {
            loop {
                assert!(film.develop().rgb.iter().all(|value| value.is_finite() && *value >= 0.0));
                if done.is_cancelled() {
                    break;
                }
            }
        });
        render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        done.cancel();
        looks.join().unwrap();
    });
    assert!(bits(&render.image()) == reference);
}

/// The room with all its coordinates, which are multiples of 1/8, moved by `shift`.
fn moved(shift: DVec3) -> SceneDesc {
    moved_with(shift, room())
}

fn moved_with(shift: DVec3, mut desc: SceneDesc) -> SceneDesc {
    desc.meshes
        .iter_mut()
        .flat_map(|mesh| &mut std::sync::Arc::make_mut(mesh).positions)
        .for_each(|position| *position += shift);
    for surface in &mut desc.surfaces {
        if let ShapeDesc::Sphere { centre, .. } = &mut surface.shape {
            *centre += shift;
        }
    }
    desc.lights.iter_mut().for_each(|light| light.position += shift);
    let [eye, look_at, _] = desc.camera.view_mut();
    *eye += shift;
    *look_at += shift;
    if let CameraDesc::ThinLens { lens: LensDesc { focus: FocusDesc::Point(point), .. }, .. } = &mut desc.camera {
        *point += shift;
    }
    desc
}

/// Threads, interruptions and moves of the world change nothing of what is seen through a lens or by parallel rays; a lens of
/// radius 0 shows what a pinhole does.
#[test]
fn lenses_and_parallel_rays_give_the_same_bits() {
    let (eye, look_at, up) = (DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    let (fov_deg, fov_axis) = (90.0, FovAxis::Horizontal);
    let through = |radius| {
        let focus = FocusDesc::Point(DVec3::new(0.25, 0.125, -0.5));
        let lens = LensDesc { focus, blades: 5, ..LensDesc::new(radius) };
        CameraDesc::ThinLens { eye, look_at, up, fov_deg, fov_axis, lens, film: FilmDesc::default() }
    };
    let parallel = CameraDesc::Orthographic { eye, look_at, up, size: 1.5, axis: fov_axis, film: FilmDesc::default() };
    let pinhole = room().camera;
    let pictures = [pinhole, through(0.0), through(0.125), parallel].map(|camera| {
        let desc = SceneDesc { camera, ..room() };
        let render = RenderDesc { resolution: [32, 32], samples: 4, ..RenderDesc::default() };
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let once = bits(&image(&scene, &render, 1, 0));
        assert!(once == bits(&image(&scene, &render, 3, 2)), "{camera:?}: other bits by three threads");
        for exponent in [20, 40] {
            let shift = f64::from(exponent).exp2() * DVec3::new(1.0, 0.0, -2.0);
            let scene = Scene::build(&moved_with(shift, desc.clone()), &BuildOptions::default()).unwrap();
            assert!(once == bits(&image(&scene, &render, 2, 0)), "{camera:?}: other bits at 2^{exponent}");
        }
        once
    });
    assert!(pictures[0] == pictures[1], "a lens of radius 0 is no pinhole");
    assert!(pictures[0] != pictures[2] && pictures[0] != pictures[3]);
}

#[test]
fn moving_the_world_changes_nothing() {
    let render = RenderDesc { resolution: [32, 32], samples: 4, ..RenderDesc::default() };
    let image = |shift| {
        let scene = Scene::build(&moved(shift), &BuildOptions::default()).unwrap();
        bits(&image(&scene, &render, 2, 0))
    };
    let reference = image(DVec3::ZERO);
    // In f32, coordinates at 2^30 are multiples of 64, and the room is 2 wide.
    for exponent in [10, 20, 30, 40] {
        let far = f64::from(exponent).exp2();
        assert!(image(DVec3::new(far, 0.0, -2.0 * far)) == reference, "the scene at 2^{exponent} looks different");
    }
}
