//! Surfaces and shared meshes of the native format.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::builder::{Builder, lit};
use super::json::{self, Scale, join};
use super::{MeshDesc, ShapeDesc, SurfaceDesc, obj, quadric, transform, validate};
use crate::math::{Bounds, DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// Declares one kind of surface: its own keys after the ones all kinds share, and how to get at those.
macro_rules! surface {
    ($(#[$doc:meta])* $name:ident, $tag:ident, { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name<'a> {
            #[serde(rename = "geometry")]
            _geometry: tags::$tag,
            /// Name of a material. May be left out of a surface with an emission, which then reflects nothing.
            material: Option<String>,
            /// Object to world. Default: none.
            #[serde(borrow)]
            #[cfg_attr(feature = "schema", schemars(with = "Option<transform::Transform>"))]
            transform: Option<&'a RawValue>,
            /// Emitted radiance on the normal's side, W/(m^2 sr) per channel. Default: none.
            emission: Option<[f64; 3]>,
            $($(#[$field_doc])* $field: $type,)*
        }

        impl $name<'_> {
            /// Adds the surface with this shape, which `local` puts into the frame that `transform` starts from.
            fn place(&self, path: &str, shape: ShapeDesc, local: DAffine3, builder: &mut Builder<'_>) -> Result<()> {
                place(path, self.material.as_deref(), self.emission, self.transform, shape, local, builder)
            }
        }
    };
}

/// The values of `geometry`, one type each so that the schema ties keys to kinds.
mod tags {
    macro_rules! tags {
        ($($tag:ident)*) => {$(
            #[derive(serde::Deserialize)]
            #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
            #[serde(rename_all = "kebab-case")]
            pub(super) enum $tag {
                $tag,
            }
        )*};
    }
    tags!(Sphere Triangle Quad Mesh Quadric Cylinder Cone Disk Ellipsoid Paraboloid);
}

const KINDS: [&str; 10] =
    ["sphere", "triangle", "quad", "mesh", "quadric", "cylinder", "cone", "disk", "ellipsoid", "paraboloid"];

surface!(
    /// A sphere, normals outwards.
    Sphere, Sphere, {
    /// Centre.
    origin: [f64; 3],
    /// Radius, > 0.
    radius: f64,
});

surface!(
    /// A triangle with normal (v2 - v1) x (v3 - v1).
    Triangle, Triangle, {
    /// First corner.
    #[serde(rename = "vertex-1")]
    vertex_1: [f64; 3],
    /// Second corner.
    #[serde(rename = "vertex-2")]
    vertex_2: [f64; 3],
    /// Third corner.
    #[serde(rename = "vertex-3")]
    vertex_3: [f64; 3],
});

surface!(
    /// A flat convex quadrilateral, corners in order around the edge, with the normal of its first three corners.
    Quad, Quad, {
    /// First corner.
    #[serde(rename = "vertex-1")]
    vertex_1: [f64; 3],
    /// Second corner.
    #[serde(rename = "vertex-2")]
    vertex_2: [f64; 3],
    /// Third corner.
    #[serde(rename = "vertex-3")]
    vertex_3: [f64; 3],
    /// Fourth corner.
    #[serde(rename = "vertex-4")]
    vertex_4: [f64; 3],
});

surface!(
    /// A triangle mesh: shared (`mesh`), from a file (`file`), or given here (`positions`, `triangles`).
    Mesh, Mesh, {
    /// Name of one of `meshes`.
    mesh: Option<String>,
    /// Wavefront OBJ file, relative to the scene file's folder.
    file: Option<String>,
    /// One position per vertex.
    positions: Option<Vec<[f64; 3]>>,
    /// Three vertex indices per triangle, from 0, counter-clockwise seen from outside.
    triangles: Option<Vec<[u32; 3]>>,
    /// One normal per vertex.
    normals: Option<Vec<[f64; 3]>>,
    /// One texture coordinate per vertex.
    uvs: Option<Vec<[f64; 2]>>,
    /// `flat` (default) or `smooth`.
    #[serde(default, deserialize_with = "json::name")]
    shading: Option<Shading>,
    /// Added after `scale` and `rotate`, before `transform`.
    origin: Option<[f64; 3]>,
    /// Uniform factor, applied first.
    scale: Option<f64>,
    /// Rotation about x, then y, then z, in radians (in `transform` it is degrees).
    rotate: Option<[f64; 3]>,
});

surface!(
    /// a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0, inside a box.
    Quadric, Quadric, {
    /// a to j. The normal is the gradient.
    coefficients: [f64; 10],
    /// Only what lies inside is there. May be left out of ellipsoids.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Clip>"))]
    clip: Option<&'a RawValue>,
});

surface!(
    /// A tube without caps, normals outwards.
    Cylinder, Cylinder, {
    /// Centre of one end.
    base: [f64; 3],
    /// Direction to the other end, any length.
    axis: [f64; 3],
    /// Radius, > 0.
    radius: f64,
    /// Length along the axis, > 0.
    height: f64,
});

surface!(
    /// A cone without its base disk, normals outwards.
    Cone, Cone, {
    /// Centre of the base.
    base: [f64; 3],
    /// Direction to the apex, any length.
    axis: [f64; 3],
    /// Radius of the base, > 0.
    radius: f64,
    /// From base to apex, > 0.
    height: f64,
});

surface!(
    /// A flat round disk.
    Disk, Disk, {
    /// Centre.
    origin: [f64; 3],
    /// Normal, any length.
    normal: [f64; 3],
    /// Radius, > 0.
    radius: f64,
});

surface!(
    /// An ellipsoid with its axes along x, y and z, normals outwards.
    Ellipsoid, Ellipsoid, {
    /// Centre.
    origin: [f64; 3],
    /// Half its size along x, y and z, each > 0.
    radii: [f64; 3],
});

surface!(
    /// A paraboloid of revolution, open at its wide end, normals outwards (away from the axis).
    Paraboloid, Paraboloid, {
    /// The apex.
    apex: [f64; 3],
    /// Direction from the apex into the bowl, any length.
    axis: [f64; 3],
    /// Radius at `height`, > 0.
    radius: f64,
    /// Where it ends, measured from the apex along the axis, > 0.
    height: f64,
});

/// Flat faces, or normals interpolated between vertices.
#[derive(Clone, Copy, Default, Deserialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Shading {
    /// One normal per triangle.
    #[default]
    Flat,
    /// Interpolated vertex normals, made from the faces if the mesh has none.
    Smooth,
}

/// A box, axis-aligned in the quadric's frame.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Clip {
    /// Smallest corner.
    min: [f64; 3],
    /// Largest corner.
    max: [f64; 3],
}

