#include "compute/hemicube.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "compute/daylight/glazing.h"
#include "compute/daylight/sky_patches.h"
#include "compute/gpu/device.h"
#include "compute/texel.h"
#include "geometry/bounds.h"
#include "geometry/perpendicular.h"
#include "shaders/io/fixed_to_float.io.h"
#include "spirv/fixed_to_float_comp.h"
#include "spirv/hemicube_comp.h"
#include "spirv/hemicube_sum_comp.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;

// Form factor from a point to a rectangle that starts over the axis, at unit distance: parallel, and upright
// with its foot in the point's plane (Howell's catalogue, B-3 and B-4).
double parallelCorner(double a, double b) {
    const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * kPi);
}
double uprightCorner(double y, double z) {
    const double r = std::sqrt(1 + z * z);
    return (std::atan(y) - std::atan(y / r) / r) / (2 * kPi);
}

// Barycentric centroids of a regular subdivision into m^2 triangles: equal weights, so that the device sums
// in one scale.
std::vector<glm::dvec3> trianglePoints(uint32_t m) {
    std::vector<glm::dvec3> result;
    for (uint32_t i = 0; i < m; ++i)
        for (uint32_t j = 0; i + j < m; ++j) {
            const double u = (i + 1. / 3) / m, v = (j + 1. / 3) / m;
            result.push_back({1 - u - v, u, v});
            if (i + j + 1 < m) {
                const double p = (i + 2. / 3) / m, q = (j + 2. / 3) / m;
                result.push_back({1 - p - q, p, q});
            }
        }
    return result;
}

// m^2 points of about equal weight: triangles and quads by their own grid, other polygons corner by corner.
std::vector<glm::dvec3> pointsOnPatch(const geometry::PatchMesh& mesh, size_t patch, uint32_t m) {
    const auto corners = mesh.patch(patch);
    const auto corner = [&](size_t k) { return mesh.vertices[corners[k % corners.size()]]; };
    const glm::dvec3 middle = geometry::patchCentroid(mesh, patch);
    if (m <= 1) return {middle};
    std::vector<glm::dvec3> result;
    if (corners.size() == 4) {
        for (uint32_t i = 0; i < m * m; ++i) {
            const double u = (i % m + 0.5) / m, v = (i / m + 0.5) / m;
            result.push_back((1 - v) * ((1 - u) * corner(0) + u * corner(1)) +
                             v * ((1 - u) * corner(3) + u * corner(2)));
        }
        return result;
    }
    const std::vector<glm::dvec3> pattern = trianglePoints(m);
    for (size_t k = 0; k < pattern.size(); ++k) {
        const glm::dvec3 w = pattern[k];
        result.push_back(corners.size() == 3 ? w.x * corner(0) + w.y * corner(1) + w.z * corner(2)
                                             : w.x * middle + w.y * corner(k) + w.z * corner(k + 1));
    }
    return result;
}

} // namespace

std::vector<double> hemicubeDeltas(uint32_t R) {
    std::vector<double> deltas(size_t{R} * R + size_t{R} * (R / 2));
    const auto at = [&](uint32_t i) { return 2.0 * i / R; };
    const auto difference = [&](auto corner, double x0, double x1, double y0, double y1) {
        return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
    };
    for (uint32_t j = 0; j < R; ++j)
        for (uint32_t i = 0; i < R; ++i)
            deltas[size_t{j} * R + i] =
                difference(parallelCorner, at(i) - 1, at(i + 1) - 1, at(j) - 1, at(j + 1) - 1);
    for (uint32_t j = 0; j < R / 2; ++j)
        for (uint32_t i = 0; i < R; ++i)
            deltas[size_t{R} * R + size_t{j} * R + i] =
                difference(uprightCorner, at(i) - 1, at(i + 1) - 1, at(j), at(j + 1));
    return deltas;
}

PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points) {
    return patchViewpoints(mesh, points, 0, static_cast<uint32_t>(mesh.patchCount()));
}

PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points, uint32_t first,
                                uint32_t count) {
    const auto m = static_cast<uint32_t>(std::ceil(std::sqrt(std::max(points, 1u))));
    PatchViewpoints result;
    result.pointsPerPatch = m * m;
    result.viewpoints.reserve(size_t{count} * m * m);
    size_t number = size_t{first} * m * m;
    for (size_t i = first; i < size_t{first} + count; ++i) {
        Viewpoint view;
        view.normal = geometry::patchNormal(mesh, i);
        view.patch = static_cast<uint32_t>(i);
        view.room = mesh.room[i];
        for (const glm::dvec3& position : pointsOnPatch(mesh, i, m)) {
            view.position = position;
            // Golden-ratio turns: grids that line up with the walls would alias all in the same way. None is
            // zero, where edges run through the middles of pixels, and rounding would say who has them.
            view.turn = std::fmod(0.6180339887498949 * static_cast<double>(++number), 1.0) * (kPi / 2);
            result.viewpoints.push_back(view);
        }
    }
    return result;
}

