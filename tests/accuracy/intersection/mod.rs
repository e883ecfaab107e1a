//! Where rays meet surfaces: by the ray kernel alone, and through the scene.

mod places;
mod polygons;
mod quadrics;
mod rubbish;
mod segments;
mod shapes;
mod special;
mod watertight;

use std::f64::consts::{PI, TAU};

use etendue::desc::{BsdfDesc, CameraDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::embree::{self, Device, DeviceOptions, SceneBuilder, SceneOptions, TriangleMesh};
use etendue::math::{Bounds, DVec3, Ray};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use crate::common::scenes;
use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    let topics = [
        watertight::cases(),
        polygons::cases(),
        shapes::cases(),
        rubbish::cases(),
        special::cases(),
        segments::cases(),
        quadrics::cases(),
        places::cases(),
    ];
    topics.into_iter().flatten().collect()
}

const GREY: BsdfDesc = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };

/// How analytic shapes are found: tested in a list, or in the kernel's tree.
const PLACES: [(usize, &str); 2] = [(16, "list"), (0, "tree")];

/// The unit sphere's equation; a frame makes any ellipsoid of it.
const BALL: [f64; 10] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];

const EVERYWHERE: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

/// The value that is farthest from the expected one; NaN before all.
fn worst(values: impl IntoIterator<Item = f64>, expected: f64) -> f64 {
    let off = |value: &f64| (value - expected).abs();
    values.into_iter().max_by(|a, b| off(a).total_cmp(&off(b))).expect("a value")
}

/// Whether two numbers differ by no more than this; NaN differs from all.
fn is_near(a: f64, b: f64, within: f64) -> bool {
    (a - b).abs() <= within
}

/// In [0, 1).
fn unit(rng: &mut Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * 0.5_f64.powi(53)
}

fn range(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * unit(rng)
}

fn below(rng: &mut Rng, n: usize) -> usize {
    (rng.next_u64() % n as u64) as usize
}

fn in_cube(rng: &mut Rng, half: f64) -> DVec3 {
    DVec3::new(range(rng, -half, half), range(rng, -half, half), range(rng, -half, half))
}

fn on_sphere(rng: &mut Rng) -> DVec3 {
    let z = range(rng, -1.0, 1.0);
    let (sin, cos) = range(rng, 0.0, TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

/// Tries `count` times on two threads what says which of several things went wrong; returns how often each did.
fn tally<const N: usize>(count: u64, seed: u64, attempt: impl Fn(&mut Rng) -> [bool; N] + Sync) -> [u64; N] {
    let part = |thread: u64| {
        let mut rng = Rng::new(seed, thread);
        let mut bad = [0; N];
        for _ in 0..count / 2 {
            for (sum, is_bad) in bad.iter_mut().zip(attempt(&mut rng)) {
                *sum += u64::from(is_bad);
            }
        }
        bad
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(|| part(1));
        let one = part(0);
        let other = other.join().expect("no attempt panics");
        std::array::from_fn(|i| one[i] + other[i])
    })
}

/// The ray kernel's scene of one mesh, with coordinates rounded as they are.
fn kernel(mesh: &MeshDesc, options: SceneOptions) -> embree::Scene {
    let device = Device::new(&DeviceOptions::default()).expect("Embree starts");
    let vertices = mesh.positions.iter().map(|p| p.as_vec3a().to_array()).collect();
    let mesh = TriangleMesh::new(vertices, mesh.triangles.clone()).expect("a mesh of the test");
    let mut builder = SceneBuilder::new(&device, options).expect("a scene");
    builder.add_triangles(mesh).expect("a mesh");
    builder.commit(None).expect("a build")
}

fn build(desc: &SceneDesc, listed: usize) -> Scene {
    Scene::build(desc, &BuildOptions { threads: 2, listed_shapes: Some(listed), ..BuildOptions::default() })
        .expect("a scene of the test")
}

/// Grey shapes seen from `eye`, which becomes the scene frame's origin where it lies in the box around them.
fn shapes(eye: DVec3, shapes: Vec<ShapeDesc>) -> SceneDesc {
    let look_at = eye + DVec3::new(0.3, 0.2, 1.0) * eye.length().max(1.0);
    scenes::scene(camera(eye, look_at), shapes.into_iter().map(|shape| (shape, GREY, None)).collect())
}

fn camera(eye: DVec3, look_at: DVec3) -> CameraDesc {
    scenes::camera(eye, look_at, 60.0)
}

/// A mesh seen from `eye`.
fn mesh_scene(mesh: MeshDesc, eye: DVec3) -> SceneDesc {
    let mut desc = shapes(eye, vec![ShapeDesc::Mesh { mesh: 0, smooth: false }]);
    desc.meshes.push(mesh.into());
    desc
}

/// A unit sphere of 2 (rings - 1) sectors triangles around `centre`, with one vertex at each pole: edges are shared.
fn ball(rings: u32, sectors: u32, centre: DVec3) -> MeshDesc {
    let mut mesh = MeshDesc { name: "ball".into(), path: "meshes[0]".into(), ..MeshDesc::default() };
    mesh.positions.push(centre + DVec3::Z);
    for ring in 1..rings {
        let (sin, cos) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for sector in 0..sectors {
            let (y, x) = (TAU * f64::from(sector) / f64::from(sectors)).sin_cos();
            mesh.positions.push(centre + DVec3::new(sin * x, sin * y, cos));
        }
    }
    mesh.positions.push(centre - DVec3::Z);
    let last = mesh.positions.len() as u32 - 1;
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    for s in 0..sectors {
        mesh.triangles.push([0, at(1, s), at(1, s + 1)]);
        mesh.triangles.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
        for ring in 1..rings - 1 {
            mesh.triangles.push([at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)]);
            mesh.triangles.push([at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)]);
        }
    }
    mesh
}

/// A cube of twelve triangles around `centre`, two units wide.
fn cube(centre: DVec3) -> MeshDesc {
    scenes::box_inside(centre - 1.0, centre + 1.0)
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin.as_vec3a(), direction.as_vec3a())
}
