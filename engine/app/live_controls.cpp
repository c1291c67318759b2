#include "engine/app/live_controls.h"

#include <cmath>

#include <fmt/format.h>

namespace heliodon::app {

namespace {

constexpr double kNotch = 1.0 / 6, kFineNotch = 1.0 / 60; // hours
constexpr int kManyDays = 7;
constexpr double kLongestPause = 0.5; // seconds: a display that stood still does not jump

} // namespace

LiveControls::LiveControls(const SkySource& source, const LiveArguments& arguments)
    : weather_(source.weather()), leavesOutScatter_(arguments.picture.compensateScatter) {
    setTime(source.moment());
    values.latitudeDeg = source.site().latitudeDeg;
    values.longitudeDeg = source.site().longitudeDeg;
    if (!arguments.moment.sky.empty()) values.sky = arguments.moment.sky;
    if (weather_) values.sky = present::kWeatherFile;
    values.skyColour = arguments.picture.skyColour;
    values.falseColour = arguments.picture.falseColor;
    values.autoExposure = !arguments.picture.exposure;
    values.whiteLux = arguments.picture.exposure.value_or(values.whiteLux);
}

daylight::Site LiveControls::site() const {
    if (showsWeather()) return weather_->site;
    return {values.latitudeDeg, values.longitudeDeg};
}

void LiveControls::setTime(const daylight::Moment& moment) {
    clock_ = moment;
    values.year = moment.date.year;
    values.dayOfYear = daylight::dayOfYear(moment.date);
    values.hour = moment.second / 3600;
}

daylight::Moment LiveControls::moment() const {
    daylight::Moment moment = clock_;
    moment.date =
        daylight::dateFromDays(daylight::daysSinceEpoch({values.year, 1, 1}) + values.dayOfYear - 1);
    moment.second = std::round(values.hour * 3600 * 1000) / 1000; // the slider's rounding is no other time
    return moment;
}

void LiveControls::addHours(double hours) {
    const double now = values.hour + hours, days = std::floor(now / 24);
    addDays(static_cast<int>(days));
    values.hour = now - 24 * days;
    if (values.hour >= 24 - 1e-9) values.hour = 0, addDays(1); // rounding
}

void LiveControls::addDays(int days) {
    const daylight::Date date =
        daylight::dateFromDays(daylight::daysSinceEpoch({values.year, 1, 1}) + values.dayOfYear - 1 + days);
    values.year = date.year;
    values.dayOfYear = daylight::dayOfYear(date);
}

void LiveControls::addPartOfDays(double days) {
    partOfDay_ += days;
    const int whole = static_cast<int>(partOfDay_);
    partOfDay_ -= whole;
    addDays(whole);
}

LiveControls::Effect LiveControls::handle(const present::Event& event) {
    const int days = event.control ? kManyDays : 1;
    const double hours = event.control ? kFineNotch : kNotch;
    if (event.kind == present::Event::Kind::wheel) {
        if (event.shift)
            addPartOfDays(days * event.notches); // a wheel of fine steps reports parts of a notch
        else
            addHours(hours * event.notches);
        return Effect::none;
    }
    using present::Shown;
    switch (event.key) {
    case 'Q':
    case present::kEscapeKey:
        return Effect::quit;
    case 'F':
        return Effect::fullScreen;
    case ' ':
        values.playing = !values.playing;
        break;
    case 'C':
        values.falseColour = !values.falseColour;
        break;
    case 'E':
        values.autoExposure = !values.autoExposure;
        break;
    case 'G':
        values.shown = Shown::grid;
        break;
    case 'W':
        values.shown = Shown::white;
        break;
    case 'B':
        values.shown = Shown::black;
        break;
    case 'I':
        values.shown = Shown::identify;
        break;
    case 'L':
        values.shown = Shown::light;
        break;
    case present::kLeftKey:
    case present::kRightKey:
        addHours(event.key == present::kRightKey ? hours : -hours);
        break;
    case present::kUpKey:
    case present::kDownKey:
        addDays(event.key == present::kUpKey ? days : -days);
        break;
    default:
        break;
    }
    return Effect::none;
}

void LiveControls::play() {
    const auto now = LiveClock::now();
    const double passed = std::min(kLongestPause, std::chrono::duration<double>(now - played_).count());
    played_ = now;
    if (!values.playing) return;
    if (!values.playDays) {
        addHours(values.speed * passed);
        return;
    }
    addPartOfDays(values.speed * passed);
}

bool LiveControls::lightChanged() const {
    return !everAsked_ || values.year != asked_.year || values.dayOfYear != asked_.dayOfYear ||
           values.hour != asked_.hour || values.latitudeDeg != asked_.latitudeDeg ||
           values.longitudeDeg != asked_.longitudeDeg || values.sky != asked_.sky ||
           values.skyColour != asked_.skyColour ||
           (leavesOutScatter_ && (values.autoExposure != asked_.autoExposure ||
                                  (!values.autoExposure && values.whiteLux != asked_.whiteLux)));
}

LightRequest LiveControls::request() {
    everAsked_ = true;
    asked_ = values;
    LightRequest request{
        moment(),          site(), values.sky, showsWeather() ? weather_ : nullptr, values.skyColour,
        leavesOutScatter_, {},     {}};
    if (leavesOutScatter_) request.whiteLux = whiteLux();
    return request;
}

bool LiveControls::pictureChanged() {
    const bool changed = values.falseColour != pictured_.falseColour || values.shown != pictured_.shown ||
                         values.autoExposure != pictured_.autoExposure ||
                         (!values.autoExposure && values.whiteLux != pictured_.whiteLux);
    pictured_ = values;
    return changed;
}

passes::Tone LiveControls::tone() const {
    passes::Tone tone;
    if (values.falseColour) tone.map = passes::ToneMap::falseColour;
    tone.whiteLux = whiteLux();
    return tone;
}

std::optional<double> LiveControls::whiteLux() const {
    return values.autoExposure ? std::nullopt : std::optional(values.whiteLux);
}

void LiveControls::describe(present::OperatorStatus& status) const {
    constexpr const char* kMonths[]{"January", "February", "March",     "April",   "May",      "June",
                                    "July",    "August",   "September", "October", "November", "December"};
    const daylight::Moment now = moment();
    const int minutes = static_cast<int>(now.second / 60 + 1e-6);
    status.clock = fmt::format("{:02}:{:02}", minutes / 60, minutes % 60);
    const int offset = std::abs(now.offsetMinutes);
    status.date = fmt::format("{} {} {}, {}", now.date.day, kMonths[now.date.month - 1], now.date.year,
                              now.solar ? "solar time"
                                        : fmt::format("UTC{}{:02}:{:02}", now.offsetMinutes < 0 ? '-' : '+',
                                                      offset / 60, offset % 60));
    const daylight::Site here = site();
    const daylight::SunPosition sun =
        daylight::sunPosition(daylight::utcSeconds(now, here.longitudeDeg), here);
    status.sun = sun.isUp() ? fmt::format("sun {:.0f}\u00b0 high, {:.0f}\u00b0 from north", sun.altitudeDeg,
                                          sun.azimuthDeg)
                            : fmt::format("sun {:.0f}\u00b0 below the horizon", -sun.altitudeDeg);
    if (weather_) status.weather = weather_->place.empty() ? "weather file" : weather_->place;
}

} // namespace heliodon::app
