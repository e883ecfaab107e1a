//! Where shadow rays end: blockers just before a light block, the light and what is behind it do not.

use etendue::desc::{SceneDesc, ShapeDesc};
use etendue::math::{DAffine3, DVec3, HitPoint, Ray, Vec3};
use etendue::sampling::Rng;
use etendue::scene::Scene;

use super::{GREY, PLACES, build, in_cube, tally};
use crate::common::scenes::{point_light, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "I18", title: "ends of shadow rays", run: segment_ends }]
}

/// A shadow ray ends this share before its target, as light transport has it.
const SHADOW_END: f32 = 1.0 - 16.0 * f32::EPSILON;

#[derive(Clone, Copy)]
enum Lamp {
    Quad,
    Sphere,
    Point,
}

/// A lamp at z = D, a tenth of that in size, seen from around the origin; a blocker across the way at z = `blocker` D.
fn hall(lamp: Lamp, distance: f64, blocker: Option<f64>, eye: DVec3) -> SceneDesc {
    let sheet = |z: f64, half: f64| {
        let corner = |x: f64, y: f64| distance * DVec3::new(half * x, half * y, z);
        // Towards the origin.
        ShapeDesc::Quad([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)])
    };
    let mut surfaces = Vec::new();
    match lamp {
        Lamp::Quad => surfaces.push((sheet(1.0, 0.05), GREY, Some(Vec3::ONE))),
        // Its nearest point at D.
        Lamp::Sphere => {
            let centre = DVec3::Z * 1.05 * distance;
            surfaces.push((ShapeDesc::Sphere { centre, radius: 0.05 * distance }, GREY, Some(Vec3::ONE)));
        }
        Lamp::Point => {}
    }
    if let Some(z) = blocker {
        surfaces.push((sheet(z, 0.5), GREY, None));
    }
    // A wall behind the eye keeps the frame where the eye is.
    surfaces.push((sheet(-1.0, 2.0), GREY, None));
    let camera = crate::common::scenes::camera(distance * eye, DVec3::Z * distance, 60.0);
    let mut desc = scene(camera, surfaces);
    if matches!(lamp, Lamp::Point) {
        desc.lights.push(point_light(DVec3::Z * distance, 1.0));
    }
    desc
}

/// A shadow ray towards a sample of the lamp from somewhere about the origin.
fn shadow(scene: &Scene, distance: f64, rng: &mut Rng) -> Option<Ray> {
    let p = scene.to_scene(distance * 0.1 * in_cube(rng, 1.0));
    let light = scene.emitters().sample(p, [(); 4].map(|()| rng.next_f32()))?;
    // From a surface that faces the lamp.
    let origin = HitPoint { p, error: HitPoint::rounding_error(p, Vec3::Z) }.offset(Vec3::Z);
    Some(Ray { origin, direction: light.target - origin, tnear: 0.0, tfar: SHADOW_END })
}

fn segment_ends(case: &mut Case) {
    // The frame's origin near the surface that is lit, near the lamp, and off to the side.
    let eyes = [DVec3::ZERO, DVec3::Z * 0.9, DVec3::new(0.4, 0.4, 0.3)];
    for (name, lamp) in [("quad", Lamp::Quad), ("sphere", Lamp::Sphere), ("point", Lamp::Point)] {
        let (mut lit, mut before, mut behind, mut total) = (0, 0, 0, 0);
        let tries = case.count(1000, 50_000);
        for distance in [1e-3, 1.0, 1e3, 1e5] {
            for (number, eye) in eyes.into_iter().enumerate() {
                for (listed, _) in PLACES {
                    let scenes = [None, Some(1.0 - 1e-5), Some(1.0 + 1e-5)]
                        .map(|blocker| build(&hall(lamp, distance, blocker, eye), listed));
                    let [a, b, c] = tally(tries, 180 + number as u64, |rng| {
                        let seed = rng.next_u64();
                        let free = |scene: &Scene| {
                            let ray = shadow(scene, distance, &mut Rng::new(seed, 0));
                            ray.map(|ray| scene.unoccluded(&ray))
                        };
                        let [alone, before, behind] = scenes.each_ref().map(free);
                        // On a ball's side, the sheet at (1 + 1e-5) D is before the light.
                        let is_behind = matches!(lamp, Lamp::Quad | Lamp::Point);
                        [alone == Some(false), before == Some(true), is_behind && behind == Some(false)]
                    });
                    lit += a;
                    before += b;
                    behind += c;
                    total += tries;
                }
            }
        }
        case.never(format!("{name}, D = 1e-3 to 1e5: the light blocks itself"), lit, total);
        case.never(format!("{name}: a blocker at (1 - 1e-5) D is missed"), before, total);
        if !matches!(lamp, Lamp::Sphere) {
            case.never(format!("{name}: a blocker at (1 + 1e-5) D blocks"), behind, total);
        }
    }

    // Lamps seen at grazing angles, where the way off them is longest.
    let tries = case.count(20_000, 4_000_000);
    for distance in [1e-3, 1.0, 1e5] {
        let mut desc = hall(Lamp::Quad, distance, None, DVec3::ZERO);
        let tilt = DAffine3::from_translation(DVec3::Z * distance)
            * DAffine3::from_rotation_x(1.56)
            * DAffine3::from_translation(-DVec3::Z * distance);
        desc.surfaces[0].transform = tilt;
        let scene = build(&desc, 16);
        let [lit] = tally(tries, 190, |rng| [shadow(&scene, distance, rng).is_some_and(|ray| !scene.unoccluded(&ray))]);
        case.never(format!("quad at 0.6 degrees, D = {distance:e}: the light blocks itself"), lit, tries);
    }
}
