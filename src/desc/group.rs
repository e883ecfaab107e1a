//! Groups of surfaces, which are described once and placed as often as they are needed.

use std::ops::Range;
use std::sync::Arc;

use super::edit::none_such;
use super::json::{elided, join};
use super::{AreaWebDesc, MotionDesc, SceneDesc, ShapeDesc, SurfaceDesc, surface, validate};
use crate::math::DAffine3;
use crate::room::{check_room, with_room};
use crate::{Error, ErrorKind, Result};

/// Most surfaces that a description with groups has, those of groups and those that were removed among them. Groups of groups of groups
/// would otherwise have as many as a short file asks for.
pub const MAX_PLACED_SURFACES: usize = 1 << 22;

/// Bytes that a path of a placed surface takes, as a rule, and what an allocation takes besides.
const BYTES_OF_A_PATH: usize = 96;

/// Surfaces that are placed together.
#[derive(Clone, Debug)]
pub struct GroupDesc {
    /// JSON path, for messages.
    pub path: String,
    /// What placements call it; empty where it has no name.
    pub name: String,
    /// The surfaces, none where the group was removed. Their [`transform`](SurfaceDesc::transform) leads to the frame of the group. No
    /// ray meets them here.
    pub members: Vec<SurfaceDesc>,
}

/// A group at one place: the surfaces of a scene that are copies of the group's members.
#[derive(Clone, Debug)]
pub struct PlacementDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Index into [`SceneDesc::groups`].
    pub group: usize,
    /// The surfaces, in the order of the group's members: indices into [`SceneDesc::surfaces`].
    pub surfaces: Range<usize>,
    /// From the group's frame to the world, invertible. Each surface has the product of this transform and that of its member.
    pub transform: DAffine3,
    /// Whether the placement was removed, and its surfaces with it.
    pub hidden: bool,
}

/// Calls that make groups and place them.
impl SceneDesc {
    /// Makes a group of copies of these surfaces, as they are at this moment, and returns its number. The frame of the group is the
    /// world's. The surfaces themselves stay what they are; those that were only made for the group can be removed. A group with an
    /// empty `name` has no name.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `groups[..]`: `.name` if it is taken or has a NUL, `.surfaces` for no surface; at `surfaces[..]`
    /// for a number that no surface has or that belongs to a removed surface; [`ErrorKind::Unsupported`] at
    /// `surfaces[..].motion` for a surface that moves, other than by the steps of its mesh, and at `groups[..]` for more than [`MAX_PLACED_SURFACES`]
    /// surfaces; [`ErrorKind::OutOfMemory`].
    pub fn add_group(&mut self, name: &str, surfaces: &[usize]) -> Result<usize> {
        let path = format!("groups[{}]", self.groups.len());
        self.check_group_name(&path, name)?;
        for number in surfaces {
            let path = &self.live_surface(*number)?.path;
            check_rests(path, self.motion.surfaces.contains_key(number))?;
        }
        self.check_count(&path, surfaces.len())?;
        let mut members = with_room(surfaces.len())?;
        for (member, number) in surfaces.iter().enumerate() {
            let surface = &self.surfaces[*number];
            check_room(surface.name.len() + BYTES_OF_A_PATH)?;
            members.push(SurfaceDesc { path: format!("{path}.surfaces[{member}]"), ..surface.clone() });
        }
        self.put_group(path, name.to_owned(), members)
    }

    /// Places a group: adds a copy of each of its surfaces and returns the number of the placement, whose
    /// [`surfaces`](PlacementDesc::surfaces) are those copies. Each is a surface like any other, which may be given another material,
    /// moved or removed. `transform` is from the group's frame to the world.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `placements[..]` for a number that no group has or that belongs to a removed group, and at its
    /// `.transform` for one that is not invertible; for each surface the errors of [`Self::set_transform`];
    /// [`ErrorKind::Unsupported`] for more than [`MAX_PLACED_SURFACES`] surfaces; [`ErrorKind::OutOfMemory`].
    pub fn place_group(&mut self, group: usize, transform: DAffine3) -> Result<usize> {
        let path = format!("placements[{}]", self.placements.len());
        let first = self.surfaces.len();
        self.put_placement(path, group, transform, |member| format!("surfaces[{}]", first + member))
    }

    /// Moves a placement as a whole. Surfaces of it that were moved by themselves are moved back to their places in the group; those that
    /// were removed stay removed.
    ///
    /// # Errors
    /// The errors of [`Self::place_group`] at the placement and its surfaces, and an error for a number that no placement has or that
    /// belongs to a removed placement.
    pub fn set_placement_transform(&mut self, placement: usize, transform: DAffine3) -> Result<()> {
        let PlacementDesc { path, group, surfaces, .. } = self.live_placement(placement)?.clone();
        validate::invertible(&join(&path, "transform"), &transform)?;
        let group = Arc::clone(&self.groups[group]);
        let placed = |member: &SurfaceDesc| transform * member.transform;
        for (number, member) in surfaces.clone().zip(&group.members) {
            if !self.surfaces[number].hidden {
                self.check_move(number, &placed(member))?;
            }
        }
        for (number, member) in surfaces.zip(&group.members) {
            self.surfaces[number].transform = placed(member);
        }
        self.placements[placement].transform = transform;
        Ok(())
    }

