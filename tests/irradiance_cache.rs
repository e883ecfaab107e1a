//! The irradiance cache: its gradients, its values where they are known, what it must not answer, and that it is the same
//! for any number of threads.

mod common;

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use common::scenes::{box_inside, camera, mean_and_error, point_light, render_scene, scene};
use etendue::camera::Camera;
use etendue::desc::{self, BsdfDesc, IntegratorDesc, RenderDesc, SceneDesc, ShapeDesc};
use etendue::integrator::irradiance_cache::hemisphere::{Estimate, Incident, Strata};
use etendue::integrator::irradiance_cache::{IrradianceCache, fill_cache};
use etendue::integrator::photon::{Gather, Plan};
use etendue::math::{DVec3, Vec3};
use etendue::render::{Render, RenderSettings};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Alone, Cancel, ErrorKind, Parallel, Result};

// Gradients against closed forms.

/// Irradiance from a polygon of radiance 1 that lies over the horizon: Lambert's formula.
fn polygon(corners: &[DVec3], p: DVec3, n: DVec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = ((corners[i] - p).normalize(), (corners[(i + 1) % corners.len()] - p).normalize());
        a.angle_between(b) * a.cross(b).normalize().dot(n)
    };
    (0.5 * (0..corners.len()).map(edge).sum::<f64>()).abs()
}

/// What a ray from the origin meets of a polygon, anticlockwise or clockwise as seen from there.
fn distance(corners: &[DVec3], direction: DVec3) -> Option<f64> {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let t = normal.dot(corners[0]) / normal.dot(direction);
    let side = |i: usize| corners[i].cross(corners[(i + 1) % corners.len()]).dot(direction);
    let (first, same) = (side(0), |i| side(i) * side(0) > 0.0);
    (t > 0.0 && first != 0.0 && (1..corners.len()).all(same)).then_some(t)
}

/// Estimates from independent sets of rays: mean of what `value` makes of them, and its standard error.
fn estimates(ray: impl Fn(DVec3) -> (f64, f64), value: impl Fn(&Estimate) -> f64) -> (f64, f64) {
    let strata = Strata::new(1 << 16);
    let one = |seed| {
        let mut rng = Rng::new(9, seed);
        let incident = |number| {
            let (radiance, distance) = ray(strata.direction(number, rng.next_2d()).as_dvec3());
            Incident { radiance: Rgb::splat(radiance as f32), distance: distance as f32 }
        };
        let rays: Vec<Incident> = (0..strata.count()).map(incident).collect();
        value(&strata.estimate(&rays))
    };
    let values: Vec<f64> = (0..16).map(one).collect();
    let mean = values.iter().sum::<f64>() / 16.0;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 15.0;
    (mean, (variance / 16.0).sqrt())
}

/// That irradiance and gradients are those of the closed form `exact(p, n)` at the origin, within `share` of the largest
/// component and four standard errors.
fn check_gradients(what: &str, ray: impl Fn(DVec3) -> (f64, f64), exact: impl Fn(DVec3, DVec3) -> f64, share: f64) {
    let h = 1e-5;
    let moved = |step: DVec3| (exact(step * h, DVec3::Z) - exact(-step * h, DVec3::Z)) / (2.0 * h);
    // About x, z turns towards -y; about y, towards x.
    let turned = |towards: DVec3| {
        let at = |angle: f64| exact(DVec3::ZERO, DVec3::Z * angle.cos() + towards * angle.sin());
        (at(h) - at(-h)) / (2.0 * h)
    };
    type Value = fn(&Estimate) -> f64;
    let values: [(&str, Value, f64); 5] = [
        ("irradiance", |e| e.irradiance.r().into(), exact(DVec3::ZERO, DVec3::Z)),
        ("d/dx", |e| e.translation[0].r().into(), moved(DVec3::X)),
        ("d/dy", |e| e.translation[1].r().into(), moved(DVec3::Y)),
        ("about x", |e| e.rotation[0].r().into(), turned(DVec3::NEG_Y)),
        ("about y", |e| e.rotation[1].r().into(), turned(DVec3::X)),
    ];
    for (i, (name, value, exact)) in values.into_iter().enumerate() {
        let largest = match i {
            0 => values[0].2,
            1 | 2 => values[1].2.hypot(values[2].2),
            _ => values[3].2.hypot(values[4].2),
        };
        let (mean, error) = estimates(&ray, value);
        println!("{what}: {name} {mean:.5} +- {error:.5}, exactly {exact:.5}");
        assert!((mean - exact).abs() <= share * largest.abs() + 4.0 * error, "{what}: {name} {mean}, exactly {exact}");
    }
}

