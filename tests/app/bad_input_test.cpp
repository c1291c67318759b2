// Bad input: one clear line that names file and place, exit code 2, nothing written.
#include <algorithm>

#include "geometry/picture_file.h"
#include "geometry/rig.h"
#include "geometry/whole_file.h"
#include "tests/app/program.h"
#include "tests/vision/table_painter.h"

namespace heliodon::test {
namespace {

const std::string kRig = HELIODON_SOURCE "/examples/rig.json";
const std::string kPhoto = HELIODON_SOURCE "/examples/i01_mixed.png";

class BadInput : public InFolder {
protected:
    // Every word must be in the one line that is printed, and `out` must not have appeared.
    void expectRefused(const std::string& arguments, const std::vector<std::string>& words) {
        const Outcome outcome = heliodon(arguments);
        EXPECT_EQ(outcome.exitCode, 2) << outcome.output;
        EXPECT_TRUE(outcome.output.starts_with("heliodon: ")) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        for (const std::string& word : words)
            EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " in " << outcome.output;
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            EXPECT_EQ(entry.path().filename().string().find("out"), std::string::npos) << entry.path();
    }
};

TEST_F(BadInput, a_missing_photograph) {
    expectRefused("detect " + in("none.png") + " --rig " + kRig + " -o " + in("out.json"),
                  {"none.png", "does not exist"});
}

TEST_F(BadInput, a_photograph_without_a_rig) {
    expectRefused("model " + kPhoto + " -o " + in("out.obj"), {"i01_mixed.png", "--rig"});
}

// Without its warnings the line alone tells why.
TEST_F(BadInput, a_photograph_of_which_walls_were_left_out) {
    const geometry::Rig rig = geometry::readRig(kRig);
    geometry::Sketch sketch;
    sketch.walls.resize(1);
    sketch.walls[0].a = {-5, 3}, sketch.walls[0].b = {5, 3};
    vision::Photograph photo = vision::paintTable(sketch, rig);
    vision::cover(photo, rig, {{-5, -4}, {5, -4}, {5, -3}, {-5, -3}}, 0, {0.4, 0.06, 0.06});
    geometry::writePngFile(in("photo.png"), photo.width, photo.height, photo.rgb.data());
    expectRefused("model --quiet " + in("photo.png") + " --rig " + kRig + " -o " + in("out.obj"),
                  {"photo.png", "NOT_ENCLOSED", "1 piece in the photograph was left out that may be a wall"});
}

TEST_F(BadInput, a_program_that_was_copied_alone_or_in_part_says_what_it_lacks_and_where) {
    std::filesystem::copy_file(HELIODON_PROGRAM, folder / "heliodon");
    const std::string command = "ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 " + in("heliodon") +
                                " detect " + kPhoto + " --rig " + kRig + " -o " + in("out.json") + " >" +
                                in("said") + " 2>&1";
    EXPECT_NE(std::system(command.c_str()), 0);
    EXPECT_NE(readText(in("said")).find("is missing: expected beside the program in " + folder.string()),
              std::string::npos)
        << readText(in("said"));
    const std::string module = "heliodon_pictures.so";
    std::filesystem::copy_file(std::filesystem::path(HELIODON_PROGRAM).parent_path() / module,
                               folder / module);
    std::filesystem::resize_file(folder / module, std::filesystem::file_size(folder / module) / 2);
    EXPECT_NE(std::system(command.c_str()), 0);
    EXPECT_NE(readText(in("said")).find(in(module) + ", which reads and writes pictures, is cut short"),
              std::string::npos)
        << readText(in("said"));
}

TEST_F(BadInput, a_file_that_is_not_a_picture) {
    writeText(in("text.png"), "not a picture");
    expectRefused("detect " + in("text.png") + " --rig " + kRig + " -o " + in("out.json"), {"text.png"});
}

TEST_F(BadInput, json_where_a_photograph_belongs) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json",
                      rest = " --rig " + kRig + " -o ";
    expectRefused("detect " + kRig + rest + in("out.json"), {"rig.json", "is vh-rig/1", "photograph"});
    expectRefused("detect " + sketch + rest + in("out.json"), {"p04_L.json", "is vh-sketch/1", "photograph"});
    writeText(in("list.json"), "[]");
    expectRefused("detect " + in("list.json") + rest + in("out.json"),
                  {"list.json", "is JSON", "photograph"});
}

TEST_F(BadInput, json_that_is_cut_off) {
    writeText(in("cut.json"), R"({"format": "vh-sketch/1", "walls": [)");
    expectRefused("model " + in("cut.json") + " -o " + in("out.obj"), {"cut.json:1:"});
    writeText(in("cut.json"), "{\n");
    expectRefused("model " + in("cut.json") + " -o " + in("out.obj"), {"cut.json:2:", "character 1 of"});
}

TEST_F(BadInput, a_folder_where_a_file_belongs) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json", here = folder.string();
    std::filesystem::create_directories(folder / "s.json");
    std::filesystem::create_directories(folder / "m.obj");
    const std::string moments =
        " --from 2026-06-21T10:00Z --to 2026-06-21T11:00Z --step PT1H -o " + in("out");
    std::filesystem::create_directories(folder / "p.png");
    for (const std::string& words :
         {"detect " + in("p.png") + " --rig " + kRig + " -o " + in("out.json"),
          "render " + here + " -o " + in("out"),
          "detect " + kPhoto + " --rig " + here + " -o " + in("out.json"),
          "model " + in("s.json") + " -o " + in("out.obj"), "model " + in("m.obj") + " -o " + in("out.obj"),
          "illuminance " + sketch + " --sensors " + here + " -o " + in("out.csv"),
          "illuminance " + sketch + " --sky " + in("s.json") + " -o " + in("out.csv"),
          "annual " + sketch + " --weather " + here + " -o " + in("out"),
          "timelapse " + sketch + " --weather " + here + moments})
        expectRefused(words, {"is a folder, expected"});
}

