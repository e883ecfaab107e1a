//! Closed rooms whose walls all emit Le and reflect a share a: the radiance everywhere is Le / (1 - a), whatever the shape
//! of the room, what stands in it, and how a wall scatters as long as its albedo is a for every direction.

mod common;

use common::scenes::{Job, box_inside, camera, mean_and_error, render, scene};
use etendue::desc::{BsdfDesc, IntegratorDesc, SceneDesc, ShapeDesc};
use etendue::math::{Bounds, DVec3, Vec3};

const EYE: DVec3 = DVec3::new(0.3, -0.2, 0.1);

/// A box of emitting walls with a sphere in it.
fn room(wall: BsdfDesc, le: f32, object: Option<(ShapeDesc, BsdfDesc)>) -> SceneDesc {
    let walls = ShapeDesc::Mesh { mesh: 0, smooth: false };
    let mut surfaces = vec![(walls, wall, Some(Vec3::splat(le)))];
    surfaces.extend(object.map(|(shape, bsdf)| (shape, bsdf, None)));
    let mut desc = scene(camera(EYE, DVec3::new(-0.4, 0.1, -1.0), 100.0), surfaces);
    desc.meshes.push(box_inside(DVec3::new(-1.0, -0.8, -1.5), DVec3::new(1.2, 1.0, 0.9)).into());
    desc
}

fn ball() -> ShapeDesc {
    ShapeDesc::Sphere { centre: DVec3::new(-0.3, 0.0, -0.8), radius: 0.4 }
}

/// |mean - exact| within 5 standard errors and 0.1 %, and a standard error small enough to prove it.
fn check(what: &str, desc: &SceneDesc, job: &Job, exact: f64) {
    let (image, _) = render(desc, job);
    let (mean, error) = mean_and_error(&image);
    println!("{what}: {mean:.6} +- {error:.6}, exact {exact:.6}");
    assert!(error < 0.25e-3 * exact, "{what}: the error {error} of {mean} proves nothing");
    assert!((mean - exact).abs() <= 5.0 * error + 1e-6 * exact, "{what}: {mean} +- {error} instead of {exact}");
    assert!((mean - exact).abs() <= 1e-3 * exact, "{what}: {mean} instead of {exact}");
}

#[test]
fn lambert_walls() {
    for (albedo, samples) in [(0.5, 1536), (0.9, 6144)] {
        let exact = 1.0 / (1.0 - f64::from(albedo));
        let wall = BsdfDesc::Lambert { albedo: Vec3::splat(albedo) };
        let job = Job { samples, ..Job::default() };
        check(&format!("Lambert {albedo}, path"), &room(wall, 1.0, None), &job, exact);
    }
}

#[test]
fn cut_after_n_hits() {
    // N hits are N reflections: Le (1 - a^(N + 1)) / (1 - a).
    let wall = BsdfDesc::Lambert { albedo: Vec3::splat(0.9) };
    for (hits, exact) in [(4, 4.0951), (16, 8.332_281_83)] {
        let job = Job { samples: 4096, max_depth: Some(hits), ..Job::default() };
        check(&format!("cut after {hits}"), &room(wall, 1.0, None), &job, exact);
    }
}

#[test]
fn direct_and_whitted_scatter_once() {
    let wall = BsdfDesc::Lambert { albedo: Vec3::splat(0.6) };
    for integrator in [IntegratorDesc::Direct, IntegratorDesc::Whitted] {
        let job = Job { samples: 256, integrator, ..Job::default() };
        check(&format!("{integrator:?}"), &room(wall, 2.0, None), &job, 2.0 * 1.6);
    }
}

