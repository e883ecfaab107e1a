//! The photon look-up: that it finds exactly what looking at every photon finds, wherever the photons are.

use std::collections::HashSet;

use etendue::integrator::photon::{Nearest, Photon, PhotonMap};
use etendue::math::Vec3;
use etendue::sampling::Rng;
use etendue::spectrum::Rgb;
use etendue::{Cancel, ErrorKind};
use proptest::prelude::*;

/// Relative error of a squared distance computed in single precision from exact coordinates: three roundings of a
/// difference's square, two of sums.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Photons at these places; the power says which is which.
fn photons(places: &[[f32; 3]]) -> Vec<Photon> {
    let one = |(i, &p): (usize, &[f32; 3])| Photon::new(Vec3::from(p), Vec3::Z, Vec3::Z, Rgb::splat(i as f32));
    places.iter().enumerate().map(one).collect()
}

fn build(places: &[[f32; 3]]) -> PhotonMap {
    PhotonMap::build(photons(places), &Cancel::new()).unwrap()
}

/// Which of the places it was built from a photon is at.
fn number(photon: &Photon) -> usize {
    photon.power[0] as usize
}

/// Distance of two places in double precision, squared.
fn exact2(a: &[f32; 3], b: Vec3) -> f64 {
    (0..3).map(|axis| (f64::from(a[axis]) - f64::from(b[axis])).powi(2)).sum()
}

/// Compares a query of each kind with a look at every place in double precision. Where rounding decides, either is right.
fn check(places: &[[f32; 3]], map: &PhotonMap, p: Vec3, radius: f32, count: usize) {
    let radius2 = f64::from(radius).powi(2);
    let label = format!("{} photons, {radius} around {p}", places.len());

    let mut seen = HashSet::new();
    map.within(p, radius, |photon, distance2| {
        assert!(seen.insert(number(photon)), "{label}: {} twice", number(photon));
        let exact = exact2(&places[number(photon)], p);
        assert!(exact < radius2 * (1.0 + ROUNDING), "{label}: {exact} is too far");
        let rounded = f64::from(distance2);
        let representable = exact > 1e-37 && exact < 3e38;
        assert!(!representable || (rounded / exact - 1.0).abs() < ROUNDING, "{label}: {rounded} for {exact}");
    });
    for (i, place) in places.iter().enumerate() {
        let exact = exact2(place, p);
        assert!(exact >= radius2 * (1.0 - ROUNDING) || seen.contains(&i), "{label}: {i} at {exact} is missing");
    }

    let mut nearest = Nearest::default();
    map.nearest(p, count, radius, &mut nearest);
    let found = nearest.found();
    assert_eq!(found.len(), count.min(seen.len()), "{label}");
    let of_map = |&(_, i): &(f32, u32)| exact2(&map.photons()[i as usize].p, p);
    let mut exact: Vec<f64> = places.iter().map(|place| exact2(place, p)).collect();
    exact.sort_unstable_by(f64::total_cmp);
    for (one, exact) in found.iter().zip(&exact) {
        assert!(of_map(one) <= exact * (1.0 + 2.0 * ROUNDING), "{label}: {} instead of {exact}", of_map(one));
    }
    let indices: HashSet<u32> = found.iter().map(|one| one.1).collect();
    assert_eq!(indices.len(), found.len(), "{label}");
    // Squares that are no normal numbers are equal more often than distances.
    let in_order = |a: &(f32, u32), b: &(f32, u32)| a.0 < b.0 || (a.0 == b.0 && (a.1 < b.1 || !a.0.is_normal()));
    assert!(found.is_sorted_by(in_order), "{label}");
}

/// That the map holds each photon once.
fn check_complete(places: &[[f32; 3]], map: &PhotonMap) {
    let numbers: HashSet<usize> = map.photons().iter().map(number).collect();
    assert_eq!((map.photons().len(), numbers.len()), (places.len(), places.len()));
    for photon in map.photons() {
        assert_eq!(photon.p.map(f32::to_bits), places[number(photon)].map(f32::to_bits));
    }
}

