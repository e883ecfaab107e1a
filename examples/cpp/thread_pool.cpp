// A host with threads of its own: the library gives its work to them, and starts none.
//
// Build:  c++ -std=c++17 -pthread thread_pool.cpp $(pkg-config --cflags --libs etendue) -o thread_pool
// Run:    ./thread_pool [THREADS [WIDTH [HEIGHT [SAMPLES]]]]; writes thread_pool.png
#include "common.hpp"

#include <condition_variable>
#include <deque>
#include <thread>
#include <vector>

namespace {

// The simplest pool there is: a list and some threads. Going away, it finishes what is on the list.
class Pool {
public:
    explicit Pool(std::uint32_t threads) {
        for (std::uint32_t i = 0; i < threads; ++i) {
            threads_.emplace_back([this] { run(); });
        }
    }
    Pool(const Pool &) = delete;
    Pool &operator=(const Pool &) = delete;
    ~Pool() { finish(); }

    void add(std::function<void()> work) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            list_.push_back(std::move(work));
        }
        changed_.notify_one();
    }

    // Runs what is on the list, ends the threads, and says how much there was.
    std::size_t finish() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            closed_ = true;
        }
        changed_.notify_all();
        for (std::thread &thread : threads_) {
            thread.join();
        }
        threads_.clear();
        return done_;
    }

private:
    void run() {
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return closed_ || !list_.empty(); });
            if (list_.empty()) {
                return;
            }
            std::function<void()> work = std::move(list_.front());
            list_.pop_front();
            lock.unlock();
            work();
            work = nullptr;
            lock.lock();
            ++done_;
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> list_;
    std::vector<std::thread> threads_;
    bool closed_ = false;
    std::size_t done_ = 0;
};

} // namespace

int main(int count, char **arguments) {
    return reporting([&] {
        const std::uint32_t threads = number_argument(count, arguments, 1, 4);
        Pool pool(threads);
        etd_device_options device_options = etd::device_options();
        device_options.threads = threads;
        etd::DeviceFunctions functions;
        functions.submit = [&](etd::Work work) { pool.add(std::move(work)); };
        const etd::Device device = etd::Device::create(device_options, std::move(functions));
        {
            TwoBalls world(device);
            etd::Film film = etd::Film::create(device, number_argument(count, arguments, 2, 320),
                                               number_argument(count, arguments, 3, 240));
            etd_render_options options = etd::render_options();
            options.samples = number_argument(count, arguments, 4, 64);
            etd::Task task = etd::Task::start(world.scene, film, &options);
            task.wait();
            film.write("thread_pool.png");
        }
        // The pool ends what it has taken, and only then the device goes.
        std::printf("%u threads did %zu pieces of work\n", threads, pool.finish());
    });
}
