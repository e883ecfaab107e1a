//! Triangles without area, numbers that are none, and the same triangle many times.

use std::sync::Arc;
use std::time::Instant;

use etendue::desc::{BsdfDesc, HostMesh, MeshDesc, SceneDesc, ShapeDesc};
use etendue::embree::SceneOptions;
use etendue::math::{DVec3, Ray, Vec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{GREY, ball, build, camera, in_cube, kernel, mesh_scene, on_sphere, range, shapes, tally, unit};
use crate::common::scenes::{Job, box_inside, render, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "I11", title: "rubbish triangles", run: rubbish },
        Entry { id: "I12", title: "thin collinear triangle", run: collinear },
        Entry { id: "I13", title: "coplanar duplicates", run: duplicates },
    ]
}

const LAMP: [DVec3; 4] = [
    DVec3::new(-0.25, 0.99, -0.25),
    DVec3::new(0.25, 0.99, -0.25),
    DVec3::new(0.25, 0.99, 0.25),
    DVec3::new(-0.25, 0.99, 0.25),
];

/// A box with a lamp under its ceiling.
fn lit_box() -> SceneDesc {
    let mut desc = scene(
        camera(DVec3::new(0.0, 0.0, 0.9), DVec3::NEG_Z),
        vec![
            (ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Lambert { albedo: Rgb::new(0.7, 0.5, 0.3) }, None),
            (ShapeDesc::Quad(LAMP), GREY, Some(Rgb::splat(10.0))),
        ],
    );
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc
}

fn bits(desc: &SceneDesc) -> Vec<u32> {
    let job = Job { resolution: [24, 24], samples: 4, ..Job::default() };
    render(desc, &job).0.rgb.iter().map(|value| value.to_bits()).collect()
}

/// Triangles without area, all inside the box: points, corners on a line, corners that are the same.
const FLAT: [[DVec3; 3]; 4] = [
    [DVec3::splat(0.5); 3],
    [DVec3::splat(-0.5), DVec3::ZERO, DVec3::splat(0.25)],
    [DVec3::splat(-0.5), DVec3::splat(-0.5), DVec3::splat(0.5)],
    [DVec3::new(0.5, 0.25, 0.0), DVec3::new(0.5, -0.5, 0.0), DVec3::new(0.5, 0.25, 0.0)],
];