TEST_F(BadInput, outputs_that_would_hurt_what_is_there) {
    const std::string model = in("m.obj"), scan = "detect " + kPhoto + " --rig " + kRig + " -o ";
    writeText(model, "v 0 0 0\n");
    expectRefused("model " + model + " -o " + folder.string() + "/./m.obj", {"--output", "is read by INPUT"});
    expectRefused("model " + model + " -o " + in("out.obj") + " --report " + model, {"--report", "INPUT"});
    expectRefused(scan + in("out.json") + " --overlay " + in("out.json"), {"--overlay", "--output"});
    expectRefused(scan + in("out.json") + " --overlay " + in("out.jpg"), {"out.jpg", ".png"});
    expectRefused("model " + model + " -o " + in("out.obj") + " --report " + in("out.mtl"),
                  {"--report", "out.mtl", "--output"});
    EXPECT_EQ(readText(model), "v 0 0 0\n");
    const std::string rig = readText(kRig);
    writeText(in("rig.json"), rig);
    expectRefused("detect " + kPhoto + " --rig " + in("rig.json") + " -o " + in("rig.json"),
                  {"--output", "is read by --rig"});
    EXPECT_EQ(readText(in("rig.json")), rig);
    const std::string nowhere = in(std::string(300, 'x')); // longer than names may be
    expectRefused("model " + kPhoto + " --rig " + kRig + " -o " + nowhere + ".obj", {"xxx", "too long"});
    expectRefused("model " + kPhoto + " --rig " + kRig + " -o " + nowhere + "/a.obj --report " + nowhere +
                      "/b.json",
                  {"xxx", "too long"});
    // The film's name has room, its table's has not.
    expectRefused("timelapse " + kPhoto + " --rig " + kRig + " --view preview -o " +
                      in(std::string(246, 'x') + ".mp4") +
                      " --from 2026-06-21T12:00solar --to 2026-06-21T12:00solar --step PT1H",
                  {"xxx.frames.csv", "too long"});
}

