// glTF 2.0 (.gltf, .glb) through tinygltf: triangles of every mesh node of the default scene, materials after
// KHR_materials_transmission, KHR_materials_ior and KHR_materials_emissive_strength, blinds after
// extras.blinds of a material, asset.extras.north_deg and .twins, positions after KHR_mesh_quantization.
// Of base colour textures the mean.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include "geometry/counted.h"
#include "geometry/gltf_fields.h"
#include "geometry/gltf_materials.h"
#include "geometry/input_error.h"
#include "geometry/last_decimal.h"
#include "geometry/raw_model.h"
#include "geometry/text_file.h"
#include "geometry/texture_mean.h"

namespace heliodon::geometry {

namespace {

class GltfReader {
public:
    explicit GltfReader(const std::filesystem::path& file) {
        out_.file = file.string();
        const std::string bytes = readText(file, "a model (.gltf .glb)", kLargestModel);
        const bool binary = bytes.starts_with("glTF");
        if (binary) refuseOlder(bytes);
        if (binary) refuseCutOff(bytes);
        checkGltfFields(bytes, out_.file);
        tinygltf::TinyGLTF loader;
        // The loader would read a folder as a file without end.
        const auto isFile = [](const std::string& path, void*) {
            std::error_code none;
            return std::filesystem::is_regular_file(path, none);
        };
        loader.SetFsCallbacks(
            {isFile, tinygltf::ExpandFilePath, tinygltf::ReadWholeFile, tinygltf::WriteWholeFile, nullptr});
        loader.SetImageLoader(
            [](tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* data,
               int size, void*) {
                if (image->bufferView < 0) image->image.assign(data, data + size); // as it is in its file
                return true;
            },
            nullptr);
        std::string errors, warnings;
        const std::string beside = file.parent_path().string();
        const auto size = static_cast<unsigned>(bytes.size());
        const bool good =
            binary ? loader.LoadBinaryFromMemory(&in_, &errors, &warnings,
                                                 reinterpret_cast<const unsigned char*>(bytes.data()), size,
                                                 beside)
                   : loader.LoadASCIIFromString(&in_, &errors, &warnings, bytes.data(), size, beside);
        if (!good) {
            if (!binary) readJson(file, "a model (glTF 2.0)", kLargestModel); // where it stops being JSON
            refuseMissingPart(errors);
            // In one line, and without the file's name, which stands in front.
            for (size_t at; (at = errors.find(out_.file)) != std::string::npos;)
                errors.erase(at, out_.file.size());
            for (char& c : errors)
                if (c == '\n') c = ' ';
            for (size_t at; (at = errors.find("file: :")) != std::string::npos;) errors.erase(at + 4, 2);
            while (!errors.empty() && (errors.back() == ' ' || errors.back() == ':')) errors.pop_back();
            if (const size_t data = errors.find(";base64,"); data != std::string::npos) { // of any length
                const size_t begin = data + std::strlen(";base64,");
                errors.replace(begin, errors.find(' ', begin) - begin, "...");
            }
            throw InputError(out_.file, "", "is no glTF 2.0: " + errors);
        }
    }