const PANEL: [DVec3; 4] =
    [DVec3::new(0.4, -0.3, 1.0), DVec3::new(1.6, 0.1, 1.2), DVec3::new(1.4, 0.9, 1.5), DVec3::new(0.2, 0.5, 1.3)];

#[test]
fn gradients_of_a_bright_panel_are_those_of_the_closed_form() {
    // The panel is planar to single precision only as a parallelogram.
    let panel = [PANEL[0], PANEL[1], PANEL[1] + PANEL[3] - PANEL[0], PANEL[3]];
    check_gradients(
        "panel",
        |d| distance(&panel, d).map_or((0.0, f64::INFINITY), |t| (1.0, t)),
        |p, n| polygon(&panel, p, n),
        0.01,
    );
}

#[test]
fn the_nearer_surface_moves_the_border() {
    // A dark panel before a bright sky: all that changes is what the panel hides.
    let panel = [PANEL[0], PANEL[1], PANEL[1] + PANEL[3] - PANEL[0], PANEL[3]];
    check_gradients(
        "panel before the sky",
        |d| distance(&panel, d).map_or((1.0, 1e6), |t| (0.0, t)),
        // A sky that is level with the horizon of a turned surface loses no light to first order.
        |p, n| PI - polygon(&panel, p, n),
        0.01,
    );
}

#[test]
fn light_painted_on_a_ceiling_moves_with_it() {
    // L = 1 + sin(k x) / 2 at height 1: irradiance pi + A sin(k x), with A from the moment at x = 0 by quadrature.
    let k = 2.0;
    let amplitude = {
        let n = 2000;
        let mut sum = 0.0;
        for i in 0..n {
            // Uniform in sin^2, the tail beyond tan = 200 left out: it averages to nothing.
            let sin2 = (i as f64 + 0.5) / n as f64;
            let tan = (sin2 / (1.0 - sin2)).sqrt();
            // Mean of cos(k tan cos(phi)) over phi is J0, by the trapezoidal rule, exact for periodic functions.
            let m = 64 + 8 * (k * tan).ceil() as usize;
            let mean: f64 = (0..m).map(|j| (k * tan * (TAU * j as f64 / m as f64).cos()).cos()).sum::<f64>() / m as f64;
            sum += mean / n as f64;
        }
        0.5 * PI * sum
    };
    let strata_value = |e: &Estimate| f64::from(e.translation[0].r());
    let ray = |d: DVec3| (1.0 + 0.5 * (k * d.x / d.z).sin(), 1.0 / d.z);
    let (mean, error) = estimates(ray, strata_value);
    let exact = amplitude * k;
    println!("painted ceiling: {mean:.5} +- {error:.5}, exactly {exact:.5}");
    assert!((mean - exact).abs() <= 0.01 * exact + 4.0 * error, "{mean}, exactly {exact}");
    let (mean, error) = estimates(|d| (1.0, 1.0 / d.z), strata_value);
    assert!(mean.abs() <= 4.0 * error + 1e-6, "an even ceiling has the gradient {mean}");
}

// Caches.

fn lambert(albedo: f32) -> BsdfDesc {
    BsdfDesc::Lambert { albedo: Rgb::splat(albedo) }
}

