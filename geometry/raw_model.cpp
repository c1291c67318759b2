#include "geometry/raw_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/counted.h"
#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

// R"(node "Window 2")"; what is longer than 40 characters is cut off.
std::string shown(const RawModel::Object& object) {
    const auto& [kind, name] = object;
    constexpr size_t kMost = 40;
    size_t end = 0;
    for (size_t characters = 0; end < name.size(); ++end) {
        const bool begins = (static_cast<unsigned char>(name[end]) & 0xC0) != 0x80; // a character of UTF-8
        if (begins && characters++ == kMost) break;
    }
    return fmt::format("{} \"{}{}\"", kind, name.substr(0, end), end < name.size() ? "..." : "");
}

// As a shell takes it for one word, whatever is in it.
std::string forShell(const std::string& word) {
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? R"('\'')" : std::string(1, c);
    return "'" + quoted + "'";
}

constexpr double kOfRoom = 0.5; // of all area: what has more is no thing in the room

} // namespace

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
    const auto alone = static_cast<uint32_t>(i);
    return places({&alone, 1});
}

std::string RawModel::places(std::span<const uint32_t> faces) const {
    std::string out;
    for (size_t k = 0; k < faces.size(); ++k) {
        const uint32_t f = faces[k], g = group[f];
        if (k > 0) out += ", ";
        out += source[g].empty() ? std::to_string(number[f])
                                 : fmt::format("{} triangle {}", source[g], number[f]);
        const bool last = k + 1 == faces.size() || object[group[faces[k + 1]]] != object[g];
        if (last && !object[g].name.empty()) out += " (" + shown(object[g]) + ")";
    }
    return out;
}

InputError RawModel::errorAt(uint32_t face, const std::string& what) const {
    return {file, place(face), what, {.faces = {face}}};
}

InputError RawModel::openAt(uint32_t face, const std::string& what) const {
    return {file, place(face), what, {.faces = {face}, .isOpen = true}};
}

std::string RawModel::doWithoutNamed(const InputError& error) const {
    const std::string message = error.what();
    const auto& faces = error.where().faces;
    const bool isOfPane = !faces.empty() && materials[material[faces[0]]].isOpening();
    struct Share {
        double area = 0;
        bool hasGlass = false;
    };
    std::map<std::string, Share> known;
    std::map<size_t, const Object*> named; // by where in the message
    double whole = 0;
    for (size_t i = 0; i < group.size(); ++i) {
        const Object& its = object[group[i]];
        const double area = glm::length(areaVector(vertices, face(i)));
        whole += area;
        const auto [share, isNew] = known.try_emplace(its.name);
        share->second.area += area;
        share->second.hasGlass |= materials[material[i]].isOpening();
        if (its.name.empty() || !isNew) continue;
        const size_t at = message.find(fmt::format("({})", shown(its)));
        if (at != message.npos) named.try_emplace(at, &its);
    }
    if (isOfPane && named.size() > 1 && known[named.begin()->second->name].hasGlass)
        named.erase(named.begin()); // what lies on the pane
    if (named.empty() || known.size() < 2) return "";
    const Object& first = *named.begin()->second;
    if (const Share& its = known[first.name]; its.hasGlass || its.area > kOfRoom * whole) return "";
    return fmt::format("; --leave-out={} does without this {}", forShell(first.name), first.kind);
}

