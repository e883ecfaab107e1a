//! Measured lamps: what is read from files of either format, their flux, and the light that they give.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::sync::Arc;

use etendue::desc::{LightDistribution, PointLightDesc, WebDesc};
use etendue::emitter::{DirectedPoint, Distribution, Emitter, EmitterSet, TurnedWeb};
use etendue::math::{DVec3, Vec3};
use etendue::photometry::Web;
use etendue::sampling::{Rng, warps};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{INTEGRATORS, irradiance, lit};
use crate::common::scenes::{Job, point_light, render};
use crate::record::{Case, Entry, Within};
use crate::stats;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L52", title: "measured lamps, files", run: files },
        Entry { id: "L53", title: "measured lamps, flux and directions", run: whole },
        Entry { id: "L54", title: "measured lamps, at points", run: points },
        Entry { id: "L86", title: "measured lamps that are tilted", run: tilted_lamps },
    ]
}

/// Luminous efficacy [lm/W].
pub const EFFICACY: f64 = 683.0;

/// What it is called, its lamp, the type of its planes, horizontal and vertical angles.
type IesFile<'a> = (&'a str, Lamp, u32, Vec<f64>, &'a [f64]);

/// Candela by direction in the frame of the lamp: x towards C = 0, y towards C = 90 degrees, z along the axis.
pub type Lamp = fn(DVec3) -> f64;

/// Without any symmetry, over the hemisphere around the axis.
pub fn uneven(d: DVec3) -> f64 {
    100.0 * d.z.max(0.0) * (1.0 + 0.3 * d.x) * (1.0 + 0.2 * d.y * d.y)
}

/// The flux of it [lm].
pub const UNEVEN_FLUX: f64 = 100.0 * PI * 1.05;

/// Even in x and y.
fn quarters(d: DVec3) -> f64 {
    100.0 * d.z.max(0.0) * (1.0 + 0.3 * d.x * d.x) * (1.0 + 0.2 * d.y * d.y)
}

/// Even in y alone, with light above the lamp too.
fn halves(d: DVec3) -> f64 {
    100.0 * (1.0 + 0.9 * d.z) * (1.0 + 0.3 * d.x) * (1.0 + 0.2 * d.y * d.y)
}

/// Even in x alone, with light above the lamp too.
fn other_halves(d: DVec3) -> f64 {
    100.0 * (1.0 + 0.9 * d.z) * (1.0 + 0.3 * d.y) * (1.0 + 0.2 * d.x * d.x)
}

/// Even about the axis.
fn around(d: DVec3) -> f64 {
    100.0 * (1.0 + 0.9 * d.z)
}

/// Angles from one to another, in so many steps.
pub fn angles(from: f64, to: f64, steps: u32) -> Vec<f64> {
    (0..=steps).map(|k| from + (to - from) * f64::from(k) / f64::from(steps)).collect()
}

/// The direction of a horizontal and a vertical angle of a file of type 1 (C), 2 (B) or 3 (A).
fn direction(kind: u32, horizontal: f64, vertical: f64) -> DVec3 {
    let ((sin_h, cos_h), (sin_v, cos_v)) = (horizontal.to_radians().sin_cos(), vertical.to_radians().sin_cos());
    match kind {
        1 => DVec3::new(sin_v * cos_h, sin_v * sin_h, cos_v),
        2 => DVec3::new(sin_h, cos_h * sin_v, cos_h * cos_v),
        _ => DVec3::new(cos_v * sin_h, sin_v, cos_v * cos_h),
    }
}

