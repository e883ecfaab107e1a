//! Small glTF files that tests write.

use std::path::Path;

use base64::Engine;
use etendue::Error;
use etendue::desc::{self, LoadOptions, SceneDesc};
use serde_json::{Value, json};

/// Component types.
pub const BYTE: u32 = 5120;
pub const UNSIGNED_BYTE: u32 = 5121;
pub const SHORT: u32 = 5122;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;
pub const FLOAT: u32 = 5126;

/// A document with one buffer.
#[derive(Clone)]
pub struct File {
    pub root: Value,
    pub bytes: Vec<u8>,
}

impl File {
    /// A document with nothing in it but a scene of its first node.
    pub fn new() -> Self {
        let root = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "accessors": [], "bufferViews": [], "meshes": [], "nodes": [],
        });
        Self { root, bytes: Vec::new() }
    }

    /// A document with a triangle in the plane z = 0, seen by a node.
    pub fn triangle() -> Self {
        let mut file = Self::new();
        let positions = file.floats(3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        file.push("meshes", json!({"primitives": [{"attributes": {"POSITION": positions}}]}));
        file.push("nodes", json!({"mesh": 0}));
        file
    }

    /// Adds an element to a list, which is made if it is not there.
    pub fn push(&mut self, list: &str, element: Value) -> usize {
        if self.root[list].is_null() {
            self.root[list] = json!([]);
        }
        let list = self.root[list].as_array_mut().expect("a list");
        list.push(element);
        list.len() - 1
    }

    /// Adds a view of these bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    /// Adds an accessor of floats with this many components.
    pub fn floats(&mut self, components: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(FLOAT, components, values.len() / components, &bytes)
    }

    /// Adds an accessor of whole numbers.
    pub fn whole(&mut self, component_type: u32, components: usize, values: &[i64]) -> usize {
        let size = match component_type {
            BYTE | UNSIGNED_BYTE => 1,
            SHORT | UNSIGNED_SHORT => 2,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()[..size].to_vec()).collect();
        self.accessor(component_type, components, values.len() / components, &bytes)
    }

    fn accessor(&mut self, component_type: u32, components: usize, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let kind = match components {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        let accessor = json!({"bufferView": view, "componentType": component_type, "count": count, "type": kind});
        self.push("accessors", accessor)
    }

    /// The text of the document, with its buffer as a data URI unless it has another one.
    pub fn text(&self) -> String {
        let mut root = self.root.clone();
        if root["buffers"].is_null() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
            let uri = format!("data:application/octet-stream;base64,{data}");
            root["buffers"] = json!([{"uri": uri, "byteLength": self.bytes.len()}]);
        }
        serde_json::to_string_pretty(&root).expect("text")
    }

    /// The bytes of a binary file.
    pub fn binary(&self) -> Vec<u8> {
        let mut root = self.root.clone();
        root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes.clone();
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let word = |value: usize| (value as u32).to_le_bytes();
        let length = 12 + 8 + text.len() + 8 + bytes.len();
        [
            b"glTF".as_slice(),
            &word(2),
            &word(length),
            &word(text.len()),
            b"JSON",
            &text,
            &word(bytes.len()),
            b"BIN\0",
            &bytes,
        ]
        .concat()
    }

    /// The scene of the document.
    pub fn load(&self) -> Result<SceneDesc, Error> {
        self.load_with(&LoadOptions::default())
    }

    /// The scene of the document with a choice.
    pub fn load_with(&self, options: &LoadOptions) -> Result<SceneDesc, Error> {
        desc::parse_gltf(self.text().as_bytes(), Path::new("/nowhere"), None, options)
    }

    /// The scene at a time.
    pub fn at(&self, time: f64) -> Result<SceneDesc, Error> {
        self.load_with(&LoadOptions { time: Some(time), ..LoadOptions::default() })
    }
}
