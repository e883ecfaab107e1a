// The C++ layer: what it owns, what it throws or returns, what becomes of exceptions in functions of the host.
//
// Built twice: as it is, and with ETENDUE_NO_EXCEPTIONS and -fno-exceptions.
#include <etendue.hpp>

#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

int checks = 0;
int failures = 0;

void check(bool holds, int line, const char *what) {
    ++checks;
    if (!holds) {
        ++failures;
        std::fprintf(stderr, "layer.cpp:%d: %s (last error: %s)\n", line, what, etd_last_error_message());
    }
}
#define CHECK(condition) check(static_cast<bool>(condition), __LINE__, #condition)

static_assert(!std::is_copy_constructible_v<etd::Device> && std::is_nothrow_move_constructible_v<etd::Device>);
static_assert(!std::is_copy_constructible_v<etd::Scene> && std::is_nothrow_move_assignable_v<etd::Scene>);
static_assert(!std::is_copy_constructible_v<etd::Film> && std::is_nothrow_move_assignable_v<etd::Film>);
static_assert(!std::is_copy_constructible_v<etd::Task> && std::is_nothrow_move_assignable_v<etd::Task>);
static_assert(!std::is_copy_constructible_v<etd::Map> && std::is_nothrow_move_assignable_v<etd::Map>);
static_assert(std::is_nothrow_copy_constructible_v<etd::Error>);

const char broken[] = R"({"etendue": 1,
"camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60},
"surfaces": [
{"geometry": "sphere", "origin": [0, 0, 0], "radius": -1, "emission": [1, 1, 1]}]})";

etd_render_options few(std::uint32_t samples = 2) {
    etd_render_options options = etd::render_options();
    options.samples = samples;
    return options;
}

#if ETENDUE_THROWS

etd::Scene ball(const etd::Device &device) {
    etd::Scene scene = etd::Scene::create(device);
    const auto white = scene.add_material(etd::material(), "white");
    scene.add_sphere({0, 0, -3}, 1, etd::surface(white));
    scene.add_point_light({{2, 2, 0}, {5, 5, 5}});
    return scene;
}

// The status that a call fails with; ETD_OK if it does not.
template <class F>
etd_status status_of(F &&call) {
    try {
        call();
        return ETD_OK;
    } catch (const etd::Error &error) {
        CHECK(std::strlen(error.what()) > 0);
        return error.status();
    }
}

// What a call throws that is not the library's; empty if it throws nothing.
template <class F>
std::string thrown_by(F &&call) {
    try {
        call();
    } catch (const etd::Error &error) {
        return std::string("etd::Error ") + error.what();
    } catch (const std::runtime_error &error) {
        return error.what();
    }
    return {};
}

struct Boom : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void errors() {
    const etd::Device device = etd::Device::create();
    try {
        etd::Scene::from_json(device, broken);
        CHECK(false);
    } catch (const etd::Error &error) {
        CHECK(error.status() == ETD_INVALID_SCENE);
        CHECK(error.line() == 4);
        CHECK(error.json_path().find("surfaces[0]") == 0);
        CHECK(error.message() == error.what());
    }
    CHECK(status_of([&] { etd::Scene::from_json(device, {}); }) == ETD_INVALID_SCENE);
    CHECK(status_of([&] { etd::Scene::from_file(device, "no-such-file.json"); }) == ETD_IO);
    CHECK(status_of([&] { etd::Film::create(device, 0, 0); }) == ETD_INVALID_ARGUMENT);
    etd_device_options options = etd::device_options();
    options.threads = 5000;
    CHECK(status_of([&] { etd::Device::create(options); }) == ETD_INVALID_ARGUMENT);
    etd::Scene scene = ball(device);
    CHECK(status_of([&] { scene.remove_surface(99); }) == ETD_INVALID_ARGUMENT);
    const auto first = scene.first_failure();
    CHECK(first && first->status() == ETD_INVALID_ARGUMENT && first->message().find("99") != std::string::npos);
    CHECK(!scene.first_failure());
}

