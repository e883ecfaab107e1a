//! Balls that shine, whose radiance a texture varies.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use etendue::desc::{
    BsdfDesc, IntegratorDesc, Projection, SceneDesc, ShapeDesc, TextureDesc, TextureKey, TextureMapping, TextureSource,
};
use etendue::math::{DAffine3, DMat3, DVec3, Ray, Vec3};
use etendue::render::{Render, RenderSettings};
use etendue::sampling::Rng;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, Pattern, Procedural, TextureFilter};

use super::emission::METHODS;
use super::scenes::{quad, vary};
use super::{Mean, described, image};
use crate::common::scenes::{Job, add, box_inside, camera, mean_and_error, render, render_scene, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "X18", title: "textured balls that shine, by points", run: points },
        Entry { id: "X19", title: "textured balls that shine, whole pictures", run: pictures },
    ]
}

/// The ball in its own frame, and what places it: turned, in a mirror and twice as large.
const OWN: (DVec3, f64) = (DVec3::new(0.1, 0.0, -0.05), 0.2);
const FACTOR: f64 = 2.0;

fn placed() -> DAffine3 {
    let turn = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(-0.4);
    DAffine3 {
        matrix3: turn * DMat3::from_diagonal(DVec3::new(-2.0, 2.0, 2.0)),
        translation: DVec3::new(0.1, 1.1, -0.2),
    }
}

/// The radiances of 8 x 4 squares over their factor, columns to the right and rows from the top.
fn square(x: u32, y: u32) -> f64 {
    match 8 * y + x {
        5 | 19 => 4.0,
        i if i % 3 == 0 => 0.0,
        i => 0.04 * f64::from(i),
    }
}

/// How the texture lies on the ball.
#[derive(Clone, Copy)]
pub(super) enum Way {
    /// By the ball's own coordinates.
    Own,
    /// By a projection of the world along z, with so many images in a length.
    Projected(f64),
    /// A ramp along the world's x.
    Ramp,
    /// One square of 512 x 256 shines.
    Spot,
    /// All squares are dark.
    Dark,
    /// A texture of one value.
    Even,
}

const SPOT: [u32; 2] = [300, 100];

impl Way {
    fn texture(self) -> TextureDesc {
        let squares = image(8, 4, 3, |x, y, c| square(x, y) as f32 * [1.0, 0.5, 0.25][c as usize]);
        let described = |image, scale| described("lamp", image, ColorSpace::Linear, TextureFilter::Nearest, scale);
        match self {
            Self::Own => described(&squares, 1.0),
            Self::Projected(scale) => TextureDesc {
                mapping: TextureMapping::Projected {
                    projection: Projection::Z,
                    scale: [scale; 2],
                    rotation: 0.0,
                    offset: [0.25, 0.5],
                },
                ..described(&squares, 1.0)
            },
            Self::Ramp => {
                let colors = [Rgb::ZERO, Rgb::new(1.0, 0.5, 0.25)];
                let ramp = Procedural { pattern: Pattern::Gradient, colors, in_space: true };
                TextureDesc {
                    source: TextureSource::Procedural(ramp),
                    mapping: TextureMapping::Space { scale: DVec3::splat(1.2), offset: DVec3::splat(0.5) },
                    ..described(&squares, 1.0)
                }
            }
            Self::Spot => described(&image(512, 256, 1, |x, y, _| if [x, y] == SPOT { 1e4 } else { 0.0 }), 1.0),
            Self::Even => described(&image(8, 4, 1, |_, _, _| 1.0), 1.0),
            Self::Dark => described(&image(8, 4, 1, |_, _, _| 0.0), 1.0),
        }
    }

