// Round each edge the sheets are sorted by angle; the sides that look at one another over an edge bound the
// same part of space (the radial-edge structure of Weiler, 1988).
#include "geometry/shared_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/shell_nesting.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

// A small thing: of the largest room's volume. A thin one, as walls, columns and cupboards are: twice its
// volume over its surface, of the largest room's height (a wall 0.2 m thick 0.07, a cupboard 0.6 m square
// 0.09, a lavatory of 0.9 by 1.2 m 0.18).
constexpr double kSmall = 0.05, kThin = 0.12;
constexpr double kNothing = 1e-3; // of a part's surface

class SpaceDivider {
public:
    SpaceDivider(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                 double tolerance)
        : faces_(faces), isGlass_(isGlass), tolerance_(tolerance), sheets_(cutIntoSheets(faces, tolerance)) {}

    std::optional<SharedWalls> divide() {
        weld();
        if (!joinSides()) return std::nullopt;
        makeParts();
        if (!placeParts()) return std::nullopt;
        SharedWalls out = answer();
        if (unclear_) return std::nullopt;
        if (out.repairs.empty() && out.warnings.empty())
            return std::nullopt; // nothing lies or ends on another
        return out;
    }

private:
    void weld() {
        std::vector<SoupFace> soup;
        for (size_t s = 0; s < sheets_.size(); ++s) {
            SoupFace face;
            face.loops = sheets_[s].loops;
            face.surface = static_cast<uint32_t>(s);
            soup.push_back(std::move(face));
        }
        welded_ = weldFaces(soup, 1, tolerance_, true);
    }

    dvec3 normalOf(const Face& face) const {
        return glm::normalize(areaVector(welded_.vertices, face.loops[0]));
    }