Hemicube::Hemicube(gpu::Device& device, const geometry::PatchMesh& mesh, const HemicubeOptions& options)
    : device_(&device), options_(options), toFloat_(device, fixed_to_float_comp, "fixed to float") {
    options_.resolution = std::max(2u, (options.resolution + 1) / 2 * 2);
    uploadMesh(mesh);
    const uint32_t R = options_.resolution;
    raster_ = gpu::Kernel(device, hemicube_comp, "hemicube raster");
    sum_ = gpu::Kernel(device, hemicube_sum_comp, "hemicube sum",
                       {{"kSky", skyElements_ > 0 ? 1u : 0u}, {"kChannels", channels_}});
    // About three layers of triangles cover the pixels; a lane should have no more than some 256 of them to
    // fill.
    params_.stripes = std::clamp(9 * R * R / (256 * std::max(params_.triangleCount, 1u)), 1u, R);
    const size_t pixels = size_t{3} * R * R;
    params_.listLength = static_cast<uint32_t>(
        std::max(size_t{10} * params_.triangleCount * params_.stripes, skyElements_ > 0 ? pixels : 2));
    // Buffers for each viewpoint of a dispatch: few on a CPU, which wants them in its cache.
    const size_t largest = std::max(pixels, size_t{params_.listLength}) * sizeof(uint32_t);
    const size_t most = std::min<size_t>(device.limits().maxStorageBufferRange / largest,
                                         device.limits().maxTexelBufferElements / pixels);
    batch_ = static_cast<uint32_t>(
        std::clamp<size_t>(most, 1, device.info().type == "software" ? 64 : 1024));
    items_ = gpu::Buffer(device, pixels * batch_ * sizeof(uint32_t), "hemicube items");
    lists_ = gpu::Buffer(device, size_t{params_.listLength} * batch_ * sizeof(uint32_t), "hemicube lists");
    params_.resolution = R;
    params_.skyElements = skyElements_;
    params_.skyDivision = options_.skyDivision;
}

void Hemicube::uploadMesh(const geometry::PatchMesh& mesh) {
    const size_t n = mesh.patchCount();
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    centre_ = box.centre();
    const double diagonal = std::max(box.diagonal(), 1e-30);

    std::vector<glm::uvec4> triangles, openings;
    for (size_t i = 0; i < n; ++i) {
        const auto corners = mesh.patch(i);
        const auto patch = static_cast<uint32_t>(i);
        const bool opening =
            mesh.twin[i] == geometry::kNoTwin && mesh.materials[mesh.material[i]].isOpening();
        for (size_t k = 1; k + 1 < corners.size(); ++k) {
            triangles.push_back(texelOf(mesh.vertices[corners[0]] - centre_, patch));
            triangles.push_back(texelOf(mesh.vertices[corners[k]] - centre_, mesh.room[i]));
            triangles.push_back(texelOf(mesh.vertices[corners[k + 1]] - centre_, opening ? 1 : 0));
        }
        hasOpenings_ |= opening;
        openings.push_back(texelOf(geometry::patchNormal(mesh, i), mesh.material[i]));
    }
    std::vector<glm::vec4> glazings;
    for (const geometry::Material& m : mesh.materials) {
        const daylight::Glazing glazing = daylight::glazingOf(m);
        glazings.push_back(
            glm::vec4(glm::vec3(glazing.transmissivity), glazing.isHole() ? 1.0 : glazing.refractiveIndex));
        if (m.transmittance.x != m.transmittance.y || m.transmittance.y != m.transmittance.z) channels_ = 3;
    }
    triangles_ = gpu::Buffer::from(*device_, triangles, "hemicube triangles");
    openings_ = gpu::Buffer::from(*device_, openings, "hemicube openings");
    glazings_ = gpu::Buffer::from(*device_, glazings, "hemicube glazings");
    if (hasOpenings_ && options_.skyDivision > 0)
        skyElements_ = static_cast<uint32_t>(
            daylight::SkyPatches(static_cast<int>(options_.skyDivision)).elementCount());

    params_.triangleCount = static_cast<uint32_t>(triangles.size() / 3);
    params_.patchCount = static_cast<uint32_t>(n);
    params_.idBits = static_cast<uint32_t>(std::bit_width(4 * n));
    const double steps = std::min(std::exp2(32.0 - params_.idBits), 16777216.0) - 4;
    params_.depthScale = static_cast<float>(steps / diagonal);
    params_.flatness = static_cast<float>(1e-6 * diagonal);
}

gpu::Buffer Hemicube::uploadViewpoints(const std::vector<Viewpoint>& viewpoints) {
    std::vector<glm::uvec4> texels;
    texels.reserve(3 * viewpoints.size());
    for (const Viewpoint& v : viewpoints) {
        const glm::dvec3 u = geometry::perpendicular(v.normal), w = glm::cross(v.normal, u);
        texels.push_back(texelOf(v.position - centre_, v.patch));
        texels.push_back(texelOf(v.normal, v.room));
        texels.push_back(texelOf(std::cos(v.turn) * u + std::sin(v.turn) * w, 0));
    }
    return gpu::Buffer::from(*device_, texels, "hemicube viewpoints");
}

