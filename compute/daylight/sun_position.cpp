// I. Reda, A. Andreas, Solar Position Algorithm for Solar Radiation Applications, NREL/TP-560-34302, revised
// 2008. Section numbers below are the report's. Where ours differs: rise and set are solved on the full
// algorithm instead of by interpolation over three days (appendix A.2).
#include "compute/daylight/sun_position.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "compute/daylight/frame.h"
#include "compute/daylight/spa_tables.h"

namespace heliodon::daylight {

namespace {

constexpr double kDaySeconds = 86400.0;
constexpr double kRiseAltitudeDeg = -0.8333;
constexpr double kHourAngleRate = 360.0 / kDaySeconds; // of the mean sun, degrees per second

double wrap360(double deg) {
    const double wrapped = std::fmod(deg, 360.0);
    return wrapped < 0 ? wrapped + 360.0 : wrapped;
}

double wrap180(double deg) {
    const double wrapped = wrap360(deg);
    return wrapped > 180.0 ? wrapped - 360.0 : wrapped;
}

template<size_t n> double polynomial(const double (&coefficients)[n], double x) {
    double sum = 0;
    for (size_t i = n; i-- > 0;) sum = sum * x + coefficients[i];
    return sum;
}

double series(std::span<const spa::Term> terms, double tau) {
    double sum = 0;
    for (const auto& t : terms) sum += t.a * std::cos(t.b + t.c * tau);
    return sum;
}

// 3.2: earth's heliocentric longitude and latitude (degrees), radius (AU).
struct Earth {
    double longitude, latitude, radius;
};

Earth heliocentricEarth(double tau) {
    using namespace spa;
    const double l[] = {series(kL0, tau), series(kL1, tau), series(kL2, tau),
                        series(kL3, tau), series(kL4, tau), series(kL5, tau)};
    const double b[] = {series(kB0, tau), series(kB1, tau)};
    const double r[] = {series(kR0, tau), series(kR1, tau), series(kR2, tau), series(kR3, tau),
                        series(kR4, tau)};
    return {degrees(polynomial(l, tau) * 1e-8), degrees(polynomial(b, tau) * 1e-8),
            polynomial(r, tau) * 1e-8};
}

// 3.4: nutation in longitude and obliquity, degrees; t in Julian ephemeris centuries.
struct Nutation {
    double psi, epsilon;
};

Nutation nutation(double t) {
    const double d = polynomial({297.85036, 445267.111480, -0.0019142, 1.0 / 189474}, t);
    const double m = polynomial({357.52772, 35999.050340, -0.0001603, -1.0 / 300000}, t);
    const double mPrime = polynomial({134.96298, 477198.867398, 0.0086972, 1.0 / 56250}, t);
    const double f = polynomial({93.27191, 483202.017538, -0.0036825, 1.0 / 327270}, t);
    const double omega = polynomial({125.04452, -1934.136261, 0.0020708, 1.0 / 450000}, t);
    Nutation sum{0, 0};
    for (const auto& n : spa::kNutation) {
        const double angle = radians(n.d * d + n.m * m + n.mPrime * mPrime + n.f * f + n.omega * omega);
        sum.psi += (n.psi + n.psiPerCentury * t) * std::sin(angle);
        sum.epsilon += (n.epsilon + n.epsilonPerCentury * t) * std::cos(angle);
    }
    return {sum.psi / 36e6, sum.epsilon / 36e6};
}

// 3.3 and 3.5 to 3.10, the sun as seen from the earth's centre. Degrees, AU, minutes.
struct Geocentric {
    double rightAscension, declination, siderealTime, radius, equationOfTimeMin;
};

double defaultDeltaT(double utc) {
    const Date date = dateFromDays(static_cast<int64_t>(std::floor(utc / kDaySeconds)));
    return deltaTSeconds(date.year + (date.month - 0.5) / 12.0);
}

Geocentric geocentricSun(double utc, double deltaT) {
    const double days = utc / kDaySeconds - 10957.5; // since J2000 (2000-01-01T12:00), UT
    const double t = days / 36525.0;
    const double te = (days + deltaT / kDaySeconds) / 36525.0;
    const double tau = te / 10.0;

    const Earth earth = heliocentricEarth(tau);
    const Nutation nut = nutation(te);
    const double meanObliquity = polynomial(
        {84381.448, -4680.93, -1.55, 1999.25, -51.38, -249.67, -39.05, 7.12, 27.87, 5.79, 2.45}, tau / 10.0);
    const double obliquity = radians(meanObliquity / 3600.0 + nut.epsilon);
    const double aberration = -20.4898 / (3600.0 * earth.radius);
    const double lambda = radians(earth.longitude + 180.0 + nut.psi + aberration);
    const double beta = radians(-earth.latitude);

    Geocentric sun{};
    sun.radius = earth.radius;
    const double meanSidereal =
        280.46061837 + 360.98564736629 * days + t * t * (0.000387933 - t / 38710000.0);
    sun.siderealTime = wrap360(meanSidereal) + nut.psi * std::cos(obliquity);
    sun.rightAscension = wrap360(degrees(std::atan2(
        std::sin(lambda) * std::cos(obliquity) - std::tan(beta) * std::sin(obliquity), std::cos(lambda))));
    sun.declination = degrees(std::asin(std::sin(beta) * std::cos(obliquity) +
                                        std::cos(beta) * std::sin(obliquity) * std::sin(lambda)));
    // A.1: the sun's mean longitude against its right ascension.
    const double meanLongitude =
        polynomial({280.4664567, 360007.6982779, 0.03032028, 1.0 / 49931, -1.0 / 15300, -1.0 / 2000000}, tau);
    sun.equationOfTimeMin =
        4.0 * wrap180(meanLongitude - 0.0057183 - sun.rightAscension + nut.psi * std::cos(obliquity));
    return sun;
}

// 3.14: refraction lifts the disc; none well below the horizon.
double refraction(double altitudeDeg, const SunOptions& options) {
    if (altitudeDeg < -(0.26667 + options.horizonRefractionDeg)) return 0;
    return options.pressureMbar / 1010.0 * (283.0 / (273.0 + options.temperatureC)) * 1.02 /
           (60.0 * std::tan(radians(altitudeDeg + 10.3 / (altitudeDeg + 5.11))));
}

double geocentricAltitude(double utc, const Site& site) {
    const Geocentric sun = geocentricSun(utc, defaultDeltaT(utc));
    const double hourAngle = radians(sun.siderealTime + site.longitudeDeg - sun.rightAscension);
    const double latitude = radians(site.latitudeDeg), declination = radians(sun.declination);
    return degrees(std::asin(std::clamp(std::sin(latitude) * std::sin(declination) +
                                            std::cos(latitude) * std::cos(declination) * std::cos(hourAngle),
                                        -1.0, 1.0)));
}

double geocentricHourAngle(double utc, double longitudeDeg) {
    const Geocentric sun = geocentricSun(utc, defaultDeltaT(utc));
    return wrap180(sun.siderealTime + longitudeDeg - sun.rightAscension);
}

// Between an instant when the sun is below the rise altitude and one when it is above, to 0.01 s.
double crossing(double below, double above, const Site& site) {
    while (std::abs(above - below) > 0.01) {
        const double middle = 0.5 * (below + above);
        (geocentricAltitude(middle, site) < kRiseAltitudeDeg ? below : above) = middle;
    }
    return 0.5 * (below + above);
}

} // namespace

SunPosition sunPosition(double utc, const Site& site, const SunOptions& options) {
    const Geocentric sun = geocentricSun(utc, options.deltaTSeconds.value_or(defaultDeltaT(utc)));
    SunPosition p;
    p.rightAscensionDeg = sun.rightAscension;
    p.declinationDeg = sun.declination;
    p.earthSunAu = sun.radius;
    p.equationOfTimeMin = sun.equationOfTimeMin;
    p.hourAngleDeg = wrap180(sun.siderealTime + site.longitudeDeg - sun.rightAscension);

    // 3.11 to 3.13: parallax moves the sun by up to 8.8 arc seconds for an observer on the surface.
    const double h = radians(p.hourAngleDeg), declination = radians(sun.declination);
    const double latitude = radians(site.latitudeDeg);
    const double parallax = std::sin(radians(8.794 / (3600.0 * sun.radius)));
    const double u = std::atan(0.99664719 * std::tan(latitude));
    const double x = std::cos(u) + options.elevationM / 6378140.0 * std::cos(latitude);
    const double y = 0.99664719 * std::sin(u) + options.elevationM / 6378140.0 * std::sin(latitude);
    const double level = std::cos(declination) - x * parallax * std::cos(h);
    const double shift = std::atan2(-x * parallax * std::sin(h), level);
    const double localDeclination =
        std::atan2((std::sin(declination) - y * parallax) * std::cos(shift), level);
    const double localH = h - shift;

    // 3.14 and 3.15: altitude and azimuth.
    p.trueAltitudeDeg =
        degrees(std::asin(std::clamp(std::sin(latitude) * std::sin(localDeclination) +
                                         std::cos(latitude) * std::cos(localDeclination) * std::cos(localH),
                                     -1.0, 1.0)));
    p.altitudeDeg = p.trueAltitudeDeg + refraction(p.trueAltitudeDeg, options);
    p.azimuthDeg = wrap360(
        180.0 + degrees(std::atan2(std::sin(localH), std::cos(localH) * std::sin(latitude) -
                                                         std::tan(localDeclination) * std::cos(latitude))));
    return p;
}

double deltaTSeconds(double year) {
    const auto longTerm = [](double y) {
        return -20.0 + 32.0 * ((y - 1820.0) / 100.0) * ((y - 1820.0) / 100.0);
    };
    if (year < -500 || year >= 2150) return longTerm(year);
    if (year >= 2050) return longTerm(year) - 0.5628 * (2150.0 - year);
    const double t = year;
    if (year < 500)
        return polynomial({10583.6, -1014.41, 33.78311, -5.952053, -0.1798452, 0.022174192, 0.0090316521},
                          t / 100);
    if (year < 1600)
        return polynomial({1574.2, -556.01, 71.23472, 0.319781, -0.8503463, -0.005050998, 0.0083572073},
                          (t - 1000) / 100);
    if (year < 1700) return polynomial({120, -0.9808, -0.01532, 1.0 / 7129}, t - 1600);
    if (year < 1800) return polynomial({8.83, 0.1603, -0.0059285, 0.00013336, -1.0 / 1174000}, t - 1700);
    if (year < 1860)
        return polynomial({13.72, -0.332447, 0.0068612, 0.0041116, -0.00037436, 0.0000121272, -0.0000001699,
                           0.000000000875},
                          t - 1800);
    if (year < 1900)
        return polynomial({7.62, 0.5737, -0.251754, 0.01680668, -0.0004473624, 1.0 / 233174}, t - 1860);
    if (year < 1920) return polynomial({-2.79, 1.494119, -0.0598939, 0.0061966, -0.000197}, t - 1900);
    if (year < 1941) return polynomial({21.20, 0.84493, -0.076100, 0.0020936}, t - 1920);
    if (year < 1961) return polynomial({29.07, 0.407, -1.0 / 233, 1.0 / 2547}, t - 1950);
    if (year < 1986) return polynomial({45.45, 1.067, -1.0 / 260, -1.0 / 718}, t - 1975);
    if (year < 2005)
        return polynomial({63.86, 0.3345, -0.060374, 0.0017275, 0.000651814, 0.00002373599}, t - 2000);
    return polynomial({62.92, 0.32217, 0.005589}, t - 2000);
}

double utcSeconds(const Moment& moment, double longitudeDeg) {
    if (!moment.solar) return clockSeconds(moment);
    const double wanted = (moment.second - 0.5 * kDaySeconds) * kHourAngleRate;
    double utc = clockSeconds(moment) - longitudeDeg / kHourAngleRate;
    // The mean sun is within 17 minutes of the true one, and the true one's rate within 0.04 % of the mean's:
    // each round gains more than three digits.
    for (int round = 0; round < 4; ++round)
        utc -= wrap180(geocentricHourAngle(utc, longitudeDeg) - wanted) / kHourAngleRate;
    return utc;
}

Moment solarMoment(double utc, double longitudeDeg) {
    // The date comes from mean solar time, then the time of day moves by the equation of time.
    const double mean = utc + longitudeDeg / kHourAngleRate;
    const double day = std::floor(mean / kDaySeconds);
    const double ofDay = mean - day * kDaySeconds;
    const double apparent = 0.5 * kDaySeconds + geocentricHourAngle(utc, longitudeDeg) / kHourAngleRate;
    const double shift = wrap180((apparent - ofDay) * kHourAngleRate) / kHourAngleRate;
    Moment moment = momentFromUtc(mean + shift);
    moment.solar = true;
    return moment;
}

SunDay sunDay(double utc, const Site& site) {
    SunDay day;
    day.transitUtc = utc;
    for (int round = 0; round < 4; ++round)
        day.transitUtc -= geocentricHourAngle(day.transitUtc, site.longitudeDeg) / kHourAngleRate;
    const double before = day.transitUtc - 0.5 * kDaySeconds, after = day.transitUtc + 0.5 * kDaySeconds;
    if (geocentricAltitude(day.transitUtc, site) < kRiseAltitudeDeg) {
        day.kind = DayKind::alwaysDown;
    } else if (std::max(geocentricAltitude(before, site), geocentricAltitude(after, site)) >=
               kRiseAltitudeDeg) {
        day.kind = DayKind::alwaysUp;
    } else {
        day.sunriseUtc = crossing(before, day.transitUtc, site);
        day.sunsetUtc = crossing(after, day.transitUtc, site);
    }
    return day;
}

} // namespace heliodon::daylight
