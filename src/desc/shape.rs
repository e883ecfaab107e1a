//! The shapes of the scene format by name, each with its frame and with the checks of its numbers.

use super::json::join;
use super::{ShapeDesc, quadric, validate};
use crate::math::{Bounds, DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// Greatest difference between 1 and the length of a disk's normal.
const UNIT: f64 = 1e-6;

/// Difference between 1 and the length of a vector that was made a unit vector, from rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Constructors for the shapes that the scene format calls by name.
///
/// Each constructor returns a shape and its [`super::SurfaceDesc::local`] frame, both of which are arguments of
/// [`super::SceneDesc::add_surface`]. The results are identical to the last bit to those of the format. Lengths are in
/// scene units, and all numbers must fit single precision. Errors are of kind [`crate::ErrorKind::InvalidScene`] and
/// name the argument as the format does (`radius`, `vertex-2[1]`).
impl ShapeDesc {
    /// Makes a sphere with its normals outwards; `radius` > 0.
    ///
    /// # Errors
    /// At `origin[..]` or `radius`.
    pub fn sphere(centre: DVec3, radius: f64) -> Result<(Self, DAffine3)> {
        checked(Self::Sphere { centre, radius })
    }

    /// Makes a triangle with normal (v1 - v0) x (v2 - v0).
    ///
    /// # Errors
    /// At `vertex-1[..]` to `vertex-3[..]`.
    pub fn triangle(vertices: [DVec3; 3]) -> Result<(Self, DAffine3)> {
        checked(Self::Triangle(vertices))
    }

    /// Makes a flat convex quadrilateral. Its corners are in order around its edge, and its normal is that of its first
    /// three corners.
    ///
    /// # Errors
    /// At `vertex-1` to `vertex-4`, or without a path if the quadrilateral has no area.
    pub fn quad(vertices: [DVec3; 4]) -> Result<(Self, DAffine3)> {
        checked(Self::Quad(vertices))
    }

    /// Makes a flat round disk. `normal` has any length but zero, and `radius` > 0.
    ///
    /// # Errors
    /// At `origin[..]`, `normal` or `radius`.
    pub fn disk(centre: DVec3, normal: DVec3, radius: f64) -> Result<(Self, DAffine3)> {
        let unit = validate::direction("normal", normal)?;
        // A vector that has been made a unit vector before stays as it is.
        let normal = if (normal.length() - 1.0).abs() <= ROUNDING { normal } else { unit };
        checked(Self::Disk { centre, normal, radius })
    }

    /// Makes the quadric a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0 inside a box. Its
    /// normal is the gradient. With `None` for the box, an ellipsoid is bounded by its own extent. A quadric cannot
    /// emit.
    ///
    /// # Errors
    /// At `coefficients[..]` or `clip`, or without a path if there is no box and the quadric is no ellipsoid.
    pub fn quadric(coefficients: [f64; 10], clip: Option<Bounds>) -> Result<(Self, DAffine3)> {
        check_coefficients("", &coefficients)?;
        let clip = match clip {
            Some(clip) => clip,
            None => quadric::closed_bounds(&coefficients).ok_or_else(|| {
                let message = "missing key `clip`: only an ellipsoid ends by itself, and this quadric is none";
                Error::invalid("", message)
            })?,
        };
        checked(Self::Quadric { coefficients, clip })
    }

    /// Makes a tube without caps, with its normals outwards. It extends from the centre `base` of one end along `axis`,
    /// which has any length but zero. `radius` and `height` > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `base`.
    pub fn cylinder(base: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::cylinder(), frame(("base", base), axis, radius, height)?))
    }

    /// Makes a cone without its base disk, with its normals outwards. Its radius is `radius` at `base`, and its apex is
    /// at `height` along `axis`, which has any length but zero. `radius` and `height` > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `base`.
    pub fn cone(base: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::cone(), frame(("base", base), axis, radius, height)?))
    }

    /// Makes a paraboloid of revolution, with its normals away from the axis. It is a bowl that opens from `apex` along
    /// `axis`, which has any length but zero. Its wide end at `height` is open and has the radius `radius`. `radius` and
    /// `height` > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `apex`.
    pub fn paraboloid(apex: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::paraboloid(), frame(("apex", apex), axis, radius, height)?))
    }

    /// Makes an ellipsoid with its normals outwards. `radii` are half its size along x, y and z, each > 0. An ellipsoid
    /// cannot emit; a sphere under a transform can emit, as long as the transform keeps the sphere round.
    ///
    /// # Errors
    /// At `radii[..]` or `origin[..]`.
    pub fn ellipsoid(centre: DVec3, radii: DVec3) -> Result<(Self, DAffine3)> {
        for (i, radius) in radii.to_array().into_iter().enumerate() {
            validate::positive(&format!("radii[{i}]"), radius)?;
        }
        let centre = validate::vector("origin", centre)?;
        Ok((quadric::ball(), DAffine3::from_mat3_translation(DMat3::from_diagonal(radii), centre)))
    }

    /// Whether it is the tube of [`Self::cylinder`].
    pub(crate) fn is_cylinder(&self) -> bool {
        *self == quadric::cylinder()
    }

    /// Whether surfaces of this shape can emit light: of the quadrics, only cylinders can. A sphere can where its transform keeps it
    /// round.
    pub(crate) fn can_emit(&self) -> bool {
        !matches!(self, Self::Quadric { .. }) || self.is_cylinder()
    }

    /// Checks that the format could have given these numbers. The number of a mesh is not checked.
    pub(super) fn check(&self, path: &str) -> Result<()> {
        let at = |key: &str| join(path, key);
        let corners = |vertices: &[DVec3]| {
            let mut numbered = vertices.iter().zip(1..);
            numbered.try_for_each(|(v, i)| validate::vector(&at(&format!("vertex-{i}")), *v).map(|_| ()))
        };
        match self {
            Self::Sphere { centre, radius } => {
                validate::vector(&at("origin"), *centre)?;
                validate::positive(&at("radius"), *radius)?;
            }
            Self::Triangle(vertices) => corners(vertices)?,
            Self::Quad(vertices) => {
                corners(vertices)?;
                validate::quad(path, *vertices)?;
            }
            Self::Mesh { .. } => {}
            Self::Quadric { coefficients, clip } => {
                check_coefficients(path, coefficients)?;
                validate::clip(&at("clip"), clip)?;
            }
            Self::Disk { centre, normal, radius } => {
                validate::vector(&at("origin"), *centre)?;
                validate::direction(&at("normal"), *normal)?;
                if (normal.length() - 1.0).abs() > UNIT {
                    let message = format!("the normal has the length {}, expected a unit vector", normal.length());
                    return Err(Error::invalid(at("normal"), message));
                }
                validate::positive(&at("radius"), *radius)?;
            }
        }
        Ok(())
    }

    /// Returns the box around the shape in its own frame. `mesh_extent` gives the box of a mesh.
    pub(super) fn extent(&self, mesh_extent: impl FnOnce(usize) -> Bounds) -> Bounds {
        match self {
            Self::Sphere { centre, radius } | Self::Disk { centre, radius, .. } => {
                Bounds::around([centre - DVec3::splat(*radius), centre + DVec3::splat(*radius)])
            }
            Self::Triangle(vertices) => Bounds::around(*vertices),
            Self::Quad(vertices) => Bounds::around(*vertices),
            Self::Mesh { mesh, .. } => mesh_extent(*mesh),
            Self::Quadric { clip, .. } => *clip,
        }
    }
}

fn checked(shape: ShapeDesc) -> Result<(ShapeDesc, DAffine3)> {
    shape.check("")?;
    Ok((shape, DAffine3::IDENTITY))
}

/// Returns the frame of a shape of revolution. `name` is the format's name for its origin.
fn frame((name, origin): (&str, DVec3), axis: DVec3, radius: f64, height: f64) -> Result<DAffine3> {
    let (radius, height) = (validate::positive("radius", radius)?, validate::positive("height", height)?);
    let axis = validate::direction("axis", axis)?;
    Ok(quadric::frame(validate::vector(name, origin)?, axis, radius, height))
}

fn check_coefficients(path: &str, coefficients: &[f64; 10]) -> Result<()> {
    let at = join(path, "coefficients");
    for (i, coefficient) in coefficients.iter().enumerate() {
        validate::number(&format!("{at}[{i}]"), *coefficient)?;
    }
    if coefficients[..9].iter().all(|coefficient| *coefficient == 0.0) {
        return Err(Error::invalid(at, "all coefficients but the last are 0, expected a surface"));
    }
    Ok(())
}
