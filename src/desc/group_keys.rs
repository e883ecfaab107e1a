//! Reads and writes groups of the native format, and the surfaces that place them.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::builder::Builder;
use super::json::{self, join};
use super::save::raw;
use super::surface::checked_name;
use super::{GroupDesc, MotionDesc, PlacementDesc, SceneDesc, SurfaceDesc, motion_keys, surface, transform};
use crate::room::check_room;
use crate::{Error, Result};

/// Surfaces that are placed together, as often as surfaces of the geometry `group` name them.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Group<'a> {
    /// What placements call it, not empty.
    name: String,
    /// The surfaces, one at least, in the frame of the group.
    #[serde(borrow)]
    surfaces: &'a RawValue,
}

/// All surfaces of a group, at one place. They are surfaces like any others.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Placement<'a> {
    #[serde(rename = "geometry")]
    _geometry: Tag,
    /// Name of one of `groups`: of an earlier one, inside a group.
    group: String,
    /// What all of its surfaces are called in mattes, in place of their own names, not empty. Default: their own names.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    name: Option<String>,
    /// From the frame of the group to the world. Default: none.
    #[serde(borrow)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<transform::Transform>"))]
    transform: Option<&'a RawValue>,
    /// Keyframes, by which the group is moved after `transform`. Default: it rests. Not inside a group.
    motion: Option<Vec<motion_keys::Key>>,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(rename_all = "kebab-case")]
enum Tag {
    Group,
}

/// Reads one of `groups`.
pub(super) fn read(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let group: Group<'_> = json::object(raw, path)?;
    if group.name.is_empty() {
        return Err(Error::invalid(join(path, "name"), "the name is empty, expected one letter at least"));
    }
    builder.scene.check_group_name(path, &group.name)?;
    let first = [builder.scene.surfaces.len(), builder.scene.placements.len()];
    json::each(Some(group.surfaces), &join(path, "surfaces"), |path, raw| surface::read(raw, path, builder))?;
    builder.scene.gather_group(path, group.name, first)?;
    Ok(())
}

/// Reads one of `surfaces` that places a group.
pub(super) fn read_placement(raw: &RawValue, path: &str, builder: &mut Builder<'_>) -> Result<()> {
    let it: Placement<'_> = json::object(raw, path)?;
    let at = |key: &str| join(path, key);
    let group = builder.group(&at("group"), &it.group)?;
    let name = checked_name(path, it.name)?;
    let transform = transform::read(it.transform, &at("transform"))?;
    let motion = it.motion.map(|keys| motion_keys::motion(keys, &at("motion"))).transpose()?;
    let scene = &mut builder.scene;
    let placed =
        scene.put_placement(path.to_owned(), group, transform, |member| format!("{path}.surfaces[{member}]"))?;
    if !name.is_empty() {
        let count = scene.placements[placed].surfaces.len();
        check_room(name.len().saturating_mul(count))?;
        for number in scene.placements[placed].surfaces.clone() {
            scene.set_surface_name(number, &name)?;
        }
    }
    if motion.is_some() {
        scene.set_placement_motion(placed, motion)?;
    }
    Ok(())
}

/// Writes a group with this name and these surfaces, as they were written.
pub(super) fn write(name: &str, surfaces: &[Box<RawValue>]) -> Result<Box<RawValue>> {
    raw(&Group { name: name.to_owned(), surfaces: &raw(&surfaces)? })
}

/// Writes a surface that places a group with this name.
pub(super) fn write_placement(
    placement: &PlacementDesc,
    group: &str,
    name: &str,
    motion: Option<&MotionDesc>,
) -> Result<Box<RawValue>> {
    raw(&Placement {
        _geometry: Tag::Group,
        group: group.to_owned(),
        name: Some(name.to_owned()).filter(|name| !name.is_empty()),
        transform: transform::write(&placement.transform)?.as_deref(),
        motion: motion.map(motion_keys::write_motion),
    })
}

/// The name that all surfaces of a placement have in place of their own, empty where they have their own, and the motion of the
/// placement; `None` where its surfaces are not those that a file has where it places the group.
pub(super) fn as_placed<'a>(
    scene: &'a SceneDesc,
    placement: &PlacementDesc,
    group: &GroupDesc,
) -> Option<(&'a str, Option<&'a MotionDesc>)> {
    if placement.hidden || placement.surfaces.len() != group.members.len() {
        return None;
    }
    let surfaces = scene.surfaces.range(placement.surfaces.clone())?;
    let pairs = || surfaces.clone().zip(&group.members);
    let has_own_names = pairs().all(|(surface, member)| surface.name == member.name);
    let name = if has_own_names { "" } else { surfaces.clone().next()?.name.as_str() };
    let motion = scene.motion.surfaces.get(&placement.surfaces.start);
    let moves_so = |number: usize| scene.motion.surfaces.get(&number) == motion;
    let is_named_so = |surface: &SurfaceDesc| has_own_names || !name.is_empty() && surface.name == name;
    let is_placed = pairs().all(|(surface, member)| is_named_so(surface) && is_copy(surface, member, placement));
    (is_placed && placement.surfaces.clone().all(moves_so)).then(|| (name, motion.map(|motion| &**motion)))
}

/// Whether a surface is what a placement makes of a member of its group, apart from its name.
fn is_copy(surface: &SurfaceDesc, member: &SurfaceDesc, placement: &PlacementDesc) -> bool {
    let placed = placement.transform * member.transform;
    transform::same_bits(&surface.transform, &placed)
        && transform::same_bits(&surface.local, &member.local)
        && surface.shape == member.shape
        && surface.material == member.material
        && surface.emission == member.emission
        && surface.emits_both == member.emits_both
        && surface.web == member.web
        && surface.spectrum == member.spectrum
        && !surface.hidden
}

/// Surfaces that are placed together, as often as surfaces of the geometry `group` name them.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(deny_unknown_fields, rename = "Group")]
#[expect(dead_code, reason = "only its schema is used")]
pub(super) struct GroupSchema<T> {
    /// What placements call it, not empty.
    #[schemars(length(min = 1))]
    name: String,
    /// The surfaces, one at least, in the frame of the group.
    #[schemars(length(min = 1))]
    surfaces: Vec<T>,
}
