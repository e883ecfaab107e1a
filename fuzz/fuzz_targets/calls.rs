//! Any sequence of calls with any arguments: a status comes back, and nothing breaks.
//!
//! Handles are alive or NULL, as a program's are; numbers, counts, strides and enumerations are anything. Arrays are as
//! large as the calls say they are: no library can see through a pointer.

#![no_main]

use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};

use arbitrary::Arbitrary;
use etendue::capi::*;
use etendue::desc::IntegratorDesc;
use libfuzzer_sys::fuzz_target;

#[derive(Arbitrary, Debug)]
enum Call {
    Camera { projection: u8, axis: u8, origin: [f64; 3], look_at: [f64; 3], up: [f64; 3], fov: f64 },
    Lens { projection: u8, focus: u8, blades: u8, numbers: [f64; 4], point: [f64; 3] },
    CameraFilm { projection: u8, shift: [f64; 2], aspect: f64 },
    SaneCamera { origin: [i8; 3], lens: [u8; 4], shift: [i8; 2], aspect: u8, is_parallel: bool },
    AddMaterial { bsdf: u8, color: [f32; 3], numbers: [f32; 5], name: Option<u8> },
    SaneMaterial { bsdf: u8, color: [u8; 3] },
    SetMaterial { material: u8, bsdf: u8, color: [f32; 3], numbers: [f32; 5] },
    AddLight { position: [f64; 3], intensity: [f32; 3] },
    SetLight { light: u8, position: [f64; 3], intensity: [f32; 3] },
    SpotLight { light: Option<u8>, position: [f64; 3], direction: [f64; 3], intensity: [f32; 3], angles: [f64; 2] },
    SaneSpotLight { position: [i8; 3], direction: [i8; 3], angles: [u8; 2] },
    WebLight {
        light: Option<u8>,
        text: Vec<u8>,
        position: [f64; 3],
        direction: [f64; 3],
        c0: [f64; 3],
        factor: [f32; 3],
        tilt: f64,
    },
    Environment { radiance: Option<[f32; 3]> },
    Portals { corners: Vec<[[f64; 3]; 4]>, count: u16 },
    EnvironmentMap { texture: u8, projection: u8, hidden: u8, radiance: [f32; 3], up: [f64; 3], rotation: f64 },
    SaneEnvironmentMap { texture: u8, rotation: i8 },
    Backplate { texture: u8, radiance: [f32; 3], none: bool },
    DistantLight { light: Option<u8>, towards: [f64; 3], irradiance: [f32; 3], angle: f64, hidden: u8 },
    Sky {
        cie: u8,
        flags: [u8; 3],
        radiance: [f32; 3],
        ground: [f32; 3],
        perez: [f64; 5],
        turbidity: Option<[f64; 2]>,
        sun: [f64; 3],
        up: [f64; 3],
    },
    SaneSky { cie: u8, sun: [i8; 2], angle: u8, turbidity: u8 },
    Sun { place: [f64; 3] },
    AddShape { kind: u8, numbers: [f64; 12], material: u8, emission: [f32; 3], transform: Option<[f64; 12]> },
    SaneShape { kind: u8, numbers: [i8; 12], material: u8, glow: u8, shift: [i8; 3] },
    AddMesh { vertices: Vec<[f32; 3]>, triangles: Vec<[u8; 3]>, flags: u8, stride: u8 },
    SetMesh { mesh: u8, vertices: Vec<[i8; 3]>, triangles: Vec<[u8; 3]>, flags: u8 },
    RemoveMesh { mesh: u8 },
    MeshFrom { mesh: u8, name: Option<u8> },
    AddGroup { surfaces: [u8; 3], count: u8, name: Option<u8> },
    PlaceGroup { group: u8, transform: Option<[f64; 12]> },
    SanePlacement { group: u8, shift: [i8; 3], scale: i8 },
    MovePlacement { placement: u8, shift: [i8; 3], scale: i8 },
    RemovePlacement { placement: u8 },
    RemoveGroup { group: u8 },
    AddMeshSurface { mesh: u8, smooth: u8, material: u8, glow: u8, shift: [i8; 3] },
    AddTexture { kind: u8, size: [u8; 3], format: u8, numbers: [f32; 8], texels: Vec<u8>, name: Option<u8> },
    SetTexture { texture: u8, kind: u8, size: [u8; 3], format: u8, numbers: [f32; 8], texels: Vec<u8> },
    UpdateTexture { texture: u8 },
    BindTexture { material: u8, parameter: u8, texture: u8, channel: u8, strength: f32 },
    RemoveSurface { surface: u8 },
    SetTransform { surface: u8, rows: [f64; 12] },
    SaneTransform { surface: u8, shift: [i8; 3], scale: i8 },
    SetSurfaceMaterial { surface: u8, material: u8 },
    SetEmission { surface: u8, radiance: Option<[f32; 3]> },
    SetEmitsBoth { surface: u8, both: bool },
    SurfaceWeb { surface: u8, text: Option<Vec<u8>>, c0: [f64; 3], tilt: f64 },
    SaneSurfaceWeb { surface: u8, candela: [u8; 3], c0: [i8; 3] },
    Spectrum { target: u8, number: u8, kind: u8, illuminant: u8, temperature: f64, samples: Option<Vec<[f64; 2]>> },
    SaneSpectrum { target: u8, number: u8, first: u8, values: [u8; 4] },
    GetSurface { surface: u8 },
    Commit { cancel: bool },
    Film { width: u8, height: u8, layers: u16 },
    Resize { width: u8, height: u8 },
    Render { integrator: u8, sampler: u8, filter: u8, parameters: [f32; 2], samples: u8, depth: u8, film: bool },
    RenderPart { integrator: u8, sampler: u8, picture: [u8; 2], crop: [u32; 2] },
    Start { integrator: u8, samples: u32, time: f64, error: f64 },
    Poll,
    Wait {
        seconds: u8,
    },
    Cancel,
    Resume,
    ReleaseTask,
    Map {
        layer: u8,
    },
    Unmap {
        which: u8,
    },
    Copy {
        layer: u8,
        format: u8,
        tone_map: u8,
        exposure: f32,
        stride: u16,
        bottom_up: u8,
    },
    Intersect {
        rays: Vec<[f32; 8]>,
    },
    Occluded {
        rays: Vec<[f32; 8]>,
    },
    Query {
        rays: Vec<[f32; 8]>,
        threads: u16,
        strides: [u8; 2],
        wanted: u16,
    },
    Text {
        which: u8,
        capacity: u8,
    },
    NewScene {
        dynamic: u8,
    },
}

