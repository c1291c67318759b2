#include "engine/passes/frame_scene.h"

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
      all(drawMesh(m, vertexLight)), solids(drawSolids(occluders)), tops(facingUp(solids, true)),
      sides(facingUp(solids, false)), table(tableDisc(occluders, r ? r->tableRadius : o.tableRadius)) {
    if (!r) return;
    rig = *r;
    shown = shownMesh(mesh, vertexLight, occluders, rig);
    for (const geometry::Projector& projector : rig.projectors) intensity.push_back(fullIntensity(projector));
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
