//! A liquid in a glass: bodies that overlap, against the interfaces between their media.

use super::rough::frosted;
use super::*;
use etendue::desc::{PhotonDesc, ShapeDesc, SurfaceLook};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "A7", title: "straight through a liquid in a glass", run: straight },
        Entry { id: "A8", title: "overlap and interfaces", run: interfaces },
        Entry { id: "A9", title: "coloured liquid, by all methods", run: methods },
        Entry { id: "A11", title: "overlap and interfaces, rough", run: rough_interfaces },
        Entry { id: "A12", title: "coloured liquid in rough glass, by all methods", run: rough_methods },
    ]
}

const GLASS: f32 = 1.5;
const WATER: f32 = 1.33;

/// A scene whose surfaces are quads.
struct Quads {
    desc: SceneDesc,
}

impl Quads {
    fn material(&mut self, name: &str, bsdf: BsdfDesc) -> usize {
        self.desc.add_material(name, bsdf, None).expect("a material of the test")
    }

    fn quad(&mut self, corners: [DVec3; 4], towards: DVec3, material: usize, emission: Option<Rgb>) {
        let [a, b, c, d] = corners;
        let corners = if (b - a).cross(c - a).dot(towards) > 0.0 { corners } else { [a, d, c, b] };
        let (shape, local) = ShapeDesc::quad(corners).expect("a quad of the test");
        let look = SurfaceLook { material: Some(material), emission, ..SurfaceLook::default() };
        self.desc.add_surface(shape, local, look).expect("a surface of the test");
    }

    /// The four walls of an upright square tube about the axis, with normals outwards (1) or inwards (-1).
    fn walls(&mut self, half: f64, [low, high]: [f64; 2], out: f64, material: usize) {
        for (x, z) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            let (normal, along) = (DVec3::new(x, 0.0, z), DVec3::new(-z, 0.0, x));
            let corner = |s: f64, y: f64| half * (normal + s * along) + DVec3::Y * y;
            let corners = [corner(-1.0, low), corner(1.0, low), corner(1.0, high), corner(-1.0, high)];
            self.quad(corners, out * normal, material, None);
        }
    }

    /// A level square about the axis, with its normal upwards (1) or downwards (-1).
    fn level(&mut self, half: f64, y: f64, up: f64, material: usize, emission: Option<Rgb>) {
        let corner = |x: f64, z: f64| DVec3::new(half * x, y, half * z);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        self.quad(corners, up * DVec3::Y, material, emission);
    }

    /// The level ring between two squares, with its normal upwards.
    fn rim(&mut self, inner: f64, outer: f64, y: f64, material: usize) {
        for (x, z) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            let (normal, along) = (DVec3::new(x, 0.0, z), DVec3::new(-z, 0.0, x));
            let corner = |half: f64, s: f64| half * (normal + s * along) + DVec3::Y * y;
            let corners = [corner(inner, -1.0), corner(outer, -1.0), corner(outer, 1.0), corner(inner, 1.0)];
            self.quad(corners, DVec3::Y, material, None);
        }
    }
}

/// Half widths of the glass, of its inside and of the liquid that reaches into the glass.
const OUTER: f64 = 0.5;
const INNER: f64 = 0.4;
const OVERLAP: f64 = 0.45;
/// Heights of the bottom of the inside, of the liquid's top and of the rim.
const BOTTOM: f64 = 0.1;
const TOP: f64 = 0.55;
const RIM: f64 = 0.8;

/// A glass with a liquid, as two bodies that overlap, or as the interfaces between three media.
fn tumbler(quads: &mut Quads, overlaps: bool, absorption: [Rgb; 2], roughness: f32) {
    let glass = |ior, exterior_ior| frosted(ior, exterior_ior, roughness);
    let glass_in_air = quads.material("glass in air", glass(GLASS, 1.0));
    quads.walls(OUTER, [0.0, RIM], 1.0, glass_in_air);
    quads.level(OUTER, 0.0, -1.0, glass_in_air, None);
    quads.rim(INNER, OUTER, RIM, glass_in_air);
    if overlaps {
        let water = quads.material("water", glass(WATER, 1.0));
        quads.walls(INNER, [BOTTOM, RIM], -1.0, glass_in_air);
        quads.level(INNER, BOTTOM, 1.0, glass_in_air, None);
        quads.walls(OVERLAP, [0.5 * BOTTOM, TOP], 1.0, water);
        quads.level(OVERLAP, 0.5 * BOTTOM, -1.0, water, None);
        quads.level(OVERLAP, TOP, 1.0, water, None);
        fill(&mut quads.desc, [glass_in_air], absorption[0], 7);
        fill(&mut quads.desc, [water], absorption[1], 3);
    } else {
        let glass_in_water = quads.material("glass in water", glass(GLASS, WATER));
        let water_in_air = quads.material("water in air", glass(WATER, 1.0));
        quads.walls(INNER, [TOP, RIM], -1.0, glass_in_air);
        quads.walls(INNER, [BOTTOM, TOP], -1.0, glass_in_water);
        quads.level(INNER, BOTTOM, 1.0, glass_in_water, None);
        quads.level(INNER, TOP, 1.0, water_in_air, None);
    }
}

