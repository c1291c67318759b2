// A model file -> closed rooms (geometry/model_rooms.h), of its panes as drawn or as rooms need them.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/air_pocket.h"
#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/crossing_solids.h"
#include "geometry/dark_rooms.h"
#include "geometry/doubled_faces.h"
#include "geometry/doubled_glass.h"
#include "geometry/drawn_rooms.h"
#include "geometry/face_soup.h"
#include "geometry/glass_panes.h"
#include "geometry/glass_use.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/input_error.h"
#include "geometry/last_decimal.h"
#include "geometry/model_faces.h"
#include "geometry/model_file.h"
#include "geometry/model_rooms.h"
#include "geometry/open_sheets.h"
#include "geometry/outline_area.h"
#include "geometry/panes_within_room.h"
#include "geometry/raw_model.h"
#include "geometry/refused_model.h"
#include "geometry/room_measures.h"
#include "geometry/seen_boards.h"
#include "geometry/sheet_boards.h"
#include "geometry/sheet_surroundings.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"
#include "geometry/small_rooms.h"
#include "geometry/space_parts.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

// Of a pane's diagonal: what is farther off does not bound the hole that it was drawn for.
constexpr double kMostGap = 0.1;

// Of all glass: what is longer, as terrain and the ground, says nothing of how small the parts of rooms are
// (a hall of 60 m may have one window of 4).
constexpr double kMostOfGlass = 16;

// Of the last decimal: how far off corners that were meant to be one, or on a face, may be; that, and more
// where it does not do.
constexpr std::array kRoundingApart{1.5, 2.5};
constexpr double kMostRounding = 2e-4; // of the extent: 1 mm in a room of 5 m

// Metres of building: sheets in rooms are boards of that thickness, or lie on walls no farther behind.
constexpr double kBoard = 1e-3, kNearWall = 0.02;
constexpr double kBoardOfTolerance = 8; // at least

constexpr double kLeastRoom = 0.1; // cubic metres of building

class ModelImporter {
public:
    // `model`: turned to y up.
    ModelImporter(const RawModel& model, const ImportOptions& options, double coarser = 1)
        : model_(model), givenScale_(options.worldPerBuilding) {
        const double all = extentOf([](uint32_t) { return true; });
        if (!(all > 0)) throw model_.errorAt(0, "all faces lie in one point");
        const double glass = extentOf(isGlass_);
        extent_ = coarser * (glass > 0 ? std::min(all, kMostOfGlass * glass) : all);
        faces_ = flatFaces(model_, extent_, worldPerBuilding(model_.vertices), coarser);
        faces_.dropped += dropDoubledGlass(faces_.soup, isGlass_, kWeldOfExtent * extent_);
        faces_.dropped += dropDoubledFaces(faces_.soup, isGlass_, kWeldOfExtent * extent_);
    }

    // World metres: the last decimal of the coordinates, where the rooms are many times larger; 0: none.
    double rounding() const {
        const double step = lastDecimal(model_.vertices, kWeldOfExtent * extent_ / kRoundingApart.back());
        return step < kMostRounding * extent_ ? step : 0;
    }
    double extent() const { return extent_; }
    // World metres, or a point of the world, in metres of the building.
    template<class Lengths> Lengths inBuilding(Lengths metres) const {
        return metres / worldPerBuilding(model_.vertices);
    }
    InputError withHint(const InputError& error) const { return {error, model_.doWithoutNamed(error.what())}; }
    RefusedModel refused(const InputError& error) const {
        return refusedModel(model_, error.where(), extent_, worldPerBuilding(model_.vertices));
    }

    // Where all else is refused, sheets that stand in rooms are thin boards.
    Building import(const std::function<void()>& beforePart) {
        const ModelFaces drawn = faces_;
        try {
            return importSolids(beforePart);
        } catch (const InputError&) {
            faces_ = drawn;
            for (WithBoards& with : withBoards()) {
                faces_ = std::move(with.faces);
                try {
                    Building made = importSolids(beforePart, with.boards);
                    if (!hasInsideOfWalls(made)) return made;
                } catch (const InputError&) { // what was wrong before says more
                }
            }
            if (coveredPane_) throw InputError(*coveredPane_);
            throw;
        }
    }

