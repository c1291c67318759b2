#include "geometry/mesh_domains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include <glm/geometric.hpp>

#include "geometry/constrained_delaunay.h"
#include "geometry/facet_merging.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/touching_outline.h"

namespace heliodon::geometry {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;
using Frame = MeshDomain::Frame;
constexpr double kStraightSine = 1e-7;
// Of the domain's extent: how far corners of merged faces lie off their plane, as the corners of one face of
// a model may (model_faces.h).
constexpr double kFlat = 1e-5;
// The same over the plane of one face: no rounding to speak of, and more than rounding.
constexpr double kExact = 1e-9, kCurved = 1e-3;
constexpr double kUprightSine = 1e-5; // scenes in single precision, turned by their nodes
constexpr double kSamePlace = 1e-6;   // of a wall's length

// Axes in a plane: v up along the wall, or any axis of a level one.
Frame frameIn(glm::dvec3 origin, glm::dvec3 n) {
    Frame frame;
    frame.origin = origin;
    const glm::dvec3 helper = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    frame.u = glm::normalize(glm::cross(helper, n));
    frame.v = glm::cross(n, frame.u);
    return frame;
}

Frame frameOfFace(const Building& building, const Face& face) {
    return frameIn(building.vertices[face.loops[0][0]], faceNormal(building, face));
}

// The boundary of several faces together: their edges without the seams, as loops.
class BoundaryTracer {
public:
    BoundaryTracer(const Building& building, MeshDomain& domain) : domain_(domain) {
        for (uint32_t i = 0; i < domain.faces.size(); ++i)
            for (const auto& loop : building.faces[domain.faces[i]].loops)
                for (size_t k = 0; k < loop.size(); ++k)
                    after_[{loop[k], loop[(k + 1) % loop.size()]}] = {loop[(k + 2) % loop.size()], i};
    }

    void trace(const std::set<Edge>& seams) {
        std::set<Edge> seen;
        for (const auto& [start, next] : after_) {
            if (seams.contains(start) || seen.contains(start)) continue;
            std::vector<uint32_t> loop, frames;
            Edge at = start;
            do {
                seen.insert(at);
                loop.push_back(at.first);
                frames.push_back(domain_.frames.size() > 1 ? after_.at(at).second : 0);
                at = {at.second, after_.at(at).first};
                while (seams.contains(at)) at = {at.first, after_.at({at.second, at.first}).first};
            } while (at != start);
            domain_.loops.push_back(std::move(loop));
            domain_.frameOf.push_back(std::move(frames));
        }
    }

private:
    MeshDomain& domain_;
    std::map<Edge, std::pair<uint32_t, uint32_t>> after_; // edge -> corner that follows, facet
};

bool repeatsCorner(const MeshDomain& domain) {
    std::set<uint32_t> seen;
    for (const auto& loop : domain.loops)
        for (const uint32_t v : loop)
            if (!seen.insert(v).second) return true;
    return false;
}

class DomainFinder {
public:
    DomainFinder(const Building& building, double edge, bool merging, bool careful)
        : building_(building), edge_(edge), merging_(merging), careful_(careful) {
        for (const Face& face : building.faces) normals_.push_back(faceNormal(building, face));
    }

    std::vector<MeshDomain> find() {
        std::map<std::tuple<uint32_t, uint32_t, Role, uint32_t>, std::vector<uint32_t>> groups;
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            const Face& face = building_.faces[f];
            if (face.twin >= 0)
                addSingle(f);
            else
                groups[{face.surface, face.material, face.role, face.room}].push_back(f);
        }
        for (const auto& [key, faces] : groups)
            if (faces.size() == 1)
                addSingle(faces[0]);
            else
                addConnected(faces);
        dropStraightCorners();
        if (merging_) mergeFacets(building_, domains_, edge_);
        for (MeshDomain& domain : domains_) {
            findFolds(domain);
            domain.planar = planarLoops(domain);
        }
        return std::move(domains_);
    }

private:
    MeshDomain domainOf(uint32_t f, FaceLoops loops) const {
        MeshDomain domain;
        domain.faces = {f};
        domain.frames = {frameOfFace(building_, building_.faces[f])};
        domain.loops = std::move(loops);
        for (const auto& loop : domain.loops) domain.frameOf.emplace_back(loop.size(), 0u);
        return domain;
    }

