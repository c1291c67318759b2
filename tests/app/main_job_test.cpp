// The main job as a user does it: photograph in, pictures and a film out.
#include <regex>

#include <nlohmann/json.hpp>

#include "geometry/picture_file.h"
#include "tests/app/program.h"
#include "vision/photograph.h"

namespace heliodon::test {
namespace {

const std::string kRig = HELIODON_SOURCE "/examples/rig.json";
const std::string kPhoto = HELIODON_SOURCE "/examples/i01_mixed.png";

class MainJob : public InFolder {
protected:
    void run(const std::string& arguments) {
        const Outcome outcome = heliodon(arguments);
        ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    }
    nlohmann::json report(const std::string& name) const {
        return nlohmann::json::parse(readText(folder / name));
    }

    // Not EXPECT_EQ: it would print both files.
    bool sameBytes(const std::string& a, const std::string& b) const {
        return readText(folder / a) == readText(folder / b);
    }

    // Mean over pixels of the largest channel, and the share of pixels that are exactly black.
    struct Look {
        double mean = 0, black = 0;
    };
    Look look(const std::string& name, int width, int height) const {
        const vision::Photograph picture = vision::readPhotograph(folder / name);
        EXPECT_EQ(picture.width, width);
        EXPECT_EQ(picture.height, height);
        Look result;
        const double count = static_cast<double>(picture.rgb.size()) / 3;
        for (size_t i = 0; i < picture.rgb.size(); i += 3) {
            const int most = std::max({picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]});
            result.mean += most / count;
            result.black += (most == 0 ? 1 : 0) / count;
        }
        return result;
    }
};

TEST_F(MainJob, a_photograph_becomes_a_sketch_that_gives_the_same_model) {
    for (const char* name : {"a", "b"}) std::filesystem::create_directory(folder / name);
    run("detect " + kPhoto + " --rig " + kRig + " -o " + in("sketch.json") + " --overlay " + in("found.png"));
    run("model " + in("sketch.json") + " -o " + in("a/model.obj") + " --report " + in("a.json"));
    run("model " + kPhoto + " --rig " + kRig + " -o " + in("b/model.obj") + " --report " + in("b.json"));
    EXPECT_TRUE(sameBytes("a/model.obj", "b/model.obj"));
    const nlohmann::json a = report("a.json");
    EXPECT_EQ(a["outcome"], "ok");
    EXPECT_EQ(a["n_rooms"], 1);
    EXPECT_EQ(a["rooms"][0]["closed"], true);
    EXPECT_EQ(a["rooms"][0]["self_intersecting"], false);
    EXPECT_NEAR(a["triangles"].get<double>(), 2000, 200);
    for (const char* field : {"version", "stages", "modelled", "skipped", "warnings", "seconds"})
        EXPECT_TRUE(a.contains(field));
}

TEST_F(MainJob, a_model_is_reported_as_closed_rooms) {
    run("model " HELIODON_TEST_DATA
        "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj --up z -o " +
        in("m.glb") + " --report " + in("m.json"));
    const nlohmann::json m = report("m.json");
    EXPECT_EQ(m["outcome"], "ok");
    EXPECT_TRUE(m["walls"].is_array());
    ASSERT_EQ(m["n_rooms"], 1);
    EXPECT_NEAR(m["rooms"][0]["volume"].get<double>(), 4000 - 2, 0.01); // 400 ft2 x 10 ft less the partition
}

TEST_F(MainJob, a_model_is_taken_at_the_scale_that_is_given_or_assumed) {
    const std::string model =
        "model " HELIODON_TEST_DATA
        "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj --up z -o " +
        in("m.glb") + " --report " + in("r.json");
    run(model);
    const double area = report("r.json")["rooms"][0]["floor_area"];
    EXPECT_EQ(report("r.json")["assumed"], "model as large as its building");
    EXPECT_EQ(report("r.json").value("warnings", nlohmann::json::array()).dump().find("is it --up"),
              std::string::npos);
    run(model + " --model-scale 12");
    EXPECT_FALSE(report("r.json").contains("assumed"));
    EXPECT_NEAR(report("r.json")["rooms"][0]["floor_area"].get<double>(), 144 * area, 1e-6 * area);

    // Lumens are the building's, too.
    const auto lumensAt = [&](const std::string& scale) {
        run("illuminance " HELIODON_TEST_DATA
            "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj --up z --triangles 50 " +
            scale + " --sky overcast -o " + in("lux.csv") + " --report " + in("r.json"));
        return report("r.json")["radiosity"]["lumens_in"].get<double>();
    };
    const double asItIs = lumensAt("--model-scale 1");
    EXPECT_NEAR(lumensAt("--model-scale 12"), 144 * asItIs, 1e-6 * asItIs);
}

TEST_F(MainJob, fences_of_a_model_in_centimetres_are_no_walls) {
    std::ofstream(in("garden.obj"))
        << "v 0 0 0\nv 400 0 0\nv 400 300 0\nv 0 300 0\nv 0 0 500\nv 400 0 500\nv 400 300 500\nv 0 300 500\n"
        << "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n"
        << "v -900 0 -900\nv 1400 0 -900\nv 1400 0 1400\nv -900 0 1400\n"
        << "v -900 180 -900\nv 1400 180 -900\nv 1400 180 1400\nv -900 180 1400\n"
        << "f 9 12 11 10\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
    run("model " + in("garden.obj") + " --model-scale 0.01 -o " + in("m.obj") + " --report " + in("r.json"));
    EXPECT_EQ(report("r.json")["n_rooms"], 1);
}

TEST_F(MainJob, a_sketch_without_an_arrow_is_said_to_have_its_north_assumed) {
    const auto assumedWith = [&](const std::string& options) {
        run("illuminance " HELIODON_TEST_DATA "/geometry/sketches/garden_l.json --triangles 100 -o " +
            in("lux.csv") + " --report " + in("r.json") + options);
        return report("r.json").value("assumed", "");
    };
    EXPECT_NE(assumedWith("").find("north along y of the plan"), std::string::npos);
    EXPECT_EQ(assumedWith(" --north 30").find("north"), std::string::npos);
    // So is one that is read from a photograph.
    const int width = 1392, height = 1032;
    std::vector<uint8_t> table(static_cast<size_t>(3 * width) * height, 180);
    table[0] = 200;
    geometry::writePngFile(in("bare.png"), width, height, table.data());
    run("detect " + in("bare.png") + " --rig " HELIODON_SOURCE "/examples/rig.json -o " + in("s.json") +
        " --report " + in("r.json"));
    EXPECT_NE(report("r.json").value("assumed", "").find("north along y of the plan"), std::string::npos);
}

TEST_F(MainJob, a_model_on_its_side_or_in_other_units_is_said_to_seem_so) {
    const char* const box = "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
    const auto saidOf = [&](const char* corners, const char* faces = nullptr) {
        std::ofstream(in("box.obj")) << corners << (faces ? faces : box);
        run("model " + in("box.obj") + " --triangles 100 -o " + in("m.obj") + " --report " + in("r.json"));
        return report("r.json")["assumed"].get<std::string>() + report("r.json")["warnings"].dump();
    };
    const std::string lying =
        saidOf("v 0 0 0\nv 8 0 0\nv 8 6 0\nv 0 6 0\nv 0 0 3\nv 8 0 3\nv 8 6 3\nv 0 6 3\n");
    EXPECT_NE(lying.find("is it --up z?"), std::string::npos) << lying;
    // Of two storeys a floor by name says that they stand.
    std::ofstream(in("box.mtl")) << "newmtl Floor\nKd .3 .3 .3\nnewmtl wall\nKd .5 .5 .5\n";
    const std::string standing =
        saidOf("mtllib box.mtl\nv 0 0 0\nv 8 0 0\nv 8 6 0\nv 0 6 0\nv 0 0 3\nv 8 0 3\nv 8 6 3\nv 0 6 3\n"
               "usemtl Floor\nf 1 5 6 2\nusemtl wall\n",
               "f 1 2 3 4\nf 8 7 6 5\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
    EXPECT_EQ(standing.find("is it --up"), std::string::npos) << standing;
    const std::string feet =
        saidOf("v 0 0 0\nv 16 0 0\nv 16 9 0\nv 0 9 0\nv 0 0 14\nv 16 0 14\nv 16 9 14\nv 0 9 14\n");
    EXPECT_NE(feet.find("in feet give --model-scale 0.3048"), std::string::npos) << feet;
    EXPECT_EQ(feet.find("is it --up"), std::string::npos) << feet;
    const std::string hall =
        saidOf("v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 4.5\nv 20 0 4.5\nv 20 20 4.5\nv 0 20 4.5\n");
    EXPECT_NE(hall.find("is it --up z?"), std::string::npos) << hall;
    EXPECT_EQ(hall.find("inches"), std::string::npos) << hall;
}

// And a fifth, black one, which stands below the table and looks away, both in warnings.
TEST_F(MainJob, render_writes_four_projector_pictures_and_a_preview) {
    nlohmann::json rig = nlohmann::json::parse(readText(kRig));
    rig["projectors"].push_back(rig["projectors"][0]);
    rig["projectors"][4]["id"] = "away";
    rig["projectors"][4]["t"] = {0, 0, -3};
    writeText(in("rig.json"), rig.dump());
    run("render " + kPhoto + " --rig " + in("rig.json") +
        " --triangles 600 --time 2026-03-21T13:00solar --false-color -o " + in("out") + " --report " +
        in("report.json"));
    for (int p = 0; p < 4; ++p) {
        const Look projector = look("out/projector-" + std::to_string(p) + ".png", 1024, 768);
        EXPECT_GT(projector.mean, 5);    // something is shown,
        EXPECT_GT(projector.black, 0.2); // and outside the model there is nothing
    }
    const vision::Photograph preview = vision::readPhotograph(folder / "out/preview.png");
    EXPECT_GT(preview.width, 600);
    const nlohmann::json r = report("report.json");
    for (const char* stage : {"detect", "model", "formfactors", "solve", "render"})
        EXPECT_TRUE(r["stages"].contains(stage)) << stage;
    EXPECT_TRUE(r["device"].contains("name"));
    EXPECT_EQ(look("out/projector-4.png", 1024, 768).mean, 0);
    ASSERT_EQ(r["warnings"].size(), 2u) << r["warnings"];
    EXPECT_NE(
        r["warnings"][0].get<std::string>().find("projectors[4] stands 1.51 m below the top of the table"),
        std::string::npos);
    EXPECT_NE(r["warnings"][1].get<std::string>().find("'away' reaches no wall"), std::string::npos);
}

TEST_F(MainJob, the_same_command_gives_the_same_bits) {
    for (const char* name : {"one", "two"})
        run("render " + kPhoto + " --rig " + kRig + " --triangles 400 --compensate-scatter -o " + in(name) +
            " --report " + in("r.json"));
    const nlohmann::json scatter = report("r.json")["scatter"];
    EXPECT_LT(scatter["error"].get<double>(), 0.5 * scatter["error_before"].get<double>());
    for (const char* picture : {"projector-0.png", "projector-3.png", "preview.png"})
        EXPECT_TRUE(sameBytes(std::string("one/") + picture, std::string("two/") + picture)) << picture;
}

TEST_F(MainJob, a_timelapse_is_a_film_or_numbered_pictures) {
    const std::string day =
        " --triangles 300 --from 2026-06-21T11:00solar --to 2026-06-21T12:00solar --step PT30M ";
    run("timelapse " + kPhoto + " --rig " + kRig + day + "--view preview -o " + in("day.mp4"));
    EXPECT_GT(std::filesystem::file_size(folder / "day.mp4"), 1000u);
    run("timelapse " + kPhoto + " --rig " + kRig + day + "--view preview -o " + in("frames"));
    EXPECT_TRUE(std::filesystem::exists(folder / "frames/00002.png"));
    EXPECT_FALSE(std::filesystem::exists(folder / "frames/00003.png"));
    const std::string table = readText(folder / "frames/frames.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4) << table;
}

// Scripts rely on the fields: what no page names, no one can.
TEST(Report, every_field_is_documented) {
    const std::string page = readText(HELIODON_SOURCE "/docs/files.md");
    const std::regex field(R"re(report\(\)\["(\w+)"\])re");
    size_t fields = 0;
    for (const auto& entry : std::filesystem::directory_iterator(HELIODON_SOURCE "/engine/app")) {
        const std::string source = readText(entry.path());
        for (std::sregex_iterator at(source.begin(), source.end(), field), end; at != end; ++at, ++fields)
            EXPECT_NE(page.find("`" + at->str(1) + "`"), page.npos) << at->str(1) << " in " << entry.path();
    }
    EXPECT_GT(fields, 20u);
}

} // namespace
} // namespace heliodon::test