TEST_F(BadInput, names_as_long_as_the_file_system_holds_are_written) {
    const std::string most(250, 'x');
    const Outcome outcome = heliodon("detect " + kPhoto + " --rig " + kRig + " -o " + in(most + ".json") +
                                     " --report " + in("y" + most.substr(1) + ".json"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        files += entry.path().filename().string().size() == 255;
    EXPECT_EQ(files, 2u);
    // What is written aside meanwhile, by several threads, has names of its own.
    EXPECT_NE(geometry::asideOf(in(most + "1.png")), geometry::asideOf(in(most + "2.png")));
}

TEST_F(BadInput, materials_that_a_model_reads_are_not_written_over) {
    const std::string materials = "newmtl m\nKd 0.5 0.5 0.5\n";
    writeText(in("b.mtl"), materials);
    writeText(in("a.obj"), "mtllib b.mtl\nusemtl m\nv 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\n"
                           "v 3 3 3\nv 0 3 3\nf 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\n"
                           "f 4 8 5 1\n");
    const std::string model = "model " + in("a.obj") + " --triangles 12 -o ";
    expectRefused(model + in("b.obj"), {"--output", "b.mtl", "is read by INPUT"});
    EXPECT_FALSE(std::filesystem::exists(folder / "b.obj"));
    std::filesystem::copy_file(in("a.obj"), in("A.OBJ"));
    expectRefused("model " + in("A.OBJ") + " --triangles 12 -o " + in("b.obj"),
                  {"b.mtl", "is read by INPUT"});
    expectRefused(model + in("out.obj") + " --report " + in("b.mtl"), {"--report", "b.mtl"});
    EXPECT_EQ(readText(in("b.mtl")), materials);
    const Outcome other = heliodon(model + in("c.obj") + " --report " + in("c.json"));
    EXPECT_EQ(other.exitCode, 0) << other.output;
}

TEST_F(BadInput, a_report_is_no_result_in_the_folder_that_is_written) {
    const std::string render = "render " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --triangles 60 "
                               "--sky overcast --size 16x16 -o ";
    std::filesystem::create_directory(folder / "r");
    for (const char* name : {"preview.png", "render.files.json"}) {
        writeText(folder / "r" / name, "before");
        for (const std::string& way : {in("r/"), in("r/../r/")})
            expectRefused(render + in("r") + " --report " + way + name, {"--report", name});
        EXPECT_EQ(readText(folder / "r" / name), "before");
        std::filesystem::remove(folder / "r" / name);
    }
    // As of films: of one picture a projector, by names of their own.
    const std::string hour = "--from 2026-03-21T12:00solar --to 2026-03-21T12:00solar --step PT1H -o ",
                      film = "timelapse " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --rig " + kRig +
                             " " + hour;
    for (const char* name : {"day-projector-2.mp4", "day.frames.csv"})
        expectRefused(film + in("day.mp4") + " --report " + in(name), {"--report", name, "result"});
    expectRefused(film + in("r") + " --report " + in("r/projector-3-00000.png"), {"--report", "result"});
    // Nor is what is read.
    std::filesystem::copy_file(HELIODON_TEST_DATA "/geometry/sketches/p04_L.json", in("r/frames.json"));
    expectRefused("timelapse " + in("r/frames.json") + " --view none " + hour + in("r"),
                  {"frames.json", "is read"});
    EXPECT_EQ(readText(in("r/frames.json")), readText(HELIODON_TEST_DATA "/geometry/sketches/p04_L.json"));
    // Through links either way.
    std::filesystem::create_symlink("preview.png", in("r/link.json"));
    expectRefused(render + in("r") + " --report " + in("r/link.json"), {"--report", "link.json"});
    const std::string still = "timelapse " + in("still.json") + " --view preview " + hour + in("r");
    std::filesystem::create_symlink("r/frames.json", in("still.json"));
    expectRefused(still, {"still.json", "is read"});
    std::filesystem::remove(in("still.json"));
    std::filesystem::rename(in("r/frames.json"), in("still.json"));
    std::filesystem::create_symlink("../still.json", in("r/00000.png"));
    expectRefused(still, {"still.json", "is read"});
    std::filesystem::remove(in("r/00000.png"));
    expectRefused(render + in("new") + " --report " + in("new/preview.png"), {"--report", "result"});
    EXPECT_FALSE(std::filesystem::exists(folder / "new"));
    const Outcome beside = heliodon(render + in("new.v2/") + " --report " + in("new.v2/report.json"));
    EXPECT_EQ(beside.exitCode, 0) << beside.output;
    EXPECT_TRUE(std::filesystem::exists(folder / "new.v2/report.json"));
}

// They would stand there as folders with such names.
TEST_F(BadInput, names_of_files_where_a_folder_is_written) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json";
    const std::string film =
        "timelapse " + sketch + " --from 2026-06-21T10:00Z --to 2026-06-21T11:00Z --step PT1H -o ";
    expectRefused("render " + sketch + " -o " + in("out.png"), {"out.png", "folder"});
    expectRefused(film + in("out.avi"), {"out.avi", ".mp4"});
    expectRefused(film + in("none/out.mp4"), {"none/out.mp4", "its folder does not exist"});
    expectRefused(film + in("out.MP4"), {"out.MP4", ".mp4"});
    for (const char* size :
         {"1920", "1920x", "x1080", "0x0", "-640x480", "640x480x2", "99999x10", "640.5x480"})
        expectRefused("render " + sketch + " -o " + in("out") + " --size=" + size,
                      {"--size", "WIDTHxHEIGHT"});
    // More than the software device takes in one piece: said before the form factors.
    if (heliodon("devices").output.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "no llvmpipe";
    expectRefused("render " + sketch + " -o " + in("out") + " --device llvmpipe --size 8192x8192",
                  {"--size", "8192x8192", "llvmpipe"});
}

TEST_F(BadInput, a_rig_that_says_nothing_of_its_table_is_not_passed_over) {
    std::string rig = readText(kRig);
    const size_t at = rig.find("\"table\": {");
    ASSERT_NE(at, std::string::npos);
    writeText(in("rig.json"), rig.replace(at, 7, "\"tuble\""));
    const Outcome outcome = heliodon("detect " + kPhoto + " --rig " + in("rig.json") + " -o " + in("s.json"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("assumed: a table 1.067 m across"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, a_wrong_field_in_a_sketch) {
    writeText(in("s.json"), R"({"format": "vh-sketch/1", "units": "inch", "walls": [
        {"id": "w1", "a": [0, 0], "b": [5, 0], "thickness": "thin", "height_class": "red"}]})");
    expectRefused("model " + in("s.json") + " -o " + in("out.obj"), {"s.json", "walls[0].thickness"});
}

// A room of 0.5 m or 300 mm on the table, given as such.
TEST_F(BadInput, a_sketch_in_other_units_is_told_its_span) {
    for (const auto& [size, span] : {std::pair("0.5", "0.5"), std::pair("300", "300")}) {
        const std::string h = std::string("-") + size;
        writeText(in("s.json"), R"({"format": "vh-sketch/1", "walls": [
            {"a": [)" + h + ", " + h +
                                    R"(], "b": [0, )" + h + R"(], "height_class": "red"}]})");
        expectRefused(
            "model " + in("s.json") + " -o " + in("out.obj"),
            {"s.json", std::string("sketch spans ") + span + ", expected inches on a table 42 inches"});
    }
}

TEST_F(BadInput, an_unknown_height_class) {
    writeText(in("s.json"), R"({"format": "vh-sketch/1", "units": "inch", "walls": [
        {"id": "w1", "a": [0, 0], "b": [5, 0], "thickness": 0.375, "height_class": "purple"}]})");
    expectRefused("model " + in("s.json") + " -o " + in("out.obj"),
                  {"s.json", "walls[0].height_class", "purple"});
}

TEST_F(BadInput, an_empty_table_is_refused_and_the_report_says_why) {
    writeText(in("empty.json"), R"({"format": "vh-sketch/1", "units": "inch", "walls": [], "arcs": []})");
    expectRefused("model " + in("empty.json") + " -o " + in("out.obj") + " --report " + in("report.json"),
                  {"empty.json", "NO_WALLS"});
    const std::string report = readText(folder / "report.json");
    EXPECT_NE(report.find("\"outcome\": \"refuse\""), std::string::npos) << report;
    EXPECT_NE(report.find("\"code\": \"NO_WALLS\""), std::string::npos) << report;
}

class BadModel : public BadInput {
protected:
    void writeModel(const std::string& lastFace, const std::string& reflectance) {
        writeText(in("m.mtl"), "newmtl grey\nKd " + reflectance + "\n");
        writeText(
            in("m.obj"),
            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl grey\nf 1 2 3\nf 1 4 2\nf 1 3 4\n" +
                lastFace + "\n");
    }
    std::string command() const { return "formfactors " + in("m.obj") + " -o " + in("out.npy"); }
};

TEST_F(BadModel, a_face_with_a_bad_index) {
    writeModel("f 2 4 9", "0.5 0.5 0.5");
    expectRefused(command(), {"m.obj:10", "9"});
}

TEST_F(BadModel, text_that_is_no_gltf) {
    for (const std::string name : {"room.gltf", "room.glb"}) {
        writeText(folder / name, "{\"asset\":\n oops}");
        expectRefused("formfactors " + in(name) + " --quiet -o " + in("F.npy"),
                      {name + ":2: is not JSON here (character 2 of the line)", "glTF"});
    }
}

TEST_F(BadModel, a_reflectance_that_is_not_a_number) {
    writeModel("f 2 4 3", "nan 0.5 0.5");
    expectRefused(command(), {"m.mtl:2"});
}

TEST_F(BadModel, a_reflectance_of_one) {
    writeModel("f 2 4 3", "1 1 1");
    expectRefused(command(), {"m.mtl:2"});
}

TEST_F(BadModel, a_folder_that_does_not_exist) {
    writeModel("f 2 4 3", "0.5 0.5 0.5");
    expectRefused("formfactors " + in("m.obj") + " -o " + in("none/F.npy"), {"none/F.npy", "folder"});
}

TEST_F(BadModel, an_unknown_kernel) {
    writeModel("f 2 4 3", "0.5 0.5 0.5");
    expectRefused(command() + " --kernel magic", {"magic", "hemicube"});
}

// Options that would do nothing.
TEST_F(BadModel, options_that_are_for_other_input_or_other_kernels) {
    writeModel("f 2 4 3", "0.5 0.5 0.5");
    expectRefused(command() + " --chord-error 0.1", {"--chord-error", "curved"});
    expectRefused("model " + in("m.obj") + " --chord-error 0.1 -o " + in("out.glb"),
                  {"--chord-error", "curved"});
    expectRefused("illuminance \"\" -o " + in("out.csv"), {"INPUT", "is empty"});
    expectRefused(command() + " --model-scale 1e300", {"--model-scale", "1e300", "from 1e-06 to 1000000"});
    const std::string report = " --report " + in("report.json");
    Outcome outcome = heliodon(command() + " --kernel exact --resolution 16 --points 2" + report);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("--resolution is not used"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("--points is not used"), std::string::npos) << outcome.output;
    outcome = heliodon(command() + " --kernel hemicube --resolution 16 --points 2" + report);
    EXPECT_EQ(outcome.output.find("not used"), std::string::npos) << outcome.output;
    outcome = heliodon("model " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --up z -o " + in("l.obj"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("--up is not used"), std::string::npos) << outcome.output;
}

TEST_F(BadModel, sensors_with_text_where_a_number_belongs) {
    writeModel("f 2 4 3", "0.5 0.5 0.5");
    writeText(in("s.csv"), "x,y,z,nx,ny,nz\n0.1,0.1,0.1,0,1,0\n0.1,zero,0.1,0,1,0\n");
    expectRefused("illuminance " + in("m.obj") + " --sensors " + in("s.csv") + " -o " + in("out.csv"),
                  {"s.csv:3", "zero"});
}

TEST_F(BadInput, an_unknown_command_and_a_missing_option) {
    for (const char* word : {"paint", "--paint"})
        expectRefused(word, {"command line", word, "is no command"});
    expectRefused("redner", {"redner", "is no command (render?)"});
    expectRefused("calibrate", {"calibrate", "steps: target, "});
    expectRefused("calibrate patern", {"patern", "is no step of calibrate (patterns?)"});
    expectRefused("detect " + kPhoto + " -o " + in("out.json"), {"--rig"});
    const std::string sketch = "render " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json -o ";
    expectRefused(sketch, {"--output", "its value is missing"});
    expectRefused("detect " + kPhoto + " --rig -o " + in("out.json"),
                  {"--rig: its value is missing before -o"});
    expectRefused("detect " + kPhoto + " --rig --output=" + in("out.json"),
                  {"--rig: its value is missing before --output"});
    expectRefused("illuminance " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json -o - --report -",
                  {"--report", "is written by --output too"});
    expectRefused(sketch + in("out") + " --rgi r.json", {"--rgi", "--help lists"});
    expectRefused("timelapse --frm 2026-06-21T10:00Z",
                  {"--frm (--from?)", "--help lists"}); // not what is missing beside it
    expectRefused(sketch + in("out") + " -o " + in("out"), {"--output", "more than once"});
    for (const char* unset : {" --sky ''", " --sky=", " --site ''"})
        expectRefused(sketch + in("out") + unset, {std::string(unset).substr(1, 5), "is empty"});
    expectRefused(sketch + in("out") + " --site 142,3", {"--site", "-90 to 90"});
    expectRefused(sketch + in("out") + " --triangles 20.5", {"--triangles", "'20.5' is no whole number"});
}

TEST_F(BadInput, help_of_every_command_fits_a_terminal) {
    for (const char* command : {"", "detect", "model", "formfactors", "illuminance", "render", "timelapse",
                                "annual", "live", "calibrate", "calibrate target", "calibrate camera",
                                "calibrate patterns", "calibrate projector", "bench", "devices"}) {
        const Outcome help = heliodon(std::string(command) + " --help");
        EXPECT_EQ(help.exitCode, 0) << command;
        EXPECT_NE(help.output.find("Usage: heliodon"), std::string::npos) << command;
        EXPECT_EQ(heliodon("help " + std::string(command)).output, help.output);
        std::istringstream lines(help.output);
        for (std::string line; std::getline(lines, line);)
            EXPECT_LE(line.size(), 96u) << command << ": " << line;
    }
}

TEST_F(BadInput, scenes_and_kernels_that_no_bench_knows) {
    expectRefused("bench --scenes castle -o " + in("out"), {"--scenes", "castle", "partitions"});
    expectRefused("bench --scenes " + in("none.obj") + " -o " + in("out"), {"none.obj", "does not exist"});
    expectRefused("bench --kernels guess -o " + in("out"), {"--kernels", "guess", "exact"});
    writeText(in("empty.obj"), "v 0 0 0\n");
    expectRefused("bench --scenes " + in("empty.obj") + " -o " + in("out"), {"empty.obj", "no faces"});
}

TEST_F(BadInput, numbers_that_are_none_and_devices_that_are_not_there) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json";
    expectRefused("illuminance " + sketch + " --north nan -o " + in("out.csv"), {"--north", "nan", "360"});
    expectRefused("illuminance " + sketch + " --north 1e99 -o " + in("out.csv"), {"--north", "1e99", "360"});
    expectRefused("illuminance " + sketch +
                      " --triangles 100 --time 2026-03-21T13:00solar --site 42,-73 --sky "
                      "clear --quiet --device none -o " +
                      in("out.csv"),
                  {"--device", "none"});
}

TEST_F(BadInput, devices_that_are_not_there_where_none_is_opened) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json";
    expectRefused("devices --device nosuch", {"--device:nosuch", "expected one of"});
    expectRefused("model " + sketch + " --device nosuch -o " + in("out.obj"), {"--device:nosuch"});
    EXPECT_EQ(heliodon("devices --device 0").exitCode, 0);
}

TEST_F(BadInput, results_under_names_of_other_kinds_of_files) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json";
    expectRefused("formfactors " + sketch + " -o " + in("out.csv"), {"--output", "out.csv", ".npy"});
    expectRefused("illuminance " + sketch + " -o " + in("out.txt"), {"--output", "out.txt", ".csv"});
    expectRefused("detect " + kPhoto + " --rig " + kRig + " -o " + in("out.txt"), {"--output", ".json"});
    expectRefused("render " + sketch + " -o -", {"--output", "folder"});
}

