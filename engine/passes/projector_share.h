// The surfaces that projectors show, meshed along the outlines of what each projector sees
// (geometry/projector_visibility.h), with every projector's share of the picture. Shares run smoothly between
// vertices and sum to one. Where the rule for vertices leaves a band to nobody (no projector sees all of the
// triangles round a vertex), each triangle goes to those that see it.
#pragma once

#include "engine/passes/draw_mesh.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::passes {

// Cost: mostly that of splitByProjectorVisibility.
DrawMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig);

} // namespace heliodon::passes
