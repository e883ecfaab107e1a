//! Furnaces: closed rooms whose walls all emit Le and reflect a share a. The radiance everywhere is Le / (1 - a), whatever
//! the shape of the room, what stands in it, and how a wall scatters as long as its albedo is a for every direction.
//! Blind to wrong directions, so the other cases of the group go with them.

use super::rays::escapes;
use super::{Known, MESH, ball, ball_mesh, converges, glass, grey, measure, mesh, mirror, pick, turned};
use crate::common::scenes::{Job, box_inside, camera, mean_and_error, render, render_scene, scene};
use crate::record::{Case, Entry, Within};
use etendue::desc::{BsdfDesc, IntegratorDesc, MeshDesc, RenderDesc, RouletteDesc, SceneDesc, ShapeDesc};
use etendue::math::{Bounds, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R54", title: "glass and mirrors under uniform light", run: clear_bodies },
        Entry { id: "R54b", title: "diffuse surfaces under uniform light", run: diffuse_surfaces },
        Entry { id: "R54c", title: "bodies of triangles under uniform light", run: meshes },
        Entry { id: "R55", title: "emitting box", run: emitting_box },
        Entry { id: "R55b", title: "emitting rooms of other shapes", run: other_shapes },
        Entry { id: "R55c", title: "emitting box, path cut", run: cut },
        Entry { id: "R55d", title: "objects in an emitting box", run: objects },
        Entry { id: "R55e", title: "emitting mirrors", run: mirror_walls },
        Entry { id: "R55f", title: "roulette by the scene's own probability", run: survival },
    ]
}

const EYE: DVec3 = DVec3::new(0.3, -0.2, 0.1);

/// The box of every case: eye and object are well inside.
fn walls() -> MeshDesc {
    box_inside(DVec3::new(-1.0, -0.8, -1.5), DVec3::new(1.2, 1.0, 0.9))
}

/// An emitting room with things in it.
fn room(shape: MeshDesc, wall: BsdfDesc, le: f32, objects: Vec<(ShapeDesc, BsdfDesc)>) -> SceneDesc {
    let mut surfaces = vec![(MESH, wall, Some(Rgb::splat(le)))];
    surfaces.extend(objects.into_iter().map(|(shape, bsdf)| (shape, bsdf, None)));
    let mut desc = scene(camera(EYE, DVec3::new(-0.4, 0.1, -1.0), 100.0), surfaces);
    desc.meshes.push(shape.into());
    desc
}

const CENTRE: DVec3 = DVec3::new(-0.3, 0.0, -0.8);

fn object() -> ShapeDesc {
    ball(CENTRE, 0.4)
}

/// The object alone fills the image.
fn look_at_object(desc: &mut SceneDesc) {
    desc.camera = camera(EYE, CENTRE, 29.0);
}

fn ellipsoid() -> ShapeDesc {
    ShapeDesc::Quadric {
        coefficients: [9.0, 16.0, 4.0, 0.0, 0.0, 0.0, 2.7, 0.0, 3.2, 2.37],
        clip: Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
    }
}

/// What nested bodies are made of: (radius, index inside, index outside).
type Shells = &'static [(f64, f32, f32)];