// What is behind it is not replaced: lines before stay, as `>>` has them.
TEST_F(BadInput, the_standard_output_is_written_to_where_it_stands) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json",
                      command = "ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 " +
                                std::string(HELIODON_PROGRAM) + " illuminance " + sketch +
                                " --triangles 60 --sky overcast --quiet -o ";
    ASSERT_EQ(std::system((command + in("lux.csv")).c_str()), 0);
    const std::string table = readText(folder / "lux.csv");
    for (const std::string name : {"-", "/dev/stdout", "/dev/fd/1"}) {
        writeText(in("here.txt"), "before\n");
        std::filesystem::create_hard_link(folder / "here.txt", folder / "same.txt");
        ASSERT_EQ(std::system((command + name + " >> " + in("here.txt")).c_str()), 0) << name;
        EXPECT_EQ(readText(folder / "here.txt"), "before\n" + table) << name;
        EXPECT_EQ(readText(folder / "same.txt"), "before\n" + table) << name; // the same file still
        std::filesystem::remove(folder / "same.txt");
    }
    expectRefused("illuminance " + sketch + " --triangles 60 --quiet -o /dev/fd/77",
                  {"/dev/fd/77", "not open for writing"});
}

// Of a program that nobody listens to the results are what they would be; a list that is lost is an error.
TEST_F(BadInput, what_cannot_be_said_ends_no_work_and_goes_into_no_file) {
    setenv("ASAN_OPTIONS", "detect_leaks=0:detect_odr_violation=0", 1);
    const auto code = [](const std::string& arguments) {
        const int status = std::system((std::string(HELIODON_PROGRAM) + " " + arguments).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    };
    const std::string command =
        "illuminance " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --triangles 60 -o ";
    ASSERT_EQ(code(command + in("lux.csv") + " --quiet"), 0);
    for (const std::string nowhere : {" 2> /dev/full", " 2>&-", " 0<&- 2>&-"}) {
        std::filesystem::remove(folder / "same.csv");
        EXPECT_EQ(code(command + in("same.csv") + nowhere), 0) << nowhere;
        EXPECT_EQ(readText(folder / "same.csv"), readText(folder / "lux.csv")) << nowhere;
        EXPECT_EQ(code("model no-such.json -o " + in("room.obj") + nowhere), 2) << nowhere;
    }
    for (const std::string list : {"devices", "--help", "render --help"})
        for (const std::string nowhere : {" > /dev/full 2>&1", " >&- 2> /dev/null"})
            EXPECT_EQ(code(list + nowhere), 1) << list << nowhere;
}

TEST_F(BadInput, windows_in_a_state_that_is_none) {
    const std::string command = "illuminance " HELIODON_TEST_DATA "/compute/office/model.obj --up z --sky " +
                                std::string("overcast --quiet --triangles 100 -o ") + in("out.csv") +
                                " --blinds ";
    expectRefused(command + "shut", {"--blinds", "shut", "fabric", "slats"});
    expectRefused(command + "slats:ninety", {"--blinds", "angle", "ninety"});
    expectRefused(command + "fabric:0.8,0.5", {"--blinds", "more than 1"});
    expectRefused(command + "slats:45,0.5,0.8,2", {"--blinds", "'2'"});
    expectRefused(command + "door=slats:45", {"--blinds", "door", "expected one of"});
}

TEST_F(BadInput, glass_of_no_transmittance) {
    const std::string command = "model " HELIODON_TEST_DATA
                                "/compute/office/model.obj --up z --triangles 100 "
                                "--quiet -o " +
                                in("out.obj") + " --glass ";
    for (const char* text :
         {"Glass", "=0.8", "glass=", "glass=0", "glass=1.5", "glass=0.5,0.5", "glass=0.5,"})
        expectRefused(command + text, {"--glass", text, "MATERIAL=T"});
    expectRefused(command + "nothing=0.8", {"model.obj:nothing:", "expected one of"});
    expectRefused("model " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --glass glazing=0.8 -o " +
                      in("out.obj"),
                  {"--glass", "models from files"});
}

TEST_F(BadInput, a_reflectance_of_a_sketch_or_of_one) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json";
    expectRefused("model " + sketch + " --reflectance 0.5 -o " + in("out.obj"),
                  {"--reflectance", "models from files"});
    expectRefused("model " + in("none.obj") + " --reflectance 1 -o " + in("out.obj"),
                  {"--reflectance", "from 0 to 0.99"});
}

