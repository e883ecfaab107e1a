//! Flat surfaces that shine by a photometric web: what of the web each side and each triangle of them has.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use super::lower::{mesh_of, wound};
use super::textured_emission::binding_of;
use crate::desc::{AreaWebDesc, SceneDesc, ShapeDesc, SurfaceDesc};
use crate::emitter::{DiskEmitter, Emitter, FlatEmitter, TriangleEmitter, TurnedWeb, WebArea};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Bounds, DVec3};
use crate::photometry::LUMENS_PER_WATT;
use crate::shape::{Disk, Triangle};
use crate::spectrum::Rgb;

/// How far the corners of a flat surface may be off its plane, as a share of its extent. All quadrilaterals are as flat as this.
const FLATNESS: f64 = 3e-4;

/// The light of one side: the radiance of an even surface of the same power, and the web.
#[derive(Clone, Debug)]
struct Side {
    radiance: Rgb,
    web: Arc<TurnedWeb>,
}

/// The light of a surface with a photometric web.
#[derive(Clone, Debug)]
pub(super) struct EmissionWeb {
    /// That of the normal's side and that of the other one, `None` where no light goes there.
    sides: [Option<Side>; 2],
}

/// The webs of surfaces by their numbers. The description is posed, so that what moves in it does so while the shutter is open.
///
/// # Errors
/// [`ErrorKind::Unsupported`] for a surface that is not flat, that moves, or whose emission a texture varies;
/// [`ErrorKind::InvalidScene`] for a radiance beyond single precision, and for light behind a surface that does not emit there.
pub(super) fn emission_webs(desc: &SceneDesc) -> Result<BTreeMap<u32, EmissionWeb>> {
    let mut webs = BTreeMap::new();
    for (number, surface) in desc.surfaces.of_blocks(|facts| facts.shines_unevenly) {
        if let (Some(web), Some(factor), false) = (&surface.web, surface.emission, surface.hidden) {
            webs.insert(number as u32, EmissionWeb::new(desc, (number, surface), web, factor)?);
        }
    }
    Ok(webs)
}

impl EmissionWeb {
    fn new(desc: &SceneDesc, (number, surface): (usize, &SurfaceDesc), it: &AreaWebDesc, factor: Rgb) -> Result<Self> {
        // A description that is put together by hand has passed no checks.
        it.check(&surface.path, &surface.shape, factor, surface.emits_both)?;
        let refuse = |key: &str, message: &str| {
            Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.{key}", surface.path)))
        };
        let deforms = match surface.shape {
            ShapeDesc::Mesh { mesh, .. } => desc.motion.meshes.contains_key(&mesh),
            _ => false,
        };
        if deforms || desc.motion.surfaces.contains_key(&number) {
            return refuse("motion", "a surface with a photometric web cannot move, expected one that rests");
        }
        if binding_of(desc, surface).is_some() {
            let message = "a texture varies the emission already, expected a material without one where there is a photometric web";
            return refuse("web", message);
        }
        let (normal, area) = flat(desc, surface)?;
        let c0 = surface.transform.matrix3 * it.c0;
        let side = |front: bool| {
            let web = it.web.side(front).map(Arc::new)?;
            let power = factor.to_f64() * (it.tilt_factor() * web.flux() / LUMENS_PER_WATT);
            // An even surface emits pi times its area and radiance.
            let radiance = Rgb::from_f64(power / (PI * area));
            Some(Side { radiance, web: Arc::new(TurnedWeb::new(web, normal, c0)) })
        };
        let sides = [side(true), surface.emits_both.then(|| side(false)).flatten()];
        for side in sides.iter().flatten() {
            let most =
                side.radiance.to_f64() * (PI * side.web.peak() / (side.web.flux() * f64::from(WebArea::LEAST_COSINE)));
            if !Rgb::from_f64(most).is_finite() {
                let message = format!("the radiance of the lamp is beyond single precision on an area of {area:e}");
                return Err(Error::invalid(format!("{}.web", surface.path), message));
            }
        }
        Ok(Self { sides })
    }

    /// The emitter of a triangle of the surface, or of its other side, in the scene frame; `error` is the bound of
    /// [`crate::math::HitPoint`] for points on it.
    pub fn triangle(&self, triangle: Triangle, error: f32, flipped: bool) -> Emitter {
        let even = |radiance| TriangleEmitter::new(triangle, radiance, error);
        match &self.sides[usize::from(flipped)] {
            Some(side) => side.emitter(FlatEmitter::Triangle(even(side.radiance))),
            None => Emitter::Triangle(even(Rgb::ZERO)),
        }
    }

    /// The emitter of a disk, or of its other side, in the scene frame.
    pub fn disk(&self, disk: Disk, flipped: bool) -> Emitter {
        match &self.sides[usize::from(flipped)] {
            Some(side) => side.emitter(FlatEmitter::Disk(DiskEmitter::new(disk, side.radiance))),
            None => Emitter::Disk(Box::new(DiskEmitter::new(disk, Rgb::ZERO))),
        }
    }
}

impl Side {
    fn emitter(&self, even: FlatEmitter) -> Emitter {
        Emitter::Web(Box::new(WebArea::new(even, Arc::clone(&self.web))))
    }
}

/// The unit normal of a surface in the world, and its area.
///
/// # Errors
/// [`ErrorKind::Unsupported`] for one that is not flat.
fn flat(desc: &SceneDesc, surface: &SurfaceDesc) -> Result<(DVec3, f64)> {
    let to_world = surface.to_world();
    let refuse = |why: &str| {
        let message =
            format!("a photometric web needs a flat surface, and {why}, expected a triangle, quad, disk or flat mesh");
        Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.web", surface.path)))
    };
    let triangles: Vec<[DVec3; 3]> = match surface.shape {
        ShapeDesc::Disk { centre, normal, radius } => {
            let disk = Disk::new(centre, normal, radius, &to_world);
            return Ok((disk.normal(), disk.area()));
        }
        ShapeDesc::Triangle(corners) => vec![corners],
        ShapeDesc::Quad([a, b, c, d]) => vec![[a, b, c], [a, c, d]],
        ShapeDesc::Mesh { mesh, .. } => {
            let mesh = mesh_of(desc, surface, mesh)?;
            let corners = |i| mesh.triangle(i).map(|corner: u32| mesh.position(corner as usize));
            (0..mesh.triangle_count()).map(corners).collect()
        }
        ShapeDesc::Sphere { .. } | ShapeDesc::Quadric { .. } => return refuse("its shape is none"),
    };
    let triangles: Vec<[DVec3; 3]> = triangles
        .into_iter()
        .map(|corners| wound(&to_world, corners.map(|corner| to_world.transform_point3(corner))))
        .collect();
    let twice_area = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a);
    let sum: DVec3 = triangles.iter().map(twice_area).sum();
    let area: f64 = 0.5 * triangles.iter().map(|corners| twice_area(corners).length()).sum::<f64>();
    let Some(normal) = sum.try_normalize() else {
        return refuse("the mesh has no area");
    };
    let middle = Bounds::around(triangles.iter().flatten().copied()).centre();
    let reach = triangles.iter().flatten().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
    let heights = || triangles.iter().flatten().map(|corner| (*corner - middle).dot(normal));
    let off = 0.5 * (heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min));
    if off > FLATNESS * reach {
        return refuse("the corners of the mesh are not in a plane");
    }
    // Triangles that face the other way have their light on the wrong side.
    if triangles.iter().any(|corners| twice_area(corners).dot(normal) < 0.0) {
        return refuse("the triangles of the mesh face both sides of its plane");
    }
    Ok((normal, area))
}
