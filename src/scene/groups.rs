//! Groups that are placed as wholes: the meshes of a group in one hierarchy, with one instance for each placement.
//!
//! The other way is to take every surface of a placement for itself. It is right for everything else in a group: shapes that are no
//! meshes, what emits light, and what was edited at one place only.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Weak};

use super::instance_transform::inverts_well;
use super::interaction::Triangles;
use super::lower::{INSTANCE_TRIANGLES, OBJECT_TRIANGLES};
use super::mesh;
use super::record::address;
use crate::control::WorkProgress;
use crate::desc::{GroupDesc, MeshDesc, PlacementDesc, SceneDesc, ShapeDesc, SurfaceDesc};
use crate::embree::{self, Device, MAX_COORDINATE};
use crate::error::Result;
use crate::math::{Bounds, DAffine3};

/// A group has one hierarchy where it is at most this many times as wide as the smallest of its meshes. Vertices are rounded to
/// single precision about the middle of the group: by 6 * 10⁻⁵ of that mesh at most.
const WIDEST_GROUP: f64 = 1e3;

/// A placement whose meshes are one instance.
#[derive(Clone, Debug)]
pub(super) struct WholePlacement {
    /// Index into [`SceneDesc::placements`].
    pub placement: usize,
    /// The members of the group that are in its hierarchy.
    pub members: Arc<[usize]>,
}

impl WholePlacement {
    pub(super) fn desc<'a>(&self, desc: &'a SceneDesc) -> &'a PlacementDesc {
        &desc.placements[self.placement]
    }

    pub(super) fn group<'a>(&self, desc: &'a SceneDesc) -> &'a Arc<GroupDesc> {
        &desc.groups[self.desc(desc).group]
    }

    /// The numbers of the surfaces that are in the instance.
    pub(super) fn surfaces<'a>(&'a self, desc: &SceneDesc) -> impl Iterator<Item = usize> + 'a {
        let first = self.desc(desc).surfaces.start;
        self.members.iter().map(move |member| first + member)
    }
}

/// Returns the placements that are instances as wholes: those of groups whose meshes have together as many triangles as a mesh has that is
/// instanced by itself.
pub(super) fn wholes(
    desc: &SceneDesc,
    is_dynamic: bool,
    mut bounds_of: impl FnMut(&Arc<MeshDesc>) -> Result<Bounds>,
) -> Result<Vec<WholePlacement>> {
    let candidates: Vec<Option<Arc<[usize]>>> = match desc.placements.is_empty() {
        true => Vec::new(),
        false => {
            let mut members = |group: &Arc<GroupDesc>| members(desc, group, is_dynamic, &mut bounds_of);
            desc.groups.iter().map(&mut members).collect::<Result<_>>()?
        }
    };
    let mut uses = vec![0; candidates.len()];
    let mut wholes = Vec::new();
    for (placement, it) in desc.placements.iter().enumerate() {
        if let Some(members) = candidates.get(it.group).and_then(Option::as_ref)
            && is_whole(desc, it, members)
        {
            uses[it.group] += 1;
            wholes.push(WholePlacement { placement, members: Arc::clone(members) });
        }
    }
    // What is there only once is faster in the hierarchy of the scene.
    wholes.retain(|whole| is_dynamic || uses[whole.desc(desc).group] > 1);
    Ok(wholes)
}

/// For each surface, whether it is in an instance of these; empty where there are none.
pub(super) fn in_wholes(desc: &SceneDesc, wholes: &[WholePlacement]) -> Vec<bool> {
    let mut inside = if wholes.is_empty() { Vec::new() } else { vec![false; desc.surfaces.len()] };
    for number in wholes.iter().flat_map(|whole| whole.surfaces(desc)) {
        inside[number] = true;
    }
    inside
}

/// The mesh of a member that can be in the hierarchy of its group.
fn mesh_of<'a>(desc: &'a SceneDesc, member: &SurfaceDesc) -> Option<&'a Arc<MeshDesc>> {
    let emits = || member.emission.is_some() || desc.material_of(member).is_some_and(|it| it.emission.is_some());
    match member.shape {
        ShapeDesc::Mesh { mesh, .. } if !emits() && !desc.motion.meshes.contains_key(&mesh) => {
            // A host's mesh stays in the host's memory.
            desc.meshes.get(mesh).filter(|mesh| mesh.host.is_none())
        }
        _ => None,
    }
}

