// `heliodon annual` and the plans as a user runs them.
#include <numbers>
#include <sstream>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/app/table_file.h"
#include "tests/app/program.h"

namespace heliodon::test {
namespace {

const std::string kOffice = HELIODON_TEST_DATA "/compute/office/model.obj --up z --triangles 300";

class Annual : public InFolder {
protected:
    void SetUp() override {
        InFolder::SetUp();
        // Two days of March, one record missing its irradiance, and a leap day between them.
        std::string text = "LOCATION,Somewhere,-,-,TEST,0,41.98,-87.92,-6.0,201.0\n"
                           "DESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\n"
                           "HOLIDAYS/DAYLIGHT SAVINGS,Yes,0,0,0\nCOMMENTS 1,\nCOMMENTS 2,\n"
                           "DATA PERIODS,1,1,Data,Wednesday,2/28,3/1\n";
        for (const auto& [month, day] : {std::pair{2, 28}, {2, 29}, {3, 1}})
            for (int hour = 1; hour <= 24; ++hour) {
                const bool lit = hour >= 8 && hour <= 17, missing = day == 29 && hour == 12;
                text += "2024," + std::to_string(month) + "," + std::to_string(day) + "," +
                        std::to_string(hour) + ",0,,5.0,1.0,75,99500,0,1415,300," +
                        (missing    ? "9999,9999,9999"
                         : !lit     ? "0,0,0"
                         : day == 1 ? "100,0,100"
                                    : "400,500,120") +
                        ",0,0,0,0,180,3,5,5,16,77777,9,0,10,0.1,0,88,0.2,0,0\r\n";
            }
        writeText(folder / "days.epw", text);
    }
};

TEST_F(Annual, a_folder_of_results_appears) {
    const Outcome outcome =
        heliodon("annual " + kOffice + " --weather " + in("days.epw") + " --ill --temporal 0 -o " +
                 in("year") + " --report " + in("report.json"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const auto summary = nlohmann::json::parse(readText(folder / "year/summary.json"));
    const size_t sensors = summary["sensors"], records = 72;
    EXPECT_EQ(summary["records"], records);
    EXPECT_EQ(summary["occupied"]["hours"], 30);
    EXPECT_GT(sensors, 50u); // 29.5 m2 of floor, one for 0.37 m2
    EXPECT_LT(sensors, 100u);
    for (const char* name : {"sDA300/50", "ASE1000,250"}) {
        EXPECT_GE(summary[name].get<double>(), 0);
        EXPECT_LE(summary[name].get<double>(), 100);
    }
    const std::vector<float> lux = app::readMatrix(folder / "year/illuminance.npy", sensors, records);
    for (size_t h = 0; h < records; ++h) EXPECT_EQ(lux[h] > 0, h % 24 >= 7 && h % 24 < 17) << "record " << h;
    EXPECT_GT(lux[24 + 11], 0.5f * lux[11]); // the missing hour was filled from the day before
    const std::string metrics = readText(folder / "year/metrics.csv");
    EXPECT_EQ(static_cast<size_t>(std::count(metrics.begin(), metrics.end(), '\n')), sensors + 1);
    EXPECT_TRUE(metrics.starts_with("x,y,z,nx,ny,nz,DA300_pct,cDA300_pct,UDI_lt100_pct"))
        << metrics.substr(0, 80);
    const std::string ill = readText(folder / "year/illuminance.ill");
    EXPECT_EQ(static_cast<size_t>(std::count(ill.begin(), ill.end(), '\n')), records);
    std::istringstream lines(ill);
    for (size_t h = 0; h < records; ++h) {
        double month = 0, day = 0, hour = 0, value = 0;
        lines >> month >> day >> hour;
        EXPECT_EQ(day, h < 24 ? 28 : h < 48 ? 29 : 1);
        EXPECT_EQ(hour, static_cast<double>(h % 24) + 0.5);
        for (size_t s = 0; s < sensors; ++s) {
            lines >> value;
            EXPECT_NEAR(value, double{lux[s * records + h]}, 0.5001) << s << ", record " << h;
        }
    }
    for (const char* picture : {"temporal-mean.png", "temporal-0000.png", "plan-da.png", "plan-udi.png"})
        EXPECT_GT(std::filesystem::file_size(folder / "year" / picture), 2000u) << picture;
    const auto report = nlohmann::json::parse(readText(folder / "report.json"));
    EXPECT_EQ(report["year"]["hours"], records);
    EXPECT_FALSE(report["skipped"].empty());
    EXPECT_NE(report["warnings"].dump().find("not of a year"), std::string::npos);
    EXPECT_FALSE(report["warnings"].empty()); // the missing hour

    writeText(folder / "year/notes.ill", "the user's own");
    ASSERT_EQ(
        heliodon("annual " + kOffice + " --weather " + in("days.epw") + " --svg -o " + in("year")).exitCode,
        0);
    for (const char* old : {"illuminance.ill", "temporal-0000.png", "temporal-mean.png", "plan-da.png"})
        EXPECT_FALSE(std::filesystem::exists(folder / "year" / old)) << old;
    for (const char* kept : {"notes.ill", "illuminance.npy", "metrics.csv", "summary.json", "plan-da.svg"})
        EXPECT_TRUE(std::filesystem::exists(folder / "year" / kept)) << kept;
}

// 25 days of minutes, all dark but for an hour of the first day and one of the last.
TEST_F(Annual, minutes_are_computed_in_parts_of_the_year) {
    std::string text = readText(folder / "days.epw");
    text = text.substr(0, text.find("DATA PERIODS")) + "DATA PERIODS,1,60,Data,Thursday,3/1,3/25\n";
    const auto isLit = [](size_t record) {
        const size_t day = record / 1440, hour = record % 1440 / 60;
        return hour == 12 && (day == 0 || day == 24);
    };
    const size_t records = 25 * 1440;
    for (size_t r = 0; r < records; ++r)
        text += fmt::format(
            "2024,3,{},{},{},,5.0,1.0,75,99500,0,1415,300,{},0,0,0,0,180,3,5,5,16,77777,9,0,10,0.1,"
            "0,88,0.2,0,0\n",
            1 + r / 1440, 1 + r % 1440 / 60, 1 + r % 60, isLit(r) ? "400,500,120" : "0,0,0");
    writeText(folder / "minutes.epw", text);
    writeText(folder / "one.csv", "x,y,z,nx,ny,nz\n1.8,3,0.85,0,0,1\n");
    const Outcome outcome =
        heliodon("annual " + kOffice + " --weather " + in("minutes.epw") + " --sensors " + in("one.csv") +
                 " --occupied 12-14 --quiet -o " + in("year") + " --report " + in("report.json"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const std::vector<float> lux = app::readMatrix(folder / "year/illuminance.npy", 1, records);
    size_t reached = 0;
    for (size_t r = 0; r < records; ++r) {
        EXPECT_EQ(lux[r] > 0, isLit(r)) << r;
        reached += lux[r] >= 300;
    }
    const auto report = nlohmann::json::parse(readText(folder / "report.json"));
    EXPECT_EQ(report["year"]["hours"], records);
    EXPECT_EQ(report["year"]["lit"], 120);
    EXPECT_EQ(report["modelled"][0], "sky and ground: 120 records");
    EXPECT_EQ(report["year"]["checked_hours"], 12); // of each part
    EXPECT_NEAR(report["summary"]["mean_DA"].get<double>(), 100.0 * static_cast<double>(reached) / (50 * 60),
                1e-9);
}

// The same days over and over, as in files of several years, or with a data period listed twice.
TEST_F(Annual, more_than_a_year_is_said_to_be_that) {
    const std::string text = readText(folder / "days.epw");
    const size_t periods = text.find("DATA PERIODS"), records = text.find("2024,");
    std::string many = text.substr(0, periods) + "DATA PERIODS,123,1", again;
    for (int k = 0; k < 123; ++k) many += ",Data,Wednesday,2/28,3/1", again += text.substr(records);
    writeText(folder / "many.epw", many + '\n' + again);
    writeText(folder / "one.csv", "x,y,z,nx,ny,nz\n1.8,3,0.85,0,0,1\n");
    ASSERT_EQ(heliodon("annual " + kOffice + " --weather " + in("many.epw") + " --sensors " + in("one.csv") +
                       " --quiet -o " + in("year") + " --report " + in("report.json"))
                  .exitCode,
              0);
    const auto report = nlohmann::json::parse(readText(folder / "report.json"));
    EXPECT_NE(report["warnings"].dump().find("covers 369 days"), std::string::npos) << report["warnings"];
}

TEST_F(Annual, blinds_dim_every_command_that_computes_light) {
    const auto ran = [&](const std::string& arguments) {
        const Outcome outcome = heliodon(arguments + " --quiet --report " + in("report.json"));
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        return nlohmann::json::parse(readText(folder / "report.json"));
    };
    const std::string year = "annual " + kOffice + " --weather " + in("days.epw") + " -o " + in("year"),
                      lux = "illuminance " + kOffice + " --sky overcast -o " + in("lux.csv"),
                      picture = "render " + kOffice + " --sky overcast -o " + in("pictures"),
                      film = "timelapse " + kOffice +
                             " --from 2026-06-21T10:00solar --to 2026-06-21T11:00solar "
                             "--step PT1H --view none -o " +
                             in("film");
    const auto meanLux = [&](const std::string& arguments, const char* group, const char* field) {
        return ran(arguments)[group][field].get<double>();
    };
    const std::tuple<std::string, const char*, const char*> lit[]{
        {year, "summary", "mean_lux"}, {lux, "lux", "mean"}, {picture, "light", "mean_lux"}};
    std::vector<double> without;
    for (const auto& [command, group, field] : lit) without.push_back(meanLux(command, group, field));
    for (const std::string blinds : {" --blinds fabric:0.2", " --blinds slats:60"}) {
        for (size_t i = 0; i < without.size(); ++i) {
            const auto& [command, group, field] = lit[i];
            EXPECT_LT(meanLux(command + blinds, group, field), 0.7 * without[i]) << command << blinds;
        }
        const nlohmann::json report = ran(film + blinds);
        EXPECT_EQ(report["blinds"].size(), 1u);
        EXPECT_LT(report["blinds"][0]["diffuse_transmittance"].get<double>(), 0.3);
    }
}

TEST_F(Annual, slightly_negative_irradiance_is_none_and_nonsense_is_named) {
    const std::string text = readText(folder / "days.epw");
    const auto ran = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        changed.replace(changed.find(from), from.size(), to);
        writeText(folder / "odd.epw", changed);
        return heliodon("annual " + kOffice + " --weather " + in("odd.epw") + " --quiet -o " + in("odd"));
    };
    // Instruments read a little below zero at night; DNI of the first lit hour, 2/28 8:00, is line 16.
    const Outcome negative = ran(",400,500,120,", ",400,-3,120,");
    EXPECT_EQ(negative.exitCode, 0) << negative.output;
    const size_t sensors = nlohmann::json::parse(readText(folder / "odd/summary.json"))["sensors"];
    for (const float lux : app::readMatrix(folder / "odd/illuminance.npy", sensors, 72)) EXPECT_GE(lux, 0);
    const Outcome nonsense = ran(",400,500,120,", ",400,-300,120,");
    EXPECT_EQ(nonsense.exitCode, 2);
    EXPECT_NE(nonsense.output.find("odd.epw:16"), std::string::npos) << nonsense.output;
    const Outcome cut = ran(",400,500,120,0,0,0,0,180,3,5,5,16,77777,9,0,10,0.1,0,88,0.2,0,0", ",400");
    EXPECT_EQ(cut.exitCode, 2);
    EXPECT_NE(cut.output.find("odd.epw:16"), std::string::npos) << cut.output;
}

TEST_F(Annual, illuminance_to_a_wanted_error_says_how_it_got_there) {
    const std::string command = "illuminance " HELIODON_TEST_DATA
                                "/compute/office/model.obj --up z --sky overcast "
                                "--sensors " HELIODON_TEST_DATA "/compute/office/sensors.csv --quiet -o " +
                                in("lux.csv") + " --report " + in("report.json");
    const auto accuracy = [&](const std::string& more) {
        const Outcome outcome = heliodon(command + more);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        return nlohmann::json::parse(readText(folder / "report.json"));
    };
    const nlohmann::json loose = accuracy(" --max-error 0.06"), tight = accuracy(" --max-error 0.03");
    EXPECT_LE(loose["accuracy"]["reached"].get<double>(), 0.06);
    EXPECT_LE(tight["accuracy"]["reached"].get<double>(), 0.03);
    EXPECT_GE(tight["triangles"].get<int>(), loose["triangles"].get<int>());
    EXPECT_EQ(tight["accuracy"]["rounds"].back()["error"], tight["accuracy"]["reached"]);
    // 21 March at 13:00 apparent solar time, 42.73 N: asin(cos 42.73 cos 15) but for the declination.
    EXPECT_EQ(tight["time"], "2026-03-21T13:00:00solar");
    EXPECT_NEAR(tight["sky"]["sun"]["altitude_deg"].get<double>(), 45.5, 0.3);
    EXPECT_NEAR(tight["sky"]["sun"]["azimuth_deg"].get<double>(), 201.5, 0.3);
    // The disc is longer up than its middle without air: cos H = (sin -0.833 - sin 42.73 sin d) / (cos cos).
    EXPECT_EQ(tight["sky"]["sun"]["rise"].get<std::string>().substr(0, 15), "2026-03-21T05:5");
    EXPECT_EQ(tight["sky"]["sun"]["set"].get<std::string>().substr(0, 15), "2026-03-21T18:0");
    const nlohmann::json given = accuracy(" --max-error 0.001 --triangles 300");
    EXPECT_GT(given["accuracy"]["reached"].get<double>(), 0.001);
    EXPECT_EQ(given["accuracy"]["why"], "the mesh was given by --triangles");
    EXPECT_FALSE(given["warnings"].empty());
}

// What an open field gets stands in the report; under a uniform ground of albedo 1 a sky file's luminance is
// replaced by E / pi.
TEST_F(Annual, illuminance_says_what_is_outside_and_takes_another_ground) {
    writeText(in("sky.json"), R"({"format": "vh-sky/1", "model": "cie_overcast",
        "zenith_luminance_cdm2": 9000, "ground": {"luminance_cdm2": 100}})");
    writeText(in("s.csv"), "x,y,z,nx,ny,nz\n1.8,4,0.8,0,0,1\n500,4,0.8,0,0,1\n");
    const auto ran = [&](const std::string& more) {
        const Outcome outcome =
            heliodon("illuminance " + kOffice + " --site 10,20 --sky " + in("sky.json") + " --sensors " +
                     in("s.csv") + " -o " + in("lux.csv") + " --report " + in("report.json") + more);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        EXPECT_NE(outcome.output.find("1 of 2 sensors lie in no room and stay dark: row 1, counted from 0"),
                  std::string::npos)
            << outcome.output;
        EXPECT_NE(outcome.output.find("--site is not used"), std::string::npos) << outcome.output;
        return nlohmann::json::parse(readText(folder / "report.json"));
    };
    const std::string year = heliodon("annual " + kOffice + " --weather " + in("days.epw") + " --sensors " +
                                      in("s.csv") + " -o " + in("year"))
                                 .output;
    EXPECT_NE(year.find("1 of 2 sensors lie in no room"), std::string::npos) << year;
    const auto summary = nlohmann::json::parse(readText(folder / "year/summary.json"));
    EXPECT_EQ(summary["sensors"], 1);
    EXPECT_EQ(summary["sensors_outside"], 1);
    const std::vector<float> lux = app::readMatrix(folder / "year/illuminance.npy", 2, 72);
    double sum = 0;
    for (const size_t h : {8, 9, 10, 11, 12, 13, 14, 15, 16, 17})
        for (const size_t day : {0, 1, 2}) sum += static_cast<double>(lux[day * 24 + h]);
    EXPECT_NEAR(summary["mean_lux"].get<double>(), sum / 30, 1e-4 * sum / 30);
    const nlohmann::json dark = ran(""), bright = ran(" --ground 1");
    // Moon and Spencer: E = 7 pi Lz / 9.
    const double outside = 7.0 / 9.0 * std::numbers::pi * 9000;
    for (const nlohmann::json& report : {dark, bright}) {
        EXPECT_NEAR(report["sky"]["outside_lux"]["global"].get<double>(), outside, 1e-4 * outside);
        EXPECT_EQ(report["sky"]["outside_lux"]["direct"], 0.0);
    }
    EXPECT_EQ(bright["sky"]["ground_reflectance"], 1.0);
    EXPECT_GT(bright["lux"]["max"].get<double>(), 1.1 * dark["lux"]["max"].get<double>());
}

TEST_F(Annual, a_plan_of_illuminance_is_a_drawing) {
    const std::string command =
        "illuminance " + kOffice + " --sky overcast --quiet -o " + in("lux.csv") + " --plan ";
    ASSERT_EQ(heliodon(command + in("plan.svg")).exitCode, 0);
    const std::string svg = readText(folder / "plan.svg");
    EXPECT_NE(svg.find("21 March 2026, 13:00 solar time, overcast sky, 42.73 N 73.68 W"), std::string::npos);
    EXPECT_TRUE(svg.starts_with("<svg")) << svg.substr(0, 40);
    EXPECT_NE(svg.find("<path"), std::string::npos);
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_EQ(svg.find("edge of direct sun"), std::string::npos);
    for (const char* told : {"work plane 0.76 m above the floors", ">sensor<"})
        EXPECT_NE(svg.find(told), std::string::npos) << told;
    EXPECT_EQ(heliodon(command + in("plan.gif")).exitCode, 2);
    const std::string sunny =
        "illuminance " + kOffice + " --time 2026-12-21T12:00solar --quiet -o " + in("lux.csv");
    ASSERT_EQ(heliodon(sunny + " --plan " + in("sunny.svg")).exitCode, 0);
    EXPECT_NE(readText(folder / "sunny.svg").find("edge of direct sun"), std::string::npos);
}

TEST_F(Annual, maps_of_a_year_name_weather_and_clock) {
    const Outcome outcome =
        heliodon("annual " + kOffice + " --weather " + in("days.epw") + " --svg --quiet -o " + in("year"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const std::string svg = readText(folder / "year/temporal-mean.svg");
    EXPECT_NE(svg.find("Weather of Somewhere"), std::string::npos);
    EXPECT_NE(svg.find("standard time, UTC-6 h; grey is not in the file"), std::string::npos);
    EXPECT_NE(svg.find(">&lt; "), std::string::npos); // the legend says what is black
}

TEST_F(Annual, wrong_words_are_named) {
    const auto said = [&](const std::string& options) {
        const Outcome outcome = heliodon("annual " + kOffice + " --weather " + in("days.epw") + " -o " +
                                         in("bad") + " " + options);
        EXPECT_EQ(outcome.exitCode, 2);
        return outcome.output;
    };
    for (const std::string hours : {"18-8", "8:3-9", "8:75-9", "8:30-"})
        EXPECT_NE(said("--occupied " + hours).find("--occupied: '" + hours + "'"), std::string::npos)
            << hours;
    EXPECT_NE(
        said("--occupied 12-12:20").find("--occupied: no record of days.epw has its middle in 12-12:20"),
        std::string::npos);
    EXPECT_NE(said("--temporal 5000").find("--temporal: '5000'"), std::string::npos);
    writeText(in("far.csv"), "x,y,z,nx,ny,nz\n1800,4000,800,0,0,1\n3000,4000,800,0,0,1\n");
    const std::string far = said("--sensors " + in("far.csv"));
    EXPECT_NE(far.find("far.csv: none of its 2 sensors lies in a room"), std::string::npos) << far;
    EXPECT_NE(far.find("they are at x 1800 to 3000, y 4000 to 4000, z 800 to 800"), std::string::npos) << far;
    const Outcome moment =
        heliodon("illuminance " + kOffice + " --sensors " + in("far.csv") + " -o " + in("lux.csv"));
    EXPECT_EQ(moment.exitCode, 2);
    EXPECT_NE(moment.output.find("far.csv: none of its 2 sensors lies in a room"), std::string::npos)
        << moment.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "lux.csv"));
    EXPECT_NE(said("--sensors nowhere.csv").find("nowhere.csv"), std::string::npos);
    const Outcome noWeather = heliodon("annual " + kOffice + " --weather nowhere.epw -o " + in("bad"));
    EXPECT_EQ(noWeather.exitCode, 2);
    EXPECT_NE(noWeather.output.find("nowhere.epw"), std::string::npos);
}

} // namespace
} // namespace heliodon::test
