//! Writes surfaces and shared meshes of the native format.

use serde_json::value::RawValue;

use super::{
    Clip, Cone, Cylinder, Disk, Ellipsoid, Emits, Mesh, Paraboloid, Quad, Quadric, Shading, SharedMesh, Sphere,
    Triangle, tags,
};
use crate::desc::area_web_keys::AreaWeb;
use crate::desc::json::join;
use crate::desc::numbers::{self, shortest, unless};
use crate::desc::save::{Names, raw};
use crate::desc::transform::{self, same_bits, unless_zero};
use crate::desc::{MeshStep, MotionDesc, ShapeDesc, SurfaceDesc, motion_keys, spectrum_keys};
use crate::math::{DAffine3, DVec3};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The keys that all kinds of surfaces have.
#[derive(Default)]
struct Look {
    name: Option<String>,
    material: Option<String>,
    transform: Option<Box<RawValue>>,
    emission: Option<[f64; 3]>,
    spectrum: Option<Box<RawValue>>,
    web: Option<AreaWeb>,
    emits: Option<Emits>,
    motion: Option<Vec<motion_keys::Key>>,
}

/// The text of one kind of surface.
macro_rules! text {
    ($name:ident, $look:expr, { $($field:ident: $value:expr,)* }) => {
        raw(&$name {
            _geometry: tags::$name::$name,
            name: $look.name,
            material: $look.material,
            transform: $look.transform.as_deref(),
            emission: $look.emission,
            luminance: None,
            temperature: None,
            spectrum: $look.spectrum.as_deref(),
            web: $look.web,
            emits: $look.emits,
            motion: $look.motion,
            $($field: $value,)*
        })
    };
}

/// Writes a surface whose material and mesh have these names. Its numbers have been checked. `emits_both`: it emits on both sides. `web`: the
/// name of the file of the web by which it shines, if it does.
///
/// Where the keys of its kind cannot give the frame of its shape, that frame goes into the `transform`.
pub(in crate::desc) fn write(
    surface: &SurfaceDesc,
    emits_both: bool,
    web: Option<&str>,
    motion: Option<&MotionDesc>,
    names: &Names,
) -> Result<Box<RawValue>> {
    let SurfaceDesc { path, local, .. } = surface;
    let look = |keeps_frame: bool| {
        let placed = if keeps_frame { surface.transform } else { surface.to_world() };
        let web = surface.web.as_ref().zip(surface.emission).zip(web).map(|((web, factor), file)| {
            // Its direction is one of the frame from which the written transform starts.
            let c0 = if keeps_frame { web.c0 } else { local.matrix3.inverse() * web.c0 };
            AreaWeb::write(web, c0, factor, file)
        });
        Ok(Look {
            name: Some(surface.name.clone()).filter(|name| !name.is_empty()),
            material: surface.material.map(|material| names.materials[material].clone()),
            transform: transform::write(&placed)?,
            // A surface may be without a material where it says what it emits, and be it nothing.
            emission: surface
                .emission
                .or_else(|| surface.material.is_none().then_some(Rgb::ZERO))
                .filter(|_| web.is_none())
                .map(numbers::color),
            spectrum: surface
                .spectrum
                .as_ref()
                .filter(|_| surface.emission.is_some())
                .map(spectrum_keys::write)
                .transpose()?,
            web,
            emits: emits_both.then_some(Emits::Both),
            motion: motion.map(motion_keys::write_motion),
        })
    };
    let is_plain = same_bits(local, &DAffine3::IDENTITY);
    let array = DVec3::to_array;
    match surface.shape {
        ShapeDesc::Sphere { centre, radius } => {
            text!(Sphere, look(is_plain)?, { origin: array(&centre), radius: radius, })
        }
        ShapeDesc::Triangle(corners) => {
            let [vertex_1, vertex_2, vertex_3] = corners.map(|corner| corner.to_array());
            text!(Triangle, look(is_plain)?, { vertex_1: vertex_1, vertex_2: vertex_2, vertex_3: vertex_3, })
        }
        ShapeDesc::Quad(corners) => {
            let [vertex_1, vertex_2, vertex_3, vertex_4] = corners.map(|corner| corner.to_array());
            text!(Quad, look(is_plain)?, {
                vertex_1: vertex_1,
                vertex_2: vertex_2,
                vertex_3: vertex_3,
                vertex_4: vertex_4,
            })
        }
        ShapeDesc::Disk { centre, normal, radius } => {
            if ShapeDesc::disk(centre, normal, radius)?.0 != surface.shape {
                let length = normal.length();
                let message = format!("the normal has the length {length}, expected a unit vector in double precision");
                return Err(Error::invalid(join(path, "normal"), message));
            }
            text!(Disk, look(is_plain)?, { origin: array(&centre), normal: array(&normal), radius: radius, })
        }
        ShapeDesc::Mesh { mesh, smooth } => {
            let scale = local.matrix3.x_axis.x;
            let keeps_frame = keeps_frame(surface);
            text!(Mesh, look(keeps_frame)?, {
                mesh: Some(names.meshes[mesh].clone()),
                file: None,
                positions: None,
                triangles: None,
                normals: None,
                uvs: None,
                further_uvs: None,
                colors: None,
                tangents: None,
                steps: None,
                materials: None,
                shading: smooth.then_some(Shading::Smooth),
                origin: unless_zero(local.translation).filter(|_| keeps_frame),
                scale: unless(scale, 1.0).filter(|_| keeps_frame),
                rotate: None,
            })
        }
        ShapeDesc::Quadric { coefficients, clip } => {
            if let Some(named) = named(surface, || look(true)) {
                return named;
            }
            let clip = raw(&Clip { min: clip.min.to_array(), max: clip.max.to_array() })?;
            text!(Quadric, look(is_plain)?, { coefficients: coefficients, clip: Some(&*clip), })
        }
    }
}

