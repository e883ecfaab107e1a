/**
 * @file etendue.hpp
 * @brief Étendue for C++17 and later: etendue.h with owners, exceptions and function objects. Header only.
 *
 * Everything is the C interface; its documentation says what calls mean, and structures of options are the C ones, filled
 * with their defaults by functions of their name (`etd::render_options()`). What this file adds:
 *
 * **Owners.** `Device`, `Scene`, `Film`, `Task` and `Map` hold one reference and give it back. They can be moved, not
 * copied; `share()` makes a second owner of the same object. They may be destroyed in any order.
 *
 * **Errors.** One mechanism, two forms. Every call that can fail has the return type `Outcome<T>`:
 *   - with exceptions, `Outcome<T>` is `T`, and a failure throws `etd::Error`;
 *   - where `ETENDUE_NO_EXCEPTIONS` is defined, or the compiler has exceptions switched off, `Outcome<T>` is
 *     `etd::Result<T>`, which holds a value or an `etd::Error`, and nothing is thrown.
 *
 * The two forms have names of their own for the linker, so that files of both kinds may be linked together; objects
 * cannot be handed from one kind to the other except as C handles. `ETD_CANCELLED` and `ETD_RUNNING` are no failures
 * here: the calls that can come to them return the status as their value.
 *
 * **Functions of the host.** Progress, log and the like are `std::function`s, kept alive for as long as the library may
 * call them. What they throw never reaches the library: the work at hand is cancelled, and the call that waits for it
 * (`Scene::commit`, `render`, `Task::wait`) throws it again.
 *
 * @code{.cpp}
 * etd::Device device = etd::Device::create();
 * etd::Scene scene = etd::Scene::from_file(device, "scenes/room.json");
 * etd::Film film = etd::Film::create(device, 640, 480);
 * etd::render(scene, film);
 * film.write("room.png");
 * @endcode
 */
#ifndef ETENDUE_HPP
#define ETENDUE_HPP

#include "etendue.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#if defined(__has_include)
#if __has_include(<span>) && (__cplusplus >= 202002L || (defined(_MSVC_LANG) && _MSVC_LANG >= 202002L))
#include <span>
#endif
#endif

/** 1 where failures are thrown, 0 where they are returned. */
#if defined(ETENDUE_NO_EXCEPTIONS) || !(defined(__cpp_exceptions) || defined(_CPPUNWIND))
#define ETENDUE_THROWS 0
#else
#define ETENDUE_THROWS 1
#endif

