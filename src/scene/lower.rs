//! Lowers described surfaces to the primitives that are traced: loose triangles, whole meshes, instances and analytic
//! shapes.
//!
//! All coordinates are in double precision and in the world frame. The builder shifts them to the scene frame and
//! rounds them.

use std::collections::HashMap;
use std::sync::Arc;

use super::geometry::Part;
use super::groups::{self, WholePlacement};
use super::instance_transform::inverts_well;
use super::lower_moving::{self, MovingSurface};
use super::record::GeometryRecord;
use super::singles::is_analytic;
use crate::Cancel;
use crate::desc::{BlockFacts, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc};
use crate::error::{Error, ErrorKind, Result};
use crate::math::{Bounds, DAffine3, DVec3, similarity_scale};
use crate::room::with_room;

/// A mesh of more triangles than this is instanced rather than copied when it is used more than once.
pub(super) const INSTANCE_TRIANGLES: usize = 10_000;

/// In a scene whose geometry changes, a mesh of more triangles than this has a hierarchy of its own, which edits of
/// other surfaces leave as it is. Smaller meshes are faster copied than instanced, because every ray that hits an
/// instance's box is transformed, which costs about as much as a few levels of a hierarchy.
pub(super) const OBJECT_TRIANGLES: usize = 128;

/// Bound on the coordinates of a scene. It is half of the bound that Embree takes, because the scene frame may be
/// shifted by as much again.
const LARGEST_COORDINATE: f64 = 0.5 * crate::embree::MAX_COORDINATE as f64;

/// The primitives that the surfaces of a scene become, each with the number of its surface.
#[derive(Debug, Default)]
pub(super) struct Lowered {
    /// Number of triangles of the surfaces that are triangles and quads and rest.
    pub triangles: usize,
    /// Number of spheres, disks and quadrics that rest.
    pub shapes: usize,
    /// Meshes to be copied into the scene frame.
    pub meshes: Vec<MeshUse>,
    /// Meshes to be instanced.
    pub instances: Vec<MeshUse>,
    /// Placements of groups whose meshes are instances as wholes.
    pub wholes: Vec<WholePlacement>,
    /// Surfaces in `meshes` that would be instances if the kernel could invert their transforms.
    pub copied: Vec<usize>,
    /// What moves while the shutter is open.
    pub moving: Vec<MovingSurface>,
    /// Box around all surfaces, in the world frame.
    pub bounds: Bounds,
    /// Boxes around the surfaces of each block that are no meshes; `None` where something moves in a block.
    pub block_bounds: Vec<Option<Bounds>>,
}

/// One use of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshUse {
    pub mesh: usize,
    pub smooth: bool,
    pub surface: usize,
}

/// An analytic shape in the world frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum WorldShape {
    Sphere { centre: DVec3, radius: f64 },
    Disk { centre: DVec3, normal: DVec3, radius: f64, to_world: DAffine3 },
    Quadric { coefficients: [f64; 10], clip: Bounds, to_world: DAffine3 },
}

