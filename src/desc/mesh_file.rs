//! Mesh files that calls add to a description. A file may be read before the description is touched, so that nobody has to wait for it.

use std::path::{Path, PathBuf};

use super::json::join;
use super::read::no_choices;
use super::warnings::warn;
use super::{LoadOptions, MeshDesc, SceneDesc, mesh_files};
use crate::Result;

/// A mesh file whose name and place in a description are checked, and which is still to be read.
#[derive(Clone, Debug)]
pub struct MeshFile {
    name: String,
    file: PathBuf,
    /// Where the description would name the file.
    path: String,
}

/// The mesh of a file, for [`SceneDesc::add_read_mesh`].
#[derive(Clone, Debug)]
pub struct ReadMesh {
    from: MeshFile,
    mesh: MeshDesc,
    /// What was left out of the file.
    warnings: Vec<String>,
}

impl MeshFile {
    /// Reads the file. `options` say how the reading is watched: progress is told by bytes.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Io`] if the file cannot be read; [`crate::ErrorKind::InvalidScene`] for invalid content, with the file and
    /// the line; [`crate::ErrorKind::Unsupported`] for choices that only glTF files have; [`crate::ErrorKind::Cancelled`].
    pub fn read(self, options: &LoadOptions) -> Result<ReadMesh> {
        if options.is_choice() {
            return Err(no_choices(Some(&self.file)));
        }
        options.watch(|work| {
            mesh_files::announce_file(&self.file, work);
            let mut warnings = Vec::new();
            let mesh = mesh_files::load(&self.file, &self.path, false, &mut warnings, work)?;
            Ok(ReadMesh { from: self, mesh, warnings })
        })
    }
}

impl SceneDesc {
    /// Adds the mesh in a Wavefront OBJ, PLY or STL file and returns its number. The file is read at each call; a relative path is
    /// resolved from the process's working directory. A mesh with an empty name has no name. The parts of the file that
    /// are left out are listed in `warnings`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Io`] if the file cannot be read; [`crate::ErrorKind::InvalidScene`] for invalid content,
    /// with the file and the line, and at `meshes[..].name` for a name that is taken.
    pub fn add_mesh_file(&mut self, name: &str, file: &Path) -> Result<usize> {
        self.add_mesh_file_with(name, file, &LoadOptions::default())
    }

    /// Adds the mesh in a file as [`Self::add_mesh_file`] does, with progress, and a cancel that leaves the description as it was.
    ///
    /// # Errors
    /// Those of [`Self::add_mesh_file`] and of [`MeshFile::read`].
    pub fn add_mesh_file_with(&mut self, name: &str, file: &Path, options: &LoadOptions) -> Result<usize> {
        let mesh = self.mesh_file(name, file)?.read(options)?;
        self.add_read_mesh(mesh)
    }

    /// Checks the name of a mesh and that of its file, which can then be read without the description, and added to it by
    /// [`Self::add_read_mesh`].
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..].name` for a name that is taken, and at `meshes[..].file` for one of a file that is
    /// not possible.
    pub fn mesh_file(&self, name: &str, file: &Path) -> Result<MeshFile> {
        let path = format!("meshes[{}]", self.meshes.len());
        if !name.is_empty() {
            self.check_mesh_name(&path, name)?;
        }
        let at = join(&path, "file");
        mesh_files::check_name(&at, file)?;
        Ok(MeshFile { name: name.to_owned(), file: file.to_owned(), path: at })
    }

    /// Adds a mesh that was read from a file, and returns its number. Other meshes may have been added since.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..].name` for a name that was taken meanwhile.
    pub fn add_read_mesh(&mut self, read: ReadMesh) -> Result<usize> {
        let ReadMesh { from: MeshFile { name, file, path: expected }, mesh, warnings } = read;
        let path = format!("meshes[{}]", self.meshes.len());
        if !name.is_empty() {
            self.check_mesh_name(&path, &name)?;
        }
        let at = join(&path, "file");
        for warning in warnings {
            // The mesh may have got another number than the one that it was read for.
            let rest = warning.strip_prefix(&expected).map(|rest| format!("{at}{rest}"));
            warn(&mut self.warnings, rest.unwrap_or(warning));
        }
        self.files.push(file);
        let number = self.put_mesh(MeshDesc { path: at, ..mesh });
        self.index.name_mesh(name, number);
        Ok(number)
    }
}
