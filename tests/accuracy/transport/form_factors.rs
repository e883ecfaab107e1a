//! Form factors by rendering: a camera straight above a receiver of albedo rho that it covers exactly, and a black emitter
//! of radiance L. The mean of the image is rho L F, F being the share of the receiver's own light that would reach the
//! emitter.

use super::{Known, ball, converges, grey, measure, mesh, parallelogram, pick};
use crate::common::scenes::{Job, camera, scene};
use crate::record::{Case, Entry};
use etendue::desc::{BsdfDesc, CameraDesc, FilmDesc, IntegratorDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::math::DVec3;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R57", title: "form factors of rectangles", run: rectangles },
        Entry { id: "R57b", title: "form factors of round things", run: round },
        Entry { id: "R57c", title: "form factor of a groove", run: groove },
    ]
}

const ALBEDO: f32 = 0.8;

/// A camera at `height` above the middle of the rectangle [0, x] x [0, y] of the plane z = 0, which fills the image; up is
/// the y axis.
fn above(x: f64, y: f64, height: f64) -> CameraDesc {
    let middle = 0.5 * DVec3::new(x, y, 0.0);
    match camera(middle + height * DVec3::Z, middle, 2.0 * (0.5 * x / height).atan().to_degrees()) {
        CameraDesc::Perspective { eye, look_at, fov_deg, fov_axis, .. } => {
            CameraDesc::Perspective { eye, look_at, up: DVec3::Y, fov_deg, fov_axis, film: FilmDesc::default() }
        }
        other => other,
    }
}

fn lit(camera: CameraDesc, receiver: ShapeDesc, emitter: ShapeDesc) -> SceneDesc {
    scene(camera, vec![(receiver, grey(ALBEDO), None), (emitter, BsdfDesc::Black, Some(Rgb::splat(2.0)))])
}

/// What the image's mean has to be.
fn expected(form_factor: f64) -> f64 {
    2.0 * f64::from(ALBEDO) * form_factor
}

fn rectangle(x: f64, y: f64) -> ShapeDesc {
    parallelogram(DVec3::ZERO, DVec3::X * x, DVec3::Y * y)
}

/// A unit square and a parallel one at this distance.
pub fn parallel(x: f64, y: f64, distance: f64) -> SceneDesc {
    let emitter = parallelogram(DVec3::Z * distance, DVec3::Y * y, DVec3::X * x);
    lit(above(x, y, 0.5 * distance), rectangle(x, y), emitter)
}

/// A rectangle of length 1 and this width, and a wall of this height that stands on its edge.
pub fn perpendicular(width: f64, height: f64) -> SceneDesc {
    let emitter = parallelogram(DVec3::ZERO, DVec3::Y, DVec3::Z * height);
    lit(above(width, 1.0, 0.4), rectangle(width, 1.0), emitter)
}

fn rectangles(case: &mut Case) {
    let tolerance = pick(case, 1.5e-3, 4e-4);
    for (what, desc, width, form_factor) in [
        ("parallel squares at 1", parallel(1.0, 1.0, 1.0), 1, 0.199_824_895_698_387_4),
        ("parallel squares at 0.1", parallel(1.0, 1.0, 0.1), 1, 0.826_994_522_397),
        ("parallel squares at 10", parallel(1.0, 1.0, 10.0), 1, 0.003_162_056_838_76),
        ("parallel rectangles 2 x 1 at 0.5", parallel(2.0, 1.0, 0.5), 2, 0.508_988_669_041),
        ("squares with a common edge", perpendicular(1.0, 1.0), 1, 0.200_043_776_075_403_2),
        ("common edge, width 1, height 2", perpendicular(1.0, 2.0), 1, 0.232_852_602_795),
        ("common edge, width 2, height 1", perpendicular(2.0, 1.0), 2, 0.116_426_301_398),
    ] {
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Direct] {
            // Both take the same samples here.
            if integrator == IntegratorDesc::Direct && !case.is_full() {
                continue;
            }
            let samples = case.count(256, 2048) as u32;
            let job = Job { resolution: [16 * width, 16], samples, integrator, ..Job::default() };
            case.mean(format!("{what}, {integrator:?}"), measure(&desc, &job), expected(form_factor), tolerance);
        }
        if ["parallel squares at 0.1", "squares with a common edge"].contains(&what) {
            converges(case, what, &desc, (Known::TheMean, expected(form_factor)));
        }
    }
    // The floor of a closed cube whose other walls shine: all form factors add up to one.
    let walls = [
        (DVec3::ZERO, DVec3::Y, DVec3::Z),
        (DVec3::X, DVec3::Z, DVec3::Y),
        (DVec3::ZERO, DVec3::Z, DVec3::X),
        (DVec3::Y, DVec3::X, DVec3::Z),
        (DVec3::Z, DVec3::Y, DVec3::X),
    ];
    let mut surfaces = vec![(rectangle(1.0, 1.0), grey(ALBEDO), None)];
    surfaces.extend(walls.map(|(corner, u, v)| (parallelogram(corner, u, v), BsdfDesc::Black, Some(Rgb::splat(2.0)))));
    let desc = scene(above(1.0, 1.0, 0.4), surfaces);
    let job = Job { resolution: [16, 16], samples: case.count(192, 2048) as u32, ..Job::default() };
    case.mean("all walls of a cube", measure(&desc, &job), expected(1.0), tolerance);
}

