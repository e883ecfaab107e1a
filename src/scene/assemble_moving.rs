//! Assembles the geometry that moves while the shutter is open.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use super::analytic::{AnalyticGeometry, MovingGeometry};
use super::assemble::Assembler;
use super::geometry::{Geometry, Part};
use super::instance_transform::InstancePath;
use super::interaction::Triangles;
use super::lower::{MeshUse, WorldShape, is_mirrored, wound};
use super::lower_moving::{MovingBody, MovingSurface};
use super::movement::mesh_at;
use super::moving_shape::MovingShape;
use super::{bindings, cost, mesh};
use crate::desc::{SceneDesc, ShapeDesc};
use crate::embree::{TriangleMesh, VertexBuffer};
use crate::error::Result;
use crate::math::{DAffine3, DVec3};
use crate::shape::Triangle;

/// The units of work of a surface that moves.
pub(super) fn cost(desc: &SceneDesc, moving: &MovingSurface) -> f64 {
    let count = moving.steps.len() as f64;
    let triangles = match &moving.body {
        MovingBody::Polygon => 2,
        MovingBody::Copied(mesh_use) => desc.meshes[mesh_use.mesh].triangle_count(),
        MovingBody::Instance(mesh_use) => {
            let mesh = &desc.meshes[mesh_use.mesh];
            return mesh::place_cost(mesh, mesh_use.smooth) + cost::HIERARCHY * mesh.triangle_count() as f64;
        }
        MovingBody::Shape(_) => 1,
    };
    let emits = desc.surfaces[moving.surface].emission.is_some();
    let emitters = if emits { bindings::triangles_cost(triangles) } else { 0.0 };
    count * (cost::TEST + cost::PLACE + cost::HIERARCHY) * triangles as f64 + emitters
}

impl Assembler<'_, '_> {
    /// Adds what moves.
    pub(super) fn moving(&mut self, all: &[MovingSurface]) -> Result<()> {
        for moving in all {
            if let Some(off) = moving.coarse {
                self.facts.coarse.push((off, self.desc.surfaces[moving.surface].path.clone()));
            }
        }
        self.facts.moving = all.len();
        // The kernel has one number of moments for each geometry.
        let mut polygons: BTreeMap<usize, Vec<&MovingSurface>> = BTreeMap::new();
        let mut shapes: BTreeMap<usize, Vec<(&MovingSurface, &[WorldShape])>> = BTreeMap::new();
        let mut counted = HashSet::new();
        for moving in all {
            match &moving.body {
                MovingBody::Polygon => polygons.entry(moving.steps.len()).or_default().push(moving),
                MovingBody::Shape(own) => shapes.entry(moving.steps.len()).or_default().push((moving, own)),
                MovingBody::Copied(mesh_use) => self.moving_mesh(moving, mesh_use)?,
                MovingBody::Instance(mesh_use) => self.instance(mesh_use, &moving.steps, &mut counted)?,
            }
        }
        for (count, polygons) in polygons {
            self.moving_polygons(&polygons, count)?;
        }
        for shapes in shapes.into_values() {
            self.moving_shapes(&shapes)?;
        }
        Ok(())
    }

    fn to_scene(&self, to_world: &DAffine3) -> DAffine3 {
        DAffine3::from_translation(-self.centre) * *to_world
    }

    /// Adds a mesh with its vertices at all moments.
    fn moving_mesh(&mut self, moving: &MovingSurface, mesh_use: &MeshUse) -> Result<()> {
        let desc = self.desc;
        let own = &*desc.meshes[mesh_use.mesh];
        let deforming = desc.motion.meshes.get(&mesh_use.mesh);
        let at = |step| match deforming {
            Some(steps) => Cow::Owned(mesh_at(own, steps, moving.time(desc, step))),
            None => Cow::Borrowed(own),
        };
        let steps: Vec<DAffine3> = moving.steps.iter().map(|step| self.to_scene(step)).collect();
        let made = mesh::moving(at, &steps, mesh_use.smooth, self.device, self.progress)?;
        self.note_dropped(made.dropped, mesh_use);
        let Some(triangles) = made.triangles else { return Ok(()) };
        self.facts.smooth_meshes += usize::from(mesh_use.smooth);
        self.add_triangles(&triangles)?;
        let (surface, moved) = (moving.surface as u32, Some(Box::new(InstancePath::new(&steps))));
        self.geometries.push(Geometry::Flat { triangles, surface, cache: None, moved });
        Ok(())
    }

