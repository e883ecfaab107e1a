//! Types that describe scenes.

use std::ffi::{c_char, c_void};

use super::device::etd_release_fn;
use super::material::etd_principled;
use super::numbers::{
    EtdBsdf, EtdCameraType, EtdDistribution, EtdFocus, EtdFovAxis, EtdMasking, EtdPositionFormat, EtdSharing, EtdUsage,
};
use super::render::etd_progress_fn;
pub use {
    etd_bsdf::*, etd_camera_type::*, etd_focus::*, etd_fov_axis::*, etd_position_format::*, etd_sharing::*,
    etd_usage::*,
};

/// How the geometry of a scene is stored.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_usage {
    /// All geometry is in one hierarchy where possible, which is fastest to trace. At the first change of geometry after a
    /// build, the scene becomes dynamic.
    ETD_USAGE_STATIC = 0,
    /// Every larger mesh has a hierarchy of its own, and so have single triangles and single shapes where they are many, so that the others
    /// are not rebuilt when a surface is added, moved or removed.
    ETD_USAGE_DYNAMIC = 1,
}

/// Options of a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_scene_options {
    /// `sizeof(etd_scene_options)`.
    pub struct_size: usize,
    /// An `etd_usage`.
    pub usage: EtdUsage,
    /// Must be 0.
    pub reserved: u32,
    /// The folder to which paths of mesh files in a scene from text are relative; NULL: the current folder.
    pub base_dir: *const c_char,
    /// A parameter file of the report's renderer that overrides the scene's own settings; NULL: none.
    pub params_file: *const c_char,
    /// Progress callback of the calls that read a scene; may be NULL. It receives the fraction of the bytes of mesh
    /// files and images that are read, on one of the reading threads, and cancels the reading if it returns anything but 0.
    pub progress: etd_progress_fn,
    /// Passed to the callback.
    pub user_data: *mut c_void,
}

/// The projection of a camera.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_camera_type {
    /// A pinhole at `origin`, or a thin lens around it.
    ETD_CAMERA_PERSPECTIVE = 0,
    /// The report's camera: `origin` is the centre of a view plane, the eye lies behind it, and the length of `up` scales
    /// the plane.
    ETD_CAMERA_VIEW_PLANE = 1,
    /// Parallel rays from the plane through `origin`; what is behind the plane is not seen.
    ETD_CAMERA_ORTHOGRAPHIC = 2,
    /// All directions: longitude across the width, latitude across the height. `fov_deg` is not read.
    ETD_CAMERA_SPHERICAL = 3,
    /// The mantle of an upright cylinder around the eye: `fov_deg` in (0, 360] across the width, and as high as pixels that are square
    /// at the horizon make it.
    ETD_CAMERA_CYLINDRICAL = 4,
    /// A circle by the equisolid projection, black beyond: `fov_deg` in (0, 360] across the circle, which spans `fov_axis`.
    ETD_CAMERA_FISHEYE = 5,
}

/// The side of the image that a camera's field of view spans, or the `size` of an orthographic one.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_fov_axis {
    /// The width.
    ETD_FOV_HORIZONTAL = 0,
    /// The height; perspective and orthographic cameras only.
    ETD_FOV_VERTICAL = 1,
}

/// Where the lens of a camera is in focus.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_focus {
    /// On the plane through `look_at` across the view direction.
    ETD_FOCUS_LOOK_AT = 0,
    /// On the plane at `focus_distance` from `origin`.
    ETD_FOCUS_DISTANCE = 1,
    /// On the plane through `focus_at`.
    ETD_FOCUS_POINT = 2,
}

