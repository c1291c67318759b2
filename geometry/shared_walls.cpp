#include "geometry/shared_walls.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/box_tree.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_crossing.h"
#include "geometry/flat_faces.h"
#include "geometry/room_parts.h"
#include "geometry/shell_faces.h"
#include "geometry/space_parts.h"

namespace heliodon::geometry {

namespace {

// Of a wall without thickness: where faces that are turned over cover so much, they are its outside; but of
// an outside that is all there they cover so much.
constexpr double kOutside = 0.5, kWholeOutside = 0.95;

// Those that hang together with an edge of one alone: others enclose something, as neighbours that overlap.
std::vector<SoupFace> openAmong(const std::vector<SoupFace>& sheets, double tolerance) {
    const Building welded = weldedByNumber(sheets, tolerance);
    DisjointSets wholes(sheets.size());
    std::set<uint32_t> edged; // sheets
    for (const auto& [edge, faces] : facesOfEdges(welded)) {
        const uint32_t one = welded.faces[faces[0]].surface;
        if (faces.size() == 1) edged.insert(one);
        for (const uint32_t f : faces) wholes.join(one, welded.faces[f].surface);
    }
    std::set<uint32_t> open;
    for (const uint32_t k : edged) open.insert(wholes.root(k));
    std::vector<SoupFace> out;
    for (uint32_t k = 0; k < sheets.size(); ++k)
        if (open.contains(wholes.root(k))) out.push_back(sheets[k]);
    return out;
}

// What each room sees of each sheet.
class RoomSides {
public:
    RoomSides(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
              double tolerance, const SpaceParts& space, const RoomParts& rooms)
        : faces_(faces), isGlass_(isGlass), tolerance_(tolerance), space_(space), rooms_(rooms) {}

    // None where it is unclear what is seen, or where nothing lies or ends on another, or touches it in an
    // edge.
    std::optional<SharedWalls> answer() {
        SharedWalls out;
        out.rooms = rooms_.count;
        size_t shared = 0; // walls that two rooms see
        std::set<uint32_t> meeting;
        std::vector<SoupFace> outside;
        for (uint32_t f = 0; f < space_.welded.faces.size(); ++f) {
            const Sheet& sheet = space_.sheetOf(f);
            const std::vector<uint32_t> all = drawnOn(f);
            for (size_t k = 1; k < all.size(); ++k)
                out.pairs.push_back({faces_[all[0]].surface, faces_[all[k]].surface});
            const size_t before = out.faces.size();
            const size_t outsideBefore = outside.size();
            addSides(f, all[0], out.faces, outside);
            const size_t sides = out.faces.size() - before;
            if (sides == 0 &&
                std::ranges::none_of(all, [&](uint32_t k) { return isGlass_(faces_[k].material); })) {
                out.outer.insert(out.outer.end(),
                                 outside.begin() + static_cast<std::ptrdiff_t>(outsideBefore), outside.end());
                const bool isWithinSolid = outside.size() == outsideBefore;
                if (!isWithinSolid && space_.partAt(f, 0) == space_.partAt(f, 1))
                    out.sheets.push_back(outside[outsideBefore + (sheet.drawn[0].empty() ? 1 : 0)]);
            }
            shared += sides == 2;
            if (sides == 1 && all.size() > 1) meeting.insert(all.begin(), all.end());
        }
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (space_.drawn[k].sheets > 1) meeting.insert(k);
        out.repairs = repairs(shared, meeting.size());
        out.warnings = rooms_.warnings;
        if (!overturned_.empty())
            out.warnings.push_back(fmt::format(
                "faces of different materials lie on one another in {} between two rooms and look "
                "the same way: each room sees the one that is beside its others in the file",
                counted(overturned_.size(), "place")));
        out.unseen.assign(unseen_.begin(), unseen_.end());
        out.outside = weldFaces(outside, 1, tolerance_);
        out.sheets = openAmong(out.sheets, tolerance_);
        if (out.repairs.empty() && out.warnings.empty() && touchInEdges())
            out.repairs.emplace_back("rooms and solids that touch in an edge alone were kept apart");
        if (unclear_ || (out.repairs.empty() && out.warnings.empty())) return std::nullopt;
        return out;
    }

private:
    // All, whichever way they look.
    std::vector<uint32_t> drawnOn(uint32_t f) const {
        const auto& [ahead, back] = space_.sheetOf(f).drawn;
        std::vector<uint32_t> out = ahead;
        out.insert(out.end(), back.begin(), back.end());
        return out;
    }

