#include "compute/sloped_factors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "compute/parallel.h"
#include "compute/patch_points.h"
#include "compute/point_view.h"

namespace heliodon::compute {

using glm::dmat3;
using glm::dvec3;

namespace {

constexpr uint32_t kPoints = 4;      // on a patch that is nearest to the sender
constexpr size_t kRowsAtOnce = 8;    // of F, side by side for the processor
constexpr size_t kColumnsAtOnce = 8; // of importance, as well
constexpr float kClose = 0.05F;      // form factor below which one point does
constexpr double kFarthest = 1. / 3; // of a patch's size: how far from its middle light can be sent from
constexpr float kUnresolved = 0.6F;  // form factor across a gap much narrower than patches
constexpr double kNoFlux = 1e-3;     // of what a patch sends: too little to make up for the rest

using Triangle = std::array<dvec3, 3>;

dvec3 middleOf(const Triangle& t) {
    return (t[0] + t[1] + t[2]) / 3.0;
}

double areaOf(const Triangle& t) {
    return 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
}

// How a patch lies round its middle, and pieces of it to look at one by one.
struct Extent {
    dvec3 middle;
    dmat3 spread{0}; // mean of the products of what its points are off
    std::vector<Triangle> pieces;
    double unseen = 1; // spread over that of the pieces' middles

