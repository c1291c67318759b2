#include "compute/straight_sky.h"

#include <algorithm>
#include <array>

#include "compute/lighting.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

using daylight::SkyTables;
using Nodes = std::span<const StraightSky::Node>;
using Shares = std::span<const StraightSky::Share>;
constexpr size_t kAtOnce = StraightSky::kTables * SkyTables::kSkies; // hours

// What a node has in these hours, table by table.
struct alignas(SkyTables) Luminances {
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

// Of at most kAtOnce hours.
class SkiesTogether {
public:
    SkiesTogether(std::span<const daylight::Sky> skies, std::span<const uint32_t> hours) {
        for (const uint32_t hour : hours) skies_.push_back(&skies[hour]);
        for (size_t first = 0; first < skies_.size(); first += SkyTables::kSkies) {
            std::array<const daylight::Sky*, SkyTables::kSkies> separable{};
            for (size_t k = 0; k < std::min(SkyTables::kSkies, skies_.size() - first); ++k)
                if (!skies_[first + k]->formula.intermediate) separable[k] = skies_[first + k];
            tables_.emplace_back(separable);
        }
    }

    void lookUp(Nodes nodes, std::vector<Luminances>& luminances) const {
        luminances.assign(nodes.size(), {});
        for (size_t table = 0; table < tables_.size(); ++table)
            kernels_.lookUp(tables_[table], table, nodes, luminances.data());
        for (size_t k = 0; k < skies_.size(); ++k) {
            if (!skies_[k]->formula.intermediate) continue;
            for (size_t n = 0; n < nodes.size(); ++n)
                luminances[n].of[k / SkyTables::kSkies][k % SkyTables::kSkies] =
                    static_cast<float>(skies_[k]->luminance(glm::dvec3(nodes[n].direction)));
        }
    }

    // Adds a sensor's lux to `row`, one of each sky in order of `hours`.
    void add(const std::vector<Luminances>& luminances, Shares shares, float ground, float* row,
             std::span<const uint32_t> hours) const {
        Luminances sums;
        kernels_.addShares(luminances.data(), shares, sums);
        for (size_t k = 0; k < hours.size(); ++k)
            row[hours[k]] += sums.of[k / SkyTables::kSkies][k % SkyTables::kSkies] +
                             ground * static_cast<float>(skies_[k]->ground.luminance);
    }

private:
    Kernels kernels_ = ofThisProcessor();
    std::vector<const daylight::Sky*> skies_;
    std::vector<SkyTables> tables_;
};

StraightSky::Node nodeAt(glm::vec3 direction) {
    return {direction, SkyTables::heightIndex(direction.y)};
}

} // namespace

StraightSky::StraightSky(const SkyView& view, std::span<const NearLight> near) : view_(&view), near_(near) {
    constexpr uint32_t kUnused = ~0U;
    std::vector<uint32_t> number(grid_.nodes().size(), kUnused); // among those that count
    for (size_t s = 0; s < near.size(); ++s) {
        double ground = 0;
        std::vector<double> weights(grid_.nodes().size(), 0);
        for (const std::span<const SkySample> samples : samplesOf(s))
            for (const SkySample& sample : samples) {
                const double weight = photometric(sample.weight);
                if (sample.direction.y > 0)
                    for (const auto& [node, part] : grid_.sharesOf(glm::dvec3(sample.direction)))
                        weights[node] += weight * part;
                else
                    ground += weight;
            }
        for (size_t n = 0; n < weights.size(); ++n) {
            if (weights[n] == 0) continue;
            if (number[n] == kUnused) {
                number[n] = static_cast<uint32_t>(nodes_.size());
                nodes_.push_back(nodeAt(grid_.nodes()[n]));
            }
            shares_.push_back({number[n], static_cast<float>(weights[n])});
        }
        first_.push_back(shares_.size());
        ground_.push_back(static_cast<float>(ground));
    }
}

void StraightSky::addTo(std::span<float> lux, std::span<const daylight::Sky> skies,
                        std::span<const uint32_t> hours, const std::function<void(size_t)>& done) const {
    std::vector<char> isSmooth(hours.size());
    inParallel(hours.size(), [&](size_t k) { isSmooth[k] = grid_.isSmoothWithHeight(skies[hours[k]]); });
    std::vector<uint32_t> smooth, steep;
    for (size_t k = 0; k < hours.size(); ++k) (isSmooth[k] ? smooth : steep).push_back(hours[k]);
    const auto inBlocks = [&](std::span<const uint32_t> some, size_t before, auto add) {
        inParallel((some.size() + kAtOnce - 1) / kAtOnce,
                   [&](size_t block) {
                       const size_t first = block * kAtOnce;
                       (this->*add)(lux, skies, some.subspan(first, std::min(kAtOnce, some.size() - first)));
                   },
                   [&](size_t blocks) {
                       if (done) done(before + std::min(blocks * kAtOnce, some.size()));
                   });
    };
    inBlocks(smooth, 0, &StraightSky::addByNodes);
    inBlocks(steep, smooth.size(), &StraightSky::addBySamples);
}

void StraightSky::addByNodes(std::span<float> lux, std::span<const daylight::Sky> skies,
                             std::span<const uint32_t> hours) const {
    const SkiesTogether together(skies, hours);
    std::vector<Luminances> luminances;
    together.lookUp(nodes_, luminances);
    for (size_t s = 0; s < ground_.size(); ++s)
        together.add(luminances, Shares(shares_).subspan(first_[s], first_[s + 1] - first_[s]), ground_[s],
                     &lux[s * skies.size()], hours);
}

void StraightSky::addBySamples(std::span<float> lux, std::span<const daylight::Sky> skies,
                               std::span<const uint32_t> hours) const {
    const SkiesTogether together(skies, hours);
    std::vector<Luminances> luminances;
    std::vector<Node> places;
    std::vector<Share> shares;
    for (size_t s = 0; s < ground_.size(); ++s) {
        places.clear(), shares.clear();
        for (const std::span<const SkySample> samples : samplesOf(s))
            for (const SkySample& sample : samples) {
                if (!(sample.direction.y > 0)) continue;
                shares.push_back(
                    {static_cast<uint32_t>(places.size()), static_cast<float>(photometric(sample.weight))});
                places.push_back(nodeAt(sample.direction));
            }
        together.lookUp(places, luminances);
        together.add(luminances, shares, ground_[s], &lux[s * skies.size()], hours);
    }
}

} // namespace heliodon::compute
