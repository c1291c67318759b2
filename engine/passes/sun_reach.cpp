#include "engine/passes/sun_reach.h"

#include <algorithm>
#include <array>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::passes {

namespace {

constexpr int kTiles = 256; // each way

} // namespace

SunPlane::SunPlane(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun)
    : across_(geometry::perpendicular(towardsSun)), up_(glm::cross(towardsSun, across_)),
      mask_(kTiles, kTiles, 1) {
    glm::dvec2 low(1e300), high(-1e300);
    for (const glm::dvec3& p : mesh.vertices) {
        const glm::dvec2 q(glm::dot(across_, p), glm::dot(up_, p));
        low = glm::min(low, q), high = glm::max(high, q);
    }
    if (mesh.vertices.empty()) return;
    perTile_ = std::max({high.x - low.x, high.y - low.y, 1e-9}) / (kTiles - 4);
    low_ = low - 2 * perTile_; // so that what is a little larger lies within
}

SunPlane::Box SunPlane::boxOf(std::span<const glm::vec3> points) const {
    Box box{glm::dvec2(1e300), glm::dvec2(-1e300)};
    for (const glm::vec3& point : points) {
        const glm::dvec3 p(point);
        const glm::dvec2 q = (glm::dvec2(glm::dot(across_, p), glm::dot(up_, p)) - low_) / perTile_;
        box.low = glm::min(box.low, q), box.high = glm::max(box.high, q);
    }
    constexpr double kBeside = 0.25;
    return {box.low - kBeside, box.high + kBeside};
}

void SunPlane::mark(std::span<const glm::vec3> points) {
    const Box box = boxOf(points);
    mask_.mark(box.low, box.high);
}

bool SunPlane::touches(std::span<const glm::vec3> points) const {
    const Box box = boxOf(points);
    return mask_.touches(box.low, box.high);
}

SunReach sunReach(const geometry::PatchMesh& mesh, const DrawMesh& drawn, glm::dvec3 towardsSun,
                  bool closed) {
    SunPlane panes(mesh, towardsSun);
    SunReach reach{{}, panes};
    std::vector<glm::vec3> outline;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        if (!mesh.materials[mesh.material[p]].isOpening()) continue;
        outline.clear();
        for (const uint32_t corner : mesh.patch(p)) outline.emplace_back(mesh.vertices[corner]);
        panes.mark(outline);
    }
    for (uint32_t c = 0; c < drawn.corners.size(); c += 3) {
        if (glm::dot(glm::dvec3(drawn.corners[c].normal), towardsSun) <= -1e-6) continue;
        const std::array<glm::vec3, 3> triangle{
            drawn.corners[c].position, drawn.corners[c + 1].position, drawn.corners[c + 2].position};
        if (closed && !panes.touches(triangle)) continue;
        reach.corners.insert(reach.corners.end(), {c, c + 1, c + 2});
        reach.plane.mark(triangle);
    }
    return reach;
}

} // namespace heliodon::passes
