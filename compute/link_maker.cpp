#include "compute/link_maker.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/parallel.h"
#include "spirv/hierarchical_links_comp.h"
#include "spirv/hierarchical_many_rays_comp.h"
#include "spirv/hierarchical_near_leaves_comp.h"
#include "spirv/hierarchical_open_leaves_comp.h"
#include "spirv/hierarchical_rays_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kBatch = 1u << 16;    // pairs of one dispatch
constexpr uint32_t kMostRays = 1u << 14; // between two triangles
constexpr size_t kSortedTogether = 64;   // lists of links, by one thread
constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT;

struct StageKernel {
    std::span<const uint32_t> spirv;
    std::string name;
    gpu::Specialization values;
};

// As shaders/CMakeLists.txt sets them.
static_assert(io::kHierarchicalLanes == 8);

StageKernel kernelOf(LinkStage stage) {
    switch (stage) {
    case LinkStage::clusters:
        return {hierarchical_links_comp, "hierarchical links", {}};
    case LinkStage::triangles:
        return {hierarchical_open_leaves_comp, "hierarchical leaves", {{"kNear", 0u}}};
    case LinkStage::nearTriangles:
        return {hierarchical_near_leaves_comp, "hierarchical near leaves", {{"kNear", 1u}}};
    case LinkStage::rays:
        return {hierarchical_rays_comp, "hierarchical rays", {{"kLanes", 1u}}};
    case LinkStage::manyRays:
        break;
    }
    return {hierarchical_many_rays_comp, "hierarchical many rays", {{"kLanes", io::kHierarchicalLanes}}};
}

template<class T> void append(std::vector<T>& to, const gpu::Buffer& from, uint32_t count) {
    if (count == 0) return;
    to.insert(to.end(), from.mapped<T>(), from.mapped<T>() + count); // made in memory that the host sees
}

// By first and second node: into one list for each first node, then each list by itself.
void sortLinks(std::vector<io::HierarchicalLink>& links, size_t nodes) {
    std::vector<uint32_t> begin(nodes + 1, 0);
    for (const io::HierarchicalLink& link : links) ++begin[link.first + 1];
    for (size_t k = 0; k < nodes; ++k) begin[k + 1] += begin[k];
    std::vector<io::HierarchicalLink> sorted(links.size());
    std::vector<uint32_t> at(begin.begin(), begin.end() - 1);
    for (const io::HierarchicalLink& link : links) sorted[at[link.first]++] = link;
    inParallel((nodes + kSortedTogether - 1) / kSortedTogether, [&](size_t chunk) {
        for (size_t k = chunk * kSortedTogether; k < std::min(nodes, (chunk + 1) * kSortedTogether); ++k)
            std::sort(sorted.begin() + begin[k], sorted.begin() + begin[k + 1],
                      [](const auto& a, const auto& b) { return a.second < b.second; });
    });
    links = std::move(sorted);
}

// Moves the last of `from`, at most a batch, to the device.
template<class T> uint32_t takeBatch(std::vector<T>& from, gpu::Buffer& to) {
    const size_t count = std::min<size_t>(from.size(), kBatch);
    to.upload(std::span<const T>(from).last(count));
    from.resize(from.size() - count);
    return static_cast<uint32_t>(count);
}

} // namespace

LinkMaker::LinkMaker(gpu::Device& device, const ClusterScene& scene, const LinkTolerance& tolerance)
    : device_(&device), scene_(&scene), pairs_(device, kBatch * sizeof(glm::uvec2), "link pairs"),
      doubted_(device, kBatch * sizeof(io::HierarchicalDoubt), "doubted links"),
      counters_(device, io::kHierarchicalCounters, "link counters"),
      next_(device, 4 * kBatch * sizeof(glm::uvec2), "next pairs", gpu::Place::host),
      newLeafPairs_(device, 4 * kBatch * sizeof(glm::uvec2), "leaf pairs", gpu::Place::host),
      newLinks_(device, kBatch * sizeof(io::HierarchicalLink), "new links", gpu::Place::host),
      newDoubts_(device, kBatch * sizeof(io::HierarchicalDoubt), "new doubts", gpu::Place::host),
      newLongDoubts_(device, kBatch * sizeof(io::HierarchicalDoubt), "new long doubts", gpu::Place::host) {
    params_.nodeCount = scene.blockers.nodeCount;
    params_.flatness = static_cast<float>(5e-7 * scene.diagonal);
    params_.mostRays = kMostRays;
    setTolerance(tolerance);
}

void LinkMaker::setTolerance(const LinkTolerance& tolerance) {
    params_.tolerance = static_cast<float>(tolerance.open);
    params_.visibilityTolerance = static_cast<float>(tolerance.visible);
}

void LinkMaker::prepareKernels(gpu::Device& device) {
    for (int stage = 0; stage < kLinkStages; ++stage) {
        const StageKernel kernel = kernelOf(static_cast<LinkStage>(stage));
        device.kernels().prepare(kernel.spirv, kernel.name, kernel.values);
    }
}

