//! The index of a description: tables by which its calls find elements without searching the whole scene.

use std::collections::BTreeMap;
use std::sync::{Arc, Weak};

use super::object::{MeshDesc, ShapeDesc};
use super::surfaces::Surfaces;
use crate::math::Bounds;

/// Names, extents of meshes and users of meshes. The readers and the calls keep them beside the lists of a
/// [`super::SceneDesc`].
///
/// A description that is put together by hand starts with the default index. Elements that are put into its lists by
/// hand have no name here, so the calls neither find such an element by name nor refuse a second element of that name.
#[derive(Clone, Debug, Default)]
pub struct SceneIndex {
    /// Numbers of the named materials.
    pub(super) materials: BTreeMap<String, usize>,
    /// Numbers of the named textures.
    pub(super) textures: BTreeMap<String, usize>,
    /// Numbers of the named groups.
    pub(super) groups: BTreeMap<String, usize>,
    /// The number of surfaces of all groups.
    pub(super) grouped: usize,
    /// Numbers of the named meshes. Several names may refer to one mesh.
    pub(super) meshes: BTreeMap<String, usize>,
    /// The extent of each mesh that was queried, with the data that it was computed from. A mesh that was replaced by
    /// hand is measured again.
    extents: BTreeMap<usize, (Weak<MeshDesc>, Bounds)>,
    /// The surfaces that were made with each mesh. Some of them may be hidden by now.
    uses: BTreeMap<usize, Vec<usize>>,
    /// The number of surfaces that `uses` covers.
    seen: usize,
}

impl SceneIndex {
    /// Records the bounding box of a mesh.
    pub(super) fn measured(&mut self, number: usize, mesh: &Arc<MeshDesc>, extent: Bounds) {
        self.extents.insert(number, (Arc::downgrade(mesh), extent));
    }

    /// Returns the bounding box of a mesh in its own frame. The box is computed once for each mesh.
    pub(super) fn extent(&mut self, number: usize, mesh: &Arc<MeshDesc>) -> Bounds {
        self.known_extent(number, mesh).unwrap_or_else(|| {
            let extent = mesh.bounds();
            self.measured(number, mesh, extent);
            extent
        })
    }

    /// The bounding box of a mesh, if it was recorded.
    pub(super) fn known_extent(&self, number: usize, mesh: &Arc<MeshDesc>) -> Option<Bounds> {
        let (known, extent) = self.extents.get(&number)?;
        std::ptr::eq(known.as_ptr(), Arc::as_ptr(mesh)).then_some(*extent)
    }

    /// Records the surfaces that were added since the last call.
    pub(super) fn see(&mut self, surfaces: &Surfaces) {
        if self.seen > surfaces.len() {
            self.uses.clear();
            self.seen = 0;
        }
        for (number, surface) in surfaces.iter().enumerate().skip(self.seen) {
            if let ShapeDesc::Mesh { mesh, .. } = surface.shape {
                self.uses.entry(mesh).or_default().push(number);
            }
        }
        self.seen = surfaces.len();
    }

    /// Forgets the surfaces from `first` on, which were taken out of the description.
    pub(super) fn forget_surfaces(&mut self, first: usize) {
        if self.seen > first {
            self.uses.values_mut().for_each(|users| users.retain(|number| *number < first));
            self.seen = first;
        }
    }

    /// Removes a group of so many surfaces and its name from the index.
    pub(super) fn forget_group(&mut self, group: usize, name: &str, count: usize) {
        self.grouped = self.grouped.saturating_sub(count);
        if self.groups.get(name) == Some(&group) {
            self.groups.remove(name);
        }
    }

    /// Returns the surfaces that use a mesh, in order.
    pub(super) fn users(&mut self, mesh: usize, surfaces: &Surfaces) -> Vec<usize> {
        self.see(surfaces);
        let shows = |number: &usize| {
            surfaces.get(*number).is_some_and(|surface| {
                !surface.hidden && matches!(surface.shape, ShapeDesc::Mesh { mesh: used, .. } if used == mesh)
            })
        };
        self.uses.get(&mesh).into_iter().flatten().copied().filter(shows).collect()
    }

    /// Replaces the recorded users of a mesh by these.
    pub(super) fn keep_users(&mut self, mesh: usize, users: Vec<usize>) {
        self.uses.insert(mesh, users);
    }

    /// Makes a mesh known by a name, unless the name is empty.
    pub(super) fn name_mesh(&mut self, name: String, mesh: usize) {
        if !name.is_empty() {
            self.meshes.insert(name, mesh);
        }
    }

    /// Removes a mesh and its name from the index.
    pub(super) fn forget_mesh(&mut self, mesh: usize, name: &str) {
        self.extents.remove(&mesh);
        self.uses.remove(&mesh);
        if self.meshes.get(name) == Some(&mesh) {
            self.meshes.remove(name);
        }
    }
}
