#include "engine/app/projector_displays.h"

#include <gtest/gtest.h>

#include "geometry/input_error.h"

namespace heliodon::test {
namespace {

using present::Display;

geometry::Rig twoProjectors() {
    geometry::Rig rig;
    rig.projectors.resize(2);
    for (size_t i = 0; i < 2; ++i) {
        rig.projectors[i].id = "P" + std::to_string(i);
        rig.projectors[i].width = 1024, rig.projectors[i].height = 768;
    }
    return rig;
}

TEST(ProjectorDisplays, have_said_what_spoils_a_picture_once) {
    const geometry::Rig rig = twoProjectors();
    const Display left{"A", 0, 0, 1024, 768}, right{"B", 1024, 0, 1024, 768},
        operators{"", 2048, 0, 800, 600};
    std::vector<std::optional<Display>> covered{left, right, operators};
    for (size_t i = 0; i < 2; ++i) EXPECT_EQ(app::displayNotice(rig, i, covered), "");
    covered[2]->x = 2047; // a pixel of B
    EXPECT_EQ(app::displayNotice(rig, 0, covered), "");
    EXPECT_NE(app::displayNotice(rig, 1, covered).find("operator's window lies on display 'B'"),
              std::string::npos);
    covered[2].reset();
    covered[1] = Display{"B", 0, 0, 1024, 768}; // mirrored
    EXPECT_EQ(app::displayNotice(rig, 0, covered), "");
    EXPECT_NE(app::displayNotice(rig, 1, covered).find("'B' and 'A' show the same"), std::string::npos);
    covered[1] = Display{"B", 1024, 0, 768, 1024}; // turned
    EXPECT_NE(app::displayNotice(rig, 1, covered).find("768 x 1024"), std::string::npos);
    covered[1]->name = ""; // a window, which its user may make as large as they like
    EXPECT_EQ(app::displayNotice(rig, 1, covered), "");
    covered[1].reset(); // hidden
    EXPECT_EQ(app::displayNotice(rig, 1, covered), "");
}

TEST(ProjectorDisplays, are_those_of_the_command_line) {
    geometry::Rig rig = twoProjectors();
    rig.projectors[0].display = "A";
    app::assignDisplays(rig, {"P1=DP-1.2", "P1=B=C"});
    EXPECT_EQ(rig.projectors[0].display, "A");
    EXPECT_EQ(rig.projectors[1].display, "B=C");
    for (const char* wrong : {"P2=A", "P1=", "P1", "=A", ""})
        EXPECT_THROW(app::assignDisplays(rig, {wrong}), geometry::InputError) << wrong;
}

} // namespace
} // namespace heliodon::test
