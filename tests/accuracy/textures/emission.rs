//! Lamps whose radiance a texture varies.

use etendue::desc::{
    BsdfDesc, IntegratorDesc, Projection, SceneDesc, TextureDesc, TextureKey, TextureMapping, TextureSource,
};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TextureFilter};

use super::scenes::{quad, vary};
use super::{Mean, described, image};
use crate::common::scenes::{Job, camera, mean_and_error, render, scene};
use crate::lights::polygon_factor;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "X13", title: "textured lamps, by points", run: points },
        Entry { id: "X14", title: "textured lamps, whole pictures", run: pictures },
        Entry { id: "X16", title: "textured lamps of which little shines", run: spots },
    ]
}

/// The radiances of 4 x 4 squares, some of which are dark and few bright, columns to the right and rows from the top.
fn radiance(x: u32, y: u32) -> f64 {
    match 4 * y + x {
        2 => 20.0,
        7 => 6.0,
        i if i % 3 == 0 => 0.0,
        i => 0.1 * f64::from(i),
    }
}

/// A lamp of these squares over [-1, 1]^2 at the height 1, which shines down; u along x and v along z. On its floor, which is white.
pub fn lamp(mapping: Option<Projection>) -> SceneDesc {
    let texels = image(4, 4, 3, |x, y, c| radiance(x, y) as f32 * [1.0, 0.5, 0.25][c as usize]);
    let corners = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
    let floor = quad([[-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]]);
    let white = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let mut desc = scene(
        camera(0.9 * DVec3::Y, DVec3::ZERO, 90.0),
        vec![(quad(corners), BsdfDesc::Black, None), (floor, white, None)],
    );
    desc.materials[0].emission = Some(Rgb::splat(2.0));
    let texture = described("lamp", &texels, ColorSpace::Linear, TextureFilter::Nearest, 1.0);
    let texture = match mapping {
        // Seen from above u is x, and v is -z: turned over.
        Some(projection) => TextureDesc {
            mapping: TextureMapping::Projected { projection, scale: [0.5, -0.5], rotation: 0.0, offset: [0.5; 2] },
            ..texture
        },
        None => texture,
    };
    vary(&mut desc, 0, TextureKey::Emission, texture);
    desc
}

/// Irradiance in red at a point that looks up, from the squares one by one.
pub fn exact(p: DVec3, n: DVec3) -> f64 {
    let edge = |i: u32| 0.5 * f64::from(i) - 1.0;
    let all = (0..4).flat_map(|x| (0..4).map(move |y| (x, y)));
    all.map(|(x, y)| {
        // Rows are counted from the top, where v, and so z, is largest.
        let (z0, z1) = (edge(3 - y), edge(4 - y));
        let corners = [[edge(x), z0], [edge(x + 1), z0], [edge(x + 1), z1], [edge(x), z1]];
        let corners = corners.map(|[x, z]| DVec3::new(x, 1.0, z));
        2.0 * radiance(x, y) * std::f64::consts::PI * polygon_factor(p, n, &corners)
    })
    .sum()
}

