#include "vision/aravis_camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <mutex>

#include <arv.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::vision {

namespace {

// Throws CameraLost with Aravis' words and frees them.
class Failure {
public:
    ~Failure() { g_clear_error(&error_); }
    GError** operator&() { return &error_; }
    bool happened() const { return error_ != nullptr; }
    void check(const std::string& doing) {
        if (!error_) return;
        const std::string why = error_->message;
        g_clear_error(&error_);
        throw CameraLost(fmt::format("{}: {}", doing, why));
    }

private:
    GError* error_ = nullptr;
};

struct Unref {
    void operator()(void* object) const { g_object_unref(object); }
};

// What OpenCV must do to a format to get RGB; -1: nothing. OpenCV names a mosaic by its second row.
struct Format {
    ArvPixelFormat pixels;
    int channels, conversion;
};
constexpr std::array<Format, 7> kFormats{{
    {ARV_PIXEL_FORMAT_RGB_8_PACKED, 3, -1},
    {ARV_PIXEL_FORMAT_BGR_8_PACKED, 3, cv::COLOR_BGR2RGB},
    {ARV_PIXEL_FORMAT_BAYER_RG_8, 1, cv::COLOR_BayerBG2RGB},
    {ARV_PIXEL_FORMAT_BAYER_GR_8, 1, cv::COLOR_BayerGB2RGB},
    {ARV_PIXEL_FORMAT_BAYER_GB_8, 1, cv::COLOR_BayerGR2RGB},
    {ARV_PIXEL_FORMAT_BAYER_BG_8, 1, cv::COLOR_BayerRG2RGB},
    {ARV_PIXEL_FORMAT_MONO_8, 1, cv::COLOR_GRAY2RGB},
}};

class AravisCamera : public Camera {
public:
    AravisCamera(const std::string& id, const CameraOptions& options) {
        static std::once_flag once;
        if (id.starts_with("Fake")) std::call_once(once, [] { arv_enable_interface("Fake"); });
        const std::string name = id.empty() ? "a camera" : "camera " + id;
        Failure failure;
        camera_.reset(arv_camera_new(id.empty() ? nullptr : id.c_str(), &failure));
        failure.check(name);
        if (!camera_) throw CameraLost(name + " was not found");
        describe();
        chooseFormat();
        chooseRegion(options);
        arv_camera_set_acquisition_mode(camera_.get(), ARV_ACQUISITION_MODE_CONTINUOUS, &failure);
        failure.check(name_);
        const guint payload = arv_camera_get_payload(camera_.get(), &failure);
        failure.check(name_);
        stream_.reset(arv_camera_create_stream(camera_.get(), nullptr, nullptr, &failure));
        failure.check(name_);
        if (!stream_) throw CameraLost(name_ + " sends no pictures");
        constexpr int kBuffers = 6;
        for (int i = 0; i < kBuffers; ++i)
            arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(payload));
        g_signal_connect(
            arv_camera_get_device(camera_.get()), "control-lost",
            G_CALLBACK(+[](ArvDevice*, gpointer self) { static_cast<AravisCamera*>(self)->lost_ = true; }),
            this);
        arv_camera_start_acquisition(camera_.get(), &failure);
        failure.check(name_);
        lastSeen_ = std::chrono::steady_clock::now();
    }
    ~AravisCamera() override {
        g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera_.get()), this);
        Failure ignored;
        arv_camera_stop_acquisition(camera_.get(), &ignored);
    }

    std::optional<CameraPicture> next(std::chrono::milliseconds longest) override {
        const auto microseconds = std::chrono::duration_cast<std::chrono::microseconds>(longest).count();
        ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(microseconds));
        // Only the newest counts; the others go back to the stream at once.
        while (ArvBuffer* newer = buffer ? arv_stream_try_pop_buffer(stream_.get()) : nullptr) {
            arv_stream_push_buffer(stream_.get(), buffer);
            buffer = newer;
        }
        const auto giveBack = [this](ArvBuffer* taken) { arv_stream_push_buffer(stream_.get(), taken); };
        const std::unique_ptr<ArvBuffer, decltype(giveBack)> held(buffer, giveBack);
        const auto now = std::chrono::steady_clock::now();
        std::optional<CameraPicture> picture;
        if (buffer && arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) {
            picture = CameraPicture{convert(buffer), now};
            lastSeen_ = now;
        }
        constexpr std::chrono::seconds kSilent(5);
        if (lost_ || now - lastSeen_ > kSilent)
            throw CameraLost(name_ + (lost_ ? " went away" : " sends no pictures any more"));
        return picture;
    }
    bool isContinuous() const override { return true; }
    std::string description() const override { return name_; }

