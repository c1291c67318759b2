#include "geometry/sheet_boards.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/drawn_once.h"
#include "geometry/flat_faces.h"
#include "geometry/model_faces.h"
#include "geometry/open_sheets.h"
#include "geometry/outline_area.h"
#include "geometry/ray_triangle.h"
#include "geometry/sheet_bodies.h"
#include "geometry/sheet_rooms.h"
#include "geometry/sheet_walls.h"
#include "geometry/shell_faces.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kMostOffset = 5;     // thicknesses: at the tip of a sharp fold
constexpr double kAlmost = 0.25;      // of `near`: a sheet that ends so little before a wall was to reach it
constexpr double kNearlyFlat = 1e-12; // below 1e-16 a determinant is rounding
constexpr double kOfFlat = 0.01;      // more than one has no offset between planes that are one or nearly so
constexpr double kHold = 1e-4;
constexpr double kParallel = 0.9;   // least cosine to a wall behind: the floor is none
constexpr double kOnPlane = 0.98;   // cosine: a sheet along a wall goes on from it, and stands not on it
constexpr double kThickest = 25;    // times `near`: sheets no farther apart may be the sides of a body
constexpr double kNoAccount = 0.01; // tolerances: nearer a wall's plane than this a rim stays as it is
constexpr double kThick = 0.6;      // least part of its thickness where a rim slides along a wall
constexpr double kPlanar = kPlanarOfExtent / kWeldOfExtent; // tolerances: what rooms take as flat

std::vector<SoupFace> numbered(std::vector<SoupFace> faces) {
    for (uint32_t k = 0; k < faces.size(); ++k) faces[k].surface = k;
    return faces;
}

class BoardMaker {
public:
    // `all`: the walls and the glass. `isInRoom`: of a point, whether these enclose it.
    BoardMaker(const std::vector<SoupFace>& sheets, const SheetWalls& walls, const SheetWalls& all,
               const std::function<bool(dvec3)>& isInRoom, double thickness, double near, double tolerance)
        : sheets_(sheets), walls_(walls), all_(all), isInRoom_(isInRoom), thickness_(thickness), near_(near),
          tolerance_(tolerance), welded_(weldedByNumber(sheets, tolerance)) {}

    // `apart`: sheets where a third one ends on them, all along that line. False where a sheet has one side
    // alone, or ends a hair before a wall, or nothing is `apart` that would not be.
    bool make(std::vector<SoupFace>& out, bool apart) {
        const auto edges = facesOfEdges(welded_);
        apart_ = apart;
        if (!findJoints(edges)) return false;
        DisjointSets sets(welded_.faces.size());
        for (const Edge& joint : joints_) sets.join(edges.at(joint)[0], edges.at(joint)[1]);
        std::map<uint32_t, std::vector<uint32_t>> wholes;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) wholes[sets.root(f)].push_back(f);
        return std::ranges::all_of(wholes,
                                   [&](const auto& whole) { return makeOne(whole.second, edges, out); });
    }

