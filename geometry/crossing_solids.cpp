// A face that another body's runs through or ends on is cut along the whole plane of that one, and its parts
// again, until none is; then each part lies within another body, on its surface or beside it.
#include "geometry/crossing_solids.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "geometry/box_tree.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_crossing.h"
#include "geometry/flat_faces.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLeastOfGround = 0.25; // of the model, from above
constexpr size_t kMostSolids = 500;     // leaves in one another take the pieces' import minutes
constexpr uint32_t kNone = UINT32_MAX;  // body of what welding leaves nothing of

// Whether a convex face is on both sides of the other's plane, and the line there runs on the other one or
// its border.
bool isCutBy(const FlatFace& convex, const FlatFace& other, double tolerance) {
    double most = 0, least = 0;
    std::vector<dvec3> ends;
    const std::vector<dvec3>& loop = convex.loops[0];
    for (size_t k = 0; k < loop.size(); ++k) {
        const double a = other.height(loop[k]), b = other.height(loop[(k + 1) % loop.size()]);
        most = std::max(most, a), least = std::min(least, a);
        if ((a >= 0) != (b >= 0))
            ends.push_back(loop[k] + a / (a - b) * (loop[(k + 1) % loop.size()] - loop[k]));
    }
    if (most <= tolerance || least >= -tolerance) return false;
    const dvec3 along = ends[1] - ends[0];
    return std::ranges::any_of(other.triangles, [&](const ShellTriangle& t) {
        const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
        double from = 0, to = 1;
        for (const auto& [p, q] : {std::pair(t.a, t.b), {t.b, t.c}, {t.c, t.a}}) {
            const dvec3 inwards = glm::normalize(glm::cross(normal, q - p));
            const double height = glm::dot(ends[0] - p, inwards) + tolerance, rise = glm::dot(along, inwards);
            if (rise > 0)
                from = std::max(from, -height / rise);
            else if (rise < 0)
                to = std::min(to, -height / rise);
            else if (height < 0)
                return false;
        }
        return (to - from) * glm::length(along) > 4 * tolerance; // more than both edges' margins at a corner
    });
}

// As they are given, each by its place, for welding puts corners of others into edges, which makes needles of
// triangles.
Building unwelded(const std::vector<SoupFace>& faces) {
    Building out;
    for (const SoupFace& given : faces) {
        Face& face = out.faces.emplace_back();
        face.surface = static_cast<uint32_t>(&given - faces.data());
        for (const auto& loop : given.loops) {
            face.loops.emplace_back();
            for (const dvec3 p : loop) {
                face.loops.back().push_back(static_cast<uint32_t>(out.vertices.size()));
                out.vertices.push_back(p);
            }
        }
    }
    return out;
}

std::vector<FlatFace> convexParts(const FlatFace& face) {
    const std::vector<dvec3>& loop = face.loops[0];
    const size_t n = loop.size();
    bool convex = face.loops.size() == 1;
    for (size_t k = 0; k < n; ++k)
        convex = convex && glm::dot(glm::cross(loop[(k + 1) % n] - loop[k], loop[(k + 2) % n] - loop[k]),
                                    face.normal) >= 0;
    if (convex) return {convexFace(loop, face.normal)};
    std::vector<FlatFace> out;
    for (const ShellTriangle& t : face.triangles) out.push_back(convexFace({t.a, t.b, t.c}, face.normal));
    return out;
}

class SolidUniter {
public:
    SolidUniter(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                double tolerance)
        : given_(faces), isGlass_(isGlass), tolerance_(tolerance) {
        faces_ = flatFacesOf(unwelded(faces));
        findBodies(weldedByNumber(faces, tolerance));
        if (solids_.size() < 2) return; // nothing to meet
        for (const FlatFace& face : faces_)
            boxes_.push_back({face.box.low - tolerance, face.box.high + tolerance});
        tree_.emplace(boxes_);
        straighten();
    }

    std::optional<UnitedSolids> unite(Solids which) {
        if (solids_.size() < 2) return std::nullopt;
        UnitedSolids out;
        findMeeting(which, out);
        if (out.solids == 0) return std::nullopt;
        std::vector<bool> isCut(given_.size(), false);
        for (uint32_t k = 0; k < faces_.size(); ++k) {
            if (!meets_.contains(body_[k])) continue;
            const auto pieces = outside(k);
            if (!pieces) continue;
            const SoupFace& face = given_[faces_[k].surface];
            isCut[faces_[k].surface] = true;
            for (const FlatFace& piece : *pieces) {
                out.faces.push_back(face);
                out.faces.back().loops = piece.loops;
            }
        }
        for (size_t k = 0; k < given_.size(); ++k)
            if (!isCut[k]) out.faces.push_back(given_[k]);
        return out;
    }

private:
    struct Body {
        bool isClosed = true, hasGlass = false;
        double volume = 0; // below 0 where the faces look in
        std::vector<ShellTriangle> triangles;

        void add(const ShellTriangle& t) {
            const dvec3 origin = triangles.empty() ? t.a : triangles[0].a;
            volume += glm::dot(t.a - origin, glm::cross(t.b - origin, t.c - origin)) / 6;
            triangles.push_back(t);
        }
    };

    class Solid {
    public:
        Solid(const std::vector<ShellTriangle>& triangles, double tolerance)
            : box_{triangles[0].a, triangles[0].a}, rays_(triangles, tolerance) {
            for (const ShellTriangle& t : triangles)
                for (const dvec3 p : {t.a, t.b, t.c}) box_ = united(box_, {p, p});
        }
        const Bounds& box() const { return box_; }
        bool enclose(dvec3 p) const { return box_.isNear({p, p}, 0) && rays_.enclose(p); }

