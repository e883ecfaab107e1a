//! Types of ray queries and of information about scenes.

pub use etd_text::*;

/// A ray segment: origin + t * direction for t in [tnear, tfar], world frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_ray {
    /// Origin of the ray, where t is 0.
    pub origin: [f32; 3],
    /// Start of the segment, >= 0.
    pub tnear: f32,
    /// Direction of any length except zero. The length is the unit of t.
    pub direction: [f32; 3],
    /// End of the segment; may be infinite.
    pub tfar: f32,
}

/// The first hit of a ray.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_hit {
    /// Distance in lengths of the ray's direction; infinite where the ray hits nothing. In that case, only `surface` is set
    /// besides.
    pub t: f32,
    /// Weights of the triangle's second and third vertex; 0 on other shapes.
    pub barycentric: [f32; 2],
    /// Texture coordinates: the mesh's where it has any, else the barycentric ones (over the whole of a quad); 0 on other
    /// shapes.
    pub uv: [f32; 2],
    /// Geometric normal, unit length, on the outer side.
    pub ng: [f32; 3],
    /// Shading normal, unit length, on the outer side; the geometric one where shading is flat.
    pub ns: [f32; 3],
    /// Number of the surface; `ETD_NONE` where the ray hits nothing.
    pub surface: u32,
    /// Number of the surface's material; `ETD_NONE` for a surface without one, and where the ray hits nothing.
    pub material: u32,
    /// Number of the triangle in its mesh, 0 or 1 in a quad, else 0.
    pub primitive: u32,
}

/// Rays to trace, and what is wanted of their hits, for `etd_scene_query`.
///
/// Each kind of value is a column: a pointer to the value of the first ray, and the number of bytes from the value of one ray to
/// that of the next, 0 for values without gaps. Columns may be arrays of their own or members of the host's structures, as in
/// `query.ng = &hits[0].normal.x; query.ng_stride = sizeof hits[0];`. A column that is NULL is not read or not computed. Values
/// that are written may overlap nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_ray_query {
    /// `sizeof(etd_ray_query)`, set by the caller (`ETD_RAY_QUERY_INIT`).
    pub struct_size: usize,
    /// Number of rays.
    pub count: usize,
    /// Greatest number of the device's threads that trace the rays. 0 and 1 stand for the calling thread alone, which few rays
    /// never leave.
    pub threads: u32,
    /// 0.
    pub reserved: u32,
    /// Three floats a ray: where its t is 0, world frame.
    pub origins: *const f32,
    /// Bytes from one origin to the next.
    pub origins_stride: usize,
    /// Three floats a ray: direction of any length except zero. The length is the unit of t.
    pub directions: *const f32,
    /// Bytes from one direction to the next.
    pub directions_stride: usize,
    /// Starts of the segments, >= 0; NULL for 0.
    pub tnear: *const f32,
    /// Bytes from one start to the next.
    pub tnear_stride: usize,
    /// Ends of the segments, which may be infinite; NULL for infinity.
    pub tfar: *const f32,
    /// Bytes from one end to the next.
    pub tfar_stride: usize,
    /// Moments in [0, 1] of the shutter interval, of a scene with motion; NULL for 0, the opening.
    pub times: *const f32,
    /// Bytes from one moment to the next.
    pub times_stride: usize,
    /// A byte a ray: where it is 0, the ray is not traced, and nothing is written for it. NULL for all rays.
    pub active: *const u8,
    /// Bytes from one ray's byte to the next.
    pub active_stride: usize,
    /// A byte a ray: 1 where anything is in the segment, otherwise 0. If nothing else is wanted, rays end at any surface, which is
    /// faster than to look for the first.
    pub occluded: *mut u8,
    /// Bytes from one answer to the next.
    pub occluded_stride: usize,
    /// Distance of the first hit in lengths of the direction, infinite without a hit.
    pub t: *mut f32,
    /// Bytes from one distance to the next.
    pub t_stride: usize,
    /// Three doubles a ray: the point that is hit, world frame. It is computed on the surface, so its error does not grow with the
    /// length of the ray. Without a hit 0, as all that follows unless it says otherwise.
    pub positions: *mut f64,
    /// Bytes from one position to the next.
    pub positions_stride: usize,
    /// Two floats a ray, as `etd_hit.barycentric`.
    pub barycentric: *mut f32,
    /// Bytes from one pair of weights to the next.
    pub barycentric_stride: usize,
    /// Two floats a ray, as `etd_hit.uv`.
    pub uv: *mut f32,
    /// Bytes from one pair of coordinates to the next.
    pub uv_stride: usize,
    /// Three floats a ray, as `etd_hit.ng`.
    pub ng: *mut f32,
    /// Bytes from one geometric normal to the next.
    pub ng_stride: usize,
    /// Three floats a ray, as `etd_hit.ns`.
    pub ns: *mut f32,
    /// Bytes from one shading normal to the next.
    pub ns_stride: usize,
    /// Numbers of the surfaces; `ETD_NONE` without a hit.
    pub surfaces: *mut u32,
    /// Bytes from one surface to the next.
    pub surfaces_stride: usize,
    /// Numbers of the surfaces' materials; `ETD_NONE` for a surface without one, and without a hit.
    pub materials: *mut u32,
    /// Bytes from one material to the next.
    pub materials_stride: usize,
    /// As `etd_hit.primitive`.
    pub primitives: *mut u32,
    /// Bytes from one primitive to the next.
    pub primitives_stride: usize,
}

/// Information about a built scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_info {
    /// `sizeof(etd_scene_info)`.
    pub struct_size: usize,
    /// Number of surfaces in the description, including removed ones.
    pub surfaces: u64,
    /// Number of materials in the description.
    pub materials: u64,
    /// Number of meshes in the description.
    pub meshes: u64,
    /// Number of point lights in the description.
    pub point_lights: u64,
    /// Number of triangles that are stored in the scene's own frame.
    pub triangles: u64,
    /// Number of instances of meshes.
    pub instances: u64,
    /// Number of triangles of instanced meshes; each mesh counts once.
    pub shared_triangles: u64,
    /// Number of spheres, disks and quadrics.
    pub analytic_shapes: u64,
    /// Number of emitters that light sampling uses.
    pub emitters: u64,
    /// Bytes of the library's vertices, indices, normals and precomputed shading data.
    pub geometry_bytes: u64,
    /// Bytes of Embree's hierarchies.
    pub hierarchy_bytes: u64,
    /// Smallest corner of the box around all surfaces, world frame.
    pub bounds_min: [f64; 3],
    /// Largest corner.
    pub bounds_max: [f64; 3],
    /// Seconds that the last build took.
    pub build_time: f64,
    /// Number of textures that materials of surfaces use.
    pub textures: u64,
    /// Bytes of the images of these textures and of their smaller levels, without texels that the host keeps.
    pub texture_bytes: u64,
}

/// A text about a scene.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_text {
    /// Information about what was built and decided, one line for each item.
    ETD_TEXT_INFO = 0,
    /// Warnings from reading and building, one line for each.
    ETD_TEXT_WARNINGS = 1,
}

enumerations! {
    etd_text: ETD_TEXT_INFO, ETD_TEXT_WARNINGS;
}

versioned! {
    etd_ray_query, primitives_stride;
    etd_scene_info, build_time;
}
