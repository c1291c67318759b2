// Space is divided into an octree of cells; those that no face meets are air. A cell that faces meet is
// divided further only where they leave a way through: where what of them lies in and around it is not one
// piece that can be drawn together to a point (its Euler number, by the nerve of its simplices, is 1), or
// ends in the air; and only where such cells hang together from one large space to another. So cells as small
// as a crack lie along cracks alone. What was parted from the outside by larger cells and no longer is by
// smaller ones leaks between these.
#include "geometry/air_leak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <unordered_map>
#include <utility>

#include "geometry/bounds.h"
#include "geometry/disjoint_sets.h"
#include "geometry/key_hash.h"
#include "geometry/open_sheets.h"
#include "geometry/segment_distance.h"
#include "geometry/shell_faces.h"
#include "geometry/space_parts.h"
#include "geometry/space_sheets.h"
#include "geometry/triangle_box.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kAround = 1.25; // of the model's longest side: the cube that is divided
constexpr int kFirst = 5;        // at this level the outside is one
constexpr int kBase = 6;         // up to this level all cells that faces meet are divided
constexpr int kLast = 17;        // level of the smallest
constexpr size_t kMostCells = 300000, kMostTests = 20000000;
constexpr size_t kPiece = 100, kPieces = 8; // cells, and how many such at once
constexpr size_t kMany = 250;               // triangles of a cell: smaller ones tell with less work
constexpr double kLarge = 0.05;    // of the largest space: smaller ones are parts of ways between these
constexpr double kParallel = 1e-6; // of planes, squared sine
constexpr uint32_t kNone = ~0u;

// First, and how many, those of what is closed, looking out of it; then what is open.
std::pair<std::vector<SoupFace>, size_t> boundaries(const std::vector<SoupFace>& faces, double tolerance) {
    const auto none = [](uint32_t) { return false; };
    const auto open = openSheets(faces, none, tolerance);
    const auto space = partsOfSpace(open ? open->closed : faces, none, tolerance);
    if (!space) return {faces, 0};
    std::vector<SoupFace> out;
    for (uint32_t f = 0; f < space->welded.faces.size(); ++f) {
        const bool before = space->parts.at(space->partAt(f, 0)).volume > 0,
                   behind = space->parts.at(space->partAt(f, 1)).volume > 0;
        if (before && behind) continue;
        out.emplace_back().loops = space->sheetOf(f).loops;
        if (before) turnOver(out.back());
    }
    const size_t count = out.size();
    if (open) out.insert(out.end(), open->open.begin(), open->open.end());
    return {std::move(out), count};
}

struct Cell {
    int level = 0;
    std::array<int64_t, 3> at{}; // in cells of its level
    bool isMet = false, isDivided = false;
    std::vector<uint32_t> near; // triangles in it or in its neighbours, until it is known to be of no account
};

