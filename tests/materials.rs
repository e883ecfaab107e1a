//! Opacity, emission and media of materials, and mixtures of them, from descriptions to pictures.

mod common;

use common::scenes::{Job, render_scene};
use etendue::desc::{self, BsdfDesc, IntegratorDesc, MaterialDesc, SceneDesc, SurfaceLook};
use etendue::render::{Render, RenderSettings};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{Error, ErrorKind};
use serde_json::{Value, json};

const FREE: [IntegratorDesc; 3] = [IntegratorDesc::Path, IntegratorDesc::Direct, IntegratorDesc::Whitted];

fn parse(scene: &Value) -> Result<SceneDesc, Error> {
    desc::parse(&scene.to_string(), &common::snippets::data_dir(), None)
}

fn build(scene: &Value) -> Scene {
    Scene::build(&parse(scene).expect("a scene"), &BuildOptions::default()).expect("a scene that builds")
}

fn quad(half: f64, z: f64, more: &Value) -> Value {
    let mut quad = json!({"geometry": "quad", "vertex-1": [-half, -half, z], "vertex-2": [half, -half, z],
        "vertex-3": [half, half, z], "vertex-4": [-half, half, z]});
    quad.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    quad
}

/// Means of several renders with different seeds, and the standard error of their mean.
fn mean(scene: &Scene, integrator: IntegratorDesc, side: u32, samples: u32) -> [f64; 2] {
    const SEEDS: u64 = 12;
    let one = |seed| {
        let job = Job { resolution: [side; 2], samples, integrator, seed, ..Job::default() };
        let (image, _) = render_scene(scene, job.desc());
        image.rgb.iter().map(|value| f64::from(*value)).sum::<f64>() / image.rgb.len() as f64
    };
    let means: Vec<f64> = (1..=SEEDS).map(one).collect();
    let mean = means.iter().sum::<f64>() / SEEDS as f64;
    let square = means.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (SEEDS - 1) as f64;
    [mean, (square / SEEDS as f64).sqrt()]
}

/// Checks a value that would be noticed if it were two percent wrong.
fn is(name: &str, [seen, error]: [f64; 2], exact: f64) {
    assert!(error * 5.0 < 0.02 * exact, "{name}: {seen} with an error of {error}, too much to see a fault of {exact}");
    assert!((seen - exact).abs() < 4.5 * error + 1e-6, "{name}: {seen} with an error of {error}, not {exact}");
}

fn scene(origin: [f64; 3], target: [f64; 3], materials: &Value, lights: &Value, surfaces: &Value) -> Value {
    json!({"etendue": 1, "camera": {"origin": origin, "lookAt": target, "fieldOfView": 40},
        "materials": materials, "lights": lights, "surfaces": surfaces})
}

/// Black sheets of opacity a before a lamp let 1 - a of its light pass, each of them.
#[test]
fn sheets_show_what_is_behind_them_by_their_opacity() {
    let materials = json!([{"name": "veil", "type": "black", "opacity": 0.3}]);
    let lamp = quad(20.0, -2.0, &json!({"emission": [1, 1, 1]}));
    for count in [1, 2] {
        let mut surfaces = vec![lamp.clone()];
        surfaces.extend((0..count).map(|i| quad(20.0, -0.1 * f64::from(i), &json!({"material": "veil"}))));
        let scene = build(&scene([0.0, 0.0, 4.0], [0.0; 3], &materials, &json!([]), &json!(surfaces)));
        assert!(scene.info().to_string().contains("1 materials are not opaque"), "{}", scene.info());
        for integrator in FREE {
            is(&format!("{integrator:?}, {count}"), mean(&scene, integrator, 16, 64), 0.7_f64.powi(count));
        }
    }
}

