//! Tangents of normal maps: those that a mesh has, or those of MikkTSpace.
//!
//! A normal map holds the differences between two surfaces in frames that the program which made the map chose at each point. They
//! agree with the renderer's frames if both take Mikkelsen's (2008, "Simulation of Wrinkled Surfaces Revisited"), as almost all
//! programs do. They are made for the surfaces alone that have a normal map, where their meshes bring none along.

use std::collections::HashMap;
use std::sync::Arc;

use bevy_mikktspace::{Geometry as MikkGeometry, TangentSpace, generate_tangents};

use super::mesh::unit_normals;
use super::record::address;
use crate::buffer::Buffer;
use crate::control::WorkProgress;
use crate::desc::{MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc, TextureKey, TextureMapping};
use crate::embree::{Charge, Device};
use crate::error::Result;
use crate::math::{DMat3, Vec3};
use crate::room::filled;

/// The tangents of a mesh in its own frame.
#[derive(Debug)]
pub(super) struct MeshTangents {
    /// One for each corner of each triangle of the description. A corner for which there is none has 0.
    corners: Vec<[[f32; 3]; 3]>,
    _charge: Option<Charge>,
}

/// The tangents of the surfaces that have a normal map.
#[derive(Debug, Default)]
pub(super) struct SurfaceTangents {
    /// Of each surface; empty where no material has a normal map.
    of_surfaces: Vec<Option<Arc<MeshTangents>>>,
    /// All of them by the addresses of their meshes, which are kept so that no other mesh can have the address, and by the set of
    /// texture coordinates.
    known: HashMap<(usize, u32), (Arc<MeshDesc>, Arc<MeshTangents>)>,
}

impl SurfaceTangents {
    /// Makes the tangents that surfaces need. Those that `before` has are taken from there.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`] where they are past the allowance of `device`, and [`crate::ErrorKind::Cancelled`].
    pub fn new(desc: &SceneDesc, before: Option<&Self>, device: &Device, progress: &WorkProgress) -> Result<Self> {
        let mut all = Self::default();
        if desc.materials.iter().all(|material| material.textured(TextureKey::Normal).is_none()) {
            return Ok(all);
        }
        let mut of = |surface| {
            let Some((mesh, set)) = normal_mapped(desc, surface) else { return Ok(None) };
            let key = (address(mesh), set);
            let known = all.known.get(&key).or_else(|| before.and_then(|before| before.known.get(&key)));
            let tangents = match known {
                Some((_, tangents)) => Arc::clone(tangents),
                None => Arc::new(MeshTangents::new(mesh, set, device, progress)?),
            };
            all.known.insert(key, (Arc::clone(mesh), Arc::clone(&tangents)));
            Ok(Some(tangents))
        };
        all.of_surfaces = filled(None, desc.surfaces.len())?;
        for (number, surface) in desc.surfaces.meshes() {
            all.of_surfaces[number] = of(surface)?;
        }
        Ok(all)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// The tangents of a surface, where a normal map reads them.
    pub fn of(&self, surface: u32) -> Option<&MeshTangents> {
        self.of_surfaces.get(surface as usize)?.as_deref()
    }
}

/// The mesh of a surface with a normal map, and the set of texture coordinates by which the map lies on it, where the mesh is smooth.
/// On flat triangles, the derivatives of the positions are the frames.
fn normal_mapped<'a>(desc: &'a SceneDesc, surface: &SurfaceDesc) -> Option<(&'a Arc<MeshDesc>, u32)> {
    let ShapeDesc::Mesh { mesh, smooth: true } = surface.shape else { return None };
    let binding = desc.material_of(surface)?.textured(TextureKey::Normal)?;
    let TextureMapping::Uv { set, .. } = desc.textures.get(binding.texture)?.mapping else { return None };
    let mesh = desc.meshes.get(mesh).filter(|_| !surface.hidden)?;
    // A mesh that lacks the set has the first.
    let set = if mesh.uv_of_set(set, 0).is_some() { set } else { 0 };
    mesh.uv_of_set(set, 0)?;
    Some((mesh, set))
}

