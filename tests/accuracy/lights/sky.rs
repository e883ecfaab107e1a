//! Light from infinity by formula: parallel light, the disk of the sun, and the CIE's skies.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::desc::{
    BsdfDesc, DistantLightDesc, EnvironmentDesc, FormulaSkyDesc, IntegratorDesc, SceneDesc, ShapeDesc, SkyDesc,
};
use etendue::emitter::SkyFormula;
use etendue::film::Image;
use etendue::math::DVec3;
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

use super::{irradiance, lit, sphere_factor};
use crate::common::scenes::{Job, camera, mean_and_error, render, render_scene, scene};
use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "L60", title: "light of the sun", run: sun },
        Entry { id: "L61", title: "the sun in a mirror", run: mirrored },
        Entry { id: "L62", title: "skies by formula, by points", run: skies },
        Entry { id: "L63", title: "skies by formula, by all methods", run: pictures },
    ]
}

/// The methods that draw what light from infinity gives, and how far they may be off beside their error.
pub const METHODS: [(IntegratorDesc, f64); 8] = [
    (IntegratorDesc::Path, 0.0),
    (IntegratorDesc::Direct, 0.0),
    (IntegratorDesc::Whitted, 0.0),
    (IntegratorDesc::Caustic, 0.0),
    (IntegratorDesc::IrradianceCache, 0.0),
    (IntegratorDesc::Photon, 1e-2),
    (IntegratorDesc::Sppm, 1e-2),
    (IntegratorDesc::PhotonDirect, 1e-2),
];

/// A picture with so many photons that their own noise, which all pixels share, is small beside what methods may be off. Where all that is
/// seen is their light, these are many in the test too.
pub fn drawn(case: &Case, desc: &SceneDesc, integrator: IntegratorDesc, samples: u32) -> Image {
    let scene = Scene::build(desc, &BuildOptions::default()).expect("a scene of the test");
    let mut settings = Job { samples, integrator, ..Job::default() }.desc();
    let quick = if integrator == IntegratorDesc::PhotonDirect { 1 << 18 } else { 1 << 16 };
    settings.photons.count = Some(case.count(quick, 1 << 18) as u32);
    render_scene(&scene, settings).0
}

/// A white floor, whose normal is z, by all methods.
fn by_all_methods(case: &mut Case, what: &str, desc: &SceneDesc, exact: f64) {
    let samples = case.count(64, 1024) as u32;
    for (integrator, bias) in METHODS {
        let (mean, error) = mean_and_error(&drawn(case, desc, integrator, samples));
        // All pixels see the same photons, whose errors are then not those of independent pixels.
        case.biased_mean(format!("{what}, by {integrator:?}"), (mean, error), exact, (bias.max(1e-4), 1e-2));
    }
}

fn sun(case: &mut Case) {
    let point = etendue::math::Vec3::new(0.3, -0.2, 0.0);
    for degrees in [0.0, 1e-3, 0.533, 10.0, 60.0, 180.0] {
        for tilt in [0.0_f64, 40.0, 80.0, 89.9] {
            let towards =
                DVec3::new(0.6 * tilt.to_radians().sin(), 0.8 * tilt.to_radians().sin(), tilt.to_radians().cos());
            let light =
                DistantLightDesc { angle_deg: degrees, ..DistantLightDesc::parallel(towards * 7.0, Rgb::splat(3.0)) };
            let mut desc = lit(1.0, 0.1, vec![]);
            desc.add_distant_light(light).expect("a light of the test");
            let scene = Scene::build(&desc, &BuildOptions::default()).expect("a scene of the test");
            let half = (0.5 * degrees).to_radians();
            // Where all of the disk is above the horizon, as from its middle; else what is left of a ball that has this size.
            let exact = if degrees == 0.0 {
                3.0 * tilt.to_radians().cos()
            } else {
                3.0 / half.sin().powi(2) * sphere_factor(half.sin(), tilt.to_radians())
            };
            let (mean, error) = irradiance(case, scene.emitters(), point, DVec3::Z);
            let what = format!("{degrees} degrees wide, {tilt} from the normal");
            if degrees < 0.01 && half.to_degrees() + tilt < 90.0 {
                // Single precision holds directions to some 10^-7, which counts where light grazes.
                case.exact(what, mean * PI, exact, Within::Relative(1e-7 / tilt.to_radians().cos() + 1e-6));
            } else {
                case.mean(what, (mean * PI, error * PI), exact, 4e-3);
            }
        }
    }
    let mut desc = lit(1.0, 0.1, vec![]);
    let parallel = DistantLightDesc::parallel(DVec3::new(0.6, 0.0, 0.8), Rgb::splat(3.0));
    desc.add_distant_light(parallel.clone()).expect("a light of the test");
    by_all_methods(case, "parallel light", &desc, 0.8 * 3.0 / PI);
    let disk = DistantLightDesc { angle_deg: 20.0, ..parallel };
    desc.set_distant_light(0, disk).expect("a light of the test");
    by_all_methods(case, "a disk 20 degrees wide", &desc, 0.8 * 3.0 / PI);
}

