#include "geometry/model_rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/face_soup.h"
#include "geometry/faces_on_faces.h"
#include "geometry/glass_pairs.h"
#include "geometry/hole_size.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"
#include "geometry/model_surfaces.h"
#include "geometry/outline_area.h"
#include "geometry/outside_shade.h"
#include "geometry/pinched_shells.h"
#include "geometry/shared_walls.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

namespace {

// Where corners of files' digits leave the model open: gaps that nobody sees, 0.5 mm in a room of 5 m.
constexpr std::array kGapsOfExtent{kWeldOfExtent, 2e-5, 1e-4};
constexpr double kPinchOfExtent = 1e-9;      // nothing that anyone sees
constexpr double kLeastRoomOfExtent = 1e-15; // of its cube: less is what rounding leaves

// Keys are of a sketch's windows, in metres on the table: pairGlasses() finds the twins of models.
std::vector<SoupFace> withoutKeys(std::vector<SoupFace> faces) {
    for (SoupFace& face : faces) face.twinKey = -1;
    return faces;
}

class RoomMaker {
public:
    RoomMaker(const RawModel& model, const ModelFaces& faces, double extent, const std::set<uint32_t>& made)
        : model_(model), faces_(faces), made_(made), turnedOver_(faces.turnedOver), extent_(extent) {}

    ModelRooms make(const std::function<void()>& beforePart) {
        bool tried = false, placed = false;
        const auto then = [&](auto part) {
            beforePart();
            return (this->*part)();
        };
        try {
            then(&RoomMaker::weld);
            then(&RoomMaker::closeGaps);
            if (then(&RoomMaker::endsOnFaces)) {
                tried = true;
                if (then(&RoomMaker::shareWalls)) return done();
            }
            then(&RoomMaker::orient);
            then(&RoomMaker::nestShells);
            then(&RoomMaker::splitSharedCorners);
            then(&RoomMaker::finish);
            placed = true;
            then(&RoomMaker::prove);
        } catch (const InputError& wrong) {
            if (!tried && shareWalls()) return done();
            if (!placed || !openPinches()) throw;
            try {
                prove();
            } catch (const InputError&) { // what was wrong before says more
                throw InputError(wrong);
            }
        }
        then(&RoomMaker::dropBodies);
        return done();
    }

private:
    ModelRooms done() {
        outer_.insert(outer_.end(), faces_.outside.begin(), faces_.outside.end());
        building_.outside = outsideShade(outer_, building_, kPlanarOfExtent * extent_);
        building_.northDeg = model_.northDeg.value_or(kModelNorthDeg);
        building_.northIsSaid = model_.northDeg.has_value();
        const auto isUsed = [&](uint32_t material) {
            return std::ranges::find(model_.material, material) != model_.material.end();
        };
        building_.repairs.insert(building_.repairs.end(), model_.leftOut.begin(), model_.leftOut.end());
        for (const auto& [material, assumption] : model_.assumed)
            if (isUsed(material)) building_.repairs.push_back(assumption);
        for (const auto& [material, doubt] : model_.doubts)
            if (isUsed(material)) building_.warnings.push_back(doubt);
        std::string unread;
        for (const auto& [material, what] : model_.unread)
            if (isUsed(material))
                unread += fmt::format("{}\"{}\" ({})", unread.empty() ? "" : ", ",
                                      model_.materials[material].name, what);
        if (!unread.empty())
            building_.warnings.push_back("textures and colours of vertices that are not read leave these "
                                         "materials uncertain: " +
                                         unread);
        building_.warnings.insert(building_.warnings.end(), faces_.warnings.begin(), faces_.warnings.end());
        return {std::move(building_), std::move(source_), std::move(sheets_)};
    }

    void finish() {
        findSurfaces(building_, model_, source_);
        building_.materials = model_.materials;
        const double tolerance = kPlanarOfExtent * extent_;
        const std::optional<GlassPairs> said = pairsAsSaid(tolerance);
        const GlassPairs glasses = said ? *said : pairGlasses(building_, tolerance, extent_ / faces_.coarser);
        for (const auto& [a, b] : glasses.odd)
            refuse({a, b}, "the glass has another shape or place than that on the other side of its wall");
        if (glasses.nearly > 0)
            building_.repairs.push_back(counted(glasses.nearly, "pane") +
                                        " taken as one with what is nearly opposite in the wall");
        if (turnedOver_ > 0) building_.repairs.push_back(countedWere(turnedOver_, "face") + " turned over");
    }