/// The members of a group that are in its hierarchy; `None` where it has none of its own.
fn members(
    desc: &SceneDesc,
    group: &GroupDesc,
    is_dynamic: bool,
    mut bounds_of: impl FnMut(&Arc<MeshDesc>) -> Result<Bounds>,
) -> Result<Option<Arc<[usize]>>> {
    let mut members = Vec::new();
    let mut triangles = 0;
    for (number, member) in group.members.iter().enumerate() {
        if let Some(mesh) = mesh_of(desc, member) {
            triangles += mesh.triangle_count();
            members.push(number);
        }
    }
    let least = if is_dynamic { OBJECT_TRIANGLES } else { INSTANCE_TRIANGLES };
    if members.len() < 2 || triangles <= least {
        return Ok(None);
    }
    let (mut whole, mut smallest) = (Bounds::EMPTY, f64::INFINITY);
    for member in members.iter().map(|member| &group.members[*member]) {
        if let Some(mesh) = mesh_of(desc, member) {
            let own = bounds_of(mesh)?.transformed(&member.to_world());
            smallest = smallest.min((own.max - own.min).length());
            whole = whole.union(own);
        }
    }
    let across = (whole.max - whole.min).length();
    // What is small in a wide group would lose digits, and the kernel has no room for some groups that are placed smaller.
    let is_fine = across <= WIDEST_GROUP * smallest && across < f64::from(MAX_COORDINATE);
    Ok(is_fine.then(|| members.into()))
}

/// Whether the surfaces of a placement are still where the group has them, and the kernel can invert its transform.
fn is_whole(desc: &SceneDesc, placement: &PlacementDesc, members: &[usize]) -> bool {
    let group = &desc.groups[placement.group];
    let first = placement.surfaces.start;
    let is_in_place = |&number: &usize| {
        let (surface, member) = (&desc.surfaces[first + number], &group.members[number]);
        surface.shape == member.shape
            && surface.emission.is_none()
            && surface.local == member.local
            && surface.transform == placement.transform * member.transform
            && !surface.hidden
            && !desc.motion.surfaces.contains_key(&(first + number))
    };
    !placement.hidden
        && placement.surfaces.len() == group.members.len()
        && placement.surfaces.end <= desc.surfaces.len()
        && inverts_well(&placement.transform)
        && members.iter().all(is_in_place)
}

/// The hierarchy over the meshes of a group. Its origin is the middle of the group.
pub(super) struct GroupObject {
    /// The group itself: while it is here, no other has its address.
    group: Arc<GroupDesc>,
    members: Arc<[usize]>,
    /// The mesh of each member.
    meshes: Vec<Weak<MeshDesc>>,
    /// The Embree scene, and the triangles of each member that has any, in the order of their numbers there; `None` where none has.
    pub content: Option<(embree::Scene, Vec<(usize, Triangles)>)>,
    /// From the frame of the object to that of the group.
    pub to_group: DAffine3,
    /// The numbers of degenerate triangles of members.
    pub dropped: Vec<(usize, usize)>,
}

impl GroupObject {
    /// Builds the object of a placement's group. `bounds_of` has the boxes of meshes in their own frames, by their addresses.
    pub(super) fn new(
        desc: &SceneDesc,
        whole: &WholePlacement,
        bounds_of: &HashMap<usize, Bounds>,
        device: &Device,
        progress: &WorkProgress,
    ) -> Result<Self> {
        let group = whole.group(desc);
        let meshes: Vec<(usize, &Arc<MeshDesc>)> = parts(desc, whole).collect();
        let bounds = meshes.iter().fold(Bounds::EMPTY, |all, (member, mesh)| {
            let own = bounds_of.get(&address(mesh)).copied().unwrap_or_default();
            all.union(own.transformed(&group.members[*member].to_world()))
        });
        let to_group = DAffine3::from_translation(bounds.centre());
        let (mut triangles, mut dropped) = (Vec::new(), Vec::new());
        for (member, mesh) in &meshes {
            let it = &group.members[*member];
            let smooth = matches!(it.shape, ShapeDesc::Mesh { smooth: true, .. });
            let made = mesh::placed(mesh, smooth, &(to_group.inverse() * it.to_world()), device, progress)?;
            if made.dropped > 0 {
                dropped.push((*member, made.dropped));
            }
            triangles.extend(made.triangles.map(|triangles| (*member, triangles)));
        }
        let content = match triangles.is_empty() {
            true => None,
            false => {
                let count = triangles.iter().map(|(_, triangles)| triangles.mesh.indices().len()).sum();
                let scene = mesh::hierarchy(count, device, progress, |scene| {
                    triangles.iter().try_for_each(|(_, it)| scene.add_triangles(it.mesh.clone()).map(|_| ()))
                })?;
                Some((scene, triangles))
            }
        };
        let meshes = meshes.iter().map(|(_, mesh)| Arc::downgrade(mesh)).collect();
        Ok(Self { group: Arc::clone(group), members: Arc::clone(&whole.members), meshes, content, to_group, dropped })
    }