private:
    using Corner = std::pair<uint32_t, uint32_t>; // vertex, face

    // Edges over which two sheets are one board. False where none is apart that would not be.
    bool findJoints(const std::map<Edge, std::vector<uint32_t>>& edges) {
        std::vector<Edge> next;
        std::map<uint32_t, std::vector<Edge>> joints; // per vertex
        for (const auto& [edge, around] : edges) {
            if (around.size() > 2) next.push_back(edge);
            if (around.size() != 2) continue;
            joints_.insert(edge);
            joints[edge.first].push_back(edge), joints[edge.second].push_back(edge);
        }
        const auto way = [&](const Edge& edge) {
            return glm::normalize(welded_.vertices[edge.second] - welded_.vertices[edge.first]);
        };
        bool any = !apart_;
        while (apart_ && !next.empty()) {
            const Edge edge = next.back();
            next.pop_back();
            for (const uint32_t v : {edge.first, edge.second})
                for (const Edge& other : joints[v])
                    if (std::abs(glm::dot(way(edge), way(other))) > kOnePlaneCosine && joints_.erase(other))
                        next.push_back(other), any = true;
        }
        return any;
    }

    bool makeOne(const std::vector<uint32_t>& members, const std::map<Edge, std::vector<uint32_t>>& edges,
                 std::vector<SoupFace>& out) {
        over_.clear();
        if (!orient(members, edges)) return false;
        findFans(members, edges);
        std::map<uint32_t, std::pair<glm::dmat3, dvec3>> planes; // per fan, sums over its faces
        for (const auto& [corner, fan] : fan_) {
            const dvec3 n = normalOf(corner.second);
            auto& [a, b] = planes.try_emplace(fan, glm::dmat3(1e-9), dvec3(0)).first->second;
            a += glm::outerProduct(n, n), b += n;
        }
        offset_.clear();
        for (const auto& [fan, sums] : planes) offset_[fan] = offsetFrom(sums.first, sums.second);
        for (const auto& [fan, normals] : normalsAtRim(members))
            slide(offset_.at(fan), planes.at(fan).first, planes.at(fan).second, normals);
        if (endsAlmostOnWalls(members, edges)) return false;
        const auto [ahead, behind] = depths(members);
        for (const uint32_t f : members) addSides(f, ahead, behind, out);
        return true;
    }

    // Per corner of a face: faces round a vertex that hang together by joints move as one there, or all.
    void findFans(const std::vector<uint32_t>& members, const std::map<Edge, std::vector<uint32_t>>& edges) {
        std::map<Corner, uint32_t> number;
        for (const uint32_t f : members)
            for (const auto& loop : welded_.faces[f].loops)
                for (const uint32_t v : loop)
                    number.try_emplace({v, f}, static_cast<uint32_t>(number.size()));
        DisjointSets sets(number.size());
        for (const uint32_t f : members)
            eachEdge(f, [&](uint32_t a, uint32_t b) {
                if (!isJoint(a, b)) return;
                for (const uint32_t g : edges.at(std::minmax(a, b)))
                    for (const uint32_t v : {a, b}) sets.join(number.at({v, f}), number.at({v, g}));
            });
        if (!apart_)
            for (auto one = number.begin(), next = one; ++next != number.end(); one = next)
                if (one->first.first == next->first.first) sets.join(one->second, next->second);
        fan_.clear();
        for (const auto& [corner, k] : number) fan_[corner] = sets.root(k);
    }

    bool isJoint(uint32_t a, uint32_t b) const { return joints_.contains(std::minmax(a, b)); }

    // As the face runs.
    template<class Take> void eachEdge(uint32_t f, const Take& take) const {
        for (const auto& loop : welded_.faces[f].loops)
            for (size_t k = 0; k < loop.size(); ++k) take(loop[k], loop[(k + 1) % loop.size()]);
    }

    // Least squares: by which all planes move by one. Where they are one plane or nearly so, the inverse may
    // be that of rounding errors; then it is held near what the mean plane asks for.
    static dvec3 offsetFrom(const glm::dmat3& squares, dvec3 sum) {
        const double all = squares[0][0] + squares[1][1] + squares[2][2];
        const dvec3 d = glm::inverse(squares) * sum;
        const bool isFlat =
            glm::determinant(squares) < kNearlyFlat * all * all * all && glm::length(sum) > 0.5;
        if (isFlat && (glm::length(d) > 1 + kOfFlat || glm::length(squares * d - sum) > 1e-6 * all))
            return glm::inverse(squares + glm::dmat3(kHold)) * (sum + kHold * glm::normalize(sum));
        return d * std::min(1.0, kMostOffset / glm::length(d));
    }

    // Per fan at the rim, of what that stands on.
    std::map<uint32_t, std::vector<dvec3>> normalsAtRim(const std::vector<uint32_t>& members) const {
        std::map<uint32_t, std::vector<dvec3>> out;
        for (const uint32_t f : members)
            eachEdge(f, [&](uint32_t a, uint32_t b) {
                if (isJoint(a, b)) return;
                for (const dvec3 n : all_.normalsAlong(welded_.vertices[a], welded_.vertices[b]))
                    if (std::abs(glm::dot(n, normalOf(f))) < kOnPlane)
                        for (const uint32_t v : {a, b}) out[fan_.at({v, f})].push_back(n);
            });
        return out;
    }

    // The rim of a leaning sheet would half leave the floor, by as little as corners are welded within: there
    // it moves in the floor's plane, along that of the sheet. Where it lies in several planes, it keeps to
    // those that turn it least, and to none that it is too nearly parallel to.
    void slide(dvec3& offset, const glm::dmat3& squares, dvec3 sum, std::vector<dvec3> normals) const {
        const auto off = [&](dvec3 n) { return std::abs(glm::dot(n, offset)); };
        const double least = kNoAccount * tolerance_ / near_;
        if (std::ranges::all_of(normals, [&](dvec3 n) { return off(n) <= least; })) return;
        std::ranges::stable_sort(normals, {}, off);
        dvec3 slid = offset;
        glm::dmat3 freedom = glm::inverse(squares + glm::dmat3(kHold)); // large along the sheet
        const double faces = squares[0][0] + squares[1][1] + squares[2][2];
        for (const dvec3 n : normals) {
            const dvec3 along = freedom * n;
            const double most = glm::dot(n, along);
            if (most < kHold) continue; // as one before, or nothing is left free
            const dvec3 to = slid - along * (glm::dot(n, slid) / most);
            if (!(glm::length(to) <= kMostOffset && glm::dot(sum, to) >= kThick * faces)) continue;
            slid = to;
            freedom -= glm::outerProduct(along, along) / most;
        }
        offset = slid;
    }

    // Over its edges, all sheets to one side.
    bool orient(const std::vector<uint32_t>& members, const std::map<Edge, std::vector<uint32_t>>& edges) {
        std::vector<uint32_t> next{members[0]};
        over_[members[0]] = false;
        while (!next.empty()) {
            const uint32_t f = next.back();
            next.pop_back();
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t k = 0; k < loop.size(); ++k) {
                    const uint32_t from = loop[k], to = loop[(k + 1) % loop.size()];
                    if (!isJoint(from, to)) continue;
                    const auto& around = edges.at(std::minmax(from, to));
                    const uint32_t g = around[0] == f ? around[1] : around[0];
                    const bool over = over_.at(f) != runs(g, from, to);
                    const auto [known, isNew] = over_.try_emplace(g, over);
                    if (isNew) next.push_back(g);
                    if (known->second != over) return false;
                }
        }
        return true;
    }

    bool endsAlmostOnWalls(const std::vector<uint32_t>& members,
                           const std::map<Edge, std::vector<uint32_t>>& edges) const {
        for (const uint32_t f : members)
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t k = 0; k < loop.size(); ++k) {
                    const uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
                    if (edges.at(std::minmax(a, b)).size() != 1) continue;
                    const dvec3 from = welded_.vertices[a], to = welded_.vertices[b],
                                n = areaVector(welded_.vertices, welded_.faces[f].loops[0]),
                                outwards = glm::normalize(glm::cross(to - from, n));
                    const double gap = walls_.nearest(0.5 * (from + to), outwards, kAlmost * near_);
                    if (gap > tolerance_ && gap <= kAlmost * near_) return true;
                }
        return false;
    }

    bool runs(uint32_t f, uint32_t from, uint32_t to) const {
        return std::ranges::any_of(welded_.faces[f].loops, [&](const std::vector<uint32_t>& loop) {
            for (size_t k = 0; k < loop.size(); ++k)
                if (loop[k] == from && loop[(k + 1) % loop.size()] == to) return true;
            return false;
        });
    }

    dvec3 normalOf(uint32_t f) const {
        const dvec3 n = glm::normalize(areaVector(welded_.vertices, welded_.faces[f].loops[0]));
        return over_.at(f) ? -n : n;
    }

    // How far it reaches before the sheet and behind it.
    std::pair<double, double> depths(const std::vector<uint32_t>& members) {
        onWall_.reset();
        const dvec3 n = normalOf(members[0]);
        const double half = 0.5 * thickness_;
        if (std::ranges::any_of(members,
                                [&](uint32_t f) { return glm::dot(normalOf(f), n) < kOnePlaneCosine; }))
            return {half, half};
        for (const double side : {1.0, -1.0})
            if (const Gap gap = gapTo(walls_, members, side * n, near_); gap.all) {
                if (!isRoomBehind(members, side * n, gap.most)) return reach(gap, side);
                if (leans(gap)) return side > 0 ? std::pair(0.0, thickness_) : std::pair(thickness_, 0.0);
                onWall_ = {side * gap.most, walls_.materialAt(middleOf(members[0]), side * n, gap.most)};
                return reach(gap, side);
            }
        // Half over a window, and nearer than a board reaches; one that leans is cut off by the wall.
        for (const double side : {1.0, -1.0})
            if (const Gap gap = gapTo(all_, members, side * n, half - tolerance_);
                gap.all && !leans(gap) && gapTo(walls_, members, side * n, half - tolerance_).any)
                return reach(gap, side);
        return {half, half};
    }

    // Of a wall without thickness: a board that leans would reach into that room.
    bool isRoomBehind(const std::vector<uint32_t>& members, dvec3 way, double gap) const {
        return std::ranges::any_of(members, [&](uint32_t f) {
            const dvec3 p = middleOf(f) + (gap + thickness_) * way;
            return walls_.nearest(p, way, kThickest * near_) > kThickest * near_ && isInRoom_(p);
        });
    }

    dvec3 middleOf(uint32_t f) const {
        dvec3 middle(0);
        const auto& loop = welded_.faces[f].loops[0];
        for (const uint32_t v : loop) middle += welded_.vertices[v] / double(loop.size());
        return middle;
    }

    struct Gap {
        bool all = true, any = false; // of the corners have something behind them
        double least, most = 0;
    };

    Gap gapTo(const SheetWalls& walls, const std::vector<uint32_t>& members, dvec3 way, double within) const {
        Gap gap{.least = within};
        for (const uint32_t f : members) {
            const dvec3 middle = middleOf(f);
            for (const uint32_t v : welded_.faces[f].loops[0]) { // not along the border of the wall
                const dvec3 p = glm::mix(welded_.vertices[v], middle, 1e-3);
                const double far = walls.nearest(p, way, within, kParallel);
                gap.all &= far <= within, gap.any |= far <= within;
                gap.least = std::min(gap.least, far), gap.most = std::max(gap.most, far);
            }
        }
        return gap;
    }

    bool leans(const Gap& gap) const { return gap.most - gap.least > tolerance_; }

    std::pair<double, double> reach(const Gap& gap, double side) const {
        const double back = leans(gap) ? gap.most + thickness_ : gap.most; // leaning ones into it
        return side > 0 ? std::pair(back, 0.0) : std::pair(0.0, back);
    }

    void addSides(uint32_t f, double ahead, double behind, std::vector<SoupFace>& out) const {
        const Face& face = welded_.faces[f];
        const SoupFace& sheet = sheets_[face.surface];
        const bool over = over_.at(f);
        const auto at = [&](uint32_t v, double depth) {
            return welded_.vertices[v] + depth * offset_.at(fan_.at({v, f}));
        };
        // As it is drawn, and its back.
        const double drawn = over ? -behind : ahead, turned = over ? ahead : -behind;
        const auto add = [&](const std::vector<std::vector<dvec3>>& loops, uint32_t material) {
            out.push_back(sheet);
            out.back().loops = loops;
            out.back().material = material;
        };
        // Of corners with offsets of their own; triangles where it is bent by them.
        const auto addSide = [&](double depth, bool isBack) {
            const uint32_t material = onWall_ && depth == onWall_->first ? onWall_->second
                                      : isBack ? sheet.behind.value_or(sheet.material)
                                               : sheet.material;
            const auto moved = [&](const auto& corners) {
                std::vector<dvec3> loop;
                for (const uint32_t v : corners) loop.push_back(at(v, depth));
                if (isBack) std::ranges::reverse(loop);
                return loop;
            };
            std::vector<std::vector<dvec3>> loops;
            for (const auto& loop : face.loops) loops.push_back(moved(loop));
            if (isFlat(loops)) return add(loops, material);
            for (const auto& triangle : triangulateFace(welded_, face)) add({moved(triangle)}, material);
        };
        eachEdge(f, [&](uint32_t a, uint32_t b) {
            if (isJoint(a, b)) return;
            const std::vector<dvec3> rim{at(a, turned), at(b, turned), at(b, drawn), at(a, drawn)};
            const dvec3 n = glm::normalize(areaVector(rim));
            if (std::abs(glm::dot(rim[1] - rim[0], n)) + std::abs(glm::dot(rim[3] - rim[0], n)) < tolerance_)
                add({rim}, sheet.material);
            else
                add({{rim[0], rim[1], rim[2]}}, sheet.material),
                    add({{rim[0], rim[2], rim[3]}}, sheet.material);
        });
        addSide(drawn, false), addSide(turned, true);
    }

    bool isFlat(const std::vector<std::vector<dvec3>>& loops) const {
        const dvec3 n = glm::normalize(areaVector(loops[0]));
        return std::ranges::all_of(loops, [&](const std::vector<dvec3>& loop) {
            return std::ranges::all_of(loop, [&](dvec3 p) {
                return std::abs(glm::dot(p - loops[0][0], n)) <= kPlanar * tolerance_;
            });
        });
    }

    const std::vector<SoupFace>& sheets_;
    const SheetWalls &walls_, &all_;
    const std::function<bool(dvec3)>& isInRoom_;
    double thickness_, near_, tolerance_;
    Building welded_;
    std::map<uint32_t, bool> over_; // per face of one whole
    bool apart_ = false;
    std::set<Edge> joints_;
    // Of one whole that lies on a wall without thickness: what the next room sees there, and how far it is.
    std::optional<std::pair<double, uint32_t>> onWall_;
    std::map<Corner, uint32_t> fan_;   // of one whole
    std::map<uint32_t, dvec3> offset_; // per fan of one whole: by which all its faces move by one
};

