//! The error that progressive photon mapping estimates of itself: noise and bias, against the truth.

#[path = "common/mod.rs"]
mod common;

use std::ops::ControlFlow;
use std::time::Duration;

use common::stops::run_with_stops;
use etendue::desc::{IntegratorDesc, PhotonDesc, RenderDesc};
use etendue::film::{Image, LayerKind};
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;

const SIZE: u32 = 24;

fn render(scene: &Scene, desc: RenderDesc) -> (Render, Option<f64>) {
    let mut render = Render::new(scene, RenderSettings { desc, ..RenderSettings::default() }).unwrap();
    let summary = render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    (render, summary.rel_mse.map(|error| error.value.sqrt()))
}

fn settings(integrator: IntegratorDesc, samples: u32, seed: u64) -> RenderDesc {
    // Wide, so that the bias counts; the noise is large besides.
    let photons = PhotonDesc {
        radius: Some(0.35),
        caustic_radius: Some(0.08),
        count: Some(1 << 13),
        caustic_count: Some(1 << 13),
        ..PhotonDesc::default()
    };
    RenderDesc { resolution: [SIZE; 2], samples, integrator, seed, photons, ..RenderDesc::default() }
}

/// Root of the mean squared error relative to a reference, as `Film::rel_mse` means it.
fn true_error(image: &Image, reference: &Image) -> f64 {
    let values = reference.rgb.len() as f64;
    let mean = reference.rgb.iter().map(|v| f64::from(*v)).sum::<f64>() / values;
    let sum: f64 = image
        .rgb
        .iter()
        .zip(&reference.rgb)
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2) / (f64::from(*b).powi(2) + 1e-2 * mean * mean))
        .sum();
    (sum / values).sqrt()
}

#[test]
fn estimated_errors_cover_the_true_ones() {
    let desc = etendue::desc::load("scenes/caustic-room.json".as_ref(), None).unwrap();
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    // Narrow radii and many passes: its bias and noise are small against those that are judged.
    let reference = {
        let photons = PhotonDesc { radius: Some(0.08), caustic_radius: Some(0.02), ..PhotonDesc::default() };
        let desc = RenderDesc { photons, ..settings(IntegratorDesc::Sppm, 128, 99) };
        render(&scene, desc).0.image()
    };
    for integrator in [IntegratorDesc::Ppm, IntegratorDesc::Sppm] {
        let (mut covered, mut tried) = (0, 0);
        let mut ratios = Vec::new();
        for seed in 0..3 {
            let (render, estimated) = render(&scene, settings(integrator, 64, seed));
            let image = render.image();
            ratios.push(estimated.unwrap() / true_error(&image, &reference));
            let film = render.film();
            let layer = |kind: LayerKind| {
                let mut values = vec![0.0; image.rgb.len()];
                film.layer_into(kind, &mut values).unwrap();
                values
            };
            let (standard_error, bias) = (layer(LayerKind::StandardError), layer(LayerKind::Bias));
            for (((value, truth), error), bias) in image.rgb.iter().zip(&reference.rgb).zip(&standard_error).zip(&bias)
            {
                tried += 1;
                // Eight replicates: Student's t for 7 degrees of freedom leaves out 10 % beyond 1.895.
                covered += u32::from((value - bias - truth).abs() <= 1.895 * error + 1e-3 * truth);
            }
        }
        let share = f64::from(covered) / f64::from(tried);
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        println!("{integrator:?}: 90 % intervals cover {share:.3}; estimated over true error {mean:.3}");
        assert!((0.80..=0.98).contains(&share), "{integrator:?}: {share}");
        assert!((0.75..=1.3).contains(&mean), "{integrator:?}: {ratios:?}");
    }
}

#[test]
fn auto_looks_for_lamps_that_paths_do_not_find() {
    use etendue::desc::{BsdfDesc, ShapeDesc};
    use etendue::integrator::photon::choose;
    use etendue::math::DVec3;

    let chosen = |name: &str| {
        let desc = etendue::desc::load(format!("scenes/{name}.json").as_ref(), None).unwrap();
        choose(&Scene::build(&desc, &BuildOptions::default()).unwrap())
    };
    for (name, expected) in [
        ("room", IntegratorDesc::Path),
        ("cornell", IntegratorDesc::Path),
        ("caustic-room", IntegratorDesc::Sppm),
        ("caustic-mirror", IntegratorDesc::Sppm),
        ("caustic-glass", IntegratorDesc::Sppm),
    ] {
        let choice = chosen(name);
        assert_eq!(choice.integrator, expected, "{name}: {}", choice.why);
    }
    // A tiny lamp in a bulb of glass: the way to what it lights counts, not that to the glass. A large dim panel beside it makes
    // it no easier to find.
    let grey = BsdfDesc::Lambert { albedo: Rgb::splat(0.5) };
    let glass = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let at = DVec3::new(0.0, 0.5, 0.0);
    let ball = |radius: f64| ShapeDesc::sphere(at, radius).unwrap();
    let room = |radius: f64| ShapeDesc::sphere(DVec3::ZERO, radius).unwrap();
    let mut scene = etendue::desc::SceneDesc::default();
    for ((shape, local), bsdf, emission) in
        [(ball(0.01), BsdfDesc::Black, 1e4), (ball(0.05), glass, 0.0), (room(2.0), grey, 0.0)]
    {
        let material = scene.add_material(&format!("m{}", scene.materials.len()), bsdf, None).unwrap();
        let emission = (emission > 0.0).then(|| Rgb::splat(emission));
        let look = etendue::desc::SurfaceLook { material: Some(material), emission, ..Default::default() };
        scene.add_surface(shape, local, look).unwrap();
    }
    let bulb = choose(&Scene::build(&scene, &BuildOptions::default()).unwrap());
    assert_eq!(bulb.integrator, IntegratorDesc::Sppm, "{}", bulb.why);
}

