//! Converts a described mesh to the triangles that Embree and shading read.

use std::borrow::Cow;
use std::sync::Arc;

use super::cost;
use super::interaction::Triangles;
use super::lower;
use crate::buffer::Buffer;
use crate::control::WorkProgress;
use crate::desc::{HostMesh, MeshDesc};
use crate::embree::{self, Device, MAX_COORDINATE, SceneBuilder, SceneOptions, TriangleMesh, VertexBuffer};
use crate::error::{Error, Result};
use crate::math::{Bounds, DAffine3, DMat3, DVec3, Vec3};
use crate::room::{filled, with_room};
use crate::shape::Triangle;

/// Triangles, and the number of triangles that were left out because they had no area.
pub(super) struct BuiltMesh {
    /// `None` where no triangle has an area.
    pub triangles: Option<Triangles>,
    pub dropped: usize,
}

/// A mesh with a hierarchy of its own, to be instanced.
pub(super) struct MeshObject {
    /// The Embree scene and the triangles; `None` where no triangle has an area.
    pub content: Option<(embree::Scene, Triangles)>,
    /// The point of the mesh's own frame that became the object's origin.
    pub middle: DVec3,
    pub dropped: usize,
}

/// Returns the box around a mesh in its own frame.
///
/// # Errors
/// The errors are a coordinate that is not finite, arrays of different lengths, and indices past the end.
pub(super) fn bounds(mesh: &MeshDesc, progress: &WorkProgress) -> Result<Bounds> {
    let invalid = |message: String| Err(Error::invalid(&mesh.path, message));
    let (vertices, triangles) = (mesh.vertex_count(), mesh.triangle_count());
    let (normals, uvs) = match &mesh.host {
        None => (mesh.normals.len(), mesh.uvs.len()),
        Some(host) => (host.normals.as_ref().map_or(0, Buffer::len), host.uvs.as_ref().map_or(0, Buffer::len)),
    };
    let further = mesh.further_uvs.iter().map(|uvs| (uvs.len(), "uvs of a further set"));
    let own = [(normals, "normals"), (uvs, "uvs"), (mesh.colors.len(), "colors"), (mesh.tangents.len(), "tangents")];
    for (count, what) in own.into_iter().chain(further) {
        if count != 0 && count != vertices {
            return invalid(format!("{count} {what} for {vertices} vertices"));
        }
    }
    // The coordinates of a host's mesh are passed to the kernel unchanged. Other meshes are still to be transformed and
    // rounded.
    let limit = if mesh.host.is_some() { f64::from(MAX_COORDINATE) } else { f64::MAX };
    let mut bounds = Bounds::EMPTY;
    let mut bad = None;
    progress.each(vertices, cost::BOUND, |vertex| {
        let position = mesh.position(vertex);
        if !position.is_finite() || position.abs().max_element() >= limit {
            bad.get_or_insert(vertex);
        }
        bounds = bounds.include(position);
    })?;
    if let Some(vertex) = bad {
        let position = mesh.position(vertex);
        return invalid(format!("vertex {vertex} is {position}: coordinates must be finite and below {limit:e}"));
    }
    let mut bad = None;
    progress.each(triangles, cost::BOUND, |triangle| {
        if mesh.triangle(triangle).into_iter().any(|corner| corner as usize >= vertices) {
            bad.get_or_insert(triangle);
        }
    })?;
    if let Some(triangle) = bad {
        let corners = mesh.triangle(triangle);
        return invalid(format!("triangle {triangle} is {corners:?}: there are only {vertices} vertices"));
    }
    Ok(bounds)
}

/// Units of work that [`bounds`] takes.
pub(super) fn bounds_cost(mesh: &MeshDesc) -> f64 {
    cost::BOUND * (mesh.vertex_count() + mesh.triangle_count()) as f64
}

