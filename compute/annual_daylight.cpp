#include "compute/annual_daylight.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "compute/daylight/horizon_ribbon.h"
#include "compute/glow_rows.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"

namespace heliodon::compute {

namespace {

constexpr size_t kCheckedSunless = 3, kCheckedSunny = 6;
constexpr size_t kSolvedAtOnce = 8; // hours that share passes over F
// Work in about CPU milliseconds, for the bar, measured on 37 to 280 sensors, 600 and 2000 patches: an hour's
// sky; its sun, by itself and by patches (twice that behind partitions).
constexpr double kSkyWork = 0.085, kSunWork = 0.2, kSunPatchWork = 7e-5;
// Of a sensor: what it sees, what it answers, by pairs of patches; by hours with sky, what it sees straight;
// by hours with sun, its beam.
constexpr double kSensorWork = 1.2, kAnswerWork = 5e-7, kStraightWork = 8e-5, kBeamWork = 1.2e-4;
// An hour whose sky has a ribbon, by patches and by sensors.
constexpr double kRibbonWork = 0.15, kRibbonSensorWork = 1;
// Of a sensor with walls beside it, beyond that: by patches; by hours with sky; by hours with sun.
constexpr double kNearWork = 1.5e-3, kNearSkyWork = 8e-4, kNearSunWork = 3e-4;

// `wanted` entries spread evenly over `all`.
template<class T> std::vector<T> spread(const std::vector<T>& all, size_t wanted) {
    std::vector<T> some;
    const size_t count = std::min(wanted, all.size());
    for (size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
    return some;
}

// As of a moment's light: slopes can leave what is nearly nothing below it, which counts as error.
void keepFromNegative(std::span<float> lux, std::span<const float> sun, std::span<float> error) {
    for (size_t at = 0; at < lux.size(); ++at) {
        const float below = std::max(0.0f, sun[at] - lux[at]);
        lux[at] = std::max(lux[at], sun[at]);
        error[at] = std::max(0.0f, error[at]) + below;
    }
}

} // namespace

AnnualDaylight::AnnualDaylight(DaylightTransport& transport, std::vector<daylight::Sky> skies,
                               size_t sensorCount, Tell told, size_t sunBytes)
    : transport_(transport), skies_(std::move(skies)), sensorCount_(sensorCount), tell_(std::move(told)),
      responder_(transport) {
    const TransportParts parts = transport_.parts();
    suns_.emplace(parts, transport_.mesh(), skies_, sunBytes, [this](size_t hours) {
        const double work = sunWork() * static_cast<double>(hours);
        sunDone_ += work;
        tell(work);
    });
    sunWork_ = sunWork() * static_cast<double>(suns_->sunny());
    makeSkies(parts);
    straight_.emplace(skies_, lit_);
    ribbonWork_ = ribbonWork() * static_cast<double>(ribbons_.size());
    report_.hours = skies_.size();
    report_.solved = ribbons_.size();
    report_.lit = lit_.size() + ribbons_.size();
    for (const auto* hours : {&lit_, &ribbons_})
        report_.sunless += static_cast<size_t>(
            std::ranges::count_if(*hours, [&](uint32_t hour) { return !skies_[hour].hasSun(); }));
}

double AnnualDaylight::sunWork() const {
    return kSunWork + kSunPatchWork * static_cast<double>(transport_.mesh().patchCount());
}

double AnnualDaylight::answerWork() const {
    const auto patches = static_cast<double>(transport_.mesh().patchCount());
    return kSensorWork + kAnswerWork * patches * patches;
}

// Hours whose sun enters are known once they are made.
double AnnualDaylight::sensorWork() const {
    const auto sunny = static_cast<double>(suns_->blocks() > 0 ? suns_->skies().size() : suns_->sunny());
    return answerWork() + kStraightWork * static_cast<double>(lit_.size()) + kBeamWork * sunny +
           kRibbonSensorWork * static_cast<double>(ribbons_.size());
}

double AnnualDaylight::ribbonWork() const {
    return kRibbonWork * static_cast<double>(transport_.mesh().patchCount());
}

// Where the hours' sun is not kept, all but its last block is made again in each call that is still to come,
// taken to be of as many sensors as the last; so are ribbon hours that are not kept.
void AnnualDaylight::foresee(size_t sensors) {
    const size_t left = sensorCount_ - std::min(sensorsDone_, sensorCount_),
                 calls = (left + sensors - 1) / sensors;
    const auto blocks = static_cast<double>(std::max<size_t>(suns_->blocks(), 1));
    sunWork_ = sunDone_ + static_cast<double>(calls) * (1 - 1 / blocks) * sunWork() *
                              static_cast<double>(suns_->skies().size());
    ribbonWork_ =
        ribbonsDone_ + static_cast<double>(calls * (ribbons_.size() - solved_.size())) * ribbonWork();
}

// To be told how many things are done, of which each has `work`.
std::function<void(size_t)> AnnualDaylight::tellEach(double work) {
    return [this, work, told = size_t{0}](size_t done) mutable {
        tell(work * static_cast<double>(done - told));
        told = done;
    };
}

// Sensors that are still to come are taken to have as many walls beside them as these.
void AnnualDaylight::makeNearLight(size_t sensors) {
    nearShare_ = static_cast<double>(transport_.report().sensorsNearWalls) / static_cast<double>(sensors);
    const double taken = nearShare_ * kNearWork * static_cast<double>(transport_.mesh().patchCount());
    const double each = taken + nearShare_ * (kNearSkyWork * static_cast<double>(lit_.size()) +
                                              kNearSunWork * static_cast<double>(suns_->skies().size()));
    nearWork_ =
        nearDone_ + each * static_cast<double>(std::max(sensorCount_, sensorsDone_ + sensors) - sensorsDone_);
    transport_.makeNearLight(tellEach(taken));
    nearDone_ += each * static_cast<double>(sensors);
}

void AnnualDaylight::tell(double work) {
    if (!tell_) return;
    workDone_ += work;
    const double all = kSkyWork * static_cast<double>(lit_.size()) + sunWork_ + nearWork_ + ribbonWork_ +
                       sensorWork() * static_cast<double>(std::max<size_t>(sensorCount_, 1));
    tell_(std::min(1.0, workDone_ / all));
}

void AnnualDaylight::makeSkies(const TransportParts& parts) {
    const SecondsAdded clock(report_.skySeconds);
    if (parts.skyElements == 0) return;
    for (size_t h = 0; h < skies_.size(); ++h)
        if (daylight::hasHorizonRibbon(skies_[h].formula))
            ribbons_.push_back(static_cast<uint32_t>(h));
        else if (skies_[h].formula.scale > 0 || skies_[h].ground.luminance > 0)
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

// reflected: hours with sun x sensors.
void AnnualDaylight::addSun(const SunHours::Block& block, const TransportParts& parts,
                            const SensorResponses& responses, std::span<float> reflected) const {
    const size_t sensors = responses.sensors;
    const GlowRows rows(parts, transport_.mesh().patchCount());
    inParallel(block.hours.size(), [&](size_t k) {
        float* row = &reflected[(block.first + k) * sensors];
        for (const SunHours::Lit& lit : block.hours[k].patches) responses.add(lit.row, lit.lux, row);
        for (const SunHours::Lit& lit : block.hours[k].bounced)
            responses.add(rows.smooth + lit.row, lit.lux, row);
        for (const SunHours::Lit& lit : block.hours[k].outside)
            responses.add(rows.outside + lit.row, lit.lux, row);
        addBlinds(block.hours[k], parts, responses, row);
    });
}

// What blinds scatter of one hour's sun. Windows of a group that it shines on alike, all unless something
// shades them, are told as one.
void AnnualDaylight::addBlinds(const SunHours::Hour& hour, const TransportParts& parts,
                               const SensorResponses& responses, float* reflected) const {
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
                for (size_t lobe = 0; lobe < daylight::kSlatLobes; ++lobe)
                    responses.add(row + lobe, lux * lobes[lobe], reflected);
            };
            const glm::vec3 one = lit->lux;
            if (static_cast<size_t>(last - lit) == count &&
                std::all_of(lit, last, [&](const SunHours::Lit& l) {
                    return glm::length(l.lux - one) <= 1e-6F * glm::length(one);
                }))
                add(rows.groupLobes + g * daylight::kSlatLobes, one);
            else
                for (auto l = lit; l != last; ++l)
                    add(rows.lobes + (slats + l->row - window) * daylight::kSlatLobes, l->lux);
        }
        if (group.window.hasSlats()) slats += count;
        window += count;
        lit = last;
    }
}

