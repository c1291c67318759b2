// What drawing needs of one geometry, worked out without a device: in any thread, while another geometry is
// still being shown.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "engine/passes/draw_mesh.h"
#include "engine/passes/panes.h"
#include "engine/passes/projector_light.h"
#include "engine/passes/projector_share.h"
#include "engine/passes/shadow_volumes.h"
#include "engine/passes/vertex_light.h"
#include "engine/passes/view.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::passes {

struct FrameRendererOptions {
    double tableRadius = 0.5334; // metres; of the disc in previews, where there is no rig; 0: none
};

constexpr int kProjectorSupersample = 2; // outlines and the sun's edge run smoothly over the panel's pixels

struct FrameScene {
    // `rig` may be null: then there are previews only. Cost: mostly that of splitByProjectorVisibility, and a
    // look through the lens for every pixel of every projector.
    FrameScene(const geometry::PatchMesh& mesh, const geometry::Occluders& occluders,
               const geometry::Rig* rig, const FrameRendererOptions& options = {});

    // What each projector sees, confined to what it shows.
    std::vector<View> projectorViews(int supersample) const;

    // Per projector, whether it shows nothing from now on: the others take its part over, as far as they see
    // it.
    void leaveOut(const std::vector<bool>& projectors);

    FrameRendererOptions options;
    geometry::PatchMesh mesh;
    geometry::Rig rig; // without projectors where none was given
    VertexLight vertexLight;
    ShadowCasters casters;
    Panes panes;
    std::vector<glm::dvec3> points; // of mesh and solids, for framing
    DrawMesh all;
    ShownMesh shown; // what projectors show
    std::vector<DrawCorner> solids, tops, sides, table;
    PaintedPatches painted;
    std::vector<View> views; // projectorViews(kProjectorSupersample)
};

} // namespace heliodon::passes
