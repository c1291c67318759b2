#include "geometry/model_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "geometry/face_soup.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/picture_file.h"
#include "geometry/raw_model.h"

using namespace heliodon::geometry;
namespace fs = std::filesystem;

namespace {

const fs::path kEnclosures = HELIODON_TEST_DATA "/compute/formfactor",
               kRoom = HELIODON_TEST_DATA
               "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj"; // with a partition

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
    const PatchMesh mesh = readPatches(kEnclosures / "room3_672.obj");
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
    const PatchMesh slab = readPatches(kEnclosures / "thin_slab_1_1_0.001.obj");
    ASSERT_EQ(slab.patchCount(), 6u);
    EXPECT_EQ(std::set<uint32_t>(slab.surface.begin(), slab.surface.end()).size(), 6u);
    const PatchMesh two = readPatches(write("m.obj", kSquare + "f 1 2 3\nf 1 3 4\nv 5 5 0\nf 2 3 5\n"));
    EXPECT_EQ(two.surface[0], two.surface[1]);
}

TEST_F(ModelFile, what_stands_outside_is_no_patch) {
    const std::string outside = "g heliodon_outside\n";
    const PatchMesh mesh =
        readPatches(write("m.obj", kSquare + outside + "f 1 2 3 4\ng wall\nf 1 2 3\n"), UpAxis::z);
    EXPECT_EQ(mesh.patchCount(), 1u);
    EXPECT_EQ(mesh.outside.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(mesh.outside.vertices, mesh.vertices);
    EXPECT_EQ(refusal(kSquare + outside + "f 1 2 3 4\n"),
              "m.obj: holds no faces, expected lines such as f 1 2 3");
    EXPECT_EQ(refusal(kSquare + "v 1e200 0 0\nf 1 2 3\n" + outside + "f 1 2 5\n").substr(0, 24),
              "m.obj:heliodon_outside: ");
}

// A board over the room with the window is behind the glass, but shades the wall that the window looks at.
TEST_F(ModelFile, what_shades_a_wall_before_a_window_stands_outside) {
    write("m.mtl", "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 0 0 0\nTf 0.88 0.88 0.88\nNi 1.52\n");
    const auto box = [](double x, const std::string& east) {
        std::string text;
        for (const double z : {0.0, 3.0})
            for (const auto& [dx, y] : {std::pair{0, 0}, {4, 0}, {4, 5}, {0, 5}})
                text +=
                    "v " + std::to_string(x + dx) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        return text + "usemtl wall\nf -8 -7 -6 -5\nf -1 -2 -3 -4\nf -4 -3 -7 -8\nf -2 -1 -5 -6\n" +
               "f -1 -4 -8 -5\nusemtl " + east + "\nf -3 -2 -6 -7\n";
    };
    const std::string board = "usemtl wall\nv 3 0 5\nv 3 5 5\nv 3 5 9\nv 3 0 9\n"
                              "f -4 -3 -2 -1\n";
    const auto outside = [&](const std::string& rooms) {
        return importModel(write("m.obj", "mtllib m.mtl\n" + rooms + board), UpAxis::z).outside;
    };
    EXPECT_EQ(outside(box(0, "glass") + box(8, "wall")).material.size(), 2u);
    EXPECT_TRUE(outside(box(0, "glass")).material.empty());
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

// Many programs write glass by its opacity alone, with the air's refractive index, which is a hole's.
TEST_F(ModelFile, glass_by_name_whatever_the_file_says) {
    write("m.mtl", "newmtl wall\nKd 0.5\nnewmtl pane\nKd 0.9\nNi 1\nd 0.2\n");
    const std::string file = write("m.obj", "mtllib m.mtl\n" + kSquare + "usemtl pane\nf 1 2 3\n");
    const GivenMaterials green{{{"pane", {0.5, 0.75, 0.5}}}, {}}, other{{{"window", {0.5, 0.5, 0.5}}}, {}};
    EXPECT_FALSE(readPatches(file).materials[1].isOpening());
    const Material glass = readPatches(file, UpAxis::y, green).materials[1];
    EXPECT_EQ(glass.transmittance, glm::vec3(0.5f, 0.75f, 0.5f));
    EXPECT_EQ(glass.reflectance, glm::vec3(0));
    EXPECT_FLOAT_EQ(glass.refractiveIndex, 1.52f);
    try {
        readPatches(file, UpAxis::y, other);
        ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), file + ":window: is no material of this model, expected one of wall, pane");
    }
}

