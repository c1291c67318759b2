#include "geometry/slot_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/necks.h"
#include "geometry/ray_crossing.h"

namespace heliodon::geometry {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;

constexpr double kOfWidth = 0.7;
constexpr double kMostTriangles = 0.35; // of those asked for
constexpr double kWorthwhile = 0.75;    // of the edge length
// Cosines: of a wall that stands before the opening, not beside it, and of two that face one another.
constexpr double kBefore = 0.5, kFacing = -0.7;
constexpr double kAlike = 3; // times the area of the other one: most of the larger one faces something else
constexpr double kDeep = 1;  // times its width: necks that are shorter are doors
// Triangles per area over the square of their edge, and per length of a border over the edge, where they
// grow on its other side (Grading's growth).
constexpr double kPerArea = 4 / 1.7320508, kPerBorder = kPerArea / 0.6;
constexpr double kTie = 1e-9;  // equally far apart: of walls in parts, the largest counts
constexpr double kAbout = 1.5; // times a slot's width: what of a wall lies before the other one
constexpr double kNone = std::numeric_limits<double>::infinity();

class SlotFinder {
public:
    SlotFinder(const Building& building, const std::vector<MeshDomain>& domains, double edge)
        : building_(building), domains_(domains), edge_(edge), widest_(kWorthwhile * edge / kOfWidth),
          width_(domains.size(), kNone) {
        for (uint32_t d = 0; d < domains.size(); ++d)
            forEdges(d, [&](Edge e, const MeshDomain::Frame& frame) { borders_[e] = {d, &frame}; });
    }

    SlotSizes sizes(double triangles) {
        for (uint32_t d = 0; d < domains_.size(); ++d)
            if (face(d).twin >= 0)
                continue;
            else if (isOpening(d))
                measureOpening(d);
            else
                measureNecks(d);
        const double factor = factorFor(kMostTriangles * triangles), worthwhile = kOfWidth * widest_;
        SlotSizes sizes{{}, std::vector<std::vector<SizeSource>>(domains_.size())};
        for (const double width : width_) {
            const double size = factor * kOfWidth * width;
            sizes.longest.push_back(size < worthwhile ? size : kNone);
        }
        for (const auto& [walls, width] : before_)
            if (const double size = factor * kOfWidth * width; size < worthwhile)
                addPart(walls.first, walls.second, width, size, sizes.parts[walls.second]);
        return sizes;
    }

private:
    struct Border {
        uint32_t domain;
        const MeshDomain::Frame* frame;
    };
    struct Side { // of an opening
        uint32_t domain;
        glm::dvec3 middle, normal;
    };

    const Face& face(uint32_t d) const { return building_.faces[domains_[d].faces[0]]; }
    bool isOpening(uint32_t d) const { return building_.materials[face(d).material].isOpening(); }
    bool isSlot(uint32_t d) const { return width_[d] < widest_; }
    double length(Edge e) const {
        return glm::length(building_.vertices[e.second] - building_.vertices[e.first]);
    }
    template<class Visit> void forEdges(uint32_t d, Visit visit) const {
        const MeshDomain& domain = domains_[d];
        for (size_t l = 0; l < domain.loops.size(); ++l)
            for (size_t k = 0, n = domain.loops[l].size(); k < n; ++k)
                visit(Edge(domain.loops[l][k], domain.loops[l][(k + 1) % n]),
                      domain.frames[domain.frameOf[l][k]]);
    }

    // In the mean, along a wall that is unrolled.
    double facetOf(uint32_t d) const {
        const MeshDomain& domain = domains_[d];
        if (domain.folds.empty()) return kNone;
        const auto [low, high] = extentOf(domain);
        return (high - low) / static_cast<double>(domain.folds.size() + 1);
    }

    // What is to be so fine, for a count of its triangles.
    struct Fine {
        double finest, facet, area, border; // metres; of the border to what is as coarse as elsewhere

