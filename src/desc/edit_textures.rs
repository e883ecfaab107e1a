//! Calls that add and change textures of a description.

use std::sync::Arc;

use super::json::{elided, join};
use super::{SceneDesc, TextureBinding, TextureDesc, TextureKey, TextureSource, material_check, texture_check};
use crate::{Error, Result};

impl SceneDesc {
    /// Adds a named texture and returns its number. The path of the description is not read.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `textures[..]` for a name given twice or a number out of range.
    pub fn add_texture(&mut self, texture: TextureDesc) -> Result<usize> {
        let texture = TextureDesc { path: format!("textures[{}]", self.textures.len()), ..texture };
        texture_check::texture(&texture)?;
        self.put_texture(texture)
    }

    /// Changes all of a texture but its name: the materials that it varies see the new one. Only this texture is prepared again
    /// when the scene is rebuilt.
    ///
    /// # Errors
    /// Those of [`Self::add_texture`], and an error at `textures[..]` for a number that no texture has. The description is then as it was.
    pub fn set_texture(&mut self, texture: usize, to: TextureDesc) -> Result<()> {
        let count = self.textures.len();
        let Some(known) = self.textures.get(texture) else {
            let message = format!("there is no texture {texture}, the scene has {count}");
            return Err(Error::invalid(format!("textures[{texture}]"), message));
        };
        let to = TextureDesc { name: known.name.clone(), path: known.path.clone(), ..to };
        texture_check::texture(&to)?;
        let before = std::mem::replace(&mut self.textures[texture], Arc::new(to));
        // What a parameter may take depends on the texture.
        let mut users = self.materials.iter().enumerate();
        let checked =
            users.try_for_each(|(i, user)| texture_check::bindings(user, &self.textures, &self.materials[..i]));
        let checked =
            checked.and_then(|()| match self.environment.as_ref().filter(|environment| environment.map().is_some()) {
                Some(environment) => texture_check::environment(environment, &self.textures),
                None => Ok(()),
            });
        let checked = checked.and_then(|()| self.backplate.map_or(Ok(()), |backplate| backplate.check(&self.textures)));
        if checked.is_err() {
            self.textures[texture] = before;
        }
        checked
    }

    /// Takes note that the program has changed texels that lie in its own memory ([`crate::texture::Texels`] of a foreign buffer):
    /// this texture alone is prepared again when the scene is rebuilt.
    ///
    /// # Errors
    /// An error at `textures[..]` for a number that no texture has, for a pattern, and for a texel that is not finite.
    pub fn update_texture(&mut self, texture: usize) -> Result<()> {
        let count = self.textures.len();
        let Some(known) = self.textures.get(texture) else {
            let message = format!("there is no texture {texture}, the scene has {count}");
            return Err(Error::invalid(format!("textures[{texture}]"), message));
        };
        let TextureSource::Image(image) = &known.source else {
            return Err(Error::invalid(&known.path, "a pattern has no texels that change"));
        };
        // Another `Arc` is another image: what was prepared for the old one is not used again.
        let changed = image.image.changed().map_err(|message| Error::invalid(&known.path, message))?;
        let source = TextureSource::Image(super::ImageTextureDesc { image: Arc::new(changed), ..image.clone() });
        self.textures[texture] = Arc::new(TextureDesc { source, ..TextureDesc::clone(known) });
        Ok(())
    }

    /// Sets the texture of one parameter of a material; `None` removes it.
    ///
    /// # Errors
    /// Those of [`Self::set_material_textures`].
    pub fn set_material_texture(&mut self, material: usize, key: TextureKey, to: Option<TextureBinding>) -> Result<()> {
        let known = self.materials.get(material).map(|material| material.textures.clone()).unwrap_or_default();
        let others = known.into_iter().filter(|binding| binding.key != key);
        self.set_material_textures(material, others.chain(to).collect())
    }

    /// Sets all textures of a material.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `materials[..].textures` for a parameter that this material does not have or that has two
    /// textures, and for a texture that does not exist. The description is then as it was.
    pub fn set_material_textures(&mut self, material: usize, textures: Vec<TextureBinding>) -> Result<()> {
        let count = self.materials.len();
        let Some(known) = self.materials.get(material) else {
            let message = format!("there is no material {material}, the scene has {count}");
            return Err(Error::invalid(format!("materials[{material}]"), message));
        };
        let to = super::MaterialDesc { textures, ..known.clone() };
        self.set_material_desc(material, to)
    }

    /// Returns the number of the texture to which a file or a call gave this name.
    pub fn find_texture(&self, name: &str) -> Option<usize> {
        self.index.textures.get(name).copied().filter(|number| *number < self.textures.len())
    }

    /// Adds a texture whose numbers have been checked.
    pub(super) fn put_texture(&mut self, texture: TextureDesc) -> Result<usize> {
        if !texture.name.is_empty() && self.find_texture(&texture.name).is_some() {
            let message = format!("the texture name '{}' is given twice", elided(&texture.name));
            return Err(Error::invalid(join(&texture.path, "name"), message));
        }
        let number = self.textures.len();
        if !texture.name.is_empty() {
            self.index.textures.insert(texture.name.clone(), number);
        }
        self.textures.push(Arc::new(texture));
        Ok(number)
    }

    /// Checks the textures of all materials, of the environment and of the backplate, for a description that is put together by hand.
    pub(crate) fn check_textures(&self) -> Result<()> {
        let map = self.environment.as_ref().filter(|environment| environment.map().is_some());
        if let Some(backplate) = &self.backplate {
            backplate.check(&self.textures)?;
        }
        let shows_texture = map.is_some() || self.backplate.is_some_and(|backplate| backplate.texture.is_some());
        if !shows_texture && self.materials.iter().all(|material| material.textures.is_empty()) {
            return Ok(());
        }
        if let Some(environment) = map {
            texture_check::environment(environment, &self.textures)?;
        }
        for texture in &self.textures {
            texture_check::texture(texture)?;
        }
        // All of them, since a part that comes after the whole would have no end.
        for (i, material) in self.materials.iter().enumerate() {
            material_check::check(&mut material.clone(), &self.materials[..i])?;
            texture_check::bindings(material, &self.textures, &self.materials[..i])?;
        }
        Ok(())
    }
}
