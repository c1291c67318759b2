// Runs the built program as a user would and keeps what it said.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace heliodon::test {

struct Outcome {
    int exitCode = -1;
    std::string output; // stdout and stderr together
};

// `hear` is told all that was said so far, whenever there is more.
inline Outcome heliodon(const std::string& arguments,
                        const std::function<void(const std::string&)>& hear = {}) {
    // Leaks are looked for in the tests that run in one process: in the program, drivers are unloaded before
    // the leak checker could name what they keep.
    const std::string environment = "ASAN_OPTIONS=detect_leaks=0:detect_odr_violation=0 ";
    FILE* pipe = popen((environment + HELIODON_PROGRAM + " " + arguments + " 2>&1").c_str(), "r");
    Outcome outcome;
    std::array<char, 4096> chunk{};
    for (ssize_t n; (n = read(fileno(pipe), chunk.data(), chunk.size())) > 0;) {
        outcome.output.append(chunk.data(), static_cast<size_t>(n));
        if (hear) hear(outcome.output);
    }
    const int status = pclose(pipe);
    outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

inline void writeText(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

inline std::string readText(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

// A folder of its own for each test, removed at the end.
class InFolder : public testing::Test {
protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder = std::filesystem::temp_directory_path() /
                 ("heliodon-" + std::to_string(getpid()) + "-" + info->name());
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    std::string in(const std::string& name) const { return (folder / name).string(); }

    std::filesystem::path folder;
};

} // namespace heliodon::test
