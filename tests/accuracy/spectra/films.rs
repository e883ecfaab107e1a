//! Thin films: what they reflect and transmit, in three channels and in wavelengths.

use super::{build, channels, white};
use crate::common::scenes::{Job, add, box_inside, camera, render_scene, scene};
use crate::record::Case;
use crate::transport::{MESH, ball, glass, pick, plane};
use etendue::desc::{
    BsdfDesc, ConductorDesc, Dispersion, IntegratorDesc, MediumDesc, MicrofacetsDesc, RenderDesc, SceneDesc,
    ThinFilmDesc,
};
use etendue::math::DVec3;
use etendue::spectrum::{Rgb, rec_709};

type Complex = [f64; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn over(a: Complex, [c, d]: Complex) -> Complex {
    let scale = 1.0 / (c * c + d * d);
    times(a, [c * scale, -d * scale])
}

fn root([a, b]: Complex) -> Complex {
    let (length, angle) = (a.hypot(b).sqrt(), 0.5 * b.atan2(a));
    [length * angle.cos(), length * angle.sin()]
}

/// The reflectance of a film by the amplitudes of its faces: with r12 = rho exp(i phi) and delta = 4 pi n d cos(theta) / lambda,
/// (r01^2 + rho^2 + 2 r01 rho cos(phi + delta)) / (1 + r01^2 rho^2 + 2 r01 rho cos(phi + delta)).
///
/// Source: Born and Wolf, *Principles of Optics*, Sec. 14.4.1.
fn reflectance(cos: f64, front: f64, film: ThinFilmDesc, behind: Complex, nanometres: f64) -> f64 {
    let (n, d) = (f64::from(film.ior), f64::from(film.thickness));
    let sin2 = front * front * (1.0 - cos * cos);
    let film_cos = (1.0 - sin2 / (n * n)).sqrt();
    let squared = times(behind, behind);
    let behind_cos = over(root([squared[0] - sin2, squared[1]]), behind);
    let delta = 4.0 * std::f64::consts::PI * n * d * film_cos / nanometres;
    let polarised = |parallel: bool| {
        // The indices times their own cosine, or each times that of the other medium.
        let (a, b) = if parallel { (n * cos, front * film_cos) } else { (front * cos, n * film_cos) };
        let (c, e) = if parallel {
            (behind.map(|part| part * film_cos), behind_cos.map(|part| part * n))
        } else {
            ([n * film_cos, 0.0], times(behind, behind_cos))
        };
        let r01 = (a - b) / (a + b);
        let [re, im] = over([c[0] - e[0], c[1] - e[1]], [c[0] + e[0], c[1] + e[1]]);
        let (rho, phi) = (re.hypot(im), im.atan2(re));
        let both = 2.0 * r01 * rho * (phi + delta).cos();
        (r01 * r01 + rho * rho + both) / (1.0 + r01 * r01 * rho * rho + both)
    };
    0.5 * (polarised(false) + polarised(true))
}

/// Compares a picture in three channels and one in wavelengths with the colour that a share of white light has.
fn compare(case: &mut Case, what: &str, desc: &SceneDesc, integrator: IntegratorDesc, share: impl Fn(f64) -> f64) {
    let scene = build(desc);
    let exact = rec_709(|nanometres| share(nanometres) * white(nanometres)).to_array();
    let most = exact.into_iter().fold(0.0, f64::max);
    for spectral in [false, true] {
        let job = Job { resolution: [16, 16], samples: case.count(256, 4096) as u32, integrator, ..Job::default() };
        let image = render_scene(&scene, RenderDesc { spectral, ..job.desc() }).0;
        for (channel, (mean, error)) in channels(&image).into_iter().enumerate() {
            let of = if spectral { "wavelengths" } else { "colours" };
            let what = format!("{what}, {}, {of}, channel {channel}: difference over the largest", integrator.name());
            // Tables of colours are off by 5e-4 of white at most; four wavelengths vary by their number.
            let off = 1.0 + (mean - exact[channel]) / most;
            case.biased_mean(what, (off, error / most), 1.0, (1.5e-3, pick(case, 1e-2, 2.5e-3)));
        }
    }
}

/// A large sheet of this model and film with its outer side to the camera, or its inner one, seen at an angle; and a lamp that fills
/// what is seen through it, or by reflection in it.
fn sheet(bsdf: BsdfDesc, film: ThinFilmDesc, degrees: f64, outside: bool, behind: bool) -> SceneDesc {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let view = camera(DVec3::new(-sin, 0.0, -cos) * 2.0, DVec3::ZERO, 0.2);
    let normal = if outside { DVec3::NEG_Z } else { DVec3::Z };
    let (at, facing) = if behind { (5.0, DVec3::NEG_Z) } else { (-5.0, DVec3::Z) };
    let surfaces = vec![
        (plane(DVec3::ZERO, normal, 50.0), bsdf, None),
        (plane(DVec3::Z * at, facing, 100.0), BsdfDesc::Black, Some(Rgb::ONE)),
    ];
    let mut desc = scene(view, surfaces);
    desc.materials[0].film = Some(film);
    desc
}

/// Soap, and coats on glass from both sides.
pub fn dielectrics(case: &mut Case) {
    let soap = ThinFilmDesc { thickness: 420.0, ior: 1.33 };
    let through = |cos: f64, front: f64, film: ThinFilmDesc, behind: f64| {
        move |nanometres: f64| 1.0 - reflectance(cos, front, film, [behind, 0.0], nanometres)
    };
    let cos = 50_f64.to_radians().cos();
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted] {
        let desc = sheet(glass(1.0, 1.0), soap, 50.0, true, true);
        compare(case, "through soap", &desc, integrator, through(cos, 1.0, soap, 1.0));
        let desc = sheet(glass(1.0, 1.0), soap, 50.0, false, false);
        compare(case, "by soap", &desc, integrator, |at| reflectance(cos, 1.0, soap, [1.0, 0.0], at));
    }
    // The lamp is on the other side of the glass, where its radiance is that in the medium.
    let coat = ThinFilmDesc { thickness: 180.0, ior: 2.1 };
    let ior = 1.5_f64;
    let desc = sheet(glass(ior as f32, 1.0), coat, 50.0, true, true);
    let pass = through(cos, 1.0, coat, ior);
    compare(case, "into glass", &desc, IntegratorDesc::Path, |at| pass(at) / (ior * ior));
    let cos = 30_f64.to_radians().cos();
    let desc = sheet(glass(ior as f32, 1.0), coat, 30.0, false, true);
    let pass = through(cos, ior, coat, 1.0);
    compare(case, "out of glass", &desc, IntegratorDesc::Path, |at| pass(at) * ior * ior);
    // Glass in water, whose film has water in front of it; light is reflected to and fro between it and the surface of the water.
    let water = 1.33_f32;
    let mut desc = sheet(glass(ior as f32, 1.0), coat, 0.0, true, true);
    add(&mut desc, 2, plane(DVec3::NEG_Z, DVec3::NEG_Z, 50.0), glass(water, 1.0), None);
    for (material, priority) in [(0, 2), (2, 1)] {
        desc.set_medium(material, Some(MediumDesc { absorption: Rgb::ZERO, priority })).expect("a medium");
    }
    let n = f64::from(water);
    let bare = ((n - 1.0) / (n + 1.0)).powi(2);
    compare(case, "in water", &desc, IntegratorDesc::Path, |at| {
        let film = reflectance(1.0, n, coat, [ior, 0.0], at);
        (1.0 - bare) * (1.0 - film) / (1.0 - bare * film) / (ior * ior)
    });
    // In an even light no film is seen, whatever it does with light, by photons too.
    let view = camera(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 25.0);
    let mut desc =
        scene(view, vec![(ball(DVec3::ZERO, 1.0), glass(1.5, 1.0), None), (MESH, BsdfDesc::Black, Some(Rgb::ONE))]);
    desc.meshes.push(box_inside(DVec3::splat(-9.0), DVec3::splat(9.0)).into());
    desc.materials[0].film = Some(coat);
    let furnace = build(&desc);
    for integrator in [IntegratorDesc::Caustic, IntegratorDesc::Sppm] {
        // A pass has its own wavelengths for all pixels: the error falls with the number of passes.
        let job = Job { resolution: [8, 8], samples: case.count(1024, 8192) as u32, integrator, ..Job::default() };
        let image = render_scene(&furnace, RenderDesc { spectral: true, ..job.desc() }).0;
        for (channel, found) in channels(&image).into_iter().enumerate() {
            let what = format!("a ball in a furnace, {}, channel {channel}", integrator.name());
            case.biased_mean(what, found, 1.0, (pick(case, 4e-3, 1e-3), pick(case, 8e-3, 3e-3)));
        }
    }
    // A film on glass that disperses light: each wavelength has its own index on both sides of the sum.
    let dispersion = Dispersion::Abbe(15.0);
    let mut desc = sheet(glass(1.7, 1.0), coat, 30.0, true, false);
    desc.materials[0].dispersion = Some(dispersion);
    let cos = 30_f64.to_radians().cos();
    let scene = build(&desc);
    let index = |at: f64| dispersion.index(f64::from(1.7_f32), at);
    let exact = rec_709(|at| reflectance(cos, 1.0, coat, [index(at), 0.0], at) * white(at)).to_array();
    let most = exact.into_iter().fold(0.0, f64::max);
    let job = Job { resolution: [16, 16], samples: case.count(256, 4096) as u32, ..Job::default() };
    let image = render_scene(&scene, RenderDesc { spectral: true, ..job.desc() }).0;
    for (channel, (mean, error)) in channels(&image).into_iter().enumerate() {
        let off = 1.0 + (mean - exact[channel]) / most;
        let what = format!("by dispersing glass, channel {channel}: difference over the largest");
        case.biased_mean(what, (off, error / most), 1.0, (1e-3, pick(case, 1e-2, 2.5e-3)));
    }
}

