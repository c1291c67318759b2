// Curved walls: which folds between facets are edges of the mesh, and where triangles may lie across folds,
// which is off the facets: in the wall's solids, or before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/building.h"
#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

class FoldLeaning {
public:
    // Both outlive it.
    FoldLeaning(const Building& building, const std::vector<MeshDomain>& domains);

    // Those with room for triangles of this edge length (metres) between them; across facets narrower than
    // `narrowest` of it triangles lean. Metres along the domain.
    std::vector<double> folds(size_t domain, double edge, double narrowest) const;

    bool mayLean(size_t domain, double edge) const; // triangles across its folds

private:
    using Edges = std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>>; // domains of each

    bool standsAt(size_t domain, glm::dvec2 place, double height) const;
    // boxes: round domains
    bool isBetween(const Edges::value_type& edge, const Bounds& box, const std::vector<Bounds>& boxes) const;
    double clearanceOf(size_t domain, const std::vector<Bounds>& boxes, const Edges& edges) const;
    double deepestLean(size_t domain,
                       double edge) const; // metres from the facets, of triangles without folds
    glm::dvec3 position(uint32_t corner) const { return building_.vertices[corner]; }

    const Building& building_;
    const std::vector<MeshDomain>& domains_;
    std::vector<double> clearances_; // per domain: metres from its folds to what is near
};

} // namespace heliodon::geometry
