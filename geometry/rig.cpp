// The lens model is D. C. Brown, "Close-range camera calibration" (1971), in OpenCV's order and sign of the
// terms.
#include "geometry/rig.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "geometry/field_names.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"

namespace heliodon::geometry {
namespace {

using nlohmann::json;
using namespace std::string_view_literals;

constexpr double kFarthest = 1e7; // metres

struct Distorted {
    glm::dvec2 point;
    double xx, xy, yy; // Jacobian; it is symmetric
};

Distorted distort(const std::array<double, 5>& d, glm::dvec2 p) {
    const auto [k1, k2, p1, p2, k3] = d;
    const double x = p.x, y = p.y, r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3)); // d radial / d r2, times 2
    Distorted out{};
    out.point = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                 y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
    out.xx = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x;
    out.xy = x * y * slope + 2 * p1 * x + 2 * p2 * y;
    out.yy = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
    return out;
}

// One JSON value with the path that leads to it, so that every complaint names its field.
class Field {
public:
    Field(const std::string& file, std::string path, const json& value)
        : file_(file), path_(std::move(path)), value_(value) {}

    [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, path_, what); }
    bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
    Field operator[](const char* key) const {
        const std::string path = path_.empty() ? key : path_ + "." + key;
        if (!value_.is_object()) fail("expected an object");
        if (!value_.contains(key)) throw InputError(file_, path, "missing");
        return {file_, path, value_.at(key)};
    }
    Field at(size_t i) const { return {file_, fmt::format("{}[{}]", path_, i), value_.at(i)}; }
    size_t arraySize() const {
        if (!value_.is_array()) fail("expected an array");
        return value_.size();
    }
    void expectSize(size_t n) const {
        if (arraySize() != n) fail(fmt::format("expected {} elements, found {}", n, value_.size()));
    }
    double number() const {
        if (!value_.is_number()) fail("expected a number");
        const double v = value_.get<double>();
        if (!std::isfinite(v)) fail("expected a finite number");
        return v;
    }
    double numberWithin(double low, double high) const {
        const double v = number();
        if (!(v >= low && v <= high)) fail(fmt::format("{} is not between {} and {}", v, low, high));
        return v;
    }
    int pixels() const {
        if (!value_.is_number_integer()) fail("expected a whole number of pixels");
        return static_cast<int>(numberWithin(1, 65536));
    }
    std::string text() const {
        if (!value_.is_string()) fail("expected a string");
        return value_.get<std::string>();
    }
    bool isText() const { return value_.is_string(); }
    void listOthers(std::span<const std::string_view> known, std::vector<std::string>& list,
                    Notes notes = Notes::unexpected) const {
        geometry::listOthers(otherFields(value_, known), path_, notes, list);
    }
    // [row][column], as the file has it.
    std::array<std::array<double, 3>, 3> matrix3() const {
        std::array<std::array<double, 3>, 3> m{};
        expectSize(3);
        for (size_t i = 0; i < 3; ++i) {
            at(i).expectSize(3);
            for (size_t j = 0; j < 3; ++j) m[i][j] = at(i).at(j).number();
        }
        return m;
    }

private:
    const std::string& file_;
    std::string path_;
    const json& value_;
};

Lens readLens(const Field& device) {
    Lens lens;
    const Field kField = device["K"];
    const auto k = kField.matrix3();
    if (!(k[0][0] > 0 && k[1][1] > 0)) kField.fail("focal lengths K[0][0] and K[1][1] must be positive");
    if (k[1][0] != 0 || k[2][0] != 0 || k[2][1] != 0 || k[2][2] != 1)
        kField.fail("expected [[fx, skew, cx], [0, fy, cy], [0, 0, 1]]");
    lens.fx = k[0][0], lens.skew = k[0][1], lens.cx = k[0][2];
    lens.fy = k[1][1], lens.cy = k[1][2];
    if (!device.has("dist")) return lens;
    const Field dist = device["dist"];
    const size_t n = dist.arraySize();
    if (n != 4 && n != 5) dist.fail(fmt::format("expected k1, k2, p1, p2[, k3], found {} numbers", n));
    for (size_t i = 0; i < n; ++i) lens.dist[i] = dist.at(i).numberWithin(-1e6, 1e6);
    return lens;
}

