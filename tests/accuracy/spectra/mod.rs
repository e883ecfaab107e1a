//! Paths that carry wavelengths: colours as spectra, and light that is dispersed.

mod bands;
mod films;
mod own;
mod varied;

use crate::common::scenes::{Job, box_inside, camera, render_scene, scene};
use crate::record::{Case, Entry, Within};
use crate::transport::{MESH, ball, glass, grey, parallelogram, pick, plane};
use etendue::desc::{
    BsdfDesc, Dispersion, GLASSES, IntegratorDesc, MediumDesc, MicrofacetsDesc, PhotonDesc, RenderDesc, SceneDesc,
    ShapeDesc,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::{
    Illuminant, REC_709_FROM_XYZ, Rgb, SmoothSpectrum, VISIBLE, color_matching, rec_709, tristimulus,
};
use std::sync::LazyLock;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "W1", title: "furnace under D65, all methods", run: furnace },
        Entry { id: "W2", title: "colours of reflectances and lights", run: colours },
        Entry { id: "W3", title: "light between coloured walls by quadrature over wavelengths", run: between_walls },
        Entry { id: "W4", title: "round trip of ten thousand colours", run: round_trip },
        Entry { id: "W5", title: "dispersion against single wavelengths", run: prism },
        Entry { id: "W6", title: "dispersing glass in a furnace", run: glass_furnace },
        Entry { id: "W7", title: "dispersed photons against single wavelengths", run: photons },
        Entry { id: "W8", title: "indices and angles of rainbows", run: rainbow },
        Entry { id: "W9", title: "absorption over parts of a way", run: absorption },
        Entry {
            id: "W10",
            title: "films of soap and on glass by quadrature over wavelengths",
            run: films::dielectrics,
        },
        Entry { id: "W11", title: "films on metals by quadrature over wavelengths", run: films::metals },
        Entry {
            id: "W12",
            title: "spectra of lights and walls by quadrature over wavelengths",
            run: own::between_walls,
        },
        Entry { id: "W13", title: "lamps of all kinds with a spectrum", run: own::lamps },
        Entry { id: "W14", title: "models with spectra against single wavelengths", run: own::models },
        Entry { id: "W15", title: "absorption by a spectrum", run: own::absorption },
        Entry { id: "W16", title: "means over bands of wavelengths", run: bands::means },
        Entry { id: "W17", title: "temperatures and films that textures vary", run: varied::all },
    ]
}

/// Methods whose paths carry wavelengths.
const METHODS: [IntegratorDesc; 6] = [
    IntegratorDesc::Path,
    IntegratorDesc::Whitted,
    IntegratorDesc::Direct,
    IntegratorDesc::Caustic,
    IntegratorDesc::Ppm,
    IntegratorDesc::Sppm,
];

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// A picture of a scene by paths that carry wavelengths.
fn spectral(scene: &Scene, job: &Job) -> Image {
    render_scene(scene, RenderDesc { spectral: true, ..job.desc() }).0
}

/// Mean of each channel and its standard error; pixels are independent.
fn channels(image: &Image) -> [(f64, f64); 3] {
    let variance = &image.layer("variance").expect("always there").data;
    let pixels = image.rgb.len() as f64 / 3.0;
    std::array::from_fn(|channel| {
        let sum: f64 = variance.iter().skip(channel).step_by(3).map(|v| f64::from(*v)).sum();
        (image.mean()[channel], sum.sqrt() / pixels)
    })
}

/// The spectrum of D65 of luminance 1, of which lights of the colour (1, 1, 1) are.
fn white(nanometres: f64) -> f64 {
    static LUMINANCE: LazyLock<f64> = LazyLock::new(|| tristimulus(|nanometres| Illuminant::D65.power(nanometres)).y);
    Illuminant::D65.power(nanometres) / *LUMINANCE
}

