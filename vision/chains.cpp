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

constexpr Paint kWalls[] = {Paint::red, Paint::blue, Paint::green}; // whose heights a marker may have
constexpr size_t kMiddleHeight = 1;
size_t placeOf(Paint wall) {
    return static_cast<size_t>(std::find(std::begin(kWalls), std::end(kWalls), wall) - std::begin(kWalls));
}

// The regions that walls are made of, wall paint first, then markers, each where it is in plan.
struct Regions {
    std::vector<const Component*> all;
    size_t pieces = 0;                    // that many are wall paint
    std::vector<std::array<Pca, 3>> axes; // by height: of a piece only at its own
    std::vector<MomentsByHeight> moments; // the same
    double straight = 0;                  // most standard deviation across a strip

    Regions(const std::vector<const Component*>& wallPieces, const std::vector<const Component*>& markers,
            const PlanView& view, const DetectOptions& options)
        : all(wallPieces), pieces(wallPieces.size()),
          straight(1.5 *
                   stripSpread(view, {}, geometry::heightInches(geometry::HeightClass::blue), options)) {
        all.insert(all.end(), markers.begin(), markers.end());
        axes.resize(all.size()), moments.resize(all.size());
        for (size_t i = 0; i < all.size(); ++i)
            for (size_t h = 0; h < 3; ++h) {
                if (isPiece(i) && kWalls[h] != all[i]->group) continue;
                const double fold = isPiece(i) ? 0 : options.markerThickness;
                const auto points = planPoints(*all[i], view, heightOf(kWalls[h]) + fold);
                axes[i][h] = principalAxes(points);
                moments[i][h].add(points);
            }
    }
    bool isPiece(size_t i) const { return i < pieces; }
    Paint paintOf(size_t i) const { return isPiece(i) ? all[i]->group : Paint::none; }
};

struct Link {
    double off;
    size_t a, b;
};

// Which regions continue one another, the best first; those of markers alone, whose height is not known,
// last.
std::vector<Link> findLinks(const Regions& regions) {
    std::vector<Link> links;
    for (size_t i = 0; i < regions.pieces; ++i) {
        const size_t h = placeOf(regions.paintOf(i));
        if (regions.axes[i][h].minor > regions.straight) continue; // curved: nothing can be hung on it
        for (size_t k = regions.pieces; k < regions.all.size(); ++k)
            if (const auto off = continues(regions.axes[i][h], regions.axes[k][h], kMarkerGap))
                links.push_back({*off, i, k});
        for (size_t k = i + 1; k < regions.pieces; ++k)
            if (regions.paintOf(k) == regions.paintOf(i) && regions.axes[k][h].minor < regions.straight)
                if (const auto off = continues(regions.axes[i][h], regions.axes[k][h], kPieceGap))
                    links.push_back({*off, i, k});
    }
    for (size_t i = regions.pieces; i < regions.all.size(); ++i)
        for (size_t k = i + 1; k < regions.all.size(); ++k)
            if (const auto off =
                    continues(regions.axes[i][kMiddleHeight], regions.axes[k][kMiddleHeight], kMarkerGap))
                links.push_back({*off + kOffLine, i, k});
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.off < b.off; });
    return links;
}

} // namespace

Chains formChains(const std::vector<const Component*>& wallPieces,
                  const std::vector<const Component*>& markers, const PlanView& view,
                  const DetectOptions& options) {
    Regions regions(wallPieces, markers, view, options);
    const size_t n = regions.all.size();
    std::vector<size_t> set(n);
    std::iota(set.begin(), set.end(), size_t{0});
    std::vector<Paint> paintOf;
    for (size_t i = 0; i < n; ++i) paintOf.push_back(regions.paintOf(i));
    for (const Link& link : findLinks(regions)) {
        const size_t from = set[link.b], to = set[link.a];
        if (from == to) continue;
        if (paintOf[from] != Paint::none && paintOf[to] != Paint::none && paintOf[from] != paintOf[to])
            continue;
        // A marker at a corner continues both walls there: together they must stay one straight strip.
        const Paint paint = paintOf[to] != Paint::none ? paintOf[to] : paintOf[from];
        const size_t h = paint == Paint::none ? kMiddleHeight : placeOf(paint);
        Moments together = regions.moments[to][h];
        together.add(regions.moments[from][h]);
        if (together.minor() > regions.straight) continue;
        paintOf[to] = paint;
        for (size_t i = 0; i < 3; ++i) regions.moments[to][i].add(regions.moments[from][i]);
        std::replace(set.begin(), set.end(), from, to);
    }
    Chains out;
    for (size_t root = 0; root < n; ++root) {
        Chain chain;
        chain.paint = paintOf[root];
        for (size_t i = 0; i < n; ++i)
            if (set[i] == root) (regions.isPiece(i) ? chain.pieces : chain.markers).push_back(regions.all[i]);
        if (!chain.pieces.empty())
            out.chains.push_back(chain);
        else
            out.orphans.insert(out.orphans.end(), chain.markers.begin(), chain.markers.end());
    }
    return out;
}

} // namespace heliodon::vision
