//! The clear sky of Hosek and Wilkie and its sun: against numbers of the published datasets, quadrature and closed forms.
//!
//! The numbers were computed in double precision from the published datasets (version 1.4a) by a program of their own; another
//! implementation, Mitsuba 3.9, gives three of the directions to 2e-6.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::Cancel;
use etendue::desc::{DistantLightDesc, EnvironmentDesc, HosekWilkieDesc, IntegratorDesc, SceneDesc, SkyDesc};
use etendue::emitter::{EnvironmentMap, HosekWilkieSky, Sky, solar_radiance};
use etendue::lighting::{daylight_only, exterior_illuminance};
use etendue::math::{DMat3, DVec3};
use etendue::render::RenderSettings;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::sky::{METHODS, drawn};
use super::{irradiance, lit, sphere_factor};
use crate::common::scenes::mean_and_error;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L70", title: "clear sky, published numbers", run: published },
        Entry { id: "L71", title: "clear sky, by points", run: points },
        Entry { id: "L72", title: "the sun of the clear sky", run: sun },
        Entry { id: "L73", title: "clear sky and its sun, by all methods", run: pictures },
    ]
}

/// Turbidity, albedo, elevation of the sun, angle to the zenith and angle to the sun \[degree\], with the radiance.
const RADIANCES: [([f64; 5], [f64; 3]); 12] = [
    ([1.0, 0.0, 0.0, 80.0, 30.0], [4.371415, 3.474362, 1.718818]),
    ([1.0, 0.0, 90.0, 45.0, 45.0], [2.149354, 4.988866, 10.449328]),
    ([1.0, 1.0, 30.0, 0.0, 60.0], [1.862969, 4.164959, 8.648112]),
    ([2.0, 0.0, 60.0, 30.0, 40.0], [2.266693, 4.156391, 9.049528]),
    ([3.0, 0.3, 30.0, 10.0, 50.0], [2.056991, 3.732343, 7.173336]),
    ([2.5, 0.5, 10.0, 85.0, 5.0], [54.047794, 43.543689, 22.680946]),
    ([6.0, 0.5, 80.0, 60.0, 60.0], [8.252909, 12.435547, 20.126875]),
    ([4.75, 0.25, 45.0, 45.0, 0.0], [45.458079, 46.946320, 41.987687]),
    ([10.0, 0.0, 5.0, 88.0, 90.0], [1.098948, 0.990897, 0.896798]),
    ([10.0, 1.0, 45.0, 70.0, 90.0], [16.356658, 17.835955, 20.261898]),
    ([10.0, 1.0, 90.0, 30.0, 30.0], [28.086894, 31.172224, 33.123103]),
    ([9.6, 0.8, 20.0, 20.0, 110.0], [2.239845, 3.491537, 5.575608]),
];

/// Turbidity and elevation \[degree\], with the mean radiance of the sun's disk.
const SUNS: [([f64; 2], [f64; 3]); 8] = [
    ([1.0, 90.0], [2782499.242, 2395361.380, 1982362.445]),
    ([1.0, 0.0], [318285.872, 46092.258, 0.0]),
    ([2.0, 5.0], [1354322.541, 628743.367, 102770.443]),
    ([3.0, 30.0], [2480345.375, 1979116.218, 1386767.383]),
    ([3.5, 1.5], [248320.338, 59735.778, 0.0]),
    ([6.0, 60.0], [2461497.199, 2072563.307, 1680250.492]),
    ([9.25, 20.0], [1008564.939, 697785.702, 436744.444]),
    ([10.0, 90.0], [1830990.786, 1511853.448, 1279236.538]),
];

/// The sine of half of 0.533 degrees, squared, times pi: irradiance over radiance of the sun's disk.
fn across() -> f64 {
    PI * (0.5 * 0.533_f64).to_radians().sin().powi(2)
}

/// The direction to the sun at this elevation, z up.
fn towards(elevation: f64) -> DVec3 {
    let (sine, cosine) = elevation.to_radians().sin_cos();
    DVec3::new(0.6 * cosine, -0.8 * cosine, sine)
}

fn clear(turbidity: f64, elevation: f64, albedo: f64) -> HosekWilkieDesc {
    HosekWilkieDesc {
        up: DVec3::Z * 2.0,
        ground: Rgb::splat(albedo as f32),
        disk_deg: None,
        ..HosekWilkieDesc::new(turbidity, towards(elevation) * 3.0)
    }
}

/// A white floor under this sky.
fn under(sky: HosekWilkieDesc, factor: f32) -> SceneDesc {
    let mut desc = lit(1.0, 0.1, vec![]);
    let environment = EnvironmentDesc { sky: SkyDesc::HosekWilkie(sky), ..EnvironmentDesc::even(Rgb::splat(factor)) };
    desc.set_environment_desc(Some(environment)).expect("a sky of the test");
    desc
}

