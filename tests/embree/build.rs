//! Building: large and awkward scenes, progress, and being told to stop.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use etendue::ErrorKind;
use etendue::embree::{BuildQuality, Device, DeviceOptions, SceneBuilder, SceneOptions, TriangleMesh};
use etendue::math::{Ray, Vec3};

use crate::{device, rounded};

/// A wavy field of 2 n^2 triangles over the unit square.
pub fn terrain(n: u32) -> TriangleMesh {
    let step = 1.0 / n as f32;
    let height = |x: u32, y: u32| (0.3 * (x as f32 * 0.7).sin() + 0.2 * (y as f32 * 1.3).cos()) * step;
    let vertices = (0..=n)
        .flat_map(|y| (0..=n).map(move |x| (x, y)))
        .map(|(x, y)| [x as f32 * step, y as f32 * step, height(x, y)])
        .collect();
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let indices = (0..n)
        .flat_map(|y| (0..n).map(move |x| (x, y)))
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    TriangleMesh::new(vertices, indices).expect("a terrain")
}

#[test]
fn an_empty_scene_is_a_scene() {
    let scene = SceneBuilder::new(&device(), SceneOptions::default()).unwrap().commit(None).unwrap();
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert_eq!(scene.intersect(&ray), None);
    assert!(!scene.occluded(&ray));
    assert!(scene.bounds().is_empty());
    assert_eq!(scene.features(), Default::default());
}

/// The same quad a hundred thousand times: no split separates them.
#[test]
fn duplicate_quads_build() {
    const COUNT: u32 = 100_000;
    for quality in [BuildQuality::Low, BuildQuality::Medium, BuildQuality::High] {
        let vertices = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        let indices = (0..COUNT).flat_map(|_| [[0, 1, 2], [0, 2, 3]]).collect();
        let device = device();
        let mut builder = SceneBuilder::new(&device, SceneOptions { quality, ..Default::default() }).unwrap();
        builder.add_triangles(TriangleMesh::new(vertices, indices).unwrap()).unwrap();
        let scene = builder.commit(None).unwrap();
        let hit = scene.intersect(&Ray::new(Vec3::new(0.7, 0.2, 0.0), Vec3::Z)).expect("a quad");
        assert_eq!((rounded(hit.t), hit.prim % 2), (1.0, 0), "{quality:?}");
        assert!(device.peak_memory_bytes() < 500_000_000, "{quality:?}: {}", device.peak_memory_bytes());
    }
}

#[test]
fn degenerate_triangles_build_and_are_never_met_off_themselves() {
    let vertices = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.0, 1.0]];
    let mesh = TriangleMesh::new(vertices, vec![[0, 0, 0], [0, 1, 2], [1, 1, 2]]).unwrap();
    let scene = crate::mesh_scene(&device(), SceneOptions::default(), &mesh);
    assert_eq!(scene.intersect(&Ray::new(Vec3::new(0.5, 0.5, 0.0), Vec3::Z)), None);
}

#[test]
fn progress_rises_to_one() {
    for threads in [1, 2] {
        for mesh in [terrain(1), terrain(400)] {
            let device = Device::new(&DeviceOptions { threads, ..DeviceOptions::default() }).unwrap();
            let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
            builder.add_triangles(mesh).unwrap();
            let seen = Mutex::new(Vec::new());
            let report = |fraction: f64| {
                seen.lock().unwrap().push(fraction);
                true
            };
            builder.commit(Some(&report)).unwrap();
            let seen = seen.into_inner().unwrap();
            assert!(seen.windows(2).all(|w| w[0] < w[1]), "{seen:?}");
            assert!(seen.iter().all(|x| (0.0..=1.0).contains(x)), "{seen:?}");
            assert_eq!(seen.last(), Some(&1.0));
        }
    }
}

#[test]
fn a_build_can_be_cancelled() {
    for threads in [1, 2] {
        let device = Device::new(&DeviceOptions { threads, ..DeviceOptions::default() }).unwrap();
        // At once, and on the way.
        for stop_after in [0, 3] {
            let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
            builder.add_triangles(terrain(400)).unwrap();
            let calls = AtomicUsize::new(0);
            let report = |_: f64| calls.fetch_add(1, Ordering::Relaxed) < stop_after;
            let error = builder.commit(Some(&report)).err().expect("cancelled");
            assert_eq!(error.kind(), ErrorKind::Cancelled, "{error}");
            // Nobody asks again after a no.
            assert_eq!(calls.load(Ordering::Relaxed), stop_after + 1);
            // On a busy machine the build may have been left to itself.
            device.wait_idle();
            assert_eq!(device.memory_bytes(), 0);
        }
        let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
        builder.add_triangles(terrain(10)).unwrap();
        builder.commit(None).expect("the device is as good as new");
    }
}

#[test]
fn a_panic_in_the_progress_callback_is_an_error() {
    let device = device();
    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
    builder.add_triangles(terrain(400)).unwrap();
    let report = |fraction: f64| -> bool { panic!("no more than {fraction}") };
    let error = builder.commit(Some(&report)).err().expect("an error");
    assert_eq!(error.kind(), ErrorKind::Internal, "{error}");
    assert!(error.message().contains("no more than"), "{error}");
    // On a busy machine the build may have been left to itself.
    device.wait_idle();
    assert_eq!(device.memory_bytes(), 0);
}

#[test]
fn scenes_of_one_device_can_be_built_at_the_same_time() {
    let device = Device::new(&DeviceOptions { threads: 2, ..DeviceOptions::default() }).unwrap();
    std::thread::scope(|scope| {
        for i in 0..4 {
            let device = device.clone();
            scope.spawn(move || {
                for _ in 0..5 {
                    let mut builder = SceneBuilder::new(&device, SceneOptions::default()).unwrap();
                    builder.add_triangles(terrain(60 + i)).unwrap();
                    // Half of them are stopped; their errors must not reach the others.
                    let stop = i % 2 == 0;
                    let result = builder.commit(Some(&move |_| !stop));
                    match result {
                        Ok(scene) => {
                            assert!(!stop);
                            assert!(scene.occluded(&Ray::new(Vec3::new(0.5, 0.5, 1.0), -Vec3::Z)));
                        }
                        Err(error) => assert!(stop && error.kind() == ErrorKind::Cancelled, "{error}"),
                    }
                }
            });
        }
    });
}
