// A model file -> closed rooms (geometry/glazed_rooms.h): solids and sheets as drawn, or as rooms need them.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/air_pocket.h"
#include "geometry/counted.h"
#include "geometry/crossing_solids.h"
#include "geometry/double_glazing.h"
#include "geometry/doubled_faces.h"
#include "geometry/doubled_glass.h"
#include "geometry/face_soup.h"
#include "geometry/glazed_rooms.h"
#include "geometry/input_error.h"
#include "geometry/last_decimal.h"
#include "geometry/model_faces.h"
#include "geometry/model_file.h"
#include "geometry/model_reading.h"
#include "geometry/named_leak.h"
#include "geometry/raw_model.h"
#include "geometry/refused_model.h"
#include "geometry/room_measures.h"
#include "geometry/seen_boards.h"
#include "geometry/sheet_boards.h"
#include "geometry/sheet_walls.h"
#include "geometry/shell_faces.h"
#include "geometry/space_parts.h"
#include "geometry/space_sheets.h"
#include "geometry/turned_faces.h"

namespace heliodon::geometry {

namespace {

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
// Panes in one frame are no farther apart; two windows with a sill between them are.
constexpr double kBetweenPanes = 0.1;

class ModelImporter {
public:
    // `model`: turned to y up.
    ModelImporter(const RawModel& model, const ImportOptions& options, double coarser = 1)
        : reading_{model, options.worldPerBuilding, options.beforePart} {
        const double all = extentOf([](uint32_t) { return true; });
        if (!(all > 0)) throw reading_.model.errorAt(0, "all faces lie in one point");
        const double glass = extentOf(reading_.isGlass());
        reading_.extent = coarser * (glass > 0 ? std::min(all, kMostOfGlass * glass) : all);
        faces_ = flatFaces(reading_.model, reading_.extent, reading_.worldPerBuilding(), coarser);
        faces_.dropped += dropDoubledGlass(faces_.soup, reading_.isGlass(), reading_.tolerance());
        faces_.dropped += dropDoubledFaces(faces_.soup, reading_.isGlass(), reading_.tolerance());
        faces_.turnedOver = turnAlike(faces_.soup, reading_.isGlass(), reading_.tolerance());
    }

    // World metres: the last decimal or bit of the coordinates, where the rooms are many times larger; 0:
    // none.
    double rounding() const {
        const double least = reading_.tolerance() / kRoundingApart.back();
        double step = reading_.model.step > least ? reading_.model.step : 0;
        for (const auto& of : {lastDecimal, lastBit})
            step = std::max(step, of(reading_.model.vertices, least));
        return step < kMostRounding * reading_.extent ? step : 0;
    }
    const ModelReading& reading() const { return reading_; }
    // As the user has it.
    InputError named(const InputError& wrong) const {
        const InputError error =
            withLeak(wrong, reading_.model, reading_.extent, reading_.worldPerBuilding());
        return {error, reading_.model.doWithoutNamed(error)};
    }
    RefusedModel refused(const InputError& error) const {
        return refusedModel(reading_.model, error.where(), reading_.extent, reading_.worldPerBuilding());
    }

    // Where all else is refused, sheets that stand in rooms are thin boards.
    Building import() {
        const ModelFaces drawn = faces_;
        try {
            return importSolids();
        } catch (const InputError&) {
            faces_ = drawn;
            std::optional<InputError> onPane;
            for (WithBoards& with : withBoards()) {
                faces_ = std::move(with.faces);
                if (!onPane) onPane = boardOnPane(with.boards);
                try {
                    Building made = importSolids(with.boards);
                    if (insidesOfWalls(made) == 0) return made;
                } catch (const InputError&) { // what was wrong before says more
                }
            }
            if (reading_.coveredPane) throw InputError(*reading_.coveredPane);
            if (onPane) throw InputError(*onPane);
            throw;
        }
    }

    // Where it puts parts elsewhere, a model may close all the same.
    void warnOfRounding(Building& made) const {
        const double step = lastBit(reading_.model.vertices, kMostRounding * reading_.extent);
        if (step > 0)
            made.warnings.push_back(
                fmt::format("so far from the origin single precision rounds coordinates to "
                            "{:.2g} m, and sizes with them: export the model nearer to it",
                            reading_.inBuilding(step)));
    }

    void joinPanes(Building& made) const {
        const double scale = reading_.worldPerBuilding(made.vertices);
        const DoubleGlazing joined = geometry::joinPanes(made, kBetweenPanes * scale, reading_.tolerance());
        if (joined.spaces > 0)
            made.repairs.push_back(
                fmt::format("{} between panes (up to {:.2g} m deep) {}: each such window is one "
                            "that transmits the product of its panes",
                            counted(joined.spaces, "space"), joined.deepest / scale,
                            joined.spaces == 1 ? "is no room" : "are no rooms"));
    }