void AnnualDaylight::addEdges(const SunHours::Block& block, const TransportParts& parts,
                              std::span<float> reflected) {
    const size_t n = transport_.mesh().patchCount(), count = parts.sensors.size();
    const double work =
        nearShare_ * kNearSunWork * static_cast<double>(block.hours.size() * SunEdges::kTogether);
    inParallel((count + SunEdges::kTogether - 1) / SunEdges::kTogether,
               [&](size_t group) {
                   const size_t first = group * SunEdges::kTogether;
                   std::vector<SunEdges::Place> places;
                   for (size_t s = first; s < std::min(count, first + SunEdges::kTogether); ++s)
                       places.push_back({PointView(parts.points.blockers(), parts.sensors[s].position,
                                                   parts.sensors[s].normal, parts.sensorRooms[s]),
                                         parts.sensorRooms[s], &parts.sensorEven[s * n]});
                   float* const lux = &reflected[block.first * count + first];
                   block.edges.addTo(lux, count, parts.points, places);
                   std::vector<float> more;
                   for (size_t k = 0; k < places.size(); ++k) {
                       if (parts.near[first + k].isEmpty()) continue;
                       more.assign(block.hours.size(), 0);
                       block.edges.addTo(more, parts.points, parts.near[first + k], places[k].room);
                       for (size_t h = 0; h < more.size(); ++h) lux[h * count + k] += more[h];
                   }
               },
               tellEach(work));
}

