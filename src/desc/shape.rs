//! The shapes of the scene format by name, each with the frame it stands in, and what their numbers must fulfil.

use super::json::join;
use super::{ShapeDesc, quadric, validate};
use crate::math::{Bounds, DAffine3, DMat3, DVec3};
use crate::{Error, Result};

/// How far from 1 the length of a disk's normal may be.
const UNIT: f64 = 1e-6;

/// Constructors for what the scene format calls by name.
///
/// Each gives a shape and its [`super::SurfaceDesc::local`] frame, both for [`super::SceneDesc::add_surface`], and the
/// very same bits as the format. Lengths are in scene units; all numbers must fit single precision. Errors are of kind
/// [`crate::ErrorKind::InvalidScene`] and name the argument as the format does (`radius`, `vertex-2[1]`).
impl ShapeDesc {
    /// A sphere, normals outwards; `radius` > 0.
    ///
    /// # Errors
    /// At `origin[..]` or `radius`.
    pub fn sphere(centre: DVec3, radius: f64) -> Result<(Self, DAffine3)> {
        checked(Self::Sphere { centre, radius })
    }

    /// A triangle with normal (v1 - v0) x (v2 - v0).
    ///
    /// # Errors
    /// At `vertex-1[..]` to `vertex-3[..]`.
    pub fn triangle(vertices: [DVec3; 3]) -> Result<(Self, DAffine3)> {
        checked(Self::Triangle(vertices))
    }

    /// A flat convex quadrilateral, corners in order around the edge, with the normal of its first three corners.
    ///
    /// # Errors
    /// At `vertex-1` to `vertex-4`, or without a path if the whole has no area.
    pub fn quad(vertices: [DVec3; 4]) -> Result<(Self, DAffine3)> {
        checked(Self::Quad(vertices))
    }

    /// A flat round disk; `normal` of any length but zero, `radius` > 0. It cannot emit.
    ///
    /// # Errors
    /// At `origin[..]`, `normal` or `radius`.
    pub fn disk(centre: DVec3, normal: DVec3, radius: f64) -> Result<(Self, DAffine3)> {
        checked(Self::Disk { centre, normal: validate::direction("normal", normal)?, radius })
    }

    /// a x^2 + b y^2 + c z^2 + 2d xy + 2e yz + 2f xz + 2g x + 2h y + 2i z + j = 0 inside a box, with the gradient for
    /// a normal. `None` for the box means an ellipsoid's own extent. It cannot emit.
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

    /// A tube without caps, normals outwards: from the centre `base` of one end along `axis`, of any length but zero.
    /// `radius` and `height` > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `base`.
    pub fn cylinder(base: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::cylinder(), frame(("base", base), axis, radius, height)?))
    }

    /// A cone without its base disk, normals outwards: `radius` wide at `base`, its apex at `height` along `axis`,
    /// which has any length but zero. `radius` and `height` > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `base`.
    pub fn cone(base: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::cone(), frame(("base", base), axis, radius, height)?))
    }

    /// A paraboloid of revolution, open at its wide end, normals away from the axis: a bowl that opens from `apex`
    /// along `axis`, of any length but zero, and is `radius` wide at `height`. Both > 0.
    ///
    /// # Errors
    /// At `radius`, `height`, `axis` or `apex`.
    pub fn paraboloid(apex: DVec3, axis: DVec3, radius: f64, height: f64) -> Result<(Self, DAffine3)> {
        Ok((quadric::paraboloid(), frame(("apex", apex), axis, radius, height)?))
    }

    /// An ellipsoid, normals outwards; `radii` are half its size along x, y and z, each > 0. It cannot emit; a sphere
    /// under a transform can, as long as that keeps it round.
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

    /// Whether the numbers are such that the format could have given them; a mesh's number is not looked at.
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

    /// Box around the shape in its own frame; `mesh_extent` says how large a mesh is.
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

/// The frame of a shape of revolution, whose origin the format calls by this name.
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