// Models are often passed on without their .mtl, and white is written as 1.
TEST_F(ModelFile, a_reflectance_for_what_the_file_does_not_define) {
    write("white.mtl", "newmtl white\nKd 1 0.5 0.25\nnewmtl pane\nKd 1 1 1\nTf 0.8 0.8 0.8\n");
    const std::string file = write("m.obj", "mtllib gone.mtl\nmtllib white.mtl\n" + kSquare +
                                                "usemtl white\nf 1 2 3\nusemtl brick\nf 1 3 4\nusemtl pane\n"
                                                "f 2 3 4\nusemtl window\nf 1 2 4\n");
    const std::vector<Glazing> panes{{"pane", glm::vec3(0.7f)}, {"window", glm::vec3(0.9f)}};
    const PatchMesh mesh = readPatches(file, UpAxis::y, {panes, 0.8f});
    const auto of = [&](size_t patch) { return mesh.materials[mesh.material[patch]]; };
    EXPECT_EQ(of(0).reflectance, glm::vec3(0.8f, 0.4f, 0.2f));
    EXPECT_EQ(of(1).reflectance, glm::vec3(0.8f));
    EXPECT_EQ(of(2).transmittance, glm::vec3(0.7f));
    EXPECT_EQ(of(3).transmittance, glm::vec3(0.9f));
    for (const GivenMaterials& few : {GivenMaterials{panes, {}}, {{panes[0]}, {}}, {{panes[1]}, 0.8f}})
        EXPECT_THROW(readPatches(file, UpAxis::y, few), InputError);
}

TEST_F(ModelFile, what_is_left_out_by_name_is_as_not_in_the_file) {
    write("m.mtl", "newmtl wall\nKd 0.5\nnewmtl leaf\nKd 1.5\nnewmtl trunk\nKd 0.25\n");
    const std::string begin = "mtllib m.mtl\n" + kSquare + "v 9 9 9\nv 8 9 9\nv 8 8 9\n",
                      wall = "o Wall\nusemtl wall\nf 1 2 3 4\n",
                      tree = "o Tree\ng top\nusemtl leaf\nf 5 6 7\ng low\nusemtl trunk\nf 5 7 6\n";
    const std::string file = write("m.obj", begin + tree + wall);
    const auto without = [&](std::vector<std::string> names) {
        return readRawModel(file, {.glazing = {}, .reflectance = {}, .leftOut = std::move(names)});
    };
    EXPECT_THROW(without({}), InputError);      // Kd 1.5
    EXPECT_THROW(without({"low"}), InputError); // still
    for (const std::vector<std::string>& all :
         {std::vector<std::string>{"Tree"}, {"top", "low"}, {"leaf", "trunk"}}) {
        const RawModel rest = without(all);
        ASSERT_EQ(rest.faceCount(), 1u);
        EXPECT_EQ(rest.place(0), "18 (object \"Wall\")");
        EXPECT_EQ(std::vector<uint32_t>(rest.face(0).begin(), rest.face(0).end()),
                  (std::vector<uint32_t>{0, 1, 2, 3}));
        for (const glm::dvec3 p : rest.vertices) EXPECT_LT(p.x, 2);
    }
    EXPECT_EQ(without({"Tree"}).leftOut,
              std::vector<std::string>{"2 faces of \"Tree\" left out (--leave-out)"});
    EXPECT_EQ(without({"leaf"}).faceCount(), 2u);
    try {
        without({"Bush"});
        ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), "--leave-out:Bush: names no face of " + file +
                                    ", expected one of Tree, Wall, wall, leaf, trunk");
    }
}