fn rubbish(case: &mut Case) {
    let clean = lit_box();
    let reference = bits(&clean);
    let emitters = Scene::build(&clean, &BuildOptions::default()).expect("a box").emitters().emitters().len();
    let mut in_mesh = clean.clone();
    let mesh = Arc::make_mut(&mut in_mesh.meshes[0]);
    for corners in FLAT {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        // Before all others, so that every number shifts.
        mesh.triangles.insert(0, [first, first + 1, first + 2]);
    }
    mesh.triangles.extend([[0, 0, 0], [1, 1, 5], [3, 2, 3]]);
    let loose = |emission: Option<Rgb>| {
        let mut desc = clean.clone();
        for corners in FLAT {
            let mut surface = desc.surfaces[0].clone();
            (surface.shape, surface.emission) = (ShapeDesc::Triangle(corners), emission);
            desc.surfaces.push(surface);
        }
        desc
    };
    let mut emitting_mesh = loose(Some(Rgb::splat(1e6)));
    emitting_mesh.surfaces[0].emission = None;
    for (name, desc) in
        [("in a mesh", in_mesh), ("by themselves", loose(None)), ("that should emit", loose(Some(Rgb::splat(1e6))))]
    {
        let image = bits(&desc);
        let different = image.iter().zip(&reference).filter(|(a, b)| a != b).count();
        case.never(format!("without area, {name}: values that differ"), different as u64, reference.len() as u64);
        let built = Scene::build(&desc, &BuildOptions::default()).expect("a box with rubbish");
        let more = built.emitters().emitters().len().abs_diff(emitters);
        case.never(format!("without area, {name}: emitters more"), more as u64, emitters as u64);
    }

    // What cannot be left out is refused, and named.
    type Spoil = fn(&mut MeshDesc);
    let spoils: [(&str, &str, Spoil); 6] = [
        ("index out of range", "triangle 3", |mesh| mesh.triangles[3][1] = 8),
        ("NaN", "vertex 5", |mesh| mesh.positions[5].y = f64::NAN),
        ("+infinity", "vertex 5", |mesh| mesh.positions[5].z = f64::INFINITY),
        ("-infinity", "vertex 5", |mesh| mesh.positions[5].x = f64::NEG_INFINITY),
        ("1.9e18", "surfaces[0]", |mesh| mesh.positions[5].x = 1.9e18),
        ("1e39", "surfaces[0]", |mesh| mesh.positions[5].x = -1e39),
    ];
    for (name, place, spoil) in spoils {
        let mut desc = clean.clone();
        spoil(Arc::make_mut(&mut desc.meshes[0]));
        let message = Scene::build(&desc, &BuildOptions::default()).err().map(|error| error.to_string());
        let is_named = message.as_ref().is_some_and(|message| message.contains(place));
        let got = if is_named { format!("error at {place}") } else { message.unwrap_or("a scene".to_owned()) };
        case.holds(format!("a mesh with {name}"), &format!("error at {place}"), got, is_named);
    }
    for (name, x) in [("NaN", f64::NAN), ("infinity", f64::INFINITY), ("1.9e18", 1.9e18)] {
        let mut desc = loose(None);
        desc.surfaces[3].path = "surfaces[3]".into();
        desc.surfaces[3].shape = ShapeDesc::Triangle([DVec3::X * x, DVec3::Y, DVec3::Z]);
        let message = Scene::build(&desc, &BuildOptions::default()).err().map(|error| error.to_string());
        let is_named = message.as_ref().is_some_and(|message| message.contains("surfaces[3]"));
        let got = if is_named { "error at surfaces[3]".to_owned() } else { message.unwrap_or("a scene".to_owned()) };
        case.holds(format!("a triangle with {name}"), "error at surfaces[3]", got, is_named);
    }

    if case.is_full() {
        let clean = ball(500, 1000, DVec3::ZERO);
        let mut dirty = clean.clone();
        for i in 0..10_000 {
            dirty.triangles.insert(97 * i as usize, [i, i, i + 1]);
        }
        let descs = [clean, dirty].map(|mesh| mesh_scene(mesh, DVec3::ZERO));
        let options = BuildOptions { threads: 1, ..BuildOptions::default() };
        // By turns, so that both meet the same company on the machine.
        let mut times = [f64::INFINITY; 2];
        for _ in 0..9 {
            for (time, desc) in times.iter_mut().zip(&descs) {
                let start = Instant::now();
                drop(Scene::build(desc, &options).expect("a ball"));
                *time = time.min(start.elapsed().as_secs_f64());
            }
        }
        case.at_most("1 % of a million without area: time of the build", times[1] / times[0], 1.1);
    }
}

