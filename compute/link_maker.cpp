#include "compute/link_maker.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <utility>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "spirv/hierarchical_leaves_comp.h"
#include "spirv/hierarchical_links_comp.h"
#include "spirv/hierarchical_rays_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kBatch = 1u << 16;    // pairs of one dispatch
constexpr uint32_t kMostRays = 1u << 14; // between two triangles
constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT;

template<class T> void append(std::vector<T>& to, const gpu::Buffer& from, uint32_t count) {
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

// Moves the last of `from`, at most a batch, to the device.
template<class T> uint32_t takeBatch(std::vector<T>& from, gpu::Buffer& to) {
    const size_t count = std::min<size_t>(from.size(), kBatch);
    to.upload(std::span<const T>(from).last(count));
    from.resize(from.size() - count);
    return static_cast<uint32_t>(count);
}

} // namespace

LinkMaker::LinkMaker(gpu::Device& device, const ClusterScene& scene, const LinkTolerance& tolerance)
    : device_(&device), scene_(&scene),
      clusters_(device.kernels().get(hierarchical_links_comp, "hierarchical links")),
      triangles_(device.kernels().get(hierarchical_leaves_comp, "hierarchical leaves", {{"kNear", 0u}})),
      nearTriangles_(
          device.kernels().get(hierarchical_leaves_comp, "hierarchical near leaves", {{"kNear", 1u}})),
      rays_(device.kernels().get(hierarchical_rays_comp, "hierarchical rays")),
      pairs_(device, kBatch * sizeof(glm::uvec2), "link pairs"),
      doubted_(device, kBatch * sizeof(io::HierarchicalDoubt), "doubted links"),
      counters_(device, io::kHierarchicalCounters * sizeof(uint32_t), "link counters", gpu::Place::host),
      next_(device, 4 * kBatch * sizeof(glm::uvec2), "next pairs", gpu::Place::host),
      newLeafPairs_(device, 4 * kBatch * sizeof(glm::uvec2), "leaf pairs", gpu::Place::host),
      newLinks_(device, kBatch * sizeof(io::HierarchicalLink), "new links", gpu::Place::host),
      newDoubts_(device, kBatch * sizeof(io::HierarchicalDoubt), "new doubts", gpu::Place::host) {
    params_.nodeCount = scene.blockers.nodeCount;
    params_.flatness = static_cast<float>(5e-7 * scene.blockers.diagonal);
    params_.tolerance = static_cast<float>(tolerance.open);
    params_.visibilityTolerance = static_cast<float>(tolerance.visible);
    params_.mostRays = kMostRays;
}

void LinkMaker::add(uint32_t first, uint32_t second) {
    const bool triangles = scene_->tree.nodes[first].child == 0 && scene_->tree.nodes[second].child == 0;
    (triangles ? leafPairs_ : pending_).push_back({first, second});
    if (pending_.size() >= kBatch || leafPairs_.size() >= kBatch) work(kBatch);
}

std::vector<io::HierarchicalLink> LinkMaker::finish() {
    work(1);
    std::sort(links_.begin(), links_.end(), [](const io::HierarchicalLink& a, const io::HierarchicalLink& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    return std::move(links_);
}

// Until fewer than `least` wait in each queue: full dispatches of the last stages first, so that little
// waits, else the first stage that has enough.
void LinkMaker::work(size_t least) {
    for (;;) {
        const std::array waiting{pending_.size(), leafPairs_.size(), nearPairs_.size(), doubts_.size()};
        const auto full =
            std::find_if(waiting.rbegin(), waiting.rend(), [](size_t n) { return n >= kBatch; });
        const auto enough =
            std::find_if(waiting.begin(), waiting.end(), [&](size_t n) { return n >= least; });
        if (full == waiting.rend() && enough == waiting.end()) return;
        const auto stage = full != waiting.rend() ? waiting.rend() - full - 1 : enough - waiting.begin();
        if (stage == 0) {
            const uint32_t count = takeBatch(pending_, pairs_);
            pairCount_ += count;
            run(clusters_, pairs_, count, true);
        } else if (stage == 1)
            run(triangles_, pairs_, takeBatch(leafPairs_, pairs_), false);
        else if (stage == 2)
            run(nearTriangles_, pairs_, takeBatch(nearPairs_, pairs_), false);
        else
            run(rays_, doubted_, takeBatch(doubts_, doubted_), true);
    }
}

void LinkMaker::run(const gpu::Kernel& kernel, const gpu::Buffer& in, uint32_t count, bool splits) {
    params_.pairCount = count;
    std::vector<gpu::Binding> bindings{gpu::texel(scene_->nodes, kUvec4),
                                       gpu::texel(scene_->leaves, kUvec4),
                                       gpu::texel(scene_->blockers.nodes, kUvec4),
                                       gpu::texel(scene_->blockers.triangles, kUvec4),
                                       in,
                                       counters_,
                                       next_};
    if (splits) bindings.push_back(newLeafPairs_);
    bindings.insert(bindings.end(), {newLinks_, newDoubts_});
    gpu::Commands commands(*device_);
    commands.fill(counters_, 0);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    commands.dispatchBytes(kernel, bindings, &params_, sizeof params_,
                           {gpu::groupsFor(count, io::kHierarchicalGroup), 1, 1});
    commands.barrier(gpu::Stage::compute, gpu::Stage::host);
    device_->submitAndWait(std::move(commands));
    const auto* counters = counters_.mapped<uint32_t>();
    append(splits ? pending_ : nearPairs_, next_, counters[io::kHierarchicalPairs]);
    if (splits) append(leafPairs_, newLeafPairs_, counters[io::kHierarchicalLeaves]);
    append(links_, newLinks_, counters[io::kHierarchicalLinks]);
    append(doubts_, newDoubts_, counters[io::kHierarchicalDoubts]);
}

} // namespace heliodon::compute
