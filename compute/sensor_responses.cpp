#include "compute/sensor_responses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "compute/dense_gather.h"
#include "compute/glow_rows.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr size_t kColumnsAtOnce = 48; // right-hand sides that share passes over F

// A sensor's row in one channel, with what tinted panes make of it and what comes back from outside and the
// walls beside it add; `near`
// is empty without any.
std::vector<float> rowWith(const TransportParts& parts, std::span<const float> rows, size_t sensor,
                           size_t channel, const std::vector<float>& near) {
    const size_t n = rows.size() / parts.sensors.size();
    const std::span<const float> row = rows.subspan(sensor * n, n);
    std::vector<float> sum(row.begin(), row.end());
    for (const auto* more : {&parts.tinted[sensor], &parts.returned[sensor]})
        for (const TintedShare& share : *more) sum[share.patch] += share.more[static_cast<int>(channel)];
    for (size_t i = 0; i < near.size(); ++i) sum[i] += near[i];
    return sum;
}

} // namespace

// What sensors send into the room: a column for each and for each channel.
struct SensorResponder::Importance {
    size_t first = 0, count = 0;   // sensors
    std::vector<float> sent, once; // reflected where sensors look, and what of that falls on patches
    std::vector<float> more, rest; // exitance and gathered light of all that follows
    std::vector<float> even;       // once + rest as it would be for light that does not run on smoothly
};

SensorResponder::SensorResponder(DaylightTransport& transport)
    : transport_(transport), beams_(transport.parts().skyChannels == 3 ? 3 : 1) {
    const geometry::PatchMesh& mesh = transport_.mesh();
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        area_.push_back(static_cast<float>(geometry::patchArea(mesh, i)));
        clear_.push_back(mesh.twin[i] != geometry::kNoTwin && isClear(mesh.materials[mesh.material[i]]));
    }
}

// What gathers importance: A^-1 F^T A, which is F itself but for the slopes in it. On the host where F lies
// in its memory: sensors are many columns.
void SensorResponder::takeFactors(const TransportParts& parts) {
    if (solver_) return;
    const size_t n = transport_.mesh().patchCount();
    const gpu::Buffer& factors = transport_.formFactors().values;
    const gpu::HostView<float> values(factors, n * n);
    std::vector<float> adjoint(n * n), sums(n, 0); // sums: of absolute values
    inParallel(n, [&](size_t i) {
        for (size_t j = 0; j < n; ++j) {
            adjoint[i * n + j] = values[j * n + i] * area_[j] / area_[i];
            sums[i] += std::abs(adjoint[i * n + j]);
        }
    });
    if (factors.mapped() && n <= DenseGather::kMostHostPatches) {
        gather_ = std::make_unique<HostGather>(adjoint, static_cast<uint32_t>(n));
        bytes_ = n * n * sizeof(float);
    } else {
        adjoint_ = gpu::Buffer::from(parts.device, adjoint, "form factors of importance");
        gather_ = std::make_unique<RadiosityGather>(parts.device, adjoint_, static_cast<uint32_t>(n));
    }
    tinted_.emplace(*gather_, parts.links, parts.returnedOutside);
    for (size_t i = 0; i < parts.links.rowSums().size(); ++i) sums[i] += parts.links.mostTint(i);
    const std::vector<glm::vec3> back = parts.returnedOutside.rowSums();
    for (size_t i = 0; i < back.size(); ++i) sums[i] += std::max({back[i].x, back[i].y, back[i].z});
    solver_.emplace(*tinted_, std::move(sums));
    solver_->setMatter(parts.solver.matter());
}

SensorResponses SensorResponder::respond(const TransportParts& parts, const Told& told) {
    const size_t n = transport_.mesh().patchCount(), sensors = parts.sensors.size();
    SensorResponses result;
    result.sensors = sensors;
    result.own.assign(sensors, 0);
    for (size_t b = 0; b < beams_; ++b) result.sun[b].assign(GlowRows(parts, n).all * sensors, 0);
    Smooth smooth;
    for (size_t c = 0; c < parts.skyChannels; ++c) smooth[c].assign(sensors * n, 0);
    takeFactors(parts);
    const size_t atOnce = std::max<size_t>(1, kColumnsAtOnce / parts.channels);
    for (size_t first = 0; first < sensors; first += atOnce) {
        const Importance sent = importanceOf(parts, first, std::min(atOnce, sensors - first));
        inParallel(sent.count, [&](size_t k) { addAnswers(parts, sent, k, result, smooth); });
        told(sent.count);
    }
    addSky(parts, smooth, result);
    addLobes(parts, smooth, result);
    addGlow(parts, result);
    hideGlow(parts, result);
    addOutside(parts, smooth, result);
    return result;
}