void owners() {
    std::optional<etd::Map> map;
    std::optional<etd::Task> task;
    {
        etd::Device device = etd::Device::create();
        etd::Scene scene = ball(device);
        etd::Scene moved = std::move(scene);
        CHECK(!scene && moved);
        CHECK(status_of([&] { scene.commit(); }) == ETD_INVALID_ARGUMENT);
        scene = std::move(moved);
        etd::Scene same = scene.share();
        CHECK(same.get() == scene.get());
        etd::Film film = etd::Film::create(device, 8, 4, ETD_LAYER_DEPTH);
        CHECK(etd::render(scene, film, few()) == ETD_OK);
        map = film.map(ETD_LAYER_DEPTH);
        const etd_render_options options = few(100000);
        task = etd::Task::start(scene, film, &options);
        etd::Task second = task->share();
        CHECK(second.poll().status == ETD_RUNNING);
        second = etd::Task(std::move(*task));
        task = std::move(second);
        CHECK(device.memory().used > 0);
        // Everything but the map and the task goes.
    }
    CHECK(map->width() == 8 && map->height() == 4 && map->channels() == 1 && map->data().size() == 32);
    CHECK(map->pixel(4, 2)[0] > 1.9F && map->pixel(4, 2)[0] < 2.6F);
    etd::Map other = std::move(*map);
    CHECK(map->data().empty() && !other.data().empty());
    task->cancel();
    CHECK(task->wait() == ETD_CANCELLED);
    task->resume();
    task->cancel();
    CHECK(task->wait() == ETD_CANCELLED);
}

void shared_meshes() {
    const etd::Device device = etd::Device::create();
    auto positions = std::make_shared<std::vector<float>>(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
    const std::weak_ptr<const void> watch = positions;
    const std::vector<std::uint32_t> indices = {0, 1, 2};
    const std::vector<std::uint32_t> wrong = {0, 1, 7};
    {
        etd::Scene scene = ball(device);
        CHECK(status_of([&] { scene.add_mesh(etd::mesh(*positions, wrong), positions); }) == ETD_INVALID_SCENE);
        CHECK(positions.use_count() == 1);
        const auto mesh = scene.add_mesh(etd::mesh(*positions, indices), positions);
        scene.add_mesh_surface(mesh, false, etd::surface(0));
        positions.reset();
        CHECK(scene.commit() == ETD_OK);
        CHECK(!watch.expired());
        const etd_hit hit = scene.intersect(etd::ray({0.2F, 0.2F, 1}, {0, 0, -1}));
        {
            const std::vector<etd_ray> rays(2, etd::ray({0.2F, 0.2F, 1}, {0, 0, -1}));
            std::vector<etd_hit> hits(1);
            std::vector<std::uint8_t> answers(3);
            CHECK(status_of([&] { scene.intersect(rays, hits); }) == ETD_INVALID_ARGUMENT);
            CHECK(status_of([&] { scene.occluded(rays, answers); }) == ETD_INVALID_ARGUMENT);
        }
        CHECK(hit.surface == 1 && std::fabs(hit.t - 1) < 1e-6F);
        CHECK(scene.occluded(etd::ray({0.2F, 0.2F, 1}, {0, 0, -1})));
        CHECK(!scene.occluded(etd::ray({0.2F, 0.2F, 1}, {0, 0, 1})));
        // A scene that has the mesh too keeps its arrays.
        etd::Scene other = ball(device);
        CHECK(other.add_mesh_from(scene, mesh, "part") == 0);
        CHECK(status_of([&] { other.add_mesh_from(scene, 7); }) == ETD_INVALID_ARGUMENT);
        scene = std::move(other);
        CHECK(!watch.expired());
        CHECK(scene.find_mesh("part") == 0);
    }
    CHECK(watch.expired());
}

void mesh_files() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    const std::string path = "layer-mesh.obj";
    std::FILE *file = std::fopen(path.c_str(), "w");
    CHECK(file != nullptr);
    if (file == nullptr) {
        return;
    }
    std::fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
    std::fclose(file);
    const auto stops = [](const etd_progress &) { return false; };
    const auto throws = [](const etd_progress &) -> bool { throw Boom("reading"); };
    CHECK(status_of([&] { scene.add_mesh_file(path, nullptr, stops); }) == ETD_CANCELLED);
    CHECK(thrown_by([&] { scene.add_mesh_file(path, nullptr, throws); }) == "reading");
    double last = 0;
    const auto listens = [&](const etd_progress &progress) {
        last = progress.fraction;
        return true;
    };
    CHECK(scene.add_mesh_file(path, "part", listens) == 0 && last == 1);
    CHECK(scene.add_mesh_file(path) == 1);
    std::remove(path.c_str());
}

