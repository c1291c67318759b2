// A year in an office against Radiance, hour by hour (tests/data/compute/office, tests/data/daylight).
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "compute/annual_daylight.h"
#include "compute/daylight/annual_metrics.h"
#include "compute/daylight/frame.h"
#include "compute/daylight/sky_patches.h"
#include "compute/daylight/weather.h"
#include "geometry/mesher.h"
#include "tests/compute/cases.h"
#include "tests/compute/path_tracer.h"
#include "tests/daylight/csv.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

const std::string kOffice = std::string(HELIODON_TEST_DATA) + "/compute/office/";
constexpr size_t kSensors = 78, kTriangles = 1000;

geometry::PatchMesh office(size_t triangles = kTriangles) {
    return geometry::meshBuilding(geometry::importModel(kOffice + "model.obj", geometry::UpAxis::z),
                                  {triangles});
}

std::vector<Sensor> officeSensors() {
    return test::readCase(kOffice).sensors;
}

std::vector<double> differences(const std::vector<double>& ours, const std::vector<double>& reference) {
    std::vector<double> relative;
    for (size_t i = 0; i < ours.size(); ++i) relative.push_back(ours[i] / reference[i] - 1);
    return relative;
}

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (double v : values) sum += v * v;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

// Against a deterministic radiosity solution with exact point-to-rectangle factors, itself good to 0.1 %.
TEST(Office, a_uniform_sky_gives_the_daylight_factors_of_a_finer_solution) {
    geometry::PatchMesh mesh = office();
    for (geometry::Material& m : mesh.materials)
        if (m.isOpening()) m.transmittance = glm::vec3(1), m.refractiveIndex = 1;
    daylight::Sky sky = daylight::cieGeneralSky(5, {0, 1, 0}, 1e4 / daylight::kPi);
    daylight::lightGround(sky, 0.2);
    DaylightTransport transport(test::device(), mesh);
    AnnualDaylight annual(transport, {sky}, kSensors);
    std::vector<float> lux(kSensors), sun(kSensors), error(kSensors);
    annual.sensors(officeSensors(), lux, sun, error);
    std::vector<double> ours, reference;
    for (const std::string& line : test::split(test::readAll(kOffice + "uniform_sky.csv"), '\n'))
        if (!line.empty() && std::isdigit(line[0])) reference.push_back(std::stod(line));
    ASSERT_EQ(reference.size(), kSensors);
    for (float e : lux) ours.push_back(e / 100);
    EXPECT_LT(rms(differences(ours, reference)), 0.005);
}

// What the reference makes of the sky that a sensor sees straight beyond what is there: it has the sky's mean
// over each of its patches, wherever in the patch the window ends.
double smearedSky(std::span<const SkySample> samples, const daylight::Sky& sky,
                  const daylight::SkyPatches& patches, std::span<const double> means) {
    double lux = 0;
    for (const SkySample& sample : samples) {
        const glm::dvec3 direction(sample.direction);
        lux += photometric(sample.weight) * (means[patches.elementOf(direction)] - sky.luminance(direction));
    }
    return lux;
}

// Radiance's stored hours hold the sky's inter-reflected light twice (they exceed the product of their own
// daylight coefficients with the sky by just that, under overcast skies too); once is taken off again with
// the same coefficients.
TEST(Office, hours_of_the_year_are_those_of_radiance) {
    const daylight::Weather weather = daylight::readWeather(test::dataFile("chicago_tmy3.epw.gz"));
    const test::Csv stored("illuminance_lux_glz.csv.gz");
    const std::string packed = test::readAll(kOffice + "reflected_mf2_glz.f32.gz");
    std::vector<float> reflected(packed.size() / sizeof(float));
    std::memcpy(reflected.data(), packed.data(), packed.size());
    const daylight::SkyPatches patches(2);
    ASSERT_EQ(reflected.size(), kSensors * patches.patchCount());

    constexpr int before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    std::vector<size_t> rows;
    std::vector<daylight::Sky> skies;
    for (size_t r = 5; r < stored.rows.size(); r += 19) { // an odd step: every time of day
        const auto day =
            static_cast<size_t>(before[std::stoi(stored.rows[r][0]) - 1] + std::stoi(stored.rows[r][1]) - 1);
        const auto& hour = weather.hours[day * 24 + static_cast<size_t>(std::stod(stored.rows[r][2]))];
        // The reference's sun stands up to a degree elsewhere: below this height its skies are other skies.
        if (hour.sun.altitudeDeg < 3) continue;
        rows.push_back(r);
        skies.push_back(daylight::skyOfHour(hour));
    }
    DaylightTransport transport(test::device(), office());
    AnnualDaylight annual(transport, skies, kSensors);
    std::vector<float> lux(kSensors * skies.size()), sun(lux.size()), error(lux.size());
    annual.sensors(officeSensors(), lux, sun, error);

    const SkyView& seen = transport.parts().sensorSky;
    std::vector<double> sunless, sunny;
    size_t inside = 0;
    for (size_t h = 0; h < skies.size(); ++h) {
        const std::vector<double> luminance = patches.luminances(skies[h]);
        for (size_t s = 0; s < kSensors; ++s) {
            double twice = 0;
            for (size_t k = 0; k < patches.patchCount(); ++k)
                twice += luminance[k] * reflected[s * patches.patchCount() + k];
            const double reference = std::stod(stored.rows[rows[h]][s + 3]) - twice -
                                     smearedSky(seen.of(s), skies[h], patches, luminance);
            if (reference < 50) continue; // stored as whole lux
            const size_t at = s * skies.size() + h;
            (skies[h].hasSun() ? sunny : sunless).push_back(lux[at] / reference - 1);
            // Radiance's noise; with sun what smearing it over sky patches costs: the RMS that is found
            // below.
            const double own = skies[h].hasSun() ? 0.043 : 0.015;
            inside += std::abs(lux[at] - reference) <= error[at] + own * reference;
        }
    }
    ASSERT_GT(sunless.size(), 500u);
    ASSERT_GT(sunny.size(), 3000u);
    EXPECT_LT(rms(sunless), 0.02);
    EXPECT_LT(rms(sunny), 0.05); // the reference reflects the sun from the four nearest of 577 sky patches
    EXPECT_GT(static_cast<double>(inside), 0.95 * static_cast<double>(sunny.size() + sunless.size()));
    std::printf("RMS without sun %.2f %%, with sun %.2f %%; %zu of %zu inside their error\n",
                100 * rms(sunless), 100 * rms(sunny), inside, sunny.size() + sunless.size());
}