impl MeshTangents {
    fn new(mesh: &MeshDesc, set: u32, device: &Device, progress: &WorkProgress) -> Result<Self> {
        let count = mesh.triangle_count();
        let charge = device.charge(count * size_of::<[[f32; 3]; 3]>()).map_err(|error| error.at(&mesh.path))?;
        if !mesh.tangents.is_empty() {
            let given = |vertex: u32| mesh.tangents[vertex as usize];
            return Ok(Self { corners: (0..count).map(|i| mesh.triangle(i).map(given)).collect(), _charge: charge });
        }
        let normals = unit_normals(mesh, DMat3::IDENTITY, progress)?;
        let mut made = Making { mesh, set, normals, corners: vec![[[0.0; 3]; 3]; count] };
        // There are no errors that it could return.
        let _ = generate_tangents(&mut made);
        progress.check()?;
        Ok(Self { corners: made.corners, _charge: charge })
    }

    /// The tangents at the corners of a triangle, which the description numbers and orders so.
    pub fn of_triangle(&self, triangle: u32) -> [Vec3; 3] {
        self.corners[triangle as usize].map(Vec3::from)
    }
}

struct Making<'a> {
    mesh: &'a MeshDesc,
    set: u32,
    normals: Buffer<[f32; 3]>,
    corners: Vec<[[f32; 3]; 3]>,
}

impl Making<'_> {
    fn vertex(&self, face: usize, vert: usize) -> usize {
        self.mesh.triangle(face)[vert] as usize
    }
}

