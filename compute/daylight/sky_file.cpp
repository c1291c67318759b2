// Skies as users name them: --sky options and `vh-sky/1` files.
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "compute/daylight/frame.h"
#include "compute/daylight/sky.h"
#include "geometry/field_names.h"
#include "geometry/input_error.h"
#include "geometry/number_text.h"
#include "geometry/text_file.h"

namespace heliodon::daylight {

namespace {

using geometry::InputError;
using nlohmann::json;
using namespace std::string_view_literals;

constexpr double kBrightest = 1e10; // cd/m2 or lux: above the sun's own luminance something else was meant
constexpr const char* kOption = "--sky";

constexpr std::array kOfSky{"format"sv, "model"sv,   "type"sv,  "zenith_luminance_cdm2"sv,
                            "norm"sv,   "Lz_cdm2"sv, "abcde"sv, "sun_direction"sv,
                            "sun"sv,    "ground"sv,  "A_cdm2"sv};
constexpr std::array kOfSun{"direction"sv, "normal_illuminance_lux"sv};
constexpr std::array kOfGround{"albedo"sv, "luminance_cdm2"sv};

[[noreturn]] void refuseOption(const std::string& option, const std::string& why) {
    throw InputError(
        kOption, "",
        fmt::format("'{}': {}; expected clear, overcast, intermediate, cie:1..15, perez:DNI,DHI or FILE.json",
                    option.substr(0, 80), why));
}

int cieType(const std::string& option) {
    const auto type = geometry::numberFrom(std::string_view(option).substr(4));
    if (!type || *type != std::floor(*type) || *type < 1 || *type > 15)
        refuseOption(option, "the CIE type must be a whole number from 1 to 15");
    return static_cast<int>(*type);
}

Irradiance perezNumbers(const std::string& option) {
    const std::string_view values = std::string_view(option).substr(6);
    const size_t comma = values.find(',');
    const auto direct = geometry::numberFrom(values.substr(0, comma));
    const auto diffuse = comma == values.npos ? std::nullopt : geometry::numberFrom(values.substr(comma + 1));
    if (!direct || !diffuse) refuseOption(option, "two numbers are expected after perez:, W/m2");
    if (*direct < 0 || *direct > 1500) refuseOption(option, "DNI must be 0 to 1500 W/m2");
    if (*diffuse < 0 || *diffuse > 1200) refuseOption(option, "DHI must be 0 to 1200 W/m2");
    return {*direct, *diffuse};
}

// One object of the file, knowing its name for messages.
struct Field {
    const json& value;
    const std::string& file;
    std::string name;

    [[noreturn]] void refuse(const std::string& what) const { throw InputError(file, name, what); }

    // Nothing of `known` may be misspelt; a sun that is not read is a sun that does not shine.
    void refuseMisspelt(std::span<const std::string_view> known) const {
        for (const auto& [key, meant] : geometry::otherFields(value, known, geometry::Alike::near))
            if (!meant.empty())
                Field{value, file, path(key)}.refuse(
                    fmt::format("is no field of a sky, expected \"{}\"", meant));
    }
    bool has(const char* key) const { return value.contains(key); }
    Field at(const char* key) const {
        if (!value.contains(key)) Field{value, file, path(key)}.refuse("is missing");
        return {value[key], file, path(key)};
    }
    std::string path(const std::string& key) const { return name.empty() ? key : name + "." + key; }

