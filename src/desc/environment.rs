//! Light from infinity.

use std::f64::consts::PI;

use super::json::join;
use super::{HosekWilkieDesc, SceneDesc, SpectrumDesc, spectrum_edit, texture_check, validate};
use crate::emitter::{FormulaSky, SkyFormula};
use crate::math::{DMat3, DQuat, DVec3};
use crate::shape::Triangle;
use crate::spectrum::Rgb;
use crate::{Error, ErrorKind, Result};

/// Light from infinity, all around the scene. One scene has one at most.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDesc {
    /// JSON path, for messages.
    pub path: String,
    /// Radiance from every direction [W m^-2 sr^-1], each channel >= 0; a factor on the texture's where there is one, and on that
    /// of [`HosekWilkieDesc`]. Of another sky by a formula it is what [`FormulaSkyDesc::is_horizontal`] says.
    pub radiance: Rgb,
    /// What varies the radiance by direction.
    pub sky: SkyDesc,
    /// Whether camera rays that meet nothing show it. Mirrors and glass show it in any case.
    pub visible: bool,
    /// Openings through which it comes into rooms, [`MAX_PORTALS`] at most. They make it found sooner there, and change nothing else.
    pub portals: Vec<PortalDesc>,
    /// The shape of the spectrum, of which renders in wavelengths get the luminance of the radiance, whatever varies it; `None` for the
    /// smooth spectrum of the colour times that of D65. Skies by a formula have none.
    pub spectrum: Option<SpectrumDesc>,
}

/// Most portals of an environment, as each light sample looks at all of them.
pub const MAX_PORTALS: usize = 256;

/// A flat opening such as a window, a triangle or a quadrilateral, world frame. Its sides are alike.
#[derive(Clone, Debug, PartialEq)]
pub struct PortalDesc {
    /// Three or four corners, in order around the edge.
    pub corners: Vec<DVec3>,
}

impl PortalDesc {
    /// The opening in one or two triangles.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.corners.windows(2).skip(1).map(|pair| [self.corners[0], pair[0], pair[1]])
    }

    /// Checks the corners.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `path`.
    fn check(&self, path: &str) -> Result<()> {
        let count = self.corners.len();
        if !(3..=4).contains(&count) {
            return Err(Error::invalid(path, format!("{count} corners; expected 3 or 4")));
        }
        for (place, corner) in self.corners.iter().enumerate() {
            validate::vector(&format!("{path}[{place}]"), *corner)?;
        }
        let has_area =
            |[a, b, c]: [DVec3; 3]| Triangle::new([DVec3::ZERO, b - a, c - a].map(|p| p.as_vec3a())).is_some();
        if !self.triangles().all(has_area) {
            return Err(Error::invalid(path, "the corners have no area between them"));
        }
        Ok(())
    }
}

impl EnvironmentDesc {
    /// An environment that camera rays see, of this radiance [W m^-2 sr^-1] from every direction.
    pub fn even(radiance: Rgb) -> Self {
        Self { path: String::new(), radiance, sky: SkyDesc::Even, visible: true, portals: Vec::new(), spectrum: None }
    }

    /// Refuses a spectrum of a sky that has none.
    pub(super) fn check_spectrum(&self) -> Result<()> {
        if self.spectrum.is_some() && matches!(self.sky, SkyDesc::Formula(_) | SkyDesc::HosekWilkie(_)) {
            let message = "a sky by a formula has no spectrum of its own, expected an even one or one by a texture";
            return Err(Error::new(ErrorKind::Unsupported, message).at(join(&self.path, "spectrum")));
        }
        Ok(())
    }

    /// The texture that varies it.
    pub fn map(&self) -> Option<&EnvironmentMapDesc> {
        match &self.sky {
            SkyDesc::Map(map) => Some(map),
            SkyDesc::Even | SkyDesc::Formula(_) | SkyDesc::HosekWilkie(_) => None,
        }
    }
}

/// How light from infinity varies by direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SkyDesc {
    /// Not at all.
    #[default]
    Even,
    /// By a texture.
    Map(EnvironmentMapDesc),
    /// By a formula of the angles to the zenith and to the sun.
    Formula(FormulaSkyDesc),
    /// The clear sky of Hosek and Wilkie, with its sun.
    HosekWilkie(HosekWilkieDesc),
}

/// A sky by a formula, over a ground. The disk of the sun is a light of its own, [`super::DistantLightDesc`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormulaSkyDesc {
    /// The formula.
    pub formula: SkyFormula,
    /// The direction towards the sun, of any length but 0 and above the horizon.
    pub sun: DVec3,
    /// The direction of the zenith, of any length but 0.
    pub up: DVec3,
    /// Whether the environment's radiance is the irradiance of a horizontal surface by the sky [W m^-2], and not the radiance at the
    /// zenith.
    pub is_horizontal: bool,
    /// The share of that irradiance that the ground sends back evenly from below the horizon, [0, 1] per channel.
    pub ground: Rgb,
}

impl FormulaSkyDesc {
    /// A sky with +y up over a black ground, of this radiance at the zenith.
    pub fn new(formula: SkyFormula, sun: DVec3) -> Self {
        Self { formula, sun, up: DVec3::Y, is_horizontal: false, ground: Rgb::ZERO }
    }

