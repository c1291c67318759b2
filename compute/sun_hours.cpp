#include "compute/sun_hours.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compute/lighting.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"
#include "compute/sun_bounce.h"

namespace heliodon::compute {

namespace {

constexpr size_t kAtOnce = 64;  // hours that threads work on before they are counted
constexpr double kTrace = 2e-2; // of what sunlight would give all surfaces at its first bounce, were it even

size_t bytesOf(const SunHours::Hour& hour) {
    return sizeof hour +
           (hour.patches.size() + hour.bounced.size() + hour.windows.size() + hour.outside.size()) *
               sizeof(SunHours::Lit) +
           hour.groups.size() * sizeof(SunHours::Scatter);
}

} // namespace

SunHours::SunHours(const TransportParts& parts, const geometry::PatchMesh& mesh,
                   std::span<const daylight::Sky> skies, size_t mostBytes, std::function<void(size_t)> done)
    : mesh_(&mesh), scene_(&parts.sun), bounce_(parts.sunBounce), blinds_(&parts.blinds),
      reflection_(&parts.reflection), skies_(skies), wantedBytes_(mostBytes), done_(std::move(done)) {
    for (size_t i = 0; i < mesh.patchCount(); ++i) area_ += geometry::patchArea(mesh, i);
    for (size_t h = 0; h < skies.size() && parts.skyElements > 0; ++h)
        if (skies[h].hasSun()) sunny_.push_back(static_cast<uint32_t>(h));
}

// Finds out which hours' sun enters and where blocks end.
void SunHours::makeFirst(const std::function<void(const Block&)>& work) {
    made_ = true;
    std::vector<Made> block;
    size_t bytes = 0;
    for (size_t first = 0; first < sunny_.size(); first += kAtOnce) {
        std::vector<Made> made(std::min(kAtOnce, sunny_.size() - first));
        {
            const SecondsAdded clock(seconds_);
            inParallel(made.size(), [&](size_t k) { made[k] = hourOf(sunny_[first + k]); });
        }
        if (done_) done_(made.size());
        for (Made& one : made) {
            if (!one.enters) continue;
            if (bytes >= wantedBytes_ && !block.empty()) {
                hold(firsts_.size() - 1, block);
                work(held());
                hours_ = {}, edges_ = {};
                bytes = 0;
            }
            if (block.empty()) firsts_.push_back(entering_.size());
            entering_.push_back(one.hour.sky);
            litPatches_ += one.hour.patches.size();
            bytes += bytesOf(one.hour) + SunEdges::bytesOf(one.edges);
            held_ = std::max(held_, bytes);
            block.push_back(std::move(one));
        }
    }
    if (block.empty()) return;
    hold(firsts_.size() - 1, block);
    work(held());
}

SunHours::Made SunHours::hourOf(uint32_t at) const {
    const daylight::SunDisc& disc = skies_[at].sun;
    const SunPatches sun(*scene_, disc.direction, !reflection_->isEmpty());
    Made made{sun.canEnter(), {at, {}, {}, {}, {}, {}}, {}};
    const std::vector<glm::vec3> outside = reflection_->sunlight(sun);
    for (size_t c = 0; c < outside.size(); ++c)
        if (outside[c] != glm::vec3(0))
            made.hour.outside.push_back(
                {static_cast<uint32_t>(c), static_cast<float>(disc.normalIlluminance) * outside[c]});
    made.enters |= !made.hour.outside.empty();
    if (!sun.canEnter()) return made;
    const auto strength = static_cast<float>(disc.normalIlluminance);
    const auto add = [](std::vector<Lit>& lit, size_t row, glm::vec3 lux) {
        if (lux != glm::vec3(0)) lit.push_back({static_cast<uint32_t>(row), lux});
    };
    std::vector<SunlitParts> partly;
    const std::vector<glm::vec3> onPatches = sun.onPatches(&partly);
    made.edges = SunEdges::edgesOf(*mesh_, partly, disc.normalIlluminance);
    for (size_t i = 0; i < onPatches.size(); ++i) add(made.hour.patches, i, strength * onPatches[i]);
    addBounced(partly, disc.normalIlluminance, made);
    size_t row = 0;
    for (const GlowingBlinds::Group& group : blinds_->groups())
        for (const uint32_t patch : group.patches)
            add(made.hour.windows, row++, glm::vec3(disc.normalIlluminance * sun.onOutside(patch)));
    made.hour.patches.shrink_to_fit();
    made.hour.windows.shrink_to_fit();
    if (made.hour.windows.empty()) return made;
    const glm::dvec3 towards = glm::normalize(disc.direction);
    for (const GlowingBlinds::Group& group : blinds_->groups()) {
        Scatter& scatter = made.hour.groups.emplace_back(
            Scatter{glm::vec3(group.window.scattered(towards, group.normal)), {}});
        const daylight::Window::Lobes lobes = group.window.lobes(towards, group.normal);
        std::copy(lobes.begin(), lobes.end(), scatter.lobes.begin());
    }
    return made;
}

void SunHours::addBounced(std::span<const SunlitParts> partly, double strength, Made& made) const {
    if (!bounce_) return;
    std::vector<glm::vec3> more(mesh_->patchCount(), glm::vec3(0)), sent = more;
    bounce_->addTo(more, sent, partly, strength);
    double reflected = 0; // lumens of the first bounce
    for (Lit& patch : made.hour.patches) {
        const glm::vec3 rho = mesh_->materials[mesh_->material[patch.row]].reflectance;
        reflected += geometry::patchArea(*mesh_, patch.row) * photometric(rho * patch.lux);
        const int most = rho.g >= std::max(rho.r, rho.b) ? 1 : rho.r >= rho.b ? 0 : 2;
        // As if lit less or more: where one channel stands for all, also in those that are not reflected.
        for (int c = 0; c < 3; ++c) {
            const int of = rho[c] > 0 ? c : most;
            if (rho[of] > 0) patch.lux[c] += sent[patch.row][of] / rho[of];
        }
    }
    for (SunEdges::Edge& edge : made.edges) edge.beyond = sent[edge.patch];
    for (size_t i = 0; i < more.size(); ++i)
        if (std::abs(photometric(more[i])) * area_ > kTrace * reflected)
            made.hour.bounced.push_back({static_cast<uint32_t>(i), more[i]});
    made.hour.bounced.shrink_to_fit();
}

void SunHours::makeAgain(size_t block) {
    const size_t first = firsts_[block],
                 last = block + 1 < firsts_.size() ? firsts_[block + 1] : entering_.size();
    hours_ = {};
    edges_ = {};
    std::vector<Made> made(last - first);
    {
        const SecondsAdded clock(seconds_);
        inParallel(made.size(), [&](size_t k) { made[k] = hourOf(entering_[first + k]); });
    }
    if (done_) done_(made.size());
    hold(block, made);
}

// Takes what was made.
void SunHours::hold(size_t block, std::vector<Made>& made) {
    hours_.clear();
    std::vector<std::vector<SunEdges::Edge>> edges;
    for (Made& one : made) {
        hours_.push_back(std::move(one.hour));
        edges.push_back(std::move(one.edges));
    }
    made.clear();
    edges_ = SunEdges(*mesh_, std::move(edges));
    block_ = block;
}

void SunHours::forBlocks(const std::function<void(const Block&)>& work) {
    if (!made_) return makeFirst(work);
    const size_t begin = block_;
    for (size_t k = 0; k < firsts_.size(); ++k) {
        const size_t block = (begin + k) % firsts_.size();
        if (block != block_) makeAgain(block);
        work(held());
    }
}

} // namespace heliodon::compute