impl MikkGeometry for Making<'_> {
    fn num_faces(&self) -> usize {
        self.corners.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        self.mesh.position(self.vertex(face, vert)).as_vec3().to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.normals.get(self.vertex(face, vert))
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        self.mesh.uv_of_set(self.set, self.vertex(face, vert)).unwrap_or_default()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
        self.corners[face][vert] = space.map_or([0.0; 3], |space| space.tangent());
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::{BuildOptions, Scene};
    use super::*;
    use crate::desc;
    use crate::math::{DVec3, Ray};
    use crate::sampling::Rng;

    /// What the map of the tests says everywhere, as it is stored.
    const STORED: [f64; 3] = [0.75, 0.4, 0.9];

    /// A tube about the y axis of eight sides, open at its ends, with u around it and v upwards.
    fn tube() -> Value {
        let (mut positions, mut normals, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for i in 0..=8_u32 {
            let (sin, cos) = (f64::from(i % 8) * std::f64::consts::FRAC_PI_4).sin_cos();
            for y in [0_u32, 1] {
                positions.push([cos, 2.0 * f64::from(y) - 1.0, -sin]);
                normals.push([cos, 0.0, -sin]);
                uvs.push([f64::from(i) / 8.0, f64::from(y)]);
            }
            if i < 8 {
                let a = 2 * i;
                triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
            }
        }
        json!({"geometry": "mesh", "material": "mapped", "shading": "smooth", "positions": positions, "normals": normals,
            "uvs": uvs, "triangles": triangles})
    }

    fn describe(surface: &Value, textures: &Value) -> SceneDesc {
        let scene = json!({
            "etendue": 1,
            "camera": {"origin": [0, 0, 9], "lookAt": [0, 0, 0]},
            "textures": [{"name": "normals", "type": "checker", "colors": [STORED, STORED]}],
            "materials": [{"name": "mapped", "type": "diffuse", "color": [1, 1, 1], "textures": textures}],
            "surfaces": [surface],
        });
        desc::parse(&scene.to_string(), "".as_ref(), None).unwrap()
    }

    fn build(surface: &Value, textures: &Value, options: &BuildOptions) -> Scene {
        Scene::build(&describe(surface, textures), options).unwrap()
    }

    /// The direction around the tube at one of its sides, turned by this angle towards its end.
    fn around(side: f64, turn: f64) -> DVec3 {
        let (sin, cos) = (side * std::f64::consts::FRAC_PI_4).sin_cos();
        turn.cos() * DVec3::new(-sin, 0.0, -cos) + turn.sin() * DVec3::Y
    }

    /// At the vertices of a tube, the tangents run around it; between them they are interpolated, as normals are. Where a transform
    /// mirrors the tube, the map is mirrored with it.
    #[test]
    fn normals_of_a_map_turn_evenly_around_a_coarse_tube() {
        turn_evenly(&tube(), 0.0);
    }

    /// A mesh may bring its tangents along, of any length.
    #[test]
    fn given_tangents_are_those_of_the_map() {
        let mut surface = tube();
        let tangents: Vec<_> = (0..18).map(|i| (3.0 * around(f64::from(i / 2), 0.5)).to_array()).collect();
        surface["tangents"] = json!(tangents);
        turn_evenly(&surface, 0.5);
    }

    fn turn_evenly(tube: &Value, turn: f64) {
        for transform in [json!([]), json!([{"rotate": [20, 50, 10]}]), json!([{"scale": [-1.5, 1.2, 0.8]}])] {
            for dynamic in [false, true] {
                let mut surface = tube.clone();
                surface["transform"] = transform.clone();
                let options = BuildOptions { dynamic, ..BuildOptions::default() };
                let scene = build(&surface, &json!({"normal": "normals"}), &options);
                let place = scene.record.placed(0).unwrap().1;
                let mut rng = Rng::new(5, 5);
                let mut met = 0;
                for _ in 0..2000 {
                    let angle = f64::from(rng.next_f32()) * std::f64::consts::TAU;
                    let from = DVec3::new(9.0 * angle.cos(), f64::from(rng.next_f32()) - 0.5, 9.0 * angle.sin());
                    let to = place.transform_vector3(-from) + 0.1 * f64::from(rng.next_f32());
                    let ray = Ray::new(scene.to_scene(place.transform_point3(from)), to.as_vec3a().normalize());
                    let Some(hit) = scene.intersect(&ray) else { continue };
                    let at = scene.interaction(&ray, &hit);
                    let detail = scene.detail(&hit, &at);
                    // The place on the side, from u: sides are an eighth of u wide.
                    let side = (8.0 * f64::from(detail.uv[0])).clamp(0.0, 7.999);
                    let [before, after] = [side.floor(), side.floor() + 1.0].map(|i| around(i, turn));
                    let along = place.matrix3 * before.lerp(after, side.fract());
                    let ns = at.ns.as_dvec3();
                    let along = (along - along.dot(ns) * ns).normalize();
                    let up = place.matrix3 * DVec3::Y;
                    let across = ns.cross(along) * ns.cross(along).dot(up).signum();
                    let [x, y, z] = STORED.map(|value| 2.0 * f64::from(value as f32) - 1.0);
                    let exact = (x * along + y * across + z * ns).normalize();
                    let normal = scene.material(at.material).normal(|_| detail).unwrap().as_dvec3();
                    assert!((normal - exact).length() < 1e-4, "{normal}, not {exact} at {:?}", detail.uv);
                    met += 1;
                }
                assert!(met > 1500, "{met}");
            }
        }
    }

    #[test]
    fn tangents_are_made_where_a_normal_map_reads_them_alone() {
        let options = BuildOptions::default();
        let mapped = build(&tube(), &json!({"normal": "normals"}), &options);
        assert!(mapped.tangents.of(0).is_some());
        let mut flat = tube();
        flat["shading"] = json!("flat");
        for (surface, textures) in [
            (tube(), json!({"color": "normals"})),
            (tube(), json!({"bump": "normals"})),
            (flat, json!({"normal": "normals"})),
        ] {
            assert!(build(&surface, &textures, &options).tangents.of(0).is_none(), "{textures}");
        }
    }

    #[test]
    fn a_rebuilt_scene_keeps_the_tangents_of_its_meshes() {
        let mut desc = describe(&tube(), &json!({"normal": "normals"}));
        let options = BuildOptions::default();
        let before = Scene::build(&desc, &options).unwrap();
        desc.set_material_textures(0, desc.materials[0].textures.clone()).unwrap();
        let after = before.rebuild(&desc, &options).unwrap();
        let of = |scene: &Scene| Arc::as_ptr(scene.tangents.of_surfaces[0].as_ref().unwrap());
        assert_eq!(of(&before), of(&after));
    }
}
