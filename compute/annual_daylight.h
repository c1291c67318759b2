// A year of light at sensors, each hour with its own sky and its exact sun.
//
// Sensors see the room through importance (Smits, Arvo, Salesin: An Importance-Driven Radiosity Algorithm,
// 1992): a sensor sends out what it receives, u = K f / A + K F u, and the light of any moment at it is
//     E = pi sum_k (c_k + sum_i A_i u_i C_ik) L_k  +  sum_i rho_i y_i sun_i  +  sun at the sensor,
// y_i = f_i + A_i (F u)_i, c and f what the sensor sees directly of sky and patches, C the patches' sky
// coefficients, sun_i the sun's exactly clipped illuminance on patch i that hour. So a sensor costs one
// solution of the radiosity system, an hour one row of luminances and one clipped sun, and the year their
// product. Reciprocity (A_i F_ij = A_j F_ji) is used: where form factors keep it only to some error, results
// differ from DaylightTransport::light by as much; `sensors` measures that on some hours of the year. The few
// hours whose sky has a ribbon at the horizon, too low for sky elements, are that function's own, at 0.15 to
// 0.4 CPU seconds each, once for all sensors as far as 64 MiB hold them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/daylight/sky.h"
#include "compute/daylight_transport.h"
#include "compute/panel_product.h"
#include "compute/sensor_responses.h"
#include "compute/straight_sky.h"
#include "compute/sun_hours.h"

namespace heliodon::compute {

struct YearReport {
    size_t hours = 0, lit = 0; // lit: with sky or ground
    size_t withSun = 0;        // hours whose sun enters, or lights what stands outside
    size_t sunOutside = 0;     // sun in the sky, but on neither
    size_t sunless = 0;        // lit, no sun
    size_t solved = 0;         // one by one in full: skies with a ribbon at the horizon
    double skySeconds = 0, sunSeconds = 0, sensorSeconds = 0, productSeconds = 0, checkSeconds = 0,
           solvedSeconds = 0;
    size_t sunlitPatches = 0; // over all hours
    size_t sunBlocks = 0;     // that the hours with sun are held in, one at a time
    size_t sunBytes = 0;      // of the largest
    size_t bytes = 0;         // most that was held at once, without the transport's own
    // Against DaylightTransport::light on some hours: RMS of the relative difference over sensors.
    size_t checkedHours = 0;
    double checkRms = 0;

    YearReport& operator+=(const YearReport& part); // of other hours, at the same sensors
};

class AnnualDaylight {
public:
    // `share` of the whole work that is done, 0 to 1, of `sensorCount` sensors.
    using Tell = std::function<void(double share)>;

    static constexpr size_t kSunBytes = 128 << 20;
    static constexpr size_t kSolvedBytes = 64 << 20; // of ribbon hours kept; more are solved in each call

    // Luminances of every sky, about 0.1 ms each and core. `transport` must outlive this and keep
    // its materials.
    AnnualDaylight(DaylightTransport& transport, std::vector<daylight::Sky> skies, size_t sensorCount,
                   Tell told = {}, size_t sunBytes = kSunBytes);
    AnnualDaylight(const AnnualDaylight&) = delete;
    AnnualDaylight& operator=(const AnnualDaylight&) = delete;

    // Photometric illuminance of these sensors, which become the transport's: arrays of sensors x hours.
    // `sun` is the direct sun in it, `error` an estimate of the half-width of its interval, made from the
    // errors that the transport states for some hours. To be called with a few hundred sensors at a time: the
    // first call makes the hours' sun, about 0.4 ms an hour and core, and where that takes more than
    // `sunBytes`, as on large meshes with many windows, so does each other one.
    void sensors(std::span<const Sensor> sensors, std::span<float> lux, std::span<float> sun,
                 std::span<float> error);

    // Of the last call, by place in its arrays: the direct sun that may be there more or less, at the edges
    // of beams (SunPatches::beamAtPoint), photometric lux. `error` has it in.
    const std::map<size_t, float>& beamEdges() const { return beamEdges_; }

    size_t hours() const { return skies_.size(); }
    const YearReport& report() const { return report_; }

private:
    void makeSkies(const TransportParts& parts);
    std::vector<float> sunOf(const SensorResponses& responses);
    void addSun(const SunHours::Block& block, const TransportParts& parts, const SensorResponses& responses,
                std::span<float> reflected) const;
    void addBlinds(const SunHours::Hour& hour, const TransportParts& parts, const SensorResponses& responses,
                   float* reflected) const;
    void addEdges(const SunHours::Block& block, const TransportParts& parts, std::span<float> reflected);
    void addBeams(std::span<const Sensor> sensors, std::span<float> sun);
    void checkAndSetErrors(std::span<const float> lux, std::span<const float> sun, std::span<float> error);
    std::vector<uint32_t> checkedHours(size_t& sunless) const;
    void solveRibbons(std::span<float> lux, std::span<float> sun, std::span<float> error);
    void keep(std::vector<Moment> moments);
    double sunWork() const;    // of an hour
    double ribbonWork() const; // of an hour, but for its sensors
    void reportOf(const SensorResponses& responses, size_t values);
    double answerWork() const; // of a sensor
    double sensorWork() const; // of all that it takes, but for walls beside it
    void foresee(size_t sensors);
    void makeNearLight(size_t sensors);
    std::function<void(size_t)> tellEach(double work);
    void tell(double work); // that was done

    DaylightTransport& transport_;
    std::vector<daylight::Sky> skies_;
    size_t sensorCount_, sensorsDone_ = 0;
    Tell tell_;
    double workDone_ = 0, sunDone_ = 0, nearDone_ = 0, ribbonsDone_ = 0;
    double sunWork_ = 0, nearWork_ = 0, ribbonWork_ = 0; // done and to come
    double nearShare_ = 0;                               // of sensors, those with walls beside them
    SensorResponder responder_;
    std::vector<uint32_t> lit_;     // hours with sky or ground, but for ...
    std::vector<uint32_t> ribbons_; // ... those whose sky has a ribbon
    std::vector<Moment> solved_;    // of the first of these
    size_t solvedBytes_ = 0;
    bool keeps_ = true;                     // there is room for more of them
    Panels luminance_;                      // elements x lit hours, times pi
    std::optional<StraightHours> straight_; // of lit hours
    std::optional<SunHours> suns_;
    std::map<size_t, float> beamEdges_;
    double checkSquares_ = 0, checkCount_ = 0;
    YearReport report_;
};

} // namespace heliodon::compute