fn build(desc: &SceneDesc) -> Scene {
    Scene::build(desc, &BuildOptions::default()).expect("a scene of the test")
}

/// All light from infinity in a direction.
fn seen(scene: &Scene, direction: DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    scene.emitters().each_infinite(direction.as_vec3a().normalize(), |radiance, _| sum += radiance.to_f64());
    sum
}

/// The published formula, read anew from the table: the numbers of a channel by repeated interpolation, for one corner of
/// turbidity and albedo after another.
struct Published {
    numbers: [[f64; 10]; 3],
    sun: DVec3,
}

impl Published {
    fn new(turbidity: f64, elevation: f64, albedo: f64) -> Self {
        let table = include_bytes!("../../../src/emitter/hosek_wilkie/sky.f32");
        let read = |i: usize| f64::from(f32::from_le_bytes(table[4 * i..4 * i + 4].try_into().expect("four bytes")));
        let t = (elevation / 90.0).cbrt();
        let corner = |channel: usize, albedo: usize, turbidity: usize, number: usize| {
            let mut points: Vec<f64> = (0..6)
                .map(|point| read((((channel * 2 + albedo) * 10 + turbidity - 1) * 6 + point) * 10 + number))
                .collect();
            while points.len() > 1 {
                points = points.windows(2).map(|pair| pair[0] + t * (pair[1] - pair[0])).collect();
            }
            points[0]
        };
        let floor = turbidity.floor();
        let rest = turbidity - floor;
        let of_air = |channel, ground, number| {
            let low = corner(channel, ground, floor as usize, number);
            if rest == 0.0 { low } else { low + rest * (corner(channel, ground, floor as usize + 1, number) - low) }
        };
        let number = |channel: usize, number: usize| {
            (1.0 - albedo) * of_air(channel, 0, number) + albedo * of_air(channel, 1, number)
        };
        let numbers = [0, 1, 2].map(|channel| std::array::from_fn(|i| number(channel, i)));
        Self { numbers, sun: towards(elevation) }
    }

    fn radiance(&self, theta: f64, gamma: f64) -> DVec3 {
        DVec3::from_array(self.numbers.map(|[a, b, c, d, e, f, g, h, i, radiance]| {
            let chi = (1.0 + gamma.cos().powi(2)) / (1.0 + i * i - 2.0 * i * gamma.cos()).powf(1.5);
            let shape = c + d * (e * gamma).exp() + f * gamma.cos().powi(2) + g * chi + h * theta.cos().sqrt();
            (radiance * (1.0 + a * (b / (theta.cos() + 0.01)).exp()) * shape).max(0.0)
        }))
    }

    /// What a surface with this normal gets from the sky alone.
    fn received(&self, normal: DVec3) -> DVec3 {
        const STEPS: u32 = 1200;
        const AROUND: u32 = 600;
        let mut sum = DVec3::ZERO;
        for j in 0..STEPS {
            let theta = FRAC_PI_2 * (f64::from(j) + 0.5) / f64::from(STEPS);
            let solid = theta.sin() * FRAC_PI_2 / f64::from(STEPS) * 2.0 * PI / f64::from(AROUND);
            for i in 0..AROUND {
                let around = 2.0 * PI * (f64::from(i) + 0.5) / f64::from(AROUND);
                let d = DVec3::new(theta.sin() * around.cos(), theta.sin() * around.sin(), theta.cos());
                sum += self.radiance(theta, d.angle_between(self.sun)) * d.dot(normal).max(0.0) * solid;
            }
        }
        sum
    }
}

fn published(case: &mut Case) {
    for ([turbidity, albedo, elevation, theta, gamma], expected) in RADIANCES {
        let sun = DVec3::new(elevation.to_radians().cos(), elevation.to_radians().sin(), 0.0);
        let sky = HosekWilkieSky::new(turbidity, sun, Rgb::splat(albedo as f32), Rgb::ONE);
        let got = sky.at(theta.to_radians().cos(), gamma.to_radians().cos()).to_array();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let what = format!(
                "turbidity {turbidity}, albedo {albedo}, sun {elevation} high, {theta} from the zenith, {gamma} from the sun, {name}"
            );
            case.exact(what, got[channel], expected[channel], Within::Relative(3e-6));
        }
    }
    // The same light in a scene, in its own frame, by two of these places.
    for (number, direction) in [(2, DVec3::Z), (7, towards(45.0))] {
        let ([turbidity, albedo, elevation, ..], expected) = RADIANCES[number];
        let got = seen(&build(&under(clear(turbidity, elevation, albedo), 2.0)), direction).to_array();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let what = format!("twice the sky of turbidity {turbidity} in a scene, {name}");
            case.exact(what, got[channel], 2.0 * expected[channel], Within::Relative(3e-5));
        }
    }
    for ([turbidity, elevation], expected) in SUNS {
        let got = solar_radiance(turbidity, elevation.to_radians()).to_array();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let what = format!("the sun, turbidity {turbidity}, {elevation} high, {name}");
            let within = if expected[channel] == 0.0 { Within::Absolute(0.0) } else { Within::Relative(1e-6) };
            case.exact(what, got[channel], expected[channel], within);
        }
    }
}

