// The surfaces that projectors show, meshed along the outlines of what each projector sees
// (geometry/projector_visibility.h), with how projectors share them (geometry/projector_blend.h).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/passes/draw_mesh.h"
#include "geometry/patch_mesh.h"
#include "geometry/projector_blend.h"
#include "geometry/rig.h"

namespace heliodon::passes {

struct ShownMesh {
    DrawMesh mesh;
    geometry::ProjectorBlend blend; // of the same triangles

    // Of the triangles that a projector sees: it has no gain on any other.
    std::vector<uint32_t> cornersSeenBy(size_t projector) const;
};

// Cost: mostly that of splitByProjectorVisibility.
ShownMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                    const geometry::Occluders& occluders, const geometry::Rig& rig);

} // namespace heliodon::passes