/// Mirrors see the disk, glossy and smooth, and cameras unless they are not to; parallel light is in no mirror.
fn mirrored(case: &mut Case) {
    let towards = DVec3::new(0.0, 0.6, 0.8);
    let light =
        |degrees| DistantLightDesc { angle_deg: degrees, ..DistantLightDesc::parallel(towards, Rgb::splat(3.0)) };
    let of = |bsdf: BsdfDesc, light: DistantLightDesc| {
        let eye = DVec3::new(0.0, -0.6, 0.8) * 4.0;
        let mut desc = scene(camera(eye, DVec3::ZERO, 1.0), vec![(big_square(), bsdf, None)]);
        desc.add_distant_light(light).expect("a light of the test");
        render(&desc, &Job { samples: 64, ..Job::default() }).0.mean()[0]
    };
    let mirror = || BsdfDesc::Mirror { reflectance: Rgb::splat(0.5) };
    let radiance = 3.0 / (PI * 10_f64.to_radians().sin().powi(2));
    case.exact("the disk in a mirror", of(mirror(), light(20.0)), 0.5 * radiance, Within::Relative(1e-5));
    let hidden = DistantLightDesc { visible: false, ..light(20.0) };
    case.exact("one that cameras do not see", of(mirror(), hidden.clone()), 0.5 * radiance, Within::Relative(1e-5));
    case.exact("parallel light in a mirror", of(mirror(), light(0.0)), 0.0, Within::Absolute(0.0));
    for (what, light, exact) in
        [("the disk itself", light(20.0), radiance), ("one that cameras do not see", hidden, 0.0)]
    {
        let mut desc = scene(camera(DVec3::Z, DVec3::Z + towards, 1.0), vec![(big_square(), mirror(), None)]);
        desc.add_distant_light(light).expect("a light of the test");
        let mean = render(&desc, &Job { samples: 16, ..Job::default() }).0.mean()[0];
        case.exact(format!("{what}, seen"), mean, exact, Within::Absolute(1e-5 * radiance));
    }
}

/// A square about the origin, whose normal is z.
fn big_square() -> ShapeDesc {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    ShapeDesc::Triangle([corner(-9.0, -9.0), corner(27.0, -9.0), corner(-9.0, 27.0)])
}

/// The numbers of ISO 15469:2004, table 1, by gradation and indicatrix group.
const GRADATIONS: [[f64; 2]; 6] = [[4.0, -0.70], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];
const INDICATRICES: [[f64; 3]; 6] = [
    [0.0, -1.0, 0.0],
    [2.0, -1.5, 0.15],
    [5.0, -2.5, 0.30],
    [10.0, -3.0, 0.45],
    [16.0, -3.0, 0.30],
    [24.0, -2.8, 0.15],
];
/// Which groups each type has.
const GROUPS: [[usize; 2]; 15] = [
    [0, 0],
    [0, 1],
    [1, 0],
    [1, 1],
    [2, 0],
    [2, 1],
    [2, 2],
    [2, 3],
    [3, 1],
    [3, 2],
    [3, 3],
    [4, 3],
    [4, 4],
    [5, 4],
    [5, 5],
];

