#include "geometry/sketch.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/field_names.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::geometry {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "vh-sketch/1";
// Beyond any table: a coordinate larger than this is a unit mistake, and exact arithmetic stays cheap below
// it.
constexpr double kLargestInches = 1e4;

// A JSON object with the name that messages use for it.
class Object {
public:
    Object(const std::string& file, std::string place, const Json& json)
        : file_(file), place_(std::move(place)), json_(json) {
        if (!json.is_object()) fail("", "expected an object");
    }

    [[noreturn]] void fail(std::string_view field, const std::string& what) const {
        throw InputError(file_, at(field), what);
    }

    const std::string& file() const { return file_; }
    std::string at(std::string_view field) const {
        if (field.empty()) return place_;
        return place_.empty() ? std::string(field) : place_ + "." + std::string(field);
    }

    // Fields that nobody has asked for.
    void listUnread(std::vector<std::string>& list, Notes notes = Notes::unexpected) const {
        const std::vector<std::string_view> known(asked_.begin(), asked_.end());
        listOthers(otherFields(json_, known), place_, notes, list);
    }

    // nullptr when absent; null counts as absent.
    const Json* find(const char* field) const {
        asked_.insert(field);
        const auto it = json_.find(field);
        return it == json_.end() || it->is_null() ? nullptr : &*it;
    }

    double number(const char* field, std::optional<double> otherwise = {}) const {
        const Json* value = find(field);
        if (!value) {
            if (otherwise) return *otherwise;
            fail(field, "is missing, expected a number");
        }
        return checked(field, *value);
    }

    double positive(const char* field, std::optional<double> otherwise = {}) const {
        const double value = number(field, otherwise);
        if (!(value > 0)) fail(field, fmt::format("is {}, expected a number above 0", value));
        return value;
    }

    glm::dvec2 point(const char* field) const {
        const Json* value = find(field);
        if (!value) fail(field, "is missing, expected two numbers [x, y]");
        if (!value->is_array() || value->size() != 2) fail(field, "expected two numbers [x, y]");
        return {checked(field, (*value)[0]), checked(field, (*value)[1])};
    }

    std::string text(const char* field, const std::string& otherwise) const {
        const Json* value = find(field);
        if (!value) return otherwise;
        if (!value->is_string()) fail(field, "expected a text");
        return value->get<std::string>();
    }

    // The index of the text in `names`.
    template<size_t N> size_t choice(const char* field, const std::array<const char*, N>& names) const {
        const std::string value = text(field, "");
        for (size_t i = 0; i < N; ++i)
            if (value == names[i]) return i;
        std::string expected = names[0];
        for (size_t i = 1; i < N; ++i) expected += std::string(i + 1 < N ? ", " : " or ") + names[i];
        fail(field, value.empty() ? "is missing, expected " + expected
                                  : fmt::format("is \"{}\", expected {}", value, expected));
    }

private:
    double checked(const char* field, const Json& value) const {
        if (!value.is_number()) fail(field, "expected a number");
        const double number = value.get<double>();
        if (!std::isfinite(number) || std::abs(number) > kLargestInches)
            fail(field, fmt::format("is {}, expected a finite number within +-{}", number, kLargestInches));
        return number;
    }

    const std::string& file_;
    std::string place_;
    const Json& json_;
    mutable std::set<std::string> asked_;
};

constexpr std::array kHeights{"red", "blue", "green"};
constexpr std::array kWindows{"standard", "picture", "transom"};
constexpr std::array kTokens{"floor", "wall_all", "wall_single"};

Detection readDetection(const Object& in) {
    Detection out;
    out.confidence = in.number("confidence", 1.0);
    if (out.confidence < 0 || out.confidence > 1)
        in.fail("confidence", fmt::format("is {}, expected 0 to 1", out.confidence));
    const Json* outline = in.find("outline_px");
    if (!outline) return out;
    if (!outline->is_array()) in.fail("outline_px", "expected a list of points [x, y]");
    for (const Json& point : *outline) {
        if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number())
            in.fail("outline_px", "expected a list of points [x, y]");
        out.outlinePx.emplace_back(point[0].get<double>(), point[1].get<double>());
        if (!std::isfinite(out.outlinePx.back().x) || !std::isfinite(out.outlinePx.back().y))
            in.fail("outline_px", "holds a number that is not finite");
    }
    return out;
}

Wall readWall(const Object& in) {
    Wall out;
    out.a = in.point("a");
    out.b = in.point("b");
    out.thickness = in.positive("thickness", Wall{}.thickness);
    out.heightClass = static_cast<HeightClass>(in.choice("height_class", kHeights));
    return out;
}

