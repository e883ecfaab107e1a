//! The choice among many lights by what a receiver may get from each: probabilities, densities, and no light forgotten.

use etendue::bsdf::{Bsdf, Model as _, TransportMode};
use etendue::desc::{BsdfDesc, ShapeDesc};
use etendue::emitter::{Emitter, EmitterSet, Receiver, SphereEmitter};
use etendue::math::{DVec3, Frame, Vec3};
use etendue::sampling::{Rng, Sampler, SobolSampler, warps};
use etendue::shape::Sphere;
use etendue::spectrum::Rgb;

use super::{REPLICATES, polygon_factor, sphere_factor, triangle_light};
use crate::common::scenes::{Job, add, camera, point_light, render, scene};
use crate::leaving::ball_mesh;
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L49", title: "choice by receiver: probabilities", run: probabilities },
        Entry { id: "L49b", title: "choice by receiver: no light is forgotten", run: none_forgotten },
        Entry { id: "L49c", title: "choice by receiver: 1e4 lights", run: ten_thousand },
        Entry { id: "L49d", title: "choice by receiver: rough and smooth surfaces", run: surfaces },
        Entry { id: "L49e", title: "choice by receiver: odd sets", run: odd },
    ]
}

/// A number in [-1, 1).
fn signed(rng: &mut Rng) -> f32 {
    2.0 * rng.next_f32() - 1.0
}

fn somewhere(rng: &mut Rng, size: f32) -> Vec3 {
    size * Vec3::new(signed(rng), signed(rng), signed(rng))
}

fn direction(rng: &mut Rng) -> Vec3 {
    warps::uniform_sphere([rng.next_f32(), rng.next_f32()])
}

/// A light of any kind in the cube of this half side; extents of up to a tenth of it, powers over six decades.
fn any_light(rng: &mut Rng, size: f32, radiance: Rgb) -> Emitter {
    let middle = somewhere(rng, size);
    match (3.0 * rng.next_f32()) as u32 {
        0 => Emitter::Point { position: middle, intensity: radiance * (size * size) },
        1 => {
            let radius = f64::from(size) * 10_f64.powf(-1.0 - 2.0 * f64::from(rng.next_f32()));
            let sphere = Sphere { centre: middle.as_dvec3(), radius };
            Emitter::Sphere(SphereEmitter { sphere, radiance })
        }
        _ => {
            let extent = 0.1 * size * (0.05 + rng.next_f32());
            let (a, b) = (direction(rng), direction(rng));
            let b = if a.cross(b).length() < 0.1 { a.any_orthonormal_vector() } else { b };
            triangle_light([middle, middle + extent * a, middle + extent * b], radiance)
        }
    }
}

/// Receivers with and without a normal, among the lights, right at them, and far away.
fn any_receiver(rng: &mut Rng, set: &EmitterSet, size: f32) -> (Receiver, Option<Vec3>) {
    let p = match (4.0 * rng.next_f32()) as u32 {
        0 | 1 => somewhere(rng, size),
        2 => {
            let chosen = (rng.next_f32() * set.emitters().len() as f32) as usize;
            set.emitters()[chosen].centre() + somewhere(rng, 0.02 * size)
        }
        _ => somewhere(rng, 1e3 * size),
    };
    if rng.next_f32() < 0.3 {
        return (Receiver::from(p), None);
    }
    let normal = direction(rng);
    (Receiver::facing(p, normal), Some(normal))
}

fn total_probability(set: &EmitterSet, receiver: Receiver) -> f64 {
    (0..set.emitters().len() as u32).map(|i| f64::from(set.probability(i, receiver))).sum()
}

