// Independent items of host work on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace heliodon::compute {

// work(i) for every i in [0, count), in any order and on several threads; each item's result must not depend
// on another's, so that the bits are the same on any number of cores. `done` is called on the calling thread
// now and then with the number of finished items. The first exception is thrown on, after all threads have
// stopped.
inline void inParallel(size_t count, const std::function<void(size_t)>& work,
                       const std::function<void(size_t)>& done = {}) {
    std::atomic<size_t> next{0}, finished{0};
    std::exception_ptr failure;
    std::mutex failing;
    const auto take = [&](bool tells) {
        try {
            for (size_t i; (i = next++) < count;) {
                work(i);
                ++finished;
                if (tells && done) done(finished);
            }
        } catch (...) {
            const std::lock_guard lock(failing);
            if (!failure) failure = std::current_exception();
            next = count;
        }
    };
    const size_t threads = std::min<size_t>(std::max(1u, std::thread::hardware_concurrency()), count);
    {
        std::vector<std::jthread> others;
        for (size_t t = 1; t < threads; ++t) others.emplace_back([&] { take(false); });
        take(true);
    }
    if (failure) std::rethrow_exception(failure);
    if (done) done(count);
}

} // namespace heliodon::compute