    // Of the faces drawn on a sheet, the one for the side: that which is turned as those about it, and of
    // several such its own, and the smaller one (drawn on the other). Where nothing is behind the sheet a
    // smaller one that is turned over is drawn on the other, too, unless its like cover half of that: those
    // are the wall as seen from outside. A solid behind has an outside of its own.
    uint32_t drawnFor(uint32_t f, uint32_t side) {
        const Sheet& sheet = space_.sheetOf(f);
        const uint32_t id = space_.partAt(f, side);
        const uint32_t beyond = space_.partAt(f, 1 - side);
        const SpacePart& behind = space_.parts.at(beyond);
        const size_t first = space_.parts.at(id).drawnInwards >= 0 ? side : 1 - side;
        const auto& list = sheet.drawn[first].empty() ? sheet.drawn[1 - first] : sheet.drawn[first];
        const auto& turned = sheet.drawn[first].empty() ? sheet.drawn[first] : sheet.drawn[1 - first];
        const auto rank = [&](uint32_t k) {
            const DrawnFace& face = space_.drawn[k];
            return std::pair(face.owners[0] != id && face.owners[1] != id, face.area);
        };
        // No larger than the other but for rounding.
        const auto rivals = [&](uint32_t k, uint32_t other) {
            return rank(k).first == rank(other).first && rank(k).second < rank(other).second * 1.001;
        };
        const auto looksOther = [&](uint32_t k, uint32_t other) {
            return faces_[k].material != faces_[other].material || faces_[k].role != faces_[other].role;
        };
        if (turned.empty() && list.size() == 2 && looksOther(list[0], list[1]) && rivals(list[0], list[1]) &&
            rivals(list[1], list[0]) && rooms_.room.contains(beyond))
            if (const auto own = besideOthersOf(id, beyond, list[0], list[1])) {
                overturned_.insert(f);
                return *own;
            }
        if (isOfBeyond(f, side, &list == &sheet.drawn[0] ? 0 : 1)) return wallAmong(list, id);
        const uint32_t best = *std::ranges::min_element(list, {}, rank);
        if (!rooms_.room.contains(beyond) && !turned.empty()) {
            const uint32_t over = *std::ranges::min_element(turned, {}, rank);
            const DrawnFace& face = space_.drawn[best];
            const bool isDrawnOn = !rivals(best, over) && rivals(over, best);
            if (isDrawnOn &&
                (behind.volume > 0 ? looksOther(over, best) : face.backed < kOutside * face.area)) {
                if (looksOther(over, best)) covered_.insert(f);
                for (const uint32_t k : turned) unclear_ |= rivals(k, over) && looksOther(k, over);
                return over;
            }
            if (isDrawnOn && face.backed < kWholeOutside * face.area && looksOther(over, best))
                unseen_.insert(faces_[over].surface);
        }
        for (const uint32_t k : list) {
            if (!looksOther(k, best) || rank(k).first != rank(best).first) continue;
            unclear_ |= rivals(k, best);
            covered_.insert(f);
        }
        return best;
    }

    // Of two faces in one place, drawn for two parts, where one is turned over: the one that is the part's,
    // as next to it in the file are others of that part. None where that says nothing.
    std::optional<uint32_t> besideOthersOf(uint32_t part, uint32_t beyond, uint32_t one, uint32_t other) {
        if (partOf_.empty())
            for (uint32_t k = 0; k < faces_.size(); ++k) {
                std::set<uint32_t> parts = space_.drawn[k].borders.value_or(std::set<uint32_t>());
                std::erase_if(parts, [&](uint32_t id) { return !rooms_.room.contains(id); });
                if (parts.size() == 1) partOf_[faces_[k].surface] = *parts.begin();
            }
        const auto lean = [&](uint32_t k) {
            const auto says = [&](uint32_t id) { return id == part ? 1 : id == beyond ? -1 : 0; };
            const auto after = partOf_.lower_bound(faces_[k].surface);
            return (after == partOf_.end() ? 0 : says(after->second)) +
                   (after == partOf_.begin() ? 0 : says(std::prev(after)->second));
        };
        if (lean(one) == lean(other)) return std::nullopt;
        return lean(one) > lean(other) ? one : other;
    }

    // Where a sheet's faces that look this way are the only ones, or both rooms' own: whether the room on the
    // other side sees all of them.
    bool isOfBeyond(uint32_t f, uint32_t side, size_t looks) const {
        const uint32_t beyond = space_.partAt(f, 1 - side);
        const auto own = [&](uint32_t s) { // which way its faces look
            return space_.parts.at(space_.partAt(f, s)).drawnInwards >= 0 ? s : 1 - s;
        };
        return rooms_.room.contains(beyond) && own(1 - side) == looks &&
               (own(side) != looks || looks != side);
    }

    // The face that parts that room from another: of those that are as large there the smallest. What is
    // smaller is drawn on it in the other room.
    uint32_t wallAmong(const std::vector<uint32_t>& list, uint32_t id) {
        if (list.size() == 1) return list[0];
        if (!wholes_) measureWholes();
        const auto size = [&](uint32_t k) { return towards_.at({wholes_->root(k), id}); };
        const double largest = size(*std::ranges::max_element(list, {}, size));
        return *std::ranges::min_element(list, {}, [&](uint32_t k) {
            return std::pair(size(k) * 1.001 < largest, wholeArea_.at(wholes_->root(k)));
        });
    }