/// A place in the unit cube.
fn anywhere(rng: &mut Rng) -> [f32; 3] {
    [rng.next_f32(), rng.next_f32(), rng.next_f32()]
}

/// A room of unit size with photons on its walls, a third of them in a caustic of a ten-thousandth of a wall, and some on a
/// ball.
fn room(count: usize, rng: &mut Rng) -> Vec<[f32; 3]> {
    let one = |i: usize| {
        let [u, v, w] = anywhere(rng);
        match i % 12 {
            0..4 => [0.3 + 0.01 * u, 0.0, 0.7 + 0.01 * v],
            4 => {
                let z = 2.0 * u - 1.0;
                let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
                let r = 0.2 * (1.0 - z * z).sqrt();
                [0.5 + r * cos, 0.3 + r * sin, 0.5 + 0.2 * z]
            }
            i => {
                let mut p = [u, v, w];
                p[i % 3] = (i % 2) as f32;
                p
            }
        }
    };
    (0..count).map(one).collect()
}

#[test]
fn rooms_of_any_size_and_queries_of_any_radius() {
    let mut rng = Rng::new(1, 1);
    for count in [0, 1, 2, 7, 8, 9, 31, 32, 33, 127, 128, 129, 1000, 4097, 50_000] {
        let places = room(count, &mut rng);
        let map = build(&places);
        check_complete(&places, &map);
        for i in 0..50 {
            let p = if i % 2 == 0 || count == 0 { anywhere(&mut rng) } else { places[rng.next_u64() as usize % count] };
            let radius = 10_f32.powf(-4.0 + 4.5 * rng.next_f32());
            check(&places, &map, Vec3::from(p), radius, [1, 2, 50, 200][i % 4]);
        }
        check(&places, &map, Vec3::splat(0.5), f32::INFINITY, 70);
        check(&places, &map, Vec3::splat(1000.0), f32::INFINITY, 70);
        check(&places, &map, Vec3::splat(1000.0), 1.0, 70);
        check(&places, &map, Vec3::splat(0.5), f32::MAX, count + 10);
    }
}

#[test]
fn queries_that_ask_for_nothing_find_nothing() {
    let mut rng = Rng::new(2, 1);
    let map = build(&room(1000, &mut rng));
    let mut nearest = Nearest::default();
    let p = map.photons()[17].position();
    for (p, radius) in [(p, 0.0), (p, -0.0), (p, -1.0), (p, f32::NAN), (Vec3::NAN, 1.0), (Vec3::INFINITY, 1.0)] {
        map.within(p, radius, |photon, _| panic!("{photon:?} within {radius} of {p}"));
        map.nearest(p, 10, radius, &mut nearest);
        assert_eq!(nearest.found(), [], "{radius} around {p}");
    }
    map.nearest(p, 0, 1.0, &mut nearest);
    assert_eq!(nearest.found(), []);
    map.nearest(p, usize::MAX, f32::INFINITY, &mut nearest);
    assert_eq!(nearest.found().len(), 1000);
    // The least radius of all holds what is in the very place.
    map.nearest(p, 10, f32::from_bits(1), &mut nearest);
    assert_eq!(nearest.found(), [(0.0, 17)]);
    let mut found = 0;
    map.within(p, f32::from_bits(1), |_, _| found += 1);
    assert_eq!(found, 1);
}

