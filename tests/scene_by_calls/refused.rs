//! What no call accepts, and what it says then.

use std::path::Path;

use etendue::buffer::Buffer;
use etendue::desc::{
    BsdfDesc, CameraDesc, FilmDesc, FocusDesc, FovAxis, LensDesc, LightDistribution, MediumDesc, MeshDesc, Panorama,
    PanoramaDesc, PointLightDesc, RenderDesc, SceneDesc, ShapeDesc, SpotDesc, SurfaceLook,
};
use etendue::math::{Bounds, DAffine3, DMat3, DVec3};
use etendue::spectrum::Rgb;
use etendue::{Error, ErrorKind, Result};

use super::{A, B, base, corner, file, hosted, lit, parse};

type Call = Box<dyn Fn(&mut SceneDesc) -> Result<()>>;

/// A call that fails, where it says so, and a piece of why.
fn bad<T>(
    path: &'static str,
    why: &'static str,
    call: impl Fn(&mut SceneDesc) -> Result<T> + 'static,
) -> (&'static str, &'static str, Call) {
    (path, why, Box::new(move |desc| call(desc).map(|_| ())))
}

fn bad_cameras() -> Vec<(&'static str, &'static str, Call)> {
    let with = |eye, look_at, up, fov_deg| CameraDesc::Perspective {
        eye,
        look_at,
        up,
        fov_deg,
        fov_axis: FovAxis::Vertical,
        film: FilmDesc::default(),
    };
    let (nan, far) = (DVec3::new(0.0, f64::NAN, 0.0), DVec3::new(0.0, 0.0, 1e39));
    let parallel = |size, axis| CameraDesc::Orthographic {
        eye: A,
        look_at: B,
        up: DVec3::Y,
        size,
        axis,
        film: FilmDesc::default(),
    };
    let bent = |kind, fov_deg| {
        let panorama = PanoramaDesc { fov_deg, ..PanoramaDesc::new(kind) };
        CameraDesc::Panoramic { eye: A, look_at: B, up: DVec3::Y, panorama }
    };
    let through = |lens| CameraDesc::ThinLens {
        eye: A,
        look_at: B,
        up: DVec3::Y,
        fov_deg: 60.0,
        fov_axis: FovAxis::Vertical,
        lens,
        film: FilmDesc::default(),
    };
    let on = |shift, pixel_aspect| CameraDesc::Perspective {
        eye: A,
        look_at: B,
        up: DVec3::Y,
        fov_deg: 60.0,
        fov_axis: FovAxis::Vertical,
        film: FilmDesc { shift, pixel_aspect },
    };
    let stretched = |kind, pixel_aspect| {
        let panorama = PanoramaDesc { pixel_aspect, ..PanoramaDesc::new(kind) };
        CameraDesc::Panoramic { eye: A, look_at: B, up: DVec3::Y, panorama }
    };
    let plane = CameraDesc::ViewPlane { centre: far, look_at: A, up: DVec3::Y, fov_deg: 60.0 };
    vec![
        bad("camera.origin[1]", "NaN is beyond", move |desc| desc.set_camera(with(nan, A, DVec3::Y, 60.0))),
        bad("camera.origin[2]", "1e39 is beyond", move |desc| desc.set_camera(plane)),
        bad("camera.lookAt[2]", "1e39 is beyond", move |desc| desc.set_camera(with(A, far, DVec3::Y, 60.0))),
        bad("camera.lookAt", "is the camera's origin", move |desc| desc.set_camera(with(A, A, DVec3::Y, 60.0))),
        bad("camera.up[1]", "NaN is beyond", move |desc| desc.set_camera(with(A, B, nan, 60.0))),
        bad("camera.up", "is zero", move |desc| desc.set_camera(with(A, B, DVec3::ZERO, 60.0))),
        bad("camera.up", "is parallel", move |desc| desc.set_camera(with(A, B, B - A, 60.0))),
        bad("camera.fieldOfView", "180 degrees", move |desc| desc.set_camera(with(A, B, DVec3::Y, 180.0))),
        bad("camera.fieldOfView", "NaN degrees", move |desc| desc.set_camera(with(A, B, DVec3::Y, f64::NAN))),
        bad("camera.fieldOfView", "359 degrees", move |desc| desc.set_camera(bent(Panorama::Spherical, 359.0))),
        bad("camera.fieldOfView", "NaN degrees", move |desc| desc.set_camera(bent(Panorama::Cylindrical, f64::NAN))),
        bad("camera.fieldOfView", "-1 degrees", move |desc| desc.set_camera(bent(Panorama::Fisheye, -1.0))),
        bad("camera.width", "0 is not above 0", move |desc| desc.set_camera(parallel(0.0, FovAxis::Horizontal))),
        bad("camera.height", "NaN is beyond", move |desc| desc.set_camera(parallel(f64::NAN, FovAxis::Vertical))),
        bad("camera.lensRadius", "-1 is negative", move |desc| desc.set_camera(through(LensDesc::new(-1.0)))),
        bad("camera.lensRadius", "NaN is beyond", move |desc| desc.set_camera(through(LensDesc::new(f64::NAN)))),
        bad("camera.shift[0]", "NaN is out of range", move |desc| desc.set_camera(on([f64::NAN, 0.0], 1.0))),
        bad("camera.shift[1]", "-101 is out of range, expected a number in [-100, 100]", move |desc| {
            desc.set_camera(on([0.0, -101.0], 1.0))
        }),
        bad("camera.pixelAspect", "0 is out of range, expected a number in [0.01, 100]", move |desc| {
            desc.set_camera(on([0.0; 2], 0.0))
        }),
        bad("camera.pixelAspect", "NaN is out of range", move |desc| {
            desc.set_camera(stretched(Panorama::Cylindrical, f64::NAN))
        }),
        bad("camera.pixelAspect", "a spherical camera spreads all directions", move |desc| {
            desc.set_camera(stretched(Panorama::Spherical, 2.0))
        }),
        bad("camera.focusDistance", "-3 is not above 0", move |desc| {
            desc.set_camera(through(LensDesc { focus: FocusDesc::Distance(-3.0), ..LensDesc::new(0.1) }))
        }),
        bad("camera.focusAt", "expected a point in front", move |desc| {
            desc.set_camera(through(LensDesc { focus: FocusDesc::Point(2.0 * A - B), ..LensDesc::new(0.1) }))
        }),
        bad("camera.focusAt[0]", "NaN is beyond", move |desc| {
            desc.set_camera(through(LensDesc { focus: FocusDesc::Point(DVec3::NAN), ..LensDesc::new(0.1) }))
        }),
        bad("camera.blades", "no 2 blades", move |desc| {
            desc.set_camera(through(LensDesc { blades: 2, ..LensDesc::new(0.1) }))
        }),
        bad("camera.bladeRotation", "beyond", move |desc| {
            desc.set_camera(through(LensDesc { blade_rotation_deg: f64::INFINITY, ..LensDesc::new(0.1) }))
        }),
        bad("camera.squeeze", "NaN is out of range", move |desc| {
            desc.set_camera(through(LensDesc { squeeze: f64::NAN, ..LensDesc::new(0.1) }))
        }),
    ]
}

