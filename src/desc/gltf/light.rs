//! Lights of nodes (`KHR_lights_punctual`), and the light of files that have none.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::super::json::{self, elided};
use super::super::{SceneDesc, validate};
use super::document::{Document, called, element, missing};
use super::nodes::Nodes;
use crate::{Error, Result};

/// The extension's name.
const NAME: &str = "KHR_lights_punctual";

/// The luminous efficacy by which photometric units are converted [lm W^-1]. It is the one that exporters use, so that a light of
/// P watts comes back as one of P watts.
pub(super) const EFFICACY: f64 = 683.0;

#[derive(Deserialize)]
struct Light {
    name: Option<String>,
    color: Option<[f64; 3]>,
    /// Candela of point and spot lights, lux of directional ones.
    intensity: Option<f64>,
    #[serde(rename = "type")]
    kind: Option<String>,
    range: Option<f64>,
}

/// Adds the lights of a scene's nodes.
pub(super) fn add(document: &Document<'_>, nodes: &Nodes, scene: &mut SceneDesc) -> Result<()> {
    #[derive(Deserialize)]
    struct Lights<'a> {
        #[serde(borrow)]
        lights: Vec<&'a RawValue>,
    }
    #[derive(Deserialize)]
    struct OfNode {
        light: u64,
    }
    let list = format!("extensions.{NAME}");
    let lights = match document.extensions.get(NAME) {
        Some(raw) => json::object::<Lights<'_>>(raw, &list)?.lights,
        None => Vec::new(),
    };
    let (mut left_out, mut ranged) = (Vec::new(), Vec::new());
    for node in &nodes.drawn {
        let Some(raw) = document.nodes[*node].extensions.get(NAME) else { continue };
        let at_node = format!("nodes[{node}].extensions.{NAME}");
        let OfNode { light } = json::object(raw, &at_node)?;
        let (number, raw) = element(&lights, &format!("{list}.lights"), &format!("{at_node}.light"), light)?;
        let path = format!("{list}.lights[{number}]");
        let light: Light = json::object(raw, &path)?;
        let name = || called(&path, light.name.as_deref());
        match light.kind.as_deref() {
            Some("point") => {}
            Some(kind @ ("spot" | "directional")) => {
                left_out.push(format!("{} ({kind})", name()));
                continue;
            }
            Some(other) => {
                let message = format!("unknown type '{}', expected point, spot or directional", elided(other));
                return Err(Error::invalid(format!("{path}.type"), message));
            }
            None => return Err(missing(&path, "type")),
        }
        if light.range.is_some() {
            ranged.push(name());
        }
        let factor = light.intensity.unwrap_or(1.0) / EFFICACY;
        let position = nodes.to_world[*node].translation;
        let mut light = validate::point_light(&path, position, light.color.unwrap_or([1.0; 3]), factor)?;
        light.path = at_node;
        scene.lights.push(light);
    }
    if !left_out.is_empty() {
        super::warn(&mut scene.warnings, format!("these lights are not drawn: {}", super::listed(left_out)));
    }
    if !ranged.is_empty() {
        let text = format!(
            "light falls off with the square of the distance; `range` is left out of {}",
            super::listed(ranged)
        );
        super::warn(&mut scene.warnings, text);
    }
    Ok(())
}
