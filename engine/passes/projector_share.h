// Which projector shows which part of a surface, after M. Sheng et al., section 4.3, and R. Raskar et al.,
// "Shader Lamps" (2001). A projector's share is non-zero at a mesh vertex only if it sees all triangles round
// it, less steep than the grazing limit; between vertices shares run smoothly, and they sum to one.
// Near the shadows of walls that rule leaves bands to nobody. There the triangles are divided along the
// shadows' edges, down to `finestMetres`, and each piece goes to the projectors that see it.
#pragma once

#include "engine/passes/draw_mesh.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::passes {

struct ShareOptions {
    double grazingLimit = 0.2;    // cosine between the surface's normal and the ray to the projector
    double finestMetres = 1.5e-3; // about a projector's pixel on the table
    double borderPixels = 24;     // a projector's part fades out towards the edges of its picture
};

// The patches that physical surfaces show, with every projector's share. What stands in the way is
// `occluders`, or where there are none the shown patches themselves. Cost: about 50 ms for 2000 patches and
// four projectors.
DrawMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig,
                   const ShareOptions& options = {});

} // namespace heliodon::passes
