//! Bodies among media whose surfaces textures vary.

use super::*;
use crate::textures::scenes::vary;
use crate::textures::{described, image as texels};
use etendue::desc::{
    CameraDesc, FilmDesc, FovAxis, PrincipledDesc, Projection, ShapeDesc, TextureDesc, TextureKey, TextureMapping,
};
use etendue::texture::{ColorSpace, TextureFilter};

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "A14", title: "straight through a textured body in a liquid", run: straight },
        Entry { id: "A15", title: "furnace of nested media, roughness by a texture", run: furnace },
        Entry { id: "A16", title: "bodies in a liquid with textures of one value", run: even },
    ]
}

const SECOND: ShapeDesc = ShapeDesc::Mesh { mesh: 1, smooth: false };
const BODY: f64 = 1.5;
const LIQUID: f64 = 1.33;

/// Columns of two values, along the world's x, eight pairs of them in two units.
fn columns([first, second]: [f32; 2]) -> TextureDesc {
    let image = texels(2, 1, 1, |x, _, _| if x == 0 { first } else { second });
    let (projection, scale) = (Projection::Z, [4.0; 2]);
    TextureDesc {
        mapping: TextureMapping::Projected { projection, scale, rotation: 0.0, offset: [0.0; 2] },
        ..described("columns", &image, ColorSpace::Linear, TextureFilter::Nearest, 1.0)
    }
}

fn clear(transmission_color: Rgb) -> BsdfDesc {
    BsdfDesc::Principled(PrincipledDesc {
        base_color: Rgb::ZERO,
        specular_roughness: 0.0,
        specular_ior: BODY as f32,
        transmission_weight: 1.0,
        transmission_color,
        ..PrincipledDesc::default()
    })
}

/// What comes straight through air, liquid, body, liquid and air. `colour`: the share that both faces of the body let pass
/// together beside what they reflect; `left`: what is left after each way through a medium.
fn through_liquid(colour: f64, left: [f64; 3]) -> f64 {
    let indices = [1.0, LIQUID, BODY, LIQUID, 1.0];
    let face = colour.sqrt();
    let shares = [1.0, face, face, 1.0];
    // From the far side on: what is reflected by all that lies behind, and what comes through.
    let (mut reflected, mut transmitted) = (0.0, 1.0);
    for i in (0..4).rev() {
        let r = ((indices[i] - indices[i + 1]) / (indices[i] + indices[i + 1])).powi(2);
        let passes = (1.0 - r) * shares[i];
        let a = if i < 3 { left[i] } else { 1.0 };
        let behind = reflected * a * a;
        let between = 1.0 / (1.0 - r * behind);
        (reflected, transmitted) = (r + passes * passes * behind * between, passes * between * a * transmitted);
    }
    transmitted
}

fn straight(case: &mut Case) {
    const DARK: f32 = 0.25;
    let (eye, axis) = (DVec3::Z * 4.0, FovAxis::Horizontal);
    let view = CameraDesc::Orthographic {
        eye,
        look_at: DVec3::ZERO,
        up: DVec3::Y,
        size: 2.0,
        axis,
        film: FilmDesc::default(),
    };
    let tint = Rgb::new(0.5, 1.0, 3.0);
    let block = |half: f64, depth: f64| {
        let size = DVec3::new(half, half, depth);
        Arc::new(turned(box_inside(-size, size), DVec3::ZERO, false))
    };
    let bodies: [(&str, BsdfDesc, TextureKey, f64); 3] = [
        ("colour", clear(Rgb::ONE), TextureKey::TransmissionColor, f64::from(DARK)),
        ("opaque columns", clear(Rgb::ONE), TextureKey::TransmissionWeight, 0.0),
        ("mixture", BsdfDesc::Black, TextureKey::Weight, f64::from(DARK)),
    ];
    for (what, body, key, dark) in bodies {
        let lamp = (plane(DVec3::NEG_Z * 3.0, DVec3::Z, 1e2), BsdfDesc::Black, Some(Rgb::ONE));
        let mut desc = scene(view, vec![(MESH, glass(LIQUID as f32, 1.0), None), lamp]);
        desc.meshes.push(block(3.0, 1.0));
        desc.meshes.push(block(2.0, 0.5));
        fill(&mut desc, [0], tint, 1);
        if key == TextureKey::Weight {
            add(&mut desc, 2, MESH, clear(Rgb::ONE), None);
            add(&mut desc, 3, MESH, clear(Rgb::splat(DARK)), None);
            fill(&mut desc, [2, 3], Rgb::ZERO, 2);
            desc.surfaces.truncate(2);
            add(&mut desc, 2, MESH, BsdfDesc::Mix { materials: [2, 3], weight: 1.0 }, None);
        } else {
            add(&mut desc, 2, MESH, body, None);
            fill(&mut desc, [2], Rgb::ZERO, 2);
        }
        desc.surfaces[2].shape = SECOND;
        let own = desc.surfaces[2].material.unwrap();
        let values = if key == TextureKey::TransmissionColor { [1.0, DARK] } else { [0.0, 1.0] };
        vary(&mut desc, own, key, columns(values));
        let scene = build(&desc);
        for integrator in [IntegratorDesc::Path, IntegratorDesc::Whitted, IntegratorDesc::Sppm] {
            let image = image(&scene, integrator, case.count(64, 1024), 1);
            for i in 0..3 {
                let around = (-0.5 * tint.to_f64().to_array()[i]).exp();
                let exact =
                    0.5 * [1.0, dark].map(|colour| through_liquid(colour, [around, 1.0, around])).iter().sum::<f64>();
                let name = format!("{what}, {}, channel {i}", integrator.name());
                case.biased_mean(name, channel(&image, i), exact, (OFFSET, pick(case, 4e-3, 1e-3)));
            }
        }
    }
}