fn built(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

fn settings(resolution: [u32; 2], samples: u32) -> RenderDesc {
    RenderDesc { resolution, samples, seed: 3, integrator: IntegratorDesc::IrradianceCache, ..RenderDesc::default() }
}

/// A room whose walls glow and reflect: radiance 1 / (1 - albedo) everywhere.
fn furnace(albedo: f32) -> SceneDesc {
    let mut desc = scene(
        camera(DVec3::new(0.3, -0.2, 0.4), DVec3::new(1.0, 0.4, -0.3), 90.0),
        vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, lambert(albedo), Some(Rgb::ONE))],
    );
    desc.meshes.push(box_inside(DVec3::new(-1.0, -1.5, -2.0), DVec3::new(1.0, 1.5, 2.0)).into());
    desc
}

/// A cache filled without the renderer, and what its gather rays asked.
fn filled(scene: &Scene, desc: RenderDesc, parallel: &mut impl Parallel) -> Result<(IrradianceCache, Vec<String>)> {
    let desc = Arc::new(desc);
    let camera = Camera::new(scene.camera(), desc.resolution, scene.centre())?;
    let source: Gather = Plan::new(scene, &camera, &desc, IntegratorDesc::Caustic)?.gather(0, &mut Alone::default())?;
    let (cache, report) = fill_cache(scene, &camera, &desc, &source.unaided(), parallel)?;
    Ok((cache, report.notes))
}

/// Bias in percent and its standard error, as reported.
fn bias(notes: &[String]) -> (f64, f64) {
    let text = notes.iter().find_map(|note| note.split_once("bias ")).expect("a note on the bias").1;
    let mut words = text.split(' ');
    let mut number = || words.next().and_then(|word| word.parse().ok()).expect("a number");
    let bias = number();
    assert_eq!(words.next(), Some("+-"));
    (bias, words.next().and_then(|word| word.parse().ok()).expect("a number"))
}

#[test]
fn a_furnace_is_as_bright_as_it_must_be() {
    let albedo = 0.6;
    let scene = built(&furnace(albedo));
    let (image, summary) = render_scene(&scene, settings([48, 48], 64));
    let exact = 1.0 / (1.0 - f64::from(albedo));
    let (mean, error) = mean_and_error(&image);
    let (bias, bias_error) = bias(&summary.notes);
    println!("{mean:.5} +- {error:.5}, exactly {exact:.5}; {:?}", summary.notes);
    // What is cached is albedo^2 / (1 - albedo) of it. Its own noise, shared by all pixels, shows in the bias.
    let cached = f64::from(albedo * albedo / (1.0 - albedo));
    let allowed = 4.0 * error + 0.01 * (bias.abs() + 4.0 * bias_error) * cached;
    assert!((mean - exact).abs() <= allowed, "{mean}, exactly {exact}, allowed {allowed}");
    // A fault of two percent in what is cached would show.
    assert!(allowed < 0.02 * cached, "{allowed} of {cached} proves nothing");
    assert!(bias.abs() <= 4.0 * bias_error + 0.005, "bias {bias} +- {bias_error} %");
}

