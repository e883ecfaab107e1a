//! Pixel filters: their published values, what is drawn from them, and what they make of flat fields, edges and small
//! lights.

use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FilterDesc, FovAxis, MeshDesc, RenderDesc, SamplerDesc, SceneDesc, ShapeDesc,
};
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::sampling::{Filter, Rng};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use crate::common::scenes::{box_inside, render_scene, scene};
use crate::record::{Case, Entry, Within};
use crate::stats::{check_density, mean_and_error};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "P52", title: "Filters: values and integrals", run: values },
        Entry { id: "P52b", title: "Filters: what is drawn", run: drawn },
        Entry { id: "P52c", title: "Filters: a constant image", run: constant },
        Entry { id: "P52d", title: "Filters: a small light", run: impulse },
        Entry { id: "P52e", title: "Filters: an edge", run: edge },
    ]
}

const MITCHELL: FilterDesc = FilterDesc::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };

fn filters() -> [(&'static str, FilterDesc); 8] {
    [
        ("box", FilterDesc::Box),
        ("tent", FilterDesc::Tent),
        ("Gaussian, σ 0.5", FilterDesc::Gaussian { sigma: 0.5 }),
        ("Gaussian, σ 0.2", FilterDesc::Gaussian { sigma: 0.2 }),
        ("Blackman-Harris", FilterDesc::BlackmanHarris),
        ("Mitchell", MITCHELL),
        ("Catmull-Rom", FilterDesc::Mitchell { b: 0.0, c: 0.5 }),
        ("B-spline", FilterDesc::Mitchell { b: 1.0, c: 0.0 }),
    ]
}

/// A filter along one axis. It is separable, and the square root of its centre is that of one axis.
fn along_x(filter: &Filter) -> impl Fn(f64) -> f64 {
    let centre = f64::from(filter.evaluate(0.0, 0.0)).sqrt();
    move |x| f64::from(filter.evaluate(x as f32, 0.0)) / centre
}

/// Integral by the midpoint rule over [from, to].
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64, points: u32) -> f64 {
    let h = (to - from) / f64::from(points);
    (0..points).map(|i| f(from + (f64::from(i) + 0.5) * h) * h).sum()
}

fn values(case: &mut Case) {
    let mitchell = Filter::new(&MITCHELL);
    for (x, exact) in [(0.0, 8.0 / 9.0), (0.5, 77.0 / 144.0), (1.0, 1.0 / 18.0), (1.5, -5.0 / 144.0)] {
        case.exact(format!("Mitchell at {x}"), along_x(&mitchell)(x), exact, Within::Relative(1e-6));
    }
    case.exact("Mitchell at its end", along_x(&mitchell)(2.0), 0.0, Within::Absolute(1e-6));
    let gaussian = Filter::new(&FilterDesc::Gaussian { sigma: 0.5 });
    // The mass of the whole normal density within 1 of 0.954499736104 and within its end at 1.5 of 0.997300203937.
    let within = integral(along_x(&gaussian), -1.0, 1.0, 4000);
    case.exact("Gaussian, σ 0.5: mass within 1", within, 0.954499736104 / 0.997300203937, Within::Relative(1e-6));
    // Sums of the window's coefficients, over its integral 4 x 0.35875.
    let window = Filter::new(&FilterDesc::BlackmanHarris);
    for (x, sum) in [(0.0, 1.0), (0.5, 0.69576415563), (1.0, 0.21747), (1.5, 0.02173584437)] {
        let exact = sum / (4.0 * 0.35875);
        case.exact(format!("Blackman-Harris at {x}"), along_x(&window)(x), exact, Within::Relative(2e-6));
    }
    case.exact(
        "tent at (0.25, -0.5)",
        f64::from(Filter::new(&FilterDesc::Tent).evaluate(0.25, -0.5)),
        0.375,
        Within::Ulps(1.0),
    );
    for (name, desc) in filters() {
        let filter = Filter::new(&desc);
        let radius = f64::from(filter.radius());
        let total = integral(along_x(&filter), -radius, radius, 4000);
        case.exact(format!("{name}: integral"), total * total, 1.0, Within::Absolute(1e-6));
        let outside = filter.radius() * 1.001;
        let beyond = filter.evaluate(outside, 0.0).abs() + filter.evaluate(0.0, -outside).abs();
        case.exact(format!("{name}: beyond its radius"), f64::from(beyond), 0.0, Within::Absolute(0.0));
    }
}

