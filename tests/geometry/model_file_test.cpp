#include "geometry/model_file.h"

#include <filesystem>
#include <fstream>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/input_error.h"

using namespace heliodon::geometry;
namespace fs = std::filesystem;

namespace {

const fs::path kModels = HELIODON_TEST_DATA "/geometry/models";

class ModelFile : public testing::Test {
protected:
    fs::path folder = fs::temp_directory_path() / ("heliodon_model_" + std::to_string(::getpid()));

    void SetUp() override { fs::create_directories(folder); }
    void TearDown() override { fs::remove_all(folder); }

    fs::path write(const std::string& name, const std::string& text) {
        std::ofstream(folder / name, std::ios::binary) << text;
        return folder / name;
    }

    // The message of the refusal, after the folder's name.
    std::string refusal(const std::string& obj) {
        try {
            readPatches(write("m.obj", obj));
        } catch (const InputError& error) {
            return std::string(error.what()).substr(folder.string().size() + 1);
        }
        return "accepted";
    }
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

} // namespace

TEST_F(ModelFile, faces_stay_as_in_the_file) {
    const PatchMesh mesh = readPatches(kModels / "room3_672.obj");
    ASSERT_EQ(mesh.patchCount(), 672u);
    double total = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) total += patchArea(mesh, i);
    // Room 8 x 6 x 3 with partitions 0.2 x 4 x 3, 0.2 x 4 x 2.5, 0.2 x 3 x 2, of which two touch a wall and
    // one the ceiling; each cuts its footprint from the floor. The file's coordinates are exact binary
    // fractions but for the 0.2s, printed with 17 digits.
    const double shell = 2 * (8 * 6) + 2 * (8 * 3) + 2 * (6 * 3);
    const double full = 2 * 4 * 3 + 0.2 * 3 - 2 * 0.2 * 4 - 0.2 * 3;
    const double tall = 2 * 4 * 2.5 + 0.2 * 2.5 + 0.2 * 4 - 0.2 * 4 - 0.2 * 2.5;
    const double free = 2 * 3 * 2 + 2 * 0.2 * 2 + 0.2 * 3 - 0.2 * 3;
    EXPECT_NEAR(total, shell + full + tall + free, 1e-9);
    for (const uint32_t room : mesh.room) EXPECT_EQ(room, 0u);
}

TEST_F(ModelFile, coplanar_neighbours_of_one_material_are_one_surface) {
    const PatchMesh slab = readPatches(kModels / "thin_slab_1_1_0.001.obj");
    ASSERT_EQ(slab.patchCount(), 6u);
    EXPECT_EQ(std::set<uint32_t>(slab.surface.begin(), slab.surface.end()).size(), 6u);
    const PatchMesh two = readPatches(write("m.obj", kSquare + "f 1 2 3\nf 1 3 4\nv 5 5 0\nf 2 3 5\n"));
    EXPECT_EQ(two.surface[0], two.surface[1]);
}

TEST_F(ModelFile, z_up_is_turned_so_that_up_is_y) {
    const PatchMesh mesh = readPatches(write("m.obj", kSquare + "f 1 2 3 4\n"), UpAxis::z);
    const glm::dvec3 normal = patchNormal(mesh, 0);
    EXPECT_EQ(normal, glm::dvec3(0, 1, 0));
    EXPECT_EQ(worldFromModel({1, 2, 3}, UpAxis::z), glm::dvec3(1, 3, -2));
}

