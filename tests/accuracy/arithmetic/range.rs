//! Very bright and very dark light, and very large and very small scenes.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FilterDesc, IntegratorDesc, MeshDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc,
};
use etendue::film::{Image, LayerKind};
use etendue::math::DVec3;
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::repeat::load;
use crate::common::scenes::{box_inside, camera, mean_and_error, point_light, render_scene, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "D66b", title: "Bright and dark light", run: light },
        Entry { id: "D66c", title: "One bright light, one dark", run: two_lights },
        Entry { id: "D66d", title: "Dark surfaces", run: dark_surfaces },
        Entry { id: "D66f", title: "Bright and large, dark and small", run: powers },
        Entry { id: "D66g", title: "Errors of bright and dark light", run: errors },
        Entry { id: "D66e", title: "Large and small scenes", run: sizes },
    ]
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn grey(albedo: f32) -> BsdfDesc {
    BsdfDesc::Lambert { albedo: Rgb::splat(albedo) }
}

/// A closed box with a point light, a shining ball, a shining triangle, glass and a mirror.
fn everything() -> SceneDesc {
    let ball = |x: f64, y: f64, radius: f64| ShapeDesc::Sphere { centre: DVec3::new(x, y, -0.5), radius };
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z, 70.0),
        vec![
            (
                ShapeDesc::Mesh { mesh: 0, smooth: false },
                BsdfDesc::OrenNayarQualitative { albedo: Rgb::new(0.7, 0.5, 0.3), sigma: 0.4 },
                None,
            ),
            (ball(0.3, 0.5, 0.1), grey(0.0), Some(Rgb::new(3.0, 2.0, 1.0))),
            (ball(-0.4, -0.4, 0.3), BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
            (ball(0.5, -0.5, 0.25), BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (ShapeDesc::Mesh { mesh: 1, smooth: false }, grey(0.2), Some(Rgb::new(0.5, 1.0, 2.0))),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    let lamp = MeshDesc {
        name: "lamp".into(),
        path: "meshes[1]".into(),
        positions: vec![DVec3::new(-0.5, 0.9, -0.5), DVec3::new(0.5, 0.9, -0.5), DVec3::new(0.0, 0.9, 0.5)],
        triangles: vec![[0, 1, 2]],
        ..MeshDesc::default()
    };
    desc.meshes.push(lamp.into());
    desc.lights.push(point_light(DVec3::new(-0.5, 0.5, 0.5), 0.5));
    desc
}

/// All light of a scene times `factor`.
fn scaled_light(desc: &SceneDesc, factor: f32) -> SceneDesc {
    let mut desc = desc.clone();
    desc.surfaces.iter_mut().filter_map(|surface| surface.emission.as_mut()).for_each(|emission| *emission *= factor);
    desc.lights.iter_mut().for_each(|light| light.intensity *= factor);
    desc
}

/// Values that are not those of the other image times `factor`.
fn different(image: &Image, reference: &Image, factor: f32) -> u64 {
    image.rgb.iter().zip(&reference.rgb).filter(|(a, b)| a.to_bits() != (**b * factor).to_bits()).count() as u64
}

fn light(case: &mut Case) {
    let samples = case.count(4, 64) as u32;
    let render = |scene: &Scene, integrator, sampler| {
        let filter = FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
        let desc = RenderDesc { resolution: [40, 40], samples, integrator, sampler, filter, ..RenderDesc::default() };
        render_scene(scene, desc).0
    };
    let integrators = [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct];
    let settings: Vec<_> = [SamplerDesc::Sobol, SamplerDesc::Random]
        .into_iter()
        .flat_map(|sampler| integrators.map(|integrator| (integrator, sampler)))
        .collect();
    for (name, desc) in [("every kind of light", everything()), ("room.json", load("room.json"))] {
        let plain = build(&desc);
        let references: Vec<Image> = settings.iter().map(|&(i, s)| render(&plain, i, s)).collect();
        // 2^66 is 7.4e19; what lies beyond is what single precision can hold.
        for power in [-66, 66, -90, 100] {
            let factor = (power as f32).exp2();
            let scaled = build(&scaled_light(&desc, factor));
            let (mut others, mut values) = (0, 0);
            for (&(integrator, sampler), reference) in settings.iter().zip(&references) {
                others += different(&render(&scaled, integrator, sampler), reference, factor);
                values += reference.rgb.len() as u64;
            }
            case.never(format!("{name}, times 2^{power}: other values"), others, values);
        }
    }
}

/// Light and size together: what a lamp sends out is its radiance times its area, which single precision may not hold while
/// it holds either.
fn powers(case: &mut Case) {
    let samples = case.count(4, 64) as u32;
    let render = RenderDesc { resolution: [40, 40], samples, ..RenderDesc::default() };
    let mut desc = everything();
    // Their intensity would be out of range itself.
    desc.lights.clear();
    let reference = render_scene(&build(&desc), render.clone()).0;
    for (size, light) in [(28, 90), (-25, -90), (28, -66), (-25, 66)] {
        let factor = (light as f32).exp2();
        let scene = build(&scaled_light(&scaled(&desc, f64::from(size).exp2()), factor));
        let others = different(&render_scene(&scene, render.clone()).0, &reference, factor);
        let what = format!("lengths times 2^{size}, light times 2^{light}: other values");
        case.never(what, others, reference.rgb.len() as u64);
    }
}

/// Standard error and variance of each value, in the light's unit and its square.
fn error_layers(scene: &Scene, samples: u32) -> [Vec<f32>; 2] {
    let desc = RenderDesc { resolution: [16, 16], samples, ..RenderDesc::default() };
    let settings = RenderSettings { desc, threads: 2, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).expect("settings of the test");
    render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
    [LayerKind::StandardError, LayerKind::Variance].map(|kind| {
        let mut data = vec![0.0; 3 * 16 * 16];
        render.film().layer_into(kind, &mut data).expect("a layer of this size");
        data
    })
}

fn errors(case: &mut Case) {
    let samples = case.count(16, 256) as u32;
    let plain = error_layers(&build(&everything()), samples);
    for power in [-66, 66] {
        let factor = (power as f32).exp2();
        let scaled = error_layers(&build(&scaled_light(&everything(), factor)), samples);
        // The factor of a variance is out of range itself, its root is not.
        let different = |layer: usize, factors: [f32; 2]| {
            let pairs = scaled[layer].iter().zip(&plain[layer]);
            let off = |a: f32, b: f32| (a / factors[0] / factors[1] - b).abs();
            pairs.filter(|&(&a, &b)| off(a, b) > 1e-6 * b || off(a, b).is_nan()).count() as u64
        };
        let values = plain[0].len() as u64;
        let what = format!("standard error, light times 2^{power}: other values");
        case.never(what, different(0, [factor, 1.0]), values);
        if power < 0 {
            case.known(
                "the layer is in the square of the light's unit, of which single precision holds 10^-38 to 10^38",
            )
            .never(
                format!("variance, light times 2^{power}: other values"),
                different(1, [factor; 2]),
                values,
            );
        }
    }
}

/// A floor at y = 0, seen from above its origin.
fn floor(albedo: f32) -> SceneDesc {
    let eye = CameraDesc::Perspective {
        eye: DVec3::new(0.0, 1.0, 0.0),
        look_at: DVec3::ZERO,
        up: DVec3::X,
        fov_deg: 0.2,
        fov_axis: etendue::desc::FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let mut desc = scene(eye, vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, grey(albedo), None)]);
    let corners = [(-4.0, -4.0), (-4.0, 4.0), (4.0, 4.0), (4.0, -4.0)];
    let mesh = MeshDesc {
        name: "floor".into(),
        path: "meshes[0]".into(),
        positions: corners.map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshDesc::default()
    };
    desc.meshes.push(mesh.into());
    desc
}

fn two_lights(case: &mut Case) {
    let samples = case.count(256, 16_384) as u32;
    // A lamp of 1 and one of 10^-20: what the first does not light, the second must, with the same relative error as a dim
    // light that is one of two.
    for (name, dim) in [("1 : 10^-10", 1e-10_f32), ("1 : 10^-20", 1e-20), ("10^20 : 10^-15", 1e-15)] {
        let bright = if name.starts_with("10^20") { 1e20 } else { 1.0 };
        let mut desc = floor(0.5);
        // The bright one is under the floor.
        desc.lights.push(point_light(DVec3::new(0.0, -1.0, 0.0), bright));
        desc.lights.push(point_light(DVec3::new(0.0, 1.0, 1.0), dim));
        let render = RenderDesc { resolution: [4, 4], samples, ..RenderDesc::default() };
        let image = render_scene(&build(&desc), render).0;
        // rho I cos / (pi d^2), with d^2 = 2; in units of the dim lamp, whose square single precision does not hold.
        let exact = 0.5 * 0.5_f64.sqrt() / (2.0 * PI);
        let (mut mean, mut values) = (0.0, Vec::new());
        for pixel in image.rgb.chunks_exact(3) {
            values.push(f64::from(pixel[0]) / f64::from(dim));
            mean += values[values.len() - 1] / 16.0;
        }
        let (_, error) = crate::stats::mean_and_error(&values);
        case.mean(format!("{name}: where the dim one shines alone"), (mean, error), exact, 0.05);
    }
    // Where both shine, the bright one is not disturbed.
    let mut desc = floor(0.5);
    desc.lights.push(point_light(DVec3::new(0.0, 1.0, 1.0), 1.0));
    desc.lights.push(point_light(DVec3::new(0.0, 1.0, -1.0), 1e-20));
    let render = RenderDesc { resolution: [4, 4], samples, ..RenderDesc::default() };
    let image = render_scene(&build(&desc), render).0;
    let exact = 0.5 * 0.5_f64.sqrt() / (2.0 * PI);
    case.mean("1 : 10^-20: where both shine", mean_and_error(&image), exact, 0.02);
}

fn dark_surfaces(case: &mut Case) {
    let render = RenderDesc { resolution: [4, 4], samples: 16, ..RenderDesc::default() };
    for (albedo, intensity) in [(1e-30_f32, 1.0_f32), (1e-30, 1e30), (1e-10, 1e-20), (1.0, 1e-30), (1.0, 1e30)] {
        let mut desc = floor(albedo);
        desc.lights.push(point_light(DVec3::new(0.0, 1.0, 1.0), intensity));
        let image = render_scene(&build(&desc), render.clone()).0;
        let exact = f64::from(albedo) * f64::from(intensity) * 0.5_f64.sqrt() / (2.0 * PI);
        // Over the symmetrical pixels, what the footprint changes is of second order.
        let mean = image.mean()[0];
        case.exact(format!("albedo {albedo:e}, light {intensity:e}"), mean, exact, Within::Relative(2e-5));
    }
    // In a closed box that shines everywhere, of albedo 10^-30 and 10^-45: 1 / (1 - albedo) is 1.
    for albedo in [1e-30_f32, f32::from_bits(1)] {
        let walls = (ShapeDesc::Mesh { mesh: 0, smooth: false }, grey(albedo), Some(Rgb::ONE));
        let mut desc = scene(camera(DVec3::ZERO, DVec3::NEG_Z, 90.0), vec![walls]);
        desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
        let image = render_scene(&build(&desc), render.clone()).0;
        let worst = image.rgb.iter().map(|value| (f64::from(*value) - 1.0).abs()).fold(0.0, f64::max);
        case.exact(format!("shining box of albedo {albedo:e}: worst pixel"), 1.0 + worst, 1.0, Within::Absolute(1e-6));
    }
}

/// The scene with all its lengths times `factor`, and its point lights such that nothing else changes.
fn scaled(desc: &SceneDesc, factor: f64) -> SceneDesc {
    let mut desc = desc.clone();
    for mesh in &mut desc.meshes {
        std::sync::Arc::make_mut(mesh).positions.iter_mut().for_each(|position| *position *= factor);
    }
    for surface in &mut desc.surfaces {
        if let ShapeDesc::Sphere { centre, radius } = &mut surface.shape {
            *centre *= factor;
            *radius *= factor;
        }
    }
    for light in &mut desc.lights {
        light.position *= factor;
        light.intensity *= (factor * factor) as f32;
    }
    if let CameraDesc::Perspective { eye, look_at, .. } = &mut desc.camera {
        *eye *= factor;
        *look_at *= factor;
    }
    desc
}

fn sizes(case: &mut Case) {
    let samples = case.count(4, 64) as u32;
    let desc = everything();
    let render = RenderDesc { resolution: [40, 40], samples, ..RenderDesc::default() };
    let reference = render_scene(&build(&desc), render.clone()).0;
    // Within the sizes that a scene may have without a warning.
    for power in [-25, -20, -10, 10, 20, 28] {
        let scene = build(&scaled(&desc, f64::from(power).exp2()));
        let quiet = scene.warnings().is_empty();
        let others = different(&render_scene(&scene, render.clone()).0, &reference, 1.0);
        let others = if quiet { others } else { u64::MAX };
        case.never(format!("all lengths times 2^{power}: other values"), others, reference.rgb.len() as u64);
    }
    // Outside of them, products of three lengths leave single precision.
    let silent = [-50, -30, 31, 50].into_iter().filter(|&power| {
        let desc = scaled(&desc, f64::from(power).exp2());
        Scene::build(&desc, &BuildOptions::default()).is_ok_and(|scene| scene.warnings().is_empty())
    });
    case.never("2^-50, 2^-30, 2^31, 2^50: no warning", silent.count() as u64, 4);
}
