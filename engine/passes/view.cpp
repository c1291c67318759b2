#include "engine/passes/view.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "engine/passes/tile_mask.h"

namespace heliodon::passes {

namespace {

// Clip space from device space (x right, y down, z forward) for the pixel (fx x + skew y) / z + cx,
// (fy y) / z + cy.
glm::dmat4 clipFromDevice(const geometry::Lens& k, int width, int height, double nearMetres) {
    glm::dmat4 m(0);
    m[0][0] = 2 * k.fx / width;
    m[1][0] = 2 * k.skew / width;
    m[2][0] = 2 * (k.cx + 0.5) / width - 1;
    m[1][1] = 2 * k.fy / height;
    m[2][1] = 2 * (k.cy + 0.5) / height - 1;
    m[3][2] = nearMetres;
    m[2][3] = 1;
    return m;
}

glm::dmat4 rigid(const glm::dmat3& rotation, glm::dvec3 translation) {
    glm::dmat4 m(rotation);
    m[3] = glm::dvec4(translation, 1);
    return m;
}

// For each panel pixel the pixel of a lens without distortion that sees the same. Solved at every eighth
// pixel and interpolated: a lens bends far too little over eight pixels for the difference to reach 1/100
// pixel.
std::vector<glm::vec2> undistortedPixels(const geometry::OpticalDevice& device, const geometry::Lens& ideal) {
    constexpr int kStep = 8;
    const int columns = (device.width - 1) / kStep + 2, rows = (device.height - 1) / kStep + 2;
    std::vector<glm::dvec2> nodes;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            nodes.push_back(ideal.pixelFromPlane(device.lens.planeFromPixel({i * kStep, j * kStep})));
    std::vector<glm::vec2> pixels;
    pixels.reserve(static_cast<size_t>(device.width) * static_cast<size_t>(device.height));
    for (int y = 0; y < device.height; ++y)
        for (int x = 0; x < device.width; ++x) {
            const glm::dvec2* node = &nodes[static_cast<size_t>(y / kStep * columns + x / kStep)];
            const double s = double(x % kStep) / kStep, t = double(y % kStep) / kStep;
            pixels.emplace_back((1 - t) * ((1 - s) * node[0] + s * node[1]) +
                                t * ((1 - s) * node[columns] + s * node[columns + 1]));
        }
    return pixels;
}

// Pinhole pixel of a world point (integer = pixel centre); none behind the eye.
std::optional<glm::dvec2> pinholePixel(const View& view, glm::dvec3 world) {
    const glm::dvec4 clip = view.clipFromWorld * glm::dvec4(world, 1);
    if (clip.w <= 0) return std::nullopt;
    return glm::dvec2((clip.x / clip.w + 1) / 2 * view.width - 0.5,
                      (clip.y / clip.w + 1) / 2 * view.height - 0.5);
}

// What an output pixel reads round its centre, in pinhole pixels.
double reachOf(const View& view) {
    return view.supersample + 1;
}

// The tiles of the pinhole picture in which triangles lie. None where one reaches behind the eye.
std::optional<TileMask> tilesOf(const View& view, std::span<const glm::vec3> corners, int tile,
                                double beside) {
    TileMask mask(view.width, view.height, tile);
    for (size_t i = 0; i + 2 < corners.size(); i += 3) {
        glm::dvec2 low(1e300), high(-1e300);
        for (size_t k = i; k < i + 3; ++k) {
            const auto pixel = pinholePixel(view, glm::dvec3(corners[k]));
            if (!pixel) return std::nullopt;
            low = glm::min(low, *pixel), high = glm::max(high, *pixel);
        }
        mask.mark(low + 0.5 - beside, high + 0.5 + beside);
    }
    return mask;
}

} // namespace

View viewOfDevice(const geometry::OpticalDevice& device, int supersample) {
    constexpr double kNear = 0.02; // metres
    View view;
    view.outputWidth = device.width;
    view.outputHeight = device.height;
    view.supersample = supersample;
    view.eye = device.centre();
    geometry::Lens ideal = device.lens;
    ideal.dist = {};
    view.warp = undistortedPixels(device, ideal);
    glm::dvec2 low(1e30), high(-1e30);
    for (const glm::vec2& p : view.warp) {
        low = glm::min(low, glm::dvec2(p));
        high = glm::max(high, glm::dvec2(p));
    }
    // One and a half pixels on each side: half of the outermost panel pixel, and room for interpolation. A
    // lens that bends beyond reason gets at most twice its panel.
    low = glm::max(low - 1.5, glm::dvec2(-0.5 * device.width, -0.5 * device.height));
    high = glm::min(high + 1.5, glm::dvec2(1.5 * device.width, 1.5 * device.height));
    const glm::dvec2 first = glm::floor(low), size = glm::ceil(high) - first + 1.0;
    const double s = supersample;
    view.width = static_cast<int>(s * size.x);
    view.height = static_cast<int>(s * size.y);
    const auto toPinhole = [&](glm::dvec2 p) { return s * (p - first + 0.5) - 0.5; };
    for (glm::vec2& p : view.warp) p = glm::vec2(toPinhole(glm::dvec2(p)));
    const glm::dvec2 centre = toPinhole({ideal.cx, ideal.cy});
    ideal.fx *= s, ideal.fy *= s, ideal.skew *= s;
    ideal.cx = centre.x, ideal.cy = centre.y;
    view.clipFromWorld = clipFromDevice(ideal, view.width, view.height, kNear) *
                         rigid(device.deviceFromWorld, device.translation);
    view.shown = {0, 0, view.outputWidth, view.outputHeight};
    view.parts = {view.shown};
    return view;
}

void confine(View& view, const std::vector<glm::dvec3>& points) {
    glm::dvec2 low(view.width, view.height), high(-1);
    for (const glm::dvec3& p : points) {
        const auto pixel = pinholePixel(view, p);
        if (!pixel) return; // something behind the eye: its picture has no bounds
        low = glm::min(low, *pixel);
        high = glm::max(high, *pixel);
    }
    // A ring around that stays empty, as wide as what one output pixel reads.
    const double ring = 3.0 * view.supersample + 2;
    const glm::ivec2 first = glm::max(glm::ivec2(glm::floor(low - ring)), glm::ivec2(0));
    const glm::ivec2 end = glm::min(glm::ivec2(glm::ceil(high + ring)), glm::ivec2(view.width, view.height));
    const glm::ivec2 size = glm::max(end - first, glm::ivec2(1));
    glm::ivec2 shownFirst(view.outputWidth, view.outputHeight), shownEnd(0);
    const double reach = reachOf(view);
    for (int y = 0; y < view.outputHeight; ++y)
        for (int x = 0; x < view.outputWidth; ++x) {
            const glm::vec2 at = view.warp[static_cast<size_t>(y * view.outputWidth + x)];
            if (at.x < low.x - reach || at.y < low.y - reach || at.x > high.x + reach ||
                at.y > high.y + reach)
                continue;
            shownFirst = glm::min(shownFirst, glm::ivec2(x, y));
            shownEnd = glm::max(shownEnd, glm::ivec2(x + 1, y + 1));
        }
    const glm::ivec2 shownSize = glm::max(shownEnd - shownFirst, glm::ivec2(0));
    view.shown = {std::min(shownFirst.x, view.outputWidth - 1), std::min(shownFirst.y, view.outputHeight - 1),
                  shownSize.x, shownSize.y};
    view.parts = {view.shown};
    for (glm::vec2& at : view.warp) at -= glm::vec2(first);
    const glm::dvec2 whole(view.width, view.height),
        scale = whole / glm::dvec2(size), shift = (whole - 2.0 * glm::dvec2(first)) / glm::dvec2(size) - 1.0;
    glm::dmat4 cut(1);
    cut[0][0] = scale.x, cut[1][1] = scale.y;
    cut[3][0] = shift.x, cut[3][1] = shift.y;
    view.clipFromWorld = cut * view.clipFromWorld;
    view.width = size.x, view.height = size.y;
}

std::vector<PixelRect> placesOf(const View& view, std::span<const glm::vec3> corners, int tile,
                                double beside) {
    const std::optional<TileMask> mask = tilesOf(view, corners, tile, beside);
    if (!mask) return {{0, 0, view.width, view.height}};
    return mask->rectangles();
}

void confineParts(View& view, std::span<const glm::vec3> corners) {
    constexpr int kTile = 16;
    const std::optional<TileMask> drawn = tilesOf(view, corners, kTile, reachOf(view));
    if (!drawn) return;
    TileMask shown(view.shown.width, view.shown.height, kTile);
    for (int y = 0; y < view.shown.height; ++y)
        for (int x = 0; x < view.shown.width; ++x) {
            const int pixel = (view.shown.y + y) * view.outputWidth + view.shown.x + x;
            const glm::dvec2 at(view.warp[static_cast<size_t>(pixel)]);
            if (drawn->touches(at + 0.5, at + 0.5)) shown.mark(glm::dvec2(x, y), glm::dvec2(x, y));
        }
    view.parts = shown.rectangles();
    for (PixelRect& part : view.parts) part.x += view.shown.x, part.y += view.shown.y;
    if (view.parts.empty()) view.shown.width = view.shown.height = 0;
}

View viewOfCamera(const PerspectiveCamera& camera, int width, int height, int supersample) {
    View view;
    view.outputWidth = width;
    view.outputHeight = height;
    view.supersample = supersample;
    view.width = width * supersample;
    view.height = height * supersample;
    view.shown = {0, 0, width, height};
    view.parts = {view.shown};
    view.eye = camera.eye;
    const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 up = std::abs(forward.y) > 0.9999 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, up)), down = glm::cross(forward, right);
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, down, forward));
    geometry::Lens lens;
    lens.fx = lens.fy = 0.5 * view.height / std::tan(glm::radians(camera.fovDegrees) / 2);
    lens.cx = 0.5 * view.width - 0.5;
    lens.cy = 0.5 * view.height - 0.5;
    const double nearMetres = 0.02 * glm::length(camera.target - camera.eye);
    view.clipFromWorld =
        clipFromDevice(lens, view.width, view.height, nearMetres) * rigid(rotation, -(rotation * camera.eye));
    return view;
}

