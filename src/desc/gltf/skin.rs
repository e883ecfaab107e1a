//! Skins: the transforms of joints.

use super::accessor::{Accessors, Allowed};
use super::document::{Document, element};
use super::nodes::Nodes;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// From the frame of a mesh to the world, for each joint of the skin that `path` names.
pub(super) fn joints(
    document: &Document<'_>,
    accessors: &Accessors<'_>,
    nodes: &Nodes,
    path: &str,
    index: u64,
) -> Result<Vec<DAffine3>> {
    let (number, skin) = element(&document.skins, "skins", path, index)?;
    let path = format!("skins[{number}]");
    accessors.spend(&path, skin.joints.len() as u64)?;
    let at = format!("{path}.inverseBindMatrices");
    let inverse = match skin.inverse_bind_matrices {
        Some(index) => accessors.floats::<16>(&at, index, Allowed::Floats)?,
        None => Vec::new(),
    };
    if skin.inverse_bind_matrices.is_some() && inverse.len() < skin.joints.len() {
        let message = format!("{} matrices for {} joints, expected one each", inverse.len(), skin.joints.len());
        return Err(Error::invalid(at, message));
    }
    let matrix = |i: usize| {
        let Some(m) = inverse.get(i) else { return Ok(DAffine3::IDENTITY) };
        let last = [m[3], m[7], m[11], m[15]];
        // Exporters round the last row.
        if last.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(found, expected)| (found - expected).abs() > 1e-4) {
            let message = format!("the last row of element {i} is {last:?}, expected [0, 0, 0, 1]");
            return Err(Error::invalid(&at, message));
        }
        let column = |i: usize| DVec3::new(m[i].into(), m[i + 1].into(), m[i + 2].into());
        Ok(DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(4), column(8)), column(12)))
    };
    let of_joint = |(i, joint): (usize, &u64)| {
        let (joint, _) = element(&document.nodes, "nodes", &format!("{path}.joints[{i}]"), *joint)?;
        Ok(nodes.to_world[joint] * matrix(i)?)
    };
    skin.joints.iter().enumerate().map(of_joint).collect()
}
