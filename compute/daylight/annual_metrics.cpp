#include "compute/daylight/annual_metrics.h"

#include <algorithm>
#include <stdexcept>

namespace heliodon::daylight {

namespace {

// Records whose illuminance is in a band: as computed, surely, possibly.
struct Count {
    size_t value = 0, sure = 0, possible = 0;

    void add(bool in, bool surely, bool possibly) {
        value += in;
        sure += surely;
        possible += possibly;
    }
    Range scaled(double unit) const {
        return {unit * static_cast<double>(value), unit * static_cast<double>(sure),
                unit * static_cast<double>(possible)};
    }
};

// What one sensor's occupied records amount to when the illuminances carry no error: three counts and a sum
// say it all, in a loop without branches.
struct PlainTally {
    size_t occupied = 0, atLeastLow = 0, atLeastTarget = 0, above = 0, sun = 0;
    double continuous = 0;

    PlainTally(std::span<const float> lux, std::span<const float> sunLux, std::span<const uint8_t> flags,
               const AnnualOptions& o) {
        const double perTarget = 1.0 / o.targetLux;
        for (size_t r = 0; r < lux.size(); ++r) {
            const double e = lux[r];
            const size_t in = flags[r] != 0;
            occupied += in;
            atLeastLow += in & static_cast<size_t>(e >= o.udiLowLux);
            atLeastTarget += in & static_cast<size_t>(e >= o.targetLux);
            above += in & static_cast<size_t>(e > o.udiHighLux);
            continuous += in ? std::min(1.0, e * perTarget) : 0.0;
        }
        for (size_t r = 0; r < sunLux.size(); ++r)
            sun += static_cast<size_t>(flags[r] != 0) &
                   static_cast<size_t>(static_cast<double>(sunLux[r]) > o.aseLux);
    }
    SensorMetrics metrics(double percent, double hours) const {
        const auto exactly = [](double unit, size_t count) {
            const double v = unit * static_cast<double>(count);
            return Range{v, v, v};
        };
        SensorMetrics m;
        m.da = exactly(percent, atLeastTarget);
        m.cda = {percent * continuous, percent * continuous, percent * continuous};
        m.udiBelow = exactly(percent, occupied - atLeastLow);
        m.udiSupplementary = exactly(percent, atLeastLow - atLeastTarget);
        m.udiAutonomous = exactly(percent, atLeastTarget - above);
        m.udiUseful = exactly(percent, atLeastLow - above);
        m.udiAbove = exactly(percent, above);
        m.sunHours = exactly(hours, sun);
        return m;
    }
};

// The same with intervals.
struct Tally {
    Count reached, below, supplementary, autonomous, useful, above, sun;
    double continuous = 0, continuousLow = 0, continuousHigh = 0;