fn probabilities(case: &mut Case) {
    let mut rng = Rng::new(49, 0);
    let receivers = case.count(12, 200);
    for size in [1e-15_f32, 1.0, 1e15] {
        // A cloud of points, each known by its intensity: the sample tells which was chosen. Every choice is a sample.
        let points = 300_u32;
        let light = |i: u32, rng: &mut Rng| Emitter::Point {
            position: somewhere(rng, size),
            intensity: Rgb::new(1.0 + (i % 7) as f32, (i + 1) as f32, 0.0) * (size * size),
        };
        let set = EmitterSet::new((0..points).map(|i| light(i, &mut rng)).collect());
        let (mut most_off, mut density_off, mut least_p) = (0.0_f64, 0.0_f64, 1.0_f64);
        for _ in 0..receivers {
            let (receiver, _) = any_receiver(&mut rng, &set, size);
            let sum = total_probability(&set, receiver);
            let draws = 20_000_u32;
            let mut sampler = SobolSampler::new(rng.next_u64(), draws);
            let (mut observed, mut nothing) = (vec![0_u64; points as usize + 1], 0);
            for i in 0..draws {
                sampler.start(0, i);
                let u = sampler.next_4d();
                // Independent choices: those of a net would be more even than chance.
                let u = [rng.next_f32(), u[1], u[2], rng.next_f32()];
                let Some(sample) = set.sample(receiver, u) else {
                    nothing += 1;
                    continue;
                };
                let ratio = sample.radiance.g() / sample.radiance.r();
                let found = (0..points).min_by(|&a, &b| {
                    let off = |i: u32| {
                        let Emitter::Point { position, intensity } = set.emitters()[i as usize] else { return 2.0 };
                        let way = (position - receiver.p).normalize();
                        (intensity.g() / intensity.r() / ratio - 1.0).abs() + way.distance(sample.wi)
                    };
                    f32::total_cmp(&off(a), &off(b))
                });
                let found = found.expect("there are lights");
                observed[found as usize] += 1;
                let probability = f64::from(set.probability(found, receiver));
                density_off = density_off.max((f64::from(sample.pdf) / probability - 1.0).abs());
            }
            observed[points as usize] = nothing;
            let mut expected: Vec<f64> =
                (0..points).map(|i| f64::from(set.probability(i, receiver)) * f64::from(draws)).collect();
            // What comes to nothing is the rest of all probabilities.
            expected.push((1.0 - sum).max(1e-6) * f64::from(draws));
            most_off = most_off.max(sum - 1.0);
            least_p = least_p.min(stats::chi_square(&observed, &expected));
        }
        case.at_most(format!("size {size:e}: sum of the probabilities over 1"), most_off, 1e-5);
        case.at_most(format!("size {size:e}: density over the probability, off 1"), density_off, 1e-5);
        case.p_value(format!("size {size:e}: frequencies, least of all receivers"), least_p, 3 * receivers as usize);
    }
}

fn none_forgotten(case: &mut Case) {
    let mut rng = Rng::new(50, 0);
    let receivers = case.count(2000, 20_000);
    for size in [1e-15_f32, 1.0, 1e15] {
        let mut lights: Vec<Emitter> = (0..200)
            .map(|_| {
                let power = 10_f32.powf(6.0 * rng.next_f32() - 3.0);
                any_light(&mut rng, size, Rgb::splat(power))
            })
            .collect();
        // Never seen: nothing is as far up, and it shines upwards. Its probability is what every light has at least.
        let [x, y] = [Vec3::X, Vec3::Y].map(|axis| 0.01 * size * axis);
        let up = 1.2 * size * Vec3::Z;
        lights.push(triangle_light([up, up + x, up + y], Rgb::splat(1e-3)));
        lights.push(triangle_light([up, up + 2.0 * x, up + y], Rgb::ZERO));
        let set = EmitterSet::new(lights);
        let unseen = set.emitters().len() as u32 - 2;
        let (mut forgotten, mut impossible, mut able, mut black) = (0, 0, 0, 0);
        for _ in 0..receivers {
            let (receiver, normal) = any_receiver(&mut rng, &set, size);
            if receiver.p.z > size {
                continue;
            }
            let least = set.probability(unseen, receiver);
            black += u64::from(set.probability(unseen + 1, receiver) != 0.0);
            // What each sends from some place on it, without what is in between.
            let sent = |emitter: &Emitter, rng: &mut Rng| {
                let departure = emitter.sample_departure([rng.next_f32(), rng.next_f32()]);
                let way = (departure.point.p.as_dvec3() - receiver.p.as_dvec3()) / f64::from(size);
                let (distance2, to_light) = (way.length_squared(), way.normalize());
                let leaving = departure.normal.map_or(1.0, |normal| normal.as_dvec3().dot(-to_light).max(0.0));
                let arriving = normal.map_or(1.0, |normal| normal.as_dvec3().dot(to_light).max(0.0));
                let power = emitter.power().x / f64::from(size).powi(2);
                if distance2 > 0.0 { power * leaving * arriving / distance2 } else { 0.0 }
            };
            let sent: Vec<f64> = set.emitters().iter().map(|emitter| sent(emitter, &mut rng)).collect();
            let all: f64 = sent.iter().sum();
            for (i, sent) in (0..unseen).zip(sent) {
                let probability = set.probability(i, receiver);
                able += u64::from(sent > 0.0);
                impossible += u64::from(sent > 0.0 && probability <= 0.0);
                // Below that the difference is lost in single precision.
                forgotten += u64::from(sent > 1e-4 * all && probability <= least);
            }
        }
        case.never(format!("size {size:e}: impossible"), impossible, able);
        case.never(
            format!("size {size:e}: no more likely than one that is not seen, of those that give 1e-4 of the light"),
            forgotten,
            able,
        );
        case.never(format!("size {size:e}: black ones chosen"), black, receivers);
    }
}

