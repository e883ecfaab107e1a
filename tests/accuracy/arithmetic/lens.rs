//! Thin lenses: points on apertures, the blur of what is out of focus against closed forms, and what is in focus.

use std::f64::consts::{PI, TAU};

use etendue::camera::Camera;
use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FocusDesc, FovAxis, IntegratorDesc, LensDesc, MeshDesc, RenderDesc, SceneDesc,
    ShapeDesc,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::sampling::{Rng, warps};
use etendue::spectrum::Rgb;
use glam::DVec2;

use super::layers;
use crate::common::scenes::{Job, mean_and_error as image_mean, render, scene};
use crate::common::stats::{check_density, mean_and_error};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "C70", title: "points on apertures", run: apertures },
        Entry { id: "C71", title: "circle of confusion", run: confusion },
        Entry { id: "C72", title: "edges out of focus", run: edges },
        Entry { id: "C73", title: "what is in focus", run: focus },
        Entry { id: "C75", title: "methods through a lens", run: methods },
    ]
}

/// Radius of the lens, and distance of the plane in focus.
const RADIUS: f64 = 0.75;
const FOCUS: f64 = 4.0;
/// Tangent of half the angle of view.
const TANGENT: f64 = 0.25;

/// Looks along -z from the origin, in focus at [`FOCUS`].
fn through(lens: LensDesc) -> CameraDesc {
    let fov_deg = 2.0 * TANGENT.atan().to_degrees();
    let (eye, look_at) = (DVec3::ZERO, DVec3::new(0.0, 0.0, -FOCUS));
    CameraDesc::ThinLens {
        eye,
        look_at,
        up: DVec3::Y,
        fov_deg,
        fov_axis: FovAxis::Horizontal,
        lens,
        film: FilmDesc::default(),
    }
}

fn lens(blades: u32, blade_rotation_deg: f64, squeeze: f64) -> LensDesc {
    LensDesc { blades, blade_rotation_deg, squeeze, ..LensDesc::new(RADIUS) }
}

/// The corners of an aperture in units of the lens's radius, by the document's words; many for a disk.
fn corners(lens: &LensDesc) -> Vec<DVec2> {
    let count = if lens.blades == 0 { 20_000 } else { lens.blades };
    let corner = |i: u32| {
        let (y, x) = (lens.blade_rotation_deg.to_radians() + TAU * f64::from(i) / f64::from(count)).sin_cos();
        DVec2::new(x / lens.squeeze, y)
    };
    (0..count).map(corner).collect()
}

/// Area of a polygon.
fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// The share of an aperture that is to the left of x, in units of the lens's radius: by cutting the polygon.
fn share_below(corners: &[DVec2], x: f64) -> f64 {
    let mut left = Vec::new();
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        if a.x < x {
            left.push(*a);
        }
        if (a.x < x) != (b.x < x) {
            left.push(a.lerp(*b, (x - a.x) / (b.x - a.x)));
        }
    }
    if left.is_empty() { 0.0 } else { area(&left) / area(corners) }
}