fn bad_materials() -> Vec<(&'static str, &'static str, Call)> {
    let grey = Rgb::splat(0.5);
    let (over, under) = (Rgb::new(0.5, 1.5, 0.5), Rgb::new(0.5, 0.5, -0.25));
    let lambert = move |albedo| BsdfDesc::Lambert { albedo };
    let glass = |ior, exterior_ior| BsdfDesc::Dielectric { ior, exterior_ior };
    let rough = move |sigma| BsdfDesc::OrenNayarQualitative { albedo: grey, sigma };
    let oren_nayar = move |roughness| BsdfDesc::OrenNayar { albedo: grey, roughness };
    let add = |path, why, bsdf, survival| bad(path, why, move |desc| desc.add_material("new", bsdf, survival));
    vec![
        bad("materials[2].name", "'white' is given twice", move |desc| {
            desc.add_material("white", BsdfDesc::Black, None)
        }),
        add("materials[2].color[1]", "a reflectance of 1.5 breaks", lambert(over), None),
        add("materials[2].color[2]", "a reflectance of -0.25 breaks", BsdfDesc::Mirror { reflectance: under }, None),
        add("materials[2].color[0]", "NaN", BsdfDesc::OrenNayarQualitative { albedo: Rgb::NAN, sigma: 0.1 }, None),
        add("materials[2].color[1]", "1.5", BsdfDesc::OrenNayar { albedo: over, roughness: 0.1 }, None),
        add("materials[2].sigmaDeg", "is out of range, expected a number in [0, 90]", rough(1.571), None),
        add("materials[2].sigmaDeg", "is out of range", rough(-0.1), None),
        add("materials[2].roughness", "1.5 is out of range", oren_nayar(1.5), None),
        add("materials[2].refractionIndex", "0 is not above 0", glass(0.0, 1.0), None),
        add("materials[2].exteriorIndex", "inf is beyond", glass(1.5, f32::INFINITY), None),
        add("materials[2].reflectionRate", "0 is not above 0", lambert(grey), Some(0.0)),
        add("materials[2].reflectionRate", "1.5 is out of range", oren_nayar(0.5), Some(1.5)),
        add("materials[2].reflectionRate", "only a diffuse material", glass(1.5, 1.0), Some(0.5)),
        bad("materials[0].color[1]", "1.5", move |desc| desc.set_material(0, lambert(over), None)),
        bad("materials[0].medium", "only a refractive material", move |desc| {
            desc.set_medium(0, Some(MediumDesc { absorption: grey, priority: 0 }))
        }),
        bad("materials[9]", "there is no material 9", |desc| desc.set_medium(9, None)),
        bad("materials[0].reflectionRate", "NaN", move |desc| desc.set_material(0, lambert(grey), Some(f32::NAN))),
        bad("materials[9]", "there is no material 9, expected an index below 2", move |desc| {
            desc.set_material(9, lambert(grey), None)
        }),
    ]
}