    const Field& asObject() const {
        if (!value.is_object()) refuse("expected an object");
        return *this;
    }
    double number(double low, double high) const {
        if (!value.is_number()) refuse("expected a number");
        const double number = value.get<double>();
        if (!(number >= low && number <= high))
            refuse(fmt::format("is {}, expected {:g} to {:g}", number, low, high));
        return number;
    }
    template<size_t n> std::array<double, n> numbers(double low, double high) const {
        if (!value.is_array() || value.size() != n) refuse(fmt::format("expected {} numbers", n));
        std::array<double, n> all{};
        for (size_t i = 0; i < n; ++i)
            all[i] = Field{value[i], file, fmt::format("{}[{}]", name, i)}.number(low, high);
        return all;
    }
    glm::dvec3 direction(geometry::UpAxis axes) const {
        const auto [x, y, z] = numbers<3>(-1.01, 1.01);
        const glm::dvec3 d(x, y, z);
        if (std::abs(glm::length(d) - 1.0) > 1e-3)
            refuse(fmt::format("has length {:.6g}, expected a unit vector", glm::length(d)));
        return glm::normalize(directionFromModel(d, axes));
    }
};

double zenithLuminance(const Field& root) {
    const char* key =
        root.has("zenith_luminance_cdm2") || !root.has("Lz_cdm2") ? "zenith_luminance_cdm2" : "Lz_cdm2";
    return root.at(key).number(0, kBrightest);
}

Sky distribution(const Field& root, geometry::UpAxis axes) {
    const Field model = root.at("model");
    const std::string name = model.value.is_string() ? model.value.get<std::string>() : "";
    if (name == "cie_overcast") return cieGeneralSky(16, {0, 1, 0}, zenithLuminance(root));
    if (name == "cie_clear") {
        const double norm = root.has("norm") ? root.at("norm").number(1e-6, 1e6) : 0.0;
        return cieClearSky(root.at("sun_direction").direction(axes), zenithLuminance(root), norm);
    }
    if (name == "cie_general") {
        const double type = root.at("type").number(1, 16);
        if (type != std::floor(type)) root.at("type").refuse("expected a whole number, 1 to 16");
        const glm::dvec3 sun = root.at("sun_direction").direction(axes);
        return cieGeneralSky(static_cast<int>(type), sun, zenithLuminance(root));
    }
    if (name == "perez") {
        // exp(b / 0.01) must stay finite.
        const auto [a, b, c, d, e] = root.at("abcde").numbers<5>(-1e5, 1e5);
        if (b > 5) root.at("abcde").refuse(fmt::format("has b = {:g}, expected at most 5", b));
        if (d > 50) root.at("abcde").refuse(fmt::format("has d = {:g}, expected at most 50", d));
        return perezSky({a, b, c, d, e}, root.at("sun_direction").direction(axes),
                        root.at("A_cdm2").number(0, kBrightest));
    }
    model.refuse("expected cie_overcast, cie_clear, cie_general or perez");
}

} // namespace

Sky readSky(const std::filesystem::path& path, geometry::UpAxis axes) {
    const std::string file = path.string();
    const json document = geometry::readJson(file, "a sky (vh-sky/1)");
    const Field root{document, file, ""};
    root.asObject();
    if (root.at("format").value != "vh-sky/1") root.at("format").refuse("expected \"vh-sky/1\"");
    root.refuseMisspelt(kOfSky);
    Sky sky = distribution(root, axes);
    sky.sun.direction = sky.shapeDirection;
    if (root.has("sun")) {
        const Field sun = root.at("sun");
        sun.asObject();
        sun.refuseMisspelt(kOfSun);
        sky.sun.direction = sun.at("direction").direction(axes);
        sky.sun.normalIlluminance = sun.at("normal_illuminance_lux").number(0, kBrightest);
        if (sky.sun.direction.y <= 0) sky.sun.normalIlluminance = 0;
    }
    double albedo = sky.ground.albedo;
    std::optional<double> luminance;
    if (root.has("ground")) {
        const Field ground = root.at("ground");
        ground.asObject();
        ground.refuseMisspelt(kOfGround);
        if (ground.has("albedo")) albedo = ground.at("albedo").number(0, 1);
        if (ground.has("luminance_cdm2")) luminance = ground.at("luminance_cdm2").number(0, kBrightest);
    }
    if (luminance)
        sky.ground = {albedo, *luminance};
    else
        lightGround(sky, albedo);
    return sky;
}

bool skyDependsOnTime(const std::string& option) {
    return !option.ends_with(".json");
}

Sky skyFromOption(const std::string& option, const SunPosition& sun, const SkySetting& setting,
                  geometry::UpAxis fileAxes) {
    if (option == "clear") return clearSky(sun, setting);
    if (option == "overcast") return overcastSky(sun, setting);
    if (option == "intermediate") return intermediateSky(sun, setting);
    if (option.starts_with("cie:")) return cieTypicalSky(cieType(option), sun, setting);
    if (option.starts_with("perez:")) return skyFromIrradiance(perezNumbers(option), sun, setting);
    if (option.ends_with(".json")) return readSky(option, fileAxes);
    refuseOption(option, "is not a sky");
}

} // namespace heliodon::daylight
