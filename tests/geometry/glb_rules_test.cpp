// What writeModel puts into a .glb, byte by byte against the glTF 2.0 specification (Khronos, 2021): section
// 4.4 for the container, 3.6 for buffers and accessors, 5 for the fields, and the material extensions' own
// rules. Nothing of our reader is used.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"

using namespace heliodon::geometry;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

template<class Value> Value at(const std::string& bytes, size_t offset) {
    Value value{};
    if (offset + sizeof value > bytes.size()) throw std::out_of_range("past the end");
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

struct Glb {
    json root;
    std::string binary;
};

void readContainer(const std::string& bytes, Glb& out) {
    ASSERT_EQ(at<uint32_t>(bytes, 0), 0x46546C67u);
    ASSERT_EQ(at<uint32_t>(bytes, 4), 2u);
    ASSERT_EQ(at<uint32_t>(bytes, 8), bytes.size());
    const size_t text = at<uint32_t>(bytes, 12);
    ASSERT_EQ(text % 4, 0u);
    ASSERT_EQ(at<uint32_t>(bytes, 16), 0x4E4F534Au);
    const std::string chunk = bytes.substr(20, text);
    ASSERT_EQ(chunk.front(), '{');
    ASSERT_LT(chunk.size() - chunk.find_last_not_of(' ') - 1, 4u); // padded with blanks, no more than needed
    out.root = json::parse(chunk);
    const size_t binary = at<uint32_t>(bytes, 20 + text);
    ASSERT_EQ(binary % 4, 0u);
    ASSERT_EQ(at<uint32_t>(bytes, 24 + text), 0x004E4942u);
    ASSERT_EQ(28 + text + binary, bytes.size());
    out.binary = bytes.substr(28 + text);
}

void expectWithin(const json& value, double low, double high) {
    ASSERT_TRUE(value.is_number());
    EXPECT_GE(value.get<double>(), low);
    EXPECT_LE(value.get<double>(), high);
}

// Arrays that are there are not empty; extensions that are used are declared, once, and none is required.
void checkTop(const json& root) {
    EXPECT_EQ(root.at("asset").at("version"), "2.0");
    for (const auto& [key, value] : root.items()) EXPECT_FALSE(value.is_array() && value.empty()) << key;
    EXPECT_FALSE(root.contains("extensionsRequired"));
    std::set<std::string> used;
    for (const json& material : root.value("materials", json::array()))
        if (material.contains("extensions"))
            for (const auto& [name, extension] : material["extensions"].items()) used.insert(name);
    const auto declared = root.value("extensionsUsed", std::vector<std::string>());
    EXPECT_EQ(std::set<std::string>(declared.begin(), declared.end()), used);
    EXPECT_EQ(declared.size(), used.size());
}

void checkBuffers(const Glb& glb) {
    const json& buffers = glb.root.at("buffers");
    ASSERT_EQ(buffers.size(), 1u);
    EXPECT_FALSE(buffers[0].contains("uri"));
    const size_t length = buffers[0].at("byteLength");
    EXPECT_LE(length, glb.binary.size());
    EXPECT_LE(glb.binary.size(), length + 3);
    for (const json& view : glb.root.at("bufferViews")) {
        EXPECT_EQ(view.at("buffer"), 0);
        EXPECT_GE(view.at("byteLength").get<size_t>(), 1u);
        EXPECT_LE(view.value("byteOffset", size_t{0}) + view.at("byteLength").get<size_t>(), length);
        EXPECT_TRUE(view.at("target") == 34962 || view.at("target") == 34963);
    }
}

// The accessor's first byte in the binary chunk.
size_t checkAccessor(const Glb& glb, const json& accessor, int target) {
    const json& view = glb.root.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
    EXPECT_EQ(view.at("target"), target);
    EXPECT_FALSE(view.contains("byteStride")); // packed
    const size_t element = accessor.at("type") == "VEC3" ? 12 : 4, count = accessor.at("count");
    EXPECT_GE(count, 1u);
    const size_t own = accessor.value("byteOffset", size_t{0}), begin = view.value("byteOffset", size_t{0});
    EXPECT_EQ((own + begin) % 4, 0u);
    EXPECT_EQ(own % 4, 0u);
    EXPECT_LE(own + element * count, view.at("byteLength").get<size_t>());
    return own + begin;
}

void checkPositions(const Glb& glb, const json& accessor) {
    EXPECT_EQ(accessor.at("componentType"), 5126);
    EXPECT_EQ(accessor.at("type"), "VEC3");
    const size_t begin = checkAccessor(glb, accessor, 34962), count = accessor.at("count");
    ASSERT_EQ(accessor.at("min").size(), 3u);
    ASSERT_EQ(accessor.at("max").size(), 3u);
    for (size_t c = 0; c < 3; ++c) {
        float low = at<float>(glb.binary, begin + 4 * c), high = low;
        for (size_t i = 0; i < count; ++i) {
            const float value = at<float>(glb.binary, begin + 12 * i + 4 * c);
            ASSERT_TRUE(std::isfinite(value));
            low = std::min(low, value);
            high = std::max(high, value);
        }
        EXPECT_EQ(static_cast<float>(accessor.at("min")[c].get<double>()), low); // "must match exactly"
        EXPECT_EQ(static_cast<float>(accessor.at("max")[c].get<double>()), high);
    }
}

// Adds the area of the primitive's triangles.
void checkPrimitive(const Glb& glb, const json& primitive, double& area) {
    EXPECT_EQ(primitive.value("mode", 4), 4);
    const json& accessors = glb.root.at("accessors");
    const json& positions = accessors.at(primitive.at("attributes").at("POSITION").get<size_t>());
    const json& indices = accessors.at(primitive.at("indices").get<size_t>());
    if (primitive.contains("material")) {
        EXPECT_LT(primitive.at("material").get<size_t>(), glb.root.at("materials").size());
    }
    checkPositions(glb, positions);
    EXPECT_EQ(indices.at("componentType"), 5125);
    EXPECT_EQ(indices.at("type"), "SCALAR");
    const size_t count = indices.at("count"), begin = checkAccessor(glb, indices, 34963),
                 points = checkAccessor(glb, positions, 34962);
    ASSERT_EQ(count % 3, 0u);
    const auto corner = [&](size_t i) {
        const uint32_t v = at<uint32_t>(glb.binary, begin + 4 * i);
        EXPECT_LT(v, positions.at("count").get<uint32_t>());
        glm::dvec3 p;
        for (int c = 0; c < 3; ++c)
            p[c] = at<float>(glb.binary, points + 12 * size_t{v} + 4 * static_cast<size_t>(c));
        return p;
    };
    for (size_t i = 0; i < count; i += 3) {
        const glm::dvec3 a = corner(i);
        area += 0.5 * glm::length(glm::cross(corner(i + 1) - a, corner(i + 2) - a));
    }
}

void checkMaterials(const json& root) {
    std::set<std::string> names;
    for (const json& material : root.value("materials", json::array())) {
        EXPECT_TRUE(names.insert(material.at("name")).second) << material.at("name");
        const json& pbr = material.at("pbrMetallicRoughness");
        ASSERT_EQ(pbr.at("baseColorFactor").size(), 4u);
        for (const json& value : pbr.at("baseColorFactor")) expectWithin(value, 0, 1);
        expectWithin(pbr.at("metallicFactor"), 0, 1);
        expectWithin(pbr.at("roughnessFactor"), 0, 1);
        if (material.contains("emissiveFactor")) {
            ASSERT_EQ(material["emissiveFactor"].size(), 3u);
            for (const json& value : material["emissiveFactor"]) expectWithin(value, 0, 1);
        }
        const json extensions = material.value("extensions", json::object());
        if (extensions.contains("KHR_materials_transmission"))
            expectWithin(extensions["KHR_materials_transmission"].at("transmissionFactor"), 0, 1);
        if (extensions.contains("KHR_materials_ior"))
            expectWithin(extensions["KHR_materials_ior"].at("ior"), 1, 4);
        if (extensions.contains("KHR_materials_emissive_strength"))
            expectWithin(extensions["KHR_materials_emissive_strength"].at("emissiveStrength"), 0, 1e30);
    }
}

// One node and one mesh per room and role, named so; all nodes in the scene, none twice.
void checkNodes(const json& root, const PatchMesh& mesh) {
    std::set<std::string> expected, names;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        expected.insert("room" + std::to_string(mesh.room[i]) +
                        (mesh.role[i] == Role::projection ? "_projection" : "_fill-in"));
    std::set<size_t> inScene;
    for (const json& node : root.at("scenes").at(root.at("scene").get<size_t>()).at("nodes")) {
        ASSERT_TRUE(inScene.insert(node.get<size_t>()).second);
        const json& own = root.at("nodes").at(node.get<size_t>());
        names.insert(own.at("name").get<std::string>());
        EXPECT_EQ(root.at("meshes").at(own.at("mesh").get<size_t>()).at("name"), own.at("name"));
    }
    EXPECT_EQ(names, expected);
    EXPECT_EQ(inScene.size(), root.at("nodes").size());
}

class GlbRules : public testing::Test {
protected:
    fs::path folder = fs::temp_directory_path() / ("heliodon_glb_" + std::to_string(::getpid()));
    void SetUp() override { fs::create_directories(folder); }
    void TearDown() override { fs::remove_all(folder); }

    void check(const PatchMesh& mesh) {
        writeModel(mesh, folder / "m.glb");
        std::ifstream in(folder / "m.glb", std::ios::binary);
        Glb glb;
        ASSERT_NO_FATAL_FAILURE(readContainer({std::istreambuf_iterator<char>(in), {}}, glb));
        checkTop(glb.root);
        checkBuffers(glb);
        checkMaterials(glb.root);
        checkNodes(glb.root, mesh);
        double area = 0, expected = 0;
        for (const json& m : glb.root.at("meshes")) {
            ASSERT_FALSE(m.at("primitives").empty());
            for (const json& primitive : m.at("primitives")) checkPrimitive(glb, primitive, area);
        }
        for (size_t i = 0; i < mesh.patchCount(); ++i) expected += patchArea(mesh, i);
        EXPECT_NEAR(area, expected, 1e-5 * expected); // single precision
    }
};

// A floor of five corners and a wall of four.
PatchMesh twoFaces() {
    PatchMesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, 2}, {1, 0, 3}, {2, 0, 2}, {2, 0, 0}, {2, 1.5, 0}, {0, 1.5, 0}};
    mesh.materials.resize(2);
    mesh.addPatch(std::vector<uint32_t>{0, 1, 2, 3, 4}, 0, Role::projection, 0, 0);
    mesh.addPatch(std::vector<uint32_t>{0, 4, 5, 6}, 1, Role::fillIn, 1, 3);
    return mesh;
}

} // namespace

