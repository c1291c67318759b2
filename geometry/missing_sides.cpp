#include "geometry/missing_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

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
constexpr double kLeastSteep = 0.1;   // of the area of what has walls
constexpr double kDeepLoggia = 1.5;   // of the lowest room's height
constexpr int kLeastOfWindow = 2;     // of kAzimuths
constexpr double kCourtStep = 0.3;    // of the lowest room's height: where windows on courts are looked for
constexpr int kCourtSteps = 24;
constexpr double kOffVertical = 0.176; // tangent: up and down are four ways, not along a joint

// Metres of a building: neither an attic nor a hall says how high the least room is.
constexpr double kLowRoom = 2, kHighRoom = 3;
constexpr double kFence = 2.05, kFenceOfRoom = 0.95; // the same, and at most that of the lowest room
constexpr double kLowSpace = 1.6, kLowOfRoom = 0.8;  // likewise, on the mean: attics and dormers are lower
constexpr double kNearFloor = 0.1;                   // of the height there: where roofs are about an attic
// The same, without floor or ceiling: balustrades and planters are lower. Somewhere above holes in them.
constexpr std::array kWallsOfLow{1.2, 1.4, 1.6, 1.8, 2.0};
constexpr double kWideYard = 4; // of the lowest room's height: walls so far off are no low room's
constexpr int kMostStorey = 8;  // low spaces one over another that are looked at, each way

class SideFinder {
public:
    SideFinder(const Building& sheets, const std::vector<FlatFace>& ofSheets, const Building& rooms,
               const std::vector<FlatFace>& ofRooms, const std::vector<FlatFace>& solidGround, bool looksIn,
               double worldPerBuilding, double tolerance)
        : sheets_(ofSheets), looksIn_(looksIn), worldPerBuilding_(worldPerBuilding), tolerance_(tolerance) {
        height_ = heightOfLowRoom(rooms, worldPerBuilding);
        fence_ = heightOfFences(height_, worldPerBuilding);
        low_ = std::min(kLowSpace * worldPerBuilding, kLowOfRoom * height_);
        findWholes(sheets, boundsOfFaces(ofRooms).diagonal());
        std::vector<FlatFace> around, windows;
        for (size_t k = 0; k < sheets_.size(); ++k)
            if (!isSmall_[k]) around.push_back(sheets_[k]);
        around.insert(around.end(), ofRooms.begin(), ofRooms.end());
        around.insert(around.end(), solidGround.begin(), solidGround.end());
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
        std::array<double, kSpaces.size()> area{}; // of each
        for (size_t k = 0; k < sheets_.size(); ++k) {
            if (isSmall_[k]) continue;
            for (const ShellTriangle& t : sheets_[k].triangles) {
                if (next++ % step != 0) continue;
                for (const double side : {1.0, -1.0}) {
                    if (side < 0 && looksIn_) continue;
                    const Found found = before(t.middle(), side * sheets_[k].normal, reach_[k]);
                    if (found.space == none) continue;
                    area[found.space] +=
                        0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a)) * static_cast<double>(step);
                    auto& first = out.*kSpaces[found.space];
                    if (!first) first = LackingSide{sheets_[k].surface, found.lacks};
                }
            }
        }
        const double least = kLeastWalls * height_ * height_;
        if (area[low] + area[room] <= least)
            out.low.reset();
        else if (!out.low)
            out.low = out.room;
        for (const Space space : {room, loggia, court})
            if (area[space] <= least) (out.*kSpaces[space]).reset();
        return out;
    }

