//! Lowers surfaces that move or deform while the shutter is open.

use std::sync::Arc;

use super::instance_transform::inverts_well;
use super::lower::{MeshUse, WorldShape, check_reach, mesh_of, shape_under};
use super::movement::vertex_at;
use super::steps::{MOST_OFF, Mover, moment};
use crate::Cancel;
use crate::desc::{MeshDesc, MeshStep, SceneDesc, ShapeDesc};
use crate::embree::MAX_TIME_STEPS;
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Bounds, DAffine3, flattens_between, similarity_scale};

/// Up to this many triangles times moments, a mesh that moves as a whole is given to the kernel with its vertices at all moments. Above,
/// it is an instance whose transform changes. An instance takes no more memory however many moments there are, but where there is one
/// in a scene that moves, rays are traced one by one instead of in packets.
const COPIED_TRIANGLES: usize = 1 << 14;

/// A surface that would be shown farther from its true place than this share of its size is refused.
const MOST_COARSE: f64 = 0.05;

/// A surface that moves or deforms.
#[derive(Debug)]
pub(super) struct MovingSurface {
    pub surface: usize,
    /// Transforms of the shape's frame to the world at moments evenly spaced, two or more.
    pub steps: Vec<DAffine3>,
    /// Box around all that the surface passes.
    pub bounds: Bounds,
    pub body: MovingBody,
    /// How far the surface is from its true place at most, as a share of its size, where that is too much.
    pub coarse: Option<f64>,
}

/// What moves.
#[derive(Debug)]
pub(super) enum MovingBody {
    /// The corners of a triangle or a quad.
    Polygon,
    /// A mesh whose vertices are given at all moments.
    Copied(MeshUse),
    /// A mesh with a hierarchy of its own, whose transform is given at all moments.
    Instance(MeshUse),
    /// A shape, as it is in the world at all moments.
    Shape(Vec<WorldShape>),
}

/// Lowers a surface of a posed description, if it moves or deforms.
pub(super) fn moving(
    desc: &SceneDesc,
    number: usize,
    cancel: &Cancel,
    bounds_of: &mut impl FnMut(&Arc<MeshDesc>) -> Result<Bounds>,
) -> Result<Option<MovingSurface>> {
    if desc.motion.is_empty() {
        return Ok(None);
    }
    let surface = &desc.surfaces[number];
    let path = desc.motion.surfaces.get(&number).map(|motion| motion.path());
    let deforming = match surface.shape {
        ShapeDesc::Mesh { mesh, .. } => desc.motion.meshes.get(&mesh).map(|steps| &**steps),
        _ => None,
    };
    if path.is_none() && deforming.is_none() {
        return Ok(None);
    }
    let interval = desc.motion.shutter.interval();
    let own_bounds = match &surface.shape {
        ShapeDesc::Triangle(corners) => Bounds::around(*corners),
        ShapeDesc::Quad(corners) => Bounds::around(*corners),
        ShapeDesc::Mesh { mesh, .. } => match deforming {
            None => bounds_of(mesh_of(desc, surface, *mesh)?)?,
            Some(steps) => {
                // The vertices of a mesh that deforms are those of its steps; its triangles are checked all the same.
                bounds_of(mesh_of(desc, surface, *mesh)?)?;
                bounds_of_steps(steps, interval, cancel)?
            }
        },
        _ => shape_under(surface, DAffine3::IDENTITY, true)?.bounds(surface)?,
    };
    let mover = Mover { interval, path: path.as_ref(), own: surface.to_world(), bounds: own_bounds, deforming };
    let steps = mover.steps(cancel)?;
    let is_flattened = steps.transforms.windows(2).any(|pair| flattens_between(pair[0].matrix3, pair[1].matrix3));
    if is_flattened || steps.off > MOST_COARSE {
        let message = format!(
            "it moves in so many ways while the shutter is open that {MAX_TIME_STEPS} moments are too few; expected a shorter time"
        );
        return Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.motion", surface.path)));
    }
    let bounds = steps
        .transforms
        .iter()
        .fold(Bounds::EMPTY, |bounds, transform| bounds.union(own_bounds.transformed(transform)));
    check_reach(&bounds, surface)?;
    let body = match surface.shape {
        ShapeDesc::Triangle(_) | ShapeDesc::Quad(_) => MovingBody::Polygon,
        ShapeDesc::Mesh { mesh, smooth } => {
            let mesh_use = MeshUse { mesh, smooth, surface: number };
            let description = mesh_of(desc, surface, mesh)?;
            let is_large = description.triangle_count().saturating_mul(steps.transforms.len()) > COPIED_TRIANGLES;
            let wanted = deforming.is_none() && surface.emission.is_none() && (is_large || description.host.is_some());
            if wanted && steps.transforms.iter().all(inverts_well) {
                MovingBody::Instance(mesh_use)
            } else {
                MovingBody::Copied(mesh_use)
            }
        }
        _ => {
            let stays_round = steps.transforms.iter().all(|transform| similarity_scale(transform).is_some())
                || surface.emission.is_some();
            let shapes = steps.transforms.iter().map(|transform| shape_under(surface, *transform, stays_round));
            MovingBody::Shape(shapes.collect::<Result<_>>()?)
        }
    };
    let coarse = (steps.off > MOST_OFF).then_some(steps.off);
    Ok(Some(MovingSurface { surface: number, steps: steps.transforms, bounds, body, coarse }))
}

/// The box around all vertices of the steps of a mesh during an interval.
fn bounds_of_steps(steps: &[MeshStep], interval: [f64; 2], cancel: &Cancel) -> Result<Bounds> {
    let mut bounds = Bounds::EMPTY;
    for time in interval {
        cancel.check()?;
        bounds = (0..steps[0].positions.len()).fold(bounds, |all, vertex| all.include(vertex_at(steps, vertex, time)));
    }
    let [open, close] = interval;
    for step in steps.iter().filter(|step| open < step.time && step.time < close) {
        cancel.check()?;
        bounds = step.positions.iter().fold(bounds, |all, position| all.include(*position));
    }
    Ok(bounds)
}

impl MovingSurface {
    /// The time \[s\] of one of the moments.
    pub(super) fn time(&self, desc: &SceneDesc, step: usize) -> f64 {
        moment(desc.motion.shutter.interval(), step, self.steps.len() - 1)
    }
}