/// A closed room that glows and reflects, seen from inside.
fn room(albedo: BsdfDesc, emission: Rgb) -> SceneDesc {
    let view = camera(DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.0, 0.4, -0.7), 60.0);
    let mut desc = scene(view, vec![(MESH, albedo, Some(emission))]);
    desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::ONE).into());
    desc
}

fn furnace(case: &mut Case) {
    let scene = build(&room(grey(0.5), Rgb::splat(0.5)));
    for integrator in METHODS {
        // Photons and paths of a pass share wavelengths, which are spread evenly over passes: the error falls with their number.
        let is_in_passes =
            !matches!(integrator, IntegratorDesc::Path | IntegratorDesc::Whitted | IntegratorDesc::Direct);
        let samples = case.count(if is_in_passes { 1024 } else { 128 }, if is_in_passes { 8192 } else { 1024 }) as u32;
        let job =
            Job { resolution: if is_in_passes { [4, 4] } else { [16, 16] }, samples, integrator, ..Job::default() };
        let bias = if is_in_passes { pick(case, 4e-3, 1e-3) } else { 1e-3 };
        // Direct light and Whitted's method have one reflection.
        let exact =
            if integrator == IntegratorDesc::Whitted || integrator == IntegratorDesc::Direct { 0.75 } else { 1.0 };
        let photons = PhotonDesc { count: Some(1000), ..PhotonDesc::default() };
        let image = render_scene(&scene, RenderDesc { spectral: true, photons, ..job.desc() }).0;
        for (channel, found) in channels(&image).into_iter().enumerate() {
            let what = format!("{}, channel {channel}", integrator.name());
            case.biased_mean(what, found, exact, (bias, pick(case, 4e-3, 1e-3)));
        }
    }
}

/// Colours of surfaces: saturated, dark, nearly grey.
const COLOURS: [[f32; 3]; 5] =
    [[0.7, 0.2, 0.1], [0.05, 0.3, 0.4], [0.2, 0.25, 0.02], [0.6, 0.5, 0.55], [0.02, 0.01, 0.03]];

fn colours(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    let job = Job { resolution: [16, 16], samples, integrator: IntegratorDesc::Direct, ..Job::default() };
    for color in COLOURS.map(Rgb::from_array) {
        // A patch before the camera in a room that glows evenly.
        let patch = parallelogram(DVec3::new(-2.0, -2.0, -0.5), DVec3::X * 4.0, DVec3::Y * 4.0);
        let view = camera(DVec3::ZERO, DVec3::new(0.1, 0.2, -1.0), 30.0);
        let surfaces =
            vec![(patch, BsdfDesc::Lambert { albedo: color }, None), (MESH, BsdfDesc::Black, Some(Rgb::ONE))];
        let mut lit = scene(view, surfaces);
        lit.meshes.push(box_inside(DVec3::splat(-5.0), DVec3::splat(5.0)).into());
        let lit = build(&lit);
        let glows = build(&room(BsdfDesc::Black, color * 3.0));
        let reflected = channels(&spectral(&lit, &job));
        let emitted = channels(&spectral(&glows, &job)).map(|(mean, error)| (mean / 3.0, error / 3.0));
        let most = f64::from(color.max_element());
        for (what, found) in [("reflected", reflected), ("emitted", emitted)] {
            for (channel, (mean, error)) in found.into_iter().enumerate() {
                // Relative to the largest channel, so that dark channels of a saturated colour are judged as the eye does.
                let off = (mean - f64::from(color.to_array()[channel])) / most;
                let what = format!("{what}, {:?}, channel {channel}: difference over the largest", color.to_array());
                case.biased_mean(what, (1.0 + off, error / most), 1.0, (4e-3, pick(case, 8e-3, 2e-3)));
            }
        }
    }
}

