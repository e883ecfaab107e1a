//! Lights of nodes (`KHR_lights_punctual`), and the light of files that have none.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::super::json::{self, elided};
use super::super::{DistantLightDesc, LightDistribution, PointLightDesc, SceneDesc, SpotDesc, validate};
use super::document::{Document, called, element, missing};
use super::nodes::Nodes;
use crate::math::DVec3;
use crate::photometry::LUMENS_PER_WATT;
use crate::{Error, Result};

/// The extension's name.
const NAME: &str = "KHR_lights_punctual";

#[derive(Deserialize)]
struct Light {
    name: Option<String>,
    color: Option<[f64; 3]>,
    /// Candela of point and spot lights, lux of directional ones.
    intensity: Option<f64>,
    #[serde(rename = "type")]
    kind: Option<String>,
    range: Option<f64>,
    spot: Option<Spot>,
}

/// The angles of a spot light from its axis, radians.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Spot {
    inner_cone_angle: Option<f64>,
    outer_cone_angle: Option<f64>,
}

/// The cone of a spot light, which shines along the axis -z of its node.
fn spot(path: &str, spot: &Spot, direction: DVec3) -> Result<LightDistribution> {
    let default = SpotDesc::new(direction);
    let degrees = |angle: Option<f64>, default: f64| angle.map_or(default, f64::to_degrees);
    let spot = SpotDesc {
        outer_deg: degrees(spot.outer_cone_angle, default.outer_deg),
        inner_deg: degrees(spot.inner_cone_angle, default.inner_deg),
        ..default
    };
    validate::spot(path, &spot)?;
    Ok(LightDistribution::Spot(spot))
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
    let mut ranged = Vec::new();
    for node in &nodes.drawn {
        let Some(raw) = document.nodes[*node].extensions.get(NAME) else { continue };
        let at_node = format!("nodes[{node}].extensions.{NAME}");
        let OfNode { light } = json::object(raw, &at_node)?;
        let (number, raw) = element(&lights, &format!("{list}.lights"), &format!("{at_node}.light"), light)?;
        let path = format!("{list}.lights[{number}]");
        let light: Light = json::object(raw, &path)?;
        let name = || called(&path, light.name.as_deref());
        match light.kind.as_deref() {
            Some("point" | "spot" | "directional") => {}
            Some(other) => {
                let message = format!("unknown type '{}', expected point, spot or directional", elided(other));
                return Err(Error::invalid(format!("{path}.type"), message));
            }
            None => return Err(missing(&path, "type")),
        }
        if light.range.is_some() {
            ranged.push(name());
        }
        let factor =
            validate::intensity(&format!("{path}.intensity"), light.intensity.unwrap_or(1.0))? / LUMENS_PER_WATT;
        let to_world = &nodes.to_world[*node];
        if light.kind.as_deref() == Some("directional") {
            // It shines along the axis -z of its node, and is parallel wherever the node is.
            let irradiance = validate::emission(&format!("{path}.color"), light.color.unwrap_or([1.0; 3]), factor)?;
            let light = DistantLightDesc::parallel(to_world.matrix3 * DVec3::Z, irradiance);
            scene.distant_lights.push(DistantLightDesc { path: at_node, ..light });
            continue;
        }
        let even = validate::point_light(&path, to_world.translation, light.color.unwrap_or([1.0; 3]), factor)?;
        let distribution = if light.kind.as_deref() == Some("spot") {
            let angles = light.spot.ok_or_else(|| missing(&path, "spot"))?;
            spot(&format!("{path}.spot"), &angles, to_world.matrix3 * DVec3::NEG_Z)?
        } else {
            LightDistribution::Even
        };
        scene.lights.push(PointLightDesc { path: at_node, distribution, ..even });
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
