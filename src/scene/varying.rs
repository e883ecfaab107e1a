//! Tests of materials that vary over their surfaces. No scene description has one yet, apart from a constant opacity; the tests
//! replace materials of scenes that were built.

use std::ops::ControlFlow;
use std::sync::Arc;

use serde_json::json;

use super::{BuildOptions, Scene, SurfaceDetail, VaryingMaterial};
use crate::ErrorKind;
use crate::bsdf::{Bsdf, Lambert};
use crate::camera::Camera;
use crate::desc::{self, FilterDesc, IntegratorDesc, RenderDesc};
use crate::emitter::{Emitter, EmitterSet, EnvironmentEmitter, InfiniteBall};
use crate::integrator::{Integrator, Path, SceneTracer};
use crate::math::{DVec3, Ray, Vec3};
use crate::render::{Render, RenderSettings};
use crate::sampling::{Rng, Sampler as _, SobolSampler};
use crate::spectrum::Rgb;

/// A diffuse material whose albedo is that of the texture coordinates: u in red, v in green.
#[derive(Debug)]
struct Gradient;

impl VaryingMaterial for Gradient {
    fn bsdf(&self, at: &SurfaceDetail) -> Bsdf {
        Bsdf::Lambert(Lambert::new(Rgb::new(at.uv[0], at.uv[1], 0.5)))
    }

    fn mean(&self) -> Bsdf {
        Bsdf::Lambert(Lambert::new(Rgb::splat(0.5)))
    }
}

/// A black sheet of this opacity where the second texture coordinate is below 1/2, and of this one elsewhere.
#[derive(Debug)]
struct Veil([f32; 2]);

impl VaryingMaterial for Veil {
    fn bsdf(&self, _: &SurfaceDetail) -> Bsdf {
        self.mean()
    }

    fn mean(&self) -> Bsdf {
        Bsdf::new(&desc::BsdfDesc::Black)
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn opacity(&self, at: &SurfaceDetail) -> f32 {
        self.0[usize::from(at.uv[1] >= 0.5)]
    }
}

/// A material whose albedo is the footprint's diameter.
#[derive(Debug)]
struct Width;

impl VaryingMaterial for Width {
    fn bsdf(&self, at: &SurfaceDetail) -> Bsdf {
        Bsdf::Lambert(Lambert::new(Rgb::splat(at.footprint.min(1.0))))
    }

    fn mean(&self) -> Bsdf {
        Bsdf::Lambert(Lambert::new(Rgb::splat(0.5)))
    }