/// Light samples at points of the floor, and rays that meet the lamp, have the closed form as their mean; and so have powers.
fn points(case: &mut Case) {
    let count = case.count(200_000, 4_000_000) as u32;
    for mapping in [None, Some(Projection::Y)] {
        let how = if mapping.is_some() { "projected" } else { "by its own coordinates" };
        let built = Scene::build(&lamp(mapping), &BuildOptions::default()).expect("a scene of the test");
        let power: f64 = built.emitters().emitters().iter().map(|emitter| emitter.power().x).sum();
        let sum: f64 = (0..16).map(|i| 2.0 * radiance(i % 4, i / 4)).sum();
        case.exact(
            format!("power of the lamp, {how}"),
            power,
            std::f64::consts::PI * 0.25 * sum,
            Within::Relative(5e-3),
        );
        let photons = photons(&built, count);
        case.mean(format!("power of photons, {how}"), photons, std::f64::consts::PI * 0.25 * sum, 2e-3);
        let mut rng = Rng::new(11, 0);
        for (x, z) in [(0.0, 0.0), (0.7, -0.4), (-1.5, 1.2)] {
            let p = DVec3::new(x, 0.0, z);
            let at = built.to_scene(p);
            let (mut light, mut met) = (Mean::default(), Mean::default());
            for _ in 0..count {
                let u = [rng.next_f32(), rng.next_f32(), rng.next_f32(), rng.next_f32()];
                if let Some(sample) = built.emitters().sample(at, u) {
                    light.add(f64::from(sample.radiance.r() * sample.wi.y.max(0.0) / sample.pdf));
                }
                // Directions by the cosine.
                let (r, phi) = (f64::from(u[1]).sqrt(), std::f64::consts::TAU * f64::from(u[2]));
                let wi = DVec3::new(r * phi.cos(), (1.0 - r * r).sqrt(), r * phi.sin()).as_vec3a();
                let ray = etendue::math::Ray::new(at + 1e-4 * Vec3::Y, wi);
                let Some(hit) = built.intersect(&ray) else { continue };
                let surface = built.interaction(&ray, &hit);
                let Some(emitter) = surface.emitter else { continue };
                let le = built.emitters().le(emitter, surface.ng, -wi, surface.point.p);
                met.add(std::f64::consts::PI * f64::from(le.r()));
            }
            let exact = exact(p, DVec3::Y);
            case.mean(format!("light samples at ({x}, {z}), {how}"), light.of(count), exact, 4e-3);
            case.mean(format!("rays from ({x}, {z}), {how}"), met.of(count), exact, 3e-2);
        }
    }
}

/// The power that photons take along from the emitters of a scene together, in red.
fn photons(scene: &Scene, count: u32) -> (f64, f64) {
    let mut rng = Rng::new(17, 0);
    let mut power = |emitter: &etendue::emitter::Emitter| {
        let mut mean = Mean::default();
        for _ in 0..count {
            mean.add(emitter.power_from(&emitter.sample_departure([rng.next_f32(), rng.next_f32()])).x);
        }
        mean.of(count)
    };
    scene.emitters().emitters().iter().fold((0.0, 0.0), |(sum, error), emitter| {
        let (own, own_error) = power(emitter);
        (sum + own, own_error.hypot(error))
    })
}

/// Methods that draw the floor below a lamp, and the relative standard error within which they do.
pub const METHODS: [(IntegratorDesc, f64); 7] = [
    (IntegratorDesc::Path, 4e-3),
    (IntegratorDesc::Direct, 4e-3),
    (IntegratorDesc::Whitted, 4e-3),
    (IntegratorDesc::Caustic, 4e-3),
    (IntegratorDesc::IrradianceCache, 5e-3),
    (IntegratorDesc::Photon, 1e-2),
    (IntegratorDesc::Sppm, 1e-2),
];

