//! JSON Schema of the native scene format, from the structures that read it.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};

use super::{
    backplate_keys, camera_keys, group_keys, light_keys, material_keys, native, render_block, sky_keys, surface,
    texture_keys,
};

/// A scene in Étendue's native format, version 1.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, rename = "Scene")]
#[expect(dead_code, reason = "only its schema is used")]
struct Scene<'a> {
    /// Version of the format: 1.
    #[schemars(range(min = 1, max = 1))]
    etendue: u8,
    /// For editors; ignored.
    #[schemars(rename = "$schema")]
    schema: Option<String>,
    /// For people; ignored.
    description: Option<String>,
    /// Where the scene is seen from.
    camera: camera_keys::Camera,
    /// How to render.
    render: Option<render_block::Render<'a>>,
    /// Lights. Surfaces with an emission are lights too.
    lights: Option<Vec<Light>>,
    /// What the camera sees behind everything.
    backplate: Option<backplate_keys::Backplate>,
    /// Images and patterns, by name.
    textures: Option<Vec<Texture>>,
    /// Materials, by name.
    materials: Option<Vec<Material>>,
    /// Meshes that several surfaces can use, by name.
    meshes: Option<Vec<surface::SharedMesh>>,
    /// Surfaces that are placed together, by name. Those inside another group are described before it.
    groups: Option<Vec<group_keys::GroupSchema<Surface<'a>>>>,
    /// What there is to hit.
    surfaces: Option<Vec<Surface<'a>>>,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Light {
    Point(light_keys::PointLight),
    Spot(light_keys::SpotLight),
    Web(light_keys::WebLight),
    Area(native::AreaLight),
    Environment(sky_keys::Environment),
    Distant(sky_keys::Distant),
    Sky(sky_keys::FormulaSky),
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Texture {
    Image(texture_keys::Image),
    Pattern(texture_keys::PatternTexture),
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Material {
    Diffuse(material_keys::Diffuse),
    Reflective(material_keys::Reflective),
    Refractive(material_keys::Refractive),
    Black(material_keys::Black),
    Conductor(material_keys::Conductor),
    ThinRefractive(material_keys::ThinRefractive),
    CoatedDiffuse(material_keys::CoatedDiffuse),
    Sheen(material_keys::Sheen),
    DiffuseTransmission(material_keys::DiffuseTransmission),
    Principled(Box<material_keys::Principled>),
    Mix(material_keys::Mix),
    TwoSided(material_keys::TwoSided),
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Surface<'a> {
    Sphere(surface::Sphere<'a>),
    Triangle(surface::Triangle<'a>),
    Quad(surface::Quad<'a>),
    Mesh(Box<surface::Mesh<'a>>),
    Quadric(surface::Quadric<'a>),
    Cylinder(surface::Cylinder<'a>),
    Cone(surface::Cone<'a>),
    Disk(surface::Disk<'a>),
    Ellipsoid(surface::Ellipsoid<'a>),
    Paraboloid(surface::Paraboloid<'a>),
    Group(group_keys::Placement<'a>),
}

/// The JSON Schema (draft 2020-12) of native scene files.
///
/// It checks keys, types and names; what numbers mean (a camera's frame, a flat quad) only reading a scene checks.
pub fn schema() -> Schema {
    // A key may be null wherever it may be left out; that null is its default says nothing more.
    let without_null = RecursiveTransform(|schema: &mut Schema| {
        if schema.get("default").is_some_and(serde_json::Value::is_null) {
            schema.remove("default");
        }
    });
    SchemaSettings::default().with_transform(without_null).into_generator().into_root_schema_for::<Scene<'_>>()
}