std::vector<std::vector<uint32_t>> RawModel::loops(size_t i) const {
    const std::vector<uint32_t> whole(face(i).begin(), face(i).end());
    if (whole.size() == 3) return {whole};
    std::map<std::array<double, 3>, uint32_t> places; // some programs write a corner each time it is run by
    std::vector<uint32_t> merged;
    for (const uint32_t v : whole) {
        const glm::dvec3& p = vertices[v];
        merged.push_back(places.try_emplace({p.x, p.y, p.z}, v).first->second);
    }
    if (places.size() == whole.size()) return {whole};
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (size_t k = 0; k < whole.size(); ++k) edges.emplace(merged[k], merged[(k + 1) % whole.size()]);
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

std::optional<RawModel::Flaw> flawOf(const Material& material, const MaterialFields& fields,
                                     const std::string& file, const std::string& place) {
    using Kind = RawModel::Flaw::Kind;
    const auto flaw = [&](const std::string& what, Kind kind = Kind::unphysical) {
        return RawModel::Flaw{kind, file, place, fmt::format("material \"{}\": {}", material.name, what)};
    };
    const float ior = material.refractiveIndex;
    if (!(ior >= 1 && ior <= 4))
        return flaw(fmt::format("refractive index ({}) is {}, expected 1 to 4", fields.refractiveIndex, ior));
    for (int c = 0; c < 3; ++c) {
        const float kd = material.reflectance[c], tf = material.transmittance[c], ke = material.exitance[c];
        if (!(kd >= 0 && kd < 1)) {
            const bool tooBright = kd >= 1 && std::isfinite(kd) && !material.isOpening();
            return flaw(fmt::format("reflectance ({}) is {}, expected 0 to below 1 (white paint: 0.85{})",
                                    fields.reflectance, kd,
                                    tooBright ? ", as which --reflectance 0.85 takes it" : ""),
                        tooBright ? Kind::tooBright : Kind::unphysical);
        }
        if (!(tf >= 0 && tf <= 1))
            return flaw(fmt::format("transmittance ({}) is {}, expected 0 to 1", fields.transmittance, tf));
        if (kd + tf > 1 + 1e-6f)
            return flaw(
                fmt::format("reflectance {0} and transmittance ({1}) {2} add up to more than 1; an opaque "
                            "material has no {1}",
                            kd, fields.transmittance, tf));
        if (!(ke >= 0 && ke <= kBrightest))
            return flaw(
                fmt::format("exitance ({}) is {}, expected 0 to {:g} lux", fields.exitance, ke, kBrightest));
    }
    return std::nullopt;
}

namespace {

void checkReach(const RawModel& model) {
    const glm::dvec3 first = model.vertices[model.corners[0]];
    const auto check = [&](std::span<const uint32_t> corners, const auto& place) {
        for (const uint32_t v : corners)
            for (int c = 0; c < 3; ++c) {
                const double at = model.vertices[v][c], across = at - first[c];
                const bool isNear = std::abs(at) <= kFarthest;
                if (isNear && std::abs(across) <= kLargest) continue;
                throw InputError(
                    model.file, place(),
                    isNear ? fmt::format("a corner of the face lies {:.3g} from that of the first face, "
                                         "expected -{:g} to {:g} (metres)",
                                         across, kLargest, kLargest)
                           : fmt::format("a corner of the face has the coordinate {:.3g}, expected -{:g} "
                                         "to {:g}",
                                         at, kFarthest, kFarthest));
            }
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
    if (std::ranges::find(model.materials, glazing.material, &Material::name) == model.materials.end()) {
        std::vector<std::string> names;
        for (const Material& material : model.materials) names.push_back(material.name);
        throw InputError(
            model.file, glazing.material,
            fmt::format("is no material of this model, expected one of {}", fmt::join(names, ", ")));
    }
    for (uint32_t number = 0; number < model.materials.size(); ++number) { // a file may define it twice
        Material& material = model.materials[number];
        if (material.name != glazing.material) continue;
        material = {.name = material.name, .transmittance = glazing.transmittance, .blind = material.blind};
        model.assumed.erase(number), model.doubts.erase(number), model.unread.erase(number);
        std::erase_if(model.flaws, [&](const RawModel::Flaw& flaw) {
            return flaw.kind != RawModel::Flaw::Kind::missingFile && flaw.material == number;
        });
    }
}

// Throws what nothing given mends.
void mendMaterials(RawModel& model, const GivenMaterials& given) {
    for (const Glazing& one : given.glazing) makeGlass(model, one);
    std::vector<uint32_t> undefined;
    for (const RawModel::Flaw& flaw : model.flaws) {
        if (!given.reflectance || flaw.kind == RawModel::Flaw::Kind::unphysical) {
            const auto texture = model.unread.find(flaw.material); // would have made white less
            const bool lacks = flaw.kind == RawModel::Flaw::Kind::tooBright && texture != model.unread.end();
            throw InputError(flaw.file, flaw.place,
                             flaw.what + (lacks ? "; not read: " + texture->second : ""));
        }
        if (flaw.kind == RawModel::Flaw::Kind::missingFile) continue;
        Material& material = model.materials[flaw.material];
        if (flaw.kind == RawModel::Flaw::Kind::undefined) {
            material.reflectance = glm::vec3(*given.reflectance);
            undefined.push_back(flaw.material);
            continue;
        }
        const glm::vec3 stated = material.reflectance;
        const float most = std::max({stated.x, stated.y, stated.z});
        material.reflectance *= *given.reflectance / most;
        model.assumed[flaw.material] =
            fmt::format("material \"{}\" states a reflectance of {}: it was taken as {} (--reflectance)",
                        material.name, most, *given.reflectance);
    }
    if (undefined.empty()) return;
    std::string names;
    constexpr size_t kFew = 5;
    for (size_t k = 0; k < std::min(kFew, undefined.size()); ++k)
        names += (k == 0 ? "" : ", ") + model.materials[undefined[k]].name;
    if (undefined.size() > kFew) names += fmt::format(" and {} more", undefined.size() - kFew);
    model.assumed[undefined[0]] =
        fmt::format("{} that {} not defined ({}): a reflectance of {} was taken (--reflectance)",
                    counted(undefined.size(), "material"), undefined.size() == 1 ? "is" : "are", names,
                    *given.reflectance);
}

std::string namesIn(const RawModel& model) {
    constexpr size_t kFew = 20;
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    };
    for (const RawModel::Object& object : model.object) add(object.name);
    for (const Material& material : model.materials) add(material.name);
    const size_t more = names.size() - std::min(names.size(), kFew);
    names.resize(names.size() - more);
    return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

// Their corners, too: what stands far off says nothing of the size of the rest.
void dropFaces(RawModel& model, const std::vector<bool>& gone) {
    const std::vector<uint32_t> corners = model.corners, firstCorner = model.firstCorner;
    std::vector<bool> isOfRest(model.vertices.size(), false);
    size_t kept = 0, end = 0;
    for (size_t f = 0; f < gone.size(); ++f) {
        if (gone[f]) continue;
        for (uint32_t c = firstCorner[f]; c < firstCorner[f + 1]; ++c, ++end) {
            model.corners[end] = corners[c];
            if (!model.cornerNormals.empty()) model.cornerNormals[end] = model.cornerNormals[c];
            isOfRest[corners[c]] = true;
        }
        if (!model.smoothing.empty()) model.smoothing[kept] = model.smoothing[f];
        model.material[kept] = model.material[f];
        model.group[kept] = model.group[f];
        model.number[kept] = model.number[f];
        model.firstCorner[++kept] = static_cast<uint32_t>(end);
    }
    model.corners.resize(end), model.firstCorner.resize(kept + 1);
    model.cornerNormals.resize(std::min(model.cornerNormals.size(), end));
    model.smoothing.resize(std::min(model.smoothing.size(), kept));
    model.material.resize(kept), model.group.resize(kept), model.number.resize(kept);
    for (const RawModel::Outside& face : model.outside)
        for (const uint32_t v : face.corners) isOfRest[v] = true;
    if (end == 0) return;
    for (size_t f = 0; f < gone.size(); ++f)
        for (uint32_t c = firstCorner[f]; gone[f] && c < firstCorner[f + 1]; ++c)
            if (!isOfRest[corners[c]]) model.vertices[corners[c]] = model.vertices[model.corners[0]];
}

void leaveOut(RawModel& model, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::vector<size_t> count(names.size(), 0);
    std::vector<bool> gone(model.faceCount(), false);
    for (size_t k = 0; k < names.size(); ++k) {
        const auto isIt = [&](uint32_t g, uint32_t m) {
            return model.groups[g] == names[k] || model.object[g].name == names[k] ||
                   model.materials[m].name == names[k] ||
                   (g < model.above.size() &&
                    std::ranges::find(model.above[g], names[k]) != model.above[g].end());
        };
        for (size_t f = 0; f < gone.size(); ++f)
            if (isIt(model.group[f], model.material[f])) gone[f] = true, ++count[k];
        count[k] += std::erase_if(model.outside, [&](const RawModel::Outside& face) {
            return names[k] == kOutsideGroup || model.materials[face.material].name == names[k];
        });
        if (count[k] == 0)
            throw InputError(
                "--leave-out", names[k],
                fmt::format("names no face of {}, expected one of {}", model.file, namesIn(model)));
        model.leftOut.push_back(
            fmt::format("{} of \"{}\" left out (--leave-out)", counted(count[k], "face"), names[k]));
    }
    const std::vector<uint32_t> wasOf = model.material;
    dropFaces(model, gone);
    const auto isUsed = [](const std::vector<uint32_t>& all, uint32_t m) {
        return std::ranges::find(all, m) != all.end();
    };
    std::erase_if(model.flaws, [&](const RawModel::Flaw& flaw) {
        return flaw.kind != RawModel::Flaw::Kind::missingFile && isUsed(wasOf, flaw.material) &&
               !isUsed(model.material, flaw.material);
    });
}

} // namespace

RawModel readRawModel(const std::filesystem::path& file, const GivenMaterials& given) {
    RawModel model = readByExtension(file);
    leaveOut(model, given.leftOut);
    mendMaterials(model, given);
    if (model.faceCount() == 0) throw InputError(model.file, "", "holds no faces");
    checkReach(model);
    doubtOpaqueGlass(model);
    return model;
}

} // namespace heliodon::geometry
