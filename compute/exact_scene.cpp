#include "compute/exact_scene.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "compute/convex_regions.h"
#include "compute/gpu/device.h"
#include "shaders/io/exact_form_factors.io.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

struct Faces {
    dvec3 centre{0}; // subtracted from all corners
    std::vector<glm::vec4> high, low, normal, middle;
    std::vector<glm::uvec4> range;

    // `normal` and the first corner fix the plane; zero area makes a face that faces nothing.
    void add(const std::vector<dvec3>& corners, const dvec3& unitNormal, uint32_t room) {
        range.push_back(
            {static_cast<uint32_t>(high.size()), static_cast<uint32_t>(corners.size()), room, 0u});
        dvec3 area{0}, weighted{0};
        double total = 0;
        for (size_t k = 1; k + 1 < corners.size(); ++k) {
            const dvec3 u = corners[k] - corners[0], v = corners[k + 1] - corners[0],
                        c = 0.5 * glm::cross(u, v);
            area += c;
            weighted += glm::length(c) * (u + v) / 3.0;
            total += glm::length(c);
        }
        const dvec3 middleD = corners[0] + (total > 0 ? weighted / total : dvec3(0));
        double radius = 0;
        for (const dvec3& p : corners) {
            glm::vec3 h, l;
            splitPosition(p - centre, h, l);
            high.emplace_back(h, 0.0f);
            low.emplace_back(l, 0.0f);
            radius = std::max(radius, glm::length(p - middleD));
        }
        normal.emplace_back(glm::vec3(total > 0 ? unitNormal : dvec3(0)), static_cast<float>(total));
        middle.emplace_back(glm::vec3(middleD - corners[0]), static_cast<float>(radius));
    }
};

} // namespace

void splitPosition(const dvec3& relative, glm::vec3& high, glm::vec3& low) {
    for (int c = 0; c < 3; ++c) {
        // Through memory: GCC 12 at -O3 otherwise takes the float back to the double it came from.
        volatile float rounded = static_cast<float>(relative[c]);
        high[c] = rounded;
        low[c] = static_cast<float>(relative[c] - static_cast<double>(rounded));
    }
}

ExactScene exactScene(gpu::Device& device, const geometry::PatchMesh& mesh) {
    ExactScene scene;
    scene.patchCount = static_cast<uint32_t>(mesh.patchCount());
    Faces faces;
    if (!mesh.vertices.empty()) {
        dvec3 lowest = mesh.vertices[0], highest = lowest;
        for (const dvec3& p : mesh.vertices) {
            lowest = glm::min(lowest, p);
            highest = glm::max(highest, p);
        }
        scene.centre = faces.centre = 0.5 * (lowest + highest);
    }
    const auto normalOf = [](const dvec3& areaVector) {
        const double size = glm::length(areaVector);
        return size > 0 ? areaVector / size : dvec3(0);
    };
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        const dvec3 normal = normalOf(geometry::patchAreaVector(mesh, i));
        for (size_t first = 1; first + 1 < corner.size(); first += io::kExactPieceCorners - 2) {
            std::vector<dvec3> corners{mesh.vertices[corner[0]]};
            for (size_t k = first; k < std::min<size_t>(corner.size(), first + io::kExactPieceCorners - 1);
                 ++k)
                corners.push_back(mesh.vertices[corner[k]]);
            scene.mostCorners = std::max(scene.mostCorners, static_cast<uint32_t>(corners.size()));
            faces.add(corners, normal, mesh.room[i]);
            scene.area.push_back(faces.normal.back().w);
            scene.patchOfPiece.push_back(static_cast<uint32_t>(i));
        }
    }
    scene.pieceCount = static_cast<uint32_t>(faces.range.size());
    const std::vector<ConvexRegion> regions = blockingRegions(mesh, io::kExactBlockerCorners);
    for (const ConvexRegion& region : regions) {
        dvec3 areaVector{0};
        for (size_t k = 1; k + 1 < region.corners.size(); ++k)
            areaVector +=
                glm::cross(region.corners[k] - region.corners[0], region.corners[k + 1] - region.corners[0]);
        faces.add(region.corners, normalOf(areaVector), region.room);
    }
    scene.blockerCount = static_cast<uint32_t>(regions.size());
    scene.closed = isClosedSolid(mesh, regions);
    scene.cornerHigh = gpu::Buffer::from(device, faces.high, "exact corners, high");
    scene.cornerLow = gpu::Buffer::from(device, faces.low, "exact corners, low");
    scene.faceNormal = gpu::Buffer::from(device, faces.normal, "exact normals");
    scene.faceCentre = gpu::Buffer::from(device, faces.middle, "exact centres");
    scene.faceRange = gpu::Buffer::from(device, faces.range, "exact ranges");
    return scene;
}

} // namespace heliodon::compute