/// A camera in the world frame, which is right-handed, with lengths in scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_camera {
    /// `sizeof(etd_camera)`.
    pub struct_size: usize,
    /// An `etd_camera_type`.
    pub projection: EtdCameraType,
    /// An `etd_fov_axis`.
    pub fov_axis: EtdFovAxis,
    /// The eye, or the centre of the view plane.
    pub origin: [f64; 3],
    /// A point that is seen in the middle of the image, or off it by `shift`, other than `origin`.
    pub look_at: [f64; 3],
    /// The direction that is up in the image, of any length and not parallel to the view direction.
    pub up: [f64; 3],
    /// Full angle of view, degrees, between 0 and 180. An orthographic camera does not read it.
    pub fov_deg: f64,
    /// Orthographic cameras: what the image spans across `fov_axis`, scene units, above 0. 0 for other cameras.
    pub size: f64,
    /// Perspective cameras: radius of the lens, scene units. 0 is a pinhole. The fields below say more of the lens; other cameras
    /// have 0 in all of them.
    pub lens_radius: f64,
    /// An `etd_focus`.
    pub focus: EtdFocus,
    /// Number of sides of the aperture, a regular polygon in the circle of the lens: 3 to 32. 0 is the whole disk.
    pub blades: u32,
    /// `ETD_FOCUS_DISTANCE`: distance of the plane in focus along the view direction, scene units, above 0.
    pub focus_distance: f64,
    /// `ETD_FOCUS_POINT`: a point of the plane in focus, in front of the camera.
    pub focus_at: [f64; 3],
    /// Degrees by which the polygon is turned counter-clockwise in the image. At 0, one of its vertices is at the right.
    pub blade_rotation_deg: f64,
    /// Number by which the aperture's width is divided, after it is turned: 0.01 to 100. 0 means 1.
    pub squeeze: f64,
    /// Perspective and orthographic cameras: how far the film is moved against the view axis, to the right in widths of the image and
    /// upwards in heights of the image, each -100 to 100. 0 for other cameras.
    pub shift: [f64; 2],
    /// Width of a pixel over its height, 0.01 to 100. 0 means 1; view-plane and spherical cameras have 0.
    pub pixel_aspect: f64,
}

/// How a surface scatters light.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_bsdf {
    /// A surface that absorbs all light.
    ETD_BSDF_BLACK = 0,
    /// Lambert's model, with `color`.
    ETD_BSDF_LAMBERT = 1,
    /// Fujii's improved Oren-Nayar model, with `color` and `roughness`.
    ETD_BSDF_OREN_NAYAR = 2,
    /// Oren and Nayar's qualitative model, with `color` and `sigma_deg`.
    ETD_BSDF_OREN_NAYAR_QUALITATIVE = 3,
    /// A perfect mirror, with `color`.
    ETD_BSDF_MIRROR = 4,
    /// A smooth dielectric such as clear glass, with `ior` and `exterior_ior`.
    ETD_BSDF_DIELECTRIC = 5,
    /// Portsmouth, Kutz and Hill's energy-preserving rough diffuse model (EON), with `color` and `roughness`.
    ETD_BSDF_EON = 6,
    /// A thin sheet that scatters light diffusely on both sides: `color` is the share that it reflects and `transmittance` the
    /// share that it transmits. Both sum to 1 at most per channel.
    ETD_BSDF_DIFFUSE_TRANSMISSION = 7,
    /// Fibres that stand up from a surface (Estevez and Kulla 2017), with `color` and `roughness`. A roughness of 0 means 0.5.
    ETD_BSDF_SHEEN = 8,
    /// A metal, smooth or rough: `eta` and `k`, or `color` and `edge_tint`, and the facets.
    ETD_BSDF_CONDUCTOR = 9,
    /// A rough dielectric such as frosted glass, with `ior`, `exterior_ior` and the facets.
    ETD_BSDF_ROUGH_DIELECTRIC = 10,
    /// A thin sheet of clear or tinted glass, smooth or rough, with `ior`, `exterior_ior`, `transmittance` and the facets.
    ETD_BSDF_THIN_DIELECTRIC = 11,
    /// A diffuse surface of albedo `color` under a clear coat, such as plastic, with `ior` and `exterior_ior` of the coat and
    /// the coat's facets. `single_scattering` is ignored.
    ETD_BSDF_COATED_DIFFUSE = 12,
    /// One model with the parameters of OpenPBR, which are in `principled`.
    ETD_BSDF_PRINCIPLED = 13,
    /// A sum of the materials `first` and `second`, with `weight`.
    ETD_BSDF_MIX = 14,
    /// The material `first` on the normal's side of a surface and `second` on the other side. Neither may transmit light.
    ETD_BSDF_TWO_SIDED = 15,
}

