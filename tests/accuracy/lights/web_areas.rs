//! Measured lamps with an area: flat surfaces whose radiance is the intensity of a file over area and cosine.
//!
//! What a receiver gets is the mean over the area of what a point lamp would give from there, which quadrature gives.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use etendue::bsdf::Bsdf;
use etendue::desc::{AreaWebDesc, BsdfDesc, IntegratorDesc, MeshDesc, SceneDesc, ShapeDesc};
use etendue::emitter::{DiskEmitter, Emitter, EmitterSet, FlatEmitter, TriangleEmitter, TurnedWeb, WebArea};
use etendue::integrator::photon::MapKind;
use etendue::math::{DAffine3, DMat3, DVec3, Vec3};
use etendue::photometry::Web;
use etendue::sampling::mis;
use etendue::scene::{BuildOptions, Scene};
use etendue::shape::{Disk, Triangle};
use etendue::spectrum::Rgb;

use super::round::{consistency, thousand_places};
use super::sky::{METHODS, drawn};
use super::webs::{EFFICACY, Lamp, angles, ies, in_lamp, parsed};
use super::weights::{Weight, direct};
use super::{irradiance, lit};
use crate::common::scenes::{Job, add, box_inside, camera, mean_and_error, render};
use crate::photons::{build, runs, seeded, shot, stored, unseen};
use crate::record::{Case, Entry, Within};
use crate::stats;
use crate::transport::{grey, mirror, parallelogram, pick};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L95", title: "measured lamps with an area, over a floor", run: floors },
        Entry { id: "L96", title: "measured lamps with an area, by all methods", run: pictures },
        Entry { id: "L97", title: "measured lamps with an area, as they are seen", run: seen },
        Entry { id: "L97b", title: "measured lamps with an area, combined sampling", run: chances },
        Entry { id: "L98", title: "measured lamps with an area, flux and photons", run: photons },
        Entry { id: "L99", title: "choice among a thousand measured lamps with an area", run: many },
    ]
}

/// As bright along its plane as a third of what it is along its axis, and uneven; dark behind.
fn flat(d: DVec3) -> f64 {
    if d.z < -1e-9 { 0.0 } else { 100.0 * (0.5 + d.z) * (1.0 + 0.3 * d.x) * (1.0 + 0.2 * d.y * d.y) }
}

/// The flux of it [lm].
const FLAT_FLUX: f64 = 100.0 * (0.5 * (TAU + 0.4 * PI / 3.0) + PI + 0.05 * PI);

/// Uneven light on both sides, also along the plane between them.
fn both(d: DVec3) -> f64 {
    100.0 * (1.0 + 0.5 * d.z) * (1.0 + 0.3 * d.x) * (1.0 + 0.2 * d.y * d.y)
}

/// The flux of it on the side of the axis and on the other one [lm].
const BOTH_FLUX: [f64; 2] = [100.0 * (TAU + 0.4 * PI / 3.0 + 0.525 * PI), 100.0 * (TAU + 0.4 * PI / 3.0 - 0.525 * PI)];

/// The file of a lamp, by steps of a degree.
fn web(lamp: Lamp) -> Web {
    // A file that ends at the horizon, or goes on beyond it without an angle there.
    let (last, steps) = if lamp(DVec3::NEG_Z) > 0.0 { (180.0, 179) } else { (90.0, 90) };
    parsed(&ies(lamp, 1, &angles(0.0, 360.0, 360), &angles(0.0, last, steps)))
}

/// The direction of C = 0 of all lamps here, askew.
const C0: DVec3 = DVec3::new(1.0, 0.5, 0.1);

/// A flat lamp: a parallelogram from a corner along two sides, whose normal is along their cross product, or an ellipse around a point
/// through the ends of two vectors.
#[derive(Clone, Copy)]
struct Area {
    from: DVec3,
    u: DVec3,
    v: DVec3,
    is_round: bool,
}

