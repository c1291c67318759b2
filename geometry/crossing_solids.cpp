// A face that another body's runs through or ends on is cut along the whole plane of that one, and its parts
// again, until none is; then each part lies within another body, on its surface or beside it.
#include "geometry/crossing_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "geometry/box_tree.h"
#include "geometry/closed_pieces.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_crossing.h"
#include "geometry/face_cutting.h"
#include "geometry/flat_faces.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/outline_area.h"
#include "geometry/sheet_rooms.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"
#include "geometry/solid_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLeastOfGround = 0.25; // of the model, from above
constexpr size_t kMostSolids = 500;     // leaves in one another take the pieces' import minutes
constexpr uint32_t kNone = UINT32_MAX;  // body of what welding leaves nothing of
constexpr double kMuchOutside = 0.25;   // of a body's volume
constexpr int kSteps = 12;              // along each axis of its box, to find that

class SolidUniter {
public:
    SolidUniter(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                double tolerance, double rounding, const std::set<uint32_t>& boards)
        : given_(faces), isGlass_(isGlass), boards_(boards), tolerance_(tolerance),
          told_(std::max(tolerance, rounding)) {
        faces_ = flatFacesOf(unwelded(faces));
        findBodies(weldedByNumber(faces, tolerance));
        if (solids_.empty()) return; // nothing to meet
        boxes_ = boxesOf(faces_, tolerance);
        tree_.emplace(boxes_);
        if (solids_.size() > 1) straighten();
    }

    std::optional<UnitedSolids> unite(Solids which) {
        if (solids_.empty()) return std::nullopt;
        UnitedSolids out;
        findMeeting(which, out);
        findThrough(out);
        if (solids_.size() == 1 && !through_.empty()) straighten();
        const size_t all = meets_.size() + through_.size();
        if (all > kMostSolids || all == 0) return std::nullopt;
        std::vector<bool> isCut(given_.size(), false);
        const auto add = [&](uint32_t k, const std::vector<FlatFace>& pieces, std::vector<SoupFace>& to) {
            for (const FlatFace& piece : pieces) {
                to.push_back(given_[faces_[k].surface]);
                to.back().loops = piece.loops;
            }
        };
        for (uint32_t k = 0; k < faces_.size(); ++k) {
            const bool isSolid = meets_.contains(body_[k]) || through_.contains(body_[k]);
            if (!isSolid && (through_.empty() || !isSheet(k))) continue;
            const auto pieces = isSolid ? outside(k) : notWithin(k);
            if (!pieces) continue;
            isCut[faces_[k].surface] = true;
            add(k, pieces->kept, out.faces);
            add(k, pieces->beyond, out.beyond);
        }
        for (size_t k = 0; k < given_.size(); ++k)
            if (!isCut[k]) out.faces.push_back(given_[k]);
        for (const uint32_t body : indoor_)
            if (isMuchOutside(solids_.at(body))) out.muchOutside.push_back(firstOf(body));
        return out;
    }

private:
    struct Body {
        bool isClosed = true, hasGlass = false;
        double volume = 0; // as volumeWithin() has it
        std::vector<ShellTriangle> triangles;
    };

    // What rounding puts on corners turns the triangles of a narrow side by 1e-4 and more, and cuts along
    // their planes part far from them: each takes the plane of the largest face that it touches and lies in.
    void straighten() {
        std::vector<std::pair<double, uint32_t>> largestFirst; // by twice the area
        for (uint32_t k = 0; k < faces_.size(); ++k)
            largestFirst.emplace_back(glm::length(areaVector(faces_[k].loops[0])), k);
        std::ranges::sort(largestFirst, std::greater());
        std::vector<uint32_t> place(faces_.size());
        for (uint32_t k = 0; k < faces_.size(); ++k) place[largestFirst[k].second] = k;
        for (const auto& [area, k] : largestFirst) {
            FlatFace& face = faces_[k];
            uint32_t largest = k;
            tree_->anyHolding(face.box.high, face.box.low, [&](uint32_t i) {
                if (place[i] < place[largest] && liesIn(face, faces_[i])) largest = i;
                return false; // look at all
            });
            if (largest == k) continue;
            const FlatFace& plane = faces_[largest];
            face.normal = glm::dot(face.normal, plane.normal) < 0 ? -plane.normal : plane.normal;
            face.origin = plane.origin;
        }
    }