    void refuseInsideOfWalls(const Building& made) const {
        const auto pocket = airPocket(made, kWeldOfExtent * extent_);
        if (!pocket) return;
        const glm::dvec3 at = inBuilding(pocket->hole);
        throw InputError(
            model_.file, "",
            fmt::format("the only closed space is the inside of the walls: the room needs glass "
                        "in its hole, about {:.2g} m wide and {:.2g} m high, near x {:.2f}, y {:.2f}, "
                        "z {:.2f} m (y up)",
                        inBuilding(pocket->width), inBuilding(pocket->height), at.x, at.y, at.z),
            {{}, {pocket->hole, pocket->hole}});
    }

private:
    // As drawn, but that solids which run into one another are one; where that is refused or the insides of
    // walls come out as rooms, with those that touch as one, too. `boards`: made of sheets; refused where
    // these get lost.
    Building importSolids(const std::function<void()>& beforePart, const std::vector<SoupFace>& boards = {}) {
        const ModelFaces drawn = faces_;
        std::optional<Building> doubtful;
        std::optional<InputError> wrong;
        const auto attempt = [&]() -> std::optional<Building> {
            strays_.clear(), whyNoPane_.reset(), insideOut_ = false;
            try {
                Building made = importAsDrawnOrFitted(beforePart);
                if (!hasInsideOfWalls(made)) return made;
                if (!doubtful) doubtful = std::move(made);
            } catch (const InputError& error) {
                if (!wrong) wrong = error;
            }
            return std::nullopt;
        };
        const bool cross = unite(Solids::thatCross);
        if (auto made = attempt()) return std::move(*made);
        faces_ = drawn;
        if (unite(Solids::thatMeet))
            if (auto made = attempt()) return std::move(*made);
        if (doubtful) return std::move(*doubtful);
        faces_ = drawn;
        if (cross) {
            faces_.warnings.emplace_back(
                "solids run into one another, and were not united, as no room was left: what "
                "runs into walls is not seen in rooms");
            auto made = attempt();
            if (!made) made = std::move(doubtful);
            if (made && areBoardsSeen(boards, *made, kWeldOfExtent * extent_)) return std::move(*made);
        }
        if (!faces_.folded.empty()) throw InputError(foldError(*faces_.folded.begin()), doubtsOfGlass());
        unite(Solids::thatMeet);
        if (!whyNoPane_ && isOfWallsAlone()) // what is wrong with glass says more
            throw InputError(model_.file, "",
                             "encloses no room: all that is closed is as thin as walls and slabs, and they "
                             "close nothing in between (a ceiling or a wall is missing, or there are gaps)");
        throw InputError(*wrong, doubtsOfGlass());
    }

    // Solids without a room between them: what is wrong with these as rooms says nothing.
    bool isOfWallsAlone() const {
        const auto space = partsOfSpace(faces_.soup, isGlass_, kWeldOfExtent * extent_);
        return space && std::ranges::all_of(space->parts, [&](const auto& entry) {
                   const SpacePart& part = entry.second;
                   RoomMeasures measures;
                   measures.volume = part.volume, measures.surface = part.area;
                   return part.volume <= 0 ||
                          isLikeInsideOfWalls(measures, worldPerBuilding(model_.vertices));
               });
    }

    // Glass that was read as a wall is what keeps many a model from closing.
    std::string doubtsOfGlass() const {
        std::string out;
        for (const auto& [material, doubt] : model_.doubts)
            if (std::ranges::find(model_.material, material) != model_.material.end()) out += "; " + doubt;
        return out;
    }

    struct WithBoards {
        ModelFaces faces;
        std::vector<SoupFace> boards; // those among them
    };

    // In the ways that sheetsAsBoards() has.
    std::vector<WithBoards> withBoards() {
        const std::vector<SoupFace> drawn = faces_.soup;
        unite(Solids::thatCross);
        const double scale = worldPerBuilding(model_.vertices), tolerance = kWeldOfExtent * extent_;
        const double thickness = std::max(kBoard * scale, kBoardOfTolerance * tolerance);
        std::vector<WithBoards> out;
        for (SheetBoards& boards :
             sheetsAsBoards(faces_.soup, drawn, isGlass_, thickness, kNearWall * scale, tolerance)) {
            const auto first = boards.faces.begin() + static_cast<ptrdiff_t>(boards.first);
            ModelFaces& faces = out.emplace_back(faces_, std::vector(first, boards.faces.end())).faces;
            faces.soup = std::move(boards.faces);
            faces.warnings.push_back(fmt::format(
                "{} (the first at {}) in rooms enclose nothing: taken as boards {:.2g} m thick, or that "
                "lie on the wall or floor which is right behind",
                counted(boards.sheets, "face"), model_.place(boards.surface), inBuilding(thickness)));
        }
        return out;
    }

