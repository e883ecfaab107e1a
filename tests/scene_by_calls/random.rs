//! Random calls: none panics, none that fails changes anything, and what is left builds or says why not.

use etendue::desc::{BsdfDesc, CameraDesc, FilmDesc, FovAxis, MeshDesc, SceneDesc, ShapeDesc, SurfaceLook};
use etendue::math::{Bounds, DAffine3, DMat3, DVec3};
use etendue::scene::{BuildOptions, Scene};
use etendue::spectrum::Rgb;
use etendue::{ErrorKind, Result};
use proptest::prelude::*;

use super::base;

/// A number of an ordinary size, or one to break things with.
fn number() -> impl Strategy<Value = f64> {
    let odd = [0.0, -1.0, 1e-40, 1e-20, 1e17, 3e38, 1e39, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    prop_oneof![12 => -2.0..2.0, 6 => 0.01..1.0, 1 => proptest::sample::select(odd.to_vec())]
}

/// One call with arguments made of ten numbers and some whole ones.
fn edit(desc: &mut SceneDesc, kind: u8, n: [f64; 10], which: [usize; 3]) -> Result<()> {
    let [a, b, c, d, e, f, g, h, i, j] = n;
    let (p, q, r) = (DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i));
    let light = 0.5 * Rgb::new(a as f32, b as f32, c as f32).abs();
    let mesh =
        MeshDesc { positions: vec![p, q, r], triangles: vec![[0, 1, which[2] as u32 % 4]], ..MeshDesc::default() };
    let bsdf = match which[1] % 5 {
        0 => BsdfDesc::Lambert { albedo: light },
        1 => BsdfDesc::Mirror { reflectance: light },
        2 => BsdfDesc::Dielectric { ior: d as f32, exterior_ior: 1.0 },
        3 => BsdfDesc::OrenNayarQualitative { albedo: light, sigma: j as f32 },
        _ => BsdfDesc::Black,
    };
    let transform = match which[2] % 3 {
        0 => DAffine3::from_translation(q),
        1 => DAffine3::from_scale(q),
        _ => DAffine3::from_mat3_translation(DMat3::from_cols(p, q, r), p),
    };
    let look = SurfaceLook {
        material: Some(which[0]).filter(|material| material % 3 > 0),
        emission: (which[1].is_multiple_of(2)).then_some(light),
        emits_both: which[0].is_multiple_of(5),
        transform: if which[2].is_multiple_of(2) { DAffine3::IDENTITY } else { transform },
    };
    match kind {
        0 => desc.set_camera(CameraDesc::Perspective {
            eye: p,
            look_at: q,
            up: r,
            fov_deg: 50.0 + 40.0 * j,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        }),
        1 => desc.add_material(["", "m", "n"][which[0] % 3], bsdf, None).map(|_| ()),
        2 => desc.set_material(which[0], bsdf, (j > 0.5).then_some(j as f32)),
        3 => desc.add_point_light(q, light).map(|_| ()),
        4 => desc.set_point_light(which[0], q, light),
        5 => desc.add_mesh(mesh).map(|_| ()),
        6 => desc.set_mesh(which[0], mesh),
        7 => desc.remove_mesh(which[0]),
        8 => desc.set_transform(which[0], transform),
        9 => desc.set_surface_material(which[0], look.material),
        10 => desc.set_emission(which[0], look.emission),
        11 => desc.remove_surface(which[0]),
        _ => {
            let (shape, local) = match kind % 8 {
                0 => ShapeDesc::sphere(p, j)?,
                1 => ShapeDesc::triangle([p, q, r])?,
                2 => ShapeDesc::quad([p, q, r, p + r - q])?,
                3 => ShapeDesc::disk(p, q, j)?,
                4 => ShapeDesc::cone(p, q, i, j)?,
                5 => ShapeDesc::ellipsoid(p, q.abs())?,
                6 => ShapeDesc::quadric(n, Some(Bounds { min: -DVec3::ONE, max: DVec3::ONE }))?,
                _ => (ShapeDesc::Mesh { mesh: which[0], smooth: which[1].is_multiple_of(2) }, DAffine3::IDENTITY),
            };
            desc.add_surface(shape, local, look).map(|_| ())
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(150) })]

    #[test]
    fn any_calls_leave_a_scene_that_builds_or_says_why_not(
        calls in proptest::collection::vec(
            (0_u8..40, proptest::array::uniform10(number()), proptest::array::uniform3(0_usize..8)), 1..40),
    ) {
        let mut desc = base();
        for (kind, numbers, which) in calls {
            let before = format!("{desc:?}");
            if let Err(error) = edit(&mut desc, kind, numbers, which) {
                prop_assert!(!error.message().is_empty());
                prop_assert_eq!(format!("{:?}", desc), before, "{} changed something", error);
            }
        }
        // What the calls accept can be said again.
        for surface in desc.surfaces.iter().filter(|surface| !surface.hidden) {
            prop_assert!(surface.material.is_none_or(|material| material < desc.materials.len()));
            if let ShapeDesc::Mesh { mesh, .. } = surface.shape {
                prop_assert!(desc.meshes[mesh].triangle_count() > 0);
            }
        }
        if let Err(error) = Scene::build(&desc, &BuildOptions { threads: 1, ..BuildOptions::default() }) {
            prop_assert!(matches!(error.kind(), ErrorKind::InvalidScene | ErrorKind::Unsupported), "{}", error);
            prop_assert!(!error.location().json_path.is_empty(), "{}", error);
        }
    }
}
