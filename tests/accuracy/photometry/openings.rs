//! Daylight through openings and glass: after CIE 171:2006, sections 5.5 and 5.9 to 5.14.

use std::f64::consts::PI;

use etendue::desc::{
    BsdfDesc, EnvironmentDesc, FormulaSkyDesc, GridPoints, IntegratorDesc, MicrofacetsDesc, SceneDesc, ShapeDesc,
    SkyDesc,
};
use etendue::emitter::SkyFormula;
use etendue::lighting::{daylight_only, exterior_illuminance};
use etendue::math::DVec3;
use etendue::spectrum::Rgb;

use super::{build, illuminance, level, of, quad, run, settings, value, white};
use crate::lights::relative;
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "Y7", title: "directional transmittance of clear glass (5.5)", run: glass },
        Entry { id: "Y8", title: "sky component under a roof opening (5.9, 5.10)", run: roof },
        Entry { id: "Y9", title: "sky component behind a façade opening (5.11, 5.12)", run: facade },
        Entry { id: "Y10", title: "façade opening with outside masks (5.13, 5.14)", run: masks },
    ]
}

const INDEX: f64 = 1.52;

fn pane() -> BsdfDesc {
    let microfacets = MicrofacetsDesc::default();
    BsdfDesc::ThinDielectric { ior: INDEX as f32, exterior_ior: 1.0, transmittance: Rgb::ONE, microfacets }
}

/// Transmittance of a clear sheet for light at this cosine to its normal: for each polarisation (1 - R) / (1 + R), by Fresnel.
fn transmittance(cosine: f64) -> f64 {
    let inner = (1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX)).sqrt();
    let reflected = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    let through = |r: f64| (1.0 - r) / (1.0 + r);
    0.5 * (through(reflected(cosine, INDEX * inner)) + through(reflected(INDEX * cosine, inner)))
}

fn glass(case: &mut Case) {
    let pane = (level([-50.0, 50.0], [-50.0, 50.0], 1.0, false), pane(), None);
    // Looked at through the pane, a bright ceiling beyond it.
    let ceiling = (level([-400.0, 400.0], [-400.0, 400.0], 10.0, false), BsdfDesc::Black, Some(white(1000.0)));
    let scene = build(&of(vec![pane, ceiling]));
    let angles = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0];
    let directions = angles.map(|degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        DVec3::new(0.6 * sine, 0.8 * sine, cosine)
    });
    let points = GridPoints::Views { points: vec![DVec3::ZERO; angles.len()], directions: directions.to_vec() };
    let found = run(&scene, points, settings(case.count(65_536, 1 << 20) as u32, IntegratorDesc::Path));
    for (number, degrees) in angles.into_iter().enumerate() {
        let expected = 1000.0 * transmittance(degrees.to_radians().cos());
        let what = format!("luminance through clear glass, {degrees} degrees off the normal, cd/m2, path");
        // Whether a path passes is chosen by points that divide the unit interval evenly, to one part in their number.
        case.exact(what, found.values[number], expected, Within::Relative(2e-4));
    }
    // An even sky through a pane that is much larger than its height above the point.
    let mut desc = of(vec![(level([-4000.0, 4000.0], [-4000.0, 4000.0], 1.0, false), pane.1, None)]);
    sky(&mut desc, 5, DVec3::Z);
    let found = illuminance(
        &build(&desc),
        &[(DVec3::ZERO, DVec3::Z)],
        case.count(65_536, 1 << 20) as u32,
        IntegratorDesc::Path,
    );
    const STEPS: u32 = 100_000;
    let even: f64 = (0..STEPS).map(|i| transmittance(((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt())).sum();
    case.mean(
        "even sky of 1000 cd/m2 through clear glass, lx, path",
        value(&found, 0),
        1000.0 * PI * even / f64::from(STEPS),
        2e-3,
    );
}

/// Gives a scene a sky of 1000 cd/m^2 at the zenith over a black ground.
fn sky(desc: &mut SceneDesc, number: u32, sun: DVec3) {
    let formula = SkyFormula::cie(number).expect("a type");
    let sky = FormulaSkyDesc { up: DVec3::Z, ..FormulaSkyDesc::new(formula, sun) };
    let environment = EnvironmentDesc { sky: SkyDesc::Formula(sky), ..EnvironmentDesc::even(white(1000.0)) };
    desc.set_environment_desc(Some(environment)).expect("a sky");
}

/// Luminance relative to the zenith, integrated over the horizontal.
fn horizontal(number: usize, sun: DVec3) -> f64 {
    const STEPS: u32 = 800;
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (radius, around) =
                (((f64::from(i) + 0.5) / f64::from(STEPS)).sqrt(), 2.0 * PI * (f64::from(j) + 0.5) / f64::from(STEPS));
            let d = DVec3::new(radius * around.cos(), radius * around.sin(), (1.0 - radius * radius).sqrt());
            sum += relative(number, d, sun);
        }
    }
    PI * sum / f64::from(STEPS * STEPS)
}

