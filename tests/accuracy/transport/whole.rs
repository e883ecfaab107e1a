//! The renderer as a whole: lamp and eye exchanged, ways to the same image compared, all power accounted for.

use std::f64::consts::PI;

use super::rays::PATH;
use super::{ball, glass, grey, mesh, mirror, parallelogram, pick};
use crate::common::scenes::{Job, box_inside, render_scene, scene};
use crate::record::{Case, Entry};
use crate::stats;
use etendue::desc::{BsdfDesc, CameraDesc, IntegratorDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc, SurfaceLook};
use etendue::film::Image;
use etendue::integrator::{Integrator, SceneTracer};
use etendue::math::{DVec3, Frame, Ray, Vec3};
use etendue::sampling::{Sampler, SobolSampler, warps};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "R69", title: "lamp and sensor exchanged", run: reciprocity },
        Entry { id: "R60", title: "Cornell box, integrators compared", run: compared },
        Entry { id: "R60b", title: "Cornell box, closed: power", run: power },
    ]
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// Batches whose scatter is the error of their mean.
const BATCHES: u32 = 32;

/// Mean of an estimate and its standard error, each channel, by batches of a power of two on two threads.
fn estimate(samples: u64, one: impl Fn(&mut SobolSampler) -> Rgb + Sync) -> [(f64, f64); 3] {
    let size = (samples as u32 / BATCHES).next_power_of_two();
    let batch = |number: u32| {
        let mut sampler = SobolSampler::new(11, size);
        let mut sum = [0.0; 3];
        for sample in 0..size {
            sampler.start(number, sample);
            let value = one(&mut sampler).to_array();
            assert!(value.iter().all(|v| v.is_finite() && *v >= 0.0), "{value:?}");
            sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += f64::from(value) / f64::from(size));
        }
        sum
    };
    let half = |start: u32| (start..BATCHES).step_by(2).map(batch).collect::<Vec<_>>();
    let means: Vec<[f64; 3]> = std::thread::scope(|scope| {
        let other = scope.spawn(|| half(1));
        let mut means = half(0);
        means.extend(other.join().expect("no sample panics"));
        means
    });
    std::array::from_fn(|channel| stats::mean_and_error(&means.iter().map(|mean| mean[channel]).collect::<Vec<_>>()))
}

/// A flat sensor: a parallelogram that receives on the side of u x v.
#[derive(Clone, Copy)]
struct Patch {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
}

impl Patch {
    fn shape(self) -> ShapeDesc {
        parallelogram(self.corner, self.u, self.v)
    }

    fn area(self) -> f64 {
        self.u.cross(self.v).length()
    }

    /// A ray that meets the patch in a random point straight on.
    fn view(self, scene: &Scene, u: [f32; 4]) -> Ray {
        let normal = self.u.cross(self.v).normalize();
        let point = self.corner + f64::from(u[0]) * self.u + f64::from(u[1]) * self.v;
        Ray::new(scene.to_scene(point + 1e-4 * self.area().sqrt() * normal), -normal.as_vec3a())
    }

    /// Power that it receives from the scene, by what it shows of that.
    fn received(self, scene: &Scene, samples: u64) -> (f64, f64) {
        let [(mean, error), ..] = estimate(samples, |sampler| {
            let ray = self.view(scene, sampler.next_4d());
            PATH.radiance(scene, ray, sampler, &mut SceneTracer::new(scene), &mut |_| {})
        });
        let factor = PI / f64::from(GLIMMER) * self.area();
        (mean * factor, error * factor)
    }
}

/// Albedo of what stands for black but must show what falls on it.
const GLIMMER: f32 = 0.01;

/// Surfaces around two patches.
type Things = Vec<(ShapeDesc, BsdfDesc)>;

