#include "compute/hierarchical.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/packing.hpp>
#include <glm/vec4.hpp>

#include "compute/gpu/device.h"
#include "compute/link_claims.h"
#include "compute/link_maker.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"
#include "compute/texel.h"
#include "spirv/hierarchical_gather_comp.h"
#include "spirv/hierarchical_moments_comp.h"
#include "spirv/hierarchical_patches_comp.h"
#include "spirv/hierarchical_spread_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kMostColumns = 4;
constexpr uint32_t kMostAgain = 2, kRounds = 8;
constexpr double kFalls = 0.9; // of an error made again: where it falls by less, so it will the next time
// One of so many pairs of roots, of so many roots at least, tells what will be claimed, to about so much; so
// does the first round of all.
constexpr uint32_t kSampledOf = 8, kSampledRoots = 100;
constexpr double kExpectedCaution = 1.5;
constexpr size_t kSortedTogether = 64; // nodes' entries, by one thread
constexpr VkFormat kUint = VK_FORMAT_R32_UINT, kUvec4 = VK_FORMAT_R32G32B32A32_UINT,
                   kVec4 = VK_FORMAT_R32G32B32A32_SFLOAT;

// Of a link over the row error asked: errors of many add up, and the finer they are, the more there are
// (measured in rooms of 672 and 2088 patches). What may be hidden costs most and errs most.
LinkTolerance toleranceFor(double asked) {
    const double hidden = std::max(asked, kLeastErrorOfLinks);
    return {0.8 * asked, 0.6 * hidden * std::pow(hidden / 5e-3, 0.6)};
}

glm::dvec3 middleOf(const PatchTree::Leaf& leaf) {
    return (leaf.corner[0] + leaf.corner[1] + leaf.corner[2]) / 3.0;
}

} // namespace

HierarchicalFormFactors::HierarchicalFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                                 const HierarchicalOptions& options)
    : device_(&device), patchCount_(static_cast<uint32_t>(mesh.patchCount())),
      // Kernels are made while the tree grows.
      scene_((LinkMaker::prepareKernels(device), ClusterScene(device, mesh))) {
    const Stopwatch watch;
    statistics_.blockers = scene_.blockerCount;
    statistics_.nodes = static_cast<uint32_t>(scene_.tree.nodes.size());
    for (size_t i = 0; i < mesh.patchCount(); ++i) patchArea_.push_back(geometry::patchArea(mesh, i));
    uploadTree();
    makeLinks(options);
    if (!gaveUp_) makeOperator();
    report_.reciprocityRms = 0;
    report_.seconds = watch.seconds();
    report_.why = fmt::format(
        "{} links between {} clusters, {:.1f} MB instead of {:.1f} MB", statistics_.links, statistics_.nodes,
        static_cast<double>(statistics_.bytes) * 1e-6, static_cast<double>(patchCount_) * patchCount_ * 4e-6);
    if (scene_.blockerCount == 0)
        report_.skipped.emplace_back("occlusion: nothing can stand between two patches");
}

void HierarchicalFormFactors::uploadTree() {
    std::vector<glm::uvec4> family;
    std::vector<glm::vec4> frames;
    std::vector<uint32_t> parents;
    for (const PatchTree::Node& node : scene_.tree.nodes) {
        const uint32_t patch = node.child == 0 ? scene_.tree.leaves[node.firstLeaf].patch : 0;
        family.push_back({node.child, patch, bitsOf(node.area), 0});
        parents.push_back(node.parent);
        if (node.parent == PatchTree::kNone) {
            frames.insert(frames.end(), 2, glm::vec4(0));
            continue;
        }
        const PatchTree::Node& parent = scene_.tree.nodes[node.parent];
        const auto centre = PatchTree::coordinates(parent, node.centre),
                   u = PatchTree::coordinates(parent, parent.centre + node.axisU),
                   v = PatchTree::coordinates(parent, parent.centre + node.axisV);
        frames.push_back(glm::vec4(glm::dvec4(centre[0], centre[1], 0, 0)));
        frames.push_back(glm::vec4(glm::dvec4(u[0], u[1], v[0], v[1])));
    }
    family_ = gpu::Buffer::from(*device_, family, "hierarchical family");
    frames_ = gpu::Buffer::from(*device_, frames, "hierarchical frames");
    parents_ = gpu::Buffer::from(*device_, parents, "hierarchical parents");
}

