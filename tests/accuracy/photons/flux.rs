//! Power: what light paths carry away, what becomes of it, and what is stored.

use std::f64::consts::PI;

use super::{RUNS, Surface, add_mesh, build, load, many_runs, runs, seeded, shot, stored, unseen};
use crate::common::scenes::{box_inside, point_light};
use crate::record::{Case, Entry, Within};
use crate::transport::{ball, glass, grey, mirror, parallelogram, pick};
use etendue::Alone;
use etendue::desc::{BsdfDesc, PhotonDesc, PhotonSharing, RenderDesc, ShapeDesc};
use etendue::integrator::photon::{MapKind, NARROW, Photon, PhotonBatch, PhotonJob, shoot};
use etendue::math::DVec3;
use etendue::scene::Scene;
use etendue::spectrum::Rgb;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "M63", title: "power sent out and what becomes of it", run: balance },
        Entry { id: "M63b", title: "power stored in closed rooms", run: closed_room },
        Entry { id: "M63c", title: "light that escapes", run: escaping },
        Entry { id: "M63d", title: "brighter and uneven lights", run: shares },
        Entry { id: "M63e", title: "photons aimed at glass and mirrors", run: guided },
        Entry { id: "M63f", title: "light paths cut short by memory", run: memory },
    ]
}

const KINDS: [MapKind; 4] = [MapKind::Direct, MapKind::Caustic, MapKind::Indirect, MapKind::Global];

