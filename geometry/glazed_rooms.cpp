#include "geometry/glazed_rooms.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/drawn_rooms.h"
#include "geometry/face_soup.h"
#include "geometry/glass_panes.h"
#include "geometry/glass_use.h"
#include "geometry/rooms_of_reading.h"
#include "geometry/shell_faces.h"
#include "geometry/small_rooms.h"

namespace heliodon::geometry {

namespace {

// Of a pane's diagonal: what is farther off does not bound the hole that it was drawn for.
constexpr double kMostGap = 0.1;

struct WithGlass {
    Building building;
    GlassUse use;
};

class GlazedRooms {
public:
    GlazedRooms(ModelReading& reading, ModelFaces& faces, std::optional<InputError>& whyNoPane)
        : reading_(reading), faces_(faces), whyNoPane_(whyNoPane) {}

    Building find() {
        std::optional<InputError> asDrawn, blocks;
        auto made = importPanes(Drawn::slabs);
        if (!made && !insideOut_) {
            try {
                ModelRooms drawn = roomsOfReading(reading_, faces_, {});
                if (const auto touching = touchingRoomsOfGlass(drawn, reading_.isGlass()))
                    blocks = reading_.model.errorAt(
                        *touching, "bodies of glass that touch, mitred or too many, fill no hole together: "
                                   "expected slabs that end on one another's sides, or flat panes");
                else {
                    if (const auto body = roomOfGlass(drawn, reading_.isGlass()))
                        drawn.building.warnings.push_back(fmt::format(
                            "a body of glass ({} and others) fills no hole as a pane does and was taken as a "
                            "space of its own: what passes it is dimmed by glass on either side",
                            reading_.model.place(*body)));
                    made = withGlass(std::move(drawn));
                }
            } catch (const InputError& error) {
                asDrawn = error;
            }
        }
        if (made && made->use.without.empty() && !isBetweenPanes(*made)) return std::move(made->building);
        auto fitted = importPanes(Drawn::slabsAndFlat);
        if (fitted && (!made || fitted->use.panes > made->use.panes)) return saidOfGlass(std::move(*fitted));
        if (made && made->use.panes > 0) return saidOfGlass(std::move(*made));
        if (blocks) throw *blocks;
        if (whyNoPane_) throw *whyNoPane_;
        if (asDrawn) throw *asDrawn;
        throw reading_.model.openAt(
            made->use.without[0],
            "the glass bounds no room, nor does any other: something crosses it, or the model is "
            "open elsewhere, as where a door in a thick wall is not drawn");
    }

private:
    Building saidOfGlass(WithGlass made) {
        if (isBetweenPanes(made))
            throw reading_.model.openAt(firstGlass(), "all that is closed lies between panes: the rooms "
                                                      "before them are open, as by a gap round a frame");
        if (made.use.without.empty()) return std::move(made.building);
        if (areAllSmall(made.building, leastRoom(reading_.worldPerBuilding())))
            throw reading_.model.openAt(
                made.use.without[0],
                fmt::format("the glass bounds no room, and all that is closed holds less than {} "
                            "m3: the model is open elsewhere, as by a hole without a pane or a "
                            "gap round a frame",
                            kLeastRoom));
        made.building.warnings.push_back(warningOf(made.use, reading_.place()));
        return std::move(made.building);
    }

    bool isBetweenPanes(const WithGlass& made) const {
        return areAllBetweenPanes(made.building, leastRoom(reading_.worldPerBuilding()));
    }

    uint32_t firstGlass() const {
        return std::ranges::find_if(faces_.soup, reading_.isGlass(), &SoupFace::material)->surface;
    }

    WithGlass withGlass(ModelRooms rooms) const {
        GlassUse use = useOfGlass(faces_.soup, reading_.isGlass(), rooms);
        return {std::move(rooms.building), std::move(use)};
    }

    // With other panes than are drawn; none where there are none, or not even these make rooms.
    std::optional<WithGlass> importPanes(Drawn drawn) {
        auto panes = panesInHoles(faces_.soup, reading_.isGlass(), reading_.tolerance(), drawn);
        if (!panes) return std::nullopt;
        const size_t materials = reading_.model.materials.size();
        if (!panes->edges.empty()) reading_.model.materials.push_back({.name = "edge of glass"});
        for (const uint32_t f : panes->edges) panes->soup[f].material = static_cast<uint32_t>(materials);
        std::optional<WithGlass> out = tryPanes(*panes);
        while (!out && leaveOutFree(*panes, std::exchange(strays_, {}))) out = tryPanes(*panes);
        reading_.model.materials.resize(materials);
        return out;
    }

