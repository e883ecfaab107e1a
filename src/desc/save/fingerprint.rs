//! A number for what a scene holds.

use std::io::{self, Write};

use super::files::WebFiles;
use super::{Names, check, document, ply_write};
use crate::Result;
use crate::desc::{RenderDesc, SceneDesc, TextureSource};
use crate::replace::fnv;
use crate::texture::put_texels;

/// A writer that keeps a hash of what is written.
struct Hasher(u64);

impl Hasher {
    fn new() -> Self {
        Self(fnv::BEGIN)
    }

    fn name(self) -> String {
        format!("{:016x}", self.0)
    }
}

impl Write for Hasher {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = fnv::continued(self.0, bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What a writer that never fails was given.
fn hash(write: impl FnOnce(&mut Hasher) -> io::Result<()>) -> String {
    let mut hasher = Hasher::new();
    // A hasher refuses nothing.
    let _ = write(&mut hasher);
    hasher.name()
}

impl SceneDesc {
    /// A number for all that the scene holds except its render settings and the names of its surfaces: the same for a scene that was read from the same files, and
    /// for one that was read from where [`SceneDesc::save`] has written it. Other scenes have other numbers, but for an accident of
    /// one in 10^19. It takes about as long as to read all meshes and images in memory.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`](crate::ErrorKind::InvalidScene) for a description that the native format cannot have, as
    /// [`SceneDesc::save`] says.
    pub fn fingerprint(&self) -> Result<u64> {
        // Meshes and images are shared, not copied.
        let mut scene = Self {
            render: RenderDesc::default(),
            // The surfaces of placements are among all others.
            groups: Vec::new(),
            placements: Vec::new(),
            ..self.clone()
        };
        // No picture depends on the names of surfaces.
        scene.surfaces.iter_mut().for_each(|surface| surface.name.clear());
        check(&scene)?;
        let images: Vec<String> = scene
            .textures
            .iter()
            .map(|texture| match &texture.source {
                TextureSource::Image(it) => hash(|hasher| put_texels(&it.image, hasher)),
                _ => String::new(),
            })
            .collect();
        let meshes: Vec<String> = scene
            .meshes
            .iter()
            .map(|mesh| match mesh.triangle_count() {
                0 => String::new(),
                _ => hash(|hasher| ply_write::write(mesh, hasher)),
            })
            .collect();
        let webs = WebFiles::named(&scene, |_, web| Ok(hash(|hasher| hasher.write_all(web.text()))))?;
        let mut hasher = Hasher::new();
        document(&scene, &Names::of(&scene), [&images, &meshes], &webs, &mut hasher)?;
        Ok(hasher.0)
    }
}
