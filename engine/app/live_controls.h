// What keys, wheel, operator's window and play have set: when, where, under which sky, and how it is shown.
#pragma once

#include <memory>

#include "engine/app/live_light.h"
#include "engine/app/moment.h"
#include "engine/passes/tone.h"
#include "engine/present/operator_window.h"

namespace heliodon::app {

class LiveControls {
public:
    // `source`: what the display begins with; of its weather file, if it has one, all hours can be chosen.
    LiveControls(const SkySource& source, const LiveArguments& arguments);

    present::OperatorControls values;

    enum class Effect { none, quit, fullScreen };
    // Changes the values; what is left to the caller is returned.
    Effect handle(const present::Event& event);
    // Goes on by the time since the last call, where it plays.
    void play();
    void setTime(const daylight::Moment& moment);

    // What decides the light is not what it was when `request` was called last.
    bool lightChanged() const;
    LightRequest request();
    // What decides how light is shown is not what it was at the last call.
    bool pictureChanged();

    passes::Tone tone() const;
    daylight::Moment moment() const;
    // Fills in clock, date and sun.
    void describe(present::OperatorStatus& status) const;

private:
    std::optional<double> whiteLux() const; // none: that of the light at hand
    bool showsWeather() const { return weather_ && values.sky == present::kWeatherFile; }
    daylight::Site site() const;
    void addHours(double hours);
    void addDays(int days);
    void addPartOfDays(double days);

    daylight::Moment clock_;                           // whose kind of clock is kept: solar, or an offset
    std::shared_ptr<const daylight::Weather> weather_; // null: no file was given
    present::OperatorControls asked_, pictured_;
    bool everAsked_ = false;
    bool leavesOutScatter_;
    LiveClock::time_point played_{};
    double partOfDay_ = 0; // left over
};

} // namespace heliodon::app
