// Which pieces of paint and which markers make one wall. The paper merges parallel walls that lie close; here
// a piece, a marker and the next piece must continue one another along one line.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

#include "vision/edges.h"
#include "vision/pieces.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {
namespace {

constexpr double kMarkerGap = 0.3; // inches between paint and the marker next to it
constexpr double kPieceGap = 0.6;  // two walls are further apart: each has half an inch of white
constexpr double kOffLine = 0.2;   // inches

// Distance by which two regions fail to continue one another; none when they do not.
std::optional<double> continues(const Pca& a, const Pca& b, double maxGap) {
    const Pca& longer = a.high - a.low >= b.high - b.low ? a : b;
    const Pca& shorter = &longer == &a ? b : a;
    glm::dvec2 along = longer.axis;
    const glm::dvec2 apart = shorter.mean - longer.mean;
    // Too short to have a direction, both of them: that of the line between them.
    if (longer.high - longer.low < 0.8) along = glm::normalize(apart + glm::dvec2(1e-12, 0));
    const double off = std::abs(glm::dot(apart, turnedLeft(along)));
    if (off > kOffLine) return std::nullopt;
    const double half = 0.5 * (longer.high - longer.low);
    const double middle = 0.5 * (longer.high + longer.low);
    const bool sameWay = shorter.high - shorter.low > 1 && shorter.major > 2 * shorter.minor;
    if (sameWay && std::abs(glm::dot(shorter.axis, turnedLeft(along))) > 0.2) return std::nullopt;
    const double gap = std::abs(glm::dot(apart, along) - middle) - half - 0.5 * (shorter.high - shorter.low);
    if (gap > maxGap) return std::nullopt;
    return off;
}

// Sums over a region's pixels at one height, from which the spread of several together follows.
struct Moments {
    double n = 0, xx = 0, xy = 0, yy = 0;
    glm::dvec2 sum{};

    void add(const std::vector<glm::dvec2>& points) {
        for (const glm::dvec2& p : points)
            n += 1, sum += p, xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
    }
    void add(const Moments& o) { n += o.n, sum += o.sum, xx += o.xx, xy += o.xy, yy += o.yy; }
    double minor() const { // standard deviation across
        const glm::dvec2 mean = sum / n;
        const double a = xx / n - mean.x * mean.x, b = xy / n - mean.x * mean.y, c = yy / n - mean.y * mean.y;
        return std::sqrt(std::max(0.0, 0.5 * (a + c) - std::hypot(0.5 * (a - c), b)));
    }
};
using MomentsByHeight = std::array<Moments, 3>; // red, blue, green

struct Link {
    double off;
    size_t a, b;
};

} // namespace

Chains formChains(const std::vector<const Component*>& wallPieces,
                  const std::vector<const Component*>& markers, const PlanView& view,
                  const DetectOptions& options) {
    const size_t pieces = wallPieces.size(), n = pieces + markers.size();
    const Paint heights[] = {Paint::red, Paint::blue, Paint::green};
    std::vector<Pca> pieceAxes;
    std::vector<std::array<Pca, 3>> markerAxes;
    std::vector<MomentsByHeight> moments(n);
    auto placeOf = [&](Paint paint) {
        return static_cast<size_t>(std::find(std::begin(heights), std::end(heights), paint) -
                                   std::begin(heights));
    };
    for (size_t i = 0; i < pieces; ++i) {
        const auto points = planPoints(*wallPieces[i], view, heightOf(wallPieces[i]->group));
        pieceAxes.push_back(principalAxes(points));
        moments[i][placeOf(wallPieces[i]->group)].add(points);
    }
    for (size_t k = 0; k < markers.size(); ++k) {
        markerAxes.push_back({});
        for (size_t h = 0; h < 3; ++h) {
            const auto points = planPoints(*markers[k], view, heightOf(heights[h]) + options.markerThickness);
            markerAxes.back()[h] = principalAxes(points);
            moments[pieces + k][h].add(points);
        }
    }
    const double straight =
        1.5 * stripSpread(view, {}, geometry::heightInches(geometry::HeightClass::blue), options);
    std::vector<Link> links;
    for (size_t i = 0; i < pieces; ++i) {
        if (pieceAxes[i].minor > straight) continue; // curved: nothing can be hung on it
        const Paint paint = wallPieces[i]->group;
        const size_t h = placeOf(paint);
        for (size_t k = 0; k < markers.size(); ++k)
            if (const auto off = continues(pieceAxes[i], markerAxes[k][h], kMarkerGap))
                links.push_back({*off, i, pieces + k});
        for (size_t k = i + 1; k < pieces; ++k)
            if (wallPieces[k]->group == paint && pieceAxes[k].minor < straight)
                if (const auto off = continues(pieceAxes[i], pieceAxes[k], kPieceGap))
                    links.push_back({*off, i, k});
    }
    for (size_t i = 0; i < markers.size(); ++i)
        for (size_t k = i + 1; k < markers.size(); ++k)
            if (const auto off = continues(markerAxes[i][1], markerAxes[k][1], kMarkerGap))
                links.push_back({*off + kOffLine, pieces + i, pieces + k}); // after those that state a height
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.off < b.off; });

    std::vector<size_t> set(n);
    std::iota(set.begin(), set.end(), size_t{0});
    std::vector<Paint> paintOf(n, Paint::none);
    for (size_t i = 0; i < pieces; ++i) paintOf[i] = wallPieces[i]->group;
    for (const Link& link : links) {
        const size_t from = set[link.b], to = set[link.a];
        if (from == to) continue;
        if (paintOf[from] != Paint::none && paintOf[to] != Paint::none && paintOf[from] != paintOf[to])
            continue;
        // A marker at a corner continues both walls there: together they must stay one straight strip.
        const Paint paint = paintOf[to] != Paint::none ? paintOf[to] : paintOf[from];
        const size_t h = paint == Paint::none ? 1 : placeOf(paint);
        Moments together = moments[to][h];
        together.add(moments[from][h]);
        if (together.minor() > straight) continue;
        paintOf[to] = paint;
        for (size_t i = 0; i < 3; ++i) moments[to][i].add(moments[from][i]);
        std::replace(set.begin(), set.end(), from, to);
    }
    Chains out;
    for (size_t root = 0; root < n; ++root) {
        Chain chain;
        chain.paint = paintOf[root];
        for (size_t i = 0; i < n; ++i) {
            if (set[i] != root) continue;
            if (i < pieces)
                chain.pieces.push_back(wallPieces[i]);
            else
                chain.markers.push_back(markers[i - pieces]);
        }
        if (!chain.pieces.empty())
            out.chains.push_back(chain);
        else
            out.orphans.insert(out.orphans.end(), chain.markers.begin(), chain.markers.end());
    }
    return out;
}

} // namespace heliodon::vision