    bool liesIn(const FlatFace& face, const FlatFace& plane) const {
        return std::abs(glm::dot(face.normal, plane.normal)) > kOnePlaneCosine &&
               std::ranges::all_of(face.loops[0],
                                   [&](dvec3 p) { return std::abs(plane.height(p)) <= tolerance_; });
    }

    void findBodies(const Building& welded) {
        const auto place = [&](uint32_t f) { return given_[welded.faces[f].surface].surface; };
        DisjointSets sets =
            hangingTogether(welded, place, [&](uint32_t f) { return boards_.contains(place(f)); });
        std::map<uint32_t, Body> bodies; // by root
        std::vector<uint32_t> bodyOf(given_.size(), kNone);
        for (const Face& face : welded.faces) {
            const uint32_t root = sets.root(static_cast<uint32_t>(&face - welded.faces.data()));
            bodyOf[face.surface] = root;
            if (isGlass_(face.material)) bodies[root].hasGlass = true;
        }
        std::map<std::pair<uint32_t, Edge>, std::pair<int, int>>
            runs; // of a body along an edge: all, and net
        for (const Face& face : welded.faces)
            for (const auto& loop : face.loops)
                for (size_t k = 0; k < loop.size(); ++k) {
                    const uint32_t from = loop[k], to = loop[(k + 1) % loop.size()];
                    auto& [all, net] = runs[{bodyOf[face.surface], std::minmax(from, to)}];
                    ++all, net += from < to ? 1 : -1;
                }
        for (const auto& [run, times] : runs)
            if (times != std::pair(2, 0)) bodies[run.first].isClosed = false;
        for (const FlatFace& face : faces_) {
            body_.push_back(bodyOf[face.surface]);
            auto& all = bodies[body_.back()].triangles;
            all.insert(all.end(), face.triangles.begin(), face.triangles.end());
        }
        bodies.erase(kNone);
        for (auto& [root, body] : bodies) body.volume = volumeWithin(body.triangles);
        findSolids(bodies);
    }

    void findSolids(std::map<uint32_t, Body>& bodies) {
        const auto isSolid = [](const Body& body) {
            return body.isClosed && !body.hasGlass && body.volume < 0;
        };
        for (const auto& [root, body] : bodies)
            if (isSolid(body)) solids_.try_emplace(root, body.triangles, tolerance_);
        std::map<uint32_t, uint32_t> cavityOf; // the least that is round it: a house with walls
        for (const auto& [root, body] : bodies) {
            if (!body.isClosed || body.volume <= 0) continue;
            uint32_t around = kNone;
            for (const auto& [number, solid] : solids_)
                if (isRound(solid.box(), boxOf(body)) && solid.enclose(body.triangles[0].middle()) &&
                    (around == kNone || bodies[number].volume > bodies[around].volume))
                    around = number;
            if (around != kNone) cavityOf[root] = around;
        }
        for (const auto& [cavity, solid] : cavityOf) {
            auto& all = bodies[solid].triangles;
            all.insert(all.end(), bodies[cavity].triangles.begin(), bodies[cavity].triangles.end());
            solids_.erase(solid);
            solids_.try_emplace(solid, all, tolerance_);
        }
        for (uint32_t& body : body_)
            if (const auto cavity = cavityOf.find(body); cavity != cavityOf.end()) body = cavity->second;
        leaveOutGround(bodies);
    }

    static Bounds boxOf(const Body& body) {
        Bounds out{body.triangles[0].a, body.triangles[0].a};
        for (const ShellTriangle& t : body.triangles) out = united(out, boundsOf(std::array{t.a, t.b, t.c}));
        return out;
    }

    static bool isRound(const Bounds& outer, const Bounds& inner) {
        return glm::all(glm::lessThan(outer.low, inner.low)) &&
               glm::all(glm::greaterThan(outer.high, inner.high));
    }

