//! Layouts and bakes that are stopped at any of their reports leave nothing behind, and what they report only grows.

use etendue::ErrorKind;
use etendue::bake::{VertexOptions, Vertices, by_radiosity};
use etendue::desc::{IntegratorDesc, RadiositySolver};
use etendue::embree::{Device, DeviceOptions, MemoryBudget};
use etendue::render::Render;
use etendue::spectrum::Rgb;

use super::*;

/// A wavy sheet of 2 n^2 triangles, a room and a sphere.
fn sheet(n: usize) -> SceneDesc {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let corner = |x: usize, y: usize| (y * (n + 1) + x) as u32;
    let mesh = MeshDesc {
        positions: (0..=n)
            .flat_map(|y| (0..=n).map(move |x| (x, y)))
            .map(|(x, y)| DVec3::new(at(x), 0.2 * (9.0 * at(x)).sin() * (7.0 * at(y)).cos(), at(y)))
            .collect(),
        triangles: (0..n)
            .flat_map(|y| (0..n).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                [[a, c, b], [a, d, c]]
            })
            .collect(),
        ..MeshDesc::default()
    };
    let mut desc = one_mesh(mesh, None);
    let grey = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let room = ShapeDesc::Mesh { mesh: 1, smooth: false };
    scenes::add(&mut desc, 1, room, grey, Some(Rgb::ONE));
    desc.meshes.push(Arc::new(scenes::box_inside(DVec3::splat(-2.0), DVec3::splat(2.0))));
    scenes::add(&mut desc, 2, ShapeDesc::Sphere { centre: DVec3::Y, radius: 0.3 }, grey, None);
    desc
}

/// Does `work` to its end, then stopped at each of its reports; all of what was told in the whole one.
fn stopped_everywhere<R>(
    what: &str,
    work: impl Fn(&mut (dyn FnMut(f64) -> ControlFlow<()> + Send)) -> etendue::Result<R>,
) -> Vec<f64> {
    let mut told = Vec::new();
    work(&mut |share| {
        told.push(share);
        ControlFlow::Continue(())
    })
    .expect("nobody stops it");
    assert!(told.is_sorted(), "{what}: {told:?}");
    assert!(told.iter().all(|share| (0.0..=1.0).contains(share)), "{what}: {told:?}");
    for last in 1.. {
        let mut calls = 0;
        let outcome = work(&mut |_| {
            calls += 1;
            if calls < last { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        if calls < last {
            assert!(outcome.is_ok(), "{what}");
            // It may have taken longer, or less long, than before.
            assert!(last > 4, "{what}: only {calls} reports");
            return told;
        }
        assert_eq!(outcome.err().map(|error| error.kind()), Some(ErrorKind::Cancelled), "{what}, report {last}");
        assert_eq!(calls, last, "{what}: asked once more after it was stopped");
    }
    unreachable!("it comes to an end")
}

#[test]
fn layouts() {
    let budget = MemoryBudget::new(1 << 30);
    let device = Device::new(&DeviceOptions { budget: Some(budget.clone()), ..DeviceOptions::default() }).unwrap();
    let options = BuildOptions { device: Some(device), ..BuildOptions::default() };
    let scene = Scene::build(&sheet(60), &options).unwrap();
    let used = budget.used();
    let options = AtlasOptions { resolution: Some(128), ..AtlasOptions::default() };
    let told = stopped_everywhere("an atlas", |look_up| Atlas::watched(&scene, &options, look_up));
    assert_eq!(budget.used(), used, "what was stopped takes memory");
    let inner = told.iter().filter(|share| (0.01..0.99).contains(*share)).count();
    assert!(inner >= 4, "{told:?}");
    let watched = Atlas::watched(&scene, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    let alone = Atlas::new(&scene, &options, &Cancel::new()).unwrap();
    assert_eq!((watched.vertices(), watched.coverage()), (alone.vertices(), alone.coverage()));
    drop((watched, alone));

    let options = VertexOptions { spacing: Some(0.1), ..VertexOptions::default() };
    for only in [None, Some(1)] {
        let work = |look_up: &mut (dyn FnMut(f64) -> ControlFlow<()> + Send)| {
            Vertices::watched(&scene, &options, only, look_up)
        };
        let mut shares = Vec::new();
        let vertices = work(&mut |share| {
            shares.push(share);
            ControlFlow::Continue(())
        });
        assert!(vertices.is_ok() && shares.len() >= 3 && shares.is_sorted(), "{shares:?}");
        let stopped = work(&mut |share| if share > 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) });
        assert_eq!(stopped.unwrap_err().kind(), ErrorKind::Cancelled);
    }
    assert_eq!(budget.used(), used);
}

#[test]
fn bakes_by_radiosity() {
    let scene = build(&sheet(6));
    let atlas = atlas(&scene, 96);
    for (threads, solver) in [(1, RadiositySolver::Gather), (2, RadiositySolver::Shoot)] {
        let mut settings = RenderSettings { threads, ..settings(1, None) };
        settings.desc.radiosity.solver = solver;
        settings.desc.radiosity.error = 50.0;
        let told = stopped_everywhere("a bake", |look_up| {
            by_radiosity(&scene, atlas.sites(), &settings, Some(0.5), true, look_up)
        });
        let inner = told.iter().filter(|share| (0.05..0.95).contains(*share)).count();
        assert!(inner >= 6, "{solver:?}: {told:?}");
        assert!(told[told.len() - 1] >= 0.9, "{solver:?}: {told:?}");
    }
}

/// The image of a solution: what is told goes on growing when it is solved.
#[test]
fn images_of_radiosity() {
    let scene = build(&sheet(6));
    let mut settings = settings(4, None);
    settings.desc.integrator = IntegratorDesc::Radiosity;
    settings.desc.resolution = [16, 16];
    let mut render = Render::new(&scene, settings).unwrap();
    let mut told = Vec::new();
    let stopped = render.run(&mut |progress| {
        told.push(progress.fraction);
        if progress.samples_done < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    assert!(stopped.unwrap().stopped);
    assert!(told.is_sorted(), "{told:?}");
    assert!(told.iter().filter(|share| (0.01..0.5).contains(*share)).count() >= 5, "{told:?}");
    assert!(told.iter().any(|share| (0.5..1.0).contains(share)), "{told:?}");
    // There is no solution to be found any more.
    let mut told = Vec::new();
    render
        .run(&mut |progress| {
            told.push(progress.fraction);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(told.iter().all(|share| *share >= 0.5) && told.is_sorted(), "{told:?}");
    assert_eq!(told.last(), Some(&1.0));
}