TEST_F(ModelFile, a_face_of_no_material_is_grey) {
    const PatchMesh mesh = readPatches(write("m.obj", kSquare + "usemtl \nf 1 2 3\n"));
    EXPECT_EQ(mesh.materials[mesh.material[0]].reflectance, glm::vec3(0.5f));
}

TEST_F(ModelFile, what_the_format_allows_but_few_programs_write) {
    write("a.mtl", "\xEF\xBB\xBFnewmtl a\nKd 0.25\n");
    write("b c.mtl", "newmtl b\rKd +0.5 5e-1 .5\r"); // lines of an old Mac
    const std::string square = "\xEF\xBB\xBFmtllib a.mtl b.mtl\n" + kSquare;
    EXPECT_EQ(refusal("mtllib a.mtl b c.mtl\n" + kSquare + "f 1 2 3\n")
                  .rfind("m.obj:1: mtllib \"a.mtl b c.mtl\" ", 0),
              0u);
    write("b.mtl", "newmtl b\nKd 0.5 0.5 0.5\n");
    const PatchMesh mesh = readPatches(write("m.obj", square + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n"));
    ASSERT_EQ(mesh.materials.size(), 2u);
    EXPECT_EQ(mesh.materials[0].reflectance, glm::vec3(0.25f));
    EXPECT_EQ(refusal("mtllib b c.mtl\nv +0.0 +0 0\nv +1e0 0 0\nv 1 1 0\nusemtl b\nf 1 2 3\n"), "accepted");
    EXPECT_EQ(refusal("v 0 +-1 0\n"), "m.obj:1: \"+-1\" is not a finite number, expected v x y z");
}

// As programs for Windows write them, and files that came without their folders.
TEST_F(ModelFile, materials_beside_the_model_are_found_by_name) {
    write("room.mtl", "newmtl a\nKd 0.25\n");
    for (const char* name : {"room.mtl", "Room.MTL", ".\\room.mtl", "C:\\Users\\me\\models\\room.mtl",
                             "/home/me/room.mtl", "\"room.mtl\""})
        EXPECT_EQ(refusal(std::string("mtllib ") + name + "\n" + kSquare + "usemtl a\nf 1 2 3\n"), "accepted")
            << name;
    EXPECT_NE(refusal("mtllib models\\other.mtl\n" + kSquare), "accepted");
    write("b.mtl", "newmtl b\nKd 0.5\n");
    for (const char* two : {"./room.mtl ./b.mtl", "m/room.mtl m/b.mtl"}) // not the last alone
        EXPECT_EQ(refusal(std::string("mtllib ") + two + "\n" + kSquare + "usemtl a\nf 1 2 3\n"), "accepted")
            << two;
}

TEST_F(ModelFile, messages_hold_no_more_than_a_line_of_text) {
    EXPECT_EQ(refusal(std::string("\nv 0 4\0\x1b[2J 0\n", 15)),
              "m.obj:2: \"4??[2J\" is not a finite number, expected v x y z");
    EXPECT_EQ(refusal(std::string("\xFF\xFEv\0 \0", 6)),
              "m.obj: is UTF-16, expected UTF-8: save it in that encoding");
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
    EXPECT_EQ(refusal(kSquare + "v 0.2 0.5 0\nf 1 2 3 4 5\n"),
              "m.obj:6: the face is not convex, as a patch must be; `heliodon model` cuts such faces");
    EXPECT_EQ(refusal("v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\n").substr(0, 34),
              "m.obj:5: the face is not planar, a");
    EXPECT_EQ(refusal("v 0 nan 0\n"), "m.obj:1: \"nan\" is not a finite number, expected v x y z");
    EXPECT_EQ(refusal("v 0 0\n"), "m.obj:1: ends early, expected v x y z");
    EXPECT_EQ(refusal(kSquare), "m.obj: holds no faces, expected lines such as f 1 2 3");
    // Round and round the same square: each corner turns left, yet no simple polygon.
    EXPECT_EQ(refusal(kSquare + "f 1 2 3 4 1 2 3 4\n"), "m.obj:5: the face winds round itself");
}

// Pictures and models of other programs under a wrong name, and what is nothing.
TEST_F(ModelFile, files_of_another_kind_are_told_what_they_are) {
    using namespace std::string_literals;
    const auto said = [&](const std::string& name, const std::string& bytes) {
        try {
            importModel(write(name, bytes));
        } catch (const InputError& error) {
            return std::string(error.what()).substr(folder.string().size() + 1);
        }
        return "accepted"s;
    };
    for (const std::string name : {"m.obj", "m.gltf", "m.glb"}) {
        for (const auto& [bytes, kind] :
             std::vector<std::pair<std::string, std::string>>{{"\x89PNG\r\n\x1A\nf \n", "a picture (PNG)"},
                                                              {"\xFF\xD8\xFF\xE0", "a picture (JPEG)"},
                                                              {"II*\0"s, "a picture (TIFF)"},
                                                              {"PK\3\4a", "an archive (zip)"},
                                                              {"\x1F\x8B\x08", "compressed (gzip)"},
                                                              {"BLENDER-v304", "a scene of Blender (.blend)"},
                                                              {"AC1032\0\0f"s, "no text"}})
            EXPECT_TRUE(said(name, bytes).starts_with(name + ": is " + kind + ", expected a model"))
                << said(name, bytes);
    }
    EXPECT_TRUE(said("m.obj", "glTF\2\0\0\0"s).starts_with("m.obj: is a model (.glb), expected"));
    for (const char* nothing : {"", " \n", "\xEF\xBB\xBF", "\xEF\xBB\xBF\n"})
        EXPECT_EQ(said("m.glb", nothing), "m.glb: is empty, expected a model (glTF 2.0)");
}

TEST_F(ModelFile, a_glb_that_was_cut_off_says_so) {
    const fs::path file = folder / "m.glb";
    writeModel(readPatches(kEnclosures / "room3_672.obj"), file);
    const auto size = fs::file_size(file);
    for (const auto length : {size - 1, size / 2, uintmax_t{21}, uintmax_t{12}, uintmax_t{4}}) {
        fs::resize_file(file, length);
        try {
            importModel(file);
            ADD_FAILURE() << length;
        } catch (const InputError& error) {
            EXPECT_EQ(error.what(), fmt::format("{}: is cut off after {} bytes, expected {} and more",
                                                file.string(), length, length < 20 ? 20 : size));
        }
    }
}

TEST_F(ModelFile, a_glb_of_the_format_before_says_so) {
    const fs::path file = write("m.glb", std::string("glTF\1\0\0\0\xff\0\0\0", 12)); // and cut off
    try {
        importModel(file);
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), file.string() + ": is glTF 1.0 in binary, expected 2.0");
    }
}