/** The C++ layer of Étendue. */
namespace etd {

#if ETENDUE_THROWS
/** Everything, in the form that throws. */
inline namespace throwing {
#else
/** Everything, in the form that returns `Result`. */
inline namespace returning {
#endif

// ---------------------------------------------------------------------------------------------------------------------
// Arrays

#ifdef __cpp_lib_span
/** Items one after another that belong to somebody else. */
template <class T>
using span = std::span<T>;
#else
/** Items one after another that belong to somebody else: as much of C++20's `std::span` as is needed here. */
template <class T>
class span {
public:
    /** What it holds, without `const`. */
    using value_type = std::remove_cv_t<T>;

    /** No items. */
    constexpr span() noexcept = default;
    /** `count` items from `first` on. */
    constexpr span(T *first, std::size_t count) noexcept : data_(first), size_(count) {}
    /** The items of an array. */
    template <std::size_t N>
    constexpr span(T (&items)[N]) noexcept : data_(items), size_(N) {}
    /** The items of whatever has `data()` and `size()`: vectors, arrays, other spans. */
    template <class C, class = std::enable_if_t<
                           !std::is_same_v<std::remove_cv_t<std::remove_reference_t<C>>, span> &&
                           std::is_convertible_v<
                               std::remove_pointer_t<decltype(std::declval<C &>().data())> (*)[], T (*)[]>>>
    constexpr span(C &&items) noexcept : data_(items.data()), size_(items.size()) {}

    /** The first item. */
    constexpr T *data() const noexcept { return data_; }
    /** How many there are. */
    constexpr std::size_t size() const noexcept { return size_; }
    /** How many bytes they take. */
    constexpr std::size_t size_bytes() const noexcept { return size_ * sizeof(T); }
    /** Whether there is none. */
    constexpr bool empty() const noexcept { return size_ == 0; }
    /** One of them. */
    constexpr T &operator[](std::size_t index) const noexcept { return data_[index]; }
    /** To go through them. */
    constexpr T *begin() const noexcept { return data_; }
    /** Behind the last one. */
    constexpr T *end() const noexcept { return data_ + size_; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};
#endif

/** Three numbers: a position, or a direction. */
using Vec3 = std::array<double, 3>;
/** Linear Rec. 709 red, green and blue. */
using Rgb = std::array<float, 3>;
/** Object to world: three rows of four, the last column translates. */
using Transform = std::array<double, 12>;

// ---------------------------------------------------------------------------------------------------------------------
// Defaults

/** The defaults of a device. */
inline etd_device_options device_options() noexcept { return ETD_DEVICE_OPTIONS_INIT; }
/** The defaults of a scene. */
inline etd_scene_options scene_options() noexcept { return ETD_SCENE_OPTIONS_INIT; }
/** The defaults of a render; `Scene::render_options` gives those that the scene itself asks for. */
inline etd_render_options render_options() noexcept { return ETD_RENDER_OPTIONS_INIT; }
/** The defaults of a copied or written image. */
inline etd_image_options image_options() noexcept { return ETD_IMAGE_OPTIONS_INIT; }
/** The default camera. */
inline etd_camera camera() noexcept { return ETD_CAMERA_INIT; }
/** Defaults of a light map's layout. */
inline etd_atlas_options atlas_options() noexcept { return ETD_ATLAS_OPTIONS_INIT; }
/** Three floats for each texel or vertex, close together. */
inline etd_bake_target bake_target(span<float> irradiance) noexcept {
    etd_bake_target target = ETD_BAKE_TARGET_INIT;
    target.irradiance = irradiance.data();
    target.size = irradiance.size() * sizeof(float);
    return target;
}
/** A film of this resolution; `layers`: `etd_layer` bits besides the colour. */
inline etd_film_options film_options(std::uint32_t width, std::uint32_t height, std::uint32_t layers = 0) noexcept {
    etd_film_options options = ETD_FILM_OPTIONS_INIT;
    options.width = width;
    options.height = height;
    options.layers = layers;
    return options;
}
/** A material of this model and colour. */
inline etd_material material(etd_bsdf bsdf = ETD_BSDF_LAMBERT, const Rgb &color = {0.5F, 0.5F, 0.5F}) noexcept {
    etd_material value = ETD_MATERIAL_INIT;
    value.bsdf = bsdf;
    for (std::size_t i = 0; i < 3; ++i) {
        value.color[i] = color[i];
    }
    return value;
}
/** The parameters of a principled material, with OpenPBR's defaults. */
inline etd_principled principled() noexcept { return ETD_PRINCIPLED_INIT; }
/** A principled material. `parameters` must live until the material was added or set. */
inline etd_material material(const etd_principled &parameters) noexcept {
    etd_material value = material(ETD_BSDF_PRINCIPLED);
    value.principled = &parameters;
    return value;
}
/** A temporary would be gone before the material is used. */
etd_material material(etd_principled &&parameters) = delete;
/** A surface of this material that emits this radiance. */
inline etd_surface surface(std::uint32_t material = ETD_NONE, const Rgb &emission = {0, 0, 0}) noexcept {
    etd_surface value = ETD_SURFACE_INIT;
    value.material = material;
    for (std::size_t i = 0; i < 3; ++i) {
        value.emission[i] = emission[i];
    }
    return value;
}
/**
 * A mesh of these arrays, to be copied (or shared, see `Scene::add_mesh`).
 *
 * `positions`: three for each vertex; one or two more may follow, which is what sharing needs at the end (16 bytes must
 * be readable from the last position on). `indices`: three for each triangle. The arrays are only pointed to.
 */
inline etd_mesh mesh(span<const float> positions, span<const std::uint32_t> indices) noexcept {
    etd_mesh value = ETD_MESH_INIT;
    value.positions = positions.data();
    value.position_bytes = positions.size_bytes();
    value.vertex_count = positions.size() / 3;
    value.indices = indices.data();
    value.triangle_count = indices.size() / 3;
    return value;
}
/** The same with positions in double precision, which are always copied. */
inline etd_mesh mesh(span<const double> positions, span<const std::uint32_t> indices) noexcept {
    etd_mesh value = ETD_MESH_INIT;
    value.positions = positions.data();
    value.position_format = ETD_POSITION_DOUBLE3;
    value.vertex_count = positions.size() / 3;
    value.indices = indices.data();
    value.triangle_count = indices.size() / 3;
    return value;
}
/** A ray from `origin` on, without an end. */
inline etd_ray ray(const Rgb &origin, const Rgb &direction) noexcept {
    return {{origin[0], origin[1], origin[2]},
            0,
            {direction[0], direction[1], direction[2]},
            std::numeric_limits<float>::infinity()};
}

// ---------------------------------------------------------------------------------------------------------------------
// Errors

/** Why a call failed. Cheap to copy. */
class Error : public std::exception {
public:
    /** A failure of this status and message. */
    Error(etd_status status, std::string message, std::string file = {}, std::string json_path = {},
          std::uint32_t line = 0)
        : parts_(std::make_shared<const Parts>(
              Parts{status, line, std::move(message), std::move(file), std::move(json_path)})) {}

    /** The last failure of this thread. */
    static Error last(etd_status status) {
        etd_error error = ETD_ERROR_INIT;
        if (etd_last_error(&error) != ETD_OK || error.status != status) {
            return Error(status, etd_status_name(status));
        }
        return Error(status, error.message, error.file, error.json_path, error.line);
    }

    /** What the call returned. */
    etd_status status() const noexcept { return parts_->status; }
    /** The whole message, with file, line and JSON path in front. */
    const std::string &message() const noexcept { return parts_->message; }
    /** The file that it is about; empty where it is about none. */
    const std::string &file() const noexcept { return parts_->file; }
    /** JSON path such as `surfaces[3].radius`; empty where there is none. */
    const std::string &json_path() const noexcept { return parts_->json_path; }
    /** One-based line in `file()`; 0 where it is not known. */
    std::uint32_t line() const noexcept { return parts_->line; }
    /** The message. */
    const char *what() const noexcept override { return parts_->message.c_str(); }

private:
    struct Parts {
        etd_status status;
        std::uint32_t line;
        std::string message;
        std::string file;
        std::string json_path;
    };
    // Shared, so that copying an exception in flight cannot throw.
    std::shared_ptr<const Parts> parts_;
};

/** A value, or the error that there is instead. */
template <class T>
class [[nodiscard]] Result {
    using Stored = std::conditional_t<std::is_void_v<T>, std::monostate, T>;

public:
    /** A value. */
    Result(Stored value) : holds_(std::in_place_index<0>, std::move(value)) {}
    /** An error. */
    Result(Error error) : holds_(std::in_place_index<1>, std::move(error)) {}
    /** Success without a value. */
    template <class U = T, class = std::enable_if_t<std::is_void_v<U>>>
    Result() : holds_(std::in_place_index<0>) {}

    /** Whether there is a value. */
    bool has_value() const noexcept { return holds_.index() == 0; }
    /** Whether there is a value. */
    explicit operator bool() const noexcept { return has_value(); }
    /** The value; ends the program, with the message, if there is none. */
    Stored &value() & noexcept { return *checked(); }
    /** The value, to be moved out of a temporary. */
    Stored &&value() && noexcept { return std::move(*checked()); }
    /** The value, as is. */
    const Stored &value() const & noexcept { return *const_cast<Result *>(this)->checked(); }
    /** The value. */
    Stored &operator*() & noexcept { return value(); }
    /** The value, to be moved out of a temporary. */
    Stored &&operator*() && noexcept { return std::move(*this).value(); }
    /** A member of the value. */
    Stored *operator->() noexcept { return checked(); }
    /** The error; ends the program if there is none. */
    const Error &error() const noexcept {
        const Error *error = std::get_if<1>(&holds_);
        if (error == nullptr) {
            std::fputs("etd::Result: there is a value, no error\n", stderr);
            std::abort();
        }
        return *error;
    }

private:
    Stored *checked() noexcept {
        if (const Error *error = std::get_if<1>(&holds_)) {
            std::fprintf(stderr, "etd::Result: there is no value: %s\n", error->what());
            std::abort();
        }
        return std::get_if<0>(&holds_);
    }
    std::variant<Stored, Error> holds_;
};

#if ETENDUE_THROWS
/** What a call that can fail returns: its value; failures are thrown. */
template <class T>
using Outcome = T;
#else
/** What a call that can fail returns: its value or an error. */
template <class T>
using Outcome = Result<T>;
#endif

/** @cond internal */
namespace detail {

/** Ends a call with a failure. */
template <class T>
[[nodiscard]] inline Outcome<T> fail(etd_status status) {
#if ETENDUE_THROWS
    throw Error::last(status);
#else
    return Error::last(status);
#endif
}

/** Ends a call whose arguments do not fit together, before the library has seen them. */
template <class T>
[[nodiscard]] inline Outcome<T> refuse(const char *message) {
#if ETENDUE_THROWS
    throw Error(ETD_INVALID_ARGUMENT, message);
#else
    return Error(ETD_INVALID_ARGUMENT, message);
#endif
}

/** Ends a call that has no value. */
inline Outcome<void> done(etd_status status) {
    if (status != ETD_OK) {
        return fail<void>(status);
    }
    return Outcome<void>();
}

/** Ends a call that has a value if it succeeded. */
template <class T>
[[nodiscard]] inline Outcome<T> give(etd_status status, T &&value) {
    if (status != ETD_OK) {
        return fail<T>(status);
    }
    return Outcome<T>(std::forward<T>(value));
}

/** A text that `copy` writes to a buffer as `etd_scene_copy_text` does. It may grow between two calls, when another thread changes it. */
template <class Copy>
[[nodiscard]] inline Outcome<std::string> copied(const Copy &copy) {
    std::string text;
    std::size_t needed = 0;
    etd_status status = copy(nullptr, 0, &needed);
    while (status == ETD_OK && needed > text.size()) {
        text.resize(needed);
        status = copy(text.data(), text.size(), &needed);
    }
    if (status == ETD_OK) {
        text.resize(needed - 1);
    }
    return give(status, std::move(text));
}

/** Ends a call for which being cancelled or still running is no failure. */
[[nodiscard]] inline Outcome<etd_status> ended(etd_status status) {
    if (status != ETD_OK && status != ETD_CANCELLED && status != ETD_RUNNING) {
        return fail<etd_status>(status);
    }
    return Outcome<etd_status>(status);
}

/** The first exception that functions of the host threw, until the call that waits throws it again. */
class Thrown {
public:
#if ETENDUE_THROWS
    void keep(std::exception_ptr thrown) noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!thrown_) {
            thrown_ = std::move(thrown);
            any_.store(true, std::memory_order_release);
        }
    }
    void rethrow() {
        std::exception_ptr thrown;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            thrown = std::exchange(thrown_, nullptr);
            any_.store(false, std::memory_order_release);
        }
        if (thrown) {
            std::rethrow_exception(thrown);
        }
    }
    bool any() const noexcept { return any_.load(std::memory_order_acquire); }

private:
    std::mutex mutex_;
    std::exception_ptr thrown_;
    std::atomic<bool> any_{false};
#else
    void rethrow() noexcept {}
    bool any() const noexcept { return false; }
#endif
};

/** Calls a function of the host; false if it threw. */
template <class F>
bool guarded([[maybe_unused]] Thrown &thrown, F &&call) noexcept {
#if ETENDUE_THROWS
    try {
        call();
        return true;
    } catch (...) {
        thrown.keep(std::current_exception());
        return false;
    }
#else
    call();
    return true;
#endif
}

} // namespace detail
/** @endcond */

// ---------------------------------------------------------------------------------------------------------------------
// Functions of the host

/**
 * A piece of work for the host's executor: to be called once, on any thread.
 *
 * Copies are of the same piece; only the first call does anything. If all copies go away without a call, the last one
 * runs the work as it goes, so that no render waits for ever.
 */
class Work {
public:
    /** What `etd_submit_fn` was given. */
    Work(etd_work_fn work, void *argument) : once_(std::make_shared<Once>(work, argument)) {}
    /** Runs it. */
    void operator()() const noexcept { once_->run(); }

private:
    struct Once {
        Once(etd_work_fn function, void *with) noexcept : work(function), argument(with) {}
        Once(const Once &) = delete;
        Once &operator=(const Once &) = delete;
        ~Once() { run(); }
        void run() noexcept {
            if (!ran.exchange(true, std::memory_order_acq_rel)) {
                work(argument);
            }
        }
        etd_work_fn work;
        void *argument;
        std::atomic<bool> ran{false};
    };
    std::shared_ptr<Once> once_;
};

/**
 * Told how far work has come; return true to go on and false to cancel. Called as `etd_progress_fn` is.
 */
using Progress = std::function<bool(const etd_progress &progress)>;

/** Told that a task has ended, and how, on the task's thread. */
using Finished = std::function<void(etd_status status)>;

/**
 * The functions of a device. Each may be empty, and then what `etd_device_options` says is called.
 *
 * What one of them throws cancels the device's renders at their next report, and is thrown again by the first call that
 * waits for work of the device.
 */
struct DeviceFunctions {
    /** Told warnings and decisions, on any thread, several at once. */
    std::function<void(etd_log_level level, const char *message)> log = {};
    /** Told every failing call on an object of the device, on the thread of the call. */
    std::function<void(etd_status status, const char *message)> error = {};
    /** Takes pieces of work for the host's own threads and returns without waiting for them. */
    std::function<void(Work work)> submit = {};
};

/** @cond internal */
namespace detail {

/** The functions of a device and what they threw. Everything made with the device keeps it. */
struct DeviceHooks {
    DeviceFunctions functions;
    etd_device_options options;
    Thrown thrown;

    DeviceHooks(DeviceFunctions &&given, const etd_device_options &raw)
        : functions(std::move(given)), options(raw) {}

    static void log(void *user_data, etd_log_level level, const char *message) noexcept {
        auto *self = static_cast<DeviceHooks *>(user_data);
        guarded(self->thrown, [&] {
            if (self->functions.log) {
                self->functions.log(level, message);
            } else if (self->options.log != nullptr) {
                self->options.log(self->options.user_data, level, message);
            }
        });
    }
    static void error(void *user_data, etd_status status, const char *message) noexcept {
        auto *self = static_cast<DeviceHooks *>(user_data);
        guarded(self->thrown, [&] {
            if (self->functions.error) {
                self->functions.error(status, message);
            } else if (self->options.error != nullptr) {
                self->options.error(self->options.user_data, status, message);
            }
        });
    }
    static void submit(void *user_data, etd_work_fn work, void *argument) noexcept {
        auto *self = static_cast<DeviceHooks *>(user_data);
        if (!self->functions.submit) {
            self->options.submit(self->options.user_data, work, argument);
            return;
        }
        guarded(self->thrown, [&] { self->functions.submit(Work(work, argument)); });
    }
};

using Keep = std::shared_ptr<DeviceHooks>;

/** Progress of one piece of work. */
struct ProgressHooks {
    Progress progress;
    etd_progress_fn raw;
    void *raw_data;
    Keep device;
    Thrown thrown;

    ProgressHooks(Progress &&function, etd_progress_fn raw_function, void *data, Keep keep)
        : progress(std::move(function)), raw(raw_function), raw_data(data), device(std::move(keep)) {}

