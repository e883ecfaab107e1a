//! Samples that are not finite: left out of the image, counted, and named by pixel, surface, material and primitive.

mod common;

use std::ops::ControlFlow;

use common::scenes::{Job, box_inside, camera, point_light, scene};
use etendue::desc::{BsdfDesc, IntegratorDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings, Summary};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

/// A dim room with a quad in it that shines so brightly that twice its radiance is beyond single precision.
fn room(quad: BsdfDesc) -> SceneDesc {
    let corner = |x: f64, y: f64| DVec3::new(x, y, -0.9);
    let shape = ShapeDesc::Quad([corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)]);
    let walls = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z, 80.0),
        vec![(walls, BsdfDesc::Lambert { albedo: Rgb::splat(0.9) }, None), (shape, quad, Some(Rgb::splat(3.4e38)))],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc
}

fn run(desc: &SceneDesc, (integrator, reuse): (IntegratorDesc, bool), threads: usize) -> (Render, Summary) {
    let scene = Scene::build(desc, &BuildOptions::default()).unwrap();
    let desc = Job { resolution: [40, 24], samples: 64, integrator, ..Job::default() }.desc();
    let desc = RenderDesc { reuse: Some(reuse), ..desc };
    let mut render = Render::new(&scene, RenderSettings { desc, threads, ..RenderSettings::default() }).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    (render, summary)
}

#[test]
fn what_is_not_finite_is_named_and_never_written() {
    // Radiance of the quad and what comes back from the walls: too much together for some samples. Those who follow no
    // diffuse bounce see the walls in the quad, or the quad lit by a lamp.
    let diffuse = room(BsdfDesc::Lambert { albedo: Rgb::splat(0.9) });
    let mirror = room(BsdfDesc::Mirror { reflectance: Rgb::ONE });
    let mut lit = diffuse.clone();
    lit.lights.push(point_light(DVec3::ZERO, 3e38));
    for (desc, integrator, reuse) in [
        (&diffuse, IntegratorDesc::Path, false),
        (&diffuse, IntegratorDesc::Path, true),
        (&mirror, IntegratorDesc::Whitted, false),
        (&lit, IntegratorDesc::Direct, false),
    ] {
        let integrator = (integrator, reuse);
        let (render, summary) = run(desc, integrator, 2);
        println!("{integrator:?}: {} samples, {:?}", summary.non_finite, summary.notes);
        assert!(render.image().rgb.iter().all(|value| value.is_finite()));
        assert_eq!(summary.non_finite_samples.len() as u64, summary.non_finite.min(8));
        for found in &summary.non_finite_samples {
            assert!(!found.radiance.is_finite() && found.rays >= 1, "{found:?}");
            let hit = found.hit.expect("nothing comes from nowhere");
            assert!(hit.material == Some(hit.surface) && hit.surface < 2, "{found:?}");
            assert!(hit.primitive < if hit.surface == 0 { 12 } else { 2 }, "{found:?}");
            let [x, y] = found.pixel;
            assert!(x < 40 && y < 24 && found.sample < 64, "{found:?}");
        }
        // The same, whoever renders.
        let (_, again) = run(desc, integrator, 1);
        assert_eq!(again.non_finite, summary.non_finite);
        assert_eq!(again.non_finite_samples, summary.non_finite_samples);
        assert!(summary.non_finite > 0);
        let note = summary.notes.iter().find(|note| note.contains("NaN or infinite")).unwrap();
        assert!(note.contains("; the first: pixel (") && note.contains("primitive"), "{note}");
    }
}