    /// Adds triangles and quads that have the same number of moments, as one geometry.
    fn moving_polygons(&mut self, all: &[&MovingSurface], count: usize) -> Result<()> {
        let mut steps: Vec<Vec<[f32; 3]>> = vec![Vec::new(); count];
        let mut parts = Vec::new();
        for moving in all {
            let surface = &self.desc.surfaces[moving.surface];
            let halves: Vec<[DVec3; 3]> = match surface.shape {
                ShapeDesc::Triangle(corners) => vec![corners],
                ShapeDesc::Quad([a, b, c, d]) => vec![[a, b, c], [a, c, d]],
                _ => Vec::new(),
            };
            let mut dropped = 0;
            for (half, corners) in halves.into_iter().enumerate() {
                let at = |step: &DAffine3| {
                    let to_scene = self.to_scene(step);
                    wound(step, corners).map(|corner| to_scene.transform_point3(corner).as_vec3a())
                };
                let places: Vec<_> = moving.steps.iter().map(at).collect();
                if places.iter().any(|corners| Triangle::new(*corners).is_some()) {
                    let is_mirrored = is_mirrored(&moving.steps[0]);
                    parts.push(Part { surface: moving.surface as u32, half: half as u32, is_mirrored });
                    for (step, corners) in steps.iter_mut().zip(places) {
                        step.extend(corners.map(|corner| corner.to_array()));
                    }
                } else {
                    dropped += 1;
                }
            }
            if dropped > 0 {
                self.facts.dropped.push((dropped, surface.path.clone()));
            }
        }
        if parts.is_empty() {
            return Ok(());
        }
        let charge = self.device.charge(12 * (3 * count + 1) * parts.len())?.map(Arc::new);
        let buffers = steps.into_iter().map(|step| VertexBuffer::from_vec(step, &self.progress.cancel).map(Arc::new));
        let buffers: Vec<_> = buffers.collect::<Result<_>>()?;
        let indices: Vec<_> = (0..parts.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::deforming(&buffers, indices)?;
        let (normals, later_normals, original) = (None, None, None);
        let (any_length, swapped) = (false, false);
        let triangles = Triangles { mesh, normals, later_normals, any_length, original, swapped, _charge: charge };
        self.add_triangles(&triangles)?;
        self.geometries.push(Geometry::Loose { triangles, parts: parts.into(), cache: None });
        Ok(())
    }

    /// Adds analytic shapes that have the same number of moments, as one geometry.
    fn moving_shapes(&mut self, all: &[(&MovingSurface, &[WorldShape])]) -> Result<()> {
        let of = |(moving, shapes): &(&MovingSurface, &[WorldShape])| {
            let steps: Vec<DAffine3> = moving.steps.iter().map(|step| self.to_scene(step)).collect();
            let shapes: Vec<WorldShape> = shapes.iter().map(|shape| shape.moved(-self.centre)).collect();
            MovingShape::new(&shapes, &steps)
        };
        let moving: Vec<_> = all.iter().map(of).collect();
        let start = moving.iter().map(|shape| shape.at(0.0)).collect();
        let surfaces = all.iter().map(|(moving, _)| moving.surface as u32).collect();
        self.facts.embree_shapes += moving.len();
        let shapes = Arc::new(AnalyticGeometry { start, moving });
        self.embree.add_user(Arc::new(MovingGeometry(Arc::clone(&shapes))))?;
        self.geometries.push(Geometry::Analytic { shapes, surfaces });
        Ok(())
    }
}
