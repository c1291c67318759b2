#include "compute/annual_daylight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "compute/glow_rows.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"

namespace heliodon::compute {

namespace {

constexpr std::array<double, 3> kLuminous{0.2126, 0.7152, 0.0722};
constexpr size_t kColumnsAtOnce = 48;     // right-hand sides that share passes over F
constexpr size_t kMostHostPatches = 8000; // 256 MB of form factors once more
constexpr size_t kCheckedSunless = 3, kCheckedSunny = 6;
// Work in about milliseconds, for the bar, measured on 40 to 400 sensors, 600 to 2000 patches, whole and half
// hours: an hour's sky, its sun; of a sensor what it answers, by patches, and its products, by hours with
// light.
constexpr double kSkyWork = 0.5, kSunWork = 0.8, kAnswerWork = 5e-3, kProductWork = 4e-4;

// A sensor's row in one channel, with what tinted panes make of it and what the walls beside it add; `near`
// is empty without any.
std::vector<float> rowWith(std::span<const float> row, std::span<const TintedShare> tinted, size_t channel,
                           const std::vector<float>& near) {
    std::vector<float> sum(row.begin(), row.end());
    for (const TintedShare& share : tinted) sum[share.patch] += share.more[static_cast<int>(channel)];
    for (size_t i = 0; i < near.size(); ++i) sum[i] += near[i];
    return sum;
}

// `wanted` entries spread evenly over `all`.
template<class T> std::vector<T> spread(const std::vector<T>& all, size_t wanted) {
    std::vector<T> some;
    const size_t count = std::min(wanted, all.size());
    for (size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
    return some;
}

} // namespace

// What the sensors at hand answer to sky elements, to sun on patches and to the room's own emission.
struct AnnualDaylight::Responses {
    size_t sensors = 0;
    std::vector<float> sky; // sensors x elements, photometric
    // Rows x sensors, each times its channel's luminous share; one unless tinted
    std::vector<float> sun[3];
    std::vector<float> own; // per sensor, lux
    // Per channel of the sky, sensors x patches: importance of what falls on patches like the sky, smoothly.
    // Empty once it is part of `sky` and `sun`.
    std::vector<float> smooth[3];