impl Area {
    fn rectangle(from: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Self {
        let [from, u, v] = [from, u, v].map(DVec3::from_array);
        Self { from, u, v, is_round: false }
    }

    /// A disk.
    fn disk(centre: [f64; 3], normal: DVec3, radius: f64) -> Self {
        let (u, v) = normal.any_orthonormal_pair();
        Self { from: DVec3::from_array(centre), u: radius * u, v: radius * v, is_round: true }
    }

    fn normal(&self) -> DVec3 {
        self.u.cross(self.v).normalize()
    }

    fn size(&self) -> f64 {
        self.u.cross(self.v).length() * if self.is_round { PI } else { 1.0 }
    }

    fn shape(&self) -> ShapeDesc {
        let Self { from, u, v, is_round } = *self;
        if is_round {
            return ShapeDesc::Disk { centre: from, normal: self.normal(), radius: u.length() };
        }
        ShapeDesc::Quad([from, from + u, from + u + v, from + v])
    }

    /// A point for two numbers in [0, 1), uniform by area.
    fn at(&self, s: f64, t: f64) -> DVec3 {
        if !self.is_round {
            return self.from + s * self.u + t * self.v;
        }
        let (sin, cos) = (TAU * t).sin_cos();
        self.from + s.sqrt() * (cos * self.u + sin * self.v)
    }

    /// The irradiance at `p` with unit normal `n` by this lamp [W/m^2], by midpoints. `axis`: gamma = 0, which is the normal or against it.
    fn irradiance(&self, lamp: Lamp, axis: DVec3, p: DVec3, n: DVec3, steps: u32) -> f64 {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let one = |(i, j): (u32, u32)| {
            let way = p - self.at(at(i), at(j));
            let distance = way.length();
            let cosine = (-way.dot(n) / distance).max(0.0);
            let is_lit = way.dot(self.normal()) > 0.0;
            if is_lit { lamp(in_lamp(axis, C0, way / distance)) / EFFICACY * cosine / distance.powi(2) } else { 0.0 }
        };
        let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j)));
        all.map(one).sum::<f64>() / f64::from(steps * steps)
    }
}

/// Lets the surface shine as the lamp does, on both sides if that has light behind.
fn shine(desc: &mut SceneDesc, surface: usize, lamp: Lamp) {
    let it = AreaWebDesc { c0: C0, ..AreaWebDesc::new(Arc::new(web(lamp))) };
    if lamp(DVec3::NEG_Z) > 0.0 {
        desc.set_emits_both(surface, true).expect("a lamp of the test");
    }
    desc.set_surface_web(surface, Some(it)).expect("a lamp of the test");
}

/// A floor under a lamp.
fn under(area: &Area, lamp: Lamp, eye: f64, size: f64) -> SceneDesc {
    let mut desc = lit(eye, size, vec![area.shape()]);
    shine(&mut desc, 1, lamp);
    desc
}

fn floors(case: &mut Case) {
    let over = |z: f64, x: f64| Area::rectangle([x - 0.5, -0.3, z], [0.0, 0.6, 0.0], [1.0, 0.0, 0.0]);
    let steps = pick(case, 1000, 3000);
    for (what, area, tolerance) in [
        ("a tenth of its width over it", over(0.1, 0.0), 6e-3),
        ("half of its width over it", over(0.5, 0.2), 2e-3),
        ("over it", over(1.0, 0.0), 2e-3),
        ("beside it", over(1.0, 2.0), 2e-3),
        ("far beside it", over(0.2, 3.0), 2e-3),
        ("ten of its widths over it", over(10.0, 1.0), 2e-3),
        // A wall that shines along the floor, most of which the floor sees at grazing angles.
        ("close to a wall", Area::rectangle([-0.05, -0.5, 0.01], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]), 1e-2),
        ("a disk over it", Area::disk([0.2, 0.1, 0.8], DVec3::NEG_Z, 0.5), 2e-3),
        ("a disk, a tenth of its radius over it", Area::disk([0.2, 0.1, 0.05], DVec3::NEG_Z, 0.5), 6e-3),
        ("a disk askew", Area::disk([-0.9, 0.4, 0.7], DVec3::new(0.8, -0.2, -0.3).normalize(), 0.5), 2e-3),
    ] {
        let exact = area.irradiance(flat, area.normal(), DVec3::ZERO, DVec3::Z, steps) / PI;
        rendered_biased(case, what, &under(&area, flat, 0.04, 1e-4), exact, tolerance);
    }
    // From afar it is the point lamp of its file.
    for distance in [100.0, 1000.0] {
        let axis = DVec3::new(0.3, -0.2, -0.9).normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let middle = distance * DVec3::new(0.4, 0.3, 0.8).normalize();
        let area = Area { from: middle - 0.5 * u - 0.3 * v, u, v: 0.6 * v, is_round: false };
        let way = -middle.normalize();
        let exact = flat(in_lamp(area.normal(), C0, way)) / EFFICACY * -way.z / distance.powi(2) / PI;
        let name = format!("{distance} lengths away: I cos / r^2");
        // The size of the lamp counts by its square over that of the distance.
        rendered_biased(case, &name, &under(&area, flat, 0.1, 1e-3), exact, 2e-3);
    }
    // Densities of samples are those of points, and shadow rays end on the lamp.
    for (name, set, p) in [
        ("near a triangle", lone(&over(0.5, 0.0)), Vec3::ZERO),
        ("far from a triangle", lone(&over(6.0, 0.0)), Vec3::ZERO),
        ("near a disk", lone(&Area::disk([0.2, 0.1, 0.8], DVec3::NEG_Z, 0.5)), Vec3::ZERO),
        ("far from a disk", lone(&Area::disk([0.2, 0.1, 8.0], DVec3::NEG_Z, 0.5)), Vec3::ZERO),
    ] {
        consistency(case, name, &set, p);
    }
}

