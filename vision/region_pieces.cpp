#include "vision/region_pieces.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "vision/pieces.h"
#include "vision/round_holes.h"
#include "vision/vivid_part.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {

bool isLightBlue(const Component& region) {
    return region.group == Paint::blue && 2 * region.minorityArea > region.area;
}

const char* whyNoWall(const Component& region) {
    return region.group == Paint::red && 2 * region.minorityArea > region.area
               ? "orange like the north arrow, but not of its shape: does a wall hide a part? It is left out"
               : "coloured like a wall, but not of a wall's shape; it is left out";
}

RegionCutter::Pieces RegionCutter::piecesOf(const Component& region) {
    Pieces out;
    if (!isLightBlue(region) && isStripOrArc(region, view_, options_))
        out.pieces.push_back(&region);
    else if (addVivid(region, out))
        return out;
    else if (isLightBlue(region))
        out.unread = "light blue like a skylight, but no rectangle; it is left out";
    else
        addStrips(region, out);
    leaveOutRims(region, out);
    return out;
}

void RegionCutter::leaveOutRims(const Component& region, Pieces& out) const {
    constexpr double kLeast = 0.25, kMost = 2, kRim = 1.3; // inches; of a wall's thickness
    const double perInch = view_.pixelsPerInch(view_.plan(region.centre, 0), 0);
    const std::vector<RoundHole> holes = roundHoles(region, kLeast * perInch, kMost * perInch);
    const size_t left = std::erase_if(out.pieces, [&](const Component* piece) {
        return liesRound(*piece, holes, kRim * options_.wallThickness * perInch);
    });
    if (left > 0)
        out.unread = "coloured like a wall, but closed round a hole as a roll of tape is; it is left out";
}

bool RegionCutter::hasVividPieces(const Component& region) const {
    return !vividPieces(vividPart(region, image_, view_)).empty() ||
           !vividPieces(bluePart(region, image_)).empty();
}

// Shade in a light of another colour, or what a file smears, has run into paint, or a skylight touches it:
// strips are left where what is pale is taken away.
bool RegionCutter::addVivid(const Component& region, Pieces& out) {
    const std::optional<ClassImage> blue = bluePart(region, image_);
    if (!addPiecesOf(vividPart(region, image_, view_), region, out) && !addPiecesOf(blue, region, out))
        return false;
    if (blue && 2 * areaOf(Paint::sky, region) < region.minorityArea)
        out.unread =
            "light blue beside a blue wall: a skylight that it hides in part, or shade? It is left out";
    return true;
}

// Of what of the region is left, pixels.
int RegionCutter::areaOf(Paint paint, const Component& region) const {
    int area = 0;
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x) area += image_.at(x, run.y) == paint;
    return area;
}

bool RegionCutter::addPiecesOf(const std::optional<ClassImage>& vivid, const Component& region, Pieces& out) {
    std::vector<Component> parts = vividPieces(vivid);
    if (parts.empty()) return false;
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x)
            if (vivid->at(x, run.y) == Paint::none) image_.set(x, run.y, Paint::none);
    for (Component& part : parts) keep(std::move(part), out);
    return true;
}

std::vector<Component> RegionCutter::vividPieces(const std::optional<ClassImage>& vivid) const {
    if (!vivid) return {};
    std::vector<Component> parts = findComponents(*vivid, smallestArea(view_));
    std::erase_if(parts, [&](const Component& part) { return !isVividPiece(part); });
    return parts;
}

// What is curved, as a finger is, has to show white ends.
bool RegionCutter::isVividPiece(const Component& part) const {
    constexpr float kEnd = 0.1f;
    if (isLightBlue(part) || !isStripOrArc(part, view_, options_)) return false;
    const Chain alone{part.group, {&part}, {}};
    if (fitStraight(alone, view_, options_)) return true;
    const auto arc = fitArc(alone, view_, options_);
    if (!arc) return true;
    const auto ends = evidence().endSteps(*arc);
    return std::min(ends[0], ends[1]) > kEnd;
}

// A region that is neither a straight strip nor an arc may be walls that touch: its strips, if they are
// walls.
void RegionCutter::addStrips(const Component& region, Pieces& out) {
    for (Component& thin : thinParts(region, view_, options_)) {
        if (thin.area < region.area && isStripOrArc(thin, view_, options_)) {
            keep(std::move(thin), out);
            continue;
        }
        std::vector<geometry::Arc> arcs; // that have their pieces already
        for (Component& strip : splitStrips(thin, view_, options_)) {
            const Chain piece{region.group, {&strip}, {}};
            const auto wall = fitStraight(piece, view_, options_);
            if (!wall || !evidence().isWall(wall->wall)) {
                if (liesOnOne(arcs, strip)) continue;
                const auto arc = followArc(strip, thin);
                if (!arc) continue;
                arcs.push_back(*arc);
            }
            keep(std::move(strip), out);
        }
    }
    if (out.pieces.empty()) out.unread = whyNoWall(region);
}

void RegionCutter::keep(Component&& part, Pieces& out) {
    parts_.push_back(std::move(part));
    out.pieces.push_back(&parts_.back());
}

// The arc of a strip that was cut out of a region, which takes what of the region goes on along it as far as
// white ends would be.
std::optional<geometry::Arc> RegionCutter::followArc(Component& strip, const Component& region) const {
    constexpr int kMostPasses = 40;
    auto arc = fitArc({strip.group, {&strip}, {}}, view_, options_);
    for (int pass = 0; arc && pass < kMostPasses; ++pass) {
        Component longer = alongArc(region, *arc);
        if (longer.area <= strip.area) break;
        const auto next = fitArc({longer.group, {&longer}, {}}, view_, options_);
        if (!next) break;
        strip = std::move(longer), arc = next;
    }
    return arc;
}

Component RegionCutter::alongArc(const Component& region, const geometry::Arc& arc) const {
    Component out;
    out.group = region.group;
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x) {
            if (!isOn(arc, {x, run.y})) continue;
            out.runs.push_back({run.y, x, x + 1});
            out.centre += glm::dvec2(x, run.y), ++out.area;
        }
    if (out.area > 0) out.centre /= out.area;
    return out;
}

bool RegionCutter::isOn(const geometry::Arc& arc, glm::dvec2 pixel) const {
    const glm::dvec2 p = view_.plan(pixel, geometry::heightInches(arc.heightClass)) - arc.center;
    if (std::abs(glm::length(p) - arc.radius) > 0.6 * options_.wallThickness) return false;
    const double beyond = glm::degrees(0.8 * options_.unpaintedEnd / arc.radius); // its own ends are in it
    double angle = glm::degrees(std::atan2(p.y, p.x)) - arc.a0Deg + beyond;
    angle -= 360 * std::floor(angle / 360);
    return angle < arc.a1Deg - arc.a0Deg + 2 * beyond;
}

bool RegionCutter::liesOnOne(const std::vector<geometry::Arc>& arcs, const Component& strip) const {
    return std::any_of(arcs.begin(), arcs.end(), [&](const geometry::Arc& arc) {
        const auto on = std::count_if(strip.runs.begin(), strip.runs.end(), [&](const Run& run) {
            return isOn(arc, {0.5 * (run.x0 + run.x1 - 1), run.y});
        });
        return 2 * static_cast<size_t>(on) > strip.runs.size();
    });
}

} // namespace heliodon::vision
