// Time-lapses that go on where another stopped, and runs that are interrupted, as a user meets them.
#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace heliodon::test {
namespace {

const std::string kOffice = HELIODON_TEST_DATA "/compute/office/model.obj --up z --triangles 100";

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

    std::filesystem::remove(folder / "day/frames.json");
    const Outcome unknown = heliodon(day("12:00", "PT1H", "--resume"));
    EXPECT_EQ(unknown.exitCode, 2) << unknown.output;
}

TEST_F(Timelapse, a_new_job_leaves_no_frame_of_the_old_one) {
    ASSERT_EQ(heliodon(day("12:00", "PT1H")).exitCode, 0);
    writeText(folder / "day/notes.png", "the user's own");
    ASSERT_EQ(heliodon(day("11:00", "PT1H")).exitCode, 0);
    EXPECT_TRUE(has("00001.png"));
    EXPECT_FALSE(has("00002.png"));
    EXPECT_TRUE(has("notes.png"));
}

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

TEST_F(Timelapse, an_interrupted_run_says_so_and_leaves_nothing) {
    const std::string program = HELIODON_PROGRAM;
    // In the foreground, or the whole group would get the signal: the second one ends the program at once.
    // Leaks are looked for in one process, see program.h.
    const std::string command = "ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 timeout --foreground "
                                "--preserve-status -s INT 2 " +
                                program + " annual " + HELIODON_TEST_DATA +
                                "/compute/office/model.obj --up z --triangles 8000 --quiet --weather " +
                                HELIODON_TEST_DATA + "/daylight/chicago_tmy3.epw.gz -o " + in("new/year");
    FILE* pipe = popen((command + " 2>&1; echo \"code $?\"").c_str(), "r");
    std::string output(4096, '\0');
    output.resize(fread(output.data(), 1, output.size(), pipe));
    pclose(pipe);
    EXPECT_EQ(output, "heliodon: interrupted\ncode 1\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "new"));
}

} // namespace
} // namespace heliodon::test