/// A mesh that several surfaces can use.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct SharedMesh {
    /// What surfaces call it.
    name: String,
    /// Wavefront OBJ file, relative to the scene file's folder.
    file: Option<String>,
    /// One position per vertex.
    positions: Option<Vec<[f64; 3]>>,
    /// Three vertex indices per triangle, from 0, counter-clockwise seen from outside.
    triangles: Option<Vec<[u32; 3]>>,
    /// One normal per vertex.
    normals: Option<Vec<[f64; 3]>>,
    /// One texture coordinate per vertex.
    uvs: Option<Vec<[f64; 2]>>,
}

/// Where the triangles of a mesh come from.
struct MeshSource {
    name: Option<String>,
    file: Option<String>,
    positions: Option<Vec<[f64; 3]>>,
    triangles: Option<Vec<[u32; 3]>>,
    normals: Option<Vec<[f64; 3]>>,
    uvs: Option<Vec<[f64; 2]>>,
}

/// Reads one of `surfaces`.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let positive = |key: &str, value: f64| validate::positive(&at(key), value);
    let vector = |key: &str, value: [f64; 3]| validate::vector(&at(key), value);
    let identity = DAffine3::IDENTITY;
    match json::tag(raw, path, "geometry", &KINDS)?.as_str() {
        "sphere" => {
            let it: Sphere = json::object(raw, path)?;
            let shape =
                ShapeDesc::Sphere { centre: vector("origin", it.origin)?, radius: positive("radius", it.radius)? };
            it.place(path, shape, identity, builder)
        }
        "triangle" => {
            let it: Triangle = json::object(raw, path)?;
            let shape = ShapeDesc::Triangle([
                vector("vertex-1", it.vertex_1)?,
                vector("vertex-2", it.vertex_2)?,
                vector("vertex-3", it.vertex_3)?,
            ]);
            it.place(path, shape, identity, builder)
        }
        "quad" => {
            let it: Quad = json::object(raw, path)?;
            let vertices = [
                vector("vertex-1", it.vertex_1)?,
                vector("vertex-2", it.vertex_2)?,
                vector("vertex-3", it.vertex_3)?,
                vector("vertex-4", it.vertex_4)?,
            ];
            validate::quad(path, vertices)?;
            it.place(path, ShapeDesc::Quad(vertices), identity, builder)
        }
        "mesh" => {
            let mut it: Mesh = json::object(raw, path)?;
            let origin = vector("origin", it.origin.unwrap_or_default())?;
            let radians = vector("rotate", it.rotate.unwrap_or_default())?;
            let scale = transform::factors(&at("scale"), it.scale.map(Scale::Uniform))?;
            let source = MeshSource {
                name: it.mesh.take(),
                file: it.file.take(),
                positions: it.positions.take(),
                triangles: it.triangles.take(),
                normals: it.normals.take(),
                uvs: it.uvs.take(),
            };
            let mesh = source.resolve(path, path, builder)?;
            let smooth = it.shading.unwrap_or_default() == Shading::Smooth;
            it.place(path, ShapeDesc::Mesh { mesh, smooth }, transform::place(scale, radians, origin), builder)
        }
        "quadric" => {
            let it: Quadric = json::object(raw, path)?;
            let shape = general_quadric(&it.coefficients, it.clip, path)?;
            it.place(path, shape, identity, builder)
        }
        "cylinder" => {
            let it: Cylinder = json::object(raw, path)?;
            let (radius, height) = (positive("radius", it.radius)?, positive("height", it.height)?);
            let axis = validate::direction(&at("axis"), it.axis)?;
            let frame = quadric::frame(vector("base", it.base)?, axis, radius, height);
            it.place(path, quadric::cylinder(), frame, builder)
        }
        "cone" => {
            let it: Cone = json::object(raw, path)?;
            let (radius, height) = (positive("radius", it.radius)?, positive("height", it.height)?);
            let axis = validate::direction(&at("axis"), it.axis)?;
            let frame = quadric::frame(vector("base", it.base)?, axis, radius, height);
            it.place(path, quadric::cone(), frame, builder)
        }
        "disk" => {
            let it: Disk = json::object(raw, path)?;
            let shape = ShapeDesc::Disk {
                centre: vector("origin", it.origin)?,
                normal: validate::direction(&at("normal"), it.normal)?,
                radius: positive("radius", it.radius)?,
            };
            it.place(path, shape, identity, builder)
        }
        "ellipsoid" => {
            let it: Ellipsoid = json::object(raw, path)?;
            for (i, radius) in it.radii.into_iter().enumerate() {
                positive(&format!("radii[{i}]"), radius)?;
            }
            let size = DMat3::from_diagonal(DVec3::from_array(it.radii));
            let frame = DAffine3::from_mat3_translation(size, vector("origin", it.origin)?);
            it.place(path, quadric::ball(), frame, builder)
        }
        _ => {
            let it: Paraboloid = json::object(raw, path)?;
            let (radius, height) = (positive("radius", it.radius)?, positive("height", it.height)?);
            let axis = validate::direction(&at("axis"), it.axis)?;
            let frame = quadric::frame(vector("apex", it.apex)?, axis, radius, height);
            it.place(path, quadric::paraboloid(), frame, builder)
        }
    }
}