TEST_F(ModelFile, unphysical_materials_are_named_by_line) {
    const auto withMtl = [&](const std::string& mtl) {
        write("m.mtl", mtl);
        return refusal("mtllib m.mtl\n" + kSquare + "f 1 2 3\n");
    };
    EXPECT_EQ(withMtl("newmtl a\nKd 1 0 0\n"),
              "m.mtl:2: material \"a\": reflectance (Kd) is 1, expected 0 to below 1 (white paint: 0.85, as "
              "which --reflectance 0.85 takes it)");
    EXPECT_EQ(withMtl("newmtl a\nKd -1 0 0\n"),
              "m.mtl:2: material \"a\": reflectance (Kd) is -1, expected 0 to below 1 (white paint: 0.85)");
    EXPECT_EQ(withMtl("newmtl a\nKe 1e30 0 0\n"),
              "m.mtl:2: material \"a\": exitance (Ke) is 1e+30, expected 0 to 1e+10 lux");
    EXPECT_EQ(withMtl("newmtl a\nKd nan 0 0\n"),
              "m.mtl:2: \"nan\" is not a finite number, expected three numbers r g b");
    EXPECT_EQ(
        withMtl("newmtl a\nKd 0.8 0.8 0.8\nTf 1 1 1\n"),
        "m.mtl:3: material \"a\": reflectance 0.8 and transmittance (Tf) 1 add up to more than 1; an opaque "
        "material has no Tf");
    EXPECT_EQ(
        withMtl("newmtl a\nd 0.5\nTf 1 1 1\nKd 0.8 0.8 0.8\nNi 1.5\n"),
        "m.mtl:4: material \"a\": reflectance 0.8 and transmittance (Tf) 1 add up to more than 1; an opaque "
        "material has no Tf");
    EXPECT_EQ(withMtl("Kd 0 0 0\n"), "m.mtl:1: Kd stands before any newmtl");
    const std::string triangle = kSquare + "f 1 2 3\n";
    EXPECT_EQ(refusal("# no\nmtllib missing.mtl\n" + triangle),
              "m.obj:2: mtllib \"missing.mtl\" does not exist, expected materials (.mtl); --reflectance 0.5 "
              "takes them as grey, --glass MATERIAL=0.8 one as glass");
    EXPECT_EQ(refusal("mtllib\n"), "m.obj:1: mtllib without a name");
    EXPECT_EQ(refusal("usemtl red\n" + triangle),
              "m.obj:1: material \"red\" is not defined in any mtllib; --reflectance 0.5 takes it as grey, "
              "--glass \"red=0.8\" as glass");
}