// Some sunny hours of a year, with nothing but these in it.
struct SunnyYear {
    std::vector<daylight::Sky> skies;
    std::vector<float> lux, sun, error; // sensors x hours
};
SunnyYear sunnyYear(size_t every) {
    SunnyYear year;
    size_t count = 0;
    for (const auto& hour : daylight::readWeather(test::dataFile("chicago_tmy3.epw.gz")).hours)
        if (daylight::Sky sky = daylight::skyOfHour(hour); sky.hasSun() && ++count % every == 0)
            year.skies.push_back(std::move(sky));
    DaylightTransport transport(test::device(), office());
    AnnualDaylight annual(transport, year.skies, kSensors);
    for (auto* values : {&year.lux, &year.sun, &year.error}) values->resize(kSensors * year.skies.size());
    annual.sensors(officeSensors(), year.lux, year.sun, year.error);
    return year;
}

// Each hour alone, in full, on a mesh four times as fine; and what is said of the year lies in its intervals.
TEST(Office, hours_with_sun_are_those_of_a_finer_solution) {
    const SunnyYear year = sunnyYear(80);
    const size_t hours = year.skies.size();
    DaylightTransport fine(test::device(), office(4 * kTriangles));
    fine.setSensors(officeSensors());
    const std::vector<Moment> moments = fine.light(year.skies);
    std::vector<float> exact(year.lux.size());
    std::vector<double> relative;
    size_t inside = 0;
    for (size_t s = 0; s < kSensors; ++s)
        for (size_t h = 0; h < hours; ++h) {
            const size_t at = s * hours + h;
            const LightParts& parts = moments[h].sensors[s];
            exact[at] = static_cast<float>(photometric(parts.total()));
            inside += std::abs(year.lux[at] - exact[at]) <= year.error[at];
            // Without the beam at the sensor, which is exact in both and would hide a difference.
            const double indirect = photometric(parts.total() - parts.sun);
            if (indirect > 1) relative.push_back((year.lux[at] - year.sun[at]) / indirect - 1);
        }
    EXPECT_LT(rms(relative), 0.002);
    EXPECT_GT(static_cast<double>(inside), 0.99 * static_cast<double>(exact.size()));

    using Metrics = daylight::SensorMetrics;
    const std::vector<uint8_t> occupied(hours, 1);
    const auto told = daylight::annualMetrics(year.lux, year.sun, occupied, {}, year.error).sensors,
               truth = daylight::annualMetrics(exact, year.sun, occupied).sensors;
    for (size_t s = 0; s < kSensors; ++s)
        for (const auto metric : {&Metrics::da, &Metrics::cda, &Metrics::udiBelow, &Metrics::udiSupplementary,
                                  &Metrics::udiAutonomous, &Metrics::udiAbove}) {
            const daylight::Range range = told[s].*metric;
            EXPECT_GE((truth[s].*metric).value, range.low - 1e-9) << s;
            EXPECT_LE((truth[s].*metric).value, range.high + 1e-9) << s;
        }
    std::printf("%zu hours with sun: RMS %.2f %%\n", hours, 100 * rms(relative));
}

// Paths share nothing but the formulas of sky and glass with what they check.
TEST(Office, hours_with_sun_are_those_of_paths) {
    const SunnyYear year = sunnyYear(400);
    const size_t hours = year.skies.size();
    const geometry::PatchMesh few = geometry::readPatches(kOffice + "model.obj", geometry::UpAxis::z);
    std::vector<double> relative;
    double noise = 0;
    for (size_t h = 0; h < hours; ++h) {
        test::PathTracer tracer(few, year.skies[h]);
        for (size_t s = 3 + h % 7; s < kSensors; s += 30) {
            const auto traced = tracer.at(officeSensors()[s], 50);
            const size_t at = s * hours + h;
            const double indirect = traced.lux - year.sun[at];
            relative.push_back((year.lux[at] - traced.lux) / indirect);
            noise += std::pow(traced.standardError / indirect, 2);
            EXPECT_NEAR(year.lux[at], traced.lux, year.error[at] + 4 * traced.standardError);
        }
    }
    noise = std::sqrt(noise / static_cast<double>(relative.size()));
    EXPECT_LT(noise, 0.03);
    EXPECT_LT(rms(relative), 0.01 + 1.3 * noise); // of some 25 values
    std::printf("%zu sensors and hours: RMS %.2f %%, the paths' own noise %.2f %%\n", relative.size(),
                100 * rms(relative), 100 * noise);
}

} // namespace
} // namespace heliodon::compute