    RawModel read() {
        readNorth();
        readTwins();
        for (size_t i = 0; i < in_.materials.size(); ++i) {
            checkColour(i);
            const auto [texture, field] = textureOf(in_.materials[i]);
            const std::optional<glm::vec3> mean = texture < 0 ? std::nullopt : meanOf(in_, texture);
            Material material = materialOf(in_.materials[i], mean.value_or(glm::vec3(1)));
            readBlind(i, material);
            if (material.name.empty()) material.name = fmt::format("material{}", i);
            if (mean) {
                out_.assumed[static_cast<uint32_t>(i)] =
                    textureTaken(material.name, material.reflectance + material.transmittance,
                                 fmt::format("{} in {}", field, out_.file));
            } else if (!hasColour(in_.materials[i]) && !material.isOpening()) {
                // The format's default, 1, is no reflectance; lamps get none, as in an .obj.
                const float assumed = material.exitance == glm::vec3(0) ? 0.5f : 0.0f;
                material.reflectance = glm::vec3(assumed);
                out_.assumed[static_cast<uint32_t>(i)] =
                    fmt::format("material \"{}\" has no baseColorFactor: a reflectance of {} was assumed",
                                material.name, assumed);
            }
            MaterialFields fields = kGltfFields;
            if (diffuse(in_.materials[i], "diffuseFactor")) fields.reflectance = "diffuseFactor";
            if (auto flaw = flawOf(material, fields, out_.file, fmt::format("materials[{}]", i))) {
                flaw->material = static_cast<uint32_t>(i);
                out_.flaws.push_back(*flaw);
            }
            const char* unread = texture >= 0 && !mean ? field : otherTextureOf(in_.materials[i]);
            if (unread) out_.unread[static_cast<uint32_t>(i)] = fmt::format("{} in {}", unread, out_.file);
            const double opacity = colourOf(in_.materials[i]).at(3);
            if (in_.materials[i].alphaMode == "BLEND" && opacity < 1 && !material.isOpening())
                out_.doubts[static_cast<uint32_t>(i)] =
                    seeThroughButOpaque(material.name, opacity, "KHR_materials_transmission");
            out_.materials.push_back(std::move(material));
        }
        seen_.assign(in_.nodes.size(), Seen::never);
        for (const int node : rootNodes()) visit(node, glm::dmat4(1), 0);
        if (out_.faceCount() == 0 && !withoutFaces_.empty()) fail(withoutFaces_, "is not triangles");
        sayWhatOthersShow();
        return std::move(out_);
    }

private:
    void refuseOlder(const std::string& bytes) const {
        uint32_t version = 2;
        if (bytes.size() >= 8) std::memcpy(&version, bytes.data() + 4, sizeof version);
        if (version != 2)
            throw InputError(out_.file, "", fmt::format("is glTF {}.0 in binary, expected 2.0", version));
    }

    void refuseCutOff(const std::string& bytes) const {
        uint32_t all = 20; // its header and that of its first chunk
        if (bytes.size() >= all) std::memcpy(&all, bytes.data() + 8, sizeof all);
        if (bytes.size() < all)
            throw InputError(
                out_.file, "",
                fmt::format("is cut off after {} bytes, expected {} and more", bytes.size(), all));
    }

    // A file of numbers (.bin) that was left behind when the .gltf was copied.
    void refuseMissingPart(const std::string& errors) const {
        constexpr std::string_view kMissing = "File not found : ";
        const size_t at = errors.find(kMissing);
        if (at == errors.npos) return;
        const size_t begin = at + kMissing.size();
        throw InputError(out_.file, "buffers",
                         fmt::format("\"{}\" does not exist, expected it beside the model",
                                     errors.substr(begin, errors.find('\n', begin) - begin)));
    }

    // Of the default scene; a file without scenes shows all its nodes.
    std::vector<int> rootNodes() const {
        const auto scene = static_cast<size_t>(std::max(in_.defaultScene, 0));
        if (scene < in_.scenes.size()) return in_.scenes[scene].nodes;
        if (!in_.scenes.empty()) throw InputError(out_.file, "scene", "does not exist");
        std::vector<bool> isChild(in_.nodes.size());
        for (const tinygltf::Node& node : in_.nodes)
            for (const int child : node.children)
                if (child >= 0 && static_cast<size_t>(child) < isChild.size())
                    isChild[static_cast<size_t>(child)] = true;
        std::vector<int> roots;
        for (size_t i = 0; i < isChild.size(); ++i)
            if (!isChild[i]) roots.push_back(static_cast<int>(i));
        return roots;
    }

    void sayWhatOthersShow() {
        size_t others = 0;
        for (size_t i = 0; i < in_.nodes.size(); ++i)
            others += in_.nodes[i].mesh >= 0 && seen_[i] == Seen::never;
        if (others == 0) return;
        if (out_.faceCount() == 0)
            fail("scene", "shows no mesh, which others do: expected the number of one of these");
        out_.leftOut.push_back(counted(others, "node") +
                               " with a mesh that the file's default scene does not show left out");
    }

    // asset.extras.north_deg, our own.
    void readNorth() {
        const tinygltf::Value& extras = in_.asset.extras;
        if (!extras.IsObject() || !extras.Has("north_deg")) return;
        const tinygltf::Value& north = extras.Get("north_deg");
        if (!north.IsNumber() || !std::isfinite(north.GetNumberAsDouble()))
            throw InputError(out_.file, "asset.extras.north_deg", "expected a finite number of degrees");
        out_.northDeg = north.GetNumberAsDouble();
    }

