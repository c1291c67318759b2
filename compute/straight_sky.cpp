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
constexpr size_t kAtOnce = StraightHours::kTables * SkyTables::kSkies; // hours

// What a node has in these hours, table by table.
struct alignas(SkyTables) Luminances {
    SkyTables::Floats of[StraightHours::kTables];
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
        for (size_t t = 0; t < StraightHours::kTables; ++t)
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

Kernels kernelsOf([[maybe_unused]] VectorWidth width) {
#if defined(__x86_64__)
    if (width >= VectorWidth::avx2) return {lookUpWide, addSharesWide};
#endif
    return {lookUpNarrow, addSharesNarrow};
}

class SkiesTogether {
public:
    SkiesTogether(std::span<const daylight::Sky> skies, const StraightHours::Block& block, VectorWidth width)
        : kernels_(kernelsOf(width)), block_(block) {
        for (const uint32_t hour : block.hours) skies_.push_back(&skies[hour]);
    }

    void lookUp(Nodes nodes, std::vector<Luminances>& luminances) const {
        luminances.assign(nodes.size(), {});
        for (size_t table = 0; table < block_.tables.size(); ++table)
            kernels_.lookUp(block_.tables[table], table, nodes, luminances.data());
        for (size_t k = 0; k < skies_.size(); ++k) {
            if (!skies_[k]->formula.intermediate) continue;
            for (size_t n = 0; n < nodes.size(); ++n)
                luminances[n].of[k / SkyTables::kSkies][k % SkyTables::kSkies] =
                    static_cast<float>(skies_[k]->luminance(glm::dvec3(nodes[n].direction)));
        }
    }

    // Adds a sensor's lux to its `row` of all hours.
    void add(const std::vector<Luminances>& luminances, Shares shares, float ground, float* row) const {
        Luminances sums;
        kernels_.addShares(luminances.data(), shares, sums);
        for (size_t k = 0; k < skies_.size(); ++k)
            row[block_.hours[k]] += sums.of[k / SkyTables::kSkies][k % SkyTables::kSkies] +
                                    ground * static_cast<float>(skies_[k]->ground.luminance);
    }

private:
    Kernels kernels_;
    const StraightHours::Block& block_;
    std::vector<const daylight::Sky*> skies_;
};

StraightSky::Node nodeAt(glm::vec3 direction) {
    return {direction, SkyTables::heightIndex(direction.y)};
}

} // namespace

StraightHours::StraightHours(std::span<const daylight::Sky> skies, std::vector<uint32_t> hours,
                             size_t tableBytes)
    : skies_(skies), hours_(std::move(hours)) {
    std::vector<char> isSmooth(skies.size());
    inParallel(hours_.size(),
               [&](size_t k) { isSmooth[hours_[k]] = grid_.isSmoothWithHeight(skies[hours_[k]]); });
    const auto steep =
        std::ranges::stable_partition(hours_, [&](uint32_t hour) { return isSmooth[hour] != 0; });
    const std::span<const uint32_t> all(hours_);
    const size_t smooth = hours_.size() - steep.size();
    for (const bool bySamples : {false, true}) {
        const std::span<const uint32_t> some = bySamples ? all.subspan(smooth) : all.first(smooth);
        for (size_t first = 0; first < some.size(); first += kAtOnce)
            blocks_.push_back({some.subspan(first, std::min(kAtOnce, some.size() - first)), bySamples, {}});
    }
    inParallel(std::min(blocks_.size(), tableBytes / (kTables * sizeof(SkyTables))),
               [&](size_t block) { blocks_[block].tables = tablesOf(blocks_[block].hours); });
}

std::vector<SkyTables> StraightHours::tablesOf(std::span<const uint32_t> hours) const {
    std::vector<SkyTables> tables;
    for (size_t first = 0; first < hours.size(); first += SkyTables::kSkies) {
        std::array<const daylight::Sky*, SkyTables::kSkies> separable{};
        for (size_t k = 0; k < std::min(SkyTables::kSkies, hours.size() - first); ++k)
            if (const daylight::Sky& sky = skies_[hours[first + k]]; !sky.formula.intermediate)
                separable[k] = &sky;
        tables.emplace_back(separable);
    }
    return tables;
}

void StraightHours::withBlock(size_t block, const std::function<void(const Block&)>& work) const {
    const Block& kept = blocks_[block];
    if (!kept.tables.empty()) return work(kept);
    work({kept.hours, kept.bySamples, tablesOf(kept.hours)});
}

size_t StraightHours::bytes() const {
    size_t sum = hours_.size() * sizeof(uint32_t) + blocks_.size() * sizeof(Block);
    for (const Block& block : blocks_) sum += block.tables.size() * sizeof(SkyTables);
    return sum;
}

StraightSky::StraightSky(const StraightHours& hours, const SkyView& view, std::span<const NearLight> near)
    : hours_(&hours), view_(&view), near_(near) {
    constexpr uint32_t kUnused = ~0U;
    const daylight::SkyGrid& grid = hours.grid();
    std::vector<uint32_t> number(grid.nodes().size(), kUnused); // among those that count
    for (size_t s = 0; s < near.size(); ++s) {
        double ground = 0;
        std::vector<double> weights(grid.nodes().size(), 0);
        for (const std::span<const SkySample> samples : samplesOf(s))
            for (const SkySample& sample : samples) {
                const double weight = photometric(sample.weight);
                if (sample.direction.y > 0)
                    for (const auto& [node, part] : grid.sharesOf(glm::dvec3(sample.direction)))
                        weights[node] += weight * part;
                else
                    ground += weight;
            }
        for (size_t n = 0; n < weights.size(); ++n) {
            if (weights[n] == 0) continue;
            if (number[n] == kUnused) {
                number[n] = static_cast<uint32_t>(nodes_.size());
                nodes_.push_back(nodeAt(grid.nodes()[n]));
            }
            shares_.push_back({number[n], static_cast<float>(weights[n])});
        }
        first_.push_back(shares_.size());
        ground_.push_back(static_cast<float>(ground));
    }
}

void StraightSky::addTo(std::span<float> lux, const std::function<void(size_t)>& done,
                        VectorWidth width) const {
    inParallel(
        hours_->blocks(),
        [&](size_t block) {
            hours_->withBlock(block, [&](const StraightHours::Block& hours) {
                if (hours.bySamples)
                    addBySamples(lux, hours, width);
                else
                    addByNodes(lux, hours, width);
            });
        },
        [&](size_t blocks) {
            if (done) done(std::min(blocks * kAtOnce, hours_->count()));
        });
}

void StraightSky::addByNodes(std::span<float> lux, const StraightHours::Block& block,
                             VectorWidth width) const {
    const std::span<const daylight::Sky> skies = hours_->skies();
    const SkiesTogether together(skies, block, width);
    std::vector<Luminances> luminances;
    together.lookUp(nodes_, luminances);
    for (size_t s = 0; s < ground_.size(); ++s)
        together.add(luminances, Shares(shares_).subspan(first_[s], first_[s + 1] - first_[s]), ground_[s],
                     &lux[s * skies.size()]);
}

void StraightSky::addBySamples(std::span<float> lux, const StraightHours::Block& block,
                               VectorWidth width) const {
    const std::span<const daylight::Sky> skies = hours_->skies();
    const SkiesTogether together(skies, block, width);
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
        together.add(luminances, shares, ground_[s], &lux[s * skies.size()]);
    }
}

} // namespace heliodon::compute
