#include "engine/app/blinds.h"

#include <algorithm>
#include <charconv>
#include <map>

#include <fmt/format.h>

#include "compute/daylight/window.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

using geometry::Blind;

struct Range {
    const char* name;
    double low, high, standard; // standard: where it is not given
};

// Numbers with commas between, at least the first `needed` of them.
std::vector<double> numbersOf(const std::string& text, const std::string& all, size_t needed,
                              const std::vector<Range>& ranges) {
    std::vector<double> values;
    size_t at = 0;
    const auto refuse = [&](const std::string& why) {
        throw geometry::InputError("--blinds", "", fmt::format("'{}': {}", all, why));
    };
    for (const Range& range : ranges) {
        if (at > text.size() || (text.empty() && values.size() >= needed)) {
            if (values.size() < needed) refuse(fmt::format("{} is missing", range.name));
            values.push_back(range.standard);
            continue;
        }
        const size_t comma = std::min(text.find(',', at), text.size());
        double value = 0;
        const auto end = std::from_chars(text.data() + at, text.data() + comma, value);
        if (end.ec != std::errc() || end.ptr != text.data() + comma ||
            !(value >= range.low && value <= range.high))
            refuse(fmt::format("{} is '{}', expected {:g} to {:g}", range.name, text.substr(at, comma - at),
                               range.low, range.high));
        values.push_back(value);
        at = comma + 1;
    }
    if (at <= text.size()) refuse(fmt::format("'{}' is more than there is to say", text.substr(at)));
    return values;
}

std::string stateName(const Blind& blind) {
    switch (blind.kind) {
    case Blind::Kind::fabric:
        return fmt::format("fabric:{:g},{:g}", blind.transmittance, blind.reflectance);
    case Blind::Kind::slats:
        return fmt::format("slats:{:g},{:g},{:g}", blind.slatAngleDeg, blind.reflectance, blind.slatSpacing);
    case Blind::Kind::none:
        break;
    }
    return "open";
}

bool leadsOutside(const geometry::PatchMesh& mesh, size_t patch) {
    return mesh.twin[patch] == geometry::kNoTwin && mesh.materials[mesh.material[patch]].isOpening();
}

} // namespace

WindowState parseWindowState(const std::string& text) {
    WindowState state;
    const size_t equals = text.rfind('=');
    if (equals != std::string::npos) state.material = text.substr(0, equals);
    const std::string words = equals == std::string::npos ? text : text.substr(equals + 1);
    const size_t colon = std::min(words.find(':'), words.size());
    const std::string kind = words.substr(0, colon),
                      rest = colon < words.size() ? words.substr(colon + 1) : "";
    Blind& blind = state.blind;
    if (kind == "fabric" && colon < words.size()) {
        const auto v =
            numbersOf(rest, text, 1, {{"the transmittance", 0, 1, 0}, {"the reflectance", 0, 0.999, -1}});
        blind.kind = Blind::Kind::fabric;
        blind.transmittance = static_cast<float>(v[0]);
        // What is not said: half of what does not pass, as of middling fabrics.
        blind.reflectance = static_cast<float>(v[1] < 0 ? 0.5 * (1 - v[0]) : v[1]);
        if (double{blind.transmittance} + double{blind.reflectance} > 1 + 1e-6)
            throw geometry::InputError(
                "--blinds", "", fmt::format("'{}': a fabric cannot pass and reflect more than 1", text));
    } else if (kind == "slats" && colon < words.size()) {
        const auto v = numbersOf(
            rest, text, 1,
            {{"the angle", -85, 85, 0}, {"the reflectance", 0, 0.999, 0.7}, {"the spacing", 0.05, 10, 0.8}});
        blind.kind = Blind::Kind::slats;
        blind.slatAngleDeg = static_cast<float>(v[0]);
        blind.reflectance = static_cast<float>(v[1]);
        blind.slatSpacing = static_cast<float>(v[2]);
    } else if (words != "open") {
        throw geometry::InputError(
            "--blinds", "",
            fmt::format(
                "'{}' is no state, expected [MATERIAL=] open, fabric:T[,R] or slats:ANGLE[,R[,SPACING]]",
                text));
    }
    return state;
}

void drawBlinds(Run& run, const std::vector<std::string>& states, geometry::PatchMesh& mesh) {
    if (states.empty()) return;
    std::map<uint32_t, std::optional<Blind>> drawn; // materials of openings that lead outside
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (leadsOutside(mesh, i)) drawn[mesh.material[i]];
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
    nlohmann::json report = nlohmann::json::array();
    std::map<uint32_t, uint32_t> shaded; // a material of its own: interior windows may share the old one
    for (const auto& [material, blind] : drawn) {
        if (!blind) continue;
        const geometry::Material m = daylight::withBlind(mesh.materials[material], *blind);
        report.push_back({{"window", m.name},
                          {"state", stateName(*blind)},
                          {"diffuse_transmittance", daylight::Window(m).diffuseTransmittance().y},
                          {"room_reflectance", m.reflectance.y}});
        if (blind->kind == Blind::Kind::none) continue;
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