TEST_F(ModelFile, cut_short_at_any_byte_never_reads_past_the_end) {
    std::ifstream in(kEnclosures / "thin_slab_1_1_0.001.obj", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    for (size_t length = 0; length < whole.size(); ++length) {
        try {
            readPatches(write("m.obj", whole.substr(0, length)));
        } catch (const InputError&) { // what a cut-off file may be
        }
    }
}

namespace {

// A unit cube with outward faces, as most modellers write it; face k is on line first + 8 + k.
std::string cube(double size, glm::dvec3 at, int firstVertex) {
    std::string text;
    for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 2; ++x)
                text += fmt::format("v {} {} {}\n", at.x + size * x, at.y + size * y, at.z + size * z);
    const int quads[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                             {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
    for (const auto& q : quads) {
        text += "f";
        for (const int v : q) text += fmt::format(" {}", v + firstVertex - 1);
        text += "\n";
    }
    return text;
}

double airVolume(const Building& building, uint32_t room) {
    return proveShells(building).at(room).volume;
}

void expectSameMesh(const PatchMesh& a, const PatchMesh& b, double tolerance) {
    ASSERT_EQ(a.patchCount(), b.patchCount());
    double areaA = 0, areaB = 0;
    for (size_t i = 0; i < a.patchCount(); ++i) {
        areaA += patchArea(a, i);
        areaB += patchArea(b, i);
    }
    EXPECT_NEAR(areaA, areaB, tolerance * areaA);
}

} // namespace

TEST_F(ModelFile, daylight_reference_room_imports_with_its_partition) {
    const Building b = importModel(kRoom, UpAxis::z);
    EXPECT_EQ(b.roomCount, 1u);
    // L: 24 x 12 + 14 x 8 ft, 10 ft high, less a partition 4 ft high, 6 ft long, 1 in thick.
    const double ft = 0.3048;
    EXPECT_NEAR(airVolume(b, 0), ((24 * 12 + 14 * 8) * 10 - 4 * 6 / 12.0) * ft * ft * ft, 1e-4);
    size_t openings = 0;
    for (const Face& f : b.faces) openings += b.materials[f.material].isOpening();
    EXPECT_EQ(openings, 3u); // two windows and a skylight
}

TEST_F(ModelFile, triangulated_room_imports_closed) {
    const Building b = importModel(kEnclosures / "room3_672.obj");
    EXPECT_EQ(b.faces.size(), 672u);
    EXPECT_NEAR(airVolume(b, 0), 8 * 6 * 3 - 0.2 * (4 * 3 + 4 * 2.5 + 3 * 2), 1e-9);
}

TEST_F(ModelFile, faces_are_turned_to_the_air) {
    // Outward cube: all turned. One face turned over by hand: mended too.
    std::string text = cube(1, {0, 0, 0}, 1);
    const Building whole = importModel(write("m.obj", text));
    EXPECT_NEAR(airVolume(whole, 0), 1, 1e-12);
    const size_t face = text.find("f 1 2 6 5");
    text.replace(face, 9, "f 5 6 2 1");
    EXPECT_NEAR(airVolume(importModel(write("m.obj", text)), 0), 1, 1e-12);
}

TEST_F(ModelFile, boxes_in_a_room_belong_to_its_air) {
    const Building floating = importModel(write("m.obj", cube(3, {0, 0, 0}, 1) + cube(1, {1, 1, 1}, 9)));
    EXPECT_EQ(floating.roomCount, 1u);
    EXPECT_NEAR(airVolume(floating, 0), 26, 1e-12);
    // Standing on the floor, whose face is not cut out for it.
    const Building standing = importModel(write("m.obj", cube(3, {0, 0, 0}, 1) + cube(1, {1, 1, 0}, 9)));
    EXPECT_EQ(standing.roomCount, 1u);
    EXPECT_NEAR(airVolume(standing, 0), 26, 1e-12);
    const Building apart = importModel(write("m.obj", cube(3, {0, 0, 0}, 1) + cube(1, {5, 1, 0}, 9)));
    EXPECT_EQ(apart.roomCount, 2u);
}

TEST_F(ModelFile, what_is_not_closed_is_refused_by_line) {
    std::string text = cube(1, {0, 0, 0}, 1);
    text.resize(text.rfind("f 2 4 8 6"));
    try {
        importModel(write("m.obj", text));
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("m.obj:9: the model is not closed"), std::string::npos)
            << error.what();
    }
    // Two boxes that cross.
    EXPECT_THROW(importModel(write("m.obj", cube(3, {0, 0, 0}, 1) + cube(1, {2.5, 1, 1}, 9))), InputError);
}

TEST_F(ModelFile, t_vertices_are_split_into_the_edge) {
    // The top of the cube in two halves, its neighbours' edges not divided.
    std::string text = cube(1, {0, 0, 0}, 1);
    text.replace(text.find("f 5 6 8 7"), 9, "v 0.5 0 1\nv 0.5 1 1\nf 5 9 10 7\nf 9 6 8 10");
    const Building b = importModel(write("m.obj", text));
    EXPECT_NEAR(airVolume(b, 0), 1, 1e-12);
    EXPECT_EQ(b.faces.size(), 7u);
}

TEST_F(ModelFile, written_models_read_back) {
    const PatchMesh mesh = meshBuilding(importModel(kRoom, UpAxis::z), {500});
    writeModel(mesh, folder / "out.obj");
    const PatchMesh obj = readPatches(folder / "out.obj");
    expectSameMesh(mesh, obj, 1e-12);
    writeModel(mesh, folder / "out.glb");
    const PatchMesh glb = readPatches(folder / "out.glb");
    expectSameMesh(mesh, glb, 1e-6); // float32 positions
    ASSERT_EQ(glb.materials.size(), mesh.materials.size());
    for (size_t i = 0; i < mesh.materials.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(glb.materials[i].reflectance[c], mesh.materials[i].reflectance[c], 1e-6);
            EXPECT_NEAR(glb.materials[i].transmittance[c], mesh.materials[i].transmittance[c], 1e-6);
            EXPECT_EQ(obj.materials[i].reflectance[c], mesh.materials[i].reflectance[c]);
        }
    // And closed again: what is written out can be taken in.
    EXPECT_NEAR(airVolume(importModel(folder / "out.glb"), 0), airVolume(importModel(kRoom, UpAxis::z), 0),
                1e-4);
    EXPECT_THROW(writeModel(mesh, folder / "out.stl"), InputError);
    writeModel(mesh, folder / "no #1.obj"); // a comment, were it to name its materials so
    EXPECT_EQ(readPatches(folder / "no #1.obj").materials.size(), obj.materials.size());
}

TEST_F(ModelFile, no_materials_are_written_without_their_model) {
    const PatchMesh mesh = readPatches(kEnclosures / "thin_slab_1_1_0.001.obj");
    fs::create_directories(folder / "a.obj");
    EXPECT_THROW(writeModel(mesh, folder / "a.obj"), InputError);
    EXPECT_FALSE(fs::exists(folder / "a.mtl"));
    fs::create_directories(folder / "b.mtl");
    EXPECT_THROW(writeModel(mesh, folder / "b.obj"), InputError);
    EXPECT_FALSE(fs::exists(folder / "b.obj"));
}

TEST_F(ModelFile, north_goes_along) {
    const Building room = importModel(kRoom, UpAxis::z);
    EXPECT_EQ(room.northDeg, 90);
    const PatchMesh mesh = meshBuilding(room, {500});
    for (const char* name : {"turned.obj", "turned.glb"}) {
        writeModel(mesh, folder / name, 37.25);
        EXPECT_EQ(importModel(folder / name).northDeg, 37.25) << name;
        writeModel(mesh, folder / name);
        EXPECT_EQ(importModel(folder / name).northDeg, 90) << name;
    }
    std::ofstream(folder / "bad.obj") << "v 0 0 0\nnorth up\n";
    EXPECT_THROW(importModel(folder / "bad.obj"), InputError);
}

// What a modelling program makes objects and materials of, read without our reader.
TEST_F(ModelFile, objects_are_rooms_and_roles_in_what_is_written) {
    const PatchMesh mesh = meshBuilding(importModel(kRoom, UpAxis::z), {500});
    std::map<std::string, std::map<std::string, int>> expected; // faces by object and material
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const char* role = mesh.role[i] == Role::fillIn ? "fill-in" : "projection";
        ++expected[fmt::format("room{}_{}", mesh.room[i], role)][mesh.materials[mesh.material[i]].name];
    }
    writeModel(mesh, folder / "out.obj");
    std::map<std::string, std::map<std::string, int>> found;
    std::ifstream in(folder / "out.obj");
    std::string object, group, material;
    for (std::string key; in >> key;) {
        if (key == "o") {
            in >> object;
            EXPECT_FALSE(found.contains(object)) << "one object, one place";
        } else if (key == "g")
            in >> group;
        else if (key == "usemtl")
            in >> material;
        else if (key == "f") {
            EXPECT_EQ(object, group);
            ++found[object][material];
        }
        std::getline(in, key);
    }
    EXPECT_EQ(found, expected);
    std::ifstream library(folder / "out.mtl");
    const std::string text((std::istreambuf_iterator<char>(library)), {});
    EXPECT_NE(text.find("\nd 0"), std::string::npos) << "glass that viewers without Tf see through\n" << text;

    writeModel(mesh, folder / "out.glb");
    std::ifstream binary(folder / "out.glb", std::ios::binary);
    const std::string glb((std::istreambuf_iterator<char>(binary)), {});
    uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, 4);
    const nlohmann::json json = nlohmann::json::parse(glb.substr(20, length));
    found.clear();
    for (const auto& node : json["nodes"])
        for (const auto& part : json["meshes"][node["mesh"].get<size_t>()]["primitives"])
            found[node["name"]][json["materials"][part["material"].get<size_t>()]["name"]] +=
                json["accessors"][part["indices"].get<size_t>()]["count"].get<int>() / 3;
    EXPECT_EQ(found, expected);
}

