#include "geometry/raw_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

void RawModel::addCorner(uint32_t vertex, glm::vec3 normal) {
    if (normal != glm::vec3(0) || !cornerNormals.empty()) {
        cornerNormals.resize(corners.size());
        cornerNormals.push_back(normal);
    }
    corners.push_back(vertex);
}

void RawModel::endFace(uint32_t itsMaterial, size_t itsNumber, uint32_t itsSmoothing) {
    if (groups.back() == kOutsideGroup) {
        outside.push_back({{corners.begin() + firstCorner.back(), corners.end()}, itsMaterial});
        corners.resize(firstCorner.back());
        cornerNormals.resize(std::min(cornerNormals.size(), corners.size()));
        return;
    }
    if (itsSmoothing != 0 || !smoothing.empty()) {
        smoothing.resize(faceCount());
        smoothing.push_back(itsSmoothing);
    }
    firstCorner.push_back(static_cast<uint32_t>(corners.size()));
    material.push_back(itsMaterial);
    group.push_back(static_cast<uint32_t>(groups.size() - 1));
    number.push_back(itsNumber);
}

std::string RawModel::place(size_t i) const {
    const std::string& name = source[group[i]];
    return name.empty() ? std::to_string(number[i]) : fmt::format("{} triangle {}", name, number[i]);
}

std::vector<std::vector<uint32_t>> RawModel::loops(size_t i) const {
    const std::vector<uint32_t> whole(face(i).begin(), face(i).end());
    if (whole.size() == 3) return {whole};
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (size_t k = 0; k < whole.size(); ++k) edges.emplace(whole[k], whole[(k + 1) % whole.size()]);
    std::map<uint32_t, uint32_t> next;
    size_t kept = 0;
    for (const auto& [a, b] : edges)
        if (!edges.contains({b, a})) {
            next[a] = b;
            ++kept;
        }
    if (kept == whole.size() || next.size() != kept) return {whole};
    std::vector<std::vector<uint32_t>> loops;
    while (!next.empty()) {
        std::vector<uint32_t> loop;
        for (auto at = next.begin(); at != next.end();) {
            const uint32_t to = at->second;
            loop.push_back(at->first);
            next.erase(at);
            at = next.find(to);
        }
        loops.push_back(std::move(loop));
    }
    if (loops.empty()) return {whole};
    std::vector<glm::dvec3> areas;
    for (const auto& loop : loops) areas.push_back(areaVector(vertices, loop));
    const auto largest = static_cast<size_t>(
        std::ranges::max_element(areas, {}, [](glm::dvec3 a) { return glm::length(a); }) - areas.begin());
    std::swap(loops[0], loops[largest]);
    std::swap(areas[0], areas[largest]);
    for (size_t l = 1; l < loops.size(); ++l) // holes run the other way round
        if (glm::dot(areas[l], areas[0]) > 0) return {whole};
    return loops;
}

std::string seeThroughButOpaque(const std::string& material, double opacity, const char* transmittance) {
    return fmt::format("material \"{}\" is see-through (opacity {}) but has no {}: it was taken as opaque "
                       "(--glass \"{}=0.8\" makes it glass)",
                       material, opacity, transmittance, material);
}

// Lux. The sun's surface has 6e9; squares of what is much brighter leave single precision.
constexpr float kBrightest = 1e10f;

void checkMaterial(const Material& material, const MaterialFields& fields, const std::string& file,
                   const std::string& place) {
    const auto fail = [&](const std::string& what) {
        throw InputError(file, place, fmt::format("material \"{}\": {}", material.name, what));
    };
    const float ior = material.refractiveIndex;
    if (!(ior >= 1 && ior <= 4))
        fail(fmt::format("refractive index ({}) is {}, expected 1 to 4", fields.refractiveIndex, ior));
    for (int c = 0; c < 3; ++c) {
        const float kd = material.reflectance[c], tf = material.transmittance[c], ke = material.exitance[c];
        if (!(kd >= 0 && kd < 1))
            fail(fmt::format("reflectance ({}) is {}, expected 0 to below 1 (white paint: 0.85)",
                             fields.reflectance, kd));
        if (!(tf >= 0 && tf <= 1))
            fail(fmt::format("transmittance ({}) is {}, expected 0 to 1", fields.transmittance, tf));
        if (kd + tf > 1 + 1e-6f)
            fail(fmt::format("reflectance {0} and transmittance ({1}) {2} add up to more than 1; an opaque "
                             "material has no {1}",
                             kd, fields.transmittance, tf));
        if (!(ke >= 0 && ke <= kBrightest))
            fail(fmt::format("exitance ({}) is {}, expected 0 to {:g} lux", fields.exitance, ke, kBrightest));
    }
}

namespace {

void checkReach(const RawModel& model) {
    const auto check = [&](std::span<const uint32_t> corners, const auto& place) {
        for (const uint32_t v : corners)
            for (int c = 0; c < 3; ++c)
                if (!(std::abs(model.vertices[v][c]) <= kFarthest))
                    throw InputError(
                        model.file, place(),
                        fmt::format("a corner of the face has the coordinate {:.3g}, expected -{:g} "
                                    "to {:g} (metres)",
                                    model.vertices[v][c], kFarthest, kFarthest));
    };
    for (size_t i = 0; i < model.faceCount(); ++i) check(model.face(i), [&] { return model.place(i); });
    for (const RawModel::Outside& face : model.outside)
        check(face.corners, [] { return std::string(kOutsideGroup); });
}

RawModel readByExtension(const std::filesystem::path& file) {
    const std::string extension = loweredExtension(file);
    if (extension == ".obj") return readObj(file);
    if (extension == ".gltf" || extension == ".glb") return readGltf(file);
    throw InputError(file.string(), "", "is no model, expected .obj, .gltf or .glb");
}

// Several programs write glass without a word of how much light passes, and without an opacity.
void doubtOpaqueGlass(RawModel& model) {
    for (uint32_t m = 0; m < model.materials.size(); ++m) {
        const Material& material = model.materials[m];
        const std::string name = lowered(material.name);
        const bool isGlass = name.find("glass") != name.npos || name.find("glazing") != name.npos;
        if (isGlass && !material.isOpening())
            model.doubts.try_emplace(m, fmt::format("material \"{}\" is glass by its name but has no "
                                                    "transmittance: it was taken as opaque (--glass "
                                                    "\"{}=0.8\" says which)",
                                                    material.name, material.name));
    }
}

void makeGlass(RawModel& model, const Glazing& glazing) {
    const auto found = std::ranges::find(model.materials, glazing.material, &Material::name);
    if (found == model.materials.end()) {
        std::vector<std::string> names;
        for (const Material& material : model.materials) names.push_back(material.name);
        throw InputError(
            model.file, glazing.material,
            fmt::format("is no material of this model, expected one of {}", fmt::join(names, ", ")));
    }
    *found = {.name = found->name, .transmittance = glazing.transmittance, .blind = found->blind};
    const auto number = static_cast<uint32_t>(found - model.materials.begin());
    model.assumed.erase(number), model.doubts.erase(number);
}

} // namespace

RawModel readRawModel(const std::filesystem::path& file, std::span<const Glazing> glazing) {
    RawModel model = readByExtension(file);
    for (const Glazing& one : glazing) makeGlass(model, one);
    if (model.faceCount() == 0) throw InputError(model.file, "", "holds no faces");
    checkReach(model);
    doubtOpaqueGlass(model);
    return model;
}

} // namespace heliodon::geometry