/// Whether the keys of its kind can give the frame of a surface's shape. Otherwise, that frame goes into its `transform`.
pub(in crate::desc) fn keeps_frame(surface: &SurfaceDesc) -> bool {
    let local = &surface.local;
    match surface.shape {
        // A frame that scales evenly and moves has keys; one that turns has none that are written.
        ShapeDesc::Mesh { .. } => {
            let scale = DVec3::splat(local.matrix3.x_axis.x);
            same_bits(local, &transform::place(scale, DVec3::ZERO, local.translation))
        }
        ShapeDesc::Quadric { .. } if named(surface, || Ok(Look::default())).is_some() => true,
        _ => same_bits(local, &DAffine3::IDENTITY),
    }
}

/// Writes a quadric that has a name by its name, where the keys of the name give the same frame.
fn named(surface: &SurfaceDesc, look: impl Fn() -> Result<Look>) -> Option<Result<Box<RawValue>>> {
    let SurfaceDesc { shape, local, .. } = surface;
    let is_same =
        |made: Result<(ShapeDesc, DAffine3)>| made.is_ok_and(|(own, frame)| own == *shape && same_bits(&frame, local));
    let columns = local.matrix3;
    let origin = local.translation;
    let radii = DVec3::new(columns.x_axis.x, columns.y_axis.y, columns.z_axis.z);
    if is_same(ShapeDesc::ellipsoid(origin, radii)) {
        let text = |look: Look| text!(Ellipsoid, look, { origin: origin.to_array(), radii: radii.to_array(), });
        return Some(look().and_then(text));
    }
    // Lengths of columns are off by rounding, and lengths of people have few digits.
    let lengths = |column: DVec3| {
        let length = column.length();
        [length, shortest(length, |short| (short / length - 1.0).abs() < 1e-14).unwrap_or(length)]
    };
    for radius in lengths(columns.x_axis) {
        for height in lengths(columns.z_axis) {
            let axis = columns.z_axis / height;
            let (start, direction) = (origin.to_array(), axis.to_array());
            if is_same(ShapeDesc::cylinder(origin, axis, radius, height)) {
                let text = |look: Look| text!(Cylinder, look, { base: start, axis: direction, radius: radius, height: height, });
                return Some(look().and_then(text));
            }
            if is_same(ShapeDesc::cone(origin, axis, radius, height)) {
                let text =
                    |look: Look| text!(Cone, look, { base: start, axis: direction, radius: radius, height: height, });
                return Some(look().and_then(text));
            }
            if is_same(ShapeDesc::paraboloid(origin, axis, radius, height)) {
                let text = |look: Look| text!(Paraboloid, look, { apex: start, axis: direction, radius: radius, height: height, });
                return Some(look().and_then(text));
            }
        }
    }
    None
}

/// Writes a mesh that is in a PLY file, of which degenerate triangles may be kept.
pub(in crate::desc) fn write_mesh(
    name: &str,
    file: &str,
    keep_degenerate: bool,
    steps: Option<&[MeshStep]>,
) -> Result<Box<RawValue>> {
    raw(&SharedMesh {
        name: name.to_owned(),
        file: Some(file.to_owned()),
        keep_degenerate: keep_degenerate.then_some(true),
        positions: None,
        triangles: None,
        normals: None,
        uvs: None,
        further_uvs: None,
        colors: None,
        tangents: None,
        steps: steps.map(motion_keys::write_steps),
    })
}