/// A rectangle in a plane: a corner and two sides that are perpendicular to each other.
#[derive(Clone, Copy)]
struct Opening {
    corner: DVec3,
    sides: [DVec3; 2],
}

impl Opening {
    /// Illuminance at `p` by what is seen of the sky through the opening, of a sky of luminance 1 at the zenith, by the midpoints of cells,
    /// as many as `steps` along each side. `passes` is the share that passes of light along a direction that leaves through a
    /// point of the opening.
    fn seen(
        &self,
        (p, n): (DVec3, DVec3),
        number: usize,
        steps: [usize; 2],
        passes: impl Fn(DVec3, DVec3) -> f64,
    ) -> f64 {
        let [u, v] = self.sides;
        let across = u.cross(v) / (steps[0] * steps[1]) as f64;
        let mut sum = 0.0;
        for i in 0..steps[0] {
            for j in 0..steps[1] {
                let [s, t] = [(i, steps[0]), (j, steps[1])].map(|(k, count)| (k as f64 + 0.5) / count as f64);
                let q = self.corner + s * u + t * v;
                let d = (q - p).normalize();
                let passed = passes(q, d);
                if d.z > 0.0 && passed > 0.0 {
                    let solid = across.dot(d).abs() / (q - p).length_squared();
                    sum += relative(number, d, SUN) * d.dot(n).max(0.0) * solid * passed;
                }
            }
        }
        sum
    }
}

/// The black room [-2, 2] x [-2, 2] x [0, 3], with a hole in its roof, or in its wall at y = -2.
fn room(hole: &Opening, is_glazed: bool) -> Vec<(ShapeDesc, BsdfDesc, Option<Rgb>)> {
    let black = |shape| (shape, BsdfDesc::Black, None);
    let [low, high] = [hole.corner, hole.corner + hole.sides[0] + hole.sides[1]];
    let in_roof = low.z == high.z;
    let wall = |x: [f64; 2], z: [f64; 2]| {
        quad([[x[0], -2.0, z[0]], [x[1], -2.0, z[0]], [x[1], -2.0, z[1]], [x[0], -2.0, z[1]]])
    };
    let mut surfaces = vec![
        black(level([-2.0, 2.0], [-2.0, 2.0], 0.0, true)),
        black(quad([[-2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 3.0], [-2.0, 2.0, 3.0]])),
        black(quad([[-2.0, -2.0, 0.0], [-2.0, 2.0, 0.0], [-2.0, 2.0, 3.0], [-2.0, -2.0, 3.0]])),
        black(quad([[2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 3.0], [2.0, -2.0, 3.0]])),
    ];
    if in_roof {
        let roof = |x, y| black(level(x, y, 3.0, false));
        surfaces.push(black(wall([-2.0, 2.0], [0.0, 3.0])));
        surfaces.push(roof([-2.0, low.x], [-2.0, 2.0]));
        surfaces.push(roof([high.x, 2.0], [-2.0, 2.0]));
        surfaces.push(roof([low.x, high.x], [-2.0, low.y]));
        surfaces.push(roof([low.x, high.x], [high.y, 2.0]));
    } else {
        surfaces.push(black(level([-2.0, 2.0], [-2.0, 2.0], 3.0, false)));
        surfaces.push(black(wall([-2.0, low.x], [0.0, 3.0])));
        surfaces.push(black(wall([high.x, 2.0], [0.0, 3.0])));
        surfaces.push(black(wall([low.x, high.x], [0.0, low.z])));
        surfaces.push(black(wall([low.x, high.x], [high.z, 3.0])));
    }
    if is_glazed {
        let shape = if in_roof {
            level([low.x, high.x], [low.y, high.y], 3.0, false)
        } else {
            wall([low.x, high.x], [low.z, high.z])
        };
        surfaces.push((shape, pane(), None));
    }
    surfaces
}