    bool hasInsideOfWalls(const Building& building) const {
        return building.roomCount > 1 &&
               std::ranges::any_of(measureRooms(ownTriangles(building)), [&](const RoomMeasures& room) {
                   return isLikeInsideOfWalls(room, worldPerBuilding(building.vertices));
               });
    }

    // False where there are none.
    bool unite(Solids which) {
        const auto united = uniteSolids(faces_.soup, isGlass_, which, kWeldOfExtent * extent_);
        if (!united) return false;
        faces_.soup = united->faces;
        faces_.outside.insert(faces_.outside.end(), united->beyond.begin(), united->beyond.end());
        std::ranges::move(warningsOf(*united, which, [&](uint32_t f) { return model_.place(f); }),
                          std::back_inserter(faces_.warnings));
        return true;
    }

    Building importAsDrawnOrFitted(const std::function<void()>& beforePart) {
        std::optional<InputError> asDrawn, blocks;
        auto made = importPanes(Drawn::slabs, beforePart);
        if (!made && !insideOut_) {
            try {
                ModelRooms drawn = rooms({}, beforePart);
                if (const auto touching = touchingRoomsOfGlass(drawn, isGlass_))
                    blocks = model_.errorAt(
                        *touching, "bodies of glass that touch, mitred or too many, fill no hole together: "
                                   "expected slabs that end on one another's sides, or flat panes");
                else {
                    if (const auto body = roomOfGlass(drawn, isGlass_))
                        drawn.building.warnings.push_back(fmt::format(
                            "a body of glass ({} and others) fills no hole as a pane does and was taken as a "
                            "space of its own: what passes it is dimmed by glass on either side",
                            model_.place(*body)));
                    made = withGlass(std::move(drawn));
                }
            } catch (const InputError& error) {
                asDrawn = error;
            }
        }
        if (made && made->use.without.empty()) return std::move(made->building);
        auto fitted = importPanes(Drawn::slabsAndFlat, beforePart);
        if (fitted && (!made || fitted->use.panes > made->use.panes)) return saidOfGlass(std::move(*fitted));
        if (made && made->use.panes > 0) return saidOfGlass(std::move(*made));
        if (blocks) throw *blocks;
        if (whyNoPane_) throw *whyNoPane_;
        if (asDrawn) throw *asDrawn;
        throw model_.errorAt(
            made->use.without[0],
            "the glass bounds no room, nor does any other: something crosses it, or the model is "
            "open elsewhere, as where a door in a thick wall is not drawn");
    }

    struct WithGlass {
        Building building;
        GlassUse use;
    };

    Building saidOfGlass(WithGlass made) {
        if (made.use.without.empty()) return std::move(made.building);
        if (areAllSmall(made.building, leastRoom()))
            throw model_.errorAt(
                made.use.without[0],
                fmt::format("the glass bounds no room, and all that is closed holds less than {} "
                            "m3: the model is open elsewhere, as by a hole without a pane or a "
                            "gap round a frame",
                            kLeastRoom));
        made.building.warnings.push_back(warningOf(made.use, [&](uint32_t f) { return model_.place(f); }));
        return std::move(made.building);
    }

    double worldPerBuilding(std::span<const glm::dvec3> corners) const {
        return givenScale_.value_or(assumedWorldPerBuilding(corners));
    }

    double leastRoom() const { // cubic world metres
        const double scale = worldPerBuilding(model_.vertices);
        return kLeastRoom * scale * scale * scale;
    }

    // Diagonal of the faces of some materials, world metres; negative where there are none.
    double extentOf(const std::function<bool(uint32_t)>& isOne) const {
        glm::dvec3 low(1e300), high(-1e300);
        for (size_t f = 0; f < model_.faceCount(); ++f) {
            if (!isOne(model_.material[f])) continue;
            for (const uint32_t v : model_.face(f)) {
                low = glm::min(low, model_.vertices[v]);
                high = glm::max(high, model_.vertices[v]);
            }
        }
        return high.x < low.x ? -1 : glm::length(high - low);
    }

