// Where, when and under which sky: the command line's words made into skies over one scene.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "compute/daylight/sky.h"
#include "compute/daylight/sun_position.h"
#include "compute/daylight/time.h"
#include "compute/daylight/weather.h"
#include "engine/app/arguments.h"
#include "engine/app/run.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

class SkySource {
public:
    // What the user left open is taken from the rig or the defaults, printed once and kept in the report.
    SkySource(Run& run, const MomentArguments& arguments, const Scene& scene);
    // Nothing left open. `sky` is as `--sky` has it.
    SkySource(const daylight::Site& site, std::string sky, double northDeg,
              geometry::UpAxis up = geometry::UpAxis::y);
    // The hours of a weather file, at its site.
    SkySource(std::shared_ptr<const daylight::Weather> weather, double northDeg);

    // Of `moment()`, for drawings: "21 March 2026, 13:00 solar time, clear sky, 42.73 N 73.68 W".
    std::string title() const;
    // The sky and, where it matters, the place: "clear sky, 42.73 N 73.68 W".
    std::string skyInWords() const;
    // Of the day of `moment()`, on its clock: "it rises at 06:08 and sets at 17:52".
    std::string riseAndSet() const;
    // Whether the sky is another one at another time; not so of sky files.
    bool followsTime() const;
    // A warning where it is not, for whoever asks for times (`--time` is warned of already).
    void warnOfOneLight(Run& run) const;
    // `--time`, or its default.
    const daylight::Moment& moment() const { return moment_; }
    const daylight::Site& site() const { return site_; }
    // Null where the sky is not a weather file's.
    const std::shared_ptr<const daylight::Weather>& weather() const { return weather_; }
    daylight::SunPosition sunAt(const daylight::Moment& moment) const;
    // Throws InputError for moments that the weather file does not cover.
    daylight::Sky skyAt(const daylight::Moment& moment) const;
    // skyAt(moment()), with what it gives an unobstructed horizontal plane in the report's `sky`.
    daylight::Sky reportedSky(Run& run) const;

private:
    daylight::SunDay day() const;               // of moment()
    daylight::Moment onClock(double utc) const; // the clock of moment()

    daylight::Site site_;
    daylight::Moment moment_; // as constructed: 21 March, 13:00 apparent solar time
    std::string option_;
    geometry::UpAxis up_ = geometry::UpAxis::y;
    daylight::SkySetting setting_;
    std::optional<double> groundAlbedo_; // as asked for: goes before that of a sky file
    std::shared_ptr<const daylight::Weather> weather_;
};

// A warning where nothing is lit, `maxLux` being 0, because the sun of `source.moment()` has set.
void warnOfNight(Run& run, const SkySource& source, double maxLux);

// Whether two skies give the same light: nothing need be solved or drawn again.
bool sameLight(const daylight::Sky& a, const daylight::Sky& b);

} // namespace heliodon::app
