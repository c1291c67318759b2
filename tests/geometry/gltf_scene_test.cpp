// glTF scenes as programs write them: nodes that turn, mirror and repeat, and what is not taken, by name.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/picture_file.h"
#include "geometry/raw_model.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;
using nlohmann::json;

namespace {

std::string base64(const std::string& bytes) {
    static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (int k = 3; k >= 0; --k) out += kDigits[word >> (6 * k) & 63];
    }
    for (size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k) out[out.size() - 1 - k] = '=';
    return out;
}

const std::vector<uint16_t> kTriangles{0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 1, 3, 0, 3, 2,
                                       4, 6, 7, 4, 7, 5, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};

// A room of 4 x 2.5 x 3 m as one mesh, with these nodes.
json roomScene(const json& nodes, const std::vector<uint16_t>& indices = kTriangles) {
    std::string data;
    for (int i = 0; i < 8; ++i)
        for (const float x : {i & 1 ? 4.0f : 0.0f, i & 2 ? 2.5f : 0.0f, i & 4 ? 3.0f : 0.0f})
            data.append(reinterpret_cast<const char*>(&x), 4);
    const size_t positions = data.size();
    const size_t bytes = indices.size() * sizeof indices[0];
    data.append(reinterpret_cast<const char*>(indices.data()), bytes);
    json out;
    out["asset"]["version"] = "2.0";
    out["scene"] = 0;
    out["scenes"] = json::array({{{"nodes", {0}}}});
    out["nodes"] = nodes;
    out["meshes"] = json::parse(R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])");
    out["accessors"] = json::parse(R"([{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",
        "min":[0,0,0],"max":[4,2.5,3]},{"bufferView":1,"componentType":5123,"type":"SCALAR"}])");
    out["accessors"][1]["count"] = indices.size();
    out["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", positions}},
                                      {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", bytes}}});
    out["buffers"] = json::array(
        {{{"byteLength", data.size()}, {"uri", "data:application/octet-stream;base64," + base64(data)}}});
    return out;
}

std::string written(const json& scene) {
    const std::string file = testing::TempDir() + "scene.gltf";
    std::ofstream(file) << scene;
    return file;
}

void expectRooms(const char* nodes, uint32_t rooms, double cubicMetres) {
    const Building building = importModel(written(roomScene(json::parse(nodes))));
    EXPECT_EQ(building.roomCount, rooms) << nodes;
    EXPECT_NEAR(volume(meshBuilding(building, {200})), cubicMetres, 1e-5 * cubicMetres) << nodes;
}

void expectRefused(const json& scene, const std::string& why) {
    try {
        importModel(written(scene));
        ADD_FAILURE() << "taken, though " << why;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
}

const json kOneNode = json::parse(R"([{"mesh":0}])");

} // namespace

TEST(GltfScene, nodes_turn_mirror_and_repeat) {
    expectRooms(R"([{"mesh":0}])", 1, 30);
    expectRooms(R"([{"mesh":0,"scale":[-1,1,1],"translation":[10,0,0]}])", 1, 30);
    expectRooms(R"([{"mesh":0,"scale":[-1,-1,-2]}])", 1, 60);
    expectRooms(R"([{"children":[1],"scale":[2,2,2]},
        {"mesh":0,"rotation":[0,0.70710678118654752,0,0.70710678118654752],"scale":[0.5,0.5,-0.5]}])",
                1, 30);
    expectRooms(R"([{"mesh":0,"matrix":[0.5,0,0,0, 0,1,0,0, 0,0,1,0, 7,0,0,1]}])", 1, 15);
    expectRooms(R"([{"children":[1,2]},{"mesh":0},{"mesh":0,"translation":[6,0,0]}])", 2, 60);
}

TEST(GltfScene, what_other_scenes_show_is_said) {
    json scene =
        roomScene(json::parse(R"([{"mesh":0},{"mesh":0,"translation":[20,0,0]},{"name":"camera"}])"));
    scene["scenes"] = json::parse(R"([{"nodes":[0]},{"nodes":[1,2]}])");
    const Building building = importModel(written(scene));
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_EQ(
        building.repairs,
        std::vector<std::string>{"1 node with a mesh that the file's default scene does not show left out"});
    scene["scenes"] = json::parse(R"([{"nodes":[2]},{"nodes":[0,1]}])");
    expectRefused(scene, "scene: shows no mesh, which others do");
}

