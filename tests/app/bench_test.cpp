// The bench as a user runs it: a table whose errors are those that the methods have.
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <regex>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "compute/form_factors.h"
#include "compute/parallel.h"
#include "compute/reference/form_factor_rows.h"
#include "engine/app/bench_peers.h"
#include "engine/app/bench_plot.h"
#include "engine/app/bench_results.h"
#include "engine/app/bench_scenes.h"
#include "engine/app/progress.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"
#include "tests/app/program.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::test {
namespace {

class Bench : public InFolder {};

// Steps may be many to a unit of what is counted.
TEST(Progress, says_once_that_all_is_done) {
    const int screen = ::posix_openpt(O_RDWR | O_NOCTTY), usual = ::dup(STDERR_FILENO);
    ASSERT_TRUE(::grantpt(screen) == 0 && ::unlockpt(screen) == 0);
    const int end = ::open(::ptsname(screen), O_RDWR | O_NOCTTY);
    ::dup2(end, STDERR_FILENO);
    {
        app::Progress progress("hours", 3, true);
        std::this_thread::sleep_for(std::chrono::milliseconds(2100));
        progress.advance(2);
        for (int step = 0; step < 5; ++step) progress.advance(3);
    }
    ::dup2(usual, STDERR_FILENO);
    ::close(end); // reads go on to the end of what was written, and not beyond
    std::string said;
    std::array<char, 4096> text{};
    for (ssize_t size; (size = ::read(screen, text.data(), text.size())) > 0;)
        said.append(text.data(), static_cast<size_t>(size));
    for (const int handle : {usual, screen}) ::close(handle);
    EXPECT_NE(said.find("2/3"), std::string::npos) << said;
    EXPECT_NE(said.find("3/3"), std::string::npos) << said;
    EXPECT_EQ(said.find("3/3"), said.rfind("3/3")) << said;
}

TEST_F(Bench, names_with_commas_and_quotes_stay_one_cell) {
    app::BenchResult result;
    result.scene = "my \"best\" room", result.kernel = "hemicube", result.setting = "64x64, 4 points";
    const std::string csv = app::csvOf(std::vector{result});
    EXPECT_NE(csv.find("\n\"my \"\"best\"\" room\",0,hemicube,\"64x64, 4 points\",false,"), std::string::npos)
        << csv;
    EXPECT_EQ(app::csvOf(std::vector{app::BenchResult{.scene = "box"}}).find('"'), std::string::npos);
}

TEST_F(Bench, names_that_are_no_plain_words_do_not_break_the_plot) {
    app::BenchResult r;
    r.scene = "a, <b> & \"c\".obj", r.kernel = "exact", r.setting = "1 < 2";
    r.compared.median = 1, r.rowError = 1e-3;
    const std::string svg = app::plotOf({r}, "R&D", "CPU").svg();
    EXPECT_EQ(svg.find("<b>"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("1 < 2"), std::string::npos) << svg;
    EXPECT_FALSE(std::regex_search(svg, std::regex("&(?!amp;|lt;|gt;|quot;)"))) << svg;
}

TEST_F(Bench, a_convex_room_by_two_kernels) {
    const Outcome outcome = heliodon("bench --quiet --kernels exact,montecarlo --scenes box --sizes 60,60 "
                                     "--errors 1e-2,1e-4,1e-4 --runs 1 "
                                     "--reference-rows 4 --no-peers -o " +
                                     in("out"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
    const auto json = nlohmann::json::parse(readText(in("out/bench.json")));
    EXPECT_TRUE(json["complete"].get<bool>());
    EXPECT_GT(json["flops_per_second"].get<double>(), 0);
    EXPECT_GT(json["cores"].get<int>(), 0);
    std::map<std::string, double> rowError;
    for (const auto& row : json["form_factors"]) {
        EXPECT_EQ(row["scene"], "box");
        EXPECT_GT(row["seconds"].get<double>(), 0);
        EXPECT_GT(row["device_seconds"].get<double>(), 0);
        EXPECT_LE(row["seconds_min"], row["seconds"]);
        EXPECT_GE(row["seconds_max"], row["seconds"]);
        // Of 59 others about ten lie in a patch's own wall, and nothing hides any.
        EXPECT_NEAR(row["pairs_apart"].get<double>() + row["pairs_visible"].get<double>(), 1, 1e-9);
        EXPECT_NEAR(row["pairs_apart"].get<double>(), 0.2, 0.15);
        EXPECT_LE(row["row_error"].get<double>(), row["row_error_max"].get<double>());
        rowError[row["kernel"].get<std::string>() + " " + row["setting"].get<std::string>()] =
            row["row_error"];
    }
    EXPECT_EQ(rowError.size(), json["form_factors"].size()); // what is named twice runs once
    EXPECT_LT(rowError.at("exact 1e-4"), 1e-4);              // what it was asked for
    // 1 / sqrt(rays) at most, by variance; and rays are no oracle.
    EXPECT_LT(rowError.at("montecarlo 4096"), 1.0 / 64);
    EXPECT_GT(rowError.at("montecarlo 4096"), rowError.at("exact 1e-4"));
    for (const auto& row : json["gather"]) EXPECT_LT(row["error"].get<double>(), 1e-5);
    // One line a row, as many columns everywhere; a plot with a mark for each row; meshes to run other
    // programs on.
    const std::string csv = readText(in("out/bench.csv"));
    EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), '\n')), json["form_factors"].size() + 1);
    const std::string svg = readText(in("out/bench.svg"));
    size_t marks = 0;
    for (size_t at = svg.find("<title"); at != std::string::npos; at = svg.find("<title", at + 1)) ++marks;
    EXPECT_EQ(marks, json["form_factors"].size());
    EXPECT_TRUE(std::filesystem::exists(in("out/bench.png")));
    EXPECT_TRUE(std::filesystem::exists(in("out/scenes/box-60.obj")));
}