Arc readArc(const Object& in) {
    Arc out;
    out.center = in.point("center");
    out.radius = in.positive("radius");
    out.thickness = in.positive("thickness", Arc{}.thickness);
    out.a0Deg = in.number("a0_deg");
    out.a1Deg = in.number("a1_deg");
    if (!(out.a1Deg > out.a0Deg)) in.fail("a1_deg", "expected more than a0_deg (arcs run counter-clockwise)");
    if (out.a1Deg - out.a0Deg > 360 + 1e-9) in.fail("a1_deg", "expected at most a0_deg + 360");
    out.heightClass = static_cast<HeightClass>(in.choice("height_class", kHeights));
    return out;
}

Blind readBlind(const Object& in) {
    try {
        return parseBlind(in.text("blinds", "open"));
    } catch (const std::invalid_argument& error) {
        in.fail("blinds", error.what());
    }
}

WindowMarker readWindow(const Object& in) {
    WindowMarker out;
    out.wall = in.text("wall", "");
    if (out.wall.empty()) in.fail("wall", "is missing, expected the id of a wall");
    out.pos = in.number("pos");
    out.width = in.positive("width");
    out.kind = static_cast<WindowKind>(in.choice("kind", kWindows));
    out.blind = readBlind(in);
    return out;
}

Skylight readSkylight(const Object& in) {
    Skylight out;
    out.center = in.point("center");
    out.size = in.point("size");
    if (!(out.size.x > 0 && out.size.y > 0)) in.fail("size", "expected two numbers above 0");
    out.angleDeg = in.number("angle_deg", 0.0);
    out.blind = readBlind(in);
    return out;
}

Token readToken(const Object& in) {
    Token out;
    out.kind = static_cast<TokenKind>(in.choice("kind", kTokens));
    out.pos = in.point("pos");
    out.angleDeg = in.number("angle_deg", 0.0);
    const Json* rgb = in.find("rgb");
    if (!rgb || !rgb->is_array() || rgb->size() != 3) in.fail("rgb", "expected three numbers, 0 to 255");
    for (size_t i = 0; i < 3; ++i) {
        if (!(*rgb)[i].is_number()) in.fail("rgb", "expected three numbers, 0 to 255");
        out.rgb[i] = (*rgb)[i].get<double>();
        if (!(out.rgb[i] >= 0 && out.rgb[i] <= 255)) in.fail("rgb", "expected three numbers, 0 to 255");
    }
    return out;
}

// Reads a list; entries without an id get prefix + number, skipping ids that are taken.
template<class Item, class Read>
std::vector<Item> readList(const Object& root, const char* field, const std::string& prefix, Read read,
                           std::vector<std::string>& unknown) {
    std::vector<Item> items;
    const Json* list = root.find(field);
    if (!list) return items;
    if (!list->is_array()) root.fail(field, "expected a list");
    std::set<std::string> taken;
    for (const Json& json : *list) {
        const Object in(root.file(), fmt::format("{}[{}]", field, items.size()), json);
        Item item = read(in);
        item.id = in.text("id", "");
        item.detection = readDetection(in);
        in.listUnread(unknown);
        if (!item.id.empty() && !taken.insert(item.id).second)
            in.fail("id", fmt::format("\"{}\" is used twice", item.id));
        items.push_back(std::move(item));
    }
    size_t next = 1;
    for (Item& item : items) {
        while (item.id.empty()) {
            std::string id = prefix + std::to_string(next++);
            if (taken.insert(id).second) item.id = std::move(id);
        }
    }
    return items;
}

void checkReferences(const Object& root, const Sketch& sketch) {
    for (size_t i = 0; i < sketch.windows.size(); ++i) {
        const std::string& id = sketch.windows[i].wall;
        const auto named = [&](const auto& item) { return item.id == id; };
        if (std::ranges::none_of(sketch.walls, named) && std::ranges::none_of(sketch.arcs, named))
            root.fail(fmt::format("windows[{}].wall", i),
                      fmt::format("\"{}\" is no wall of this sketch", id));
    }
    for (size_t i = 0; i < sketch.arcs.size(); ++i)
        if (std::ranges::any_of(sketch.walls, [&](const Wall& wall) { return wall.id == sketch.arcs[i].id; }))
            root.fail(fmt::format("arcs[{}].id", i), fmt::format("\"{}\" is a wall's id", sketch.arcs[i].id));
}

Json jsonPoint(glm::dvec2 p) {
    return Json::array({p.x, p.y});
}

void writeDetection(Json& out, const Detection& detection) {
    out["confidence"] = detection.confidence;
    if (detection.outlinePx.empty()) return;
    Json outline = Json::array();
    for (const glm::dvec2 p : detection.outlinePx) outline.push_back(jsonPoint(p));
    out["outline_px"] = std::move(outline);
}

Json jsonOf(const Wall& wall) {
    return {{"id", wall.id},
            {"a", jsonPoint(wall.a)},
            {"b", jsonPoint(wall.b)},
            {"thickness", wall.thickness},
            {"height_class", kHeights[static_cast<size_t>(wall.heightClass)]}};
}