/// A tumbler in a room with a lamp.
fn room(overlaps: bool, absorption: [Rgb; 2], roughness: f32) -> SceneDesc {
    let view = camera(DVec3::new(0.35, 0.9, 1.3), DVec3::new(0.0, 0.35, 0.0), 60.0);
    let mut quads = Quads { desc: SceneDesc { camera: view, ..SceneDesc::default() } };
    let wall = quads.material("wall", grey(0.6));
    quads.walls(1.5, [-0.2, 2.3], -1.0, wall);
    quads.level(1.5, -0.2, 1.0, wall, None);
    quads.level(1.5, 2.3, -1.0, wall, None);
    quads.level(1.4, 2.2, -1.0, wall, Some(Rgb::splat(3.0)));
    tumbler(&mut quads, overlaps, absorption, roughness);
    quads.desc
}

/// Reflectance and transmittance of layers seen straight on, with all reflections between them: the indices of the media, and
/// what one way through each inner one leaves.
fn layers(indices: &[f64], left: &[f64]) -> f64 {
    // From the far side on: what is reflected by all that lies behind, and what comes through.
    let (mut reflected, mut transmitted) = (0.0, 1.0);
    for i in (0..indices.len() - 1).rev() {
        let r = ((indices[i] - indices[i + 1]) / (indices[i] + indices[i + 1])).powi(2);
        let a = if i < left.len() { left[i] } else { 1.0 };
        let behind = reflected * a * a;
        let between = 1.0 / (1.0 - r * behind);
        (reflected, transmitted) =
            (r + (1.0 - r) * (1.0 - r) * behind * between, (1.0 - r) * between * a * transmitted);
    }
    transmitted
}

fn straight(case: &mut Case) {
    let tints = [Rgb::new(0.5, 1.0, 3.0), Rgb::new(2.0, 0.3, 1.0)];
    let mut quads = Quads { desc: SceneDesc::default() };
    tumbler(&mut quads, true, tints, 0.0);
    let black = quads.material("black", BsdfDesc::Black);
    let corner = |x: f64, y: f64| DVec3::new(9.0 * x, 9.0 * y, -3.0);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    quads.quad(corners, DVec3::Z, black, Some(Rgb::ONE));
    let eyes = [
        ("from outside", 1.0, 1.0),
        ("from within the glass", 0.5 * (OUTER + OVERLAP), 2.25),
        ("from within the overlap", 0.5 * (OVERLAP + INNER), 2.25),
        ("from within the liquid", 0.1, f64::from(WATER).powi(2)),
    ];
    for (what, z, scale) in eyes {
        let eye = DVec3::new(0.01, 0.3, z);
        let mut desc = quads.desc.clone();
        desc.camera = camera(eye, eye + DVec3::NEG_Z, 1e-3);
        let scene = build(&desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
            let image = image(&scene, integrator, case.count(256, 8192), 1);
            for i in 0..3 {
                let [glass, water] = tints.map(|tint| tint.to_f64().to_array()[i]);
                let (g, w) = (f64::from(GLASS), f64::from(WATER));
                // A wall, the liquid and the other wall.
                let wall = (-glass * (OUTER - INNER)).exp();
                let liquid = (-water * 2.0 * INNER).exp();
                let indices = [1.0, g, w, g, 1.0];
                let all = layers(&indices, &[wall, liquid, wall]);
                let exact = if z > OUTER { all } else { from_within(z, [g, w], [glass, water]) };
                let name = format!("{what}, {}, channel {i}", integrator.name());
                case.biased_mean(name, channel(&image, i), scale * exact, (OFFSET, pick(case, 4e-3, 1e-3)));
            }
        }
    }
}

/// The share of the light beyond the far wall that comes, straight on, to an eye within the glass or the liquid, but for the
/// square of the index: by following all reflections of a ray.
fn from_within(z: f64, [g, w]: [f64; 2], [glass, water]: [f64; 2]) -> f64 {
    // Faces from the eye's side to the lamp's, and the media between them.
    let faces = [OUTER, INNER, -INNER, -OUTER];
    let indices = [1.0, g, w, g, 1.0];
    let coefficients = [0.0, glass, water, glass, 0.0];
    let at = |z: f64| faces.iter().take_while(|face| **face > z).count();
    // Radiance in each medium in both directions, at the end of its way: iterated to the solution.
    let cell = at(z);
    let r = |i: usize| ((indices[i] - indices[i + 1]) / (indices[i] + indices[i + 1])).powi(2);
    // `down[i]` travels to smaller z in medium i, just after it entered; `up[i]` likewise to larger z. Importance from the eye.
    let (mut down, mut up) = ([0.0; 5], [0.0; 5]);
    let lengths = [0.0, OUTER - INNER, 2.0 * INNER, OUTER - INNER, 0.0];
    let first = (-coefficients[cell] * (z - faces[cell])).exp();
    let mut found = 0.0;
    // The first arrival, at the face below the eye.
    down[cell + 1] += first * (1.0 - r(cell));
    up[cell] += first * r(cell);
    for _ in 0..200 {
        let (mut next_down, mut next_up) = ([0.0; 5], [0.0; 5]);
        found += down[4];
        for i in 1..4 {
            let a = (-coefficients[i] * lengths[i]).exp();
            next_down[i + 1] += down[i] * a * (1.0 - r(i));
            next_up[i] += down[i] * a * r(i);
            next_up[i - 1] += up[i] * a * (1.0 - r(i - 1));
            next_down[i] += up[i] * a * r(i - 1);
        }
        (down, up) = (next_down, next_up);
    }
    found
}