    void measureWholes() {
        wholes_.emplace(faces_.size());
        for (const auto& [edge, around] : facesOfEdges(space_.welded))
            for (const uint32_t f : around)
                for (const uint32_t g : around)
                    if (f < g && std::abs(glm::dot(space_.normalOf(f), space_.normalOf(g))) > kOnePlaneCosine)
                        for (const uint32_t k : drawnOn(f))
                            for (const uint32_t other : drawnOn(g))
                                if (faces_[k].material == faces_[other].material) wholes_->join(k, other);
        for (uint32_t f = 0; f < space_.welded.faces.size(); ++f)
            for (const uint32_t k : drawnOn(f))
                for (const uint32_t s : {0u, 1u})
                    towards_[{wholes_->root(k), space_.partAt(f, s)}] += space_.area[f];
        for (uint32_t k = 0; k < faces_.size(); ++k) wholeArea_[wholes_->root(k)] += space_.drawn[k].area;
    }

    // The sides of a welded face, to the rooms that see them and to the outside; nobody sees `unseen` there.
    void addSides(uint32_t f, uint32_t unseen, std::vector<SoupFace>& inRooms,
                  std::vector<SoupFace>& outside) {
        for (uint32_t s = 0; s < 2; ++s) {
            const uint32_t id = space_.partAt(f, s);
            const SpacePart& part = space_.parts.at(id);
            const auto room = rooms_.room.find(id);
            const bool inRoom = room != rooms_.room.end();
            if (part.volume > 0 && !inRoom) continue;
            SoupFace face = faces_[inRoom ? drawnFor(f, s) : unseen];
            face.loops.clear();
            for (const auto& loop : space_.welded.faces[f].loops) {
                face.loops.emplace_back();
                for (const uint32_t v : loop) face.loops.back().push_back(space_.welded.vertices[v]);
                if (s) std::ranges::reverse(face.loops.back());
            }
            if (part.volume <= 0) {
                face.room = 0;
                outside.push_back(face);
            }
            if (!inRoom) continue;
            face.room = room->second;
            inRooms.push_back(std::move(face));
        }
    }

    bool touchInEdges() const {
        return std::ranges::any_of(facesOfEdges(space_.welded),
                                   [](const auto& entry) { return entry.second.size() > 2; });
    }

    std::vector<std::string> repairs(size_t shared, size_t meeting) const {
        std::vector<std::string> out;
        if (shared > 0)
            out.push_back(fmt::format("{} without thickness: rooms on both sides share {}",
                                      counted(shared, "wall"), shared == 1 ? "it" : "them"));
        if (!covered_.empty())
            out.push_back(
                fmt::format("faces of different materials lie on one another in {}: the smaller is seen",
                            counted(covered_.size(), "place")));
        if (rooms_.walls > 0)
            out.push_back(counted(rooms_.walls, "space") + " round the room taken as its walls");
        if (meeting > 0)
            out.push_back(
                fmt::format("{} divided where others lie on or end on {}, and one is seen in each place",
                            countedWere(meeting, "face"), meeting == 1 ? "it" : "them"));
        return out;
    }

    const std::vector<SoupFace>& faces_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    const SpaceParts& space_;
    const RoomParts& rooms_;
    std::set<uint32_t> covered_;          // sheets of different materials of which the smaller is seen
    std::set<uint32_t> unseen_;           // given faces, as SharedWalls has them
    std::set<uint32_t> overturned_;       // sheets of which one face of two is turned over
    std::map<uint32_t, uint32_t> partOf_; // of faces (SoupFace::surface) that one room alone has
    // Faces of one material that hang together in their plane; by their roots the areas, of each part and
    // all.
    std::optional<DisjointSets> wholes_;
    std::map<std::pair<uint32_t, uint32_t>, double> towards_;
    std::map<uint32_t, double> wholeArea_;
    bool unclear_ = false; // two materials in one place
};

bool anyCross(const std::vector<FlatFace>& faces, double tolerance) {
    std::vector<Bounds> boxes;
    for (const FlatFace& face : faces) boxes.push_back(face.box);
    const BoxTree tree(boxes);
    return std::ranges::any_of(faces, [&](const FlatFace& face) {
        return tree.anyHolding(face.box.high, face.box.low,
                               [&](uint32_t other) { return facesCross(face, faces[other], tolerance); });
    });
}

// Whether faces enclose nothing though no edge is open, as something crosses their room: the ground.
bool facesAreLost(const SpaceParts& space, double tolerance) {
    for (uint32_t f = 0; f < space.welded.faces.size(); ++f)
        if (space.partAt(f, 0) == space.partAt(f, 1)) return anyCross(flatFacesOf(space.welded), tolerance);
    return false;
}

} // namespace

std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces,
                                       const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    const auto space = partsOfSpace(faces, isGlass, tolerance);
    if (!space || facesAreLost(*space, tolerance)) return std::nullopt;
    const RoomParts rooms = roomsAmong(*space, tolerance);
    if (rooms.count == 0) return std::nullopt;
    return RoomSides(faces, isGlass, tolerance, *space, rooms).answer();
}

} // namespace heliodon::geometry