void exceptions() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    etd::Film film = etd::Film::create(device, 8, 8);
    const etd_render_options options = few(1000);
    const auto throws = [](const etd_progress &) -> bool { throw Boom("progress"); };

    CHECK(thrown_by([&] { etd::render(scene, film, options, throws); }) == "progress");
    CHECK(etd::render(scene, film, few()) == ETD_OK); // nothing is left of it
    scene.set_camera(etd::camera());
    etd::Scene second = ball(device);
    CHECK(thrown_by([&] { second.commit(throws); }) == "progress");
    CHECK(second.commit() == ETD_OK);

    {
        etd::Task task = etd::Task::start(scene, film, &options, throws);
        CHECK(thrown_by([&] { task.wait(); }) == "progress");
        CHECK(task.wait() == ETD_CANCELLED); // only once
    }
    {
        const etd_render_options short_options = few();
        int ends = 0;
        etd::Task task = etd::Task::start(scene, film, &short_options, {}, [&](etd_status status) {
            CHECK(status == ETD_OK);
            ++ends;
            throw Boom("finished");
        });
        CHECK(thrown_by([&] { task.wait(); }) == "finished");
        CHECK(ends == 1);
    }
    {
        // Nobody waits: nothing is thrown.
        const etd::Task task = etd::Task::start(scene, film, &options, throws);
    }
    {
        int reports = 0;
        CHECK(etd::render(scene, film, options, [&](const etd_progress &) { return ++reports < 1; }) ==
              ETD_CANCELLED);
        CHECK(reports == 1);
    }
    {
        // What the options say is called where no function object is given.
        int reports = 0;
        etd_render_options raw = few(1000);
        raw.progress = [](void *user_data, const etd_progress *) -> std::int32_t {
            ++*static_cast<int *>(user_data);
            return 1;
        };
        raw.user_data = &reports;
        CHECK(etd::render(scene, film, raw) == ETD_CANCELLED && reports == 1);
    }
}

void exceptions_of_devices() {
    bool armed = false;
    etd::DeviceFunctions functions;
    functions.log = [&](etd_log_level, const char *) {
        if (armed) {
            throw Boom("log");
        }
    };
    functions.error = [](etd_status, const char *) { throw Boom("error"); };
    const etd::Device device = etd::Device::create(etd::device_options(), std::move(functions));
    etd::Scene scene = ball(device);
    etd::Film film = etd::Film::create(device, 4, 4);
    armed = true;
    CHECK(thrown_by([&] { scene.commit(); }) == "log");
    armed = false;
    CHECK(etd::render(scene, film, few()) == ETD_OK);
    CHECK(status_of([&] { scene.remove_surface(99); }) == ETD_INVALID_ARGUMENT);
    CHECK(thrown_by([&] { scene.commit(); }) == "error");
    CHECK(scene.commit() == ETD_OK);
}

void executors() {
    // Takes nothing: the work is done all the same, and the wait says what was thrown.
    etd::DeviceFunctions functions;
    int submitted = 0;
    functions.submit = [&](const etd::Work &) {
        ++submitted;
        throw Boom("submit");
    };
    etd_device_options options = etd::device_options();
    options.threads = 2;
    const etd::Device device = etd::Device::create(options, std::move(functions));
    etd::Scene scene = ball(device);
    etd::Film film = etd::Film::create(device, 8, 8);
    CHECK(thrown_by([&] {
              etd::Task task = etd::Task::start(scene, film);
              task.wait();
          }) == "submit");
    CHECK(submitted > 0);

    // Two calls of one piece of work are one.
    std::vector<std::thread> threads;
    etd::DeviceFunctions doubled;
    doubled.submit = [&](const etd::Work &work) {
        work();
        threads.emplace_back([work] { work(); });
    };
    const etd::Device twice = etd::Device::create(options, std::move(doubled));
    etd::Scene other = ball(twice);
    etd::Film picture = etd::Film::create(twice, 8, 8);
    CHECK(etd::render(other, picture, few()) == ETD_OK);
    for (std::thread &thread : threads) {
        thread.join();
    }
}