fn bad_lights() -> Vec<(&'static str, &'static str, Call)> {
    let dark = Rgb::new(1.0, -1.0, 1.0);
    let spot = |direction, outer_deg, inner_deg| {
        let distribution = LightDistribution::Spot(SpotDesc { direction, outer_deg, inner_deg });
        PointLightDesc { distribution, ..PointLightDesc::even(A, Rgb::ONE) }
    };
    vec![
        bad("lights[1].origin[0]", "inf", |desc| desc.add_point_light(DVec3::INFINITY, Rgb::ONE)),
        bad("lights[1].color[1]", "-1 is negative", move |desc| desc.add_point_light(A, dark)),
        bad("lights[0].origin[0]", "1e300 is beyond", |desc| {
            desc.set_point_light(0, DVec3::new(1e300, 0.0, 0.0), Rgb::ONE)
        }),
        bad("lights[0].color[0]", "NaN", |desc| desc.set_point_light(0, A, Rgb::NAN)),
        bad("lights[1]", "there is no point light 1", |desc| desc.set_point_light(1, A, Rgb::ONE)),
        bad("lights[1]", "there is no point light 1", move |desc| desc.set_light_desc(1, spot(A, 45.0, 0.0))),
        bad("lights[1].direction", "has no direction", move |desc| desc.add_light_desc(spot(DVec3::ZERO, 45.0, 0.0))),
        bad("lights[1].direction[0]", "inf", move |desc| desc.add_light_desc(spot(DVec3::INFINITY, 45.0, 0.0))),
        bad("lights[0].outerConeAngle", "181 degrees", move |desc| desc.set_light_desc(0, spot(A, 181.0, 0.0))),
        bad("lights[0].outerConeAngle", "NaN", move |desc| desc.set_light_desc(0, spot(A, f64::NAN, 0.0))),
        bad("lights[0].innerConeAngle", "46 degrees", move |desc| desc.set_light_desc(0, spot(A, 45.0, 46.0))),
    ]
}

