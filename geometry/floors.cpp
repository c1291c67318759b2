#include "geometry/floors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"

namespace heliodon::geometry {

namespace {

constexpr double kWalkable = 0.98; // of the normal's rise: ramps up to 11 degrees
constexpr double kUpright = 1e-6;  // of the normal's rise
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Metres of the building.
constexpr double kStep = 0.25;
constexpr double kRise = 0.3, kGap = 0.3; // from a tread of a stair to the next one
constexpr double kLastRise = 0.55;        // to what it leads to, where the last tread is not drawn
constexpr double kHeadroom = 2;
constexpr double kThickest = 1; // of a floor, from what one walks on to the ceiling beneath
constexpr double kLeastArea = 1.5, kLeastWidth = 0.6;
constexpr double kCupboard = 0.9; // no single row of cupboards is so wide

// Level patches that hang together by their edges.
struct Level {
    std::vector<size_t> patches;
    double low = kInfinite, high = -kInfinite;
    double area = 0, perimeter = 0;
    Bounds box;
    bool isReached = false; // by stairs or steps

    // Of a rectangle of that area and perimeter.
    double width() const {
        const double half = perimeter / 2;
        return 0.5 * (half - std::sqrt(std::max(0.0, half * half - 4 * area)));
    }
};

class FloorFinder {
public:
    FloorFinder(const PatchMesh& mesh, double scale) : mesh_(mesh), scale_(scale) {}

    Floors find() {
        Shells shells(mesh_);
        std::map<uint32_t, std::vector<size_t>> rooms, furniture; // what stands free in them
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            if (patchNormal(mesh_, i).y > kWalkable)
                (shells.volume(i) > 0 ? rooms : furniture)[mesh_.room[i]].push_back(i);
        for (auto& [room, patches] : rooms) findIn(patches, furniture[room]);
        return std::move(out_);
    }

private:
    double low(size_t patch) const {
        double low = kInfinite;
        for (const uint32_t v : mesh_.patch(patch)) low = std::min(low, mesh_.vertices[v].y);
        return low;
    }

    double high(size_t patch) const {
        double high = -kInfinite;
        for (const uint32_t v : mesh_.patch(patch)) high = std::max(high, mesh_.vertices[v].y);
        return high;
    }

    // Of one room.
    void findIn(std::vector<size_t>& patches, const std::vector<size_t>& furniture) {
        std::ranges::stable_sort(patches, {}, [&](size_t i) { return low(i); });
        double reached = low(patches[0]);
        size_t next = 0;
        for (; next < patches.size() && low(patches[next]) <= reached + kStep * scale_; ++next) {
            reached = std::max(reached, high(patches[next]));
            out_.lowest.push_back(patches[next]);
        }
        if (next == patches.size()) return;
        least_ = low(patches[0]) + kHeadroom * scale_;
        const auto rest = patches.begin() + static_cast<ptrdiff_t>(next);
        std::vector<Level> levels = levelsOf({rest, patches.end()}), treads = levelsOf(furniture),
                           below = levelsOf({patches.begin(), rest});
        for (Level& level : below) level.isReached = true;
        climb(levels, treads, below);
        for (const Level& level : levels) {
            if (level.low > reached + kStep * scale_ && !isStorey(level, reached)) continue;
            reached = std::max(reached, level.high);
            out_.upper.insert(out_.upper.end(), level.patches.begin(), level.patches.end());
        }
    }

