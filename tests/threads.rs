//! No thread is made that was not asked for, and none is left behind. Alone in its program, as it counts threads.
#![cfg(target_os = "linux")]

mod common;

use std::ops::ControlFlow;

use common::scenes::{box_inside, camera, scene};
use etendue::desc::{BsdfDesc, RenderDesc, ShapeDesc};
use etendue::math::DVec3;
use etendue::output::{self, WriteOptions};
use etendue::render::{Render, RenderSettings, Workers};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// Makes the workers of a render, and their threads with them.
type Make = fn() -> Option<Workers>;

/// Threads of this process.
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").unwrap().count()
}

#[test]
fn threads_are_those_asked_for_and_end() {
    let wall = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let mut desc = scene(
        camera(DVec3::ZERO, DVec3::NEG_Z, 90.0),
        vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, wall, Some(Rgb::ONE))],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    let scene = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let desc = RenderDesc { resolution: [64, 64], samples: 16, ..RenderDesc::default() };
    let before = threads();
    let all: [(Make, usize); 4] = [
        (|| Some(Workers::calling_thread()), 0),
        (|| Some(Workers::host(4, drop)), 0),
        (|| Some(Workers::pool(3).unwrap()), 3),
        (|| None, 2),
    ];
    for (workers, more) in all {
        let settings =
            RenderSettings { desc: desc.clone(), threads: 2, workers: workers(), ..RenderSettings::default() };
        let mut render = Render::new(&scene, settings).unwrap();
        let mut reports = 0;
        render
            .run(&mut |_| {
                assert_eq!(threads(), before + more);
                reports += 1;
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!(reports > 0);
        output::write(&render.image(), &folder.path().join("a.exr"), &WriteOptions::default()).unwrap();
        drop(render);
        // A thread that has been joined may take a moment to vanish from the list.
        let start = std::time::Instant::now();
        while threads() != before && start.elapsed() < std::time::Duration::from_secs(5) {
            std::thread::yield_now();
        }
        assert_eq!(threads(), before, "threads are left behind");
    }
}