fn drawn(case: &mut Case) {
    let draws = case.count(60_000, 3_000_000) as usize;
    for (i, (name, desc)) in filters().into_iter().enumerate() {
        let filter = Filter::new(&desc);
        let radius = f64::from(filter.radius());
        // Where a filter is negative its magnitude is drawn from.
        let magnitude = integral(|x| along_x(&filter)(x).abs(), -radius, radius, 4000).powi(2);
        let density = |x: f64, y: f64| f64::from(filter.evaluate(x as f32, y as f32)).abs() / magnitude;
        let mut rng = Rng::new(12, i as u64);
        let mut weights = Vec::with_capacity(draws);
        let (mut signs, mut off) = (0, 0.0_f64);
        let draw = || {
            let ([x, y], weight) = filter.sample(rng.next_2d());
            weights.push(f64::from(weight));
            let value = filter.evaluate(x, y);
            // The sign of the weight is that of the filter, but for rounding right at a root.
            signs += u64::from(value * weight < 0.0 && value.abs() > 1e-5);
            off = off.max((f64::from(weight.abs()) / magnitude - 1.0).abs());
            (f64::from(x), f64::from(y), density(f64::from(x), f64::from(y)))
        };
        let check = check_density((32, 32), ((-radius, radius), (-radius, radius)), draws, draw, density);
        case.p_value(format!("{name}: 32 x 32 counts of samples"), check.p_value, filters().len());
        case.never(format!("{name}: weight of the wrong sign"), signs, draws as u64);
        case.exact(format!("{name}: weight over magnitude"), 1.0 + off, 1.0, Within::Relative(1e-5));
        if magnitude > 1.0 + 1e-4 {
            case.mean(format!("{name}: mean weight"), mean_and_error(&weights), 1.0, 0.01);
        }
    }
}

/// A flat light of the plane z = -1, in pixels of [`film`]: columns, and rows from the top.
fn light(columns: [f64; 2], rows: [f64; 2]) -> SceneDesc {
    let point = |x: f64, y: f64| DVec3::new(x / 16.5 - 1.0, (8.5 - y) / 16.5, -1.0);
    let positions = vec![
        point(columns[0], rows[0]),
        point(columns[0], rows[1]),
        point(columns[1], rows[1]),
        point(columns[1], rows[0]),
    ];
    let camera = CameraDesc::Perspective {
        eye: DVec3::ZERO,
        look_at: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_deg: 90.0,
        fov_axis: FovAxis::Horizontal,
        film: FilmDesc::default(),
    };
    let black = BsdfDesc::Lambert { albedo: Rgb::ZERO };
    let mut desc = scene(camera, vec![(ShapeDesc::Mesh { mesh: 0, smooth: false }, black, Some(Rgb::ONE))]);
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = MeshDesc { name: "light".into(), path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() };
    desc.meshes.push(mesh.into());
    desc
}

/// More than one tile across, and neither side a multiple of a tile's.
const SIZE: [u32; 2] = [33, 17];

fn film(desc: &SceneDesc, filter: FilterDesc, samples: u64, seed: u64) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    render_scene(
        &scene,
        RenderDesc { resolution: SIZE, samples: samples as u32, filter, seed, ..RenderDesc::default() },
    )
    .0
}