/// The channels of the whole picture and of its middle, where the liquid is, for each of several seeds.
fn means(scene: &Scene, integrator: IntegratorDesc, [samples, photons, runs]: [u64; 3]) -> Vec<[f64; 6]> {
    (1..=runs)
        .map(|seed| {
            let photons = PhotonDesc {
                count: Some(photons as u32),
                caustic_count: Some(photons as u32),
                radius: Some(0.08),
                caustic_radius: Some(0.04),
                ..PhotonDesc::default()
            };
            let desc = RenderDesc {
                resolution: [16, 16],
                samples: samples as u32,
                integrator,
                seed,
                photons,
                ..RenderDesc::default()
            };
            let image = render_scene(scene, desc).0;
            let middle = |i: usize| {
                let pixels = (5..11).flat_map(|y| (5..11).map(move |x| 3 * (16 * y + x) + i));
                pixels.map(|at| f64::from(image.rgb[at])).sum::<f64>() / 36.0
            };
            let whole = image.mean();
            [whole[0], whole[1], whole[2], middle(0), middle(1), middle(2)]
        })
        .collect()
}

fn mean_of(values: &[[f64; 6]]) -> [(f64, f64); 6] {
    std::array::from_fn(|i| stats::mean_and_error(&values.iter().map(|value| value[i]).collect::<Vec<_>>()))
}

fn interfaces(case: &mut Case) {
    compare_interfaces(case, &[IntegratorDesc::Whitted], 0.0);
}

/// Rough boundaries, whose Bsdf between two media is made when a path first meets it.
fn rough_interfaces(case: &mut Case) {
    compare_interfaces(case, &[], 0.4);
}

fn compare_interfaces(case: &mut Case, more: &[IntegratorDesc], roughness: f32) {
    let [overlap, exact] = [true, false].map(|overlaps| build(&room(overlaps, [Rgb::ZERO; 2], roughness)));
    let methods = [IntegratorDesc::Path, IntegratorDesc::Sppm, IntegratorDesc::Photon, IntegratorDesc::Caustic];
    for integrator in more.iter().copied().chain(methods) {
        let effort = [case.count(16, 256), case.count(4_000, 60_000), case.count(8, 32)];
        let [a, b] = [&overlap, &exact].map(|scene| means(scene, integrator, effort));
        for (i, part) in [(0, "whole"), (3, "middle")] {
            // The same seeds make much the same paths.
            let ratios: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a[i] / b[i]).collect();
            let what = format!("{}, {part}: ratio", integrator.name());
            case.mean(what, stats::mean_and_error(&ratios), 1.0, pick(case, 8e-3, 2e-3));
        }
    }
}

fn methods(case: &mut Case) {
    compare_methods(case, 1, 0.0);
}

fn rough_methods(case: &mut Case) {
    compare_methods(case, pick(case, 2, 3), 0.4);
}

fn compare_methods(case: &mut Case, more: u64, roughness: f32) {
    let scene = build(&room(true, [Rgb::new(0.3, 0.1, 0.2), Rgb::new(0.5, 1.0, 2.0)], roughness));
    let runs = more * case.count(12, 32);
    let expected = mean_of(&means(&scene, IntegratorDesc::Path, [case.count(96, 1024), 1, runs]));
    let methods = [
        (IntegratorDesc::Caustic, 0.0),
        (IntegratorDesc::Sppm, 0.0),
        // Their maps are made once.
        (IntegratorDesc::Photon, 5e-3),
        (IntegratorDesc::IrradianceCache, 5e-3),
    ];
    for (integrator, bias) in methods {
        let effort = [case.count(16, 256), case.count(6_000, 60_000), runs];
        let found = mean_of(&means(&scene, integrator, effort));
        for (part, from, quick) in [("whole", 0, 5e-3), ("middle", 3, 2e-2)] {
            for i in 0..3 {
                let (mean, error) = found[from + i];
                let (exact, own) = expected[from + i];
                let what = format!("{}, {part}, channel {i}", integrator.name());
                let both = (mean, error.hypot(own));
                let tolerance = pick(case, quick, 3e-3);
                if bias == 0.0 {
                    case.mean(what, both, exact, tolerance);
                } else {
                    case.biased_mean(what, both, exact, (bias, tolerance));
                }
            }
        }
    }
}