TEST_F(ModelFile, materials_are_read_and_unknown_keys_ignored) {
    write("m.mtl", "newmtl a wall\nKd 0.5 0.25 0.125\nNs 3\nmap_Kd x.png\nillum 2\n"
                   "newmtl glass\nKd 0 0 0\nTf 0.88 0.88 0.88\nNi 1.52\nnewmtl lamp\nKe 1000 900 800\n");
    const PatchMesh mesh = readPatches(write("m.obj", "mtllib m.mtl\no thing\ns off\nvt 0 0\n" + kSquare +
                                                          "usemtl glass\nf 1/1 2/1 3/1\nusemtl a wall\n"
                                                          "f -4//1 -2//1 -1//1\r\n"));
    ASSERT_EQ(mesh.materials.size(), 3u);
    EXPECT_EQ(mesh.material, (std::vector<uint32_t>{1, 0}));
    EXPECT_EQ(mesh.materials[0].reflectance, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_FALSE(mesh.materials[0].isOpening());
    EXPECT_TRUE(mesh.materials[1].isOpening());
    EXPECT_FLOAT_EQ(mesh.materials[1].refractiveIndex, 1.52f);
    EXPECT_EQ(mesh.materials[2].exitance, glm::vec3(1000, 900, 800));
    EXPECT_EQ(mesh.materials[2].reflectance, glm::vec3(0)); // a lamp without Kd reflects nothing
}

TEST_F(ModelFile, bad_faces_are_named_by_line) {
    EXPECT_EQ(refusal(kSquare + "f 1 2 9\n"), "m.obj:5: vertex 9 does not exist, 4 are defined so far");
    EXPECT_EQ(refusal(kSquare + "f 1 2 -5\n"), "m.obj:5: vertex -5 does not exist, 4 are defined so far");
    EXPECT_EQ(refusal(kSquare + "f 0 1 2\n"), "m.obj:5: vertex 0 does not exist, 4 are defined so far");
    EXPECT_EQ(refusal(kSquare + "f 1 2\n"), "m.obj:5: a face of 2 corners, expected at least 3");
    EXPECT_EQ(refusal(kSquare + "f 1 x 3\n"), "m.obj:5: \"x\" is not a vertex index");
    EXPECT_EQ(refusal(kSquare + "f 1 2 2 3\n"), "m.obj:5: the face repeats a corner");
    EXPECT_EQ(refusal(kSquare + "v 2 0 0\n# remark\nf 1 2 5\n"), "m.obj:7: the face has no area");
    EXPECT_EQ(refusal(kSquare + "f 1 3 2 4\n").substr(0, 8), "m.obj:5:"); // a bow tie
    EXPECT_EQ(refusal(kSquare + "v 0.4 0.6 0\nf 1 2 5 4\n"), "accepted");
    EXPECT_EQ(refusal(kSquare + "v 0.2 0.5 0\nf 1 2 3 4 5\n"), "m.obj:6: the face is not convex");
    EXPECT_EQ(refusal("v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\n").substr(0, 34),
              "m.obj:5: the face is not planar, a");
    EXPECT_EQ(refusal("v 0 nan 0\n"), "m.obj:1: \"nan\" is not a finite number, expected v x y z");
    EXPECT_EQ(refusal("v 0 0\n"), "m.obj:1: ends early, expected v x y z");
    EXPECT_EQ(refusal(kSquare), "m.obj: holds no faces");
    // Round and round the same square: each corner turns left, yet no simple polygon.
    EXPECT_EQ(refusal(kSquare + "f 1 2 3 4 1 2 3 4\n"), "m.obj:5: the face winds round itself");
}

TEST_F(ModelFile, unphysical_materials_are_named_by_line) {
    const auto withMtl = [&](const std::string& mtl) {
        write("m.mtl", mtl);
        return refusal("mtllib m.mtl\n" + kSquare + "f 1 2 3\n");
    };
    EXPECT_EQ(withMtl("newmtl a\nKd 1 0 0\n"),
              "m.mtl:2: material \"a\": reflectance (Kd) is 1, expected 0 to below 1");
    EXPECT_EQ(withMtl("newmtl a\nKd nan 0 0\n"),
              "m.mtl:2: \"nan\" is not a finite number, expected three numbers r g b");
    EXPECT_EQ(
        withMtl("newmtl a\nKd 0.8 0.8 0.8\nTf 1 1 1\n"),
        "m.mtl:3: material \"a\": reflectance 0.8 and transmittance (Tf) 1 add up to more than 1; an opaque "
        "material has no Tf");
    EXPECT_EQ(withMtl("Kd 0 0 0\n"), "m.mtl:1: Kd stands before any newmtl");
    EXPECT_EQ(refusal("mtllib missing.mtl\n"), "missing.mtl: cannot be read");
    EXPECT_EQ(refusal("usemtl red\n"), "m.obj:1: material \"red\" is not defined in any mtllib");
}

TEST_F(ModelFile, cut_short_at_any_byte_never_reads_past_the_end) {
    std::ifstream in(kModels / "thin_slab_1_1_0.001.obj", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    for (size_t length = 0; length < whole.size(); ++length) {
        try {
            readPatches(write("m.obj", whole.substr(0, length)));
        } catch (const InputError&) { // what a cut-off file may be
        }
    }
}
