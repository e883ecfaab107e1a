//! A scene's polygons alone, as Embree sees them.

use etendue::desc::{SceneDesc, ShapeDesc};
use etendue::embree::{self, SceneBuilder, SceneOptions, TriangleMesh};
use etendue::math::DVec3;
use etendue::scene::Scene;

/// All triangles of the scene in its frame.
pub fn triangles(desc: &SceneDesc, centre: DVec3) -> etendue::Result<TriangleMesh> {
    let mut vertices: Vec<[f32; 3]> = Vec::new();
    for surface in &desc.surfaces {
        let to_world = surface.to_world();
        let mut add = |corners: [DVec3; 3]| {
            vertices.extend(corners.map(|p| (to_world.transform_point3(p) - centre).as_vec3().to_array()));
        };
        match surface.shape {
            ShapeDesc::Triangle(corners) => add(corners),
            ShapeDesc::Quad([a, b, c, d]) => {
                add([a, b, c]);
                add([a, c, d]);
            }
            ShapeDesc::Mesh { mesh, .. } => {
                let mesh = &desc.meshes[mesh];
                mesh.triangles.iter().for_each(|corners| add(corners.map(|i| mesh.positions[i as usize])));
            }
            ShapeDesc::Sphere { .. } | ShapeDesc::Disk { .. } | ShapeDesc::Quadric { .. } => {}
        }
    }
    let indices = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(vertices, indices)
}

/// Embree with nothing but these triangles.
pub fn kernel(scene: &Scene, mesh: &TriangleMesh, robust: bool) -> etendue::Result<embree::Scene> {
    let mut builder = SceneBuilder::new(scene.device(), SceneOptions { robust, ..SceneOptions::default() })?;
    builder.add_triangles(mesh.clone())?;
    builder.commit(None)
}