TEST(GltfScene, a_node_is_left_out_with_those_below_it) {
    const std::string file =
        written(roomScene(json::parse(R"([{"name":"All","children":[1,2]},{"name":"Room","mesh":0},
        {"name":"Annex","children":[3]},{"children":[4]},{"name":"Box","mesh":0,"translation":[6,0,0]}])")));
    const auto faces = [&](const std::string& name) {
        return readRawModel(file, {.glazing = {}, .reflectance = {}, .leftOut = {name}}).faceCount();
    };
    EXPECT_EQ(faces("Annex"), 12u);
    EXPECT_EQ(faces("Box"), 12u);
    EXPECT_THROW(faces("All"), InputError);
    EXPECT_THROW(faces("Anne"), InputError);
}

TEST(GltfScene, what_cannot_be_read_is_refused_by_place) {
    expectRefused(roomScene(json::parse(R"([{"mesh":0,"children":[1]},{"children":[0]}])")),
                  "nodes[0]: is its own ancestor");
    expectRefused(roomScene(json::parse(R"([{"mesh":0,"scale":[1,0,1]}])")), "meshes[0].primitives[0]");
    json doubling = json::array(); // 2^40 rooms, were it followed
    for (int k = 1; k <= 40; ++k) doubling.push_back({{"children", {k, k}}});
    doubling.push_back({{"mesh", 0}});
    expectRefused(roomScene(doubling), "nodes[40]: has two parents");
    json deep = json::array();
    for (int k = 1; k <= 300; ++k) deep.push_back({{"children", {k}}});
    deep.push_back({{"mesh", 0}});
    expectRefused(roomScene(deep), "nodes[257]");
    json older = roomScene(kOneNode);
    older["asset"]["version"] = "1.0";
    older["scene"] = "defaultScene";
    expectRefused(older, "asset.version: is \"1.0\", expected 2.0");
    older["asset"]["version"] = 1;
    expectRefused(older, "asset.version: is \"1\", expected 2.0");
    json external = roomScene(kOneNode);
    external["buffers"][0]["uri"] = "gone.bin";
    expectRefused(external, "gone.bin");
    json sparse = roomScene(kOneNode);
    sparse["accessors"][0]["sparse"] = json::parse(
        R"({"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}})");
    expectRefused(sparse, "sparse");
    for (const int mode : {0, 1, 3}) {
        json strip = roomScene(kOneNode);
        strip["meshes"][0]["primitives"][0]["mode"] = mode;
        expectRefused(strip, "primitives[0].mode");
    }
}

// Modellers write loose edges and points beside the faces; they bound nothing.
// As programs show them; a mesh of a node without a name by its own.
TEST(GltfScene, a_face_is_named_by_its_node_too) {
    json scene = roomScene(json::parse(R"([{"mesh":0,"name":"Window 2"}])"));
    scene["meshes"][0]["name"] = "Plane.001";
    EXPECT_EQ(readRawModel(written(scene)).place(1),
              "meshes[0].primitives[0] triangle 1 (node \"Window 2\")");
    scene["nodes"][0].erase("name");
    EXPECT_EQ(readRawModel(written(scene)).place(1),
              "meshes[0].primitives[0] triangle 1 (mesh \"Plane.001\")");
    scene["meshes"][0].erase("name");
    EXPECT_EQ(readRawModel(written(scene)).place(1), "meshes[0].primitives[0] triangle 1");
}

TEST(GltfScene, edges_and_points_beside_faces_are_passed_over) {
    json scene = roomScene(kOneNode);
    json& primitives = scene["meshes"][0]["primitives"];
    for (const int mode : {0, 1, 2, 3}) {
        primitives.push_back(primitives[0]);
        primitives.back()["mode"] = mode;
    }
    const Building building = importModel(written(scene));
    EXPECT_EQ(building.faces.size(), 12u);
    EXPECT_TRUE(building.repairs.empty());
    primitives.back()["mode"] = 7;
    expectRefused(scene, "primitives[4].mode: expected 0 to 6");
}