/// Small lamps and balls all over a hall: their factors at `p` with normal `n` times their radiances.
fn exact(set: &EmitterSet, p: DVec3, n: DVec3) -> f64 {
    set.emitters()
        .iter()
        .map(|emitter| match emitter {
            Emitter::Triangle(emitter) => {
                let corners = emitter.triangle.vertices.map(Vec3::as_dvec3);
                let shines = emitter.triangle.height_by_twice_area(p.as_vec3a()) > 0.0;
                let factor = if shines { polygon_factor(p, n, &corners) } else { 0.0 };
                f64::from(emitter.radiance.r()) * factor
            }
            Emitter::Textured(_)
            | Emitter::TexturedSphere(_)
            | Emitter::EnvironmentMap(_)
            | Emitter::Disk(_)
            | Emitter::Tube(_)
            | Emitter::InnerTube(_) => {
                unreachable!("no lamp here has a texture or is round but for balls")
            }
            Emitter::Moving(_) => unreachable!("no lamp here moves"),
            Emitter::Web(_) => unreachable!("all lamps here shine evenly"),
            Emitter::Sphere(emitter) => {
                let way = emitter.sphere.centre - p;
                let distance = way.length();
                f64::from(emitter.radiance.r())
                    * sphere_factor(emitter.sphere.radius / distance, (way.dot(n) / distance).acos())
            }
            Emitter::Point { .. } | Emitter::Directed(_) | Emitter::Environment(_) | Emitter::Distant(_) => 0.0,
        })
        .sum()
}