    void addSingle(uint32_t f) {
        const Face& face = building_.faces[f];
        const auto isWhole = [&](const FaceLoops& loops) { return keepsApart(domainOf(f, loops)); };
        std::vector<FaceLoops> parts;
        if (careful_ && face.twin < 0 && !isTriangle(face) && !isWhole(face.loops))
            parts = partsOfTouching(building_, face, isWhole);
        if (parts.empty()) parts = {face.loops};
        for (FaceLoops& loops : parts) domains_.push_back(domainOf(f, std::move(loops)));
    }

    static bool isTriangle(const Face& face) { return face.loops.size() == 1 && face.loops[0].size() == 3; }

    void addConnected(const std::vector<uint32_t>& faces) {
        std::map<Edge, uint32_t> faceOf;
        for (const uint32_t f : faces)
            for (const auto& loop : building_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) faceOf[{loop[i], loop[(i + 1) % loop.size()]}] = f;
        for (const auto& whole : connected(faces, faceOf, [](uint32_t, uint32_t) { return true; })) {
            if (whole.size() > 1 && merge(whole)) continue;
            // A wall that runs on into a vault is unrolled up to there.
            const auto sameWay = [&](uint32_t f, uint32_t g) { return isUpright(f) == isUpright(g); };
            for (const auto& part : connected(whole, faceOf, sameWay))
                if (part.size() == 1 || !isUpright(part[0]) || commonPlane(part))
                    addFlatParts(part, faceOf);
                else
                    unroll(part, faceOf);
        }
    }

    // Neighbours in one plane together.
    void addFlatParts(const std::vector<uint32_t>& members, const std::map<Edge, uint32_t>& faceOf) {
        const auto level = [&](uint32_t f, uint32_t g) { return inOnePlane(f, g); };
        for (const auto& part : connected(members, faceOf, level))
            if (part.size() == 1 || !merge(part))
                for (const uint32_t f : part) addSingle(f);
    }

    // Parts of `members` that hang together by edges across which `joins` holds of both faces.
    template<class Joins>
    std::vector<std::vector<uint32_t>> connected(const std::vector<uint32_t>& members,
                                                 const std::map<Edge, uint32_t>& faceOf,
                                                 const Joins& joins) const {
        std::vector<std::vector<uint32_t>> parts;
        std::set<uint32_t> rest(members.begin(), members.end());
        for (const uint32_t start : members) {
            if (rest.erase(start) == 0) continue;
            std::vector<uint32_t>& part = parts.emplace_back(1, start);
            for (size_t i = 0; i < part.size(); ++i)
                for (const auto& loop : building_.faces[part[i]].loops)
                    for (size_t k = 0; k < loop.size(); ++k)
                        if (const auto other = faceOf.find({loop[(k + 1) % loop.size()], loop[k]});
                            other != faceOf.end() && rest.contains(other->second) &&
                            joins(part[i], other->second)) {
                            part.push_back(other->second);
                            rest.erase(other->second);
                        }
        }
        return parts;
    }

    bool isUpright(uint32_t f) const { return std::abs(normals_[f].y) <= kUprightSine; }

    bool inOnePlane(uint32_t f, uint32_t g) const { return geometry::inOnePlane(normals_[f], normals_[g]); }

    // How far corners lie off the plane, as a share of their distance from its origin.
    double unevenness(const std::vector<uint32_t>& members, const Frame& frame) const {
        const glm::dvec3 n = glm::cross(frame.u, frame.v);
        double extent = 0, off = 0;
        for (const uint32_t f : members)
            for (const auto& loop : building_.faces[f].loops)
                for (const uint32_t v : loop) {
                    const glm::dvec3 d = building_.vertices[v] - frame.origin;
                    extent = std::max(extent, glm::length(d));
                    off = std::max(off, std::abs(glm::dot(d, n)));
                }
        return extent > 0 ? off / extent : 0;
    }

    // The plane of all: that of one face, or, where files have rounded its corners and it leads away from the
    // others, the one that fits them. None where they lie in no plane.
    std::optional<Frame> commonPlane(const std::vector<uint32_t>& members) const {
        Frame frame = frameOfFace(building_, building_.faces[members[0]]);
        double off = unevenness(members, frame);
        if (off > kExact && off <= kCurved) {
            frame = fittingFrame(members);
            off = unevenness(members, frame);
        }
        if (off > kFlat) return std::nullopt;
        return frame;
    }

