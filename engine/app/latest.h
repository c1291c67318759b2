// A place for one thing on its way from one thread to another: what was not taken yet is replaced by what
// comes after it, so that nobody works on what is out of date.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace heliodon::app {

template<class T> class Latest {
public:
    // False when it took the place of one that nobody took.
    bool put(T value) {
        const std::lock_guard lock(mutex_);
        const bool fresh = !value_;
        value_ = std::move(value);
        changed_.notify_all();
        return fresh;
    }
    // Waits. None once it is closed.
    std::optional<T> take() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return value_ || closed_; });
        return closed_ ? std::nullopt : std::exchange(value_, std::nullopt);
    }
    void close() {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        changed_.notify_all();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<T> value_;
    bool closed_ = false;
};

} // namespace heliodon::app
