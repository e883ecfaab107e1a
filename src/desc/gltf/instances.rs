//! `EXT_mesh_gpu_instancing`: one mesh at many places below a node.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::super::json;
use super::accessor::{Accessors, Allowed};
use super::document::Node;
use crate::math::{DAffine3, DQuat, DVec3};
use crate::{Error, Result};

/// The extension's name.
pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

/// Most places of one mesh.
const LIMIT: u64 = 1 << 22;

/// The places of a node's mesh in the frame of the node; `None` where the node does not have the extension.
pub(super) fn read(path: &str, node: &Node<'_>, accessors: &Accessors<'_>) -> Result<Option<Vec<DAffine3>>> {
    #[derive(Deserialize)]
    struct Extension {
        #[serde(default)]
        attributes: BTreeMap<String, u64>,
    }
    let Some(raw) = node.extensions.get(NAME) else { return Ok(None) };
    let path = format!("{path}.extensions.{NAME}");
    let Extension { attributes } = json::object(raw, &path)?;
    let at = |key: &str| format!("{path}.attributes.{key}");
    let mut count = None;
    for (key, index) in &attributes {
        let of_this = accessors.count(&at(key), *index)?;
        if count.is_some_and(|count| count != of_this) {
            return Err(Error::invalid(at(key), format!("{of_this} elements, other attributes have {count:?}")));
        }
        if of_this > LIMIT {
            return Err(Error::invalid(at(key), format!("{of_this} instances are too many, expected {LIMIT} at most")));
        }
        count = Some(of_this);
    }
    let count = count.unwrap_or(0) as usize;
    let vectors = |key: &str| match attributes.get(key) {
        Some(index) => accessors.floats::<3>(&at(key), *index, Allowed::Floats).map(Some),
        None => Ok(None),
    };
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let rotations = match attributes.get("ROTATION") {
        Some(index) => Some(accessors.floats::<4>(&at("ROTATION"), *index, Allowed::Animated)?),
        None => None,
    };
    let vector = |list: &Option<Vec<[f32; 3]>>, i: usize, default: DVec3| match list {
        Some(list) => DVec3::from_array(list[i].map(f64::from)),
        None => default,
    };
    let place = |i: usize| {
        let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |list| DQuat::from_array(list[i].map(f64::from)));
        let length = rotation.length();
        if length <= 1e-6 {
            return Err(Error::invalid(
                at("ROTATION"),
                format!("element {i} is {rotation}, expected a unit quaternion"),
            ));
        }
        let (scale, translation) = (vector(&scales, i, DVec3::ONE), vector(&translations, i, DVec3::ZERO));
        Ok(DAffine3::from_scale_rotation_translation(scale, rotation / length, translation))
    };
    (0..count).map(place).collect::<Result<_>>().map(Some)
}
