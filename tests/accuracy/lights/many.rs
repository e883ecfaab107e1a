//! Many lights, even and uneven ones: the choice among them.

use std::f64::consts::PI;

use etendue::emitter::{Emitter, EmitterSet};
use etendue::math::{DVec3, Vec3};
use etendue::sampling::{Distribution1D, Sampler, SobolSampler};
use etendue::spectrum::Rgb;

use super::{ceiling, irradiance, lit, rendered, replicates, triangle_light};
use crate::common::scenes::point_light;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L47", title: "many lights", run: many },
        Entry { id: "L47b", title: "one light 1e6 times as strong", run: uneven },
        Entry { id: "L47c", title: "choice among 1e5 lights", run: choice },
    ]
}

/// The 2 x 2 square at height 1.
const SQUARE: f64 = 0.554126423980;

/// The halves of a horizontal square that shines down with this radiance.
fn square(centre: Vec3, half: f32, radiance: f32) -> [Emitter; 2] {
    let corner = |x: f32, y: f32| centre + half * Vec3::new(x, y, 0.0);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    [[a, b, c], [a, c, d]].map(|vertices| triangle_light(vertices, Rgb::splat(radiance)))
}

fn many(case: &mut Case) {
    for copies in [1_u16, 10, 1000] {
        let radiance = 1.0 / f32::from(copies);
        let set = EmitterSet::new((0..copies).flat_map(|_| square(Vec3::Z, 1.0, radiance)).collect());
        let found = irradiance(case, &set, Vec3::ZERO, DVec3::Z);
        case.mean(format!("{copies} copies, each as much weaker"), found, SQUARE, 1e-3);
    }
    // The square in 1000 pieces.
    let piece = |i: u16| {
        let (x, y) = (f64::from(i % 40) / 20.0 - 1.0, f64::from(i / 40) / 12.5 - 1.0);
        ceiling([x, x + 0.05], [y, y + 0.08], 1.0)
    };
    rendered(case, "1000 pieces", &lit(0.5, 1e-3, (0..1000).map(piece).collect()), SQUARE, 1e-3);
    // The bright one has all but 1e-9 of the power and lies below the receiver.
    let mut desc = lit(0.1, 1e-3, vec![]);
    desc.lights.push(point_light(DVec3::Z, 1.0));
    desc.lights.push(point_light(-DVec3::Z, 1e9));
    rendered(case, "a dim one beside a bright one out of sight", &desc, 1.0 / PI, 2e-3);
}

fn uneven(case: &mut Case) {
    // A thousand dim lamps on the ceiling, and one that is brighter by a million.
    let dim = |i: u16| square(Vec3::new(f32::from(i % 40) - 20.0, f32::from(i / 40) - 12.0, 3.0), 0.01, 1.0);
    let strong = || square(Vec3::new(0.3, 0.4, 2.0), 0.01, 1e6);
    let crowd = EmitterSet::new((0..1000).flat_map(dim).chain(strong()).collect());
    let exact = |set: &EmitterSet| -> f64 {
        // Lamps this small are points of intensity L A times the cosine there.
        set.emitters()
            .iter()
            .map(|emitter| match emitter {
                Emitter::Triangle(emitter) => {
                    let [a, b, c] = emitter.triangle.vertices;
                    let polygon = [a, b, c].map(Vec3::as_dvec3);
                    f64::from(emitter.radiance.r()) * super::polygon_factor(DVec3::ZERO, DVec3::Z, &polygon)
                }
                _ => 0.0,
            })
            .sum()
    };
    let all = exact(&crowd);
    case.mean("1000 dim and one strong", irradiance(case, &crowd, Vec3::ZERO, DVec3::Z), all, 1e-3);
    let without = EmitterSet::new((0..1000).flat_map(dim).collect());
    let dim_only = exact(&without);
    case.mean("the dim ones alone", irradiance(case, &without, Vec3::ZERO, DVec3::Z), dim_only, 1e-3);

    // A lamp as large as a room, so that it is noisy by itself.
    let large = || square(Vec3::new(0.3, 0.4, 2.0), 4.0, 1e6);
    let crowd = EmitterSet::new((0..1000).flat_map(dim).chain(large()).collect());
    let alone = EmitterSet::new(large().to_vec());
    let samples = 4096;
    let rmse = |set: &EmitterSet| {
        let exact = exact(set);
        let started = std::time::Instant::now();
        // Single samples, independent of one another: what the choice costs shows undisturbed.
        let values: Vec<f64> = (0..samples).flat_map(|seed| replicates(set, Vec3::ZERO, DVec3::Z, 1, seed)).collect();
        let mean = values.iter().map(|value| (value / exact - 1.0).powi(2)).sum::<f64>() / values.len() as f64;
        (mean.sqrt(), started.elapsed().as_secs_f64())
    };
    let ((one, one_seconds), (both, both_seconds)) = (rmse(&alone), rmse(&crowd));
    case.at_most("RMSE beside 1000 dim ones over that alone", both / one, 3.0);
    if case.is_full() {
        let ratio = both / one * (both_seconds / one_seconds).sqrt();
        case.at_most("the same at equal time", ratio, 3.0);
    }
}