// Most of it, on both its sides.
bool liesIn(const SheetRooms& rooms, const FlatFace& piece, double tolerance) {
    const ShellTriangle& t = largestTriangle(piece);
    return std::ranges::all_of(std::array{t.middle(), t.a, t.b, t.c}, [&](dvec3 corner) {
        const dvec3 p = glm::mix(t.middle(), corner, 0.8), off = 2 * tolerance * piece.normal;
        return rooms.enclose(p + off) && rooms.enclose(p - off);
    });
}

// None where BoardMaker makes none.
std::optional<SheetBoards> boardsOf(const std::set<uint32_t>& inRooms, const std::vector<SoupFace>& faces,
                                    const std::function<bool(uint32_t)>& isGlass, double thickness,
                                    double near, double tolerance, bool apart) {
    SheetBoards out{
        .faces = {}, .first = 0, .sheets = inRooms.size(), .surface = faces[*inRooms.begin()].surface};
    std::vector<SoupFace> sheets, walls;
    for (uint32_t k = 0; k < faces.size(); ++k) {
        if (inRooms.contains(k)) {
            sheets.push_back(faces[k]);
            continue;
        }
        out.faces.push_back(faces[k]);
        if (!isGlass(faces[k].material)) walls.push_back(faces[k]);
    }
    out.first = out.faces.size();
    const SheetWalls ofWalls(walls, tolerance), ofAll(out.faces, tolerance);
    std::optional<SheetRooms> rooms; // few need them
    const std::vector<SoupFace> rest = out.faces;
    const std::function<bool(dvec3)> isInRoom = [&](dvec3 p) {
        if (!rooms) rooms.emplace(rest, isGlass, tolerance);
        return rooms->enclose(p);
    };
    if (!BoardMaker(drawnOnce(sheets, tolerance), ofWalls, ofAll, isInRoom, thickness, near, tolerance)
             .make(out.faces, apart))
        return std::nullopt;
    return out;
}

} // namespace

