//! The JSON of a glTF document as plain structures, with the keys that this library reads.
//!
//! The crate `gltf-json` has such structures too. It is not used because its validation panics for a `POSITION` whose accessor does
//! not exist, it cuts indices to 32 bits, refuses scenes and animation targets without nodes, which the specification allows, and
//! forgets the names of attributes that it does not know. Here every number that is no number is told with its path, and every index
//! is looked up by [`Document::element`], which names the place of one that is out of range.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::super::json;
use crate::{Error, ErrorKind, Result};

/// Extensions of an element, by name. They are read where they are used.
pub(super) type Extensions<'a> = BTreeMap<String, &'a RawValue>;

/// Declares structures whose keys are those of glTF.
macro_rules! elements {
    ($($(#[$meta:meta])* $name:ident $(<$life:lifetime>)? {
        $($(#[$field_meta:meta])* $field:ident: $type:ty,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Debug, Deserialize)]
        #[serde(rename_all = "camelCase")]
        pub(super) struct $name $(<$life>)? {
            $($(#[$field_meta])* #[serde(default)] pub $field: $type,)*
        }
    )*};
}

/// The whole document.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document<'a> {
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(borrow, default)]
    pub animations: Vec<Animation<'a>>,
    #[serde(borrow, default)]
    pub buffers: Vec<Buffer<'a>>,
    #[serde(borrow, default)]
    pub buffer_views: Vec<BufferView<'a>>,
    #[serde(default)]
    pub cameras: Vec<Camera>,
    #[serde(borrow, default)]
    pub images: Vec<Image<'a>>,
    #[serde(borrow, default)]
    pub materials: Vec<Material<'a>>,
    #[serde(borrow, default)]
    pub meshes: Vec<Mesh<'a>>,
    #[serde(borrow, default)]
    pub nodes: Vec<Node<'a>>,
    #[serde(default)]
    pub samplers: Vec<Sampler>,
    #[serde(default)]
    pub scenes: Vec<Scene>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(borrow, default)]
    pub textures: Vec<Texture<'a>>,
    pub scene: Option<u64>,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    #[serde(borrow, default)]
    pub extensions: Extensions<'a>,
}

elements! {
    /// An array of numbers in a buffer.
    Accessor {
        buffer_view: Option<u64>,
        byte_offset: u64,
        component_type: u32,
        normalized: bool,
        count: u64,
        #[serde(rename = "type")]
        kind: String,
        sparse: Option<Sparse>,
    }
    /// The elements of an accessor that are not those of its buffer view.
    Sparse {
        count: u64,
        indices: SparsePart,
        values: SparsePart,
    }
    /// A buffer.
    Buffer<'a> {
        #[serde(borrow)]
        uri: Option<&'a RawValue>,
        byte_length: u64,
    }
    /// A part of a buffer.
    BufferView<'a> {
        buffer: Option<u64>,
        byte_offset: u64,
        byte_length: u64,
        byte_stride: Option<u64>,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// A camera.
    Camera {
        name: Option<String>,
        #[serde(rename = "type")]
        kind: String,
        perspective: Option<Perspective>,
        orthographic: Option<Orthographic>,
    }
    /// What an orthographic camera sees.
    Orthographic {
        xmag: Option<f64>,
        ymag: Option<f64>,
    }
    /// What a perspective camera sees.
    Perspective {
        aspect_ratio: Option<f64>,
        yfov: Option<f64>,
    }
    /// An image.
    Image<'a> {
        #[serde(borrow)]
        uri: Option<&'a RawValue>,
        buffer_view: Option<u64>,
    }
    /// A material.
    Material<'a> {
        name: Option<String>,
        #[serde(borrow)]
        pbr_metallic_roughness: Option<MetallicRoughness<'a>>,
        #[serde(borrow)]
        normal_texture: Option<TextureInfo<'a>>,
        #[serde(borrow)]
        occlusion_texture: Option<TextureInfo<'a>>,
        #[serde(borrow)]
        emissive_texture: Option<TextureInfo<'a>>,
        emissive_factor: Option<[f64; 3]>,
        alpha_mode: Option<String>,
        alpha_cutoff: Option<f64>,
        double_sided: bool,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// The parameters that every material has.
    MetallicRoughness<'a> {
        base_color_factor: Option<[f64; 4]>,
        #[serde(borrow)]
        base_color_texture: Option<TextureInfo<'a>>,
        metallic_factor: Option<f64>,
        roughness_factor: Option<f64>,
        #[serde(borrow)]
        metallic_roughness_texture: Option<TextureInfo<'a>>,
    }
    /// Where a material names a texture. `scale` is of normal maps, `strength` of occlusion.
    TextureInfo<'a> {
        index: Option<u64>,
        tex_coord: u64,
        scale: Option<f64>,
        strength: Option<f64>,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// A mesh: primitives that are drawn together.
    Mesh<'a> {
        name: Option<String>,
        #[serde(borrow)]
        primitives: Vec<Primitive<'a>>,
        weights: Option<Vec<f64>>,
    }
    /// Triangles, lines or points of one material.
    Primitive<'a> {
        attributes: BTreeMap<String, u64>,
        indices: Option<u64>,
        material: Option<u64>,
        mode: Option<u32>,
        targets: Vec<BTreeMap<String, u64>>,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// A place in the hierarchy of a scene.
    Node<'a> {
        name: Option<String>,
        camera: Option<u64>,
        children: Vec<u64>,
        matrix: Option<[f64; 16]>,
        translation: Option<[f64; 3]>,
        rotation: Option<[f64; 4]>,
        scale: Option<[f64; 3]>,
        mesh: Option<u64>,
        skin: Option<u64>,
        weights: Option<Vec<f64>>,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// How a texture is repeated.
    Sampler {
        mag_filter: Option<u32>,
        wrap_s: Option<u32>,
        wrap_t: Option<u32>,
    }
    /// The nodes that are drawn together.
    Scene {
        name: Option<String>,
        nodes: Vec<u64>,
    }
    /// The joints that move a mesh.
    Skin {
        inverse_bind_matrices: Option<u64>,
        joints: Vec<u64>,
    }
    /// An image with a sampler.
    Texture<'a> {
        sampler: Option<u64>,
        source: Option<u64>,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// Changes of nodes over time.
    Animation<'a> {
        name: Option<String>,
        #[serde(borrow)]
        channels: Vec<Channel<'a>>,
        samplers: Vec<AnimationSampler>,
    }
    /// What an animation changes.
    Channel<'a> {
        sampler: Option<u64>,
        #[serde(borrow)]
        target: Option<Target<'a>>,
    }
    /// A property of a node.
    Target<'a> {
        node: Option<u64>,
        path: String,
        #[serde(borrow)]
        extensions: Extensions<'a>,
    }
    /// Values at times.
    AnimationSampler {
        input: Option<u64>,
        interpolation: Option<String>,
        output: Option<u64>,
    }
}

