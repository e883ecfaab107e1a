//! Light through slabs, prisms and balls of glass: how much of it, and where to.

use std::f64::consts::{FRAC_PI_2, PI};

use super::rays::{Choices, PATH, REFLECT, REFRACT, Random, Recorder, angle, follow, line};
use super::{Known, ball, converges, glass, measure, parallelogram, pick, plane};
use crate::common::scenes::{Job, box_inside, camera, scene};
use crate::record::{Case, Entry, Within};
use etendue::bsdf::fresnel_dielectric;
use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::integrator::{Integrator, SceneTracer, Whitted};
use etendue::math::{DVec3, Ray};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R61", title: "glass slab", run: slab },
        Entry { id: "R61b", title: "way through a slab", run: shift },
        Entry { id: "R61c", title: "prism", run: prism },
        Entry { id: "R62", title: "focus of a glass ball", run: focus },
        Entry { id: "R62b", title: "light through a glass ball", run: ball_shares },
        Entry { id: "R62c", title: "rainbow", run: rainbow },
        Entry { id: "R40b", title: "radiance seen from within glass", run: from_within },
    ]
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn fresnel(degrees: f64, eta: f64) -> f64 {
    fresnel_dielectric(degrees.to_radians().cos(), eta)
}

/// A slab between z = 0 and `thickness`, so many times as wide.
fn slab_surfaces(thickness: f64, aspect: f64) -> Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)> {
    let half = 0.5 * aspect * thickness;
    vec![
        (plane(DVec3::ZERO, DVec3::NEG_Z, half), glass(1.5, 1.0), None),
        (plane(DVec3::Z * thickness, DVec3::Z, half), glass(1.5, 1.0), None),
    ]
}

/// An eye before a slab that looks at it under this angle; behind the slab everything shines.
pub fn lit_slab(degrees: f64) -> SceneDesc {
    let mut surfaces = slab_surfaces(1.0, 2000.0);
    surfaces.push((plane(DVec3::Z * 3.0, DVec3::NEG_Z, 1e3), BsdfDesc::Black, Some(Rgb::ONE)));
    let (sin, cos) = degrees.to_radians().sin_cos();
    scene(camera(DVec3::new(0.0, 0.0, -2.0), DVec3::new(2.0 * sin, 0.0, 2.0 * cos - 2.0), 0.01), surfaces)
}

/// What passes a slab, with all reflections inside.
pub fn slab_transmittance(degrees: f64) -> f64 {
    let f = fresnel(degrees, 1.5);
    (1.0 - f) / (1.0 + f)
}

fn slab(case: &mut Case) {
    for (degrees, stated) in [(0.0, 12.0 / 13.0), (30.0, 0.920_265_532_519), (60.0, 0.836_232_462_710)] {
        let desc = lit_slab(degrees);
        case.exact(
            format!("(1 - F) / (1 + F) at {degrees}°"),
            slab_transmittance(degrees),
            stated,
            Within::Relative(1e-6),
        );
        let job = Job { resolution: [16, 16], samples: case.count(256, 8192) as u32, ..Job::default() };
        case.mean(format!("path, {degrees}°"), measure(&desc, &job), stated, pick(case, 2e-3, 3e-4));
        if degrees == 30.0 {
            converges(case, "glass slab at 30°", &desc, (Known::EachPixel, stated));
        }
        // The tree grows while a branch carries a 64th, and goes on by chance.
        let integrator = IntegratorDesc::Whitted;
        let job = Job { samples: case.count(64, 1024) as u32, integrator, ..job };
        case.mean(format!("Whitted, {degrees}°"), measure(&desc, &job), stated, pick(case, 1e-3, 2e-5));
        // Cut after 3, 5 and 7 hits, the last of which is the light: the sum over two, four, six passages of a face.
        let f = fresnel(degrees, 1.5);
        for (hits, terms) in [(3, 1.0), (5, 1.0 + f * f), (7, 1.0 + f * f + f.powi(4))] {
            let job = Job { max_depth: Some(hits), samples: case.count(16, 256) as u32, ..job.clone() };
            let exact = (1.0 - f) * (1.0 - f) * terms;
            case.mean(format!("Whitted, {degrees}°, {hits} hits"), measure(&desc, &job), exact, 1e-3);
        }
    }
}

