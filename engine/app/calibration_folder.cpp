#include "engine/app/calibration_folder.h"

#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/app/pixel_size.h"
#include "geometry/field_names.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"

namespace heliodon::app {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

using namespace std::string_view_literals;
constexpr std::array kOfDescription{"format"sv, "id"sv, "width"sv, "height"sv, "cell"sv, "names"sv};

// Null where there is no such file. Throws InputError where it is not JSON.
json readJson(const fs::path& file) {
    if (!fs::exists(file)) return nullptr;
    json out = geometry::readJson(file, "an object");
    if (!out.is_object()) throw geometry::InputError(file.string(), "", "not a JSON object");
    return out;
}

std::optional<int> pixelsIn(const fs::path& file, const json& object, const char* key) {
    if (!object.contains(key)) return std::nullopt;
    if (!object[key].is_number_integer() || object[key] < 1 || object[key] > kMostPixels)
        throw geometry::InputError(file.string(), key, "expected a whole number of pixels");
    return object[key].get<int>();
}

std::optional<int> numberOf(const fs::path& folder) {
    const std::string name = folder.filename().string(), start = "plane_";
    int number = 0;
    if (!name.starts_with(start)) return std::nullopt;
    const char *first = name.data() + start.size(), *last = name.data() + name.size();
    const auto [end, error] = std::from_chars(first, last, number);
    return error == std::errc() && end == last ? std::optional(number) : std::nullopt;
}

// The first pixel at which the last Gray bit turns white is a cell in.
std::optional<int> cellIn(const vision::GreyPicture& lastBit) {
    for (int x = 0; x < lastBit.width; ++x)
        if (lastBit(x, 0) > 0.5f) return x > 0 ? std::optional(x) : std::nullopt;
    return std::nullopt;
}

void describePatterns(const CalibrateProjectorArguments& arguments, const fs::path& folder,
                      CalibrationFolder& out) {
    bool knowsSize = false, knowsCell = false;
    for (const char* name : {"patterns.json", "projector.json"}) {
        const fs::path file = folder / name;
        const json description = readJson(file);
        if (description.is_null()) continue;
        const auto width = pixelsIn(file, description, "width"),
                   height = pixelsIn(file, description, "height"), cell = pixelsIn(file, description, "cell");
        if (!knowsSize && width && height)
            out.patterns.width = *width, out.patterns.height = *height, knowsSize = true;
        if (!knowsCell && cell) out.patterns.cell = *cell, knowsCell = true;
        if (description.contains("id") && !description["id"].is_string())
            throw geometry::InputError(file.string(), "id", "expected a text");
        if (out.id.empty()) out.id = description.value("id", "");
        CalibrationFolder::Misspelt& misspelt = out.misspelt.emplace_back(file);
        geometry::listOthers(geometry::otherFields(description, kOfDescription), "", geometry::Notes::welcome,
                             misspelt.fields);
    }
    if (const fs::path sent = folder / "patterns"; fs::exists(sent / "x_bit0.png")) {
        const vision::GreyPicture lastBit = vision::readGrey(sent / "x_bit0.png");
        if (!knowsSize)
            out.patterns.width = lastBit.width, out.patterns.height = lastBit.height, knowsSize = true;
        if (const auto cell = cellIn(lastBit); cell && !knowsCell)
            out.patterns.cell = *cell, knowsCell = true;
    }
    if (!arguments.size.empty()) {
        const PixelSize size = parseSize("--size", arguments.size, kMostPixels);
        out.patterns.width = size.width, out.patterns.height = size.height;
        knowsSize = true;
    }
    if (arguments.cell) out.patterns.cell = *arguments.cell, knowsCell = true;
    if (!knowsSize)
        out.assumed = fmt::format("a projector of {} x {} pixels", out.patterns.width, out.patterns.height);
    if (!knowsCell)
        out.assumed +=
            fmt::format("{}cells of {} pixels", out.assumed.empty() ? "" : ", ", out.patterns.cell);
}

} // namespace

CalibrationFolder openCalibrationFolder(const CalibrateProjectorArguments& arguments, size_t index) {
    const fs::path& folder = arguments.folders[index];
    if (!fs::is_directory(folder))
        throw geometry::InputError(folder.string(), "",
                                   "no such folder, expected one with plane_0, plane_1 ...");
    CalibrationFolder out;
    describePatterns(arguments, folder, out);
    if (!arguments.ids.empty()) out.id = arguments.ids[index];
    if (out.id.empty()) out.id = fs::weakly_canonical(folder).filename().string();
    if (out.id.empty()) out.id = fs::weakly_canonical(folder).parent_path().filename().string(); // "left/"

    std::map<int, fs::path> planes;
    for (const auto& entry : fs::directory_iterator(folder))
        if (const auto number = numberOf(entry.path()); number && entry.is_directory())
            planes[*number] = entry.path();
    if (planes.empty())
        throw geometry::InputError(folder.string(), "",
                                   "holds no plane_0, plane_1 ... with the camera's pictures");
    if (!arguments.heights.empty() && arguments.heights.size() != planes.size())
        throw geometry::InputError("--heights", "",
                                   fmt::format("{} heights for {} planes in {}", arguments.heights.size(),
                                               planes.size(), folder.string()));
    for (const auto& [number, path] : planes)
        out.planes.push_back({path, arguments.heights.empty() ? arguments.spacing * number
                                                              : arguments.heights[out.planes.size()]});
    return out;
}

fs::path pictureOf(const fs::path& plane, const std::string& pattern) {
    for (const char* extension : {".png", ".tif", ".tiff", ".jpg", ".jpeg"})
        if (fs::path file = plane / (pattern + extension); fs::exists(file)) return file;
    throw geometry::InputError((plane / (pattern + ".png")).string(), "",
                               "no such file, expected the camera's picture of this pattern");
}

} // namespace heliodon::app
