// A face that crosses another is cut along its whole plane, and its parts again, until none crosses any.
#include "geometry/ground_in_rooms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <glm/vector_relational.hpp>

#include "geometry/box_tree.h"
#include "geometry/face_crossing.h"
#include "geometry/missing_sides.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kMuchLarger = 3;  // than the rooms, from above
constexpr double kMostSteep = 0.5; // of its area
constexpr double kFiner = 0.1;     // than what sheets outside may touch rooms by: gentle slopes along a floor
constexpr double kLevel = 0.25;    // of a normal: slopes, not partitions that stand on the ground

class GroundCutter {
public:
    GroundCutter(const Building& rooms, double worldPerBuilding, double tolerance)
        : walls_(flatFacesOf(rooms)), box_(boundsOfFaces(walls_)), shells_(trianglesOf(walls_), tolerance),
          storey_(heightOfFences(heightOfLowRoom(rooms, worldPerBuilding), worldPerBuilding)),
          tolerance_(tolerance) {
        boxes_ = boxesOf(walls_, tolerance);
        tree_.emplace(boxes_);
    }

    Bounds box() const { return box_; }

    bool crossesWindow(const FlatFace& face) const {
        return tree_->anyHolding(face.box.high, face.box.low, [&](uint32_t i) {
            return walls_[i].isWindow && facesCross(face, walls_[i], tolerance_);
        });
    }

    // Convex pieces of the face that lie in no room; none where it lies in none at all.
    std::optional<std::vector<FlatFace>> outside(const FlatFace& face) const {
        std::vector<FlatFace> kept;
        bool goes = false;
        for (const ShellTriangle& t : face.triangles) {
            std::vector<FlatFace> next{convexFace({t.a, t.b, t.c}, face.normal)};
            while (!next.empty()) {
                const FlatFace piece = std::move(next.back());
                next.pop_back();
                if (const FlatFace* wall = wallThrough(piece))
                    for (FlatFace& half : halves(piece, *wall)) next.push_back(std::move(half));
                else if (isGroundInRoom(piece))
                    goes = true;
                else
                    kept.push_back(piece);
            }
        }
        if (!goes) return std::nullopt;
        return kept;
    }

private:
    const FlatFace* wallThrough(const FlatFace& piece) const {
        const FlatFace* found = nullptr;
        tree_->anyHolding(piece.box.high, piece.box.low, [&](uint32_t i) {
            if (walls_[i].isGlass || !facesCross(piece, walls_[i], tolerance_)) return false;
            found = &walls_[i];
            return true;
        });
        return found;
    }

    bool isGroundInRoom(const FlatFace& piece) const {
        const ShellTriangle& t = largestTriangle(piece);
        if (!isWithin(shells_, t, tolerance_)) return false;
        const auto isClose = [&](dvec3 way) { return shells_.anyWithin(t.middle(), way, storey_); };
        return isClose({0, 1, 0}) || isClose({0, -1, 0});
    }

    std::vector<FlatFace> walls_;
    Bounds box_;
    TriangleRays shells_;
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
    double storey_, tolerance_;
};

bool isLevel(const Whole& whole) {
    return whole.steep <= kMostSteep * whole.area;
}

// What hangs together and is closed, by Whole::id.
struct Body {
    Whole whole;
    bool isClosed = true, hasGlass = false, hasWalls = false;
    std::vector<ShellTriangle> triangles;
    double volume = 0; // as volumeWithin() has it
};

std::map<uint32_t, Body> bodiesOf(const Building& welded, const std::vector<FlatFace>& flat,
                                  const std::vector<Whole>& wholes,
                                  const std::function<bool(uint32_t)>& isGlass) {
    std::map<uint32_t, Body> bodies;
    std::map<uint32_t, Body*> bodyOf; // by welded face
    for (size_t k = 0; k < flat.size(); ++k) {
        Body& body = bodies.try_emplace(wholes[k].id, Body{.whole = wholes[k]}).first->second;
        body.triangles.insert(body.triangles.end(), flat[k].triangles.begin(), flat[k].triangles.end());
        (isGlass(welded.faces[flat[k].face].material) ? body.hasGlass : body.hasWalls) = true;
        bodyOf[flat[k].face] = &body;
    }
    for (const auto& [edge, around] : facesOfEdges(welded))
        if (const auto body = bodyOf.find(around[0]); around.size() != 2 && body != bodyOf.end())
            body->second->isClosed = false;
    for (auto& [id, body] : bodies) body.volume = volumeWithin(body.triangles);
    return bodies;
}

bool holds(const Bounds& box, const Bounds& inner, double tolerance) {
    return glm::all(glm::lessThanEqual(box.low - tolerance, inner.low)) &&
           glm::all(glm::greaterThanEqual(box.high + tolerance, inner.high));
}

