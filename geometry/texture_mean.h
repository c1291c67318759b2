// What a textured surface reflects, as one colour.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// Per linear Rec. 709 channel the mean over all of a picture (a file's bytes, in sRGB), wherever its parts
// lie on the faces. None where it is no whole PNG, JPEG or TIFF, or nothing is there that reads them.
std::optional<glm::vec3> textureMean(const std::vector<uint8_t>& picture);

// R"(material "brick": a reflectance of 0.42 0.31 0.25 was taken, with the mean of map_Kd)".
std::string textureTaken(const std::string& material, glm::vec3 reflectance, const std::string& texture);

} // namespace heliodon::geometry