    /// Radiance in red at a point of the ball, and at the direction of it in the ball's own frame.
    fn radiance(self, p: DVec3, d: DVec3) -> f64 {
        let uv = [0.5 + d.x.atan2(d.z) / TAU, 0.5 + d.y.asin() / PI];
        let texel = |uv: [f64; 2], [width, height]: [u32; 2]| {
            let [x, y] =
                [(uv[0], width), (uv[1], height)].map(|(x, n)| (((x - x.floor()) * f64::from(n)) as u32).min(n - 1));
            [x, height - 1 - y]
        };
        FACTOR
            * match self {
                Self::Own => {
                    let [x, y] = texel(uv, [8, 4]);
                    square(x, y)
                }
                Self::Projected(scale) => {
                    let [x, y] = texel([scale * p.x + 0.25, scale * p.y + 0.5], [8, 4]);
                    square(x, y)
                }
                Self::Ramp => (1.2 * p.x + 0.5).clamp(0.0, 1.0),
                Self::Spot => f64::from(u8::from(texel(uv, [512, 256]) == SPOT)) * 1e4,
                Self::Dark => 0.0,
                Self::Even => 1.0,
            }
    }

    /// Irradiance in red at a point that looks up.
    pub(super) fn irradiance(p: DVec3) -> f64 {
        Self::Own.integral(|q, n| transfer(p, q, n))
    }

    /// The sum over all of the ball of radiance times `weight` of the point and the normal there, times its area.
    fn integral(self, weight: impl Fn(DVec3, DVec3) -> f64) -> f64 {
        const N: u32 = 2048;
        let to_world = placed();
        let (centre, radius) = (to_world.transform_point3(OWN.0), 2.0 * OWN.1);
        let mut sum = 0.0;
        for row in 0..N / 2 {
            let latitude = PI * ((f64::from(row) + 0.5) / f64::from(N / 2) - 0.5);
            let (y, level) = latitude.sin_cos();
            for column in 0..N {
                let longitude = TAU * ((f64::from(column) + 0.5) / f64::from(N) - 0.5);
                let d = DVec3::new(level * longitude.sin(), y, level * longitude.cos());
                let n = 0.5 * (to_world.matrix3 * d);
                let p = centre + radius * n;
                sum += level * self.radiance(p, d) * weight(p, n);
            }
        }
        sum * radius * radius * TAU / f64::from(N) * PI / f64::from(N / 2)
    }
}

/// Irradiance at a point with the normal y by a small area with the normal `n` at `q`, of radiance and area 1.
fn transfer(p: DVec3, q: DVec3, n: DVec3) -> f64 {
    let way = q - p;
    way.y.max(0.0) * (-way.dot(n)).max(0.0) / way.length_squared().powi(2)
}

/// A white floor at the height 0 below the ball.
pub(super) fn lamp(way: Way) -> SceneDesc {
    let ball = ShapeDesc::Sphere { centre: OWN.0, radius: OWN.1 };
    let floor = quad([[-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]]);
    let white = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let view = camera(DVec3::new(0.0, 0.45, 0.0), DVec3::ZERO, 90.0);
    let mut desc = scene(view, vec![(ball, BsdfDesc::Black, None), (floor, white, None)]);
    desc.surfaces[0].transform = placed();
    desc.materials[0].emission = Some(Rgb::splat(FACTOR as f32));
    vary(&mut desc, 0, TextureKey::Emission, way.texture());
    desc
}

/// The ball in a closed room without the floor.
pub(super) fn room(albedo: f32) -> SceneDesc {
    let mut room = lamp(Way::Own);
    room.surfaces[1].hidden = true;
    room.meshes.push(box_inside(DVec3::splat(-1.5), DVec3::splat(1.5)).into());
    let white = BsdfDesc::Lambert { albedo: Rgb::splat(albedo) };
    add(&mut room, 2, ShapeDesc::Mesh { mesh: 0, smooth: false }, white, None);
    room
}

