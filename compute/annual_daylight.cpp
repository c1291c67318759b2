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
// Work of an hour with sun and of a sensor, whose responses are the largest part, for the bar: measured on 78
// to 400 sensors.
constexpr double kHourWork = 1.0, kSensorWork = 4.0, kResponseShare = 0.8;

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

    // What light on one row gives, added to one value a sensor.
    void add(size_t row, glm::vec3 lux, float* to) const {
        for (int b = 0; b < 3 && !sun[b].empty(); ++b) {
            const float *answer = &sun[b][row * sensors], times = lux[b];
            for (size_t s = 0; s < sensors; ++s) to[s] += times * answer[s];
        }
    }
};

AnnualDaylight::AnnualDaylight(DaylightTransport& transport, std::vector<daylight::Sky> skies,
                               size_t sensorCount, Tell tell, size_t sunBytes)
    : transport_(transport), skies_(std::move(skies)), sensorCount_(sensorCount), tell_(std::move(tell)),
      tinted_(transport.parts().skyChannels == 3) {
    report_.hours = skies_.size();
    makeSkies();
    makeSuns(sunBytes);
}

void AnnualDaylight::told(size_t hours, double sensors) const {
    if (!tell_) return;
    const auto work = [](size_t h, double s) { return kHourWork * static_cast<double>(h) + kSensorWork * s; };
    tell_(work(hours, sensors) / work(sunHours_, static_cast<double>(std::max<size_t>(sensorCount_, 1))));
}

void AnnualDaylight::makeSkies() {
    const SecondsAdded clock(report_.skySeconds);
    const TransportParts parts = transport_.parts();
    if (parts.skyElements == 0) return;
    for (size_t h = 0; h < skies_.size(); ++h)
        if (skies_[h].formula.scale > 0 || skies_[h].ground.luminance > 0)
            lit_.push_back(static_cast<uint32_t>(h));
    report_.lit = lit_.size();
    luminance_ = Panels(parts.skyElements, lit_.size());
    inParallel(lit_.size(), [&](size_t k) {
        const std::vector<double> values = parts.sky.luminances(skies_[lit_[k]]);
        for (size_t e = 0; e < values.size(); ++e)
            luminance_.at(e, k) = static_cast<float>(std::numbers::pi * values[e]);
    });
}