private:
    enum Space { room, loggia, court, low, none };
    static constexpr std::array kSpaces{&MissingSides::room, &MissingSides::loggia, &MissingSides::court,
                                        &MissingSides::low};
    struct Found {
        Space space = none;
        const char* lacks = "";
    };

    // Per sheet, by what it hangs together with: whether that is small, and how far off what it sees may be
    // its room's: the length of the house, or of that where it has walls. A hall may be longer than the
    // house, but the ground is no floor of a room with the houses across the street for walls.
    void findWholes(const Building& sheets, double house) {
        for (const Whole& whole : wholesOf(sheets, sheets_)) {
            const double length = whole.box.diagonal();
            isSmall_.push_back(length < kLeastWhole * height_);
            reach_.push_back(whole.steep > kLeastSteep * whole.area ? std::max(house, length) : house);
        }
    }

    struct Middle {
        dvec3 p;
        bool isLow = false; // no room unless it has floor and ceiling
    };
    // Half-way between what is above and below, no farther than a room is high: canopies with a border and
    // roofs with a parapet are low. Without a ceiling above fences.
    Middle middleOver(dvec3 p) const {
        const dvec3 up(0, 1, 0);
        const double above = freeTo(p, up), below = freeTo(p, -up), middle = 0.5 * (above - below);
        const bool hasNoCeiling = above == height_ && below < height_;
        return {p + (hasNoCeiling ? std::max(middle, fence_ - below) : middle) * up, above + below < fence_};
    }

    // At most as high as a room is.
    double freeTo(dvec3 p, dvec3 way) const { return std::min(all_->nearest(p, way, height_), height_); }

    // Metres: over the floor about what is half-way up there, as far as something is about it and over it.
    double meanHeight(dvec3 middle, double reach) const {
        const dvec3 up(0, 1, 0);
        const double below = freeTo(middle, -up);
        const dvec3 p = middle - (1 - 2 * kNearFloor) * below * up;
        double sum = 0, area = 0;
        for (int k = 0; k < kAzimuths; ++k) {
            const double off = all_->nearest(p, azimuth(k), reach);
            if (!std::isfinite(off)) continue;
            const dvec3 q = p + 2.0 / 3 * off * azimuth(k); // the middle of the sector
            const double height = freeTo(q, up) + freeTo(q, -up);
            if (height >= fence_) continue; // outside
            sum += off * off * height;
            area += off * off;
        }
        return area > 0 ? sum / area : 0;
    }

    struct Sides {
        double above = 0, below = 0, about = 0; // how much is closed, of 1, 1 and 4
        bool isAllAbout = true;
    };
    Sides sidesAbout(dvec3 p, double reach) const {
        Sides out;
        for (const dvec3 aside : {dvec3(1, 0, 0.3), dvec3(-0.3, 0, 1), dvec3(-1, 0, -0.3), dvec3(0.3, 0, -1)})
            for (const double up : {1.0, -1.0})
                if (all_->anyWithin(p, glm::normalize(dvec3(0, up, 0) + kOffVertical * aside), reach))
                    (up > 0 ? out.above : out.below) += 0.25;
        for (int k = 0; k < kAzimuths; ++k) {
            const bool isClosed = all_->anyWithin(p, azimuth(k), reach);
            out.about += isClosed ? 4.0 / kAzimuths : 0;
            out.isAllAbout = out.isAllAbout && isClosed;
        }
        return out;
    }

    static dvec3 azimuth(double k) {
        const double turn = 2 * std::numbers::pi * (k + 0.37) / kAzimuths;
        return {std::cos(turn), 0, std::sin(turn)};
    }

    int waysToWindows(dvec3 p, double reach, double turned = 0) const { // of kAzimuths
        int met = 0;
        for (int k = 0; k < kAzimuths; ++k) {
            const double off = windows_->nearest(p, azimuth(k + turned), reach);
            met += std::isfinite(off) && !all_->anyWithin(p, azimuth(k + turned), off - tolerance_);
        }
        return met;
    }

    // Open to the sky, before windows of any storey.
    bool isCourt(dvec3 p, double reach) const {
        constexpr double kFar = std::numeric_limits<double>::infinity();
        const dvec3 up(0, 1, 0);
        const double below = all_->nearest(p, -up, kFar);
        if (!std::isfinite(below) || all_->anyWithin(p, up, kFar)) return false;
        const dvec3 floor = p - below * up;
        int met = 0;
        for (int k = 1; k <= kCourtSteps && met < kLeastOfWindow; ++k)
            met += waysToWindows(floor + k * kCourtStep * height_ * up, reach,
                                 static_cast<double>(k) / kCourtSteps);
        return met >= kLeastOfWindow;
    }

    static bool encloses(const Sides& sides) { return sides.above + sides.below + sides.about > kEnclosed; }

    // Metres: of low spaces with floor and ceiling one over another, each without a wall, as what a gallery
    // divides, with the one about `middle`.
    double heightOfStack(dvec3 middle, double reach) const {
        double sum = freeTo(middle, {0, 1, 0}) + freeTo(middle, {0, -1, 0});
        for (const dvec3 way : {dvec3(0, 1, 0), dvec3(0, -1, 0)}) {
            dvec3 p = middle;
            for (int storey = 0; storey < kMostStorey; ++storey) {
                const dvec3 beyond = p + (freeTo(p, way) + 2 * tolerance_) * way;
                const double height = freeTo(beyond, way);
                if (height >= fence_) break;
                p = beyond + 0.5 * height * way;
                const Sides sides = sidesAbout(p, reach);
                if (!encloses(sides) || sides.above + sides.below < 2 || sides.isAllAbout) break;
                sum += height;
            }
        }
        return sum;
    }

    // With walls all about over a floor, or below a ceiling, without the other.
    Found lowBox(dvec3 p, double reach) const {
        const dvec3 up(0, 1, 0);
        const double above = freeTo(p, up), below = freeTo(p, -up);
        const bool hasFloor = below < height_;
        if (hasFloor == (above < height_)) return {};
        for (const double metres : kWallsOfLow) {
            const double walls = metres * worldPerBuilding_;
            if (isAllAbout(p + (hasFloor ? walls - below : above - walls) * up,
                           std::min(reach, kWideYard * height_)))
                return {low, hasFloor ? "ceiling" : "floor"};
        }
        return {};
    }

    bool isAllAbout(dvec3 p, double reach) const {
        for (int k = 0; k < kAzimuths; ++k)
            if (!all_->anyWithin(p, azimuth(k), reach)) return false;
        return true;
    }

    Found before(dvec3 middle, dvec3 way, double reach) const { // the side of a sheet there
        const dvec3 from = middle + 2 * tolerance_ * way;
        const double width = all_->nearest(from, way, 2 * kLeastOfRoom * height_); // wider ones are as good
        if (width < kLeastOfRoom * height_) return {};
        const dvec3 beside = from + std::min(0.5 * width, kLeastOfRoom * height_) * way;
        const auto [p, isLow] = middleOver(beside);
        const Sides sides = sidesAbout(p, reach);
        if (!encloses(sides)) return lowBox(beside, reach);
        const char* lacks = sides.below < 1 ? "floor" : sides.above < 1 ? "ceiling" : "wall";
        const bool lacksWall = sides.above == 1 && sides.below == 1;
        if (isLow && (!lacksWall || sides.isAllAbout ||
                      (meanHeight(p, reach) < low_ && heightOfStack(p, reach) < low_)))
            return {low, lacks};
        if (sides.below == 1 && isCourt(p, reach)) return {court, "ceiling"};
        const bool isLoggia = lacksWall && waysToWindows(p, kDeepLoggia * height_) >= kLeastOfWindow;
        return {isLoggia ? loggia : room, lacks};
    }

    const std::vector<FlatFace>& sheets_;
    std::optional<TriangleRays> all_, windows_; // of what may be walls, of windows of rooms
    bool looksIn_;
    double worldPerBuilding_, tolerance_, height_ = 1e300, fence_ = 0,
                                          low_ = 0; // the first of a low room, of what is none
    std::vector<double> reach_;                     // per sheet, as is
    std::vector<bool> isSmall_;
};

} // namespace