/// The same of a disk: its segment.
fn segment(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

/// What the points of a camera's lens have in the mean over a grid of numbers, in units of the lens's radius.
fn over_lens<const N: usize>(lens: LensDesc, side: u32, of: impl Fn(DVec2) -> [f64; N]) -> [f64; N] {
    let camera = Camera::new(&through(lens), [64, 64], DVec3::ZERO).expect("a camera of the test");
    let mut sums = [0.0; N];
    for i in 0..side * side {
        let u = [i % side, i / side].map(|n| (n as f32 + 0.5) / side as f32);
        let origin = camera.ray_through_lens(20.0, 30.0, u).origin.as_dvec3() / RADIUS;
        for (sum, value) in sums.iter_mut().zip(of(origin.truncate())) {
            *sum += value / f64::from(side * side);
        }
    }
    sums
}

fn apertures(case: &mut Case) {
    let side = case.count(400, 2000) as u32;
    for (name, lens) in [
        ("disk", lens(0, 0.0, 1.0)),
        ("3 blades", lens(3, 0.0, 1.0)),
        ("4 blades turned by 45°", lens(4, 45.0, 1.0)),
        ("5 blades turned by -20°", lens(5, -20.0, 1.0)),
        ("32 blades", lens(32, 0.0, 1.0)),
        ("6 blades, squeeze 2", lens(6, 15.0, 2.0)),
        ("disk, squeeze 0.8", lens(0, 0.0, 0.8)),
    ] {
        let outline = corners(&lens);
        let middle = DVec2::new(0.05, -0.1);
        let is_near = |p: DVec2| f64::from(u8::from(p.distance(middle) < 0.25));
        let [x, y, xx, yy, xy, near] =
            over_lens(lens, side, |p| [p.x, p.y, p.x * p.x, p.y * p.y, p.x * p.y, is_near(p)]);
        // The area by the points in a small circle: its own area over their share.
        let found = PI * 0.25 * 0.25 / near;
        let blades = f64::from(lens.blades);
        let (whole, around) = match lens.blades {
            0 => (PI, 0.5),
            _ => (0.5 * blades * (TAU / blades).sin(), (2.0 + (TAU / blades).cos()) / 6.0),
        };
        case.exact(format!("{name}: area"), found, whole / lens.squeeze, Within::Relative(2e-3));
        case.exact(format!("{name}: mean to the right"), x, 0.0, Within::Absolute(1e-5));
        case.exact(format!("{name}: mean upwards"), y, 0.0, Within::Absolute(1e-5));
        // A regular polygon's moments are the same along all axes.
        let across = 0.5 * around / (lens.squeeze * lens.squeeze);
        case.exact(format!("{name}: second moment across"), xx, across, Within::Relative(2e-4));
        case.exact(format!("{name}: second moment upwards"), yy, 0.5 * around, Within::Relative(2e-4));
        case.exact(format!("{name}: mixed moment"), xy, 0.0, Within::Absolute(2e-5));
        // How far it reaches into directions, as its corners do, and no farther.
        let towards: Vec<(DVec2, f64)> = (0..7)
            .map(|i| DVec2::from_angle(0.1 + TAU * f64::from(i) / 7.0))
            .map(|direction| (direction, outline.iter().map(|corner| corner.dot(direction)).fold(0.0, f64::max)))
            .collect();
        let camera = Camera::new(&through(lens), [64, 64], DVec3::ZERO).expect("a camera of the test");
        let (mut most, mut rng) = ([0.0_f64; 7], Rng::new(70, 1));
        let ends = [0.0, 0.5, 1.0_f32.next_down()];
        let special = ends.into_iter().flat_map(|a| ends.map(|b| [a, b]));
        let random: Vec<_> = (0..200_000).map(|_| rng.next_2d()).collect();
        for u in special.chain(random) {
            let p = camera.ray_through_lens(1.0, 2.0, u).origin.as_dvec3().truncate() / RADIUS;
            for (most, (direction, farthest)) in most.iter_mut().zip(&towards) {
                *most = most.max(p.dot(*direction) / farthest);
            }
        }
        case.at_most(format!("{name}: reach, of its corners'"), most.into_iter().fold(0.0, f64::max), 1.0 + 1e-6);
        case.at_most(format!("{name}: corner not reached"), 1.0 - most.into_iter().fold(1.0, f64::min), 0.02);
    }
    let draws = case.count(500_000, 3_000_000) as usize;
    for sides in [3_u32, 5, 8] {
        let outline = corners(&lens(sides, 0.0, 1.0));
        let density = 1.0 / area(&outline);
        let mut rng = Rng::new(70, u64::from(sides));
        let draw = || {
            let [x, y] = warps::uniform_polygon(rng.next_2d(), sides as f32);
            (f64::from(x), f64::from(y), density)
        };
        let is_inside = |x: f64, y: f64| {
            let p = DVec2::new(x, y);
            outline.iter().zip(outline.iter().cycle().skip(1)).all(|(a, b)| (*b - *a).perp_dot(p - *a) >= 0.0)
        };
        let inside = |x: f64, y: f64| if is_inside(x, y) { density } else { 0.0 };
        let check = check_density((40, 40), ((-1.0, 1.0), (-1.0, 1.0)), draws, draw, inside);
        case.p_value(format!("polygon of {sides} sides: 40 x 40 counts"), check.p_value, 3);
    }
}

/// Surfaces in the plane at distance `depth`, each a rectangle from `low` to `high` or a disk around 0, that shine with
/// radiance 1.
fn flat(camera: CameraDesc, depth: f64, [low, high]: [DVec2; 2]) -> SceneDesc {
    let at = |x: f64, y: f64| DVec3::new(x, y, -depth);
    let positions = vec![at(low.x, low.y), at(high.x, low.y), at(high.x, high.y), at(low.x, high.y)];
    let look = BsdfDesc::Lambert { albedo: Rgb::splat(0.75) };
    let mut desc = scene(camera, vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, look, Some(Rgb::ONE))]);
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = MeshDesc { name: "light".into(), path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() };
    desc.meshes.push(mesh.into());
    desc
}

