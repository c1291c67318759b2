// A folder that a command writes into.
#pragma once

#include <filesystem>
#include <vector>

namespace heliodon::app {

class OutputFolder {
public:
    // Makes the folder when it is missing; throws InputError when it is a file or cannot be made or written
    // to.
    explicit OutputFolder(const std::filesystem::path& folder);
    // Removes what was made and is still empty: of a run that failed.
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

private:
    std::vector<std::filesystem::path> made_; // innermost first
};

} // namespace heliodon::app