fn shift(case: &mut Case) {
    for (thickness, aspect, name) in
        [(1.0, 20.0, "20 x 1"), (1e-3, 20.0, "0.02 x 0.001"), (1e3, 20.0, "20000 x 1000"), (1.0, 2000.0, "2000 x 1")]
    {
        let eye = DVec3::new(0.1, 0.2, -1.3) * thickness;
        let scene = build(&scene(camera(eye, DVec3::ZERO, 40.0), slab_surfaces(thickness, aspect)));
        for (degrees, stated) in [(30.0_f64, 0.193_813_782_152), (60.0, 0.512_472_013_191)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let start = (eye, DVec3::new(0.6 * sin, 0.8 * sin, cos));
            let rays = follow(&scene, start, &[REFRACT], 3);
            let (origin, direction) = line(&scene, &rays[2]);
            let shift = (origin - eye).reject_from(direction).length() / thickness;
            if aspect > 1000.0 {
                case.known(
                    "a ray leaves a triangle by a millionth of its extent along the normal, beside its own line",
                );
            }
            case.exact(format!("{name}, {degrees}°: shift / thickness"), shift, stated, Within::Absolute(1e-4));
            let turned = angle(direction, start.1);
            case.exact(format!("{name}, {degrees}°: turn, rad"), turned, 0.0, Within::Absolute(1e-6));
        }
    }
}

fn prism(case: &mut Case) {
    // Equilateral, index 1.5, its refracting edge along z.
    let (left, right, top) =
        (DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 3.0_f64.sqrt(), -1.0));
    let along = DVec3::Z * 2.0;
    let face = |a: DVec3, b: DVec3| (parallelogram(a, along, b - a), glass(1.5, 1.0), None);
    let eye = DVec3::new(-5.0, 0.8, 0.0);
    let desc = scene(camera(eye, DVec3::Y, 40.0), vec![face(left, top), face(top, right), face(right, left)]);
    let scene = build(&desc);
    // Through the middle of the left face, whose normal is 30° above -x.
    let target = 0.5 * (left + top) + DVec3::Z;
    let deviation = |incidence: f64| -> f64 {
        let direction = (incidence - PI / 6.0).sin_cos();
        let direction = DVec3::new(direction.1, direction.0, 0.0);
        let rays = follow(&scene, (target - 2.0 * direction, direction), &[REFRACT], 3);
        assert_eq!(rays.len(), 3, "the ray misses the second face");
        angle(line(&scene, &rays[2]).1, direction)
    };
    let at = |degrees: f64| deviation(degrees.to_radians());
    let symmetric = (1.5 * 0.5_f64).asin().to_degrees();
    case.exact("symmetric passage, rad", at(symmetric), 37.180_755_781_5_f64.to_radians(), Within::Absolute(1e-6));
    case.exact("incidence 60°, rad", at(60.0), 38.876_769_612_4_f64.to_radians(), Within::Absolute(1e-6));
    let least = (0..2000).map(|i| at(40.0 + 0.01 * f64::from(i))).fold(f64::INFINITY, f64::min);
    case.exact("minimum deviation, rad", least, 37.180_755_781_5_f64.to_radians(), Within::Absolute(1e-6));
    // Beyond the limit of total reflection nothing comes through: r' = 60° - r above the critical angle.
    let critical = (1.0 / 1.5_f64).asin();
    let limit = (1.5 * (PI / 3.0 - critical).sin()).asin().to_degrees();
    case.holds(
        "total reflection just below its limit only",
        "deviation above, none below",
        format!("limit {limit:.5}°"),
        at(limit + 1e-3) < FRAC_PI_2 && {
            let (sin, cos) = (limit - 1e-3 - 30.0).to_radians().sin_cos();
            let direction = DVec3::new(cos, sin, 0.0);
            let rays = follow(&scene, (target - 2.0 * direction, direction), &[REFRACT], 3);
            // Inside still: the third ray turns back from the right face.
            line(&scene, &rays[2]).1.x < line(&scene, &rays[1]).1.x
        },
    );
}