/// A material. Fields that its model does not use are ignored; `etd_bsdf` says which fields each model uses.
///
/// The facets of a rough surface are `roughness`, `anisotropy`, `rotation_deg`, `distribution`, `masking` and
/// `single_scattering`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_material {
    /// `sizeof(etd_material)`.
    pub struct_size: usize,
    /// An `etd_bsdf`.
    pub bsdf: EtdBsdf,
    /// Albedo or reflectance, linear, [0, 1] per channel.
    pub color: [f32; 3],
    /// Roughness in [0, 1], as in files: Fujii's sigma' for `ETD_BSDF_OREN_NAYAR`, the roughness of EON and of sheen, and for
    /// facets the perceptual roughness, whose square is the width alpha of their distribution. Facets of roughness 0 are a
    /// smooth surface.
    pub roughness: f32,
    /// Standard deviation of the facets' slope angle, degrees, in [0, 90].
    pub sigma_deg: f32,
    /// Index of refraction on the side opposite to the normal, > 0.
    pub ior: f32,
    /// Index of refraction on the normal's side, > 0; 0 means 1.
    pub exterior_ior: f32,
    /// Survival probability of Russian roulette at this material, in (0, 1], for renders with `ETD_ROULETTE_FILE`. With 0, the
    /// library chooses the probability in these renders too. It changes noise and time, never the expected image.
    pub survival: f32,
    /// Must be 0.
    pub reserved: u32,
    /// Absorption coefficient inside of a dielectric [1 / scene unit], each channel >= 0: after a distance d, exp(-absorption d)
    /// of the light is left.
    pub absorption: [f32; 3],
    /// Priority of the medium inside of a dielectric. Where bodies overlap, the medium with the largest number fills the overlap;
    /// among equal ones, it is the medium that a ray entered last.
    pub priority: u32,
    /// How much narrower facets are spread across the tangent than along it, in [0, 0.99].
    pub anisotropy: f32,
    /// Angle from the surface's tangent to the direction of the larger spread of facets, degrees in [-360, 360],
    /// counter-clockwise about the normal.
    pub rotation_deg: f32,
    /// An `etd_distribution`.
    pub distribution: EtdDistribution,
    /// An `etd_masking`.
    pub masking: EtdMasking,
    /// 0: light that facets scatter more than once is included; 1: it is left out. It is always left out with
    /// `ETD_MASKING_V_CAVITY`.
    pub single_scattering: u32,
    /// `ETD_BSDF_DIFFUSE_TRANSMISSION`: the share of the light that is transmitted, [0, 1] per channel.
    /// `ETD_BSDF_THIN_DIELECTRIC`: what is left of light that crossed the sheet once along the normal, [0, 1] per channel. For
    /// that model, three zeros mean clear glass, as three ones do; a sheet that lets no light through has three times -1.
    pub transmittance: [f32; 3],
    /// Index of refraction of a conductor per channel, > 0. Three zeros: the conductor is described by `color`, its reflectance
    /// at normal incidence, and `edge_tint`. `etd_metal` has the indices of measured metals.
    pub eta: [f32; 3],
    /// Extinction coefficient of a conductor per channel, >= 0, used with `eta`.
    pub k: [f32; 3],
    /// Tint of the edge of a conductor that is described by `color`, [0, 1] per channel (Gulbrandsen 2014). With 1 its
    /// reflectance rises steadily towards grazing angles, and with 0 it falls before it rises. Three zeros are this 0; the
    /// initialiser has ones, the default of files.
    pub edge_tint: [f32; 3],
    /// `ETD_BSDF_MIX`, `ETD_BSDF_TWO_SIDED`: number of a material, which must be lower than the material's own number.
    pub first: u32,
    /// As `first`.
    pub second: u32,
    /// `ETD_BSDF_MIX`: the share of `second`, in [0, 1].
    pub weight: f32,
    /// `ETD_BSDF_PRINCIPLED`: the parameters, which are read during the call only; must not be NULL for this model.
    /// `etd_scene_get_material` sets the pointer to NULL; `etd_scene_get_principled` returns the parameters.
    pub principled: *const etd_principled,
    /// Probability with which a ray meets a surface of the material, in [0, 1]; other rays pass straight on. 0 means 1, and -1
    /// stands for 0. A material that emits light is opaque.
    pub opacity: f32,
    /// Emitted radiance on the normal's side [W m^-2 sr^-1], each channel >= 0, of all surfaces of the material that have no
    /// emission of their own. Three zeros: none. Quadrics and disks cannot have a material that emits.
    pub emission: [f32; 3],
    /// Abbe number (n_d - 1) / (n_F - n_C) of a dielectric, > 0: the smaller, the more its index depends on the wavelength, by
    /// Cauchy's formula with `ior` at 587.56 nm. Only renders in wavelengths (`etd_render_options.spectral`) show it. 0: the same
    /// index for all wavelengths.
    pub abbe: f32,
    /// Strengths of Sellmeier's formula n^2 = 1 + sum of strength lambda^2 / (lambda^2 - resonance) for a dielectric, lambda in
    /// micrometres, in place of `abbe`; unused ones are 0. `ior` is then not read: the index is that of the formula.
    pub sellmeier_strengths: [f32; 4],
    /// Squares of the resonant wavelengths of Sellmeier's formula, micrometre^2.
    pub sellmeier_resonances: [f32; 4],
    /// Must be 0.
    pub reserved_1: u32,
    /// Thickness of a thin film on the outer side of a dielectric or a conductor, nanometres, in [0, 10000]. 0: no film.
    pub film_thickness: f32,
    /// Index of refraction of the film, above 0 and up to 100. Without a film it is not read.
    pub film_ior: f32,
}

