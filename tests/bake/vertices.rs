//! Irradiance at vertices.

use etendue::bake::{VertexOptions, Vertices};
use etendue::spectrum::Rgb;

use super::*;

fn vertices(scene: &Scene, spacing: Option<f64>) -> Vertices {
    Vertices::new(scene, &VertexOptions { spacing, ..VertexOptions::default() }, &Cancel::new()).unwrap()
}

/// Solid angle of a rectangle seen from a point at a height over its plane, its corners relative to the foot.
fn solid_angle([x0, x1]: [f64; 2], [z0, z1]: [f64; 2], h: f64) -> f64 {
    let corner = |x: f64, z: f64| (x * z / (h * (x * x + z * z + h * h).sqrt())).atan();
    corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0)
}

/// What vertices receive adds up to what the surface does, however it is cut.
#[test]
fn flux_is_kept() {
    let place = DVec3::new(0.3, 0.8, -0.4);
    let surfaces = vec![(square(0.0, true), BsdfDesc::Lambert { albedo: Rgb::splat(0.5) }, None)];
    let mut desc = scenes::scene(scenes::camera(DVec3::Y, DVec3::ZERO, 60.0), surfaces);
    desc.lights = vec![scenes::point_light(place, 3.0)];
    let scene = build(&desc);
    let exact = 3.0 * solid_angle([-1.3, 0.7], [-0.6, 1.4], 0.8);
    for (spacing, count) in [(None, 4), (Some(0.5), 49), (Some(0.1), 900)] {
        let vertices = vertices(&scene, spacing);
        assert_eq!(vertices.vertices().len(), count, "{spacing:?}");
        assert_eq!(vertices.sites().len(), count);
        let area: f64 = vertices.areas().iter().sum();
        assert!((area - 4.0).abs() < 1e-9, "{area}");
        let (baked, _) = bake(&scene, vertices.sites(), settings(4096 / count as u32 * 8, None));
        let sums = |values: &[[f32; 3]]| {
            let flux = vertices.areas().iter().zip(values).map(|(area, value)| area * f64::from(value[0]));
            (flux.clone().sum::<f64>(), flux.map(|flux| flux * flux).sum::<f64>().sqrt())
        };
        let ((flux, _), (_, error)) = (sums(&baked.irradiance), sums(&baked.standard_error));
        assert!(error < 3e-3 * exact, "{error}");
        assert!((flux - exact).abs() < 5.0 * error.max(1e-5 * exact), "{flux} +- {error} and not {exact}");
    }
}

#[test]
fn vertices_are_those_of_the_description() {
    let mut mesh = scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0));
    // One that nothing uses.
    mesh.positions.insert(0, DVec3::splat(9.0));
    mesh.triangles.iter_mut().flatten().for_each(|corner| *corner += 1);
    let mut desc = one_mesh(mesh, Some(Rgb::ONE));
    scenes::add(&mut desc, 1, square(3.0, false), BsdfDesc::Lambert { albedo: Rgb::splat(0.25) }, None);
    let scene = build(&desc);
    let vertices = vertices(&scene, None);
    assert_eq!((vertices.of_surface(0), vertices.of_surface(1), vertices.of_surface(2)), (0..9, 9..13, 0..0));
    for (vertex, position) in vertices.vertices().iter().zip(&desc.meshes[0].positions) {
        assert!(vertex.position.distance(*position) < 1e-5);
    }
    assert_eq!(vertices.sites().len(), 12);
    assert_eq!(vertices.vertices()[0].normal, Vec3::ZERO);
    let (baked, _) = bake(&scene, vertices.sites(), settings(64, None));
    let irradiance = vertices.spread(&baked.irradiance);
    assert_eq!(irradiance[0], [0.0; 3]);
    // The furnace: E = pi L / (1 - rho), and its radiosity the same.
    let exact = std::f32::consts::PI / 0.5;
    let radiosity = vertices.radiosity(&irradiance, true);
    let behind = vertices.radiosity(&irradiance, false);
    for i in 1..9 {
        let off = 5.0 * baked.standard_error[i - 1][0] + 1e-4;
        assert!((irradiance[i][0] - exact).abs() < off, "{:?}", irradiance[i]);
        assert!((radiosity[i][0] - exact).abs() < off, "{:?}", radiosity[i]);
        // It emits on the outer side alone.
        assert_eq!(behind[i], irradiance[i].map(|value| 0.5 * value));
    }
    for i in 9..13 {
        assert_eq!(radiosity[i], irradiance[i].map(|value| 0.25 * value));
    }
}