/// A glass ball of radius 1 around the origin, an eye far down the z axis, everything shining.
fn glass_ball(ior: f32, shape: ShapeDesc) -> Scene {
    let eye = DVec3::new(0.0, 0.0, -5.0);
    let sky = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let mut desc = scene(
        camera(eye, DVec3::ZERO, 40.0),
        vec![(shape, glass(ior, 1.0), None), (sky, BsdfDesc::Black, Some(Rgb::ONE))],
    );
    desc.meshes.push(box_inside(DVec3::splat(-9.0), DVec3::splat(9.0)).into());
    build(&desc)
}

/// A ray parallel to the axis at this height, turned about the axis so that nothing is special.
fn parallel_ray(height: f64) -> (DVec3, DVec3) {
    (DVec3::new(0.8 * height, 0.6 * height, -5.0), DVec3::Z)
}

fn focus(case: &mut Case) {
    let unit = ball(DVec3::ZERO, 1.0);
    let ellipsoid = ShapeDesc::ellipsoid(DVec3::ZERO, DVec3::ONE).expect("a ball");
    for (name, ior, stated) in [("1.5", 1.5_f32, 1.5), ("1.333", 1.333, 2.001_501_501_50)] {
        let scene = glass_ball(ior, unit);
        case.exact(format!("index {name}: paraxial focus"), crossing(&scene, 1e-3), stated, Within::Absolute(1e-4));
    }
    let scene = glass_ball(1.5, unit);
    let heights = [
        (0.1, 1.495_827_063_06),
        (0.3, 1.461_978_436_96),
        (0.5, 1.391_572_948_89),
        (0.7, 1.277_787_023_38),
        (0.9, 1.104_445_568_37),
    ];
    for (height, stated) in heights {
        case.exact(format!("crossing at height {height}"), crossing(&scene, height), stated, Within::Absolute(1e-5));
    }
    // The same ball as a quadric.
    let mut desc = crate::common::scenes::scene(
        camera(DVec3::new(0.0, 0.0, -5.0), DVec3::ZERO, 40.0),
        vec![(ellipsoid.0, glass(1.5, 1.0), None)],
    );
    desc.surfaces[0].local = ellipsoid.1;
    let scene = build(&desc);
    for (height, stated) in heights {
        let got = crossing(&scene, height);
        case.exact(format!("quadric, height {height}"), got, stated, Within::Absolute(1e-5));
    }
}

/// Where the refracted ray that came in at this height crosses the axis.
fn crossing(scene: &Scene, height: f64) -> f64 {
    let rays = follow(scene, parallel_ray(height), &[REFRACT], 3);
    let (origin, direction) = line(scene, &rays[2]);
    // In the plane of the ray and the axis.
    let axis = DVec3::new(0.8, 0.6, 0.0);
    origin.z - origin.dot(axis) * direction.z / direction.dot(axis)
}

/// Radiance of a ray by Whitted's tree, cut after so many hits.
fn tree(scene: &Scene, (origin, direction): (DVec3, DVec3), max_depth: u32) -> f64 {
    let ray = Ray::new(scene.to_scene(origin), direction.as_vec3a());
    let whitted = Whitted { max_depth: Some(max_depth), shadow_rays: 1 };
    let mut tracer = SceneTracer::new(scene);
    f64::from(whitted.radiance(scene, ray, &mut Choices::new(&[0.5]), &mut tracer, &mut |_| {}).r())
}