void Hemicube::makeDeltas(uint32_t points) {
    if (points == deltaPoints_) return;
    deltaPoints_ = points;
    const double one = static_cast<double>(1u << io::kHemicubeOneBits) / points;
    // Rounded along a running sum, so that the whole hemicube adds up to one.
    std::vector<uint32_t> fixed;
    double exact = 0, given = 0;
    for (double delta : hemicubeDeltas(options_.resolution)) {
        exact += delta * one;
        fixed.push_back(static_cast<uint32_t>(std::llround(exact - given)));
        given += fixed.back();
    }
    deltas_ = gpu::Buffer::from(*device_, fixed, "hemicube deltas");
}

void Hemicube::record(gpu::Commands& commands, const Inputs& in, const gpu::Binding& factors,
                      const gpu::Binding& sky) {
    constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT;
    io::HemicubeParams params = params_;
    params.firstViewpoint = in.firstOfWindow + in.first;
    params.pointsPerRow = in.pointsPerRow;
    params.viewpointInRow = in.first;
    commands.barrier(gpu::Stage::any, gpu::Stage::any); // the last batch is done with items and lists
    commands.fill(items_, 0xffffffffu);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    commands.dispatch(raster_,
                      {gpu::texel(triangles_, kUvec4), gpu::texel(in.viewpoints, kUvec4), lists_, items_},
                      params, in.count);
    commands.barrier(gpu::Stage::compute, gpu::Stage::compute); // items, lists
    commands.dispatch(sum_,
                      {gpu::texel(in.viewpoints, kUvec4), gpu::texel(deltas_, VK_FORMAT_R32_UINT),
                       gpu::texel(items_, VK_FORMAT_R32_UINT), gpu::texel(openings_, kUvec4),
                       gpu::texel(glazings_, VK_FORMAT_R32G32B32A32_SFLOAT), lists_, factors, sky},
                      params, in.count);
}

void Hemicube::recordToFloat(gpu::Commands& commands, const gpu::Buffer& buffer, size_t offset,
                             size_t bytes) {
    if (bytes == 0) return;
    const auto count = static_cast<uint32_t>(bytes / sizeof(uint32_t));
    const io::FixedToFloatParams params{count, 1.0f / static_cast<float>(1u << io::kHemicubeOneBits)};
    commands.dispatch(toFloat_, {gpu::part(buffer, offset, bytes)}, params,
                      gpu::groupsFor(count, io::kFixedToFloatGroup * io::kFixedToFloatEach));
}

Hemicube::Result Hemicube::run(const std::vector<Viewpoint>& viewpoints, uint32_t points) {
    Result result;
    result.rows = static_cast<uint32_t>(viewpoints.size() / points);
    const size_t factorRow = size_t{params_.patchCount} * sizeof(float);
    const size_t skyRow = size_t{skyElements_} * channels_ * sizeof(float);
    result.factors = gpu::Buffer(*device_, result.rows * factorRow, "form factors");
    result.sky = gpu::Buffer(*device_, result.rows * skyRow, "sky coefficients");
    if (result.rows == 0 || params_.patchCount == 0) return result;
    makeDeltas(points);
    const gpu::Buffer views = uploadViewpoints(viewpoints);
    // Rows of a window: a multiple of 64, so that every window starts on the device's alignment (at most 256
    // bytes).
    const size_t largest = device_->limits().maxStorageBufferRange / std::max<size_t>({factorRow, skyRow, 1});
    const auto window =
        static_cast<uint32_t>(std::max<size_t>(64, std::min<size_t>(largest, 1024) / 64 * 64));
    for (uint32_t first = 0; first < result.rows; first += window) {
        const uint32_t rows = std::min(window, result.rows - first);
        const auto part = [&](const gpu::Buffer& buffer, size_t rowBytes) {
            return rowBytes > 0 ? gpu::part(buffer, first * rowBytes, rows * rowBytes) : gpu::Binding(buffer);
        };
        gpu::Commands commands(*device_);
        commands.fill(result.factors, 0, first * factorRow, rows * factorRow);
        if (skyRow > 0) commands.fill(result.sky, 0, first * skyRow, rows * skyRow);
        // Batches of one window share its rows: a row's points may be split between two of them.
        for (uint32_t at = 0; at < rows * points; at += batch_)
            record(commands, {views, first * points, at, std::min(batch_, rows * points - at), points},
                   part(result.factors, factorRow), part(result.sky, skyRow));
        commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
        recordToFloat(commands, result.factors, first * factorRow, rows * factorRow);
        recordToFloat(commands, result.sky, first * skyRow, rows * skyRow);
        commands.barrier(gpu::Stage::compute, gpu::Stage::any);
        device_->submitAndWait(std::move(commands));
    }
    return result;
}

} // namespace heliodon::compute