    std::optional<WithGlass> tryPanes(PanesInHoles& panes) {
        std::swap(faces_.soup, panes.soup);
        std::optional<WithGlass> out;
        try {
            ModelRooms made = roomsOfReading(reading_, faces_, {panes.made.begin(), panes.made.end()});
            const std::vector<bool> inRoom = areInRooms(made, panes.loose);
            for (size_t k = 0; k < inRoom.size(); ++k)
                if (panes.loose[k].kept && !inRoom[k]) strays_.insert(panes.loose[k].faces[0]);
            if (const auto error = wrongGlass(made, panes, inRoom)) {
                insideOut_ = true;
                throw *error;
            }
            if (!strays_.empty())
                throw reading_.model.errorAt(*strays_.begin(), "the glass stands outside of all rooms");
            reportGlass(panes, made.building, reading_.place());
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
        if (panes.openFlat && !isLetIn(*panes.openFlat)) return jointError(*panes.openFlat);
        if (panes.slabs + panes.loose.size() > 0) return error;
        return whyNoPane_;
    }

    // Whether most of a flat pane's border is that of walls, too: it fills its hole, but for a face that it
    // lacks.
    bool isLetIn(const LooseGlass& pane) const {
        const std::set<uint32_t> own(pane.faces.begin(), pane.faces.end());
        const Building welded = weldFaces(faces_.soup, 1, reading_.tolerance(), true);
        double around = 0, shared = 0;
        for (const auto& [edge, faces] : facesOfEdges(welded)) {
            const auto ofPane = std::ranges::count_if(
                faces, [&](uint32_t f) { return own.contains(welded.faces[f].surface); });
            if (ofPane != 1) continue;
            const double length = glm::distance(welded.vertices[edge.first], welded.vertices[edge.second]);
            around += length;
            if (faces.size() > 1) shared += length;
        }
        return shared > 0.5 * around;
    }

    InputError jointError(const LooseGlass& glass) const {
        if (*glass.joint > kMostGap * glass.diagonal)
            return reading_.model.errorAt(
                glass.faces[0],
                "the glass fills no hole, as a leaf that stands open or a flat pane that stands free");
        return reading_.model.errorAt(
            glass.faces[0],
            fmt::format("a gap of {:.2g} m is left between the glass and the hole in which it stands, "
                        "expected at most 0.5 % of its diagonal",
                        reading_.inBuilding(*glass.joint)));
    }

    // Panes that no room has, or glass in a hole and not in a room: air and walls are taken for one another.
    std::optional<InputError> wrongGlass(const ModelRooms& rooms, const PanesInHoles& panes,
                                         const std::vector<bool>& inRoom) const {
        const std::set<uint32_t> made(panes.made.begin(), panes.made.end());
        if (!made.empty() && std::ranges::none_of(rooms.source, [&](uint32_t f) { return made.contains(f); }))
            return reading_.model.openAt(
                panes.made[0],
                "the glass fills a hole but bounds no room: the model is open elsewhere, as by "
                "a hole without a pane or a gap round a frame" +
                    (panes.loose.empty() ? ""
                                         : " (the glass at " + reading_.model.place(panes.loose[0].faces[0]) +
                                               " fills none)"));
        const bool dark = std::ranges::none_of(
            rooms.building.faces, [&](const Face& face) { return reading_.isGlass()(face.material); });
        for (size_t k = 0; k < inRoom.size(); ++k) {
            const LooseGlass& glass = panes.loose[k];
            if (glass.joint && !inRoom[k]) return jointError(glass);
            if (dark)
                return reading_.model.errorAt(
                    glass.faces[0],
                    "the glass fills no hole, and no other glass bounds a room, expected a slab "
                    "as wide as its hole and at most a fifth as thick, or flat panes round a corner");
        }
        return std::nullopt;
    }

    ModelReading& reading_;
    ModelFaces& faces_;         // as they were, once a try is over
    std::set<uint32_t> strays_; // the first faces of glass that stands free, but not in a room
    std::optional<InputError>& whyNoPane_;
    bool insideOut_ = false; // with panes that fit, what is drawn bounds the inside of walls
};

} // namespace

Building glazedRooms(ModelReading& reading, ModelFaces& faces, std::optional<InputError>& whyNoPane) {
    return GlazedRooms(reading, faces, whyNoPane).find();
}

} // namespace heliodon::geometry