TEST_F(ModelFile, damaged_glb_is_refused_not_read_past_its_end) {
    writeModel(readPatches(kEnclosures / "thin_slab_1_1_0.001.obj"), folder / "whole.glb");
    std::ifstream in(folder / "whole.glb", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    for (size_t length = 0; length < whole.size(); length += 7)
        EXPECT_THROW(readPatches(write("cut.glb", whole.substr(0, length))), InputError) << length;
}

// 188 of 255 in sRGB is 0.50, 90 is 0.10.
TEST_F(ModelFile, what_a_texture_alone_colours_reflects_its_mean) {
    const std::vector<uint8_t> pixels{188, 188, 188, 90, 90, 90};
    writePngFile(folder / "Brick Wall.png", 2, 1, pixels.data());
    const std::string box =
        "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 5\nv 4 0 5\nv 4 3 5\nv 0 3 5\nusemtl wall\n"
        "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
    for (const char* lines : {"map_Kd Brick Wall.png\n", "Kd 1 1 1\nmap_Kd C:\\tex\\brick wall.PNG\n"}) {
        write("m.mtl", std::string("newmtl wall\n") + lines);
        const Building building = importModel(write("m.obj", box));
        EXPECT_NEAR(building.materials[building.faces[0].material].reflectance.y, 0.302, 1e-3) << lines;
        EXPECT_TRUE(building.warnings.empty());
        ASSERT_EQ(building.repairs.size(), 1u);
        EXPECT_TRUE(
            building.repairs[0].starts_with("material \"wall\": a reflectance of 0.30 0.30 0.30 was taken, "
                                            "with the mean of map_Kd "))
            << building.repairs[0];
    }
    write("m.mtl", "newmtl wall\nKd .6 .6 .6\nmap_Kd -s 2 2 1 \"Brick Wall.png\"\n"); // of both, or of one
    const Building both = importModel(write("m.obj", box));
    EXPECT_EQ(both.materials[both.faces[0].material].reflectance.y, 0.6f);
    EXPECT_EQ(both.warnings.size(), 1u);
    write("m.mtl", "newmtl wall\nmap_Kd none.png\n");
    const Building none = importModel(write("m.obj", box));
    EXPECT_EQ(none.materials[none.faces[0].material].reflectance.y, 0.5f);
    EXPECT_EQ(none.warnings.size(), 1u);
}

TEST_F(ModelFile, materials_with_a_texture_or_two_definitions_are_warned_of) {
    const std::string box =
        "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 5\nv 4 0 5\nv 4 3 5\nv 0 3 5\nusemtl wall\n"
        "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
    const std::string mtl = "newmtl wall\nKd 0.6 0.6 0.6\n";
    const auto warnings = [&](const std::string& libraries) {
        return importModel(write("m.obj", "mtllib " + libraries + "\n" + box)).warnings;
    };
    write("one.mtl", mtl), write("same.mtl", mtl + "newmtl other\nKd 0.1 0.1 0.1\nmap_Kd unused.png\n");
    EXPECT_TRUE(warnings("one.mtl same.mtl").empty());
    write("other.mtl", "newmtl wall\nKd 0.1 0.1 0.1\n");
    std::vector<std::string> said = warnings("one.mtl other.mtl");
    ASSERT_EQ(said.size(), 1u);
    EXPECT_NE(said[0].find("material \"wall\" is defined again in "), std::string::npos) << said[0];
    EXPECT_NE(said[0].find("other.mtl:2"), std::string::npos) << said[0];
    const Building glass = importModel(write("m.obj", "mtllib one.mtl other.mtl\n" + box), UpAxis::y,
                                       {.materials = {.glazing = {{"wall", glm::vec3(0.8f)}}}});
    EXPECT_TRUE(glass.materials[glass.faces[0].material].isOpening());
    write("one.mtl", mtl + "map_Kd brick.png\n");
    said = warnings("one.mtl");
    ASSERT_EQ(said.size(), 1u);
    EXPECT_NE(said[0].find("\"wall\" (map_Kd brick.png in "), std::string::npos) << said[0];
}