/// Lowers every surface but single ones that rest, which [`triangles`] and [`shapes`] do; those are checked here. `bounds_of` gives the box of
/// a mesh in its own frame; `is_dynamic` says whether the geometry will change. Single surfaces of blocks that `old` has too are not looked at.
pub(super) fn lower(
    desc: &SceneDesc,
    is_dynamic: bool,
    old: Option<&GeometryRecord>,
    cancel: &Cancel,
    mut bounds_of: impl FnMut(&Arc<MeshDesc>) -> Result<Bounds>,
) -> Result<Lowered> {
    let mut lowered = Lowered { wholes: groups::wholes(desc, is_dynamic, &mut bounds_of)?, ..Lowered::default() };
    let in_whole = groups::in_wholes(desc, &lowered.wholes);
    let in_whole = |number: usize| in_whole.get(number).is_some_and(|is_inside| *is_inside);
    let mut uses: HashMap<(usize, bool), usize> = HashMap::new();
    for (number, surface) in desc.surfaces.meshes() {
        if let ShapeDesc::Mesh { mesh, smooth } = surface.shape
            && surface.emission.is_none()
            && !surface.hidden
            && !in_whole(number)
        {
            *uses.entry((mesh, smooth)).or_default() += 1;
        }
    }
    for block in desc.surfaces.blocks() {
        cancel.check()?;
        let rests = desc.motion.surfaces.range(block.numbers()).next().is_none();
        let known = old.and_then(|old| old.block_bounds(&desc.surfaces, block.place)).filter(|_| rests);
        let mut of_singles = known.unwrap_or_default();
        let mut one = |number: usize, surface: &SurfaceDesc| -> Result<()> {
            if surface.hidden {
                return Ok(());
            }
            if let Some(moving) = lower_moving::moving(desc, number, cancel, &mut bounds_of)? {
                lowered.bounds = lowered.bounds.union(moving.bounds);
                lowered.moving.push(moving);
                return Ok(());
            }
            let to_world = surface.to_world();
            let ShapeDesc::Mesh { mesh, smooth } = surface.shape else {
                let bounds = single_bounds(surface, &to_world)?;
                check_reach(&bounds, surface)?;
                of_singles = of_singles.union(bounds);
                return Ok(());
            };
            let description = mesh_of(desc, surface, mesh)?;
            if !in_whole(number) {
                let is_shared = uses.get(&(mesh, smooth)).is_some_and(|&uses| uses > 1);
                let count = description.triangle_count();
                let is_large = is_shared && count > INSTANCE_TRIANGLES || is_dynamic && count > OBJECT_TRIANGLES;
                // Emitters are in the scene frame, so a mesh that emits is copied there, even a host's mesh. A mesh is
                // also copied if its transform cannot be inverted accurately enough for the kernel to find it.
                let wanted = surface.emission.is_none() && (is_large || description.host.is_some());
                let instanced = wanted && inverts_well(&to_world);
                if wanted && !instanced {
                    lowered.copied.push(number);
                }
                let target = if instanced { &mut lowered.instances } else { &mut lowered.meshes };
                target.push(MeshUse { mesh, smooth, surface: number });
            }
            // The box of a transformed box is larger than necessary. The difference moves the centre only slightly,
            // which is harmless.
            let bounds = bounds_of(description)?.transformed(&to_world);
            check_reach(&bounds, surface)?;
            lowered.bounds = lowered.bounds.union(bounds);
            Ok(())
        };
        match known {
            Some(_) => block.meshes().try_for_each(|(number, surface)| one(number, surface))?,
            None => block.surfaces().try_for_each(|(number, surface)| one(number, surface))?,
        }
        lowered.bounds = lowered.bounds.union(of_singles);
        lowered.block_bounds.push(rests.then_some(of_singles));
        lowered.triangles += block.facts().triangles;
        lowered.shapes += block.facts().shapes;
    }
    for moving in &lowered.moving {
        match desc.surfaces[moving.surface].shape {
            ShapeDesc::Triangle(_) => lowered.triangles -= 1,
            ShapeDesc::Quad(_) => lowered.triangles -= 2,
            ShapeDesc::Mesh { .. } => {}
            ShapeDesc::Sphere { .. } | ShapeDesc::Disk { .. } | ShapeDesc::Quadric { .. } => lowered.shapes -= 1,
        }
    }
    check_volumes(desc, &lowered, cancel)?;
    Ok(lowered)
}

/// The box around a surface that is no mesh, in the world frame.
fn single_bounds(surface: &SurfaceDesc, to_world: &DAffine3) -> Result<Bounds> {
    let place = |p: &DVec3| to_world.transform_point3(*p);
    match &surface.shape {
        ShapeDesc::Triangle(corners) => Ok(extent(&corners.each_ref().map(place))),
        ShapeDesc::Quad(corners) => Ok(extent(&corners.each_ref().map(place))),
        _ => world_shape(surface)?.bounds(surface),
    }
}

/// Number of surfaces that are lowered between two checks for cancellation.
const LOOK: usize = 1024;

/// The surfaces of a kind that rest, of the blocks whose facts say that there are any.
fn resting<'a>(
    desc: &'a SceneDesc,
    lowered: &'a Lowered,
    has_any: impl Fn(&BlockFacts) -> bool + 'a,
) -> impl Iterator<Item = (usize, &'a SurfaceDesc)> {
    let rests = |number: &usize| lowered.moving.binary_search_by_key(number, |it| it.surface).is_err();
    desc.surfaces.of_blocks(has_any).filter(move |(number, surface)| !surface.hidden && rests(number))
}

/// The triangles of the surfaces that are triangles and quads and rest. The winding gives the outer side.
pub(super) fn triangles(desc: &SceneDesc, lowered: &Lowered, cancel: &Cancel) -> Result<Vec<([DVec3; 3], Part)>> {
    let mut triangles = with_room(lowered.triangles)?;
    for (number, surface) in resting(desc, lowered, |facts| facts.triangles > 0) {
        if triangles.len() % LOOK == 0 {
            cancel.check()?;
        }
        let to_world = surface.to_world();
        let place = |p: &DVec3| to_world.transform_point3(*p);
        let mut add = |half: u32, corners: [DVec3; 3]| {
            let part = Part { surface: number as u32, half, is_mirrored: is_mirrored(&to_world) };
            triangles.push((wound(&to_world, corners), part));
        };
        match &surface.shape {
            ShapeDesc::Triangle(corners) => add(0, corners.each_ref().map(place)),
            ShapeDesc::Quad(corners) => {
                let [a, b, c, d] = corners.each_ref().map(place);
                add(0, [a, b, c]);
                add(1, [a, c, d]);
            }
            _ => {}
        }
    }
    Ok(triangles)
}

