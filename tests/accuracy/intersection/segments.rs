//! Where shadow rays end: blockers just before a light block, the light and what is behind it do not.

use etendue::desc::{SceneDesc, ShapeDesc};
use etendue::integrator::{Direct, Integrator as _, Tracer};
use etendue::math::{DAffine3, DVec3, Ray, Vec3};
use etendue::sampling::{Pattern, PatternSampler, Rng, Sampler as _};
use etendue::scene::{Hit, Scene};
use etendue::spectrum::Rgb;

use super::{GREY, PLACES, build, in_cube, tally};
use crate::common::scenes::{point_light, scene};
use crate::record::{Case, Entry};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "I18", title: "ends of shadow rays", run: segment_ends }]
}

/// Traces, and keeps what the last shadow ray was answered.
struct Listener<'s> {
    scene: &'s Scene,
    is_free: Option<bool>,
}

impl Tracer for Listener<'_> {
    fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.scene.intersect(ray)
    }

    fn unoccluded(&mut self, ray: &Ray) -> bool {
        let is_free = self.scene.unoccluded(ray);
        self.is_free = Some(is_free);
        is_free
    }
}

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
        Lamp::Quad => surfaces.push((sheet(1.0, 0.05), GREY, Some(Rgb::ONE))),
        // Its nearest point at D.
        Lamp::Sphere => {
            let centre = DVec3::Z * 1.05 * distance;
            surfaces.push((ShapeDesc::Sphere { centre, radius: 0.05 * distance }, GREY, Some(Rgb::ONE)));
        }
        Lamp::Point => {}
    }
    if let Some(z) = blocker {
        surfaces.push((sheet(z, 0.5), GREY, None));
    }
    // What is lit, and a wall behind the eye, which keeps the frame where the eye is.
    let corner = |x: f64, y: f64| distance * DVec3::new(x, y, 0.0);
    surfaces.push((
        ShapeDesc::Quad([corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)]),
        GREY,
        None,
    ));
    surfaces.push((sheet(-1.0, 2.0), GREY, None));
    let camera = crate::common::scenes::camera(distance * eye, DVec3::Z * distance, 60.0);
    let mut desc = scene(camera, surfaces);
    if matches!(lamp, Lamp::Point) {
        desc.lights.push(point_light(DVec3::Z * distance, 1.0));
    }
    desc
}

/// Whether light that is sampled from somewhere about the origin arrives there; `None` where none was sampled.
fn arrives(scene: &Scene, distance: f64, rng: &mut Rng) -> Option<bool> {
    let over = distance * (0.1 * in_cube(rng, 1.0) + 0.15 * DVec3::Z);
    let mut sampler = PatternSampler::new(Pattern::Random, rng.next_u64(), 1);
    sampler.start(0, 0);
    let mut listener = Listener { scene, is_free: None };
    let down = Ray::new(scene.to_scene(over), Vec3::NEG_Z);
    Direct { shadow_rays: 1 }.radiance(scene, down, &mut sampler, &mut listener, &mut |_| {});
    listener.is_free
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
                    let [a, b, c, sampled] = tally(tries, 180 + number as u64, |rng| {
                        let seed = rng.next_u64();
                        let free = |scene: &Scene| arrives(scene, distance, &mut Rng::new(seed, 0));
                        let [alone, before, behind] = scenes.each_ref().map(free);
                        // On a ball's side, the sheet at (1 + 1e-5) D is before the light.
                        let is_behind = matches!(lamp, Lamp::Quad | Lamp::Point);
                        [
                            alone == Some(false),
                            before == Some(true),
                            is_behind && behind == Some(false),
                            alone.is_some(),
                        ]
                    });
                    lit += a;
                    before += b;
                    behind += c;
                    total += sampled;
                }
            }
        }
        case.never(format!("{name}, D = 1e-3 to 1e5: the light blocks itself"), lit, total);
        case.never(format!("{name}: a blocker at (1 - 1e-5) D is missed"), before, total);
        if !matches!(lamp, Lamp::Sphere) {
            case.never(format!("{name}: a blocker at (1 + 1e-5) D blocks"), behind, total);
        }
    }

    // A lamp mounted on a ceiling without thickness.
    let (mut dark, mut total) = (0, 0);
    for distance in [1e-3, 1.0, 1e5] {
        for eye in eyes {
            let scene = build(&hall(Lamp::Point, distance, Some(1.0), eye), 16);
            let tries = case.count(1000, 50_000);
            let [blocked, sampled] = tally(tries, 185, |rng| {
                let answer = arrives(&scene, distance, rng);
                [answer == Some(false), answer.is_some()]
            });
            dark += blocked;
            total += sampled;
        }
    }
    case.never("point, exactly on a ceiling: the ceiling blocks", dark, total);

    // Lamps seen at grazing angles, where the way off them is longest.
    let tries = case.count(20_000, 4_000_000);
    for distance in [1e-3, 1.0, 1e5] {
        let mut desc = hall(Lamp::Quad, distance, None, DVec3::ZERO);
        let tilt = DAffine3::from_translation(DVec3::Z * distance)
            * DAffine3::from_rotation_x(1.56)
            * DAffine3::from_translation(-DVec3::Z * distance);
        desc.surfaces[0].transform = tilt;
        let scene = build(&desc, 16);
        let [lit] = tally(tries, 190, |rng| [arrives(&scene, distance, rng) == Some(false)]);
        case.never(format!("quad at 0.6 degrees, D = {distance:e}: the light blocks itself"), lit, tries);
    }
}