/// A file of IES LM-63 whose factors come to 1.
pub fn ies(lamp: Lamp, kind: u32, horizontal: &[f64], vertical: &[f64]) -> String {
    let mut text = String::from("IESNA:LM-63-2002\n[TEST] none\n[LUMINAIRE] of a formula\nTILT=NONE\n");
    let (rows, columns) = (vertical.len(), horizontal.len());
    writeln!(text, "2 500 2.5 {rows} {columns} {kind} 2 0.1 0.2 0.3\n0.8 1 60").unwrap();
    for list in [vertical, horizontal] {
        writeln!(text, "{}", list.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")).unwrap();
    }
    for &h in horizontal {
        for &v in vertical {
            write!(text, "{:.7} ", lamp(direction(kind, h, v)) / 2.0).unwrap();
        }
        text.push('\n');
    }
    text
}

/// A file of EULUMDAT with all planes in steps of a degree, those of which its symmetry leaves with their intensities.
fn ldt(lamp: Lamp, symmetry: usize) -> String {
    let (planes, rows) = (360, 181);
    let mut text = format!("nobody\n1\n{symmetry}\n{planes}\n1\n{rows}\n1\n");
    text.push_str("report\nof a formula\n1\nfile\nday\n100\n100\n50\n90\n90\n0\n0\n0\n0\n80\n100\n1,25\n0\n1\n");
    text.push_str("2\nlamp\n800\nwhite\n80\n60\n");
    text.push_str(&"0.5\n".repeat(10));
    for plane in 0..planes {
        writeln!(text, "{plane}").unwrap();
    }
    for row in 0..rows {
        writeln!(text, "{row}").unwrap();
    }
    let (first, count) = [(0, 360), (0, 1), (0, 181), (270, 181), (0, 91)][symmetry];
    for plane in first..first + count {
        for row in 0..rows {
            writeln!(text, "{:.7}", lamp(direction(1, f64::from(plane % 360), f64::from(row)))).unwrap();
        }
    }
    text
}

pub fn parsed(text: &str) -> Web {
    Web::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// The uneven lamp, by steps of a degree.
pub fn uneven_web() -> Web {
    parsed(&ies(uneven, 1, &angles(0.0, 360.0, 360), &angles(0.0, 90.0, 90)))
}

/// A measured lamp of one watt for each lumen over the efficacy.
pub fn web_light(position: DVec3, direction: DVec3, c0: DVec3, web: Web) -> PointLightDesc {
    let distribution = LightDistribution::Web(WebDesc { direction, c0, ..WebDesc::new(Arc::new(web)) });
    PointLightDesc { distribution, ..point_light(position, 1.0) }
}

/// The direction of a scene in the frame of a lamp.
pub fn in_lamp(direction: DVec3, c0: DVec3, d: DVec3) -> DVec3 {
    let z = direction.normalize();
    let x = (c0 - z * c0.dot(z)).normalize();
    DVec3::new(d.dot(x), d.dot(x.cross(z)), d.dot(z))
}

/// Compares the intensities that were read with those of the formula, in directions that are no angles of the file.
fn compare(case: &mut Case, what: &str, text: &str, lamp: Lamp) {
    let web = parsed(text);
    let mut rng = Rng::new(52, 0);
    let mut worst: f64 = 0.0;
    for _ in 0..case.count(2000, 100_000) {
        let d = warps::uniform_sphere(rng.next_2d()).as_dvec3().normalize();
        // The last step before the horizon of a lamp that ends there is no straight line.
        if d.z.abs() > 0.02 {
            worst = worst.max((web.candela(d) - lamp(d)).abs());
        }
    }
    case.at_most(format!("{what}: worst of 200 cd"), worst, 2e-2);
}

fn files(case: &mut Case) {
    let rows = angles(0.0, 180.0, 180);
    let down = angles(0.0, 90.0, 90);
    let sides = angles(-90.0, 90.0, 180);
    let ies_files: [IesFile<'_>; 13] = [
        ("C, one plane", around, 1, vec![0.0], &rows),
        ("C, a quarter", quarters, 1, angles(0.0, 90.0, 90), &down),
        ("C, a half from 0", halves, 1, angles(0.0, 180.0, 180), &rows),
        ("C, a half from 90", other_halves, 1, angles(90.0, 270.0, 180), &rows),
        ("C, all planes", uneven, 1, angles(0.0, 360.0, 360), &down),
        ("C, all planes but the last", uneven, 1, angles(0.0, 359.0, 359), &down),
        ("C, all planes of the quarters", quarters, 1, angles(0.0, 360.0, 360), &down),
        ("C, all planes of the half", halves, 1, angles(0.0, 360.0, 360), &rows),
        (
            "C, above alone",
            |d| uneven(DVec3::new(d.x, d.y, -d.z)),
            1,
            angles(0.0, 360.0, 360),
            &angles(90.0, 180.0, 90),
        ),
        ("B, all", uneven, 2, sides.clone(), &sides),
        ("A, all", uneven, 3, sides.clone(), &sides),
        ("B, one side", quarters, 2, angles(0.0, 90.0, 90), &sides),
        ("A, one side", quarters, 3, angles(0.0, 90.0, 90), &sides),
    ];
    for (what, lamp, kind, horizontal, vertical) in ies_files {
        compare(case, &format!("IES {what}"), &ies(lamp, kind, &horizontal, vertical), lamp);
    }
    let symmetric: [Lamp; 5] = [uneven, around, halves, other_halves, quarters];
    for (symmetry, lamp) in symmetric.into_iter().enumerate() {
        compare(case, &format!("EULUMDAT, symmetry {symmetry}"), &ldt(lamp, symmetry), lamp);
    }
    // Factors: what a file of the first versions says after that of the ballast is a factor too, and no more in later ones.
    let old = ies(uneven, 1, &angles(0.0, 360.0, 360), &down)
        .replace("IESNA:LM-63-2002\n", "")
        .replace("0.8 1 60", "0.8 1.5 60");
    compare(case, "IES of 1986", &old, |d| 1.5 * uneven(d));
    let new = ies(uneven, 1, &angles(0.0, 360.0, 360), &down)
        .replace("IESNA:LM-63-2002", "IES:LM-63-2019")
        .replace("0.8 1 60", "0.8 1.10000 60")
        .replace("TILT=NONE", "TILT=INCLUDE\n1 3\n0 45 90\n1 0.9 0.8");
    compare(case, "IES of 2019 with a tilt", &new, uneven);
}

fn whole(case: &mut Case) {
    let down = angles(0.0, 90.0, 90);
    let turn = angles(0.0, 360.0, 360);
    let sides = angles(-90.0, 90.0, 180);
    let lambert: Lamp = |d| 100.0 * d.z.max(0.0);
    let cubed: Lamp = |d| 100.0 * d.z.max(0.0).powi(3);
    let even = |_: DVec3| 100.0;
    let all = angles(0.0, 180.0, 4);
    // Between the angles of a file, linear numbers stand for curved ones: wrong by the square of a degree in radians, 3e-4, over 12
    // and times the bend.
    for (what, text, flux, within) in [
        ("even, four steps", ies(even, 1, &[0.0], &all), 400.0 * PI, 1e-6),
        ("cos", ies(lambert, 1, &[0.0], &down), 100.0 * PI, 1e-4),
        ("cos^3", ies(cubed, 1, &[0.0], &down), 50.0 * PI, 4e-4),
        ("cos by planes of type B", ies(lambert, 2, &sides, &sides), 100.0 * PI, 2e-4),
        ("cos by planes of type A", ies(lambert, 3, &sides, &sides), 100.0 * PI, 2e-4),
        ("uneven", ies(uneven, 1, &turn, &down), UNEVEN_FLUX, 2e-4),
        ("uneven by planes of type B", ies(uneven, 2, &sides, &sides), UNEVEN_FLUX, 2e-4),
        ("uneven by planes of type A", ies(uneven, 3, &sides, &sides), UNEVEN_FLUX, 2e-4),
        ("uneven, EULUMDAT", ldt(uneven, 0), UNEVEN_FLUX, 2e-4),
    ] {
        let web = parsed(&text);
        case.exact(format!("{what}: lm"), web.flux(), flux, Within::Relative(within));
        let stated = if text.starts_with("IES") { 1000.0 } else { 800.0 };
        case.exact(format!("{what}: lm of the file"), web.stated_flux().unwrap_or(0.0), stated, Within::Absolute(0.0));
    }
    // Means over the directions that are sampled.
    let tries = case.count(1 << 16, 1 << 21);
    let means = [0.3 * (1.0 / 4.0 + 0.2 / 24.0) / 1.05, 0.0, (2.0 / 3.0 + 0.4 / 15.0) / 1.05];
    for (kind, horizontal, vertical, name) in
        [(1, &turn, &down, "C"), (2, &sides, &sides, "B"), (3, &sides, &sides, "A")]
    {
        let web = parsed(&ies(uneven, kind, horizontal, vertical));
        let mut rng = Rng::new(53, 0);
        let directions: Vec<DVec3> = (0..tries).map(|_| web.sample(rng.next_2d().map(f64::from))).collect();
        for (axis, exact) in [(0, means[0]), (2, means[2])] {
            let found = stats::mean_and_error(&directions.iter().map(|d| d[axis]).collect::<Vec<_>>());
            case.biased_mean(format!("type {name}: mean component {axis}"), found, exact, (3e-4, 3e-2));
        }
        let off = stats::mean_and_error(&directions.iter().map(|d| 1.0 + d.y).collect::<Vec<_>>());
        case.mean(format!("type {name}: mean component 1, plus 1"), off, 1.0 + means[1], 5e-3);
        let squares = stats::mean_and_error(&directions.iter().map(|d| d.y * d.y).collect::<Vec<_>>());
        let exact = (1.0 / 4.0 + 0.2 / 8.0) / 1.05;
        case.biased_mean(format!("type {name}: mean square of component 1"), squares, exact, (5e-4, 5e-3));
    }
}

fn points(case: &mut Case) {
    let (axis, c0) = (DVec3::new(0.2, -0.3, -0.9), DVec3::new(1.0, 0.5, 0.1));
    let place = DVec3::new(0.3, -0.2, 2.0);
    let web = Arc::new(uneven_web());
    for p in [DVec3::ZERO, DVec3::new(1.0, 0.5, 0.0), DVec3::new(-2.0, 1.0, 0.0), DVec3::new(0.5, -3.0, 0.0)] {
        let way = p - place;
        let exact = uneven(in_lamp(axis, c0, way.normalize())) / EFFICACY * -way.z / way.length().powi(3);
        let turned = TurnedWeb::new(Arc::clone(&web), axis.normalize(), c0.normalize());
        let set = EmitterSet::new(vec![Emitter::Directed(Box::new(DirectedPoint {
            position: place.as_vec3a(),
            intensity: Rgb::splat((1.0 / EFFICACY) as f32),
            distribution: Distribution::Web(turned),
        }))]);
        let (mean, _) = irradiance(case, &set, p.as_vec3a(), DVec3::Z);
        case.exact(format!("below it, at {p}"), mean * PI, exact, Within::Relative(3e-4));
        let (above, _) = irradiance(case, &set, Vec3::new(0.0, 0.0, 5.0), -DVec3::Z);
        case.exact(format!("above it, from {p}"), above, 0.0, Within::Absolute(0.0));
        // A floor by each method.
        let mut desc = lit(0.1, 1e-3, vec![]);
        desc.lights.push(web_light(place - p, axis, c0, Web::clone(&web)));
        for (whose, integrator) in INTEGRATORS {
            let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
            let (image, _) = render(&desc, &job);
            case.exact(format!("a floor at {p}, {whose}"), image.mean()[0], exact / PI, Within::Relative(5e-4));
        }
    }
}

/// Lamps whose file has factors of tilts: light of a lamp as it is tilted, over that of the formula.
fn tilted_lamps(case: &mut Case) {
    let text = ies(uneven, 1, &angles(0.0, 360.0, 360), &angles(0.0, 90.0, 90));
    let (place, axis, c0) = (DVec3::new(0.3, -0.2, 2.0), DVec3::new(0.2, -0.3, -0.9), DVec3::X);
    let way = -place;
    let even = uneven(in_lamp(axis, c0, way.normalize())) / EFFICACY * place.z / way.length().powi(3);
    for (what, block, tilt, factor) in [
        ("upright, 0 degrees", "1\n4\n0 20 60 90\n1 0.9 0.7 0.75", 0.0, 1.0),
        ("upright, 30 degrees", "1\n4\n0 20 60 90\n1 0.9 0.7 0.75", 30.0, 0.85),
        ("upright, -84 degrees", "1\n4\n0 20 60 90\n1 0.9 0.7 0.75", -84.0, 0.74),
        ("level and tilted, -45 degrees", "3\n3\n-90 0 90\n0.5 1 0.8", -45.0, 0.75),
        ("level and tilted, 45 degrees", "3\n3\n-90 0 90\n0.5 1 0.8", 45.0, 0.9),
        ("level and fixed, 45 degrees", "2\n3\n0 45 90\n0.98 0.9 0.8", 45.0, 0.98),
        ("from 40 degrees on, 10 degrees", "1\n2\n40 90\n0.8 0.6", 10.0, 0.95),
    ] {
        let web = parsed(&text.replace("TILT=NONE", &format!("TILT=INCLUDE\n{block}")));
        let mut desc = lit(0.1, 1e-3, vec![]);
        desc.lights.push(web_light(place, axis, c0, web));
        let LightDistribution::Web(it) = &mut desc.lights[0].distribution else { unreachable!("it is a web") };
        it.tilt_deg = tilt;
        let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
        let power = scene.emitters().emitters()[0].power().x;
        case.exact(format!("{what}: W"), power, factor * UNEVEN_FLUX / EFFICACY, Within::Relative(2e-4));
        for (whose, integrator) in INTEGRATORS {
            let job = Job { resolution: [4, 4], samples: 64, integrator, ..Job::default() };
            let (image, _) = render(&desc, &job);
            let name = format!("{what}: a floor, {whose}");
            case.exact(name, image.mean()[0], factor * even / PI, Within::Relative(5e-4));
        }
    }
}