    // asset.extras.twins, our own: of how many triangles and what glass, and pairs of them by their order in
    // the file from 0.
    void readTwins() {
        const tinygltf::Value& extras = in_.asset.extras;
        if (!extras.IsObject() || !extras.Has("twins")) return;
        const auto number = [&](const tinygltf::Value& value) {
            const double n = value.IsNumber() ? value.GetNumberAsDouble() : -1;
            if (!(n >= 0 && n <= std::numeric_limits<uint32_t>::max() && n == std::floor(n)))
                fail("asset.extras.twins", "expected whole numbers of triangles");
            return static_cast<uint32_t>(n);
        };
        const tinygltf::Value& twins = extras.Get("twins");
        if (!twins.IsObject() || !twins.Has("of"))
            fail("asset.extras.twins", R"(expected {"of": TRIANGLES, "pairs": [TRIANGLE, TRIANGLE, ...]})");
        out_.twins.emplace().of = number(twins.Get("of"));
        if (twins.Has("glass")) {
            const tinygltf::Value& glass = twins.Get("glass");
            std::vector<double> numbers;
            for (int i = 0; i < static_cast<int>(glass.ArrayLen()); ++i)
                numbers.push_back(glass.Get(i).IsNumber() ? glass.Get(i).GetNumberAsDouble() : NAN);
            out_.twins->glass = glassMark(numbers);
            if (!out_.twins->glass)
                fail("asset.extras.twins.glass", fmt::format("expected the numbers {}", kGlassMarkForm));
        }
        if (!twins.Has("pairs")) return; // the loader drops empty lists
        const tinygltf::Value& list = twins.Get("pairs");
        if (!list.IsArray() || list.ArrayLen() % 2 != 0)
            fail("asset.extras.twins.pairs", "expected a list of pairs of triangles");
        for (int i = 0; i < static_cast<int>(list.ArrayLen()); i += 2)
            out_.twins->pairs.emplace_back(number(list.Get(i)), number(list.Get(i + 1)));
    }

    // extras.blinds, our own.
    void readBlind(size_t i, Material& material) const {
        const tinygltf::Value& extras = in_.materials[i].extras;
        if (!extras.IsObject() || !extras.Has("blinds")) return;
        const std::string place = fmt::format("materials[{}].extras.blinds", i);
        const tinygltf::Value& text = extras.Get("blinds");
        if (!text.IsString()) throw InputError(out_.file, place, "expected a text such as slats:45");
        if (!material.isOpening()) throw InputError(out_.file, place, "the material transmits nothing");
        try {
            material.blind = parseBlind(text.Get<std::string>());
        } catch (const std::invalid_argument& error) {
            throw InputError(out_.file, place,
                             fmt::format("\"{}\": {}", text.Get<std::string>(), error.what()));
        }
    }

    [[noreturn]] void fail(const std::string& place, const std::string& what) const {
        throw InputError(out_.file, place, what);
    }

    // The loader takes a colour of another length for none.
    void checkColour(size_t i) const {
        const tinygltf::Material& in = in_.materials[i];
        const auto check = [&](const char* field, size_t count) {
            if (count != 4)
                fail(fmt::format("materials[{}].{}", i, field),
                     fmt::format("has {} numbers, expected 4", count));
        };
        const auto base = in.values.find("baseColorFactor");
        if (base != in.values.end())
            check("pbrMetallicRoughness.baseColorFactor", base->second.number_array.size());
        if (const tinygltf::Value* stated = diffuse(in, "diffuseFactor"))
            check("extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor", stated->ArrayLen());
    }

    // The loader takes lists of any length; a part passed over would place the mesh elsewhere.
    void checkPlacement(const tinygltf::Node& node, const std::string& place) const {
        const auto check = [&](const char* field, const std::vector<double>& numbers, size_t count) {
            if (!numbers.empty() && numbers.size() != count)
                fail(place + field, fmt::format("has {} numbers, expected {}", numbers.size(), count));
        };
        check(".matrix", node.matrix, 16);
        constexpr std::array<double, 4> kLastRow{0, 0, 0, 1};
        for (size_t c = 0; c < 4 && !node.matrix.empty(); ++c)
            if (std::abs(node.matrix[4 * c + 3] - kLastRow[c]) > 1e-6)
                fail(place + ".matrix", "has another last row than 0 0 0 1");
        check(".translation", node.translation, 3);
        check(".scale", node.scale, 3);
        check(".rotation", node.rotation, 4);
        double squares = node.rotation.empty() ? 1 : 0;
        for (const double x : node.rotation) squares += x * x;
        if (std::abs(squares - 1) > 1e-2) fail(place + ".rotation", "is no unit quaternion");
    }

