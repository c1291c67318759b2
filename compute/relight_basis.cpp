#include "compute/relight_basis.h"

#include <algorithm>
#include <cmath>

#include "compute/float_dot.h"
#include "compute/largest.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr double kUnbalanced = 2e-6; // of what is emitted in all, that a pass is worth to have sent round
constexpr double kMostTimes = 1e6;   // that an answer is scaled by

void subtract(std::span<float> from, double times, std::span<const float> what) {
    const auto t = static_cast<float>(times);
    for (size_t i = 0; i < from.size(); ++i) from[i] -= t * what[i];
}

} // namespace

void RelightBasis::restart() {
    basis_.assign(solver_->matter().reflectance.size(), {});
}

double RelightBasis::project(uint32_t channel, std::span<float> residual, std::span<float> gathered) const {
    double rounding = kGatherRounding * largest(residual); // all of it from one pass so far
    for (int twice = 0; twice < 2; ++twice)                // images are at right angles but for rounding
        for (const Vector& v : basis_[channel]) {
            const double share = dot(v.image, residual);
            subtract(residual, share, v.image);
            subtract(gathered, -share, v.gathered);
            rounding += std::abs(share) * v.rounding;
        }
    return rounding;
}

double RelightBasis::given(std::span<const float> residual) const {
    double sum = 0;
    for (size_t i = 0; i < residual.size(); ++i)
        sum += areas_[i] * double{solver_->rowSums()[i]} * double{residual[i]};
    return sum;
}

bool RelightBasis::balance(const Vector& answer, double most, std::span<float> residual,
                           std::span<float> gathered) const {
    const double all = given(answer.image), left = given(residual);
    if (!(std::abs(left) <= kMostTimes * std::abs(all)))
        return false; // nor where there is none, or no number
    const double times = all != 0 ? left / all : 0;
    std::vector<float> rest(residual.begin(), residual.end());
    subtract(rest, times, answer.image);
    if (largest(rest) > most) return false;
    std::ranges::copy(rest, residual.begin());
    subtract(gathered, -times, answer.gathered);
    return true;
}

bool RelightBasis::learn(uint32_t channel, std::vector<float> image, std::vector<float> gathered) {
    if (basis_[channel].size() >= kMostVectors) return false;
    const double before = std::sqrt(dot(image, image));
    if (!(before > 0)) return false;
    for (int twice = 0; twice < 2; ++twice)
        for (const Vector& v : basis_[channel]) {
            const double along = dot(v.image, image);
            subtract(image, along, v.image);
            subtract(gathered, along, v.gathered);
        }
    const double length = std::sqrt(dot(image, image));
    if (length < 1e-3 * before) return false; // nothing new, or mostly rounding
    const auto scale = static_cast<float>(1 / length);
    for (float& x : image) x *= scale;
    for (float& x : gathered) x *= scale;
    basis_[channel].push_back({std::move(image), std::move(gathered)});
    return true;
}

void RelightBasis::measure(std::span<const uint32_t> channel) {
    const RadiosityMatter& matter = solver_->matter();
    const size_t n = matter.patchCount;
    std::vector<Vector*> vectors;
    std::vector<size_t> back(basis_.size(), 0);
    for (size_t k = channel.size(); k-- > 0;) {
        auto& of = basis_[channel[k]];
        vectors.insert(vectors.begin(), &of[of.size() - ++back[channel[k]]]);
    }
    std::vector<float> u(n * vectors.size()), gathered(u.size());
    for (size_t k = 0; k < vectors.size(); ++k) {
        const std::span<float> at(&u[k * n], n);
        matter.reflect<float>(channel[k], vectors[k]->gathered, at);
        for (size_t i = 0; i < n; ++i) at[i] += vectors[k]->image[i];
    }
    factors_->gatherIn(channel, u, gathered);
    for (size_t k = 0; k < vectors.size(); ++k) {
        Vector& v = *vectors[k];
        v.gathered.assign(&gathered[k * n], &gathered[k * n] + n);
        matter.reflect<float>(channel[k], v.gathered, v.image);
        for (size_t i = 0; i < n; ++i) v.image[i] = u[k * n + i] - v.image[i];
        v.rounding = kGatherRounding * std::max(largest({&u[k * n], n}), largest(v.gathered));
    }
}

// One call's light, for each column of `channel`, and what is known of its error.
struct RelightBasis::Columns {
    std::span<const uint32_t> channel;
    std::span<const float> emitted;
    std::vector<float>&radiosity, &gathered;
    const RadiosityOptions& options;
    size_t n;
    std::vector<float> direct;                 // F E
    std::vector<float> residual;               // of (I - K F) w = K F E, beyond the first bounce
    std::vector<double> scale, left, rounding; // scale: largest reflected light so far
    uint32_t passes = 1;

    std::span<float> of(std::vector<float>& all, size_t c) const { return {&all[c * n], n}; }
};

double RelightBasis::reflect(Columns& at, size_t c) const {
    const std::span<float> light = at.of(at.radiosity, c);
    solver_->matter().reflect<float>(at.channel[c], at.of(at.gathered, c), light);
    return std::max(largest(light), 1e-30);
}

double RelightBasis::allowed(const Columns& at, size_t c) const {
    return at.options.tolerance * solver_->slack(at.channel[c]) * at.scale[c];
}

