#include "geometry/gltf_fields.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/input_error.h"

namespace heliodon::geometry {

namespace {

using nlohmann::json;

enum class Kind : uint8_t { number, index, text }; // index: a whole number, 0 and more

struct Field {
    std::string_view path; // "*" stands for each of a list
    Kind kind;
};

constexpr Field kFields[] = {
    {"scene", Kind::index},
    {"scenes.*.nodes.*", Kind::index},
    {"nodes.*.mesh", Kind::index},
    {"nodes.*.skin", Kind::index},
    {"nodes.*.children.*", Kind::index},
    {"nodes.*.matrix.*", Kind::number},
    {"nodes.*.translation.*", Kind::number},
    {"nodes.*.rotation.*", Kind::number},
    {"nodes.*.scale.*", Kind::number},
    {"nodes.*.weights.*", Kind::number},
    {"meshes.*.weights.*", Kind::number},
    {"meshes.*.primitives.*.attributes.POSITION", Kind::index},
    {"meshes.*.primitives.*.indices", Kind::index},
    {"meshes.*.primitives.*.material", Kind::index},
    {"meshes.*.primitives.*.mode", Kind::index},
    {"accessors.*.bufferView", Kind::index},
    {"accessors.*.byteOffset", Kind::index},
    {"accessors.*.componentType", Kind::index},
    {"accessors.*.count", Kind::index},
    {"bufferViews.*.buffer", Kind::index},
    {"bufferViews.*.byteOffset", Kind::index},
    {"bufferViews.*.byteLength", Kind::index},
    {"bufferViews.*.byteStride", Kind::index},
    {"buffers.*.uri", Kind::text},
    {"materials.*.alphaMode", Kind::text},
    {"materials.*.emissiveFactor.*", Kind::number},
    {"materials.*.pbrMetallicRoughness.baseColorFactor.*", Kind::number},
    {"materials.*.extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor.*", Kind::number},
    {"materials.*.extensions.KHR_materials_transmission.transmissionFactor", Kind::number},
    {"materials.*.extensions.KHR_materials_ior.ior", Kind::number},
    {"materials.*.extensions.KHR_materials_emissive_strength.emissiveStrength", Kind::number},
    {"extensionsRequired.*", Kind::text},
};

class FieldChecker {
public:
    explicit FieldChecker(const std::string& file) : file_(file) {}

    void check(const json& at, std::string_view path, Kind kind, const std::string& place) const {
        if (path.empty()) return checkKind(at, kind, place);
        const size_t dot = path.find('.');
        const std::string_view step = path.substr(0, dot),
                               rest = dot == path.npos ? std::string_view() : path.substr(dot + 1);
        if (step == "*") {
            if (!at.is_array()) throw InputError(file_, place, "expected a list");
            for (size_t i = 0; i < at.size(); ++i) check(at[i], rest, kind, fmt::format("{}[{}]", place, i));
            return;
        }
        if (!at.is_object()) throw InputError(file_, place, "expected an object");
        if (const auto found = at.find(step); found != at.end())
            check(*found, rest, kind, place.empty() ? std::string(step) : fmt::format("{}.{}", place, step));
    }

private:
    void checkKind(const json& at, Kind kind, const std::string& place) const {
        if (kind == Kind::number && !at.is_number()) throw InputError(file_, place, "expected a number");
        if (kind == Kind::text && !at.is_string()) throw InputError(file_, place, "expected a text");
        if (kind == Kind::index && !at.is_number_unsigned())
            throw InputError(file_, place, "expected a whole number, 0 or more");
    }

    std::string file_;
};

// Of a .glb its first chunk.
std::string_view jsonOf(std::string_view bytes) {
    constexpr size_t kHeader = 20;
    if (!bytes.starts_with("glTF") || bytes.size() < kHeader) return bytes;
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return bytes.substr(kHeader, length);
}

// Another version has other fields.
void checkVersion(const json& root, const std::string& file) {
    if (!root.is_object() || !root.contains("asset") || !root["asset"].is_object()) return;
    const json version = root["asset"].value("version", json());
    if (version.is_null()) return;
    const std::string text = version.is_string() ? version.get<std::string>() : version.dump();
    if (!text.starts_with("2."))
        throw InputError(file, "asset.version", fmt::format("is \"{}\", expected 2.0", text));
}

// What changes how things look may be passed over; what packs or places the triangles may not.
void checkExtensions(const json& root, const std::string& file) {
    for (const json& required : root.value("extensionsRequired", json::array())) {
        const auto name = required.get<std::string>();
        if (!name.starts_with("KHR_materials_") && !name.starts_with("KHR_texture_") &&
            !name.starts_with("EXT_texture_") && name != "KHR_lights_punctual" &&
            name != "KHR_mesh_quantization")
            throw InputError(
                file, "extensionsRequired",
                fmt::format("asks for {}, which is not supported: save the model without it", name));
    }
}

// Files that do not require their packing hold a plain copy, too, or should.
void checkPlainCopies(const json& root, const std::string& file) {
    const auto list = [](const json& of, const char* name) { return of.value(name, json::array()); };
    const auto isPacked = [](const json& of, const char* by) {
        return of.value("extensions", json::object()).contains(by);
    };
    const auto refuse = [&](const std::string& place, const char* by) {
        throw InputError(
            file, place,
            fmt::format("is packed by {} alone, which is not supported: save the model without it", by));
    };
    constexpr const char *kDraco = "KHR_draco_mesh_compression", *kMeshopt = "EXT_meshopt_compression";
    const json accessors = list(root, "accessors"), meshes = list(root, "meshes"),
               buffers = list(root, "buffers");
    const auto isPlain = [&](const json& accessor) {
        return !accessor.is_number_unsigned() || accessor >= accessors.size() ||
               accessors[accessor.get<size_t>()].contains("bufferView");
    };
    for (size_t m = 0; m < meshes.size(); ++m) {
        const json primitives = list(meshes[m], "primitives");
        for (size_t p = 0; p < primitives.size(); ++p) {
            const json &primitive = primitives[p], attributes = primitive.value("attributes", json::object());
            if (isPacked(primitive, kDraco) && !(isPlain(primitive.value("indices", json())) &&
                                                 isPlain(attributes.value("POSITION", json()))))
                refuse(fmt::format("meshes[{}].primitives[{}]", m, p), kDraco);
        }
    }
    for (size_t i = 0; i < buffers.size(); ++i)
        if (isPacked(buffers[i], kMeshopt) && !buffers[i].contains("uri"))
            refuse(fmt::format("buffers[{}]", i), kMeshopt);
}

} // namespace

void checkGltfFields(std::string_view bytes, const std::string& file) {
    const json root = json::parse(jsonOf(bytes), nullptr, false);
    if (root.is_discarded()) return;
    checkVersion(root, file);
    const FieldChecker checker(file);
    for (const Field& field : kFields) checker.check(root, field.path, field.kind, "");
    checkExtensions(root, file);
    checkPlainCopies(root, file);
}

} // namespace heliodon::geometry