/// The lamp's image, and the floor below it by all methods that draw it.
fn pictures(case: &mut Case) {
    let samples = case.count(64, 4096) as u32;
    let mut seen = lamp(None);
    // From half way up, so that the lamp fills the picture.
    let angle = 2.0 * 2.0_f64.atan().to_degrees();
    seen.set_camera(camera(0.5 * DVec3::Y, DVec3::Y, angle)).expect("a camera of the test");
    let (image, _) = render(&seen, &Job { samples, ..Job::default() });
    let mean: f64 = (0..16).map(|i| 2.0 * radiance(i % 4, i / 4)).sum::<f64>() / 16.0;
    case.mean("the lamp itself", mean_and_error(&image), mean * (1.0 + 0.5 + 0.25) / 3.0, 4e-3);

    // The part of the floor that the camera sees; the floor goes on around it.
    const N: u32 = 128;
    let place = |i: u32| 0.9 * (2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0);
    let all = (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
    let sum: f64 = all.map(|(i, j)| exact(DVec3::new(place(i), 0.0, place(j)), DVec3::Y)).sum();
    let reflected = 0.5 / std::f64::consts::PI * sum / f64::from(N * N);
    let floor = lamp(None);
    for (integrator, within) in METHODS {
        let (image, _) = render(&floor, &Job { samples, integrator, ..Job::default() });
        let name = format!("the floor by {integrator:?}");
        case.mean(&name, mean_and_error(&image), reflected * (1.0 + 0.5 + 0.25) / 3.0, within);
    }
    // Elements interpolate the light between their corners.
    let (image, _) = render(&floor, &Job { samples, integrator: IntegratorDesc::Radiosity, ..Job::default() });
    let exact = reflected * (1.0 + 0.5 + 0.25) / 3.0;
    case.biased_mean("the floor by Radiosity", mean_and_error(&image), exact, (5e-3, 4e-3));
}

/// One texel of 1024 x 1024, and lines of a thousandth of the width: light samples find what no grid of points would.
fn spots(case: &mut Case) {
    let count = case.count(1_000_000, 10_000_000) as u32;
    let texel = image(1024, 1024, 1, |x, y, _| if (x, y) == (601, 350) { 1e6 } else { 0.0 });
    let texel = described("texel", &texel, ColorSpace::Linear, TextureFilter::Nearest, 1.0);
    let lines = Procedural { pattern: Pattern::Grid { width: 1e-3 }, colors: [Rgb::ZERO, Rgb::ONE], in_space: false };
    let lines = TextureDesc {
        name: "lines".to_owned(),
        path: String::new(),
        source: TextureSource::Procedural(lines),
        mapping: TextureMapping::Uv { set: 0, scale: [4.0; 2], rotation: 0.0, offset: [0.0; 2] },
        vertex_colors: false,
    };
    let p = DVec3::new(0.3, 0.0, -0.2);
    // The texel is a rectangle whose rows are counted from the top; lines cover 2 w - w^2 of the lamp, all over it.
    let place = |i: u32| 2.0 * f64::from(i) / 1024.0 - 1.0;
    let rectangle = |[x0, x1]: [f64; 2], [z0, z1]: [f64; 2]| {
        let corners = [[x0, z0], [x1, z0], [x1, z1], [x0, z1]].map(|[x, z]| DVec3::new(x, 1.0, z));
        std::f64::consts::PI * polygon_factor(p, DVec3::Y, &corners)
    };
    let of_texel = 2e6 * rectangle([place(601), place(602)], [place(1023 - 350), place(1024 - 350)]);
    let half = 0.5 * 1e-3 * 0.5;
    let bars = |edges: [f64; 2]| {
        let at = |k: i32| -1.0 + 0.5 * f64::from(k);
        (0..=4).map(move |k| [(at(k) - half).max(edges[0]), (at(k) + half).min(edges[1])])
    };
    let all = [-1.0, 1.0];
    let across: f64 = bars(all).map(|bar| rectangle(bar, all) + rectangle(all, bar)).sum();
    let twice: f64 = bars(all).flat_map(|x| bars(all).map(move |z| (x, z))).map(|(x, z)| rectangle(x, z)).sum();
    let of_lines = 2.0 * (across - twice);
    for (name, texture, exact, within) in [("a texel", texel, of_texel, 0.1), ("lines", lines, of_lines, 0.1)] {
        let mut desc = lamp(None);
        desc.materials[0].textures.clear();
        vary(&mut desc, 0, TextureKey::Emission, texture);
        let built = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let at = built.to_scene(p);
        let (mut rng, mut sum, mut squares) = (Rng::new(17, 0), 0.0, 0.0);
        for _ in 0..count {
            let u = [rng.next_f32(), rng.next_f32(), rng.next_f32(), rng.next_f32()];
            let Some(sample) = built.emitters().sample(at, u) else { continue };
            let value = f64::from(sample.radiance.r() * sample.wi.y.max(0.0) / sample.pdf);
            (sum, squares) = (sum + value, squares + value * value);
        }
        let n = f64::from(count);
        let estimate = (sum / n, ((squares / n - (sum / n).powi(2)) / n).sqrt());
        case.mean(format!("light samples of {name}"), estimate, exact, within);
    }
}