std::vector<SheetBoards> sheetsAsBoards(const std::vector<SoupFace>& faces,
                                        const std::vector<SoupFace>& drawn,
                                        const std::function<bool(uint32_t)>& isGlass, double thickness,
                                        double near, double tolerance) {
    std::set<uint32_t> inRooms, openPieces;
    std::vector<SoupFace> pieces, left = numbered(faces);
    ptrdiff_t closed = 0; // of the pieces, before the others
    // Again for those that lie on others: of a piece that is drawn twice only one is told.
    for (bool changed = true; changed;) {
        changed = false;
        const auto parts = openSheets(
            left, [](uint32_t) { return false; }, tolerance);
        if (!parts) break;
        const SheetRooms rooms(parts->closed, isGlass, tolerance);
        const bool isFirst = pieces.empty();
        if (isFirst) pieces = parts->closed, closed = std::ssize(pieces);
        for (const FlatFace& piece : flatFacesOf(weldedByNumber(parts->open, tolerance))) {
            const SoupFace& open = parts->open[piece.surface];
            if (isGlass(open.material) || piece.triangles.empty() || !liesIn(rooms, piece, tolerance))
                continue;
            changed |= inRooms.insert(open.surface).second;
            if (isFirst) openPieces.insert(static_cast<uint32_t>(closed) + piece.surface);
        }
        if (isFirst) pieces.insert(pieces.end(), parts->open.begin(), parts->open.end());
        std::erase_if(left, [&](const SoupFace& face) { return inRooms.contains(face.surface); });
    }
    std::vector<SheetBoards> out;
    if (inRooms.empty()) return out;
    const auto isOfBody = [&](const std::set<uint32_t>& sheets) {
        std::set<uint32_t> surfaces;
        for (const uint32_t k : sheets) surfaces.insert(faces[k].surface);
        return areOfBody(drawn, surfaces, kThickest * near, tolerance);
    };
    std::vector<std::pair<std::set<uint32_t>, const std::vector<SoupFace>*>> ways;
    if (!isOfBody(inRooms)) ways.emplace_back(inRooms, &faces);
    if (std::set<uint32_t> bottoms = bottomsOf(inRooms, faces, isGlass, tolerance); !bottoms.empty()) {
        bottoms.insert(inRooms.begin(), inRooms.end());
        if (!isOfBody(bottoms)) ways.emplace_back(std::move(bottoms), &faces);
    }
    const bool closeInPart = std::any_of(pieces.begin(), pieces.begin() + closed, [&](const SoupFace& piece) {
        return inRooms.contains(piece.surface);
    });
    if (closeInPart && !areOfBody(numbered(pieces), openPieces, kThickest * near, tolerance))
        ways.emplace_back(std::move(openPieces), &pieces);
    for (SoupFace& piece : pieces) piece.surface = faces[piece.surface].surface;
    for (const bool apart : {false, true})
        for (const auto& [sheets, all] : ways)
            if (auto boards = boardsOf(sheets, *all, isGlass, thickness, near, tolerance, apart))
                out.push_back(std::move(*boards));
    return out;
}

} // namespace heliodon::geometry