    // With room for the glass of panes that have one room on both sides, where nothing else is refused.
    ModelRooms rooms(const std::set<uint32_t>& made, const std::function<void()>& beforePart) {
        try {
            return roomsOf(faces_, made, beforePart);
        } catch (const InputError& wrong) {
            auto within = panesWithinRoom(faces_.soup, isGlass_, kWeldOfExtent * extent_);
            if (!within) throw;
            if (const auto covered = within->covered) {
                coveredPane_ = model_.errorAt(
                    covered->first, fmt::format("an opening and a wall ({}) lie on one another, expected a "
                                                "hole in the wall there",
                                                model_.place(covered->second)));
                throw InputError(*coveredPane_);
            }
            ModelFaces faces = faces_;
            faces.soup = std::move(within->soup);
            for (const bool exact : {false, true}) // closing gaps closes what is between glass and boards
                try {
                    faces.exact = exact;
                    ModelRooms out = roomsOf(faces, made, beforePart);
                    out.building.repairs.push_back(
                        fmt::format("{} with one room on both sides: seen through, as glass with a thickness",
                                    counted(within->panes, "pane")));
                    return out;
                } catch (const InputError&) { // what was wrong before says more
                }
            throw InputError(wrong);
        }
    }

    ModelRooms roomsOf(const ModelFaces& faces, const std::set<uint32_t>& made,
                       const std::function<void()>& beforePart) const {
        std::optional<ModelRooms> out;
        try {
            out = roomsOfModel(model_, faces, extent_, made, beforePart);
        } catch (const InputError&) {
            out = roomsBesideSheets(faces, made, beforePart);
            if (!out) throw;
        }
        if (!out->sheets.empty()) {
            const GroundOutside sheets{std::exchange(out->sheets, {}), {}, {}};
            judge(sheets, solidsAmong(faces.soup, *out), false, *out);
        }
        leaveOutSmallRooms(*out);
        std::ranges::move(
            warningsOfDarkRooms(*out, model_, worldPerBuilding(model_.vertices), kPlanarOfExtent * extent_),
            std::back_inserter(out->building.warnings));
        return std::move(*out);
    }

    void leaveOutSmallRooms(ModelRooms& rooms) const {
        const SmallRooms small = leaveOutSmall(rooms, leastRoom());
        if (small.left > 0)
            rooms.building.warnings.push_back(fmt::format(
                "{} less than {} m3 (the first has the face at {}): left out, as no rooms",
                small.left == 1 ? "1 closed space holds" : fmt::format("{} closed spaces hold", small.left),
                kLeastRoom, model_.place(small.surface)));
    }

    InputError foldError(const std::pair<const uint32_t, double>& folded) const {
        return model_.errorAt(folded.first,
                              fmt::format("the face is not planar, it is bent by {:.2g} m: divide it into "
                                          "triangles where it should fold",
                                          inBuilding(folded.second)));
    }

    // Where nothing but open sheets outside of them keeps the model from closing, or the ground drawn as a
    // solid that rooms reach into.
    std::optional<ModelRooms> roomsBesideSheets(const ModelFaces& all, const std::set<uint32_t>& made,
                                                const std::function<void()>& beforePart) const {
        const double tolerance = kWeldOfExtent * extent_;
        std::optional<OpenSheets> sheets = openSheets(all.soup, isGlass_, tolerance);
        if (sheets)
            if (auto out = roomsBeside(all, *sheets, made, beforePart)) return out;
        auto solid = openGround(sheets ? sheets->closed : all.soup, isGlass_, tolerance);
        if (!solid) return std::nullopt;
        if (sheets) solid->open.insert(solid->open.end(), sheets->open.begin(), sheets->open.end());
        return roomsBeside(all, *solid, made, beforePart);
    }