// Sun straight at the sensors: sensors x hours.
void AnnualDaylight::addBeams(std::span<const Sensor> sensors, std::span<float> sun) {
    const SunScene& panes = transport_.parts().sun;
    const std::span<const uint32_t> hours = suns_->skies();
    beamEdges_.clear();
    std::mutex adding;
    inParallel(hours.size(), [&](size_t k) {
        const daylight::Sky& sky = skies_[hours[k]];
        const SunPatches beam(panes, sky.sun.direction);
        for (size_t s = 0; s < sensors.size(); ++s) {
            const size_t at = s * skies_.size() + hours[k];
            const glm::dvec3 position = sensors[s].position, normal = glm::normalize(sensors[s].normal);
            const auto lux = [&](glm::vec3 share) {
                return static_cast<float>(sky.sun.normalIlluminance * photometric(share));
            };
            const auto [share, edge] = beam.beamAtPoint(position, normal);
            sun[at] = lux(share);
            if (const float unsure = lux(edge); unsure > 0) {
                const std::scoped_lock lock(adding);
                beamEdges_[at] = unsure;
            }
        }
    });
}

void AnnualDaylight::sensors(std::span<const Sensor> sensors, std::span<float> lux, std::span<float> sun,
                             std::span<float> error) {
    const size_t count = sensors.size(), hours = skies_.size();
    if (lux.size() != count * hours || sun.size() != lux.size() || error.size() != lux.size())
        throw std::invalid_argument("AnnualDaylight: arrays are not sensors x hours");
    if (lux.empty()) return;
    SensorResponses responses;
    {
        const SecondsAdded clock(report_.sensorSeconds);
        transport_.setSensors({sensors.begin(), sensors.end()});
        makeNearLight(count);
        responses = responder_.respond(transport_.parts(), [this](size_t answered) {
            tell(answerWork() * static_cast<double>(answered));
        });
    }
    const std::vector<float> reflected = sunOf(responses);
    {
        const SecondsAdded clock(report_.productSeconds);
        std::vector<float> sky(count * lit_.size());
        multiply(responses.sky, count, luminance_, sky);
        std::fill(sun.begin(), sun.end(), 0.0f);
        addBeams(sensors, sun);
        tell(kBeamWork * static_cast<double>(suns_->skies().size() * count));
        const TransportParts parts = transport_.parts();
        const StraightSky straight(*straight_, parts.sensorSky, parts.near);
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
        straight.addTo(lux,
                       tellEach((kStraightWork + nearShare_ * kNearSkyWork) * static_cast<double>(count)));
    }
    reportOf(responses, lux.size());
    checkAndSetErrors(lux, sun, error);
    keepFromNegative(lux, sun, error);
    solveRibbons(lux, sun, error);
    sensorsDone_ += count;
    foresee(count);
}

