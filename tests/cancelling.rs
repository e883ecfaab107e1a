//! Builds that are told to stop do so soon, in every phase, and leave nothing behind; progress only grows.

use std::any::Any;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use etendue::buffer::Buffer;
use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FovAxis, HostMesh, MaterialDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc,
    Surfaces,
};
use etendue::embree::{Device, DeviceOptions};
use etendue::math::{DAffine3, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Cancel, ErrorKind};

/// A wavy sheet of 2 n^2 triangles.
fn sheet(n: usize) -> MeshDesc {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let corner = |x: usize, y: usize| (y * (n + 1) + x) as u32;
    MeshDesc {
        positions: (0..=n)
            .flat_map(|y| (0..=n).map(move |x| (x, y)))
            .map(|(x, y)| DVec3::new(at(x), at(y), 0.2 * (9.0 * at(x)).sin() * (7.0 * at(y)).cos()))
            .collect(),
        triangles: (0..n)
            .flat_map(|y| (0..n).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect(),
        ..MeshDesc::default()
    }
}

/// The same in memory of a host; kept by its buffers.
fn hosted(mesh: &MeshDesc) -> MeshDesc {
    let vertices: Vec<[f32; 4]> = mesh.positions.iter().map(|p| p.as_vec3().extend(0.0).to_array()).collect();
    let triangles = mesh.triangles.clone();
    let memory = Arc::new((vertices, triangles));
    let owner = || Arc::clone(&memory) as Arc<dyn Any + Send + Sync>;
    // SAFETY: the vectors are never changed and live as long as the owner; vertices are of sixteen bytes.
    let host = unsafe {
        HostMesh {
            positions: Buffer::foreign(memory.0.as_ptr().cast(), memory.0.len(), 16, owner()).unwrap(),
            triangles: Buffer::foreign(memory.1.as_ptr(), memory.1.len(), 12, owner()).unwrap(),
            normals: None,
            uvs: None,
        }
    };
    MeshDesc { host: Some(host), ..MeshDesc::default() }
}

fn scene(mesh: MeshDesc, smooth: bool, emission: Option<Rgb>) -> SceneDesc {
    SceneDesc {
        camera: CameraDesc::Perspective {
            eye: DVec3::new(0.0, 0.0, 4.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            fov_deg: 60.0,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        },
        materials: vec![MaterialDesc {
            name: String::new(),
            path: String::new(),
            bsdf: BsdfDesc::Black,
            ..MaterialDesc::default()
        }],
        meshes: vec![Arc::new(mesh)],
        surfaces: Surfaces::from_iter([SurfaceDesc {
            path: "surfaces[0]".into(),
            name: String::new(),
            shape: ShapeDesc::Mesh { mesh: 0, smooth },
            local: DAffine3::IDENTITY,
            transform: DAffine3::IDENTITY,
            material: Some(0),
            emission,
            emits_both: false,
            web: None,
            spectrum: None,
            hidden: false,
        }]),
        ..SceneDesc::default()
    }
}

/// The flavours of a build that differ in their phases.
fn flavours(n: usize) -> Vec<(&'static str, SceneDesc, bool)> {
    vec![
        ("flat", scene(sheet(n), false, None), false),
        ("smooth, emitting", scene(sheet(n), true, Some(Rgb::ONE)), false),
        ("own hierarchy", scene(sheet(n), false, None), true),
        ("host's, smooth", scene(hosted(&sheet(n)), true, None), false),
    ]
}

fn device() -> Device {
    Device::new(&DeviceOptions::default()).unwrap()
}

/// Runs `build`, which is told to stop after `delay`; how long it went on after that, `None` if it was done before.
fn cancelled(delay: Duration, build: impl FnOnce(Cancel) -> etendue::Result<Scene>) -> Option<Duration> {
    let cancel = Cancel::new();
    let at = Mutex::new(None);
    let (result, end) = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(delay);
            let mut at = at.lock().unwrap();
            cancel.cancel();
            *at = Some(Instant::now());
        });
        let result = build(cancel.clone());
        (result, Instant::now())
    });
    match result {
        Ok(_) => None,
        Err(error) => {
            assert_eq!(error.kind(), ErrorKind::Cancelled, "{error}");
            Some(end.saturating_duration_since(at.into_inner().unwrap().unwrap()))
        }
    }
}

/// Runs `build`, which is told to stop by its first report of at least `at`; that must not be its last one. The fraction that was done
/// then, and that of the last report.
fn stopped(at: f64, options: BuildOptions, build: impl FnOnce(&BuildOptions) -> etendue::Result<Scene>) -> [f64; 2] {
    let cancel = Cancel::new();
    let told: Arc<Mutex<Option<[f64; 2]>>> = Arc::default();
    let progress = {
        let (cancel, told) = (cancel.clone(), Arc::clone(&told));
        Arc::new(move |fraction: f64| {
            let mut told = told.lock().unwrap();
            match &mut *told {
                Some([_, last]) => *last = fraction,
                None if fraction >= at => {
                    cancel.cancel();
                    *told = Some([fraction; 2]);
                }
                None => {}
            }
        })
    };
    let result = build(&BuildOptions { progress: Some(progress), cancel, ..options });
    assert_eq!(result.err().map(|error| error.kind()), Some(ErrorKind::Cancelled), "told at {at}");
    told.lock().unwrap().expect("a report")
}

