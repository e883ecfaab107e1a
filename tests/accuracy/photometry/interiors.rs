//! Electric light: after CIE 171:2006, sections 5.2 to 5.4 and 5.6 to 5.8.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use etendue::Cancel;
use etendue::bake::{Atlas, AtlasOptions, Bake, by_radiosity};
use etendue::desc::{
    BsdfDesc, DistantLightDesc, IntegratorDesc, LightDistribution, PointLightDesc, SceneDesc, WebDesc,
};
use etendue::math::DVec3;
use etendue::photometry::Web;
use etendue::spectrum::Rgb;

use super::{build, illuminance, level, of, quad, settings, value, walls, white};
use crate::common::scenes::box_inside;
use crate::lights::polygon_factor;
use crate::record::{Case, Entry, Within};
use crate::transport::{MESH, grey, pick};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "Y1", title: "point sources over a floor (5.2)", run: points },
        Entry { id: "Y2", title: "area source in a room (5.3)", run: area },
        Entry { id: "Y3", title: "conservation of flux (5.4)", run: flux },
        Entry { id: "Y4", title: "diffuse reflection (5.6)", run: reflection },
        Entry { id: "Y5", title: "diffuse reflection with an obstruction (5.7)", run: obstruction },
        Entry { id: "Y6", title: "interreflection in a cube (5.8)", run: cube },
    ]
}

const METHODS: [(&str, IntegratorDesc); 2] = [("path", IntegratorDesc::Path), ("radiosity", IntegratorDesc::Radiosity)];

/// A black floor that faces upwards.
fn floor() -> SceneDesc {
    of(vec![(level([-4.0, 4.0], [-4.0, 4.0], 0.0, true), grey(0.0), None)])
}

/// The places of the cosine lamp: below it, and 1.5 m away along one axis and along both.
const PLACES: [[f64; 2]; 3] = [[0.0, 0.0], [1.5, 0.0], [1.5, 1.5]];

fn points(case: &mut Case) {
    let places = PLACES.map(|[x, y]| (DVec3::new(x, y, 0.0), DVec3::Z));
    // 1000 cd times the cosine, in a file whose angles are those of the points: nothing is interpolated there.
    let angle = |[x, y]: [f64; 2]| (x.hypot(y) / 3.0).atan().to_degrees();
    let mut angles: Vec<f64> =
        (0..=18).map(|step| 5.0 * f64::from(step)).chain(PLACES[1..].iter().map(|p| angle(*p))).collect();
    angles.sort_by(f64::total_cmp);
    let text = |values: Vec<f64>| values.iter().map(|value| format!("{value:.12}")).collect::<Vec<_>>().join("\n");
    let candela = angles.iter().map(|degrees| 1000.0 * degrees.to_radians().cos()).collect();
    let file = format!(
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {} 1 1 2 0 0 0\n1 1 1\n{}\n0\n{}\n",
        angles.len(),
        text(angles.clone()),
        text(candela)
    );
    let web =
        WebDesc { direction: DVec3::NEG_Z, ..WebDesc::new(Arc::new(Web::parse(file.as_bytes()).expect("a file"))) };
    let lamp = PointLightDesc::even(DVec3::new(0.0, 0.0, 3.0), Rgb::ONE);
    let mut desc = floor();
    desc.add_light_desc(PointLightDesc { distribution: LightDistribution::Web(web), ..lamp }).expect("a light");
    let found = illuminance(&build(&desc), &places, 64, IntegratorDesc::Path);
    for (number, [x, y]) in PLACES.into_iter().enumerate() {
        // I0 cos^4 / h^2: 111.11, 71.11 and 49.38 lx.
        let cosine2 = 9.0 / (9.0 + x * x + y * y);
        case.exact(
            format!("cosine lamp of 1000 cd 3 m above, {x} {y} m aside, lx, path"),
            found.values[number],
            1000.0 / 9.0 * cosine2 * cosine2,
            Within::Relative(2e-5),
        );
    }
    let mut desc = floor();
    desc.add_point_light(DVec3::new(0.0, 0.0, 3.0), white(1000.0)).expect("a light");
    let scene = build(&desc);
    for (name, method) in METHODS {
        let found = illuminance(&scene, &places, 64, method);
        for (number, [x, y]) in PLACES.into_iter().enumerate() {
            case.exact(
                format!("even lamp of 1000 cd 3 m above, {x} {y} m aside, lx, {name}"),
                found.values[number],
                3000.0 / (9.0 + x * x + y * y).powf(1.5),
                Within::Relative(2e-5),
            );
        }
    }
}

