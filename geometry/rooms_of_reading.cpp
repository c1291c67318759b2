#include "geometry/rooms_of_reading.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/counted.h"
#include "geometry/dark_rooms.h"
#include "geometry/drawn_rooms.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/open_sheets.h"
#include "geometry/panes_within_room.h"
#include "geometry/sheet_surroundings.h"
#include "geometry/shell_faces.h"
#include "geometry/small_rooms.h"

namespace heliodon::geometry {

namespace {

// Warns of sheets of `all`, or throws where they are none that stand outside. `looksIn`: as judgeSheets() has
// it.
void judge(const ModelReading& reading, const ModelFaces& all, const GroundOutside& ground,
           const std::vector<SoupFace>& solids, bool looksIn, ModelRooms& rooms) {
    if (ground.onGlass)
        throw reading.model.errorAt(
            *ground.onGlass, "the ground is drawn through the glass of a window, expected it to end there");
    const SheetVerdict verdict =
        judgeSheets(ground.sheets, rooms.building, solids, looksIn,
                    reading.worldPerBuilding(rooms.building.vertices), reading.flatness());
    if (verdict.fault)
        throw reading.model.openAt(
            verdict.fault->surface,
            fmt::format("the model is not closed: this face {} (what is open has to stand outside of "
                        "rooms)",
                        verdict.fault->words));
    std::vector<std::string>& warnings = rooms.building.warnings;
    const auto place = reading.place();
    std::vector<SoupFace> outside = ground.sheets;
    std::erase_if(outside, [&](const SoupFace& sheet) { return all.boards.contains(sheet.surface); });
    if (!outside.empty()) warnings.push_back(sheetsOutside(outside, place));
    if (ground.surface)
        warnings.push_back(fmt::format("the ground ({} and others of it) runs on through rooms: what "
                                       "lies in them was left out, their floors are as drawn",
                                       reading.model.place(*ground.surface)));
    std::ranges::move(warningsOf(verdict, place, rooms.source), std::back_inserter(warnings));
}

std::optional<ModelRooms> roomsBeside(const ModelReading& reading, const ModelFaces& all,
                                      const OpenSheets& sheets, const std::set<uint32_t>& made) {
    const auto roomsAmong = [&](const std::vector<SoupFace>& open) -> std::optional<ModelRooms> {
        ModelFaces faces = all;
        faces.soup = sheets.closed;
        for (const SoupFace& sheet : open)
            for (const bool over : {false, true}) {
                SoupFace& side = faces.outside.emplace_back(sheet);
                if (!over) continue;
                turnOver(side);
                side.material = sheet.behind.value_or(sheet.material);
            }
        try {
            return roomsOfModel(reading.model, faces, reading.extent, made, reading.beforePart);
        } catch (const InputError&) {
            return std::nullopt;
        }
    };
    auto out = roomsAmong(sheets.open);
    if (!out) return std::nullopt;
    GroundOutside ground = groundOutside(
        sheets.open, out->building, reading.worldPerBuilding(out->building.vertices), reading.flatness());
    if (ground.surface) out = roomsAmong(ground.sheets);
    if (!out) return std::nullopt;
    std::ranges::move(std::exchange(out->sheets, {}), std::back_inserter(ground.sheets));
    judge(reading, all, ground, solidsAmong(sheets.closed, *out), lookIn(all.soup, *out), *out);
    return out;
}

// Where nothing but open sheets outside of them keeps the model from closing, or the ground drawn as a
// solid that rooms reach into.
std::optional<ModelRooms> roomsBesideSheets(const ModelReading& reading, const ModelFaces& all,
                                            const std::set<uint32_t>& made) {
    const double tolerance = reading.tolerance();
    std::optional<OpenSheets> sheets = openSheets(all.soup, reading.isGlass(), tolerance);
    if (sheets)
        if (auto out = roomsBeside(reading, all, *sheets, made)) return out;
    auto solid = openGround(sheets ? sheets->closed : all.soup, reading.isGlass(), tolerance);
    if (!solid) return std::nullopt;
    if (sheets) solid->open.insert(solid->open.end(), sheets->open.begin(), sheets->open.end());
    return roomsBeside(reading, all, *solid, made);
}

void leaveOutSmallRooms(const ModelReading& reading, ModelRooms& rooms) {
    const SmallRooms small = leaveOutSmall(rooms, leastRoom(reading.worldPerBuilding()));
    if (small.left > 0)
        rooms.building.warnings.push_back(fmt::format(
            "{} less than {} m3 (the first has the face at {}): left out, as no rooms",
            small.left == 1 ? "1 closed space holds" : fmt::format("{} closed spaces hold", small.left),
            kLeastRoom, reading.model.place(small.surface)));
}

ModelRooms roomsOrBeside(const ModelReading& reading, const ModelFaces& faces,
                         const std::set<uint32_t>& made) {
    std::optional<ModelRooms> out;
    try {
        out = roomsOfModel(reading.model, faces, reading.extent, made, reading.beforePart);
    } catch (const InputError&) {
        out = roomsBesideSheets(reading, faces, made);
        if (!out) throw;
    }
    if (!out->sheets.empty()) {
        const GroundOutside sheets{std::exchange(out->sheets, {}), {}, {}};
        judge(reading, faces, sheets, solidsAmong(faces.soup, *out), false, *out);
    }
    leaveOutSmallRooms(reading, *out);
    std::ranges::move(
        warningsOfDarkRooms(*out, reading.model, reading.worldPerBuilding(), reading.flatness()),
        std::back_inserter(out->building.warnings));
    return std::move(*out);
}

} // namespace

ModelRooms roomsOfReading(ModelReading& reading, const ModelFaces& drawn, const std::set<uint32_t>& made) {
    try {
        return roomsOrBeside(reading, drawn, made);
    } catch (const InputError& wrong) {
        auto within = panesWithinRoom(drawn.soup, reading.isGlass(), reading.tolerance());
        if (!within) throw;
        if (const auto covered = within->covered) {
            reading.coveredPane = reading.model.errorAt(
                covered->first, fmt::format("an opening and a wall ({}) lie on one another, expected a "
                                            "hole in the wall there",
                                            reading.model.place(covered->second)));
            throw InputError(*reading.coveredPane);
        }
        ModelFaces faces = drawn;
        faces.soup = std::move(within->soup);
        for (const bool exact : {false, true}) // closing gaps closes what is between glass and boards
            try {
                faces.exact = exact;
                ModelRooms out = roomsOrBeside(reading, faces, made);
                out.building.repairs.push_back(
                    fmt::format("{} with one room on both sides: seen through, as glass with a thickness",
                                counted(within->panes, "pane")));
                return out;
            } catch (const InputError&) { // what was wrong before says more
            }
        throw InputError(wrong);
    }
}

} // namespace heliodon::geometry