    bool isMostOfWalls(const Building& made) const { return 2 * insidesOfWalls(made) > made.roomCount; }

    void refuseInsideOfWalls(const Building& made) const {
        const auto pocket = airPocket(made, reading_.tolerance());
        if (!pocket) return;
        const glm::dvec3 at = reading_.inBuilding(pocket->hole);
        throw InputError(
            reading_.model.file, "",
            fmt::format("the only closed space is the inside of the walls: the room needs glass "
                        "in its hole, about {:.2g} m wide and {:.2g} m high, near x {:.2f}, y {:.2f}, "
                        "z {:.2f} m (y up)",
                        reading_.inBuilding(pocket->width), reading_.inBuilding(pocket->height), at.x, at.y,
                        at.z),
            {.border = {pocket->hole, pocket->hole}});
    }

private:
    // As drawn, but that solids which run into one another are one; where that is refused or the insides of
    // walls come out as rooms, with those that touch as one, too. `boards`: made of sheets; refused where
    // these get lost.
    Building importSolids(const std::vector<SoupFace>& boards = {}) {
        const ModelFaces drawn = faces_;
        std::optional<Building> doubtful;
        std::optional<InputError> wrong, whyNoPane;
        const auto attempt = [&]() -> std::optional<Building> {
            whyNoPane.reset();
            try {
                Building made = glazedRooms(reading_, faces_, whyNoPane);
                if (insidesOfWalls(made) == 0) return made;
                if (!doubtful) doubtful = std::move(made);
            } catch (const InputError& error) {
                if (!wrong) wrong = error;
            }
            return std::nullopt;
        };
        const bool cross = unite(Solids::thatCross);
        const bool byRounding = cross && faces_.warnings.size() == drawn.warnings.size();
        if (auto made = attempt()) return std::move(*made);
        faces_ = drawn;
        if (unite(Solids::thatMeet, byRounding))
            if (auto made = attempt()) return std::move(*made);
        if (doubtful) return std::move(*doubtful);
        faces_ = drawn;
        if (cross) {
            if (!byRounding)
                faces_.warnings.emplace_back(
                    "solids run into one another, and were not united, as no room was left: what "
                    "runs into walls is not seen in rooms");
            auto made = attempt();
            if (!made) made = std::move(doubtful);
            if (made && areBoardsSeen(boards, *made, reading_.tolerance())) return std::move(*made);
        }
        if (!faces_.folded.empty()) throw InputError(foldError(*faces_.folded.begin()), doubtsOfGlass());
        unite(Solids::thatMeet, byRounding);
        if (!whyNoPane && isOfWallsAlone()) // what is wrong with glass says more
            throw InputError(reading_.model.file, "",
                             "encloses no room: all that is closed is as thin as walls and slabs, and they "
                             "close nothing in between (a ceiling or a wall is missing, or there are gaps)",
                             {.isOpen = true});
        throw InputError(*wrong, doubtsOfGlass());
    }

    // Solids without a room between them: what is wrong with these as rooms says nothing.
    bool isOfWallsAlone() const {
        const auto space = partsOfSpace(faces_.soup, reading_.isGlass(), reading_.tolerance());
        return space && std::ranges::all_of(space->parts, [&](const auto& entry) {
                   const SpacePart& part = entry.second;
                   RoomMeasures measures;
                   measures.volume = part.volume, measures.surface = part.area;
                   return part.volume <= 0 || isLikeInsideOfWalls(measures, reading_.worldPerBuilding());
               });
    }

    // Glass that was read as a wall is what keeps many a model from closing.
    std::string doubtsOfGlass() const {
        std::string out;
        for (const auto& [material, doubt] : reading_.model.doubts)
            if (std::ranges::find(reading_.model.material, material) != reading_.model.material.end())
                out += "; " + doubt;
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
        const double scale = reading_.worldPerBuilding(), tolerance = reading_.tolerance();
        const double thickness = boardThickness();
        std::vector<WithBoards> out;
        for (SheetBoards& boards : sheetsAsBoards(faces_.soup, drawn, reading_.isGlass(), thickness,
                                                  kNearWall * scale, tolerance)) {
            const auto first = boards.faces.begin() + static_cast<ptrdiff_t>(boards.first);
            ModelFaces& faces = out.emplace_back(faces_, std::vector(first, boards.faces.end())).faces;
            for (const SoupFace& board : out.back().boards) faces.boards.insert(board.surface);
            faces.soup = std::move(boards.faces);
            faces.warnings.push_back(fmt::format(
                "{} (the first at {}) in rooms enclose nothing: taken as boards {:.2g} m thick, or that "
                "lie on the wall or floor which is right behind",
                counted(boards.sheets, "face"), reading_.model.place(boards.surface),
                reading_.inBuilding(thickness)));
        }
        return out;
    }

