#include "compute/hierarchical.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/packing.hpp>
#include <glm/vec4.hpp>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/stopwatch.h"
#include "compute/texel.h"
#include "spirv/hierarchical_gather_comp.h"
#include "spirv/hierarchical_links_comp.h"
#include "spirv/hierarchical_moments_comp.h"
#include "spirv/hierarchical_patches_comp.h"
#include "spirv/hierarchical_spread_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kBatch = 1u << 16; // pairs of one dispatch
constexpr uint32_t kMostColumns = 4;
// Tolerance of a link over the row error asked: errors of many add up (measured in rooms of 672 and 2088
// patches).
constexpr double kShare = 0.45;
constexpr double kLeastHidden = 5e-4; // row error that samples of visibility reach in useful time
constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT, kVec4 = VK_FORMAT_R32G32B32A32_SFLOAT;

glm::dvec3 middleOf(const PatchTree::Leaf& leaf) {
    return (leaf.corner[0] + leaf.corner[1] + leaf.corner[2]) / 3.0;
}

} // namespace

struct HierarchicalFormFactors::Work {
    io::HierarchicalLinksParams params{};
    uint32_t root = 0, partner = 1; // the next pair of roots
    std::vector<glm::uvec2> pending, leafPairs;
    std::vector<io::HierarchicalLink> links;
    gpu::Buffer pairs, counters, next, nextLeaves, newLinks;