    /// From the frame of the sky, with y up, to the world.
    pub fn to_world(&self) -> DMat3 {
        DMat3::from_quat(y_to(self.up))
    }

    /// The sky of this radiance; `None` where the formula gives no light, or light beyond single precision.
    pub(crate) fn model(&self, radiance: Rgb) -> Option<FormulaSky> {
        let sun = (self.to_world().transpose() * self.sun).normalize_or(DVec3::Y);
        FormulaSky::new(self.formula, sun, radiance, self.is_horizontal, self.ground)
    }
}

/// How the directions of the sphere lie in an image. The image's frame has y up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SkyProjection {
    /// By longitude and latitude. As one sees it from within, u grows to the right and v upwards; v = 1 is up, and the middle of the
    /// image is in the direction -z.
    #[default]
    LatLong,
    /// The faces of an octahedron, unfolded (Cigolle et al. 2014): up is in the middle of a square image, down at its four corners, +x
    /// in the middle of the right edge and -z in that of the upper edge.
    Octahedral,
    /// Six squares, one under another: the faces +x, -x, +y, -y, +z and -z of a cube, each as OpenGL, Vulkan and Direct3D have it
    /// (OpenGL 4.6, table 8.19).
    Cube,
}

/// A texture of all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentMapDesc {
    /// Number of the texture.
    pub texture: usize,
    /// How directions lie in it.
    pub projection: SkyProjection,
    /// The direction of the image's upper edge, of any length. It takes the rest along by the shortest way: with +z up, the middle of
    /// the image is in the direction +y.
    pub up: DVec3,
    /// The degrees by which the image is turned about `up`, counter-clockwise as seen from above.
    pub rotation_deg: f64,
}

impl EnvironmentMapDesc {
    /// A texture by longitude and latitude with +y up.
    pub fn new(texture: usize) -> Self {
        Self { texture, projection: SkyProjection::LatLong, up: DVec3::Y, rotation_deg: 0.0 }
    }

    /// From the frame of the image to the world.
    pub fn to_world(&self) -> DMat3 {
        DMat3::from_quat(y_to(self.up) * DQuat::from_rotation_y(self.rotation_deg.to_radians()))
    }
}

/// The turn of +y to `up` by the shortest way.
pub(super) fn y_to(up: DVec3) -> DQuat {
    let up = up.normalize_or(DVec3::Y);
    if up.y < -1.0 + 1e-12 { DQuat::from_rotation_x(PI) } else { DQuat::from_rotation_arc(DVec3::Y, up) }
}

/// Checks the portals of an environment.
pub(super) fn check_portals(environment: &EnvironmentDesc) -> Result<()> {
    let path = join(&environment.path, "portals");
    let count = environment.portals.len();
    if count > MAX_PORTALS {
        return Err(Error::invalid(path, format!("{count} portals; expected {MAX_PORTALS} at most")));
    }
    let mut all = environment.portals.iter().enumerate();
    all.try_for_each(|(place, portal)| portal.check(&format!("{path}[{place}]")))
}

impl SceneDesc {
    /// Sets the light that comes from infinity, the same from all directions: radiance [W m^-2 sr^-1], each channel >= 0. `None`
    /// removes it. The environment of a file keeps its path.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `environment.color[..]`.
    pub fn set_environment(&mut self, radiance: Option<Rgb>) -> Result<()> {
        let spectrum = self.environment.as_ref().and_then(|known| known.spectrum.clone());
        self.set_environment_desc(radiance.map(|it| EnvironmentDesc { spectrum, ..EnvironmentDesc::even(it) }))
    }

    /// Sets the light that comes from infinity; `None` removes it. The environment of a file keeps its path; that of the description
    /// is not read.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `environment`: `.color[..]`, `.up`, `.rotation`, or `.texture` for one that does not exist, that has not the shape of its projection,
    /// that is projected on surfaces or multiplied by colours of vertices, or an image that is scaled, turned or moved. The description
    /// is then as it was.
    pub fn set_environment_desc(&mut self, environment: Option<EnvironmentDesc>) -> Result<()> {
        let known = self.environment.as_ref();
        let path = known.map_or_else(|| "environment".to_owned(), |known| known.path.clone());
        let mut environment = environment.map(|it| EnvironmentDesc { path, ..it });
        if let Some(environment) = &mut environment {
            texture_check::environment(environment, &self.textures)?;
            check_portals(environment)?;
            environment.check_spectrum()?;
            environment.radiance =
                spectrum_edit::dressed(&environment.path, environment.spectrum.as_ref(), environment.radiance)?;
        }
        self.environment = environment;
        Ok(())
    }

    /// Sets the openings through which the environment comes into rooms; see [`EnvironmentDesc::portals`].
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `environment.portals`: for a scene without an environment, for more than [`MAX_PORTALS`],
    /// for a corner that is no place, or for an opening without an area. The description is then as it was.
    pub fn set_portals(&mut self, portals: Vec<PortalDesc>) -> Result<()> {
        let Some(environment) = &mut self.environment else {
            return Err(Error::invalid("environment.portals", "there is no environment that comes through them"));
        };
        let before = std::mem::replace(&mut environment.portals, portals);
        let checked = check_portals(environment);
        if checked.is_err() {
            environment.portals = before;
        }
        checked
    }
}