// Of what has walls and glass, or is the smallest about glass that hangs together with no wall, as in reveals
// that are not cut there.
Bounds boxOfHouses(const std::map<uint32_t, Body>& bodies, double tolerance) {
    Bounds out{dvec3(1e300), dvec3(-1e300)};
    const auto add = [&](const Bounds& box) { out = united(out, box); };
    for (const auto& [id, body] : bodies) {
        if (!body.hasGlass) continue;
        if (body.hasWalls) {
            add(body.whole.box);
            continue;
        }
        const Bounds* least = nullptr;
        for (const auto& [other, about] : bodies)
            if (about.hasWalls && holds(about.whole.box, body.whole.box, tolerance) &&
                (!least || areaFromAbove(about.whole.box) < areaFromAbove(*least)))
                least = &about.whole.box;
        if (least) add(*least);
    }
    return out;
}

} // namespace

bool isMuchLarger(const Bounds& ground, const Bounds& rooms) {
    return areaFromAbove(ground) >= kMuchLarger * areaFromAbove(rooms);
}

std::optional<OpenSheets> openGround(const std::vector<SoupFace>& faces,
                                     const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    const Building welded = weldedByNumber(faces, tolerance);
    const std::vector<FlatFace> flat = flatFacesOf(welded);
    const std::vector<Whole> wholes = wholesOf(welded, flat);
    const std::map<uint32_t, Body> bodies = bodiesOf(welded, flat, wholes, isGlass);
    const Bounds house = boxOfHouses(bodies, tolerance);
    if (house.low.x > house.high.x) return std::nullopt;
    const auto isGroundBody = [&](const Body& body) {
        return !body.hasGlass && body.isClosed && isLevel(body.whole) &&
               body.whole.box.low.y < house.low.y - tolerance && isMuchLarger(body.whole.box, house);
    };
    OpenSheets out;
    std::vector<bool> isGround(faces.size(), false);
    for (size_t k = 0; k < flat.size(); ++k) {
        const Body& body = bodies.at(wholes[k].id);
        if (!isGroundBody(body)) continue;
        isGround[flat[k].surface] = true;
        if ((body.volume < 0 ? 1 : -1) * flat[k].normal.y > kLevel)
            out.open.push_back(faces[flat[k].surface]);
    }
    for (size_t k = 0; k < faces.size(); ++k)
        if (!isGround[k]) out.closed.push_back(faces[k]);
    if (out.open.empty() || out.closed.empty()) return std::nullopt;
    return out;
}

GroundOutside groundOutside(const std::vector<SoupFace>& sheets, const Building& rooms,
                            double worldPerBuilding, double tolerance) {
    const GroundCutter cutter(rooms, worldPerBuilding, kFiner * tolerance);
    const Building welded = weldedByNumber(sheets, tolerance);
    const std::vector<FlatFace> faces = flatFacesOf(welded);
    const std::vector<Whole> wholes = wholesOf(welded, faces);
    GroundOutside out;
    std::vector<bool> isCut(sheets.size(), false);
    for (size_t k = 0; k < faces.size(); ++k) {
        if (std::abs(faces[k].normal.y) < kLevel || !isLevel(wholes[k]) ||
            !isMuchLarger(wholes[k].box, cutter.box()))
            continue;
        const auto pieces = cutter.outside(faces[k]);
        if (!pieces) continue;
        const SoupFace& sheet = sheets[faces[k].surface];
        if (cutter.crossesWindow(faces[k])) out.onGlass = sheet.surface;
        isCut[faces[k].surface] = true;
        if (!out.surface) out.surface = sheet.surface;
        for (const FlatFace& piece : *pieces) {
            out.sheets.push_back(sheet);
            out.sheets.back().loops = piece.loops;
        }
    }
    for (size_t k = 0; k < sheets.size(); ++k)
        if (!isCut[k]) out.sheets.push_back(sheets[k]);
    return out;
}

GroundAndOthers groundAmong(const std::vector<SoupFace>& faces, const Building& rooms, double tolerance) {
    const Bounds house = boundsOfFaces(flatFacesOf(rooms));
    const Building welded = weldedByNumber(faces, tolerance);
    Building level = welded;
    std::erase_if(level.faces, [&](const Face& face) {
        const dvec3 area = areaVector(welded.vertices, face.loops[0]);
        return !(std::abs(area.y) >= kLevel * glm::length(area));
    });
    const std::vector<FlatFace> flat = flatFacesOf(level);
    const std::vector<Whole> wholes = wholesOf(level, flat);
    std::vector<bool> isGround(faces.size(), false);
    for (size_t k = 0; k < flat.size(); ++k) isGround[flat[k].surface] = isMuchLarger(wholes[k].box, house);
    GroundAndOthers out;
    for (size_t k = 0; k < faces.size(); ++k) (isGround[k] ? out.ground : out.others).push_back(faces[k]);
    return out;
}

} // namespace heliodon::geometry