// As tolerances have it; finer where sums of rows may be far off, which few links cause; then, where the
// error of all is above what was asked, those again that err most, with less tolerance, as long as that
// helps.
void HierarchicalFormFactors::makeLinks(const HierarchicalOptions& options) {
    const double wanted = std::max(options.maxError, 1e-6);
    LinkMaker maker(*device_, scene_, toleranceFor(wanted));
    const uint32_t roots = scene_.tree.nodes.empty() ? 0 : scene_.tree.levelFirst[1];
    std::vector<io::HierarchicalLink> links;
    LinkClaims claims(scene_.tree, patchArea_, links);
    const auto makeAdded = [&] {
        const std::vector<io::HierarchicalLink> finer = maker.finish();
        claims.add(finer);
        links.insert(links.end(), finer.begin(), finer.end());
    };
    const auto makeAgain = [&](std::span<const glm::uvec2> pairs) {
        for (const glm::uvec2& pair : pairs) maker.add(pair.x, pair.y);
        makeAdded();
    };
    // Made again, links err by about what is wanted; what all rays miss, and luck, stay as they are.
    const auto givesUp = [&](double share) {
        const double error = claims.rowError() / std::sqrt(share);
        report_.claimedRowError = claims.claim(share) * (error > wanted ? wanted / error : 1);
        return gaveUp_ =
                   options.mostClaim > 0 && report_.claimedRowError > kExpectedCaution * options.mostClaim;
    };
    const bool samples = options.mostClaim > 0 && roots >= kSampledRoots;
    for (const bool sampled : {true, false}) {
        if (sampled && !samples) continue;
        for (uint32_t a = 0; a < roots; ++a)
            for (uint32_t b = a + 1; b < roots; ++b)
                if (!samples || ((a + b) % kSampledOf == 0) == sampled) maker.add(a, b);
        makeAdded();
        if (givesUp(sampled ? 1.0 / kSampledOf : 1)) return;
    }
    const auto refineSums = [&] {
        for (uint32_t round = 0; round < kRounds; ++round) {
            const std::vector<glm::uvec2> pairs = claims.split(links, kSumOverRow * wanted);
            if (pairs.empty()) break;
            makeAgain(pairs);
        }
    };
    refineSums();
    double asked = wanted, before = INFINITY;
    for (uint32_t again = 0; again < kMostAgain && asked > kLeastErrorOfLinks; ++again) {
        const double excess = claims.rowError() / wanted;
        if (excess <= 1.1 || excess > kFalls * before) break;
        before = excess;
        ++statistics_.again;
        asked = std::max(asked * std::pow(0.9 / excess, 1.5), std::min(asked, kLeastErrorOfLinks));
        const LinkTolerance tolerance = toleranceFor(asked);
        maker.setTolerance(tolerance);
        // What errs less the shaders would keep as it is, but for mixed pairs of clusters: those they split
        // by their form factor alone.
        makeAgain(
            claims.takeAbove(links, io::kHierarchicalKept * std::min(tolerance.open, tolerance.visible)));
        refineSums();
    }
    statistics_.pairs = maker.pairs();
    claims.takeUnseen(links);
    setErrors(claims);
    std::erase_if(links, [](const io::HierarchicalLink& link) { return link.density == 0; });
    statistics_.links = links.size();
    makeEntries(links);
}