    static std::int32_t tell(void *user_data, const etd_progress *report) noexcept {
        auto *self = static_cast<ProgressHooks *>(user_data);
        bool goes_on = true;
        const bool returned = guarded(self->thrown, [&] {
            if (self->progress) {
                goes_on = self->progress(*report);
            } else if (self->raw != nullptr) {
                goes_on = self->raw(self->raw_data, report) == 0;
            }
        });
        const bool others = self->device && self->device->thrown.any();
        return returned && goes_on && !others ? 0 : 1;
    }
    void rethrow() {
        thrown.rethrow();
        if (device) {
            device->thrown.rethrow();
        }
    }
};

/** The functions of a task: held by the task's owner, and by every run until it has told its end. */
struct TaskHooks : ProgressHooks {
    Finished finished;
    etd_finished_fn raw_finished;
    std::atomic<unsigned> holders{1};

    TaskHooks(Progress &&progress_function, Finished &&finished_function, const etd_render_options &options, Keep keep)
        : ProgressHooks(std::move(progress_function), options.progress, options.user_data, std::move(keep)),
          finished(std::move(finished_function)), raw_finished(options.finished) {}

    static void end(void *user_data, etd_status status) noexcept {
        auto *self = static_cast<TaskHooks *>(static_cast<ProgressHooks *>(user_data));
        guarded(self->thrown, [&] {
            if (self->finished) {
                self->finished(status);
            } else if (self->raw_finished != nullptr) {
                self->raw_finished(self->raw_data, status);
            }
        });
        drop(self);
    }
    void hold() noexcept { holders.fetch_add(1, std::memory_order_relaxed); }
    static void drop(TaskHooks *self) noexcept {
        if (self->holders.fetch_sub(1, std::memory_order_acq_rel) == 1) {
            delete self;
        }
    }
};

struct DropTaskHooks {
    void operator()(TaskHooks *hooks) const noexcept { TaskHooks::drop(hooks); }
};

/** One reference to an object of the library, and the device's functions, which go after it. */
template <class T, etd_status (*Retain)(T *), void (*Release)(T *)>
class Owner {
public:
    Owner(const Owner &) = delete;
    Owner &operator=(const Owner &) = delete;
    Owner(Owner &&other) noexcept
        : keep_(std::move(other.keep_)), handle_(std::exchange(other.handle_, nullptr)) {}
    Owner &operator=(Owner &&other) noexcept {
        Owner taken(std::move(other));
        std::swap(keep_, taken.keep_);
        std::swap(handle_, taken.handle_);
        return *this;
    }

    /** The C handle, which stays this owner's; NULL after it was moved from. */
    T *get() const noexcept { return handle_; }
    /** Whether it owns anything. */
    explicit operator bool() const noexcept { return handle_ != nullptr; }

protected:
    Owner(Keep keep, T *handle) noexcept : keep_(std::move(keep)), handle_(handle) {}
    ~Owner() { reset(); }
    void reset() noexcept {
        Release(std::exchange(handle_, nullptr));
        keep_.reset();
    }
    etd_status retain() const noexcept { return Retain(handle_); }
    const Keep &keep() const noexcept { return keep_; }

private:
    Keep keep_;
    T *handle_;
};

/** The first failure of a call on an object, if there was one. */
template <class T>
std::optional<Error> first_failure(etd_status (*ask)(T *, char *, std::size_t), T *object) {
    std::array<char, 1024> message{};
    const etd_status status = ask(object, message.data(), message.size());
    if (status == ETD_OK) {
        return std::nullopt;
    }
    return Error(status, message.data());
}

} // namespace detail
/** @endcond */

// ---------------------------------------------------------------------------------------------------------------------
// Objects

class Film;
class Task;
class Atlas;

/** Bytes that hierarchies and films of a device take. */
struct Memory {
    /** Now. */
    std::uint64_t used = 0;
    /** The most it ever was. */
    std::uint64_t peak = 0;
};

/** Threads, a memory limit, and the functions that messages go to. */
class Device : public detail::Owner<etd_device, etd_device_retain, etd_device_release> {
public:
    /** Makes a device and starts its threads. */
    static Outcome<Device> create(const etd_device_options &options = device_options(),
                                  DeviceFunctions functions = {}) {
        auto hooks = std::make_shared<detail::DeviceHooks>(std::move(functions), options);
        etd_device_options raw = options;
        raw.log = detail::DeviceHooks::log;
        raw.error = detail::DeviceHooks::error;
        raw.submit = hooks->functions.submit || options.submit != nullptr ? detail::DeviceHooks::submit : nullptr;
        raw.user_data = hooks.get();
        etd_device *device = nullptr;
        const etd_status status = etd_device_new(&raw, &device);
        return detail::give(status, Device(std::move(hooks), device));
    }
    /** A second owner of the same device. */
    Outcome<Device> share() const {
        const etd_status status = retain();
        return detail::give(status, Device(keep(), status == ETD_OK ? get() : nullptr));
    }
    /** What hierarchies and films take. */
    Outcome<Memory> memory() const {
        Memory memory;
        const etd_status status = etd_device_memory(get(), &memory.used, &memory.peak);
        return detail::give(status, std::move(memory));
    }
    /** Its threads, and what it runs on. */
    Outcome<etd_device_info> info() const {
        etd_device_info info = ETD_DEVICE_INFO_INIT;
        const etd_status status = etd_device_get_info(get(), &info);
        return detail::give(status, std::move(info));
    }
    /** The first failure of a call on this device since this was last asked. */
    std::optional<Error> first_failure() const { return detail::first_failure(etd_device_status, get()); }

private:
    friend class Scene;
    friend class Film;
    using Owner::Owner;
};

/** What a point light is. */
struct PointLight {
    /** Where it is, world frame. */
    Vec3 position = {};
    /** Radiant intensity [W sr^-1]. */
    Rgb intensity = {};
};

/** The complex index of refraction of a metal, per channel. */
struct Metal {
    /** Index of refraction. */
    Rgb eta = {};
    /** Extinction coefficient. */
    Rgb k = {};
};

/** The index of a measured metal by its symbol, such as "Au". */
inline Outcome<Metal> metal(const char *symbol) {
    Metal value;
    const etd_status status = etd_metal(symbol, value.eta.data(), value.k.data());
    return detail::give(status, std::move(value));
}

/** A conductor of this index and perceptual roughness. */
inline etd_material material(const Metal &metal, float roughness = 0) noexcept {
    etd_material value = material(ETD_BSDF_CONDUCTOR);
    for (std::size_t i = 0; i < 3; ++i) {
        value.eta[i] = metal.eta[i];
        value.k[i] = metal.k[i];
    }
    value.roughness = roughness;
    return value;
}

/** A width and a height in pixels. */
struct Resolution {
    /** Pixels in a row. */
    std::uint32_t width = 0;
    /** Rows. */
    std::uint32_t height = 0;
};

/** A scene: what the host describes, and what was built of it. */
class Scene : public detail::Owner<etd_scene, etd_scene_retain, etd_scene_release> {
public:
    /** An empty scene. */
    static Outcome<Scene> create(const Device &device, const etd_scene_options &options = scene_options()) {
        etd_scene *scene = nullptr;
        const etd_status status = etd_scene_new(device.get(), &options, &scene);
        return detail::give(status, Scene(device.keep(), scene));
    }
    /** A scene from text. */
    static Outcome<Scene> from_json(const Device &device, std::string_view json,
                                    const etd_scene_options &options = scene_options()) {
        etd_scene *scene = nullptr;
        // An empty view may have no address, which the library takes for a forgotten argument.
        const char *text = json.empty() ? "" : json.data();
        const etd_status status = etd_scene_from_json(device.get(), text, json.size(), &options, &scene);
        return detail::give(status, Scene(device.keep(), scene));
    }
    /** A scene from a file. */
    static Outcome<Scene> from_file(const Device &device, const std::string &path,
                                    const etd_scene_options &options = scene_options()) {
        etd_scene *scene = nullptr;
        const etd_status status = etd_scene_from_file(device.get(), path.c_str(), &options, &scene);
        return detail::give(status, Scene(device.keep(), scene));
    }
    /** A second owner of the same scene. */
    Outcome<Scene> share() const {
        const etd_status status = retain();
        return detail::give(status, Scene(keep(), status == ETD_OK ? get() : nullptr));
    }
    /** The first failure of a call on this scene since this was last asked. */
    std::optional<Error> first_failure() const { return detail::first_failure(etd_scene_status, get()); }

    /** Builds what was described since the last time; `ETD_OK` or `ETD_CANCELLED`. */
    Outcome<etd_status> commit(Progress progress = {}) {
        detail::ProgressHooks hooks(std::move(progress), nullptr, nullptr, keep());
        const etd_status status = etd_scene_commit(get(), detail::ProgressHooks::tell, &hooks);
        hooks.rethrow();
        return detail::ended(status);
    }
    /** What was built: counts, memory, extent. */
    Outcome<etd_scene_info> info() const {
        etd_scene_info info = ETD_SCENE_INFO_INIT;
        const etd_status status = etd_scene_get_info(get(), &info);
        return detail::give(status, std::move(info));
    }
    /** A text about the scene. */
    Outcome<std::string> text(etd_text which) const {
        return detail::copied([&](char *buffer, std::size_t capacity, std::size_t *needed) {
            return etd_scene_copy_text(get(), which, buffer, capacity, needed);
        });
    }
    /** The settings that the scene itself asks for. */
    Outcome<etd_render_options> render_options() const {
        etd_render_options options = ETD_RENDER_OPTIONS_INIT;
        const etd_status status = etd_scene_get_render_options(get(), &options);
        return detail::give(status, std::move(options));
    }
    /** The resolution that the scene itself asks for. */
    Outcome<Resolution> resolution() const {
        Resolution resolution;
        const etd_status status = etd_scene_get_resolution(get(), &resolution.width, &resolution.height);
        return detail::give(status, std::move(resolution));
    }

