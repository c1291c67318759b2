#include "engine/app/film.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include "geometry/input_error.h"

namespace heliodon::app {

namespace fs = std::filesystem;

passes::Image8 readPicture(const fs::path& file) {
    const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (bgr.empty()) throw std::runtime_error(file.string() + ": cannot be read as a picture");
    passes::Image8 image;
    image.width = bgr.cols, image.height = bgr.rows;
    image.rgb.resize(static_cast<size_t>(bgr.cols) * static_cast<size_t>(bgr.rows) * 3);
    cv::cvtColor(bgr, cv::Mat(bgr.rows, bgr.cols, CV_8UC3, image.rgb.data()), cv::COLOR_BGR2RGB);
    return image;
}

struct Film::Impl {
    static constexpr size_t kMostWaiting = 8; // frames

    fs::path target, aside;
    int width = 0, height = 0;
    cv::VideoWriter writer;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::vector<uint8_t>> waiting;
    bool ending = false;
    std::thread thread;

    void encode() {
        cv::Mat padded(height + height % 2, width + width % 2, CV_8UC3,
                       cv::Scalar::all(0)); // 4:2:0 needs even sizes
        cv::Mat inside = padded(cv::Rect(0, 0, width, height));
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
            cv::cvtColor(cv::Mat(height, width, CV_8UC3, rgb.data()), inside, cv::COLOR_RGB2BGR);
            writer.write(padded);
        }
    }

    void end() {
        {
            const std::scoped_lock lock(mutex);
            ending = true;
        }
        changed.notify_all();
        if (thread.joinable()) thread.join();
        writer.release();
    }
};

Film::Film(const fs::path& target, uint32_t width, uint32_t height, double framesPerSecond)
    : impl_(std::make_unique<Impl>()) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::is_directory(folder))
        throw geometry::InputError(target.string(), "", "its folder does not exist");
    impl_->target = target;
    impl_->aside =
        folder / fmt::format(".{}.{}{}", target.stem().string(), ::getpid(), target.extension().string());
    impl_->width = static_cast<int>(width);
    impl_->height = static_cast<int>(height);
    const cv::Size size(impl_->width + impl_->width % 2, impl_->height + impl_->height % 2);
    if (!impl_->writer.open(impl_->aside.string(), cv::CAP_FFMPEG,
                            cv::VideoWriter::fourcc('a', 'v', 'c', '1'), framesPerSecond, size))
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
    std::error_code ignored;
    fs::remove(impl_->aside, ignored);
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
    fs::rename(impl_->aside, impl_->target);
}

} // namespace heliodon::app