glm::dmat3 readRotation(const Field& field) {
    const auto m = field.matrix3();
    glm::dvec3 x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]), z(m[2][0], m[2][1], m[2][2]);
    const double off =
        std::max({std::abs(glm::dot(x, x) - 1), std::abs(glm::dot(y, y) - 1), std::abs(glm::dot(z, z) - 1),
                  std::abs(glm::dot(x, y)), std::abs(glm::dot(y, z)), std::abs(glm::dot(z, x))});
    if (off > 1e-3) field.fail(fmt::format("not a rotation: R R^T differs from 1 by {:.2g}", off));
    if (glm::dot(glm::cross(x, y), z) < 0) field.fail("mirrors space: the determinant is -1, expected +1");
    // Two rounds of symmetric orthonormalisation, R <- R (3 - R^T R) / 2, take 1e-3 below 1e-11.
    glm::dmat3 r = glm::transpose(glm::dmat3(x, y, z));
    for (int i = 0; i < 3; ++i) r = 0.5 * r * (glm::dmat3(3) - glm::transpose(r) * r);
    return r;
}

// A pixel that no ray meets within a hundredth of one. In corners, real calibrations may have some.
bool foldsBack(const OpticalDevice& device) {
    for (const double u : {0.25, 0.5, 0.75})
        for (const double v : {0.25, 0.5, 0.75}) {
            const glm::dvec2 pixel(u * device.width, v * device.height);
            const glm::dvec2 back = device.lens.pixelFromPlane(device.lens.planeFromPixel(pixel));
            if (!(glm::distance(back, pixel) < 0.01)) return true;
        }
    return false;
}

// `centre` is written for people, R and t say it.
constexpr std::array kOfRig{"format"sv, "set"sv,        "units"sv, "conventions"sv,        "table"sv,
                            "camera"sv, "projectors"sv, "site"sv,  "surface_reflectance"sv};
constexpr std::array kOfCamera{"id"sv, "width"sv, "height"sv, "K"sv, "dist"sv, "R"sv, "t"sv, "centre"sv};
constexpr std::array kOfProjector{"id"sv, "width"sv,  "height"sv, "K"sv,           "dist"sv,     "R"sv,
                                  "t"sv,  "centre"sv, "lumens"sv, "black_level"sv, "response"sv, "display"sv};
constexpr std::array kOfTable{"radius_m"sv}; // and notes of what stands around it
constexpr std::array kOfSite{"latitude_deg"sv, "longitude_deg"sv};

void readDevice(const Field& field, OpticalDevice& device) {
    device.width = field["width"].pixels();
    device.height = field["height"].pixels();
    device.lens = readLens(field);
    if (foldsBack(device)) field.fail("the lens (K, dist) folds back inside the picture");
    device.deviceFromWorld = readRotation(field["R"]);
    const Field t = field["t"];
    t.expectSize(3);
    for (int c = 0; c < 3; ++c)
        device.translation[c] = t.at(static_cast<size_t>(c)).numberWithin(-kFarthest, kFarthest);
}

Projector readProjector(const Field& field, size_t index) {
    Projector projector;
    readDevice(field, projector);
    projector.id = field.has("id") ? field["id"].text() : fmt::format("P{}", index);
    if (field.has("lumens")) projector.lumens = field["lumens"].numberWithin(1e-3, 1e6);
    if (field.has("black_level")) projector.blackLevel = field["black_level"].numberWithin(0, 1);
    if (field.has("response")) {
        const Field response = field["response"];
        if (!response.isText())
            projector.response = fmt::format("{}", response.numberWithin(0.1, 10));
        else if (response.text() != "srgb")
            response.fail(fmt::format("\"{}\" is not known, expected \"srgb\" or a gamma as a number",
                                      response.text()));
    }
    if (field.has("display")) projector.display = field["display"].text();
    return projector;
}

} // namespace

glm::dvec2 Lens::pixelFromPlane(glm::dvec2 xy) const {
    const glm::dvec2 d = distort(dist, xy).point;
    return {fx * d.x + skew * d.y + cx, fy * d.y + cy};
}