    /** Replaces the camera. */
    Outcome<void> set_camera(const etd_camera &value) { return detail::done(etd_scene_set_camera(get(), &value)); }
    /** The camera as it is described now. */
    Outcome<etd_camera> camera() const {
        etd_camera value = ETD_CAMERA_INIT;
        const etd_status status = etd_scene_get_camera(get(), &value);
        return detail::give(status, std::move(value));
    }

    /** Adds a material; its number. `name`: NULL for none. */
    Outcome<std::uint32_t> add_material(const etd_material &value, const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_material(get(), name, &value, &number);
        return detail::give(status, std::move(number));
    }
    /** Replaces a material. */
    Outcome<void> set_material(std::uint32_t number, const etd_material &value) {
        return detail::done(etd_scene_set_material(get(), number, &value));
    }
    /** The parameters of a principled material as it is described now. */
    Outcome<etd_principled> principled(std::uint32_t number) const {
        etd_principled value = ETD_PRINCIPLED_INIT;
        const etd_status status = etd_scene_get_principled(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** A material as it is described now; without the parameters of a principled one, which `principled` returns. */
    Outcome<etd_material> material(std::uint32_t number) const {
        etd_material value = ETD_MATERIAL_INIT;
        const etd_status status = etd_scene_get_material(get(), number, &value);
        return detail::give(status, std::move(value));
    }

    /** Adds a point light; its number. */
    Outcome<std::uint32_t> add_point_light(const PointLight &light) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_point_light(get(), light.position.data(), light.intensity.data(), &number);
        return detail::give(status, std::move(number));
    }
    /** Moves and recolours a point light, which keeps its cone or web if it has one. */
    Outcome<void> set_point_light(std::uint32_t number, const PointLight &light) {
        return detail::done(
            etd_scene_set_point_light(get(), number, light.position.data(), light.intensity.data()));
    }
    /** A point light as it is described now. */
    Outcome<PointLight> point_light(std::uint32_t number) const {
        PointLight light;
        const etd_status status =
            etd_scene_get_point_light(get(), number, light.position.data(), light.intensity.data());
        return detail::give(status, std::move(light));
    }

    /** Sets when the shutter is open. */
    Outcome<void> set_shutter(const etd_shutter &value) { return detail::done(etd_scene_set_shutter(get(), &value)); }
    /** When the shutter is open as described now, without the numbers of its curve. */
    Outcome<etd_shutter> shutter() const {
        etd_shutter value = ETD_SHUTTER_INIT;
        const etd_status status = etd_scene_get_shutter(get(), &value);
        return detail::give(status, std::move(value));
    }
    /** Sets the keyframes of the camera; none: it rests. */
    Outcome<void> set_camera_motion(const etd_motion_key *keys, std::size_t count) {
        return detail::done(etd_scene_set_camera_motion(get(), keys, count));
    }
    /** Sets the keyframes of a surface; none: it rests. */
    Outcome<void> set_surface_motion(std::uint32_t surface, const etd_motion_key *keys, std::size_t count) {
        return detail::done(etd_scene_set_surface_motion(get(), surface, keys, count));
    }
    /** Sets the keyframes of a point light; none: it rests. */
    Outcome<void> set_light_motion(std::uint32_t light, const etd_motion_key *keys, std::size_t count) {
        return detail::done(etd_scene_set_light_motion(get(), light, keys, count));
    }
    /** Sets the vertices of a mesh at some moments, as `etd_scene_set_mesh_steps` takes them. */
    Outcome<void> set_mesh_steps(std::uint32_t mesh, const double *times, std::size_t count, const double *positions,
                                 const float *normals = nullptr) {
        return detail::done(etd_scene_set_mesh_steps(get(), mesh, times, count, positions, normals));
    }

    /** Adds a spot light; its number among the point lights. */
    Outcome<std::uint32_t> add_spot_light(const etd_spot_light &spot) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_spot_light(get(), &spot, &number);
        return detail::give(status, std::move(number));
    }
    /** Makes a point light of any kind a spot light. */
    Outcome<void> set_spot_light(std::uint32_t number, const etd_spot_light &spot) {
        return detail::done(etd_scene_set_spot_light(get(), number, &spot));
    }
    /** A spot light as it is described now. */
    Outcome<etd_spot_light> spot_light(std::uint32_t number) const {
        etd_spot_light spot = ETD_SPOT_LIGHT_INIT;
        const etd_status status = etd_scene_get_spot_light(get(), number, &spot);
        return detail::give(status, std::move(spot));
    }

    /** Adds a measured lamp; its number among the point lights. */
    Outcome<std::uint32_t> add_web_light(const etd_web_light &web) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_web_light(get(), &web, &number);
        return detail::give(status, std::move(number));
    }
    /** Makes a point light of any kind a measured lamp; without a file and a text, one keeps its intensities. */
    Outcome<void> set_web_light(std::uint32_t number, const etd_web_light &web) {
        return detail::done(etd_scene_set_web_light(get(), number, &web));
    }
    /** How a measured lamp is turned now. */
    Outcome<etd_web_light> web_light(std::uint32_t number) const {
        etd_web_light web = ETD_WEB_LIGHT_INIT;
        const etd_status status = etd_scene_get_web_light(get(), number, &web);
        return detail::give(status, std::move(web));
    }