// The first bounce is taken apart: what remains to be solved is smooth, so that the solver's tolerance, a
// share of the largest value, is small everywhere.
SensorResponder::Importance SensorResponder::importanceOf(const TransportParts& parts, size_t first,
                                                          size_t count) {
    const size_t n = area_.size(), columns = count * parts.channels;
    const RadiosityMatter& matter = parts.solver.matter();
    Importance result{first, count, std::vector<float>(columns * n), std::vector<float>(columns * n), {},
                      {},    {}};
    std::vector<float> twice(columns * n), perArea(n);
    std::vector<uint32_t> channel;
    for (size_t k = 0; k < columns; ++k) {
        const size_t s = first + k / parts.channels;
        channel.push_back(static_cast<uint32_t>(k % parts.channels));
        const std::vector<float> seen =
            rowWith(parts, parts.sensorFactors, s, channel[k], parts.near[s].smooth[channel[k]]);
        for (size_t i = 0; i < n; ++i) perArea[i] = seen[i] / area_[i];
        matter.reflect<float>(channel[k], perArea, {&result.sent[k * n], n});
    }
    tinted_->gatherIn(channel, result.sent, result.once);
    for (size_t k = 0; k < columns; ++k)
        matter.reflect<float>(channel[k], {&result.once[k * n], n}, {&twice[k * n], n});
    solver_->solve(twice, channel, result.more, result.rest, {});
    result.even.resize(columns * n);
    std::vector<float> all(columns * n), within(columns * n, 0); // within: as linked, then less that
    for (size_t i = 0; i < columns * n; ++i) {
        all[i] = result.sent[i] + result.more[i];
        result.even[i] = result.once[i] + result.rest[i];
    }
    inParallel(columns, [&](size_t k) {
        const std::span<float> own{&within[k * n], n};
        parts.links.addLinks(channel[k], {&all[k * n], n}, own);
        parts.returnedOutside.add(channel[k], {&all[k * n], n}, own);
        for (size_t i = 0; i < n; ++i) own[i] = result.even[k * n + i] - own[i];
    });
    parts.sloped.takeBackImportance(all, within, result.even);
    return result;
}

// Of the k-th sensor of `sent`.
void SensorResponder::addAnswers(const TransportParts& parts, const Importance& sent, size_t k,
                                 SensorResponses& result, Smooth& smooth) const {
    const geometry::PatchMesh& mesh = transport_.mesh();
    const size_t n = area_.size(), s = sent.first + k;
    const NearLight& near = parts.near[s];
    double own = 0;
    std::vector<float> later(n); // answer to what falls on patches, but for what the sensor sees itself
    for (size_t c = 0; c < parts.channels; ++c) {
        const std::vector<float> seen = rowWith(parts, parts.sensorFactors, s, c, near.smooth[c]),
                                 even = rowWith(parts, parts.sensorEven, s, c, near.even[c]);
        const std::vector<float>& rho = parts.solver.matter().reflectance[c];
        const size_t at = (k * parts.channels + c) * n;
        for (size_t i = 0; i < n; ++i) later[i] = area_[i] * (sent.once[at + i] + sent.rest[at + i]);
        // Grey stands for three.
        for (size_t shown = c; shown < (parts.channels == 1 ? 3 : c + 1); ++shown) {
            const auto axis = static_cast<int>(shown);
            const auto share = static_cast<float>(geometry::kLuminance[axis]);
            float* sky = &smooth[parts.skyChannels == 1 ? 0 : shown][s * n];
            float* sun = &result.sun[beams_ == 1 ? 0 : shown][s];
            for (size_t i = 0; i < n; ++i) {
                const float received = seen[i] + later[i];
                // What falls on clear interior glass goes straight on and is counted where it lands.
                sky[i] += share * (clear_[i] ? rho[i] * received
                                             : area_[i] * (sent.sent[at + i] + sent.more[at + i]));
                sun[i * result.sensors] += share * rho[i] * (even[i] + area_[i] * sent.even[at + i]);
                own +=
                    static_cast<double>(share * received * mesh.materials[mesh.material[i]].exitance[axis]);
            }
            own += static_cast<double>(share * near.own[axis]);
            size_t row = n;
            for (const GlowingBlinds::Group& group : parts.blinds.groups())
                for (const uint32_t i : group.patches)
                    sun[row++ * result.sensors] += share * (seen[i] + later[i]);
        }
    }
    result.own[s] = static_cast<float>(own);
}

