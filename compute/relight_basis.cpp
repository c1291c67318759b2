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

RadiosityReport RelightBasis::solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                                    std::vector<float>& radiosity, std::vector<float>& gathered,
                                    const RadiosityOptions& options) {
    const RadiosityMatter& matter = solver_->matter();
    const size_t n = matter.patchCount, count = channel.size();
    RadiosityReport report;
    radiosity.resize(n * count);
    gathered.assign(n * count, 0);
    // Beyond the first bounce: (I - K F) w = K F E.
    factors_->gatherIn(channel, emitted, gathered);
    report.passes = 1;
    const std::vector<float> direct = gathered;
    std::vector<float> residual(n * count), once(n * count);
    std::vector<double> scale(count), left(count), rounding(count); // scale: largest reflected light so far
    const auto reflect = [&](size_t c) {
        matter.reflect<float>(channel[c], {&gathered[c * n], n}, {&radiosity[c * n], n});
        return std::max(largest({&radiosity[c * n], n}), 1e-30);
    };
    inParallel(count, [&](size_t c) {
        const std::span<float> r(&residual[c * n], n), h(&gathered[c * n], n);
        matter.reflect<float>(channel[c], h, r);
        std::copy(r.begin(), r.end(), &once[c * n]);
        rounding[c] = project(channel[c], r, h);
        left[c] = largest(r);
        scale[c] = reflect(c);
    });
    const auto allowed = [&](size_t c) { return options.tolerance * solver_->slack(channel[c]) * scale[c]; };
    std::vector<uint32_t> open, openChannel;
    for (uint32_t c = 0; c < count; ++c) {
        const double most = allowed(c);
        if (left[c] + std::min(rounding[c], most / 2) > most) // so that the bound, too, is within it
            open.push_back(c), openChannel.push_back(channel[c]);
    }
    if (!open.empty()) {
        std::vector<float> right, answer, seen;
        std::vector<double> known, uncertain;
        for (uint32_t c : open) {
            right.insert(right.end(), &residual[c * n], &residual[c * n] + n);
            known.push_back(scale[c]), uncertain.push_back(rounding[c]);
        }
        report.passes +=
            solver_->solveReflected(right, openChannel, known, uncertain, answer, seen, options).passes;
        std::vector<uint32_t> learnt;
        for (size_t k = 0; k < open.size(); ++k) {
            const size_t at = open[k] * n;
            std::vector<float> image(n);
            matter.reflect<float>(openChannel[k], {&seen[k * n], n}, image);
            for (size_t i = 0; i < n; ++i) {
                image[i] = answer[k * n + i] - image[i];
                residual[at + i] -= image[i];
                gathered[at + i] += seen[k * n + i];
            }
            left[open[k]] = largest({&residual[at], n});
            scale[open[k]] = std::max(scale[open[k]], reflect(open[k]));
            rounding[open[k]] +=
                kGatherRounding * std::max(largest({&seen[k * n], n}), largest({&answer[k * n], n}));
            if (learn(openChannel[k], std::move(image), {&seen[k * n], &seen[k * n] + n}))
                learnt.push_back(openChannel[k]);
        }
        if (!learnt.empty()) measure(learnt), ++report.passes;
    }
    std::vector<uint32_t> unbalanced, unbalancedChannel;
    std::vector<float> light;
    const auto spread = [&](size_t c, const Vector& answer) {
        const std::span<float> r(&residual[c * n], n);
        const double most = allowed(c);
        const bool done = balance(answer, std::max(left[c], most - std::min(rounding[c], most / 2)), r,
                                  {&gathered[c * n], n});
        if (done) left[c] = largest(r), reflect(c);
        return done;
    };
    for (size_t c = 0; c < count; ++c) {
        Vector all; // that was answered, whose images and illuminance are known
        all.image.resize(n), all.gathered.resize(n);
        for (size_t i = 0; i < n; ++i) {
            all.image[i] = once[c * n + i] - residual[c * n + i];
            all.gathered[i] = gathered[c * n + i] - direct[c * n + i];
        }
        const std::span<const float> r(&residual[c * n], n);
        if (spread(c, all) || std::abs(given(r)) <= kUnbalanced * given({&emitted[c * n], n})) continue;
        unbalanced.push_back(static_cast<uint32_t>(c)), unbalancedChannel.push_back(channel[c]);
        light.insert(light.end(), r.begin(), r.end());
    }
    if (!unbalanced.empty()) {
        std::vector<float> seen(light.size());
        factors_->gatherIn(unbalancedChannel, light, seen);
        ++report.passes;
        for (size_t k = 0; k < unbalanced.size(); ++k) {
            Vector bounce;
            bounce.gathered.assign(&seen[k * n], &seen[k * n] + n);
            bounce.image.resize(n);
            matter.reflect<float>(unbalancedChannel[k], bounce.gathered, bounce.image);
            for (size_t i = 0; i < n; ++i) bounce.image[i] = light[k * n + i] - bounce.image[i];
            spread(unbalanced[k], bounce);
        }
    }
    for (size_t c = 0; c < count; ++c) {
        for (size_t i = 0; i < n; ++i) radiosity[c * n + i] += emitted[c * n + i];
        // B = E + K F (E + w): what is left of the residual is bounced once more.
        const double room = solver_->slack(channel[c]) * scale[c];
        report.residual = std::max(report.residual, left[c] / scale[c]);
        report.bound = std::max(report.bound, (left[c] + rounding[c]) / room);
        report.converged &= left[c] <= options.tolerance * room;
    }
    return report;
}

} // namespace heliodon::compute
