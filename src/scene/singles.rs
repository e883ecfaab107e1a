//! Single triangles and shapes with hierarchies of their own, which edits of other surfaces leave as they are.
//!
//! They are instances of a scene in the same frame, whose transform is the identity, so that hits have the same bits as those of
//! triangles and shapes among the others.

use std::sync::Arc;

use super::analytic::AnalyticGeometry;
use super::assemble::Assembler;
use super::geometry::{Geometry, Part};
use super::interaction::Triangles;
use super::mesh::hierarchy;
use super::record::GeometryRecord;
use crate::desc::{SceneDesc, ShapeDesc};
use crate::embree::{self, SceneBuilder};
use crate::error::Result;
use crate::math::{DAffine3, DVec3};

/// In a scene whose geometry changes, more single triangles than this, or more single shapes, have a hierarchy of their own. Fewer are
/// built in less than a millisecond.
pub(super) const OWN_HIERARCHY: usize = 1024;

/// The hierarchies of single surfaces.
#[derive(Clone, Default)]
pub(super) struct Singles {
    /// The origin of the frame of both.
    pub centre: DVec3,
    pub triangles: Option<Arc<SingleTriangles>>,
    pub shapes: Option<Arc<SingleShapes>>,
}

impl Singles {
    /// Number of triangles and shapes.
    pub fn count(&self) -> usize {
        self.triangles.as_ref().map_or(0, |object| object.parts.len())
            + self.shapes.as_ref().map_or(0, |object| object.surfaces.len())
    }
}

/// All triangles and quads that rest.
pub(super) struct SingleTriangles {
    scene: embree::Scene,
    triangles: Triangles,
    parts: Arc<[Part]>,
    /// The numbers of triangles without area, each with the path of its surface.
    dropped: Vec<(usize, String)>,
}

/// All analytic shapes that rest.
pub(super) struct SingleShapes {
    scene: embree::Scene,
    shapes: Arc<AnalyticGeometry>,
    surfaces: Arc<[u32]>,
}

/// Whether a surface is one of single triangles.
pub(super) fn is_polygon(shape: &ShapeDesc) -> bool {
    matches!(shape, ShapeDesc::Triangle(_) | ShapeDesc::Quad(_))
}

/// Whether a surface is a single shape.
pub(super) fn is_analytic(shape: &ShapeDesc) -> bool {
    !is_polygon(shape) && !matches!(shape, ShapeDesc::Mesh { .. })
}

impl Assembler<'_, '_> {
    /// Adds the triangles of the scene before, if they are still those of the description. Returns whether they are.
    pub(super) fn reuse_triangles(&mut self) -> Result<bool> {
        let Some(object) = self.old_singles.triangles.clone() else { return Ok(false) };
        self.place_triangles(object)?;
        Ok(true)
    }

    /// The same for the shapes.
    pub(super) fn reuse_shapes(&mut self) -> Result<bool> {
        let Some(object) = self.old_singles.shapes.clone() else { return Ok(false) };
        self.place_shapes(object)?;
        Ok(true)
    }

    /// Builds a hierarchy of these triangles and adds it.
    pub(super) fn own_triangles(
        &mut self,
        triangles: Triangles,
        parts: Arc<[Part]>,
        dropped: Vec<(usize, String)>,
    ) -> Result<()> {
        let add = |builder: &mut SceneBuilder| builder.add_triangles(triangles.mesh.clone());
        let scene = hierarchy(parts.len(), self.device, self.progress, add)?;
        self.place_triangles(Arc::new(SingleTriangles { scene, triangles, parts, dropped }))
    }

    /// Builds a hierarchy of these shapes and adds it.
    pub(super) fn own_shapes(&mut self, shapes: Arc<AnalyticGeometry>, surfaces: Arc<[u32]>) -> Result<()> {
        let add = |builder: &mut SceneBuilder| builder.add_user(Arc::clone(&shapes));
        let scene = hierarchy(surfaces.len(), self.device, self.progress, add)?;
        self.place_shapes(Arc::new(SingleShapes { scene, shapes, surfaces }))
    }

    fn place_triangles(&mut self, object: Arc<SingleTriangles>) -> Result<()> {
        let SingleTriangles { scene, triangles, parts, dropped } = &*object;
        self.embree.add_instance(scene, &DAffine3::IDENTITY)?;
        self.facts.triangles += parts.len();
        self.facts.geometry_bytes += triangles.memory_bytes();
        self.facts.embree_bytes += scene.hierarchy_bytes();
        self.facts.dropped.extend_from_slice(dropped);
        let (triangles, parts) = (triangles.clone(), Arc::clone(parts));
        self.geometries.push(Geometry::Loose { triangles, parts, cache: None });
        self.note_own(object.parts.len(), "triangles");
        self.singles.triangles = Some(object);
        Ok(())
    }

    fn place_shapes(&mut self, object: Arc<SingleShapes>) -> Result<()> {
        let SingleShapes { scene, shapes, surfaces } = &*object;
        self.embree.add_instance(scene, &DAffine3::IDENTITY)?;
        self.facts.embree_bytes += scene.hierarchy_bytes();
        let (shapes, surfaces) = (Arc::clone(shapes), Arc::clone(surfaces));
        self.geometries.push(Geometry::Analytic { shapes, surfaces });
        self.note_own(object.surfaces.len(), "shapes");
        self.singles.shapes = Some(object);
        Ok(())
    }

    fn note_own(&mut self, count: usize, what: &str) {
        self.facts.decisions.push(format!(
            "{count} single {what} are more than {OWN_HIERARCHY}: they have a hierarchy of their own, which edits of other surfaces leave as \
             it is while the origin of the frame stays"
        ));
    }
}

/// The hierarchies of the scene before that serve a description whose frame has this origin.
pub(super) fn still_serving(old: &GeometryRecord, desc: &SceneDesc, centre: DVec3) -> Singles {
    let Singles { centre: was, triangles, shapes } = &old.singles;
    let serves = |is_one: fn(&ShapeDesc) -> bool| *was == centre && old.has_same(desc, is_one);
    Singles {
        centre,
        triangles: triangles.clone().filter(|_| serves(is_polygon)),
        shapes: shapes.clone().filter(|_| serves(is_analytic)),
    }
}
