//! The C header is what the sources say. `ETENDUE_WRITE=1 cargo test --test header` writes it anew.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// The files of the C interface, in the order in which the header presents them.
const SOURCES: [&str; 41] = [
    "status.rs",
    "last_error.rs",
    "types/mod.rs",
    "types/device.rs",
    "types/material.rs",
    "types/texture.rs",
    "types/scene.rs",
    "types/shape.rs",
    "types/sky.rs",
    "types/spectrum.rs",
    "types/light.rs",
    "types/motion.rs",
    "types/render.rs",
    "types/film.rs",
    "types/query.rs",
    "types/bake.rs",
    "types/lighting.rs",
    "types/mattes.rs",
    "device.rs",
    "scene.rs",
    "describe.rs",
    "light.rs",
    "environment.rs",
    "sky.rs",
    "spectrum.rs",
    "material.rs",
    "surface.rs",
    "mesh.rs",
    "shape.rs",
    "group.rs",
    "motion.rs",
    "texture.rs",
    "film.rs",
    "film_output.rs",
    "film_size.rs",
    "checkpoint.rs",
    "task.rs",
    "query.rs",
    "bake.rs",
    "lighting.rs",
    "mattes.rs",
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).into()
}

/// The macros that are not in the sources: the version, from Cargo.toml, and initialisers with the defaults.
fn macros() -> String {
    let part = |text: &str| text.parse::<u32>().expect("a number in the version");
    let [major, minor, patch] =
        [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")].map(part);
    format!(
        "/** Version of this header. Libraries of the same major version (of the same minor version before 1.0) work with\n \
         * programs that were built with it; `etd_version` tells the library's. */\n\
         #define ETD_VERSION_MAJOR {major}\n#define ETD_VERSION_MINOR {minor}\n#define ETD_VERSION_PATCH {patch}\n\
         #define ETD_VERSION {}\n#define ETD_VERSION_STRING \"{}\"\n\n{}",
        10_000 * major + 100 * minor + patch,
        env!("CARGO_PKG_VERSION"),
        INITIALISERS
    )
}

const INITIALISERS: &str = r"/** Stands for no material, no surface. */
#define ETD_NONE UINT32_MAX

/** Defaults of the structures, to be changed field by field. */
#define ETD_ERROR_INIT {sizeof(etd_error), ETD_OK, 0, NULL, NULL, NULL}
#define ETD_DEVICE_OPTIONS_INIT {sizeof(etd_device_options), 0, ETD_LOG_ALL, 0, NULL, NULL, NULL, NULL}
#define ETD_SCENE_OPTIONS_INIT {sizeof(etd_scene_options), ETD_USAGE_STATIC, 0, NULL, NULL, NULL, NULL}
#define ETD_CAMERA_INIT \
    {sizeof(etd_camera), ETD_CAMERA_PERSPECTIVE, ETD_FOV_HORIZONTAL, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90, 0, 0, \
     ETD_FOCUS_LOOK_AT, 0, 0, {0, 0, 0}, 0, 0, {0, 0}, 0}
#define ETD_MATERIAL_INIT \
    {sizeof(etd_material), ETD_BSDF_LAMBERT, {0.5f, 0.5f, 0.5f}, 0, 0, 1.5f, 1, 0, 0, {0, 0, 0}, 0, 0, 0, \
     ETD_DISTRIBUTION_GGX, ETD_MASKING_SMITH, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}, 0, 0, 0.5f, NULL, 1, \
     {0, 0, 0}, 0, {0, 0, 0, 0}, {0, 0, 0, 0}, 0, 0, 0}
#define ETD_PRINCIPLED_INIT \
    {sizeof(etd_principled), 1, {0.8f, 0.8f, 0.8f}, 0, 0, 1, {1, 1, 1}, 0.3f, 0, 0, 1.5f, 0, {1, 1, 1}, 0, {1, 1, 1}, 0, 0, \
     1.6f, 1, 0, {1, 1, 1}, 0.5f, 0, 0, 0}
