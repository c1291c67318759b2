// `heliodon model --plan`: what was understood of a sketch, or why it was refused, as a picture.
#include "tests/app/program.h"
#include "tests/geometry/box_model.h"

namespace heliodon::test {
namespace {

class RoomPlan : public InFolder {
protected:
    Outcome model(const std::string& sketch) {
        return heliodon("model " + sketch + " --triangles 300 --quiet --plan " + in("plan.svg") + " -o " +
                        in("room.obj"));
    }
    std::string plan() const { return readText(folder / "plan.svg"); }
    bool shows(const std::string& words) const { return plan().find(words) != std::string::npos; }
};

std::string publicSketch(const std::string& name) {
    return std::string(HELIODON_TEST_DATA) + "/geometry/sketches/" + name + ".json";
}

TEST_F(RoomPlan, names_rooms_walls_and_openings) {
    ASSERT_EQ(model(publicSketch("p05_T_two_rooms")).exitCode, 0);
    for (const char* words : {">room 0<", ">room 1<", ">w1<", ">opening<", "w1: exterior", "w5: interior"})
        EXPECT_TRUE(shows(words)) << words;
    EXPECT_FALSE(shows("bounds no room"));
}

TEST_F(RoomPlan, shows_where_gaps_were_filled) {
    ASSERT_EQ(model(publicSketch("p02_rect_gaps")).exitCode, 0);
    EXPECT_TRUE(shows("filled gap"));
    ASSERT_EQ(model(publicSketch("p01_rect_tight")).exitCode, 0);
    EXPECT_FALSE(shows("filled gap"));
}

// What the program wrote is read again as a model, which has no walls by name.
TEST_F(RoomPlan, shows_rooms_of_models) {
    ASSERT_EQ(model(publicSketch("p08_cubicle")).exitCode, 0);
    const Outcome again =
        heliodon("model " + in("room.obj") + " --quiet --plan " + in("plan.svg") + " -o " + in("again.obj"));
    ASSERT_EQ(again.exitCode, 0) << again.output;
    EXPECT_TRUE(shows(">room 0<"));
    EXPECT_FALSE(shows(">w1<"));
}

TEST_F(RoomPlan, shows_galleries_beside_what_is_below_them) {
    BoxModel room(5);
    room.add({0, 2.5, 0}, {3, 2.8, 3});
    room.addStairs(0, 2.8, 0.5, 3.1);
    writeText(folder / "hall.obj", room.text());
    const Outcome made =
        heliodon("model " + in("hall.obj") + " --quiet --plan " + in("plan.svg") + " -o " + in("again.obj"));
    ASSERT_EQ(made.exitCode, 0) << made.output;
    EXPECT_TRUE(shows("floors from 0.00 m"));
    EXPECT_TRUE(shows("floors from 2.80 m"));
}

TEST_F(RoomPlan, shows_what_is_refused) {
    writeText(folder / "open.json", R"({"format": "vh-sketch/1", "units": "inch", "walls": [
        {"id": "north & co", "a": [0, 0], "b": [9, 0], "height_class": "red"},
        {"id": "far", "a": [0, 15], "b": [9, 15], "height_class": "blue"}]})");
    const Outcome refused = model(in("open.json"));
    EXPECT_EQ(refused.exitCode, 2) << refused.output;
    EXPECT_TRUE(shows("NOT_ENCLOSED"));
    EXPECT_TRUE(shows(">north &amp; co<"));
    EXPECT_TRUE(shows(">bounds no room<"));
    EXPECT_FALSE(std::filesystem::exists(folder / "room.obj"));
}

// A room of 5 by 4 m without its wall at z = 4: faces, the hole's edges in red, a circle round it.
TEST_F(RoomPlan, shows_where_a_model_is_refused) {
    const std::string corners = "v 0 0 0\nv 5 0 0\nv 5 0 4\nv 0 0 4\nv 0 3 0\nv 5 3 0\nv 5 3 4\nv 0 3 4\n",
                      faces = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 4 1 5 8\n";
    writeText(folder / "open.obj", "mtllib open.mtl\n" + corners + "usemtl wall\n" + faces);
    writeText(folder / "open.mtl", "newmtl wall\nKd 0.5 0.5 0.5\n");
    const std::string command =
        "model " + in("open.obj") + " --plan " + in("plan.svg") + " -o " + in("room.obj");
    const Outcome refused = heliodon(command);
    EXPECT_EQ(refused.exitCode, 2) << refused.output;
    EXPECT_NE(refused.output.find("plan.svg"), std::string::npos) << refused.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "room.obj"));
    EXPECT_TRUE(shows("close the hole"));
    EXPECT_TRUE(shows(">1 m<") || shows(">2 m<"));
    // The plan is 720 pixels wide: the hole is a line of all that width, and needs no circle.
    const std::string svg = plan();
    EXPECT_NE(svg.find("M40.00 638.00L760.00 638.00\" fill=\"none\" stroke=\"#d61e1e\" stroke-width=\"3\""),
              std::string::npos);
    EXPECT_EQ(svg.find("M768.00 638.00L"), std::string::npos);

    // Of a corridor half a metre wide, without its end.
    std::string narrow = corners;
    for (size_t at = 0; (at = narrow.find(" 4\n", at)) != std::string::npos;) narrow.replace(at, 3, " .5\n");
    writeText(folder / "open.obj",
              "mtllib open.mtl\n" + narrow +
                  "usemtl wall\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n");
    EXPECT_EQ(heliodon(command).exitCode, 2);
    EXPECT_NE(plan().find("M84.00 98.00L"), std::string::npos) << plan();

    std::filesystem::remove(folder / "plan.svg");
    writeText(folder / "open.obj", "mtllib open.mtl\n" + corners + "usemtl wall\n" + faces + "f 1 2 99\n");
    EXPECT_EQ(heliodon(command).exitCode, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "plan.svg")) << "of a file that is broken";
}

TEST_F(RoomPlan, is_refused_by_its_ending_before_anything_is_written) {
    const Outcome refused =
        heliodon("model " + publicSketch("p04_L") + " --plan " + in("plan.pdf") + " -o " + in("room.obj"));
    EXPECT_EQ(refused.exitCode, 2);
    EXPECT_NE(refused.output.find("plan.pdf"), std::string::npos) << refused.output;
    EXPECT_TRUE(std::filesystem::is_empty(folder));
}

} // namespace
} // namespace heliodon::test