fn ten_thousand(case: &mut Case) {
    let mut rng = Rng::new(51, 0);
    let lamp = |i: u32, rng: &mut Rng| {
        let power = Rgb::splat(10_f32.powf(2.0 * rng.next_f32()));
        let middle = Vec3::new(20.0 * rng.next_f32(), 20.0 * rng.next_f32(), 0.5 + 5.0 * rng.next_f32());
        if i.is_multiple_of(2) {
            let sphere = Sphere { centre: middle.as_dvec3(), radius: 0.01 + 0.02 * f64::from(rng.next_f32()) };
            return Emitter::Sphere(SphereEmitter { sphere, radiance: power });
        }
        let (a, b) = (direction(rng), direction(rng));
        let b = if a.cross(b).length() < 0.1 { a.any_orthonormal_vector() } else { b };
        triangle_light([middle, middle + 0.05 * a, middle + 0.05 * b], power)
    };
    let set = EmitterSet::new((0..10_000).map(|i| lamp(i, &mut rng)).collect());
    let size = case.count(8192, 65_536) as u32;
    for (what, p, normal) in [
        ("below", Vec3::new(9.0, 11.0, 0.0), Vec3::Z),
        ("in a corner", Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8)),
        ("among them, sideways", Vec3::new(12.0, 4.0, 3.0), Vec3::X),
        ("far away", Vec3::new(-500.0, 300.0, 200.0), Vec3::new(500.0, -300.0, -200.0).normalize()),
    ] {
        let n = normal.as_dvec3().normalize();
        let exact = exact(&set, p.as_dvec3(), n);
        for (how, receiver) in [("facing", Receiver::facing(p, normal)), ("open", Receiver::from(p))] {
            let mut sampler = SobolSampler::new(51, size);
            let mut value = |i| {
                sampler.start(0, i);
                let Some(sample) = set.sample(receiver, sampler.next_4d()) else { return 0.0 };
                let cos = n.dot(sample.wi.as_dvec3()).max(0.0);
                f64::from(sample.radiance.r()) * cos / f64::from(sample.pdf) / std::f64::consts::PI
            };
            let replicate = |r: u32| (r * size..(r + 1) * size).map(&mut value).sum::<f64>() / f64::from(size);
            let values: Vec<f64> = (0..REPLICATES).map(replicate).collect();
            case.mean(format!("{what}, {how}"), stats::mean_and_error(&values), exact, 5e-3);
        }
    }
    // What Bsdf samples that meet a light are weighed with.
    let receiver = Receiver::facing(Vec3::new(9.0, 11.0, 0.0), Vec3::Z);
    let mut sum = 0.0;
    for i in 0..set.emitters().len() as u32 {
        let Emitter::Triangle(emitter) = set.emitters()[i as usize] else { continue };
        let alone = EmitterSet::new(vec![Emitter::Triangle(emitter)]);
        let hit = emitter.triangle.at(0.2, 0.3);
        let (one, all) = (alone.pdf(0, receiver, hit), set.pdf(i, receiver, hit));
        if one > 0.0 {
            let expected = f64::from(one) * f64::from(set.probability(i, receiver));
            sum = f64::max(sum, (f64::from(all) / expected - 1.0).abs());
        }
    }
    case.at_most("density over that of the light alone times its probability, off 1", sum, 1e-6);
}

fn surfaces(case: &mut Case) {
    // One picture with all lights is the sum of pictures with a few each, which are chosen by power.
    let mut rng = Rng::new(52, 0);
    let lights: Vec<_> = (0..24)
        .map(|_| {
            point_light(3.0 * direction(&mut rng).as_dvec3() + DVec3::new(0.0, 1.0, 0.0), 1.0 + 9.0 * rng.next_f32())
        })
        .collect();
    for (what, bsdf) in [
        ("Oren-Nayar", BsdfDesc::OrenNayarQualitative { albedo: Rgb::splat(0.8), sigma: 0.6 }),
        ("Fujii", BsdfDesc::OrenNayar { albedo: Rgb::splat(0.8), roughness: 1.0 }),
    ] {
        let ball = |smooth| ShapeDesc::Mesh { mesh: 0, smooth };
        let mut desc = scene(camera(DVec3::new(0.5, 0.7, 4.0), DVec3::ZERO, 30.0), vec![(ball(true), bsdf, None)]);
        desc.meshes.push(ball_mesh(12, 24).into());
        let floor = super::quad([[-9.0, -1.0, 9.0], [9.0, -1.0, 9.0], [9.0, -1.0, -9.0], [-9.0, -1.0, -9.0]]);
        add(&mut desc, 1, floor, bsdf, None);
        let job = Job { resolution: [16, 16], samples: case.count(1024, 8192) as u32, ..Job::default() };
        let mean = |lights: &[_], seed| {
            let mut desc = desc.clone();
            desc.lights = lights.to_vec();
            let (image, _) = render(&desc, &Job { seed, ..job.clone() });
            crate::common::scenes::mean_and_error(&image)
        };
        let whole = mean(&lights, 1);
        let parts: Vec<_> = lights.chunks(2).zip(2..).map(|(few, seed)| mean(few, seed)).collect();
        let sum = parts.iter().map(|part| part.0).sum::<f64>();
        let error = parts.iter().map(|part| part.1.powi(2)).sum::<f64>().sqrt();
        case.equal_means(format!("{what}, smooth normals: all lights and their parts"), whole, (sum, error), 5e-3);
        // Without the scene: at grazing angles too.
        let bsdf = Bsdf::new(&bsdf);
        let frame = Frame::from_normal(Vec3::new(0.36, 0.48, 0.8));
        let set = EmitterSet::new((0..64).map(|_| any_light(&mut rng, 1.0, Rgb::ONE)).collect());
        for cos in [0.9_f32, 0.05] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let size = case.count(4096, 65_536) as u32;
            let estimate = |receiver: Receiver, seed| {
                let mut sampler = SobolSampler::new(seed, size);
                let mut value = |i| {
                    sampler.start(0, i);
                    let Some(sample) = set.sample(receiver, sampler.next_4d()) else { return 0.0 };
                    let wi = frame.to_local(sample.wi);
                    f64::from(bsdf.f(wo, wi, TransportMode::Radiance).r() * sample.radiance.r() * wi.z.abs())
                        / f64::from(sample.pdf)
                };
                let replicate = |r: u32| (r * size..(r + 1) * size).map(&mut value).sum::<f64>() / f64::from(size);
                stats::mean_and_error(&(0..REPLICATES).map(replicate).collect::<Vec<_>>())
            };
            let p = Vec3::new(-0.3, 0.2, -0.9);
            let facing = estimate(Receiver::facing(p, frame.to_world(Vec3::Z)), 52);
            let open = estimate(Receiver::from(p), 53);
            case.equal_means(format!("{what}, looked at under a cosine of {cos}: facing and open"), facing, open, 5e-3);
        }
    }
}

