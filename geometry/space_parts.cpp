// Round each edge the sheets are sorted by angle; the sides that look at one another over an edge bound the
// same part of space (the radial-edge structure of Weiler, 1988).
#include "geometry/space_parts.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

class SpaceDivider {
public:
    SpaceDivider(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                 double tolerance)
        : faces_(faces), isGlass_(isGlass), tolerance_(tolerance) {}

    std::optional<SpaceParts> divide() {
        out_.sheets = cutIntoSheets(faces_, tolerance_);
        out_.welded = weldSheets(out_.sheets, tolerance_);
        if (!joinSides()) return std::nullopt;
        makeParts();
        findOwners();
        findAlcoves();
        return std::move(out_);
    }

private:
    // False where an edge has one sheet alone.
    bool joinSides() {
        struct Sector {
            double angle;
            uint32_t ahead, behind; // the sides that look to larger and smaller angles
            uint32_t face;
        };
        std::map<std::pair<uint32_t, uint32_t>, std::vector<Sector>> edges;
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f) {
            const dvec3 n = out_.normalOf(f);
            for (const auto& loop : out_.welded.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                    const auto [low, high] = std::minmax(a, b);
                    const dvec3 axis = glm::normalize(out_.welded.vertices[high] - out_.welded.vertices[low]),
                                x = perpendicular(axis), y = glm::cross(axis, x),
                                inwards = (a == low ? 1.0 : -1.0) * glm::cross(n, axis);
                    // Walking with the axis the sheet lies to the left of its normal: that side looks ahead.
                    const bool along = a == low;
                    edges[{low, high}].push_back({std::atan2(glm::dot(inwards, y), glm::dot(inwards, x)),
                                                  2 * f + (along ? 0 : 1), 2 * f + (along ? 1 : 0), f});
                }
        }
        DisjointSets sides(2 * out_.welded.faces.size());
        shells_ = DisjointSets(out_.welded.faces.size());
        for (auto& [edge, sectors] : edges) {
            if (sectors.size() < 2) return false;
            std::ranges::sort(sectors, {}, &Sector::angle);
            for (size_t k = 0; k < sectors.size(); ++k) {
                const Sector &one = sectors[k], &next = sectors[(k + 1) % sectors.size()];
                sides.join(one.ahead, next.behind);
                shells_.join(one.face, next.face);
            }
        }
        for (uint32_t side = 0; side < 2 * out_.welded.faces.size(); ++side)
            out_.partOfSide.push_back(sides.root(side));
        return !out_.welded.faces.empty();
    }

    void makeParts() {
        out_.area.assign(out_.welded.faces.size(), 0);
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f) {
            const auto triangles = triangulateFace(out_.welded, out_.welded.faces[f]);
            const dvec3 o = out_.welded.vertices[0];
            for (uint32_t s = 0; s < 2; ++s) {
                SpacePart& part = out_.parts[out_.partAt(f, s)];
                part.shell = shells_.root(f);
                out_.area[f] = 0;
                for (const auto& t : triangles) {
                    ShellTriangle in{out_.welded.vertices[t[0]], out_.welded.vertices[t[1]],
                                     out_.welded.vertices[t[2]]};
                    if (s) std::swap(in.b, in.c);
                    part.volume -= glm::dot(in.a - o, glm::cross(in.b - o, in.c - o)) / 6;
                    out_.area[f] += 0.5 * glm::length(glm::cross(in.b - in.a, in.c - in.a));
                    part.triangles.push_back(in);
                }
                part.area += out_.area[f];
            }
        }
    }

    void findInGlass() {
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f)
            for (uint32_t turned = 0; turned < 2; ++turned)
                for (const uint32_t k : out_.sheetOf(f).drawn[turned])
                    if (faces_[k].twinKey >= 0) out_.parts[out_.partAt(f, 1 - turned)].inGlass = true;
    }

    void findAlcoves() {
        std::map<uint32_t, std::set<uint32_t>> beyond; // its glass, per part
        const auto isOfGlass = [&](const auto& list) {
            return std::ranges::any_of(list, [&](uint32_t k) { return isGlass_(faces_[k].material); });
        };
        findInGlass();
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f) {
            const bool glass = std::ranges::any_of(out_.sheetOf(f).drawn, isOfGlass);
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t id = out_.partAt(f, s), other = out_.partAt(f, 1 - s);
                out_.parts[id].neighbours.insert(other);
                if (out_.parts[other].volume <= 0)
                    (glass ? out_.parts[id].window : out_.parts[id].open) += out_.area[f];
                if (!glass || out_.parts[id].inGlass || out_.parts[other].inGlass) continue;
                beyond[id].insert(other);
                out_.parts[id].glass += out_.area[f];
            }
        }
        for (const auto& [id, others] : beyond) {
            out_.parts[id].alcove = others.size() == 1 && beyond[*others.begin()].size() > 1 &&
                                    out_.parts[*others.begin()].volume > 0;
            out_.parts[id].between = others.size() > 1;
        }
    }

    // A face as drawn belongs to the part that most of it bounds, in front of it and behind it.
    void findOwners() {
        std::vector<std::array<std::map<uint32_t, double>, 2>> bounds(faces_.size()); // areas by part
        out_.drawn.resize(faces_.size());
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f)
            for (uint32_t turned = 0; turned < 2; ++turned)
                for (const uint32_t k : out_.sheetOf(f).drawn[turned]) {
                    DrawnFace& drawn = out_.drawn[k];
                    ++drawn.sheets;
                    drawn.area += out_.area[f];
                    if (!out_.sheetOf(f).drawn[1 - turned].empty()) drawn.backed += out_.area[f];
                    const std::array<uint32_t, 2> parts{out_.partAt(f, turned), out_.partAt(f, 1 - turned)};
                    for (uint32_t s = 0; s < 2; ++s) bounds[k][s][parts[s]] += out_.area[f];
                    if (!drawn.borders) drawn.borders.emplace(parts.begin(), parts.end());
                    std::erase_if(*drawn.borders,
                                  [&](uint32_t id) { return id != parts[0] && id != parts[1]; });
                }
        for (uint32_t k = 0; k < faces_.size(); ++k)
            for (uint32_t s = 0; s < 2; ++s)
                if (!bounds[k][s].empty())
                    out_.drawn[k].owners[s] = std::ranges::max_element(bounds[k][s], {}, [](const auto& b) {
                                                  return b.second;
                                              })->first;
        for (uint32_t f = 0; f < out_.welded.faces.size(); ++f) {
            const auto& drawn = out_.sheetOf(f).drawn;
            if (drawn[0].empty() == drawn[1].empty()) continue; // faces that look both ways say nothing
            const uint32_t turned = drawn[0].empty() ? 1 : 0;
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t id = out_.partAt(f, s);
                if (std::ranges::none_of(drawn[turned], [&](uint32_t k) {
                        return out_.drawn[k].owners[s == turned ? 0 : 1] == id;
                    }))
                    continue;
                out_.parts[id].drawnInwards += s == turned ? out_.area[f] : -out_.area[f];
                out_.parts[id].drawn += out_.area[f];
            }
        }
    }

    const std::vector<SoupFace>& faces_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    SpaceParts out_;
    DisjointSets shells_; // welded faces by common edges
};

} // namespace

Bounds SpacePart::box() const {
    Bounds out{dvec3(1e300), dvec3(-1e300)};
    for (const ShellTriangle& t : triangles)
        for (const dvec3 p : {t.a, t.b, t.c}) {
            out.low = glm::min(out.low, p);
            out.high = glm::max(out.high, p);
        }
    return out;
}

dvec3 SpaceParts::normalOf(uint32_t face) const {
    return glm::normalize(areaVector(welded.vertices, welded.faces[face].loops[0]));
}

std::optional<SpaceParts> partsOfSpace(const std::vector<SoupFace>& faces,
                                       const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    return SpaceDivider(faces, isGlass, tolerance).divide();
}

} // namespace heliodon::geometry