fn reciprocity(case: &mut Case) {
    let lamp = Patch { corner: DVec3::new(-0.9, -0.2, -0.3), u: DVec3::Y * 0.5, v: DVec3::Z * 0.6 };
    let sensor = Patch { corner: DVec3::new(0.5, -0.6, 0.9), u: DVec3::Y * 0.8, v: DVec3::X * 0.4 };
    let walls = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let room = |bsdf: BsdfDesc| (walls, bsdf);
    let screen = (parallelogram(DVec3::new(0.0, -1.0, -0.6), DVec3::Y * 1.2, DVec3::Z * 1.1), grey(0.3));
    let looking_glass = (parallelogram(DVec3::new(-0.6, 0.9, -0.8), DVec3::X * 1.2, DVec3::Z * 1.6), mirror(0.9));
    let lens = (ball(DVec3::new(-0.15, 0.1, 0.35), 0.4), glass(1.5, 1.0));
    let hollow = (ball(DVec3::new(-0.15, 0.1, 0.35), 0.3), glass(1.0, 1.5));
    let oren_nayar = BsdfDesc::OrenNayar { albedo: Rgb::splat(0.7), roughness: 0.8 };
    let oren_nayar_qualitative = BsdfDesc::OrenNayarQualitative { albedo: Rgb::splat(0.7), sigma: 0.6 };
    let black = BsdfDesc::Black;
    let cases: [(&str, Things); 7] = [
        ("nothing between", vec![room(black)]),
        ("grey room and a screen", vec![room(grey(0.6)), screen]),
        ("mirror behind a screen", vec![room(grey(0.2)), screen, looking_glass]),
        ("glass ball in the dark", vec![room(black), lens]),
        ("glass shell, mirror, grey room", vec![room(grey(0.4)), lens, hollow, looking_glass]),
        ("Fujii room and a screen", vec![room(oren_nayar), screen]),
        ("Oren-Nayar room and a screen", vec![room(oren_nayar_qualitative), screen]),
    ];
    let transfer = |things: &Things, from: Patch, to: Patch, samples: u64| {
        let mut surfaces: Vec<_> = things.iter().map(|&(shape, bsdf)| (shape, bsdf, None)).collect();
        surfaces.push((from.shape(), grey(GLIMMER), Some(Rgb::ONE)));
        surfaces.push((to.shape(), grey(GLIMMER), None));
        let mut desc = scene(CameraDesc::default(), surfaces);
        desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)).into());
        to.received(&build(&desc), samples)
    };
    for (what, things) in cases {
        // In the dark, only chance finds the lamp through glass and in mirrors.
        let by_chance = what.contains("glass") || what.contains("mirror");
        let samples = if by_chance { case.count(1 << 18, 1 << 20) } else { case.count(1 << 14, 1 << 18) };
        let tolerance = if by_chance { pick(case, 2e-2, 8e-3) } else { pick(case, 1e-2, 3e-3) };
        let there = transfer(&things, lamp, sensor, samples);
        let back = transfer(&things, sensor, lamp, samples);
        case.equal_means(what, there, back, tolerance);
    }
    // A patch within a block of glass: n² times as much radiance there, in a beam n² times as narrow.
    let inside = Patch { corner: DVec3::new(-0.6, -0.3, -0.3), u: DVec3::Y * 0.6, v: DVec3::Z * 0.6 };
    let block = |n: usize| ShapeDesc::Mesh { mesh: n, smooth: false };
    let transfer = |from: Patch, to: Patch, samples: u64| {
        let mut desc = scene(
            CameraDesc::default(),
            vec![
                (block(0), grey(0.5), None),
                (block(1), glass(1.5, 1.0), None),
                (from.shape(), grey(GLIMMER), Some(Rgb::ONE)),
                (to.shape(), grey(GLIMMER), None),
            ],
        );
        desc.meshes.push(box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)).into());
        let inwards = box_inside(DVec3::new(-0.8, -0.5, -0.5), DVec3::new(-0.2, 0.5, 0.5));
        let triangles = inwards.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        desc.meshes.push(mesh(inwards.positions, triangles).into());
        to.received(&build(&desc), samples)
    };
    let (samples, tolerance) = (case.count(1 << 18, 1 << 20), pick(case, 2e-2, 8e-3));
    let (into, out) = (transfer(sensor, inside, samples), transfer(inside, sensor, samples));
    case.equal_means("patch within glass, over n²", (into.0 / 2.25, into.1 / 2.25), out, tolerance);
}

fn cornell() -> SceneDesc {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.json");
    etendue::desc::load(&path, None).expect("the Cornell box")
}

/// Mean and squared standard error of each square of 8 x 8 pixels, all channels together.
fn blocks(image: &Image) -> Vec<(f64, f64)> {
    let variance = &image.layer("variance").expect("always there").data;
    let width = image.width as usize;
    let side = width / 8;
    let mut found = vec![(0.0, 0.0); side * side];
    for (pixel, (rgb, variance)) in image.rgb.chunks_exact(3).zip(variance.chunks_exact(3)).enumerate() {
        let block = &mut found[pixel / width / 8 * side + pixel % width / 8];
        block.0 += rgb.iter().map(|&v| f64::from(v)).sum::<f64>() / (3.0 * 64.0);
        // Channels rise and fall together: their errors are added, which is no less than the error of the sum.
        let error: f64 = variance.iter().map(|&v| f64::from(v).sqrt()).sum::<f64>() / (3.0 * 64.0);
        block.1 += error * error;
    }
    found
}

