//! Texture coordinates that projections of the world give, against the formulas that the document states.

use etendue::desc::{BsdfDesc, Projection, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping};
use etendue::desc::{ShapeDesc, TextureSource};
use etendue::math::DVec3;
use etendue::spectrum::Rgb;
use etendue::texture::{Pattern, Procedural};

use crate::common::scenes::{Job, camera, mean_and_error, point_light, render, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "X15", title: "projections of the world", run: projections }]
}

const PI: f64 = std::f64::consts::PI;

/// The mean over a square [-1, 1]^2 by the rule of the middle.
fn mean_over_square(f: impl Fn(f64, f64) -> f64) -> f64 {
    const N: u32 = 512;
    let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0;
    let sum: f64 = (0..N).flat_map(|i| (0..N).map(move |j| (i, j))).map(|(i, j)| f(place(i), place(j))).sum();
    sum / f64::from(N * N)
}

/// A ramp from 0 at a coordinate of -1 to 1 at 1: u, or v where the coordinates are turned.
fn ramp(projection: Projection, is_of_v: bool) -> TextureDesc {
    let rotation = if is_of_v { -0.5 * PI } else { 0.0 };
    TextureDesc {
        name: "ramp".into(),
        path: String::new(),
        source: TextureSource::Procedural(Procedural {
            pattern: Pattern::Gradient,
            colors: [Rgb::ZERO, Rgb::ONE],
            in_space: false,
        }),
        mapping: TextureMapping::Projected { projection, scale: [0.5; 2], rotation, offset: [0.5; 2] },
        vertex_colors: false,
    }
}

/// Squares that face along the axes, and one that does not, with ramps of albedo and of height under a point light.
fn projections(case: &mut Case) {
    let samples = case.count(64, 1024) as u32;
    let mut shown = |what: &str,
                     [e1, e2]: [DVec3; 2],
                     key: TextureKey,
                     texture: TextureDesc,
                     f: &dyn Fn(f64, f64) -> (f64, DVec3)| {
        let normal = e1.cross(e2);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[a, b]| a * e1 + b * e2);
        let white = BsdfDesc::Lambert { albedo: Rgb::ONE };
        let light = 2.0 * normal + 1.5 * e1 + e2;
        let mut desc = scene(camera(normal, DVec3::ZERO, 90.0), vec![(ShapeDesc::Quad(corners), white, None)]);
        desc.lights.push(point_light(light, 10.0));
        let texture = desc.add_texture(texture).expect("a texture of the test");
        let binding = TextureBinding { key, texture, channel: TextureChannel::Default, strength: 0.8, cutoff: 0.0 };
        desc.set_material_textures(0, vec![binding]).expect("a binding of the test");
        let (image, _) = render(&desc, &Job { samples, ..Job::default() });
        let exact = mean_over_square(|a, b| {
            let way = light - (a * e1 + b * e2);
            let (albedo, normal) = f(a, b);
            albedo / PI * 10.0 * normal.dot(way.normalize()).max(0.0) / way.length_squared()
        });
        let (mean, error) = mean_and_error(&image);
        case.mean(what, (mean, error.max(1e-6 * exact)), exact, 2e-3);
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    // From outside of each side the first direction goes to the right and the second one up.
    let sides = [("x", [-z, y]), ("-x", [z, y]), ("y", [x, -z]), ("-y", [x, z]), ("z", [x, y]), ("-z", [-x, y])];
    for (side, axes) in sides {
        let normal = axes[0].cross(axes[1]);
        for is_of_v in [false, true] {
            let name = if is_of_v { "v" } else { "u" };
            let of_ramp = |a: f64, b: f64| (0.5 + 0.5 * if is_of_v { b } else { a }, normal);
            shown(
                &format!("{name} from the side of {side}"),
                axes,
                TextureKey::Color,
                ramp(Projection::Box, is_of_v),
                &of_ramp,
            );
        }
    }
    for (name, projection, axes) in
        [("x", Projection::X, [-z, y]), ("y", Projection::Y, [x, -z]), ("z", Projection::Z, [x, y])]
    {
        for is_of_v in [false, true] {
            let what = format!("{} along {name}", if is_of_v { "v" } else { "u" });
            let of_ramp = |a: f64, b: f64| (0.5 + 0.5 * if is_of_v { b } else { a }, axes[0].cross(axes[1]));
            shown(&what, axes, TextureKey::Color, ramp(projection, is_of_v), &of_ramp);
        }
    }
    // A slope of 3 in 4, seen from above: x grows by 0.8 for each unit along it, and a height of 0.8 by half of that.
    let axes = [DVec3::new(0.8, -0.6, 0.0), -z];
    let normal = axes[0].cross(axes[1]);
    let tilted = (normal - 0.8 * 0.5 * 0.8 * axes[0]).normalize();
    shown("height on a slope", axes, TextureKey::Bump, ramp(Projection::Y, false), &|_, _| (1.0, tilted));
    let on_slope = |a: f64, _: f64| (0.5 + 0.5 * 0.8 * a, normal);
    shown("u on a slope", axes, TextureKey::Color, ramp(Projection::Y, false), &on_slope);
}
