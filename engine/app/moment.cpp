#include "engine/app/moment.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "compute/daylight/frame.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

daylight::Site parseSite(const std::string& text) {
    daylight::Site site;
    const char* const end = text.data() + text.size();
    const auto latitude = std::from_chars(text.data(), end, site.latitudeDeg);
    const bool comma = latitude.ec == std::errc() && latitude.ptr != end && *latitude.ptr == ',';
    const char* second = comma ? latitude.ptr + 1 : end;
    while (second != end && *second == ' ') ++second;
    const auto longitude = std::from_chars(second, end, site.longitudeDeg);
    if (longitude.ec != std::errc() || longitude.ptr != end || !(std::abs(site.latitudeDeg) <= 90) ||
        !(std::abs(site.longitudeDeg) <= 180))
        throw geometry::InputError(
            "--site", "",
            fmt::format("'{}' is no place, expected LAT,LON in degrees north (-90 to 90) "
                        "and east (-180 to 180)",
                        text));
    return site;
}

} // namespace

SkySource::SkySource(Run& run, const MomentArguments& arguments, const Scene& scene)
    : option_(arguments.sky.empty() ? "clear" : arguments.sky), up_(scene.up) {
    setting_.northDeg = scene.northDeg;
    groundAlbedo_ = arguments.groundAlbedo;
    setting_.groundAlbedo = groundAlbedo_.value_or(setting_.groundAlbedo);
    if (!arguments.weather.empty()) {
        const StageTimer timer(run, "weather");
        weather_ = std::make_shared<daylight::Weather>(daylight::readWeather(arguments.weather));
        for (const std::string& warning : weather_->warnings) run.warn(warning);
        run.report()["weather"] = {{"file", arguments.weather.string()}, {"place", weather_->place}};
    }
    std::string assumed;
    auto assume = [&](const std::string& what) { assumed += (assumed.empty() ? "" : ", ") + what; };
    const bool named = !arguments.site.empty();
    if (named) site_ = parseSite(arguments.site); // refused where it is none, used or not
    if (weather_) {
        if (named) run.warn("--site is not used: the light is that of the weather file's site");
        site_ = weather_->site;
    } else if (named && !followsTime())
        run.warn("--site is not used: the sky file says where the sun stands");
    else if (!named && scene.rig && scene.rig->site)
        site_ = *scene.rig->site;
    else if (!named)
        assume(fmt::format("site {},{}", site_.latitudeDeg, site_.longitudeDeg));
    if (!arguments.time.empty()) {
        moment_ = daylight::parseTime(arguments.time, "--time");
        warnOfOneLight(run);
    } else {
        assume("time " + daylight::formatTime(moment_));
    }
    if (arguments.sky.empty() && !weather_) assume("sky clear");
    if (!scene.assumedNorth.empty()) assume(scene.assumedNorth);
    if (!assumed.empty() && followsTime()) run.assume(assumed);
    run.report()["sky"] = {{"option", weather_ ? "weather" : option_}, {"north_deg", scene.northDeg}};
    if (!followsTime()) return;
    run.report()["site"] = {{"latitude", site_.latitudeDeg}, {"longitude", site_.longitudeDeg}};
}

SkySource::SkySource(const daylight::Site& site, std::string sky, double northDeg, geometry::UpAxis up)
    : site_(site), option_(std::move(sky)), up_(up) {
    setting_.northDeg = northDeg;
}

SkySource::SkySource(std::shared_ptr<const daylight::Weather> weather, double northDeg)
    : site_(weather->site), weather_(std::move(weather)) {
    setting_.northDeg = northDeg;
}

bool SkySource::followsTime() const {
    return weather_ || daylight::skyDependsOnTime(option_);
}

void SkySource::warnOfOneLight(Run& run) const {
    if (!followsTime())
        run.warn(option_ + ": states one sky, which is taken for every time that is asked for");
}

std::string SkySource::title() const {
    return (followsTime() ? daylight::timeInWords(moment_) + ", " : "") + skyInWords();
}

std::string SkySource::skyInWords() const {
    if (weather_) return "weather of " + weather_->place;
    if (!daylight::skyDependsOnTime(option_))
        return "sky of " + std::filesystem::path(option_).filename().string();
    const std::string sky =
        option_.starts_with("cie:") ? "CIE sky type " + option_.substr(4)
        : option_.starts_with("perez:")
            ? fmt::format("Perez sky, {} W/m2 direct and {} W/m2 diffuse",
                          option_.substr(6, option_.find(',') - 6), option_.substr(option_.find(',') + 1))
            : option_ + " sky";
    return fmt::format("{}, {:.2f} {} {:.2f} {}", sky, std::abs(site_.latitudeDeg),
                       site_.latitudeDeg < 0 ? 'S' : 'N', std::abs(site_.longitudeDeg),
                       site_.longitudeDeg < 0 ? 'W' : 'E');
}