void LinkMaker::add(uint32_t first, uint32_t second) {
    const PatchTree::Node &a = scene_->tree.nodes[first], &b = scene_->tree.nodes[second];
    if (a.covered || b.covered) return linkAcrossGaps(a, b);
    const bool triangles = a.child == 0 && b.child == 0;
    (triangles ? leafPairs_ : pending_).push_back({first, second});
    if (pending_.size() >= kBatch || leafPairs_.size() >= kBatch) work(kBatch);
}

// Covered triangles send all their light to what covers them; the error is what passes the borders.
void LinkMaker::linkAcrossGaps(const PatchTree::Node& a, const PatchTree::Node& b) {
    for (uint32_t i = a.firstLeaf; i < a.firstLeaf + a.leafCount; ++i) {
        const PatchTree::Leaf& leaf = scene_->tree.leaves[i];
        if (leaf.across - b.firstLeaf >= b.leafCount) continue; // not of b, or of none
        const uint32_t other = scene_->tree.leaves[leaf.across].node;
        const auto density = static_cast<float>(1 / leaf.area);
        links_.push_back({std::min(leaf.node, other), std::max(leaf.node, other), density, 0, 0,
                          static_cast<float>(leaf.misses / leaf.area), density, 0});
    }
}

// Until fewer than `least` wait in each queue: full dispatches of the last stages first, so that little
// waits, else the first stage that has enough.
void LinkMaker::work(size_t least) {
    for (;;) {
        const std::array waiting{pending_.size(), leafPairs_.size(), nearPairs_.size(), doubts_.size(),
                                 longDoubts_.size()};
        const auto full =
            std::find_if(waiting.rbegin(), waiting.rend(), [](size_t n) { return n >= kBatch; });
        const auto enough =
            std::find_if(waiting.begin(), waiting.end(), [&](size_t n) { return n >= least; });
        if (full == waiting.rend() && enough == waiting.end()) return;
        const auto stage = static_cast<LinkStage>(full != waiting.rend() ? waiting.rend() - full - 1
                                                                         : enough - waiting.begin());
        switch (stage) {
        case LinkStage::clusters: {
            const uint32_t count = takeBatch(pending_, pairs_);
            pairCount_ += count;
            run(stage, pairs_, count);
            break;
        }
        case LinkStage::triangles:
            run(stage, pairs_, takeBatch(leafPairs_, pairs_));
            break;
        case LinkStage::nearTriangles:
            run(stage, pairs_, takeBatch(nearPairs_, pairs_));
            break;
        case LinkStage::rays:
            run(stage, doubted_, takeBatch(doubts_, doubted_));
            break;
        case LinkStage::manyRays:
            run(stage, doubted_, takeBatch(longDoubts_, doubted_));
            break;
        }
    }
}

std::vector<io::HierarchicalLink> LinkMaker::finish() {
    work(1);
    sortLinks(links_, scene_->tree.nodes.size());
    return std::move(links_);
}

void LinkMaker::run(LinkStage stage, const gpu::Buffer& in, uint32_t count) {
    params_.pairCount = count;
    const bool rays = stage == LinkStage::rays || stage == LinkStage::manyRays;
    const bool splits = rays || stage == LinkStage::clusters;
    const uint32_t lanes = stage == LinkStage::manyRays ? io::kHierarchicalLanes : 1;
    std::vector<gpu::Binding> bindings{gpu::texel(scene_->nodes, kUvec4),
                                       gpu::texel(scene_->leaves, kUvec4),
                                       gpu::texel(scene_->blockers.nodes, kUvec4),
                                       gpu::texel(scene_->blockers.triangles, kUvec4),
                                       in,
                                       counters_.buffer(),
                                       next_};
    if (splits) bindings.push_back(newLeafPairs_);
    bindings.insert(bindings.end(), {newLinks_, newDoubts_});
    if (rays) bindings.push_back(newLongDoubts_);
    const StageKernel kernel = kernelOf(stage);
    gpu::Commands commands(*device_);
    counters_.clear(commands);
    commands.dispatchBytes(device_->kernels().get(kernel.spirv, kernel.name, kernel.values), bindings,
                           &params_, sizeof params_,
                           {gpu::groupsFor(size_t{count} * lanes, io::kHierarchicalGroup), 1, 1});
    counters_.submitAndRead(std::move(commands));
    if (counters_[io::kHierarchicalCuts] > 0)
        throw gpu::Error("links: the device ends loops early, however short they are");
    append(splits ? pending_ : nearPairs_, next_, counters_[io::kHierarchicalPairs]);
    if (splits) append(leafPairs_, newLeafPairs_, counters_[io::kHierarchicalLeaves]);
    append(links_, newLinks_, counters_[io::kHierarchicalLinks]);
    append(doubts_, newDoubts_, counters_[io::kHierarchicalDoubts]);
    if (rays) append(longDoubts_, newLongDoubts_, counters_[io::kHierarchicalLongDoubts]);
}

} // namespace heliodon::compute
