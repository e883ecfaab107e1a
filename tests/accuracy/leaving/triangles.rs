//! Triangles of every size and shape.

use etendue::desc::ShapeDesc;
use etendue::math::{DAffine3, DVec3, Ray};
use etendue::sampling::Rng;
use etendue::scene::{Scene, SurfaceInteraction};

use super::spawn::{
    GREY, LIST, Tally, away, build, met, offset, random_direction, random_point, random_power, shoot, signed, single,
};
use crate::common::scenes::add;
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "S22", title: "rays spawned on triangles", run: random_triangles },
        Entry { id: "S22a", title: "rays spawned on needles", run: needles },
        Entry { id: "S22b", title: "rays into a gap of ten offsets", run: gaps },
    ]
}

/// A number in [0, 1).
fn uniform(rng: &mut Rng) -> f64 {
    0.5 * (signed(rng) + 1.0)
}

fn extent([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).length().max((c - a).length()).max((c - b).length())
}

/// Extent over the smallest height: 1.15 where all sides are equal.
fn slimness(corners @ [a, b, c]: [DVec3; 3]) -> f64 {
    extent(corners).powi(2) / (b - a).cross(c - a).length()
}

/// Some points of a triangle seen from `distance` times its extent away, met by rays from nearby; `visit` is given the scene
/// and each of them.
fn points(
    corners @ [a, b, c]: [DVec3; 3],
    distance: f64,
    rng: &mut Rng,
    mut visit: impl FnMut(&Scene, &SurfaceInteraction, &mut Rng),
) {
    let extent = extent(corners);
    let eye = a + distance * extent * random_direction(rng);
    let scene = build(&single(ShapeDesc::Triangle(corners), DAffine3::IDENTITY, eye, a), LIST);
    let normal = (b - a).cross(c - a).normalize();
    for _ in 0..POINTS {
        let [u, v] = [uniform(rng), uniform(rng)];
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let aim = a + u * (b - a) + v * (c - a);
        let from = aim + 0.1 * extent * (normal * signed(rng).signum() + 0.7 * random_direction(rng));
        if let Some(from) = shoot(&scene, scene.to_scene(from), scene.to_scene(aim), 0) {
            visit(&scene, &from, rng);
        }
    }
}

/// Points on each triangle.
const POINTS: u64 = 10;

/// What was found about a family of triangles.
struct Found {
    rays: Tally,
    nearer: Tally,
    hits: u64,
    /// Largest offset over extent or coordinate, whichever is larger, and over the slimness of what is slim without a
    /// short side.
    offset: f64,
}

/// Leaves each triangle that `next` makes on both sides, and once more from points nearer to it by `factor`.
fn leave_all(
    [triangles, rays]: [u64; 2],
    distance: f64,
    factor: f32,
    rng: &mut Rng,
    mut next: impl FnMut(&mut Rng) -> [DVec3; 3],
) -> Found {
    let mut found = Found { rays: Tally::default(), nearer: Tally::with_bound_times(factor), hits: 0, offset: 0.0 };
    for _ in 0..triangles {
        let corners = next(rng);
        let extent = extent(corners);
        points(corners, distance, rng, |scene, from, rng| {
            found.hits += 1;
            let reach = f64::from(from.point.p.abs().max_element()).max(extent);
            for n in [from.ng, -from.ng] {
                found.offset = found.offset.max(offset(from, n) / reach / slimness(corners));
                found.rays.leave(scene, from, n, 10.0 * extent as f32, rays / POINTS, rng);
                found.nearer.leave(scene, from, n, 10.0 * extent as f32, 2, rng);
            }
        });
    }
    found
}

fn random_triangles(case: &mut Case) {
    let mut rng = Rng::new(22, 0);
    let budget = [case.count(200, 1000), case.count(100, 1000)];
    for (distance, seen) in [(1e-2, "from 0.01 extents"), (1.0, "from 1 extent"), (1e3, "from 10^3 extents")] {
        let found = leave_all(budget, distance, 0.02, &mut rng, |rng| {
            let size = 10_f64.powi((8.0 * signed(rng)).round() as i32);
            std::array::from_fn(|_| size * random_point(rng))
        });
        case.never(format!("10^±8, seen {seen}: met again"), found.rays.bad, found.rays.rays);
        case.at_most(format!("seen {seen}: offset / reach / slimness"), found.offset, 2e-6);
        if distance == 1.0 {
            let Tally { rays, bad, .. } = found.nearer;
            case.holds("a 50th of the bound", "some met again", format!("{bad} of {rays}"), bad > 0);
        }
    }
}