fn picture(desc: &SceneDesc, resolution: [u32; 2], samples: u64, seed: u64) -> Image {
    // What emits is seen at the first hit.
    let (samples, max_depth) = (samples as u32, Some(1));
    layers(desc, RenderDesc { resolution, samples, seed, max_depth, ..RenderDesc::default() })
}

/// A square light out of focus: its image is that of a pinhole, folded with the aperture's, whose moments add up.
fn confusion(case: &mut Case) {
    const SIDE: u32 = 48;
    let (samples, seeds) = (case.count(256, 4096), case.count(8, 12));
    // Pixels for each unit of the tangent.
    let scale = f64::from(SIDE) / (2.0 * TANGENT);
    let shapes = [("disk", lens(0, 0.0, 1.0)), ("3 blades", lens(3, 0.0, 1.0)), ("disk, squeeze 2", lens(0, 0.0, 2.0))];
    for (name, lens) in shapes {
        for depth in [2.5, 12.0] {
            // The light's half side is 4 pixels.
            let half = 4.0 / scale * depth;
            let desc = flat(through(lens), depth, [DVec2::splat(-half), DVec2::splat(half)]);
            let images: Vec<Image> = (0..seeds).map(|seed| picture(&desc, [SIDE; 2], samples, seed)).collect();
            let moment = |factor: &dyn Fn(f64, f64) -> f64| {
                let of = |image: &Image| {
                    let pixels = (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE));
                    let middle = 0.5 * f64::from(SIDE);
                    let terms = pixels.map(|(x, y)| {
                        let (right, above) = (f64::from(x) + 0.5 - middle, middle - f64::from(y) - 0.5);
                        f64::from(image.pixel(x, y)[0]) * factor(right, above) / 64.0
                    });
                    terms.sum::<f64>()
                };
                mean_and_error(&images.iter().map(of).collect::<Vec<_>>())
            };
            // Radius of the circle of confusion, in pixels, positive behind the plane in focus.
            let radius = scale * RADIUS * (1.0 - FOCUS / depth) / FOCUS;
            let where_ = if depth < FOCUS { "before the focus" } else { "behind the focus" };
            case.mean(format!("{name}, {where_}: energy over a pinhole's"), moment(&|_, _| 1.0), 1.0, 2e-3);
            // A pixel's own width spreads what is in it, which the middle of the pixel does not know: its variance of 1/12 goes
            // off by Sheppard's correction.
            let own = 16.0 / 3.0 + 1.0 / 12.0;
            let spread = if lens.blades == 3 { 1.5 / 6.0 } else { 0.5 };
            let across = own + 0.5 * spread * (radius / lens.squeeze).powi(2);
            let upwards = own + 0.5 * spread * radius.powi(2);
            case.mean(format!("{name}, {where_}: second moment across"), moment(&|x, _| x * x), across, 4e-3);
            case.mean(format!("{name}, {where_}: second moment upwards"), moment(&|_, y| y * y), upwards, 4e-3);
            if lens.blades == 3 {
                // The triangle has its corner at the right behind the focus, and at the left before it.
                let exact = radius.powi(3) / 40.0;
                case.mean(format!("{name}, {where_}: third moment across"), moment(&|x, _| x * x * x), exact, 0.05);
            }
        }
    }
}