fn clear_bodies(case: &mut Case) {
    let bodies: [(&str, Shells); 8] = [
        ("glass 1.5", &[(0.4, 1.5, 1.0)]),
        ("water", &[(0.4, 1.333, 1.0)]),
        ("diamond", &[(0.4, 2.417, 1.0)]),
        ("bubble, index 1/1.5", &[(0.4, 1.0, 1.5)]),
        ("glass shell full of air", &[(0.4, 1.5, 1.0), (0.37, 1.0, 1.5)]),
        ("water in glass", &[(0.4, 1.5, 1.0), (0.36, 1.333, 1.5)]),
        ("air in water in glass", &[(0.4, 1.5, 1.0), (0.36, 1.333, 1.5), (0.2, 1.0, 1.333)]),
        ("the same index inside and out", &[(0.4, 1.0, 1.0)]),
    ];
    for (what, shells) in bodies {
        let objects = shells.iter().map(|&(radius, ior, exterior)| (ball(CENTRE, radius), glass(ior, exterior)));
        let mut desc = room(walls(), BsdfDesc::Black, 1.0, objects.collect());
        look_at_object(&mut desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
            let samples = case.count(4, 256) as u32;
            let (image, _) = render(&desc, &Job { resolution: [24, 24], samples, integrator, ..Job::default() });
            if integrator == IntegratorDesc::Path {
                let worst = image.rgb.iter().map(|&value| (f64::from(value) - 1.0).abs()).fold(0.0, f64::max);
                case.exact(format!("{what}, path: farthest pixel from 1"), 1.0 + worst, 1.0, Within::Absolute(1e-5));
            } else {
                case.mean(format!("{what}, Whitted"), mean_and_error(&image), 1.0, 1e-3);
            }
        }
    }
    let mut desc = room(walls(), BsdfDesc::Black, 1.0, vec![(object(), mirror(0.8))]);
    look_at_object(&mut desc);
    let exact = f64::from(0.8_f32);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
        let (image, _) = render(&desc, &Job { samples: 4, integrator, ..Job::default() });
        let worst = image.rgb.iter().map(|&value| (f64::from(value) - exact).abs()).fold(0.0, f64::max);
        case.exact(
            format!("mirror of 0.8, {integrator:?}: farthest pixel"),
            exact + worst,
            exact,
            Within::Relative(1e-6),
        );
    }
}

fn diffuse_surfaces(case: &mut Case) {
    // Under uniform light a surface shows its directional albedo, here by quadrature (sigma 0.5 in both models), for a
    // viewer at 0, 30, 60 and 80 degrees. Black walls: light is scattered once, so every integrator must agree.
    let tolerance = pick(case, 1.5e-3, 5e-4);
    let qualitative = BsdfDesc::OrenNayarQualitative { albedo: Rgb::ONE, sigma: 0.5 };
    let oren_nayar = BsdfDesc::OrenNayar { albedo: Rgb::ONE, roughness: 0.5 };
    let models = [
        ("Lambert", grey(1.0), [1.0; 4]),
        ("Oren-Nayar", qualitative, [0.784_482_758_621, 0.824_724_690_960, 0.883_128_419_881, 0.929_444_593_430]),
        ("Fujii", oren_nayar, [0.874_204_808_855, 0.880_987_224_927, 0.924_188_697_546, 0.974_355_540_020]),
    ];
    for (what, bsdf, albedos) in models {
        for (degrees, albedo) in [0.0_f64, 30.0, 60.0, 80.0].into_iter().zip(albedos) {
            let corner = |x: f64, y: f64| DVec3::new(1e-3 * x, 1e-3 * y, 0.0);
            let patch = ShapeDesc::Quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            let mut desc = room(walls(), BsdfDesc::Black, 1.0, vec![(patch, bsdf)]);
            let (sin, cos) = degrees.to_radians().sin_cos();
            // The patch fills the image; its image is a thousandth of its size.
            desc.camera = camera(0.5 * DVec3::new(sin, 0.0, cos), DVec3::ZERO, 0.01);
            let samples = case.count(144, 1024) as u32;
            for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
                // All take the same samples here: one of them shows as much in little time.
                if integrator != IntegratorDesc::Path && !case.is_full() {
                    continue;
                }
                let job = Job { resolution: [16, 16], samples, integrator, ..Job::default() };
                case.mean(format!("{what} at {degrees}°, {integrator:?}"), measure(&desc, &job), albedo, tolerance);
            }
            if degrees == 60.0 && what == "Fujii" {
                converges(case, "Fujii at 60° under uniform light", &desc, (Known::EachPixel, albedo));
            }
        }
    }
    let mut desc = room(walls(), BsdfDesc::Black, 1.0, vec![(object(), grey(0.6))]);
    look_at_object(&mut desc);
    let job = Job { resolution: [16, 16], samples: case.count(96, 4096) as u32, ..Job::default() };
    case.mean("Lambert ball of 0.6", measure(&desc, &job), f64::from(0.6_f32), tolerance);
}