    // What light on one row gives, added to one value a sensor.
    void add(size_t row, glm::vec3 lux, float* to) const {
        for (int b = 0; b < 3 && !sun[b].empty(); ++b) {
            const float *answer = &sun[b][row * sensors], times = lux[b];
            for (size_t s = 0; s < sensors; ++s) to[s] += times * answer[s];
        }
    }
};

// What sensors send into the room: a column for each and for each channel.
struct AnnualDaylight::Importance {
    size_t first = 0, count = 0;   // sensors
    std::vector<float> sent, once; // reflected where sensors look, and what of that falls on patches
    std::vector<float> more, rest; // exitance and gathered light of all that follows
};

AnnualDaylight::AnnualDaylight(DaylightTransport& transport, std::vector<daylight::Sky> skies,
                               size_t sensorCount, Tell told, size_t sunBytes)
    : transport_(transport), skies_(std::move(skies)), sensorCount_(sensorCount), tell_(std::move(told)),
      tinted_(transport.parts().skyChannels == 3) {
    const TransportParts parts = transport_.parts();
    const geometry::PatchMesh& mesh = transport_.mesh();
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        area_.push_back(static_cast<float>(geometry::patchArea(mesh, i)));
        clear_.push_back(mesh.twin[i] != geometry::kNoTwin && isClear(mesh.materials[mesh.material[i]]));
    }
    suns_.emplace(parts, mesh, skies_, sunBytes, [this](size_t hours) {
        sunDone_ += kSunWork * static_cast<double>(hours);
        tell(kSunWork * static_cast<double>(hours));
    });
    sunWork_ = kSunWork * static_cast<double>(suns_->sunny());
    makeSkies(parts);
    report_.hours = skies_.size();
    report_.lit = lit_.size();
    report_.sunless = static_cast<size_t>(
        std::ranges::count_if(lit_, [&](uint32_t hour) { return !skies_[hour].hasSun(); }));
}

double AnnualDaylight::answerWork() const {
    return kAnswerWork * static_cast<double>(area_.size());
}

// Where the hours' sun is not kept, all but its last block is made again in each call that is still to come,
// taken to be of as many sensors as the last.
void AnnualDaylight::foreseeSun(size_t sensors) {
    const size_t left = sensorCount_ - std::min(sensorsDone_, sensorCount_),
                 calls = (left + sensors - 1) / sensors;
    const auto blocks = static_cast<double>(std::max<size_t>(suns_->blocks(), 1));
    sunWork_ = sunDone_ + static_cast<double>(calls) * (1 - 1 / blocks) * kSunWork *
                              static_cast<double>(suns_->skies().size());
}

void AnnualDaylight::tell(double work) {
    if (!tell_) return;
    workDone_ += work;
    const auto lit = static_cast<double>(lit_.size());
    const double all =
        kSkyWork * lit + sunWork_ +
        (answerWork() + kProductWork * lit) * static_cast<double>(std::max<size_t>(sensorCount_, 1));
    tell_(std::min(1.0, workDone_ / all));
}

void AnnualDaylight::makeSkies(const TransportParts& parts) {
    const SecondsAdded clock(report_.skySeconds);
    if (parts.skyElements == 0) return;
    for (size_t h = 0; h < skies_.size(); ++h)
        if (skies_[h].formula.scale > 0 || skies_[h].ground.luminance > 0)
            lit_.push_back(static_cast<uint32_t>(h));
    luminance_ = Panels(parts.skyElements, lit_.size());
    size_t told = 0;
    inParallel(
        lit_.size(),
        [&](size_t k) {
            const std::vector<double> values = parts.sky.luminances(skies_[lit_[k]]);
            for (size_t e = 0; e < values.size(); ++e)
                luminance_.at(e, k) = static_cast<float>(std::numbers::pi * values[e]);
        },
        [&](size_t hours) {
            tell(kSkyWork * static_cast<double>(hours - told));
            told = hours;
        });
}

// Where F lies in the host's memory: sensors are many columns.
void AnnualDaylight::takeFactors(const TransportParts& parts) {
    const size_t n = transport_.mesh().patchCount();
    const float* values = transport_.formFactors().values.mapped<float>();
    if (gather_ || !values || n > kMostHostPatches) return;
    gather_.emplace(std::span(values, n * n), static_cast<uint32_t>(n));
    tintedGather_.emplace(*gather_, parts.links);
    solver_.emplace(*tintedGather_, parts.solver.rowSums());
    solver_->setMatter(parts.solver.matter());
}

AnnualDaylight::Responses AnnualDaylight::respond(const TransportParts& parts) {
    const size_t n = transport_.mesh().patchCount(), sensors = parts.sensors.size();
    Responses result;
    result.sensors = sensors;
    result.own.assign(sensors, 0);
    for (size_t b = 0; b < beams(); ++b) result.sun[b].assign(GlowRows(parts, n).all * sensors, 0);
    for (size_t c = 0; c < parts.skyChannels; ++c) result.smooth[c].assign(sensors * n, 0);
    takeFactors(parts);
    const size_t atOnce = std::max<size_t>(1, kColumnsAtOnce / parts.channels);
    for (size_t first = 0; first < sensors; first += atOnce) {
        const Importance sent = importanceOf(parts, first, std::min(atOnce, sensors - first));
        inParallel(sent.count, [&](size_t k) { addAnswers(parts, sent, k, result); });
        tell(answerWork() * static_cast<double>(sent.count));
    }
    addSky(parts, result);
    addNearSky(parts, result);
    addLobes(parts, result);
    addGlow(parts, result);
    hideGlow(parts, result);
    for (std::vector<float>& smooth : result.smooth) smooth = {};
    return result;
}

// The first bounce is taken apart: what remains to be solved is smooth, so that the solver's tolerance, a
// share of the largest value, is small everywhere.
AnnualDaylight::Importance AnnualDaylight::importanceOf(const TransportParts& parts, size_t first,
                                                        size_t count) {
    const size_t n = area_.size(), columns = count * parts.channels;
    FormFactorOperator& gather = gather_ ? *tintedGather_ : parts.gather;
    RadiositySolver& solver = solver_ ? *solver_ : parts.solver;
    const RadiosityMatter& matter = parts.solver.matter();
    Importance result{first, count, std::vector<float>(columns * n), std::vector<float>(columns * n), {}, {}};
    std::vector<float> twice(columns * n), perArea(n);
    std::vector<uint32_t> channel;
    for (size_t k = 0; k < columns; ++k) {
        const size_t s = first + k / parts.channels;
        channel.push_back(static_cast<uint32_t>(k % parts.channels));
        const std::vector<float> seen = rowWith(parts.sensorFactors.subspan(s * n, n), parts.tinted[s],
                                                channel[k], parts.near[s].smooth[channel[k]]);
        for (size_t i = 0; i < n; ++i) perArea[i] = seen[i] / area_[i];
        matter.reflect<float>(channel[k], perArea, {&result.sent[k * n], n});
    }
    gather.gatherIn(channel, result.sent, result.once);
    for (size_t k = 0; k < columns; ++k)
        matter.reflect<float>(channel[k], {&result.once[k * n], n}, {&twice[k * n], n});
    solver.solve(twice, channel, result.more, result.rest, {});
    return result;
}

// Of the k-th sensor of `sent`.
void AnnualDaylight::addAnswers(const TransportParts& parts, const Importance& sent, size_t k,
                                Responses& result) const {
    const geometry::PatchMesh& mesh = transport_.mesh();
    const size_t n = area_.size(), s = sent.first + k;
    const NearLight& near = parts.near[s];
    double own = 0;
    std::vector<float> later(n); // answer to what falls on patches, but for what the sensor sees itself
    for (size_t c = 0; c < parts.channels; ++c) {
        const auto seenRow = parts.sensorFactors.subspan(s * n, n),
                   evenRow = parts.sensorEven.subspan(s * n, n);
        const std::vector<float> seen = rowWith(seenRow, parts.tinted[s], c, near.smooth[c]),
                                 even = rowWith(evenRow, parts.tinted[s], c, near.even[c]);
        const std::vector<float>& rho = parts.solver.matter().reflectance[c];
        const size_t at = (k * parts.channels + c) * n;
        for (size_t i = 0; i < n; ++i) later[i] = area_[i] * (sent.once[at + i] + sent.rest[at + i]);
        // Grey stands for three.
        for (size_t shown = c; shown < (parts.channels == 1 ? 3 : c + 1); ++shown) {
            const auto axis = static_cast<int>(shown);
            const auto share = static_cast<float>(kLuminous[shown]);
            float* sky = &result.smooth[parts.skyChannels == 1 ? 0 : shown][s * n];
            float* sun = &result.sun[beams() == 1 ? 0 : shown][s];
            for (size_t i = 0; i < n; ++i) {
                const float received = seen[i] + later[i];
                // What falls on clear interior glass goes straight on and is counted where it lands.
                sky[i] += share * (clear_[i] ? rho[i] * received
                                             : area_[i] * (sent.sent[at + i] + sent.more[at + i]));
                sun[i * result.sensors] += share * rho[i] * (even[i] + later[i]);
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

// The sky by way of patches, and straight.
void AnnualDaylight::addSky(const TransportParts& parts, Responses& result) const {
    const size_t n = area_.size(), sensors = result.sensors, elements = parts.skyElements,
                 channels = parts.skyChannels;
    result.sky.assign(sensors * elements, 0);
    std::vector<float> reflected(sensors * elements);
    for (size_t c = 0; c < channels && elements > 0; ++c) {
        Panels coefficients(n, elements);
        for (size_t i = 0; i < n; ++i)
            for (size_t e = 0; e < elements; ++e)
                coefficients.at(i, e) = parts.patchSky[(i * channels + c) * elements + e];
        multiply(result.smooth[c], sensors, coefficients, reflected);
        const auto share = static_cast<float>(channels == 1 ? 1.0 : kLuminous[c]);
        for (size_t s = 0; s < sensors; ++s)
            for (size_t e = 0; e < elements; ++e)
                result.sky[s * elements + e] +=
                    reflected[s * elements + e] + share * parts.sensorSky[(s * channels + c) * elements + e];
    }
    const size_t smooth = GlowRows(parts, n).smooth;
    for (size_t b = 0; b < beams(); ++b)
        inParallel(n, [&](size_t i) {
            for (size_t s = 0; s < sensors; ++s)
                result.sun[b][(smooth + i) * sensors + s] = result.smooth[b][s * n + i];
        });
}

// The sky by way of walls beside the sensor.
void AnnualDaylight::addNearSky(const TransportParts& parts, Responses& responses) const {
    const size_t elements = parts.skyElements;
    inParallel(elements > 0 ? responses.sensors : 0, [&](size_t s) {
        for (const SkySample& sample : parts.near[s].sky)
            responses.sky[s * elements + parts.sky.elementOf(glm::dvec3(sample.direction))] +=
                static_cast<float>(photometric(sample.weight) / std::numbers::pi);
    });
}

void AnnualDaylight::addLobes(const TransportParts& parts, Responses& responses) const {
    if (parts.slats.empty()) return;
    const size_t n = transport_.mesh().patchCount(), sensors = responses.sensors;
    const GlowRows rows(parts, n);
    for (size_t b = 0; b < beams(); ++b) {
        std::vector<float>& answers = responses.sun[b];
        inParallel(sensors, [&](size_t s) {
            for (size_t i = 0; i < n; ++i)
                for (const SlatLobes::Share& share : parts.slats.of(i))
                    answers[(rows.lobes + share.row) * sensors + s] +=
                        responses.smooth[b][s * n + i] * share.factor;
            for (size_t shown = 0; shown < 3; ++shown) {
                if (tinted_ && shown != b) continue;
                const auto& own = parts.sensorSlats[s][tinted_ ? b : 0];
                const auto& near = parts.near[s].slats[parts.channels == 1 ? 0 : shown];
                const auto luminous = static_cast<float>(kLuminous[shown]);
                for (size_t row = 0; row < own.size(); ++row)
                    answers[(rows.lobes + row) * sensors + s] +=
                        luminous * (own[row] + (near.empty() ? 0 : near[row]));
            }
            for (size_t row = 0; row < parts.slats.rows(); ++row)
                answers[(rows.groupLobes +
                         parts.slats.windows()[row / daylight::kSlatNodes].group * daylight::kSlatNodes +
                         row % daylight::kSlatNodes) *
                            sensors +
                        s] += answers[(rows.lobes + row) * sensors + s];
        });
    }
}

// The sky's part of what blinds scatter.
void AnnualDaylight::addGlow(const TransportParts& parts, Responses& responses) const {
    const size_t elements = parts.skyElements, sensors = responses.sensors;
    const GlowRows rows(parts, transport_.mesh().patchCount());
    size_t slot = rows.glow;
    for (size_t g = 0; g < parts.blinds.groups().size() && elements > 0; ++g) {
        const size_t count = parts.blinds.groups()[g].patches.size();
        const std::vector<float> coefficients = parts.blinds.coefficients(g, parts.sky, parts.skyChannels);
        for (size_t b = 0; b < beams(); ++b)
            for (size_t s = 0; s < sensors; ++s) {
                float answer = 0;
                for (size_t k = slot; k < slot + count; ++k) answer += responses.sun[b][k * sensors + s];
                for (size_t e = 0; e < elements; ++e)
                    responses.sky[s * elements + e] += answer * coefficients[b * elements + e];
            }
        slot += count;
        if (!parts.blinds.groups()[g].window.hasSlats()) continue;
        const std::vector<float> lobes = parts.blinds.lobeCoefficients(g, parts.sky, parts.skyChannels);
        for (size_t node = 0; node < daylight::kSlatNodes; ++node)
            for (size_t b = 0; b < beams(); ++b)
                inParallel(sensors, [&](size_t s) {
                    const float answer =
                        responses.sun[b][(rows.groupLobes + g * daylight::kSlatNodes + node) * sensors + s];
                    for (size_t e = 0; e < elements; ++e)
                        responses.sky[s * elements + e] +=
                            answer * lobes[(node * parts.skyChannels + b) * elements + e];
                });
    }
}

// What the building hides before windows with blinds.
void AnnualDaylight::hideGlow(const TransportParts& parts, Responses& responses) const {
    const size_t elements = parts.skyElements, sensors = responses.sensors;
    const GlowRows rows(parts, area_.size());
    inParallel(elements > 0 ? sensors : 0, [&](size_t s) {
        std::vector<float> seen(elements); // of one patch, were nothing hidden
        const auto see = [&](float answer, const float* coefficients) {
            for (size_t e = 0; e < elements; ++e) seen[e] += answer * coefficients[e];
        };
        for (const HiddenSky::Patch& p : parts.hiddenSky.patches()) {
            std::ranges::fill(seen, 0.0f);
            for (size_t b = 0; b < beams(); ++b) {
                const float* answers = &responses.sun[b][s];
                see(answers[(rows.glow + p.row) * sensors],
                    &parts.hiddenSky.coefficients(p.group)[b * elements]);
                if (!parts.blinds.groups()[p.group].window.hasSlats()) continue;
                const std::vector<float>& lobes = parts.hiddenSky.lobeCoefficients(p.group);
                for (size_t node = 0; node < daylight::kSlatNodes; ++node)
                    see(answers[(rows.lobes + p.slats * daylight::kSlatNodes + node) * sensors],
                        &lobes[(node * 3 + b) * elements]);
            }
            for (size_t e = 0; e < elements; ++e) responses.sky[s * elements + e] -= p.hidden[e] * seen[e];
        }
    });
}

// reflected: hours with sun x sensors.
void AnnualDaylight::addSun(const SunHours::Block& block, const TransportParts& parts,
                            const Responses& responses, std::span<float> reflected) const {
    const size_t sensors = responses.sensors;
    const GlowRows rows(parts, transport_.mesh().patchCount());
    inParallel(block.hours.size(), [&](size_t k) {
        float* row = &reflected[(block.first + k) * sensors];
        for (const SunHours::Lit& lit : block.hours[k].patches) responses.add(lit.row, lit.lux, row);
        for (const SunHours::Lit& lit : block.hours[k].bounced)
            responses.add(rows.smooth + lit.row, lit.lux, row);
        addBlinds(block.hours[k], parts, responses, row);
    });
}

// What blinds scatter of one hour's sun. Windows of a group that it shines on alike, all unless something
// shades them, are told as one.
void AnnualDaylight::addBlinds(const SunHours::Hour& hour, const TransportParts& parts,
                               const Responses& responses, float* reflected) const {
    if (hour.windows.empty()) return;
    const GlowRows rows(parts, transport_.mesh().patchCount());
    auto lit = hour.windows.begin();
    size_t window = 0, slats = 0; // rows of blinds, and of those with slats, before this group's
    for (size_t g = 0; g < parts.blinds.groups().size(); ++g) {
        const GlowingBlinds::Group& group = parts.blinds.groups()[g];
        const size_t count = group.patches.size();
        const auto last = std::find_if(lit, hour.windows.end(),
                                       [&](const SunHours::Lit& l) { return l.row >= window + count; });
        const auto& [even, lobes] = hour.groups[g];
        for (auto l = lit; l != last; ++l) responses.add(rows.glow + l->row, even * l->lux, reflected);
        if (group.window.hasSlats() && lit != last) {
            const auto add = [&](size_t row, glm::vec3 lux) {
                for (size_t node = 0; node < daylight::kSlatNodes; ++node)
                    responses.add(row + node, lux * lobes[node], reflected);
            };
            const glm::vec3 one = lit->lux;
            if (static_cast<size_t>(last - lit) == count &&
                std::all_of(lit, last, [&](const SunHours::Lit& l) {
                    return glm::length(l.lux - one) <= 1e-6F * glm::length(one);
                }))
                add(rows.groupLobes + g * daylight::kSlatNodes, one);
            else
                for (auto l = lit; l != last; ++l)
                    add(rows.lobes + (slats + l->row - window) * daylight::kSlatNodes, l->lux);
        }
        if (group.window.hasSlats()) slats += count;
        window += count;
        lit = last;
    }
}

void AnnualDaylight::addEdges(const SunHours::Block& block, const TransportParts& parts,
                              std::span<float> reflected) const {
    const size_t n = transport_.mesh().patchCount(), count = parts.sensors.size();
    inParallel(count, [&](size_t s) {
        const uint32_t room = parts.sensorRooms[s];
        if (room == geometry::kNoRoom) return;
        const Sensor& at = parts.sensors[s];
        std::vector<float> more(block.hours.size(), 0);
        block.edges.addTo(more, parts.points,
                          PointView(parts.points.blockers(), at.position, at.normal, room), room,
                          &parts.sensorEven[s * n]);
        block.edges.addTo(more, parts.points, parts.near[s], room);
        for (size_t k = 0; k < more.size(); ++k) reflected[(block.first + k) * count + s] += more[k];
    });
}

// Sun straight at the sensors: sensors x hours.
void AnnualDaylight::addBeams(std::span<const Sensor> sensors, std::span<float> sun) const {
    const SunScene& panes = transport_.parts().sun;
    const std::span<const uint32_t> hours = suns_->skies();
    inParallel(hours.size(), [&](size_t k) {
        const daylight::Sky& sky = skies_[hours[k]];
        const SunPatches beam(panes, sky.sun.direction);
        for (size_t s = 0; s < sensors.size(); ++s)
            sun[s * skies_.size() + hours[k]] = static_cast<float>(
                sky.sun.normalIlluminance *
                photometric(beam.atPoint(sensors[s].position, glm::normalize(sensors[s].normal))));
    });
}

void AnnualDaylight::sensors(std::span<const Sensor> sensors, std::span<float> lux, std::span<float> sun,
                             std::span<float> error) {
    const size_t count = sensors.size(), hours = skies_.size();
    if (lux.size() != count * hours || sun.size() != lux.size() || error.size() != lux.size())
        throw std::invalid_argument("AnnualDaylight: arrays are not sensors x hours");
    if (lux.empty()) return;
    Responses responses;
    {
        const SecondsAdded clock(report_.sensorSeconds);
        transport_.setSensors({sensors.begin(), sensors.end()});
        responses = respond(transport_.parts());
    }
    const std::vector<float> reflected = sunOf(responses);
    {
        const SecondsAdded clock(report_.productSeconds);
        std::vector<float> sky(count * lit_.size());
        multiply(responses.sky, count, luminance_, sky);
        std::fill(sun.begin(), sun.end(), 0.0f);
        addBeams(sensors, sun);
        inParallel(count, [&](size_t s) {
            float* row = &lux[s * hours];
            std::fill_n(row, hours, responses.own[s]);
            for (size_t k = 0; k < lit_.size(); ++k) row[lit_[k]] += sky[s * lit_.size() + k];
            // Until errors are set below, `error` holds the part that the sun causes.
            std::fill_n(&error[s * hours], hours, 0.0f);
            const std::span<const uint32_t> sunny = suns_->skies();
            for (size_t k = 0; k < sunny.size(); ++k) {
                const size_t at = s * hours + sunny[k];
                error[at] = reflected[k * count + s] + sun[at];
                lux[at] += error[at];
            }
        });
    }
    reportOf(responses, lux.size());
    checkAndSetErrors(lux, sun, error);
    sensorsDone_ += count;
    foreseeSun(count);
    tell(kProductWork * static_cast<double>(lit_.size() * count));
}

// The sun by way of patches: hours whose sun enters x sensors.
std::vector<float> AnnualDaylight::sunOf(const Responses& responses) {
    const TransportParts parts = transport_.parts();
    std::vector<float> reflected;
    suns_->forBlocks([&](const SunHours::Block& block) {
        const SecondsAdded clock(report_.productSeconds);
        reflected.resize(std::max(reflected.size(), (block.first + block.hours.size()) * responses.sensors));
        addSun(block, parts, responses, reflected);
        addEdges(block, parts, reflected);
    });
    return reflected;
}

void AnnualDaylight::reportOf(const Responses& responses, size_t values) {
    report_.withSun = suns_->skies().size();
    report_.sunOutside = suns_->sunny() - report_.withSun;
    report_.sunlitPatches = suns_->litPatches();
    report_.sunBlocks = suns_->blocks();
    report_.sunBytes = suns_->mostBytes();
    report_.sunSeconds = suns_->seconds();
    size_t nearWalls = 0;
    for (const NearLight& near : transport_.parts().near) nearWalls += near.bytes();
    const size_t count = responses.sensors;
    size_t floats = count * (lit_.size() + report_.withSun) + responses.sky.size() + 3 * values;
    for (const std::vector<float>& rows : responses.sun) // and about as many importances of the sky
        floats += rows.size() + (rows.empty() ? 0 : count * area_.size());
    report_.bytes = std::max(report_.bytes, luminance_.bytes() + (gather_ ? gather_->bytes() : 0) +
                                                report_.sunBytes + nearWalls + sizeof(float) * floats);
}

// Sunless ones first.
std::vector<uint32_t> AnnualDaylight::checkedHours(size_t& sunless) const {
    const std::vector<uint32_t> sunny(suns_->skies().begin(), suns_->skies().end());
    std::vector<uint32_t> others;
    std::set_difference(lit_.begin(), lit_.end(), sunny.begin(), sunny.end(), std::back_inserter(others));
    std::vector<uint32_t> hours = spread(others, kCheckedSunless);
    sunless = hours.size();
    for (uint32_t h : spread(sunny, kCheckedSunny)) hours.push_back(h);
    return hours;
}

// The transport states an error for each illuminance that it solves. Per sensor, its share of sky light (the
// largest of the checked hours that no sun enters in, or where there are none, of all) and of what the sun
// adds (their mean, weighed by light) is taken for all hours.
void AnnualDaylight::checkAndSetErrors(std::span<const float> lux, std::span<const float> sun,
                                       std::span<float> error) {
    const SecondsAdded clock(report_.checkSeconds);
    const size_t hours = skies_.size(), count = hours ? lux.size() / hours : 0;
    size_t sunless = 0;
    const std::vector<uint32_t> checked = checkedHours(sunless);
    std::vector<daylight::Sky> skies;
    for (uint32_t h : checked) skies.push_back(skies_[h]);
    const std::vector<Moment> moments = transport_.light(skies);
    report_.checkedHours = checked.size();
    for (size_t s = 0; s < count; ++s) {
        double ofSky = 0, sunError = 0, sunLight = 0;
        for (size_t k = 0; k < checked.size(); ++k) {
            const LightParts& full = moments[k].sensors[s];
            const double there = photometric(full.total()), here = lux[s * hours + checked[k]];
            const double bySun = error[s * hours + checked[k]];
            const double mistake = static_cast<double>(full.error) + std::abs(here - there);
            // Light of the sun's beam at the sensor itself is exact in both and would hide a difference.
            const double indirect = there - photometric(full.sun);
            if (indirect > 0) {
                const double difference = (here - sun[s * hours + checked[k]]) / indirect - 1;
                checkSquares_ += difference * difference;
                ++checkCount_;
            }
            if (k < sunless || sunless == 0) ofSky = std::max(ofSky, there > 0 ? mistake / there : 0.0);
            if (k >= sunless) sunError += std::max(0.0, mistake - ofSky * (here - bySun)), sunLight += bySun;
        }
        const double ofSun = sunLight > 0 ? sunError / sunLight : 0;
        for (size_t h = 0; h < hours; ++h) {
            const size_t at = s * hours + h;
            error[at] = static_cast<float>(ofSky * static_cast<double>(lux[at] - error[at]) +
                                           ofSun * static_cast<double>(error[at]));
        }
    }
    report_.checkRms = checkCount_ > 0 ? std::sqrt(checkSquares_ / checkCount_) : 0;
}

} // namespace heliodon::compute