#[test]
fn records_of_a_furnace_are_exact_everywhere() {
    let albedo = 0.5;
    let scene = built(&furnace(albedo));
    let (cache, _) = filled(&scene, settings([32, 32], 1), &mut Alone::default()).unwrap();
    assert!(cache.len() > 10, "{} records", cache.len());
    // Without what comes straight from the walls: pi albedo / (1 - albedo).
    let exact = PI;
    let mut rng = Rng::new(5, 5);
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0);
    for _ in 0..4000 {
        let [u, v] = rng.next_2d();
        // The wall that the camera looks at.
        let p = Vec3::new(1.0, 3.0 * u - 1.5, 4.0 * v - 2.0);
        let p = p - scene.centre().as_vec3a();
        let Some(irradiance) = cache.irradiance(p, Vec3::NEG_X) else { continue };
        count += 1;
        sum += f64::from(irradiance.g());
        worst = worst.max((f64::from(irradiance.g()) / exact - 1.0).abs());
        assert!(cache.irradiance(p, Vec3::X).is_none(), "an answer on the outside");
        assert!(cache.irradiance(p - 0.2 * Vec3::X, Vec3::NEG_X).is_none(), "an answer off the wall");
    }
    println!(
        "{count} answers of 4000, mean {:.5} of the exact, worst off by {worst:.4}",
        sum / f64::from(count) / exact
    );
    assert!(count > 1000, "{count} answers");
    assert!((sum / f64::from(count) / exact - 1.0).abs() < 0.01);
    assert!(worst < 0.1, "off by {worst}");
}

#[test]
fn any_number_of_threads_makes_the_same_image() {
    let mut desc = furnace(0.7);
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    common::scenes::add(
        &mut desc,
        1,
        ShapeDesc::Sphere { centre: DVec3::new(0.6, 0.2, -0.2), radius: 0.2 },
        glass,
        None,
    );
    let scene = built(&desc);
    let render = |threads| {
        let mut desc = settings([40, 24], 4);
        desc.cache.rays = 128;
        let settings = RenderSettings { desc, threads, ..RenderSettings::default() };
        let mut render = Render::new(&scene, settings).unwrap();
        let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        let bits: Vec<u32> = render.image().rgb.iter().map(|value| value.to_bits()).collect();
        (bits, summary.notes)
    };
    let one = render(1);
    assert!(one.1.iter().any(|note| note.contains("irradiance cache:")), "{:?}", one.1);
    for threads in [2, 5] {
        assert!(render(threads) == one, "{threads} threads");
    }
}

#[test]
fn scenes_with_next_to_nothing() {
    let floor =
        ShapeDesc::Triangle([DVec3::new(-1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.0, 0.0, -1.0)]);
    let view = camera(DVec3::new(0.0, 2.0, 0.1), DVec3::ZERO, 60.0);
    // Nothing, and a triangle in the dark.
    for surfaces in [vec![], vec![(floor, lambert(0.5), None)]] {
        let (image, _) = render_scene(&built(&scene(view, surfaces)), settings([16, 16], 4));
        assert!(image.rgb.iter().all(|value| *value == 0.0));
    }
    // A triangle under a point light: direct light only, so the same as by paths.
    let mut desc = scene(view, vec![(floor, lambert(0.5), None)]);
    desc.lights.push(point_light(DVec3::Y, 1.0));
    let scene = built(&desc);
    let (image, summary) = render_scene(&scene, settings([16, 16], 16));
    let path = RenderDesc { integrator: IntegratorDesc::Path, ..settings([16, 16], 16) };
    let (by_paths, _) = render_scene(&scene, path);
    println!("{:?}", summary.notes);
    let ((a, a_error), (b, b_error)) = (mean_and_error(&image), mean_and_error(&by_paths));
    assert!(b > 0.01 && (a - b).abs() <= 4.0 * a_error.hypot(b_error) + 1e-6 * b, "{a} +- {a_error}, {b} +- {b_error}");
}

#[test]
fn as_bright_as_path_tracing_within_the_reported_bias() {
    for name in ["cornell", "room"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("json");
        let scene = built(&desc::load(&path, None).expect("a scene of the repository"));
        let (image, summary) = render_scene(&scene, settings([48, 48], 128));
        let by = |integrator| render_scene(&scene, RenderDesc { integrator, ..settings([48, 48], 256) }).0;
        let ((mean, error), (exact, exact_error)) = (mean_and_error(&image), mean_and_error(&by(IntegratorDesc::Path)));
        // The bias is that of indirect light alone.
        let indirect = exact - mean_and_error(&by(IntegratorDesc::Direct)).0;
        let (bias, bias_error) = bias(&summary.notes);
        println!("{name}: {mean:.5} +- {error:.5}, by paths {exact:.5} +- {exact_error:.5}; {:?}", summary.notes);
        let allowed = 4.0 * error.hypot(exact_error) + 0.01 * (bias.abs() + 4.0 * bias_error) * indirect;
        assert!((mean - exact).abs() <= allowed, "{name}: {mean}, by paths {exact}, allowed {allowed}");
        assert!(allowed < 0.03 * exact, "{name}: {allowed} of {exact} proves nothing");
    }
}