fn meshes(case: &mut Case) {
    // The flat mesh is a body like any other: nothing may be lost along its edges. Its normals, interpolated, are a body's
    // that does not exist: rays that such a normal sends through the face have nowhere to go.
    let samples = case.count(4, 256) as u32;
    for (what, smooth, bsdf, exact) in [
        ("flat glass", false, glass(1.5, 1.0), 1.0),
        ("flat mirror", false, mirror(0.8), f64::from(0.8_f32)),
        ("smooth glass", true, glass(1.5, 1.0), 1.0),
        ("smooth mirror", true, mirror(0.8), f64::from(0.8_f32)),
    ] {
        let body = ShapeDesc::Mesh { mesh: 1, smooth };
        let mut desc = room(walls(), BsdfDesc::Black, 1.0, vec![(body, bsdf)]);
        let outwards = turned(ball_mesh(0.4, 32, 64), DVec3::ZERO, false);
        let positions = outwards.positions.iter().map(|p| *p + CENTRE).collect();
        desc.meshes.push(MeshDesc { positions, ..outwards }.into());
        look_at_object(&mut desc);
        let (image, _) = render(&desc, &Job { resolution: [24, 24], samples, ..Job::default() });
        let mean = image.mean().iter().sum::<f64>() / 3.0;
        case.exact(format!("{what}, path"), mean, exact, Within::Relative(1e-5));
    }
}

fn emitting_box(case: &mut Case) {
    for (albedo, quick, full, tolerance) in [
        (0.5_f32, 64, 1024, (2e-3, 2.5e-4)),
        (0.9, 24, 512, (5e-3, 5e-4)),
        (0.99, 3, 192, (2e-2, 1e-3)),
        (0.999, 1, 12, (6e-2, 1e-2)),
    ] {
        let desc = room(walls(), grey(albedo), 1.0, Vec::new());
        let samples = case.count(quick * 4, full) as u32;
        let side = pick(case, 16, 32);
        let job = Job { resolution: [side, side], samples, ..Job::default() };
        let tolerance = pick(case, tolerance.0, tolerance.1);
        let exact = 1.0 / (1.0 - f64::from(albedo));
        case.mean(format!("albedo {albedo}"), measure(&desc, &job), exact, tolerance);
        if albedo < 0.95 {
            converges(case, &format!("emitting box of albedo {albedo}"), &desc, (Known::EachPixel, exact));
        }
    }
    for integrator in [IntegratorDesc::Direct, IntegratorDesc::Whitted] {
        // Both scatter diffuse light once.
        let desc = room(walls(), grey(0.6), 2.0, Vec::new());
        let job = Job { resolution: [16, 16], samples: case.count(64, 4096) as u32, integrator, ..Job::default() };
        let tolerance = pick(case, 2e-3, 2.5e-4);
        let exact = 2.0 * (1.0 + f64::from(0.6_f32));
        case.mean(format!("{integrator:?}, albedo 0.6"), measure(&desc, &job), exact, tolerance);
    }
}

/// Three cubes of the same size in the shape of an L, seen from inside.
fn l_shaped() -> MeshDesc {
    let cells = [(0, 0), (1, 0), (0, 1)];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (x, z) in cells {
        let min = DVec3::new(f64::from(x) - 0.5, -0.5, f64::from(z) - 0.5);
        let cube = box_inside(min, min + 1.0);
        let start = positions.len() as u32;
        for triangle in cube.triangles {
            let corners = triangle.map(|vertex| cube.positions[vertex as usize]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let behind = (x - normal.x.round() as i32, z - normal.z.round() as i32);
            if normal.y != 0.0 || !cells.contains(&behind) {
                triangles.push(triangle.map(|vertex| start + vertex));
            }
        }
        positions.extend(cube.positions);
    }
    mesh(positions, triangles)
}

fn other_shapes(case: &mut Case) {
    let corners = [(-2.0, -1.0, 1.5), (2.5, -1.2, 1.0), (0.0, 3.0, 0.2), (0.2, -0.8, -3.0)];
    let tetrahedron =
        mesh(corners.map(|(x, y, z)| DVec3::new(x, y, z)).to_vec(), vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]);
    let shapes = [
        ("tetrahedron", turned(tetrahedron, EYE, true)),
        ("ball of 760 triangles", turned(ball_mesh(1.0, 20, 20), DVec3::ZERO, true)),
        ("L", l_shaped()),
    ];
    for (what, shape) in shapes {
        let desc = room(shape, grey(0.9), 1.0, Vec::new());
        let samples = case.count(32, 1024) as u32;
        let job = Job { resolution: [16, 16], samples, ..Job::default() };
        let tolerance = pick(case, 1e-2, 1e-3);
        case.mean(format!("{what}, albedo 0.9"), measure(&desc, &job), 1.0 / (1.0 - f64::from(0.9_f32)), tolerance);
        let desc = SceneDesc { camera: camera(EYE, EYE - DVec3::Z, 170.0), ..desc };
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let (escaped, rays) = escapes(&scene, case.count(2_000, 2_000_000));
        case.rarely(format!("{what}: rays that find no wall"), escaped, rays, 1e-6);
    }
}