/// In a closed room of albedo rho that glows evenly, the radiance is E / (1 - rho) at each wavelength.
fn between_walls(case: &mut Case) {
    let samples = case.count(256, 4096) as u32;
    for color in COLOURS.map(Rgb::from_array) {
        let glow = Rgb::new(0.9, 1.0, 0.5);
        let scene = build(&room(BsdfDesc::Lambert { albedo: color }, glow));
        let job = Job { resolution: [16, 16], samples, ..Job::default() };
        let albedo = SmoothSpectrum::of_color(color);
        // A light has the smooth spectrum of its colour over twice its largest channel.
        let shape = SmoothSpectrum::of_color(glow * 0.5);
        let radiance = |nanometres: f64| {
            let emitted = 2.0 * f64::from(shape.at(nanometres as f32)) * white(nanometres);
            emitted / (1.0 - f64::from(albedo.at(nanometres as f32)))
        };
        // 81 wavelengths by 5 nm, as the CIE sums; what is left out at both ends is below 1e-5.
        let sum = (0..=80).map(|i| {
            let nanometres = 380.0 + 5.0 * f64::from(i);
            *REC_709_FROM_XYZ * color_matching(nanometres) * radiance(nanometres) * 5.0
        });
        let exact = sum.sum::<DVec3>().to_array();
        let most = exact.into_iter().fold(0.0, f64::max);
        for (channel, (mean, error)) in channels(&spectral(&scene, &job)).into_iter().enumerate() {
            let what = format!("{:?}, channel {channel}: difference over the largest", color.to_array());
            let off = (mean - exact[channel]) / most;
            case.biased_mean(what, (1.0 + off, error / most), 1.0, (3e-4, pick(case, 6e-3, 1.5e-3)));
        }
    }
}

fn round_trip(case: &mut Case) {
    let colour = |number: u32| {
        let uniform = |axis: u32| {
            // A lattice of irrational steps: well spread, and the same everywhere.
            let step = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2][axis as usize];
            (0.5 + f64::from(number) * step).fract()
        };
        DVec3::new(uniform(0), uniform(1), uniform(2))
    };
    for (what, scale, limits) in [("bright", 1.0, [9e-3, 1.2e-3]), ("dark", 0.1, [2e-2, 2.5e-3])] {
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        const COLOURS: u32 = 10_000;
        for number in 0..COLOURS {
            let color = colour(number) * scale;
            let smooth = SmoothSpectrum::of_color(Rgb::from_f64(color));
            let back = rec_709(|nanometres| f64::from(smooth.at(nanometres as f32)) * white(nanometres));
            let error = (back - color).abs().max_element() / scale;
            worst = worst.max(error);
            sum += error * error;
        }
        case.at_most(format!("{what}: largest error over the brightest"), worst, limits[0]);
        case.at_most(format!("{what}: root mean square"), (sum / f64::from(COLOURS)).sqrt(), limits[1]);
    }
    let greys = [0.0_f32, 1e-4, 0.18, 0.5, 0.99];
    for grey in greys {
        let smooth = SmoothSpectrum::of_color(Rgb::splat(grey));
        let span = [400.0, 500.0, 600.0, 700.0].map(|nanometres| smooth.at(nanometres));
        let spread = span.into_iter().fold(f32::MIN, f32::max) - span.into_iter().fold(f32::MAX, f32::min);
        case.at_most(format!("grey {grey}: spread of its spectrum"), f64::from(spread), 1e-5);
    }
}