fn constant(case: &mut Case) {
    let black = BsdfDesc::Lambert { albedo: Rgb::ZERO };
    let mut desc = light([0.0; 2], [0.0; 2]);
    desc.meshes = vec![box_inside(DVec3::splat(-1.0), DVec3::ONE).into()];
    desc.materials[0].bsdf = black;
    desc.surfaces[0].emission = Some(Rgb::new(1.0, 0.7, 1e-3));
    let built = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
    let samples = case.count(5, 100) as u32;
    let patterns = [SamplerDesc::Random, SamplerDesc::Jittered, SamplerDesc::Grid, SamplerDesc::Gaussian];
    let all = filters().map(|(name, filter)| (name.to_owned(), filter, SamplerDesc::Sobol)).into_iter();
    let all = all.chain(patterns.map(|sampler| (format!("{sampler:?}, box"), FilterDesc::Box, sampler)));
    for (name, filter, sampler) in all {
        let desc = RenderDesc { resolution: SIZE, samples, filter, sampler, ..RenderDesc::default() };
        let image = render_scene(&built, desc).0;
        let off = |pixel: &[f32]| {
            let exact = [1.0_f32, 0.7, 1e-3].map(f64::from);
            pixel.iter().zip(exact).map(|(value, exact)| (f64::from(*value) / exact - 1.0).abs()).fold(0.0, f64::max)
        };
        let worst = image.rgb.chunks_exact(3).map(off).fold(0.0, f64::max);
        case.exact(format!("{name}: worst pixel"), 1.0 + worst, 1.0, Within::Absolute(2e-6));
    }
}

/// Mean and standard error over several seeds.
fn over_seeds(seeds: u64, measure: impl Fn(u64) -> f64) -> (f64, f64) {
    mean_and_error(&(0..seeds).map(measure).collect::<Vec<_>>())
}

fn impulse(case: &mut Case) {
    // Of 2 x 1 pixels, none of its sides on a pixel's, and its light across the seam of four tiles: any filter of integral 1
    // keeps its energy, since shifts of a filter by whole pixels add up to 1 over whole pixels, and its centre by symmetry.
    let desc = light([14.5, 16.5], [14.5, 15.5]);
    let samples = case.count(256, 1024);
    let seeds = case.count(8, 12);
    for (name, filter) in filters() {
        let images: Vec<Image> = (0..seeds).map(|seed| film(&desc, filter, samples, seed)).collect();
        let moment = |factor: &dyn Fn(f64, f64) -> f64| {
            over_seeds(seeds, |seed| {
                let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
                let image = &images[seed as usize];
                pixels
                    .map(|(x, y)| f64::from(image.pixel(x, y)[0]) * factor(f64::from(x) + 0.5, f64::from(y) + 0.5))
                    .sum()
            })
        };
        case.mean(format!("{name}: energy"), moment(&|_, _| 1.0), 2.0, 1e-2);
        // About the centre, which so carries no error of the energy.
        let (column, error) = moment(&|x, _| 0.5 * (x - 15.5));
        case.mean(format!("{name}: column of the centre"), (15.5 + column, error), 15.5, 1e-3);
        let (row, error) = moment(&|_, y| 0.5 * (y - 15.0));
        case.mean(format!("{name}: row of the centre"), (15.0 + row, error), 15.0, 1e-3);
    }
}

fn edge(case: &mut Case) {
    // A light that covers the left half of the film, up to the seam between columns 15 and 16.
    let desc = light([-20.0, 16.0], [-20.0, 40.0]);
    let samples = case.count(256, 1024);
    let seeds = case.count(8, 12);
    for (name, filter) in filters() {
        let response = Filter::new(&filter);
        let images: Vec<Image> = (0..seeds).map(|seed| film(&desc, filter, samples, seed)).collect();
        // The filter's mass beyond the edge, seen from the centres of pixels on either side.
        for x in [15_u32, 17] {
            let distance = 16.0 - (f64::from(x) + 0.5);
            let radius = f64::from(response.radius());
            let end = distance.clamp(-radius, radius);
            let exact = integral(along_x(&response), -radius, end, 8000);
            // Mean over the rows.
            let found = over_seeds(seeds, |seed| {
                (0..SIZE[1]).map(|y| f64::from(images[seed as usize].pixel(x, y)[0])).sum::<f64>() / f64::from(SIZE[1])
            });
            let what = format!("{name}: column {x}");
            if exact.abs() > 1e-3 {
                case.mean(what, found, exact, if exact.abs() < 0.05 { 0.2 } else { 0.02 });
            } else {
                case.exact(what, found.0, exact, Within::Absolute(2e-4));
            }
        }
    }
}