/// Cutting goes through shared sides at the same points, and round surfaces stay round.
#[test]
fn cutting_leaves_no_cracks() {
    let sphere = ShapeDesc::Sphere { centre: DVec3::new(5.0, 0.0, 0.0), radius: 1.0 };
    let mut desc = one_mesh(scenes::box_inside(DVec3::splat(-1.0), DVec3::splat(1.0)), None);
    scenes::add(&mut desc, 1, sphere, BsdfDesc::Black, None);
    let scene = build(&desc);
    let vertices = vertices(&scene, Some(0.1));
    // 29 parts of each side of 12 triangles: 12 n^2 triangles, 6 n^2 + 2 vertices of a closed surface.
    let n = 29;
    assert_eq!(vertices.of_surface(0), 0..6 * n * n + 2);
    let mut sides = std::collections::HashMap::new();
    for triangle in vertices.triangles() {
        let [a, b, c] = triangle.map(|i| vertices.vertices()[i as usize].position);
        assert!(a.distance(b).max(b.distance(c)).max(c.distance(a)) < 0.1 + 1e-6);
        for i in 0..3 {
            *sides.entry((triangle[i], triangle[(i + 1) % 3])).or_insert(0) += 1;
        }
    }
    // Of each side two triangles, one in each direction.
    assert!(sides.iter().all(|((a, b), count)| *count == 1 && sides.contains_key(&(*b, *a))));
    for vertex in &vertices.vertices()[vertices.of_surface(1)] {
        let out = vertex.position - DVec3::new(5.0, 0.0, 0.0);
        assert!((out.length() - 1.0).abs() < 1e-5, "{vertex:?}");
        assert!((vertex.normal.as_dvec3() - out).length() < 1e-3, "{vertex:?}");
    }
}

/// What a vertex reflects and emits is what the textures have there.
#[test]
fn textures_count_at_vertices() {
    use etendue::desc::{TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping, TextureSource};
    use etendue::texture::{Pattern, Procedural};

    let surfaces = vec![(square(0.0, true), BsdfDesc::Lambert { albedo: Rgb::splat(0.5) }, None)];
    let mut desc = scenes::scene(scenes::camera(DVec3::Y, DVec3::ZERO, 60.0), surfaces);
    desc.materials[0].emission = Some(Rgb::splat(3.0));
    // A ramp over x from -1 to 1, in the space of the world.
    let pattern = Procedural { pattern: Pattern::Gradient, colors: [Rgb::ZERO, Rgb::ONE], in_space: true };
    let mapping = TextureMapping::Space { scale: DVec3::splat(0.5), offset: DVec3::splat(0.5) };
    let source = TextureSource::Procedural(pattern);
    let ramp = desc
        .add_texture(TextureDesc { name: "ramp".into(), path: String::new(), source, mapping, vertex_colors: false })
        .unwrap();
    for key in [TextureKey::Color, TextureKey::Emission] {
        let binding =
            TextureBinding { key, texture: ramp, channel: TextureChannel::Default, strength: 1.0, cutoff: 0.0 };
        desc.set_material_texture(0, key, Some(binding)).unwrap();
    }
    let scene = build(&desc);
    let vertices = vertices(&scene, Some(0.5));
    let found = vertices.radiosity(&vec![[2.0; 3]; vertices.vertices().len()], true);
    for (vertex, found) in vertices.vertices().iter().zip(found) {
        let share = (0.5 * vertex.position.x + 0.5).clamp(0.0, 1.0);
        let exact = share * (0.5 * 2.0 + std::f64::consts::PI * 3.0);
        assert!((f64::from(found[0]) - exact).abs() < 1e-4, "{}: {found:?}, not {exact}", vertex.position);
    }
}