/// Luminance over that of the zenith.
pub fn relative(number: usize, towards: DVec3, sun: DVec3) -> f64 {
    let [gradation, indicatrix] = GROUPS[number - 1];
    let ([a, b], [c, d, e]) = (GRADATIONS[gradation], INDICATRICES[indicatrix]);
    let phi = |zenith: f64| 1.0 + a * (b / zenith.cos()).exp();
    let f = |chi: f64| 1.0 + c * ((d * chi).exp() - (d * FRAC_PI_2).exp()) + e * chi.cos().powi(2);
    let (chi, sun_zenith) = (towards.angle_between(sun), sun.angle_between(DVec3::Z));
    phi(towards.angle_between(DVec3::Z)) * f(chi) / (phi(0.0) * f(sun_zenith))
}

/// What a surface with this normal gets from a sky of radiance 1 at the zenith, z, and from the ground.
pub fn received(number: usize, sun: DVec3, normal: DVec3, albedo: f64) -> f64 {
    const STEPS: u32 = 2400;
    const AROUND: u32 = 600;
    let (mut all, mut horizontal, mut from_ground) = (0.0, 0.0, 0.0);
    for j in 0..STEPS {
        let angle = PI * (f64::from(j) + 0.5) / f64::from(STEPS);
        let solid = angle.sin() * PI / f64::from(STEPS) * 2.0 * PI / f64::from(AROUND);
        for i in 0..AROUND {
            let around = 2.0 * PI * (f64::from(i) + 0.5) / f64::from(AROUND);
            let d = DVec3::new(angle.sin() * around.cos(), angle.sin() * around.sin(), angle.cos());
            let cosine = d.dot(normal).max(0.0);
            if d.z > 0.0 {
                let radiance = relative(number, d, sun);
                all += radiance * cosine * solid;
                horizontal += radiance * d.z * solid;
            } else {
                from_ground += cosine * solid;
            }
        }
    }
    all + from_ground * albedo * horizontal / PI
}

/// Light of a sky over a white floor.
fn under(sky: FormulaSkyDesc, radiance: f32) -> SceneDesc {
    let mut desc = lit(1.0, 0.1, vec![]);
    let environment = EnvironmentDesc { sky: SkyDesc::Formula(sky), ..EnvironmentDesc::even(Rgb::splat(radiance)) };
    desc.set_environment_desc(Some(environment)).expect("a sky of the test");
    desc
}

fn skies(case: &mut Case) {
    let point = etendue::math::Vec3::new(0.1, 0.2, 0.0);
    for number in 1..=15 {
        for (i, sun) in [DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.5, 0.8, 0.33).normalize()].into_iter().enumerate() {
            // Each sky by one of the suns.
            if !case.is_full() && (number + i) % 2 != 0 {
                continue;
            }
            let formula = SkyFormula::cie(number as u32).expect("a type");
            let sky =
                FormulaSkyDesc { up: DVec3::Z * 3.0, ground: Rgb::splat(0.3), ..FormulaSkyDesc::new(formula, sun) };
            let scene = Scene::build(&under(sky, 2.0), &BuildOptions::default()).expect("a scene of the test");
            for (what, normal) in [("floor", DVec3::Z), ("wall", DVec3::new(0.8, 0.6, 0.0))] {
                let exact = 2.0 * received(number, sun, normal, 0.3);
                let (mean, error) = irradiance(case, scene.emitters(), point, normal);
                let what = format!("type {number}, sun {:.0} degrees high, {what}", sun.z.asin().to_degrees());
                case.mean(what, (mean * PI, error * PI), exact, 4e-3);
            }
            if number % 5 == 2 {
                let sky = FormulaSkyDesc { is_horizontal: true, ..sky };
                let scene = Scene::build(&under(sky, 2.0), &BuildOptions::default()).expect("a scene of the test");
                let (mean, error) = irradiance(case, scene.emitters(), point, DVec3::Z);
                case.mean(
                    format!("type {number}, of a given horizontal irradiance"),
                    (mean * PI, error * PI),
                    2.0,
                    4e-3,
                );
            }
        }
    }
}

fn pictures(case: &mut Case) {
    let sun = DVec3::new(0.6, 0.0, 0.8);
    for number in [1, 12] {
        let formula = SkyFormula::cie(number as u32).expect("a type");
        let sky = FormulaSkyDesc { up: DVec3::Z, ..FormulaSkyDesc::new(formula, sun) };
        let exact = 2.0 * received(number, sun, DVec3::Z, 0.0) / PI;
        by_all_methods(case, &format!("type {number}"), &under(sky, 2.0), exact);
    }
}