fn bad_meshes() -> Vec<(&'static str, &'static str, Call)> {
    /// One that `change` breaks, where it is added and where it replaces another.
    fn both(
        list: &mut Vec<(&'static str, &'static str, Call)>,
        added: &'static str,
        set: &'static str,
        why: &'static str,
        change: fn(&mut MeshDesc),
    ) {
        let broken = move |mut mesh: MeshDesc| {
            change(&mut mesh);
            mesh
        };
        list.push(bad(added, why, move |desc| desc.add_mesh(broken(corner()))));
        list.push(bad(set, why, move |desc| desc.set_mesh(0, broken(corner()))));
    }
    let mut list = vec![
        bad("meshes[3].name", "the mesh name 'corner' is given twice", |desc| {
            desc.add_mesh(MeshDesc { name: "corner".into(), ..corner() })
        }),
        bad("meshes[3].triangles[0][2]", "there is no vertex 3, expected an index below 3", |desc| {
            let mut mesh = hosted();
            mesh.host.iter_mut().for_each(|host| host.triangles = vec![[0, 1, 3]].into());
            desc.add_mesh(mesh)
        }),
        bad("meshes[3].positions[1][0]", "NaN", |desc| {
            let mut mesh = hosted();
            mesh.host.iter_mut().for_each(|host| host.positions = vec![[0.0; 3], [f32::NAN; 3], [1.0; 3]].into());
            desc.add_mesh(mesh)
        }),
        bad("meshes[3].normals", "0 normals for 3 positions", |desc| {
            let mut mesh = hosted();
            mesh.host.iter_mut().for_each(|host| host.normals = Some(Buffer::default()));
            desc.add_mesh(mesh)
        }),
        bad("meshes[2].uvs[2][1]", "inf", |desc| {
            let mut mesh = hosted();
            let uvs = vec![[0.0; 2], [0.0; 2], [0.0, f32::INFINITY]];
            mesh.host.iter_mut().for_each(|host| host.uvs = Some(uvs.clone().into()));
            desc.set_mesh(2, mesh)
        }),
        bad("meshes[3]", "the mesh is given twice", |desc| desc.add_mesh(MeshDesc { host: hosted().host, ..corner() })),
        bad("surfaces[0]", "reaches to", |desc| {
            desc.set_transform(0, DAffine3::from_scale(DVec3::splat(100.0)))?;
            let before = format!("{desc:?}");
            let result =
                desc.set_mesh(0, MeshDesc { positions: vec![DVec3::ZERO, DVec3::X * 3e37, DVec3::Y], ..corner() });
            assert_eq!(format!("{desc:?}"), before);
            desc.set_transform(0, DAffine3::IDENTITY)?;
            result
        }),
        bad("meshes[1]", "mesh 1 was removed", |desc| desc.set_mesh(1, corner())),
        bad("meshes[7]", "there is no mesh 7, expected an index below 3", |desc| desc.set_mesh(7, corner())),
        bad("meshes[0]", "surfaces[0] uses the mesh", |desc| desc.remove_mesh(0)),
        bad("meshes[1]", "mesh 1 was removed", |desc| desc.remove_mesh(1)),
        bad("meshes[7]", "there is no mesh 7", |desc| desc.remove_mesh(7)),
        bad("meshes[3].name", "given twice", |desc| desc.add_mesh_file("corner", Path::new("x.obj"))),
        bad("meshes[3].file", "the file name is empty", |desc| desc.add_mesh_file("", Path::new(""))),
        bad("meshes[3].file", "zero byte", |desc| desc.add_mesh_file("", Path::new("a\0b"))),
        bad("meshes[3].file", "cannot open", |desc| desc.add_mesh_file("", Path::new("no/such/file.obj"))),
    ];
    both(&mut list, "meshes[3].triangles", "meshes[0].triangles", "the mesh is empty", |mesh| mesh.triangles.clear());
    both(&mut list, "meshes[3].triangles[0][1]", "meshes[0].triangles[0][1]", "no vertex 7", |mesh| {
        mesh.triangles[0][1] = 7;
    });
    both(&mut list, "meshes[3].positions[2][0]", "meshes[0].positions[2][0]", "1e39 is beyond", |mesh| {
        mesh.positions[2].x = 1e39;
    });
    both(&mut list, "meshes[3].normals", "meshes[0].normals", "2 normals for 3 positions", |mesh| {
        mesh.normals.pop();
    });
    both(&mut list, "meshes[3].normals[1][2]", "meshes[0].normals[1][2]", "NaN", |mesh| {
        mesh.normals[1][2] = f32::NAN;
    });
    both(&mut list, "meshes[3].uvs", "meshes[0].uvs", "4 uvs for 3 positions", |mesh| mesh.uvs.push([0.0; 2]));
    both(&mut list, "meshes[3].uvs[0][1]", "meshes[0].uvs[0][1]", "-inf is beyond", |mesh| {
        mesh.uvs[0][1] = f32::NEG_INFINITY;
    });
    list
}