/// Powers, light samples, rays that meet the ball and places from which photons leave, against sums over the ball.
fn points(case: &mut Case) {
    let count = case.count(200_000, 4_000_000) as u32;
    let ways = [
        ("by its own coordinates", Way::Own, 2e-3),
        ("projected", Way::Projected(3.0), 1e-2),
        ("a ramp in space", Way::Ramp, 2e-3),
    ];
    for (how, way, within) in ways {
        let built = Scene::build(&lamp(way), &BuildOptions::default()).expect("a scene of the test");
        let [emitter] = built.emitters().emitters() else { panic!("a ball is one emitter") };
        let exact = PI * way.integral(|_, _| 1.0);
        case.exact(format!("power, {how}"), emitter.power().x, exact, Within::Relative(within));
        let centre = placed().transform_point3(OWN.0);
        let mut rng = Rng::new(11, 0);
        for (x, z) in [(0.3, -0.2), (1.2, 0.4)] {
            let p = DVec3::new(x, 0.0, z);
            let at = built.to_scene(p);
            let axis = (centre - p).normalize();
            let one_minus_cos = 1.02 * (1.0 - (1.0 - (2.0 * OWN.1 / p.distance(centre)).powi(2)).sqrt());
            let (mut light, mut met) = (Mean::default(), Mean::default());
            for _ in 0..count {
                let u = [rng.next_f32(), rng.next_f32(), rng.next_f32(), rng.next_f32()];
                if let Some(sample) = built.emitters().sample(at, u) {
                    light.add(f64::from(sample.radiance.r() * sample.wi.y.max(0.0) / sample.pdf));
                }
                // Directions in a cone around the ball.
                let cos = 1.0 - f64::from(u[1]) * one_minus_cos;
                let (sin, phi) = ((1.0 - cos * cos).sqrt(), TAU * f64::from(u[2]));
                let (s, t) = axis.any_orthonormal_pair();
                let wi = (cos * axis + sin * (phi.cos() * s + phi.sin() * t)).as_vec3a();
                let ray = Ray::new(at + 1e-4 * Vec3::Y, wi);
                let Some(hit) = built.intersect(&ray) else { continue };
                let surface = built.interaction(&ray, &hit);
                let Some(number) = surface.emitter else { continue };
                let le = built.emitters().le(number, surface.ng, -wi, surface.point.p);
                met.add(TAU * one_minus_cos * f64::from(le.r() * wi.y));
            }
            let exact = way.integral(|q, n| transfer(p, q, n));
            case.mean(format!("light samples at ({x}, {z}), {how}"), light.of(count), exact, 6e-3);
            case.mean(format!("rays from ({x}, {z}), {how}"), met.of(count), exact, 6e-3);
        }
        departures(case, how, way, count, 6e-3);
    }
    let even = Scene::build(&lamp(Way::Even), &BuildOptions::default()).expect("a scene of the test");
    let mut plain = lamp(Way::Even);
    plain.materials[0].textures.clear();
    let plain = Scene::build(&plain, &BuildOptions::default()).expect("a scene of the test");
    let mut rng = Rng::new(13, 0);
    let differing = (0..10_000)
        .filter(|_| {
            let u = [rng.next_f32(), rng.next_f32(), rng.next_f32(), rng.next_f32()];
            let [a, b] = [&even, &plain].map(|built| {
                let sample = built.emitters().sample(built.to_scene(DVec3::new(0.4, 0.1, 0.3)), u);
                sample.map(|it| (it.wi, it.target, it.radiance.to_array().map(f32::to_bits), it.pdf.to_bits()))
            });
            a != b
        })
        .count();
    case.exact("light samples of one value that differ", f64::from(differing as u32), 0.0, Within::Absolute(0.0));
    departures(case, "of which a texel shines", Way::Spot, count, 5e-2);
    let dark = Scene::build(&lamp(Way::Dark), &BuildOptions::default()).expect("a scene of the test");
    let power = dark.emitters().emitters().iter().map(|emitter| emitter.power().x).sum();
    case.exact("power of a ball that is dark everywhere", power, 0.0, Within::Absolute(0.0));
    case.holds("a ball that is dark everywhere", "no light", "light", dark.emitters().is_dark());
}