void HierarchicalFormFactors::setErrors(const LinkClaims& claims) {
    for (double e : claims.rowClaims()) rowError_.push_back(static_cast<float>(e));
    report_.claimedRowError = claims.claim();
    for (double e : claims.rowSums()) {
        report_.claimedRowSumError = std::max(report_.claimedRowSumError, e);
        rowSumError_.push_back(static_cast<float>(e));
    }
}

// Both ends' lists, each in the order of the other end, whatever order the device found the links in.
void HierarchicalFormFactors::makeEntries(std::span<const io::HierarchicalLink> links) {
    const size_t n = scene_.tree.nodes.size();
    firstEntry_.assign(n + 1, 0);
    for (const io::HierarchicalLink& link : links)
        ++firstEntry_[link.first + 1], ++firstEntry_[link.second + 1];
    for (size_t k = 0; k < n; ++k) firstEntry_[k + 1] += firstEntry_[k];
    std::vector<glm::uvec4> entries(2 * links.size());
    std::vector<uint32_t> at(firstEntry_.begin(), firstEntry_.end());
    for (const io::HierarchicalLink& link : links) {
        const uint32_t density = std::bit_cast<uint32_t>(link.density);
        entries[at[link.first]++] = {link.second, density, link.firstSlope, link.secondSlope};
        entries[at[link.second]++] = {link.first, density, link.secondSlope, link.firstSlope};
    }
    // Links come in order, and most name the lesser node first: then lists are in order already.
    const auto byNode = [](const glm::uvec4& a, const glm::uvec4& b) { return a.x < b.x; };
    inParallel((n + kSortedTogether - 1) / kSortedTogether, [&](size_t chunk) {
        for (size_t k = chunk * kSortedTogether; k < std::min(n, (chunk + 1) * kSortedTogether); ++k) {
            const auto begin = entries.begin() + firstEntry_[k], end = entries.begin() + firstEntry_[k + 1];
            if (!std::is_sorted(begin, end, byNode)) std::sort(begin, end, byNode);
        }
    });
    statistics_.bytes = entries.size() * sizeof(glm::uvec4);
    entries_ = gpu::Buffer(*device_, statistics_.bytes, "hierarchical entries");
    entries_.upload(entries);
    // rows() reads them, from any thread.
    if (!entries_.mapped()) hostEntries_ = std::move(entries);
}

void HierarchicalFormFactors::makeOperator() {
    for (const PatchTree::Node& node : scene_.tree.nodes)
        extents_.push_back({node.centre, node.axisU / glm::dot(node.axisU, node.axisU),
                            node.axisV / glm::dot(node.axisV, node.axisV), node.firstLeaf, node.leafCount});
    for (const PatchTree::Leaf& leaf : scene_.tree.leaves)
        spots_.push_back({middleOf(leaf), leaf.area, leaf.patch});
    firstLeaf_.assign(patchCount_ + 1, 0);
    for (const PatchTree::Leaf& leaf : scene_.tree.leaves) ++firstLeaf_[leaf.patch + 1];
    for (size_t i = 0; i < patchCount_; ++i) firstLeaf_[i + 1] += firstLeaf_[i];
    std::vector<uint32_t> at(firstLeaf_.begin(), firstLeaf_.end());
    leafNodes_.resize(scene_.tree.leaves.size());
    std::vector<glm::uvec4> shares(scene_.tree.leaves.size());
    for (const PatchTree::Leaf& leaf : scene_.tree.leaves) {
        const uint32_t place = at[leaf.patch]++;
        leafNodes_[place] = leaf.node;
        shares[place] = {leaf.node, bitsOf(leaf.area / patchArea_[leaf.patch]), 0, 0};
    }
    firstEntryTexels_ = gpu::Buffer::from(*device_, firstEntry_, "hierarchical first entries");
    firstLeafTexels_ = gpu::Buffer::from(*device_, firstLeaf_, "hierarchical first leaves");
    leafNodeTexels_ = gpu::Buffer::from(*device_, shares, "hierarchical leaf nodes");
    const size_t sweep = scene_.tree.nodes.size() * kMostColumns * sizeof(glm::vec4);
    momentTexels_ = gpu::Buffer(*device_, sweep, "hierarchical moments");
    received_ = gpu::Buffer(*device_, sweep, "hierarchical received");
    const size_t columns = size_t{kMostColumns} * patchCount_ * sizeof(float);
    light_ = gpu::Buffer(*device_, columns, "hierarchical light");
    gathered_ = gpu::Buffer(*device_, columns, "hierarchical gathered", gpu::Place::host);
}

