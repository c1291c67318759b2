// Reads every #include of the repository: folders may only use those that the design's arrows lead to.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace fs = std::filesystem;

namespace {

const fs::path kRoot = HELIODON_SOURCE;

// Folders from the longest name on, so that compute/gpu is found before compute.
const std::vector<std::string> kFolders{
    "compute/reference", "compute/daylight", "compute/gpu", "engine/present", "engine/passes", "engine/app",
    "shaders/io",        "shaders/lib",      "geometry",    "vision",         "compute",       "shaders"};

// Each folder may include itself and these.
const std::map<std::string, std::set<std::string>> kAllowed{
    {"geometry", {}},
    {"vision", {"geometry"}},
    {"compute/daylight", {"geometry"}},
    {"compute/gpu", {"shaders/io"}},
    {"compute/reference", {"compute", "compute/daylight", "geometry", "shaders/io"}},
    {"compute", {"compute/gpu", "compute/reference", "compute/daylight", "geometry", "shaders/io"}},
    {"engine/present", {"engine/passes", "compute/gpu", "geometry", "shaders/io"}},
    {"engine/passes", {"compute", "compute/gpu", "compute/daylight", "geometry", "shaders/io"}},
    {"engine/app",
     {"engine/present", "engine/passes", "compute", "compute/gpu", "compute/daylight", "compute/reference",
      "vision", "geometry", "shaders/io"}},
    {"shaders/io", {}},
    {"shaders/lib", {"shaders/io"}},
    {"shaders", {"shaders/io", "shaders/lib"}},
};

std::string folderOf(const std::string& path) {
    for (const std::string& folder : kFolders)
        if (path.starts_with(folder + "/")) return folder;
    return "";
}

// The quoted includes of a file, resolved to the root.
std::vector<std::string> includesOf(const fs::path& file) {
    std::vector<std::string> found;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        const size_t hash = line.find_first_not_of(" \t");
        if (hash == std::string::npos || line[hash] != '#') continue;
        const size_t word = line.find("include", hash), open = line.find('"', hash);
        if (word == std::string::npos || open == std::string::npos || word > open) continue;
        const std::string name = line.substr(open + 1, line.find('"', open + 1) - open - 1);
        if (fs::exists(kRoot / name))
            found.push_back(name);
        else if (fs::exists(file.parent_path() / name))
            found.push_back(fs::relative(file.parent_path() / name, kRoot).generic_string());
    }
    return found;
}

std::vector<fs::path> sources() {
    std::vector<fs::path> out;
    for (const char* top : {"geometry", "vision", "compute", "engine", "shaders"})
        for (const auto& entry : fs::recursive_directory_iterator(kRoot / top))
            if (entry.is_regular_file() && entry.path().filename() != "CMakeLists.txt" &&
                entry.path().extension() != ".md")
                out.push_back(entry.path());
    std::ranges::sort(out);
    return out;
}

} // namespace

TEST(Includes, every_arrow_is_one_of_the_design) {
    size_t arrows = 0;
    for (const fs::path& file : sources()) {
        const std::string name = fs::relative(file, kRoot).generic_string(), from = folderOf(name);
        for (const std::string& included : includesOf(file)) {
            const std::string to = folderOf(included);
            ++arrows;
            if (to.empty() || to == from || from.empty()) continue;
            EXPECT_TRUE(kAllowed.at(from).contains(to)) << name << " includes " << included;
        }
    }
    EXPECT_GT(arrows, 50u); // it did read them
}

TEST(Includes, no_header_shows_a_third_party_type_that_is_to_stay_private) {
    for (const fs::path& file : sources()) {
        if (file.extension() != ".h") continue;
        std::ifstream in(file);
        for (std::string line; std::getline(in, line);)
            for (const char* package : {"<CGAL/", "<opencv", "<GLFW/", "<arv", "<embree", "<imgui", "<tiny_"})
                EXPECT_EQ(line.find(std::string("#include ") + package), std::string::npos)
                    << file << ": " << line;
    }
}
