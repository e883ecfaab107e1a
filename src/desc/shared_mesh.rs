//! Meshes that several descriptions have in common.

use std::sync::Arc;

use super::{MeshDesc, MeshStep, SceneDesc};
use crate::Result;
use crate::math::Bounds;

/// A mesh of a description, to be added to others without a copy of its arrays, with the steps in which it deforms.
///
/// It keeps the arrays alive, those of a host too, as each description that has the mesh does.
#[derive(Clone, Debug)]
pub struct SharedMesh {
    mesh: Arc<MeshDesc>,
    steps: Option<Arc<[MeshStep]>>,
    /// Its box, where the description has measured it.
    extent: Option<Bounds>,
}

impl SharedMesh {
    /// The mesh itself, the same object in all descriptions that have it. Its path and name are those of the first of them.
    pub fn mesh(&self) -> &Arc<MeshDesc> {
        &self.mesh
    }
}

impl SceneDesc {
    /// A mesh of this description, for [`Self::add_shared_mesh`] of another one, or of this one for other steps. It takes the same time
    /// however large the mesh is.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..]` for a number that no mesh has or that belongs to a removed mesh.
    pub fn shared_mesh(&self, mesh: usize) -> Result<SharedMesh> {
        self.usable_mesh(&format!("meshes[{mesh}]"), mesh)?;
        let (known, steps) = (&self.meshes[mesh], self.motion.meshes.get(&mesh));
        Ok(SharedMesh {
            mesh: Arc::clone(known),
            steps: steps.map(Arc::clone),
            extent: self.index.known_extent(mesh, known),
        })
    }

    /// Adds a mesh that another description has, and returns its number here. Arrays and steps are shared, not copied; a later change of
    /// the mesh in one description is none in the others. Each scene that is built has hierarchies and placed vertices of its own. A mesh
    /// with an empty `name` has no name. Messages about the arrays name the mesh as the first description does.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..].name` for a name that is taken.
    pub fn add_shared_mesh(&mut self, name: &str, shared: &SharedMesh) -> Result<usize> {
        let number = self.meshes.len();
        if !name.is_empty() {
            self.check_mesh_name(&format!("meshes[{number}]"), name)?;
        }
        let extent = shared.extent.unwrap_or_else(|| shared.mesh.bounds());
        self.index.measured(number, &shared.mesh, extent);
        self.meshes.push(Arc::clone(&shared.mesh));
        if let Some(steps) = &shared.steps {
            self.motion.meshes.insert(number, Arc::clone(steps));
        }
        self.index.name_mesh(name.to_owned(), number);
        Ok(number)
    }
}
