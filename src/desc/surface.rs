//! Reads surfaces and shared meshes of the native format, and writes them.

mod write;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::area_web_keys::AreaWeb;
use super::builder::Builder;
use super::json::{self, Scale, join};
use super::{
    MeshDesc, ShapeDesc, SurfaceLook, group_keys, motion_keys, photometric, spectrum_keys, transform, validate,
};
use crate::math::{Bounds, DAffine3, DVec3};
use crate::{Error, Result};

pub(super) use write::{keeps_frame, write, write_mesh};

/// Declares one kind of surface: its own keys after the ones all kinds share, and how to get at those.
macro_rules! surface {
    ($(#[$doc:meta])* $name:ident, $tag:ident, { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Deserialize, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name<'a> {
            #[serde(rename = "geometry")]
            _geometry: tags::$tag,
            /// What it is called in mattes, not empty; all surfaces of one name are one object. Default: none.
            #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
            name: Option<String>,
            /// Name of a material. May be left out of a surface with an emission, which then reflects nothing.
            material: Option<String>,
            /// Object to world. Default: none.
            #[serde(borrow)]
            #[cfg_attr(feature = "schema", schemars(with = "Option<transform::Transform>"))]
            transform: Option<&'a RawValue>,
            /// Emitted radiance on the normal's side, W/(m^2 sr) per channel. Default: none.
            emission: Option<[f64; 3]>,
            /// Luminance on the normal's side, cd/m^2, above 0, in place of `emission`. Default: none.
            luminance: Option<f64>,
            /// With `luminance`: colour temperature in kelvin, in [1000, 15000]: that of a Planckian radiator. Default: white.
            temperature: Option<f64>,
            /// The spectrum of the light, in place of `emission`: radiance, W/(m^2 sr nm); with `luminance`, with `web`, or with an `emission`,
            /// whose luminance counts then, its shape alone. Default: none.
            #[serde(borrow)]
            #[cfg_attr(feature = "schema", schemars(with = "Option<super::spectrum_keys::Spectrum>"))]
            spectrum: Option<&'a RawValue>,
            /// Of a flat surface, in place of `emission`: a measured lamp, as which the surface shines. Default: none.
            web: Option<AreaWeb>,
            /// Of a surface that emits light: `front`, on the normal's side (default), or `both` sides. Not `both` of spheres.
            #[serde(default, deserialize_with = "json::name")]
            emits: Option<Emits>,
            /// Keyframes, by which the surface is moved after `transform`. Default: it rests.
            motion: Option<Vec<motion_keys::Key>>,
            $($(#[$field_doc])* $field: $type,)*
        }

        impl $name<'_> {
            /// Adds the surface with this shape, in the frame that `transform` starts from.
            fn place(
                &mut self,
                path: &str,
                shape: Result<(ShapeDesc, DAffine3)>,
                builder: &mut Builder<'_>,
            ) -> Result<()> {
                let name = checked_name(path, self.name.take())?;
                let light = Light {
                    emission: self.emission,
                    luminance: self.luminance,
                    temperature: self.temperature,
                    emits: self.emits,
                    web: self.web.take(),
                    spectrum: self.spectrum,
                };
                let motion = self.motion.take();
                let surface = place(path, self.material.as_deref(), light, self.transform, motion, shape, builder)?;
                builder.scene.set_surface_name(surface, &name)
            }
        }
    };
}

/// The values of `geometry`, one type each so that the schema ties keys to kinds.
mod tags {
    macro_rules! tags {
        ($($tag:ident)*) => {$(
            #[derive(serde::Deserialize, serde::Serialize)]
            #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
            #[serde(rename_all = "kebab-case")]
            pub(super) enum $tag {
                $tag,
            }
        )*};
    }
    tags!(Sphere Triangle Quad Mesh Quadric Cylinder Cone Disk Ellipsoid Paraboloid);
}

const KINDS: [&str; 11] =
    ["sphere", "triangle", "quad", "mesh", "quadric", "cylinder", "cone", "disk", "ellipsoid", "paraboloid", "group"];

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
    /// Wavefront OBJ, PLY or STL file, relative to the scene file's folder.
    file: Option<String>,
    /// One position per vertex.
    positions: Option<Vec<[f64; 3]>>,
    /// Three vertex indices per triangle, from 0, counter-clockwise seen from outside.
    triangles: Option<Vec<[u32; 3]>>,
    /// One normal per vertex.
    normals: Option<Vec<[f64; 3]>>,
    /// One texture coordinate per vertex.
    uvs: Option<Vec<[f64; 2]>>,
    /// Further sets of texture coordinates: set 1, 2, ... to 7, each of one texture coordinate per vertex, or empty.
    #[serde(rename = "furtherUvs")]
    further_uvs: Option<Vec<Vec<[f64; 2]>>>,
    /// One colour per vertex, of three or four numbers: red, green and blue in linear light, >= 0, and opacity in [0, 1], default 1.
    colors: Option<Vec<VertexColor>>,
    /// One tangent per vertex for normal maps on smooth surfaces, instead of those of MikkTSpace.
    tangents: Option<Vec<[f64; 3]>>,
    /// The vertices at some moments, between which they move along straight lines. Default: the mesh does not deform.
    steps: Option<Vec<motion_keys::Step>>,
    /// `from-file`: the materials that `file` names in its material libraries, instead of `material`. Default: none.
    #[serde(default, deserialize_with = "json::name")]
    materials: Option<MaterialsOf>,
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

/// Where the materials of a mesh are described.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum MaterialsOf {
    /// In the material libraries (.mtl) of its Wavefront OBJ file.
    FromFile,
}