TEST_F(GlbRules, hold_for_rooms_with_windows) {
    for (const char* name : {"p05_T_two_rooms.json", "p09_D_curved.json"}) {
        const fs::path file = fs::path(HELIODON_TEST_DATA "/geometry/sketches") / name;
        const Closure closure = closeSketch(readSketch(file));
        ASSERT_TRUE(closure.building);
        check(meshBuilding(*closure.building, {300}));
    }
    check(meshBuilding(importModel(HELIODON_TEST_DATA
                                   "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj",
                                   UpAxis::z),
                       {300}));
}

TEST_F(GlbRules, hold_for_every_material_that_is_taken) {
    PatchMesh mesh = twoFaces();
    mesh.materials[0].reflectance = {0.9f, 0, 0.5f};
    mesh.materials[0].transmittance = {0.1000005f, 0, 0.5f}; // adds up to as much over 1 as is taken
    mesh.materials[1].reflectance = glm::vec3(0);
    mesh.materials[1].exitance = {1e5f, 0.1f, 3e-7f};
    check(mesh);
    mesh.materials[0].transmittance = glm::vec3(1); // a hole
    mesh.materials[0].reflectance = glm::vec3(0);
    mesh.materials[0].refractiveIndex = 1;
    mesh.materials[1].exitance = {0, 1e-40f, 0}; // the least there is
    check(mesh);
}

// Names come from files of any encoding; JSON is UTF-8.
TEST_F(GlbRules, hold_for_any_name) {
    PatchMesh mesh = twoFaces();
    for (const std::string name : {"", "Wei\xdf", "Wei\xc3\x9f", "a \"b\"\\\n", "\xff\xfe\x80"}) {
        mesh.materials[0].name = mesh.materials[1].name = name;
        check(mesh);
    }
    mesh.materials[0].name = "a\xff";
    mesh.materials[1].name = "a\xfe"; // still two names
    check(mesh);
}

TEST_F(GlbRules, nothing_is_no_model) {
    EXPECT_THROW(writeModel(PatchMesh{}, folder / "m.glb"), InputError);
    EXPECT_THROW(writeModel(PatchMesh{}, folder / "m.obj"), InputError);
    EXPECT_FALSE(fs::exists(folder / "m.glb"));
}
