//! Flat surfaces that shine as a photometric web says.

use std::sync::Arc;

use super::json::join;
use super::{SceneDesc, ShapeDesc, WebDesc, validate};
use crate::math::DVec3;
use crate::photometry::Web;
use crate::spectrum::Rgb;
use crate::{Error, ErrorKind, Result};

/// The photometric web of a flat surface, and how it is turned. The lamp's axis, gamma = 0, is the normal of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaWebDesc {
    /// The intensities, which the whole surface has from afar.
    pub web: Arc<Web>,
    /// The direction of C = 0 in the object's frame, of any length but 0. Its part along the surface counts; where there is none, some
    /// direction is taken. C grows counter-clockwise as seen along the normal, also where the transform is a mirror.
    pub c0: DVec3,
    /// Degrees by which the luminaire is tilted from straight down, as [`WebDesc::tilt_deg`].
    pub tilt_deg: f64,
}

impl AreaWebDesc {
    /// A web with C = 0 towards +x.
    pub fn new(web: Arc<Web>) -> Self {
        Self { web, c0: DVec3::X, tilt_deg: 0.0 }
    }

    /// The factor on the intensities by the lamp's tilt, 0 beyond the angles that the file has.
    pub fn tilt_factor(&self) -> f64 {
        self.web.tilt_factor(self.tilt_deg).unwrap_or(0.0)
    }

    /// Checks that a surface of this shape can have the web, times `factor`. `path` is that of the surface.
    ///
    /// # Errors
    /// Those of [`SceneDesc::set_surface_web`].
    pub(crate) fn check(&self, path: &str, shape: &ShapeDesc, factor: Rgb, emits_both: bool) -> Result<()> {
        let at = join(path, "web");
        let what = match shape {
            ShapeDesc::Triangle(_) | ShapeDesc::Quad(_) | ShapeDesc::Mesh { .. } | ShapeDesc::Disk { .. } => None,
            ShapeDesc::Sphere { .. } => Some("a sphere"),
            ShapeDesc::Quadric { .. } => Some("a quadric"),
        };
        if let Some(what) = what {
            let message = format!(
                "a photometric web needs a flat surface, and {what} is none, expected a triangle, quad, disk or flat mesh"
            );
            return Err(Error::new(ErrorKind::Unsupported, message).at(at));
        }
        let turned = WebDesc { c0: self.c0, tilt_deg: self.tilt_deg, ..WebDesc::new(Arc::clone(&self.web)) };
        validate::web(&at, &turned, factor)?;
        let behind = match emits_both {
            true => None,
            false => self.web.side(false),
        };
        if let Some(behind) = behind {
            let message = format!(
                "the lamp sends {:.4} of its {:.4} lm behind the surface, expected a file without light beyond 90 degrees, or \
                 a surface with `emits` 'both'",
                behind.flux(),
                self.web.flux()
            );
            return Err(Error::invalid(at, message));
        }
        Ok(())
    }
}

impl SceneDesc {
    /// Lets a flat surface shine as a photometric web says, or evenly again. With a web, the emission of the surface is a factor on the
    /// file's candela over 683 lm/W, 1 in each channel for the lamp as it was measured, and no radiance. What the file has beyond 90
    /// degrees from the normal leaves on the surface's other side.
    ///
    /// The web has no effect on a surface without an emission of its own. A surface keeps it when its emission changes.
    ///
    /// # Errors
    /// [`ErrorKind::Unsupported`] at `surfaces[..].web` for a shape that is not flat; [`ErrorKind::InvalidScene`] at `.web` for a file
    /// with light beyond 90 degrees on a surface that does not [emit on both sides](Self::set_emits_both), at `.web.c0`, `.web.tilt` or
    /// `.web.color` for a number out of range, and for a number that no surface has or that belongs to a removed surface. Whether a mesh
    /// is flat is checked when the scene is built, and so is what moves, and textures of emission, which a surface with a web cannot
    /// have.
    pub fn set_surface_web(&mut self, surface: usize, web: Option<AreaWebDesc>) -> Result<()> {
        let known = self.live_surface(surface)?;
        if let Some(web) = &web {
            web.check(&known.path, &known.shape, known.emission.unwrap_or(Rgb::ZERO), known.emits_both)?;
        }
        self.surfaces[surface].web = web.map(Arc::new);
        Ok(())
    }
}
