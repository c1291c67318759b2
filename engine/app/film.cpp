#include "engine/app/film.h"

#include <exception>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "engine/app/bounded_queue.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace fs = std::filesystem;

passes::Image8 readPicture(const fs::path& file) {
    auto picture = geometry::pictureIn(geometry::bytesOf(file));
    if (!picture) throw std::runtime_error(file.string() + ": cannot be read as a picture");
    return {picture->width, picture->height, std::move(picture->rgb)};
}

struct Film::Impl {
    fs::path target, place, aside; // `target` leads to `place`, through links
    std::unique_ptr<geometry::FilmEncoder> encoder;
    BoundedQueue<std::vector<uint8_t>> frames{8};
    std::mutex mutex;
    std::exception_ptr failure; // of the thread
    std::thread thread;

    void encode() {
        while (const auto rgb = frames.pop()) {
            try {
                if (!encoder->add(rgb->data())) fail("a frame could not be encoded or written");
            } catch (...) {
                const std::scoped_lock lock(mutex);
                failure = std::current_exception();
                frames.close(true);
            }
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        const std::string why = encoder->why();
        throw std::runtime_error(target.string() + ": " + what + (why.empty() ? "" : ": " + why));
    }

    void throwFailure() {
        const std::scoped_lock lock(mutex);
        if (failure) std::rethrow_exception(failure);
    }

    void discard() {
        encoder.reset(); // closes the file
        std::error_code ignored;
        fs::remove(aside, ignored);
    }

    void end(bool drop) {
        frames.close(drop);
        if (thread.joinable()) thread.join();
    }
};

Film::Film(const fs::path& target, uint32_t width, uint32_t height, double framesPerSecond)
    : Film(target, [&](const fs::path& file) {
          return geometry::openFilmFile(file, static_cast<int>(width), static_cast<int>(height),
                                        framesPerSecond);
      }) {}

Film::Film(const fs::path& target, const Open& open) : impl_(std::make_unique<Impl>()) {
    impl_->target = target;
    const fs::path place = geometry::placeOf(target);
    impl_->place = place.empty() ? target : place;
    impl_->aside = geometry::asideOf(impl_->place);
    try {
        geometry::writeTextAside(impl_->aside, target, ""); // encoders do not say why they cannot
        impl_->encoder = open(impl_->aside);
        if (!impl_->encoder)
            throw std::runtime_error(target.string() +
                                     ": no H.264 encoder could be opened (FFmpeg with libx264 is needed)");
        impl_->thread = std::thread([impl = impl_.get()] { impl->encode(); });
    } catch (...) { // the file may have been begun
        impl_->discard();
        throw;
    }
}

Film::~Film() {
    if (!impl_->thread.joinable()) return;
    impl_->end(true);
    impl_->discard();
}

void Film::add(std::vector<uint8_t> rgb) {
    if (!impl_->frames.push(std::move(rgb))) impl_->throwFailure();
}

void Film::close() {
    impl_->end(false);
    try {
        impl_->throwFailure();
        if (!impl_->encoder->finish()) impl_->fail("the film could not be written");
        fs::rename(impl_->aside, impl_->place);
    } catch (...) {
        impl_->discard();
        throw;
    }
}

} // namespace heliodon::app
