// The calibrated devices round the table (`vh-rig/1`): one overhead camera, up to 31 projectors.
// World: metres, right-handed, y up, table top y = 0. Device frame (OpenCV): x right, y down, z forward,
// X_dev = R X_world + t. Pixels: integer = pixel centre, so an image W wide spans [-0.5, W - 0.5].
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>

namespace heliodon::geometry {

// Brown-Conrady lens; a projector is a camera in reverse (ideal ray -> distorted panel pixel).
struct Lens {
    double fx = 1, fy = 1, cx = 0, cy = 0, skew = 0;
    std::array<double, 5> dist{}; // k1 k2 p1 p2 k3

    // Ideal image-plane point (x/z, y/z) to pixel and back. The inverse is iterated to 1e-10 of the image
    // plane; where the lens folds back, as polynomials may towards the corners, there is none, and the point
    // is merely finite.
    glm::dvec2 pixelFromPlane(glm::dvec2 xy) const;
    glm::dvec2 planeFromPixel(glm::dvec2 pixel) const;
};

struct Ray {
    glm::dvec3 origin, direction; // direction has unit length
};

struct OpticalDevice {
    std::string id;
    int width = 0, height = 0;
    Lens lens;
    glm::dmat3 deviceFromWorld{1}; // R; glm is column-major: R[column][row]
    glm::dvec3 translation{};      // t

    glm::dvec3 centre() const;                                        // -R^T t, world metres
    std::optional<glm::dvec2> pixelFromWorld(glm::dvec3 world) const; // none behind the device
    Ray rayFromPixel(glm::dvec2 pixel) const;
    // Where the pixel's ray meets the horizontal plane at height y; none when it is parallel or behind.
    std::optional<glm::dvec3> worldOnPlane(glm::dvec2 pixel, double y) const;
};

struct Projector : OpticalDevice {
    double lumens = 3000;          // all-white output
    double blackLevel = 0;         // fraction of white that leaks when black is sent, 0..1
    std::string response = "srgb"; // transfer function of the input: "srgb", or a gamma as a number
    std::string display;           // output's name for `live`; may be empty
};

struct Site {
    double latitudeDeg = 42.73, longitudeDeg = -73.68; // north, east
};

constexpr size_t kMostProjectors = 31; // with the camera, the bits of a word

struct Rig {
    double tableRadius = 0.5334; // metres
    bool tableAssumed = false;   // the file says nothing of a table: it is taken for the paper's
    OpticalDevice camera;
    std::vector<Projector> projectors; // kMostProjectors at most
    double surfaceReflectance = 0.84;  // of the physical walls and table: white foam core, museum board
    std::optional<Site> site;
    // Not of this format: "projectors[0].lumnes (lumens?)"; outside devices only what may be a misspelling.
    std::vector<std::string> unknownFields;
};

// Throws InputError naming the file and the field ("projectors[1].K"). R must be a rotation within 1e-3; it
// is re-orthonormalised. A lens must not fold back in the middle half of its picture. Unknown fields make no
// difference.
Rig readRig(const std::filesystem::path& file);
// The same of what such a file holds; `file` names it in complaints.
Rig rigOf(const nlohmann::json& document, const std::string& file);

} // namespace heliodon::geometry