fn bad_shapes() -> Vec<(&'static str, &'static str, Call)> {
    let add = |path, why, shape| bad(path, why, move |desc| desc.add_surface(shape, DAffine3::IDENTITY, lit(0)));
    let nan = DVec3::new(0.0, 0.0, f64::NAN);
    let quadric = |coefficients, clip| ShapeDesc::Quadric { coefficients, clip };
    let clip = Bounds { min: -DVec3::ONE, max: DVec3::ONE };
    let ball = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    let mut broken = ball;
    broken[4] = f64::INFINITY;
    let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let bent = [square[0], square[1], square[2], DVec3::new(0.0, 1.0, 0.5)];
    let crossed = [square[0], square[1], square[3], square[2]];
    let disk = |centre, normal, radius| ShapeDesc::Disk { centre, normal, radius };
    vec![
        add("surfaces[5].origin[2]", "NaN", ShapeDesc::Sphere { centre: nan, radius: 1.0 }),
        add("surfaces[5].radius", "0 is not above 0", ShapeDesc::Sphere { centre: A, radius: 0.0 }),
        add("surfaces[5].radius", "NaN", ShapeDesc::Sphere { centre: A, radius: f64::NAN }),
        add("surfaces[5]", "reaches to", ShapeDesc::Sphere { centre: DVec3::X * 1e38, radius: 3e38 }),
        add("surfaces[5].vertex-2[2]", "NaN", ShapeDesc::Triangle([A, nan, B])),
        add("surfaces[5].vertex-4[2]", "NaN", ShapeDesc::Quad([A, B, A, nan])),
        add("surfaces[5].vertex-4", "the quad is not flat", ShapeDesc::Quad(bent)),
        add("surfaces[5].vertex-3", "not convex", ShapeDesc::Quad(crossed)),
        add("surfaces[5]", "no area", ShapeDesc::Quad([A; 4])),
        add("surfaces[5].coefficients[4]", "inf", quadric(broken, clip)),
        add("surfaces[5].coefficients", "all coefficients but the last are 0", quadric([0.0; 10], clip)),
        add("surfaces[5].clip.max[2]", "NaN", quadric(ball, Bounds { min: -DVec3::ONE, max: nan })),
        add("surfaces[5].clip", "the box is empty", quadric(ball, Bounds { min: clip.max, max: clip.min })),
        add("surfaces[5].origin[2]", "NaN", disk(nan, DVec3::X, 1.0)),
        add("surfaces[5].normal", "expected a unit vector", disk(A, DVec3::X * 2.0, 1.0)),
        add("surfaces[5].normal", "has no direction", disk(A, DVec3::ZERO, 1.0)),
        add("surfaces[5].radius", "-1 is not above 0", disk(A, DVec3::X, -1.0)),
        add("surfaces[5].mesh", "there is no mesh 8", ShapeDesc::Mesh { mesh: 8, smooth: false }),
        add("surfaces[5].mesh", "mesh 1 was removed", ShapeDesc::Mesh { mesh: 1, smooth: false }),
    ]
}