    // By a file of our own that nobody has changed in between; else that is warned of.
    std::optional<GlassPairs> pairsAsSaid(double tolerance) {
        if (!model_.twins || std::ranges::none_of(source_, [&](uint32_t f) { return isOpening(f); }))
            return std::nullopt;
        const auto warn = [&](const std::string& why) {
            building_.warnings.push_back("what the file says of glass between rooms (twins) is not used, " +
                                         why + ": it was found by shape and place");
            return std::nullopt;
        };
        const auto& [of, glass, said] = *model_.twins;
        if (of != model_.faceCount())
            return warn(fmt::format("it is of {}, not {}", counted(of, "face"), model_.faceCount()));
        std::vector<size_t> panes;
        for (uint32_t f = 0; f < model_.faceCount(); ++f)
            if (isOpening(f)) panes.push_back(f);
        const GlassMark now = glassMark(model_.vertices, model_.corners, model_.firstCorner, panes);
        if (glass && glass->panes != now.panes)
            return warn(fmt::format("it is of {}, not {}", counted(glass->panes, "pane"), now.panes));
        if (glass && !glass->agrees(now)) return warn("the glass stood elsewhere in the model");
        std::map<uint32_t, uint32_t> faceOf; // by its number in the file
        for (uint32_t f = 0; f < source_.size(); ++f)
            if (!faceOf.try_emplace(source_[f], f).second)
                return warn(model_.place(source_[f]) + " was divided");
        std::vector<std::pair<uint32_t, uint32_t>> pairs;
        for (const auto& [a, b] : said)
            if (faceOf.contains(a) && faceOf.contains(b)) pairs.emplace_back(faceOf.at(a), faceOf.at(b));
        const auto made = pairs.size() < said.size() ? std::nullopt : pairAsSaid(building_, pairs, tolerance);
        return made ? made : warn("pairs of it are no two sides of a wall");
    }

    bool isOpening(uint32_t source) const { return model_.materials[model_.material[source]].isOpening(); }

    // Two faces in one place, if they are such.
    void refuseOpeningOnWall(uint32_t one, uint32_t other) const {
        if (isOpening(one) == isOpening(other)) return;
        if (isOpening(other)) std::swap(one, other);
        throw model_.errorAt(
            one,
            fmt::format("an opening and a wall ({}) lie on one another, expected a hole in the wall there",
                        model_.place(other)));
    }

    // Rooms whose common walls have no thickness; false when that is not what kept them from closing.
    bool shareWalls() {
        const auto space = divideSpace(faces_.soup, isGlass_, weldOfExtent_ * extent_);
        if (!space || proveShells(space->outside)[0].selfIntersecting) return false;
        for (const auto& [one, other] : space->pairs) refuseOpeningOnWall(one, other);
        const auto before = std::tuple(building_, source_, turnedOver_);
        building_ = weldFaces(withoutKeys(space->faces), space->rooms, weldOfExtent_ * extent_);
        source_.clear();
        for (const Face& face : building_.faces) source_.push_back(face.surface);
        turnedOver_ = faces_.turnedOver;
        building_.repairs = std::get<0>(before).repairs;
        building_.repairs.insert(building_.repairs.end(), space->repairs.begin(), space->repairs.end());
        building_.warnings = space->warnings;
        if (!space->unseen.empty())
            building_.warnings.push_back(fmt::format(
                "{} (the first at {}) on a wall without thickness {} away from the room and {} most of it: "
                "not seen in the room, taken as its outside (a poster has to look into the room)",
                counted(space->unseen.size(), "face"), model_.place(space->unseen[0]),
                space->unseen.size() == 1 ? "is turned" : "are turned",
                space->unseen.size() == 1 ? "covers" : "cover"));
        finish();
        try {
            proveOpened();
            outer_ = space->outer;
            sheets_ = space->sheets;
            return true;
        } catch (const InputError&) { // what was wrong before says more
            std::tie(building_, source_, turnedOver_) = before;
            return false;
        }
    }

    glm::dvec3 areaOf(const std::vector<uint32_t>& loop) const {
        return areaVector(building_.vertices, loop);
    }

    glm::dvec3 normal(const Face& face) const { return glm::normalize(areaOf(face.loops[0])); }