/// Oxides on a metal, smooth and nearly so, in an even light.
pub fn metals(case: &mut Case) {
    let (eta, k) = ([2.8_f32, 2.5, 1.9], [3.3_f32, 3.0, 2.7]);
    let channels = [650.0, 550.0, 450.0];
    let metal = |at: f64| {
        let place = |lower: usize, upper: usize, part: [f32; 3]| {
            let share = (at - channels[lower]) / (channels[upper] - channels[lower]);
            f64::from(part[lower]) + share.clamp(0.0, 1.0) * (f64::from(part[upper]) - f64::from(part[lower]))
        };
        let (lower, upper) = if at < 550.0 { (2, 1) } else { (1, 0) };
        [place(lower, upper, eta), place(lower, upper, k)]
    };
    let conductor = ConductorDesc::Index { eta: Rgb::from_array(eta), k: Rgb::from_array(k) };
    for (what, roughness, film) in [
        ("smooth, 45 nm", 0.0, ThinFilmDesc { thickness: 45.0, ior: 2.4 }),
        ("smooth, 300 nm", 0.0, ThinFilmDesc { thickness: 300.0, ior: 1.6 }),
        ("rough, 45 nm", 0.1, ThinFilmDesc { thickness: 45.0, ior: 2.4 }),
    ] {
        // Facets this narrow reflect what a smooth surface does to second order in their width of 0.01.
        let microfacets = MicrofacetsDesc { roughness, multiple_scattering: false, ..MicrofacetsDesc::default() };
        for degrees in [10.0_f64, 55.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let view = camera(DVec3::new(-sin, 0.0, -cos) * 2.0, DVec3::ZERO, 0.2);
            let bsdf = BsdfDesc::Conductor { conductor, microfacets };
            let surfaces =
                vec![(plane(DVec3::ZERO, DVec3::NEG_Z, 50.0), bsdf, None), (MESH, BsdfDesc::Black, Some(Rgb::ONE))];
            let mut desc = scene(view, surfaces);
            desc.meshes.push(box_inside(DVec3::splat(-90.0), DVec3::splat(90.0)).into());
            desc.materials[0].film = Some(film);
            let what = format!("{what}, {degrees}°");
            compare(case, &what, &desc, IntegratorDesc::Path, |at| reflectance(cos, 1.0, film, metal(at), at));
        }
    }
}