/// The larger relative difference of two powers' channels.
fn off(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

fn floor() -> Surface {
    let shape = parallelogram(DVec3::new(-3.0, -1.0, 3.0), DVec3::X * 6.0, DVec3::Z * -6.0);
    (shape, BsdfDesc::Lambert { albedo: Rgb::new(0.8, 0.5, 0.2) }, None)
}

fn balance(case: &mut Case) {
    let paths = case.count(1 << 14, 1 << 18) as u32;
    let colour = Rgb::new(3.0, 0.5, 1e-3);
    let powers = |factor: f64| colour.to_f64().to_array().map(|channel| factor * channel);
    let triangle = ShapeDesc::Triangle([DVec3::ZERO, DVec3::X * 2.0, DVec3::Z * 0.5]);
    let lights: [(&str, Option<ShapeDesc>, f64); 3] = [
        ("point, 4 π I", None, 4.0 * PI),
        ("triangle, π L A", Some(triangle), PI * 0.5),
        ("sphere, π L A", Some(ball(DVec3::new(0.3, 0.2, 0.1), 0.3)), PI * 4.0 * PI * 0.09),
    ];
    for (name, shape, factor) in lights {
        let mut surfaces = vec![floor()];
        surfaces.extend(shape.map(|shape| (shape, BsdfDesc::Black, Some(colour))));
        let mut desc = unseen(surfaces);
        if shape.is_none() {
            let light = point_light(DVec3::new(0.1, 0.3, -0.2), 1.0);
            desc.lights.push(etendue::desc::PointLightDesc { intensity: colour, ..light });
        }
        let tally = shot(&build(&desc), &seeded(1), MapKind::Global, paths).tally;
        let worst = off(tally.emitted.to_array(), powers(factor));
        case.at_most(format!("{name}: sent out, worst channel off"), worst, 1e-6);
    }
    for name in ["cornell.json", "room.json", "caustic.json"] {
        let scene = build(&load(name));
        let power: [f64; 3] = scene.emitters().emitters().iter().map(|emitter| emitter.power()).sum::<DVec3>().into();
        for kind in KINDS {
            let plain = RenderDesc { photons: PhotonDesc { guided: false, ..PhotonDesc::default() }, ..seeded(1) };
            let tally = shot(&scene, &plain, kind, paths).tally;
            let found = tally.absorbed + tally.escaped + tally.left;
            let what = format!("{name}, {kind:?}: absorbed, escaped and left over sent out");
            case.at_most(what, off(found.to_array(), tally.emitted.to_array()), 1e-6);
            if kind == MapKind::Global && name != "caustic.json" {
                // The lamps of the third are of different colours, chosen by luminance: no channel is exact there.
                let worst = off(tally.emitted.to_array(), power);
                case.at_most(format!("{name}: sent out over the lamps' power"), worst, 1e-6);
            }
        }
    }
}

/// A box of this albedo, whose light of 1 W is a small ball in it, and a mirror.
fn room(albedo: f32, objects: Vec<(ShapeDesc, BsdfDesc)>) -> Scene {
    let radius = 0.05;
    let radiance = 1.0 / (PI * 4.0 * PI * radius * radius);
    let lamp = (ball(DVec3::new(0.2, 0.3, -0.1), radius), BsdfDesc::Lambert { albedo: Rgb::splat(albedo) });
    let mut surfaces = vec![(lamp.0, lamp.1, Some(Rgb::splat(radiance as f32)))];
    surfaces.extend(objects.into_iter().map(|(shape, bsdf)| (shape, bsdf, None)));
    let mut desc = unseen(surfaces);
    add_mesh(&mut desc, box_inside(DVec3::new(-1.0, -0.8, -1.5), DVec3::new(1.2, 1.0, 0.9)), grey(albedo), None);
    build(&desc)
}

fn closed_room(case: &mut Case) {
    let paths = case.count(1 << 9, 1 << 12) as u32;
    let clear = || vec![(ball(DVec3::new(-0.4, 0.0, -0.7), 0.4), glass(1.5, 1.0))];
    let shiny = || vec![(ball(DVec3::new(-0.4, 0.0, -0.7), 0.4), mirror(1.0))];
    for (albedo, tolerance) in [(0.5_f32, 4e-3), (0.9, 1e-2), (0.99, 4e-2)] {
        let exact = 1.0 / (1.0 - f64::from(albedo));
        let scene = room(albedo, Vec::new());
        let tolerance = pick(case, tolerance, 0.4 * tolerance);
        let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Global, paths)));
        case.mean(format!("albedo {albedo}"), found, exact, tolerance);
        for (what, objects) in [("glass", clear()), ("mirror", shiny())] {
            let scene = room(albedo, objects);
            let [global, parts] = many_runs(|seed| {
                let stored = |kind| stored(&shot(&scene, &seeded(seed), kind, paths));
                let parts = [MapKind::Direct, MapKind::Indirect].map(stored).iter().sum::<f64>();
                [stored(MapKind::Global), parts + stored(MapKind::Caustic)]
            });
            case.mean(format!("albedo {albedo}, {what} ball"), global, exact, tolerance);
            case.mean(format!("albedo {albedo}, {what} ball: direct, caustic and indirect"), parts, exact, tolerance);
        }
        for depth in [1, 2, 4, 16] {
            let exact = (1.0 - f64::from(albedo).powi(depth)) * exact;
            let found = runs(|seed| {
                let desc = RenderDesc { max_depth: Some(depth as u32), ..seeded(seed) };
                stored(&shot(&scene, &desc, MapKind::Global, paths))
            });
            case.mean(format!("albedo {albedo}, cut after {depth} hits"), found, exact, tolerance);
        }
    }
}

fn escaping(case: &mut Case) {
    // A point light at height 1 over a disk of radius 1: the share of the sphere that the disk fills.
    let disk = ShapeDesc::Disk { centre: DVec3::ZERO, normal: DVec3::Y, radius: 1.0 };
    let mut desc = unseen(vec![(disk, grey(0.5), None)]);
    desc.lights.push(point_light(DVec3::Y, 2.0));
    let scene = build(&desc);
    let power = 8.0 * PI;
    let share = 0.5 * (1.0 - 0.5_f64.sqrt());
    let paths = case.count(1 << 11, 1 << 17) as u32;
    let [kept, lost] = many_runs(|seed| {
        let shot = shot(&scene, &seeded(seed), MapKind::Global, paths);
        [stored(&shot), shot.tally.escaped.x]
    });
    let tolerance = pick(case, 3e-3, 3e-4);
    case.mean("disk under a point light: stored", kept, power * share, tolerance);
    // The disk sends half of what it gets out again.
    case.mean("disk under a point light: escaped", lost, power * (1.0 - 0.5 * share), tolerance);
    // From the middle of a sphere's open half nothing but what goes the other way is kept.
    let bounds = etendue::math::Bounds { min: DVec3::splat(-2.0), max: DVec3::new(2.0, 2.0, 0.5) };
    let bowl = ShapeDesc::Quadric { coefficients: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0], clip: bounds };
    let mut desc = unseen(vec![(bowl, grey(0.8), None)]);
    desc.lights.push(point_light(DVec3::ZERO, 1.0));
    let scene = build(&desc);
    // 3/4 of the sphere: first hits, and of what is sent back 3/4 again.
    let exact = 4.0 * PI * 0.75 / (1.0 - 0.75 * f64::from(0.8_f32));
    let found = runs(|seed| stored(&shot(&scene, &seeded(seed), MapKind::Global, paths)));
    case.mean("open sphere", found, exact, pick(case, 6e-3, 6e-4));
}