/// Half of a rectangle, or a disk, with the light of the lamp.
fn lone(area: &Area) -> EmitterSet {
    EmitterSet::new(vec![emitter(area, flat)])
}

/// An emitter of a lamp, without a scene; a rectangle is represented by its first half, which has the lamp's whole light.
fn emitter(area: &Area, lamp: Lamp) -> Emitter {
    let side = web(lamp).side(true).expect("a lit side");
    let radiance = |size: f64| Rgb::splat((side.flux() / (EFFICACY * PI * size)) as f32);
    let even = match area.is_round {
        true => {
            let to_scene = DAffine3::from_mat3_translation(DMat3::from_cols(area.u, area.v, area.normal()), area.from);
            FlatEmitter::Disk(DiskEmitter::new(Disk::new(DVec3::ZERO, DVec3::Z, 1.0, &to_scene), radiance(area.size())))
        }
        false => {
            let corners = [area.from, area.from + area.u, area.from + area.v].map(DVec3::as_vec3a);
            let triangle = Triangle::new(corners).expect("a triangle with an area");
            FlatEmitter::Triangle(TriangleEmitter::new(triangle, radiance(0.5 * area.size()), 1e-6))
        }
    };
    Emitter::Web(Box::new(WebArea::new(even, Arc::new(TurnedWeb::new(Arc::new(side), area.normal(), C0)))))
}

/// As [`super::rendered`], where the file's steps of a degree may be off by a little.
fn rendered_biased(case: &mut Case, what: &str, desc: &SceneDesc, exact: f64, tolerance: f64) {
    let samples = case.count(2048, 8192) as u32;
    for (name, integrator) in super::INTEGRATORS {
        let (image, _) = render(desc, &Job { resolution: [8, 8], samples, integrator, ..Job::default() });
        case.biased_mean(format!("{what}, {name}"), mean_and_error(&image), exact, (1e-4, tolerance));
    }
}