glm::dvec2 Lens::planeFromPixel(glm::dvec2 pixel) const {
    const double wantedY = (pixel.y - cy) / fy;
    const glm::dvec2 wanted((pixel.x - cx - skew * wantedY) / fx, wantedY);
    glm::dvec2 p = wanted;
    // Newton; a lens that folds back beyond its picture corners would send a step to infinity, so steps are
    // bounded.
    for (int i = 0; i < 30; ++i) {
        const Distorted d = distort(dist, p);
        const glm::dvec2 miss = wanted - d.point;
        const double det = d.xx * d.yy - d.xy * d.xy;
        if (std::abs(det) < 1e-6) break;
        glm::dvec2 step((d.yy * miss.x - d.xy * miss.y) / det, (d.xx * miss.y - d.xy * miss.x) / det);
        const double length = glm::length(step);
        if (length > 0.25) step *= 0.25 / length;
        p += step;
        if (length < 1e-12) break;
    }
    return p;
}

glm::dvec3 OpticalDevice::centre() const {
    return -(glm::transpose(deviceFromWorld) * translation);
}

std::optional<glm::dvec2> OpticalDevice::pixelFromWorld(glm::dvec3 world) const {
    const glm::dvec3 p = deviceFromWorld * world + translation;
    if (p.z <= 1e-9) return std::nullopt;
    return lens.pixelFromPlane({p.x / p.z, p.y / p.z});
}

Ray OpticalDevice::rayFromPixel(glm::dvec2 pixel) const {
    const glm::dvec3 inDevice(lens.planeFromPixel(pixel), 1);
    return {centre(), glm::normalize(glm::transpose(deviceFromWorld) * inDevice)};
}

std::optional<glm::dvec3> OpticalDevice::worldOnPlane(glm::dvec2 pixel, double y) const {
    const Ray ray = rayFromPixel(pixel);
    const double distance = (y - ray.origin.y) / ray.direction.y;
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    glm::dvec3 hit = ray.origin + distance * ray.direction;
    hit.y = y;
    return hit;
}

Rig readRig(const std::filesystem::path& path) {
    return rigOf(readJson(path, "a rig (vh-rig/1)"), path.string());
}

Rig rigOf(const json& document, const std::string& file) {
    const Field root(file, "", document);
    const Field format = root["format"];
    if (format.text() != "vh-rig/1") format.fail(fmt::format("\"{}\", expected \"vh-rig/1\"", format.text()));
    if (root.has("units") && root["units"].text() != "metres")
        root["units"].fail(fmt::format("\"{}\", expected \"metres\"", root["units"].text()));
    Rig rig;
    rig.tableAssumed = !root.has("table");
    if (!rig.tableAssumed) {
        const Field table = root["table"];
        rig.tableRadius = table["radius_m"].numberWithin(0.05, 50);
        table.listOthers(kOfTable, rig.unknownFields, Notes::welcome);
    }
    readDevice(root["camera"], rig.camera);
    rig.camera.id = "camera";
    root["camera"].listOthers(kOfCamera, rig.unknownFields);
    if (root.has("projectors")) {
        const Field list = root["projectors"];
        if (list.arraySize() > kMostProjectors)
            list.fail(fmt::format("expected {} at most, found {}", kMostProjectors, list.arraySize()));
        std::set<std::string> ids;
        for (size_t i = 0; i < list.arraySize(); ++i) {
            rig.projectors.push_back(readProjector(list.at(i), i));
            list.at(i).listOthers(kOfProjector, rig.unknownFields);
            if (!ids.insert(rig.projectors.back().id).second)
                list.at(i).fail(fmt::format("id \"{}\" is used twice", rig.projectors.back().id));
        }
    }
    if (root.has("surface_reflectance"))
        rig.surfaceReflectance = root["surface_reflectance"].numberWithin(0.01, 0.98);
    if (root.has("site")) {
        const Field site = root["site"];
        rig.site =
            Site{site["latitude_deg"].numberWithin(-90, 90), site["longitude_deg"].numberWithin(-180, 180)};
        site.listOthers(kOfSite, rig.unknownFields, Notes::welcome);
    }
    root.listOthers(kOfRig, rig.unknownFields, Notes::welcome);
    return rig;
}

} // namespace heliodon::geometry