/// The indices or the values of a sparse accessor.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub buffer_view: Option<u64>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: Option<u32>,
}

/// Reads the text of a document, after its version.
pub(super) fn read(text: &str) -> Result<Document<'_>> {
    #[derive(Deserialize)]
    struct Probe<'a> {
        #[serde(borrow)]
        asset: Option<&'a RawValue>,
    }
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Asset<'a> {
        #[serde(borrow)]
        version: Option<&'a RawValue>,
        #[serde(borrow)]
        min_version: Option<&'a RawValue>,
    }
    let raw = json::document(text)?;
    let Some(asset) = json::object::<Probe<'_>>(raw, "")?.asset else {
        return Err(Error::invalid("", "missing key `asset`, which every glTF document has"));
    };
    let Asset { version, min_version }: Asset<'_> = json::object(asset, "asset")?;
    let version = version.ok_or_else(|| Error::invalid("asset", "missing key `version`, expected 2.0"))?;
    for (key, version) in [("asset.version", Some(version)), ("asset.minVersion", min_version)] {
        // Files of version 1 also have it as a number.
        let version = version.map(|raw| raw.get().trim_matches('"'));
        if let Some(version) = version.filter(|it| it.split('.').next() != Some("2")) {
            let message =
                format!("the file is of glTF version {}, this library reads version 2.0", json::elided(version));
            return Err(Error::new(ErrorKind::Unsupported, message).at(key));
        }
    }
    json::value(raw, "")
}

/// Looks up an element of one of the document's lists by the index at `path`.
pub(super) fn element<'a, T>(list: &'a [T], what: &str, path: &str, index: u64) -> Result<(usize, &'a T)> {
    let found = usize::try_from(index).ok().and_then(|index| list.get(index).map(|it| (index, it)));
    found.ok_or_else(|| {
        let message = match list.len() {
            0 => format!("there is no {what}[{index}], the file has no {what}"),
            len => format!("there is no {what}[{index}], expected an index below {len}"),
        };
        Error::invalid(path, message)
    })
}

/// The error for a key that has to be there.
pub(super) fn missing(path: &str, key: &str) -> Error {
    Error::invalid(path, format!("missing key `{key}`"))
}

/// What an element is called in messages: its path, with its name if it has one.
pub(super) fn called(path: &str, name: Option<&str>) -> String {
    match name.filter(|name| !name.is_empty()) {
        Some(name) => format!("{path} ('{}')", json::elided(name)),
        None => path.to_owned(),
    }
}