/// The format of an array of positions.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_position_format {
    /// Three values of type `float`.
    ETD_POSITION_FLOAT3 = 0,
    /// Three values of type `double`, which are always copied.
    ETD_POSITION_DOUBLE3 = 1,
}

/// Whether the arrays of a mesh are copied or shared.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_sharing {
    /// The arrays are copied during the call.
    ETD_COPY = 0,
    /// The arrays are read in place. They must neither change nor be freed until `release` is called. Positions must be of type
    /// `float`, and 16 bytes must be readable from the last position on. A mesh that emits light is copied when it is built.
    ETD_SHARE = 1,
}

/// A triangle mesh in arrays of the host.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_mesh {
    /// `sizeof(etd_mesh)`.
    pub struct_size: usize,
    /// One position for each vertex, in the mesh's own frame.
    pub positions: *const c_void,
    /// Bytes from one position to the next; 0: positions without gaps.
    pub position_stride: usize,
    /// Number of readable bytes from `positions` on; 0: up to the end of the last stride. Used only with `ETD_SHARE`.
    pub position_bytes: usize,
    /// Number of vertices, at least 1 and below 2^32 - 1.
    pub vertex_count: usize,
    /// Three vertex numbers for each triangle, counter-clockwise seen from outside.
    pub indices: *const u32,
    /// Bytes from one triangle's numbers to those of the next; 0: triangles without gaps.
    pub index_stride: usize,
    /// Number of triangles, at least 1 and below 2^32 - 1.
    pub triangle_count: usize,
    /// One normal for each vertex, of any length; NULL: none.
    pub normals: *const f32,
    /// Bytes from one normal to the next; 0: normals without gaps.
    pub normal_stride: usize,
    /// One texture coordinate for each vertex; NULL: none.
    pub uvs: *const f32,
    /// Bytes from one texture coordinate to the next; 0: coordinates without gaps.
    pub uv_stride: usize,
    /// An `etd_position_format`.
    pub position_format: EtdPositionFormat,
    /// An `etd_sharing`.
    pub sharing: EtdSharing,
    /// With `ETD_SHARE`: called once the arrays are no longer read; may be NULL. It is not called if adding the mesh fails.
    pub release: etd_release_fn,
    /// Passed to `release`.
    pub user_data: *mut c_void,
    /// Name of the mesh, unique among meshes; NULL: none.
    pub name: *const c_char,
    /// One colour for each vertex, for textures with `vertex_colors`: red, green and blue in linear light, each >= 0, and opacity in
    /// [0, 1]; NULL: none. Colours are always copied.
    pub colors: *const f32,
    /// Bytes from one colour to the next; 0: colours without gaps.
    pub color_stride: usize,
    /// The sets 1, 2, ... of texture coordinates for textures with `uv_set`, each with one texture coordinate for each vertex, or
    /// NULL; NULL: none. They are always copied.
    pub further_uvs: *const *const f32,
    /// Number of further sets, 7 at most.
    pub further_uv_count: u32,
    /// Bytes from one texture coordinate of a further set to the next; 0: coordinates without gaps.
    pub further_uv_stride: usize,
    /// One tangent for each vertex, of any length, for normal maps on smooth surfaces: the direction in which u grows; NULL: those of
    /// MikkTSpace. They are always copied.
    pub tangents: *const f32,
    /// Bytes from one tangent to the next; 0: tangents of three numbers without gaps.
    pub tangent_stride: usize,
}