fn area(case: &mut Case) {
    // A panel of 1 m^2 and 1000 cd/m^2 in the ceiling of a black room.
    let panel = [[-0.5, -0.5, 3.0], [0.5, -0.5, 3.0], [0.5, 0.5, 3.0], [-0.5, 0.5, 3.0]];
    let mut desc = of(vec![
        (level([-0.5, 0.5], [-0.5, 0.5], 3.0, false), BsdfDesc::Black, Some(white(1000.0))),
        (level([-2.0, 2.0], [-2.0, 2.0], 0.0, true), grey(0.0), None),
    ]);
    desc.set_environment(None).expect("none");
    let scene = build(&desc);
    let places = [
        ("floor, middle", [0.0, 0.0, 0.0], DVec3::Z),
        ("floor, 0.125 m off", [0.125, 0.125, 0.0], DVec3::Z),
        ("floor, 0.5 m off", [0.5, 0.5, 0.0], DVec3::Z),
        ("floor, corner", [1.75, 1.75, 0.0], DVec3::Z),
        ("wall, 2.75 m high", [2.0, 0.0, 2.75], DVec3::NEG_X),
        ("wall, 0.25 m high", [2.0, 1.0, 0.25], DVec3::NEG_X),
    ];
    let at: Vec<_> = places.iter().map(|(_, p, n)| (super::point(*p), *n)).collect();
    let samples = case.count(4096, 65_536) as u32;
    for (name, method) in METHODS {
        let found = illuminance(&scene, &at, samples, method);
        for (number, (what, p, n)) in places.iter().enumerate() {
            let expected = PI * 1000.0 * polygon_factor(super::point(*p), *n, &panel.map(super::point));
            case.mean(format!("{what}, lx, {name}"), value(&found, number), expected, 2e-3);
        }
    }
}

fn flux(case: &mut Case) {
    let (min, max) = (DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, 2.0, 3.0));
    let all = walls(min, max, case.count(16, 24) as usize);
    let places: Vec<_> = all.iter().map(|([p, n], _)| (*p, *n)).collect();
    let lumens = |desc: &SceneDesc, samples: u32, method| {
        let found = illuminance(&build(desc), &places, samples, method);
        let flux = all.iter().zip(&found.values).map(|((_, area), lux)| area * lux).sum::<f64>();
        let error = all.iter().zip(&found.standard_errors).map(|((_, area), e)| (area * e).powi(2)).sum::<f64>();
        (flux, error.sqrt())
    };
    let mut desc = of(vec![]);
    desc.add_point_light(DVec3::new(0.7, -0.4, 1.4), white(10_000.0 / (4.0 * PI))).expect("a light");
    for (name, method) in METHODS {
        let (found, _) = lumens(&desc, 4, method);
        // What is left of the integrand's poles, which lie 1.3 m behind the walls, by the rule of 16 x 16 points.
        case.exact(format!("10 klm of a point, over all walls, lm, {name}"), found, 1e4, Within::Relative(2e-5));
    }
    let panel = level([-0.5, 0.5], [-0.5, 0.5], 2.0, false);
    let desc = of(vec![(panel, BsdfDesc::Black, Some(white(1000.0)))]);
    for (name, method) in METHODS {
        let found = lumens(&desc, case.count(256, 4096) as u32, method);
        // The walls' illuminance has an edge at the height of the panel, which no smooth rule takes exactly.
        case.biased_mean(format!("panel of 1000 cd/m2, over all walls, lm, {name}"), found, 1e3 * PI, (2e-3, 1e-3));
    }
}