Json jsonOf(const Arc& arc) {
    return {{"id", arc.id},
            {"center", jsonPoint(arc.center)},
            {"radius", arc.radius},
            {"a0_deg", arc.a0Deg},
            {"a1_deg", arc.a1Deg},
            {"thickness", arc.thickness},
            {"height_class", kHeights[static_cast<size_t>(arc.heightClass)]}};
}

Json jsonOf(const WindowMarker& window) {
    Json out{{"id", window.id},
             {"wall", window.wall},
             {"pos", window.pos},
             {"width", window.width},
             {"kind", kWindows[static_cast<size_t>(window.kind)]}};
    if (window.blind != Blind{}) out["blinds"] = blindText(window.blind);
    return out;
}

Json jsonOf(const Skylight& skylight) {
    Json out{{"id", skylight.id},
             {"center", jsonPoint(skylight.center)},
             {"size", jsonPoint(skylight.size)},
             {"angle_deg", skylight.angleDeg}};
    if (skylight.blind != Blind{}) out["blinds"] = blindText(skylight.blind);
    return out;
}

Json jsonOf(const Token& token) {
    return {{"id", token.id},
            {"kind", kTokens[static_cast<size_t>(token.kind)]},
            {"pos", jsonPoint(token.pos)},
            {"rgb", Json(token.rgb)},
            {"angle_deg", token.angleDeg}};
}

template<class Item> Json jsonList(const std::vector<Item>& items) {
    Json list = Json::array();
    for (const Item& item : items) {
        list.push_back(jsonOf(item));
        writeDetection(list.back(), item.detection);
    }
    return list;
}

} // namespace

Sketch readSketch(const std::filesystem::path& file) {
    const std::string name = file.string();
    const Json json = readJson<Json>(file, "a sketch (vh-sketch/1)");
    const Object root(name, "", json);
    const std::string format = root.text("format", "");
    if (format != kFormat) root.fail("format", fmt::format("is \"{}\", expected \"{}\"", format, kFormat));

    // What is on the table is as large as it is: other words would change nothing.
    for (const auto& [field, only] : {std::pair("units", "inch"), std::pair("scale", "1in=1ft")})
        if (const std::string said = root.text(field, only); said != only)
            root.fail(field, fmt::format("is \"{}\", expected \"{}\"", said, only));

    Sketch sketch;
    sketch.id = root.text("id", file.stem().string());
    sketch.title = root.text("title", "");
    if (const Json* tableJson = root.find("table")) {
        const Object in(name, "table", *tableJson);
        sketch.tableDiameter = in.positive("diameter", Sketch{}.tableDiameter);
        if (in.find("center") && in.point("center") != glm::dvec2(0))
            in.fail("center", "is not [0, 0], expected the origin there");
        in.listUnread(sketch.unknownFields, Notes::welcome);
    }
    sketch.walls = readList<Wall>(root, "walls", "w", readWall, sketch.unknownFields);
    sketch.arcs = readList<Arc>(root, "arcs", "a", readArc, sketch.unknownFields);
    sketch.windows = readList<WindowMarker>(root, "windows", "win", readWindow, sketch.unknownFields);
    sketch.skylights = readList<Skylight>(root, "skylights", "sky", readSkylight, sketch.unknownFields);
    sketch.tokens = readList<Token>(root, "tokens", "token", readToken, sketch.unknownFields);
    if (const Json* northJson = root.find("north")) {
        const Object in(name, "north", *northJson);
        sketch.north = NorthArrow{in.point("pos"), in.number("dir_deg"), readDetection(in)};
        in.listUnread(sketch.unknownFields, Notes::welcome);
    }
    root.listUnread(sketch.unknownFields, Notes::welcome);
    checkReferences(root, sketch);
    return sketch;
}

void writeSketch(const Sketch& sketch, const std::filesystem::path& file) {
    Json out{{"format", kFormat},
             {"id", sketch.id},
             {"title", sketch.title},
             {"units", "inch"},
             {"scale", "1in=1ft"},
             {"table", {{"center", {0, 0}}, {"diameter", sketch.tableDiameter}}},
             {"walls", jsonList(sketch.walls)},
             {"arcs", jsonList(sketch.arcs)},
             {"windows", jsonList(sketch.windows)},
             {"skylights", jsonList(sketch.skylights)},
             {"tokens", jsonList(sketch.tokens)}};
    if (sketch.north) {
        out["north"] = {{"pos", jsonPoint(sketch.north->pos)}, {"dir_deg", sketch.north->dirDeg}};
        writeDetection(out["north"], sketch.north->detection);
    }
    writeWholeText(file, out.dump(1) + "\n");
}

} // namespace heliodon::geometry