TEST_F(Bench, of_equals_the_faster_is_on_the_front) {
    std::vector<app::BenchResult> results(4);
    results[0].compared.median = 1, results[0].rowError = 1e-3;
    results[1].compared.median = 2, results[1].rowError = 1e-3; // as good, later
    results[2].compared.median = 1, results[2].rowError = 1e-3; // the very same
    results[3].compared.median = 2, results[3].rowError = 1e-4;
    app::markFront(results);
    EXPECT_TRUE(results[0].onFront && results[2].onFront && results[3].onFront);
    EXPECT_FALSE(results[1].onFront);
    // Later and better, but by less than the reference knows.
    for (app::BenchResult& r : results) r.referenceError = 2e-3;
    app::markFront(results);
    EXPECT_FALSE(results[3].onFront);
}

TEST_F(Bench, runs_that_differ_have_a_bar_over_their_range) {
    app::BenchResult r;
    r.kernel = "exact", r.rowError = 1e-3, r.runs = 3;
    r.compared = {1, 1, 1};
    const auto lines = [](const app::BenchResult& result) {
        const std::string svg = app::plotOf({result}, "device", "wall").svg();
        return std::pair{svg.find("bar: all runs") != std::string::npos,
                         std::count(svg.begin(), svg.end(), '\n')};
    };
    const auto same = lines(r);
    r.compared = {1, 0.9, 5};
    const auto apart = lines(r);
    EXPECT_TRUE(same.first && apart.first);
    EXPECT_GE(apart.second, same.second + 3); // the bar and its ends
}

TEST_F(Bench, peers_see_scenes_far_from_the_origin_as_near_it) {
    if (!app::hasEmbree()) GTEST_SKIP() << "built without Embree";
    geometry::PatchMesh mesh = app::benchScenes({"box"}, {12}, in("out"))[0].mesh;
    const std::vector<float> near = app::embreeRays(mesh, 256).factors;
    for (glm::dvec3& v : mesh.vertices) v += glm::dvec3(4e6, -2e6, 1e6);
    const std::vector<float> far = app::embreeRays(mesh, 256).factors;
    for (size_t k = 0; k < near.size(); ++k) EXPECT_NEAR(near[k], far[k], 0.01) << k;
}

TEST_F(Bench, models_of_all_kinds_are_scenes) {
    const geometry::PatchMesh mesh = app::benchScenes({"box"}, {12}, in("out"))[0].mesh;
    for (const char* name : {"own.obj", "own.glb"}) {
        geometry::writeModel(mesh, in(name));
        app::checkBenchScenes({in(name)});
        const app::BenchScene scene = app::benchScenes({in(name)}, {}, in("out"))[0];
        EXPECT_EQ(scene.name, "own");
        EXPECT_EQ(scene.mesh.patchCount(), mesh.patchCount()) << name;
    }
    EXPECT_THROW(app::checkBenchScenes({in("own.mtl")}), geometry::InputError);
    const Outcome outcome = heliodon("bench --kernels montecarlo --errors 0.1 --runs 1 --no-peers --sizes 60 "
                                     "--scenes " +
                                     in("own.obj") + " -o " + in("models"));
    EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("--sizes is not used"), std::string::npos) << outcome.output;
}