#[test]
fn a_million_in_one_plane_on_one_line_and_in_one_point() {
    let mut rng = Rng::new(3, 1);
    let count = 1_000_000;
    let shapes: [&dyn Fn([f32; 3]) -> [f32; 3]; 5] = [
        &|[u, v, _]| [u, v, 0.25],
        &|[u, v, _]| [u, 1.0 - u, v],
        &|[u, _, _]| [0.5, u, 0.5],
        &|[u, _, _]| [u, u, u],
        &|_| [0.1, 0.2, 0.3],
    ];
    for shape in shapes {
        let places: Vec<_> = (0..count).map(|_| shape(anywhere(&mut rng))).collect();
        let map = build(&places);
        check_complete(&places, &map);
        for radius in [1e-6, 1e-3, 0.1, 10.0] {
            check(&places, &map, Vec3::from(shape(anywhere(&mut rng))), radius, 100);
        }
        check(&places, &map, Vec3::new(0.1, 0.2, 0.3), f32::INFINITY, 100);
    }
}

#[test]
fn photons_in_one_place_keep_their_order_and_are_found_by_index() {
    for count in [10_000, 1_000_000] {
        let map = build(&vec![[1.0, 2.0, 3.0]; count]);
        assert!(map.photons().iter().map(number).eq(0..count));
        let mut nearest = Nearest::default();
        for p in [Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO] {
            // Ties end the search: a walk through all of them for every query would take minutes.
            for _ in 0..10_000 {
                map.nearest(p, 50, f32::INFINITY, &mut nearest);
            }
            assert!(nearest.found().iter().map(|one| one.1).eq(0..50));
        }
    }
}

#[test]
fn huge_and_tiny_scenes() {
    let mut rng = Rng::new(4, 1);
    for size in [1e-44, 1e-38, 1e-30, 1e-20, 1e-10, 1e10, 1e18, 1e20, 1e30, 1e38] {
        let places: Vec<_> = room(3000, &mut rng).iter().map(|p| p.map(|v| (v - 0.5) * size)).collect();
        let map = build(&places);
        check_complete(&places, &map);
        for i in 0..40 {
            let p = Vec3::from(anywhere(&mut rng).map(|v| (v - 0.5) * size));
            let radius = size * 10_f32.powf(-3.0 + 3.0 * rng.next_f32());
            check(&places, &map, p, radius, [1, 50, 200][i % 3]);
        }
        check(&places, &map, Vec3::from(places[5]), f32::INFINITY, 100);
        check(&places, &map, Vec3::from(places[5]), f32::MAX, 100);
    }
}

#[test]
fn dense_spots_far_apart_are_in_order() {
    // A caustic of a hundredth of a unit and a ground of a million: cells of the whole scene see the caustic as a point.
    // That it is in order all the same shows in how much the look-up spends on it.
    let mut rng = Rng::new(5, 1);
    let place = |i: usize| match i % 3 {
        0 => anywhere(&mut rng).map(|v| (v - 0.5) * 2e6),
        1 => anywhere(&mut rng).map(|v| v * 1e-2),
        _ => anywhere(&mut rng).map(|v| 10.0 + v * 1e-4),
    };
    let places: Vec<_> = (0..300_000).map(place).collect();
    let map = build(&places);
    check_complete(&places, &map);
    for (corner, size) in [(0.0, 1e-2), (10.0, 1e-4)] {
        for _ in 0..20 {
            let p = Vec3::from(anywhere(&mut rng).map(|v| corner + v * size));
            check(&places, &map, p, size * 0.05, 50);
        }
    }
    let consecutive = |pair: &[Photon]| pair[0].position().distance(pair[1].position());
    let steps: Vec<f32> = map.photons().windows(2).map(consecutive).filter(|&step| step < 1e-2).collect();
    assert!(steps.len() > 199_000 && steps.iter().sum::<f32>() / (steps.len() as f32) < 1e-3);
}

