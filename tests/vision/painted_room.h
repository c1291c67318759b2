// A room on the example rig's table to paint, and what is to be read from its photograph.
#pragma once

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "tests/vision/sketch_score.h"
#include "vision/detect.h"

namespace heliodon::vision {

inline geometry::Rig exampleRig() {
    return geometry::readRig(HELIODON_SOURCE "/examples/rig.json");
}

inline geometry::Wall wall(const char* id, glm::dvec2 a, glm::dvec2 b, geometry::HeightClass height) {
    geometry::Wall out;
    out.id = id, out.a = a, out.b = b, out.heightClass = height;
    return out;
}

inline geometry::WindowMarker window(const char* id, const char* on, double pos, double width,
                                     geometry::WindowKind kind) {
    geometry::WindowMarker out;
    out.id = id, out.wall = on, out.pos = pos, out.width = width, out.kind = kind;
    return out;
}

// Four walls, three windows, a skylight, a token, an arrow.
inline geometry::Sketch room() {
    geometry::Sketch s;
    s.walls = {wall("w1", {-7, -5}, {7, -5}, geometry::HeightClass::red),
               wall("w2", {7.4, -4.6}, {7.4, 5}, geometry::HeightClass::blue),
               wall("w3", {7, 5.4}, {-7, 5.4}, geometry::HeightClass::red),
               wall("w4", {-7.4, 5}, {-7.4, -4.6}, geometry::HeightClass::blue)};
    s.windows = {window("win1", "w1", 5, 2.5, geometry::WindowKind::standard),
                 window("win2", "w1", 10, 2, geometry::WindowKind::picture),
                 window("win3", "w2", 4, 2, geometry::WindowKind::transom)};
    s.skylights = {{"sky1", {1, 1}, {2.5, 1.5}, 20, {}}};
    geometry::Token token;
    token.id = "token1", token.kind = geometry::TokenKind::wallAll, token.pos = {-4, -1}, token.angleDeg = 15;
    token.rgb = {40, 40, 40};
    s.tokens = {token};
    s.north = geometry::NorthArrow{{0, -14}, 60, {}};
    return s;
}

inline void expectRead(const geometry::Sketch& stated, const Photograph& photo, double place = 0.08) {
    const auto result = detectSketch(photo, exampleRig());
    const Score score = scoreSketch(stated, result.sketch);
    for (const auto& [kind, k] : score) {
        EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
        EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
        EXPECT_LT(k.placeWorst, place) << kind << "\n" << table(score);
    }
}

inline bool warnsOf(const DetectionResult& result, const char* what) {
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

} // namespace heliodon::vision