fn bad_surfaces() -> Vec<(&'static str, &'static str, Call)> {
    let (shape, identity) = ShapeDesc::sphere(A, 1.0).unwrap();
    let (cone, _) = ShapeDesc::cone(A, B, 1.0, 1.0).unwrap();
    let (flat_disk, _) = ShapeDesc::disk(A, DVec3::X, 1.0).unwrap();
    let flat = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0)));
    let nan = DAffine3::from_translation(DVec3::NAN);
    let far = DAffine3::from_translation(DVec3::X * 1e39);
    let long = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    let light = SurfaceLook { emission: Some(Rgb::ONE), ..SurfaceLook::default() };
    let add = |path, why, shape, local, look| bad(path, why, move |desc| desc.add_surface(shape, local, look));
    let gone = "surface 2 was removed";
    vec![
        add("surfaces[5].material", "there is no material 2, expected an index below 2", shape, identity, lit(2)),
        add("surfaces[5]", "missing key `material`", shape, identity, SurfaceLook::default()),
        add(
            "surfaces[5].emission[0]",
            "-1 is negative",
            shape,
            identity,
            SurfaceLook { emission: Some(-Rgb::ONE), ..lit(0) },
        ),
        add("surfaces[5].emission[0]", "NaN", shape, identity, SurfaceLook { emission: Some(Rgb::NAN), ..lit(0) }),
        add("surfaces[5].emission", "only cylinders can emit", cone, identity, light),
        add("surfaces[5].emission", "stretches it", shape, identity, SurfaceLook { transform: long, ..light }),
        add(
            "surfaces[5].emits",
            "a sphere, which is closed",
            shape,
            identity,
            SurfaceLook { emits_both: true, ..light },
        ),
        add("surfaces[5].emits", "emits no light", flat_disk, identity, SurfaceLook { emits_both: true, ..lit(0) }),
        add("surfaces[5].emission", "stretches it", shape, long, light),
        add("surfaces[5]", "cannot be undone", shape, flat, lit(0)),
        add("surfaces[5]", "overflows", shape, nan, lit(0)),
        add("surfaces[5].transform", "cannot be undone", shape, identity, SurfaceLook { transform: flat, ..lit(0) }),
        add("surfaces[5].transform", "overflows", shape, identity, SurfaceLook { transform: nan, ..lit(0) }),
        add("surfaces[5]", "reaches to 1e39", shape, identity, SurfaceLook { transform: far, ..lit(0) }),
        bad("surfaces[0].transform", "cannot be undone", move |desc| desc.set_transform(0, flat)),
        bad("surfaces[0].transform", "overflows", move |desc| desc.set_transform(0, nan)),
        bad("surfaces[0]", "reaches to 1e39", move |desc| desc.set_transform(0, far)),
        bad("surfaces[1].emission", "stretches it", move |desc| desc.set_transform(1, long)),
        bad("surfaces[2]", gone, move |desc| desc.set_transform(2, identity)),
        bad("surfaces[5]", "there is no surface 5", move |desc| desc.set_transform(5, identity)),
        bad("surfaces[0].material", "there is no material 2", |desc| desc.set_surface_material(0, Some(2))),
        bad("surfaces[0]", "missing key `material`", |desc| desc.set_surface_material(0, None)),
        bad("surfaces[2]", gone, |desc| desc.set_surface_material(2, Some(0))),
        bad("surfaces[5]", "there is no surface 5", |desc| desc.set_surface_material(5, Some(0))),
        bad("surfaces[0].emission[0]", "inf", |desc| desc.set_emission(0, Some(Rgb::INFINITY))),
        bad("surfaces[3].emits", "emits no light", |desc| desc.set_emits_both(3, true)),
        bad("surfaces[9]", "there is no surface 9", |desc| desc.set_emits_both(9, false)),
        bad("surfaces[2]", gone, |desc| desc.set_surface_name(2, "gone")),
        bad("surfaces[9]", "there is no surface 9", |desc| desc.set_surface_name(9, "none")),
        bad("surfaces[3].emission", "only cylinders can emit", |desc| desc.set_emission(3, Some(Rgb::ONE))),
        bad("surfaces[2]", gone, |desc| desc.set_emission(2, None)),
        bad("surfaces[5]", "there is no surface 5", |desc| desc.set_emission(5, None)),
        bad("surfaces[2]", gone, |desc| desc.remove_surface(2)),
        bad("surfaces[5]", "there is no surface 5", |desc| desc.remove_surface(5)),
    ]
}