    std::optional<ModelRooms> roomsBeside(const ModelFaces& all, const OpenSheets& sheets,
                                          const std::set<uint32_t>& made,
                                          const std::function<void()>& beforePart) const {
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
                return roomsOfModel(model_, faces, extent_, made, beforePart);
            } catch (const InputError&) {
                return std::nullopt;
            }
        };
        auto out = roomsAmong(sheets.open);
        if (!out) return std::nullopt;
        GroundOutside ground = groundOutside(
            sheets.open, out->building, worldPerBuilding(out->building.vertices), kPlanarOfExtent * extent_);
        if (ground.surface) out = roomsAmong(ground.sheets);
        if (!out) return std::nullopt;
        std::ranges::move(std::exchange(out->sheets, {}), std::back_inserter(ground.sheets));
        judge(ground, solidsAmong(sheets.closed, *out), lookIn(faces_.soup, *out), *out);
        return out;
    }

    // Warns of sheets, or throws where they are none that stand outside. `looksIn`: as judgeSheets() has it.
    void judge(const GroundOutside& ground, const std::vector<SoupFace>& solids, bool looksIn,
               ModelRooms& rooms) const {
        if (ground.onGlass)
            throw model_.errorAt(
                *ground.onGlass,
                "the ground is drawn through the glass of a window, expected it to end there");
        const SheetVerdict verdict =
            judgeSheets(ground.sheets, rooms.building, solids, looksIn,
                        worldPerBuilding(rooms.building.vertices), kPlanarOfExtent * extent_);
        if (verdict.fault)
            throw model_.errorAt(
                verdict.fault->surface,
                fmt::format("the model is not closed: this face {} (what is open has to stand outside of "
                            "rooms)",
                            verdict.fault->words));
        std::vector<std::string>& warnings = rooms.building.warnings;
        const auto place = [&](uint32_t f) { return model_.place(f); };
        warnings.push_back(sheetsOutside(ground.sheets, place));
        if (ground.surface)
            warnings.push_back(fmt::format("the ground ({} and others of it) runs on through rooms: what "
                                           "lies in them was left out, their floors are as drawn",
                                           model_.place(*ground.surface)));
        std::ranges::move(warningsOf(verdict, place, rooms.source), std::back_inserter(warnings));
    }

    WithGlass withGlass(ModelRooms rooms) const {
        GlassUse use = useOfGlass(faces_.soup, isGlass_, rooms);
        return {std::move(rooms.building), std::move(use)};
    }

    // With other panes than are drawn; none where there are none, or not even these make rooms.
    std::optional<WithGlass> importPanes(Drawn drawn, const std::function<void()>& beforePart) {
        auto panes = panesInHoles(faces_.soup, isGlass_, kWeldOfExtent * extent_, drawn);
        if (!panes) return std::nullopt;
        const size_t materials = model_.materials.size();
        if (!panes->edges.empty()) model_.materials.push_back({.name = "edge of glass"});
        for (const uint32_t f : panes->edges) panes->soup[f].material = static_cast<uint32_t>(materials);
        std::optional<WithGlass> out = tryPanes(*panes, beforePart);
        while (!out && leaveOutFree(*panes, std::exchange(strays_, {}))) out = tryPanes(*panes, beforePart);
        model_.materials.resize(materials);
        return out;
    }

    std::optional<WithGlass> tryPanes(PanesInHoles& panes, const std::function<void()>& beforePart) {
        std::swap(faces_.soup, panes.soup);
        std::optional<WithGlass> out;
        try {
            ModelRooms made = rooms({panes.made.begin(), panes.made.end()}, beforePart);
            const std::vector<bool> inRoom = areInRooms(made, panes.loose);
            for (size_t k = 0; k < inRoom.size(); ++k)
                if (panes.loose[k].kept && !inRoom[k]) strays_.insert(panes.loose[k].faces[0]);
            if (const auto error = wrongGlass(made, panes, inRoom)) {
                insideOut_ = true;
                throw *error;
            }
            if (!strays_.empty())
                throw model_.errorAt(*strays_.begin(), "the glass stands outside of all rooms");
            reportGlass(panes, made.building, [&](uint32_t f) { return model_.place(f); });
            out = withGlass(std::move(made));
        } catch (const InputError& error) {
            whyNoPane_ = reasonOf(panes, error);
        }
        std::swap(faces_.soup, panes.soup);
        return out;
    }

    // What says most of why panes as they would have to be make no rooms; none where that is what is wrong as
    // they are drawn.
    std::optional<InputError> reasonOf(const PanesInHoles& panes, const InputError& error) const {
        for (const LooseGlass& glass : panes.loose)
            if (glass.joint) return jointError(glass);
        if (panes.openFlat) return jointError(*panes.openFlat);
        if (panes.slabs + panes.loose.size() > 0) return error;
        return whyNoPane_;
    }

    InputError jointError(const LooseGlass& glass) const {
        if (*glass.joint > kMostGap * glass.diagonal)
            return model_.errorAt(
                glass.faces[0],
                "the glass fills no hole, as a leaf that stands open or a flat pane that stands free");
        return model_.errorAt(
            glass.faces[0],
            fmt::format("a gap of {:.2g} m is left between the glass and the hole in which it stands, "
                        "expected at most 0.5 % of its diagonal",
                        inBuilding(*glass.joint)));
    }

    // Panes that no room has, or glass in a hole and not in a room: air and walls are taken for one another.
    std::optional<InputError> wrongGlass(const ModelRooms& rooms, const PanesInHoles& panes,
                                         const std::vector<bool>& inRoom) const {
        const std::set<uint32_t> made(panes.made.begin(), panes.made.end());
        if (!made.empty() && std::ranges::none_of(rooms.source, [&](uint32_t f) { return made.contains(f); }))
            return model_.errorAt(
                panes.made[0],
                "the glass fills a hole but bounds no room: the model is open elsewhere, as by "
                "a hole without a pane or a gap round a frame" +
                    (panes.loose.empty()
                         ? ""
                         : " (the glass at " + model_.place(panes.loose[0].faces[0]) + " fills none)"));
        const bool dark = std::ranges::none_of(rooms.building.faces,
                                               [&](const Face& face) { return isGlass_(face.material); });
        for (size_t k = 0; k < inRoom.size(); ++k) {
            const LooseGlass& glass = panes.loose[k];
            if (glass.joint && !inRoom[k]) return jointError(glass);
            if (dark)
                return model_.errorAt(
                    glass.faces[0],
                    "the glass fills no hole, and no other glass bounds a room, expected a slab "
                    "as wide as its hole and at most a fifth as thick, or flat panes round a corner");
        }
        return std::nullopt;
    }

    RawModel model_;
    std::optional<double> givenScale_; // world metres a metre of building
    std::function<bool(uint32_t)> isGlass_ = [this](uint32_t m) { return model_.materials[m].isOpening(); };
    ModelFaces faces_;
    std::set<uint32_t> strays_; // the first faces of glass that stands free, but not in a room
    std::optional<InputError> whyNoPane_;
    std::optional<InputError> coveredPane_; // with one room on both sides
    bool insideOut_ = false;                // with panes that fit, what is drawn bounds the inside of walls
    double extent_ = 0;
};

} // namespace