        double density(double size) const { // between folds columns come in whole numbers
            const double column = std::isinf(facet) ? size : facet / std::ceil(facet / size);
            return kPerArea / (size * column);
        }
    };
    std::vector<Fine> fineParts() const {
        std::vector<Fine> parts;
        const auto add = [&](uint32_t d, double width, const auto& isBorder) {
            Fine& part = parts.emplace_back(kOfWidth * width, facetOf(d), domainArea(domains_[d]), 0.0);
            forEdges(d, [&](Edge e, const MeshDomain::Frame&) {
                if (isBorder(e)) part.border += length(e);
            });
        };
        for (uint32_t d = 0; d < domains_.size(); ++d)
            if (isSlot(d))
                add(d, width_[d], [&](Edge e) {
                    const auto other = borders_.find({e.second, e.first});
                    return other != borders_.end() && !isSlot(other->second.domain);
                });
        for (const auto& [walls, width] : before_) // as much of the other wall
            if (width < widest_) add(walls.first, width, [](Edge) { return true; });
        return parts;
    }

    // By what sizes are multiplied so that all this takes no more than so many triangles beyond those of a
    // uniform mesh.
    double factorFor(double most) const {
        const std::vector<Fine> parts = fineParts();
        const auto count = [&](double factor) {
            double sum = 0;
            for (const Fine& part : parts) {
                const double size = factor * part.finest, coarser = size / edge_;
                if (coarser >= 1) continue;
                sum += part.area * (part.density(size) - part.density(edge_)) +
                       kPerBorder * part.border * (1 - coarser) * (1 - coarser) / size;
            }
            return sum;
        };
        double low = 1, high = 1;
        while (count(high) > most) low = high, high *= 2;
        for (int round = 0; round < 40 && high > low; ++round)
            (count(0.5 * (low + high)) > most ? low : high) = 0.5 * (low + high);
        return high;
    }

    // The wall that stands on an edge of the domain, before it.
    std::optional<Side> sideAt(Edge e, glm::dvec3 normal) const {
        const auto other = borders_.find({e.second, e.first});
        if (other == borders_.end() || isOpening(other->second.domain)) return std::nullopt;
        const MeshDomain::Frame& frame = *other->second.frame;
        const glm::dvec3 a = building_.vertices[e.first], b = building_.vertices[e.second],
                         itsNormal = glm::cross(frame.u, frame.v),
                         inward = glm::normalize(glm::cross(normal, b - a));
        if (glm::dot(itsNormal, inward) <= kBefore) return std::nullopt;
        return Side{other->second.domain, 0.5 * (a + b), itsNormal};
    }

    // All of a slot is as fine as its narrowest part asks for.
    void measureOpening(uint32_t opening) {
        const glm::dvec3 normal = faceNormal(building_, face(opening));
        std::vector<Side> sides;
        forEdges(opening, [&](Edge e, const MeshDomain::Frame&) {
            if (const auto side = sideAt(e, normal)) sides.push_back(*side);
        });
        double width = kNone, smallest = kNone;
        const auto across = [](const Side& side, const Side& other) {
            const double gap = glm::dot(other.middle - side.middle, side.normal);
            return glm::dot(side.normal, other.normal) < kFacing && gap > 0 ? gap : kNone;
        };
        for (const Side& side : sides)
            for (const Side& other : sides) {
                const double gap = across(side, other);
                if (gap == kNone || gap > width * (1 + kTie)) continue;
                const double area =
                    std::min(domainArea(domains_[side.domain]), domainArea(domains_[other.domain]));
                smallest = gap < width * (1 - kTie) ? area : std::max(smallest, area);
                width = std::min(width, gap);
            }
        if (width >= widest_) return;
        const auto isSmall = [&](const Side& side) {
            return domainArea(domains_[side.domain]) <= kAlike * smallest;
        };
        narrow(width_[opening], width);
        for (const Side& side : sides)
            if (isSmall(side))
                narrow(width_[side.domain], width);
            else
                for (const Side& other : sides)
                    if (isSmall(other) && across(other, side) <= kAbout * width)
                        narrowBefore(other.domain, side.domain, width);
    }

