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
        const auto eachFacet = [&](const auto& use) {
            forEach([](const Corner& c) { return c.facet; }, use);
        };
        eachFacet([&](std::span<const Corner> facet) {
            if (const auto strip = stripOf(facet, out)) strips_.emplace(facet[0].facet, *strip);
        });
        for (auto& [facet, strip] : strips_) shareTurns(facet, strip);
        for (auto& [facet, strip] : strips_) turnOn(facet, strip);
        eachFacet([&](std::span<const Corner> facet) { acrossFacet(facet, out); });
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
        beyond_.assign(out.size(), kNone);
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
                uint32_t& beyond = beyond_[corner.index];
                for (const Corner& other : round)
                    if (other.facet != corner.facet)
                        beyond = beyond == kNone || beyond == other.facet ? other.facet : kMany;
            }
        });
    }

    struct Fold {
        double at, turn;
        uint32_t beyond; // the facet there; kMany: not known
    };
    // A facet whose folds are parallel: the first, to which its normal turns to `across`, and one opposite.
    struct Strip {
        glm::dvec3 across;
        double low = 1e300, high = -1e300;
        std::optional<Fold> folds[2];
        bool moved[2] = {}; // folds whose turn is no longer half of that between the facets

        double middle() const { return (low + high) / 2; }
        double width() const { return high - low; }
    };

    std::optional<Strip> stripOf(std::span<const Corner> facet, const std::vector<glm::dvec3>& out) const {
        const glm::dvec3 m = flat_[facet[0].facet];
        std::optional<Strip> strip;
        for (const Corner& corner : facet) {
            if (!fold_[corner.index]) continue;
            const glm::dvec3 n = out[corner.index];
            if (!strip) strip = {.across = glm::normalize(n - glm::dot(n, m) * m)};
            const double side = glm::dot(n, strip->across), turn = std::atan2(side, glm::dot(n, m));
            if (glm::length(n - glm::dot(n, m) * m - side * strip->across) > kSameTurn) return std::nullopt;
            std::optional<Fold>& fold = strip->folds[turn < 0];
            if (fold && std::abs(fold->turn - turn) > kSameTurn) return std::nullopt;
            const uint32_t beyond = beyond_[corner.index];
            if (!fold)
                fold = {glm::dot(mesh_.vertices[corner.vertex], strip->across), turn, beyond};
            else if (fold->beyond != beyond)
                fold->beyond = kMany;
        }
        if (!strip) return strip;
        for (const Corner& corner : facet) {
            const double at = glm::dot(mesh_.vertices[corner.vertex], strip->across);
            strip->low = std::min(strip->low, at), strip->high = std::max(strip->high, at);
        }
        return strip;
    }

    // The strip beyond a fold of another one, and which of its folds that is.
    std::pair<Strip*, size_t> beyond(uint32_t facet, const Fold& fold) {
        const auto found = strips_.find(fold.beyond);
        if (found == strips_.end()) return {nullptr, 0};
        const auto& folds = found->second.folds;
        const auto leadsBack = [&](size_t k) { return folds[k] && folds[k]->beyond == facet; };
        if (leadsBack(0) == leadsBack(1)) return {nullptr, 0};
        return {&found->second, leadsBack(0) ? 0 : 1};
    }

    // Facets of an arc turn by as much as they are wide.
    void shareTurns(uint32_t facet, Strip& strip) {
        constexpr double kAlike = 2, kSameWidth = 1e-6;
        for (size_t k = 0; k < 2; ++k) {
            if (!strip.folds[k]) continue;
            const auto [other, back] = beyond(facet, *strip.folds[k]);
            if (!other || facet > strip.folds[k]->beyond) continue;
            const double own = strip.width(), its = other->width();
            if (own > kAlike * its || its > kAlike * own || std::abs(own - its) < kSameWidth * own) continue;
            const double both = 2 / (own + its);
            strip.folds[k]->turn *= own * both;
            other->folds[back]->turn *= its * both;
            strip.moved[k] = other->moved[back] = true;
        }
    }

    // The last facet ends where something else meets the arc, often beside the circle of its folds: where the
    // one before can tell, normals go on turning as they do there.
    void turnOn(uint32_t facet, Strip& strip) {
        constexpr double kTilted = 0.6; // of its turn: a facet farther off the arc is not of it
        if (strip.folds[1]) return;
        Fold& fold = *strip.folds[0];
        const auto [before, back] = beyond(facet, fold);
        if (!before || !before->folds[1 - back]) return;
        const Fold& last = *before->folds[1 - back];
        const auto next = strips_.find(last.beyond);
        if (next == strips_.end() || !next->second.folds[1] || next->second.folds[1]->beyond == kNone) return;
        Fold& shared = before->folds[back].value();
        const double rate = std::abs(last.turn / (last.at - before->middle())),
                     its = rate * std::abs(shared.at - before->middle()),
                     own = fold.turn + std::abs(shared.turn) - its, end = own - rate * strip.width();
        if (!(std::abs(own + end) < kTilted * (own - end))) return;
        strip.folds[1] = Fold{fold.at < strip.middle() ? strip.high : strip.low, end, kNone};
        fold.turn = own;
        shared.turn = std::copysign(its, shared.turn);
        strip.moved[0] = before->moved[back] = true;
    }

    void acrossFacet(std::span<const Corner> facet, std::vector<glm::dvec3>& out) {
        const uint32_t number = facet[0].facet;
        const auto found = strips_.find(number);
        if (found == strips_.end()) return;
        const Strip& strip = found->second;
        const auto normal = [&](uint32_t of, const Strip& on, double turn) {
            return std::cos(turn) * flat_[of] + std::sin(turn) * on.across;
        };
        const Fold one = *strip.folds[0], other = strip.folds[1].value_or(Fold{strip.middle(), 0, kNone});
        const bool fromSideToSide = std::abs(one.at - other.at) > 0.1 * strip.width();
        for (const Corner& corner : facet) {
            glm::dvec3& n = out[corner.index];
            if (fold_[corner.index]) {
                const size_t k = glm::dot(n, strip.across) < 0;
                if (!strip.moved[k]) continue;
                const Fold& fold = *strip.folds[k];
                const auto [its, back] = beyond(number, fold); // one normal for both
                n = number < fold.beyond ? normal(number, strip, fold.turn)
                                         : normal(fold.beyond, *its, its->folds[back]->turn);
            } else if (fromSideToSide) {
                const double at = glm::dot(mesh_.vertices[corner.vertex], strip.across);
                n = normal(number, strip,
                           other.turn + (one.turn - other.turn) * (at - other.at) / (one.at - other.at));
            }
        }
    }

    static constexpr uint32_t kNone = 0xffffffff, kMany = 0xfffffffe;

    const PatchMesh& mesh_;
    std::vector<glm::dvec3> flat_;        // normal of each patch, 0 of those without area
    std::unordered_set<uint32_t> curved_; // surfaces
    DisjointSets facets_;                 // of patches
    std::vector<Corner> corners_;         // of curved surfaces
    std::vector<bool> fold_;              // per corner of the mesh: facets meet there
    std::vector<uint32_t> beyond_;        // per corner of the mesh: the one other facet there; kNone, kMany
    std::unordered_map<uint32_t, Strip> strips_; // by facet
};

} // namespace

std::vector<glm::dvec3> cornerNormals(const PatchMesh& mesh) {
    return NormalFinder(mesh).find();
}

} // namespace heliodon::geometry
