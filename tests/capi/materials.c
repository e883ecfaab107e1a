/* Every model of a material: set by calls, read back, and rendered to the picture that a file with the same material has. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include <math.h>

CHECK_MAIN;

#define SIDE 12

/* What a case changes in the material and in its principled parameters. */
typedef void set_fn(etd_material *material, etd_principled *principled);

static void set3(float *to, float r, float g, float b) {
    to[0] = r;
    to[1] = g;
    to[2] = b;
}

static void rough(etd_material *material) {
    material->roughness = 0.5f;
    material->anisotropy = 0.25f;
    material->rotation_deg = 30;
}

#define CASE(name) static void name(etd_material *m, etd_principled *p)
#define ONLY_MATERIAL (void)p

CASE(black) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_BLACK; }
CASE(lambert) { ONLY_MATERIAL; set3(m->color, 0.75f, 0.5f, 0.25f); }
CASE(oren_nayar) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_OREN_NAYAR; m->roughness = 0.5f; }
CASE(qualitative) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_OREN_NAYAR_QUALITATIVE; m->sigma_deg = 30; }
CASE(mirror) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_MIRROR; set3(m->color, 0.75f, 0.5f, 0.25f); }
CASE(dielectric) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_DIELECTRIC; m->ior = 1.5f; m->exterior_ior = 1.25f; }
CASE(abbe) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_DIELECTRIC; m->ior = 1.5f; m->abbe = 64.25f; }
CASE(soap) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_DIELECTRIC;
    m->ior = 1;
    m->film_thickness = 312.5f;
    m->film_ior = 1.25f;
}
CASE(oxide) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_CONDUCTOR;
    m->eta[0] = m->eta[1] = m->eta[2] = 0.5f;
    m->k[0] = m->k[1] = m->k[2] = 3.5f;
    m->roughness = 0.25f;
    m->film_thickness = 40;
    m->film_ior = 2.5f;
}
CASE(sellmeier) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_ROUGH_DIELECTRIC;
    m->sellmeier_strengths[0] = 0.5f;
    m->sellmeier_strengths[1] = 1.25f;
    m->sellmeier_resonances[0] = 0.03125f;
    m->sellmeier_resonances[1] = 0.0078125f;
    m->roughness = 0.5f;
}
CASE(eon) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_EON; set3(m->color, 0.75f, 0.5f, 0.25f); m->roughness = 0.5f; }
CASE(diffuse_transmission) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_DIFFUSE_TRANSMISSION;
    set3(m->color, 0.25f, 0.25f, 0.5f);
    set3(m->transmittance, 0.5f, 0.25f, 0);
}
CASE(sheen) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_SHEEN; set3(m->color, 0.75f, 0.5f, 0.25f); m->roughness = 0.25f; }
CASE(sheen_default) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_SHEEN; set3(m->color, 0.75f, 0.5f, 0.25f); }
CASE(gold) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_CONDUCTOR;
    CHECK_OK(etd_metal("Au", m->eta, m->k));
    rough(m);
}
CASE(metal_by_index) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_CONDUCTOR;
    set3(m->eta, 0.5f, 1, 1.5f);
    set3(m->k, 3, 2, 0);
    rough(m);
    m->distribution = ETD_DISTRIBUTION_BECKMANN;
    m->masking = ETD_MASKING_SMITH_SEPARABLE;
    m->single_scattering = 1;
}
CASE(metal_by_colour) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_CONDUCTOR; set3(m->color, 0.75f, 0.5f, 0.25f); }
CASE(metal_by_tint) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_CONDUCTOR;
    set3(m->color, 0.75f, 0.5f, 0.25f);
    set3(m->edge_tint, 0, 0, 0);
}
CASE(cook_torrance) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_CONDUCTOR;
    CHECK_OK(etd_metal("Cu", m->eta, m->k));
    m->roughness = 0.5f;
    m->distribution = ETD_DISTRIBUTION_BECKMANN;
    m->masking = ETD_MASKING_V_CAVITY; /* which leaves out light that is scattered more than once */
}
CASE(rough_dielectric) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_ROUGH_DIELECTRIC;
    m->ior = 1.5f;
    m->exterior_ior = 0; /* 1 */
    rough(m);
}
CASE(thin_clear) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_THIN_DIELECTRIC; m->ior = 1.5f; }
CASE(thin_tinted) { thin_clear(m, p); set3(m->transmittance, 0.5f, 0, 0.25f); m->exterior_ior = 1.25f; }
CASE(thin_frosted) { thin_tinted(m, p); m->roughness = 0.5f; m->anisotropy = 0.25f; m->single_scattering = 1; }
CASE(thin_black) { thin_clear(m, p); set3(m->transmittance, -1, -1, -1); }
CASE(coated_diffuse) {
    ONLY_MATERIAL;
    m->bsdf = ETD_BSDF_COATED_DIFFUSE;
    set3(m->color, 0.75f, 0.5f, 0.25f);
    m->ior = 1.75f;
    rough(m);
}
CASE(principled_default) { m->bsdf = ETD_BSDF_PRINCIPLED; m->principled = p; }
CASE(principled) {
    principled_default(m, p);
    p->base_weight = 0.75f;
    set3(p->base_color, 0.75f, 0.5f, 0.25f);
    p->base_diffuse_roughness = 0.5f;
    p->base_metalness = 0.25f;
    p->specular_weight = 0.5f;
    set3(p->specular_color, 0.25f, 0.5f, 0.75f);
    p->specular_roughness = 0.5f;
    p->specular_roughness_anisotropy = 0.25f;
    p->specular_rotation_deg = 30;
    p->specular_ior = 1.75f;
    p->transmission_weight = 0.25f;
    set3(p->transmission_color, 0.5f, 1, 0.5f);
    p->transmission_depth = 0.125f;
    p->coat_weight = 0.5f;
    set3(p->coat_color, 1, 0.75f, 0.5f);
    p->coat_roughness = 0.25f;
    p->coat_roughness_anisotropy = 0.5f;
    p->coat_ior = 1.5f;
    p->coat_darkening = 0.5f;
    p->fuzz_weight = 0.25f;
    set3(p->fuzz_color, 0.5f, 0.75f, 1);
    p->fuzz_roughness = 0.75f;
    p->thin_walled = 1;
    p->single_scattering = 1;
}
CASE(mix) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_MIX; m->first = 0; m->second = 1; m->weight = 0.25f; }
CASE(mix_default) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_MIX; m->first = 1; }
CASE(mix_of_first) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_MIX; m->second = 1; m->weight = 0; }
CASE(veil) { ONLY_MATERIAL; set3(m->color, 0.75f, 0.5f, 0.25f); m->opacity = 0.25f; }
CASE(invisible) { ONLY_MATERIAL; m->opacity = -1; }
CASE(opaque) { ONLY_MATERIAL; m->opacity = 0; }
CASE(two_sided) { ONLY_MATERIAL; m->bsdf = ETD_BSDF_TWO_SIDED; m->first = 1; }