/// The power that photons take along, and how much of it leaves from the upper part of the ball.
fn departures(case: &mut Case, how: &str, way: Way, count: u32, within: f64) {
    let built = Scene::build(&lamp(way), &BuildOptions::default()).expect("a scene of the test");
    let [emitter] = built.emitters().emitters() else { panic!("a ball is one emitter") };
    let (mut all, mut upper) = (Mean::default(), Mean::default());
    let mut rng = Rng::new(12, 0);
    for _ in 0..count {
        let departure = emitter.sample_departure([rng.next_f32(), rng.next_f32()]);
        let power = emitter.power_from(&departure).x;
        let height = f64::from(departure.normal.expect("a ball has normals").y);
        all.add(power);
        upper.add(power * (1.0 + height));
    }
    case.mean(format!("photons, {how}"), all.of(count), PI * way.integral(|_, _| 1.0), within);
    let exact = PI * way.integral(|_, n| 1.0 + n.y);
    case.mean(format!("photons by where they leave, {how}"), upper.of(count), exact, within);
}

/// The floor below the ball by all methods that draw it, and a closed room.
fn pictures(case: &mut Case) {
    let samples = case.count(64, 512) as u32;
    let floor = lamp(Way::Own);
    // The part of the floor that the camera sees; the floor goes on around it.
    const N: u32 = 16;
    let place = |i: u32| 0.45 * (2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0);
    let seen: Vec<DVec3> = (0..N * N).map(|i| DVec3::new(place(i % N), 0.0, place(i / N))).collect();
    let mean = |q, n| seen.iter().map(|p| transfer(*p, q, n)).sum::<f64>() / f64::from(N * N);
    let reflected = 0.5 / PI * Way::Own.integral(mean) * (1.0 + 0.5 + 0.25) / 3.0;
    let further = [(IntegratorDesc::PhotonDirect, 1e-2), (IntegratorDesc::Ppm, 1e-2)];
    for (integrator, within) in METHODS.into_iter().chain(further) {
        let (image, _) = render(&floor, &Job { samples, integrator, ..Job::default() });
        let name = format!("the floor by {integrator:?}");
        // The mean over the floor is a sum over a few points.
        case.biased_mean(&name, mean_and_error(&image), reflected, (1e-3, within));
    }
    rooms(case, samples);
}

/// A closed room by all methods that store light, against paths; and the same bits from any number of threads.
fn rooms(case: &mut Case, samples: u32) {
    let built = Scene::build(&room(0.8), &BuildOptions::default()).expect("a scene of the test");
    let of = |integrator, samples| {
        let mut desc = Job { samples, integrator, ..Job::default() }.desc();
        // The cache's own error is 1.5 % at its defaults, by its probes.
        (desc.cache.error, desc.cache.max_spacing) = (0.05, 0.02);
        mean_and_error(&render_scene(&built, desc).0)
    };
    let (paths, error) = of(IntegratorDesc::Path, case.count(1024, 8192) as u32);
    for integrator in [
        IntegratorDesc::IrradianceCache,
        IntegratorDesc::Photon,
        IntegratorDesc::Ppm,
        IntegratorDesc::Sppm,
        IntegratorDesc::Radiosity,
    ] {
        let (mean, own) = of(integrator, samples);
        let both = own.hypot(error);
        case.biased_mean(format!("a room by {integrator:?}"), (mean, both), paths, (1e-2, 1e-2));
    }
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
        let pictures = [1, 3].map(|threads| {
            let desc = Job { samples: 4, integrator, ..Job::default() }.desc();
            let mut render = Render::new(&built, RenderSettings { desc, threads, ..RenderSettings::default() })
                .expect("settings of the test");
            render.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
            render.image()
        });
        let pairs = pictures[0].rgb.iter().zip(&pictures[1].rgb);
        let differing = pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        case.exact(
            format!("threads, {integrator:?}: values that differ"),
            differing as f64,
            0.0,
            Within::Absolute(0.0),
        );
    }
}