    // A wider tolerance, only when the model is open without it and closed with it.
    void closeGaps() {
        for (const double gap : kGapsOfExtent) {
            if (gap > kWeldOfExtent && (faces_.exact || faces_.coarser > 1 || !weldsWithin(gap))) continue;
            const auto edges = facesOfEdges(building_);
            if (!building_.faces.empty() &&
                std::ranges::none_of(edges, [](const auto& entry) { return entry.second.size() == 1; })) {
                if (gap > kWeldOfExtent)
                    building_.repairs.push_back(
                        fmt::format("gaps of up to {:.2g} between corners were closed", gap * extent_));
                return;
            }
        }
        // Open whatever the tolerance: it may stand uncut on another face, or be refused by name.
        weldOfExtent_ = kWeldOfExtent;
        weld();
    }

    bool weldsWithin(double gap) {
        weldOfExtent_ = gap;
        try {
            weld();
            return true;
        } catch (const InputError&) { // a face that this bends too far
            return false;
        }
    }

    void weld() {
        source_.clear();
        building_ = weldFaces(withoutKeys(faces_.soup), 1, weldOfExtent_ * extent_);
        if (!faces_.repair.empty()) building_.repairs.push_back(faces_.repair);
        std::map<std::vector<uint32_t>, uint32_t> known; // by corners, the face of the file
        std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<uint32_t, uint32_t>>> otherMaterials;
        size_t dropped =
            faces_.dropped + faces_.soup.size() - building_.faces.size(); // fewer than three corners left
        dropped += std::erase_if(building_.faces, [&](const Face& face) {
            std::vector<uint32_t> corners;
            for (const auto& loop : face.loops) corners.insert(corners.end(), loop.begin(), loop.end());
            std::ranges::sort(corners);
            if (glm::length(areaOf(face.loops[0])) < 1e-12 * extent_ * extent_) return true;
            const auto [first, isNew] = known.try_emplace(corners, face.surface);
            if (!isNew && model_.material[first->second] != model_.material[face.surface])
                otherMaterials[{model_.material[face.surface], model_.material[first->second]}].emplace_back(
                    face.surface, first->second);
            return !isNew;
        });
        for (const auto& [materials, copies] : otherMaterials) warnOfCopies(copies);
        if (dropped > 0)
            building_.repairs.push_back(fmt::format("{} without area or drawn twice {} left out",
                                                    counted(dropped, "face"), dropped == 1 ? "was" : "were"));
        for (const Face& face : building_.faces) {
            source_.push_back(face.surface);
            checkPlanar(face);
        }
    }

    // Of one material each, all copies and all those that they are copies of, which are kept.
    void warnOfCopies(const std::vector<std::pair<uint32_t, uint32_t>>& copies) {
        const auto [copy, kept] = copies[0];
        refuseOpeningOnWall(copy, kept);
        const auto name = [&](uint32_t face) -> const std::string& {
            return model_.materials[model_.material[face]].name;
        };
        building_.warnings.push_back(fmt::format(
            "{} of \"{}\" (the first at {}) {} the corners of faces of \"{}\" (at {}): these are seen",
            counted(copies.size(), "face"), name(copy), model_.place(copy),
            copies.size() == 1 ? "has" : "have", name(kept), model_.place(kept)));
    }

    // What closing gaps may move a corner out of its plane by.
    double offPlane() const { return std::max(kPlanarOfExtent, 2 * weldOfExtent_) * extent_; }

    void checkPlanar(const Face& face) const {
        const glm::dvec3 n = normal(face), origin = building_.vertices[face.loops[0][0]];
        for (const auto& loop : face.loops)
            for (const uint32_t v : loop)
                if (std::abs(glm::dot(building_.vertices[v] - origin, n)) > offPlane())
                    throw model_.errorAt(face.surface, "the face is not planar");
    }

    // Something ends on a face that was not divided there: an edge is open, a face lies within another, or a
    // body on several.
    bool endsOnFaces() const {
        const FacesOnFaces on(building_, offPlane());
        bool ends = on.hasOpenEdges();
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            if (on.isWithinOne(f)) {
                // A pane that lies in a wall face that was not cut is drawn, not hidden: the user must mend
                // it.
                if (model_.materials[building_.faces[f].material].isOpening())
                    refuse({f}, "an opening lies on another face that is not cut out for it");
                ends = true;
            }
            ends = ends || on.isOfBodyOn(f);
        }
        return ends;
    }

