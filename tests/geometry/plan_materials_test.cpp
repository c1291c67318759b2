// Which tokens colour what, and which colour nothing.
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::wall;

namespace {

// Two rooms side by side, with a free wall in the left one and a garden wall.
Sketch twoRooms() {
    Sketch s;
    s.walls = {wall("s", {-10, -6}, {10, -6}),     wall("e", {10, -6}, {10, 6}),
               wall("n", {10, 6}, {-10, 6}),       wall("w", {-10, 6}, {-10, -6}),
               wall("mid", {0, -6}, {0, 6}),       wall("free", {-7, 0}, {-3, 0}),
               wall("garden", {-8, -12}, {8, -12})};
    return s;
}

Token token(const std::string& id, TokenKind kind, glm::dvec2 pos, double red) {
    Token t;
    t.id = id;
    t.kind = kind;
    t.pos = pos;
    t.rgb = {red, 100, 100};
    return t;
}

ClosureReport reportWith(const std::vector<Token>& tokens) {
    Sketch s = twoRooms();
    s.tokens = tokens;
    return closeSketch(s).report;
}

} // namespace

TEST(PlanMaterials, a_token_that_colours_nothing_is_named) {
    const auto names = [](const ClosureReport& report, const std::string& sentence) {
        return report.code == "TOKEN_UNUSED" && report.outcome == Outcome::warn &&
               report.message.find("token " + sentence) != std::string::npos;
    };
    for (const auto& [kind, what] :
         {std::pair(TokenKind::floor, "floor"), std::pair(TokenKind::wallAll, "walls")}) {
        const Token left = token("left", kind, {-5, 3}, 10), right = token("right", kind, {5, 3}, 20);
        EXPECT_EQ(reportWith({left}).code, "OK");
        EXPECT_EQ(reportWith({left, right}).code, "OK");
        const ClosureReport report = reportWith({left, right, token("yard", kind, {5, -9}, 30)});
        EXPECT_TRUE(names(report, std::string("yard colours nothing: every room has the colour of its ") +
                                      what + " from another one"))
            << report.message;
        EXPECT_EQ(reportWith({left, right, token("yard", kind, {5, -9}, 20)}).code, "OK"); // the same colour
    }
    const Token one = token("one", TokenKind::wallSingle, {4, -5}, 10);
    const Token two = token("two", TokenKind::wallSingle, {-4, -5.1}, 20);
    EXPECT_EQ(reportWith({one}).code, "OK");
    const ClosureReport both = reportWith({one, two});
    EXPECT_TRUE(names(both, "two colours nothing: the wall s has the colour of one")) << both.message;
    const ClosureReport outside = reportWith({token("out", TokenKind::wallSingle, {0, -11}, 10)});
    EXPECT_TRUE(names(outside, "out colours nothing: the nearest wall, garden, is in no room"))
        << outside.message;
}

TEST(PlanMaterials, a_painted_free_wall_has_painted_ends) {
    Sketch s = twoRooms();
    s.tokens = {token("t", TokenKind::wallSingle, {-5, 0.5}, 10)};
    const Closure closure = closeSketch(s);
    ASSERT_TRUE(closure.building);
    int painted = 0;
    for (const Face& face : closure.building->faces)
        painted += closure.building->materials[face.material].name == "painted wall";
    EXPECT_EQ(painted, 4); // two sides, two ends
}