fn needles(case: &mut Case) {
    let mut rng = Rng::new(23, 0);
    let budget = [case.count(40, 1000), case.count(100, 1000)];
    let [mut usual, mut narrow, mut slim] = [0.0_f64; 3];
    for (has_short_side, kind) in [(true, "one short side"), (false, "three long sides")] {
        let mut nearer = Tally::with_bound_times(0.02);
        for aspect in [1e1, 1e2, 1e3, 1e4, 1e5, 1e6] {
            let mut rays = Tally::default();
            for distance in [1e-2, 1.0] {
                let found = leave_all(budget, distance, 0.02, &mut rng, |rng| {
                    let size = random_power(rng, -3.0, 3.0);
                    let long = random_direction(rng);
                    let across = long.cross(random_direction(rng)).normalize() / aspect;
                    let start = random_point(rng);
                    let at = if has_short_side { 0.0 } else { 0.5 + 0.4 * signed(rng) };
                    let mut corners = [start, start + long, start + at * long + across].map(|p| size * p);
                    corners.rotate_left((3.0 * uniform(rng)) as usize);
                    corners
                });
                rays.add(found.rays);
                nearer.add(found.nearer);
                let kept = match (has_short_side, aspect < 1e5) {
                    (true, true) => &mut usual,
                    (true, false) => &mut narrow,
                    (false, _) => &mut slim,
                };
                *kept = kept.max(found.offset * if has_short_side { aspect } else { 1.0 });
            }
            case.never(format!("{kind}, {aspect:e} : 1: met again"), rays.bad, rays.rays);
        }
        let Tally { rays, bad, .. } = nearer;
        case.holds(format!("{kind}, a 50th of the bound"), "some met again", format!("{bad} of {rays}"), bad > 0);
    }
    // Narrower ones are left by a sixteenth of their extent, whatever their bound: a neighbour may stand there.
    let (mut farthest, mut slivers) = (0.0_f64, Tally::default());
    for aspect in [1e7, 1e8] {
        let found = leave_all(budget, 1.0, 0.02, &mut rng, |rng| {
            let long = random_direction(rng);
            let across = long.cross(random_direction(rng)).normalize() / aspect;
            let start = random_point(rng);
            [start, start + long, start + (0.5 + 0.4 * signed(rng)) * long + across]
        });
        farthest = farthest.max(found.offset * aspect);
        slivers.add(found.rays);
    }
    case.at_most("three long sides, to 1e8 : 1: offset / reach", farthest, 0.07);
    case.never("three long sides, to 1e8 : 1: met again", slivers.bad, slivers.rays);
    // What has a short side is no dearer than other triangles, down to the width that single precision still tells.
    case.at_most("one short side, to 1e4 : 1: offset / reach", usual, 2e-6);
    case.at_most("one short side, to 1e6 : 1: offset / reach", narrow, 2e-5);
    case.at_most("three long sides: offset / reach / aspect", slim, 2e-7);
}

fn gaps(case: &mut Case) {
    let mut rng = Rng::new(24, 0);
    for (distance, seen) in [(1.0, "1 extent"), (1e3, "10^3 extents")] {
        let (mut missed, mut through, mut rays) = (0, 0, 0);
        let mut offset_over_reach = 0.0_f64;
        for _ in 0..case.count(200, 4000) {
            let size = random_power(&mut rng, -6.0, 6.0);
            let corners: [DVec3; 3] = std::array::from_fn(|_| size * random_point(&mut rng));
            if slimness(corners) > 10.0 {
                continue;
            }
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize();
            let extent = extent(corners);
            let eye = a + distance * extent * random_direction(&mut rng);
            let mut desc = single(ShapeDesc::Triangle(corners), DAffine3::IDENTITY, eye, a);
            let middle = (a + b + c) / 3.0;
            let from = middle + 0.1 * extent * normal;
            let shot = |scene: &Scene| shoot(scene, scene.to_scene(from), scene.to_scene(middle), 0);
            let Some(first) = shot(&build(&desc, LIST)) else { continue };
            let gap = 10.0 * offset(&first, -first.ng);
            // A larger one, parallel, on the far side.
            let other = corners.map(|corner| middle + 3.0 * (corner - middle) - gap * normal);
            add(&mut desc, 2, ShapeDesc::Triangle(other), GREY, None);
            let scene = build(&desc, LIST);
            let Some(from) = shot(&scene) else { continue };
            offset_over_reach = offset_over_reach.max(gap / 10.0 / extent.max(distance * extent));
            for _ in 0..50 {
                // The neighbour's edge is a thousand gaps away and more: so far a ray may go aside.
                let down = (away(-from.ng, &mut rng) - from.ng).normalize();
                missed += u64::from(met(&scene, &Ray::new(from.point.offset(-from.ng), down)) != Some(2));
                let up = Ray { tfar: extent as f32, ..Ray::new(from.point.offset(from.ng), away(from.ng, &mut rng)) };
                through += u64::from(met(&scene, &up).is_some());
                rays += 1;
            }
        }
        case.never(format!("seen from {seen}: the neighbour was missed"), missed, rays);
        case.never(format!("seen from {seen}: met on the other side"), through, rays);
        case.at_most(format!("seen from {seen}: offset / distance"), offset_over_reach, 2e-6);
    }
}
