// Models out: .obj with .mtl beside it, or one .glb. Groups (objects) are named "room0_projection",
// "room0_fill-in", and what stands outside kOutsideGroup.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "geometry/corner_normals.h"
#include "geometry/glass_mark.h"
#include "geometry/input_error.h"
#include "geometry/last_decimal.h"
#include "geometry/model_faces.h"
#include "geometry/model_file.h"
#include "geometry/raw_model.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::geometry {

namespace {

using GroupKey = std::pair<uint32_t, Role>;

std::string groupName(GroupKey key) {
    return fmt::format("room{}_{}", key.first, key.second == Role::projection ? "projection" : "fill-in");
}

std::map<GroupKey, std::vector<size_t>> groups(const PatchMesh& mesh) {
    std::map<GroupKey, std::vector<size_t>> out;
    for (size_t i = 0; i < mesh.patchCount(); ++i) out[{mesh.room[i], mesh.role[i]}].push_back(i);
    for (auto& [key, patches] : out)
        std::ranges::stable_sort(patches, {},
                                 [&](size_t i) { return std::pair(mesh.material[i], mesh.surface[i]); });
    return out;
}

// Triangles of what stands outside, by their first corners in the list, of each material. Where it has none,
// it is black to heliodon; other programs show it as they show walls.
std::map<uint32_t, std::vector<size_t>> outsideByMaterial(const PatchMesh& mesh) {
    const auto wall = std::ranges::find_if_not(mesh.materials, &Material::isOpening);
    const auto any = wall == mesh.materials.end() ? 0 : static_cast<uint32_t>(wall - mesh.materials.begin());
    const Occluders& outside = mesh.outside;
    std::map<uint32_t, std::vector<size_t>> out;
    for (size_t t = 0; t < outside.triangles.size(); t += 3)
        out[outside.material.empty() ? any : outside.material[t / 3]].push_back(t);
    return out;
}

struct TwinFaces {
    GlassMark glass;
    std::vector<size_t> pairs; // of interior panes: faces by their order in the file
};

// Counted from `first` on. None of a mesh without glass.
std::optional<TwinFaces> twinFaces(const PatchMesh& mesh, size_t first) {
    std::vector<size_t> place(mesh.patchCount()), glass;
    size_t next = first; // .glb holds triangles only
    for (const auto& [key, patches] : groups(mesh))
        for (const size_t i : patches) {
            place[i] = next++;
            if (mesh.materials[mesh.material[i]].isOpening()) glass.push_back(i);
        }
    if (glass.empty()) return std::nullopt;
    TwinFaces out{glassMark(mesh.vertices, mesh.corners, mesh.firstCorner, glass), {}};
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (const int32_t twin = mesh.twin[i]; twin >= 0 && static_cast<size_t>(twin) > i)
            out.pairs.insert(out.pairs.end(), {place[i], place[static_cast<size_t>(twin)]});
    return out;
}

// Names of materials must differ and hold no blanks at their ends.
std::vector<std::string> materialNames(const PatchMesh& mesh, bool utf8 = false) {
    std::vector<std::string> names;
    for (const Material& material : mesh.materials) {
        std::string name = material.name.empty() ? "material" : material.name;
        std::ranges::replace_if(
            name, [](unsigned char c) { return c <= ' ' || c == '#'; }, '_');
        if (utf8) name = asUtf8(name);
        const std::string base = name;
        for (int copy = 2; std::ranges::find(names, name) != names.end(); ++copy)
            name = base + "_" + std::to_string(copy);
        names.push_back(name);
    }
    return names;
}

std::string mtlText(const PatchMesh& mesh) {
    const std::vector<std::string> names = materialNames(mesh);
    std::string text =
        "# Kd diffuse reflectance; Tf visible transmittance at normal incidence; Ni 1.52 glass, 1.0 open; "
        "Ke exitance, lux; blinds: before the window, heliodon's own\n";
    const auto rgb = [&](const char* key, glm::vec3 v) {
        text += fmt::format("{} {} {} {}\n", key, v.x, v.y, v.z);
    };
    for (size_t i = 0; i < names.size(); ++i) {
        const Material& material = mesh.materials[i];
        text += "newmtl " + names[i] + "\n";
        const bool blinds = material.blind != Blind{};
        rgb("Kd", blinds ? glm::vec3(0) : material.reflectance); // drawn blinds reflect: not the glass
        if (material.isOpening()) {
            rgb("Tf", material.transmittance);
            text += fmt::format("Ni {}\n", material.refractiveIndex);
            // Kd of glass is black, and viewers that know no Tf would show it so.
            const glm::vec3 through = glm::clamp(material.transmittance, 0.0f, 1.0f);
            text += fmt::format("d {:.3g}\n", 1 - (through.x + through.y + through.z) / 3);
        }
        if (blinds) text += fmt::format("blinds {}\n", blindText(material.blind));
        if (material.exitance != glm::vec3(0)) rgb("Ke", material.exitance);
    }
    return text;
}

// Normals of curved surfaces, so that they are smooth where the file is read again; then all corners have
// one. Without any curved surface there are none.
struct Normals {
    std::vector<glm::vec3> different;
    std::vector<uint32_t> ofCorner; // into `different`