/// The shadow of a sheet of opacity a is a deep.
#[test]
fn shadows_of_sheets_have_their_opacity() {
    let materials = |opacity: f64| {
        json!([{"name": "veil", "type": "black", "opacity": opacity},
               {"name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8]}])
    };
    let floor = quad(4.0, 0.0, &json!({"material": "white"}));
    let veil = quad(20.0, 1.0, &json!({"material": "veil"}));
    let down = json!({"emission": [9, 9, 9], "transform": {"rotate": [180, 0, 0], "translate": [0, 0, 6]}});
    let area = quad(0.5, 0.0, &down);
    let point = json!([{"type": "point", "origin": [0, 0, 3], "color": [9, 9, 9]}]);
    for (name, lights, lamps) in [("point", point, vec![]), ("area", json!([]), vec![area])] {
        // The camera is below the sheet.
        let of = |opacity| {
            let mut surfaces = vec![floor.clone(), veil.clone()];
            surfaces.extend(lamps.iter().cloned());
            build(&scene([0.0, -0.3, 0.8], [0.0; 3], &materials(opacity), &lights, &json!(surfaces)))
        };
        for integrator in FREE {
            let ([open, open_error], [veiled, error]) =
                (mean(&of(0.0), integrator, 32, 64), mean(&of(0.4), integrator, 32, 64));
            let error = (error.powi(2) + (0.6 * open_error).powi(2)).sqrt();
            is(&format!("{name}, {integrator:?}"), [veiled / open, error / open], 0.6);
        }
    }
}

/// Anisotropic materials, whose Bsdf turns with the surface, and mirrors are met with their opacity as well.
#[test]
fn any_material_is_met_with_its_opacity() {
    for material in [
        json!({"type": "conductor", "metal": "Au", "roughness": 0.5, "anisotropy": 0.6}),
        json!({"type": "reflective"}),
        json!({"type": "thin-refractive", "refractionIndex": 1.5, "transmittance": [0, 0, 0]}),
        json!({"type": "principled", "coat_weight": 0.5}),
    ] {
        let mut material = material;
        (material["name"], material["opacity"]) = (json!("veil"), json!(0.25));
        // Only the lamp behind the sheet gives light, to its own front.
        let surfaces =
            json!([quad(20.0, -2.0, &json!({"emission": [1, 1, 1]})), quad(3.0, 0.0, &json!({"material": "veil"}))]);
        let scene = build(&scene([0.0, 0.0, 2.0], [0.0; 3], &json!([material]), &json!([]), &surfaces));
        let [seen, error] = mean(&scene, IntegratorDesc::Whitted, 16, 64);
        is(&material.to_string(), [seen, error], 0.75);
    }
}

#[test]
fn an_opacity_of_one_changes_nothing() {
    let of = |more: Value| {
        let mut material = json!({"name": "m", "type": "diffuse", "color": [0.5, 0.4, 0.3]});
        material.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        let surfaces =
            json!([quad(1.0, 0.0, &json!({"material": "m"})), quad(1.0, 3.0, &json!({"emission": [1, 1, 1]}))]);
        let scene = build(&scene([0.0, 0.0, 2.0], [0.0; 3], &json!([material]), &json!([]), &surfaces));
        assert!(scene.is_opaque() && !scene.uses_time());
        bits(&scene, IntegratorDesc::Path)
    };
    assert_eq!(of(json!({})), of(json!({"opacity": 1, "emission": null})));
}

fn bits(scene: &Scene, integrator: IntegratorDesc) -> Vec<u32> {
    let job = Job { resolution: [16, 12], samples: 4, integrator, ..Job::default() };
    let (image, _) = render_scene(scene, job.desc());
    image.rgb.iter().map(|value| value.to_bits()).collect()
}

/// A room with lamps of every shape that can emit. Each lamp has the material `lamp`, and `emission` besides.
fn lamps(material: &Value, emission: &Value) -> Value {
    let mut look = json!({"material": "lamp"});
    if !emission.is_null() {
        look["emission"] = emission.clone();
    }
    let with = |mut surface: Value| {
        surface.as_object_mut().expect("an object").extend(look.as_object().expect("an object").clone());
        surface
    };
    let mut lamp = json!({"name": "lamp", "type": "diffuse", "color": [0.2, 0.5, 0.3]});
    lamp.as_object_mut().expect("an object").extend(material.as_object().expect("an object").clone());
    let materials = json!([{"name": "white", "type": "diffuse", "color": [0.8, 0.8, 0.8]}, lamp]);
    let surfaces = json!([
        quad(4.0, -1.0, &json!({"material": "white"})),
        with(quad(0.5, 0.5, &json!({"transform": {"rotate": [150, 0, 0]}}))),
        with(json!({"geometry": "sphere", "origin": [1, 0, 0], "radius": 0.3})),
        with(
            json!({"geometry": "triangle", "vertex-1": [-1, 0, 0], "vertex-2": [-1, 1, 0], "vertex-3": [-2, 0, -0.5]})
        ),
        with(json!({"geometry": "mesh", "file": "pyramid.obj", "scale": 0.2, "origin": [0, -1, 0]})),
    ]);
    scene([0.0, 0.0, 4.0], [0.0; 3], &materials, &json!([]), &surfaces)
}

/// The emission of a material is that of its surfaces, to the last bit.
#[test]
fn materials_emit_as_their_surfaces_would() {
    let own = build(&lamps(&json!({}), &json!([3, 2, 1])));
    let of_material = lamps(&json!({"emission": [3, 2, 1]}), &Value::Null);
    let lit = build(&of_material);
    assert_eq!(lit.emitters().emitters().len(), own.emitters().emitters().len());
    for integrator in [
        IntegratorDesc::Path,
        IntegratorDesc::Whitted,
        IntegratorDesc::Direct,
        IntegratorDesc::Photon,
        IntegratorDesc::Radiosity,
    ] {
        let (seen, expected) = (bits(&lit, integrator), bits(&own, integrator));
        assert!(seen == expected, "{integrator:?}");
        assert!(expected.iter().any(|bits| f32::from_bits(*bits) > 0.1), "{integrator:?}");
    }
    // The emission of a surface counts before that of its material.
    let both = build(&lamps(&json!({"emission": [7, 7, 7]}), &json!([3, 2, 1])));
    assert!(bits(&both, IntegratorDesc::Path) == bits(&own, IntegratorDesc::Path));

    // Edits of the material reach all of its surfaces.
    let mut desc = parse(&of_material).unwrap();
    let lamp = desc.find_material("lamp").unwrap();
    let dark = build(&lamps(&json!({}), &Value::Null));
    let bsdf = desc.materials[lamp].bsdf;
    let emission = |radiance: Option<Rgb>| MaterialDesc { bsdf, emission: radiance, ..MaterialDesc::default() };
    desc.set_material_desc(lamp, emission(None)).unwrap();
    let switched_off = lit.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!(bits(&switched_off, IntegratorDesc::Path) == bits(&dark, IntegratorDesc::Path));
    desc.set_material_desc(lamp, emission(Some(Rgb::new(3.0, 2.0, 1.0)))).unwrap();
    let again = switched_off.rebuild(&desc, &BuildOptions::default()).unwrap();
    assert!(bits(&again, IntegratorDesc::Path) == bits(&own, IntegratorDesc::Path));
    desc.set_material_desc(lamp, emission(Some(Rgb::ONE))).unwrap();
    let brighter = again.rebuild(&desc, &BuildOptions::default()).unwrap();
    let expected = build(&lamps(&json!({"emission": [1, 1, 1]}), &Value::Null));
    assert!(bits(&brighter, IntegratorDesc::Path) == bits(&expected, IntegratorDesc::Path));
}

/// Integrators that store light on surfaces refuse a description whose surfaces are not opaque, by name.
#[test]
fn what_stores_light_refuses_materials_that_are_not_opaque() {
    let materials = json!([{"name": "veil", "type": "diffuse", "color": [1, 1, 1], "opacity": 0.5}]);
    let surfaces =
        json!([quad(1.0, 0.0, &json!({"material": "veil"})), quad(1.0, 3.0, &json!({"emission": [1, 1, 1]}))]);
    let scene = build(&scene([0.0, 0.0, 2.0], [0.0; 3], &materials, &json!([]), &surfaces));
    let mut refused = 0;
    for integrator in IntegratorDesc::ALL {
        let desc = Job { resolution: [4, 4], samples: 1, integrator, ..Job::default() }.desc();
        if let Err(error) = Render::new(&scene, RenderSettings { desc, ..RenderSettings::default() }) {
            let text = error.to_string();
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            assert!(text.contains(integrator.name()) && text.contains("not opaque"), "{text}");
            refused += 1;
        }
    }
    assert_eq!(refused, IntegratorDesc::ALL.len() - FREE.len() - 1, "all but path, direct, whitted and auto");
}

/// The description refuses what would be counted twice or has no meaning, in files, in calls and when a scene is built.
#[test]
fn what_emits_is_opaque_and_can_emit() {
    let veil = json!({"opacity": 0.5});
    let error = parse(&lamps(&veil, &json!([1, 1, 1]))).unwrap_err().to_string();
    let expected = "surfaces[1].emission: the material 'lamp' has an opacity of 0.5, expected an opaque one";
    assert!(error.contains(expected), "{error}");

    let mut cone = lamps(&json!({"emission": [1, 1, 1]}), &Value::Null);
    cone["surfaces"][1] = json!({
        "geometry": "cone", "base": [0, 0, 0], "axis": [0, 0, 1], "radius": 1, "height": 1, "material": "lamp"
    });
    let error = parse(&cone).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert!(
        error
            .to_string()
            .contains("surfaces[1].material: the material 'lamp' emits light: of the quadrics, only cylinders"),
        "{error}"
    );

    // Calls.
    let mut desc = parse(&lamps(&json!({}), &Value::Null)).unwrap();
    let lamp = desc.find_material("lamp").unwrap();
    let before = format!("{desc:?}");
    let with = |opacity: f32, emission: Option<Rgb>| MaterialDesc { opacity, emission, ..MaterialDesc::default() };
    for (wrong, path) in [
        (with(1.5, None), "materials[1].opacity: 1.5 is out of range"),
        (with(f32::NAN, None), "materials[1].opacity: NaN is out of range"),
        (with(0.5, Some(Rgb::ONE)), "materials[1].opacity: a material that emits light has an opacity of 0.5"),
        (with(1.0, Some(Rgb::splat(-1.0))), "materials[1].emission[0]: -1 is negative"),
        (with(1.0, Some(Rgb::splat(f32::INFINITY))), "materials[1].emission[0]: inf"),
    ] {
        let error = desc.set_material_desc(lamp, wrong).unwrap_err().to_string();
        assert!(error.contains(path), "{error}, not {path}");
    }
    assert_eq!(format!("{desc:?}"), before);
    // A material without any light is no emitter.
    desc.set_material_desc(lamp, with(0.5, Some(Rgb::ZERO))).unwrap();
    assert_eq!(desc.materials[lamp].emission, None);
    let error = desc.set_emission(1, Some(Rgb::ONE)).unwrap_err().to_string();
    assert!(error.contains("surfaces[1].emission: the material 'lamp' has an opacity of 0.5"), "{error}");
    let mix = BsdfDesc::Mix { materials: [0, lamp], weight: 0.5 };
    let error = desc.add_material("mix", mix, None).unwrap_err().to_string();
    assert!(error.contains("materials[2].materials[1]: the material 'lamp' has an opacity"), "{error}");
    desc.set_material_desc(lamp, with(1.0, None)).unwrap();
    desc.add_material("mix", mix, None).unwrap();
    let error = desc.set_material_desc(lamp, with(1.0, Some(Rgb::ONE))).unwrap_err().to_string();
    assert!(error.contains("materials[2].materials[1]: the material 'lamp' has an emission"), "{error}");
    let (shape, local) =
        etendue::desc::ShapeDesc::ellipsoid(etendue::math::DVec3::ZERO, etendue::math::DVec3::ONE).unwrap();
    let whole = desc.find_material("mix").unwrap();
    desc.add_surface(shape, local, SurfaceLook { material: Some(whole), ..SurfaceLook::default() }).unwrap();
    let error = desc.set_material_desc(whole, with(1.0, Some(Rgb::ONE))).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    let text = error.to_string();
    assert!(text.contains("materials[2].emission: surfaces[5] cannot have this material"), "{text}");

    // Descriptions that were put together by hand.
    let build = |edit: &dyn Fn(&mut SceneDesc)| {
        let mut desc = parse(&lamps(&json!({}), &Value::Null)).unwrap();
        edit(&mut desc);
        Scene::build(&desc, &BuildOptions::default()).map(|_| ()).unwrap_err().to_string()
    };
    let said = build(&|desc| desc.materials[1].opacity = f32::NAN);
    assert!(said.contains("materials[1].opacity: NaN"), "{said}");
    let said = build(&|desc| {
        desc.materials[1].opacity = 0.5;
        desc.surfaces[2].emission = Some(Rgb::ONE);
    });
    assert!(said.contains("surfaces[2].emission: the material 'lamp' has an opacity"), "{said}");

    // Rays that pass the surface of a body unseen would be refracted on their way out alone. A thin sheet has no inside.
    for (kind, is_refused) in [
        (json!({"type": "refractive", "refractionIndex": 1.5}), true),
        (json!({"type": "refractive", "refractionIndex": 1.5, "roughness": 0.3, "absorption": [1, 1, 1]}), true),
        (json!({"type": "principled", "transmission_weight": 0.5}), true),
        (json!({"type": "principled", "transmission_weight": 0.5, "thin_walled": true}), false),
        (json!({"type": "thin-refractive", "refractionIndex": 1.5}), false),
    ] {
        for (opacity, may_be) in [(0.5, false), (0.0, true), (1.0, true)] {
            let mut body = lamps(&json!({}), &Value::Null);
            body["materials"][1] = kind.clone();
            (body["materials"][1]["name"], body["materials"][1]["opacity"]) = (json!("lamp"), json!(opacity));
            match parse(&body) {
                Ok(_) => assert!(may_be || !is_refused, "{kind} {opacity}"),
                Err(error) => {
                    assert!(is_refused && !may_be, "{error}");
                    let expected = "materials[1].opacity: a body that refracts light has an opacity of 0.5";
                    assert!(error.to_string().contains(expected), "{error}");
                }
            }
        }
    }
}

/// The picture of a ball of a material, in a medium of water if `wet`, in front of a lamp that fills the view.
fn ball(materials: &Value, wet: bool) -> Vec<f32> {
    let mut surfaces = vec![
        json!({"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "ball"}),
        quad(9.0, -3.0, &json!({"emission": [1, 1, 1]})),
    ];
    if wet {
        surfaces.push(json!({"geometry": "sphere", "origin": [0.3, 0, 0], "radius": 1.5, "material": "water"}));
    }
    let mut all =
        vec![json!({"name": "water", "type": "refractive", "refractionIndex": 1.33, "absorption": [0.1, 0, 0]})];
    all.extend(materials.as_array().expect("materials").iter().cloned());
    let scene = build(&scene([0.0, 0.0, 4.0], [0.0; 3], &json!(all), &json!([]), &json!(surfaces)));
    render_scene(&scene, Job { resolution: [16; 2], samples: 64, ..Job::default() }.desc()).0.rgb
}

/// Whether two pictures are the same but for the last digits, which differ where an index comes from another formula.
fn are_near(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-4 * a.abs().max(b.abs()))
}

/// A mixture is the body of its parts; a part without weight is none.
#[test]
fn mixtures_keep_the_medium_of_their_parts() {
    let glass = json!({"name": "ball", "type": "refractive", "refractionIndex": 1.5, "absorption": [0.9, 0.1, 0.1],
        "priority": 1});
    let dark = json!({"name": "ball", "type": "principled", "transmission_weight": 1, "specular_roughness": 0.2,
        "transmission_color": [0.2, 0.8, 0.8], "transmission_depth": 1.5, "priority": 2});
    for body in [glass, dark] {
        for wet in [false, true] {
            let alone = ball(&json!([body]), wet);
            let mixed = |weight: f64| {
                let mut part = body.clone();
                part["name"] = json!("part");
                let other = json!({"name": "other", "type": "diffuse", "color": [1, 1, 1]});
                let mix = json!({"name": "ball", "type": "mix", "materials": ["part", "other"], "weight": weight});
                ball(&json!([part, other, mix]), wet)
            };
            assert!(mixed(0.0) == alone, "{body} {wet}");
            // Half a body still absorbs: what comes through is dark in red.
            let half = mixed(0.5);
            let middle = 3 * (8 * 16 + 8);
            assert!(half[middle] < 0.9 * half[middle + 1], "{body} {wet}: {:?}", &half[middle..middle + 3]);
        }
    }
    // Two different bodies in one surface.
    let error = |second: Value| {
        let materials = json!([
            {"name": "a", "type": "refractive", "refractionIndex": 1.5, "roughness": 0.3, "absorption": [1, 1, 1]},
            second,
            {"name": "ball", "type": "mix", "materials": ["a", "b"]},
        ]);
        let surfaces = json!([{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "ball"}]);
        let desc = parse(&scene([0.0, 0.0, 4.0], [0.0; 3], &materials, &json!([]), &surfaces)).unwrap();
        Scene::build(&desc, &BuildOptions::default()).map(|_| ()).map_err(|error| error.to_string())
    };
    let other = json!({"name": "b", "type": "refractive", "refractionIndex": 1.5, "roughness": 0.5});
    let said = error(other).unwrap_err();
    assert!(said.contains("materials[2]: the parts of the mixture are bodies of different media"), "{said}");
    error(json!({"name": "b", "type": "diffuse", "color": [1, 1, 1]})).unwrap();
}

/// A priority of a principled body leaves its own absorption as it is.
#[test]
fn principled_bodies_absorb_whatever_their_priority() {
    let with = |priority: u32| {
        ball(
            &json!([{"name": "ball", "type": "principled", "transmission_weight": 1, "specular_roughness": 0,
                "transmission_color": [0.2, 0.8, 0.8], "transmission_depth": 1.5, "priority": priority}]),
            false,
        )
    };
    assert!(with(0) == with(3));
    let refractive = json!([{"name": "ball", "type": "refractive", "refractionIndex": 1.5,
        "transmittance": [0.2, 0.8, 0.8], "transmittanceDistance": 1.5}]);
    assert!(are_near(&with(0), &ball(&refractive, false)));
    // In water, too, a clear principled body is what a refractive one is.
    let clear = json!([{"name": "ball", "type": "principled", "transmission_weight": 1, "specular_roughness": 0.4,
        "priority": 1}]);
    let glass =
        json!([{"name": "ball", "type": "refractive", "refractionIndex": 1.5, "roughness": 0.4, "priority": 1}]);
    assert!(are_near(&ball(&clear, true), &ball(&glass, true)));
    let thin = json!({"etendue": 1, "camera": {}, "materials": [{"name": "a", "type": "principled", "priority": 1}]});
    let error = parse(&thin).unwrap_err().to_string();
    assert!(
        error.contains("materials[0].medium: only a refractive material, or a principled one that transmits"),
        "{error}"
    );
}

/// Materials that no surface has refuse nothing and cost nothing.
#[test]
fn materials_without_surfaces_are_not_there() {
    let unused = json!([
        {"name": "ball", "type": "diffuse", "color": [0.5, 0.5, 0.5]},
        {"name": "veil", "type": "diffuse", "color": [1, 1, 1], "opacity": 0.5},
        {"name": "ink", "type": "refractive", "refractionIndex": 1.5, "absorption": [1, 1, 1]},
        {"name": "paper", "type": "diffuse-transmission", "transmittance": [0.5, 0.5, 0.5]},
    ]);
    let surfaces = json!([
        {"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "ball"},
        quad(9.0, -3.0, &json!({"emission": [1, 1, 1]})),
    ]);
    let scene = build(&scene([0.0, 0.0, 4.0], [0.0; 3], &unused, &json!([]), &surfaces));
    assert!(!scene.has_media());
    let info = scene.info();
    assert!(["opacity", "media"].iter().all(|name| info.switched_off.contains(name)), "{info}");
    for integrator in [IntegratorDesc::Sppm, IntegratorDesc::IrradianceCache, IntegratorDesc::Radiosity] {
        let job = Job { resolution: [4; 2], samples: 4, integrator, ..Job::default() };
        render_scene(&scene, job.desc());
    }
}

/// What refracts smoothly is told by what the model makes of the numbers, and by parts that have a weight.
#[test]
fn smooth_dielectrics_of_two_indices_are_not_mixed() {
    let mix = |a: Value, b: Value, weight: f64| {
        let (mut a, mut b) = (a, b);
        (a["name"], b["name"]) = (json!("a"), json!("b"));
        let mix = json!({"name": "m", "type": "mix", "materials": ["a", "b"], "weight": weight});
        parse(&json!({"etendue": 1, "camera": {}, "materials": [a, b, mix]})).map(|_| ()).map_err(|it| it.to_string())
    };
    let glass =
        |index: f64, roughness: f64| json!({"type": "refractive", "refractionIndex": index, "roughness": roughness});
    let clear = |weight: f64, metalness: f64| {
        json!({"type": "principled", "transmission_weight": 1, "specular_roughness": 0, "specular_weight": weight,
            "base_metalness": metalness})
    };
    for (a, b) in [
        (glass(1.5, 0.0), glass(1.33, 0.0)),
        // Their facets are too narrow to be told from none.
        (glass(1.5, 0.005), glass(1.33, 0.005)),
        (glass(1.5, 0.0), clear(0.3, 0.0)),
    ] {
        let said = mix(a.clone(), b.clone(), 0.5).unwrap_err();
        assert!(said.contains("materials[2]: smooth dielectrics of the relative indices"), "{said}");
        mix(a.clone(), b.clone(), 0.0).unwrap();
        mix(a, b, 1.0).unwrap();
    }
    for (a, b) in
        [(glass(1.5, 0.0), clear(1.0, 0.0)), (glass(1.33, 0.0), clear(1.0, 1.0)), (glass(1.5, 0.3), glass(1.33, 0.0))]
    {
        mix(a, b, 0.5).unwrap();
    }
}

/// The gallery of `docs/materials.md`: each entry of `scenes/gallery/materials.json` is a scene, a picture and a cell of the table
/// (`ETENDUE_WRITE=1` writes the table), and no kind of material is without one.
#[test]
fn the_gallery_shows_every_kind_of_material() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |file: &str| std::fs::read_to_string(root.join(file)).expect(file);
    let value = |file: &str| -> Value { serde_json::from_str(&read(file)).expect(file) };
    let (ball, entries) = (value("scenes/gallery/ball.json"), value("scenes/gallery/materials.json"));
    let mut kinds = std::collections::BTreeSet::new();
    let mut cells = Vec::new();
    for entry in entries.as_array().expect("a list") {
        let [picture, what] = ["picture", "what"].map(|key| entry[key].as_str().expect("a string"));
        let mut scene = ball.clone();
        let materials = scene["materials"].as_array_mut().expect("a list");
        materials.retain(|material| material["name"] != "shown");
        let shown = entry["materials"].as_array().expect("a list");
        kinds.extend(shown.iter().flat_map(|shown| ["type", "brdf"].map(|key| shown[key].as_str())).flatten());
        materials.extend(shown.iter().cloned());
        let desc = desc::parse(&scene.to_string(), &root.join("scenes/gallery"), None);
        let desc = desc.unwrap_or_else(|error| panic!("{picture}: {error}"));
        Scene::build(&desc, &BuildOptions::default()).unwrap_or_else(|error| panic!("{picture}: {error}"));
        let file = format!("docs/gallery/{picture}.png");
        assert!(root.join(&file).exists(), "{file} is missing: make gallery");
        cells.push(format!("![{picture}](gallery/{picture}.png)<br>{what}"));
    }

    let mut table = "|  |  |  |  |\n|---|---|---|---|\n".to_owned();
    for row in cells.chunks(4) {
        let row: Vec<&str> = row.iter().map(String::as_str).chain(std::iter::repeat("")).take(4).collect();
        table += &format!("| {} |\n", row.join(" | "));
    }
    let (before, rest) = read("docs/materials.md")
        .split_once("<!-- gallery -->\n")
        .map(|(a, b)| (a.to_owned(), b.to_owned()))
        .expect("its place");
    let (_, after) = rest.split_once("<!-- end gallery -->").expect("its end");
    let expected = format!("{before}<!-- gallery -->\n{table}<!-- end gallery -->{after}");
    if std::env::var_os("ETENDUE_WRITE").is_some() {
        std::fs::write(root.join("docs/materials.md"), &expected).expect("the page can be written");
    }
    assert!(read("docs/materials.md") == expected, "the table is out of date: write it with ETENDUE_WRITE=1");

    // Every kind that the schema knows.
    let schema = read("docs/scene.schema.json");
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    let mut known = Vec::new();
    let kinds_of = |schema: &Value| -> Vec<String> {
        let list = |key: &str| schema[key].as_array().cloned().unwrap_or_default();
        let named = list("oneOf").into_iter().map(|one| one["const"].clone());
        named.chain(list("enum")).filter_map(|kind| kind.as_str().map(str::to_owned)).collect()
    };
    for model in schema["$defs"]["Material"]["anyOf"].as_array().expect("models") {
        let name = model["$ref"].as_str().and_then(|link| link.rsplit('/').next()).expect("a link");
        known.extend(kinds_of(&schema["$defs"][name]["properties"]["type"]));
    }
    known.extend(kinds_of(&schema["$defs"]["Brdf"]).into_iter().filter(|brdf| brdf != "lambertian"));
    assert!(known.len() > 16, "{known:?}");
    let missing: Vec<_> = known.iter().filter(|kind| !kinds.contains(kind.as_str())).collect();
    assert!(missing.is_empty(), "kinds of materials without a picture: {missing:?}");
}

/// A clear principled body whose colour has a depth is a body of absorbing glass, smooth or rough.
#[test]
fn a_transmission_depth_is_a_medium() {
    let image = |material: Value| {
        let scene = json!({"etendue": 1,
        "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0], "fieldOfView": 40},
        "materials": [material],
        "surfaces": [
            {"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "material": "body"},
            quad(9.0, -3.0, &json!({"emission": [1, 1, 1]})),
        ]});
        let job = Job { resolution: [24; 2], samples: 16, integrator: IntegratorDesc::Path, ..Job::default() };
        render_scene(&build(&scene), job.desc()).0.rgb
    };
    for roughness in [0.0, 0.4] {
        let principled = |depth: f64| {
            image(
                json!({"name": "body", "type": "principled", "transmission_weight": 1, "specular_roughness": roughness,
                "transmission_color": [0.25, 0.5, 1], "transmission_depth": depth}),
            )
        };
        let glass = image(json!({"name": "body", "type": "refractive", "refractionIndex": 1.5, "roughness": roughness,
            "transmittance": [0.25, 0.5, 1], "transmittanceDistance": 0.5}));
        assert!(principled(0.5) == glass, "roughness {roughness}");
        assert!(principled(0.6) != glass);
    }
}
