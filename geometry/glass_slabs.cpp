#include "geometry/glass_slabs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/segment_distance.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kThickOfSide = 0.2;    // of the square root of a side's area
constexpr double kSameArea = 1e-3;      // of it
constexpr double kOffRightAngle = 0.02; // cosine

dvec3 areaOf(const SoupFace& face) {
    dvec3 sum{0};
    for (const auto& loop : face.loops) sum += areaVector(loop);
    return sum;
}

// Faces of the soup that hang together, each body by itself; only closed ones of one material.
std::vector<std::vector<uint32_t>> closedBodies(const std::vector<SoupFace>& soup,
                                                const std::function<bool(uint32_t)>& isGlass,
                                                double tolerance) {
    std::vector<SoupFace> glass;
    for (uint32_t f = 0; f < soup.size(); ++f) {
        if (!isGlass(soup[f].material)) continue;
        glass.push_back(soup[f]);
        glass.back().surface = f;
    }
    const Building welded = weldFaces(glass, 1, tolerance);
    DisjointSets bodies(welded.faces.size());
    std::vector<uint32_t> open;
    for (const auto& [edge, faces] : facesOfEdges(welded)) {
        for (const uint32_t f : faces) {
            bodies.join(f, faces[0]);
            if (faces.size() != 2 || welded.faces[f].material != welded.faces[faces[0]].material)
                open.push_back(f);
        }
    }
    std::map<uint32_t, std::vector<uint32_t>> found; // by root
    for (uint32_t f = 0; f < welded.faces.size(); ++f)
        found[bodies.root(f)].push_back(welded.faces[f].surface);
    for (const uint32_t f : open) found.erase(bodies.root(f));
    std::vector<std::vector<uint32_t>> out;
    for (auto& [root, faces] : found) out.push_back(std::move(faces));
    return out;
}

struct Slab {
    std::array<std::vector<uint32_t>, 2> sides; // faces; none where the body is no slab
    dvec3 across{0};                            // from the first side to the second
};

Slab slabOf(const std::vector<uint32_t>& body, const std::vector<SoupFace>& soup, double tolerance) {
    const uint32_t largest =
        *std::ranges::max_element(body, {}, [&](uint32_t f) { return glm::length(areaOf(soup[f])); });
    const dvec3 origin = soup[largest].loops[0][0], normal = glm::normalize(areaOf(soup[largest]));
    Slab slab;
    std::array<double, 2> areas{};
    std::array<double, 2> at{0, std::numeric_limits<double>::quiet_NaN()}; // along the normal
    for (const uint32_t f : body) {
        const dvec3 area = areaOf(soup[f]);
        double low = 1e300, high = -1e300;
        for (const auto& loop : soup[f].loops)
            for (const dvec3 p : loop) {
                low = std::min(low, glm::dot(p - origin, normal));
                high = std::max(high, glm::dot(p - origin, normal));
            }
        if (high - low > tolerance) {
            if (std::abs(glm::dot(area, normal)) > kOffRightAngle * glm::length(area)) return {};
            continue;
        }
        const size_t side = std::abs(low) <= tolerance ? 0 : 1;
        if (side == 1 && slab.sides[1].empty()) at[1] = low;
        if (std::abs(low - at[side]) > tolerance) return {};
        slab.sides[side].push_back(f);
        areas[side] += 0.5 * glm::length(area);
    }
    slab.across = at[1] * normal;
    const bool isSlab = std::abs(areas[0] - areas[1]) <= kSameArea * areas[0] &&
                        std::abs(at[1]) <= kThickOfSide * std::sqrt(areas[0]);
    return isSlab ? slab : Slab{};
}

// Edges of all faces but glass.
class OtherEdges {
public:
    OtherEdges(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass) {
        for (const SoupFace& face : soup) {
            if (isGlass(face.material)) continue;
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const std::array ends{loop[i], loop[(i + 1) % loop.size()]};
                    edges_.push_back(ends);
                    boxes_.push_back(boundsOf(ends));
                }
        }
        tree_.emplace(boxes_);
    }

    bool hold(dvec3 p, double tolerance) const {
        return tree_->anyHolding(p + tolerance, p - tolerance, [&](uint32_t i) {
            const auto& [a, b] = edges_[i];
            return distanceToSegment(p, a, b) <= tolerance;
        });
    }

private:
    std::vector<std::array<dvec3, 2>> edges_;
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
};

std::vector<SoupFace> moved(const std::vector<uint32_t>& faces, const std::vector<SoupFace>& soup, dvec3 by) {
    std::vector<SoupFace> out;
    for (const uint32_t f : faces) {
        out.push_back(soup[f]);
        for (auto& loop : out.back().loops)
            for (dvec3& p : loop) p += by;
    }
    return out;
}

// In the place of the slab; nothing where it stands in no hole.
std::vector<SoupFace> panesOf(const Slab& slab, const std::vector<SoupFace>& soup, const OtherEdges& others,
                              double tolerance) {
    const auto fits = [&](const std::vector<SoupFace>& pane) {
        return std::ranges::all_of(pane, [&](const SoupFace& face) {
            return std::ranges::all_of(face.loops, [&](const auto& loop) {
                return std::ranges::all_of(loop, [&](dvec3 p) { return others.hold(p, tolerance); });
            });
        });
    };
    std::vector<SoupFace> out = moved(slab.sides[0], soup, 0.5 * slab.across);
    if (fits(out)) return out;
    out.clear();
    for (const auto& side : slab.sides)
        if (const auto pane = moved(side, soup, dvec3(0)); fits(pane))
            out.insert(out.end(), pane.begin(), pane.end());
    return out;
}

} // namespace

std::optional<PanesOfSlabs> slabsAsPanes(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    PanesOfSlabs out;
    std::vector<bool> gone(soup.size(), false);
    const OtherEdges others(soup, isGlass);
    for (const std::vector<uint32_t>& body : closedBodies(soup, isGlass, tolerance)) {
        const Slab slab = slabOf(body, soup, tolerance);
        const std::vector<SoupFace> panes = panesOf(slab, soup, others, tolerance);
        if (panes.empty()) continue;
        ++out.slabs;
        for (const uint32_t f : body) gone[f] = true;
        out.soup.insert(out.soup.end(), panes.begin(), panes.end());
    }
    if (out.slabs == 0) return std::nullopt;
    for (size_t f = 0; f < soup.size(); ++f)
        if (!gone[f]) out.soup.push_back(soup[f]);
    return out;
}

} // namespace heliodon::geometry
