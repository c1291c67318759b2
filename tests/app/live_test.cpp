// `heliodon live` as its users meet it, by what its windows hold. Needs a display server: the one of
// $DISPLAY, else an Xvfb of its own.
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/passes/image_file.h"
#include "tests/app/fault_layer.h"
#include "tests/present/own_display.h"
#include "tests/vision/imitated_camera.h"
#include "tests/vision/table_painter.h"
#include "vision/photograph.h"

namespace heliodon::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kRig = HELIODON_SOURCE "/examples/rig.json",
                  kPhoto = HELIODON_SOURCE "/examples/i01_mixed.png",
                  kOther = HELIODON_TEST_DATA "/vision/p10_window_over_joint_good.jpg";
const std::string kFast = " --triangles 300 ";

class Live : public InFolder {
protected:
    static void SetUpTestSuite() { display = std::make_unique<OwnDisplay>(); }
    static void TearDownTestSuite() { display.reset(); }

    // What the command says and its report; validation speaks on the same stream.
    Outcome live(const std::string& camera, const std::string& script, const std::string& more = "",
                 const std::function<void(const std::string&)>& hear = {}) {
        writeText(folder / "script", script);
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation", 1);
        const Outcome outcome = heliodon("live --rig " + kRig + " --camera " + camera + kFast +
                                             "--windowed --script " + in("script") + " --snapshots " +
                                             in("shots") + " --report " + in("report.json") + " " + more,
                                         hear);
        unsetenv("VK_INSTANCE_LAYERS");
        EXPECT_EQ(outcome.output.find("Validation"), std::string::npos) << outcome.output;
        if (fs::exists(folder / "report.json")) report = json::parse(readText(folder / "report.json"));
        return outcome;
    }
    vision::Photograph shot(const std::string& name) const {
        return vision::readPhotograph(folder / "shots" / (name + ".png"));
    }
    // Waits for a snapshot: everything before it in the script has been done.
    void waitFor(const std::string& name) const {
        for (int i = 0; i < 2400 && !fs::exists(folder / "shots" / (name + ".png")); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        ASSERT_TRUE(fs::exists(folder / "shots" / (name + ".png"))) << name;
    }

    static inline std::unique_ptr<OwnDisplay> display;
    json report;
};

// Largest difference, and how many of the values differ.
std::pair<int, size_t> difference(const vision::Photograph& a, const vision::Photograph& b) {
    if (a.width != b.width || a.height != b.height) return {256, a.rgb.size()};
    std::pair<int, size_t> result{0, 0};
    for (size_t i = 0; i < a.rgb.size(); ++i) {
        const int step = std::abs(int{a.rgb[i]} - int{b.rgb[i]});
        result.first = std::max(result.first, step);
        result.second += step > 0;
    }
    return result;
}

TEST_F(Live, four_windows_show_what_render_writes_for_the_moment_that_the_wheel_has_set) {
    const Outcome outcome =
        live("file:" + kPhoto, "wait\nsnapshot noon\n"
                               "wheel -12 # two hours\nwait\nwheel 92 shift\nwait\nsnapshot june\n"
                               "resize 1 500 300\nsleep 1\nsnapshot small\nquit\n");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const std::pair<const char*, const char*> moments[]{{"noon", "2026-03-21T13:00solar"},
                                                        {"june", "2026-06-21T11:00solar"}};
    for (const auto& [name, time] : moments) {
        const Outcome render = heliodon("render " + kPhoto + kFast + "--rig " + kRig + " --time " + time +
                                        " --quiet -o " + in(name));
        ASSERT_EQ(render.exitCode, 0) << render.output;
        for (int i = 0; i < 4; ++i) {
            const std::string projector = "projector-" + std::to_string(i);
            const auto shown = shot(std::string(name) + "-" + projector),
                       written = vision::readPhotograph(folder / name / (projector + ".png"));
            const auto [most, count] = difference(shown, written);
            // The solver goes on from the light before: within its tolerance, a step of rounding.
            EXPECT_LE(most, 2) << name << projector;
            EXPECT_LE(count, shown.rgb.size() / 500) << name << projector;
        }
    }
    EXPECT_GT(difference(shot("noon-projector-0"), shot("june-projector-0")).first, 40);
    EXPECT_EQ(shot("small-projector-1").width, 500);
    EXPECT_EQ(shot("small-projector-0").width, 1024);
    EXPECT_EQ(report["live"]["sketches"], 1);
    EXPECT_EQ(report["live"]["wheel_to_light"]["count"], 2);
    EXPECT_EQ(report["live"]["photo_to_light"]["count"], 1);
}

// Nothing is drawn that steps could wait for, and no core is to be kept busy by it.
TEST_F(Live, a_night_that_is_played_is_not_solved_without_end) {
    const Outcome outcome = live("file:" + kPhoto, "wait\nkey space\nsleep 0.5\nquit\n",
                                 "--time 2026-03-21T20:00solar --window-scale 0.25 --loop --display P0=none");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_GT(report["live"]["moments_repeated"], 0);
    EXPECT_LE(report["live"]["moments_repeated"], 120); // without a wait some 600
    for (const char* option : {"--loop", "--display"})
        EXPECT_NE(outcome.output.find(std::string(option) + " is not used"), std::string::npos)
            << outcome.output;
}

TEST_F(Live, hours_of_a_weather_file_are_shown_as_a_time_lapse_shows_them) {
    const std::string weather =
        "--exposure 3000 --weather " HELIODON_TEST_DATA "/daylight/chicago_tmy3.epw.gz ";
    const Outcome outcome = live("file:" + kPhoto,
                                 "time 2026-06-21T12:30-06:00\nwait\nsnapshot june\nwheel -3\nwait\n"
                                 "snapshot earlier\nsky clear\nwait\nsnapshot clear\nsky weather\nwait\n"
                                 "snapshot again\nquit\n",
                                 weather);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(report["weather"]["place"].get<std::string>().find("Chicago"), std::string::npos);
    // Of the last moment; the report's `sky` is the start's.
    EXPECT_EQ(report["light"]["time"], "21 June 2026, 12:00 UTC-06:00");
    EXPECT_NE(report["light"]["sky"].get<std::string>().find("Chicago"), std::string::npos);
    const Outcome film =
        heliodon("timelapse " + kPhoto + kFast + "--rig " + kRig + " --quiet " + weather +
                 "--from 2026-06-21T12:00-06:00 --to 2026-06-21T12:30-06:00 --step PT30M -o " + in("film"));
    ASSERT_EQ(film.exitCode, 0) << film.output;
    const std::pair<const char*, const char*> frames[]{{"earlier", "00000"}, {"june", "00001"}};
    for (const auto& [name, frame] : frames)
        for (int i = 0; i < 4; ++i) {
            const std::string projector = "projector-" + std::to_string(i);
            const auto shown = shot(std::string(name) + "-" + projector),
                       written = vision::readPhotograph(folder / "film" / (projector + "-" + frame + ".png"));
            const auto [most, count] = difference(shown, written);
            EXPECT_LE(most, 2) << name << projector; // a step of rounding, see above
            EXPECT_LE(count, shown.rgb.size() / 500) << name << projector;
        }
    EXPECT_GT(difference(shot("earlier-projector-0"), shot("clear-projector-0")).first, 10);
    EXPECT_LE(difference(shot("earlier-projector-0"), shot("again-projector-0")).first, 2);
}

TEST_F(Live, a_bad_picture_is_reported_and_leaves_the_last_light_until_a_good_one_comes) {
    fs::copy_file(kPhoto, folder / "table.png");
    std::thread hand([this] {
        waitFor("good-operator");
        writeText(folder / "table.png", "no picture at all");
        waitFor("bad-operator");
        vision::Photograph grey = vision::readPhotograph(kPhoto);
        for (size_t k = 0; k < grey.rgb.size(); k += 3) grey.rgb[k] = grey.rgb[k + 2] = grey.rgb[k + 1];
        passes::writePng({grey.width, grey.height, grey.rgb}, folder / "table.png");
        waitFor("grey-operator");
        fs::copy_file(kOther, folder / "table.png", fs::copy_options::overwrite_existing);
    });
    const Outcome outcome =
        live("file:" + in("table.png"), "wait\nsnapshot good\nlook 2\nsnapshot bad\nlook 3\nsnapshot grey\n"
                                        "look 4\nsnapshot other\nquit\n");
    hand.join();
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(difference(shot("good-projector-0"), shot("bad-projector-0")).first, 0);
    EXPECT_EQ(difference(shot("good-projector-0"), shot("grey-projector-0")).first, 0);
    EXPECT_GT(difference(shot("good-projector-0"), shot("other-projector-0")).first, 40);
    EXPECT_EQ(report["live"]["refusals"], 2);
    EXPECT_EQ(report["live"]["refused"], ""); // not any more
    EXPECT_EQ(report["live"]["sketches"], 2);
    // Said where nobody looks at the windows too, once for each reason.
    EXPECT_EQ(report["warnings"].size(), 2u) << report["warnings"];
    EXPECT_NE(outcome.output.find("warning: not shown: " + in("table.png")), std::string::npos)
        << outcome.output;
    EXPECT_NE(outcome.output.find("is grey"), std::string::npos) << outcome.output;
}

geometry::Sketch mixedSketch() {
    return geometry::readSketch(HELIODON_TEST_DATA "/geometry/sketches/i01_mixed.sketch.json");
}

// A picture of the table under lamps of some brightness.
void paint(const geometry::Sketch& sketch, double light, const fs::path& file) {
    vision::Lighting lamps;
    for (size_t c = 0; c < 3; ++c) lamps.left[c] *= light, lamps.right[c] *= light;
    const vision::Photograph photo = vision::paintTable(sketch, geometry::readRig(kRig), {}, lamps);
    passes::writePng({photo.width, photo.height, photo.rgb}, file);
}

TEST_F(Live, only_what_has_changed_on_the_table_is_done_again) {
    geometry::Sketch sketch = mixedSketch();
    ASSERT_TRUE(sketch.north);
    ASSERT_FALSE(sketch.tokens.empty());
    paint(sketch, 1, in("table.png"));
    paint(sketch, 0.8, in("2.png")); // darker: nothing to do
    sketch.windows.erase(sketch.windows.begin());
    paint(sketch, 1, in("3.png"));
    sketch.north->dirDeg += 20;
    paint(sketch, 1, in("4.png"));
    sketch.tokens[0].rgb = {60, 60, 60};
    paint(sketch, 1, in("5.png"));
    std::string script = "wait\nsnapshot 1\n";
    for (int k = 2; k <= 5; ++k) script += fmt::format("look {}\nsnapshot {}\n", k, k);
    std::thread hand([this] {
        for (int k = 2; k <= 5; ++k) {
            waitFor(fmt::format("{}-operator", k - 1));
            fs::rename(folder / fmt::format("{}.png", k), folder / "table.png");
        }
    });
    const Outcome outcome = live("file:" + in("table.png"), script + "quit\n", "--window-scale 0.25");
    hand.join();
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(report["live"]["done_again"], json({"geometry", "geometry", "north", "materials"}));
    EXPECT_GT(report["table"]["form_factors"]["closure_rms"], 0) << "of the form factors still in use";
    EXPECT_FALSE(report["table"]["form_factors"].contains("channels")) << "of materials that are gone";
    EXPECT_EQ(report["live"]["detections"], 5);
}

// Pictures come and come, and count when they are still and show something else.
TEST_F(Live, a_camera_is_followed) {
    geometry::Sketch sketch = mixedSketch();
    fs::create_directories(folder / "pictures");
    paint(sketch, 1, in("pictures/1.png"));
    sketch.north->dirDeg += 20;
    paint(sketch, 0.8, in("pictures/2.png"));
    const Outcome outcome =
        live("replay:" + in("pictures"), "look 2\nquit\n", "--interval 3 --window-scale 0.25");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(report["live"]["done_again"], json({"geometry", "north"}));
    EXPECT_GT(report["live"]["pictures"], 1);
}

// Nothing more can come: said, not waited for.
TEST_F(Live, a_look_after_the_end_of_a_replay_is_an_error) {
    fs::create_directories(folder / "pictures");
    fs::copy_file(kPhoto, folder / "pictures/1.png");
    for (const std::string_view second : {"", "not an image", "NO_WALLS"}) {
        if (second == "not an image") writeText(folder / "pictures/2.png", "no picture");
        if (second == "NO_WALLS") paint({}, 1, in("pictures/2.png"));
        const Outcome outcome = live("replay:" + in("pictures"), "look 3\nquit\n",
                                     "--interval 1 --window-scale 0.25 --duration 200");
        EXPECT_EQ(outcome.exitCode, 2) << outcome.output;
        EXPECT_NE(outcome.output.find("look 3: the replay has ended with"), std::string::npos)
            << outcome.output;
        const std::string named =
            second.empty() ? "" : "pictures/2.png: " + std::string(second); // not the folder
        EXPECT_NE(outcome.output.find(named), std::string::npos) << outcome.output;
    }
}

TEST_F(Live, ends_cleanly_with_ctrl_c_and_with_its_windows) {
    std::thread hand([this] {
        waitFor("up-operator");
        fs::copy_file(kRig, folder / "rig.json", fs::copy_options::overwrite_existing);
        for (int i = 0; i < 2400 && readText(folder / "said").find("has been changed") == std::string::npos;
             ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        kill(pid_t(std::stoi(readText(folder / "pid"))), SIGINT);
    });
    writeText(folder / "script", "wait\nsnapshot up\n");
    json rig = json::parse(readText(kRig));
    rig["projectors"][1]["t"] = {0, 0, -3};
    writeText(folder / "rig.json", rig.dump());
    const std::string command = "sh -c 'echo $$ > " + in("pid") + "; exec " HELIODON_PROGRAM " live --rig " +
                                in("rig.json") + " --camera file:" + kPhoto + kFast +
                                "--windowed --window-scale 0.25 --script " + in("script") + " --snapshots " +
                                in("shots") + " --report " + in("report.json") + " 2> " + in("said") + "'";
    setenv("ASAN_OPTIONS", "detect_leaks=0:detect_odr_violation=0", 1);
    const int status = std::system(command.c_str());
    hand.join();
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    report = json::parse(readText(folder / "report.json"));
    EXPECT_EQ(report["live"]["sketches"], 1);
    EXPECT_EQ(report["live"]["ended"], "a signal told it to end");
    EXPECT_NE(report["table"]["warnings"].dump().find("'P1' reaches no wall"), std::string::npos)
        << report["table"];
    // Said where nobody looks at the windows, too; and that the rig is not the one that is shown by.
    EXPECT_NE(report["warnings"].dump().find("'P1' reaches no wall"), std::string::npos)
        << report["warnings"];
    EXPECT_NE(report["warnings"].dump().find("rig.json: has been changed"), std::string::npos)
        << report["warnings"];

    const Outcome closed =
        live("file:" + kPhoto,
             "wait\nsnapshot all\nclose 0\nwait\nsnapshot rest\nclose 1\nclose 2\nsleep 1\nwheel 1\nwait\n"
             "close 3\n");
    EXPECT_EQ(closed.exitCode, 0) << closed.output;
    EXPECT_EQ(report["live"]["wheel_to_light"]["count"], 1); // the last window went on
    EXPECT_NE(report["live"]["ended"].get<std::string>().find("P3's window is closed by the program"),
              std::string::npos)
        << report["live"]["ended"];
    for (const char* name :
         {"-projector-1", "-projector-2", "-projector-3"}) // they took over what the first had shown
        EXPECT_GT(difference(shot("all" + std::string(name)), shot("rest" + std::string(name))).second,
                  100'000u)
            << name;
    EXPECT_EQ(report["warnings"].size(), 0u) << report["warnings"];
    const Outcome early = live("file:" + kPhoto, "close 4\nwait\nquit\n"); // the operator's
    EXPECT_EQ(early.exitCode, 0) << early.output;
    EXPECT_NE(early.output.find("ended with 2 of its 3 steps not done: the operator's window is closed by"),
              std::string::npos)
        << early.output;
}

TEST_F(Live, closed_windows_leave_other_scatter_and_a_lost_display_server_ends_with_a_report) {
    const std::string usual = std::getenv("DISPLAY");
    unsetenv("DISPLAY");
    auto server = std::make_unique<OwnDisplay>();
    std::thread hand([&] {
        waitFor("three-operator");
        server.reset();
    });
    const Outcome outcome =
        live("file:" + kPhoto, "wait\nsnapshot four\nclose 0\nwait\nsnapshot three\nsleep 100\n",
             "--window-scale 0.25 --compensate-scatter");
    hand.join();
    setenv("DISPLAY", usual.c_str(), 1);
    EXPECT_EQ(outcome.exitCode, 1) << outcome.output;
    EXPECT_NE(outcome.output.find("the connection to the display server has broken"), std::string::npos)
        << outcome.output;
    EXPECT_EQ(report["live"]["moments_solved"], 2); // the same moment, for other projectors
}

TEST_F(Live, a_missing_display_is_named_and_the_picture_shown_in_a_window) {
    json rig = json::parse(readText(kRig));
    rig["projectors"][2]["display"] = rig["projectors"][3]["display"] = "NO-SUCH-OUTPUT";
    writeText(folder / "rig.json", rig.dump());
    const Outcome outcome = heliodon("live --rig " + in("rig.json") + " --camera file:" + kPhoto + kFast +
                                     "--duration 1 --report " + in("report.json"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("display 'NO-SUCH-OUTPUT' is not"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("projectors[3].display: 'NO-SUCH-OUTPUT' is also of"), std::string::npos);
    report = json::parse(readText(folder / "report.json"));
    EXPECT_FALSE(report["live"]["outputs"][2]["full_screen"]);
    EXPECT_NE(report["live"]["outputs"][2]["notice"], "");
}

TEST_F(Live, a_network_camera_shows_the_table) {
    const vision::ImitatedCamera camera(vision::readPhotograph(kPhoto));
    ASSERT_TRUE(camera.runs());
    const Outcome outcome = live("aravis:127.0.0.1", "wait\nsnapshot seen\nquit\n", "--duration 100");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_EQ(report["live"]["sketches"], 1);
    const auto seen = shot("seen-projector-0");
    EXPECT_GT(*std::max_element(seen.rgb.begin(), seen.rgb.end()), 100);
}

TEST_F(Live, a_camera_that_is_not_there_is_waited_for) {
    const Outcome outcome = live("aravis:no-such-camera", "wait\nsnapshot dark\nquit\n");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(report["live"]["camera"].get<std::string>().find("no-such-camera"), std::string::npos);
    const auto dark = shot("dark-projector-0");
    EXPECT_EQ(*std::max_element(dark.rgb.begin(), dark.rgb.end()), 0);
}

TEST_F(Live, sky_file_and_photograph_may_go_and_come_back) {
    const std::string sky = in("sky.json"), photo = in("photo.png");
    fs::copy_file(HELIODON_TEST_DATA "/compute/daylight/c_L_glass_perez_dec21_09_g0/sky.json", sky);
    fs::copy_file(kPhoto, photo);
    const std::string lost = "photo.png is not there; trying again"; // said whenever it goes
    std::atomic<int> losses = 0;
    std::thread user([&] {
        waitFor("first-operator");
        int removals = 0;
        fs::remove(sky);
        for (const bool again : {true, false}) {
            fs::remove(photo);
            ++removals;
            for (int i = 0; i < 2400 && losses < removals; ++i) // it could be just being replaced
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            fs::copy_file(kPhoto, photo);
            if (again) waitFor("back-operator");
        }
    });
    const Outcome outcome =
        live("file:" + photo,
             "wait\nsnapshot first\nsleep 1\nwheel 3\nwait\nlook 2\nsnapshot back\n"
             "look 3\nsky overcast\nwait\nsnapshot last\nquit\n",
             "--window-scale 0.25 --sky " + sky, [&](const std::string& said) {
                 int count = 0;
                 for (size_t at = 0; (at = said.find(lost, at)) != std::string::npos; ++at) ++count;
                 losses = count;
             });
    user.join();
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_GE(report["live"]["refusals"], 1); // of the sky
    EXPECT_LE(report["live"]["refusals"], 2); // looking for the photograph is none
    EXPECT_EQ(report["live"]["camera_losses"], 2);
    EXPECT_NE(outcome.output.find(lost, outcome.output.find(lost) + 1), std::string::npos) << outcome.output;
    EXPECT_NE(shot("last-projector-0").rgb, shot("first-projector-0").rgb);
}

// Submissions of windows, rooms and light take turns, so the same count meets one or the other.
TEST_F(Live, goes_on_when_a_device_is_lost_or_a_window_loses_its_surface) {
    writeText(folder / "script", "wait\nwheel -6\nwait\nwheel 3\nwait\nsnapshot last\nquit\n");
    long swapchains = 0;
    const auto run = [&](const std::string& fault) {
        FaultOutcome outcome =
            heliodonWithFault(fault,
                              "live --rig " + kRig + " --camera file:" + kPhoto +
                                  " --triangles 100 --windowed --window-scale 0.25 --script " + in("script") +
                                  " --snapshots " + in("shots") + " --report " + in("report.json"),
                              folder);
        EXPECT_EQ(outcome.exitCode, 0) << fault << ": " << outcome.output;
        EXPECT_EQ(outcome.leftOver, "") << fault;
        swapchains = outcome.made["Swapchain"];
        EXPECT_EQ(outcome.fired, fault != "none:1:lost") << fault;
        report = json::parse(readText(folder / "report.json"));
        EXPECT_EQ(report["live"]["sketches"], 1) << fault;
        for (const json& output : report["live"]["outputs"]) EXPECT_EQ(output["closed"], "") << fault;
        return shot("last-projector-0");
    };
    const vision::Photograph whole = run("none:1:lost");
    const long enough = swapchains;
    for (const char* fault : {"submit:25:lost", "submit:60:lost", "present:4:lost"}) {
        EXPECT_LE(difference(run(fault), whole).first, 2) << fault;
        EXPECT_GE(report["live"]["device_losses"], 1) << fault;
    }
    for (const char* fault : {"acquire:9:surface", "present:5:date"}) {
        EXPECT_LE(difference(run(fault), whole).first, 2) << fault;
        EXPECT_EQ(report["live"]["device_losses"], 0) << fault;
    }
    // A show that nobody ended is not over in silence.
    const FaultOutcome ended = heliodonWithFault(
        "acquire:9:surface:100000",
        "live --rig " + kRig + " --camera file:" + kPhoto +
            " --triangles 100 --windowed --window-scale 0.25 --duration 100 --report " + in("report.json"),
        folder);
    EXPECT_EQ(ended.exitCode, 1) << ended.output;
    EXPECT_NE(ended.output.find("window is closed: its display went away"), std::string::npos)
        << ended.output;
    EXPECT_TRUE(json::parse(readText(folder / "report.json"))["live"]["outputs"].is_array());
    // But one that its user ends is over, whichever window was lost before; not the operator's.
    writeText(folder / "closing",
              "wait\nclose 0\nsleep 0.2\nclose 1\nsleep 0.2\nclose 2\nsleep 0.2\nclose 3\nsleep 100\n");
    bool lostProjector = false;
    for (int call = 9; call < 15 && !lostProjector; ++call) {
        const FaultOutcome closed =
            heliodonWithFault("acquire:" + std::to_string(call) + ":surface:2",
                              "live --rig " + kRig + " --camera file:" + kPhoto +
                                  " --triangles 100 --windowed --window-scale 0.25 --script " + in("closing"),
                              folder);
        lostProjector = closed.output.find("window is closed") != std::string::npos &&
                        closed.output.find("operator's window is closed") == std::string::npos;
        EXPECT_TRUE(!lostProjector || closed.exitCode == 0) << closed.output;
    }
    EXPECT_TRUE(lostProjector);
    // Images that never fit are made anew once, not for every presentation.
    EXPECT_LE(difference(run("present:2:suboptimal:100000"), whole).first, 2);
    EXPECT_GT(swapchains, enough);
    EXPECT_LE(swapchains, enough + 2);
}

TEST_F(Live, bad_words_are_refused_by_name) {
    const std::string start = "live --windowed --rig " + kRig + " --camera ";
    writeText(folder / "script", "wait\nwheel up\n");
    writeText(folder / "weather", "wait\nsky cie:99\n");
    writeText(folder / "half", "close 1.5\n");
    std::filesystem::create_directory(folder / "empty");
    std::filesystem::copy_file(kPhoto, folder / "end-projector-1.png");
    writeText(folder / "file", "sky weather # which was not given\n");
    const std::pair<std::string, std::string> cases[]{
        {start + "webcam:0", "webcam:0"},
        {start + "file:" + in("none.png"), "none.png"},
        {start + "replay:" + in("empty"), "holds no photograph"},
        {start + "file:" + kPhoto + " --sky purple", "purple"},
        {start + "file:" + kPhoto + " --script " + in("script"), "script:2"},
        {start + "file:" + kPhoto + " --script " + kPhoto,
         "i01_mixed.png: is a picture (PNG), expected a script"},
        {start + "file:" + kPhoto + " --script " + in("weather"), "weather:2"},
        {start + "file:" + kPhoto + " --script " + in("file"), "file:1"},
        {start + "file:" + kPhoto + " --script " + in("half"), "half:1: expected a window as a whole number"},
        {start + "file:" + kPhoto + " --weather " + in("none.epw"), "none.epw"},
        {start + "file:" + kPhoto + " --snapshots " + in("script"), "script"},
        {start + "replay:" + folder.string() + " --snapshots " + in("./"), "read from"},
        {start + "file:" + kPhoto + " --snapshots " + in("new") + " --report " + in("new/end-operator.png"),
         "--report"},
        {start + "file:" + in("end-projector-1.png") + " --snapshots " + folder.string(), "is read"},
        {"live --camera file:" + kPhoto, "--rig"}};
    for (const auto& [words, named] : cases) {
        const Outcome outcome = heliodon(words);
        EXPECT_EQ(outcome.exitCode, 2) << words << "\n" << outcome.output;
        EXPECT_NE(outcome.output.find(named), std::string::npos) << outcome.output;
    }
    // What is wrong with the words is wrong without a display too.
    const char* own = getenv("DISPLAY");
    const std::string before = own ? own : "";
    unsetenv("DISPLAY");
    const Outcome outcome = heliodon(start + "webcam:0");
    setenv("DISPLAY", before.c_str(), 1);
    EXPECT_EQ(outcome.exitCode, 2) << outcome.output;
    EXPECT_NE(outcome.output.find("--camera: 'webcam:0' is no camera"), std::string::npos) << outcome.output;
}

} // namespace
} // namespace heliodon::test
