#include "geometry/plan_walls.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/plan_fillings.h"
#include "geometry/ray_crossing.h"
#include "geometry/straight_sides.h"
#include "geometry/used_stretches.h"

namespace heliodon::geometry {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSameArc = 0.25 + 1e-6; // inches: by which copies of an arc miss one another
constexpr double kShortestWall = 0.1;    // inches: shorter ones are slips of the detection
constexpr double kLeastInside = 0.02;    // inches: the inner radius of an arc
constexpr double kMeet = 1e-9;           // radians: arcs that end where others begin, but for rounding

glm::dvec2 onCircle(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

auto order(const WallPiece& p) {
    return std::tuple(p.a.x, p.a.y, p.b.x, p.b.y, p.center.x, p.center.y, p.radius, p.thickness, p.height);
}

// Straight walls run from the lower to the higher end, so that neither file order nor drawing direction
// matters.
std::vector<WallPiece> straightPieces(const Sketch& sketch, bool green, PlanWalls& plan) {
    std::vector<WallPiece> pieces;
    for (const Wall& wall : sketch.walls) {
        if ((wall.heightClass == HeightClass::green) != green) continue;
        if (glm::length(wall.b - wall.a) < kShortestWall) {
            plan.notes.push_back(
                {"ZERO_LENGTH_WALL", fmt::format("wall {} has no length and is ignored", wall.id)});
            plan.ignored.push_back({wall.id, "has no length"});
            continue;
        }
        WallPiece piece;
        piece.ids = {wall.id};
        const bool forward = std::pair(wall.a.x, wall.a.y) < std::pair(wall.b.x, wall.b.y);
        piece.a = forward ? wall.a : wall.b;
        piece.b = forward ? wall.b : wall.a;
        piece.thickness = wall.thickness;
        piece.height = heightInches(wall.heightClass);
        pieces.push_back(piece);
    }
    std::ranges::sort(pieces, {}, order);
    return pieces;
}

std::vector<WallPiece> curvedPieces(const Sketch& sketch, bool green, PlanWalls& plan) {
    std::vector<WallPiece> pieces;
    for (const Arc& arc : sketch.arcs) {
        if ((arc.heightClass == HeightClass::green) != green) continue;
        const double sweep = std::min((arc.a1Deg - arc.a0Deg) * kPi / 180, 2 * kPi);
        if (sweep * arc.radius < kShortestWall || arc.radius < arc.thickness / 2 + kLeastInside) {
            plan.notes.push_back(
                {"ZERO_LENGTH_WALL", fmt::format("arc {} is too small to be a wall and is ignored", arc.id)});
            plan.ignored.push_back({arc.id, "too small to be a wall"});
            continue;
        }
        WallPiece piece;
        piece.ids = {arc.id};
        piece.curved = true;
        piece.center = arc.center;
        piece.radius = arc.radius;
        piece.a0 = std::remainder(arc.a0Deg, 360) * kPi / 180;
        piece.a1 = piece.a0 + sweep;
        piece.a = arc.center + arc.radius * onCircle(piece.a0);
        piece.b = arc.center + arc.radius * onCircle(piece.a1);
        piece.thickness = arc.thickness;
        piece.height = heightInches(arc.heightClass);
        pieces.push_back(piece);
    }
    std::ranges::sort(pieces, {}, order);
    return pieces;
}

// Copies of an arc, or pieces of it that overlap, become one arc. Longest first, as with straight sides;
// facets of a ring lie as they do round the middle of its longest piece.
void mergeArcs(std::vector<WallPiece>& arcs) {
    std::ranges::stable_sort(arcs, std::greater(), lengthOf);
    for (size_t i = 0; i < arcs.size(); ++i) {
        WallPiece& p = arcs[i];
        const double middle = (p.a0 + p.a1) / 2;
        for (size_t j = i + 1; j < arcs.size(); ++j) {
            const WallPiece& q = arcs[j];
            if (glm::length(p.center - q.center) > kSameArc || std::abs(p.radius - q.radius) > kSameArc ||
                p.height != q.height)
                continue;
            const double shift = 2 * kPi * std::round((p.a0 + p.a1 - q.a0 - q.a1) / (4 * kPi));
            const double b0 = q.a0 + shift, b1 = q.a1 + shift;
            if (b0 > p.a1 + kMeet || b1 < p.a0 - kMeet) continue;
            const double share = (b1 - b0) / (p.a1 - p.a0 + b1 - b0); // the longer one knows the circle best
            p.center += share * (q.center - p.center);
            p.radius += share * (q.radius - p.radius);
            p.a0 = std::min(p.a0, b0);
            p.a1 = std::max(p.a1, b1);
            if (p.a1 - p.a0 >= 2 * kPi) {
                p.a0 = middle - kPi;
                p.a1 = middle + kPi;
            }
            p.a = p.center + p.radius * onCircle(p.a0);
            p.b = p.center + p.radius * onCircle(p.a1);
            p.ids.insert(p.ids.end(), q.ids.begin(), q.ids.end());
            arcs.erase(arcs.begin() + static_cast<std::ptrdiff_t>(j));
            j = i;
        }
    }
    std::ranges::sort(arcs, {}, order);
}

// Pieces on one line that overlap become one. Where one of them is higher or thicker, that holds as far as
// it reaches, or a little farther, where what is left of the other is too short to have been meant.
class OverlapMerger {
public:
    OverlapMerger(std::vector<WallPiece>& pieces, const std::vector<WallLine>& lines)
        : pieces_(pieces), lines_(lines) {}

    void merge() {
        sort();
        for (size_t i = 0; i + 1 < pieces_.size();) {
            const WallPiece &p = pieces_[i], &q = pieces_[i + 1];
            const bool meet = p.line == q.line && from(q) <= to(p) + 1e-6;
            if (!meet || (!alike(p, q) && std::min(to(p), to(q)) - from(q) < 1e-6)) {
                ++i;
                continue;
            }
            const std::vector<WallPiece> apart = divided(p, q);
            pieces_[i] = apart[0];
            pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            pieces_.insert(pieces_.end(), apart.begin() + 1, apart.end());
            sort();
        }
    }

private:
    static constexpr double kShortestEnd = 1; // inches: copies are laid by eye

    double from(const WallPiece& p) const { return lines_[static_cast<size_t>(p.line)].along(p.a); }
    double to(const WallPiece& p) const { return lines_[static_cast<size_t>(p.line)].along(p.b); }
    void sort() {
        std::ranges::stable_sort(pieces_, {}, [&](const WallPiece& p) { return std::pair(p.line, from(p)); });
    }

    static bool alike(const WallPiece& p, const WallPiece& q) {
        return p.height == q.height && std::abs(p.thickness - q.thickness) < 0.05;
    }

    // Two pieces, p the first, as one to three that do not overlap: what is before both, both, what is
    // beyond.
    std::vector<WallPiece> divided(const WallPiece& p, const WallPiece& q) const {
        const WallPiece& last = to(q) > to(p) ? q : p;
        WallPiece both = p;
        both.a = q.a;
        both.b = (&last == &p ? q : p).b;
        both.height = std::max(p.height, q.height);
        both.thickness = std::max(p.thickness, q.thickness);
        std::ranges::copy_if(q.ids, std::back_inserter(both.ids),
                             [&](const std::string& id) { return !std::ranges::count(p.ids, id); });
        std::vector<WallPiece> out;
        if (alike(both, p) || from(q) - from(p) < kShortestEnd) {
            both.a = p.a;
        } else {
            out.push_back(p);
            out.back().b = both.a;
        }
        out.push_back(both);
        if (alike(both, last) || to(last) - to(both) < kShortestEnd) {
            out.back().b = last.b;
        } else {
            out.push_back(last);
            out.back().a = both.b;
        }
        return out;
    }

    std::vector<WallPiece>& pieces_;
    const std::vector<WallLine>& lines_;
};

void chooseFacets(WallPiece& piece, const PlanWallsOptions& options) {
    const double sweep = std::min(piece.a1 - piece.a0, 2 * kPi), outer = piece.radius + piece.thickness / 2;
    const auto widest = [&](double chordError, double most) {
        return std::clamp(2 * std::acos(1 - std::min(0.5, chordError / outer)), kPi / 180, most);
    };
    const auto fewest = [&](double step) {
        const double count = std::max(2.0, std::ceil(sweep / step));
        // Of two, the corner between them lies 4/3 of the sagitta outside, of more at most the sagitta.
        return count == 2 && sweep > 2 * std::sqrt(0.75) * step ? 3.0 : count;
    };
    piece.widestFacet = widest(options.chordError, kPi / 12);
    double count = fewest(piece.widestFacet);
    if (options.facetLength > 0) {
        const double lengths = sweep * piece.radius / options.facetLength, each = std::floor(lengths / count);
        if (each >= 1) {
            count = std::max(count, std::round(lengths / each));
        } else {
            piece.widestFacet = widest(std::max(options.chordError, options.coarseChord), kPi / 6);
            count = std::max(fewest(piece.widestFacet), std::round(lengths));
        }
    }
    piece.facets = static_cast<int>(count);
}

} // namespace

double lengthOf(const WallPiece& piece) {
    return piece.curved ? piece.radius * (piece.a1 - piece.a0) : glm::length(piece.b - piece.a);
}

glm::dvec2 wayOf(const WallPiece& piece, glm::dvec2 p) {
    return piece.curved ? leftOf(p - piece.center) : piece.b - piece.a;
}

double cornerReach(double sweep, int count, bool full) {
    const double step = sweep / count, sine = std::sin(step);
    if (full) return std::sqrt(step / sine);
    // (count - 2) sine x^2 + 2 sine x = count step, in radii.
    const double inner = (count - 2) * sine;
    return count * step / (sine + std::sqrt(sine * sine + inner * count * step));
}

std::vector<glm::dvec2> faceCorners(const WallPiece& piece, bool outer) {
    if (!piece.corners[0].empty()) return piece.corners[outer ? 0 : 1];
    const double radius = piece.radius + (outer ? 0.5 : -0.5) * piece.thickness;
    // A full circle closes in the very same points, so that its seam cancels.
    const bool full = piece.a1 - piece.a0 >= 2 * kPi - 1e-9;
    const double sweep = full ? 2 * kPi : piece.a1 - piece.a0;
    const int count = piece.facets;
    const double reach = cornerReach(sweep, count, full);
    std::vector<glm::dvec2> corners;
    for (int k = 0; k <= count; ++k) {
        // The last angle is that of wallEnd() to the last bit: fillings share these corners.
        const double angle = piece.a0 + (k < count ? sweep * k / count : full ? 0 : sweep);
        const bool between = full || (k > 0 && k < count);
        corners.push_back(piece.center + (between ? reach * radius : radius) * onCircle(angle));
    }
    return corners;
}

PlanSolid footprint(const WallPiece& piece) {
    PlanSolid solid;
    if (!piece.curved) {
        const glm::dvec2 n = piece.thickness / 2 * leftOf(glm::normalize(piece.b - piece.a));
        solid.outline = {piece.a - n, piece.b - n, piece.b + n, piece.a + n};
        solid.sides = {SolidSide::right, SolidSide::end, SolidSide::left, SolidSide::end};
        return solid;
    }
    for (const bool outer : {true, false}) {
        std::vector<glm::dvec2> corners = faceCorners(piece, outer);
        if (!outer) std::ranges::reverse(corners);
        solid.outline.insert(solid.outline.end(), corners.begin(), corners.end());
        solid.sides.insert(solid.sides.end(), corners.size() - 1, outer ? SolidSide::right : SolidSide::left);
        solid.sides.push_back(SolidSide::end);
    }
    return solid;
}

bool contains(const std::vector<glm::dvec2>& polygon, glm::dvec2 p) {
    bool inside = false;
    for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
        if (rayCrosses(p, polygon[i], polygon[j])) inside = !inside;
    return inside;
}

WallEnd wallEnd(const WallPiece& piece, int index, bool atB) {
    WallEnd end{index, atB};
    end.middle = atB ? piece.b : piece.a;
    if (piece.curved)
        end.out = leftOf(onCircle(atB ? piece.a1 : piece.a0)) * (atB ? 1.0 : -1.0);
    else
        end.out = glm::normalize(piece.b - piece.a) * (atB ? 1.0 : -1.0);
    // The same expressions as in footprint(), so that the corners are the same points to the last bit.
    const double half = piece.thickness / 2;
    if (piece.curved) {
        const glm::dvec2 r = onCircle(piece.a0 + (piece.a1 - piece.a0) * (atB ? 1 : 0));
        const glm::dvec2 outer = piece.center + (piece.radius + half) * r,
                         inner = piece.center + (piece.radius - half) * r;
        end.right = atB ? outer : inner;
        end.left = atB ? inner : outer;
        return end;
    }
    const glm::dvec2 n = half * leftOf(glm::normalize(piece.b - piece.a));
    end.right = atB ? piece.b - n : piece.a + n;
    end.left = atB ? piece.b + n : piece.a - n;
    return end;
}

bool touches(const std::vector<PlanSolid>& solids, const WallEnd& end) {
    // Just ahead, or just behind where the end face is flush with another wall's face.
    const glm::dvec2 ahead = end.middle + 1e-4 * end.out, behind = end.middle - 1e-2 * end.out;
    return std::ranges::any_of(solids, [&](const PlanSolid& solid) {
        return solid.piece != end.piece &&
               (contains(solid.outline, ahead) || contains(solid.outline, behind));
    });
}

double firstHit(std::span<const PlanSolid> solids, glm::dvec2 origin, glm::dvec2 direction, int except,
                int* hit) {
    constexpr double kBeside = 1e-8; // of an edge: more than its ends may be missed by, and rounding
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t s = 0; s < solids.size(); ++s) {
        const PlanSolid& solid = solids[s];
        if (solid.piece == except && except >= 0) continue;
        for (size_t k = 0; k < solid.outline.size(); ++k) {
            const glm::dvec2 a = solid.outline[k], b = solid.outline[(k + 1) % solid.outline.size()];
            const double turn = cross(direction, b - a);
            if (std::abs(turn) < 1e-12) continue;
            // Most edges are passed well beside them, which is told without dividing.
            const double side = cross(a - origin, direction), square = turn * turn;
            if (side * turn < -kBeside * square || side * turn > (1 + kBeside) * square) continue;
            const double t = cross(a - origin, b - a) / turn, u = side / turn;
            if (t < 1e-9 || u < -1e-9 || u > 1 + 1e-9 || t >= nearest) continue;
            nearest = t;
            if (hit) *hit = static_cast<int>(s);
        }
    }
    return nearest;
}

PlanWalls planWalls(const Sketch& sketch, const PlanWallsOptions& options) {
    PlanWalls plan;
    for (const bool green : {false, true}) {
        std::vector<WallPiece>& pieces = green ? plan.partitions : plan.pieces;
        pieces = straightPieces(sketch, green, plan);
        joinEndToEnd(pieces);
        findStraightSides(pieces, plan.lines);
        OverlapMerger(pieces, plan.lines).merge();
        std::vector<WallPiece> arcs = curvedPieces(sketch, green, plan);
        mergeArcs(arcs);
        pieces.insert(pieces.end(), arcs.begin(), arcs.end());
    }
    for (std::vector<WallPiece>* pieces : {&plan.pieces, &plan.partitions})
        for (WallPiece& piece : *pieces)
            if (piece.curved) chooseFacets(piece, options);
    for (size_t i = 0; i < plan.pieces.size(); ++i) {
        plan.solids.push_back(footprint(plan.pieces[i]));
        plan.solids.back().piece = static_cast<int>(i);
    }
    plan.crackWidth = options.crackWidth;
    fillCracks(plan, options.crackWidth);
    reachWalls(plan);
    return plan;
}

} // namespace heliodon::geometry