    Frame fittingFrame(const std::vector<uint32_t>& members) const {
        glm::dvec3 area{0}, middle{0};
        double corners = 0;
        for (const uint32_t f : members)
            for (const auto& loop : building_.faces[f].loops) {
                area += areaVector(building_.vertices, loop);
                for (const uint32_t v : loop) middle += building_.vertices[v];
                corners += static_cast<double>(loop.size());
            }
        return frameIn(middle / corners, glm::normalize(area));
    }

    // False where they lie in no plane, or the whole would touch itself.
    bool merge(const std::vector<uint32_t>& members) {
        const std::optional<Frame> plane = commonPlane(members);
        if (!plane) return false;
        MeshDomain domain;
        domain.faces = members;
        domain.frames = {*plane};
        std::set<Edge> edges, seams;
        for (const uint32_t f : members)
            for (const auto& loop : building_.faces[f].loops)
                for (size_t k = 0; k < loop.size(); ++k) edges.insert({loop[k], loop[(k + 1) % loop.size()]});
        for (const Edge& edge : edges)
            if (edges.contains({edge.second, edge.first})) seams.insert(edge);
        BoundaryTracer(building_, domain).trace(seams);
        if (repeatsCorner(domain) || (careful_ && !keepsApart(domain))) return false;
        domains_.push_back(std::move(domain));
        return true;
    }

    // Upright facets that hang together along upright edges, or are parts of one, laid out side by side.
    void unroll(const std::vector<uint32_t>& members, const std::map<Edge, uint32_t>& faceOf) {
        std::set<uint32_t> rest(members.begin(), members.end());
        while (!rest.empty()) {
            MeshDomain domain;
            std::set<Edge> seams;
            layOut(*rest.begin(), faceOf, rest, domain, seams);
            BoundaryTracer(building_, domain).trace(seams);
            if (isSimple(domain))
                domains_.push_back(std::move(domain));
            else
                addFlatParts(domain.faces, faceOf);
        }
    }

    // Whether the outlines, laid out, neither touch nor cross: round a hole whose rim leans across folds,
    // facets come back to a corner of their own, or past it.
    bool isSimple(const MeshDomain& domain) const {
        std::vector<glm::dvec2> points;
        std::vector<uint32_t> vertices;
        std::vector<Edge> edges;
        for (size_t l = 0; const auto& loop : planarLoops(domain)) {
            const auto start = static_cast<uint32_t>(points.size()), n = static_cast<uint32_t>(loop.size());
            for (uint32_t k = 0; k < n; ++k) edges.emplace_back(start + k, start + (k + 1) % n);
            points.insert(points.end(), loop.begin(), loop.end());
            vertices.insert(vertices.end(), domain.loops[l].begin(), domain.loops[l].end());
            ++l;
        }
        double length = 0;
        for (const glm::dvec2 p : points) length = std::max(length, std::abs(p.x - points[0].x));
        std::multimap<uint32_t, glm::dvec2> places;
        for (size_t k = 0; k < points.size(); ++k) {
            const auto [first, last] = places.equal_range(vertices[k]);
            for (auto other = first; other != last; ++other)
                if (glm::length(other->second - points[k]) <= kSamePlace * length) return false;
            places.emplace(vertices[k], points[k]);
        }
        return constrainedDelaunay(points, edges).has_value();
    }

    // Simple, and none of its outlines turns back on itself in a slit that rounding may close once it is
    // sampled.
    bool keepsApart(const MeshDomain& domain) const {
        for (const auto& loop : planarLoops(domain))
            for (size_t k = 0, n = loop.size(); k < n; ++k) {
                const glm::dvec2 in = loop[(k + 1) % n] - loop[k],
                                 out = loop[(k + 2) % n] - loop[(k + 1) % n];
                if (glm::dot(in, out) < 0 &&
                    std::abs(cross(in, out)) < kStraightSine * glm::length(in) * glm::length(out))
                    return false;
            }
        return isSimple(domain);
    }

