// Panes one behind the other are one window of the room before them.
#include "geometry/double_glazing.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "geometry/room_measures.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

constexpr double kGap = 0.012;

// What joins the window of Drawing::room() with panes `depth` apart before it, and these. The last leans
// out by `lean` at its head.
void panesBefore(Drawing& drawing, std::vector<double> depths, double left = 0, double sill = 0.8,
                 double lean = 0) {
    const std::array<dvec3, 4> pane{dvec3(left + 1, sill, 0), dvec3(left + 3, sill, 0), dvec3(left + 3, 2, 0),
                                    dvec3(left + 1, 2, 0)};
    double from = 0;
    for (const double to : depths) {
        const double leans = to == depths.back() ? lean : 0;
        const auto at = [&](size_t k, double depth) { return pane[k % 4] - dvec3(0, 0, depth); };
        const auto outerAt = [&](size_t k) { return at(k, k % 4 < 2 ? to : to + leans); };
        std::vector<dvec3> outer;
        for (size_t k = 0; k < 4; ++k) {
            drawing.face("wall", {at(k, from), at(k + 1, from), outerAt(k + 1), outerAt(k)});
            outer.push_back(outerAt(k));
        }
        drawing.face("glass", outer);
        from = to;
    }
}

const Material& glassOf(const Building& building) {
    const auto pane = std::ranges::find_if(
        building.faces, [&](const Face& face) { return building.materials[face.material].isOpening(); });
    return building.materials[pane->material];
}

bool isRepaired(const Building& building, const std::string& how) {
    return std::ranges::any_of(building.repairs,
                               [&](const std::string& repair) { return repair.starts_with(how); });
}

} // namespace

TEST(DoubleGlazing, is_one_window_of_the_product) {
    for (const bool triangles : {false, true}) {
        Drawing drawing(false);
        drawing.triangles = triangles;
        drawing.room(0, -1, true);
        panesBefore(drawing, {kGap});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_EQ(countPanes(meshBuilding(building, {300})).windows, 1);
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
        EXPECT_NEAR(glassOf(building).transmittance.x, 0.64, 1e-6);
        EXPECT_EQ(glassOf(building).name, "glass"); // as no other pane is of it: for --blinds
        EXPECT_EQ(building.materials.size(), 3u);
        EXPECT_TRUE(isRepaired(building, "1 space between panes (up to 0.012 m deep) is no room"));
        // The frame between the panes is a reveal.
        ASSERT_EQ(building.outside.triangles.size(), 24u);
        EXPECT_EQ(building.outside.material.size(), 8u);
        double farthest = 0;
        for (const dvec3& p : building.outside.vertices) farthest = std::min(farthest, p.z);
        EXPECT_NEAR(farthest, -kGap, 1e-9);
    }
}

// Coordinates to the millimetre turn panes; of low ones the frame is as large as the glass.
TEST(DoubleGlazing, may_lean_a_little_and_be_as_deep_as_high) {
    for (const auto& [depth, sill, lean] : {std::tuple(0.09, 1.85, 0.0), {0.012, 0.8, 0.002}}) {
        Drawing drawing(false);
        drawing.room(0, -1, true, 0, 0, sill);
        panesBefore(drawing, {depth}, 0, sill, lean);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u) << depth;
        EXPECT_NEAR(glassOf(building).transmittance.x, 0.64, 1e-6);
    }
    Drawing drawing(false);
    drawing.room(0, -1, true);
    panesBefore(drawing, {0.05}, 0, 0.8, 0.2); // at the head deeper than a frame
    EXPECT_EQ(drawing.read().roomCount, 2u);
}

// As in a rebate, or an outer pane that runs past floors.
TEST(DoubleGlazing, may_be_of_panes_that_differ_in_size) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    const double low = 0.65, high = 2.15; // of the outer pane
    const double z = -0.08;
    for (const double y : {low, high}) drawing.face("wall", {{1, y, 0}, {3, y, 0}, {3, y, z}, {1, y, z}});
    for (const double x : {1.0, 3.0})
        drawing.face("wall", {{x, low, 0}, {x, low, z}, {x, high, z}, {x, high, 0}});
    drawing.face("glass", {{1, low, z}, {3, low, z}, {3, high, z}, {1, high, z}});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
    EXPECT_NEAR(glassOf(building).transmittance.x, 0.64, 1e-6);
    EXPECT_EQ(countPanes(meshBuilding(building, {300})).windows, 1);
}

TEST(DoubleGlazing, of_three_panes_is_one_window_and_single_panes_keep_their_glass) {
    Drawing drawing(false);
    drawing.room(0, -1, true), drawing.room(6, -1, true);
    panesBefore(drawing, {kGap, 2 * kGap});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_TRUE(isRepaired(building, "2 spaces between panes"));
    std::vector<std::pair<std::string, double>> glasses;
    for (const Face& face : building.faces)
        if (const Material& material = building.materials[face.material]; material.isOpening()) {
            EXPECT_EQ(face.twin, kNoTwin);
            glasses.emplace_back(material.name, material.transmittance.x);
        }
    std::ranges::sort(glasses);
    ASSERT_EQ(glasses.size(), 2u);
    EXPECT_EQ(glasses[0].first, "glass");
    EXPECT_NEAR(glasses[0].second, 0.8, 1e-6);
    EXPECT_EQ(glasses[1].first, "glass+glass+glass");
    EXPECT_NEAR(glasses[1].second, 0.512, 1e-6);
}

// Two rooms with a common wall that has two panes, and one with a window.
TEST(DoubleGlazing, between_two_rooms_is_an_interior_window) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    panesBefore(drawing, {kGap});
    const dvec3 o(0, 0, -kGap), z(0, 0, -3), x(4, 0, 0), y(0, 2.5, 0);
    drawing.sheet(o, x, z), drawing.sheet(o + y, z, x), drawing.sheet(o, z, y), drawing.sheet(o + x, y, z);
    drawing.sheet(o + z, y, x, "glass");
    const std::array<dvec3, 4> wall{o, o + x, o + x + y, o + y},
        pane{o + dvec3(1, 0.8, 0), o + dvec3(3, 0.8, 0), o + dvec3(3, 2, 0), o + dvec3(1, 2, 0)};
    for (size_t k = 0; k < 4; ++k)
        drawing.face("wall", {wall[(k + 1) % 4], wall[k], pane[k], pane[(k + 1) % 4]});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    size_t twins = 0;
    for (const Face& face : building.faces) {
        if (face.twin == kNoTwin) continue;
        ++twins;
        const Face& other = building.faces[static_cast<size_t>(face.twin)];
        EXPECT_NE(face.room, other.room);
        EXPECT_EQ(&building.faces[static_cast<size_t>(other.twin)], &face);
        EXPECT_NEAR(building.materials[face.material].transmittance.x, 0.64, 1e-6);
    }
    EXPECT_EQ(twins, 2u);
    EXPECT_EQ(countPanes(meshBuilding(building, {300})).windows, 2);
}

TEST(DoubleGlazing, as_far_apart_as_may_be_is_told_to_within_rounding) {
    for (const double turned : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        Drawing drawing(false);
        drawing.turned = turned;
        drawing.room(0, -1, true);
        panesBefore(drawing, {0.1});
        EXPECT_EQ(drawing.read().roomCount, 1u) << turned;
    }
}

TEST(DoubleGlazing, panes_a_sill_apart_stay_two_windows) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    panesBefore(drawing, {0.2});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(glassOf(building).transmittance.x, 0.8, 1e-6);
}

} // namespace heliodon::geometry