/// Flat faces, or normals interpolated between vertices.
#[derive(Clone, Copy, Default, Deserialize, Serialize, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Shading {
    /// One normal per triangle.
    #[default]
    Flat,
    /// Interpolated vertex normals, made from the faces if the mesh has none.
    Smooth,
}

/// The sides on which a surface emits.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
enum Emits {
    /// That of the normal.
    Front,
    /// Both, with the same radiance.
    Both,
}

/// The keys of the light that a surface emits.
struct Light<'a> {
    emission: Option<[f64; 3]>,
    luminance: Option<f64>,
    temperature: Option<f64>,
    emits: Option<Emits>,
    web: Option<AreaWeb>,
    spectrum: Option<&'a RawValue>,
}

/// A box, axis-aligned in the quadric's frame.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Clip {
    /// Smallest corner.
    min: [f64; 3],
    /// Largest corner.
    max: [f64; 3],
}

/// A mesh that several surfaces can use.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct SharedMesh {
    /// What surfaces call it.
    name: String,
    /// Wavefront OBJ, PLY or STL file, relative to the scene file's folder.
    file: Option<String>,
    /// Of a PLY file: whether triangles that name a vertex twice are kept. They are never seen, but have numbers. Default false.
    #[serde(rename = "keepDegenerate")]
    keep_degenerate: Option<bool>,
    /// One position per vertex.
    positions: Option<Vec<[f64; 3]>>,
    /// Three vertex indices per triangle, from 0, counter-clockwise seen from outside.
    triangles: Option<Vec<[u32; 3]>>,
    /// One normal per vertex.
    normals: Option<Vec<[f64; 3]>>,
    /// One texture coordinate per vertex.
    uvs: Option<Vec<[f64; 2]>>,
    /// Further sets of texture coordinates: set 1, 2, ... to 7, each of one texture coordinate per vertex, or empty.
    #[serde(rename = "furtherUvs")]
    further_uvs: Option<Vec<Vec<[f64; 2]>>>,
    /// One colour per vertex, of three or four numbers: red, green and blue in linear light, >= 0, and opacity in [0, 1], default 1.
    colors: Option<Vec<VertexColor>>,
    /// One tangent per vertex for normal maps on smooth surfaces, instead of those of MikkTSpace.
    tangents: Option<Vec<[f64; 3]>>,
    /// The vertices at some moments, between which they move along straight lines. Default: the mesh does not deform.
    steps: Option<Vec<motion_keys::Step>>,
}

/// Where the triangles of a mesh come from.
struct MeshSource {
    name: Option<String>,
    file: Option<String>,
    positions: Option<Vec<[f64; 3]>>,
    triangles: Option<Vec<[u32; 3]>>,
    normals: Option<Vec<[f64; 3]>>,
    uvs: Option<Vec<[f64; 2]>>,
    further_uvs: Option<Vec<Vec<[f64; 2]>>>,
    colors: Option<Vec<VertexColor>>,
    tangents: Option<Vec<[f64; 3]>>,
}