    /// Sets the motion of all surfaces of a placement, which they make as one, or removes it.
    ///
    /// # Errors
    /// The errors of [`Self::set_surface_motion`], at the placement, and an error for a number that no placement has or that belongs to a
    /// removed placement.
    pub fn set_placement_motion(&mut self, placement: usize, motion: Option<MotionDesc>) -> Result<()> {
        let known = self.live_placement(placement)?;
        if let Some(motion) = &motion {
            motion.check(&join(&known.path, "motion"))?;
        }
        let motion = motion.map(Arc::new);
        for number in known.surfaces.clone().filter(|number| !self.surfaces[*number].hidden) {
            match &motion {
                Some(motion) => self.motion.surfaces.insert(number, Arc::clone(motion)),
                None => self.motion.surfaces.remove(&number),
            };
        }
        Ok(())
    }

    /// Removes a placement permanently, with its surfaces. No other number changes.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for a number that no placement has or that belongs to a removed placement.
    pub fn remove_placement(&mut self, placement: usize) -> Result<()> {
        let surfaces = self.live_placement(placement)?.surfaces.clone();
        for number in surfaces {
            self.surfaces[number].hidden = true;
            self.motion.surfaces.remove(&number);
        }
        self.placements[placement].hidden = true;
        Ok(())
    }

    /// Removes a group that is placed nowhere any more, and what it keeps of its surfaces. Its name may be used again; its number is not used
    /// again.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] at `groups[..]` while the group is placed, and for a number that no group has or that belongs to a
    /// removed group.
    pub fn remove_group(&mut self, group: usize) -> Result<()> {
        let path = format!("groups[{group}]");
        let known = Arc::clone(self.live_group(&path, group)?);
        if let Some(user) = self.placements.iter().find(|it| it.group == group && !it.hidden) {
            let message = format!("{} places the group, expected one that is not placed", user.path);
            return Err(Error::invalid(path, message));
        }
        self.index.forget_group(group, &known.name, known.members.len());
        self.groups[group] = Arc::new(GroupDesc { path, name: String::new(), members: Vec::new() });
        Ok(())
    }

    /// Returns the number of the group to which a file or a call gave this name.
    pub fn find_group(&self, name: &str) -> Option<usize> {
        self.index.groups.get(name).copied().filter(|number| *number < self.groups.len())
    }

    /// Checks that a group can have this name.
    pub(super) fn check_group_name(&self, path: &str, name: &str) -> Result<()> {
        if name.contains('\0') {
            return Err(Error::invalid(join(path, "name"), "the name has a NUL, which ends a name in C"));
        }
        if self.find_group(name).is_some() {
            return Err(Error::invalid(
                join(path, "name"),
                format!("the group name '{}' is given twice", elided(name)),
            ));
        }
        Ok(())
    }

    /// Makes a group of surfaces that the description has from `first` on, which are taken out of it with all placements among them.
    pub(super) fn gather_group(&mut self, path: &str, name: String, first: [usize; 2]) -> Result<usize> {
        let [first, first_placement] = first;
        if let Some((number, _)) = self.motion.surfaces.range(first..).next() {
            let placed = self.placements[first_placement..].iter().find(|it| it.surfaces.contains(number));
            check_rests(placed.map_or(&self.surfaces[*number].path, |it| &it.path), true)?;
        }
        self.placements.truncate(first_placement);
        let members = self.surfaces.split_off(first);
        self.index.forget_surfaces(first);
        self.put_group(path.to_owned(), name, members)
    }

    fn put_group(&mut self, path: String, name: String, members: Vec<SurfaceDesc>) -> Result<usize> {
        if members.is_empty() {
            return Err(Error::invalid(join(&path, "surfaces"), "the group is empty, expected one surface at least"));
        }
        let number = self.groups.len();
        if !name.is_empty() {
            self.index.groups.insert(name.clone(), number);
        }
        self.index.grouped += members.len();
        let members = members.into_iter().map(in_written_frame).collect();
        self.groups.push(Arc::new(GroupDesc { path, name, members }));
        Ok(number)
    }

    /// Places a group, whose surfaces have these paths.
    pub(super) fn put_placement(
        &mut self,
        path: String,
        group: usize,
        transform: DAffine3,
        path_of: impl Fn(usize) -> String,
    ) -> Result<usize> {
        let known = Arc::clone(self.live_group(&path, group)?);
        validate::invertible(&join(&path, "transform"), &transform)?;
        let first = self.surfaces.len();
        let surfaces = first..first.saturating_add(known.members.len());
        self.check_count(&path, known.members.len())?;
        check_room_of_copies(&known.members)?;
        for (number, member) in known.members.iter().enumerate() {
            let path = path_of(number);
            let placed = SurfaceDesc { path, transform: transform * member.transform, ..member.clone() };
            if let Err(error) = self.check_surface(&placed) {
                self.surfaces.truncate(first);
                return Err(error);
            }
            self.surfaces.push(placed);
        }
        self.index.see(&self.surfaces);
        self.placements.push(PlacementDesc { path, group, surfaces, transform, hidden: false });
        Ok(self.placements.len() - 1)
    }