void task_in_its_own_function() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    etd::Film film = etd::Film::create(device, 8, 8);
    const etd_render_options options = few(100000);
    auto alive = std::make_shared<int>(0);
    const std::weak_ptr<int> watch = alive;
    std::mutex mutex;
    std::optional<etd::Task> task;
    {
        const std::lock_guard<std::mutex> lock(mutex);
        task = etd::Task::start(scene, film, &options, [&mutex, &task, alive](const etd_progress &) {
            const std::lock_guard<std::mutex> guard(mutex);
            task.reset(); // the last owner: cancelled, not waited for
            return true;
        });
    }
    alive.reset();
    while (!watch.expired()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    CHECK(!task);
}

void contents() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    CHECK(scene.find_material("white") == 0);
    CHECK(scene.find_surface("surfaces[0]") == 0);
    const etd_surface at = scene.surface(0);
    CHECK(at.material == 0);
    CHECK(scene.point_light(0).intensity[2] == 5);
    etd_motion_key keys[2] = {ETD_MOTION_KEY_INIT, ETD_MOTION_KEY_INIT};
    keys[1].time = 1;
    keys[1].translation[0] = 1;
    scene.set_surface_motion(0, keys, 2);
    scene.set_light_motion(0, keys, 2);
    scene.set_camera_motion(keys, 2);
    etd_shutter shutter = ETD_SHUTTER_INIT;
    shutter.close = 0.5;
    scene.set_shutter(shutter);
    CHECK(scene.shutter().close == 0.5);
    CHECK(status_of([&] { scene.set_mesh_steps(7, nullptr, 0, nullptr); }) == ETD_INVALID_ARGUMENT);
    scene.set_surface_motion(0, nullptr, 0);
    scene.set_light_motion(0, nullptr, 0);
    scene.set_camera_motion(nullptr, 0);
    etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
    spot.outer_cone_deg = 30;
    const std::uint32_t beam = scene.add_spot_light(spot);
    CHECK(scene.spot_light(beam).outer_cone_deg == 30 && scene.spot_light(beam).direction[1] == -1);
    scene.set_point_light(beam, {{1, 2, 3}, {0, 0, 0}});
    spot = scene.spot_light(beam);
    CHECK(spot.position[2] == 3 && spot.intensity[0] == 0 && spot.outer_cone_deg == 30);
    spot.inner_cone_deg = 20;
    scene.set_spot_light(beam, spot);
    CHECK(scene.spot_light(beam).inner_cone_deg == 20);
    const std::string text = "TILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n";
    etd_web_light web = ETD_WEB_LIGHT_INIT;
    CHECK(status_of([&] { scene.add_web_light(web); }) == ETD_INVALID_ARGUMENT);
    web.text = text.data();
    web.text_bytes = text.size();
    web.factor[1] = 0;
    const std::uint32_t lamp = scene.add_web_light(web);
    web = scene.web_light(lamp);
    CHECK(!web.text && !web.file && web.factor[1] == 0 && web.factor[0] == 1 && web.c0[0] == 1);
    web.factor[0] = web.factor[2] = 0;
    scene.set_web_light(lamp, web);
    CHECK(scene.web_light(lamp).factor[0] == 0);
    CHECK(status_of([&] { scene.set_web_light(beam, web); }) == ETD_INVALID_ARGUMENT);
    etd::Scene room = ball(device);
    etd_surface glowing = ETD_SURFACE_INIT;
    glowing.emission[0] = 0.5F;
    const std::uint32_t panel = room.add_disk({0, 3, 0}, {0, -1, 0}, 0.1, glowing);
    etd_surface_web shaped = ETD_SURFACE_WEB_INIT;
    CHECK(status_of([&] { room.set_surface_web(panel, shaped); }) == ETD_INVALID_ARGUMENT);
    shaped.text = text.data();
    shaped.text_bytes = text.size();
    shaped.c0[2] = 1;
    room.set_surface_web(panel, shaped);
    CHECK(room.surface_web(panel).c0[2] == 1 && !room.surface_web(panel).text);
    room.clear_surface_web(panel);
    CHECK(status_of([&] { room.surface_web(panel); }) == ETD_INVALID_ARGUMENT);
    etd_spectrum glow = ETD_SPECTRUM_INIT;
    glow.kind = ETD_SPECTRUM_BLACK_BODY;
    CHECK(status_of([&] { room.set_spectrum(ETD_SPECTRUM_OF_SURFACE, panel, glow); }) == ETD_INVALID_SCENE);
    glow.temperature = 2700;
    room.set_spectrum(ETD_SPECTRUM_OF_SURFACE, panel, glow);
    CHECK(room.spectrum(ETD_SPECTRUM_OF_SURFACE, panel).temperature == 2700);
    CHECK(room.surface(panel).emission[0] > 2 * room.surface(panel).emission[2]);
    room.clear_spectrum(ETD_SPECTRUM_OF_SURFACE, panel);
    CHECK(status_of([&] { room.spectrum(ETD_SPECTRUM_OF_SURFACE, panel); }) == ETD_INVALID_ARGUMENT);
    CHECK(scene.environment()[0] == 0);
    scene.set_environment({0.25F, 0.5F, 1});
    CHECK(scene.environment()[1] == 0.5F);
    etd_environment_map hidden = ETD_ENVIRONMENT_MAP_INIT;
    hidden.hidden = 1;
    scene.set_environment_map(hidden);
    CHECK(scene.environment_map().hidden == 1 && scene.environment()[1] == 1);
    CHECK(scene.backplate().radiance[0] == 0 && scene.backplate().texture == ETD_NONE);
    etd_backplate grey = ETD_BACKPLATE_INIT;
    grey.radiance[1] = 0.5F;
    scene.set_backplate(grey);
    CHECK(scene.backplate().radiance[1] == 0.5F && scene.environment()[1] == 1);
    grey.texture = 99;
    CHECK(status_of([&] { scene.set_backplate(grey); }) == ETD_INVALID_SCENE);
    scene.remove_backplate();
    CHECK(scene.backplate().radiance[1] == 0);
    etd_sky clear = ETD_SKY_INIT;
    clear.sun[0] = 1;
    scene.set_sky(clear);
    CHECK(scene.sky().cie == 12 && scene.sky().sun[0] == 1 && scene.environment()[1] == 1);
    clear.cie = 0;
    clear.turbidity = 2.5;
    clear.no_disk = 1;
    scene.set_sky(clear);
    CHECK(scene.sky().cie == 0 && scene.sky().turbidity == 2.5 && scene.sky().no_disk == 1);
    etd_distant_light sun = ETD_DISTANT_LIGHT_INIT;
    sun.angle_deg = 0.533;
    CHECK(scene.add_distant_light(sun) == 0);
    CHECK(scene.distant_light(0).angle_deg == 0.533);
    sun.irradiance[0] = sun.irradiance[1] = sun.irradiance[2] = 0;
    scene.set_distant_light(0, sun);
    CHECK(scene.distant_light(0).irradiance[1] == 0);
    scene.remove_environment();
    CHECK(scene.environment()[1] == 0);
    CHECK(scene.resolution().width == 256);
    CHECK(scene.commit() == ETD_OK);
    CHECK(scene.info().surfaces == 1);
    CHECK(scene.text(ETD_TEXT_INFO).size() > 10);
    etd::Film film = etd::Film::create(device, 3, 2);
    CHECK(etd::render(scene, film, few()) == ETD_OK);
    std::vector<float> floats(3 * 2 * 4);
    film.copy(ETD_LAYER_COLOR, etd::span<float>(floats));
    const etd::Map map = film.map();
    CHECK(std::memcmp(map.data().data(), floats.data(), floats.size() * sizeof(float)) == 0);
    etd::Film window = etd::Film::create(device, 8, 8);
    window.resize(3, 2);
    CHECK(window.resolution().width == 3 && window.resolution().height == 2);
    CHECK(etd::render(scene, window, few()) == ETD_OK);
    CHECK(std::memcmp(window.map().data().data(), floats.data(), floats.size() * sizeof(float)) == 0);
    CHECK(status_of([&] { window.resize(0, 2); }) == ETD_INVALID_ARGUMENT);
    std::vector<unsigned char> bytes(3 * 2 * 3);
    etd_image_options image = etd::image_options();
    image.format = ETD_FORMAT_RGB8;
    film.copy(ETD_LAYER_COLOR, etd::span<unsigned char>(bytes), image);
    CHECK(film.summary().samples == 2);
    CHECK(status_of([&] { film.copy(ETD_LAYER_COLOR, etd::span<unsigned char>(bytes)); }) == ETD_INVALID_ARGUMENT);
}