double assumedWorldPerBuilding(std::span<const glm::dvec3> corners) {
    constexpr double kLowestRoom = 1.0; // metres: nobody works in less
    const Bounds box = boundsOf(corners);
    return box.high.y - box.low.y < kLowestRoom ? 1.0 / 12 : 1.0;
}

Building importModel(const std::filesystem::path& file, UpAxis up, const ImportOptions& options) {
    const SheetMemory memory;
    RawModel model = readRawModel(file, options.materials);
    for (glm::dvec3& p : model.vertices) p = worldFromModel(p, up);
    model.up = up;
    ModelImporter importer(model, options);
    const double step = importer.rounding();
    try {
        Building made = importer.import(options.beforePart);
        importer.refuseInsideOfWalls(made);
        return made;
    } catch (const InputError& error) {
        for (const double apart : kRoundingApart) {
            const double coarser = apart * step / (kWeldOfExtent * importer.extent());
            if (coarser <= 1) continue;
            try {
                Building made = ModelImporter(model, options, coarser).import(options.beforePart);
                made.warnings.push_back(fmt::format("coordinates are rounded to {:.1g} m, and as they are "
                                                    "enclose no room: what is no farther apart than "
                                                    "{:.2g} m was taken to touch",
                                                    importer.inBuilding(step),
                                                    importer.inBuilding(apart * step)));
                return made;
            } catch (const InputError&) { // what was wrong before says more
            }
        }
        if (options.onRefusal) options.onRefusal(importer.refused(error));
        throw importer.withHint(error);
    }
}

} // namespace heliodon::geometry