    explicit Normals(const PatchMesh& mesh) {
        std::map<std::array<float, 3>, uint32_t> known;
        for (const glm::dvec3 exact : cornerNormals(mesh)) {
            const glm::vec3 n(glm::round(exact * 1e5) / 1e5 + 0.0); // 2 seconds of arc, and no -0
            const auto [place, isNew] =
                known.try_emplace({n.x, n.y, n.z}, static_cast<uint32_t>(different.size()));
            if (isNew) different.push_back(n);
            ofCorner.push_back(place->second);
        }
    }
};

std::string outsideText(const PatchMesh& mesh, std::span<const std::string> names) {
    const std::vector<uint32_t>& triangles = mesh.outside.triangles;
    if (triangles.empty()) return "";
    std::string text =
        fmt::format("# before windows, seen from outside; heliodon's own\no {0}\ng {0}\n", kOutsideGroup);
    for (const glm::dvec3& p : mesh.outside.vertices) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    const size_t first = mesh.vertices.size() + 1;
    for (const auto& [material, ofIt] : outsideByMaterial(mesh)) {
        text += fmt::format("usemtl {}\n", names[material]);
        for (const size_t t : ofIt)
            text += fmt::format("f {} {} {}\n", first + triangles[t], first + triangles[t + 1],
                                first + triangles[t + 2]);
    }
    return text;
}

void writeObj(const PatchMesh& mesh, const std::filesystem::path& file, double northDeg) {
    std::filesystem::path library = file;
    library.replace_extension(".mtl");
    std::string name = library.filename().string();
    std::ranges::replace(name, '#', '_'); // would begin a comment
    library.replace_filename(name);
    const std::vector<std::string> names = materialNames(mesh);
    std::string text =
        fmt::format("# metres, y up; faces counter-clockwise seen from the room's air\nmtllib {}\n", name);
    text += fmt::format(
        "# north: degrees counter-clockwise from +x seen from above; heliodon's own\nnorth {}\n", northDeg);
    for (const glm::dvec3& p : mesh.vertices)
        text += fmt::format("v {} {} {}\n", p.x, p.y, p.z); // shortest that reads back
    const Normals normals(mesh);
    for (const glm::vec3 n : normals.different) text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
    for (const auto& [key, patches] : groups(mesh)) {
        // Some programs make objects of one, some of the other.
        text += fmt::format("o {0}\ng {0}\n", groupName(key));
        size_t material = mesh.materials.size();
        for (const size_t i : patches) {
            if (mesh.material[i] != material) {
                material = mesh.material[i];
                text += "usemtl " + names[material] + "\n";
            }
            text += "f";
            for (uint32_t c = mesh.firstCorner[i]; c < mesh.firstCorner[i + 1]; ++c) {
                text += fmt::format(" {}", mesh.corners[c] + 1);
                if (!normals.ofCorner.empty()) text += fmt::format("//{}", normals.ofCorner[c] + 1);
            }
            text += "\n";
        }
    }
    text += outsideText(mesh, names);
    if (const auto twins = twinFaces(mesh, 1)) {
        constexpr size_t kOfLine = 16;
        text += fmt::format(
            "# the two sides of glass between rooms, of all faces, by their order from 1, and how "
            "much glass there was where; other glass looks outside; heliodon's own\n"
            "twins of {} glass {}",
            mesh.patchCount(), fmt::join(numbersOf(twins->glass), " "));
        for (size_t k = 0; k < twins->pairs.size(); ++k)
            text += fmt::format("{}{}", k % kOfLine == 0 ? "\ntwins " : " ", twins->pairs[k]);
        text += "\n";
    }
    // Materials when all else is written: without a model none appear, nor replace those of an older one.
    writeWhole(file, [&](const std::filesystem::path& aside) {
        writeTextAside(aside, file, text);
        writeWholeText(library, mtlText(mesh));
    });
}

class GlbWriter {
public:
    GlbWriter(const PatchMesh& mesh, double northDeg)
        : mesh_(mesh), northDeg_(northDeg), normals_(mesh), points_(mesh.corners),
          origin_(originOf(mesh.vertices)) {}