    // False where an edge has one sheet alone.
    bool joinSides() {
        struct Sector {
            double angle;
            uint32_t ahead, behind; // the sides that look to larger and smaller angles
            uint32_t face;
        };
        std::map<std::pair<uint32_t, uint32_t>, std::vector<Sector>> edges;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const dvec3 n = normalOf(welded_.faces[f]);
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                    const auto [low, high] = std::minmax(a, b);
                    const dvec3 axis = glm::normalize(welded_.vertices[high] - welded_.vertices[low]),
                                x = perpendicular(axis), y = glm::cross(axis, x),
                                inwards = (a == low ? 1.0 : -1.0) * glm::cross(n, axis);
                    // Walking with the axis the sheet lies to the left of its normal: that side looks ahead.
                    const bool along = a == low;
                    edges[{low, high}].push_back({std::atan2(glm::dot(inwards, y), glm::dot(inwards, x)),
                                                  2 * f + (along ? 0 : 1), 2 * f + (along ? 1 : 0), f});
                }
        }
        sides_ = DisjointSets(2 * welded_.faces.size());
        shells_ = DisjointSets(welded_.faces.size());
        for (auto& [edge, sectors] : edges) {
            if (sectors.size() < 2) return false;
            std::ranges::sort(sectors, {}, &Sector::angle);
            for (size_t k = 0; k < sectors.size(); ++k) {
                const Sector &one = sectors[k], &next = sectors[(k + 1) % sectors.size()];
                sides_.join(one.ahead, next.behind);
                shells_.join(one.face, next.face);
            }
        }
        return !welded_.faces.empty();
    }

    // The parts of space and what they hold; triangles look into the part.
    struct Part {
        uint32_t shell = 0;
        std::vector<ShellTriangle> triangles;
        double volume = 0; // negative: what lies outside of the shell
        double area = 0;   // of all that bounds it
        int room = -1;
        bool solid = false, alcove = false, between = false; // two glasses or more
        double glass = 0, window = 0, open = 0; // areas: of glass, of that which looks outside, of what else
                                                // parts it from the outside
        std::set<uint32_t> neighbours;
        double drawnInwards = 0; // area of its own faces that look into it, less that of those that look out
        double drawn = 0;        // area of both
        Bounds box() const {
            Bounds out{dvec3(1e300), dvec3(-1e300)};
            for (const ShellTriangle& t : triangles)
                for (const dvec3 p : {t.a, t.b, t.c}) {
                    out.low = glm::min(out.low, p);
                    out.high = glm::max(out.high, p);
                }
            return out;
        }
        // Nearly all of its own faces look in, or out.
        bool looksIn() const { return drawnInwards > 0.5 * drawn; }
        bool looksOut() const { return drawnInwards < -0.5 * drawn; }
    };

    uint32_t partAt(uint32_t face, uint32_t side) { return sides_.root(2 * face + side); }
    const Sheet& sheetOf(uint32_t face) const { return sheets_[welded_.faces[face].surface]; }

    void makeParts() {
        area_.assign(welded_.faces.size(), 0);
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const auto triangles = triangulateFace(welded_, welded_.faces[f]);
            const dvec3 o = welded_.vertices[0];
            for (uint32_t s = 0; s < 2; ++s) {
                Part& part = parts_[partAt(f, s)];
                part.shell = shells_.root(f);
                area_[f] = 0;
                for (const auto& t : triangles) {
                    ShellTriangle in{welded_.vertices[t[0]], welded_.vertices[t[1]], welded_.vertices[t[2]]};
                    if (s) std::swap(in.b, in.c);
                    part.volume -= glm::dot(in.a - o, glm::cross(in.b - o, in.c - o)) / 6;
                    area_[f] += 0.5 * glm::length(glm::cross(in.b - in.a, in.c - in.a));
                    part.triangles.push_back(in);
                }
                part.area += area_[f];
            }
        }
        findOwners();
        findAlcoves();
    }

    // What has glass to one room alone, which has other glass, is air: else light would come from nowhere.
    void findAlcoves() {
        std::map<uint32_t, std::set<uint32_t>> beyond; // its glass, per part
        const auto isOfGlass = [&](const auto& list) {
            return std::ranges::any_of(list, [&](uint32_t k) { return isGlass_(faces_[k].material); });
        };
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const bool glass = std::ranges::any_of(sheetOf(f).drawn, isOfGlass);
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t id = partAt(f, s), other = partAt(f, 1 - s);
                parts_[id].neighbours.insert(other);
                if (parts_[other].volume <= 0) (glass ? parts_[id].window : parts_[id].open) += area_[f];
                if (!glass) continue;
                beyond[id].insert(other);
                parts_[id].glass += area_[f];
            }
        }
        for (const auto& [id, others] : beyond) {
            parts_[id].alcove = others.size() == 1 && beyond[*others.begin()].size() > 1 &&
                                parts_[*others.begin()].volume > 0;
            parts_[id].between = others.size() > 1;
        }
    }

    // Air for its glass: an alcove, or what lies between two panes unless it is the inside of a wall, whose
    // faces look out and which is no glass for the most part.
    static bool isBehindGlass(const Part& part, const Part& largest) {
        return part.alcove || (part.between && (part.glass >= 0.5 * part.area || !contrary(part, largest)));
    }

    // A face as drawn belongs to the part that most of it bounds, in front of it and behind it.
    void findOwners() {
        std::vector<std::array<std::map<uint32_t, double>, 2>> bounds(faces_.size()); // areas by part
        borders_.resize(faces_.size());
        pieces_.assign(faces_.size(), 0);
        drawnArea_.assign(faces_.size(), 0);
        backed_.assign(faces_.size(), 0);
        for (uint32_t f = 0; f < welded_.faces.size(); ++f)
            for (uint32_t turned = 0; turned < 2; ++turned)
                for (const uint32_t k : sheetOf(f).drawn[turned]) {
                    ++pieces_[k];
                    drawnArea_[k] += area_[f];
                    if (!sheetOf(f).drawn[1 - turned].empty()) backed_[k] += area_[f];
                    const std::array<uint32_t, 2> parts{partAt(f, turned), partAt(f, 1 - turned)};
                    for (uint32_t s = 0; s < 2; ++s) bounds[k][s][parts[s]] += area_[f];
                    if (!borders_[k]) borders_[k].emplace(parts.begin(), parts.end());
                    std::erase_if(*borders_[k],
                                  [&](uint32_t id) { return id != parts[0] && id != parts[1]; });
                }
        owner_.resize(faces_.size());
        for (uint32_t k = 0; k < faces_.size(); ++k)
            for (uint32_t s = 0; s < 2; ++s)
                if (!bounds[k][s].empty())
                    owner_[k][s] = std::ranges::max_element(bounds[k][s], {}, [](const auto& b) {
                                       return b.second;
                                   })->first;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const auto& drawn = sheetOf(f).drawn;
            if (drawn[0].empty() == drawn[1].empty()) continue; // faces that look both ways say nothing
            const uint32_t turned = drawn[0].empty() ? 1 : 0;
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t id = partAt(f, s);
                if (std::ranges::none_of(drawn[turned],
                                         [&](uint32_t k) { return owner_[k][s == turned ? 0 : 1] == id; }))
                    continue;
                parts_[id].drawnInwards += s == turned ? area_[f] : -area_[f];
                parts_[id].drawn += area_[f];
            }
        }
    }

    // How a part of space stands in another one, told from what was drawn of its boundary.
    struct Stand {
        bool within = false; // it takes a piece out of a room that was drawn without regard to it
        bool touchesWall = false;
        bool drawnThere = false; // it has faces of its own where it touches that room's
    };

    static bool contrary(const Part& part, const Part& largest) {
        return largest.looksIn() && part.looksOut();
    }

    static bool isSolid(const Stand& stand, const Part& part, const Part& largest, double height) {
        const bool thin = 2 * part.volume < kThin * height * part.area,
                   agreed = largest.looksIn() && part.looksIn();
        if (contrary(part, largest))
            return thin || (stand.within && (!stand.touchesWall || part.volume < kSmall * largest.volume));
        if (!stand.within) return false;
        if (!stand.touchesWall) return thin || !agreed; // a column, a block on the floor
        return thin && stand.drawnThere && !agreed;
    }

    Stand standOf(uint32_t id) {
        const Part& part = parts_[id];
        Stand out;
        double alone = 0; // where nothing but its own faces parts it from the outside
        bool touches = false;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f)
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t other = partAt(f, 1 - s);
                if (partAt(f, s) != id || other == id) continue;
                touches |= parts_[other].solid;
                if (parts_[other].volume > 0) continue;
                const auto& drawn = sheetOf(f).drawn;
                bool beyond = false, own = false; // faces that reach beyond its own boundary
                for (const auto& list : drawn)
                    for (const uint32_t k : list) (borders_[k]->contains(id) ? own : beyond) = true;
                if (!beyond && (drawn[0].empty() || drawn[1].empty())) {
                    alone += area_[f];
                    continue;
                }
                touches = true;
                out.drawnThere |= own;
                out.touchesWall |= std::abs(normalOf(welded_.faces[f]).y) < 0.7;
            }
        out.within = touches && alone < kNothing * part.area;
        return out;
    }

    // Which parts are rooms, and of which room's air those are that lie outside of a shell.
    bool placeParts() {
        std::map<uint32_t, std::vector<uint32_t>> shells; // parts of each
        for (const auto& [id, part] : parts_) shells[part.shell].push_back(id);
        std::map<uint32_t, std::vector<uint32_t>> around; // per shell: bounded parts of others that hold it
        for (const auto& [shell, own] : shells)
            for (const auto& [id, part] : parts_)
                if (part.shell != shell && part.volume > 0 && !part.triangles.empty() &&
                    crossings(part.triangles, parts_[own[0]].triangles.front().a) % 2 == 1)
                    around[shell].push_back(id);
        const auto nested = [&](uint32_t shell) { return around[shell].size() % 2 == 1; };
        dropOutsides(shells, around);
        findWallsOfWindows(shells, around);
        for (auto& [id, part] : parts_) // nothing but a closed box in a room's air
            part.solid |= part.volume > 0 && nested(part.shell) && shells[part.shell].size() == 2;
        findWallsAllRound();
        findSolids(nested);
        for (auto& [id, part] : parts_)
            if (part.volume > 0 && !part.solid) part.room = static_cast<int>(rooms_++);
        for (auto& [id, part] : parts_) {
            if (part.volume > 0 || !nested(part.shell)) continue;
            const auto& holders = around[part.shell];
            part.room = parts_[*std::ranges::max_element(holders, {}, [&](uint32_t o) {
                            return around[parts_[o].shell].size();
                        })].room;
        }
        countSolids();
        return rooms_ > 0;
    }

    // Those found, by whether a room's air touches them.
    void countSolids() {
        std::set<uint32_t> inRooms;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f)
            for (uint32_t s = 0; s < 2; ++s)
                if (parts_[partAt(f, 1 - s)].room >= 0) inRooms.insert(partAt(f, s));
        for (const auto& [id, volume] : found_) {
            if (!inRooms.contains(id)) {
                ++solidsOutside_;
                continue;
            }
            ++solids_;
            largestSolid_ = std::max(largestSolid_, volume);
        }
    }

    // The outside of walls that have a thickness is no room, as in nestShells().
    void dropOutsides(const std::map<uint32_t, std::vector<uint32_t>>& shells,
                      std::map<uint32_t, std::vector<uint32_t>>& around) {
        constexpr double kFilled = 0.125;
        std::vector<uint32_t> outsides;
        for (const auto& [id, outer] : parts_) {
            if (outer.volume <= 0 || shells.at(outer.shell).size() != 2 || !around[outer.shell].empty() ||
                !outer.looksOut())
                continue;
            double filled = 0;
            bool inwards = true;
            for (const auto& [other, part] : parts_)
                if (part.volume > 0 && around[part.shell] == std::vector<uint32_t>{id}) {
                    filled += part.volume;
                    inwards = inwards && part.looksIn();
                }
            if (inwards && filled > kFilled * outer.volume) outsides.push_back(id);
        }
        for (const uint32_t id : outsides) {
            parts_[id].solid = true;
            for (auto& [shell, holders] : around) std::erase(holders, id);
        }
        outsides_ = outsides.size();
    }

    // Walls, however thick, round rooms that have windows: glass has none in them. What touches such a room
    // and the outside is its walls where nothing but that and glass parts the rooms from the outside, unless
    // its faces look as theirs do; where several parts do, or floors and ceilings are drawn without
    // thickness, it must look out, and in the latter case reach as far as the rooms all round.
    std::vector<uint32_t> wallsOfWindows(const std::vector<uint32_t>& parts) const {
        std::vector<uint32_t> rooms, walls;
        Bounds all{dvec3(1e300), dvec3(-1e300)};
        bool open = false, lookIn = true;
        double largest = 0; // what is small beside it, as bars of a frame, is found with other solids
        for (const uint32_t id : parts) {
            const Part& part = parts_.at(id);
            if (part.volume <= 0 || part.window == 0) continue;
            rooms.push_back(id);
            const Bounds box = part.box();
            all = {glm::min(all.low, box.low), glm::max(all.high, box.high)};
            open |= part.open > kNothing * part.area;
            lookIn &= part.looksIn();
            largest = std::max(largest, part.volume);
        }
        for (const uint32_t id : parts) {
            const Part& part = parts_.at(id);
            if (part.volume <= kSmall * largest || part.solid || part.glass > 0 || part.open == 0) continue;
            const bool beside =
                std::ranges::any_of(rooms, [&](uint32_t room) { return part.neighbours.contains(room); });
            if (beside && !(lookIn && part.looksIn()) && (!open || isRound(part.box(), all, tolerance_)))
                walls.push_back(id);
        }
        if (open || walls.size() > 1)
            std::erase_if(walls, [&](uint32_t id) { return !lookIn || !parts_.at(id).looksOut(); });
        return walls;
    }

    void findWallsOfWindows(const std::map<uint32_t, std::vector<uint32_t>>& shells,
                            std::map<uint32_t, std::vector<uint32_t>>& around) {
        for (const auto& [shell, own] : shells) {
            if (!around[shell].empty()) continue;
            for (const uint32_t id : wallsOfWindows(own)) {
                ++walls_;
                parts_[id].solid = true;
                for (auto& [other, holders] : around) std::erase(holders, id);
            }
        }
    }

    // On all six sides, or no more than `within` short of it.
    static bool isRound(const Bounds& box, const Bounds& inner, double within = 0) {
        return glm::all(glm::lessThan(box.low, inner.low + within)) &&
               glm::all(glm::greaterThan(box.high, inner.high - within));
    }

    // What is round all others, no larger than these together, with faces that look out of it.
    void findWallsAllRound() {
        for (auto& [id, part] : parts_) {
            if (part.volume <= 0 || part.solid || !part.looksOut()) continue;
            const Bounds box = part.box();
            double inner = 0;
            bool round = true;
            for (const auto& [other, room] : parts_) {
                if (other == id || room.volume <= 0 || room.solid) continue;
                inner += room.volume;
                round = round && !room.looksOut() && isRound(box, room.box());
            }
            if (!round || inner < part.volume) continue;
            part.solid = true;
            ++walls_;
        }
    }

    // What stands on a solid is one after that was found.
    template<class Nested> void findSolids(Nested nested) {
        const auto air = [](const auto& p) { return p.second.solid ? 0 : p.second.volume; };
        const auto& [first, largest] = *std::ranges::max_element(parts_, {}, air);
        const Bounds room = largest.box();
        const double height = room.high.y - room.low.y;
        for (bool changed = true; changed;) {
            changed = false;
            contrary_ = insides_ = 0;
            for (auto& [id, part] : parts_) {
                if (id == first || part.volume <= 0 || part.solid || isBehindGlass(part, largest)) continue;
                Stand stand = standOf(id);
                stand.within |= nested(part.shell);
                if (isSolid(stand, part, largest, height)) {
                    part.solid = changed = true;
                    if (isRound(part.box(), room)) {
                        ++walls_;
                        continue;
                    }
                    found_[id] = part.volume / largest.volume;
                } else {
                    contrary_ += contrary(part, largest);
                    insides_ += stand.within && !stand.touchesWall;
                }
            }
        }
    }

    // Of the faces drawn on a sheet, the one for the side: that which is turned as those about it, and of
    // several such its own, and the smaller one (drawn on the other). Where nothing is behind the sheet a
    // smaller one that is turned over is drawn on the other, too, unless its like cover half of that: those
    // are the wall as seen from outside.
    uint32_t drawnFor(uint32_t f, uint32_t side) {
        const Sheet& sheet = sheetOf(f);
        const uint32_t id = partAt(f, side);
        const Part& behind = parts_[partAt(f, 1 - side)];
        const size_t first = parts_[id].drawnInwards >= 0 ? side : 1 - side;
        const auto& list = sheet.drawn[first].empty() ? sheet.drawn[1 - first] : sheet.drawn[first];
        const auto& turned = sheet.drawn[first].empty() ? sheet.drawn[first] : sheet.drawn[1 - first];
        const auto rank = [&](uint32_t k) {
            return std::pair(owner_[k][0] != id && owner_[k][1] != id, drawnArea_[k]);
        };
        // No larger than the other but for rounding.
        const auto rivals = [&](uint32_t k, uint32_t other) {
            return rank(k).first == rank(other).first && rank(k).second < rank(other).second * 1.001;
        };
        const auto looksOther = [&](uint32_t k, uint32_t other) {
            return faces_[k].material != faces_[other].material || faces_[k].role != faces_[other].role;
        };
        const uint32_t best = *std::ranges::min_element(list, {}, rank);
        if (behind.room < 0 && behind.volume <= 0 && !turned.empty()) {
            const uint32_t over = *std::ranges::min_element(turned, {}, rank);
            if (!rivals(best, over) && rivals(over, best) && backed_[best] < 0.5 * drawnArea_[best]) {
                if (looksOther(over, best)) covered_.insert(f);
                for (const uint32_t k : turned) unclear_ |= rivals(k, over) && looksOther(k, over);
                return over;
            }
        }
        for (const uint32_t k : list) {
            if (!looksOther(k, best) || rank(k).first != rank(best).first) continue;
            unclear_ |= rivals(k, best);
            covered_.insert(f);
        }
        return best;
    }

    SharedWalls answer() {
        SharedWalls out;
        out.rooms = rooms_;
        size_t shared = 0; // walls that two rooms see
        std::set<uint32_t> meeting;
        std::vector<SoupFace> outside;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const Sheet& sheet = sheetOf(f);
            std::vector<uint32_t> all = sheet.drawn[0];
            all.insert(all.end(), sheet.drawn[1].begin(), sheet.drawn[1].end());
            for (size_t k = 1; k < all.size(); ++k)
                out.pairs.push_back({faces_[all[0]].surface, faces_[all[k]].surface});
            const size_t before = out.faces.size();
            const size_t outsideBefore = outside.size();
            addSides(f, all[0], out.faces, outside);
            const size_t sides = out.faces.size() - before;
            if (sides == 0 &&
                std::ranges::none_of(all, [&](uint32_t k) { return isGlass_(faces_[k].material); }))
                out.outer.insert(out.outer.end(),
                                 outside.begin() + static_cast<std::ptrdiff_t>(outsideBefore), outside.end());
            shared += sides == 2;
            if (sides == 1 && all.size() > 1) meeting.insert(all.begin(), all.end());
        }
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (pieces_[k] > 1) meeting.insert(k);
        out.repairs = repairs(shared, meeting.size());
        out.warnings = guesses();
        out.outside = weldFaces(outside, 1, tolerance_);
        return out;
    }

    // The sides of a welded face, to the rooms that see them and to the outside; nobody sees `unseen` there.
    void addSides(uint32_t f, uint32_t unseen, std::vector<SoupFace>& inRooms,
                  std::vector<SoupFace>& outside) {
        for (uint32_t s = 0; s < 2; ++s) {
            const Part& part = parts_[partAt(f, s)];
            if (part.volume > 0 && part.room < 0) continue;
            SoupFace face = faces_[part.room < 0 ? unseen : drawnFor(f, s)];
            face.loops.clear();
            for (const auto& loop : welded_.faces[f].loops) {
                face.loops.emplace_back();
                for (const uint32_t v : loop) face.loops.back().push_back(welded_.vertices[v]);
                if (s) std::ranges::reverse(face.loops.back());
            }
            if (part.volume <= 0) {
                face.room = 0;
                outside.push_back(face);
            }
            if (part.room < 0) continue;
            face.room = static_cast<uint32_t>(part.room);
            inRooms.push_back(std::move(face));
        }
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
        if (walls_ > 0) out.push_back(counted(walls_, "space") + " round the room taken as its walls");
        if (meeting > 0)
            out.push_back(
                fmt::format("{} divided where others lie on or end on {}, and one is seen in each place",
                            countedWere(meeting, "face"), meeting == 1 ? "it" : "them"));
        return out;
    }

    std::vector<std::string> guesses() const {
        const auto oneOrMany = [](size_t n, const char* one, const char* many) {
            return n == 1 ? fmt::format("1 {}", one) : fmt::format("{} {}", n, many);
        };
        std::vector<std::string> out;
        if (outsides_ > 0)
            out.push_back(oneOrMany(outsides_,
                                    "outside of walls was left out: only shells within it are rooms",
                                    "outsides of walls were left out: only shells within them are rooms"));
        if (solids_ > 0)
            out.push_back(
                fmt::format("{} {:.2g} % of the largest room's volume: what stands in a room is solid unless "
                            "its faces look into it as those of the room do, and so is what is small or thin "
                            "and has faces that look out",
                            oneOrMany(solids_, "solid was cut out of the room where it stands, of",
                                      "solids were cut out of the room where they stand, the largest of"),
                            100 * largestSolid_));
        if (solidsOutside_ > 0)
            out.push_back(oneOrMany(
                solidsOutside_,
                "solid touches no room, as what stands outside a window: it was not taken as a room",
                "solids touch no room, as what stands outside a window: they were not taken as rooms"));
        if (insides_ > 0)
            out.push_back(oneOrMany(
                insides_, "space within a room was taken as a room of its own: its faces look into it",
                "spaces within a room were taken as rooms: their faces look into them"));
        if (contrary_ > 0)
            out.push_back(oneOrMany(
                contrary_,
                "space was taken as a room though its faces look out of it (those of the largest look in)",
                "spaces were taken as rooms though their faces look out of them (those of the largest look "
                "in)"));
        return out;
    }

    const std::vector<SoupFace>& faces_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    std::vector<Sheet> sheets_;
    Building welded_;          // the sheets; surface: into sheets_
    std::vector<double> area_; // per sheet as welded
    // Side 2 f of a welded face is the one that its normal points to, 2 f + 1 the other: by the part of space
    // that they bound. Faces by common edges.
    DisjointSets sides_, shells_;
    std::map<uint32_t, Part> parts_; // by the root of their sides
    // Per given face: the parts that all of it borders on, the owners in front and behind.
    std::vector<std::optional<std::set<uint32_t>>> borders_;
    std::vector<std::array<uint32_t, 2>> owner_;
    std::vector<uint32_t> pieces_;           // sheets that it lies on
    std::vector<double> drawnArea_, backed_; // of these, and where others lie on it that are turned over
    std::set<uint32_t> covered_;             // sheets of different materials of which the smaller is seen
    uint32_t rooms_ = 0;
    std::map<uint32_t, double>
        found_; // solids that stand against walls or floors: of the largest part's volume
    size_t solids_ = 0, solidsOutside_ = 0; // of these
    double largestSolid_ = 0;
    size_t walls_ = 0;                  // solids all round the largest part
    size_t outsides_ = 0;               // of walls with a thickness
    size_t contrary_ = 0, insides_ = 0; // rooms whose faces look out, or that stand in others
    bool unclear_ = false;              // two materials in one place
};

} // namespace

std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces,
                                       const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    return SpaceDivider(faces, isGlass, tolerance).divide();
}

} // namespace heliodon::geometry