/// The profile of a half-plane's edge out of focus: what of the aperture sees it.
fn edges(case: &mut Case) {
    const SIZE: [u32; 2] = [40, 8];
    let samples = case.count(4096, 32_768);
    let scale = f64::from(SIZE[0]) / (2.0 * TANGENT);
    for (name, lens) in [
        ("disk", lens(0, 0.0, 1.0)),
        ("5 blades turned by 10°", lens(5, 10.0, 1.0)),
        ("3 blades, squeeze 1.5", lens(3, 0.0, 1.5)),
    ] {
        let outline = corners(&lens);
        let share = |x: f64| if lens.blades == 0 { segment(x) } else { share_below(&outline, x) };
        for depth in [2.5, 12.0] {
            // Light to the left of 1.3 pixels right of the middle.
            let edge = 1.3 / scale * depth;
            let desc = flat(through(lens), depth, [DVec2::splat(-100.0), DVec2::new(edge, 100.0)]);
            let image = picture(&desc, SIZE, samples, 3);
            let albedo = &image.layer("albedo").expect("an auxiliary layer").data;
            // The ray through the lens's point a and the film's point t is at t depth + a (1 - depth / FOCUS) there.
            let slope = RADIUS * (1.0 - depth / FOCUS);
            let seen = |t: f64| {
                let x = (edge - t * depth) / slope;
                if slope > 0.0 { share(x) } else { 1.0 - share(x) }
            };
            let (mut worst, mut layer, mut sum) = (0.0_f64, 0.0_f64, 0.0);
            for column in 0..SIZE[0] {
                const STEPS: u32 = 400;
                let at =
                    |i: u32| f64::from(column) + (f64::from(i) + 0.5) / f64::from(STEPS) - 0.5 * f64::from(SIZE[0]);
                let exact = (0..STEPS).map(|i| seen(at(i) / scale)).sum::<f64>() / f64::from(STEPS);
                let rows = 0..SIZE[1];
                let mean = |of: &dyn Fn(u32) -> f64| rows.clone().map(of).sum::<f64>() / f64::from(SIZE[1]);
                let found = mean(&|row| f64::from(image.pixel(column, row)[0]));
                let place = |row: u32| 3 * (row * SIZE[0] + column) as usize;
                let of_layer = mean(&|row| f64::from(albedo[place(row)]) / 0.75);
                worst = worst.max((found - exact).abs());
                layer = layer.max((of_layer - exact).abs());
                sum += found - exact;
            }
            let where_ = if depth < FOCUS { "before the focus" } else { "behind the focus" };
            let limit = if case.is_full() { 3e-4 } else { 3e-3 };
            case.at_most(format!("{name}, {where_}: worst column"), worst, limit);
            case.at_most(format!("{name}, {where_}: worst column of the albedo"), layer, limit);
            case.at_most(format!("{name}, {where_}: place of the edge, pixels"), sum.abs(), 4.0 * limit);
        }
    }
}

