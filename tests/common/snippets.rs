//! The examples in `docs/scene-format.md`, as complete scenes.

use std::path::{Path, PathBuf};

/// The folder that contains the examples' mesh files.
pub fn data_dir() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

/// (kind, snippet, complete text) of every JSON block; parameter files stay as they are.
pub fn snippets() -> Vec<(String, String, String)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene-format.md");
    let text = std::fs::read_to_string(path).expect("docs/scene-format.md");
    let mut found = Vec::new();
    for part in text.split("\n```json ").skip(1) {
        let (kind, rest) = part.split_once('\n').expect("a block after its kind");
        let (snippet, _) = rest.split_once("\n```").expect("an end of the block");
        found.push((kind.to_owned(), snippet.to_owned(), complete(kind, snippet)));
    }
    found
}

/// A fragment of a kind, within the smallest scene that contains it.
fn complete(kind: &str, snippet: &str) -> String {
    let white = r#"{"name": "white", "type": "diffuse", "color": [0.5, 0.5, 0.5]}"#;
    let bricks = r#"{"name": "bricks", "type": "image", "file": "bricks.png"}"#;
    match kind {
        "scene" | "params" => snippet.to_owned(),
        "camera" => format!("{{\"etendue\": 1,\n\"camera\":\n{snippet}\n}}"),
        "render" => format!("{{\"etendue\": 1, \"camera\": {{}},\n\"render\":\n{snippet}\n}}"),
        "light" => format!("{{\"etendue\": 1, \"camera\": {{}},\n\"lights\": [\n{snippet}\n]}}"),
        "texture" => format!("{{\"etendue\": 1, \"camera\": {{}},\n\"textures\": [\n{snippet}\n]}}"),
        "material" if snippet.contains("\"bricks\"") => {
            format!("{{\"etendue\": 1, \"camera\": {{}},\n\"textures\": [{bricks}],\n\"materials\": [\n{snippet}\n]}}")
        }
        "material" => format!("{{\"etendue\": 1, \"camera\": {{}},\n\"materials\": [\n{snippet}\n]}}"),
        "surface" => {
            format!("{{\"etendue\": 1, \"camera\": {{}},\n\"materials\": [{white}],\n\"surfaces\": [\n{snippet}\n]}}")
        }
        other => panic!("unknown kind of example: {other}"),
    }
}
