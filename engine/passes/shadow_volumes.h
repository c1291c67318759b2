// Shadow volumes of a light at infinity, after F. Crow, "Shadow algorithms for computer graphics" (1977),
// counted behind the visible surface: J. Carmack (2000), C. Everitt and M. Kilgard, "Practical and robust
// stenciled shadow volumes" (2002).
// Every opaque patch casts, whichever side the sun is on: its volume is the patch, seen from the sun, swept
// to infinity. Sides between two patches that both go on cancel; what is left are silhouettes and the rims of
// openings. So nothing is asked of the mesh: rooms, walls without thickness, holes and cracks all count
// right. A point is lit where the count of volumes round it is zero.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "engine/passes/sun_reach.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

class ShadowCasters {
public:
    explicit ShadowCasters(const geometry::PatchMesh& mesh);

    // Triangles, three homogeneous points each, counter-clockwise seen from outside the volumes; w = 0 is the
    // point at infinity away from the sun. Caps (the casters themselves) come first: they lie on the surfaces
    // that they shade and are drawn with a depth bias, which would shift the shadows' edges if sides had it.
    struct Volumes {
        std::vector<glm::vec4> corners;
        uint32_t capCorners = 0;
    };
    // Of all casters that touch what is marked in the plane across the sun's rays: there, counts are whole.
    // Cost: one pass over edges and patches.
    Volumes volumes(glm::dvec3 towardsSun, const SunPlane& wanted) const;

private:
    struct Use {
        uint32_t caster;
        bool forward; // the caster goes from `from` to `to`
    };
    struct Edge {
        uint32_t from, to;
        uint32_t firstUse, useCount;
    };

    std::vector<glm::vec3> vertices_;
    std::vector<glm::dvec3> normals_;                // per caster
    std::vector<uint32_t> corners_, firstCorner_{0}; // per caster
    std::vector<Edge> edges_;
    std::vector<Use> uses_;
};

} // namespace heliodon::passes
