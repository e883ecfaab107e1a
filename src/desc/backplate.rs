//! The picture behind everything.

use std::sync::Arc;

use super::json::{elided, join};
use super::{SceneDesc, TextureDesc, TextureMapping, validate};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The key of a scene file, and the path of messages.
pub(super) const PATH: &str = "backplate";

/// A picture that the camera sees behind everything, in place of what comes from infinity. It lights nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BackplateDesc {
    /// Radiance [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one.
    pub radiance: Rgb,
    /// Number of the texture that is spread over the whole picture: u from 0 at the left edge to 1 at the right one, v from 0 at the
    /// lower edge to 1 at the upper one. `None` for the same radiance everywhere.
    pub texture: Option<usize>,
}

impl BackplateDesc {
    /// The same radiance [W m^-2 sr^-1] everywhere.
    pub fn even(radiance: Rgb) -> Self {
        Self { radiance, texture: None }
    }

    /// The texture with this number, as it is.
    pub fn of_texture(texture: usize) -> Self {
        Self { radiance: Rgb::ONE, texture: Some(texture) }
    }

    /// Checks the radiance and the texture.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `backplate.color[..]` or `backplate.texture`.
    pub(super) fn check(&self, textures: &[Arc<TextureDesc>]) -> Result<()> {
        radiance(self.radiance.to_f64(), 1.0)?;
        let Some(number) = self.texture else { return Ok(()) };
        let at = join(PATH, "texture");
        let Some(texture) = textures.get(number) else {
            let message = format!("texture {number} of {} does not exist", textures.len());
            return Err(Error::invalid(at, message));
        };
        let refused = |what: &str| Err(Error::invalid(&at, format!("the texture '{}' {what}", elided(&texture.name))));
        if texture.vertex_colors {
            return refused("is multiplied by the colours of vertices, which a backplate has not");
        }
        if let TextureMapping::Projected { .. } = texture.mapping {
            return refused("is projected on surfaces, expected the coordinates `uv`");
        }
        Ok(())
    }
}

/// The radiance of a backplate from a colour and its factor.
pub(super) fn radiance(color: impl Into<DVec3>, factor: f64) -> Result<Rgb> {
    let factor = validate::intensity(&join(PATH, "intensity"), factor)?;
    validate::emission(&join(PATH, "color"), color, factor)
}

impl SceneDesc {
    /// Sets the picture that the camera sees behind everything; `None` removes it.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `backplate`: `.color[..]` for a number out of range, or `.texture` for one that does not
    /// exist, that is projected on surfaces or that is multiplied by colours of vertices. The description is then as it was.
    pub fn set_backplate(&mut self, backplate: Option<BackplateDesc>) -> Result<()> {
        if let Some(backplate) = &backplate {
            backplate.check(&self.textures)?;
        }
        self.backplate = backplate;
        Ok(())
    }
}