const ROOF: Opening = Opening { corner: DVec3::new(-0.5, -0.5, 3.0), sides: [DVec3::X, DVec3::Y] };
const FACADE: Opening = Opening { corner: DVec3::new(-1.0, -2.0, 1.0), sides: [DVec3::new(2.0, 0.0, 0.0), DVec3::Z] };

/// Where the sun is, for the skies that ask: 53 degrees high, aside.
const SUN: DVec3 = DVec3::new(0.48, -0.36, 0.8);

/// A point of a room: its name, where it is, and its normal.
type Place = (&'static str, [f64; 3], DVec3);

/// Sky components of points of the room under some skies. `name` says what is special, `passes` what of the light passes.
fn components(
    case: &mut Case,
    name: &str,
    surfaces: &[(ShapeDesc, BsdfDesc, Option<Rgb>)],
    hole: &Opening,
    skies: &[u32],
    (places, samples, steps): (&[Place], u64, [usize; 2]),
    passes: &dyn Fn(DVec3, DVec3, DVec3) -> f64,
) {
    let is_glazed = surfaces.iter().any(|(_, bsdf, _)| matches!(bsdf, BsdfDesc::ThinDielectric { .. }));
    // Light samples do not reach through glass.
    let samples =
        case.count(if is_glazed { 8 * samples } else { samples }, 1 << if is_glazed { 22 } else { 20 }) as u32;
    let at: Vec<_> = places.iter().map(|(_, p, n)| (super::point(*p), *n)).collect();
    for &number in skies {
        let mut desc = of(surfaces.to_vec());
        sky(&mut desc, number, SUN);
        // A lamp and the sun itself, which daylight does not count.
        desc.add_point_light(DVec3::new(0.0, 0.0, 2.0), white(1e4)).expect("a light");
        let sun = etendue::desc::DistantLightDesc::parallel(DVec3::Z, white(1e5));
        desc.add_distant_light(sun).expect("a light");
        let settings = settings(samples, IntegratorDesc::Path);
        let outside = exterior_illuminance(&desc, &settings).expect("a sky");
        let scene = build(&daylight_only(&desc).expect("a sky"));
        let found = illuminance(&scene, &at, samples, IntegratorDesc::Path).relative_to(outside);
        let outside = horizontal(number as usize, SUN);
        for (place, (what, p, n)) in places.iter().enumerate() {
            let p = super::point(*p);
            let seen = hole.seen((p, *n), number as usize, steps, |q, d| passes(p, q, d));
            let (mean, error) = value(&found, place);
            let what = format!("{name}, sky {number}, {what}: daylight factor, %, path");
            // An edge of a mask within a cell of the quadrature counts as the cell's middle does.
            let tolerance = if is_glazed { 5e-2 } else { 4e-2 };
            case.biased_mean(what, (100.0 * mean, 100.0 * error), 100.0 * seen / outside, (1e-3, tolerance));
        }
    }
}

/// Cells of the quadrature: of a whole opening, and of one that the edges of masks divide, which may leave a strip of it.
const EVEN: [usize; 2] = [400, 400];
const MASKED: [usize; 2] = [400, 8000];

/// Samples of a quick run.
const QUICK: u64 = 1 << 14;

const ALL: [u32; 15] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

fn roof(case: &mut Case) {
    for number in [1, 12] {
        let mut desc = of(vec![]);
        sky(&mut desc, number, SUN);
        let settings = settings(case.count(1 << 14, 1 << 18) as u32, IntegratorDesc::Path);
        let outside = exterior_illuminance(&desc, &settings).expect("a sky");
        let exact = 1000.0 * horizontal(number as usize, SUN);
        case.mean(format!("sky {number}, illuminance outside, lx"), outside, exact, 2e-3);
        let places = [(DVec3::new(1.0, 2.0, 3.0), DVec3::Z)];
        let found =
            illuminance(&build(&desc), &places, settings.desc.samples, IntegratorDesc::Path).relative_to(outside);
        case.mean(format!("sky {number}, no building: daylight factor"), value(&found, 0), 1.0, 4e-3);
    }
    let places = [
        ("floor below", [0.0, 0.0, 0.0], DVec3::Z),
        ("floor in the corner", [1.75, 1.75, 0.0], DVec3::Z),
        ("wall", [2.0, 0.5, 1.5], DVec3::NEG_X),
    ];
    components(case, "open", &room(&ROOF, false), &ROOF, &ALL, (&places, 2 * QUICK, EVEN), &|_, _, _| 1.0);
    let glass = |_: DVec3, _: DVec3, d: DVec3| transmittance(d.z);
    components(case, "glazed", &room(&ROOF, true), &ROOF, &[1, 12], (&places, QUICK, EVEN), &glass);
}

/// Points of the floor and of the wall that the façade's opening lights.
const INSIDE: [Place; 3] = [
    ("floor near it", [0.0, -1.0, 0.0], DVec3::Z),
    ("floor far from it", [0.5, 1.0, 0.0], DVec3::Z),
    ("wall on the side", [2.0, -0.5, 0.5], DVec3::NEG_X),
];

fn facade(case: &mut Case) {
    components(case, "open", &room(&FACADE, false), &FACADE, &ALL, (&INSIDE, QUICK, EVEN), &|_, _, _| 1.0);
    let glass = |_: DVec3, _: DVec3, d: DVec3| transmittance(d.y.abs());
    components(case, "glazed", &room(&FACADE, true), &FACADE, &[1, 12], (&INSIDE, QUICK, EVEN), &glass);
}

fn masks(case: &mut Case) {
    let black = |shape| (shape, BsdfDesc::Black, None);
    // 0.8 m out from the upper edge of the opening, and a wall across the street.
    let mut surfaces = room(&FACADE, false);
    surfaces.push(black(level([-2.0, 2.0], [-2.8, -2.0], 2.0, false)));
    let overhang = |p: DVec3, q: DVec3, d: DVec3| {
        let at = p + d * ((2.0 - p.z) / d.z);
        let hides = q.z < 2.0 && (-2.8..=-2.0).contains(&at.y) && at.x.abs() <= 2.0;
        if hides { 0.0 } else { 1.0 }
    };
    components(case, "overhang", &surfaces, &FACADE, &[1, 5, 12], (&INSIDE, 8 * QUICK, MASKED), &overhang);
    let mut surfaces = room(&FACADE, false);
    surfaces.push(black(quad([[-4.0, -8.0, 0.0], [4.0, -8.0, 0.0], [4.0, -8.0, 5.0], [-4.0, -8.0, 5.0]])));
    let across = |p: DVec3, _: DVec3, d: DVec3| {
        let at = p + d * ((-8.0 - p.y) / d.y);
        let hides = at.x.abs() <= 4.0 && (0.0..=5.0).contains(&at.z);
        if hides { 0.0 } else { 1.0 }
    };
    components(case, "wall across", &surfaces, &FACADE, &[1, 5, 12], (&INSIDE, 4 * QUICK, MASKED), &across);
}