// Parts of a picture: saved, loaded, merged, gone on from.
void parts() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    etd::Film whole = etd::Film::create(device, 20, 17);
    etd::render(scene, whole, few(4));
    std::vector<etd::Film> films;
    for (std::uint32_t number = 1; number <= 2; ++number) {
        etd::Film film = etd::Film::create(device, 20, 17);
        etd_render_options options = few();
        options.share_number = number;
        options.share_count = 2;
        etd::render(scene, film, options);
        films.push_back(etd::Film::load_memory(device, film.save_memory()));
        CHECK(films.back().part().number == number && films.back().part().count == 2);
        CHECK(films.back().resolution().width == 20 && films.back().resolution().height == 17);
    }
    etd::Film merged = etd::Film::merge(films);
    CHECK(merged.part().count == 0 && merged.summary().samples == 2);
    CHECK(status_of([&] { (void)etd::Film::merge(etd::span<const etd::Film>(films.data(), 1)); }) ==
          ETD_INVALID_ARGUMENT);
    CHECK(status_of([&] { (void)etd::Film::merge({}); }) == ETD_INVALID_ARGUMENT);
    merged.save("layer.film");
    const etd::Film read = etd::Film::load(device, "layer.film");
    std::remove("layer.film");
    etd_render_options options = few(4);
    options.resume = read.get();
    etd::render(scene, merged, options);
    CHECK(merged.save_memory() == whole.save_memory());
    CHECK(status_of([&] { (void)etd::Film::load(device, "layer.film"); }) == ETD_IO);
    CHECK(status_of([&] { (void)etd::Film::load_memory(device, {}); }) == ETD_INVALID_SCENE);
    CHECK(status_of([&] { (void)etd::Film::load_memory(device, read.save_memory(), ETD_LAYER_DEPTH); }) ==
          ETD_UNSUPPORTED);
    CHECK(status_of([&] { (void)etd::Film::create(device, 2, 2).save_memory(); }) == ETD_INVALID_OPERATION);
}