#[test]
fn every_bad_value_is_refused_with_its_place_and_changes_nothing() {
    let before = format!("{:?}", base());
    let mut wrong = Vec::new();
    let lists = [bad_cameras(), bad_materials(), bad_lights(), bad_meshes(), bad_shapes(), bad_surfaces()];
    for (path, why, call) in lists.into_iter().flatten() {
        let mut desc = base();
        match call(&mut desc) {
            Ok(()) => wrong.push(format!("{path}, {why}: accepted")),
            Err(error) if error.location().json_path != path || !error.message().contains(why) => {
                wrong.push(format!("expected {path}: {why}\n    said {error}"));
            }
            Err(_) => {}
        }
        if format!("{desc:?}") != before {
            wrong.push(format!("{path}, {why}: the description has changed"));
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn constructors_name_the_argument_that_is_bad() {
    let (nan, flat) = (DVec3::splat(f64::NAN), [DVec3::ZERO; 4]);
    let open = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0];
    let clip = Bounds { min: nan, max: DVec3::ONE };
    let cases = [
        ("origin[0]", ShapeDesc::sphere(nan, 1.0)),
        ("radius", ShapeDesc::sphere(A, -1.0)),
        ("vertex-3[0]", ShapeDesc::triangle([A, B, nan])),
        ("vertex-1[0]", ShapeDesc::quad([nan, A, B, A])),
        ("", ShapeDesc::quad(flat)),
        ("origin[0]", ShapeDesc::disk(nan, B, 1.0)),
        ("normal", ShapeDesc::disk(A, DVec3::ZERO, 1.0)),
        ("radius", ShapeDesc::disk(A, B, f64::INFINITY)),
        ("coefficients[0]", ShapeDesc::quadric([f64::NAN; 10], None)),
        ("coefficients", ShapeDesc::quadric([0.0; 10], None)),
        ("", ShapeDesc::quadric(open, None)),
        ("clip.min[0]", ShapeDesc::quadric(open, Some(clip))),
        ("base[0]", ShapeDesc::cylinder(nan, B, 1.0, 1.0)),
        ("axis", ShapeDesc::cylinder(A, DVec3::ZERO, 1.0, 1.0)),
        ("radius", ShapeDesc::cone(A, B, 0.0, 1.0)),
        ("height", ShapeDesc::cone(A, B, 1.0, 1e-60)),
        ("apex[0]", ShapeDesc::paraboloid(nan, B, 1.0, 1.0)),
        ("axis[0]", ShapeDesc::paraboloid(A, nan, 1.0, 1.0)),
        ("radii[1]", ShapeDesc::ellipsoid(A, DVec3::new(1.0, 0.0, 1.0))),
        ("origin[0]", ShapeDesc::ellipsoid(nan, DVec3::ONE)),
    ];
    for (i, (path, result)) in cases.into_iter().enumerate() {
        let error = result.expect_err(path);
        assert_eq!((error.kind(), error.location().json_path.as_str()), (ErrorKind::InvalidScene, path), "case {i}");
    }
}

#[test]
fn a_call_is_refused_in_the_words_of_the_format() {
    let one = |more: &str, surface: &str| parse(&file(more, surface)).expect_err(surface);
    let sphere = ShapeDesc::sphere(DVec3::ZERO, 1.0).unwrap();
    let cone = ShapeDesc::cone(DVec3::ZERO, DVec3::Y, 1.0, 2.0).unwrap();
    let round = r#""geometry": "sphere", "origin": [0, 0, 0], "radius": 1"#;
    let mut fresh = SceneDesc::default();
    fresh.add_material("white", BsdfDesc::Lambert { albedo: Rgb::ONE }, None).unwrap();
    let cases: [(Error, Error); 10] = [
        (
            one("", r#""geometry": "sphere", "origin": [0, 0, 0], "radius": -2.5"#),
            fresh.add_surface(ShapeDesc::Sphere { centre: DVec3::ZERO, radius: -2.5 }, sphere.1, lit(0)).unwrap_err(),
        ),
        (
            one(
                "",
                r#""geometry": "quad", "vertex-1": [0, 0, 0], "vertex-2": [1, 0, 0], "vertex-3": [1, 1, 0],
                       "vertex-4": [0, 1, 1]"#,
            ),
            fresh
                .add_surface(
                    ShapeDesc::Quad([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)]),
                    sphere.1,
                    lit(0),
                )
                .unwrap_err(),
        ),
        (
            one("", &format!(r#"{round}, "emission": [1, -0.5, 1]"#)),
            fresh
                .add_surface(sphere.0, sphere.1, SurfaceLook { emission: Some(Rgb::new(1.0, -0.5, 1.0)), ..lit(0) })
                .unwrap_err(),
        ),
        (
            one("", &format!(r#"{round}, "emission": [1, 1, 1], "transform": {{"scale": [1, 2, 1]}}"#)),
            fresh
                .add_surface(
                    sphere.0,
                    sphere.1,
                    SurfaceLook {
                        emission: Some(Rgb::ONE),
                        transform: DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0)),
                        ..lit(0)
                    },
                )
                .unwrap_err(),
        ),
        (
            one(
                "",
                r#""geometry": "cone", "base": [0, 0, 0], "axis": [0, 1, 0], "radius": 1, "height": 2, "emission": [1, 1, 1]"#,
            ),
            fresh.add_surface(cone.0, cone.1, SurfaceLook { emission: Some(Rgb::ONE), ..lit(0) }).unwrap_err(),
        ),
        (
            one(
                "",
                &format!(r#"{round}, "transform": {{"matrix": [1, 2, 0, 0, 2, 4, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}"#),
            ),
            fresh
                .add_surface(
                    sphere.0,
                    sphere.1,
                    SurfaceLook {
                        transform: DAffine3::from_mat3(DMat3::from_cols(
                            DVec3::new(1.0, 2.0, 0.0),
                            DVec3::new(2.0, 4.0, 0.0),
                            DVec3::Z,
                        )),
                        ..lit(0)
                    },
                )
                .unwrap_err(),
        ),
        (
            one("", &format!(r#"{round}, "transform": {{"translate": [3e38, 0, 0], "scale": 2e38}}"#)),
            fresh
                .add_surface(
                    sphere.0,
                    sphere.1,
                    SurfaceLook {
                        transform: DAffine3::from_scale_rotation_translation(
                            DVec3::splat(2e38),
                            Default::default(),
                            DVec3::X * 3e38,
                        ),
                        ..lit(0)
                    },
                )
                .unwrap_err(),
        ),
        (
            one(
                r#""meshes": [{"name": "m", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2],
                [0, 5, 1]]}],"#,
                round,
            ),
            fresh.add_mesh(MeshDesc { triangles: vec![[0, 1, 2], [0, 5, 1]], ..corner() }).unwrap_err(),
        ),
        (
            one(r#""lights": [{"type": "point", "origin": [0, 1, 0], "color": [1, 1, -2]}],"#, round),
            fresh.add_point_light(DVec3::Y, Rgb::new(1.0, 1.0, -2.0)).unwrap_err(),
        ),
        (
            one(r#""render": {"shadowRays": 2000},"#, round),
            RenderDesc { shadow_rays: 2000, ..RenderDesc::default() }.check().unwrap_err(),
        ),
    ];
    for (read, called) in &cases {
        assert_eq!(called.message(), read.message());
        assert_eq!(called.location().json_path, read.location().json_path, "{read}");
        assert_eq!(called.kind(), read.kind(), "{read}");
    }
}