/// Units of work that transforming a mesh and building its hierarchy take.
pub(super) fn place_cost(mesh: &MeshDesc, smooth: bool) -> f64 {
    let normals = if smooth && !mesh.has_normals() { cost::NORMAL } else { 0.0 };
    let vertices = if smooth { 2.0 * cost::PLACE } else { cost::PLACE };
    vertices * mesh.vertex_count() as f64 + (cost::TEST + normals) * mesh.triangle_count() as f64
}

/// Transforms a mesh's arrays. The outer side stays outside, and degenerate triangles are dropped and counted.
pub(super) fn placed(
    mesh: &MeshDesc,
    smooth: bool,
    transform: &DAffine3,
    device: &Device,
    progress: &WorkProgress,
) -> Result<BuiltMesh> {
    let (vertex_count, triangle_count) = (mesh.vertex_count(), mesh.triangle_count());
    let normal_count = if smooth { vertex_count } else { 0 };
    let charge = device.charge(12 * (vertex_count + 1 + triangle_count + normal_count))?;
    // The capacity has one more vertex for the padding.
    let mut vertices: Vec<[f32; 3]> = with_room(vertex_count + 1)?;
    progress.each(vertex_count, cost::PLACE, |i| {
        vertices.push(transform.transform_point3(mesh.position(i)).as_vec3a().to_array());
    })?;
    let swapped = lower::is_mirrored(transform);
    let mut kept = Kept::new(triangle_count);
    let mut indices = with_room(triangle_count)?;
    progress.each(triangle_count, cost::TEST, |i| {
        let [a, b, c] = mesh.triangle(i);
        let corners = if swapped { [a, c, b] } else { [a, b, c] };
        if kept.test(i, corners.map(|corner| Vec3::from(vertices[corner as usize]))) {
            indices.push(corners);
        }
    })?;
    let (original, dropped) = kept.finish();
    if indices.is_empty() {
        return Ok(BuiltMesh { triangles: None, dropped });
    }
    let normals =
        if smooth { Some(unit_normals(mesh, transform.matrix3.inverse().transpose(), progress)?) } else { None };
    let vertices = VertexBuffer::from_vec(vertices, &progress.cancel).map_err(|error| error.at(&mesh.path))?;
    let mesh = TriangleMesh::checked(Arc::new(vertices), indices.into(), &progress.cancel)?;
    let charge = charge.map(Arc::new);
    Ok(BuiltMesh {
        triangles: Some(Triangles {
            mesh,
            normals,
            later_normals: None,
            any_length: false,
            original,
            swapped,
            _charge: charge,
        }),
        dropped,
    })
}

/// Transforms a mesh's arrays as [`placed`] does, at several moments: `at` gives the mesh at each, whose triangles are the same, and
/// `transforms` has its transform then. Triangles that have no area at any moment are dropped and counted.
pub(super) fn moving<'a>(
    at: impl Fn(usize) -> Cow<'a, MeshDesc>,
    transforms: &[DAffine3],
    smooth: bool,
    device: &Device,
    progress: &WorkProgress,
) -> Result<BuiltMesh> {
    let first = at(0);
    let (vertex_count, triangle_count, count) = (first.vertex_count(), first.triangle_count(), transforms.len());
    let normal_count = if smooth { vertex_count } else { 0 };
    let charge = device.charge(12 * (count * (vertex_count + 1 + normal_count) + triangle_count))?.map(Arc::new);
    let (mut steps, mut normals) = (Vec::with_capacity(count), Vec::new());
    for (step, transform) in transforms.iter().enumerate() {
        let mesh = at(step);
        let mut vertices: Vec<[f32; 3]> = with_room(vertex_count + 1)?;
        progress.each(vertex_count, cost::PLACE, |i| {
            vertices.push(transform.transform_point3(mesh.position(i)).as_vec3a().to_array());
        })?;
        let vertices = VertexBuffer::from_vec(vertices, &progress.cancel).map_err(|error| error.at(&mesh.path))?;
        steps.push(Arc::new(vertices));
        if smooth {
            normals.push(unit_normals(&mesh, transform.matrix3.inverse().transpose(), progress)?);
        }
    }
    let swapped = lower::is_mirrored(&transforms[0]);
    let mut kept = Kept::new(triangle_count);
    let mut indices = with_room(triangle_count)?;
    progress.each(triangle_count, cost::TEST, |i| {
        let [a, b, c] = first.triangle(i);
        let corners = if swapped { [a, c, b] } else { [a, b, c] };
        let has_area = |step: &Arc<VertexBuffer>| {
            Triangle::new(corners.map(|corner| Vec3::from(step.get(corner as usize)))).is_some()
        };
        if kept.count_if(i, steps.iter().any(has_area)) {
            indices.push(corners);
        }
    })?;
    let (original, dropped) = kept.finish();
    if indices.is_empty() {
        return Ok(BuiltMesh { triangles: None, dropped });
    }
    let mesh = TriangleMesh::deforming(&steps, indices).map_err(|error| error.at(&first.path))?;
    let mut normals = normals.into_iter();
    let (normals, later) = (normals.next(), normals.collect::<Vec<_>>());
    let later_normals = (!later.is_empty()).then(|| later.into());
    let triangles = Triangles { mesh, normals, later_normals, any_length: false, original, swapped, _charge: charge };
    Ok(BuiltMesh { triangles: Some(triangles), dropped })
}

