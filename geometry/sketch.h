// What lies on the table, as the camera saw it or a file states it (`vh-sketch/1`).
// Plan coordinates: inches on the table (1 in = 1 ft of building), origin at the table's centre, x right, y
// up as seen from above; angles in degrees counter-clockwise from +x. World metres are (0.0254 x, 0, -0.0254
// y).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/blind.h"

namespace heliodon::geometry {

enum class HeightClass { red, blue, green }; // wall tops: 10, 8 and 4 inches
enum class WindowKind { standard, picture, transom };
enum class TokenKind { floor, wallAll, wallSingle };

constexpr double kMetresPerInch = 0.0254, kMetresPerFoot = 0.3048;
constexpr double heightInches(HeightClass c) {
    return c == HeightClass::red ? 10.0 : c == HeightClass::blue ? 8.0 : 4.0;
}

// What detection knows about a primitive; a sketch read from a file without it has confidence 1 and no
// outline.
struct Detection {
    double confidence = 1;             // 0..1
    std::vector<glm::dvec2> outlinePx; // camera pixels (integer = pixel centre), closed, may be empty
};

struct Wall {
    std::string id;
    glm::dvec2 a{}, b{}; // ends of the centre line: the real physical ends, not those of the paint
    double thickness = 0.375;
    HeightClass heightClass = HeightClass::red;
    Detection detection;
};

struct Arc {
    std::string id;
    glm::dvec2 center{};
    double radius = 0;           // of the centre line
    double a0Deg = 0, a1Deg = 0; // counter-clockwise from a0 to a1, a1 > a0
    double thickness = 0.375;
    HeightClass heightClass = HeightClass::red;
    Detection detection;
};

struct WindowMarker {
    std::string id;
    std::string wall; // id of a planar wall
    double pos = 0;   // from that wall's `a` along the centre line to the marker's middle
    double width = 0;
    WindowKind kind = WindowKind::standard;
    Blind blind; // "blinds" in the file
    Detection detection;
};

struct Skylight {
    std::string id;
    glm::dvec2 center{}, size{};
    double angleDeg = 0;
    Blind blind; // "blinds" in the file; where skylights overlap, that of one of them holds
    Detection detection;
};

struct Token {
    std::string id;
    TokenKind kind = TokenKind::floor;
    glm::dvec2 pos{};
    std::array<double, 3> rgb{}; // sRGB of the paint chip, 0..255
    double angleDeg = 0;
    Detection detection;
};

struct NorthArrow {
    glm::dvec2 pos{};
    double dirDeg = 90; // direction that the arrow points to: north
    Detection detection;
};

struct Sketch {
    std::string id, title;
    double tableDiameter = 42;
    std::vector<Wall> walls;
    std::vector<Arc> arcs;
    std::vector<WindowMarker> windows;
    std::vector<Skylight> skylights;
    std::vector<Token> tokens;
    std::optional<NorthArrow> north;
    // Of the file, and not of this format: "walls[3].height"; at the top level those that look like
    // misspellings.
    std::vector<std::string> unknownFields;
};

// Throws InputError naming the file and the field ("walls[3].thickness"); unknown fields make no difference.
// Ids must be unique within a list; missing ids are given ("w1", "a1", "win1", "sky1", "token1").
Sketch readSketch(const std::filesystem::path& file);
// Written whole or not at all. Reading it back gives the same sketch.
void writeSketch(const Sketch& sketch, const std::filesystem::path& file);

} // namespace heliodon::geometry
