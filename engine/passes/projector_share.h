// The surfaces that projectors show, meshed along the outlines of what each projector sees
// (geometry/projector_visibility.h), with every projector's share of the picture. Shares run smoothly between
// vertices and sum to one. Where the rule for vertices leaves a band to nobody (no projector sees all of the
// triangles round a vertex), each triangle goes to those that see it.
#pragma once

#include <vector>

#include "engine/passes/draw_mesh.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::passes {

// Cost: mostly that of splitByProjectorVisibility.
DrawMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig);

// `dark`: per projector, whether it shows nothing any more. What the others see of its part becomes theirs,
// as if the rig had only them; elsewhere shares are zero.
void handOverShares(DrawMesh& shown, const std::vector<bool>& dark);

} // namespace heliodon::passes