fn pictures(case: &mut Case) {
    let samples = case.count(16, 256) as u32;
    let area = Area::rectangle([-0.3, -0.6, 0.8], [-0.2, 0.9, 0.1], [1.1, 0.1, 0.3]);
    let turned = Area { from: area.from + area.u, u: -area.u, ..area };
    let disk = Area::disk([0.5, 0.0, 1.0], DVec3::NEG_Z, 1.0);
    let back = Area::disk([0.5, 0.0, 1.0], DVec3::Z, 1.0);
    // The file's axis is the normal, also of the side that it does not point to.
    for (what, area, lamp, faces) in [
        ("quad", area, flat as Lamp, true),
        ("quad of both sides", area, both, true),
        ("back of a quad", turned, both, false),
        ("disk", disk, flat, true),
        ("back of a disk", back, both, false),
    ] {
        let lit_side = if faces { area } else { Area { from: area.from, u: area.v, v: area.u, ..area } };
        let exact = lit_side.irradiance(lamp, area.normal(), DVec3::ZERO, DVec3::Z, 1000) / PI;
        let desc = under(&area, lamp, 0.5, 0.05);
        for (integrator, bias) in METHODS {
            let (mean, error) = mean_and_error(&drawn(case, &desc, integrator, samples));
            case.biased_mean(format!("{what}, by {integrator:?}"), (mean, error), exact, (bias.max(2e-4), 1e-2));
        }
    }
    // A flat mesh in a frame that is mirrored: hits and lamp agree on the side that shines, and C = 0 is turned along.
    let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mut desc = lit(0.5, 0.05, vec![]);
    let positions: Vec<DVec3> =
        [[-0.3, -0.4], [-0.3, 0.6], [0.5, 0.6], [0.9, 0.1], [0.5, -0.4]].map(|[x, y]| DVec3::new(x, y, 1.0)).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    desc.meshes.push(Arc::new(MeshDesc { path: "meshes[0]".into(), positions, triangles, ..MeshDesc::default() }));
    add(&mut desc, 1, ShapeDesc::Mesh { mesh: 0, smooth: false }, BsdfDesc::Black, Some(Rgb::ONE));
    shine(&mut desc, 1, flat);
    desc.set_transform(1, mirrored).expect("a place of the test");
    let (mut sum, mut area) = (0.0, 0.0);
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4]] {
        let [a, b, c] = [a, b, c].map(|i: usize| mirrored.transform_point3(desc.meshes[0].positions[i]));
        let size = 0.5 * (b - a).cross(c - a).length();
        let mut one = |p: DVec3| {
            let way = -p / p.length();
            let lamp = flat(in_lamp(DVec3::NEG_Z, mirrored.matrix3 * C0, way));
            sum += size / 1e4 * lamp / EFFICACY * -way.z / p.length_squared();
        };
        etendue::shape::centroids(100).for_each(|[s, t]| one(a + f64::from(s) * (b - a) + f64::from(t) * (c - a)));
        area += size;
    }
    for (integrator, bias) in METHODS {
        let (mean, error) = mean_and_error(&drawn(case, &desc, integrator, samples));
        let what = format!("mirrored mesh, by {integrator:?}");
        case.biased_mean(what, (mean, error), sum / area / PI, (bias.max(2e-4), 1e-2));
    }
    let message = Scene::build(&desc, &BuildOptions::default())
        .and_then(|scene| etendue::integrator::check_support(&scene, IntegratorDesc::Radiosity))
        .map_or_else(|error| error.to_string(), |()| "taken".to_owned());
    case.holds("radiosity", "refuses it by name", message.clone(), message.contains("photometric web"));
}

/// What the camera sees of the lamp itself: the intensity over area and cosine.
fn seen(case: &mut Case) {
    for (what, is_round, lamp, side) in [
        ("rectangle", false, flat as Lamp, 1.0),
        ("disk", true, flat, 1.0),
        ("front of both", false, both, 1.0),
        ("back of both", true, both, -1.0),
    ] {
        let area = match is_round {
            true => Area::disk([0.0, 0.0, 0.0], DVec3::Z, 0.6),
            false => Area::rectangle([-0.5, -0.4, 0.0], [1.0, 0.0, 0.0], [0.0, 0.8, 0.0]),
        };
        for degrees in [0.0_f64, 30.0, 60.0, 85.0, 89.5] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let towards = DVec3::new(0.6 * sin, 0.8 * sin, side * cos);
            let mut desc = under(&area, lamp, 0.1, 1e-3);
            desc.surfaces[0].hidden = true;
            desc.set_camera(camera(20.0 * towards, DVec3::ZERO, 1e-3)).expect("a camera of the test");
            let exact = lamp(in_lamp(DVec3::Z, C0, towards)) / EFFICACY / area.size() / cos;
            let (image, _) = render(&desc, &Job { resolution: [4, 4], samples: 16, ..Job::default() });
            let name = format!("{what}, {degrees} degrees off its normal");
            case.exact(name, image.mean()[0], exact, Within::Relative(1e-3));
        }
    }
    // A mirror shows it as the camera would see it from behind the mirror.
    let area = Area::rectangle([-0.5, -0.4, 2.0], [0.0, 0.8, 0.0], [1.0, 0.0, 0.0]);
    let mut desc = under(&area, flat, 0.1, 1.0);
    desc.materials[0].bsdf = mirror(0.9);
    desc.set_camera(camera(DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.7, 0.0, 0.0), 1e-3)).expect("a camera of the test");
    let way = DVec3::new(0.6, 0.0, -2.0).normalize();
    let exact = 0.9 * flat(in_lamp(DVec3::NEG_Z, C0, way)) / EFFICACY / area.size() / -way.z;
    let (image, _) = render(&desc, &Job { resolution: [4, 4], samples: 16, ..Job::default() });
    case.exact("in a mirror", image.mean()[0], exact, Within::Relative(1e-3));
}

