// Time-lapses that go on where another stopped, and runs that are interrupted, as a user meets them.
#include <array>
#include <atomic>
#include <csignal>
#include <thread>

#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "compute/daylight/weather.h"
#include "engine/app/film.h"
#include "engine/app/interrupt.h"
#include "engine/app/output_folder.h"
#include "engine/app/run.h"
#include "geometry/text_file.h"
#include "tests/app/program.h"

namespace heliodon::test {
namespace {

const std::string kOffice = HELIODON_TEST_DATA "/compute/office/model.obj --up z --triangles 100";

// mean_lux of every frame.
std::vector<double> meanLux(const std::filesystem::path& file) {
    std::istringstream table(readText(file));
    std::vector<double> lux;
    std::string line, field;
    for (std::getline(table, line); std::getline(table, line);) {
        std::istringstream fields(line);
        for (int k = 0; k < 4; ++k) std::getline(fields, field, ',');
        lux.push_back(std::stod(field));
    }
    return lux;
}

class Timelapse : public InFolder {
protected:
    std::string day(const std::string& to, const std::string& step, const std::string& more = "") const {
        return "timelapse " + kOffice + " --sky overcast --from 2026-06-21T10:00solar --to 2026-06-21T" + to +
               "solar --step " + step + " --quiet -o " + in("day") + " --report " + in("report.json") + " " +
               more;
    }
    size_t drawn() const {
        return nlohmann::json::parse(readText(folder / "report.json"))["frames"]["drawn"];
    }
    bool has(const std::string& picture) const { return std::filesystem::exists(folder / "day" / picture); }
};

TEST_F(Timelapse, only_frames_of_the_same_job_are_taken_over) {
    ASSERT_EQ(heliodon(day("12:00", "PT1H")).exitCode, 0);
    const std::string before = readText(folder / "day/00001.png");
    const Outcome other = heliodon(day("12:00", "PT30M", "--resume"));
    EXPECT_EQ(other.exitCode, 2) << other.output;
    EXPECT_NE(other.output.find("--step is PT1H there and PT30M here"), std::string::npos) << other.output;
    EXPECT_EQ(readText(folder / "day/00001.png"), before);
    EXPECT_FALSE(has("00003.png"));

    std::filesystem::remove(folder / "day/00001.png");
    const Outcome same = heliodon(day("12:00", "PT1H", "--resume"));
    EXPECT_EQ(same.exitCode, 0) << same.output;
    EXPECT_EQ(drawn(), 1u);
    EXPECT_EQ(readText(folder / "day/00001.png"), before);

    auto silent = nlohmann::ordered_json::parse(readText(folder / "day/frames.json"));
    ASSERT_EQ(silent["job"].erase("--size"), 1u);
    writeText(folder / "day/frames.json", silent.dump());
    EXPECT_EQ(heliodon(day("12:00", "PT1H", "--resume")).exitCode, 2);

    std::filesystem::remove(folder / "day/frames.json");
    const Outcome unknown = heliodon(day("12:00", "PT1H", "--resume"));
    EXPECT_EQ(unknown.exitCode, 2) << unknown.output;
}

TEST_F(Timelapse, a_new_job_leaves_no_frame_of_the_old_one) {
    const auto warnsOfStrangers = [&] {
        return readText(folder / "report.json").find("day: 00001.png stood there") != std::string::npos;
    };
    std::filesystem::create_directories(folder / "day");
    writeText(folder / "day/00001.png", "the user's own");
    ASSERT_EQ(heliodon(day("12:00", "PT1H")).exitCode, 0);
    EXPECT_TRUE(warnsOfStrangers());
    writeText(folder / "day/notes.png", "the user's own");
    ASSERT_EQ(heliodon(day("11:00", "PT1H")).exitCode, 0);
    EXPECT_FALSE(warnsOfStrangers());
    EXPECT_TRUE(has("00001.png"));
    EXPECT_FALSE(has("00002.png"));
    EXPECT_TRUE(has("notes.png"));
}

// Names beside a film that are the user's stay the user's, and what goes beside it is said.
TEST_F(Timelapse, a_film_overwrites_no_table_of_another_name) {
    writeText(folder / "film.csv", "precious");
    const std::string film = "timelapse " + kOffice +
                             " --sky overcast --from 2026-06-21T10:00solar --to 2026-06-21T11:00solar --step "
                             "PT1H -o " +
                             in("film.mp4");
    const Outcome odd = heliodon(film + " --size 321x240");
    EXPECT_EQ(odd.exitCode, 2) << odd.output;
    EXPECT_NE(odd.output.find("--size:321x240"), std::string::npos) << odd.output;
    {
        const app::SoleFile held(folder / "film.mp4");
        const Outcome second = heliodon(film);
        EXPECT_EQ(second.exitCode, 2) << second.output;
        EXPECT_NE(second.output.find("film.mp4: another run is writing it"), std::string::npos)
            << second.output;
    }
    const Outcome outcome = heliodon(film + " --size 320x240 --rig " HELIODON_SOURCE "/examples/rig.json");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(readText(folder / "film.csv"), "precious");
    EXPECT_EQ(meanLux(folder / "film.frames.csv").size(), 2u);
    for (const char* name : {"film-projector-0.mp4", "film-projector-1.mp4"}) {
        EXPECT_NE(outcome.output.find(in(name)), std::string::npos) << outcome.output;
        EXPECT_TRUE(std::filesystem::exists(folder / name));
    }
}

TEST_F(Timelapse, frames_that_are_empty_or_cut_are_made_anew) {
    ASSERT_EQ(heliodon(day("12:00", "PT1H", "--exr")).exitCode, 0);
    std::vector<std::pair<std::string, std::string>> before;
    const std::vector<std::pair<std::string, size_t>> cuts{{"00000.png", 0}, {"00001.exr", 5000}};
    for (const auto& [name, size] : cuts) {
        before.emplace_back(name, readText(folder / "day" / name));
        std::filesystem::resize_file(folder / "day" / name, size);
    }
    ASSERT_EQ(heliodon(day("12:00", "PT1H", "--exr --resume")).exitCode, 0);
    EXPECT_EQ(drawn(), 2u);
    for (const auto& [name, bytes] : before) EXPECT_EQ(readText(folder / "day" / name), bytes) << name;
}

TEST_F(Timelapse, a_table_alone_is_a_job_like_any_other) {
    ASSERT_EQ(heliodon(day("12:00", "PT1H")).exitCode, 0);
    const Outcome resumed = heliodon(day("11:00", "PT1H", "--resume --view none"));
    EXPECT_EQ(resumed.exitCode, 2) << resumed.output;
    EXPECT_TRUE(has("00002.png"));
    ASSERT_EQ(heliodon(day("11:00", "PT1H", "--view none")).exitCode, 0);
    EXPECT_FALSE(has("00000.png"));
    EXPECT_EQ(meanLux(folder / "day/frames.csv").size(), 2u);
    EXPECT_EQ(nlohmann::json::parse(readText(folder / "day/frames.json"))["frames"], 2);
    ASSERT_EQ(heliodon(day("10:00", "PT1H")).exitCode, 0);
    EXPECT_TRUE(has("00000.png"));
}

TEST_F(Timelapse, a_rig_without_projectors_leaves_the_preview) {
    auto rig = nlohmann::json::parse(readText(HELIODON_SOURCE "/examples/rig.json"));
    rig["projectors"] = nlohmann::json::array();
    writeText(folder / "rig.json", rig.dump());
    const std::string rigged = "--size 64x48 --rig " + in("rig.json");
    const Outcome plain = heliodon(day("10:00", "PT1H", rigged));
    EXPECT_EQ(plain.exitCode, 0) << plain.output;
    EXPECT_TRUE(has("00000.png"));
    EXPECT_NE(readText(folder / "report.json").find("rig.json: projectors: there is none"),
              std::string::npos);
    const Outcome asked = heliodon(day("10:00", "PT1H", rigged + " --view projectors"));
    EXPECT_EQ(asked.exitCode, 2) << asked.output;
    EXPECT_NE(asked.output.find("rig.json:projectors: there is none"), std::string::npos) << asked.output;
}

TEST_F(Timelapse, polar_day_and_polar_night) {
    const auto day = [&](const std::string& date) {
        const Outcome outcome =
            heliodon("timelapse " + kOffice + " --site 78.2,15.6 --sky clear --view none --quiet --from " +
                     date + "T00:00solar --to " + date + "T23:00solar --step PT1H -o " + in("polar") +
                     " --report " + in("report.json"));
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        return meanLux(folder / "polar/frames.csv");
    };
    for (const double lux : day("2026-12-21")) EXPECT_EQ(lux, 0);
    EXPECT_NE(readText(folder / "report.json").find("23 frames: the same light"), std::string::npos);
    const std::vector<double> summer = day("2026-06-21");
    EXPECT_EQ(summer.size(), 24u);
    for (const double lux : summer) EXPECT_GT(lux, 0); // at midnight too
    // A last frame in the dark says nothing of the others' accuracy.
    EXPECT_EQ(day("2026-03-21").back(), 0);
    const nlohmann::json report = nlohmann::json::parse(readText(folder / "report.json"));
    EXPECT_GT(report["radiosity"]["bound"].get<double>(), 0);
    EXPECT_NE(report["skipped"].dump().find(" frames: sky and ground: dark"), std::string::npos);
}

TEST_F(Timelapse, what_is_dark_by_day_is_not_said_to_be_night) {
    const auto said = [&](const std::string& from) {
        return heliodon("timelapse " + kOffice +
                        " --site 48,11 --sky perez:0,0 --view none --from 2026-06-21T" + from +
                        "solar --to 2026-06-21T12:00solar --step PT12H -o " + in("dark"))
            .output;
    };
    EXPECT_NE(said("12:00").find("1 of 1 frames are dark: the sun is up and the sky without light"),
              std::string::npos);
    EXPECT_NE(said("00:00").find("2 of 2 frames are dark: the sun is below the horizon, but in 1 of them "
                                 "the sun is up"),
              std::string::npos);
}

// Its sun, if it has one, is not that of the frames' times.
TEST_F(Timelapse, a_sky_file_has_one_light_and_no_sun_that_moves) {
    writeText(folder / "sky.json",
              R"({"format":"vh-sky/1","model":"cie_overcast","zenith_luminance_cdm2":5000})");
    const auto said = [&](const std::string& to) {
        return heliodon("timelapse " + kOffice + " --sky " + in("sky.json") +
                        " --view none --from 2026-06-21T11:00solar --to 2026-06-21T" + to +
                        "solar --step PT1H -o " + in("still"))
            .output;
    };
    const std::string warning = "sky.json: states one sky, which is taken for every time";
    EXPECT_NE(said("12:00").find(warning), std::string::npos);
    EXPECT_NE(readText(folder / "still/frames.csv").find("\n2026-06-21T12:00:00solar,,,"), std::string::npos);
    const std::vector<double> lux = meanLux(folder / "still/frames.csv");
    ASSERT_EQ(lux.size(), 2u);
    EXPECT_GT(lux[0], 0);
    EXPECT_EQ(lux[0], lux[1]);
    const std::string render =
        "render " + kOffice + " --sky " + in("sky.json") + " --size 64x48 -o " + in("r");
    EXPECT_EQ(heliodon(render).output.find(warning), std::string::npos); // no time is asked for
    for (const char* times : {" --contact-sheet --days 06-21 --hours 12", " --time 2026-06-21T12:00solar"})
        EXPECT_NE(heliodon(render + times).output.find(warning), std::string::npos) << times;
}

TEST_F(Timelapse, says_which_options_are_for_other_pictures) {
    const auto said = [&](const std::string& more) {
        return heliodon(
                   "timelapse " + kOffice +
                   " --sky overcast --from 2026-06-21T12:00solar --to 2026-06-21T12:00solar --step PT1H " +
                   "-o " + in("day") + " " + more)
            .output;
    };
    const std::string none = said("--view none --exr --exposure 300 --false-color --sky-color --size 64x48");
    for (const char* option : {"--exr", "--exposure", "--false-color", "--sky-color", "--size"})
        EXPECT_NE(none.find(std::string(option) + " is not used: --view none draws nothing"),
                  std::string::npos)
            << none;
    const std::string rig = "--rig " HELIODON_SOURCE "/examples/rig.json ";
    const std::string preview = said(rig + "--view preview --size 64x48 --compensate-scatter --fps 30");
    EXPECT_NE(preview.find("--compensate-scatter is not used"), std::string::npos) << preview;
    EXPECT_NE(preview.find("--fps is not used"), std::string::npos) << preview;
    EXPECT_EQ(preview.find("--size"), std::string::npos) << preview;
    EXPECT_NE(said(rig + "--size 64x48").find("--size is not used"), std::string::npos);
    EXPECT_EQ(said("--size 64x48").find("not used"), std::string::npos);
}

TEST_F(Timelapse, dark_for_want_of_a_window) {
    writeText(folder / "box.obj", "v 0 0 0\nv 4 0 0\nv 4 5 0\nv 0 5 0\nv 0 0 3\nv 4 0 3\nv 4 5 3\nv 0 5 3\n"
                                  "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n");
    const Outcome outcome = heliodon(
        "timelapse " + in("box.obj") + " --up z --triangles 50 --site 48,11 --sky clear --view none " +
        "--from 2026-06-21T11:00solar --to 2026-06-21T13:00solar --step PT1H -o " + in("box"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("3 of 3 frames are dark: no window leads outside"), std::string::npos)
        << outcome.output;
}

TEST_F(Timelapse, frames_of_the_same_light_are_what_each_alone_is) {
    writeText(folder / "sky.json", R"({"format": "vh-sky/1", "model": "cie_overcast",
        "zenith_luminance_cdm2": 5000, "ground": {"albedo": 0.2}})");
    const std::string sky = kOffice + " --quiet --sky " + in("sky.json") + " --report " + in("report.json");
    ASSERT_EQ(heliodon("timelapse " + sky +
                       " --view none --from 2026-06-21T10:00solar --to "
                       "2026-06-21T14:00solar --step PT1H -o " +
                       in("day"))
                  .exitCode,
              0);
    EXPECT_NE(readText(folder / "report.json").find("4 frames: the same light"), std::string::npos);
    ASSERT_EQ(heliodon("render " + sky + " --time 2026-06-21T14:00solar -o " + in("one")).exitCode, 0);
    const double alone = nlohmann::json::parse(readText(folder / "report.json"))["light"]["mean_lux"];
    const std::vector<double> frames = meanLux(folder / "day/frames.csv");
    ASSERT_EQ(frames.size(), 5u);
    for (const double lux : frames) EXPECT_NEAR(lux, alone, 2e-4 * alone + 0.005); // two digits in the table
}

// An interrupted film leaves its frames in OUT.frames, as a folder of pictures of the same job.
TEST_F(Timelapse, a_film_goes_on_from_its_frames) {
    const auto film = [&](const std::string& output, const std::string& more) {
        return heliodon("timelapse " + kOffice +
                        " --sky overcast --from 2026-06-21T10:00solar --to "
                        "2026-06-21T13:00solar --step PT1H --quiet -o " +
                        in(output) + " --report " + in("report.json") + more);
    };
    ASSERT_EQ(film("whole.mp4", " --resume").exitCode, 0);
    EXPECT_EQ(drawn(), 4u);
    EXPECT_FALSE(std::filesystem::exists(folder / "whole.frames")); // the film is whole
    const auto made = std::filesystem::last_write_time(folder / "whole.mp4");
    ASSERT_EQ(film("whole.mp4", " --resume").exitCode, 0);
    EXPECT_EQ(drawn(), 0u);
    EXPECT_EQ(std::filesystem::last_write_time(folder / "whole.mp4"), made);
    ASSERT_EQ(film("whole.mp4", " --resume --fps 30").exitCode, 0); // another film
    EXPECT_EQ(drawn(), 4u);
    ASSERT_EQ(film("whole.mp4", "").exitCode, 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "whole.frames.json")); // nothing to compare with any more
    ASSERT_EQ(film("part.frames", "").exitCode, 0);
    for (const char* missing : {"00002.png", "00003.png"})
        std::filesystem::remove(folder / "part.frames" / missing);
    writeText(folder / "part.frames/notes.txt", "the user's own");
    ASSERT_EQ(film("part.mp4", " --resume").exitCode, 0);
    EXPECT_EQ(drawn(), 2u);
    EXPECT_FALSE(std::filesystem::exists(folder / "part.frames/00000.png"));
    EXPECT_EQ(readText(folder / "part.frames/notes.txt"), "the user's own");
    EXPECT_GT(std::filesystem::file_size(folder / "part.mp4"), 1000u);
    EXPECT_EQ(readText(folder / "part.mp4"), readText(folder / "whole.mp4"));
}

// As a run leaves it that ends in the middle of a line: the rest comes out as if it had never stopped, though
// each frame is solved from those before it.
TEST_F(Timelapse, a_table_goes_on_from_its_rows) {
    const std::string command = "timelapse " + kOffice +
                                " --site 41.8,-87.8 --sky clear --view none --from 2026-06-21T09:00solar "
                                "--to 2026-06-21T13:59solar --step PT1M --resume --quiet -o " +
                                in("day") + " --report " + in("report.json");
    const auto kept = [&] {
        return nlohmann::json::parse(readText(folder / "report.json"))["frames"]["kept"].get<size_t>();
    };
    ASSERT_EQ(heliodon(command).exitCode, 0);
    EXPECT_EQ(kept(), 0u);
    EXPECT_FALSE(std::filesystem::exists(folder / "day/frames.part.csv"));
    const std::string whole = readText(folder / "day/frames.csv");
    size_t end = 0;
    for (int line = 0; line < 201; ++line) end = whole.find('\n', end) + 1; // the header and 200 frames
    std::filesystem::remove(folder / "day/frames.csv");
    writeText(folder / "day/frames.part.csv", whole.substr(0, end + 40));
    ASSERT_EQ(heliodon(command).exitCode, 0);
    EXPECT_EQ(kept(), 200u);
    EXPECT_EQ(readText(folder / "day/frames.csv"), whole);
    EXPECT_FALSE(std::filesystem::exists(folder / "day/frames.part.csv"));
}

// Weather files are as old as their makers' computers: names in ISO 8859-1.
TEST_F(Timelapse, previews_of_any_size_and_places_of_any_name) {
    ASSERT_EQ(std::system(("gzip -dc " HELIODON_TEST_DATA "/daylight/chicago_tmy3.epw.gz | "
                           "sed '1s/^LOCATION,[^,]*/LOCATION,S\\xE3o Paulo/' > " +
                           in("place.epw"))
                              .c_str()),
              0);
    const std::string film = "timelapse " + kOffice + " --weather " + in("place.epw") +
                             " --from 2026-06-21T10:00-06:00 --to 2026-06-21T10:00-06:00 --step PT1H --quiet "
                             "--size 640x200 --report " +
                             in("report.json") + " -o ";
    const Outcome outcome = heliodon(film + in("day"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const nlohmann::json report = nlohmann::json::parse(readText(folder / "report.json"));
    EXPECT_EQ(report["weather"]["place"].get<std::string>().substr(0, 10), "S\u00E3o Paulo");
    const passes::Image8 frame = app::readPicture(folder / "day/00000.png");
    EXPECT_EQ(frame.width, 640);
    EXPECT_EQ(frame.height, 200);
    const Outcome coloured = heliodon(film + in("lux") + " --false-color");
    ASSERT_EQ(coloured.exitCode, 0) << coloured.output;
    EXPECT_EQ(app::readPicture(folder / "lux/00000.png").width, 640); // with its legend
}

// The stamp of previews lies in the lower left corner, and projectors' pictures have none.
TEST_F(Timelapse, frames_say_when_they_are) {
    ASSERT_EQ(heliodon(day("11:00", "PT1H")).exitCode, 0);
    const passes::Image8 ten = app::readPicture(folder / "day/00000.png"),
                         eleven = app::readPicture(folder / "day/00001.png");
    ASSERT_EQ(heliodon(day("11:00", "PT1H", "--no-stamp")).exitCode, 0);
    const passes::Image8 plain = app::readPicture(folder / "day/00000.png");
    ASSERT_EQ(ten.rgb.size(), plain.rgb.size());
    size_t stamped = 0, bright = 0, told = 0;
    for (int y = 0; y < ten.height; ++y)
        for (int x = 0; x < ten.width; ++x) {
            const bool corner = y > 0.88 * ten.height && x < 0.7 * ten.width;
            const bool same = std::equal(ten.pixel(x, y), ten.pixel(x, y) + 3, plain.pixel(x, y));
            if (!corner) {
                ASSERT_TRUE(same) << x << ' ' << y;
                continue;
            }
            stamped += !same;
            bright += !same && ten.pixel(x, y)[0] > 220;
            told += ten.pixel(x, y)[0] > 220 && eleven.pixel(x, y)[0] < 120;
        }
    EXPECT_GT(stamped, 20'000u);
    EXPECT_GT(bright, 1'000u); // letters
    EXPECT_GT(told, 20u);      // another hour in other letters

    const std::string rig = " --rig " HELIODON_SOURCE "/examples/rig.json";
    ASSERT_EQ(heliodon(day("10:00", "PT1H", rig)).exitCode, 0);
    const std::string picture = readText(folder / "day/projector-0-00000.png");
    EXPECT_FALSE(picture.empty());
    ASSERT_EQ(heliodon(day("10:00", "PT1H", rig + " --no-stamp")).exitCode, 0);
    EXPECT_EQ(readText(folder / "day/projector-0-00000.png"), picture);
}

TEST_F(Timelapse, a_contact_sheet_has_a_cell_for_every_day_and_hour) {
    const auto sheet = [&](const std::string& hours) {
        const Outcome outcome = heliodon("render " + kOffice +
                                         " --site 42,-88 --contact-sheet --days 06-21,12-21 "
                                         "--hours " +
                                         hours + " --quiet -o " + in("sheet"));
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        return app::readPicture(folder / "sheet/contact-sheet.png");
    };
    const passes::Image8 two = sheet("0,12"), three = sheet("0,9,12");
    const int cell = three.width - two.width; // one column more
    EXPECT_GE(cell, 400);
    EXPECT_EQ(three.height, two.height);
    // Midnight is dark, noon is not, in both rows; within the cells, away from titles.
    const auto mean = [&](double x, double y) {
        double sum = 0;
        for (int j = -40; j < 40; ++j)
            for (int i = -40; i < 40; ++i)
                sum += two.rgb[3 * (static_cast<size_t>(y + j) * static_cast<size_t>(two.width) +
                                    static_cast<size_t>(x + i)) +
                               1];
        return sum / 6400;
    };
    for (const double y : {0.3 * two.height, 0.78 * two.height})
        EXPECT_GT(mean(two.width - 0.5 * cell, y), mean(two.width - 1.5 * cell, y) + 20);
    // A room without light says so, on a ground as dark: none is taken for one that failed.
    const auto at = [&](double x, double y) {
        return int{
            two.rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(two.width) + static_cast<size_t>(x)) +
                    1]};
    };
    const double top = two.height - 300 + 4; // of the lower row, where nothing of a room is
    EXPECT_LT(2 * at(two.width - 2 * cell + 8, top), at(two.width - cell + 8, top));
    int palest = 0;
    for (int y = -10; y < 10; ++y)
        for (int x = -40; x < 40; ++x)
            palest = std::max(palest, at(two.width - 1.5 * cell + x, two.height - 150 - 8 + y));
    EXPECT_GT(palest, 150);
}

// What the earlier run wrote goes, by its record; what others put there stays, also under such a name.
TEST_F(Timelapse, pictures_of_an_earlier_render_do_not_stay_among_the_new) {
    const std::string render = "render " + kOffice + " --quiet -o " + in("out") + " ",
                      rig = "--rig " HELIODON_SOURCE "/examples/rig.json ";
    std::filesystem::create_directories(folder / "out");
    writeText(folder / "out/contact-sheet.png", "the user's own");
    ASSERT_EQ(heliodon(render + rig + "--false-color --exr").exitCode, 0);
    const std::vector<std::string> extra{"false-color.png", "preview.exr", "projector-0.png",
                                         "projector-0.exr"};
    for (const std::string& name : extra) EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
    for (const char* name : {"out/preview.exr", "out/projector-0.exr"})
        for (const char* attribute : {"heliodon:unit", "heliodon:time", "latitude", "heliodon:whiteLux"})
            EXPECT_NE(readText(folder / name).find(attribute), std::string::npos) << name << ' ' << attribute;
    const std::string stamped = readText(folder / "out/preview.png");
    EXPECT_EQ(heliodon(render + "--sky nonsense").exitCode, 2);
    for (const std::string& name : extra) EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
    ASSERT_EQ(heliodon(render).exitCode, 0);
    for (const std::string& name : extra)
        EXPECT_FALSE(std::filesystem::exists(folder / "out" / name)) << name;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/preview.png"));
    EXPECT_EQ(readText(folder / "out/contact-sheet.png"), "the user's own");
    const Outcome over =
        heliodon("render " + kOffice + " -o " + in("out") + " --contact-sheet --time 2026-06-21T23:00-04:00");
    EXPECT_NE(over.output.find("out: contact-sheet.png stood there"), std::string::npos) << over.output;
    EXPECT_EQ(over.output.find("preview.png"), std::string::npos) << over.output;
    EXPECT_NE(over.output.find("it rises at 05:17 and sets at 20:36"), std::string::npos) << over.output;

    // A record that somebody wrote removes nothing outside the folder.
    writeText(folder / "precious.txt", "precious");
    writeText(
        folder / "out/render.files.json",
        R"({"format": "heliodon-files/1", "command": "render", "files": ["../precious.txt", "..", ""]})");
    ASSERT_EQ(heliodon(render + "--no-stamp").exitCode, 0);
    EXPECT_EQ(readText(folder / "precious.txt"), "precious");
    EXPECT_NE(readText(folder / "out/preview.png"), stamped);
}

// By Ctrl-C, by a system that shuts down, by a terminal that is closed.
TEST_F(Timelapse, an_interrupted_run_says_so_and_leaves_nothing) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        // Leaks are looked for in one process, see program.h.
        const std::string command =
            "echo $$ > " + in("pid") +
            "; ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 exec " HELIODON_PROGRAM " annual " +
            HELIODON_TEST_DATA "/compute/office/model.obj --up z --triangles 8000 --quiet --weather " +
            HELIODON_TEST_DATA "/daylight/chicago_tmy3.epw.gz -o " + in("new/year") + " 2>&1";
        std::thread hand([&] {
            for (int i = 0; i < 2400 && !std::filesystem::exists(folder / "new/year"); ++i)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            std::this_thread::sleep_for(std::chrono::seconds(1)); // well in its work
            const auto program = pid_t(std::stoi(readText(folder / "pid")));
            kill(program, number);
            if (number != SIGTERM) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            kill(program, number); // as timeout does: to the program, then to its group
        });
        FILE* pipe = popen(command.c_str(), "r");
        std::string output;
        std::array<char, 4096> chunk{};
        while (const size_t size = fread(chunk.data(), 1, chunk.size(), pipe))
            output.append(chunk.data(), size);
        hand.join();
        const int status = pclose(pipe);
        output += WIFEXITED(status) ? "code " + std::to_string(WEXITSTATUS(status)) + "\n" : "killed\n";
        EXPECT_EQ(output, "heliodon: interrupted\ncode 1\n") << number;
        EXPECT_FALSE(std::filesystem::exists(folder / "new")) << number;
    }
}

// Work that is not asked for a while. A terminal that is closed is not impatient, however often it says so.
TEST(Interrupt, a_second_signal_ends_the_program_at_once_where_it_is_no_echo_of_the_first) {
    const auto raised = [](int first, int second, int pauseMs) {
        const app::InterruptGuard guard;
        std::raise(first);
        std::this_thread::sleep_for(std::chrono::milliseconds(pauseMs));
        std::raise(second);
        std::_Exit(0);
    };
    constexpr int kLater = 300;
    EXPECT_EXIT(raised(SIGINT, SIGINT, kLater), testing::KilledBySignal(SIGINT), "");
    EXPECT_EXIT(raised(SIGINT, SIGTERM, kLater), testing::KilledBySignal(SIGTERM), "");
    EXPECT_EXIT(raised(SIGTERM, SIGTERM, 20), testing::ExitedWithCode(0), "");
    EXPECT_EXIT(raised(SIGHUP, SIGHUP, kLater), testing::ExitedWithCode(0), "");
}

class PipeTest : public InFolder {};

TEST_F(PipeTest, that_nobody_writes_into_is_waited_for_until_the_first_signal) {
    const std::string pipe = in("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const auto message = [&](const auto& read) -> std::string {
        const app::InterruptGuard guard;
        std::atomic<bool> done = false;
        std::thread hand([&, reader = pthread_self()] {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            pthread_kill(reader, SIGINT);
            for (int i = 0; i < 100 && !done; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
            if (!done) close(open(pipe.c_str(), O_WRONLY | O_NONBLOCK)); // or it would wait for ever
        });
        std::string said;
        try {
            read();
        } catch (const std::exception& error) {
            said = error.what();
        }
        done = true;
        hand.join();
        return said;
    };
    const std::string wanted = pipe + ": interrupted, nobody writes into this pipe";
    EXPECT_EQ(message([&] { geometry::readText(pipe, "a sketch"); }), wanted);
    EXPECT_EQ(message([&] { daylight::readWeather(pipe); }), wanted);
}

// Commands that use no device are asked between their stages: `model` wrote all of two million triangles.
TEST(Stages, none_begins_once_a_run_is_interrupted) {
    app::Run run(app::Arguments{});
    const app::InterruptGuard guard;
    { const app::StageTimer before(run, "model"); }
    std::raise(SIGTERM);
    EXPECT_THROW(app::StageTimer(run, "write"), app::Interrupted);
    EXPECT_TRUE(run.report()["stages"].contains("model"));
    EXPECT_FALSE(run.report()["stages"].contains("write"));
}

} // namespace
} // namespace heliodon::test