private:
    // What a read that failed left is no text.
    void describe() {
        const auto textOf = [&](auto read, const char* otherwise) {
            Failure failure;
            const char* text = read(camera_.get(), &failure);
            return std::string(failure.happened() || !text ? otherwise : text);
        };
        const std::string model = textOf(arv_camera_get_model_name, "camera");
        name_ = fmt::format("{} {}", model, textOf(arv_camera_get_device_serial_number, ""));
    }

    void chooseFormat() {
        guint count = 0;
        Failure failure;
        gint64* offered = arv_camera_dup_available_pixel_formats(camera_.get(), &count, &failure);
        failure.check(name_);
        const std::vector<gint64> formats(offered, offered + count);
        g_free(offered);
        for (const Format& format : kFormats) {
            if (!std::count(formats.begin(), formats.end(), static_cast<gint64>(format.pixels))) continue;
            arv_camera_set_pixel_format(camera_.get(), format.pixels, &failure);
            failure.check(name_);
            return;
        }
        throw CameraLost(name_ + " has no 8-bit format that is known: RGB, Bayer or grey");
    }

    // A sensor larger than the calibrated picture is read from its first pixel.
    void chooseRegion(const CameraOptions& options) {
        if (options.width <= 0 || options.height <= 0) return;
        gint width = 0, height = 0;
        Failure failure;
        arv_camera_get_sensor_size(camera_.get(), &width, &height, &failure);
        failure.check(name_);
        if (width < options.width || height < options.height) return; // the detection says that it is small
        arv_camera_set_region(camera_.get(), 0, 0, options.width, options.height, &failure);
        failure.check(name_);
    }

    std::shared_ptr<const Photograph> convert(ArvBuffer* buffer) const {
        size_t bytes = 0;
        const void* data = arv_buffer_get_data(buffer, &bytes);
        const int width = arv_buffer_get_image_width(buffer), height = arv_buffer_get_image_height(buffer);
        const ArvPixelFormat pixels = arv_buffer_get_image_pixel_format(buffer);
        const auto format = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const Format& f) { return f.pixels == pixels; });
        const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
        if (format == kFormats.end() || bytes < count * static_cast<size_t>(format->channels))
            throw CameraLost(name_ + " sends pictures in another format than was agreed");
        auto photo = std::make_shared<Photograph>();
        photo->width = width, photo->height = height;
        photo->name = name_;
        photo->rgb.resize(3 * count);
        const cv::Mat from(height, width, format->channels == 3 ? CV_8UC3 : CV_8UC1, const_cast<void*>(data));
        cv::Mat to(height, width, CV_8UC3, photo->rgb.data());
        if (format->conversion < 0)
            from.copyTo(to);
        else
            cv::cvtColor(from, to, format->conversion);
        return photo;
    }

    std::unique_ptr<ArvCamera, Unref> camera_;
    std::unique_ptr<ArvStream, Unref> stream_; // goes first
    std::string name_ = "camera";
    std::atomic<bool> lost_ = false;
    std::chrono::steady_clock::time_point lastSeen_;
};

} // namespace

std::unique_ptr<Camera> openAravisCamera(const std::string& id, const CameraOptions& options) {
    return std::make_unique<AravisCamera>(id, options);
}

} // namespace heliodon::vision