    void measureNecks(uint32_t d) {
        struct Slot {
            double width = kNone, length = 0;
            std::map<Edge, double> edges; // of the first wall, lengths
        };
        std::map<std::pair<uint32_t, uint32_t>, Slot> slots; // by walls
        const MeshDomain& domain = domains_[d];
        const glm::dvec3 normal = faceNormal(building_, face(d));
        for (const Neck& neck : necksOf(domain, widest_)) {
            const auto& loop = domain.loops[neck.loop];
            const auto edgeAt = [&](size_t k) { return Edge(loop[k], loop[(k + 1) % loop.size()]); };
            const auto side = sideAt(edgeAt(neck.first), normal), other = sideAt(edgeAt(neck.second), normal);
            if (!side || !other) continue;
            const bool turned = domainArea(domains_[side->domain]) > domainArea(domains_[other->domain]);
            Slot& slot = slots[turned ? std::pair(other->domain, side->domain)
                                      : std::pair(side->domain, other->domain)];
            slot.width = std::min(slot.width, neck.width), slot.length += neck.length;
            const Edge edge = edgeAt(turned ? neck.second : neck.first);
            slot.edges[edge] = length(edge);
        }
        for (const auto& [walls, slot] : slots) {
            double whole = 0; // of the smaller wall
            for (const auto& [edge, its] : slot.edges) whole += its;
            if (slot.length < kDeep * slot.width || whole > kAlike * slot.length) continue;
            narrow(width_[walls.first], slot.width);
            if (domainArea(domains_[walls.second]) <= kAlike * domainArea(domains_[walls.first]))
                narrow(width_[walls.second], slot.width);
            else
                narrowBefore(walls.first, walls.second, slot.width);
        }
    }

    static void narrow(double& width, double to) { width = std::min(width, to); }
    void narrowBefore(uint32_t wall, uint32_t larger, double width) {
        narrow(before_.try_emplace({wall, larger}, width).first->second, width);
    }

    // Where the larger wall lies before the other one.
    void addPart(uint32_t wall, uint32_t larger, double width, double size,
                 std::vector<SizeSource>& sources) const {
        const MeshDomain &from = domains_[wall], &to = domains_[larger];
        glm::dvec2 low(kNone), high(-kNone);
        for (const auto& loop : from.planar)
            for (const glm::dvec2 p : loop) low = glm::min(low, p), high = glm::max(high, p);
        const glm::dvec2 count = glm::ceil((high - low) / size), step = (high - low) / count;
        for (double i = 0.5; i < count.x; ++i)
            for (double j = 0.5; j < count.y; ++j) {
                const glm::dvec2 p = low + glm::dvec2(i, j) * step;
                if (!isInside(from.planar, p)) continue;
                const glm::dvec3 place = from.inSpace(p);
                for (const MeshDomain::Frame& frame : to.frames) {
                    const glm::dvec2 q = frame.coordinates(place);
                    const double gap = glm::dot(place - frame.origin, glm::cross(frame.u, frame.v));
                    if (std::abs(gap) <= kAbout * width &&
                        (to.frames.size() == 1 || (q.x >= frame.low && q.x <= frame.high)))
                        sources.push_back({q, size});
                }
            }
    }

    const Building& building_;
    const std::vector<MeshDomain>& domains_;
    double edge_, widest_; // metres: wider ones are no slots
    std::map<Edge, Border> borders_;
    std::vector<double> width_; // per domain: of the slot
    std::map<std::pair<uint32_t, uint32_t>, double>
        before_; // the same of a wall and a larger one that it faces
};

} // namespace

SlotSizes slotSizes(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                    double triangles) {
    return SlotFinder(building, domains, edge).sizes(triangles);
}

} // namespace heliodon::geometry