    // By stairs, of whatever stands in the room.
    void climb(std::vector<Level>& levels, std::vector<Level>& treads, std::vector<Level>& below) const {
        std::vector<Level*> all, todo;
        for (std::vector<Level>* some : {&levels, &treads, &below})
            for (Level& level : *some) all.push_back(&level);
        std::ranges::sort(all, {}, [](const Level* l) { return l->low; });
        for (Level* level : all)
            if (level->isReached) todo.push_back(level);
        const double rise = kRise * scale_, last = kLastRise * scale_, gap = kGap * scale_,
                     large = kLeastArea * scale_ * scale_;
        while (!todo.empty()) {
            const Level& from = *todo.back();
            todo.pop_back();
            for (auto at = std::ranges::lower_bound(all, from.low, {}, [](const Level* l) { return l->low; });
                 at != all.end() && (*at)->low <= from.high + last; ++at) {
                const Bounds &a = from.box, &b = (*at)->box;
                if ((*at)->isReached || ((*at)->low > from.high + rise && (*at)->area < large) ||
                    a.low.x > b.high.x + gap || b.low.x > a.high.x + gap || a.low.z > b.high.z + gap ||
                    b.low.z > a.high.z + gap)
                    continue;
                (*at)->isReached = true;
                todo.push_back(*at);
            }
        }
    }

    // From the lowest.
    std::vector<Level> levelsOf(const std::vector<size_t>& patches) const {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges; // of one patch only
        DisjointSets joined(patches.size());
        const auto forEdges = [&](size_t k, const auto& what) {
            const auto corner = mesh_.patch(patches[k]);
            for (size_t c = 0; c < corner.size(); ++c)
                what(std::minmax(corner[c], corner[(c + 1) % corner.size()]));
        };
        for (uint32_t k = 0; k < patches.size(); ++k)
            forEdges(k, [&](std::pair<uint32_t, uint32_t> edge) {
                const auto [other, isNew] = edges.insert({edge, k});
                if (isNew) return;
                joined.join(k, other->second);
                edges.erase(other);
            });
        std::map<uint32_t, Level> levels;
        for (uint32_t k = 0; k < patches.size(); ++k) {
            Level& level = levels[joined.root(k)];
            level.patches.push_back(patches[k]);
            const Bounds box = boundsOf(patchCorners(mesh_, patches[k]));
            level.box = level.patches.size() == 1 ? box : united(level.box, box);
            level.low = std::min(level.low, low(patches[k]));
            level.high = std::max(level.high, high(patches[k]));
            level.area += patchArea(mesh_, patches[k]);
        }
        for (const auto& [edge, k] : edges)
            levels[joined.root(k)].perimeter +=
                glm::distance(mesh_.vertices[edge.first], mesh_.vertices[edge.second]);
        std::vector<Level> sorted;
        for (auto& [root, level] : levels) sorted.push_back(std::move(level));
        std::ranges::stable_sort(sorted, {}, &Level::low);
        return sorted;
    }

    // About 200 points or fewer, equally dense.
    std::vector<glm::dvec3> pointsOn(const Level& level) const {
        constexpr double kApart = 0.4; // building metres
        const double each = std::max(std::pow(kApart * scale_, 2), level.area / 200);
        std::vector<glm::dvec3> points;
        double due = 0.5;
        for (const size_t i : level.patches) {
            const std::vector<glm::dvec3> p = patchCorners(mesh_, i);
            for (size_t c = 2; c < p.size(); ++c) { // middles of n x n parts of each triangle
                const glm::dvec3 u = p[c - 1] - p[0], v = p[c] - p[0];
                due += 0.5 * glm::length(glm::cross(u, v)) / each;
                const double n = std::floor(std::sqrt(due));
                due -= n * n;
                for (double a = 0; a < n; ++a)
                    for (double b = 0; a + b < n; ++b) {
                        points.push_back(p[0] + ((a + 1.0 / 3) * u + (b + 1.0 / 3) * v) / n);
                        if (a + b + 1 < n)
                            points.push_back(p[0] + ((a + 2.0 / 3) * u + (b + 2.0 / 3) * v) / n);
                    }
            }
        }
        return points;
    }

    // What is not upright, by where it is seen from above.
    void arrange() {
        if (columns_) return;
        for (size_t i = 0; i < mesh_.patchCount(); ++i) {
            const double rise = patchNormal(mesh_, i).y;
            if (std::abs(rise) < kUpright) continue;
            Bounds box = boundsOf(patchCorners(mesh_, i));
            box.low.y = -kInfinite, box.high.y = kInfinite;
            boxes_.push_back(box);
            sloping_.emplace_back(i, rise > 0);
        }
        columns_.emplace(boxes_);
    }