    // `place`: without its faces.
    [[noreturn]] void refuse(const std::vector<uint32_t>& faces, const std::string& what,
                             ModelPlace place = {}) const {
        std::vector<uint32_t> drawn; // a face may have been cut into several
        for (const uint32_t f : faces) drawn.push_back(source_[f]);
        std::ranges::sort(drawn);
        drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
        if (!place.border.empty()) { // what is said of it is said of its face
            const auto first = std::ranges::find(drawn, source_[faces[0]]);
            std::rotate(drawn.begin(), first, first + 1);
        }
        const std::span<const uint32_t> all(drawn);
        std::string more =
            all.size() < 2 ? "" : model_.places(all.subspan(1, std::min<size_t>(4, all.size() - 1)));
        if (drawn.size() > 5) more += fmt::format(" and {} more", drawn.size() - 5);
        place.faces = drawn;
        throw InputError(model_.file, drawn.empty() ? "" : model_.place(drawn[0]),
                         what + place.said + (more.empty() ? "" : " (also " + more + ")"), place);
    }

    // In the file's unit and axes, as the program that wrote it shows them.
    std::string sizeOf(const ShellFaces& shells) const {
        if (shells.border.empty()) return "";
        const glm::dvec3 p = model_.inFile(boundsOf(shells.border).centre());
        return fmt::format(" ({} {}, round {:.3g} {:.3g} {:.3g}, in the file's unit{})",
                           shells.isHole ? "it is" : "the open border of the largest such part is",
                           sizeOfHole(shells.border, offPlane()), p.x, p.y, p.z,
                           shells.isHole ? "; a face of glass in it, with Ni 1, is an opening" : "");
    }

    // Within a shell all faces look the same way: the way of most of its area.
    void orient() {
        if (building_.faces.empty()) throw model_.errorAt(0, "no face of the model has an area");
        const std::vector<Face> before = made_.empty() ? std::vector<Face>{} : building_.faces;
        ShellFaces shells = orientShells(building_);
        if (!shells.bad.empty())
            refuse(shells.bad, shells.what,
                   {.border = shells.border, .said = sizeOf(shells), .isOpen = shells.isOpen});
        shell_ = std::move(shells.shell);
        shellCount_ = shells.count;
        turnedOver_ += shells.turnedOver;
        for (size_t f = 0; f < before.size(); ++f) // panes of ours look neither way
            if (made_.contains(source_[f]) && before[f].loops != building_.faces[f].loops) --turnedOver_;
    }