// The sky by way of patches.
void SensorResponder::addSky(const TransportParts& parts, const Smooth& smooth,
                             SensorResponses& result) const {
    const size_t n = area_.size(), sensors = result.sensors, elements = parts.skyElements,
                 channels = parts.skyChannels;
    result.sky.assign(sensors * elements, 0);
    std::vector<float> reflected(sensors * elements);
    for (size_t c = 0; c < channels && elements > 0; ++c) {
        Panels coefficients(n, elements);
        for (size_t i = 0; i < n; ++i)
            for (size_t e = 0; e < elements; ++e)
                coefficients.at(i, e) = parts.patchSky[(i * channels + c) * elements + e];
        multiply(smooth[c], sensors, coefficients, reflected);
        for (size_t k = 0; k < reflected.size(); ++k) result.sky[k] += reflected[k];
    }
    const size_t row = GlowRows(parts, n).smooth;
    for (size_t b = 0; b < beams_; ++b)
        inParallel(n, [&](size_t i) {
            for (size_t s = 0; s < sensors; ++s)
                result.sun[b][(row + i) * sensors + s] = smooth[b][s * n + i];
        });
}

void SensorResponder::addLobes(const TransportParts& parts, const Smooth& smooth,
                               SensorResponses& result) const {
    if (parts.slats.empty()) return;
    const size_t n = transport_.mesh().patchCount(), sensors = result.sensors;
    const GlowRows rows(parts, n);
    for (size_t b = 0; b < beams_; ++b) {
        std::vector<float>& answers = result.sun[b];
        inParallel(sensors, [&](size_t s) {
            for (size_t i = 0; i < n; ++i)
                for (const SlatLobes::Share& share : parts.slats.of(i))
                    answers[(rows.lobes + share.row) * sensors + s] += smooth[b][s * n + i] * share.factor;
            for (size_t shown = 0; shown < 3; ++shown) {
                if (beams_ == 3 && shown != b) continue;
                const auto& own = parts.sensorSlats[s][b];
                const auto& near = parts.near[s].slats[parts.channels == 1 ? 0 : shown];
                const auto luminous =
                    static_cast<float>(geometry::kLuminance[static_cast<glm::length_t>(shown)]);
                for (size_t row = 0; row < own.size(); ++row)
                    answers[(rows.lobes + row) * sensors + s] +=
                        luminous * (own[row] + (near.empty() ? 0 : near[row]));
            }
            for (size_t row = 0; row < parts.slats.rows(); ++row)
                answers[(rows.groupLobes +
                         parts.slats.windows()[row / daylight::kSlatLobes].group * daylight::kSlatLobes +
                         row % daylight::kSlatLobes) *
                            sensors +
                        s] += answers[(rows.lobes + row) * sensors + s];
        });
    }
}

// The sky's part of what blinds scatter.
void SensorResponder::addGlow(const TransportParts& parts, SensorResponses& result) const {
    const size_t elements = parts.skyElements, sensors = result.sensors;
    const GlowRows rows(parts, transport_.mesh().patchCount());
    size_t slot = rows.glow;
    for (size_t g = 0; g < parts.blinds.groups().size() && elements > 0; ++g) {
        const size_t count = parts.blinds.groups()[g].patches.size();
        const std::vector<float> coefficients = parts.blinds.coefficients(g, parts.sky, parts.skyChannels);
        for (size_t b = 0; b < beams_; ++b)
            for (size_t s = 0; s < sensors; ++s) {
                float answer = 0;
                for (size_t k = slot; k < slot + count; ++k) answer += result.sun[b][k * sensors + s];
                for (size_t e = 0; e < elements; ++e)
                    result.sky[s * elements + e] += answer * coefficients[b * elements + e];
            }
        slot += count;
        if (!parts.blinds.groups()[g].window.hasSlats()) continue;
        const std::vector<float> lobes = parts.blinds.lobeCoefficients(g, parts.sky, parts.skyChannels);
        for (size_t lobe = 0; lobe < daylight::kSlatLobes; ++lobe)
            for (size_t b = 0; b < beams_; ++b)
                inParallel(sensors, [&](size_t s) {
                    const float answer =
                        result.sun[b][(rows.groupLobes + g * daylight::kSlatLobes + lobe) * sensors + s];
                    for (size_t e = 0; e < elements; ++e)
                        result.sky[s * elements + e] +=
                            answer * lobes[(lobe * parts.skyChannels + b) * elements + e];
                });
    }
}

