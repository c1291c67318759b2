// A triangulation of the plane that can be changed: edges flip, points enter and move.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/constrained_delaunay.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

struct PlanarNet : TriangleNet {
    std::vector<glm::dvec2> points; // the first boundaryCount never move
    uint32_t boundaryCount = 0;
    std::vector<bool> slides; // per point: it lies on an upright fold, which it does not leave
    enum class Kind : uint8_t {
        rim,    // of a part: it does not move, but the net goes on
        border, // of the domain
        sharp   // a corner of the domain with no room for good angles
    };
    std::vector<Kind> kinds; // of the points that never move

    bool atSharpCorner(uint32_t t) const {
        return std::ranges::any_of(corner[t],
                                   [&](uint32_t v) { return !inner(v) && kinds[v] == Kind::sharp; });
    }
    bool onBorder(uint32_t v) const { return !inner(v) && kinds[v] != Kind::rim; }
    bool inner(uint32_t v) const { return v >= boundaryCount; }
    double twiceArea(uint32_t a, uint32_t b, uint32_t c) const {
        return cross(points[b] - points[a], points[c] - points[a]);
    }
    double twiceArea(uint32_t t) const { return twiceArea(corner[t][0], corner[t][1], corner[t][2]); }
    // Cosine of the smallest angle; 1 and more for triangles that are turned over.
    static double worstCosine(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);
    double worstCosine(uint32_t t) const {
        return worstCosine(points[corner[t][0]], points[corner[t][1]], points[corner[t][2]]);
    }

    // Turns the diagonal between triangle t and its neighbour k when Delaunay asks for it.
    bool flip(uint32_t t, size_t k);
    // Until nothing asks for it any more.
    void flipAll();
    // The triangle over p on a walk from triangle t; kNoTriangle when the boundary is in the way.
    uint32_t locate(uint32_t t, glm::dvec2 p) const;
    // Divides triangle t at p, which lies inside it, and flips round it.
    void insert(uint32_t t, glm::dvec2 p);

private:
    void relink(uint32_t triangle, uint32_t from, uint32_t to);
    bool prefersFlip(uint32_t p, uint32_t a, uint32_t b, uint32_t q) const;
};

// The hot spot of the optimisation: asked for every triangle round every place that is tried.
inline double PlanarNet::worstCosine(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const glm::dvec2 u = b - a, v = c - b, w = a - c;
    if (cross(u, v) <= 0) return 1;
    const double uu = glm::dot(u, u), vv = glm::dot(v, v), ww = glm::dot(w, w);
    // The smallest angle lies opposite the shortest side.
    if (uu <= vv && uu <= ww) return -glm::dot(v, w) / std::sqrt(vv * ww);
    if (vv <= ww) return -glm::dot(w, u) / std::sqrt(ww * uu);
    return -glm::dot(u, v) / std::sqrt(uu * vv);
}

// The triangles round each vertex, as lists one after the other.
struct Stars {
    explicit Stars(const PlanarNet& net);
    std::vector<uint32_t> first, triangles; // of vertex v: triangles[first[v] .. first[v + 1])
};

// The surroundings of a triangle as a net of their own, whose outer points do not move.
class NetPart {
public:
    // The triangle, which is the part's first, and `rings` times all that touch those there are.
    NetPart(const PlanarNet& whole, const Stars& stars, uint32_t triangle, int rings);

    PlanarNet net;

    // Points may have moved or been added and edges flipped since.
    void putBack(PlanarNet& whole) const;

private:
    struct Rim { // an edge of the part, from a to b with the part on its left
        uint32_t a, b, outside;
        bool fixed;
    };
    const Rim& rim(uint32_t a, uint32_t b) const;

    std::vector<uint32_t> triangles_, points_; // of the whole
    std::vector<Rim> rims_;                    // in the part's numbers, by a and b
};

} // namespace heliodon::geometry