#[test]
fn a_large_lamp_in_a_mirror_is_found_without_a_map() {
    // A floor that lamps light by way of a mirror wall and of a glass ball, and a lid that shades it from them.
    let quad = |corners: [[f64; 3]; 4]| ShapeDesc::Quad(corners.map(DVec3::from_array));
    let floor = quad([[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, -2.0]]);
    let lamp = quad([[-2.0, 2.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, 2.0, 1.0], [-2.0, 2.0, 1.0]]);
    let lid = quad([[-1.2, 1.0, -2.0], [-0.2, 1.0, -2.0], [-0.2, 1.0, 2.0], [-1.2, 1.0, 2.0]]);
    let mirror = quad([[2.0, 0.0, -2.0], [2.0, 0.0, 2.0], [2.0, 2.0, 2.0], [2.0, 2.0, -2.0]]);
    let ball = ShapeDesc::Sphere { centre: DVec3::new(1.0, 0.4, 0.0), radius: 0.4 };
    let rough = BsdfDesc::OrenNayar { albedo: Rgb::splat(0.5), roughness: 0.7 };
    let desc = scene(
        camera(DVec3::new(-0.5, 0.9, 0.8), DVec3::new(0.6, 0.0, 0.9), 40.0),
        vec![
            (floor, rough, None),
            (lamp, BsdfDesc::Black, Some(Rgb::ONE)),
            (lid, BsdfDesc::Black, None),
            (mirror, BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }, None),
            (ball, BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 }, None),
        ],
    );
    let scene = built(&desc);
    let (image, summary) = render_scene(&scene, settings([24, 24], 4096));
    assert!(!summary.notes.iter().any(|note| note.contains("caustic photon map")), "{:?}", summary.notes);
    let path = RenderDesc { integrator: IntegratorDesc::Path, ..settings([24, 24], 16384) };
    let direct = RenderDesc { integrator: IntegratorDesc::Direct, ..settings([24, 24], 512) };
    let [exact, direct] = [path, direct].map(|desc| mean_and_error(&render_scene(&scene, desc).0));
    let (mean, error) = mean_and_error(&image);
    println!("{mean} +- {error}, by paths {exact:?}, direct {direct:?}");
    // The floor sees itself in nothing but mirror and glass, so all that the cache has to say is small.
    let allowed = 4.0 * error.hypot(exact.1) + 0.002 * exact.0;
    assert!((mean - exact.0).abs() <= allowed, "{mean}, by paths {} +- {allowed}", exact.0);
    // A fault of 4 % in them would show.
    assert!(exact.0 - direct.0 > 25.0 * allowed, "caustics are too small a part to tell");
    // With a radius of their own they come from a map, as they do with small lamps.
    let mut by_map = settings([24, 24], 64);
    by_map.photons.caustic_radius = Some(0.02);
    let (image, summary) = render_scene(&scene, by_map);
    assert!(summary.notes.iter().any(|note| note.contains("caustic photon map")), "{:?}", summary.notes);
    let (mapped, mapped_error) = mean_and_error(&image);
    assert!((mapped - exact.0).abs() <= 4.0 * mapped_error + 0.02 * exact.0, "{mapped} +- {mapped_error} by a map");
}

