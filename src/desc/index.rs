//! What the calls of a description look up, so that none of them has to search the whole scene.

use std::collections::BTreeMap;
use std::sync::{Arc, Weak};

use super::object::{MeshDesc, ShapeDesc, SurfaceDesc};
use crate::math::Bounds;

/// Names, extents of meshes and who uses them, kept beside the lists of a [`super::SceneDesc`] by the readers and the
/// calls.
///
/// A description put together by hand starts with the default. What is put into its lists by hand has no name here, so
/// the calls neither find it by name nor refuse a second one of that name.
#[derive(Clone, Debug, Default)]
pub struct SceneIndex {
    /// Numbers of the named materials.
    pub(super) materials: BTreeMap<String, usize>,
    /// Numbers of the named meshes; several names may mean one mesh.
    pub(super) meshes: BTreeMap<String, usize>,
    /// The material of surfaces without one.
    pub(super) black: Option<usize>,
    /// Extent of each mesh that was asked for, and of which data: a mesh replaced by hand is measured again.
    extents: BTreeMap<usize, (Weak<MeshDesc>, Bounds)>,
    /// The surfaces that were made with each mesh; some may be hidden by now.
    uses: BTreeMap<usize, Vec<usize>>,
    /// How many surfaces `uses` knows.
    seen: usize,
}

impl SceneIndex {
    /// Takes note of the box around a mesh.
    pub(super) fn measured(&mut self, number: usize, mesh: &Arc<MeshDesc>, extent: Bounds) {
        self.extents.insert(number, (Arc::downgrade(mesh), extent));
    }

    /// Box around a mesh in its own frame, computed once for each mesh.
    pub(super) fn extent(&mut self, number: usize, mesh: &Arc<MeshDesc>) -> Bounds {
        match self.extents.get(&number) {
            Some((known, extent)) if std::ptr::eq(known.as_ptr(), Arc::as_ptr(mesh)) => *extent,
            _ => {
                let extent = mesh.bounds();
                self.measured(number, mesh, extent);
                extent
            }
        }
    }

    /// Takes note of the surfaces that came since the last time.
    pub(super) fn see(&mut self, surfaces: &[SurfaceDesc]) {
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

    /// The surfaces that show a mesh, in order.
    pub(super) fn users(&mut self, mesh: usize, surfaces: &[SurfaceDesc]) -> Vec<usize> {
        self.see(surfaces);
        let shows = |number: &usize| {
            surfaces.get(*number).is_some_and(|surface| {
                !surface.hidden && matches!(surface.shape, ShapeDesc::Mesh { mesh: used, .. } if used == mesh)
            })
        };
        self.uses.get(&mesh).into_iter().flatten().copied().filter(shows).collect()
    }

    /// Keeps these users of a mesh only.
    pub(super) fn keep_users(&mut self, mesh: usize, users: Vec<usize>) {
        self.uses.insert(mesh, users);
    }

    /// Lets a mesh be found by a name, unless that is empty.
    pub(super) fn name_mesh(&mut self, name: String, mesh: usize) {
        if !name.is_empty() {
            self.meshes.insert(name, mesh);
        }
    }

    /// Forgets a mesh and its name.
    pub(super) fn forget_mesh(&mut self, mesh: usize, name: &str) {
        self.extents.remove(&mesh);
        self.uses.remove(&mesh);
        if self.meshes.get(name) == Some(&mesh) {
            self.meshes.remove(name);
        }
    }
}
