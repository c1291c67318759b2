#include "engine/app/blinds.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "compute/daylight/window.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

using geometry::Blind;

bool leadsOutside(const geometry::PatchMesh& mesh, size_t patch) {
    return mesh.twin[patch] == geometry::kNoTwin && mesh.materials[mesh.material[patch]].isOpening();
}

} // namespace

WindowState parseWindowState(const std::string& text) {
    WindowState state;
    const size_t equals = text.rfind('=');
    if (equals != std::string::npos) state.material = text.substr(0, equals);
    try {
        state.blind = geometry::parseBlind(equals == std::string::npos ? text : text.substr(equals + 1));
    } catch (const std::invalid_argument& error) {
        throw geometry::InputError("--blinds", "", fmt::format("'{}': {}", text, error.what()));
    }
    return state;
}

void drawBlinds(Run& run, const std::vector<std::string>& states, const std::string& file,
                geometry::PatchMesh& mesh) {
    std::map<uint32_t, std::optional<Blind>> drawn; // materials of openings that lead outside
    std::set<uint32_t> inside;                      // of interior windows
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        const bool given = material.blind.kind != Blind::Kind::none;
        if (leadsOutside(mesh, i))
            drawn[mesh.material[i]] = given ? std::optional(material.blind) : std::nullopt;
        else if (material.isOpening())
            inside.insert(mesh.material[i]);
        if (given && inside.contains(mesh.material[i]))
            throw geometry::InputError(file, material.name,
                                       "has blinds, which windows between two rooms cannot have");
    }
    for (geometry::Material& material : mesh.materials) material.blind = {}; // drawn below, or not
    for (const std::string& text : states) {
        const WindowState state = parseWindowState(text);
        bool found = state.material.empty();
        for (auto& [material, blind] : drawn)
            if (state.material.empty() || mesh.materials[material].name == state.material)
                blind = state.blind, found = true;
        if (!found) {
            std::string names;
            for (const auto& [material, blind] : drawn)
                names += (names.empty() ? "" : ", ") + mesh.materials[material].name;
            throw geometry::InputError("--blinds", state.material,
                                       names.empty() ? "is no window: nothing leads outside"
                                                     : "is no window's material, expected one of " + names);
        }
    }
    if (std::ranges::none_of(drawn, [](const auto& entry) { return entry.second.has_value(); })) return;
    nlohmann::json report = nlohmann::json::array();
    std::map<uint32_t, uint32_t> shaded; // a material of its own, where interior windows share the old one
    for (const auto& [material, blind] : drawn) {
        if (!blind) continue;
        const geometry::Material m = daylight::withBlind(mesh.materials[material], *blind);
        report.push_back({{"window", m.name},
                          {"state", geometry::blindText(*blind)},
                          {"diffuse_transmittance", daylight::Window(m).diffuseTransmittance().y},
                          {"room_reflectance", m.reflectance.y}});
        if (blind->kind == Blind::Kind::none) continue;
        if (!inside.contains(material)) {
            mesh.materials[material] = m;
            continue;
        }
        shaded[material] = static_cast<uint32_t>(mesh.materials.size());
        mesh.materials.push_back(m);
    }
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (leadsOutside(mesh, i))
            if (const auto to = shaded.find(mesh.material[i]); to != shaded.end())
                mesh.material[i] = to->second;
    run.report()["blinds"] = report;
}

} // namespace heliodon::app