/// Light of a bright lamp that reaches the camera through a wedge of glass, which bends each wavelength by another angle: the lamp
/// hangs in a dark room, the wedge is before the camera.
fn wedge(bsdf: BsdfDesc, dispersion: Option<Dispersion>) -> SceneDesc {
    let view = camera(DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.35, 0.0, 0.0), 30.0);
    let lamp = parallelogram(DVec3::new(1.2, -1.0, -4.0), DVec3::X * 0.8, DVec3::Y * 2.0);
    let surfaces =
        vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, bsdf, None), (lamp, BsdfDesc::Black, Some(Rgb::ONE))];
    let mut desc = scene(view, surfaces);
    // A prism whose edge is upright, with its base to the right.
    let corners = [[-0.8, 0.0], [0.8, 0.45], [0.8, -0.45]];
    let at = |y: f64| corners.map(|[x, z]| DVec3::new(x, y, z));
    let positions = [at(-1.5), at(1.5)].concat();
    let triangles = vec![[0, 1, 2], [3, 5, 4], [0, 4, 1], [0, 3, 4], [1, 5, 2], [1, 4, 5], [2, 3, 0], [2, 5, 3]];
    let mesh = crate::transport::mesh(positions, triangles);
    desc.meshes.push(std::sync::Arc::new(crate::transport::turned(mesh, DVec3::new(0.3, 0.0, 0.0), false)));
    desc.materials[0].dispersion = dispersion;
    desc
}

/// The picture of a grey scene at single wavelengths, weighted as a sensor does: the method that needs no wavelengths in paths.
/// `with_index` makes the scene for an index of refraction.
fn by_single_wavelengths(
    with_index: impl Fn(f32) -> SceneDesc,
    index: impl Fn(f64) -> f64,
    job: &Job,
) -> [(f64, f64); 3] {
    const STEP: f64 = 10.0;
    let count = ((VISIBLE[1] - VISIBLE[0]) / STEP) as u32;
    let (mut mean, mut variance) = (DVec3::ZERO, DVec3::ZERO);
    for i in 0..count {
        let nanometres = VISIBLE[0] + STEP * (f64::from(i) + 0.5);
        // What the sensor sees of the interval around the wavelength.
        let within = (0..10).map(|part| nanometres - STEP / 2.0 + f64::from(part) + 0.5);
        let weight: DVec3 = within.map(|at| *REC_709_FROM_XYZ * color_matching(at) * white(at)).sum();
        let scene = build(&with_index(index(nanometres) as f32));
        let job = Job { seed: 100 + u64::from(i), resolution: job.resolution, ..*job };
        let [(grey, error), ..] = channels(&render_scene(&scene, job.desc()).0);
        mean += weight * grey;
        variance += (weight * error) * (weight * error);
    }
    std::array::from_fn(|channel| (mean[channel], variance[channel].sqrt()))
}

fn rough(ior: f32) -> BsdfDesc {
    let microfacets = MicrofacetsDesc { roughness: 0.3, ..MicrofacetsDesc::default() };
    BsdfDesc::RoughDielectric { ior, exterior_ior: 1.0, microfacets }
}

fn prism(case: &mut Case) {
    // A glass that disperses more than any, so that colours are far apart.
    let (ior, dispersion) = (1.6, Dispersion::Abbe(8.0));
    let index = |nanometres: f64| dispersion.index(f64::from(ior), nanometres);
    for what in ["smooth", "rough"] {
        let model = |ior| if what == "smooth" { glass(ior, 1.0) } else { rough(ior) };
        let dispersing = build(&wedge(model(ior), Some(dispersion)));
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
            if what == "rough" && integrator == IntegratorDesc::Whitted {
                continue;
            }
            let samples = case.count(1024, 8192) as u32;
            let job = Job { resolution: [16, 16], samples, integrator, ..Job::default() };
            let found = channels(&spectral(&dispersing, &job));
            let single = Job { samples: samples / 8, ..Job { ..job } };
            let expected = by_single_wavelengths(|ior| wedge(model(ior), None), index, &single);
            // The same scene with the index of the line d is another picture, which the comparison can tell.
            let plain = channels(&render_scene(&build(&wedge(model(ior), None)), job.desc()).0);
            let most = expected.iter().map(|channel| channel.0).fold(0.0, f64::max);
            for channel in 0..3 {
                let what = format!("{what}, {}, channel {channel}: difference over the largest", integrator.name());
                let (a, b) = (found[channel], expected[channel]);
                let error = a.1.hypot(b.1) / most;
                case.biased_mean(what, (1.0 + (a.0 - b.0) / most, error), 1.0, (2e-3, pick(case, 1.5e-2, 5e-3)));
            }
            let apart = (plain[0].0 - expected[0].0).abs() / most;
            let colour = (expected[0].0 - expected[2].0).abs() / most;
            let seen = apart.max(colour);
            case.holds(
                format!("{what}, {}: the picture has colours", integrator.name()),
                "> 0.02",
                format!("{seen:.3}"),
                seen > 0.02,
            );
        }
    }
}