/// What is glass or a mirror beside something diffuse makes caustics as well: in a closed room with a small lamp, photons are
/// chosen for it as for glass alone, and the irradiance cache shows its caustics by a map.
#[test]
fn auto_sees_caustics_of_what_is_also_diffuse() {
    use etendue::desc::{BsdfDesc, CacheDesc, MicrofacetsDesc, PrincipledDesc, SceneDesc, ShapeDesc, SurfaceLook};
    use etendue::integrator::photon::choose;
    use etendue::math::DVec3;

    let albedo = Rgb::splat(0.5);
    let smooth = MicrofacetsDesc { roughness: 0.0, ..MicrofacetsDesc::default() };
    let glass = |transmission_weight, thin_walled| {
        let specular_roughness = 0.0;
        let desc = PrincipledDesc { transmission_weight, thin_walled, specular_roughness, ..PrincipledDesc::default() };
        BsdfDesc::Principled(desc)
    };
    let plastic = || BsdfDesc::CoatedDiffuse { albedo, ior: 1.5, exterior_ior: 1.0, microfacets: smooth };
    let grey = || BsdfDesc::Lambert { albedo };
    let mix = |weight| BsdfDesc::Mix { materials: [0, 1], weight };
    let dielectric = BsdfDesc::Dielectric { ior: 1.5, exterior_ior: 1.0 };
    let room = |ball: BsdfDesc, walls: BsdfDesc, lamp: f64| {
        let mut scene = SceneDesc::default();
        let mut add = |name, bsdf| scene.add_material(name, bsdf, None).unwrap();
        // The mix is of the first two.
        add("glass", dielectric);
        add("plastic", plastic());
        let [mixed, walls, black] =
            [("ball", ball), ("walls", walls), ("lamp", BsdfDesc::Black)].map(|(name, it)| add(name, it));
        let ball = |x: f64, radius: f64| ShapeDesc::sphere(DVec3::new(x, 0.0, 0.0), radius).unwrap();
        for ((shape, local), material, emission) in [
            (ball(0.0, 2.0), walls, None),
            (ball(-0.5, 0.3), mixed, None),
            (ball(0.9, lamp), black, Some(Rgb::splat(1.0 / (lamp * lamp) as f32))),
        ] {
            let look = SurfaceLook { material: Some(material), emission, ..SurfaceLook::default() };
            scene.add_surface(shape, local, look).unwrap();
        }
        Scene::build(&scene, &BuildOptions::default()).unwrap()
    };
    for (name, ball, walls, lamp, expected) in [
        ("glass", glass(1.0, false), grey(), 0.01, IntegratorDesc::Sppm),
        ("almost glass", glass(0.99, false), grey(), 0.01, IntegratorDesc::Sppm),
        ("half glass", glass(0.5, false), grey(), 0.01, IntegratorDesc::Sppm),
        ("almost a sheet of glass", glass(0.99, true), grey(), 0.01, IntegratorDesc::Sppm),
        ("plastic", plastic(), grey(), 0.01, IntegratorDesc::Sppm),
        ("glass and plastic", mix(0.5), grey(), 0.01, IntegratorDesc::Sppm),
        ("almost glass, plastic walls", glass(0.99, false), plastic(), 0.01, IntegratorDesc::Sppm),
        ("almost glass, large lamp", glass(0.99, false), grey(), 0.5, IntegratorDesc::Path),
    ] {
        let scene = room(ball, walls, lamp);
        let choice = choose(&scene);
        println!("{name}: {:?}: {}", choice.integrator, choice.why);
        assert_eq!(choice.integrator, expected, "{name}: {}", choice.why);
        assert!(!choice.why.contains("none of"), "{name}: {}", choice.why);
        if !name.starts_with("almost glass") {
            continue;
        }
        let desc = RenderDesc {
            resolution: [4; 2],
            samples: 1,
            integrator: IntegratorDesc::IrradianceCache,
            // The map is asked for, and no picture.
            cache: CacheDesc { rays: 16, ..CacheDesc::default() },
            ..RenderDesc::default()
        };
        let mut render = Render::new(&scene, RenderSettings { desc, ..RenderSettings::default() }).unwrap();
        let notes = render.run(&mut |_| ControlFlow::Continue(())).unwrap().notes;
        let has_map = notes.iter().any(|note| note.contains("caustic photon map"));
        assert_eq!(has_map, expected == IntegratorDesc::Sppm, "{name}: {notes:?}");
    }
}

/// Threads, passes and stops in the middle of them change nothing.
#[test]
fn a_render_in_many_goes_is_the_same() {
    let desc = etendue::desc::load("scenes/caustic-room.json".as_ref(), None).unwrap();
    let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
    for integrator in [IntegratorDesc::Sppm, IntegratorDesc::Caustic, IntegratorDesc::IrradianceCache] {
        let desc = RenderDesc { resolution: [48; 2], ..settings(integrator, 12, 5) };
        let whole = render(&scene, desc.clone()).0.image();
        let settings = RenderSettings { desc, threads: 3, ..RenderSettings::default() };
        let mut parts = Render::new(&scene, settings).unwrap();
        let (stops, _) = run_with_stops(&mut parts, Duration::from_millis(5));
        assert!(stops > 0, "{integrator:?} was over before it could be stopped");
        let image = parts.image();
        assert_eq!(image.rgb, whole.rgb, "{integrator:?} after {stops} stops");
        let bias =
            |image: &Image| image.layers.iter().find(|layer| layer.name == "bias").map(|layer| layer.data.clone());
        assert_eq!(bias(&image), bias(&whole), "{integrator:?} after {stops} stops");
    }
}