/// The properties of a surface other than its shape.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_surface {
    /// `sizeof(etd_surface)`.
    pub struct_size: usize,
    /// Number of the surface's material; `ETD_NONE` for a surface that emits light and reflects none.
    pub material: u32,
    /// Emitted radiance on the normal's side [W m^-2 sr^-1], or the factor on the surface's web where `etd_scene_set_surface_web` gave it
    /// one; three zeros for a surface that does not emit. Of the quadrics, only
    /// cylinders can emit.
    pub emission: [f32; 3],
    /// Transform from the object frame to the world frame, three rows of four numbers whose last column is the translation;
    /// twelve zeros stand for the identity.
    pub transform: [f64; 12],
    /// If not 0, the surface emits on its other side too, with the same radiance: it must emit, and be no sphere.
    pub emits_both: u32,
    /// 0.
    pub reserved: u32,
}

enumerations! {
    etd_usage: ETD_USAGE_STATIC, ETD_USAGE_DYNAMIC;
    etd_camera_type: ETD_CAMERA_PERSPECTIVE, ETD_CAMERA_VIEW_PLANE, ETD_CAMERA_ORTHOGRAPHIC, ETD_CAMERA_SPHERICAL,
        ETD_CAMERA_CYLINDRICAL, ETD_CAMERA_FISHEYE;
    etd_focus: ETD_FOCUS_LOOK_AT, ETD_FOCUS_DISTANCE, ETD_FOCUS_POINT;
    etd_fov_axis: ETD_FOV_HORIZONTAL, ETD_FOV_VERTICAL;
    etd_bsdf:
        ETD_BSDF_BLACK, ETD_BSDF_LAMBERT, ETD_BSDF_OREN_NAYAR, ETD_BSDF_OREN_NAYAR_QUALITATIVE, ETD_BSDF_MIRROR,
        ETD_BSDF_DIELECTRIC, ETD_BSDF_EON, ETD_BSDF_DIFFUSE_TRANSMISSION, ETD_BSDF_SHEEN, ETD_BSDF_CONDUCTOR,
        ETD_BSDF_ROUGH_DIELECTRIC, ETD_BSDF_THIN_DIELECTRIC, ETD_BSDF_COATED_DIFFUSE, ETD_BSDF_PRINCIPLED, ETD_BSDF_MIX,
        ETD_BSDF_TWO_SIDED;
    etd_position_format: ETD_POSITION_FLOAT3, ETD_POSITION_DOUBLE3;
    etd_sharing: ETD_COPY, ETD_SHARE;
}

versioned! {
    etd_scene_options, params_file;
    etd_camera, fov_deg;
    etd_material, reserved;
    etd_mesh, name;
    etd_surface, transform;
}