/// A build that is told to stop by one of its reports makes no more: reports come every 1 / 512 of the work where there are any. What they
/// say nothing of, such as the beginning of Embree's work and the tree of lights, is stopped from outside.
#[test]
fn a_build_stops_soon_in_every_phase() {
    const MOMENTS: u32 = 8;
    const TRIES: usize = 10;
    let device = device();
    for (what, desc, dynamic) in flavours(708) {
        let options =
            |cancel| BuildOptions { device: Some(device.clone()), dynamic, cancel, ..BuildOptions::default() };
        let time = || {
            let start = Instant::now();
            drop(Scene::build(&desc, &options(Cancel::new())).unwrap());
            start.elapsed()
        };
        let mut full = time();
        let mut latencies = Vec::new();
        for moment in 0..MOMENTS {
            let at = f64::from(moment) / f64::from(MOMENTS);
            let [from, to] = stopped(at, options(Cancel::new()), |it| Scene::build(&desc, it));
            assert!(to < from + 0.05, "{what}: told to stop at {from}, it went on to {to}");
            let mut least = Duration::MAX;
            // Of a few tries, one is held up by nothing but the build. Where the machine has become slower, a whole build takes longer too.
            for _ in 0..TRIES {
                let delay = full.mul_f64(at + 0.5 / f64::from(MOMENTS));
                let Some(latency) = cancelled(delay, |cancel| Scene::build(&desc, &options(cancel))) else {
                    // It has become faster, and was done.
                    full = time();
                    continue;
                };
                device.wait_idle();
                assert_eq!(device.memory_bytes(), 0, "{what}: a cancelled build leaks");
                least = least.min(latency);
                if least < full / 20 {
                    break;
                }
                full = time();
            }
            assert!(
                least == Duration::MAX || least < full / 10,
                "{what}: told at {at} of {full:?}, it ended after {least:?}"
            );
            latencies.extend((least < Duration::MAX).then_some(least));
        }
        latencies.sort();
        assert!(!latencies.is_empty(), "{what}: never cancelled");
        let (median, largest) = (latencies[latencies.len() / 2], latencies[latencies.len() - 1]);
        println!("{what}: full build {full:.1?}; cancelled, median {median:.2?}, largest {largest:.2?}");
    }
}

#[test]
fn a_rebuild_that_was_cancelled_works_the_next_time() {
    let device = device();
    let options =
        |cancel| BuildOptions { device: Some(device.clone()), dynamic: true, cancel, ..BuildOptions::default() };
    let desc = scene(sheet(200), true, None);
    let scene = Scene::build(&desc, &options(Cancel::new())).unwrap();
    let bytes = device.memory_bytes();
    let mut edited = desc.clone();
    Arc::make_mut(&mut edited.meshes[0]).positions.iter_mut().for_each(|p| p.z *= 2.0);
    for moment in 0..18 {
        stopped(f64::from(moment) / 20.0, options(Cancel::new()), |it| scene.rebuild(&edited, it));
        device.wait_idle();
        assert_eq!(device.memory_bytes(), bytes, "a cancelled rebuild leaks");
    }
    // Told beforehand.
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(scene.rebuild(&desc, &options(cancel)).unwrap_err().kind(), ErrorKind::Cancelled);
    let rebuilt = scene.rebuild(&edited, &options(Cancel::new())).unwrap();
    assert_eq!(rebuilt.info().bounds, Scene::build(&edited, &options(Cancel::new())).unwrap().info().bounds);
}

/// Another build has the device; the one that waits for it can be cancelled all the same.
#[test]
fn a_build_that_waits_for_the_device_can_be_cancelled() {
    let device = device();
    let (large, small) = (scene(sheet(708), false, None), scene(sheet(4), false, None));
    // Until a build under way holds the device for longer than the other waits, which the first try does as a rule. One that waited for
    // the device would never find it held.
    let waited = (0..10).any(|_| {
        let (told, hears) = std::sync::mpsc::channel();
        let told = Mutex::new(Some(told));
        let progress = Arc::new(move |fraction: f64| {
            // Half of a flat build is Embree's.
            if fraction > 0.5
                && let Some(told) = told.lock().unwrap().take()
            {
                told.send(()).ok();
            }
        });
        let stop_large = Cancel::new();
        let options = BuildOptions {
            device: Some(device.clone()),
            progress: Some(progress),
            cancel: stop_large.clone(),
            ..BuildOptions::default()
        };
        std::thread::scope(|scope| {
            let large = scope.spawn(|| Scene::build(&large, &options));
            hears.recv().unwrap();
            let latency = cancelled(Duration::from_millis(5), |cancel| {
                Scene::build(&small, &BuildOptions { device: Some(device.clone()), cancel, ..BuildOptions::default() })
            });
            let still_held = !large.is_finished();
            stop_large.cancel();
            latency.is_some() && still_held
        })
    });
    assert!(waited, "the device was never held long enough");
}

#[test]
fn progress_only_grows_and_ends_with_one() {
    for (what, desc, dynamic) in flavours(120) {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let sink = Arc::clone(&seen);
        let progress: Arc<dyn Fn(f64) + Send + Sync> = Arc::new(move |fraction| sink.lock().unwrap().push(fraction));
        let options =
            BuildOptions { device: Some(device()), dynamic, progress: Some(progress), ..BuildOptions::default() };
        let scene = Scene::build(&desc, &options).unwrap();
        let check = |what: &str| {
            let seen = std::mem::take(&mut *seen.lock().unwrap());
            assert!(seen.windows(2).all(|w| w[0] < w[1]), "{what}: {seen:?}");
            assert!(seen.iter().all(|fraction| (0.0..=1.0).contains(fraction)), "{what}: {seen:?}");
            assert_eq!(seen.last(), Some(&1.0), "{what}");
            seen
        };
        let seen = check(what);
        assert!(seen.len() > 8, "{what}: {seen:?}");
        let widest = seen.windows(2).map(|w| w[1] - w[0]).fold(seen[0], f64::max);
        assert!(widest < 0.6, "{what}: a step of {widest}: {seen:?}");
        scene.rebuild(&desc, &options).unwrap();
        check("a rebuild without work");
    }
}