void HierarchicalFormFactors::gather(std::span<const float> in, std::span<float> out, uint32_t columns) {
    if (patchCount_ == 0 || scene_.tree.nodes.empty()) {
        std::fill(out.begin(), out.end(), 0.0f);
        return;
    }
    for (uint32_t first = 0; first < columns; first += kMostColumns) {
        const uint32_t count = std::min(kMostColumns, columns - first);
        light_.upload(in.subspan(size_t{first} * patchCount_, size_t{count} * patchCount_));
        gpu::Commands commands(*device_);
        recordMoments(commands, count);
        recordLinks(commands, count);
        recordSpread(commands, count);
        device_->submitAndWait(std::move(commands));
        std::memcpy(&out[size_t{first} * patchCount_], gathered_.mapped(),
                    size_t{count} * patchCount_ * sizeof(float));
    }
}

void HierarchicalFormFactors::sweep(gpu::Commands& commands, const gpu::Kernel& kernel,
                                    std::initializer_list<gpu::Binding> resources, Sweep over) {
    const size_t mostGroups = device_->limits().maxComputeWorkGroupCount[0];
    const size_t most = std::max<size_t>(mostGroups * io::kHierarchicalGroup / over.columns, 1);
    for (size_t from = over.begin; from < over.end; from += most) {
        const auto count = static_cast<uint32_t>(std::min<size_t>(from + most, over.end) - from);
        commands.dispatch(
            kernel, resources,
            io::HierarchicalSweepParams{static_cast<uint32_t>(from), count, over.columns, patchCount_},
            gpu::groupsFor(count * over.columns, io::kHierarchicalGroup));
    }
}

void HierarchicalFormFactors::recordMoments(gpu::Commands& commands, uint32_t columns) {
    const gpu::Kernel& moments = device_->kernels().get(hierarchical_moments_comp, "hierarchical moments");
    const auto& level = scene_.tree.levelFirst;
    for (size_t l = level.size() - 1; l-- > 0;) {
        sweep(commands, moments,
              {gpu::texel(family_, kUvec4), gpu::texel(frames_, kVec4), light_, momentTexels_},
              {level[l], level[l + 1], columns});
        commands.barrier(gpu::Stage::compute,
                         gpu::Stage::compute); // parents read the moments of their children
    }
}

void HierarchicalFormFactors::recordLinks(gpu::Commands& commands, uint32_t columns) {
    const gpu::Kernel& kernel =
        device_->kernels().get(hierarchical_gather_comp, "hierarchical gather", {{"kColumns", columns}});
    // Windows of nodes within the device's limits on texels and groups.
    const uint32_t mostEntries = device_->limits().maxTexelBufferElements;
    const uint32_t nodesPerGroup = io::kHierarchicalGroup / std::max(1u, device_->subgroupSize());
    const size_t mostNodes = size_t{device_->limits().maxComputeWorkGroupCount[0]} * nodesPerGroup;
    const auto nodes = static_cast<uint32_t>(scene_.tree.nodes.size());
    for (uint32_t begin = 0; begin < nodes;) {
        uint32_t end = begin + 1;
        const uint32_t firstEntry = firstEntry_[begin] / io::kHierarchicalAlign * io::kHierarchicalAlign;
        while (end < nodes && end - begin < mostNodes && firstEntry_[end + 1] - firstEntry <= mostEntries)
            ++end;
        const size_t offset = size_t{firstEntry} * sizeof(glm::uvec4),
                     bytes = size_t{firstEntry_[end] - firstEntry} * sizeof(glm::uvec4);
        commands.dispatch(
            kernel,
            {gpu::texel(firstEntryTexels_, kUint),
             bytes > 0 ? gpu::texel(entries_, kUvec4, offset, bytes) : gpu::texel(entries_, kUvec4),
             gpu::texel(momentTexels_, kVec4), received_},
            io::HierarchicalSweepParams{begin, end - begin, columns, patchCount_},
            gpu::groupsFor(end - begin, nodesPerGroup));
        begin = end;
    }
    commands.barrier(gpu::Stage::compute, gpu::Stage::compute); // children read what their parents received
}