void materials() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    const etd::Metal gold = etd::metal("Au");
    const std::uint32_t metal = scene.add_material(etd::material(gold, 0.25F), "gold");
    const etd_material found = scene.material(metal);
    CHECK(found.bsdf == ETD_BSDF_CONDUCTOR && found.roughness == 0.25F);
    CHECK(found.eta[0] == gold.eta[0] && found.k[2] == gold.k[2] && gold.k[0] > 3);
    etd_principled parameters = etd::principled();
    parameters.coat_weight = 1;
    const std::uint32_t varnished = scene.add_material(etd::material(parameters));
    CHECK(scene.material(varnished).principled == nullptr);
    CHECK(scene.principled(varnished).coat_weight == 1 && scene.principled(varnished).specular_roughness == 0.3F);
    CHECK(status_of([&] { (void)scene.principled(metal); }) == ETD_INVALID_ARGUMENT);
    CHECK(status_of([&] { (void)etd::metal("gold"); }) == ETD_INVALID_ARGUMENT);
}

void light_maps() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    etd_atlas_options layout = etd::atlas_options();
    layout.resolution = 64;
    CHECK(status_of([&] { etd::Atlas::create(scene, layout, [](const etd_progress &) { return false; }); }) ==
          ETD_CANCELLED);
    CHECK(thrown_by([&] {
              etd::Atlas::create(scene, layout, [](const etd_progress &) -> bool { throw Boom("atlas"); });
          }) == "atlas");
    double fraction = -1;
    etd::Atlas atlas = etd::Atlas::create(scene, layout, [&](const etd_progress &progress) {
        fraction = progress.fraction;
        return true;
    });
    CHECK(fraction > 0 && fraction <= 1);
    const etd_atlas_info info = atlas.info();
    CHECK(info.width == 64 && info.height == 64);
    CHECK(atlas.vertices().size() == info.vertex_count);
    CHECK(atlas.indices().size() == 3 * info.triangle_count);
    CHECK(atlas.primitives().size() == info.triangle_count);
    CHECK(atlas.surfaces().size() == 1 && atlas.surfaces()[0].triangle_count == info.triangle_count);
    const std::vector<float> coverage = atlas.coverage();
    std::vector<float> texels(64 * 64 * 3, -1.0F);
    etd_summary summary = ETD_SUMMARY_INIT;
    CHECK(atlas.bake(etd::bake_target(texels), few(), {}, &summary) == ETD_OK);
    CHECK(summary.samples == 2);
    bool is_lit = false;
    for (std::size_t i = 0; i < coverage.size(); ++i) {
        CHECK(texels[3 * i] >= 0);
        is_lit = is_lit || (coverage[i] > 0 && texels[3 * i] > 0);
    }
    CHECK(is_lit);
    CHECK(atlas.bake(etd::bake_target(texels), few(100000), [](const etd_progress &) { return false; }) == ETD_CANCELLED);
    CHECK(thrown_by([&] {
              atlas.bake(etd::bake_target(texels), few(), [](const etd_progress &) -> bool { throw Boom("bake"); });
          }) == "bake");
    CHECK(status_of([&] { atlas.bake(etd::bake_target(etd::span<float>()), few()); }) == ETD_INVALID_ARGUMENT);
    CHECK(status_of([&] { etd::bake_vertices(scene, 7, etd::bake_target(texels), few()); }) == ETD_INVALID_ARGUMENT);
    std::vector<float> vertices(3 * info.vertex_count);
    CHECK(etd::bake_vertices(scene, 0, etd::bake_target(vertices), few()) == ETD_OK);
    const std::vector<etd_measuring_point> points{{{0, 2, 0}, {0, 1, 0}}, {{2, 1, 0}, {0, 1, 0}}};
    std::vector<double> lux(2, -1.0);
    std::vector<double> errors(2, -1.0);
    CHECK(etd::measure(scene, ETD_QUANTITY_ILLUMINANCE, points, few(8), lux, errors) == ETD_OK);
    CHECK(lux[0] >= 0 && lux[1] >= 0 && errors[0] >= 0);
    CHECK(etd::measure(scene, ETD_QUANTITY_ILLUMINANCE, points, few(100000), lux, {},
                       [](const etd_progress &) { return false; }) == ETD_CANCELLED);
    CHECK(status_of([&] {
              etd::measure(scene, ETD_QUANTITY_LUMINANCE, points, few(), etd::span<double>(lux.data(), 1));
          }) == ETD_INVALID_ARGUMENT);
    const etd::Atlas other = atlas.share();
    CHECK(other.get() == atlas.get());
}