// A strip goes on at the next face by triangles without area.
TEST(GltfScene, strips_and_fans_are_triangles) {
    json strip = roomScene(kOneNode, {0, 4, 1, 5, 5, 2, 2, 3, 6, 7, 7, 0, 0, 1, 2, 3, 3,
                                      4, 4, 6, 5, 7, 7, 0, 0, 2, 4, 6, 6, 1, 1, 5, 3, 7});
    strip["meshes"][0]["primitives"][0]["mode"] = 5;
    const Building building = importModel(written(strip));
    EXPECT_TRUE(
        std::ranges::none_of(building.repairs, [](const auto& r) { return r.find("turned") < r.size(); }));
    EXPECT_NEAR(volume(meshBuilding(building, {200})), 30, 1e-4);
    // The three faces at a corner, and those at the opposite one, are two fans.
    json fans = roomScene(kOneNode, {0, 4, 5, 1, 3, 2, 6, 4, 7, 3, 1, 5, 4, 6, 2, 3});
    json& primitives = fans["meshes"][0]["primitives"];
    primitives[0]["mode"] = 6;
    primitives.push_back(primitives[0]);
    primitives[1]["indices"] = 2;
    fans["accessors"].push_back(fans["accessors"][1]);
    for (const size_t k : {1, 2}) fans["accessors"][k]["count"] = 8;
    fans["accessors"][2]["byteOffset"] = 16;
    EXPECT_NEAR(volume(meshBuilding(importModel(written(fans)), {200})), 30, 1e-4);
}

TEST(GltfScene, without_scenes_all_nodes_are_shown) {
    json scene = roomScene(json::parse(R"([{"mesh":0},{"children":[0],"scale":[2,1,1]}])"));
    scene.erase("scenes");
    scene.erase("scene");
    EXPECT_NEAR(volume(meshBuilding(importModel(written(scene)), {200})), 60, 1e-4);
}