/// Reads one of `meshes`.
pub(super) fn shared_mesh(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let mesh: SharedMesh = json::object(raw, path)?;
    let SharedMesh { name, file, positions, triangles, normals, uvs } = mesh;
    let index = MeshSource { name: None, file, positions, triangles, normals, uvs }.resolve(path, &name, builder)?;
    builder.name_mesh(&join(path, "name"), &name, index)
}

fn place(
    path: &str,
    material: Option<&str>,
    emission: Option<[f64; 3]>,
    outer: Option<&RawValue>,
    shape: ShapeDesc,
    local: DAffine3,
    builder: &mut Builder<'_>,
) -> Result<()> {
    let emission = match emission {
        Some(radiance) => Some(validate::emission(&join(path, "emission"), radiance, 1.0)?),
        None => None,
    };
    let material = match material {
        Some(name) => builder.material(&join(path, "material"), name)?,
        None if emission.is_some() => builder.black(path),
        None => return Err(Error::invalid(path, "missing key `material`")),
    };
    let at_transform = join(path, "transform");
    let transform = transform::read(outer, &at_transform)?;
    validate::invertible(if outer.is_some() { &at_transform } else { path }, &(transform * local))?;
    let emission = emission.and_then(lit);
    builder.add_surface(SurfaceDesc {
        path: path.to_owned(),
        shape,
        local,
        transform,
        material,
        emission,
        hidden: false,
    })
}