// What keeps a room with a sheet from closing is often glass that was read as a wall.
TEST_F(BadInput, a_refusal_says_what_may_be_glass) {
    writeText(in("m.mtl"), "newmtl wall\nKd 0.5\nnewmtl Window\nKd 0.5\nd 0.3\n");
    writeText(in("m.obj"), "mtllib m.mtl\nv 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\n"
                           "usemtl wall\nf 1 2 3 4\nusemtl Window\nf 1 2 6 5\n");
    expectRefused("model " + in("m.obj") + " -o " + in("out.obj"), {"m.obj:", "--glass", "Window=0.8"});
}

// A sheet that ends 1 mm below the ceiling was to reach it, or to be none.
TEST_F(BadInput, one_object_that_keeps_a_room_from_closing) {
    writeText(in("m.obj"), "v 0 0 0\nv 4 0 0\nv 4 0 5\nv 0 0 5\nv 0 3 0\nv 4 3 0\nv 4 3 5\nv 0 3 5\no Room\n"
                           "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
                           "v 1 1 2\nv 2 1 2\nv 2 2.999 2\nv 1 2.999 2\no Old banner\nf 9 10 11 12\n");
    const std::string command = "model " + in("m.obj") + " -o " + in("out.obj");
    expectRefused(command, {"m.obj:21 (object \"Old banner\")", "--leave-out='Old banner' does without"});
    // For a shell, whatever is in it.
    const std::string text = readText(in("m.obj")), name = "Old banner";
    writeText(in("m.obj"), std::string(text).replace(text.find(name), name.size(), "it's $HOME `id`"));
    expectRefused(command, {R"(--leave-out='it'\''s $HOME `id`' does without)"});
    EXPECT_EQ(
        heliodon("model " + in("m.obj") + " -o " + in("made.obj") + R"( --leave-out='it'\''s $HOME `id`')")
            .exitCode,
        0);
    // No thing in the room, but the room.
    writeText(in("m.obj"), std::string(text).replace(text.find("f 5 6 7 8\n"), 10, ""));
    const auto open = heliodon(command);
    EXPECT_EQ(open.exitCode, 2);
    EXPECT_EQ(open.output.find("--leave-out"), std::string::npos) << open.output;
    writeText(in("m.obj"), text);
    expectRefused(command + " --leave-out Banner", {"Banner", "expected one of Room, Old banner"});
    expectRefused("model " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --leave-out w1 -o " +
                      in("out.glb"),
                  {"--leave-out", "models from files"});
    EXPECT_EQ(heliodon(command + " --leave-out 'Old banner' --report " + in("report.json")).exitCode, 0);
    EXPECT_NE(readText(in("report.json")).find("1 face of \\\"Old banner\\\" left out"), std::string::npos);
}