fn cut(case: &mut Case) {
    // N hits are N reflections: Le (1 - a^(N + 1)) / (1 - a).
    for (albedo, hits, quick, full) in
        [(0.9_f32, 4, 192, 2048), (0.9, 8, 96, 2048), (0.9, 16, 48, 2048), (0.9, 64, 32, 2048), (0.99, 64, 8, 512)]
    {
        let samples = case.count(quick, full) as u32;
        let job = Job { resolution: [16, 16], samples, max_depth: Some(hits), ..Job::default() };
        let albedo64 = f64::from(albedo);
        let exact = (1.0 - albedo64.powi(hits as i32 + 1)) / (1.0 - albedo64);
        let desc = room(walls(), grey(albedo), 1.0, Vec::new());
        let tolerance = pick(case, 5e-3, 5e-4);
        case.mean(format!("albedo {albedo}, {hits} hits"), measure(&desc, &job), exact, tolerance);
    }
}

fn objects(case: &mut Case) {
    let things: [(&str, Vec<(ShapeDesc, BsdfDesc)>); 5] = [
        ("mirror ball", vec![(object(), mirror(1.0))]),
        ("glass ball", vec![(object(), glass(1.5, 1.0))]),
        ("mirror ellipsoid", vec![(ellipsoid(), mirror(1.0))]),
        ("glass ellipsoid", vec![(ellipsoid(), glass(1.5, 1.0))]),
        ("water in glass", vec![(object(), glass(1.5, 1.0)), (ball(CENTRE, 0.36), glass(1.333, 1.5))]),
    ];
    for (what, objects) in things {
        let desc = room(walls(), grey(0.5), 1.0, objects);
        let job = Job { resolution: [16, 16], samples: case.count(96, 2048) as u32, ..Job::default() };
        case.mean(what, measure(&desc, &job), 2.0, pick(case, 4e-3, 5e-4));
    }
}

fn mirror_walls(case: &mut Case) {
    // Whitted's branches and the path's single way must both add up to Le / (1 - r).
    let r = f64::from(0.8_f32);
    let in_it = vec![(object(), glass(1.5, 1.0))];
    let whitted = IntegratorDesc::Whitted;
    for (what, wall, objects, integrator, exact, tolerance) in [
        ("mirrors of 0.8, path", mirror(0.8), Vec::new(), IntegratorDesc::Path, 1.0 / (1.0 - r), (4e-3, 5e-4)),
        ("mirrors of 0.8, Whitted", mirror(0.8), Vec::new(), whitted, 1.0 / (1.0 - r), (1e-3, 1e-4)),
        ("glass in mirrors of 0.8, Whitted", mirror(0.8), in_it, whitted, 1.0 / (1.0 - r), (2e-3, 2e-4)),
        ("mirrors of 0.8, direct", mirror(0.8), Vec::new(), IntegratorDesc::Direct, 1.0 + r, (1e-3, 1e-4)),
    ] {
        let desc = room(walls(), wall, 1.0, objects);
        let samples = case.count(64, 4096) as u32;
        let job = Job { resolution: [16, 16], samples, integrator, ..Job::default() };
        case.mean(what, measure(&desc, &job), exact, pick(case, tolerance.0, tolerance.1));
    }
}

fn survival(case: &mut Case) {
    // Certain survival among them: such a path must end too.
    for (survival, quick, full) in [(0.3, 1024, 16384), (0.8, 64, 1024), (1.0, 16, 512)] {
        let mut desc = room(walls(), grey(0.5), 1.0, Vec::new());
        desc.materials[0].survival = Some(survival);
        let job = Job { resolution: [16, 16], samples: case.count(quick, full) as u32, ..Job::default() };
        let tolerance = pick(case, 5e-3, 5e-4);
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let (image, _) = render_scene(&scene, RenderDesc { roulette: RouletteDesc::File, ..job.desc() });
        case.mean(format!("albedo 0.5, survival {survival}"), mean_and_error(&image), 2.0, tolerance);
    }
}