double heightOfLowRoom(const Building& rooms, double worldPerBuilding) {
    std::vector<glm::dvec2> range(rooms.roomCount, {1e300, -1e300}); // of heights
    for (const Face& face : rooms.faces)
        for (const uint32_t v : face.loops[0]) {
            const double y = rooms.vertices[v].y;
            glm::dvec2& its = range[face.room];
            its = {std::min(its.x, y), std::max(its.y, y)};
        }
    double least = 1e300;
    for (const glm::dvec2 its : range) least = std::min(least, its.y - its.x);
    return std::clamp(least, kLowRoom * worldPerBuilding, kHighRoom * worldPerBuilding);
}

double heightOfFences(double lowRoom, double worldPerBuilding) {
    return std::min(kFence * worldPerBuilding, kFenceOfRoom * lowRoom);
}

MissingSides missingSides(const Building& sheets, const std::vector<FlatFace>& ofSheets,
                          const Building& rooms, const std::vector<FlatFace>& ofRooms,
                          const std::vector<FlatFace>& solidGround, bool looksIn, double worldPerBuilding,
                          double tolerance) {
    return SideFinder(sheets, ofSheets, rooms, ofRooms, solidGround, looksIn, worldPerBuilding, tolerance)
        .find();
}

} // namespace heliodon::geometry