/// Uses a host's mesh in the host's own memory. Only its indices are copied, and only if some triangles have no area
/// and must be left out.
fn in_place(
    mesh: &MeshDesc,
    host: &HostMesh,
    smooth: bool,
    device: &Device,
    progress: &WorkProgress,
) -> Result<BuiltMesh> {
    let vertices = VertexBuffer::from_buffer(host.positions.clone(), &progress.cancel).map_err(|e| e.at(&mesh.path))?;
    let count = host.triangles.len();
    let mut kept = Kept::new(count);
    progress.each(count, cost::TEST, |i| {
        kept.test(i, host.triangles.get(i).map(|corner| Vec3::from(vertices.get(corner as usize))));
    })?;
    let (original, dropped) = kept.finish();
    if dropped == count {
        return Ok(BuiltMesh { triangles: None, dropped });
    }
    let made_normals = smooth && host.normals.is_none();
    let normal_count = if made_normals { host.positions.len() } else { 0 };
    let index_count = original.as_ref().map_or(0, |original| original.len());
    let charge = device.charge(12 * normal_count + 16 * index_count)?.map(Arc::new);
    let indices = match &original {
        None => host.triangles.clone(),
        Some(original) => {
            let mut indices = with_room(original.len())?;
            progress.each(original.len(), 0.0, |i| indices.push(host.triangles.get(original[i] as usize)))?;
            indices.into()
        }
    };
    let normals = match &host.normals {
        _ if !smooth => None,
        Some(normals) => Some(normals.clone()),
        None => Some(unit_normals(mesh, DMat3::IDENTITY, progress)?),
    };
    let any_length = normals.is_some() && !made_normals;
    let triangles =
        TriangleMesh::checked(Arc::new(vertices), indices, &progress.cancel).map_err(|e| e.at(&mesh.path))?;
    let triangles = Triangles {
        mesh: triangles,
        normals,
        later_normals: None,
        any_length,
        original,
        swapped: false,
        _charge: charge,
    };
    Ok(BuiltMesh { triangles: Some(triangles), dropped })
}

