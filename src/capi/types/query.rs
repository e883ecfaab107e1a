//! What scenes are asked, and what they answer.

pub use etd_text::*;

/// A ray segment: origin + t * direction for t in [tnear, tfar], world frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_ray {
    /// Where t is 0.
    pub origin: [f32; 3],
    /// Start of the segment, >= 0.
    pub tnear: f32,
    /// Any length that is not zero; t counts in this length.
    pub direction: [f32; 3],
    /// End of the segment; may be infinite.
    pub tfar: f32,
}

/// What a ray met first.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_hit {
    /// Distance in lengths of the ray's direction; infinite where nothing was met, and then nothing else is set but
    /// `surface`.
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
    /// Number of the surface; `ETD_NONE` where nothing was met.
    pub surface: u32,
    /// Number of its material.
    pub material: u32,
    /// Number of the triangle in its mesh, 0 or 1 in a quad, else 0.
    pub primitive: u32,
}

/// What a built scene holds.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_info {
    /// `sizeof(etd_scene_info)`.
    pub struct_size: usize,
    /// Surfaces described, removed ones included.
    pub surfaces: u64,
    /// Materials described.
    pub materials: u64,
    /// Meshes described.
    pub meshes: u64,
    /// Point lights described.
    pub point_lights: u64,
    /// Triangles that are kept in the scene's own frame.
    pub triangles: u64,
    /// Instances of meshes.
    pub instances: u64,
    /// Triangles of the instanced meshes, each mesh counted once.
    pub shared_triangles: u64,
    /// Spheres, disks and quadrics.
    pub analytic_shapes: u64,
    /// Emitters that can be sampled.
    pub emitters: u64,
    /// Bytes of vertices, indices and normals that belong to the library, and of what is kept ready for shading.
    pub geometry_bytes: u64,
    /// Bytes of Embree's hierarchies.
    pub hierarchy_bytes: u64,
    /// Smallest corner of the box around all surfaces, world frame.
    pub bounds_min: [f64; 3],
    /// Largest corner.
    pub bounds_max: [f64; 3],
    /// Seconds that the last build took.
    pub build_time: f64,
}

/// A text about a scene.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_text {
    /// What was built and decided, a line each.
    ETD_TEXT_INFO = 0,
    /// Warnings from reading and building, a line each.
    ETD_TEXT_WARNINGS = 1,
}

enumerations! {
    etd_text: ETD_TEXT_INFO, ETD_TEXT_WARNINGS;
}

versioned! {
    etd_scene_info, build_time;
}