    Extent(const geometry::PatchMesh& mesh, size_t patch) : middle(geometry::patchCentroid(mesh, patch)) {
        const std::vector<dvec3> corner = geometry::patchCorners(mesh, patch);
        double all = 0, ofMiddles = 0;
        for (size_t k = 1; k + 1 < corner.size(); ++k) {
            const Triangle t{corner[0], corner[k], corner[k + 1]};
            const double area = areaOf(t);
            const dvec3 off = middleOf(t) - middle;
            spread += area * glm::outerProduct(off, off);
            for (const dvec3& p : t)
                spread += area / 12 * glm::outerProduct(p - middleOf(t), p - middleOf(t));
            const dvec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
            for (const Triangle& piece :
                 {Triangle{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}}) {
                const dvec3 away = middleOf(piece) - middle;
                ofMiddles += area / 4 * glm::dot(away, away);
                pieces.push_back(piece);
            }
            all += area;
        }
        spread /= std::max(all, 1e-300);
        const double trace = spread[0][0] + spread[1][1] + spread[2][2];
        if (ofMiddles > 0) unseen = trace * all / ofMiddles;
    }
};

// Where on a patch what a few points get of it comes from, in the mean, off its middle.
dvec3 seenNearby(const Extent& from, const Blockers& blockers, std::span<const Viewpoint> points) {
    dvec3 sum(0);
    double whole = 0;
    for (const Viewpoint& at : points) {
        const PointView view(blockers, at.position, at.normal);
        for (const Triangle& piece : from.pieces) {
            const double factor = view.factor(piece);
            whole += factor;
            sum += factor * (middleOf(piece) - from.middle);
        }
    }
    return whole > 0 ? from.unseen / whole * sum : dvec3(0);
}

// The same from farther off: form factors fall off as cos cos / r^2 does at the middles.
dvec3 seenFromAfar(const Extent& from, double size, const PointScene::Patch& to) {
    const dvec3 d = from.middle - to.centre;
    const double height = glm::dot(d, to.normal);
    if (!(height > 0)) return dvec3(0);
    const dvec3 fall =
        to.normal / std::max(height, kFarthest * size) - 4.0 * d / std::max(glm::dot(d, d), size * size);
    const dvec3 off = from.spread * fall;
    const double length = glm::length(off), most = kFarthest * size;
    return length > most ? most / length * off : off;
}

// Between patches much nearer than they are large, as in thin slots, light falls off within a single one:
// its slope tells nothing, and would make light negative.
double trustInSlope(float largest) {
    return double{std::clamp((kUnresolved - largest) / (kUnresolved - NearPairs::kAcrossGap), 0.0F, 1.0F)};
}

} // namespace

SlopedFactors::SlopedFactors(const PointScene& scene, const PatchSlopes& slopes, const NearPairs& pairs,
                             std::span<const float> rowSums, gpu::Buffer& factors)
    : slopes_(&slopes), pairs_(&pairs), rest_(scene.mesh().patchCount(), glm::vec3(0)) {
    const size_t n = rest_.size();
    std::vector<float> copied;
    float* matrix = factors.mapped<float>();
    if (!matrix) copied = factors.download<float>(n * n), matrix = copied.data();
    const std::span<float> values(matrix, n * n);
    first_.push_back(0);
    for (size_t i = 0; i < n; ++i) {
        area_.push_back(static_cast<float>(geometry::patchArea(scene.mesh(), i)));
        first_.push_back(first_[i] + pairs.of(i).size());
    }
    near_.assign(first_.back(), glm::vec3(0));
    inParallel(n, [&](size_t j) { findMoments(scene, static_cast<uint32_t>(j), rowSums[j]); });
    putInto(values);
    if (!copied.empty()) factors.upload(copied);
}

void SlopedFactors::findMoments(const PointScene& scene, uint32_t sender, float rowSum) {
    const geometry::PatchMesh& mesh = scene.mesh();
    if (mesh.materials[mesh.material[sender]].isOpening() || slopes_->terms(sender).empty()) return;
    const std::span<const NearPairs::Pair> all = pairs_->of(sender);
    const double trust = trustInSlope(pairs_->largest(sender));
    if (trust == 0) return;
    const double size = scene.patches()[sender].size;
    const Extent from(mesh, sender);
    const double whole = double{area_[sender]} * double{rowSum};
    double nearby = 0;
    dvec3 sum(0);
    std::vector<dvec3> moment;
    for (size_t k = 0; k < all.size(); ++k) {
        const auto [to, factor] = all[k];
        const double flux = double{area_[to]} * double{factor};
        moment.push_back(
            trust * (k < pairs_->nearest(sender).size()
                         ? seenNearby(from, scene.blockers(),
                                      patchViewpoints(mesh, factor < kClose ? 1 : kPoints, to, 1).viewpoints)
                         : seenFromAfar(from, size, scene.patches()[to])));
        sum += flux * moment[k];
        nearby += flux;
    }
    dvec3 rest(0);
    if (const double others = whole - nearby; others > kNoFlux * whole) {
        rest = -sum / others;
        if (const double length = glm::length(rest); length > kFarthest * size)
            rest *= kFarthest * size / length;
        sum += others * rest;
    }
    rest_[sender] = glm::vec3(rest);
    for (size_t k = 0; k < all.size(); ++k) // what no others can make up for is spread among these
        near_[first_[sender] + k] =
            glm::vec3(double{all[k].factor} * (moment[k] - sum / std::max(nearby, 1e-300) - rest));
}

void SlopedFactors::putInto(std::span<float> factors) {
    const size_t n = rest_.size();
    struct Sender {
        uint32_t patch;
        glm::vec3 moment;
    };
    std::vector<std::vector<Sender>> senders(n);
    for (uint32_t j = 0; j < n; ++j)
        for (size_t k = first_[j]; k < first_[j + 1]; ++k)
            if (near_[k] != glm::vec3(0)) senders[pairs_->of(j)[k - first_[j]].to].push_back({j, near_[k]});
    negative_.assign(n, 0);
    struct Share {
        uint32_t patch;
        float of; // what others get of the sender
    };
    std::vector<std::vector<Share>> shares(n);
    for (size_t j = 0; j < n; ++j)
        if (rest_[j] != glm::vec3(0))
            for (const PatchSlopes::Term& term : slopes_->terms(j))
                shares[j].push_back({term.patch, glm::dot(rest_[j], term.weight)});
    using Rows = std::array<float, kRowsAtOnce>;
    inParallel((n + kRowsAtOnce - 1) / kRowsAtOnce, [&](size_t block) {
        const size_t first = block * kRowsAtOnce, end = std::min(first + kRowsAtOnce, n);
        std::vector<Rows> before(n), more(n);
        for (size_t i = first; i < end; ++i)
            for (size_t j = 0; j < n; ++j) before[j][i - first] = factors[i * n + j];
        for (size_t j = 0; j < n; ++j)
            for (const Share& share : shares[j]) {
                Rows sum = more[share.patch];
                for (size_t r = 0; r < kRowsAtOnce; ++r) sum[r] += before[j][r] * share.of;
                more[share.patch] = sum;
            }
        for (size_t i = first; i < end; ++i) {
            const std::span<float> row = factors.subspan(i * n, n);
            for (size_t j = 0; j < n; ++j) row[j] += more[j][i - first];
            for (const Sender& sender : senders[i])
                for (const PatchSlopes::Term& term : slopes_->terms(sender.patch))
                    row[term.patch] += glm::dot(sender.moment, term.weight);
            for (const float value : row) negative_[i] += std::max(0.0F, -value);
        }
    });
}

void SlopedFactors::takeBack(std::span<const glm::vec3> exitance, std::span<glm::vec3> lux,
                             std::span<glm::vec3> sent) const {
    for (size_t j = 0; j < rest_.size(); ++j) {
        glm::mat3 slope(0); // a column for each channel
        for (const PatchSlopes::Term& term : slopes_->terms(j))
            slope += glm::outerProduct(term.weight, exitance[term.patch]);
        if (slope == glm::mat3(0)) continue;
        sent[j] -= rest_[j] * slope;
        const std::span<const NearPairs::Pair> all = pairs_->of(j);
        for (size_t k = 0; k < all.size(); ++k) lux[all[k].to] -= near_[first_[j] + k] * slope;
    }
}

void SlopedFactors::takeBackImportance(std::span<const float> importance, std::span<const float> within,
                                       std::span<float> gathered) const {
    const size_t n = rest_.size(), columns = gathered.size() / n;
    inParallel((columns + kColumnsAtOnce - 1) / kColumnsAtOnce, [&](size_t block) {
        const size_t from = block * kColumnsAtOnce * n,
                     count = std::min(kColumnsAtOnce * n, gathered.size() - from);
        takeBackTogether(importance.subspan(from, count), within.subspan(from, count),
                         gathered.subspan(from, count));
    });
}

// Of kColumnsAtOnce columns or fewer: each pair of patches is read once for all of them.
void SlopedFactors::takeBackTogether(std::span<const float> importance, std::span<const float> within,
                                     std::span<float> gathered) const {
    using Columns [[gnu::vector_size(kColumnsAtOnce * sizeof(float))]] = float;
    const size_t n = rest_.size(), count = gathered.size() / n;
    std::vector<Columns> sent(n, Columns{}), got(n, Columns{}), left(n, Columns{}); // sent and got times area
    for (size_t c = 0; c < count; ++c)
        for (size_t i = 0; i < n; ++i) {
            sent[i][c] = area_[i] * importance[c * n + i];
            got[i][c] = area_[i] * within[c * n + i];
            left[i][c] = gathered[c * n + i];
        }
    for (size_t j = 0; j < n; ++j) {
        const glm::vec3& rest = rest_[j];
        Columns x = got[j] * rest.x, y = got[j] * rest.y, z = got[j] * rest.z; // what its slope answers to
        const std::span<const NearPairs::Pair> all = pairs_->of(j);
        for (size_t k = 0; k < all.size(); ++k) {
            const glm::vec3& moment = near_[first_[j] + k];
            const Columns& of = sent[all[k].to];
            x += of * moment.x, y += of * moment.y, z += of * moment.z;
        }
        for (const PatchSlopes::Term& term : slopes_->terms(j))
            left[term.patch] -=
                (x * term.weight.x + y * term.weight.y + z * term.weight.z) / area_[term.patch];
    }
    for (size_t c = 0; c < count; ++c)
        for (size_t i = 0; i < n; ++i) gathered[c * n + i] = left[i][c];
}

} // namespace heliodon::compute
