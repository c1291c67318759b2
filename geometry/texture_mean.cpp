#include "geometry/texture_mean.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "geometry/picture_file.h"
#include "geometry/srgb.h"

namespace heliodon::geometry {

std::optional<glm::vec3> textureMean(const std::vector<uint8_t>& picture) {
    std::optional<PicturePixels> pixels;
    try {
        if (!jpegDamageIn(picture)) pixels = pictureIn(picture);
    } catch (const std::runtime_error&) { // the module that reads them is missing
    }
    if (!pixels || pixels->rgb.empty()) return std::nullopt;
    std::array<double, 256> linear{};
    for (size_t value = 0; value < linear.size(); ++value)
        linear[value] = linearOfSrgb(static_cast<double>(value));
    glm::dvec3 sum(0);
    for (size_t i = 0; i < pixels->rgb.size(); i += 3)
        sum += glm::dvec3(linear[pixels->rgb[i]], linear[pixels->rgb[i + 1]], linear[pixels->rgb[i + 2]]);
    return glm::vec3(sum * (3.0 / static_cast<double>(pixels->rgb.size())));
}

std::string textureTaken(const std::string& material, glm::vec3 reflectance, const std::string& texture) {
    return fmt::format(
        "material \"{}\": a reflectance of {:.2f} {:.2f} {:.2f} was taken, with the mean of {}", material,
        reflectance.x, reflectance.y, reflectance.z, texture);
}

} // namespace heliodon::geometry