/// Values from 0.25 to 1 on squares.
fn squares(name: &str) -> TextureDesc {
    let image = texels(8, 4, 1, |x, y, _| 0.25 + 0.75 * ((5 * x + 3 * y) % 8) as f32 / 7.0);
    described(name, &image, ColorSpace::Linear, TextureFilter::Bilinear, 1.0)
}

fn furnace(case: &mut Case) {
    let roughness = |desc: &mut SceneDesc, material: usize| {
        vary(desc, material, TextureKey::Roughness, squares(&format!("squares {material}")));
    };
    nested(case, &[IntegratorDesc::Path, IntegratorDesc::Sppm], 8, 0.8, roughness);
}

/// A texture of one value changes nothing but that the model is made at each hit.
fn even(case: &mut Case) {
    let view = camera(DVec3::new(0.3, 0.5, 3.2), DVec3::ZERO, 45.0);
    // Parameters that textures round are multiples of their steps.
    let coated = PrincipledDesc {
        base_color: Rgb::new(0.8, 0.4, 0.2),
        specular_roughness: 0.375,
        transmission_weight: 0.75,
        coat_weight: 0.5,
        coat_roughness: 0.25,
        ..PrincipledDesc::default()
    };
    let bodies = [
        BsdfDesc::Principled(coated),
        rough::frosted(1.8, 1.0, 0.5),
        BsdfDesc::Principled(PrincipledDesc { coat_weight: 0.0, ..coated }),
    ];
    let at = [DVec3::new(-0.5, 0.0, 0.2), DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.1, -0.6, 0.3)];
    let surfaces = bodies.into_iter().zip(at).map(|(body, at)| (ball(at, 0.4), body, None));
    let liquid = (ball(DVec3::ZERO, 1.3), glass(LIQUID as f32, 1.0), None);
    // A room that shines, but for a dark floor.
    let floor = (plane(DVec3::NEG_Y * 2.5, DVec3::Y, 3.0), grey(0.1), None);
    let room = (MESH, BsdfDesc::Black, Some(Rgb::ONE));
    let mut plain = scene(view, surfaces.chain([liquid, floor, room]).collect());
    plain.meshes.push(Arc::new(box_inside(DVec3::splat(-4.0), DVec3::splat(4.0))));
    fill(&mut plain, [0, 1, 2], ABSORPTION * 0.5, 2);
    fill(&mut plain, [3], Rgb::new(0.1, 0.05, 0.02), 1);
    let mut textured = plain.clone();
    let one = texels(1, 1, 1, |_, _, _| 1.0);
    let one = |name| described(name, &one, ColorSpace::Linear, TextureFilter::Bilinear, 1.0);
    let keys = [TextureKey::SpecularRoughness, TextureKey::Roughness, TextureKey::TransmissionWeight];
    for (material, key) in keys.into_iter().enumerate() {
        vary(&mut textured, material, key, one(["a", "b", "c"][material]));
    }
    for integrator in [IntegratorDesc::Path, IntegratorDesc::Sppm] {
        let samples = case.count(16, 256);
        let [plain, textured] =
            [(&plain, 1), (&textured, 2)].map(|(desc, seed)| image(&build(desc), integrator, samples, seed));
        for i in 0..3 {
            let ((exact, own), (mean, error)) = (channel(&plain, i), channel(&textured, i));
            let name = format!("{}, channel {i}", integrator.name());
            case.mean(name, (mean, error.hypot(own)), exact, pick(case, 1e-2, 2e-3));
        }
    }
}