/// A floor under two point lights of these intensities.
fn two_lights(intensities: [f32; 2]) -> Scene {
    let mut desc = unseen(vec![floor()]);
    for (x, intensity) in [-1.0, 1.0].into_iter().zip(intensities) {
        desc.lights.push(point_light(DVec3::new(x, 0.0, 0.0), intensity));
    }
    build(&desc)
}

/// Largest power over least, red.
fn spread(photons: &[Photon]) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for photon in photons {
        least = least.min(f64::from(photon.power[0]));
        most = most.max(f64::from(photon.power[0]));
    }
    most / least
}

fn shares(case: &mut Case) {
    let paths = case.count(1 << 14, 1 << 18) as u32;
    for (what, factor) in [("twice", 2.0_f32), ("2^40 times", 2.0_f32.powi(40)), ("2^-40 times", 2.0_f32.powi(-40))] {
        let one = shot(&two_lights([1.0, 3.0]), &seeded(1), MapKind::Global, paths).photons;
        let other = shot(&two_lights([factor, 3.0 * factor]), &seeded(1), MapKind::Global, paths).photons;
        let scaled = |photon: &Photon| Photon { power: photon.power.map(|power| factor * power), ..*photon };
        let count = one.iter().zip(&other).filter(|(one, other)| scaled(one) != **other).count();
        let bad = count + one.len().abs_diff(other.len());
        case.never(format!("{what} the light: photons of other than that power"), bad as u64, one.len() as u64);
    }
    let direct = |intensities: [f32; 2]| shot(&two_lights(intensities), &seeded(1), MapKind::Direct, paths);
    for ratio in [100.0_f32, 1e6] {
        let shot = direct([1.0, ratio]);
        case.exact(
            format!("1 : {ratio}: largest power of a photon over the least"),
            spread(&shot.photons),
            1.0,
            Within::Relative(1e-6),
        );
        let emitted = 4.0 * PI * (1.0 + f64::from(ratio));
        case.exact(format!("1 : {ratio}: sent out"), shot.tally.emitted.x, emitted, Within::Relative(1e-6));
    }
    // The dim one's own light, by photons that come from its side: it is a hundredth of the other's, not lost.
    let dim = |scene: &Scene, shot: &PhotonBatch| -> f64 {
        let from = scene.to_scene(DVec3::NEG_X);
        let of_dim = |photon: &&Photon| (photon.position() - from).normalize().dot(photon.wi.get()) < -1.0 + 1e-6;
        shot.photons.iter().filter(of_dim).map(|photon| f64::from(photon.power[0])).sum()
    };
    let scene = two_lights([1.0, 100.0]);
    let alone = build(&{
        let mut desc = unseen(vec![floor()]);
        desc.lights.push(point_light(DVec3::new(-1.0, 0.0, 0.0), 1.0));
        desc
    });
    let [both, one] = many_runs(|seed| {
        let direct = |scene| shot(scene, &seeded(seed), MapKind::Direct, paths);
        [dim(&scene, &direct(&scene)), stored(&direct(&alone))]
    });
    case.equal_means("light of the dim one, beside a bright one and alone", both, one, pick(case, 3e-2, 1e-2));

    // By area: a large dim lamp and a small bright one.
    let lamp = |x: f64, side: f64| parallelogram(DVec3::new(x, 1.0, 0.0), DVec3::X * side, DVec3::Z * side);
    let lamps = [
        (lamp(-1.0, 1.0), BsdfDesc::Black, Some(Rgb::splat(1.0))),
        (lamp(1.0, 0.1), BsdfDesc::Black, Some(Rgb::splat(1e4))),
    ];
    let mut surfaces = vec![floor()];
    surfaces.extend(lamps);
    let scene = build(&unseen(surfaces));
    let [power, area] = [PhotonSharing::Power, PhotonSharing::Area].map(|sharing| {
        runs(|seed| {
            let desc = RenderDesc { photons: PhotonDesc { sharing, ..PhotonDesc::default() }, ..seeded(seed) };
            stored(&shot(&scene, &desc, MapKind::Global, paths))
        })
    });
    case.equal_means("shared by power and by area: light stored", power, area, pick(case, 2e-2, 6e-3));
}

