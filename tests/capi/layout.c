/* The binary interface as the C compiler sees it: sizes, offsets, values. Compared with abi.txt by abi.sh, so that nobody
 * changes it without knowing. abi.sh also checks that nothing of the header is missing here. */
#include <stdio.h>

#include <etendue.h>

#define STRUCT(type) printf("struct %s %lu\n", #type, (unsigned long)sizeof(type))
#define FIELD(type, field)                                                          \
    printf("  %s %lu %lu\n", #field, (unsigned long)offsetof(type, field),          \
           (unsigned long)sizeof(((type *)0)->field))
#define ENUM(type) printf("enum %s %lu\n", #type, (unsigned long)sizeof(type))
#define VALUE(name) printf("  %s %lu\n", #name, (unsigned long)(name))
#define NUMBER(name) printf("macro %s %lu\n", #name, (unsigned long)(name))
#define TEXT(name) printf("macro %s \"%s\"\n", #name, name)

static void hexadecimal(const char *name, const void *bytes, size_t size) {
    size_t i;
    printf("macro %s", name);
    for (i = 0; i < size; ++i) {
        printf(i % 4 == 0 ? " %02x" : "%02x", ((const unsigned char *)bytes)[i]);
    }
    printf("\n");
}

/* An initialiser, byte by byte; the structures have no padding but what offsets and sizes show. */
#define INITIALISER(type, name)                     \
    do {                                            \
        static const type value = name;             \
        hexadecimal(#name, &value, sizeof value);   \
    } while (0)

static void enumerations(void) {
    ENUM(etd_status);
    VALUE(ETD_OK);
    VALUE(ETD_RUNNING);
    VALUE(ETD_INVALID_ARGUMENT);
    VALUE(ETD_INVALID_HANDLE);
    VALUE(ETD_INVALID_OPERATION);
    VALUE(ETD_INVALID_SCENE);
    VALUE(ETD_UNSUPPORTED);
    VALUE(ETD_IO);
    VALUE(ETD_DEVICE);
    VALUE(ETD_OUT_OF_MEMORY);
    VALUE(ETD_CANCELLED);
    VALUE(ETD_INTERNAL);
    VALUE(ETD_PANIC);
    ENUM(etd_log_level);
    VALUE(ETD_LOG_WARNING);
    VALUE(ETD_LOG_INFO);
    ENUM(etd_phase);
    VALUE(ETD_PHASE_BUILD);
    VALUE(ETD_PHASE_RENDER);
    VALUE(ETD_PHASE_END);
    ENUM(etd_ended);
    VALUE(ETD_ENDED_SAMPLES);
    VALUE(ETD_ENDED_TIME);
    VALUE(ETD_ENDED_ERROR);
    VALUE(ETD_ENDED_CANCELLED);
    ENUM(etd_usage);
    VALUE(ETD_USAGE_STATIC);
    VALUE(ETD_USAGE_DYNAMIC);
    ENUM(etd_camera_type);
    VALUE(ETD_CAMERA_PERSPECTIVE);
    VALUE(ETD_CAMERA_VIEW_PLANE);
    ENUM(etd_fov_axis);
    VALUE(ETD_FOV_HORIZONTAL);
    VALUE(ETD_FOV_VERTICAL);
    ENUM(etd_bsdf);
    VALUE(ETD_BSDF_BLACK);
    VALUE(ETD_BSDF_LAMBERT);
    VALUE(ETD_BSDF_OREN_NAYAR);
    VALUE(ETD_BSDF_OREN_NAYAR_QUALITATIVE);
    VALUE(ETD_BSDF_MIRROR);
    VALUE(ETD_BSDF_DIELECTRIC);
    ENUM(etd_position_format);
    VALUE(ETD_POSITION_FLOAT3);
    VALUE(ETD_POSITION_DOUBLE3);
    ENUM(etd_sharing);
    VALUE(ETD_COPY);
    VALUE(ETD_SHARE);
    ENUM(etd_sampler);
    VALUE(ETD_SAMPLER_SOBOL);
    VALUE(ETD_SAMPLER_RANDOM);
    VALUE(ETD_SAMPLER_JITTERED);
    VALUE(ETD_SAMPLER_GRID);
    VALUE(ETD_SAMPLER_GAUSSIAN);
    ENUM(etd_filter);
    VALUE(ETD_FILTER_BOX);
    VALUE(ETD_FILTER_TENT);
    VALUE(ETD_FILTER_GAUSSIAN);
    VALUE(ETD_FILTER_BLACKMAN_HARRIS);
    VALUE(ETD_FILTER_MITCHELL);
    ENUM(etd_integrator);
    VALUE(ETD_INTEGRATOR_PATH);
    VALUE(ETD_INTEGRATOR_WHITTED);
    VALUE(ETD_INTEGRATOR_DIRECT);
    VALUE(ETD_INTEGRATOR_PHOTON_DIRECT);
    VALUE(ETD_INTEGRATOR_CAUSTIC);
    VALUE(ETD_INTEGRATOR_PHOTON);
    VALUE(ETD_INTEGRATOR_IRRADIANCE_CACHE);
    VALUE(ETD_INTEGRATOR_PPM);
    VALUE(ETD_INTEGRATOR_SPPM);
    VALUE(ETD_INTEGRATOR_AUTO);
    VALUE(ETD_INTEGRATOR_RADIOSITY);
    ENUM(etd_photon_kernel);
    VALUE(ETD_PHOTON_KERNEL_DEFAULT);
    VALUE(ETD_PHOTON_KERNEL_FLAT);
    VALUE(ETD_PHOTON_KERNEL_CONE);
    VALUE(ETD_PHOTON_KERNEL_EPANECHNIKOV);
    ENUM(etd_photon_sharing);
    VALUE(ETD_PHOTON_SHARING_POWER);
    VALUE(ETD_PHOTON_SHARING_AREA);
    ENUM(etd_cache_source);
    VALUE(ETD_CACHE_SOURCE_PATHS);
    VALUE(ETD_CACHE_SOURCE_PHOTONS);
    ENUM(etd_radiosity_solver);
    VALUE(ETD_RADIOSITY_SOLVER_GATHER);
    VALUE(ETD_RADIOSITY_SOLVER_SHOOT);
    ENUM(etd_switch);
    VALUE(ETD_SWITCH_DEFAULT);
    VALUE(ETD_SWITCH_ON);
    VALUE(ETD_SWITCH_OFF);
    ENUM(etd_error_measure);
    VALUE(ETD_ERROR_RELMSE);
    VALUE(ETD_ERROR_DISPLAY);
    ENUM(etd_layer);
    VALUE(ETD_LAYER_COLOR);
    VALUE(ETD_LAYER_ALBEDO);
    VALUE(ETD_LAYER_NORMAL);
    VALUE(ETD_LAYER_DEPTH);
    VALUE(ETD_LAYER_SAMPLES);
    VALUE(ETD_LAYER_VARIANCE);
    VALUE(ETD_LAYER_STANDARD_ERROR);
    VALUE(ETD_LAYER_ALPHA);
    VALUE(ETD_LAYER_BIAS);
    ENUM(etd_format);
    VALUE(ETD_FORMAT_FLOAT);
    VALUE(ETD_FORMAT_RGB_FLOAT);
    VALUE(ETD_FORMAT_RGB8);
    VALUE(ETD_FORMAT_RGBA8);
    ENUM(etd_tone_map);
    VALUE(ETD_TONE_MAP_CLAMP);
    VALUE(ETD_TONE_MAP_MAXIMUM);
    VALUE(ETD_TONE_MAP_REINHARD);
    VALUE(ETD_TONE_MAP_ACES);
    ENUM(etd_text);
    VALUE(ETD_TEXT_INFO);
    VALUE(ETD_TEXT_WARNINGS);
}

static void structures(void) {
    STRUCT(etd_error);
    FIELD(etd_error, struct_size);
    FIELD(etd_error, status);
    FIELD(etd_error, line);
    FIELD(etd_error, message);
    FIELD(etd_error, file);
    FIELD(etd_error, json_path);
    STRUCT(etd_device_options);
    FIELD(etd_device_options, struct_size);
    FIELD(etd_device_options, threads);
    FIELD(etd_device_options, reserved);
    FIELD(etd_device_options, memory_limit);
    FIELD(etd_device_options, log);
    FIELD(etd_device_options, error);
    FIELD(etd_device_options, submit);
    FIELD(etd_device_options, user_data);
    STRUCT(etd_scene_options);
    FIELD(etd_scene_options, struct_size);
    FIELD(etd_scene_options, usage);
    FIELD(etd_scene_options, reserved);
    FIELD(etd_scene_options, base_dir);
    FIELD(etd_scene_options, params_file);
    STRUCT(etd_progress);
    FIELD(etd_progress, struct_size);
    FIELD(etd_progress, fraction);
    FIELD(etd_progress, elapsed);
    FIELD(etd_progress, rays);
    FIELD(etd_progress, samples_done);
    FIELD(etd_progress, samples_total);
    FIELD(etd_progress, phase);
    FIELD(etd_progress, images);
    STRUCT(etd_scene_info);
    FIELD(etd_scene_info, struct_size);
    FIELD(etd_scene_info, surfaces);
    FIELD(etd_scene_info, materials);
    FIELD(etd_scene_info, meshes);
    FIELD(etd_scene_info, point_lights);
    FIELD(etd_scene_info, triangles);
    FIELD(etd_scene_info, instances);
    FIELD(etd_scene_info, shared_triangles);
    FIELD(etd_scene_info, analytic_shapes);
    FIELD(etd_scene_info, emitters);
    FIELD(etd_scene_info, geometry_bytes);
    FIELD(etd_scene_info, hierarchy_bytes);
    FIELD(etd_scene_info, bounds_min);
    FIELD(etd_scene_info, bounds_max);
    FIELD(etd_scene_info, build_time);
    STRUCT(etd_render_options);
    FIELD(etd_render_options, struct_size);
    FIELD(etd_render_options, integrator);
    FIELD(etd_render_options, sampler);
    FIELD(etd_render_options, filter);
    FIELD(etd_render_options, filter_parameters);
    FIELD(etd_render_options, samples);
    FIELD(etd_render_options, max_depth);
    FIELD(etd_render_options, shadow_rays);
    FIELD(etd_render_options, seed);
    FIELD(etd_render_options, time_limit);
    FIELD(etd_render_options, target_error);
    FIELD(etd_render_options, progress);
    FIELD(etd_render_options, finished);
    FIELD(etd_render_options, user_data);
    FIELD(etd_render_options, photon_radius);
    FIELD(etd_render_options, caustic_radius);
    FIELD(etd_render_options, photon_alpha);
    FIELD(etd_render_options, cache_error);
    FIELD(etd_render_options, cache_min_spacing);
    FIELD(etd_render_options, cache_max_spacing);
    FIELD(etd_render_options, photon_count);
    FIELD(etd_render_options, caustic_count);
    FIELD(etd_render_options, min_photons);
    FIELD(etd_render_options, photon_neighbours);
    FIELD(etd_render_options, photon_kernel);
    FIELD(etd_render_options, photon_kernel_k);
    FIELD(etd_render_options, photon_sharing);
    FIELD(etd_render_options, photons_guided);
    FIELD(etd_render_options, photons_progressive);
    FIELD(etd_render_options, gather_rays);
    FIELD(etd_render_options, photon_memory);
    FIELD(etd_render_options, cache_rays);
    FIELD(etd_render_options, cache_source);
    FIELD(etd_render_options, reserved);
    FIELD(etd_render_options, error_measure);
    FIELD(etd_render_options, adaptive);
    FIELD(etd_render_options, radiosity_element_size);
    FIELD(etd_render_options, radiosity_error);
    FIELD(etd_render_options, radiosity_tolerance);
    FIELD(etd_render_options, radiosity_iterations);
    FIELD(etd_render_options, radiosity_solver);
    FIELD(etd_render_options, radiosity_ambient);
    FIELD(etd_render_options, radiosity_final_gather);
    FIELD(etd_render_options, radiosity_memory);
    FIELD(etd_render_options, reserved_2);
    STRUCT(etd_camera);
    FIELD(etd_camera, struct_size);
    FIELD(etd_camera, projection);
    FIELD(etd_camera, fov_axis);
    FIELD(etd_camera, origin);
    FIELD(etd_camera, look_at);
    FIELD(etd_camera, up);
    FIELD(etd_camera, fov_deg);
    STRUCT(etd_material);
    FIELD(etd_material, struct_size);
    FIELD(etd_material, bsdf);
    FIELD(etd_material, color);
    FIELD(etd_material, roughness);
    FIELD(etd_material, sigma_deg);
    FIELD(etd_material, ior);
    FIELD(etd_material, exterior_ior);
    FIELD(etd_material, survival);
    FIELD(etd_material, reserved);
    STRUCT(etd_surface);
    FIELD(etd_surface, struct_size);
    FIELD(etd_surface, material);
    FIELD(etd_surface, emission);
    FIELD(etd_surface, transform);
    STRUCT(etd_mesh);
    FIELD(etd_mesh, struct_size);
    FIELD(etd_mesh, positions);
    FIELD(etd_mesh, position_stride);
    FIELD(etd_mesh, position_bytes);
    FIELD(etd_mesh, vertex_count);
    FIELD(etd_mesh, indices);
    FIELD(etd_mesh, index_stride);
    FIELD(etd_mesh, triangle_count);
    FIELD(etd_mesh, normals);
    FIELD(etd_mesh, normal_stride);
    FIELD(etd_mesh, uvs);
    FIELD(etd_mesh, uv_stride);
    FIELD(etd_mesh, position_format);
    FIELD(etd_mesh, sharing);
    FIELD(etd_mesh, release);
    FIELD(etd_mesh, user_data);
    FIELD(etd_mesh, name);
    STRUCT(etd_film_options);
    FIELD(etd_film_options, struct_size);
    FIELD(etd_film_options, width);
    FIELD(etd_film_options, height);
    FIELD(etd_film_options, layers);
    FIELD(etd_film_options, reserved);
    STRUCT(etd_map);
    FIELD(etd_map, struct_size);
    FIELD(etd_map, data);
    FIELD(etd_map, width);
    FIELD(etd_map, height);
    FIELD(etd_map, channels);
    FIELD(etd_map, samples);
    FIELD(etd_map, id);
    STRUCT(etd_image_options);
    FIELD(etd_image_options, struct_size);
    FIELD(etd_image_options, format);
    FIELD(etd_image_options, tone_map);
    FIELD(etd_image_options, exposure);
    FIELD(etd_image_options, bottom_up);
    FIELD(etd_image_options, comments);
    STRUCT(etd_summary);
    FIELD(etd_summary, struct_size);
    FIELD(etd_summary, elapsed);
    FIELD(etd_summary, build_time);
    FIELD(etd_summary, rays);
    FIELD(etd_summary, non_finite);
    FIELD(etd_summary, relative_error);
    FIELD(etd_summary, samples);
    FIELD(etd_summary, cancelled);
    FIELD(etd_summary, rel_mse);
    FIELD(etd_summary, rel_mse_standard_error);
    FIELD(etd_summary, display_error);
    FIELD(etd_summary, samples_min);
    FIELD(etd_summary, samples_max);
    FIELD(etd_summary, ended);
    FIELD(etd_summary, reserved);
    STRUCT(etd_ray);
    FIELD(etd_ray, origin);
    FIELD(etd_ray, tnear);
    FIELD(etd_ray, direction);
    FIELD(etd_ray, tfar);
    STRUCT(etd_hit);
    FIELD(etd_hit, t);
    FIELD(etd_hit, barycentric);
    FIELD(etd_hit, uv);
    FIELD(etd_hit, ng);
    FIELD(etd_hit, ns);
    FIELD(etd_hit, surface);
    FIELD(etd_hit, material);
    FIELD(etd_hit, primitive);
}

static void macros(void) {
    NUMBER(ETD_VERSION_MAJOR);
    NUMBER(ETD_VERSION_MINOR);
    NUMBER(ETD_VERSION_PATCH);
    NUMBER(ETD_VERSION);
    TEXT(ETD_VERSION_STRING);
    NUMBER(ETD_NONE);
    INITIALISER(etd_error, ETD_ERROR_INIT);
    INITIALISER(etd_device_options, ETD_DEVICE_OPTIONS_INIT);
    INITIALISER(etd_scene_options, ETD_SCENE_OPTIONS_INIT);
    INITIALISER(etd_camera, ETD_CAMERA_INIT);
    INITIALISER(etd_material, ETD_MATERIAL_INIT);
    INITIALISER(etd_mesh, ETD_MESH_INIT);
    INITIALISER(etd_surface, ETD_SURFACE_INIT);
    INITIALISER(etd_render_options, ETD_RENDER_OPTIONS_INIT);
    INITIALISER(etd_progress, ETD_PROGRESS_INIT);
    INITIALISER(etd_summary, ETD_SUMMARY_INIT);
    INITIALISER(etd_film_options, ETD_FILM_OPTIONS_INIT);
    INITIALISER(etd_map, ETD_MAP_INIT);
    INITIALISER(etd_image_options, ETD_IMAGE_OPTIONS_INIT);
    INITIALISER(etd_scene_info, ETD_SCENE_INFO_INIT);
}

int main(void) {
    enumerations();
    structures();
    macros();
    return 0;
}
