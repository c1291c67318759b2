// GenICam cameras (GigE Vision, USB3 Vision) through Aravis. Internal to vision: openCamera is the way in.
#pragma once

#include <memory>
#include <string>

#include "vision/camera.h"

namespace heliodon::vision {

// `id` empty: the first camera found; one that starts with "Fake": Aravis' own imitation. The camera keeps
// its exposure and gain; colour formats are preferred to mosaics, and these to grey.
std::unique_ptr<Camera> openAravisCamera(const std::string& id, const CameraOptions& options);

} // namespace heliodon::vision
