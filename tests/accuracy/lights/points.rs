//! Point lights, and which side of a light shines.

use std::f64::consts::PI;
use std::sync::Arc;

use etendue::desc::{BsdfDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::emitter::{Emitter, EmitterSet};
use etendue::math::{DVec3, Ray, Vec3};
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{INTEGRATORS, irradiance, lit, quad};
use crate::common::scenes::{Job, camera, point_light, render};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "L45", title: "point light", run: points }, Entry { id: "L46", title: "dark sides", run: sides }]
}

fn points(case: &mut Case) {
    // The samplers' own values, at any distance and for any intensity that single precision holds.
    let towards = DVec3::new(0.6, 0.0, 0.8);
    for distance in [1e-10, 1e-3, 1.0, 1e4, 1e10] {
        let position = (distance * towards).as_vec3a();
        let intensity = Rgb::splat((distance * distance) as f32);
        let set = EmitterSet::new(vec![Emitter::Point { position, intensity }]);
        let (mean, _) = irradiance(case, &set, Vec3::ZERO, DVec3::Z);
        case.exact(format!("distance {distance:e}"), mean, 0.8 / PI, Within::Relative(1e-6));
        let (behind, _) = irradiance(case, &set, Vec3::ZERO, -DVec3::Z);
        case.exact(format!("distance {distance:e}, from below"), behind, 0.0, Within::Absolute(0.0));
    }
    // Along a floor, from a height of 3: 3 I / (9 + r^2)^(3/2).
    for r in [0.0, 0.5, 1.0, 2.0, 5.0, 20.0, 3000.0] {
        let set = EmitterSet::new(vec![Emitter::Point { position: Vec3::new(0.0, 0.0, 3.0), intensity: Rgb::ONE }]);
        let (mean, _) = irradiance(case, &set, Vec3::new(0.6 * r as f32, 0.8 * r as f32, 0.0), DVec3::Z);
        let r = f64::from(0.6 * r as f32).hypot(f64::from(0.8 * r as f32));
        case.exact(format!("height 3, {r:.1} aside"), mean * PI, 3.0 / (9.0 + r * r).powf(1.5), Within::Relative(1e-6));
    }
    let at_it = EmitterSet::new(vec![Emitter::Point { position: Vec3::ONE, intensity: Rgb::ONE }]);
    let (mean, _) = irradiance(case, &at_it, Vec3::ONE, DVec3::Z);
    case.exact("receiver at the light itself", mean, 0.0, Within::Absolute(0.0));

    for distance in [1e-3, 1.0, 1e4] {
        let mut desc = lit(0.1 * distance, 1e-3 * distance, vec![]);
        desc.lights.push(point_light(distance * towards, (distance * distance) as f32));
        for (name, integrator) in INTEGRATORS {
            // No variance but for the footprint.
            let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
            let (image, _) = render(&desc, &job);
            let what = format!("distance {distance:e}, {name}");
            case.exact(what, image.mean()[0], 0.8 / PI, Within::Relative(2e-6));
        }
    }
}

/// One light alone in the scene, with a white receiver below it where there is one.
fn alone(shape: ShapeDesc, mesh: Option<MeshDesc>, eye: DVec3, look_at: DVec3) -> SceneDesc {
    let mut desc =
        crate::common::scenes::scene(camera(eye, look_at, 40.0), vec![(shape, BsdfDesc::Black, Some(Rgb::ONE))]);
    desc.meshes.extend(mesh.map(Arc::new));
    desc
}

fn sides(case: &mut Case) {
    let up = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
    let triangle = ShapeDesc::Triangle([up[0], up[1], up[2]].map(super::point));
    let ball = ShapeDesc::Sphere { centre: DVec3::Z, radius: 0.5 };
    // A box whose faces look outwards.
    let outwards = || {
        let mut mesh = crate::common::scenes::box_inside(DVec3::new(-0.5, -0.5, 0.5), DVec3::new(0.5, 0.5, 1.5));
        for triangle in &mut mesh.triangles {
            triangle.swap(1, 2);
        }
        mesh
    };
    let mesh = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let (above, below) = (DVec3::new(0.1, 0.2, 4.0), DVec3::new(0.1, 0.2, -2.0));
    let inside = DVec3::new(0.1, 0.05, 0.9);
    let tries = case.count(5_000, 1_000_000);
    for (name, shape, is_mesh, dark, bright, look_at) in [
        ("triangle", triangle, false, below, above, DVec3::new(0.3, 0.0, 1.0)),
        ("quad", quad(up), false, below, above, DVec3::new(0.3, 0.0, 1.0)),
        ("sphere", ball, false, inside, above, DVec3::Z),
        ("mesh", mesh, true, inside, above, DVec3::Z),
    ] {
        let desc = |eye| alone(shape, is_mesh.then(outwards), eye, look_at);
        // Seen by the camera, and with a receiver in place of the camera: samples of the light and of the Bsdf.
        for (whose, integrator) in INTEGRATORS {
            let job = Job { resolution: [16, 16], samples: 16, integrator, ..Job::default() };
            let (image, _) = render(&desc(dark), &job);
            let bright_values = image.rgb.iter().filter(|&&value| value != 0.0).count();
            case.never(format!("{name}, {whose}: its dark side seen"), bright_values as u64, image.rgb.len() as u64);
        }
        let (image, _) = render(&desc(bright), &Job { resolution: [16, 16], samples: 16, ..Job::default() });
        let most = image.rgb.iter().fold(0.0_f32, |most, &value| most.max(value));
        case.exact(format!("{name}: its bright side seen"), f64::from(most), 1.0, Within::Absolute(0.0));

        let scene = Scene::build(&desc(dark), &BuildOptions::default()).expect("a scene of the test");
        let p = scene.to_scene(dark);
        let mut rng = Rng::new(46, 0);
        let (mut sampled, mut met, mut hits) = (0, 0, 0);
        for _ in 0..tries {
            if let Some(sample) = scene.emitters().sample(p, rng.next_4d()) {
                // A box has faces whose bright sides a point inside it is not before; none of them is reached.
                let shadow = Ray::segment(p, sample.target - p, 1.0);
                sampled += u64::from(scene.unoccluded(&shadow));
            }
            let ray = Ray::new(p, warps::uniform_sphere(rng.next_2d()));
            if let Some(hit) = scene.intersect(&ray) {
                let surface = scene.interaction(&ray, &hit);
                let emitter = surface.emitter.expect("the only surface shines");
                hits += 1;
                met +=
                    u64::from(scene.emitters().le(emitter, surface.ng, -ray.direction, surface.point.p) != Rgb::ZERO);
            }
        }
        case.never(format!("{name}: light samples from its dark side"), sampled, tries);
        case.never(format!("{name}: light met on its dark side"), met, hits);
    }
    // A receiver below lights that shine up.
    for (name, shape) in [("triangle", triangle), ("quad", quad(up))] {
        for (whose, integrator) in INTEGRATORS {
            let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
            let (image, _) = render(&lit(0.5, 1e-3, vec![shape]), &job);
            let bright = image.rgb.iter().filter(|&&value| value != 0.0).count();
            case.never(format!("{name}, {whose}: a receiver behind it lit"), bright as u64, image.rgb.len() as u64);
        }
    }
}
