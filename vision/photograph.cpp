#include "vision/photograph.h"

#include <string>
#include <utility>

#include "geometry/input_error.h"
#include "geometry/picture_file.h"

namespace heliodon::vision {

Photograph readPhotograph(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        throw geometry::InputError(file.string(), "",
                                   "no such file, expected a photograph (png, jpg or tif)");
    // The pixels as the sensor has them: the rig was calibrated on those, so no rotation by EXIF.
    auto picture = geometry::readPictureFile(file);
    if (!picture)
        throw geometry::InputError(file.string(), "",
                                   "not an image that can be read, expected png, jpg or tif");
    return {picture->width, picture->height, std::move(picture->rgb), file.string()};
}

} // namespace heliodon::vision