#[test]
fn positions_that_are_no_numbers_do_no_harm() {
    let mut rng = Rng::new(6, 1);
    let mut places = room(5000, &mut rng);
    let bad = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for i in 0..500 {
        places[10 * i][i % 3] = bad[i % 4];
    }
    let map = build(&places);
    check_complete(&places, &map);
    let fit = |p: &[f32; 3]| p.iter().all(|v| v.is_finite());
    for radius in [0.01, 0.1, 10.0, f32::INFINITY] {
        let p = Vec3::splat(0.3);
        let (mut found, mut expected) = (HashSet::new(), HashSet::new());
        map.within(p, radius, |photon, _| assert!(found.insert(number(photon))));
        expected.extend((0..places.len()).filter(|&i| fit(&places[i]) && exact2(&places[i], p).sqrt() < radius.into()));
        assert_eq!(found, expected);
        let mut nearest = Nearest::default();
        map.nearest(p, 300, radius, &mut nearest);
        assert_eq!(nearest.found().len(), expected.len().min(300));
        assert!(nearest.found().iter().all(|one| fit(&map.photons()[one.1 as usize].p)));
    }
    for value in bad {
        let map = build(&vec![[value; 3]; 1000]);
        assert_eq!(map.photons().len(), 1000);
        map.within(Vec3::ZERO, f32::INFINITY, |_, _| panic!());
    }
}

#[test]
fn the_order_is_the_same_every_time_and_building_can_be_cancelled() {
    let mut rng = Rng::new(7, 1);
    let photons = photons(&room(20_000, &mut rng));
    let cancel = Cancel::new();
    let maps = [photons.clone(), photons.clone()].map(|photons| PhotonMap::build(photons, &cancel).unwrap());
    assert_eq!(maps[0].photons(), maps[1].photons());
    let orders = maps.map(|map| {
        let mut order = Vec::new();
        map.within(Vec3::new(0.305, 0.0, 0.705), 0.003, |photon, _| order.push(number(photon)));
        order
    });
    assert!(orders[0].len() > 100);
    assert_eq!(orders[0], orders[1]);
    cancel.cancel();
    assert_eq!(PhotonMap::build(photons, &cancel).unwrap_err().kind(), ErrorKind::Cancelled);
}

#[test]
fn memory_is_as_promised() {
    let mut rng = Rng::new(8, 1);
    let map = build(&room(100_000, &mut rng));
    // 32 of a photon, 12 of its place once more, and boxes.
    assert!(map.bytes() <= 48 * 100_000, "{}", map.bytes());
}

proptest! {
    #[test]
    fn any_photons_and_any_query(
        places in prop::collection::vec(prop::array::uniform3(-1e3_f32..1e3), 0..300),
        again in prop::collection::vec(any::<prop::sample::Index>(), 0..100),
        p in prop::array::uniform3(-2e3_f32..2e3),
        radius in 0.0_f32..4e3,
        count in 1_usize..120,
    ) {
        let mut places = places;
        if !places.is_empty() {
            let copies: Vec<_> = again.iter().map(|i| *i.get(&places)).collect();
            places.extend(copies);
        }
        let map = build(&places);
        check_complete(&places, &map);
        check(&places, &map, Vec3::from(p), radius, count);
    }

    #[test]
    fn any_bits_at_all(
        places in prop::collection::vec(prop::array::uniform3(prop::num::f32::ANY), 0..200),
        p in prop::array::uniform3(prop::num::f32::NORMAL),
        radius in prop::num::f32::POSITIVE,
    ) {
        let map = build(&places);
        check_complete(&places, &map);
        let fit: Vec<usize> = (0..places.len()).filter(|&i| places[i].iter().all(|v| v.is_finite())).collect();
        let mut found = HashSet::new();
        map.within(Vec3::from(p), radius, |photon, _| assert!(found.insert(number(photon))));
        for i in fit {
            let exact = exact2(&places[i], Vec3::from(p)).sqrt() / f64::from(radius);
            // Differences beyond the largest number are beyond any radius.
            let difference = (0..3).map(|axis| (places[i][axis] - p[axis]).abs()).fold(0.0, f32::max);
            prop_assert!(!(exact < 1.0 - 1e-5 && difference.is_finite()) || found.contains(&i));
            prop_assert!(exact < 1.0 + 1e-5 || !found.contains(&i));
        }
    }
}
