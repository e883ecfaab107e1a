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
    etd_scene_info, build_time;
}
