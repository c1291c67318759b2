// What is meshed in one go: faces of one plane that hang together, or the facets of a curved wall unrolled.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/building.h"

namespace heliodon::geometry {

struct MeshDomain {
    // Per facet: plane coordinates are (offset + along `u`, along `v`) from `origin`.
    struct Frame {
        glm::dvec3 origin{}, u{}, v{};
        double offset = 0;        // of the origin
        double low = 0, high = 0; // extent along u
        glm::dvec2 coordinates(glm::dvec3 p) const;
    };
    std::vector<uint32_t> faces; // all of one material, role, surface and room
    std::vector<Frame> frames;
    std::vector<std::vector<uint32_t>> loops; // boundary corners, the domain on their left
    std::vector<std::vector<uint32_t>>
        frameOf; // per loop and corner: the facet that the edge from there is on
    std::vector<std::vector<glm::dvec2>> planar; // per loop and corner: its place in the plane
    struct Fold {
        double at = 0, turn = 0; // along the wall; radians, positive where it bulges into the room
    };
    std::vector<Fold> folds; // ascending: where facets of different planes meet

    // From the plane back on to the facet there.
    glm::dvec3 inSpace(glm::dvec2 p) const;
    // Leaves out corners of `loops` and `frameOf`; `kept`: per vertex of the building.
    void keepCorners(const std::vector<bool>& kept);
};

glm::dvec3 faceNormal(const Building& building, const Face& face);

// Square metres.
double domainArea(const MeshDomain& domain);

// In the plane, of the longest straight run of the outlines.
glm::dvec2 mainDirection(const MeshDomain& domain);

// Corners in a straight line that no domain needs are left out of all of them, so that seams between faces of
// one surface leave no trace. A face with a twin is a domain by itself.
// `edge`: length that triangles will have, metres. `merging`: facets much narrower than it become wider ones
// (facet_merging.h). `careful`: faces whose outline touches itself, or turns back in a slit, are several
// domains, for where these cannot be meshed as one.
std::vector<MeshDomain> findMeshDomains(const Building& building, double edge, bool merging = false,
                                        bool careful = false);

// Along an unrolled wall.
std::pair<double, double> extentOf(const MeshDomain& domain);

} // namespace heliodon::geometry