PerspectiveCamera frameAll(const std::vector<glm::dvec3>& points, double azimuthDegrees,
                           double elevationDegrees, double fovDegrees, double aspect, double margin) {
    const double azimuth = glm::radians(azimuthDegrees), elevation = glm::radians(elevationDegrees);
    const glm::dvec3 towardsEye(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                std::cos(elevation) * std::cos(azimuth));
    const glm::dvec3 forward = -towardsEye;
    const glm::dvec3 up = std::abs(forward.y) > 0.9999 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, up)), top = glm::cross(right, forward);
    const double slopeY = (1 - 2 * margin) * std::tan(glm::radians(fovDegrees) / 2), slopeX = slopeY * aspect;
    // A point (x, y, z) along (right, top, forward) is inside when |x - ex| <= slopeX (z - ez), likewise y:
    // the outermost planes of each direction give the eye.
    double left = 1e300, rightmost = -1e300, bottom = 1e300, topmost = -1e300;
    for (const glm::dvec3& p : points) {
        const double x = glm::dot(p, right), y = glm::dot(p, top), z = glm::dot(p, forward);
        left = std::min(left, x + slopeX * z);
        rightmost = std::max(rightmost, x - slopeX * z);
        bottom = std::min(bottom, y + slopeY * z);
        topmost = std::max(topmost, y - slopeY * z);
    }
    PerspectiveCamera camera;
    camera.fovDegrees = fovDegrees;
    if (points.empty()) return camera;
    const double ex = (left + rightmost) / 2, ey = (bottom + topmost) / 2;
    const double ez = std::min((left - rightmost) / (2 * slopeX), (bottom - topmost) / (2 * slopeY));
    camera.eye = ex * right + ey * top + ez * forward;
    glm::dvec3 middle{0};
    for (const glm::dvec3& p : points) middle += p / static_cast<double>(points.size());
    camera.target = camera.eye + std::max(glm::dot(middle - camera.eye, forward), 1e-6) * forward;
    return camera;
}

} // namespace heliodon::passes