/// The spheres, disks and quadrics that rest, each with the number of its surface.
pub(super) fn shapes(desc: &SceneDesc, lowered: &Lowered, cancel: &Cancel) -> Result<Vec<(WorldShape, usize)>> {
    let mut shapes = with_room(lowered.shapes)?;
    for (number, surface) in resting(desc, lowered, |facts| facts.shapes > 0) {
        if shapes.len() % LOOK == 0 {
            cancel.check()?;
        }
        if is_analytic(&surface.shape) {
            shapes.push((world_shape(surface)?, number));
        }
    }
    Ok(shapes)
}

/// Refuses a surface, with this box around it in the world, that reaches too far.
pub(super) fn check_reach(bounds: &Bounds, surface: &SurfaceDesc) -> Result<()> {
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    if bounds.is_empty() || !reach.is_finite() || reach >= LARGEST_COORDINATE {
        let message = format!("reaches to {reach:e}; coordinates must stay below {LARGEST_COORDINATE:e}");
        return Err(Error::invalid(&surface.path, message));
    }
    Ok(())
}

/// Refuses triangles that the kernel would miss. The kernel multiplies the distance of a triangle by its area in single
/// precision, which overflows in scenes of some 10^12 across.
fn check_volumes(desc: &SceneDesc, lowered: &Lowered, cancel: &Cancel) -> Result<()> {
    const MOST: f64 = f32::MAX as f64 / 8.0;
    let across = (lowered.bounds.max - lowered.bounds.min).length();
    if lowered.bounds.is_empty() || across.powi(3) < MOST {
        return Ok(());
    }
    if let Some(moving) = lowered.moving.first() {
        let message = format!("a surface cannot move in a scene {across:e} across, which is too large to be searched");
        return Err(Error::new(ErrorKind::Unsupported, message).at(&desc.surfaces[moving.surface].path));
    }
    let is_lost = |[a, b, c]: [DVec3; 3], across: f64| (b - a).cross(c - a).length() * across > MOST;
    let lost = |surface: usize, what: String| {
        let message =
            format!("{what} is too large to be met in a scene {across:e} across: area times size must stay below 2e37");
        Err(Error::invalid(&desc.surfaces[surface].path, message))
    };
    if let Some((_, part)) = triangles(desc, lowered, cancel)?.iter().find(|(corners, _)| is_lost(*corners, across)) {
        return lost(part.surface as usize, "it".to_owned());
    }
    // Of a mesh in this frame, in which the scene is so far across.
    let check = |number: usize, mesh: usize, frame: DAffine3, across: f64| {
        cancel.check()?;
        let mesh = mesh_of(desc, &desc.surfaces[number], mesh)?;
        let corners = |i| mesh.triangle(i).map(|corner: u32| frame.transform_point3(mesh.position(corner as usize)));
        match (0..mesh.triangle_count()).find(|&i| is_lost(corners(i), across)) {
            Some(triangle) => lost(number, format!("triangle {triangle} of {}", mesh.name)),
            None => Ok(()),
        }
    };
    let copied = lowered.meshes.iter().map(|mesh_use| (mesh_use, false));
    for (mesh_use, is_instance) in copied.chain(lowered.instances.iter().map(|mesh_use| (mesh_use, true))) {
        let to_world = desc.surfaces[mesh_use.surface].to_world();
        // Rays are intersected with an instance in the instance's own frame.
        let (frame, across) = match is_instance {
            true => (DAffine3::IDENTITY, across * shrink(&to_world)),
            false => (to_world, across),
        };
        check(mesh_use.surface, mesh_use.mesh, frame, across)?;
    }
    for whole in &lowered.wholes {
        let across = across * shrink(&whole.desc(desc).transform);
        for (surface, member) in whole.surfaces(desc).zip(&*whole.members) {
            let member = &whole.group(desc).members[*member];
            if let ShapeDesc::Mesh { mesh, .. } = member.shape {
                check(surface, mesh, member.to_world(), across)?;
            }
        }
    }
    Ok(())
}

/// How many times as long a distance of the world is in the frame of an instance, at most.
fn shrink(to_world: &DAffine3) -> f64 {
    to_world.matrix3.inverse().to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns the box around the corners. Where a corner is not finite, the box is empty and is refused later; NaN would
/// not widen it.
fn extent(corners: &[DVec3]) -> Bounds {
    if corners.iter().all(|corner| corner.is_finite()) {
        Bounds::around(corners.iter().copied())
    } else {
        Bounds::EMPTY
    }
}

pub(super) fn mesh_of<'a>(desc: &'a SceneDesc, surface: &SurfaceDesc, mesh: usize) -> Result<&'a Arc<MeshDesc>> {
    desc.meshes.get(mesh).ok_or_else(|| {
        Error::invalid(format!("{}.mesh", surface.path), format!("mesh {mesh} of {} does not exist", desc.meshes.len()))
    })
}