    // The air of rooms is often drawn into it: what is much larger than the largest of all else that hangs
    // together.
    void leaveOutGround(const std::map<uint32_t, Body>& bodies) {
        std::map<uint32_t, Bounds> solids, rooms; // the latter: what else has glass
        for (const auto& [root, body] : bodies)
            if (body.hasGlass && !body.triangles.empty()) rooms[root] = boxOf(body);
        for (const auto& [body, solid] : solids_) solids[body] = solid.box();
        const double all = faces_.empty() ? 0 : areaFromAbove(boundsOfFaces(faces_));
        for (const auto& [body, ground] : solids) {
            if (areaFromAbove(ground) < kLeastOfGround * all) continue;
            std::map<uint32_t, Bounds> others = solids;
            others.erase(body);
            others.insert(rooms.begin(), rooms.end());
            Bounds largest{dvec3(0), dvec3(0)};
            while (!others.empty()) {
                Bounds whole = others.begin()->second;
                others.erase(others.begin());
                while (std::erase_if(others, [&](const auto& other) {
                    const bool touches = other.second.isNear(whole, tolerance_);
                    if (touches) whole = united(whole, other.second);
                    return touches;
                })) {
                }
                if (areaFromAbove(whole) > areaFromAbove(largest)) largest = whole;
            }
            if (solids.size() + rooms.size() < 2 || !isMuchLarger(ground, largest) || isAboveGlass(body))
                continue;
            solids_.erase(body);
            ground_.insert(body);
        }
    }

    // As a house of one piece.
    bool isAboveGlass(uint32_t body) const {
        return std::ranges::any_of(faces_, [&](const FlatFace& face) {
            return isGlass_(given_[face.surface].material) && !face.triangles.empty() &&
                   solids_.at(body).isAbove(largestTriangle(face).middle());
        });
    }

    void findMeeting(Solids which, UnitedSolids& out) {
        const auto bodiesThat = [&](Solids meet, double tolerance) {
            std::set<uint32_t> bodies;
            for (uint32_t k = 0; k < faces_.size(); ++k)
                if (solids_.contains(body_[k]) && !bodies.contains(body_[k]))
                    anyOfAnother(faces_[k], body_[k], [&](uint32_t i) {
                        if (meet == Solids::thatCross && !facesCross(faces_[k], faces_[i], tolerance))
                            return false;
                        if (bodies.empty()) out.surface = given_[faces_[k].surface].surface;
                        bodies.insert(body_[k]), bodies.insert(body_[i]);
                        return true;
                    });
            return bodies;
        };
        meets_ = bodiesThat(which, tolerance_);
        out.solids = static_cast<uint32_t>(
            (told_ > tolerance_ ? bodiesThat(Solids::thatCross, told_) : meets_).size());
    }

    bool isSheet(uint32_t k) const {
        return !solids_.contains(body_[k]) && !ground_.contains(body_[k]) &&
               !isGlass_(given_[faces_[k].surface].material);
    }

    uint32_t firstOf(uint32_t body) const { // the face in the file
        return given_[faces_[static_cast<size_t>(std::ranges::find(body_, body) - body_.begin())].surface]
            .surface;
    }

    // Solids whose faces cross the walls of rooms that are drawn without thickness, as furniture that is sunk
    // into floors.
    void findThrough(UnitedSolids& out) {
        std::vector<uint32_t> crossing;
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (solids_.contains(body_[k]) &&
                tree_->anyHolding(faces_[k].box.high, faces_[k].box.low, [&](uint32_t i) {
                    return isSheet(i) && facesCross(faces_[k], faces_[i], tolerance_);
                }))
                crossing.push_back(k);
        if (crossing.empty()) return;
        std::vector<bool> isOfSolid(given_.size(), false);
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (solids_.contains(body_[k]) || ground_.contains(body_[k])) isOfSolid[faces_[k].surface] = true;
        std::vector<SoupFace> sheets;
        for (size_t k = 0; k < given_.size(); ++k)
            if (!isOfSolid[k]) sheets.push_back(given_[k]);
        rooms_.emplace(sheets, isGlass_, tolerance_);
        std::set<uint32_t> told;
        for (const uint32_t k : crossing) {
            if (told.contains(body_[k]) || !rooms_->areCrossedBy(faces_[k], tolerance_)) continue;
            through_.insert(body_[k]);
            if (told_ > tolerance_ && !rooms_->areCrossedBy(faces_[k], told_)) continue;
            if (told.empty()) out.surfaceThrough = given_[faces_[k].surface].surface;
            told.insert(body_[k]);
        }
        out.through = static_cast<uint32_t>(told.size());
        findIndoor();
    }