fn points(case: &mut Case) {
    let point = etendue::math::Vec3::new(0.1, 0.2, 0.0);
    for (i, (turbidity, albedo)) in
        [(1.0, 0.0), (1.0, 1.0), (3.3, 0.3), (10.0, 0.0), (10.0, 1.0)].into_iter().enumerate()
    {
        for (j, elevation) in [0.0, 6.0, 45.0, 90.0].into_iter().enumerate() {
            // Each sky and each height, but not all of their pairs.
            if !case.is_full() && (i + j) % 2 != 0 {
                continue;
            }
            let what = |more: &str| format!("turbidity {turbidity}, albedo {albedo}, sun {elevation} high, {more}");
            let published = Published::new(turbidity, elevation, albedo);
            let horizontal = published.received(DVec3::Z);
            let (sine, cosine) = elevation.to_radians().sin_cos();
            let sky =
                HosekWilkieSky::new(turbidity, DVec3::new(cosine, sine, 0.0), Rgb::splat(albedo as f32), Rgb::ONE);
            case.exact(what("horizontal"), sky.horizontal().x, horizontal.x, Within::Relative(1e-4));
            let scene = build(&under(clear(turbidity, elevation, albedo), 2.0));
            // Below the horizon is the ground, which sends back what it gets.
            let ground = 2.0 * albedo * horizontal / PI;
            let nadir = seen(&scene, DVec3::new(0.6, 0.0, -0.8));
            let within = if albedo == 0.0 { Within::Absolute(0.0) } else { Within::Relative(1e-4) };
            case.exact(what("the ground"), nadir.y, ground.y, within);
            for (name, normal) in [("floor", DVec3::Z), ("wall", DVec3::new(0.8, 0.6, 0.0))] {
                // Half of what a wall sees is the ground.
                let exact = 2.0 * published.received(normal).x + (1.0 - normal.z) * 0.5 * PI * ground.x;
                let (mean, error) = irradiance(case, scene.emitters(), point, normal);
                case.mean(what(name), (mean * PI, error * PI), exact, 1e-3);
            }
        }
    }
    density(case);
    daylight(case);
}

/// The density of sampled directions, by all light and by what is above the mean, integrates to 1.
fn density(case: &mut Case) {
    const UP: u32 = 1024;
    for (turbidity, elevation) in [(1.0, 90.0), (2.0, 3.0), (10.0, 30.0)] {
        let (sine, cosine) = f64::to_radians(elevation).sin_cos();
        let sky = HosekWilkieSky::new(turbidity, DVec3::new(cosine, sine, 0.0), Rgb::splat(0.2), Rgb::ONE);
        let sky = Sky::Model(Box::new(sky));
        let map = EnvironmentMap::new(sky, &DMat3::IDENTITY, 2, &Cancel::new()).expect("not cancelled");
        let map = map.expect("light");
        for beside_bsdf in [false, true] {
            let mut sum = 0.0;
            for j in 0..UP {
                let theta = PI * (f64::from(j) + 0.5) / f64::from(UP);
                let solid = theta.sin() * PI / f64::from(UP) * PI / f64::from(UP);
                for i in 0..2 * UP {
                    let phi = PI * (f64::from(i) + 0.5) / f64::from(UP);
                    let d = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                    sum += f64::from(map.pdf(d.as_vec3a().normalize(), beside_bsdf)) * solid;
                }
            }
            let what = format!("density, turbidity {turbidity}, sun {elevation} high, beside a Bsdf: {beside_bsdf}");
            case.exact(what, sum, 1.0, Within::Relative(1e-4));
        }
    }
}