class LeakFinder {
public:
    LeakFinder(const std::vector<SoupFace>& all, double tolerance) : tolerance_(tolerance) {
        const auto [faces, solids] = boundaries(all, tolerance);
        const std::vector<Sheet> sheets = cutIntoSheets(faces, tolerance);
        const Building welded = weldSheets(sheets, tolerance);
        vertices_ = welded.vertices;
        std::map<Edge, uint32_t> known;
        for (const Face& face : welded.faces) {
            const auto& drawn = sheets[face.surface].drawn;
            const auto isSolid = [&, n = solids](const std::vector<uint32_t>& of) {
                return std::ranges::any_of(of, [&](uint32_t k) { return k < n; });
            };
            for (const auto& t : triangulateFace(welded, face)) {
                Triangle& triangle = triangles_.emplace_back(Triangle{t, {}, {}});
                for (size_t k = 0; k < 3; ++k) {
                    const Edge edge = std::minmax(t[k], t[(k + 1) % 3]);
                    const auto found = known.try_emplace(edge, static_cast<uint32_t>(edges_.size())).first;
                    if (found->second == edges_.size()) edges_.push_back({edge, false});
                    triangle.edges[k] = found->second;
                }
                triangle.shape = {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
                triangle.behind = (isSolid(drawn[0]) ? -1 : 0) + (isSolid(drawn[1]) ? 1 : 0);
                shapes_.push_back(triangle.shape);
            }
        }
        for (const auto& [edge, around] : facesOfEdges(welded))
            if (const auto found = known.find(edge); found != known.end())
                edges_[found->second].isOpen = around.size() == 1;
    }

    std::optional<TightPlace> find() {
        if (triangles_.empty()) return std::nullopt;
        placeRoot();
        std::array<std::vector<std::vector<uint32_t>>, kLast> waiting; // per level
        waiting[0] = {{0}};
        for (int level = 0; level >= 0;) { // what was found last is divided to the end first
            auto& pieces = waiting[static_cast<size_t>(level)];
            if (pieces.empty()) {
                --level;
                continue;
            }
            std::vector<uint32_t> met;
            for (const auto& piece : takeSome(pieces))
                for (const uint32_t c : piece)
                    if (!divide(c, met)) return best_;
            joinNew();
            if (level + 1 >= kFirst) findMerged();
            if (level + 1 >= kBase) met = onWays(met);
            if (best_ && level + 1 >= kBase && largestOnWay_ <= bestVolume_) break;
            if (level + 1 < kLast) inPieces(std::move(met), waiting[static_cast<size_t>(++level)]);
        }
        return best_;
    }

private:
    struct Triangle {
        std::array<uint32_t, 3> corners, edges;
        ShellTriangle shape;
        int behind = 0; // which way from it along its normal lies what is closed: 0 neither
    };
    struct EdgeOf {
        Edge ends;
        bool isOpen;
    };
    struct Space { // cells that hang together
        double volume = 0;
        uint32_t widest = kNone; // cell
    };

    double sizeAt(int level) const { return std::ldexp(side_, -level); }
    double marginAt(int level) const { return sizeAt(std::max(level, kBase)); }
    double sizeOf(uint32_t c) const { return sizeAt(cells_[c].level); }
    dvec3 middleOf(const Cell& cell) const {
        return low_ + sizeAt(cell.level) * (dvec3(cell.at[0], cell.at[1], cell.at[2]) + 0.5);
    }

    void placeRoot() {
        const Bounds box = boundsOf(vertices_);
        const dvec3 size = box.high - box.low;
        side_ = kAround * std::max({size.x, size.y, size.z});
        low_ = box.centre() - 0.5 * side_;
        Cell root{.isMet = true};
        for (uint32_t t = 0; t < triangles_.size(); ++t) root.near.push_back(t);
        add(std::move(root));
    }

    void add(Cell cell) {
        leaf_[{cell.level, cell.at[0], cell.at[1], cell.at[2]}] = static_cast<uint32_t>(cells_.size());
        cells_.push_back(std::move(cell));
        ways_.emplace_back();
        spaces_.add();
    }

    // False where that would be too much.
    bool divide(uint32_t c, std::vector<uint32_t>& met) {
        const Cell parent = std::move(cells_[c]);
        cells_[c].isDivided = true;
        cells_[c].level = parent.level, cells_[c].at = parent.at;
        leaf_.erase({parent.level, parent.at[0], parent.at[1], parent.at[2]});
        const double half = 0.5 * sizeAt(parent.level + 1);
        for (int64_t k = 0; k < 8; ++k) {
            Cell cell;
            cell.level = parent.level + 1;
            cell.at = {2 * parent.at[0] + k % 2, 2 * parent.at[1] + k / 2 % 2, 2 * parent.at[2] + k / 4};
            const dvec3 middle = middleOf(cell);
            for (const uint32_t t : parent.near)
                if (meetsCube(triangles_[t].shape, middle, half + marginAt(cell.level))) {
                    cell.near.push_back(t);
                    cell.isMet = cell.isMet || meetsCube(triangles_[t].shape, middle, half);
                }
            tests_ += parent.near.size() + cell.near.size();
            if (cell.isMet)
                met.push_back(static_cast<uint32_t>(cells_.size()));
            else
                cell.near.clear();
            add(std::move(cell));
        }
        return tests_ < kMostTests && cells_.size() < kMostCells;
    }

    // From all over them.
    static std::vector<std::vector<uint32_t>> takeSome(std::vector<std::vector<uint32_t>>& pieces) {
        std::vector<std::vector<uint32_t>> out, left;
        for (size_t k = 0; k < pieces.size(); ++k) {
            const bool isNext = k * kPieces >= out.size() * pieces.size() && out.size() < kPieces;
            (isNext ? out : left).push_back(std::move(pieces[k]));
        }
        pieces = std::move(left);
        return out;
    }

    // Of few cells each, as they lie side by side.
    void inPieces(std::vector<uint32_t> cells, std::vector<std::vector<uint32_t>>& out) const {
        if (cells.empty()) return;
        if (cells.size() <= kPiece || cells_[cells[0]].level < kBase + 1)
            return out.push_back(std::move(cells));
        std::vector<dvec3> middles;
        for (const uint32_t c : cells) middles.push_back(middleOf(cells_[c]));
        const Bounds box = boundsOf(middles);
        const dvec3 size = box.high - box.low;
        const size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto half = cells.begin() + static_cast<ptrdiff_t>(cells.size() / 2);
        std::ranges::nth_element(cells, half, {}, [&](uint32_t c) { return cells_[c].at[axis]; });
        inPieces({half, cells.end()}, out);
        inPieces({cells.begin(), half}, out);
    }

    // The undivided cell there of this level or a larger one; none where smaller ones are, or beyond all.
    uint32_t leafAt(int level, std::array<int64_t, 3> at) const {
        for (; level >= 0; --level) {
            if (const auto found = leaf_.find({level, at[0], at[1], at[2]}); found != leaf_.end())
                return found->second;
            for (int64_t& x : at) x >>= 1;
        }
        return kNone;
    }

    // The undivided cells there, of those smaller than this level what borders on the cell `step` back.
    template<class Take>
    void eachBeside(int level, const std::array<int64_t, 3>& at, size_t axis, int64_t step,
                    const Take& take) const {
        if (std::ranges::any_of(at, [&](int64_t x) { return x < 0 || x >= (int64_t(1) << level); })) return;
        if (const uint32_t d = leafAt(level, at); d != kNone) return take(d);
        for (int64_t k = 0; k < 4; ++k) {
            std::array<int64_t, 3> finer{2 * at[0], 2 * at[1], 2 * at[2]};
            finer[axis] += step < 0;
            finer[(axis + 1) % 3] += k % 2, finer[(axis + 2) % 3] += k / 2;
            eachBeside(level + 1, finer, axis, step, take);
        }
    }

    // New cells of air to their neighbours.
    void joinNew() {
        before_ = spaces_;
        spaceBefore_ = space_;
        for (uint32_t c = joined_; c < cells_.size(); ++c) {
            if (cells_[c].isMet || cells_[c].isDivided) continue;
            const double size = sizeOf(c);
            space_[c] = {size * size * size, c};
            if (cells_[c].at == std::array<int64_t, 3>{} && outside_ == kNone) outside_ = c;
        }
        for (uint32_t c = joined_; c < cells_.size(); ++c) {
            if (cells_[c].isMet || cells_[c].isDivided) continue;
            for (size_t axis = 0; axis < 3; ++axis)
                for (const int64_t step : {-1, 1}) {
                    auto at = cells_[c].at;
                    at[axis] += step;
                    eachBeside(cells_[c].level, at, axis, step, [&](uint32_t d) {
                        if (cells_[d].isMet) return;
                        ways_[c].push_back(d);
                        if (d < joined_) ways_[d].push_back(c);
                        join(c, d);
                    });
                }
        }
        joined_ = static_cast<uint32_t>(cells_.size());
    }

    void join(uint32_t c, uint32_t d) {
        const uint32_t a = spaces_.root(c), b = spaces_.root(d);
        if (a == b) return;
        const Space from = space_.at(a);
        Space& to = space_.at(b);
        to.volume += from.volume;
        if (sizeOf(from.widest) > sizeOf(to.widest)) to.widest = from.widest;
        space_.erase(a);
        spaces_.join(a, b);
    }

    // The largest space that was not the outside before.
    void findMerged() {
        if (outside_ == kNone) return;
        const uint32_t outside = spaces_.root(outside_);
        Space largest;
        // What is much smaller than another one is a gap between faces.
        for (const auto& [root, space] : space_)
            if (root != outside) largest.volume = std::max(largest.volume, kLarge * space.volume);
        for (const auto& [root, space] : spaceBefore_)
            if (root != before_.root(outside_) && spaces_.root(root) == outside &&
                space.volume > largest.volume)
                largest = space;
        if (largest.widest == kNone || largest.volume <= bestVolume_) return;
        if (const auto leak = leakFrom(largest.widest)) best_ = leak, bestVolume_ = largest.volume;
    }

    // Along the way that keeps to large cells.
    std::optional<TightPlace> leakFrom(uint32_t from) const {
        std::unordered_map<uint32_t, std::pair<double, uint32_t>> reached{{from, {0, from}}};
        std::priority_queue<std::pair<double, uint32_t>, std::vector<std::pair<double, uint32_t>>,
                            std::greater<>>
            next;
        next.emplace(0, from);
        while (!next.empty() && next.top().second != outside_) {
            const auto [length, c] = next.top();
            next.pop();
            if (length > reached.at(c).first) continue;
            for (const uint32_t d : ways_[c]) {
                const double to = length + std::pow(sizeOf(c), -2) + std::pow(sizeOf(d), -2);
                const auto [known, isNew] = reached.try_emplace(d, to, c);
                if (!isNew && known->second.first <= to) continue;
                known->second = {to, c};
                next.emplace(to, d);
            }
        }
        if (next.empty()) return std::nullopt;
        std::vector<dvec3> way;
        for (uint32_t c = outside_; c != from; c = reached.at(c).second) way.push_back(middleOf(cells_[c]));
        way.push_back(middleOf(cells_[from]));
        return tightestPlace(way, shapes_);
    }

    // An edge of one face, unless that stands on another one there.
    bool endsInAir(uint32_t edge, const std::vector<uint32_t>& near, dvec3 middle) const {
        if (!edges_[edge].isOpen) return false;
        const dvec3 a = vertices_[edges_[edge].ends.first], b = vertices_[edges_[edge].ends.second],
                    p = a + placeOnSegment(middle, a, b) * (b - a);
        return std::ranges::none_of(near, [&](uint32_t t) {
            return std::ranges::find(triangles_[t].edges, edge) == triangles_[t].edges.end() &&
                   isOn(triangles_[t].shape, p, tolerance_);
        });
    }

    // Whether both hold the point of the line common to their planes that is nearest to the middle of a box.
    bool touch(uint32_t one, uint32_t other, dvec3 middle, double half) const {
        const ShellTriangle &s = triangles_[one].shape, &t = triangles_[other].shape;
        const dvec3 m = glm::cross(s.b - s.a, s.c - s.a), n = glm::cross(t.b - t.a, t.c - t.a),
                    way = glm::cross(m, n);
        const double square = glm::dot(way, way);
        if (square <= kParallel * glm::dot(m, m) * glm::dot(n, n)) return false;
        const dvec3 off = (glm::dot(s.a - middle, m) * glm::cross(n, way) +
                           glm::dot(t.a - middle, n) * glm::cross(way, m)) /
                          square;
        return glm::length(off) <= 2 * half && isOn(s, middle + off, tolerance_) &&
               isOn(t, middle + off, tolerance_);
    }

    // Whether what lies between any two of the pieces is closed: the two sides of a wall.
    bool areLayers(const Cell& cell, DisjointSets& pieces, dvec3 middle) const {
        for (uint32_t k = 0; k < cell.near.size(); ++k) {
            const Triangle& t = triangles_[cell.near[k]];
            if (t.behind == 0) return false;
            const dvec3 inwards =
                double(t.behind) * glm::normalize(glm::cross(t.shape.b - t.shape.a, t.shape.c - t.shape.a));
            for (uint32_t i = 0; i < cell.near.size(); ++i) {
                if (pieces.root(i) == pieces.root(k)) continue;
                const dvec3 p = nearestPoint(triangles_[cell.near[i]].shape, middle);
                if (glm::dot(p - t.shape.a, inwards) < tolerance_) return false;
            }
        }
        return true;
    }

    // Whether faces near the cell leave a way through.
    bool hasWay(const Cell& cell) const {
        const dvec3 middle = middleOf(cell);
        const double half = 0.5 * sizeAt(cell.level) + marginAt(cell.level);
        std::vector<uint32_t> edges, corners;
        for (const uint32_t k : cell.near) {
            edges.insert(edges.end(), triangles_[k].edges.begin(), triangles_[k].edges.end());
            corners.insert(corners.end(), triangles_[k].corners.begin(), triangles_[k].corners.end());
        }
        const auto keep = [&](std::vector<uint32_t>& all, const auto& meets) { // once each, those in the box
            std::ranges::sort(all);
            all.erase(std::unique(all.begin(), all.end()), all.end());
            std::erase_if(all, [&](uint32_t i) { return !meets(i); });
        };
        keep(edges, [&](uint32_t i) {
            const auto& [a, b] = edges_[i].ends;
            return meetsCube({vertices_[a], vertices_[b], vertices_[b]}, middle, half);
        });
        if (std::ranges::any_of(edges, [&](uint32_t i) { return endsInAir(i, cell.near, middle); }))
            return true;
        keep(corners, [&](uint32_t i) {
            return meetsCube({vertices_[i], vertices_[i], vertices_[i]}, middle, half);
        });
        const auto holds = [&](uint32_t corner) { return std::ranges::binary_search(corners, corner); };
        std::vector<uint32_t> first(edges.size(), kNone); // triangle of an edge, by its place in the list
        DisjointSets pieces(cell.near.size());
        int euler = static_cast<int>(corners.size());
        size_t count = cell.near.size();
        for (uint32_t k = 0; k < cell.near.size(); ++k) {
            const Triangle& t = triangles_[cell.near[k]];
            ++euler;
            for (size_t i = 0; i < 3; ++i) {
                euler += holds(t.corners[i]);
                const auto edge = std::ranges::lower_bound(edges, t.edges[i]);
                if (edge == edges.end() || *edge != t.edges[i]) continue;
                --euler;
                uint32_t& other = first[static_cast<size_t>(edge - edges.begin())];
                if (other == kNone) other = k;
                if (pieces.root(other) == pieces.root(k)) continue;
                pieces.join(k, other);
                --count;
            }
        }
        if (count > 1 && cell.near.size() > kMany) return true;
        for (uint32_t k = 0; k < cell.near.size() && count > 1;
             ++k) // where they were not cut along one another
            for (uint32_t i = 0; i < k; ++i) {
                if (pieces.root(i) == pieces.root(k) || !touch(cell.near[i], cell.near[k], middle, half))
                    continue;
                pieces.join(i, k);
                --count, --euler;
            }
        if (count > 1 && !areLayers(cell, pieces, middle)) return true;
        for (const uint32_t i : edges)
            euler += 1 - holds(edges_[i].ends.first) - holds(edges_[i].ends.second);
        return euler != static_cast<int>(count);
    }

    // Cells through which a way may lead from one large space to another.
    std::vector<uint32_t> onWays(const std::vector<uint32_t>& met) {
        std::vector<uint32_t> out;
        if (outside_ == kNone) return met;
        double largest = 0;
        const uint32_t outside = spaces_.root(outside_);
        for (const auto& [root, space] : space_)
            if (root != outside) largest = std::max(largest, space.volume);
        std::map<uint32_t, uint32_t> number; // in `sets`: of cells, and of small spaces
        std::vector<uint32_t> open;
        for (const uint32_t c : met) {
            tests_ += cells_[c].near.size();
            if (hasWay(cells_[c])) {
                number.emplace(c, static_cast<uint32_t>(number.size()));
                open.push_back(c);
            } else
                cells_[c].near = {};
        }
        std::map<uint32_t, std::set<uint32_t>> large; // per cell, spaces that it touches
        std::vector<std::pair<uint32_t, uint32_t>> pairs;
        for (const uint32_t c : open)
            for (int64_t k = 0; k < 27; ++k) {
                auto at = cells_[c].at;
                at[0] += k % 3 - 1, at[1] += k / 3 % 3 - 1, at[2] += k / 9 - 1;
                uint32_t d = leafAt(cells_[c].level, at);
                if (d == kNone || d == c) continue;
                if (!cells_[d].isMet) {
                    d = spaces_.root(d);
                    if (d == outside || space_.at(d).volume > kLarge * largest) {
                        large[c].insert(d);
                        continue;
                    }
                    number.emplace(d, static_cast<uint32_t>(number.size()));
                }
                if (number.contains(d)) pairs.emplace_back(c, d);
            }
        DisjointSets sets(number.size());
        for (const auto& [c, d] : pairs) sets.join(number.at(c), number.at(d));
        std::map<uint32_t, std::set<uint32_t>> touched; // per set
        for (const auto& [c, spaces] : large)
            touched[sets.root(number.at(c))].insert(spaces.begin(), spaces.end());
        largestOnWay_ = 0;
        for (const auto& [set, spaces] : touched)
            if (spaces.size() > 1)
                for (const uint32_t root : spaces)
                    if (root != outside) largestOnWay_ = std::max(largestOnWay_, space_.at(root).volume);
        for (const uint32_t c : open) {
            if (touched[sets.root(number.at(c))].size() > 1)
                out.push_back(c);
            else
                cells_[c].near = {};
        }
        return out;
    }

    double tolerance_;
    std::vector<dvec3> vertices_;
    std::vector<EdgeOf> edges_;
    std::vector<Triangle> triangles_;
    std::vector<ShellTriangle> shapes_; // of these
    dvec3 low_{0};
    double side_ = 0;
    std::vector<Cell> cells_;
    std::unordered_map<std::array<int64_t, 4>, uint32_t, KeyHash> leaf_;
    std::vector<std::vector<uint32_t>> ways_;                 // per cell of air, its neighbours
    DisjointSets spaces_, before_;                            // cells of air that hang together
    std::unordered_map<uint32_t, Space> space_, spaceBefore_; // by root
    uint32_t joined_ = 0, outside_ = kNone;
    size_t tests_ = 0;
    std::optional<TightPlace> best_;
    double bestVolume_ = 0, largestOnWay_ = 0;
};

} // namespace

std::optional<TightPlace> airLeak(const std::vector<SoupFace>& faces, double tolerance) {
    return LeakFinder(faces, tolerance).find();
}

} // namespace heliodon::geometry