static const struct {
    const char *name;
    set_fn *set;
    const char *json; /* all but the name */
} cases[] = {
    {"black", black, "\"type\": \"black\""},
    {"lambert", lambert, "\"type\": \"diffuse\", \"color\": [0.75, 0.5, 0.25]"},
    {"oren-nayar", oren_nayar,
     "\"type\": \"diffuse\", \"brdf\": \"oren-nayar\", \"color\": [0.5, 0.5, 0.5], \"roughness\": 0.5"},
    {"qualitative", qualitative,
     "\"type\": \"diffuse\", \"brdf\": \"oren-nayar-qualitative\", \"color\": [0.5, 0.5, 0.5], \"sigmaDeg\": 30"},
    {"mirror", mirror, "\"type\": \"reflective\", \"color\": [0.75, 0.5, 0.25]"},
    {"dielectric", dielectric, "\"type\": \"refractive\", \"refractionIndex\": 1.5, \"exteriorIndex\": 1.25"},
    {"abbe", abbe, "\"type\": \"refractive\", \"refractionIndex\": 1.5, \"dispersion\": 64.25"},
    {"soap", soap, "\"type\": \"refractive\", \"refractionIndex\": 1, \"film\": {\"thickness\": 312.5, \"refractionIndex\": 1.25}"},
    {"oxide", oxide,
     "\"type\": \"conductor\", \"eta\": [0.5, 0.5, 0.5], \"k\": [3.5, 3.5, 3.5], \"roughness\": 0.25, "
     "\"film\": {\"thickness\": 40, \"refractionIndex\": 2.5}"},
    {"sellmeier", sellmeier,
     "\"type\": \"refractive\", \"roughness\": 0.5, \"dispersion\": {\"strengths\": [0.5, 1.25], "
     "\"resonances\": [0.03125, 0.0078125]}"},
    {"eon", eon, "\"type\": \"diffuse\", \"brdf\": \"eon\", \"color\": [0.75, 0.5, 0.25], \"roughness\": 0.5"},
    {"diffuse transmission", diffuse_transmission,
     "\"type\": \"diffuse-transmission\", \"color\": [0.25, 0.25, 0.5], \"transmittance\": [0.5, 0.25, 0]"},
    {"sheen", sheen, "\"type\": \"sheen\", \"color\": [0.75, 0.5, 0.25], \"roughness\": 0.25"},
    {"sheen, default", sheen_default, "\"type\": \"sheen\", \"color\": [0.75, 0.5, 0.25]"},
    {"gold", gold,
     "\"type\": \"conductor\", \"metal\": \"Au\", \"roughness\": 0.5, \"anisotropy\": 0.25, \"rotation\": 30"},
    {"metal by index", metal_by_index,
     "\"type\": \"conductor\", \"eta\": [0.5, 1, 1.5], \"k\": [3, 2, 0], \"roughness\": 0.5, \"anisotropy\": 0.25, "
     "\"rotation\": 30, \"distribution\": \"beckmann\", \"masking\": \"smith-separable\", \"multipleScattering\": false"},
    {"metal by colour", metal_by_colour, "\"type\": \"conductor\", \"reflectance\": [0.75, 0.5, 0.25]"},
    {"metal by tint", metal_by_tint,
     "\"type\": \"conductor\", \"reflectance\": [0.75, 0.5, 0.25], \"edgeTint\": [0, 0, 0]"},
    {"cook-torrance", cook_torrance, "\"type\": \"cook-torrance\", \"metal\": \"Cu\", \"roughness\": 0.5"},
    {"rough dielectric", rough_dielectric,
     "\"type\": \"refractive\", \"refractionIndex\": 1.5, \"roughness\": 0.5, \"anisotropy\": 0.25, \"rotation\": 30"},
    {"thin, clear", thin_clear, "\"type\": \"thin-refractive\", \"refractionIndex\": 1.5"},
    {"thin, tinted", thin_tinted,
     "\"type\": \"thin-refractive\", \"refractionIndex\": 1.5, \"exteriorIndex\": 1.25, \"transmittance\": [0.5, 0, 0.25]"},
    {"thin, frosted", thin_frosted,
     "\"type\": \"thin-refractive\", \"refractionIndex\": 1.5, \"exteriorIndex\": 1.25, \"transmittance\": [0.5, 0, 0.25], "
     "\"roughness\": 0.5, \"anisotropy\": 0.25, \"multipleScattering\": false"},
    {"thin, black", thin_black, "\"type\": \"thin-refractive\", \"refractionIndex\": 1.5, \"transmittance\": [0, 0, 0]"},
    {"coated diffuse", coated_diffuse,
     "\"type\": \"coated-diffuse\", \"color\": [0.75, 0.5, 0.25], \"refractionIndex\": 1.75, \"roughness\": 0.5, "
     "\"anisotropy\": 0.25, \"rotation\": 30"},
    {"principled, default", principled_default, "\"type\": \"principled\""},
    {"principled", principled,
     "\"type\": \"principled\", \"base_weight\": 0.75, \"base_color\": [0.75, 0.5, 0.25], "
     "\"base_diffuse_roughness\": 0.5, \"base_metalness\": 0.25, \"specular_weight\": 0.5, "
     "\"specular_color\": [0.25, 0.5, 0.75], \"specular_roughness\": 0.5, \"specular_roughness_anisotropy\": 0.25, "
     "\"specular_rotation\": 30, \"specular_ior\": 1.75, \"transmission_weight\": 0.25, "
     "\"transmission_color\": [0.5, 1, 0.5], \"transmission_depth\": 0.125, \"coat_weight\": 0.5, \"coat_color\": [1, 0.75, 0.5], "
     "\"coat_roughness\": 0.25, \"coat_roughness_anisotropy\": 0.5, \"coat_ior\": 1.5, \"coat_darkening\": 0.5, "
     "\"fuzz_weight\": 0.25, \"fuzz_color\": [0.5, 0.75, 1], \"fuzz_roughness\": 0.75, \"thin_walled\": true, "
     "\"multipleScattering\": false"},
    {"mix", mix, "\"type\": \"mix\", \"materials\": [\"floor\", \"metal\"], \"weight\": 0.25"},
    {"mix, default", mix_default, "\"type\": \"mix\", \"materials\": [\"metal\", \"floor\"]"},
    {"mix of the first", mix_of_first, "\"type\": \"mix\", \"materials\": [\"floor\", \"metal\"], \"weight\": 0"},
    {"veil", veil, "\"type\": \"diffuse\", \"color\": [0.75, 0.5, 0.25], \"opacity\": 0.25"},
    {"invisible", invisible, "\"type\": \"diffuse\", \"color\": [0.5, 0.5, 0.5], \"opacity\": 0"},
    {"opaque", opaque, "\"type\": \"diffuse\", \"color\": [0.5, 0.5, 0.5]"},
    {"two-sided", two_sided, "\"type\": \"two-sided\", \"front\": \"metal\", \"back\": \"floor\""},
};