// The sun by way of patches: hours whose sun enters x sensors.
std::vector<float> AnnualDaylight::sunOf(const SensorResponses& responses) {
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

void AnnualDaylight::reportOf(const SensorResponses& responses, size_t values) {
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
        floats += rows.size() + (rows.empty() ? 0 : count * transport_.mesh().patchCount());
    report_.bytes = std::max(report_.bytes, luminance_.bytes() + straight_->bytes() + responder_.bytes() +
                                                transport_.parts().gatherBytes + solvedBytes_ +
                                                report_.sunBytes + nearWalls + sizeof(float) * floats);
}

// Sunless ones first.
std::vector<uint32_t> AnnualDaylight::checkedHours(size_t& sunless) const {
    std::vector<uint32_t> sunny, others;
    std::ranges::set_difference(suns_->skies(), ribbons_, std::back_inserter(sunny));
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
            const size_t at = s * hours + checked[k];
            if (beamEdges_.contains(at)) continue; // says nothing of other hours
            const double there = photometric(full.total()), here = lux[at], bySun = error[at];
            const double mistake = static_cast<double>(full.error) + std::abs(here - there);
            // Light of the sun's beam at the sensor itself is exact in both and would hide a difference.
            const double indirect = there - photometric(full.sun);
            if (indirect > 0) {
                const double difference = (here - sun[at]) / indirect - 1;
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
    for (const auto& [at, open] : beamEdges_) error[at] += open;
    report_.checkRms = checkCount_ > 0 ? std::sqrt(checkSquares_ / checkCount_) : 0;
}

void AnnualDaylight::solveRibbons(std::span<float> lux, std::span<float> sun, std::span<float> error) {
    const SecondsAdded clock(report_.solvedSeconds);
    const size_t hours = skies_.size();
    const auto write = [&](const Moment& moment, uint32_t hour) {
        for (size_t s = 0; s < moment.sensors.size(); ++s) {
            const LightParts& parts = moment.sensors[s];
            const size_t at = s * hours + hour;
            lux[at] = static_cast<float>(photometric(parts.total()));
            sun[at] = static_cast<float>(photometric(parts.sun));
            error[at] = parts.error;
        }
    };
    const size_t kept = solved_.size();
    const double bySensors = kRibbonSensorWork * static_cast<double>(lux.size()) / static_cast<double>(hours);
    for (size_t k = 0; k < kept; ++k) {
        transport_.lightSensors(solved_[k], skies_[ribbons_[k]]);
        write(solved_[k], ribbons_[k]);
        tell(bySensors);
    }
    for (size_t first = kept; first < ribbons_.size(); first += kSolvedAtOnce) {
        std::vector<daylight::Sky> skies;
        for (size_t k = first; k < std::min(first + kSolvedAtOnce, ribbons_.size()); ++k)
            skies.push_back(skies_[ribbons_[k]]);
        std::vector<Moment> moments = transport_.light(skies);
        for (size_t k = 0; k < moments.size(); ++k) write(moments[k], ribbons_[first + k]);
        const double work = static_cast<double>(moments.size()) * ribbonWork();
        ribbonsDone_ += work;
        tell(work + bySensors * static_cast<double>(moments.size()));
        keep(std::move(moments));
    }
}

// For sensors to come, as many as may be held.
void AnnualDaylight::keep(std::vector<Moment> moments) {
    for (Moment& moment : moments) {
        const size_t vectors = moment.lobes.size() + moment.glow.size() + 3 * moment.patches.size();
        const size_t bytes =
            moment.patches.size() * (sizeof(LightParts) + 2 * sizeof(float)) + vectors * sizeof(glm::vec3);
        if (!keeps_ || solvedBytes_ + bytes > kSolvedBytes) {
            keeps_ = false;
            return;
        }
        solvedBytes_ += bytes;
        moment.sensors.clear();
        solved_.push_back(std::move(moment));
    }
}

YearReport& YearReport::operator+=(const YearReport& part) {
    const double squares = checkRms * checkRms * static_cast<double>(checkedHours) +
                           part.checkRms * part.checkRms * static_cast<double>(part.checkedHours);
    hours += part.hours, lit += part.lit, withSun += part.withSun, sunOutside += part.sunOutside;
    sunless += part.sunless, solved += part.solved, sunlitPatches += part.sunlitPatches;
    skySeconds += part.skySeconds, sunSeconds += part.sunSeconds, sensorSeconds += part.sensorSeconds;
    productSeconds += part.productSeconds, checkSeconds += part.checkSeconds;
    solvedSeconds += part.solvedSeconds;
    sunBlocks += part.sunBlocks, checkedHours += part.checkedHours;
    sunBytes = std::max(sunBytes, part.sunBytes), bytes = std::max(bytes, part.bytes);
    checkRms = checkedHours > 0 ? std::sqrt(squares / static_cast<double>(checkedHours)) : 0;
    return *this;
}

} // namespace heliodon::compute
