//! Keys of materials that consist of others, and of the black one.

use super::super::builder::Builder;
use super::super::json::join;
use super::super::numbers::single;
use super::super::{BsdfDesc, validate};
use super::{Kind, SharedKeys, keys, material, tags};
use crate::Result;

material!(
    /// Absorbs everything.
    Black, Black, {
});

material!(
    /// Two materials, mixed.
    Mix, Mix, {
    /// Names of two materials that come before this one.
    materials: [String; 2],
    /// Share of the second, in [0, 1]. Default 0.5.
    weight: Option<f64>,
});

material!(
    /// Different materials on the two sides of a surface.
    TwoSided, TwoSided, {
    /// Name of the material on the normal's side, which comes before this one and does not transmit light.
    front: String,
    /// Name of the material on the other side.
    back: String,
});

impl Black {
    /// The keys of a black material.
    pub(super) fn of(shared: SharedKeys) -> Self {
        keys!(Self, tags::Black::Black, shared, {})
    }
}

impl Mix {
    /// The keys of a mixture of the materials of these names.
    pub(super) fn of(shared: SharedKeys, materials: [String; 2], weight: f32) -> Self {
        keys!(Self, tags::Mix::Mix, shared, {
            materials: materials,
            weight: Some(single(weight)),
        })
    }
}

impl TwoSided {
    /// The keys of a material with the materials of these names on its sides.
    pub(super) fn of(shared: SharedKeys, front: String, back: String) -> Self {
        keys!(Self, tags::TwoSided::TwoSided, shared, {
            front: front,
            back: back,
        })
    }
}

impl Kind for Black {
    fn bsdf(&self, _: &str, _: &Builder<'_>) -> Result<BsdfDesc> {
        Ok(BsdfDesc::Black)
    }
}

impl Kind for Mix {
    fn bsdf(&self, path: &str, builder: &Builder<'_>) -> Result<BsdfDesc> {
        let at = |key: &str| join(path, key);
        let [first, second] = &self.materials;
        let materials = [builder.part(&at("materials[0]"), first)?, builder.part(&at("materials[1]"), second)?];
        let weight = validate::within(&at("weight"), self.weight.unwrap_or(0.5), 0.0, 1.0)?;
        Ok(BsdfDesc::Mix { materials, weight })
    }
}

impl Kind for TwoSided {
    fn bsdf(&self, path: &str, builder: &Builder<'_>) -> Result<BsdfDesc> {
        let front = builder.part(&join(path, "front"), &self.front)?;
        let back = builder.part(&join(path, "back"), &self.back)?;
        Ok(BsdfDesc::TwoSided { front, back })
    }
}