    /** Sets the light from infinity: radiance, the same from all directions. */
    Outcome<void> set_environment(const Rgb &radiance) {
        return detail::done(etd_scene_set_environment(get(), radiance.data()));
    }
    /** Sets the light from infinity by a texture, or the same from all directions for a texture of ETD_NONE. */
    Outcome<void> set_environment_map(const etd_environment_map &map) {
        return detail::done(etd_scene_set_environment_map(get(), &map));
    }
    /** The light from infinity as it is described now; its radiance is 0 where there is none. */
    Outcome<etd_environment_map> environment_map() const {
        etd_environment_map map = ETD_ENVIRONMENT_MAP_INIT;
        const etd_status status = etd_scene_get_environment_map(get(), &map);
        return detail::give(status, std::move(map));
    }
    /** Sets `count` openings, of four corners each, through which light from infinity comes into rooms. */
    Outcome<void> set_portals(const double *corners, std::size_t count) {
        return detail::done(etd_scene_set_portals(get(), corners, count));
    }
    /** Sets the picture that the camera sees behind everything, and which lights nothing. */
    Outcome<void> set_backplate(const etd_backplate &backplate) {
        return detail::done(etd_scene_set_backplate(get(), &backplate));
    }
    /** Removes the picture behind everything. */
    Outcome<void> remove_backplate() { return detail::done(etd_scene_set_backplate(get(), nullptr)); }
    /** The picture behind everything as it is described now; its radiance is 0 where there is none. */
    Outcome<etd_backplate> backplate() const {
        etd_backplate value = ETD_BACKPLATE_INIT;
        const etd_status status = etd_scene_get_backplate(get(), &value);
        return detail::give(status, std::move(value));
    }
    /** Sets the light from infinity to a sky by a formula. */
    Outcome<void> set_sky(const etd_sky &sky) { return detail::done(etd_scene_set_sky(get(), &sky)); }
    /** The sky by a formula as it is described now; its radiance is 0 where there is none. */
    Outcome<etd_sky> sky() const {
        etd_sky value = ETD_SKY_INIT;
        const etd_status status = etd_scene_get_sky(get(), &value);
        return detail::give(status, std::move(value));
    }
    /** Adds light from one direction of infinity, such as that of the sun; its number among such lights. */
    Outcome<std::uint32_t> add_distant_light(const etd_distant_light &light) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_distant_light(get(), &light, &number);
        return detail::give(status, std::move(number));
    }
    /** Changes light from one direction. */
    Outcome<void> set_distant_light(std::uint32_t number, const etd_distant_light &light) {
        return detail::done(etd_scene_set_distant_light(get(), number, &light));
    }
    /** Light from one direction as it is described now. */
    Outcome<etd_distant_light> distant_light(std::uint32_t number) const {
        etd_distant_light value = ETD_DISTANT_LIGHT_INIT;
        const etd_status status = etd_scene_get_distant_light(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** Removes the light from infinity all around. */
    Outcome<void> remove_environment() { return detail::done(etd_scene_set_environment(get(), nullptr)); }
    /** The radiance from infinity as it is described now; 0 where there is none. */
    Outcome<Rgb> environment() const {
        Rgb radiance = {};
        const etd_status status = etd_scene_get_environment(get(), radiance.data());
        return detail::give(status, std::move(radiance));
    }

    /** Adds a sphere; its number as a surface, as from all that add a surface. */
    Outcome<std::uint32_t> add_sphere(const Vec3 &centre, double radius, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_sphere(get(), centre.data(), radius, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a triangle. */
    Outcome<std::uint32_t> add_triangle(const std::array<double, 9> &vertices, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_triangle(get(), vertices.data(), &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a flat convex quadrilateral. */
    Outcome<std::uint32_t> add_quad(const std::array<double, 12> &vertices, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_quad(get(), vertices.data(), &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a flat round disk. */
    Outcome<std::uint32_t> add_disk(const Vec3 &centre, const Vec3 &normal, double radius,
                                    const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_disk(get(), centre.data(), normal.data(), radius, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a tube without caps. */
    Outcome<std::uint32_t> add_cylinder(const Vec3 &base, const Vec3 &axis, double radius, double height,
                                        const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_cylinder(get(), base.data(), axis.data(), radius, height, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a cone without its base disk. */
    Outcome<std::uint32_t> add_cone(const Vec3 &base, const Vec3 &axis, double radius, double height,
                                    const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_cone(get(), base.data(), axis.data(), radius, height, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a paraboloid of revolution, open at its wide end. */
    Outcome<std::uint32_t> add_paraboloid(const Vec3 &apex, const Vec3 &axis, double radius, double height,
                                          const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_paraboloid(get(), apex.data(), axis.data(), radius, height, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds an ellipsoid with its axes along x, y and z. */
    Outcome<std::uint32_t> add_ellipsoid(const Vec3 &centre, const Vec3 &radii, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_ellipsoid(get(), centre.data(), radii.data(), &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a quadric that ends by itself: an ellipsoid. */
    Outcome<std::uint32_t> add_quadric(const std::array<double, 10> &coefficients, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status =
            etd_scene_add_quadric(get(), coefficients.data(), nullptr, nullptr, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds what of a quadric lies inside a box. */
    Outcome<std::uint32_t> add_quadric(const std::array<double, 10> &coefficients, const Vec3 &clip_min,
                                       const Vec3 &clip_max, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_quadric(get(), coefficients.data(), clip_min.data(), clip_max.data(),
                                                        &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a use of a mesh. `smooth`: whether vertex normals are interpolated. */
    Outcome<std::uint32_t> add_mesh_surface(std::uint32_t mesh, bool smooth, const etd_surface &surface) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_mesh_surface(get(), mesh, smooth ? 1 : 0, &surface, &number);
        return detail::give(status, std::move(number));
    }
    /** Removes a surface. */
    Outcome<void> remove_surface(std::uint32_t number) {
        return detail::done(etd_scene_remove_surface(get(), number));
    }
    /** Places a surface. */
    Outcome<void> set_transform(std::uint32_t number, const Transform &transform) {
        return detail::done(etd_scene_set_transform(get(), number, transform.data()));
    }
    /** Gives a surface another material. */
    Outcome<void> set_surface_material(std::uint32_t number, std::uint32_t material) {
        return detail::done(etd_scene_set_surface_material(get(), number, material));
    }
    /** Changes what a surface emits [W m^-2 sr^-1]. */
    Outcome<void> set_emission(std::uint32_t number, const Rgb &radiance) {
        return detail::done(etd_scene_set_emission(get(), number, radiance.data()));
    }
    /** Sets whether a surface that emits does so on both of its sides. */
    Outcome<void> set_emits_both(std::uint32_t number, bool both) {
        return detail::done(etd_scene_set_emits_both(get(), number, both ? 1 : 0));
    }
    /** Names the object that a surface is, or is a part of, in mattes; an empty text takes the name away. */
    Outcome<void> set_surface_name(std::uint32_t number, const std::string &name) {
        return detail::done(etd_scene_set_surface_name(get(), number, name.c_str()));
    }
    /** The name of a surface; empty where it has none. */
    Outcome<std::string> surface_name(std::uint32_t number) const {
        return detail::copied([&](char *buffer, std::size_t capacity, std::size_t *needed) {
            return etd_scene_get_surface_name(get(), number, buffer, capacity, needed);
        });
    }
    /** Lets a flat surface shine by a photometric web; its emission is a factor on it then. */
    Outcome<void> set_surface_web(std::uint32_t number, const etd_surface_web &web) {
        return detail::done(etd_scene_set_surface_web(get(), number, &web));
    }
    /** Lets a surface shine evenly again. */
    Outcome<void> clear_surface_web(std::uint32_t number) {
        return detail::done(etd_scene_set_surface_web(get(), number, nullptr));
    }
    /** How the photometric web of a surface is turned, without its intensities. */
    Outcome<etd_surface_web> surface_web(std::uint32_t number) const {
        etd_surface_web web = ETD_SURFACE_WEB_INIT;
        const etd_status status = etd_scene_get_surface_web(get(), number, &web);
        return detail::give(status, std::move(web));
    }
    /** Gives a light, an emission or a parameter of a material a spectrum of its own. */
    Outcome<void> set_spectrum(etd_spectrum_target target, std::uint32_t number, const etd_spectrum &spectrum) {
        return detail::done(etd_scene_set_spectrum(get(), target, number, &spectrum));
    }
    /** Takes the spectrum away, which leaves its colour. */
    Outcome<void> clear_spectrum(etd_spectrum_target target, std::uint32_t number) {
        return detail::done(etd_scene_set_spectrum(get(), target, number, nullptr));
    }
    /** The spectrum of a light, an emission or a parameter of a material, without its samples. */
    Outcome<etd_spectrum> spectrum(etd_spectrum_target target, std::uint32_t number) const {
        etd_spectrum value = ETD_SPECTRUM_INIT;
        const etd_status status = etd_scene_get_spectrum(get(), target, number, &value);
        return detail::give(status, std::move(value));
    }
    /** Material, emission and transform of a surface as they are described now. */
    Outcome<etd_surface> surface(std::uint32_t number) const {
        etd_surface value = ETD_SURFACE_INIT;
        const etd_status status = etd_scene_get_surface(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** What a surface is, as it is described now. */
    Outcome<etd_shape> shape(std::uint32_t number) const {
        etd_shape value = ETD_SHAPE_INIT;
        const etd_status status = etd_scene_get_shape(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** What a mesh has, as it is described now. */
    Outcome<etd_mesh_info> mesh_info(std::uint32_t number) const {
        etd_mesh_info value = ETD_MESH_INFO_INIT;
        const etd_status status = etd_scene_get_mesh(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** Copies arrays of a mesh. Empty spans are left out; `ETD_INVALID_ARGUMENT` for one that is not as long as the mesh's. */
    Outcome<void> copy_mesh(std::uint32_t number, span<double> positions, span<float> normals, span<float> uvs,
                            span<std::uint32_t> indices) const {
        etd_mesh_info info = ETD_MESH_INFO_INIT;
        const etd_status status = etd_scene_get_mesh(get(), number, &info);
        if (status != ETD_OK) {
            return detail::done(status);
        }
        const auto fits = [](std::size_t given, std::size_t needed) { return given == 0 || given == needed; };
        if (!fits(positions.size(), 3 * info.vertex_count) || !fits(normals.size(), 3 * info.vertex_count) ||
            !fits(uvs.size(), 2 * info.vertex_count) || !fits(indices.size(), 3 * info.triangle_count)) {
            return detail::refuse<void>("an array is not as long as the mesh's");
        }
        const auto pointer = [](auto &values) { return values.size() == 0 ? nullptr : values.data(); };
        return detail::done(etd_scene_copy_mesh(get(), number, info.vertex_count, info.triangle_count, pointer(positions),
                                                pointer(normals), pointer(uvs), pointer(indices)));
    }
    /** The number of the material of this name. */
    Outcome<std::uint32_t> find_material(const char *name) const {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_find_material(get(), name, &number);
        return detail::give(status, std::move(number));
    }
    /** The number of the mesh of this name. */
    Outcome<std::uint32_t> find_mesh(const char *name) const {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_find_mesh(get(), name, &number);
        return detail::give(status, std::move(number));
    }
    /** The number of the surface with this JSON path. */
    Outcome<std::uint32_t> find_surface(const char *json_path) const {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_find_surface(get(), json_path, &number);
        return detail::give(status, std::move(number));
    }

    /** A group that is placed, as it is described now. */
    struct Placement {
        /** The number of the group. */
        std::uint32_t group = ETD_NONE;
        /** The number of the first of its surfaces, which follow one another. */
        std::uint32_t first_surface = ETD_NONE;
        /** How many surfaces it has. */
        std::uint32_t surface_count = 0;
        /** From the group's frame to the world. */
        Transform transform{};
    };

    /** Makes a group of copies of surfaces; its number. `name`: NULL for none. */
    Outcome<std::uint32_t> add_group(const std::vector<std::uint32_t> &surfaces, const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_group(get(), name, surfaces.data(), surfaces.size(), &number);
        return detail::give(status, std::move(number));
    }
    /** Places a group; the number of the placement, of which `placement` says more. */
    Outcome<std::uint32_t> place_group(std::uint32_t group, const Transform &transform) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_place_group(get(), group, transform.data(), &number, nullptr);
        return detail::give(status, std::move(number));
    }
    /** What a placement is as described now. */
    Outcome<Placement> placement(std::uint32_t number) const {
        Placement it;
        const etd_status status = etd_scene_get_placement(get(), number, &it.group, &it.first_surface, &it.surface_count,
                                                          it.transform.data());
        return detail::give(status, std::move(it));
    }
    /** Moves a placement as a whole. */
    Outcome<void> set_placement_transform(std::uint32_t number, const Transform &transform) {
        return detail::done(etd_scene_set_placement_transform(get(), number, transform.data()));
    }
    /** Sets the keyframes of a placement; none: it rests. */
    Outcome<void> set_placement_motion(std::uint32_t number, const etd_motion_key *keys, std::size_t count) {
        return detail::done(etd_scene_set_placement_motion(get(), number, keys, count));
    }
    /** Removes a placement with its surfaces. */
    Outcome<void> remove_placement(std::uint32_t number) {
        return detail::done(etd_scene_remove_placement(get(), number));
    }
    /** Removes a group that is not placed. */
    Outcome<void> remove_group(std::uint32_t number) { return detail::done(etd_scene_remove_group(get(), number)); }
    /** The number of the group of this name. */
    Outcome<std::uint32_t> find_group(const char *name) const {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_find_group(get(), name, &number);
        return detail::give(status, std::move(number));
    }

    /** Adds a mesh; its number. */
    Outcome<std::uint32_t> add_mesh(const etd_mesh &mesh) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_mesh(get(), &mesh, &number);
        return detail::give(status, std::move(number));
    }
    /**
     * Adds a mesh whose arrays are read in place; `owner` is kept until they are no longer read, and let go on any
     * thread. What letting it go does must make no calls of this library, and not throw.
     */
    Outcome<std::uint32_t> add_mesh(const etd_mesh &mesh, std::shared_ptr<const void> owner) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = with_owner(mesh, std::move(owner), [&](const etd_mesh *shared) {
            return etd_scene_add_mesh(get(), shared, &number);
        });
        return detail::give(status, std::move(number));
    }
    /** Adds a mesh from a Wavefront OBJ, PLY or STL file; its number. `name`: NULL for none. */
    Outcome<std::uint32_t> add_mesh_file(const std::string &path, const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_mesh_file(get(), name, path.c_str(), &number);
        return detail::give(status, std::move(number));
    }
    /**
     * The same with `progress`, which says how far the reading is and may cancel it: an error of `ETD_CANCELLED`, after which the scene is
     * as it was.
     */
    Outcome<std::uint32_t> add_mesh_file(const std::string &path, const char *name, Progress progress) {
        std::uint32_t number = ETD_NONE;
        detail::ProgressHooks hooks(std::move(progress), nullptr, nullptr, keep());
        const etd_status status = etd_scene_add_mesh_file_with_progress(get(), name, path.c_str(),
                                                                        detail::ProgressHooks::tell, &hooks, &number);
        hooks.rethrow();
        return detail::give(status, std::move(number));
    }
    /** Adds a mesh that another scene has, without a copy of its arrays; its number here. `name`: NULL for none. */
    Outcome<std::uint32_t> add_mesh_from(const Scene &source, std::uint32_t mesh, const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_mesh_from(get(), name, source.get(), mesh, &number);
        return detail::give(status, std::move(number));
    }
    /**
     * Adds the surfaces of a Wavefront OBJ file with the file's own materials; the number of the first surface, and how many there
     * are.
     */
    Outcome<std::pair<std::uint32_t, std::uint32_t>> add_file_surfaces(const std::string &path, bool smooth = false) {
        std::pair<std::uint32_t, std::uint32_t> numbers{ETD_NONE, 0};
        const etd_status status =
            etd_scene_add_file_surfaces(get(), path.c_str(), smooth ? 1 : 0, nullptr, &numbers.first, &numbers.second);
        return detail::give(status, std::move(numbers));
    }
    /** Replaces a mesh by other arrays. */
    Outcome<void> set_mesh(std::uint32_t number, const etd_mesh &mesh) {
        return detail::done(etd_scene_set_mesh(get(), number, &mesh));
    }
    /** Replaces a mesh by other arrays, which are read in place; see `add_mesh`. */
    Outcome<void> set_mesh(std::uint32_t number, const etd_mesh &mesh, std::shared_ptr<const void> owner) {
        return detail::done(with_owner(mesh, std::move(owner), [&](const etd_mesh *shared) {
            return etd_scene_set_mesh(get(), number, shared);
        }));
    }
    /** Removes a mesh that no surface and no group uses any more. */
    Outcome<void> remove_mesh(std::uint32_t number) { return detail::done(etd_scene_remove_mesh(get(), number)); }

    /** Adds a texture; its number. `name`: NULL for none. */
    Outcome<std::uint32_t> add_texture(const etd_texture &texture, const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_add_texture(get(), name, &texture, &number);
        return detail::give(status, std::move(number));
    }
    /** Adds a texture whose texels are read in place; `owner` as in `add_mesh`. */
    Outcome<std::uint32_t> add_texture(const etd_texture &texture, std::shared_ptr<const void> owner,
                                       const char *name = nullptr) {
        std::uint32_t number = ETD_NONE;
        const etd_status status = with_owner(texture, std::move(owner), [&](const etd_texture *shared) {
            return etd_scene_add_texture(get(), name, shared, &number);
        });
        return detail::give(status, std::move(number));
    }
    /** Replaces a texture. */
    Outcome<void> set_texture(std::uint32_t number, const etd_texture &texture) {
        return detail::done(etd_scene_set_texture(get(), number, &texture));
    }
    /** Replaces a texture by texels that are read in place; see `add_texture`. */
    Outcome<void> set_texture(std::uint32_t number, const etd_texture &texture, std::shared_ptr<const void> owner) {
        return detail::done(with_owner(texture, std::move(owner), [&](const etd_texture *shared) {
            return etd_scene_set_texture(get(), number, shared);
        }));
    }
    /** Takes note that shared texels were changed. */
    Outcome<void> update_texture(std::uint32_t number) {
        return detail::done(etd_scene_update_texture(get(), number));
    }
    /** A texture as it is described now, without its texels. */
    Outcome<etd_texture> texture(std::uint32_t number) const {
        etd_texture value = ETD_TEXTURE_INIT;
        const etd_status status = etd_scene_get_texture(get(), number, &value);
        return detail::give(status, std::move(value));
    }
    /** The number of the texture of this name. */
    Outcome<std::uint32_t> find_texture(const char *name) const {
        std::uint32_t number = ETD_NONE;
        const etd_status status = etd_scene_find_texture(get(), name, &number);
        return detail::give(status, std::move(number));
    }
    /** Sets the texture of a parameter of a material, which is called as in scene files. */
    Outcome<void> set_material_texture(std::uint32_t material, const char *parameter,
                                       const etd_texture_binding &binding) {
        return detail::done(etd_scene_set_material_texture(get(), material, parameter, &binding));
    }
    /** The same for all of a texture. */
    Outcome<void> set_material_texture(std::uint32_t material, const char *parameter, std::uint32_t texture) {
        etd_texture_binding binding = ETD_TEXTURE_BINDING_INIT;
        binding.texture = texture;
        return set_material_texture(material, parameter, binding);
    }
    /** The texture of a parameter of a material. */
    Outcome<etd_texture_binding> material_texture(std::uint32_t material, const char *parameter) const {
        etd_texture_binding value = ETD_TEXTURE_BINDING_INIT;
        const etd_status status = etd_scene_get_material_texture(get(), material, parameter, &value);
        return detail::give(status, std::move(value));
    }

    /** Finds what each ray meets first. There are as many hits as rays; `ETD_INVALID_ARGUMENT` if not. */
    Outcome<void> intersect(span<const etd_ray> rays, span<etd_hit> hits) const {
        if (hits.size() != rays.size()) {
            return detail::refuse<void>("hits and rays are not of the same number");
        }
        return detail::done(etd_scene_intersect(get(), rays.data(), rays.size(), hits.data()));
    }
    /** Finds what a ray meets first. */
    Outcome<etd_hit> intersect(const etd_ray &ray) const {
        etd_hit hit{};
        const etd_status status = etd_scene_intersect(get(), &ray, 1, &hit);
        return detail::give(status, std::move(hit));
    }
    /** Makes the camera's rays through the middles of the pixels of a film, row by row from the top. There are width * height rays;
     *  `ETD_INVALID_ARGUMENT` if not. */
    Outcome<void> camera_rays(std::uint32_t width, std::uint32_t height, span<etd_ray> rays) const {
        if (rays.size() != static_cast<std::size_t>(width) * height) {
            return detail::refuse<void>("rays and pixels are not of the same number");
        }
        return detail::done(etd_scene_camera_rays(get(), width, height, nullptr, rays.data()));
    }
    /** Finds for each ray whether anything is in its segment (1) or not (0). There are as many answers as rays;
     *  `ETD_INVALID_ARGUMENT` if not. */
    Outcome<void> occluded(span<const etd_ray> rays, span<std::uint8_t> answers) const {
        if (answers.size() != rays.size()) {
            return detail::refuse<void>("answers and rays are not of the same number");
        }
        return detail::done(etd_scene_occluded(get(), rays.data(), rays.size(), answers.data()));
    }
    /** Traces the rays of a query and writes what it wants of their hits. */
    Outcome<void> query(const etd_ray_query &query) const { return detail::done(etd_scene_query(get(), &query)); }
    /** Whether anything is in a ray's segment. */
    Outcome<bool> occluded(const etd_ray &ray) const {
        std::uint8_t answer = 0;
        const etd_status status = etd_scene_occluded(get(), &ray, 1, &answer);
        return detail::give(status, answer != 0);
    }

private:
    friend class Film;
    friend class Task;
    friend class Atlas;
    friend Outcome<etd_status> render(Scene &scene, Film &film, const etd_render_options *options, Progress progress);
    friend Outcome<etd_status> measure(Scene &scene, etd_quantity quantity, span<const etd_measuring_point> points,
                                       const etd_render_options &options, span<double> values,
                                       span<double> standard_errors, Progress progress, etd_summary *summary);
    friend Outcome<etd_status> trace_mattes(Scene &scene, std::uint32_t width, std::uint32_t height,
                                            const etd_render_options &options, etd_matte_kind kind,
                                            std::uint32_t levels, span<std::uint32_t> ids, span<float> coverages,
                                            Progress progress);
    friend Outcome<etd_status> bake_vertices(Scene &scene, std::uint32_t surface, const etd_bake_target &target,
                                             const etd_render_options &options, Progress progress,
                                             etd_summary *summary);
    using Owner::Owner;

    static void let_go(void *owner) noexcept { delete static_cast<std::shared_ptr<const void> *>(owner); }

    /** `T`: etd_mesh or etd_texture. */
    template <class T, class F>
    static etd_status with_owner(T value, std::shared_ptr<const void> &&owner, F &&call) {
        auto kept = std::make_unique<std::shared_ptr<const void>>(std::move(owner));
        value.sharing = ETD_SHARE;
        value.release = let_go;
        value.user_data = kept.get();
        const etd_status status = call(&value);
        if (status == ETD_OK) {
            // `let_go` has it now, and may have deleted it already.
            static_cast<void>(kept.release());
        }
        return status;
    }
};

/** An image in the library's memory, there to be read for as long as this lives. */
class Map {
public:
    Map(const Map &) = delete;
    Map &operator=(const Map &) = delete;
    /** Takes a map over. */
    Map(Map &&other) noexcept
        : keep_(std::move(other.keep_)), film_(std::exchange(other.film_, nullptr)), map_(other.map_) {
        other.map_ = no_map();
    }
    /** Ends this map and takes another one over. */
    Map &operator=(Map &&other) noexcept {
        Map taken(std::move(other));
        std::swap(keep_, taken.keep_);
        std::swap(film_, taken.film_);
        std::swap(map_, taken.map_);
        return *this;
    }
    /** Ends the map. */
    ~Map() { unmap(); }

    /** `[height][width][channels]`, row 0 on top. */
    span<const float> data() const noexcept {
        return map_.data == nullptr ? span<const float>()
                                    : span<const float>(map_.data, std::size_t{map_.width} * map_.height * map_.channels);
    }
    /** The values of a pixel. */
    const float *pixel(std::uint32_t x, std::uint32_t y) const noexcept {
        return map_.data + (std::size_t{y} * map_.width + x) * map_.channels;
    }
    /** Pixels in a row. */
    std::uint32_t width() const noexcept { return map_.width; }
    /** Rows. */
    std::uint32_t height() const noexcept { return map_.height; }
    /** Values for each pixel. */
    std::uint32_t channels() const noexcept { return map_.channels; }
    /** Complete samples for each pixel when this image was made. */
    std::uint32_t samples() const noexcept { return map_.samples; }
    /** Ends the map before its time. */
    void unmap() noexcept {
        if (film_ != nullptr) {
            etd_film_unmap(film_, &map_);
            etd_film_release(std::exchange(film_, nullptr));
            map_ = no_map();
        }
    }

private:
    friend class Film;
    static etd_map no_map() noexcept { return ETD_MAP_INIT; }
    Map(detail::Keep keep, etd_film *film, const etd_map &map) noexcept
        : keep_(std::move(keep)), film_(film), map_(map) {}

    detail::Keep keep_;
    etd_film *film_;
    etd_map map_;
};

/** Which part of a picture a film has: `share_number` and `share_count` of its render's options. */
struct Share {
    /** The part, from 1; 0 for all of the picture. */
    std::uint32_t number = 0;
    /** How many parts there are; 0 for all of the picture. */
    std::uint32_t count = 0;
};

/** A film: its resolution and layers, and the image that was made last. */
class Film : public detail::Owner<etd_film, etd_film_retain, etd_film_release> {
public:
    /** A black film. */
    static Outcome<Film> create(const Device &device, const etd_film_options &options) {
        etd_film *film = nullptr;
        const etd_status status = etd_film_new(device.get(), &options, &film);
        return detail::give(status, Film(device.keep(), film));
    }
    /** A black film of this resolution; `layers`: `etd_layer` bits besides the colour. */
    static Outcome<Film> create(const Device &device, std::uint32_t width, std::uint32_t height,
                                std::uint32_t layers = 0) {
        return create(device, film_options(width, height, layers));
    }
    /**
     * A film that was saved, from a file; `layers`: `etd_layer` bits besides the colour. A render whose options have its `get()` as
     * `resume` goes on from it.
     */
    static Outcome<Film> load(const Device &device, const std::string &path, std::uint32_t layers = 0) {
        const etd_film_options options = film_options(0, 0, layers);
        etd_film *film = nullptr;
        const etd_status status = etd_film_load(device.get(), path.c_str(), &options, &film);
        return detail::give(status, Film(device.keep(), film));
    }
    /** A film that was saved, from memory. */
    static Outcome<Film> load_memory(const Device &device, span<const unsigned char> bytes, std::uint32_t layers = 0) {
        const etd_film_options options = film_options(0, 0, layers);
        // An empty span may have no address, which the library takes for a forgotten argument.
        static constexpr unsigned char none = 0;
        const unsigned char *data = bytes.empty() ? &none : bytes.data();
        etd_film *film = nullptr;
        const etd_status status = etd_film_load_memory(device.get(), data, bytes.size(), &options, &film);
        return detail::give(status, Film(device.keep(), film));
    }
    /** The film of a whole picture, from those of all its parts in any order, which stay as they are. */
    static Outcome<Film> merge(span<const Film> parts) {
        std::vector<etd_film *> handles;
        for (const Film &part : parts) {
            handles.push_back(part.get());
        }
        etd_film *none = nullptr;
        etd_film *film = nullptr;
        const etd_status status = etd_film_merge(handles.empty() ? &none : handles.data(), handles.size(), &film);
        return detail::give(status, Film(parts.empty() ? nullptr : parts[0].keep(), film));
    }
    /** A second owner of the same film. */
    Outcome<Film> share() const {
        const etd_status status = retain();
        return detail::give(status, Film(keep(), status == ETD_OK ? get() : nullptr));
    }
    /** The first failure of a call on this film since this was last asked. */
    std::optional<Error> first_failure() const { return detail::first_failure(etd_film_status, get()); }

    /** Maps a layer of the newest image. The map keeps the film alive. */
    Outcome<Map> map(etd_layer layer = ETD_LAYER_COLOR) const {
        etd_map map = ETD_MAP_INIT;
        etd_status status = etd_film_map(get(), layer, &map);
        if (status == ETD_OK) {
            status = retain();
        }
        return detail::give(status, Map(keep(), status == ETD_OK ? get() : nullptr, map));
    }
    /**
     * Copies a layer of the newest image. `T` is `float` or a byte, as `options.format` says; `row_stride`: bytes from
     * one row to the next, 0 for rows close together.
     */
    template <class T>
    Outcome<void> copy(etd_layer layer, span<T> pixels, const etd_image_options &options = image_options(),
                       std::size_t row_stride = 0) const {
        static_assert(std::is_same_v<T, float> || sizeof(T) == 1, "pixels are floats or bytes");
        return detail::done(
            etd_film_copy(get(), layer, &options, pixels.data(), pixels.size_bytes(), row_stride));
    }
    /** Writes the film to a `.png`, `.exr` or `.pfm` file. */
    Outcome<void> write(const std::string &path, const etd_image_options &options = image_options()) const {
        return detail::done(etd_film_write(get(), path.c_str(), &options));
    }
    /** Saves the state of the last render to a file, which is replaced in one step. */
    Outcome<void> save(const std::string &path) const { return detail::done(etd_film_save(get(), path.c_str())); }
    /** The bytes that `save` writes. */
    Outcome<std::vector<unsigned char>> save_memory() const {
        std::vector<unsigned char> bytes;
        std::size_t size = 0;
        etd_status status = etd_film_save_memory(get(), nullptr, 0, &size);
        if (status == ETD_OK) {
            bytes.resize(size);
            status = etd_film_save_memory(get(), bytes.data(), bytes.size(), &size);
        }
        return detail::give(status, std::move(bytes));
    }
    /** Which part of the picture the last render was of. */
    Outcome<Share> part() const {
        Share part;
        const etd_status status = etd_film_get_share(get(), &part.number, &part.count);
        return detail::give(status, std::move(part));
    }
    /** Makes it a black film of another resolution with the same layers. Maps stay as they are. */
    Outcome<void> resize(std::uint32_t width, std::uint32_t height) {
        return detail::done(etd_film_resize(get(), width, height));
    }
    /** Width and height in pixels. */
    Outcome<Resolution> resolution() const {
        Resolution resolution;
        const etd_status status = etd_film_get_resolution(get(), &resolution.width, &resolution.height);
        return detail::give(status, std::move(resolution));
    }
    /** What the last render that ended on this film came to, or what is known of a film that was loaded or merged. */
    Outcome<etd_summary> summary() const {
        etd_summary summary = ETD_SUMMARY_INIT;
        const etd_status status = etd_film_get_summary(get(), &summary);
        return detail::give(status, std::move(summary));
    }

private:
    using Owner::Owner;
};

/** What `Task::poll` tells. */
struct TaskState {
    /** `ETD_RUNNING`, `ETD_OK` or `ETD_CANCELLED`. */
    etd_status status = ETD_RUNNING;
    /** How far it is. */
    etd_progress progress = ETD_PROGRESS_INIT;
};

/**
 * A started render. Destroying the last owner cancels it, and waits for its end so that its functions are not called any
 * more (inside one of these it does not wait; they live for as long as they are needed).
 */
class Task : public detail::Owner<etd_task, etd_task_retain, etd_task_release> {
public:
    /**
     * Begins to render a scene to a film and returns at once.
     *
     * `options`: NULL for the scene's own settings. `progress`, `finished`: where empty, what `options` says is called.
     */
    static Outcome<Task> start(Scene &scene, Film &film, const etd_render_options *options = nullptr,
                               Progress progress = {}, Finished finished = {}) {
        etd_render_options raw = ETD_RENDER_OPTIONS_INIT;
        etd_status status = take_options(scene, options, raw);
        if (status != ETD_OK) {
            return detail::fail<Task>(status);
        }
        Hooks hooks(new detail::TaskHooks(std::move(progress), std::move(finished), raw, scene.keep()));
        raw.progress = detail::ProgressHooks::tell;
        raw.finished = detail::TaskHooks::end;
        raw.user_data = static_cast<detail::ProgressHooks *>(hooks.get());
        etd_task *task = nullptr;
        hooks->hold();
        status = etd_render_start(scene.get(), film.get(), &raw, &task);
        if (status != ETD_OK) {
            detail::TaskHooks::drop(hooks.get());
        }
        return detail::give(status, Task(scene.keep(), task, std::move(hooks)));
    }
    /** A second owner of the same task. */
    Outcome<Task> share() const {
        const etd_status status = retain();
        if (status == ETD_OK) {
            hooks_->hold();
        }
        return detail::give(status, status == ETD_OK ? Task(keep(), get(), Hooks(hooks_.get()))
                                                     : Task(nullptr, nullptr, nullptr));
    }
    /** The first failure of a call on this task since this was last asked. */
    std::optional<Error> first_failure() const { return detail::first_failure(etd_task_status, get()); }

    /** Takes a task over. */
    Task(Task &&other) noexcept : Owner(static_cast<Owner &&>(other)), hooks_(std::move(other.hooks_)) {}
    /** Gives back the task there was and takes another one over. */
    Task &operator=(Task &&other) noexcept {
        if (this != &other) {
            // The handle goes first: the task's last calls need the functions.
            reset();
            Owner::operator=(static_cast<Owner &&>(other));
            hooks_ = std::move(other.hooks_);
        }
        return *this;
    }
    /** Gives back the task. */
    ~Task() { reset(); }

    /** How far it is, or how it ended. */
    Outcome<TaskState> poll() const {
        TaskState state;
        const etd_status status = etd_task_poll(get(), &state.progress);
        if (status != ETD_OK && status != ETD_RUNNING && status != ETD_CANCELLED) {
            return detail::fail<TaskState>(status);
        }
        state.status = status;
        return Outcome<TaskState>(state);
    }
    /**
     * Waits for the end, for `seconds` at most (below 0: without a limit): `ETD_RUNNING`, `ETD_OK` or `ETD_CANCELLED`.
     * Throws again what a function of the task has thrown.
     */
    Outcome<etd_status> wait(double seconds = -1) const {
        const etd_status status = etd_task_wait(get(), seconds);
        if (status != ETD_RUNNING && hooks_) {
            hooks_->rethrow();
        }
        return detail::ended(status);
    }
    /** Asks it to end soon. */
    Outcome<void> cancel() const { return detail::done(etd_task_cancel(get())); }
    /** Lets it go on from where it was stopped. */
    Outcome<void> resume() {
        if (hooks_) {
            hooks_->hold();
        }
        const etd_status status = etd_task_resume(get());
        if (status != ETD_OK && hooks_) {
            detail::TaskHooks::drop(hooks_.get());
        }
        return detail::done(status);
    }

private:
    friend Outcome<etd_status> render(Scene &scene, Film &film, const etd_render_options *options, Progress progress);
    using Hooks = std::unique_ptr<detail::TaskHooks, detail::DropTaskHooks>;

    Task(detail::Keep keep, etd_task *task, Hooks hooks) noexcept
        : Owner(std::move(keep), task), hooks_(std::move(hooks)) {}

    /** The options of a render whose functions are to be replaced. */
    static etd_status take_options(const Scene &scene, const etd_render_options *options, etd_render_options &out) {
        if (options == nullptr) {
            return etd_scene_get_render_options(scene.get(), &out);
        }
        out = *options;
        return ETD_OK;
    }

    Hooks hooks_;
};

/**
 * Renders a scene to a film and returns when it is done: `ETD_OK`, or `ETD_CANCELLED` if `progress` said so.
 *
 * `options`: NULL for the scene's own settings. `progress`: where empty, what `options` says is called.
 */
inline Outcome<etd_status> render(Scene &scene, Film &film, const etd_render_options *options = nullptr,
                                  Progress progress = {}) {
    etd_render_options raw = ETD_RENDER_OPTIONS_INIT;
    etd_status status = Task::take_options(scene, options, raw);
    if (status != ETD_OK) {
        return detail::fail<etd_status>(status);
    }
    detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, scene.keep());
    raw.progress = detail::ProgressHooks::tell;
    raw.finished = nullptr;
    raw.user_data = &hooks;
    status = etd_render(scene.get(), film.get(), &raw);
    hooks.rethrow();
    return detail::ended(status);
}

/** As above, with these settings. */
inline Outcome<etd_status> render(Scene &scene, Film &film, const etd_render_options &options,
                                  Progress progress = {}) {
    return render(scene, film, &options, std::move(progress));
}

/** The layout of a light map, and the scene that it is of. */
class Atlas : public detail::Owner<etd_atlas, etd_atlas_retain, etd_atlas_release> {
public:
    /**
     * Lays out all surfaces of a scene. `ETD_CANCELLED` is an error here: there is no atlas then.
     *
     * `progress`: where empty, what `options` says is called.
     */
    static Outcome<Atlas> create(Scene &scene, const etd_atlas_options &options = atlas_options(),
                                 Progress progress = {}) {
        etd_atlas_options raw = options;
        detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, scene.keep());
        raw.progress = detail::ProgressHooks::tell;
        raw.user_data = &hooks;
        etd_atlas *atlas = nullptr;
        const etd_status status = etd_atlas_new(scene.get(), &raw, &atlas);
        hooks.rethrow();
        return detail::give(status, Atlas(scene.keep(), atlas));
    }
    /** A second owner of the same atlas. */
    Outcome<Atlas> share() const {
        const etd_status status = retain();
        return detail::give(status, Atlas(keep(), status == ETD_OK ? get() : nullptr));
    }
    /** The first failure of a call on this atlas since this was last asked. */
    std::optional<Error> first_failure() const { return detail::first_failure(etd_atlas_status, get()); }

    /** How large it is, and how many of everything it has. */
    Outcome<etd_atlas_info> info() const {
        etd_atlas_info info = ETD_ATLAS_INFO_INIT;
        const etd_status status = etd_atlas_get_info(get(), &info);
        return detail::give(status, std::move(info));
    }
    /** Vertices, those of a surface together. */
    Outcome<std::vector<etd_atlas_vertex>> vertices() const { return copy(etd_atlas_copy_vertices); }
    /** Three vertex numbers for each triangle. */
    Outcome<std::vector<std::uint32_t>> indices() const { return copy(etd_atlas_copy_indices); }
    /** The number of each triangle in its mesh as it was given. */
    Outcome<std::vector<std::uint32_t>> primitives() const { return copy(etd_atlas_copy_primitives); }
    /** What there is of each surface. */
    Outcome<std::vector<etd_atlas_surface>> surfaces() const { return copy(etd_atlas_copy_surfaces); }
    /** The share of each texel that triangles cover, row 0 at v = 0. */
    Outcome<std::vector<float>> coverage() const { return copy(etd_atlas_copy_coverage); }

    /** Bakes the light map into the program's memory: `ETD_OK`, or `ETD_CANCELLED` if `progress` said so. */
    Outcome<etd_status> bake(const etd_bake_target &target, const etd_render_options &options, Progress progress = {},
                             etd_summary *summary = nullptr) {
        etd_render_options raw = options;
        detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, keep());
        raw.progress = detail::ProgressHooks::tell;
        raw.user_data = &hooks;
        const etd_status status = etd_atlas_bake(get(), &raw, &target, summary);
        hooks.rethrow();
        return detail::ended(status);
    }

private:
    using Owner::Owner;

    template <class T>
    Outcome<std::vector<T>> copy(etd_status (*call)(const etd_atlas *, T *, std::size_t, std::size_t *)) const {
        std::vector<T> items;
        std::size_t needed = 0;
        etd_status status = call(get(), nullptr, 0, &needed);
        if (status == ETD_OK) {
            items.resize(needed);
            status = call(get(), items.data(), items.size(), &needed);
        }
        return detail::give(status, std::move(items));
    }
};

/** Bakes the vertices of one surface into the program's memory: `ETD_OK`, or `ETD_CANCELLED` if `progress` said so. */
inline Outcome<etd_status> bake_vertices(Scene &scene, std::uint32_t surface, const etd_bake_target &target,
                                         const etd_render_options &options, Progress progress = {},
                                         etd_summary *summary = nullptr) {
    etd_render_options raw = options;
    detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, scene.keep());
    raw.progress = detail::ProgressHooks::tell;
    raw.user_data = &hooks;
    const etd_status status = etd_scene_bake_vertices(scene.get(), surface, &raw, &target, summary);
    hooks.rethrow();
    return detail::ended(status);
}

/** Measures light at points: `ETD_OK`, or `ETD_CANCELLED` if `progress` said so. `values` and `standard_errors`, unless that is
 *  empty, have a number for each point; `ETD_INVALID_ARGUMENT` if not. */
inline Outcome<etd_status> measure(Scene &scene, etd_quantity quantity, span<const etd_measuring_point> points,
                                   const etd_render_options &options, span<double> values,
                                   span<double> standard_errors = {}, Progress progress = {},
                                   etd_summary *summary = nullptr) {
    if (values.size() != points.size() || (standard_errors.size() != 0 && standard_errors.size() != points.size())) {
        return detail::refuse<etd_status>("values or standard errors and points are not of the same number");
    }
    etd_render_options raw = options;
    detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, scene.keep());
    raw.progress = detail::ProgressHooks::tell;
    raw.user_data = &hooks;
    double *errors = standard_errors.size() == 0 ? nullptr : standard_errors.data();
    const etd_status status = etd_scene_measure(scene.get(), quantity, points.data(), points.size(), &raw, values.data(),
                                                errors, summary);
    hooks.rethrow();
    return detail::ended(status);
}

/** Traces mattes: `ETD_OK`, or `ETD_CANCELLED` if `progress` said so. `ids` and `coverages` have `width` x `height` x `levels` items;
 *  `ETD_INVALID_ARGUMENT` if not. */
inline Outcome<etd_status> trace_mattes(Scene &scene, std::uint32_t width, std::uint32_t height,
                                        const etd_render_options &options, etd_matte_kind kind, std::uint32_t levels,
                                        span<std::uint32_t> ids, span<float> coverages, Progress progress = {}) {
    const std::size_t count = std::size_t(width) * height;
    const auto fits = [&](std::size_t size) { return levels != 0 && size % levels == 0 && size / levels == count; };
    if (!fits(ids.size()) || !fits(coverages.size())) {
        return detail::refuse<etd_status>("ids or coverages are not width x height x levels");
    }
    etd_render_options raw = options;
    detail::ProgressHooks hooks(std::move(progress), raw.progress, raw.user_data, scene.keep());
    raw.progress = detail::ProgressHooks::tell;
    raw.user_data = &hooks;
    const etd_status status =
        etd_scene_trace_mattes(scene.get(), width, height, &raw, kind, levels, ids.data(), coverages.data());
    hooks.rethrow();
    return detail::ended(status);
}

/** The identifier of a name in mattes. */
inline Outcome<std::uint32_t> matte_id(const std::string &name) {
    std::uint32_t id = 0;
    const etd_status status = etd_matte_id(name.c_str(), &id);
    return detail::give(status, std::move(id));
}

} // inline namespace
} // namespace etd

#endif