/// Rays of a film position meet in the plane of focus, and an edge there is as sharp as with a pinhole.
fn focus(case: &mut Case) {
    let kinds = [
        ("the point looked at", FocusDesc::LookAt, FOCUS),
        ("a distance", FocusDesc::Distance(6.5), 6.5),
        ("a point beside the axis", FocusDesc::Point(DVec3::new(2.0, -1.0, -2.75)), 2.75),
        ("a far distance", FocusDesc::Distance(1e6), 1e6),
    ];
    for (name, focus, distance) in kinds {
        for (shape, blades) in [("disk", 0), ("6 blades", 6)] {
            let lens = LensDesc { focus, ..lens(blades, 0.0, 1.0) };
            let camera = Camera::new(&through(lens), [40, 30], DVec3::ZERO).expect("a camera of the test");
            let (mut rng, mut off) = (Rng::new(73, 0), 0.0_f64);
            for _ in 0..20_000 {
                let [x, y] = rng.next_2d().map(|u| 40.0 * u);
                let ray = camera.ray_through_lens(x, y, rng.next_2d());
                let direction = ray.direction.as_dvec3();
                let met = ray.origin.as_dvec3() + direction * (distance + f64::from(ray.origin.z)) / -direction.z;
                // Of a pinhole's ray, in pixels.
                let pinhole = camera.ray(x, y).direction.as_dvec3();
                let away = (met / distance - pinhole / -pinhole.z).length() * 40.0 / (2.0 * TANGENT);
                off = off.max(away);
            }
            case.at_most(format!("focus at {name}, {shape}: rays off their point, pixels"), off, 4e-5);
        }
        // An edge at 0.3 of a column: no other column has a mixture.
        let (samples, size) = (case.count(64, 1024), [16, 4]);
        let edge = 1.3 * 2.0 * TANGENT / 16.0 * distance;
        let lens = LensDesc { focus, ..lens(5, 0.0, 1.0) };
        let whole = DVec2::splat(-distance);
        let image = picture(&flat(through(lens), distance, [whole, DVec2::new(edge, distance)]), size, samples, 1);
        let mut mixed = 0;
        for i in 0..size[0] * size[1] {
            let (column, value) = (i % size[0], image.pixel(i % size[0], i / size[0])[0]);
            mixed += u64::from(column != 9 && value != if column < 9 { 1.0 } else { 0.0 });
        }
        case.never(format!("edge in focus at {name}: pixels beside it that mix"), mixed, 60);
        let column = (0..4).map(|row| f64::from(image.pixel(9, row)[0])).sum::<f64>() / 4.0;
        case.exact(format!("edge in focus at {name}: its own column"), column, 0.3, Within::Absolute(4e-3));
    }
}

/// A bar near the lens hides all from its middle, and little from its edge: light comes by all methods as by paths.
fn methods(case: &mut Case) {
    let grey = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| ShapeDesc::Triangle([a, b, c].map(DVec3::from_array));
    let surfaces = vec![
        (ShapeDesc::Sphere { centre: DVec3::new(0.0, 0.0, -1.0), radius: 0.4 }, BsdfDesc::Black, None),
        (triangle([-20.0, -20.0, -6.0], [20.0, -20.0, -6.0], [0.0, 30.0, -6.0]), grey, None),
        (triangle([-3.0, 4.0, -4.0], [0.0, 4.0, -5.5], [3.0, 4.0, -4.0]), BsdfDesc::Black, Some(Rgb::splat(10.0))),
    ];
    let with = |radius: f64| {
        let lens = LensDesc { focus: FocusDesc::Distance(6.0), ..LensDesc::new(radius) };
        scene(through(lens), surfaces.clone())
    };
    let job = |integrator, samples| Job { resolution: [16, 16], samples, integrator, ..Job::default() };
    let (image, _) = render(&with(1.0), &job(IntegratorDesc::Path, case.count(512, 32_768) as u32));
    let (exact, error) = image_mean(&image);
    let (dark, _) = render(&with(0.0), &job(IntegratorDesc::Path, 64));
    case.exact("through a pinhole: what is seen beside the ball", image_mean(&dark).0, 0.0, Within::Absolute(0.0));
    case.at_most("through the lens: standard error of the mean", error / exact, 3e-3);
    for integrator in [
        IntegratorDesc::Direct,
        IntegratorDesc::Whitted,
        IntegratorDesc::Caustic,
        IntegratorDesc::Photon,
        IntegratorDesc::Ppm,
        IntegratorDesc::Sppm,
        IntegratorDesc::IrradianceCache,
        IntegratorDesc::Radiosity,
    ] {
        let (image, _) = render(&with(1.0), &job(integrator, case.count(64, 4096) as u32));
        let (mean, own) = image_mean(&image);
        case.biased_mean(format!("a wall by {integrator:?}"), (mean, own.hypot(error)), exact, (1e-2, 1e-2));
    }
}
