#include "compute/hemicube.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "compute/closed_solid.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/gpu/kernel.h"
#include "compute/texel.h"
#include "geometry/bounds.h"
#include "geometry/perpendicular.h"
#include "shaders/io/fixed_to_float.io.h"
#include "spirv/fixed_to_float_comp.h"
#include "spirv/hemicube_comp.h"
#include "spirv/hemicube_lists_comp.h"
#include "spirv/hemicube_sum_comp.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kFewTurns = 16384; // of an invocation's loops, far below shaders/lib/loop_limit.glsl

struct HemicubeKernel {
    std::span<const uint32_t> spirv;
    const char* name;
    const gpu::Kernel& of(gpu::Device& device) const { return device.kernels().get(spirv, name); }
};
const HemicubeKernel kLists{hemicube_lists_comp, "hemicube lists"}, kRaster{hemicube_comp, "hemicube raster"},
    kSum{hemicube_sum_comp, "hemicube sum"}, kToFloat{fixed_to_float_comp, "fixed to float"};

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

Hemicube::Hemicube(gpu::Device& device, const geometry::PatchMesh& mesh, const HemicubeOptions& options)
    : device_(&device), options_(options) {
    for (const HemicubeKernel& kernel : {kLists, kRaster, kSum, kToFloat})
        device.kernels().prepare(kernel.spirv, kernel.name);
    options_.resolution = std::max(2u, (options.resolution + 1) / 2 * 2);
    uploadMesh(mesh);
    const uint32_t R = options_.resolution;
    // About three layers of triangles cover the pixels; a lane should have no more than some 256 of them to
    // fill.
    const size_t pixels = size_t{3} * R * R;
    params_.stripeBits = static_cast<uint32_t>(
        std::bit_width(std::clamp<size_t>(3 * pixels / (256 * std::max(params_.triangleCount, 1u)), 1, R)) -
        1);
    params_.listLength = std::max(10 * params_.triangleCount, 2u);
    rasterParts_ = gpu::groupsFor(3 * pixels, io::kHemicubeGroup * kFewTurns);
    sumParts_ = gpu::groupsFor(pixels, io::kHemicubeGroup * kFewTurns);
    // Buffers for each viewpoint of a dispatch: few on a CPU, which wants them in its caches.
    const size_t largest = std::max(pixels, size_t{params_.listLength}) * sizeof(uint32_t);
    const size_t most = std::min<size_t>(device.limits().maxStorageBufferRange / largest,
                                         device.limits().maxTexelBufferElements * size_t{2} / pixels);
    batch_ = static_cast<uint32_t>(std::clamp<size_t>(most, 1, device.info().type == "software" ? 16 : 1024));
    items_ = gpu::Buffer(device, pixels * batch_ * sizeof(uint32_t), "hemicube items");
    lists_ = gpu::Buffer(device, size_t{params_.listLength} * batch_ * sizeof(uint32_t), "hemicube lists");
    cuts_ = gpu::Counters(device, 1, "hemicube cuts");
    counts_ = gpu::Buffer(device, io::kHemicubeSizes * batch_ * sizeof(uint32_t), "hemicube counts");
    params_.resolution = R;
}