fn choice(case: &mut Case) {
    let lights = 100_000_u32;
    let power = |i: u32| f64::from(1 + i % 1000).powi(2);
    // Small lamps in a plane, all seen from the origin, each with its density divided by its own alone.
    let lamp = |i: u32| {
        let (x, y) = (f64::from(i % 400) - 200.0, f64::from(i / 400) - 125.0);
        let v = |dx: f64, dy: f64| Vec3::new((x + dx) as f32, (y + dy) as f32, 100.0);
        triangle_light([v(0.0, 0.0), v(0.0, 0.5), v(0.5, 0.0)], Rgb::splat(power(i) as f32))
    };
    let set = EmitterSet::new((0..lights).map(lamp).collect());
    let mut sum = 0.0;
    for i in 0..lights {
        let Emitter::Triangle(emitter) = set.emitters()[i as usize] else { continue };
        let hit = emitter.triangle.at(1.0 / 3.0, 1.0 / 3.0);
        let wi = hit.normalize();
        let cos = f64::from(wi.z);
        let alone = f64::from(hit.length_squared()) / (cos * f64::from(emitter.triangle.area));
        sum += f64::from(set.pdf(i, Vec3::ZERO, hit)) / alone;
    }
    case.exact("probabilities in the lights' densities: sum", sum, 1.0, Within::Absolute(1e-6));
    let weights: Vec<f64> = (0..lights).map(power).collect();
    let distribution = Distribution1D::new(&weights).expect("positive weights");
    let sum = (0..weights.len()).map(|i| f64::from(distribution.pmf(i))).sum::<f64>();
    case.exact("probabilities of the distribution: sum", sum, 1.0, Within::Absolute(1e-6));
    let total: f64 = weights.iter().sum();
    let worst = weights
        .iter()
        .enumerate()
        .map(|(i, weight)| (f64::from(distribution.pmf(i)) / (weight / total) - 1.0).abs())
        .fold(0.0, f64::max);
    // Differences of a cumulative sum in double precision, and what is drawn: 1e-16 of the least likely, 3e-11.
    case.at_most("least exact probability, relative", worst, 1e-5);
    // Each light is found, and none without power.
    let mut sampler = SobolSampler::new(47, u32::MAX);
    let draws = case.count(1 << 18, 1 << 24);
    let mut zero_and_one = vec![0.0; 1000];
    zero_and_one[7] = 1.0;
    zero_and_one[999] = 1e-6;
    let rare = Distribution1D::new(&zero_and_one).expect("positive weights");
    let (mut none, mut last) = (0, 0_u64);
    for i in 0..draws {
        sampler.start((i >> 16) as u32, (i & 0xffff) as u32);
        let u = sampler.next_4d();
        let (index, pmf, _) = rare.sample(f64::from(u[0]) + f64::from(u[3]) * (-24_f64).exp2());
        none += u64::from(zero_and_one[index] == 0.0 || pmf == 0.0);
        last += u64::from(index == 999);
    }
    case.never("lights without power chosen", none, draws);
    // About one in a million, a quarter of one in 2^18: seen or not, never often.
    case.rarely("a light with 1e-6 of the power chosen", last, draws, 4e-6);
}