    private:
        Bounds box_;
        TriangleRays rays_;
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

    // What hangs together by edges: where more than two faces meet in one, each with the next in the file, as
    // bodies are written one after another.
    DisjointSets hangingTogether(const Building& welded) const {
        DisjointSets sets(welded.faces.size());
        const auto place = [&](uint32_t f) { return given_[welded.faces[f].surface].surface; };
        for (auto& [edge, faces] : facesOfEdges(welded)) {
            std::ranges::sort(faces, {}, place);
            for (size_t k = 1; k < faces.size(); k += 2) sets.join(faces[k - 1], faces[k]);
        }
        return sets;
    }

    void findBodies(const Building& welded) {
        DisjointSets sets = hangingTogether(welded);
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
            for (const ShellTriangle& t : face.triangles) bodies[body_.back()].add(t);
        }
        bodies.erase(kNone);
        findSolids(bodies);
    }

    void findSolids(std::map<uint32_t, Body>& bodies) {
        const auto isSolid = [](const Body& body) {
            return body.isClosed && !body.hasGlass && body.volume > 0;
        };
        for (const auto& [root, body] : bodies)
            if (isSolid(body)) solids_.try_emplace(root, body.triangles, tolerance_);
        std::map<uint32_t, uint32_t> cavityOf; // the least that is round it: a house with walls
        for (const auto& [root, body] : bodies) {
            if (!body.isClosed || body.volume >= 0) continue;
            uint32_t around = kNone;
            for (const auto& [number, solid] : solids_)
                if (solid.enclose(body.triangles[0].middle()) &&
                    (around == kNone || bodies[number].volume < bodies[around].volume))
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
        leaveOutGround();
    }

    // The air of rooms is often drawn into it: what is much larger than the largest of all else that hangs
    // together.
    void leaveOutGround() {
        std::map<uint32_t, Bounds> solids;
        for (const auto& [body, solid] : solids_) solids[body] = solid.box();
        const double all = faces_.empty() ? 0 : areaFromAbove(boundsOfFaces(faces_));
        for (const auto& [body, ground] : solids) {
            if (areaFromAbove(ground) < kLeastOfGround * all) continue;
            std::map<uint32_t, Bounds> others = solids;
            others.erase(body);
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
            if (solids.size() > 1 && isMuchLarger(ground, largest)) solids_.erase(body);
        }
    }

    void findMeeting(Solids which, UnitedSolids& out) {
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (solids_.contains(body_[k]) && !meets_.contains(body_[k]))
                anyOfAnother(faces_[k], body_[k], [&](uint32_t i) {
                    if (which == Solids::thatCross && !facesCross(faces_[k], faces_[i], tolerance_))
                        return false;
                    if (meets_.empty()) out.surface = given_[faces_[k].surface].surface;
                    meets_.insert(body_[k]), meets_.insert(body_[i]);
                    return true;
                });
        out.solids = meets_.size() <= kMostSolids ? static_cast<uint32_t>(meets_.size()) : 0;
    }

    // Whether `accepts(i)` says so of any face i of another solid near the piece.
    template<class Accepts>
    bool anyOfAnother(const FlatFace& piece, uint32_t body, const Accepts& accepts) const {
        return tree_->anyHolding(piece.box.high, piece.box.low, [&](uint32_t i) {
            return body_[i] != body && solids_.contains(body_[i]) && accepts(i);
        });
    }

    // Null where there is none.
    const FlatFace* cutting(const FlatFace& piece, uint32_t body) const {
        const FlatFace* found = nullptr;
        anyOfAnother(piece, body, [&](uint32_t i) {
            if (!meets_.contains(body_[i]) || !isCutBy(piece, faces_[i], tolerance_)) return false;
            found = &faces_[i];
            return true;
        });
        return found;
    }

    // Convex pieces of the face that are of the union's surface; none where all of it is.
    std::optional<std::vector<FlatFace>> outside(uint32_t k) const {
        std::vector<FlatFace> kept;
        bool goes = false;
        std::vector<FlatFace> next = convexParts(faces_[k]);
        while (!next.empty()) {
            const FlatFace piece = std::move(next.back());
            next.pop_back();
            if (const FlatFace* other = cutting(piece, body_[k]))
                for (FlatFace& half : halves(piece, *other)) next.push_back(std::move(half));
            else if (isCovered(piece, body_[k]))
                goes = true;
            else
                kept.push_back(piece);
        }
        if (!goes) return std::nullopt;
        return kept;
    }

    // What lies on another surface that looks the same way is the earlier body's.
    bool isCovered(const FlatFace& piece, uint32_t body) const {
        const dvec3 middle = largestTriangle(piece).middle(), off = 2 * tolerance_ * piece.normal;
        return std::ranges::any_of(meets_, [&](uint32_t other) {
            if (other == body) return false;
            const Solid& solid = solids_.at(other);
            return solid.enclose(middle + off) || (other < body && solid.enclose(middle - off));
        });
    }

    const std::vector<SoupFace>& given_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    std::vector<FlatFace> faces_; // surface: the number among those given
    std::vector<uint32_t> body_;  // per flat face
    std::map<uint32_t, Solid> solids_;
    std::set<uint32_t> meets_; // bodies that meet others
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
};

} // namespace

std::optional<UnitedSolids> uniteSolids(const std::vector<SoupFace>& faces,
                                        const std::function<bool(uint32_t)>& isGlass, Solids which,
                                        double tolerance) {
    if (std::ranges::none_of(faces, [&](const SoupFace& face) { return isGlass(face.material); }))
        return std::nullopt;
    return SolidUniter(faces, isGlass, tolerance).unite(which);
}

} // namespace heliodon::geometry