daylight::SunPosition SkySource::sunAt(const daylight::Moment& moment) const {
    return daylight::sunPosition(daylight::utcSeconds(moment, site_.longitudeDeg), site_);
}

daylight::Sky SkySource::skyAt(const daylight::Moment& moment) const {
    if (!weather_) {
        daylight::Sky sky = daylight::skyFromOption(option_, sunAt(moment), setting_, up_);
        if (groundAlbedo_ && !daylight::skyDependsOnTime(option_)) daylight::lightGround(sky, *groundAlbedo_);
        return sky;
    }
    daylight::WeatherSky options;
    options.setting = setting_;
    const std::optional<daylight::Sky> sky =
        daylight::skyAt(*weather_, daylight::utcSeconds(moment, site_.longitudeDeg), options);
    if (!sky)
        throw geometry::InputError("--weather", "",
                                   fmt::format("the file does not cover {}", daylight::formatTime(moment)));
    return *sky;
}

daylight::Moment SkySource::onClock(double utc) const {
    return moment_.solar ? daylight::solarMoment(utc, site_.longitudeDeg)
                         : daylight::momentFromUtc(utc, moment_.offsetMinutes);
}

daylight::SunDay SkySource::day() const {
    return daylight::sunDay(daylight::utcSeconds(moment_, site_.longitudeDeg), site_);
}

std::string SkySource::riseAndSet() const {
    const daylight::SunDay day = this->day();
    if (day.kind == daylight::DayKind::alwaysUp) return "it does not set that day";
    if (day.kind == daylight::DayKind::alwaysDown) return "it does not rise that day";
    const auto clock = [&](double utc) {
        const long minutes = std::lround(onClock(utc).second / 60);
        return fmt::format("{:02}:{:02}", minutes / 60 % 24, minutes % 60);
    };
    return fmt::format("it rises at {} and sets at {}", clock(day.sunriseUtc), clock(day.sunsetUtc));
}

void warnOfNight(Run& run, const SkySource& source, double maxLux) {
    const daylight::SunPosition sun = source.sunAt(source.moment());
    if (maxLux <= 0 && source.followsTime() && !sun.isUp())
        run.warn(fmt::format("the sun is {:.1f} degrees below the horizon: everything is dark; {}",
                             -sun.altitudeDeg, source.riseAndSet()));
}

daylight::Sky SkySource::reportedSky(Run& run) const {
    const daylight::Sky sky = skyAt(moment_);
    const double diffuse = daylight::diffuseHorizontalIlluminance(sky),
                 direct = daylight::directHorizontalIlluminance(sky);
    run.report()["sky"]["model"] = sky.model;
    run.report()["sky"]["ground_reflectance"] = sky.ground.albedo;
    run.report()["sky"]["outside_lux"] = {
        {"global", diffuse + direct}, {"diffuse", diffuse}, {"direct", direct}};
    if (followsTime()) {
        const daylight::SunPosition sun = sunAt(moment_);
        run.report()["time"] = daylight::formatTime(moment_);
        const daylight::SunDay day = this->day();
        const auto time = [&](double utc) -> nlohmann::json {
            if (day.kind != daylight::DayKind::risesAndSets) return nullptr;
            daylight::Moment at = onClock(utc);
            at.second = std::round(at.second);
            return daylight::formatTime(at);
        };
        run.report()["sky"]["sun"] = {{"altitude_deg", sun.altitudeDeg},
                                      {"azimuth_deg", sun.azimuthDeg},
                                      {"rise", time(day.sunriseUtc)},
                                      {"set", time(day.sunsetUtc)}};
    } else if (sky.hasSun()) {
        const glm::dvec3 d = sky.sun.direction;
        const double azimuth = setting_.northDeg - daylight::degrees(std::atan2(-d.z, d.x));
        run.report()["sky"]["sun"] = {
            {"altitude_deg", daylight::degrees(std::asin(std::clamp(d.y, -1.0, 1.0)))},
            {"azimuth_deg", azimuth - 360 * std::floor(azimuth / 360)}};
    }
    return sky;
}

bool sameLight(const daylight::Sky& a, const daylight::Sky& b) {
    if (a.isDark() && b.isDark()) return true;
    const daylight::SkyFormula &f = a.formula, &g = b.formula;
    const bool sameSun = (!a.hasSun() && !b.hasSun()) || (a.sun.direction == b.sun.direction &&
                                                          a.sun.normalIlluminance == b.sun.normalIlluminance);
    const bool roundSun = f.c != 0 || f.e != 0 || f.intermediate; // else the shape's direction is idle
    return sameSun && f.scale == g.scale && f.g0 == g.g0 && f.g1 == g.g1 && f.a == g.a && f.b == g.b &&
           f.zFloor == g.zFloor && f.i0 == g.i0 && f.c == g.c && f.d == g.d && f.e == g.e &&
           f.intermediate == g.intermediate && (!roundSun || a.shapeDirection == b.shapeDirection) &&
           a.ground.luminance == b.ground.luminance;
}

} // namespace heliodon::app