/* A floor, and above it a ball that is cut open, so that its inner side is seen. The material of the ball is number 2. */
static etd_scene *scene_of_file(etd_device *device, const char *material) {
    char json[4096];
    etd_scene *scene = NULL;
    snprintf(json, sizeof json,
             "{\"etendue\": 1, \"camera\": {\"origin\": [0, 2, 4], \"lookAt\": [0, 0.5, 0], \"up\": [0, 1, 0], "
             "\"fieldOfView\": 60}, \"materials\": ["
             "{\"name\": \"floor\", \"type\": \"diffuse\", \"color\": [0.5, 0.5, 0.5]}, "
             "{\"name\": \"metal\", \"type\": \"conductor\", \"reflectance\": [0.75, 0.5, 0.25], \"roughness\": 0.5}, "
             "{\"name\": \"ball\", %s}], \"surfaces\": ["
             "{\"geometry\": \"quad\", \"vertex-1\": [-3, -1, -3], \"vertex-2\": [-3, -1, 3], \"vertex-3\": [3, -1, 3], "
             "\"vertex-4\": [3, -1, -3], \"material\": \"floor\"}, "
             "{\"geometry\": \"cone\", \"base\": [0, -0.5, 0], \"axis\": [0, 1, 0], \"radius\": 1, \"height\": 1.5, "
             "\"material\": \"ball\"}, "
             "{\"geometry\": \"quad\", \"vertex-1\": [-1, 3, -1], \"vertex-2\": [1, 3, -1], \"vertex-3\": [1, 3, 1], "
             "\"vertex-4\": [-1, 3, 1], \"emission\": [4, 4, 4]}]}",
             material);
    if (!CHECK_OK(etd_scene_from_json(device, json, strlen(json), NULL, &scene))) {
        fprintf(stderr, "%s\n", json);
    }
    return scene;
}

