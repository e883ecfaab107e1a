//! Reads and writes the placement of surfaces: a matrix, or scale, rotation and translation, or several of them in a row.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::json::{self, Scale, join};
use super::numbers::unless;
use super::{save, validate};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// One step of a `transform`: either `matrix`, or any of the others (applied as scale, rotate, translate).
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Step {
    /// 4 x 4 matrix in row-major order, acting on column vectors; its last row is [0, 0, 0, 1].
    matrix: Option<[f64; 16]>,
    /// Translation, scene units.
    translate: Option<[f64; 3]>,
    /// Rotation about the x, then the y, then the z axis, degrees, right-handed.
    rotate: Option<[f64; 3]>,
    /// One factor, or one per axis.
    scale: Option<Scale>,
}

/// One step of placement, or several in a row.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
#[expect(clippy::large_enum_variant, reason = "never made")]
pub(super) enum Transform {
    /// One step.
    One(Step),
    /// Several, the first of which is applied first.
    Several(Vec<Step>),
}

/// Reads a `transform`. The result is the identity where there is none.
pub(super) fn read(raw: Option<&RawValue>, path: &str) -> Result<DAffine3> {
    let Some(raw) = raw else { return Ok(DAffine3::IDENTITY) };
    let transform = match json::kind(raw.get()) {
        "an object" => step(raw, path)?,
        "an array" => {
            let mut done = DAffine3::IDENTITY;
            json::each(Some(raw), path, |path, raw| {
                done = step(raw, path)? * done;
                Ok(())
            })?;
            done
        }
        found => {
            return Err(Error::invalid(path, format!("expected an object or an array of objects, found {found}")));
        }
    };
    validate::invertible(path, &transform)?;
    Ok(transform)
}

fn step(raw: &RawValue, path: &str) -> Result<DAffine3> {
    let step: Step = json::object(raw, path)?;
    if let Some(m) = step.matrix {
        if step.translate.is_some() || step.rotate.is_some() || step.scale.is_some() {
            let message = "`matrix` stands alone; use an array of transforms to combine it with others";
            return Err(Error::invalid(join(path, "matrix"), message));
        }
        return matrix(m, &join(path, "matrix"));
    }
    let translate = validate::vector(&join(path, "translate"), step.translate.unwrap_or_default())?;
    let degrees = validate::vector(&join(path, "rotate"), step.rotate.unwrap_or_default())?;
    let scale = factors(&join(path, "scale"), step.scale)?;
    Ok(place(scale, degrees * (std::f64::consts::PI / 180.0), translate))
}

/// The transform of a matrix that is given row by row.
pub(super) fn matrix(m: [f64; 16], path: &str) -> Result<DAffine3> {
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        let message = format!("the last row is {:?}, expected [0, 0, 0, 1]: the matrix is given row by row", &m[12..]);
        return Err(Error::invalid(path, message));
    }
    let column = |i: usize| DVec3::new(m[i], m[i + 4], m[i + 8]);
    Ok(DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3)))
}

/// Writes a transform that is invertible; `None` for the identity. It is written as a scale and a translation where it is made of
/// these, and otherwise as a matrix.
pub(super) fn write(transform: &DAffine3) -> Result<Option<Box<RawValue>>> {
    if same_bits(transform, &DAffine3::IDENTITY) {
        return Ok(None);
    }
    let DAffine3 { matrix3: DMat3 { x_axis, y_axis, z_axis }, translation } = *transform;
    let scale = DVec3::new(x_axis.x, y_axis.y, z_axis.z);
    let step = if same_bits(transform, &place(scale, DVec3::ZERO, translation)) && scale.cmpne(DVec3::ZERO).all() {
        Step {
            matrix: None,
            translate: unless_zero(translation),
            rotate: None,
            scale: if scale == DVec3::splat(scale.x) {
                unless(scale.x, 1.0).map(Scale::Uniform)
            } else {
                Some(Scale::PerAxis(scale.to_array()))
            },
        }
    } else {
        let row = |i: usize| [x_axis[i], y_axis[i], z_axis[i], translation[i]];
        let [[a, b, c, d], [e, f, g, h], [i, j, k, l]] = [0, 1, 2].map(row);
        let matrix = [a, b, c, d, e, f, g, h, i, j, k, l, 0.0, 0.0, 0.0, 1.0];
        Step { matrix: Some(matrix), translate: None, rotate: None, scale: None }
    };
    save::raw(&step).map(Some)
}

/// Whether two transforms have the same bits, down to the signs of zeros.
pub(super) fn same_bits(a: &DAffine3, b: &DAffine3) -> bool {
    a.to_cols_array().map(f64::to_bits) == b.to_cols_array().map(f64::to_bits)
}

/// The value of a key that may be left out; `None` for zeros.
pub(super) fn unless_zero(value: DVec3) -> Option<[f64; 3]> {
    let is_zero = value.to_array().iter().all(|x| x.to_bits() == 0);
    (!is_zero).then(|| value.to_array())
}

/// Returns the factors of a `scale`, or 1 where there is none. Zero is refused, because it would flatten the object.
pub(super) fn factors(path: &str, scale: Option<Scale>) -> Result<DVec3> {
    let factors = match scale {
        None => DVec3::ONE,
        Some(Scale::Uniform(factor)) => DVec3::splat(validate::number(path, factor)?),
        Some(Scale::PerAxis(factors)) => validate::vector(path, factors)?,
    };
    if factors.cmpeq(DVec3::ZERO).any() {
        return Err(Error::invalid(path, "a scale of 0 flattens the object, expected another number"));
    }
    Ok(factors)
}

/// p' = Rz Ry Rx (scale p) + origin, angles in radians.
pub(super) fn place(scale: DVec3, radians: DVec3, origin: DVec3) -> DAffine3 {
    let rotation =
        DMat3::from_rotation_z(radians.z) * DMat3::from_rotation_y(radians.y) * DMat3::from_rotation_x(radians.x);
    DAffine3::from_mat3_translation(rotation * DMat3::from_diagonal(scale), origin)
}