#define ETD_MESH_INIT \
    {sizeof(etd_mesh), NULL, 0, 0, 0, NULL, 0, 0, NULL, 0, NULL, 0, ETD_POSITION_FLOAT3, ETD_COPY, NULL, NULL, NULL, \
     NULL, 0, NULL, 0, 0, NULL, 0}
#define ETD_SHAPE_INIT \
    {sizeof(etd_shape), ETD_SHAPE_NONE, ETD_NONE, 0, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, \
     {0, 0, 0}, {0, 0, 0}, 0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}}
#define ETD_MESH_INFO_INIT {sizeof(etd_mesh_info), 0, 0, 0, 0}
#define ETD_TEXTURE_INIT \
    {sizeof(etd_texture), ETD_TEXTURE_IMAGE, ETD_COLOR_SPACE_BY_USE, NULL, NULL, 0, 0, 0, 0, ETD_TEXEL_UINT8, ETD_COPY, \
     ETD_TEXTURE_FILTER_BILINEAR, NULL, NULL, ETD_WRAP_REPEAT, ETD_WRAP_REPEAT, {{0, 0, 0}, {1, 1, 1}}, 0.1f, 1, 4, \
     ETD_COORDINATES_UV, {1, 1, 1}, 0, {0, 0, 0}, 0, 0}
#define ETD_TEXTURE_BINDING_INIT {sizeof(etd_texture_binding), ETD_NONE, ETD_CHANNEL_DEFAULT, 1, 0}
#define ETD_ENVIRONMENT_MAP_INIT {sizeof(etd_environment_map), ETD_NONE, ETD_SKY_LATLONG, {1, 1, 1}, 0, {0, 1, 0}, 0}
#define ETD_BACKPLATE_INIT {sizeof(etd_backplate), ETD_NONE, {1, 1, 1}}
#define ETD_DISTANT_LIGHT_INIT {sizeof(etd_distant_light), {0, 1, 0}, {1, 1, 1}, 0, 0}
#define ETD_SKY_INIT {sizeof(etd_sky), 12, 0, {1, 1, 1}, {0, 0, 0}, 0, 0, {0, 1, 0}, {0, 1, 0}, {0, 0, 0, 0, 0}, 0, 0.533, 0, 0}
#define ETD_SPOT_LIGHT_INIT {sizeof(etd_spot_light), {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 45, 0}
#define ETD_WEB_LIGHT_INIT \
    {sizeof(etd_web_light), NULL, NULL, 0, {0, 0, 0}, {0, -1, 0}, {1, 0, 0}, {1, 1, 1}, 0}
#define ETD_SURFACE_WEB_INIT {sizeof(etd_surface_web), NULL, NULL, 0, {1, 0, 0}, 0}
#define ETD_SPECTRUM_INIT {sizeof(etd_spectrum), ETD_SPECTRUM_SAMPLES, ETD_ILLUMINANT_A, 0, NULL, 0}
#define ETD_SHUTTER_INIT {sizeof(etd_shutter), 0, 0, NULL, 0}
#define ETD_MOTION_KEY_INIT \
    {0, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}, 0, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}
#define ETD_SURFACE_INIT {sizeof(etd_surface), ETD_NONE, {0, 0, 0}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 0}
#define ETD_RENDER_OPTIONS_INIT \
    {sizeof(etd_render_options), ETD_INTEGRATOR_PATH, ETD_SAMPLER_SOBOL, ETD_FILTER_BOX, {0, 0}, 64, 0, 1, 0, 0, 0, \
     NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_PHOTON_KERNEL_DEFAULT, 0, ETD_PHOTON_SHARING_POWER, \
     ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, 0, 0, ETD_CACHE_SOURCE_PATHS, ETD_SWITCH_DEFAULT, ETD_ERROR_RELMSE, ETD_SWITCH_DEFAULT, \
     0, 0, 0, 0, ETD_RADIOSITY_SOLVER_GATHER, ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, \
     ETD_ROULETTE_OWN, 0, 0, 0, 0, {0, 0}, {0, 0}, ETD_SWITCH_DEFAULT, ETD_SWITCH_DEFAULT, 0, 0, NULL, 0, NULL, \
     0, ETD_SWITCH_DEFAULT}
