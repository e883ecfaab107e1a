//! What filters do with normals: the roughness of what they average.

use etendue::desc::{
    BsdfDesc, ConductorDesc, Distribution, MicrofacetsDesc, PrincipledDesc, SceneDesc, TextureBinding, TextureChannel,
    TextureKey,
};
use etendue::math::DVec3;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;
use etendue::texture::{ColorSpace, TextureFilter};

use super::scenes::quad;
use super::{described, image};
use crate::common::scenes::{Job, camera, mean_and_error, point_light, render, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "X21", title: "roughness of averaged normals", run: averaged }]
}

/// Texels along a side.
const SIDE: u32 = 128;

/// Standard deviation of the slopes along either direction.
const SPREAD: f64 = 0.12;

/// How often the image is repeated along a side of the square.
const REPEATS: f64 = 16.0;

/// Waves in all directions, whose sum has slopes that are nearly of a normal distribution: heights and both slopes at a place of the
/// image, whose sides have the length 1.
fn waves() -> impl Fn(f64, f64) -> [f64; 3] {
    const COUNT: u32 = 24;
    let mut rng = Rng::new(5, 1);
    let mut waves = Vec::new();
    for i in 0..COUNT {
        let turn = std::f64::consts::PI * (f64::from(i) + f64::from(rng.next_f32())) / f64::from(COUNT);
        let length = 4.0 + 3.0 * f64::from(rng.next_f32());
        let [u, v] = [turn.cos(), turn.sin()].map(|x| (length * x).round());
        let phase = std::f64::consts::TAU * f64::from(rng.next_f32());
        // Each wave gives the same share of the variance of slopes, (a k)^2 / 2 along its way.
        let steepness = SPREAD * (4.0 / f64::from(COUNT)).sqrt();
        let k = std::f64::consts::TAU * u.hypot(v);
        waves.push((std::f64::consts::TAU * u, std::f64::consts::TAU * v, phase, steepness / k));
    }
    move |x, y| {
        let mut sum = [0.0; 3];
        for (u, v, phase, height) in &waves {
            let (sin, cos) = (u * x + v * y + phase).sin_cos();
            sum = [sum[0] + height * sin, sum[1] + height * u * cos, sum[2] + height * v * cos];
        }
        sum
    }
}

/// A metal square with many small bumps, seen from above and lit from all sides but by one small light, whose reflection is as wide as
/// the facets and the bumps together. The picture of averaged normals is compared with the one of the normals themselves.
fn averaged(case: &mut Case) {
    let waves = waves();
    let place = |x: u32, y: u32| {
        let [u, v] = [x, SIDE - 1 - y].map(|i| (f64::from(i) + 0.5) / f64::from(SIDE));
        waves(u, v)
    };
    let normals = image(SIDE, SIDE, 3, |x, y, c| {
        let [_, du, dv] = place(x, y);
        let normal = DVec3::new(-du, -dv, 1.0).normalize();
        (0.5 * normal[c as usize] + 0.5) as f32
    });
    let heights = image(SIDE, SIDE, 1, |x, y, _| place(x, y)[0] as f32);
    // The side of an image on the square, which is 2 wide: heights are in these lengths.
    let length = (2.0 / REPEATS) as f32;
    let reliefs = [("normals", &normals, TextureKey::Normal, 1.0), ("heights", &heights, TextureKey::Bump, length)];

    let facets = |distribution| MicrofacetsDesc { distribution, ..MicrofacetsDesc::rough(0.45) };
    let metal = |distribution| BsdfDesc::Conductor {
        conductor: ConductorDesc::Reflectance { normal: Rgb::splat(0.8), edge: Rgb::ONE },
        microfacets: facets(distribution),
    };
    let coated = BsdfDesc::Principled(PrincipledDesc {
        base_color: Rgb::ZERO,
        coat_weight: 1.0,
        coat_roughness: 0.45,
        specular_weight: 0.0,
        ..PrincipledDesc::default()
    });
    // The sum of GGX's slopes and normally distributed ones is no GGX again: the one with wider facets is too high in its middle by
    // up to 24 %, where both spreads are alike. Wider ones yet would fit there and be worse elsewhere.
    let models = [
        ("Beckmann", metal(Distribution::Beckmann), 0.04),
        ("GGX", metal(Distribution::Ggx), 0.26),
        ("coat", coated, 0.26),
    ];
    let samples = case.count(256, 4096) as u32;
    for (model, bsdf, bias) in models {
        for (what, image, key, strength) in reliefs {
            for degrees in [0.0_f64, 20.0, 40.0] {
                let shown = |filter: TextureFilter, samples: u32| {
                    let square = quad([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
                    let mut desc: SceneDesc =
                        scene(camera(DVec3::new(0.0, 0.0, 40.0), DVec3::ZERO, 2.5), vec![(square, bsdf, None)]);
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    desc.lights.push(point_light(30.0 * DVec3::new(sin, 0.0, cos), 900.0));
                    let texture = described("relief", image, ColorSpace::Raw, filter, REPEATS);
                    let texture = desc.add_texture(texture).expect("a texture of the test");
                    let (channel, cutoff) = (TextureChannel::Default, 0.0);
                    let binding = TextureBinding { key, texture, channel, strength, cutoff };
                    desc.set_material_textures(0, vec![binding]).expect("a binding of the test");
                    let job = Job { samples, resolution: [4, 4], ..Job::default() };
                    mean_and_error(&render(&desc, &job).0)
                };
                let (exact, error) = shown(TextureFilter::Bilinear, 16 * samples);
                for filter in [TextureFilter::Mip, TextureFilter::Ewa] {
                    let (mean, own) = shown(filter, samples / 16);
                    let label = format!("{model}, {what}, {filter:?}, {degrees} degrees");
                    case.biased_mean(label, (mean, own.hypot(error)), exact, (bias, 1e-2));
                }
            }
        }
    }
}
