#include "geometry/model_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/disjoint_sets.h"
#include "geometry/input_error.h"
#include "geometry/outline_area.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

namespace {

// How far a corner may lie off the face's plane, as a fraction of the face's extent and of the coordinates'
// size: files hold 6 or 7 digits.
constexpr double kPlanarOfExtent = 1e-5, kPlanarOfCoordinate = 2e-7;
constexpr double kLeastAreaOfExtent = 1e-9; // of extent squared; below, the normal is noise
constexpr double kLeastTurn = -1e-6;        // sine of the turn at a corner; straight corners are welcome

// Throws InputError unless the face is a planar, convex polygon with an area.
void checkFace(const RawModel& model, size_t i) {
    const auto corner = model.face(i);
    const size_t n = corner.size();
    const auto fail = [&](const std::string& what) { throw InputError(model.file, model.place(i), what); };
    const auto at = [&](size_t k) { return model.vertices[corner[k % n]]; };

    glm::dvec3 sum{0}, low = at(0), high = at(0);
    for (size_t k = 0; k < n; ++k) {
        sum += glm::cross(at(k) - at(0), at(k + 1) - at(0));
        low = glm::min(low, at(k));
        high = glm::max(high, at(k));
        if (at(k) == at(k + 1)) fail("the face repeats a corner");
    }
    const double extent = glm::length(high - low), twiceArea = glm::length(sum);
    if (!(twiceArea > 2 * kLeastAreaOfExtent * extent * extent)) fail("the face has no area");
    const glm::dvec3 normal = sum / twiceArea;
    const double largest = std::max(glm::length(low), glm::length(high));
    const double tolerance = kPlanarOfExtent * extent + kPlanarOfCoordinate * largest;
    double turned = 0;
    for (size_t k = 0; k < n; ++k) {
        const double off = std::abs(glm::dot(at(k) - at(0), normal));
        if (off > tolerance)
            fail(fmt::format("the face is not planar, a corner lies {:.3g} off its plane: divide it into "
                             "triangles where it should fold",
                             off));
        const glm::dvec3 in = glm::normalize(at(k + 1) - at(k)), out = glm::normalize(at(k + 2) - at(k + 1));
        const double sine = glm::dot(glm::cross(in, out), normal);
        if (sine < kLeastTurn)
            fail("the face is not convex, as a patch must be; `heliodon model` cuts such faces");
        turned += std::atan2(sine, glm::dot(in, out));
    }
    if (turned > 3 * std::numbers::pi) fail("the face winds round itself");
}

// Coplanar faces of one material that share an edge are one surface; edges are matched by position.
class SurfaceFinder {
public:
    explicit SurfaceFinder(PatchMesh& mesh) : mesh_(mesh), surfaces_(mesh.patchCount()) {}

    void find() {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> patchOfEdge;
        const std::vector<uint32_t> welded = weldExactly();
        for (uint32_t i = 0; i < mesh_.patchCount(); ++i) {
            const auto corner = mesh_.patch(i);
            for (size_t k = 0; k < corner.size(); ++k) {
                const uint32_t a = welded[corner[k]], b = welded[corner[(k + 1) % corner.size()]];
                const auto [place, isNew] = patchOfEdge.try_emplace(std::minmax(a, b), i);
                if (!isNew && alike(i, place->second)) surfaces_.join(i, place->second);
            }
        }
        std::map<uint32_t, uint32_t> ids;
        for (uint32_t i = 0; i < mesh_.patchCount(); ++i)
            mesh_.surface[i] =
                ids.try_emplace(surfaces_.root(i), static_cast<uint32_t>(ids.size())).first->second;
    }

private:
    std::vector<uint32_t> weldExactly() const {
        const auto less = [](const glm::dvec3& a, const glm::dvec3& b) {
            return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        };
        std::map<glm::dvec3, uint32_t, decltype(less)> first(less);
        std::vector<uint32_t> welded(mesh_.vertices.size());
        for (uint32_t v = 0; v < welded.size(); ++v)
            welded[v] = first.try_emplace(mesh_.vertices[v] + 0.0, v).first->second;
        return welded;
    }

    bool alike(uint32_t i, uint32_t j) const {
        if (mesh_.material[i] != mesh_.material[j] || mesh_.room[i] != mesh_.room[j]) return false;
        return inOnePlane(patchNormal(mesh_, i), patchNormal(mesh_, j));
    }

    PatchMesh& mesh_;
    DisjointSets surfaces_;
};

} // namespace

glm::dvec3 worldFromModel(glm::dvec3 p, UpAxis up) {
    return up == UpAxis::y ? p : glm::dvec3(p.x, p.z, -p.y);
}

double assumedWorldPerBuilding(std::span<const glm::dvec3> corners) {
    constexpr double kLowestRoom = 1.0; // metres: nobody works in less
    const Bounds box = boundsOf(corners);
    return box.high.y - box.low.y < kLowestRoom ? 1.0 / 12 : 1.0;
}

PatchMesh readPatches(const std::filesystem::path& file, UpAxis up, const GivenMaterials& given) {
    const RawModel model = readRawModel(file, given);
    PatchMesh mesh;
    for (const glm::dvec3& p : model.vertices) mesh.vertices.push_back(worldFromModel(p, up));
    mesh.materials = model.materials;
    for (size_t i = 0; i < model.faceCount(); ++i) {
        checkFace(model, i);
        mesh.addPatch(model.face(i), model.material[i], Role::projection, 0, 0);
    }
    SurfaceFinder(mesh).find();
    for (const auto& [face, material] : model.outside)
        for (size_t k = 1; k + 1 < face.size(); ++k) {
            mesh.outside.triangles.insert(mesh.outside.triangles.end(), {face[0], face[k], face[k + 1]});
            mesh.outside.material.push_back(material);
        }
    if (!model.outside.empty()) mesh.outside.vertices = mesh.vertices;
    return mesh;
}

} // namespace heliodon::geometry