void Hemicube::uploadMesh(const geometry::PatchMesh& mesh) {
    const size_t n = mesh.patchCount();
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    centre_ = box.centre();
    const double diagonal = std::max(box.diagonal(), 1e-30);

    std::vector<glm::uvec4> triangles;
    for (size_t i = 0; i < n; ++i) {
        const auto corners = mesh.patch(i);
        const auto patch = static_cast<uint32_t>(i);
        for (size_t k = 1; k + 1 < corners.size(); ++k) {
            triangles.push_back(texelOf(mesh.vertices[corners[0]] - centre_, patch));
            triangles.push_back(texelOf(mesh.vertices[corners[k]] - centre_, mesh.room[i]));
            triangles.push_back(texelOf(mesh.vertices[corners[k + 1]] - centre_, 0));
        }
    }
    triangles_ = gpu::Buffer::from(*device_, triangles, "hemicube triangles");

    params_.triangleCount = static_cast<uint32_t>(triangles.size() / 3);
    params_.patchCount = static_cast<uint32_t>(n);
    params_.idBits = static_cast<uint32_t>(std::bit_width(2 * n));
    const double steps = std::min(std::exp2(32.0 - params_.idBits), 16777216.0) - 4;
    params_.depthScale = static_cast<float>(steps / diagonal);
    params_.flatness = static_cast<float>(1e-6 * diagonal);
    params_.frontsOnly = onlyFrontsBlock(mesh) ? 1 : 0;
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

void Hemicube::record(gpu::Commands& commands, const Inputs& in, const gpu::Binding& factors) {
    constexpr VkFormat kUvec2 = VK_FORMAT_R32G32_UINT, kUvec4 = VK_FORMAT_R32G32B32A32_UINT;
    const gpu::Binding triangles = gpu::texel(triangles_, kUvec4),
                       viewpoints = gpu::texel(in.viewpoints, kUvec4);
    io::HemicubeParams params = params_;
    params.firstViewpoint = in.firstOfWindow + in.first;
    params.pointsPerRow = in.pointsPerRow;
    params.viewpointInRow = in.first;
    commands.barrier(gpu::Stage::any, gpu::Stage::any); // the last batch is done with items and lists
    commands.fill(items_, 0xffffffffu);
    commands.fill(counts_, 0);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    commands.dispatch(kLists.of(*device_), {triangles, viewpoints, lists_, counts_}, params, in.count);
    commands.barrier(gpu::Stage::compute, gpu::Stage::compute); // lists, counts
    commands.dispatch(kRaster.of(*device_), {triangles, viewpoints, lists_, counts_, items_, cuts_.buffer()},
                      params, rasterParts_, in.count);
    commands.barrier(gpu::Stage::compute, gpu::Stage::compute); // items
    commands.dispatch(kSum.of(*device_), {gpu::texel(deltas_, kUvec2), gpu::texel(items_, kUvec2), factors},
                      params, sumParts_, in.count);
}

void Hemicube::shareMore() {
    const uint32_t most = device_->limits().maxComputeWorkGroupCount[0];
    if (rasterParts_ == most)
        throw gpu::Error("hemicubes: the device ends loops early, however short they are");
    params_.stripeBits =
        std::min(params_.stripeBits + 2, static_cast<uint32_t>(std::bit_width(options_.resolution)) - 1);
    rasterParts_ = std::min(4 * rasterParts_, most);
}

Hemicube::Result Hemicube::run(const std::vector<Viewpoint>& viewpoints, uint32_t points) {
    Result result;
    result.rows = static_cast<uint32_t>(viewpoints.size() / points);
    const size_t factorRow = size_t{params_.patchCount} * sizeof(float);
    result.factors = gpu::Buffer(*device_, result.rows * factorRow, "form factors");
    if (result.rows == 0 || params_.patchCount == 0) return result;
    makeDeltas(points);
    const gpu::Buffer views = uploadViewpoints(viewpoints);
    // Rows of a window: a multiple of 64, so that every window starts on the device's alignment (at most 256
    // bytes), of entries that one dispatch turns into floats.
    const VkPhysicalDeviceLimits& limits = device_->limits();
    const size_t most = std::min<size_t>(limits.maxStorageBufferRange,
                                         size_t{limits.maxComputeWorkGroupCount[0]} * io::kFixedToFloatGroup *
                                             io::kFixedToFloatEach * 4);
    const auto window =
        static_cast<uint32_t>(std::max<size_t>(64, std::min<size_t>(most / factorRow, 1024) / 64 * 64));
    for (uint32_t first = 0; first < result.rows;) {
        const uint32_t rows = std::min(window, result.rows - first);
        const gpu::Binding part = gpu::part(result.factors, first * factorRow, rows * factorRow);
        gpu::Commands commands(*device_);
        commands.fill(result.factors, 0, first * factorRow, rows * factorRow);
        cuts_.clear(commands);
        // Batches of one window share its rows: a row's points may be split between two of them.
        for (uint32_t at = 0; at < rows * points; at += batch_)
            record(commands, {views, first * points, at, std::min(batch_, rows * points - at), points}, part);
        commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
        const uint32_t count = rows * params_.patchCount;
        const io::FixedToFloatParams toFloat{count, 1.0f / static_cast<float>(1u << io::kHemicubeOneBits)};
        commands.dispatch(kToFloat.of(*device_), {part}, toFloat,
                          gpu::groupsFor(count, io::kFixedToFloatGroup * io::kFixedToFloatEach));
        cuts_.submitAndRead(std::move(commands));
        if (cuts_[0] == 0)
            first += window;
        else
            shareMore(); // and again
    }
    return result;
}

} // namespace heliodon::compute