/// A horizontal surface of 4 m x 4 m of reflectance 0.8 that is `gap` \[m\] away from the plane y = 0 of a wall, and lit straight from
/// above by 1000 lx, which are parallel to the wall.
fn lit_patch(gap: f64, more: Vec<(etendue::desc::ShapeDesc, BsdfDesc, Option<Rgb>)>) -> SceneDesc {
    let mut surfaces = vec![(level([-2.0, 2.0], [gap, gap + 4.0], 0.0, true), grey(0.8), None)];
    surfaces.extend(more);
    let mut desc = of(surfaces);
    desc.add_distant_light(DistantLightDesc::parallel(DVec3::Z, white(1000.0))).expect("a light");
    desc
}

/// Heights of points on a wall half a metre away from the lit floor, and on one that it touches.
const HEIGHTS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 3.0, 3.75];
const HEIGHTS_TOUCHING: [f64; 5] = [0.75, 1.25, 1.75, 2.25, 2.75];

fn reflection(case: &mut Case) {
    let samples = case.count(65_536, 1 << 20) as u32;
    // The factors of the floor for points of the wall, and what is found of 800 lm/m2.
    let measured = |gap: f64, heights: &[f64]| {
        let places: Vec<_> = heights.iter().map(|z| (DVec3::new(0.0, 0.0, *z), DVec3::Y)).collect();
        let far = gap + 4.0;
        let patch = [[-2.0, gap, 0.0], [2.0, gap, 0.0], [2.0, far, 0.0], [-2.0, far, 0.0]].map(super::point);
        let found = illuminance(&build(&lit_patch(gap, vec![])), &places, samples, IntegratorDesc::Path);
        let factors: Vec<f64> = places.iter().map(|(p, n)| polygon_factor(*p, *n, &patch)).collect();
        (factors, found)
    };
    let (factors, found) = measured(0.5, &HEIGHTS);
    for (number, z) in HEIGHTS.into_iter().enumerate() {
        let what = format!("wall beside a lit floor of 800 lm/m2, {z} m high, lx, path");
        case.mean(what, value(&found, number), 800.0 * factors[number], 1e-2);
    }
    let (factors, found) = measured(0.0, &HEIGHTS_TOUCHING);
    for (number, z) in HEIGHTS_TOUCHING.into_iter().enumerate() {
        let what = format!("wall that a lit floor touches, {z} m high, % of what the floor sends out, path");
        let (mean, error) = value(&found, number);
        case.mean(what, (mean / 8.0, error / 8.0), 100.0 * factors[number], 1e-2);
    }
}

fn obstruction(case: &mut Case) {
    // A black screen, parallel to the wall, hides the near part of the floor from low points and all of it from the lowest.
    let screen = quad([[-2.0, 0.3, 0.3], [-2.0, 0.3, 1.2], [2.0, 0.3, 1.2], [2.0, 0.3, 0.3]]);
    let scene = build(&lit_patch(0.5, vec![(screen, BsdfDesc::Black, None)]));
    let places: [(DVec3, DVec3); 5] = [0.6, 1.2, 1.6, 2.4, 3.6].map(|z| (DVec3::new(0.4, 0.0, z), DVec3::Y));
    let found = illuminance(&scene, &places, case.count(131_072, 1 << 20) as u32, IntegratorDesc::Path);
    for (number, (p, n)) in places.into_iter().enumerate() {
        let is_hidden = |q: DVec3| {
            let at = p + (q - p) * (0.3 / q.y);
            at.x.abs() <= 2.0 && (0.3..=1.2).contains(&at.z)
        };
        // Finer across the edges of the shadow than along them.
        const STEPS: [usize; 2] = [400, 8000];
        let mut factor = 0.0;
        for i in 0..STEPS[0] {
            for j in 0..STEPS[1] {
                let [x, y] = [(i, STEPS[0]), (j, STEPS[1])].map(|(k, count)| 4.0 * (k as f64 + 0.5) / count as f64);
                let q = DVec3::new(x - 2.0, y + 0.5, 0.0);
                let d = q - p;
                let distance2 = d.length_squared();
                if !is_hidden(q) {
                    factor += d.dot(n) * p.z / (PI * distance2 * distance2) * (16.0 / (STEPS[0] * STEPS[1]) as f64);
                }
            }
        }
        let what = format!("behind a screen, {} m high, lx, path", p.z);
        let (mean, error) = value(&found, number);
        if factor == 0.0 {
            case.exact(what, mean, 0.0, Within::Absolute(0.0));
        } else {
            // The quadrature's own edge is off by a cell.
            case.biased_mean(what, (mean, error), 800.0 * factor, (1e-3, 2e-2));
        }
    }
}

