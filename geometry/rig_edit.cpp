#include "geometry/rig_edit.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/input_error.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::geometry {
namespace {

using json = nlohmann::ordered_json;

json readBase(const std::filesystem::path& file) {
    if (file.empty())
        return {{"format", "vh-rig/1"},
                {"units", "metres"},
                {"conventions",
                 {{"world",
                   "right-handed; table top is y = 0, y up; seen from above x right and z down the picture"},
                  {"device", "x right, y down, z forward; X_dev = R X_world + t; centre = -R^T t"},
                  {"pixel", "integer = pixel centre"},
                  {"dist", "Brown-Conrady k1 k2 p1 p2 k3"}}}};
    const json rig = readJson(file, "a rig (vh-rig/1)");
    if (!rig.is_object() || !rig.contains("format") || rig["format"] != "vh-rig/1")
        throw InputError(file.string(), "format", "expected a rig, \"vh-rig/1\"");
    if (rig.contains("table") && !rig["table"].is_object())
        throw InputError(file.string(), "table", "expected an object");
    if (rig.contains("camera") && !rig["camera"].is_object())
        throw InputError(file.string(), "camera", "expected an object");
    if (rig.contains("projectors"))
        for (const json& p : rig["projectors"])
            if (!rig["projectors"].is_array() || !p.is_object() || (p.contains("id") && !p["id"].is_string()))
                throw InputError(file.string(), "projectors", "expected an array of objects, their ids text");
    return rig;
}

json rowOf(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

void put(json& entry, const OpticalDevice& device) {
    const Lens& lens = device.lens;
    const glm::dmat3& r = device.deviceFromWorld;
    entry["width"] = device.width;
    entry["height"] = device.height;
    entry["K"] = {{lens.fx, lens.skew, lens.cx}, {0.0, lens.fy, lens.cy}, {0.0, 0.0, 1.0}};
    entry["dist"] = lens.dist;
    entry["R"] = json::array();
    for (int row = 0; row < 3; ++row) entry["R"].push_back(rowOf({r[0][row], r[1][row], r[2][row]}));
    entry["t"] = rowOf(device.translation);
    entry["centre"] = rowOf(device.centre());
}

} // namespace

RigFile::RigFile(const std::filesystem::path& file) : file_(file), document_(readBase(file)) {}

bool RigFile::namesTable() const {
    return document_.contains("table") && document_["table"].contains("radius_m");
}

Rig RigFile::rig() const {
    return rigOf(document_, file_.string());
}

void RigFile::write(const std::filesystem::path& target, const RigEdit& edit) const {
    json rig = document_;
    if (edit.tableRadius) rig["table"]["radius_m"] = *edit.tableRadius;
    if (edit.camera) put(rig["camera"], *edit.camera);
    for (const OpticalDevice& projector : edit.projectors) {
        json& list = rig["projectors"];
        size_t index = 0;
        // An entry without an id goes by its place, as readRig has it.
        while (index < list.size() && list[index].value("id", fmt::format("P{}", index)) != projector.id)
            ++index;
        if (index == list.size()) list.push_back({{"id", projector.id}});
        put(list[index], projector);
    }
    writeWholeText(target, jsonText(rig, 1));
}

} // namespace heliodon::geometry