/// A disc of triangles around the z axis as large as the circle, its normal downwards.
fn fan(radius: f64, z: f64, sectors: u32) -> MeshDesc {
    let step = std::f64::consts::TAU / f64::from(sectors);
    // As much area as the circle.
    let corner = radius * (step / step.sin()).sqrt();
    let rim = (0..sectors).map(|sector| {
        let (sin, cos) = (step * f64::from(sector)).sin_cos();
        DVec3::new(corner * cos, corner * sin, z)
    });
    let positions = std::iter::once(DVec3::Z * z).chain(rim).collect();
    mesh(positions, (0..sectors).map(|sector| [0, 1 + (sector + 1) % sectors, 1 + sector]).collect())
}

fn round(case: &mut Case) {
    let tolerance = pick(case, 3e-3, 2e-4);
    let disc = |radius: f64| ShapeDesc::Disk { centre: DVec3::ZERO, normal: DVec3::Z, radius };
    let straight_above = |height: f64| camera(DVec3::Z * height, DVec3::ZERO, 2.0 * (1.0 / height).atan().to_degrees());
    // The unit disc within the image of a square.
    let share = std::f64::consts::FRAC_PI_4;
    let job = Job { resolution: [16, 16], samples: case.count(384, 4096) as u32, ..Job::default() };
    for (what, radius, distance, form_factor) in
        [("equal discs at 1", 1.0, 1.0, 0.381_966_011_250), ("discs 1 and 2 at 1.5", 2.0, 1.5, 0.601_653_344_388)]
    {
        let mut desc = lit(straight_above(0.5 * distance), disc(1.0), super::MESH);
        desc.meshes.push(fan(radius, distance, 512).into());
        case.mean(what, measure(&desc, &job), share * expected(form_factor), tolerance);
    }
    for radius in [0.01, 0.5, 0.9, 0.99] {
        // A sphere around the point above the middle: from it to the disc, (1 - cos 45°) / 2, and the other way more by
        // the ratio of the areas.
        let desc = lit(straight_above(0.5 * (1.0 - radius)), disc(1.0), ball(DVec3::Z, radius));
        let form_factor = 0.146_446_609_407 * 4.0 * radius * radius;
        let got = measure(&desc, &job);
        case.mean(format!("disc to a sphere of radius {radius}"), got, share * expected(form_factor), tolerance);
    }
}

/// Half the length of a groove without an end.
const LONG: f64 = 500.0;

/// A strip from the y axis to `side`, of pieces that grow with their distance from the middle; normals along side x Y, or
/// against it.
fn strip(side: DVec3, turned: bool) -> MeshDesc {
    let half = [0.25, 1.0, 3.0, 10.0, 30.0, 100.0, LONG];
    let ends: Vec<f64> = half.iter().rev().map(|y| -y).chain(half).collect();
    let positions = ends.iter().flat_map(|&y| [DVec3::Y * y, DVec3::Y * y + side]).collect();
    let pieces = (0..ends.len() as u32 - 1).map(|piece| 2 * piece);
    let triangles = pieces.flat_map(|p| [[p, p + 1, p + 3], [p, p + 3, p + 2]]);
    mesh(positions, triangles.map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] }).collect())
}

fn groove(case: &mut Case) {
    // Sides of length 1 in a groove without an end: 1 - sin(angle / 2) of one side's light meets the other.
    let job = Job { resolution: [128, 1], samples: case.count(1024, 16384) as u32, ..Job::default() };
    let flat = |mesh: usize| ShapeDesc::Mesh { mesh, smooth: false };
    for degrees in [60.0_f64, 20.0, 120.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let side = DVec3::new(cos, 0.0, sin);
        let camera = above(1.0, 0.0, (0.25 * degrees.to_radians().tan().abs()).min(0.3));
        let mut desc = lit(camera, flat(0), flat(1));
        desc.meshes.extend([strip(DVec3::X, false).into(), strip(side, true).into()]);
        let exact = expected(1.0 - (0.5 * degrees.to_radians()).sin());
        case.mean(format!("groove of {degrees}°"), measure(&desc, &job), exact, pick(case, 3e-3, 3e-4));
        if degrees == 20.0 && case.is_full() {
            // The same of two triangles a side.
            let long = DVec3::Y * LONG;
            let floor = parallelogram(-long, DVec3::X, 2.0 * long);
            let slope = parallelogram(-long, 2.0 * long, side);
            let desc = lit(camera, floor, slope);
            case.known(
                "a shadow ray ends off the lamp by a bound that grows with its triangle, here 0.0005 of the width",
            )
            .mean("groove of 20°, of two triangles a side", measure(&desc, &job), exact, 3e-4);
        }
    }
}