void mattes() {
    const etd::Device device = etd::Device::create();
    etd::Scene scene = ball(device);
    const std::uint32_t number = 0;
    const std::string name = "a name that is longer than a short text \xc3\xa4";
    CHECK(scene.surface_name(number).empty());
    scene.set_surface_name(number, name);
    CHECK(scene.surface_name(number) == name);
    std::vector<std::uint32_t> ids(8 * 6 * 2, 1);
    std::vector<float> coverages(8 * 6 * 2, -1.0F);
    CHECK(etd::trace_mattes(scene, 8, 6, few(), ETD_MATTE_OBJECT, 2, ids, coverages) == ETD_OK);
    const std::uint32_t id = etd::matte_id(name);
    bool is_seen = false;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        CHECK(ids[i] == (coverages[i] > 0 ? id : 0));
        is_seen = is_seen || coverages[i] > 0;
    }
    CHECK(is_seen);
    CHECK(status_of([&] { etd::trace_mattes(scene, 8, 6, few(), ETD_MATTE_OBJECT, 3, ids, coverages); }) ==
          ETD_INVALID_ARGUMENT);
    CHECK(status_of([&] { etd::trace_mattes(scene, 8, 6, few(), ETD_MATTE_OBJECT, 0, ids, coverages); }) ==
          ETD_INVALID_ARGUMENT);
    scene.set_surface_name(number, "");
    CHECK(scene.surface_name(number).empty());
}

