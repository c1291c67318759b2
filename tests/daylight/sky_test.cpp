#include "compute/daylight/sky.h"

#include <array>
#include <cmath>
#include <fstream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight/frame.h"
#include "compute/daylight/horizon_ribbon.h"
#include "compute/daylight/sky_grid.h"
#include "compute/daylight/sky_table.h"
#include "geometry/input_error.h"
#include "tests/daylight/csv.h"
#include "tests/documented_file.h"

namespace heliodon::daylight {
namespace {

glm::dvec3 towards(double azimuthDeg, double zenithDeg) {
    return directionInWorld({azimuthDeg, 90 - zenithDeg}, 90);
}

SunPosition sunAt(double azimuthDeg, double altitudeDeg) {
    SunPosition sun;
    sun.azimuthDeg = azimuthDeg;
    sun.altitudeDeg = sun.trueAltitudeDeg = altitudeDeg;
    return sun;
}

TEST(CieSky, agrees_with_the_table_of_all_sixteen_types) {
    const test::Csv table("cie_general_luminance.csv.gz");
    ASSERT_EQ(table.rows.size(), 12376u);
    for (size_t i = 0; i < table.rows.size(); ++i) {
        const double viewZenith = table.number(i, "view_zenith_deg");
        if (viewZenith >= 90) continue; // on the horizon itself sky and ground meet
        const Sky sky = cieGeneralSky(static_cast<int>(table.number(i, "type")),
                                      towards(100, table.number(i, "sun_zenith_deg")), 1.0);
        const double expected = table.number(i, "L_over_Lz");
        // 1e-6 relative; the table has eight digits.
        ASSERT_NEAR(sky.luminance(towards(100 + table.number(i, "rel_azimuth_deg"), viewZenith)), expected,
                    1e-6 * expected + 1e-8)
            << "row " << i + 2;
    }
}

TEST(CieSky, horizontal_illuminance_agrees_with_the_table) {
    const test::Csv table("cie_general_integrals.csv.gz");
    double worst = 0;
    for (size_t i = 0; i < table.rows.size(); ++i) {
        const Sky sky = cieGeneralSky(static_cast<int>(table.number(i, "type")),
                                      towards(17, table.number(i, "sun_zenith_deg")), 1000.0);
        const double ratio = diffuseHorizontalIlluminance(sky) / (1000.0 * table.number(i, "Eh_over_Lz_sr"));
        worst = std::max(worst, std::abs(ratio - 1));
        // The table's own quadrature differs from itself by up to 1e-4, in its last column.
        EXPECT_NEAR(ratio, 1, 1e-5 + table.number(i, "quadrature_self_difference")) << "row " << i + 2;
    }
    RecordProperty("worst_relative", std::to_string(worst));
}

TEST(Sky, integral_is_exact_where_it_has_a_closed_form) {
    EXPECT_NEAR(diffuseHorizontalIlluminance(cieGeneralSky(5, towards(0, 30), 100)), 100 * kPi,
                1e-9 * 100 * kPi);
    EXPECT_NEAR(diffuseHorizontalIlluminance(cieGeneralSky(16, towards(0, 30), 9.0 / (7 * kPi))), 1.0, 1e-9);
}

TEST(PerezSky, coefficients_and_luminances_agree_with_the_tables) {
    const test::Csv shapes("perez_abcde.csv.gz");
    for (size_t i = 0; i < shapes.rows.size(); ++i) {
        const PerezShape s = perezShape(shapes.number(i, "eps"), shapes.number(i, "delta"),
                                        radians(shapes.number(i, "sun_zenith_deg")));
        const double got[] = {s.a, s.b, s.c, s.d, s.e};
        const char* names[] = {"a", "b", "c", "d", "e"};
        for (size_t k = 0; k < 5; ++k) {
            const double expected = shapes.number(i, names[k]);
            EXPECT_NEAR(got[k], expected, 1e-6 * std::max(1.0, std::abs(expected)))
                << "row " << i + 2 << " " << names[k];
        }
    }
    const test::Csv table("perez_luminance.csv.gz");
    ASSERT_EQ(table.rows.size(), 7040u);
    Sky sky;
    std::string last;
    double unit = 1;
    for (size_t i = 0; i < table.rows.size(); ++i) {
        const double eps = table.number(i, "eps"), delta = table.number(i, "delta"),
                     sunZenith = table.number(i, "sun_zenith_deg");
        const std::string key =
            table.text(i, "eps") + "," + table.text(i, "delta") + "," + table.text(i, "sun_zenith_deg");
        if (key != last) {
            sky = perezSky(perezShape(eps, delta, radians(sunZenith)), towards(0, sunZenith), 1.0);
            unit = diffuseHorizontalIlluminance(sky);
            last = key;
        }
        const double viewZenith = table.number(i, "view_zenith_deg");
        if (viewZenith >= 90) continue;
        const double luminance = sky.luminance(towards(table.number(i, "rel_azimuth_deg"), viewZenith));
        const double expected = std::max(0.0, table.number(i, "l_rel"));
        ASSERT_NEAR(luminance, expected, 1e-5 * expected + 1e-6) << "row " << i + 2;
        const double perEh = table.number(i, "L_per_unit_Eh_sr-1");
        ASSERT_NEAR(luminance / unit, perEh, 1e-5 * perEh + 1e-7) << "row " << i + 2;
    }
}

// Sky files of rooms rendered with Radiance: the file's own integrals are recomputed from its formula.
TEST(SkyFile, integrals_are_those_stated_in_the_file) {
    struct Case {
        const char* file;
        double diffuse, direct, ground;
    };
    for (const auto& c : {Case{"sky_clear.json", 8286.58619086585, 51057.184456201496, 3777.9417760769975},
                          Case{"sky_overcast.json", 13322.576917556105, 0, 848.1415884604163},
                          Case{"sky_perez.json", 10260.241081880684, 1995.0067072504519, 0}}) {
        const Sky sky = readSky(test::dataFile(c.file));
        EXPECT_NEAR(diffuseHorizontalIlluminance(sky) / c.diffuse, 1, 2e-5)
            << c.file; // the file's quadrature
        EXPECT_NEAR(directHorizontalIlluminance(sky), c.direct, 1e-6 * c.direct) << c.file;
        EXPECT_DOUBLE_EQ(sky.ground.luminance, c.ground);
        EXPECT_DOUBLE_EQ(sky.luminance({0.6, -0.8, 0}), c.ground);
    }
    // z up in the file: south (-y) is world +z.
    const Sky clear = readSky(test::dataFile("sky_clear.json"));
    EXPECT_NEAR(clear.sun.direction.z, 0.6605825836078449, 1e-12);
    EXPECT_NEAR(readSky(test::dataFile("sky_clear.json"), geometry::UpAxis::y).shapeDirection.z,
                0.7047315557789464, 1e-12);
}

TEST(SkyOption, named_skies_are_those_of_gensky) {
    // gensky 3 21 +13 -a 42.73 -o 73.68 -m 75 puts the sun at 44.807 degrees.
    const double altitude = degrees(std::asin(0.7047315557789464));
    const SunPosition sun = sunAt(180 + 21.4, altitude);
    const Sky clear = skyFromOption("clear", sun, {});
    // gensky prints four digits.
    EXPECT_NEAR(clear.sun.normalIlluminance / 72449.12, 1, 5e-4);
    EXPECT_NEAR(clear.luminance({0, 1, 0}) / 1701.467, 1, 1e-3); // its norm has 0.274 for 1 - exp(-0.32)
    EXPECT_NEAR(diffuseHorizontalIlluminance(clear) / 8286.586, 1, 1e-3);
    EXPECT_NEAR(clear.ground.luminance / 3777.94, 1, 1e-3);
    const Sky overcast = skyFromOption("overcast", sun, {});
    EXPECT_NEAR(overcast.luminance({0, 1, 0}) / 5452.34, 1, 1e-4);
    EXPECT_FALSE(overcast.hasSun());
    const Sky intermediate = skyFromOption("intermediate", sun, {});
    EXPECT_NEAR(intermediate.luminance({0, 1, 0}) / (0.5 * (1702.469 + 5452.34)), 1, 1e-3);
    EXPECT_NEAR(intermediate.sun.normalIlluminance / (0.15 * 72449.12), 1, 5e-4);
}

// gensky approximates E_h / Lz of its clear and intermediate skies by a polynomial over F2, both printed in
// its source.
TEST(SkyOption, horizontal_illuminance_agrees_with_genskys_normalisation) {
    const auto polynomial = [](const double(&k)[5], double x) {
        return k[0] + x * (k[1] + x * (k[2] + x * (k[3] + x * k[4])));
    };
    for (const double altitude : {10.0, 25.0, 44.8, 60.0, 75.0}) {
        const double h = radians(altitude), x = (h - kPi / 4) / (kPi / 4), z = kPi / 2 - h;
        const double clearF2 = 0.274 * (0.91 + 10 * std::exp(-3 * z) + 0.45 * std::sin(h) * std::sin(h));
        const double middleF2 =
            (2.739 + 0.9891 * std::sin(0.3119 + 2.6 * h)) * std::exp(-z * (0.4441 + 1.48 * h));
        const double clear = polynomial({2.766521, 0.547665, -0.369832, 0.009237, 0.059229}, x) / clearF2;
        const double middle = polynomial({3.5556, -2.7152, -1.3081, 1.0660, 0.60227}, x) / middleF2;
        const glm::dvec3 sun = towards(140, 90 - altitude);
        EXPECT_NEAR(diffuseHorizontalIlluminance(cieClearSky(sun, 1)) / clear, 1, 0.015) << altitude;
        EXPECT_NEAR(diffuseHorizontalIlluminance(cieIntermediateSky(sun, 1)) / middle, 1, 0.05) << altitude;
    }
}

TEST(SkyOption, perez_numbers_are_those_of_gendaylit) {
    // gendaylit 12 21 +9 -W 150 80 -a 42.73 -o 73.68: epsilon 1.5158, delta 0.2680.
    SunPosition sun = sunAt(180 - 41.5, degrees(std::asin(0.2064729651958875)));
    sun.earthSunAu = 0.98378; // 21 December
    const Sky sky = skyFromOption("perez:150,80", sun, {});
    EXPECT_NEAR(sky.sun.normalIlluminance / 9662.31, 1, 2e-3);
    // gendaylit normalises over 145 patches, which costs half a percent here.
    EXPECT_NEAR(diffuseHorizontalIlluminance(sky) / 10260.24, 1, 7e-3);
    const double shape[] = {-1.266925, -0.686151, 10.736684, -3.151502, -0.018776};
    EXPECT_NEAR(sky.formula.a, shape[0], 5e-3);
    EXPECT_NEAR(sky.formula.c, shape[2], 3e-2);
    EXPECT_NEAR(sky.formula.d, shape[3], 1e-2);
}

TEST(SkyOption, every_cie_type_is_lit_by_day_and_dark_by_night) {
    for (int type = 1; type <= 15; ++type) {
        const std::string option = "cie:" + std::to_string(type);
        for (const double altitude : {0.01, 1.0, 20.0, 89.9}) {
            const Sky sky = skyFromOption(option, sunAt(90, altitude), {});
            const double diffuse = diffuseHorizontalIlluminance(sky);
            EXPECT_TRUE(std::isfinite(diffuse) && diffuse > 0) << option << " " << altitude;
            EXPECT_EQ(sky.hasSun(), type > 6);
            EXPECT_NEAR(sky.ground.luminance * kPi / 0.2 / globalHorizontalIlluminance(sky), 1, 1e-9);
        }
    }
    for (const char* option : {"clear", "overcast", "intermediate", "cie:12"})
        for (const double altitude : {-90.0, -7.0, -0.01})
            EXPECT_TRUE(skyFromOption(option, sunAt(90, altitude), {}).isDark()) << option;
}

TEST(SkyOption, perez_numbers_in_twilight_are_those_of_a_weather_record) {
    for (const double altitude : {-0.01, -3.0, -5.99}) {
        const SunPosition sun = sunAt(90, altitude);
        const Sky sky = skyFromOption("perez:20,15", sun, {}), record = skyFromIrradiance({20, 15}, sun);
        EXPECT_FALSE(sky.hasSun()) << altitude;
        EXPECT_GT(sky.formula.scale, 0) << altitude;
        EXPECT_EQ(sky.formula.scale, record.formula.scale) << altitude;
        EXPECT_EQ(sky.ground.luminance, record.ground.luminance) << altitude;
    }
    for (const double altitude : {-6.01, -90.0})
        EXPECT_TRUE(skyFromOption("perez:20,15", sunAt(90, altitude), {}).isDark()) << altitude;
}

TEST(SkyTables, have_the_formulas_luminance) {
    for (const double altitude : {0.5, 5.0, 40.0, 89.0})
        for (const double direct : {0.0, 100.0, 900.0}) {
            const Sky sky = skyFromIrradiance({direct, 100}, sunAt(140, altitude));
            constexpr size_t kPlace = 3; // beside black ones
            std::array<const Sky*, SkyTables::kSkies> skies{};
            skies[kPlace] = &sky;
            const SkyTables tables(skies);
            for (double zenith = 0.25; zenith < 89; zenith += 4.5)
                for (double azimuth = 0; azimuth < 360; azimuth += 10) {
                    const glm::dvec3 d = towards(azimuth, zenith);
                    const double exact = sky.luminance(d), brightest = sky.luminance(towards(140, zenith));
                    // Linear between 512 places: 2e-3 near the horizon, whose gradation is steepest.
                    SkyTables::Floats sums{};
                    tables.add(glm::vec3(d), SkyTables::heightIndex(d.y), 2.0f, sums);
                    ASSERT_NEAR(sums[kPlace], 2 * exact, 4e-3 * std::max(exact, brightest))
                        << altitude << " " << direct << " " << zenith << " " << azimuth;
                    ASSERT_EQ(sums[0], 0);
                }
        }
    const Sky other = cieIntermediateSky(towards(0, 30), 1000);
    const std::array<const Sky*, SkyTables::kSkies> skies{&other};
    EXPECT_THROW(SkyTables{skies}, std::invalid_argument);
}

// Places between nodes, at nodes, about the zenith and down to the horizon; skies with a bright sun and steep
// gradations, and what a low sun makes of the fit.
TEST(SkyGrid, has_the_luminance_at_places_and_of_the_whole) {
    const SkyGrid grid;
    std::vector<Sky> skies{cieIntermediateSky(towards(140, 30), 1000)};
    for (const double altitude : {0.5, 1.0, 2.0, 5.0, 40.0, 89.0})
        for (const double direct : {0.0, 100.0, 900.0})
            for (const double diffuse : {10.0, 30.0, 100.0, 300.0})
                skies.push_back(skyFromIrradiance({direct, diffuse}, sunAt(140, altitude)));
    for (int type = 1; type <= 16; ++type) skies.push_back(cieGeneralSky(type, towards(140, 70), 1000));
    std::vector<double> zeniths{89.99, 89.95, 89.9, 89.8, 89.7, 89.6, 89.5, 89.43, 89.3};
    for (double zenith = 89.13; zenith > 0; zenith -= zenith > 80 ? 0.3 : 2.2) zeniths.push_back(zenith);
    size_t smooth = 0;
    for (const Sky& sky : skies) {
        if (!grid.isSmoothWithHeight(sky)) continue;
        ++smooth;
        const auto told = [&](glm::dvec3 d) {
            double sum = 0, whole = 0;
            for (const auto& [node, weight] : grid.sharesOf(d)) {
                sum += weight * sky.luminance(glm::dvec3(grid.nodes()[node]));
                whole += weight;
            }
            EXPECT_NEAR(whole, 1, 1e-12);
            return sum;
        };
        double nearSun = 0, away = 0, brightest = 0, sum = 0, exactly = 0;
        for (const double zenith : zeniths)
            for (double azimuth = 0.4; azimuth < 360; azimuth += 4.3) {
                const glm::dvec3 d = towards(azimuth, zenith);
                const double exact = sky.luminance(d), off = std::abs(told(d) - exact);
                double& worst = glm::dot(d, sky.shapeDirection) > std::cos(5 * kPi / 180) ? nearSun : away;
                worst = std::max(worst, off);
                brightest = std::max(brightest, exact);
            }
        for (double zenith = 0.13; zenith < 90; zenith += 1.1)
            for (double azimuth = 0.4; azimuth < 360; azimuth += 2.3) {
                const double solid = std::sin(zenith * kPi / 180) * std::cos(zenith * kPi / 180);
                const glm::dvec3 d = towards(azimuth, zenith);
                sum += solid * told(d), exactly += solid * sky.luminance(d);
            }
        EXPECT_LT(nearSun, 5e-2 * brightest) << sky.formula.a << " " << sky.formula.b;
        EXPECT_LT(away, 3e-3 * brightest) << sky.formula.a << " " << sky.formula.b;
        EXPECT_NEAR(sum, exactly, 1e-4 * exactly) << sky.formula.a << " " << sky.formula.b;
        for (size_t n = 0; n < grid.nodes().size(); n += 97) {
            const glm::dvec3 node = glm::normalize(glm::dvec3(grid.nodes()[n]));
            EXPECT_NEAR(told(node), sky.luminance(node), 1e-4 * brightest) << n; // nodes are floats
        }
    }
    EXPECT_GE(smooth, skies.size() / 2);
}

// Skies that are black up to a height just above the horizon.
TEST(SkyGrid, is_not_asked_of_skies_too_steep_for_it) {
    const SkyGrid grid;
    for (const auto& [altitude, direct, diffuse] :
         {std::array{2.0, 400.0, 30.0}, {1.0, 600.0, 10.0}, {3.0, 800.0, 20.0}}) {
        const Sky sky = skyFromIrradiance({direct, diffuse}, sunAt(140, altitude));
        ASSERT_FALSE(hasHorizonRibbon(sky.formula));
        EXPECT_EQ(sky.luminance(towards(140, 89.9)), 0);
        EXPECT_FALSE(grid.isSmoothWithHeight(sky)) << altitude;
    }
    EXPECT_TRUE(grid.isSmoothWithHeight(skyFromIrradiance({800, 100}, sunAt(140, 30))));
}

TEST(PerezSky, keeps_the_efficacy_models_illuminance_for_any_weather) {
    for (const double altitude : {-5.0, -0.1, 0.01, 0.5, 3.0, 10.0, 45.0, 89.99})
        for (const double direct : {0.0, 1.0, 100.0, 600.0, 1050.0})
            for (const double diffuse : {0.0, 0.5, 10.0, 100.0, 600.0}) {
                const Sky sky = skyFromIrradiance({direct, diffuse}, sunAt(200, altitude));
                const double lux = diffuseHorizontalIlluminance(sky);
                ASSERT_TRUE(std::isfinite(lux));
                // The efficacies of the fit lie between 60 and 220 lm/W.
                if (diffuse >= 0.5) {
                    EXPECT_GT(lux, 60 * diffuse) << altitude << " " << direct << " " << diffuse;
                    EXPECT_LT(lux, 220 * diffuse) << altitude << " " << direct << " " << diffuse;
                }
                EXPECT_EQ(sky.hasSun() && altitude < 0, false);
                for (const double z : {0.0, 40.0, 85.0, 89.99})
                    ASSERT_TRUE(std::isfinite(sky.luminance(towards(10, z))));
            }
}

// Where b > 0 nearly all light comes from a ribbon at the horizon: against the midpoint rule in azimuth and
// in altitude, by steps that are even in the ribbon and grow with the square of the distance above it.
TEST(PerezSky, ribbon_at_the_horizon_is_integrated) {
    for (const auto& [altitude, direct, diffuse] :
         {std::array{0.5, 300.0, 25.0}, {1.0, 300.0, 30.0}, {2.0, 350.0, 40.0}, {3.0, 600.0, 50.0}}) {
        const Sky sky = skyFromIrradiance({direct, diffuse}, sunAt(200, altitude));
        const SkyFormula& f = sky.formula;
        ASSERT_TRUE(f.a > 0 && f.b > 0);
        const double edge = std::asin(f.zFloor), sunLevel = std::sqrt(1 - std::pow(sky.shapeDirection.y, 2));
        const auto ring = [&](double h) {
            double sum = 0;
            const int round = 240;
            for (int j = 0; j < round; ++j)
                sum += indicatrix(f, std::sin(h) * sky.shapeDirection.y +
                                         std::cos(h) * sunLevel * std::cos(kPi * (j + 0.5) / round));
            return gradation(f, std::sin(h)) * std::sin(h) * std::cos(h) * sum / round;
        };
        double lux = 0;
        const int steps = 2000;
        for (int k = 0; k < steps; ++k) {
            const double t = (k + 0.5) / steps, above = kPi / 2 - edge;
            lux += edge * ring(edge * t) + 2 * t * above * ring(edge + above * t * t);
        }
        lux *= f.scale * 2 * kPi / steps;
        // 1e-5 stated; the midpoint rule at the sun's cone adds up to 5e-5.
        EXPECT_NEAR(diffuseHorizontalIlluminance(sky) / lux, 1, 6e-5) << altitude;
    }
}

// Against the midpoint rule.
TEST(HorizonRibbon, is_what_the_sky_has_more_than_the_even_one) {
    for (const auto& [a, b] : {std::array{2.0, 0.02}, {0.3, 0.3}, {2.0, 0.7}, {-0.98, -0.02}}) {
        const Sky sky = perezSky({a, b, 0, -1, 0}, {0, 1, 0}, 1), even = withoutRibbon(sky);
        ASSERT_TRUE(hasHorizonRibbon(sky.formula));
        EXPECT_FALSE(hasHorizonRibbon(even.formula));
        const HorizonRibbon ribbon(sky.formula);
        for (const auto& [low, high] : {std::array{0.0, 1.0},
                                        {0.002, 0.007},
                                        {0.004, 0.0102},
                                        {0.0101, 0.0101001},
                                        {0.012, 0.4},
                                        {0.03, 0.05},
                                        {0.2, 0.3},
                                        {0.26, 0.5},
                                        {0.1, 0.1}}) {
            double light = 0, moment = 0;
            constexpr int kSteps = 100'000;
            for (int k = 0; k < kSteps; ++k) { // many steps low
                const double t = (k + 0.5) / kSteps, z = low + (high - low) * t * t;
                const double share =
                    2 * t * (high - low) / kSteps * (gradation(sky.formula, z) - gradation(even.formula, z));
                light += share, moment += share * z;
            }
            const HorizonRibbon::Integral sum = ribbon.between(low, high);
            EXPECT_NEAR(sum.light, light, 1e-5 * light) << b << ": " << low << " to " << high;
            EXPECT_NEAR(sum.moment, moment, 1e-5 * moment) << b << ": " << low << " to " << high;
        }
    }
    for (int type = 1; type <= 16; ++type)
        EXPECT_FALSE(hasHorizonRibbon(cieGeneralSky(type, {0, 1, 0}, 1).formula)) << type;
}

TEST(SkyOption, wrong_options_are_refused_by_name) {
    for (const char* option :
         {"", "sunny", "cie:", "cie:0", "cie:16", "cie:1.5", "cie:x", "perez:", "perez:1", "perez:1,2,3",
          "perez:-1,2", "perez:nan,1", "perez:1e9,1", "perez:100,inf", "Clear "})
        EXPECT_THROW(skyFromOption(option, sunAt(180, 40), {}), geometry::InputError) << option;
    EXPECT_THROW(skyFromOption("missing.json", sunAt(180, 40), {}), geometry::InputError);
}

TEST(SkyFile, wrong_fields_are_named) {
    const std::string file = testing::TempDir() + "heliodon_sky_test.json";
    struct Case {
        const char* text;
        const char* place;
    };
    const std::vector<Case> cases{
        {"", ": is empty, expected "},
        {"[1,2", ":1: "},
        {"[]", ": "},
        {"{\"format\":\"vh-sky/1\"", ":1: "},
        {R"({"model":"perez"})", ":format: "},
        {R"({"format":"vh-sky/2","model":"perez"})", ":format: "},
        {R"({"format":"vh-sky/1"})", ":model: "},
        {R"({"format":"vh-sky/1","model":7})", ":model: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast"})", ":zenith_luminance_cdm2: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":"1"})",
         ":zenith_luminance_cdm2: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":-1})",
         ":zenith_luminance_cdm2: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1e999})",
         ":1: 1e999 is too large"},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"ground":3})", ":ground: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"ground":{"albedo":2}})",
         ":ground.albedo: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"sun":[]})", ":sun: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"sun":{"direction":[0,0,1]}})",
         ":sun.normal_illuminance_lux: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"sun":{"direction":[0,0,1],"normal_iluminance_lux":1}})",
         ":sun.normal_iluminance_lux: is no field of a sky, expected \"normal_illuminance_lux\""},
        {R"({"format":"vh-sky/1","model":"cie_clear","Lz_cdm2":1})", ":sun_direction: "},
        {R"({"format":"vh-sky/1","model":"cie_clear","Lz_cdm2":1,"sun_direction":[0,0,0]})",
         ":sun_direction: "},
        {R"({"format":"vh-sky/1","model":"cie_clear","Lz_cdm2":1,"sun_direction":[0,0,"1"]})",
         ":sun_direction[2]: "},
        {R"({"format":"vh-sky/1","model":"cie_clear","Lz_cdm2":1,"sun_direction":[0,0,1],"norm":0})",
         ":norm: "},
        {R"({"format":"vh-sky/1","model":"cie_general","type":2.5,"sun_direction":[0,0,1]})", ":type: "},
        {R"({"format":"vh-sky/1","model":"cie_general","type":17,"sun_direction":[0,0,1]})", ":type: "},
        {R"({"format":"vh-sky/1","model":"cie_general","type":3})", ":sun_direction: "},
        {R"({"format":"vh-sky/1","model":"perez","A_cdm2":1,"sun_direction":[0,0,1],"abcde":[1,2,3]})",
         ":abcde: "},
        {R"({"format":"vh-sky/1","model":"perez","A_cdm2":1,"sun_direction":[0,0,1],"abcde":[1,9,3,4,5]})",
         ":abcde: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"snu":{}})", ":snu: "},
        {R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":1,"ground":{"albdeo":1}})",
         ":ground.albdeo: "}};
    for (const auto& c : cases) {
        std::ofstream(file) << c.text;
        try {
            readSky(file);
            ADD_FAILURE() << "accepted: " << c.text;
        } catch (const geometry::InputError& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with(file + c.place)) << e.what();
        }
    }
    std::remove(file.c_str());
}

TEST(SkyFile, the_documented_one_is_read) {
    const std::string file = testing::TempDir() + "documented_sky.json";
    std::ofstream(file) << test::documentedFile("vh-sky/1");
    const Sky sky = readSky(file);
    std::remove(file.c_str());
    EXPECT_EQ(sky.sun.normalIlluminance, 70000);
    EXPECT_NEAR(sky.luminance({0, 1, 0}), 3200, 1e-6);
    EXPECT_GT(sky.ground.luminance, 0);
}

TEST(Frame, compass_and_world_agree) {
    const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-15; };
    EXPECT_TRUE(near(directionInWorld({0, 0}, 90), {0, 0, -1}));
    EXPECT_TRUE(near(directionInWorld({90, 0}, 90), {1, 0, 0}));
    EXPECT_TRUE(near(directionInWorld({180, 0}, 0), {-1, 0, 0}));
    EXPECT_TRUE(near(directionInWorld({0, 0}, 0), {1, 0, 0}));
    EXPECT_TRUE(near(directionFromModel({0, 1, 0}, geometry::UpAxis::z), {0, 0, -1}));
}

} // namespace
} // namespace heliodon::daylight