fn guided(case: &mut Case) {
    let paths = case.count(1 << 12, 1 << 15) as u32;
    let lamp = parallelogram(DVec3::new(-0.2, 2.0, -0.2), DVec3::X * 0.4, DVec3::Z * 0.4);
    let side_lamp = ball(DVec3::new(-2.0, 0.5, 0.3), 0.1);
    let clear = |x: f64| (ball(DVec3::new(x, 0.0, 0.0), 0.5), glass(1.5, 1.0), None);
    let sheet = parallelogram(DVec3::new(-1.5, -0.9, -1.0), DVec3::Y * 1.2, DVec3::Z * 1.4);
    let lamps = || {
        vec![
            floor(),
            (lamp, BsdfDesc::Black, Some(Rgb::splat(4.0))),
            (side_lamp, BsdfDesc::Black, Some(Rgb::splat(1.0))),
        ]
    };
    let near_lamp = ball(DVec3::new(0.0, 0.75, 0.0), 0.2);
    let scenes: [(&str, Vec<Surface>); 4] = [
        ("a glass ball", vec![clear(0.0)]),
        ("two balls in line", vec![clear(0.0), clear(1.1), (sheet, mirror(0.9), None)]),
        ("a mirror sheet", vec![(sheet, mirror(0.9), None)]),
        ("a lamp within a group's ball", vec![clear(-0.6), clear(0.6), (near_lamp, BsdfDesc::Black, Some(Rgb::ONE))]),
    ];
    for (name, things) in scenes {
        let scene = build(&unseen(lamps().into_iter().chain(things).collect()));
        // All of it, and that on a patch of the floor.
        let found = |guided: bool| {
            many_runs(|seed| {
                let desc = RenderDesc { photons: PhotonDesc { guided, ..PhotonDesc::default() }, ..seeded(seed) };
                // Aimed photons are worth more each, so fewer of them show as much.
                let shot = shot(&scene, &desc, MapKind::Caustic, if guided { paths / 2 } else { 4 * paths });
                let centre = scene.to_scene(DVec3::new(0.1, -1.0, 0.1));
                let near = |photon: &&Photon| photon.position().distance(centre) < 1.0;
                [stored(&shot), shot.photons.iter().filter(near).map(|photon| f64::from(photon.power[0])).sum()]
            })
        };
        let ([all, patch], [plain_all, plain_patch]) = (found(true), found(false));
        case.equal_means(format!("{name}: all caustic light"), all, plain_all, pick(case, 3e-2, 1.2e-2));
        case.equal_means(format!("{name}: on a patch"), patch, plain_patch, pick(case, 8e-2, 3e-2));
    }
}

fn memory(case: &mut Case) {
    let scene = room(0.5, Vec::new());
    let paths = case.count(1 << 17, 1 << 20) as u32;
    let mut cut = 0;
    let found: Vec<f64> = (1..=u64::from(RUNS / 2))
        .map(|seed| {
            // Room for half of it at most.
            let job = PhotonJob {
                kind: MapKind::Global,
                paths,
                pass: 0,
                most: paths as usize,
                narrow_below: NARROW,
                time: 0.0,
            };
            let shot = shoot(&scene, &seeded(seed), job, &mut Alone::default()).expect("nothing stops it");
            cut += u64::from(shot.cut_from == Some(u64::from(paths)) && shot.photons.len() <= job.most);
            stored(&shot)
        })
        .collect();
    case.holds("ended within what memory holds", "every run", format!("{cut} runs"), cut == u64::from(RUNS / 2));
    case.mean("stored by fewer paths", crate::stats::mean_and_error(&found), 2.0, pick(case, 3e-3, 1e-3));
}