TEST_F(BadInput, what_was_assumed_is_not_said_before_what_is_wrong) {
    const std::string sketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --triangles 100 ";
    expectRefused("illuminance " + sketch + "--sky cie:99 -o " + in("out.csv"), {"--sky", "cie:99"});
    expectRefused("timelapse " + sketch +
                      "--from 2026-03-21T10:00solar --to 2026-03-21T11:00solar --step PT1H --view "
                      "projectors -o " +
                      in("out"),
                  {"--view"});
    expectRefused("illuminance " + sketch + "--device none -o " + in("out.csv"), {"--device", "none"});
}

TEST_F(BadInput, a_time_that_is_no_time) {
    expectRefused("render " + kPhoto + " --rig " + kRig + " --time tomorrow -o " + in("out"), {"tomorrow"});
}

TEST_F(BadInput, days_and_hours_of_a_contact_sheet_that_are_none) {
    const std::string command =
        "render " + kPhoto + " --rig " + kRig + " --contact-sheet -o " + in("out/deep");
    expectRefused(command + " --days 06-21,02-30", {"--days", "02-30"});
    expectRefused(command + " --days 02-29 --time 2026-03-21T13:00solar", {"--days", "02-29"});
    expectRefused(command + " --hours 9,25", {"--hours", "25"});
    expectRefused(command + " --hours 9,", {"--hours"});
}

} // namespace
} // namespace heliodon::test
