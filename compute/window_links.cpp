#include "compute/window_links.h"

#include <algorithm>

#include "compute/parallel.h"
#include "compute/patch_points.h"
#include "geometry/luminance.h"

namespace heliodon::compute {

namespace {

struct Link {
    uint32_t to;
    float factor;
};

} // namespace

WindowLinks::WindowLinks(const PointScene& scene, gpu::Buffer& factors) {
    if (!scene.hasRoomsBeyond()) return;
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount();
    const PatchViewpoints views = patchViewpoints(mesh, 1);
    std::vector<std::vector<Link>> rows(n);
    std::vector<std::vector<TintedShare>> seen(n), tints(n);
    inParallel(n, [&](size_t i) {
        const Viewpoint& v = views.viewpoints[i];
        std::vector<float> row(n, 0);
        scene.seePatchesBeyond(PointView(scene.blockers(), v.position, v.normal, v.room), v.room, row.data(),
                               seen[i]);
        for (uint32_t j = 0; j < n; ++j)
            if (row[j] > 0) rows[i].push_back({j, row[j]});
    });
    std::vector<double> area(n);
    for (size_t i = 0; i < n; ++i) area[i] = geometry::patchArea(mesh, i);
    std::vector<float> values;
    float* matrix = factors.mapped<float>();
    if (!matrix) values = factors.download<float>(n * n), matrix = values.data();
    rowSums_.assign(n, glm::vec3(0));
    const auto add = [&](size_t i, size_t j, double factor) {
        float& entry = matrix[i * n + j];
        entries_.push_back({i * n + j, entry, static_cast<float>(factor)});
        entry += static_cast<float>(factor);
        rowSums_[i] += glm::vec3(static_cast<float>(factor));
    };
    for (size_t i = 0; i < n; ++i)
        for (const Link& link : rows[i]) {
            const auto back = std::lower_bound(rows[link.to].begin(), rows[link.to].end(), i,
                                               [](const Link& l, size_t to) { return l.to < to; });
            const bool both = back != rows[link.to].end() && back->to == i;
            if (both && link.to < i) continue; // done from the other end
            const double exchange =
                0.5 * (area[i] * link.factor + (both ? area[link.to] * double{back->factor} : 0));
            add(i, link.to, exchange / area[i]);
            if (link.to != i) add(link.to, i, exchange / area[link.to]);
        }
    if (!values.empty()) factors.upload(values);
    for (uint32_t i = 0; i < n; ++i)
        for (const TintedShare& share : seen[i]) {
            const auto back = static_cast<float>(area[i] / area[share.patch]);
            tints[i].push_back({share.patch, 0.5f * share.more});
            tints[share.patch].push_back({i, 0.5f * back * share.more});
        }
    for (size_t i = 0; i < n; ++i) {
        firstTint_.push_back(tints_.size());
        tints_.insert(tints_.end(), tints[i].begin(), tints[i].end());
        for (const TintedShare& share : tints[i]) rowSums_[i] += share.more;
    }
    firstTint_.push_back(tints_.size());
}

float WindowLinks::mostTint(size_t i) const {
    const glm::vec3 linked = rowSums_[i];
    return static_cast<float>(std::max({linked.x, linked.y, linked.z}) - geometry::photometric(linked));
}

void WindowLinks::addLinks(uint32_t channel, std::span<const float> in, std::span<float> out) const {
    for (const Entry& entry : entries_) out[entry.at / in.size()] += entry.factor * in[entry.at % in.size()];
    if (areTinted()) addTints(channel, in, out);
}

void WindowLinks::addTints(uint32_t channel, std::span<const float> in, std::span<float> out) const {
    const auto axis = static_cast<int>(channel);
    for (size_t i = 0; i < out.size(); ++i) {
        double sum = 0;
        for (size_t k = firstTint_[i]; k < firstTint_[i + 1]; ++k)
            sum += double{tints_[k].more[axis]} * in[tints_[k].patch];
        out[i] += static_cast<float>(sum);
    }
}

void TintedFactors::gatherIn(std::span<const uint32_t> channel, std::span<const float> in,
                             std::span<float> out) {
    gather(in, out, static_cast<uint32_t>(channel.size()));
    if (!links_->areTinted() && returned_->isEmpty()) return;
    const size_t n = patchCount();
    inParallel(channel.size(), [&](size_t c) {
        const std::span<const float> from = in.subspan(c * n, n);
        const std::span<float> to = out.subspan(c * n, n);
        if (links_->areTinted()) links_->addTints(channel[c], from, to);
        returned_->add(channel[c], from, to);
    });
}

void WindowLinks::remove(gpu::Buffer& factors) const {
    if (entries_.empty()) return;
    std::vector<float> values;
    float* matrix = factors.mapped<float>();
    // All of it: entries are many, and lie everywhere.
    if (!matrix) values = factors.download<float>(rowSums_.size() * rowSums_.size()), matrix = values.data();
    for (const Entry& entry : entries_) matrix[entry.at] = entry.before;
    if (!values.empty()) factors.upload(values);
}

} // namespace heliodon::compute