#[test]
fn mirrors_and_glass_vanish() {
    let wall = BsdfDesc::Lambert { albedo: Vec3::splat(0.5) };
    let mirror = BsdfDesc::Mirror { reflectance: Vec3::ONE };
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let ellipsoid = ShapeDesc::Quadric {
        coefficients: [9.0, 16.0, 4.0, 0.0, 0.0, 0.0, 2.7, 0.0, 3.2, 2.37],
        clip: Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
    };
    let job = Job { samples: 8192, ..Job::default() };
    for (what, shape, bsdf) in [
        ("mirror ball", ball(), mirror),
        ("glass ball", ball(), glass),
        ("mirror ellipsoid", ellipsoid, mirror),
        ("glass ellipsoid", ellipsoid, glass),
    ] {
        check(what, &room(wall, 1.0, Some((shape, bsdf))), &job, 2.0);
    }
}

#[test]
fn whitted_sees_through_glass_and_mirrors() {
    // Black walls: what arrives is Le along every chain of reflections and refractions.
    let mirror = BsdfDesc::Mirror { reflectance: Vec3::splat(0.8) };
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let job = Job { samples: 64, integrator: IntegratorDesc::Whitted, ..Job::default() };
    check("Whitted, glass", &room(BsdfDesc::Black, 1.0, Some((ball(), glass))), &job, 1.0);
    check("Whitted, mirror walls", &room(mirror, 1.0, None), &job, 5.0);
    check("Whitted, glass in mirrors", &room(mirror, 1.0, Some((ball(), glass))), &job, 5.0);
    let job = Job { integrator: IntegratorDesc::Direct, ..job };
    check("direct, mirror walls", &room(mirror, 1.0, None), &job, 1.8);
}

#[test]
fn a_scenes_own_survival_probability_changes_nothing() {
    // Certain survival among them: such a path must end too.
    for (survival, samples) in [(0.8, 4096), (1.0, 1536)] {
        let mut desc = room(BsdfDesc::Lambert { albedo: Vec3::splat(0.5) }, 1.0, None);
        desc.materials[0].survival = Some(survival);
        check(&format!("survival {survival}"), &desc, &Job { samples, ..Job::default() }, 2.0);
    }
}

#[test]
fn mirror_walls() {
    let mirror = BsdfDesc::Mirror { reflectance: Vec3::splat(0.8) };
    check("mirror walls, path", &room(mirror, 1.0, None), &Job { samples: 8192, ..Job::default() }, 5.0);
}

#[test]
fn rough_diffuse_surfaces_show_their_albedo() {
    // Under uniform light a surface shows its directional albedo, here by quadrature (sigma 0.5 in both models), for a
    // viewer at 0, 30, 60 and 80 degrees. Black walls: light is scattered once, so every integrator must agree.
    let qualitative = BsdfDesc::OrenNayar { albedo: Vec3::ONE, sigma: 0.5 };
    let fujii = BsdfDesc::Fujii { albedo: Vec3::ONE, roughness: 0.5 };
    let lambert = BsdfDesc::Lambert { albedo: Vec3::ONE };
    for (what, bsdf, albedos) in [
        ("Lambert", lambert, [1.0; 4]),
        ("qualitative", qualitative, [0.784_482_758_621, 0.824_724_690_960, 0.883_128_419_881, 0.929_444_593_430]),
        ("Fujii", fujii, [0.874_204_808_855, 0.880_987_224_927, 0.924_188_697_546, 0.974_355_540_020]),
    ] {
        for (degrees, albedo) in [0.0_f64, 30.0, 60.0, 80.0].into_iter().zip(albedos) {
            let corner = |x: f64, y: f64| DVec3::new(1e-3 * x, 1e-3 * y, 0.0);
            let patch = ShapeDesc::Quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            let mut desc = room(BsdfDesc::Black, 1.0, Some((patch, bsdf)));
            let (sin, cos) = degrees.to_radians().sin_cos();
            // The patch fills the image; its image is a thousandth of its size.
            desc.camera = camera(0.5 * DVec3::new(sin, 0.0, cos), DVec3::ZERO, 0.01);
            for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
                let job = Job { resolution: [16, 16], samples: 3072, integrator, ..Job::default() };
                check(&format!("{what} at {degrees} degrees, {integrator:?}"), &desc, &job, albedo);
            }
        }
    }
}