#[test]
fn a_thin_wall_does_not_leak() {
    // A wall of a thousandth of the floor's width stands across it, under nothing. The light is low on the left, so the right
    // half is black: no light comes there at all.
    let quad = |corners: [[f64; 3]; 4]| ShapeDesc::Quad(corners.map(DVec3::from_array));
    let floor = quad([[-0.5, 0.0, -0.5], [-0.5, 0.0, 0.5], [0.5, 0.0, 0.5], [0.5, 0.0, -0.5]]);
    let at = 0.0005;
    let left = quad([[-at, 0.0, -0.5], [-at, 0.3, -0.5], [-at, 0.3, 0.5], [-at, 0.0, 0.5]]);
    let right = quad([[at, 0.0, -0.5], [at, 0.0, 0.5], [at, 0.3, 0.5], [at, 0.3, -0.5]]);
    let top = quad([[-at, 0.3, -0.5], [at, 0.3, -0.5], [at, 0.3, 0.5], [-at, 0.3, 0.5]]);
    let white = || lambert(0.8);
    let mut desc = scene(
        camera(DVec3::new(0.0, 1.5, 0.01), DVec3::ZERO, 40.0),
        [floor, left, right, top].into_iter().map(|shape| (shape, white(), None)).collect(),
    );
    desc.lights.push(point_light(DVec3::new(-0.2, 0.15, 0.0), 1.0));
    let scene = built(&desc);
    let mut job = settings([64, 64], 1);
    // Records as large as they may be.
    (job.cache.error, job.cache.max_spacing, job.cache.min_spacing) = (0.5, 0.5, 8.0);
    let (cache, notes) = filled(&scene, job, &mut Alone::default()).unwrap();
    println!("{notes:?}");
    let centre = scene.centre().as_vec3a();
    let mut rng = Rng::new(8, 8);
    let (mut lit, mut dark) = (0, 0);
    for _ in 0..20_000 {
        let [u, v] = rng.next_2d();
        // Mostly close to the wall.
        let x = 0.0006 + 0.45 * u * u * u;
        let at = |x: f32| Vec3::new(x, 0.0, 0.9 * v - 0.45) - centre;
        lit += i32::from(cache.irradiance(at(-x), Vec3::Y).is_some_and(|irradiance| irradiance.g() > 0.0));
        if let Some(irradiance) = cache.irradiance(at(x), Vec3::Y) {
            assert_eq!(irradiance, Rgb::ZERO, "{x} behind the wall");
            dark += 1;
        }
    }
    assert!(lit > 10_000 && dark > 5_000, "{lit} lit and {dark} dark answers");
}

/// Ends after so many pieces of work have been asked for.
struct Ending {
    left: usize,
    cancel: Cancel,
}

impl Parallel for Ending {
    fn check(&mut self) -> Result<()> {
        self.cancel.check()
    }

    fn map<R, F>(&mut self, count: usize, piece: F) -> Result<Vec<R>>
    where
        R: Send + 'static,
        F: Fn(usize) -> R + Send + Sync + 'static,
    {
        let one = |number| {
            if self.left == 0 {
                self.cancel.cancel();
            }
            self.left = self.left.saturating_sub(1);
            self.cancel.check().map(|()| piece(number))
        };
        (0..count).map(one).collect()
    }
}

#[test]
fn filling_stops_wherever_it_is_told_to() {
    let scene = built(&furnace(0.5));
    let job = || {
        let mut job = settings([24, 24], 1);
        job.cache.rays = 32;
        job
    };
    let mut whole = Ending { left: usize::MAX, cancel: Cancel::new() };
    let (cache, _) = filled(&scene, job(), &mut whole).unwrap();
    let pieces = usize::MAX - whole.left;
    assert!(cache.len() > 10 && pieces > cache.len(), "{} records, {pieces} pieces", cache.len());
    for left in [0, 1, 2, 10, pieces / 2, pieces - 80, pieces - 1] {
        let error = filled(&scene, job(), &mut Ending { left, cancel: Cancel::new() }).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled, "after {left} of {pieces} pieces");
    }
}