void AnnualDaylight::makeSuns(size_t sunBytes) {
    const SecondsAdded clock(report_.sunSeconds);
    const auto sunny = static_cast<size_t>(
        std::count_if(skies_.begin(), skies_.end(), [](const daylight::Sky& sky) { return sky.hasSun(); }));
    report_.sunless =
        lit_.size() - static_cast<size_t>(std::count_if(lit_.begin(), lit_.end(),
                                                        [&](uint32_t h) { return skies_[h].hasSun(); }));
    const TransportParts parts = transport_.parts();
    if (parts.skyElements > 0) sunHours_ = sunny;
    suns_.emplace(parts, transport_.mesh(), skies_, sunBytes, [&](size_t hours) { told(hours, 0); });
    report_.sunlitPatches = suns_->litPatches();
    report_.sunBlocks = suns_->blocks();
    report_.sunBytes = suns_->mostBytes();
    report_.withSun = suns_->skies().size();
    report_.sunOutside = sunHours_ - report_.withSun;
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
    const geometry::PatchMesh& mesh = transport_.mesh();
    const size_t n = mesh.patchCount(), sensors = parts.sensors.size(), channels = parts.channels;
    const size_t beams = tinted_ ? 3 : 1;
    Responses result;
    result.sensors = sensors;
    result.own.assign(sensors, 0);
    std::vector<uint32_t> glowing; // patches of blinds, in the order of their groups
    for (const GlowingBlinds::Group& group : parts.blinds.groups())
        glowing.insert(glowing.end(), group.patches.begin(), group.patches.end());
    for (size_t b = 0; b < beams; ++b) result.sun[b].assign(GlowRows(parts, n).all * sensors, 0);
    const size_t skies = parts.skyChannels;
    std::vector<float> weights[3]; // sensors x patches: importance of what falls on patches from the sky
    for (size_t c = 0; c < skies; ++c) weights[c].assign(sensors * n, 0);
    takeFactors(parts);
    FormFactorOperator& gather = gather_ ? *tintedGather_ : parts.gather;
    RadiositySolver& solver = solver_ ? *solver_ : parts.solver;
    const RadiosityMatter& matter = parts.solver.matter();
    std::vector<float> area(n);
    std::vector<uint8_t> clear(n);
    for (size_t i = 0; i < n; ++i) {
        area[i] = static_cast<float>(geometry::patchArea(mesh, i));
        clear[i] = mesh.twin[i] != geometry::kNoTwin && isClear(mesh.materials[mesh.material[i]]);
    }

    const size_t atOnce = std::max<size_t>(1, kColumnsAtOnce / channels);
    for (size_t first = 0; first < sensors; first += atOnce) {
        const size_t count = std::min(atOnce, sensors - first), columns = count * channels;
        std::vector<float> sent(columns * n), once(columns * n), twice(columns * n), perArea(n);
        std::vector<uint32_t> channel;
        for (size_t s = 0; s < count; ++s) {
            for (uint32_t c = 0; c < channels; ++c) {
                const std::vector<float> seen =
                    rowWith(parts.sensorFactors.subspan((first + s) * n, n), parts.tinted[first + s], c,
                            parts.near[first + s].smooth[c]);
                for (size_t i = 0; i < n; ++i) perArea[i] = seen[i] / area[i];
                matter.reflect<float>(c, perArea, {&sent[(s * channels + c) * n], n});
                channel.push_back(c);
            }
        }
        // The first bounce apart: what remains to be solved is smooth, so that the solver's tolerance, a
        // share of the largest value, is small everywhere.
        gather.gatherIn(channel, sent, once);
        for (size_t k = 0; k < columns; ++k)
            matter.reflect<float>(channel[k], {&once[k * n], n}, {&twice[k * n], n});
        std::vector<float> importance, rest;
        solver.solve(twice, channel, importance, rest, {});

        inParallel(count, [&](size_t s) {
            double own = 0;
            for (size_t c = 0; c < channels; ++c) {
                const NearLight& near = parts.near[first + s];
                const auto& tinted = parts.tinted[first + s];
                const std::vector<float> seen = rowWith(parts.sensorFactors.subspan((first + s) * n, n),
                                                        tinted, c, near.smooth[c]),
                                         even = rowWith(parts.sensorEven.subspan((first + s) * n, n), tinted,
                                                        c, near.even[c]);
                const size_t at = (s * channels + c) * n;
                for (size_t shown = c; shown < (channels == 1 ? 3 : c + 1); ++shown) {
                    const auto share = static_cast<float>(kLuminous[shown]);
                    float* sky = &weights[skies == 1 ? 0 : shown][(first + s) * n];
                    float* sun = &result.sun[beams == 1 ? 0 : shown][first + s];
                    for (size_t i = 0; i < n; ++i) {
                        const float later = area[i] * (once[at + i] + rest[at + i]),
                                    received = seen[i] + later;
                        // What falls on clear interior glass goes straight on and is counted where it lands.
                        sky[i] += share * (clear[i] ? matter.reflectance[c][i] * received
                                                    : area[i] * (sent[at + i] + importance[at + i]));
                        sun[i * sensors] += share * matter.reflectance[c][i] * (even[i] + later);
                        own += static_cast<double>(
                            share * received *
                            mesh.materials[mesh.material[i]].exitance[static_cast<int>(shown)]);
                    }
                    own += static_cast<double>(share * near.own[static_cast<int>(shown)]);
                    for (size_t k = 0; k < glowing.size(); ++k) {
                        const size_t i = glowing[k];
                        sun[(n + k) * sensors] += share * (seen[i] + area[i] * (once[at + i] + rest[at + i]));
                    }
                }
            }
            result.own[first + s] = static_cast<float>(own);
        });
        told(sunHours_, kResponseShare * static_cast<double>(sensorsDone_ + first + count));
    }

    const size_t elements = parts.skyElements;
    result.sky.assign(sensors * elements, 0);
    std::vector<float> reflected(sensors * elements);
    for (size_t c = 0; c < skies && elements > 0; ++c) {
        Panels coefficients(n, elements);
        for (size_t i = 0; i < n; ++i)
            for (size_t e = 0; e < elements; ++e)
                coefficients.at(i, e) = parts.patchSky[(i * skies + c) * elements + e];
        multiply(weights[c], sensors, coefficients, reflected);
        const auto share = static_cast<float>(skies == 1 ? 1.0 : kLuminous[c]);
        for (size_t s = 0; s < sensors; ++s)
            for (size_t e = 0; e < elements; ++e)
                result.sky[s * elements + e] +=
                    reflected[s * elements + e] + share * parts.sensorSky[(s * skies + c) * elements + e];
    }
    const size_t smooth = GlowRows(parts, n).smooth;
    for (size_t b = 0; b < beams; ++b)
        inParallel(n, [&](size_t i) {
            for (size_t s = 0; s < sensors; ++s)
                result.sun[b][(smooth + i) * sensors + s] = weights[b][s * n + i];
        });
    addNearSky(parts, result);
    addLobes(parts, weights, result);
    addGlow(parts, result);
    return result;
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

// `weights`: per channel of the sky, sensors x patches: importance of what falls on patches, like the sky,
// not evenly.
void AnnualDaylight::addLobes(const TransportParts& parts, std::span<const std::vector<float>> weights,
                              Responses& responses) const {
    if (parts.slats.empty()) return;
    const size_t n = transport_.mesh().patchCount(), sensors = responses.sensors;
    const GlowRows rows(parts, n);
    for (size_t b = 0; b < (tinted_ ? 3u : 1u); ++b) {
        std::vector<float>& answers = responses.sun[b];
        inParallel(sensors, [&](size_t s) {
            for (size_t i = 0; i < n; ++i)
                for (const SlatLobes::Share& share : parts.slats.of(i))
                    answers[(rows.lobes + share.row) * sensors + s] += weights[b][s * n + i] * share.factor;
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
        for (size_t b = 0; b < (tinted_ ? 3u : 1u); ++b)
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
            for (size_t b = 0; b < (tinted_ ? 3u : 1u); ++b)
                inParallel(sensors, [&](size_t s) {
                    const float answer =
                        responses.sun[b][(rows.groupLobes + g * daylight::kSlatNodes + node) * sensors + s];
                    for (size_t e = 0; e < elements; ++e)
                        responses.sky[s * elements + e] +=
                            answer * lobes[(node * parts.skyChannels + b) * elements + e];
                });
    }
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
    Responses responses;
    std::vector<float> sky(count * lit_.size()), reflected(count * suns_->skies().size());
    if (lux.empty()) return;
    {
        const SecondsAdded clock(report_.sensorSeconds);
        transport_.setSensors({sensors.begin(), sensors.end()});
        responses = respond(transport_.parts());
    }
    {
        const SecondsAdded clock(report_.productSeconds);
        multiply(responses.sky, count, luminance_, sky);
        const TransportParts parts = transport_.parts();
        suns_->forBlocks([&](const SunHours::Block& block) {
            addSun(block, parts, responses, reflected);
            addEdges(block, parts, reflected);
        });
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
    size_t nearWalls = 0;
    for (const NearLight& near : transport_.parts().near) nearWalls += near.bytes();
    size_t floats = sky.size() + reflected.size() + responses.sky.size() + 3 * lux.size();
    for (const std::vector<float>& rows : responses.sun) // and about as many weights of the sky
        floats += rows.size() + (rows.empty() ? 0 : count * transport_.mesh().patchCount());
    report_.bytes = std::max(report_.bytes, luminance_.bytes() + (gather_ ? gather_->bytes() : 0) +
                                                report_.sunBytes + nearWalls + sizeof(float) * floats);
    checkAndSetErrors(lux, sun, error);
    sensorsDone_ += count;
    told(sunHours_, static_cast<double>(sensorsDone_));
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
