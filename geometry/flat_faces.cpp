#include "geometry/flat_faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/clip_polygon.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

constexpr double kSteep = 0.7; // of a normal's height: walls are

} // namespace

FlatFace convexFace(const std::vector<glm::dvec3>& corners, glm::dvec3 normal) {
    FlatFace out{.origin = corners[0], .normal = normal, .loops = {corners}, .box = boundsOf(corners)};
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        out.triangles.push_back({corners[0], corners[k], corners[k + 1]});
    return out;
}

std::vector<FlatFace> halves(const FlatFace& convex, const FlatFace& plane) {
    std::vector<FlatFace> out;
    std::vector<glm::dvec3> part;
    for (const double side : {1.0, -1.0}) {
        clip<glm::dvec3>(
            convex.loops[0], [&](glm::dvec3 p) { return side * plane.height(p); }, part);
        if (!part.empty()) out.push_back(convexFace(part, convex.normal));
    }
    return out;
}

const ShellTriangle& largestTriangle(const FlatFace& face) {
    return *std::ranges::max_element(face.triangles, {}, [](const ShellTriangle& t) {
        return glm::length(glm::cross(t.b - t.a, t.c - t.a));
    });
}

std::vector<FlatFace> flatFacesOf(const Building& building) {
    std::vector<FlatFace> out;
    for (const Face& face : building.faces) {
        FlatFace flat;
        flat.face = static_cast<uint32_t>(&face - building.faces.data());
        flat.surface = face.surface;
        for (const auto& loop : face.loops) {
            flat.loops.emplace_back();
            for (const uint32_t v : loop) flat.loops.back().push_back(building.vertices[v]);
        }
        for (const auto& t : triangulateFace(building, face))
            flat.triangles.push_back(
                {building.vertices[t[0]], building.vertices[t[1]], building.vertices[t[2]]});
        const glm::dvec3 area = areaVector(flat.loops[0]);
        if (!(glm::length(area) > 0)) continue;
        flat.origin = flat.loops[0][0];
        flat.normal = glm::normalize(area);
        flat.box = boundsOf(flat.loops[0]);
        flat.isGlass = !building.materials.empty() && building.materials[face.material].isOpening();
        flat.isWindow = flat.isGlass && face.twin == kNoTwin;
        out.push_back(std::move(flat));
    }
    return out;
}

std::vector<ShellTriangle> trianglesOf(const std::vector<FlatFace>& faces) {
    std::vector<ShellTriangle> out;
    for (const FlatFace& face : faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

std::vector<Bounds> boxesOf(const std::vector<FlatFace>& faces, double margin) {
    std::vector<Bounds> out;
    for (const FlatFace& face : faces) out.push_back({face.box.low - margin, face.box.high + margin});
    return out;
}

Bounds boundsOfFaces(const std::vector<FlatFace>& faces) {
    Bounds out = faces[0].box;
    for (const FlatFace& face : faces) out = united(out, face.box);
    return out;
}

double areaFromAbove(const Bounds& box) {
    const glm::dvec3 size = box.high - box.low;
    return size.x * size.z;
}

std::vector<Whole> wholesOf(const Building& building, const std::vector<FlatFace>& faces) {
    DisjointSets sets(building.faces.size());
    for (const auto& [edge, ofIt] : facesOfEdges(building))
        for (const uint32_t f : ofIt) sets.join(f, ofIt[0]);
    std::map<uint32_t, Whole> wholes; // by root
    for (const FlatFace& face : faces) {
        Whole& whole = wholes[sets.root(face.face)];
        whole.id = sets.root(face.face);
        whole.box = united(whole.box, face.box);
        const double area = 0.5 * glm::length(areaVector(face.loops[0]));
        whole.area += area;
        if (std::abs(face.normal.y) < kSteep) whole.steep += area;
    }
    std::vector<Whole> out;
    for (const FlatFace& face : faces) out.push_back(wholes[sets.root(face.face)]);
    return out;
}

} // namespace heliodon::geometry