void HierarchicalFormFactors::recordSpread(gpu::Commands& commands, uint32_t columns) {
    const gpu::Kernel &spread = device_->kernels().get(hierarchical_spread_comp, "hierarchical spread"),
                      &patches = device_->kernels().get(hierarchical_patches_comp, "hierarchical patches");
    const auto& level = scene_.tree.levelFirst;
    for (size_t l = 1; l + 1 < level.size(); ++l) {
        sweep(commands, spread, {gpu::texel(parents_, kUint), gpu::texel(frames_, kVec4), received_},
              {level[l], level[l + 1], columns});
        commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
    }
    sweep(commands, patches,
          {gpu::texel(firstLeafTexels_, kUint), gpu::texel(leafNodeTexels_, kUvec4), received_, gathered_},
          {0, patchCount_, columns});
}

void HierarchicalFormFactors::rows(uint32_t first, uint32_t count, std::span<float> values) const {
    const glm::uvec4* entries = entries_.mapped() ? entries_.mapped<glm::uvec4>() : hostEntries_.data();
    std::vector<double> row(patchCount_);
    for (uint32_t i = first; i < first + count; ++i) {
        std::fill(row.begin(), row.end(), 0.0);
        for (uint32_t k = firstLeaf_[i]; k < firstLeaf_[i + 1]; ++k) {
            const Spot& own = spots_[scene_.tree.nodes[leafNodes_[k]].firstLeaf];
            const double share = own.area / patchArea_[i];
            for (uint32_t p = leafNodes_[k]; p != PatchTree::kNone; p = scene_.tree.nodes[p].parent) {
                const glm::dvec3 d = own.middle - extents_[p].centre;
                const double u = glm::dot(d, extents_[p].u), v = glm::dot(d, extents_[p].v);
                for (uint32_t e = firstEntry_[p]; e < firstEntry_[p + 1]; ++e) {
                    const glm::uvec4& entry = entries[e];
                    const glm::vec2 a = entry.z ? glm::unpackHalf2x16(entry.z) : glm::vec2(0);
                    addToRow(extents_[entry.x], share * double{std::bit_cast<float>(entry.y)},
                             1 + double{a.x} * u + double{a.y} * v, entry.w, row);
                }
            }
        }
        for (uint32_t j = 0; j < patchCount_; ++j)
            values[size_t{i - first} * patchCount_ + j] = static_cast<float>(row[j]);
    }
}

void HierarchicalFormFactors::addToRow(const Extent& at, double density, double here, uint32_t slope,
                                       std::span<double> row) const {
    if (at.leafCount == 1) { // its middle is the cluster's: no slope
        const Spot& spot = spots_[at.firstLeaf];
        row[spot.patch] += density * spot.area * here;
        return;
    }
    // The slopes as a vector in the plane.
    const glm::vec2 b = glm::unpackHalf2x16(slope);
    const glm::dvec3 along = double{b.x} * at.u + double{b.y} * at.v;
    const double base = density * (here - glm::dot(along, at.centre));
    for (uint32_t l = at.firstLeaf; l < at.firstLeaf + at.leafCount; ++l) {
        const Spot& spot = spots_[l];
        row[spot.patch] += spot.area * (base + density * glm::dot(along, spot.middle));
    }
}

} // namespace heliodon::compute