/// No ray meets a triangle whose corners lie on a line.
fn collinear(case: &mut Case) {
    let corner = |y: f64| DVec3::new(-1000.5, y, -56.0);
    let corners = [corner(-80.0), corner(-87.0), corner(-79.2)];
    let mesh = MeshDesc { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..MeshDesc::default() };
    let host = HostMesh {
        positions: corners.map(|p| p.as_vec3a().to_array()).to_vec().into(),
        triangles: vec![[0, 1, 2]].into(),
        normals: None,
        uvs: None,
    };
    // Something that is there, far from the rays.
    let other = ShapeDesc::Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
    let scene = |shape: ShapeDesc, mesh: MeshDesc| {
        let mut desc = shapes(corners[0], vec![other, shape]);
        desc.meshes.push(mesh.into());
        build(&desc, 16)
    };
    let in_mesh = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let kernel = kernel(&mesh, SceneOptions::default());
    let scenes = [
        ("triangle", scene(ShapeDesc::Triangle(corners), mesh.clone())),
        ("mesh", scene(in_mesh, mesh)),
        ("host's mesh", scene(in_mesh, MeshDesc { host: Some(host), ..MeshDesc::default() })),
    ];
    let tries = case.count(20_000, 4_000_000);
    let aim = |rng: &mut etendue::sampling::Rng, to_scene: &dyn Fn(DVec3) -> Vec3| {
        let target = corner(range(rng, -87.0, -79.2));
        let origin = match rng.next_u64() % 3 {
            0 => target + in_cube(rng, 100.0),
            1 => target + on_sphere(rng) * 0.1,
            // In a plane with it.
            _ => target + DVec3::new(range(rng, 1.0, 500.0), range(rng, -50.0, 50.0), 0.0),
        };
        let (origin, target) = (to_scene(origin), to_scene(target));
        Ray::new(origin, target - origin)
    };
    for (name, scene) in &scenes {
        let [met] = tally(tries, 120, |rng| {
            let ray = aim(rng, &|p| scene.to_scene(p));
            [scene.intersect(&ray).is_some() || !scene.unoccluded(&ray)]
        });
        case.never(format!("{name}: met"), met, tries);
    }
    let [met] = tally(tries, 120, |rng| {
        let ray = aim(rng, &|p| p.as_vec3a());
        [kernel.intersect(&ray).is_some() || kernel.occluded(&ray)]
    });
    case.never("the kernel alone: met", met, tries);
}

fn duplicates(case: &mut Case) {
    // A second white floor upon the first.
    let floor = |y: f64| {
        let corner = |x: f64, z: f64| DVec3::new(x, y, z);
        ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)])
    };
    let lit = |copies: usize| {
        let mut surfaces = vec![(ShapeDesc::Quad(LAMP), GREY, Some(Rgb::splat(10.0)))];
        surfaces.extend((0..copies).map(|_| (floor(0.0), BsdfDesc::Lambert { albedo: Rgb::ONE }, None)));
        bits(&scene(camera(DVec3::new(0.0, 0.5, 2.0), DVec3::ZERO), surfaces))
    };
    let one = lit(1);
    for copies in [2, 5] {
        let different = lit(copies).iter().zip(&one).filter(|(a, b)| a != b).count();
        case.never(
            format!("{copies} quads in one place: values that differ from one's"),
            different as u64,
            one.len() as u64,
        );
    }

    // On one thread, whose time tells less of what else the machine does.
    let options = BuildOptions { threads: 1, ..BuildOptions::default() };
    let stack = |copies: u32| {
        let mesh = MeshDesc {
            positions: vec![DVec3::Z, DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 1.0)],
            triangles: (0..copies).flat_map(|_| [[0, 1, 2], [0, 2, 3]]).collect(),
            ..MeshDesc::default()
        };
        let desc = mesh_scene(mesh, DVec3::ZERO);
        let start = Instant::now();
        let scene = Scene::build(&desc, &options).expect("a stack");
        (scene, start.elapsed().as_secs_f64())
    };
    let copies = case.count(20_000, 100_000) as u32;
    let ((half, _), (whole, _)) = (stack(copies / 2), stack(copies));
    let bytes = |scene: &Scene| scene.info().embree_bytes as f64 + scene.info().geometry_bytes as f64;
    case.at_most("1e5 copies: memory against half as many", bytes(&whole) / bytes(&half), 2.2);
    if case.is_full() {
        let time = |copies| (0..15).map(|_| stack(copies).1).fold(f64::INFINITY, f64::min);
        case.at_most("1e5 copies: time of the build against half as many", time(copies) / time(copies / 2), 3.0);
    }
    let tries = 200;
    let [wrong] = tally(tries, 130, |rng| {
        let target = DVec3::new(unit(rng), unit(rng), 1.0);
        let ray = Ray::new(whole.to_scene(DVec3::ZERO), target.as_vec3a());
        [whole.intersect(&ray).is_none_or(|hit| (f64::from(hit.t) - 1.0).abs() > 2e-7)]
    });
    case.never("1e5 copies: misses, or t off by > 2e-7", wrong, tries);
}
