// A face that crosses another is cut along its whole plane, and its parts again, until none crosses any.
#include "geometry/ground_in_rooms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/box_tree.h"
#include "geometry/clip_polygon.h"
#include "geometry/face_crossing.h"
#include "geometry/missing_sides.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kMuchLarger = 3;  // than the rooms, from above
constexpr double kMostSteep = 0.5; // of its area
constexpr double kLevel = 0.25;    // of a normal: slopes, not partitions that stand on the ground

double areaFromAbove(const Bounds& box) {
    const dvec3 size = box.high - box.low;
    return size.x * size.z;
}

FlatFace flatFaceOf(const std::vector<dvec3>& corners, dvec3 normal) { // convex
    FlatFace out{.origin = corners[0], .normal = normal, .loops = {corners}, .box = boundsOf(corners)};
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        out.triangles.push_back({corners[0], corners[k], corners[k + 1]});
    return out;
}

class GroundCutter {
public:
    GroundCutter(const Building& rooms, double tolerance)
        : walls_(flatFacesOf(rooms)), shells_(trianglesOf(walls_), tolerance),
          storey_(heightOfFences(heightOfLowRoom(rooms))), tolerance_(tolerance) {
        for (const FlatFace& wall : walls_)
            boxes_.push_back({wall.box.low - tolerance, wall.box.high + tolerance});
        tree_.emplace(boxes_);
    }

    double roomsFromAbove() const { return areaFromAbove(boundsOfFaces(walls_)); }

    // Convex pieces of the face that lie in no room; none where it lies in none at all.
    std::optional<std::vector<FlatFace>> outside(const FlatFace& face) const {
        std::vector<FlatFace> kept;
        bool goes = false;
        for (const ShellTriangle& t : face.triangles) {
            std::vector<FlatFace> next{flatFaceOf({t.a, t.b, t.c}, face.normal)};
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

    static std::vector<FlatFace> halves(const FlatFace& piece, const FlatFace& wall) {
        std::vector<FlatFace> out;
        std::vector<dvec3> part;
        for (const double side : {1.0, -1.0}) {
            clip<dvec3>(
                piece.loops[0], [&](dvec3 p) { return side * wall.height(p); }, part);
            if (!part.empty()) out.push_back(flatFaceOf(part, piece.normal));
        }
        return out;
    }

    bool isGroundInRoom(const FlatFace& piece) const {
        const ShellTriangle& t = *std::ranges::max_element(piece.triangles, {}, [](const ShellTriangle& one) {
            return glm::length(glm::cross(one.b - one.a, one.c - one.a));
        });
        if (!isWithin(shells_, t, tolerance_)) return false;
        const auto isClose = [&](dvec3 way) { return shells_.anyWithin(t.middle(), way, storey_); };
        return isClose({0, 1, 0}) || isClose({0, -1, 0});
    }

    std::vector<FlatFace> walls_;
    TriangleRays shells_;
    std::vector<Bounds> boxes_;
    std::optional<BoxTree> tree_;
    double storey_, tolerance_;
};

} // namespace

GroundOutside groundOutside(const std::vector<SoupFace>& sheets, const Building& rooms, double tolerance) {
    const GroundCutter cutter(rooms, tolerance);
    std::vector<SoupFace> numbered = sheets;
    for (uint32_t k = 0; k < numbered.size(); ++k) numbered[k].surface = k;
    const Building welded = weldFaces(numbered, 1, tolerance, true);
    const std::vector<FlatFace> faces = flatFacesOf(welded);
    const std::vector<Whole> wholes = wholesOf(welded, faces);
    GroundOutside out;
    std::vector<bool> isCut(sheets.size(), false);
    for (size_t k = 0; k < faces.size(); ++k) {
        if (std::abs(faces[k].normal.y) < kLevel || wholes[k].steep > kMostSteep * wholes[k].area ||
            areaFromAbove(wholes[k].box) < kMuchLarger * cutter.roomsFromAbove())
            continue;
        const auto pieces = cutter.outside(faces[k]);
        if (!pieces) continue;
        const SoupFace& sheet = sheets[faces[k].surface];
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

} // namespace heliodon::geometry