fn odd(case: &mut Case) {
    let lamp = |middle: Vec3, size: f32, radiance: f32| {
        triangle_light([middle, middle + size * Vec3::Y, middle + size * Vec3::X], Rgb::splat(radiance))
    };
    let point = |position, intensity| Emitter::Point { position, intensity: Rgb::splat(intensity) };
    let one = Vec3::ONE;
    for (what, lights) in [
        ("500 points in one place", (0..500).map(|_| point(one, 1.0)).collect::<Vec<_>>()),
        ("500 triangles in one place", (0..500).map(|_| lamp(one, 0.5, 1.0)).collect()),
        (
            "powers from 1e-30 to 1e30",
            (0..61_i16).map(|i| point(i.into_vec(), 10_f32.powi(i32::from(i) - 30))).collect(),
        ),
        ("places from 1e-18 to 1e18", (0..37).map(|i| point(10_f32.powi(i - 18) * one, 1.0)).collect()),
        ("a row", (0..1000_i16).map(|i| lamp(i.into_vec(), 0.1, 1.0)).collect()),
    ] {
        let set = EmitterSet::new(lights);
        let mut worst = 0.0_f64;
        for p in [Vec3::ZERO, one, 1e-18 * one, -1e18 * one, Vec3::new(3.0, 0.0, -1e-3), Vec3::new(1.0, 1.0, -1e-20)] {
            for receiver in [Receiver::from(p), Receiver::facing(p, Vec3::Z), Receiver::facing(p, -Vec3::Z)] {
                let sum = total_probability(&set, receiver);
                // A number that is not finite is as wrong as can be.
                worst = worst.max(if sum.is_finite() { (sum - 1.0).max(0.0) } else { 1.0 });
                for k in 0..64_u8 {
                    let u = f32::from(k) / 64.0;
                    if let Some(sample) = set.sample(receiver, [u, 0.3, 0.6, 0.5]) {
                        worst = worst.max(if sample.pdf > 0.0 && sample.pdf.is_finite() { 0.0 } else { 1.0 });
                    }
                }
            }
        }
        case.at_most(format!("{what}: sum of the probabilities over 1"), worst, 1e-4);
    }
    let black = EmitterSet::new((0..100).map(|_| lamp(one, 0.5, 0.0)).collect());
    case.holds("all black", "dark", format!("{}", black.is_dark()), black.is_dark());
    let lights: Vec<_> =
        (0..100_000_u32).map(|i| lamp(Vec3::new((i % 317) as f32, (i / 317) as f32, 0.0), 0.3, 1.0)).collect();
    let set = EmitterSet::new(lights);
    let sum = total_probability(&set, Receiver::facing(Vec3::new(20.0, 30.0, -3.0), Vec3::Z));
    case.exact("1e5 in a plane: sum of the probabilities", sum, 1.0, Within::Absolute(1e-5));
}

/// Places in a row.
trait InARow {
    fn into_vec(self) -> Vec3;
}

impl InARow for i16 {
    fn into_vec(self) -> Vec3 {
        Vec3::new(f32::from(self), 0.0, 0.0)
    }
}