    // The nearest height at which a ceiling or a floor lies straight above p, or below.
    double nearest(glm::dvec3 p, bool above, bool isFloor) const {
        const double apart = 1e-4 * scale_;
        double best = above ? kInfinite : -kInfinite;
        columns_->anyHolding({p.x, 0, p.z}, {p.x, 0, p.z}, [&](uint32_t k) {
            if (sloping_[k].second != isFloor) return false;
            const double h = heightAt(mesh_, sloping_[k].first, p.x, p.z, 1e-9 * scale_ * scale_);
            if (above && h > p.y + apart) best = std::min(best, h);
            if (!above && h < p.y - apart) best = std::max(best, h);
            return false;
        });
        return best;
    }

    bool isStorey(const Level& level, double reached) {
        const double metre = scale_, square = scale_ * scale_;
        if (level.low < least_ || level.area < kLeastArea * square || level.width() < kLeastWidth * metre)
            return false;
        arrange();
        double points = 0, free = 0, walkedUnder = 0;
        for (const glm::dvec3 p : pointsOn(level)) {
            ++points;
            if (nearest(p, true, false) < p.y + kHeadroom * metre) continue;
            ++free;
            const double ceiling = nearest(p, false, false);
            if (ceiling < p.y - kThickest * metre) continue;
            if (ceiling - nearest({p.x, ceiling, p.z}, false, true) >= kHeadroom * metre) ++walkedUnder;
        }
        const auto isEnough = [&](double some, double least) {
            return some * level.area >= least * square * points;
        };
        if (!isEnough(free, kLeastArea)) return false;
        const bool fits = isEnough(walkedUnder, kLeastArea) ||
                          (level.low >= reached + kHeadroom * metre && level.width() >= kCupboard * metre);
        if (fits && !level.isReached) out_.undecided.push_back(level.patches[0]);
        return fits && level.isReached;
    }

    const PatchMesh& mesh_;
    double scale_;                                 // world metres a metre of building
    double least_ = 0;                             // height of a room's upper floors
    std::vector<std::pair<size_t, bool>> sloping_; // patches, and whether they look up
    std::vector<Bounds> boxes_;                    // of these
    std::optional<BoxTree> columns_;
    Floors out_;
};

} // namespace

Shells::Shells(const PatchMesh& mesh)
    : mesh_(mesh), shells_(mesh.vertices.size()), volume_(mesh.vertices.size(), 0) {
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (const uint32_t v : mesh.patch(i)) shells_.join(v, mesh.patch(i)[0]);
    for (size_t i = 0; i < mesh.patchCount(); ++i) // normals point into the air
        volume_[of(i)] -= glm::dot(patchAreaVector(mesh, i), patchCentroid(mesh, i)) / 6;
}

Floors findFloors(const PatchMesh& mesh, double worldPerBuilding) {
    return FloorFinder(mesh, worldPerBuilding).find();
}

double heightAt(const PatchMesh& mesh, size_t patch, double x, double z, double slack) {
    const auto corners = mesh.patch(patch);
    const glm::dvec3 normal = patchNormal(mesh, patch);
    const double sign = normal.y > 0 ? 1 : -1;
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = mesh.vertices[corners[k]], b = mesh.vertices[corners[(k + 1) % corners.size()]];
        // Seen from above x is right and z down: counter-clockwise about +y.
        const double side = (b.z - a.z) * (x - a.x) - (b.x - a.x) * (z - a.z);
        if (sign * side < -slack) return std::nan("");
    }
    const glm::dvec3 p = mesh.vertices[corners[0]];
    return p.y - (normal.x * (x - p.x) + normal.z * (z - p.z)) / normal.y;
}

} // namespace heliodon::geometry