static void render(etd_device *device, etd_scene *scene, float *pixels) {
    etd_film *film = new_film(device, SIDE, SIDE, 0);
    etd_render_options options = short_render(4);
    etd_image_options image = ETD_IMAGE_OPTIONS_INIT;
    CHECK_OK(etd_render(scene, film, &options));
    CHECK_OK(etd_film_copy(film, ETD_LAYER_COLOR, &image, pixels, SIDE * SIDE * 4 * sizeof *pixels, 0));
    etd_film_release(film);
}

/* The same picture, with light in it. */
static void compare(const float *a, const float *b, const char *name) {
    char text[128];
    double sum = 0;
    int i;
    for (i = 0; i < SIDE * SIDE * 4; ++i) {
        sum += (double)a[i];
    }
    snprintf(text, sizeof text, "%s: the picture of the file", name);
    check_that(memcmp(a, b, SIDE * SIDE * 4 * sizeof *a) == 0, __FILE__, __LINE__, text);
    check_that(sum > SIDE * SIDE && sum < 1e6, __FILE__, __LINE__, name);
}

/* Reads a material with its parameters, so that it can be set again. */
static etd_material read_back(etd_scene *scene, uint32_t number, etd_principled *parameters) {
    etd_material material = ETD_MATERIAL_INIT;
    material.principled = parameters; /* is set to NULL */
    CHECK_OK(etd_scene_get_material(scene, number, &material));
    CHECK(material.principled == NULL && material.struct_size == sizeof material);
    if (material.bsdf == ETD_BSDF_PRINCIPLED) {
        CHECK_OK(etd_scene_get_principled(scene, number, parameters));
        material.principled = parameters;
    }
    return material;
}