/// A colour of a vertex: red, green and blue, and opacity where it is not 1.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged, expecting = "not a colour of a vertex, expected three or four numbers")]
pub(super) enum VertexColor {
    /// Red, green and blue.
    Rgb([f64; 3]),
    /// Red, green, blue and opacity.
    Rgba([f64; 4]),
}

impl VertexColor {
    fn with_opacity(self) -> [f64; 4] {
        match self {
            Self::Rgb([r, g, b]) => [r, g, b, 1.0],
            Self::Rgba(color) => color,
        }
    }
}

/// Reads one of `surfaces`.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let at = |key: &str| join(path, key);
    let vector = |key: &str, value: [f64; 3]| validate::vector(&at(key), value);
    let point = DVec3::from_array;
    match json::tag(raw, path, "geometry", &KINDS)?.as_str() {
        "sphere" => {
            let mut it: Sphere = json::object(raw, path)?;
            it.place(path, ShapeDesc::sphere(point(it.origin), it.radius), builder)
        }
        "triangle" => {
            let mut it: Triangle = json::object(raw, path)?;
            it.place(path, ShapeDesc::triangle([it.vertex_1, it.vertex_2, it.vertex_3].map(point)), builder)
        }
        "quad" => {
            let mut it: Quad = json::object(raw, path)?;
            it.place(path, ShapeDesc::quad([it.vertex_1, it.vertex_2, it.vertex_3, it.vertex_4].map(point)), builder)
        }
        "mesh" => {
            let mut it: Mesh = json::object(raw, path)?;
            let origin = vector("origin", it.origin.unwrap_or_default())?;
            let radians = vector("rotate", it.rotate.unwrap_or_default())?;
            let scale = transform::factors(&at("scale"), it.scale.map(Scale::Uniform))?;
            let smooth = it.shading.unwrap_or_default() == Shading::Smooth;
            let local = transform::place(scale, radians, origin);
            if it.materials.is_some() {
                return it.place_parts(path, smooth, local, builder);
            }
            let source = MeshSource {
                name: it.mesh.take(),
                file: it.file.take(),
                positions: it.positions.take(),
                triangles: it.triangles.take(),
                normals: it.normals.take(),
                uvs: it.uvs.take(),
                further_uvs: it.further_uvs.take(),
                colors: it.colors.take(),
                tangents: it.tangents.take(),
            };
            let is_shared = source.name.is_some() || source.file.is_some();
            let mesh = source.resolve(path, path, builder)?;
            if let Some(steps) = it.steps.take() {
                if is_shared {
                    let message = "the mesh is described elsewhere, expected one of `meshes` with these steps";
                    return Err(Error::invalid(at("steps"), message));
                }
                builder.scene.set_mesh_steps(mesh, motion_keys::steps(steps, &at("steps"))?)?;
            }
            it.place(path, Ok((ShapeDesc::Mesh { mesh, smooth }, local)), builder)
        }
        "quadric" => {
            let mut it: Quadric = json::object(raw, path)?;
            let clip = match it.clip {
                Some(raw) => {
                    let Clip { min, max } = json::object(raw, &at("clip"))?;
                    Some(Bounds { min: point(min), max: point(max) })
                }
                None => None,
            };
            it.place(path, ShapeDesc::quadric(it.coefficients, clip), builder)
        }
        "cylinder" => {
            let mut it: Cylinder = json::object(raw, path)?;
            it.place(path, ShapeDesc::cylinder(point(it.base), point(it.axis), it.radius, it.height), builder)
        }
        "cone" => {
            let mut it: Cone = json::object(raw, path)?;
            it.place(path, ShapeDesc::cone(point(it.base), point(it.axis), it.radius, it.height), builder)
        }
        "disk" => {
            let mut it: Disk = json::object(raw, path)?;
            it.place(path, ShapeDesc::disk(point(it.origin), point(it.normal), it.radius), builder)
        }
        "ellipsoid" => {
            let mut it: Ellipsoid = json::object(raw, path)?;
            it.place(path, ShapeDesc::ellipsoid(point(it.origin), point(it.radii)), builder)
        }
        "group" => group_keys::read_placement(raw, path, builder),
        _ => {
            let mut it: Paraboloid = json::object(raw, path)?;
            it.place(path, ShapeDesc::paraboloid(point(it.apex), point(it.axis), it.radius, it.height), builder)
        }
    }
}