void RelightBasis::answerFromBasis(Columns& at) const {
    inParallel(at.channel.size(), [&](size_t c) {
        const std::span<float> r = at.of(at.residual, c), h = at.of(at.gathered, c);
        solver_->matter().reflect<float>(at.channel[c], h, r);
        at.rounding[c] = project(at.channel[c], r, h);
        at.left[c] = largest(r);
        at.scale[c] = reflect(at, c);
    });
}

void RelightBasis::solveRest(Columns& at) {
    const size_t n = at.n;
    std::vector<uint32_t> open, channel;
    std::vector<float> right, answer, seen;
    std::vector<double> known, uncertain;
    for (uint32_t c = 0; c < at.channel.size(); ++c) {
        const double most = allowed(at, c);
        if (!(at.left[c] + std::min(at.rounding[c], most / 2) > most))
            continue; // the bound, too, is within it
        open.push_back(c), channel.push_back(at.channel[c]);
        right.insert(right.end(), &at.residual[c * n], &at.residual[c * n] + n);
        known.push_back(at.scale[c]), uncertain.push_back(at.rounding[c]);
    }
    if (open.empty()) return;
    at.passes += solver_->solveReflected(right, channel, known, uncertain, answer, seen, at.options).passes;
    std::vector<uint32_t> learnt;
    for (size_t k = 0; k < open.size(); ++k) {
        const uint32_t c = open[k];
        const std::span<float> w = at.of(answer, k), h = at.of(seen, k), r = at.of(at.residual, c),
                               g = at.of(at.gathered, c);
        std::vector<float> image(n);
        solver_->matter().reflect<float>(channel[k], h, image);
        for (size_t i = 0; i < n; ++i) {
            image[i] = w[i] - image[i];
            r[i] -= image[i];
            g[i] += h[i];
        }
        at.left[c] = largest(r);
        at.scale[c] = std::max(at.scale[c], reflect(at, c));
        at.rounding[c] += kGatherRounding * std::max(largest(h), largest(w));
        if (learn(channel[k], std::move(image), {h.begin(), h.end()})) learnt.push_back(channel[k]);
    }
    if (!learnt.empty()) measure(learnt), ++at.passes;
}

bool RelightBasis::spread(Columns& at, size_t c, const Vector& answer) const {
    const std::span<float> r = at.of(at.residual, c);
    const double most = allowed(at, c);
    const bool done = balance(answer, std::max(at.left[c], most - std::min(at.rounding[c], most / 2)), r,
                              at.of(at.gathered, c));
    if (done) at.left[c] = largest(r), reflect(at, c);
    return done;
}

void RelightBasis::sendRound(Columns& at) {
    const RadiosityMatter& matter = solver_->matter();
    const size_t n = at.n;
    std::vector<uint32_t> unbalanced, channel;
    std::vector<float> light;
    for (uint32_t c = 0; c < at.channel.size(); ++c) {
        Vector all; // that was answered, whose images and illuminance are known
        all.image.resize(n), all.gathered.resize(n);
        const std::span<const float> r = at.of(at.residual, c), g = at.of(at.gathered, c),
                                     direct = at.of(at.direct, c);
        matter.reflect<float>(at.channel[c], direct, all.image);
        for (size_t i = 0; i < n; ++i) {
            all.image[i] -= r[i];
            all.gathered[i] = g[i] - direct[i];
        }
        if (spread(at, c, all) || std::abs(given(r)) <= kUnbalanced * given(at.emitted.subspan(c * n, n)))
            continue;
        unbalanced.push_back(c), channel.push_back(at.channel[c]);
        light.insert(light.end(), r.begin(), r.end());
    }
    if (unbalanced.empty()) return;
    std::vector<float> seen(light.size());
    factors_->gatherIn(channel, light, seen);
    ++at.passes;
    for (size_t k = 0; k < unbalanced.size(); ++k) {
        Vector bounce;
        bounce.gathered.assign(&seen[k * n], &seen[k * n] + n);
        bounce.image.resize(n);
        matter.reflect<float>(channel[k], bounce.gathered, bounce.image);
        for (size_t i = 0; i < n; ++i) bounce.image[i] = light[k * n + i] - bounce.image[i];
        spread(at, unbalanced[k], bounce);
    }
}

RadiosityReport RelightBasis::solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                                    std::vector<float>& radiosity, std::vector<float>& gathered,
                                    const RadiosityOptions& options) {
    const size_t n = solver_->matter().patchCount, count = channel.size();
    const std::vector<double> none(count);
    radiosity.resize(n * count);
    gathered.assign(n * count, 0);
    factors_->gatherIn(channel, emitted, gathered);
    Columns at{channel, emitted, radiosity, gathered, options, n, gathered, std::vector<float>(n * count),
               none,    none,    none};
    answerFromBasis(at);
    solveRest(at);
    sendRound(at);
    RadiosityReport report;
    report.passes = at.passes;
    for (size_t c = 0; c < count; ++c) {
        for (size_t i = 0; i < n; ++i) radiosity[c * n + i] += emitted[c * n + i];
        // B = E + K F (E + w): what is left of the residual is bounced once more.
        const double room = solver_->slack(channel[c]) * at.scale[c];
        report.residual = std::max(report.residual, at.left[c] / at.scale[c]);
        report.bound = std::max(report.bound, (at.left[c] + at.rounding[c]) / room);
        report.converged &= at.left[c] <= options.tolerance * room;
    }
    return report;
}

} // namespace heliodon::compute
