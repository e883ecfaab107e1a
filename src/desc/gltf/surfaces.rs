//! The surfaces of a scene: the meshes of its nodes. A mesh that is not deformed is there once, however many nodes have it.

use std::collections::HashMap;

use super::super::{MeshDesc, SceneDesc, ShapeDesc, SurfaceLook, TextureKey, validate};
use super::accessor::Accessors;
use super::animation::Pose;
use super::document::{Document, Mesh, Node, element, missing};
use super::material::Materials;
use super::mesh::{Geometry, Meshes, VertexReads, weights};
use super::nodes::Nodes;
use super::{deform, instances, skin};
use crate::math::{DAffine3, DVec3};
use crate::{Error, Result};

/// Most surfaces of a scene.
const SURFACE_LIMIT: usize = 1 << 22;

/// A primitive that was read.
#[derive(Clone, Copy)]
struct Part {
    primitive: usize,
    mesh: usize,
    material: usize,
    smooth: bool,
}

struct Adding<'a> {
    document: &'a Document<'a>,
    nodes: &'a Nodes,
    meshes: Meshes<'a>,
    materials: Materials,
    /// The parts of meshes in their own frames, by mesh and weights of morph targets.
    known: HashMap<(usize, Vec<u64>), Vec<Part>>,
    /// What the surfaces of the node are called: as the node, or as its mesh. Empty for neither.
    name: &'a str,
    scene: &'a mut SceneDesc,
}

/// Adds the surfaces of all nodes.
pub(super) fn add<'a>(
    document: &'a Document<'a>,
    accessors: &'a Accessors<'a>,
    nodes: &'a Nodes,
    pose: &Pose,
    materials: Materials,
    scene: &'a mut SceneDesc,
) -> Result<()> {
    let meshes = Meshes::new(accessors);
    let mut adding = Adding { document, nodes, meshes, materials, known: HashMap::new(), name: "", scene };
    for number in &nodes.drawn {
        let node = &document.nodes[*number];
        if let Some(mesh) = node.mesh {
            let path = format!("nodes[{number}]");
            let (mesh, _) = element(&document.meshes, "meshes", &format!("{path}.mesh"), mesh)?;
            let own = weights(pose.weights.get(number), node.weights.as_ref(), document.meshes[mesh].weights.as_ref());
            let named = |name: &'a Option<String>| name.as_deref().filter(|name| !name.is_empty());
            adding.name = named(&node.name).or_else(|| named(&document.meshes[mesh].name)).unwrap_or_default();
            adding.node(&path, *number, node, mesh, own)?;
        }
    }
    let Adding { meshes, materials, scene, .. } = adding;
    meshes.warn(&mut scene.warnings);
    materials.warn(&mut scene.warnings);
    Ok(())
}

