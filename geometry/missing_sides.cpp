#include "geometry/missing_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr size_t kMostSamples = 4000; // triangles of sheets that are looked from, about
constexpr double kEnclosed = 4.5;     // of six sides, the four about counted by their angles
constexpr int kAzimuths = 24;         // ways that are looked along about, and
constexpr double kLeastOfRoom = 0.25; // of the lowest room's height: what is narrower is none
constexpr double kLeastWalls = 0.5;   // of its square: so much of a room's walls
constexpr double kLeastWhole = 0.5;   // of it: smaller ones are no walls
constexpr double kSteep = 0.7;        // of a normal's height: walls are
constexpr double kLeastSteep = 0.1;   // of the area of what has walls
// Metres: of buildings neither an attic nor a hall says how high the least room is; lower are models.
constexpr double kAttic = 1, kLowRoom = 2, kHighRoom = 3;
constexpr double kFence = 2.05, kFenceOfRoom = 0.95; // metres, and at most that of the lowest room
constexpr double kDeepLoggia = 1.5;                  // of the lowest room's height
constexpr int kLeastOfWindow = 2;                    // of kAzimuths
constexpr double kOffVertical = 0.176;               // tangent: up and down are four ways, not along a joint

class SideFinder {
public:
    SideFinder(const Building& sheets, const std::vector<FlatFace>& ofSheets, const Building& rooms,
               const std::vector<FlatFace>& ofRooms, bool looksIn, double tolerance)
        : sheets_(ofSheets), looksIn_(looksIn), tolerance_(tolerance) {
        std::vector<Bounds> boxes(rooms.roomCount, {dvec3(1e300), dvec3(-1e300)});
        Bounds all = boxes[0];
        for (const Face& face : rooms.faces)
            for (const uint32_t v : face.loops[0]) {
                const dvec3 p = rooms.vertices[v];
                for (Bounds* box : {&boxes[face.room], &all})
                    *box = {glm::min(box->low, p), glm::max(box->high, p)};
            }
        for (const Bounds& box : boxes) height_ = std::min(height_, (box.high - box.low).y);
        if (height_ > kAttic) height_ = std::clamp(height_, kLowRoom, kHighRoom);
        fence_ = std::min(kFence, kFenceOfRoom * height_);
        findWholes(sheets, all.diagonal());
        std::vector<FlatFace> around, windows;
        for (size_t k = 0; k < sheets_.size(); ++k)
            if (!isSmall_[k]) around.push_back(sheets_[k]);
        around.insert(around.end(), ofRooms.begin(), ofRooms.end());
        std::ranges::copy_if(ofRooms, std::back_inserter(windows), &FlatFace::isWindow);
        all_.emplace(trianglesOf(around), tolerance);
        windows_.emplace(trianglesOf(windows), tolerance);
    }

    MissingSides find() const {
        size_t count = 0, next = 0;
        for (size_t k = 0; k < sheets_.size(); ++k)
            if (!isSmall_[k]) count += sheets_[k].triangles.size();
        const size_t step = (count + kMostSamples - 1) / kMostSamples;
        MissingSides out;
        double ofRoom = 0, ofLoggia = 0; // area of sides
        for (size_t k = 0; k < sheets_.size(); ++k) {
            if (isSmall_[k]) continue;
            for (const ShellTriangle& t : sheets_[k].triangles) {
                if (next++ % step != 0) continue;
                for (const double side : {1.0, -1.0}) {
                    if (side < 0 && looksIn_) continue;
                    const Space space = before(t.middle(), side * sheets_[k].normal, reach_[k]);
                    if (space == Space::none) continue;
                    (space == Space::room ? ofRoom : ofLoggia) +=
                        0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a)) * static_cast<double>(step);
                    auto& first = space == Space::room ? out.room : out.loggia;
                    if (!first) first = sheets_[k].surface;
                }
            }
        }
        const double least = kLeastWalls * height_ * height_;
        if (ofRoom <= least) out.room.reset();
        if (ofLoggia <= least) out.loggia.reset();
        return out;
    }