/// Builds an Embree scene for one mesh. Its origin is the middle of the mesh; a host's mesh keeps its own origin.
pub(super) fn object(
    mesh: &MeshDesc,
    bounds: Bounds,
    smooth: bool,
    device: &Device,
    progress: &WorkProgress,
) -> Result<MeshObject> {
    let (middle, made) = match &mesh.host {
        Some(host) => (DVec3::ZERO, in_place(mesh, host, smooth, device, progress)?),
        None => {
            let middle = bounds.centre();
            (middle, placed(mesh, smooth, &DAffine3::from_translation(-middle), device, progress)?)
        }
    };
    let content = match made.triangles {
        None => None,
        Some(triangles) => {
            let count = triangles.mesh.indices().len();
            let object = hierarchy(count, device, progress, |object| object.add_triangles(triangles.mesh.clone()))?;
            Some((object, triangles))
        }
    };
    Ok(MeshObject { content, middle, dropped: made.dropped })
}

/// Builds a hierarchy of its own for what `add` adds to it, which has `count` primitives.
pub(super) fn hierarchy<T>(
    count: usize,
    device: &Device,
    progress: &WorkProgress,
    add: impl FnOnce(&mut SceneBuilder) -> Result<T>,
) -> Result<embree::Scene> {
    let mut builder = SceneBuilder::cancellable(device, SceneOptions::default(), &progress.cancel)?;
    add(&mut builder)?;
    progress.within(cost::HIERARCHY * count as f64, |report| builder.commit(Some(report)))
}

/// Records which triangles of a mesh have an area.
struct Kept {
    /// Numbers of the triangles that have an area; `None` until a triangle without area was found.
    original: Option<Vec<u32>>,
    dropped: usize,
    count: usize,
}

impl Kept {
    fn new(count: usize) -> Self {
        Self { original: None, dropped: 0, count }
    }

    /// Returns whether triangle `i` is kept. The function must be called for all triangles in order.
    fn test(&mut self, i: usize, corners: [Vec3; 3]) -> bool {
        self.count_if(i, Triangle::new(corners).is_some())
    }

    /// Keeps triangle `i` if `stays`. The function must be called for all triangles in order.
    fn count_if(&mut self, i: usize, stays: bool) -> bool {
        if !stays {
            self.dropped += 1;
            let count = self.count;
            self.original.get_or_insert_with(|| {
                let mut original = Vec::with_capacity(count);
                original.extend(0..i as u32);
                original
            });
        } else if let Some(original) = &mut self.original {
            original.push(i as u32);
        }
        stays
    }

    /// Returns the numbers of the triangles that are kept, where some are not, and the number of those that are left
    /// out.
    fn finish(self) -> (Option<Arc<[u32]>>, usize) {
        (self.original.map(Into::into), self.dropped)
    }
}

/// Returns a unit normal for each vertex after transforming it by `matrix`, or zero where there is none.
pub(super) fn unit_normals(mesh: &MeshDesc, matrix: DMat3, progress: &WorkProgress) -> Result<Buffer<[f32; 3]>> {
    let sums = if mesh.has_normals() { None } else { Some(face_means(mesh, progress)?) };
    let mut normals = with_room(mesh.vertex_count())?;
    progress.each(mesh.vertex_count(), cost::PLACE, |vertex| {
        let normal = match &sums {
            Some(sums) => sums[vertex],
            None => mesh.normal(vertex).map_or(DVec3::ZERO, |normal| Vec3::from(normal).as_dvec3()),
        };
        normals.push((matrix * normal).try_normalize().unwrap_or(DVec3::ZERO).as_vec3a().to_array());
    })?;
    Ok(normals.into())
}

/// Returns the angle-weighted mean of the normals of the faces around each vertex, in the mesh frame.
///
/// Source: Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets".
fn face_means(mesh: &MeshDesc, progress: &WorkProgress) -> Result<Vec<DVec3>> {
    let mut normals = filled(DVec3::ZERO, mesh.vertex_count())?;
    progress.each(mesh.triangle_count(), cost::NORMAL, |i| {
        let triangle = mesh.triangle(i);
        let corners = triangle.map(|corner| mesh.position(corner as usize));
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else { return };
        for i in 0..3 {
            let (a, b) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
            normals[triangle[i] as usize] += a.angle_between(b) * normal;
        }
    })?;
    Ok(normals)
}