    /// Whether this is the object of a placement.
    pub(super) fn serves(&self, desc: &SceneDesc, whole: &WholePlacement) -> bool {
        let is_same = |(known, (_, mesh)): (&Weak<MeshDesc>, (_, &Arc<MeshDesc>))| {
            std::ptr::eq(known.as_ptr(), Arc::as_ptr(mesh))
        };
        Arc::ptr_eq(&self.group, whole.group(desc))
            && self.members == whole.members
            && self.meshes.iter().zip(parts(desc, whole)).all(is_same)
    }
}

/// The members of a placement that are in its instance, with their meshes.
fn parts<'a>(desc: &'a SceneDesc, whole: &'a WholePlacement) -> impl Iterator<Item = (usize, &'a Arc<MeshDesc>)> {
    let group = whole.group(desc);
    whole.members.iter().filter_map(|&member| Some((member, mesh_of(desc, &group.members[member])?)))
}

/// The objects of groups, by the addresses of these.
pub(super) type GroupObjects = HashMap<usize, Arc<GroupObject>>;

/// The address that distinguishes a group from all others.
pub(super) fn group_address(group: &Arc<GroupDesc>) -> usize {
    Arc::as_ptr(group).addr()
}

/// Units of work that the objects of groups take that are not known yet.
pub(super) fn cost(desc: &SceneDesc, wholes: &[WholePlacement], known: &GroupObjects) -> f64 {
    let mut seen = HashSet::new();
    let mut units = 0.0;
    for whole in wholes {
        let address = group_address(whole.group(desc));
        let is_known = || known.get(&address).is_some_and(|object| object.serves(desc, whole));
        if seen.insert(address) && !is_known() {
            for (_, mesh) in parts(desc, whole) {
                units += mesh::place_cost(mesh, true) + super::cost::HIERARCHY * mesh.triangle_count() as f64;
            }
        }
    }
    units
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::geometry::Geometry;
    use super::super::{BuildOptions, HitDescription, Scene};
    use crate::desc::{self, BsdfDesc, MeshDesc, SceneDesc};
    use crate::math::{DAffine3, DVec3, Ray, Vec3};
    use crate::sampling::Rng;
    use crate::spectrum::Rgb;

    /// A wavy sheet of 2 n² triangles with texture coordinates.
    fn sheet(n: usize) -> Value {
        let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
        let grid = || (0..=n).flat_map(move |j| (0..=n).map(move |i| (at(i), at(j))));
        let positions: Vec<_> = grid().map(|(x, z)| [x, 0.2 * (3.0 * x).sin() * (4.0 * z).cos(), z]).collect();
        let uvs: Vec<_> = grid().map(|(x, z)| [0.5 * x + 0.5, 0.3 * z]).collect();
        let corner = |i: usize, j: usize| j * (n + 1) + i;
        let cell = |(i, j): (usize, usize)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, d, c], [a, c, b]]
        };
        let triangles: Vec<_> = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).flat_map(cell).collect();
        json!({"positions": positions, "uvs": uvs, "triangles": triangles})
    }

    /// Four placements of a group of three sheets, a ball and a lamp. The third sheet is mirrored, and so is the last placement.
    fn bunches(n: usize) -> SceneDesc {
        let mut mesh = sheet(n);
        mesh["name"] = "sheet".into();
        let sheet = |material: &str, shading: &str, transform: Value| json!({"geometry": "mesh", "mesh": "sheet", "material": material, "shading": shading, "transform": transform});
        let place = |transform: Value| json!({"geometry": "group", "group": "bunch", "transform": transform});
        let scene = json!({
            "etendue": 1, "camera": {"origin": [0, 2, 12], "lookAt": [0, 0, 0]},
            "textures": [{"name": "bumps", "type": "noise", "scale": [9, 7]}],
            "materials": [
                {"name": "plain", "type": "diffuse", "color": [0.8, 0.7, 0.6]},
                {"name": "bumpy", "type": "diffuse", "color": [0.4, 0.7, 0.6], "textures": {"normal": "bumps"}}],
            "meshes": [mesh],
            "groups": [{"name": "bunch", "surfaces": [
                sheet("plain", "flat", json!({"translate": [0, 0.8, 0]})),
                {"geometry": "sphere", "origin": [1.2, 0, 0], "radius": 0.4, "material": "plain"},
                sheet("bumpy", "smooth", json!([{"rotate": [30, 50, 10]}, {"scale": [1, 0.7, 1.2]}])),
                {"geometry": "quad", "vertex-1": [0, 2, 0], "vertex-2": [0.3, 2, 0], "vertex-3": [0.3, 2, 0.3],
                    "vertex-4": [0, 2, 0.3], "emission": [5, 5, 5]},
                sheet("bumpy", "smooth", json!([{"scale": [-0.6, 0.6, 0.6]}, {"rotate": [80, 0, 0]}, {"translate": [0, -1, 0.5]}])),
            ]}],
            "surfaces": [
                {"geometry": "quad", "material": "plain", "vertex-1": [-9, -3, 9], "vertex-2": [9, -3, 9],
                    "vertex-3": [9, -3, -9], "vertex-4": [-9, -3, -9]},
                place(json!({"translate": [-3, 0, 0]})),
                place(json!([{"rotate": [0, 40, 15]}, {"translate": [0.5, 0, -1]}])),
                place(json!([{"scale": 1.4}, {"rotate": [70, 0, 15]}, {"translate": [0.5, 0, 4]}])),
                place(json!([{"scale": [-1, 1.3, 0.8]}, {"translate": [3.5, 0, 0]}])),
            ],
        });
        desc::parse(&scene.to_string(), "".as_ref(), None).unwrap()
    }

    fn build(desc: &SceneDesc) -> Scene {
        Scene::build(desc, &BuildOptions::default()).unwrap()
    }

    /// The surfaces that are instances, and how many instances there are.
    fn instances(scene: &Scene) -> (Vec<u32>, usize) {
        let surface = |geometry: &Geometry| match geometry {
            Geometry::Instance { surface, .. } => Some(*surface),
            _ => None,
        };
        (scene.geometries.iter().filter_map(surface).collect(), scene.record.facts.instances)
    }

    /// Says that rays see both scenes alike, and returns how many met something, and how many met an instance.
    fn assert_alike(a: &Scene, b: &Scene) -> [usize; 2] {
        let mut rng = Rng::new(5, 8);
        let mut met = [0; 2];
        for _ in 0..4000 {
            let mut at = |size: f64| size * (2.0 * f64::from(rng.next_f32()) - 1.0);
            let (from, to) = (DVec3::new(at(8.0), at(4.0), at(8.0)), DVec3::new(at(4.0), at(1.5), at(3.0)));
            let seen = |scene: &Scene| {
                let direction: Vec3 = (to - from).normalize().as_vec3a();
                let ray = Ray::new(scene.to_scene(from), direction);
                let hit = scene.intersect(&ray)?;
                let interaction = scene.interaction(&ray, &hit);
                let detail = scene.detail(&hit, &interaction);
                let normal = scene.material(interaction.material).normal(|_| detail);
                let is_instance =
                    matches!(scene.geometries.get(hit.geometry as usize), Some(Geometry::Instance { .. }));
                Some((scene.describe_hit(&ray, &hit), normal, is_instance))
            };
            match (seen(a), seen(b)) {
                (None, None) => {}
                (Some((a, bent, is_instance)), Some((b, other, _))) => {
                    let HitDescription { t, barycentric, uv, ng, ns, .. } = a;
                    assert_eq!(
                        (a.surface, a.material, a.primitive),
                        (b.surface, b.material, b.primitive),
                        "{a:?} {b:?}"
                    );
                    assert!((t - b.t).abs() < 1e-5 * t + 2e-6, "{t}, not {}", b.t);
                    // Normals of vertices are of unit length in the frame in which they are interpolated.
                    assert!((ng - b.ng).length() < 1e-4 && (ns - b.ns).length() < 5e-3, "{a:?} {b:?}");
                    for (own, other) in barycentric.into_iter().chain(uv).zip(b.barycentric.into_iter().chain(b.uv)) {
                        assert!((own - other).abs() < 2e-3, "{a:?} {b:?}");
                    }
                    let turned = bent.zip(other).map_or(0.0, |(own, other)| (own - other).length());
                    assert!(bent.is_some() == other.is_some() && turned < 5e-3, "{bent:?} {other:?}");
                    met[0] += 1;
                    met[1] += usize::from(is_instance);
                }
                (a, b) => panic!("{a:?}, but {b:?}"),
            }
        }
        met
    }

    /// The same surfaces without a group.
    fn apart(desc: &SceneDesc) -> SceneDesc {
        SceneDesc { groups: Vec::new(), placements: Vec::new(), ..desc.clone() }
    }

    #[test]
    fn meshes_of_a_group_are_one_instance_at_each_place() {
        let desc = bunches(50);
        let scene = build(&desc);
        let expected: Vec<u32> = (0..4).flat_map(|place| [1, 3, 5].map(|member| 5 * place + member)).collect();
        assert_eq!(instances(&scene), (expected, 4));
        assert_eq!(scene.record.facts.shared_triangles, 3 * 5000);
        let flat = build(&apart(&desc));
        assert_eq!(instances(&flat).1, 0);
        let [met, instanced] = assert_alike(&scene, &flat);
        assert!(met > 2000 && instanced > 1000, "{met} {instanced}");
        // Small groups, and what is there once, are faster in the hierarchy of the scene.
        assert_eq!(instances(&build(&bunches(30))).1, 0);
        let mut once = desc;
        (1..4).for_each(|placement| once.remove_placement(placement).unwrap());
        assert_eq!(instances(&build(&once)).1, 0);
    }

    #[test]
    fn placements_that_are_edited_in_part_are_taken_apart() {
        let mut desc = bunches(50);
        let red = desc.add_material("red", BsdfDesc::Lambert { albedo: Rgb::new(0.9, 0.1, 0.1) }, None).unwrap();
        // Another material, or another place of what is no mesh, changes nothing.
        desc.set_surface_material(3, Some(red)).unwrap();
        desc.set_transform(2, DAffine3::from_translation(DVec3::Y)).unwrap();
        assert_eq!(instances(&build(&desc)).1, 4);
        desc.remove_surface(8).unwrap();
        desc.set_transform(13, DAffine3::from_translation(DVec3::Y)).unwrap();
        let scene = build(&desc);
        assert_eq!(instances(&scene), (vec![1, 3, 5, 16, 18, 20], 2));
        assert_alike(&scene, &build(&apart(&desc)));
        desc.set_emission(16, Some(Rgb::ONE)).unwrap();
        assert_eq!(instances(&build(&desc)).1, 0);
        // One that is moved as a whole is whole again, but for what was removed.
        desc.set_emission(16, None).unwrap();
        desc.set_placement_transform(2, DAffine3::from_translation(DVec3::NEG_Y)).unwrap();
        let scene = build(&desc);
        assert_eq!(instances(&scene).1, 3);
        assert_alike(&scene, &build(&apart(&desc)));
    }

    /// What is lit by its material is outside, as is what the host holds, and what is small in a wide group has digits of its own.
    #[test]
    fn groups_are_whole_where_that_costs_nothing() {
        let shining = |desc: &mut SceneDesc| {
            let lamp = desc::MaterialDesc { emission: Some(Rgb::ONE), ..desc.materials[0].clone() };
            let lamp = desc.add_material_desc(desc::MaterialDesc { name: "lamp".into(), ..lamp }).unwrap();
            let group = std::sync::Arc::make_mut(&mut desc.groups[0]);
            group.members[0].material = Some(lamp);
            for placement in 0..4 {
                desc.set_surface_material(1 + 5 * placement, Some(lamp)).unwrap();
            }
        };
        let mut desc = bunches(80);
        shining(&mut desc);
        let scene = build(&desc);
        assert_eq!((instances(&scene).0.len(), instances(&scene).1), (8, 4));
        assert_alike(&scene, &build(&apart(&desc)));

        // The first sheet is moved away from the others, by as much as each placement is shrunk to stay in place.
        for (distance, is_whole) in [(1e3, true), (1e5, false), (1e19, false)] {
            let mut desc = bunches(50);
            let far = DAffine3::from_translation(DVec3::X * distance);
            let group = std::sync::Arc::make_mut(&mut desc.groups[0]);
            group.members[0].transform = far * group.members[0].transform;
            for placement in 0..4 {
                let shrunk = DAffine3::from_scale(DVec3::splat(1.0 / distance)) * desc.placements[placement].transform;
                desc.set_placement_transform(placement, shrunk).unwrap();
            }
            assert_eq!(instances(&build(&desc)).1, if is_whole { 4 } else { 0 }, "{distance}");
        }
    }

    /// A placement that the shutter shows at rest is one instance; one that moves meanwhile is not.
    #[test]
    fn placements_are_posed_as_wholes() {
        let mut desc = bunches(50);
        let key = |time: f64, x: f64| desc::MotionKey {
            time,
            place: desc::KeyPlace::Matrix(DAffine3::from_translation(DVec3::new(x, 0.5, 0.0))),
        };
        let motion = desc::MotionDesc { keys: vec![key(0.0, 0.3), key(1.0, 0.6)] };
        desc.set_placement_motion(1, Some(motion)).unwrap();
        let scene = build(&desc);
        assert_eq!(instances(&scene).1, 4);
        assert_alike(&scene, &build(&apart(&desc)));
        desc.motion.shutter.close = 0.5;
        assert_eq!(instances(&build(&desc)).1, 3);
    }

    #[test]
    fn groups_without_any_area_are_no_instances() {
        let mut desc = bunches(50);
        desc.set_mesh(
            0,
            MeshDesc {
                positions: vec![DVec3::ZERO; desc.meshes[0].positions.len()],
                ..MeshDesc::clone(&desc.meshes[0])
            },
        )
        .unwrap();
        let scene = Scene::build(&desc, &BuildOptions { dynamic: true, ..BuildOptions::default() }).unwrap();
        assert_eq!(instances(&scene), (Vec::new(), 0));
        assert!(scene.info().decisions.iter().any(|it| it.contains("0 uses of larger meshes")));
    }

    /// Triangles of surfaces wind about their outer sides, in mirrored instances too, and facets have their corners in the same order.
    #[test]
    fn facets_of_mirrored_placements_face_outwards() {
        let scene = build(&bunches(50));
        let mut mirrored = 0;
        for mesh in scene.surface_meshes(&crate::Cancel::new()).unwrap() {
            if !mesh.is_mesh {
                continue;
            }
            for (corners, facet) in mesh.triangles.iter().zip(&mesh.facets) {
                let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
                let at = scene.facet_point(facet, 0.25, 0.5);
                let expected = scene.to_scene(0.25 * a + 0.25 * b + 0.5 * c);
                assert!((at.point.p - expected).length() < 1e-5, "{} {expected}", at.point.p);
                assert!((b - a).cross(c - a).dot(at.ng.as_dvec3()) > 0.0);
            }
            mirrored += usize::from(mesh.surface > 15);
        }
        assert_eq!(mirrored, 3);
    }

    #[test]
    fn hierarchies_of_groups_are_kept_by_edits() {
        let mut desc = bunches(20);
        let options = BuildOptions { dynamic: true, ..BuildOptions::default() };
        let first = Scene::build(&desc, &options).unwrap();
        assert_eq!(instances(&first).1, 4);
        let object = |scene: &Scene| scene.record.objects.groups.values().next().cloned().unwrap();
        desc.set_placement_transform(1, DAffine3::from_translation(DVec3::new(0.0, 1.0, 2.0))).unwrap();
        let moved = first.rebuild(&desc, &options).unwrap();
        assert!(std::sync::Arc::ptr_eq(&object(&first), &object(&moved)));
        assert_alike(&moved, &build(&apart(&desc)));
        // With other triangles the group has another hierarchy.
        let mesh = MeshDesc {
            positions: desc.meshes[0].positions.iter().map(|p| *p + DVec3::new(0.0, 0.1 * p.x, 0.0)).collect(),
            ..MeshDesc::clone(&desc.meshes[0])
        };
        desc.set_mesh(0, mesh).unwrap();
        let changed = moved.rebuild(&desc, &options).unwrap();
        assert!(!std::sync::Arc::ptr_eq(&object(&moved), &object(&changed)));
        assert_alike(&changed, &build(&apart(&desc)));
    }
}