fn cube(case: &mut Case) {
    const LUMENS: f64 = 10_000.0;
    let half = DVec3::splat(2.0);
    for &albedo in pick(case, &[0.05_f32, 0.5, 0.95][..], &[0.05, 0.3, 0.5, 0.8, 0.95]) {
        let mut desc = of(vec![(MESH, grey(albedo), None)]);
        desc.meshes.push(Arc::new(box_inside(-half, half)));
        desc.add_point_light(DVec3::ZERO, white(LUMENS / (4.0 * PI))).expect("a light");
        let scene = build(&desc);
        // All of the light is absorbed in the end: 96 m^2 (1 - rho) E = Phi. The direct part is Phi / 96.
        let rho = f64::from(albedo);
        let expected = rho * LUMENS / ((1.0 - rho) * 96.0);
        let direct = LUMENS / 96.0;
        let indirect = |(mean, error): (f64, f64)| (mean - direct, error);
        let all = walls(-half, half, 8);
        let places: Vec<_> = all.iter().map(|([p, n], _)| (*p, *n)).collect();
        let samples = case.count(256, 2048) as u32;
        for (name, method) in METHODS {
            let found = illuminance(&scene, &places, samples, method);
            let mean = all.iter().zip(&found.values).map(|((_, area), lux)| area * lux).sum::<f64>() / 96.0;
            let error =
                all.iter().zip(&found.standard_errors).map(|((_, area), e)| (area * e).powi(2)).sum::<f64>().sqrt()
                    / 96.0;
            let what = format!("reflectance {albedo}: mean indirect illuminance, lx, {name}");
            // Of radiosity what its links leave out, relative to all light.
            let bias = if method == IntegratorDesc::Path { 1e-4 } else { 5e-3 } / rho;
            case.biased_mean(what, indirect((mean, error)), expected, (bias, 1e-2));
        }
        let options = AtlasOptions { resolution: Some(64), ..AtlasOptions::default() };
        let atlas = Atlas::new(&scene, &options, &Cancel::new()).expect("a layout");
        let area = |texel: usize| f64::from(atlas.coverage()[texel]);
        let total: f64 = (0..atlas.coverage().len()).map(area).sum();
        let mean = |values: &[[f32; 3]]| {
            values.iter().enumerate().map(|(texel, value)| area(texel) * f64::from(value[1])).sum::<f64>() * 683.0
                / total
        };
        let mut bake =
            Bake::new(&scene, atlas.sites(), settings(case.count(16, 128) as u32, IntegratorDesc::Path), true)
                .expect("sites");
        bake.run(&mut |_| ControlFlow::Continue(())).expect("no worker panics");
        let baked = bake.irradiance();
        let squares = baked
            .standard_error
            .iter()
            .enumerate()
            .map(|(texel, e)| (area(texel) * f64::from(e[1])).powi(2))
            .sum::<f64>();
        let found = (mean(&baked.irradiance), squares.sqrt() * 683.0 / total);
        let what = format!("reflectance {albedo}: mean indirect illuminance, lx, bake");
        case.biased_mean(what, indirect(found), expected, (1e-4 / rho, 1e-2));
        let settings = settings(1, IntegratorDesc::Radiosity);
        let (baked, _) =
            by_radiosity(&scene, atlas.sites(), &settings, Some(0.1), true, &mut |_| ControlFlow::Continue(()))
                .expect("a solution");
        let what = format!("reflectance {albedo}: mean indirect illuminance, lx, bake by radiosity");
        case.exact(what, mean(&baked.irradiance) - direct, expected, Within::Relative(5e-3 / rho));
    }
}
