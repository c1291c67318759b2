#include "compute/straight_sky.h"

#include <algorithm>
#include <array>

#include "compute/daylight/sky_grid.h"
#include "compute/lighting.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

using daylight::SkyTables;
using Nodes = std::span<const StraightSky::Node>;
using Shares = std::span<const StraightSky::Share>;
constexpr size_t kAtOnce = StraightSky::kTables * SkyTables::kSkies; // hours

// What a node has in these hours, table by table.
struct alignas(SkyTables::Floats) Luminances {
    SkyTables::Floats of[StraightSky::kTables];
};

[[gnu::always_inline]] inline void lookUp(const SkyTables& tables, size_t table, Nodes nodes,
                                          Luminances* luminances) {
    for (size_t n = 0; n < nodes.size(); ++n) {
        SkyTables::Floats luminance{};
        tables.add(nodes[n].direction, nodes[n].heightIndex, 1, luminance);
        luminances[n].of[table] = luminance;
    }
}

[[gnu::always_inline]] inline void addShares(const Luminances* luminances, Shares shares, Luminances& sums) {
    Luminances sum{}; // in registers
    for (const StraightSky::Share& share : shares)
        for (size_t t = 0; t < StraightSky::kTables; ++t)
            sum.of[t] += share.weight * luminances[share.node].of[t];
    sums = sum;
}

struct Kernels {
    void (*lookUp)(const SkyTables&, size_t, Nodes, Luminances*);
    void (*addShares)(const Luminances*, Shares, Luminances&);
};

void lookUpNarrow(const SkyTables& tables, size_t table, Nodes nodes, Luminances* luminances) {
    lookUp(tables, table, nodes, luminances);
}

void addSharesNarrow(const Luminances* luminances, Shares shares, Luminances& sums) {
    addShares(luminances, shares, sums);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void lookUpWide(const SkyTables& tables, size_t table, Nodes nodes,
                                        Luminances* luminances) {
    lookUp(tables, table, nodes, luminances);
}

[[gnu::target("avx2")]] void addSharesWide(const Luminances* luminances, Shares shares, Luminances& sums) {
    addShares(luminances, shares, sums);
}
#endif

Kernels ofThisProcessor() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return {lookUpWide, addSharesWide};
#endif
    return {lookUpNarrow, addSharesNarrow};
}

} // namespace

StraightSky::StraightSky(const SkyView& view, std::span<const NearLight> near) {
    const daylight::SkyGrid grid;
    constexpr uint32_t kUnused = ~0U;
    std::vector<uint32_t> number(grid.nodes().size(), kUnused); // among those that count
    for (size_t s = 0; s < near.size(); ++s) {
        double ground = 0;
        std::vector<double> weights(grid.nodes().size(), 0);
        const auto take = [&](std::span<const SkySample> samples) {
            for (const SkySample& sample : samples) {
                const double weight = photometric(sample.weight);
                if (sample.direction.y > 0)
                    for (const auto& [node, part] : grid.sharesOf(glm::dvec3(sample.direction)))
                        weights[node] += weight * part;
                else
                    ground += weight;
            }
        };
        take(view.of(s));
        take(near[s].sky);
        for (size_t n = 0; n < weights.size(); ++n) {
            if (weights[n] == 0) continue;
            if (number[n] == kUnused) {
                number[n] = static_cast<uint32_t>(nodes_.size());
                const glm::vec3 direction = grid.nodes()[n];
                nodes_.push_back({direction, SkyTables::heightIndex(direction.y)});
            }
            shares_.push_back({number[n], static_cast<float>(weights[n])});
        }
        first_.push_back(shares_.size());
        ground_.push_back(static_cast<float>(ground));
    }
}

void StraightSky::addTo(std::span<float> lux, std::span<const daylight::Sky> skies,
                        std::span<const uint32_t> hours, const std::function<void(size_t)>& done) const {
    inParallel((hours.size() + kAtOnce - 1) / kAtOnce,
               [&](size_t block) {
                   const size_t first = block * kAtOnce;
                   addTogether(lux, skies, hours.subspan(first, std::min(kAtOnce, hours.size() - first)));
               },
               [&](size_t blocks) {
                   if (done) done(std::min(blocks * kAtOnce, hours.size()));
               });
}

// At most kAtOnce hours.
void StraightSky::addTogether(std::span<float> lux, std::span<const daylight::Sky> skies,
                              std::span<const uint32_t> hours) const {
    const Kernels kernels = ofThisProcessor();
    std::vector<Luminances> luminances(nodes_.size());
    for (size_t table = 0; table * SkyTables::kSkies < hours.size(); ++table) {
        const size_t first = table * SkyTables::kSkies;
        const auto some = hours.subspan(first, std::min(SkyTables::kSkies, hours.size() - first));
        std::array<const daylight::Sky*, SkyTables::kSkies> separable{};
        for (size_t k = 0; k < some.size(); ++k)
            if (!skies[some[k]].formula.intermediate) separable[k] = &skies[some[k]];
        kernels.lookUp(SkyTables(separable), table, nodes_, luminances.data());
        for (size_t k = 0; k < some.size(); ++k)
            for (size_t n = 0; n < nodes_.size() && !separable[k]; ++n)
                luminances[n].of[table][k] =
                    static_cast<float>(skies[some[k]].luminance(glm::dvec3(nodes_[n].direction)));
    }
    for (size_t s = 0; s < ground_.size(); ++s) {
        Luminances sums;
        kernels.addShares(luminances.data(), Shares(shares_).subspan(first_[s], first_[s + 1] - first_[s]),
                          sums);
        for (size_t k = 0; k < hours.size(); ++k)
            lux[s * skies.size() + hours[k]] +=
                sums.of[k / SkyTables::kSkies][k % SkyTables::kSkies] +
                ground_[s] * static_cast<float>(skies[hours[k]].ground.luminance);
    }
}

} // namespace heliodon::compute