    // Of those through walls the ones that meet no solid outside, which would be open without them.
    void findIndoor() {
        std::vector<uint32_t> bodies;
        std::vector<Bounds> boxes;
        for (const auto& [body, solid] : solids_) bodies.push_back(body), boxes.push_back(solid.box());
        DisjointSets clusters(bodies.size());
        const BoxTree tree(boxes);
        for (uint32_t k = 0; k < boxes.size(); ++k)
            tree.anyHolding(boxes[k].high + tolerance_, boxes[k].low - tolerance_, [&](uint32_t i) {
                clusters.join(i, k);
                return false; // look at all
            });
        std::set<uint32_t> outdoors;
        for (uint32_t k = 0; k < bodies.size(); ++k)
            if (!through_.contains(bodies[k]) && !rooms_->enclose(pointIn(bodies[k])))
                outdoors.insert(clusters.root(k));
        for (uint32_t k = 0; k < bodies.size(); ++k)
            if (through_.contains(bodies[k]) && !outdoors.contains(clusters.root(k)))
                indoor_.insert(bodies[k]);
    }

    dvec3 pointIn(uint32_t body) const {
        size_t k = 0;
        while (body_[k] != body || faces_[k].triangles.empty()) ++k; // what is closed has some
        const FlatFace& face = faces_[k];
        return largestTriangle(face).middle() - 2 * tolerance_ * face.normal;
    }

    // Whether `accepts(i)` says so of any face i of another solid near the piece.
    template<class Accepts>
    bool anyOfAnother(const FlatFace& piece, uint32_t body, const Accepts& accepts) const {
        return tree_->anyHolding(piece.box.high, piece.box.low, [&](uint32_t i) {
            return body_[i] != body && solids_.contains(body_[i]) && accepts(i);
        });
    }

    // Null where there is none.
    template<class Cuts> const FlatFace* cutting(const FlatFace& piece, const Cuts& cuts) const {
        const FlatFace* found = nullptr;
        tree_->anyHolding(piece.box.high, piece.box.low, [&](uint32_t i) {
            if (!cuts(i) || !isCutBy(piece, faces_[i], tolerance_)) return false;
            found = &faces_[i];
            return true;
        });
        return found;
    }

    // Convex pieces of a face.
    struct Pieces {
        std::vector<FlatFace> kept, beyond; // the latter: outside of the rooms whose walls it runs through
    };
    enum class Place { seen, hidden, beyond };

    // None where all of the face is seen.
    template<class Cuts, class PlaceOf>
    std::optional<Pieces> cutUp(uint32_t k, const Cuts& cuts, const PlaceOf& placeOf) const {
        Pieces out;
        bool goes = false;
        std::vector<FlatFace> next = convexParts(faces_[k]);
        while (!next.empty()) {
            const FlatFace piece = std::move(next.back());
            next.pop_back();
            if (const FlatFace* other = cutting(piece, cuts)) {
                for (FlatFace& half : halves(piece, *other)) next.push_back(std::move(half));
                continue;
            }
            const Place place = placeOf(piece);
            goes |= place != Place::seen;
            if (place != Place::hidden) (place == Place::seen ? out.kept : out.beyond).push_back(piece);
        }
        if (!goes) return std::nullopt;
        return out;
    }

    // Of a solid's face what is of the union's surface, and in rooms where the solid stands in them.
    std::optional<Pieces> outside(uint32_t k) const {
        const uint32_t body = body_[k];
        return cutUp(
            k,
            [&](uint32_t i) {
                return (body_[i] != body && meets_.contains(body_[i])) ||
                       (through_.contains(body) && isSheet(i));
            },
            [&](const FlatFace& piece) {
                if (isCovered(piece, body)) return Place::hidden;
                return !indoor_.contains(body) || rooms_->enclose(off(piece, 2)) ? Place::seen
                                                                                 : Place::beyond;
            });
    }

    // Of a sheet what a room has on one of its sides that is in no solid.
    std::optional<Pieces> notWithin(uint32_t k) const {
        const bool isNear = std::ranges::any_of(through_, [&](uint32_t body) {
            return solids_.at(body).box().isNear(faces_[k].box, tolerance_);
        });
        if (!isNear) return std::nullopt;
        return cutUp(
            k, [&](uint32_t i) { return through_.contains(body_[i]); },
            [&](const FlatFace& piece) {
                bool touches = false;
                for (const double side : {2.0, -2.0}) {
                    const dvec3 p = off(piece, side);
                    const auto holds = [&](uint32_t body) { return solids_.at(body).enclose(p); };
                    const auto holder = std::ranges::find_if(through_, holds);
                    touches |= holder != through_.end();
                    if (holder == through_.end() && (indoor_.empty() || rooms_->enclose(p)))
                        return Place::seen;
                }
                return touches ? Place::hidden : Place::seen;
            });
    }