    /// Checks that the description can have so many surfaces more.
    fn check_count(&self, path: &str, count: usize) -> Result<()> {
        if self.surfaces.len().saturating_add(self.index.grouped).saturating_add(count) > MAX_PLACED_SURFACES {
            let message = format!(
                "with it the scene and its groups would have more than {MAX_PLACED_SURFACES} surfaces, expected fewer"
            );
            return Err(Error::new(ErrorKind::Unsupported, message).at(path));
        }
        Ok(())
    }

    /// Checks a surface that is a copy of another one: that its mesh is there, that its place is one, and that it may emit there.
    fn check_surface(&mut self, surface: &SurfaceDesc) -> Result<()> {
        let SurfaceDesc { path, shape, local, transform, material, emission, .. } = surface;
        if let ShapeDesc::Mesh { mesh, .. } = *shape {
            self.usable_mesh(&join(path, "mesh"), mesh)?;
        }
        self.check_place(path, shape, local, transform)?;
        self.check_look(path, *emission, *material, shape, &(*transform * *local))
    }

    /// Returns a placement, or an error if it does not exist or was removed.
    pub(super) fn live_placement(&self, placement: usize) -> Result<&PlacementDesc> {
        let path = || format!("placements[{placement}]");
        let known = self
            .placements
            .get(placement)
            .ok_or_else(|| none_such(&path(), "placement", placement, self.placements.len()))?;
        if known.hidden {
            return Err(Error::invalid(&known.path, format!("placement {placement} was removed")));
        }
        // A description that was put together by hand may have any numbers.
        let members = self.groups.get(known.group).map(|group| group.members.len());
        if members != Some(known.surfaces.len()) || known.surfaces.end > self.surfaces.len() {
            let message = format!("placement {placement} is not one of a group of this description");
            return Err(Error::invalid(&known.path, message));
        }
        Ok(known)
    }

    /// The surfaces that groups keep.
    pub(super) fn members(&self) -> impl Iterator<Item = &SurfaceDesc> {
        self.groups.iter().flat_map(|group| &group.members)
    }

    /// The path of a group that has a member with this mesh.
    pub(super) fn group_with_mesh(&self, mesh: usize) -> Option<&str> {
        let uses = |group: &&Arc<GroupDesc>| group.members.iter().any(|member| has_mesh(member, mesh));
        self.groups.iter().find(uses).map(|group| group.path.as_str())
    }

    /// Returns a group, or an error if it does not exist or was removed. `path` is where its number is used.
    fn live_group(&self, path: &str, group: usize) -> Result<&Arc<GroupDesc>> {
        let known = self.groups.get(group).ok_or_else(|| none_such(path, "group", group, self.groups.len()))?;
        if known.members.is_empty() {
            return Err(Error::invalid(path, format!("group {group} was removed")));
        }
        Ok(known)
    }
}

/// Whether a surface shows this mesh.
pub(super) fn has_mesh(surface: &SurfaceDesc, mesh: usize) -> bool {
    matches!(surface.shape, ShapeDesc::Mesh { mesh: own, .. } if own == mesh)
}

/// The same surface in a frame that scene files can give: a frame of its shape that no key can say becomes a part of its transform. So the
/// surfaces of a placement are the same, to the last bit, once the group was written and read again.
fn in_written_frame(member: SurfaceDesc) -> SurfaceDesc {
    if surface::keeps_frame(&member) {
        return member;
    }
    let inverse = member.local.matrix3.inverse();
    let turned = |web: Arc<AreaWebDesc>| Arc::new(AreaWebDesc { c0: inverse * web.c0, ..AreaWebDesc::clone(&web) });
    let transform = member.to_world();
    SurfaceDesc { local: DAffine3::IDENTITY, transform, web: member.web.map(turned), ..member }
}

/// Fails where there is no room for copies of these surfaces, with their names and paths, which are asked for in small parts later.
fn check_room_of_copies(members: &[SurfaceDesc]) -> Result<()> {
    let bytes = members.iter().map(|member| size_of::<SurfaceDesc>() + member.name.len() + BYTES_OF_A_PATH);
    check_room(bytes.fold(0, usize::saturating_add))
}

/// Refuses a surface of a group that moves by itself.
fn check_rests(path: &str, moves: bool) -> Result<()> {
    if moves {
        let message =
            "the surfaces of a group rest in its frame, expected a motion of the whole group where it is placed";
        return Err(Error::new(ErrorKind::Unsupported, message).at(join(path, "motion")));
    }
    Ok(())
}