fn compared(case: &mut Case) {
    let scene = build(&cornell());
    let side = 32;
    let base = RenderDesc {
        samples: case.count(64, 2048) as u32,
        seed: 1,
        ..Job { resolution: [side, side], ..Job::default() }.desc()
    };
    let image = |desc: RenderDesc| blocks(&render_scene(&scene, desc).0);
    let path = image(base.clone());
    let scattered_once = image(RenderDesc { max_depth: Some(1), ..base.clone() });
    let random = RenderDesc { sampler: SamplerDesc::Random, seed: 2, ..base.clone() };
    let more_shadow_rays = RenderDesc { shadow_rays: 4, seed: 3, ..base.clone() };
    let whitted = RenderDesc { integrator: IntegratorDesc::Whitted, seed: 4, ..base.clone() };
    let direct = RenderDesc { integrator: IntegratorDesc::Direct, shadow_rays: 2, seed: 5, ..base.clone() };
    let jittered = RenderDesc { sampler: SamplerDesc::Jittered, seed: 6, ..base };
    for (what, reference, other) in [
        ("path: Sobol' and random samples", &path, random),
        ("path: Sobol' and jittered samples", &path, jittered),
        ("path: 1 and 4 shadow rays", &path, more_shadow_rays),
        ("path of one hit and Whitted", &scattered_once, whitted),
        ("path of one hit and direct, 2 shadow rays", &scattered_once, direct),
    ] {
        let other = image(other);
        let (mut least, mut largest, mut tests) = (1.0_f64, 0.0_f64, 0);
        for (a, b) in reference.iter().zip(&other) {
            let error = (a.1 + b.1).sqrt();
            if a.0 == 0.0 && b.0 == 0.0 {
                // Beside the box.
                continue;
            }
            least = least.min(stats::z_test(a.0, error, b.0));
            largest = largest.max(error / a.0);
            tests += 1;
        }
        // Out of all five comparisons.
        case.p_value(format!("{what}: blocks of 8 x 8"), least, 5 * tests);
        case.at_most(format!("{what}: largest error of a block"), largest, pick(case, 0.08, 0.01));
    }
}

fn power(case: &mut Case) {
    // An almost black wall closes the open side, so that nothing is lost.
    let mut desc = cornell();
    let corners = [(0.0, 0.0), (552.8, 0.0), (556.0, 548.8), (0.0, 548.8)];
    let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
    let wall = desc.add_material("wall", grey(GLIMMER), None).expect("a material");
    let (shape, local) = ShapeDesc::quad(corners).expect("a wall");
    let look = SurfaceLook { material: Some(wall), ..SurfaceLook::default() };
    desc.add_surface(shape, local, look).expect("a wall");
    let scene = build(&desc);
    // What the walls and blocks show says what falls on them and what of that they keep: pi L (1 - a) / a.
    let mut triangles = Vec::new();
    for surface in desc.surfaces.iter().filter(|surface| surface.emission.is_none()) {
        let BsdfDesc::Lambert { albedo } = desc.materials[surface.material.unwrap()].bsdf else {
            unreachable!("all are")
        };
        match surface.shape {
            ShapeDesc::Quad([a, b, c, d]) => triangles.extend([([a, b, c], albedo), ([a, c, d], albedo)]),
            ShapeDesc::Triangle(corners) => triangles.push((corners, albedo)),
            _ => unreachable!("the box is made of quads and triangles"),
        }
    }
    let areas: Vec<f64> = triangles.iter().map(|([a, b, c], _)| 0.5 * (b - a).cross(c - a).length()).collect();
    let total: f64 = areas.iter().sum();
    let samples = case.count(1 << 17, 1 << 22);
    let kept = estimate(samples, |sampler| {
        let u = sampler.next_4d();
        let mut left = f64::from(u[0]) * total;
        let found = areas.iter().position(|area| {
            left -= area;
            left < 0.0
        });
        let ([a, b, c], albedo) = triangles[found.unwrap_or(triangles.len() - 1)];
        let [_, s, t] = warps::uniform_triangle([u[1], u[2]]).map(f64::from);
        // Not all of them face the light.
        let side = if u[3] < 0.5 { 1.0 } else { -1.0 };
        let normal = side * (b - a).cross(c - a).normalize();
        let point = a + s * (b - a) + t * (c - a);
        let ray = Ray::new(scene.to_scene(point + 1e-2 * normal), -normal.as_vec3a());
        let shown = PATH.radiance(&scene, ray, sampler, &mut SceneTracer::new(&scene), &mut |_| {});
        2.0 * std::f32::consts::PI * total as f32 * shown * (Rgb::ONE - albedo) / albedo
    });
    // The lamp is black: it keeps what falls on it.
    let lamp = Patch { corner: DVec3::new(213.0, 548.8, 227.0), u: DVec3::X * 130.0, v: DVec3::Z * 105.0 };
    let on_lamp = estimate(samples / 4, |sampler| {
        let u = sampler.next_4d();
        let point = lamp.corner + f64::from(u[0]) * lamp.u + f64::from(u[1]) * lamp.v;
        let down = Frame::from_normal(Vec3::NEG_Y).to_world(warps::cosine_hemisphere([u[2], u[3]]));
        let ray = Ray::new(scene.to_scene(point - 1e-2 * DVec3::Y), down.normalize());
        let radiance = PATH.radiance(&scene, ray, sampler, &mut SceneTracer::new(&scene), &mut |_| {});
        (PI * lamp.area()) as f32 * radiance
    });
    let emitted = desc.surfaces.iter().find_map(|surface| surface.emission).expect("a lamp");
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let parts = [kept[channel], on_lamp[channel]];
        let sum = parts.iter().map(|part| part.0).sum();
        let error = parts.iter().map(|part| part.1 * part.1).sum::<f64>().sqrt();
        let exact = PI * 130.0 * 105.0 * f64::from(emitted[channel]);
        case.mean(format!("absorbed over emitted, {name}"), (sum, error), exact, pick(case, 5e-3, 1e-3));
    }
}
