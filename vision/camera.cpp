#include "vision/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "geometry/file_state.h"
#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/text_file.h"
#include "vision/aravis_camera.h"

namespace heliodon::vision {

namespace {

using Clock = std::chrono::steady_clock;
using geometry::FileState;
using geometry::InputError;

Clock::duration seconds(double value) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

std::shared_ptr<const Photograph> shared(const std::filesystem::path& file) {
    return std::make_shared<const Photograph>(readPhotograph(file));
}

// A file, and again whenever it has changed and then stayed as it is for one look.
class FileCamera : public Camera {
public:
    FileCamera(std::filesystem::path file, const CameraOptions& options)
        : file_(std::move(file)), refresh_(seconds(options.refreshSeconds)) {
        constexpr const char* kExpected = "a photograph (png, jpg or tif)";
        if (file_.empty())
            throw InputError("--camera", "file:", std::string("names no file, expected ") + kExpected);
        geometry::refuseUnreadable(file_, kExpected);
        if (!std::filesystem::is_regular_file(file_))
            throw InputError(file_.string(), "", std::string("can be read only once, expected ") + kExpected);
    }

    std::optional<CameraPicture> next(std::chrono::milliseconds longest) override {
        const auto end = Clock::now() + longest;
        for (;;) {
            const std::optional<FileState> now = geometry::fileState(file_);
            const bool settled = now == last_; // whoever writes it has finished
            last_ = now;
            if (now && settled && now != read_) {
                read_ = now;
                const auto noticed = Clock::now();
                return CameraPicture{shared(file_), noticed};
            }
            if (!now && read_) { // a file that is replaced is gone for a moment only
                if (!missingSince_) missingSince_ = Clock::now();
                if (Clock::now() - *missingSince_ > std::chrono::seconds(2)) {
                    missingSince_.reset();
                    read_.reset();
                    throw CameraLost(file_.string() + " is not there");
                }
            } else {
                missingSince_.reset();
            }
            if (Clock::now() + refresh_ > end) {
                std::this_thread::sleep_until(end);
                return std::nullopt;
            }
            std::this_thread::sleep_for(refresh_);
        }
    }
    bool isContinuous() const override { return false; }
    std::string description() const override { return "file " + file_.filename().string(); }

private:
    std::filesystem::path file_;
    Clock::duration refresh_;
    std::optional<FileState> last_, read_;
    std::optional<Clock::time_point> missingSince_;
};

// Behaves as a camera before which the table changes once an interval.
class ReplayCamera : public Camera {
public:
    ReplayCamera(const std::filesystem::path& folder, const CameraOptions& options)
        : folder_(folder), options_(options), start_(Clock::now()) {
        std::error_code ignored;
        if (!std::filesystem::is_directory(folder, ignored))
            throw InputError(folder.string(), "", "no such folder, expected one with photographs");
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const std::string extension = geometry::loweredExtension(entry.path());
            constexpr std::array kPictures{".png", ".jpg", ".jpeg", ".tif", ".tiff"};
            if (entry.is_regular_file() && std::count(kPictures.begin(), kPictures.end(), extension))
                files_.push_back(entry.path());
        }
        std::sort(files_.begin(), files_.end());
        if (files_.empty()) throw InputError(folder.string(), "", "holds no photograph (png, jpg or tif)");
    }

    std::optional<CameraPicture> next(std::chrono::milliseconds longest) override {
        const auto refresh = seconds(options_.refreshSeconds);
        const auto due = lastShown_ + refresh, end = Clock::now() + longest;
        std::this_thread::sleep_until(std::min(due, end));
        if (due > end) return std::nullopt;
        lastShown_ = Clock::now();
        const double elapsed = std::chrono::duration<double>(lastShown_ - start_).count();
        size_t turn = static_cast<size_t>(elapsed / options_.intervalSeconds);
        turn = options_.loop ? turn % files_.size() : std::min(turn, files_.size() - 1);
        if (turn != turn_) {
            turn_ = turn;
            picture_.reset(); // also where it cannot be read: that is said once
            picture_ = shared(files_[turn]);
        }
        if (!picture_) return std::nullopt;
        return CameraPicture{picture_, lastShown_};
    }
    bool isContinuous() const override { return true; }
    bool hasEnded() const override { return !options_.loop && turn_ == files_.size() - 1; }
    std::string description() const override {
        return fmt::format("replay, picture {} of {}", turn_.value_or(0) + 1, files_.size());
    }

private:
    std::filesystem::path folder_;
    CameraOptions options_;
    std::vector<std::filesystem::path> files_;
    Clock::time_point start_, lastShown_{};
    std::shared_ptr<const Photograph> picture_;
    std::optional<size_t> turn_;
};

} // namespace

void refuseNoCamera(const std::string& source) {
    for (const char* kind : {"file:", "replay:", "aravis:"})
        if (source.starts_with(kind)) return;
    throw InputError("--camera", "",
                     "'" + source + "' is no camera, expected aravis:ID, replay:FOLDER or file:PHOTO");
}

std::unique_ptr<Camera> openCamera(const std::string& source, const CameraOptions& options) {
    refuseNoCamera(source);
    const size_t colon = source.find(':');
    const std::string kind = source.substr(0, colon), rest = source.substr(colon + 1);
    if (kind == "file") return std::make_unique<FileCamera>(rest, options);
    if (kind == "replay") return std::make_unique<ReplayCamera>(rest, options);
    return openAravisCamera(rest, options);
}

} // namespace heliodon::vision
