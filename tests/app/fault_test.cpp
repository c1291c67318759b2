// How commands end when something goes wrong that is nobody's input: one line, exit code 1, no half of a
// file, nothing left on the device.
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include <nlohmann/json.hpp>

#include "engine/app/film.h"
#include "engine/app/output_folder.h"
#include "engine/app/run.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"
#include "tests/app/fault_layer.h"

namespace heliodon::test {
namespace {

namespace fs = std::filesystem;

const std::string kRig = HELIODON_SOURCE "/examples/rig.json",
                  kSketch = HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --triangles 60 --quiet ";
const std::string kFrom = "--sky clear --from 2026-03-21T10:00solar --to 2026-03-21T13:00solar --step PT1H ";

class Fault : public InFolder {
protected:
    size_t filesIn(const fs::path& where) const {
        size_t count = 0;
        if (fs::exists(where))
            for (const auto& entry : fs::recursive_directory_iterator(where))
                count += entry.is_regular_file();
        return count;
    }
    // Pictures that were finished before may be there; nothing that is half of something.
    void expectNothingHalf(const std::string& what) const {
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            const std::string name = entry.path().filename().string();
            EXPECT_FALSE(name.starts_with(".")) << what << " left " << entry.path();
            EXPECT_FALSE(entry.is_regular_file() && name.starts_with("out.") && name != "out.mtl")
                << what << " left " << entry.path();
            if (entry.path().extension() != ".png") continue;
            EXPECT_NO_THROW(app::readPicture(entry.path())) << what << " left " << entry.path();
        }
    }
    static void expectOneLine(const Outcome& outcome, const std::string& word, const std::string& what) {
        EXPECT_EQ(outcome.exitCode, 1) << what << ": " << outcome.output;
        EXPECT_TRUE(outcome.output.starts_with("heliodon: ")) << what << ": " << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1)
            << what << outcome.output;
        EXPECT_NE(outcome.output.find(word), std::string::npos) << what << ": " << outcome.output;
    }
    // False when the command came to its end before that call.
    bool fails(const std::string& fault, const std::string& command) {
        const FaultOutcome outcome = heliodonWithFault(fault, command, folder);
        const std::string what = command.substr(0, command.find(' ')) + " with " + fault;
        EXPECT_EQ(outcome.leftOver, "") << what;
        // A pipeline is made ahead of its use, and not every one is used.
        const bool idle = fault.starts_with("Pipeline:") || fault.starts_with("ShaderModule:");
        if (outcome.exitCode == 0 && (!outcome.fired || idle)) {
            fs::remove_all(folder / "out");
            return outcome.fired;
        }
        expectOneLine(outcome, "VK_ERROR_", what);
        expectNothingHalf(what);
        return true;
    }
    static pid_t begin(const std::string& arguments) {
        const pid_t child = fork();
        if (child == 0) {
            const std::string command =
                "ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 exec " HELIODON_PROGRAM " " + arguments;
            execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
            _exit(127);
        }
        return child;
    }
    // Of one that a signal has ended: -1.
    static int exitCodeOf(pid_t child) {
        int status = 0;
        waitpid(child, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    static void waitFor(const fs::path& file) {
        for (int i = 0; i < 2400 && !fs::exists(file); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        ASSERT_TRUE(fs::exists(file));
    }
    // Writing fails beyond so many blocks of 512 bytes, as on a full disk.
    Outcome onFullDisk(int blocks, const std::string& arguments) const {
        const std::string program = "sh -c \"ulimit -f " + std::to_string(blocks) +
                                    "; exec " HELIODON_PROGRAM " " + arguments + "\" 2>&1";
        FILE* pipe = popen(("ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 " + program).c_str(), "r");
        Outcome outcome;
        for (int c; (c = fgetc(pipe)) != EOF;) outcome.output += static_cast<char>(c);
        const int status = pclose(pipe);
        outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        return outcome;
    }
};

TEST_F(Fault, a_call_that_fails_anywhere_in_a_command_ends_it_with_nothing_left_behind) {
    const std::string render = "render " + kSketch + "--rig " + kRig + " -o " + in("out");
    for (const char* call : {"Device", "CommandPool", "Semaphore", "Memory", "Buffer", "bind", "BufferView",
                             "Image", "ImageView", "Sampler", "ShaderModule", "DescriptorSetLayout",
                             "PipelineLayout", "Pipeline", "record"}) {
        EXPECT_TRUE(fails(std::string(call) + ":1:memory", render)) << call;
        if (call[0] == 'M' || call[0] == 'B') fails(std::string(call) + ":9:memory", render);
    }
}

TEST_F(Fault, a_lost_device_ends_every_command_with_one_line) {
    const std::string commands[]{
        "formfactors " + kSketch + "-o " + in("out.npy"),
        "illuminance " + kSketch + "-o " + in("out.csv"),
        "render " + kSketch + "--rig " + kRig + " -o " + in("out"),
        "timelapse " + kSketch + kFrom + "-o " + in("out.mp4"),
        "annual " + kSketch + "--weather " HELIODON_TEST_DATA "/daylight/chicago_tmy3.epw.gz -o " + in("out"),
        "bench --quiet --sizes 100 --runs 1 --kernels exact -o " + in("out")};
    for (const std::string& command : commands) {
        EXPECT_TRUE(fails("submit:2:lost", command)) << command;
        EXPECT_TRUE(fails("wait:7:lost", command)) << command;
    }
}

TEST_F(Fault, a_time_lapse_goes_on_after_its_device_was_lost) {
    const std::string command = "timelapse " + kSketch + kFrom + "--resume -o " + in("out");
    // Late enough for some frames and too early for all: how many calls that is, is the machine's affair.
    const auto pictures = [&] {
        size_t count = 0;
        for (int frame = 0; frame < 4; ++frame)
            count += fs::exists(folder / "out" / ("0000" + std::to_string(frame) + ".png"));
        return count;
    };
    size_t done = 0;
    for (int early = 1, late = 128; late - early > 1 && (done == 0 || done == 4);) {
        const int n = (early + late) / 2;
        fs::remove_all(folder / "out");
        const FaultOutcome outcome =
            heliodonWithFault("submit:" + std::to_string(n) + ":lost", command, folder);
        if (outcome.fired) expectOneLine(outcome, "VK_ERROR_DEVICE_LOST", "timelapse");
        done = pictures();
        (done == 0 ? early : late) = n;
    }
    ASSERT_GT(done, 0u);
    ASSERT_LT(done, 4u);
    EXPECT_TRUE(fs::exists(folder / "out/frames.part.csv"));
    const std::string first = readText(folder / "out/00000.png");
    const Outcome again = heliodon(command);
    ASSERT_EQ(again.exitCode, 0) << again.output;
    EXPECT_EQ(readText(folder / "out/00000.png"), first);
    EXPECT_EQ(filesIn(folder / "out"), 6u); // four pictures, frames.json, frames.csv
}

TEST_F(Fault, without_a_driver_every_command_says_so) {
    setenv("VK_ICD_FILENAMES", "/no/such/driver.json", 1);
    setenv("VK_DRIVER_FILES", "/no/such/driver.json", 1);
    for (const std::string& command :
         {std::string("devices"), "formfactors " + kSketch + "-o " + in("out.npy"),
          "formfactors " + kSketch + "--device 0 -o " + in("out.npy")})
        expectOneLine(heliodon(command), "no Vulkan device", command);
    unsetenv("VK_ICD_FILENAMES");
    unsetenv("VK_DRIVER_FILES");
    expectNothingHalf("no driver");
}

TEST_F(Fault, a_full_disk_leaves_no_half_of_a_file) {
    const std::string render = "render " + kSketch + "--rig " + kRig + " -o ";
    const std::pair<int, std::string> commands[]{{8, "formfactors " + kSketch + "-o " + in("out.npy")},
                                                 {4, "illuminance " + kSketch + "-o " + in("out.csv")},
                                                 {20, render + in("out")},
                                                 {4, "timelapse " + kSketch + kFrom + "-o " + in("out.mp4")},
                                                 {8, "timelapse " + kSketch + kFrom + "-o " + in("out")},
                                                 {2, "model " + kSketch + "-o " + in("out.obj")}};
    // With newer drivers in software memory is a file without a name, which the limit ends, too.
    const bool asksDevice = onFullDisk(4, "illuminance " + kSketch + "-o -").exitCode == 0;
    for (const auto& [blocks, command] : commands) {
        if (!asksDevice && !command.starts_with("model")) continue;
        const Outcome outcome = onFullDisk(blocks, command);
        EXPECT_EQ(outcome.exitCode, 1) << command << ": " << outcome.output;
        EXPECT_NE(outcome.output.find("out"), std::string::npos) << command << ": " << outcome.output;
        EXPECT_EQ(outcome.output.find(".heliodon-"), std::string::npos) << command << ": " << outcome.output;
        expectNothingHalf(command);
        EXPECT_FALSE(fs::exists(folder / "out/render.files.json")) << "lists what is not there";
        fs::remove_all(folder / "out");
    }
    if (!asksDevice)
        GTEST_SKIP() << "all but `model`: this driver's memory falls under the limit of file sizes";
}

TEST_F(Fault, ctrl_c_ends_work_that_asks_no_device_and_not_the_report_of_what_is_done) {
    const pid_t patterns = begin("calibrate patterns --size 3840x2160 --quiet -o " + in("out"));
    waitFor(folder / "out/white.png");
    kill(patterns, SIGINT);
    EXPECT_EQ(exitCodeOf(patterns), 1);
    EXPECT_FALSE(fs::exists(folder / "out/patterns.json"));
    expectNothingHalf("calibrate patterns");

    ASSERT_EQ(mkfifo(in("report.json").c_str(), 0600), 0); // waits until somebody reads
    const pid_t model = begin("model " HELIODON_TEST_DATA "/geometry/sketches/p04_L.json --triangles 60 -o " +
                              in("done.obj") + " --report " + in("report.json") + " 2> " + in("said"));
    const auto isDone = [&] { return readText(folder / "said").find(" triangles\n") != std::string::npos; };
    for (int i = 0; i < 2400 && !isDone(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ASSERT_TRUE(isDone()) << readText(folder / "said");
    kill(model, SIGINT);
    const int reader = open(in("report.json").c_str(), O_RDONLY | O_NONBLOCK);
    std::string report;
    int status = 0;
    for (bool ended = false; !ended;) { // a report longer than a pipe holds waits for this, too
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        ended = waitpid(model, &status, WNOHANG) != 0;
        std::array<char, 4096> chunk{};
        for (ssize_t n; (n = read(reader, chunk.data(), chunk.size())) > 0;)
            report.append(chunk.data(), static_cast<size_t>(n));
    }
    close(reader);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    EXPECT_NE(report.find("\"triangles\""), std::string::npos) << report;
}

TEST_F(Fault, a_pipe_is_written_to_and_stays_a_pipe_and_a_link_stays_a_link) {
    ASSERT_EQ(mkfifo(in("pipe.npy").c_str(), 0600), 0);
    std::string read;
    std::thread reader([&] { read = readText(folder / "pipe.npy"); });
    const Outcome piped = heliodon("formfactors " + kSketch + "-o " + in("pipe.npy"));
    reader.join();
    EXPECT_EQ(piped.exitCode, 0) << piped.output;
    EXPECT_TRUE(fs::is_fifo(folder / "pipe.npy"));
    fs::create_symlink("there.npy", folder / "link.npy");
    EXPECT_EQ(heliodon("formfactors " + kSketch + "-o " + in("link.npy")).exitCode, 0);
    EXPECT_TRUE(fs::is_symlink(folder / "link.npy"));
    EXPECT_GT(read.size(), 1000u);
    EXPECT_TRUE(readText(folder / "there.npy") == read);
}

TEST_F(Fault, a_folder_has_one_writer_and_a_killed_one_is_no_obstacle) {
    const std::string render = "render " + kSketch + "--rig " + kRig + " -o " + in("out");
    const pid_t child = begin("timelapse " + kSketch + // a year of minutes: long enough to be killed
                              "--from 2026-01-01T00:00solar --to 2026-12-31T00:00solar --step PT1M "
                              "--sky clear -o " +
                              in("out"));
    waitFor(folder / "out/frames.json");
    const Outcome second = heliodon(render);
    EXPECT_EQ(second.exitCode, 2) << second.output;
    EXPECT_NE(second.output.find("another run"), std::string::npos) << second.output;
    kill(child, SIGKILL);
    exitCodeOf(child);
    for (const auto& entry : fs::directory_iterator(folder / "out")) { // what bears its final name is whole
        if (entry.path().extension() != ".png" || entry.path().filename().string().starts_with(".")) continue;
        EXPECT_NO_THROW(app::readPicture(entry.path()));
    }
    const Outcome third = heliodon(render);
    EXPECT_EQ(third.exitCode, 0) << third.output;
}

// As a killed one holds it, until its memory is given back.
TEST_F(Fault, a_folder_that_is_held_for_a_moment_longer_is_waited_for) {
    const int held = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    const std::jthread release([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        ::close(held);
    });
    EXPECT_NO_THROW(app::OutputFolder{folder});
}

TEST_F(Fault, a_run_that_failed_records_what_it_wrote_and_nothing_of_others) {
    app::Run run(app::Arguments{"render", {.quiet = true}, {}});
    const auto write = [&](const char* name) { geometry::writeWholeText(folder / name, "the run's"); };
    const auto recorded = [&] {
        return nlohmann::json::parse(readText(folder / "render.files.json"))["files"];
    };
    for (const char* theirs : {"b", "c"}) writeText(folder / theirs, "the user's");
    { // fails before it has written d
        app::OutputFolder failing(folder);
        failing.startFiles(run, "render", {"a", "b", "c", "d"});
        write("a");
        write("b");
    }
    EXPECT_EQ(recorded(), nlohmann::json({"a", "b"}));
    writeText(folder / "d", "the user's");
    { // fails before it has written anything
        app::OutputFolder failing(folder);
        failing.startFiles(run, "render", {"a", "c"});
    }
    EXPECT_EQ(recorded(), nlohmann::json({"a"}));
    EXPECT_FALSE(fs::exists(folder / "b"));
    { app::OutputFolder(folder).startFiles(run, "render", {"e"}); }
    EXPECT_FALSE(fs::exists(folder / "a"));
    EXPECT_FALSE(fs::exists(folder / "render.files.json"));
    for (const char* theirs : {"c", "d"}) EXPECT_EQ(readText(folder / theirs), "the user's") << theirs;
}

TEST_F(Fault, the_record_of_files_that_cannot_be_removed_stays) {
    app::Run run(app::Arguments{"render", {.quiet = true}, {}});
    const auto start = [&](app::OutputFolder& out, const char* file) {
        out.startFiles(run, "render", {file});
    };
    fs::create_directories(folder / "out");
    {
        app::OutputFolder out(folder / "out");
        start(out, "a");
        geometry::writeWholeText(folder / "out/a", "the run's");
    }
    {
        app::OutputFolder out(folder / "out");
        fs::permissions(folder / "out", fs::perms::owner_read | fs::perms::owner_exec |
                                            fs::perms::others_read | fs::perms::others_exec);
        const uid_t self = geteuid();
        if (self == 0) { // whom no permissions bind
            ASSERT_EQ(seteuid(65534), 0);
        }
        EXPECT_ANY_THROW(start(out, "b"));
        ASSERT_EQ(seteuid(self), 0);
        fs::permissions(folder / "out", fs::perms::owner_all);
    }
    {
        app::OutputFolder out(folder / "out");
        start(out, "b");
    }
    EXPECT_FALSE(fs::exists(folder / "out/a"));
}

TEST_F(Fault, empty_folders_go_with_the_run_however_they_were_named) {
    for (const char* name : {"new/out", "new/out/", "new//out//"}) {
        { const app::OutputFolder made(in(name)); }
        EXPECT_FALSE(fs::exists(folder / "new")) << name;
    }
    EXPECT_THROW(app::OutputFolder(in("out.png/")), geometry::InputError);
    EXPECT_FALSE(fs::exists(folder / "out.png"));
}

TEST_F(Fault, what_a_killed_run_leaves_is_removed_by_the_next_and_nothing_else_is) {
    const fs::path mine = geometry::asideOf(folder / "room.obj"); // of a process that lives
    const std::string name = mine.filename().string();
    const size_t number = name.rfind('-') + 1, end = name.rfind('.');
    const pid_t child = fork();
    if (child == 0) _exit(0);
    int status = 0;
    waitpid(child, &status, 0);
    std::string ofDead = name, ofOthers = name;
    ofDead.replace(number, end - number, std::to_string(child));
    ofOthers = ofDead;
    ofOthers[ofOthers.rfind("heliodon-") + 9] ^= 1; // another machine, whose processes nobody here knows
    const std::string kept[]{name, ofOthers, ".room.obj", ".room." + std::to_string(child) + ".obj",
                             "room.txt"};
    for (const std::string& file : kept) writeText(folder / file, "x");
    writeText(folder / ofDead, "x");
    const Outcome outcome = heliodon("model " + kSketch + "-o " + in("out.obj"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_FALSE(fs::exists(folder / ofDead));
    for (const std::string& file : kept) EXPECT_TRUE(fs::exists(folder / file)) << file;
}

} // namespace
} // namespace heliodon::test