/// Nothing is lost or gained: glass in an even light is not seen, whatever it disperses.
fn glass_furnace(case: &mut Case) {
    for (what, bsdf) in [("smooth", glass(1.6, 1.0)), ("rough", rough(1.6))] {
        let view = camera(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 25.0);
        let mut desc = scene(view, vec![(ball(DVec3::ZERO, 1.0), bsdf, None), (MESH, BsdfDesc::Black, Some(Rgb::ONE))]);
        desc.meshes.push(box_inside(DVec3::splat(-9.0), DVec3::splat(9.0)).into());
        desc.materials[0].dispersion = Some(Dispersion::Abbe(8.0));
        let scene = build(&desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Sppm] {
            if what == "rough" && integrator == IntegratorDesc::Whitted {
                continue;
            }
            let samples = case.count(512, 8192) as u32;
            let job = Job { resolution: [16, 16], samples, integrator, ..Job::default() };
            for (channel, found) in channels(&spectral(&scene, &job)).into_iter().enumerate() {
                let what = format!("{what}, {}, channel {channel}", integrator.name());
                case.biased_mean(what, found, 1.0, (1e-3, pick(case, 8e-3, 2e-3)));
            }
        }
    }
}

/// A floor under a ball of glass and a lamp: what photons bring against paths at single wavelengths.
fn photons(case: &mut Case) {
    let (ior, dispersion) = (1.6, Dispersion::Abbe(8.0));
    let index = |nanometres: f64| dispersion.index(f64::from(ior), nanometres);
    let make = |ior: f32, dispersion: Option<Dispersion>| {
        let view = camera(DVec3::new(0.0, 0.9, 1.2), DVec3::new(0.0, -1.0, 0.0), 40.0);
        let floor = parallelogram(DVec3::new(-3.0, -1.0, 3.0), DVec3::X * 6.0, DVec3::Z * -6.0);
        let lamp = parallelogram(DVec3::new(-0.5, 3.0, -0.5), DVec3::X * 1.0, DVec3::Z * 1.0);
        let mut desc = scene(
            view,
            vec![
                (ball(DVec3::new(0.0, -0.2, 0.0), 0.5), glass(ior, 1.0), None),
                (floor, grey(0.7), None),
                (lamp, BsdfDesc::Black, Some(Rgb::splat(10.0))),
            ],
        );
        desc.materials[0].dispersion = dispersion;
        desc
    };
    let scene = build(&make(ior, Some(dispersion)));
    let samples = case.count(64, 256) as u32;
    let single = Job { resolution: [16, 16], samples: samples * 4, ..Job::default() };
    let expected = by_single_wavelengths(|ior| make(ior, None), index, &single);
    let most = expected.iter().map(|channel| channel.0).fold(0.0, f64::max);
    let count = Some(case.count(30_000, 60_000) as u32);
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Caustic, IntegratorDesc::Sppm] {
        let samples = if integrator == IntegratorDesc::Path { samples * 32 } else { samples };
        // Passes share wavelengths: their spread is found from runs of different seeds.
        let runs = case.count(5, 8) as usize;
        let mut means = vec![[0.0; 3]; runs];
        for (run, mean) in means.iter_mut().enumerate() {
            let seed = 7 + run as u64;
            let job = Job { resolution: [16, 16], samples, integrator, seed, ..Job::default() };
            let photons = PhotonDesc { count, caustic_count: count, ..PhotonDesc::default() };
            let image = render_scene(&scene, RenderDesc { spectral: true, photons, ..job.desc() }).0;
            *mean = channels(&image).map(|(mean, _)| mean);
        }
        for channel in 0..3 {
            let of: Vec<f64> = means.iter().map(|mean| mean[channel]).collect();
            let (mean, error) = crate::stats::mean_and_error(&of);
            let error = error.hypot(expected[channel].1) / most;
            let off = 1.0 + (mean - expected[channel].0) / most;
            let what = format!("{}, channel {channel}: difference over the largest", integrator.name());
            case.biased_mean(what, (off, error), 1.0, (5e-3, pick(case, 2e-2, 8e-3)));
        }
    }
}

