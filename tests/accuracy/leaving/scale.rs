//! One picture at every scale.

use etendue::desc::{BsdfDesc, SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DVec3};
use etendue::spectrum::Rgb;

use super::instances::ball_mesh;
use super::spawn::{GREY, LIST, TREE, build};
use crate::common::scenes::{Job, camera, point_light, render_scene, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "S21", title: "one picture at every scale", run: scales },
        Entry { id: "S21a", title: "point light over a tilted plane", run: tilted_plane },
    ]
}

/// What stands on a tilted floor.
#[derive(Clone, Copy)]
enum Body {
    Nothing,
    Sphere,
    Disk,
    /// One use is copied, two are instances.
    Meshes(usize),
}

/// A floor tilted by 30 degrees with something on it, under a point light or an area light.
fn tilted(body: Body, is_area: bool, scale: f64) -> SceneDesc {
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let corner = |x: f64, y: f64| scale * DVec3::new(x, y * cos, y * sin);
    let plane = ShapeDesc::Quad([corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)]);
    let mut surfaces = vec![(plane, GREY, None)];
    let centre = scale * DVec3::new(0.2, -0.3, 0.3);
    match body {
        Body::Nothing => {}
        Body::Sphere => surfaces.push((ShapeDesc::Sphere { centre, radius: 0.3 * scale }, GREY, None)),
        Body::Disk => {
            let normal = DVec3::new(0.6, 0.0, 0.8);
            surfaces.push((ShapeDesc::Disk { centre, normal, radius: 0.4 * scale }, GREY, None));
        }
        Body::Meshes(uses) => {
            surfaces.extend((0..uses).map(|_| (ShapeDesc::Mesh { mesh: 0, smooth: uses == 1 }, GREY, None)));
        }
    }
    if is_area {
        let at = |x: f64, y: f64| scale * DVec3::new(x, y, 1.4);
        let lamp = ShapeDesc::Quad([at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0.5, -0.5)]);
        surfaces.push((lamp, BsdfDesc::Black, Some(Rgb::ONE)));
    }
    let mut desc = scene(camera(scale * DVec3::new(0.2, 0.1, 3.0), DVec3::ZERO, 40.0), surfaces);
    if let Body::Meshes(uses) = body {
        let rings = if uses == 1 { 8 } else { 60 };
        desc.meshes.push(ball_mesh(rings, 100).into());
        for number in 0..uses {
            let aside = scale * number as f64 * DVec3::new(-0.5, 0.2, 0.0);
            let stretch = DAffine3::from_scale(scale * DVec3::new(0.3, 0.2, 0.25));
            desc.surfaces[1 + number].transform =
                DAffine3::from_translation(centre + aside) * DAffine3::from_rotation_x(0.7) * stretch;
        }
    }
    if !is_area {
        desc.lights.push(point_light(scale * DVec3::new(0.0, -sin, cos), (scale * scale) as f32));
    }
    desc
}

fn scales(case: &mut Case) {
    let size = case.count(24, 96) as u32;
    let job = Job { resolution: [size; 2], samples: 4, ..Job::default() };
    let image = |desc: &SceneDesc, listed| render_scene(&build(desc, listed), job.desc()).0.rgb;
    let exponents: Vec<i32> =
        if case.is_full() { (-20..=20).collect() } else { vec![-20, -13, -10, -1, 1, 10, 13, 20] };
    for (what, body) in [
        ("plane", Body::Nothing),
        ("sphere", Body::Sphere),
        ("disk", Body::Disk),
        ("smooth mesh", Body::Meshes(1)),
        ("instances", Body::Meshes(2)),
    ] {
        for (light, is_area) in [("point light", false), ("area light", true)] {
            let reference = image(&tilted(body, is_area, 1.0), LIST);
            let differing = |scale: f64, listed| {
                let image = image(&tilted(body, is_area, scale), listed);
                image.iter().zip(&reference).filter(|(a, b)| a != b).count() as u64
            };
            let other: u64 = exponents.iter().map(|&exponent| differing(f64::from(exponent).exp2(), LIST)).sum();
            let tried = (exponents.len() * reference.len()) as u64;
            case.never(format!("{what}, {light}: values that change with 2^k"), other, tried);
            if matches!(body, Body::Sphere | Body::Disk) {
                // In the list the rejection is done in single precision, whose squares overflow at the largest scale.
                let exponents = [-25, 0, 20, 29, 33];
                let other: u64 = exponents.iter().map(|&exponent| differing(f64::from(exponent).exp2(), TREE)).sum();
                let listed: u64 = [-25, 29, 33].iter().map(|&e| differing(f64::from(e).exp2(), LIST)).sum();
                let tried = 8 * reference.len() as u64;
                case.never(format!("{what}, {light}: list, tree and 2^33"), other + listed, tried);
            }
            if is_area {
                continue;
            }
            // Powers of ten move a hit by a rounding, and an edge with it: whole shadow pixels may turn.
            let mean = |values: &[f32]| values.iter().map(|&value| f64::from(value)).sum::<f64>();
            for exponent in [-6, -3, 3, 6] {
                let image = image(&tilted(body, is_area, 10_f64.powi(exponent)), LIST);
                let got = mean(&image) / mean(&reference);
                case.exact(format!("{what}: mean at 10^{exponent}"), got, 1.0, Within::Relative(1e-5));
            }
        }
    }
}

fn tilted_plane(case: &mut Case) {
    // A camera's ray through the middle of a pixel, a light one unit above the plane's middle: albedo I / pi.
    let size = case.count(16, 64) as u32;
    let job = Job { resolution: [size; 2], samples: 1, ..Job::default() };
    let pixels = |scale: f64| render_scene(&build(&tilted(Body::Nothing, false, scale), LIST), job.desc()).0.rgb;
    let reference = pixels(1.0);
    let dark = reference.iter().filter(|value| **value <= 0.0).count();
    case.never("pixels without light", dark as u64, reference.len() as u64);
    for exponent in [-6, -3, 3, 6] {
        let image = pixels(10_f64.powi(exponent));
        let worst = image.iter().zip(&reference).map(|(a, b)| f64::from((a / b - 1.0).abs())).fold(0.0, f64::max);
        case.at_most(format!("worst pixel at 10^{exponent}, relative"), worst, 1e-5);
    }
    // The pixel at which the camera looks, through a hundredth of a degree.
    let mut desc = tilted(Body::Nothing, false, 1.0);
    desc.camera = camera(DVec3::new(0.2, 0.1, 3.0), DVec3::ZERO, 0.01);
    let got = render_scene(&build(&desc, LIST), Job { resolution: [1; 2], samples: 64, ..Job::default() }.desc()).0.rgb;
    let expected = 0.5 / std::f64::consts::PI;
    case.exact("radiance under the light", f64::from(got[0]), expected, Within::Relative(1e-5));
}
