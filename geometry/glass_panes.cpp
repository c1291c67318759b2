#include "geometry/glass_panes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/pane_in_hole.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kThickOfSide = 0.2;    // of the square root of a side's area
constexpr double kSameArea = 1e-3;      // of it
constexpr double kSameHole = 1e-6;      // of a pane's area
constexpr double kOffRightAngle = 0.02; // cosine

dvec3 twiceAreaVector(const SoupFace& face) {
    dvec3 sum{0};
    for (const auto& loop : face.loops) sum += areaVector(loop);
    return sum;
}

// Faces of the soup that hang together.
struct Body {
    std::vector<uint32_t> faces;
    bool closed = true; // and of one material
};

std::vector<Body> bodiesOf(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass,
                           double tolerance) {
    std::vector<SoupFace> glass;
    for (uint32_t f = 0; f < soup.size(); ++f) {
        if (!isGlass(soup[f].material)) continue;
        glass.push_back(soup[f]);
        glass.back().surface = f;
    }
    const Building welded = weldFaces(glass, 1, tolerance);
    DisjointSets sets(welded.faces.size());
    std::vector<uint32_t> open;
    for (const auto& [edge, faces] : facesOfEdges(welded))
        for (const uint32_t f : faces) {
            sets.join(f, faces[0]);
            if (faces.size() != 2 || welded.faces[f].material != welded.faces[faces[0]].material)
                open.push_back(f);
        }
    std::map<uint32_t, Body> found; // by root
    for (uint32_t f = 0; f < welded.faces.size(); ++f)
        found[sets.root(f)].faces.push_back(welded.faces[f].surface);
    for (const uint32_t f : open) found[sets.root(f)].closed = false;
    std::vector<Body> out;
    for (auto& [root, body] : found) out.push_back(std::move(body));
    return out;
}

struct Slab {
    std::array<std::vector<uint32_t>, 2> sides; // faces; none where the body is no slab
    dvec3 across{0};                            // from the first side to the second
};

Slab slabOf(const std::vector<uint32_t>& body, const std::vector<SoupFace>& soup, double tolerance) {
    const uint32_t largest = *std::ranges::max_element(
        body, {}, [&](uint32_t f) { return glm::length(twiceAreaVector(soup[f])); });
    const dvec3 origin = soup[largest].loops[0][0], normal = glm::normalize(twiceAreaVector(soup[largest]));
    Slab slab;
    std::array<double, 2> areas{};
    std::array<double, 2> at{0, std::numeric_limits<double>::quiet_NaN()}; // along the normal
    for (const uint32_t f : body) {
        const dvec3 area = twiceAreaVector(soup[f]);
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

// In the place of the slab; nothing where it stands in no hole.
std::vector<SoupFace> panesOf(const Slab& slab, const PaneFitter& holes) {
    if (slab.sides[0].empty()) return {};
    std::vector<SoupFace> out = holes.fit(slab.sides[0], 0.5 * slab.across);
    if (!out.empty()) return out;
    for (const auto& side : slab.sides) {
        const std::vector<SoupFace> pane = holes.fit(side, dvec3(0));
        out.insert(out.end(), pane.begin(), pane.end());
    }
    return out;
}

double areaOf(std::span<const SoupFace> faces) {
    double sum = 0;
    for (const SoupFace& face : faces) sum += 0.5 * glm::length(twiceAreaVector(face));
    return sum;
}

// The same of a pane without thickness; nothing where it fits, or is not flat.
std::vector<SoupFace> otherPane(const std::vector<uint32_t>& pane, const std::vector<SoupFace>& soup,
                                const PaneFitter& holes, double tolerance) {
    std::vector<SoupFace> drawn;
    for (const uint32_t f : pane) drawn.push_back(soup[f]);
    const dvec3 origin = drawn[0].loops[0][0], normal = glm::normalize(twiceAreaVector(drawn[0]));
    for (const SoupFace& face : drawn)
        for (const dvec3 p : face.loops[0])
            if (std::abs(glm::dot(p - origin, normal)) > tolerance) return {};
    std::vector<SoupFace> out = holes.fit(pane, dvec3(0));
    if (std::abs(areaOf(out) - areaOf(drawn)) <= kSameHole * areaOf(drawn)) out.clear();
    return out;
}

} // namespace

std::optional<PanesInHoles> panesInHoles(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance,
                                         Drawn drawn) {
    std::vector<Body> bodies = bodiesOf(soup, isGlass, tolerance);
    if (drawn == Drawn::slabs) std::erase_if(bodies, [](const Body& body) { return !body.closed; });
    if (bodies.empty()) return std::nullopt; // as of most models: no walls are sorted for nothing
    PanesInHoles out;
    std::vector<bool> gone(soup.size(), false);
    const PaneFitter holes(soup, isGlass, tolerance);
    for (const Body& body : bodies) {
        const std::vector<SoupFace> panes = body.closed ? panesOf(slabOf(body.faces, soup, tolerance), holes)
                                                        : otherPane(body.faces, soup, holes, tolerance);
        if (panes.empty()) continue;
        ++(body.closed ? out.slabs : out.flat);
        for (const uint32_t f : body.faces) gone[f] = true;
        out.soup.insert(out.soup.end(), panes.begin(), panes.end());
    }
    if (out.soup.empty()) return std::nullopt;
    for (size_t f = 0; f < soup.size(); ++f)
        if (!gone[f]) out.soup.push_back(soup[f]);
    return out;
}

} // namespace heliodon::geometry
