#include "geometry/decks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/floors.h"

namespace heliodon::geometry {

namespace {

constexpr double kTouch = 0.05; // building metres apart, at most

std::vector<size_t> fromLowest(const PatchMesh& mesh, std::vector<size_t> patches) {
    std::ranges::stable_sort(patches, {}, [&](size_t i) { return boundsOf(patchCorners(mesh, i)).low.y; });
    return patches;
}

std::vector<Bounds> boxesOf(const PatchMesh& mesh, const std::vector<size_t>& patches) {
    std::vector<Bounds> boxes;
    for (const size_t i : patches) boxes.push_back(boundsOf(patchCorners(mesh, i)));
    return boxes;
}

} // namespace

double Level::width() const {
    const double half = perimeter / 2;
    return 0.5 * (half - std::sqrt(std::max(0.0, half * half - 4 * area)));
}

std::vector<Level> levelsOf(const PatchMesh& mesh, const std::vector<size_t>& patches) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges; // of one patch only
    DisjointSets joined(patches.size());
    for (uint32_t k = 0; k < patches.size(); ++k) {
        const auto corner = mesh.patch(patches[k]);
        for (size_t c = 0; c < corner.size(); ++c) {
            const auto [other, isNew] =
                edges.insert({std::minmax(corner[c], corner[(c + 1) % corner.size()]), k});
            if (isNew) continue;
            joined.join(k, other->second);
            edges.erase(other);
        }
    }
    std::map<uint32_t, Level> levels;
    for (uint32_t k = 0; k < patches.size(); ++k) {
        Level& level = levels[joined.root(k)];
        level.patches.push_back(patches[k]);
        const Bounds box = boundsOf(patchCorners(mesh, patches[k]));
        level.box = level.patches.size() == 1 ? box : united(level.box, box);
        level.low = level.box.low.y, level.high = level.box.high.y;
        level.area += patchArea(mesh, patches[k]);
    }
    for (const auto& [edge, k] : edges) {
        Level& level = levels[joined.root(k)];
        level.border.push_back(edge);
        level.perimeter += glm::distance(mesh.vertices[edge.first], mesh.vertices[edge.second]);
    }
    std::vector<Level> sorted;
    for (auto& [root, level] : levels) sorted.push_back(std::move(level));
    std::ranges::stable_sort(sorted, {}, &Level::low);
    return sorted;
}

const Level& Deck::largest() const {
    return *std::ranges::max_element(levels, {}, &Level::area);
}

std::vector<size_t> Deck::patches() const {
    std::vector<size_t> all;
    for (const Level& level : levels) all.insert(all.end(), level.patches.begin(), level.patches.end());
    return all;
}

Decks::Decks(const PatchMesh& mesh, std::vector<size_t> patches, double scale)
    : mesh_(mesh), scale_(scale), patches_(fromLowest(mesh, std::move(patches))),
      boxes_(boxesOf(mesh, patches_)), tree_(boxes_) {
    std::vector<Level> levels = levelsOf(mesh, patches_);
    std::map<size_t, uint32_t> levelOf;
    for (uint32_t l = 0; l < levels.size(); ++l)
        for (const size_t i : levels[l].patches) levelOf[i] = l;
    std::vector<uint32_t> level;
    for (const size_t i : patches_) level.push_back(levelOf[i]);
    DisjointSets joined(levels.size());
    for (size_t k = 0; k < patches_.size() && levels.size() > 1; ++k)
        forNear(k, kFloorStep * scale_, [&](size_t other, double rise) {
            if (std::abs(rise) <= kFloorStep * scale_) joined.join(level[k], level[other]);
        });
    std::map<uint32_t, uint32_t> deckOf; // by root
    for (uint32_t l = 0; l < levels.size(); ++l) {
        const auto [place, isNew] = deckOf.insert({joined.root(l), static_cast<uint32_t>(decks_.size())});
        if (isNew) decks_.emplace_back();
        Deck& deck = decks_[place->second];
        deck.area += levels[l].area;
        deck.width = std::max(deck.width, levels[l].width());
        deck.levels.push_back(std::move(levels[l]));
    }
    for (const uint32_t l : level) deck_.push_back(deckOf[joined.root(l)]);
}

// Seen from above: no line along an edge of either has one on each side and a gap between them.
bool Decks::areNear(size_t k, size_t other) const {
    for (const size_t one : {k, other}) {
        const auto corner = mesh_.patch(patches_[one]);
        for (size_t c = 0; c < corner.size(); ++c) {
            const glm::dvec3 along =
                mesh_.vertices[corner[(c + 1) % corner.size()]] - mesh_.vertices[corner[c]];
            const glm::dvec3 across(-along.z, 0, along.x);
            double low[2], high[2];
            for (const bool second : {false, true}) {
                low[second] = std::numeric_limits<double>::infinity(), high[second] = -low[second];
                for (const uint32_t v : mesh_.patch(patches_[second ? other : k])) {
                    const double at = glm::dot(across, mesh_.vertices[v]);
                    low[second] = std::min(low[second], at), high[second] = std::max(high[second], at);
                }
            }
            if (std::max(low[0] - high[1], low[1] - high[0]) > kTouch * scale_ * glm::length(across))
                return false;
        }
    }
    return true;
}

// Of a patch's plane, within its own heights.
double Decks::heightNear(size_t k, double x, double z) const {
    const glm::dvec3 p = mesh_.vertices[mesh_.patch(patches_[k])[0]], n = patchNormal(mesh_, patches_[k]);
    return std::clamp(p.y - (n.x * (x - p.x) + n.z * (z - p.z)) / n.y, boxes_[k].low.y, boxes_[k].high.y);
}

// Asks of patches beside a patch, no farther below it than `depth` and no more than a step above, with how
// much lower they are where the two are next to one another.
template<class Ask> void Decks::forNear(size_t k, double depth, const Ask& ask) const {
    const double touch = kTouch * scale_;
    const Bounds& box = boxes_[k];
    tree_.anyHolding(box.high + glm::dvec3(touch, kFloorStep * scale_, touch),
                     box.low - glm::dvec3(touch, depth, touch), [&](uint32_t other) {
                         if (!areNear(k, other)) return false;
                         const Bounds& o = boxes_[other];
                         const glm::dvec3 at = 0.5 * (glm::max(box.low, o.low) + glm::min(box.high, o.high));
                         ask(other, heightNear(k, at.x, at.z) - heightNear(other, at.x, at.z));
                         return false;
                     });
}

Decks::Rise Decks::riseOf(const Deck& deck, const std::function<bool(const Deck&)>& counts) {
    Rise best;
    for (size_t k = 0; k < patches_.size(); ++k) {
        if (&of(k) != &deck) continue;
        forNear(k, std::numeric_limits<double>::infinity(), [&](size_t other, double rise) {
            Deck& from = decks_[deck_[other]];
            if (rise > 0 && rise < best.height && &from != &deck && counts(from)) best = {rise, &from};
        });
    }
    return best;
}

} // namespace heliodon::geometry