    void layOut(uint32_t start, const std::map<Edge, uint32_t>& faceOf, std::set<uint32_t>& rest,
                MeshDomain& domain, std::set<Edge>& seams) const {
        domain.faces = {start};
        domain.frames = {frameOfFace(building_, building_.faces[start])};
        rest.erase(start);
        for (size_t i = 0; i < domain.faces.size(); ++i)
            for (const auto& loop : building_.faces[domain.faces[i]].loops)
                for (size_t k = 0; k < loop.size(); ++k) {
                    const Edge edge{loop[k], loop[(k + 1) % loop.size()]};
                    const auto other = faceOf.find({edge.second, edge.first});
                    if (other == faceOf.end() || !rest.contains(other->second)) continue;
                    if (!upright(edge) && !inOnePlane(domain.faces[i], other->second)) continue;
                    Frame frame = frameOfFace(building_, building_.faces[other->second]);
                    const glm::dvec3 p = building_.vertices[edge.first];
                    frame.offset = domain.frames[i].coordinates(p).x;
                    frame.origin = {p.x, domain.frames[i].origin.y, p.z};
                    domain.faces.push_back(other->second);
                    domain.frames.push_back(frame);
                    rest.erase(other->second);
                }
        findSeams(domain, seams);
        for (size_t i = 0; i < domain.faces.size(); ++i)
            measure(domain.frames[i], building_.faces[domain.faces[i]]);
    }

    // Edges that lie in one place as seen from both of their facets: all but those where a ring was cut open.
    void findSeams(const MeshDomain& domain, std::set<Edge>& seams) const {
        std::map<Edge, size_t> facetOf;
        for (size_t i = 0; i < domain.faces.size(); ++i)
            for (const auto& loop : building_.faces[domain.faces[i]].loops)
                for (size_t k = 0; k < loop.size(); ++k) facetOf[{loop[k], loop[(k + 1) % loop.size()]}] = i;
        for (const auto& [edge, facet] : facetOf) {
            const auto other = facetOf.find({edge.second, edge.first});
            if (other == facetOf.end()) continue;
            const glm::dvec3 a = building_.vertices[edge.first], b = building_.vertices[edge.second];
            const glm::dvec2 own = domain.frames[facet].coordinates(0.5 * (a + b)),
                             its = domain.frames[other->second].coordinates(0.5 * (a + b));
            if (glm::length(own - its) < 10 * kUprightSine * glm::length(b - a) + 1e-12) seams.insert(edge);
        }
    }

    void measure(Frame& frame, const Face& face) const {
        frame.low = 1e300;
        frame.high = -1e300;
        for (const uint32_t v : face.loops[0]) {
            const double x = frame.coordinates(building_.vertices[v]).x;
            frame.low = std::min(frame.low, x);
            frame.high = std::max(frame.high, x);
        }
    }

    bool upright(Edge edge) const {
        const glm::dvec3 d = building_.vertices[edge.second] - building_.vertices[edge.first];
        return std::hypot(d.x, d.z) < kUprightSine * glm::length(d) + 1e-12;
    }

    bool straight(uint32_t before, uint32_t at, uint32_t after) const {
        const glm::dvec3 in = building_.vertices[at] - building_.vertices[before],
                         out = building_.vertices[after] - building_.vertices[at];
        return glm::dot(in, out) > 0 &&
               glm::length(glm::cross(in, out)) < kStraightSine * glm::length(in) * glm::length(out);
    }

    void dropStraightCorners() {
        std::vector<bool> needed(building_.vertices.size());
        for (const MeshDomain& domain : domains_)
            for (const auto& loop : domain.loops)
                for (size_t k = 0, n = loop.size(); k < n; ++k)
                    if (building_.faces[domain.faces[0]].twin >= 0 || n <= 3 ||
                        !straight(loop[(k + n - 1) % n], loop[k], loop[(k + 1) % n]))
                        needed[loop[k]] = true;
        // A slit, where a body touches a wall in an edge, is straight but for less than is seen.
        for (const MeshDomain& domain : domains_)
            for (const auto& loop : domain.loops)
                if (std::ranges::count_if(loop, [&](uint32_t v) { return bool{needed[v]}; }) < 3)
                    for (const uint32_t v : loop) needed[v] = true;
        for (MeshDomain& domain : domains_) domain.keepCorners(needed);
    }