int main(void) {
    static float expected[SIDE * SIDE * 4];
    static float found[SIDE * SIDE * 4];
    etd_device *device = new_device(1);
    size_t i;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const char *name = cases[i].name;
        etd_material material = ETD_MATERIAL_INIT;
        etd_principled parameters = ETD_PRINCIPLED_INIT;
        etd_principled read_parameters = ETD_PRINCIPLED_INIT;
        etd_principled of_file = ETD_PRINCIPLED_INIT;
        etd_material one, other;
        uint32_t number = 0;
        etd_scene *file = scene_of_file(device, cases[i].json);
        etd_scene *calls = scene_of_file(device, "\"type\": \"black\"");
        if (file == NULL || calls == NULL) {
            break;
        }
        render(device, file, expected);
        cases[i].set(&material, &parameters);

        /* What is set is what the file says, field by field. */
        CHECK_OK(etd_scene_set_material(calls, 2, &material));
        other = read_back(calls, 2, &read_parameters);
        one = read_back(file, 2, &of_file);
        one.principled = other.principled = NULL;
        check_that(memcmp(&one, &other, sizeof one) == 0, __FILE__, __LINE__, name);
        check_that(memcmp(&of_file, &read_parameters, sizeof of_file) == 0, __FILE__, __LINE__, name);
        check_that(material.bsdf == other.bsdf, __FILE__, __LINE__, name);
        if (material.bsdf == ETD_BSDF_PRINCIPLED) {
            /* Only the angle goes through another unit. */
            check_that(fabsf(parameters.specular_rotation_deg - read_parameters.specular_rotation_deg) < 1e-4f, __FILE__,
                       __LINE__, name);
            read_parameters.specular_rotation_deg = parameters.specular_rotation_deg;
            check_that(memcmp(&parameters, &read_parameters, sizeof parameters) == 0, __FILE__, __LINE__, name);
        }
        render(device, calls, found);
        compare(found, expected, name);

        /* What was read may be set, as a new material of another scene, whose pictures are those of the file too. */
        other = read_back(file, 2, &of_file);
        etd_scene_release(calls);
        calls = scene_of_file(device, "\"type\": \"black\"");
        CHECK_OK(etd_scene_add_material(calls, NULL, &other, &number));
        CHECK_OK(etd_scene_set_surface_material(calls, 1, number));
        memset(&of_file, 0xff, sizeof of_file); /* nobody reads it after the call */
        render(device, calls, found);
        compare(found, expected, name);
        etd_scene_release(calls);
        etd_scene_release(file);
    }
    {
        /* The emission of a material is that of its surfaces. */
        const float radiance[3] = {4, 4, 4};
        etd_material lamp = ETD_MATERIAL_INIT;
        etd_principled unused = ETD_PRINCIPLED_INIT;
        etd_scene *own = scene_of_file(device, "\"type\": \"black\"");
        etd_scene *scene = scene_of_file(device, "\"type\": \"black\"");
        uint32_t number = 0;
        CHECK_OK(etd_scene_set_emission(own, 0, radiance));
        set3(lamp.emission, 4, 4, 4);
        CHECK(etd_scene_set_material(scene, 2, &lamp) == ETD_UNSUPPORTED); /* the cone's */
        CHECK_OK(etd_scene_add_material(scene, "lamp", &lamp, &number));
        CHECK(etd_scene_set_surface_material(scene, 1, number) == ETD_UNSUPPORTED);
        CHECK_OK(etd_scene_set_surface_material(scene, 0, number));
        memset(&lamp, 0xff, sizeof lamp);
        lamp = read_back(scene, number, &unused);
        CHECK(lamp.emission[0] == 4 && lamp.emission[1] == 4 && lamp.emission[2] == 4 && lamp.opacity == 1);
        render(device, own, expected);
        render(device, scene, found);
        compare(found, expected, "emission");
        lamp.opacity = 0.5f;
        CHECK(etd_scene_set_material(scene, number, &lamp) == ETD_INVALID_SCENE);
        lamp.opacity = 1;
        lamp.emission[1] = -1;
        CHECK(etd_scene_set_material(scene, number, &lamp) == ETD_INVALID_SCENE);
        etd_scene_release(own);
        etd_scene_release(scene);
    }
    {
        static const char *const metals[] = {"Ag", "Al", "Au", "Cr", "Cu", "Fe", "Hg", "Ir", "Ni", "Rh", "TiN", "W"};
        for (i = 0; i < sizeof metals / sizeof metals[0]; ++i) {
            float eta[4] = {0, 0, 0, 7};
            float k[4] = {0, 0, 0, 7};
            CHECK_OK(etd_metal(metals[i], eta, k));
            CHECK(eta[0] > 0 && eta[1] > 0 && eta[2] > 0 && k[0] > 1 && k[1] > 1 && k[2] > 1);
            CHECK(eta[3] == 7 && k[3] == 7);
        }
    }
    etd_device_release(device);
    return check_report("materials");
}