    std::string bytes() {
        // Every list first: an ordered object moves its members when it grows.
        for (const char* list : {"asset", "scene", "scenes", "nodes", "meshes", "materials", "accessors",
                                 "bufferViews", "buffers"})
            json_[list] = nlohmann::ordered_json::array();
        json_["asset"] = {{"version", "2.0"}, {"generator", "heliodon " HELIODON_VERSION}};
        json_["asset"]["extras"]["north_deg"] = northDeg_;
        if (const auto twins = twinFaces(mesh_, 0)) {
            nlohmann::ordered_json glass = numbersOf(twins->glass);
            glass[0] = twins->glass.panes;
            json_["asset"]["extras"]["twins"] = {
                {"of", mesh_.patchCount()}, {"glass", glass}, {"pairs", twins->pairs}};
        }
        json_["scene"] = 0;
        addMaterials();
        addPoints();
        nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
        for (const auto& [key, patches] : groups(mesh_)) addGroup(key, patches, nodes);
        addOutside(nodes);
        json_["scenes"] = {{{"nodes", nodes}}};
        json_["buffers"] = {{{"byteLength", data_.size()}}};
        std::string text = json_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out;
        for (const uint32_t word :
             {0x46546C67u, 2u, static_cast<uint32_t>(12 + 8 + text.size() + 8 + data_.size())})
            append(out, word);
        append(out, static_cast<uint32_t>(text.size()));
        append(out, 0x4E4F534Au);
        out += text;
        append(out, static_cast<uint32_t>(data_.size()));
        append(out, 0x004E4942u);
        return out + data_;
    }

private:
    // Of the nodes, as positions are of single precision, which far off, as in a national grid, moves
    // corners; 0 where it moves them by less than what is read as one corner.
    static glm::dvec3 originOf(const std::vector<glm::dvec3>& places) {
        glm::dvec3 low(places[0]), high(low);
        for (const glm::dvec3& p : places) low = glm::min(low, p), high = glm::max(high, p);
        const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
        const bool isNear =
            singleStep(std::max({far.x, far.y, far.z})) < kWeldOfExtent * glm::length(high - low);
        return isNear ? glm::dvec3(0) : glm::round(0.5 * (low + high));
    }

    // glTF is little-endian.
    template<class Value> static void append(std::string& out, Value value) {
        static_assert(std::endian::native == std::endian::little);
        std::array<char, sizeof value> raw{};
        std::memcpy(raw.data(), &value, sizeof value);
        out.append(raw.data(), raw.size());
    }

