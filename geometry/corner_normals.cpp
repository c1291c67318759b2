#include "geometry/corner_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

constexpr double kSameTurn = 1e-4; // radians

// A corner of a curved surface.
struct Corner {
    uint32_t vertex, surface, facet, index;
    double angle;
};

class NormalFinder {
public:
    explicit NormalFinder(const PatchMesh& mesh) : mesh_(mesh) {}

    std::vector<glm::dvec3> find() {
        const size_t count = mesh_.patchCount();
        for (size_t i = 0; i < count; ++i) {
            const glm::dvec3 own = patchAreaVector(mesh_, i);
            flat_.push_back(glm::length(own) > 0 ? glm::normalize(own) : glm::dvec3(0)); // says not where to
        }
        if (!findCurved()) return {};
        findFacets();
        std::vector<glm::dvec3> out;
        for (size_t i = 0; i < count; ++i)
            out.insert(out.end(), mesh_.patch(i).size(),
                       flat_[i] != glm::dvec3(0) ? flat_[i] : glm::dvec3(0, 1, 0));
        atVertices(out);
        std::ranges::sort(corners_, {}, &Corner::facet);
        forEach([](const Corner& c) { return c.facet; },
                [&](std::span<const Corner> facet) { acrossFacet(facet, out); });
        return out;
    }

private:
    bool findCurved() {
        std::unordered_map<uint32_t, glm::dvec3> first; // normal of each surface
        for (size_t i = 0; i < flat_.size(); ++i) {
            if (flat_[i] == glm::dvec3(0)) continue;
            const auto [known, isNew] = first.try_emplace(mesh_.surface[i], flat_[i]);
            if (!isNew && !inOnePlane(known->second, flat_[i])) curved_.insert(mesh_.surface[i]);
        }
        return !curved_.empty();
    }

    void findFacets() {
        struct Edge {
            uint32_t surface, low, high, patch;
            auto operator<=>(const Edge&) const = default;
        };
        std::vector<Edge> edges;
        facets_ = DisjointSets(flat_.size());
        for (uint32_t i = 0; i < flat_.size(); ++i) {
            if (flat_[i] == glm::dvec3(0) || !curved_.contains(mesh_.surface[i])) continue;
            const auto patch = mesh_.patch(i);
            for (size_t k = 0; k < patch.size(); ++k) {
                const auto [low, high] = std::minmax({patch[k], patch[(k + 1) % patch.size()]});
                edges.push_back({mesh_.surface[i], low, high, i});
            }
        }
        std::ranges::sort(edges);
        for (size_t e = 1; e < edges.size(); ++e) {
            const Edge &a = edges[e - 1], &b = edges[e];
            if (std::tie(a.surface, a.low, a.high) == std::tie(b.surface, b.low, b.high) &&
                inOnePlane(flat_[a.patch], flat_[b.patch]))
                facets_.join(a.patch, b.patch);
        }
        for (uint32_t i = 0; i < flat_.size(); ++i) {
            if (flat_[i] == glm::dvec3(0) || !curved_.contains(mesh_.surface[i])) continue;
            const std::vector<glm::dvec3> at = patchCorners(mesh_, i);
            for (size_t k = 0, n = at.size(); k < n; ++k) {
                const glm::dvec3 u = at[(k + 1) % n] - at[k], v = at[(k + n - 1) % n] - at[k];
                corners_.push_back({mesh_.patch(i)[k], mesh_.surface[i], facets_.root(i),
                                    mesh_.firstCorner[i] + static_cast<uint32_t>(k),
                                    std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v))});
            }
        }
    }

    template<class Key, class Use> void forEach(const Key& key, const Use& use) const {
        for (size_t from = 0, to = 0; from < corners_.size(); from = to) {
            while (to < corners_.size() && key(corners_[to]) == key(corners_[from])) ++to;
            use(std::span(corners_).subspan(from, to - from));
        }
    }

    void atVertices(std::vector<glm::dvec3>& out) {
        fold_.assign(out.size(), false);
        const auto key = [](const Corner& c) { return std::pair(c.vertex, c.surface); };
        std::ranges::sort(corners_, {}, [&](const Corner& c) { return std::pair(key(c), c.index); });
        std::vector<std::pair<glm::dvec3, double>> planes; // and the angle that each takes
        forEach(key, [&](std::span<const Corner> round) {
            planes.clear();
            for (const Corner& corner : round) {
                const glm::dvec3 own = flat_[corner.facet];
                const auto known =
                    std::ranges::find_if(planes, [&](const auto& p) { return inOnePlane(p.first, own); });
                if (known == planes.end())
                    planes.emplace_back(own, corner.angle);
                else
                    known->second += corner.angle;
            }
            if (planes.size() < 2) return;
            glm::dvec3 sum(0);
            for (const auto& [normal, angle] : planes) sum += (planes.size() == 2 ? 1 : angle) * normal;
            if (!(glm::length(sum) > 1e-9)) return; // folded together
            for (const Corner& corner : round) {
                out[corner.index] = glm::normalize(sum);
                fold_[corner.index] = true;
            }
        });
    }

    void acrossFacet(std::span<const Corner> facet, std::vector<glm::dvec3>& out) const {
        const glm::dvec3 m = flat_[facet[0].facet];
        std::optional<glm::dvec3> across; // to where the first fold turns
        double low = 1e300, high = -1e300;
        struct Fold {
            double at, turn;
        };
        std::optional<Fold> folds[2];
        for (const Corner& corner : facet) {
            if (!fold_[corner.index]) continue;
            const glm::dvec3 n = out[corner.index];
            if (!across) across = glm::normalize(n - glm::dot(n, m) * m);
            const double side = glm::dot(n, *across), turn = std::atan2(side, glm::dot(n, m));
            if (glm::length(n - glm::dot(n, m) * m - side * *across) > kSameTurn) return;
            std::optional<Fold>& fold = folds[turn < 0];
            if (fold && std::abs(fold->turn - turn) > kSameTurn) return;
            if (!fold) fold = {glm::dot(mesh_.vertices[corner.vertex], *across), turn};
        }
        if (!across) return;
        for (const Corner& corner : facet) {
            const double at = glm::dot(mesh_.vertices[corner.vertex], *across);
            low = std::min(low, at), high = std::max(high, at);
        }
        const Fold one = *folds[0], other = folds[1].value_or(Fold{(low + high) / 2, 0});
        if (!(std::abs(one.at - other.at) > 0.1 * (high - low))) return; // not from one side to the other
        for (const Corner& corner : facet) {
            if (fold_[corner.index]) continue;
            const double at = glm::dot(mesh_.vertices[corner.vertex], *across),
                         turn = other.turn + (one.turn - other.turn) * (at - other.at) / (one.at - other.at);
            out[corner.index] = std::cos(turn) * m + std::sin(turn) * *across;
        }
    }

    const PatchMesh& mesh_;
    std::vector<glm::dvec3> flat_;        // normal of each patch, 0 of those without area
    std::unordered_set<uint32_t> curved_; // surfaces
    DisjointSets facets_;                 // of patches
    std::vector<Corner> corners_;         // of curved surfaces
    std::vector<bool> fold_;              // per corner of the mesh: facets meet there
};

} // namespace

std::vector<glm::dvec3> cornerNormals(const PatchMesh& mesh) {
    return NormalFinder(mesh).find();
}

} // namespace heliodon::geometry