// Triangles that are packed in a way that we do not know would be read as something else.
TEST(GltfScene, required_extensions_that_are_not_known_are_refused_by_name) {
    for (const char* name :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"}) {
        json scene = roomScene(kOneNode);
        scene["extensionsUsed"] = scene["extensionsRequired"] = json::array({name});
        for (json& accessor : scene["accessors"]) accessor.erase("bufferView"); // as packed ones
        expectRefused(scene, std::string("extensionsRequired: asks for ") + name);
    }
    json packed = roomScene(kOneNode);
    packed["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
    packed["extensionsUsed"] = json::array({"KHR_draco_mesh_compression"});
    EXPECT_EQ(importModel(written(packed)).roomCount, 1u); // of its plain copy
    packed["accessors"][1].erase("bufferView");
    expectRefused(packed, "meshes[0].primitives[0]: is packed by KHR_draco_mesh_compression alone, which");
    packed = roomScene(kOneNode);
    packed["buffers"].push_back({{"byteLength", 96}});
    packed["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"] = true;
    expectRefused(packed, "buffers[1]: is packed by EXT_meshopt_compression alone, which");
    json looks = roomScene(kOneNode);
    looks["extensionsUsed"] = looks["extensionsRequired"] = json::array({"KHR_materials_transmission"});
    EXPECT_EQ(importModel(written(looks)).roomCount, 1u);
}

// Positions of the room as integers, `perMetre` of them a metre, and a node that scales them back.
template<class Integer> json quantized(int componentType, double perMetre, bool normalized) {
    json scene = roomScene(kOneNode);
    std::string data;
    for (int i = 0; i < 8; ++i)
        for (const double x : {i & 1 ? 4 : 0.0, i & 2 ? 2.5 : 0.0, i & 4 ? 3 : 0.0, 0.0}) {
            const auto packed = static_cast<Integer>(std::lround(x * perMetre));
            data.append(reinterpret_cast<const char*>(&packed), sizeof packed);
        }
    scene["buffers"].push_back(
        {{"byteLength", data.size()}, {"uri", "data:application/octet-stream;base64," + base64(data)}});
    scene["bufferViews"].push_back(
        {{"buffer", 1}, {"byteLength", data.size()}, {"byteStride", 4 * sizeof(Integer)}});
    json& positions = scene["accessors"][0];
    positions["bufferView"] = 2;
    positions["componentType"] = componentType;
    if (normalized) positions["normalized"] = true;
    const double scale = (normalized ? std::numeric_limits<Integer>::max() : 1) / perMetre;
    scene["nodes"][0]["scale"] = {scale, scale, scale};
    scene["extensionsUsed"] = scene["extensionsRequired"] = json::array({"KHR_mesh_quantization"});
    return scene;
}

TEST(GltfScene, positions_may_be_integers) {
    for (const bool normalized : {false, true})
        for (const json& scene :
             {quantized<int8_t>(5120, 30, normalized), quantized<uint8_t>(5121, 60, normalized),
              quantized<int16_t>(5122, 8000, normalized), quantized<uint16_t>(5123, 16000, normalized)}) {
            const Building building = importModel(written(scene));
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(volume(meshBuilding(building, {200})), 30, 1e-9 * 30);
        }
    json without = quantized<int16_t>(5122, 8000, false);
    without.erase("extensionsRequired");
    expectRefused(without, "is not of three floats");
}

TEST(GltfScene, a_material_without_colour_gets_what_it_gets_in_an_obj_and_one_of_1_is_refused) {
    json scene = roomScene(kOneNode);
    scene["meshes"][0]["primitives"][0]["material"] = 0;
    for (const char* material : {R"([{"name":"bare"}])", R"([{"name":"bare","pbrMetallicRoughness":{}}])",
                                 R"([{"name":"bare","pbrMetallicRoughness":{"roughnessFactor":0.9}}])"}) {
        scene["materials"] = json::parse(material);
        const Building building = importModel(written(scene));
        for (const Face& face : building.faces)
            EXPECT_EQ(building.materials[face.material].reflectance, glm::vec3(0.5f));
        ASSERT_EQ(building.repairs.size(), 1u);
        EXPECT_NE(building.repairs[0].find("\"bare\" has no baseColorFactor"), std::string::npos);
    }
    scene["materials"] = json::parse(
        R"([{"name":"pane","alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.2,0.3,0.4,0.25]}}])");
    const std::vector<std::string> warnings = importModel(written(scene)).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("\"pane\" is see-through (opacity 0.25)"), std::string::npos) << warnings[0];
    scene["materials"] = json::parse(R"([{"emissiveFactor":[1,1,1]}])");
    const Building lamp = importModel(written(scene));
    EXPECT_EQ(lamp.materials[lamp.faces[0].material].reflectance, glm::vec3(0));
    scene["materials"] = json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.3,0.4,1]}}])");
    EXPECT_TRUE(importModel(written(scene)).repairs.empty());
    scene["materials"] = json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1]}}])");
    expectRefused(scene, "reflectance (baseColorFactor) is 1");
    scene["materials"] = json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.3,0.4]}}])");
    expectRefused(scene, "materials[0].pbrMetallicRoughness.baseColorFactor: has 3 numbers, expected 4");
}

TEST(GltfScene, a_texture_multiplies_the_colour_by_its_mean) {
    const std::vector<uint8_t> pixels{188, 188, 188, 90, 90, 90}; // 0.50 and 0.10
    const std::filesystem::path file = testing::TempDir() + fmt::format("texture-{}.png", ::getpid());
    writePngFile(file, 2, 1, pixels.data());
    const std::vector<uint8_t> png = bytesOf(file);
    json scene = roomScene(kOneNode);
    scene["meshes"][0]["primitives"][0]["material"] = 0;
    scene["textures"] = json::parse(R"([{"source":0}])");
    const auto expectColour = [&](const char* colour, float red, const char* field) {
        scene["materials"] = json::parse(colour);
        const Building building = importModel(written(scene));
        EXPECT_NEAR(building.materials[building.faces[0].material].reflectance.x, red, 1e-3) << colour;
        EXPECT_TRUE(building.warnings.empty());
        ASSERT_EQ(building.repairs.size(), 1u);
        EXPECT_NE(building.repairs[0].find(std::string("with the mean of ") + field), std::string::npos);
    };
    const std::string data = "data:image/png;base64," + base64({png.begin(), png.end()});
    for (const std::string& uri : {data, file.filename().string()}) {
        scene["images"] = json::array({{{"uri", uri}}});
        expectColour(R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])", 0.302f,
                     "baseColorTexture");
        expectColour(
            R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1],"baseColorTexture":{"index":0}}}])",
            0.151f, "baseColorTexture");
        expectColour(
            R"([{"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}}}])",
            0.302f, "diffuseTexture");
    }
    scene["images"] = json::array({{{"bufferView", 0}, {"mimeType", "image/png"}}}); // of numbers
    EXPECT_EQ(importModel(written(scene)).warnings.size(), 1u);
    // Cut short, of which the rest would be grey.
    const std::vector<uint8_t> jpeg = bytesOf(HELIODON_TEST_DATA "/vision/two_lights.jpg");
    const size_t half = jpeg.size() / 2;
    for (const size_t bytes : {jpeg.size(), half}) {
        const std::string part(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(bytes));
        scene["images"] = json::array({{{"uri", "data:image/jpeg;base64," + base64(part)}}});
        EXPECT_EQ(importModel(written(scene)).warnings.size(), bytes == half ? 1u : 0u);
    }
    scene["images"] = json::array({{{"uri", "none.png"}}});
    EXPECT_EQ(importModel(written(scene)).warnings.size(), 1u);
    scene["materials"] = json::parse(
        R"([{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],"baseColorTexture":{"index":0}}}])");
    expectRefused(scene, "takes it); not read: baseColorTexture in ");
    std::filesystem::remove(file);
}