unsafe extern "C" fn stop(_: *mut c_void, _: *const etd_progress) -> i32 {
    1
}

/// Memory of a shared mesh, freed by the library's word.
unsafe extern "C" fn free(memory: *mut c_void) {
    // SAFETY: the box that was given with the mesh.
    drop(unsafe { Box::from_raw(memory.cast::<(Vec<[f32; 4]>, Vec<[u32; 3]>)>()) });
}

fn sized<T>() -> T {
    // SAFETY: the structures of the interface are valid when zero, and begin with their size.
    unsafe {
        let mut value: T = std::mem::zeroed();
        (&raw mut value).cast::<usize>().write(size_of::<T>());
        value
    }
}

/// How many integrators there are; their values in C have no gap.
const INTEGRATORS: u32 = IntegratorDesc::ALL.len() as u32;

/// Options with which no integrator takes long to prepare.
fn quick() -> etd_render_options {
    etd_render_options {
        photon_count: 1 << 10,
        caustic_count: 1 << 10,
        cache_rays: 16,
        radiosity_error: 1000.0,
        radiosity_memory: 1,
        ..sized()
    }
}

struct World {
    device: *mut etd_device,
    scene: *mut etd_scene,
    film: *mut etd_film,
    task: *mut etd_task,
    maps: Vec<etd_map>,
}

/// A status that a correct library may give.
fn fine(status: etd_status) -> etd_status {
    assert!(!matches!(status, ETD_PANIC | ETD_INTERNAL | ETD_INVALID_HANDLE), "{status:?}");
    status
}

fn material(bsdf: u8, color: [f32; 3], n: [f32; 5]) -> etd_material {
    etd_material {
        bsdf: u32::from(bsdf),
        color,
        roughness: n[0],
        sigma_deg: n[1],
        ior: n[2],
        exterior_ior: n[3],
        survival: n[4],
        ..sized()
    }
}

/// The names of parameters, and one that is none.
const PARAMETERS: [&std::ffi::CStr; 10] = [
    c"color",
    c"roughness",
    c"base_color",
    c"opacity",
    c"normal",
    c"bump",
    c"weight",
    c"hue",
    c"filmThickness",
    c"temperature",
];

/// A texture whose texels are in `texels`, which is made large enough.
fn texture(kind: u8, size: [u8; 3], format: u8, n: [f32; 8], texels: &mut Vec<u8>) -> etd_texture {
    let [width, height, channels] = size.map(u32::from);
    let channels = channels % 6;
    texels.resize(width as usize * height as usize * channels as usize * 4 + 8, 7);
    let [a, b, c, d, e, f, g, h] = n;
    etd_texture {
        kind: u32::from(kind % 10),
        color_space: u32::from(format >> 2 & 3),
        texels: texels.as_ptr().wrapping_add(texels.as_ptr().align_offset(4)).cast(),
        width,
        height,
        channels,
        texel_format: u32::from(format & 3),
        filter: u32::from(format >> 4 & 7),
        wrap_u: u32::from(kind >> 4 & 3),
        wrap_v: u32::from(kind >> 6),
        colors: [[a, b, c], [d, e, f]],
        line_width: g,
        turbulence: h,
        octaves: u32::from(format >> 4),
        coordinates: u32::from(format >> 5),
        scale: [g.into(), h.into(), 1.0],
        vertex_colors: u32::from(kind >> 5 & 1),
        uv_set: u32::from(kind >> 4),
        ..sized()
    }
}

fn look(material: u8, emission: [f32; 3], transform: [f64; 12]) -> etd_surface {
    let material = if material == 255 { ETD_NONE } else { u32::from(material % 4) };
    etd_surface { material, emission, transform, ..sized() }
}

fn shifted(shift: [i8; 3], scale: f64) -> [f64; 12] {
    let [x, y, z] = shift.map(|n| f64::from(n) / 16.0);
    [scale, 0.0, 0.0, x, 0.0, scale, 0.0, y, 0.0, 0.0, scale, z]
}

impl World {
    fn new() -> Self {
        let mut world =
            Self { device: null_mut(), scene: null_mut(), film: null_mut(), task: null_mut(), maps: Vec::new() };
        let options = etd_device_options { threads: 2, memory_limit: 1 << 29, ..sized() };
        // SAFETY: the pointers are to what they say.
        unsafe {
            assert_eq!(etd_device_new(&raw const options, &raw mut world.device), ETD_OK);
            assert_eq!(etd_scene_new(world.device, null(), &raw mut world.scene), ETD_OK);
        }
        world
    }