    template<class T> static void append(std::vector<T>& to, const gpu::Buffer& from, uint32_t count) {
        if (count == 0) return;
        const size_t at = to.size();
        to.resize(at + count);
        if (const T* mapped = from.mapped<T>())
            std::memcpy(to.data() + at, mapped, count * sizeof(T));
        else {
            const std::vector<T> values = from.download<T>(count);
            std::copy(values.begin(), values.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
        }
    }
};

HierarchicalFormFactors::HierarchicalFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                                 const HierarchicalOptions& options)
    : device_(&device), patchCount_(static_cast<uint32_t>(mesh.patchCount())), scene_(device, mesh),
      links_(device, hierarchical_links_comp, "hierarchical links"),
      moments_(device, hierarchical_moments_comp, "hierarchical moments"),
      spread_(device, hierarchical_spread_comp, "hierarchical spread"),
      patches_(device, hierarchical_patches_comp, "hierarchical patches") {
    const Stopwatch watch;
    statistics_.blockers = scene_.blockerCount;
    statistics_.nodes = static_cast<uint32_t>(scene_.tree.nodes.size());
    for (size_t i = 0; i < mesh.patchCount(); ++i) patchArea_.push_back(geometry::patchArea(mesh, i));
    uploadTree();
    makeLinks(options);
    makeOperator();
    report_.kernel = "hierarchical";
    report_.claimedRowError =
        scene_.blockerCount > 0 ? std::max(options.maxError, kLeastHidden) : options.maxError;
    report_.seconds = watch.seconds();
    report_.why = fmt::format(
        "{} links between {} clusters, {:.1f} MB instead of {:.1f} MB", statistics_.links, statistics_.nodes,
        static_cast<double>(statistics_.bytes) * 1e-6, static_cast<double>(patchCount_) * patchCount_ * 4e-6);
    if (scene_.blockerCount == 0)
        report_.skipped.push_back("occlusion: nothing can stand between two patches");
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

void HierarchicalFormFactors::makeLinks(const HierarchicalOptions& options) {
    Work work;
    const double tolerance = kShare * std::max(options.maxError, 1e-6);
    work.params.nodeCount = scene_.blockers.nodeCount;
    work.params.flatness = static_cast<float>(5e-7 * scene_.blockers.diagonal);
    work.params.tolerance = static_cast<float>(tolerance);
    const double visibility = std::max(tolerance, kShare * kLeastHidden);
    work.params.visibilityTolerance = static_cast<float>(visibility);
    work.pairs = gpu::Buffer(*device_, kBatch * sizeof(glm::uvec2), "hierarchical pairs");
    work.counters = gpu::Buffer(*device_, io::kHierarchicalCounters * sizeof(uint32_t),
                                "hierarchical counters", gpu::Place::host);
    work.next = gpu::Buffer(*device_, 4 * kBatch * sizeof(glm::uvec2), "hierarchical next", gpu::Place::host);
    work.nextLeaves =
        gpu::Buffer(*device_, 4 * kBatch * sizeof(glm::uvec2), "hierarchical leaf pairs", gpu::Place::host);
    work.newLinks = gpu::Buffer(*device_, kBatch * sizeof(io::HierarchicalLink), "hierarchical new links",
                                gpu::Place::host);
    LeafExchanges exchanges(*device_, scene_);
    const auto takeLeaves = [&] {
        const size_t before = work.links.size();
        exchanges.run(work.leafPairs, visibility, work.links);
        statistics_.leafLinks += work.links.size() - before;
        work.leafPairs.clear();
    };
    const uint32_t roots = scene_.tree.nodes.empty() ? 0 : scene_.tree.levelFirst[1];
    for (;;) {
        while (work.pending.size() < kBatch && work.root + 1 < roots) {
            const bool leaves =
                scene_.tree.nodes[work.root].child == 0 && scene_.tree.nodes[work.partner].child == 0;
            (leaves ? work.leafPairs : work.pending).push_back({work.root, work.partner});
            if (++work.partner == roots) work.partner = ++work.root + 1;
        }
        if (work.pending.empty()) break;
        runNodes(work, static_cast<uint32_t>(std::min<size_t>(work.pending.size(), kBatch)));
        if (work.leafPairs.size() >= kBatch) takeLeaves();
    }
    takeLeaves();
    statistics_.links = work.links.size();
    makeEntries(std::move(work.links));
}

void HierarchicalFormFactors::runNodes(Work& work, uint32_t count) {
    work.pairs.upload(std::span<const glm::uvec2>(work.pending).last(count));
    work.pending.resize(work.pending.size() - count);
    work.params.pairCount = count;
    statistics_.pairs += count;
    gpu::Commands commands(*device_);
    commands.fill(work.counters, 0);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    commands.dispatch(links_,
                      {gpu::texel(scene_.nodes, kUvec4), gpu::texel(scene_.leaves, kUvec4),
                       gpu::texel(scene_.blockers.nodes, kUvec4),
                       gpu::texel(scene_.blockers.triangles, kUvec4), work.pairs, work.counters, work.next,
                       work.nextLeaves, work.newLinks},
                      work.params, gpu::groupsFor(count, io::kHierarchicalGroup));
    commands.barrier(gpu::Stage::compute, gpu::Stage::host);
    device_->submitAndWait(std::move(commands));
    const auto* counters = work.counters.mapped<uint32_t>();
    Work::append(work.pending, work.next, counters[io::kHierarchicalPairs]);
    Work::append(work.leafPairs, work.nextLeaves, counters[io::kHierarchicalLeaves]);
    Work::append(work.links, work.newLinks, counters[io::kHierarchicalLinks]);
}

// Both ends' lists, each in the order of the other end, whatever order the device found the links in.
void HierarchicalFormFactors::makeEntries(std::vector<io::HierarchicalLink> links) {
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
    for (size_t k = 0; k < n; ++k)
        std::sort(entries.begin() + firstEntry_[k], entries.begin() + firstEntry_[k + 1],
                  [](const glm::uvec4& a, const glm::uvec4& b) { return a.x < b.x; });
    statistics_.bytes = entries.size() * sizeof(glm::uvec4);
    entries_ = gpu::Buffer(*device_, statistics_.bytes, "hierarchical entries");
    entries_.upload(entries);
}

void HierarchicalFormFactors::makeOperator() {
    for (uint32_t columns = 1; columns <= kMostColumns; ++columns)
        gathers_.emplace_back(*device_, hierarchical_gather_comp, "hierarchical gather",
                              gpu::Specialization{{"kColumns", columns}});
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
    constexpr gpu::Stage kCompute = gpu::Stage::compute;
    constexpr VkFormat kUint = VK_FORMAT_R32_UINT;
    if (patchCount_ == 0 || scene_.tree.nodes.empty()) {
        std::fill(out.begin(), out.end(), 0.0f);
        return;
    }
    const auto& level = scene_.tree.levelFirst;
    const auto nodes = static_cast<uint32_t>(scene_.tree.nodes.size());
    // Windows of nodes whose entries fit the device's limit on texels.
    const uint32_t mostEntries = device_->limits().maxTexelBufferElements;
    const uint32_t nodesPerGroup = io::kHierarchicalGroup / std::max(1u, device_->subgroupSize());
    for (uint32_t first = 0; first < columns; first += kMostColumns) {
        const uint32_t count = std::min(kMostColumns, columns - first);
        light_.upload(in.subspan(size_t{first} * patchCount_, size_t{count} * patchCount_));
        gpu::Commands commands(*device_);
        const auto sweep = [&](uint32_t begin, uint32_t end) {
            return io::HierarchicalSweepParams{begin, end - begin, count, patchCount_};
        };
        const auto groups = [&](uint32_t begin, uint32_t end) {
            return gpu::groupsFor(size_t{end - begin} * count, io::kHierarchicalGroup);
        };
        for (size_t l = level.size() - 1; l-- > 0;) {
            commands.dispatch(
                moments_, {gpu::texel(family_, kUvec4), gpu::texel(frames_, kVec4), light_, momentTexels_},
                sweep(level[l], level[l + 1]), groups(level[l], level[l + 1]));
            commands.barrier(kCompute, kCompute); // parents read the moments of their children
        }
        for (uint32_t begin = 0; begin < nodes;) {
            uint32_t end = begin + 1;
            const uint32_t firstEntry = firstEntry_[begin] / io::kHierarchicalAlign * io::kHierarchicalAlign;
            while (end < nodes && firstEntry_[end + 1] - firstEntry <= mostEntries) ++end;
            const size_t offset = size_t{firstEntry} * sizeof(glm::uvec4),
                         bytes = size_t{firstEntry_[end] - firstEntry} * sizeof(glm::uvec4);
            commands.dispatch(
                gathers_[count - 1],
                {gpu::texel(firstEntryTexels_, kUint),
                 bytes > 0 ? gpu::texel(entries_, kUvec4, offset, bytes) : gpu::texel(entries_, kUvec4),
                 gpu::texel(momentTexels_, kVec4), received_},
                sweep(begin, end), gpu::groupsFor(end - begin, nodesPerGroup));
            begin = end;
        }
        commands.barrier(kCompute, kCompute); // children read what their parents received
        for (size_t l = 1; l + 1 < level.size(); ++l) {
            commands.dispatch(spread_, {gpu::texel(parents_, kUint), gpu::texel(frames_, kVec4), received_},
                              sweep(level[l], level[l + 1]), groups(level[l], level[l + 1]));
            commands.barrier(kCompute, kCompute);
        }
        commands.dispatch(
            patches_,
            {gpu::texel(firstLeafTexels_, kUint), gpu::texel(leafNodeTexels_, kUvec4), received_, gathered_},
            sweep(0, nodes), gpu::groupsFor(size_t{patchCount_} * count, io::kHierarchicalGroup));
        commands.barrier(kCompute, gpu::Stage::host);
        device_->submitAndWait(std::move(commands));
        std::memcpy(&out[size_t{first} * patchCount_], gathered_.mapped(),
                    size_t{count} * patchCount_ * sizeof(float));
    }
}

void HierarchicalFormFactors::rows(uint32_t first, uint32_t count, std::span<float> values) const {
    std::vector<glm::uvec4> copy;
    const auto* entries = entries_.mapped<glm::uvec4>();
    if (!entries) {
        copy = entries_.download<glm::uvec4>(firstEntry_.back());
        entries = copy.data();
    }
    std::fill_n(values.begin(), size_t{count} * patchCount_, 0.0f);
    std::vector<double> row(patchCount_);
    for (uint32_t i = first; i < first + count; ++i) {
        std::fill(row.begin(), row.end(), 0.0);
        for (uint32_t k = firstLeaf_[i]; k < firstLeaf_[i + 1]; ++k) {
            const PatchTree::Leaf& own = scene_.tree.leaves[scene_.tree.nodes[leafNodes_[k]].firstLeaf];
            const double share = own.area / patchArea_[i];
            for (uint32_t p = leafNodes_[k]; p != PatchTree::kNone; p = scene_.tree.nodes[p].parent) {
                const auto at = PatchTree::coordinates(scene_.tree.nodes[p], middleOf(own));
                for (uint32_t e = firstEntry_[p]; e < firstEntry_[p + 1]; ++e) {
                    const PatchTree::Node& q = scene_.tree.nodes[entries[e].x];
                    const double density = share * double{std::bit_cast<float>(entries[e].y)};
                    const glm::vec2 a = glm::unpackHalf2x16(entries[e].z),
                                    b = glm::unpackHalf2x16(entries[e].w);
                    const double here = 1 + double{a.x} * at[0] + double{a.y} * at[1];
                    // The other end's slopes as a vector in its plane.
                    const glm::dvec3 slope = double{b.x} * q.axisU / glm::dot(q.axisU, q.axisU) +
                                             double{b.y} * q.axisV / glm::dot(q.axisV, q.axisV);
                    for (uint32_t l = q.firstLeaf; l < q.firstLeaf + q.leafCount; ++l) {
                        const PatchTree::Leaf& leaf = scene_.tree.leaves[l];
                        row[leaf.patch] +=
                            density * leaf.area * (here + glm::dot(slope, middleOf(leaf) - q.centre));
                    }
                }
            }
        }
        for (uint32_t j = 0; j < patchCount_; ++j)
            values[size_t{i - first} * patchCount_ + j] = static_cast<float>(row[j]);
    }
}

} // namespace heliodon::compute