    double boardThickness() const {
        return std::max(kBoard * reading_.worldPerBuilding(), kBoardOfTolerance * reading_.tolerance());
    }

    // Nearer than boards are thick none is made of a sheet without the pane going: what a user can mend.
    std::optional<InputError> boardOnPane(const std::vector<SoupFace>& boards) const {
        std::vector<SoupFace> glass = faces_.soup;
        std::erase_if(glass, [&](const SoupFace& face) { return !reading_.isGlass()(face.material); });
        if (glass.empty()) return std::nullopt;
        const double tolerance = reading_.tolerance(), thickness = boardThickness();
        const SheetWalls panes(glass, tolerance);
        for (const FlatFace& face : flatFacesOf(weldedByNumber(boards, tolerance))) {
            if (face.triangles.empty()) continue;
            const glm::dvec3 middle = largestTriangle(face).middle();
            for (const double side : {1.0, -1.0})
                if (const auto pane = panes.faceAt(middle, side * face.normal, thickness))
                    return reading_.model.errorAt(
                        boards[face.surface].surface,
                        fmt::format("the face lies less than {:.2g} m from an opening ({}), expected it "
                                    "farther off",
                                    reading_.inBuilding(thickness),
                                    reading_.model.place(glass[*pane].surface)));
        }
        return std::nullopt;
    }

    // Of the rooms of several.
    size_t insidesOfWalls(const Building& building) const {
        return building.roomCount < 2
                   ? 0
                   : static_cast<size_t>(std::ranges::count_if(
                         measureVolumes(ownTriangles(building)), [&](const RoomMeasures& room) {
                             return isLikeInsideOfWalls(room, reading_.worldPerBuilding(building.vertices));
                         }));
    }

    // False where there are none. `byRounding`: nothing is said of what may meet others by that alone.
    bool unite(Solids which, bool byRounding = true) {
        const auto united = uniteSolids(faces_.soup, reading_.isGlass(), which, reading_.tolerance(),
                                        byRounding ? kRoundingApart.back() * rounding() : 0, faces_.boards);
        if (!united) return false;
        faces_.soup = united->faces;
        faces_.outside.insert(faces_.outside.end(), united->beyond.begin(), united->beyond.end());
        std::ranges::move(warningsOf(*united, which, reading_.place()), std::back_inserter(faces_.warnings));
        return true;
    }

    // Diagonal of the faces of some materials, world metres; negative where there are none.
    double extentOf(const std::function<bool(uint32_t)>& isOne) const {
        glm::dvec3 low(1e300), high(-1e300);
        for (size_t f = 0; f < reading_.model.faceCount(); ++f) {
            if (!isOne(reading_.model.material[f])) continue;
            for (const uint32_t v : reading_.model.face(f)) {
                low = glm::min(low, reading_.model.vertices[v]);
                high = glm::max(high, reading_.model.vertices[v]);
            }
        }
        return high.x < low.x ? -1 : glm::length(high - low);
    }

    InputError foldError(const std::pair<const uint32_t, double>& folded) const {
        return reading_.model.errorAt(
            folded.first, fmt::format("the face is not planar, it is bent by {:.2g} m: divide it into "
                                      "triangles where it should fold",
                                      reading_.inBuilding(folded.second)));
    }

    ModelReading reading_;
    ModelFaces faces_;
};

} // namespace

Building importModel(const std::filesystem::path& file, UpAxis up, const ImportOptions& options) {
    const SheetMemory memory;
    RawModel model = readRawModel(file, options.materials);
    for (glm::dvec3& p : model.vertices) p = worldFromModel(p, up);
    model.up = up;
    ModelImporter importer(model, options);
    const double step = importer.rounding();
    try {
        Building made = importer.import();
        importer.refuseInsideOfWalls(made);
        importer.joinPanes(made);
        importer.warnOfRounding(made);
        return made;
    } catch (const InputError& wrong) {
        for (const double apart : kRoundingApart) {
            const double coarser = apart * step / importer.reading().tolerance();
            if (coarser <= 1) continue;
            try {
                ModelImporter roughly(model, options, coarser);
                Building made = roughly.import();
                if (roughly.isMostOfWalls(made)) continue; // guessed twice
                made.warnings.push_back(fmt::format("coordinates are rounded to {:.1g} m, and as they are "
                                                    "enclose no room: what is no farther apart than "
                                                    "{:.2g} m was taken to touch",
                                                    importer.reading().inBuilding(step),
                                                    importer.reading().inBuilding(apart * step)));
                roughly.joinPanes(made);
                return made;
            } catch (const InputError&) { // what was wrong before says more
            }
        }
        const InputError error = importer.named(wrong);
        if (options.onRefusal) options.onRefusal(importer.refused(error));
        throw InputError(error);
    }
}

} // namespace heliodon::geometry
