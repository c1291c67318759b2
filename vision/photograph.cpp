#include "vision/photograph.h"

#include <string>
#include <utility>

#include "geometry/input_error.h"
#include "geometry/picture_file.h"
#include "vision/grey_picture.h"

namespace heliodon::vision {

namespace {

// The pixels as the sensor has them: the rig was calibrated on those, so no rotation by EXIF.
template<class Picture>
Picture readOrComplain(std::optional<Picture> (*read)(const std::filesystem::path&),
                       const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        throw geometry::InputError(file.string(), "",
                                   "no such file, expected a photograph (png, jpg or tif)");
    auto picture = read(file);
    if (!picture)
        throw geometry::InputError(file.string(), "",
                                   "not an image that can be read, expected png, jpg or tif");
    return std::move(*picture);
}

} // namespace

Photograph readPhotograph(const std::filesystem::path& file) {
    auto picture = readOrComplain(geometry::readPictureFile, file);
    return {picture.width, picture.height, std::move(picture.rgb), file.string()};
}

GreyPicture readGrey(const std::filesystem::path& file) {
    auto picture = readOrComplain(geometry::readGreyFile, file);
    return {picture.width, picture.height, std::move(picture.values)};
}

} // namespace heliodon::vision