    /// # Safety
    /// The handles are alive or NULL.
    unsafe fn shape(&self, kind: u8, n: &[f64; 12], surface: &etd_surface) -> etd_status {
        let mut number = 0;
        let (scene, out) = (self.scene, &raw mut number);
        let at = |i: usize| n[i..].as_ptr();
        // SAFETY: the arrays are as long as each call reads.
        unsafe {
            match kind % 9 {
                0 => etd_scene_add_sphere(scene, at(0), n[3], surface, out),
                1 => etd_scene_add_triangle(scene, at(0), surface, out),
                2 => etd_scene_add_quad(scene, at(0), surface, out),
                3 => etd_scene_add_disk(scene, at(0), at(3), n[6], surface, out),
                4 => etd_scene_add_cylinder(scene, at(0), at(3), n[6], n[7], surface, out),
                5 => etd_scene_add_cone(scene, at(0), at(3), n[6], n[7], surface, out),
                6 => etd_scene_add_paraboloid(scene, at(0), at(3), n[6], n[7], surface, out),
                7 => etd_scene_add_ellipsoid(scene, at(0), at(3), surface, out),
                _ => etd_scene_add_quadric(scene, at(0), null(), null(), surface, out),
            }
        }
    }

    /// # Safety
    /// The handles are alive or NULL.
    unsafe fn mesh(&self, replace: Option<u8>, vertices: Vec<[f32; 3]>, triangles: &[[u8; 3]], flags: u8, stride: u8) {
        let mut vertices: Vec<[f32; 4]> = vertices.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect();
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|triangle| triangle.map(u32::from)).collect();
        let count = vertices.len();
        vertices.push([0.0; 4]);
        let memory = Box::into_raw(Box::new((vertices, triangles)));
        // SAFETY: alive until freed below or by the library.
        let (positions, indices) = unsafe { (&(*memory).0, &(*memory).1) };
        let share = flags & 1 != 0;
        let mesh = etd_mesh {
            positions: positions.as_ptr().cast(),
            // A stride that the memory holds, or one that is refused.
            position_stride: if stride > 16 || stride % 4 == 0 { 16 } else { usize::from(stride) },
            position_bytes: positions.len() * 16,
            vertex_count: count,
            indices: indices.as_ptr().cast(),
            triangle_count: indices.len(),
            normals: if flags & 2 != 0 { positions.as_ptr().cast() } else { null() },
            normal_stride: 16,
            uvs: if flags & 4 != 0 { positions.as_ptr().cast() } else { null() },
            uv_stride: 16,
            colors: if flags & 64 != 0 { positions.as_ptr().cast() } else { null() },
            color_stride: 16,
            tangents: if flags & 128 != 0 { positions.as_ptr().cast() } else { null() },
            tangent_stride: 16,
            position_format: u32::from(flags >> 3 & 7 == 7) * 9,
            sharing: u32::from(share),
            release: Some(free),
            user_data: memory.cast(),
            ..sized()
        };
        let mut number = 0;
        // SAFETY: the arrays are as the structure says.
        let status = fine(unsafe {
            match replace {
                None => etd_scene_add_mesh(self.scene, &raw const mesh, &raw mut number),
                Some(mesh_number) => etd_scene_set_mesh(self.scene, u32::from(mesh_number), &raw const mesh),
            }
        });
        if status != ETD_OK || !share {
            // SAFETY: the library has not taken it over.
            unsafe { free(memory.cast()) }
        }
    }

    /// Puts a film in the place of the one there was that was saved and loaded, and merged if that is all of it.
    ///
    /// # Safety
    /// The handles are alive or NULL.
    unsafe fn move_film(&mut self) {
        let (mut size, mut loaded, mut merged) = (0, null_mut(), null_mut());
        // SAFETY: every pointer is to what the call reads or writes.
        unsafe {
            if fine(etd_film_save_memory(self.film, null_mut(), 0, &raw mut size)) != ETD_OK {
                return;
            }
            let mut bytes = vec![0_u8; size];
            assert_eq!(etd_film_save_memory(self.film, bytes.as_mut_ptr().cast(), size, null_mut()), ETD_OK);
            let bytes = bytes.as_ptr().cast();
            if fine(etd_film_load_memory(self.device, bytes, size, null(), &raw mut loaded)) != ETD_OK {
                return;
            }
            if fine(etd_film_merge(&raw const loaded, 1, &raw mut merged)) == ETD_OK {
                etd_film_release(loaded);
                loaded = merged;
            }
            self.maps.clear();
            etd_film_release(self.film);
            self.film = loaded;
        }
    }

    /// # Safety
    /// The handles are alive or NULL.
    unsafe fn call(&mut self, call: Call) {
        let scene = self.scene;
        let mut number = 0;
        // SAFETY: every pointer is to what the call reads or writes.
        unsafe {
            match call {
                Call::Camera { projection, axis, origin, look_at, up, fov } => {
                    let camera = etd_camera {
                        projection: u32::from(projection),
                        fov_axis: u32::from(axis),
                        origin,
                        look_at,
                        up,
                        fov_deg: fov,
                        ..sized()
                    };
                    fine(etd_scene_set_camera(scene, &raw const camera));
                }
                Call::Lens { projection, focus, blades, numbers, point } => {
                    let camera = etd_camera {
                        projection: u32::from(projection),
                        look_at: [0.0, 0.0, -1.0],
                        up: [0.0, 1.0, 0.0],
                        fov_deg: 70.0,
                        size: if projection == 2 { numbers[0] } else { 0.0 },
                        lens_radius: numbers[0],
                        focus: u32::from(focus),
                        blades: u32::from(blades),
                        focus_distance: numbers[1],
                        focus_at: point,
                        blade_rotation_deg: numbers[2],
                        squeeze: numbers[3],
                        ..sized()
                    };
                    fine(etd_scene_set_camera(scene, &raw const camera));
                }
                Call::CameraFilm { projection, shift, aspect } => {
                    let camera = etd_camera {
                        projection: u32::from(projection),
                        look_at: [0.0, 0.0, -1.0],
                        up: [0.0, 1.0, 0.0],
                        fov_deg: 70.0,
                        size: if projection == 2 { 3.0 } else { 0.0 },
                        shift,
                        pixel_aspect: aspect,
                        ..sized()
                    };
                    fine(etd_scene_set_camera(scene, &raw const camera));
                }
                Call::SaneCamera { origin, lens: [radius, distance, blades, turn], shift, aspect, is_parallel } => {
                    let origin = origin.map(|n| f64::from(n) / 8.0 + 0.1);
                    let seen = etd_camera {
                        origin,
                        up: [0.0, 1.0, 0.3],
                        fov_deg: 70.0,
                        shift: shift.map(|n| f64::from(n) / 64.0),
                        pixel_aspect: (f64::from(aspect) / 64.0).max(0.1),
                        ..sized()
                    };
                    let camera = if is_parallel {
                        etd_camera { projection: 2, size: f64::from(radius) + 0.5, ..seen }
                    } else {
                        etd_camera {
                            lens_radius: f64::from(radius) / 64.0,
                            focus: 1,
                            focus_distance: f64::from(distance) / 16.0 + 0.1,
                            blades: if blades < 3 { 0 } else { u32::from(blades).min(32) },
                            blade_rotation_deg: f64::from(turn),
                            ..seen
                        }
                    };
                    fine(etd_scene_set_camera(scene, &raw const camera));
                }
                Call::AddMaterial { bsdf, color, numbers, name } => {
                    let name = name.and_then(|name| CString::new(vec![name]).ok());
                    let name = name.as_ref().map_or(null(), |name| name.as_ptr());
                    let value = material(bsdf, color, numbers);
                    fine(etd_scene_add_material(scene, name, &raw const value, &raw mut number));
                }
                Call::SaneMaterial { bsdf, color } => {
                    let color = color.map(|n| f32::from(n) / 255.0);
                    let value = material(bsdf % 6, color, [0.3, 20.0, 1.5, 1.0, 0.0]);
                    fine(etd_scene_add_material(scene, null(), &raw const value, &raw mut number));
                }
                Call::SetMaterial { material: which, bsdf, color, numbers } => {
                    let value = material(bsdf, color, numbers);
                    fine(etd_scene_set_material(scene, u32::from(which), &raw const value));
                }
                Call::AddLight { position, intensity } => {
                    fine(etd_scene_add_point_light(scene, position.as_ptr(), intensity.as_ptr(), &raw mut number));
                }
                Call::SetLight { light, position, intensity } => {
                    fine(etd_scene_set_point_light(scene, u32::from(light), position.as_ptr(), intensity.as_ptr()));
                }
                Call::SpotLight { light, position, direction, intensity, angles: [outer_cone_deg, inner_cone_deg] } => {
                    let it =
                        etd_spot_light { position, direction, intensity, outer_cone_deg, inner_cone_deg, ..sized() };
                    match light {
                        None => {
                            fine(etd_scene_add_spot_light(scene, &raw const it, &raw mut number));
                        }
                        Some(light) => {
                            fine(etd_scene_set_spot_light(scene, u32::from(light), &raw const it));
                            let mut out: etd_spot_light = sized();
                            fine(etd_scene_get_spot_light(scene, u32::from(light), &raw mut out));
                        }
                    }
                }
                Call::SaneSpotLight { position, direction, angles } => {
                    let it = etd_spot_light {
                        position: position.map(|x| f64::from(x) / 16.0),
                        direction: direction.map(f64::from),
                        intensity: [1.0; 3],
                        outer_cone_deg: f64::from(angles[0].max(angles[1])) / 256.0 * 180.0,
                        inner_cone_deg: f64::from(angles[0].min(angles[1])) / 256.0 * 180.0,
                        ..sized()
                    };
                    fine(etd_scene_add_spot_light(scene, &raw const it, &raw mut number));
                }
                Call::WebLight { light, text, position, direction, c0, factor, tilt } => {
                    let it = etd_web_light {
                        text: if text.is_empty() { null() } else { text.as_ptr().cast() },
                        text_bytes: text.len(),
                        position,
                        direction,
                        c0,
                        factor,
                        tilt_deg: tilt,
                        ..sized()
                    };
                    match light {
                        None => {
                            fine(etd_scene_add_web_light(scene, &raw const it, &raw mut number));
                        }
                        Some(light) => {
                            fine(etd_scene_set_web_light(scene, u32::from(light), &raw const it));
                            let mut out: etd_web_light = sized();
                            fine(etd_scene_get_web_light(scene, u32::from(light), &raw mut out));
                        }
                    }
                }
                Call::Environment { radiance } => {
                    let radiance = radiance.as_ref().map_or(null(), |radiance| radiance.as_ptr());
                    fine(etd_scene_set_environment(scene, radiance));
                }
                Call::Portals { corners, count } => {
                    let given = if usize::from(count) > corners.len() && count <= 256 { corners.len() } else { count.into() };
                    let given = if given <= 256 { given.min(corners.len()) } else { given };
                    let first = if corners.is_empty() { null() } else { corners.as_ptr().cast() };
                    fine(etd_scene_set_portals(scene, first, given));
                    let (mut out, mut number) = ([[[0.0_f64; 3]; 4]; 8], 0);
                    fine(etd_scene_get_portals(scene, out.as_mut_ptr().cast(), 8, &raw mut number));
                }
                Call::EnvironmentMap { texture, projection, hidden, radiance, up, rotation } => {
                    let it = etd_environment_map {
                        texture: if texture == 255 { ETD_NONE } else { u32::from(texture % 4) },
                        projection: u32::from(projection % 4),
                        radiance,
                        hidden: u32::from(hidden),
                        up,
                        rotation_deg: rotation,
                        ..sized()
                    };
                    fine(etd_scene_set_environment_map(scene, &raw const it));
                    let mut out: etd_environment_map = sized();
                    fine(etd_scene_get_environment_map(scene, &raw mut out));
                }
                Call::Backplate { texture, radiance, none } => {
                    let texture = if texture == 255 { ETD_NONE } else { u32::from(texture % 4) };
                    let it = etd_backplate { texture, radiance, ..sized() };
                    fine(etd_scene_set_backplate(scene, if none { null() } else { &raw const it }));
                    let mut out: etd_backplate = sized();
                    fine(etd_scene_get_backplate(scene, &raw mut out));
                }
                Call::SaneEnvironmentMap { texture, rotation } => {
                    let it = etd_environment_map {
                        texture: u32::from(texture % 4),
                        radiance: [1.0; 3],
                        up: [0.0, 1.0, 0.0],
                        rotation_deg: f64::from(rotation),
                        ..sized()
                    };
                    fine(etd_scene_set_environment_map(scene, &raw const it));
                }
                Call::DistantLight { light, towards, irradiance, angle, hidden } => {
                    let it = etd_distant_light {
                        towards,
                        irradiance,
                        hidden: u32::from(hidden),
                        angle_deg: angle,
                        ..sized()
                    };
                    fine(match light {
                        Some(light) => etd_scene_set_distant_light(scene, u32::from(light % 4), &raw const it),
                        None => etd_scene_add_distant_light(scene, &raw const it, &raw mut number),
                    });
                    let mut out: etd_distant_light = sized();
                    fine(etd_scene_get_distant_light(scene, u32::from(light.unwrap_or(0) % 4), &raw mut out));
                }
                Call::Sky { cie, flags, radiance, ground, perez, turbidity, sun, up } => {
                    let [turbidity, angle_deg] = turbidity.unwrap_or_default();
                    let it = etd_sky {
                        cie: u32::from(cie % 17),
                        turbidity,
                        angle_deg,
                        no_disk: u32::from(flags[2]),
                        horizontal: u32::from(flags[0]),
                        radiance,
                        ground,
                        hidden: u32::from(flags[1]),
                        perez,
                        sun,
                        up,
                        ..sized()
                    };
                    fine(etd_scene_set_sky(scene, &raw const it));
                    let mut out: etd_sky = sized();
                    fine(etd_scene_get_sky(scene, &raw mut out));
                }
                Call::SaneSky { cie, sun, angle, turbidity } => {
                    let sun = [f64::from(sun[0]), 40.0, f64::from(sun[1])];
                    let it = etd_sky {
                        cie: if turbidity < 10 { u32::from(cie % 15 + 1) } else { 0 },
                        turbidity: if turbidity < 10 { 0.0 } else { f64::from(turbidity % 91 + 10) * 0.1 },
                        angle_deg: f64::from(angle) * 0.5,
                        radiance: [1.0; 3],
                        sun,
                        up: [0.0, 1.0, 0.0],
                        ..sized()
                    };
                    fine(etd_scene_set_sky(scene, &raw const it));
                    let it = etd_distant_light {
                        towards: sun,
                        irradiance: [1.0; 3],
                        angle_deg: f64::from(angle) * 0.5,
                        ..sized()
                    };
                    fine(etd_scene_add_distant_light(scene, &raw const it, &raw mut number));
                }
                Call::Sun { place } => {
                    let mut out = [0.0; 3];
                    fine(etd_sun_direction(place[0], place[1], place[2], out.as_mut_ptr()));
                }
                Call::AddShape { kind, numbers, material, emission, transform } => {
                    fine(self.shape(kind, &numbers, &look(material, emission, transform.unwrap_or_default())));
                }
                Call::SaneShape { kind, numbers, material, glow, shift } => {
                    let numbers = numbers.map(|n| f64::from(n) / 32.0);
                    let emission = [f32::from(glow / 64); 3];
                    fine(self.shape(kind, &numbers, &look(material, emission, shifted(shift, 1.0))));
                }
                Call::AddMesh { vertices, triangles, flags, stride } => {
                    self.mesh(None, vertices, &triangles, flags, stride);
                }
                Call::SetMesh { mesh, vertices, triangles, flags } => {
                    let vertices = vertices.into_iter().map(|v| v.map(|n| f32::from(n) / 16.0)).collect();
                    self.mesh(Some(mesh), vertices, &triangles, flags, 16);
                }
                Call::AddTexture { kind, size, format, numbers, mut texels, name } => {
                    let it = texture(kind, size, format, numbers, &mut texels);
                    let name = name.map(|name| CString::new(vec![name.max(1)]).expect("no zero byte"));
                    let name = name.as_ref().map_or(null(), |name| name.as_ptr());
                    fine(etd_scene_add_texture(scene, name, &raw const it, &raw mut number));
                }
                Call::SetTexture { texture: at, kind, size, format, numbers, mut texels } => {
                    let it = texture(kind, size, format, numbers, &mut texels);
                    fine(etd_scene_set_texture(scene, u32::from(at % 4), &raw const it));
                }
                Call::UpdateTexture { texture } => {
                    fine(etd_scene_update_texture(scene, u32::from(texture % 4)));
                }
                Call::BindTexture { material, parameter, texture, channel, strength } => {
                    let it = etd_texture_binding {
                        texture: if texture == 255 { ETD_NONE } else { u32::from(texture % 4) },
                        channel: u32::from(channel % 6),
                        strength,
                        ..sized()
                    };
                    let parameter = PARAMETERS[usize::from(parameter) % PARAMETERS.len()].as_ptr();
                    fine(etd_scene_set_material_texture(scene, u32::from(material % 4), parameter, &raw const it));
                    let mut out: etd_texture_binding = sized();
                    fine(etd_scene_get_material_texture(scene, u32::from(material % 4), parameter, &raw mut out));
                }
                Call::RemoveMesh { mesh } => {
                    fine(etd_scene_remove_mesh(scene, u32::from(mesh)));
                }
                // Between two scenes or within one, it is the same.
                Call::MeshFrom { mesh, name } => {
                    let name = name.map(|name| CString::new(vec![name.max(1)]).expect("no zero byte"));
                    let name = name.as_ref().map_or(null(), |name| name.as_ptr());
                    fine(etd_scene_add_mesh_from(scene, name, scene, u32::from(mesh), &raw mut number));
                }
                // Of few surfaces: groups of groups of groups grow fast.
                Call::AddGroup { surfaces, count, name } => {
                    let name = name.map(|name| CString::new(vec![name.max(1)]).expect("no zero byte"));
                    let name = name.as_ref().map_or(null(), |name| name.as_ptr());
                    let surfaces = surfaces.map(u32::from);
                    let count = usize::from(count) % (surfaces.len() + 1);
                    fine(etd_scene_add_group(scene, name, surfaces.as_ptr(), count, &raw mut number));
                    fine(etd_scene_find_group(scene, name, &raw mut number));
                }
                Call::PlaceGroup { group, transform } => {
                    let rows = transform.as_ref().map_or(null(), |rows| rows.as_ptr());
                    fine(etd_scene_place_group(scene, u32::from(group % 4), rows, &raw mut number, null_mut()));
                }
                Call::SanePlacement { group, shift, scale } => {
                    let rows = shifted(shift, f64::from(scale) / 16.0);
                    let mut first = 0;
                    fine(etd_scene_place_group(scene, u32::from(group % 4), rows.as_ptr(), &raw mut number, &raw mut first));
                }
                Call::MovePlacement { placement, shift, scale } => {
                    let (placement, rows) = (u32::from(placement % 8), shifted(shift, f64::from(scale) / 16.0));
                    fine(etd_scene_set_placement_transform(scene, placement, rows.as_ptr()));
                    let (mut first, mut count) = (0, 0);
                    let mut now = [0.0; 12];
                    let group = &raw mut number;
                    fine(etd_scene_get_placement(scene, placement, group, &raw mut first, &raw mut count, now.as_mut_ptr()));
                }
                Call::RemovePlacement { placement } => {
                    fine(etd_scene_remove_placement(scene, u32::from(placement % 8)));
                }
                Call::RemoveGroup { group } => {
                    fine(etd_scene_remove_group(scene, u32::from(group % 4)));
                }
                Call::AddMeshSurface { mesh, smooth, material, glow, shift } => {
                    let surface = look(material, [f32::from(glow / 64); 3], shifted(shift, 1.0));
                    let (mesh, smooth) = (u32::from(mesh), u32::from(smooth & 1));
                    fine(etd_scene_add_mesh_surface(scene, mesh, smooth, &raw const surface, &raw mut number));
                }
                Call::RemoveSurface { surface } => {
                    fine(etd_scene_remove_surface(scene, u32::from(surface)));
                }
                Call::SetTransform { surface, rows } => {
                    fine(etd_scene_set_transform(scene, u32::from(surface), rows.as_ptr()));
                }
                Call::SaneTransform { surface, shift, scale } => {
                    let rows = shifted(shift, f64::from(scale) / 16.0);
                    fine(etd_scene_set_transform(scene, u32::from(surface), rows.as_ptr()));
                }
                Call::SetSurfaceMaterial { surface, material } => {
                    let material = if material == 255 { ETD_NONE } else { u32::from(material) };
                    fine(etd_scene_set_surface_material(scene, u32::from(surface), material));
                }
                Call::SetEmission { surface, radiance } => {
                    let radiance = radiance.as_ref().map_or(null(), |radiance| radiance.as_ptr());
                    fine(etd_scene_set_emission(scene, u32::from(surface), radiance));
                }
                Call::SetEmitsBoth { surface, both } => {
                    fine(etd_scene_set_emits_both(scene, u32::from(surface), u32::from(both)));
                }
                Call::SurfaceWeb { surface, text, c0, tilt } => {
                    let it = etd_surface_web {
                        text: text.as_ref().filter(|text| !text.is_empty()).map_or(null(), |text| text.as_ptr().cast()),
                        text_bytes: text.as_ref().map_or(0, Vec::len),
                        c0,
                        tilt_deg: tilt,
                        ..sized()
                    };
                    let given = if text.is_some() { &raw const it } else { null() };
                    fine(etd_scene_set_surface_web(scene, u32::from(surface), given));
                    let mut out: etd_surface_web = sized();
                    fine(etd_scene_get_surface_web(scene, u32::from(surface), &raw mut out));
                }
                Call::SaneSurfaceWeb { surface, candela: [a, b, c], c0 } => {
                    let text = format!("TILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 1\n0 90 180\n0\n{a} {b} {c}\n");
                    let it = etd_surface_web {
                        text: text.as_ptr().cast(),
                        text_bytes: text.len(),
                        c0: c0.map(f64::from),
                        ..sized()
                    };
                    fine(etd_scene_set_emits_both(scene, u32::from(surface), u32::from(c > 0)));
                    fine(etd_scene_set_surface_web(scene, u32::from(surface), &raw const it));
                }
                Call::Spectrum { target, number, kind, illuminant, temperature, samples } => {
                    let (target, number) = (u32::from(target), u32::from(number));
                    let it = etd_spectrum {
                        kind: u32::from(kind),
                        illuminant: u32::from(illuminant),
                        temperature,
                        samples: samples.as_ref().map_or(null(), |samples| samples.as_ptr().cast()),
                        sample_count: samples.as_ref().map_or(0, Vec::len),
                        ..sized()
                    };
                    let given = if kind == 255 { null() } else { &raw const it };
                    fine(etd_scene_set_spectrum(scene, target, number, given));
                    let mut out: etd_spectrum = sized();
                    fine(etd_scene_get_spectrum(scene, target, number, &raw mut out));
                }
                Call::SaneSpectrum { target, number, first, values } => {
                    let samples: [[f64; 2]; 4] = std::array::from_fn(|i| {
                        [400.0 + f64::from(first) + 30.0 * i as f64, f64::from(values[i]) / 255.0]
                    });
                    let it = etd_spectrum { samples: samples.as_ptr().cast(), sample_count: 4, ..sized() };
                    fine(etd_scene_set_spectrum(scene, u32::from(target % 11), u32::from(number), &raw const it));
                }
                Call::GetSurface { surface } => {
                    let mut value: etd_surface = sized();
                    fine(etd_scene_get_surface(scene, u32::from(surface), &raw mut value));
                    let mut shape: etd_shape = sized();
                    fine(etd_scene_get_shape(scene, u32::from(surface), &raw mut shape));
                    let mut mesh: etd_mesh_info = sized();
                    if fine(etd_scene_get_mesh(scene, u32::from(surface), &raw mut mesh)) == ETD_OK {
                        let counts = (mesh.vertex_count, mesh.triangle_count);
                        let (mut positions, mut uvs) = (vec![[0.0_f64; 3]; counts.0], vec![[0.0_f32; 2]; counts.0]);
                        let mut indices = vec![[0_u32; 3]; counts.1];
                        let (positions, indices) = (positions.as_mut_ptr().cast(), indices.as_mut_ptr().cast());
                        let uvs = if mesh.has_uvs == 0 { null_mut() } else { uvs.as_mut_ptr().cast() };
                        let number = u32::from(surface);
                        fine(etd_scene_copy_mesh(
                            scene, number, counts.0, counts.1, positions, null_mut(), uvs, indices,
                        ));
                    }
                }
                Call::Commit { cancel } => {
                    fine(etd_scene_commit(scene, if cancel { Some(stop) } else { None }, null_mut()));
                }
                Call::Film { width, height, layers } => {
                    let options = etd_film_options {
                        width: u32::from(width % 40),
                        height: u32::from(height % 40),
                        layers: u32::from(layers),
                        ..sized()
                    };
                    let mut film = null_mut();
                    if fine(etd_film_new(self.device, &raw const options, &raw mut film)) == ETD_OK {
                        self.maps.clear();
                        etd_film_release(self.film);
                        self.film = film;
                    }
                }
                Call::Resize { width, height } => {
                    if !self.film.is_null() {
                        fine(etd_film_resize(self.film, u32::from(width % 40), u32::from(height % 40)));
                    }
                }
                Call::Render { integrator, sampler, filter, parameters, samples, depth, film } => {
                    let (is_part, goes_on) = (filter >= 192, (128..192).contains(&filter));
                    let options = etd_render_options {
                        integrator: u32::from(integrator) % (INTEGRATORS + 1),
                        sampler: u32::from(sampler % 6),
                        filter: u32::from(filter % 6),
                        filter_parameters: parameters,
                        samples: u32::from(samples % 4),
                        max_depth: u32::from(depth % 16) + 1,
                        spectral: u32::from(sampler >> 6),
                        reuse: u32::from(depth >> 4) % 4,
                        light_paths: u32::from(filter >> 4) % 4,
                        first_shadow_rays: u32::from(samples >> 6),
                        allow_bias: u32::from(depth >> 6),
                        sensor_bands: if depth >> 6 == 3 { parameters.map(f64::from) } else { [0.0; 2] },
                        share_number: if is_part { u32::from(samples >> 2) % 4 } else { 0 },
                        share_count: if is_part { u32::from(samples >> 4) % 4 } else { 0 },
                        resume: if goes_on { self.film } else { null() },
                        ..quick()
                    };
                    let film = if film { self.film } else { null_mut() };
                    if fine(etd_render(scene, film, &raw const options)) == ETD_OK && (is_part || goes_on) {
                        self.move_film();
                    }
                }
                Call::RenderPart { integrator, sampler, picture, crop: [crop_left, crop_top] } => {
                    let [picture_width, picture_height] = picture.map(u32::from);
                    let options = etd_render_options {
                        integrator: u32::from(integrator) % INTEGRATORS,
                        sampler: u32::from(sampler % 5),
                        samples: 1,
                        max_depth: 4,
                        picture_width,
                        picture_height,
                        crop_left,
                        crop_top,
                        ..quick()
                    };
                    fine(etd_render(scene, self.film, &raw const options));
                }
                Call::Start { integrator, samples, time, error } => {
                    let options = etd_render_options {
                        integrator: u32::from(integrator) % INTEGRATORS,
                        samples,
                        max_depth: 8,
                        time_limit: if time.is_finite() { time.clamp(-1.0, 0.01) } else { time },
                        target_error: error,
                        ..quick()
                    };
                    let mut task = null_mut();
                    if fine(etd_render_start(scene, self.film, &raw const options, &raw mut task)) == ETD_OK {
                        etd_task_release(self.task);
                        self.task = task;
                    }
                }
                Call::Poll => {
                    let mut progress: etd_progress = sized();
                    fine(etd_task_poll(self.task, &raw mut progress));
                    assert!(self.task.is_null() || (0.0..=1.0).contains(&progress.fraction));
                }
                Call::Wait { seconds } => {
                    fine(etd_task_wait(self.task, f64::from(seconds) * 1e-5));
                }
                Call::Cancel => {
                    fine(etd_task_cancel(self.task));
                }
                Call::Resume => {
                    fine(etd_task_resume(self.task));
                }
                Call::ReleaseTask => {
                    etd_task_release(self.task);
                    self.task = null_mut();
                }
                Call::Map { layer } => {
                    let mut map: etd_map = sized();
                    if fine(etd_film_map(self.film, u32::from(layer), &raw mut map)) == ETD_OK {
                        let count = map.width as usize * map.height as usize * map.channels as usize;
                        let data = std::slice::from_raw_parts(map.data, count);
                        std::hint::black_box(data.iter().sum::<f32>());
                        self.maps.push(map);
                    }
                }
                Call::Unmap { which } => {
                    if !self.maps.is_empty() {
                        let which = usize::from(which) % self.maps.len();
                        let mut map = self.maps.swap_remove(which);
                        fine(etd_film_unmap(self.film, &raw mut map));
                        assert_ne!(etd_film_unmap(self.film, &raw mut map), ETD_OK);
                    }
                }
                Call::Copy { layer, format, tone_map, exposure, stride, bottom_up } => {
                    let options = etd_image_options {
                        format: u32::from(format),
                        tone_map: u32::from(tone_map),
                        exposure,
                        bottom_up: u32::from(bottom_up),
                        ..sized()
                    };
                    let mut pixels = vec![0_u32; 20_000];
                    let (size, stride) = (pixels.len() * 4, usize::from(stride));
                    let pixels = pixels.as_mut_ptr().cast();
                    fine(etd_film_copy(self.film, u32::from(layer), &raw const options, pixels, size, stride));
                }
                Call::Intersect { rays } => {
                    let rays = as_rays(&rays);
                    let mut hits = vec![sized_hit(); rays.len()];
                    fine(etd_scene_intersect(scene, rays.as_ptr(), rays.len(), hits.as_mut_ptr()));
                }
                Call::Occluded { rays } => {
                    let rays = as_rays(&rays);
                    let mut occluded = vec![0; rays.len()];
                    fine(etd_scene_occluded(scene, rays.as_ptr(), rays.len(), occluded.as_mut_ptr()));
                }
                Call::Query { rays, threads, strides, wanted } => {
                    let rays = as_rays(&rays);
                    let Some(first) = rays.first() else { return };
                    // Room for the greatest stride that is not refused.
                    let mut floats = vec![0.0_f32; 64 * rays.len() + 64];
                    let mut doubles = vec![0.0_f64; 64 * rays.len() + 64];
                    let (t, positions) = (floats.as_mut_ptr(), doubles.as_mut_ptr());
                    let mut numbers = vec![0_u32; rays.len()];
                    let mut answers = vec![0_u8; rays.len()];
                    let (mut uvs, mut weights) = (vec![[0.0_f32; 2]; rays.len()], vec![[0.0_f32; 2]; rays.len()]);
                    let (mut normals, mut shading) = (vec![[0.0_f32; 3]; rays.len()], vec![[0.0_f32; 3]; rays.len()]);
                    let wants = |bit: u16| wanted & (1 << bit) != 0;
                    let query = etd_ray_query {
                        count: rays.len(),
                        threads: threads.into(),
                        origins: first.origin.as_ptr(),
                        origins_stride: size_of::<etd_ray>(),
                        directions: first.direction.as_ptr(),
                        directions_stride: size_of::<etd_ray>(),
                        tnear: if wants(0) { &raw const first.tnear } else { null() },
                        tnear_stride: size_of::<etd_ray>(),
                        times: if wants(1) { &raw const first.tfar } else { null() },
                        times_stride: size_of::<etd_ray>(),
                        t: if wants(2) { t } else { null_mut() },
                        t_stride: strides[0].into(),
                        positions: if wants(3) { positions } else { null_mut() },
                        positions_stride: strides[1].into(),
                        surfaces: if wants(4) { numbers.as_mut_ptr() } else { null_mut() },
                        occluded: if wants(5) { answers.as_mut_ptr() } else { null_mut() },
                        tfar: if wants(6) { &raw const first.tfar } else { null() },
                        tfar_stride: size_of::<etd_ray>(),
                        active: if wants(7) { rays.as_ptr().cast() } else { null() },
                        active_stride: size_of::<etd_ray>(),
                        uv: if wants(8) { uvs.as_mut_ptr().cast() } else { null_mut() },
                        ng: if wants(9) { normals.as_mut_ptr().cast() } else { null_mut() },
                        ns: if wants(9) { shading.as_mut_ptr().cast() } else { null_mut() },
                        barycentric: if wants(10) { weights.as_mut_ptr().cast() } else { null_mut() },
                        ..sized()
                    };
                    fine(etd_scene_query(scene, &raw const query));
                    let [width, height] = strides.map(|side| u32::from(side % 16));
                    let mut of_camera = as_rays(&vec![[0.0; 8]; (width * height) as usize]);
                    fine(etd_scene_camera_rays(scene, width, height, null(), of_camera.as_mut_ptr()));
                }
                Call::Text { which, capacity } => {
                    let mut buffer = vec![0; usize::from(capacity)];
                    let mut needed = 0;
                    let (buffer, capacity) = (buffer.as_mut_ptr(), usize::from(capacity));
                    fine(etd_scene_copy_text(scene, u32::from(which), buffer, capacity, &raw mut needed));
                }
                Call::NewScene { dynamic } => {
                    let options = etd_scene_options { usage: u32::from(dynamic % 3), ..sized() };
                    let mut scene = null_mut();
                    if fine(etd_scene_new(self.device, &raw const options, &raw mut scene)) == ETD_OK {
                        etd_scene_release(self.scene);
                        self.scene = scene;
                    }
                }
            }
        }
    }
}

fn as_rays(numbers: &[[f32; 8]]) -> Vec<etd_ray> {
    let ray =
        |n: &[f32; 8]| etd_ray { origin: [n[0], n[1], n[2]], tnear: n[3], direction: [n[4], n[5], n[6]], tfar: n[7] };
    numbers.iter().map(ray).collect()
}

fn sized_hit() -> etd_hit {
    // SAFETY: plain numbers.
    unsafe { std::mem::zeroed() }
}

impl Drop for World {
    fn drop(&mut self) {
        // SAFETY: each is given back once, and in an order that suits nobody.
        unsafe {
            etd_device_release(self.device);
            etd_scene_release(self.scene);
            etd_film_release(self.film);
            etd_task_release(self.task);
        }
    }
}

fuzz_target!(|calls: Vec<Call>| {
    let mut world = World::new();
    for call in calls.into_iter().take(64) {
        // SAFETY: the handles are alive or NULL.
        unsafe { world.call(call) }
    }
});
