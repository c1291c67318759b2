#include "engine/app/film.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/picture_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace fs = std::filesystem;

passes::Image8 readPicture(const fs::path& file) {
    auto picture = geometry::readPictureFile(file);
    if (!picture) throw std::runtime_error(file.string() + ": cannot be read as a picture");
    return {picture->width, picture->height, std::move(picture->rgb)};
}

struct Film::Impl {
    static constexpr size_t kMostWaiting = 8; // frames

    fs::path target, aside;
    std::unique_ptr<geometry::FilmEncoder> encoder;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::vector<uint8_t>> waiting;
    bool ending = false;
    std::exception_ptr failure; // of the thread, read when it has ended
    std::thread thread;

    void encode() {
        while (true) {
            std::vector<uint8_t> rgb;
            {
                std::unique_lock lock(mutex);
                changed.wait(lock, [&] { return ending || !waiting.empty(); });
                if (waiting.empty()) return;
                rgb = std::move(waiting.front());
                waiting.pop_front();
            }
            changed.notify_all();
            if (!failure) try {
                    encoder->add(rgb.data());
                } catch (...) {
                    failure = std::current_exception();
                }
        }
    }

    void discard() {
        encoder.reset(); // closes the file
        std::error_code ignored;
        fs::remove(aside, ignored);
    }

    void end() {
        {
            const std::scoped_lock lock(mutex);
            ending = true;
        }
        changed.notify_all();
        if (thread.joinable()) thread.join();
    }
};

Film::Film(const fs::path& target, uint32_t width, uint32_t height, double framesPerSecond)
    : impl_(std::make_unique<Impl>()) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::is_directory(folder))
        throw geometry::InputError(target.string(), "", "its folder does not exist");
    impl_->target = target;
    impl_->aside = geometry::asideOf(target);
    impl_->encoder = geometry::openFilmFile(impl_->aside, static_cast<int>(width), static_cast<int>(height),
                                            framesPerSecond);
    if (!impl_->encoder)
        throw std::runtime_error(target.string() +
                                 ": no H.264 encoder could be opened (OpenCV with FFmpeg is needed)");
    impl_->thread = std::thread([impl = impl_.get()] { impl->encode(); });
}

Film::~Film() {
    if (!impl_->thread.joinable()) return;
    {
        const std::scoped_lock lock(impl_->mutex);
        impl_->waiting.clear();
    }
    impl_->end();
    impl_->discard();
}

void Film::add(std::vector<uint8_t> rgb) {
    std::unique_lock lock(impl_->mutex);
    impl_->changed.wait(lock, [&] { return impl_->waiting.size() < Impl::kMostWaiting; });
    impl_->waiting.push_back(std::move(rgb));
    lock.unlock();
    impl_->changed.notify_all();
}

void Film::close() {
    impl_->end();
    try {
        if (impl_->failure) std::rethrow_exception(impl_->failure);
        if (!impl_->encoder->finish())
            throw std::runtime_error(impl_->target.string() + ": the film could not be written (disk full?)");
        fs::rename(impl_->aside, impl_->target);
    } catch (...) {
        impl_->discard();
        throw;
    }
}

} // namespace heliodon::app
