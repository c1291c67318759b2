#include "engine/app/temporal_chart.h"

#include <fmt/format.h>

namespace heliodon::app {

namespace {

constexpr double kLeft = 52, kTop = 64, kDay = 2.5, kHour = 11, kRight = 90, kBottom = 34; // pixels

} // namespace

Chart temporalChart(const daylight::Weather& weather, std::span<const float> lux, const ValueScale& scale,
                    const std::string& title) {
    bool leap = false;
    for (const auto& hour : weather.hours) leap |= hour.date.month == 2 && hour.date.day == 29;
    const int year = leap ? 2024 : 2023; // typical years mix years: only month and day count
    const double width = kDay * (leap ? 366 : 365), height = kHour * 24;
    Chart chart(kLeft + width + kRight, kTop + height + kBottom);
    chart.rectangle(kLeft, kTop, width, height, {225, 225, 225}); // hours that the file lacks
    const double tall = kHour * weather.recordHours();
    for (size_t h = 0; h < weather.hours.size(); ++h) {
        const daylight::WeatherHour& hour = weather.hours[h];
        const double x = kLeft + kDay * (daylight::dayOfYear({year, hour.date.month, hour.date.day}) - 1);
        const double y = kTop + height - kHour * hour.clockHour - 0.5 * tall;
        chart.rectangle(x, y, kDay, tall, scale.ink(double{lux[h]}));
    }
    for (int month = 1; month <= 12; ++month) {
        const double x = kLeft + kDay * (daylight::dayOfYear({year, month, 1}) - 1);
        if (month > 1) chart.line({{x, kTop}, {x, kTop + height}}, kGrey, 0.5);
        chart.text({x + 15 * kDay, kTop + height + 18}, daylight::monthName(month).substr(0, 3), 11,
                   Anchor::middle);
    }
    for (int hour = 0; hour <= 24; hour += 6) {
        const double y = kTop + height - kHour * hour;
        chart.line({{kLeft - 4, y}, {kLeft + (hour % 24 ? width : 0), y}}, kGrey, 0.5);
        chart.text({kLeft - 8, y + 4}, fmt::format("{}:00", hour), 11, Anchor::end);
    }
    chart.text({kLeft, 26}, title, 15);
    chart.text({kLeft, 44},
               fmt::format("Weather of {}; standard time, UTC{:+g} h{}", weather.place, weather.timeZoneHours,
                           weather.hours.size() < static_cast<size_t>(8760 * weather.recordsPerHour)
                               ? "; grey is not in the file"
                               : ""),
               11);
    drawScale(chart, scale, {kLeft + width + 20, kTop + 10}, height - 10);
    return chart;
}

} // namespace heliodon::app