TEST(GltfScene, colours_that_are_not_read_are_warned_of) {
    json scene = roomScene(kOneNode);
    json& primitive = scene["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    const auto expectWarned = [&](const char* what) {
        const std::vector<std::string> warnings = importModel(written(scene)).warnings;
        ASSERT_EQ(warnings.size(), 1u) << what;
        EXPECT_NE(warnings[0].find(fmt::format("\"wall\" ({} in ", what)), std::string::npos) << warnings[0];
    };
    scene["materials"] = json::parse(
        R"([{"name":"wall","pbrMetallicRoughness":{"baseColorFactor":[0.2,0.3,0.4,1],"baseColorTexture":{"index":0}}}])");
    expectWarned("baseColorTexture");
    scene["materials"] = json::parse(
        R"([{"name":"wall","extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.2,0.3,0.4,1],"diffuseTexture":{"index":0}}}}])");
    expectWarned("diffuseTexture");
    const Building building = importModel(written(scene));
    EXPECT_EQ(building.materials[building.faces[0].material].reflectance, glm::vec3(0.2f, 0.3f, 0.4f));
    EXPECT_TRUE(building.repairs.empty());
    json& older = scene["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    older.erase("diffuseTexture");
    EXPECT_TRUE(importModel(written(scene)).warnings.empty());
    primitive["attributes"]["COLOR_0"] = 0;
    expectWarned("COLOR_0");
    primitive["attributes"].erase("COLOR_0");
    scene["materials"][0]["emissiveTexture"]["index"] = 0; // emits nothing
    EXPECT_TRUE(importModel(written(scene)).warnings.empty());
    scene["materials"][0]["emissiveFactor"] = {1, 1, 1};
    expectWarned("emissiveTexture");
    scene["materials"][0].erase("emissiveFactor");
    older["diffuseFactor"] = {1, 1, 1, 1};
    expectRefused(scene, "reflectance (diffuseFactor) is 1");
    older["diffuseFactor"] = {0.2, 0.3, 0.4};
    expectRefused(scene, "diffuseFactor: has 3 numbers, expected 4");
}

TEST(GltfScene, what_is_said_of_a_buffer_does_not_repeat_it) {
    json scene = roomScene(kOneNode);
    scene["buffers"][0]["byteLength"] = 1000;
    expectRefused(scene, "data:application/octet-stream;base64,... ");
}

TEST(GltfScene, meshes_that_bend_or_are_instanced_are_refused_though_the_file_does_not_require_it) {
    json skinned = roomScene(kOneNode);
    skinned["skins"] = json::parse(R"([{"joints":[0]}])");
    skinned["nodes"][0]["skin"] = 0;
    expectRefused(skinned, "nodes[0].skin");
    json morphed = roomScene(kOneNode);
    morphed["meshes"][0]["primitives"][0]["targets"] = json::parse(R"([{"POSITION":0}])");
    morphed["meshes"][0]["weights"] = {0.0};
    EXPECT_EQ(importModel(written(morphed)).roomCount, 1u);
    morphed["meshes"][0]["weights"] = {1.0};
    expectRefused(morphed, "morph targets");
    json instanced = roomScene(kOneNode);
    instanced["extensionsUsed"] = json::array({"EXT_mesh_gpu_instancing"});
    instanced["nodes"][0]["extensions"] =
        json::parse(R"({"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}})");
    expectRefused(instanced, "EXT_mesh_gpu_instancing");
}

