//! Calls that say what the surfaces and meshes of a scene are, whoever described them.

use super::boundary::{on, write_sized};
use super::describe::{find, find_surface};
use super::read;
use super::scene::etd_scene;
use super::status::{Failure, Result, etd_status};
use super::types::{
    ETD_NONE, ETD_SHAPE_DISK, ETD_SHAPE_MESH, ETD_SHAPE_NONE, ETD_SHAPE_QUAD, ETD_SHAPE_QUADRIC, ETD_SHAPE_SPHERE,
    ETD_SHAPE_TRIANGLE, Enumeration, etd_mesh_info, etd_shape,
};
use crate::desc::{MeshDesc, ShapeDesc, SurfaceDesc};
use crate::math::DVec3;

/// A shape of which nothing is set but its size.
const NO_SHAPE: etd_shape = etd_shape {
    struct_size: size_of::<etd_shape>(),
    kind: ETD_SHAPE_NONE as u32,
    mesh: ETD_NONE,
    smooth: 0,
    reserved: 0,
    frame: [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    vertices: [0.0; 12],
    centre: [0.0; 3],
    normal: [0.0; 3],
    radius: 0.0,
    coefficients: [0.0; 10],
    clip_min: [0.0; 3],
    clip_max: [0.0; 3],
};

/// The shape of a surface.
fn shape_of(surface: &SurfaceDesc) -> etd_shape {
    if surface.hidden {
        return NO_SHAPE;
    }
    let with_vertices = |kind: super::types::etd_shape_kind, given: &[DVec3]| {
        let mut vertices = [0.0; 12];
        for (out, vertex) in vertices.chunks_exact_mut(3).zip(given) {
            out.copy_from_slice(&vertex.to_array());
        }
        etd_shape { kind: kind.number(), vertices, ..NO_SHAPE }
    };
    let shape = match &surface.shape {
        ShapeDesc::Triangle(vertices) => with_vertices(ETD_SHAPE_TRIANGLE, vertices),
        ShapeDesc::Quad(vertices) => with_vertices(ETD_SHAPE_QUAD, vertices),
        &ShapeDesc::Mesh { mesh, smooth } => {
            etd_shape { kind: ETD_SHAPE_MESH.number(), mesh: mesh as u32, smooth: smooth.into(), ..NO_SHAPE }
        }
        &ShapeDesc::Sphere { centre, radius } => {
            etd_shape { kind: ETD_SHAPE_SPHERE.number(), centre: centre.to_array(), radius, ..NO_SHAPE }
        }
        &ShapeDesc::Disk { centre, normal, radius } => etd_shape {
            kind: ETD_SHAPE_DISK.number(),
            centre: centre.to_array(),
            normal: normal.to_array(),
            radius,
            ..NO_SHAPE
        },
        &ShapeDesc::Quadric { coefficients, clip } => etd_shape {
            kind: ETD_SHAPE_QUADRIC.number(),
            coefficients,
            clip_min: clip.min.to_array(),
            clip_max: clip.max.to_array(),
            ..NO_SHAPE
        },
    };
    etd_shape { frame: read::transform_out(&surface.local), ..shape }
}

/// Returns what a surface is, as described now. Surfaces are numbered from 0; `etd_scene_info.surfaces` says how many there are. A surface
/// that was removed has the kind `ETD_SHAPE_NONE`. Material and transform: `etd_scene_get_surface`. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_shape(
    scene: *const etd_scene,
    surface: u32,
    out_shape: *mut etd_shape,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            write_sized(out_shape, "out_shape", shape_of(find_surface(&desc.surfaces, surface)?))
        })
    }
}

/// Returns what a mesh has, as described now. Meshes are numbered from 0; `etd_scene_info.meshes` says how many there are. Thread-safe.
///
/// # Safety
/// Each pointer must be NULL or point to a value of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_get_mesh(
    scene: *const etd_scene,
    mesh: u32,
    out_info: *mut etd_mesh_info,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let mesh = find(&desc.meshes, mesh, "mesh")?;
            let value = etd_mesh_info {
                struct_size: size_of::<etd_mesh_info>(),
                vertex_count: mesh.vertex_count(),
                triangle_count: mesh.triangle_count(),
                has_normals: mesh.has_normals().into(),
                has_uvs: mesh.has_uvs().into(),
            };
            write_sized(out_info, "out_info", value)
        })
    }
}

/// Copies the arrays of a mesh, as described now, into memory of the host.
///
/// `vertex_count`, `triangle_count`: those of `etd_scene_get_mesh`; if the mesh has other numbers by now, nothing is written.
/// `positions`: three doubles for each vertex. `normals`: three floats for each vertex. `uvs`: two floats for each vertex. `indices`:
/// three numbers of vertices for each triangle. Each of them may be NULL. Error: `ETD_INVALID_ARGUMENT` also for normals or texture coordinates
/// that the mesh does not have. Thread-safe.
///
/// # Safety
/// Each array must be NULL or writable for as many vertices or triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn etd_scene_copy_mesh(
    scene: *const etd_scene,
    mesh: u32,
    vertex_count: usize,
    triangle_count: usize,
    positions: *mut f64,
    normals: *mut f32,
    uvs: *mut f32,
    indices: *mut u32,
) -> etd_status {
    // SAFETY: the caller keeps this function's contract.
    unsafe {
        on(scene, |scene| {
            let desc = scene.desc();
            let it: &MeshDesc = find(&desc.meshes, mesh, "mesh")?;
            let counts = [it.vertex_count(), it.triangle_count()];
            if counts != [vertex_count, triangle_count] {
                let message = format!(
                    "mesh {mesh} has {} vertices and {} triangles, expected {vertex_count} and {triangle_count}",
                    counts[0], counts[1]
                );
                return Err(Failure::argument(message));
            }
            for (what, is_wanted, is_there) in
                [("normals", !normals.is_null(), it.has_normals()), ("uvs", !uvs.is_null(), it.has_uvs())]
            {
                if is_wanted && !is_there {
                    return Err(Failure::argument(format!("{what}: mesh {mesh} has none")));
                }
            }
            // All pointers are checked before anything is written.
            aligned(positions, "positions")?;
            aligned(normals, "normals")?;
            aligned(uvs, "uvs")?;
            aligned(indices, "indices")?;
            fill(positions, vertex_count, |vertex| it.position(vertex).to_array());
            fill(normals, vertex_count, |vertex| it.normal(vertex).unwrap_or_default());
            fill(uvs, vertex_count, |vertex| it.uv(vertex).unwrap_or_default());
            fill(indices, triangle_count, |triangle| it.triangle(triangle));
            Ok(())
        })
    }
}

/// Refuses a pointer that is not aligned.
fn aligned<T>(pointer: *mut T, name: &str) -> Result {
    if pointer.is_null() { Ok(()) } else { super::boundary::need(pointer, name) }
}

/// Writes `N` numbers for each item, where the host wants them.
///
/// # Safety
/// `to` must be NULL, or aligned and writable for as many items.
unsafe fn fill<T: Copy, const N: usize>(to: *mut T, count: usize, item: impl Fn(usize) -> [T; N]) {
    if !to.is_null() {
        for number in 0..count {
            // SAFETY: the caller keeps this function's contract; arrays have the alignment of their items.
            unsafe { to.cast::<[T; N]>().add(number).write(item(number)) };
        }
    }
}