private:
    enum class Space { none, room, loggia };

    // Per sheet, by what it hangs together with: whether that is small, and how far off what it sees may be
    // its room's: the length of the house, or of that where it has walls. A hall may be longer than the
    // house, but the ground is no floor of a room with the houses across the street for walls.
    void findWholes(const Building& sheets, double house) {
        struct Whole {
            Bounds box{dvec3(1e300), dvec3(-1e300)};
            double area = 0, steep = 0;
        };
        DisjointSets sets(sheets.faces.size());
        for (const auto& [edge, faces] : facesOfEdges(sheets))
            for (const uint32_t f : faces) sets.join(f, faces[0]);
        std::map<uint32_t, Whole> wholes; // by root
        for (const FlatFace& sheet : sheets_) {
            Whole& whole = wholes[sets.root(sheet.face)];
            whole.box = {glm::min(whole.box.low, sheet.box.low), glm::max(whole.box.high, sheet.box.high)};
            const double area = glm::length(areaVector(sheet.loops[0]));
            whole.area += area;
            if (std::abs(sheet.normal.y) < kSteep) whole.steep += area;
        }
        for (const FlatFace& sheet : sheets_) {
            const Whole& whole = wholes[sets.root(sheet.face)];
            const double length = whole.box.diagonal();
            isSmall_.push_back(length < kLeastWhole * height_);
            reach_.push_back(whole.steep > kLeastSteep * whole.area ? std::max(house, length) : house);
        }
    }

    // Before a sheet, and half-way between what is above and below, no farther than a room is high: canopies
    // with a border and roofs with a parapet are low. Without a ceiling above fences. None in what is lower.
    std::optional<dvec3> middleBefore(dvec3 from, dvec3 way, double width) const {
        const dvec3 p = from + std::min(0.5 * width, kLeastOfRoom * height_) * way, up(0, 1, 0);
        const auto free = [&](dvec3 to) { return std::min(all_->nearest(p, to, height_), height_); };
        const double above = free(up), below = free(-up);
        if (above + below < fence_) return std::nullopt;
        const double middle = 0.5 * (above - below);
        const bool hasNoCeiling = above == height_ && below < height_;
        return p + (hasNoCeiling ? std::max(middle, fence_ - below) : middle) * up;
    }

    struct Sides {
        double above = 0, below = 0, about = 0; // how much is closed, of 1, 1 and 4
    };
    Sides sidesAbout(dvec3 p, double reach) const {
        Sides out;
        for (const dvec3 aside : {dvec3(1, 0, 0.3), dvec3(-0.3, 0, 1), dvec3(-1, 0, -0.3), dvec3(0.3, 0, -1)})
            for (const double up : {1.0, -1.0})
                if (all_->anyWithin(p, glm::normalize(dvec3(0, up, 0) + kOffVertical * aside), reach))
                    (up > 0 ? out.above : out.below) += 0.25;
        for (int k = 0; k < kAzimuths; ++k)
            if (all_->anyWithin(p, azimuth(k), reach)) out.about += 4.0 / kAzimuths;
        return out;
    }

    static dvec3 azimuth(int k) {
        const double turn = 2 * std::numbers::pi * (k + 0.37) / kAzimuths;
        return {std::cos(turn), 0, std::sin(turn)};
    }

    bool seesWindow(dvec3 p) const {
        int met = 0;
        for (int k = 0; k < kAzimuths; ++k) {
            const double off = windows_->nearest(p, azimuth(k), kDeepLoggia * height_);
            met += std::isfinite(off) && !all_->anyWithin(p, azimuth(k), off - tolerance_);
        }
        return met >= kLeastOfWindow;
    }

    Space before(dvec3 middle, dvec3 way, double reach) const { // the side of a sheet there
        const dvec3 from = middle + 2 * tolerance_ * way;
        const double width = all_->nearest(from, way, 2 * kLeastOfRoom * height_); // wider ones are as good
        if (width < kLeastOfRoom * height_) return Space::none;
        const auto p = middleBefore(from, way, width);
        if (!p) return Space::none;
        const Sides sides = sidesAbout(*p, reach);
        if (sides.above + sides.below + sides.about <= kEnclosed) return Space::none;
        const bool lacksWall = sides.above == 1 && sides.below == 1;
        return lacksWall && seesWindow(*p) ? Space::loggia : Space::room;
    }

    const std::vector<FlatFace>& sheets_;
    std::optional<TriangleRays> all_, windows_; // of what may be walls, of windows of rooms
    bool looksIn_;
    double tolerance_, height_ = 1e300, fence_ = 0; // the latter of a low room, of what is none
    std::vector<double> reach_;                     // per sheet, as is
    std::vector<bool> isSmall_;
};

} // namespace

MissingSides missingSides(const Building& sheets, const std::vector<FlatFace>& ofSheets,
                          const Building& rooms, const std::vector<FlatFace>& ofRooms, bool looksIn,
                          double tolerance) {
    return SideFinder(sheets, ofSheets, rooms, ofRooms, looksIn, tolerance).find();
}

} // namespace heliodon::geometry
