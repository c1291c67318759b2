#include "geometry/model_faces.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/counted.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using Outline = std::vector<glm::dvec3>;

constexpr double kBentOfExtent = 2e-4; // 1 mm in a room of 5 m: corners in whole millimetres, turned
// Of the face's size: what is bent by more is named where the model does not close.
constexpr double kMostBent = 0.02;

std::vector<Outline> placed(const RawModel& model, size_t face) {
    std::vector<Outline> out;
    for (const auto& loop : model.loops(face)) {
        out.emplace_back();
        for (const uint32_t v : loop) out.back().push_back(model.vertices[v]);
    }
    return out;
}

// "role" of a group that writeModel named ("room0_fill-in"), else projection.
Role roleOf(const RawModel& model, size_t face) {
    return model.groups[model.group[face]].ends_with("_fill-in") ? Role::fillIn : Role::projection;
}

// About that of a strip of its area and perimeter.
double widthOf(const Outline& outline) {
    const double border = perimeter(outline);
    return border > 0 ? 2 * glm::length(areaVector(outline)) / border : 0;
}

// Metres between the two planes, parallel to the face, that hold all its corners.
double bendOf(const std::vector<Outline>& loops) {
    const glm::dvec3 n = glm::normalize(areaVector(loops[0]));
    double low = 0, high = 0;
    for (const Outline& loop : loops)
        for (const glm::dvec3 p : loop) {
            low = std::min(low, glm::dot(p - loops[0][0], n));
            high = std::max(high, glm::dot(p - loops[0][0], n));
        }
    return high - low;
}

// Turns the outlines so that a face drawn from the other side, or from another corner on, has the same; true
// where that turned them over.
bool normalise(std::vector<Outline>& loops) {
    const auto before = [](const glm::dvec3& a, const glm::dvec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    bool over = false;
    for (Outline& loop : loops) {
        std::ranges::rotate(loop, std::ranges::min_element(loop, before));
        if (&loop == loops.data()) over = before(loop.back(), loop[1]);
        if (over) std::reverse(loop.begin() + 1, loop.end());
    }
    return over;
}

// The face itself where that fails: its outline crosses itself, which is refused later.
std::vector<SoupFace> inTriangles(const SoupFace& face) {
    std::vector<Outline> loops = face.loops;
    const bool over = normalise(loops);
    Building alone;
    Face whole;
    for (const Outline& loop : loops) {
        whole.loops.emplace_back();
        for (const glm::dvec3 p : loop) {
            whole.loops.back().push_back(static_cast<uint32_t>(alone.vertices.size()));
            alone.vertices.push_back(p);
        }
    }
    std::vector<SoupFace> out;
    for (const auto& t : triangulateFace(alone, whole)) {
        out.push_back(face);
        out.back().loops = {{alone.vertices[t[0]], alone.vertices[t[1]], alone.vertices[t[2]]}};
        if (over) std::swap(out.back().loops[0][1], out.back().loops[0][2]);
    }
    return out.empty() ? std::vector{face} : out;
}

// Bent faces of one kind.
struct Bent {
    size_t count = 0, first = 0;
    double most = 0;

    void add(size_t face, double bend) {
        if (count++ == 0) first = face;
        most = std::max(most, bend);
    }
    std::string sentence(double worldPerBuilding, const std::string& where) const {
        return fmt::format("{} bent by up to {:.2g} m{} {} divided into triangles", counted(count, "face"),
                           most / worldPerBuilding, where, count == 1 ? "was" : "were");
    }
};

} // namespace

ModelFaces flatFaces(const RawModel& model, double extent, double worldPerBuilding, double coarser) {
    ModelFaces out;
    out.coarser = coarser;
    Bent little, much;
    for (size_t i = 0; i < model.faceCount(); ++i) {
        const SoupFace face{placed(model, i), model.material[i], roleOf(model, i), static_cast<uint32_t>(i)};
        const Outline& outline = face.loops[0];
        if (widthOf(outline) < kWeldOfExtent * extent) {
            ++out.dropped;
            continue;
        }
        const double bend = outline.size() > 3 ? bendOf(face.loops) : 0;
        if (bend <= kPlanarOfExtent * extent) {
            out.soup.push_back(face);
            continue;
        }
        if (bend <= kBentOfExtent * extent / coarser)
            little.add(i, bend);
        else {
            much.add(i, bend);
            if (bend > kMostBent * std::sqrt(0.5 * glm::length(areaVector(outline))))
                out.folded[static_cast<uint32_t>(i)] = bend;
        }
        for (SoupFace& piece : inTriangles(face)) out.soup.push_back(std::move(piece));
    }
    for (const auto& [corners, material] : model.outside) {
        SoupFace face{.loops = {{}}, .material = material};
        for (const uint32_t v : corners) face.loops[0].push_back(model.vertices[v]);
        if (widthOf(face.loops[0]) < kWeldOfExtent * extent) continue;
        for (SoupFace& piece : inTriangles(face)) out.outside.push_back(std::move(piece));
    }
    if (little.count > 0) out.repair = little.sentence(worldPerBuilding, "");
    if (much.count > 0)
        out.warnings.push_back(
            much.sentence(worldPerBuilding, fmt::format(" (the first at {})", model.place(much.first))) +
            ": where they should fold was guessed");
    return out;
}

} // namespace heliodon::geometry