impl Mesh<'_> {
    /// Adds a surface for each material that the file of the mesh names.
    fn place_parts(&mut self, path: &str, smooth: bool, local: DAffine3, builder: &mut Builder<'_>) -> Result<()> {
        let at = |key: &str| join(path, key);
        for (key, given) in [
            ("material", self.material.is_some()),
            ("emission", self.emission.is_some()),
            ("luminance", self.luminance.is_some()),
            ("temperature", self.temperature.is_some()),
            ("emits", self.emits.is_some()),
            ("web", self.web.is_some()),
            ("spectrum", self.spectrum.is_some()),
            ("mesh", self.mesh.is_some()),
            ("positions", self.positions.is_some()),
            ("triangles", self.triangles.is_some()),
            ("normals", self.normals.is_some()),
            ("uvs", self.uvs.is_some()),
            ("furtherUvs", self.further_uvs.is_some()),
            ("colors", self.colors.is_some()),
            ("tangents", self.tangents.is_some()),
            ("steps", self.steps.is_some()),
        ] {
            if given {
                let message = "the materials are those of the file (`materials`), expected a surface without this key";
                return Err(Error::invalid(at(key), message));
            }
        }
        let Some(file) = &self.file else {
            return Err(Error::invalid(path, "missing key `file`, whose materials are asked for"));
        };
        let transform = transform::read(self.transform, &at("transform"))?;
        let keys = self.motion.take();
        let motion = keys.map(|keys| motion_keys::motion(keys, &at("motion"))).transpose()?;
        let name = checked_name(path, self.name.take())?;
        for [material, mesh] in builder.divided_file(&at("file"), file)? {
            let look = SurfaceLook { material: Some(material), transform, ..SurfaceLook::default() };
            let surface = builder.scene.put_surface(path, ShapeDesc::Mesh { mesh, smooth }, local, look)?;
            builder.scene.set_surface_name(surface, &name)?;
            builder.scene.set_surface_motion(surface, motion.clone())?;
        }
        Ok(())
    }
}

/// Reads one of `meshes`.
pub(super) fn shared_mesh(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let mesh: SharedMesh = json::object(raw, path)?;
    let SharedMesh {
        name,
        file,
        keep_degenerate,
        positions,
        triangles,
        normals,
        uvs,
        further_uvs,
        colors,
        tangents,
        steps,
    } = mesh;
    let before = builder.scene.meshes.len();
    let is_file = file.is_some();
    let mut index = match (keep_degenerate, &file, positions.is_some() || triangles.is_some()) {
        (Some(true), Some(file), false) => builder.mesh_file(&join(path, "file"), file, true)?,
        (Some(true), ..) => {
            let message = "only a mesh in a file has this key, a mesh given in place keeps all triangles";
            return Err(Error::invalid(join(path, "keepDegenerate"), message));
        }
        _ => MeshSource { name: None, file, positions, triangles, normals, uvs, further_uvs, colors, tangents }
            .resolve(path, &name, builder)?,
    };
    builder.scene.check_mesh_name(path, &name)?;
    if let Some(steps) = steps {
        if is_file {
            index = builder.own_mesh(index, before);
        }
        builder.scene.set_mesh_steps(index, motion_keys::steps(steps, &join(path, "steps"))?)?;
    }
    builder.scene.index.meshes.insert(name, index);
    Ok(())
}

fn place(
    path: &str,
    material: Option<&str>,
    light: Light<'_>,
    outer: Option<&RawValue>,
    motion: Option<Vec<motion_keys::Key>>,
    shape: Result<(ShapeDesc, DAffine3)>,
    builder: &mut Builder<'_>,
) -> Result<usize> {
    let (shape, local) = shape.map_err(json::below(path))?;
    let spectrum = spectrum_keys::read_some(light.spectrum, path, builder)?;
    let own = spectrum.as_ref().filter(|_| light.web.is_none());
    let mut emission = photometric::emission(path, light.emission, light.luminance, light.temperature, own)?;
    let web = match &light.web {
        None => None,
        Some(keys) => {
            if emission.is_some() {
                let key = if light.luminance.is_some() { "luminance" } else { "emission" };
                let message = "`web` says the light already, expected one of both";
                return Err(Error::invalid(join(path, key), message));
            }
            let (web, factor) = keys.resolve(&join(path, "web"), builder)?;
            emission = Some(factor);
            Some(web)
        }
    };
    let material = match material {
        Some(name) => Some(builder.material(&join(path, "material"), name)?),
        None => None,
    };
    let transform = transform::read(outer, &join(path, "transform"))?;
    let emits_both = matches!(light.emits, Some(Emits::Both));
    let look = SurfaceLook { material, emission, emits_both, transform };
    let surface = builder.scene.put_surface(path, shape, local, look)?;
    if web.is_some() {
        builder.scene.set_surface_web(surface, web)?;
    }
    builder.scene.set_surface_spectrum(surface, spectrum)?;
    if let Some(keys) = motion {
        let motion = motion_keys::motion(keys, &join(path, "motion"))?;
        builder.scene.set_surface_motion(surface, Some(motion))?;
    }
    Ok(surface)
}