    void findFolds(MeshDomain& domain) const {
        std::vector<const Frame*> frames;
        for (const Frame& frame : domain.frames) frames.push_back(&frame);
        std::ranges::sort(frames, {}, &Frame::low);
        const double same = kSamePlace * (frames.back()->high - frames.front()->low);
        for (size_t k = 1; k < frames.size(); ++k) {
            const Frame &before = *frames[k - 1], &after = *frames[k];
            if (after.low > before.low + same && !geometry::inOnePlane(before.u, after.u))
                domain.folds.push_back(
                    {after.low, std::atan2(glm::dot(after.v, glm::cross(before.u, after.u)),
                                           glm::dot(before.u, after.u))});
        }
    }

    std::vector<std::vector<glm::dvec2>> planarLoops(const MeshDomain& domain) const {
        std::vector<std::vector<glm::dvec2>> planar(domain.loops.size());
        for (size_t l = 0; l < domain.loops.size(); ++l)
            for (size_t k = 0; k < domain.loops[l].size(); ++k)
                planar[l].push_back(
                    domain.frames[domain.frameOf[l][k]].coordinates(building_.vertices[domain.loops[l][k]]));
        return planar;
    }

    const Building& building_;
    double edge_;
    bool merging_, careful_;
    std::vector<glm::dvec3> normals_; // per face
    std::vector<MeshDomain> domains_;
};

} // namespace

glm::dvec2 MeshDomain::Frame::coordinates(glm::dvec3 p) const {
    return {offset + glm::dot(p - origin, u), glm::dot(p - origin, v)};
}

void MeshDomain::keepCorners(const std::vector<bool>& kept) {
    for (size_t l = 0; l < loops.size(); ++l) {
        std::vector<uint32_t> corners, facets;
        for (size_t k = 0; k < loops[l].size(); ++k)
            if (kept[loops[l][k]]) {
                corners.push_back(loops[l][k]);
                facets.push_back(frameOf[l][k]);
            }
        loops[l] = std::move(corners);
        frameOf[l] = std::move(facets);
    }
}

glm::dvec3 MeshDomain::inSpace(glm::dvec2 p) const {
    const auto beyond = [&](const Frame& frame) {
        return std::max({0.0, frame.low - p.x, p.x - frame.high});
    };
    const Frame& frame = frames.size() == 1 ? frames[0] : *std::ranges::min_element(frames, {}, beyond);
    return frame.origin + (p.x - frame.offset) * frame.u + p.y * frame.v;
}

glm::dvec3 faceNormal(const Building& building, const Face& face) {
    glm::dvec3 sum{0};
    const glm::dvec3 origin = building.vertices[face.loops[0][0]];
    for (const auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i)
            sum += glm::cross(building.vertices[loop[i]] - origin,
                              building.vertices[loop[(i + 1) % loop.size()]] - origin);
    return glm::normalize(sum);
}

double domainArea(const MeshDomain& domain) {
    double twice = 0;
    for (const auto& loop : domain.planar)
        for (size_t k = 0; k < loop.size(); ++k) twice += cross(loop[k], loop[(k + 1) % loop.size()]);
    return std::abs(twice) / 2;
}

glm::dvec2 mainDirection(const MeshDomain& domain) {
    glm::dvec2 best{1, 0};
    double longest = 0;
    for (size_t l = 0; l < domain.loops.size(); ++l) {
        const std::vector<glm::dvec2>& loop = domain.planar[l];
        glm::dvec2 run{0};
        for (size_t k = 0, n = loop.size(); k < 2 * n; ++k) {
            const glm::dvec2 d = loop[(k + 1) % n] - loop[k % n];
            const bool onward =
                glm::dot(run, d) > 0 && std::abs(cross(run, d)) < 1e-6 * glm::length(run) * glm::length(d);
            run = onward && k < n + n / 2 ? run + d : d;
            if (glm::length(run) > longest * (1 + 1e-9)) {
                longest = glm::length(run);
                best = run / longest;
            }
        }
    }
    return best;
}

std::vector<MeshDomain> findMeshDomains(const Building& building, double edge, bool merging, bool careful) {
    return DomainFinder(building, edge, merging, careful).find();
}

std::pair<double, double> extentOf(const MeshDomain& domain) {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    for (const MeshDomain::Frame& frame : domain.frames) {
        low = std::min(low, frame.low);
        high = std::max(high, frame.high);
    }
    return {low, high};
}

} // namespace heliodon::geometry