// All kernels agree on zeros there.
TEST_F(Bench, scenes_in_which_nothing_faces_anything_are_no_result) {
    writeText(in("out.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                             "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    const Outcome outcome = heliodon("bench --kernels hierarchical --runs 1 --no-peers --scenes " +
                                     in("out.obj") + " -o " + in("refused"));
    EXPECT_EQ(outcome.exitCode, 2) << outcome.output;
    EXPECT_NE(outcome.output.find(in("out.obj") + ": the faces look out of what they enclose"),
              std::string::npos)
        << outcome.output;
    // Two squares back to back, after a room: the room's results stay.
    writeText(
        in("backs.obj"),
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\n");
    std::filesystem::create_directories(in("out"));
    writeText(in("out/bench.csv"), "mine");
    const std::string command = "bench --kernels exact --errors 1e-2 --runs 1 --no-peers --reference-rows 2 "
                                "--sizes 12 -o " +
                                in("out") + " --scenes " + in("backs.obj");
    const Outcome alone = heliodon(command);
    EXPECT_EQ(alone.exitCode, 1) << alone.output;
    EXPECT_EQ(readText(in("out/bench.csv")), "mine");
    EXPECT_NE(alone.output.find("bench.csv stood there, not known"), std::string::npos) << alone.output;
    const Outcome after = heliodon(command + ",box");
    EXPECT_EQ(after.exitCode, 0) << after.output;
    EXPECT_NE(after.output.find("backs, 2 patches: reference rows: all are zero"), std::string::npos)
        << after.output;
    const auto results = nlohmann::json::parse(readText(in("out/bench.json")));
    for (const auto& row : results["form_factors"]) EXPECT_EQ(row["scene"], "box");
}

// Ctrl-C after the first row: what was finished is there, whole, and says that there was more.
TEST_F(Bench, an_interrupted_run_keeps_what_it_finished) {
    FILE* pipe = popen(("echo $$; ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 exec " HELIODON_PROGRAM
                        " bench --kernels exact --scenes box --sizes 60 --runs 20 --reference-rows 4 -o " +
                        in("out") + " 2>&1")
                           .c_str(),
                       "r");
    std::array<char, 4096> line{};
    ASSERT_TRUE(fgets(line.data(), line.size(), pipe));
    const auto program = static_cast<pid_t>(std::stoi(line.data()));
    std::string said;
    while (fgets(line.data(), line.size(), pipe)) {
        if (said.find("row error") == std::string::npos && std::strstr(line.data(), "row error"))
            kill(program, SIGINT);
        said += line.data();
    }
    EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 1);
    EXPECT_NE(said.find("heliodon: interrupted\n"), std::string::npos) << said;
    const auto json = nlohmann::json::parse(readText(in("out/bench.json")));
    EXPECT_FALSE(json["complete"].get<bool>());
    ASSERT_FALSE(json["form_factors"].empty());
    EXPECT_EQ(json["form_factors"][0]["setting"], "1e-2");
    const std::string csv = readText(in("out/bench.csv"));
    EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), '\n')), json["form_factors"].size() + 1);
    EXPECT_TRUE(readText(in("out/bench.svg")).ends_with("</svg>\n"));
}

// Partitions' edges are where light is lost: closure of every row, and rows spread over the patches against
// the oracle.
TEST_F(Bench, partitions_close_and_agree_with_the_oracle) {
    const geometry::PatchMesh mesh = app::benchScenes({"partitions"}, {1000}, in("out"))[0].mesh;
    const size_t n = mesh.patchCount();
    const compute::reference::FormFactorRows oracle(mesh);
    constexpr size_t kRows = test::kSanitized ? 2 : 8;
    std::vector<compute::reference::FormFactorRows::Row> truth(kRows);
    compute::inParallel(kRows, [&](size_t k) { truth[k] = oracle.row((2 * k + 1) * n / (2 * kRows)); });
    struct Asked {
        const char* kernel;
        double error, closure;
    };
    for (const Asked& asked : {Asked{"exact", 1e-4, 3e-3}, Asked{"exact", 1e-5, 3e-4},
                               Asked{"hierarchical", 5e-3, 0.1}, Asked{"hierarchical", 1e-3, 0.02}}) {
        compute::FormFactorOptions options;
        options.kernel = asked.kernel;
        options.maxError = asked.error;
        const compute::FormFactors F = compute::computeFormFactors(test::device(), mesh, options);
        const auto values = F.values.download<float>(n * n);
        double squares = 0;
        for (size_t k = 0; k < kRows; ++k)
            for (size_t j = 0; j < n; ++j) {
                const size_t i = (2 * k + 1) * n / (2 * kRows);
                ASSERT_GE(values[i * n + j], 0.0f);
                squares += std::pow(double{values[i * n + j]} - truth[k].factors[j], 2);
            }
        // Eight rows of a thousand stand for all.
        EXPECT_LE(std::sqrt(squares / kRows), 1.2 * asked.error) << asked.kernel;
        EXPECT_LE(F.report.closureMax, asked.closure) << asked.kernel << " " << asked.error;
        EXPECT_LE(F.report.claimedRowError, 6 * asked.error) << asked.kernel; // `exact` is cautious
    }
}

} // namespace
} // namespace heliodon::test