#define ETD_PROGRESS_INIT {sizeof(etd_progress), 0, 0, 0, 0, 0, ETD_PHASE_BUILD, 0}
#define ETD_SUMMARY_INIT {sizeof(etd_summary), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, ETD_ENDED_SAMPLES, ETD_INTEGRATOR_PATH}
#define ETD_FILM_OPTIONS_INIT {sizeof(etd_film_options), 0, 0, 0, 0}
#define ETD_MAP_INIT {sizeof(etd_map), NULL, 0, 0, 0, 0, 0}
#define ETD_IMAGE_OPTIONS_INIT {sizeof(etd_image_options), ETD_FORMAT_FLOAT, ETD_TONE_MAP_CLAMP, 0, 0, NULL, ETD_PRIMARIES_REC709, 0}
#define ETD_ATLAS_OPTIONS_INIT {sizeof(etd_atlas_options), 0, 0, 0, 0, ETD_ATLAS_LAYOUT_AUTO, 0, 0, NULL, NULL}
#define ETD_ATLAS_INFO_INIT {sizeof(etd_atlas_info), 0, 0, 0, 0, 0, 0, 0, 0}
#define ETD_BAKE_TARGET_INIT {sizeof(etd_bake_target), NULL, NULL, 0, 0, 0, ETD_SIDE_FRONT, 0}
#define ETD_RAY_QUERY_INIT \
    {sizeof(etd_ray_query), 0, 0, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, \
     NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0, NULL, 0}
#define ETD_DEVICE_INFO_INIT {sizeof(etd_device_info), 0, 0, 0, 0, NULL, 0}
#define ETD_SCENE_INFO_INIT {sizeof(etd_scene_info), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, 0, 0, 0}
";

fn generate() -> String {
    let mut config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).expect("cbindgen.toml");
    config.after_includes = Some(format!("\n{}", macros()));
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(folder().join("src/capi").join(source));
    }
    let bindings = builder.generate().expect("the sources of the C interface can be read");
    let mut header = Vec::new();
    bindings.write(&mut header);
    let header = String::from_utf8(header).expect("UTF-8");
    // Rust's own headings say nothing to a C programmer, and the contracts below them are those of any C function.
    let mut lines = Vec::new();
    let mut in_safety = false;
    for line in header.lines() {
        match line.trim() {
            "* # Safety" => {
                in_safety = true;
                while lines.last().is_some_and(|line: &&str| line.trim() == "*") {
                    lines.pop();
                }
            }
            "*/" => {
                in_safety = false;
                lines.push(line);
            }
            _ if in_safety => {}
            _ => lines.push(line),
        }
    }
    lines.join("\n") + "\n"
}

#[test]
fn the_header_is_what_the_sources_say() {
    let path = folder().join("include/etendue.h");
    let generated = generate();
    if env::var_os("ETENDUE_WRITE").is_some() {
        fs::create_dir_all(folder().join("include")).expect("a folder for the header");
        fs::write(&path, &generated).expect("the header can be written");
    }
    let committed = fs::read_to_string(&path).expect("include/etendue.h");
    for (number, (old, new)) in committed.lines().zip(generated.lines()).enumerate() {
        assert_eq!(old, new, "line {} of include/etendue.h; write it anew with ETENDUE_WRITE=1", number + 1);
    }
    assert_eq!(
        committed.len(),
        generated.len(),
        "include/etendue.h ends elsewhere; write it anew with ETENDUE_WRITE=1"
    );
}
