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
    // What was taken last is to be taken again. False when something newer waits, or nothing was taken yet.
    bool again() {
        const std::lock_guard lock(mutex_);
        if (value_ || !taken_) return false;
        value_ = taken_;
        changed_.notify_all();
        return true;
    }
    // Waits. None once it is closed.
    std::optional<T> take() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return value_ || closed_; });
        if (closed_) return std::nullopt;
        taken_ = std::exchange(value_, std::nullopt);
        return taken_;
    }
    void close() {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        changed_.notify_all();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<T> value_, taken_;
    bool closed_ = false;
};

} // namespace heliodon::app