/// Returns the vertices in an order whose normal points outwards, because a mirroring transform reverses the winding.
pub(super) fn wound(to_world: &DAffine3, [a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    if is_mirrored(to_world) { [a, c, b] } else { [a, b, c] }
}

/// Returns whether a transform turns a right-handed frame into a left-handed one.
pub(super) fn is_mirrored(transform: &DAffine3) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// Returns the shape of a sphere, quadric or disk in the world frame. An emission of a shape that cannot emit is
/// refused.
pub(super) fn world_shape(surface: &SurfaceDesc) -> Result<WorldShape> {
    shape_under(surface, surface.to_world(), true)
}

/// [`world_shape`] under another transform than the surface's own. Spheres stay spheres where that can be and `stays_round` says so.
pub(super) fn shape_under(surface: &SurfaceDesc, transform: DAffine3, stays_round: bool) -> Result<WorldShape> {
    let stretched = |what: &str| {
        Error::new(ErrorKind::Unsupported, format!("{what} under a transform that stretches it cannot emit"))
            .at(format!("{}.emission", surface.path))
    };
    match surface.shape {
        ShapeDesc::Sphere { .. } if surface.emission.is_some() && surface.emits_both => {
            let message = "a sphere, which is closed, cannot emit on both sides";
            Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.emits", surface.path)))
        }
        ShapeDesc::Sphere { centre, radius } => match similarity_scale(&transform).filter(|_| stays_round) {
            Some(scale) => {
                Ok(WorldShape::Sphere { centre: transform.transform_point3(centre), radius: scale * radius })
            }
            None if surface.emission.is_some() => Err(stretched("a sphere")),
            None => Ok(WorldShape::Quadric {
                // An ellipsoid is the unit sphere in a frame that stretches it.
                coefficients: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0],
                clip: Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY },
                to_world: transform
                    * DAffine3::from_scale_rotation_translation(DVec3::splat(radius), Default::default(), centre),
            }),
        },
        ref other if surface.emission.is_some() && !other.can_emit() => {
            let message = "of the quadrics, only cylinders can emit light";
            Err(Error::new(ErrorKind::Unsupported, message).at(format!("{}.emission", surface.path)))
        }
        ShapeDesc::Quadric { coefficients, clip } => {
            Ok(WorldShape::Quadric { coefficients, clip, to_world: transform })
        }
        ShapeDesc::Disk { centre, normal, radius } => {
            Ok(WorldShape::Disk { centre, normal, radius, to_world: transform })
        }
        ShapeDesc::Triangle(_) | ShapeDesc::Quad(_) | ShapeDesc::Mesh { .. } => {
            Err(Error::new(ErrorKind::Internal, "a polygon is not an analytic shape").at(&surface.path))
        }
    }
}

impl WorldShape {
    /// The same shape moved by a vector.
    pub(super) fn moved(&self, by: DVec3) -> Self {
        let shifted = |to_world: DAffine3| DAffine3::from_translation(by) * to_world;
        match *self {
            Self::Sphere { centre, radius } => Self::Sphere { centre: centre + by, radius },
            Self::Disk { centre, normal, radius, to_world } => {
                Self::Disk { centre, normal, radius, to_world: shifted(to_world) }
            }
            Self::Quadric { coefficients, clip, to_world } => {
                Self::Quadric { coefficients, clip, to_world: shifted(to_world) }
            }
        }
    }

    /// Returns the shape in the frame whose origin is at `centre` of the world.
    pub(super) fn in_scene(&self, centre: DVec3) -> crate::shape::Analytic {
        use crate::shape::{Analytic, Disk, Quadric, Sphere};
        match *self {
            Self::Sphere { centre: own, radius } => Analytic::Sphere(Sphere { centre: own - centre, radius }),
            Self::Disk { centre: own, normal, radius, to_world } => {
                Analytic::Disk(Disk::new(own, normal, radius, &(DAffine3::from_translation(-centre) * to_world)))
            }
            Self::Quadric { coefficients, clip, to_world } => Analytic::Quadric(Box::new(Quadric::new(
                &coefficients,
                clip,
                DAffine3::from_translation(-centre) * to_world,
            ))),
        }
    }

    pub(super) fn bounds(&self, surface: &SurfaceDesc) -> Result<Bounds> {
        let bounds = self.in_scene(DVec3::ZERO).bounds();
        if bounds.min.is_finite() && bounds.max.is_finite() {
            Ok(bounds)
        } else {
            Err(Error::invalid(
                format!("{}.clip", surface.path),
                "this quadric has no end of its own: clip it to a finite box",
            ))
        }
    }
}