    static glm::dmat4 parentFromNode(const tinygltf::Node& node) {
        glm::dmat4 m(1);
        if (node.matrix.size() == 16) {
            for (int k = 0; k < 16; ++k) m[k / 4][k % 4] = node.matrix[static_cast<size_t>(k)];
            return m;
        }
        if (node.rotation.size() == 4)
            m = glm::mat4_cast(glm::normalize(
                glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
        if (node.scale.size() == 3)
            for (int c = 0; c < 3; ++c) m[c] *= node.scale[static_cast<size_t>(c)];
        if (node.translation.size() == 3)
            m[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1);
        return m;
    }

    // Bones, morph targets and instances move or repeat the triangles, whether the file requires them or not.
    void checkRigid(const tinygltf::Node& node, const tinygltf::Mesh& mesh, const std::string& place) const {
        const char* const instances = "EXT_mesh_gpu_instancing";
        if (node.skin >= 0) fail(place + ".skin", "bends the mesh, which is not supported");
        const auto& weights = node.weights.empty() ? mesh.weights : node.weights;
        if (std::ranges::any_of(weights, [](double weight) { return weight != 0; }))
            fail(place, "has a mesh with morph targets, which are not supported");
        if (node.extensions.contains(instances))
            fail(place + ".extensions", fmt::format("has {}, which is not supported", instances));
    }

    void visit(int index, const glm::dmat4& worldFromParent, int depth) {
        const std::string place = fmt::format("nodes[{}]", index);
        if (index < 0 || static_cast<size_t>(index) >= in_.nodes.size()) fail(place, "does not exist");
        // A tree, as glTF has it: else few nodes could stand for any number of triangles.
        Seen& seen = seen_[static_cast<size_t>(index)];
        if (seen == Seen::above) fail(place, "is its own ancestor");
        if (seen == Seen::before) fail(place, "has two parents");
        if (depth > 256) fail(place, "lies under more than 256 others");
        seen = Seen::above;
        const tinygltf::Node& node = in_.nodes[static_cast<size_t>(index)];
        checkPlacement(node, place);
        const glm::dmat4 worldFromNode = worldFromParent * parentFromNode(node);
        if (node.mesh >= 0) {
            if (static_cast<size_t>(node.mesh) >= in_.meshes.size()) fail(place + ".mesh", "does not exist");
            const tinygltf::Mesh& mesh = in_.meshes[static_cast<size_t>(node.mesh)];
            checkRigid(node, mesh, place);
            for (size_t p = 0; p < mesh.primitives.size(); ++p)
                addPrimitive(mesh.primitives[p], fmt::format("meshes[{}].primitives[{}]", node.mesh, p),
                             node.name, mesh.name, worldFromNode);
        }
        above_.push_back(node.name);
        for (const int child : node.children) visit(child, worldFromNode, depth + 1);
        above_.pop_back();
        seen = Seen::before;
    }

    // Calls `take(pointer to element, index)` for each element; every byte read lies inside the buffer.
    void forEachElement(int index, const std::string& place,
                        const std::function<void(const unsigned char*)>& take) const {
        if (index < 0 || static_cast<size_t>(index) >= in_.accessors.size()) fail(place, "does not exist");
        const tinygltf::Accessor& accessor = in_.accessors[static_cast<size_t>(index)];
        if (accessor.sparse.isSparse) fail(place, "is sparse, which is not supported");
        if (accessor.bufferView < 0 || static_cast<size_t>(accessor.bufferView) >= in_.bufferViews.size())
            fail(place, "has no bufferView");
        const tinygltf::BufferView& view = in_.bufferViews[static_cast<size_t>(accessor.bufferView)];
        if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= in_.buffers.size())
            fail(place, "has no buffer");
        const std::vector<unsigned char>& bytes = in_.buffers[static_cast<size_t>(view.buffer)].data;
        const int stride = accessor.ByteStride(view);
        const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
        const int width = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
        if (stride <= 0 || components <= 0 || width <= 0) fail(place, "has an unknown type");
        const auto element = static_cast<size_t>(components) * static_cast<size_t>(width);
        if (static_cast<size_t>(stride) < element) fail(place, "has elements that overlap (byteStride)");
        const size_t length = view.byteLength, offset = accessor.byteOffset;
        if (view.byteOffset > bytes.size() || length > bytes.size() - view.byteOffset)
            fail(place, "reaches past the end of its buffer");
        const size_t begin = view.byteOffset + offset, step = static_cast<size_t>(stride);
        if (accessor.count > 0 && (offset > length || accessor.count > length ||
                                   offset + (accessor.count - 1) * step + element > length))
            fail(place, "reaches past the end of its bufferView");
        for (size_t i = 0; i < accessor.count; ++i) take(bytes.data() + begin + i * step);
    }

    template<class Integer> static glm::dvec3 integers(const unsigned char* bytes, bool normalized) {
        std::array<Integer, 3> xyz;
        std::memcpy(xyz.data(), bytes, sizeof xyz);
        const glm::dvec3 p(xyz[0], xyz[1], xyz[2]);
        return normalized ? glm::max(p / double{std::numeric_limits<Integer>::max()}, -1.0) : p;
    }

    // Three floats, or integers after KHR_mesh_quantization.
    static glm::dvec3 positionAt(const unsigned char* bytes, const tinygltf::Accessor& accessor) {
        switch (accessor.componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return integers<int8_t>(bytes, accessor.normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return integers<uint8_t>(bytes, accessor.normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return integers<int16_t>(bytes, accessor.normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return integers<uint16_t>(bytes, accessor.normalized);
        default:
            break;
        }
        std::array<float, 3> xyz;
        std::memcpy(xyz.data(), bytes, sizeof xyz);
        return {xyz[0], xyz[1], xyz[2]};
    }

    static double packedStep(const tinygltf::Accessor& accessor) {
        if (!accessor.normalized) return 1;
        const int type = accessor.componentType,
                  bits = 8 * tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type));
        const bool isSigned = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
        return 1 / (std::ldexp(1.0, bits - isSigned) - 1);
    }

    void addVertices(int index, const std::string& place, const glm::dmat4& worldFromNode) {
        if (index < 0 || static_cast<size_t>(index) >= in_.accessors.size()) fail(place, "does not exist");
        const tinygltf::Accessor& accessor = in_.accessors[static_cast<size_t>(index)];
        const int type = accessor.componentType;
        const bool packed = type >= TINYGLTF_COMPONENT_TYPE_BYTE &&
                            type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                            std::ranges::find(in_.extensionsRequired, "KHR_mesh_quantization") !=
                                in_.extensionsRequired.end();
        if ((type != TINYGLTF_COMPONENT_TYPE_FLOAT && !packed) || accessor.type != TINYGLTF_TYPE_VEC3)
            fail(place, "is not of three floats");
        double largest = 0; // of the accessor's own coordinates
        forEachElement(index, place, [&](const unsigned char* bytes) {
            const glm::dvec3 own = positionAt(bytes, accessor);
            const glm::dvec3 p(worldFromNode * glm::dvec4(own, 1));
            for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(own[c]));
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                fail(place, "holds a number that is not finite");
            out_.vertices.push_back(p);
        });
        const double step = packed ? packedStep(accessor) : singleStep(largest);
        for (int c = 0; c < 3; ++c)
            out_.step = std::max(out_.step, step * glm::length(glm::dvec3(worldFromNode[c])));
    }

    // Per vertex; empty where the primitive has none that can be read: then it stays in facets.
    std::vector<glm::vec3> normals(const tinygltf::Primitive& primitive, const std::string& place,
                                   const glm::dmat3& worldFromNode) const {
        const auto found = primitive.attributes.find("NORMAL");
        if (found == primitive.attributes.end() || found->second < 0 ||
            static_cast<size_t>(found->second) >= in_.accessors.size())
            return {};
        const tinygltf::Accessor& accessor = in_.accessors[static_cast<size_t>(found->second)];
        if (accessor.type != TINYGLTF_TYPE_VEC3 || accessor.sparse.isSparse || accessor.bufferView < 0 ||
            accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
            return {};
        const glm::dmat3 turned = glm::transpose(glm::inverse(worldFromNode)); // keeps them perpendicular
        std::vector<glm::vec3> out;
        forEachElement(found->second, place, [&](const unsigned char* bytes) {
            out.emplace_back(turned * positionAt(bytes, accessor));
        });
        return out;
    }

    std::vector<uint32_t> indices(const tinygltf::Primitive& primitive, const std::string& place,
                                  size_t count) {
        std::vector<uint32_t> found;
        if (primitive.indices < 0) {
            for (uint32_t i = 0; i < count; ++i) found.push_back(i);
            return found;
        }
        if (static_cast<size_t>(primitive.indices) >= in_.accessors.size()) fail(place, "does not exist");
        const int type = in_.accessors[static_cast<size_t>(primitive.indices)].componentType;
        const size_t width = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                             : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                             : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? 4
                                                                              : 0;
        if (width == 0) fail(place, "is not of unsigned integers");
        forEachElement(primitive.indices, place, [&](const unsigned char* bytes) {
            uint32_t value = 0;
            std::memcpy(&value, bytes, width); // glTF is little-endian, as every machine that we build for
            if (value >= count) fail(place, fmt::format("names vertex {} of {}", value, count));
            found.push_back(value);
        });
        return found;
    }

    // Three corners for each triangle of a strip or a fan; every other one of a strip runs the other way
    // round.
    static std::vector<uint32_t> separateTriangles(std::vector<uint32_t> corner, int mode) {
        const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
        if (!strip && mode != TINYGLTF_MODE_TRIANGLE_FAN) return corner;
        std::vector<uint32_t> out;
        for (size_t i = 0; i + 2 < corner.size(); ++i) {
            const size_t turned = strip ? i % 2 : 0;
            const uint32_t a = corner[strip ? i : 0], b = corner[i + 1 + turned], c = corner[i + 2 - turned];
            if (a != b && b != c && c != a)
                out.insert(out.end(), {a, b, c}); // else a strip goes on elsewhere
        }
        return out;
    }

    uint32_t materialIndex(int index, const std::string& place) {
        if (index >= 0) {
            if (static_cast<size_t>(index) >= in_.materials.size())
                fail(place + ".material", "does not exist");
            return static_cast<uint32_t>(index);
        }
        if (!greyMaterial_) {
            greyMaterial_ = static_cast<uint32_t>(out_.materials.size());
            out_.materials.push_back({"default", glm::vec3(0.5f)});
        }
        return *greyMaterial_;
    }

    void addPrimitive(const tinygltf::Primitive& primitive, const std::string& place, const std::string& node,
                      const std::string& mesh, const glm::dmat4& worldFromNode) {
        if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) fail(place + ".mode", "expected 0 to 6");
        if (primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES) { // loose points and edges
            withoutFaces_ = place + ".mode";
            return;
        }
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) fail(place, "has no POSITION");
        const auto first = static_cast<uint32_t>(out_.vertices.size());
        addVertices(position->second, place + ".attributes.POSITION", worldFromNode);
        const std::vector<glm::vec3> normal =
            normals(primitive, place + ".attributes.NORMAL", glm::dmat3(worldFromNode));
        const std::vector<uint32_t> corner = separateTriangles(
            indices(primitive, place + ".indices", out_.vertices.size() - first), primitive.mode);
        if (corner.size() % 3 != 0) fail(place + ".indices", "do not come in threes");
        const uint32_t material = materialIndex(primitive.material, place);
        if (primitive.attributes.contains("COLOR_0"))
            out_.unread.try_emplace(material, "COLOR_0 in " + out_.file);
        // A mirrored node turns its triangles over.
        const bool mirrored = glm::determinant(glm::dmat3(worldFromNode)) < 0;
        out_.groups.push_back(mesh.empty() ? node : mesh);
        out_.object.push_back(node.empty() ? RawModel::Object{"mesh", mesh} : RawModel::Object{"node", node});
        out_.source.push_back(place);
        out_.above.push_back(above_);
        for (size_t t = 0; t < corner.size(); t += 3) {
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = corner[t + (mirrored ? 2 - k : k)];
                out_.addCorner(first + v, v < normal.size() ? normal[v] : glm::vec3(0));
            }
            out_.endFace(material, t / 3);
        }
    }

    tinygltf::Model in_;
    RawModel out_;
    std::optional<uint32_t> greyMaterial_;
    std::string withoutFaces_; // a primitive of points or lines
    enum class Seen : uint8_t { never, above, before };
    std::vector<Seen> seen_;         // per node
    std::vector<std::string> above_; // the names of nodes above that which is visited
};

} // namespace

RawModel readGltf(const std::filesystem::path& file) {
    return GltfReader(file).read();
}

} // namespace heliodon::geometry
