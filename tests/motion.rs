//! Scenes in which something moves: what is refused and warned of, what integrators take them, and the same bits whoever does
//! the work. What pictures of them show is in `accuracy/motion`.

mod common;

use std::ops::ControlFlow;
use std::path::Path;

use etendue::ErrorKind;
use etendue::desc::{self, IntegratorDesc, RenderDesc, SceneDesc, ShutterDesc};
use etendue::math::{DVec3, Ray};
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use serde_json::{Value, json};

fn parse(camera: Value, surfaces: Value) -> SceneDesc {
    let scene = json!({
        "etendue": 1, "camera": camera,
        "lights": [{"type": "point", "origin": [0, 3, 3], "color": [9, 9, 9]}],
        "textures": [{"name": "squares", "type": "checker", "scale": [3, 2]}],
        "materials": [
            {"name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8]},
            {"name": "squares", "type": "diffuse", "color": [1, 1, 1], "textures": {"color": "squares"}},
            {"name": "lamp", "type": "diffuse", "color": [1, 1, 1], "emission": [1, 1, 1], "textures": {"emission": "squares"}},
        ],
        "surfaces": surfaces,
    });
    desc::parse(&scene.to_string(), Path::new(""), None).unwrap()
}

fn build(desc: &SceneDesc) -> etendue::Result<Scene> {
    Scene::build(desc, &BuildOptions::default())
}

fn bits(scene: &Scene, threads: usize, stops: usize) -> Vec<u32> {
    let desc = RenderDesc { resolution: [40, 24], samples: 8, ..RenderDesc::default() };
    let settings = RenderSettings { desc, threads, auxiliary: true, ..RenderSettings::default() };
    let mut render = Render::new(scene, settings).unwrap();
    for _ in 0..stops {
        render.run(&mut |_| ControlFlow::Break(())).unwrap();
    }
    render.run(&mut |_| ControlFlow::Continue(())).unwrap();
    let image = render.image();
    let layers = image.layers.iter().flat_map(|layer| &layer.data);
    image.rgb.iter().chain(layers).map(|value| value.to_bits()).collect()
}

#[test]
fn the_same_bits_come_from_any_number_of_threads() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/motion-blur.json");
    let desc = desc::load(&path, None).unwrap();
    let scene = build(&desc).unwrap();
    assert!(scene.has_motion() && !scene.has_moving_camera());
    let one = bits(&scene, 1, 0);
    assert!(one == bits(&scene, 2, 0) && one == bits(&scene, 3, 2));
    // Packets and single rays meet the same: with an instance in the scene, rays are traced one by one.
    let mut moving_camera = desc;
    let motion = moving_camera.motion.surfaces[&2].clone();
    let keys = motion.keys.iter().map(|key| desc::MotionKey { place: desc::KeyPlace::REST, ..*key }).collect();
    moving_camera.set_camera_motion(Some(desc::MotionDesc { keys })).unwrap();
    let still_camera = build(&moving_camera).unwrap();
    assert!(!still_camera.has_moving_camera(), "keys that are all the same are rest");
    assert!(one == bits(&still_camera, 2, 0));
}