    // The reader's rule backwards: what is transmitted is tinted by the base colour, the rest of it
    // reflected.
    void addMaterials() {
        const std::vector<std::string> names = materialNames(mesh_, true);
        for (size_t i = 0; i < names.size(); ++i) {
            Material material = mesh_.materials[i];
            if (material.blind != Blind{}) material.reflectance = glm::vec3(0); // that of the drawn blind
            // Files may hold sums that rounding has put above 1.
            const glm::vec3 base = glm::min(material.reflectance + material.transmittance, glm::vec3(1));
            const float sum = base.x + base.y + base.z;
            const float through = sum > 0
                                      ? std::min(1.0f, (material.transmittance.x + material.transmittance.y +
                                                        material.transmittance.z) /
                                                           sum)
                                      : 0;
            nlohmann::ordered_json out{{"name", names[i]},
                                       {"pbrMetallicRoughness",
                                        {{"baseColorFactor", {base.x, base.y, base.z, 1}},
                                         {"metallicFactor", 0},
                                         {"roughnessFactor", material.isOpening() ? 0 : 1}}}};
            nlohmann::ordered_json extensions;
            if (through > 0) {
                extensions["KHR_materials_transmission"] = {{"transmissionFactor", through}};
                extensions["KHR_materials_ior"] = {{"ior", material.refractiveIndex}};
            }
            const float strength = std::max({material.exitance.x, material.exitance.y, material.exitance.z});
            if (strength > 0) {
                const glm::vec3 hue = material.exitance / strength;
                out["emissiveFactor"] = {hue.x, hue.y, hue.z};
                extensions["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
            }
            for (const auto& [name, value] : extensions.items())
                if (!json_.contains("extensionsUsed") ||
                    std::ranges::find(json_["extensionsUsed"], nlohmann::ordered_json(name)) ==
                        json_["extensionsUsed"].end())
                    json_["extensionsUsed"].push_back(name);
            if (!extensions.empty()) out["extensions"] = extensions;
            if (material.blind != Blind{}) out["extras"] = {{"blinds", blindText(material.blind)}};
            json_["materials"].push_back(out);
        }
    }

    size_t addView(size_t begin, int target) {
        json_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", data_.size() - begin}, {"target", target}});
        return json_["bufferViews"].size() - 1;
    }

    // glTF has one normal a point: where surfaces meet at a vertex of the mesh, each has a point of its own.
    void addPoints() {
        std::vector<glm::dvec3> places = mesh_.vertices;
        std::vector<glm::vec3> directions;
        if (!normals_.ofCorner.empty()) {
            places.clear();
            std::map<std::pair<uint32_t, uint32_t>, uint32_t> known; // vertex and normal
            for (size_t c = 0; c < points_.size(); ++c) {
                const auto [point, isNew] = known.try_emplace({mesh_.corners[c], normals_.ofCorner[c]},
                                                              static_cast<uint32_t>(places.size()));
                points_[c] = point->second;
                if (!isNew) continue;
                places.push_back(mesh_.vertices[mesh_.corners[c]]);
                directions.push_back(glm::normalize(normals_.different[normals_.ofCorner[c]]));
            }
        }
        attributes_["POSITION"] = addPlaces(places);
        if (directions.empty()) return;
        const size_t begin = data_.size();
        for (const glm::vec3 n : directions)
            for (int c = 0; c < 3; ++c) append(data_, n[c]);
        attributes_["NORMAL"] = addVectors(begin, directions.size());
    }

    size_t addPlaces(const std::vector<glm::dvec3>& places) {
        const size_t begin = data_.size();
        glm::vec3 low(1e30f), high(-1e30f);
        for (const glm::dvec3& p : places) {
            const glm::vec3 q(p - origin_);
            low = glm::min(low, q);
            high = glm::max(high, q);
            for (int c = 0; c < 3; ++c) append(data_, q[c]);
        }
        const size_t accessor = addVectors(begin, places.size());
        json_["accessors"].back().update({{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}});
        return accessor;
    }

    size_t addVectors(size_t begin, size_t count) {
        json_["accessors"].push_back({{"bufferView", addView(begin, 34962)},
                                      {"componentType", 5126},
                                      {"count", count},
                                      {"type", "VEC3"}});
        return json_["accessors"].size() - 1;
    }

    void addGroup(GroupKey key, const std::vector<size_t>& patches, nlohmann::ordered_json& nodes) {
        nlohmann::ordered_json primitives = nlohmann::ordered_json::array();
        for (size_t first = 0; first < patches.size();) {
            const uint32_t material = mesh_.material[patches[first]];
            const size_t begin = data_.size();
            for (; first < patches.size() && mesh_.material[patches[first]] == material; ++first) {
                const uint32_t own = mesh_.firstCorner[patches[first]],
                               next = mesh_.firstCorner[patches[first] + 1];
                for (uint32_t c = own + 1; c + 1 < next; ++c)
                    for (const uint32_t corner : {own, c, c + 1}) append(data_, points_[corner]);
            }
            primitives.push_back(primitive(attributes_, begin, material));
        }
        addNode(groupName(key), primitives, nodes);
    }

    void addOutside(nlohmann::ordered_json& nodes) {
        if (mesh_.outside.triangles.empty()) return;
        nlohmann::ordered_json attributes;
        attributes["POSITION"] = addPlaces(mesh_.outside.vertices);
        nlohmann::ordered_json primitives = nlohmann::ordered_json::array();
        for (const auto& [material, triangles] : outsideByMaterial(mesh_)) {
            const size_t begin = data_.size();
            for (const size_t t : triangles)
                for (size_t k = 0; k < 3; ++k) append(data_, mesh_.outside.triangles[t + k]);
            primitives.push_back(primitive(attributes, begin, material));
        }
        addNode(kOutsideGroup, primitives, nodes);
    }

    // Of the indices that `data_` ends with.
    nlohmann::ordered_json primitive(const nlohmann::ordered_json& attributes, size_t begin,
                                     uint32_t material) {
        json_["accessors"].push_back({{"bufferView", addView(begin, 34963)},
                                      {"componentType", 5125},
                                      {"count", (data_.size() - begin) / 4},
                                      {"type", "SCALAR"}});
        return {
            {"attributes", attributes}, {"indices", json_["accessors"].size() - 1}, {"material", material}};
    }

    void addNode(const std::string& name, const nlohmann::ordered_json& primitives,
                 nlohmann::ordered_json& nodes) {
        json_["meshes"].push_back({{"name", name}, {"primitives", primitives}});
        const size_t meshIndex = json_["meshes"].size() - 1;
        json_["nodes"].push_back({{"name", name}, {"mesh", meshIndex}});
        if (origin_ != glm::dvec3(0))
            json_["nodes"].back()["translation"] = {origin_.x, origin_.y, origin_.z};
        nodes.push_back(json_["nodes"].size() - 1);
    }

    const PatchMesh& mesh_;
    double northDeg_;
    Normals normals_;
    std::vector<uint32_t> points_; // of the file, per corner of the mesh
    glm::dvec3 origin_;
    nlohmann::ordered_json json_, attributes_;
    std::string data_;
};

} // namespace

void writeModel(const PatchMesh& mesh, const std::filesystem::path& file, double northDeg) {
    if (mesh.patchCount() == 0) throw InputError(file.string(), "", "would hold no faces");
    if (file.extension() == ".obj") return writeObj(mesh, file, northDeg);
    if (file.extension() == ".glb") return writeWholeText(file, GlbWriter(mesh, northDeg).bytes());
    throw InputError(file.string(), "", "is no model to write, expected .obj or .glb");
}

} // namespace heliodon::geometry
