//! Light transport as a whole: rooms and bodies whose light is known in closed form.

pub mod form_factors;
mod furnace;
mod guides;
mod parts;
mod rays;
mod refraction;
pub mod rooms;
mod whole;

use crate::common::scenes::{Job, mean_and_error, render, render_scene};
use crate::record::{Case, Effort, Entry};
use etendue::desc::{BsdfDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    [
        furnace::cases(),
        rooms::cases(),
        form_factors::cases(),
        refraction::cases(),
        guides::cases(),
        whole::cases(),
        parts::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Mean of an image and its standard error.
fn measure(desc: &SceneDesc, job: &Job) -> (f64, f64) {
    mean_and_error(&render(desc, job).0)
}

/// What has the exact value.
#[derive(Clone, Copy)]
enum Known {
    EachPixel,
    TheMean,
}

/// Error against the exact value over rising numbers of samples, in the table of the documents only.
fn converges(case: &mut Case, what: &str, desc: &SceneDesc, (known, exact): (Known, f64)) {
    if !case.is_full() {
        return;
    }
    let (side, seeds) = match known {
        Known::EachPixel => (32, 2),
        Known::TheMean => (8, 128),
    };
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let efforts = [16, 64, 256].map(|samples| {
        let (mut squares, mut count, mut seconds) = (0.0, 0_u32, 0.0);
        for seed in 1..=seeds {
            let job = Job { resolution: [side, side], samples, seed, ..Job::default() };
            let (image, summary) = render_scene(&scene, job.desc());
            seconds += summary.elapsed.as_secs_f64() / seeds as f64;
            let values = match known {
                Known::EachPixel => image.rgb.chunks_exact(3).map(|rgb| f64::from(rgb[0])).collect(),
                Known::TheMean => vec![image.mean()[0]],
            };
            for value in values {
                squares += (value / exact - 1.0).powi(2);
                count += 1;
            }
        }
        Effort { samples, seconds, rmse: (squares / f64::from(count)).sqrt() }
    });
    case.convergence(what, &efforts);
}

/// The quick number, or the one of the documents.
pub fn pick<T>(case: &Case, quick: T, full: T) -> T {
    if case.is_full() { full } else { quick }
}

pub fn grey(albedo: f32) -> BsdfDesc {
    BsdfDesc::Lambert { albedo: Rgb::splat(albedo) }
}

pub fn mirror(reflectance: f32) -> BsdfDesc {
    BsdfDesc::Mirror { reflectance: Rgb::splat(reflectance) }
}

pub fn glass(ior: f32, exterior_ior: f32) -> BsdfDesc {
    BsdfDesc::Dielectric { ior, exterior_ior }
}

pub fn ball(centre: DVec3, radius: f64) -> ShapeDesc {
    ShapeDesc::Sphere { centre, radius }
}

/// A parallelogram with the normal u x v.
pub fn parallelogram(corner: DVec3, u: DVec3, v: DVec3) -> ShapeDesc {
    ShapeDesc::Quad([corner, corner + u, corner + u + v, corner + v])
}

/// A large square around a point, in the plane with this unit normal.
pub fn plane(middle: DVec3, normal: DVec3, half: f64) -> ShapeDesc {
    let u = half * normal.any_orthonormal_vector();
    let v = normal.cross(u);
    parallelogram(middle - u - v, 2.0 * u, 2.0 * v)
}

pub fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> MeshDesc {
    MeshDesc { name: "mesh".into(), path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() }
}

/// The first mesh of a scene, flat.
pub const MESH: ShapeDesc = ShapeDesc::Mesh { mesh: 0, smooth: false };

/// A closed convex mesh turned so that all normals point towards `inside`, or all away from it.
pub fn turned(mut mesh: MeshDesc, inside: DVec3, inwards: bool) -> MeshDesc {
    for triangle in &mut mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        if ((b - a).cross(c - a).dot(inside - a) > 0.0) != inwards {
            triangle.swap(1, 2);
        }
    }
    mesh
}

/// A tessellated ball around the origin.
pub fn ball_mesh(radius: f64, rings: u32, sectors: u32) -> MeshDesc {
    use std::f64::consts::{PI, TAU};
    let mut positions = vec![radius * DVec3::Y, -radius * DVec3::Y];
    let point = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    for ring in 1..rings {
        let (sin, cos) = (f64::from(ring) / f64::from(rings) * PI).sin_cos();
        for sector in 0..sectors {
            let (y, x) = (f64::from(sector) / f64::from(sectors) * TAU).sin_cos();
            positions.push(radius * DVec3::new(sin * x, cos, sin * y));
        }
    }
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, point(1, sector), point(1, sector + 1)]);
        triangles.push([1, point(rings - 1, sector), point(rings - 1, sector + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [point(ring, sector), point(ring, sector + 1)];
            triangles.extend([[a, b, b + sectors], [a, b + sectors, a + sectors]]);
        }
    }
    mesh(positions, triangles)
}
