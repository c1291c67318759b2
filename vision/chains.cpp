// Which pieces of paint and which markers make one wall. The paper merges parallel walls that lie close; here
// a piece, a marker and the next piece must continue one another along one line.
#include <algorithm>
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
    for (const Component* piece : wallPieces)
        pieceAxes.push_back(principalAxes(planPoints(*piece, view, heightOf(piece->group))));
    for (const Component* marker : markers) {
        markerAxes.push_back({});
        for (size_t h = 0; h < 3; ++h)
            markerAxes.back()[h] =
                principalAxes(planPoints(*marker, view, heightOf(heights[h]) + options.markerThickness));
    }
    const double straight = 1.5 * options.wallThickness / std::sqrt(12.0);
    std::vector<Link> links;
    for (size_t i = 0; i < pieces; ++i) {
        if (pieceAxes[i].minor > straight) continue; // curved: nothing can be hung on it
        const Paint paint = wallPieces[i]->group;
        const size_t h = paint == Paint::red ? 0 : paint == Paint::blue ? 1 : 2;
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
        if (paintOf[to] == Paint::none) paintOf[to] = paintOf[from];
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