    Tally(std::span<const float> lux, std::span<const float> sunLux, std::span<const float> luxError,
          std::span<const uint8_t> occupied, const AnnualOptions& options) {
        for (size_t r = 0; r < lux.size(); ++r) {
            if (!occupied[r]) continue;
            const double e = lux[r], error = luxError[r];
            add(e, std::max(0.0, e - error), e + error, options);
            if (sunLux.empty()) continue;
            // The error is that of the sun's amount; where there is none, addEdges() says whether some may
            // be.
            const double direct = sunLux[r];
            if (direct > 0) addSun(direct, direct - error, direct + error, options);
        }
    }
    void add(double e, double low, double high, const AnnualOptions& o) {
        const double target = o.targetLux, a = o.udiLowLux, b = o.udiHighLux;
        reached.add(e >= target, low >= target, high >= target);
        below.add(e < a, high < a, low < a);
        supplementary.add(e >= a && e < target, low >= a && high < target, high >= a && low < target);
        autonomous.add(e >= target && e <= b, low >= target && high <= b, high >= target && low <= b);
        useful.add(e >= a && e <= b, low >= a && high <= b, high >= a && low <= b);
        above.add(e > b, low > b, high > b);
        continuous += std::min(1.0, e / target);
        continuousLow += std::min(1.0, low / target);
        continuousHigh += std::min(1.0, high / target);
    }
    // `edges`: of all sensors; `first`: this one's place there.
    void addEdges(const std::map<size_t, float>& edges, size_t first, std::span<const float> sunLux,
                  std::span<const uint8_t> occupied, const AnnualOptions& options) {
        const auto end = edges.lower_bound(first + sunLux.size());
        for (auto edge = edges.lower_bound(first); edge != end; ++edge) {
            const size_t record = edge->first - first;
            if (occupied[record] && !(sunLux[record] > 0)) addSun(0, 0, double{edge->second}, options);
        }
    }
    void addSun(double e, double low, double high, const AnnualOptions& o) {
        sun.add(e > o.aseLux, low > o.aseLux, high > o.aseLux);
    }
    SensorMetrics metrics(double percent, double hours) const {
        SensorMetrics m;
        m.da = reached.scaled(percent);
        m.cda = {percent * continuous, percent * continuousLow, percent * continuousHigh};
        m.udiBelow = below.scaled(percent);
        m.udiSupplementary = supplementary.scaled(percent);
        m.udiAutonomous = autonomous.scaled(percent);
        m.udiUseful = useful.scaled(percent);
        m.udiAbove = above.scaled(percent);
        m.sunHours = sun.scaled(hours);
        return m;
    }
};

// Percent of sensors that pass; a sensor whose interval straddles the limit leaves the result open.
template<typename Pass>
Range share(const std::vector<SensorMetrics>& sensors, Range SensorMetrics::*metric, Pass pass) {
    Count count;
    for (const auto& s : sensors)
        count.add(pass((s.*metric).value), pass((s.*metric).low), pass((s.*metric).high));
    return count.scaled(sensors.empty() ? 0.0 : 100.0 / static_cast<double>(sensors.size()));
}

double mean(const std::vector<SensorMetrics>& sensors, Range SensorMetrics::*metric) {
    double sum = 0;
    for (const auto& s : sensors) sum += (s.*metric).value;
    return sensors.empty() ? 0 : sum / static_cast<double>(sensors.size());
}

} // namespace

SensorMetrics& SensorMetrics::operator+=(const SensorMetrics& part) {
    for (Range SensorMetrics::*metric :
         {&SensorMetrics::da, &SensorMetrics::cda, &SensorMetrics::udiBelow, &SensorMetrics::udiSupplementary,
          &SensorMetrics::udiAutonomous, &SensorMetrics::udiUseful, &SensorMetrics::udiAbove,
          &SensorMetrics::sunHours}) {
        Range& all = this->*metric;
        const Range& more = part.*metric;
        all.value += more.value, all.low += more.low, all.high += more.high;
    }
    luxHours += part.luxHours;
    return *this;
}

AnnualMetrics summarized(std::vector<SensorMetrics> sensors, std::span<const uint8_t> occupied,
                         const AnnualOptions& options) {
    AnnualMetrics result{std::move(sensors), {}};
    const auto occupiedRecords =
        std::count_if(occupied.begin(), occupied.end(), [](uint8_t o) { return o != 0; });
    AnnualSummary& summary = result.summary;
    summary.sensors = result.sensors.size();
    summary.occupiedHours = static_cast<double>(occupiedRecords) * options.recordHours;
    summary.sda = share(result.sensors, &SensorMetrics::da,
                        [&](double da) { return da >= 100.0 * options.sdaShare - 1e-9; });
    summary.ase = share(result.sensors, &SensorMetrics::sunHours,
                        [&](double hours) { return hours > options.aseHours + 1e-9; });
    summary.meanDa = mean(result.sensors, &SensorMetrics::da);
    summary.meanCda = mean(result.sensors, &SensorMetrics::cda);
    summary.meanUdiUseful = mean(result.sensors, &SensorMetrics::udiUseful);
    summary.meanUdiAbove = mean(result.sensors, &SensorMetrics::udiAbove);
    return result;
}

AnnualMetrics annualMetrics(std::span<const float> lux, std::span<const float> sunLux,
                            std::span<const uint8_t> occupied, const AnnualOptions& options,
                            std::span<const float> luxError, const std::map<size_t, float>& sunEdges) {
    const size_t records = occupied.size();
    if (records == 0 || lux.size() % records != 0)
        throw std::invalid_argument("annualMetrics: lux is not sensors x records");
    if (!sunLux.empty() && sunLux.size() != lux.size())
        throw std::invalid_argument("annualMetrics: sunLux has another size");
    if (!luxError.empty() && luxError.size() != lux.size())
        throw std::invalid_argument("annualMetrics: luxError has another size");

    const size_t sensors = lux.size() / records;
    const auto occupiedRecords = options.occupiedRecords
                                     ? options.occupiedRecords
                                     : static_cast<size_t>(std::count_if(occupied.begin(), occupied.end(),
                                                                         [](uint8_t o) { return o != 0; }));
    const double percent = occupiedRecords ? 100.0 / static_cast<double>(occupiedRecords) : 0.0;
    AnnualMetrics result;
    result.sensors.reserve(sensors);
    double occupiedLux = 0;
    for (size_t s = 0; s < sensors; ++s) {
        const auto own = [&](std::span<const float> all) {
            return all.empty() ? all : all.subspan(s * records, records);
        };
        const std::span<const float> e = own(lux);
        if (luxError.empty()) {
            result.sensors.push_back(
                PlainTally(e, own(sunLux), occupied, options).metrics(percent, options.recordHours));
        } else {
            Tally tally(e, own(sunLux), own(luxError), occupied, options);
            tally.addEdges(sunEdges, s * records, own(sunLux), occupied, options);
            result.sensors.push_back(tally.metrics(percent, options.recordHours));
        }
        double all = 0;
        for (size_t r = 0; r < records; ++r) {
            all += static_cast<double>(e[r]);
            occupiedLux += occupied[r] ? static_cast<double>(e[r]) : 0.0;
        }
        result.sensors.back().luxHours = all * options.recordHours;
    }

    result = summarized(std::move(result.sensors), occupied, options);
    if (occupiedRecords && sensors)
        result.summary.meanLux = occupiedLux / static_cast<double>(occupiedRecords * sensors);
    return result;
}

} // namespace heliodon::daylight