    fn asks_footprint(&self) -> bool {
        true
    }
}

const QUAD: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

fn quad(material: &str, corners: [[f64; 3]; 4]) -> serde_json::Value {
    let [a, b, c, d] = corners;
    json!({"geometry": "quad", "material": material, "vertex-1": a, "vertex-2": b, "vertex-3": c, "vertex-4": d})
}

fn behind(z: f64) -> [[f64; 3]; 4] {
    QUAD.map(|[x, y, _]| [x, y, z])
}

/// A scene of material 0 ("varied"), 1 ("white") and 2 ("mirror"), seen from z = 4, in an environment of radiance 1.
fn build(surfaces: serde_json::Value, options: &BuildOptions) -> Scene {
    let scene = json!({
        "etendue": 1,
        "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 30},
        "materials": [
            {"name": "varied", "type": "diffuse", "color": [0.5, 0.5, 0.5]},
            {"name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8]},
            {"name": "mirror", "type": "reflective", "color": [1, 1, 1]},
        ],
        "surfaces": surfaces,
    });
    let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
    let mut scene = Scene::build(&desc, options).unwrap();
    let environment = EnvironmentEmitter::new(Rgb::ONE, InfiniteBall::new(scene.to_scene(DVec3::ZERO), 10.0));
    scene.set_emitters(EmitterSet::new(vec![Emitter::Environment(environment)]));
    scene
}

fn with(mut scene: Scene, varying: impl VaryingMaterial + 'static) -> Scene {
    scene.set_varying(0, Arc::new(varying));
    scene
}

/// The pixels of a square render, in row order.
fn render(scene: &Scene, integrator: IntegratorDesc, side: u32, samples: u32) -> Vec<[f32; 3]> {
    let desc =
        RenderDesc { resolution: [side; 2], samples, integrator, filter: FilterDesc::Box, ..RenderDesc::default() };
    let mut render = Render::new(scene, RenderSettings { desc, threads: 1, ..Default::default() }).unwrap();
    render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    render.image().rgb.chunks(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect()
}

/// On triangles, texture coordinates are linear and their derivatives are the tangents, wherever the triangle came from.
#[test]
fn tangents_are_derivatives_of_positions_by_texture_coordinates() {
    let n = 20_u32;
    let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..n * n {
        let (x, y) = (f64::from(i % n) / 10.0 - 1.0, f64::from(i / n) / 10.0 - 1.0);
        positions.push([x, y, 0.2 * (3.0 * x).sin() * y]);
        uvs.push([0.3 * x + 0.7 * y * y, 1.5 - 0.4 * y + 0.2 * x * y]);
        if i % n + 1 < n && i / n + 1 < n {
            triangles.extend([[i, i + 1, i + n + 1], [i, i + n + 1, i + n]]);
        }
    }
    let mesh = json!({"geometry": "mesh", "material": "white", "positions": positions, "triangles": triangles});
    let mut with_uvs = mesh.clone();
    with_uvs["uvs"] = json!(uvs);
    let mut turned = with_uvs.clone();
    turned["transform"] = json!([{"scale": [-1.3, 0.8, 1.1]}, {"rotate": [30, 40, 10]}]);
    let triangle = json!({"geometry": "triangle", "material": "white",
        "vertex-1": [-1, -1, 0.1], "vertex-2": [1, -1, 0], "vertex-3": [0.5, 1, -0.3]});
    let skew = quad("white", [[-1.0, -1.0, 0.0], [1.0, -0.8, 0.0], [0.9, 1.0, 0.0], [-0.7, 0.8, 0.0]]);
    for surface in [mesh, with_uvs, turned, triangle, skew] {
        for dynamic in [false, true] {
            let scene = build(json!([surface]), &BuildOptions { dynamic, ..BuildOptions::default() });
            let mut rng = Rng::new(3, 3);
            let centre = scene.to_scene(DVec3::ZERO);
            let mut last = None;
            let mut compared = 0;
            for _ in 0..4000 {
                let target = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 0.0) * 1.6;
                let ray = Ray::new(centre + target + Vec3::Z * 3.0, -Vec3::Z);
                let Some(hit) = scene.intersect(&ray) else { continue };
                let at = scene.interaction(&ray, &hit);
                let detail = scene.detail(&hit, &at);
                assert_eq!(detail.uv, scene.describe_hit(&ray, &hit).uv);
                for tangent in [detail.dpdu, detail.dpdv] {
                    assert!(tangent.dot(at.ng).abs() < 1e-5 * tangent.length(), "{detail:?}");
                }
                let place = (hit.geometry, hit.primitive);
                if let Some((other, p, uv)) = last
                    && other == place
                {
                    let [u, v]: [f32; 2] = uv;
                    let linear = detail.dpdu * (detail.uv[0] - u) + detail.dpdv * (detail.uv[1] - v);
                    let moved: Vec3 = at.point.p - p;
                    assert!((moved - linear).length() < 1e-4, "{moved}, {linear}");
                    compared += 1;
                }
                last = Some((place, at.point.p, detail.uv));
            }
            assert!(compared >= 2, "{compared}");
        }
    }
}

/// In a uniform environment, a convex diffuse body shows its albedo, here that of the place.
#[test]
fn a_material_is_asked_where_a_ray_meets_it() {
    let scene = with(build(json!([quad("varied", QUAD)]), &BuildOptions::default()), Gradient);
    let camera = Camera::new(scene.camera(), [8; 2], scene.centre()).unwrap();
    for integrator in [
        IntegratorDesc::Path,
        IntegratorDesc::Whitted,
        IntegratorDesc::Direct,
        IntegratorDesc::Caustic,
        IntegratorDesc::Sppm,
    ] {
        let image = render(&scene, integrator, 8, 64);
        let mut compared = 0;
        for (i, seen) in image.iter().enumerate() {
            let ray = camera.ray((i % 8) as f32 + 0.5, (i / 8) as f32 + 0.5);
            let Some(hit) = scene.intersect(&ray) else { continue };
            let [u, v] = scene.detail(&hit, &scene.interaction(&ray, &hit)).uv;
            // Pixels at the edge see past it.
            if !(0.15..0.85).contains(&u) || !(0.15..0.85).contains(&v) {
                continue;
            }
            compared += 1;
            for (seen, exact) in seen.iter().zip([u, v, 0.5]) {
                // Samples are spread over a pixel, a quarter of the quad wide at most; their mean is the middle's.
                assert!((seen - exact).abs() < 0.02, "{integrator:?}, ({u}, {v}): {seen}, not {exact}");
            }
        }
        assert!(compared >= 20, "{integrator:?}: {compared} pixels");
    }
}

/// Rays pass a sheet of opacity a with probability 1 - a, each sheet by itself; holes are holes.
#[test]
fn opacity_is_the_probability_of_meeting_a_surface() {
    const SAMPLES: u32 = 1 << 15;
    let sheets =
        |count: i32| json!((0..count).map(|i| quad("varied", behind(-0.01 * f64::from(i)))).collect::<Vec<_>>());
    for count in [1, 3] {
        let scene = with(build(sheets(count), &BuildOptions::default()), Veil([0.3, 0.0]));
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct] {
            let image = render(&scene, integrator, 4, SAMPLES);
            // The upper rows see holes, the lower ones the sheets; the outer pixels see past them.
            for (row, exact) in [(1, 1.0), (2, 0.7_f64.powi(count))] {
                for column in [1, 2] {
                    let [seen, ..] = image[4 * row + column].map(f64::from);
                    let error = (exact * (1.0 - exact) / f64::from(SAMPLES)).sqrt();
                    assert!((seen - exact).abs() <= 4.0 * error + 1e-6, "{integrator:?}, {count}: {seen}, not {exact}");
                }
            }
        }
    }
    // A ball is passed through its front and its back.
    let ball = json!([{"geometry": "sphere", "material": "varied", "origin": [0, 0, 0], "radius": 1.0}]);
    for listed_shapes in [None, Some(0)] {
        let scene = build(ball.clone(), &BuildOptions { listed_shapes, ..BuildOptions::default() });
        let [seen, ..] = render(&with(scene, Veil([0.4, 0.4])), IntegratorDesc::Path, 4, SAMPLES)[5].map(f64::from);
        let error = (0.36 * 0.64 / f64::from(SAMPLES)).sqrt();
        assert!((seen - 0.36).abs() <= 4.0 * error, "{listed_shapes:?}: {seen}, not 0.36");
    }
}

/// A white floor below a sheet of opacity 1/4.
pub(crate) fn veiled_floor() -> Scene {
    let veil = quad("varied", behind(-0.5).map(|[x, y, z]| [50.0 * x, 50.0 * y, z]));
    with(build(json!([quad("white", behind(-1.0)), veil]), &BuildOptions::default()), Veil([0.25, 0.25]))
}

/// A sheet whose albedo is the diameter of the cone of the ray that meets it, before a white floor.
pub(crate) fn footprints() -> Scene {
    with(build(json!([quad("white", behind(-1.0)), quad("varied", QUAD)]), &BuildOptions::default()), Width)
}

/// Samples that share a camera ray decide anew whether they meet a veil.
#[test]
fn samples_of_one_ray_see_a_veil_with_its_opacity() {
    let scene = with(build(json!([quad("varied", QUAD)]), &BuildOptions::default()), Veil([0.4, 0.4]));
    let sampler = crate::desc::SamplerDesc::Grid;
    let (mut sum, seeds) = (0.0, 2000);
    for seed in 0..seeds {
        let desc = RenderDesc { resolution: [1; 2], samples: 1, seed, sampler, ..RenderDesc::default() };
        let mut render = Render::new(&scene, RenderSettings { desc, threads: 1, ..Default::default() }).unwrap();
        render.run(&mut |_| ControlFlow::Continue(())).unwrap();
        sum += f64::from(render.image().rgb[0]) / seeds as f64;
    }
    let error = (0.6 * 0.4 / seeds as f64).sqrt();
    assert!((sum - 0.6).abs() < 4.0 * error, "{sum}, not 0.6");
}

/// Shadow rays meet a sheet with its opacity too.
#[test]
fn shadows_of_sheets_have_their_opacity() {
    let floor = quad("white", behind(-1.0));
    let open = build(json!([floor]), &BuildOptions::default());
    let veiled = veiled_floor();
    // The floor is seen from below the veil, so only its light passes the veil.
    let mean = |scene: &Scene| {
        let (mut sampler, mut tracer) = (SobolSampler::new(4, u32::MAX), SceneTracer::new(scene));
        let path = Path::new(None, 1);
        let (mut sum, count) = (0.0, 1 << 15);
        for sample in 0..count {
            sampler.start(sample % 256, sample / 256);
            let [x, y] = sampler.pixel_2d();
            let from = scene.to_scene(DVec3::new(f64::from(x) - 0.5, f64::from(y) - 0.5, -0.6));
            let ray = Ray::new(from, -Vec3::Z);
            let radiance = path.radiance(scene, ray, &mut sampler, &mut tracer, &mut |_| {});
            sum += f64::from(radiance.g());
        }
        sum / f64::from(count)
    };
    let (free, through) = (mean(&open), mean(&veiled));
    assert!((free - 0.8).abs() < 0.004, "{free}");
    assert!((through / free - 0.75).abs() < 0.01, "{through} of {free}");
}

/// Cones grow with distance, along mirrors too.
#[test]
fn footprints_are_what_pixels_see() {
    let scene = with(build(json!([quad("varied", QUAD)]), &BuildOptions::default()), Width);
    assert!(
        scene.asks_footprints() && !build(json!([quad("varied", QUAD)]), &BuildOptions::default()).asks_footprints()
    );
    let pixel = |side: u32| 2.0 * 15.0_f64.to_radians().tan() / f64::from(side);
    let check = |scene: &Scene, distance: f64, at: usize| {
        let [seen, ..] = render(scene, IntegratorDesc::Path, 9, 256)[at].map(f64::from);
        let exact = pixel(9) * distance;
        assert!((seen / exact - 1.0).abs() < 0.02, "{seen}, not {exact}");
    };
    check(&scene, 4.0, 40);
    // By a mirror at z = 0, the camera at z = 4 sees the sheet at z = 6 behind itself, 10 away.
    let sheet = behind(6.0).map(|[x, y, z]| [40.0 * x, 40.0 * y, z]);
    let mirrored = with(build(json!([quad("mirror", QUAD), quad("varied", sheet)]), &BuildOptions::default()), Width);
    check(&mirrored, 10.0, 40);
}

#[test]
fn what_stores_light_on_surfaces_refuses_those_that_are_not_opaque() {
    let mut scene = with(
        build(json!([quad("varied", QUAD), quad("white", behind(-1.0))]), &BuildOptions::default()),
        Veil([0.5, 0.5]),
    );
    scene.set_emitters(EmitterSet::new(Vec::new()));
    for integrator in IntegratorDesc::ALL {
        let desc = RenderDesc { resolution: [4, 4], samples: 1, integrator, ..RenderDesc::default() };
        let made = Render::new(&scene, RenderSettings { desc, threads: 1, ..Default::default() });
        let free = [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Direct, IntegratorDesc::Auto];
        assert_eq!(made.is_ok(), free.contains(&integrator), "{integrator:?}");
        if let Err(error) = made {
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            assert!(error.to_string().contains("not opaque"), "{error}");
        }
    }
}