impl Adding<'_> {
    fn node(&mut self, path: &str, number: usize, node: &Node<'_>, mesh: usize, weights: &[f64]) -> Result<()> {
        let to_world = self.nodes.to_world[number];
        let places = instances::read(path, node, self.meshes.accessors)?;
        if let Some(skin) = node.skin {
            // The joints alone place a skinned mesh.
            let at = format!("{path}.skin");
            let joints = skin::joints(self.document, self.meshes.accessors, self.nodes, &at, skin)?;
            return self.skinned(path, mesh, weights, &joints);
        }
        let Some(places) = places else {
            return self.place(path, mesh, weights, to_world);
        };
        for (i, place) in places.into_iter().enumerate() {
            self.place(&format!("{path}.instances[{i}]"), mesh, weights, to_world * place)?;
        }
        Ok(())
    }

    /// Adds the surfaces of a mesh in its own frame at a place.
    fn place(&mut self, path: &str, mesh: usize, weights: &[f64], to_world: DAffine3) -> Result<()> {
        if validate::invertible(path, &to_world).is_err() {
            return self.flattened(path, mesh, weights, &to_world);
        }
        for part in self.parts(mesh, weights)? {
            self.surface(&format!("{path}.primitives[{}]", part.primitive), part, to_world)?;
        }
        Ok(())
    }

    fn surface(&mut self, path: &str, part: Part, transform: DAffine3) -> Result<()> {
        if self.scene.surfaces.len() == SURFACE_LIMIT {
            let message = format!("the file has more than {SURFACE_LIMIT} surfaces");
            return Err(Error::invalid(path, message));
        }
        let shape = ShapeDesc::Mesh { mesh: part.mesh, smooth: part.smooth };
        let look = SurfaceLook { material: Some(part.material), transform, ..SurfaceLook::default() };
        let surface = self.scene.put_surface(path, shape, DAffine3::IDENTITY, look)?;
        self.scene.set_surface_name(surface, self.name)
    }

    /// Adds a mesh that a scale of zero makes flat. Rays need an inverse of every placement, so the vertices themselves are moved.
    fn flattened(&mut self, path: &str, mesh: usize, weights: &[f64], to_world: &DAffine3) -> Result<()> {
        if !deform::leaves_a_plane(to_world) {
            self.meshes.leave_out("nodes that are scaled to a line or a point are not drawn", path);
            return Ok(());
        }
        self.moved(path, mesh, weights, |_, _, _, geometry| {
            deform::flatten(to_world, geometry);
            Ok(())
        })
    }

    fn skinned(&mut self, path: &str, mesh: usize, weights: &[f64], joints: &[DAffine3]) -> Result<()> {
        self.moved(path, mesh, weights, |path, meshes, primitive, geometry| {
            deform::skin(path, primitive, joints, meshes.accessors, geometry)
        })
    }

    /// Adds a mesh whose vertices are moved to the world.
    fn moved(
        &mut self,
        path: &str,
        mesh: usize,
        weights: &[f64],
        to_world: impl Fn(&str, &Meshes<'_>, &super::document::Primitive<'_>, &mut Geometry) -> Result<()>,
    ) -> Result<()> {
        let document = self.document;
        for (i, primitive) in primitives(&document.meshes[mesh], mesh)?.iter().enumerate() {
            let at = format!("meshes[{mesh}].primitives[{i}]");
            self.meshes.accessors.spend(&at, 1)?;
            let material = self.materials.of(&at, primitive.material, self.scene)?;
            let Some(mut geometry) =
                self.meshes.read(&at, primitive, weights, vertex_reads(&self.materials, self.scene, material))?
            else {
                continue;
            };
            to_world(&at, &self.meshes, primitive, &mut geometry)?;
            let part = self.part(&at, mesh, i, material, geometry)?;
            self.surface(&format!("{path}.primitives[{i}]"), part, DAffine3::IDENTITY)?;
        }
        Ok(())
    }

    /// The parts of a mesh in its own frame, which are read once.
    fn parts(&mut self, mesh: usize, weights: &[f64]) -> Result<Vec<Part>> {
        let key = (mesh, weights.iter().map(|weight| weight.to_bits()).collect::<Vec<_>>());
        if let Some(parts) = self.known.get(&key) {
            return Ok(parts.clone());
        }
        let mut parts = Vec::new();
        let document = self.document;
        for (i, primitive) in primitives(&document.meshes[mesh], mesh)?.iter().enumerate() {
            let at = format!("meshes[{mesh}].primitives[{i}]");
            self.meshes.accessors.spend(&at, 1)?;
            let material = self.materials.of(&at, primitive.material, self.scene)?;
            if let Some(geometry) =
                self.meshes.read(&at, primitive, weights, vertex_reads(&self.materials, self.scene, material))?
            {
                parts.push(self.part(&at, mesh, i, material, geometry)?);
            }
        }
        self.known.insert(key, parts.clone());
        Ok(parts)
    }

    /// Adds a mesh to the scene.
    fn part(&mut self, path: &str, mesh: usize, primitive: usize, material: usize, it: Geometry) -> Result<Part> {
        let name = match self.document.meshes[mesh].name.as_deref() {
            Some(name) if !name.is_empty() => format!("{name}[{primitive}]"),
            _ => path.to_owned(),
        };
        let smooth = !it.normals.is_empty();
        let single = |vectors: Vec<DVec3>| vectors.into_iter().map(|it| it.as_vec3().to_array()).collect();
        let desc = MeshDesc {
            name: name.clone(),
            path: path.to_owned(),
            positions: it.positions,
            normals: single(it.normals),
            tangents: single(it.tangents),
            uvs: it.uvs,
            further_uvs: it.further_uvs,
            colors: it.colors,
            triangles: it.triangles,
            host: None,
        };
        validate::mesh(path, &desc)?;
        let number = self.scene.put_mesh(desc);
        if self.scene.find_mesh(&name).is_none() {
            self.scene.index.meshes.insert(name, number);
        }
        Ok(Part { primitive, mesh: number, material, smooth })
    }
}

fn vertex_reads<'a>(materials: &'a Materials, scene: &SceneDesc, material: usize) -> VertexReads<'a> {
    let tangents = scene.materials[material].textured(TextureKey::Normal).is_some();
    VertexReads { uv_sets: materials.uv_sets(material), tangents }
}

/// The primitives of a mesh, of which there has to be one.
fn primitives<'a, 'b>(mesh: &'b Mesh<'a>, number: usize) -> Result<&'b [super::document::Primitive<'a>]> {
    if mesh.primitives.is_empty() {
        return Err(missing(&format!("meshes[{number}]"), "primitives"));
    }
    Ok(&mesh.primitives)
}