/// The name of a surface; empty where it has none.
pub(super) fn checked_name(path: &str, name: Option<String>) -> Result<String> {
    if name.as_ref().is_some_and(String::is_empty) {
        return Err(Error::invalid(join(path, "name"), "the name is empty, expected one letter at least, or no name"));
    }
    if name.as_ref().is_some_and(|name| name.contains('\0')) {
        return Err(Error::invalid(join(path, "name"), "the name has a NUL, which ends a name in C"));
    }
    Ok(name.unwrap_or_default())
}

impl MeshSource {
    /// The index of the mesh; `name` is for one given in place.
    fn resolve(self, path: &str, name: &str, builder: &mut Builder<'_>) -> Result<usize> {
        let inline = self.positions.is_some()
            || self.triangles.is_some()
            || self.normals.is_some()
            || self.uvs.is_some()
            || self.further_uvs.is_some()
            || self.colors.is_some()
            || self.tangents.is_some();
        match (self.name, self.file) {
            (Some(shared), None) if !inline => builder.mesh_named(&join(path, "mesh"), &shared),
            (None, Some(file)) if !inline => builder.mesh_file(&join(path, "file"), &file, false),
            (None, None) if inline => {
                let missing = |key: &str| Error::invalid(path, format!("missing key `{key}` of a mesh given in place"));
                let positions = self.positions.ok_or_else(|| missing("positions"))?;
                let triangles = self.triangles.ok_or_else(|| missing("triangles"))?;
                let (normals, uvs) = (self.normals.unwrap_or_default(), self.uvs.unwrap_or_default());
                let tangents = self.tangents.unwrap_or_default();
                // The numbers are checked here as they were written. The other checks are done in single precision.
                for (key, vectors) in [("normals", &normals), ("tangents", &tangents)] {
                    vectors.iter().enumerate().try_for_each(|(i, it)| validate::numbers(path, key, i, *it))?;
                }
                for (i, uv) in uvs.iter().enumerate() {
                    validate::numbers(path, "uvs", i, *uv)?;
                }
                let further_uvs = self.further_uvs.unwrap_or_default();
                for (set, uvs) in further_uvs.iter().enumerate() {
                    let key = format!("furtherUvs[{set}]");
                    uvs.iter().enumerate().try_for_each(|(i, uv)| validate::numbers(path, &key, i, *uv))?;
                }
                let single = |uvs: Vec<[f64; 2]>| uvs.into_iter().map(|uv| uv.map(|x| x as f32)).collect::<Vec<_>>();
                let single_vectors = |all: Vec<[f64; 3]>| all.into_iter().map(|it| it.map(|x| x as f32)).collect();
                let colors: Vec<_> = self.colors.into_iter().flatten().map(VertexColor::with_opacity).collect();
                for (i, color) in colors.iter().enumerate() {
                    validate::numbers(path, "colors", i, *color)?;
                }
                builder.add_mesh(MeshDesc {
                    name: name.to_owned(),
                    path: path.to_owned(),
                    positions: positions.into_iter().map(DVec3::from_array).collect(),
                    normals: single_vectors(normals),
                    tangents: single_vectors(tangents),
                    uvs: single(uvs),
                    further_uvs: further_uvs.into_iter().map(single).collect(),
                    triangles,
                    colors: colors.into_iter().map(|color| color.map(|x| x as f32)).collect(),
                    host: None,
                })
            }
            (None, None) => Err(Error::invalid(
                path,
                "the mesh has no triangles, expected `file`, `positions` with `triangles`, or (of a surface) `mesh`",
            )),
            _ => Err(Error::invalid(path, "the mesh is given twice, expected one of `mesh`, `file` and `positions`")),
        }
    }
}