    dvec3 off(const FlatFace& piece, double tolerances) const {
        return largestTriangle(piece).middle() + tolerances * tolerance_ * piece.normal;
    }

    bool isMuchOutside(const SolidRays& solid) const {
        int all = 0, beyond = 0;
        for (int k = 0; k < kSteps * kSteps * kSteps; ++k) {
            const dvec3 step(k % kSteps, k / kSteps % kSteps, k / kSteps / kSteps),
                size = solid.box().high - solid.box().low,
                p = solid.box().low + (step + 0.5) / double(kSteps) * size;
            if (!solid.enclose(p)) continue;
            ++all;
            beyond += !rooms_->enclose(p);
        }
        return beyond > kMuchOutside * all;
    }

    // What lies on another surface that looks the same way is the earlier body's. Of what only comes near
    // one, where both part at a small angle, its own place tells.
    bool isCovered(const FlatFace& piece, uint32_t body) const {
        return std::ranges::any_of(meets_, [&](uint32_t other) {
            if (other == body) return false;
            const SolidRays& solid = solids_.at(other);
            const bool before = solid.enclose(off(piece, 2)), behind = solid.enclose(off(piece, -2));
            if (before != behind && !liesOn(piece, other)) return solid.enclose(off(piece, 0));
            return before || (behind && other < body);
        });
    }

    bool liesOn(const FlatFace& piece, uint32_t body) const {
        const dvec3 p = off(piece, 0);
        if (isThin(largestTriangle(piece), 2 * tolerance_)) return true; // as good as
        return tree_->anyHolding(p, p, [&](uint32_t i) {
            return body_[i] == body && std::abs(faces_[i].height(p)) <= 2 * tolerance_ &&
                   std::abs(glm::dot(piece.normal, faces_[i].normal)) > kOnePlaneCosine;
        });
    }

    const std::vector<SoupFace>& given_;
    const std::function<bool(uint32_t)>& isGlass_;
    const std::set<uint32_t>& boards_;
    double tolerance_, told_;     // the latter: of what runs no farther into others nothing is said
    std::vector<FlatFace> faces_; // surface: the number among those given
    std::vector<uint32_t> body_;  // per flat face
    std::map<uint32_t, SolidRays> solids_;
    std::set<uint32_t> ground_;           // bodies
    std::set<uint32_t> meets_;            // bodies that meet others
    std::optional<SheetRooms> rooms_;     // where solids run through their walls
    std::set<uint32_t> through_, indoor_; // those, and the ones of which what is outside of rooms goes
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
};

} // namespace

std::optional<UnitedSolids> uniteSolids(const std::vector<SoupFace>& faces,
                                        const std::function<bool(uint32_t)>& isGlass, Solids which,
                                        double tolerance, double rounding, const std::set<uint32_t>& boards) {
    if (std::ranges::none_of(faces, [&](const SoupFace& face) { return isGlass(face.material); }))
        return std::nullopt;
    return SolidUniter(faces, isGlass, tolerance, rounding, boards).unite(which);
}

std::vector<std::string> warningsOf(const UnitedSolids& united, Solids which,
                                    const std::function<std::string(uint32_t)>& place) {
    std::vector<std::string> out;
    if (united.solids > 0)
        out.push_back(fmt::format("{} solids that {}run into one another (one with the face at {}) were "
                                  "taken as one: of what lies in others nothing is seen",
                                  united.solids, which == Solids::thatMeet ? "touch or " : "",
                                  place(united.surface)));
    if (united.through > 0)
        out.push_back(fmt::format(
            "{} (the first with the face at {}) {} through walls, floors or ceilings of rooms: cut off there",
            counted(united.through, "solid"), place(united.surfaceThrough),
            united.through == 1 ? "runs" : "run"));
    if (!united.muchOutside.empty())
        out.push_back(fmt::format("a quarter or more of {} (the first with the face at {}) lies outside of "
                                  "the rooms: is it in the wrong place?",
                                  counted(united.muchOutside.size(), "such solid"),
                                  place(united.muchOutside[0])));
    return out;
}

} // namespace heliodon::geometry