    void nestShells() {
        std::vector<std::vector<ShellTriangle>> shells(shellCount_);
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            const auto pieces = triangulateFace(building_, building_.faces[f]);
            if (pieces.empty()) refuse({f}, "the outline of the face crosses itself");
            for (const auto& t : pieces)
                shells[shell_[f]].push_back(
                    {building_.vertices[t[0]], building_.vertices[t[1]], building_.vertices[t[2]]});
        }
        std::vector<bool> hasGlass(shellCount_, false);
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            if (isOpening(source_[f])) hasGlass[shell_[f]] = true;
        const ShellNesting nesting = geometry::nestShells(shells, hasGlass);
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            if (nesting.inverted[shell_[f]]) turnOver(building_.faces[f]);
            building_.faces[f].room = nesting.room[shell_[f]];
        }
        if (nesting.solidsThatLookIn > 0)
            building_.warnings.push_back(
                fmt::format("{} within a room taken as solid though the faces look into {}, as the room's do",
                            countedWere(nesting.solidsThatLookIn, "closed shell"),
                            nesting.solidsThatLookIn == 1 ? "it" : "them"));
        dropOutsides();
        building_.roomCount = nesting.rooms + nesting.bodies;
        bodies_ = nesting.bodies;
    }

    // Once they are proven not to cross rooms.
    void dropBodies() {
        if (bodies_ == 0) return;
        building_.warnings.push_back(solidsOutside(bodies_));
        building_.roomCount -= bodies_;
        std::vector<bool> gone;
        for (const Face& face : building_.faces) {
            gone.push_back(face.room >= building_.roomCount);
            if (!gone.back()) continue;
            SoupFace& outer = outer_.emplace_back();
            outer.material = face.material;
            for (const auto& loop : face.loops) {
                auto& corners = outer.loops.emplace_back();
                for (const uint32_t v : loop) corners.push_back(building_.vertices[v]);
                std::ranges::reverse(corners); // it looks into the body
            }
        }
        leaveOut(gone);
    }

    void dropOutsides() {
        std::vector<bool> outside;
        for (const Face& face : building_.faces) outside.push_back(face.room == kNoRoom);
        if (const auto count = std::ranges::count(outside, true); count > 0)
            building_.warnings.push_back(fmt::format(
                "{} faces of the outside of walls were left out: only shells within them are rooms", count));
        leaveOut(outside);
    }

    void leaveOut(const std::vector<bool>& gone) {
        size_t kept = 0;
        for (size_t f = 0; f < gone.size(); ++f) {
            if (gone[f]) continue;
            if (kept < f) building_.faces[kept] = std::move(building_.faces[f]);
            source_[kept++] = source_[f];
        }
        building_.faces.resize(kept);
        source_.resize(kept);
    }

    // Rooms that touch in a corner must not share the vertex.
    void splitSharedCorners() {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;
        std::vector<int64_t> owner(building_.vertices.size(), -1);
        for (Face& face : building_.faces)
            for (auto& loop : face.loops)
                for (uint32_t& v : loop) {
                    if (owner[v] < 0) owner[v] = face.room;
                    if (owner[v] == face.room) continue;
                    const auto [place, isNew] =
                        copies.try_emplace({v, face.room}, static_cast<uint32_t>(building_.vertices.size()));
                    if (isNew) {
                        building_.vertices.push_back(building_.vertices[v]);
                        owner.push_back(face.room);
                    }
                    v = place->second;
                }
    }

    std::vector<uint32_t> facesOfRoom(uint32_t room) const {
        std::vector<uint32_t> out;
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            if (building_.faces[f].room == room) out.push_back(f);
        return out;
    }

    // Where bodies touch in edges or corners alone, with corners for each.
    void proveOpened() {
        try {
            proveRooms();
        } catch (const InputError&) {
            if (!openPinches()) throw;
            proveRooms();
        }
    }

    bool openPinches() {
        return geometry::openPinches(building_, kPinchOfExtent * extent_, weldOfExtent_ * extent_);
    }

    void proveRooms() {
        const std::vector<ShellProof> proofs = proveShells(building_);
        if (proofs.empty()) refuse({0}, "the model encloses no room", {.isOpen = true});
        for (const ShellProof& proof : proofs) {
            if (!proof.closed)
                refuse(proof.badFaces, "the model is not closed: the faces round a corner form no single fan",
                       {.isOpen = true});
            if (proof.selfIntersecting) refuse(proof.badFaces, "the face crosses another face");
            if (!(proof.volume > kLeastRoomOfExtent * extent_ * extent_ * extent_))
                refuse(facesOfRoom(static_cast<uint32_t>(&proof - proofs.data())),
                       "the faces enclose no room");
        }
    }

    void prove() {
        proveRooms();
        if (building_.roomCount < 2) return;
        Building together = building_; // rooms must not cross each other either
        together.roomCount = 1;
        for (Face& face : together.faces) face.room = 0;
        const ShellProof proof = proveShells(together)[0];
        if (proof.selfIntersecting) refuse(proof.badFaces, "the face crosses a face of another room");
    }

    const RawModel& model_;
    const ModelFaces& faces_;
    const std::set<uint32_t>& made_;
    std::function<bool(uint32_t)> isGlass_ = [this](uint32_t m) { return model_.materials[m].isOpening(); };
    Building building_;
    std::vector<SoupFace> outer_, sheets_; // seen from outside of all rooms alone, and as ModelRooms has them
    uint32_t bodies_ = 0;                  // that stand outside, numbered as the last rooms
    std::vector<uint32_t> source_, shell_; // per face
    uint32_t shellCount_ = 0;
    size_t turnedOver_; // against the others of their shell
    double extent_, weldOfExtent_ = kWeldOfExtent;
};

} // namespace

ModelRooms roomsOfModel(const RawModel& model, const ModelFaces& faces, double extent,
                        const std::set<uint32_t>& made, const std::function<void()>& beforePart) {
    return RoomMaker(model, faces, extent, made).make(beforePart);
}

} // namespace heliodon::geometry
