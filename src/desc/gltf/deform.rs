//! Puts vertices where joints or a flattening transform move them.

use super::accessor::{Accessors, Allowed};
use super::document::Primitive;
use super::mesh::{Geometry, needed};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// Most sets of four joints for each vertex.
const SETS: usize = 4;

/// Moves the vertices of a primitive to the world by the weighted mean of the transforms of their joints.
pub(super) fn skin(
    path: &str,
    primitive: &Primitive<'_>,
    joints: &[DAffine3],
    accessors: &Accessors<'_>,
    geometry: &mut Geometry,
) -> Result<()> {
    let count = geometry.positions.len();
    let mut sums = vec![(0.0, DAffine3::ZERO); count];
    let mut first = vec![None; count];
    for set in 0..SETS {
        let [joint_key, weight_key] = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")];
        let has = |key: &str| primitive.attributes.contains_key(key);
        if set > 0 && !has(&joint_key) && !has(&weight_key) {
            break;
        }
        let at = |key: &str| format!("{path}.attributes.{key}");
        let numbers =
            accessors.whole::<4>(&at(&joint_key), needed(path, primitive, &joint_key)?, Allowed::SmallWhole)?;
        let weights =
            accessors.floats::<4>(&at(&weight_key), needed(path, primitive, &weight_key)?, Allowed::Fractions)?;
        for (key, found) in [(&joint_key, numbers.len()), (&weight_key, weights.len())] {
            if found != count {
                let message = format!("{found} elements for {count} positions, expected one each");
                return Err(Error::invalid(at(key), message));
            }
        }
        for (i, (numbers, weights)) in numbers.iter().zip(&weights).enumerate() {
            for (number, weight) in numbers.iter().zip(weights) {
                let Some(joint) = joints.get(*number as usize) else {
                    // Joints without a weight are padding.
                    if *weight == 0.0 {
                        continue;
                    }
                    let message = format!("element {i} names joint {number}, expected one below {}", joints.len());
                    return Err(Error::invalid(at(&joint_key), message));
                };
                first[i].get_or_insert(*joint);
                let (sum, blended) = &mut sums[i];
                let weight = f64::from(*weight);
                *sum += weight;
                blended.matrix3 += weight * joint.matrix3;
                blended.translation += weight * joint.translation;
            }
        }
    }
    let mut mirrored = 0_usize;
    for (i, (sum, blended)) in sums.into_iter().enumerate() {
        // Weights that were rounded do not sum to one. A vertex without weights follows its first joint, as elsewhere.
        let to_world = if sum.abs() > 1e-9 {
            DAffine3 { matrix3: blended.matrix3 * (1.0 / sum), translation: blended.translation / sum }
        } else {
            first[i].unwrap_or(DAffine3::IDENTITY)
        };
        mirrored += usize::from(to_world.matrix3.determinant() < 0.0);
        geometry.positions[i] = to_world.transform_point3(geometry.positions[i]);
        if let Some(normal) = geometry.normals.get_mut(i) {
            *normal = transformed_normal(&to_world.matrix3, *normal);
        }
        if let Some(tangent) = geometry.tangents.get_mut(i) {
            *tangent = to_world.matrix3 * *tangent;
        }
    }
    if 2 * mirrored > count {
        geometry.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    Ok(())
}

/// Moves vertices by a transform that leaves a plane at least. Their normals are those of the faces.
pub(super) fn flatten(to_world: &DAffine3, geometry: &mut Geometry) {
    geometry.normals.clear();
    geometry.tangents.clear();
    geometry.positions.iter_mut().for_each(|position| *position = to_world.transform_point3(*position));
}

/// Whether a transform leaves at least a plane of what it moves.
pub(super) fn leaves_a_plane(to_world: &DAffine3) -> bool {
    let m = to_world.matrix3;
    let largest = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.length()).into_iter().fold(0.0, f64::max);
    let areas = [m.x_axis.cross(m.y_axis), m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis)];
    areas.iter().any(|area| area.length() > 1e-12 * largest * largest)
}

/// A normal after a transform: the inverse transposed, up to a factor > 0, which is also defined for matrices without an inverse.
fn transformed_normal(m: &DMat3, normal: DVec3) -> DVec3 {
    let cofactors = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let turned = cofactors * normal * m.determinant().signum();
    turned.try_normalize().unwrap_or(DVec3::ZERO)
}