fn ball_shares(case: &mut Case) {
    let scene = glass_ball(1.5, ball(DVec3::ZERO, 1.0));
    for (height, stated) in [
        (0.1, 0.921_596_825_411),
        (0.3, 0.921_310_010_056),
        (0.5, 0.918_678_876_516),
        (0.7, 0.903_259_159_797),
        (0.9, 0.784_745_990_317),
    ] {
        // Everything shines: two hits show what is reflected at once, three also what is refracted twice.
        let ray = parallel_ray(height);
        let share = tree(&scene, ray, 3) - tree(&scene, ray, 2);
        case.exact(format!("height {height}: (1 - F)²"), share, stated, Within::Relative(1e-6));
    }
    // Of the path's random ways, the share that is refracted twice.
    let tries = case.count(20_000, 2_000_000);
    let mut random = Random(Rng::new(5, 0));
    let (origin, direction) = parallel_ray(0.7);
    let ray = Ray::new(scene.to_scene(origin), direction.as_vec3a());
    let mut straight = 0.0;
    for _ in 0..tries {
        let mut tracer = Recorder::new(&scene, usize::MAX);
        PATH.radiance(&scene, ray, &mut random, &mut tracer, &mut |_| {});
        straight += f64::from(u8::from(tracer.rays.len() == 3));
    }
    let (n, p) = (tries as f64, 0.903_259_159_797);
    case.mean("height 0.7, path", (straight / n, (p * (1.0 - p) / n).sqrt()), p, pick(case, 3e-3, 3e-4));

    for (name, ior, refracted, reflected) in [
        ("1.5", 1.5_f32, 0.835_544_400_144, 0.091_777_959_342_4),
        ("1.333", 1.333, 0.881_437_392_471, 0.066_405_764_783_1),
    ] {
        // A parallel beam that fills the ball, equal areas.
        let scene = glass_ball(ior, ball(DVec3::ZERO, 1.0));
        let rings = case.count(2_000, 200_000);
        let (mut twice, mut at_once) = (0.0, 0.0);
        for ring in 0..rings {
            let ray = parallel_ray(((ring as f64 + 0.5) / rings as f64).sqrt());
            let first = tree(&scene, ray, 2);
            at_once += first / rings as f64;
            twice += (tree(&scene, ray, 3) - first) / rings as f64;
        }
        let within = Within::Relative(pick(case, 1e-3, 1e-4));
        case.exact(format!("index {name}: share refracted twice"), twice, refracted, within);
        case.exact(format!("index {name}: share reflected at once"), at_once, reflected, within);
    }
}

fn rainbow(case: &mut Case) {
    let scene = glass_ball(1.333, ball(DVec3::ZERO, 1.0));
    let steps = case.count(2_000, 200_000);
    let deviation = |height: f64| {
        let start = parallel_ray(height);
        let rays = follow(&scene, start, &[REFRACT, REFLECT, REFRACT], 4);
        angle(line(&scene, &rays[3]).1, start.1)
    };
    let least = (0..steps).map(|i| deviation(0.8 + 0.1 * i as f64 / steps as f64)).fold(f64::INFINITY, f64::min);
    case.exact("least deviation, rad", least, 137.921_892_620_f64.to_radians(), Within::Absolute(1e-5));
}

fn from_within(case: &mut Case) {
    // The eye in a half-space of glass, everything outside shining: n² (1 - F) inside the critical angle, 0 beyond.
    let desc = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let face = (plane(DVec3::ZERO, DVec3::Y, 1e3), glass(1.5, 1.0), None);
        let sky = (plane(DVec3::Y, DVec3::NEG_Y, 1e3), BsdfDesc::Black, Some(Rgb::ONE));
        scene(camera(-DVec3::new(sin, cos, 0.0), DVec3::ZERO, 0.001), vec![face, sky])
    };
    for degrees in [0.0, 30.0, 41.0] {
        let exact = 2.25 * (1.0 - fresnel(degrees, 1.0 / 1.5));
        let job = Job { resolution: [16, 16], samples: case.count(256, 4096) as u32, ..Job::default() };
        case.mean(format!("path, {degrees}°"), measure(&desc(degrees), &job), exact, pick(case, 4e-3, 1e-3));
        let job = Job { samples: 4, integrator: IntegratorDesc::Whitted, ..job };
        case.mean(format!("Whitted, {degrees}°"), measure(&desc(degrees), &job), exact, 1e-4);
    }
    let job = Job { resolution: [16, 16], samples: 64, ..Job::default() };
    case.exact("beyond the critical angle, 42°", measure(&desc(42.0), &job).0, 0.0, Within::Absolute(0.0));
}
