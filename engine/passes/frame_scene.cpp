#include "engine/passes/frame_scene.h"

#include <cmath>
#include <utility>

#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"

namespace heliodon::passes {

namespace {

std::vector<DrawCorner> facingUp(const std::vector<DrawCorner>& corners, bool up) {
    std::vector<DrawCorner> out;
    for (size_t i = 0; i < corners.size(); i += 3)
        if ((corners[i].normal.y > 0.7f) == up)
            out.insert(out.end(), corners.begin() + static_cast<long>(i),
                       corners.begin() + static_cast<long>(i) + 3);
    return out;
}

// Of wall tops, what no surface of the model covers, such as the top of a partition: that is drawn with its
// light, and a copy beneath it would show through where the edges of both, whose corners lie at different
// places, meet pixels differently.
std::vector<DrawCorner> uncovered(const std::vector<DrawCorner>& tops, const geometry::PatchMesh& mesh) {
    constexpr double kSame = 1e-6;  // metres
    constexpr double kLeast = 1e-4; // of a triangle: what rounding leaves of a covered one
    using Outline = std::vector<glm::dvec3>;
    const auto side = [](glm::dvec3 a, glm::dvec3 b) { // of the line from a to b, seen from above: its left
        return [=](glm::dvec3 p) { return (b.z - a.z) * (p.x - a.x) - (b.x - a.x) * (p.z - a.z); };
    };
    const auto area = [](const Outline& outline) { return glm::length(geometry::areaVector(outline)) / 2; };
    std::vector<size_t> level;
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (geometry::patchNormal(mesh, p).y > 1 - kSame) level.push_back(p);
    std::vector<DrawCorner> out;
    for (size_t t = 0; t < tops.size(); t += 3) {
        std::vector<Outline> parts(1);
        for (size_t k = 0; k < 3; ++k) parts[0].emplace_back(tops[t + k].position);
        const double whole = area(parts[0]), height = parts[0][0].y;
        for (const size_t p : level) {
            if (std::abs(mesh.vertices[mesh.patch(p)[0]].y - height) > kSame) continue;
            const Outline patch = geometry::patchCorners(mesh, p);
            std::vector<Outline> rest; // beyond one edge after another
            for (Outline& part : parts)
                for (size_t i = 0, j = patch.size() - 1; i < patch.size() && !part.empty(); j = i++) {
                    const auto inside = side(patch[j], patch[i]);
                    Outline outer, inner;
                    geometry::clip(
                        part, [&](glm::dvec3 q) { return -inside(q); }, outer);
                    geometry::clip(part, inside, inner);
                    if (outer.size() > 2) rest.push_back(std::move(outer));
                    part = std::move(inner);
                }
            parts = std::move(rest);
            std::erase_if(parts, [&](const Outline& part) { return area(part) < 1e-9 * whole; });
        }
        double left = 0;
        for (const Outline& part : parts) left += area(part);
        if (left < kLeast * whole) continue;
        for (const Outline& part : parts)
            for (size_t k = 2; k < part.size(); ++k)
                for (const size_t corner : {size_t{0}, k - 1, k}) {
                    out.push_back(tops[t]);
                    out.back().position = glm::vec3(part[corner]);
                }
    }
    return out;
}

std::vector<glm::dvec3> modelPoints(const geometry::PatchMesh& mesh, const geometry::Occluders& occluders) {
    std::vector<glm::dvec3> points;
    for (uint32_t corner : mesh.corners) points.push_back(mesh.vertices[corner]);
    for (uint32_t corner : occluders.triangles) points.push_back(occluders.vertices[corner]);
    return points;
}

std::vector<DrawCorner> tableDisc(const geometry::Occluders& occluders, double radius) {
    if (occluders.triangles.empty() || !(radius > 0)) return {};
    return drawDisc({0, -1e-3, 0}, radius);
}

} // namespace

FrameScene::FrameScene(const geometry::PatchMesh& m, const geometry::Occluders& occluders,
                       const geometry::Rig* r, const FrameRendererOptions& o)
    : options(o), mesh(m), vertexLight(m), casters(m), panes(m), points(modelPoints(m, occluders)),
      all(drawMesh(m, vertexLight)), solids(drawSolids(occluders)),
      tops(uncovered(facingUp(solids, true), mesh)), sides(facingUp(solids, false)),
      table(tableDisc(occluders, r ? r->tableRadius : o.tableRadius)) {
    if (!r) return;
    rig = *r;
    shown = shownMesh(mesh, vertexLight, occluders, rig);
    painted = paintedPatches(mesh, shown, rig);
    views = projectorViews(kProjectorSupersample);
}

void FrameScene::leaveOut(const std::vector<bool>& projectors) {
    uint32_t lit = 0;
    for (size_t p = 0; p < projectors.size(); ++p)
        if (!projectors[p]) lit |= 1u << p;
    geometry::keepOnly(shown.blend, lit);
    painted = paintedPatches(mesh, shown, rig);
}

std::vector<View> FrameScene::projectorViews(int supersample) const {
    std::vector<glm::dvec3> shownPoints;
    for (const DrawCorner& corner : shown.mesh.corners) shownPoints.emplace_back(corner.position);
    std::vector<View> list;
    for (size_t i = 0; i < rig.projectors.size(); ++i) {
        list.push_back(viewOfDevice(rig.projectors[i], supersample));
        confine(list.back(), shownPoints);
        confineParts(list.back(), shown.mesh.positions(shown.cornersSeenBy(i)));
    }
    return list;
}

} // namespace heliodon::passes
