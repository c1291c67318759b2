// A GigE Vision camera on the loopback network, imitated by Aravis.
#pragma once

#include <algorithm>

#include <arv.h>

#include "vision/photograph.h"

namespace heliodon::vision {

// Serves one picture as a GigE Vision camera at 127.0.0.1.
class ImitatedCamera {
public:
    explicit ImitatedCamera(Photograph photo) : photo_(std::move(photo)) {
        camera_ = arv_gv_fake_camera_new("127.0.0.1", "GV01");
        arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_), fill, this);
    }
    ~ImitatedCamera() { g_object_unref(camera_); }
    bool runs() const { return arv_gv_fake_camera_is_running(camera_); }

private:
    static void fill(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat format) {
        const Photograph& photo = static_cast<ImitatedCamera*>(self)->photo_;
        size_t unknown = 0;
        auto* to = static_cast<uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &unknown)));
        const int width = std::min(arv_buffer_get_image_width(buffer), photo.width),
                  height = std::min(arv_buffer_get_image_height(buffer), photo.height);
        if (format != ARV_PIXEL_FORMAT_RGB_8_PACKED) return;
        for (int y = 0; y < height; ++y)
            std::copy_n(&photo.rgb[static_cast<size_t>(3 * y * photo.width)], 3 * width,
                        to + static_cast<ptrdiff_t>(3 * y * arv_buffer_get_image_width(buffer)));
    }

    Photograph photo_;
    ArvGvFakeCamera* camera_;
};

} // namespace heliodon::vision