TEST(GltfScene, placements_of_a_wrong_length_are_refused_by_name) {
    const auto refused = [](const char* nodes, const std::string& why) {
        expectRefused(roomScene(json::parse(nodes)), why);
    };
    refused(R"([{"mesh":0,"scale":[2,2]}])", "nodes[0].scale: has 2 numbers, expected 3");
    refused(R"([{"mesh":0,"translation":[1,2,3,4]}])", "nodes[0].translation: has 4 numbers");
    refused(R"([{"mesh":0,"matrix":[1,0,0,0]}])", "nodes[0].matrix: has 4 numbers, expected 16");
    refused(R"([{"mesh":0,"matrix":[1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])",
            "nodes[0].matrix: has another last row than 0 0 0 1");
    refused(R"([{"mesh":0,"rotation":[0,0,0]}])", "nodes[0].rotation: has 3 numbers, expected 4");
    refused(R"([{"mesh":0,"rotation":[0,0,0,0]}])", "nodes[0].rotation: is no unit quaternion");
    refused(R"([{"mesh":0,"rotation":[0,2,0,2]}])", "nodes[0].rotation: is no unit quaternion");
    expectRooms(R"([{"mesh":0,"rotation":[0,0.708,0,0.708]}])", 1,
                30); // three digits turn, and stretch nothing
}

// Bytes past a view belong to another one: indices read as positions made a room of another size.
TEST(GltfScene, accessors_end_within_their_view) {
    json past = roomScene(kOneNode);
    past["accessors"][0]["byteOffset"] = 4;
    expectRefused(past, "POSITION: reaches past the end of its bufferView");
    json shortView = roomScene(kOneNode);
    shortView["bufferViews"][1]["byteLength"] = 70;
    expectRefused(shortView, "indices: reaches past the end of its bufferView");
    json longView = roomScene(kOneNode);
    longView["bufferViews"][1]["byteLength"] = 1000;
    expectRefused(longView, "indices: reaches past the end of its buffer");
    json overlapping = roomScene(kOneNode);
    overlapping["bufferViews"][0]["byteStride"] = 8;
    expectRefused(overlapping, "POSITION: has elements that overlap (byteStride)");
}

// The loader takes a field of another type for one that is absent.
TEST(GltfScene, fields_of_another_type_are_refused_by_name) {
    const json scene = roomScene(kOneNode);
    const auto refused = [&](const char* pointer, const json& value, const std::string& why) {
        json wrong = scene;
        wrong[json::json_pointer(pointer)] = value;
        expectRefused(wrong, why);
    };
    refused("/nodes/0/scale", "abc", "nodes[0].scale: expected a list");
    refused("/nodes/0/scale", json::parse(R"([2,"2",2])"), "nodes[0].scale[1]: expected a number");
    refused("/accessors/0/byteOffset", -4, "accessors[0].byteOffset: expected a whole number, 0 or more");
    refused("/accessors/1/byteOffset", 1.5, "accessors[1].byteOffset: expected a whole number");
    refused("/bufferViews/1/byteOffset", "96", "bufferViews[1].byteOffset: expected a whole number");
    refused("/meshes/0/primitives/0/mode", "5", "meshes[0].primitives[0].mode: expected a whole number");
    refused("/materials", json::parse(R"([{"extensions":{"KHR_materials_ior":{"ior":"1"}}}])"),
            "materials[0].extensions.KHR_materials_ior.ior: expected a number");
    refused("/materials", json::parse(R"([{"pbrMetallicRoughness":7}])"),
            "materials[0].pbrMetallicRoughness: expected an object");
    refused("/buffers/0/uri", testing::TempDir(), "does not exist, expected it beside the model"); // a folder
    refused("/buffers/0/uri", "none.bin",
            "buffers: \"none.bin\" does not exist, expected it beside the model");
}