/// A lamp behind an absorbing body that does not refract, whole and in four parts.
fn absorption(case: &mut Case) {
    let coefficient = Rgb::new(0.1, 1.2, 2.5);
    let most = coefficient.max_element();
    let shape = SmoothSpectrum::of_color(coefficient * (1.0 / most));
    let exact = rec_709(|nanometres| (-f64::from(most * shape.at(nanometres as f32))).exp() * white(nanometres));
    for parts in [1, 4] {
        let view = camera(DVec3::new(0.0, 0.0, -2.0), DVec3::ZERO, 1.0);
        let ends = (0..parts).flat_map(|part| {
            let thick = 1.0 / f64::from(parts);
            let near = f64::from(part) * (thick + 1e-3);
            [(near, DVec3::NEG_Z), (near + thick, DVec3::Z)]
        });
        let faces = ends.map(|(z, normal)| (plane(DVec3::Z * z, normal, 20.0), glass(1.0, 1.0), None));
        let lamp = (plane(DVec3::Z * 5.0, DVec3::NEG_Z, 100.0), BsdfDesc::Black, Some(Rgb::ONE));
        let mut desc = scene(view, faces.chain([lamp]).collect());
        for material in 0..2 * parts as usize {
            desc.set_medium(material, Some(MediumDesc { absorption: coefficient, priority: 0 })).expect("a medium");
        }
        let scene = build(&desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
            let job = Job { resolution: [16, 16], samples: case.count(256, 2048) as u32, integrator, ..Job::default() };
            for (channel, (mean, error)) in channels(&spectral(&scene, &job)).into_iter().enumerate() {
                let off = 1.0 + (mean - exact[channel]) / exact.x;
                let what = format!("{parts} parts, {}, channel {channel}: difference over red", integrator.name());
                case.biased_mean(what, (off, error / exact.x), 1.0, (1e-3, pick(case, 6e-3, 1.5e-3)));
            }
        }
    }
}

/// The angle between a ray of the sun and the primary rainbow, by the index of water: that of least deviation after one reflection
/// inside of a drop (Descartes 1637).
fn rainbow(case: &mut Case) {
    let water =
        GLASSES.iter().find(|glass| glass.name == "water").map(|glass| glass.dispersion).expect("water is known");
    let angle = |n: f64| {
        let cos2 = (n * n - 1.0) / 3.0;
        let incident = cos2.sqrt().acos();
        let refracted = (incident.sin() / n).asin();
        (4.0 * refracted - 2.0 * incident).to_degrees()
    };
    case.exact("n 1.333: deviation, degrees", 180.0 - angle(1.333), 137.921_892_620, Within::Absolute(1e-8));
    let index = |nanometres: f64| water.index(1.333, nanometres);
    let (red, violet) = (angle(index(656.272)), angle(index(404.770)));
    // Minnaert 1937: 42.3 degrees for red and 40.6 for violet light.
    case.exact("arc of 656.3 nm, degrees", red, 42.3, Within::Absolute(0.1));
    case.exact("arc of 404.8 nm, degrees", violet, 40.6, Within::Absolute(0.1));
    case.holds("red arc outside of the violet one", "red > violet", format!("{red:.2}°, {violet:.2}°"), red > violet);
}
