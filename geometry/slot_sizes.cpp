#include "geometry/slot_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;

constexpr double kOfWidth = 0.7;
constexpr double kMostTriangles = 0.35; // of those asked for
constexpr double kWorthwhile = 0.75;    // of the edge length
// Cosines: of a wall that stands before the opening, not beside it, and of two that face one another.
constexpr double kBefore = 0.5, kFacing = -0.7;
constexpr double kAlike = 3; // times the area of the other one: most of the larger one faces something else
// Triangles per area over the square of their edge, and per length of a border over the edge, where they
// grow on its other side (Grading's growth).
constexpr double kPerArea = 4 / 1.7320508, kPerBorder = kPerArea / 0.6;
constexpr double kTie = 1e-9; // equally far apart: of walls in parts, the largest counts
constexpr double kNone = std::numeric_limits<double>::infinity();

class SlotFinder {
public:
    SlotFinder(const Building& building, const std::vector<MeshDomain>& domains)
        : building_(building), domains_(domains), width_(domains.size(), kNone) {
        for (uint32_t d = 0; d < domains.size(); ++d) forEdges(d, [&](Edge edge) { domainOf_[edge] = d; });
    }

    std::vector<double> sizes(double edge, double triangles) {
        for (uint32_t d = 0; d < domains_.size(); ++d)
            if (face(d).twin < 0 && isOpening(d)) measure(d);
        // f times as large: area / f^2 + border / f triangles.
        double area = 0, border = 0;
        for (uint32_t d = 0; d < domains_.size(); ++d) {
            if (!isSlot(d, edge)) continue;
            const double size = kOfWidth * width_[d];
            area += kPerArea * domainArea(domains_[d]) / (size * size);
            forEdges(d, [&](Edge e) {
                const auto other = domainOf_.find({e.second, e.first});
                if (other != domainOf_.end() && !isSlot(other->second, edge))
                    border += kPerBorder * length(e) / size;
            });
        }
        const double most = kMostTriangles * triangles,
                     factor = (border + std::sqrt(border * border + 4 * area * most)) / (2 * most);
        std::vector<double> sizes;
        for (const double width : width_) {
            const double size = std::max(1.0, factor) * kOfWidth * width;
            sizes.push_back(size < kWorthwhile * edge ? size : kNone);
        }
        return sizes;
    }

private:
    struct Side { // of an opening
        uint32_t domain;
        glm::dvec3 middle, normal;
    };

    const Face& face(uint32_t d) const { return building_.faces[domains_[d].faces[0]]; }
    bool isOpening(uint32_t d) const { return building_.materials[face(d).material].isOpening(); }
    bool isSlot(uint32_t d, double edge) const { return kOfWidth * width_[d] < kWorthwhile * edge; }
    double length(Edge e) const {
        return glm::length(building_.vertices[e.second] - building_.vertices[e.first]);
    }
    template<class Visit> void forEdges(uint32_t d, Visit visit) const {
        for (const auto& loop : domains_[d].loops)
            for (size_t k = 0; k < loop.size(); ++k) visit(Edge(loop[k], loop[(k + 1) % loop.size()]));
    }

    // Walls that stand before the opening.
    std::vector<Side> sidesOf(uint32_t opening) const {
        const glm::dvec3 normal = faceNormal(building_, face(opening));
        std::vector<Side> sides;
        forEdges(opening, [&](Edge e) {
            const auto other = domainOf_.find({e.second, e.first});
            if (other == domainOf_.end() || isOpening(other->second) ||
                domains_[other->second].frames.size() > 1)
                return;
            const glm::dvec3 a = building_.vertices[e.first], b = building_.vertices[e.second],
                             itsNormal = faceNormal(building_, face(other->second)),
                             inward = glm::normalize(glm::cross(normal, b - a));
            if (glm::dot(itsNormal, inward) > kBefore)
                sides.push_back({other->second, 0.5 * (a + b), itsNormal});
        });
        return sides;
    }

    // All of a slot is as fine as its narrowest part asks for.
    void measure(uint32_t opening) {
        const std::vector<Side> sides = sidesOf(opening);
        double width = kNone, smallest = kNone;
        for (const Side& side : sides)
            for (const Side& other : sides)
                if (glm::dot(side.normal, other.normal) < kFacing) {
                    const double across = glm::dot(other.middle - side.middle, side.normal);
                    if (across <= 0 || across > width * (1 + kTie)) continue;
                    const double area =
                        std::min(domainArea(domains_[side.domain]), domainArea(domains_[other.domain]));
                    smallest = across < width * (1 - kTie) ? area : std::max(smallest, area);
                    width = std::min(width, across);
                }
        width_[opening] = std::min(width_[opening], width);
        for (const Side& side : sides)
            if (domainArea(domains_[side.domain]) <= kAlike * smallest)
                width_[side.domain] = std::min(width_[side.domain], width);
    }

    const Building& building_;
    const std::vector<MeshDomain>& domains_;
    std::map<Edge, uint32_t> domainOf_;
    std::vector<double> width_; // per domain: of the slot
};

} // namespace

std::vector<double> slotSizes(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                              double triangles) {
    return SlotFinder(building, domains).sizes(edge, triangles);
}

} // namespace heliodon::geometry