// What stands outside and is lit by the sky; what a sensor answers to any light on it.
void SensorResponder::addOutside(const TransportParts& parts, const Smooth& smooth,
                                 SensorResponses& result) const {
    const size_t n = area_.size(), sensors = result.sensors, elements = parts.skyElements,
                 cells = parts.reflection.cells().size();
    const GlowRows rows(parts, n);
    inParallel(cells > 0 ? sensors : 0, [&](size_t s) {
        for (size_t b = 0; b < beams_; ++b) {
            const auto axis = static_cast<int>(b);
            std::vector<float> answers(cells, 0);
            for (size_t i = 0; i < n; ++i)
                for (const OutsideShare& share : parts.patchWalls[i])
                    answers[share.cell] += smooth[b][s * n + i] * share.weight[axis];
            for (const OutsideOnBlinds::Patch& p : parts.outsideOnBlinds.patches())
                for (const OutsideShare& share : p.shares)
                    answers[share.cell] +=
                        result.sun[b][(rows.glow + p.row) * sensors + s] * share.weight[axis];
            const float luminous = beams_ == 3 ? static_cast<float>(geometry::kLuminance[axis]) : 1;
            for (const std::span<const OutsideShare> own :
                 {std::span(parts.sensorWalls[s]), std::span<const OutsideShare>(parts.near[s].walls)})
                for (const OutsideShare& share : own)
                    answers[share.cell] += beams_ == 3 ? luminous * share.weight[axis]
                                                       : static_cast<float>(photometric(share.weight));
            parts.reflection.answer(static_cast<uint32_t>(b), answers);
            for (size_t c = 0; c < cells; ++c) {
                result.sun[b][(rows.outside + c) * sensors + s] = answers[c];
                const std::span<const float> bySky = parts.reflection.bySky(c);
                const auto perLuminance = static_cast<float>(answers[c] / std::numbers::pi);
                for (size_t e = 0; e < elements; ++e) result.sky[s * elements + e] += perLuminance * bySky[e];
            }
        }
    });
}

// What the building hides before windows with blinds.
void SensorResponder::hideGlow(const TransportParts& parts, SensorResponses& result) const {
    const size_t elements = parts.skyElements, sensors = result.sensors;
    const GlowRows rows(parts, area_.size());
    inParallel(elements > 0 ? sensors : 0, [&](size_t s) {
        std::vector<float> seen(elements); // of one patch, were nothing hidden
        const auto see = [&](float answer, const float* coefficients) {
            for (size_t e = 0; e < elements; ++e) seen[e] += answer * coefficients[e];
        };
        for (const HiddenSky::Patch& p : parts.hiddenSky.patches()) {
            std::ranges::fill(seen, 0.0f);
            for (size_t b = 0; b < beams_; ++b) {
                const float* answers = &result.sun[b][s];
                see(answers[(rows.glow + p.row) * sensors],
                    &parts.hiddenSky.coefficients(p.group)[b * elements]);
                if (!parts.blinds.groups()[p.group].window.hasSlats()) continue;
                const std::vector<float>& lobes = parts.hiddenSky.lobeCoefficients(p.group);
                for (size_t lobe = 0; lobe < daylight::kSlatLobes; ++lobe)
                    see(answers[(rows.lobes + p.slats * daylight::kSlatLobes + lobe) * sensors],
                        &lobes[(lobe * 3 + b) * elements]);
            }
            for (size_t e = 0; e < elements; ++e) result.sky[s * elements + e] -= p.hidden[e] * seen[e];
        }
    });
}

} // namespace heliodon::compute