#[test]
fn what_cannot_be_shown_is_refused_or_warned_of() {
    let camera = || json!({"origin": [0, 0, 5], "shutter": {"open": 0, "close": 1}});
    let turning = |degrees: f64, count: u32| {
        let key = |i: u32| json!({"time": f64::from(i) / f64::from(count), "rotate": [0, 0, degrees * f64::from(i)]});
        (0..=count).map(key).collect::<Value>()
    };
    let quad = |material: &str, motion: Value| {
        json!([{"geometry": "quad", "material": material, "motion": motion, "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0],
            "vertex-3": [1, 1, 0], "vertex-4": [0, 1, 0]}])
    };
    // Three turns are a little too much for 128 straight pieces, and a hundred cannot be shown at all.
    let scene = build(&parse(camera(), quad("white", turning(120.0, 9)))).unwrap();
    assert!(
        scene.warnings().iter().any(|it| it.contains("off by more than a thousandth") && it.contains("surfaces[0]")),
        "{:?}",
        scene.warnings()
    );
    assert!(build(&parse(camera(), quad("white", turning(120.0, 2)))).unwrap().warnings().is_empty());
    let error = build(&parse(camera(), quad("white", turning(170.0, 300)))).unwrap_err();
    assert_eq!((error.kind(), &*error.location().json_path), (ErrorKind::Unsupported, "surfaces[0].motion"), "{error}");
    assert!(error.to_string().contains("129 moments are too few"), "{error}");

    // Lamps whose light a texture varies: squares, spheres and meshes.
    let mesh = json!([{"geometry": "mesh", "material": "lamp", "motion": turning(10.0, 1), "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        "triangles": [[0, 1, 2]], "uvs": [[0, 0], [1, 0], [0, 1]]}]);
    let sphere = json!([{"geometry": "sphere", "material": "lamp", "motion": turning(10.0, 1), "origin": [0, 0, 0], "radius": 1}]);
    for surfaces in [quad("lamp", turning(10.0, 1)), mesh, sphere] {
        let error = build(&parse(camera(), surfaces.clone())).unwrap_err();
        assert_eq!(
            (error.kind(), &*error.location().json_path),
            (ErrorKind::Unsupported, "surfaces[0].motion"),
            "{error}"
        );
        // At one moment they are lamps like any other.
        let mut still = parse(camera(), surfaces);
        still.set_shutter(ShutterDesc::at(0.5)).unwrap();
        assert!(!build(&still).unwrap().has_motion());
    }
    // A ball that emits stays round.
    let flat = json!([{"geometry": "sphere", "material": "white", "emission": [1, 1, 1], "origin": [0, 0, 0], "radius": 1,
        "motion": [{"time": 0}, {"time": 1, "scale": [1, 2, 1]}]}]);
    let error = build(&parse(camera(), flat)).unwrap_err();
    assert_eq!(&*error.location().json_path, "surfaces[0].emission", "{error}");
    // A number of a surface that is not there.
    let mut made = parse(camera(), quad("white", turning(10.0, 1)));
    let motion = made.motion.surfaces[&0].clone();
    made.motion.surfaces.insert(7, motion);
    assert!(build(&made).unwrap_err().to_string().contains("there is no surface 7"));
}

#[test]
fn integrators_that_prepare_anything_once_refuse_what_moves_by_name() {
    let camera = |motion: Value| json!({"origin": [0, 0, 5], "shutter": {"open": 0, "close": 1}, "motion": motion});
    let ball = |motion: Value| json!([{"geometry": "sphere", "material": "white", "origin": [0, 0, 0], "radius": 1, "motion": motion}]);
    let way = || json!([{"time": 0}, {"time": 1, "translate": [0.5, 0, 0]}]);
    let rest = || json!([{"time": 0}]);
    let started = |desc: &SceneDesc, integrator: IntegratorDesc| {
        let scene = build(desc).unwrap();
        let desc = RenderDesc { resolution: [4, 4], samples: 1, integrator, ..RenderDesc::default() };
        Render::new(&scene, RenderSettings { desc, threads: 1, ..Default::default() }).map(|_| ())
    };
    let refuses = [
        IntegratorDesc::Radiosity,
        IntegratorDesc::Photon,
        IntegratorDesc::PhotonDirect,
        IntegratorDesc::IrradianceCache,
    ];
    let mut lamp = parse(camera(rest()), ball(rest()));
    let motion = parse(camera(rest()), ball(way())).motion.surfaces[&0].clone();
    lamp.set_light_motion(0, Some(motion.as_ref().clone())).unwrap();
    for (what, desc, is_camera) in [
        ("surface", parse(camera(rest()), ball(way())), false),
        ("camera", parse(camera(way()), ball(rest())), true),
        ("lamp", lamp, false),
    ] {
        for integrator in IntegratorDesc::ALL {
            let made = started(&desc, integrator);
            let expected = is_camera || !refuses.contains(&integrator);
            assert_eq!(made.is_ok(), expected, "{what}, {}", integrator.name());
            if let Err(error) = made {
                assert_eq!(error.kind(), ErrorKind::Unsupported);
                assert!(error.to_string().contains(&format!("{} shows no motion", integrator.name())), "{error}");
            }
            let mut still = desc.clone();
            still.set_shutter(ShutterDesc::at(0.25)).unwrap();
            assert!(started(&still, integrator).is_ok(), "{what}, {}", integrator.name());
        }
        // A caustic map that is made once.
        let scene = build(&desc).unwrap();
        let mut once = RenderDesc { resolution: [4, 4], integrator: IntegratorDesc::Caustic, ..RenderDesc::default() };
        once.photons.progressive = false;
        let made = Render::new(&scene, RenderSettings { desc: once, threads: 1, ..Default::default() });
        assert_eq!(made.is_ok(), is_camera, "{what}");
        if let Err(error) = made {
            let message = "caustic with maps that are made once shows no motion";
            assert!(error.kind() == ErrorKind::Unsupported && error.to_string().contains(message), "{error}");
        }
    }
}

#[test]
fn textures_go_along_with_what_turns() {
    let camera = json!({"origin": [0, 0, 5], "shutter": {"open": 0, "close": 1}});
    for surface in [
        json!({"geometry": "sphere", "origin": [0.1, 0, 0], "radius": 1}),
        json!({"geometry": "cylinder", "base": [0, -1, 0], "axis": [0, 1, 0], "radius": 0.7, "height": 2}),
        json!({"geometry": "disk", "origin": [0, 0, 0], "normal": [0, 0, 1], "radius": 1}),
        json!({"geometry": "quad", "vertex-1": [-1, -1, 0], "vertex-2": [1, -1, 0], "vertex-3": [1, 1, 0], "vertex-4": [-1, 1, 0]}),
    ] {
        let mut surface = surface;
        surface["material"] = json!("squares");
        surface["motion"] =
            json!([{"time": 0, "translate": [-0.1, 0, 0]}, {"time": 1, "axis": [0.2, 1, 0.3], "angle": 40}]);
        let desc = parse(camera.clone(), json!([surface]));
        let moving = build(&desc).unwrap();
        let mut seen = 0;
        for time in [0.0, 0.3, 0.5, 0.9] {
            let mut still = desc.clone();
            still.set_shutter(ShutterDesc::at(f64::from(time))).unwrap();
            let still = build(&still).unwrap();
            for i in 0..100_u32 {
                let place = DVec3::new(f64::from(i % 10) * 0.2 - 0.9, f64::from(i / 10) * 0.2 - 0.9, 5.0);
                let of = |scene: &Scene, time: f32| {
                    let ray = Ray::new(scene.to_scene(place), DVec3::NEG_Z.as_vec3a()).at_time(time);
                    let hit = scene.intersect(&ray)?;
                    let at = scene.interaction(&ray, &hit);
                    Some((scene.detail(&hit, &at).uv, at.ns))
                };
                if let (Some((a, na)), Some((b, nb))) = (of(&moving, time), of(&still, 0.0))
                    && nb.z.abs() > 0.3
                {
                    let off = (0..2).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
                    // Once around, coordinates begin again.
                    assert!(
                        !(5e-3..=0.995).contains(&off) && na.dot(nb) > 0.9999,
                        "{surface} at {time}: {a:?}, not {b:?}"
                    );
                    seen += 1;
                }
            }
        }
        assert!(seen > 80, "{seen}: {surface}");
    }
}

/// Hits of a moving triangle have the weights of its vertices in their order, also where the motion mirrors it all the time.
#[test]
fn a_moving_triangle_that_is_mirrored_keeps_the_order_of_its_vertices() {
    let camera = json!({"origin": [0, 0, 4], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60});
    for scale in [1.0, -1.0] {
        let motion = json!([
            {"time": 0, "scale": [scale, 1, 1]}, {"time": 1, "scale": [scale, 1, 1], "translate": [1, 0, 0]}
        ]);
        let surfaces = json!([{
            "geometry": "triangle", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [0, 1, 0], "material": "squares",
            "motion": motion
        }]);
        let mut desc = parse(camera.clone(), surfaces);
        desc.motion.shutter = ShutterDesc { open: 0.0, close: 1.0, ..desc.motion.shutter };
        let scene = build(&desc).unwrap();
        // A quarter along the first side and an eighth along the other.
        let at = DVec3::new(0.25 * scale + 0.5, 0.125, 1.0);
        let ray = Ray { time: 0.5, ..Ray::new(scene.to_scene(at), etendue::math::Vec3::NEG_Z) };
        let hit = scene.intersect(&ray).expect("a hit");
        let found = scene.describe_hit(&ray, &hit);
        for weights in [found.barycentric, found.uv, scene.uv(&hit)] {
            assert!((weights[0] - 0.25).abs() < 1e-5 && (weights[1] - 0.125).abs() < 1e-5, "{scale}: {weights:?}");
        }
    }
}