/// Light samples and Bsdf samples that meet the lamp, alone and combined, near it and along a wall of light.
fn chances(case: &mut Case) {
    let bsdf = Bsdf::new(&BsdfDesc::Lambert { albedo: Rgb::ONE });
    let over = Area::rectangle([-0.3, -0.3, 0.5], [0.0, 0.6, 0.0], [1.0, 0.0, 0.0]);
    let wall = Area::rectangle([-0.1, -0.5, 0.01], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let disk = Area::disk([0.2, 0.1, 0.4], DVec3::NEG_Z, 0.5);
    let far = Area::rectangle([0.5, -0.5, 2.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    for (what, area) in [("near", over), ("close to a wall", wall), ("near a disk", disk), ("farther away", far)] {
        let mut desc = under(&area, flat, 0.1, 1e-3);
        desc.surfaces[0].hidden = true;
        let scene = build(&desc);
        let exact = area.irradiance(flat, area.normal(), DVec3::ZERO, DVec3::Z, 1000) / PI;
        let [none, all]: [Weight; 2] = [|_, _| 0.0, |_, _| 1.0];
        let size = case.count(4096, 32_768) as u32;
        for (technique, light, scattering, size, tolerance) in [
            ("light samples", all, none, size, 5e-3),
            ("Bsdf samples", none, all, 8 * size, 2e-2),
            ("balance heuristic", mis::balance_heuristic, mis::balance_heuristic, size, 5e-3),
            ("power heuristic", mis::power_heuristic, mis::power_heuristic, size, 5e-3),
        ] {
            let found = stats::mean_and_error(&direct(&scene, &bsdf, light, scattering, size));
            case.biased_mean(format!("{what}: {technique}"), found, exact, (1e-4, tolerance));
        }
    }
}

fn photons(case: &mut Case) {
    let paths = case.count(1 << 13, 1 << 16) as u32;
    let area = Area::rectangle([-0.2, 0.9, -0.3], [0.0, 0.0, 0.5], [-0.8, 0.1, 0.0]);
    let back = Area { u: area.v, v: area.u, ..area };
    for (what, lamp, flux) in [("one side", flat as Lamp, [FLAT_FLUX, 0.0]), ("both sides", both, BOTH_FLUX)] {
        let web = web(lamp);
        for (side, flux) in [true, false].into_iter().zip(flux) {
            let found = web.side(side).map_or(0.0, |side| side.flux());
            let name = format!("{what}: lm {} the plane", if side { "before" } else { "behind" });
            case.exact(name, found, flux, if flux > 0.0 { Within::Relative(2e-4) } else { Within::Absolute(0.0) });
        }
        let whole = (flux[0] + flux[1]) / EFFICACY;
        let lamp_of = |mut desc: SceneDesc| {
            let number = desc.surfaces.len();
            add(&mut desc, number, area.shape(), BsdfDesc::Black, Some(Rgb::ONE));
            shine(&mut desc, number, lamp);
            desc
        };
        // What falls on a parallelogram from one side or the other.
        let onto = |corner: DVec3, u: DVec3, v: DVec3| {
            let (n, steps) = (u.cross(v).normalize(), 30);
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
            let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j)));
            let of = |p: DVec3| {
                let one =
                    |side: &Area| [n, -n].map(|n| side.irradiance(lamp, area.normal(), p, n, 30)).iter().sum::<f64>();
                one(&area) + one(&back)
            };
            let sum: f64 = all.map(|(i, j)| of(corner + at(i) * u + at(j) * v)).sum();
            sum / f64::from(steps * steps) * u.cross(v).length()
        };
        let floor = (DVec3::new(-0.5, 0.0, 0.5), DVec3::X, DVec3::NEG_Z);
        let mut surfaces = vec![(parallelogram(floor.0, floor.1, floor.2), grey(1.0), None)];
        let ceiling = (DVec3::new(-0.5, 1.8, 0.5), DVec3::NEG_Z, DVec3::X);
        if lamp(DVec3::NEG_Z) > 0.0 {
            surfaces.push((parallelogram(ceiling.0, ceiling.1, ceiling.2), grey(1.0), None));
        }
        let scene = build(&lamp_of(unseen(surfaces)));
        let tally = shot(&scene, &seeded(1), MapKind::Global, paths).tally;
        case.exact(format!("{what}: sent out"), tally.emitted.x, whole, Within::Relative(3e-4));
        let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Direct, paths)));
        let mut exact = onto(floor.0, floor.1, floor.2);
        if lamp(DVec3::NEG_Z) > 0.0 {
            exact += onto(ceiling.0, ceiling.1, ceiling.2);
        }
        case.biased_mean(format!("{what}: on patches"), found, exact, (1e-3, pick(case, 1e-2, 4e-3)));
        // In a closed room, surfaces get the power of the lamp over what they absorb; what the lamp itself absorbs is made up for by
        // none, so it is small.
        let small = |desc: &mut SceneDesc| {
            let number = desc.surfaces.len();
            let tiny = Area { from: DVec3::ZERO, u: 1e-3 * area.u, v: 1e-3 * area.v, is_round: false };
            add(desc, number, tiny.shape(), BsdfDesc::Black, Some(Rgb::ONE));
            shine(desc, number, lamp);
        };
        let mut desc = unseen(Vec::new());
        desc.meshes.push(Arc::new(box_inside(DVec3::new(-1.0, -0.8, -1.5), DVec3::new(1.2, 1.0, 0.9))));
        add(&mut desc, 0, ShapeDesc::Mesh { mesh: 0, smooth: false }, grey(0.5), None);
        small(&mut desc);
        let scene = build(&desc);
        let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Global, paths / 4)));
        let tolerance = (3e-4, pick(case, 5e-3, 2e-3));
        case.biased_mean(format!("{what}: stored in a closed room"), found, 2.0 * whole, tolerance);
        // Aimed at a mirror.
        let glass = (DVec3::new(-1.2, 0.1, -0.5), DVec3::Y, DVec3::Z);
        let mut surfaces = vec![(parallelogram(glass.0, glass.1, glass.2), mirror(0.9), None)];
        let far = 50.0;
        for side in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
            let (s, t) = (side.any_orthonormal_vector(), side.cross(side.any_orthonormal_vector()));
            surfaces.push((parallelogram(far * (side - s - t), 2.0 * far * s, 2.0 * far * t), grey(0.5), None));
        }
        let mut desc = unseen(surfaces);
        small(&mut desc);
        let moved = DAffine3::from_translation(DVec3::new(-0.3, 0.9, 0.0));
        desc.set_transform(6, moved).expect("a place of the test");
        let tiny = Area { from: moved.translation, u: 1e-3 * area.u, v: 1e-3 * area.v, is_round: false };
        let other = Area { u: tiny.v, v: tiny.u, ..tiny };
        let steps = 300;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
        let exact: f64 = (0..steps * steps)
            .map(|i| glass.0 + at(i % steps) * glass.1 + at(i / steps) * glass.2)
            .map(|p| {
                [&tiny, &other].map(|side| side.irradiance(lamp, area.normal(), p, DVec3::X, 1)).iter().sum::<f64>()
            })
            .sum();
        let found = runs(|seed| stored(&shot(&build(&desc), &seeded(seed), MapKind::Caustic, paths)));
        let exact = 0.9 * exact / f64::from(steps * steps);
        case.biased_mean(format!("{what}: mirrored"), found, exact, (5e-4, pick(case, 5e-3, 2e-3)));
    }
}

/// More lamps than are chosen by power, some of which shine along the receiver's way only.
fn many(case: &mut Case) {
    let places = thousand_places(99);
    let areas: Vec<Area> = places
        .iter()
        .map(|to_scene| {
            let normal = to_scene.matrix3.z_axis.normalize();
            let (u, v) = normal.any_orthonormal_pair();
            Area { from: to_scene.translation, u: 0.03 * u, v: 0.03 * v, is_round: true }
        })
        .collect();
    let set = EmitterSet::new(areas.iter().map(|area| emitter(area, flat)).collect());
    for (what, p, n) in [
        ("below", Vec3::new(0.3, 0.2, 0.0), DVec3::Z),
        ("among them", Vec3::new(1.0, -1.0, 2.0), DVec3::X),
        ("far away", Vec3::new(-60.0, 30.0, 20.0), DVec3::new(60.0, -30.0, -20.0).normalize()),
    ] {
        let exact: f64 = areas.iter().map(|area| area.irradiance(flat, area.normal(), p.as_dvec3(), n, 20)).sum();
        case.biased_mean(what, irradiance(case, &set, p, n), exact / PI, (3e-4, 1e-2));
    }
}