void all() {
    light_maps();
    mattes();
    errors();
    owners();
    shared_meshes();
    mesh_files();
    exceptions();
    exceptions_of_devices();
    executors();
    task_in_its_own_function();
    contents();
    parts();
    materials();
}

#else

void all() {
    etd::Result<etd::Device> device = etd::Device::create();
    CHECK(device.has_value() && device);
    if (!device) {
        return;
    }
    const etd::Result<etd::Scene> none = etd::Scene::from_json(*device, broken);
    CHECK(!none);
    CHECK(none.error().status() == ETD_INVALID_SCENE && none.error().line() == 4);
    etd::Result<etd::Scene> made = etd::Scene::create(*device);
    CHECK(made);
    etd::Scene scene = std::move(made).value();
    etd::Result<std::uint32_t> material = scene.add_material(etd::material(), "white");
    CHECK(material && *material == 0);
    CHECK(scene.add_material(etd::material(etd::metal("Cu").value(), 0.5F)).has_value());
    CHECK(scene.principled(*material).error().status() == ETD_INVALID_ARGUMENT);
    CHECK(etd::metal("copper").error().message().find("Cu") != std::string::npos);
    CHECK(scene.add_sphere({0, 0, -3}, 1, etd::surface(*material)).has_value());
    CHECK(scene.add_point_light({{2, 2, 0}, {5, 5, 5}}).has_value());
    const etd::Result<void> refused = scene.remove_surface(99);
    CHECK(!refused && refused.error().status() == ETD_INVALID_ARGUMENT);
    CHECK(scene.set_camera(etd::camera()).has_value());
    etd::Result<etd::Film> film = etd::Film::create(*device, 4, 4);
    CHECK(film);
    const etd_render_options options = few(1000);
    etd::Result<etd_status> status =
        etd::render(scene, *film, options, [](const etd_progress &) { return false; });
    CHECK(status && *status == ETD_CANCELLED);
    etd::Result<etd::Task> task = etd::Task::start(scene, *film, &options);
    CHECK(task);
    CHECK(task->cancel().has_value());
    status = task->wait();
    CHECK(status && (*status == ETD_CANCELLED || *status == ETD_OK));
    CHECK(film->map()->data().size() == 64);
    CHECK(film->resize(5, 2) && film->map()->data().size() == 40);
    CHECK(film->resize(0, 2).error().status() == ETD_INVALID_ARGUMENT);
    CHECK(film->resize(4, 4));
    CHECK(scene.add_mesh_from(scene, 0).error().status() == ETD_INVALID_ARGUMENT);
    CHECK(scene.add_mesh_file("no-such-file.obj", nullptr, {}).error().status() == ETD_IO);
    etd::Result<etd::Atlas> atlas = etd::Atlas::create(scene);
    CHECK(atlas && atlas->info()->width == 512);
    const etd::Result<etd::Atlas> stopped =
        etd::Atlas::create(scene, etd::atlas_options(), [](const etd_progress &) { return false; });
    CHECK(!stopped && stopped.error().status() == ETD_CANCELLED);
    const etd::Result<etd_status> baked = atlas->bake(etd::bake_target(etd::span<float>()), options);
    CHECK(!baked && baked.error().status() == ETD_INVALID_ARGUMENT);
    CHECK(film->map(ETD_LAYER_DEPTH).error().status() == ETD_INVALID_OPERATION);
    CHECK(etd::render(scene, *film, few()));
    etd::Result<std::vector<unsigned char>> bytes = film->save_memory();
    CHECK(bytes && !bytes->empty());
    etd::Result<etd::Film> loaded = etd::Film::load_memory(*device, *bytes);
    CHECK(loaded && loaded->part()->count == 0 && loaded->resolution()->width == 4);
    CHECK(etd::Film::load(*device, "no-such-file").error().status() == ETD_IO);
}

#endif

} // namespace

int main() {
    all();
    std::printf("layer (%s): %d checks, %d failed\n", ETENDUE_THROWS ? "throwing" : "returning", checks, failures);
    return failures == 0 && checks > 0 ? 0 : 1;
}