fn general_quadric(coefficients: &[f64; 10], clip: Option<&RawValue>, path: &str) -> Result<ShapeDesc> {
    let at = join(path, "coefficients");
    for (i, coefficient) in coefficients.iter().enumerate() {
        validate::number(&format!("{at}[{i}]"), *coefficient)?;
    }
    if coefficients[..9].iter().all(|coefficient| *coefficient == 0.0) {
        return Err(Error::invalid(at, "all coefficients but the last are 0, expected a surface"));
    }
    let clip = match clip {
        Some(raw) => {
            let at = join(path, "clip");
            let clip: Clip = json::object(raw, &at)?;
            let min = validate::vector(&join(&at, "min"), clip.min)?;
            let max = validate::vector(&join(&at, "max"), clip.max)?;
            if !min.cmple(max).all() {
                return Err(Error::invalid(at, format!("the box is empty: min {min} is not below max {max}")));
            }
            Bounds { min, max }
        }
        None => quadric::closed_bounds(coefficients).ok_or_else(|| {
            Error::invalid(path, "missing key `clip`: only an ellipsoid ends by itself, and this quadric is none")
        })?,
    };
    Ok(ShapeDesc::Quadric { coefficients: *coefficients, clip })
}

impl MeshSource {
    /// The index of the mesh; `name` is for one given in place.
    fn resolve(self, path: &str, name: &str, builder: &mut Builder<'_>) -> Result<usize> {
        let inline =
            self.positions.is_some() || self.triangles.is_some() || self.normals.is_some() || self.uvs.is_some();
        match (self.name, self.file) {
            (Some(shared), None) if !inline => builder.mesh_named(&join(path, "mesh"), &shared),
            (None, Some(file)) if !inline => builder.mesh_file(&join(path, "file"), &file),
            (None, None) if inline => {
                let missing = |key: &str| Error::invalid(path, format!("missing key `{key}` of a mesh given in place"));
                let positions = self.positions.ok_or_else(|| missing("positions"))?;
                let triangles = self.triangles.ok_or_else(|| missing("triangles"))?;
                let mesh = inline_mesh(
                    positions,
                    triangles,
                    self.normals.unwrap_or_default(),
                    &self.uvs.unwrap_or_default(),
                    path,
                )?;
                Ok(builder.add_mesh(MeshDesc { name: name.to_owned(), path: path.to_owned(), ..mesh }))
            }
            (None, None) => Err(Error::invalid(
                path,
                "the mesh has no triangles, expected `file`, `positions` with `triangles`, or (of a surface) `mesh`",
            )),
            _ => Err(Error::invalid(path, "the mesh is given twice, expected one of `mesh`, `file` and `positions`")),
        }
    }
}

fn inline_mesh(
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<[f64; 3]>,
    uvs: &[[f64; 2]],
    path: &str,
) -> Result<MeshDesc> {
    let at = |key: &str| join(path, key);
    if triangles.is_empty() {
        return Err(Error::invalid(at("triangles"), "the mesh is empty, expected at least one triangle"));
    }
    let count = positions.len();
    for (i, triangle) in triangles.iter().enumerate() {
        if let Some(k) = triangle.iter().position(|index| *index as usize >= count) {
            let message = format!("there is no vertex {}, expected an index below {count}", triangle[k]);
            return Err(Error::invalid(at(&format!("triangles[{i}][{k}]")), message));
        }
    }
    for (key, given) in [("normals", normals.len()), ("uvs", uvs.len())] {
        if given != 0 && given != count {
            let message = format!("{given} {key} for {count} positions, expected one each");
            return Err(Error::invalid(at(key), message));
        }
    }
    let (at_positions, at_normals, at_uvs) = (at("positions"), at("normals"), at("uvs"));
    let in_range = |at: &str, i: usize, values: &[f64]| {
        values.iter().enumerate().try_for_each(|(k, value)| {
            if validate::fits(*value) {
                return Ok(());
            }
            validate::number(&format!("{at}[{i}][{k}]"), *value).map(|_| ())
        })
    };
    for (i, p) in positions.iter().enumerate() {
        in_range(&at_positions, i, p)?;
    }
    for (i, n) in normals.iter().enumerate() {
        in_range(&at_normals, i, n)?;
    }
    for (i, uv) in uvs.iter().enumerate() {
        in_range(&at_uvs, i, uv)?;
    }
    Ok(MeshDesc {
        positions: positions.into_iter().map(DVec3::from_array).collect(),
        normals: normals.into_iter().filter_map(obj::finite).collect(),
        uvs: uvs.iter().copied().filter_map(obj::finite).collect(),
        triangles,
        ..MeshDesc::default()
    })
}