/// Illuminance outside, and that the sun does not count for it.
fn daylight(case: &mut Case) {
    let sky = HosekWilkieDesc { disk_deg: Some(0.533), ..clear(3.3, 45.0, 0.3) };
    let desc = under(sky, 1.0);
    let exact = 683.0 * Published::new(3.3, 45.0, 0.3).received(DVec3::Z).dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let settings = RenderSettings { desc: desc.render.clone(), ..RenderSettings::default() };
    let (lux, error) = exterior_illuminance(&desc, &settings).expect("a sky of the test");
    case.mean("turbidity 3.3, illuminance outside, lx", (lux, error), exact, 1e-3);
    let alone = daylight_only(&desc).expect("a sky of the test");
    let suns =
        [&desc, &alone].map(|desc| u64::from(desc.environment.as_ref().and_then(EnvironmentDesc::sun).is_some()));
    case.holds("suns of the scene, and by daylight alone", "[1, 0]", format!("{suns:?}"), suns == [1, 0]);
}

/// The disk: its irradiance by the closed form of its radiance, whatever its diameter.
fn sun(case: &mut Case) {
    let point = etendue::math::Vec3::new(0.3, -0.2, 0.0);
    for ([turbidity, elevation], radiance) in SUNS {
        let exact = across() * DVec3::from_array(radiance);
        let sky = |angle| HosekWilkieDesc { disk_deg: Some(angle), ..clear(turbidity, elevation, 0.0) };
        for angle in [0.0, 0.533, 8.0] {
            let what = |more: &str| format!("turbidity {turbidity}, {elevation} high, {angle} wide, {more}");
            let desc = under(sky(angle), 2.0);
            let light = desc.environment.as_ref().and_then(EnvironmentDesc::sun).expect("a sun");
            case.exact(what("across"), f64::from(light.irradiance.r()), 2.0 * exact.x, Within::Relative(1e-6));
            // Its radiance, in the middle of it, above that of the sky.
            if angle > 0.0 {
                let [with, without] = [desc, under(clear(turbidity, elevation, 0.0), 2.0)]
                    .map(|it| seen(&build(&it), towards(elevation)));
                let half = (0.5 * angle).to_radians().sin();
                let expected = 2.0 * exact.x / (PI * half * half);
                case.exact(what("seen"), with.x - without.x, expected, Within::Relative(1e-6));
            }
            // Alone on the floor.
            let mut desc = lit(1.0, 0.1, vec![]);
            desc.add_distant_light(DistantLightDesc { path: String::new(), ..light }).expect("a light of the test");
            let (mean, error) = irradiance(case, build(&desc).emitters(), point, DVec3::Z);
            let half = (0.5 * angle).to_radians().sin();
            let tilt = (90.0 - elevation).to_radians();
            let expected =
                if angle == 0.0 { exact.x * tilt.cos() } else { exact.x / (half * half) * sphere_factor(half, tilt) };
            if expected > 1e-3 {
                case.mean(what("floor"), (mean * PI, error * PI), 2.0 * expected, 1e-2);
            }
        }
    }
    // The ground is lit by the sun too, where there is one.
    let sky = HosekWilkieDesc { disk_deg: Some(0.533), ..clear(3.0, 30.0, 0.3) };
    let by_sky = Published::new(3.0, 30.0, 0.3).received(DVec3::Z);
    let by_sun = across() * DVec3::from_array(SUNS[3].1) * 0.5;
    let got = seen(&build(&under(sky, 2.0)), DVec3::new(0.0, 0.6, -0.8));
    case.exact("the ground in the sun", got.y, 2.0 * 0.3 / PI * (by_sky + by_sun).y, Within::Relative(1e-5));
}

fn pictures(case: &mut Case) {
    let samples = case.count(16, 256) as u32;
    // The place in the list of suns, albedo and diameter of the disk.
    for (number, albedo, angle) in [(1, 0.0, 0.533_f64), (3, 0.3, 8.0), (7, 1.0, 0.533)] {
        let ([turbidity, elevation], radiance) = SUNS[number];
        let half = (0.5 * angle).to_radians().sin();
        // Of a disk on the horizon half is above it.
        let factor = sphere_factor(half, (90.0 - elevation).to_radians()) / (half * half);
        let by_sun = across() * DVec3::from_array(radiance) * factor;
        let by_sky = Published::new(turbidity, elevation, albedo).received(DVec3::Z);
        let exact = 2.0 * (by_sky + by_sun).element_sum() / 3.0 / PI;
        let sky = HosekWilkieDesc { disk_deg: Some(angle), ..clear(turbidity, elevation, albedo) };
        let desc = under(sky, 2.0);
        let others = [(IntegratorDesc::Radiosity, 5e-3), (IntegratorDesc::Ppm, 1e-2), (IntegratorDesc::Auto, 0.0)];
        for (integrator, bias) in METHODS.into_iter().chain(others) {
            let means = mean_and_error(&drawn(case, &desc, integrator, samples));
            let what = format!("turbidity {turbidity}, sun {elevation} high, by {integrator:?}");
            case.biased_mean(what, means, exact, (bias.max(1e-4), 1e-2));
        }
    }
}
